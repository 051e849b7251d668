# SPDX-License-Identifier: BSD-3-Clause
"""The files that `avianlidar design` writes: design.csv, sensitivities.csv, pictures and a page of HTML."""
from __future__ import annotations

import math
import pathlib
from typing import Any, Dict, List

import numpy as np

from ..._disk import only_run, write_whole
from ..._version import __version__
from ..inputs._on_sale import CHOSEN
from ..inputs._tables import write_table
from ..pages import _drawing as drawing
from ..pages._html import First, Number, render, short_enough
from ..pages._words import plural
from ..sequences._card import cell, number
from ..sequences._scores import Value
from ._design import CHANGE, FIELDS, TOLD, Candidate, Field, Study, is_told
from ._report import place

TOLD_WORDS = {True: "yes", False: "no", None: "undecided"}
SHOWN = 10  # greatest number of designs in a table of the page
PULSE_COLUMNS = {"exit_aperture [m2]": "exit_aperture", "radiant_exposure [J/m2]": "exposure",
                 "through_7_mm_pupil [J]": "pupil", "pulse_rate [Hz]": "pulse_rate",
                 "shortest_interval [s]": "shortest_interval", "average_power [W]": "average_power"}


def _cost(study: Study, cost: float) -> str:
    return f"{cost:.4g} {study.unit}".rstrip()


def does(study: Study, share: str = "") -> str:
    """The meaning of the share, in words. @param share words before the birds, as in "30 % of " """
    birds = f"{share}{plural(study.plan.bird)}" if len(study.plan.mix) == 1 else f"{share}birds"
    if study.measure == "tracked":
        return f"tracks {birds} of the scenario at least once"
    scans = f"{study.plan.coverage.required_detections} or more of the scans in {study.within:g} s"
    return f"detects {birds} {study.plan.where}, by {scans if study.within else 'one scan'}"


def stands(study: Study) -> str:
    """The place of the lidar, in words."""
    x, y, _ = study.plan.sensor.position
    at = place((x, y, 0.0)).rsplit(",", 1)[0]
    return f"{at} of the scene's origin" if x or y else "at the scene's origin"


def answers(study: Study) -> List[str]:
    """The answers to the question of the plan, in sentences."""
    count, about, other, pulses = len(study.judged), study.about, study.elsewhere, study.about.pulses
    share, question = cell(study.of(about), "%"), does(study, f"{100.0 * study.asked:g} % of ")
    cost = f"costs {_cost(study, about.cost)} by the plan's formula"
    first = (f"The cheapest of {count} designs that {question} {cost} and has {share}" if study.chosen else
             f"None of {count} designs surely {question}: the best design has {share} and {cost}")
    varied = ", ".join(f"{FIELDS[name].words} {FIELDS[name].text(about.values[name])}" for name in study.swept)
    energy = f"{FIELDS['pulse_energy'].text(about.values['pulse_energy'])} a pulse, "
    microjoules = float(f"{1e6 * pulses['pupil']:.2g}")
    ideas = " The designs are ideas: nobody sells these lidars." if study.plan.idea or any(
        name not in (*CHOSEN, "mast") for name in study.swept) else ""
    found = [f"{first}; eye safety is not assessed: at {study.plan.sensor.wavelength:g} nm each pulse puts "
             f"{microjoules:g} µJ through a pupil of 7 mm at the exit aperture, "
             f"if the pulse fills the aperture evenly (assumed).{ideas}",
             f"The design is number {about.number}: {varied}; {'' if 'pulse_energy' in study.swept else energy}"
             f"{pulses['exposure']:.4g} J/m² a pulse at the exit aperture of {1e4 * pulses['exit_aperture']:.4g} cm², "
             f"{pulses['pulse_rate']:,.0f} pulses a second."]
    found.append(f"At {other.number:,} other places, which were not used to choose designs, "
                 f"the design detects {cell(other, '%')}")
    if study.measure == "detected" and study.chosen:
        words = {True: "at least the required share", False: "less than the required share",
                 None: "the error does not decide"}
        found[-1] += f": {words[is_told(other.value, other.error, study.asked)]}"
    found[-1] += "."
    unsure = study.undecided()
    if unsure:
        least = _cost(study, min(one.cost for one in unsure))
        designs = f"{len(unsure)} {'cheaper ' if study.chosen else ''}{'design' if len(unsure) == 1 else 'designs'}"
        more = "scans" if study.measure == "tracked" else "places"
        found.append(f"For {designs}, from {least} on, the error does not decide, because their shares lie within "
                     f"{TOLD:g} standard errors of {100.0 * study.asked:g} %. More {more} would decide.")
    return found


