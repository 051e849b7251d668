# SPDX-License-Identifier: BSD-3-Clause
"""Comparison of predictions for labelled sequences with the labels: the command `avianlidar bench`."""
from __future__ import annotations

import itertools
import math
import pathlib
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..._disk import only_run, write_whole
from ..._files import read_regular
from ..._pipeline import Error
from ..._version import __version__
from ..._weather import in_words
from ..._writers import as_csv
from ..inputs._json import naming
from ..inputs._read import read_manifest
from ..inputs._tables import read_table, texts
from ..pages import _drawing as drawing
from ..pages._html import First, render, short_enough
from ._card import cell, number as with_error
from ._labels import BIRD, MOVING
from ._scores import Value, mean
from ._sequence import DONE, content_of
from ._simulation import SUBSETS

RANGES = (200.0, 400.0, 600.0, 1000.0)  # limits of the groups by range, m
GROUPS = (*(f"{low:g} to {high:g} m" for low, high in zip((0.0, *RANGES), RANGES)), f"beyond {RANGES[-1]:g} m")
LOST = 3  # number of consecutive scans with points of a bird, none of which is predicted as bird, that lose its track
FALSE = (1, 10)  # allowed false points a scan
RECALLS = np.linspace(0.0, 1.0, 101)  # recalls of the curve
NO_SUBSET = 255  # of points of recorded scans
SHOWN = 5  # greatest number of sets on paper; files have all
SURE = 2.0  # a difference is sure if it is larger than this number of standard errors
# Scores with the words and the unit of the page.
SCORES = {"recall_at_1": ("recall at 1 false point a scan", "%"),
          "recall_at_10": ("recall at 10 false points a scan", "%"),
          "average_precision": ("average precision", ""), "iou": ("IoU", ""), "recall": ("recall", "%"),
          "precision": ("precision", "%"), "false": ("false points a scan", ""), "lost": ("tracks lost", "%"),
          "others": ("others under way called birds", "%")}
ALL = ("all", "")  # the group of all points
Group = Tuple[str, str]  # kind of a group, and its name


class Points(NamedTuple):
    """The scored points of a sequence or of one scan, in arrays with one value for each point."""
    scan: np.ndarray
    bird: np.ndarray                # whether the point belongs to a bird
    other: np.ndarray               # whether the point belongs to another mover, and is neither right nor wrong
    instance: np.ndarray
    subset: np.ndarray
    range: np.ndarray               # m
    called: np.ndarray              # whether the point is predicted to be a bird
    score: Optional[np.ndarray]     # score of a bird; greater means surer


