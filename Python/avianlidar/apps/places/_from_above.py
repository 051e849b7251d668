# SPDX-License-Identifier: BSD-3-Clause
"""The scene of an airport from above, drawn into axes of Matplotlib, which only the functions import."""
from __future__ import annotations

from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ..._cloud import as_numpy, field_values, leaves_of, triangles_of
from ..._look import CLASSES, GROUND

TALL = 5.0  # height above the ground at the sensor from which on surfaces are drawn as buildings, m, except GROUND
FAR = 2000.0  # width of a map, m, from which on its ticks are in km
PLANTS = ("vegetation", "tree")  # classes that are drawn as woods


def draw_land(axes, plan: Any) -> None:
    """Draws woods and water of the scene. @param plan a plan of coverage, or an object with the same scene"""
    from matplotlib.collections import PolyCollection
    for block in leaves_of(plan.scene.surfaces):
        polygons, ids = block.GetPolys(), block.GetCellData().GetArray("object_id")
        if not polygons.GetNumberOfCells():
            continue
        classes = np.array(field_values(block).get("object_classes", [""]))
        of = classes[as_numpy(ids) if ids and len(classes) > 1 else np.zeros(polygons.GetNumberOfCells(), int)]
        points = vtk_to_numpy(block.GetPoints().GetData())[:, :2]
        offsets = vtk_to_numpy(polygons.GetOffsetsArray())
        cells = np.split(points[vtk_to_numpy(polygons.GetConnectivityArray())], offsets[1:-1])
        for wanted, colour in ((np.isin(of, PLANTS), CLASSES["vegetation"]), (of == "water", CLASSES["water"])):
            if wanted.any():
                drawn = [cells[i] for i in np.flatnonzero(wanted)]
                axes.add_collection(PolyCollection(drawn, facecolors=colour, edgecolors=colour, zorder=0.5))


def draw_airport(axes, plan: Any, colour: str = "0.25") -> None:
    """Draws buildings, runways and the sensor. @param plan a plan of coverage, or an object with the same runways, scene,
    ground, sensor and extent @param colour colour of buildings and runways"""
    from matplotlib.colors import ListedColormap
    for runway in plan.runways:
        axes.plot(*np.transpose([runway.start, runway.end]), color=colour, linewidth=1.5, solid_capstyle="butt")
    if plan.scene is not None:
        surfaces = plan.scene.tree.GetOutput()
        points, cells = triangles_of(surfaces)
        roofs = points[cells][:, :, 2].min(axis=1) > (plan.ground or 0.0) + TALL
        classes = field_values(surfaces).get("object_classes", ())
        if len(classes):
            roofs &= ~np.isin(classes, GROUND)[as_numpy(surfaces.GetCellData().GetArray("object_id"))]
        if roofs.any():
            axes.tripcolor(*points[:, :2].T, cells[roofs], facecolors=np.zeros(roofs.sum()),
                           cmap=ListedColormap([colour]))
    axes.plot(*plan.sensor.position[:2], "r^", markersize=6, markeredgecolor="white", markeredgewidth=0.6)
    unit, scale = ("km", 1000.0) if np.ptp(plan.extent[:2]) > FAR else ("m", 1.0)
    axes.set(xlim=plan.extent[:2], ylim=plan.extent[2:], aspect="equal", xlabel=f"{unit} east", ylabel=f"{unit} north")
    axes.locator_params(nbins=5)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value / scale:g}")
