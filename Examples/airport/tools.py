# SPDX-License-Identifier: BSD-3-Clause
"""Common functions of the examples: arguments, errors in one line, the table of a scan, and pictures by Matplotlib."""
import argparse
import contextlib
import csv
import math
import os
import pathlib
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges, vtkTriangleFilter

import avianlidar as al
from avianlidar._cloud import triangles_of
from avianlidar._look import GROUND, class_colour
from avianlidar._pipeline import update
from avianlidar._plot import fonts, shortened

LARGEST = sys.float_info.max
STATUS = ("with echoes below saturation", "that meet nothing", "too weak to be perceived", "saturated",
          "that meet things outside the gate only")


class Parser(argparse.ArgumentParser):
    """Reports a bad argument in one line, with the exit code 2."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {message} (see --help)\n")


def number(kind, low, high=LARGEST):
    """The type of an argument that is an int or a float from low to high."""
    def convert(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"expected {kind.__name__} from {low:g} to {high:g}, not '{text}'")
        return value
    return convert


above_zero, finite = number(float, sys.float_info.min), number(float, -LARGEST)


def file(text):
    """The type of an argument that is a readable file."""
    if not os.path.isfile(text) or not os.access(text, os.R_OK):
        raise argparse.ArgumentTypeError(f"there is no file {text} to read")
    return pathlib.Path(text)


def add_arguments(parser, out):
    """Adds the arguments of all scans."""
    parser.add_argument("--rays", type=number(int, 1, 1000000), default=100, help="rays per beam, default 100")
    parser.add_argument("--seed", type=number(int, -2**31, 2**31 - 1), default=0,
                        help="seed of the random numbers, default 0")
    parser.add_argument("--threads", type=number(int, 0, 4096), default=0,
                        help="number of threads, default 0: one for each core")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(out),
                        help=f"folder for results, default {out}")
    parser.add_argument("--paper", action="store_true",
                        help="use the method and the tree of the paper (presets Paper) with 100 rays instead of --rays")
    parser.add_argument("--no-pictures", action="store_true", help="write only files and tables")


def preset(options):
    """The name of the scan's preset."""
    return "Paper" if options.paper else "Custom"


def run(work):
    """Returns the result of the work. An error ends the script with one line and the exit code 1."""
    try:
        return work()
    except (al.Error, OSError, ValueError) as error:
        sys.exit(" ".join(str(error).split()))


class Clock:
    """Measures the wall time of each stage, s: with clock("read"): ..."""

    def __init__(self, before=()):
        self.seconds = dict(before)

    @contextlib.contextmanager
    def __call__(self, stage):
        start = time.perf_counter()
        yield
        self.seconds[stage] = time.perf_counter() - start

    def rows(self):
        return [(f"{stage} (s)", f"{seconds:.3f}") for stage, seconds in self.seconds.items()]


def strings(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())] if array else []


def counts(tree, echoes, lidar):
    """The rows of a scan's table with counts and shares."""
    beams, points = lidar.GetOutput(1), echoes.GetPointData()
    status = vtk_to_numpy(beams.GetPointData().GetArray("status"))
    rays = int(beams.GetFieldData().GetArray("rays_per_beam").GetValue(0))
    energy, secondary = (vtk_to_numpy(points.GetArray(name)) for name in ("return_energy", "secondary_share"))
    return [("triangles", tree.GetOutput().GetNumberOfPolys()), ("beams", len(status)),
            *((f"- {name}", int((status == i).sum())) for i, name in enumerate(STATUS)),
            ("rays emitted", len(status) * rays), ("rays traced", int(lidar.GetNumberOfTracedRays())),
            ("echoes", echoes.GetNumberOfPoints()),
            ("secondary share of the energy", f"{100 * (secondary @ energy) / max(energy.sum(), 1e-300):.2f} %"),
            ("ghosts (mostly secondary)", int((secondary > 0.5).sum()))]


