# SPDX-License-Identifier: BSD-3-Clause
"""Runways and outlines in GeoJSON files, files of sites, and conversion between degrees and metres of a scene."""
from __future__ import annotations

import itertools
import json
import pathlib
import re
import warnings
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from ... import vtkAvianLidar as _wrapped
from ..._cloud import Cloud, add_array, vertices
from ..._coverage import places_of
from ..._disk import write_whole
from ..._files import save
from ..._pipeline import Error, callers_level, update
from ..._properties import set_properties
from ..._ranks import as_json
from ..inputs._json import load_json, naming, packaged
from ._features import Reasons, length_of, tags_of, width_of
from ._regions import Runway, designators

NEAR_LINE = 3000.0  # greatest gap between runways on one line that may be one runway, m


def _transformed(points, origin: Sequence[float], source: str, target: str) -> np.ndarray:
    transform = _wrapped.vtkAvianLidarGeodeticTransform()
    transform.SetInputData(places_of(points))
    set_properties(transform, source_frame=source, target_frame=target, origin=tuple(origin), move_points=True,
                   use_field_data_origin=False)
    update(transform)
    return Cloud(transform.GetOutputDataObject(0)).points.copy()


def placed(points, origin: Sequence[float]) -> np.ndarray:
    """East, north and up, m. @param points n x 3, longitude and latitude (deg) and height (m) @param origin latitude,
    longitude (deg), height (m)"""
    return _transformed(points, origin, "geodetic", "enu")


def to_enu(longitudes_latitudes, origin: Sequence[float]) -> np.ndarray:
    """East and north, m. @param longitudes_latitudes n x 2, deg @param origin latitude, longitude (deg), height (m)"""
    degrees = np.asarray(longitudes_latitudes, dtype=float)
    return placed(np.column_stack([degrees, np.full(len(degrees), origin[2])]), origin)[:, :2]


def to_geodetic(points, origin: Sequence[float]) -> np.ndarray:
    """Longitude, latitude (deg) and height above the ellipsoid (m). @param points n x 3, m east, north and up
    @param origin latitude, longitude (deg), height (m)"""
    return _transformed(points, origin, "enu", "geodetic")


def features_of(path: pathlib.Path) -> List[Dict[str, Any]]:
    """The features of a GeoJSON file; their properties and geometries are objects, empty where the file has null."""
    document = load_json(path)
    features = document.get("features") if isinstance(document, dict) else None
    if not isinstance(features, list):
        raise Error(f"{path}: is not a GeoJSON file with features")
    for number, feature in enumerate(features):
        if not isinstance(feature, dict):
            raise Error(f"{path}: features[{number}]: is {str(feature)[:40]}, expected an object")
        for name in ("properties", "geometry"):
            part = {} if feature.get(name) is None else feature[name]
            if not isinstance(part, dict):
                raise Error(f"{path}: features[{number}].{name}: is {str(part)[:40]}, expected an object or null")
            feature[name] = part
    return features


def _corners(coordinates: Any, least: int) -> np.ndarray:
    """Longitudes and latitudes (n x 2, deg) of corners in GeoJSON. @param least least number of corners"""
    try:
        degrees = np.array([point[:2] for point in coordinates])
    except (TypeError, ValueError, LookupError):
        degrees = np.empty(0)
    if degrees.dtype.kind not in "iuf" or degrees.ndim != 2 or degrees.shape[1] != 2 or len(degrees) < least:
        raise ValueError(f"the coordinates are not {least} or more pairs of longitude and latitude")
    return degrees


def _lines(shape: Dict[str, Any], origin: Sequence[float]) -> List[np.ndarray]:
    """The ends (2 x 2, m) of each line in GeoJSON. Lines of a MultiLineString that lie on one line are one."""
    is_many = shape["type"] == "MultiLineString"
    lines = shape.get("coordinates") if is_many else [shape.get("coordinates")]
    if not isinstance(lines, list) or not lines:
        raise ValueError("the coordinates of a MultiLineString are not a list of lines")
    ends = [to_enu(_corners(line, 2), origin)[[0, -1]] for line in lines]
    points = np.concatenate(ends)
    first = points[np.argmax(np.hypot(*(points - points[0]).T))]
    last = points[np.argmax(np.hypot(*(points - first).T))]
    if (last - first) @ (ends[0][1] - ends[0][0]) < 0.0:
        first, last = last, first
    x, y = last - first
    beside = np.abs((points - first) @ (-y, x)) / max(np.hypot(x, y), 1.0)
    is_one = is_many and beside.max() <= packaged("places/airport.json")["runway_offset"]
    return [np.array([first, last])] if is_one else ends


