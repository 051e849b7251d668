#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which birds does a search lidar see over an airport? Scans a scenario of birds and clutter, and writes three pictures and
a table. The pictures are from-above.png (successive scans), range-image.png (one scan) and points.png (points of a bird
against its range). The table birds-over-airport.md counts the birds by status.

    birds_over_airport.py --out build/birds-over-airport
    birds_over_airport.py --scans 20 --no-pictures

PYTHONPATH must contain the folder of the Python package (`cat build/paraview/python-path`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
from avianlidar.apps._simulation import TRUTH

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "airport"))
import tools  # noqa: E402

COLORS = {"herring gull": (204, 0, 102), "crow": (0, 0, 0), "kestrel": (230, 97, 0), "Canada goose": (0, 125, 80),
          "starling": (120, 60, 200), "pigeon": (0, 110, 190)}
OTHER = (110, 70, 30)  # colour of other species
PALE = 0.55  # share of the clutter's colours in a mixture with white
STATUSES = ("seen", "missed", "too weak", "hidden", "outside")
HALF = 550.0  # half of the width of the view from above, m
BIN = 50.0  # width of a range bin of the curves, m
FAR = 1200.0  # end of the grey scale, m
FEWEST = 20  # least number of birds in a bin of the curves


def arguments(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scenario", type=tools.file, default=HERE.parent / "sequence" / "hongqiao.scenario.json",
                        help="scenario file, default: birds over Shanghai Hongqiao")
    parser.add_argument("--scans", type=tools.number(int, 1, 100000), default=200, help="number of all scans, default 200")
    parser.add_argument("--shown", type=tools.number(int, 1, 1000), default=20,
                        help="number of successive scans in from-above.png, default 20; later scans have other birds")
    parser.add_argument("--seed", type=tools.number(int, -2**31, 2**31 - 1), help="seed, default: the seed of the scenario")
    parser.add_argument("--threads", type=tools.number(int, 0, 4096), default=0, help="number of threads, default 0: one for each core")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/birds-over-airport"),
                        help="folder for results")
    parser.add_argument("--no-pictures", action="store_true", help="write only the table")
    return parser.parse_args(argv)


def run(options):
    """Scans the scenario. @return a dictionary of the data of the table and the pictures"""
    changes = {} if options.seed is None else {"seed": options.seed}
    sequence = al.Sequence(options.scenario, threads=options.threads, number_of_scans=options.scans,
                           scans_per_sequence=options.shown, **changes)
    rows, echoes, first, seconds = [], [], None, 1 / sequence.sensor.rotation_rate
    for number in range(len(sequence)):
        for k, scan, species in sequence.frames(number):
            rows += sequence.truth(k, species)
            if number == 0:
                echoes.append(scan.echoes)
            if k == 0:
                first = {"image": {name: np.array(scan.range_image()[name]) for name in
                                   ("distance_m", "column_azimuths", "row_elevations")},
                         "species": species, "trails": trails(scan.movers, species, len(sequence.span(0)) * seconds)}
    truth = {name: [row[i] for row in rows] for i, name in enumerate(TRUTH)}
    for name in ("range_m", "azimuth_deg", "elevation_deg", "expected_probability"):
        truth[name] = np.array([float(value) if value != "" else np.nan for value in truth[name]])
    for name in ("scan", "points"):
        truth[name] = np.array(truth[name], int)
    for name in ("species", "status"):
        truth[name] = np.array(truth[name])
    return {"sequence": sequence, "truth": truth, "echoes": echoes, **first}


def trails(movers, species, end):
    """Paths of birds from the start to the end of the scans: {species: [rows of x and y, m]}."""
    found = {}
    for k in range(movers.GetNumberOfBlocks()):
        block = movers.GetBlock(k)
        name = species.get(int(block.GetCellData().GetArray("object_id").GetTuple1(0)))
        if name is None:
            continue
        fields = block.GetFieldData()
        times, places = (vtk_to_numpy(fields.GetArray("pose_" + what)) for what in ("time", "position"))
        at = np.unique(np.clip(np.concatenate([times, [0, end]]), max(0, times[0]), min(end, times[-1])))
        found.setdefault(name, []).append(np.stack([np.interp(at, times, places[:, i]) for i in (0, 1)], axis=1))
    return found


def table_of(truth):
    """Head and rows of the table: number of scanned birds by species and status."""
    found = [(name, truth["species"] == name) for name in sorted(set(truth["species"]))] + [("all", True)]
    return ("a bird in a scan", *STATUSES), [(name, *(int((of & (truth["status"] == s)).sum()) for s in STATUSES)) for name, of in found]


def colour_of(name):
    return np.array(COLORS.get(name, OTHER)) / 255


