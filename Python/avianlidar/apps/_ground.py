# SPDX-License-Identifier: BSD-3-Clause
"""The ground of an airport: heights of a raster with the file's units and holes, and triangles.

GDAL gives the unit and the nodata value that the file declares. Many files declare no nodata value, or a value that
differs from the value of the holes. Therefore, values outside the heights of the Earth's ground also count as holes.
"""
from __future__ import annotations

import math
import pathlib
import re
import warnings
from typing import Any, Dict, Optional, Sequence, Tuple

import numpy as np
from osgeo import gdal, osr

from .._pipeline import Error
from .._scene import mesh as _surface
from ._gdal import open_file, quiet
from ._json import naming
from ._maps import coordinate_system

DRIVERS = {"GTiff": "GeoTIFF", "AAIGrid": "ASCII grid", "SRTMHGT": "SRTM .hgt", "VRT": "GDAL .vrt"}
WHAT = f"heights, expected {', '.join(DRIVERS.values())}"
LOWEST, HIGHEST = -500.0, 9000.0  # m: the Dead Sea's shore lies at -430, Everest at 8,849
SENTINELS = (-32768.0, -32767.0, -9999.0)  # raw values of holes, also if the unit makes them possible heights
HOLE = -1e9  # value of holes in the returned raster
FOOT, SURVEY_FOOT = 0.3048, 1200.0 / 3937.0  # m
METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "km": 1000.0, "ft": FOOT, "us ft": SURVEY_FOOT, "yd": 0.9144,
          "in": 0.0254, "fathom": 1.8288}
SPELLINGS = (  # spellings of GDAL, EPSG, Esri and users, in lower case
    (r"(?:us |u s )(?:survey )?(?:foot|feet|ft)|us ?ft|(?:foot|feet|ft) ?us|survey (?:foot|feet)", "us ft"),
    (r"(?:international |intl )?(?:foot|feet|ft)", "ft"), (r"(?:international )?(?:yards?|yd)", "yd"),
    (r"inch|inches|in", "in"), (r"fathoms?", "fathom"),
    (r"([dcmk]?m)", ""), (r"(deci|centi|milli|kilo|)met(?:re|er)s?", ""))
PREFIXES = {"": "m", "deci": "dm", "centi": "cm", "milli": "mm", "kilo": "km"}
MOST_POSTS = 250_000  # greatest number of posts of a terrain, which takes some seconds
MOST_CHOSEN = 0.25  # share of the posts above which all posts are taken


def metres_of(name: str) -> Optional[float]:
    """Metres in a unit; None for an unknown name."""
    plain = re.sub(r"[\s_.()-]+", " ", name).strip().lower()
    for pattern, unit in SPELLINGS:
        found = re.fullmatch(pattern, plain)
        if found:
            return METRES[unit or PREFIXES.get(found[1], found[1])]
    return None


def unit_of(data) -> Tuple[str, float, str]:
    """The unit of a raster's heights and the metres in the unit, from the band or from the vertical system; "" and 1 if
    the file gives no unit. The third value is then the likely unit: the unit of the coordinates, if this is not the
    metre."""
    system = osr.SpatialReference()
    system.ImportFromWkt(data.GetProjection())
    named = data.GetRasterBand(1).GetUnitType()
    vertical, factor = system.GetAttrValue("VERT_CS|UNIT", 0), float(system.GetAttrValue("VERT_CS|UNIT", 1) or 1.0)
    if not named:
        likely = not vertical and system.IsProjected() and abs(system.GetLinearUnits() - 1.0) > 1e-9
        return vertical or "", factor, system.GetLinearUnitsName() if likely else ""
    metres = metres_of(named)
    if metres is None:
        raise Error(f"its heights are in {named!r}, expected one of {', '.join(METRES)}")
    if vertical and not math.isclose(metres, factor, rel_tol=1e-4):
        raise Error(f"its band gives heights in {named!r} and its vertical system in {vertical!r}, expected one unit")
    return named, metres, ""


