# SPDX-License-Identifier: BSD-3-Clause
"""Time through the plugin: the time keeper knows the steps, the animation goes through them, a static scene without
steps to play stays as it is, and what is saved says which revolution it is of.

Run by pvpython in one process and by pvbatch on two ranks (the argument)."""

import glob
import os
import shutil
import sys

import numpy
from paraview import simple
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkFiltersSources import vtkLineSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
from vtkmodules.vtkParallelCore import vtkMultiProcessController

from plugin_testing import OUTPUT_DIR, airport, assert_same, fetch, load_plugin

COLUMNS = 60
MOVING = """
from vtkmodules.vtkFiltersSources import vtkCubeSource
info = self.GetOutputInformation(0)
time = info.Get(self.GetExecutive().UPDATE_TIME_STEP()) if info.Has(self.GetExecutive().UPDATE_TIME_STEP()) else 0.0
cube = vtkCubeSource()
cube.SetBounds(-20, 20, 50 + time, 52 + time, -20, 20)
cube.SetOutputPointsPrecision(1)
cube.Update()
self.GetPolyDataOutput().ShallowCopy(cube.GetOutput())
"""
STEPS = """
info, executive = self.GetOutputInformation(0), self.GetExecutive()
info.Remove(executive.TIME_STEPS())
info.Remove(executive.TIME_RANGE())
for step in range({first}, 11):
    info.Append(executive.TIME_STEPS(), step)
for end in ({first}, 10):
    info.Append(executive.TIME_RANGE(), end)
"""


def fresh():
    simple.ResetSession()
    load_plugin()


def remove(names):
    if vtkMultiProcessController.GetGlobalController().GetLocalProcessId() == 0:
        for name in glob.glob(os.path.join(OUTPUT_DIR, names)):
            shutil.rmtree(name) if os.path.isdir(name) else os.remove(name)  # pieces of ranks have a folder


def played():
    """The animation of all that is there."""
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    return scene


def frames_of(scene, look):
    """What `look` sees at each frame while the animation plays."""
    seen = []
    scene.GoToFirst()
    for _ in scene.TimeKeeper.TimestepValues:
        seen.append(look())
        scene.GoToNext()
    return seen


def count(proxy, port=0):
    proxy.UpdatePipeline(simple.GetAnimationScene().TimeKeeper.Time)
    return proxy.GetDataInformation(port).GetNumberOfPoints()


def nearest(echoes):
    count(echoes)
    return echoes.PointData["distance_m"].GetRange()[0]


def test_a_static_scene_stays_as_it_is():
    """Without steps to play an animation of a camera has its ten frames, all of them the same scan."""
    fresh()
    echoes = airport(COLUMNS)[3]
    before = fetch(echoes)
    scene = played()
    assert not scene.TimeKeeper.TimestepValues and scene.PlayMode == "Sequence", scene.TimeKeeper.TimestepValues
    assert (scene.NumberOfFrames, scene.StartTime, scene.EndTime) == (10, 0.0, 1.0), scene.NumberOfFrames
    echoes.UpdatePipeline(0.7)
    assert_same(fetch(echoes), before)


