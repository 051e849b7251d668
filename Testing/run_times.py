#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where the time of run.sh goes: runs a stage and notes its times, and prints all of them with the slowest tests. The last
line is the one that ctest closes with.

    run_times.py stage FILE NAME COMMAND...    exits as the command does
    run_times.py table FILE TESTS.xml          of `ctest --output-junit`
"""
import resource
import subprocess
import sys
import time
import xml.etree.ElementTree

SLOWEST = 10


def stage(file, name, *command):
    """Runs it. Processor time is that of all its processes that have ended, wall time has those, too, that only wait."""
    start = time.monotonic()
    code = subprocess.run(command, check=False).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(file, "a", encoding="utf-8") as lines:
        lines.write(f"{name}\t{time.monotonic() - start:.1f}\t{used.ru_utime + used.ru_stime:.1f}\n")
    return code


def table(file, tests):
    with open(file, encoding="utf-8") as lines:
        stages = [line.rstrip("\n").split("\t") for line in lines]
    stages = [(name, float(wall), float(processor)) for name, wall, processor in stages]
    total = ("all", *(sum(one[i] for one in stages) for i in (1, 2)))
    print(f"\n{'stage':<20}{'min':>8}{'CPU min':>10}")
    for name, wall, processor in (*stages, total):
        print(f"{name:<20}{wall / 60:>8.1f}{processor / 60:>10.1f}")
    try:
        suite = xml.etree.ElementTree.parse(tests).getroot()
    except (OSError, xml.etree.ElementTree.ParseError):
        print(f"ctest left no {tests}.")
        return 0
    cases = sorted(((float(case.get("time")), case.get("name")) for case in suite.iter("testcase")), reverse=True)
    if not cases:  # they were only listed
        return 0
    print(f"\nSlowest of {len(cases)} tests, {sum(seconds for seconds, _ in cases) / 60:.1f} min one after the other:")
    for seconds, name in cases[:SLOWEST]:
        print(f"{seconds:8.1f} s  {name}")
    # What could not run counts as skipped there.
    skipped = sum(reason.get("message", "").startswith("SKIP_") for reason in suite.iter("skipped"))
    passed = sum(case.get("status") == "run" for case in suite.iter("testcase"))
    failed = len(cases) - passed - skipped
    print(f"\n{100 * (len(cases) - failed) // len(cases)}% tests passed, {failed} tests failed out of {len(cases)}, "
          f"{skipped} of them skipped")
    return 0


if __name__ == "__main__":
    sys.exit({"stage": stage, "table": table}[sys.argv[1]](*sys.argv[2:]))
