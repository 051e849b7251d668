# SPDX-License-Identifier: BSD-3-Clause
"""The paper's protocol of Sec. 5.2 without a real scan: a dense scan of the corridor, thinned 22 times along azimuth,
against the scan of 2 by 2 degrees. Both clouds come from one model, so all of their difference is sampling: the floor
below which no simulator comes. Leaves a table.

    Testing/Studies/run.py protocol
"""
import fnmatch

import numpy as np

from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import corridor_scene
import running
import tools
from running import argument, column, study, whole

DENSE_STEP, STEP, THINNING = 0.09, 2.0, 22  # degrees, degrees, times (paper, Sec. 5.2)

# The areas of Fig. 13 to 15: objects of the corridor from x to x in metres. How much borders
# matter is seen from the end wall with and without the walls beside it, and from the near part of the corridor.
_END = ("Near end", "Door", "Window of the door", "Hydrant cabinet")
_LONG = ("North wall", "Bulletin board", "South wall", "Door at*", "Floor", "Ceiling", "Far end")
AREAS = {"door": (_END, -np.inf, np.inf),
         "door and 1 m of the side walls": (_END + _LONG, -np.inf, corridor_scene.WEST + 1),
         "stairwell": (("Steps", "Stairwell", "Handrail*"), -np.inf, np.inf),
         "corridor": (_LONG, 0.9, np.inf), "corridor, its first 8 m": (_LONG, 0.9, 8)}

# What the paper measures between its real and its simulated cloud: Hausdorff distance, RMSE.
PAPER = {"door": (0.164, 0.04), "stairwell": (0.908, 0.33), "corridor": (0.373, 0.10)}


def paper_of(area):
    return next(numbers for name, numbers in PAPER.items() if area.startswith(name))


def scan(tree, step, yaw, seed, mode):
    """The echoes of CorridorC16 with another step of azimuth, turned by `yaw` degrees: places, columns, and for each area
    whether they belong to it."""
    sensor = vtkAvianLidarBeamSource()
    sensor.SetPresetToCorridorC16()
    running.set_all(sensor, {"Position": corridor_scene.LIDAR, "Orientation": (yaw, 0, 0), "AzimuthStep": step,
                             "RotationRate": 0.1})  # slow enough for 4,000 columns; nothing moves
    echoes = running.scanned(sensor, tree, AttenuationCoefficient=corridor_scene.HAZE, Seed=seed, ReturnMode=mode).GetOutput()
    places, names = echoes.GetPoints().GetData(), tools.strings(echoes, "object_names")
    places, beams, objects = np.array(places), column(echoes, "beam_id"), column(echoes, "object_id")
    within = {}
    for area, (patterns, west, east) in AREAS.items():
        mine = [i for i, name in enumerate(names) if any(fnmatch.fnmatchcase(name, one) for one in patterns)]
        within[area] = np.isin(objects, mine) & (places[:, 0] >= west) & (places[:, 0] <= east)
    return places, beams // sensor.GetNumberOfChannels(), within


def measure(seeds, mode=Filter.RETURN_MODE_ALL):
    """{area: array of (points of the thinned scan, of the simulation, Hausdorff, RMSE), a row for each seed and phase}."""
    tree = vtkAvianLidarCollisionTree()
    tree.SetInputDataObject(corridor_scene.build())
    rows = {area: [] for area in AREAS}
    for seed in range(seeds):
        yaw = STEP * seed / seeds  # where columns meet the walls is chance, too
        dense, column, of_dense = scan(tree, DENSE_STEP, yaw, 2 * seed, Filter.RETURN_MODE_ALL)
        simulated, _, of_simulated = scan(tree, STEP, yaw, 2 * seed + 1, mode)
        for area in AREAS:
            there = simulated[of_simulated[area]]
            for phase in range(THINNING):
                here = dense[of_dense[area] & (column % THINNING == phase)]
                found = running.apart(there, here)  # Eq. 19, and Eq. 20 as corrected: from the actual to the simulated points
                rows[area].append((len(here), len(there), found.GetHausdorffDistance(), found.GetRMSEReferenceToSimulated()))
    return {area: np.array(values) for area, values in rows.items()}


def table(found, units):
    """Head and rows: for each area the floor, the paper's number, and their ratio."""
    rows = []
    for area, values in found.items():
        for i, what in enumerate(("Hausdorff distance (m)", "RMSE (m)")):
            floor, paper = values[:, 2 + i], paper_of(area)[i]
            rows.append((f"{area}: {what}", f"{floor.mean():.3f}", f"{floor.min():.3f}", f"{floor.max():.3f}", f"{paper:g}",
                         f"{100 * floor.mean() / paper:.0f} %", f"{units[area][:, 2 + i].mean():.3f}"))
    return ("", "sampling floor, mean", "least", "most", "the paper", "floor / paper", "a point per range unit"), rows


@study(argument("--seeds", type=whole(1, 1000), default=5, help="of the random numbers, default 5"))
def main(options):
    found, units = measure(options.seeds), measure(options.seeds, Filter.RETURN_MODE_RANGE_UNITS)
    tools.leave(options.out, "table", *table(found, units))
    return found, units
