# SPDX-License-Identifier: BSD-3-Clause
"""Obstacles of AIXM 5.1, as States publish them (eTOD): the state of each VerticalStructure today, and its parts.

A structure has time slices: BASELINE (or SNAPSHOT) gives the whole state from a day on, PERMDELTA changes it for good,
TEMPDELTA for some time. Of slices with one sequence number, the highest correction counts (AIXM Temporality Concept
1.0). `verticalExtent` is the height of a part above its bottom, which may be the roof of another part."""
from __future__ import annotations

import dataclasses
import datetime
import functools
import math
import pathlib
import re
from typing import Any, Callable, Dict, Iterator, List, Tuple
from xml.etree import ElementTree

from osgeo import ogr, osr

from ..._pipeline import Error
from ..places._features import DECIMAL, form_of
from ..places._gdal import corners_of, degrees, plain, quiet, solid
from ._extract import CROSSING, NO_DEGREES, NO_EXTENT, are_degrees, has_extent

ENDED, FUTURE, NO_DATE = "no longer valid", "not valid yet", "a validity without a date"
NO_BASELINE = "a change without its baseline"
TWICE = "published twice"
MOBILE = "a mobile obstacle"
UNREADABLE = "a geometry that cannot be read"
STRAIGHT = {"Ring", "curveMember", "Curve", "segments", "GeodesicString", "Geodesic", "LineStringSegment", "LineString",
            "posList", "pos", "pointProperty", "pointRep", "Point"}  # elements of rings without arcs
SNAP = 0.01  # gap between the ends of a ring below which its last corner is the first, as a share of the ring's size
BESIDE = 1e-6  # greatest distance of parts at one place, degrees
ON = ("point", "area")  # forms of a part and of another part below it, if their elevations are not known
Row = Tuple[Dict[str, str], Any, str]  # tags, shape (ogr, degrees; or None), reason why the part is left out


def _local(element) -> str:
    return str(element.tag).rpartition("}")[2]


def _text(element, name: str) -> str:
    """The text of a child, or empty."""
    found = element.find(f"{{*}}{name}")
    return (found.text or "").strip() if found is not None else ""


@dataclasses.dataclass
class Slice:
    """A time slice: its properties by name, and when it is valid (dates; empty for an open end)."""

    kind: str
    sequence: int
    correction: int
    begin: str
    end: str
    problem: str  # reason why the slice cannot be used, or empty
    properties: Dict[str, List[Any]]

    @staticmethod
    def of(element) -> Slice:
        properties: Dict[str, List[Any]] = {}
        for child in element:
            properties.setdefault(_local(child), []).append(child)
        begin, end, problem = _period(properties.pop("validTime", []))
        sequence, correction = (int(text) if text.isdecimal() else 0 for text in (
            _text(element, name) for name in ("sequenceNumber", "correctionNumber")))
        kind = _text(element, "interpretation").upper()
        kind = kind if kind in ("PERMDELTA", "TEMPDELTA") else "BASELINE"
        return Slice(kind, sequence, correction, begin, end, problem, properties)

    @property
    def key(self) -> Tuple[str, int, str]:
        """What the corrections of a slice have in common."""
        return self.kind, self.sequence, "" if self.sequence else self.begin

    @property
    def order(self) -> Tuple[int, str]:
        return self.sequence, self.begin

    @property
    def name(self) -> str:
        return next((one.text or "" for one in self.properties.get("name", [])), "").strip()

    def reason(self, today: str) -> str:
        """Why the slice does not hold on a day, or empty."""
        return self.problem or (ENDED if self.end and self.end < today else FUTURE if self.begin > today else "")


def _period(elements: List[Any]) -> Tuple[str, str, str]:
    """The dates of a GML time (empty for an open end), and a reason why they cannot be read. A correction without any
    valid time withdraws a slice."""
    times = [(_local(one), (one.text or "").strip()) for element in elements for one in element.iter()]
    texts = {name: text for name, text in times if name in ("beginPosition", "endPosition", "timePosition") and text}
    if any(not re.match(r"\d{4}-\d\d-\d\d", text) for text in texts.values()):
        return "", "", NO_DATE
    is_withdrawn = bool(elements) and not list(elements[0]) and any(
        key.rpartition("}")[2] in ("nil", "nilReason") for key in elements[0].attrib)
    begin = texts.get("beginPosition", texts.get("timePosition", ""))
    return begin[:10], texts.get("endPosition", "")[:10], ENDED if is_withdrawn else ""


