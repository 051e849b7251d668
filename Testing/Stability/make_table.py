#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs avianlidarStabilityTests and writes what it recorded into the table of Documentation/results/stability.md.

With --check nothing is written: the page must have the very rows that the tests make, with their ranges and promises.
The worst errors are those of the run that wrote the page; they may differ in their last digits between processors, and
what they may be at most the tests check themselves.

With --large the rows on size are those of ten million triangles (about 3 GB, a minute)."""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BEGIN = "<!-- table: extremes -->"
END = "<!-- end -->"
HEADER = "| extreme | input range | what is measured | promised: at most | worst seen |\n|---|---|---|---:|---:|\n"
LARGE = {"AVIANLIDAR_STABILITY_TRIANGLES": "10000000"}


def recorded(program, large):
    """Rows of a run, which must pass."""
    with tempfile.TemporaryDirectory() as folder:
        rows = pathlib.Path(folder) / "rows.tsv"
        environment = dict(os.environ, AVIANLIDAR_STABILITY_ROWS=str(rows), **(LARGE if large else {}))
        done = subprocess.run([program, "--gtest_brief=1"], env=environment, check=False)
        if done.returncode != 0:
            sys.exit("the tests failed: no table")
        return [line.split("\t") for line in rows.read_text().splitlines()]


def in_markdown(rows):
    """The table, each extreme named once."""
    text = HEADER
    extreme = None
    for row in rows:
        text += "| {} | {} | {} | {} | {} |\n".format(row[0] if row[0] != extreme else "", *row[1:])
        extreme = row[0]
    return text


def promises(table):
    """What does not depend on machine and build: all but the last column, numbers that tell of size, and the order."""
    rows, extreme = [], None
    for line in table.splitlines():
        first, *rest = line.split("|")[1:-2]
        extreme = first if first.strip() else extreme
        rows.append("|".join([extreme, *rest]))
    return sorted(re.sub(r"[0-9,]+ triangles", "triangles", row) for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--page", required=True, type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--large", action="store_true")
    arguments = parser.parse_args()
    page = arguments.page.read_text()
    before, rest = page.split(BEGIN + "\n")
    old, after = rest.split(END, 1)
    rows = recorded(arguments.program, arguments.large)
    rows.sort(key=lambda row: old.find(f"| {row[0]} |") % (len(old) + 1))  # as on the page, whichever ran first; new ones last
    table = in_markdown(rows)
    if not arguments.check:
        arguments.page.write_text(before + BEGIN + "\n" + table + END + after)
        return 0
    if promises(table) != promises(old):
        for line in set(promises(table)) ^ set(promises(old)):
            print("only on one side:", line)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
