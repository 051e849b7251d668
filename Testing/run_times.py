#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the slowest tests of run.sh. The last line is the one that ctest closes with.

    run_times.py TESTS.xml    of `ctest --output-junit`
"""
import sys
import xml.etree.ElementTree

SLOWEST = 10


def main(tests):
    try:
        suite = xml.etree.ElementTree.parse(tests).getroot()
    except (OSError, xml.etree.ElementTree.ParseError):
        print(f"ctest left no {tests}.")
        return
    cases = sorted(((float(case.get("time")), case.get("name")) for case in suite.iter("testcase")), reverse=True)
    if not cases:  # they were only listed
        return
    minutes = sum(seconds for seconds, _ in cases) / 60
    print(f"\nSlowest of {len(cases)} tests, {minutes:.1f} min one after the other:")
    for seconds, name in cases[:SLOWEST]:
        print(f"{seconds:8.1f} s  {name}")
    # What could not run counts as skipped there.
    skipped = sum(reason.get("message", "").startswith("SKIP_") for reason in suite.iter("skipped"))
    failed = len(cases) - skipped - sum(case.get("status") == "run" for case in suite.iter("testcase"))
    print(f"\n{100 * (len(cases) - failed) // len(cases)}% tests passed, {failed} tests failed out of {len(cases)}, "
          f"{skipped} of them skipped")


if __name__ == "__main__":
    main(sys.argv[1])
