# SPDX-License-Identifier: BSD-3-Clause
"""Comparison of predictions for labelled sequences with the labels: the command `avianlidar bench`."""
from __future__ import annotations

import itertools
import math
import pathlib
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .._disk import only_run, write_whole
from .._files import read_regular
from .._pipeline import Error
from .._version import __version__
from .._weather import in_words
from .._writers import as_csv
from . import _pictures as pictures
from ._card import cell
from ._labels import BIRD, MOVING
from ._scores import Value, mean
from ._inputs import read_manifest
from ._sequence import FOLDERS
from ._simulation import SUBSETS
from ._tables import embedded, read_table, render

RANGES = (0.0, 200.0, 400.0, 600.0, 1000.0, math.inf)  # limits of the groups by range, m
LOST = 3  # number of consecutive scans with points of a bird, none predicted as bird, after which the bird's track is lost
FALSE = (1, 10)  # allowed false points a scan
RECALLS = np.linspace(0.0, 1.0, 101)  # recalls of the curve
SURE = 2.0  # a difference is sure if it is larger than this number of standard errors
# Scores with the words and the unit of the page.
SCORES = {**{f"recall_at_{most}": (f"recall at {most} false point{'s' if most > 1 else ''} a scan", "%") for most in FALSE},
          "average_precision": ("average precision", ""), "iou": ("IoU", ""), "recall": ("recall", "%"), "precision": ("precision", "%"),
          "false": ("false points a scan", ""), "lost": ("tracks lost", "%"), "others": ("others under way called birds", "%")}
ALL = ("all", "")  # the group of all points


class Points(NamedTuple):
    """The scored points of a sequence or of one scan, in arrays with one value for each point."""
    scan: np.ndarray
    bird: np.ndarray                # whether the point belongs to a bird
    other: np.ndarray               # whether the point belongs to another moving object, which counts as neither right nor wrong
    instance: np.ndarray
    subset: np.ndarray
    range: np.ndarray               # m
    called: np.ndarray              # whether the point is predicted to be a bird
    score: Optional[np.ndarray]     # score of a bird; greater means surer


class Threshold(NamedTuple):
    """Scores in descending order, with the numbers of birds and of false points at or above each score."""
    values: np.ndarray
    birds: np.ndarray
    false: np.ndarray


def ranked(score, bird, other) -> Threshold:
    """Points by descending score. Points of the same score form one step."""
    score, bird = score[~other], bird[~other]
    order = np.argsort(-score, kind="stable")
    score, birds = score[order], np.cumsum(bird[order])
    last = np.flatnonzero(np.append(score[1:] != score[:-1], True)) if len(score) else np.zeros(0, int)
    return Threshold(score[last], birds[last], last + 1 - birds[last])


def threshold(rank: Threshold, most: float) -> float:
    """The least score with at most that many false points; nan, which no score reaches, if the first step has more."""
    fit = np.flatnonzero(rank.false <= most)
    return float(rank.values[fit[-1]]) if len(fit) else math.nan


def average_precision(rank: Threshold) -> float:
    """The mean of the precision, weighted with the gain of recall at each step; nan without a bird."""
    won = np.diff(rank.birds, prepend=0)
    return float(np.sum(won * rank.birds / (rank.birds + rank.false)) / rank.birds[-1]) if rank.birds.any() else math.nan


def curve(rank: Threshold) -> np.ndarray:
    """The greatest precision at or above each of `RECALLS`."""
    if not rank.birds.any():
        return np.full(len(RECALLS), math.nan)
    best = np.maximum.accumulate((rank.birds / (rank.birds + rank.false))[::-1])[::-1]
    place = np.searchsorted(rank.birds / rank.birds[-1], RECALLS - 1e-9)
    return best[np.minimum(place, len(best) - 1)]


