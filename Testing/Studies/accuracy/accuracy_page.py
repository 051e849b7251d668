# SPDX-License-Identifier: BSD-3-Clause
"""The trade of speed for accuracy on the scenes of Documentation/evidence/accuracy.md, as tables and a plot of that page. It takes
about ten minutes on two cores.

    Testing/Studies/run.py pages accuracy_page
"""
import shutil

import accuracy_speed
import tools
import trade_grid
import trade_results
from running import study

# Name in the page, and arguments.
RUNS = (("airport16", ["airport", "--sensor", "airport16"]),
        ("airport32", ["airport", "--sensor", "airport32", "--seeds", "3", "--reference-rays", "15000"]),
        ("corridor", ["corridor"]))


def in_words(r):
    bound = "" if r.resolved("energy") else "≤ "
    return (f"{r.median('cpu'):.2g} s, {r.mean('rays'):.0f} rays a beam; energy {bound}{100 * r.error('energy'):.2g} % "
            f"(median {100 * r.mean('energy_median'):.2g} %), range {1000 * r.error('range'):.2g} mm, "
            f"{100 * r.error('detection'):.2g} % missed or false")


@study()
def main(options):
    found = {}
    for name, arguments in RUNS:
        subject, _, results, advice = accuracy_speed.main([*arguments, "--out", str(options.out / name)])
        found[f"{subject.name}, {subject.sensor_name}"] = results, advice
        shutil.copyfile(options.out / name / "table.md", options.out / f"trade-table-{name}.md")
    shutil.copyfile(options.out / "airport16" / "energy.png", options.out / "airport16-energy.png")
    tools.leave(options.out, "trade-presets", ("preset", *found), [
        (f"`{preset}`", *(in_words(next(r for r in results if r.choice.family == preset)) for results, _ in found.values()))
        for preset in trade_grid.PRESETS])
    for name, left, tables in (
            ("advice", 3, {scene: trade_results.advice_table(advice, results) for scene, (results, advice) in found.items()}),
            ("rates", 2, {scene: accuracy_speed.rates(results) for scene, (results, _) in found.items()})):
        head = next(iter(tables.values()))[0]
        tools.leave(options.out, f"trade-{name}", ("scene", *head), [
            (scene, *row) for scene, (_, rows) in tables.items() for row in rows], left)
