#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How much time buys how much accuracy on a scene? Scans it with many settings of the echo filter and several seeds,
compares each with a converged reference, and leaves results.csv, table.md, a plot for each kind of error, and
advice.md: which setting to use for 1 %, 5 %, 10 % error of energy, for detection, for range.

    /usr/bin/python3 Examples/accuracy_speed/accuracy_speed.py airport --sensor airport32
    /usr/bin/python3 Examples/accuracy_speed/accuracy_speed.py my.lidarscene.json --sensor corridor --quick

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`). No display is needed.
"""
import csv
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common"), str(HERE)]
import running  # noqa: E402
import tables  # noqa: E402
import trade_grid  # noqa: E402
import trade_results  # noqa: E402
import trade_runs  # noqa: E402

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


def scene(text):
    return text if text in ("airport", "corridor", "field") else str(running.file(text))


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scene", type=scene, help="airport (Shanghai Hongqiao), corridor, field (of small objects), or a .lidarscene.json file")
    parser.add_argument("--sensor", choices=list(trade_runs.SENSORS), help="default: corridor there, else airport16")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/accuracy_speed"), help="of the results")
    parser.add_argument("--quick", action="store_true", help="fewer beams, settings and seeds: under a minute")
    parser.add_argument("--seeds", type=running.whole(2, 100), help="scans with each setting, default 5 (quick: 3)")
    parser.add_argument("--threads", type=running.whole(0, 4096), default=0, help="of the wall times; 0: all cores")
    parser.add_argument("--reference-rays", type=running.whole(1000, 1000000), help="default 30000 (quick: 10000)")
    options = parser.parse_args(argv)
    options.seeds = options.seeds or (3 if options.quick else 5)
    options.reference_rays = options.reference_rays or (10000 if options.quick else 30000)
    return options


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
    """Markdown: what lies on a front, and the presets."""
    fronts = {kind: {id(r) for r in trade_results.front(results, kind)} for kind in trade_results.KINDS}
    lines = ["| setting | s of one core | rays per beam | energy rms | median | beam total rms | range rms (mm) | "
             "missed | false | on the front of |", "|---|---:|---:|---:|---:|---:|---:|---:|---:|---|"]
    for r in sorted(results, key=lambda r: r.median("cpu")):
        on = [kind for kind, members in fronts.items() if id(r) in members]
        if not on and "Preset" not in r.choice.settings:
            continue
        bound = {kind: "" if r.resolved(kind) else "≤ " for kind in ("energy", "total", "range")}
        lines.append(f"| {r.choice.words} | {r.median('cpu'):.3g} | {r.mean('rays'):.0f} | "
                     f"{bound['energy']}{100 * r.error('energy'):.2g} % | {100 * r.mean('energy_median'):.2g} % | "
                     f"{bound['total']}{100 * r.error('total'):.2g} % | "
                     f"{bound['range']}{1000 * r.error('range'):.3g} | {r.mean('missed'):.1f} | "
                     f"{r.mean('false'):.1f} | {', '.join(on)} |")
    return "\n".join(lines)


def rates(results):
    """Markdown: how fast errors fall with the number of rays."""
    families = ("Monte Carlo", "stratified")
    lines = ["| error ~ rays^p | " + " | ".join(families) + " |", "|---|---:|---:|"]
    for kind, words in (("energy", "energy"), ("total", "total of a beam"), ("range", "range")):
        cells = []
        for family in families:
            slope, spread = trade_results.rate(results, family, kind)
            cells.append(f"{slope:.2f} ± {spread:.2f}")
        lines.append(f"| {words} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def head(subject, reference, options):
    own = reference.own
    return (f"{subject.title}: {subject.number_of_beams} beams, {len(reference.echoes['beam_id'])} true echoes, "
            f"{int(reference.strong.sum())} of them of at least twice the lower limit. Reference: two scans of "
            f"{reference.rays} rays per beam; its own error is {100 * own['energy']:.2g} % of energy, "
            f"{100 * own['total']:.2g} % of a beam's total (rms), {1000 * own['range']:.2g} mm of range (rms); "
            f"too near to the limit to be judged: {len(reference.undecided['beam_id'])}. "
            f"{options.seeds} seeds.")


def main(argv=None):
    options = arguments(argv)
    clock = tables.Clock()
    with clock("scene and reference"):
        subject = trade_runs.Subject(options.scene, options.sensor, 4 if options.quick else 1)
        reference = trade_runs.Reference(subject, options.reference_rays)
    with clock("scans"):
        results = measure(subject, reference, trade_grid.choices(options.quick), options)

        def check(choice):
            found = trade_runs.scan(subject, choice.settings, 2000003)
            return trade_results.summary(trade_runs.judge(reference, found), found, found.wall)

        advice = [trade_results.advise(results, *wish, check) for wish in trade_results.wishes(subject)]
    options.out.mkdir(parents=True, exist_ok=True)
    with clock("tables and plots"):
        import trade_plots  # only here: matplotlib takes a second to load
        for kind in trade_results.KINDS:
            trade_plots.draw(results, subject, reference, kind, options.out / f"{kind}.png")
        write_csv(results, subject, options.out / "results.csv")
        recommended = trade_results.advice_table(advice, results)
        (options.out / "table.md").write_text(table(results) + "\n", encoding="utf-8")
        (options.out / "rates.md").write_text(rates(results) + "\n", encoding="utf-8")
        (options.out / "head.md").write_text(head(subject, reference, options) + "\n", encoding="utf-8")
        (options.out / "advice.md").write_text(recommended + "\n", encoding="utf-8")
    print(head(subject, reference, options), rates(results), table(results), recommended, sep="\n\n")
    return subject, reference, results, advice


if __name__ == "__main__":
    main()
