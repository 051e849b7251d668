# SPDX-License-Identifier: BSD-3-Clause
"""Features of extracts: their kinds by the rules (`airport.json`), and the properties that the scene file reads."""
from __future__ import annotations

import collections
import contextlib
import dataclasses
import datetime
import json
import re
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Tuple

import numpy as np

from ..inputs._json import packaged

TALLEST, HIGHEST = 1000.0, 200.0  # greatest plausible height, m, and number of storeys
LONGEST_LENGTH = 100  # characters
THOUSANDS = "[, \u00a0\u202f'\u2019]"  # separators between groups of three digits
NUMBER = rf"\d{{1,3}}(?:{THOUSANDS}\d{{3}})+(?:\.\d+)?|\d+(?:[.,]\d+)?"
DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")  # numbers that GDAL reads
UNIT = (r"mm|cm|km|millimet\w+|centimet\w+|kilomet\w+|met(?:er|re)s?|mtrs?|mts?|m|м|метр\w*|米|"
        r"ft|foot|feet|['′]|yd|yards?|stor[ei]\w*|floors?|levels?")
LENGTH = re.compile(rf"(?:~|<|>|≈|\+|c\.|ca\.?|circa|approx\.?|about|max\.?|up to)?\s*({NUMBER})\s*"
                    rf"(?:(?:±|\+/?-)\s*(?:{NUMBER})|\+)?\s*({UNIT})?\.?\s*-?\s*"
                    rf"(?:({NUMBER})\s*(?:\"|''|″|in|inch|inches)\.?)?\s*"
                    r"(?:\(.*\)|a\.?g\.?l\.?|above ground\w*(?: level)?|high|tall|hoch)?", re.IGNORECASE)
# m, by the unit's beginning
UNITS = {"mm": 1e-3, "mil": 1e-3, "c": 1e-2, "k": 1e3, "f": 0.3048, "'": 0.3048, "′": 0.3048, "y": 0.9144}
HEIGHTS = ("height", "building:height", "est_height", "height_m", "render_height", "measuredHeight", "height:hub")
LEVELS = ("building:levels", "num_floors", "levels", "floors")
MIN_HEIGHTS = ("min_height", "building:min_height", "render_min_height")
MIN_LEVELS = ("building:min_level", "min_level", "min_floor")
ON_ROOF = "on_roof"  # a tag of this program: height of the roof below, m
# texts that give no number: -1 in Microsoft's footprints, no storey above the ground, objects that begin at the ground
NO_HEIGHT, NO_LEVEL = re.compile(r"\s*(?:-1(?:\.0*)?)?\s*"), re.compile(r"\s*0*\s*")
NO_MIN_HEIGHT = re.compile(r"\s*(?:-\d+(?:\.\d+)?|0*\.?0*)\s*m?\s*")
BELOW = re.compile(r"-\d+(?:\.\d+)?(?:\s*[;,-]\s*-\d+(?:\.\d+)?)*")  # storeys (`level`) that are all below the ground
WIDTHS = ("width", "width_m", "diameter", "diameter_crown")
TAG = re.compile(r'"((?:[^"\\]|\\.)*)"=>"((?:[^"\\]|\\.)*)"')  # a tag in hstore
# Properties that hold several tags, as GDAL, QGIS, osmtogeojson (overpass turbo) and Overture write them
TAGS = ("other_tags", "all_tags", "tags", "source_tags")


def tags_of(properties: Mapping[str, Any]) -> Dict[str, str]:
    """Tags as texts, without empty ones. Tags that GDAL and other programs put together into one property are taken
    out."""
    tags: Dict[str, str] = {}
    for name, value in properties.items():
        inner = _tags_in(value) if name in (*TAGS, "names") else {name: value}
        inner = {"name": inner.get("primary")} if name == "names" else inner
        texts = ((key, _text_of(word)) for key, word in inner.items())
        tags.update((key, text) for key, text in texts if text)
    return tags


