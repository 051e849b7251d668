# SPDX-License-Identifier: BSD-3-Clause
"""Plans of coverage, and maps as files: the command `avianlidar coverage`."""
from __future__ import annotations

import functools
import json
import math
import pathlib
import warnings
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from .. import vtkAvianLidar as _wrapped
from .._coverage import Coverage, places_of
from .._disk import replacing, write_whole
from .._files import checked_name, save
from .._pipeline import Error, update
from .._properties import in_snake_case
from .._ranks import digest_of, digest_of_arrays
from .._scene import Scene, load_scene
from .._sensor import Sensor
from .._weather import AIR, in_weather, weather, without_air
from .._writers import as_csv
from . import _metar
from ._air import Air, weakening
from ._json import check_json, load_json, naming
from ._scores import weighted
from .siting import Runway, by_kind, ground_of, places_by_region, read_runways, region_heights, region_names, require_memory

QUANTITIES = {"detection_probability": "1", "track_probability": "1", "photoelectrons": "1",
              "minimum_effective_area": "m2", "status": ""}  # maps that are written, with their units
LIMITS = (0.1, 0.5, 0.9)  # of the detection probability, in GeoJSON
HEIGHTS = (15.0, 30.0, 60.0, 150.0)  # m
PLACES = 12000
AROUND_SENSOR = 1500.0  # m, that maps hold to each side
AROUND_ENDS = 300.0  # m, of runways
STEP_OF_EXTENT = 100.0  # m
FLAT = 0.5  # m: z of a ground that counts as 0
IN_MEMORY = "/vsimem/avianlidar/"  # GDAL's
MOST_PIXELS = 100_000_000  # of a map
BYTES_OF_PLACE = 200  # of a place that is drawn, and of what is found there
SUM = 1e-6  # to which the shares of a year are 1


def read_plan(file, words: Optional[Sequence[str]] = None, metar=None, **changes: Dict[str, Any]) -> Dict[str, Any]:
    """A plan of coverage (JSON, `coverage.schema.json`), with its own name as `file` and what was changed as `options`; `Error` names what
    is wrong. Files that it names are absolute.

    words    of weather, in place of the plan's, its year and what its `coverage` says of the air
    metar    file of reports, in place of the plan's year
    changes  parts of the plan, such as `sensor`, each with what else it shall hold
    """
    path = pathlib.Path(file)
    plan = load_json(path)
    if isinstance(plan, dict):
        plan = {name: part for name, part in plan.items() if not (words or metar) or name not in ("year", "metar")}
        if words:
            plan["weather"] = list(words)
            if isinstance(plan.get("coverage"), dict):
                plan["coverage"] = without_air(plan["coverage"])
        if metar:
            plan["metar"] = str(pathlib.Path(metar).resolve())
        for part, values in changes.items():
            if values and isinstance(plan.get(part, {}), dict):
                plan[part] = {**plan.get(part, {}), **{name: list(value) if isinstance(value, (tuple, list)) else
                                                       [value] if name in ("masts", "exclusions") else value for name, value in values.items()}}
    check_json(plan, "coverage.schema.json", str(file))

    def from_here(name: Any) -> Any:
        return str((path.parent / name).resolve()) if isinstance(name, str) else [*map(from_here, name)]

    def sensor(given: Union[str, Dict[str, Any]], what: str) -> Dict[str, Any]:
        with naming(f"{file}: {what}"):
            given = {"preset": given} if isinstance(given, str) else given
            known = in_snake_case(_wrapped.vtkAvianLidarBeamSource, given, "Sensor")
            if known["preset"].endswith(".json"):
                known["preset"] = from_here(known["preset"])
        sensor_name(known, f"{file}: {what}")
        return known

    with naming(f"{file}: coverage"):
        if "coverage" in plan:
            plan["coverage"] = in_snake_case(_wrapped.vtkAvianLidarCoverage, plan["coverage"], "Coverage")
    plan["sensor"] = sensor(plan["sensor"], "sensor")
    plan["compare_with"] = [sensor(other, f"compare_with[{i}]") for i, other in enumerate(plan.get("compare_with", ()))]
    if "siting" in plan:
        if "runways" not in plan:
            raise Error(f"{file}: siting: needs runways")
        plan["siting"].setdefault("exclusions", [])
    for member in ("scene", "runways", "metar", "tracks", "design.scenario", "siting.exclusions", "siting.points"):
        of, _, name = member.rpartition(".")
        holder = plan.get(of, {}) if of else plan
        if name in holder:
            with naming(f"{file}: {member}"):
                holder[name] = from_here(holder[name])
    _check_question(plan, str(file))
    if "metar" in plan:
        with naming(f"{file}: metar"):
            hours = _metar.read_metar(plan["metar"])
            plan.update(year=hours.year(), hours=hours.words())
    options = [[f"--{part}-set", f"{name}={_as_option(value)}"] for part, values in changes.items() for name, value in (values or {}).items()]
    plan.update(file=str(file), options=[["--weather", *(words or ())]] * bool(words) + [["--metar", str(metar)]] * bool(metar) + options)
    return plan


