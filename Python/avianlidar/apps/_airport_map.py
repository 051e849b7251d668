# SPDX-License-Identifier: BSD-3-Clause
"""Features of an airport from maps, the features in its scene, and the plans and the scenario that follow."""
from __future__ import annotations

import collections
import json
import pathlib
import re
import warnings
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np
from osgeo import ogr, osr

from .._cloud import field_values
from .._pipeline import Error
from .._scene import Scene
from ._candidates import Surfaces, candidates, ground_of, lattice, pierced
from ._extract import COAST, CUT, sea, without_parts
from ._features import Feature, height_name, properties_of
from ._gdal import box_of, degrees, form_of, geometry, moved, valid
from ._geojson import features_of, read_outlines, to_geodetic
from ._ground import height_at, posts_of, read_heights
from ._json import naming, packaged
from ._maps import coordinate_system
from ._obstacles import read_obstacles
from ._osm import read_extract
from ._regions import Runway, ends_of, runway_outline
from ._runways import choose_runways

FLAT_SPACING = 100.0  # spacing of a ground without a terrain, which follows the curvature of the Earth, m
AROUND = 600.0  # distance from runways within which lidars may stand, m
SPACINGS, CHOICE = (200, 150, 100, 50), 30  # spacings of candidates, m; the widest that leaves CHOICE of them is used


