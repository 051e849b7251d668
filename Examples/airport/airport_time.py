#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft rolls past the lidar while that turns: plays a scan in steps, revolution by revolution. The airport stands
still and is traced once; the aircraft is a mover, which each beam meets where it is at the beam's own time. Leaves one
.vtp of echoes per step, a table of the revolutions (time.md) and two pictures: sweep.png, a scan that is not finished,
and revolutions.png, the aircraft's echoes in all revolutions.

    airport_time.py --out build/time
    airport_time.py --revolutions 10 --steps 36 --speed 70

ParaView opens the files as one series (echoes_..vtp). PYTHONPATH has to name the Python package
(`cat build/paraview/python-path`), pictures need a display (`xvfb-run -a`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkAppendPolyData
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from avianlidar import mover
from avianlidar.vtkAvianLidar import (vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter,
                                      vtkAvianLidarHSBColorMap, vtkAvianLidarMaterial)

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402

AIRCRAFT = "Aircraft"
BOXES = ((-2, 2, -19, 19, 2, 6), (-17, 17, -3, 3, 2.5, 3.2), (-0.3, 0.3, -19, -14, 6, 12))  # hull, wings, tail; m


def aircraft(x=0.0, y=0.0):
    """Boxes of the paper's metal; m east and north of the origin of its frame."""
    whole = vtkAppendPolyData()
    for x0, x1, y0, y1, z0, z1 in BOXES:
        box = vtkCubeSource()
        box.SetBounds(x + x0, x + x1, y + y0, y + y1, z0, z1)
        box.SetOutputPointsPrecision(1)
        box.Update()
        whole.AddInputData(box.GetOutput())
    paint = vtkAvianLidarMaterial()
    paint.SetInputConnection(whole.GetOutputPort())
    paint.SetMaterialToMetal()
    paint.SetNameOfObject(AIRCRAFT)
    paint.Update()
    return paint.GetOutput()


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=running.file, default=HERE / "scene" / "hongqiao.lidarscene.json",
                        help="a .lidarscene.json file; default: Shanghai Hongqiao")
    parser.add_argument("--revolutions", type=running.whole(1, 10000), default=6, help="of 2 s, default 6")
    parser.add_argument("--steps", type=running.whole(1, 960), default=12, help="of a revolution, default 12")
    parser.add_argument("--speed", type=running.above_zero, default=40.0, help="of the aircraft, m/s, default 40")
    running.add_arguments(parser, "build/time")
    return running.parse(parser, argv)


def start_of(scene):
    """240 m south and 100 m west of the lidar."""
    lidar = scene.GetFieldData().GetArray("lidar_position")
    x, y, _ = lidar.GetTuple(0) if lidar else (0, 0, 0)
    return x - 100, y - 240


def rolling(start, speed, seconds):
    """The aircraft as a mover: north at `speed`, in a straight line between two poses."""
    x, y = start
    return mover(aircraft(), [(x, y, 0), (x, y + speed * seconds, 0)], times=[0, seconds])


def pipeline(scene, options):
    """(echoes in their colours, the echo filter)."""
    sensor = vtkAvianLidarBeamSource()
    if scene.GetFieldData().GetArray("lidar_position"):
        sensor.SetPosition(scene.GetFieldData().GetArray("lidar_position").GetTuple(0))
    sensor.SetNumberOfRevolutions(options.revolutions)
    sensor.SetStepsPerRevolution(options.steps)
    tree = vtkAvianLidarCollisionTree()
    tree.SetInputData(scene)
    lidar = vtkAvianLidarEchoFilter()
    lidar.SetInputConnection(0, sensor.GetOutputPort())
    lidar.SetSurfacesConnection(tree.GetOutputPort())
    lidar.SetMoversData(rolling(start_of(scene), options.speed, options.revolutions / sensor.GetRotationRate()))
    lidar.SetRaysPerBeam(options.rays)
    lidar.SetSeed(options.seed)
    lidar.SetNumberOfThreads(options.threads)
    colors = vtkAvianLidarHSBColorMap()
    colors.SetInputConnection(lidar.GetOutputPort())
    return colors, lidar


def play(colors, lidar, folder):
    """Every step: (time, echoes, (beams whose static surfaces were traced, beams that the aircraft may touch)); a file
    of each."""
    colors.UpdateInformation()
    information = colors.GetOutputInformation(0)
    key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    frames = []
    for number, time in enumerate([information.Get(key, i) for i in range(information.Length(key))]):
        information.Set(vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP(), time)
        running.update(colors)
        echoes = vtkPolyData()
        echoes.ShallowCopy(colors.GetOutputDataObject(0))
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(folder / f"echoes_{number:04d}.vtp"))
        writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
        writer.SetInputData(echoes)
        writer.Write()
        frames.append((time, echoes, (int(lidar.GetNumberOfTracedBeams()), int(lidar.GetNumberOfTouchedBeams()))))
    return frames


