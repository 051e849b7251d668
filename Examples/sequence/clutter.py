#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Scores of the clutter filter on labelled sequences: separation of birds and clutter without learning from labels.

    clutter.py build/sequences

A point counts as moving if the filter does not call the point clutter. The script prints a Markdown table. For each
subset and each set of learned scans, the table has the number of points, intersection over union (IoU), precision and
recall, for birds and for all moving objects. The score of birds leaves out points of other moving objects. The sets of
learned scans are

* the scans before: all sequences are one stream of one lidar;
* the same without a score of the first sequence;
* the scans before in the same sequence: the filter begins anew with each sequence;
* all scans of the sequence: the filter first learns all scans with equal weight, and then only the table decides.

--set Window=100 changes a property of the filter. --speed measures the processor time on random scans of 10,000 and
100,000 points instead. The points have a jitter of 0.02 m, so that points of walls keep their cells, or of 1 m
(standard deviation).
"""
import argparse
import itertools
import pathlib
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData

from avianlidar.vtkAvianLidar import vtkAvianLidarClutterFilter, vtkAvianLidarPointCloudReader

SUBSETS = ("sky", "near clutter", "through edges")
BIRD, OTHERS = 99, (252, 258, 259)  # classes of birds; of moving cars, trucks, aircraft and other vehicles
LONGEST = 100000  # length of a window with about equal weights of all scans, in scans


class Stream:
    """The clutter filter on successive files. Files without times count as successive scans."""

    def __init__(self, settings, **others):
        self.reader, self.filter = vtkAvianLidarPointCloudReader(), vtkAvianLidarClutterFilter()
        self.filter.SetInputConnection(self.reader.GetOutputPort())
        for name, value in {**settings, **others}.items():
            if not hasattr(self.filter, "Set" + name):
                raise ValueError(f"the clutter filter has no property {name}")
            getattr(self.filter, "Set" + name)(type(getattr(self.filter, "Get" + name)())(value))

    def moving(self, file):
        """For each point of a file, whether the point is not clutter."""
        self.reader.SetFileName(str(file))
        self.filter.Update()
        return vtk_to_numpy(self.filter.GetOutputDataObject(0).GetPointData().GetArray("is_clutter")) == 0

    def table(self):
        table = vtkPolyData()
        table.DeepCopy(self.filter.GetOutputDataObject(1))
        return table


def counts(file, called):
    """True positives, false positives and false negatives of each subset, for birds and for all moving objects."""
    sequence = file.parents[1]
    labels = np.fromfile(sequence / "labels" / f"{file.stem}.label", "<u4") & 0xffff
    subsets = np.fromfile(sequence / "subsets" / f"{file.stem}.subset", np.uint8)
    if not len(called) == len(labels) == len(subsets):
        raise ValueError(f"{file}: {len(called)} points, {len(labels)} labels, {len(subsets)} subsets")
    bird, other = labels == BIRD, np.isin(labels, OTHERS)
    result = np.zeros((len(SUBSETS), 2, 3), int)
    for subset in range(len(SUBSETS)):
        for which, (true, among) in enumerate(((bird, ~other), (bird | other, True))):
            here = (subsets == subset) & among
            parts = called & true, called & ~true, ~called & true
            result[subset, which] = [np.count_nonzero(here & part) for part in parts]
    return result


def measure(sequences, settings):
    """Yields each set of learned scans, and the counts of the subsets for each scored scan."""
    stream = Stream(settings)
    by_sequence = [[counts(file, stream.moving(file)) for file in files] for files in sequences]
    yield "the scans before", by_sequence
    if len(sequences) > 1:
        yield "the same, from the second sequence on", by_sequence[1:]
    anew = []
    for files in sequences:
        stream = Stream(settings)
        anew.append([counts(file, stream.moving(file)) for file in files])
    yield "the scans before in its sequence", anew
    known = []
    for files in sequences:
        learned = Stream(settings, Window=LONGEST)
        for file in files:
            learned.moving(file)
        stream = Stream(settings, Learning=False)
        table = learned.table()
        stream.filter.SetInputDataObject(1, table)
        known.append([counts(file, stream.moving(file)) for file in files])
    yield "all scans of its sequence", known


def scores(numbers):
    """Points, IoU, precision and recall as cells of a table."""
    hit, false, missed = numbers

    def ratio(part, total):
        return f"{part / total:.3f}" if total else "–"
    return [f"{hit + missed:,}", ratio(hit, hit + false + missed), ratio(hit, hit + false), ratio(hit, hit + missed)]


def table(folder, settings):
    """The scores of a set of sequences as a Markdown table."""
    names = sorted(path for path in (folder / "sequences").iterdir() if not path.name.startswith("."))
    sequences = [sorted((name / "velodyne").glob("*.bin")) for name in names]
    lines = ["| known | subset | points of birds | IoU | precision | recall "
             "| points of all that moves | IoU | precision | recall | false points a scan |", "|---|---|" + "---:|" * 9]
    for known, found in measure(sequences, settings):
        scans = sum(map(len, found))
        total = sum((sum(each) for each in found), np.zeros((len(SUBSETS), 2, 3), int))
        for subset, (birds, everything) in [*zip(SUBSETS, total), ("all", total.sum(axis=0))]:
            cells = [known, subset, *scores(birds), *scores(everything), f"{everything[1] / scans:.1f}"]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def speed():
    """Yields a table of processor time per scan, ms, after 300 scans of random walls of 960 columns and 80 channels."""
    random = np.random.default_rng(1)
    yield "| points | jitter, m | cells kept | ms a scan |\n|---:|---:|---:|---:|"
    for points, jitter in itertools.product((10000, 100000), (0.02, 1.0)):
        azimuth = np.radians(random.integers(0, 960, points) * 0.375)
        elevation = np.radians(random.integers(-40, 40, points) * 0.375)
        flat = np.cos(elevation)
        away = np.stack([np.sin(azimuth) * flat, np.cos(azimuth) * flat, np.sin(elevation)], axis=1)
        distance = random.uniform(5, 300, points)
        algorithm, times = vtkAvianLidarClutterFilter(), []
        for _ in range(300):
            cloud, places = vtkPolyData(), vtkPoints()
            places.SetData(numpy_to_vtk(away * (distance + random.normal(0, jitter, points))[:, None], deep=True))
            cloud.SetPoints(places)
            algorithm.SetInputDataObject(0, cloud)
            begin = time.process_time()
            algorithm.Update()
            times.append(time.process_time() - begin)
        cells = algorithm.GetOutputDataObject(1).GetNumberOfPoints()
        yield f"| {points:,} | {jitter} | {cells:,} | {1e3 * np.median(times[-20:]):.1f} |"


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=pathlib.Path, nargs="?", help="folder that `avianlidar sequence` has written")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE",
                        help="properties of the clutter filter, as in C++")
    parser.add_argument("--speed", action="store_true", help="measure time instead")
    options = parser.parse_args(argv)
    if options.speed:
        for line in speed():
            print(line)
        return
    if options.folder is None:
        parser.error("expected a folder, or --speed")
    try:
        print(table(options.folder, dict(text.split("=", 1) for text in options.set)), end="")
    except (OSError, ValueError) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