def draw_from_above(made, file):
    """Draws echoes and paths of the birds in the shown scans, and the clutter of the first scan."""
    from matplotlib.colors import ListedColormap, LogNorm
    sequence, species, first = made["sequence"], made["species"], made["echoes"][0]
    pale = ListedColormap(1 - PALE * (1 - al.hue_colors()(np.linspace(0, 1, 256))))
    low, high = (1e6 * first.fields[name] for name in ("lower_energy_limit", "upper_energy_limit"))
    with tools.figure(file, figsize=(11, 9)) as axes:
        tools.plan(axes, al.Scene(sequence.scenario["scene"]).surfaces.GetBlock(0), "0.6")
        clutter = np.flatnonzero(~np.isin(first["object_id"], list(species)))
        clutter = clutter[np.argsort(first["energy"][clutter])]
        dots = axes.scatter(*first.points[clutter, :2].T, s=3, c=1e6 * first["energy"][clutter], cmap=pale, norm=LogNorm(low, high))
        for name, ways in made["trails"].items():
            for way in ways:
                axes.plot(*way.T, color=1 - PALE * (1 - colour_of(name)), linewidth=0.8)
            own = [bird for bird, its in species.items() if its == name]
            places = np.concatenate([echoes.points[np.isin(echoes["object_id"], own)] for echoes in made["echoes"]])
            axes.plot(*places[:, :2].T, "o", color=colour_of(name), markersize=4, label=f"{name}: {len(places)}", zorder=3)
        x, y, _ = first.fields["position"]
        axes.plot(x, y, "r+", markersize=12, markeredgewidth=2.5, zorder=4)
        scans = len(made["echoes"])
        axes.set(xlim=(x - HALF, x + HALF), ylim=(y - HALF, y + HALF), aspect="equal", xlabel="east (m)", ylabel="north (m)")
        axes.set_title(f"{scans} scans in {scans / sequence.sensor.rotation_rate:g} s: points and paths of birds, "
                       "and clutter of the first scan", loc="left")
        axes.legend(loc="upper left", title="points of birds")
        axes.figure.colorbar(dots, ax=axes, label="energy of clutter (µJ)", shrink=0.6)


def draw_range_image(made, file):
    """Draws the range of every beam of the first scan, and the birds."""
    from matplotlib.colors import ListedColormap
    image, truth = made["image"], made["truth"]
    azimuths, elevations = image["column_azimuths"], image["row_elevations"]
    greys = ListedColormap(np.repeat(np.linspace(0, 0.82, 256)[:, None], 3, axis=1))
    with tools.figure(file, 2, 1, figsize=(13, 5.6)) as axes:
        now = truth["scan"] == 0
        for axis, begin in zip(axes, (0, 180)):
            mesh = axis.pcolormesh(azimuths, elevations, np.ma.masked_invalid(image["distance_m"]), cmap=greys, vmin=0,
                                   vmax=FAR, shading="nearest", rasterized=True)
            for name in made["trails"]:
                of = now & (truth["species"] == name) & np.isfinite(truth["azimuth_deg"])
                color = colour_of(name)
                seen = of & (truth["status"] == "seen")
                axis.scatter(truth["azimuth_deg"][seen], truth["elevation_deg"][seen], s=42, color=[color], edgecolors="white",
                             linewidths=0.8, label=name, zorder=3)
                rest = of & ~seen
                axis.scatter(truth["azimuth_deg"][rest], truth["elevation_deg"][rest], s=38, facecolors="none",
                             edgecolors=[color], linewidths=1.4, zorder=3)
            step = azimuths[1] - azimuths[0]
            axis.set(xlim=(begin - step, begin + 180), ylim=(-0.6, elevations[-1] + 0.6), ylabel="elevation (deg)")
            axis.set_xticks(range(begin, begin + 181, 30))
        axes[0].scatter([], [], s=38, facecolors="none", edgecolors="grey", linewidths=1.4, label="not seen")
        axes[0].legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=len(made["trails"]) + 1, frameon=False)
        axes[1].set_xlabel("azimuth from north, clockwise (deg)")
        axes[0].figure.colorbar(mesh, ax=axes, label="range of the strongest echo (m)", shrink=0.8, extend="max")


def draw_points(made, file):
    """Draws points, share seen and expected share by range, for birds that are not hidden."""
    truth = made["truth"]
    free = np.isin(truth["status"], ("seen", "missed", "too weak"))
    with tools.figure(file, 1, 2, figsize=(12, 4.4)) as (left, right):
        for name in made["trails"]:
            of = free & (truth["species"] == name)
            color = colour_of(name)
            bins = np.floor(truth["range_m"][of] / BIN).astype(int)
            kept = [k for k in np.unique(bins) if (bins == k).sum() >= FEWEST and (k + 0.5) * BIN < 1000]
            at = [(k + 0.5) * BIN for k in kept]

            def means(values):
                return [values[of][bins == k].mean() for k in kept]
            left.plot(at, means(truth["points"]), marker="o", color=color, label=name)
            right.plot(at, means(truth["expected_probability"]), color=color)
            right.plot(at, means((truth["status"] == "seen").astype(float)), "o", color=color)
        left.set(xlabel="range (m)", ylabel="points of a bird in a scan, mean")
        right.set(xlabel="range (m)", ylabel="share of birds seen", ylim=(-0.03, 1.03))
        right.plot([], [], color="grey", label="expected")
        right.plot([], [], "o", color="grey", label="scanned")
        for axis in (left, right):
            axis.grid(alpha=0.3)
            axis.set_xlim(0, None)
            axis.legend()
        left.set_ylim(0, None)


def main(argv=None):
    options = arguments(argv)
    made = run(options)
    tools.leave(options.out, "birds-over-airport", *table_of(made["truth"]))
    if not options.no_pictures:
        draw_from_above(made, options.out / "from-above.png")
        draw_range_image(made, options.out / "range-image.png")
        draw_points(made, options.out / "points.png")
    return made


if __name__ == "__main__":
    main()
