# SPDX-License-Identifier: BSD-3-Clause
"""The report card of tracks: scores by species, height and weather, pictures, and a page of HTML."""
from __future__ import annotations

import bisect
import itertools
import json
import math
import pathlib
from types import SimpleNamespace
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from ..._disk import write_whole
from ..._look import class_colour
from ..._pipeline import Error
from ..._ranks import as_json
from ..._version import __version__
from ..._writers import as_csv
from ..inputs._json import load_json
from ..inputs._tables import texts
from ..pages import _drawing as drawing
from ..pages._html import First, Number, render, short_enough
from ..pages._words import counted
from ..places._from_above import draw_airport
from . import _scores as scores
from ._following import FALSE, ORIGINS, STATES, VOLUMES, Input
from ._scores import Value

HEIGHTS = (10.0, 30.0, 60.0)  # limits of the bands of a bird's mean height, m
BANDS = [f"below {HEIGHTS[0]:g} m", *(f"{low:g} to {high:g} m" for low, high in zip(HEIGHTS, HEIGHTS[1:])),
         f"above {HEIGHTS[-1]:g} m"]
WARNED = (10.0, 30.0, 60.0)  # warning times that are counted, s
Scores = Dict[str, Tuple[str, Value]]  # unit and value of scores, by the words on the page
Part = Tuple[str, str, List[Scores]]  # kind and name of a group, and its scores for each input
NEAREST = 300.0  # least extent of maps around the sensor, m
FEWEST = 5  # least number of birds for a curve of warnings
COLOURS = [class_colour(word) for word in ("bird", "bird", "car", "structure", "noise", "air")]  # of ORIGINS
MARKS = "oPsv^x"  # of ORIGINS
LINES = ("-", "-", "--", ":", "-.", (0, (1, 3)))  # of ORIGINS
SHOWN = 3  # greatest number of inputs on paper; files have all
ROWS = 10  # greatest number of rows of a table on paper
Results = List[Dict[str, Any]]
Warned = Sequence[Tuple[str, List[np.ndarray]]]  # volumes with the warning times of each input, s


def of_birds(birds: Results) -> Scores:
    """Scores of a group of birds that were in the volume of the sensor."""
    found, count = [bird for bird in birds if bird["found_s"] is not None], len(birds)
    return {"birds tracked": ("%", scores.share(len(found), count)),
            "tracked or beside a track": ("%", scores.share(sum(bird["near"] > 0 for bird in birds), count)),
            "share of time": ("%", scores.ratio(*([bird[name] for bird in birds] for name in ("tracked", "scans")))),
            "delay": ("s", scores.mean([bird["found_s"] - bird["came_s"] for bird in found])),
            "identity switches": ("", scores.mean([bird["switches"] for bird in found]))}


def of_tracks(sequences: Results) -> Scores:
    """Scores of the tracks of several sequences."""
    hours = sum(one["seconds"] for one in sequences) / 3600.0
    origins = [track["origin"] for one in sequences for track in one["tracks"]]
    distance, localisation, cardinality = np.array([np.mean(one["ospa"], axis=0) for one in sequences]).T
    return {"false tracks an hour": ("", scores.rate(sum(map(origins.count, FALSE)), hours)),
            "tracks of vehicles an hour": ("", scores.rate(origins.count("vehicle"), hours)),
            "second tracks of a bird an hour": ("", scores.rate(origins.count(ORIGINS[1]), hours)),
            "OSPA distance": ("m", scores.mean(distance)), "OSPA: localisation": ("m", scores.mean(localisation)),
            "OSPA: without partner": ("m", scores.mean(cardinality))}


def warnings_of(birds: Results, volume: str) -> np.ndarray:
    """Warning times, s: how long each bird that flies into a volume was on or beside a confirmed track before; 0
    without a track. A bird that begins in such a volume counts if it flies into a different volume."""
    return np.array([0.0 if bird["near_s"] is None else max(bird[volume] - bird["near_s"], 0.0)
                     for bird in birds if bird[volume] is not None])


def of_warnings(seconds: np.ndarray) -> Scores:
    """Scores of the warnings of a volume."""
    def warned(which: np.ndarray) -> Tuple[str, Value]:
        return "%", scores.share(int(which.sum()), len(seconds))
    return {"mean warning": ("s", scores.mean(seconds)), "warned at all": warned(seconds > 0.0),
            **{f"warned {least:g} s before or more": warned(seconds >= least) for least in WARNED}}


