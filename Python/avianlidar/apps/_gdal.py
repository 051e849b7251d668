# SPDX-License-Identifier: BSD-3-Clause
"""Geometries (ogr) and files by GDAL."""
from __future__ import annotations

import contextlib
import json
import pathlib
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple

import numpy as np
from osgeo import gdal, ogr, osr

from .._pipeline import Error
from ._features import form_of

for module in (gdal, ogr, osr):
    module.UseExceptions()


@contextlib.contextmanager
def quiet(hear: Optional[Callable[[str], Any]] = None) -> Iterator[None]:
    """Suppresses GDAL's warnings. @param hear is called with them and with the OSM driver's messages on ways
    and relations"""
    before = gdal.GetConfigOption("CPL_DEBUG")
    gdal.PushErrorHandler("CPLQuietErrorHandler" if hear is None else lambda _, number, words: hear(words))
    gdal.SetConfigOption("CPL_DEBUG", before if hear is None else "OSM")
    try:
        yield
    finally:
        gdal.SetConfigOption("CPL_DEBUG", before)
        gdal.PopErrorHandler()


def expect_file(file: pathlib.Path) -> None:
    if not file.exists():
        raise FileNotFoundError(f"no such file: {file}")
    if not file.is_file():
        raise Error(f"{file}: it is not a regular file")


def open_file(file: pathlib.Path, what: str, drivers: List[str], kind: int, options: Tuple[str, ...] = ()):
    """A regular file with one of GDAL's drivers."""
    expect_file(file)
    try:
        return gdal.OpenEx(str(file.resolve()), kind | gdal.OF_READONLY, allowed_drivers=drivers,
                           open_options=list(options))
    except RuntimeError as error:
        raise Error(f"{file}: GDAL cannot read it as {what} ({error})") from None


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


def valid(shape):
    return shape if shape.IsValid() else shape.MakeValid()


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


def solid(shape, stray: Callable[[], Any] = lambda: None):
    """The polygons in a closed line or an area, without rings that enclose nothing and without holes outside the outer
    rings. May be empty. @param stray is called for each hole outside the outer rings"""
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
    return union([geometry("MultiPolygon", kept)])


def union(areas: List[Any]):
    whole = ogr.Geometry(ogr.wkbMultiPolygon)
    for area in areas:
        for part in parts_of(valid(area)):
            if form_of(part) == "area":
                whole.AddGeometry(part)
    return whole.UnionCascaded()
