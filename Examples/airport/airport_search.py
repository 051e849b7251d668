#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where does a scan look, and what becomes of its beams? Leaves three pictures of a scene: tree.png, the boxes of the
collision tree at one level, coloured by the number of beams whose axis passes through them; status.png and cost.png, the beam
report as maps over azimuth and elevation; and a table of levels, search.md.

    airport_search.py --out build/search
    airport_search.py --level 6 --scene my.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`), pictures need a display (`xvfb-run -a`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402

LEVELS = (0, 2, 4, 6, 8, 10, 12)


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=running.file, default=HERE / "scene" / "hongqiao.lidarscene.json",
                        help="a .lidarscene.json file; default: Shanghai Hongqiao")
    parser.add_argument("--level", type=running.whole(0, 40), default=8, help="of the tree that is drawn, default 8")
    running.add_arguments(parser, "build/search")
    return running.parse(parser, argv)


def boxes_of(scan, level):
    """The boxes of a level of the collision tree and of the leaves above it: six faces and eight points each."""
    tree = scan.scene.tree
    tree.SetDisplayLevel(level)
    running.update(tree)
    boxes = vtkPolyData()
    boxes.ShallowCopy(tree.GetOutput(1))
    return boxes


def beams_through(boxes, beams):
    """How many beams have an axis that passes through each box."""
    corners = vtk_to_numpy(boxes.GetPoints().GetData()).reshape(-1, 8, 3)
    counts = []
    with np.errstate(divide="ignore", invalid="ignore"):
        for lower, upper in zip(corners.min(axis=1), corners.max(axis=1)):
            ranges = np.stack([lower - beams.points, upper - beams.points]) / beams["direction"]
            enter, leave = ranges.min(axis=0).max(axis=1), ranges.max(axis=0).min(axis=1)
            counts.append(np.count_nonzero(leave >= np.maximum(enter, 0)))
    return np.array(counts)


def table_of(scan):
    """How many boxes each level has, and how many beams pass through them, as Markdown."""
    rows = ["| level | boxes | most beams through one | median | sum |", "|---|---:|---:|---:|---:|"]
    for level in LEVELS:
        beams = beams_through(boxes_of(scan, level), scan.sensor.beams)
        rows.append(f"| {level} | {len(beams)} | {beams.max()} | {np.median(beams):.0f} | {beams.sum()} |")
    return "\n".join(rows) + "\n"


def main(argv=None):
    options = arguments(argv)
    surfaces = running.read_scene(options.scene).GetOutput()
    scan = avianlidar.Scan(avianlidar.Scene(surfaces), rays_per_beam=options.rays, seed=options.seed, number_of_threads=options.threads)
    table = table_of(scan)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "search.md").write_text(table, encoding="utf-8")
    print(table)
    if not options.no_pictures:
        import search_pictures  # only here: numbers need no display
        boxes = boxes_of(scan, options.level)
        search_pictures.draw(surfaces, scan, boxes, beams_through(boxes, scan.sensor.beams), options)
    return scan


if __name__ == "__main__":
    main()
