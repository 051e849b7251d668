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
import platform
import re
import subprocess
import sys
import time

import report

# Suite and the files that it leaves.
SUITES = (("machine", ["libraries"]), ("matrix", ["matrix", "hits"]), ("locators", ["locators"]), ("build", ["build"]),
          ("growth", ["growth"]), ("figure9", ["figure9"]), ("figure10", ["figure10"]), ("figure11", ["figure11", "rays11"]),
          ("epsilon", ["epsilon"]), ("section5", ["section5"]),
          ("scan", ["scan"]), ("front", ["front"]), ("filter", ["filter"]), ("memory", ["memory"]),
          ("movers", ["movers"]))


def describe_machine(out):
    """machine.csv: processor, cores, instruction sets, memory, system, load."""
    info = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")

    def first(key):
        found = re.search(rf"^{key}\s*:\s*(.*)$", info, re.M)
        return found[1] if found else "unknown"

    flags = set(first("flags").split())
    sets = [s for s in ("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512bw", "avx512vl") if s in flags]
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    rows = [("processor", f"{first('model name')} (family {first('cpu family')}, model {first('model')})"),
            ("cores", len(os.sched_getaffinity(0))), ("instruction sets", " ".join(sets)),
            ("memory", f"{memory:.0f} GiB"), ("system", platform.freedesktop_os_release().get("PRETTY_NAME", "")),
            ("load before the run", f"{os.getloadavg()[0]:.1f}"), ("date", time.strftime("%Y-%m-%d"))]
    with open(out / "machine.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("what", "is"), *rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--short", action="store_true", help="about ten minutes")
    parser.add_argument("--smoke", action="store_true", help="seconds")
    parser.add_argument("--suites", nargs="*", default=[name for name, _ in SUITES], help="only these")
    arguments = parser.parse_args()
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    describe_machine(out)
    form = ["--smoke"] if arguments.smoke else ["--short"] if arguments.short else []
    # Threads that wait for the next loop leave the core to whoever is measured meanwhile.
    environment = {**os.environ, "OMP_WAIT_POLICY": "passive"}
    failed = []
    for name, files in SUITES:
        if name not in arguments.suites:
            continue
        for file in files:
            (out / f"{file}.csv").unlink(missing_ok=True)
        start = time.monotonic()
        code = subprocess.run([arguments.program, "--suite", name, "--out", str(out), *form], check=False,
                              env=environment).returncode
        print(f"-- {name}: {time.monotonic() - start:.0f} s", flush=True)
        empty = [f for f in files if len(report.read(out, f)) == 0]
        if code != 0 or empty:
            failed.append(f"{name} (exit code {code}, without results: {empty})")
    pictures = report.make(out)
    missing = [str(p) for p in pictures if not p.exists()]
    for what in failed + missing:
        print(f"FAILED: {what}", file=sys.stderr)
    return 1 if failed or missing else 0


if __name__ == "__main__":
    sys.exit(main())
