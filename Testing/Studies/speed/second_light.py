# SPDX-License-Identifier: BSD-3-Clause
"""What paths with two reflections cost at eight places: processor time of a scan with two reflections over that with one.

    Testing/Studies/run.py second_light

Airport16 with its columns --factor times as far apart; the median of --turns pairs of scans, taken by turns. At four places every
surface is a mirror as glass or sheet metal is (kd 0.05, ks 0.6, kp 3000; assumed), so that all of them pass light on. The sceneries
that are not part of the repository are scene files in AVIANLIDAR_SCENES_DIR (default: build/paraview/Testing/Scenes), and a place
without its file is left out.
"""
import pathlib
import statistics
import sys
import time

from vtkmodules.vtkCommonDataModel import vtkDataObjectTreeIterator

import tools
from avianlidar import vtkAvianLidar as al
from running import above_zero, argument, made, study, whole

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "Golden"))
from golden import scene_files, surfaces_of  # noqa: E402

# Name in the table, scene, position of the lidar (m), whether all surfaces are mirrors. Chosen among 48 places drawn at random for the
# largest factors.
PLACES = [(title, scene, position, mirrors) for title, scene, position, materials in (
    ("Shanghai, centre, (1430, -84) m", "shanghai_cbd", (1429.6, -84.3, 3.0), (False, True)),
    ("Hongqiao, structures, origin", "zsss_structures", (0.0, 0.0, 3.0), (False, True)),
    ("Ingolstadt, origin", "ingolstadt", (0.0, 0.0, 3.0), (False, True)),
    ("Hongqiao, everything, (437, 660) m", "zsss_all", (437.2, 659.7, 3.0), (False,)),
    ("Honolulu, origin", "phnl", (0.0, 0.0, 2.82), (True,))) for mirrors in materials]
MIRROR = {"kd": 0.05, "ks": 0.6, "kp": 3000.0}


def tree_of(name, file, mirrors):
    surfaces, _ = surfaces_of(name, file)
    if mirrors:
        leaves = vtkDataObjectTreeIterator()
        leaves.SetDataSet(surfaces)
        leaves.InitTraversal()
        while not leaves.IsDoneWithTraversal():
            for array, value in MIRROR.items():
                leaves.GetCurrentDataObject().GetCellData().GetArray(array).Fill(value)
            leaves.GoToNextItem()
    tree = al.vtkAvianLidarCollisionTree()
    made(tree, InputDataObject=surfaces)
    return tree


def scan(tree, position, reflections, factor):
    """Seconds of the processor."""
    source, echoes = al.vtkAvianLidarBeamSource(), al.vtkAvianLidarEchoFilter()
    source.SetPresetToAirport16()
    source.SetAzimuthStep(source.GetAzimuthStep() * factor)
    source.SetPosition(*position)
    source.Update()
    echoes.SetNumberOfThreads(1)
    echoes.SetNumberOfReflections(reflections)
    echoes.SetInputConnection(0, source.GetOutputPort())
    echoes.SetInputConnection(1, tree.GetOutputPort())
    echoes.AddObserver("WarningEvent", lambda *_: None)  # faces that coincide in what others drew
    begin = time.process_time()
    echoes.Update()
    return time.process_time() - begin


@study(argument("--turns", type=whole(1, 1000), default=5, help="pairs of scans of each place, default 5"),
       argument("--factor", type=above_zero, default=4.0, help="step of azimuth, default 4 times the sensor's"))
def main(options):
    rows = []
    for title, name, position, mirrors in PLACES:
        file = scene_files()[name]
        if file.exists():
            tree = tree_of(name, file, mirrors)
            pairs = [[scan(tree, position, reflections, options.factor) for reflections in (1, 2)] for _ in range(options.turns)]
            rows.append((title, "yes" if mirrors else "no", *(f"{1000 * min(times):.0f}" for times in zip(*pairs)),
                         f"{statistics.median(two / one for one, two in pairs):.1f}"))
    tools.leave(options.out, "second-light", ("place", "mirrors", "one, ms", "two, ms", "factor"), rows, 2)
