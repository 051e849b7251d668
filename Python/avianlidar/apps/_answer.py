# SPDX-License-Identifier: BSD-3-Clause
"""The first page of a report in words: where a lidar should stand, what it detects, and what to do next."""
from __future__ import annotations

import math
import pathlib
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from .._weather import in_words
from . import reach, siting
from ._maps import Plan
from ._sites import FEWEST_DRAWS

LEAST = 0.0005  # share that is given as a number; a site that detects less is no answer
LEAST_WORDS = f"{100.0 * LEAST:g}\u00a0%"
WINDS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


def place(position: Sequence[float]) -> str:
    """Coordinates in words."""
    x, y, z = position
    words = [f"{abs(value):g}\u00a0m {plus if value > 0.0 else minus}"
             for value, plus, minus in ((x, "east", "west"), (y, "north", "south")) if value]
    return f"{' and '.join(words) or 'at the origin'}, {round(z, 1):g}\u00a0m up"


def percent(value: float, error: float = math.nan) -> str:
    """A share as a percentage, with its standard error."""
    if 0.0 < value < LEAST:
        return f"under {LEAST_WORDS}"
    bar = "" if math.isnan(error) else f" ± {100.0 * error:.1f}"
    return f"{100.0 * value:.1f}{bar}\u00a0%"


def metres(value: float) -> str:
    """A range to what is known of it."""
    return f"{float(f'{value:.2g}') if value < 100.0 else 10.0 * round(value / 10.0):g}\u00a0m" if value > 0.0 else "no range"


def listed(words: Sequence[str]) -> str:
    """a, b and c."""
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def wind(way: np.ndarray) -> str:
    """The direction of a way (east, north) by eight winds."""
    return WINDS[round(math.atan2(way[0], way[1]) / (math.pi / 4)) % 8]


def beside(position: Sequence[float], runways: Sequence[siting.Runway]) -> str:
    """Where a place lies by the two nearest runways, in words: beside a runway how far from its middle line and from an end, else
    how far from an end."""
    found = []
    at = np.asarray(position, dtype=float)[:2]
    for runway in runways:
        axis, length = runway.axis()
        along = float((at - runway.start) @ axis)
        nearer, way = (runway.start, -axis) if along < length / 2 else (runway.end, axis)
        if 0.0 <= along <= length:
            off = at - (runway.start + along * axis)
            away = float(np.hypot(*off))
            found.append((away, f"{metres(away)} {wind(off)} of {runway.name}" if away >= 1.0 else f"on {runway.name}",
                          f", {metres(min(along, length - along))} from its {wind(way)} end"))
        else:
            off = at - nearer
            away = float(np.hypot(*off))
            found.append((away, f"{metres(away)} {wind(off)} of the {wind(way)} end of {runway.name}", ""))
    found = sorted(found)[:2]
    return f"{found[0][1]}{found[0][2]}" + (f", and {found[1][1]}" if len(found) > 1 else "") if found else ""


def birds_of(view: Plan) -> str:
    """Whom the plan asks for, as many."""
    return f"{view.bird}s" if len(view.mix) == 1 else f"birds {view.bird[5:]}"


def over(view: Plan) -> str:
    """Where and how high the birds are that the plan asks for, for who has not seen the plan."""
    if not view.runways:
        return view.where
    count = len(view.runways)
    whose = "the runway" if count == 1 else "both runways" if count == 2 else f"all {count} runways"
    parts = [{"strips": f"the strips of {whose} (to {siting.STRIP_HALF_WIDTH:g}\u00a0m beside the middle)",
              "approaches": f"the approaches (to {siting.APPROACH_LENGTH / 1000.0:g}\u00a0km from an end)"}[name] for name in view.members]
    low, high = view.asked or (0.0, 0.0)
    heights = "" if not view.asked else f"at {low:g}\u00a0m " if low == high else f"at {low:g} to {high:g}\u00a0m "
    tops = "" if view.asked else f", to {listed([f'{view.heights_of(name)[1]:.3g}' for name in view.members])}\u00a0m high"
    return f"{heights}over {listed(parts)}{tops}"


def air_of(view: Plan) -> str:
    """The air of the shares."""
    visibility = view.coverage.visibility
    return f" in {in_words(view.air)}" if view.air else f" at {visibility / 1000.0:g}\u00a0km visibility" if visibility > 0.0 else ""


def two_sentences(plan: Plan, view: Plan, site: Optional[Dict[str, Any]], reaches: Dict[str, Any], of_year: Dict[str, float]) -> List[str]:
    """Where the lidar should stand and which share of the birds it detects from there; how far they are seen. @param view the plan's
    sensor at its best site, or the plan itself @param of_year the share over the plan's year, if it has one"""
    found = view.overall
    detects = (f"one scan detects {percent(found['detection_probability'], found['detection_std_error'])} of {birds_of(view)} "
               f"{over(view)}{air_of(view)}")
    if view.year:
        detects += f", {percent(of_year['detection_probability'], of_year['detection_std_error'])} over the year"
    by = beside(view.sensor.position, view.runways)
    at = f"{place(view.sensor.position)} from the scene's origin{'; ' + site['degrees'] if site and site['degrees'] else ''}"
    mast = round(float(view.sensor.position[2] - siting.ground_of(view.scene, [view.sensor.position[:2]])[0]), 1)
    at = f"on a mast of {mast:g}\u00a0m, {at}" if mast > 0.0 else at
    where = f"{by} ({at})" if by else at
    year = ", by the year's weather" if view.year else ""
    if not site:
        first = f"{plan.name} stands {where}: from there {detects}."
    elif view is plan:
        first = (f"Nowhere: from none of {site['count']} candidates, of {site['lattice']}, one scan of {plan.name} detects {LEAST_WORDS} of "
                 f"{birds_of(view)} {over(view)}{year or air_of(view)}.")
    else:
        first = f"{plan.name} should stand {where}: from there {detects}, the most of {site['count']} candidates{year}."
    return [first, _how_far(view, reaches)]


