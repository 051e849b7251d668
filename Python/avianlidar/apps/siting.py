# SPDX-License-Identifier: BSD-3-Clause
"""Where on an airport a lidar sees most birds: runways and places around them, candidates, coverage of each, and the best
one, two, three or more of them.

>>> from avianlidar import siting
>>> runway = siting.Runway("18L/36R", (0.0, 1700.0), (0.0, -1700.0), 57.6)
>>> points, regions = siting.strips_and_approaches([runway], 1000)
>>> points.shape, sorted(regions), len(regions["approaches"])
((1000, 3), ['approaches', 'strips'], 500)
"""
from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import io
import itertools
import json
import math
import os
import pathlib
import re
import warnings
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

from .. import vtkAvianLidar as _wrapped
from .._cloud import add_array, field_values, vertices
from .._coverage import Coverage, places_of
from .._disk import write_whole
from .._files import read_regular, save
from .._pipeline import Error, Updates, callers_level, update
from .._ranks import Ranks, as_json, digest_of, digest_of_arrays
from .._version import __version__
from ._json import load_json, naming

# Places in strips and approaches. Source: none; after obstacle limitation surfaces of ICAO Annex 14, simplified.
STRIP_HALF_WIDTH = 150.0  # m, to either side of a runway's middle
STRIP_HEIGHTS = (0.5, 60.0)  # m
APPROACH_LENGTH = 3000.0  # m, beyond a runway's end
APPROACH_HALF_WIDTH = (75.0, 0.15)  # m at the end, and how it widens
APPROACH_HEIGHT = (45.0, 0.0524)  # m at the end, and how it rises (3 degrees)
APPROACH_LOWEST = 0.02  # of that height

SPREADS = ("distance", "area")  # of places over a region

WINDS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
MOST_CANDIDATES = 100_000
SAME_PLACE = 1e-3  # m: candidates whose coordinates are the same to this are one
POINTS = 32  # that are looked at together, with the edges beside them
SAME_BIRDS = 20_000  # places whose poses are held together: 6 MB a sensor and air


@dataclasses.dataclass(frozen=True)
class Runway:
    """A runway in the scene's coordinates (m east and north)."""

    name: str
    start: Tuple[float, float]
    end: Tuple[float, float]
    width: float
    displaced: Tuple[float, float] = (0.0, 0.0)  # how far the thresholds lie from the start and the end, m

    def words(self) -> str:
        """Its name, length, width and displaced thresholds."""
        names = self.name.split("/") if self.name.count("/") == 1 else ("its start", "its end")
        found = [f"of {name} by {away:.0f} m" for name, away in zip(names, self.displaced) if away > 0.0]
        return f"{self.name}: {self.axis()[1]:.0f} m long, {self.width:g} m wide" + (f"; threshold displaced: {', '.join(found)}" if found else "")

    def axis(self) -> Tuple[np.ndarray, float]:
        """The unit vector from start to end, and the length, m."""
        way = np.subtract(self.end, self.start)
        length = float(np.hypot(*way))
        return way / length, length

    def axes(self) -> np.ndarray:
        """The unit vectors from start to end and to the right of that, 2 x 2."""
        axis, _ = self.axis()
        return np.array([axis, (axis[1], -axis[0])])


def _transformed(points, origin: Sequence[float], to_geodetic: bool) -> np.ndarray:
    transform = _wrapped.vtkAvianLidarGeodeticTransform()
    transform.SetInputData(places_of(points))
    frames = (transform.FRAME_ENU, transform.FRAME_GEODETIC)
    transform.SetSourceFrame(frames[not to_geodetic])
    transform.SetTargetFrame(frames[to_geodetic])
    transform.SetUseFieldDataOrigin(False)
    transform.SetOrigin(*origin)
    transform.SetMovePoints(True)
    update(transform)
    return vtk_to_numpy(transform.GetOutputDataObject(0).GetPoints().GetData()).copy()


def to_enu(longitudes_latitudes, origin: Sequence[float]) -> np.ndarray:
    """East and north, m. @param longitudes_latitudes n x 2, deg @param origin latitude, longitude (deg), height (m)"""
    degrees = np.asarray(longitudes_latitudes, dtype=float)
    return _transformed(np.column_stack([degrees, np.full(len(degrees), origin[2])]), origin, False)[:, :2]


def to_geodetic(points, origin: Sequence[float]) -> np.ndarray:
    """Longitude, latitude (deg) and height above the ellipsoid (m). @param points n x 3, m east, north and up
    @param origin latitude, longitude (deg), height (m)"""
    return _transformed(points, origin, True)


def rounded(position: Sequence[float]) -> List[str]:
    """Coordinates in tenths of a metre, more than is known of terrain and maps."""
    return [f"{round(float(value), 1) + 0.0:.10g}" for value in position]


def require_memory(needed: float, what: str, instead: str) -> None:
    """Error where results are larger than this computer's memory. @param needed bytes @param instead what to do"""
    there = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if needed > there:
        raise Error(f"{what} need {needed / 1e9:.3g} GB, there are {there / 1e9:.3g} GB: {instead}")


def _features(path: pathlib.Path) -> List[Dict[str, Any]]:
    """The features of a GeoJSON file; their properties and geometries are objects, empty where the file has null."""
    document = load_json(path)
    features = document.get("features") if isinstance(document, dict) else None
    if not isinstance(features, list):
        raise Error(f"{path}: is no GeoJSON file with features")
    for number, feature in enumerate(features):
        if not isinstance(feature, dict):
            raise Error(f"{path}: features[{number}]: is {str(feature)[:40]}, expected an object")
        for name in ("properties", "geometry"):
            if feature.get(name) is None:
                feature[name] = {}
            if not isinstance(feature[name], dict):
                raise Error(f"{path}: features[{number}].{name}: is {str(feature[name])[:40]}, expected an object or null")
    return features


