# SPDX-License-Identifier: BSD-3-Clause
"""A report card of tracks in labelled sequences: the command `avianlidar track`."""
from __future__ import annotations

import hashlib
import itertools
import os
import pathlib
from typing import Any, Callable, Dict, Optional, Sequence as Many, Union

import numpy as np

from ... import vtkAvianLidar as _wrapped
from ..._disk import only_run, write_whole
from ..._files import checked_name
from ..._pipeline import Error
from ..._properties import in_snake_case
from ..._ranks import Ranks, as_json
from ..._sensor import Sensor
from ..._version import __version__
from ..._weather import without_air
from ..inputs._json import load_json, naming
from ..inputs._read import read_scenario
from ..pages._words import counted
from ..places._regions import Runway
from . import _scores as scores
from ._card import write_card
from ._following import Chain, Input, origin_of, read_truth, score
from ._sequence import Sequence, _identity, _short

CUTOFF = 20.0  # m: a track at this distance from a bird is not assigned to the bird
ORDER = 2.0  # order of OSPA
FOLLOWED = "followed"  # folder of the results of sequences
LEARNING = 20  # scans at the beginning of a sequence from which only clutter is learned

Progress = Callable[[str, int, int], Any]


class BirdTracks:
    """Tracks of the birds in labelled sequences, and scores of these tracks.

    >>> tracks = BirdTracks(["build/sequences"], runways="Examples/airport/scene/hongqiao.geojson")   # doctest: +SKIP
    >>> tracks.write("build/tracks")                                                                  # doctest: +SKIP
    """

    def __init__(self, inputs: Many[Union[str, "os.PathLike[str]"]], runways=None, learning_scans: int = LEARNING,
                 cutoff: float = CUTOFF, order: float = ORDER, clutter: Optional[Dict[str, Any]] = None,
                 tracker: Optional[Dict[str, Any]] = None, sensors: Many[str] = (), threads: int = 0, **changes: Any):
        """Checks the inputs and settings; `write` does the work.

        inputs          folders that `Sequence.write` has made, and scenarios, whose sequences are made first
        runways         a GeoJSON file, for warning times before birds enter a strip or a glide path
        learning_scans  scans at the beginning of a sequence from which only clutter is learned; they are not scored
        cutoff          m: a track at this distance from a bird is not assigned to the bird; also the cut-off of OSPA
        order           order of OSPA
        clutter         properties of vtkAvianLidarClutterFilter by name
        tracker         properties of vtkAvianLidarTracker by name
        sensors         sensors that replace the sensor of scenarios: presets, or .lidarsensor.json files
        threads         number of threads for scenarios
        changes         changes of scenarios, for example number_of_scans
        """
        scores.ospa(np.zeros((0, 0)), cutoff, order)  # raises errors of cutoff and order before the work
        if not isinstance(learning_scans, int) or learning_scans < 0:
            raise ValueError(f"learning_scans is {learning_scans}, expected a whole number from 0 on")
        self.runways = pathlib.Path(runways) if runways else None
        self.learning, self.cutoff, self.order = learning_scans, float(cutoff), float(order)
        self.clutter = in_snake_case(_wrapped.vtkAvianLidarClutterFilter, dict(clutter or {}), "clutter")
        self.tracker = in_snake_case(_wrapped.vtkAvianLidarTracker, dict(tracker or {}), "tracker")
        Chain(Sensor(), self.learning, self.clutter, self.tracker)
        self.made: Dict[str, Sequence] = {}
        self.folders: Dict[str, pathlib.Path] = {}
        for given in map(pathlib.Path, inputs):
            if given.is_dir():
                asked = [name for name, value in (("sensors", sensors), *changes.items()) if value]
                if asked:
                    raise ValueError(f"{given} holds finished sequences, but {', '.join(asked)} is for scenarios: "
                                     "expected a scenario")
                self._add(given.resolve().name, given)
                continue
            scenario, stem = read_scenario(given), given.name.split(".")[0]
            if "weather" in changes:
                scenario["scan"] = without_air(scenario.get("scan", {}))
            for sensor in sensors or ("",):
                name = self._add("-".join([stem, pathlib.Path(sensor).name.split(".")[0]] if sensor else [stem]))
                preset = str(pathlib.Path(sensor).resolve()) if sensor.endswith(".json") else sensor
                changed = {**scenario["sensor"], "preset": preset or scenario["sensor"]["preset"]}
                with naming(str(given)):
                    self.made[name] = Sequence({**scenario, "sensor": changed}, threads=threads, **changes)
        if not self.folders:
            raise ValueError("no sequences are given, expected at least a folder or a scenario")

    def _add(self, name: str, folder: pathlib.Path = pathlib.Path()) -> str:
        if checked_name(name, "the name of an input") in self.folders:
            raise Error(f"the name {name!r} is there twice, expected inputs of different names, because "
                        "results are in folders of these names")
        self.folders[name] = folder
        return name

    def write(self, folder, ranks: Optional[Ranks] = None, progress: Optional[Progress] = None,
              page: Optional[Callable[[], bool]] = None) -> Dict[str, Any]:
        """Makes the sequences of scenarios (`folder`/sequences/NAME), follows the birds of each sequence
        (`folder`/followed/NAME/NN.json), then writes card.html, card.csv, card.json, tracks.csv, birds.csv and
        pictures. Results of the same files and settings are kept. Each rank takes whole sequences. @param progress
        called with the name of the work, the completed amount and the total @param page writes view.html after the
        tables, and returns whether it is there for a link @return the content of card.json"""
        ranks, out, step = ranks or Ranks(), pathlib.Path(folder), progress or (lambda *_: None)

        def known() -> Any:
            return (list(self.folders.items()), [(name, made.decides()) for name, made in self.made.items()],
                    self.runways, self.learning, self.cutoff, self.order, self.clutter, self.tracker)
        with only_run(out, ranks, goes_on=True, known=known), ranks.together():
            for name, made in self.made.items():
                self.folders[name] = out / "sequences" / name
                what, scans = f"scans of {name}", itertools.count(1)
                made.write(self.folders[name], ranks, lambda *_: step(what, next(scans), made.scans_to_do))
            inputs = [Input(path, name) for name, path in self.folders.items()]
            chains = [Chain(of.sensor, self.learning, self.clutter, self.tracker) for of in inputs]
            everywhere = [of.runways(self.runways) for of in inputs]
            jobs = [(of, chain, runways, number) for of, chain, runways in zip(inputs, chains, everywhere)
                    for number in of.numbers][ranks.rank::ranks.size]
            done, total = 0, sum(of.content[number]["scans"] for of, _, _, number in jobs)
            for of, chain, runways, number in jobs:
                file, identity = _file(out, of, number), self._identity(of, number, chain, runways)
                if not _is_of(file, identity):
                    found = self._follow(of, number, chain, runways,
                                         lambda scans: step("scans followed", done + scans, total))
                    file.parent.mkdir(parents=True, exist_ok=True)
                    write_whole(file, as_json({"identity": identity, "sha256": _sum(found), **found}))
                done += of.content[number]["scans"]
            ranks.wait()
            card: Dict[str, Any] = {}
            if ranks.rank == 0:
                results = [{number: load_json(_file(out, of, number)) for number in of.numbers} for of in inputs]
                settings = {"learning_scans": self.learning, "cutoff": self.cutoff, "order": self.order,
                            "runways": [[runway.name for runway in runways] for runways in everywhere],
                            "chains": [chain.properties() for chain in chains]}
                card = write_card(out, inputs, results, everywhere, settings, step, page)
            ranks.wait()
            return card

    def _identity(self, of: Input, number: str, chain: Chain, runways: Many[Runway]) -> str:
        """Checksum of everything that decides the results of a sequence."""
        return _identity({"sequence": of.content[number]["sha256"], "inputs": of.content[number]["identity"],
                          "version": __version__, "runways": _short([[r.name, r.start, r.end] for r in runways]),
                          "learning": str(self.learning), "cutoff": repr(self.cutoff), "order": repr(self.order),
                          **chain.properties()})

    def _follow(self, of: Input, number: str, chain: Chain, runways: Many[Runway],
                step: Callable[[int], Any]) -> Dict[str, Any]:
        home, count = of.folder / "sequences" / number, of.content[number]["scans"]
        if count <= self.learning:
            raise Error(f"{home}: has {counted(count, 'scan')}, "
                        f"expected more than the {self.learning} scans from which only clutter is learned")
        truth, scans = read_truth(home / "truth.csv"), []
        for k, (scan, live) in enumerate(chain.follow(of.scans(number))):
            if k >= self.learning:
                scans.append((scan.number, truth.get(scan.number, []), live, origin_of(scan.labels).astype(np.uint8)))
            step(k + 1)
        shown = {"scan": scan.number, "points": np.round(scan.placed, 1).tolist(), "origins": scans[-1][-1].tolist(),
                 "clutter": live.clutter.astype(int).tolist()}
        return {**score(scans, self.cutoff, self.order, runways),
                "seconds": (count - self.learning) / of.sensor.rotation_rate, "shown": shown}


def _file(out: pathlib.Path, of: Input, number: str) -> pathlib.Path:
    """The results of a sequence."""
    return out / FOLLOWED / of.name / f"{number}.json"


def _sum(found: Dict[str, Any]) -> str:
    """Checksum of results."""
    return hashlib.sha256(as_json(found)).hexdigest()


def _is_of(file: pathlib.Path, identity: str) -> bool:
    """Whether a file holds the results of these inputs and settings, as they were written."""
    try:
        known = load_json(file)
    except Error:  # also for a missing file
        return False
    if not isinstance(known, dict):
        return False
    found = {name: value for name, value in known.items() if name not in ("identity", "sha256")}
    return (known.get("identity"), known.get("sha256")) == (identity, _sum(found))
