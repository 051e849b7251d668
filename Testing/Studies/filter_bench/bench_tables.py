# SPDX-License-Identifier: BSD-3-Clause
"""The tables and the picture of Documentation/guide/filters.md from what `avianlidar bench` has written.

    Testing/Studies/run.py bench_tables
    Testing/Studies/run.py pages --from build/bench scores
"""
import tools
from running import rows_of, study

FILTERS = ("persistence", "trees-one-scan", "trees", "network-one-scan", "network")
PLACES = ("hongqiao", "honolulu", "neubrandenburg")
SETS = (*PLACES, *(f"{place}-rain" for place in PLACES))
TABLES = {"bench-iou": ("IoU", 1.0, 3), "bench-recall": ("recall at 1 false point a scan", 100.0, 1)}


@study(out="bench/scores")
def main(options):
    rows = [row for row in rows_of(options.out / "bench.csv") if row["by"] == "all"]
    scores = {(row["set"], row["predictions"], row["score"]): row for row in rows}
    for name, (score, factor, digits) in TABLES.items():
        tools.leave(options.out, name, ("", *(of.replace("-", ", ").capitalize() for of in SETS)), [
            (f"`{kind}`", *("{0:.{2}f} ± {1:.{2}f}".format(
                *(factor * float(scores[of, kind, score][key]) for key in ("value", "std_error")),
                digits) for of in SETS))
            for kind in FILTERS])