def in_metres(file: pathlib.Path, data):
    """A raster's first band in metres, with HOLE at missing heights; blocks are read when they are needed. @return the
    raster, and the unit that the file gives"""
    if not data.GetProjection():
        raise Error("does not say its coordinate reference system; an ASCII grid needs a .prj file with the system")
    band = data.GetRasterBand(1)
    if band.DataType == gdal.GDT_Byte:
        raise Error(f"holds bytes in {data.RasterCount} {'bands' if data.RasterCount > 1 else 'band'}, "
                    "as a picture or a hillshade does, expected heights of 16 bits or more")
    unit, metres, likely = unit_of(data)
    if likely:
        warnings.warn(f"{file}: says no unit of its heights, and its coordinates are in {likely}: "
                      f"the heights are read as metres, but are likely in {likely}; "
                      f"`gdal_edit.py -units '{likely}' {file.name}` sets the unit", RuntimeWarning, stacklevel=4)
    scale, offset = metres * (band.GetScale() or 1.0), metres * (band.GetOffset() or 0.0)
    copy = gdal.Translate("", data, format="VRT", bandList=[1], outputType=gdal.GDT_Float64, noData=HOLE)
    text = re.sub(r"<(Scale|Offset|UnitType)>[^<]*</\1>", "", copy.GetMetadata("xml:VRT")[0])
    text = re.sub(r"<(/?)SimpleSource\b", r"<\1ComplexSource", text, count=2)  # of the band; the mask is kept
    none = band.GetNoDataValue()
    table = ("" if none is None else f"<NODATA>{none!r}</NODATA>") + f"<LUT>{_table(scale, offset)}</LUT>"
    return gdal.Open(text.replace("</ComplexSource>", f"{table}</ComplexSource>", 1)), unit


def _table(scale: float, offset: float) -> str:
    """Table from raw values to heights, between which GDAL interpolates: metres within the limits, else HOLE."""
    low, high = sorted(((LOWEST - offset) / scale, (HIGHEST - offset) / scale))
    sentinels = sorted(value for value in SENTINELS if low < value < high)
    around = [math.nextafter(value, way) for value in sentinels for way in (-math.inf, math.inf)]
    known = {raw: scale * raw + offset for raw in (low, *around, high)}
    outside = (-1e300, math.nextafter(low, -math.inf), *sentinels, math.nextafter(high, math.inf), 1e300)
    return ",".join(f"{raw!r}:{height!r}" for raw, height in sorted({**known, **dict.fromkeys(outside, HOLE)}.items()))


def posts_of(rectangle: Sequence[float], spacing: float) -> Tuple[int, int]:
    """The numbers of rows and columns of posts that cover a rectangle. @param rectangle west, east, south, north, m"""
    columns, rows = np.ceil(np.diff(np.reshape(rectangle, (2, 2)))[:, 0] / spacing).astype(int) + 1
    return int(rows), int(columns)


def read_heights(file: pathlib.Path, origin: Sequence[float], rectangle: Sequence[float], known: Dict[str, Any]
                 ) -> Tuple[np.ndarray, float, float, str]:
    """Heights of a raster at posts that cover a rectangle (m from the origin), rows from south to north. Missing
    heights become level ground, into which the raster fades. @return heights (m), spacing (m), height at the origin
    (m), words for the reader"""
    raw = open_file(file, WHAT, list(DRIVERS), gdal.OF_RASTER)
    with naming(str(file)), quiet():
        data, unit = in_metres(file, raw)
        system = coordinate_system((*origin[:2], 0.0)).ExportToWkt()
        own = abs(gdal.AutoCreateWarpedVRT(data, None, system).GetGeoTransform()[1])
        west, east, south, north = rectangle
        spacing = max(own, math.sqrt((east - west) * (north - south) / MOST_POSTS))
        rows, columns = posts_of(rectangle, spacing)
        left, bottom = west - spacing / 2, south - spacing / 2
        grid = gdal.Warp("", data, format="MEM", dstSRS=system, width=columns, height=rows, dstNodata=HOLE,
                         outputBounds=(left, bottom, left + columns * spacing, bottom + rows * spacing),
                         resampleAlg="bilinear" if spacing < 2.0 * own else "average", outputType=gdal.GDT_Float64,
                         multithread=False, overviewLevel="NONE", options=["-novshift"])
        band = grid.GetRasterBand(1)
        heights = band.ReadAsArray()
        holes = 100.0 * np.mean(~(np.abs(heights) < 1e8))
        if holes == 100.0:
            raise Error(f"holds no heights from {LOWEST:,g} to {HIGHEST:,g} m at the airport")
        if holes:
            gdal.FillNodata(band, None, 20, 0)
            heights = _feathered(band.ReadAsArray(), spacing, known["feather"])
    heights = heights[::-1]
    here = height_at(heights, (west, south), spacing, (0.0, 0.0))
    words = (f"heights: {file.name}, {heights.min():.1f} to {heights.max():.1f} m, taken every {spacing:.3g} m"
             + (f" (the file has heights every {own:.3g} m)" if spacing > 1.01 * own else ""))
    if unit and metres_of(unit) != 1.0:
        words += f", in {unit} by the file"
    if holes > 0.0:
        words += (f"; {holes:.2g} % of the places have no height in the file: holes are filled from their "
                  "surroundings, and beyond the raster's border the ground is level. "
                  f"The raster fades into level ground over {known['feather']:g} m (assumed)")
    if holes > 5.0:
        warnings.warn(f"{file}: has no heights at {holes:.2g} % of the places of the scene; "
                      "the ground is level at these places", RuntimeWarning, stacklevel=2)
    return heights, spacing, here, words