def state(slices: List[Slice], today: str) -> Tuple[Dict[str, List[Any]], str, str]:
    """The properties of a structure on a day (ISO 8601), a note on their source, and why the structure stands nowhere,
    or empty."""
    latest: Dict[Tuple[str, int, str], Slice] = {}
    for one in sorted(slices, key=lambda one: (one.correction, one.begin)):
        latest[one.key] = one
    by_kind = {kind: sorted((one for one in latest.values() if one.kind == kind), key=lambda one: one.order)
               for kind in ("BASELINE", "PERMDELTA", "TEMPDELTA")}
    bases = [one for one in by_kind["BASELINE"] if not one.reason(today)]
    if by_kind["BASELINE"] and not bases:
        return {}, "", by_kind["BASELINE"][-1].reason(today)
    deltas = [one for one in by_kind["PERMDELTA"] if not bases or one.order > bases[-1].order] + by_kind["TEMPDELTA"]
    used = [one for one in deltas if not one.reason(today)]
    properties = dict(bases[-1].properties) if bases else {}
    for one in used:
        properties.update(one.properties)
    if "part" not in properties:
        reason = next((one.reason(today) for one in deltas if one.reason(today)), NO_BASELINE)
        return properties, "", "" if bases or not slices else reason
    _, end, problem = _period(properties.get("featureLifetime", []))
    note = f", changed by {used[-1].kind}" if bases and used else f", from {used[-1].kind} alone" if used else ""
    return properties, note, problem or (ENDED if end and end < today else "")


class Structures:
    """The structures of some files of AIXM. Time slices of one structure in several files belong together."""

    def __init__(self) -> None:
        self.found: Dict[Any, Tuple[Any, pathlib.Path, List[Slice]]] = {}
        self.twice: List[Tuple[Dict[str, str], pathlib.Path]] = []

    def add(self, file: pathlib.Path, content: bytes) -> None:
        try:
            root = ElementTree.fromstring(content)
        except ElementTree.ParseError as error:
            raise Error(f"{file}: cannot be read as AIXM 5.1 ({error})") from None
        structures = root.findall(".//{*}VerticalStructure")
        if not structures:
            raise Error(f"{file}: holds no VerticalStructure, expected AIXM 5.1")
        for element in structures:
            slices = [Slice.of(one) for one in element.iterfind("{*}timeSlice/{*}VerticalStructureTimeSlice")]
            key = _text(element, "identifier").lower().removeprefix("urn:uuid:").removeprefix("uuid.") or object()
            _, _, known = self.found.setdefault(key, (element, file, []))
            there = {(one.key, one.correction) for one in known}
            new = [one for one in slices if (one.key, one.correction) not in there]
            if len(new) < len(slices):
                self.twice.append(({"id": _id(element), "name": slices[-1].name}, file))
            known += new

    def rows(self, metres) -> Iterator[Tuple[pathlib.Path, Row]]:
        """The parts of all structures. @param metres reads a length: text, unit, name of the length"""
        today = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
        for tags, file in self.twice:
            yield file, (tags, None, TWICE)
        for element, file, slices in self.found.values():
            properties, note, reason = state(slices, today)
            whole = ElementTree.Element("state")
            whole.extend([one for elements in properties.values() for one in elements])
            parts = whole.findall("{*}part/{*}VerticalStructurePart")
            known = {"id": _id(element), "name": _text(whole, "name"), "type": _text(whole, "type")}
            if reason or not parts:
                known["name"] = known["name"] or (slices[-1].name if slices else "")
                yield file, (known, None, reason)
                continue
            found = [_part(part, whole, known, note, len(parts) == 1, metres) for part in parts]
            for row in _stacked(found):
                yield file, row


def _id(element) -> str:
    return next((value for key, value in element.attrib.items() if key.endswith("}id")), _text(element, "identifier"))


def _part(part, whole, known: Dict[str, str], note: str, is_single: bool, metres) -> Row:
    """A part of a structure. @param known tags of the structure @param is_single whether it is the only part"""
    tags = {**known, "name": known["name"] or _text(part, "designator"), "part": _text(part, "type"), "note": note}
    if is_single and _text(whole, "group") == "YES":
        tags["group"] = "yes"
    reason = MOBILE if _text(part, "mobile") == "YES" else ""
    if _text(part, "constructionStatus") == "IN_CONSTRUCTION":
        tags["note"] += ", in construction"
    place = next((one for holder in part if _local(holder).startswith("horizontalProjection") for one in holder), None)
    lengths = [(part, "verticalExtent", "height"), (whole, "radius", "radius"), (whole, "length", "length"),
               (whole, "width", "width")] + ([(place, "elevation", "elevation")] if place is not None else [])
    for holder, name, column in lengths:
        one = holder.find(f"{{*}}{name}")
        if one is None or not (one.text or "").strip():
            continue
        try:
            value = metres(one.text.strip(), one.get("uom") or "M", column)
        except ValueError as error:
            reason = reason or ("" if column == "elevation" and "height" in tags else str(error))
            continue
        if value is not None:
            is_used = column == "height" or (column == "elevation" and "height" not in tags)
            tags["note"] += ", m assumed" if is_used and not one.get("uom") else ""
            tags[column] = f"{value:.3f}"
    try:
        crosses = functools.partial(tags.setdefault, CROSSING, "yes")
        return tags, _shape(place, crosses) if place is not None else None, reason
    except ValueError as error:
        return tags, None, reason or str(error)


