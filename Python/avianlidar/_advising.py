# SPDX-License-Identifier: BSD-3-Clause
"""Sentences on the settings of the echo filter that a scene requires, from what `_measurement` has measured."""
from collections.abc import Sequence
from typing import Any

import numpy as np

from ._advice import MET, SETTINGS, UNDECIDED, Advice
from ._echo_errors import FEW
from ._measurement import CELLS, DEFAULT, DIRECT, RAYS, UNCONNECTED, Measurement, Trial
from ._numbers import figures
from ._pipeline import Progress
from ._properties import snake


def per_cent(share: float) -> str:
    return f"{figures(100 * share if share > 1e-11 else 0, 2 if share < 0.995 else 3)} %"


def errors_in_words(errors: np.ndarray) -> str:
    """Errors in words. @param errors by kind: a value, or value, least and most"""
    words = []
    for kind, name in enumerate(("energy {} rms", "range {} rms", "echoes missed or invented {}")):
        value, most = (f"{figures(one, 3)} m" if kind == 1 else per_cent(one)
                       for one in np.atleast_1d(errors[kind])[[0, -1]])
        bound = f"at most {most}"
        if errors.ndim > 1 and np.isinf(errors[kind, 2]):
            bound = "undecided: fewer than 30 beams have an echo of twice the limit"
        words.append(name.format(f"{value} ({bound})" if errors.ndim > 1 else value))
    return ", ".join(words)


def cost(trial: Trial, other: Trial) -> str:
    """The time of a trial compared with the time of another trial, in words."""
    if trial.is_as_fast_as(other):
        return "about the same time"
    share = round(100 * (trial.seconds / other.seconds - 1))
    return f"{figures(abs(share), 3)} % {'less' if share < 0 else 'more'} time"


