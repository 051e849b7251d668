# SPDX-License-Identifier: BSD-3-Clause
"""The first page of a report in words: where a lidar should stand, which birds it detects, and what to do next."""
from __future__ import annotations

import math
import pathlib
import shlex
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ... import reach
from ..._numbers import figures
from ..._properties import snake
from ..._weather import in_words
from ..inputs._on_sale import PLACE
from ..pages._words import listed, plural
from ..places._candidates import ground_of
from ..places._regions import APPROACH_LENGTH, KINDS, STRIP_HALF_WIDTH, Runway, region_names, rounded, wind
from ._crossing import Crossing
from ._plan import Plan
from ._sites import FEWEST_DRAWS

LEAST = 0.0005  # least share that is given as a number; a site that detects less is not an answer
LEAST_WORDS = f"{100.0 * LEAST:g}\u00a0%"
# Shares in words, each up to a share.
IN_WORDS = ((LEAST, "hardly any"), (0.002, "fewer than one in 500"), (0.01, "fewer than one in 100"),
            (0.03, "fewer than one in 30"), (0.1, "fewer than one in ten"), (0.25, "fewer than one in four"),
            (0.5, "fewer than half"), (0.75, "more than half"), (0.9, "more than three in four"),
            (math.inf, "more than nine in ten"))


def place(position: Sequence[float]) -> str:
    """Coordinates in words."""
    x, y, z = rounded(position)
    words = [f"{value.lstrip('-')}\u00a0m {minus if value.startswith('-') else plus}"
             for value, plus, minus in ((x, "east", "west"), (y, "north", "south")) if value != "0"]
    return f"{' and '.join(words) or 'at the origin'}, {z}\u00a0m up"


def decimals(error: float) -> int:
    """Number of decimals that a standard error justifies: one significant digit of the error."""
    return min(max(-math.floor(math.log10(error)), 0), 9)


def bound(places: int) -> float:
    """Upper bound (95 %) of a share if none of the drawn places counts. @param places number of drawn places"""
    return max(LEAST, 3.0 / places) if places else LEAST


def percent(value: float, error: float = math.nan, places: int = 0, bar: bool = True) -> str:
    """A share as a percentage, with the digits that its standard error justifies. @param error standard error of drawn
    places @param places number of drawn places @param bar whether the error is shown"""
    if math.isnan(value):
        return "–"
    if value < LEAST and (value > 0.0 or not math.isnan(error)):
        return f"under {float(f'{100.0 * bound(places):.1g}'):g}\u00a0%" if places else f"under {LEAST_WORDS}"
    if value == 0.0:
        return "0\u00a0%"
    digits = decimals(100.0 * error) if error > 0.0 else 1
    after = f" ± {100.0 * error:.{digits}f}" if error > 0.0 and bar else ""
    return f"{100.0 * value:.{digits}f}{after}\u00a0%"


def cell(row: Dict[str, Any], column: str) -> str:
    """A share, or its standard error, from a row of shares, with the digits that the error justifies."""
    value, places = row[column], row["places"]
    if math.isnan(value):
        return "–"
    if column.endswith("_std_error"):
        share = row[column.replace("_std_error", "_probability")]
        return f"{value:.{decimals(value)}f}" if value > 0.0 and share >= LEAST else "–"
    known = column.endswith("_probability")
    error = row[column.replace("_probability", "_std_error")] if known else math.sqrt(value * (1.0 - value) / places)
    if error > 0.0 and value >= LEAST:
        return f"{value:.{decimals(error)}f}"
    least = min(bound(places), 1.0)
    return f"< {least:.1g}" if value < 0.5 else f"> {1.0 - least:.{decimals(least)}f}"


def metres(value: float) -> str:
    """A range with two digits, or in tens of metres."""
    if not value > 0.0:
        return "no range"
    rounded_value = float(f"{value:.2g}") if value < 100.0 else 10.0 * round(value / 10.0)
    return f"{rounded_value:g}\u00a0m"


