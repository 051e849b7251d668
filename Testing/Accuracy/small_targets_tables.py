#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of Documentation/results/small-targets.md, from the CSV files of avianlidarAccuracy. Costs of scenes
that were not measured, as those of the rich sceneries without their data, stay as they are.

    small_targets_tables.py FOLDER"""
import csv
import pathlib
import re
import sys

PAGE = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "results" / "small-targets.md"
COLUMNS = [("100", "Stratified"), ("100", "MonteCarlo"), ("16", "Stratified"), ("16", "MonteCarlo")]


def read(folder, name):
    with open(pathlib.Path(folder) / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---|" + "---:|" * (len(header) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def by_size(rows):
    """How often each size is received and how its energy spreads; in brackets without rays of its own."""
    found = {(r["size"], r["rays"], r["sampling"], r["own"]): r for r in rows}
    sizes = list(dict.fromkeys(r["size"] for r in rows))

    def cell(size, column, what, digits):
        own, none = (100 * float(found[size, *column, i][what]) for i in "10")
        return f"{own:.{digits}f} % ({none:.{digits}f} %)"

    names = [name for rays, sampling in COLUMNS for name in (f"N = {rays}, {sampling}", "spread")]
    return table(["edge"] + names, [[f"{size} m"] + [text for c in COLUMNS for text in (
        cell(size, c, "seen", 1), cell(size, c, "deviation", 0))] for size in sizes])


def costs(rows):
    """One row for each scene and kind of objects, the numbers of channels beside one another."""
    channels = list(dict.fromkeys(r["channels"] for r in rows))
    found = {}
    for r in rows:
        found.setdefault((r["scene"], f"{int(r['objects']):,}, {r['object']}"), {})[r["channels"]] = [
            f"{int(r['beams_with']):,} of {int(r['beams']):,}", f"{float(r['targets']):,.0f}",
            f"{float(r['off_ms']):.1f}", f"{float(r['on_ms']):.1f}", f"{100 * float(r['more']):+.1f} %"]
    names = [name for c in channels
             for name in (f"{c} channels: beams with targets", "targets", "without, ms", "with, ms", "more")]
    return table(["scene", "objects"] + names,
                 [[*key, *(text for c in channels for text in by.get(c, [""] * 5))] for key, by in found.items()])


def scene_of(line):
    return line.split("|")[1].strip()


def with_those_not_measured(measured, before):
    """A table's lines: the new ones, each scene's in the place of its old ones, and the old ones of other scenes."""
    head, rows = measured.split("\n")[:2], measured.split("\n")[2:]
    new = {scene: [row for row in rows if scene_of(row) == scene] for scene in dict.fromkeys(map(scene_of, rows))}
    old = {scene: [row for row in before if scene_of(row) == scene] for scene in dict.fromkeys(map(scene_of, before))}
    for scene in old.keys() - new.keys():
        print(f"not measured, as before: {scene}")
    return "\n".join(head + sum((old | new).values(), []))


def main():
    folder = sys.argv[1]
    detection = read(folder, "small_targets")
    tables = {"seen": by_size(detection), "cost": costs(read(folder, "small_targets_cost"))}
    text = PAGE.read_text(encoding="utf-8")
    before = re.search("<!-- cost -->\n(.*?)\n<!-- /cost -->", text, flags=re.DOTALL)
    tables["cost"] = with_those_not_measured(tables["cost"], before[1].split("\n")[2:])
    for name, lines in tables.items():
        text, count = re.subn(f"(<!-- {name} -->\n).*?(\n<!-- /{name} -->)", lambda m, t=lines: m[1] + t + m[2], text,
                              flags=re.DOTALL)
        assert count == 1, name
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
