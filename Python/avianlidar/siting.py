# SPDX-License-Identifier: BSD-3-Clause
"""Where on an airport birds are looked for: its runways, and places around them.

>>> from avianlidar import siting
>>> runway = siting.Runway("18L/36R", (0.0, 1700.0), (0.0, -1700.0), 57.6)
>>> points, regions = siting.strips_and_approaches([runway], 1000)
>>> points.shape, sorted(regions), len(regions["approaches"])
((1000, 3), ['approaches', 'strips'], 500)
"""
from __future__ import annotations

import dataclasses
import pathlib
from typing import Dict, List, Sequence, Tuple

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from . import vtkAvianLidar as _wrapped
from ._coverage import places_of
from ._json import load_json
from ._pipeline import Error, update

# Places in strips and approaches. Source: none; after obstacle limitation surfaces of ICAO Annex 14, simplified.
STRIP_HALF_WIDTH = 150.0  # m, to either side of a runway's middle
STRIP_HEIGHTS = (0.5, 60.0)  # m
APPROACH_LENGTH = 3000.0  # m, beyond a runway's end
APPROACH_HALF_WIDTH = (75.0, 0.15)  # m at the end, and how it widens
APPROACH_HEIGHT = (45.0, 0.0524)  # m at the end, and how it rises (3 degrees)
APPROACH_LOWEST = 0.02  # of that height


@dataclasses.dataclass(frozen=True)
class Runway:
    """A runway in the scene's coordinates (m east and north)."""

    name: str
    start: Tuple[float, float]
    end: Tuple[float, float]
    width: float

    def axis(self) -> Tuple[np.ndarray, float]:
        """The unit vector from start to end, and the length, m."""
        way = np.subtract(self.end, self.start)
        length = float(np.hypot(*way))
        return way / length, length


def to_enu(longitudes_latitudes, origin: Sequence[float]) -> np.ndarray:
    """East and north, m. @param longitudes_latitudes n x 2, deg @param origin latitude, longitude (deg), height (m)"""
    degrees = np.asarray(longitudes_latitudes, dtype=float)
    transform = _wrapped.vtkAvianLidarGeodeticTransform()
    transform.SetInputData(places_of(np.column_stack([degrees, np.full(len(degrees), origin[2])])))
    transform.SetSourceFrame(transform.FRAME_GEODETIC)
    transform.SetTargetFrame(transform.FRAME_ENU)
    transform.SetUseFieldDataOrigin(False)
    transform.SetOrigin(*origin)
    transform.SetMovePoints(True)
    update(transform)
    return vtk_to_numpy(transform.GetOutputDataObject(0).GetPoints().GetData())[:, :2].copy()


def read_runways(file, origin: Sequence[float]) -> List[Runway]:
    """The runways of a GeoJSON file: lines whose property `kind` or `aeroway` is "runway", with `name` or `ref`, and `width`
    (m, default 45). @param origin of the scene: latitude, longitude (deg), height (m)"""
    path = pathlib.Path(file)
    document = load_json(path)
    features = document.get("features") if isinstance(document, dict) else None
    if not isinstance(features, list):
        raise Error(f"{path}: is no GeoJSON file with features")
    found: List[Runway] = []
    for feature in features:
        properties = feature.get("properties") or {}
        if "runway" in (properties.get("kind"), properties.get("aeroway")) and feature["geometry"]["type"] == "LineString":
            start, end = to_enu([feature["geometry"]["coordinates"][i][:2] for i in (0, -1)], origin).tolist()
            name = properties.get("name") or properties.get("ref") or f"runway {len(found) + 1}"
            found.append(Runway(name, (start[0], start[1]), (end[0], end[1]), float(properties.get("width", 45.0))))
    if not found:
        raise Error(f"{path}: holds no runway, expected lines whose property kind or aeroway is runway")
    return found


def strips_and_approaches(runways: Sequence[Runway], count: int = 12000, seed: int = 0) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
    """Places drawn at random, and which lie where: half in strips (along each runway, 150 m to either side, 0.5 to 60 m
    high), half in approaches (beyond each runway's end to 3 km, 75 m + 0.15 d to either side at the distance d, 0.02 to 1 of
    45 m + 0.0524 d high).

    @return n x 3 coordinates, m; the numbers of the places in "strips" and in "approaches"
    """
    if count < 2 * len(runways) or not runways:
        raise ValueError(f"count is {count}, expected at least 2 for each of at least one runway")
    random = np.random.default_rng(seed)
    strips, approaches = count // 2, count - count // 2
    places = []
    for number, runway in enumerate(runways):
        axis, length = runway.axis()
        across = np.array([axis[1], -axis[0]])
        n = strips // len(runways) + (number < strips % len(runways))
        along = random.uniform(0.0, length, n)
        aside = random.uniform(-STRIP_HALF_WIDTH, STRIP_HALF_WIDTH, n)
        ground = np.asarray(runway.start) + along[:, None] * axis + aside[:, None] * across
        places.append(np.column_stack([ground, random.uniform(*STRIP_HEIGHTS, n)]))
    ends = [(point, sign) for runway in runways for point, sign in ((runway.start, -1.0), (runway.end, 1.0))]
    for number, (point, sign) in enumerate(ends):
        axis, _ = runways[number // 2].axis()
        across = np.array([axis[1], -axis[0]])
        n = approaches // len(ends) + (number < approaches % len(ends))
        away = random.uniform(0.0, APPROACH_LENGTH, n)
        aside = random.uniform(-1.0, 1.0, n) * (APPROACH_HALF_WIDTH[0] + APPROACH_HALF_WIDTH[1] * away)
        ground = np.asarray(point) + (sign * away)[:, None] * axis + aside[:, None] * across
        height = random.uniform(APPROACH_LOWEST, 1.0, n) * (APPROACH_HEIGHT[0] + APPROACH_HEIGHT[1] * away)
        places.append(np.column_stack([ground, height]))
    return np.concatenate(places), {"strips": np.arange(strips), "approaches": np.arange(strips, count)}
