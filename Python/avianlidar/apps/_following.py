# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of birds in labelled sequences, and comparison with the true flights."""
from __future__ import annotations

import collections
import contextlib
import functools
import json
import math
import pathlib
from typing import Any, Dict, List, NamedTuple, Optional, Sequence as Many, Tuple

import numpy as np

from .. import vtkAvianLidar as _wrapped
from .._cloud import add_array, as_numpy
from .._pipeline import Error, Updates, update
from .._properties import get_property, property_names, set_properties
from .._ranks import digest_of_arrays
from .._scene import Scene, load_scene, mesh
from .._sensor import Sensor
from . import _scores as scores
from ._json import load_json, naming
from ._labels import FIRST_BIRD, FIRST_OBJECT
from ._geojson import read_runways
from ._regions import APPROACH_HALF_WIDTH, APPROACH_HEIGHT, APPROACH_LENGTH, STRIP_HALF_WIDTH, STRIP_HEIGHTS, Runway
from ._inputs import read_manifest, read_scenario
from ._sequence import DONE, _digest, _short
from ._tables import read_table

VOLUMES = ("strip", "glide path")
NEEDED = ("bird", "species", "status", "time_s", "x_m", "y_m", "z_m", "range_m", "visibility_m", "rain_mm_h")  # columns of truth.csv
ORIGINS = ("bird", "second track of a bird", "vehicle", "surface", "false alarm", "air")  # origins of a track
FALSE = ("surface", "false alarm", "air")
STATES = ("scan", "track", "time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "bird")
NO_BIT = ("number_of_threads", "controller")


class Live(NamedTuple):
    """The live tracks after a scan, and for each point the number of its track, -1 for none."""
    ids: np.ndarray
    confirmed: np.ndarray
    times: np.ndarray  # time of the last position, s
    places: np.ndarray  # last positions, n x 3, m
    velocities: np.ndarray  # n x 3, m/s
    of_points: np.ndarray
    clutter: np.ndarray  # whether a point is clutter


class Chain:
    """A clutter filter and a tracker, which process one scan after another."""

    def __init__(self, sensor: Sensor, learning: int, clutter: Dict[str, Any], tracker: Dict[str, Any]):
        """Steps of the grid and width of the beam are taken from the sensor unless they are set."""
        steps = {name: getattr(sensor, name) for name in ("azimuth_step", "elevation_step") if getattr(sensor, name) > 0.0}
        widest = max(steps.values(), default=0.0)
        self.filter, self.tracker = _wrapped.vtkAvianLidarClutterFilter(), _wrapped.vtkAvianLidarTracker()
        self.filter.SetController(None)  # ranks process different sequences
        self.tracker.SetController(None)
        set_properties(self.filter, "vtkAvianLidarClutterFilter", **{"warm_up": learning, **steps, **clutter})
        set_properties(self.tracker, "vtkAvianLidarTracker", **{"half_beamwidth": sensor.half_beamwidth, "history_length": 1, "keep_time": 0.0,
                                                                **({"cluster_angle": 1.6 * widest} if widest else {}), **tracker})
        self.position = np.array(sensor.position, float)

    def properties(self) -> Dict[str, str]:
        """All settings that decide the results."""
        return {f"{part}.{name}": _short(get_property(one, cxx)) for part, one in (("clutter", self.filter), ("tracker", self.tracker))
                for name, cxx in property_names(type(one)).items() if name not in NO_BIT}

    def __enter__(self) -> "Chain":
        """Begins a new sequence: all learned clutter and tracks are dropped."""
        self.filter.Forget()
        self.tracker.Reset()
        self._stack = contextlib.ExitStack()
        self._filtered, self._tracked = (self._stack.enter_context(Updates(one)) for one in (self.filter, self.tracker))
        return self

    def __exit__(self, *_) -> None:
        self._stack.close()

    def __call__(self, points: np.ndarray, placed: np.ndarray, times: Optional[np.ndarray], time: float) -> Live:
        """@param points m right, forward and up of the sensor, so that cells of the grid follow the beams @param placed the points in the
        scene's frame @param times times of points, us @param time time of the scan, s"""
        self.filter.SetInputData(_cloud(points, time, np.zeros(3)))
        self._filtered()
        clutter = as_numpy(self.filter.GetOutputDataObject(0).GetPointData().GetArray("is_clutter")).astype(np.uint8)
        rest = _cloud(placed, time, self.position)
        add_array(rest.GetPointData(), "is_clutter", clutter)
        if times is not None:
            add_array(rest.GetPointData(), "timestamp", times)
        self.tracker.SetInputData(rest)
        self._tracked()
        of_points = as_numpy(self.tracker.GetOutputDataObject(1).GetPointData().GetArray("track_id")).astype(int)
        return Live(*_last(self.tracker.GetOutputDataObject(0)), of_points, clutter != 0)


def _cloud(points: np.ndarray, time: float, position: np.ndarray):
    cloud = mesh(points, np.empty((0, 3), int))
    add_array(cloud.GetFieldData(), "TimeValue", np.array([time]))
    add_array(cloud.GetFieldData(), "position", position.reshape(1, 3))
    return cloud


def _last(tracks) -> Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Ids, confirmed flags, times, places and velocities of the last positions of live tracks."""
    ends = [as_numpy(cells.GetConnectivityArray())[as_numpy(cells.GetOffsetsArray())[1:] - 1]
            for cells in (tracks.GetVerts(), tracks.GetLines()) if cells.GetNumberOfCells()]
    if not ends:
        return np.empty(0, int), np.empty(0, bool), np.empty(0), np.empty((0, 3)), np.empty((0, 3))
    of_cells, of_points = tracks.GetCellData(), tracks.GetPointData()
    live = as_numpy(of_cells.GetArray("ended")) == 0
    last = np.concatenate(ends)[live]
    return (as_numpy(of_cells.GetArray("track_id")).astype(int)[live], as_numpy(of_cells.GetArray("confirmed"))[live] != 0,
            as_numpy(of_points.GetArray("time"))[last], as_numpy(tracks.GetPoints().GetData()).astype(float)[last],
            as_numpy(of_points.GetArray("velocity")).astype(float)[last])


def origin_of(labels: np.ndarray) -> np.ndarray:
    """The origin of the light of each point, as an index in ORIGINS. @param labels labels of a sequence"""
    kind, instance = labels & 0xffff, (labels >> 16).astype(int) - 1
    return np.select([instance >= FIRST_BIRD, instance >= FIRST_OBJECT, kind == 1, (kind == 0) & (instance < 0)],
                     [ORIGINS.index(name) for name in ("bird", "vehicle", "air", "false alarm")], ORIGINS.index("surface"))


def read_truth(file) -> Dict[int, List[Dict[str, Any]]]:
    """For each scan, by its number in the whole set, the rows of the birds that are present, with numbers parsed."""
    found: Dict[int, List[Dict[str, Any]]] = collections.defaultdict(list)
    for number, row in enumerate(read_table(file, ("scan", *NEEDED), "the truth of a sequence")):
        with naming(f"{file}: line {number + 2}"):
            of_scan = found[int(row["scan"])]
            weather = [f"visibility {float(row['visibility_m']):g} m"] if row["visibility_m"] else []
            weather += [f"rain {float(row['rain_mm_h']):g} mm/h"] if float(row["rain_mm_h"] or 0) > 0.0 else []
            if row["x_m"]:
                of_scan.append({"bird": int(row["bird"]), "species": row["species"], "in": row["status"] not in ("absent", "outside"),
                                "time": float(row["time_s"]), "place": [float(row[name]) for name in ("x_m", "y_m", "z_m")],
                                "range": float(row["range_m"]), "weather": ", ".join(weather) or "clear"})
    return found


def inside(volume: str, runways: Many[Runway], places) -> np.ndarray:
    """Which of n places (n x 3, m) lie in each volume of the runways, volumes x n. Strips reach 150 m to either side of the middle and 60 m
    up. Glide paths begin at both ends of each runway and reach 3 km; they are 75 m wide to either side and 45 m high at the end, widen by
    0.15 and rise by 3 degrees."""
    if volume == "strip":
        wedges: List[Any] = [(runway.start, *runway.axis(), (STRIP_HALF_WIDTH, 0.0), (STRIP_HEIGHTS[1], 0.0)) for runway in runways]
    else:
        wedges = [(*end, APPROACH_LENGTH, APPROACH_HALF_WIDTH, APPROACH_HEIGHT) for runway in runways for end in runway.ends()]
    return np.array([scores.in_wedge(places, *wedge) for wedge in wedges], bool).reshape(-1, len(places))


class Scorer:
    """Collects the tracks of a sequence scan after scan, then scores them against the true flights."""

    def __init__(self, cutoff: float, order: float, runways: Many[Runway]):
        self.cutoff, self.order, self.runways = cutoff, order, runways
        self.scans: List[Tuple[int, List[Dict[str, Any]], Live]] = []
        self.points: Dict[int, np.ndarray] = collections.defaultdict(lambda: np.zeros(len(ORIGINS), int))  # points of tracks, by origin
        self.begin: Dict[int, List[float]] = {}  # first time of tracks, s

    def add(self, scan: int, rows: List[Dict[str, Any]], live: Live, origins: np.ndarray) -> None:
        """@param rows rows of the truth @param origins origins of points"""
        for track, origin in zip(live.of_points.tolist(), origins):
            self.points[track][origin] += 1  # also counts points without a track
        for track, place in zip(live.ids.tolist(), live.places.tolist()):
            self.begin.setdefault(track, [round(x, 2) for x in place])
        self.scans.append((scan, rows, live))

    def results(self) -> Dict[str, Any]:
        """Birds in the volume of the sensor, confirmed tracks, OSPA of each scan, and states of confirmed tracks."""
        origins = {track: ORIGINS[int(np.argmax(counts))] for track, counts in self.points.items()}
        tracks: Dict[int, Dict[str, Any]] = {}
        birds: Dict[int, List[Tuple[Dict[str, Any], Optional[int], bool]]] = collections.defaultdict(list)
        before: Dict[int, int] = {}
        ospa, states, last = [], [], []
        for scan, rows, live in self.scans:
            times, places, velocities = (part[live.confirmed] for part in (live.times, live.places, live.velocities))
            ids = live.ids[live.confirmed].tolist()
            # positions of tracks when the bird's beam is fired
            away = np.array([np.linalg.norm(places + velocities * (row["time"] - times)[:, None] - row["place"], axis=1) for row in rows])
            away = away.reshape(len(rows), len(ids))
            of_birds = np.array([origins.get(track) == "bird" for track in ids], bool)
            before = scores.follow(away[:, of_birds], [row["bird"] for row in rows], np.array(ids, int)[of_birds].tolist(), self.cutoff, before)
            bird_of = {track: bird for bird, track in before.items()}
            for row, near in zip(rows, (away[:, of_birds] < self.cutoff).any(axis=1).tolist()):
                birds[row["bird"]].append((row, before.get(row["bird"]), near))
            for i, track in enumerate(ids):
                known = tracks.setdefault(track, {"track": track, "origin": origins.get(track, "surface"), "begin": self.begin[track],
                                                  "confirmed_s": float(times[i]), "end_s": -math.inf, "scans": 0, "assigned": 0})
                known["scans"] += 1
                known["assigned"] += track in bird_of
                if times[i] > known["end_s"]:
                    known["end_s"] = float(times[i])
                    states.append([scan, track, *(round(float(x), 3) for x in (times[i], *places[i], *velocities[i])), bird_of.get(track, -1)])
            # Tracks of vehicles and of birds outside the volume are not scored.
            within = {row["bird"]: row["in"] for row in rows}
            asked = np.array([origins.get(track) != "vehicle" and within.get(bird_of.get(track, -1), True) for track in ids], bool)
            ospa.append([round(x, 4) for x in scores.ospa(away[np.array([*within.values()], bool)][:, asked], self.cutoff, self.order)])
            last = [[round(x, 1) for x in row["place"][:2]] + [row["bird"] in before] for row in rows if row["in"]]
        for known in tracks.values():
            if known["origin"] == "bird" and not known["assigned"]:
                known["origin"] = ORIGINS[1]
        return {"birds": [self._of_bird(*zip(*history)) for _, history in sorted(birds.items()) if any(row["in"] for row, _, _ in history)],
                "tracks": [tracks[track] for track in sorted(tracks)], "ospa": ospa, "states": states, "last": last}

    def _of_bird(self, rows: Many[Dict[str, Any]], tracks: Many[Optional[int]], near: Many[bool]) -> Dict[str, Any]:
        """Results of a bird from its rows of the truth. @param tracks assigned tracks @param near whether a bird's track was within the
        cut-off"""
        times, places, within, ranges = (np.array([row[name] for row in rows]) for name in ("time", "place", "in", "range"))
        had, beside = np.array([track is not None for track in tracks]), np.array(near)

        def first(when: np.ndarray) -> Optional[float]:
            return float(times[when][0]) if when.any() else None
        entries = {volume: scores.entry(times, inside(volume, self.runways, places)) for volume in VOLUMES}
        return {**{name: rows[0][name] for name in ("bird", "species", "weather")}, "height": float(places[within, 2].mean()),
                "range": float(ranges[within].mean()), "scans": int(within.sum()), "tracked": int((had & within).sum()),
                "near": int((beside & within).sum()), "came_s": first(within), "found_s": first(had & within), "near_s": first(beside),
                "switches": scores.switches(tracks), **{volume: None if math.isnan(when) else when for volume, when in entries.items()}}


class Input:
    """A folder of sequences, as an input of the report card."""

    def __init__(self, folder: pathlib.Path, name: str):
        self.folder, self.name, self.manifest = folder, name, folder / "manifest.json"
        known = read_manifest(folder, ", or a scenario")
        self.scenario, self.assumed, self.numbers = read_scenario(self.manifest), list(known.get("assumed", ())), sorted(known["sequences"])
        self.content = {number: self._whole(number) for number in self.numbers}
        first = self.content[self.numbers[0]]["inputs"]
        with naming(f"{self.manifest}: sensor"):
            self.sensor = Sensor(**{"motion_seed": int(self.scenario.get("seed", 0)), "position": json.loads(first["sensor.position"]), **self.scenario["sensor"],
                                    "number_of_revolutions": 1, "sway_amplitude": 0.0, "encoder_jitter": 0.0})
            update(self.sensor.algorithm)
        beams = _short(digest_of_arrays(self.sensor.beams.data))
        for number, content in self.content.items():
            if content["inputs"].get("sensor.beams") != beams:
                raise Error(f"{folder / 'sequences' / number}: has another sensor than {self.manifest}, expected sequences of one")

    def _whole(self, number: str) -> Dict[str, Any]:
        """The content of DONE for a sequence; `Error` unless all files are those with which the sequence was made."""
        home = self.folder / "sequences" / number
        for name in ("truth.csv", DONE):
            if not (home / name).is_file():
                raise Error(f"{home / name}: is missing, expected a sequence with its truth, as `avianlidar sequence` makes it")
        content = load_json(home / DONE)
        if not isinstance(content, dict) or not isinstance(content.get("inputs"), dict) or content.get("sha256") != _digest(home):
            raise Error(f"{home}: its files differ from the sha256 in its {DONE}: another program has changed, added or removed files")
        return content

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
            raise Error(f"{file}: runways need longitude and latitude, and the scene {self.scenario['scene']} has no origin on the Earth")
        return read_runways(file, origin)

    def scans(self, number: str):
        """For each scan: its number in the whole set, its start time (s), points in the sensor's frame (right, forward, up, m) and
        in the scene's frame, times of points (us, None if the times do not follow from the direction), labels."""
        from scipy.spatial import cKDTree
        home, first = self.folder / "sequences" / number, int(self.content[number]["inputs"]["scans"].split()[0])
        starts, poses = (np.loadtxt(home / name, ndmin=1) for name in ("times.txt", "poses.txt"))
        pose = poses.reshape(-1, 12)[0].reshape(3, 4)
        beams, fired = self.sensor.beams, np.array(self.sensor.beams["timestamp"])
        nearest = cKDTree(np.array(beams["direction"])) if self.sensor.algorithm.GetNumberOfPrisms() == 0 else None
        for k, start in enumerate(starts):
            points = np.fromfile(home / "velodyne" / f"{k:06d}.bin", "<f4").reshape(-1, 4)[:, :3].astype(float)
            labels = np.fromfile(home / "labels" / f"{k:06d}.label", "<u4")
            placed = points @ pose[:, :3].T + pose[:, 3]
            times = None
            if nearest is not None:
                ranges = np.maximum(np.linalg.norm(points, axis=1), 1e-9)
                times = 1e6 * start + fired[nearest.query((placed - pose[:, 3]) / ranges[:, None])[1]] if len(points) else np.empty(0)
            yield first + k, float(start), np.column_stack([-points[:, 1], points[:, 0], points[:, 2]]), placed, times, labels