def _corners(coordinates: Any, origin: Sequence[float], least: int) -> np.ndarray:
    """East and north (n x 2, m) of corners in GeoJSON. @param least number of corners"""
    try:
        degrees = np.array([point[:2] for point in coordinates])
    except (TypeError, ValueError, LookupError):
        degrees = np.empty(0)
    if degrees.dtype.kind not in "iuf" or degrees.ndim != 2 or degrees.shape[1] != 2 or len(degrees) < least:
        raise ValueError(f"the coordinates are not {least} or more pairs of longitude and latitude")
    return to_enu(degrees, origin)


def read_runways(file, origin: Sequence[float]) -> List[Runway]:
    """The runways of a GeoJSON file: lines whose property `kind` or `aeroway` is "runway", with `name` or `ref`, and `width`
    (m, default 45). @param origin of the scene: latitude, longitude (deg), height (m)"""
    path = pathlib.Path(file)
    found: List[Runway] = []
    for number, feature in enumerate(_features(path)):
        properties, shape = feature["properties"], feature["geometry"]
        if "runway" in (properties.get("kind"), properties.get("aeroway")) and shape.get("type") == "LineString":
            name = str(properties.get("name") or properties.get("ref") or f"runway {len(found) + 1}")
            width = properties.get("width", 45.0)
            with naming(f"{path}: features[{number}]"):
                corners = _corners(shape.get("coordinates"), origin, 2)
                if not isinstance(width, (int, float)) or not width > 0 or not np.hypot(*(corners[-1] - corners[0])) > 1.0:
                    raise ValueError(f"{name}: expected a line of some length and a width above 0 m, got the width {width!r}")
                (x0, y0), (x1, y1) = (map(float, corner) for corner in corners[[0, -1]])
                displaced = [properties.get(f"displaced_{end}", 0.0) for end in ("start", "end")]
                if not all(isinstance(away, (int, float)) and 0.0 <= away < np.hypot(x1 - x0, y1 - y0) for away in displaced):
                    raise ValueError(f"{name}: displaced thresholds are {displaced[0]!r} and {displaced[1]!r}, expected metres, less than its length")
                found.append(Runway(name, (x0, y0), (x1, y1), float(width), (float(displaced[0]), float(displaced[1]))))
    if not found:
        raise Error(f"{path}: holds no runway, expected lines whose property kind or aeroway is runway")
    return found


def region_heights(name: str, heights: Optional[Tuple[float, float]] = None) -> Tuple[float, float]:
    """Least and greatest height (m) of the places that are drawn in "strips" or "approaches". @param heights asked for, if any"""
    if heights is not None:
        return heights
    if name == "strips":
        return STRIP_HEIGHTS
    return APPROACH_LOWEST * APPROACH_HEIGHT[0], APPROACH_HEIGHT[0] + APPROACH_HEIGHT[1] * APPROACH_LENGTH


def wind(way: np.ndarray) -> str:
    """The direction of a way (east, north) by eight winds."""
    return WINDS[round(math.atan2(way[0], way[1]) / (math.pi / 4)) % 8]


def end_names(runways: Sequence[Runway]) -> List[Tuple[str, str]]:
    """The designators of the start and the end of each runway, such as ("08", "26"): that of an end is the one which says in what direction
    aircraft land there. Where a name does not hold two, ends are called by the wind: ("grass west", "grass east")."""
    names = []
    for runway in runways:
        axis, _ = runway.axis()
        found = re.findall(r"(?<![0-9])([0-9]{1,2}[A-Z]?)(?![0-9A-Za-z])", runway.name)
        if len(found) == 2 and (int(found[0].rstrip(LETTERS)) - int(found[1].rstrip(LETTERS))) % 36 == 18:
            heading = math.degrees(math.atan2(axis[0], axis[1]))
            off = abs((10.0 * int(found[0].rstrip(LETTERS)) - heading + 180.0) % 360.0 - 180.0)
            names.append((found[0], found[1]) if off <= 90.0 else (found[1], found[0]))
        else:
            names.append((f"{runway.name} {wind(-axis)}", f"{runway.name} {wind(axis)}"))
    known = [name for pair in names for name in pair]
    return [pair if all(known.count(name) == 1 for name in pair) else (f"{pair[0]} ({number})", f"{pair[1]} ({number})")
            for number, pair in enumerate(names, 1)]


def region_names(runways: Sequence[Runway]) -> Dict[str, List[str]]:
    """Of strips and approaches, in the order of the runways: "strip" and the runway's name, "approach" and the name of the end."""
    pairs = end_names(runways)
    strips = [f"strip {'/'.join(sorted(pair))}" if all(name in runway.name for name in pair) else f"strip {runway.name}" for runway, pair in zip(runways, pairs)]
    return {"strips": [name if strips.count(name) == 1 else f"{name} ({number})" for number, name in enumerate(strips, 1)],
            "approaches": [f"approach {name}" for pair in pairs for name in pair]}


