# SPDX-License-Identifier: BSD-3-Clause
"""Views of a scene and its echoes from above."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData

import pictures

PAVED = {"apron": (0.93, 0.93, 0.93), "runway": (0.84, 0.84, 0.84)}


def strings(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())] if array else []


def objects(scene):
    """(name, class, surfaces) of every object."""
    names, classes = strings(scene, "object_names"), strings(scene, "object_classes")
    blocks = (scene.GetBlock(i) for i in range(scene.GetNumberOfBlocks()))
    return list(zip(names, classes or [""] * len(names), blocks))


def plan(scene):
    """What the views show: pavement as surfaces, what stands on the ground as its edges, the ground not at all."""
    return [(kind, surfaces if kind in PAVED else pictures.edges(surfaces))
            for _, kind, surfaces in objects(scene) if kind != "ground"]


def limits(echoes):
    return [echoes.GetFieldData().GetArray(name).GetValue(0) for name in ("lower_energy_limit", "upper_energy_limit")]


def lidar_position(echoes):
    return echoes.GetFieldData().GetArray("position").GetTuple(0)


def around(points, margin):
    """Bounds of points with a margin of that share."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    grow = margin * (high - low).max() or 100.0
    return low[0] - grow, high[0] + grow, low[1] - grow, high[1] + grow


def strongest_on_top(echoes):
    """A copy to look at from above: of dots in one place the strongest hides the others. It is raised above roofs."""
    copy, raised = vtkPolyData(), vtkPoints()
    points = vtk_to_numpy(echoes.GetPoints().GetData()).copy()
    energy = vtk_to_numpy(echoes.GetPointData().GetArray("energy"))
    points[:, 2] = 2000 + 1000 * energy.argsort().argsort() / len(energy)
    raised.SetData(numpy_to_vtk(points, deep=True))
    copy.ShallowCopy(echoes)
    copy.SetPoints(raised)
    return copy


def places(echoes):
    """The points, also of no echoes."""
    return vtk_to_numpy(echoes.GetPoints().GetData()) if echoes.GetNumberOfPoints() else np.zeros((0, 3))


def count_in_words(picture, echoes):
    """How many echoes the picture shows, of how many."""
    number, shown = echoes.GetNumberOfPoints(), int(picture.in_view(places(echoes)).sum())
    return f"{number} echoes" if shown == number else f"{shown} of {number} echoes"


def site(scene, echoes):
    """Points to frame: the lidar, the echoes, and all but the ground as far as the range gate."""
    lidar, gate = lidar_position(echoes), echoes.GetFieldData().GetArray("range_gate").GetValue(0)
    points = [vtk_to_numpy(surfaces.GetPoints().GetData()) for _, kind, surfaces in objects(scene)
              if kind != "ground" and surfaces and surfaces.GetNumberOfPoints()]
    points = np.vstack([*points, [lidar]])
    near = (abs(points[:, :2] - lidar[:2]) <= gate).all(axis=1)
    return np.vstack([points[near], places(echoes)])


def from_above(shapes, echoes, title, words, bounds, diameter):
    """The diameter of the dots is in pixels."""
    picture = pictures.Picture.for_bounds(title, "", bounds)
    for kind, shape in shapes:
        if kind in PAVED:
            picture.faces(shape, PAVED[kind])
        else:
            picture.outlines(shape)
    metres = picture.look_down(bounds)
    picture.subtitle(f"{words}, {count_in_words(picture, echoes)}")
    if echoes.GetNumberOfPoints():
        picture.dots(strongest_on_top(echoes), diameter * metres)
    x, y, _ = lidar_position(echoes)
    picture.lidar((x, y, 4000), 14 * metres)
    picture.hue_bar(*limits(echoes))
    picture.note(f"{where_is(x, y, bounds)}; the strongest dot is on top")
    return picture


def where_is(x, y, bounds):
    """Words about the lidar, which may be outside the view."""
    if bounds[0] < x < bounds[1] and bounds[2] < y < bounds[3]:
        return "red plus: the lidar"
    east, north = x - 0.5 * (bounds[0] + bounds[1]), y - 0.5 * (bounds[2] + bounds[3])
    wind = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")
    to = wind[round(np.degrees(np.arctan2(east, north)) / 45) % 8]
    return f"the lidar is {np.hypot(east, north):.0f} m {to} of here"
