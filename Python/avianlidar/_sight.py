# SPDX-License-Identifier: BSD-3-Clause
"""Warnings that explain why a sensor sees nothing, or less than the user intended."""
from collections.abc import Iterator
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonDataModel import vtkCellArray

from ._cloud import Cloud, as_numpy, field_values, triangles_of, with_points
from ._numbers import figures
from ._pipeline import update
from ._plot import STATUS

WIDE, TALL = 50e3, 1e3  # m: a scene that is wider, or taller and without echoes, may be in millimetres
FAR = 1e5  # m: distance at which nothing is seen
BELOW = 1.0  # distance below the lowest point from which on a sensor counts as below the scene, m


def coordinate(value: float) -> str:
    """A coordinate in words, in cm if it is one of a map."""
    return figures(value) if abs(value) < 1e5 else figures(round(value, 2), 15)


def extent(bounds) -> str:
    """Bounds in words, m."""
    return ", ".join(f"{name} {coordinate(low)} to {coordinate(high)}" for name, low, high in
                     zip(("east", "north", "up"), bounds[::2], bounds[1::2])) + " m"


def crossed(surfaces, place) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the triangles that the vertical line through a place crosses, and the heights of the crossings, m.
    Triangles with the same corners count once."""
    points, triangles = triangles_of(surfaces)
    place = place[0] + 1.2e-6, place[1] + 0.7e-6  # beside edges, where a line would cross both triangles or none
    numbers = np.arange(len(triangles))
    for axis in range(2):  # triangles with corners on both sides, found with bits because there may be millions
        beyond = (points[:, axis] > place[axis])[triangles]
        both = beyond.any(axis=1) & ~beyond.all(axis=1)
        triangles, numbers = triangles[both], numbers[both]
    x, y, z = (points[:, axis][triangles] for axis in range(3))
    x, y = x - place[0], y - place[1]
    # Twice the area opposite to each corner.
    opposite = np.roll(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), -1, axis=1)
    area = opposite.sum(axis=1)
    inside = np.flatnonzero((area != 0) & ((opposite * np.sign(area)[:, None]) >= 0).all(axis=1))
    once = {frozenset(map(tuple, points[triangles[i]])): i for i in inside}
    inside = np.array(sorted(once.values()), dtype=int)
    return numbers[inside], (opposite[inside] * z[inside]).sum(axis=1) / area[inside]


def parts_of(surfaces, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The connected part of each of some triangles, and for each part the greatest height of its open edges, m,
    minus infinity without open edges. @param numbers numbers of the triangles"""
    from vtkmodules.vtkFiltersCore import vtkPolyDataConnectivityFilter  # takes long to load, and is rarely needed
    points, triangles = triangles_of(surfaces)
    used, corners = np.unique(triangles[numbers], return_inverse=True)
    places = points[used].astype(float) + 0.0  # without the sign of zeros
    _, first, number = np.unique(places.view("V24").ravel(), return_index=True, return_inverse=True)  # of equal corners
    corners = number[corners].reshape(-1, 3).astype(np.int64)
    whole = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    corners = corners[whole]
    welded, cells = with_points(places[first]), vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(corners.ravel(), deep=True))
    welded.SetPolys(cells)
    connected = vtkPolyDataConnectivityFilter()
    connected.SetInputData(welded)
    connected.SetExtractionModeToAllRegions()
    connected.ColorRegionsOn()
    update(connected)
    found = connected.GetOutput()
    parts = np.full(len(numbers), -1)
    parts[whole] = as_numpy(found.GetPointData().GetArray("RegionId"))[triangles_of(found)[1][:, 0]]
    ends = np.sort(np.stack([corners, np.roll(corners, 1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
    _, edge, count = np.unique(ends @ (len(first), 1), return_index=True, return_counts=True)
    edge = edge[count == 1]  # of one triangle alone
    open_to = np.full(parts.max() + 1, -np.inf)
    np.maximum.at(open_to, np.repeat(parts[whole], 3)[edge], places[first][ends[edge], 2].max(axis=1))
    return parts, open_to


def around(surfaces, place, numbers: np.ndarray) -> list[str]:
    """Names of the objects with a closed surface around a place. A surface that is open only below the place, such as a
    building without a floor, counts as closed. @param numbers numbers of the triangles straight above the place"""
    names = field_values(surfaces).get("object_names", [])
    ids = as_numpy(surfaces.GetCellData().GetArray("object_id"))
    found = []
    for one in np.unique(ids[numbers]):
        whole = np.flatnonzero(ids == one)
        parts, open_to = parts_of(surfaces, whole)
        above = parts[np.searchsorted(whole, numbers[ids[numbers] == one])]
        part, count = np.unique(above, return_counts=True)
        if ((count % 2 == 1) & (open_to[part] < place[2])).any():
            found.append(f"'{names[one]}'" if 0 <= one < len(names) else f"object {one}")
    return found


def of_scene(bounds, place=(0, 0, 0), seen: bool = True) -> Iterator[str]:
    """Warnings about the extent of a scene. @param place position of the sensor @param seen whether there are echoes"""
    wide, deep, tall = (high - low for low, high in zip(bounds[::2], bounds[1::2]))
    on_north = abs(bounds[2]) <= 0.1 * deep
    if max(wide, deep) > WIDE or tall > TALL and not seen:
        yield f"the scene extends {extent(bounds)}: if its file is in millimetres, read it with the scale 0.001"
    elif on_north and (deep < tall / 3 and tall > 100 and bounds[4] < -0.25 * tall or
                       not seen and bounds[4] < place[2] - 0.5 * tall and deep < tall):
        yield (f"the scene's lowest point is {figures(-bounds[4])} m below the origin, and the scene stands on north = "
               f"{figures(bounds[2])} m ({extent(bounds)}): if y is up in its file, read it with the up axis y")


def of_place(surfaces, bounds, place, seen: bool = True) -> Iterator[str]:
    """Warnings about a sensor's place. @param seen whether there are echoes"""
    where = "({}, {}, {}) m".format(*map(coordinate, place))
    within = all(low <= at <= high for at, low, high in zip(place[:2], bounds[:4:2], bounds[1:4:2]))
    if place[2] < bounds[4] - BELOW and (within or not seen):
        yield f"the sensor at {where} is below the scene, whose lowest point is at {figures(bounds[4])} m"
        return
    numbers, heights = crossed(surfaces, place)
    above = heights > place[2]
    solids = around(surfaces, place, numbers[above])
    if solids:
        yield (f"the sensor at {where} is inside the closed surface of {' and '.join(solids)}, which hides everything "
               "outside: move the sensor out of it, unless this is intended")
    elif above.any() and above.all():
        yield f"the sensor at {where} has surfaces above it and none below: is it below the ground?"


def of_echoes(bounds, place, report, gate: float) -> str:
    """The reason why there is no echo. @param report cloud of the beams @param gate range gate, m"""
    if not report.number_of_points:
        return "no echoes: the sensor has no beams"
    counts = np.bincount(report["status"], minlength=len(STATUS))
    words = [f"{what} {count}" for count, what in zip(counts, STATUS) if count]
    text = f"no echoes of {report.number_of_points} beams: {', '.join(words)}"
    away = np.linalg.norm([max(low - at, 0, at - high) for at, low, high in zip(place, bounds[::2], bounds[1::2])])
    if away > gate:
        text += f"; the scene is {figures(away)} m away or more, the range gate ends at {figures(gate)} m"
        if away > FAR:
            text += "; if its coordinates are those of a map, such as UTM, subtract an offset or put the sensor there"
    elif counts[1] == report.number_of_points:
        angles = report["vertical_angle"]
        text += f"; the beams point {angles.min():.4g} to {angles.max():.4g} deg up, the scene extends {extent(bounds)}"
    return text


def warnings_of(scan: Any) -> Iterator[str]:
    """Warnings about a scan or a coverage that was just executed: about the scene and the sensor's place once,
    about beams without any echo each time."""
    surfaces = scan.scene.tree.GetOutput()
    beams = scan.algorithm.GetInputDataObject(0, 0)
    echoes = scan.algorithm.IsA("vtkAvianLidarEchoFilter")
    seen = not echoes or scan.algorithm.GetOutput(0).GetNumberOfPoints() > 0
    if not surfaces.GetNumberOfPolys():
        if not (echoes and seen):  # otherwise a mover was seen
            yield "the scene has no triangles"
        return
    bounds = surfaces.GetBounds()
    place = beams.GetPoint(0) if beams.GetNumberOfPoints() else (0, 0, 0)
    looked = (surfaces, surfaces.GetMTime(), place, seen)
    if looked != getattr(scan, "_looked", None):
        scan._looked = looked
        yield from of_scene(bounds, place, seen)
        yield from of_place(surfaces, bounds, place, seen)
    if not seen:
        gate = field_values(beams).get("range_gate", np.inf)
        yield of_echoes(bounds, place, Cloud(scan.algorithm.GetOutput(1)), float(gate))
