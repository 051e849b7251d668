#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts the instructions of three fixed cases under callgrind and compares with what is recorded in instructions.json.

More than the tolerance above the record fails; fewer never does. --record writes the present counts.

Counts belong to a compiler and to an instruction set. The kernel chooses its code by the processor; valgrind 3.19 shows
it one with at most AVX2, so machines with AVX2 and with AVX-512 count alike. Skipped (exit code 77) are one without AVX2,
another compiler or build type, and one whose valgrind cannot start a Highway program: on a processor without RDTSCP
valgrind 3.19 tells programs that there is one, libhwy executes it when it is loaded, and valgrind does not know it.
Inside callgrind libm and the allocator count too: hence a tolerance and not equality."""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

RECORD = pathlib.Path(__file__).with_name("instructions.json")
CASES = ("trace-boxes", "trace-fine-sphere", "scan-corridor")
LOADER = "/lib64/ld-linux-x86-64.so.2"  # says what the processor has, as valgrind shows it
SKIPPED = 77


def count(valgrind, program, case):
    """Instructions executed inside avianlidarCounted()."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind.out"
        run = subprocess.run([valgrind, "--tool=callgrind", f"--callgrind-out-file={out}",
                              "--toggle-collect=avianlidarCounted", program, case],
                             capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise SystemExit(f"{case} failed under callgrind:\n{run.stdout}{run.stderr}")
        return int(re.search(r"^(?:summary|totals): (\d+)", out.read_text(encoding="utf-8"), re.M)[1])


def hindrance(valgrind, program):
    """Why nothing can be counted here, or None."""
    def run(*command):
        return subprocess.run([valgrind, "--tool=none", *command], capture_output=True, text=True, check=False)

    start = run(program)  # without a case it ends as soon as it has started
    if unknown := re.search(r"unhandled instruction.*", start.stderr):
        return f"valgrind cannot start a Highway program on this processor: {unknown[0]}"
    if "x86-64-v3 (supported" not in run(LOADER, "--help").stdout:
        return "the counts are for a processor with AVX2, which valgrind does not show here"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--valgrind", default="valgrind")
    parser.add_argument("--program", required=True)
    parser.add_argument("--compiler", required=True, help="name and version")
    parser.add_argument("--build", default="Release", help="CMAKE_BUILD_TYPE")
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()

    compiler = re.sub(r"(\d+)\.\S*$", r"\1", arguments.compiler)  # the major version
    if not arguments.record:
        record = json.loads(RECORD.read_text(encoding="utf-8"))
        here = {"compiler": compiler, "build": arguments.build}
        recorded = {key: record[key] for key in here}
        reason = (f"the counts are for {recorded}, this is {here}" if here != recorded
                  else hindrance(arguments.valgrind, arguments.program))
        if reason:
            print(f"skipped: {reason}")
            return SKIPPED
    counts = {case: count(arguments.valgrind, arguments.program, case) for case in CASES}
    if arguments.record:
        text = {"compiler": compiler, "build": arguments.build, "tolerance": 0.1, "instructions": counts}
        RECORD.write_text(json.dumps(text, indent=2) + "\n", encoding="utf-8")
        return 0
    changes = {case: counts[case] / record["instructions"][case] - 1.0 for case in CASES}
    for case, change in changes.items():
        hint = ", fewer: record anew with --record" if change < -record["tolerance"] else ""
        print(f"{case}: {counts[case]:,} instructions, {100 * change:+.1f} % of those recorded{hint}")
    return 1 if max(changes.values()) > record["tolerance"] else 0


if __name__ == "__main__":
    sys.exit(main())
