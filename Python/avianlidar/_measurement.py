# SPDX-License-Identifier: BSD-3-Clause
"""Measurement of the settings that a scene requires of the echo filter: a ladder of settings on some beams of a scan.

1. Up to fifty beams for each beam of the sample are scanned with default settings. The scan sorts these beams into four
   kinds: beams that meet a mover, beams that meet nothing, beams that meet a surface without an echo, and beams with an
   echo. A weighted sample is drawn of each kind.
2. The reference is the mean of two scans of the sample by cells with 6400 rays. For beams whose two scans differ much,
   the reference is the mean of eight scans with 25600 rays. The error of the reference follows from the spread of its
   scans, and from the additional difference to two scans by plain rays.
3. Each setting scans the same beams, and `_echo_errors` computes the errors. A limit is kept if the bound of the error
   is below the limit. Beams with much light from second reflections are scanned with eight seeds, because a few of them
   may have most of the error, and with one seed more often less than their mean error.
4. Times are processor times of one thread over runs of neighbouring beams, which share work, less the time of a scan
   without beams. Promising settings are timed five times, with other seeds.
5. The sample is doubled, up to four times its size, if a setting that is 1.5 times as fast as all settings that
   surely keep every limit is undecided only in its share of wrong echoes. Where the sample has all beams, further seeds
   take the place of further beams.
6. The most accurate of the settings that overlap in time with the fastest one that keeps every limit is advised. Its
   time and the default's are measured again, over the whole scan. A setting that is slower and less accurate than the
   default is not advised.

Noise is off, because noise belongs to the receiver and is not an error of the model. Errors have the same bits for any
number of threads.
"""
import functools
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from . import vtkAvianLidar as _wrapped
from ._advice import KINDS, MET, NOT_MET, SETTINGS, UNDECIDED, Setting
from ._cloud import Cloud, add_array, as_numpy, with_points
from ._echo_errors import (BEAM, ENERGY, GHOST, OBJECT, RANGE, SECONDARY, SURELY, TOTAL, Found, Judge, Known, bounds,
                           in_order, per_beam, ratio_of)
from ._pipeline import Progress, update
from ._properties import get_property, property_names, set_properties, snake

CELLS, RAYS, STRATIFIED = 0, 1, 1  # choices of vtkAvianLidarEchoFilter
LADDER = [Setting(CELLS, rays, STRATIFIED, *paths) for rays in (8, 25, 100, 400, 1600)
          for paths in ((1, 0), (3, 0), (3, 2), (3, 8)) if rays >= 100 or paths != (3, 8)]
LADDER += [Setting(RAYS, rays, STRATIFIED, *paths) for rays in (8, 25, 100, 400, 1600, 6400)
           for paths in ((1, 0), (3, 0), (3, 2))]
DEFAULT, UNCONNECTED, DIRECT = (Setting(CELLS, 100, STRATIFIED, *paths) for paths in ((3, 2), (3, 0), (1, 0)))
REFERENCE, FINER = (Setting(CELLS, rays, STRATIFIED, 3, 8) for rays in (6400, 25600))
WITNESS = Setting(RAYS, 10000, STRATIFIED, 3, 2)
SEEDS, WITNESS_SEEDS, FINER_SEEDS = (1000003, 1000033), (1000037, 1000039), range(1000103, 1000111)
CANDIDATES = 50  # scanned beams for each beam of the sample
MOST_BEAMS = 4  # greatest sample, as a multiple of the chosen number of beams
RUN, RUNS = 32, 32  # neighbouring beams that are timed together, and number of such runs
TURNS = 5
SLOW = 3.0  # time relative to the fastest good setting beyond which a setting is not timed again
FASTER = 1.5  # speed relative to the fastest good setting that justifies more beams
AS_FAST = 1.03  # ratio by which times of one setting differ between two starts of a program
MUCH = 0.02  # share of an echo's energy from second reflections above which its beam is scanned with more seeds
MORE_SEEDS = 8  # number of these seeds
COARSE = 0.25  # share of a limit above which the reference of a beam is refined
OF_AIR = -2  # object_id of echoes of the air
COLUMNS = ("distance_m", "energy_received", "secondary_share", "return_energy", "object_id")  # RANGE to OBJECT


