# SPDX-License-Identifier: BSD-3-Clause
"""The scene file, the exclusions, the place of the lidar, the plans and the scenario that follow from an airport's
features."""
from __future__ import annotations

import collections
import dataclasses
import functools
import json
import pathlib
import re
from typing import Any, Counter, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from osgeo import ogr

from ..._cloud import field_values
from ..._scene import Scene
from ..inputs._json import naming
from ..places._candidates import Surfaces, candidates, ground_of, lattice, pierced
from ..places._features import Feature, form_of, height_name
from ..places._gdal import geometry, moved
from ..places._geojson import read_outlines, to_geodetic
from ..places._regions import Runway, ends_of, runway_outline
from ._map import AirportMap

AROUND = 600.0  # distance from runways within which lidars may stand, m
SPACINGS, CHOICE = (200, 150, 100, 50), 30  # spacings of candidates, m; the widest that leaves CHOICE of them is used


class Place(NamedTuple):
    """A place for the lidar, and what follows from the free places around it."""
    position: np.ndarray    # m
    spacing: float          # spacing of the candidates of siting, m
    pierces: bool           # whether the lidar pierces an obstacle limitation surface


def scene_file(airport: AirportMap, rows: Sequence[Dict[str, Any]], ground: str,
               position: Optional[np.ndarray] = None) -> Dict[str, Any]:
    """The scene file. @param rows properties of the features of airport.geojson @param ground words on the heights
    @param position position of the lidar, m; None before a place is found"""
    objects: List[Dict[str, Any]] = [
        {"name": "Terrain", "class": "terrain", "file": "terrain.vtp", "material": "Grass"}]
    there = collections.Counter((row["kind"], row.get("surface")) for row in rows)
    for kind, rule in airport.known["kinds"].items():
        for surface in sorted({surface for one, surface in there if one == kind}, key=str):
            of_surface = {"surface": surface} if surface else {}
            item = {"name": kind.replace("_", " ").capitalize() + (f" of {surface.lower()}" if surface else ""),
                    "class": rule["class"], "footprints": "airport.geojson",
                    "filter": {"kind": kind, **of_surface}, "on": "Terrain",
                    **({} if "medium" in rule else {"material": surface or rule["material"]}),
                    **{name: rule[name] for name in ("medium", "flat", "base", "width", "glazing") if name in rule}}
            if not rule.get("flat"):
                item.update(height_attribute=height_name(rule), height=rule["height"])
                if any(row["kind"] == kind and "min_height" in row for row in rows):
                    item["min_height_attribute"] = "min_height"
            if "width" in rule:
                item["width_attribute"] = "width"
            if kind in ("runway", "terminal", "hangar", "tower"):
                item.update(features="separate", name_attribute="ref" if kind == "runway" else "name")
            objects.append(item)
    used = {item.get("material") for item in objects}
    materials = {name: values for name, values in airport.known["materials"].items() if name in used}
    lidar = {"lidar": {"position": [round(float(x), 3) for x in position]}} if position is not None else {}
    return {"version": 1, "comment": [f"{airport.name}, from {airport.extract.name}. README.txt says what is assumed.",
                                      ground],
            "attribution": [f"Outlines: {airport.extract.name}; of OpenStreetMap: (c) OpenStreetMap contributors, "
                            "ODbL 1.0, https://www.openstreetmap.org/copyright",
                            *(f"Obstacles: {file.name}" for file in airport.obstacles)],
            "origin": dict(zip(("latitude", "longitude", "height"), airport.origin)), **lidar,
            **({"materials": materials} if materials else {}), "objects": objects}