def _how_far(view: Plan, reaches: Dict[str, Any]) -> str:
    """How far birds are seen, and where that is at the heights asked for."""
    low, high = reach.band(view.sensor)
    said = f"Within its beams, {low:.1f} to {high:.1f}° up, one scan detects {half_and_tenth(reaches)}"
    if not view.asked:
        return f"{said}."
    seen, never = in_band(view, reaches, "\u00a0m up")
    where = [*(["at " + ", ".join(seen)] if seen else []), *([f"nowhere at {listed(never)} m"] if never else [])]
    return f"{said}; half are in its beams and near enough {', and '.join(where)}."


def half_and_tenth(reaches: Dict[str, Any]) -> str:
    """To which range a half and a tenth of each species are detected."""
    def of(name: str, found: reach.Reach) -> str:
        if found.to(0.1) == 0.0:
            return f"less than a tenth of {name}s at any range"
        half = f"half of {name}s to {metres(found.to(0.5))}" if found.to(0.5) > 0.0 else f"at no range half of {name}s"
        return f"{half} and a tenth to {metres(found.to(0.1))}"
    return "; ".join(of(*one) for one in reaches["of"].items())


def in_band(view: Plan, reaches: Dict[str, Any], unit: str) -> Tuple[List[str], List[str]]:
    """From where to where half of the birds are in the beams and near enough at the heights asked for; and heights (m) where nowhere."""
    rows = reach.heights_in_band(view, view.heights, max(one.to(0.5) for one in reaches["of"].values()))
    return ([f"{row['height']:g}{unit} from {row['from']:.0f} to {row['to']:.0f}\u00a0m away" for row in rows if row["to"] > row["from"]],
            [f"{row['height']:g}" for row in rows if not row["to"] > row["from"]])


def next_steps(plan: Plan, view: Plan, site: Optional[Dict[str, Any]], advice: Optional[Dict[str, Any]]) -> List[Dict[str, str]]:
    """What follows from the answer: a head, words, an anchor of the page for more, and a command, each perhaps empty."""
    file = pathlib.Path(plan.file).name if pathlib.Path(plan.file).is_absolute() else plan.file
    steps = [_raise(view, advice)] if advice else []
    if site and len(site["gain"]) > 1 and view is not plan:
        together = [f"{('two', 'three')[row['sensors'] - 2] if row['sensors'] < 4 else row['sensors']} detect {percent(row['value'])}"
                    for row in site["gain"][1:]]
        steps.append({"head": "Weigh a second lidar.", "more": "#sites", "command": "",
                      "words": f"Where one detects {percent(site['gain'][0]['value'])}, {listed(together)} at their best sites, "
                               "if they miss birds independently."})
    if site and view is not plan:
        steps.append(_check(view, site, file))
    steps.append({"head": "Replace what is assumed.", "more": "#assumptions",
                  "words": f"Size and reflectance ({view.coverage.reflectance:g}) of birds, and {len(set(view.assumed))} numbers of {view.name}: ask its "
                           "maker. What darker birds change:",
                  "command": f"avianlidar report {file} -o darker.html --coverage-set reflectance={view.coverage.reflectance / 2.0:g}"})
    return steps


def _raise(view: Plan, advice: Dict[str, Any]) -> Dict[str, str]:
    """The sensor itself, where its band leaves out heights that are asked for."""
    found = {"head": "Change the beams first.", "more": "#heights-in-band", "command": ""}
    if advice["needed"] is None:
        return {**found, "head": "Take a lidar that sees farther.",
                "words": "At the heights asked for no bird is near enough, whatever the elevation of the beams."}
    best = max(advice["ways"], key=lambda way: way["then"]["detection_probability"], default=None)
    ends = f"They end at {advice['high']:.1f}°; for all heights asked for they should go up to {advice['needed']:.1f}°"
    if best is None:
        return {**found, "words": f"{ends}. No change of them that was tried detects more from there."}
    now, then = (percent(one["detection_probability"]) for one in (advice["now"], best["then"]))
    return {**found, "words": f"{ends}. From the same place {best['what'].partition(' (')[0]} detect {then} instead of {now}; it costs "
                              f"{best['cost']}."}


def _check(view: Plan, site: Dict[str, Any], file: str) -> Dict[str, str]:
    """The site itself."""
    words = [f"{site['surfaces']}; what no map has may be there."]
    masts = [f"{percent(value)} with a mast of {mast:g}\u00a0m" for mast, _, value in site["masts"]]
    if len(masts) > 1:
        words.append(f"The best sites have {listed(masts)}.")
    if site["alike"]:
        words.append(f"{site['alike']} more candidates are as good within the error.")
    alone = [row for row in site["robustness"] if row["sensors"] == 1]
    if alone:
        most = max(alone, key=lambda row: row["another winner"])
        words.append(f"With other numbers ({most['change']}) another wins in up to {most['another winner']} of {most['draws']} draws, with at most "
                     f"{1.0 + max(row['gain at most'] for row in alone):.2f} times the share.")
    if site["edge"]:
        words.append("It lies at the lattice's edge: wider bounds may have a better one.")
    if site["draws"] < FEWEST_DRAWS:
        words.append(f"How sure it is the best was not looked at: that takes draws={FEWEST_DRAWS}.")
    at = ",".join(f"{value:g}" for value in view.sensor.position)
    return {"head": "Check the site.", "more": "#sites", "words": " ".join(words) + " Its maps for GIS:",
            "command": f"avianlidar coverage {file} -o maps --sensor-set position={at}"}
