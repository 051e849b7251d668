# SPDX-License-Identifier: BSD-3-Clause
"""The question that a plan of coverage asks, and the shares of birds that are detected."""
from __future__ import annotations

import contextlib
import functools
import math
import warnings
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np

from ... import vtkAvianLidar as _wrapped
from ..._cloud import leaves_of
from ..._coverage import Coverage, places_of
from ..._numbers import figures
from ..._pipeline import Error, update
from ..._properties import PropertyOwner
from ..._ranks import digest_of, digest_of_arrays
from ..._scene import Scene, load_scene
from ..._sensor import Sensor
from ..._weather import AIR, in_weather, weather
from ..inputs._air import Air, as_received
from ..inputs._json import naming
from ..inputs._on_sale import PLACE, idea
from ..inputs._read import sensor_name
from ..places._candidates import ground_of
from ..places._geojson import read_runways
from ..places._regions import Runway, by_kind, ends_of, places_by_region, region_heights, region_names
from ..sequences._scores import weighted
from ._looks import require_memory

HEIGHTS = (15.0, 30.0, 60.0, 150.0)  # default heights of maps, m
PLACES = 12000
AROUND_SENSOR = 1500.0  # distance that maps show to each side of the sensor, m
AROUND_ENDS = 300.0  # distance that maps show around the ends of runways, m
STEP_OF_EXTENT = 100.0  # step to which the extent of maps is rounded, m
FLAT = 0.5  # absolute z below which the ground counts as 0, m
MOST_PIXELS = 100_000_000  # greatest number of pixels of a map
OTHER_PLACES = 1 << 40  # offset of the seed for places that were not used to choose sites or designs
BYTES_OF_PLACE = 200  # memory for a drawn place and its results, bytes


@contextlib.contextmanager
def restored(owner: PropertyOwner, *names: str) -> Iterator[None]:
    """Gives attributes of a coverage or sensor their present values again afterwards, also after an error or Ctrl-C."""
    own = {name: getattr(owner, name) for name in names}
    try:
        yield
    finally:
        for name, value in own.items():
            setattr(owner, name, value)