@dataclasses.dataclass(frozen=True)
class AirportScene:
    """An airport as its written files say, which a user may have edited."""

    map: AirportMap
    chosen: Sequence[Feature]           # features that were written to airport.geojson
    features: Sequence[Dict[str, Any]]  # features of airport.geojson
    ground: str                         # words on the heights
    scene: Scene
    sides: Sequence[Runway]

    @property
    def rows(self) -> List[Dict[str, Any]]:
        """Properties of the features of airport.geojson."""
        return [feature["properties"] for feature in self.features]

    @functools.cached_property
    def fates(self) -> Tuple[Counter[str], List[Feature]]:
        """The number of features of each kind in the scene, and the features that were left out, also by the scene's
        reader."""
        there, left = collections.Counter(self.map.used), list(self.map.left)
        for one in self.chosen:
            there[one.kind] += one.count
        kinds = {kind.replace("_", " "): kind for kind in self.map.known["kinds"]}
        report = "\n".join(field_values(self.scene.surfaces.GetBlock(0)).get("scene_report", ()))
        for name, count, reason in re.findall(r"^(.*?): (\d+) (.*) were left out(?:: .*)?$", report, re.MULTILINE):
            kind = kinds.get(name.split(" of ")[0].lower())
            if kind is not None:
                left.append(Feature(kind, {}, count=int(count), reason=reason))
                there[kind] -= int(count)
        return there, left

    def exclusions(self) -> List[Tuple[Dict[str, Any], Any]]:
        """Areas beside buildings where no lidar may stand: around runways and taxiways, on aprons, roads and water, in
        woods, and outside the aerodrome if the extract has its outline."""
        rows = []
        if self.map.outline is not None:
            rows.append(({"what": "outside the aerodrome"}, self.map.box.Difference(self.map.outline)))
        for runway in self.sides:
            outline = np.column_stack([runway_outline(runway), np.zeros(4)])[[0, 1, 2, 3, 0]]
            ring = to_geodetic(outline, self.scene.geodetic_origin)[:, :2]
            rows.append(({"what": "around a runway", "name": runway.name}, geometry("Polygon", [ring])))
        for feature in self.features:
            properties = feature["properties"]
            kind = properties["kind"]
            if kind in ("taxiway", "apron", "road", "water", "wood", "scrub"):
                shape = ogr.CreateGeometryFromJson(json.dumps(feature["geometry"]))
                if form_of(shape) == "line":
                    half = properties.get("width", 0.0) / 2
                    beside = self.map.known["beside_taxiways"] if kind == "taxiway" else half
                    shape = moved(moved(shape, self.map.to_local).Buffer(beside), self.map.to_degrees)
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
        return any("medium" in self.map.known["kinds"][row["kind"]] for row in self.rows)

    @property
    def longest(self) -> Runway:
        return max(self.sides, key=lambda runway: runway.axis()[1])

    def place_lidar(self, mapped: pathlib.Path, exclusions: pathlib.Path) -> Place:
        """Finds a place for the lidar, for use until siting finds a better place: the free place nearest to the middle
        of the longest runway, below the obstacle limitation surfaces unless every free place pierces one of them."""
        taken = read_outlines(mapped, self.scene.geodetic_origin, "height")
        taken += read_outlines(exclusions, self.scene.geodetic_origin)
        with naming(f"{self.map.extract}: places for a lidar beside its runways"):
            free = candidates(lattice(self._bounds(), SPACINGS[-1]), (self.map.known["mast"],),
                              [(outline, 10.0) for outline in taken], self.scene)
        below = free[pierced([Surfaces.of(runway, self.scene) for runway in self.sides], free) == 0]
        free = below if len(below) else free
        area = len(free) * SPACINGS[-1] ** 2
        spacing = next((one for one in SPACINGS if area >= CHOICE * one**2), SPACINGS[-1])
        middle = np.mean([self.longest.start, self.longest.end], axis=0)
        position = free[np.argmin(np.linalg.norm(free[:, :2] - middle, axis=1))]
        return Place(position, spacing, len(below) == 0)

    def plan(self, place: Place, siting_too: bool = False) -> Dict[str, Any]:
        """A plan of coverage. @param siting_too also where else lidars could stand"""
        plan: Dict[str, Any] = {
            "description": f"Where does a search lidar see herring gulls at {self.map.name}?",
            "scene": "airport.lidarscene.json", "sensor": {"preset": "Search905"},
            "coverage": {"species": "herring gull", "visibility": 23000}, "runways": "airport.geojson"}
        if siting_too:
            plan["description"] = f"Where should a search lidar stand to see herring gulls at {self.map.name}?"
            if self.leaves:
                plan["coverage"]["clutter"] = False
            plan["siting"] = {"bounds": self._bounds(), "spacing": place.spacing, "masts": [self.map.known["mast"]],
                              "margin": 10, "exclusions": ["exclusions.geojson"], "sensors": 3}
        return plan

    def scenario(self, place: Place) -> Dict[str, Any]:
        """A scenario of labelled scans with birds around the lidar, and an aircraft on the longest runway."""
        x, y, z = (round(float(c), 1) for c in place.position)
        center = [x, y, round(z - self.map.known["mast"], 1)]
        ends = ends_of([self.longest])
        route = np.column_stack([ends, np.nan_to_num(ground_of(self.scene, ends))]).tolist()
        birds = [("Crossings", "herring gull", 8, 500, [2, 40]), ("Crossings", "crow", 8, 400, [2, 30]),
                 ("Circles", "kestrel", 4, 300, [5, 25]), ("Flock", "starling", 8, 250, [8, 20])]
        names = ("pattern", "species", "number_of_birds", "radius", "heights")
        return {
            "description": (f"Birds at {self.map.name}. "
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