def _text_of(word: Any) -> str:
    """The text of a tag: the words of a list, also of a list in JSON, with semicolons; empty for objects and nulls."""
    if isinstance(word, str) and word.startswith("["):
        with contextlib.suppress(ValueError, RecursionError):
            word = json.loads(word)
    if isinstance(word, list):
        return "" if any(isinstance(one, (dict, list)) for one in word) else ";".join(map(_text_of, word))
    return "" if word is None or isinstance(word, dict) else str(word)


def _tags_in(value: Any) -> Dict[str, Any]:
    """The tags in an object, in the JSON of an object, or in hstore. Other values have none."""
    if isinstance(value, str) and value.startswith("{"):
        try:
            value = json.loads(value)
        except (ValueError, RecursionError):
            return {}
    elif isinstance(value, str):
        value = {re.sub(r"\\(.)", r"\1", key): re.sub(r"\\(.)", r"\1", word) for key, word in TAG.findall(value)}
    return value if isinstance(value, dict) else {}


def form_of(shape) -> str:
    """Which of point, line and area a geometry is; "" for others."""
    name = shape.GetGeometryName().replace("MULTI", "") if shape is not None else ""
    return {"POINT": "point", "LINESTRING": "line", "POLYGON": "area"}.get(name, "")


def number_of(text: str, most: float = np.inf) -> float:
    """The number in "1,200.5", "1 200" or "12,5". @param most value above which a comma is read as a decimal mark"""
    thousands = re.fullmatch(rf"\d{{1,3}}({THOUSANDS}\d{{3}})+(\.\d+)?", text)
    value = float(re.sub(THOUSANDS, "", text) if thousands else text.replace(",", "."))
    if value <= most or "," not in text or "." in text:
        return value
    return float(text.replace(",", ".", 1).replace(",", ""))


def length_of(text: Any, most: float = TALLEST) -> Optional[float]:
    """Metres in "12", "12.5 m", "40 ft", "39'4\"", "1,200 ft", "approx 12"; the greatest value in "2;3" and "12-15".
    None for a text without a length. @param most greatest plausible length, m"""
    return _greatest(text, _one_length, most)


def levels_of(text: Any) -> Optional[float]:
    """The number in "2", "2 floors", "3+1"; the greatest in "2;3", "2,3" and "2-3". None for other texts."""
    return _greatest(re.sub(r",(?!5\b)", ";", str(text)) if text else text, _one_number_of_levels, HIGHEST)


def _greatest(text: Any, one: Callable[[str], Optional[float]], most: float) -> Optional[float]:
    # The time of the expressions grows with a high power of the number of blanks in a row.
    said = re.sub(r"(\s)\s+", r"\1", str(text if text is not None else "")).strip().strip(";").strip()
    if not said or len(said) > LONGEST_LENGTH:
        return None
    values = [one(part.strip()) for part in re.split(r"[;/](?!-)|\.\.|(?<=[\w.])\s*[-–]\s*(?=\d)", said)]
    known = [value for value in values if value is not None]
    return max(known) if len(known) == len(values) and 0.0 < max(known) <= most else None


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
        return number_of(found[1]) * packaged("places/airport.json")["level_height"]
    metres = next((value for word, value in UNITS.items() if unit.startswith(word)), 1.0)
    return (number_of(found[1], TALLEST / metres) + (number_of(found[3]) if found[3] else 0.0) / 12) * metres


def _one_number_of_levels(text: str) -> Optional[float]:
    found = re.fullmatch(r"(\d+(?:[.,]\d+)?)(?:\s*\+\s*(\d+(?:\.\d+)?))?\s*(?:[a-z]+\.?)?", text, re.IGNORECASE)
    return number_of(found[1]) + float(found[2] or 0.0) if found else None


@dataclasses.dataclass
class Feature:
    """A feature of an extract with a kind of the rules: tags and geometry (ogr, degrees, longitude first)."""

    kind: str
    tags: Dict[str, str]
    shape: Any = None
    count: int = 1  # number of the file's features that form this feature
    reason: str = ""  # reason why the feature is not in the scene

    @property
    def id(self) -> str:
        """The identifier in the extract, or empty."""
        return next((self.tags[name] for name in ("osm_id", "osm_way_id", "id", "@id") if self.tags.get(name)), "")

    @property
    def name(self) -> str:
        return self.tags.get("name") or self.tags.get("ref") or ""

    def left(self, reason: str) -> Feature:
        """The feature, marked as left out of the scene."""
        return dataclasses.replace(self, shape=None, reason=reason)


