# SPDX-License-Identifier: BSD-3-Clause
"""The files that `avianlidar design` writes: design.csv, sensitivities.csv, pictures and a page of HTML."""
from __future__ import annotations

import math
import pathlib
from typing import Any, Dict, List

import numpy as np

from .._disk import only_run, write_whole
from .._version import __version__
from . import _pictures as pictures
from ._card import cell
from ._design import CHANGE, FIELDS, TOLD, Candidate, Study, is_told
from ._report import place
from ._scores import Value
from ._tables import embedded, render, write_table

TOLD_WORDS = {True: "yes", False: "no", None: "undecided"}


def _cost(study: Study, cost: float) -> str:
    return f"{cost:.4g}{' ' + study.unit if study.unit else ''}"


def does(study: Study) -> str:
    """The meaning of the share, in words."""
    birds = f"{study.plan.bird}s" if len(study.plan.mix) == 1 else "birds"
    if study.measure == "tracked":
        return f"tracks {birds} of the scenario at least once"
    needed = study.plan.coverage.required_detections
    time = f"{needed} or more of the scans in {study.within:g} s" if study.within else "one scan"
    return f"detects {birds} {study.plan.where}, by {time}"


def stands(study: Study) -> str:
    """The place of the lidar, in words."""
    x, y, _ = study.plan.sensor.position
    return f"{place((x, y, study.about.values['mast'] + study.ground)).rsplit(',', 1)[0]} of the scene's origin" if x or y else "at the scene's origin"


def in_words(study: Study, one: Candidate) -> str:
    """The varied numbers of a design, in words."""
    return ", ".join(f"{FIELDS[name].words} {FIELDS[name].text(one.values[name])}" for name in study.swept)


def pulses(study: Study, one: Candidate) -> str:
    """The numbers of pulses with which an assessment of eye safety begins."""
    of, energy = one.pulses, FIELDS["pulse_energy"].text(one.values["pulse_energy"])
    first = "" if "pulse_energy" in study.swept else f"{energy} a pulse, "
    return (f"{first}{of['exposure']:.4g} J/m² a pulse at the exit aperture of {1e4 * of['exit_aperture']:.4g} cm², "
            f"{of['pulse_rate']:,.0f} pulses a second")


def unassessed(study: Study, one: Candidate) -> str:
    """Words on eye safety, which is not assessed, and on the energy of a pulse that an eye at the lidar would receive."""
    microjoules = float(f"{1e6 * one.pulses['pupil']:.2g}")
    return (f"eye safety is not assessed: at {study.plan.sensor.wavelength:g} nm each pulse puts {microjoules:g} µJ "
            "through a pupil of 7 mm at the exit aperture, if the pulse fills the aperture evenly (assumed)")


def answers(study: Study) -> List[str]:
    """The answers to the question of the plan, in sentences."""
    count, asked = len(study.judged), f"{100.0 * study.asked:g} %"
    about, share = study.about, cell(study.of(study.about), "%")
    question, cost = does(study).replace(" ", f" {asked} of ", 1), f"costs {_cost(study, about.cost)} by the plan's formula"
    first = (f"The cheapest of {count} designs that {question} {cost} and has {share}" if study.chosen else
             f"None of {count} designs surely {question}: the best design has {share} and {cost}")
    found = [f"{first}; {unassessed(study, about)}.", f"The design is number {about.number}: "
                                                      f"{in_words(study, about)}; {pulses(study, about)}."]
    other = study.elsewhere
    same = is_told(other.value, other.error, study.asked)
    words = {True: "at least the required share", False: "less than the required share", None: "the error does not decide"}[same]
    found.append(f"At {other.number:,} other places, which were not used to choose designs, the design detects {cell(other, '%')}"
                 + (f": {words}." if study.measure == "detected" and study.chosen else "."))
    unsure = study.undecided()
    if unsure:
        least = min(unsure, key=lambda one: one.cost)
        found.append(f"For {len(unsure)} {'cheaper ' if study.chosen else ''}{'design' if len(unsure) == 1 else 'designs'}, "
                     f"from {_cost(study, least.cost)} on, the error "
                     f"does not decide, because their shares lie within {TOLD:g} standard errors of {asked}. More "
                     f"{'scans' if study.measure == 'tracked' else 'places'} would decide.")
    return found


