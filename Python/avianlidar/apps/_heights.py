# SPDX-License-Identifier: BSD-3-Clause
"""Rasters of heights as their files have them: units, holes, and what is not heights.

GDAL's units and nodata are what a writer declared. Many declare none, or one while the holes have another value, so values that
no ground of the Earth has are holes, too.
"""
from __future__ import annotations

import math
import pathlib
import re
import warnings
from typing import List, Optional, Tuple

from .._pipeline import Error

DRIVERS = {"GTiff": "GeoTIFF", "AAIGrid": "ASCII grid", "SRTMHGT": "SRTM .hgt", "VRT": "GDAL .vrt"}
WHAT = f"heights, expected {', '.join(DRIVERS.values())}"
LOWEST, HIGHEST = -500.0, 9000.0  # m: the Dead Sea's shore lies at -430, Everest at 8,849
SENTINELS = (-32768.0, -32767.0, -9999.0)  # raw values that mean a hole, also where the unit makes them possible heights
HOLE = -1e9  # of the raster that is returned
FOOT, SURVEY_FOOT = 0.3048, 1200.0 / 3937.0  # m
METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "km": 1000.0, "ft": FOOT, "us ft": SURVEY_FOOT, "yd": 0.9144, "in": 0.0254,
          "fathom": 1.8288}
SPELLINGS = (  # of GDAL, EPSG, Esri and people, in lower case
    (r"(?:us |u s )(?:survey )?(?:foot|feet|ft)|us ?ft|(?:foot|feet|ft) ?us|survey (?:foot|feet)", "us ft"),
    (r"(?:international |intl )?(?:foot|feet|ft)", "ft"), (r"(?:international )?(?:yards?|yd)", "yd"), (r"inch|inches|in", "in"), (r"fathoms?", "fathom"),
    (r"([dcmk]?m)", ""), (r"(deci|centi|milli|kilo|)met(?:re|er)s?", ""))
PREFIXES = {"": "m", "deci": "dm", "centi": "cm", "milli": "mm", "kilo": "km"}


def metres_of(name: str) -> Optional[float]:
    """Metres of a unit; None where its name is not known."""
    plain = re.sub(r"[\s_.()-]+", " ", name).strip().lower()
    for pattern, unit in SPELLINGS:
        found = re.fullmatch(pattern, plain)
        if found:
            return METRES[unit or PREFIXES.get(found[1], found[1])]
    return None


def unit_of(data) -> Tuple[str, float, str]:
    """The unit of a raster's heights, and metres of it: that of its band or of its vertical system; "" and 1 where
    neither says one. The third is the likely unit then: that of the coordinates, where it is not the metre."""
    from osgeo import osr
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
        raise Error(f"its band says heights in {named!r}, and its vertical system in {vertical!r}, expected one unit")
    return named, metres, ""


def in_metres(file: pathlib.Path, data):
    """A raster's first band in metres with HOLE where it has no height: read block by block when it is asked for. @return it, and the
    unit that the file says"""
    from osgeo import gdal
    if not data.GetProjection():
        raise Error("does not say its coordinate reference system; an ASCII grid has it in a .prj file beside it")
    band = data.GetRasterBand(1)
    if band.DataType == gdal.GDT_Byte:
        raise Error(f"holds bytes in {data.RasterCount} {'bands' if data.RasterCount > 1 else 'band'}, as a picture or a hillshade does, expected heights "
                    "of 16 bits or more")
    unit, metres, likely = unit_of(data)
    if likely:
        warnings.warn(f"{file}: says no unit of its heights, and its coordinates are in {likely}: they are taken for metres, and are likely in {likely}, too; "
                      f"`gdal_edit.py -units '{likely}' {file.name}` says so", RuntimeWarning, stacklevel=4)
    scale, offset = metres * (band.GetScale() or 1.0), metres * (band.GetOffset() or 0.0)
    copy = gdal.Translate("", data, format="VRT", bandList=[1], outputType=gdal.GDT_Float64, noData=HOLE)
    text = re.sub(r"<(Scale|Offset|UnitType)>[^<]*</\1>", "", copy.GetMetadata("xml:VRT")[0])
    text = re.sub(r"<(/?)SimpleSource\b", r"<\1ComplexSource", text, count=2)  # of the band; its mask stays as it is
    none = band.GetNoDataValue()
    declared = "" if none is None else f"<NODATA>{none!r}</NODATA>"
    return gdal.Open(text.replace("</ComplexSource>", f"{declared}<LUT>{_table(scale, offset)}</LUT></ComplexSource>", 1)), unit


def _table(scale: float, offset: float) -> str:
    """Raw values and what they are, between which GDAL interpolates: metres within the limits, else HOLE."""
    low, high = sorted(((LOWEST - offset) / scale, (HIGHEST - offset) / scale))
    rows: List[Tuple[float, float]] = [(-1e300, HOLE), (math.nextafter(low, -math.inf), HOLE), (low, scale * low + offset)]
    for value in sorted(value for value in SENTINELS if low < value < high):
        before, after = math.nextafter(value, -math.inf), math.nextafter(value, math.inf)
        rows += [(before, scale * before + offset), (value, HOLE), (after, scale * after + offset)]
    rows += [(high, scale * high + offset), (math.nextafter(high, math.inf), HOLE), (1e300, HOLE)]
    return ",".join(f"{raw!r}:{height!r}" for raw, height in rows)
