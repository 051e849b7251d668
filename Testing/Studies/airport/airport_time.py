# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft rolls past the lidar while that turns: plays a scan in steps, revolution by revolution. The airport stands
still and is traced once; the aircraft is a mover, which each beam meets where it is at the beam's own time. Leaves a table of
the revolutions (time.md) and a picture, revolutions.png, of the aircraft's echoes in all of them.

    Testing/Studies/run.py airport_time
    Testing/Studies/run.py airport_time --revolutions 10 --steps 36 --speed 70
"""
import numpy as np
from matplotlib.collections import LineCollection
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
import running
import tools
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter
from running import BOX, BOX_SIDES, argument, set_all, study, whole

AIRCRAFT = "Aircraft"
BOXES = ((-2, 2, -19, 19, 2, 6), (-17, 17, -3, 3, 2.5, 3.2), (-0.3, 0.3, -19, -14, 6, 12))  # hull, wings, tail; m
PERIOD = 2.0  # s, of a revolution


def aircraft():
    """Boxes of the paper's metal, m east and north of the origin of its frame."""
    low, high = np.reshape(BOXES, (-1, 1, 3, 2)).transpose(3, 0, 1, 2)
    faces = (8 * np.arange(len(BOXES))[:, None, None] + BOX_SIDES).reshape(-1, 3)
    return al.Scene((low + (high - low) * BOX).reshape(-1, 3), faces, material="Metal", name=AIRCRAFT).surfaces.GetBlock(0)


def play(scene, options):
    """Every step: (time, echoes, (beams whose static surfaces were traced, beams that the aircraft may touch))."""
    sensor = al.Sensor("Airport16", position=scene.lidar_position, number_of_revolutions=options.revolutions,
                       steps_per_revolution=options.steps)
    x, y = start_of(scene)
    end = options.revolutions * PERIOD
    way = al.mover(aircraft(), [(x, y, 0), (x, y + options.speed * end, 0)], times=[0, end])
    lidar = set_all(vtkAvianLidarEchoFilter(), {"MoversData": way, "RaysPerBeam": options.rays})
    lidar.SetInputConnection(0, sensor.algorithm.GetOutputPort())
    lidar.SetSurfacesConnection(scene.tree.GetOutputPort())
    for number in range(options.revolutions * options.steps):
        time = number * PERIOD / options.steps
        lidar.UpdateTimeStep(time)
        data = lidar.GetOutput().NewInstance()
        data.DeepCopy(lidar.GetOutput())
        echoes = al.Cloud(data).annotated()
        yield time, echoes, (int(lidar.GetNumberOfTracedBeams()), int(lidar.GetNumberOfTouchedBeams()))


def start_of(scene):
    """240 m south and 100 m west of the lidar."""
    return scene.lidar_position[0] - 100, scene.lidar_position[1] - 240


def of_aircraft(echoes):
    """Which echoes are the aircraft's."""
    return echoes["object_id"] == tools.strings(echoes.data, "object_names").index(AIRCRAFT)


def seconds_of(echoes):
    """When the aircraft's echoes were fired: the median, s; None without any."""
    timestamps = echoes["timestamp"][of_aircraft(echoes)]
    return 1e-6 * float(np.median(timestamps)) if len(timestamps) else None


def rows_of(frames, options):
    """What each revolution saw of the aircraft."""
    for revolution in range(options.revolutions):
        steps = frames[revolution * options.steps:(revolution + 1) * options.steps]
        time, whole_turn, (_, touched) = steps[0][0], *steps[-1][1:]
        north = whole_turn.points[of_aircraft(whole_turn), 1] - whole_turn.fields["position"][1]
        yield (revolution, f"{time:g}", whole_turn.number_of_points, len(north), f"{seconds_of(whole_turn):.2f}" if len(north) else "-",
               round(0.5 * (north.min() + north.max())) if len(north) else "-", sum(traced for _, _, (traced, _) in steps), touched)


def draw(scene, frames, options):
    """The aircraft's echoes in all revolutions, and its outline where it was seen."""
    ends = [frames[(number + 1) * options.steps - 1][1] for number in range(options.revolutions)]
    x, y = start_of(scene)
    way, shape = options.speed * frames[-1][0], tools.edges(aircraft())
    outline = vtk_to_numpy(shape.GetPoints().GetData())[vtk_to_numpy(shape.GetLines().GetConnectivityArray()).reshape(-1, 2), :2]
    with tools.figure(options.out / "revolutions.png", figsize=(8, 10)) as axes:
        for number, one in enumerate(ends):
            if number == 0:
                tools.from_above(axes, scene.surfaces.GetBlock(0), one, ((x - 90, x + 90 + way / 3), (y - 40, y + way + 40)), "")
            own = of_aircraft(one)
            axes.scatter(*one.points[own, :2].T, s=8, c=one["rgb"][own] / 255, zorder=3)
            axes.set_title(f"An aircraft at {options.speed:g} m/s in {options.revolutions} revolutions", loc="left")
            seconds = seconds_of(one)
            if seconds is not None:  # where it was when it was seen
                at = y + options.speed * seconds
                axes.add_collection(LineCollection(outline + (x, at), colors="black", linewidths=0.7))
                axes.text(x + 30, at + 12, f"{seconds:.2f} s")


@study(argument("--scene", type=running.file, default=running.AIRPORT, help="a .lidarscene.json file; default: Shanghai Hongqiao"),
       argument("--revolutions", type=whole(1, 10000), default=6, help="of 2 s, default 6"),
       argument("--steps", type=whole(1, 960), default=12, help="of a revolution, default 12"),
       argument("--speed", type=running.above_zero, default=40.0, help="of the aircraft, m/s, default 40"),
       argument("--rays", type=whole(1, 1000000), default=100, help="rays per beam, default 100"))
def main(options):
    scene = al.Scene(options.scene)
    frames = list(play(scene, options))
    tools.leave(options.out, "time", (
        "revolution", "start, s", "echoes", "of the aircraft", "fired at, s", "their middle, m north of the lidar", "static beams traced",
        "beams that the aircraft may touch"), list(rows_of(frames, options)))
    draw(scene, frames, options)