def table(study: Study) -> List[Dict[str, Any]]:
    """Rows of design.csv, in SI units."""
    rows = []
    for one in study.candidates:
        row: Dict[str, Any] = {"design": one.number, **{f"{name} [{FIELDS[name].unit}]": one.values[name] for name in FIELDS},
                               "detected [1]": one.share.value, "detected_std_error [1]": one.share.error}
        if study.measure == "tracked":
            row.update({"tracked [1]": one.tracked.value, "tracked_std_error [1]": one.tracked.error, "tracked_of [1]": one.tracked.number})
        row.update({f"cost [{study.unit or '1'}]": one.cost, "wavelength [nm]": float(study.plan.sensor.wavelength),
                    "pulse_width [s]": float(study.plan.sensor.pulse_width), **{f"{name}]": one.pulses.get(key, math.nan) for name, key in (
                        ("exit_aperture [m2", "exit_aperture"), ("radiant_exposure [J/m2", "exposure"), ("through_7_mm_pupil [J", "pupil"),
                        ("pulse_rate [Hz", "pulse_rate"), ("shortest_interval [s", "shortest_interval"), ("average_power [W", "average_power"))},
                    "on_the_front": int(one.front), "has_the_asked_share": _verdict(study, one, ""),
                    "chosen": int(one is study.chosen), "refused": one.refused})
        rows.append(row)
    return rows


def _verdict(study: Study, one: Candidate, unknown: str) -> str:
    """Whether a design has the required share, in words. @param unknown words for designs without a share"""
    return unknown if math.isnan(study.of(one).value) else TOLD_WORDS[study.has_it(one)]


def _draw_front(axes, study: Study) -> None:
    def bars(of: List[Candidate], shares: List[Value], **style: Any) -> None:
        axes.errorbar([one.cost for one in of], [100 * share.value for share in shares], [100 * share.error for share in shares], **style)
    others, front = [one for one in study.candidates if not (one.refused or one.front)], study.front
    for of, style in ((others, {"color": "0.6", "label": "designs"}), (front, {"color": "C0", "label": "on the front"})):
        bars(of, [one.share for one in of], fmt="o", markersize=4, **style)
    axes.step([one.cost for one in front], [100 * one.share.value for one in front], where="post", color="C0", linewidth=1)
    if study.finalists:
        bars(study.finalists, [one.tracked for one in study.finalists], fmt="s-", color="C1", label="tracked")
    axes.axhline(100 * study.asked, color="red", linewidth=0.8, label=f"required: {100 * study.asked:g} %")
    about = study.about
    axes.plot(about.cost, 100 * study.of(about).value, "*", color="red", markersize=14, zorder=5,
              label="cheapest with this share" if study.chosen else "the best")
    pictures.finish(axes, ylim=(0.0, None), xlabel=f"cost{', ' + study.unit if study.unit else ''}", ylabel="share of birds, %")


def _draw_sensitivities(axes, study: Study) -> None:
    rows = [row for row in study.sensitivities if not row["refused"]]
    order = sorted(study.swept, key=lambda name: max((abs(row["share"].value) for row in rows if row["field"] == name), default=0.0))
    for row in rows:
        up = row["to"] > row["from"]
        axes.barh(order.index(row["field"]) + (0.19 if up else -0.19), 100 * row["share"].value, 0.36, xerr=100 * row["share"].error, color="C0" if up else "C1")
    for up, colour in ((True, "C0"), (False, "C1")):
        axes.barh([0], [0], color=colour, label="more" if up else "less")
    axes.set_yticks(np.arange(len(order)), [FIELDS[name].words for name in order])
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set_xlabel("change of the share detected, percentage points")
    axes.grid(axis="x")
    axes.legend()