def _as_option(value: Any) -> str:
    """A value as commands take it."""
    if isinstance(value, (list, tuple)):
        return ",".join(map(_as_option, value))
    return ("off", "on")[value] if isinstance(value, bool) else str(value)


def _check_question(plan: Dict[str, Any], file: str) -> None:
    """`Error` where parts of a plan ask for different birds or places."""
    for old, new in (("mix", "mix"), ("shares", "regions")):
        if old in plan.get("siting", {}):
            raise Error(f"{file}: siting.{old}: expected {new!r} of the plan instead, beside {'siting'!r}: it counts for maps, shares and sites")
    if "regions" in plan and "runways" not in plan:
        raise Error(f"{file}: regions: needs runways")
    with naming(f"{file}: weather"):
        in_weather(plan.get("coverage", {}), plan.get("weather"))
    for number, part in enumerate(plan.get("year", ())):
        with naming(f"{file}: year[{number}].weather"):
            weather(part["weather"])
    if "year" in plan and "metar" in plan:
        raise Error(f"{file}: metar: is there beside 'year', expected one of both to say which weather there is")
    total = sum(part["share"] for part in plan.get("year", ()))
    if "year" in plan and not abs(total - 1.0) <= SUM:
        raise Error(f"{file}: year: shares sum to {total:g}, expected 1")
    if "species" in plan.get("coverage", {}) and "mix" in plan:
        raise Error(f"{file}: coverage.species: is there beside 'mix', expected one of both to say which birds are asked for")


def coordinate_system(origin: Sequence[float]):
    """The scene's plane for GIS: the transverse Mercator projection about its origin on WGS84, scaled to the origin's height. It
    differs from east and north by some millimetres at 3 km. @param origin latitude, longitude (deg), height (m)"""
    from osgeo import osr
    osr.UseExceptions()
    system = osr.SpatialReference()
    # Metres at a height are longer than on the ellipsoid: by the mean radius of curvature there.
    flattening = 1.0 / osr.SRS_WGS84_INVFLATTENING
    bulge = 1.0 - flattening * (2.0 - flattening) * math.sin(math.radians(origin[0])) ** 2
    radius = osr.SRS_WGS84_SEMIMAJOR * (1.0 - flattening) / bulge
    system.ImportFromProj4(f"+proj=tmerc +lat_0={origin[0]:.12g} +lon_0={origin[1]:.12g} +k={1.0 + origin[2] / radius:.12g} "
                           "+x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs")
    system.SetProjCS("metres east and north of the scene's origin")
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
    kind, code = (np.uint8, gdal.GDT_Byte) if np.issubdtype(values.dtype, np.integer) else (np.float32, gdal.GDT_Float32)
    pixels = values[::-1].astype(kind)
    rows, columns = pixels.shape
    image = gdal.GetDriverByName("GTiff").Create(IN_MEMORY + "map.tif", columns, rows, 1, code, ["COMPRESS=DEFLATE"])
    image.SetGeoTransform((corner[0] - spacing[0] / 2, spacing[0], 0.0, corner[1] + (rows - 0.5) * spacing[1], 0.0, -spacing[1]))
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
    del band, image  # written now
    with naming(f"{file}: GDAL has not written the whole map"):
        if not np.array_equal(gdal.Open(IN_MEMORY + "map.tif").ReadAsArray(), pixels, equal_nan=True):
            raise ValueError("it holds other values")
        content, beside = _taken("map.tif"), _taken("map.tif.aux.xml")
    names = pathlib.Path(f"{file}.aux.xml")
    if beside:
        with replacing(names) as part:
            pathlib.Path(part).write_bytes(beside)
            write_whole(file, content)
    else:
        write_whole(file, content)
        names.unlink(missing_ok=True)  # with statistics of the map that was there


