#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the trade of speed for accuracy on the scenes of Documentation/results/accuracy.md and brings tables, words
and plots into the page.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/accuracy_speed/make_page.py
"""
import argparse
import csv
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import accuracy_speed  # noqa: E402
import trade_grid  # noqa: E402

DOCUMENTATION = HERE.parent.parent / "Documentation"
PAGE = DOCUMENTATION / "results" / "accuracy.md"

# Name in the page, arguments, which pictures the page shows; without any, its table is left out, too.
RUNS = (("airport16", ["airport", "--sensor", "airport16"], ("energy", "range", "detection")),
        ("airport32", ["airport", "--sensor", "airport32", "--seeds", "3", "--reference-rays", "15000"], ()),
        ("corridor", ["corridor"], ("energy",)))


def put(name, words):
    """Between the lines <!-- name --> and <!-- end --> of the page."""
    text = PAGE.read_text(encoding="utf-8")
    block = rf"(<!-- {name} -->\n).*?(<!-- end -->)"
    if not re.search(block, text, flags=re.S):
        sys.exit(f"{PAGE}: no place for {name}")
    PAGE.write_text(re.sub(block, lambda m: m[1] + words.strip() + "\n" + m[2], text, flags=re.S), encoding="utf-8")


def presets(folder):
    """Markdown: what each preset costs and how wrong it is, scene by scene."""
    tables = [rows(folder / name / "results.csv") for name, *_ in RUNS]
    lines = ["| preset | " + " | ".join(f"{t[0]['scene']}, {t[0]['sensor']}" for t in tables) + " |",
             "|---|" + "---|" * len(tables)]
    for preset in trade_grid.PRESETS:
        found = [next(row for row in table if row["setting"] == preset) for table in tables]
        lines.append(f"| `{preset}` | " + " | ".join(map(in_words, found)) + " |")
    return "\n".join(lines)


def joined(folder, part):
    """The tables of all scenes below one another, with the scene in front."""
    lines = []
    for name, *_ in RUNS:
        subject = rows(folder / name / "results.csv")[0]
        head, line, *body = (folder / name / f"{part}.md").read_text(encoding="utf-8").strip().split("\n")
        lines += [] if lines else [f"| scene {head}", f"|---{line}"]
        lines += [f"| {subject['scene']}, {subject['sensor']} {row}" for row in body]
    return "\n".join(lines)


def rows(file):
    with open(file, encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def in_words(row):
    def value(name, factor=1):
        return f"{factor * float(row[name]):.2g}"

    def energy(kind):
        return value(f"energy {kind} error with missed as -1 [1]", 100)

    bound = "" if float(row["energy error told by the reference [1]"]) else "≤ "
    return (f"{value('time of one core [s]')} s, {float(row['rays traced per beam [1]']):.0f} rays a beam; energy "
            f"{bound}{energy('rms')} % (median {energy('median')} %), range "
            f"{value('range rms error [m]', 1000)} mm, {value('missed and false of the true [1]', 100)} % missed or false")


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/accuracy_speed"), help="of the results")
    parser.add_argument("--scenes", nargs="*", choices=[name for name, *_ in RUNS], default=[name for name, *_ in RUNS],
                        help="measure only these, and take the others from an earlier run; default: all")
    options = parser.parse_args(argv)
    for name, arguments, _ in RUNS:
        if name in options.scenes:
            accuracy_speed.main([*arguments, "--out", str(options.out / name)])
    missing = [name for name, *_ in RUNS if not (options.out / name / "results.csv").exists()]
    if missing:
        print(f"The page stays as it is: not measured yet: {', '.join(missing)}")
        return
    put("trade presets", presets(options.out))
    put("trade advice", joined(options.out, "advice"))
    put("trade rates", joined(options.out, "rates"))
    for name, _, pictures in RUNS:
        for part in ("head", "table") if pictures else ("head",):
            put(f"trade {part}: {name}", (options.out / name / f"{part}.md").read_text(encoding="utf-8"))
        for kind in pictures:
            target = DOCUMENTATION / "images" / f"accuracy-{name}-{kind}.png"
            shutil.copyfile(options.out / name / f"{kind}.png", target)


if __name__ == "__main__":
    main()