def lost(points: Points) -> Tuple[int, int]:
    """(birds that have points in `LOST` consecutive scans; those with such scans without a point predicted as bird)."""
    many = lost_ones = 0
    mine = np.flatnonzero(points.bird)
    mine = mine[np.argsort(points.instance[mine], kind="stable")]
    for one in np.split(mine, np.flatnonzero(np.diff(points.instance[mine])) + 1) if len(mine) else ():
        scans, place = np.unique(points.scan[one], return_inverse=True)
        found = np.bincount(place, points.called[one]) > 0
        runs = [(scans[k + LOST - 1] - scans[k] == LOST - 1, not found[k:k + LOST].any()) for k in range(len(scans) - LOST + 1)]
        many += any(whole for whole, _ in runs)
        lost_ones += any(whole and none for whole, none in runs)
    return many, lost_ones


def scores(points: Points, among: np.ndarray, scans: int, least: Sequence[float]) -> Dict[str, float]:
    """Scores of a group of points of a sequence. @param among which points @param scans number of scans of the sequence @param least least
    score of a bird, for each of `FALSE`"""
    bird, called, other = points.bird & among, points.called & among, points.other & among
    hit, false, missed = (int(np.count_nonzero(part)) for part in (bird & called, called & ~points.bird & ~other, bird & ~called))

    def ratio(part: float, whole: float) -> float:
        return part / whole if whole else math.nan
    found = {"birds": float(hit + missed), "recall": ratio(hit, hit + missed), "precision": ratio(hit, hit + false),
             "iou": ratio(hit, hit + false + missed) if hit + missed else math.nan, "false": false / scans,
             "others": ratio(int(np.count_nonzero(other & called)), int(np.count_nonzero(other)))}
    if points.score is not None:
        for most, score in zip(FALSE, least):
            found[f"recall_at_{most}"] = ratio(int(np.count_nonzero(points.score[bird] >= score)), hit + missed)
        found["average_precision"] = average_precision(ranked(points.score[among], points.bird[among], points.other[among]))
    return found


