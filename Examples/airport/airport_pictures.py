# SPDX-License-Identifier: BSD-3-Clause
"""The three pictures of the airport: from above, close to a terminal, and as a range image."""
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import pictures
import views


def focus(scene, echoes, name):
    """Title and bounds of the close view: the object, or else the 500 m with the most echoes or about the lidar."""
    for object_name, _, surfaces in views.objects(scene):
        if object_name == name:
            return name, views.around(vtk_to_numpy(surfaces.GetPoints().GetData()), 0.06)
    if not echoes.GetNumberOfPoints():
        x, y, _ = views.lidar_position(echoes)
        return "Around the lidar", (x - 250, x + 250, y - 250, y + 250)
    points = views.places(echoes)
    squares, counts = np.unique(np.floor(points[:, :2] / 500), axis=0, return_counts=True)
    x, y = 500 * squares[counts.argmax()]
    return "Where most echoes are", (x, x + 500, y, y + 500)


def top_view(scene, shapes, echoes, words):
    bounds = views.around(views.site(scene, echoes), 0.03)
    picture = views.from_above(shapes, echoes, "Echoes from above", words, bounds, 7)
    x_lidar = views.lidar_position(echoes)[0]
    for name, kind, surfaces in views.objects(scene):
        corners = vtk_to_numpy(surfaces.GetPoints().GetData())
        if kind == "terminal" and np.ptp(corners[:, 1]) > 300:
            low, high = corners.min(axis=0), corners.max(axis=0)
            behind = (high[0] + 30, "left") if high[0] > x_lidar else (low[0] - 30, "right")
            picture.label((behind[0], 0.5 * (low[1] + high[1])), name, behind[1])
    return picture


def close_view(scene, shapes, echoes, name, words):
    title, bounds = focus(scene, echoes, name)
    return views.from_above(shapes, echoes, title + ": echoes from above", words, bounds, 7)


def draw(scene, echoes, image, preset, options):
    """Write <preset>-top.png, <preset>-close.png and <preset>-range.png."""
    words = f"{preset}, {options.rays} rays per beam"
    shapes = views.plan(scene)
    top_view(scene, shapes, echoes, words).save(options.out / f"{preset}-top.png")
    close_view(scene, shapes, echoes, options.focus, words).save(options.out / f"{preset}-close.png")
    title = f"Range image: {words}, {echoes.GetNumberOfPoints()} echoes"
    page = pictures.range_picture(image, title, views.limits(echoes))
    page.save(options.out / f"{preset}-range.png")