def beside(position: Sequence[float], runways: Sequence[Runway]) -> str:
    """The position of a place relative to the two nearest runways, in words. Beside a runway: the distances from the
    middle line and from an end. Beyond a runway: the distance from an end."""
    at, found = np.asarray(position, dtype=float)[:2], []
    for runway in runways:
        axis, length = runway.axis()
        along = float((at - runway.start) @ axis)
        off = at - (runway.start + min(max(along, 0.0), length) * axis)
        away, end = float(np.hypot(*off)), f"{wind(-axis if along < length / 2 else axis)} end"
        if 0.0 <= along <= length:
            words = f"{metres(away)} {wind(off)} of {runway.name}" if away >= 1.0 else f"on {runway.name}"
            found.append((away, words, f", {metres(min(along, length - along))} from its {end}"))
        else:
            found.append((away, f"{metres(away)} {wind(off)} of the {end} of {runway.name}", ""))
    found = sorted(found)[:2]
    parts = [words for _, words, _ in found]
    if found:
        parts[0] += found[0][2]  # the distance from an end, for the nearest runway only
    return ", and ".join(parts)


def birds_of(view: Plan) -> str:
    """The birds that the plan names, in the plural."""
    return plural(view.bird) if len(view.mix) == 1 else f"birds {view.bird[5:]}"


def over(view: Plan) -> str:
    """The regions and heights of the birds, for readers who have not seen the plan."""
    if not view.runways:
        return view.where
    count, parts = len(view.runways), []
    whose = {1: "the runway", 2: "both runways"}.get(count, f"all {count} runways")
    for kind, names in region_names(view.runways).items():
        there = [name.partition(" ")[2] for name in names if name in view.ends]
        every = len(there) == len(names)
        up_to = f", up to {figures(view.heights_of(kind)[1], 3)}\u00a0m high" if there and not view.asked else ""
        if there and kind == "strips":
            which = f"the strips of {whose}" if every else f"the strip of {listed(there)}"
            parts.append(f"{which} (to {STRIP_HALF_WIDTH:g}\u00a0m beside the middle{up_to})")
        elif there:
            which = "the approaches" if every else f"the approach to {listed(there)}"
            parts.append(f"{which} (to {APPROACH_LENGTH / 1000.0:g}\u00a0km from an end{up_to})")
    if not view.asked:
        return f"over {listed(parts)}"
    low, high = view.asked
    heights = f"{low:g}" if low == high else f"{low:g} to {high:g}"
    return f"at {heights}\u00a0m over {listed(parts)}"


def air_of(view: Plan) -> str:
    """The air in which the shares hold."""
    if view.air:
        return f" in {in_words(view.air)}"
    if view.coverage.visibility > 0.0:
        return f" at {view.coverage.visibility / 1000.0:g}\u00a0km visibility"
    return ""


def takes(plan: Plan) -> str:
    """The duration of one scan of the plan's sensor."""
    return f"{figures(1.0 / plan.sensor.rotation_rate, 2)}\u00a0s"


def twice(crossing: Optional[Crossing]) -> str:
    """The share of birds that is detected at least twice while crossing."""
    return percent(crossing.share, crossing.error, crossing.birds) if crossing else "–"


def _meaning(view: Plan, crossing: Optional[Crossing]) -> str:
    """What the share of one scan means, and the share of birds that is detected at least twice while crossing."""
    if not crossing:
        return f"One scan takes {takes(view)}. The share is the mean over the whole map, near and far."
    whole = {"strips": "the whole length of", "approaches": f"the whole {APPROACH_LENGTH / 1000.0:g}\u00a0km of"}
    count = {kind: sum(KINDS[name.partition(" ")[0]] == kind for name in view.ends) for kind in whole}
    one = {"strips": "strip", "approaches": "approach"}
    parts = listed([f"{whole[kind]} {'the' if count[kind] == 1 else 'each'} {one[kind]}"
                    for kind in whole if count[kind]])
    scans, seconds = (f"{float(f'{value:.2g}'):g}" for value in (crossing.scans, crossing.seconds))
    return (f"The share is that of one scan, which takes {takes(view)}, as a mean over {parts}, near and far. While "
            f"birds cross there at right angles at {crossing.speed:.3g}\u00a0m/s (on average for {seconds}\u00a0s, or "
            f"{scans} scans), {twice(crossing)} of them are detected at least twice.")


