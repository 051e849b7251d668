# SPDX-License-Identifier: BSD-3-Clause
"""A report in words: where a lidar should stand, which birds it detects, and what to do next."""
from __future__ import annotations

import math
import pathlib
import shlex
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ..._numbers import figures
from ..._properties import snake
from ..._weather import in_words
from ..inputs._on_sale import PLACE
from ..pages._html import Number, short_enough
from ..pages._words import listed, plural
from ..places._candidates import ground_of
from ..places._regions import Runway, rounded, wind
from ._crossing import Crossing
from ._plan import Plan
from ._sites import FEWEST_DRAWS

LEAST = 0.0005  # least share that is given as a number; a site that detects less is not an answer
LEAST_WORDS = f"{100.0 * LEAST:g}\u00a0%"
CLAIM = "is not a claim about real birds"


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
    """What the share of one scan means."""
    if not crossing:
        return f"One scan takes {takes(view)}. The share is the mean over the whole map, near and far."
    return (f"One scan takes {takes(view)}. The share is the mean over the whole length of these regions, near and "
            f"far. Birds cross there at right angles at {crossing.speed:.3g}\u00a0m/s, and {twice(crossing)} of them "
            "are detected at least twice.")


def sentence(view: Plan, site: Optional[Dict[str, Any]]) -> str:
    """The answer in at most MOST_WORDS words. @param site facts of the best site, if sites were compared"""
    share = share_of(view.overall, bar=False)
    kinds = (plural(view.bird), "birds") if len(view.mix) == 1 else ("birds",)
    if site and not site["detects"]:
        return short_enough(*(f"Nowhere: at none of {site['count']} sites does one scan of {who} detect {LEAST_WORDS} "
                              f"of the {birds}." for who in (view.name, "the lidar") for birds in kinds))
    nearest = beside(view.sensor.position, view.runways).partition(", and ")[0]
    stands = "would stand best" if view.idea else "should stand"
    places = [nearest, nearest.partition(", ")[0]] if nearest else [place(view.sensor.position)]
    begin = [f"{{}} {stands} {where}: one scan" for where in places] if site else [
        f"{{}} stands {where}: one scan" for where in places]
    return short_enough(*(f"{first.format(who)} detects {share} of {birds}." for who in (view.name, "The lidar")
                          for birds in kinds for first in (*begin, "One scan of {}")))


def numbers(view: Plan, reaches: Dict[str, Any], crossing: Optional[Crossing], fog: Dict[str, Any]) -> List[Number]:
    """Three numbers with their errors in words. @param fog the row of shares at a visibility of 1 km"""
    def drawn(value: float, error: float) -> str:
        if value < LEAST or not error > 0.0:
            return "fewer than the random places can show" if value < LEAST else "without an error by chance"
        return f"the random places leave {100.0 * error:.{decimals(100.0 * error)}f} percentage points uncertain"

    def share(row: Dict[str, Any]) -> Tuple[str, str]:
        value, error = row["detection_probability"], row["detection_std_error"]
        return percent(value, error, row["places"], bar=False), drawn(value, error)
    (once, error), (species, one) = share(view.overall), next(iter(reaches["of"].items()))
    limits = reaches["limits"][species]
    units = (f"real units: {metres(limits[0].to(0.5))} to {metres(limits[1].to(0.5))}" if limits and
             limits[1].to(0.5) > 0.0 else "no unit was measured with birds")
    found = [Number(once, "detected by one scan", f"of {birds_of(view)} {view.where}; {error}"),
             Number(metres(one.to(0.5)), "range to which half are detected",
                    f"of {plural(species)} in the beams by one scan, in free air; {units}")]
    if crossing:
        scans, seconds = (f"{float(f'{value:.2g}'):g}" for value in (crossing.scans, crossing.seconds))
        found.append(Number(percent(crossing.share, crossing.error, crossing.birds, bar=False),
                            "detected at least twice while crossing", f"in {seconds} s or {scans} scans on average; "
                            + drawn(crossing.share, crossing.error).replace("places", "birds")))
    else:
        found.append(Number(share(fog)[0], "in fog of 1 km visibility", f"detected by one scan; {share(fog)[1]}"))
    return found


def assumed(view: Plan, offers: Sequence[Dict[str, Any]]) -> List[str]:
    """Sentences on what is assumed. @param offers lidars on sale, the best first"""
    return [*about_idea(view, offers), f"Nothing was measured, and the answer {CLAIM}. Sizes, shapes, plumage and "
            f"reflectance ({view.coverage.reflectance:g}) of birds are assumed, and so are {len(set(view.assumed))} "
            f"numbers of {view.name}{', ' + air_of(view).strip() if air_of(view) else ''} and the distribution of "
            f"{view.count:,} random places. These assumptions may change the numbers by more than chance does. "
            "Eye safety, cost and the recognition of birds by software are not assessed."]


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


def details(plan: Plan, view: Plan, site: Optional[Dict[str, Any]], of_year: Dict[str, float],
            crossing: Optional[Crossing]) -> List[str]:
    """Where the lidar should stand, and which share of the birds is detected from there.
    @param view the plan's sensor at its best site, or the plan itself @param of_year the share over the plan's year"""
    birds, position = f"{birds_of(view)} {view.where}", view.sensor.position
    year = ", by the year's weather" if view.year else ""
    over_the_year = f", {share_of(of_year)} over the year" if view.year else ""
    detects = f"one scan detects {share_of(view.overall)} of {birds}{air_of(view)}{over_the_year}"
    mast = round(float(position[2] - ground_of(view.scene, [position[:2]])[0]), 1)
    at = (f"on a mast of {mast:g}\u00a0m, " * (mast > 0.0) + f"{place(position)} from the scene's origin"
          f"{'; ' + site['degrees'] if site and site['degrees'] else ''}")
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
        first += f" From its place in the plan or the scene it detects {share_of(plan.overall)}."
    there = [f"The other numbers of this page are for the sensor's place in the plan or its scene ({place(position)})."]
    there = there if site and view is plan else []
    return [first, *there, _meaning(view, crossing)]