def region_outlines(runways: Sequence[Runway]) -> Dict[str, np.ndarray]:
    """Each strip and approach from above, 4 x 2, m, by its name."""
    names, found = region_names(runways), {}
    for number, runway in enumerate(runways):
        axis, across = runway.axes()
        found[names["strips"][number]] = runway_outline(runway, 0.0, STRIP_HALF_WIDTH)
        for name, end, way in zip(names["approaches"][2 * number:], (runway.start, runway.end), (-axis, axis)):
            near, far = APPROACH_HALF_WIDTH[0] * across, (APPROACH_HALF_WIDTH[0] + APPROACH_HALF_WIDTH[1] * APPROACH_LENGTH) * across
            outer = np.asarray(end) + APPROACH_LENGTH * way
            found[name] = np.array([end - near, outer - far, outer + far, end + near])
    return found


def _region_shares(runways: Sequence[Runway], shares: Optional[Mapping[str, Any]], spread: str) -> Dict[str, Dict[str, float]]:
    """The share of the places in each region of each kind; all of them sum to 1."""
    wanted = {"strips": 1.0, "approaches": 1.0} if shares is None else dict(shares)
    if not wanted.keys() <= {"strips", "approaches"}:
        raise ValueError(f"shares are {wanted}, expected numbers from 0 of strips and approaches with a sum above 0")
    if spread not in SPREADS:
        raise ValueError(f"spread is {spread!r}, expected {' or '.join(SPREADS)}")
    found: Dict[str, Dict[str, float]] = {}
    for kind, names in region_names(runways).items():
        given = wanted.get(kind, 0.0)
        if isinstance(given, Mapping):
            known = {word: name for name in names for word in (name, name.partition(" ")[2])}
            known.update({runway.name: name for runway, name in zip(runways, names)} if kind == "strips" else {})
            for word in given:
                if word not in known:
                    raise ValueError(f"{kind} has {word!r}, expected some of {', '.join(name.partition(' ')[2] for name in names)}")
            found[kind] = {**dict.fromkeys(names, 0.0), **{known[word]: float(share) for word, share in given.items()}}
        else:
            sizes = [runway.axis()[1] for runway in runways] if (kind, spread) == ("strips", "area") else [1.0] * len(names)
            found[kind] = {name: float(given) * size / sum(sizes) for name, size in zip(names, sizes)}
    each = [share for of in found.values() for share in of.values()]
    if not 0.0 < sum(each) < np.inf or min(each) < 0.0:
        raise ValueError(f"shares are {wanted}, expected numbers from 0 of strips and approaches with a sum above 0")
    return {kind: {name: share / sum(each) for name, share in of.items()} for kind, of in found.items()}


def _split(count: int, shares: Sequence[float]) -> np.ndarray:
    """Whole numbers by shares, the sum `count`: what is left goes to the largest remainders, of equal ones to the first."""
    total = sum(shares)
    exact = np.array(shares) * (count / total) if total > 0.0 else np.zeros(len(shares))
    numbers = np.floor(exact + 1e-9).astype(int)
    if total > 0.0:
        numbers[np.argsort(-np.round(exact - numbers, 9), kind="stable")[:count - numbers.sum()]] += 1
    return numbers


def places_by_region(runways: Sequence[Runway], count: int = 12000, seed: int = 0, shares: Optional[Mapping[str, Any]] = None,
                     heights: Optional[Tuple[float, float]] = None, spread: str = "distance") -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
    """The same places as `strips_and_approaches`, with the numbers of those in each strip and in the approach to each end."""
    if count < 2 * len(runways) or not runways:
        raise ValueError(f"count is {count}, expected at least 2 for each of at least one runway")
    if heights is not None and not -np.inf < heights[0] <= heights[1] < np.inf:
        raise ValueError(f"heights are {tuple(heights)}, expected the least and the greatest, m")
    wanted = _region_shares(runways, shares, spread)
    random = np.random.default_rng(seed)
    strips = int(count * sum(wanted["strips"].values()) + 1e-9)
    numbers = [*_split(strips, list(wanted["strips"].values())), *_split(count - strips, list(wanted["approaches"].values()))]
    strip_of = [(runway, runway.start, 1.0) for runway in runways]
    ends = [(runway, point, sign) for runway in runways for point, sign in ((runway.start, -1.0), (runway.end, 1.0))]
    places = []
    for number, ((runway, point, sign), n) in enumerate(zip(strip_of + ends, numbers)):
        if number < len(runways):
            away = random.uniform(0.0, runway.axis()[1], n)
            aside = random.uniform(-STRIP_HALF_WIDTH, STRIP_HALF_WIDTH, n)
            height = random.uniform(*region_heights("strips", heights), n)
        else:
            away = random.uniform(0.0, APPROACH_LENGTH, n)
            base, wider = APPROACH_HALF_WIDTH
            if spread == "area":  # the width of an approach rises evenly with the distance
                area = away / APPROACH_LENGTH * (base * APPROACH_LENGTH + 0.5 * wider * APPROACH_LENGTH ** 2)
                away = (np.sqrt(base ** 2 + 2.0 * wider * area) - base) / wider
            aside = random.uniform(-1.0, 1.0, n) * (base + wider * away)
            top = APPROACH_HEIGHT[0] + APPROACH_HEIGHT[1] * away
            height = random.uniform(APPROACH_LOWEST, 1.0, n) * top if heights is None else random.uniform(*heights, n)
        axis, across = runway.axes()
        ground = np.asarray(point) + (sign * away)[:, None] * axis + aside[:, None] * across
        places.append(np.column_stack([ground, height]))
    names = [name for of in wanted.values() for name in of]
    parts = np.split(np.arange(count), np.cumsum(numbers)[:-1])
    return np.concatenate(places), {name: part for name, part in zip(names, parts) if len(part)}


