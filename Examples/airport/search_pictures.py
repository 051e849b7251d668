# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of airport_search.py: the tree with VTK, the maps with Matplotlib."""
import math

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm
import matplotlib.pyplot as plt
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

import pictures
import views


class PowerOfTwo:
    """Labels of a logarithmic scale."""

    @staticmethod
    def format(value):
        return f"{2 ** value:,.0f}"


def colours(values, low, high):
    """Of logarithms of counts, as bytes."""
    shares = np.clip((np.asarray(values) - low) / max(high - low, 1e-9), 0, 1)
    return np.round(255 * colormaps["plasma_r"](0.1 + 0.9 * shares)[..., :3]).astype(np.uint8)


def coloured(boxes, beams, low, high):
    """A copy with one colour for each of the six faces of a box; boxes without beams are pale."""
    copy = vtkPolyData()
    copy.ShallowCopy(boxes)
    counts = np.repeat(beams, 6)
    rgb = colours(np.log2(np.maximum(counts, 1)), low, high)
    rgb[counts == 0] = 225
    array = numpy_to_vtk(np.ascontiguousarray(rgb), deep=True)
    array.SetName("rgb")
    copy.GetCellData().SetScalars(array)
    return copy


def draw_tree(surfaces, scan, boxes, beams, options):
    picture = pictures.Picture("Where beams look: boxes of the collision tree, coloured by the beams through them",
                               f"the {len(beams)} boxes of level {options.level}, and leaves above it; "
                               f"{scan.sensor.beams.number_of_points:,} beams", 1500, 900)
    for kind, shape in views.plan(surfaces):
        if kind in views.PAVED:
            picture.faces(shape, views.PAVED[kind])
        else:
            picture.outlines(shape, (0.6, 0.6, 0.6), 1)
    most = 4 * math.ceil(math.log2(max(beams.max(), 2)) / 4)  # a whole power at each tick
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(coloured(boxes, beams, 0, most))
    actor = picture.show(mapper, (1, 1, 1), 2.5)
    actor.GetProperty().SetRepresentationToWireframe()
    x, y, z = scan.sensor.position
    picture.lidar((x, y, z), 40)
    picture.look((x - 400, y - 2600, z + 1500), (x - 160, y + 200, z), 32)
    picture.hue_bar(0, most, colors=colours, title="beams", unit=1, labels=PowerOfTwo)
    picture.note("red plus: the lidar; grey: pavement and the edges of what stands on the ground")
    picture.save(options.out / "tree.png")


def draw_map(scan, array, title, file):
    figure, axes = plt.subplots(figsize=(11, 3.2), constrained_layout=True)
    figure.suptitle(title, x=0.01, ha="left", weight="bold")
    options = {"norm": LogNorm()} if array == "nodes_visited" else {}
    scan.plot_range_image(array, axes, **options)
    figure.savefig(file, dpi=130)
    plt.close(figure)


def draw(surfaces, scan, boxes, beams, options):
    draw_tree(surfaces, scan, boxes, beams, options)
    draw_map(scan, "status", "What became of every beam", options.out / "status.png")
    draw_map(scan, "nodes_visited", "Nodes of the tree that every beam's search tested", options.out / "cost.png")
