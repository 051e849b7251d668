# SPDX-License-Identifier: BSD-3-Clause
"""Time through the plugin: the time keeper knows the steps, the animation goes through them, a static scene without
steps to play stays as it is, series of files move, and what is saved says which revolution it is of.

Run by pvpython in one process and by pvbatch on two ranks (the argument)."""

import glob
import os
import shutil
import sys

import numpy
from paraview import servermanager, simple
from vtkmodules.vtkParallelCore import vtkMultiProcessController

from plugin_testing import OUTPUT_DIR, airport, arrays_of, assert_same, fetch, load_plugin

COLUMNS = 120
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
info = self.GetOutputInformation(0)
executive = self.GetExecutive()
steps = [float(step) for step in range(0, 11)]
info.Remove(executive.TIME_STEPS())
for step in steps:
    info.Append(executive.TIME_STEPS(), step)
info.Remove(executive.TIME_RANGE())
info.Append(executive.TIME_RANGE(), steps[0])
info.Append(executive.TIME_RANGE(), steps[-1])
"""


def count(proxy, port=0):
    proxy.UpdatePipeline(simple.GetAnimationScene().TimeKeeper.Time)
    return proxy.GetDataInformation(port).GetNumberOfPoints()


def fresh():
    simple.ResetSession()
    load_plugin()


def remove(names):
    if vtkMultiProcessController.GetGlobalController().GetLocalProcessId() == 0:
        for name in names:
            shutil.rmtree(name) if os.path.isdir(name) else os.remove(name)


def frames_of(scene, look):
    """What `look` sees at each frame while the animation plays."""
    seen = []
    scene.GoToFirst()
    for _ in range(len(scene.TimeKeeper.TimestepValues) or scene.NumberOfFrames):
        seen.append(look())
        scene.GoToNext()
    return seen


def test_a_static_scene_stays_as_it_is():
    """Without steps to play an animation of a camera has its ten frames, all of them the same scan."""
    fresh()
    _, _, _, echoes = airport(COLUMNS)
    before = fetch(echoes)
    scene = simple.GetAnimationScene()
    assert not scene.TimeKeeper.TimestepValues, scene.TimeKeeper.TimestepValues
    scene.UpdateAnimationUsingDataTimeSteps()
    assert scene.PlayMode == "Sequence", scene.PlayMode
    assert scene.NumberOfFrames == 10 and (scene.StartTime, scene.EndTime) == (0.0, 1.0), (
        scene.NumberOfFrames, scene.StartTime, scene.EndTime)
    echoes.UpdatePipeline(0.7)
    assert echoes.GetPropertyValue("NumberOfTracedRays") is not None
    assert_same(fetch(echoes), before)


def test_playing_sweeps():
    fresh()
    _, _, beams, echoes = airport(COLUMNS)
    whole = fetch(echoes)
    beams.NumberOfRevolutions = 2
    beams.StepsPerRevolution = 6
    beams.UpdatePipelineInformation()
    steps = [(k + j / 6) / 0.5 for k in range(2) for j in range(6)]
    assert list(beams.TimestepValues) == steps, beams.TimestepValues
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    assert list(scene.TimeKeeper.TimestepValues) == steps
    assert scene.PlayMode == "Snap To TimeSteps", scene.PlayMode
    assert (scene.StartTime, scene.EndTime) == (0.0, steps[-1])
    seen = frames_of(scene, lambda: (scene.TimeKeeper.Time, count(beams), count(beams, 1), count(echoes), count(echoes, 1)))
    assert [frame[0] for frame in seen] == steps, [frame[0] for frame in seen]
    for number, (_, fired, rays, received, report) in enumerate(seen):
        assert fired == report == COLUMNS * 16 * (number % 6 + 1) // 6, seen
        assert rays == 2 * fired, (number, rays, fired)
    counts = [frame[3] for frame in seen]
    assert 0 < counts[1] < counts[2] < counts[5] == len(whole["energy"]) and counts[:6] == counts[6:], counts
    # Played by ParaView itself.
    view = simple.CreateRenderView()
    simple.Show(echoes, view)
    scene.ViewModules = [view]
    scene.GoToFirst()
    scene.Play()
    assert scene.TimeKeeper.Time == steps[-1]
    found = fetch(echoes)
    numpy.testing.assert_allclose(found.pop("timestamp"), whole.pop("timestamp") + 2e6, rtol=1e-12)
    assert_same(found, whole)


def test_an_image_sweeps_beside_its_echoes():
    """Sensor, echoes and image in one view: the image is the whole scan at every step, filled as far as it was fired."""
    fresh()
    _, _, beams, echoes = airport(COLUMNS)
    beams.StepsPerRevolution = 6
    image = simple.AvianLidarRangeImage(Echoes=echoes, Beams=simple.OutputPort(echoes, 1))
    view = simple.CreateRenderView()
    for shown in (beams, echoes, image):
        simple.Show(shown, view)
    simple.ColorBy(simple.GetDisplayProperties(image, view), ("POINTS", "status"))
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.ViewModules = [view]

    def look():
        simple.Render(view)
        report = echoes.GetDataInformation(1).GetNumberOfPoints()
        extent = tuple(image.GetDataInformation().GetExtent())
        status = image.PointData["status"].GetRange()
        return extent, report, status[0]

    seen = frames_of(scene, look)
    assert [frame[0] for frame in seen] == [(0, COLUMNS - 1, 0, 15, 0, 0)] * 6, seen
    assert [frame[1] for frame in seen] == [COLUMNS * 16 * (step + 1) // 6 for step in range(6)], seen
    assert [frame[2] >= 0 for frame in seen] == [False] * 5 + [True], seen


def moving():
    source = simple.ProgrammableSource(
        OutputDataSetType="vtkPolyData", Script=MOVING, ScriptRequestInformation=STEPS)
    walls = simple.AvianLidarMaterial(Input=source)
    beams = simple.AvianLidarCorridorC16(RotationRate=0.5, NumberOfRevolutions=3, StepsPerRevolution=2)
    echoes = simple.AvianLidarEchoFilter(
        Beams=simple.Transform(Input=beams), Surfaces=simple.AvianLidarCollisionTree(Input=walls))
    return source, beams, echoes


def nearest(echoes):
    echoes.UpdatePipeline(simple.GetAnimationScene().TimeKeeper.Time)
    return echoes.PointData["distance_m"].GetRange()[0]


def test_a_moving_scene_is_sampled_at_each_revolution():
    fresh()
    _, _, echoes = moving()
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = sorted(set(range(11)) | {0.0, 1.0, 2.0, 3.0, 4.0, 5.0})
    assert list(scene.TimeKeeper.TimestepValues) == times, scene.TimeKeeper.TimestepValues
    for time, distance in zip(times, frames_of(scene, lambda: nearest(echoes))):
        assert abs(distance - 50 - 2 * (time // 2)) < 0.01, (time, distance)


def test_one_scan_leaves_the_steps_of_others_alone():
    """A sensor with nothing to play adds no step to those of data, and follows them."""
    fresh()
    source = simple.ProgrammableSource(
        OutputDataSetType="vtkPolyData", Script=MOVING, ScriptRequestInformation=STEPS.replace("range(0", "range(5"))
    source.UpdatePipelineInformation()
    beams = simple.AvianLidarAirport16()
    beams.UpdatePipelineInformation()
    echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=simple.AvianLidarMaterial(Input=source))
    echoes.UpdatePipelineInformation()
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = [5.0, 6.0, 7.0, 8.0, 9.0, 10.0]
    assert list(scene.TimeKeeper.TimestepValues) == times, scene.TimeKeeper.TimestepValues
    assert (scene.StartTime, scene.EndTime) == (5.0, 10.0), (scene.StartTime, scene.EndTime)
    for time, distance in zip(times, frames_of(scene, lambda: nearest(echoes))):
        assert abs(distance - 50 - 2 * (time // 2)) < 0.01, (time, distance)


def test_saving_every_step(kind):
    """Save Data with "Write timesteps as file-series" leaves a file for each step of the sensor."""
    fresh()
    _, _, echoes = moving()
    stem = os.path.join(OUTPUT_DIR, f"TestAnimation-{kind}")
    label = "Writetimestepsasfileseries" if kind == "vtp" else "Writealltimestepsasfileseries"
    simple.SaveData(f"{stem}.{kind}", proxy=echoes, DataMode="Binary", **{label: 1})
    files = [f"{stem}_{step}.{kind}" for step in range(6)]
    assert sorted(glob.glob(f"{stem}_?.{kind}")) == files, glob.glob(f"{stem}*")
    fresh()
    for step, file in enumerate(files):
        back = simple.OpenDataFile(file)
        back.UpdatePipeline()
        assert back.FieldData["revolution"].GetRange()[0] == step // 2
        assert abs(back.PointData["distance_m"].GetRange()[0] - 50 - 2 * (step // 2)) < 0.01
        simple.Delete(back)
    if kind == "vtp":
        series = simple.OpenDataFile(files)
        assert list(series.TimestepValues) == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], series.TimestepValues
    remove(glob.glob(f"{stem}_?*"))


def test_a_series_of_files_is_a_moving_scene(kind):
    fresh()
    names = []
    for k in range(3):
        box = simple.Box(XLength=40, YLength=2, ZLength=40, Center=[0, 51 + 5 * k, 0])
        box.UpdatePipeline()
        names.append(os.path.join(OUTPUT_DIR, f"TestAnimationBox_{k}.{kind}"))
        simple.SaveData(names[-1], proxy=simple.ExtractSurface(Input=box), DataMode="Binary")
    reader = simple.OpenDataFile(names)
    beams = simple.AvianLidarCorridorC16(RotationRate=1, FiringInterval=1e-6, NumberOfRevolutions=3)
    echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=simple.AvianLidarMaterial(Input=reader))
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    seen = frames_of(scene, lambda: nearest(echoes))
    assert [round(distance, 1) for distance in seen] == [50.0, 55.0, 60.0], seen
    remove(glob.glob(os.path.join(OUTPUT_DIR, "TestAnimationBox_?*")))


def test_a_clutter_filter_learns_while_it_plays(kind):
    """A ball that stands and one that moves, whatever executes again meanwhile."""
    fresh()
    names = []
    for k in range(4):
        balls = [simple.Sphere(Radius=2, Center=center) for center in ([-30, 60, 0], [30, 60 + 12 * k, 0])]
        group = simple.AppendDatasets(Input=balls)
        group.UpdatePipeline()
        names.append(os.path.join(OUTPUT_DIR, f"TestAnimationClutter_{k}.{kind}"))
        simple.SaveData(names[-1], proxy=group, DataMode="Binary")
    cloud = simple.OpenDataFile(names)
    clutter = simple.AvianLidarClutterFilter(Input=cloud, WarmUp=0)
    view = simple.CreateRenderView()
    for port in (0, 1):
        simple.Show(simple.OutputPort(clutter, port), view)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    scene.ViewModules = [view]

    def look():
        simple.Render(view)
        clutter.ClutterThreshold = 0.05 if clutter.ClutterThreshold == 0.06 else 0.06  # executes again
        clutter.UpdatePipeline(scene.TimeKeeper.Time)
        return (*clutter.PointData["clutter_probability"].GetRange(), clutter.FieldData["learned_scans"].GetRange()[0])

    assert frames_of(scene, look) == [(0.0, float(k > 0), k + 1.0) for k in range(4)], look()
    scene.GoToFirst()
    assert look() == (0.0, 0.0, 1.0)
    remove(glob.glob(os.path.join(OUTPUT_DIR, "TestAnimationClutter_?*")))


def main():
    ranks = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    assert vtkMultiProcessController.GetGlobalController().GetNumberOfProcesses() == ranks
    load_plugin()
    kind = "vtp" if ranks == 1 else "pvtp"
    test_a_static_scene_stays_as_it_is()
    test_playing_sweeps()
    test_an_image_sweeps_beside_its_echoes()
    test_a_moving_scene_is_sampled_at_each_revolution()
    test_one_scan_leaves_the_steps_of_others_alone()
    test_saving_every_step(kind)
    test_a_series_of_files_is_a_moving_scene(kind)
    test_a_clutter_filter_learns_while_it_plays(kind.replace("vtp", "vtu"))


if __name__ == "__main__":
    main()
