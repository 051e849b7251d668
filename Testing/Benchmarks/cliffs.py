#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times what users have met as cliffs: small objects in crowded beams, second reflections of beams without an echo, range
gates, the tree, and whole commands. Each row is a ratio or a time with its aim; ratios are of medians of processor times,
taken in turn in one process.

    AVIANLIDAR_DATA_DIR=sceneries cliffs.py [--short] [--parts crowded silent ...] [-o cliffs.csv]

The whole takes about forty minutes, --short about five. A row is never an error because something is slow."""
import argparse
import csv
import importlib
import statistics
import sys
import time
from typing import Callable, Dict, NamedTuple, Optional

PARTS = ("crowded", "silent", "gate", "tree", "operations")


class Row(NamedTuple):
    part: str
    what: str
    value: float
    unit: str                    # s, MB, B, or empty for a ratio
    aim: Optional[float] = None  # at most; None for rows that explain others


def interleaved(runs: Dict[str, Callable[[], object]], rounds: int = 5, first: bool = False) -> Dict[str, float]:
    """Medians of the processor times (s) of runs that take turns. @param first times the first turn, too"""
    times: Dict[str, list] = {name: [] for name in runs}
    for number in range(rounds + (not first)):
        for name, run in (runs.items() if number % 2 else reversed(runs.items())):
            start = time.process_time()
            run()
            if number or first:
                times[name].append(time.process_time() - start)
    return {name: statistics.median(all_) for name, all_ in times.items()}


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="about five minutes")
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=PARTS, help="only these")
    parser.add_argument("-o", metavar="FILE", help="writes the rows as CSV")
    options = parser.parse_args(arguments)
    rows = []
    print(f"{'value':>10}  {'aim':>6}  what")
    for part in options.parts:
        for row in importlib.import_module(f"cliff_{part}").rows(options.short):
            rows.append(row)
            value = f"{row.value:.3g} {row.unit}".strip()
            aim = "" if row.aim is None else f"{row.aim:g}"
            print(f"{value:>10}  {aim:>6}  {row.part}: {row.what}{'' if row.aim is None or row.value <= row.aim else '  (missed)'}",
                  flush=True)
    if options.o:
        with open(options.o, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([Row._fields, *rows])
    return 0


if __name__ == "__main__":
    sys.exit(main())
