#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which birds does a search lidar see over an airport? Scans a scenario of birds amid clutter and leaves three pictures,
from-above.png (some successive scans), range-image.png (one scan) and points.png (points of a bird against its range),
and a table of what became of the birds, birds-over-airport.md.

    birds_over_airport.py --out build/birds-over-airport
    birds_over_airport.py --scans 20 --no-pictures

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`), pictures need a display (`xvfb-run -a`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

import avianlidar as al
from avianlidar.apps._sequence import TRUTH

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common")]
import running  # noqa: E402

COLORS = {"herring gull": (204, 0, 102), "crow": (0, 0, 0), "kestrel": (230, 97, 0), "Canada goose": (0, 125, 80),
          "starling": (120, 60, 200), "pigeon": (0, 110, 190)}
OTHER = (110, 70, 30)  # another species
PALE = 0.55  # of the clutter's colours, the rest is white
STATUSES = ("seen", "missed", "too weak", "hidden", "outside")
HALF = 550.0  # m, half the width of the view from above
BIN = 50.0  # m
FAR = 1200.0  # m, the end of the grey scale
FEWEST = 20  # birds in a bin of the curves


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scenario", type=running.file, default=HERE.parent / "sequence" / "hongqiao.scenario.json",
                        help="default: birds over Shanghai Hongqiao")
    parser.add_argument("--scans", type=running.whole(1, 100000), default=200, help="in all, default 200")
    parser.add_argument("--shown", type=running.whole(1, 1000), default=20,
                        help="successive scans from above, default 20; after as many there are other birds")
    parser.add_argument("--seed", type=running.whole(-2**31, 2**31 - 1), help="default: that of the scenario")
    parser.add_argument("--threads", type=running.whole(0, 4096), default=0, help="default 0: as many as there are cores")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/birds-over-airport"),
                        help="folder for results")
    parser.add_argument("--no-pictures", action="store_true", help="needs no display")
    return running.parse(parser, argv)


def copy_of(output):
    copy = vtkPolyData()
    copy.DeepCopy(output)
    return copy


def run(options):
    """The scenario, scanned: a dictionary of what the table and the pictures need."""
    changes = {} if options.seed is None else {"seed": options.seed}
    sequence = al.Sequence(options.scenario, threads=options.threads, number_of_scans=options.scans,
                           scans_per_sequence=options.shown, **changes)
    rows, echoes, first, seconds = [], [], None, 1 / sequence.sensor.rotation_rate
    for number in range(len(sequence)):
        for k, scan, species in sequence.frames(number):
            rows += sequence.truth(k, species)
            if number == 0:
                echoes.append(copy_of(scan.algorithm.GetOutput(0)))
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
    """{species: [way of a bird from the begin of the scans to their end, rows of x and y]}."""
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
    """How often each species was what, as Markdown."""
    lines = ["| a bird in a scan | " + " | ".join(STATUSES) + " |", "|---|" + "---:|" * len(STATUSES)]
    known = sorted(set(truth["species"]))
    for name in [*known, "all"]:
        of = truth["species"] == name if name != "all" else np.ones(len(truth["species"]), bool)
        lines.append(f"| {name} | " + " | ".join(str(int((of & (truth["status"] == s)).sum())) for s in STATUSES) + " |")
    return "\n".join(lines) + "\n"


def lines_of(ways, height):
    """Ways as polylines."""
    lines, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    for way in ways:
        cells.InsertNextCell(len(way))
        for x, y in way:
            cells.InsertCellPoint(points.InsertNextPoint(x, y, height))
    lines.SetPoints(points)
    lines.SetLines(cells)
    return lines


def dots_of(places, rgb, height):
    """Points with the array `rgb`."""
    dots, points = vtkPolyData(), vtkPoints()
    places = np.array(places, float)
    places[:, 2] = height
    points.SetData(numpy_to_vtk(places, deep=True))
    dots.SetPoints(points)
    colors = numpy_to_vtk(np.ascontiguousarray(rgb, np.uint8), deep=True)
    colors.SetName("rgb")
    dots.GetPointData().AddArray(colors)
    return dots


def draw_from_above(made, options):
    """Birds' echoes of the shown scans, their ways, and the clutter of the first scan."""
    import pictures  # only here: numbers need no display
    import views

    class Wide(pictures.Picture):
        right = 220  # for the names of species

    sequence, species = made["sequence"], made["species"]
    x, y, _ = views.lidar_position(made["echoes"][0])
    bounds = (x - HALF, x + HALF, y - HALF, y + HALF)
    scans = len(made["echoes"])
    size = 1100
    picture = Wide("Birds over an airport, from above", "", size + Wide.right - Wide.above - Wide.below + Wide.left, size)
    for kind, shape in views.plan(running.read_scene(sequence.scenario["scene"]).GetOutput()):
        if kind in views.PAVED:
            picture.faces(shape, (0.96, 0.96, 0.96))
        else:
            picture.outlines(shape, (0.6, 0.6, 0.6))
    metres = picture.look_down(bounds)
    echoes = made["echoes"][0]
    of_bird = np.isin(vtk_to_numpy(echoes.GetPointData().GetArray("object_id")), list(species))
    energy = vtk_to_numpy(echoes.GetPointData().GetArray("energy"))[~of_bird]
    low, high = views.limits(echoes)

    def decibels(values, begin, end):
        return 255 - PALE * (255 - pictures.hue_colors(values, begin, end).astype(float))
    span = 10 * np.log10(high / low)
    order = np.argsort(energy)  # the strongest on top
    picture.dots(dots_of(views.places(echoes)[~of_bird][order], decibels(10 * np.log10(energy[order] / low), 0, span),
                         2000 + np.arange(len(order)) / max(len(order), 1)), 5 * metres)
    count = {}
    for name, ways in made["trails"].items():
        color = np.array(COLORS.get(name, OTHER)) / 255
        picture.outlines(lines_of(ways, 3000), tuple(0.45 + 0.55 * color), 1.5)
    for echoes in made["echoes"]:
        ids = vtk_to_numpy(echoes.GetPointData().GetArray("object_id"))
        for name in made["trails"]:
            places = views.places(echoes)[np.isin(ids, [bird for bird, its in species.items() if its == name])]
            count[name] = count.get(name, 0) + len(places)
            if len(places):
                picture.dots(dots_of(places, [COLORS.get(name, OTHER)] * len(places), 3500), 7 * metres)
    picture.lidar((x, y, 4000), 14 * metres)
    picture.subtitle(f"{scans} scans in {scans / sequence.sensor.rotation_rate:g} s; large dots: points of birds; lines: where "
                     "they flew; small dots: clutter of the first scan")
    left, top = picture.width - picture.right + 12, picture.height - picture.above - 50
    picture.text(left, top + 32, "points of birds:", 18, color=pictures.GREY)
    for k, name in enumerate(made["trails"]):
        color = np.array(COLORS.get(name, OTHER), np.uint8)
        picture.pixels(left, top - 30 * k - 6, np.broadcast_to(color, (12, 12, 3)).copy())
        picture.text(left + 20, top - 30 * k, f"{name}: {count[name]}", 18)
    picture.hue_bar(0, span, left + 8, 140, 380, lambda *what: decibels(*what).astype(np.uint8), "clutter (dB)", 1, "{:.0f}")
    picture.note(views.where_is(x, y, bounds))
    picture.save(options.out / "from-above.png")


def draw_range_image(made, file):
    """Range of every beam of the first scan, and the birds."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.colors import ListedColormap
    image, truth = made["image"], made["truth"]
    azimuths, elevations = image["column_azimuths"], image["row_elevations"]
    greys = ListedColormap(np.repeat(np.linspace(0, 0.82, 256)[:, None], 3, axis=1))
    figure, axes = plt.subplots(2, 1, figsize=(13, 5.6), constrained_layout=True)
    now = truth["scan"] == 0
    for axis, begin in zip(axes, (0, 180)):
        mesh = axis.pcolormesh(azimuths, elevations, np.ma.masked_invalid(image["distance_m"]), cmap=greys, vmin=0,
                               vmax=FAR, shading="nearest", rasterized=True)
        for name in made["trails"]:
            of = now & (truth["species"] == name) & np.isfinite(truth["azimuth_deg"])
            color = np.array(COLORS.get(name, OTHER)) / 255
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
    figure.colorbar(mesh, ax=axes, label="range of the strongest echo (m)", shrink=0.8, extend="max")
    figure.savefig(file, dpi=100)
    plt.close(figure)


def draw_points(made, file):
    """Of birds that nothing hides, by range: points, and the share seen against the expected one."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    truth = made["truth"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.4), constrained_layout=True)
    free = np.isin(truth["status"], ("seen", "missed", "too weak"))
    for name in made["trails"]:
        of = free & (truth["species"] == name)
        color = np.array(COLORS.get(name, OTHER)) / 255
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
    figure.savefig(file, dpi=100)
    plt.close(figure)


def main(argv=None):
    options = arguments(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    made = run(options)
    table = table_of(made["truth"])
    (options.out / "birds-over-airport.md").write_text(table, encoding="utf-8")
    print(table)
    if not options.no_pictures:
        draw_from_above(made, options)
        draw_range_image(made, options.out / "range-image.png")
        draw_points(made, options.out / "points.png")
    return made


if __name__ == "__main__":
    main()
