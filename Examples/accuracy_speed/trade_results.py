# SPDX-License-Identifier: BSD-3-Clause
"""From differences to errors, fronts, rates of convergence, and a recommendation in words."""
import dataclasses
import math

import numpy as np

import trade_runs
from trade_grid import Choice

WANTED = (0.01, 0.05, 0.1)  # relative rms errors of energy that are advised on
WANTED_DETECTION = 0.01  # missed and made-up echoes, of those that are there
WANTED_RANGE = 0.1  # rms, in range units
NOTICED = 0.01  # of an error: less is no difference
MARGIN = 0.9  # a setting is advised if its worst seed stays below this share of what is wanted
KINDS = {"energy": "rms relative error of energy", "range": "rms error of range (m)",
         "detection": "missed and false echoes, of the true"}


@dataclasses.dataclass
class Result:
    """A setting: its errors over all seeds, less what is the reference's own, and its median costs."""

    choice: Choice
    scans: list  # numbers of each seed, as summary() makes them
    own: dict  # errors of the reference

    def pooled(self, kind):
        """The rms over seeds, as measured against the reference."""
        if kind == "detection":
            return float(np.mean([s["detection"] for s in self.scans]))
        return trade_runs.rms([s[kind] for s in self.scans])

    def error(self, kind):
        """Without the reference's own part, which is independent and so adds in squares. Where no more than that was
        seen, what was seen: a bound."""
        seen = self.pooled(kind)
        if kind == "detection" or not self.resolved(kind):
            return seen
        return math.sqrt(seen**2 - self.own[kind]**2)

    def resolved(self, kind):
        """Whether the reference is good enough to tell the error."""
        return self.pooled(kind) > 1.5 * self.own[kind]

    def worst(self, kind):
        return max(s[kind] for s in self.scans)

    def median(self, name):
        return float(np.median([s[name] for s in self.scans]))

    def mean(self, name):
        return float(np.mean([s[name] for s in self.scans]))


def summary(found, cost, wall):
    """The numbers of one seed."""
    true = max(found["true"], 1)
    away = abs(found["range"])
    return {"energy": trade_runs.rms(found["energy"]), "range": trade_runs.rms(found["range"]),
            "total": trade_runs.rms(found["total"]),
            "energy_median": float(np.median(abs(found["energy"]))) if len(found["energy"]) else math.nan,
            "range_95": float(np.percentile(away, 95)) if len(away) else math.nan,
            "bias": float(np.mean(found["energy"])) if len(found["energy"]) else math.nan,
            "detection": (found["missed"] + found["false"]) / true, "missed": found["missed"],
            "missed_strong": found["missed_strong"], "false": found["false"], "true": found["true"],
            "cpu": cost.cpu, "wall": wall, "rays": cost.rays, "used": cost.used}


def front(results, kind):
    """Settings that no other beats in both time and this error, the fastest first; by a hundredth is not beaten, nor is
    it on the front."""
    best, found = math.inf, []
    for result in sorted(results, key=lambda r: (r.median("cpu"), r.error(kind))):
        if result.error(kind) < (1 - NOTICED) * best:
            best = result.error(kind)
            found.append(result)
    return found


def rate(results, family, kind="energy"):
    """(exponent, its standard error) of the error over the number of rays, where the reference tells the error."""
    points = [(r.choice.settings["RaysPerBeam"], r.error(kind)) for r in results
              if r.choice.family == family and r.resolved(kind) and r.error(kind) > 0]
    if len(points) < 3:
        return math.nan, math.nan
    x, y = np.log(np.array(points)).T
    slope, offset = np.polyfit(x, y, 1)
    spread = math.sqrt(np.sum((y - slope * x - offset)**2) / (len(x) - 2) / np.sum((x - x.mean())**2))
    return float(slope), spread


@dataclasses.dataclass
class Advice:
    """What to use for one wish. `result` is None where nothing of the grid is good enough."""

    kind: str
    wanted: float
    result: Result = None
    checked: dict = None  # numbers of a seed that took no part in the choice

    @property
    def kept(self):
        return self.checked is not None and self.checked[self.kind] <= self.wanted


def advise(results, kind, wanted, check):
    """The fastest setting whose worst seed keeps the wish with some margin, and which keeps it on a new seed, too."""
    good = [r for r in results if r.worst(kind) <= MARGIN * wanted]
    for result in sorted(good, key=lambda r: r.median("cpu")):
        advice = Advice(kind, wanted, result, check(result.choice))
        if advice.kept:
            return advice
    return Advice(kind, wanted)


def wishes(subject):
    return [*(("energy", e) for e in WANTED), ("detection", WANTED_DETECTION), ("range", WANTED_RANGE * subject.unit)]


def amount(kind, value):
    return f"{1000 * value:.3g} mm" if kind == "range" else f"{100 * value:.2g} %"


def sentence(advice, subject, results):
    """The recommendation in words."""
    wish = {"energy": f"{amount('energy', advice.wanted)} energy error (rms of echoes of at least twice the limit)",
            "detection": f"{amount('detection', advice.wanted)} of the echoes missed or false",
            "range": f"a range error of {amount('range', advice.wanted)} (rms)"}[advice.kind]
    if advice.result is None:
        best = min(results, key=lambda r: r.error(advice.kind))
        return (f"For {wish} on this scene ({subject.title}) nothing that was tried is enough: {best.choice.words} "
                f"reaches {amount(advice.kind, best.error(advice.kind))} in {best.median('cpu'):.3g} s.")
    result = advice.result
    text = (f"For {wish} on this scene ({subject.title}) use {result.choice.words}: "
            f"{amount(advice.kind, result.error(advice.kind))} measured over {len(result.scans)} seeds, "
            f"{amount(advice.kind, advice.checked[advice.kind])} on a seed of its own, {result.median('cpu'):.3g} s of "
            f"one core, {result.mean('rays'):.0f} rays traced per beam.")
    plain = [r for r in results if r.choice.family == "Monte Carlo" and r.worst(advice.kind) <= MARGIN * advice.wanted]
    if plain:
        first = min(plain, key=lambda r: r.median("cpu"))
        rays = first.mean("rays") / max(result.mean("rays"), 1e-9)
        longer = first.median("cpu") / max(result.median("cpu"), 1e-9)
        text += (f" Plain Monte Carlo needs {first.choice.settings['RaysPerBeam']} rays per beam for it: "
                 f"{rays:.1f} times the rays, {longer:.1f} times the time.")
    else:
        text += plain_by_law(advice, results)
    return text


def plain_by_law(advice, results):
    """What plain Monte Carlo would need, by the law that its errors follow."""
    plain = [r for r in results if r.choice.family == "Monte Carlo"]
    most = max(plain, key=lambda r: r.choice.settings["RaysPerBeam"])
    slope, _ = rate(results, "Monte Carlo", advice.kind)
    if not slope < 0:
        return " Plain Monte Carlo does not reach it with what was tried."
    factor = (most.error(advice.kind) / (MARGIN * advice.wanted)) ** (-1 / slope)
    rays = factor * most.mean("rays") / max(advice.result.mean("rays"), 1e-9)
    needed = float(f"{factor * most.choice.settings['RaysPerBeam']:.1g}")
    return (f" Plain Monte Carlo would need about {needed:.0f} rays per beam for it, by the rate at which its errors "
            f"fall: {rays:.0f} times the rays.")