def band_of(height: float) -> str:
    """The band of a height, in words."""
    return BANDS[bisect.bisect(HEIGHTS, height)]


GROUPS: Tuple[Tuple[str, Callable[[Dict[str, Any]], str]], ...] = (
    ("species", lambda bird: bird["species"]), ("height", lambda bird: band_of(bird["height"])),
    ("weather", lambda bird: bird["weather"]))


def _groups(everywhere: Sequence[Results]) -> List[Part]:
    """Scores of birds by species, height and weather. @param everywhere birds of each input"""
    found: List[Part] = []
    for by, name_of in GROUPS:
        names = {name_of(bird) for birds in everywhere for bird in birds}
        for name in sorted(names, key=BANDS.index if by == "height" else None):
            of_group = [[bird for bird in birds if name_of(bird) == name] for birds in everywhere]
            found.append((by, name, [*map(of_birds, of_group)]))
    return found


def cell(value: Value, unit: str = "", words: Optional[str] = None) -> str:
    """A score with its standard error, both to the second digit of the error or to hundredths. @param words in place of
    the unit"""
    number, error = ((100.0 if unit == "%" else 1.0) * part for part in value[:2])
    if math.isnan(number):
        return "–"
    digits = min(max(1 - math.floor(math.log10(error)), 0), 2) if error > 0.0 else 1
    of = (f"\u00a0{unit}" if unit else "") if words is None else words
    return f"{number:.{digits}f}{f' ± {error:.{digits}f}' if error > 0.0 else ''}{of}"


def number(score: Tuple[str, Value], name: str, words: str) -> Number:
    """A score, with its unit, on a first page, with its error in words."""
    unit, value = score
    text, _, error = cell(value, unit, "").partition(" ± ")
    error = f"the error by chance is {error} {'percentage points' if unit == '%' else unit}".rstrip() if error else ""
    return Number(f"{text}\u00a0{unit}".rstrip("\u00a0"), name, f"{words}; {error or 'it shows no error by chance'}")


def _rows(of: Sequence[Scores]) -> List[Dict[str, Any]]:
    """A row for each score. @param of scores of each input"""
    return [{"words": words, "cells": [cell(found[words][1], unit) for found in of]}
            for words, (unit, _) in of[0].items()]


def _as_text(value: Any) -> Any:
    """A cell of a table; lists and settings become JSON."""
    return json.dumps(value, ensure_ascii=False) if isinstance(value, (dict, list)) else value


def _tables(names: Sequence[str], results: Sequence[Mapping[str, Any]], parts: Sequence[Part],
            facts: Sequence[Dict[str, Any]], chains: Sequence[Any]) -> Dict[str, List[Any]]:
    """Rows of the tables, by the name of the file. @param facts, chains inputs and their settings"""
    card = [(name, by, group, words, "1" if unit in ("%", "") else unit, *value)
            for k, name in enumerate(names) for by, group, of in parts for words, (unit, value) in of[k].items()]
    followed = [(name, number, one) for name, of in zip(names, results) for number, one in of.items()]
    birds = [{"input": name, "sequence": number, **bird} for name, number, one in followed for bird in one["birds"]]
    return {"card.csv": [("input", "by", "group", "score", "unit", "value", "std_error", "count"), *map(texts, card)],
            "tracks.csv": [("input", "sequence", *STATES),
                           *((name, number, *state) for name, number, one in followed for state in one["states"])],
            "inputs.csv": [[*facts[0], "settings"], *(texts(map(_as_text, [*one.values(), chain]))
                                                      for one, chain in zip(facts, chains))],
            "birds.csv": [[*birds[0]] if birds else ["input", "sequence"], *(texts(bird.values()) for bird in birds)]}