class Plan:
    """The question that a plan of coverage asks.

    name           name of the sensor     heights  heights of the maps, m
    scene, sensor  loaded from files      runways  in the scene's coordinates
    coverage       Coverage for the maps
    regions        Coverage of places drawn in strips and approaches, or without runways on the maps
    members, ends  numbers of the places by kind of region (strips, approaches), and by single strip and approach
    mix            share of each species, with the sum 1; maps of reasons are for the first species, which has the
                   greatest share
    air            words of the plan's weather
    year           weathers by which sites are ranked, with their shares of the hours; empty if the plan gives no year
    asked          least and greatest height of the places, m; None if the plan has no `heights`, so that each region
                   has its own heights
    ground         z of the ground below the sensor, m; None without a ground
    """

    def __init__(self, plan: Dict[str, Any], threads: int = 0, scene: Optional[Scene] = None, member: str = "sensor"):
        """Checks all parts. `Error` names the plan's file and the member. @param member the name
        of the sensor's member of the plan, for errors"""
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
        lowest = min((leaf.GetBounds()[4] for leaf in leaves_of(self.scene.surfaces) if leaf.GetNumberOfPoints()),
                     default=-math.inf)
        if self.asked and self.asked[0] < min(lowest, self.sensor.position[2]):
            raise Error(f"{self.file}: heights: {self.asked[0]:g} m is below the sensor and all surfaces of the scene, "
                        f"whose lowest height is {lowest:g} m above the origin")
        self.air = tuple(plan.get("weather", ()))
        self.settings: Dict[str, Any] = {"number_of_threads": threads, **in_weather(plan.get("coverage", {}), self.air)}
        if self.air:
            with naming(f"{self.file}: weather"):
                given = {name: self.settings[name] for name in AIR if name in self.settings}
                self.settings.update(self.air_of(**given))
        with naming(f"{self.file}: year"):
            self.year = [Air(tuple(part["weather"]), float(part["share"]), self.air_of(part["weather"]))
                         for part in plan.get("year", ()) if part["share"] > 0.0]
        if self.asked and self.asked[0] < self.asked[1]:
            self.settings.setdefault("height_limits", sorted(self.heights))
        if member == "sensor":  # other members use these of the first plan
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
            self.points, self.ends = self.places(self.seed)
        self.members = by_kind(self.ends)
        every: Dict[str, Any] = {"all_species": True, **self.settings}
        self.regions = Coverage(self.scene, self.sensor, places=places_of(self.points, self.members), **every)
        x, y, _ = self.sensor.position
        ground = ground_of(self.scene, [(x, y)])[0]
        self.ground = None if np.isnan(ground) else float(ground)

    def _try(self, member: str, **changes: Any) -> None:
        """`Error` if coverage refuses settings at one place of an empty scene."""
        with naming(f"{self.file}: {member}"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings are shown during the work
            Coverage(Scene(), self.sensor, places=[(0.0, 0.0, 0.0)], **{**self.settings, **changes}).update()

    def air_of(self, words: Sequence[str] = (), **air: Any) -> Dict[str, Any]:
        """Settings of coverage in a weather. Without a word on visibility, the plan's visibility is used; without rain,
        the air is dry.

        words  words as for `--weather`
        air    settings in place of words, such as rain_rate=0 (mm/h)
        """
        default = _wrapped.vtkAvianLidarCoverage()
        own = {"attenuation_coefficient": default.GetAttenuationCoefficient(), "visibility": default.GetVisibility(),
               "air_backscatter": False}
        given = {name: value for name, value in self.plan.get("coverage", {}).items() if name in own}
        return as_received(self.sensor, {**own, **given, "rain_rate": 0.0, **weather(words), **air})

    def _mix(self) -> Dict[str, float]:
        mix = self.plan.get("mix") or {Coverage(Scene(), self.sensor, **self.settings).species: 1.0}
        total = float(sum(mix.values()))
        if not 0.0 < total < math.inf:
            raise Error(f"{self.file}: mix: is {mix}, expected numbers from 0 with a sum above 0")
        return {name: share / total for name, share in sorted(mix.items(), key=lambda item: -item[1]) if share > 0.0}

    def _extent(self) -> Tuple[float, float, float, float]:
        """Extent of the maps: surroundings of the sensor and of the runways' ends."""
        x, y, _ = self.sensor.position
        ends = ends_of(self.runways)
        low = np.min([(x - AROUND_SENSOR, y - AROUND_SENSOR), *(ends - AROUND_ENDS)], axis=0)
        high = np.max([(x + AROUND_SENSOR, y + AROUND_SENSOR), *(ends + AROUND_ENDS)], axis=0)
        if len(ends):
            low, high = STEP_OF_EXTENT * np.floor(low / STEP_OF_EXTENT), STEP_OF_EXTENT * np.ceil(high / STEP_OF_EXTENT)
        return low[0], high[0], low[1], high[1]

    def at(self, position: Sequence[float], title: str, seed: Optional[int] = None, **changes: Any) -> Plan:
        """The plan with the sensor at another place, on the same maps. @param position m @param title title of pictures
        and tables @param seed seed of the places, default the same @param changes properties of the sensor"""
        sensor = {**self.plan["sensor"], "name": self.name, **changes, "position": [float(c) for c in position]}
        other = Plan({**self.plan, "extent": self.extent, "seed": self.seed if seed is None else seed,
                      "sensor": sensor}, self.threads, self.scene, "siting")
        other.title = title
        return other

    def with_lidar(self, preset: str) -> Plan:
        """The plan with another lidar at the same place."""
        place = {name: [float(c) for c in getattr(self.sensor, name)] for name in PLACE}
        return Plan({**self.plan, "sensor": {"preset": preset, **place}}, self.threads, self.scene, "siting")

    @property
    def idea(self) -> str:
        """A sentence if nobody sells the plan's sensor, else empty."""
        return idea(self.name, self.sensor, self.plan["sensor"])

    def _check_maps(self) -> None:
        x0, x1, y0, y1 = self.extent
        if not (x0 <= x1 and y0 <= y1):
            raise Error(f"{self.file}: extent: is {list(self.extent)}, "
                        "expected least and greatest x, least and greatest y")
        pixels = ((x1 - x0) / self.spacing + 1.0) * ((y1 - y0) / self.spacing + 1.0)
        if not pixels <= MOST_PIXELS:
            raise Error(f"{self.file}: spacing: is {self.spacing:g} m, which makes maps of {figures(pixels, 3)} "
                        f"pixels, expected at most {MOST_PIXELS:,}: take a larger spacing or a smaller extent")

    def _runways(self) -> List[Runway]:
        if self.scene.geodetic_origin is None:
            raise Error(f"{self.plan['scene']}: has no origin, expected latitude and longitude, "
                        "because runways are given in degrees")
        return read_runways(self.plan["runways"], self.scene.geodetic_origin)

    def decides(self) -> Any:
        """Everything that decides the results: the plan without its own name, surfaces, beams and places."""
        update(self.scene.tree)
        return ({name: part for name, part in self.plan.items() if name != "file"},
                digest_of(self.scene.tree.GetOutput()), digest_of_arrays(self.sensor.beams.data), self.points.tobytes())

    def places(self, seed: int) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
        """The places for shares, n x 3, m, and their numbers in each strip and in the approach to each end."""
        require_memory(BYTES_OF_PLACE * self.count, f"{self.count:,} places", "take fewer")
        if self.runways:
            return places_by_region(self.runways, self.count, seed, self.plan.get("regions"), self.asked, self.spread)
        low, high = np.transpose([self.extent[:2], self.extent[2:], (min(self.heights), max(self.heights))])
        return np.random.default_rng(seed).uniform(low, high, (self.count, 3)), {"map": np.arange(self.count)}

    def weights(self, points: np.ndarray) -> np.ndarray:
        """The weight of each place (n x 3) for each species, as in the table: species x places, with the sum 1."""
        density = (Coverage.strike_height_density(points[:, 2]) if self.regions.strike_height_weights else
                   np.ones(len(points)))
        return np.outer(list(self.mix.values()), density / density.sum())

    @classmethod
    def all_of(cls, plan: Dict[str, Any], threads: int = 0) -> List[Plan]:
        """The plan with its sensor, then with each sensor for comparison."""
        plans = [cls(plan, threads)]
        place = {name: value for name, value in plan["sensor"].items() if name in PLACE}
        for number, other in enumerate(plan.get("compare_with", ())):
            member = f"compare_with[{number}]"
            plans.append(cls({**plan, "sensor": {**place, **other}}, threads, plans[0].scene, member))
            if plans[-1].name in [before.name for before in plans[:-1]]:
                raise Error(f"{plans[0].file}: {member}: {plans[-1].name!r} is there twice, "
                            "expected a different `name`")
        return plans

    @property
    def spread_words(self) -> str:
        """Words on the distribution of places over strips and approaches."""
        each = "square metre of" if self.spread == "area" else "metre along"
        return f"equally many on each {each} the {' and '.join(self.members)}"

    @property
    def where(self) -> str:
        """Words on the places of the shares."""
        low, high = min(self.heights), max(self.heights)
        heights = f", {low:g} to {high:g} m" if high > low else f" at {low:g} m"
        if not self.runways:
            return f"on the map{heights}"
        names_of = region_names(self.runways)
        there = {kind: kind if set(names_of[kind]) <= self.ends.keys() else
                 ", ".join(name for name in names_of[kind] if name in self.ends) for kind in self.members}
        if self.asked:
            return f"in {' and '.join(there.values())}{heights + ' high' if high > low else ',' + heights}"
        return "in " + " and ".join(f"{words} (to {figures(self.heights_of(kind)[1], 3)} m high)"
                                    for kind, words in there.items())

    def heights_of(self, region: str) -> Tuple[float, float]:
        """Least and greatest height of the places of a region, m; for any other name, of all places."""
        if not self.runways:
            return min(self.heights), max(self.heights)
        lows, highs = zip(*(region_heights(name, self.asked)
                            for name in ([region] if region in self.members else self.members)))
        return min(lows), max(highs)

    @property
    def bird(self) -> str:
        """The bird or birds of the plan, in words."""
        if len(self.mix) == 1:
            return next(iter(self.mix)) or "target"
        return "bird (" + ", ".join(f"{name or 'target'} {100 * share:.3g} %" for name, share in self.mix.items()) + ")"

    @property
    def above(self) -> str:
        """The level from which heights are measured, in words."""
        return "ground" if self.ground is not None and abs(self.ground) < FLAT else "the scene's origin"

    @property
    def assumed(self) -> Tuple[str, ...]:
        """Properties of the sensor whose numbers are assumed, by the sensor's file or because the plan sets them."""
        changed = [name for name in self.plan["sensor"] if name not in ("preset", "name", *PLACE)]
        return (*self.sensor.beams.fields.get("assumed", ()), *self.sensor.not_given, *changed)

    def map_at(self, height: float) -> Coverage:
        """Coverage of the plan's extent at a height, m, for the first species."""
        self.coverage.set(bounds=(*self.extent, height, height), species=next(iter(self.mix)))
        return self.coverage

    def mixed(self, cover: Coverage, name: str = "detection_probability") -> np.ndarray:
        """The mean of an array over the plan's species."""
        total: Any = 0.0
        with restored(cover, "species"):
            for species, share in reversed(self.mix.items()):  # the first is usually the species of `cover`
                cover.species = species
                total = total + share * cover[name]
        return total

    @functools.cached_property
    def shares(self) -> List[Dict[str, Any]]:
        """Rows of shares of the regions: rows of each species, then rows of the mix. Standard errors of the mix are
        upper bounds from the errors of the species."""
        rows = self.regions.table
        of_species = [[row for row in rows if row["species"] == species] for species in self.mix]
        return rows + self._of_mix(of_species) * (len(self.mix) > 1)

    def _of_mix(self, of_species: Sequence[List[Dict[str, Any]]]) -> List[Dict[str, Any]]:
        """Rows of the mix. @param of_species rows of each species"""
        if len(self.mix) == 1:
            return of_species[0]
        names = [name for name, value in of_species[0][0].items()
                 if isinstance(value, float) and not name.startswith("height_")]
        return [{**same[0], "species": self.bird,
                 **{name: sum(share * row[name] for share, row in zip(self.mix.values(), same)) for name in names}}
                for same in zip(*of_species)]

    def in_airs(self, airs: Sequence[Dict[str, Any]]) -> List[List[Dict[str, Any]]]:
        """For each air, the rows of shares of all heights for the plan's birds: each region, and finally all places. No
        line of sight is traced again. @param airs settings of coverage, as from `air_of`"""
        regions, found = self.regions, []
        with restored(regions, "all_species", "species", *airs[0]):
            regions.all_species = False
            for species in self.mix:
                regions.species = species
                found.append([[row for row in regions.set(**air).table
                               if math.isinf(row["height_from"]) and math.isinf(row["height_to"])] for air in airs])
        return [*map(self._of_mix, zip(*found))]

    @functools.cached_property
    def by_end(self) -> List[Dict[str, Any]]:
        """A row for each strip and the approach to each end: the share of all heights for the plan's birds, with the
        standard error as in the table."""
        weights = self.weights(self.points).sum(axis=0)
        values = {name: self.mixed(self.regions, f"{name}_probability") for name in ("detection", "track")}
        rows = []
        for region, members in self.ends.items():
            row: Dict[str, Any] = {"region": region, "species": self.bird, "places": len(members)}
            for name, p in values.items():
                row[f"{name}_probability"], row[f"{name}_std_error"], _ = weighted(p[members], weights[members])
            rows.append(row)
        return rows

    @property
    def overall(self) -> Dict[str, Any]:
        """The row of shares of all places and heights, for the plan's birds."""
        name = self.bird if len(self.mix) > 1 else next(iter(self.mix))
        return next(row for row in reversed(self.shares) if row["species"] == name and row["height_from"] == -math.inf)