def read_runways(file, origin: Sequence[float]) -> List[Runway]:
    """The runways of a GeoJSON file: lines whose property or tag `kind` or `aeroway` is "runway", with `name` or `ref`
    and `width`, in service, on land. @param origin of the scene: latitude, longitude (deg), height (m)"""
    path, known = pathlib.Path(file), packaged("places/airport.json")
    reasons, left = Reasons(known), []
    found: List[Runway] = []
    strange: List[str] = []
    for number, feature in enumerate(features_of(path)):
        with naming(f"{path}: features[{number}]"):
            tags, shape = tags_of(feature["properties"]), feature["geometry"]
            is_runway = "runway" in (tags.get("kind"), tags.get("aeroway", "").lower())
            if not is_runway or shape.get("type") not in ("LineString", "MultiLineString"):
                continue
            reason = reasons.find(tags)
            if reason:
                left.append(reason)
                continue
            width, source = width_of(tags, "runway", known)
            for (x0, y0), (x1, y1) in (ends.tolist() for ends in _lines(shape, origin)):
                name = tags.get("name") or tags.get("ref") or f"runway {len(found) + 1}"
                length = float(np.hypot(x1 - x0, y1 - y0))
                if not length > 1.0:
                    raise ValueError(f"{name}: is {length:g} m long, expected a line of some length")
                said = [tags.get(end, "0") for end in ("displaced_start", "displaced_end")]
                away = [0.0 if re.fullmatch(r"0*\.?0*", text) else length_of(text, length) for text in said]
                if None in away or length in away:
                    raise ValueError(f"{name}: displaced thresholds are {said[0]!r} and {said[1]!r}, "
                                     "expected metres, less than the runway's length")
                strange += [f"{name}: {source.partition(': ')[2]}"] if ": " in source else []
                found.append(Runway(name, (x0, y0), (x1, y1), width, (away[0] or 0.0, away[1] or 0.0)))
    if not found:
        raise Error(f"{path}: holds no runway{f' in use (left out: {left[0]})' if left else ''}, expected lines whose "
                    "property kind or aeroway is runway; `avianlidar airport` makes such a file from any extract of a "
                    "map")
    if strange:
        warnings.warn(f"{path}: {'; '.join(strange)}, expected metres above 0; the runway counts as "
                      f"{known['kinds']['runway']['width']:g} m wide", RuntimeWarning, stacklevel=callers_level())
    doubtful = _doubtful(found, known)
    if doubtful:
        warnings.warn(f"{path}: {'; '.join(doubtful[:4])}; expected one line for each runway: `avianlidar airport` "
                      f"joins pieces that are up to {known['runway_gap']:g} m apart", RuntimeWarning,
                      stacklevel=callers_level())
    return found


def _doubtful(runways: Sequence[Runway], known: Dict[str, Any]) -> List[str]:
    """Pairs of runways that may be pieces of one, in words: of one name, or on one line."""
    found = []
    for one, other in itertools.combinations(runways, 2):
        short, long = sorted((one, other), key=lambda runway: runway.axis()[1])
        beside, gap = long.beside(short)
        is_line = beside <= known["runway_offset"] and gap <= NEAR_LINE
        is_named = not any(re.fullmatch(r"runway \d+", runway.name) for runway in (one, other))
        if is_line or (is_named and designators(one.name) & designators(other.name)):
            found.append(f"{one.name[:40]} and {other.name[:40]} "
                         + (f"lie on one line, {gap:.0f} m apart" if is_line else "have one name"))
    return found


def _open(ring: np.ndarray) -> np.ndarray:
    """A ring, n x 2, without its first corner at its end."""
    if np.array_equal(ring[0], ring[-1]):
        ring = ring[:-1]
    if len(ring) < 3:
        raise ValueError("a ring has fewer than 3 corners")
    return ring