def write_card(out: pathlib.Path, inputs: Sequence[Input], results: Sequence[Mapping[str, Any]],
               runways: Sequence[Sequence[Any]], settings: Dict[str, Any],
               progress: Callable[[str, int, int], Any], page: Optional[Callable[[], bool]] = None) -> Dict[str, Any]:
    """Writes card.csv, tracks.csv, birds.csv, inputs.csv, pictures, card.json and card.html. @param results results of
    each input, by the number of the sequence @param page writes view.html, and returns whether it is there @return the
    content of card.json"""
    names, sequences = [of.name for of in inputs], [list(of.values()) for of in results]
    birds = [[bird for one in of for bird in one["birds"]] for of in sequences]
    of_flocks = [of_birds(flock) for flock in birds]
    overall = [{**of_flock, **of_tracks(of)} for of_flock, of in zip(of_flocks, sequences)]
    warned = [(volume, [warnings_of(flock, volume) for flock in birds]) for volume in VOLUMES if any(map(len, runways))]
    groups = _groups(birds)
    warnings: List[Part] = [("volume", volume, [*map(of_warnings, seconds)]) for volume, seconds in warned]
    facts = [_facts(*of) for of in zip(inputs, sequences, birds)]
    for file, table in _tables(names, results, [("all", "", overall), *groups, *warnings], facts,
                               settings["chains"]).items():
        write_whole(out / file, as_csv(table))
    card: Dict[str, Any] = {
        "version": __version__, "names": names, "cutoff": settings["cutoff"], "order": settings["order"],
        "learning_scans": settings["learning_scans"], "volumes": bool(warned), "settings": settings,
        "answers": [_answer(name, of, [(volume, seconds[k]) for volume, seconds in warned])
                    for k, (name, of) in enumerate(zip(names, overall))],
        "inputs": facts,
        "overall": _rows(overall), "head": [*of_flocks[0]],
        "groups": [{"by": by, "rows": [
            {"name": name, "counts": [found["birds tracked"][1].number for found in of],
             "cells": [row["cells"] for row in _rows(of)]}
            for kind, name, of in groups if kind == by]} for by, _ in GROUPS],
        "warnings": [{"volume": volume, "rows": _rows(of), "heads": [
            f"{name}, {counted(found['mean warning'][1].number, 'bird')}" for name, found in zip(names, of)]}
                     for _, volume, of in warnings]}
    shown = list(_pictures(out, inputs, results, runways))
    progress("pictures", 1, 1)
    write_whole(out / "card.json", as_json(card))
    first = _first(card, overall[0], warned, shown[0])._replace(interactive="view.html" if page and page() else "")
    write_whole(out / "card.html", render("sequences/card.html.jinja", card=card, pictures=shown[1:], rows=ROWS,
                                          most=SHOWN, first=first))
    return card


def _first(card: Mapping[str, Any], of: Scores, warned: Warned, picture: Dict[str, Any]) -> First:
    """The first page, on the first input."""
    name, known = card["names"][0], card["inputs"][0]
    tracked, false = (number(of[words], "", "").value for words in ("birds tracked", "false tracks an hour"))
    third = number(of["share of time"], "of the time tracked", "of all birds in the beams")
    for volume, (seconds, *_) in warned:
        if len(seconds) >= FEWEST:
            third = number(("s", scores.mean(seconds)), "warning", f"before a bird enters the {volume}, on average")
            break
    steps = [("Look at single birds.", "birds.csv has each bird, tracks.csv each track, card.csv all scores."),
             ("Simulate more birds.", "Longer or more sequences make the errors smaller."),
             ("Replace what is assumed.", "The scenario has the birds, their flights, and the sensor's numbers.")]
    return First(
        f"How well are birds tracked? {', '.join(card['names'][:SHOWN])}",
        short_enough(*(f"{who} tracks {tracked} of the birds in its beams and reports {false} false tracks an hour."
                       for who in (name, "The lidar"))), picture,
        [number(of["birds tracked"], "of birds tracked", f"{known['birds']} birds in {known['sequences']} "
                f"sequences of {known['seconds'] / 60:.1f} minutes in all"),
         number(of["false tracks an hour"], "false tracks an hour", "from surfaces, noise and air"), third],
        [{"head": head, "words": words, "command": ""} for head, words in steps],
        ["The scans are simulated. Nothing was measured, and the scores are not a claim about real birds. Assumed are "
         f"kinds, numbers and flights of birds, and of the sensor {', '.join(known['assumed']) or 'no number'}. A "
         "clutter filter that learns only where echoes persist, and a tracker, process the scans. Birds count as "
         "independent."])


def _facts(of: Input, sequences: Results, birds: Results) -> Dict[str, Any]:
    """An input, as the page describes it."""
    origins = [track["origin"] for one in sequences for track in one["tracks"]]
    return {"name": of.name, "sensor": pathlib.Path(of.scenario["sensor"]["preset"]).name.split(".")[0],
            "scene": pathlib.Path(of.scenario["scene"]).name, "position": [float(x) for x in of.sensor.position],
            "sequences": len(sequences), "scans": sum(len(one["ospa"]) for one in sequences),
            "seconds": sum(one["seconds"] for one in sequences), "birds": len(birds), "assumed": of.assumed,
            "false": {origin: origins.count(origin) for origin in FALSE}}


