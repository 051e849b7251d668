# SPDX-License-Identifier: BSD-3-Clause
"""Labelled sequences of scans with birds, for training and testing."""
from __future__ import annotations

import collections
import hashlib
import json
import os
import pathlib
import secrets
import shutil
import warnings
from typing import Any, Callable, Counter, Dict, List, Optional

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from ... import vtkAvianLidar as _wrapped
from ..._cloud import Cloud, add_array, with_points
from ..._disk import only_run, synchronize, write_whole
from ..._files import numbers_of, read_regular
from ..._pipeline import Error, Updates, callers_level
from ..._ranks import Ranks, as_json, digest_of, digest_of_arrays
from ..._version import __version__
from ..._weather import in_words
from ..._writers import as_csv
from ..inputs._json import load_json
from ..inputs._read import with_files
from ..pages._words import counted
from ._boxes import Boxes
from ._labels import BIRD, classes_of, configuration, relabel
from ._simulation import STATUSES, SUBSETS, TRUTH, Simulation

DONE = "done.json"
PART = ".part"  # suffix of a folder that is being written
FOLDERS = {"velodyne": ".bin", "labels": ".label", "subsets": ".subset", "boxes": ".txt"}  # suffix of the files
OFFSETS = {"offsets": ".offset"}  # only without motion correction: s from the start of the scan, float32
POINT = {"velodyne": 16, "labels": 4, "subsets": 1, "offsets": 4}  # bytes of a point
TEXTS = ("truth.csv", "times.txt", "poses.txt", "calib.txt")  # files of a whole sequence
TABLES = ("points_of_classes", "birds_of_statuses", "birds_seen_of_subsets")  # tables in DONE
COUNTS = ("scans", "scans_with_birds_seen")
_AGAIN = "Remove the folder, and make the sequence again"
_OTHER = "choose another folder or remove this folder"
_FEWER = "choose at least as many scans as the folder has, or another folder"
SHOWN = 3  # number of differing inputs in an error
# Settings that change no bit of a scan; numbers of scans and of revolutions decide which scans exist.
NO_BIT = ("number_of_threads", "controller", "maximum_cache_size", "batch_collision_detection", "number_of_revolutions",
          "number_of_scans")
CONFIGURATION = "semantic-kitti.yaml"
Progress = Callable[[int, int, int], None]


