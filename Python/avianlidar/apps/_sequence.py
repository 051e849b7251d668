# SPDX-License-Identifier: BSD-3-Clause
"""Labelled sequences of scans with birds, to train and to test on."""
from __future__ import annotations

import collections
import contextlib
import functools
import hashlib
import json
import math
import os
import pathlib
import secrets
import shutil
import warnings
from typing import Any, Callable, Counter, Dict, Iterator, List, Optional, Tuple, Union

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkFieldData, vtkMultiBlockDataSet, vtkPolyData

from .. import vtkAvianLidar as _wrapped
from .._cloud import Cloud, add_array, field_values, leaves_of
from .._disk import as_csv, only_run, read_regular, synchronize, write_whole
from .._pipeline import Error, Updates, callers_level, update
from .._properties import in_snake_case, set_properties
from .._ranks import Ranks, as_json, digest_of, digest_of_arrays
from .._scan import Scan
from .._scene import Scene, load_scene, mesh, mover
from .._sensor import Sensor
from .._weather import in_weather, in_words
from .._version import __version__
from ._boxes import Boxes
from ._json import check_json, load_json, naming
from ._labels import BIRD, FIRST_BIRD, FIRST_OBJECT, LAST_ID, classes_of, configuration, relabel

SUBSETS = ("sky", "near_clutter", "through_edges")
STATUSES = ("absent", "outside", "hidden", "air", "too weak", "missed", "seen")
TRUTH = ("scan", "bird", "species", "status", "subset", "time_s", "x_m", "y_m", "z_m", "range_m", "azimuth_deg",
         "elevation_deg", "effective_area_m2", "beams", "expected_energy_J", "expected_photoelectrons",
         "expected_probability", "points", "clutter_distance_m", "clutter_share",
         "first_time_s", "first_x_m", "first_y_m", "first_z_m", "last_time_s", "last_x_m", "last_y_m", "last_z_m",
         "visibility_m", "rain_mm_h", "clear_probability")
AIR = -2  # object_id of echoes of the air
WEAK = 0.1  # a bird of a smaller probability of detection is too weak
LONGEST = 1e9  # s that an object is under way, or sets out later
DONE = "done.json"
PART = ".part"  # ends the name of a folder that is being written
FOLDERS = (("velodyne", ".bin", 16), ("labels", ".label", 4), ("subsets", ".subset", 1))  # suffix, bytes of a point
ALL = (*FOLDERS, ("boxes", ".txt", 1))
TEXTS = ("truth.csv", "times.txt", "poses.txt", "calib.txt")  # of a whole sequence
TABLES = ("points_of_classes", "birds_of_statuses", "birds_seen_of_subsets")  # of DONE
COUNTS = ("scans", "scans_with_birds_seen")
_AGAIN = "Remove the folder: it is made again"
_FEWER = "ask for as many scans as there are, or choose another folder"
# Whose properties the parts of a scenario name.
PROPERTIES = {"sensor": _wrapped.vtkAvianLidarBeamSource, "scan": _wrapped.vtkAvianLidarEchoFilter, "birds": _wrapped.vtkAvianLidarTracks}
SHOWN = 3  # inputs that differ, in an error
CONFIGURATION = "semantic-kitti.yaml"

Progress = Callable[[int, int, int], None]


def checked(scenario: Any, what: str) -> Dict[str, Any]:
    """A scenario whose properties have their names in snake case, as its schema wants it. @param what its file, for errors"""
    def here(wrapped: type, value: Any, part: str) -> Any:
        if isinstance(value, list):
            return [here(wrapped, one, f"{part}[{place}]") for place, one in enumerate(value)]
        return in_snake_case(wrapped, value, part) if isinstance(value, dict) else value
    if isinstance(scenario, dict):
        with naming(what):
            scenario = {part: here(PROPERTIES[part], value, part) if part in PROPERTIES else value for part, value in scenario.items()}
    check_json(scenario, "scenario.schema.json", what)
    return scenario


