# SPDX-License-Identifier: BSD-3-Clause
"""Maps of coverage as files: the command `avianlidar coverage`."""
from __future__ import annotations

import itertools
import json
import pathlib
from typing import Any, Callable, Dict, Optional, Sequence

import numpy as np

from ..._disk import replacing, write_whole
from ..._files import save
from ..inputs._json import naming
from ..inputs._tables import write_table
from ._plan import Plan

QUANTITIES = {"detection_probability": "1", "track_probability": "1", "photoelectrons": "1",
              "minimum_effective_area": "m2", "status": ""}  # written maps with their units
LIMITS = (0.1, 0.5, 0.9)  # limits of the detection probability, in GeoJSON
IN_MEMORY = "/vsimem/avianlidar/"  # GDAL's folder in memory


def write_geotiff(file, values: np.ndarray, corner: Sequence[float], spacing: Sequence[float],
                  origin: Optional[Sequence[float]], name: str, unit: str = "", categories: Sequence[str] = (),
                  notes: Optional[Dict[str, str]] = None) -> None:
    """Writes a map as a GeoTIFF.

    values      rows (from south to north) x columns; integers up to 255 become bytes, others single precision
    corner      x and y of the first value, m, at the centre of its pixel
    spacing     distance between columns and between rows, m
    origin      of the scene: latitude, longitude (deg), height (m); None: no coordinate system
    categories  names of the values 0, 1, ...
    """
    from ..places._gdal import coordinate_system, gdal
    is_whole = np.issubdtype(values.dtype, np.integer)
    pixels = values[::-1].astype(np.uint8 if is_whole else np.float32)
    rows, columns = pixels.shape
    image = gdal.GetDriverByName("GTiff").Create(
        IN_MEMORY + "map.tif", columns, rows, 1, gdal.GDT_Byte if is_whole else gdal.GDT_Float32, ["COMPRESS=DEFLATE"])
    north_west = corner[0] - spacing[0] / 2, corner[1] + (rows - 0.5) * spacing[1]
    image.SetGeoTransform((north_west[0], spacing[0], 0.0, north_west[1], 0.0, -spacing[1]))
    if origin is not None:
        image.SetProjection(coordinate_system(origin).ExportToWkt())
    image.SetMetadata({key: str(value) for key, value in (notes or {}).items()})
    band = image.GetRasterBand(1)
    band.SetDescription(name)
    if unit:
        band.SetUnitType(unit)
    if np.isinf(values).any():
        band.SetNoDataValue(float("inf"))
    if categories:
        band.SetCategoryNames(list(categories))
    band.WriteArray(pixels)
    del band, image  # closes and writes the image
    with naming(f"{file}: GDAL has not written the whole map"):
        if not np.array_equal(gdal.Open(IN_MEMORY + "map.tif").ReadAsArray(), pixels, equal_nan=True):
            raise ValueError("the file holds other values")
        content, beside = _taken("map.tif"), _taken("map.tif.aux.xml")
    names = pathlib.Path(f"{file}.aux.xml")
    if beside:
        with replacing(names) as part:
            pathlib.Path(part).write_bytes(beside)
            write_whole(file, content)
    else:
        write_whole(file, content)
        names.unlink(missing_ok=True)  # statistics of an older map


def _taken(name: str) -> bytes:
    """The bytes that GDAL has written to a file in memory, which is freed; empty without such a file. GDAL does not
    write to the disk itself, because GDAL does not report a full disk."""
    from ..places._gdal import gdal
    name = IN_MEMORY + name
    found = gdal.VSIStatL(name)
    if found is None:
        return b""
    stream = gdal.VSIFOpenL(name, "rb")
    content = bytes(gdal.VSIFReadL(1, found.size, stream) or b"")
    gdal.VSIFCloseL(stream)
    gdal.Unlink(name)
    if len(content) != found.size:
        raise ValueError(f"{len(content)} of {found.size} bytes can be read")
    return content


