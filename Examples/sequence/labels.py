#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of a labelled sequence: all points from above, in the colour of their class.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/sequence/labels.py --out build/labels

The script makes 20 scans of the scenario, draws the points as labels.png, and prints the number of points of each
class.
"""
import argparse
import pathlib
import sys

import numpy as np
from matplotlib.figure import Figure

from avianlidar._command import main as avianlidar
from avianlidar.apps.sequences._labels import CLASSES

HERE = pathlib.Path(__file__).resolve().parent
# Drawn classes of SemanticKITTI, and sizes of their points.
SIZES = {50: 2, 52: 2, 80: 4, 252: 6, 258: 6, 259: 6, 99: 6}


def points(folder):
    """Positions east and north of the sensor, m, (n, 2), and classes, (n,), of all points of all scans."""
    places, labels = [], []
    for file in sorted(folder.glob("sequences/*/velodyne/*.bin")):
        x, y, _, _ = np.fromfile(file, "<f4").reshape(-1, 4).T
        places.append(np.column_stack([-y, x]))
        labels.append(np.fromfile(file.parents[1] / "labels" / f"{file.stem}.label", "<u4") & 0xffff)
    return np.concatenate(places), np.concatenate(labels)


def main(arguments=None):
    """Makes the sequence and the picture. @return the number of points by class"""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default=str(HERE / "hongqiao.scenario.json"), help="default: hongqiao.scenario.json")
    parser.add_argument("--scans", type=int, default=20, help="number of scans, default 20")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder of the results")
    options = parser.parse_args(arguments)
    folder = options.out / "sequences"
    if avianlidar(["sequence", options.scenario, "-o", str(folder), "--scans", str(options.scans)]):
        sys.exit(1)
    places, labels = points(folder)
    figure = Figure(figsize=(8, 6), layout="constrained")
    axes = figure.subplots()
    for label, size in SIZES.items():
        x, y = places[labels == label].T
        if len(x):
            colour = np.array(CLASSES[label].color[::-1]) / 255
            axes.scatter(x, y, size, [colour], linewidths=0, label=f"{label} {CLASSES[label].here}: {len(x)}")
    axes.set(aspect="equal", xlim=(-800, 800), ylim=(-600, 600), xlabel="m east of the sensor", ylabel="m north",
             title=f"Labelled points of {options.scans} scans")
    axes.legend(loc="upper left", markerscale=3, fontsize=8)
    figure.savefig(options.out / "labels.png", dpi=125)
    return {int(label): int(count) for label, count in zip(*np.unique(labels, return_counts=True))}


if __name__ == "__main__":
    print(main())
