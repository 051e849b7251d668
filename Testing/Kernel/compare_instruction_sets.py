#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs avianlidarInstructionSets with every instruction set that can be had here, and compares all it writes.

The kernel chooses its loops by the processor when it starts (Filters/Kernel/Core/Multiversion.h), so another choice needs
another processor: this one, and those that qemu emulates, which go up to AVX2. AVX-512 is compared where this processor
has it.

glibc chooses too: its elementary functions differ in the last bit with and without fused multiply-adds. It can be told
not to use them (GLIBC_TUNABLES), which tells the two apart. Runs that have libm's bits in common, by a fingerprint that
the program takes, must have all bits in common: every instruction set takes part in that comparison. Between libm's two
versions whole numbers (triangles, objects, numbers of returns, trees) must be the same, others to 1e-12, but to 1e-6 where
planes are integrated, whose bounds are differences of sums: the scenes have no ray so near an edge that it goes over.

Exit code 77, which means skipped, without qemu 7.2 or later, the first to emulate AVX2."""
import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77
TOLERANCE = 1e-12
TOLERANCE_OF_INTEGRALS = 1e-6  # of the scene "panes"
LIBM_WITHOUT_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"}
BASE = "x86-64"
SETS = ("x86-64-v4", "x86-64-v3")  # of Multiversion.h, the best first
# Name, model that qemu emulates, libm without FMA, instruction set that must be chosen (None: what the loader says).
RUNS = (("this processor", None, False, None),
        ("this processor, libm without FMA", None, True, None),
        ("Nehalem", "Nehalem", False, BASE),
        ("Haswell, libm without FMA", "Haswell", True, "x86-64-v3"),
        ("all that qemu has", "max", False, "x86-64-v3"))
LOADER = "/lib64/ld-linux-x86-64.so.2"
MOST_ERRORS = 5


class Run:
    """What the program wrote: `rows` of `sections`, a section being (kind, scene, whole and real columns)."""

    def __init__(self, name, path):
        self.name = name
        lines = path.read_text(encoding="ascii").splitlines()
        self.instruction_set = lines[0].removeprefix("instruction set ")
        self.libm = lines[1].removeprefix("libm ")
        self.sections = []
        for line in lines[2:]:
            if line.startswith("section "):
                head, columns = line.split(" : ")
                whole, real = columns.split("|")
                self.sections.append((*head.split()[1:], whole.split(), real.split(), []))
            else:
                self.sections[-1][-1].append(line)

    def count(self, kind):
        return sum(len(section[-1]) for section in self.sections if section[0] == kind)


class Comparison:
    """Of two runs."""

    def __init__(self, one, two):
        self.same_libm = one.libm == two.libm
        self.errors = []
        self.largest = {}  # relative difference, by name
        self.differing = 0
        title = f"{two.name} ({two.instruction_set}) against {one.name} ({one.instruction_set}): "
        if [section[:-1] for section in one.sections] != [section[:-1] for section in two.sections]:
            self.errors.append(title + "other sections")
            return
        for a, b in zip(one.sections, two.sections):
            place = title + " ".join(a[:2])
            if len(a[-1]) != len(b[-1]):
                self.errors.append(f"{place}: {len(a[-1])} and {len(b[-1])} rows")
                continue
            for number, (x, y) in enumerate(zip(a[-1], b[-1])):
                if x != y:
                    self.compare(f"{place}, row {number}", a, x, y)

    def compare(self, place, section, x, y):
        _, scene, whole, real = section[:4]
        tolerance = TOLERANCE_OF_INTEGRALS if scene == "panes" else TOLERANCE
        whole_x, real_x = x.split("|")
        whole_y, real_y = y.split("|")
        self.differing += 1
        good = not self.same_libm and whole_x == whole_y
        for name, p, q in zip(real, real_x.split(), real_y.split()):
            if p == q:
                continue
            p, q = float.fromhex(p), float.fromhex(q)
            difference = abs(p - q) / max(abs(p), abs(q)) if p != q else 0.0  # zeros of two signs
            self.largest[name] = max(difference, self.largest.get(name, 0.0))
            good = good and difference <= tolerance  # false for NaN, too
        if not good:
            self.errors.append(f"{place} ({' '.join(whole)} | {' '.join(real)}):\n  {x}\n  {y}")

    def summary(self):
        if not self.differing:
            return "the same bits"
        worst = ", ".join(f"{name} {value:.1e}" for name, value in self.largest.items())
        return f"{self.differing} rows differ; largest relative differences: {worst or 'none, but whole numbers'}"


def set_of_this_processor(loader=LOADER):
    """By glibc's loader, which asks the processor itself; None where it does not say (glibc before 2.33, another libc)."""
    try:
        text = subprocess.run([loader, "--help"], capture_output=True, text=True, check=False).stdout
    except OSError:
        return None
    levels = re.findall(r"^ +(x86-64-v\d+)( \(supported)?", text, re.M)
    supported = {name for name, supported in levels if supported}
    return next((name for name in SETS if name in supported), BASE) if levels else None