def fits(tags: Dict[str, str], wanted: Dict[str, Any]) -> bool:
    """Whether tags have all wanted values: a word, one of several words, `*` for any word, a beginning before `*`."""
    return all(name in tags and any(tags[name] == word or (word[-1] == "*" and tags[name].startswith(word[:-1]))
                                    for word in ([words] if isinstance(words, str) else words))
               for name, words in wanted.items())


class Table:
    """Names by tags; the first row that fits counts."""

    def __init__(self, rows: Iterable[Tuple[str, Dict[str, Any]]]):
        self.rows: Dict[str, List[Tuple[int, str, Dict[str, Any]]]] = collections.defaultdict(list)
        for number, (name, wanted) in enumerate(rows):
            self.rows[next(iter(wanted))].append((number, name, wanted))

    def find(self, tags: Dict[str, str]) -> Optional[str]:
        rows = (row for key in tags if key in self.rows for row in self.rows[key])
        return min((row[:2] for row in rows if fits(tags, row[2])), default=(0, None))[1]


class Reasons:
    """Why features stand nowhere, or are not in use, by their tags and dates."""

    def __init__(self, known: Dict[str, Any]):
        self.table = Table((reason, tags) for reason, rows in known["left_out"].items() for tags in rows)
        self.lifecycle = known["lifecycle"]
        self.today = datetime.date.today().isoformat()

    def find(self, tags: Dict[str, str]) -> Optional[str]:
        """The reason, or None. A runway that is one no longer, or not yet, by a second tag is not in use."""
        for name, reason in (("start_date", "not built"), ("end_date", "ruins, or gone")):
            date = re.match(r"\d{4}(?:-\d\d){0,2}$", tags.get(name, ""))
            today = self.today[:len(date[0])] if date else ""
            if date and (date[0] > today if name == "start_date" else date[0] < today):
                return reason
        underground = tags.get("building:levels") == "0" and levels_of(tags.get("building:levels:underground"))
        below = underground and tags.keys().isdisjoint((*HEIGHTS, "roof:levels"))
        is_below = bool(below or BELOW.fullmatch(tags.get("level", "")))
        ends = [prefix for name, word in tags.items() for prefix, _, rest in [name.partition(":")]
                if rest == "aeroway" and word == "runway" and prefix in self.lifecycle]
        return self.table.find(tags) or ("below ground" if is_below else self.lifecycle[ends[0]] if ends else None)


def height_name(rule: Dict[str, Any]) -> str:
    """The property with the height: `height` for buildings, whose heights siting varies and near which no lidar stands;
    `top` for plants, fences and masts."""
    return "top" if rule["class"] in ("fence", "mast", "pole", "tree", "vegetation") else "height"


def _first(tags: Dict[str, str], names: Tuple[str, ...],
           read: Callable[[Any], Optional[float]]) -> Tuple[Optional[float], str]:
    """The first usable number in some tags, and the name of the tag."""
    values = ((read(tags.get(name)), name) for name in names)
    return next(((value, name) for value, name in values if value is not None), (None, "assumed"))


def _not_understood(tags: Dict[str, str], names: Tuple[str, ...], nothing: re.Pattern[str]) -> str:
    """The first of some tags whose text is neither a number nor one of the texts that give no number."""
    strange = (name for name in names if name in tags and not nothing.fullmatch(tags[name]))
    return next((f"assumed: {name} is {tags[name][:40]!r}" for name in strange), "")


