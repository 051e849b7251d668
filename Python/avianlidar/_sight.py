# SPDX-License-Identifier: BSD-3-Clause
"""Why a sensor sees nothing, or less than meant: what a user is warned of."""
from __future__ import annotations

from typing import Any, Iterator, Tuple

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

TALL, TALL_SHARE = 2000.0, 0.1  # m, and of the width: what is taller may be in millimetres
STATUS = ("with echoes", "meet no surface", "have echoes below the lower energy limit", "are saturated",
          "meet surfaces outside the range gate only")


def extent(bounds) -> str:
    """Bounds in words, m."""
    return ", ".join(f"{name} {low:.6g} to {high:.6g}" for name, low, high in
                     zip(("east", "north", "up"), bounds[::2], bounds[1::2])) + " m"


def above_and_below(surfaces, place) -> Tuple[int, int]:
    """How many triangles are straight above a place and how many below or at it."""
    corners = vtk_to_numpy(surfaces.GetPoints().GetData())
    x, y, z = (corners[:, i][vtk_to_numpy(surfaces.GetPolys().GetConnectivityArray()).reshape(-1, 3)] for i in range(3))
    x, y = x - place[0], y - place[1]
    around = (x.min(axis=1) <= 0) & (x.max(axis=1) >= 0) & (y.min(axis=1) <= 0) & (y.max(axis=1) >= 0)
    x, y, z = x[around], y[around], z[around]
    nexts = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    opposite = np.roll(x * nexts[1] - y * nexts[0], -1, axis=1)  # twice the area opposite to each corner
    area = opposite.sum(axis=1)
    inside = (area != 0) & ((opposite * np.sign(area)[:, None]) >= 0).all(axis=1)
    heights = (opposite[inside] * z[inside]).sum(axis=1) / area[inside]
    return int((heights > place[2]).sum()), int((heights <= place[2]).sum())


def of_scene(bounds) -> Iterator[str]:
    """What its extent says of a scene."""
    wide, deep, tall = (high - low for low, high in zip(bounds[::2], bounds[1::2]))
    if tall > TALL and tall > TALL_SHARE * max(wide, deep):
        yield (f"the scene is {tall:.6g} m tall ({extent(bounds)}): if its file is in millimetres, say scale=0.001")
    elif deep < tall / 3 and bounds[4] < -0.25 * tall and abs(bounds[2]) < 0.1 * deep:
        yield (f"the scene is {tall:.6g} m tall and its lowest point {-bounds[4]:.6g} m below the origin, but it is "
               f"{deep:.6g} m deep and stands on north = {bounds[2]:.6g} m ({extent(bounds)}): if y is up in its file, say "
               "up_axis=\"y\"")


def of_place(surfaces, bounds, place) -> Iterator[str]:
    """What is wrong with a sensor's place."""
    where = "({:.6g}, {:.6g}, {:.6g}) m".format(*place)
    if place[2] < bounds[4]:
        yield f"the sensor at {where} is below the scene, whose lowest point is at {bounds[4]:.6g} m"
        return
    above, below = above_and_below(surfaces, place)
    if above and not below:
        yield f"the sensor at {where} has surfaces above it and none below: is it below the ground?"


def of_echoes(bounds, place, report, gate: float) -> str:
    """Why there is no echo. @param report cloud of the beams @param gate range gate, m"""
    if not report.number_of_points:
        return "no echoes: the sensor has no beams"
    counts = np.bincount(report["status"], minlength=len(STATUS))
    words = [f"{count} {what}" for count, what in zip(counts, STATUS) if count]
    text = f"no echoes: of {report.number_of_points} beams {', '.join(words)}"
    away = np.linalg.norm([max(low - at, 0, at - high) for at, low, high in zip(place, bounds[::2], bounds[1::2])])
    if away > gate:
        text += f"; the scene is {away:.6g} m away or more, the range gate ends at {gate:.6g} m"
    elif counts[1] == report.number_of_points:
        angles = report["vertical_angle"]
        text += f"; the beams look {angles.min():.4g} to {angles.max():.4g} deg up, the scene extends {extent(bounds)}"
    return text


def warnings_of(scan: Any) -> Iterator[str]:
    """What a user of a scan, or of coverage, that was just executed is warned of: of its scene and its sensor's place once,
    of beams without any echo each time."""
    surfaces = scan.scene.tree.GetOutput()
    beams = scan.algorithm.GetInputDataObject(0, 0)
    if not surfaces.GetNumberOfPolys():
        yield "the scene has no triangles"
        return
    bounds, place = surfaces.GetBounds(), beams.GetPoint(0) if beams.GetNumberOfPoints() else (0, 0, 0)
    looked = (surfaces, surfaces.GetMTime(), place)
    if looked != getattr(scan, "_looked", None):  # a scan that is lit again must not go through all triangles
        scan._looked = looked
        yield from of_scene(bounds)
        yield from of_place(surfaces, bounds, place)
    if scan.algorithm.IsA("vtkAvianLidarEchoFilter") and not scan.algorithm.GetOutput(0).GetNumberOfPoints():
        from ._cloud import Cloud, field_values
        gate = field_values(beams).get("range_gate", np.inf)
        yield of_echoes(bounds, place, Cloud(scan.algorithm.GetOutput(1)), float(gate))