class Set:
    """A folder that `avianlidar sequence` has made, or recorded scans with labels in the same folders."""

    def __init__(self, folder, numbers: Sequence[str] = (), first: int = 0):
        """@param numbers the scored sequences, default all @param first first scored scan of each sequence"""
        self.folder, self.first = pathlib.Path(folder), first
        recorded: Dict[str, Any] = {home.parent.name: {} for home in sorted(self.folder.glob("sequences/*/labels"))}
        self.is_recorded = bool(recorded) and not (self.folder / "manifest.json").exists()
        manifest = {"sequences": recorded, "scenario": {"scene": "recorded", "sensor": {"preset": "a lidar"}}} \
            if self.is_recorded else read_manifest(folder, ", or recorded scans in sequences/NN/velodyne and labels")
        parts, scenario = sorted(manifest["sequences"]), manifest["scenario"]
        self.numbers = [number for number in parts if not numbers or number in numbers]
        if {*numbers} - {*parts}:
            raise Error(f"{self.folder / 'manifest.json'}: has no sequence {min({*numbers} - {*parts})}, "
                        f"expected some of {', '.join(parts)}")
        for number in self.numbers:
            home = self.folder / "sequences" / number
            if (home / DONE).exists() or "sha256" in manifest["sequences"][number]:  # not in sets of other programs
                content_of(home)
        self.name = self.folder.resolve().name
        with naming(f"{self.folder / 'manifest.json'}: scenario"):
            self.bird_class = int(scenario.get("bird_class", BIRD))
            self.weather = "recorded" if self.is_recorded else in_words(scenario.get("weather", ())) or "clear"
            files = scenario["scene"], scenario["sensor"]["preset"]
            self.scene, self.sensor = (pathlib.Path(name).name.split(".")[0] for name in files)

    def species(self, number: str) -> Dict[int, str]:
        """The species of the birds of a sequence by instance; none for recorded scans."""
        if self.is_recorded:
            return {}
        file = self.folder / "sequences" / number / "truth.csv"
        rows = read_table(file, ("bird", "species"), "the truth of a sequence")
        return {int(row["bird"]) + 1: row["species"] for row in rows}

    def points(self, number: str, predictions: pathlib.Path) -> Tuple[Points, int]:
        """The points of a sequence with their predictions, and the number of scans."""
        home, theirs = self.folder / "sequences" / number, predictions / "sequences" / number / "predictions"
        names = [file.stem for file in sorted((home / "velodyne").glob("*.bin"))][self.first:]
        if not names:
            raise Error(f"{home}: has no scan from number {self.first} on, "
                        "expected longer sequences or a smaller --first")
        kinds = [(home / "labels", ".label", "<u4"), (home / "subsets", ".subset", "u1"), (theirs, ".label", "<u4")]
        if self.is_recorded:
            del kinds[1]
        if any((theirs / f"{name}.score").exists() for name in names):  # then all scans need scores
            kinds.append((theirs, ".score", "<f4"))
        scans = []
        for name in names:
            points = _content(home / "velodyne" / f"{name}.bin", "4<f4")
            scans.append([points, *(_content(folder / f"{name}{suffix}", kind, len(points))
                                    for folder, suffix, kind in kinds)])
        parts: List[Any] = [*map(np.concatenate, zip(*scans))]
        if self.is_recorded:
            parts.insert(2, np.full(len(parts[0]), NO_SUBSET, np.uint8))
        places, labels, subset, predicted, *score = parts
        kind = labels & 0xffff
        bird = kind == self.bird_class
        return Points(np.repeat(np.arange(len(names)), [len(scan[0]) for scan in scans]), bird,
                      np.isin(kind, [*MOVING.values()]) & ~bird, labels >> 16, subset,
                      np.linalg.norm(places[:, :3].astype(float), axis=1), (predicted & 0xffff) == self.bird_class,
                      score[0] if score else None), len(names)


def _content(file: pathlib.Path, kind: str, points: Optional[int] = None) -> np.ndarray:
    """The values of a file. @param kind their type @param points number of points of the scan"""
    if not file.exists():
        expected = "scores of all scans or of none" if file.suffix == ".score" else \
            "a file for each scan, of the same number"
        raise Error(f"{file}: is missing, expected {expected}")
    content, unit = read_regular(file), np.dtype(kind).itemsize
    if len(content) % unit:
        raise Error(f"{file}: has {len(content)} bytes, expected {unit} for each point")
    values = np.frombuffer(content, kind)
    if points is not None and len(values) != points:
        raise Error(f"{file}: has {len(values)} values, expected one for each of the {points} points of the scan")
    if file.suffix == ".score" and np.isnan(values).any():
        raise Error(f"{file}: has a score that is not a number")
    return values


class Threshold(NamedTuple):
    """Scores in descending order, with the numbers of birds and of false points at or above each score."""
    values: np.ndarray
    birds: np.ndarray
    false: np.ndarray


def ranked(score, bird, other) -> Threshold:
    """Points by descending score. Points of the same score form one step."""
    values, count = np.unique(-score[~other], return_counts=True)
    birds = np.cumsum(np.bincount(np.searchsorted(values, -score[bird & ~other]), minlength=len(values)))
    return Threshold(-values, birds, np.cumsum(count) - birds)


def threshold(rank: Threshold, most: float) -> float:
    """The least score with at most that many false points; nan, which no score reaches, if the first step has more."""
    count = np.searchsorted(rank.false, most, "right")
    return float(rank.values[count - 1]) if count else math.nan


def average_precision(rank: Threshold) -> float:
    """The mean of the precision, weighted with the gain of recall at each step; nan without a bird."""
    if not rank.birds.any():
        return math.nan
    return float(np.average(rank.birds / (rank.birds + rank.false), weights=np.diff(rank.birds, prepend=0)))


def curve(rank: Threshold) -> np.ndarray:
    """The greatest precision at or above each of `RECALLS`."""
    if not rank.birds.any():
        return np.full(len(RECALLS), math.nan)
    best = np.maximum.accumulate((rank.birds / (rank.birds + rank.false))[::-1])[::-1]
    return best[np.searchsorted(rank.birds / rank.birds[-1], RECALLS - 1e-9)]


