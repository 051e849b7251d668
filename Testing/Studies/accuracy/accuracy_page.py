# SPDX-License-Identifier: BSD-3-Clause
"""The trade of speed for accuracy on the scenes of Documentation/evidence/accuracy.md, as tables and a plot of that page. It takes
about ten minutes on two cores.

    Testing/Studies/run.py pages accuracy_page
"""
import shutil

import accuracy_speed
import tools
import trade_results
from running import study

# Name in the page, and arguments.
RUNS = (("airport16", ["airport", "--sensor", "airport16"]),
        ("airport32", ["airport", "--sensor", "airport32", "--seeds", "3", "--reference-rays", "15000"]),
        ("corridor", ["corridor"]))


@study()
def main(options):
    found = {}
    for name, arguments in RUNS:
        subject, _, results, advice = accuracy_speed.main([*arguments, "--out", str(options.out / name)])
        found[f"{subject.name}, {subject.sensor_name}"] = results, advice
        shutil.copyfile(options.out / name / "table.md", options.out / f"trade-table-{name}.md")
    shutil.copyfile(options.out / "airport16" / "energy.png", options.out / "airport16-energy.png")
    for name, left, tables in (
            ("advice", 3, {scene: trade_results.advice_table(advice, results) for scene, (results, advice) in found.items()}),
            ("rates", 2, {scene: accuracy_speed.rates(results) for scene, (results, _) in found.items()})):
        head = next(iter(tables.values()))[0]
        tools.leave(options.out, f"trade-{name}", ("scene", *head), [
            (scene, *row) for scene, (_, rows) in tables.items() for row in rows], left)
