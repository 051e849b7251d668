# SPDX-License-Identifier: BSD-3-Clause
"""How much time buys how much accuracy on a scene? Scans it with many settings of the echo filter and several seeds,
compares each with a converged reference, and leaves tables and a plot of errors of energy: settings that no other
beats, rates of convergence, and the setting to use for 1 %, 5 %, 10 % error of energy, for detection, for range.

    Testing/Studies/run.py accuracy_speed airport --sensor airport32
    Testing/Studies/run.py accuracy_speed my.lidarscene.json --sensor corridor --quick
"""
import sys

import tools
import trade_grid
import trade_results
import trade_runs
from running import argument, study, whole


def judged(subject, reference, choice, seed):
    """The numbers of one seed."""
    found = trade_runs.scan(subject, choice.settings, seed)
    return trade_results.summary(trade_runs.judge(reference, found), found)


def measure(subject, reference, choices, options):
    """Every setting with every seed. Settings take turns, so that what disturbs the machine disturbs all alike."""
    scans = {choice: [] for choice in choices}
    for seed in range(options.seeds):
        print(f"{subject.title}: seed {seed + 1} of {options.seeds}", file=sys.stderr, flush=True)
        for choice in choices:
            scans[choice].append(judged(subject, reference, choice, seed))
    return [trade_results.Result(choice, found, reference.own) for choice, found in scans.items()]


def table(results):
    """Head and rows: what lies on a front, and the presets."""
    fronts = {kind: {id(r) for r in trade_results.front(results, kind)} for kind in trade_results.KINDS}
    rows = []
    for r in sorted(results, key=lambda r: r.median("cpu")):
        on = [kind for kind, members in fronts.items() if id(r) in members]
        if on or "Preset" in r.choice.settings:
            bound = {kind: "" if r.resolved(kind) else "≤ " for kind in ("energy", "total", "range")}
            rows.append((
                r.choice.words, f"{r.median('cpu'):.3g}", f"{r.mean('rays'):.0f}",
                f"{bound['energy']}{100 * r.error('energy'):.2g} %", f"{100 * r.mean('energy_median'):.2g} %",
                f"{bound['total']}{100 * r.error('total'):.2g} %", f"{bound['range']}{1000 * r.error('range'):.3g}",
                f"{r.mean('missed'):.1f}", f"{r.mean('false'):.1f}", ", ".join(on)))
    return ("setting", "s of one core", "rays per beam", "energy rms", "median", "beam total rms", "range rms (mm)",
            "missed", "false", "on the front of"), rows


def rates(results):
    """Head and rows: how fast errors fall with the number of rays."""
    families = ("Monte Carlo", "stratified")
    return ("error ~ rays^p", *families), [
        (words, *("{:.2f} ± {:.2f}".format(*trade_results.rate(results, family, kind)) for family in families))
        for kind, words in (("energy", "energy"), ("total", "total of a beam"), ("range", "range"))]


def head(subject, reference, options):
    own = reference.own
    return (f"{subject.title}: {subject.number_of_beams} beams, {len(reference.echoes['beam_id'])} true echoes, "
            f"{int(reference.strong.sum())} of them of at least twice the lower limit. Reference: two scans of "
            f"{reference.rays} rays per beam; its own error is {100 * own['energy']:.2g} % of energy, "
            f"{100 * own['total']:.2g} % of a beam's total (rms), {1000 * own['range']:.2g} mm of range (rms); "
            f"too near to the limit to be judged: {len(reference.undecided['beam_id'])}. "
            f"{options.seeds} seeds.")


@study(argument("scene", type=trade_runs.scene_name,
                help="airport (Shanghai Hongqiao), corridor, field (of small objects), or a .lidarscene.json file"),
       argument("--sensor", choices=list(trade_runs.SENSORS), help="default: corridor there, else airport16"),
       argument("--quick", action="store_true", help="fewer beams, settings and seeds: under a minute"),
       argument("--seeds", type=whole(2, 100), help="scans with each setting, default 5 (quick: 3)"),
       argument("--reference-rays", type=whole(1000, 1000000), help="default 30000 (quick: 10000)"))
def main(options):
    options.seeds = options.seeds or (3 if options.quick else 5)
    options.reference_rays = options.reference_rays or (10000 if options.quick else 30000)
    subject = trade_runs.subject_of(options.scene, options.sensor, 4 if options.quick else 1)
    reference = trade_runs.Reference(subject, options.reference_rays)
    results = measure(subject, reference, trade_grid.choices(options.quick), options)

    advice = [trade_results.advise(results, *wish, lambda choice: judged(subject, reference, choice, 2000003))
              for wish in trade_results.wishes(subject)]
    trade_results.draw(results, subject, reference, options.out / "energy.png")
    print(head(subject, reference, options))
    tools.leave(options.out, "rates", *rates(results))
    tools.leave(options.out, "table", *table(results))
    tools.leave(options.out, "advice", *trade_results.advice_table(advice, results), 2)
    return subject, reference, results, advice