def _with_files(scenario: Dict[str, Any], change: Callable[[str], str]) -> Dict[str, Any]:
    """The scenario with other words for the files that it names."""
    preset = scenario["sensor"]["preset"]
    birds = [{name: change(value) if name in ("file_name", "species_file_name") else value for name, value in group.items()}
             for group in scenario.get("birds", ())]
    return {**scenario, "scene": change(scenario["scene"]), "birds": birds,
            "sensor": {**scenario["sensor"], "preset": change(preset) if preset.endswith(".json") else preset}}


def read_scenario(file) -> Dict[str, Any]:
    """A scenario file, or the manifest of a sequence; `Error` names what is wrong. Files that it names are absolute."""
    path = pathlib.Path(file)
    scenario = load_json(path)
    if isinstance(scenario, dict) and "sequences" in scenario:
        scenario = scenario.get("scenario")  # a manifest
    with naming(str(file)):
        return _with_files(checked(scenario, str(file)), lambda name: str((path.parent / name).resolve()))


def read_manifest(folder, others: str = "") -> Dict[str, Any]:
    """The manifest of a folder of sequences. @param others what else could be given, in words"""
    file, made = pathlib.Path(folder) / "manifest.json", "a folder that `avianlidar sequence` has made"
    if not file.is_file():
        raise Error(f"{folder}: holds no manifest.json, expected {made}{others}")
    manifest = load_json(file)
    parts = manifest.get("sequences") if isinstance(manifest, dict) else None
    if not isinstance(parts, dict) or not parts:
        raise Error(f"{file}: names no sequences, expected the manifest of {made}")
    return manifest


class Clutter:
    """The static echoes of every beam, without noise: what a point of the same beam has before or behind it.

    A point is in the `sky` if its beam has no static echo; `through_edges` if one lies more than `near` metres before it,
    so that the beam goes on past an edge; else `near_clutter`.
    """

    def __init__(self, scan: Scan, near: float):
        echoes = scan.echoes
        order = np.lexsort((echoes["distance_m"], echoes["beam_id"]))
        order = order[echoes["object_id"][order] != AIR]  # those of the air are not clutter
        self.beams, self.ranges, self.energies = (echoes[name][order] for name in ("beam_id", "distance_m", "energy_received"))
        self.near = near

    def look(self, beams, ranges) -> Tuple[np.ndarray, np.ndarray]:
        """(distance in range to the nearest static echo of the same beam, m, infinite without one; index in SUBSETS)."""
        beams, ranges = np.asarray(beams), np.asarray(ranges)
        distance = np.full(len(beams), np.inf)
        begin, end = np.searchsorted(self.beams, beams, "left"), np.searchsorted(self.beams, beams, "right")
        for k in range(int((end - begin).max(initial=0))):
            has = begin + k < end
            distance[has] = np.minimum(distance[has], np.abs(ranges[has] - self.ranges[begin[has] + k]))
        first = np.append(self.ranges, np.inf)[np.where(begin < end, begin, -1)]  # of each beam
        return distance, np.where(ranges - first > self.near, 2, begin < end).astype(np.uint8)

    def energy(self, beam: int) -> float:
        """Of all static echoes of a beam, J."""
        return float(self.energies[slice(*np.searchsorted(self.beams, [beam, beam + 1]))].sum())


