# SPDX-License-Identifier: BSD-3-Clause
"""Where is a bird detected at an airport? Maps, reasons, a section along an approach and shares, of two receivers side by side.

    coverage.py hongqiao.coverage.json --out build/coverage

For the plan's sensor and for the paper's receiver, Airport16: in a folder each what `avianlidar coverage` leaves (GeoTIFF, CSV,
clutter), and together maps.png, reasons.png, section.png and shares.csv.
"""
import argparse
import csv
import pathlib
import sys
import time

import matplotlib
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
from avianlidar._maps import Plan, read_plan

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.colors import BoundaryNorm, ListedColormap  # noqa: E402

PAPER = "Airport16"
# Of outside the gate, above, below, between beams, shadowed, in clutter, too weak, seen.
COLOURS = ["#f7f7f7", "#a6cee3", "#c6a982", "#f4e04d", "#4d4d5c", "#d95f02", "#cc99bb", "#1b9e77"]
BEYOND = 1500.0  # m, of the section, to either side of the sensor
HIGH = 160.0  # m


def plans(file, threads):
    """The plan with its own sensor and with the paper's, by name."""
    own = read_plan(file)
    sensor = {name: value for name, value in own["sensor"].items() if name in ("position", "orientation")}
    return {own["sensor"]["preset"]: Plan(own, threads), f"{PAPER} (the paper's)": Plan({**own, "sensor": {"preset": PAPER, **sensor}}, threads)}


def outlines(axes, plan):
    """Buildings and runways as seen from above."""
    surfaces = plan.scene.tree.GetOutput()
    box = plan.extent
    for runway in plan.runways:
        axes.plot(*np.transpose([runway.start, runway.end]), color="0.35", linewidth=2, solid_capstyle="butt", label="runway")
    points = vtk_to_numpy(surfaces.GetPoints().GetData())
    cells = vtk_to_numpy(surfaces.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    tall = points[cells][:, :, 2].min(axis=1) > 5.0  # roofs
    axes.tripcolor(points[:, 0], points[:, 1], cells[tall], facecolors=np.zeros(np.count_nonzero(tall)), cmap=ListedColormap(["0.25"]))
    axes.plot(*plan.sensor.position[:2], "r^", markersize=5)
    axes.set_xlim(box[0], box[1])
    axes.set_ylim(box[2], box[3])
    axes.set_aspect("equal")


def draw_maps(found, file, quantity):
    """A row for each receiver, a column for each height."""
    heights = next(iter(found.values())).heights
    figure, rows = plt.subplots(len(found), len(heights), figsize=(3.1 * len(heights) + 1.2, 3.2 * len(found) + 0.6), squeeze=False,
                                sharex=True, sharey=True, layout="constrained")
    for row, (name, plan) in zip(rows, found.items()):
        for axes, height in zip(row, heights):
            cover = plan.map_at(height)
            if quantity == "status":
                style = {"cmap": ListedColormap(COLOURS), "norm": BoundaryNorm(np.arange(9) - 0.5, 8)}
            else:
                style = {"cmap": "viridis", "vmin": 0.0, "vmax": 1.0}
            outlines(axes, plan)
            image = axes.imshow(cover[quantity][0], origin="lower", extent=plan.extent, alpha=0.85, interpolation="nearest", **style)
            axes.set_title(f"{name}, {height:g} m", fontsize=9)
            axes.tick_params(labelsize=7)
    species = next(iter(found.values())).coverage.species
    bar = figure.colorbar(image, ax=rows, shrink=0.8)
    if quantity == "status":
        bar.set_ticks(range(8), labels=plan.coverage.status_names)
    else:
        bar.set_label(f"probability that one scan detects a {species} (assumed: bird, receiver)")
    figure.supxlabel("m east", fontsize=9)
    figure.supylabel("m north", fontsize=9)
    figure.savefig(file, dpi=110)
    plt.close(figure)


def draw_section(found, file):
    """Along the runway nearest to the sensor, through the middle of its strip and the approaches, with a glide path of 3 degrees."""
    figure, rows = plt.subplots(len(found), 1, figsize=(10, 3.0 * len(found)), sharex=True, squeeze=False, layout="constrained")
    for (axes,), (name, plan) in zip(rows, found.items()):
        position = np.array(plan.sensor.position[:2])
        runway = min(plan.runways, key=lambda r: np.linalg.norm(0.5 * (np.array(r.start) + r.end) - position))
        axis, length = runway.axis()
        along = np.arange(-BEYOND, length + BEYOND, 10.0)
        heights = np.arange(0.0, HIGH + 1.0, 2.0)
        ground = np.asarray(runway.start) + along[:, None] * axis
        places = np.concatenate([np.column_stack([ground, np.full(len(along), z)]) for z in heights])
        cover = al.Coverage(plan.scene, plan.sensor, places=places, **plan.settings)
        p = cover["detection_probability"].reshape(len(heights), -1)
        image = axes.imshow(p, origin="lower", aspect="auto", extent=(along[0], along[-1], 0, HIGH), cmap="viridis", vmin=0, vmax=1)
        axes.plot([0, length], [0.5, 0.5], color="white", linewidth=3)
        for start, sign in ((0.0, -1.0), (length, 1.0)):
            axes.plot([start, start + sign * BEYOND], [15.0, 15.0 + np.tan(np.radians(3.0)) * BEYOND], "w--", linewidth=1)
        axes.set_title(f"{name}: section along {runway.name} (white), glide paths of 3 degrees (dashed)", fontsize=9)
        axes.set_ylabel("m above ground", fontsize=8)
        axes.set_xlim(along[0], along[-1])
        axes.set_ylim(0, HIGH)
    rows[-1][0].set_xlabel("m along the runway from its first end", fontsize=8)
    figure.colorbar(image, ax=rows, label="probability of one scan (assumed: bird, receiver)")
    figure.savefig(file, dpi=110)
    plt.close(figure)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan", type=pathlib.Path, nargs="?", default=pathlib.Path(__file__).with_name("hongqiao.coverage.json"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/coverage"))
    parser.add_argument("--threads", type=int, default=0)
    options = parser.parse_args(arguments)
    began = time.monotonic()
    try:
        found = plans(options.plan, options.threads)
        options.out.mkdir(parents=True, exist_ok=True)
        rows = []
        for name, plan in found.items():
            plan.write(options.out / name.split()[0])
            rows += [{"receiver": name, **row} for row in (plan.regions or plan.coverage).table]
    except (al.Error, ValueError, OSError) as error:
        print(f"coverage.py: {error}", file=sys.stderr)
        return 2
    with (options.out / "shares.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    draw_maps(found, options.out / "maps.png", "detection_probability")
    draw_maps(found, options.out / "reasons.png", "status")
    if next(iter(found.values())).runways:
        draw_section(found, options.out / "section.png")
    for row in rows:
        if row["region"] == "all" and row["height_from"] == -np.inf and row["species"] == plan.coverage.species:
            print(f"{row['receiver']}: {row['species']} detected in one scan at {row['detection_probability']:.3f} +- "
                  f"{row['detection_std_error']:.3f} of the places in strips and approaches")
    print(f"{time.monotonic() - began:.1f} s; files in {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
