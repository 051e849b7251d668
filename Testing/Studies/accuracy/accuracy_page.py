# SPDX-License-Identifier: BSD-3-Clause
"""The trade of speed for accuracy on the scenes of Documentation/evidence/accuracy.md, as tables and plots of that page. It takes
about ten minutes on two cores.

    Testing/Studies/run.py pages accuracy_page
"""
import shutil

import accuracy_speed
import tools
import trade_grid
import trade_results
from running import study

# Name in the page, arguments, which plots the page shows.
RUNS = (("airport16", ["airport", "--sensor", "airport16"], ("energy", "range", "detection")),
        ("airport32", ["airport", "--sensor", "airport32", "--seeds", "3", "--reference-rays", "15000"], ()),
        ("corridor", ["corridor"], ("energy",)))


def in_words(r):
    bound = "" if r.resolved("energy") else "≤ "
    return (f"{r.median('cpu'):.2g} s, {r.mean('rays'):.0f} rays a beam; energy {bound}{100 * r.error('energy'):.2g} % "
            f"(median {100 * r.mean('energy_median'):.2g} %), range {1000 * r.error('range'):.2g} mm, "
            f"{100 * r.error('detection'):.2g} % missed or false")


@study()
def main(options):
    found = {}
    for name, arguments, pictures in RUNS:
        subject, _, results, advice = accuracy_speed.main([*arguments, "--out", str(options.out / name)])
        found[f"{subject.name}, {subject.sensor_name}"] = results, advice
        for part in ("head", "table") if pictures else ("head",):
            shutil.copyfile(options.out / name / f"{part}.md", options.out / f"trade-{part}-{name}.md")
        for kind in pictures:
            shutil.copyfile(options.out / name / f"{kind}.png", options.out / f"{name}-{kind}.png")
    tools.leave(options.out, "trade-presets", ("preset", *found), [
        (f"`{preset}`", *(in_words(next(r for r in results if r.choice.family == preset)) for results, _ in found.values()))
        for preset in trade_grid.PRESETS])
    for name, left, tables in (
            ("advice", 3, {scene: trade_results.advice_table(advice, results) for scene, (results, advice) in found.items()}),
            ("rates", 2, {scene: accuracy_speed.rates(results) for scene, (results, _) in found.items()})):
        head = next(iter(tables.values()))[0]
        tools.leave(options.out, f"trade-{name}", ("scene", *head), [
            (scene, *row) for scene, (_, rows) in tables.items() for row in rows], left)
