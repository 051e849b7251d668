# SPDX-License-Identifier: BSD-3-Clause
"""The runways of one airport, from the features of an extract."""
from __future__ import annotations

import collections
import math
import pathlib
import re
from typing import Any, Dict, List, Optional, Sequence, Set, Tuple

import numpy as np
from osgeo import osr
from scipy.sparse.csgraph import connected_components

from ..._pipeline import Error
from ..places._features import Feature, form_of
from ..places._gdal import box_of, coordinate_system, degrees, geometry, moved, parts_of
from ..places._regions import designators
from ._extract import NO_DEGREES, OUTSIDE, Extract

NEAR_AERODROME = 3000.0  # greatest distance of a runway from its aerodrome, m
ONE_AIRPORT = 6000.0  # greatest distance between runways of one airport in an extract without aerodromes, m
MODEL_NEAR = 100.0  # greatest distance of a runway from the model airfield that it belongs to, m
ALONG = math.cos(math.radians(10.0))  # cosine of the angle below which two directions are equal
THRESHOLD_BESIDE = 30.0  # greatest distance of a threshold beside a runway, m
THRESHOLD_BEYOND = 30.0  # least distance of a displaced threshold from a runway's end, m


def _axis_of(hull) -> Tuple[np.ndarray, float]:
    """Ends of the line between the short sides of the smallest rectangle around a convex area, and the rectangle's
    width. @param hull ogr, m"""
    corners = np.array(hull.Boundary().GetPoints())[:, :2]
    ways = np.diff(corners, axis=0)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    axes = np.stack([ways, ways[:, ::-1] * (-1, 1)], axis=1)  # direction of each side, and the perpendicular direction
    turned = axes @ corners.T
    axis = axes[np.argmin(np.ptp(turned, axis=2).prod(axis=1))]
    low, high = (axis @ corners.T).min(axis=1), (axis @ corners.T).max(axis=1)
    middle, sides = (low + high) / 2, high - low
    ends = np.array([middle + sign * 0.5 * sides * (sides == sides.max()) for sign in (-1, 1)])
    return ends @ axis, float(sides.min())


def _ends(tags: Dict[str, str]) -> Set[str]:
    """The designators in `ref`, as "09L" for "9L"."""
    words = [word.strip().upper() for word in re.split(r"[/;-]", tags.get("ref", ""))]
    return {word.zfill(3 if word[-1].isalpha() else 2) for word in words if word}


class _Piece:
    """A way that is part of a runway: its feature, tags, and points (n x 2, m)."""

    def __init__(self, feature: Feature, points: np.ndarray, **more: str):
        self.feature, self.tags, self.points = feature, {**more, **feature.tags}, points
        self.is_displaced = "displaced_threshold" in (self.tags.get("runway"), self.tags.get("aeroway"))
        way = points[-1] - points[0]
        self.length = float(np.linalg.norm(way))
        self.along = way / self.length

    def goes_on(self, other: _Piece, known: Dict[str, Any]) -> bool:
        """Whether two ways are one runway: no contradicting numbers, one line, and at most a gap of the map."""
        mine, theirs = designators(self.tags.get("ref", "")), designators(other.tags.get("ref", ""))
        if mine and theirs and not mine & theirs:
            return False
        long, short = (self, other) if self.length >= other.length else (other, self)
        off = short.points[[0, -1]] - long.points[0]
        across = np.abs(off @ np.array([-long.along[1], long.along[0]]))
        at = np.sort(off @ long.along)
        gap = max(at[0] - long.length, -at[1], 0.0)
        return bool(across.max() <= known["runway_offset"] and gap <= known["runway_gap"])


