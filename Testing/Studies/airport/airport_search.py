# SPDX-License-Identifier: BSD-3-Clause
"""Where does a scan look? Leaves a picture of a scene, tree.png: the boxes of the collision tree at one level, coloured by the
number of beams whose axis passes through them.

    Testing/Studies/run.py airport_search --level 6 --scene my.lidarscene.json
"""
import math

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

import avianlidar as al
import running
import tools
from corridor_pictures import View
from running import argument, study


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


def draw_tree(scan, boxes, beams, options):
    """Boxes in the colours of their beams; those without beams are pale."""
    view, most = View(1400, 780), 4 * math.ceil(math.log2(max(beams.max(), 2)) / 4)
    surfaces = scan.scene.surfaces.GetBlock(0)
    for number, kind in enumerate(tools.strings(surfaces, "object_classes")):
        if kind in tools.PAVED:
            view.show(surfaces.GetBlock(number), 3 * (float(tools.PAVED[kind]),))
        elif kind != "ground":
            view.show(tools.edges(surfaces.GetBlock(number)), (0.6, 0.6, 0.6), 1)
    rgb = np.round(255 * colormaps["plasma_r"](0.1 + 0.9 * np.log2(np.maximum(beams, 1)) / most)[:, :3]).astype(np.uint8)
    rgb[beams == 0] = 225
    boxes.GetCellData().SetScalars(numpy_to_vtk(np.repeat(rgb, 6, axis=0), deep=True))
    view.show(boxes, (1, 1, 1), 2.5, vtkPolyDataMapper()).GetProperty().SetRepresentationToWireframe()
    x, y, z = scan.sensor.position
    view.dots([(x, y, z)], [(217, 0, 0)], 50)
    with tools.figure(options.out / "tree.png", figsize=(15, 8.5)) as axes:
        axes.imshow(view.image((x - 400, y - 2600, z + 1500), (x - 160, y + 200, z), 32))
        axes.set_axis_off()
        axes.set_title(f"The {len(beams)} boxes of level {options.level} of the collision tree, and leaves above it; red: the lidar", loc="left")
        bar = axes.scatter([], [], c=[], cmap="plasma_r", norm=LogNorm(1, 2**most))
        axes.figure.colorbar(bar, ax=axes, label="beams whose axis passes through a box", shrink=0.6)


@study(argument("--scene", type=running.file, default=running.AIRPORT, help="a .lidarscene.json file; default: Shanghai Hongqiao"),
       argument("--level", type=running.whole(0, 40), default=8, help="of the tree that is drawn, default 8"))
def main(options):
    scan = al.Scan(al.Scene(options.scene))
    boxes = boxes_of(scan, options.level)
    draw_tree(scan, boxes, beams_through(boxes, scan.sensor.beams), options)