def _answer(name: str, of: Scores, warned: Sequence[Tuple[str, np.ndarray]]) -> str:
    """A sentence that sums up the card of an input."""
    mean = ", ".join(f"a warning of {cell(scores.mean(seconds), 's')} before the {volume} "
                     f"({counted(len(seconds), 'bird')})"
                     for volume, seconds in warned if len(seconds) >= FEWEST)
    tracked, near, false = (cell(of[words][1], of[words][0]) for words in (
        "birds tracked", "tracked or beside a track", "false tracks an hour"))
    return (f"{name}: {tracked} of birds tracked, {near} tracked or beside a track, {false} false tracks an hour"
            f"{', and on average ' + mean if mean else ''}.")


def read_card(folder) -> Dict[str, Any]:
    """The card of a folder that `avianlidar track` has written."""
    folder = pathlib.Path(folder)
    if not (folder / "card.json").is_file():
        raise Error(f"{folder}: holds no card.json, expected a folder that `avianlidar track` has written")
    card = load_json(folder / "card.json")
    if not isinstance(card, dict) or card.get("version") != __version__:
        raise Error(f"{folder / 'card.json'}: is of another version; run `avianlidar track` again")
    return card


def _pictures(out: pathlib.Path, inputs: Sequence[Input], results: Sequence[Mapping[str, Any]],
              runways: Sequence[Sequence[Any]]) -> Iterator[Dict[str, Any]]:
    """The pictures: tracks and birds of the first input, a scan of each input, beginnings of tracks, OSPA distances."""
    grounds = []
    for of, one, lines in zip(inputs, results, runways):
        first = next(iter(one.values()))
        places = [state[3:5] for state in first["states"] if state[9] >= 0]
        grounds.append(_ground(of, lines, lambda away: np.quantile(away, 0.98), places))
    of, first = inputs[0], next(iter(results[0].values()))
    yield drawing.picture(
        out / f"{of.name}-tracks.png", (drawing.WIDTH, 4.4), "Map of confirmed tracks and birds",
        f"Confirmed tracks of {of.name} in the first sequence until scan {first['shown']['scan']}, with its birds.",
        lambda axes: _draw_tracks(axes, grounds[0], first))
    for of, one, ground in zip(inputs, results, grounds):
        sequence, first = next(iter(one.items()))
        last = first["shown"]
        count = last["clutter"].count(0)
        yield drawing.picture(
            out / f"{of.name}-scan.png", (drawing.WIDTH, 2.3), f"One scan of {of.name} in four steps",
            f"{of.name}, scan {last['scan']} (sequence {sequence}): its {len(last['clutter'])} echoes, the {count} "
            "echoes that the clutter filter keeps, confirmed tracks, and birds as they were.",
            lambda axes: _draw_strip(axes, ground, first), columns=4)
    of, lines = inputs[0], runways[0]
    tracks = [track for found in results[0].values() for track in found["tracks"]]
    ground = _ground(of, lines, lambda away: 1.05 * away.max(), [track["begin"][:2] for track in tracks])
    half = 0.5 * drawing.WIDTH - 0.1
    yield drawing.picture(out / f"{of.name}-begin.png", (half, 3.2), f"Where {len(tracks)} confirmed tracks begin",
                          f"Where confirmed tracks of {of.name} begin, by their origin.",
                          lambda axes: _draw_begin(axes, ground, tracks))
    yield drawing.picture(out / "ospa.png", (half, 2.6), f"OSPA distance over time of {len(inputs)} inputs",
                          "OSPA distance over time, as a mean of the sequences (less is better).",
                          lambda axes: _draw_ospa(axes, inputs, results))


def _ground(of: Input, runways: Sequence[Any], reach: Callable[[np.ndarray], float], places: List[Any]) -> Any:
    """The ground around the sensor that `draw_airport` draws. @param reach extent from the distances of places, m"""
    scene = of.scene if pathlib.Path(of.scenario["scene"]).exists() else None  # sequences may have been copied alone
    x, y, _ = of.sensor.position
    away = max(NEAREST, float(reach(np.abs(np.array(places or [(x, y)]) - (x, y)).max(axis=1))))
    return SimpleNamespace(runways=runways, scene=scene, ground=None, sensor=of.sensor,
                           extent=(x - away, x + away, y - away, y + away))


