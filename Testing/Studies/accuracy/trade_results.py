# SPDX-License-Identifier: BSD-3-Clause
"""From differences to errors, fronts, rates of convergence, and a recommendation in words."""
import dataclasses
import math

import numpy as np

import tools
import trade_runs
from trade_grid import PRESETS, Choice

WANTED = (0.01, 0.05, 0.1)  # relative rms errors of energy that are advised on
WANTED_DETECTION = 0.01  # missed and made-up echoes, of those that are there
WANTED_RANGE = 0.1  # rms, in range units
NOTICED = 0.01  # of an error: less is no difference
MARGIN = 0.9  # a setting is advised if its worst seed stays below this share of what is wanted
KINDS = ("energy", "range", "detection")


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


def summary(found, cost):
    """The numbers of one seed."""
    return {**{kind: trade_runs.rms(found[kind]) for kind in ("energy", "range", "total")},
            "energy_median": float(np.median(abs(found["energy"]))), "held": float(np.mean(found["held"])),
            "detection": trade_runs.wrong(found), "missed": found["missed"], "false": found["false"],
            "cpu": cost.cpu, "rays": cost.rays}


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


def advice_table(advice, results):
    """Head and rows: for each wish the setting to use, what it reaches and costs, and what plain Monte Carlo needs."""
    rows = []
    for one in advice:
        kind, wanted = one.kind, amount(one.kind, one.wanted)
        result = one.result or min(results, key=lambda r, kind=kind: r.error(kind))
        words, on_new_seed, plain = f"nothing suffices; the best is {result.choice.words}", "-", "-"
        if one.result:
            words, plain = result.choice.words, plain_needs(one, results)
            on_new_seed = amount(kind, one.checked[kind])
        rows.append((f"{wanted} missed or false" if kind == "detection" else f"{kind} to {wanted} rms", words,
                     amount(kind, result.error(kind)), on_new_seed, f"{result.median('cpu'):.3g}",
                     f"{result.mean('rays'):.0f}", plain))
    return ("wanted", "use", "reached", "on a new seed", "s of one core", "rays per beam",
            "plain Monte Carlo needs"), rows


def plain_needs(advice, results):
    """Rays and time of plain Monte Carlo for the same wish; beyond what was tried, by the rate at which its errors
    fall."""
    plain = [r for r in results if r.choice.family == "Monte Carlo"]
    good = [r for r in plain if r.worst(advice.kind) <= MARGIN * advice.wanted]
    if good:
        first = min(good, key=lambda r: r.median("cpu"))
        longer = first.median("cpu") / max(advice.result.median("cpu"), 1e-9)
        return f"{first.choice.settings['RaysPerBeam']} rays, {longer:.1f} times the time"
    slope, _ = rate(results, "Monte Carlo", advice.kind)
    if not slope < 0:
        return "more than was tried"
    most = max(plain, key=lambda r: r.choice.settings["RaysPerBeam"])
    factor = (most.error(advice.kind) / (MARGIN * advice.wanted)) ** (-1 / slope)
    needed = factor * most.choice.settings["RaysPerBeam"]
    return f"about {float(f'{needed:.1g}'):.0f} rays (extrapolated)"


def draw(results, subject, reference, file):
    """Error of energy against time: every setting a dot, the front a line, presets named."""
    groups = {}
    for result in results:
        groups.setdefault("presets" if result.choice.family in PRESETS else result.choice.family, []).append(result)
    # Zeros have no place on a logarithmic axis: they lie on its lower end.
    floor = 0.5 * min((r.error("energy") for r in results if r.error("energy") > 0), default=1e-6)

    def places(some):
        return [r.median("cpu") for r in some], [max(r.error("energy"), floor) for r in some]

    with tools.figure(file, figsize=(8.5, 6), dpi=110) as axes:
        presets = groups.pop("presets", [])
        for i, (name, some) in enumerate(groups.items()):
            axes.plot(*places(some), "os^vDPX<>ph8d"[i % 13], markersize=5, alpha=0.8, label=name)
        axes.plot(*places(front(results, "energy")), "-", color="black", linewidth=1.2, label="front", zorder=1)
        axes.plot(*places(presets), "*", markersize=15, color="crimson", markeredgecolor="white", zorder=5)
        for result, place in zip(presets, zip(*places(presets))):
            axes.annotate(result.choice.family, place, xytext=(0, 10), textcoords="offset points", color="crimson",
                          weight="bold", ha="center")
        if reference.own["energy"] > 0:
            axes.axhline(reference.own["energy"], color="grey", linestyle=":", linewidth=1,
                         label="the reference's own error")
        axes.set(xscale="log", yscale="log", xlabel=f"time of one core for {subject.number_of_beams} beams (s)",
                 ylabel="rms relative error of energy")
        axes.set_title(f"{subject.title}: {int(reference.strong.sum())} echoes of at least twice the lower limit",
                       fontsize=11)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, ncol=2)
