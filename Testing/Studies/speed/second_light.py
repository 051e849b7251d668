#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What paths over two reflections cost at eight places: processor time of a scan with two reflections over that with one.

    second_light.py [--turns N] [--factor F]

Airport16 with its columns F times as far apart; the median of N pairs of scans, taken by turns. At four places every surface is
a mirror as glass or sheet metal is (kd 0.05, ks 0.6, kp 3000; assumed), so that all of them pass light on. PYTHONPATH names the
Python package of the build; the sceneries that are not part of the repository are scene files in AVIANLIDAR_SCENES_DIR
(default: build/paraview/Testing/Scenes), and a place without its file is left out, and named."""
import argparse
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "Golden"))
from golden import al, scene_files, surfaces_of  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkDataObjectTreeIterator  # noqa: E402

# Scene, position of the lidar (m), whether all surfaces are mirrors. Chosen among 48 places drawn at random for the largest factors.
PLACES = [("shanghai_cbd", (1429.6, -84.3, 3.0), False), ("shanghai_cbd", (1429.6, -84.3, 3.0), True),
          ("zsss_structures", (0.0, 0.0, 3.0), False), ("zsss_structures", (0.0, 0.0, 3.0), True),
          ("ingolstadt", (0.0, 0.0, 3.0), False), ("ingolstadt", (0.0, 0.0, 3.0), True),
          ("zsss_all", (437.2, 659.7, 3.0), False), ("phnl", (0.0, 0.0, 2.82), True)]
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
    tree.SetInputDataObject(surfaces)
    tree.Update()
    return tree


def scan(tree, position, reflections, factor):
    """Seconds of the processor, and echoes."""
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
    return time.process_time() - begin, echoes.GetOutput().GetNumberOfPoints()


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--factor", type=float, default=4.0)
    options = parser.parse_args(argv)
    print("scene              place                  mirrors  one, ms  two, ms  factor  echoes")
    for name, position, mirrors in PLACES:
        file = scene_files()[name]
        if not file.exists():
            print(f"{name}: left out, {file} is not there")
            continue
        tree = tree_of(name, file, mirrors)
        pairs = []
        for _ in range(options.turns):
            one, two = (scan(tree, position, reflections, options.factor) for reflections in (1, 2))
            pairs.append((two[0] / one[0], one[0], two[0], two[1]))
        one, two = (1000.0 * min(pair[k] for pair in pairs) for k in (1, 2))
        print(f"{name:18s} {str(position):22s} {'yes' if mirrors else 'no':7s} {one:8.1f} {two:8.1f} "
              f"{statistics.median(pair[0] for pair in pairs):7.2f} {pairs[0][3]:7d}", flush=True)


if __name__ == "__main__":
    main()
