# SPDX-License-Identifier: BSD-3-Clause
"""Surveyed obstacles in the formats of State publications: AIXM 5.1, and CSV with named columns."""
from __future__ import annotations

import math
import pathlib
import re
from typing import Any, Dict, Iterator, List, Optional, Tuple
from xml.etree import ElementTree

from osgeo import ogr, osr

from .._files import read_regular
from .._pipeline import Error
from ._features import NUMBER, TALLEST, Feature, form_of, number_of
from ._gdal import degrees, geometry, plain
from ._osm import CONTROLS
from ._tables import csv_rows

METRES = {**dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0),
          **dict.fromkeys(("ft", "foot", "feet", "'", "′"), 0.3048)}
COLUMNS = {"longitude": ("longitude", "lon", "long", "lng", "londec", "x"),
           "latitude": ("latitude", "lat", "latdec", "y"), "height": ("height", "agl", "hgt"),
           "elevation": ("elevation", "amsl", "elev"), "unit": ("unit", "units", "uom"),
           "kind": ("kind", "type", "obstacle_type"),
           "name": ("name", "id", "identifier", "designator", "oas"), "action": ("action",)}
UNIT = re.compile(r"[ _]*[\[(](\w+)[\])]$|_(m|ft|feet)$")  # unit of a column, as in "height_ft" and "Height (m)"
CELL = re.compile(rf"\+?({NUMBER})\s*(m|met(?:re|er)s?|ft|foot|feet|['′])?\.?\s*(?:agl|amsl)?", re.IGNORECASE)
ANGLE = re.compile(r"([NSEW]?)\s*(\d{1,3})[°:\s-]*(\d{2})[′':\s-]*(\d{2}(?:[.,]\d+)?)[″\"\s]*([NSEW]?)", re.IGNORECASE)
MOST = {"height": TALLEST, "elevation": 9000.0}  # greatest plausible values, m
NO_PLACE = "without a place or a height"


def read_obstacles(file: pathlib.Path, known: Dict[str, Any]) -> Tuple[List[Feature], List[Feature]]:
    """Obstacles as features of the rules, and obstacles that are left out. The tag `height` is in metres above the
    ground. If a file gives only the elevation of the top, the tag `elevation` has the elevation, m."""
    suffix = file.suffix.lower()
    if suffix not in (".xml", ".csv"):
        raise Error(f"{file}: is not a file of obstacles by its name, expected .xml (AIXM 5.1) or .csv")
    found: List[Feature] = []
    left: List[Feature] = []
    for tags, shape in (_aixm if suffix == ".xml" else _csv)(file, read_regular(file)):
        kind = _kind_of(tags.pop("word"), form_of(shape) if shape is not None else "", known)
        tags = {name: CONTROLS.sub("", value) for name, value in tags.items()}
        one = Feature(kind, {**tags, "height_source": f"surveyed, {file.name}{tags.get('note', '')}"}, shape)
        if shape is None or not {"height", "elevation"} & tags.keys():
            left.append(one.left(NO_PLACE))
        elif kind == "wire" or tags.get("gone"):
            left.append(one.left("a wire" if kind == "wire" else "ruins, or gone"))
        else:
            found.append(one)
    for one in left:
        one.kind = one.kind.replace("wire", "obstacle")
    return found, left


def _kind_of(word: str, form: str, known: Dict[str, Any]) -> str:
    """The kind of the rules for the words of a file. The last known word counts, as in "cable car pylon". A building
    without an outline becomes a tower, which has a width."""
    said = re.sub(r"[\W_]+", " ", word.lower())
    ends = [(found.end(), len(one), kind) for kind, words in known["obstacles"].items() for one in words
            for found in re.finditer(rf"\b{one}s?\b", said)]
    kind = max(ends, default=(0, 0, "obstacle"))[2]
    if kind != "wire" and form and form not in known["kinds"][kind]["from"]:
        kind = {"point": "tower" if kind == "building" else "obstacle", "line": "wall"}.get(form, "obstacle")
    return kind


def _metres(value: str, unit: str, what: str, most: float) -> Optional[float]:
    """Metres above 0, or None for other texts. @param unit for values without a unit @param most greatest value, m"""
    found = CELL.fullmatch(value)
    if not found:
        return None
    unit = (found[2] or unit).lower()
    if unit not in METRES:
        raise Error(f"{what}: the unit is {unit!r}, expected m or ft")
    return number_of(found[1], most / METRES[unit]) * METRES[unit] or None


