# SPDX-License-Identifier: BSD-3-Clause
"""A scene, plans and a scenario of an airport from an extract of a map: the command `avianlidar airport`. The scene reader raises
footprints, lays areas on the terrain and places crowns."""
from __future__ import annotations

import collections
import hashlib
import json
import math
import pathlib
import re
import warnings
from typing import Any, Callable, Counter, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np
from osgeo import gdal, ogr, osr

from .._cloud import field_values, leaves_of, triangles_of
from .._disk import write_whole
from .._files import read_regular
from .._pipeline import Error, update
from .._scene import Scene, load_scene
from .._scene import mesh as _surface
from .._writers import as_csv, vtp
from . import _heights, _pictures, siting
from ._extract import COAST, CUT, UNKNOWN, Feature, geometry, height_name, moved, open_file, properties_of, quiet, read_extract, rules, sea, valid, without_parts
from ._extract import degrees as _degrees
from ._extract import form_of as _form
from ._json import load_json, naming
from ._maps import coordinate_system
from ._obstacles import read_obstacles
from ._runways import box_of as _box
from ._runways import choose_runways
from ._surfaces import Surfaces, pierced

MOST_POSTS = 250_000  # of a terrain: it takes some seconds
MOST_CHOSEN = 0.25  # of the posts: where so many are needed, all are taken
FLAT_SPACING = 100.0  # m, of a ground without a terrain, which follows the Earth
AROUND = 600.0  # m beside runways where lidars may stand
SPACINGS, CHOICE = (200, 150, 100, 50), 30  # m between candidates of the siting plan: the widest that leaves about so many
WHAT = ("airport.geojson", "terrain.vtp", "airport.lidarscene.json", "exclusions.geojson", "airport.coverage.json",
        "siting.coverage.json", "airport.scenario.json", "assumed.csv", "airport.png", "README.txt")
RECORD = "made.json"  # checksums of these as they were made
FOOT = 0.3048  # m
COLOURS = {"runway": "#333333", "taxiway": "#666666", "apron": "#b0aca4", "road": "#8c8c8c", "parking": "#a5a5a5", "water": "#7fb2d6",
           "grass": "#cfe3b8", "terminal": "#c0392b", "hangar": "#8e44ad", "tower": "#e67e22", "mast": "#e67e22", "pole": "#e67e22",
           "fence": "#000000", "structure": "#8e6d4f"}
BUILDING = "#a0522d"
PLANTS = "#4c8c4a"


def read_heights(file: pathlib.Path, origin: Sequence[float], rectangle: Sequence[float], known: Dict[str, Any]
                 ) -> Tuple[np.ndarray, float, float, str]:
    """Heights of a raster at posts that cover a rectangle (m about the origin), rows from south to north: where the raster says
    none they are level, and it fades into that. @return heights (m), spacing (m), height at the origin (m), words for the reader"""
    raw = open_file(file, _heights.WHAT, list(_heights.DRIVERS), gdal.OF_RASTER)
    with naming(str(file)), quiet():
        data, unit = _heights.in_metres(file, raw)
        system = coordinate_system((*origin[:2], 0.0)).ExportToWkt()
        own = abs(gdal.AutoCreateWarpedVRT(data, None, system).GetGeoTransform()[1])
        west, east, south, north = rectangle
        spacing = max(own, math.sqrt((east - west) * (north - south) / MOST_POSTS))
        columns, rows = (int(math.ceil((high - low) / spacing)) + 1 for low, high in ((west, east), (south, north)))
        half = spacing / 2
        bounds = (west - half, south - half, west - half + columns * spacing, south - half + rows * spacing)
        grid = gdal.Warp("", data, format="MEM", dstSRS=system, outputBounds=bounds, width=columns, height=rows, dstNodata=-1e9,
                         resampleAlg="bilinear" if spacing < 2.0 * own else "average", outputType=gdal.GDT_Float64, multithread=False,
                         overviewLevel="NONE", options=["-novshift"])
        band = grid.GetRasterBand(1)
        heights = band.ReadAsArray()
        holes = 100.0 * np.mean(~(np.abs(heights) < 1e8))
        if holes == 100.0:
            raise Error(f"holds no heights from {_heights.LOWEST:,g} to {_heights.HIGHEST:,g} m at the airport")
        if holes:
            gdal.FillNodata(band, None, 20, 0)
            heights = _feathered(band.ReadAsArray(), spacing, known["feather"])
    heights = heights[::-1]
    here = _at(heights, (west, south), spacing, (0.0, 0.0))
    words = f"heights: {file.name}, {heights.min():.1f} to {heights.max():.1f} m, taken every {spacing:.3g} m" + (f" (it has them every {own:.3g} m)" if spacing > 1.01 * own else "")
    if unit and _heights.metres_of(unit) != 1.0:
        words += f", in {unit}, which it says"
    if holes > 0.0:
        words += (f"; {holes:.2g} % of the places have none there: holes are filled from around them, and beyond its border the ground is level, "
                  f"into which it fades over {known['feather']:g} m (assumed)")
    if holes > 5.0:
        warnings.warn(f"{file}: has no heights at {holes:.2g} % of the places of the scene, which are level there", RuntimeWarning, stacklevel=2)
    return heights, spacing, here, words


