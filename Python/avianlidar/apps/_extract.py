# SPDX-License-Identifier: BSD-3-Clause
"""Extracts of maps: which features become which parts of an airport's scene, which are left out, and why. GDAL reads."""
from __future__ import annotations

import collections
import contextlib
import dataclasses
import datetime
import json
import mmap
import pathlib
import re
import tempfile
from typing import Any, Callable, Counter, Dict, Iterable, Iterator, List, Optional, Set, Tuple
from xml.etree import ElementTree

import numpy as np
from osgeo import gdal, ogr, osr

from .._pipeline import Error
from ._json import load_json, naming

SUFFIXES = {".osm": "OSM", ".pbf": "OSM", ".geojson": "GeoJSON", ".gpkg": "GPKG"}  # with GDAL's drivers
LARGEST = 256 << 20  # bytes of an extract
TALLEST = 1000.0  # m: what is higher is no height
LONGEST_LENGTH = 100  # characters
COAST = "coastline"
UNKNOWN, CUT, TWICE = "unknown kind", "cut by the extract's border", "drawn twice"
CONTROLS = re.compile("[\x00-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")  # and marks of direction, which disorder a line
TAG = re.compile(r'"((?:[^"\\]|\\.)*)"=>"((?:[^"\\]|\\.)*)"')  # of GDAL's OSM driver
THOUSANDS = "[, \u00a0\u202f'\u2019]"  # between groups of three digits
NUMBER = rf"\d{{1,3}}(?:{THOUSANDS}\d{{3}})+(?:\.\d+)?|\d+(?:[.,]\d+)?"
LENGTH = re.compile(rf"(?:~|<|>|≈|\+|c\.|ca\.?|circa|approx\.?|about|max\.?|up to)?\s*({NUMBER})\s*(?:(?:±|\+/?-)\s*(?:{NUMBER})|\+)?\s*"
                    r"(mm|cm|km|millimet\w+|centimet\w+|kilomet\w+|met(?:er|re)s?|mtrs?|mts?|m|м|метр\w*|米|ft|foot|feet|['′]|yd|yards?|stor[ei]\w*|floors?|levels?)?\.?"
                    rf"\s*-?\s*(?:({NUMBER})\s*(?:\"|''|″|in|inch|inches)\.?)?\s*(?:\(.*\)|a\.?g\.?l\.?|above ground\w*(?: level)?|high|tall|hoch)?", re.IGNORECASE)
UNITS = {"mm": 1e-3, "mil": 1e-3, "c": 1e-2, "k": 1e3, "f": 0.3048, "'": 0.3048, "′": 0.3048, "y": 0.9144}  # m, by how a unit begins
HEIGHTS = ("height", "building:height", "est_height", "height_m", "render_height", "measuredHeight", "height:hub")
LEVELS = ("building:levels", "num_floors", "levels", "floors")
MIN_HEIGHTS = ("min_height", "building:min_height", "render_min_height")
MIN_LEVELS = ("building:min_level", "min_level", "min_floor")
NOTHING = re.compile(r"\s*(?:-\d+(?:\.\d+)?|0*\.?0*)\s*m?\s*")  # no height
WIDTHS = ("width", "width_m", "diameter", "diameter_crown")

for module in (gdal, ogr, osr):
    module.UseExceptions()


@dataclasses.dataclass
class Feature:
    """What a kind of the rules takes from an extract: tags and geometry (ogr, degrees, longitude first)."""

    kind: str
    tags: Dict[str, str]
    shape: Any = None
    count: int = 1  # of the file's features that it is made of
    reason: str = ""  # why it is not in the scene

    @property
    def id(self) -> str:
        """As the extract has it, or empty."""
        return next((self.tags[name] for name in ("osm_id", "osm_way_id", "id", "@id") if self.tags.get(name)), "")

    @property
    def name(self) -> str:
        return self.tags.get("name") or self.tags.get("ref") or ""

    def left(self, reason: str) -> Feature:
        """The feature as one that is not in the scene."""
        return dataclasses.replace(self, shape=None, reason=reason)


def rules() -> Dict[str, Any]:
    """What is made of which tags, with all numbers that are assumed (`airport.json`)."""
    return load_json(pathlib.Path(__file__).with_name("airport.json"))