class AirportMap:
    """An airport as given by extracts, a raster of heights and surveyed obstacles, and then by the written files.

    rows   properties of the features of airport.geojson    scene  as loaded
    sides  runways of the scene

    `rows`, `scene` and `sides` are set when files have been written and read again.
    """

    rows: List[Dict[str, Any]]
    scene: Scene
    sides: List[Runway]

    def __init__(self, extract, heights=None, icao: Optional[str] = None, bounds: Optional[Sequence[float]] = None,
                 obstacles: Sequence[Any] = (), progress: Callable[[str, int, int], Any] = lambda *_: None):
        self.known, self.extract = packaged("airport.json"), pathlib.Path(extract)
        self.dem = pathlib.Path(heights) if heights is not None else None
        self.progress = progress
        if bounds is not None:
            west, south, east, north = bounds
            if not (-180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0):
                raise ValueError(f"--bounds {west:g} {south:g} {east:g} {north:g}: "
                                 "expected west, south, east and north in degrees")
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
            warnings.warn(f"{self.extract}: its coastlines do not part the scene: the scene has land in place of the "
                          "sea; draw the sea as natural=water, or cut the extract wider", RuntimeWarning, stacklevel=2)
        ground = valid(aerodrome.shape) if aerodrome and form_of(aerodrome.shape) == "area" else None
        self.ground = ground if ground is not None and all(
            ground.Contains(one.shape.Centroid()) for one in self.runways) else None

    def _place(self, bounds: Optional[Sequence[float]]) -> None:
        """Sets the origin and the rectangle of the scene."""
        ends = np.array([one.shape.GetPoints() for one in self.runways])[:, :, :2]
        low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
        if high[0] - low[0] > 180.0:
            raise Error(f"{self.extract}: its runways cross the meridian of 180 degrees, "
                        "where scenes of this command end")
        longitude, latitude = (low + high) / 2
        self.origin = (round(float(latitude), 7), round(float(longitude), 7), 0.0)
        local = coordinate_system(self.origin)
        self.to_local = osr.CoordinateTransformation(degrees(), local)
        self.to_degrees = osr.CoordinateTransformation(local, degrees())
        shape = moved(box_of(bounds) if bounds is not None else geometry("MultiLineString", ends), self.to_local)
        margin = 0.0 if bounds is not None else self.known["margin"]
        west, east, south, north = shape.GetEnvelope()
        self.rectangle = (west - margin, east + margin, south - margin, north + margin)
        around = moved(box_of([self.rectangle[i] for i in (0, 2, 1, 3)]), self.to_degrees).GetEnvelope()
        if np.ptp(around[:2]) > 180.0:
            raise Error(f"{self.extract}: the scene would reach over the meridian of 180 degrees; "
                        "set --bounds to the runways' side of it")
        self.box = box_of([around[i] for i in (0, 2, 1, 3)])

    def chosen(self, posts: np.ndarray, corner: Sequence[float], spacing: float) -> List[Feature]:
        """The features of the scene on the ground of `posts`; others are added to `self.left`, with a reason."""
        found: List[Feature] = []
        outside: Dict[str, int] = collections.Counter()
        for one in [*self.runways, *(one for one in self.features
                                     if one.kind != "runway" or form_of(one.shape) != "line")]:
            if not (one.shape if one.shape.IsValid() else one.shape.ConvexHull()).Intersects(self.box):
                outside[one.kind] += one.count
                continue
            if "elevation" in one.tags and "height" not in one.tags:
                place = moved(one.shape.Centroid(), self.to_local).GetPoint_2D()
                above = float(one.tags["elevation"]) - self.origin[2] - height_at(posts, corner, spacing, place)
                if self.dem is None or not above > 0.0:
                    self.left.append(one.left("an elevation without --heights" if self.dem is None else "below ground"))
                    continue
                one.tags = {**one.tags, "height": f"{above:.3f}",
                            "height_source": f"{one.tags['height_source']}, elevation less that of the ground"}
            found.append(one)
        self.left += [Feature(kind, {}, count=count, reason="outside the scene") for kind, count in outside.items()]
        found, drawn = without_parts(found, self.known)
        self.left += [one.left("drawn by its parts") for one in drawn]
        self.cut = [one for one in found if CUT in one.tags]
        if any(one.kind == "runway" for one in self.cut):
            warnings.warn(f"{self.extract}: a runway is {CUT}, and ends there: cut the extract wider", RuntimeWarning,
                          stacklevel=3)
        return found

    def mapped(self, chosen: Sequence[Feature]) -> List[Tuple[Dict[str, Any], Any]]:
        """Properties for the scene file and shape of each feature. Flat areas, woods and lines end at the box."""
        rows = []
        for one in chosen:
            shape, rule = one.shape, self.known["kinds"][one.kind]
            ends = ("flat" in rule or "medium" in rule or form_of(shape) == "line") and one.kind != "runway"
            if ends and not self.box.Contains(shape):
                shape = valid(shape).Intersection(self.box)
            if shape is not None and not shape.IsEmpty():
                rows.append((properties_of(one, self.known), shape))
        return sorted(rows, key=lambda row: list(self.known["kinds"]).index(row[0]["kind"]))

    def posts(self) -> Tuple[np.ndarray, Sequence[float], float]:
        """Heights above the origin, the south-west corner (m) and the spacing. Also sets the height of the origin."""
        west, east, south, north = rectangle = np.add(self.rectangle, (-50.0, 50.0, -50.0, 50.0)).tolist()
        if self.dem is None:
            spacing, self.error = FLAT_SPACING, self.known["level_error"]
            posts = np.zeros(posts_of(rectangle, spacing))
            words = "heights: none given: the ground is level at 0 m (assumed), and curves as the Earth does"
        else:
            posts, spacing, here, words = read_heights(self.dem, self.origin, rectangle, self.known)
            self.origin, self.error = (*self.origin[:2], round(here, 3)), self.known["terrain_error"]
            posts = posts - self.origin[2]
        self.terrain_words = f"{words}; triangles within {self.error:g} m of these heights"
        return posts, (west, south), spacing

    def scene_of(self, position: Optional[np.ndarray] = None) -> Dict[str, Any]:
        """The scene file. @param position position of the lidar, m; None before a place is found"""
        objects: List[Dict[str, Any]] = [
            {"name": "Terrain", "class": "terrain", "file": "terrain.vtp", "material": "Grass"}]
        there = collections.Counter((row["kind"], row.get("surface")) for row in self.rows)
        for kind, rule in self.known["kinds"].items():
            for surface in sorted({surface for one, surface in there if one == kind}, key=str):
                of_surface = {"surface": surface} if surface else {}
                item = {"name": kind.replace("_", " ").capitalize() + (f" of {surface.lower()}" if surface else ""),
                        "class": rule["class"], "footprints": "airport.geojson",
                        "filter": {"kind": kind, **of_surface}, "on": "Terrain",
                        **({} if "medium" in rule else {"material": surface or rule["material"]}),
                        **{name: rule[name] for name in ("medium", "flat", "base", "width", "glazing") if name in rule}}
                if not rule.get("flat"):
                    item.update(height_attribute=height_name(rule), height=rule["height"])
                    if any(row["kind"] == kind and "min_height" in row for row in self.rows):
                        item["min_height_attribute"] = "min_height"
                if "width" in rule:
                    item["width_attribute"] = "width"
                if kind in ("runway", "terminal", "hangar", "tower"):
                    item.update(features="separate", name_attribute="ref" if kind == "runway" else "name")
                objects.append(item)
        used = {item.get("material") for item in objects}
        materials = {name: values for name, values in self.known["materials"].items() if name in used}
        lidar = {"lidar": {"position": [round(float(x), 3) for x in position]}} if position is not None else {}
        return {"version": 1, "comment": [f"{self.name}, from {self.extract.name}. README.txt says what is assumed.",
                                          self.terrain_words],
                "attribution": [f"Outlines: {self.extract.name}; of OpenStreetMap: (c) OpenStreetMap contributors, "
                                "ODbL 1.0, https://www.openstreetmap.org/copyright",
                                *(f"Obstacles: {file.name}" for file in self.obstacles)],
                "origin": dict(zip(("latitude", "longitude", "height"), self.origin)), **lidar,
                **({"materials": materials} if materials else {}), "objects": objects}

    def count(self, chosen: Sequence[Feature]) -> None:
        """Counts the features of each kind in the scene, without those that the scene's reader leaves out."""
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

    def exclusions(self, mapped: pathlib.Path) -> List[Tuple[Dict[str, Any], Any]]:
        """Areas beside buildings where no lidar may stand: around runways and taxiways, on aprons, roads and water, in
        woods, and outside the aerodrome if the extract has its outline."""
        rows = []
        if self.ground is not None:
            rows.append(({"what": "outside the aerodrome"}, self.box.Difference(self.ground)))
        for runway in self.sides:
            outline = np.column_stack([runway_outline(runway), np.zeros(4)])[[0, 1, 2, 3, 0]]
            ring = to_geodetic(outline, self.scene.geodetic_origin)[:, :2]
            rows.append(({"what": "around a runway", "name": runway.name}, geometry("Polygon", [ring])))
        for feature in features_of(mapped):
            properties = feature["properties"]
            kind = properties["kind"]
            if kind in ("taxiway", "apron", "road", "water", "wood", "scrub"):
                shape = ogr.CreateGeometryFromJson(json.dumps(feature["geometry"]))
                if form_of(shape) == "line":
                    beside = self.known["beside_taxiways"] if kind == "taxiway" else properties.get("width", 0.0) / 2
                    shape = moved(moved(shape, self.to_local).Buffer(beside), self.to_degrees)
                rows.append(({"what": kind}, shape))
        return rows

    def _bounds(self) -> List[float]:
        """Bounds of the runways and the area beside them: least and greatest x, y, m."""
        ends = ends_of(self.sides)
        low, high = ends.min(axis=0) - AROUND, ends.max(axis=0) + AROUND
        return [float(x) for x in np.round((low[0], high[0], low[1], high[1]), -1)]

    @property
    def leaves(self) -> bool:
        """Whether the scene has leaves. Clutter behind leaves takes seconds in each weather of a report."""
        return any("medium" in self.known["kinds"][row["kind"]] for row in self.rows)

    @property
    def longest(self) -> Runway:
        return max(self.sides, key=lambda runway: runway.axis()[1])

    def place_lidar(self, mapped: pathlib.Path, exclusions: pathlib.Path) -> None:
        """Finds a place for the lidar, for use until siting finds a better place: the free place nearest to the middle
        of the longest runway, below the obstacle limitation surfaces unless every free place pierces one of them."""
        taken = read_outlines(mapped, self.scene.geodetic_origin, "height")
        taken += read_outlines(exclusions, self.scene.geodetic_origin)
        with naming(f"{self.extract}: places for a lidar beside its runways"):
            free = candidates(lattice(self._bounds(), SPACINGS[-1]), (self.known["mast"],),
                              [(outline, 10.0) for outline in taken], self.scene)
        below = free[pierced([Surfaces.of(runway, self.scene) for runway in self.sides], free) == 0]
        self.pierces = len(below) == 0
        free = free if self.pierces else below
        area = len(free) * SPACINGS[-1] ** 2
        self.spacing = next((spacing for spacing in SPACINGS if area >= CHOICE * spacing**2), SPACINGS[-1])
        middle = np.mean([self.longest.start, self.longest.end], axis=0)
        self.position = free[np.argmin(np.linalg.norm(free[:, :2] - middle, axis=1))]

    def plan(self, siting_too: bool = False) -> Dict[str, Any]:
        """A plan of coverage. @param siting_too also where else lidars could stand"""
        plan: Dict[str, Any] = {
            "description": f"Where does a search lidar see herring gulls at {self.name}?",
            "scene": "airport.lidarscene.json", "sensor": {"preset": "Search905"},
            "coverage": {"species": "herring gull", "visibility": 23000}, "runways": "airport.geojson"}
        if siting_too:
            plan["description"] = f"Where should a search lidar stand to see herring gulls at {self.name}?"
            if self.leaves:
                plan["coverage"]["clutter"] = False
            plan["siting"] = {"bounds": self._bounds(), "spacing": self.spacing, "masts": [self.known["mast"]],
                              "margin": 10, "exclusions": ["exclusions.geojson"], "sensors": 3}
        return plan

    def scenario(self) -> Dict[str, Any]:
        """A scenario of labelled scans with birds around the lidar, and an aircraft on the longest runway."""
        x, y, z = (round(float(c), 1) for c in self.position)
        center = [x, y, round(z - self.known["mast"], 1)]
        ends = ends_of([self.longest])
        route = np.column_stack([ends, np.nan_to_num(ground_of(self.scene, ends))]).tolist()
        birds = [("Crossings", "herring gull", 8, 500, [2, 40]), ("Crossings", "crow", 8, 400, [2, 30]),
                 ("Circles", "kestrel", 4, 300, [5, 25]), ("Flock", "starling", 8, 250, [8, 20])]
        names = ("pattern", "species", "number_of_birds", "radius", "heights")
        return {
            "description": (f"Birds at {self.name}. "
                            "Kinds, numbers and flights of birds, the aircraft, sway and jitter are assumed."),
            "scene": "airport.lidarscene.json",
            "sensor": {"preset": "Search905", "sway_amplitude": 0.02, "sway_frequency": 0.5, "encoder_jitter": 0.01},
            "scan": {"attenuation_coefficient": 8.9e-5, "number_of_reflections": 1, "rays_per_beam": 400},
            "number_of_scans": 100, "scans_per_sequence": 100, "seed": 1,
            "birds": [{**dict(zip(names, group)), "center": center} for group in birds],
            "objects": [
                {"name": "Aircraft on the runway", "class": "aircraft", "material": "Metal", "speed": 40, "every": 150,
                 "boxes": [[-2, 2, -19, 19, 2, 6], [-17, 17, -3, 3, 2.5, 3.2], [-0.3, 0.3, -19, -14, 6, 12]],
                 "route": [[round(c, 1) for c in end] for end in route]}]}