def by_kind(regions: Mapping[str, np.ndarray]) -> Dict[str, np.ndarray]:
    """The numbers of all places in strips and of all in approaches. @param regions as of `places_by_region`"""
    kinds: Dict[str, List[np.ndarray]] = {}
    for name, numbers in regions.items():
        kinds.setdefault("strips" if name.startswith("strip ") else "approaches", []).append(numbers)
    return {kind: np.concatenate(parts) for kind, parts in kinds.items()}


def strips_and_approaches(runways: Sequence[Runway], count: int = 12000, seed: int = 0, shares: Optional[Mapping[str, Any]] = None,
                          heights: Optional[Tuple[float, float]] = None, spread: str = "distance") -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
    """Places drawn at random, and which lie where: in strips (along each runway, 150 m to either side, 0.5 to 60 m high) and in
    approaches (beyond each runway's end to 3 km, 75 m + 0.15 d to either side at the distance d, 0.02 to 1 of 45 m + 0.0524 d
    high).

    shares   of the places by the name of the region, "strips" and "approaches"; default 1 each. A region without is not there. In place of a
             number, the shares of single ones by name: {"approaches": {"08": 1}} (`region_names`)
    heights  least and greatest z of all places, m, in place of the regions' own: evenly between them
    spread   "distance": as many on each metre along a strip or an approach, and in each of them. "area": as many on each square metre
    @return n x 3 coordinates, m; the numbers of the places by the name of the region
    """
    points, regions = places_by_region(runways, count, seed, shares, heights, spread)
    return points, by_kind(regions)


def read_outlines(file, origin: Sequence[float], attribute: str = "") -> List[Any]:
    """The polygons in a GeoJSON file: each its ring (n x 2, m, open), or, where it has holes, a list of its outer ring and theirs.
    @param origin of the scene: latitude, longitude (deg), height (m) @param attribute only of features that have this one"""
    found: List[Any] = []
    for number, feature in enumerate(_features(pathlib.Path(file))):
        shape = feature["geometry"]
        if shape.get("type") in ("Polygon", "MultiPolygon") and (not attribute or feature["properties"].get(attribute)):
            with naming(f"{file}: features[{number}]"):
                polygons = [shape.get("coordinates")] if shape["type"] == "Polygon" else shape.get("coordinates")
                if not isinstance(polygons, list):
                    raise ValueError("the coordinates of a MultiPolygon are no list")
                for rings in polygons:
                    outline = [_ring(ring, origin) for ring in (rings if isinstance(rings, list) else [None])]
                    found += [outline if len(outline) > 1 else outline[0]] if outline else []
    return found


def _ring(coordinates: Any, origin: Sequence[float]) -> np.ndarray:
    """A ring of a polygon in GeoJSON, n x 2, m, open."""
    corners = _corners(coordinates, origin, 3)
    ring = corners[:-1] if np.array_equal(corners[0], corners[-1]) else corners
    if len(ring) < 3:
        raise ValueError("a ring has fewer than 3 corners")
    return ring


def runway_outline(runway: Runway, beyond: float = 60.0, beside: float = 185.0) -> np.ndarray:
    """The rectangle (4 x 2, m) around a runway where nothing may stand. @param beyond of its ends, m @param beside of its
    middle, m"""
    axis, across = runway.axes() * [[beyond], [beside]]
    start, end = runway.start - axis, runway.end + axis
    return np.array([start - across, end - across, end + across, start + across])


def is_near(points, outline, margin: float = 0.0) -> np.ndarray:
    """Which points (n x 2, m) lie in an outline or within `margin` (m) of it: n of bool. @param outline a ring (m x 2, m), or several:
    the outer one and holes"""
    points = np.asarray(points, dtype=float)[:, :2]
    rings = [np.asarray(ring, dtype=float) for ring in (outline if np.ndim(outline[0]) == 2 else [outline])]
    for ring in rings:
        if ring.ndim != 2 or ring.shape[1] != 2 or len(ring) < 3:
            raise ValueError(f"an outline has the shape {ring.shape}, expected n x 2 with n at least 3")
    starts, ends = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    reach = max(margin, 0.0)
    low, high = np.minimum(starts, ends) - reach, np.maximum(starts, ends) + reach
    near = ((points >= low.min(axis=0)) & (points <= high.max(axis=0))).all(axis=1)
    chosen = np.flatnonzero(near)[np.argsort(points[near, 1])]  # from south to north
    for part in np.array_split(chosen, len(chosen) // POINTS + 1) if len(chosen) else ():
        place, (_, south), (_, north) = points[part, None], points[part[0]], points[part[-1]]
        edges = (low[:, 1] <= north) & (high[:, 1] >= south) & (high[:, 0] >= place[..., 0].min())
        start, end = starts[edges], ends[edges]
        way, off = end - start, place - start
        upward = off[..., 1] >= 0.0
        left = way[:, 0] * off[..., 1] - way[:, 1] * off[..., 0] > 0.0
        crossed = (upward != (place[..., 1] >= end[:, 1])) & (left == upward)  # by the ray to the east
        along = np.clip((off * way).sum(axis=2) / np.maximum((way ** 2).sum(axis=1), 1e-300), 0.0, 1.0)
        close = np.linalg.norm(off - along[..., None] * way, axis=2) < margin
        near[part] = (crossed.sum(axis=1) % 2 == 1) | close.any(axis=1)
    return near


def lattice(bounds: Sequence[float], spacing: float) -> np.ndarray:
    """Points n x 2 (m), x fastest, at most MOST_CANDIDATES. @param bounds least and greatest x, least and greatest y, m, both
    included"""
    if not spacing > 0.0 or bounds[1] < bounds[0] or bounds[3] < bounds[2]:
        raise ValueError(f"spacing {spacing} and bounds {tuple(bounds)} make no lattice")
    counts = [np.floor((high - low) / spacing + 1e-9) + 1.0 for low, high in (bounds[:2], bounds[2:])]
    _check_count(counts[0] * counts[1], f"spacing {spacing} and bounds {tuple(bounds)} make", "take a larger spacing or smaller bounds")
    x, y = (np.arange(low, high + 1e-9 * spacing, spacing) for low, high in (bounds[:2], bounds[2:]))
    return np.column_stack([np.tile(x, len(y)), np.repeat(y, len(x))])


def _check_count(count: float, what: str, instead: str) -> None:
    if not count < MOST_CANDIDATES + 1.0:
        number = f"{count:,.0f}" if count < 1e15 else f"{count:.2g}"
        raise ValueError(f"{what} {number} candidates, expected at most {MOST_CANDIDATES:,}: {instead}")


def _along_verticals(scene, points) -> List[np.ndarray]:
    """z of all surfaces above and below each point (n x 2, m), rising."""
    update(scene.tree)
    surfaces = scene.tree.GetOutput()
    low, high = surfaces.GetBounds()[4:]
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surfaces)
    locator.BuildLocator()
    hits, cells, found = vtkPoints(), vtkIdList(), []
    for x, y in np.asarray(points, dtype=float):
        locator.IntersectWithLine((x, y, low - 1.0), (x, y, high + 1.0), 0.0, hits, cells)
        found.append(np.sort([hits.GetPoint(i)[2] for i in range(hits.GetNumberOfPoints())]))
    return found