class Set:
    """A folder that `avianlidar sequence` has made."""

    def __init__(self, folder, numbers: Sequence[str] = (), first: int = 0):
        """@param numbers numbers of the scored sequences, default all @param first first scored scan of each sequence"""
        self.folder, self.first, manifest = pathlib.Path(folder), first, read_manifest(folder)
        parts, scenario = sorted(manifest["sequences"]), manifest["scenario"]
        self.numbers = [number for number in parts if not numbers or number in numbers]
        if {*numbers} - {*parts}:
            raise Error(f"{self.folder / 'manifest.json'}: has no sequence {min({*numbers} - {*parts})}, expected some of {', '.join(parts)}")
        self.name = self.folder.resolve().name
        self.bird_class = int(scenario.get("bird_class", BIRD))
        self.weather = in_words(scenario.get("weather", ())) or "clear"
        self.scene, self.sensor = pathlib.Path(scenario["scene"]).name.split(".")[0], pathlib.Path(str(scenario["sensor"]["preset"])).name.split(".")[0]

    def species(self, number: str) -> Dict[int, str]:
        """The species of the birds of a sequence by instance."""
        rows = read_table(self.folder / "sequences" / number / "truth.csv", ("bird", "species"), "the truth of a sequence")
        return {int(row["bird"]) + 1: row["species"] for row in rows}

    def points(self, number: str, predictions: pathlib.Path) -> Tuple[Points, int]:
        """The points of a sequence with their predictions, and the number of scans."""
        home, theirs = self.folder / "sequences" / number, predictions / "sequences" / number
        names = [file.stem for file in sorted((home / "velodyne").glob("*.bin"))][self.first:]
        if not names:
            raise Error(f"{home}: has no scan from number {self.first} on, expected longer sequences or a smaller --first")
        kinds = [(home / folder, suffix, kind) for (folder, suffix, _), kind in zip(FOLDERS, ("<f4", "<u4", "u1"))]
        kinds.append((theirs / "predictions", ".label", "<u4"))
        if any((theirs / "predictions" / f"{name}.score").exists() for name in names):  # then all scans need scores
            kinds.append((theirs / "predictions", ".score", "<f4"))
        columns = []
        for scan, name in enumerate(names):
            first, *found = (_content(folder / f"{name}{suffix}", kind) for folder, suffix, kind in kinds)
            places = first.reshape(-1, 4)[:, :3].astype(float)
            for (folder, suffix, _), values in zip(kinds[1:], found):
                if len(values) != len(places):
                    raise Error(f"{folder / name}{suffix}: has {len(values)} values, expected one for each of the {len(places)} points of the scan")
                if np.isnan(values).any():
                    raise Error(f"{folder / name}{suffix}: has a score that is not a number")
            labels, subset, predicted, *score = found
            kind, called = labels & 0xffff, (predicted & 0xffff) == self.bird_class
            columns.append((np.full(len(places), scan), kind == self.bird_class, np.isin(kind, [*MOVING.values()]) & (kind != self.bird_class),
                            labels >> 16, subset, np.linalg.norm(places, axis=1), called, *score))
        arrays: List[Any] = [np.concatenate(column) for column in zip(*columns)]
        return Points(*arrays[:7], *(arrays[7:] or [None])), len(names)

    def groups(self, number: str, points: Points) -> Dict[Tuple[str, str], np.ndarray]:
        """For each group (kind, name), which points belong to the group."""
        found: Dict[Tuple[str, str], np.ndarray] = {("all", ""): np.ones(len(points.bird), bool)}
        found.update({("subset", words.replace("_", " ")): points.subset == place for place, words in enumerate(SUBSETS)})
        for low, high in zip(RANGES, RANGES[1:]):
            words = f"{low:g} to {high:g} m" if math.isfinite(high) else f"beyond {low:g} m"
            found["range", words] = (points.range >= low) & (points.range < high)
        names = self.species(number)
        for name in sorted({*names.values()}):
            found["species", name] = points.bird & np.isin(points.instance, [one for one, species in names.items() if species == name])
        return found


def _content(file: pathlib.Path, kind: str) -> np.ndarray:
    if not file.exists():
        expected = "scores of all scans or of none" if file.suffix == ".score" else "a file for each scan, of the same number"
        raise Error(f"{file}: is missing, expected {expected}")
    content, unit = read_regular(file), 16 if file.suffix == ".bin" else np.dtype(kind).itemsize
    if len(content) % unit:
        raise Error(f"{file}: has {len(content)} bytes, expected {unit} for each point")
    return np.frombuffer(content, kind)


class Scored:
    """Scores of predictions for a set: for each group the values of the sequences, and the curves."""

    def __init__(self, of: Set, predictions: pathlib.Path, name: str, step: Callable[[], Any] = lambda: None):
        self.set, self.name = of, name
        self.values: Dict[Tuple[str, str], List[Dict[str, float]]] = {}
        self.curves: List[np.ndarray] = []
        self.scans = 0
        for number in of.numbers:
            points, scans = of.points(number, predictions)
            self.scans += scans
            least: List[float] = []
            if points.score is not None:
                rank = ranked(points.score, points.bird, points.other)
                least = [threshold(rank, most * scans) for most in FALSE]
                self.curves.append(curve(rank))
            for group, among in of.groups(number, points).items():
                found = scores(points, among, scans, least)
                if group[0] == "all":
                    many, gone = lost(points)
                    found["lost"] = gone / many if many else math.nan
                if group[0] == "species":  # false points have no species
                    found = {key: found[key] for key in found if key == "birds" or key.startswith("recall")}
                self.values.setdefault(group, []).append(found)
            step()

    def of_sequences(self, group: Tuple[str, str], score: str) -> np.ndarray:
        """A value for each sequence, nan if the sequence has no score."""
        return np.array([values.get(score, math.nan) for values in self.values.get(group, ())])

    def value(self, group: Tuple[str, str], score: str) -> Value:
        """The mean over the sequences and the standard error."""
        found = self.of_sequences(group, score)
        return mean(found[~np.isnan(found)])

    def points(self, group: Tuple[str, str]) -> int:
        """Number of points of birds in all sequences."""
        return int(sum(values["birds"] for values in self.values.get(group, ())))