def in_short(view: Plan, site: Optional[Dict[str, Any]], crossing: Optional[Crossing]) -> str:
    """The result in one sentence without a number: for readers who read no further."""
    share = crossing.share if crossing else view.overall["detection_probability"]
    words = next(words for most, words in IN_WORDS if share < most)
    best = ", at its best site," if site and site["detects"] else ""
    birds = f"crossing {birds_of(view)} at least twice" if crossing else f"{birds_of(view)} by one scan"
    return f"In short: {view.name}{best} detects {words} of the {birds}."


def about_idea(view: Plan, offers: Sequence[Dict[str, Any]]) -> List[str]:
    """A sentence if nobody sells the lidar, and one on the best lidar on sale at the same place. @param offers lidars
    on sale, the best first"""
    if not view.idea:
        return []
    best, crossing = offers[0], offers[0]["crossing"]
    seen = f"{share_of(best['row'])} of the same birds by one scan"
    seen += f", and {twice(crossing)} at least twice while they cross" if crossing else ""
    who = (f"the best of {len(offers)} lidars on sale ({best['name']} of {best['maker']})" if any(merit(best)[:2]) else
           f"each of {len(offers)} lidars on sale")
    return [f"{view.idea} At the same place, {who} detects {seen}."]


def merit(offer: Dict[str, Any]) -> Tuple[float, float, float]:
    """What lidars on sale are ordered by: shares detected twice and by one scan, if they are given as a number, and the
    range to which half of the birds are detected."""
    shares = (offer["crossing"].share if offer["crossing"] else 0.0, offer["row"]["detection_probability"])
    twice_share, one_scan = (share if share >= LEAST else 0.0 for share in shares)
    return twice_share, one_scan, 0.0 if math.isnan(offer["half"]) else offer["half"]


def first_sentences(plan: Plan, view: Plan, site: Optional[Dict[str, Any]], reaches: Dict[str, Any],
                    of_year: Dict[str, float], crossing: Optional[Crossing]) -> List[str]:
    """Where the lidar should stand, which share of the birds is detected from there, and how far birds are detected.
    @param view the plan's sensor at its best site, or the plan itself @param of_year the share over the plan's year"""
    birds, position = f"{birds_of(view)} {over(view)}", view.sensor.position
    year = ", by the year's weather" if view.year else ""
    over_the_year = f", {share_of(of_year)} over the year" if view.year else ""
    detects = f"one scan detects {share_of(view.overall)} of {birds}{air_of(view)}{over_the_year}"
    mast = round(float(position[2] - ground_of(view.scene, [position[:2]])[0]), 1)
    across, _, up = place(position).rpartition(", ")
    up = "" if f"{mast:g}\u00a0m up" == up else f", {up}"  # not the same number twice
    at = f"on a mast of {mast:g}\u00a0m{up}, {across}" if mast > 0.0 else place(position)
    at = f"{at} from the scene's origin{'; ' + site['degrees'] if site and site['degrees'] else ''}"
    by = beside(position, view.runways)
    where = f"{by} ({at})" if by else at
    if not site:
        first = f"{plan.name} stands {where}: from there {detects}."
    elif view is plan:
        first = (f"Nowhere: from none of {site['count']} candidates, of {site['lattice']}, one scan of {plan.name} "
                 f"detects {LEAST_WORDS} of {birds}{year or air_of(view)}.")
    else:
        stands = "would stand best" if view.idea else "should stand"
        alike = site["alike"] + 1
        which = (f"one of {alike} sites that are equally good within the error, of {site['count']} candidates"
                 if site["alike"] else f"the most of {site['count']} candidates")
        first = f"{plan.name} {stands} {where}: from there {detects}, {which}{year}."
        own, best = plan.overall, view.overall
        if not site["taken"] and (own["detection_probability"] + own["detection_std_error"] >=
                                  best["detection_probability"]):
            first += f" Its place in the plan or the scene ({place(plan.sensor.position)}) is as good: {share_of(own)}."
    there = [f"The other numbers of this page are for the sensor's place in the plan or its scene ({place(position)})."]
    there = there if site and view is plan else []
    return [first, *there, _meaning(view, crossing), *_by_end(view), _how_far(view, reaches)]