def has_avx2(qemu):
    """Whether this qemu emulates AVX2."""
    if not qemu or qemu.endswith("NOTFOUND"):
        return False
    text = subprocess.run([qemu, "--version"], capture_output=True, text=True, check=True).stdout
    version = re.search(r"version (\d+)\.(\d+)", text)
    return (int(version[1]), int(version[2])) >= (7, 2)


def start(program, qemu, folder, number):
    name, model, without_fma, _ = RUNS[number]
    out = folder / f"{number}.txt"
    command = ([qemu, "-cpu", model] if model else []) + [program, str(out)]
    environment = dict(os.environ, OMP_NUM_THREADS="1", **(LIBM_WITHOUT_FMA if without_fma else {}))
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{name} failed ({done.returncode}):\n{done.stdout}{done.stderr}")
    return Run(name, out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--qemu", default="qemu-x86_64", help="empty or ...-NOTFOUND: not there")
    parser.add_argument("--program", required=True, help="avianlidarInstructionSets")
    arguments = parser.parse_args()
    if not has_avx2(arguments.qemu):
        print(f"skipped: this needs qemu-x86_64 7.2 or later (package qemu-user), found: {arguments.qemu or 'none'}")
        return SKIPPED

    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        runs = list(pool.map(lambda number: start(arguments.program, arguments.qemu, pathlib.Path(folder), number),
                             range(len(RUNS))))
    errors = []
    here = set_of_this_processor()
    if here is None:
        print("the loader does not say what this processor has: any choice for it is right")
    for run, (_, _, _, expected) in zip(runs, RUNS):
        print(f"{run.name}: {run.instruction_set}, libm {run.libm}")
        expected = expected or here
        if expected and run.instruction_set != expected:
            errors.append(f"{run.name} took {run.instruction_set}, not {expected}")
    counts = [f"{runs[0].count(kind):,} {kind}" for kind in ("tree", "hits", "echoes", "beams")]
    print("in each run, rows of: " + ", ".join(counts))

    groups = {}
    for run in runs:
        groups.setdefault(run.libm, []).append(run)
    sets = {run.instruction_set for run in runs}
    base = next(run for run in runs if run.name == "Nehalem")
    compared = {run.instruction_set for run in groups[base.libm]}
    if compared != sets:
        errors.append(f"bits of {sorted(sets - compared)} were not compared with those of {base.instruction_set}: "
                          "libm differs")
    for group in groups.values():
        for one, two in [(group[0], run) for run in group[1:]] + [(base, group[0])] * (group[0].libm != base.libm):
            comparison = Comparison(one, two)
            libm = "same libm" if comparison.same_libm else "other libm"
            print(f"{one.name} ({one.instruction_set}), {two.name} ({two.instruction_set}), {libm}: "
                  + comparison.summary())
            errors += comparison.errors[:MOST_ERRORS]
    if "x86-64-v4" not in sets:
        print("not run: x86-64-v4 (AVX-512), which neither this processor nor qemu has")
    print("\n".join(errors) or f"good: {', '.join(sorted(sets))}")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
