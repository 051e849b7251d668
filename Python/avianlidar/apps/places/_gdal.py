# SPDX-License-Identifier: BSD-3-Clause
"""Geometries (ogr) and files by GDAL."""
from __future__ import annotations

import contextlib
import functools
import itertools
import json
import math
import os
import pathlib
import warnings
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple

import numpy as np
from osgeo import gdal, ogr, osr

from ..._pipeline import Error, callers_level
from ._features import form_of

GRID_ACCURACY = 1.0  # m: worse accuracies of coordinates are reported
ACCURACIES = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 25.0, 30.0, 50.0, 100.0, 1000.0)  # m

MODULES = gdal, ogr, osr
for one in MODULES:
    one.UseExceptions()


HARMLESS = "Non closed ring detected"  # start of a warning; all rings are closed
# No file leads GDAL to a server: no URL is allowed, and the proxy does not exist.
OFFLINE = {"CPL_VSIL_CURL_ALLOWED_FILENAME": "none", "GDAL_HTTP_PROXY": "127.0.0.1:1", "GDAL_HTTP_MAX_RETRY": "0"}


@contextlib.contextmanager
def quiet(hear: Optional[Callable[[str], Any]] = None) -> Iterator[None]:
    """Suppresses GDAL's messages, and the network of GDAL (in this thread) and of PROJ. @param hear is called with the
    messages, and with the OSM driver's messages on ways and relations"""
    before, online = gdal.GetConfigOption("CPL_DEBUG"), osr.GetPROJEnableNetwork()
    own = {name: gdal.GetThreadLocalConfigOption(name) for name in OFFLINE}
    gdal.PushErrorHandler("CPLQuietErrorHandler" if hear is None else lambda _, number, words: hear(words))
    gdal.SetConfigOption("CPL_DEBUG", before if hear is None else "OSM")
    osr.SetPROJEnableNetwork(False)
    for name, value in OFFLINE.items():
        gdal.SetThreadLocalConfigOption(name, value)
    try:
        yield
    finally:
        for name, value in own.items():
            gdal.SetThreadLocalConfigOption(name, value)
        osr.SetPROJEnableNetwork(online)
        gdal.SetConfigOption("CPL_DEBUG", before)
        gdal.PopErrorHandler()


@contextlib.contextmanager
def warning_of(file: pathlib.Path) -> Iterator[None]:
    """As `quiet`; GDAL's warnings on a file become one warning of Python."""
    heard: List[str] = []
    with quiet():
        gdal.PushErrorHandler(lambda severity, _, words: heard.append(words) if severity == gdal.CE_Warning else None)
        try:
            yield
        finally:
            gdal.PopErrorHandler()
    heard = [words for words in dict.fromkeys(heard) if not words.startswith(HARMLESS)]
    if heard:
        more = f" (and {len(heard) - 1} more of its warnings)" if heard[1:] else ""
        warnings.warn(f"{file}: GDAL warns: {heard[0]}{more}", RuntimeWarning, stacklevel=callers_level())


def expect_file(file: pathlib.Path, named: str = "") -> None:
    """@param named begins the message in place of the file's name"""
    if not file.exists():
        raise FileNotFoundError(f"{named}, which does not exist" if named else f"no such file: {file}")
    if not file.is_file():
        raise Error(f"{named}, which is not a regular file" if named else f"{file}: it is not a regular file")


def open_file(file: pathlib.Path, what: str, drivers: List[str], kind: int, options: Tuple[str, ...] = (),
              beside: Sequence[str] = (), content: str = ""):
    """A regular file with one of GDAL's drivers. @param beside names of files of the same folder that belong to the
    file @param content text that replaces the file's content"""
    expect_file(file)
    with warning_of(file):
        try:
            return gdal.OpenEx(content or os.path.abspath(file), kind | gdal.OF_READONLY, allowed_drivers=drivers,
                               open_options=list(options), sibling_files=[file.name, *beside])
        except RuntimeError as error:
            raise Error(f"{file}: GDAL cannot read it as {what} ({error})") from None