def share_of(row: Dict[str, Any]) -> str:
    """The share of a row that one scan detects, with the standard error."""
    return percent(row["detection_probability"], row["detection_std_error"], row["places"])


def _by_end(view: Plan) -> List[str]:
    """A sentence with the shares by strip and approach, if the plan has several."""
    alike: Dict[Tuple[str, str], List[str]] = {}
    for row in view.by_end:
        kind, _, name = row["region"].partition(" ")
        alike.setdefault((share_of(row), "strip of" if kind == "strip" else f"{kind} to"), []).append(name)
    words = [f"{share} in the {which} {listed(names)}" for (share, which), names in alike.items()]
    return [f"By region the share is {listed(words)}."] if len(view.by_end) > 1 else []


def _how_far(view: Plan, reaches: Dict[str, Any]) -> str:
    """Sentence on how far birds are detected, and on the distances at the plan's heights."""
    found = []
    for name, one in reaches["of"].items():
        birds = plural(name)
        half = f"half of {birds} to {metres(one.to(0.5))}" if one.to(0.5) > 0.0 else f"at no range half of {birds}"
        found.append(f"{half} and a tenth to {metres(one.to(0.1))}" if one.to(0.1) > 0.0 else
                     f"less than a tenth of {birds} at any range")
    low, high = reach.band(view.sensor)
    said = f"Within its beams, {low:.1f} to {high:.1f}° up, one scan detects {'; '.join(found)}"
    half_to = max(one.to(0.5) for one in reaches["of"].values())
    seen: List[str] = []
    never: Dict[str, List[str]] = {}  # by the cause
    for row in reach.heights_in_band(view, view.heights, half_to) if view.asked and half_to > 0.0 else ():
        end = min(row["to"], row["until"])
        if end > row["from"]:
            begin = metres(row["from"]) if row["from"] else "0 m"
            seen.append(f"at a height of {row['height']:g}\u00a0m between {begin} and {metres(end)} from the lidar")
        else:
            never.setdefault(_why_never(row), []).append(f"{row['height']:g}")
    said += f". It detects half or more of the birds {listed(seen)}" if seen else ""
    for why, heights in never.items():
        said += f". At {listed(heights)}\u00a0m it nowhere detects half of the birds{why}"
    return f"{said}."


def _why_never(row: Dict[str, float]) -> str:
    """The cause why half of the birds at a height are detected nowhere, if it is known. @param row of
    `reach.heights_in_band`"""
    if math.isinf(row["from"]):
        return ", because no beam gets there"
    if row["from"] >= row["to"] > 0.0:
        return ", because the beams get there only where the range is already too long"
    return ", because all of these birds are too far away" if row["to"] == 0.0 else ""


def command(view: Plan, verb: str, out: str, **settings: str) -> str:
    """A command with every option of this report that the verb has. @param settings further settings, such as
    `coverage.species`, which replace settings of the same names"""
    file = pathlib.Path(view.file).name if pathlib.Path(view.file).is_absolute() else view.file
    words = ["avianlidar", verb, file, "-o", out]
    flags = {"--weather", "--sensor-set", "--coverage-set"}
    if verb == "report":
        flags |= {"--metar", "--siting-set"}
    for flag, *values in view.plan.get("options", ()):
        if flag in flags and f"{flag[2:].partition('-')[0]}.{snake(values[0].partition('=')[0])}" not in settings:
            words += [flag, *values]
    for name, value in settings.items():
        part, _, member = name.partition(".")
        words += [f"--{part}-set", f"{member}={value}"]
    return shlex.join(words + (["--threads", str(view.threads)] if view.threads else []))


