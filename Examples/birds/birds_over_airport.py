#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which birds does a search lidar see over an airport? Scans a scenario of birds and clutter, and writes the pictures
from-above.png of successive scans and range.png of the first scan, and the table birds-over-airport.md, which counts
the birds by status.

    birds_over_airport.py --out build/birds-over-airport
    birds_over_airport.py --scans 20 --no-pictures

PYTHONPATH must contain the folder of the Python package (`cat build/paraview/python-path`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
from avianlidar._look import species_colours
from avianlidar.apps.sequences._simulation import TRUTH

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "airport"))
import tools  # noqa: E402

PALE = 0.55  # opacity of paths
CLUTTER = "0.35"
STATUSES = ("seen", "missed", "too weak", "hidden", "outside")
HALF = 550.0  # half of the width of the view from above, m


def arguments(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scenario", type=tools.file, default=HERE.parent / "sequence" / "hongqiao.scenario.json",
                        help="scenario file, default: birds over Shanghai Hongqiao")
    parser.add_argument("--scans", type=tools.number(int, 1, 100000), default=200,
                        help="number of all scans, default 200")
    parser.add_argument("--shown", type=tools.number(int, 1, 1000), default=20,
                        help="number of successive scans in from-above.png, default 20; later scans have other birds")
    parser.add_argument("--seed", type=tools.number(int, -2**31, 2**31 - 1),
                        help="seed, default: the seed of the scenario")
    parser.add_argument("--threads", type=tools.number(int, 0, 4096), default=0,
                        help="number of threads, default 0: one for each core")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/birds-over-airport"),
                        help="folder for results")
    parser.add_argument("--no-pictures", action="store_true", help="write only the table")
    return parser.parse_args(argv)


def run(options):
    """Scans the scenario, and draws the range image of the first scan. @return a dictionary of the data of the table
    and of the picture from above"""
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
                end = len(sequence.span(0)) * seconds
                first = {"species": species, "trails": trails(scan.movers, species, end)}
                if not options.no_pictures:
                    with tools.figure(options.out / "range.png", figsize=(10, 3.4)) as axes:
                        scan.plot_range_image("energy", axes=axes)
    truth = {name: np.array([row[TRUTH.index(name)] for row in rows]) for name in ("species", "status")}
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
    rows = [(name, *(int((of & (truth["status"] == status)).sum()) for status in STATUSES)) for name, of in found]
    return ("a bird in a scan", *STATUSES), rows


def draw_from_above(made, file):
    """Draws echoes and paths of the birds in the shown scans, and the clutter of the first scan."""
    sequence, species, first = made["sequence"], made["species"], made["echoes"][0]
    x, y, _ = first.fields["position"]
    limits = (x - HALF, x + HALF), (y - HALF, y + HALF)
    with tools.figure(file, figsize=tools.shape(limits)) as axes:
        tools.plan(axes, al.Scene(sequence.scenario["scene"]).surfaces.GetBlock(0))
        clutter = np.flatnonzero(~np.isin(first["object_id"], list(species)))
        axes.scatter(*first.points[clutter, :2].T, s=3, color=CLUTTER, label="clutter")
        colours = species_colours(made["trails"])
        for name, ways in made["trails"].items():
            for way in ways:
                axes.plot(*way.T, color=colours[name], alpha=PALE, linewidth=0.8)
            own = [bird for bird, its in species.items() if its == name]
            places = np.concatenate([echoes.points[np.isin(echoes["object_id"], own)] for echoes in made["echoes"]])
            axes.plot(*places[:, :2].T, "o", color=colours[name], markersize=4, label=f"{name}: {len(places)}",
                      zorder=3)
        axes.plot(x, y, "r+", markersize=12, markeredgewidth=2.5, zorder=4)
        scans = len(made["echoes"])
        axes.set(xlim=limits[0], ylim=limits[1], aspect="equal", xlabel="east (m)", ylabel="north (m)")
        axes.set_title(f"{scans} scans in {scans / sequence.sensor.rotation_rate:g} s: points and paths of birds, "
                       "and clutter of the first scan", loc="left")
        axes.legend(loc="upper left", title="points")


def main(argv=None):
    options = arguments(argv)
    made = run(options)
    tools.leave(options.out, "birds-over-airport", *table_of(made["truth"]))
    if not options.no_pictures:
        draw_from_above(made, options.out / "from-above.png")
    return made


if __name__ == "__main__":
    main()