def ground_of(scene, points) -> np.ndarray:
    """z of the lowest surface at each point, m; NaN where there is none. @param points n x 2, m"""
    return np.array([z[0] if len(z) else np.nan for z in _along_verticals(scene, points)])


def candidates(points, masts: Sequence[float] = (5.0,), exclusions: Sequence[Tuple[Any, float]] = (), scene=None) -> np.ndarray:
    """Where a lidar may stand, n x 3, m: each point that no exclusion holds, with each mast. Of candidates in one place only the
    first is there, with a warning: two sensors there would be one.

    points      n x 2, m
    masts       heights above the ground, m
    exclusions  outlines (m x 2, m), each with the margin (m) around it
    scene       a Scene: its lowest surface is the ground, and nothing may stand under another one, as in a building. None: the
                ground is at z = 0, as it is where the scene has no surface
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"points have the shape {points.shape}, expected n x 2 coordinates in metres")
    _check_count(len(points) * len(masts), f"{len(points)} points and {len(masts)} masts make", "take fewer")
    free = np.ones(len(points), dtype=bool)
    for outline, margin in exclusions:
        free &= ~is_near(points, outline, margin)
    surfaces = _along_verticals(scene, points[free]) if scene is not None else [np.empty(0)] * np.count_nonzero(free)
    ground = np.array([z[0] if len(z) else 0.0 for z in surfaces])
    top = np.array([z[-1] if len(z) else -np.inf for z in surfaces])
    found = [np.column_stack([points[free], ground + mast])[ground + mast > top] for mast in masts]
    if not any(map(len, found)):
        raise ValueError(f"no candidate is left of {len(points)} points and {len(found)} masts: exclusions hold them all")
    places = np.concatenate(found)
    first = np.sort(np.unique(np.round(places / SAME_PLACE), axis=0, return_index=True)[1])
    if len(first) < len(places):
        warnings.warn(f"{len(places) - len(first)} of {len(places)} candidates stand where another one stands, and are left out",
                      RuntimeWarning, stacklevel=callers_level())
    return places[first]


def weights_of(count: int, regions: Mapping[str, Any], shares: Mapping[str, float],
               mix: Mapping[str, float]) -> np.ndarray:
    """What each place counts for each species: species x places, the sum 1.

    count    number of places
    regions  names, each with the numbers of its places
    shares   of regions, by name: places of a region share it evenly
    mix      shares of species, by name
    """
    for what, given in (("share", shares), ("mix", mix)):
        if not given or min(given.values()) < 0.0 or not 0.0 < sum(given.values()) < np.inf:
            raise ValueError(f"{what} is {dict(given)}, expected numbers from 0 with a sum above 0")
    weights = np.zeros(count)
    for name, share in shares.items():
        if name not in regions or not len(regions[name]):
            raise ValueError(f"no place lies in the region {name!r}; regions are {', '.join(regions)}")
        weights[np.asarray(regions[name])] += share / len(regions[name])
    species = np.array(list(mix.values()), dtype=float)
    return np.outer(species / species.sum(), weights / weights.sum())


def _checked_sites(sites) -> np.ndarray:
    sites = np.asarray(sites, dtype=float)
    if sites.ndim != 2 or sites.shape[1] != 3 or not np.isfinite(sites).all():
        raise ValueError(f"sites have the shape {sites.shape}, expected n x 3 finite coordinates in metres")
    return sites


def look(scene, sensor, sites, places, species: Sequence[str], folder=None, ranks: Optional[Ranks] = None,
         progress: Optional[Callable[[int, int], Any]] = None, array: str = "detection_probability", area_factor: float = 1.0,
         airs: Sequence[Mapping[str, Any]] = ({},), **settings: Any) -> np.ndarray:
    """What a lidar at each site finds at each place: float32, sites x species x places; with several airs sites x (species x airs)
    x places, the airs of a species side by side. Without clutter unless `clutter` is on;
    on one thread unless `number_of_threads` says more, which pays only for many places: ranks share sites better.

    sensor       a Sensor; it is moved, and put back
    sites        n x 3, m
    places       m x 3, m
    species      by name; "" with `effective_area`
    folder       where each site's result is kept, a file of its own: a second call with the same scene, sensor, places and so
                 on reads what is there, also after the first was stopped. Needed on several ranks, which share the sites
    progress     called with the number of sites done and of all that this process makes
    array        a point array of vtkAvianLidarCoverage
    area_factor  on each species' mean effective area
    airs         further settings, all of the same names: visibility, rain_rate, ... For each the lines of sight are those of the first
    settings     properties of Coverage, for example visibility=10e3 (m)

    @throws ValueError that names the argument, Error of Coverage
    """
    sites, places, ranks = _checked_sites(sites), np.asarray(places, dtype=float), ranks or Ranks()
    if not area_factor > 0.0:
        raise ValueError(f"area_factor is {area_factor}, expected a number above 0")
    if ranks.size > 1 and folder is None:
        raise ValueError("folder is not given: ranks share their results there")
    before = sensor.position
    cover = Coverage(scene, sensor, places=places, clutter=False, number_of_threads=1)
    cover.set(**settings)
    with ranks.together():
        try:
            sensor.position = (0.0, 0.0, 0.0)
            inputs = {name: repr(value) for name, value in settings.items() if name != "number_of_threads"}  # which changes no bit
            known = [list(species), array, area_factor, inputs, *([[dict(air) for air in airs]] if any(airs) else [])]
            files = _files(cover, sites, places, known, folder)
            ranks.agree(folder, lambda: [file.name for file in files])
            if len(sites):
                sensor.position = tuple(sites[0])  # who is warned of a place is warned of one that was asked for
            areas = [cover.effective_area] * len(species)
            if area_factor != 1.0:
                areas = [area_factor * float(np.ravel(field_values(cover.set(species=name).data)["effective_area"])[0])
                         for name in species]
            with Updates(cover.algorithm) as again:
                def look_from(i: int) -> List[np.ndarray]:
                    sensor.position = tuple(sites[i])
                    rows = []
                    for (name, area), air in itertools.product(zip(species, areas), airs):
                        cover.set(species=name, effective_area=area, **air)
                        again()
                        values = cover.algorithm.GetOutputDataObject(0).GetPointData().GetArray(array)
                        if values is None:
                            raise ValueError(f"array is {array!r}, expected a point array of vtkAvianLidarCoverage")
                        rows.append(vtk_to_numpy(values))
                    return rows
                found = np.empty((len(sites), len(species) * len(airs), len(places)), dtype=np.float32)
                _fill(found, files, ranks, look_from, progress)
        finally:
            sensor.position = before
    return found


def _fill(found: np.ndarray, files: Sequence[pathlib.Path], ranks: Ranks, make: Callable[[int], Any],
          progress: Optional[Callable[[int, int], Any]] = None, key: Callable[[int], Any] = lambda i: i) -> None:
    """Read each row from its file; make and write what is missing. Ranks share that work.

    make  a row, by its number
    key   equal for neighbouring rows that one rank makes
    """
    kept = {i for i, file in enumerate(files) if _read_kept(file, found[i])}
    damaged = [str(file) for i, file in enumerate(files) if i not in kept and os.path.lexists(file)]
    ranks.wait()  # all have looked before anybody adds anything
    if damaged and ranks.rank == 0:
        warnings.warn(f"kept coverage is damaged and is made again: {', '.join(damaged)}", RuntimeWarning,
                      stacklevel=callers_level())
    todo = [i for i in range(len(found)) if i not in kept]
    groups = [list(of) for _, of in itertools.groupby(todo, key=key)]
    mine = [i for group in groups[ranks.rank::ranks.size] for i in group]
    for number, i in enumerate(mine):
        found[i] = make(i)
        if files:
            files[i].unlink(missing_ok=True)  # a damaged one may be a pipe
            write_whole(files[i], _kept(found[i]))
        if progress:
            progress(number + 1, len(mine))
    ranks.wait()
    for i in sorted(set(todo) - set(mine)):  # of other ranks
        if not _read_kept(files[i], found[i]):
            raise Error(f"{files[i]}: is damaged, which another rank has just written")


def _kept(values: np.ndarray) -> bytes:
    """A file of values: .npy, and behind it the digest of all that."""
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue() + hashlib.sha256(stream.getvalue()).digest()


def _read_kept(file: pathlib.Path, values: np.ndarray) -> bool:
    """Whether a file is whole, as it was written; its values are read into `values`."""
    with contextlib.suppress(OSError):
        content = file.read_bytes() if file.is_file() else b""
        read = np.load(io.BytesIO(content[:-32])) if hashlib.sha256(content[:-32]).digest() == content[-32:] else np.empty(0)
        if (read.shape, read.dtype) == (values.shape, values.dtype):
            values[:] = read
            return True
    return False


def _files(cover: Coverage, sites, places, inputs, folder) -> List[pathlib.Path]:
    """Of each site, named by all that its result depends on."""
    if folder is None:
        return []
    home = pathlib.Path(folder)
    home.mkdir(parents=True, exist_ok=True)
    update(cover.scene.tree)
    table = hashlib.sha256(read_regular(cover.species_file_name)).hexdigest() if cover.species_file_name else ""
    known = [digest_of(cover.scene.tree.GetOutput()), __version__, digest_of_arrays(cover.sensor.beams.data), inputs, table]
    common = hashlib.sha256(as_json(known) + places.tobytes())
    names = []
    for site in sites:
        digest = common.copy()
        digest.update(site.tobytes())
        names.append(home / f"{digest.hexdigest()[:32]}.npy")
    return names


@dataclasses.dataclass(frozen=True)
class Network:
    """Sites that look together, by their numbers, and the weighted share that they detect."""

    sites: Tuple[int, ...]
    value: float


def values_of(found: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The weighted share that each site alone detects. @param found sites x species x places @param weights species x places"""
    _check_weights(found, weights)
    return np.array([np.vdot(site.astype(float), weights) for site in found])


