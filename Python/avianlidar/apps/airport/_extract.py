# SPDX-License-Identifier: BSD-3-Clause
"""Extracts of maps: which features become which parts of an airport's scene, which are left out, and why."""
from __future__ import annotations

import collections
import dataclasses
import functools
import re
from typing import Any, Callable, Counter, Dict, List, Optional, Sequence, Set, Tuple

import numpy as np
from osgeo import ogr

from ..places._features import HEIGHTS, ON_ROOF, Feature, Reasons, Table, form_of, height_name, length_of, properties_of
from ..places._gdal import corners_of, geometry, is_closed, parts_of, solid, union, valid

COAST = "coastline"
UNKNOWN, CUT, TWICE = "unknown kind", "cut by the extract's border", "drawn twice"
CROSSING = "with rings that cross, overlap or share edges, repaired"
NO_DEGREES, NO_EXTENT = "coordinates that are not degrees (longitude, latitude)", "no extent"
OUTSIDE = "outside the scene"
STRAY = "a hole outside its outline"
NEAR_ROOF = 3e-5  # greatest distance from the outline of a roof that something stands on, degrees
NO_ROOF = "on a roof that the scene lacks"
EARTH, LONGEST_SIDE = 6.371e6, 50_000.0  # the Earth's radius, and the longest side that a feature may have, m
TOO_LONG = f"a side of more than {LONGEST_SIDE / 1000.0:g} km"
NOT = {"no", "false", "0", "none"}  # values by which a tag says that a feature is not of its kind


def are_degrees(corners: np.ndarray) -> bool:
    """Whether corners (n x 2) are longitudes and latitudes."""
    return bool(np.all(np.abs(corners) <= (360.0, 90.0)))  # also False for nan


def _proper(shape, form: str):
    """Points and lines without empty parts and without lines of fewer than two corners, which GEOS refuses; areas as
    they are. May be empty."""
    if form == "area":
        return shape
    parts = [part for part in parts_of(shape) if part.GetPointCount() >= (2 if form == "line" else 1)]
    if len(parts) == 1:
        return parts[0].Clone()
    kept = ogr.Geometry(ogr.wkbMultiLineString if form == "line" else ogr.wkbMultiPoint)
    for part in parts:
        kept.AddGeometry(part)
    return kept


def _longest_side(shape) -> float:
    """The longest side of lines and areas, m, to some per cent."""
    longest = 0.0
    for part in parts_of(shape):
        for line in [part.GetGeometryRef(i) for i in range(part.GetGeometryCount())] or [part]:
            ends = np.radians(np.array(line.GetPoints() or [(0.0, 0.0)])[:, :2])
            ways = np.diff(ends, axis=0)
            ways[:, 0] = np.arcsin(np.sin(ways[:, 0] / 2.0)) * 2.0 * np.cos(ends[1:, 1])  # also over 180 degrees
            longest = max(longest, float(np.hypot(*ways.T).max(initial=0.0)) * EARTH)
    return longest


def has_extent(shape, corners: np.ndarray, form: str) -> bool:
    """False for lines and areas whose nodes are missing or coincide, and for areas that enclose nothing."""
    if form == "point":
        return True
    away = corners - corners[0]
    far = away[np.argmax(np.hypot(*away.T))]
    least = 1e-9 * np.hypot(*far)  # area of a strip of 0.1 mm
    return least > 0.0 and (form == "line" or shape.Area() > least)


def _as_osm(tags: Dict[str, str], known: Dict[str, Any]) -> Dict[str, str]:
    """Tags of OpenStreetMap beside those of Overture's maps, and of what is out of use and still stands."""
    said = tags.get("class") or ""
    if tags.get("theme") == "buildings" or "has_parts" in tags or "building_id" in tags:
        is_part = tags.get("type") == "building_part" or "building_id" in tags
        tags = {"building:part" if is_part else "building": said or "yes", **tags}
    elif said and tags.get("subtype") in known["subtypes"]:
        tags = {known["subtypes"][tags["subtype"]]: said.replace("power_", ""), **tags}
    tags.update({name: tags[name].lower() for name in known["main"] if name in tags})
    for name in [name for name in tags if name.startswith(("disused:", "abandoned:"))]:
        if name.split(":", 1)[1] in known["standing"]:
            tags = {name.split(":", 1)[1]: tags[name], **tags}
    return tags