@contextlib.contextmanager
def quiet(hear: Optional[Callable[[str], Any]] = None) -> Iterator[None]:
    """Without GDAL's warnings, as of rings that cross, which the scene reader repairs and counts. @param hear is called with them,
    and with what the OSM driver says of ways and relations"""
    before = gdal.GetConfigOption("CPL_DEBUG")
    gdal.PushErrorHandler("CPLQuietErrorHandler" if hear is None else lambda _, number, words: hear(words))
    gdal.SetConfigOption("CPL_DEBUG", before if hear is None else "OSM")
    try:
        yield
    finally:
        gdal.SetConfigOption("CPL_DEBUG", before)
        gdal.PopErrorHandler()


def degrees():
    system = osr.SpatialReference()
    system.ImportFromEPSG(4326)
    system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return system


def geometry(kind: str, coordinates: Any):
    """A geometry (ogr). @param kind as in GeoJSON, as are the coordinates"""
    return ogr.CreateGeometryFromJson(json.dumps({"type": kind, "coordinates": np.asarray(coordinates, dtype=float).tolist()}))


def moved(shape, to):
    """A copy in other coordinates. @param to a transformation (osr)"""
    shape = shape.Clone()
    shape.Transform(to)
    return shape


def valid(shape):
    return shape if shape.IsValid() else shape.MakeValid()


def expect_file(file: pathlib.Path) -> None:
    if not file.exists():
        raise FileNotFoundError(f"no such file: {file}")
    if not file.is_file():
        raise Error(f"{file}: it is not a regular file")


def open_file(file: pathlib.Path, what: str, drivers: List[str], kind: int, options: Tuple[str, ...] = ()):
    """A regular file with one of GDAL's drivers."""
    expect_file(file)
    try:
        return gdal.OpenEx(str(file.resolve()), kind | gdal.OF_READONLY, allowed_drivers=drivers, open_options=list(options))
    except RuntimeError as error:
        raise Error(f"{file}: GDAL cannot read it as {what} ({error})") from None


def fits(tags: Dict[str, str], wanted: Dict[str, Any]) -> bool:
    """Whether tags have all of these: a word, several, `*` for any, `-*` for any that begins so."""
    return all(name in tags and any(tags[name] == word or (word[-1] == "*" and tags[name].startswith(word[:-1]))
                                    for word in ([words] if isinstance(words, str) else words)) for name, words in wanted.items())


class Table:
    """Names by tags: the first row counts that fits."""

    def __init__(self, rows: Iterable[Tuple[str, Dict[str, Any]]]):
        self.rows: Dict[str, List[Tuple[int, str, Dict[str, Any]]]] = collections.defaultdict(list)
        for number, (name, wanted) in enumerate(rows):
            self.rows[next(iter(wanted))].append((number, name, wanted))

    def find(self, tags: Dict[str, str]) -> Optional[str]:
        found = [(number, name) for key in tags if key in self.rows for number, name, wanted in self.rows[key] if fits(tags, wanted)]
        return min(found, default=(0, None))[1]


def form_of(shape) -> str:
    """Which of point, line and area a geometry is; "" for others."""
    name = shape.GetGeometryName().replace("MULTI", "") if shape is not None else ""
    return {"POINT": "point", "LINESTRING": "line", "POLYGON": "area"}.get(name, "")


def parts_of(shape) -> List[Any]:
    """Points, lines and polygons of a geometry (ogr)."""
    if form_of(shape) and "MULTI" not in shape.GetGeometryName():
        return [shape]
    return [part for i in range(shape.GetGeometryCount()) for part in parts_of(shape.GetGeometryRef(i).Clone())]


def _outer(shape) -> np.ndarray:
    """The corners (n x 2) of points, lines and outer rings."""
    points = [point for part in parts_of(shape) for point in (part.GetGeometryRef(0) if part.GetGeometryCount() else part).GetPoints() or ()]
    return np.array(points, dtype=float).reshape(-1, 2)


def _has_extent(corners: np.ndarray, form: str) -> bool:
    """False of lines and areas of which nodes are missing, or the same."""
    if form == "point":
        return True
    away = corners - corners[0]
    far = away[np.argmax(np.hypot(*away.T))]
    least = 1e-9 * np.hypot(*far)  # of 0.1 mm
    return least > 0.0 and (form == "line" or bool(np.abs(away[:, 0] * far[1] - away[:, 1] * far[0]).max() > least))


def number_of(text: str, most: float = np.inf) -> float:
    """Of "1,200.5", "1 200", "12,5". @param most above which a comma is taken for that of decimals"""
    thousands = re.fullmatch(rf"\d{{1,3}}({THOUSANDS}\d{{3}})+(\.\d+)?", text)
    value = float(re.sub(THOUSANDS, "", text) if thousands else text.replace(",", "."))
    return value if value <= most or "," not in text or "." in text else float(text.replace(",", ".", 1).replace(",", ""))