def _joined(pieces: List[_Piece], known: Dict[str, Any]) -> List[Tuple[Feature, np.ndarray, List[float]]]:
    """Runways joined from pieces: features without a geometry, ends (2 x 2, m), and the displacement of each end's
    threshold, m. The first end belongs to the first number of `ref`."""
    pieces = sorted(pieces, key=lambda one: -one.length)
    fit = np.array([[one.goes_on(other, known) for other in pieces] for one in pieces])
    labels = connected_components(fit)[1] if pieces else fit
    members = sorted((np.flatnonzero(labels == label) for label in np.unique(labels)), key=lambda of: of[-1])
    found = []
    for numbers in members:
        group = sorted([pieces[i] for i in numbers], key=lambda one: one.is_displaced)  # the longest way first
        tags = {name: value for one in reversed(group) for name, value in one.tags.items() if name != "runway"}
        ends_named = {end for one in group for end in _ends(one.tags)}
        if len(_ends(tags)) == 1 and ends_named == designators(tags["ref"]):  # pieces are named by one end each
            tags["ref"] = "/".join(sorted(ends_named))
        points, along, start = np.concatenate([one.points for one in group]), group[0].along, group[0].points[0]
        number = re.match(r"(\d{1,2})[LCR]?\s*/", tags.get("ref", ""))
        if number and math.cos(math.atan2(along[0], along[1]) - math.radians(10.0 * int(number[1]))) < 0.0:
            along = -along
        at = (points - start) @ along
        ends = points[[np.argmin(at), np.argmax(at)]]
        inner = np.concatenate([(one.points - start) @ along for one in group if not one.is_displaced] or [at])
        one = Feature("runway", tags, None, len({id(piece.feature) for piece in group}))
        found.append((one, ends, [float(inner.min() - at.min()), float(at.max() - inner.max())]))
    return found


def _displaced(ends: np.ndarray, by_pieces: List[float], thresholds: List[np.ndarray]) -> List[float]:
    """The displacement of each end's threshold, m, from ways of a runway or from points of thresholds."""
    length = float(np.linalg.norm(ends[1] - ends[0]))
    along, found = (ends[1] - ends[0]) / length, list(by_pieces)
    for point in thresholds:
        at, beside = (point - ends[0]) @ along, abs((point - ends[0]) @ np.array([-along[1], along[0]]))
        for end, away in enumerate((at, length - at)):
            if beside <= THRESHOLD_BESIDE and THRESHOLD_BEYOND < away < length / 2:
                found[end] = max(found[end], float(away))
    return found


def _name_of(aerodrome: Feature) -> str:
    code = aerodrome.tags.get("icao", "")
    return " ".join(filter(None, (code, aerodrome.tags.get("name", ""), "" if code else "(no ICAO code)")))


