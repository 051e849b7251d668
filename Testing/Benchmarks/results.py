# SPDX-License-Identifier: BSD-3-Clause
"""CSV files of the benchmarks, and what their tables are made of."""
import csv
import math
import pathlib


def read(folder, name):
    """The rows of one CSV file as dictionaries, numbers as numbers; [] if it is not there."""
    file = pathlib.Path(folder) / f"{name}.csv"
    if not file.exists():
        return []

    def value(text):
        try:
            return float(text)
        except ValueError:
            return text

    with open(file, newline="", encoding="utf-8") as stream:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(stream)]


def table(header, rows, words=False):
    """Markdown; numbers to the right, words to the left."""
    lines = ["| " + " | ".join(header) + " |", "|---|" + ("---|" if words else "---:|") * (len(header) - 1)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def count(number):
    return f"{int(number):,}"


def seconds(value):
    """Three digits with a unit that fits."""
    if value == "":
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if value >= size:
            break
    return f"{value / size:.3g} {unit}" if value < 1000 else f"{value:,.0f} s"


def fit(xs, ys):
    """Slope, intercept and R^2 of a straight line."""
    n, mx, my = len(xs), sum(xs) / len(xs), sum(ys) / len(ys)
    sxx = sum((x - mx) ** 2 for x in xs)
    sxy = sum((x - mx) * (y - my) for x, y in zip(xs, ys))
    syy = sum((y - my) ** 2 for y in ys)
    slope = sxy / sxx if n > 1 and sxx > 0 else math.nan
    return slope, my - slope * mx, sxy * sxy / (sxx * syy) if sxx > 0 and syy > 0 else math.nan


def ratio_text(ratio):
    return f"**{ratio:.2f}**" if ratio < 1.0 else f"{ratio:.1f}" if ratio < 10 else f"{ratio:.0f}"