def _stacked(rows: List[Row]) -> Iterator[Row]:
    """The parts of a structure. A part that begins on top of another part, as an antenna on a roof, gets its heights
    above the ground."""
    def elevation(row: Row) -> float:
        return float(row[0].get("elevation", "nan"))

    placed: List[Row] = []
    for row in sorted(rows, key=lambda row: (form_of(row[1]) != "area", float(row[0].get("elevation", "0")))):
        tags, shape, reason = row
        if shape is None or reason or "height" not in tags:
            continue
        own, top = float(tags["height"]), 0.0
        for below in placed:
            other = float(below[0]["height"])
            begins = elevation(row) - own - (elevation(below) - other)  # above the ground, m; NaN if not known
            is_on = begins > other / 2.0 if not math.isnan(begins) else (form_of(shape), form_of(below[1])) == ON
            if is_on and below[1].Buffer(BESIDE).Contains(shape.Centroid()):
                top = max(top, other)
        if top > 0.0:
            tags.update(min_height=f"{top:.3f}", height=f"{top + own:.3f}")
            tags["note"] += ", on another part"
        placed.append(row)
    yield from rows


def _positions(ring, size: int) -> List[List[str]]:
    """The corners of a ring as they are written, without repeated ones. @param size numbers of a corner"""
    found: List[List[str]] = []
    for one in ring.iter():
        words = (one.text or "").split() if _local(one) in ("pos", "posList") else []
        step = len(words) if _local(one) == "pos" else size
        if words and (step < 2 or len(words) % step):
            raise ValueError(UNREADABLE)
        found += [words[i:i + 2] for i in range(0, len(words), step or 1)]
    return [at for number, at in enumerate(found) if not number or at != found[number - 1]]


def _close_rings(place) -> None:
    """Turns rings of straight lines into closed linear rings, because GDAL refuses others that are open by a hair."""
    sizes = [one.get("srsDimension", "2") for one in place.iter() if one.get("srsDimension")]
    size = int(sizes[0]) if sizes and sizes[0].isdecimal() else 2
    for ring in [one for one in place.iter() if _local(one) in ("Ring", "LinearRing")]:
        if {_local(one) for one in ring.iter()} - STRAIGHT - {"LinearRing"} or any(
                one.get("orientation") == "-" for one in ring.iter()):
            continue
        found = _positions(ring, size)
        if len(found) < 3:
            continue
        places = [[float(word) for word in at] for at in found]
        reach = max(max(column) - min(column) for column in zip(*places))
        gap = max(abs(a - b) for a, b in zip(places[0], places[-1]))
        found[-1 if gap <= SNAP * reach else len(found):] = [found[0]]
        namespace = ring.tag.removesuffix(_local(ring))
        ring.tag = f"{namespace}LinearRing"
        del ring[:]
        corners = ElementTree.SubElement(ring, f"{namespace}posList", srsDimension="2")
        corners.text = " ".join(word for at in found for word in at)


def _shape(place, crosses: Callable[[], Any]):
    """The place of a part (ogr, degrees), or None. `ValueError` has the reason why the part is left out.
    @param crosses is called for rings that cross"""
    srs = next((one.get("srsName") for one in place.iter() if one.get("srsName")), "urn:ogc:def:crs:EPSG::4326")
    words = " ".join(one.text or "" for one in place.iter() if _local(one) in ("pos", "posList", "coordinates"))
    if not words.strip():
        return None
    to_degrees = _to_degrees(srs)
    try:
        if not all(map(DECIMAL.fullmatch, words.replace(",", " ").split())):  # GDAL would read other words as 0
            raise ValueError(UNREADABLE)
        _close_rings(place)
        with quiet():
            read = ogr.CreateGeometryFromGML(ElementTree.tostring(place, "unicode").replace("Elevated", ""))
            shape = plain(read, to_degrees)
    except (RuntimeError, ValueError):
        raise ValueError(UNREADABLE) from None
    form, corners = form_of(shape), corners_of(shape)
    if not form:
        raise ValueError(UNREADABLE)
    if not are_degrees(corners):
        raise ValueError(NO_DEGREES)
    with quiet():
        shape = solid(shape, crossing=crosses) if form == "area" else shape
    if not has_extent(shape, corners, form):
        raise ValueError(NO_EXTENT)
    return shape


def _to_degrees(srs: str):
    """Transformation from a named system, with its own order of axes, to longitude and latitude."""
    code = re.search(r"EPSG[:/]+(?:[\d.]*[:/])?(\d+)$", srs)
    if srs.endswith("CRS84"):
        return osr.CoordinateTransformation(degrees(), degrees())
    system = osr.SpatialReference()
    try:
        system.ImportFromEPSG(int(code[1]) if code else 0)
    except RuntimeError:
        raise ValueError(f"the unknown coordinate system {srs[:60]!r}") from None
    system.SetAxisMappingStrategy(osr.OAMS_AUTHORITY_COMPLIANT)
    return osr.CoordinateTransformation(system, degrees())
