#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The tables and the picture of Documentation/filters.md from what `avianlidar bench` has written.

    /usr/bin/python3 Examples/filter_bench/tables.py --out build/bench/scores
"""
import argparse
import csv
import pathlib

FILTERS = ("persistence", "trees-one-scan", "trees", "network-one-scan", "network")
PLACES = ("hongqiao", "honolulu", "neubrandenburg")
SETS = (*PLACES, *(f"{place}-rain" for place in PLACES))
TABLES = {"bench-iou": ("IoU", 1.0, 3), "bench-recall": ("recall at 1 false point a scan", 100.0, 1)}


def table(scores, score, factor, digits):
    """Markdown: a row for each filter, a column for each set; `factor` times value and standard error."""
    def cell(name, of):
        value, error = (factor * float(scores[of, name, score][key]) for key in ("value", "std_error"))
        return f"{value:.{digits}f} ± {error:.{digits}f}"
    lines = ["| | " + " | ".join(of.replace("-", ", ").capitalize() for of in SETS) + " |", "|---|" + "---:|" * len(SETS)]
    lines += [f"| `{name}` | " + " | ".join(cell(name, of) for of in SETS) + " |" for name in FILTERS]
    return "\n".join(lines) + "\n"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/bench/scores"), help="folder of bench.csv, default build/bench/scores")
    options = parser.parse_args(arguments)
    with open(options.out / "bench.csv", newline="", encoding="utf-8") as stream:
        scores = {(row["set"], row["predictions"], row["score"]): row for row in csv.DictReader(stream) if row["by"] == "all"}
    for name, what in TABLES.items():
        text = table(scores, *what)
        (options.out / f"{name}.md").write_text(text, encoding="utf-8")
        print(text)


if __name__ == "__main__":
    main()