class Extract:
    """What an extract holds. It takes features one by one."""

    def __init__(self, known: Dict[str, Any], are_nested: bool = False):
        """@param are_nested whether outlines inside an area are holes, as `valid` says"""
        self.known, self.are_nested = known, are_nested
        kinds = known["kinds"].items()
        self.kinds = {form: Table((kind, tags) for kind, rule in kinds if form in rule["from"] for tags in rule["tags"])
                      for form in ("point", "line", "area")}
        self.reasons = Reasons(known)
        self.nouns = {*known["main"], "building:part"}
        self.lines, self.model_tags = (Table(("", tags) for tags in known[name]) for name in ("lines", "models"))
        self.features: List[Feature] = []  # after `done`
        self.aerodromes: List[Feature] = []
        self.models: List[Feature] = []  # model airfields
        self.thresholds: List[Feature] = []  # of runways, points
        self.left: List[Feature] = []
        self.apart = 0  # features that lie far from the scene, of any kind
        self.used: Counter[str] = collections.Counter()  # features that the scene follows but does not draw
        self.unknown: Counter[str] = collections.Counter()  # by tag
        # With ranks: the greater of two alike features counts.
        self.seen: Dict[Any, List[Tuple[int, Feature]]] = collections.defaultdict(list)
        self.cut: Set[str] = set()  # ways of which nodes are missing
        self.wrong: Set[Tuple[str, str]] = set()  # "way" or "relation", and id: objects with nodes at no place

    def leave(self, feature: Feature, reason: str) -> None:
        self.left.append(feature.left(reason))

    def hear(self, words: str) -> None:
        """What GDAL's OSM driver says: it leaves out incomplete relations, and ways of fewer than two nodes."""
        part = re.search(r"For way (-?\d+), got only", words)
        gone = re.search(r"(Way|Relation) (-?\d+) (?:has missing ways|with \d+ nodes( that)?)", words)
        if part:
            self.cut.add(part[1])
        if gone:
            reason = CUT if gone[3] or "missing" in words else "no nodes"
            kind = gone[1].lower()
            self.leave(Feature(kind, {"id": gone[2]}), NO_DEGREES if (kind, gone[2]) in self.wrong else reason)
        elif words.startswith("Non closed ring detected"):
            self.leave(Feature("relation", {}), "unclosed")

    def surroundings(self, bounds: Optional[Sequence[float]] = None) -> Optional[Tuple[float, ...]]:
        """A box that holds the scene with some space around it: west, east, south and north end, degrees. None without
        `bounds` and without runways."""
        shapes = [one.shape for alike in self.seen.values() for _, one in alike if one.kind == "runway"]
        if bounds is None and not shapes:
            return None
        boxes = [shape.GetEnvelope() for shape in shapes] if bounds is None else [np.array(bounds)[[0, 2, 1, 3]]]
        lows, highs = np.array(boxes)[:, ::2].min(axis=0), np.array(boxes)[:, 1::2].max(axis=0)
        margin = np.full(2, 0.002 + (1.1 * np.degrees(self.known["margin"] / EARTH) if bounds is None else 0.0))
        margin[0] /= max(np.cos(np.radians(max(-lows[1], highs[1]))), 1e-3)
        margin += 0.1 * (highs - lows)
        (west, south), (east, north) = lows - margin, highs + margin
        return west, east, south, north

    def _kinds(self, tags: Dict[str, str], form: str, closed: bool) -> List[Tuple[str, str]]:
        """Kinds of a feature, each with the form that it takes: what is closed may be an area, a line, and both."""
        is_area, is_point = tags.get("area") == "yes", form == "point"
        # GDAL's own idea of polygons: closed ways of aeroway, and others with area=yes, which it drops.
        is_way = form == "line" or ("aeroway" in tags) == ("osm_way_id" in tags)
        solid = closed and (is_area or not is_way or self.lines.find(tags) is None)
        is_line = not is_point and (not (closed and is_area) or "barrier" in tags)
        takes = {"point": is_point, "area": solid, "line": is_line}
        found = {one: self.kinds[one].find(tags) for one, fitting in takes.items() if fitting}
        known = [(kind, one) for one, kind in found.items() if kind and (one, kind) != ("line", found.get("area"))]
        has_height = any(length_of(tags[name]) for name in HEIGHTS if name in tags)
        if not known and has_height and (is_point or (solid and not any(name in tags for name in self.known["low"]))):
            known = [("obstacle", "point" if is_point else "area")]
        return known

    def take(self, tags: Dict[str, str], shape) -> None:
        """A feature. @param shape ogr, degrees; may be None"""
        tags, form = _as_osm(tags, self.known), form_of(shape)
        if tags.get("type") == "building" and "building" in tags and not form and shape is not None:
            # a relation of outlines and parts
            crosses = functools.partial(tags.setdefault, CROSSING, "yes")
            areas = [solid(part, crossing=crosses, nested=self.are_nested) for part in parts_of(shape)
                     if form_of(part) == "area" or is_closed(part)]
            shape, form = union(areas), "area"
        shape = _proper(shape, form) if form else shape
        one = Feature("", tags, shape)
        corners = corners_of(shape) if form else np.empty((0, 2))
        if not len(corners):
            if shape is None or shape.IsEmpty():
                self.leave(one, "without a geometry")
            elif tags.get("type") == "building":  # whose members are read by themselves
                self.used["relation"] += 1
            else:
                self._do_not_know(tags)
            return
        closed, use = form == "area" or is_closed(shape), ""
        said = {name: word for name, word in tags.items() if name not in self.nouns or word.lower() not in NOT}
        kinds = self._kinds(said, form, closed)
        if {kind for kind, _ in kinds} - {"obstacle"}:
            tags = said
            one = Feature("", tags, shape)
        else:
            kinds = self._kinds(tags, form, closed)
        is_coast = tags.get("natural") == COAST
        wrong = "" if are_degrees(corners) else NO_DEGREES
        if not wrong and form != "point" and not is_coast and _longest_side(shape) > LONGEST_SIDE:
            wrong = TOO_LONG
        if wrong:
            self.leave(Feature(next(iter(kinds), ("",))[0], tags), wrong)
            return
        if self.model_tags.find(tags) is not None:
            self.models.append(one)
        if tags.get("aeroway") == "threshold" and form == "point":
            use = "threshold"
            self.thresholds.append(one)
        elif tags.get("aeroway") == "aerodrome" and "heliport" not in map(tags.get, ("aerodrome:type", "aerodrome")):
            outline = solid(shape, nested=self.are_nested) if closed else shape
            if not outline.IsEmpty():
                use = "aerodrome"
                self.aerodromes.append(Feature("", tags, outline))
        if is_coast and form != "point":
            shape = solid(shape, nested=self.are_nested) if form == "area" else shape
            if has_extent(shape, corners, form):
                self._keep(Feature(COAST, tags, shape), form, corners)
            else:
                self.leave(Feature(COAST, tags), NO_EXTENT)
            return
        if not kinds:
            self._leave_unknown(one, form, use)
        reason = self.reasons.find(tags) if kinds else None
        for kind, taken in kinds:
            one = Feature(kind, {**tags}, shape)
            if not reason and taken == "area":
                one.shape = solid(shape, functools.partial(self.leave, one, STRAY),
                                  functools.partial(one.tags.setdefault, CROSSING, "yes"), self.are_nested)
            elif taken != form:
                one.shape = _proper(ogr.ForceToMultiLineString(shape), "line")
            if reason or not has_extent(one.shape, corners, taken):
                self.leave(one, reason or self._broken(tags) or NO_EXTENT)
                continue
            self._keep(one, taken, corners)

    def _leave_unknown(self, one: Feature, form: str, use: str) -> None:
        """What no rule takes: what is gone or is not there yet, what is not closed, points of what has an outline, all
        else. @param use what it is used for, or empty"""
        lifecycle = self.known["lifecycle"]
        gone = {name: name.split(":", 1) for name in one.tags if ":" in name and name.split(":")[0] in lifecycle}
        rests = {rest: one.tags[name] for name, (_, rest) in gone.items()}
        was = self.kinds["area" if form == "line" else form].find(rests)
        one.kind = was or (form != "area" and self.kinds["area"].find(one.tags)) or ""
        if was:
            self.leave(one, lifecycle[next(iter(gone.values()))[0]])
        elif "height" in self.known["kinds"].get(one.kind, ()):
            reason = "a point without an outline" if form == "point" else self._broken(one.tags) or "unclosed"
            self.leave(one, self.reasons.find(one.tags) or reason)
        elif use:
            self.used[use] += 1
        else:
            self._do_not_know(one.tags)

    def _broken(self, tags: Dict[str, str]) -> str:
        """Why nodes of a line or an area are missing, or empty."""
        way = tags.get("osm_way_id")
        if (("way", way) if way else ("relation", tags.get("osm_id"))) in self.wrong:
            return NO_DEGREES
        return CUT if way in self.cut else ""

    def _do_not_know(self, tags: Dict[str, str]) -> None:
        name = next((name for name in self.known["main"] if name in tags), None)
        self.unknown[f"{name}={tags[name]}" if name else "others"] += 1

    def _keep(self, one: Feature, form: str, corners: np.ndarray) -> None:
        """Once each: extracts repeat closed ways as lines and areas, and the outer way of a relation. What stands above
        or beyond another of the same corners is another."""
        alike = self.seen[one.kind, frozenset(map(tuple, np.round(corners, 9).tolist()))]
        rank = 99 if form == "line" else sum(max(part.GetGeometryCount(), 1) for part in parts_of(one.shape))
        for number, (other_rank, other) in enumerate(alike):
            greater = self._greater(one, other)
            if greater is not None:
                lesser = other if greater is one else one
                self.leave(lesser, TWICE)
                shape = (one if rank > other_rank else other).shape
                alike[number] = max(rank, other_rank), Feature(one.kind, {**lesser.tags, **greater.tags}, shape)
                return
        alike.append((rank, one))

    def _greater(self, one: Feature, other: Feature) -> Optional[Feature]:
        """Which of two in one place counts: the one whose height is not assumed, else the one that reaches from below
        to above the other. None where neither does."""
        rule = self.known["kinds"].get(one.kind, {})
        if "height" not in rule:
            return other
        name, rows = height_name(rule), [properties_of(each, self.known) for each in (one, other)]
        is_assumed, is_other_assumed = ("min_height" not in row and row[f"{name}_from"].startswith("assumed")
                                        for row in rows)
        (low, high), (other_low, other_high) = ((row.get("min_height", 0.0), row[name]) for row in rows)
        if is_assumed or (not is_other_assumed and other_low <= low and high <= other_high):
            return other
        return one if is_other_assumed or (low <= other_low and other_high <= high) else None

    def done(self) -> Extract:
        if self.apart:
            self.left.append(Feature("any kind", {}, count=self.apart, reason=OUTSIDE))
        features = [one for alike in self.seen.values() for _, one in alike]
        for one in features:
            form = form_of(one.shape)
            broken = self._broken(one.tags) if form != "point" else ""
            if broken and form == "area":
                self.leave(one, broken)
            else:
                self.features.append(dataclasses.replace(one, tags={**one.tags, **({CUT: broken} if broken else {})}))
        return self