def read_outlines(file, origin: Sequence[float], attribute: str = "") -> List[Any]:
    """The polygons in a GeoJSON file: for each polygon its ring (n x 2, m, open), or a list of the outer ring and the
    holes. @param origin of the scene: latitude, longitude (deg), height (m) @param attribute only features with this
    attribute are read"""
    outlines: List[Tuple[int, List[np.ndarray]]] = []  # number of the feature, rings in degrees
    for number, feature in enumerate(features_of(pathlib.Path(file))):
        shape = feature["geometry"]
        if shape.get("type") in ("Polygon", "MultiPolygon") and (not attribute or feature["properties"].get(attribute)):
            with naming(f"{file}: features[{number}]"):
                polygons = [shape.get("coordinates")] if shape["type"] == "Polygon" else shape.get("coordinates")
                if not isinstance(polygons, list):
                    raise ValueError("the coordinates of a MultiPolygon are not a list")
                outlines += [(number, [_corners(ring, 3) for ring in (rings if isinstance(rings, list) else [None])])
                             for rings in polygons]
    every = [ring for _, rings in outlines for ring in rings]
    try:  # a conversion takes as long as that of a thousand corners
        metres = iter(np.split(to_enu(np.concatenate([np.empty((0, 2)), *every]), origin),
                               np.cumsum([len(ring) for ring in every[:-1]], dtype=int)))
    except Error:
        metres = None
    found: List[Any] = []
    for number, rings in outlines:
        with naming(f"{file}: features[{number}]"):
            outline = [_open(next(metres) if metres else to_enu(ring, origin)) for ring in rings]
            found += [outline if len(outline) > 1 else outline[0]] if outline else []
    return found


def _height(value: Any) -> float:
    """A height (m) as scenes read it: a number, or its text with or without "m"; 0 for any other value."""
    try:
        found = float(re.sub(" ?m$", "", value) if isinstance(value, str) else value)
    except (TypeError, ValueError):
        return 0.0
    return found if found > 0.0 and np.isfinite(found) and not isinstance(value, bool) else 0.0


def with_other_heights(scene_file, folder, offset: Callable[[], float]) -> pathlib.Path:
    """Copies a scene file to `folder`. In the copy, every footprint in GeoJSON whose height is read from an attribute
    is higher by the value of `offset` (m); no height is below 0.1 m. Files keep their names, because objects are named
    after files. @return the new scene file"""
    path, out = pathlib.Path(scene_file), pathlib.Path(folder)
    scene = load_json(path)
    changed: Dict[str, Tuple[pathlib.Path, Any]] = {}
    moved = set()
    for item in scene["objects"]:
        item.update({key: str((path.parent / item[key]).resolve()) for key in ("file", "footprints") if key in item})
        name, height = item.get("footprints"), item.get("height_attribute")
        if not (name and height and re.search(r"json(\.gz)?$", name, re.IGNORECASE)):
            continue
        if name not in changed:
            file = pathlib.Path(name)
            new = out.resolve() / f"footprints{len(changed)}" / (file.stem if file.suffix == ".gz" else file.name)
            changed[name] = new, load_json(name)
        item["footprints"], shapes = str(changed[name][0]), changed[name][1]
        features = shapes.get("features") if isinstance(shapes, dict) else None
        features = features if isinstance(features, list) else []
        rows = [feature.get("properties") for feature in features if isinstance(feature, dict)]
        for properties in (row for row in rows if isinstance(row, dict)):
            value = _height(properties.get(height))
            if value and (id(properties), height) not in moved:
                properties[height] = max(value + offset(), 0.1)
                under = _height(properties.get(item.get("min_height_attribute")))
                if under:  # an object above the ground keeps its thickness
                    properties[item["min_height_attribute"]] = max(under + properties[height] - value, 0.0)
                moved.add((id(properties), height))
    out.mkdir(parents=True, exist_ok=True)
    for file, shapes in changed.values():
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(shapes), encoding="utf-8")
    (out / path.name).write_text(json.dumps(scene), encoding="utf-8")
    return out / path.name


def write_sites(folder, sites, columns: Mapping[str, Any], origin: Optional[Sequence[float]] = None,
                description: str = "") -> None:
    """Writes sites.csv and sites.vtp, and sites.geojson if the scene has an origin: one point for each site, in the
    given order.

    sites        n x 3, m
    columns      numbers by name, n each
    origin       latitude, longitude (deg), height (m) of the scene's origin
    description  description in sites.geojson
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
    rows = zip(degrees.tolist(), *(np.asarray(values).tolist() for values in columns.values()))
    features = [{"type": "Feature", "properties": dict(zip(columns, row)), "geometry": {
        "type": "Point", "coordinates": [round(lon, 9), round(lat, 9), round(height, 4)]}}
        for (lon, lat, height), *row in rows]
    write_whole(out / "sites.geojson", as_json({
        "type": "FeatureCollection", "description": description, "features": features}))