def lines_of(m: Measurement, advised: Trial | None) -> list[str]:
    """Sentences on what is advised and why."""
    number = m.beams.GetNumberOfPoints()
    sure = sum(len(truth.sure) for _, truth in m.batches)
    lines = [f"Limits: {errors_in_words(m.asked)}. Measured on {len(m.sample)} of {number} beams with {sure} echoes"
             + (f", with {m.seeds} seeds" if m.seeds > 1 else "")]
    if not sure:
        return [*lines, "Advised: no setting, because none of these beams has an echo"]
    of = {trial.setting: trial for trial in m.trials[1:]}
    seconds = number * (advised or of[DEFAULT]).seconds
    if advised:
        gain = figures(m.trials[0].seconds / advised.seconds, 3)
        times = "" if advised.is_as_fast_as(m.trials[0]) else f"{gain} times "
        lines.append(f"Advised: {advised.setting.words()}: {errors_in_words(advised.errors)}; "
                     f"{figures(1e6 * advised.seconds, 3)} us a beam of one core, {figures(seconds, 3)} s the scan, "
                     f"{times}as fast as the present settings")
    else:
        best = min(m.trials, key=lambda trial: trial.parts(m.asked))
        lines.append(f"Advised: none of {len(m.trials)} settings surely keeps the limits. The best setting, "
                     f"{best.setting.words()}, has {errors_in_words(best.errors)}")
        unclear = sum(trial.verdict == UNDECIDED for trial in m.trials)
        if unclear:
            more = f"measure more beams than {len(m.sample)}"
            if m.has_all_echoes() and m.asked[2] < FEW / sure:
                more = (f"the sample has all {sure} echoes of the scan, which cannot show that less than "
                        f"{per_cent(FEW / sure)} of the echoes are wrong: allow `missed` to be larger")
            elif m.has_all_echoes():
                more = (f"the sample has all {sure} echoes of the scan, so that more seeds would help, and more beams "
                        "would not: advise again with another seed")
            lines[-1] += f"; {unclear} settings are undecided: {more}, or allow larger errors"
        if m.beaten:
            lines[-1] += ("; settings that keep the limits are slower than the default and have larger errors on these "
                          "beams, so that chance decides: measure more beams, or allow larger errors")

    second = cost(of[DEFAULT], of[DIRECT])
    one, unconnected = m.without
    if not m.reflects_twice:
        lines.append(f"One reflection is enough: second reflections return {'less than 1e-6' if m.secondary else '0'} "
                     f"of the light (measured over {len(m.sample)} beams). Two reflections take {second}")
    else:
        enough = advised and advised.setting.reflections == 1
        start = "One reflection is enough for the limits: second reflections" if enough else "Second reflections"
        lines.append(f"{start} return {per_cent(m.secondary)} of the light, up to {per_cent(m.largest)} of an echo; "
                     f"without second reflections the error of energy is {per_cent(one[0, 0])} rms, and "
                     f"{per_cent(one[2, 0])} of the echoes are wrong. Second reflections take {second}")
    lines.append(f"Connections return {per_cent(m.connected)} of the light. Without connections the error of energy is "
                 f"{per_cent(unconnected[0, 0])} rms. Two connections take {cost(of[DEFAULT], of[UNCONNECTED])}")

    needs = []
    for samples, name in ((CELLS, "cells"), (RAYS, "plain rays")):
        met = [trial for trial in m.trials if trial.setting.samples == samples and trial.verdict == MET]
        fewest = min(met, key=lambda trial: (trial.setting.rays, trial.seconds), default=None)
        needs.append(f"{name} need {fewest.setting.rays} ({figures(1e6 * fewest.seconds, 3)} us a beam)" if fewest else
                     f"no tried number of {name} is enough")
    nothing, polygons, cells = m.views[1], m.views[2], m.views[3] + m.views[5]
    lines.append(f"Density of rays: {per_cent(polygons)} of the beams are integrated over polygons, {per_cent(cells)} "
                 f"need cells, {per_cent(nothing)} meet nothing. To keep the limits, {', '.join(needs)}")

    weather = "none"
    if m.scatters or m.fields["attenuation_coefficient"] > 0:
        light, echoes = map(per_cent, m.lost)
        back = "the air sends no light back and costs no time"
        if m.scatters:
            back = f"{per_cent(m.of_air)} of the points are echoes of the air; the air takes {cost(m.hazy, m.clear)}"
        weather = f"the air takes {light} of the light and {echoes} of the echoes; {back}"
    two, eight = (f"{(m.tree_seconds + seconds) / (m.tree_seconds + seconds / n):.2g}" for n in (2, 8))
    return [*lines, f"Weather: {weather}",
            f"Processes: the collision tree ({figures(m.tree_seconds, 2)} s of one core) is built by every process, "
            f"and the scan ({figures(seconds, 2)} s) is divided. The speed-up is at most {two} with 2 processes and "
            f"{eight} with 8. Later scans keep the tree",
            f"The reference's own error: {errors_in_words(m.own())}"]


def measure(like: Any, inputs: Sequence[Any], asked: dict[str, float], beams: int,
            progress: Progress | None = None) -> Advice:
    """Measures which settings a scene requires.
    @param like an echo filter with the properties of the scan @param inputs beams, surfaces, and movers or None
    @param asked largest allowed errors by kind @param beams number of beams that are measured"""
    for kind, value in asked.items():
        if not 0 < value <= 1e30:
            raise ValueError(f"{kind} is {value!r}, expected an allowed error above 0")
    if not 50 <= beams <= 1000000:
        raise ValueError(f"beams is {beams!r}, expected 50 to 1000000 beams that are measured")
    m = Measurement(like, inputs, asked, beams, progress)
    m.look()
    m.done = 0.1
    first = m.refer(m.grow(beams))
    advised = None
    if len(m.sample):
        m.done = 0.4
        m.look_at_scene(first)
        m.try_all()
        advised = m.advise()
    settings, row = (advised.setting.properties(), m.trials.index(advised)) if advised else (None, -1)
    lines = lines_of(m, advised) + (advised.setting.as_commands() if advised else [])

    numbers = np.array([(*trial.setting, len(trial.times), trial.verdict) for trial in m.trials], np.int32)
    table = dict(zip((*map(snake, SETTINGS), "turns", "verdict"), numbers.T.copy()))
    table["seconds_per_beam"] = np.array([trial.seconds for trial in m.trials])
    errors = np.array([trial.errors for trial in m.trials])
    for i, name in enumerate(("energy_error", "range_error", "missed_share")):
        table[name], table[name + "_most"] = errors[:, i, 0].copy(), errors[:, i, 2].copy()
    return Advice(settings, tuple(lines), dict(asked), row, table)