def table(study: Study) -> List[Dict[str, Any]]:
    """Rows of design.csv, in SI units."""
    sensor, rows = study.plan.sensor, []
    for one in study.candidates:
        tracked = {"tracked [1]": one.tracked.value, "tracked_std_error [1]": one.tracked.error,
                   "tracked_of [1]": one.tracked.number}
        rows.append({
            "design": one.number, **{f"{name} [{FIELDS[name].unit}]": one.values[name] for name in FIELDS},
            "detected [1]": one.share.value, "detected_std_error [1]": one.share.error,
            **(tracked if study.measure == "tracked" else {}), f"cost [{study.unit or '1'}]": one.cost,
            "wavelength [nm]": float(sensor.wavelength), "pulse_width [s]": float(sensor.pulse_width),
            **{column: one.pulses.get(name, math.nan) for column, name in PULSE_COLUMNS.items()},
            "on_the_front": int(one.front), "has_the_asked_share": _verdict(study, one, ""),
            "chosen": int(one is study.chosen), "refused": one.refused})
    return rows


def _verdict(study: Study, one: Candidate, unknown: str) -> str:
    """Whether a design has the required share, in words. @param unknown words for designs without a share"""
    return unknown if math.isnan(study.of(one).value) else TOLD_WORDS[study.has_it(one)]


def _draw_front(axes, study: Study) -> None:
    def bars(of: List[Candidate], shares: List[Value], **style: Any) -> None:
        values = [100 * share.value for share in shares]
        errors = [100 * share.error for share in shares]
        axes.errorbar([one.cost for one in of], values, errors, **style)
    front, about = study.front, study.about
    others = [one for one in study.candidates if not (one.refused or one.front)]
    for of, colour, mark, label in ((others, "0.75", "o", "designs"), (front, "C0", "s", "on the front")):
        bars(of, [one.share for one in of], fmt=mark, markersize=4, color=colour, label=label,
             markeredgecolor="black" if of is front else colour)
    axes.step([one.cost for one in front], [100 * one.share.value for one in front], where="post", color="C0",
              linewidth=1)
    if study.finalists:
        bars(study.finalists, [one.tracked for one in study.finalists], fmt="^-", color="C1", label="tracked")
    axes.axhline(100 * study.asked, color="red", linewidth=0.8, label=f"required: {100 * study.asked:g} %")
    axes.plot(about.cost, 100 * study.of(about).value, "*", color="red", markersize=14, zorder=5,
              label="cheapest with this share" if study.chosen else "the best")
    drawing.finish(axes, ylim=(0.0, None), xlabel=f"cost{', ' + study.unit if study.unit else ''}",
                    ylabel="share of birds, %")


def _draw_sensitivities(axes, study: Study) -> None:
    rows = [row for row in study.sensitivities if not row["refused"]]
    most = {name: max((abs(row["share"].value) for row in rows if row["field"] == name), default=0.0)
            for name in study.swept}
    order = sorted(study.swept, key=lambda name: most[name])
    for row in rows:
        up, share = row["to"] > row["from"], row["share"]
        axes.barh(order.index(row["field"]) + (0.19 if up else -0.19), 100 * share.value, 0.36,
                  xerr=100 * share.error, color="C0" if up else "C1", hatch="" if up else "///")
    for colour, label in (("C0", "more"), ("C1", "less")):
        axes.barh([0], [0], color=colour, hatch="" if label == "more" else "///", label=label)
    axes.set_yticks(np.arange(len(order)), [FIELDS[name].words for name in order])
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set_xlabel("change of the share detected, percentage points")
    axes.grid(axis="x")
    axes.legend()


def write(study: Study) -> None:
    """design.csv, sensitivities.csv, front.png, sensitivities.png, design.html, in the study's folder."""
    out, plan, bounds = pathlib.Path(study.folder), study.plan, study.options["bounds"]
    write_table(out / "design.csv", table(study))
    write_table(out / "sensitivities.csv", [
        {"field": row["field"], "unit": row["unit"], "from": row["from"], "to": row["to"],
         "change_of_detected [1]": row["share"].value, "change_std_error [1]": row["share"].error,
         f"change_of_cost [{study.unit or '1'}]": row["cost"], "refused": row["refused"]}
        for row in study.sensitivities])
    front = drawing.picture(
        out / "front.png", (drawing.WIDTH, 4.2), f"Share of birds by cost of {len(study.candidates)} designs",
        "Share of birds detected by cost, with one standard error.", lambda axes: _draw_front(axes, study))
    changes = drawing.picture(
        out / "sensitivities.png", (drawing.WIDTH, 0.8 + 0.3 * len(study.swept)), "Change of the share by each number",
        f"Effect of {100 * CHANGE:g} % more or less of one number of design {study.about.number}; elevations change by "
        "this share of the band's width.", lambda axes: _draw_sensitivities(axes, study))
    about, shown = study.about, {one.number: one for one in [*study.front, study.about]}.values()
    nearest = sorted(shown, key=lambda one: abs(one.cost - about.cost))[:SHOWN]
    nearest.sort(key=lambda one: one.cost)
    designs = [[one.number, *(FIELDS[name].text(one.values[name]) for name in study.swept), _cost(study, one.cost),
                cell(one.share, "%"), *([cell(one.tracked, "%")] if study.measure == "tracked" else []),
                _verdict(study, one, "–")] for one in nearest]
    base = [[field.words, field.text(study.base[name]),
             f"{_bounds(field, bounds[name])} (assumed)" if name in bounds else "the same in all designs"]
            for name, field in FIELDS.items()]
    write_whole(out / "design.html", render(
        "coverage/design.html.jinja", first=_first(study, front), answer=answers(study), study=study, designs=designs,
        stands=stands(study), told=TOLD, changes=changes, base=base, version=__version__, nearest=nearest,
        heads=[FIELDS[name].words for name in study.swept], places=len(plan.points), name=plan.name,
        refused=[one for one in study.candidates if one.refused],
        impossible=[f"{FIELDS[row['field']].text(row['to'])}: {row['refused']}" for row in study.sensitivities
                    if row["refused"]][:2]))