def choose_runways(file: pathlib.Path, extract: Extract, known: Dict[str, Any], icao: Optional[str],
                   box: Optional[Sequence[float]]) -> Tuple[List[Feature], Optional[Feature]]:
    """The runways of one airport as lines (degrees), and its aerodrome, if the extract has one. Ways that are too short
    for a runway are left out. @param icao code of the airport, if given @param box west, south, east, north, degrees:
    the runways must meet this box, if given"""
    lines, areas = ([one for one in extract.features if one.kind == "runway" and form_of(one.shape) == form]
                    for form in ("line", "area"))
    if not lines + areas:
        lost = sum(left.kind == "way" and left.reason != NO_DEGREES for left in extract.left)
        nodes = f"; {lost} ways lack their nodes; `osmium sort` puts the nodes before the ways" if lost else ""
        other = next((f"; left out: {left.reason}" for left in extract.left if left.kind == "runway"), nodes)
        nowhere = [f"node {left.id}: {left.name}" for left in extract.left if left.kind == "node"]
        if nowhere:
            other += f"; {nowhere[0]}, expected degrees as in 53.602"
            other += f", as of {len(nowhere) - 1} other nodes" if nowhere[1:] else ""
        if lost and file.suffix.lower() == ".pbf":
            other += ("; if the ways contain the coordinates of nodes, `osmium cat FILE -o FILE.osm` writes a suitable "
                      "extract")
        raise Error(f"{file}: holds no runway, expected lines or areas with the tag aeroway=runway{other}")
    middles = np.array([one.shape.Centroid().GetPoint_2D() for one in lines + areas])
    middle = (lines + areas)[int(np.argmin(np.abs(middles - np.median(middles, axis=0)).sum(axis=1)))].shape.Centroid()
    local = coordinate_system((middle.GetY(), middle.GetX(), 0.0))
    to_local = osr.CoordinateTransformation(degrees(), local)
    to_degrees = osr.CoordinateTransformation(local, degrees())

    def is_near(one: Feature) -> bool:
        """Whether a feature is near enough for the local system, which does not reach the far side of the Earth."""
        try:
            moved(one.shape, to_local)
        except RuntimeError:
            return False
        return True

    def points_of(shape) -> np.ndarray:
        return np.array(moved(shape, to_local).GetPoints())[:, :2]

    far = [one for one in lines + areas if not is_near(one)]
    for one in far:
        extract.leave(one, "far from other runways")
    extract.features[:] = [one for one in extract.features if not any(one is other for other in far)]
    lines, areas = ([one for one in group if not any(one is other for other in far)] for group in (lines, areas))
    extract.aerodromes, extract.models, extract.thresholds = (
        [one for one in group if is_near(one)] for group in (extract.aerodromes, extract.models, extract.thresholds))

    pieces = []
    for one in lines:
        ways = [points for points in map(points_of, parts_of(one.shape))
                if np.linalg.norm(points[-1] - points[0]) > 1.0]
        pieces += [_Piece(one, points) for points in ways]
        if not ways:
            extract.leave(one, "a runway of no length")
    drawn = [(piece, geometry("LineString", piece.points)) for piece in pieces]
    for one in areas:
        hull = moved(one.shape, to_local).ConvexHull()
        ends, width = _axis_of(hull)
        area = _Piece(one, ends, width=f"{min(width, known['widest']):.1f}")
        inside = sum(line.Intersection(hull).Length() for piece, line in drawn if abs(piece.along @ area.along) > ALONG)
        if inside < area.length / 2:  # the area is not along the line
            pieces.append(area)
            extract.features.remove(one)
    models = [moved(one.shape, to_local) for one in extract.models]
    thresholds = [points_of(part)[0] for one in extract.thresholds for part in parts_of(one.shape)]
    runways: List[Tuple[Feature, Any]] = []  # features with their lines, m
    for one, ends, by_pieces in _joined(pieces, known):
        line = geometry("LineString", ends)
        one.shape = moved(line, to_degrees)
        if line.Length() < known["model_runway"] and any(model.Distance(line) <= MODEL_NEAR for model in models):
            extract.leave(one, "of a model airfield")
        elif line.Length() < known["shortest_runway"]:
            extract.leave(one, f"a runway shorter than {known['shortest_runway']:g} m")
        else:
            displaced = zip(("displaced_start", "displaced_end"), _displaced(ends, by_pieces, thresholds))
            one.tags = {**one.tags, **{name: f"{away:.1f}" for name, away in displaced if away > 1.0}}
            runways.append((one, line))
    if not runways:
        raise Error(f"{file}: holds no runway of {known['shortest_runway']:g} m or more")
    places = [moved(one.shape, to_local) for one in extract.aerodromes]
    groups: Dict[Any, List[Tuple[Feature, Any]]] = collections.defaultdict(list)
    for one, line in runways:
        if box is not None and not one.shape.Intersects(box_of(box)):
            extract.leave(one, OUTSIDE)
            continue
        away, near = min(((place.Distance(line), i) for i, place in enumerate(places)), default=(math.inf, -1))
        if away <= NEAR_AERODROME:
            code = extract.aerodromes[near].tags.get("icao")
            key: Any = next(number for number, place in enumerate(extract.aerodromes)
                            if number == near or (code and place.tags.get("icao") == code))
        else:  # groups from the distances between runways
            close = (key for key, members in groups.items() if isinstance(key, str)
                     and min(other.Distance(line) for _, other in members) <= ONE_AIRPORT)
            key = next(close, f"runway {one.tags.get('ref', '?')}")
        groups[key].append((one, line))
    if not groups:
        raise Error(f"{file}: --bounds {' '.join(f'{x:g}' for x in box or ())} holds none of its runways")
    names = {key: _name_of(extract.aerodromes[key]) if isinstance(key, int) else key for key in groups}
    chosen = list(groups)
    if icao is not None:
        chosen = [key for key in groups if isinstance(key, int)
                  and extract.aerodromes[key].tags.get("icao", "").upper() == icao.upper()]
        if not chosen:
            raise Error(f"{file}: holds no airport {icao} with a runway, but: {', '.join(names.values())}")
    elif len(groups) > 1 and box is None:
        raise Error(f"{file}: holds runways of {len(groups)} airports: {', '.join(names.values())}; "
                    "expected one airport, or --icao CODE or --bounds W S E N to choose one")
    for key in groups:
        if key not in chosen:
            for one, _ in groups[key]:
                extract.leave(one, "of another airport")
    aerodrome = next((extract.aerodromes[key] for key in chosen if isinstance(key, int)), None)
    return [one for key in chosen for one, _ in groups[key]], aerodrome