class Trial:
    """A setting, and the measured errors and times of the setting."""

    def __init__(self, setting: Setting):
        self.setting = setting
        self.found: list[Found] = []  # errors on each batch of the sample
        self.seeds = 1  # number of seeds with which all beams are scanned
        self.errors = np.full((3, 3), np.nan)  # by kind: value, lower and upper bound
        self.verdicts = np.zeros(3, int)
        self.times: list[float] = []  # time of a beam in each turn, s

    @property
    def verdict(self) -> int:
        return int(self.verdicts.min())

    @property
    def seconds(self) -> float:
        return float(np.median(self.times)) if self.times else np.nan

    def parts(self, asked: np.ndarray) -> list[float]:
        """Error bounds divided by the limits, the largest first."""
        return sorted(self.errors[:, 2] / asked, reverse=True)

    def is_as_fast_as(self, other: "Trial") -> bool:
        """Whether times do not differ: the middle halves of the turns overlap, or the times differ by 3 % at most."""
        (low, high), (least, most) = (np.percentile(one.times, (25, 75)) for one in (self, other))
        return low <= max(most, AS_FAST * other.seconds) and least <= max(high, AS_FAST * self.seconds)


def choose(trials: Sequence[Trial], asked: np.ndarray) -> Trial | None:
    """The most accurate of the settings that keep all limits and are as fast as the fastest such setting, or None."""
    met = [trial for trial in trials if trial.verdict == MET]
    if not met:
        return None
    fastest = min(met, key=lambda trial: trial.seconds)
    return min((trial for trial in met if trial.is_as_fast_as(fastest)), key=lambda trial: trial.parts(asked))


def spread(items: np.ndarray, start: float) -> np.ndarray:
    """The items in an order whose every beginning is spread evenly over all items: multiples of the golden section."""
    return items[np.argsort((start + 0.5 * (np.sqrt(5) - 1) * np.arange(len(items))) % 1)]


def some_of(beams: vtkPolyData, which: np.ndarray) -> vtkPolyData:
    """Some of the beams, with their ids."""
    some = with_points(as_numpy(beams.GetPoints().GetData())[which])
    some.GetFieldData().ShallowCopy(beams.GetFieldData())
    for name, values in {"beam_id": np.arange(beams.GetNumberOfPoints()), **Cloud(beams)}.items():
        add_array(some.GetPointData(), name, values[which])
    return some


class Scanner:
    """An echo filter with the properties of another echo filter. Nothing is kept from scan to scan."""

    def __init__(self, like: Any, beams: vtkPolyData, surfaces: Any, movers: Any, progress: Progress, **settings: Any):
        self.filter, self.progress = _wrapped.vtkAvianLidarEchoFilter(), progress
        own = {name: get_property(like, prop) for name, prop in property_names(type(like)).items()}
        own.update(noise=False, maximum_cache_size=0, report_movers=False, controller=None, **settings)
        set_properties(self.filter, **own)
        self.filter.SetSurfacesData(surfaces)
        self.filter.SetMoversData(movers)
        self.seconds, idle = 0.0, []  # time of this thread in the last scan, s
        for _ in range(TURNS):  # the first turn merges the surfaces
            self.scan(some_of(beams, np.zeros(0, int)), None, 0)
            idle.append(self.seconds)
        self.idle = float(np.median(idle))  # time of a scan without beams, s

    def scan(self, beams: vtkPolyData, setting: Setting | None, seed: int) -> np.ndarray:
        """The echoes as rows, with beams counted from 0. @param setting None: the filter's own setting"""
        if setting:
            set_properties(self.filter, **setting.properties())
        self.filter.SetSeed((seed + 2**31) % 2**32 - 2**31)
        self.filter.SetInputDataObject(0, beams)
        before = time.thread_time()
        update(self.filter, self.progress)
        self.seconds = time.thread_time() - before
        echoes, ids = Cloud(self.filter.GetOutput(0)), as_numpy(beams.GetPointData().GetArray("beam_id"))
        order = np.argsort(ids)
        columns = [order[np.searchsorted(ids, echoes["beam_id"], sorter=order)], *(echoes[name] for name in COLUMNS)]
        return in_order(np.stack(columns, axis=1).astype(float))