def lost(points: Points) -> Tuple[int, int]:
    """(birds that have points in `LOST` consecutive scans; those with such scans without a point predicted as bird)."""
    windows = np.lib.stride_tricks.sliding_window_view
    instances, bird = np.unique(points.instance[points.bird], return_inverse=True)
    scan, called = points.scan[points.bird], points.called[points.bird]
    seen, found = np.zeros((2, len(instances), max(scan.max(initial=0) + 1, LOST)), bool)
    seen[bird, scan] = True
    found[bird[called], scan[called]] = True
    tracks = windows(seen, LOST, axis=1).all(axis=2)
    missed = tracks & ~windows(found, LOST, axis=1).any(axis=2)
    return int(tracks.any(axis=1).sum()), int(missed.any(axis=1).sum())


def scores(points: Points, among: np.ndarray, scans: int, least: Sequence[float]) -> Dict[str, float]:
    """Scores of a group of points of a sequence. @param among which points @param scans number of scans of the sequence
    @param least least score of a bird, for each of `FALSE`"""
    bird, called, other = points.bird & among, points.called & among, points.other & among
    birds, hit, false = bird.sum(), (bird & called).sum(), (called & ~points.bird & ~other).sum()
    with np.errstate(invalid="ignore"):  # nothing of nothing is nan
        found = {"birds": birds, "recall": hit / birds, "precision": hit / (hit + false),
                 "iou": hit / (birds + false) if birds else math.nan, "false": false / scans,
                 "others": (other & called).sum() / other.sum()}
        if points.score is not None:
            for most, score in zip(FALSE, least):
                found[f"recall_at_{most}"] = (points.score[bird] >= score).sum() / birds
            rank = ranked(points.score[among], points.bird[among], points.other[among])
            found["average_precision"] = average_precision(rank)
    return {name: float(value) for name, value in found.items()}


def groups(points: Points, species: Dict[int, str]) -> Dict[Group, np.ndarray]:
    """For each group, which points belong to the group. @param species species of birds by instance"""
    found: Dict[Group, np.ndarray] = {ALL: np.ones(len(points.bird), bool)}
    found.update({("subset", name.replace("_", " ")): points.subset == number for number, name in enumerate(SUBSETS)})
    place = np.digitize(points.range, RANGES)
    found.update({("range", name): place == number for number, name in enumerate(GROUPS)})
    for name in sorted({*species.values()}):
        instances = [instance for instance, of in species.items() if of == name]
        found["species", name] = points.bird & np.isin(points.instance, instances)
    return found


class Scored:
    """Scores of predictions for a set: for each group the scores of each sequence, and the curves."""

    def __init__(self, of: Set, name: str):
        self.set, self.name, self.scans = of, name, 0
        self.values: Dict[Group, List[Dict[str, float]]] = {}
        self.curves: List[np.ndarray] = []

    def add(self, points: Points, scans: int, species: Dict[int, str]) -> None:
        """Scores a sequence. @param scans number of scans @param species species of birds by instance"""
        self.scans += scans
        least: List[float] = []
        if points.score is not None:
            rank = ranked(points.score, points.bird, points.other)
            least = [threshold(rank, most * scans) for most in FALSE]
            self.curves.append(curve(rank))
        for group, among in groups(points, species).items():
            found = scores(points, among, scans, least)
            if group[0] == "species":  # false points have no species
                found = {key: found[key] for key in found if key == "birds" or key.startswith("recall")}
            self.values.setdefault(group, []).append(found)
        many, gone = lost(points)
        self.values[ALL][-1]["lost"] = gone / many if many else math.nan

    def of_sequences(self, group: Group, score: str) -> np.ndarray:
        """A value for each sequence, nan if the sequence has no score."""
        return np.array([values.get(score, math.nan) for values in self.values.get(group, ())])

    def value(self, group: Group, score: str) -> Value:
        """The mean over the sequences and the standard error."""
        found = self.of_sequences(group, score)
        return mean(found[~np.isnan(found)])

    def cells(self, group: Group, keys: Sequence[str]) -> List[str]:
        """Scores of a group, for the page."""
        return [cell(self.value(group, key), SCORES[key][1]) for key in keys]

    def points(self, group: Group) -> int:
        """Number of points of birds in all sequences."""
        return int(sum(values["birds"] for values in self.values.get(group, ())))


