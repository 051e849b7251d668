# SPDX-License-Identifier: BSD-3-Clause
"""The report card of tracks: scores by species, height and weather, pictures, and a page of HTML."""
from __future__ import annotations

import itertools
import math
import pathlib
from types import SimpleNamespace
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .._disk import write_whole
from .._pipeline import Error
from .._ranks import as_json
from .._version import __version__
from .._writers import as_csv
from . import _pictures as pictures
from . import _scores as scores
from ._following import FALSE, ORIGINS, STATES, VOLUMES, Input
from ._json import load_json
from ._scores import Value
from ._tables import embedded, render

HEIGHTS = (0.0, 10.0, 30.0, 60.0, math.inf)  # limits of the bands of a bird's mean height, m
WARNED = (10.0, 30.0, 60.0)  # warning times that are counted, s
Named = List[Tuple[str, str, Value]]  # words, unit and value of scores
# Scores of groups of birds: name, words and unit on the page.
OF_BIRDS = (("tracked", "birds tracked", "%"), ("near", "tracked or beside a track", "%"), ("time", "share of time", "%"),
            ("delay", "delay", "s"), ("switches", "identity switches", ""))
OF_TRACKS = (("false", "false tracks an hour", ""), ("vehicle", "tracks of vehicles an hour", ""),
             ("second", "second tracks of a bird an hour", ""), ("ospa", "OSPA distance", "m"), ("ospa_localisation", "OSPA: localisation", "m"),
             ("ospa_cardinality", "OSPA: without partner", "m"))
NEAREST = 300.0  # least extent of maps around the sensor, m
FEWEST = 5  # least number of birds for a curve of warnings
COLOURS = ("#1b9e77", "#66c2a5", "#7570b3", "#d95f02", "#e7298a", "#66a6ff")  # colours of ORIGINS
Results = List[Dict[str, Any]]


def of_birds(birds: Results) -> Dict[str, Value]:
    """Scores of a group of birds that were in the volume of the sensor."""
    found = [bird for bird in birds if bird["found_s"] is not None]
    return {"tracked": scores.share(len(found), len(birds)), "near": scores.share(sum(bird["near"] > 0 for bird in birds), len(birds)),
            "time": scores.ratio([bird["tracked"] for bird in birds], [bird["scans"] for bird in birds]),
            "delay": scores.mean([bird["found_s"] - bird["came_s"] for bird in found]), "switches": scores.mean([bird["switches"] for bird in found])}


def of_tracks(sequences: Results) -> Dict[str, Value]:
    """Scores of the tracks of several sequences."""
    hours, origins = sum(one["seconds"] for one in sequences) / 3600.0, [track["origin"] for one in sequences for track in one["tracks"]]
    counts = {"false": sum(origin in FALSE for origin in origins), "vehicle": origins.count("vehicle"), "second": origins.count(ORIGINS[1])}
    parts = np.array([np.mean(one["ospa"], axis=0) for one in sequences])
    return {**{name: scores.rate(count, hours) for name, count in counts.items()},
            **{name: scores.mean(part) for name, part in zip(("ospa", "ospa_localisation", "ospa_cardinality"), parts.T)}}


def warnings_of(birds: Results, volume: str) -> np.ndarray:
    """Warning times, s: how long each bird that flies into a volume was on or beside a confirmed track before; 0 without a track. A bird
    that begins in such a volume counts if it flies into a different volume."""
    return np.array([max(bird[volume] - bird["near_s"], 0.0) if bird["near_s"] is not None else 0.0 for bird in birds if bird[volume] is not None])


def of_warnings(seconds: np.ndarray) -> Named:
    """Name, unit and score of the warnings of a volume."""
    return [("mean warning", "s", scores.mean(seconds)), ("warned at all", "%", scores.share(int((seconds > 0.0).sum()), len(seconds))),
            *((f"warned {least:g} s before or more", "%", scores.share(int((seconds >= least).sum()), len(seconds))) for least in WARNED)]


def band_of(height: float) -> str:
    """The band of a height, in words."""
    low, high = next((low, high) for low, high in zip(HEIGHTS, HEIGHTS[1:]) if height < high)
    return f"below {high:g} m" if low == 0.0 else f"{low:g} to {high:g} m" if math.isfinite(high) else f"above {low:g} m"


BANDS = [band_of(low) for low in HEIGHTS[:-1]]
GROUPS: Tuple[Tuple[str, Callable[[Dict[str, Any]], str]], ...] = (
    ("species", lambda bird: bird["species"]), ("height", lambda bird: band_of(bird["height"])), ("weather", lambda bird: bird["weather"]))