def hue_of(name, echoes):
    """The row with the median hue of an object's echoes. Without the object in the scene there is no row."""
    known = strings(echoes, "object_names")
    if name not in known:
        return []
    ids, hues = (vtk_to_numpy(echoes.GetPointData().GetArray(array)) for array in ("object_id", "hue"))
    hues = hues[ids == known.index(name)]
    return [(f"median hue of {name} (deg)", f"{np.median(hues):.0f}" if len(hues) else "none")]


def columns(of):
    """Head and rows of a table from {column: [(label, value)]}. All columns have the same labels."""
    return ("", *of), [(rows[0][0], *(row[1] for row in rows)) for rows in zip(*of.values())]


def markdown(head, rows, left=1):
    """A table in Markdown. The first `left` columns are flush left, and the next columns are flush right."""
    rule = ["---" if i < left else "---:" for i in range(len(head))]
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in (head, rule, *rows)) + "\n"


def leave(folder, name, head, rows, left=1):
    """Writes a table as <name>.md and <name>.csv, and prints the table."""
    folder.mkdir(parents=True, exist_ok=True)
    text = markdown(head, rows, left)
    (folder / f"{name}.md").write_text(text, encoding="utf-8")
    with open(folder / f"{name}.csv", "w", newline="", encoding="utf-8") as stream:
        csv.writer(stream).writerows([head, *rows])
    print(text)


@contextlib.contextmanager
def figure(name, *shape, figsize, dpi=100, **options):
    """Writes a picture with axes from `subplots`: with figure("map.png", 1, 2, figsize=(9, 4)) as axes: ..."""
    from matplotlib.figure import Figure
    pathlib.Path(name).parent.mkdir(parents=True, exist_ok=True)
    page = Figure(figsize, layout="constrained")
    yield page.subplots(*shape, **options)
    page.savefig(name, dpi=dpi)


def edges(surfaces, angle=20):
    """The lines where faces end, or where faces meet at more than this angle (deg)."""
    triangles, clean, found = vtkTriangleFilter(), vtkCleanPolyData(), vtkFeatureEdges()
    triangles.SetInputData(surfaces)
    clean.SetInputConnection(triangles.GetOutputPort())
    found.SetInputConnection(clean.GetOutputPort())
    found.SetFeatureAngle(angle)
    found.ColoringOff()
    update(found)
    return found.GetOutput()


def plan(axes, scene):
    """Draws blocks from above: in the colours of their classes, buildings over the ground, or without classes as their
    edges. The ground is the background."""
    from matplotlib.collections import LineCollection, PolyCollection
    kinds = strings(scene, "object_classes") or [""] * scene.GetNumberOfBlocks()
    for number, kind in enumerate(kinds):
        block = scene.GetBlock(number)
        if kind == "ground":
            axes.set_facecolor(class_colour(kind))
        elif kind and block and block.GetNumberOfCells():
            points, cells = triangles_of(block)
            axes.add_collection(PolyCollection(
                points[cells][:, :, :2], facecolors=class_colour(kind), edgecolors=class_colour(kind), linewidths=0.7,
                zorder=GROUND.index(kind) / len(GROUND) if kind in GROUND else 1))
        elif block and (lines := edges(block, 40)).GetNumberOfCells():
            cells = vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2)
            axes.add_collection(LineCollection(vtk_to_numpy(lines.GetPoints().GetData())[cells, :2], colors="black",
                                               linewidths=0.7))


