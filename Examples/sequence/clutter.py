#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The clutter filter scored on labelled sequences: what can be told apart without learning from labels.

    clutter.py build/sequences

A point is called moving where the filter says that it is no clutter. Prints a Markdown table: for each subset and what the
filter knows, points, intersection over union (IoU), precision and recall of birds and of all that moves. Points of other
moving things are left out of the score of birds. The filter knows

* the scans before: all sequences are one stream, as of one lidar that goes on;
* the same, of which the first sequence is not scored;
* the scans before in the same sequence: it begins anew with each one;
* all scans of the sequence, also later ones: they are learned first, each weighs the same, and the table decides alone.

--set Window=100 changes a property of the filter. --speed measures instead how long it takes on random scans of 10,000 and 100,000 points,
on walls that stay within their cells and on points that jitter by 1 m (standard deviation).
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
BIRD, OTHERS = 99, (252, 258, 259)  # class of birds; cars, trucks, aircraft and other vehicles under way
LONGEST = 100000  # scans, of a window in which all weigh about the same


class Stream:
    """The clutter filter on one file after the other: without times, each is a scan more."""

    def __init__(self, settings, **others):
        self.reader, self.filter = vtkAvianLidarPointCloudReader(), vtkAvianLidarClutterFilter()
        self.filter.SetInputConnection(self.reader.GetOutputPort())
        for name, value in {**settings, **others}.items():
            if not hasattr(self.filter, "Set" + name):
                raise ValueError(f"the clutter filter has no property {name}")
            getattr(self.filter, "Set" + name)(type(getattr(self.filter, "Get" + name)())(value))

    def moving(self, file):
        """Whether each point of a file is no clutter."""
        self.reader.SetFileName(str(file))
        self.filter.Update()
        return vtk_to_numpy(self.filter.GetOutputDataObject(0).GetPointData().GetArray("is_clutter")) == 0

    def table(self):
        table = vtkPolyData()
        table.DeepCopy(self.filter.GetOutputDataObject(1))
        return table


def counts(file, called):
    """Of each subset: true positives, false positives and false negatives of birds, then of all that moves."""
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
            result[subset, which] = [np.count_nonzero(here & a) for a in (called & true, called & ~true, ~called & true)]
    return result


def measure(sequences, settings):
    """What the filter knows, the counts of the subsets, and the number of scans that are scored."""
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
    """The scores of a set of sequences as Markdown."""
    names = sorted(path for path in (folder / "sequences").iterdir() if not path.name.startswith("."))
    sequences = [sorted((name / "velodyne").glob("*.bin")) for name in names]
    lines = ["| known | subset | points of birds | IoU | precision | recall | points of all that moves | IoU | precision | recall "
             "| false points a scan |", "|---|---|" + "---:|" * 9]
    for known, found in measure(sequences, settings):
        scans = sum(map(len, found))
        total = sum((sum(each) for each in found), np.zeros((len(SUBSETS), 2, 3), int))
        for subset, (birds, everything) in [*zip(SUBSETS, total), ("all", total.sum(axis=0))]:
            lines.append("| " + " | ".join([known, subset, *scores(birds), *scores(everything), f"{everything[1] / scans:.1f}"])
                         + " |")
    return "\n".join(lines) + "\n"


def speed():
    """Time of the processor for a scan, ms, after 300 scans: random walls seen by 960 columns and 80 channels."""
    random = np.random.default_rng(1)
    yield "| points | jitter, m | cells kept | ms a scan |\n|---:|---:|---:|---:|"
    for points, jitter in itertools.product((10000, 100000), (0.02, 1.0)):
        azimuth, elevation = np.radians(random.integers(0, 960, points) * 0.375), np.radians(random.integers(-40, 40, points) * 0.375)
        away = np.stack([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)], axis=1)
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
    parser.add_argument("folder", type=pathlib.Path, nargs="?", help="what `avianlidar sequence` has written")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="properties of the clutter filter, as in C++")
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