def features_of_json(data) -> List[Tuple[Any, Any]]:
    """The features of GeoJSON with their layers. A feature whose coordinates are not numbers has no geometry. Raises
    `RuntimeError` for other errors."""
    found: List[Tuple[Any, Any]] = []
    failed: List[str] = []

    def hear(severity: int, _: int, words: str) -> None:
        if severity > gdal.CE_Warning:
            failed.append(words)

    for module in reversed(MODULES):  # an exception would take the place of a feature
        module.DontUseExceptions()
    try:
        with quiet():
            gdal.PushErrorHandler(hear)
            try:
                feature, layer = data.GetNextFeature()
                while feature is not None:
                    found.append((feature, layer))
                    feature, layer = data.GetNextFeature()
            finally:
                gdal.PopErrorHandler()
    finally:
        for module in MODULES:
            module.UseExceptions()
    failed = [words for words in failed if not words.startswith("Invalid ")]
    if failed:
        raise RuntimeError(failed[0])
    return found


def accuracy_of(system, place: Sequence[float]) -> Optional[float]:
    """Accuracy by PROJ of the transformation from a system to WGS84 at a place, m, rounded up to one of ACCURACIES;
    None if PROJ does not know it. @param place longitude and latitude, deg"""
    plan = system.Clone()
    plan.DemoteTo2D()
    plan.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    with quiet():
        for accuracy in ACCURACIES:
            options = osr.CoordinateTransformationOptions()
            options.SetDesiredAccuracy(accuracy)
            options.SetBallparkAllowed(False)
            with contextlib.suppress(RuntimeError):
                if np.isfinite(osr.CoordinateTransformation(degrees(), plan, options).TransformPoint(*place)).all():
                    return accuracy
    return None


def accuracy_words(file: pathlib.Path, system, place: Sequence[float]) -> str:
    """Words on the accuracy of coordinates, and a warning, if the accuracy is worse than GRID_ACCURACY or unknown.
    @param place longitude and latitude, deg"""
    accuracy = accuracy_of(system, place)
    if accuracy is not None and accuracy <= GRID_ACCURACY:
        return ""
    name, said = system.GetName(), "unknown" if accuracy is None else f"{accuracy:g} m"
    warnings.warn(f"{file}: the accuracy with which PROJ transforms {name} to WGS84 is {said} here; a grid of PROJ may "
                  "be missing (`projinfo` names grids)", RuntimeWarning, stacklevel=callers_level())
    return f"; the accuracy of the transformation from {name} to WGS84 is {said}"


def degrees():
    system = osr.SpatialReference()
    system.ImportFromEPSG(4326)
    system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return system


def geometry(kind: str, coordinates: Any):
    """A geometry (ogr). @param kind as in GeoJSON, as are the coordinates"""
    return ogr.CreateGeometryFromJson(json.dumps({"type": kind, "coordinates": coordinates}, default=np.ndarray.tolist))


def box_of(west_south_east_north: Sequence[float]):
    west, south, east, north = west_south_east_north
    return geometry("Polygon", [[(west, south), (east, south), (east, north), (west, north), (west, south)]])


def moved(shape, to):
    """A copy in other coordinates. @param to a transformation (osr)"""
    shape = shape.Clone()
    shape.Transform(to)
    return shape


def valid(shape, nested: bool = False):
    """A valid geometry. In areas each ring is made valid alone, because GEOS fills some holes that share edges. A hole
    around its outline changes places with it. @param nested whether an outline inside the area is a hole, because GDAL's
    OSM driver takes some holes for islands; equal rings count once"""
    if shape.IsValid():
        return shape
    name = shape.GetGeometryName()
    areas = {"POLYGON": [shape], "MULTIPOLYGON": shape}.get(name)
    if areas is None:
        return shape.MakeValid()
    polygons = []
    for one in areas:
        outlines = []
        for ring in one:
            outline = ogr.Geometry(ogr.wkbPolygon)
            outline.AddGeometry(ring)
            outlines.append(outline if outline.IsValid() else outline.MakeValid())
        polygons.append(outlines)
    if nested:
        return _nested(polygons)
    wholes = []
    for outline, *holes in polygons:
        around = next((hole for hole in holes if hole.Contains(outline) and not outline.Contains(hole)), None)
        rings = [around, outline, *(hole for hole in holes if hole is not around)] if around else [outline, *holes]
        wholes.append(functools.reduce(lambda whole, hole: whole.Difference(hole), rings))
    return functools.reduce(lambda whole, other: whole.Union(other), wholes)