def without_parts(features: List[Feature], known: Dict[str, Any]) -> Tuple[List[Feature], List[Feature]]:
    """Buildings of which parts are drawn lose the ground below these, so that parts may be lower than their outline.
    @return features, and the buildings that are nothing but their parts"""
    parts = [one for one in features if one.kind == "part" and "min_height" not in properties_of(one, known)]
    boxes = np.array([part.shape.GetEnvelope() for part in parts]).reshape(-1, 4)
    kept: List[Feature] = []
    drawn: List[Feature] = []
    for one in features:
        rule, rest = known["kinds"][one.kind], None
        is_building = "level_height" in rule or rule["class"] in ("building", "house")
        if one.kind != "part" and form_of(one.shape) == "area" and is_building:
            west, east, south, north = one.shape.GetEnvelope()
            near = (boxes[:, 0] <= east) & (boxes[:, 1] >= west) & (boxes[:, 2] <= north) & (boxes[:, 3] >= south)
            whole = valid(one.shape)
            rest = whole.Difference(union([parts[i].shape for i in np.flatnonzero(near)])) if near.any() else None
        if rest is not None and rest.Area() < known["drawn_by_parts"] * whole.Area():
            drawn.append(one)
            continue
        if rest is not None and rest.Area() < whole.Area():
            one.shape = rest
        kept.append(one)
    return kept, drawn