def length_of(text: Any) -> Optional[float]:
    """Metres of "12", "12.5 m", "40 ft", "39'4\"", "1,200 ft", "approx 12", the greatest of "2;3" and "12-15"; None where it is no
    length."""
    return _greatest(text, _one_length)


def levels_of(text: Any) -> Optional[float]:
    """The number of "2", "2 floors", "3+1", the greatest of "2;3", "2,3" and "2-3"; None for other texts."""
    return _greatest(re.sub(r",(?!5\b)", ";", str(text)) if text else text, _one_number_of_levels)


def _greatest(text: Any, one: Callable[[str], Optional[float]]) -> Optional[float]:
    said = str(text if text is not None else "").strip().strip(";").strip()
    if not said or len(said) > LONGEST_LENGTH:  # expressions take the third power of a text's size
        return None
    values = [one(part.strip()) for part in re.split(r"[;/](?!-)|\.\.|(?<=[\w.])\s*[-–]\s*(?=\d)", said)]
    known = [value for value in values if value is not None]
    return max(known) if len(known) == len(values) and 0.0 < max(known) <= TALLEST else None


def _one_length(text: str) -> Optional[float]:
    found = LENGTH.fullmatch(text)
    unit = (found[2] or "m").lower() if found else ""
    parts = re.fullmatch(r"(\d+)\s*m\s*(\d{1,2})\s*cm", text, re.IGNORECASE)
    if parts:
        return int(parts[1]) + int(parts[2]) / 100.0
    if re.fullmatch(r"\d+(?:\.\d+)?e\d", text, re.IGNORECASE):
        return float(text)
    if not found or (found[3] and unit[0] not in "f'′"):
        return None
    if unit[0] in "sl" or unit.startswith("fl"):
        return number_of(found[1]) * rules()["level_height"]
    metres = next((value for word, value in UNITS.items() if unit.startswith(word)), 1.0)
    return (number_of(found[1], TALLEST / metres) + (number_of(found[3]) if found[3] else 0.0) / 12) * metres


def _one_number_of_levels(text: str) -> Optional[float]:
    found = re.fullmatch(r"(\d+(?:[.,]\d+)?)(?:\s*\+\s*(\d+(?:\.\d+)?))?\s*(?:[a-z]+\.?)?", text, re.IGNORECASE)
    return number_of(found[1]) + float(found[2] or 0.0) if found else None