def _feathered(heights: np.ndarray, spacing: float, width: float) -> np.ndarray:
    """Heights that fade within `width` (m) into level ground where heights are missing, at the mean of the border."""
    from scipy.ndimage import distance_transform_edt
    missing = ~(np.abs(heights) < 1e8)
    if not missing.any():
        return heights
    away = distance_transform_edt(~missing) * spacing
    level = heights[(away > 0.0) & (away < 1.5 * spacing)].mean()
    share = np.clip(away / max(width, spacing), 0.0, 1.0)
    return level + np.where(missing, 0.0, share * share * (3.0 - 2.0 * share) * (heights - level))


def height_at(values: np.ndarray, corner: Sequence[float], spacing: float, place: Sequence[float]) -> float:
    """The height at a place, interpolated between four posts."""
    from scipy.ndimage import map_coordinates
    at = [[(place[i] - corner[i]) / spacing] for i in (1, 0)]
    return float(map_coordinates(values, at, order=1, mode="nearest")[0])


def curvature(origin: Sequence[float], x, y):
    """How far the ellipsoid lies below the origin's tangent plane, m, to the second order; the error is 5 um at 5 km
    and 8 mm at 50 km. @param origin latitude (deg), ... @param x, y east and north, m"""
    a, f = 6378137.0, 1.0 / 298.257223563
    bulge = 1.0 - f * (2.0 - f) * math.sin(math.radians(origin[0])) ** 2
    across = a / math.sqrt(bulge)
    along = a * (1.0 - f * (2.0 - f)) / bulge ** 1.5
    return 0.5 * (x * x / across + y * y / along)


def terrain(heights: np.ndarray, corner: Sequence[float], spacing: float, origin: Sequence[float], error: float):
    """Triangles (vtkPolyData, m east, north and up of the origin) within `error` (m) of the posts: a Delaunay
    triangulation of the corners, to which the worst post of each triangle is added repeatedly. Rough ground takes all
    posts. VTK's vtkGreedyTerrainDecimation exceeds its error limit: on waves of 20 m the error was 34 m in place of
    0.25 m (VTK 9.1). @param heights above the origin's height, m, rows from south to north"""
    from scipy.spatial import Delaunay
    rows, columns = heights.shape
    row, column = (index.ravel() for index in np.indices(heights.shape))
    x, y = corner[0] + spacing * column, corner[1] + spacing * row
    z = heights.ravel() - curvature(origin, x, y)
    posts = np.column_stack([column, row]).astype(float)
    chosen = np.isin(row, (0, rows - 1)) & np.isin(column, (0, columns - 1))
    while chosen.mean() < MOST_CHOSEN:
        numbers = np.flatnonzero(chosen)
        mesh = Delaunay(posts[numbers])
        found = mesh.find_simplex(posts, tol=1e-9)
        frame = mesh.transform[found]
        two = np.einsum("nij,nj->ni", frame[:, :2], posts - frame[:, 2])
        off = np.abs((np.column_stack([two, 1.0 - two.sum(axis=1)])
                      * z[numbers][mesh.simplices[found]]).sum(axis=1) - z)
        off[chosen] = 0.0
        order = np.lexsort((-off, found))
        worst = order[np.r_[True, np.diff(found[order]) != 0]]
        worst = worst[off[worst] > error]
        if not len(worst):
            return _surface(np.column_stack([x, y, z])[numbers], mesh.simplices)
        chosen[worst] = True
    cells = np.arange(rows * columns).reshape(heights.shape)
    a, b, c, d = (part.ravel() for part in (cells[:-1, :-1], cells[:-1, 1:], cells[1:, 1:], cells[1:, :-1]))
    return _surface(np.column_stack([x, y, z]), np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))
