# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of birds in labelled sequences, and comparison with the true flights."""
from __future__ import annotations

import collections
import functools
import json
import math
import pathlib
from typing import Any, Callable, Counter, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence as Many, Tuple, Union

import numpy as np

from ... import vtkAvianLidar as _wrapped
from ..._cloud import Cloud, add_array, as_numpy, with_points
from ..._pipeline import Error, Updates, update
from ..._properties import get_property, property_names, set_properties
from ..._ranks import digest_of_arrays
from ..._scene import Scene, load_scene
from ..._sensor import Sensor
from ..inputs._json import naming
from ..inputs._read import read_manifest, read_scenario
from ..inputs._tables import read_table
from ..places._geojson import read_runways
from ..places._regions import (APPROACH_HALF_WIDTH, APPROACH_HEIGHT, APPROACH_LENGTH, STRIP_HALF_WIDTH, STRIP_HEIGHTS,
                               Runway)
from . import _scores as scores
from ._labels import FIRST_BIRD, FIRST_OBJECT
from ._sequence import DONE, _short, content_of
from ._simulation import STATUSES

VOLUMES = ("strip", "glide path")
NO_BIT = ("number_of_threads", "controller")  # properties that change no result
# Columns of truth.csv.
NEEDED = ("scan", "bird", "species", "status", "time_s", "x_m", "y_m", "z_m", "range_m", "visibility_m", "rain_mm_h")
ORIGINS = ("bird", "second track of a bird", "vehicle", "surface", "false alarm", "air")  # origins of a track
FALSE = ("surface", "false alarm", "air")
STATES = ("scan", "track", "time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "bird")


# The last position of a track: time (s), place (m) and velocity (m/s).
TRACK = np.dtype([("id", int), ("confirmed", bool), ("time", float), ("place", float, 3), ("velocity", float, 3)])


class Live(NamedTuple):
    """A scan with its live tracks."""
    tracks: np.ndarray  # TRACK
    of_points: np.ndarray  # for each point the number of its track, -1 for none
    clutter: np.ndarray  # whether a point is clutter


class Scan(NamedTuple):
    """A scan of a labelled sequence."""
    number: int  # in the whole set
    time: float  # at the beginning, s
    points: np.ndarray  # m right, forward and up of the sensor, so that cells of the clutter filter follow the beams
    placed: np.ndarray  # the points in the scene's frame, m
    times: Optional[np.ndarray]  # of points, us; None if they do not follow from the direction
    labels: np.ndarray


class Beams(NamedTuple):
    """What the clutter filter and the tracker know of the sensor."""
    azimuth_step: float  # deg, 0 for unknown
    elevation_step: float
    half_beamwidth: float  # rad
    position: np.ndarray  # m


class Chain:
    """A clutter filter and a tracker, which process one scan after another."""

    def __init__(self, sensor: Union[Sensor, Beams], learning: int, clutter: Dict[str, Any], tracker: Dict[str, Any]):
        """Steps of the grid and width of the beam are taken from the sensor unless they are set."""
        steps = {"azimuth_step": sensor.azimuth_step, "elevation_step": sensor.elevation_step}
        steps = {name: step for name, step in steps.items() if step > 0.0}
        angle = {"cluster_angle": 1.6 * max(steps.values())} if steps else {}
        self.filter, self.tracker = _wrapped.vtkAvianLidarClutterFilter(), _wrapped.vtkAvianLidarTracker()
        self.filter.SetController(None)  # ranks process different sequences
        self.tracker.SetController(None)
        self.of_filter: Dict[str, Any] = {"warm_up": learning, **steps, **clutter}
        self.of_tracker: Dict[str, Any] = {"half_beamwidth": sensor.half_beamwidth, "history_length": 1, "keep_time": 0.0, **angle,
                           **tracker}
        set_properties(self.filter, "vtkAvianLidarClutterFilter", **self.of_filter)
        set_properties(self.tracker, "vtkAvianLidarTracker", **self.of_tracker)
        self.position = np.array(sensor.position, float)

    def properties(self) -> Dict[str, str]:
        """All settings that decide the results."""
        parts = ("clutter", self.filter), ("tracker", self.tracker)
        return {f"{part}.{name}": _short(get_property(one, cxx)) for part, one in parts
                for name, cxx in property_names(type(one)).items() if name not in NO_BIT}

    def follow(self, scans: Iterable[Scan]) -> Iterator[Tuple[Scan, Live]]:
        """The scans of a sequence with the live tracks after each. What was learned before is dropped."""
        self.filter.Forget()
        self.tracker.Reset()
        with Updates(self.filter) as filtered, Updates(self.tracker) as tracked:
            for scan in scans:
                self.filter.SetInputData(_cloud(scan.points, scan.time, np.zeros(3)))
                filtered()
                clutter = np.zeros(0, np.uint8)
                if len(scan.points):
                    clutter = Cloud(self.filter.GetOutputDataObject(0))["is_clutter"].astype(np.uint8)
                rest = _cloud(scan.placed, scan.time, self.position)
                add_array(rest.GetPointData(), "is_clutter", clutter)
                if scan.times is not None:
                    add_array(rest.GetPointData(), "timestamp", scan.times)
                self.tracker.SetInputData(rest)
                tracked()
                of_points = np.zeros(0, int)
                if len(scan.points):
                    of_points = Cloud(self.tracker.GetOutputDataObject(1))["track_id"].astype(int)
                yield scan, Live(_last(self.tracker.GetOutputDataObject(0)), of_points, clutter != 0)


def _cloud(points: np.ndarray, time: float, position: np.ndarray):
    cloud = with_points(points, deep=False)
    add_array(cloud.GetFieldData(), "TimeValue", np.array([time]))
    add_array(cloud.GetFieldData(), "position", position.reshape(1, 3))
    return cloud


def _last(tracks) -> np.ndarray:
    """The last positions of live tracks (TRACK)."""
    ends = [as_numpy(cells.GetConnectivityArray())[as_numpy(cells.GetOffsetsArray())[1:] - 1]
            for cells in (tracks.GetVerts(), tracks.GetLines()) if cells.GetNumberOfCells()]
    if not ends:
        return np.empty(0, TRACK)
    cells, points = tracks.GetCellData(), Cloud(tracks)
    live = as_numpy(cells.GetArray("ended")) == 0
    last = np.concatenate(ends)[live]
    found = np.empty(len(last), TRACK)
    found["id"], found["confirmed"] = (as_numpy(cells.GetArray(name))[live] for name in ("track_id", "confirmed"))
    found["time"], found["place"] = points["time"][last], points.points[last]
    found["velocity"] = points["velocity"][last]
    return found


def firing_times(sensor: Sensor) -> Optional[Callable[[np.ndarray], np.ndarray]]:
    """A function that gives the times of points since the beginning of the revolution, us, by the nearest beams; None
    for rotating prisms, whose beams differ from scan to scan. Points are relative to the sensor, in the scene's axes."""
    from scipy.spatial import cKDTree
    if sensor.algorithm.GetNumberOfPrisms() > 0:
        return None
    nearest, fired = cKDTree(np.array(sensor.beams["direction"])), np.array(sensor.beams["timestamp"])

    def times(points: np.ndarray) -> np.ndarray:
        ranges = np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-9)
        return fired[nearest.query(points / ranges)[1]]
    return times