def share_of(row: Dict[str, Any], bar: bool = True) -> str:
    """The share of a row that one scan detects. @param bar whether the standard error is shown"""
    return percent(row["detection_probability"], row["detection_std_error"], row["places"], bar)


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
    """The next steps: for each a head, words, and a command, which may be empty. @param offers lidars on sale, the best
    first"""
    steps = [_ask(plan, view, offers)] if view.idea else []
    steps += [_raise(view, advice)] if advice else []
    if site and view is plan and not view.idea and not advice:
        steps.append(_step("Look for a lidar that sees farther.",
                           f"{view.name} detects almost none of the birds from any candidate."))
    if site and view is not plan:
        if len(site["gain"]) > 1:
            steps.append(_step("Weigh a second lidar.", _weigh(view, site)))
        where = {"sensor.position": ",".join(rounded(view.sensor.position))}
        steps.append(_step("Check the site.", "No map shows every object, and aprons, roads or water may be there. "
                           "Maps of the site for GIS:", command(view, "coverage", "maps", **where)))
    dark = f"{view.coverage.reflectance / 2.0:g}"
    ask = "" if view.idea else f" Ask the maker of {view.name} for the numbers of the lidar."
    steps.append(_step("Replace what is assumed.", f"{ask} This command shows the effect of darker birds:".strip(),
                       command(plan, "report", "darker.html", **{"coverage.reflectance": dark})))
    return steps


def _step(head: str, words: str, text: str = "") -> Dict[str, str]:
    return {"head": head, "words": words, "command": text}


def _ask(plan: Plan, view: Plan, offers: Sequence[Dict[str, Any]]) -> Dict[str, str]:
    """The step for a lidar that nobody sells."""
    best = offers[0]["name"]
    changed = plan.plan["sensor"].keys() - {"preset", "name", *PLACE}
    what = f"the report for {best}{', at the best site for it' if 'siting' in plan.plan else ''}"
    settings = {"sensor.preset": best, **({"sensor.name": best} if "name" in plan.plan["sensor"] else {})}
    return _step(f"Do not plan to buy {view.name}.",
                 "Ask makers whether they can build such a lidar, and for measured ranges of birds. "
                 + (f"A plan with the sensor {best} makes {what}." if changed else f"This command makes {what}:"),
                 "" if changed else command(plan, "report", "on-sale.html", **settings))


def _weigh(view: Plan, site: Dict[str, Any]) -> str:
    """The comparison of networks with one lidar."""
    one, *more = [percent(row["value of the same birds"], row["std_error"], view.count, bar=False)
                  for row in site["gain"]]
    together = listed([f"{count} detect {share}" for count, share in enumerate(more, 2)])
    return f"One lidar detects {one}{' over the year' if view.year else ''}; at their best sites, {together}."


def _raise(view: Plan, advice: Dict[str, Any]) -> Dict[str, str]:
    """A change of the sensor, if the band leaves out heights of the plan."""
    if advice["needed"] is None:
        return _step("Take a lidar that sees farther.",
                     "At the heights of the plan no bird is near enough, whatever the elevation of the beams.")
    head = "Change the beams first." if view.idea else "Look for a lidar with higher beams."
    ends = (f"The beams end at {advice['high']:.1f}°. "
            f"For all heights of the plan they should reach {advice['needed']:.1f}°.")
    better = [way for way in advice["ways"] if detects(way) > detects({**advice, "then": advice["now"]})]
    best = max(better, key=detects, default=None)
    if best is None:
        return _step(head, f"{ends} No tried change of the beams detects more birds from the same place.")
    now, then = (percent(row["detection_probability"], row["detection_std_error"], row["places"], bar=False)
                 for row in (advice["now"], best["then"]))
    return _step(head, f"{ends} The best change that was tried is {best['what'].partition(' (')[0]}: one scan then "
                       f"detects {then} instead of {now}. It costs {best['cost']}.")


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


def certainty(site: Dict[str, Any]) -> List[str]:
    """Sentences on how sure the best site is, and on what was checked."""
    masts = [f"{percent(row['share'][0], row['share'][1], bar=False)} with a mast of {row['mast']:g}\u00a0m"
             for row in site["masts"]]
    words = [f"The best sites have {listed(masts)}."] if len(masts) > 1 else []
    more = "1 other site is" if site["alike"] == 1 else f"{site['alike']} other sites are"
    words += site["higher"] + [f"{more} as good within the error of the random places."] * bool(site["alike"])
    words += _other_draws(site) + ["The best candidate lies at the lattice's edge: wider bounds may contain a better "
                                   "candidate."] * bool(site["edge"])
    if site["draws"] < FEWEST_DRAWS:
        words.append(f"How sure the winner is was not computed: it needs draws={FEWEST_DRAWS} or more.")
    elif not site["heights_varied"]:
        words.append("Heights of buildings are not varied, because none is read from an attribute of footprints.")
    if site["taken"]:
        words.append("No candidate may stand at the plan's position of the sensor.")
    return [*words, f"Obstacle limits: {site['surfaces']}."]