def _groups(everywhere: Sequence[Results]) -> List[Dict[str, Any]]:
    """Rows by species, height and weather with the scores of each input."""
    found = []
    for by, name_of in GROUPS:
        names = {name_of(bird) for birds in everywhere for bird in birds}
        ordered = [band for band in BANDS if band in names] if by == "height" else sorted(names)
        found.append({"by": by, "rows": [{"name": name, "cells": [of_birds([bird for bird in birds if name_of(bird) == name]) for birds in everywhere]}
                                         for name in ordered]})
    return found


def cell(value: Value, unit: str = "", words: Optional[str] = None) -> str:
    """A score with its standard error, both to the second digit of the error or to hundredths. @param words words in place of the unit"""
    number, error = ((100.0 if unit == "%" else 1.0) * part for part in value[:2])
    if math.isnan(number):
        return "–"
    digits = min(max(1 - math.floor(math.log10(error)), 0), 2) if error > 0.0 else 1
    of = (f"\u00a0{unit}" if unit else "") if words is None else words
    return f"{number:.{digits}f}{'' if math.isnan(error) else f' ± {error:.{digits}f}'}{of}"


def _named(kinds: Sequence[Tuple[str, str, str]], of: Mapping[str, Value]) -> Named:
    return [(words, unit, of[key]) for key, words, unit in kinds]


def _rows(parts: Sequence[Named]) -> List[Dict[str, Any]]:
    """A row for each score. @param parts scores of each input"""
    return [{"words": same[0][0], "cells": [cell(value, unit) for _, unit, value in same]} for same in zip(*parts)]


def write_card(out: pathlib.Path, inputs: Sequence[Input], results: Sequence[Mapping[str, Any]], runways: Sequence[Sequence[Any]], settings: Dict[str, Any],
               progress: Callable[[str, int, int], Any]) -> Dict[str, Any]:
    """Writes card.csv, tracks.csv, birds.csv, pictures, card.json and card.html. @param results results of each input, by the number of the
    sequence @return the content of card.json"""
    sequences = [list(of.values()) for of in results]
    birds = [[bird for one in of for bird in one["birds"]] for of in sequences]
    overall = [{**of_birds(flock), **of_tracks(of)} for flock, of in zip(birds, sequences)]
    groups = _groups(birds)
    warned = [(volume, [warnings_of(flock, volume) for flock in birds]) for volume in VOLUMES if any(map(len, runways))]
    names = [of.name for of in inputs]

    table: List[List[Any]] = [["input", "by", "group", "score", "unit", "value", "std_error", "count"]]
    everything = [_named((*OF_BIRDS, *OF_TRACKS), of) for of in overall]
    for k, name in enumerate(names):
        parts = [("all", "", everything[k]), *((group["by"], row["name"], _named(OF_BIRDS, row["cells"][k])) for group in groups for row in group["rows"]),
                 *(("volume", volume, of_warnings(seconds[k])) for volume, seconds in warned)]
        table += [[name, by, group, words, "1" if unit in ("%", "") else unit, *("" if math.isnan(x) else f"{x:.6g}" for x in value[:2]), value.number]
                  for by, group, found in parts for words, unit, value in found]
    write_whole(out / "card.csv", as_csv(table))
    followed = [(name, number, one) for name, of in zip(names, results) for number, one in of.items()]
    write_whole(out / "tracks.csv", as_csv([("input", "sequence", *STATES), *((name, number, *state) for name, number, one in followed for state in one["states"])]))
    columns = [*birds[0][0]] if birds[0] else []
    write_whole(out / "birds.csv", as_csv([["input", "sequence", *columns], *(
        [name, number, *("" if bird[key] is None else f"{bird[key]:.6g}" if isinstance(bird[key], float) else bird[key] for key in columns)]
        for name, number, one in followed for bird in one["birds"])]))

    card: Dict[str, Any] = {
        "version": __version__, "names": names, "cutoff": settings["cutoff"], "order": settings["order"], "learning_scans": settings["learning_scans"],
        "volumes": bool(warned), "settings": settings,
        "answers": [_answer(name, of, [(volume, seconds[k]) for volume, seconds in warned]) for k, (name, of) in enumerate(zip(names, overall))],
        "inputs": [{"name": of.name, "sensor": pathlib.Path(of.scenario["sensor"]["preset"]).name.split(".")[0], "scene": pathlib.Path(of.scenario["scene"]).name,
                    "position": [float(x) for x in of.sensor.position], "sequences": len(found), "scans": sum(len(one["ospa"]) for one in found),
                    "seconds": sum(one["seconds"] for one in found), "birds": len(flock), "assumed": of.assumed,
                    "false": {origin: sum(track["origin"] == origin for one in found for track in one["tracks"]) for origin in FALSE}}
                   for of, found, flock in zip(inputs, sequences, birds)],
        "overall": _rows(everything), "head": [words for _, words, _ in OF_BIRDS],
        "groups": [{"by": group["by"], "rows": [{"name": row["name"], "counts": [of["tracked"].number for of in row["cells"]],
                                                 "cells": [one["cells"] for one in _rows([_named(OF_BIRDS, of) for of in row["cells"]])]}
                                                for row in group["rows"]]} for group in groups],
        "warnings": [{"volume": volume, "counts": [len(of) for of in seconds], "rows": _rows([*map(of_warnings, seconds)])} for volume, seconds in warned]}
    card["pictures"] = _pictures(out, inputs, results, runways, warned, progress)
    write_whole(out / "card.json", as_json(card))
    write_whole(out / "card.html", render("card.html.jinja", card=shown(out, card)))
    return card