def verdict(scored: Sequence[Scored]) -> str:
    """Sentence on the best predictions for a set and their lead: by recall if all have scores, and by IoU."""
    names = ["recall_at_1", "iou"] if all(one.curves for one in scored) else ["iou"]
    return " ".join(_best(scored, name) for name in names)


def _best(scored: Sequence[Scored], score: str) -> str:
    words, unit = SCORES[score]
    best, *others = sorted(scored, key=lambda one: -one.value(ALL, score).value)
    if not best.value(ALL, score).number:  # all predictions have the same birds
        return "No bird has a point."
    parts = []
    for other in others:
        differences = best.of_sequences(ALL, score) - other.of_sequences(ALL, score)
        by = mean(differences[~np.isnan(differences)])  # from sequences that both have
        sure = by.value > SURE * by.error  # never true with one sequence
        parts.append(f"{cell(by, unit, ' percentage points' if unit else '')} more than {other.name}"
                     f"{'' if sure else ' (no sure difference)'}")
    lead = f": {'; '.join(parts)}" if parts else ""
    return f"{best.name} has the best {words}, {cell(best.value(ALL, score), unit)}{lead}."


def write_bench(folders: Sequence[Any], predictions: Sequence[Any], out, numbers: Sequence[str] = (), first: int = 0,
                progress: Callable[[str, int, int], Any] = lambda *_: None) -> List[List[Scored]]:
    """Writes bench.csv, curves.csv, pictures and bench.html to a folder. @param folders sets @param predictions folders
    that hold sequences/NN/predictions/NNNNNN.label, for several sets in a subfolder with the name of each set
    @param numbers, first as in `Set` @return the scores of each set's predictions"""
    if first < 0:
        raise Error(f"first is {first}, expected 0 or more")
    sets, given = [Set(folder, numbers, first) for folder in folders], [pathlib.Path(folder) for folder in predictions]
    names = [folder.resolve().name for folder in given]
    for what, known in (("sets", [of.name for of in sets]), ("predictions", names)):
        if len({*known}) < len(known):
            twice = max(known, key=known.count)
            raise Error(f"{what}: two are called {twice}, expected folders of different names")
    by_set = [[Scored(of, name) for name in names] for of in sets]
    jobs = [(scored, _folder_of(scored.set, folder, len(sets) > 1))
            for of in by_set for scored, folder in zip(of, given)]
    out, done, total = pathlib.Path(out), itertools.count(1), sum(len(scored.set.numbers) for scored, _ in jobs)
    with only_run(out, goes_on=False):
        for scored, place in jobs:
            for number in scored.set.numbers:
                scored.add(*scored.set.points(number, place), scored.set.species(number))
                progress("sequences", next(done), total)
        for name, rows in tables([scored for scored, _ in jobs]).items():
            write_whole(out / name, as_csv(map(texts, rows)))
        shown = [{**page(scored), "picture": _picture(out, scored)} for scored in by_set]
        write_whole(out / "bench.html", render(
            "sequences/bench.html.jinja", sets=shown[:SHOWN], version=__version__, all=ALL, scores=SCORES, lost=LOST,
            sure=SURE, rates=FALSE, first=_first(by_set[0], shown[0], len(by_set)), history=first))
    return by_set


def _folder_of(of: Set, folder: pathlib.Path, several: bool) -> pathlib.Path:
    """The folder with the predictions for a set. @param several whether there are several sets"""
    places = [folder / of.name] if several else [folder / of.name, folder]
    for place in places:
        if (place / "sequences").is_dir():
            return place
    expected = " or ".join(str((place / "sequences/NN/predictions").relative_to(folder)) for place in places)
    raise Error(f"{folder}: holds no predictions for {of.name}, expected {expected}")


