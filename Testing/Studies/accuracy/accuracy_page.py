# SPDX-License-Identifier: BSD-3-Clause
"""The trade of speed for accuracy on the scenes of Documentation/results/accuracy.md, as tables and plots of that page. It takes
about ten minutes on two cores.

    Testing/Studies/run.py pages accuracy_page
"""
import csv
import shutil

import accuracy_speed
import tools
import trade_grid
from running import argument, study

# Name in the page, arguments, which plots the page shows.
RUNS = (("airport16", ["airport", "--sensor", "airport16"], ("energy", "range", "detection")),
        ("airport32", ["airport", "--sensor", "airport32", "--seeds", "3", "--reference-rays", "15000"], ()),
        ("corridor", ["corridor"], ("energy",)))


def rows(file):
    with open(file, encoding="utf-8") as stream:
        return list(csv.reader(stream))


def results(file):
    head, *body = rows(file)
    return [dict(zip(head, row)) for row in body]


def in_words(row):
    def value(name, factor=1):
        return f"{factor * float(row[name]):.2g}"

    def energy(kind):
        return value(f"energy {kind} error with missed as -1 [1]", 100)

    bound = "" if float(row["energy error told by the reference [1]"]) else "≤ "
    return (f"{value('time of one core [s]')} s, {float(row['rays traced per beam [1]']):.0f} rays a beam; energy "
            f"{bound}{energy('rms')} % (median {energy('median')} %), range "
            f"{value('range rms error [m]', 1000)} mm, {value('missed and false of the true [1]', 100)} % missed or false")


def joined(folder, part):
    """Head and rows of the tables of all scenes below one another, with the scene in front."""
    found = {name: rows(folder / name / f"{part}.csv") for name, *_ in RUNS}
    subjects = {name: results(folder / name / "results.csv")[0] for name in found}
    return ("scene", *found[RUNS[0][0]][0]), [(f"{subjects[name]['scene']}, {subjects[name]['sensor']}", *row)
                                              for name, (_, *body) in found.items() for row in body]


@study(argument("--scenes", nargs="*", choices=[name for name, *_ in RUNS], default=[name for name, *_ in RUNS],
                help="measure these and take the others from an earlier run; default: all"))
def main(options):
    for name, arguments, _ in RUNS:
        if name in options.scenes:
            accuracy_speed.main([*arguments, "--out", str(options.out / name)])
    known = {name: results(options.out / name / "results.csv") for name, *_ in RUNS}
    tools.leave(options.out, "trade-presets", ("preset", *(f"{t[0]['scene']}, {t[0]['sensor']}" for t in known.values())), [
        (f"`{preset}`", *(in_words(next(row for row in table if row["setting"] == preset)) for table in known.values()))
        for preset in trade_grid.PRESETS])
    tools.leave(options.out, "trade-advice", *joined(options.out, "advice"), 3)
    tools.leave(options.out, "trade-rates", *joined(options.out, "rates"), 2)
    for name, _, pictures in RUNS:
        for part in ("head", "table") if pictures else ("head",):
            shutil.copyfile(options.out / name / f"{part}.md", options.out / f"trade-{part}-{name}.md")
        for kind in pictures:
            shutil.copyfile(options.out / name / f"{kind}.png", options.out / f"{name}-{kind}.png")