def _tags(feature, names: List[str]) -> Dict[str, str]:
    tags: Dict[str, str] = {}
    for number, name in enumerate(names):
        if not feature.IsFieldSetAndNotNull(number):
            continue
        value = feature.GetFieldAsString(number)
        if name in ("other_tags", "all_tags", "tags"):
            if value.startswith("{"):
                tags.update((key, str(word)) for key, word in json.loads(value).items())
            else:
                found = TAG.findall(value)
                tags.update(found if "\\" not in value else [(re.sub(r"\\(.)", r"\1", key), re.sub(r"\\(.)", r"\1", word)) for key, word in found])
        elif name == "names" and value.startswith("{"):
            tags["name"] = str(json.loads(value).get("primary") or "")
        elif value:
            tags[name] = value
    return {name: value if value.isprintable() else CONTROLS.sub("", value) for name, value in tags.items()}


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

    def __init__(self, known: Dict[str, Any]):
        self.known = known
        self.kinds = {form: Table((kind, tags) for kind, rule in known["kinds"].items() if form in rule["from"] for tags in rule["tags"])
                      for form in ("point", "line", "area")}
        self.reasons = Table((reason, tags) for reason, rows in known["left_out"].items() for tags in rows)
        self.lines, self.model_tags = (Table(("", tags) for tags in known[name]) for name in ("lines", "models"))
        self.features: List[Feature] = []  # after `done`
        self.aerodromes: List[Feature] = []
        self.models: List[Feature] = []  # model airfields
        self.thresholds: List[Feature] = []  # of runways, points
        self.left: List[Feature] = []
        self.used: Counter[str] = collections.Counter()  # features that the scene follows but does not draw
        self.unknown: Counter[str] = collections.Counter()  # by tag
        self.seen: Dict[Any, List[Tuple[int, Feature]]] = collections.defaultdict(list)  # with ranks: of two alike the greater counts
        self.today = datetime.date.today().isoformat()
        self.cut: Set[str] = set()  # ways of which nodes are missing

    def leave(self, feature: Feature, reason: str) -> None:
        self.left.append(feature.left(reason))

    def hear(self, words: str) -> None:
        """What GDAL's OSM driver says: it leaves out relations that are not complete, and ways of fewer than two nodes."""
        part = re.search(r"For way (-?\d+), got only", words)
        gone = re.search(r"(Way|Relation) (-?\d+) (?:has missing ways|with \d+ nodes( that)?)", words)
        if part:
            self.cut.add(part[1])
        if gone:
            self.leave(Feature(gone[1].lower(), {"id": gone[2]}), CUT if gone[3] or "missing" in words else "no nodes")
        elif words.startswith("Non closed ring detected"):
            self.leave(Feature("relation", {}), "unclosed")

    def _kinds(self, tags: Dict[str, str], form: str, closed: bool) -> List[Tuple[str, str]]:
        """Kinds of a feature, each with the form that it takes: what is closed may be an area, a line, and both."""
        is_area, is_point = tags.get("area") == "yes", form == "point"
        # GDAL's own idea of polygons: closed ways of aeroway, and others with area=yes, which it drops.
        is_way = form == "line" or ("aeroway" in tags) == ("osm_way_id" in tags)
        solid = closed and (is_area or not is_way or self.lines.find(tags) is None)
        takes = {"point": is_point, "area": solid, "line": not is_point and (not (closed and is_area) or "barrier" in tags)}
        found = {one: self.kinds[one].find(tags) for one, fitting in takes.items() if fitting}
        known = [(kind, one) for one, kind in found.items() if kind is not None and (one, kind) != ("line", found.get("area"))]
        has_height = any(length_of(tags[name]) for name in HEIGHTS if name in tags)
        if not known and has_height and (is_point or (solid and not any(name in tags for name in self.known["low"]))):
            known = [("obstacle", "point" if is_point else "area")]
        return known

    def take(self, tags: Dict[str, str], shape) -> None:
        """A feature. @param shape ogr, degrees; may be None"""
        tags, form = _as_osm(tags, self.known), form_of(shape)
        if fits(tags, {"type": "building", "building": "*"}) and not form and shape is not None:  # a relation of outlines and parts
            shape, form = _union([_as_area(part) for part in parts_of(shape) if form_of(part) == "area" or _is_closed(part)]), "area"
        one, corners = Feature("", tags, shape), _outer(shape) if form else np.empty((0, 2))
        if not len(corners):
            if shape is None or shape.IsEmpty():
                self.leave(one, "without a geometry")
            elif tags.get("type") == "building":  # whose members are read by themselves
                self.used["relation"] += 1
            else:
                self._do_not_know(tags)
            return
        is_closed, use = form == "area" or _is_closed(shape), ""
        if self.model_tags.find(tags) is not None:
            self.models.append(one)
        if tags.get("aeroway") == "threshold" and form == "point":
            use = "threshold"
            self.thresholds.append(one)
        elif tags.get("aeroway") == "aerodrome" and "heliport" not in (tags.get("aerodrome:type"), tags.get("aerodrome")):
            use = "aerodrome"
            self.aerodromes.append(Feature("", tags, _as_area(shape) if form == "line" and is_closed else shape))
        if tags.get("natural") == COAST and form != "point":
            self._keep(Feature(COAST, tags, shape), form, corners)
            return
        kinds = self._kinds(tags, form, is_closed)
        if not kinds:
            self._leave_unknown(one, form, use)
        reason = self._reason(tags) if kinds else None
        for kind, taken in kinds:
            one = Feature(kind, tags, shape)
            if reason or not _has_extent(corners, taken):
                self.leave(one, reason or (CUT if tags.get("osm_way_id") in self.cut else "no nodes"))
                continue
            if form != taken:
                one.shape = _as_area(shape) if taken == "area" else ogr.ForceToMultiLineString(shape)
            self._keep(one, taken, corners)

    def _reason(self, tags: Dict[str, str]) -> Optional[str]:
        """Why a feature of a known kind stands nowhere, by its tags and dates."""
        for name, reason in (("start_date", "not built"), ("end_date", "ruins, or gone")):
            date = re.match(r"\d{4}(?:-\d\d){0,2}$", tags.get(name, ""))
            today = self.today[:len(date[0])] if date else ""
            if date and (date[0] > today if name == "start_date" else date[0] < today):
                return reason
        underground = tags.get("building:levels") == "0" and levels_of(tags.get("building:levels:underground"))
        return self.reasons.find(tags) or ("below ground" if underground and not any(name in tags for name in (*HEIGHTS, "roof:levels")) else None)

    def _leave_unknown(self, one: Feature, form: str, use: str) -> None:
        """What no rule takes: what is gone or is not there yet, what is not closed, points of what has an outline, all else.
        @param use what it is used for, or empty"""
        gone = {rest: (word, self.known["lifecycle"][state]) for name, word in one.tags.items() for state, _, rest in [name.partition(":")]
                if rest and state in self.known["lifecycle"]}
        was = self.kinds["area" if form == "line" else form].find({name: word for name, (word, _) in gone.items()})
        one.kind = was or (form != "area" and self.kinds["area"].find(one.tags)) or ""
        if was:
            self.leave(one, next(iter(gone.values()))[1])
        elif "height" in self.known["kinds"].get(one.kind, ()):
            reason = "a point without an outline" if form == "point" else CUT if one.tags.get("osm_way_id") in self.cut else "unclosed"
            self.leave(one, self._reason(one.tags) or reason)
        elif use:
            self.used[use] += 1
        else:
            self._do_not_know(one.tags)

    def _do_not_know(self, tags: Dict[str, str]) -> None:
        name = next((name for name in self.known["main"] if name in tags), None)
        self.unknown[f"{name}={tags[name]}" if name else "others"] += 1

    def _keep(self, one: Feature, form: str, corners: np.ndarray) -> None:
        """Once each: extracts repeat closed ways as lines and areas, and the outer way of a relation. What stands above or beyond
        another of the same corners is another."""
        alike = self.seen[one.kind, frozenset(map(tuple, np.round(corners, 9).tolist()))]
        rank = 99 if form == "line" else sum(max(part.GetGeometryCount(), 1) for part in parts_of(one.shape))
        for number, (other_rank, other) in enumerate(alike):
            greater = self._greater(one, other)
            if greater is not None:
                lesser = other if greater is one else one
                self.leave(lesser, TWICE)
                alike[number] = max(rank, other_rank), Feature(one.kind, {**lesser.tags, **greater.tags}, (one if rank > other_rank else other).shape)
                return
        alike.append((rank, one))

    def _greater(self, one: Feature, other: Feature) -> Optional[Feature]:
        """Which of two in one place counts: the one whose height is not assumed, else the one that reaches from below to above the
        other. None where neither does."""
        rule = self.known["kinds"].get(one.kind, {})
        if "height" not in rule:
            return other
        name, spans = height_name(rule), []
        for row in (properties_of(each, self.known) for each in (one, other)):
            spans.append((row[f"{name}_from"].startswith("assumed") and "min_height" not in row, row.get("min_height", 0.0), row[name]))
        (is_assumed, low, high), (is_other_assumed, other_low, other_high) = spans
        if is_assumed or (not is_other_assumed and other_low <= low and high <= other_high):
            return other
        return one if is_other_assumed or (low <= other_low and other_high <= high) else None

    def done(self) -> Extract:
        for _, one in (pair for alike in self.seen.values() for pair in alike):
            is_cut = one.tags.get("osm_way_id") in self.cut
            if is_cut and form_of(one.shape) == "area":
                self.leave(one, CUT)
            else:
                self.features.append(dataclasses.replace(one, tags={**one.tags, **({CUT: "yes"} if is_cut else {})}))
        return self


