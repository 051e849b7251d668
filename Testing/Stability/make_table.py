#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs avianlidarStabilityTests and writes what it recorded into Documentation/evidence/tables/extremes.csv.

With --check nothing is written: the file must have the very rows that the tests make, with their ranges and promises.
The worst errors are those of the run that wrote the file; they may differ in their last digits between processors, and
what they may be at most the tests check themselves.

With --large the rows on size are those of ten million triangles (about 3 GB, a minute)."""
import argparse
import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HEAD = ["extreme", "input range", "view", "what is measured", "promised: at most", "worst seen"]
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


def promises(rows):
    """What does not depend on machine and build: all but the last column and numbers that tell of size."""
    return sorted(re.sub(r"[0-9,]+ triangles", "triangles", " | ".join(row[:-1])) for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--table", required=True, type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--large", action="store_true")
    arguments = parser.parse_args()
    with open(arguments.table, encoding="utf-8", newline="") as lines:
        old = list(csv.reader(lines))[1:]
    known = [row[0] for row in old]
    rows = recorded(arguments.program, arguments.large)
    # whichever ran first; new ones last
    rows.sort(key=lambda row: known.index(row[0]) if row[0] in known else len(known))
    if not arguments.check:
        with open(arguments.table, "w", encoding="utf-8", newline="") as lines:
            csv.writer(lines, lineterminator="\n").writerows([HEAD, *rows])
        return 0
    wrong = set(promises(rows)) ^ set(promises(old))
    for line in sorted(wrong):
        print("only on one side:", line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
