# SPDX-License-Identifier: BSD-3-Clause
"""What paths with two and three reflections cost at eight places: processor time of a scan over that with one
reflection. Three reflections need an aperture, so their column is of Search905's receiver.

    Testing/Studies/run.py second_light

Airport16 with its columns --factor times as far apart; the median of --turns rounds of scans, taken by turns. At four
places every surface is a mirror as glass or sheet metal is (kd 0.05, ks 0.6, kp 3000; assumed), so that all of them
pass light on. The sceneries that are not part of the repository are scene files in AVIANLIDAR_SCENES_DIR, and a place
without its file is left out.
"""
import statistics
import time

import tools
import trade_runs
from avianlidar import vtkAvianLidar as al
from avianlidar._cloud import leaves_of
from running import above_zero, argument, built_scene, made, study, whole

# Name in the table, scene, position of the lidar (m), whether all surfaces are mirrors. Chosen among 48 places drawn at
# random for the largest factors.
PLACES = [(title, scene, position, mirrors) for title, scene, position, materials in (
    ("Shanghai, centre, (1430, -84) m", "shanghai_cbd", (1429.6, -84.3, 3.0), (False, True)),
    ("Hongqiao, structures, origin", "zsss_structures", (0.0, 0.0, 3.0), (False, True)),
    ("Ingolstadt, origin", "ingolstadt", (0.0, 0.0, 3.0), (False, True)),
    ("Hongqiao, everything, (437, 660) m", "zsss_all", (437.2, 659.7, 3.0), (False,)),
    ("Honolulu, origin", "phnl", (0.0, 0.0, 2.82), (True,))) for mirrors in materials]
MIRROR = {"kd": 0.05, "ks": 0.6, "kp": 3000.0}


def tree_of(file, mirrors):
    surfaces, *_ = trade_runs.scene_of(file)
    for block in leaves_of(surfaces) if mirrors else ():
        for array, value in MIRROR.items():
            block.GetCellData().GetArray(array).Fill(value)
    tree = al.vtkAvianLidarCollisionTree()
    made(tree, InputDataObject=surfaces)
    return tree


def scan(tree, position, reflections, factor, preset="Airport16"):
    """Seconds of the processor."""
    source, echoes = al.vtkAvianLidarBeamSource(), al.vtkAvianLidarEchoFilter()
    getattr(source, f"SetPresetTo{preset}")()
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
        if built_scene(name):
            tree = tree_of(built_scene(name), mirrors)
            rounds = [[scan(tree, position, *kind) for kind in ((1, options.factor), (2, options.factor),
                                                                (1, options.factor, "Search905"),
                                                                (3, options.factor, "Search905"))]
                      for _ in range(options.turns)]
            one, two, open_one, open_three = zip(*rounds)
            rows.append((title, "yes" if mirrors else "no", *(f"{1000 * min(times):.0f}" for times in (one, two)),
                         *(f"{statistics.median(more / less for less, more in zip(*both)):.1f}"
                           for both in ((one, two), (open_one, open_three)))))
    tools.leave(options.out, "second-light", ("place", "mirrors", "one, ms", "two, ms", "factor",
                                              "three by one, Search905"), rows, 2)