def _first(study: Study, picture: Dict[str, Any]) -> First:
    plan, about, other, share = study.plan, study.about, study.elsewhere, f"{100.0 * study.asked:g} % of "
    cost, count, of = _cost(study, about.cost), len(study.judged), study.of(about)
    verb = "tracks" if study.measure == "tracked" else "detects"
    has = f"{100.0 * of.value:.3g} %"
    sentences = [f"The cheapest of {count} designs that {verb} {share}{birds} costs {cost}."
                 if study.chosen else f"None of {count} designs surely {verb} {share}{birds}: the best {verb} {has}."
                 for birds in (plural(plan.bird), "the birds")]
    microjoules = float(f"{1e6 * about.pulses['pupil']:.2g}")
    steps = [{"head": "Assess eye safety.", "command": "",
              "words": "The columns of pulses in design.csv begin such an assessment, without a verdict."}]
    if plan.idea or any(name not in (*CHOSEN, "mast") for name in study.swept):
        steps.insert(0, {"head": "Ask makers whether they can build this lidar.", "command": "",
                         "words": "The designs are ideas: nobody sells these lidars."})
    if study.undecided():
        steps.append({"head": "Decide on cheaper designs.", "command": "", "words": answers(study)[-1]})
    more = f"avianlidar design {pathlib.Path(plan.file).name} -o more --design-set designs={4 * count}"
    steps.append({"head": "Search between the designs that were tried.", "command": more,
                  "words": "Narrow the bounds, or raise designs:"})
    return First(
        plan.plan.get("description") or f"Which is the cheapest lidar that {does(study, share)}?",
        short_enough(*sentences), picture, [
            Number(cost or "–", "cost", "by the plan's formula, which has no error of its own and is assumed"),
            number(("%", other), "detected by the design",
                   f"at {other.number:,} other places, which were not used to choose"),
            Number(f"{microjoules:g}\u00a0µJ", "a pulse through a pupil",
                   "of 7 mm at the exit aperture, if the pulse fills the aperture evenly; eye safety is not assessed")],
        steps, [f"Nothing was measured, and the shares are not a claim about real birds. Costs follow from the user's "
                f"formula, {study.cost.text}. Assumed are this formula, the bounds, size, reflectance and heights of "
                f"birds, and of the sensor: {', '.join(plan.assumed) or 'no number'}."
                + (f" Scans within {study.within:g} s count as independent, and the bird keeps its place."
                   if study.within else " One scan counts, whatever its duration.")])


def _bounds(field: Field, given: Any) -> str:
    """The values of a bound, or its ends, in words."""
    if isinstance(given, list):
        return ", ".join(field.text(value) for value in given)
    levels = f" in {given['levels']} levels" if given.get("levels") else ""
    return (f"{field.text(given['from'])} to {field.text(given['to'])}{levels}"
            f"{', evenly by the logarithm' if given.get('logarithmic') else ''}")


class Designs(Study):
    """Designs of a plan within its bounds: `write` finds their shares and leaves tables, pictures and a page.

    >>> study = Designs("Examples/coverage/design.coverage.json", "build/design").write()   # doctest: +SKIP
    >>> study.chosen.values, study.chosen.cost, study.chosen.share                          # doctest: +SKIP
    """

    def write(self) -> Designs:
        """Computes the shares, then writes the page, the tables and the pictures. @return this study"""
        with only_run(self.folder, self.ranks, goes_on=True, known=self.plan.decides):
            self.look()
            if not self.ranks.rank:
                write(self)
        return self
