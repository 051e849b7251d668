# SPDX-License-Identifier: BSD-3-Clause
"""Surveyed obstacles in the formats of State publications: AIXM 5.1, and CSV with named columns."""
from __future__ import annotations

import collections
import math
import pathlib
import re
import warnings
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np
from osgeo import osr

from ..._files import read_regular
from ..._pipeline import Error
from ..inputs._tables import csv_rows
from ..places._features import NUMBER, TALLEST, Feature, form_of, number_of
from ..places._gdal import coordinate_system, corners_of, degrees, geometry, moved
from ._aixm import TWICE, Row, Structures
from ._osm import CONTROLS

METRES = {**dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0),
          **dict.fromkeys(("ft", "foot", "feet", "'", "′"), 0.3048),
          "cm": 0.01, "km": 1000.0, "nm": 1852.0, "mi": 1609.344}
COLUMNS = {"longitude": ("longitude", "lon", "long", "lng", "londec", "x"),
           "latitude": ("latitude", "lat", "latdec", "y"), "height": ("height", "agl", "hgt"),
           "elevation": ("elevation", "amsl", "elev"), "unit": ("unit", "units", "uom"),
           "kind": ("kind", "type", "obstacle_type"),
           "name": ("name", "id", "identifier", "designator", "oas"), "action": ("action",)}
UNIT = re.compile(r"[ _]*[\[(](\w+)[\])]$|_(m|ft|feet)$")  # unit of a column, as in "height_ft" and "Height (m)"
CELL = re.compile(rf"\+?({NUMBER})\s*(m|met(?:re|er)s?|ft|foot|feet|['′])?\.?\s*(?:agl|amsl)?", re.IGNORECASE)
ANGLE = re.compile(r"([NSEW]?)\s*(\d{1,3})[°:\s-]*(\d{2})[′':\s-]*(\d{2}(?:[.,]\d+)?)[″\"\s]*([NSEW]?)", re.IGNORECASE)
MOST = {"height": TALLEST, "elevation": 9000.0, **dict.fromkeys(("radius", "length", "width"), 1e5)}  # greatest, m
NO_PLACE = "without a place or a height"
GROUP, NO_WALL = "a group of obstacles without places", "a line that is not a wall"
FARM = re.compile(r"farms?$", re.IGNORECASE)
PLANTS = ("tree", "wood")
WIDE = ("building", "tank", "tree")  # kinds whose radius is always their own
PYLON = re.compile(r"(?i)(?:transmission|power)[-_ ]lines?|\bt-l\b")  # such a point is a pylon of the line
GUYED = ("mast", "pole", "crane", "turbine")  # kinds whose radius is that of wires, of a jib or of a rotor
SLENDER = 15.0  # greatest radius that a tower, a chimney or a tree has, m; a larger one is that of wires, or of a wood
LONGEST = 400  # characters of a text in which words are looked for


def read_obstacles(files: Sequence[pathlib.Path], known: Dict[str, Any]) -> Tuple[List[Feature], List[Feature]]:
    """Obstacles as features of the rules, and obstacles that are left out. The tag `height` is in metres above the
    ground. If a file gives only the elevation of the top, the tag `elevation` has the elevation, m."""
    structures, rows = Structures(), []
    for file in files:
        suffix = file.suffix.lower()
        if suffix == ".csv":
            rows += [(file, row) for row in _csv(file, read_regular(file))]
        elif suffix == ".xml":
            structures.add(file, read_regular(file))
        else:
            raise Error(f"{file}: is not a file of obstacles by its name, expected .xml (AIXM 5.1) or .csv")
    found: Dict[Any, Feature] = {}
    left: List[Feature] = []
    for file, row in [*structures.rows(_metres), *rows]:
        one = _feature(file, row, known)
        same = (one.kind, *(one.tags.get(name) for name in ("height", "elevation", "min_height")),
                *(map(tuple, np.round(corners_of(one.shape), 7)) if one.shape is not None else ()))
        if one.reason or same in found:
            left.append(one if one.reason else one.left(TWICE))
        else:
            found[same] = one
    for file in files:
        if not any(one.tags["file"] == str(file) for one in found.values()):
            reasons = collections.Counter(one.reason for one in left if one.tags["file"] == str(file))
            words = ", ".join(f"{count:,} {reason}" for reason, count in reasons.most_common(3))
            warnings.warn(f"{file}: none of its obstacles can stand in the scene: {words or 'it holds none'}",
                          RuntimeWarning, stacklevel=2)
    return list(found.values()), left