def _height(tags: Dict[str, str], rule: Dict[str, Any], floor: float) -> Tuple[float, str]:
    """Height above the ground, m, and the source of the number. @param floor height of a floor, m"""
    value, source = _first(tags, HEIGHTS, length_of)
    if value is not None:
        return value, f"{source}: {tags['height_source']}" if "height_source" in tags else source
    levels, source = _first(tags, LEVELS, levels_of)
    roof = levels_of(tags.get("roof:levels")) or 0.0
    if levels or roof:
        each, lowest = rule.get("level_height", floor), rule.get("lowest_level")
        levels, up = levels or 0.0, floor * roof or length_of(tags.get("roof:height")) or 0.0
        if lowest and levels:
            return (lowest + floor * (levels - 1.0) + up,
                    f"{source}, {lowest:g} m for the lowest and {floor:g} m for others assumed")
        return each * levels + up, f"{source if levels else 'roof:levels'}, {each:g} m each assumed"
    strange = _not_understood(tags, HEIGHTS, NO_HEIGHT) or _not_understood(tags, LEVELS, NO_LEVEL)
    return rule["height"], strange or "assumed"


def width_of(tags: Dict[str, str], kind: str, known: Dict[str, Any]) -> Tuple[float, str]:
    """Width of a line or point, m, and the source of the number."""
    value, source = _first(tags, WIDTHS, lambda text: length_of(text, known["widest"]))
    if value is not None:
        return value, source
    return known["kinds"][kind]["width"], _not_understood(tags, WIDTHS, NO_HEIGHT) or source


def properties_of(feature: Feature, known: Dict[str, Any]) -> Dict[str, Any]:
    """The properties that the scene file reads for a feature, and the source of each number."""
    rule, tags = known["kinds"][feature.kind], feature.tags
    properties: Dict[str, Any] = {"kind": feature.kind, "id": feature.id or None, "name": tags.get("name"),
                                  "ref": tags.get("ref")}
    if feature.kind == "obstacle":
        tag = next((f"{name}={tags[name]}" for name in known["main"] if name in tags), "it")
        properties["kind_from"] = f"assumed: no rule knows {tag}"
    if "height" in rule:
        name, floor = height_name(rule), known["level_height"]
        height, source = _height(tags, rule, floor)
        under, why = _first(tags, MIN_HEIGHTS, length_of)
        if under is None:
            each = rule.get("level_height", floor)
            below, why = _first(tags, MIN_LEVELS, levels_of)
            if below:
                under, why = each * below, f"{why}, {each:g} m each assumed"
        if under is not None and "assumed" in source and (source.startswith("assumed") or under >= height):
            height, source = under + rule.get("thickness", height), f"{source}, above {why}"
        strange = _not_understood(tags, MIN_HEIGHTS + MIN_LEVELS, NO_MIN_HEIGHT)
        if ON_ROOF in tags and under is None:
            under, why = float(tags[ON_ROOF]), tags.get(f"{ON_ROOF}_from", "")
            height, source = under + height, f"{source}, above the roof"
        if under is None and "thickness" in rule and not tags.get("min_height", "").startswith("0"):
            under, why = height - rule["thickness"], "assumed"
        elif strange and not (under and under < height):
            under, why = 0.0, strange
        if under is not None and under >= height:
            tag = why.partition(",")[0]
            under, why = 0.0, f"assumed: {tag} is {tags.get(tag, '')[:40]!r}, above the height"
        properties.update({name: round(float(height), 3), f"{name}_from": source})
        if under is not None and 0.0 <= under < height:
            properties.update(min_height=round(float(under), 3) or None, min_height_from=why)
    if "width" in rule and form_of(feature.shape) != "area":
        value, source = width_of(tags, feature.kind, known)
        properties.update(width=round(float(value), 3), width_from=source)
    if feature.kind in ("runway", "taxiway", "apron", "road", "parking"):
        said = tags.get("surface", "")
        surface = next((name for name, words in known["surfaces"].items() if said in words), None)
        properties.update(surface=surface or rule["material"], surface_from="surface" if surface else "assumed")
    if feature.kind == "runway":
        properties.update((name, float(tags[name])) for name in ("displaced_start", "displaced_end") if name in tags)
    return {name: value for name, value in properties.items() if value is not None}
