#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Background subtraction for each beam, scored on labelled sequences: what can be told apart without learning.

    background.py build/sequences

For each sequence and beam, a range is background where an echo lies in the same bin of 1.5 m in at least 20 % of the
scans (--share); its value is the mean of these echoes. A point that is farther than 1.5 m from each such range of its beam is called
moving. Beams are told apart by the azimuth and the elevation of the points: each elevation is a channel, and the smallest
step between azimuths is that of the sensor. The background is learned from all scans of the sequence, also later ones.

Prints a Markdown table: for each subset, points, intersection over union (IoU), precision and recall of birds and of all
that moves. Points of other moving things are left out of the score of birds. NumPy is all that it needs.
"""
import argparse
import pathlib
import sys

import numpy as np

SUBSETS = ("sky", "near clutter", "through edges")
BIRD, OTHERS = 99, (252, 258, 259)  # class of birds; cars, trucks, aircraft and other vehicles under way
BIN = 1.5     # m, of ranges, and the distance from the background that counts as moving
STEPS = 1000  # of angles, in a degree: far more than a sensor has, far less than rounding shows


def read(sequence):
    """(scan, azimuth in steps, elevation in steps, range in m, class, subset) of all points; number of scans."""
    columns = []
    files = sorted((sequence / "velodyne").glob("*.bin"))
    for k, file in enumerate(files):
        x, y, z, _ = np.fromfile(file, "<f4").reshape(-1, 4).astype(float).T
        labels = np.fromfile(sequence / "labels" / f"{file.stem}.label", "<u4") & 0xffff
        subsets = np.fromfile(sequence / "subsets" / f"{file.stem}.subset", np.uint8)
        if not len(x) == len(labels) == len(subsets):
            raise ValueError(f"{file}: {len(x)} points, {len(labels)} labels, {len(subsets)} subsets")
        azimuth = np.rint(np.degrees(np.arctan2(-y, x)) * STEPS).astype(int) % (360 * STEPS)
        elevation = np.rint(np.degrees(np.arctan2(z, np.hypot(x, y))) * STEPS).astype(int)
        columns.append((np.full(len(x), k), azimuth, elevation, np.sqrt(x * x + y * y + z * z), labels, subsets))
    return tuple(np.concatenate(column) for column in zip(*columns)), len(files)


def clusters(values):
    """An index for each group of values that are less than three steps apart."""
    known, inverse = np.unique(values, return_inverse=True)
    return np.concatenate([[0], np.cumsum(np.diff(known) > 2)])[inverse]


def beams(azimuth, elevation):
    """An index of the beam of each point."""
    gaps = np.diff(np.unique(azimuth))
    step = gaps[gaps > 2].min(initial=360 * STEPS)  # a smaller gap is rounding
    columns = round(360 * STEPS / step)
    column = np.rint(azimuth * (columns / (360 * STEPS))).astype(int) % columns
    return clusters(elevation) * columns + column


def moving(scan, beam, distance, scans, share):
    """Whether a point is farther than BIN from all background of its beam."""
    cell = np.floor(distance / BIN).astype(np.int64)
    width = cell.max(initial=0) + 3
    key = beam * width + cell + 1
    bins, inverse, points = np.unique(key, return_inverse=True, return_counts=True)
    hits = np.bincount(np.unique(np.stack([inverse, scan]), axis=1)[0], minlength=len(bins))  # scans, not points
    fixed = hits >= share * scans
    background, mean = bins[fixed], (np.bincount(inverse, distance) / points)[fixed]
    result = np.ones(len(key), bool)
    for neighbour in (-1, 0, 1):
        if len(background):
            place = np.minimum(np.searchsorted(background, key + neighbour), len(background) - 1)
            result &= (background[place] != key + neighbour) | (np.abs(distance - mean[place]) > BIN)
    return result


def counts(sequence, share):
    """Of each subset: true positives, false positives and false negatives of birds, then of all that moves."""
    (scan, azimuth, elevation, distance, labels, subsets), scans = read(sequence)
    called = moving(scan, beams(azimuth, elevation), distance, scans, share)
    bird, other = labels == BIRD, np.isin(labels, OTHERS)
    result = np.zeros((len(SUBSETS), 2, 3), int)
    for subset in range(len(SUBSETS)):
        for which, (true, among) in enumerate(((bird, ~other), (bird | other, True))):
            here = (subsets == subset) & among
            result[subset, which] = [np.count_nonzero(here & a) for a in (called & true, called & ~true, ~called & true)]
    return result


def scores(numbers):
    """Points, IoU, precision and recall as cells of a table."""
    hit, false, missed = numbers

    def ratio(part, total):
        return f"{part / total:.3f}" if total else "–"
    return [f"{hit + missed:,}", ratio(hit, hit + false + missed), ratio(hit, hit + false), ratio(hit, hit + missed)]


def table(folder, share):
    """The scores of a set of sequences as Markdown."""
    names = sorted(path for path in (folder / "sequences").iterdir() if not path.name.startswith("."))
    total = sum((counts(sequence, share) for sequence in names), np.zeros((len(SUBSETS), 2, 3), int))
    rows = [*zip(SUBSETS, total), ("all", total.sum(axis=0))]
    lines = ["| subset | points of birds | IoU | precision | recall | points of all that moves | IoU | precision | recall |",
             "|---|" + "---:|" * 8]
    lines += ["| " + " | ".join([name, *scores(birds), *scores(everything)]) + " |" for name, (birds, everything) in rows]
    return "\n".join(lines) + "\n"


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=pathlib.Path, help="what `avianlidar sequence` has written")
    parser.add_argument("--share", type=float, default=0.2,
                        help="of the scans in which background has an echo, default 0.2")
    options = parser.parse_args(argv)
    try:
        print(table(options.folder, options.share), end="")
    except (OSError, ValueError) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