def value_of_same_birds(scene, sensor, sites, places, species: Sequence[str], weights: np.ndarray, airs: Sequence[Mapping[str, Any]] = ({},),
                        **settings: Any) -> float:
    """The weighted share that at least one of the sites detects in one scan if all of them look at the same bird: its heading
    and wing phase are kept from sensor to sensor. Beside it stands value_of, for which each sensor has a bird of its own. Without
    clutter unless `clutter` is on.

    sensor    a Sensor; it is moved, and put back
    sites     n x 3, m: of the network
    places    m x 3, m
    species   by name
    weights   species x places, from weights_of; with several airs (species x airs) x places
    airs      as of look
    settings  properties of Coverage, for example visibility=10e3 (m)

    @throws ValueError that names the argument, Error of Coverage
    """
    sites, places = _checked_sites(sites), np.asarray(places, dtype=float)
    rows = len(species) * len(airs)
    if weights.shape != (rows, len(places)):
        raise ValueError(f"weights have the shape {weights.shape}, expected species x places, {(rows, len(places))}")
    if not (np.isfinite(weights).all() and np.min(weights, initial=0.0) >= 0):
        raise ValueError(f"weights have {np.min(weights):g} among them, expected finite numbers of at least 0")
    before, value = sensor.position, 0.0
    cover = Coverage(scene, sensor, clutter=False, number_of_threads=1)
    cover.set(**settings)
    cover.pose_probabilities = True
    try:
        for first in range(0, len(places), SAME_BIRDS):
            part = slice(first, first + SAME_BIRDS)
            cover.places = places[part]
            for number, name in enumerate(species):
                cover.species = name
                weight = weights[number * len(airs):(number + 1) * len(airs), part]
                missed: np.ndarray = np.ones((*weight.shape, 1), dtype=np.float32)  # airs x places x poses
                for site in sites:
                    sensor.position = tuple(site)
                    found = []
                    for air in airs:
                        cover.set(**air)
                        found.append(cover["pose_probabilities"].reshape(weight.shape[1], -1))
                    missed = missed * (1.0 - np.stack(found))
                value += float(np.vdot(weight, 1.0 - missed.mean(axis=2, dtype=float)))
    finally:
        sensor.position = before
    return value