def _find_in_lists(table: Table, tags: Dict[str, str]) -> Optional[str]:
    """The name in a table of small words for tags with lists of words, as "Roof;outdoor"."""
    found = (table.find({name: word.strip().replace(" ", "_")}) for name in table.rows
             for word in re.split("[;,]", tags.get(name, "").lower()))
    return next((name for name in found if name), None)


def on_roofs(features: List[Feature], known: Dict[str, Any],
             base: Callable[[Any, Any], float]) -> Tuple[List[Feature], List[Feature]]:
    """What stands on roofs by its tags gets the height of the highest roof below it, unless a least height is given.
    @param base height of the lowest ground below an area above the ground at a point, m
    @return features, and features that are left out, with the reason"""
    table = Table(("roof", tags) for tags in known["on_roofs"])
    above = [one for one in features if "height" in known["kinds"][one.kind] and _find_in_lists(table, one.tags)
             and "min_height" not in properties_of(one, known)]
    standing = {id(one) for one in above}
    hosts = [one for one in features if form_of(one.shape) == "area" and id(one) not in standing
             and known["kinds"][one.kind]["class"] in known["roofs"] and "height" in known["kinds"][one.kind]]
    boxes = np.array([host.shape.GetEnvelope() for host in hosts]).reshape(-1, 4)
    boxes += (-NEAR_ROOF, NEAR_ROOF, -NEAR_ROOF, NEAR_ROOF)
    left: List[Feature] = []
    for one in above:
        place = one.shape.PointOnSurface() if form_of(one.shape) == "area" else one.shape.Centroid()
        west, east, south, north = place.GetEnvelope()
        near = (boxes[:, 0] <= west) & (boxes[:, 1] >= east) & (boxes[:, 2] <= south) & (boxes[:, 3] >= north)
        roofs = [(row["height"] + base(host.shape, place), row["height_from"]) for host, row in (
            (hosts[i], properties_of(hosts[i], known)) for i in np.flatnonzero(near)
            if valid(hosts[i].shape).Distance(place) <= NEAR_ROOF)]
        if not roofs or "medium" in known["kinds"][one.kind]:
            left.append(one.left(NO_ROOF if not roofs else "a plant on a roof"))
            continue
        roof, source = max(roofs)
        one.tags = {**one.tags, ON_ROOF: f"{max(roof, 0.0):.3f}", f"{ON_ROOF}_from": f"the roof, {source}"}
    gone = {id(one) for one in above if ON_ROOF not in one.tags}
    return [one for one in features if id(one) not in gone], left


def sea(features: List[Feature], box) -> List[Any]:
    """Areas of a box that lie to the right of its coastlines, as OpenStreetMap draws them. A polygon is an island. None
    where coastlines end within the box. @param box ogr, degrees, as the areas"""
    lines, right = box.Boundary(), []
    parts = [part for one in features for part in parts_of(one.shape)]
    for part in parts:
        points = corners_of(part)
        if form_of(part) == "area" and np.sum(points[:-1, 0] * points[1:, 1] - points[1:, 0] * points[:-1, 1]) < 0.0:
            points = points[::-1]  # land is to the left
        coast = geometry("LineString", points).Intersection(box)
        lines = lines.Union(coast)
        for ends in map(corners_of, parts_of(coast)):
            beside = 1e-3 * np.diff(ends, axis=0)[:, ::-1] * (1, -1)
            right += [geometry("Point", at) for at in (ends[:-1] + ends[1:]) / 2 + beside]
    found = [face for face in parts_of(lines.Polygonize()) if any(map(face.Contains, right))] if right else []
    return [] if sum(face.Area() for face in found) > 0.999 * box.Area() else found
