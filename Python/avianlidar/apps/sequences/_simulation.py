# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a scenario one after the other, with the true state of each bird."""
from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import math
import os
import warnings
from typing import Any, Dict, Iterator, List, Optional, Tuple, Union

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkFieldData, vtkMultiBlockDataSet, vtkPolyData

from ... import vtkAvianLidar as _wrapped
from ..._cloud import Cloud, add_array, field_values, leaves_of
from ..._numbers import figures
from ..._pipeline import Error, Updates, callers_level, update
from ..._properties import set_properties
from ..._scan import Scan
from ..._scene import Scene, load_scene, mesh, mover
from ..._sensor import Sensor, poses_of, trajectory
from ..._weather import in_weather
from ..inputs._air import check_received, scatters
from ..inputs._json import naming
from ..inputs._read import checked, read_scenario
from ._flights import FAR, SETTINGS, Flights, least_distance, origin_of, read_flights
from ._labels import BIRD, FIRST_BIRD, FIRST_OBJECT, LAST_ID, classes_of
from ._logs import as_time, seconds_of
from ._trajectory import read_trajectory

SUBSETS = ("sky", "near_clutter", "through_edges")
STATUSES = ("absent", "outside", "hidden", "air", "too weak", "missed", "seen")
TRUTH = ("scan", "bird", "species", "status", "subset", "time_s", "x_m", "y_m", "z_m", "range_m", "azimuth_deg",
         "elevation_deg", "effective_area_m2", "beams", "expected_energy_J", "expected_photoelectrons",
         "expected_probability", "points", "clutter_distance_m", "clutter_share",
         "first_time_s", "first_x_m", "first_y_m", "first_z_m", "last_time_s", "last_x_m", "last_y_m", "last_z_m",
         "visibility_m", "rain_mm_h", "clear_probability", "track")
SPAN = 2.0  # m, of the largest birds
AIR = -2  # object_id of echoes of the air
WEAK = 0.1  # probability of detection below which a bird counts as too weak
LONGEST = 1e9  # greatest time of a route and greatest start time of an object, s


class Clutter:
    """The static echoes of every beam, without noise, and the clutter before or behind a point of the same beam.

    A point is in the subset `sky` if its beam has no static echo; in `through_edges` if a static echo lies more than
    `near` metres before the point, so that the beam continues past an edge; else in `near_clutter`."""

    def __init__(self, scan: Scan, near: float):
        echoes = scan.echoes
        order = np.lexsort((echoes["distance_m"], echoes["beam_id"]))
        order = order[echoes["object_id"][order] != AIR]  # echoes of the air are not clutter
        self.beams, self.ranges = echoes["beam_id"][order], echoes["distance_m"][order]
        self.energies, self.near = echoes["energy_received"][order], near

    def look(self, beams, ranges) -> Tuple[np.ndarray, np.ndarray]:
        """(distance to the nearest static echo of the same beam, m, infinite without one; index in SUBSETS)."""
        beams, ranges = np.asarray(beams), np.asarray(ranges)
        distance = np.full(len(beams), np.inf)
        begin, end = np.searchsorted(self.beams, beams, "left"), np.searchsorted(self.beams, beams, "right")
        for k in range(int((end - begin).max(initial=0))):
            has = begin + k < end
            distance[has] = np.minimum(distance[has], np.abs(ranges[has] - self.ranges[begin[has] + k]))
        first = np.append(self.ranges, np.inf)[np.where(begin < end, begin, -1)]  # first static echo of each beam
        return distance, np.where(ranges - first > self.near, 2, begin < end).astype(np.uint8)

    def energy(self, beam: int) -> float:
        """Energy of all static echoes of a beam, J."""
        return float(self.energies[slice(*np.searchsorted(self.beams, [beam, beam + 1]))].sum())