def value_of(found: np.ndarray, weights: np.ndarray, sites: Sequence[int]) -> float:
    """The weighted share that at least one of the sites detects; sensors are independent."""
    return float(weights.sum() - _missed(found, weights, sites).sum())


def _missed(found, weights, sites) -> np.ndarray:
    """Weights times the probability that none of the sites detects, species x places."""
    left = weights.astype(float)
    for i in sites:
        left = left * (1.0 - found[i].astype(float))
    return left


def greedy(found: np.ndarray, weights: np.ndarray, count: int) -> List[Network]:
    """Networks of 1 to `count` sites, each the one before and the site that adds most. Shapes as for values_of."""
    chosen: List[Network] = []
    sites: Tuple[int, ...] = ()
    for _ in range(_count(found, weights, count)):
        sites += (int(np.argmax(_gains(found, weights, sites))),)
        chosen.append(Network(sites, value_of(found, weights, sites)))
    return chosen


def _check_weights(found, weights) -> None:
    if found.shape[1:] != weights.shape:
        raise ValueError(f"weights have the shape {weights.shape}, expected that of each site's coverage, {found.shape[1:]}")


def _count(found, weights, count) -> int:
    _check_weights(found, weights)
    if not 1 <= count <= len(found):
        raise ValueError(f"count is {count}, expected 1 to {len(found)}, the number of sites")
    return count


def _gains(found, weights, sites) -> np.ndarray:
    """What each site would add to the others; below 0 for these themselves."""
    gains = found.reshape(len(found), -1) @ _missed(found, weights, sites).astype(found.dtype).ravel()
    gains[list(sites)] = -1.0
    return gains


def exchange(found: np.ndarray, weights: np.ndarray, network: Network) -> Network:
    """A network from which no exchange of one site gains any more. Never below the given one."""
    best = network
    while True:
        tried = [best.sites[:k] + best.sites[k + 1:] for k in range(len(best.sites))]
        swapped = [(*rest, int(np.argmax(_gains(found, weights, rest)))) for rest in tried]
        value, sites = max((value_of(found, weights, sites), sites) for sites in swapped)
        if not value > best.value + 1e-9:
            return best
        best = Network(sites, value)