class Sequence(Simulation):
    """Scans of a scenario, with labels.

    >>> sequence = Sequence("Examples/sequence/hongqiao.scenario.json", number_of_scans=200)   # doctest: +SKIP
    >>> sequence.write("build/sequence")                                                       # doctest: +SKIP
    """

    def _write_one(self, folder: pathlib.Path, number: int, progress: Optional[Progress]) -> Dict[str, Any]:
        """Writes the files of a sequence. @return a description of the content"""
        moves, corrected = self.trajectory is not None, bool(self.scenario.get("motion_correction", True))
        for name in FOLDERS if corrected else (*FOLDERS, *OFFSETS):
            (folder / name).mkdir(parents=True)
        boxes = Boxes(self.scene.tree, self.mount, self._pose(self.mount.beams.data))
        poses: List[np.ndarray] = []
        writer = _wrapped.vtkAvianLidarKITTIWriter()
        table: List[Dict[str, Any]] = []
        classes: Counter[int] = collections.Counter()
        scans = self.span(number)
        with Updates(writer) as write:
            for k, scan, species in self.frames(number):
                echoes, name = scan.algorithm.GetOutput(0), f"{k - scans.start:06d}"
                poses.append(self._pose(echoes))
                writer.SetInputData(echoes if corrected else as_recorded(echoes))
                writer.SetFileName(str(folder / "velodyne" / f"{name}.bin"))
                write(writer.Write)
                labels = relabel(np.fromfile(folder / "velodyne" / f"{name}.label", np.uint32), self.bird_class)
                labels.tofile(folder / "labels" / f"{name}.label")
                os.remove(folder / "velodyne" / f"{name}.label")
                points = Cloud(echoes)
                _, subset = self.clutter.look(points["beam_id"], points["distance_m"])
                (folder / "subsets" / f"{name}.subset").write_bytes(subset.tobytes())
                if not corrected:
                    offsets = 1e-6 * points["timestamp"] - k / self.sensor.rotation_rate
                    (folder / "offsets" / f"{name}.offset").write_bytes(offsets.astype("<f4").tobytes())
                (folder / "boxes" / f"{name}.txt").write_text(
                    boxes.lines(Cloud(scan.algorithm.GetOutput(2)), scan.movers, self._pose_at if moves else None,
                                poses[-1] if corrected else None), encoding="utf-8")
                table += self._truth(k, species)
                classes.update((labels & 0xffff).tolist())
                if progress:
                    progress(number, k - scans.start + 1, len(scans))
        np.savetxt(folder / "times.txt", np.array(scans) / self.sensor.rotation_rate, "%.6f")
        np.savetxt(folder / "poses.txt", [pose.ravel() for pose in poses], "%.9g")
        names = "P0", "P1", "P2", "P3", "Tr"
        (folder / "calib.txt").write_text("".join(f"{name}: 1 0 0 0 0 1 0 0 0 0 1 0\n" for name in names))
        (folder / "truth.csv").write_bytes(as_csv([TRUTH, *([*row.values()] for row in table)]))
        seen = [row for row in table if row["status"] == "seen"]
        statuses, subsets = [row["status"] for row in table], [row["subset"] for row in seen]
        return {"scans": len(scans), "scans_with_birds_seen": len({row["scan"] for row in seen}),
                "points_of_classes": dict(classes),
                "birds_of_statuses": {name: statuses.count(name) for name in STATUSES},
                "birds_seen_of_subsets": {name: subsets.count(name) for name in SUBSETS}}

    def _inputs(self) -> Dict[str, str]:
        """Everything that the files depend on, by name, as found: the scenario, the files that the scenario names, the
        scene, and each property of sensor and scan, whether set or default."""
        scenario = with_files({**self.scenario, "scene": ""},
                              lambda name: name and hashlib.sha256(read_regular(name)).hexdigest())
        parts = {"scenario": {name: part for name, part in scenario.items() if name not in ("scene", "sensor", "scan")},
                 "sensor": {**self.sensor.properties(), "beams": digest_of_arrays(self.mount.beams.data)},
                 "scan": self.scan.properties()}
        found = {f"{part}.{name}": _short(value) for part, values in parts.items() for name, value in values.items()
                 if name not in NO_BIT}
        return {"version": __version__, "scene": digest_of(self.scene.tree.GetOutput()), **found}

    def decides(self) -> Any:
        """Everything that decides which files `write` makes."""
        return self.scans, sorted(self._inputs().items())

    def write(self, folder, ranks: Optional[Ranks] = None, progress: Optional[Progress] = None) -> Dict[str, Any]:
        """Makes the missing sequences of `folder`/sequences/NN, manifest.json and datasheet.md. @return the manifest

        A sequence gets its name when it is complete, so a killed run can be started again and continues with the next
        sequence. More scans add sequences; a sequence that had fewer scans is made again, with a warning. Sequences of
        another scenario, more scans than requested, and changed files are errors. Each rank makes whole sequences.
        semantic-kitti.yaml beside the manifest is the configuration for programs that read SemanticKITTI, and
        trajectory.vtp the trajectory of a sensor that moves, for ParaView.

        progress  called with the number of the sequence, its finished scans and all its scans
        """
        ranks, out = ranks or Ranks(), pathlib.Path(folder)
        with only_run(out, ranks, goes_on=True, known=self.decides), ranks.together():
            home, common = out / "sequences", self._inputs()
            home.mkdir(exist_ok=True)
            for folder in sorted(home.glob("[0-9]*")):
                if folder.name.isdigit() and int(folder.name) >= len(self):
                    raise Error(f"{folder}: exists, but number_of_scans is {self.scans}: {_FEWER}")
            missing = [k for k in range(len(self)) if not self._is_there(home / f"{k:02d}", k, common)]
            mine = missing[ranks.rank::ranks.size]
            self.scans_to_do = sum(len(self.span(k)) for k in mine)
            shorter = [home / f"{k:02d}" for k in missing if (home / f"{k:02d}").exists()]
            if shorter and ranks.rank == 0:
                warnings.warn(f"{shorter[0]}: has fewer scans than requested, and is made again, because flights "
                              "depend on the length of a sequence", RuntimeWarning, stacklevel=callers_level())
            ranks.wait()  # all ranks have read before any rank writes
            if ranks.rank == 0:
                for part in home.glob(f".*{PART}"):
                    shutil.rmtree(part)
            ranks.wait()
            for number in mine:
                name, inputs = f"{number:02d}", self._inputs_of(common, number)
                part, old = (home / f".{name}.{secrets.token_hex(4)}{PART}" for _ in range(2))
                try:
                    content = self._write_one(part, number, progress)
                    content.update(inputs=inputs, identity=_identity(inputs), sha256=_digest(part))
                    write_whole(part / DONE, as_json(content))
                    os.sync()
                    if home / name in shorter:
                        os.replace(home / name, old)
                    os.replace(part, home / name)
                except BaseException as error:
                    shutil.rmtree(part, ignore_errors=True)
                    if isinstance(error, OSError) and not error.filename:  # such as a full disk
                        raise OSError(error.errno, error.strerror, str(home / name)) from None
                    raise
                shutil.rmtree(old, ignore_errors=True)
                synchronize(home)
            ranks.wait()
            contents = {f"{k:02d}": load_json(home / f"{k:02d}" / DONE) for k in range(len(self))}
            for content in contents.values():
                del content["inputs"]
            manifest = {"scenario": with_files(self.scenario, lambda name: os.path.relpath(name, out)),
                        "scene_digest": digest_of(self.scene.tree.GetOutput()), "avian_lidar_version": __version__,
                        "beams": self.sensor.beams.number_of_points,
                        "assumed": self.sensor.beams.fields.get("assumed", []), "sequences": contents}
            if ranks.rank == 0:
                points = {int(label): count for label, count in _sums(manifest, "points_of_classes").items()}
                write_whole(out / "manifest.json", as_json(manifest))
                write_whole(out / "datasheet.md", datasheet(manifest).encode())
                if self.trajectory is not None:
                    Cloud(self.trajectory).save(out / "trajectory.vtp")
                write_whole(out / CONFIGURATION, configuration(self.bird_class, points, map(int, contents)).encode())
            ranks.wait()
            return manifest

    def _inputs_of(self, common: Dict[str, str], number: int, scans: Optional[int] = None) -> Dict[str, str]:
        """Inputs of a sequence with a number of scans; default: the scans of the sequence in this scenario."""
        span = self.span(number)
        return {**common, "scans": f"{span.start} to {span.start + scans if scans else span.stop}"}

    def _is_there(self, folder: pathlib.Path, number: int, common: Dict[str, str]) -> bool:
        """Whether a sequence is complete and has its scans. `Error` if it is damaged or was made from other inputs."""
        if not folder.exists():
            return False
        if not (folder / DONE).exists():
            raise Error(f"{folder}: has no {DONE}, so the sequence is incomplete; {_OTHER}")
        content = load_json(folder / DONE)
        known: Dict[str, Any] = content if isinstance(content, dict) else {}
        scans, wanted = known.get("scans"), len(self.span(number))
        scans = scans if isinstance(scans, int) and 0 < scans <= self.length else wanted
        if known.get("identity") != _identity(self._inputs_of(common, number, scans)):
            difference = _difference(known.get("inputs"), self._inputs_of(common, number))
            raise Error(f"{folder} was made from another scenario, scene or version: {difference}; {_OTHER}")
        if scans > wanted:
            raise Error(f"{folder}: has {counted(scans, 'scan')}, but number_of_scans is {self.scans}: {_FEWER}")
        if scans < wanted:
            return False

        def is_wrong(table: Any, allowed: Any) -> bool:
            return not isinstance(table, dict) or not set(table) <= set(allowed)
        classes = [str(label) for label in classes_of(self.bird_class)]
        wrong = [name for name, allowed in zip(TABLES, (classes, STATUSES, SUBSETS))
                 if is_wrong(known.get(name), allowed)]
        if wrong:
            raise Error(f"{folder / DONE}: {wrong[0]} is missing or is not a count. {_AGAIN}")
        content_of(folder)
        return True