class Measurement:
    """The steps of the measurement, see the module."""

    def __init__(self, like: Any, inputs: Sequence[Any], asked: dict[str, float], count: int,
                 progress: Progress | None):
        """@param like an echo filter with the scan's properties @param inputs beams, surfaces, movers or None"""
        self.like = like
        self.beams, self.surfaces, self.movers = inputs
        self.asked, self.count = np.array([asked[kind] for kind in KINDS]), count
        self.progress, self.done = progress or (lambda *_: None), 0.0
        self.seed, self.threads = like.GetSeed(), like.GetNumberOfThreads()
        self.scanner, self.timer = (self.scanner_of(number, self.surfaces, self.movers) for number in (self.threads, 1))
        self.scan = self.scanner.scan
        self.fields = fields = Cloud(self.scanner.filter.GetOutput(0)).fields
        own = Setting(*(int(fields[snake(name)]) for name in SETTINGS))  # the values of a preset, if there is one
        self.trials = [Trial(setting) for setting in (own, *LADDER)]
        length = 0.5 * 299792458.0 * np.array((fields["sampling_interval"], fields["pulse_width"]))  # m
        self.judge = Judge(length.sum(), 2 * fields["lower_energy_limit"])
        self.sample = np.zeros(0, int)  # numbers of the sampled candidates
        self.batches: list[tuple[np.ndarray, Known]] = []  # batches of the sample, each with its reference
        self.bias = np.zeros(2)  # squared error of the reference
        self.seeds = 1  # number of seeds with which undecided settings scan all beams
        self.beaten = False  # whether a setting was not advised because the default is faster and more accurate

    def scanner_of(self, threads: int, surfaces: Any, movers: Any, **settings: Any) -> Scanner:
        return Scanner(self.like, self.beams, surfaces, movers, lambda *_: self.progress(self.done, "advise"),
                       number_of_threads=threads, **settings)

    # Beams.

    def look(self) -> None:
        """Finds the kind of each candidate beam."""
        random, total = np.random.default_rng(1), self.beams.GetNumberOfPoints()
        wanted = min(total, CANDIDATES * self.count)
        places = (np.arange(wanted) + random.random(wanted)) * (total / max(1, wanted))
        self.candidates = np.unique(places.astype(int))
        beams, count = some_of(self.beams, self.candidates), len(self.candidates)
        echoes = self.scan(beams, DEFAULT, self.seed)
        report = Cloud(self.scanner.filter.GetOutput(1))
        self.views = np.bincount(report["view"], minlength=6) / max(1, count)
        # A mover (0), nothing (1), a surface without an echo (2), an echo (3).
        self.kinds = np.select((report["status"] == 1, np.isin(report["status"], (0, 3))), (1, 3), 2)
        if self.movers is not None:
            still = self.scanner_of(self.threads, self.surfaces, None).scan(beams, DEFAULT, self.seed)
            for column in (RANGE, ENERGY):
                moved, stood = (per_beam(rows, count, rows[:, column]) for rows in (echoes, still))
                self.kinds[moved != stood] = 0
        self.orders = [spread(np.flatnonzero(self.kinds == kind), random.random()) for kind in range(4)]
        runs = np.unique(((np.arange(RUNS) + random.random(RUNS)) * (-(-total // RUN) / RUNS)).astype(int))
        timed = (RUN * runs[:, None] + np.arange(RUN)).ravel()
        self.timed = some_of(self.beams, timed[timed < total])

    def grow(self, count: int) -> np.ndarray:
        """Draws further beams, up to `count` in all, and returns their numbers among the candidates."""
        numbers: list[int] = []
        for order, most in zip(self.orders, (count // 4, count // 8, count // 4, count)):
            # At least one beam, so that each kind has a weight.
            numbers.append(min(len(order), max(1, min(most, count - sum(numbers)))))
        numbers[2] = min(len(self.orders[2]), numbers[2] + max(0, count - sum(numbers)))
        chosen = np.concatenate([order[:number] for order, number in zip(self.orders, numbers)])
        new = np.setdiff1d(chosen, self.sample)
        self.sample = np.append(self.sample, new)
        return new

    def weights(self) -> np.ndarray:
        """For each beam of the sample, the number of the scan's beams that the beam represents."""
        drawn = self.kinds[self.sample]
        numbers, all_ = (np.bincount(kinds, minlength=4) for kinds in (drawn, self.kinds))
        return (all_ / np.maximum(1, numbers) * (self.beams.GetNumberOfPoints() / len(self.kinds)))[drawn]

    def beams_of(self, places: np.ndarray) -> vtkPolyData:
        return some_of(self.beams, self.candidates[places])

    # The reference.

    def refer(self, new: np.ndarray) -> np.ndarray:
        """Scans the reference of new beams, and returns the first scan."""
        scans = [self.scan(self.beams_of(new), REFERENCE, seed) for seed in SEEDS]
        known = self.judge.average(scans, len(new))
        # Beams in which rare paths return much light.
        coarse = np.flatnonzero((known.x[:2] > (COARSE * self.asked[:2, None]) ** 2).any(axis=0))
        if len(coarse):
            beams = self.beams_of(new[coarse])
            finer = self.judge.average([self.scan(beams, FINER, seed) for seed in FINER_SEEDS], len(coarse))
            known = known.replaced(coarse, finer)
        self.batches.append((new, known))
        return scans[0]

    def look_at_scene(self, first: np.ndarray) -> None:
        """Analyses the light of the reference in its first scan, and the difference of plain rays."""
        new, truth = self.batches[0]
        weights = self.weights()
        beams = self.beams_of(new)
        witness = [self.scan(beams, WITNESS, seed) for seed in WITNESS_SEEDS]
        self.bias = np.array([max(0.0, ratio - SURELY * deviation) for ratio, deviation in (
            ratio_of(x, y, weights) for x, y in zip(*self.judge.compare(witness, truth)))])

        def total(rows, values=1.0):
            return (weights[rows[:, BEAM].astype(int)] * values).sum()

        one, unconnected = (self.scan(beams, Setting(CELLS, REFERENCE.rays, STRATIFIED, reflections, 0), SEEDS[0])
                            for reflections in (1, 3))
        energy = max(total(first, first[:, TOTAL]), 1e-300)
        self.secondary = total(first, first[:, TOTAL] * first[:, SECONDARY]) / energy
        self.largest = first[:, SECONDARY].max(initial=0)
        self.connected = 1 - total(unconnected, unconnected[:, TOTAL]) / energy
        self.without = [self.errors_of(Found.of(*self.judge.count(rows, truth))) for rows in (one, unconnected)]
        self.reflects_twice = self.secondary >= 1e-6 or self.without[0][0, 0] >= 1e-4 or self.without[0][2, 0] > 0

        tree, before = _wrapped.vtkAvianLidarCollisionTree(), time.process_time()
        tree.SetInputDataObject(self.surfaces)
        update(tree)
        self.tree_seconds = time.process_time() - before  # processor time of all threads
        surfaces = tree.GetOutput()
        surfaces.GetFieldData().RemoveArray("media")
        vacuum = {"attenuation_coefficient": 0.0, "visibility": 0.0, "air_backscatter": False, "rain_rate": 0.0}
        scanner, timer = (self.scanner_of(threads, surfaces, self.movers, **vacuum) for threads in (self.threads, 1))
        clear = scanner.scan(beams, REFERENCE, SEEDS[0])
        self.lost = [max(0.0, 1 - part / max(all_, 1e-300)) for part, all_ in
                     ((energy, total(clear, clear[:, TOTAL])), (total(first), total(clear)))]
        self.of_air = total(first, first[:, OBJECT] == OF_AIR) / max(total(first), 1e-300)
        self.scatters = bool(self.fields.get("media") or self.fields["air_backscatter"] or self.fields["rain_rate"])
        self.hazy, self.clear = Trial(DEFAULT), Trial(DEFAULT)
        for turn in range(TURNS if self.scatters else 0):
            self.time(self.hazy, turn, self.timer)
            self.time(self.clear, turn, timer)

    def own(self) -> np.ndarray:
        """Errors of the reference."""
        x, y = (np.hstack(parts) for parts in zip(*((truth.x, truth.y) for _, truth in self.batches)))
        errors = np.array([ratio_of(*kind, self.weights())[0] for kind in zip(x, y)])
        return np.append(np.sqrt(errors[:2] + self.bias), errors[2])

    # Settings.

    def errors_of(self, found: Found) -> np.ndarray:
        return bounds(found, self.weights(), self.own())

    def found(self, setting: Setting, number: int, some: np.ndarray | None, seed: int) -> Found:
        """The errors of a setting on a batch. @param some places in the batch; None: all"""
        new, truth = self.batches[number]
        if some is not None:
            new, truth = new[some], truth.some(some)
        return Found.of(*self.judge.count(self.scan(self.beams_of(new), setting, seed), truth))

    def measure(self, trial: Trial) -> None:
        """Measures the errors on beams of the sample, and with seeds, that the trial has not scanned yet."""
        for number in range(len(trial.found), len(self.batches)):
            found = self.found(trial.setting, number, None, self.seed + 1)
            some = self.batches[number][1].beams_between(MUCH, GHOST)
            for turn in range(1, MORE_SEEDS if len(some) and trial.setting.reflections > 1 else 1):
                found = found.with_seed(some, self.found(trial.setting, number, some, self.seed + 1 - turn))
            trial.found.append(found)
        for trial.seeds in range(trial.seeds + 1, self.seeds + 1):
            for number, found in enumerate(trial.found):
                all_, seed = np.arange(len(found.seeds)), self.seed + trial.seeds
                trial.found[number] = found.with_seed(all_, self.found(trial.setting, number, None, seed))
        whole = functools.reduce(Found.beside, trial.found)
        trial.errors = self.errors_of(whole)
        _, low, high = trial.errors.T
        trial.verdicts = np.where(high <= self.asked, MET, np.where(low > self.asked, NOT_MET, UNDECIDED))

    def time(self, trial: Trial, turn: int, scanner: Scanner, beams: vtkPolyData | None = None) -> None:
        """@param beams which are timed; default: the runs of neighbouring beams"""
        beams = beams or self.timed
        scanner.scan(beams, trial.setting, self.seed + 1 + turn)
        trial.times.append(max(1e-12, scanner.seconds - scanner.idle) / beams.GetNumberOfPoints())

    def try_all(self) -> None:
        for place, trial in enumerate(self.trials):
            self.done = 0.55 + 0.25 * place / len(self.trials)
            self.measure(trial)
            self.time(trial, 0, self.timer)
        always = (DEFAULT, UNCONNECTED, DIRECT)
        for turn in range(1, TURNS):
            self.done = 0.8 + 0.02 * turn
            limit = SLOW * (self.fastest(MET) if self.fastest(MET) < np.inf else self.fastest(UNDECIDED))
            for trial in self.trials:
                if trial is self.trials[0] or trial.setting in always or \
                        trial.verdict != NOT_MET and trial.seconds < limit:
                    self.time(trial, turn, self.timer)
        while max(len(self.sample), self.seeds * self.count) < MOST_BEAMS * self.count and self.wants_more():
            new = np.zeros(0, int) if self.has_all_echoes() else self.grow(2 * len(self.sample))
            if len(new):
                self.refer(new)
            else:
                self.seeds *= 2
            for trial in self.trials:
                if trial.verdict != NOT_MET:
                    self.measure(trial)

    def eligible(self) -> list[Trial]:
        """Trials without second reflections, if the scene has no second reflections; else all trials."""
        return [trial for trial in self.trials if self.reflects_twice or trial.setting.reflections == 1]

    def fastest(self, verdict: int = MET) -> float:
        return min((trial.seconds for trial in self.eligible() if trial.verdict == verdict), default=np.inf)

    def has_all_echoes(self) -> bool:
        """Whether the sample has all beams of the scan with an echo."""
        return len(self.candidates) == self.beams.GetNumberOfPoints() and bool(
            np.isin(np.concatenate((self.orders[0], self.orders[3])), self.sample).all())

    def wants_more(self) -> bool:
        """Whether a much faster setting may keep all limits: only its share of wrong echoes is undecided, or no setting
        is known to keep them."""
        own, none = self.own(), self.fastest() == np.inf
        return any(FASTER * trial.seconds < self.fastest() and (none or tuple(trial.verdicts[:2]) == (MET, MET)) and
                   trial.verdict == UNDECIDED and (trial.errors[:, 0] + own < self.asked).all()
                   for trial in self.eligible())

    def advise(self) -> Trial | None:
        """The trial that is advised."""
        default = next(trial for trial in self.trials if trial.setting == DEFAULT)
        trials = self.eligible()
        while True:
            advised = choose(trials, self.asked)
            if advised is None or advised.setting == DEFAULT:
                return advised
            both = [default, advised]
            for trial in both:
                trial.times = []
            for turn in range(2):
                for trial in both:
                    self.time(trial, turn, self.timer, self.beams)
            if default in trials and default.verdict == MET:
                return choose(both, self.asked)
            if default.is_as_fast_as(advised) or default.seconds > advised.seconds or \
                    (default.errors[:, 0] > advised.errors[:, 0]).any():
                return advised
            self.beaten = True
            trials = [trial for trial in trials if trial is not advised]