class Simulation:
    """Birds, objects and scans of a scenario."""

    def __init__(self, scenario: Union[str, "os.PathLike[str]", Dict[str, Any]], threads: int = 0, **changes: Any):
        """Prepares a scenario without making scans.

        scenario  a file (keys and units: scenario.schema.json), the manifest of another sequence, or a result of
                  `read_scenario`
        threads   number of threads of this process, 0: all cores
        changes   changes of keys of the scenario, for example number_of_scans
        """
        self.file = "scenario" if isinstance(scenario, dict) else os.fspath(scenario)
        known = scenario if isinstance(scenario, dict) else read_scenario(scenario)
        self.scenario = checked({**known, **changes}, self.file)
        self.near = float(self.scenario.get("near_clutter_distance", 15.0))
        self.scans = int(self.scenario["number_of_scans"])
        self.scans_to_do = 0  # number of scans of this process, known after `write` has read the folder
        self.length, self.seed, self.bird_class = (int(self.scenario.get(name, default)) for name, default in (
            ("scans_per_sequence", 100), ("seed", 0), ("bird_class", BIRD)))
        with naming(self.file):
            classes_of(self.bird_class)
        with naming(f"{self.file}: scene"):
            self.scene = load_scene(self.scenario["scene"])
            update(self.scene.tree)
        if len(self.scene.objects) > FIRST_OBJECT:
            raise Error(f"{self.scenario['scene']}: has {len(self.scene.objects)} objects, "
                        f"expected at most {FIRST_OBJECT}: labels hold no more")
        self.trajectory = self._read_trajectory()
        place = (0, 0, 0) if self.trajectory else self.scene.lidar_position or (0, 0, 0)
        sensor: Dict[str, Any] = {"position": place, "motion_seed": self.seed,
                                  **self.scenario["sensor"], "number_of_revolutions": self.scans}
        with naming(f"{self.file}: weather"):
            air = in_weather(self.scenario.get("scan", {}), self.scenario.get("weather"))
        settings: Dict[str, Any] = {"seed": self.seed, **air, "number_of_threads": threads}
        with naming(f"{self.file}: sensor"):
            self.sensor = Sensor(**sensor, trajectory=self.trajectory)
            last = functools.partial(self.sensor.algorithm.UpdateTimeStep, (self.scans - 1) / self.sensor.rotation_rate)
            for run in (last, None) if self.trajectory else (None,):
                update(self.sensor.algorithm, run=run)
        self.place, self.way = np.array(self.sensor.position), 0.0  # middle and half length of the sensor's way, m
        if self.trajectory:
            low, high = np.reshape(self.trajectory.GetBounds(), (3, 2)).T
            self.place, self.way = (low + high) / 2, float(np.linalg.norm(high - low) / 2)
        with naming(f"{self.file}: scan"):
            self.scan = Scan(self.scene, self.sensor, **settings)
        with naming(self.file):
            check_received(self.scan, "the sensor", 'the preset "Search905"')
        self.scan.set(report_movers=True)
        media = field_values(self.scene.tree.GetOutput()).get("media", ())
        crowns = [text for text in media if "leaf_area_density" in json.loads(text)]
        self.clear = self.bare = self.scan  # scans without air that scatters, and without crowns of trees
        others = dict(settings)
        if scatters(self.scan) or len(crowns) < len(media):
            others.update(visibility=0.0, air_backscatter=False, rain_rate=0.0)
            self.clear = self.bare = self._in_media(crowns, others)
        if crowns:
            self.bare = self._in_media([], others)
        self.tracks: Dict[int, str] = {}  # ids in files of the birds of the current sequence
        sensor.update(number_of_revolutions=1, sway_amplitude=0.0, encoder_jitter=0.0)
        self.mount = Sensor(**sensor)  # on its platform, which stands still
        self.at_rest = Sensor(**sensor, trajectory=self.trajectory) if self.trajectory else self.mount
        self.flights = self._read_flights()
        self._moving(0, said=True)  # errors of birds and objects are raised before the work
        # Clutter without the effects that differ from scan to scan.
        settings["noise"] = False
        with naming(f"{self.file}: scan"):
            self._still = Scan(self.scene, self.at_rest, **settings)
            self.clutter = Clutter(self._still, self.near)

    def _in_media(self, media: List[str], settings: Dict[str, Any]) -> Scan:
        """A scan for comparison, of the scene's surfaces with other media."""
        scan = Scan(self.scene, self.sensor, **settings)
        scan.set(report_movers=True, noise=False)
        surfaces = vtkPolyData()
        surfaces.ShallowCopy(self.scene.tree.GetOutput())
        add_array(surfaces.GetFieldData(), "media", media)
        scan.algorithm.SetSurfacesData(surfaces)
        return scan

    def __len__(self) -> int:
        """Number of sequences."""
        return -(-self.scans // self.length)

    def span(self, number: int) -> range:
        """The scans of a sequence."""
        return range(number * self.length, min((number + 1) * self.length, self.scans))

    def _read_trajectory(self) -> Optional[vtkPolyData]:
        """The trajectory of the platform, or None. Its start becomes the time of the first scan if nothing else says
        this time."""
        given = dict(self.scenario.get("trajectory", {}))
        if not given:
            return None
        with naming(f"{self.file}: trajectory"):
            line = read_trajectory(given.pop("file_name"), scene=self.scene, **given)
        start = field_values(line).get("start_time")
        if start is not None and "start_time" in self.scenario and "start_time" not in given:
            with naming(f"{self.file}: start_time"):
                places, times, turns = poses_of(line)
                line = trajectory(places, times + start - seconds_of(self.scenario["start_time"]), turns)
        elif start is not None:
            self.scenario.setdefault("start_time", as_time(start))
        return line

    def _read_flights(self) -> Dict[int, Flights]:
        """The tracks of files, by the place of their group in the scenario. Warnings name files whose birds are not
        under way during the scans or are far away."""
        found: Dict[int, Flights] = {}
        for place, group in enumerate(self.scenario.get("birds", ())):
            if group["pattern"] == "File":
                with naming(f"{self.file}: birds[{place}]"):
                    given = {name: group[name] for name in (*SETTINGS, "species", "species_file_name") if name in group}
                    if not given.get("file_name"):
                        raise Error("file_name is missing, expected a file of tracks")
                    if "origin" in given:
                        given["origin"] = origin_of(given["origin"])
                    found[place] = read_flights(given.pop("file_name"), scene=self.scene, **given)
        dated, end = [one for one in found.values() if one.since_1970], self.scans / self.sensor.rotation_rate
        if "start_time" in self.scenario and not dated and not self.trajectory and all(len(one.times) for one in found.values()):
            raise Error(f"{self.file}: start_time: is given, but no file of birds has times since 1970")
        with naming(f"{self.file}: start_time"):
            if any(len(one.times) for one in dated):
                self.scenario.setdefault("start_time", as_time(min(one.times.min(initial=np.inf) for one in dated)))
                start = seconds_of(self.scenario["start_time"])
                for one in dated:
                    one.times -= start
        for place, one in found.items():
            if one.warning:
                self._warn(one.warning)
            away = one.nearest(self.place, 0.0, end)
            if len(one.times) == 0:
                self._warn(f"{one.file}: holds no track of two or more positions")
            elif len(away) == 0:
                self._warn(f"{one.file}: no track is under way in the {end:.0f} s of the scans: {self.period(one)}; "
                           f"choose {'start_time or ' * one.since_1970}number_of_scans")
            elif away.min() > FAR:
                origin = self._origin(place)
                self._warn_of_far(one.file, away, one.mistake(self.place, origin))
            else:
                self._warn_of_far(one.file, away)
                self._warn_of_levels(one, end, self._origin(place))
        return found

    def _origin(self, place: int) -> Any:
        """The origin of a group with a file: latitude, longitude (deg) and height (m)."""
        group = self.scenario["birds"][place]
        return origin_of(group["origin"]) if "origin" in group else self.scene.geodetic_origin

    def period(self, flights: Flights) -> str:
        """Words on the time in which tracks of a file are under way."""
        if not len(flights.times):
            return "no time"
        times = flights.times.min(), flights.times.max()
        if not flights.since_1970:
            return f"from {times[0]:.1f} to {times[1]:.1f} s after the first scan"
        start = seconds_of(self.scenario["start_time"])
        return f"from {as_time(start + times[0])} to {as_time(start + times[1])}; first scan at {as_time(start)}"

    def _warn_of_far(self, what: str, away, why: str = "") -> None:
        """Warns of birds that never come within the range gate. @param away their least distances, m"""
        far = away[away > self.sensor.range_gate + self.way]
        if len(far):
            least, most = (f"{x:.0f} m" if x < 9999.5 else f"{x / 1000:,.0f} km" for x in (far.min(), far.max()))
            who = "the bird never comes" if len(away) == 1 else f"{len(far)} of {len(away)} birds never come"
            self._warn(f"{what}: {who} within the lidar's range gate of {figures(self.sensor.range_gate)} m: "
                       f"{'it passes' if len(far) == 1 else 'they pass'} the lidar at "
                       f"{least}{f' to {most}' if least != most else ''}{why and '; '}{why}")

    def _warn_of_levels(self, flights: Flights, end: float, origin: Any) -> None:
        """Warns if all birds in the range gate of a level sensor stay above or below its beams, until a time (s)."""
        off, count = flights.within(self.sensor.position, self.sensor.range_gate, end)
        if count == 0 or any(self.sensor.orientation[1:]) or self.trajectory:
            return
        from ...reach import band
        lowest, highest = band(self.at_rest)
        away = np.maximum(np.linalg.norm(off, axis=1), 1e-3)
        up, size = np.degrees(np.arcsin(np.clip(off[:, 2] / away, -1.0, 1.0))), np.degrees(np.minimum(SPAN / away, 1.0))
        for side, least, nearest in (("above", (up - size).min() - highest, up.argmin()),
                                     ("below", lowest - (up + size).max(), up.argmax())):
            if least > 0.0:
                gate = figures(self.sensor.range_gate)
                words = f" and the height of the scene's origin ({origin[2]:g} m)" if origin is not None else ""
                self._warn(f"{flights.file}: {'the one bird' if count == 1 else f'all {count} birds'} within the range "
                           f"gate of {gate} m {'stays' if count == 1 else 'stay'} {side} the beams "
                           f"({lowest:.1f} to {highest:.1f} deg): the {'lowest' if side == 'above' else 'highest'} "
                           f"elevation is {up[nearest]:.1f} deg, {abs(off[nearest, 2]):.0f} m "
                           f"{'above' if off[nearest, 2] >= 0.0 else 'below'} the lidar; check height_reference "
                           f"(heights count from the {flights.level or 'origin'}){words}")

    @staticmethod
    def _warn(text: str) -> None:
        warnings.warn(text, RuntimeWarning, stacklevel=callers_level())

    def _moving(self, number: int, said: bool = False) -> Tuple[vtkMultiBlockDataSet, Dict[int, str]]:
        """The moving birds and other objects in a sequence, and the species of the birds by id. @param said warn of
        birds that patterns place far away"""
        scans, rate = self.span(number), self.sensor.rotation_rate
        time = scans.start / rate, scans.stop / rate
        birds, species = self._flights(number, time, said)
        blocks = vtkMultiBlockDataSet()
        for k, block in enumerate(birds + self._objects(*time)):
            blocks.SetBlock(k, block)
        return blocks, species

    def _flights(self, number: int, time: Tuple[float, float], said: bool) -> Tuple[List[vtkPolyData], Dict[int, str]]:
        """Birds of a sequence, and their species by id."""
        blocks: List[vtkPolyData] = []
        species: Dict[int, str] = {}
        self.tracks = {}
        for place, group in enumerate(self.scenario.get("birds", ())):
            tracks = _wrapped.vtkAvianLidarTracks()
            if place in self.flights:
                lines, ids = self.flights[place].lines(*time)
                self.tracks.update(enumerate(ids, FIRST_BIRD + len(blocks)))
                tracks.SetInputData(lines)
                group = {**{name: value for name, value in group.items() if name not in SETTINGS}, "pattern": "Lines"}
            seed = hashlib.sha256(json.dumps((self.seed, number, place)).encode()).digest()[:4]
            ours = {"time_range": time, "first_object_id": FIRST_BIRD + len(blocks),
                    "seed": int.from_bytes(seed, "little", signed=True), **group}
            with naming(f"{self.file}: birds[{place}]"):
                set_properties(tracks, "vtkAvianLidarTracks", **ours)
                update(tracks)
            found = list(leaves_of(tracks.GetOutput()))
            for block in found:
                species[FIRST_BIRD + len(blocks)] = field_values(block)["species"][0]
                blocks.append(block)
            if said and place not in self.flights:
                self._warn_of_far(f"{self.file}: birds[{place}]", np.array(
                    [least_distance(field_values(block)["pose_position"], self.place) for block in found]))
            if len(blocks) > LAST_ID - FIRST_BIRD:
                raise Error(f"{self.file}: birds: {len(blocks)} and more, "
                            f"expected at most {LAST_ID - FIRST_BIRD}: labels hold no more")
        return blocks, species

    def _objects(self, begin: float, end: float) -> List[vtkPolyData]:
        """Other objects that move at some time between begin and end, s."""
        blocks: List[vtkPolyData] = []
        for place, thing in enumerate(self.scenario.get("objects", ())):
            route = np.array(thing["route"], float)
            legs = np.diff(route, axis=0)
            lengths = np.linalg.norm(legs, axis=1)
            if (lengths < 1e-5 * thing["speed"]).any():
                raise Error(f"{self.file}: objects[{place}].route: two points that follow each other are the same")
            with np.errstate(all="ignore"):
                times = np.concatenate([[0.0], np.cumsum(lengths) / thing["speed"]])
            first, every = float(thing.get("first", 0)), float(thing.get("every", math.inf))
            if not times[-1] <= LONGEST or abs(first) > LONGEST:
                raise Error(f"{self.file}: objects[{place}]: is under way from {first:g} s for {times[-1]:g} s, "
                            f"expected at most {LONGEST:g} s")
            most = FIRST_BIRD - FIRST_OBJECT
            too_many = Error(f"{self.file}: objects[{place}].every: "
                             f"more than {most} objects would be under way in one sequence")
            if every * most < times[-1] + end - begin:
                raise too_many
            start = first
            if math.isfinite(every) and begin - times[-1] > first:
                start = first + every * math.ceil((begin - times[-1] - first) / every)
            while start < end:
                if len(blocks) == most:
                    raise too_many
                with naming(f"{self.file}: objects[{place}]"):
                    blocks.append(self._under_way(thing, route, legs, start + times, FIRST_OBJECT + len(blocks)))
                start += every
        return blocks

    @staticmethod
    def _under_way(thing: Dict[str, Any], route, legs, times, number: int) -> vtkPolyData:
        sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        corners = [(box[x], box[2 + y], box[4 + z]) for box in thing["boxes"] for x, y, z in np.ndindex(2, 2, 2)]
        triangles = [(at + a, at + b, at + c) for at in range(0, len(corners), 8) for a, *rest in sides
                     for b, c in zip(rest, rest[1:])]
        scene = Scene((np.array(corners, float), triangles), material=thing.get("material", "Metal"))
        update(scene.tree)
        surface = vtkPolyData()
        surface.ShallowCopy(scene.tree.GetOutput())
        surface.SetFieldData(vtkFieldData())
        surface.GetFieldData().AddArray(scene.tree.GetOutput().GetFieldData().GetAbstractArray("material_names"))
        add_array(surface.GetCellData(), "object_id", np.full(surface.GetNumberOfCells(), number, np.int32))
        add_array(surface.GetFieldData(), "object_names", [thing["name"]])
        add_array(surface.GetFieldData(), "object_classes", [thing.get("class", "vehicle")])
        # The object turns where two legs meet: each leg has one heading and two poses.
        heading = np.arctan2(legs[:, 0], legs[:, 1])
        turn = np.stack([np.cos(heading / 2), 0 * heading, 0 * heading, -np.sin(heading / 2)], axis=1)
        when = np.repeat(times, 2)[1:-1]
        when[2::2] += 1e-6
        return mover(surface, np.repeat(route, 2, axis=0)[1:-1], when, np.repeat(turn, 2, axis=0))

    def frames(self, number: int) -> Iterator[Tuple[int, Scan, Dict[int, str]]]:
        """The scans of a sequence: (number, the scan in its state at that time, species of the birds by id)."""
        movers, species = self._moving(number)
        scans = [*dict.fromkeys((self.scan, self.clear, self.bare))]
        for scan in scans:
            scan.movers = movers
        # Beams of rotating prisms and of a sensor that moves differ from scan to scan.
        differ = self.sensor.algorithm.GetNumberOfPrisms() > 0 or self.trajectory is not None
        with contextlib.ExitStack() as stack:
            runs = [(stack.enter_context(Updates(scan.algorithm)), scan.algorithm.UpdateTimeStep)
                    for scan in scans + [self._still] * differ]
            for k in self.span(number):
                for run, step in runs:
                    run(functools.partial(step, k / self.sensor.rotation_rate))
                if differ:
                    self.clutter = Clutter(self._still, self.near)
                yield k, self.scan, species

    def truth(self, k: int, species: Dict[int, str]) -> List[List[Any]]:
        """A row of `TRUTH` for each bird, for the current state of the scan."""
        return [[*row.values()] for row in self._truth(k, species)]

    def _truth(self, k: int, species: Dict[int, str]) -> List[Dict[str, Any]]:
        """The rows of `truth`, with the names of the columns."""
        weather = {"visibility_m": f"{self.scan.visibility:g}" if self.scan.visibility > 0.0 else "",
                   "rain_mm_h": f"{self.scan.rain_rate:g}"}
        rows: Dict[int, Dict[str, Any]] = {
            bird: {**dict.fromkeys(TRUTH, ""), "scan": k, "bird": bird, "species": name, "status": "absent", "beams": 0,
                   "points": 0, **weather, "track": self.tracks.get(bird, "")} for bird, name in species.items()}
        report = Cloud(self.scan.algorithm.GetOutput(2))
        if report.number_of_points == 0:
            return list(rows.values())
        without, bare = (dict(zip(found["object_id"], zip(found["energy_received"], found["detection_probability"])))
                         for found in (Cloud(scan.algorithm.GetOutput(2)) for scan in (self.clear, self.bare)))
        distances, subsets = self.clutter.look(report["beam_id"], report["distance_m"])
        for one, place, distance, subset in zip(report.structured(), report.points, distances, subsets):
            row = rows.get(one["object_id"].item())
            if row is None:  # a moving object that is not a bird
                continue
            beams, energy, probability, points = (one[name].item() for name in (
                "number_of_beams", "energy_received", "detection_probability", "number_of_echoes"))
            light, chance = without.get(row["bird"], (energy, probability))
            in_gate = self.sensor.minimum_range <= one["distance_m"] <= self.sensor.range_gate
            outside = not in_gate or (beams == 0 and light == 0)
            static = self.clutter.energy(one["beam_id"])
            status = ("seen" if points else "outside" if outside else "hidden" if light == 0 else
                      "missed" if probability >= WEAK else "air" if chance >= WEAK else
                      "hidden" if bare.get(row["bird"], (0.0, chance))[1] >= WEAK else "too weak")
            row.update(
                status=status, subset=SUBSETS[subset] if status != "outside" else "",
                range_m=f"{one['distance_m']:.4f}", azimuth_deg=f"{one['azimuth'] / 100:.4f}",
                elevation_deg=f"{one['vertical_angle']:.4f}", effective_area_m2=f"{one['effective_area']:.6g}",
                beams=beams, expected_energy_J=f"{energy:.6g}",
                expected_photoelectrons=f"{one['photoelectrons']:.6g}" if "photoelectrons" in report else "",
                expected_probability=f"{probability:.6g}", points=points,
                clutter_distance_m=f"{distance:.4f}" if status != "outside" else "",
                clutter_share=f"{static / (static + energy):.4f}" if static + energy > 0 else "",
                clear_probability=f"{chance:.6g}" if self.clear is not self.scan else "")
            for when in ("", "first_", "last_"):
                row[f"{when}time_s"] = f"{1e-6 * one[f'{when}timestamp']:.6f}"
                at = one[f"{when}position"] if when else place
                row.update({f"{when}{name}_m": f"{x:.4f}" for name, x in zip("xyz", at)})
        return list(rows.values())

    @staticmethod
    def _pose(beams: vtkPolyData) -> np.ndarray:
        """The 3 x 4 matrix from the coordinates of points (x forward, y left, z up) to the scene's coordinates, at the
        start of the scan. @param beams beams or echoes of the scan"""
        place = np.array(field_values(beams)["position"])
        ends = mesh(np.vstack([place + axis for axis in np.eye(3)]), [(0, 1, 2)])
        ends.GetFieldData().PassData(beams.GetFieldData())
        right, forward, up = Cloud(ends).coordinates("sensor").T  # the scene's axes in the sensor's frame
        return np.column_stack([forward, -right, up, place])

    def _pose_at(self, beam: int) -> np.ndarray:
        """The matrix of `_pose`, at the firing of a beam of the current scan of a sensor that moves."""
        from scipy.spatial.transform import Rotation
        beams = Cloud(self.sensor.algorithm.GetOutput())
        row = int(np.searchsorted(beams["beam_id"], beam))
        right, forward, up = Rotation.from_quat(beams["sensor_orientation"][row][[1, 2, 3, 0]]).as_matrix().T
        return np.column_stack([forward, -right, up, beams["sensor_position"][row]])
