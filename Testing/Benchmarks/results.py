# SPDX-License-Identifier: BSD-3-Clause
"""CSV files of the benchmarks, and what their tables are made of."""
import csv
import math
import os
import pathlib
import platform
import re
import sys
import time

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "Documentation"))
import page_tables  # noqa: E402


def read(folder, name):
    """The rows of one CSV file as dictionaries, numbers as numbers; [] if it is not there."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text

    file = pathlib.Path(folder) / f"{name}.csv"
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(lines)]


def pivot(rows, group, column, cell):
    """{group of a row: {column of a row: its cell}}, in the order of the rows."""
    found = {}
    for r in rows:
        found.setdefault(group(r), {})[column(r)] = cell(r)
    return found


def columns_of(found):
    """The columns of a pivot, in the order in which they come first."""
    return list(dict.fromkeys(column for cells in found.values() for column in cells))


def table(header, rows, words=False):
    """Markdown; numbers to the right, words to the left."""
    lines = ["| " + " | ".join(header) + " |", "|---|" + ("---|" if words else "---:|") * (len(header) - 1)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def count(number):
    return f"{int(number):,}"


def seconds(value):
    """Three digits with a unit that fits."""
    unit, size = next((u for u in (("s", 1.0), ("ms", 1e-3)) if value >= u[1]), ("us", 1e-6))
    return f"{value / size:.3g} {unit}" if value < 1000 else f"{value:,.0f} s"


def fit(xs, ys):
    """Slope, intercept and R^2 of a straight line."""
    if len(xs) < 2 or max(xs) == min(xs):
        return math.nan, math.nan, math.nan
    return *np.polyfit(xs, ys, 1), np.corrcoef(xs, ys)[0, 1] ** 2


def ratio_text(ratio):
    return f"**{ratio:.2f}**" if ratio < 1.0 else f"{ratio:.1f}" if ratio < 10 else f"{ratio:.0f}"


def machine():
    """(what, is): processor, cores, instruction sets, memory, system, load, date."""
    info = dict(re.findall(r"^([^\t:]*?)\s*:\s*(.*)$", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M))
    flags = info.get("flags", "").split()
    sets = [s for s in ("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512bw", "avx512vl") if s in flags]
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    name, family, model = (info.get(key, "unknown") for key in ("model name", "cpu family", "model"))
    return [("processor", f"{name} (family {family}, model {model})"), ("cores", len(os.sched_getaffinity(0))),
            ("instruction sets", " ".join(sets)), ("memory", f"{memory:.0f} GiB"),
            ("system", platform.freedesktop_os_release().get("PRETTY_NAME", "")),
            ("load before the run", f"{os.getloadavg()[0]:.1f}"), ("date", time.strftime("%Y-%m-%d"))]


def put_into_pages(tables):
    """Tables that have a row into the pages and CSV files that have them, which are returned."""
    return {place for name, body in tables.items() if body.count("\n") > 2 for place in page_tables.put(name, body)}
