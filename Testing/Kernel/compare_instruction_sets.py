#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs avianlidarInstructionSets with every available instruction set, and compares the printed numbers.

The kernel chooses its loops by the processor when it starts (Filters/Kernel/Core/Multiversion.h). The other processors
are emulated by qemu, up to AVX2. AVX-512 is compared if this processor has it.

glibc's elementary functions differ in the last bit with and without fused multiply-adds, which GLIBC_TUNABLES can
switch off. Without them, all runs must have the same bits with every instruction set. With them, integers (triangles,
objects, numbers of returns, trees) must be the same. Other numbers must agree to 1e-12, and to 1e-6 where planes are
integrated, because the bounds of planes are differences of sums. No ray of the scenes is near enough to an edge to
cross it.

The exit code is 77 (skipped) without qemu 7.2, the first version that emulates AVX2, or a later version."""
import argparse
import concurrent.futures
import math
import os
import re
import subprocess
import sys

SKIPPED = 77
WITHOUT_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"}
# Model that qemu emulates (empty: this processor), whether libm may fuse, instruction set that must be chosen (None:
# any).
RUNS = (("Nehalem", False, "x86-64"), ("Haswell", False, "x86-64-v3"), ("", False, None), ("max", True, "x86-64-v3"),
        ("", True, None))


def has_avx2(qemu):
    """Whether this qemu emulates AVX2."""
    if not qemu or qemu.endswith("NOTFOUND"):
        return False
    text = subprocess.run([qemu, "--version"], capture_output=True, text=True, check=True).stdout
    return tuple(map(int, re.search(r"version (\d+)\.(\d+)", text).groups())) >= (7, 2)


def lines_of(program, qemu, model, fuses):
    environment = dict(os.environ, OMP_NUM_THREADS="1", **({} if fuses else WITHOUT_FMA))
    command = ([qemu, "-cpu", model] if model else []) + [program]
    return subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()


def are_close(one, two, tolerance):
    """Whether two rows have the same whole numbers and nearly the same others."""
    (whole, real), (other_whole, other_real) = (row.split("|") for row in (one, two))
    return whole == other_whole and all(a == b or math.isclose(float.fromhex(a), float.fromhex(b), rel_tol=tolerance)
                                        for a, b in zip(real.split(), other_real.split(), strict=True))


def differences(right, lines, fuses):
    """Sections and rows that differ."""
    section = ""
    for number, (one, two) in enumerate(zip(right, lines)):
        section = one if one.startswith("section") else section
        tolerance = 1e-6 if " panes:" in section else 1e-12
        if one != two and not (fuses and "|" in one and "|" in two and are_close(one, two, tolerance)):
            yield f"{section}, line {number}:\n  {one}\n  {two}"
    if len(right) != len(lines):
        yield f"{len(right)} and {len(lines)} lines"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--qemu", default="qemu-x86_64", help="empty or ...-NOTFOUND: not there")
    parser.add_argument("--program", required=True, help="avianlidarInstructionSets")
    arguments = parser.parse_args()
    if not has_avx2(arguments.qemu):
        print(f"skipped: this needs qemu-x86_64 7.2 or later (package qemu-user), found: {arguments.qemu or 'none'}")
        return SKIPPED
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        printed = list(pool.map(lambda run: lines_of(arguments.program, arguments.qemu, *run[:2]), RUNS))
    failed = False
    for (model, fuses, expected), (chosen, *lines) in zip(RUNS, printed):
        errors = list(differences(printed[0][1:], lines, fuses))
        errors += [f"not {expected}"] * (expected not in (None, chosen))
        print(f"{model or 'this processor'}, libm {'with' if fuses else 'without'} FMA: {chosen}, "
              f"{len(lines):,} lines, {len(errors)} errors", *errors[:5], sep="\n" if errors else " ")
        failed = failed or bool(errors)
    return failed


if __name__ == "__main__":
    sys.exit(main())