def _csv(file: pathlib.Path, content: bytes) -> Iterator[Tuple[Dict[str, str], Any]]:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    head = text.split("\n", 1)[0]
    rows = csv_rows(file, text, max(",;\t", key=head.count))
    names = [name.strip().lower() for name in next(rows, [])]
    plain_names = [UNIT.sub("", name) for name in names]
    at: Dict[str, int] = {}
    for column, words in COLUMNS.items():
        there = [word for word in words if word in plain_names]
        if there:
            at[column] = plain_names.index(there[0])
    if not {"longitude", "latitude"} <= at.keys() or not MOST.keys() & at.keys():
        raise Error(f"{file}: expected the columns longitude, latitude, and height or elevation "
                    f"(and unit, kind, name), found {', '.join(names)[:200]}")
    is_faa = {"latdec", "londec", "agl"} <= set(names)  # the Digital Obstacle File of the FAA, in feet
    units = {column: own[1] or own[2] for column, place in at.items() for own in UNIT.finditer(names[place])}
    for number, row in enumerate(rows, 2):
        if not any(cell.strip() for cell in row):
            continue
        cells = dict.fromkeys(COLUMNS, "")
        cells.update({column: row[place].strip() for column, place in at.items() if place < len(row)})
        tags = {"id": cells["name"] or str(number), "name": cells["name"], "word": cells["kind"],
                "gone": "yes" if cells["action"].upper() == "D" else ""}
        for column, most in MOST.items():
            unit = cells["unit"] or units.get(column) or ("ft" if is_faa else "")
            value = _metres(cells[column], unit or "m", f"{file}: row {number}", most)
            if value is not None:
                tags.update({column: f"{value:.3f}",
                             "note": "" if unit or not cells[column][-1].isdigit() else ", m assumed"})
        longitude, latitude = _angle(cells["longitude"]), _angle(cells["latitude"])
        is_place = abs(longitude) <= 180.0 and abs(latitude) <= 90.0
        yield tags, geometry("Point", [longitude, latitude]) if is_place else None


def _angle(text: str) -> float:
    """Degrees in "13.302", "13,302", "0131807.2E", "53°36'10\"N"; NaN for any other text."""
    found = ANGLE.fullmatch(text)
    if found and (found[1] or found[5]):
        value = int(found[2]) + int(found[3]) / 60.0 + float(found[4].replace(",", ".")) / 3600.0
        return -value if (found[1] or found[5]).upper() in "SW" else value
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return math.nan


def _all(element, name: str) -> List[Any]:
    return element.findall(f".//{{*}}{name}")


def _text(element, name: str) -> str:
    return next(filter(None, ((one.text or "").strip() for one in _all(element, name))), "")


def _aixm(file: pathlib.Path, content: bytes) -> Iterator[Tuple[Dict[str, str], Any]]:
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise Error(f"{file}: cannot be read as AIXM 5.1 ({error})") from None
    structures = _all(root, "VerticalStructure")
    if not structures:
        raise Error(f"{file}: holds no VerticalStructure, expected AIXM 5.1")
    for structure in structures:
        slices = [one for one in _all(structure, "VerticalStructureTimeSlice")
                  if not _text(one, "interpretation").endswith("DELTA")]
        last = max(slices, key=lambda one: int(_text(one, "sequenceNumber") or 0), default=None)
        parts = _all(last, "VerticalStructurePart") if last is not None else []
        for part in parts:
            name = _text(last, "name")
            what = f"{file}: {name}"
            tags = {"id": next((value for key, value in structure.attrib.items() if key.endswith("}id")), name),
                    "name": name, "word": _text(part, "type") or _text(last, "type") or name}
            for column, element in (("height", "verticalExtent"), ("elevation", "elevation")):
                for one in _all(part, element)[:1]:
                    value = _metres((one.text or "").strip(), one.get("uom", "M"), what, MOST[column])
                    if value is not None:
                        tags[column] = f"{value:.3f}"
            yield tags, _shape(part, what)


def _shape(part, what: str):
    """The place of a part (ogr, degrees), or None."""
    for place in part.iter():
        if place.tag.rpartition("}")[2].removeprefix("Elevated") not in ("Point", "Curve", "Surface"):
            continue
        srs = next((one.get("srsName") for one in place.iter() if one.get("srsName")), "urn:ogc:def:crs:EPSG::4326")
        words = " ".join(one.text or "" for one in place.iter() if one.tag.rpartition("}")[2] in ("pos", "posList"))
        if words.strip():
            try:
                for word in words.replace(",", " ").split():
                    float(word)  # raises ValueError for words that GDAL would read as 0
                shape = ogr.CreateGeometryFromGML(ElementTree.tostring(place, "unicode").replace("Elevated", ""))
            except (RuntimeError, ValueError) as error:
                raise Error(f"{what}: {words[:60]!r}: cannot be read as coordinates of GML ({error})") from None
            return plain(shape, _to_degrees(srs, what))
    return None


def _to_degrees(srs: str, what: str):
    """Transformation from a named system, with its own order of axes, to longitude and latitude."""
    code = re.search(r"EPSG[:/]+(?:[\d.]*[:/])?(\d+)$", srs)
    if srs.endswith("CRS84"):
        return osr.CoordinateTransformation(degrees(), degrees())
    system = osr.SpatialReference()
    try:
        system.ImportFromEPSG(int(code[1]) if code else 0)
    except RuntimeError:
        raise Error(f"{what}: the coordinate system is {srs!r}, expected a system of EPSG") from None
    system.SetAxisMappingStrategy(osr.OAMS_AUTHORITY_COMPLIANT)
    return osr.CoordinateTransformation(system, degrees())
