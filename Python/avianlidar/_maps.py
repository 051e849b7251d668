# SPDX-License-Identifier: BSD-3-Clause
"""Plans of coverage, and maps as files: the command `avianlidar coverage`."""
from __future__ import annotations

import csv
import math
import os
import pathlib
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from ._coverage import Coverage, places_of
from ._files import save
from ._json import check_json, load_json
from ._pipeline import Error
from ._ranks import PART
from ._scene import Scene, load_scene
from ._sensor import Sensor
from .siting import Runway, read_runways, strips_and_approaches

QUANTITIES = {"detection_probability": "1", "track_probability": "1", "photoelectrons": "1",
              "minimum_effective_area": "m2", "status": ""}  # maps that are written, with their units
LIMITS = (0.1, 0.5, 0.9)  # of the detection probability, in GeoJSON
HEIGHTS = (15.0, 30.0, 60.0, 150.0)  # m
PLACES = 12000


def read_plan(file) -> Dict[str, Any]:
    """A plan of coverage (JSON, `coverage.schema.json`); `Error` names what is wrong. Files that it names are absolute."""
    path = pathlib.Path(file)
    plan = load_json(path)
    check_json(plan, "coverage.schema.json", str(file))

    def absolute(name: str) -> str:
        return str((path.parent / name).resolve())

    def sensor(name: str) -> str:
        return absolute(name) if name.endswith(".json") else name

    plan["scene"] = absolute(plan["scene"])
    plan["sensor"]["preset"] = sensor(str(plan["sensor"]["preset"]))
    plan["compare_with"] = [sensor(name) for name in plan.get("compare_with", ())]
    if "runways" in plan:
        plan["runways"] = absolute(plan["runways"])
    if "siting" in plan:
        if "runways" not in plan:
            raise Error(f"{file}: siting: needs runways")
        plan["siting"]["exclusions"] = [absolute(name) for name in plan["siting"].get("exclusions", ())]
        if "points" in plan["siting"]:
            plan["siting"]["points"] = absolute(plan["siting"]["points"])
    return plan


def coordinate_system(origin: Sequence[float]):
    """The scene's plane for GIS: the transverse Mercator projection about its origin on WGS84, which differs from east and
    north by a millimetre at 3 km. @param origin latitude, longitude (deg), height (m)"""
    from osgeo import osr
    osr.UseExceptions()
    system = osr.SpatialReference()
    system.ImportFromProj4(f"+proj=tmerc +lat_0={origin[0]:.12g} +lon_0={origin[1]:.12g} +k=1 +x_0=0 +y_0=0 +datum=WGS84 "
                           "+units=m +no_defs")
    return system


def write_geotiff(file, values: np.ndarray, corner: Sequence[float], spacing: Sequence[float], origin: Optional[Sequence[float]],
                  name: str, unit: str = "", categories: Sequence[str] = (), notes: Optional[Dict[str, str]] = None) -> None:
    """Write a map as a GeoTIFF.

    values      rows (from south to north) x columns; integers up to 255 become bytes, others single precision
    corner      x and y of the first value, m; the middle of its pixel
    spacing     between columns and rows, m
    origin      of the scene: latitude, longitude (deg), height (m); None: no coordinate system
    categories  names of the values 0, 1, ...
    """
    from osgeo import gdal
    gdal.UseExceptions()
    whole = np.issubdtype(values.dtype, np.integer)
    rows, columns = values.shape
    part = f"{file}{PART}"
    image = gdal.GetDriverByName("GTiff").Create(part, columns, rows, 1, gdal.GDT_Byte if whole else gdal.GDT_Float32,
                                                 ["COMPRESS=DEFLATE"])
    image.SetGeoTransform((corner[0] - spacing[0] / 2, spacing[0], 0.0, corner[1] + (rows - 0.5) * spacing[1], 0.0, -spacing[1]))
    if origin is not None:
        image.SetProjection(coordinate_system(origin).ExportToWkt())
    image.SetMetadata({key: str(value) for key, value in (notes or {}).items()})
    band = image.GetRasterBand(1)
    band.SetDescription(name)
    if unit:
        band.SetUnitType(unit)
    if categories:
        band.SetCategoryNames(list(categories))
    band.WriteRaster(0, 0, columns, rows, np.ascontiguousarray(values[::-1], dtype=np.uint8 if whole else np.float32).tobytes())
    del band, image  # written now
    for end in ("", ".aux.xml"):
        if os.path.exists(part + end):
            os.replace(part + end, f"{file}{end}")


def write_areas(file, geotiff, limits: Sequence[float] = LIMITS) -> None:
    """Write where a map's values lie between limits as GeoJSON: polygons of whole pixels, in longitude and latitude, with the
    numbers `from` and `to`. Below the first limit there is none. @param geotiff the map, in a coordinate system"""
    from osgeo import gdal, ogr
    gdal.UseExceptions()
    image = gdal.Open(str(geotiff))
    classes = gdal.GetDriverByName("MEM").CreateCopy("", image)
    classes.GetRasterBand(1).WriteArray(np.digitize(image.ReadAsArray(), limits))
    areas = gdal.GetDriverByName("Memory").Create("", 0, 0, 0, gdal.GDT_Unknown)
    layer = areas.CreateLayer("areas", image.GetSpatialRef(), ogr.wkbPolygon)
    for name, kind in (("class", ogr.OFTInteger), ("from", ogr.OFTReal), ("to", ogr.OFTReal)):
        layer.CreateField(ogr.FieldDefn(name, kind))
    gdal.Polygonize(classes.GetRasterBand(1), classes.GetRasterBand(1), layer, 0)  # masked: class 0 is not there
    for feature in layer:
        number = feature.GetField("class")
        feature.SetField("from", limits[number - 1])
        feature.SetField("to", limits[number] if number < len(limits) else 1.0)
        layer.SetFeature(feature)
    part = f"{file}{PART}"
    gdal.VectorTranslate(part, areas, format="GeoJSON", selectFields=["from", "to"], layerCreationOptions=["RFC7946=YES"])
    os.replace(part, file)