def _taken(name: str) -> bytes:
    """What GDAL has written in memory, which it frees; nothing if there is no such file. It writes no file of a disk: where that is
    full, it says so where nobody hears it."""
    from osgeo import gdal
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


def write_areas(file, geotiff, description: str, limits: Sequence[float] = LIMITS) -> None:
    """Write where a map's probabilities lie between limits as GeoJSON: polygons of whole pixels, in longitude and latitude, with
    the numbers `probability_from` and `probability_to`. Below the first limit there is none.

    geotiff      the map, in a coordinate system
    description  of the file, in words
    """
    from osgeo import gdal, ogr
    gdal.UseExceptions()
    image = gdal.Open(str(geotiff))
    classes = gdal.GetDriverByName("MEM").CreateCopy("", image)
    classes.GetRasterBand(1).WriteArray(np.digitize(image.ReadAsArray(), limits))
    areas = gdal.GetDriverByName("Memory").Create("", 0, 0, 0, gdal.GDT_Unknown)
    layer = areas.CreateLayer("areas", image.GetSpatialRef(), ogr.wkbPolygon)
    bounds = ("probability_from", "probability_to")
    for name, kind in (("class", ogr.OFTInteger), *((name, ogr.OFTReal) for name in bounds)):
        layer.CreateField(ogr.FieldDefn(name, kind))
    gdal.Polygonize(classes.GetRasterBand(1), classes.GetRasterBand(1), layer, 0)  # masked: class 0 is not there
    for feature in layer:
        number = feature.GetField("class")
        for name, value in zip(bounds, (limits[number - 1], limits[number] if number < len(limits) else 1.0)):
            feature.SetField(name, value)
        layer.SetFeature(feature)
    gdal.VectorTranslate(IN_MEMORY + "areas.geojson", areas, format="GeoJSON", selectFields=list(bounds),
                         layerCreationOptions=["RFC7946=YES", f"DESCRIPTION={description}"])
    with naming(f"{file}: GDAL has not written all areas"):
        content = _taken("areas.geojson")
        count, wanted = len(json.loads(content)["features"]), layer.GetFeatureCount()
        if count != wanted:
            raise ValueError(f"{count} of {wanted} are there")
    write_whole(file, content)