def as_recorded(echoes: vtkPolyData) -> vtkPolyData:
    """Echoes of a sensor that moves, in its frame at the firing of each beam, as a real lidar records them."""
    data = vtkPolyData()
    data.ShallowCopy(echoes)
    data.SetPoints(with_points(Cloud(echoes).coordinates("sensor", motion_correction=False)).GetPoints())
    for name in ("position", "orientation"):
        add_array(data.GetFieldData(), name, np.zeros((1, 3)))
    return data


def _short(value: Any) -> str:
    """A short text of a value, different for different values and independent of the order of keys."""
    text = json.dumps(value, sort_keys=True)
    return text if len(text) <= 80 else hashlib.sha256(text.encode()).hexdigest()[:32]


def _identity(inputs: Dict[str, str]) -> str:
    return hashlib.sha256(as_json(inputs)).hexdigest()


def _difference(before: Any, now: Dict[str, str]) -> str:
    """Words on the inputs that differ from those of a sequence."""
    if not isinstance(before, dict):
        return "the inputs of the sequence are not known"
    names = [name for name in {*before, *now} if before.get(name) != now.get(name)]
    names.sort(key=lambda name: (len(now.get(name, "")), name))  # numbers before checksums
    words = [f"{name} {before.get(name, 'not set')}, now {now.get(name, 'not set')}" for name in names[:SHOWN]]
    return "; ".join(words + ([f"and {len(names) - SHOWN} more"] if len(names) > SHOWN else []))