class Plan:
    """What a plan of coverage asks for.

    name           of the sensor          heights  of the maps, m
    scene, sensor  as loaded              runways  in the scene's coordinates
    coverage       for the maps           regions  Coverage of places in strips and approaches, None without runways
    """

    def __init__(self, plan: Dict[str, Any], threads: int = 0, scene: Optional[Scene] = None):
        self.plan = plan
        self.scene = scene or load_scene(plan["scene"])
        self.name = pathlib.Path(plan["sensor"]["preset"]).name.split(".lidarsensor")[0]
        settings = dict(plan["sensor"])
        settings.setdefault("position", self.scene.lidar_position or (0.0, 0.0, 0.0))
        self.sensor = Sensor(settings.pop("preset"), **settings)
        self.heights: List[float] = list(plan.get("heights", HEIGHTS))
        self.settings: Dict[str, Any] = {"number_of_threads": threads, **plan.get("coverage", {})}
        x, y, _ = self.sensor.position
        self.extent = plan.get("extent", (x - 1500.0, x + 1500.0, y - 1500.0, y + 1500.0))
        self.spacing = float(plan.get("spacing", 10.0))
        self.coverage = Coverage(self.scene, self.sensor, spacing=(self.spacing, self.spacing, 1.0), **self.settings)
        self.runways: List[Runway] = []
        self.regions: Optional[Coverage] = None
        if "runways" in plan:
            if self.scene.geodetic_origin is None:
                raise Error(f"{plan['scene']}: has no origin, expected latitude and longitude, as runways are given by them")
            self.runways = read_runways(plan["runways"], self.scene.geodetic_origin)
            points, members = strips_and_approaches(self.runways, plan.get("places", PLACES), plan.get("seed", 0))
            every: Dict[str, Any] = {"all_species": True, **self.settings}
            self.regions = Coverage(self.scene, self.sensor, places=places_of(points, members), **every)

    @classmethod
    def all_of(cls, plan: Dict[str, Any], threads: int = 0) -> List[Plan]:
        """The plan with its sensor, then with each that it compares with."""
        plans = [cls(plan, threads)]
        place = {name: value for name, value in plan["sensor"].items() if name in ("position", "orientation")}
        for preset in plan.get("compare_with", ()):
            plans.append(cls({**plan, "sensor": {"preset": preset, **place}}, threads, plans[0].scene))
        return plans

    def map_at(self, height: float) -> Coverage:
        """Coverage of the plan's extent at a height, m."""
        self.coverage.set(bounds=(*self.extent, height, height))
        return self.coverage

    @property
    def shares(self) -> List[Dict[str, Any]]:
        """Rows of shares: of strips and approaches if there are runways, else of the map that was made last."""
        return (self.regions or self.coverage).table

    @property
    def overall(self) -> Dict[str, Any]:
        """The row of shares of all places and heights, for the bird of the maps."""
        return next(row for row in reversed(self.shares)
                    if row["species"] == self.coverage.species and row["height_from"] == -math.inf)

    def notes(self) -> Dict[str, str]:
        """What maps were made for, in words."""
        fields = self.coverage.data.GetFieldData()
        area = fields.GetArray("effective_area").GetValue(0)
        species = self.coverage.species or "target"
        return {"sensor": self.name, "position_m": " ".join(f"{c:g}" for c in self.sensor.position),
                "target": f"{species}, effective area {area:.4f} m2 (assumed), reflectance {self.coverage.reflectance:g} (assumed)",
                "visibility_m": f"{self.coverage.visibility:g}",
                "limits": "calculated, not measured; receiver assumed unless it is the paper's"}

    def write(self, folder, progress=None) -> List[str]:
        """Write all files: a GeoTIFF for each height and quantity, shares.csv, clutter.vtp. @param progress called with the
        files done and their number @return their names"""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        names: List[str] = []
        origin = self.scene.geodetic_origin
        total = len(self.heights) * (len(QUANTITIES) + (origin is not None)) + 2

        def done(name: str) -> None:
            names.append(name)
            if progress:
                progress(len(names), total)

        for height in self.heights:
            cover = self.map_at(height)
            data = cover.data
            for quantity, unit in QUANTITIES.items():
                name = f"{quantity}_{height:g}m.tif"
                write_geotiff(folder / name, cover[quantity][0], data.GetOrigin()[:2], data.GetSpacing()[:2], origin,
                              f"{quantity} at {height:g} m", unit, cover.status_names if quantity == "status" else (),
                              {**self.notes(), "height_m": f"{height:g}"})
                done(name)
            if origin is not None:
                name = f"detection_probability_{height:g}m"
                write_areas(folder / f"{name}.geojson", folder / f"{name}.tif")
                done(f"{name}.geojson")
        save(self.coverage.clutter_map, folder / "clutter.vtp")
        done("clutter.vtp")
        write_table(folder / "shares.csv", self.shares)
        done("shares.csv")
        return names


def write_table(file, rows: Sequence[Dict[str, Any]]) -> None:
    """Write rows as CSV, units in the header."""
    units = {"height_from": "m", "height_to": "m"}
    part = f"{file}{PART}"
    with open(part, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        if rows:
            writer.writerow([f"{name} [{units[name]}]" if name in units else name for name in rows[0]])
        for row in rows:
            writer.writerow([f"{value:.6g}" if isinstance(value, float) else value for value in row.values()])
    os.replace(part, file)