def write_areas(file, geotiff, description: str) -> None:
    """Writes the areas where a map's probabilities lie between LIMITS as GeoJSON: polygons of whole pixels, in
    longitude and latitude, with the numbers `probability_from` and `probability_to`. Areas below the first limit are
    left out.

    geotiff      the map, which needs a coordinate system
    description  description in the file
    """
    from ..places._gdal import gdal, ogr
    image = gdal.Open(str(geotiff))
    classes = gdal.GetDriverByName("MEM").CreateCopy("", image)
    band = classes.GetRasterBand(1)
    band.WriteArray(np.digitize(image.ReadAsArray(), LIMITS))
    areas = gdal.GetDriverByName("Memory").Create("", 0, 0, 0, gdal.GDT_Unknown)
    layer = areas.CreateLayer("areas", image.GetSpatialRef(), ogr.wkbPolygon)
    bounds = ("probability_from", "probability_to")
    for name, kind in (("class", ogr.OFTInteger), *((name, ogr.OFTReal) for name in bounds)):
        layer.CreateField(ogr.FieldDefn(name, kind))
    gdal.Polygonize(band, band, layer, 0)  # masked: class 0 is left out
    for feature in layer:
        number = feature.GetField("class")
        for name, value in zip(bounds, (*LIMITS, 1.0)[number - 1:number + 1]):
            feature.SetField(name, value)
        layer.SetFeature(feature)
    gdal.VectorTranslate(IN_MEMORY + "areas.geojson", areas, format="GeoJSON", selectFields=list(bounds),
                         layerCreationOptions=["RFC7946=YES", f"DESCRIPTION={description}"])
    with naming(f"{file}: GDAL has not written all areas"):
        content = _taken("areas.geojson")
        count, wanted = len(json.loads(content)["features"]), layer.GetFeatureCount()
        if count != wanted:
            raise ValueError(f"the file holds {count} of {wanted} areas")
    write_whole(file, content)


def height_name(height: float) -> str:
    """The height in names of files: as short as possible, and different for each height."""
    short = f"{height:g}"
    return f"{short if float(short) == height else repr(float(height))}m"


def notes_of(plan: Plan) -> Dict[str, str]:
    """The settings for which maps were made, in words."""
    cover, area = plan.coverage, plan.regions.data.GetFieldData().GetArray("effective_area").GetValue(0)
    size = (f", effective area {area:.4f} m2 (assumed)" if len(plan.mix) == 1 else
            ", effective areas assumed; reasons are for the first species")
    visibility = (f"{cover.visibility:g} (assumed)" if cover.visibility > 0.0 else
                  f"none, attenuation {cover.attenuation_coefficient:.3g}/m")
    return {"sensor": plan.name, "position_m": " ".join(f"{c:g}" for c in plan.sensor.position),
            "target": f"{plan.bird}{size}, reflectance {cover.reflectance:g} (assumed)", "visibility_m": visibility,
            "rain_mm_h": f"{cover.rain_rate:g}",
            "air": "sends light back" if cover.air_backscatter or cover.rain_rate else "only weakens",
            "assumed_of_the_sensor": ", ".join(plan.assumed) or "none", "limits": "calculated, not measured"}


def _write_each(plan: Plan, folder: pathlib.Path, step: Callable[[], Any]) -> None:
    """Writes the files of a plan. @param step called after each file"""
    origin = plan.scene.geodetic_origin
    for height in plan.heights:
        cover, at, notes = plan.map_at(height), height_name(height), {**notes_of(plan), "height_m": f"{height:g}"}
        place = cover.data.GetOrigin()[:2], cover.data.GetSpacing()[:2], origin
        for quantity, unit in QUANTITIES.items():
            values = plan.mixed(cover, quantity) if quantity.endswith("_probability") else cover[quantity]
            write_geotiff(folder / f"{quantity}_{at}.tif", values[0], *place, f"{quantity} at {height:g} m", unit,
                          cover.status_names if quantity == "status" else (), notes)
            step()
        if origin is not None:
            file = folder / f"detection_probability_{at}"
            write_areas(f"{file}.geojson", f"{file}.tif", "; ".join(map(": ".join, notes.items())))
            step()
    save(plan.coverage.clutter_map, folder / "clutter.vtp")
    step()
    for name, rows in (("shares.csv", plan.shares), ("ends.csv", plan.by_end)):
        write_table(folder / name, rows)
        step()


def write_maps(plan: Plan, folder, progress: Callable[[int, int], Any] = lambda *_: None) -> int:
    """Writes a GeoTIFF for each height and quantity, GeoJSON if the scene has an origin, shares.csv, ends.csv,
    clutter.vtp. @param progress called with the number of finished files and the number of all files @return the number
    of all files"""
    total = len(plan.heights) * (len(QUANTITIES) + (plan.scene.geodetic_origin is not None)) + 3
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    done = itertools.count(1)
    _write_each(plan, pathlib.Path(folder), lambda: progress(next(done), total))
    return total