def _nested(polygons: List[List[Any]]):
    """The area of rings (ogr, valid) of polygons. A ring inside a larger one is a hole."""
    rings = [(number > 0, ring, ring.Area() if ring.GetDimension() == 2 else 0.0)
             for polygon in polygons for number, ring in enumerate(polygon)]
    rings.sort(key=lambda ring: -ring[2])
    whole, larger = rings[0][1], rings[:1]
    for one in rings[1:]:
        is_hole, ring, area = one
        alike = itertools.takewhile(lambda other: other[2] - area <= 1e-9 * area, reversed(larger))
        if any(ring.Contains(other[1]) and other[1].Contains(ring) for other in alike):
            continue
        larger.append(one)
        whole = whole.Difference(ring) if is_hole or whole.Contains(ring) else whole.Union(ring)
    return whole


def plain(shape, to_degrees):
    """A geometry of straight lines in degrees; what consists of one part is that part, and rings are closed."""
    if shape is None:
        return None
    shape = shape.GetLinearGeometry()
    if to_degrees is not None:
        shape.Transform(to_degrees)
    shape.FlattenTo2D()
    shape.CloseRings()
    is_one = shape.GetGeometryName().startswith("MULTI") and shape.GetGeometryCount() == 1
    return shape.GetGeometryRef(0).Clone() if is_one else shape


def parts_of(shape) -> List[Any]:
    """Points, lines and polygons of a geometry (ogr)."""
    if form_of(shape) and "MULTI" not in shape.GetGeometryName():
        return [shape]
    return [part for one in shape for part in parts_of(one.Clone())]


def corners_of(shape) -> np.ndarray:
    """The corners (n x 2) of points, lines and outer rings."""
    points = [point for part in parts_of(shape)
              for point in (part.GetGeometryRef(0) if part.GetGeometryCount() else part).GetPoints() or ()]
    return np.array(points, dtype=float).reshape(-1, 2)


def is_closed(shape) -> bool:
    """Whether a geometry is a line of three or more corners that ends where it begins."""
    points = shape.GetPoints() if shape.GetGeometryName() == "LINESTRING" else ()
    return len(points or ()) > 3 and points[0][:2] == points[-1][:2]


def solid(shape, stray: Callable[[], Any] = lambda: None, crossing: Callable[[], Any] = lambda: None,
          nested: bool = False):
    """The polygons in a closed line or an area, without rings that enclose nothing and without holes outside the outer
    rings. May be empty. @param stray is called for each hole outside the outer rings @param crossing is called if other
    rings cross, overlap or share edges @param nested as for `valid`"""
    area = shape.Clone() if form_of(shape) == "area" else ogr.ForceToPolygon(shape.Clone())
    polygons = [[ring.GetPoints() or () for ring in part] for part in parts_of(area)]
    if all(len(ring) > 3 for rings in polygons for ring in rings) and area.IsValid():
        return area
    # GEOS refuses rings of fewer than three corners.
    kept = [[ring for ring in rings if len(ring) > 3] for rings in polygons if rings and len(rings[0]) > 3]
    outside = union([geometry("Polygon", rings[:1]) for rings in kept])
    for rings in kept:
        for ring in rings[:0:-1]:
            hole = union([geometry("Polygon", [ring])])
            if hole.Area() > 0.0 == hole.Intersection(outside).Area():
                rings.remove(ring)
                stray()
    whole = geometry("MultiPolygon", kept)
    if not whole.IsValid():
        crossing()
    return union([whole], nested)


def union(areas: List[Any], nested: bool = False):
    whole = ogr.Geometry(ogr.wkbMultiPolygon)
    for area in areas:
        for part in parts_of(valid(area, nested)):
            if form_of(part) == "area":
                whole.AddGeometry(part)
    return whole.UnionCascaded()


def coordinate_system(origin: Sequence[float]):
    """The scene's plane for GIS: the transverse Mercator projection about the origin on WGS84, scaled to the origin's
    height. The difference to east and north is some millimetres at 3 km. @param origin latitude, longitude (deg),
    height (m)"""
    system = osr.SpatialReference()
    # Lengths at a height are longer than on the ellipsoid, in proportion to the distance from the centre of curvature.
    flattening = 1.0 / osr.SRS_WGS84_INVFLATTENING
    bulge = 1.0 - flattening * (2.0 - flattening) * math.sin(math.radians(origin[0])) ** 2
    radius = osr.SRS_WGS84_SEMIMAJOR * (1.0 - flattening) / bulge
    system.ImportFromProj4(f"+proj=tmerc +lat_0={origin[0]:.12g} +lon_0={origin[1]:.12g} "
                           f"+k={1.0 + origin[2] / radius:.12g} +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs")
    system.SetProjCS("metres east and north of the scene's origin")
    return system