def verdict(scored: Sequence[Scored]) -> str:
    """Sentence on the best predictions for a set and their lead: by recall if all have scores, and by intersection over union."""
    return " ".join(_best(scored, score) for score in (f"recall_at_{FALSE[0]}", "iou") if score == "iou" or all(one.curves for one in scored))


def _best(scored: Sequence[Scored], score: str) -> str:
    words, unit = SCORES[score]
    values = {one.name: one.value(ALL, score) for one in scored}
    ordered = sorted((one for one in scored if values[one.name].number), key=lambda one: -values[one.name].value)
    if not ordered:
        return "No bird has a point."
    best = ordered[0]
    parts = []
    for other in ordered[1:]:
        differences = best.of_sequences(ALL, score) - other.of_sequences(ALL, score)
        by = mean(differences[~np.isnan(differences)])  # from sequences that both have
        sure = by.value > SURE * by.error  # never true with one sequence
        parts.append(f"{cell(by, unit, ' percentage points' if unit else '')} more than {other.name}{'' if sure else ' (no sure difference)'}")
    end = f": {'; '.join(parts)}." if parts else "."
    return f"{best.name} has the best {words}, {cell(values[best.name], unit)}{end}"


class Bench:
    """Sets with predictions for each: tables, curves, and a page."""

    def __init__(self, folders: Sequence[Any], predictions: Sequence[Any], numbers: Sequence[str] = (), first: int = 0):
        """@param folders sets @param predictions folders that hold sequences/NN/predictions/NNNNNN.label, for several sets in a subfolder
        with the name of each set @param numbers, first as in `Set`"""
        if first < 0:
            raise Error(f"first is {first}, expected 0 or more")
        self.sets = [Set(folder, numbers, first) for folder in folders]
        self.predictions = [pathlib.Path(folder) for folder in predictions]
        for what, names in (("sets", [one.name for one in self.sets]), ("predictions", [folder.resolve().name for folder in self.predictions])):
            if len({*names}) < len(names):
                raise Error(f"{what}: two are called {max(names, key=names.count)}, expected folders of different names")
        self.jobs = [(one, folder, self._folder_of(one, folder)) for one in self.sets for folder in self.predictions]

    def _folder_of(self, one: Set, folder: pathlib.Path) -> pathlib.Path:
        places = [folder / one.name] + [folder] * (len(self.sets) == 1)
        for place in places:
            if (place / "sequences").is_dir():
                return place
        expected = " or ".join(str((place / "sequences/NN/predictions").relative_to(folder)) for place in places)
        raise Error(f"{folder}: holds no predictions for {one.name}, expected {expected}")

    def write(self, out, progress: Callable[[str, int, int], Any] = lambda *_: None) -> List[List[Scored]]:
        """Writes bench.csv, curves.csv, pictures and bench.html to a folder. @return the scores of each set's predictions"""
        out = pathlib.Path(out)
        total, done = sum(len(one.numbers) for one, _, _ in self.jobs), itertools.count(1)
        with only_run(out):
            scored = [Scored(one, place, folder.resolve().name, lambda: progress("sequences", next(done), total))
                      for one, folder, place in self.jobs]
            by_set = [scored[k * len(self.predictions):(k + 1) * len(self.predictions)] for k in range(len(self.sets))]
            self._write_tables(out, scored)
            shown = [self._shown(out, of) for of in by_set]
            write_whole(out / "bench.html", render("bench.html.jinja", sets=shown, version=__version__, lost=LOST, sure=SURE, rates=FALSE,
                                                   first=self.sets[0].first))
        return by_set

    @staticmethod
    def _write_tables(out: pathlib.Path, scored: Sequence[Scored]) -> None:
        rows: List[List[Any]] = [["set", "weather", "predictions", "by", "group", "score", "unit", "value", "std_error", "sequences", "points"]]
        lines: List[List[Any]] = [["set", "predictions", "recall", "precision"]]
        for one in scored:
            for group in one.values:
                for score, (words, _) in SCORES.items():
                    value = one.value(group, score)
                    if value.number:
                        rows.append([one.set.name, one.set.weather, one.name, *group, words, "1", *("" if math.isnan(x) else f"{x:.6g}" for x in value[:2]),
                                     value.number, one.points(group)])
            if one.curves:
                lines += [[one.set.name, one.name, f"{recall:g}", f"{precision:.6g}"] for recall, precision in zip(RECALLS, np.nanmean(one.curves, axis=0))]
        write_whole(out / "bench.csv", as_csv(rows))
        write_whole(out / "curves.csv", as_csv(lines))

    @staticmethod
    def _shown(out: pathlib.Path, scored: Sequence[Scored]) -> Dict[str, Any]:
        """The values that the page shows for a set."""
        first = scored[0]

        def row(name: str, group: Tuple[str, str], keys: Sequence[str]) -> Dict[str, Any]:
            return {"name": name, "points": first.points(group), "cells": [[cell(one.value(group, key), SCORES[key][1]) for key in keys] for one in scored]}
        keys = [key for key in SCORES if any(one.value(ALL, key).number for one in scored)]
        best = [key for key in (f"recall_at_{FALSE[0]}", "iou") if key in keys]
        parts = []
        for by in ("subset", "range", "species"):
            names = list(dict.fromkeys(name for one in scored for kind, name in one.values if kind == by and one.points((by, name))))
            chosen = [key for key in ((f"recall_at_{FALSE[0]}", "recall") if by == "species" else best) if key in keys]
            parts.append({"by": by, "head": [SCORES[key][0] for key in chosen], "rows": [row(name, (by, name), chosen) for name in names]})
        found = {"name": first.set.name, "weather": first.set.weather, "scene": first.set.scene, "sensor": first.set.sensor, "scans": first.scans,
                 "sequences": len(first.set.numbers), "points": first.points(ALL), "verdict": verdict(scored), "names": [one.name for one in scored],
                 "head": [SCORES[key][0] for key in keys], "groups": parts,
                 "all": [{"name": one.name, "cells": [cell(one.value(ALL, key), SCORES[key][1]) for key in keys]} for one in scored], "picture": None}
        curves = [(one.name, np.array(one.curves)) for one in scored if one.curves]
        if curves:
            file = out / f"curves-{first.set.name}.png"
            pictures.draw(file, (5.6, 3.6), lambda axes: _draw_curves(axes, curves))
            areas = ", ".join(f"{one.name} {one.value(ALL, 'average_precision').value:.3f}" for one in scored if one.curves)
            found["picture"] = {"source": embedded(file), "alt": f"Precision over recall at {first.set.name}; average precision: {areas}.",
                                "caption": f"{first.set.name}, {first.set.weather}: the mean of the sequences, and one standard error to either side"}
        return found


def _draw_curves(axes, curves: Sequence[Tuple[str, np.ndarray]]) -> None:
    for name, values in curves:
        middle = np.nanmean(values, axis=0)
        line, = axes.plot(RECALLS, middle, label=name)
        if len(values) > 1:
            error = np.nanstd(values, axis=0, ddof=1) / math.sqrt(len(values))
            axes.fill_between(RECALLS, middle - error, middle + error, color=line.get_color(), alpha=0.2, linewidth=0)
    pictures.finish(axes, xlabel="recall", ylabel="precision", xlim=(0.0, 1.0), ylim=(0.0, 1.02))