def _is_closed(shape) -> bool:
    return shape.GetGeometryName() == "LINESTRING" and shape.GetPointCount() > 3 and shape.GetPoint_2D(0) == shape.GetPoint_2D(shape.GetPointCount() - 1)


def _as_area(shape):
    """The polygon in a closed line; polygons are as they are."""
    return shape.Clone() if form_of(shape) == "area" else ogr.ForceToPolygon(shape.Clone())


def _union(areas: List[Any]):
    whole = ogr.Geometry(ogr.wkbMultiPolygon)
    for part in (part for area in areas for part in parts_of(valid(area)) if form_of(part) == "area"):
        whole.AddGeometry(part)
    return whole.UnionCascaded()


def _needs_order(file: pathlib.Path) -> bool:
    """Whether XML of OpenStreetMap has nodes after ways, things that an editor has deleted, or places in ways: GDAL reads none of
    these."""
    with open(file, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        way, relation = data.find(b"<way "), data.find(b"<relation ")
        return (0 <= way < data.rfind(b"<node ") or 0 <= relation < data.rfind(b"<way ") or 0 <= relation < data.rfind(b"<node ")
                or re.search(rb"""action=["']delete|visible=["']false|<nd [^>]*lat=""", data) is not None)


def _memberless(file: pathlib.Path) -> int:
    """How many areas of XML of OpenStreetMap have no way, of which GDAL says nothing."""
    with open(file, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        return sum(re.search(rb"""type=["']way""", one[1]) is None and re.search(rb"""v=["'](multipolygon|boundary)""", one[1]) is not None
                   for one in re.finditer(rb"<relation [^>]*[^/]>(.*?)</relation>", data, re.DOTALL))


def _in_order(file: pathlib.Path, out: pathlib.Path) -> pathlib.Path:
    """A copy of XML of OpenStreetMap with nodes, then ways, then relations, each once, by their ids."""
    found: Dict[str, Dict[int, Tuple[int, bytes]]] = {"node": {}, "way": {}, "relation": {}}
    places: Dict[Tuple[str, str], str] = {}

    def keep(tag: str, number: str, size: int, text: bytes) -> None:
        found[tag][int(number)] = max(found[tag].get(int(number), (-1, b"")), (size, text), key=lambda one: one[0])

    root = None
    for event, one in ElementTree.iterparse(file, ("start", "end")):
        root = one if root is None else root
        if event == "start" or one.tag not in found:
            continue
        for node in one.iter("nd"):  # of what Overpass writes by `out geom`: with places, without a number in members of relations
            where = node.get("lat"), node.get("lon")
            if where[0]:
                node.set("ref", node.get("ref") or places.setdefault(where, str(-(1 << 40) - len(places))))
                keep("node", node.get("ref"), 0, b'<node id="%s" lat="%s" lon="%s"/>' % tuple(word.encode() for word in (node.get("ref"), *where)))
        for member in one.iter("member"):
            nodes = [b'<nd ref="%s"/>' % node.get("ref").encode() for node in member.iter("nd") if node.get("ref")]
            if nodes and member.get("type") == "way":
                keep("way", member.get("ref"), 0, b'<way id="%s">%s</way>' % (member.get("ref").encode(), b"".join(nodes)))
        if one.get("action") != "delete" and one.get("visible") != "false" and (one.tag != "node" or one.get("lat")):
            keep(one.tag, one.get("id"), len(one) + 1, ElementTree.tostring(one))
        root.clear()
    with open(out, "wb") as stream:
        stream.write(b'<?xml version="1.0" encoding="UTF-8"?><osm version="0.6">\n')
        for things in found.values():
            stream.writelines(things[number][1] for number in sorted(things))
        stream.write(b"</osm>\n")
    return out


def _expect_map(file: pathlib.Path) -> None:
    """Say what a file is that tools leave where an extract was expected."""
    with open(file, "rb") as stream:
        head = stream.read(2000).lstrip(b"\xef\xbb\xbf \r\n\t").lower()
    what = ("is empty" if not head else "is in UTF-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "is a web page" if head.startswith((b"<!doctype html", b"<html"))
            else "is Overpass's own JSON" if head.startswith(b"{") and b'"elements"' in head else "")
    if what:
        raise Error(f"{file}: {what}, expected an extract of a map: export it again as .osm, .osm.pbf, .geojson or .gpkg")


def read_extract(file: pathlib.Path, known: Dict[str, Any]) -> Extract:
    """What the rules know, aerodromes, and what is left out."""
    driver = SUFFIXES.get(file.suffix.lower())
    if not driver:
        raise Error(f"{file}: is no extract by its name, expected .osm, .osm.pbf, .geojson or .gpkg")
    expect_file(file)
    if file.stat().st_size > LARGEST:
        raise Error(f"{file}: holds {file.stat().st_size >> 20} MiB, expected at most {LARGEST >> 20}: cut it to the airport and some "
                    "kilometres around it first, as `osmium extract --bbox W,S,E,N` does")
    _expect_map(file)
    options = (f"CONFIG_FILE={pathlib.Path(__file__).with_name('osmconf.ini')}", "USE_CUSTOM_INDEXING=NO") if driver == "OSM" else ()
    aliases = {name.replace(":", "_"): name for name in known["colons"]}
    found, source = Extract(known), file
    with contextlib.ExitStack() as stack:
        if file.suffix.lower() == ".osm":
            if _needs_order(file):
                folder = stack.enter_context(tempfile.TemporaryDirectory())
                try:
                    with naming("its nodes, ways and relations"):
                        source = _in_order(file, pathlib.Path(folder) / "in_order.osm")
                except ElementTree.ParseError as error:
                    raise Error(f"{file}: GDAL cannot read it as an extract ({error})") from None
            found.left += [Feature("relation", {}, reason="no ways")] * _memberless(source)
        data = open_file(source, "an extract", [driver], gdal.OF_VECTOR, options)
        stack.enter_context(naming(str(file)))
        stack.enter_context(quiet(found.hear if driver == "OSM" else None))
        layers: Dict[str, Tuple[List[str], Any]] = {}
        while True:
            try:
                feature, layer = data.GetNextFeature()
            except RuntimeError:
                raise Error("cannot be read to its end: it is damaged or not whole, expected a whole extract") from None
            if feature is None:
                break
            if layer.GetName() not in layers:
                own, frame = layer.GetSpatialRef(), layer.GetLayerDefn()
                if own is not None:
                    own.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
                names = [frame.GetFieldDefn(number).GetName() for number in range(frame.GetFieldCount())]
                layers[layer.GetName()] = ([aliases.get(name, name) for name in names],
                                           osr.CoordinateTransformation(own, degrees()) if own is not None and not own.IsSame(degrees()) else None)
            names, to_degrees = layers[layer.GetName()]
            tags = _tags(feature, names)
            if driver != "OSM":
                tags = tags or {"feature": str(feature.GetFID())}
            elif layer.GetName() == "lines":
                tags["osm_way_id"] = tags.get("osm_id", "")
            if tags:
                found.take(tags, plain(feature.GetGeometryRef(), to_degrees))
        del data
    return found.done()


def plain(shape, to_degrees):
    """A geometry of straight lines in degrees; what consists of one part is that part, and rings are closed."""
    if shape is None:
        return None
    shape = shape.GetLinearGeometry() if shape.HasCurveGeometry() else shape.Clone()
    if to_degrees is not None:
        shape.Transform(to_degrees)
    shape.FlattenTo2D()
    shape.CloseRings()
    return shape.GetGeometryRef(0).Clone() if shape.GetGeometryName().startswith("MULTI") and shape.GetGeometryCount() == 1 else shape


def height_name(rule: Dict[str, Any]) -> str:
    """The property with the height: `height` of buildings, which siting changes by some metres and keeps lidars away from, `top`
    of plants, fences and masts."""
    return "top" if rule["class"] in ("fence", "mast", "pole", "tree", "vegetation") else "height"


def _first(tags: Dict[str, str], names: Tuple[str, ...], read: Callable[[Any], Optional[float]]) -> Tuple[Optional[float], str]:
    """The first of some tags with a usable number, and its name."""
    return next(((value, name) for name in names for value in [read(tags.get(name))] if value is not None), (None, "assumed"))


def _not_understood(tags: Dict[str, str], names: Tuple[str, ...]) -> str:
    """Which of some tags holds something else than no height."""
    return next((f"assumed: {name} is {tags[name][:40]!r}" for name in names if name in tags and not NOTHING.fullmatch(tags[name])), "")


def _height(tags: Dict[str, str], rule: Dict[str, Any], floor: float) -> Tuple[float, str]:
    """m above the ground, and what it is from. @param floor height of one, m"""
    value, source = _first(tags, HEIGHTS, length_of)
    if value is not None:
        return value, f"{source}: {tags['height_source']}" if "height_source" in tags else source
    levels, source = _first(tags, LEVELS, levels_of)
    roof = levels_of(tags.get("roof:levels")) or 0.0
    if levels or roof:
        each, lowest = rule.get("level_height", floor), rule.get("lowest_level")
        levels, up = levels or 0.0, floor * roof or length_of(tags.get("roof:height")) or 0.0
        if lowest and levels:
            return lowest + floor * (levels - 1.0) + up, f"{source}, {lowest:g} m for the lowest and {floor:g} m for others assumed"
        return each * levels + up, f"{source if levels else 'roof:levels'}, {each:g} m each assumed"
    return rule["height"], _not_understood(tags, HEIGHTS) or "assumed"


def properties_of(feature: Feature, known: Dict[str, Any]) -> Dict[str, Any]:
    """What the scene file reads of a feature, and what each number is from."""
    rule, tags = known["kinds"][feature.kind], feature.tags
    properties: Dict[str, Any] = {"kind": feature.kind, "id": feature.id or None, "name": tags.get("name"), "ref": tags.get("ref")}
    if feature.kind == "obstacle":
        properties["kind_from"] = f"assumed: no rule knows {next((f'{name}={tags[name]}' for name in known['main'] if name in tags), 'it')}"
    if "height" in rule:
        name, floor = height_name(rule), known["level_height"]
        height, source = _height(tags, rule, floor)
        under, why = _first(tags, MIN_HEIGHTS, length_of)
        if under is None:
            each, (below, why) = rule.get("level_height", floor), _first(tags, MIN_LEVELS, levels_of)
            under, why = (each * below, f"{why}, {each:g} m each assumed") if below else (None, why)
        if under is not None and "assumed" in source and (source.startswith("assumed") or under >= height):
            height, source = under + rule.get("thickness", height), f"{source}, above {why}"
        strange = _not_understood(tags, MIN_HEIGHTS + MIN_LEVELS)
        if under is None and "thickness" in rule and not tags.get("min_height", "").startswith("0"):
            under, why = height - rule["thickness"], "assumed"
        elif strange and not (under and under < height):
            under, why = 0.0, strange
        properties.update({name: round(float(height), 3), f"{name}_from": source})
        if under is not None and 0.0 <= under < height:
            properties.update(min_height=round(float(under), 3) or None, min_height_from=why)
    if "width" in rule and form_of(feature.shape) != "area":
        value, source = _first(tags, WIDTHS, length_of)
        properties.update(width=round(float(rule["width"] if value is None else value), 3), width_from=source)
    if feature.kind in ("runway", "taxiway", "apron", "road", "parking"):
        said = tags.get("surface", "")
        surface = next((name for name, words in known["surfaces"].items() if said in words), None)
        properties.update(surface=surface or rule["material"], surface_from="surface" if surface else "assumed")
    properties.update((name, float(tags[name])) for name in ("displaced_start", "displaced_end") if feature.kind == "runway" and name in tags)
    return {name: value for name, value in properties.items() if value is not None}


def without_parts(features: List[Feature], known: Dict[str, Any]) -> Tuple[List[Feature], List[Feature]]:
    """Buildings of which parts are drawn lose the ground below these, so that parts may be lower than their outline. @return features,
    and the buildings that are nothing but their parts"""
    parts = [one for one in features if one.kind == "part" and "min_height" not in properties_of(one, known)]
    boxes = np.array([part.shape.GetEnvelope() for part in parts]).reshape(-1, 4)
    kept: List[Feature] = []
    drawn: List[Feature] = []
    for one in features:
        rule, rest = known["kinds"][one.kind], None
        if one.kind != "part" and form_of(one.shape) == "area" and ("level_height" in rule or rule["class"] in ("building", "house")):
            west, east, south, north = one.shape.GetEnvelope()
            near = (boxes[:, 0] <= east) & (boxes[:, 1] >= west) & (boxes[:, 2] <= north) & (boxes[:, 3] >= south)
            whole = valid(one.shape)
            rest = whole.Difference(_union([parts[i].shape for i in np.flatnonzero(near)])) if near.any() else None
        if rest is not None and rest.Area() < known["drawn_by_parts"] * whole.Area():
            drawn.append(one)
            continue
        if rest is not None and rest.Area() < whole.Area():
            one.shape = rest
        kept.append(one)
    return kept, drawn


def sea(features: List[Feature], box) -> List[Any]:
    """Areas of a box that lie to the right of its coastlines, as OpenStreetMap draws them. A polygon is an island. None where
    coastlines end within the box. @param box ogr, degrees, as the areas"""
    lines, right = box.Boundary(), []
    for part in (part for one in features for part in parts_of(one.shape)):
        points = _outer(part)
        if form_of(part) == "area" and np.sum(points[:-1, 0] * points[1:, 1] - points[1:, 0] * points[:-1, 1]) < 0.0:
            points = points[::-1]  # land is to the left
        coast = geometry("LineString", points).Intersection(box)
        lines = lines.Union(coast)
        for ends in map(_outer, parts_of(coast)):
            ways = np.diff(ends, axis=0)
            right += [geometry("Point", at) for at in (ends[:-1] + ends[1:]) / 2 + 1e-3 * np.column_stack([ways[:, 1], -ways[:, 0]])]
    found = [face for face in parts_of(lines.Polygonize()) if any(map(face.Contains, right))] if right else []
    return [] if sum(face.Area() for face in found) > 0.999 * box.Area() else found
