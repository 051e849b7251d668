#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Documentation/results/standard-errors.md and small-targets.md from the CSV files of avianlidarAccuracy.

    make_page.py FOLDER"""
import csv
import pathlib
import sys

RESULTS = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "results"
FEWEST_WINDOWS = 10  # of a decile that is judged, as in SuiteStandardErrors.cxx

HEAD = """# Standard errors, measured

How far `energy_std_error` can be trusted where beams are sampled by rays. Made by `Testing/Accuracy/run.sh`; a test
(`Accuracy-StandardErrors`, shipped scenes, fixed seeds) holds the values named as wanted.

## Coverage of standard errors

* *Held*: share of estimates whose ±1.96 standard errors hold the truth (wanted: 93 %).
* *Least decile*: the smallest such share in any decile of the share of the beam's energy whose pulse reaches into the
  window (wanted: 88 %; deciles of fewer than ten windows are not judged).
* *Width/rms*: mean of 1.96 standard errors over the rms error, both relative to the truth (wanted: at most 4). It is
  1.96 for errors that are all alike, and less where a few large ones make the rms.
* *Bias*: mean error, relative.

A window is the strongest range unit of a return in one seed's scan, with a true energy of at least 2 Qlow. The truth
comes from 20,000 stratified rays of another seed; further seeds estimate the window's energy with a standard error. A
window in which a seed has no echo counts as not held. Every beam is sampled (`BeamSamples` is Rays), as integrated ones
state a bound instead; a specular lobe that no ray met is in no estimate. The light-energy constraint has a
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

SMALL = """# Small objects, measured

Whether beams in cells find a small object, how far its energy is right, and how far its standard error can be trusted.
How it works: [beams that many triangles enter](../beam-samples.md#cells). Made by
`Testing/Accuracy/run.sh`; the test `Accuracy-SmallTargets` holds that objects with an id of their own are found in 99 %
of the beams, and that 1.96 standard errors hold the truth in 93 %.

A matt box 1 km away, whose edges have the length given, stands somewhere in the inner half of {beams} beams, before a
wall of 1,152 triangles that fills them; both are turned by 25 degrees, so that no mirror's image of the lidar makes cells finer. Qlow is half of what the box's front returns. The truth is the box alone, which
is integrated.

* *Share*: of the beam that the box's front takes.
* *Found*: share of the beams with an echo before the wall.
* *Rms error*: of the energy of these echoes, relative to the truth.
* *Stated*: mean of their standard errors, likewise.
* *Held*: share of them of which 1.96 standard errors hold the truth.

## With an id of its own

An object with an id of its own gets more rays of the grid where fewer than 256 (32 with N = 25) would fall on it, from a share of 1e-6
of the beam on. So the number of rays matters for larger ones only.

"""

NO_ID = """
## Without an id of its own

Here the box is part of the wall's object. What fewer rays of the grid meet is missed as often as
`missed_detail_energy` says.

"""

RAYS = """
## By rays

With `BeamSamples` Rays the beam has its N rays, whatever stands there.

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


def small_table(rows):
    """A row for each size; the numbers of rays beside one another."""
    counts = list(dict.fromkeys(r["rays"] for r in rows))
    found = {}
    for r in rows:
        seen = float(r["found"]) > 0.0
        found.setdefault((f"{r['size']} m", f"{float(r['share']):.1e}"), {})[r["rays"]] = [
            percent(r["found"]), *(percent(r[k]) if seen else "" for k in ("rms", "stated", "held"))]
    names = [name for c in counts for name in (f"N = {int(c):,}: found", "rms error", "stated", "held")]
    return table(["edge", "share", *names], [[*key, *(text for c in counts for text in by[c])] for key, by in found.items()])


def small_page(rows):
    def some(samples, own):
        return small_table([r for r in rows if r["samples"] == samples and r["own_id"] == own])

    return (SMALL.format(beams=rows[0]["beams"]) + some("Cells", "1") + NO_ID + some("Cells", "0") + RAYS +
            some("Rays", "1"))


def main():
    folder = sys.argv[1]
    errors = read(folder, "standard_errors")
    page = HEAD + errors_table(errors) + FEW + few_table(errors) + PARTS + parts_table(errors)
    (RESULTS / "standard-errors.md").write_text(page, encoding="utf-8")
    (RESULTS / "small-targets.md").write_text(small_page(read(folder, "small_targets")), encoding="utf-8")


if __name__ == "__main__":
    main()
