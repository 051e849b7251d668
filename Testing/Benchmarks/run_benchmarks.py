#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every suite of avianlidarBenchmarks, each in a process of its own, and writes tables and plots of what they
measured.

    run_benchmarks.py --program build/paraview/bin/avianlidarBenchmarks --out build/benchmarks [--short | --smoke]

--smoke is for the test suite: seconds, no times worth reading, but hits are compared and every file has to appear.
The exit code is not 0 if hits disagree, a suite fails or a file is missing; never because something is slow."""
import argparse
import csv
import os
import pathlib
import subprocess
import sys
import time

import report
import results

# The files that a suite leaves, if not one of its own name.
SUITES = {"machine": ["libraries"], "matrix": ["matrix", "hits"], "locators": [], "build": [], "figure9": [],
          "figure10": [], "figure11": ["figure11", "rays11"], "epsilon": [], "section5": [], "scan": [], "filter": [],
          "memory": [], "movers": []}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--short", action="store_true", help="about ten minutes")
    parser.add_argument("--smoke", action="store_true", help="seconds")
    parser.add_argument("--suites", nargs="*", default=list(SUITES), help="only these")
    arguments = parser.parse_args()
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "machine.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("what", "is"), *results.machine()])
    form = ["--smoke"] if arguments.smoke else ["--short"] if arguments.short else []
    # Threads that wait for the next loop leave the core to whoever is measured meanwhile.
    environment = {**os.environ, "OMP_WAIT_POLICY": "passive"}
    failed = []
    for name in arguments.suites:
        files = SUITES[name] or [name]
        for file in files:
            (out / f"{file}.csv").unlink(missing_ok=True)
        start = time.monotonic()
        code = subprocess.run([arguments.program, name, str(out), *form], check=False,
                              env=environment).returncode
        print(f"-- {name}: {time.monotonic() - start:.0f} s", flush=True)
        empty = [f for f in files if not results.read(out, f)]
        if code != 0 or empty:
            failed.append(f"{name} (exit code {code}, without results: {empty})")
    failed += [str(p) for p in report.make(out) if not p.exists()]
    for what in failed:
        print(f"FAILED: {what}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