class Sequence:
    """Scans of a scenario, with labels.

    >>> sequence = Sequence("Examples/sequence/hongqiao.scenario.json", number_of_scans=200)   # doctest: +SKIP
    >>> sequence.write("build/sequence")                                                       # doctest: +SKIP
    """

    def __init__(self, scenario: Union[str, "os.PathLike[str]", Dict[str, Any]], threads: int = 0, **changes: Any):
        """A sequence, nothing made yet.

        scenario  a file (keys and units: scenario.schema.json), the manifest of another sequence, or what
                  `read_scenario` gives
        threads   of this process, 0: all cores
        changes   of keys of the scenario, for example number_of_scans
        """
        self.file = "scenario" if isinstance(scenario, dict) else os.fspath(scenario)
        self.scenario = checked({**(scenario if isinstance(scenario, dict) else read_scenario(scenario)), **changes}, self.file)
        self.threads = threads
        self.scans = int(self.scenario["number_of_scans"])
        self.scans_to_do = 0  # of this process, known when `write` has looked
        self.length, self.seed, self.bird_class = (int(self.scenario.get(name, default)) for name, default in (
            ("scans_per_sequence", 100), ("seed", 0), ("bird_class", BIRD)))
        with naming(self.file):
            classes_of(self.bird_class)
        with naming(f"{self.file}: scene"):
            self.scene = load_scene(self.scenario["scene"])
            update(self.scene.tree)
        if len(self.scene.objects) > FIRST_OBJECT:
            raise Error(f"{self.scenario['scene']}: has {len(self.scene.objects)} objects, expected at most {FIRST_OBJECT}: "
                        "labels hold no more")
        sensor: Dict[str, Any] = {"position": self.scene.lidar_position or (0, 0, 0), "motion_seed": self.seed,
                                  **self.scenario["sensor"], "number_of_revolutions": self.scans}
        with naming(f"{self.file}: weather"):
            air = in_weather(self.scenario.get("scan", {}), self.scenario.get("weather"))
        settings: Dict[str, Any] = {"seed": self.seed, **air, "number_of_threads": threads}
        with naming(f"{self.file}: sensor"):
            self.sensor = Sensor(**sensor)
            update(self.sensor.algorithm)
        with naming(f"{self.file}: scan"):
            self.scan = Scan(self.scene, self.sensor, **settings)
        self.scan.set(report_movers=True)
        media = field_values(self.scene.tree.GetOutput()).get("media", ())
        crowns = [text for text in media if "leaf_area_density" in json.loads(text)]
        self.clear = self.bare = self.scan  # without air that scatters; without crowns of trees, too
        others = dict(settings)
        if self.scan.rain_rate > 0.0 or (self.scan.air_backscatter and self.scan.visibility > 0.0) or len(crowns) < len(media):
            others.update(visibility=0.0, air_backscatter=False, rain_rate=0.0)
            self.clear = self.bare = self._in_media(crowns, others)
        if crowns:
            self.bare = self._in_media([], others)
        self._moving(0)  # what is wrong with birds and objects is said before the work
        # Where clutter is, without what differs from scan to scan.
        sensor.update(number_of_revolutions=1, sway_amplitude=0.0, encoder_jitter=0.0)
        settings["noise"] = False
        self.at_rest = Sensor(**sensor)
        with naming(f"{self.file}: scan"):
            self._still = Scan(self.scene, self.at_rest, **settings)
            self.clutter = self._clutter()

    def _in_media(self, media: List[str], settings: Dict[str, Any]) -> Scan:
        """A scan to compare with, of the surfaces of the scene with other media."""
        scan = Scan(self.scene, self.sensor, **settings)
        scan.set(report_movers=True, noise=False)
        surfaces = vtkPolyData()
        surfaces.ShallowCopy(self.scene.tree.GetOutput())
        add_array(surfaces.GetFieldData(), "media", media)
        scan.algorithm.SetSurfacesData(surfaces)
        return scan

    def _clutter(self) -> Clutter:
        return Clutter(self._still, float(self.scenario.get("near_clutter_distance", 15.0)))

    def __len__(self) -> int:
        """Number of sequences."""
        return -(-self.scans // self.length)

    def span(self, number: int) -> range:
        """The scans of a sequence."""
        return range(number * self.length, min((number + 1) * self.length, self.scans))

    def _moving(self, number: int) -> Tuple[vtkMultiBlockDataSet, Dict[int, str]]:
        """Birds and other objects under way in a sequence, and the species of the birds by id."""
        scans, rate = self.span(number), self.sensor.rotation_rate
        time = scans.start / rate, scans.stop / rate
        birds, species = self._flights(number, time)
        blocks = vtkMultiBlockDataSet()
        for k, block in enumerate(birds + self._objects(*time)):
            blocks.SetBlock(k, block)
        return blocks, species

    def _flights(self, number: int, time: Tuple[float, float]) -> Tuple[List[vtkPolyData], Dict[int, str]]:
        """Birds of a sequence, and their species by id."""
        blocks: List[vtkPolyData] = []
        species: Dict[int, str] = {}
        for place, group in enumerate(self.scenario.get("birds", ())):
            tracks = _wrapped.vtkAvianLidarTracks()
            seed = hashlib.sha256(json.dumps((self.seed, number, place)).encode()).digest()[:4]
            ours = {"time_range": time, "first_object_id": FIRST_BIRD + len(blocks), "seed": int.from_bytes(seed, "little", signed=True), **group}
            with naming(f"{self.file}: birds[{place}]"):
                set_properties(tracks, "vtkAvianLidarTracks", **ours)
                update(tracks)
            for block in leaves_of(tracks.GetOutput()):
                species[FIRST_BIRD + len(blocks)] = field_values(block)["species"][0]
                blocks.append(block)
            if len(blocks) > LAST_ID - FIRST_BIRD:
                raise Error(f"{self.file}: birds: {len(blocks)} and more, expected at most {LAST_ID - FIRST_BIRD}: labels hold no more")
        return blocks, species

    def _objects(self, begin: float, end: float) -> List[vtkPolyData]:
        """Other objects under way at some time between, s."""
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
                raise Error(f"{self.file}: objects[{place}]: is under way from {first:g} s for {times[-1]:g} s, expected at most "
                            f"{LONGEST:g} s")
            most = FIRST_BIRD - FIRST_OBJECT
            if every * most < times[-1] + end - begin or len(blocks) > most:
                raise Error(f"{self.file}: objects[{place}].every: more than {most} objects would be under way in one sequence")
            start = first
            if math.isfinite(every) and begin - times[-1] > first:
                start = first + every * math.ceil((begin - times[-1] - first) / every)
            while start < end:
                with naming(f"{self.file}: objects[{place}]"):
                    blocks.append(self._under_way(thing, route, legs, start + times, FIRST_OBJECT + len(blocks)))
                start += every
        if FIRST_OBJECT + len(blocks) > FIRST_BIRD:
            raise Error(f"{self.file}: objects: {len(blocks)} under way in one sequence, expected at most "
                        f"{FIRST_BIRD - FIRST_OBJECT}")
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
        # It turns where two legs meet: each leg has its own heading, and two poses.
        heading = np.arctan2(legs[:, 0], legs[:, 1])
        turn = np.stack([np.cos(heading / 2), 0 * heading, 0 * heading, -np.sin(heading / 2)], axis=1)
        when = np.repeat(times, 2)[1:-1]
        when[2::2] += 1e-6
        return mover(surface, np.repeat(route, 2, axis=0)[1:-1], when, np.repeat(turn, 2, axis=0))

    def frames(self, number: int) -> Iterator[Tuple[int, Scan, Dict[int, str]]]:
        """The scans of a sequence: (number of the scan, the scan as it is then, species of the birds by id)."""
        movers, species = self._moving(number)
        scans = [*dict.fromkeys((self.scan, self.clear, self.bare))]
        for scan in scans:
            scan.movers = movers
        differ = self.sensor.algorithm.GetNumberOfPrisms() > 0  # beams, from scan to scan
        with contextlib.ExitStack() as stack:
            runs = [(stack.enter_context(Updates(scan.algorithm)), scan.algorithm.UpdateTimeStep) for scan in scans + [self._still] * differ]
            for k in self.span(number):
                for run, step in runs:
                    run(functools.partial(step, k / self.sensor.rotation_rate))
                if differ:
                    self.clutter = self._clutter()
                yield k, self.scan, species

    def truth(self, k: int, species: Dict[int, str]) -> List[List[Any]]:
        """A row of `TRUTH` for each bird, of the scan as it is now."""
        report = Cloud(self.scan.algorithm.GetOutput(2))
        weather = [f"{self.scan.visibility:g}" if self.scan.visibility > 0.0 else "", f"{self.scan.rain_rate:g}"]
        rows = {bird: [k, bird, name, "absent", ""] + [""] * 8 + [0, "", "", "", 0] + [""] * 10 + [*weather, ""] for bird, name in species.items()}
        if report.number_of_points == 0:
            return list(rows.values())
        without, bare = ({bird: both for bird, *both in zip(found["object_id"], found["energy_received"], found["detection_probability"])}
                         for found in (Cloud(scan.algorithm.GetOutput(2)) for scan in (self.clear, self.bare)))
        distances, subsets = self.clutter.look(report["beam_id"], report["distance_m"])
        for one, place, distance, subset in zip(report.structured(), report.points, distances, subsets):
            bird, beams, energy, probability, points = (one[name].item() for name in (
                "object_id", "number_of_beams", "energy_received", "detection_probability", "number_of_echoes"))
            if bird not in rows:  # another object under way
                continue
            light, chance = without.get(bird, (energy, probability))
            in_gate = self.sensor.minimum_range <= one["distance_m"] <= self.sensor.range_gate
            outside = not in_gate or (beams == 0 and light == 0)
            static = self.clutter.energy(one["beam_id"])
            status = ("seen" if points else "outside" if outside else "hidden" if light == 0 else
                      "missed" if probability >= WEAK else "air" if chance >= WEAK else
                      "hidden" if bare.get(bird, (0.0, chance))[1] >= WEAK else "too weak")
            times, places = zip(*((one[f"{when}timestamp"], one[f"{when}position"] if when else place) for when in ("", "first_", "last_")))
            now, first, last = ([f"{1e-6 * time:.6f}", *(f"{x:.4f}" for x in at)] for time, at in zip(times, places))
            rows[bird] = [k, bird, species[bird], status, SUBSETS[subset] if status != "outside" else "", *now,
                          f"{one['distance_m']:.4f}", f"{one['azimuth'] / 100:.4f}",
                          f"{one['vertical_angle']:.4f}", f"{one['effective_area']:.6g}", beams,
                          f"{energy:.6g}", f"{one['photoelectrons']:.6g}" if "photoelectrons" in report else "",
                          f"{probability:.6g}", points, f"{distance:.4f}" if status != "outside" else "",
                          f"{static / (static + energy):.4f}" if static + energy > 0 else "", *first, *last,
                          *weather, f"{chance:.6g}" if self.clear is not self.scan else ""]
        return list(rows.values())

    def _write_one(self, folder: pathlib.Path, number: int, progress: Optional[Progress]) -> Dict[str, Any]:
        """The files of a sequence; what is in them."""
        for name, _, _ in ALL:
            (folder / name).mkdir(parents=True)
        boxes = Boxes(self.scene.tree.GetOutput(), self.at_rest, self._pose())
        writer = _wrapped.vtkAvianLidarKITTIWriter()
        table: List[Any] = []
        classes: Counter[int] = collections.Counter()
        scans = self.span(number)
        with Updates(writer) as write:
            for k, scan, species in self.frames(number):
                echoes, name = scan.algorithm.GetOutput(0), f"{k - scans.start:06d}"
                writer.SetInputData(echoes)
                writer.SetFileName(str(folder / "velodyne" / f"{name}.bin"))
                write(writer.Write)
                labels = relabel(np.fromfile(folder / "velodyne" / f"{name}.label", np.uint32), self.bird_class)
                labels.tofile(folder / "labels" / f"{name}.label")
                os.remove(folder / "velodyne" / f"{name}.label")
                points = Cloud(echoes)
                _, subset = self.clutter.look(points["beam_id"], points["distance_m"])
                (folder / "subsets" / f"{name}.subset").write_bytes(subset.tobytes())
                (folder / "boxes" / f"{name}.txt").write_text(
                    boxes.lines(Cloud(scan.algorithm.GetOutput(2)), scan.movers), encoding="utf-8")
                table += self.truth(k, species)
                classes.update((labels & 0xffff).tolist())
                if progress:
                    progress(number, k - scans.start + 1, len(scans))
        pose = " ".join(f"{value:.9g}" for value in self._pose().ravel())
        texts = {"times.txt": "".join(f"{k / self.sensor.rotation_rate:.6f}\n" for k in scans), "poses.txt": f"{pose}\n" * len(scans),
                 "calib.txt": "".join(f"{name}: 1 0 0 0 0 1 0 0 0 0 1 0\n" for name in ("P0", "P1", "P2", "P3", "Tr"))}
        for name, text in {**texts, "truth.csv": as_csv([TRUTH, *table]).decode()}.items():
            (folder / name).write_text(text, encoding="utf-8")
        statuses, seen = [row[3] for row in table], [row for row in table if row[3] == "seen"]
        return {"scans": len(scans), "scans_with_birds_seen": len({row[0] for row in seen}), "points_of_classes": dict(classes),
                "birds_of_statuses": {name: statuses.count(name) for name in STATUSES},
                "birds_seen_of_subsets": {name: [row[4] for row in seen].count(name) for name in SUBSETS}}

    def _pose(self) -> np.ndarray:
        """3 x 4: from the coordinates of points (x forward, y left, z up) to the scene's."""
        place = np.array(self.sensor.position, float)
        ends = mesh(np.vstack([place + axis for axis in np.eye(3)]), [(0, 1, 2)])
        ends.GetFieldData().PassData(self.sensor.beams.data.GetFieldData())
        right, forward, up = Cloud(ends).coordinates("sensor").T  # of the scene's axes
        return np.column_stack([forward, -right, up, place])

    def _inputs(self) -> Dict[str, str]:
        """All that every file depends on, by name, as it was found: of the scenario, the files that it names, the scene, and each
        property of sensor and scan whoever sets it."""
        scenario = _with_files({**self.scenario, "scene": ""}, lambda name: name and hashlib.sha256(read_regular(name)).hexdigest())
        no_bit = ("number_of_threads", "controller", "maximum_cache_size", "batch_collision_detection",
                  "number_of_revolutions")  # the last one says which scans there are
        parts = {"scenario": {name: part for name, part in scenario.items() if name not in ("scene", "sensor", "scan", "number_of_scans")},
                 "sensor": {**self.sensor.properties(), "beams": digest_of_arrays(self.at_rest.beams.data)},
                 "scan": self.scan.properties()}
        found = {f"{part}.{name}": _short(value) for part, values in parts.items() for name, value in values.items() if name not in no_bit}
        return {"version": __version__, "scene": digest_of(self.scene.tree.GetOutput()), **found}

    def decides(self) -> Any:
        """All that decides which files `write` makes."""
        return self.scans, sorted(self._inputs().items())

    def write(self, folder, ranks: Optional[Ranks] = None, progress: Optional[Progress] = None) -> Dict[str, Any]:
        """Make what is missing of `folder`/sequences/NN, then manifest.json and datasheet.md; returns the manifest.

        A sequence has its name only when it is whole. Killed at any moment and started again, the work goes on with the
        next sequence. More scans add sequences; one that had fewer is made again, with a warning. What another scenario has left
        there is an error, and so are fewer scans than there are, and files that were changed. Ranks take whole sequences.
        semantic-kitti.yaml beside the manifest is the configuration for programs that read SemanticKITTI.

        progress  called with the number of the sequence, its scans done and all of them
        """
        ranks, out = ranks or Ranks(), pathlib.Path(folder)
        with only_run(out, ranks, goes_on=True, known=self.decides), ranks.together():
            return self._write(out, ranks, progress)

    def _write(self, out: pathlib.Path, ranks: Ranks, progress: Optional[Progress]) -> Dict[str, Any]:
        home, common = out / "sequences", self._inputs()
        home.mkdir(exist_ok=True)
        for folder in sorted(home.glob("[0-9]*")):
            if folder.name.isdigit() and int(folder.name) >= len(self):
                raise Error(f"{folder}: is there, and number_of_scans is {self.scans}: {_FEWER}")
        missing = [k for k in range(len(self)) if not self._is_there(home / f"{k:02d}", k, common)]
        mine = missing[ranks.rank::ranks.size]
        self.scans_to_do = sum(len(self.span(k)) for k in mine)
        shorter = [home / f"{k:02d}" for k in missing if (home / f"{k:02d}").exists()]
        if shorter and ranks.rank == 0:
            warnings.warn(f"{shorter[0]}: has fewer scans than are wanted now, and is made again: flights depend on the length of a "
                          "sequence", RuntimeWarning, stacklevel=callers_level())
        ranks.wait()  # all have looked before anybody adds anything
        if ranks.rank == 0:
            for part in home.glob(f".*{PART}"):
                shutil.rmtree(part)
        ranks.wait()
        for number in mine:
            name, inputs = f"{number:02d}", self._inputs_of(common, number)
            part, old = (home / f".{name}.{secrets.token_hex(4)}{PART}" for _ in range(2))
            try:
                content = self._write_one(part, number, progress)
                _check_scans(part, len(self.span(number)))
                write_whole(part / DONE, as_json({**content, "inputs": inputs, "identity": _identity(inputs), "sha256": _digest(part)}))
                os.sync()
                if home / name in shorter:
                    os.replace(home / name, old)
                os.replace(part, home / name)
            except BaseException:
                shutil.rmtree(part, ignore_errors=True)
                raise
            shutil.rmtree(old, ignore_errors=True)
            synchronize(home)
        ranks.wait()
        contents = {f"{k:02d}": {key: value for key, value in load_json(home / f"{k:02d}" / DONE).items() if key != "inputs"}
                    for k in range(len(self))}
        manifest = {"scenario": _with_files(self.scenario, lambda name: os.path.relpath(name, out)),
                    "scene_digest": digest_of(self.scene.tree.GetOutput()), "avian_lidar_version": __version__,
                    "beams": self.sensor.beams.number_of_points,
                    "assumed": self.sensor.beams.fields.get("assumed", []), "sequences": contents}
        if ranks.rank == 0:
            points = {int(label): count for label, count in _sums(manifest, "points_of_classes").items()}
            write_whole(out / "manifest.json", as_json(manifest))
            write_whole(out / "datasheet.md", datasheet(manifest).encode())
            write_whole(out / CONFIGURATION, configuration(self.bird_class, points, map(int, contents)).encode())
        ranks.wait()
        return manifest

    def _inputs_of(self, common: Dict[str, str], number: int, scans: Optional[int] = None) -> Dict[str, str]:
        """Of a sequence of so many scans, by default those that it has here."""
        span = self.span(number)
        return {**common, "scans": f"{span.start} to {span.start + scans if scans else span.stop}"}

    def _is_there(self, folder: pathlib.Path, number: int, common: Dict[str, str]) -> bool:
        """False for a sequence that has fewer scans, too; `Error` unless it is whole, made of the same."""
        if not folder.exists():
            return False
        if not (folder / DONE).exists():
            raise Error(f"{folder}: is there without {DONE}, so it is no whole sequence; choose another folder or remove it")
        content = load_json(folder / DONE)
        known: Dict[str, Any] = content if isinstance(content, dict) else {}
        scans, wanted = known.get("scans"), len(self.span(number))
        scans = scans if isinstance(scans, int) and 0 < scans <= self.length else wanted
        if known.get("identity") != _identity(self._inputs_of(common, number, scans)):
            inputs = self._inputs_of(common, number)
            raise Error(f"{folder} is of another scenario, scene or version: {_difference(known.get('inputs'), inputs)}; choose another "
                        "folder or remove it")
        if scans > wanted:
            raise Error(f"{folder}: has {scans} scans, and number_of_scans is {self.scans}: {_FEWER}")
        if scans < wanted:
            return False
        wrong = [name for name, keys in zip(TABLES, (map(str, classes_of(self.bird_class)), STATUSES, SUBSETS)) if not isinstance(known.get(name), dict)
                 or not {*known[name]} <= {*keys} or not all(isinstance(count, int) for count in known[name].values())]
        wrong += [name for name in COUNTS if not isinstance(known.get(name), int)]
        if wrong:
            raise Error(f"{folder / DONE}: {wrong[0]} is missing or no count. {_AGAIN}")
        _check_scans(folder, wanted)
        if known.get("sha256") != _digest(folder):
            raise Error(f"{folder}: its files are not those that its {DONE} has the sha256 of: something else has changed, added or removed "
                        f"some. {_AGAIN}")
        return True


def _short(value: Any) -> str:
    """A value in words that are others for another value, in whatever order its keys are."""
    text = json.dumps(value, sort_keys=True)
    return text if len(text) <= 80 else hashlib.sha256(text.encode()).hexdigest()[:32]


def _identity(inputs: Dict[str, str]) -> str:
    return hashlib.sha256(as_json(inputs)).hexdigest()


def _difference(before: Any, now: Dict[str, str]) -> str:
    """Which inputs are others than those that a sequence was made of."""
    if not isinstance(before, dict):
        return "what it was made of is not known"
    names = [name for name in {*before, *now} if before.get(name) != now.get(name)]
    names.sort(key=lambda name: (len(now.get(name, "")), name))  # numbers before checksums
    words = [f"{name} {before.get(name, 'not set')}, now {now.get(name, 'not set')}" for name in names[:SHOWN]]
    return "; ".join(words + ([f"and {len(names) - SHOWN} more"] if len(names) > SHOWN else []))


def _check_scans(folder: pathlib.Path, count: int) -> None:
    """`Error` unless a sequence has all its scans and no more, with a label and a subset for each point."""
    points = [{file.stem: file.stat().st_size / size for file in (folder / name).glob(f"*{suffix}")} for name, suffix, size in ALL]
    whole = sum(len({of.get(f"{number:06d}", ~i) for i, of in enumerate(points[:len(FOLDERS)])}) == 1 for number in range(count))
    if whole < count or any(len(of) != count for of in points):
        raise Error(f"{folder}: {whole} of {count} scans are whole, and there are {len(points[0])}: something else has changed files "
                    f"there. {_AGAIN}")


def _digest(folder: pathlib.Path) -> str:
    """Of names and contents of all files of a sequence, of those that others have put beside them none."""
    scans = [path for name, suffix, _ in ALL for path in (folder / name).glob(f"*{suffix}")]
    digest = hashlib.sha256()
    for path in sorted([*scans, *map(folder.joinpath, TEXTS)]):
        digest.update(str(path.relative_to(folder)).encode() + b"\0" + (path.read_bytes() if path.is_file() else b""))
    return digest.hexdigest()


def _sums(manifest: Dict[str, Any], key: str) -> Counter[str]:
    """A table of counts, over all sequences."""
    return sum((collections.Counter(part[key]) for part in manifest["sequences"].values()), collections.Counter())


def datasheet(manifest: Dict[str, Any]) -> str:
    """What is in a set of sequences, as Markdown."""
    parts = list(manifest["sequences"].values())
    points, statuses, subsets = (_sums(manifest, key) for key in TABLES)
    scans, seen = (sum(part[key] for part in parts) for key in COUNTS)
    scenario = manifest["scenario"]
    classes = classes_of(scenario.get("bird_class", BIRD))
    lines = ["# Data sheet", "", f"{scans} scans of {manifest['beams']} beams in {len(parts)} sequences; avian-lidar "
             f"{manifest['avian_lidar_version']}. Simulated: nothing here was measured.", "",
             f"Scene {pathlib.Path(scenario['scene']).name}, sensor {scenario['sensor']['preset']}. Birds are seen in "
             f"{seen} scans ({100 * seen / max(scans, 1):.1f} %).", "",
             f"Weather: {in_words(scenario.get('weather', ())) or 'none but what the settings of scan say'}.", "",
             "Assumed: " + ("; ".join(manifest["assumed"]) or "no number of the sensor")
             + "; species, plumage, shapes and flights of birds; sizes of sway and jitter.", "",
             "| class (low 16 bits) | name | points | share |", "|---:|---|---:|---:|"]
    total = max(sum(points.values()), 1)
    lines += [f"| {label} | {classes[label].name}: {classes[label].here} | {count} | {100 * count / total:.3f} % |"
              for label, count in sorted((int(name), count) for name, count in points.items())]
    lines += ["", "| a bird in a scan | times |", "|---|---:|"]
    lines += [f"| {name} | {statuses[name]} |" for name in STATUSES]
    lines += ["", "| birds seen | times |", "|---|---:|"] + [f"| {name} | {subsets[name]} |" for name in SUBSETS]
    lines += ["", "## Scenario", "", "```json", json.dumps(scenario, indent=1), "```", ""]
    return "\n".join(lines)
