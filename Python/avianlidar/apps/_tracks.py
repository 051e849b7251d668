# SPDX-License-Identifier: BSD-3-Clause
"""A report card of tracks in labelled sequences: the command `avianlidar track`."""
from __future__ import annotations

import itertools
import os
import pathlib
from typing import Any, Callable, Dict, Optional, Sequence as Many, Union

import numpy as np

from .. import vtkAvianLidar as _wrapped
from .._disk import only_run, write_whole
from .._files import checked_name
from .._pipeline import Error
from .._properties import in_snake_case
from .._ranks import Ranks, as_json
from .._sensor import Sensor
from .._version import __version__
from .._weather import without_air
from . import _scores as scores
from ._card import write_card
from ._following import Chain, Input, Scorer, origin_of, read_truth
from ._json import load_json, naming
from ._regions import Runway
from ._inputs import read_scenario
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

    def __init__(self, inputs: Many[Union[str, "os.PathLike[str]"]], runways=None, learning_scans: int = LEARNING, cutoff: float = CUTOFF,
                 order: float = ORDER, clutter: Optional[Dict[str, Any]] = None, tracker: Optional[Dict[str, Any]] = None,
                 sensors: Many[str] = (), threads: int = 0, **changes: Any):
        """Checks the inputs and settings; `write` does the work.

        inputs          folders that `Sequence.write` has made, and scenarios, whose sequences are made first; inputs are compared
        runways         a GeoJSON file, for warning times before birds enter a strip or a glide path
        learning_scans  scans at the beginning of a sequence from which only clutter is learned; these scans are not scored
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
                    raise ValueError(f"{given} holds finished sequences, but {', '.join(asked)} is for scenarios: expected a scenario")
                self._add(given.resolve().name, given)
                continue
            scenario, stem = read_scenario(given), given.name.split(".")[0]
            if "weather" in changes:
                scenario["scan"] = without_air(scenario.get("scan", {}))
            for sensor in sensors or ("",):
                changed = {**scenario, "sensor": {**scenario["sensor"], "preset": str(pathlib.Path(sensor).resolve())
                                                  if sensor.endswith(".json") else sensor}} if sensor else scenario
                name = "-".join([stem, pathlib.Path(sensor).name.split(".")[0]] if sensor else [stem])
                self._add(name, None)
                with naming(str(given)):
                    self.made[name] = Sequence(changed, threads=threads, **changes)
        if not self.folders:
            raise ValueError("no sequences are given, expected at least a folder or a scenario")

    def _add(self, name: str, folder: Optional[pathlib.Path]) -> None:
        checked_name(name, "the name of an input")
        if name in self.folders:
            raise Error(f"the name {name!r} is there twice, expected inputs of different names, because "
                        "results are in folders of these names")
        self.folders[name] = folder or pathlib.Path()

    def write(self, folder, ranks: Optional[Ranks] = None, progress: Optional[Progress] = None) -> Dict[str, Any]:
        """Makes the sequences of scenarios (`folder`/sequences/NAME), follows the birds of each sequence
        (`folder`/followed/NAME/NN.json), then writes card.html, card.csv, card.json, tracks.csv, birds.csv and pictures. Results of the
        same files and settings are kept. Each rank takes whole sequences. @param progress called with the name of the work, the completed
        amount and the total @return the content of card.json"""
        ranks, out = ranks or Ranks(), pathlib.Path(folder)
        def known() -> Any:
            return (list(self.folders.items()), [(name, made.decides()) for name, made in self.made.items()], self.runways, self.learning, self.cutoff,
                    self.order, self.clutter, self.tracker)
        with only_run(out, ranks, goes_on=True, known=known), ranks.together():
            return self._write(out, ranks, progress or (lambda *_: None))

    def _write(self, out: pathlib.Path, ranks: Ranks, progress: Progress) -> Dict[str, Any]:
        for name in self.made:
            self.folders[name] = out / "sequences" / name
            made, scans, what = self.made[name], itertools.count(1), f"scans of {name}"
            made.write(self.folders[name], ranks, lambda *_: progress(what, next(scans), made.scans_to_do))
        inputs = [Input(path, name) for name, path in self.folders.items()]
        chains = [Chain(of.sensor, self.learning, self.clutter, self.tracker) for of in inputs]
        everywhere = [of.runways(self.runways) for of in inputs]
        mine = [(*one, number) for one in zip(inputs, chains, everywhere) for number in one[0].numbers][ranks.rank::ranks.size]
        done, total = 0, sum(int(of.content[number]["scans"]) for of, _, _, number in mine)
        for of, chain, runways, number in mine:
            file = out / FOLLOWED / of.name / f"{number}.json"
            identity = self._identity(of, number, chain, runways)
            if not _is_of(file, identity):
                found = self._follow(of, number, chain, runways, lambda scans: progress("scans followed", done + scans, total))
                file.parent.mkdir(parents=True, exist_ok=True)
                write_whole(file, as_json({"identity": identity, **found}))
            done += int(of.content[number]["scans"])
        ranks.wait()
        card: Dict[str, Any] = {}
        if ranks.rank == 0:
            results = [{number: load_json(out / FOLLOWED / of.name / f"{number}.json") for number in of.numbers} for of in inputs]
            settings = {"learning_scans": self.learning, "cutoff": self.cutoff, "order": self.order,
                        "runways": [[runway.name for runway in runways] for runways in everywhere], "chains": [chain.properties() for chain in chains]}
            card = write_card(out, inputs, results, everywhere, settings, progress)
        ranks.wait()
        return card

    def _identity(self, of: Input, number: str, chain: Chain, runways: Many[Runway]) -> str:
        """Checksum of everything that decides the results of a sequence."""
        return _identity({"sequence": of.content[number]["sha256"], "inputs": of.content[number]["identity"], "version": __version__,
                          "runways": _short([[r.name, r.start, r.end] for r in runways]), "learning": str(self.learning), "cutoff": repr(self.cutoff),
                          "order": repr(self.order), **chain.properties()})

    def _follow(self, of: Input, number: str, chain: Chain, runways: Many[Runway], step: Callable[[int], Any]) -> Dict[str, Any]:
        home = of.folder / "sequences" / number
        truth, count = read_truth(home / "truth.csv"), int(of.content[number]["scans"])
        if count <= self.learning:
            raise Error(f"{home}: has {count} scans, expected more than the {self.learning} scans from which only clutter is learned")
        scorer = Scorer(self.cutoff, self.order, runways)
        shown: Dict[str, Any] = {}
        with chain:
            for k, (scan, time, points, placed, times, labels) in enumerate(of.scans(number)):
                live, origins = chain(points, placed, times, time), origin_of(labels)
                if k >= self.learning:
                    scorer.add(scan, truth.get(scan, []), live, origins)
                if k == count - 1:
                    shown = {"scan": scan, "points": np.round(placed, 1).tolist(), "origins": origins.tolist(), "clutter": live.clutter.astype(int).tolist()}
                step(k + 1)
        return {**scorer.results(), "seconds": (count - self.learning) / of.sensor.rotation_rate, "shown": shown}


def _is_of(file: pathlib.Path, identity: str) -> bool:
    """Whether a file holds the results of these inputs and settings."""
    try:
        known = load_json(file)
    except Error:
        return False
    return isinstance(known, dict) and known.get("identity") == identity and "birds" in known