def _answer(name: str, of: Dict[str, Value], warned: Sequence[Tuple[str, np.ndarray]]) -> str:
    """A sentence that sums up the card of an input."""
    mean = ", ".join(f"a warning of {cell(scores.mean(seconds), 's')} before the {volume} ({len(seconds)} birds)"
                     for volume, seconds in warned if len(seconds) >= FEWEST)
    return (f"{name}: {cell(of['tracked'], '%')} of birds tracked, {cell(of['near'], '%')} tracked or beside a track, "
            f"{cell(of['false'])} false tracks an hour{', and on average ' + mean if mean else ''}.")


def read_card(folder) -> Dict[str, Any]:
    """The card of a folder that `avianlidar track` has written, with its pictures."""
    folder = pathlib.Path(folder)
    if not (folder / "card.json").is_file():
        raise Error(f"{folder}: holds no card.json, expected a folder that `avianlidar track` has written")
    card = load_json(folder / "card.json")
    if not isinstance(card, dict) or card.get("version") != __version__:
        raise Error(f"{folder / 'card.json'}: is of another version; run `avianlidar track` again")
    return shown(folder, card)


def shown(folder: pathlib.Path, card: Dict[str, Any]) -> Dict[str, Any]:
    """A card with embedded pictures."""
    return {**card, "pictures": [{**picture, "source": embedded(folder / picture["file"])} for picture in card["pictures"]]}


def _pictures(out: pathlib.Path, inputs: Sequence[Input], results: Sequence[Mapping[str, Any]], runways: Sequence[Sequence[Any]],
              warned: Sequence[Tuple[str, List[np.ndarray]]], progress: Callable[[str, int, int], Any]) -> List[Dict[str, str]]:
    found: List[Dict[str, str]] = []

    def add(kind: str, name: str, size: Tuple[float, float], alt: str, caption: str, work, columns: int = 1) -> None:
        pictures.draw(out / name, size, work, columns)
        found.append({"kind": kind, "file": name, "alt": alt, "caption": caption})
        progress("pictures", len(found), 2 * len(inputs) + 1 + bool(warned))
    for of, one, lines in zip(inputs, results, runways):
        number, first = next(iter(one.items()))
        last = first["shown"]
        places = np.array([state[3:5] for state in first["states"] if state[9] >= 0] or [of.sensor.position[:2]])
        reach = max(NEAREST, float(np.quantile(np.abs(places - of.sensor.position[:2]).max(axis=1), 0.98)))
        ground = _ground(of, lines, of.sensor.position[:2], reach)
        count = sum(clutter == 0 for clutter in last["clutter"])
        add("strip", f"{of.name}-scan.png", (13.2, 3.7), f"One scan of {of.name} in four steps.",
            f"{of.name}, scan {last['scan']} (sequence {number}), from above: its {len(last['clutter'])} echoes; the {count} "
            "echoes that the clutter filter keeps; confirmed tracks so far; "
            "birds as they were, tracked or not", lambda axes, ground=ground, first=first: _draw_strip(axes, ground, first), 4)
        begun = [track for sequence in one.values() for track in sequence["tracks"]]
        where = np.array([track["begin"][:2] for track in begun] or [of.sensor.position[:2]])
        reach = max(NEAREST, 1.05 * float(np.abs(where - of.sensor.position[:2]).max()))
        words = ", ".join(f"{sum(track['origin'] == name for track in begun)} of origin {name}" for name in ORIGINS)
        add("begin", f"{of.name}-begin.png", (5.0, 4.6), f"Where confirmed tracks of {of.name} begin: {words}.", f"{of.name}: where confirmed tracks begin",
            lambda axes, ground=_ground(of, lines, of.sensor.position[:2], reach), begun=begun: _draw_begin(axes, ground, begun))
    add("ospa", "ospa.png", (5.6, 3.4), "OSPA distance over time.", "OSPA distance over time, mean of the sequences; less is better",
        lambda axes: _draw_ospa(axes, {of.name: [[x[0] for x in sequence["ospa"]] for sequence in one.values()] for of, one in zip(inputs, results)},
                                [1.0 / of.sensor.rotation_rate for of in inputs]))
    if warned:
        add("warnings", "warnings.png", (5.6, 3.4), "Share of birds by their warning time.", "Share of the birds that fly into a volume which were beside a confirmed "
            "track that long before", lambda axes: _draw_warnings(axes, [of.name for of in inputs], warned))
    return found