def _mean_curve(values) -> Tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of each column; nan where fewer than one or two values are finite."""
    known = np.ma.masked_invalid(values)
    return known.mean(axis=0).filled(math.nan), known.std(axis=0, ddof=1).filled(math.nan)


def tables(scored: Sequence[Scored]) -> Dict[str, List[Any]]:
    """Rows of the tables, by the name of the file."""
    rows = []
    for one in scored:
        for group in one.values:
            for key, (words, _) in SCORES.items():
                value = one.value(group, key)
                if value.number:
                    rows.append((one.set.name, one.set.weather, one.name, *group, words, "1", *value,
                                 one.points(group)))
    curves = [(one.set.name, one.name, *place) for one in scored if one.curves
              for place in zip(RECALLS, _mean_curve(one.curves)[0])]
    return {"bench.csv": [("set", "weather", "predictions", "by", "group", "score", "unit", "value", "std_error",
                           "sequences", "points"), *rows],
            "curves.csv": [("set", "predictions", "recall", "precision"), *curves]}


def page(scored: Sequence[Scored]) -> Dict[str, Any]:
    """What the page shows of a set: its scores, and for each kind of groups the scores and the names of the groups."""
    first = scored[0]
    keys = [key for key in SCORES if any(one.value(ALL, key).number for one in scored)]
    parts = {by: ([key for key in ("recall_at_1", "recall" if by == "species" else "iou") if key in keys],
                  [group for group in first.values if group[0] == by and first.points(group)])
             for by in ("subset", "range", "species")}
    return {"of": first.set, "first": first, "scored": scored, "keys": keys, "head": [SCORES[key][0] for key in keys],
            "parts": parts, "verdict": verdict(scored)}


def _first(scored: Sequence[Scored], shown: Dict[str, Any], sets: int) -> First:
    """The first page, on the first set."""
    of = scored[0].set
    score = "recall_at_1" if all(one.curves for one in scored) else "iou"
    best = max(scored, key=lambda one: one.value(ALL, score).value if one.value(ALL, score).number else -1.0)

    others, where = ("recall" if score == "iou" else "iou", "lost"), f"{best.name} at {of.name}, mean of the sequences"
    numbers = [with_error((SCORES[key][1], best.value(ALL, key)), SCORES[key][0], where) for key in (score, *others)]
    value, what = numbers[0].value, SCORES[score][0]
    return First(
        f"Which filter separates birds from clutter? {of.name}", short_enough(
            f"At {of.name}, {best.name} has the best {what}, {value}." if best.value(ALL, score).number else
            f"At {of.name}, no bird has a point.", f"The best {what} is {value}."), shown["picture"],
        numbers,
        [{"head": "See whether the lead is sure.", "words": shown["verdict"], "command": ""},
         {"head": "Look at subsets, ranges and species.", "command": "",
          "words": f"The next page{'s' if sets > 1 else ''} and bench.csv have the scores of each."}],
        ["The scans are recorded, and the labels are those in the folder." if scored[0].set.is_recorded else
         "The scans and labels are simulated. Nothing was measured, and the scores are not a claim about real birds. "
         "Kinds and flights of birds and the sensor's numbers are assumed, as in the scenario.",
         "Points of other moving objects count as neither right nor wrong."])


def _picture(out: pathlib.Path, scored: Sequence[Scored]) -> Dict[str, Any]:
    """The curves of a set's predictions with scores, or bars of IoU, as a picture of the page."""
    of, curves = scored[0].set, {one.name: np.array(one.curves) for one in scored if one.curves}
    areas = ", ".join(f"{one.name} {one.value(ALL, 'average_precision').value:.3f}" for one in scored if one.curves)
    return drawing.picture(
        out / f"{'curves' if curves else 'iou'}-{of.name}.png", (drawing.WIDTH, 4.0),
        f"Scores of {len(scored)} predictions; average precision: {areas or 'none'}",
        f"{of.name}, {of.weather}: {'precision over recall' if curves else 'IoU'}, as the mean of the sequences with "
        "one standard error.", lambda axes: _draw_curves(axes, curves) if curves else _draw_iou(axes, scored))


def _draw_iou(axes, scored: Sequence[Scored]) -> None:
    values, errors = np.nan_to_num([one.value(ALL, "iou")[:2] for one in scored]).T
    axes.barh([one.name for one in scored], values, xerr=errors)
    drawing.finish(axes, xlabel="IoU", xlim=(0.0, 1.0))


def _draw_curves(axes, curves: Dict[str, np.ndarray]) -> None:
    drawing.series(axes)
    for name, values in curves.items():
        middle, deviation = _mean_curve(values)
        line, = axes.plot(RECALLS, middle, markevery=10, label=name)
        if len(values) > 1:
            error = deviation / math.sqrt(len(values))
            axes.fill_between(RECALLS, middle - error, middle + error, color=line.get_color(), alpha=0.2, linewidth=0)
    drawing.finish(axes, xlabel="recall", ylabel="precision", xlim=(0.0, 1.0), ylim=(0.0, 1.02))
