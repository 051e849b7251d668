#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where does a scan look, and what becomes of its beams? Leaves three pictures of a scene: tree.png, the bounding volumes
of the collision tree at one level, coloured by the number of beams that visit them; status.png and cost.png, the beam
report as maps over azimuth and elevation; and a table of levels, search.md.

    airport_search.py --out build/search
    airport_search.py --volume Sphere --level 6 --scene my.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`), pictures need a display (`xvfb-run -a`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar
from avianlidar.vtkAvianLidar import vtkAvianLidarTreeVisits

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402

LEVELS = (0, 2, 4, 6, 8, 10, 12)


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=running.file, default=HERE / "scene" / "hongqiao.lidarscene.json",
                        help="a .lidarscene.json file; default: Shanghai Hongqiao")
    parser.add_argument("--volume", choices=["AABB", "OBB", "Sphere"], default="AABB", help="of the tree's nodes")
    parser.add_argument("--level", type=running.whole(0, 40), default=8, help="of the tree that is drawn, default 8")
    running.add_arguments(parser, "build/search")
    return running.parse(parser, argv)


def visits_of(scan, level):
    """(the volumes of a level, {name: value of each of them})."""
    visits = vtkAvianLidarTreeVisits()
    visits.SetInputConnection(0, scan.sensor.algorithm.GetOutputPort())
    visits.SetSurfacesConnection(scan.scene.tree.GetOutputPort())
    visits.SetDisplayLevel(level)
    running.update(visits)
    arrays = visits.GetOutput().GetCellData()
    faces = {arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())}
    _, first = np.unique(faces["node_id"], return_index=True)
    return visits.GetOutput(), {name: values[first] for name, values in faces.items()}


def table_of(scan):
    """How many volumes each level has, and how many beams visit and meet them, as Markdown."""
    rows = ["| level | volumes | visits of the most visited | median | met by beams, all together |", "|---|---:|---:|---:|---:|"]
    for level in LEVELS:
        _, nodes = visits_of(scan, level)
        rows.append(f"| {level} | {len(nodes['visits'])} | {nodes['visits'].max()} | {np.median(nodes['visits']):.0f} "
                    f"| {nodes['beams_met'].sum()} |")
    return "\n".join(rows) + "\n"


def main(argv=None):
    options = arguments(argv)
    surfaces = running.read_scene(options.scene).GetOutput()
    scene = avianlidar.Scene(surfaces)
    getattr(scene.tree, f"SetBoundingVolumeTo{options.volume}")()
    scan = avianlidar.Scan(scene, rays_per_beam=options.rays, seed=options.seed, number_of_threads=options.threads)
    table = table_of(scan)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "search.md").write_text(table, encoding="utf-8")
    print(table)
    if not options.no_pictures:
        import search_pictures  # only here: numbers need no display
        boxes, nodes = visits_of(scan, options.level)
        search_pictures.draw(surfaces, scan, boxes, nodes, options)
    return scan


if __name__ == "__main__":
    main()