def write(study: Study) -> None:
    """design.csv, sensitivities.csv, front.png, sensitivities.png, design.html, in the study's folder."""
    out = pathlib.Path(study.folder)
    write_table(out / "design.csv", table(study))
    write_table(out / "sensitivities.csv", [
        {"field": row["field"], "unit": row["unit"], "from": row["from"], "to": row["to"], "change_of_detected [1]": row["share"].value,
         "change_std_error [1]": row["share"].error, f"change_of_cost [{study.unit or '1'}]": row["cost"], "refused": row["refused"]} for row in study.sensitivities])
    pictures.draw(out / "front.png", (6.4, 4.2), lambda axes: _draw_front(axes, study))
    pictures.draw(out / "sensitivities.png", (6.4, 4.2), lambda axes: _draw_sensitivities(axes, study))
    shown = sorted({one.number: one for one in [*study.front, study.about]}.values(), key=lambda one: one.cost)
    plan, refused = study.plan, [one for one in study.candidates if one.refused]
    bounds = study.options["bounds"]
    base = [{"words": FIELDS[name].words, "base": FIELDS[name].text(study.base[name]),
             "bounds": _bounds(name, bounds[name]) if name in bounds else "the same in all designs", "swept": name in bounds} for name in FIELDS]
    write_whole(out / "design.html", render(
        "design.html.jinja", question=plan.plan.get("description") or "Which is the cheapest lidar that "
                                                                      f"{does(study).replace(' ', f' {100 * study.asked:g} % of ', 1)}?",
        answer=answers(study), study=study, stands=stands(study), shown=shown, fields=[FIELDS[name] for name in study.swept],
        names=study.swept, told=TOLD, change=CHANGE, refused=refused,
        base=base, version=__version__, does=does(study), places=len(plan.points), name=plan.name, count=len(study.candidates),
        cells=lambda one: [FIELDS[name].text(one.values[name]) for name in study.swept],
        verdict=lambda one: _verdict(study, one, "–"),
        cost=lambda one: _cost(study, one.cost), added=lambda value: f"{value:+.3g}", words=FIELDS, filter_percent=lambda value: cell(value, "%"),
        filter_points=lambda value: "–" if math.isnan(value.value) else f"{100 * value.value:+.2f} ± {100 * value.error:.2f}",
        pictures=[{"source": embedded(out / "front.png"), "alt": f"Share of birds by cost of {len(study.candidates)} designs; {answers(study)[0]}",
                   "caption": "Share of birds by cost, with one standard error; blue: on the front; red: required share"},
                  {"source": embedded(out / "sensitivities.png"), "alt": "Change of the share by a change of each number.",
                   "caption": f"Effect of {100 * CHANGE:g} % more or less of one number (for elevations, of the band's width)"}]))


def _bounds(name: str, given: Any) -> str:
    field = FIELDS[name]
    if isinstance(given, list):
        return ", ".join(field.text(value) for value in given)
    return (f"{field.text(given['from'])} to {field.text(given['to'])}" + (f" in {given['levels']} levels" if given.get("levels") else "")
            + (", evenly by the logarithm" if given.get("logarithmic") else ""))


class Designs(Study):
    """Designs of a plan within its bounds: `write` finds their shares and leaves tables, pictures and a page.

    >>> study = Designs("Examples/coverage/design.coverage.json", "build/design").write()   # doctest: +SKIP
    >>> study.chosen.values, study.chosen.cost, study.chosen.share                          # doctest: +SKIP
    """

    def write(self) -> Designs:
        """Computes the shares, then writes design.html, design.csv, sensitivities.csv and pictures to the folder. @return this study"""
        with only_run(self.folder, self.ranks, goes_on=True, known=self.plan.decides):
            self.look()
            if not self.ranks.rank:
                write(self)
        return self