def _feathered(heights: np.ndarray, spacing: float, width: float) -> np.ndarray:
    """Level where heights are missing, at the mean of the border, and fading into that within `width` (m)."""
    from scipy.ndimage import distance_transform_edt
    missing = ~(np.abs(heights) < 1e8)
    if not missing.any():
        return heights
    away = distance_transform_edt(~missing) * spacing
    level = heights[(away > 0.0) & (away < 1.5 * spacing)].mean()
    share = np.clip(away / max(width, spacing), 0.0, 1.0)
    return level + np.where(missing, 0.0, share * share * (3.0 - 2.0 * share) * (heights - level))


def _at(values: np.ndarray, corner: Sequence[float], spacing: float, place: Sequence[float]) -> float:
    """Between four posts."""
    from scipy.ndimage import map_coordinates
    at = [[(place[i] - corner[i]) / spacing] for i in (1, 0)]
    return float(map_coordinates(values, at, order=1, mode="nearest")[0])


def curvature(origin: Sequence[float], x, y):
    """How far the ellipsoid lies below the origin's tangent plane, m, to the second order: 5 um off at 5 km and 8 mm at 50 km.
    @param origin latitude (deg), ... @param x, y east and north, m"""
    a, f = 6378137.0, 1.0 / 298.257223563
    bulge = 1.0 - f * (2.0 - f) * math.sin(math.radians(origin[0])) ** 2
    across = a / math.sqrt(bulge)
    along = a * (1.0 - f * (2.0 - f)) / bulge ** 1.5
    return 0.5 * (x * x / across + y * y / along)


def terrain(heights: np.ndarray, corner: Sequence[float], spacing: float, origin: Sequence[float], error: float):
    """Triangles (vtkPolyData, m east, north and up of the origin) within `error` (m) of the posts: Delaunay's of the corners and of
    the worst post of each triangle, again and again; of rough ground all posts. VTK's vtkGreedyTerrainDecimation does not keep to its error: of waves of 20 m
    it was 34 m off where 0.25 m was asked for (VTK 9.1). @param heights above the origin's height, m, rows from south to north"""
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
        off = np.abs((np.column_stack([two, 1.0 - two.sum(axis=1)]) * z[numbers][mesh.simplices[found]]).sum(axis=1) - z)
        off[chosen] = 0.0
        order = np.lexsort((-off, found))
        worst = order[np.r_[True, np.diff(found[order]) != 0]]
        worst = worst[off[worst] > error]
        if not len(worst):
            return _surface(np.column_stack([x, y, z])[numbers], mesh.simplices)
        chosen[worst] = True
    cells = np.arange(rows * columns).reshape(heights.shape)
    a, b, c, d = (part.ravel() for part in (cells[:-1, :-1], cells[:-1, 1:], cells[1:, 1:], cells[1:, :-1]))
    return _surface(np.column_stack([x, y, z]), np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))


class Kept:
    """Files of a folder that are made again as long as nobody has edited them."""

    def __init__(self, folder: pathlib.Path):
        self.folder, self.record = folder, folder / RECORD
        self.edited: List[str] = []
        self.made = load_json(self.record) if self.record.exists() else {}
        if not isinstance(self.made, dict) or not all(isinstance(sums, (str, list)) for sums in self.made.values()):
            raise Error(f"{self.record}: expected checksums by the names of files; remove it to have all files made again as new ones")
        strange = [name for name in WHAT if (folder / name).exists() and name not in self.made]
        if strange:
            raise Error(f"{folder}: {strange[0]} is there and was not made by this command; choose another folder")

    def put(self, name: str, make: Callable[[], bytes]) -> pathlib.Path:
        """The file, made unless it was edited."""
        path = self.folder / name
        found = hashlib.sha256(read_regular(path)).hexdigest() if path.exists() else ""
        if found and found not in self.made[name]:
            self.edited = [*dict.fromkeys([*self.edited, name])]
            return path
        content = make()
        # A run that is stopped between the record and the file leaves the one before: both are as they were made.
        self.made[name] = sorted({hashlib.sha256(content).hexdigest(), found} - {""})
        write_whole(self.record, (json.dumps(self.made, indent=2) + "\n").encode())
        write_whole(path, content)
        return path