def origin_of(labels: np.ndarray) -> np.ndarray:
    """The origin of the light of each point, as an index in ORIGINS. @param labels labels of a sequence"""
    kind, instance = labels & 0xffff, (labels >> 16).astype(int) - 1
    origins = {"bird": instance >= FIRST_BIRD, "vehicle": instance >= FIRST_OBJECT, "air": kind == 1,
               "false alarm": (kind == 0) & (instance < 0)}
    return np.select([*origins.values()], [*map(ORIGINS.index, origins)], ORIGINS.index("surface"))


def read_truth(file) -> Dict[int, List[Dict[str, Any]]]:
    """For each scan, by its number in the whole set, the rows of the birds that are present, with numbers parsed."""
    found: Dict[int, List[Dict[str, Any]]] = collections.defaultdict(list)
    for number, row in enumerate(read_table(file, NEEDED, "the truth of a sequence"), 2):
        if not row["x_m"]:
            continue
        with naming(f"{file}: line {number}"):
            rain = float(row["rain_mm_h"] or 0)
            weather = [f"visibility {float(row['visibility_m']):g} m"] if row["visibility_m"] else []
            weather += [f"rain {rain:g} mm/h"] if rain > 0.0 else []
            time, *place, distance = (float(row[name]) for name in ("time_s", "x_m", "y_m", "z_m", "range_m"))
            if not np.isfinite([time, *place, distance]).all():
                raise ValueError("expected finite numbers")
            if row["status"] not in STATUSES:
                raise ValueError(f"status is {row['status']!r}, expected one of {', '.join(STATUSES)}")
            birds, bird = found[int(row["scan"])], int(row["bird"])
            if any(one["bird"] == bird for one in birds):
                raise ValueError(f"bird {bird} is in scan {row['scan']} twice")
            birds.append({
                "bird": bird, "species": row["species"], "in": row["status"] not in ("absent", "outside"),
                "time": time, "place": place, "range": distance, "weather": ", ".join(weather) or "clear"})
    return found