def detects(way: Dict[str, Any]) -> Tuple[float, float]:
    """What changes of the beams are ordered by: the share detected at least twice, if it is known, and by one scan."""
    return (way["crossing"].share if way["crossing"] else 0.0, way["then"]["detection_probability"])


def next_steps(plan: Plan, view: Plan, site: Optional[Dict[str, Any]], advice: Optional[Dict[str, Any]],
               offers: Sequence[Dict[str, Any]]) -> List[Dict[str, str]]:
    """The next steps: for each a head, words, an anchor of the page, and a command, which may be empty. @param offers
    lidars on sale, the best first"""
    steps = [_ask(plan, view, offers)] if view.idea else []
    steps += [_raise(view, advice)] if advice else []
    if site and view is plan and not view.idea and not advice:
        steps.append({"head": "Look for a lidar that sees farther.", "more": "#range", "command": "",
                      "words": f"{view.name} detects almost none of the birds from any candidate."})
    if site and view is not plan:
        if len(site["gain"]) > 1:
            steps.append(_weigh(view, site))
        steps.append(_check(view, site))
    cover = view.coverage
    ask = "" if view.idea else f" Ask the maker of {view.name} for the numbers of the lidar."
    steps.append({"head": "Replace what is assumed.", "more": "#assumptions",
                  "words": (f"Size and reflectance ({cover.reflectance:g}) of birds and {len(set(view.assumed))} "
                            f"numbers of {view.name} are assumed.{ask} This command shows the effect of darker birds:"),
                  "command": command(plan, "report", "darker.html",
                                     **{"coverage.reflectance": f"{cover.reflectance / 2.0:g}"})})
    return steps


def _ask(plan: Plan, view: Plan, offers: Sequence[Dict[str, Any]]) -> Dict[str, str]:
    """The step for a lidar that nobody sells."""
    best = offers[0]["name"]
    changed = plan.plan["sensor"].keys() - {"preset", "name", *PLACE}
    what = f"the report for {best}{', at the best site for it' if 'siting' in plan.plan else ''}"
    settings = {"sensor.preset": best, **({"sensor.name": best} if "name" in plan.plan["sensor"] else {})}
    return {"head": f"Do not plan to buy {view.name}.", "more": "#on-sale",
            "words": ("The result shows what a lidar with these numbers would do. Ask makers whether they can build "
                      "such a lidar, and for measured ranges of birds. "
                      + (f"A plan with the sensor {best} makes {what}." if changed else f"This command makes {what}:")),
            "command": "" if changed else command(plan, "report", "on-sale.html", **settings)}


def _weigh(view: Plan, site: Dict[str, Any]) -> Dict[str, str]:
    """The step that compares networks with one lidar."""
    words = {2: "two", 3: "three"}
    one, *more = [percent(row["value of the same birds"], row["std_error"], view.count, bar=False)
                  for row in site["gain"]]
    counts = [words.get(row["sensors"], row["sensors"]) for row in site["gain"][1:]]
    together = listed([f"{count} detect {share}" for count, share in zip(counts, more)])
    return {"head": "Weigh a second lidar.", "more": "#sites", "command": "",
            "words": (f"One lidar detects {one}{' over the year' if view.year else ''}; at their best sites, "
                      f"{together}. They see a bird with one heading and size, and otherwise miss it independently.")}


