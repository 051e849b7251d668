#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Documentation/results/standard-errors.md from the CSV files of avianlidarAccuracy.

    make_page.py FOLDER"""
import csv
import pathlib
import sys

PAGE = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "results" / "standard-errors.md"
FEWEST_WINDOWS = 10  # of a decile that is judged, as in SuiteStandardErrors.cxx

HEAD = """# Standard errors and target errors, measured

Made by `Testing/Accuracy/run.sh`; the bars are a test (`Accuracy-StandardErrors`, shipped scenes, fixed seeds).

## How honest are standard errors?

A window is the strongest range unit of a return that one seed sees, with a true energy of at least 2 Qlow; the truth comes
from 20,000 stratified rays of another seed (100,000 for small targets). Other seeds then estimate the energy in the window, and state
a standard error. *Held*: share of estimates whose ±1.96 standard errors hold the truth (wanted: 93 %). *Least decile*: the
smallest such share in any decile of covered share, the share of the beam's energy whose pulse reaches into the window (wanted: 88 %;
deciles of fewer than ten windows are not judged). *Width/rms*: mean of 1.96 standard errors over the root mean square error, both
relative to the truth (wanted: at most 4; 1.96 for errors that are all alike, less where a few large ones make the rms). *Bias*: mean error, relative. A window in which a seed
sees nothing counts as not held. Of the 32 channels every second column is measured, of Ingolstadt every fourth, with N = 1000 half of
these. Every beam is sampled: what is integrated states a bound. Small objects have rays of their own, as users run it. The light-energy constraint has a thousandth of Qlow here: what it may cost is a bound of its own.

"""

FEW = """
Fewer rays than 16 often see nothing of a window; of the echoes that there are, widened by Student's t, the truth is held by (wanted:
90 %; below 8 rays there is no standard error):

"""

PARTS = """
Direct echoes, and those of which more than 1 % of the energy came over two reflections (100 rays; held):

"""

TARGET = """
## What does a target error reach, and what does it cost?

`TargetRelativeError` with `RaysPerBeam` 100 (so 8 to 1,600 rays a beam), over all windows and two seeds. Errors are relative to the
truth; an echo that is not perceived has the error 100 %. Rays are primary, with the pilot's and those of small targets, of the beams that meet something; CPU
time is that of the whole scan on one thread, two reflections. *Fewer rays than*, *faster than*: what a fixed number of rays per beam
needs for the same rms error, over what was spent (between and beyond the numbers that were run, 16 to 1024 strata and 16 to 4096 Monte
Carlo, by straight lines between logarithms).

"""

FIXED = """
Fixed numbers of rays, for comparison:

"""


def read(folder, name):
    with open(pathlib.Path(folder) / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---|" + "---|" + "---:|" * (len(header) - 2)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def percent(text, digits=1):
    return f"{100 * float(text):.{digits}f} %"


def few_table(rows):
    return table(["scene", "sampling", "N", "windows", "seeds", "seen", "held of seen", "width/rms"],
                 [[r["scene"], r["sampling"], r["rays"], f"{int(r['windows']):,}", r["seeds"],
                   percent(float(r["held"]) / float(r["held_seen"])), percent(r["held_seen"]), f"{float(r['ratio']):.2f}"]
                  for r in rows if r["echoes"] == "all" and int(r["rays"]) < 16])


def errors_table(rows):
    lines = []
    for row in rows:
        if row["echoes"] != "all" or int(row["rays"]) < 16:
            continue
        alike = [r for r in rows if all(r[k] == row[k] for k in ("scene", "sampling", "rays"))]
        deciles = [float(r["held"]) for r in alike
                   if r["echoes"].startswith("decile") and int(r["windows"]) >= FEWEST_WINDOWS]
        lines.append([row["scene"], row["sampling"], row["rays"], f"{int(row['windows']):,}", row["seeds"],
                      percent(row["held"]), percent(min(deciles)), percent(row["rms"]), f"{float(row['ratio']):.2f}",
                      percent(row["bias"], 2)])
    return table(["scene", "sampling", "N", "windows", "seeds", "held", "least decile", "rms error", "width/rms", "bias"],
                 lines)


def parts_table(rows):
    found = {(r["scene"], r["sampling"], r["echoes"]): r for r in rows if r["rays"] == "100"}
    lines = []
    for scene, sampling, echoes in found:
        second = found.get((scene, sampling, "two reflections"))
        if echoes == "direct" and second and int(second["windows"]) >= FEWEST_WINDOWS:
            direct = found[scene, sampling, "direct"]
            lines.append([scene, sampling, f"{int(direct['windows']):,}", percent(direct["held"]),
                          f"{int(second['windows']):,}", percent(second["held"]), f"{float(second['ratio']):.2f}"])
    return table(["scene", "sampling", "direct", "held", "two reflections", "held", "width/rms"], lines)


def target_table(rows):
    return table(["scene", "sampling", "target", "median error", "90th percentile", "rms", "rays", "CPU ms",
                  "fewer rays than Monte Carlo", "faster", "fewer rays than strata", "faster"],
                 [[r["scene"], r["sampling"], f"{100 * float(r['target']):.0f} %", percent(r["median"]),
                   percent(r["ninety"]), percent(r["rms"]), f"{float(r['primary']):,.0f}",
                   f"{1e3 * float(r['seconds']):.0f}"] +
                  [f"{float(r[k]):.1f}" for k in ("carlo_rays", "carlo_seconds", "strata_rays", "strata_seconds")]
                  for r in rows])


def fixed_table(rows):
    return table(["scene", "sampling", "N", "median error", "90th percentile", "rms", "rays", "CPU ms"],
                 [[r["scene"], r["sampling"], r["rays"], percent(r["median"], 2), percent(r["ninety"], 2),
                   percent(r["rms"], 2), f"{float(r['primary']):,.0f}", f"{1e3 * float(r['seconds']):.0f}"]
                  for r in rows])


def main():
    folder = sys.argv[1]
    errors = read(folder, "standard_errors")
    text = (HEAD + errors_table(errors) + FEW + few_table(errors) + PARTS + parts_table(errors) + TARGET +
            target_table(read(folder, "target_error")) + FIXED + fixed_table(read(folder, "fixed_rays")))
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