def inside(volume: str, runways: Many[Runway], places) -> np.ndarray:
    """Which of n places (n x 3, m) lie in each volume of the runways, volumes x n. Strips reach 150 m to either side of
    the middle and 60 m up. Glide paths begin at both ends of each runway and reach 3 km; they are 75 m wide to either
    side and 45 m high at the end, widen by 0.15 and rise by 3 degrees."""
    wedges: List[Any] = []
    for runway in runways:
        if volume == "strip":
            wedges.append((runway.start, *runway.axis(), (STRIP_HALF_WIDTH, 0.0), (STRIP_HEIGHTS[1], 0.0)))
        else:
            wedges += [(*end, APPROACH_LENGTH, APPROACH_HALF_WIDTH, APPROACH_HEIGHT) for end in runway.ends()]
    return np.array([scores.in_wedge(places, *wedge) for wedge in wedges], bool).reshape(-1, len(places))


def score(scans: Many[Tuple[int, List[Dict[str, Any]], Live, np.ndarray]], cutoff: float, order: float,
          runways: Many[Runway]) -> Dict[str, Any]:
    """Compares the tracks of a sequence with the true flights. @param scans number, rows of the truth, live tracks and
    origins of the points of each scan @return birds in the volume of the sensor, confirmed tracks, OSPA of each scan,
    and states of confirmed tracks"""
    points: Dict[int, Counter[int]] = collections.defaultdict(collections.Counter)  # of tracks, by origin
    begin: Dict[int, List[float]] = {}  # first places of tracks, m
    for _, _, live, origins in scans:
        for track, origin in zip(live.of_points.tolist(), origins.tolist()):
            points[track][origin] += 1  # also counts points without a track
        for track, place in zip(live.tracks["id"].tolist(), live.tracks["place"].tolist()):
            begin.setdefault(track, [round(x, 2) for x in place])
    origin_of_track = {track: ORIGINS[max(sorted(of), key=of.__getitem__)] for track, of in points.items()}
    tracks: Dict[int, Dict[str, Any]] = {}
    birds: Dict[int, List[Tuple[Dict[str, Any], Optional[int], bool]]] = collections.defaultdict(list)
    before: Dict[int, int] = {}
    ospa, states, last = [], [], []
    for scan, rows, live, _ in scans:
        confirmed = live.tracks[live.tracks["confirmed"]]
        times, places, velocities = (confirmed[name] for name in ("time", "place", "velocity"))
        ids = confirmed["id"].tolist()
        # positions of tracks when the bird's beam is fired
        away = np.array([np.linalg.norm(places + velocities * (row["time"] - times)[:, None] - row["place"], axis=1)
                         for row in rows]).reshape(len(rows), len(ids))
        of_birds = [i for i, track in enumerate(ids) if origin_of_track.get(track) == "bird"]
        near_birds = away[:, of_birds]
        before = scores.follow(near_birds, [row["bird"] for row in rows], [ids[i] for i in of_birds], cutoff, before)
        bird_of = {track: bird for bird, track in before.items()}
        for row, near in zip(rows, (near_birds < cutoff).any(axis=1).tolist()):
            birds[row["bird"]].append((row, before.get(row["bird"]), near))
        for track, time, place, velocity in zip(ids, times.tolist(), places.tolist(), velocities.tolist()):
            known = tracks.setdefault(track, {
                "track": track, "origin": origin_of_track.get(track, "surface"), "begin": begin[track],
                "confirmed_s": time, "end_s": -math.inf, "scans": 0, "assigned": 0})
            known["scans"] += 1
            known["assigned"] += track in bird_of
            if time > known["end_s"]:
                known["end_s"] = time
                states.append([scan, track, *(round(x, 3) for x in (time, *place, *velocity)), bird_of.get(track, -1)])
        # Tracks of vehicles and of birds outside the volume are not scored.
        within = {row["bird"]: row["in"] for row in rows}
        asked = [i for i, track in enumerate(ids)
                 if origin_of_track.get(track) != "vehicle" and within.get(bird_of.get(track, -1), True)]
        scored = away[np.array([*within.values()], bool)][:, asked]
        ospa.append([round(x, 4) for x in scores.ospa(scored, cutoff, order)])
        last = [[round(x, 1) for x in row["place"][:2]] + [row["bird"] in before] for row in rows if row["in"]]
    for known in tracks.values():
        if known["origin"] == "bird" and not known["assigned"]:
            known["origin"] = ORIGINS[1]
    return {"birds": [_of_bird(runways, *zip(*history)) for _, history in sorted(birds.items())
                      if any(row["in"] for row, _, _ in history)],
            "tracks": [tracks[track] for track in sorted(tracks)], "ospa": ospa, "states": states, "last": last}