def of_aircraft(echoes):
    """Which echoes are the aircraft's."""
    names = echoes.GetFieldData().GetAbstractArray("object_names")
    number = [names.GetValue(i) for i in range(names.GetNumberOfValues())].index(AIRCRAFT)
    return vtk_to_numpy(echoes.GetPointData().GetArray("object_id")) == number


def seconds_of(echoes):
    """When the aircraft's echoes were fired: the median, s; None without any."""
    timestamps = vtk_to_numpy(echoes.GetPointData().GetArray("timestamp"))[of_aircraft(echoes)]
    return 1e-6 * float(np.median(timestamps)) if len(timestamps) else None


def table_of(frames, options):
    """What each revolution saw of the aircraft, as Markdown."""
    rows = ["| revolution | start, s | echoes | of the aircraft | fired at, s | their middle, m north of the lidar | "
            "static beams traced | beams that the aircraft may touch |",
            "|---|---:|---:|---:|---:|---:|---:|---:|"]
    for revolution in range(options.revolutions):
        steps = frames[revolution * options.steps:(revolution + 1) * options.steps]
        time, whole, (_, touched) = steps[0][0], *steps[-1][1:]
        lidar = whole.GetFieldData().GetArray("position").GetTuple(0)
        north = vtk_to_numpy(whole.GetPoints().GetData())[of_aircraft(whole), 1] - lidar[1]
        middle = str(round(0.5 * (north.min() + north.max()))) if len(north) else "-"
        fired = f"{seconds_of(whole):.2f}" if len(north) else "-"
        rows.append(f"| {revolution} | {time:g} | {whole.GetNumberOfPoints()} | {len(north)} | {fired} | {middle} | "
                    f"{sum(traced for _, _, (traced, _) in steps)} | {touched} |")
    return "\n".join(rows) + "\n"


def draw(scene, frames, options):
    """sweep.png, in the middle of the third revolution or of the last; revolutions.png."""
    import pictures  # only here: numbers need no display
    import views
    words = f"Airport16, {options.rays} rays per beam"
    shapes = views.plan(scene)
    revolution = min(2, options.revolutions - 1)
    step = min(options.steps - 1, options.steps * 2 // 3 - 1 if options.steps > 1 else 0)
    time, echoes, _ = frames[revolution * options.steps + step]
    last = frames[revolution * options.steps + options.steps - 1][1]
    bounds = views.around(views.site(scene, last), 0.03)
    title = f"A sweep, {time:.2f} s: {step + 1} of {options.steps} steps of revolution {revolution}"
    views.from_above(shapes, echoes, title, words, bounds, 7).save(options.out / "sweep.png")

    seen = vtkAppendPolyData()
    for number in range(options.revolutions):
        seen.AddInputData(frames[(number + 1) * options.steps - 1][1])
    seen.Update()
    alone = vtkPolyData()
    alone.ShallowCopy(seen.GetOutput())
    alone.GetFieldData().ShallowCopy(last.GetFieldData())
    x, y = start_of(scene)
    way = options.speed * frames[-1][0]
    picture = views.from_above(shapes, alone, f"An aircraft at {options.speed:g} m/s in {options.revolutions} revolutions",
                               words, (x - 90, x + 90 + way / 3, y - 40, y + way + 40), 7)
    for number in range(options.revolutions):
        seconds = seconds_of(frames[(number + 1) * options.steps - 1][1])
        if seconds is not None:  # where it was when it was seen
            at = y + options.speed * seconds
            picture.outlines(pictures.edges(aircraft(x, at)))
            picture.label((x + 30, at + 12), f"{seconds:.2f} s", "left")
    picture.save(options.out / "revolutions.png")


def main(argv=None):
    options = arguments(argv)
    scene = running.read_scene(options.scene).GetOutput()
    colors, lidar = pipeline(scene, options)
    options.out.mkdir(parents=True, exist_ok=True)
    frames = play(colors, lidar, options.out)
    table = table_of(frames, options)
    (options.out / "time.md").write_text(table, encoding="utf-8")
    print(table)
    if not options.no_pictures:
        draw(scene, frames, options)
    return frames


if __name__ == "__main__":
    main()