def _raise(view: Plan, advice: Dict[str, Any]) -> Dict[str, str]:
    """A change of the sensor, if the band leaves out heights of the plan."""
    head = "Change the beams first." if view.idea else "Look for a lidar with higher beams."
    found = {"head": head, "more": "#heights-in-band", "command": ""}
    if advice["needed"] is None:
        return {**found, "head": "Take a lidar that sees farther.",
                "words": "At the heights of the plan no bird is near enough, whatever the elevation of the beams."}
    ends = (f"The beams end at {advice['high']:.1f}°. "
            f"For all heights of the plan they should reach {advice['needed']:.1f}°.")
    better = [way for way in advice["ways"] if detects(way) > detects({**advice, "then": advice["now"]})]
    best = max(better, key=detects, default=None)
    if best is None:
        return {**found, "words": f"{ends} No tried change of the beams detects more birds from the same place."}
    now, then = (percent(row["detection_probability"], row["detection_std_error"], row["places"], bar=False)
                 for row in (advice["now"], best["then"]))
    crosses = (f", and {twice(best['crossing'])} instead of {twice(advice['crossing'])} at least twice while they cross"
               if best["crossing"] else "")
    return {**found, "words": (f"{ends} The best change that was tried: {best['what'].partition(' (')[0]}. From the "
                               f"same place one scan of this lidar detects {then} instead of {now}{crosses}. "
                               f"It costs {best['cost']}.")}


def how_sure(site: Dict[str, Any]) -> Tuple[List[str], List[str]]:
    """Sentences on equally good candidates, and on a best candidate at the lattice's edge; each list may be empty."""
    more = "1 other site is" if site["alike"] == 1 else f"{site['alike']} other sites are"
    alike = [f"{more} as good within the error of the random places."] if site["alike"] else []
    at_edge = "The best candidate lies at the lattice's edge: wider bounds may contain a better candidate."
    return alike, [at_edge] if site["edge"] else []


def _other_draws(site: Dict[str, Any]) -> List[str]:
    """A sentence on how often another site wins, and with which lead, if numbers of the calculation change."""
    alone = [row for row in site["robustness"] if row["sensors"] == 1]
    others = [row for row in alone if row["another winner"]]
    if not alone:
        return []
    if not others:
        changes = listed([_changed(row["change"]) for row in alone])
        return [f"The choice is sharp: with {changes} this site wins in all {alone[0]['draws']} draws."]
    wins = listed([f"with {_changed(row['change'])} another site wins in {row['another winner']} of {row['draws']} "
                   "draws" for row in others])
    most = 100.0 * max(row["gain at most"] for row in others)
    lead = f"at most {most:.0f}\u00a0%" if most >= 1.0 else "less than 1\u00a0%"
    return [f"The choice is not sharp: {wins}. The other site then detects {lead} more birds than this site."]


def _changed(change: str) -> str:
    """Words on a change of `Sites.changes`."""
    what, _, amount = change.partition(" ±")
    what = {"effective area": "effective areas of birds", "other places": "other random places"}.get(what, what)
    return f"{what} changed by up to {amount}" if amount else what


def _check(view: Plan, site: Dict[str, Any]) -> Dict[str, str]:
    """The step that checks the site."""
    alike, edge = how_sure(site)
    words = [f"{site['surfaces']} Objects that no map shows may stand there."]
    masts = []
    for row in site["masts"]:
        value, error = row["share"]
        share = percent(value, error, view.count, bar=False)
        masts.append(f"{share} with a mast of {row['mast']:g}\u00a0m")
    if len(masts) > 1:
        words.append(f"The best sites have {listed(masts)}.")
    words += [*site["higher"], *alike, *_other_draws(site), *edge]
    if site["draws"] < FEWEST_DRAWS:
        words.append(f"The certainty of the best site was not computed: it needs draws={FEWEST_DRAWS} or more.")
    return {"head": "Check the site.", "more": "#sites", "words": " ".join([*words, "Maps of the site for GIS:"]),
            "command": command(view, "coverage", "maps",
                               **{"sensor.position": ",".join(rounded(view.sensor.position))})}