def test_sweeps():
    """Sensor, echoes and image in one view: the image is the whole scan at every step, filled as far as it was
    fired."""
    fresh()
    _, _, beams, echoes = airport(COLUMNS)
    whole = fetch(echoes)
    beams.NumberOfRevolutions = 2
    beams.StepsPerRevolution = 6
    beams.UpdatePipelineInformation()
    steps = [(k + j / 6) / 0.5 for k in range(2) for j in range(6)]
    assert list(beams.TimestepValues) == steps, beams.TimestepValues
    image = simple.AvianLidarRangeImage(Echoes=echoes, Beams=simple.OutputPort(echoes, 1))
    view = simple.CreateRenderView()
    for shown in (beams, echoes, image):
        simple.Show(shown, view)
    simple.ColorBy(simple.GetDisplayProperties(image, view), ("POINTS", "status"))
    scene = played()
    scene.ViewModules = [view]
    assert list(scene.TimeKeeper.TimestepValues) == steps and scene.PlayMode == "Snap To TimeSteps", scene.PlayMode
    assert (scene.StartTime, scene.EndTime) == (0.0, steps[-1])

    def look():
        simple.Render(view)
        extent, status = tuple(image.GetDataInformation().GetExtent()), image.PointData["status"].GetRange()[0]
        counts = (count(data, port) for data in (beams, echoes) for port in (0, 1))
        return scene.TimeKeeper.Time, *counts, extent, status >= 0

    times, *fired, received, reported, extents, full = zip(*frames_of(scene, look))
    assert list(times) == steps, times
    expected = [COLUMNS * 16 * (k % 6 + 1) // 6 for k in range(12)]
    assert [*map(list, fired)] == [expected, [2 * one for one in expected]], fired
    assert list(reported) == expected, reported
    assert 0 < received[1] < received[2] < received[5] == len(whole["energy"]), received
    assert received[:6] == received[6:], received
    assert {*extents} == {(0, COLUMNS - 1, 0, 15, 0, 0)} and list(full) == ([False] * 5 + [True]) * 2, (extents, full)
    # Played by ParaView itself.
    scene.GoToFirst()
    scene.Play()
    assert scene.TimeKeeper.Time == steps[-1]
    found = fetch(echoes)
    numpy.testing.assert_allclose(found.pop("timestamp"), whole.pop("timestamp") + 2e6, rtol=1e-12)
    assert_same(found, whole)


def moving(first=0, **settings):
    source = simple.ProgrammableSource(
        OutputDataSetType="vtkPolyData", Script=MOVING, ScriptRequestInformation=STEPS.format(first=first))
    walls = simple.AvianLidarMaterial(Input=source)
    beams = simple.AvianLidarCorridorC16(RotationRate=0.5, AzimuthStep=1, **settings)
    return simple.AvianLidarEchoFilter(Beams=simple.Transform(Input=beams),
                                       Surfaces=simple.AvianLidarCollisionTree(Input=walls))


def test_a_moving_scene():
    """Is sampled at each revolution. A sensor with nothing to play adds no step to those of data, and follows them."""
    for first, settings in ((0, {"NumberOfRevolutions": 3, "StepsPerRevolution": 2}), (5, {})):
        fresh()
        echoes = moving(first, **settings)
        echoes.UpdatePipelineInformation()
        scene, times = played(), [*range(first, 11)]
        assert list(scene.TimeKeeper.TimestepValues) == times, scene.TimeKeeper.TimestepValues
        assert (scene.StartTime, scene.EndTime) == (first, 10), (scene.StartTime, scene.EndTime)
        seen = frames_of(scene, lambda: nearest(echoes))
        assert numpy.allclose(seen, [50 + 2 * (time // 2) for time in times], rtol=0, atol=0.01), seen


def test_a_sensor_that_drives():
    """Moves along the trajectory in a file. A sensor that is made while another source is active stands still."""
    fresh()
    name = os.path.join(OUTPUT_DIR, "TestAnimationTrajectory.vtp")
    line, times = vtkLineSource(), vtkDoubleArray()
    line.SetPoint1(0, 0, 2)
    line.SetPoint2(40, 0, 2)
    line.SetResolution(2)
    line.SetOutputPointsPrecision(1)
    line.Update()
    times.SetName("time")
    for time in (0, 2, 6):
        times.InsertNextValue(time)
    line.GetOutput().GetPointData().AddArray(times)
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToBinary()
    writer.SetInputData(line.GetOutput())
    writer.SetFileName(name)
    assert writer.Write()
    way = simple.XMLPolyDataReader(FileName=[name])
    way.UpdatePipeline()
    simple.SetActiveSource(way)
    beams = simple.AvianLidarAirport16(AzimuthStep=360 / COLUMNS, NumberOfRevolutions=2)
    assert beams.Trajectory is None and count(beams) == 16 * COLUMNS
    assert beams.GetDataInformation().GetBounds()[:2] == (0.0, 0.0)
    beams.Trajectory = way
    scene = played()

    def look():
        return count(beams), *beams.GetDataInformation().GetBounds()[:2]

    (all_of_first, low, high), (all_of_second, later, last) = frames_of(scene, look)
    assert all_of_first == all_of_second == 16 * COLUMNS
    # 20 m in the first 2 s, then 5 m/s; the last beam is fired a column and a firing before the end.
    assert low == 0.0 and 19 < high < 20 and later == 20.0 and 29.5 < last < 30, (low, high, later, last)
    assert beams.PointData["sensor_position"].GetRange(2) == (2.0, 2.0)
    beams.Trajectory = None
    look()
    assert beams.GetDataInformation().GetBounds()[:2] == (0.0, 0.0)


def test_saving_every_step(kind):
    """Save Data with "Write timesteps as file-series" leaves a file for each step of the sensor."""
    fresh()
    echoes = moving(NumberOfRevolutions=3, StepsPerRevolution=2)
    stem = os.path.join(OUTPUT_DIR, f"TestAnimation-{kind}")
    label = "Writetimestepsasfileseries" if kind == "vtp" else "Writealltimestepsasfileseries"
    simple.SaveData(f"{stem}.{kind}", proxy=echoes, DataMode="Binary", **{label: 1})
    files = [f"{stem}_{step}.{kind}" for step in range(6)]
    assert sorted(glob.glob(f"{stem}_?.{kind}")) == files, glob.glob(f"{stem}*")
    fresh()
    for step, file in enumerate(files):
        back = simple.OpenDataFile(file)
        assert abs(
            nearest(back) - 50 - 2 * (step // 2)) < 0.01 and back.FieldData["revolution"].GetRange()[0] == step // 2
        simple.Delete(back)
    remove(f"TestAnimation-{kind}_?*")


def main():
    ranks = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    assert vtkMultiProcessController.GetGlobalController().GetNumberOfProcesses() == ranks
    load_plugin()
    kind = "vtp" if ranks == 1 else "pvtp"
    test_a_static_scene_stays_as_it_is()
    test_sweeps()
    test_a_moving_scene()
    test_a_sensor_that_drives()
    test_saving_every_step(kind)


if __name__ == "__main__":
    main()