def _feature(file: pathlib.Path, row: Row, known: Dict[str, Any]) -> Feature:
    """A feature of the rules for a row of a file; with a reason if the feature is left out."""
    tags, shape, reason = row
    tags = {name: CONTROLS.sub("", value) for name, value in tags.items()}
    form = form_of(shape)
    word, kind = next(((word, kind) for word, kind in ((tags.get(name, ""), _kind_of(tags.get(name, ""), known))
                                                       for name in ("part", "type")) if kind), ("", ""))
    if not kind:
        kind = _kind_of(tags.get("name", ""), known)
        kind = "" if kind in ("ground", "balloon", "town") else kind  # a mast on a hill may have the hill's name
    if kind == "wire" and form == "point" and PYLON.search(word):
        kind = "mast"
    said = known["not_modelled"].get(kind) or ""
    if not said and form != "point" and kind not in PLANTS and (tags.get("group") or FARM.search(word)):
        said = GROUP
    radius = _radius_of(tags)
    if shape is not None and not reason and not said and form == "point" and radius > 0.0:
        if tags.get("group") and kind not in PLANTS:
            said = GROUP
        elif kind in WIDE or (radius <= SLENDER and kind not in GUYED):
            if kind == "tree" and radius <= SLENDER:
                tags["width"] = f"{2.0 * radius:.3f}"
            else:
                shape, form = _disc(shape, radius), "area"
                tags["note"] = tags.get("note", "") + ", a disc of its extent"
    if form == "line" and "width" in tags and kind not in ("fence", "wall", "tree"):
        tags.pop("width")
    kind, fits = _fitting(kind or "obstacle", form, known)
    reason = reason or ("ruins, or gone" if tags.get("gone") else said or ("" if fits else NO_WALL))
    if not reason and (shape is None or not {"height", "elevation"} & tags.keys()):
        reason = NO_PLACE
    if tags.get("group") and form == "point":
        tags["note"] = tags.get("note", "") + ", one of a group"
    tags = {name: value for name, value in tags.items() if name not in ("length", "radius", "part", "group")}
    if not ("width" in tags and form != "area"):
        tags.pop("width", None)
    source = f"surveyed, {file.name}{tags.pop('note', '')}"
    one = Feature(kind, {**tags, "file": str(file), "height_source": source}, shape)
    return one.left(reason) if reason else one


def _radius_of(tags: Dict[str, str]) -> float:
    """The radius of a point's extent, m, or that of a disc as large as its length times its width; 0 if not given."""
    length, width = (float(tags.get(name, "0")) for name in ("length", "width"))
    return float(tags.get("radius", "0")) or math.sqrt(length * width / math.pi)


def _disc(point, radius: float):
    """A disc (ogr, degrees) about a point."""
    local = coordinate_system((point.GetY(), point.GetX(), 0.0))
    middle = moved(point, osr.CoordinateTransformation(degrees(), local))
    return moved(middle.Buffer(radius), osr.CoordinateTransformation(local, degrees()))


def _kind_of(words: str, known: Dict[str, Any]) -> str:
    """The kind of the rules, or of what is not modelled, for the words of a file; empty for others. The last known word
    counts, as in "cable car pylon"."""
    said = re.sub(r"[\W_]+", " ", words[:LONGEST].lower())
    ends = [(found.end(), len(one), kind) for kind, words in known["obstacles"].items() for one in words
            for found in re.finditer(rf"\b{one}s?\b", said)]
    return max(ends, default=(0, 0, ""))[2]


def _fitting(kind: str, form: str, known: Dict[str, Any]) -> Tuple[str, bool]:
    """The kind for an obstacle of a form, and whether one fits. A building without an outline becomes a tower, which
    has a width; an area of trees is a wood."""
    rule = known["kinds"].get(kind)
    if rule is None:
        return "obstacle", True
    if not form or form in rule["from"]:
        return kind, True
    if form == "area":
        return ("wood" if kind in PLANTS else "obstacle"), True
    if form == "point":
        return ("tower" if kind in ("building", "wall") else "obstacle"), True
    return "wall", kind in ("building", "obstacle", "tower")


def _metres(value: str, unit: str, column: str) -> Optional[float]:
    """Metres, or None for texts without a length above 0; elevations may be negative. `ValueError` has the reason why
    an obstacle is left out. @param unit of values without a unit @param column name of the length"""
    sign = -1.0 if column == "elevation" and value[:1] in "-\u2212" and value else 1.0
    found = CELL.fullmatch(value[1:] if sign < 0.0 else value)
    if not found:
        return None
    unit, most = (found[2] or unit).lower(), MOST[column]
    if unit not in METRES:
        raise ValueError(f"{column} in {unit[:20]!r}, expected m or ft")
    metres = number_of(found[1], most / METRES[unit]) * METRES[unit]
    if metres > most:
        raise ValueError(f"{column} above {most:,.0f} m")
    return sign * metres or (0.0 if column == "elevation" else None)


def _csv(file: pathlib.Path, content: bytes) -> Iterator[Row]:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    text = re.sub(r"(?m)\A(?:[ \t]*#.*\n)+", lambda comments: "\n" * comments[0].count("\n"), text)
    head = text.lstrip("\n").split("\n", 1)[0]
    rows = csv_rows(file, text, max(",;\t", key=head.count))
    names = [name.strip().lower() for name in next(filter(any, rows), [])]
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
        tags = {"id": cells["name"] or str(number), "name": cells["name"], "type": cells["kind"],
                "gone": "yes" if cells["action"].upper() == "D" else ""}
        reason = ""
        for column in ("elevation", "height"):
            unit = cells["unit"] or units.get(column) or ("ft" if is_faa else "")
            try:
                value = _metres(cells[column], unit or "m", column)
            except ValueError as error:
                value, reason = None, f"{error}"
            if value is not None:
                tags.update({column: f"{value:.3f}",
                             "note": "" if unit or not cells[column][-1].isdigit() else ", m assumed"})
                reason = ""
        longitude, latitude = _angle(cells["longitude"]), _angle(cells["latitude"])
        is_place = abs(longitude) <= 180.0 and abs(latitude) <= 90.0
        yield tags, geometry("Point", [longitude, latitude]) if is_place else None, reason


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