def _paths(axes, sequence: Dict[str, Any], width: float) -> None:
    """Draws the paths of confirmed tracks in the colours of their origins; thin and pale: tracks that have ended."""
    origins = {track["track"]: ORIGINS.index(track["origin"]) for track in sequence["tracks"]}
    paths: Dict[int, List[Sequence[float]]] = {}
    for state in sequence["states"]:
        paths.setdefault(state[1], []).append(state)
    for track, path in paths.items():
        places, now = np.array([state[3:5] for state in path]), path[-1][0] == sequence["shown"]["scan"]
        colour, line = COLOURS[origins[track]], LINES[origins[track]]
        axes.plot(*places.T, color=colour, linestyle=line, linewidth=width if now else 0.4 * width,
                  alpha=1.0 if now else 0.5)
        if now:
            axes.plot(*places[-1], "o", color=colour, markersize=2.5 * width)


def _birds(axes, sequence: Dict[str, Any], size: float) -> None:
    """Draws birds as they were in the shown scan."""
    for x, y, tracked in sequence["last"]:
        axes.plot(x, y, "o" if tracked else "x", color="black", markersize=size, markerfacecolor="none")


def _draw_tracks(axes, ground, sequence: Dict[str, Any]) -> None:
    draw_airport(axes, ground, "0.8")
    x0, x1, y0, y1 = ground.extent
    middle, half = 0.5 * (x0 + x1), 0.85 * (y1 - y0)  # the picture is wider than high
    axes.set(xlim=(middle - half, middle + half), ylim=(y0, y1))
    _paths(axes, sequence, 2.0)
    _birds(axes, sequence, 7.0)
    origins = {track["origin"] for track in sequence["tracks"]}
    for name, colour, line in zip(ORIGINS, COLOURS, LINES):
        if name in origins:
            axes.plot([], [], color=colour, linestyle=line, linewidth=2.0, label=f"track: {name}")
    for mark, label in (("o", "bird, tracked"), ("x", "bird, not tracked")):
        axes.plot([], [], mark, color="black", markersize=6, markerfacecolor="none", label=label)
    axes.plot([], [], "r^", label="lidar")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=5, frameon=False)


def _draw_strip(axes, ground, sequence: Dict[str, Any]) -> None:
    last = sequence["shown"]
    points, origins = np.array(last["points"]).reshape(-1, 3), np.array(last["origins"], int)
    for ax, title in zip(axes, ("echoes", "kept by the filter", "confirmed tracks", "birds (x: not tracked)")):
        draw_airport(ax, ground, "0.85")
        ax.set_title(title)
        ax.locator_params(nbins=3)
        if ax is not axes[0]:
            ax.set(ylabel="", yticklabels=[])
    for ax, chosen in ((axes[0], np.ones(len(points), bool)), (axes[1], ~np.array(last["clutter"], bool))):
        for number in (3, 5, 2, 4, 1, 0):  # birds above all
            part = points[chosen & (origins == number)]
            ax.plot(part[:, 0], part[:, 1], ".", color=COLOURS[number], markersize=3 if number in (0, 2) else 1.5)
    _paths(axes[2], sequence, 1.2)
    _birds(axes[3], sequence, 4.0)


def _draw_begin(axes, ground, tracks: Results) -> None:
    draw_airport(axes, ground, "0.8")
    for name, colour, mark in zip(ORIGINS, COLOURS, MARKS):
        places = np.array([track["begin"][:2] for track in tracks if track["origin"] == name]).reshape(-1, 2)
        if len(places):
            axes.plot(*places.T, mark, color=colour, markersize=4, label=f"{name}: {len(places)}")
    if tracks:
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)


def _draw_ospa(axes, inputs: Sequence[Input], results: Sequence[Mapping[str, Any]]) -> None:
    drawing.series(axes)
    for of, one in zip(inputs, results):
        distances = [[x[0] for x in sequence["ospa"]] for sequence in one.values()]
        values = np.array([*itertools.zip_longest(*distances, fillvalue=math.nan)])
        axes.plot(np.arange(len(values)) / of.sensor.rotation_rate, np.nanmean(values, axis=1), markevery=10,
                  label=of.name)
    drawing.finish(axes, ylim=(0.0, None), xlabel="s since tracking began", ylabel="OSPA distance, m")
