# SPDX-License-Identifier: BSD-3-Clause
"""How much time buys how much accuracy on a scene? Scans it with many settings of the echo filter and several seeds,
compares each with a converged reference, and leaves results.csv, table.md, a plot for each kind of error, and
advice.md: which setting to use for 1 %, 5 %, 10 % error of energy, for detection, for range.

    Testing/Studies/run.py accuracy_speed airport --sensor airport32
    Testing/Studies/run.py accuracy_speed my.lidarscene.json --sensor corridor --quick
"""
import csv
import math
import sys

import tools
import trade_grid
import trade_results
import trade_runs
from running import argument, study, whole

# Column of the CSV file with its unit, and where its number comes from. Echoes of at least twice the limit that are
# missed count in the errors of energy, as -1; in that of range they do not.
COLUMNS = {
    "seeds [1]": lambda r: len(r.scans),
    "time of one core [s]": lambda r: r.median("cpu"),
    "wall time of all threads [s]": lambda r: r.scans[0]["wall"],
    "rays traced per beam [1]": lambda r: r.mean("rays"),
    "energy rms error with missed as -1 [1]": lambda r: r.error("energy"),
    "energy rms error of the worst seed with missed as -1 [1]": lambda r: r.worst("energy"),
    "energy error told by the reference [1]": lambda r: r.resolved("energy"),
    "energy median error with missed as -1 [1]": lambda r: r.mean("energy_median"),
    "energy mean error with missed as -1 [1]": lambda r: r.mean("bias"),
    "beam total rms error [1]": lambda r: r.error("total"),
    "range rms error [m]": lambda r: r.error("range"),
    "range 95th percentile [m]": lambda r: r.mean("range_95"),
    "true echoes [1]": lambda r: r.scans[0]["true"],
    "missed [1]": lambda r: r.mean("missed"),
    "missed of at least twice the limit [1]": lambda r: r.mean("missed_strong"),
    "false [1]": lambda r: r.mean("false"),
    "missed and false of the true [1]": lambda r: r.error("detection"),
}


def measure(subject, reference, choices, options):
    """Every setting with every seed. Settings take turns, so that what disturbs the machine disturbs all alike."""
    scans = {choice: [] for choice in choices}
    for seed in range(options.seeds):
        print(f"{subject.title}: seed {seed + 1} of {options.seeds}", file=sys.stderr, flush=True)
        for choice in choices:
            alone = trade_runs.scan(subject, choice.settings, seed)
            wall = math.nan  # of all threads, once
            if seed == 0:
                wall = trade_runs.scan(subject, choice.settings, seed, options.threads).wall
            scans[choice].append(trade_results.summary(trade_runs.judge(reference, alone), alone, wall))
    return [trade_results.Result(choice, found, reference.own) for choice, found in scans.items()]


def write_csv(results, subject, file):
    """A row for each setting: the settings as the filter used them, errors, costs, and on which fronts it lies."""
    fronts = {kind: {id(r) for r in trade_results.front(results, kind)} for kind in trade_results.KINDS}
    used = list(results[0].scans[0]["used"])
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["scene", "sensor", "setting", *(f"{name} [1]" for name in used), *COLUMNS,
                         *(f"on the front of {kind} [1]" for kind in fronts)])
        for result in results:
            settings = result.scans[0]["used"]
            writer.writerow([subject.name, subject.sensor_name, result.choice.family, *(settings[n] for n in used),
                             *(f"{number(result):.6g}" for number in COLUMNS.values()),
                             *(int(id(result) in front) for front in fronts.values())])


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
       argument("--threads", type=whole(0, 4096), default=0, help="of the wall times; 0: all cores"),
       argument("--reference-rays", type=whole(1000, 1000000), help="default 30000 (quick: 10000)"))
def main(options):
    options.seeds = options.seeds or (3 if options.quick else 5)
    options.reference_rays = options.reference_rays or (10000 if options.quick else 30000)
    subject = trade_runs.Subject(options.scene, options.sensor, 4 if options.quick else 1)
    reference = trade_runs.Reference(subject, options.reference_rays)
    results = measure(subject, reference, trade_grid.choices(options.quick), options)

    def check(choice):
        found = trade_runs.scan(subject, choice.settings, 2000003)
        return trade_results.summary(trade_runs.judge(reference, found), found, found.wall)

    advice = [trade_results.advise(results, *wish, check) for wish in trade_results.wishes(subject)]
    options.out.mkdir(parents=True, exist_ok=True)
    for kind in trade_results.KINDS:
        trade_results.draw(results, subject, reference, kind, options.out / f"{kind}.png")
    write_csv(results, subject, options.out / "results.csv")
    (options.out / "head.md").write_text(head(subject, reference, options) + "\n", encoding="utf-8")
    print(head(subject, reference, options))
    tools.leave(options.out, "rates", *rates(results))
    tools.leave(options.out, "table", *table(results))
    tools.leave(options.out, "advice", *trade_results.advice_table(advice, results), 2)
    return subject, reference, results, advice