def content_of(folder: pathlib.Path) -> Dict[str, Any]:
    """The content of DONE; `Error` unless all files are those with which the sequence was made."""
    content = load_json(folder / DONE)
    if not isinstance(content, dict) or not isinstance(content.get("inputs"), dict) or \
            content.get("sha256") != _digest(folder):
        raise Error(f"{folder}: its files differ from the sha256 in its {DONE}: "
                    f"another program has changed, added or removed files. {_AGAIN}")
    tables = [content.get(name) for name in TABLES] + [{name: content.get(name)} for name in COUNTS]
    for name, table in zip((*TABLES, *COUNTS), tables):
        if not isinstance(table, dict) or any(type(count) is not int or count < 0 for count in table.values()):
            raise Error(f"{folder / DONE}: {name} is missing or is not a count. {_AGAIN}")
    _check_scans(folder, content["scans"])
    return content


def _folders_of(folder: pathlib.Path) -> Dict[str, str]:
    """The folders of the scans of a sequence, with the suffix of their files."""
    return {**FOLDERS, **OFFSETS} if (folder / "offsets").is_dir() else FOLDERS


def _check_scans(folder: pathlib.Path, count: int) -> None:
    """`Error` unless all folders of a sequence hold its scans, with a label and a subset for each point, a time and a
    pose."""
    names = [f"{number:06d}" for number in range(count)]
    folders = _folders_of(folder)
    for name, suffix in folders.items():
        if sorted(file.stem for file in (folder / name).glob(f"*{suffix}")) != names:
            raise Error(f"{folder / name}: expected the files of {counted(count, 'scan')}, 000000{suffix} and so on. "
                        f"{_AGAIN}")
    for name in names:
        points = (folder / "velodyne" / f"{name}.bin").stat().st_size / POINT["velodyne"]
        for kind, size in ((kind, POINT[kind]) for kind in folders if kind in POINT):
            file = folder / kind / f"{name}{folders[kind]}"
            if file.stat().st_size != size * int(points):
                raise Error(f"{file}: has {file.stat().st_size} bytes, expected {size} for each of "
                            f"{int(points)} points. {_AGAIN}")
    for text, columns in (("times.txt", 1), ("poses.txt", 12)):
        if len(numbers_of(folder / text, columns)) != count:
            raise Error(f"{folder / text}: expected a line for each of {counted(count, 'scan')}. {_AGAIN}")


def _digest(folder: pathlib.Path) -> str:
    """Checksum of names and contents of all files of a sequence. Other files beside them are ignored."""
    scans = [path for name, suffix in _folders_of(folder).items() for path in (folder / name).glob(f"*{suffix}")]
    digest = hashlib.sha256()
    for path in sorted([*scans, *map(folder.joinpath, TEXTS)]):
        digest.update(str(path.relative_to(folder)).encode() + b"\0" + (path.read_bytes() if path.is_file() else b""))
    return digest.hexdigest()


def _sums(manifest: Dict[str, Any], key: str) -> Counter[str]:
    """The sum of a table of counts over all sequences."""
    return sum((collections.Counter(part[key]) for part in manifest["sequences"].values()), collections.Counter())


def datasheet(manifest: Dict[str, Any]) -> str:
    """The content of a set of sequences, as Markdown."""
    parts = list(manifest["sequences"].values())
    points, statuses, subsets = (_sums(manifest, key) for key in TABLES)
    scans, seen = (sum(part[key] for part in parts) for key in COUNTS)
    scenario = manifest["scenario"]
    classes = classes_of(scenario.get("bird_class", BIRD))
    lines = ["# Data sheet", "", f"{counted(scans, 'scan')} of {counted(manifest['beams'], 'beam')} in "
             f"{counted(len(parts), 'sequence')}; avian-lidar {manifest['avian_lidar_version']}. All scans are "
             "simulated; nothing was measured. The command `avianlidar sequence` also makes a page in three dimensions, "
             "[view.html](view.html), of the first sequence.", "",
             f"Scene {pathlib.Path(scenario['scene']).name}, sensor {scenario['sensor']['preset']}. Birds are seen in "
             f"{seen} scans ({100 * seen / max(scans, 1):.1f} %).", "",
             f"Weather: {in_words(scenario.get('weather', ())) or 'none, unless the settings of scan give some'}.", "",
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