def exhaustive(found: np.ndarray, weights: np.ndarray, count: int) -> Network:
    """The best of all networks of one, two or three sites."""
    if _count(found, weights, count) > 3:
        raise ValueError(f"count is {count}, expected at most 3: there are too many networks of more")
    n = len(found)
    missed = 1.0 - found.reshape(n, -1).astype(float)
    least = np.inf
    sites: Tuple[int, ...] = ()
    for others in itertools.combinations(range(n), max(count - 2, 0)):
        first = others[0] + 1 if others else 0
        left = missed[first:] * (_missed(found, weights, others).ravel())
        if count == 1:
            table = left.sum(axis=1)[:, None]
        else:
            table = left @ missed[first:].T
            table[np.tril_indices(len(table))] = np.inf
        if table.size and table.min() < least:
            least = table.min()
            pair = np.unravel_index(np.argmin(table), table.shape)[:min(count, 2)]
            sites = (*others, *(first + int(i) for i in pair))
    return Network(sites, value_of(found, weights, sites))


def search(found: np.ndarray, weights: np.ndarray, count: int = 3, largest: int = 60) -> List[Network]:
    """The best networks of 1 to `count` sites. One site, and up to three of at most `largest`: exhaustive. Else greedy, then
    exchange.

    found    sites x species x places, from look
    weights  species x places, from weights_of
    """
    return [exhaustive(found, weights, n) if n == 1 or (n <= 3 and len(found) <= largest) else exchange(found, weights, start)
            for n, start in enumerate(greedy(found, weights, count), 1)]


def rank_correlation(a, b) -> float:
    """Spearman's, of two rows of numbers; equal ones share their mean rank."""
    from scipy.stats import spearmanr
    return float(spearmanr(a, b)[0])


def _height(value: Any) -> float:
    """A height (m) as scenes take it: a number, or a text of it, with or without "m"; 0 for what is none."""
    try:
        found = float(re.sub(" ?m$", "", value) if isinstance(value, str) else value)
    except (TypeError, ValueError):
        return 0.0
    return found if found > 0.0 and np.isfinite(found) and not isinstance(value, bool) else 0.0


def with_other_heights(scene_file, folder, offset: Callable[[], float]) -> pathlib.Path:
    """A copy of a scene file in `folder`, where every footprint in GeoJSON whose height is read from an attribute is higher by
    what `offset` gives (m; no height is below 0.1 m). Files keep their names, which objects are named by. @return the new scene
    file"""
    path, out = pathlib.Path(scene_file), pathlib.Path(folder)
    scene = load_json(path)
    changed: Dict[str, Tuple[pathlib.Path, Any]] = {}
    moved = set()
    for item in scene["objects"]:
        for key in ("file", "footprints"):
            if key in item:
                item[key] = str((path.parent / item[key]).resolve())
        name, height = item.get("footprints"), item.get("height_attribute")
        if not (name and height and re.search(r"json(\.gz)?$", name, re.IGNORECASE)):
            continue
        if name not in changed:
            file = pathlib.Path(name)
            new = out.resolve() / f"footprints{len(changed)}" / (file.stem if file.suffix == ".gz" else file.name)
            changed[name] = new, load_json(name)
        item["footprints"], shapes = str(changed[name][0]), changed[name][1]
        features = shapes.get("features") if isinstance(shapes, dict) else None
        for feature in features if isinstance(features, list) else ():
            properties = feature.get("properties") if isinstance(feature, dict) else None
            if not isinstance(properties, dict):
                continue
            value = _height(properties.get(height))
            if value and (id(feature), height) not in moved:
                properties[height] = max(value + offset(), 0.1)
                under = _height(properties.get(item.get("min_height_attribute")))
                if under:  # what does not reach the ground keeps its thickness
                    properties[item["min_height_attribute"]] = max(under + properties[height] - value, 0.0)
                moved.add((id(feature), height))
    out.mkdir(parents=True, exist_ok=True)
    for file, shapes in changed.values():
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(shapes), encoding="utf-8")
    (out / path.name).write_text(json.dumps(scene), encoding="utf-8")
    return out / path.name


def write_sites(folder, sites, columns: Mapping[str, Any], origin: Optional[Sequence[float]] = None,
                description: str = "") -> None:
    """sites.csv and sites.vtp, and sites.geojson where the scene has an origin: a point each, in the order given.

    sites    n x 3, m
    columns  numbers by name, n each
    origin   latitude, longitude (deg), height (m) of the scene's origin
    description  in words, of sites.geojson
    """
    out, data = pathlib.Path(folder), vertices(sites)
    degrees = to_geodetic(sites, origin) if origin is not None else np.empty((0, 3))
    in_degrees = {} if origin is None else {"longitude": degrees[:, 0], "latitude": degrees[:, 1]}
    for name, values in {**columns, **in_degrees}.items():
        if len(values) != len(sites):
            raise ValueError(f"column {name!r} has {len(values)} values, expected {len(sites)}, one for each site")
        add_array(data.GetPointData(), name, np.asarray(values))
    out.mkdir(parents=True, exist_ok=True)
    save(data, out / "sites.vtp")
    save(data, out / "sites.csv")
    if origin is None:
        return
    features = [{"type": "Feature", "properties": {name: np.asarray(values)[i].item() for name, values in columns.items()},
                 "geometry": {"type": "Point", "coordinates": [round(float(lon), 9), round(float(lat), 9), round(float(height), 4)]}}
                for i, (lon, lat, height) in enumerate(degrees)]
    write_whole(out / "sites.geojson", as_json({"type": "FeatureCollection", "description": description, "features": features}))