def _ground(of: Input, runways: Sequence[Any], middle: Sequence[float], reach: float) -> Any:
    """The ground that `draw_airport` draws, up to `reach` metres around a place."""
    scene = of.scene if pathlib.Path(of.scenario["scene"]).exists() else None  # sequences may have been copied without the scene
    return SimpleNamespace(runways=runways, scene=scene, ground=None, sensor=of.sensor,
                           extent=(middle[0] - reach, middle[0] + reach, middle[1] - reach, middle[1] + reach))


def _draw_strip(axes, ground, sequence: Dict[str, Any]) -> None:
    last = sequence["shown"]
    points, origins, clutter = np.array(last["points"]).reshape(-1, 3), np.array(last["origins"], int), np.array(last["clutter"], bool)
    for ax, title in zip(axes, ("echoes", "kept by the clutter filter", "confirmed tracks", "birds: tracked (green), not (red)")):
        pictures.draw_airport(ax, ground, "0.85")
        ax.set_title(title, fontsize=9)
        ax.set_ylabel("m north" if ax is axes[0] else "")
    for ax, chosen in ((axes[0], np.ones(len(points), bool)), (axes[1], ~clutter)):
        for number, colour in enumerate(COLOURS):
            part = points[chosen & (origins == number)]
            ax.plot(part[:, 0], part[:, 1], ".", color=colour, markersize=3 if number in (0, 2) else 1.5)
    colours = {track["track"]: COLOURS[ORIGINS.index(track["origin"])] for track in sequence["tracks"]}
    paths: Dict[int, List[Sequence[float]]] = {}
    for state in sequence["states"]:
        paths.setdefault(state[1], []).append(state)
    for track, path in paths.items():
        places, now = np.array([state[3:5] for state in path]), path[-1][0] == last["scan"]
        axes[2].plot(*places.T, color=colours[track], linewidth=1.2 if now else 0.5, alpha=1.0 if now else 0.5)
        if now:
            axes[2].plot(*places[-1], "o", color=colours[track], markersize=3)
    for x, y, tracked in sequence["last"]:
        axes[3].plot(x, y, "o" if tracked else "x", color="#1b9e77" if tracked else "#cc2222", markersize=4)


def _draw_begin(axes, ground, tracks: Results) -> None:
    pictures.draw_airport(axes, ground, "0.8")
    for name, colour in zip(ORIGINS, COLOURS):
        places = np.array([track["begin"][:2] for track in tracks if track["origin"] == name]).reshape(-1, 2)
        if len(places):
            axes.plot(*places.T, "o", color=colour, markersize=4, label=f"{name}: {len(places)}")
    axes.legend()


def _draw_ospa(axes, of: Mapping[str, List[List[float]]], periods: Sequence[float]) -> None:
    for (name, sequences), period in zip(of.items(), periods):
        values = np.array([*itertools.zip_longest(*sequences, fillvalue=math.nan)])
        axes.plot(period * np.arange(len(values)), np.nanmean(values, axis=1), label=name)
    pictures.finish(axes, ylim=(0.0, None), xlabel="s since tracking began", ylabel="OSPA distance, m")


def _draw_warnings(axes, names: Sequence[str], warned: Sequence[Tuple[str, List[np.ndarray]]]) -> None:
    for (volume, of), style in zip(warned, ("-", "--")):
        for number, (name, seconds) in enumerate(zip(names, of)):
            if len(seconds) >= FEWEST:
                least = np.sort(seconds[seconds > 0.0])
                shares = [np.mean(seconds > 0.0), *(np.mean(seconds >= t) for t in least)]
                axes.step([0.0, *least], shares, where="pre", linestyle=style, color=f"C{number}", label=f"{name}, {volume} ({len(seconds)} birds)")
    pictures.finish(axes, ylim=(0.0, 1.02), xlim=(0.0, None), xlabel="warning, s", ylabel="share of birds")