def landmarks(axes, scan, limits):
    """Draws rings of equal range with their ranges, and names of runway ends and buildings."""
    made = al.vtkAvianLidar.vtkAvianLidarLandmarks()
    made.SetInputDataObject(0, scan.sensor.beams.data)
    made.SetInputDataObject(1, scan.scene.tree.GetOutput())
    (west, east), (south, north) = limits
    least = max(east - west, north - south) / 12
    spacings = (size * 10.0**power for power in range(-3, 9) for size in (1, 2, 5))
    made.SetRingSpacing(next(spacing for spacing in spacings if spacing > least))
    update(made)
    for ring in np.split(vtk_to_numpy(made.GetOutput(0).GetPoints().GetData()), made.GetNumberOfRings()):
        axes.plot(*np.vstack([ring, ring[:1]])[:, :2].T, color="0.35", linewidth=0.6, zorder=2)
    for output in (made.GetOutput(1), made.GetOutput(2)):
        texts = output.GetPointData().GetAbstractArray("name")
        for i in range(output.GetNumberOfPoints()):
            x, y, _ = output.GetPoint(i)
            if not (west < x < east and 0.02 < (y - south) / (north - south) < 0.98):
                continue
            side = ("left", "center", "center", "right")[int(np.clip(4 * (x - west) / (east - west), 0, 3))]
            axes.text(x, y, shortened(texts.GetValue(i)), ha=side, va="center", fontsize=8, clip_on=True, zorder=5,
                      parse_math=False, family=fonts(), bbox={"facecolor": "white", "alpha": 0.6, "linewidth": 0, "pad": 1})


def around(points, margin):
    """Limits of x and y around points, with a margin that is the share `margin` of their extent."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    grow = margin * (high - low).max() or 100.0
    return tuple(np.column_stack([low - grow, high + grow]))


def shape(limits, side=8.0):
    """Size of a picture, inches, for a map with these limits, whose longer side is `side`, and a legend."""
    width, height = (high - low for low, high in limits)
    return side * min(1.0, width / height) + 2.2, side * min(1.0, height / width) + 1.0


def extent(scene, echoes, margin=0.03):
    """Limits around the lidar, the echoes, and all objects except the ground within the range gate."""
    lidar, gate = np.array(echoes.fields["position"]), echoes.fields["range_gate"]
    kinds = strings(scene, "object_classes") or [""] * scene.GetNumberOfBlocks()
    blocks = [scene.GetBlock(i) for i, kind in enumerate(kinds) if kind != "ground"]
    clouds = [one.GetPoints().GetData() for one in blocks if one and one.GetNumberOfPoints()]
    points = np.vstack([lidar, *map(vtk_to_numpy, clouds)])
    near = (abs(points[:, :2] - lidar[:2]) <= gate).all(axis=1)
    return around(np.vstack([points[near], echoes.points]), margin)


def from_above(axes, scene, echoes, limits, title, size=6, legend=True, scan=None):
    """Draws echoes over the plan in the colours of their energy, the strongest on top, and the lidar as a red plus; with
    rings of range and names if the scan is given. Returns the dots, for a legend that several plans share."""
    plan(axes, scene)
    if scan:
        landmarks(axes, scan, limits)
    order = np.argsort(echoes["energy"])
    low, high = (1e6 * echoes.fields[name] for name in ("lower_energy_limit", "upper_energy_limit"))
    dots = axes.scatter(*echoes.points[order, :2].T, s=size, c=1e6 * echoes["energy"][order], cmap=al.hue_colors(),
                        vmin=low, vmax=high, linewidths=0, zorder=3)
    axes.plot(*echoes.fields["position"][:2], "r+", markersize=12, markeredgewidth=2.5, zorder=4)
    (west, east), (south, north) = limits
    shown = ((echoes.points[:, :2] >= (west, south)) & (echoes.points[:, :2] <= (east, north))).all(axis=1).sum()
    axes.set(xlim=(west, east), ylim=(south, north), aspect="equal", xlabel="east (m)", ylabel="north (m)")
    axes.set_title(f"{title}: {shown} of {len(order)} echoes", loc="left", fontsize=10, wrap=True)
    if legend:
        axes.figure.colorbar(dots, ax=axes, label="energy (µJ)", shrink=0.6)
    return dots


def range_images(name, scan, title):
    """Draws range and energy of a scan over azimuth and elevation."""
    with figure(name, 2, 1, figsize=(13, 5)) as axes:
        scan.plot_range_image("distance_m", axes[0], cmap="gray")
        scan.plot_range_image("energy", axes[1])
        axes[0].set_title(f"{title}: {scan.echoes.number_of_points} echoes", loc="left")
