#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Documentation/results/standard-errors.md from the CSV files of avianlidarAccuracy.

    make_page.py FOLDER"""
import csv
import math
import pathlib
import sys

PAGE = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "results" / "standard-errors.md"
FEWEST_WINDOWS = 10  # of a decile that is judged, as in SuiteStandardErrors.cxx

HEAD = """# Standard errors and target errors, measured

How far `energy_std_error` and `TargetRelativeError` can be trusted, and what a target error costs. Made by
`Testing/Accuracy/run.sh`; a test (`Accuracy-StandardErrors`, shipped scenes, fixed seeds) holds the values named as
wanted.

## Coverage of standard errors

* *Held*: share of estimates whose ±1.96 standard errors hold the truth (wanted: 93 %).
* *Least decile*: the smallest such share in any decile of the share of the beam's energy whose pulse reaches into the
  window (wanted: 88 %; deciles of fewer than ten windows are not judged).
* *Width/rms*: mean of 1.96 standard errors over the rms error, both relative to the truth (wanted: at most 4). It is
  1.96 for errors that are all alike, and less where a few large ones make the rms.
* *Bias*: mean error, relative.

A window is the strongest range unit of a return in one seed's scan, with a true energy of at least 2 Qlow. The truth
comes from 20,000 stratified rays of another seed (100,000 for small targets); further seeds estimate the window's
energy with a standard error. A window in which a seed has no echo counts as not held. Every beam is sampled, as
integrated ones state a bound instead, and small objects have their own rays. The light-energy constraint has a
thousandth of Qlow, as it has a bound of its own. Of the 32 channels every second column is measured, of Ingolstadt
every fourth, with N = 1000 half of these.

"""

FEW = """
With fewer than 16 rays a window often has no echo. *Held of seen* is the share of the echoes that there are; their
errors are widened by Student's t (wanted: 90 %; below 8 rays there is no standard error):

"""

PARTS = """
Direct echoes, and those of which more than 1 % of the energy came over two reflections (100 rays; held, and width/rms
of the latter):

"""

TARGET = """
## What a target error reaches, and what it costs

`TargetRelativeError` with `RaysPerBeam` 100 (so 8 to 1,600 rays a beam), over all windows and two seeds. Errors are
relative to the truth; a missed echo has the error 100 %. Rays are primary rays of the beams that meet something, with
those of the pilot and of small targets. CPU time is that of the whole scan on one thread, two reflections. *Fewer rays
than*, *faster*: what a fixed number of rays per beam needs for the same rms error, over what was spent (log-log
interpolation and extrapolation of 16 to 1024 strata and 16 to 4096 Monte Carlo rays).

"""

FIXED = """
Fixed numbers of rays, for comparison (every second of those that were run):

"""


def read(folder, name):
    with open(pathlib.Path(folder) / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---|" + "---|" + "---:|" * (len(header) - 2)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def percent(text, digits=1):
    return f"{100 * float(text):.{digits}f} %"


SAMPLINGS = ("Stratified", "MonteCarlo")


def side_by_side(keys, values, rows):
    """A row for each key, of which `values` stand for both samplings: {name: text of a row}."""
    found = {}
    for row in rows:
        found.setdefault(tuple(cell(row) for cell in keys.values()), {})[row["sampling"]] = row
    names = [f"{sampling}: {name}" if name == next(iter(values)) else name for sampling in SAMPLINGS for name in values]
    return table([*keys, *names], [[*key, *(cell(both[s]) if s in both else "" for s in SAMPLINGS
                                            for cell in values.values())] for key, both in found.items()])


def number(name):
    return lambda r: f"{int(r[name]):,}"


def text(name):
    return lambda r: r[name]


def share(name, digits=1):
    return lambda r: percent(r[name], digits)


def ratio(r):
    return f"{float(r['ratio']):.2f}"


WINDOWS = {"scene": text("scene"), "N": text("rays"), "windows": number("windows"), "seeds": text("seeds")}


def few_table(rows):
    return side_by_side(WINDOWS,
                        {"seen": lambda r: percent(float(r["held"]) / float(r["held_seen"])),
                         "held of seen": share("held_seen"), "width/rms": ratio},
                        [r for r in rows if r["echoes"] == "all" and int(r["rays"]) < 16])


def errors_table(rows):
    def least(row):
        return percent(min(float(r["held"]) for r in rows
                           if all(r[k] == row[k] for k in ("scene", "sampling", "rays")) and
                           r["echoes"].startswith("decile") and int(r["windows"]) >= FEWEST_WINDOWS))

    return side_by_side(WINDOWS,
                        {"held": share("held"), "least decile": least, "rms error": share("rms"), "width/rms": ratio,
                         "bias": share("bias", 2)},
                        [r for r in rows if r["echoes"] == "all" and int(r["rays"]) >= 16])


def parts_table(rows):
    found = {(r["scene"], r["sampling"], r["echoes"]): r for r in rows if r["rays"] == "100"}
    both = [{**second, "direct": found[scene, sampling, "direct"]}
            for (scene, sampling, echoes), second in found.items()
            if echoes == "two reflections" and int(second["windows"]) >= FEWEST_WINDOWS]
    return side_by_side({"scene": text("scene"), "direct": lambda r: number("windows")(r["direct"]),
                         "two reflections": number("windows")},
                        {"direct": lambda r: percent(r["direct"]["held"]), "two reflections": share("held"),
                         "width/rms": ratio}, both)


def target_table(rows):
    return table(["scene", "sampling", "target", "median error", "90th percentile", "rms", "rays", "CPU ms",
                  "fewer rays than Monte Carlo", "faster", "fewer rays than strata", "faster"],
                 [[r["scene"], r["sampling"], f"{100 * float(r['target']):.0f} %", percent(r["median"]),
                   percent(r["ninety"]), percent(r["rms"]), f"{float(r['primary']):,.0f}",
                   f"{1e3 * float(r['seconds']):.0f}"] +
                  [f"{float(r[k]):.1f}" for k in ("carlo_rays", "carlo_seconds", "strata_rays", "strata_seconds")]
                  for r in rows])


def fixed_table(rows):
    return side_by_side({"scene": text("scene"), "N": text("rays")},
                        {"median error": share("median", 2), "90th percentile": share("ninety", 2),
                         "rms": share("rms", 2), "rays": lambda r: f"{float(r['primary']):,.0f}",
                         "CPU ms": lambda r: f"{1e3 * float(r['seconds']):.0f}"},
                        [r for r in rows if math.log2(int(r["rays"])) % 2 == 0])


def main():
    folder = sys.argv[1]
    errors = read(folder, "standard_errors")
    text = (HEAD + errors_table(errors) + FEW + few_table(errors) + PARTS + parts_table(errors) + TARGET +
            target_table(read(folder, "target_error")) + FIXED + fixed_table(read(folder, "fixed_rays")))
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
