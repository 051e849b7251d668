#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The arithmetic that results rely on: no compiler may fuse, reorder or approximate, anywhere.

Every file that the build compiles has -ffp-contract=off, as the last word on contraction, and no flag that lets the
compiler choose otherwise; no source turns that round again, or asks for a fused multiply-add of its own outside the
places that are known to be sound."""
import argparse
import json
import pathlib
import re
import sys

FORBIDDEN = re.compile(r"-(ffast-math|Ofast|funsafe-math-optimizations|fassociative-math|freciprocal-math|"
                       r"ffinite-math-only|fno-signed-zeros|fno-rounding-math|mfma|march=\S+|mtune=native|"
                       r"mfpmath=387)$")
IN_SOURCE = re.compile(r"FP_CONTRACT|fast-math|associative-math|float_control|optimize\s*\(")
# std::fma is the same on every machine and written where it is meant. Highway's MulAdd is fused or not as the machine
# has it: only for what decides where to look.
EXPLICIT = {
    r"std::fma\(": {"TriangleTest.h", "RangeLanes.cxx"},
    r"\b(Neg)?Mul(Add|Sub)\(": {"BoxTests.cxx", "RayPacketTriangles.cxx"},
}


def wrong_flags(entry):
    """What is wrong with one compilation."""
    words = entry.get("arguments") or entry["command"].split()
    contraction = [word for word in words if word.startswith("-ffp-contract=")]
    if not contraction or contraction[-1] != "-ffp-contract=off":
        yield "not compiled with -ffp-contract=off"
    for word in words:
        if FORBIDDEN.match(word):
            yield f"compiled with {word}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True, type=pathlib.Path)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    errors = []
    looked_at = 0
    for entry in json.loads((arguments.build / "compile_commands.json").read_text()):
        file = pathlib.Path(entry["directory"], entry["file"]).resolve()
        # Generated code (wrappers of VTK's) computes nothing; "Unity" holds several sources each.
        together = file.parent.name == "Unity"
        if arguments.source.resolve() not in file.parents or arguments.build.resolve() in file.parents and not together:
            continue
        looked_at += file.read_text().count("#include") if together else 1
        errors += [f"{file}: {what}" for what in wrong_flags(entry)]
    sources = [p for folder in ("Filters", "IO") for p in (arguments.source / folder).rglob("*.[hc]*")]
    for path in sources:
        text = path.read_text()
        code = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)
        if IN_SOURCE.search(code):
            errors.append(f"{path}: floating-point semantics changed in the source")
        for pattern, allowed in EXPLICIT.items():
            if re.search(pattern, code) and path.name not in allowed:
                errors.append(f"{path}: {pattern} in a new place: may results depend on it?")
    print(f"{looked_at} compiled sources, {len(sources)} sources")
    print("\n".join(errors))
    return 1 if errors or looked_at < 50 or len(sources) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
