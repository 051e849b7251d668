# SPDX-License-Identifier: BSD-3-Clause
"""Extracts of maps as files, read by GDAL: OpenStreetMap's formats, GeoJSON and GeoPackage, also of Overture's maps."""
from __future__ import annotations

import contextlib
import itertools
import json
import mmap
import pathlib
import re
import tempfile
import xml.parsers.expat
from typing import Any, Callable, Collection, Dict, Iterator, List, Optional, Sequence, Set, Tuple
from xml.etree import ElementTree

import numpy as np
from osgeo import gdal, ogr, osr

from ..._pipeline import Error
from ..inputs._json import naming
from ..places._features import DECIMAL, Feature, tags_of
from ..places._gdal import accuracy_words, degrees, expect_file, features_of_json, moved, open_file, plain, quiet
from ._extract import NO_DEGREES, Extract

SUFFIXES = {".osm": "OSM", ".pbf": "OSM", ".geojson": "GeoJSON", ".gpkg": "GPKG"}  # suffixes with GDAL's drivers
ID, NO_ID = re.compile(r"-?\d{1,18}"), "without a whole number as id"
LARGEST = 256 << 20  # greatest size of an extract, bytes
# control characters, and marks of text direction, which would disorder a line
CONTROLS = re.compile("[\x00-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
# Nodes, ways and relations as most programs write them, with coordinates that are degrees
NODE = re.compile(rb"""<node id=["'](\d{1,18})["'](?: [\w:]+=(?:"[^"<>]*"|'[^'<>]*'))*? """
                  rb"""lat=["']-?[0-8]?\d(?:\.\d*)?["'] lon=["']-?(?:1[0-7]\d|\d{1,2})(?:\.\d*)?["']""")
OBJECTS = (b"<node", NODE), *((b"<" + name, re.compile(b"<" + name + rb""" id=["'](\d{1,18})["']"""))
                              for name in (b"way", b"relation"))
# What decides where the scene lies, or reaches the scene from afar
FIRST = ("aeroway", "aerodrome", "airport", "coastline", "runway")
CRS = re.compile(rb'"crs"\s*:\s*(\{[^{}]*(?:\{[^{}]*\}[^{}]*)?\})')


def _needs_order(file: pathlib.Path) -> bool:
    """Whether XML of OpenStreetMap has nodes after ways, objects that an editor has deleted, or coordinates in ways.
    GDAL reads none of the three."""
    with open(file, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        return (any(0 <= data.find(after) < data.rfind(before)
                    for before, after in itertools.combinations((b"<node ", b"<way ", b"<relation "), 2))
                or re.search(rb"""action\s*=\s*["']delete|visible\s*=\s*["']false|<nd\s[^>]*lat\s*=""", data) is not None)


def _memberless(file: pathlib.Path) -> int:
    """The number of areas without a way in XML of OpenStreetMap. GDAL does not report such areas."""
    with open(file, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        return sum(re.search(rb"""v=["'](multipolygon|boundary)""", one[1]) is not None
                   and re.search(rb"""type=["']way""", one[1]) is None
                   for one in re.finditer(rb"<relation [^>]*[^/]>(.*?)</relation>", data, re.DOTALL))


def _each(source: pathlib.Path, hear: Callable[[str, Dict[str, str]], Any]) -> None:
    """Calls a function with each element of OpenStreetMap's XML: its name, and its attributes."""
    parser = xml.parsers.expat.ParserCreate()
    parser.StartElementHandler = hear
    with open(source, "rb") as stream, contextlib.suppress(xml.parsers.expat.ExpatError):  # GDAL names the latter
        parser.ParseFile(stream)


def _is_usual(source: pathlib.Path) -> bool:
    """Whether no object of OpenStreetMap's XML is repeated, and all nodes have coordinates in degrees. False means that
    an XML parser has to look."""
    with open(source, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        for name, usual in OBJECTS:
            found = usual.findall(data)
            rising = np.diff(np.array(found, "S18").astype(np.int64)) > 0
            if len(found) != len(re.findall(name, data)) or not rising.all():
                return False
    return True


def _nodes_nowhere(source: pathlib.Path) -> Tuple[Dict[str, str], bool]:
    """Nodes of OpenStreetMap's XML whose coordinates are not degrees, and which GDAL would read as others, such as 0:
    by their ids, what is wrong; and whether the XML repeats an object, at which GDAL stops."""
    found: Dict[str, str] = {}
    known: Dict[str, Set[str]] = {"node": set(), "way": set(), "relation": set()}
    is_repeated = False

    def hear(tag: str, own: Dict[str, str]) -> None:
        nonlocal is_repeated
        if tag in known:
            number = own.get("id", "")
            is_repeated = is_repeated or number in known[tag]
            known[tag].add(number)
        for name, most in (("lat", 90.0), ("lon", 180.0)) if tag == "node" else ():
            text = own.get(name, "").strip()
            if DECIMAL.fullmatch(text) and abs(float(text)) <= most:
                continue
            found.setdefault(own.get("id", ""), f"{name} is {own.get(name, '')[:40]!r}")

    _each(source, hear)
    return found, is_repeated


def _of_nodes(source: pathlib.Path, nodes: Dict[str, str]) -> Set[Tuple[str, str]]:
    """The ways with some nodes, and the relations with such ways."""
    found: Set[Tuple[str, str]] = set()
    at = ("", "")

    def hear(tag: str, own: Dict[str, str]) -> None:
        nonlocal at
        if tag in ("way", "relation"):
            at = tag, own.get("id", "")
        elif (tag == "nd" and own.get("ref") in nodes) or (tag == "member" and ("way", own.get("ref")) in found):
            found.add(at)

    _each(source, hear)
    return found


def _check_system(file: pathlib.Path) -> None:
    """Raises an error for GeoJSON in a coordinate system that is not known, which GDAL would read as degrees."""
    with open(file, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        found = CRS.search(data)
        said = found[1] if found else b"{}"
    system: Any = {}
    with contextlib.suppress(ValueError):  # GDAL names the error
        system = json.loads(said)
    more = system.get("properties") or {}
    name = more.get("name", "CRS84") if isinstance(more, dict) else "CRS84"
    if system.get("type") == "link":  # GDAL does not follow links
        name = f"a link to {more.get('href', '')}" if isinstance(more, dict) else "a link"
    try:
        if not isinstance(name, str) or not name.endswith("CRS84"):
            with quiet():
                osr.SpatialReference().SetFromUserInput(str(name))
    except RuntimeError:
        shown = CONTROLS.sub("", str(name))[:80]
        raise Error(f"{file}: the coordinate system is {shown!r}, expected a system of EPSG, or degrees") from None


def _in_order(file: pathlib.Path, out: pathlib.Path, left: List[Feature],
              without: Collection[str] = ()) -> pathlib.Path:
    """Writes a copy of XML of OpenStreetMap with nodes, then ways, then relations, each object once, by id.
    @param left gets the objects without an id @param without ids of nodes that are left out"""
    found: Dict[str, Dict[int, Tuple[int, bytes]]] = {"node": {}, "way": {}, "relation": {}}
    places: Dict[Tuple[str, str], str] = {}

    def keep(tag: str, number: Optional[str], size: int, text: bytes) -> None:
        if not ID.fullmatch(number or ""):
            left.append(Feature(tag, {"id": (number or "")[:40]}, reason=NO_ID))
            return
        assert number is not None
        found[tag][int(number)] = max(found[tag].get(int(number), (-1, b"")), (size, text), key=lambda one: one[0])

    root = None
    for event, one in ElementTree.iterparse(file, ("start", "end")):
        root = one if root is None else root
        if event == "start" or one.tag not in found:
            continue
        # Overpass gives coordinates for `out geom`, and no node numbers in members of relations.
        for node in one.iter("nd"):
            where = node.get("lat"), node.get("lon")
            if where[0]:
                number = node.get("ref") or places.setdefault(where, str(-(1 << 40) - len(places)))
                node.set("ref", number)
                keep("node", number, 0, f'<node id="{number}" lat="{where[0]}" lon="{where[1]}"/>'.encode())
        for member in one.iter("member"):
            nodes = "".join(f'<nd ref="{node.get("ref")}"/>' for node in member.iter("nd") if node.get("ref"))
            if nodes and member.get("type") == "way":
                keep("way", member.get("ref"), 0, f'<way id="{member.get("ref")}">{nodes}</way>'.encode())
        if one.get("action") != "delete" and one.get("visible") != "false" and (one.tag != "node" or one.get("lat")):
            keep(one.tag, one.get("id"), len(one) + 1, ElementTree.tostring(one))
        root.clear()
    with open(out, "wb") as stream:
        stream.write(b'<?xml version="1.0" encoding="UTF-8"?><osm version="0.6">\n')
        for number in without:
            found["node"].pop(int(number), None)
        for things in found.values():
            stream.writelines(things[number][1] for number in sorted(things))
        stream.write(b"</osm>\n")
    return out


def _expect_map(file: pathlib.Path) -> None:
    """Raises an error that names a frequent wrong kind of file in place of an extract."""
    with open(file, "rb") as stream:
        head = stream.read(2000).lstrip(b"\xef\xbb\xbf \r\n\t").lower()
    kinds = {"is empty": not head, "is in UTF-16": head.startswith((b"\xff\xfe", b"\xfe\xff")),
             "is a web page": head.startswith((b"<!doctype html", b"<html")),
             "is Overpass's own JSON": head.startswith(b"{") and b'"elements"' in head}
    what = next((what for what, is_so in kinds.items() if is_so), "")
    if what:
        raise Error(f"{file}: {what}, expected an extract of a map: "
                    "export it again as .osm, .osm.pbf, .geojson or .gpkg")


DAMAGED = "cannot be read to its end: the extract is damaged or incomplete, expected a complete extract"
LISTS = (ogr.OFTIntegerList, ogr.OFTInteger64List, ogr.OFTRealList, ogr.OFTStringList)


def _tags(feature, names: List[str]) -> Dict[str, str]:
    """Tags of a feature. GDAL makes lists of all values of a column in which one is a list."""
    said = tags_of({name: (feature.GetField(number) if feature.GetFieldType(number) in LISTS
                           else feature.GetFieldAsString(number)) for number, name in enumerate(names)
                    if feature.IsFieldSetAndNotNull(number)})
    return {name: value if value.isprintable() else CONTROLS.sub("", value) for name, value in said.items()}


def _features_of(data) -> Iterator[Tuple[Any, Any]]:
    """The features of an extract with their layers."""
    try:
        feature, layer = data.GetNextFeature()
        while feature is not None:
            yield feature, layer
            feature, layer = data.GetNextFeature()
    except RuntimeError:
        raise Error(DAMAGED) from None


def _comes_first(feature, names: List[str]) -> bool:
    """Whether a feature is read before it is known where the scene lies."""
    said = " ".join([f"{name} {feature.GetFieldAsString(number)}" for number, name in enumerate(names)
                     if feature.IsFieldSetAndNotNull(number)]).lower()
    return any(word in said for word in FIRST)


def _lies_apart(feature, west: float, east: float, south: float, north: float) -> bool:
    """Whether all corners of a feature are degrees outside a box."""
    shape = feature.GetGeometryRef()
    if shape is None or shape.IsEmpty():
        return False
    low_x, high_x, low_y, high_y = shape.GetEnvelope()
    are_degrees = -360.0 <= low_x and high_x <= 360.0 and -90.0 <= low_y and high_y <= 90.0
    return are_degrees and (high_x < west or low_x > east or high_y < south or low_y > north)


def read_extract(file: pathlib.Path, known: Dict[str, Any], bounds: Optional[Sequence[float]] = None) -> Extract:
    """Features known to the rules, aerodromes, and features that are left out. What lies far from all runways is
    counted, and not looked at. @param bounds west, south, east and north end of the scene, degrees, if given"""
    driver = SUFFIXES.get(file.suffix.lower())
    if not driver:
        raise Error(f"{file}: is not an extract by its name, expected .osm, .osm.pbf, .geojson or .gpkg")
    expect_file(file)
    if file.stat().st_size > LARGEST:
        raise Error(f"{file}: holds {file.stat().st_size >> 20} MiB, expected at most {LARGEST >> 20}: "
                    "cut the extract to the airport and some kilometres around it first, "
                    "for example with `osmium extract --bbox W,S,E,N`")
    _expect_map(file)
    settings = (f"CONFIG_FILE={pathlib.Path(__file__).with_name('osmconf.ini')}", "USE_CUSTOM_INDEXING=NO")
    aliases = {name.replace(":", "_"): name for name in known["colons"]}
    found, source = Extract(known, are_nested=driver == "OSM"), file
    with contextlib.ExitStack() as stack:
        if file.suffix.lower() == ".osm":
            folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
            try:
                with naming(f"{file}: its nodes, ways and relations"):
                    source = _in_order(file, folder / "in_order.osm", found.left) if _needs_order(file) else file
                    nowhere, is_repeated = ({}, False) if _is_usual(source) else _nodes_nowhere(source)
                    if nowhere or is_repeated:
                        nowhere = {number: words for number, words in nowhere.items() if ID.fullmatch(number)}
                        found.wrong = _of_nodes(source, nowhere)
                        source = _in_order(source, folder / "placed.osm", found.left, nowhere)
            except ElementTree.ParseError as error:
                raise Error(f"{file}: GDAL cannot read it as an extract ({error})") from None
            found.left += [Feature("node", {"id": number, "name": words}, reason=NO_DEGREES)
                           for number, words in nowhere.items()]
            found.left += [Feature("relation", {}, reason="no ways")] * _memberless(source)
        elif driver == "GeoJSON":
            _check_system(file)
        data = open_file(source, "an extract", [driver], gdal.OF_VECTOR, settings if driver == "OSM" else ())
        stack.enter_context(naming(str(file)))
        following = _features_of(data)
        if driver == "GeoJSON":
            try:
                following = iter(features_of_json(data))
            except RuntimeError:
                raise Error(DAMAGED) from None
        stack.enter_context(quiet(found.hear if driver == "OSM" else None))
        layers: Dict[str, Tuple[List[str], Any]] = {}
        waiting: List[Tuple[Any, str]] = []

        def take(feature, layer: str) -> None:
            names, to_degrees = layers[layer]
            tags = _tags(feature, names)
            if driver != "OSM":
                tags = tags or {"feature": str(feature.GetFID())}
            elif layer == "lines":
                tags["osm_way_id"] = tags.get("osm_id", "")
            if tags:
                found.take(tags, plain(feature.GetGeometryRef(), to_degrees))

        for feature, layer in following:
            if layer.GetName() not in layers:
                own, frame = layer.GetSpatialRef(), layer.GetLayerDefn()
                if own is not None:
                    own.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
                names = [frame.GetFieldDefn(number).GetName() for number in range(frame.GetFieldCount())]
                layers[layer.GetName()] = [aliases.get(name, name) for name in names], (
                    None if own is None or own.IsSame(degrees()) else osr.CoordinateTransformation(own, degrees()))
                shape = feature.GetGeometryRef()
                if layers[layer.GetName()][1] is not None and shape is not None and not shape.IsEmpty():
                    place = moved(shape.Centroid(), layers[layer.GetName()][1])
                    accuracy_words(file, own, (place.GetX(), place.GetY()))
            names, to_degrees = layers[layer.GetName()]
            if to_degrees is not None or _comes_first(feature, names):
                take(feature, layer.GetName())
            else:
                waiting.append((feature, layer.GetName()))
        around = found.surroundings(bounds)
        for feature, name in waiting:
            if around and _lies_apart(feature, *around):
                found.apart += 1
            else:
                take(feature, name)
        del data, waiting
    return found.done()