def _json(value: Any) -> bytes:
    return (json.dumps(value, indent=2, ensure_ascii=False) + "\n").encode()


def _geojson(features: Sequence[Tuple[Dict[str, Any], Any]]) -> bytes:
    """A feature a line. @param features properties and geometries (ogr, degrees)"""
    rows = [json.dumps({"type": "Feature", "properties": properties, "geometry": json.loads(shape.ExportToJson(["COORDINATE_PRECISION=9"]))},
                       ensure_ascii=False) for properties, shape in features]
    return ('{"type": "FeatureCollection", "features": [\n' + ",\n".join(rows) + "\n]}\n").encode()


class Airport:
    """What is made of an extract."""

    def __init__(self, extract, heights=None, icao: Optional[str] = None, bounds: Optional[Sequence[float]] = None, obstacles: Sequence[Any] = (),
                 progress: Callable[[str, int, int], Any] = lambda *_: None):
        self.known, self.extract = rules(), pathlib.Path(extract)
        self.dem = pathlib.Path(heights) if heights is not None else None
        self.progress = progress
        if bounds is not None:
            west, south, east, north = bounds
            if not (-180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0):
                raise ValueError(f"--bounds {west:g} {south:g} {east:g} {north:g}: expected west, south, east and north in degrees")
        progress("extract", 0, 1)
        found = read_extract(self.extract, self.known)
        self.features, self.left, self.unknown, self.used = found.features, found.left, found.unknown, found.used
        progress("extract", 1, 1)
        self.runways, aerodrome = choose_runways(self.extract, found, self.known, icao, bounds)
        self.obstacles = [pathlib.Path(file) for file in obstacles]
        for file in self.obstacles:
            surveyed, left = read_obstacles(file, self.known)
            self.features += surveyed
            self.left += left
        self.tags = aerodrome.tags if aerodrome else {}
        self.name = self.tags.get("name") or self.tags.get("icao") or self.extract.name.split(".")[0]
        self._place(bounds)
        coasts = [one for one in self.features if one.kind == COAST]
        self.features = [one for one in self.features if one.kind != COAST]
        seas, near = sea(coasts, self.box), sum(one.shape.Intersects(self.box) for one in coasts)
        self.features += [Feature("water", {"name": "sea"}, shape, 0) for shape in seas]
        if near < len(coasts):
            self.left.append(Feature(COAST, {}, count=len(coasts) - near, reason="outside the scene"))
        if seas:
            self.used[COAST] = near
        elif near:
            self.left.append(Feature(COAST, {}, count=near, reason="a coast that does not part the scene"))
            warnings.warn(f"{self.extract}: its coastlines do not part the scene: the sea is land there; draw it as natural=water, or cut the extract "
                          "wider", RuntimeWarning, stacklevel=2)
        ground = valid(aerodrome.shape) if aerodrome and _form(aerodrome.shape) == "area" else None
        self.ground = ground if ground is not None and all(ground.Contains(one.shape.Centroid()) for one in self.runways) else None

    def _place(self, bounds: Optional[Sequence[float]]) -> None:
        """Origin, and the rectangle that the scene holds."""
        ends = np.array([one.shape.GetPoints() for one in self.runways])[:, :, :2]
        low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
        if high[0] - low[0] > 180.0:
            raise Error(f"{self.extract}: its runways cross the meridian of 180 degrees, where scenes of this command end")
        longitude, latitude = (low + high) / 2
        self.origin = (round(float(latitude), 7), round(float(longitude), 7), 0.0)
        local = coordinate_system(self.origin)
        self.to_local, self.to_degrees = osr.CoordinateTransformation(_degrees(), local), osr.CoordinateTransformation(local, _degrees())
        shape = moved(_box(bounds) if bounds is not None else geometry("MultiLineString", ends), self.to_local)
        margin = 0.0 if bounds is not None else self.known["margin"]
        west, east, south, north = shape.GetEnvelope()
        self.rectangle = (west - margin, east + margin, south - margin, north + margin)
        around = moved(_box([self.rectangle[i] for i in (0, 2, 1, 3)]), self.to_degrees).GetEnvelope()
        if np.ptp(around[:2]) > 180.0:
            raise Error(f"{self.extract}: the scene would reach over the meridian of 180 degrees; set --bounds to the runways' side of it")
        self.box = _box([around[i] for i in (0, 2, 1, 3)])

    def _chosen(self, posts: np.ndarray, corner: Sequence[float], spacing: float) -> List[Feature]:
        """What becomes part of the scene; `self.left` gets all else, with its reason. The ground is that of `_posts`."""
        found: List[Feature] = []
        outside: Dict[str, int] = collections.Counter()
        lines = [one for one in self.features if one.kind == "runway" and _form(one.shape) == "line"]
        for one in [*self.runways, *(one for one in self.features if one not in lines)]:
            shape = one.shape
            if not shape.Intersects(self.box) if shape.IsValid() else not shape.ConvexHull().Intersects(self.box):
                outside[one.kind] += one.count
                continue
            if "elevation" in one.tags and "height" not in one.tags:
                place = moved(shape.Centroid(), self.to_local)
                above = float(one.tags["elevation"]) - self.origin[2] - _at(posts, corner, spacing, (place.GetX(), place.GetY()))
                if self.dem is None or not above > 0.0:
                    self.left.append(one.left("an elevation without --heights" if self.dem is None else "below ground"))
                    continue
                one.tags = {**one.tags, "height": f"{above:.3f}", "height_source": f"{one.tags['height_source']}, elevation less that of the ground"}
            found.append(one)
        self.left += [Feature(kind, {}, count=count, reason="outside the scene") for kind, count in outside.items()]
        found, drawn = without_parts(found, self.known)
        self.left += [one.left("drawn by its parts") for one in drawn]
        self.cut = [one for one in found if CUT in one.tags]
        if any(one.kind == "runway" for one in self.cut):
            warnings.warn(f"{self.extract}: a runway is {CUT}, and ends there: cut the extract wider", RuntimeWarning, stacklevel=3)
        return found

    def _mapped(self, chosen: Sequence[Feature]) -> bytes:
        """What is in the scene, with what the scene file reads of it; flat areas, woods and lines end at the box."""
        rows = []
        for one in chosen:
            shape, rule = one.shape, self.known["kinds"][one.kind]
            if ("flat" in rule or "medium" in rule or _form(shape) == "line") and one.kind != "runway" and not self.box.Contains(shape):
                shape = valid(shape).Intersection(self.box)
                if shape is None or shape.IsEmpty():
                    continue
            rows.append((properties_of(one, self.known), shape))
        order = list(self.known["kinds"])
        rows.sort(key=lambda row: order.index(row[0]["kind"]))
        return _geojson(rows)

    def _posts(self) -> Tuple[np.ndarray, Sequence[float], float]:
        """Heights above the origin, whose height they say, their south-west corner (m) and spacing."""
        west, east, south, north = rectangle = tuple(x + sign * 50.0 for x, sign in zip(self.rectangle, (-1, 1, -1, 1)))
        if self.dem is None:
            spacing = FLAT_SPACING
            columns, rows = (int(math.ceil((high - low) / spacing)) + 1 for low, high in ((west, east), (south, north)))
            posts: np.ndarray = np.zeros((rows, columns))
            self.terrain_words = (f"heights: none given: the ground is level at 0 m (assumed), and curves as the Earth does")
        else:
            posts, spacing, here, self.terrain_words = read_heights(self.dem, self.origin, rectangle, self.known)
            self.origin = (*self.origin[:2], round(here, 3))
            posts = posts - self.origin[2]
        self.error = self.known["terrain_error"] if self.dem is not None else self.known["level_error"]
        self.terrain_words += f"; triangles within {self.error:g} m of that"
        return posts, (west, south), spacing

    def write(self, folder) -> "Kept":
        """Leave all files in a folder, which is there; those that were edited stay."""
        out = pathlib.Path(folder)
        kept = Kept(out)
        self.progress("files", 0, len(WHAT))
        posts = self._posts()
        with quiet():
            chosen = self._chosen(*posts)
            mapped = kept.put("airport.geojson", lambda: self._mapped(chosen))
        kept.put("terrain.vtp", lambda: vtp(terrain(*posts, self.origin, self.error)))
        if "terrain.vtp" in kept.edited:
            self.terrain_words = "heights: terrain.vtp as it was edited"
        self.rows = [feature["properties"] for feature in siting._features(mapped)]
        unknown = {row.get("kind") for row in self.rows} - set(self.known["kinds"])
        if unknown:
            raise Error(f"{mapped}: kind is {sorted(map(str, unknown))[0]!r}, expected one of {', '.join(self.known['kinds'])}")
        for number, row in enumerate(self.rows):
            for name in ("height", "top", "width"):
                if name in row and (not isinstance(row[name], (int, float)) or not 0.0 < row[name] <= 1e4):
                    raise Error(f"{mapped}: features[{number}] ({row['kind']} {row.get('id', '')}): {name} is {row[name]!r}, expected metres above 0")
        scene_file = out / "airport.lidarscene.json"
        kept.put(scene_file.name, lambda: _json(self.scene_of()))
        self.progress("files", 3, len(WHAT))
        self.scene = load_scene(scene_file)
        self._count(chosen)
        self.sides = siting.read_runways(mapped, self.scene.geodetic_origin)
        exclusions = kept.put("exclusions.geojson", lambda: self._exclusions(mapped))
        self.position = self._position(mapped, exclusions)
        kept.put(scene_file.name, lambda: _json(self.scene_of(self.position)))
        kept.put("airport.coverage.json", lambda: _json(self.plan()))
        kept.put("siting.coverage.json", lambda: _json(self.plan(siting_too=True)))
        kept.put("airport.scenario.json", lambda: _json(self.scenario()))
        kept.put("assumed.csv", self._assumed)
        self.progress("files", 8, len(WHAT))
        kept.put("airport.png", self._picture)
        kept.put("README.txt", self._readme)
        self.progress("files", len(WHAT), len(WHAT))
        return kept

    def scene_of(self, position: Optional[np.ndarray] = None) -> Dict[str, Any]:
        """The scene file. @param position of the lidar, m"""
        objects: List[Dict[str, Any]] = [{"name": "Terrain", "class": "terrain", "file": "terrain.vtp", "material": "Grass"}]
        there = collections.Counter((row["kind"], row.get("surface")) for row in self.rows)
        for kind, rule in self.known["kinds"].items():
            for surface in sorted({surface for one, surface in there if one == kind}, key=str):
                name = kind.replace("_", " ").capitalize() + (f" of {surface.lower()}" if surface else "")
                item: Dict[str, Any] = {"name": name, "class": rule["class"], "footprints": "airport.geojson",
                                        "filter": {"kind": kind, **({"surface": surface} if surface else {})}, "on": "Terrain"}
                if "medium" in rule:
                    item["medium"] = rule["medium"]
                else:
                    item["material"] = surface or rule["material"]
                if rule.get("flat"):
                    item.update(flat=True, base=rule["base"])
                else:
                    item.update(height_attribute=height_name(rule), height=rule["height"])
                    if any(row["kind"] == kind and "min_height" in row for row in self.rows):
                        item["min_height_attribute"] = "min_height"
                if "width" in rule:
                    item.update(width_attribute="width", width=rule["width"])
                if "glazing" in rule:
                    item["glazing"] = rule["glazing"]
                if kind in ("runway", "terminal", "hangar", "tower"):
                    item.update(features="separate", name_attribute="ref" if kind == "runway" else "name")
                objects.append(item)
        used = {item.get("material") for item in objects}
        materials = {name: values for name, values in self.known["materials"].items() if name in used}
        lidar = {"lidar": {"position": [round(float(x), 3) for x in position]}} if position is not None else {}
        return {"version": 1, "comment": [f"{self.name}, from {self.extract.name}. README.txt says what is assumed.", self.terrain_words],
                "attribution": [f"Outlines: {self.extract.name}; of OpenStreetMap: (c) OpenStreetMap contributors, ODbL 1.0, "
                                "https://www.openstreetmap.org/copyright", *(f"Obstacles: {file.name}" for file in self.obstacles)],
                "origin": dict(zip(("latitude", "longitude", "height"), self.origin)), **lidar,
                **({"materials": materials} if materials else {}), "objects": objects}

    def _exclusions(self, mapped: pathlib.Path) -> bytes:
        """Where no lidar may stand beside buildings: around runways and taxiways, on aprons, roads and water, in woods, and outside
        the aerodrome, if the extract has its outline."""
        rows = []
        if self.ground is not None:
            rows.append(({"what": "outside the aerodrome"}, self.box.Difference(self.ground)))
        for runway in self.sides:
            corners = siting.to_geodetic(np.column_stack([siting.runway_outline(runway), np.zeros(4)]), self.scene.geodetic_origin)[:, :2]
            rows.append(({"what": "around a runway", "name": runway.name}, geometry("Polygon", [[*corners, corners[0]]])))
        for feature in siting._features(mapped):
            kind = feature["properties"]["kind"]
            if kind not in ("taxiway", "apron", "road", "water", "wood", "scrub"):
                continue
            shape = ogr.CreateGeometryFromJson(json.dumps(feature["geometry"]))
            if _form(shape) == "line":
                beside = self.known["beside_taxiways"] if kind == "taxiway" else feature["properties"].get("width", 0.0) / 2
                shape = moved(moved(shape, self.to_local).Buffer(beside), self.to_degrees)
            rows.append(({"what": kind}, shape))
        return _geojson(rows)

    def _bounds(self) -> List[float]:
        """Of the runways, and what lies beside them: least and greatest x, y, m."""
        ends = np.array([end for runway in self.sides for end in (runway.start, runway.end)])
        low, high = ends.min(axis=0) - AROUND, ends.max(axis=0) + AROUND
        return [float(x) for x in np.round((low[0], high[0], low[1], high[1]), -1)]

    @property
    def leaves(self) -> bool:
        """Whether the scene has any: the clutter behind them takes seconds in each of a report's weathers."""
        return any("medium" in self.known["kinds"][row["kind"]] for row in self.rows)

    @property
    def longest(self) -> siting.Runway:
        return max(self.sides, key=lambda runway: runway.axis()[1])

    def _position(self, mapped: pathlib.Path, exclusions: pathlib.Path) -> np.ndarray:
        """A place for the lidar, until siting finds a better one: the free place nearest to the middle of the longest runway, below the
        obstacle limitation surfaces unless every free place pierces them."""
        taken = siting.read_outlines(mapped, self.scene.geodetic_origin, "height")
        taken += siting.read_outlines(exclusions, self.scene.geodetic_origin)
        with naming(f"{self.extract}: places for a lidar beside its runways"):
            free = siting.candidates(siting.lattice(self._bounds(), SPACINGS[-1]), (self.known["mast"],), [(outline, 10.0) for outline in taken],
                                     self.scene)
        below = free[pierced([Surfaces.of(runway, self.scene) for runway in self.sides], free) == 0]
        self.pierces = len(below) == 0
        free = free if self.pierces else below
        area = len(free) * SPACINGS[-1] ** 2
        self.spacing = next((spacing for spacing in SPACINGS if area >= CHOICE * spacing**2), SPACINGS[-1])
        middle = np.mean([self.longest.start, self.longest.end], axis=0)
        return free[np.argmin(np.linalg.norm(free[:, :2] - middle, axis=1))]

    def plan(self, siting_too: bool = False) -> Dict[str, Any]:
        """A plan of coverage. @param siting_too also where else lidars could stand"""
        plan: Dict[str, Any] = {
            "description": f"{'Where should a search lidar stand to see herring gulls' if siting_too else 'Where does a search lidar see herring gulls'} "
                           f"at {self.name}?",
            "scene": "airport.lidarscene.json", "sensor": {"preset": "Search905"}, "coverage": {"species": "herring gull", "visibility": 23000},
            "runways": "airport.geojson"}
        if siting_too:
            if self.leaves:
                plan["coverage"]["clutter"] = False
            plan["siting"] = {"bounds": self._bounds(), "spacing": self.spacing, "masts": [self.known["mast"]], "margin": 10,
                              "exclusions": ["exclusions.geojson"], "sensors": 3}
        return plan

    def scenario(self) -> Dict[str, Any]:
        """A scenario of labelled scans with birds around the lidar, and an aircraft on the longest runway."""
        x, y, z = (round(float(c), 1) for c in self.position)
        ground = round(z - self.known["mast"], 1)
        around = {"center": [x, y, ground]}
        runway = self.longest
        (x0, y0), (x1, y1) = runway.start, runway.end
        z0, z1 = (round(float(np.nan_to_num(h)), 1) for h in siting.ground_of(self.scene, [runway.start, runway.end]))
        return {
            "description": f"Birds at {self.name}. Kinds, numbers and flights of birds, the aircraft, sway and jitter are assumed.",
            "scene": "airport.lidarscene.json",
            "sensor": {"preset": "Search905", "sway_amplitude": 0.02, "sway_frequency": 0.5, "encoder_jitter": 0.01},
            "scan": {"attenuation_coefficient": 8.9e-5, "number_of_reflections": 1, "rays_per_beam": 400},
            "number_of_scans": 100, "scans_per_sequence": 100, "seed": 1,
            "birds": [
                {"pattern": "Crossings", "species": "herring gull", "number_of_birds": 8, "radius": 500, "heights": [2, 40], **around},
                {"pattern": "Crossings", "species": "crow", "number_of_birds": 8, "radius": 400, "heights": [2, 30], **around},
                {"pattern": "Circles", "species": "kestrel", "number_of_birds": 4, "radius": 300, "heights": [5, 25], **around},
                {"pattern": "Flock", "species": "starling", "number_of_birds": 8, "radius": 250, "heights": [8, 20], **around}],
            "objects": [
                {"name": "Aircraft on the runway", "class": "aircraft", "material": "Metal", "speed": 40, "every": 150,
                 "boxes": [[-2, 2, -19, 19, 2, 6], [-17, 17, -3, 3, 2.5, 3.2], [-0.3, 0.3, -19, -14, 6, 12]],
                 "route": [[round(x0, 1), round(y0, 1), z0], [round(x1, 1), round(y1, 1), z1]]}]}

    def _assumed_rows(self) -> Iterator[Tuple[Any, ...]]:
        for row in self.rows:
            for what in ("kind", "height", "top", "min_height", "width", "surface"):
                if "assumed" in str(row.get(f"{what}_from", "")):
                    yield row["kind"], row.get("id", ""), row.get("name") or row.get("ref") or "", what, row.get(what, 0.0), row[f"{what}_from"]

    def _assumed(self) -> bytes:
        return as_csv([
            ("kind", "id", "name", "what", "value (m, or a material)", "from"), *self._assumed_rows(),
            *((one.kind, one.id, one.name, "left out", one.count, one.reason) for one in self.left),
            *(("unknown kind", "", name, "left out", n, "no rule knows it") for name, n in self.unknown.most_common()),
            *((kind, "", "", "in the scene", count, "") for kind, count in self.there.items())])

    def _count(self, chosen: Sequence[Feature]) -> None:
        """How many of each kind are in the scene; what its reader leaves out becomes part of `self.left`."""
        self.there = collections.Counter(self.used)
        for one in chosen:
            self.there[one.kind] += one.count
        kinds = {kind.replace("_", " "): kind for kind in self.known["kinds"]}
        report = "\n".join(field_values(self.scene.surfaces.GetBlock(0)).get("scene_report", ()))
        for name, count, reason in re.findall(r"^(.*): (\d+) (.*) were left out$", report, re.MULTILINE):
            kind = kinds.get(name.split(" of ")[0].lower())
            if kind is not None:
                self.left.append(Feature(kind, {}, count=int(count), reason=reason))
                self.there[kind] -= int(count)

    def _reasons(self) -> Dict[str, Counter[str]]:
        """How many features of each kind are left out for which reason."""
        found: Dict[str, Counter[str]] = collections.defaultdict(collections.Counter)
        for one in self.left:
            found[one.kind][one.reason] += one.count
        return found

    @property
    def counts(self) -> str:
        """What was read, what is in the scene and what is not, by reason, in one line."""
        reasons = sum(self._reasons().values(), collections.Counter({UNKNOWN: sum(self.unknown.values())}))
        there, left = sum(self.there.values()), sum(reasons.values())

        def verb(count: int, one: str, more: str) -> str:
            return f"{count:,} {one if count == 1 else more}"
        strange = [said[1] for row in self.rows for name in ("height_from", "top_from", "min_height_from")
                   for said in [re.match("assumed: [^ ]+ is ('.*?'|\".*?\")(?:, above|$)", str(row.get(name, "")))] if said]
        return (f"{verb(there + left, 'feature was', 'features were')} read, {verb(there, 'is', 'are')} in the scene, {verb(left, 'was', 'were')} left out") + (
            ": " + ", ".join(f"{count:,} {reason}" for reason, count in reasons.most_common()) if left else "") + (
            f"; {verb(len(strange), 'height was', 'heights were')} not understood: {', '.join(list(dict.fromkeys(strange))[:4])}" if strange else "")

    def _counts(self) -> str:
        """The same by kind."""
        lines, outside, away, found = [f"  {self.counts}"], "outside the scene", [], self._reasons()
        for kind in dict.fromkeys([*self.there, *(one.kind for one in self.left)]):
            out, there = +found[kind], self.there[kind]
            if not there and set(out) == {outside}:
                away.append(f"{kind} ({out[outside]:,})")
            elif out:
                lines.append(f"  {kind or 'others'}: {there + sum(out.values()):,} read, {there:,} in the scene; left out: "
                             + ", ".join(f"{count:,} {reason}" for reason, count in out.items()))
        named = [f"{name} ({count:,})" for name, count in self.unknown.most_common(7) if name != "others"]
        cut = [f"{count:,} {kind}" for kind, count in collections.Counter(one.kind for one in self.cut).items()]
        lines += [f"  {words}: {', '.join(some)}" for words, some in (
            (f"all {outside}", away), ("among those of unknown kind", named[:6]), (f"{CUT}, and shorter than they are", cut)) if some]
        if self.cut or any(one.reason == CUT for one in self.left):
            lines.append("  what is cut by the border is whole in an extract that is cut by `osmium extract --strategy smart`")
        return "\n".join(lines)

    def _readme(self) -> bytes:
        kinds = collections.Counter(row["kind"] for row in self.rows)
        assumed = collections.Counter((row[0], row[3]) for row in self._assumed_rows())
        lengths = "\n".join(f"  {runway.words()}" for runway in self.sides)
        table = "\n".join(f"  {kind}: {count}" + "".join(f"; {what} assumed of {number}" for (one, what), number in assumed.items() if one == kind)
                          for kind, count in kinds.items())
        said = sorted({str(row[name]) for row in self.rows for name in ("height_from", "top_from") if ": " in str(row.get(name, ""))})
        quoted = "".join(f"  heights are from {words}\n" for words in said)
        heights = siting.ground_of(self.scene, [end for runway in self.sides for end in (runway.start, runway.end)])
        x, y, z = self.position
        without = "; without clutter, as behind leaves it takes long" if self.leaves else ""
        return f"""{self.name}

Made by `avianlidar airport` from {self.extract.name}. All files are to be edited: a further run makes only those again that nobody
has edited, so remove a file to have it made anew.

  airport.geojson          what was taken from the extract: kind, height (of plants, fences and masts: top), width, and what each is from
  terrain.vtp              the ground
  airport.lidarscene.json  the scene
  airport.coverage.json    a plan: avianlidar coverage airport.coverage.json -o maps
  siting.coverage.json     the same with sites: avianlidar report siting.coverage.json -o report.html{without}
  exclusions.geojson       where no lidar may stand, beside buildings
  airport.scenario.json    labelled scans: avianlidar sequence airport.scenario.json -o sequences
                           tracks of them: avianlidar track sequences --runways airport.geojson -o tracks
  assumed.csv              each number that the extract does not say, and what was left out
  airport.png              the scene from above

Runways
{lengths}

What there is, and of how much of it a number is assumed
{table}
{quoted}
What was read, and what became of it
{self._counts()}

{self.terrain_words}
  heights are above the sea or the ellipsoid as the file has them
  the ends of the runways lie {np.nanmin(heights):.1f} to {np.nanmax(heights):.1f} m above the origin; heights of plans are above the origin

Assumed besides: materials, leaves (m2/m3) of woods and trees, which are full of leaves to the ground, what is not mapped is grass.
Roofs are level, solids stand on the lowest ground below them. Fences are walls here: wire lets most light through.

Check on site
  the runways' widths and ends, against the aeronautical chart
  heights of terminals, hangars, towers and masts near the lidar: they shadow
  what is new, gone, or was never mapped: buildings, masts, fences, trees; cranes and parked aircraft
  woods and trees: height, and leaves by season
  the lidar's place ({x:.0f} m east, {y:.0f} m north, {z:.1f} m up): the free place nearest to the middle of the longest runway
  {"that pierces an obstacle limitation surface of ICAO Annex 14, as every free place does" if self.pierces else
   "below the strip, approach and transitional surfaces of ICAO Annex 14"}; whether a mast may stand there is for the airport to decide
  exclusions: simplified; the report of siting.coverage.json also keeps masts below these surfaces
""".encode()

    def _picture(self) -> bytes:
        """The scene from above, in colours of what it is."""
        import tempfile
        west, east, south, north = self.rectangle
        longer = max(east - west, north - south) / 9.0  # m of an inch
        size = (max((east - west) / longer, 3.0) + 2.0, max((north - south) / longer, 3.0) + 0.5)
        with tempfile.TemporaryDirectory() as folder:
            return read_regular(_pictures.draw(pathlib.Path(folder) / "airport.png", size, self._draw))

    def _draw(self, axes) -> None:
        from matplotlib.collections import PolyCollection
        from matplotlib.colors import LinearSegmentedColormap
        from matplotlib.patches import Patch
        shown: Dict[str, str] = {}
        for _, word, triangles in parts_of(self.scene):
            if word == "terrain":
                x, y, z = triangles.reshape(-1, 3).T
                shades = axes.tripcolor(x, y, np.arange(len(x)).reshape(-1, 3), z, shading="gouraud", zorder=0,
                                        cmap=LinearSegmentedColormap.from_list("ground", ("#c3d3b4", "#f6f1df")))
                axes.figure.colorbar(shades, ax=axes, shrink=0.5, label="ground, m above the origin")
                continue
            colour = COLOURS.get(word, PLANTS if word in ("tree", "vegetation") else BUILDING)
            shown[word] = colour
            order = {"grass": 1, "water": 2, "parking": 2, "road": 3, "apron": 4, "taxiway": 5, "runway": 6, "vegetation": 7}.get(word, 8)
            axes.add_collection(PolyCollection(list(triangles[:, :, :2]), facecolors=colour, edgecolors=colour, linewidths=0.2, zorder=order))
        axes.plot(*self.position[:2], "r^", markersize=8, zorder=20)
        for runway in self.sides:
            axes.annotate(runway.name, runway.start, color="white", fontsize=8, ha="center", zorder=21,
                          bbox={"facecolor": "black", "pad": 1, "linewidth": 0})
        patches = [Patch(color=colour, label=word) for word, colour in shown.items()]
        axes.legend(handles=patches, loc="upper left").set_zorder(30)
        axes.set(xlim=self.rectangle[:2], ylim=self.rectangle[2:], aspect="equal", xlabel="m east", ylabel="m north",
                 title=f"{self.name}: the scene from above; red: the lidar")


def parts_of(scene: Scene) -> Iterator[Tuple[str, str, np.ndarray]]:
    """Of each object of a scene file its name, class and triangles (n x 3 x 3, m)."""
    for block in leaves_of(scene.surfaces):
        fields, (points, cells) = field_values(block), triangles_of(block)
        yield fields["object_names"][0], fields["object_classes"][0], points[cells]