def _of_bird(runways: Many[Runway], rows: Many[Dict[str, Any]], tracks: Many[Optional[int]],
             near: Many[bool]) -> Dict[str, Any]:
    """Results of a bird from its rows of the truth. @param tracks assigned tracks @param near whether a bird's track
    was within the cut-off"""
    names = "time", "place", "in", "range"
    times, places, within, ranges = (np.array([row[name] for row in rows]) for name in names)
    had, beside = np.array([track is not None for track in tracks]), np.array(near)

    def first(when: np.ndarray) -> Optional[float]:
        return float(times[when][0]) if when.any() else None
    return {**{name: rows[0][name] for name in ("bird", "species", "weather")},
            "height": float(places[within, 2].mean()), "range": float(ranges[within].mean()),
            "scans": int(within.sum()), "tracked": int((had & within).sum()), "near": int((beside & within).sum()),
            "came_s": first(within), "found_s": first(had & within), "near_s": first(beside),
            "switches": scores.switches(tracks),
            **{volume: first(scores.entered(inside(volume, runways, places))) for volume in VOLUMES}}


class Input:
    """A folder of sequences, as an input of the report card."""

    def __init__(self, folder: pathlib.Path, name: str):
        self.folder, self.name, self.manifest = folder, name, folder / "manifest.json"
        known = read_manifest(folder, ", or a scenario")
        self.scenario, self.numbers = read_scenario(self.manifest), sorted(known["sequences"])
        if "trajectory" in self.scenario:
            raise Error(f"{self.manifest}: the sensor moves, expected one that stands still, as the clutter filter learns "
                        "the ranges of a fixed sensor")
        self.assumed = list(known.get("assumed", ()))
        self.content = {number: self._whole(number) for number in self.numbers}
        first = self.content[self.numbers[0]]["inputs"]
        with naming(f"{self.manifest}: sensor"):
            self.sensor = Sensor(**{
                "motion_seed": int(self.scenario.get("seed", 0)), "position": json.loads(first["sensor.position"]),
                **self.scenario["sensor"], "number_of_revolutions": 1, "sway_amplitude": 0.0, "encoder_jitter": 0.0})
            update(self.sensor.algorithm)
        beams = _short(digest_of_arrays(self.sensor.beams.data))
        for number, content in self.content.items():
            if content["inputs"].get("sensor.beams") != beams:
                raise Error(f"{folder / 'sequences' / number}: has another sensor than {self.manifest}, "
                            "expected sequences of one")

    def _whole(self, number: str) -> Dict[str, Any]:
        """The content of DONE for a sequence; `Error` unless all files are those with which the sequence was made."""
        home = self.folder / "sequences" / number
        for name in ("truth.csv", DONE):
            if not (home / name).is_file():
                raise Error(f"{home / name}: is missing, expected a sequence with its truth, "
                            "as `avianlidar sequence` makes it")
        return content_of(home)

    @functools.cached_property
    def scene(self) -> Scene:
        """The loaded scene."""
        with naming(f"{self.manifest}: scene"):
            scene = load_scene(self.scenario["scene"])
            update(scene.tree)
        return scene

    def runways(self, file) -> List[Runway]:
        """Runways of a file, in the coordinates of the scene."""
        if not file:
            return []
        origin = self.scene.geodetic_origin
        if origin is None:
            raise Error(f"{file}: runways need longitude and latitude, "
                        f"and the scene {self.scenario['scene']} has no origin on the Earth")
        return read_runways(file, origin)

    def scans(self, number: str) -> Iterator[Scan]:
        """The scans of a sequence."""
        home, first = self.folder / "sequences" / number, int(self.content[number]["inputs"]["scans"].split()[0])
        starts, poses = (np.loadtxt(home / name, ndmin=1) for name in ("times.txt", "poses.txt"))
        pose = poses.reshape(-1, 12)[0].reshape(3, 4)
        fired = firing_times(self.sensor)
        for k, start in enumerate(starts.tolist()):
            points = np.fromfile(home / "velodyne" / f"{k:06d}.bin", "<f4").reshape(-1, 4)[:, :3].astype(float)
            labels = np.fromfile(home / "labels" / f"{k:06d}.label", "<u4")
            turned = points @ pose[:, :3].T
            times = None if fired is None else 1e6 * start + fired(turned)
            yield Scan(first + k, start, points[:, [1, 0, 2]] * (-1, 1, 1), turned + pose[:, 3], times, labels)