class Plan:
    """What a plan of coverage asks for.

    name           of the sensor          heights  of the maps, m
    scene, sensor  as loaded              runways  in the scene's coordinates
    coverage       for the maps           regions  Coverage of places drawn in strips and approaches; without runways on the maps
    members        numbers of the places by strips and approaches     ends  and by each strip and the approach to each runway's end
    mix            share of each species, the sum 1; maps of reasons are of the first, the greatest
    air            words of the plan's weather
    year           weathers by which sites are ranked, with their shares of the hours; empty where the plan gives none
    asked          least and greatest height of the places, m, None where the plan has no `heights`: then each region's own
    ground         z of the ground below the sensor, m, None where there is none
    """

    def __init__(self, plan: Dict[str, Any], threads: int = 0, scene: Optional[Scene] = None, member: str = "sensor"):
        """All that the plan says is checked. `Error` names the plan's file and the member. @param member of the sensor"""
        self.plan, self.file, self.threads = plan, str(plan.get("file", "plan")), threads
        with naming(f"{self.file}: scene"):
            self.scene = scene or load_scene(plan["scene"])
            update(self.scene.tree)
        self.name = self.title = sensor_name(plan["sensor"])
        settings = {name: value for name, value in plan["sensor"].items() if name != "name"}
        settings.setdefault("position", self.scene.lidar_position or (0.0, 0.0, 0.0))
        with naming(f"{self.file}: {member}"):
            self.sensor = Sensor(settings.pop("preset"), **settings)
            update(self.sensor.algorithm)
        self.heights: List[float] = list(plan.get("heights", HEIGHTS))
        self.asked = (min(self.heights), max(self.heights)) if "heights" in plan else None
        self.air = tuple(plan.get("weather", ()))
        self.settings: Dict[str, Any] = {"number_of_threads": threads, **in_weather(plan.get("coverage", {}), self.air)}
        if self.air:
            self.settings.update(self.air_of(**{name: self.settings[name] for name in AIR if name in self.settings}))
        self.year = [Air(tuple(part["weather"]), float(part["share"]), self.air_of(part["weather"])) for part in plan.get("year", ())
                     if part["share"] > 0.0]
        if self.asked and self.asked[0] < self.asked[1]:
            self.settings.setdefault("height_limits", sorted(self.heights))
        if member == "sensor":  # else they are those of the plan before
            self._try("coverage")
            for air in self.year:
                self._try(f"year: {air.name}", **air.settings)
            for name in plan.get("mix", ()):
                self._try("mix", species=name)
        self.mix = self._mix()
        self.settings["species"] = next(iter(self.mix))
        with naming(f"{self.file}: runways"):
            self.runways = self._runways() if "runways" in plan else []
        self.extent = tuple(plan.get("extent") or self._extent())
        self.spacing = float(plan.get("spacing", 10.0))
        self._check_maps()
        self.coverage = Coverage(self.scene, self.sensor, spacing=(self.spacing, self.spacing, 1.0), **self.settings)
        self.spread = plan.get("spread", "distance")
        self.count, self.seed = int(plan.get("places", PLACES)), int(plan.get("seed", 0))
        with naming(f"{self.file}: {'regions' if 'regions' in plan else 'places'}"):
            self.points, self.ends = self._drawn(self.seed)
        self.members = by_kind(self.ends) if self.runways else self.ends
        every: Dict[str, Any] = {"all_species": True, **self.settings}
        self.regions = Coverage(self.scene, self.sensor, places=places_of(self.points, self.members), **every)
        x, y, _ = self.sensor.position
        ground = ground_of(self.scene, [(x, y)])[0]
        self.ground = None if np.isnan(ground) else float(ground)

    def _try(self, member: str, **changes: Any) -> None:
        """`Error` where coverage refuses settings, at one place of an empty scene."""
        with naming(f"{self.file}: {member}"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # they come with the work
            Coverage(Scene(), self.sensor, places=[(0.0, 0.0, 0.0)], **{**self.settings, **changes}).update()

    def air_of(self, words: Sequence[str] = (), **air: Any) -> Dict[str, Any]:
        """Settings of coverage in a weather: where it says nothing of the visibility, the plan's own; without rain, dry.

        words  as of `--weather`
        air    settings instead of words, such as rain_rate=0 (mm/h)
        """
        default, given = _wrapped.vtkAvianLidarCoverage(), self.plan.get("coverage", {})
        all_of_it = {"attenuation_coefficient": given.get("attenuation_coefficient", default.GetAttenuationCoefficient()),
                     "visibility": given.get("visibility", default.GetVisibility()),
                     "air_backscatter": given.get("air_backscatter", False), "rain_rate": 0.0, **weather(words), **air}
        return all_of_it if self.gathers_light else weakening(self.sensor, all_of_it)

    @property
    def gathers_light(self) -> bool:
        """Whether the receiver has an aperture, into which air may send light back."""
        return float(self.sensor.beams.fields.get("receiver_aperture", 0.0)) > 0.0

    def _mix(self) -> Dict[str, float]:
        mix = self.plan.get("mix") or {Coverage(Scene(), self.sensor, **self.settings).species: 1.0}
        total = float(sum(mix.values()))
        if not 0.0 < total < math.inf:
            raise Error(f"{self.file}: mix: is {mix}, expected numbers from 0 with a sum above 0")
        return {name: share / total for name, share in sorted(mix.items(), key=lambda item: -item[1]) if share > 0.0}

    def _extent(self) -> Tuple[float, float, float, float]:
        """What maps hold: surroundings of the sensor and of the runways' ends."""
        x, y, _ = self.sensor.position
        ends = np.array([end for runway in self.runways for end in (runway.start, runway.end)]).reshape(-1, 2)
        low = np.min([(x - AROUND_SENSOR, y - AROUND_SENSOR), *(ends - AROUND_ENDS)], axis=0)
        high = np.max([(x + AROUND_SENSOR, y + AROUND_SENSOR), *(ends + AROUND_ENDS)], axis=0)
        if len(ends):
            low, high = STEP_OF_EXTENT * np.floor(low / STEP_OF_EXTENT), STEP_OF_EXTENT * np.ceil(high / STEP_OF_EXTENT)
        return low[0], high[0], low[1], high[1]

    def at(self, position: Sequence[float], title: str, seed: Optional[int] = None, **changes: Any) -> Plan:
        """The same with the sensor elsewhere, on the same maps. @param position m @param title of pictures and tables @param seed
        of the places, default the same @param changes properties of the sensor"""
        sensor = {**self.plan["sensor"], "name": self.name, **changes, "position": [float(c) for c in position]}
        other = Plan({**self.plan, "extent": self.extent, "seed": self.seed if seed is None else seed, "sensor": sensor}, self.threads, self.scene, "siting")
        other.title = title
        return other

    def _check_maps(self) -> None:
        x0, x1, y0, y1 = self.extent
        if not (x0 <= x1 and y0 <= y1):
            raise Error(f"{self.file}: extent: is {list(self.extent)}, expected least and greatest x, least and greatest y")
        pixels = ((x1 - x0) / self.spacing + 1.0) * ((y1 - y0) / self.spacing + 1.0)
        if not pixels <= MOST_PIXELS:
            raise Error(f"{self.file}: spacing: is {self.spacing:g} m, which makes maps of {pixels:.3g} pixels, expected at most "
                        f"{MOST_PIXELS:,}: take a larger spacing or a smaller extent")

    def _runways(self) -> List[Runway]:
        if self.scene.geodetic_origin is None:
            raise Error(f"{self.plan['scene']}: has no origin, expected latitude and longitude, as runways are given by them")
        return read_runways(self.plan["runways"], self.scene.geodetic_origin)

    def decides(self) -> Any:
        """All that decides what is found: the plan but for its own name, surfaces, beams and places."""
        update(self.scene.tree)
        return ({name: part for name, part in self.plan.items() if name != "file"}, digest_of(self.scene.tree.GetOutput()),
                digest_of_arrays(self.sensor.beams.data), self.points.tobytes())

    def places(self, seed: int) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
        """Where shares are of: n x 3, m, and the regions."""
        points, ends = self._drawn(seed)
        return points, by_kind(ends) if self.runways else ends

    def _drawn(self, seed: int) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
        """Where shares are of: n x 3, m, and the numbers of those in each strip and the approach to each end."""
        require_memory(BYTES_OF_PLACE * self.count, f"{self.count:,} places", "take fewer")
        if self.runways:
            return places_by_region(self.runways, self.count, seed, self.plan.get("regions"), self.asked, self.spread)
        low, high = np.transpose([self.extent[:2], self.extent[2:], (min(self.heights), max(self.heights))])
        return np.random.default_rng(seed).uniform(low, high, (self.count, 3)), {"map": np.arange(self.count)}

    def weights(self, points: np.ndarray) -> np.ndarray:
        """What each place (n x 3) counts for each species: species x places, the sum 1. As in the table."""
        density = Coverage.strike_height_density(points[:, 2]) if self.regions.strike_height_weights else np.ones(len(points))
        return np.outer(list(self.mix.values()), density / density.sum())

    @classmethod
    def all_of(cls, plan: Dict[str, Any], threads: int = 0) -> List[Plan]:
        """The plan with its sensor, then with each that it compares with."""
        plans = [cls(plan, threads)]
        place = {name: value for name, value in plan["sensor"].items() if name in ("position", "orientation")}
        for number, other in enumerate(plan.get("compare_with", ())):
            member = f"compare_with[{number}]"
            plans.append(cls({**plan, "sensor": {**place, **other}}, threads, plans[0].scene, member))
            if plans[-1].name in [before.name for before in plans[:-1]]:
                raise Error(f"{plans[0].file}: {member}: {plans[-1].name!r} is there twice, expected a `name` that differs")
        return plans

    @property
    def spread_words(self) -> str:
        """How places are spread over strips and approaches."""
        return {"distance": "as many on each metre along strips and approaches, as aircraft fly each once",
                "area": "as many on each square metre of strips and approaches"}[self.spread]

    @property
    def where(self) -> str:
        """Of which places the shares are."""
        low, high = min(self.heights), max(self.heights)
        heights = f"{low:g} to {high:g} m" if high > low else f"at {low:g} m"
        if not self.runways:
            return f"on the map, {heights}" if high > low else f"on the map {heights}"
        there = {kind: kind if set(names) <= self.ends.keys() else ", ".join(name for name in names if name in self.ends)
                 for kind, names in region_names(self.runways).items() if kind in self.members}
        if self.asked:
            return f"in {' and '.join(there.values())}, {heights + ' high' if high > low else heights}"
        return "in " + " and ".join(f"{words} (to {self.heights_of(kind)[1]:.3g} m high)" for kind, words in there.items())

    def heights_of(self, region: str) -> Tuple[float, float]:
        """Least and greatest height of the places of a region, m; of all for any other name."""
        names = [region] if region in self.members else list(self.members)
        limits = [region_heights(name, self.asked) if self.runways else (min(self.heights), max(self.heights)) for name in names]
        return min(low for low, _ in limits), max(high for _, high in limits)

    @property
    def bird(self) -> str:
        """Whom the plan asks for, in words."""
        if len(self.mix) == 1:
            return next(iter(self.mix)) or "target"
        return "bird (" + ", ".join(f"{name or 'target'} {100 * share:.3g} %" for name, share in self.mix.items()) + ")"

    @property
    def above(self) -> str:
        """What heights are above."""
        return "ground" if self.ground is not None and abs(self.ground) < FLAT else "the scene's origin"

    @property
    def assumed(self) -> Tuple[str, ...]:
        """Properties of the sensor whose numbers are assumed: by its file, or as the plan sets them."""
        changed = [name for name in self.plan["sensor"] if name not in ("preset", "name", "position", "orientation")]
        return (*self.sensor.beams.fields.get("assumed", ()), *changed)

    def map_at(self, height: float) -> Coverage:
        """Coverage of the plan's extent at a height, m, of the first species."""
        self.coverage.set(bounds=(*self.extent, height, height), species=next(iter(self.mix)))
        return self.coverage

    def mixed(self, cover: Coverage, name: str = "detection_probability") -> np.ndarray:
        """The mean of an array over the species asked for. It leaves the first one."""
        total: Any = 0.0
        for species, share in reversed(self.mix.items()):
            cover.species = species
            total = total + share * cover[name]
        return total

    @functools.cached_property
    def shares(self) -> List[Dict[str, Any]]:
        """Rows of shares of the regions: those of each species, then those of the mix. Its standard errors are the most that those
        of the species allow."""
        rows = self.regions.table
        return rows + self._of_mix([[row for row in rows if row["species"] == species] for species in self.mix]) * (len(self.mix) > 1)

    def _of_mix(self, of_species: Sequence[List[Dict[str, Any]]]) -> List[Dict[str, Any]]:
        """Rows of the mix. @param of_species rows of each species"""
        if len(self.mix) == 1:
            return of_species[0]
        mixed = []
        for same in zip(*of_species):
            means = {name: sum(share * row[name] for share, row in zip(self.mix.values(), same)) for name, value in same[0].items()
                     if isinstance(value, float) and not name.startswith("height_")}
            mixed.append({**same[0], **means, "species": self.bird})
        return mixed

    def in_airs(self, airs: Sequence[Dict[str, Any]]) -> List[List[Dict[str, Any]]]:
        """For each air the rows of shares of all heights, for the birds asked for: each region, and last all. No line of sight is
        traced again. @param airs settings of coverage, as of `air_of`"""
        regions, found = self.regions, []
        own = {name: getattr(regions, name) for name in ("all_species", "species", *airs[0])}
        regions.all_species = False
        for species in self.mix:
            regions.species = species
            found.append([[row for row in regions.set(**air).table if math.isinf(row["height_from"]) and math.isinf(row["height_to"])] for air in airs])
        regions.set(**own)
        return [*map(self._of_mix, zip(*found))]

    @functools.cached_property
    def by_end(self) -> List[Dict[str, Any]]:
        """A row for each strip and the approach to each end: the share of all heights, for the birds asked for, with its standard error as
        in the table."""
        weights = self.weights(self.points).sum(axis=0)
        values = {name: self.mixed(self.regions, f"{name}_probability") for name in ("detection", "track")}
        rows: List[Dict[str, Any]] = [{"region": region, "species": self.bird, "places": len(members)} for region, members in self.ends.items()]
        for row, members in zip(rows, self.ends.values()):
            for name, p in values.items():
                row[f"{name}_probability"], row[f"{name}_std_error"], _ = weighted(p[members], weights[members])
        return rows

    @property
    def overall(self) -> Dict[str, Any]:
        """The row of shares of all places and heights, for the birds asked for."""
        name = self.bird if len(self.mix) > 1 else next(iter(self.mix))
        return next(row for row in reversed(self.shares) if row["species"] == name and row["height_from"] == -math.inf)

    def notes(self) -> Dict[str, str]:
        """What maps were made for, in words."""
        area = self.regions.data.GetFieldData().GetArray("effective_area").GetValue(0)
        size = f", effective area {area:.4f} m2 (assumed)" if len(self.mix) == 1 else ", effective areas assumed; reasons are of the first"
        return {"sensor": self.name, "position_m": " ".join(f"{c:g}" for c in self.sensor.position),
                "target": f"{self.bird}{size}, reflectance {self.coverage.reflectance:g} (assumed)",
                "visibility_m": f"{self.coverage.visibility:g} (assumed)" if self.coverage.visibility > 0.0 else
                                f"none, attenuation {self.coverage.attenuation_coefficient:.3g}/m", "rain_mm_h": f"{self.coverage.rain_rate:g}",
                "air": "sends light back" if self.coverage.air_backscatter or self.coverage.rain_rate else "only weakens", "assumed_of_the_sensor": ", ".join(self.assumed) or "none",
                "limits": "calculated, not measured"}

    def write(self, folder, progress=None) -> List[str]:
        """Write all files: a GeoTIFF for each height and quantity, shares.csv, ends.csv, clutter.vtp. @param progress called with the
        files done and their number @return their names"""
        names: List[str] = []
        total = len(self.heights) * (len(QUANTITIES) + (self.scene.geodetic_origin is not None)) + 3
        for name in self._files(pathlib.Path(folder)):
            names.append(name)
            if progress:
                progress(len(names), total)
        return names

    def _files(self, folder: pathlib.Path) -> Iterator[str]:
        """Names of files, each once it is written."""
        folder.mkdir(parents=True, exist_ok=True)
        origin = self.scene.geodetic_origin
        for height in self.heights:
            cover, at = self.map_at(height), height_name(height)
            for quantity, unit in QUANTITIES.items():
                values = self.mixed(cover, quantity) if quantity.endswith("_probability") else cover[quantity]
                notes = {**self.notes(), "height_m": f"{height:g}"}
                write_geotiff(folder / f"{quantity}_{at}.tif", values[0], cover.data.GetOrigin()[:2], cover.data.GetSpacing()[:2], origin,
                              f"{quantity} at {height:g} m", unit, cover.status_names if quantity == "status" else (), notes)
                yield f"{quantity}_{at}.tif"
            if origin is not None:
                name = f"detection_probability_{at}"
                write_areas(folder / f"{name}.geojson", folder / f"{name}.tif", "; ".join(map(": ".join, notes.items())))
                yield f"{name}.geojson"
        save(self.coverage.clutter_map, folder / "clutter.vtp")
        yield "clutter.vtp"
        for name, rows in (("shares.csv", self.shares), ("ends.csv", self.by_end)):
            write_table(folder / name, rows)
            yield name


def height_name(height: float) -> str:
    """As it stands in the names of files: as short as it can be, and another for each height."""
    short = f"{height:g}"
    return f"{short if float(short) == height else repr(float(height))}m"


def sensor_name(sensor: Mapping[str, Any], what: str = "sensor") -> str:
    """Its name in files and reports: `name`, else that of the preset; "changed" if more than place and orientation are set.
    @param what it is in a plan"""
    preset = pathlib.Path(sensor["preset"]).name.split(".lidarsensor")[0]
    changed = any(name not in ("preset", "position", "orientation") for name in sensor)
    return checked_name(sensor.get("name", f"{preset} changed" if changed and preset else preset), f"{what}.name")


def write_table(file, rows: Sequence[Dict[str, Any]]) -> None:
    """Write rows as CSV, units in the header."""
    head = [[f"{name} [m]" if name in ("height_from", "height_to") else name for name in rows[0]]] if rows else []
    table = [[f"{value:.6g}" if isinstance(value, float) else value for value in row.values()] for row in rows]
    write_whole(file, as_csv(head + table, "\r\n"))
