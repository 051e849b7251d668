# SPDX-License-Identifier: BSD-3-Clause
"""Times, progress and tables of the examples."""
import contextlib
import csv
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy


class Clock:
    """with clock("read"): ...   keeps the wall time of each stage."""

    def __init__(self, before=()):
        self.seconds = dict(before)

    @contextlib.contextmanager
    def __call__(self, stage):
        start = time.perf_counter()
        yield
        self.seconds[stage] = time.perf_counter() - start

    def rows(self):
        return [(f"{stage} (s)", f"{seconds:.3f}") for stage, seconds in self.seconds.items()]


def show_progress(algorithm, name):
    """Print the progress in steps of ten per cent, to the error stream."""
    shown = [-1]

    def show(caller, _):
        tenth = int(10 * caller.GetProgress() + 1e-9)
        if tenth > shown[0]:
            shown[0] = tenth
            print(f"{name}: {10 * tenth} %", file=sys.stderr, flush=True)

    algorithm.AddObserver("ProgressEvent", show)


def counts(tree, echoes, lidar):
    """The rows of the table that are not times."""
    state = vtk_to_numpy(lidar.GetOutput(1).GetPointData().GetArray("status"))
    energy = vtk_to_numpy(echoes.GetPointData().GetArray("return_energy"))
    secondary = vtk_to_numpy(echoes.GetPointData().GetArray("secondary_share"))
    status = ("with echoes below saturation", "that meet nothing", "too weak to be perceived", "saturated",
              "that meet things outside the gate only")
    rows = [("triangles", tree.GetOutput().GetNumberOfPolys()), ("beams", len(state)),
            *((f"  {name}", int((state == i).sum())) for i, name in enumerate(status)),
            ("rays emitted", len(state) * lidar.GetRaysPerBeam()), ("rays traced", int(lidar.GetNumberOfTracedRays())),
            ("echoes", echoes.GetNumberOfPoints()),
            ("secondary share of the energy", f"{100 * (secondary @ energy) / max(energy.sum(), 1e-300):.2f} %"),
            ("ghosts (mostly secondary)", int((secondary > 0.5).sum()))]
    return rows


def hue_of(name, echoes):
    """The row with the median hue of an object's echoes; no row if the scene has no such object."""
    names = echoes.GetFieldData().GetAbstractArray("object_names")
    known = [names.GetValue(i) for i in range(names.GetNumberOfValues())]
    if name not in known:
        return []
    ids, hues = (vtk_to_numpy(echoes.GetPointData().GetArray(array)) for array in ("object_id", "hue"))
    hues = hues[ids == known.index(name)]
    return [(f"median hue of {name} (deg)", f"{np.median(hues):.0f}" if len(hues) else "none")]


def table(columns):
    """Markdown: one column of values for each name; the rows have the same labels."""
    names = list(columns)
    rows = [["", *names], *([rows[0][0], *(str(r[1]) for r in rows)] for rows in zip(*columns.values()))]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]

    def line(row):
        label = row[0].replace("  ", "- ").ljust(widths[0])
        return "| " + " | ".join([label, *(c.rjust(w) for c, w in zip(row[1:], widths[1:]))]) + " |"

    rule = "|" + "|".join(["-" * (widths[0] + 2), *("-" * (w + 1) + ":" for w in widths[1:])]) + "|"
    return "\n".join([line(rows[0]), rule, *map(line, rows[1:])])


def write(folder, name, text):
    """A table of Markdown as <name>.md and, with the same cells, as <name>.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.md").write_text(text + "\n", encoding="utf-8")
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
    with open(folder / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([lines[0], *lines[2:]])


def write_csv(folder, name, rows):
    """Dictionaries with the same keys as <name>.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
