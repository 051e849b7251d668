#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where should lidars stand that watch an airport's birds?

    Examples/siting/run.sh                            builds everything and runs this script
    siting.py -o build/siting --mix "herring gull=1" --share strips=2 --share approaches=1 --mast 5 --mast 10
    mpiexec -n 2 pvbatch --sym Examples/siting/siting.py -o build/siting

Leaves all candidates in the order of their rank as sites.csv, sites.geojson and sites.vtp, the best networks as gain.csv, what
changes the winner as robustness.csv, and the plan as siting.png. Each site's coverage is kept in the folder `coverage`: stopped
and started again, the work goes on.

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`).
"""
import argparse
import csv
import os
import pathlib
import sys
import time
import traceback

import numpy as np

import avianlidar as al
from avianlidar import siting
from avianlidar._command import Bar
from avianlidar._ranks import Ranks

SCENE = pathlib.Path(__file__).resolve().parent.parent / "airport" / "scene" / "hongqiao.lidarscene.json"
NEAR = 40  # of the best sites, among which a winner is looked for when something changes


def named(text):
    """`name=number`."""
    name, equals, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected name=number, not '{text}'") from None


def arguments(argv):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=pathlib.Path, default=SCENE, help=".lidarscene.json with an origin")
    parser.add_argument("--plan", type=pathlib.Path, help="GeoJSON with runways, and buildings with `height`; default: the "
                        "scene's name with .geojson")
    parser.add_argument("--sensor", default="Search905", help="a preset, or a .lidarsensor.json file")
    parser.add_argument("--bounds", type=float, nargs=4, default=(-2000, 1600, -2200, 2200), metavar=("X0", "X1", "Y0", "Y1"),
                        help="of the lattice of candidates, m")
    parser.add_argument("--spacing", type=float, default=200.0, help="of the lattice, m")
    parser.add_argument("--points", type=pathlib.Path, help="CSV of x,y (m) with a header: candidates instead of the lattice")
    parser.add_argument("--mast", type=float, action="append", help="height, m; may be given many times; default 5")
    parser.add_argument("--margin", type=float, default=0.0, help="around buildings, m")
    parser.add_argument("--mix", type=named, action="append", metavar="SPECIES=SHARE", help="default: herring gull=1")
    parser.add_argument("--share", type=named, action="append", metavar="REGION=SHARE",
                        help="strips, approaches; default: 1 each")
    parser.add_argument("--visibility", type=float, default=23000.0, help="m")
    parser.add_argument("--places", type=int, default=12000, help="number of places, default 12000")
    parser.add_argument("--sensors", type=int, default=3, help="the largest network, default 3")
    parser.add_argument("--draws", type=int, default=10, help="of building heights, areas and places, each; 0: none")
    parser.add_argument("-o", "--out", type=pathlib.Path, default=pathlib.Path("build/siting"))
    options = parser.parse_args(argv)
    options.plan = options.plan or options.scene.with_name(options.scene.name.replace(".lidarscene.json", ".geojson"))
    return options


class Search:
    """The airport, and the coverage of its candidates."""

    def __init__(self, options, ranks):
        self.options, self.ranks = options, ranks
        self.scene = al.load_scene(options.scene)
        if self.scene.geodetic_origin is None:
            raise ValueError(f"{options.scene} has no origin, which the plan needs")
        origin = self.scene.geodetic_origin
        self.buildings = siting.read_buildings(options.plan, origin)
        self.runways = siting.read_runways(options.plan, origin)
        self.outlines = [siting.runway_outline(runway) for runway in self.runways]
        points = siting.lattice(options.bounds, options.spacing)
        if options.points:
            points = np.loadtxt(options.points, delimiter=",", skiprows=1, ndmin=2)
        exclusions = [(outline, options.margin) for outline in self.buildings] + [(outline, 0.0) for outline in self.outlines]
        self.sites = siting.candidates(points, options.mast or (5.0,), exclusions)
        self.sensor = al.Sensor(options.sensor)
        self.mix = dict(options.mix or {"herring gull": 1.0})
        self.shares = dict(options.share or {"strips": 1.0, "approaches": 1.0})

    def look(self, sites, seed=0, scene=None, what="sites", **settings):
        """Coverage of sites, and weights."""
        points, regions = siting.strips_and_approaches(self.runways, self.options.places, seed)
        bar = Bar(what, 0)

        def progress(done, all_of_them):
            bar.total = all_of_them
            if self.ranks.rank == 0 and what == "sites":
                bar(done)
        found = siting.look(scene or self.scene, self.sensor, sites, points, list(self.mix), self.options.out / "coverage",
                            self.ranks, progress, visibility=self.options.visibility, **settings)
        if bar.total and what == "sites":
            bar.close()
        return found, siting.weights_of(len(points), regions, self.shares, self.mix), regions

    def changes(self, value):
        """What another winner costs: a row for each draw of building heights, areas and places, among the best sites."""
        near = np.argsort(-value, kind="stable")[:NEAR]
        winner = 0  # of the near ones
        random = np.random.default_rng(1)
        for draw in range(self.options.draws):
            folder = self.options.out / "heights" / f"{draw:02d}"
            offsets = random.uniform(-5.0, 5.0, 10000)
            if self.ranks.rank == 0:
                numbers = iter(offsets)
                siting.with_other_heights(self.options.scene, folder, lambda: next(numbers))
            self.ranks.wait()
            for what, settings in (
                    ("building heights ±5 m", {"scene": al.load_scene(folder / self.options.scene.name)}),
                    ("effective area ±20 %", {"area_factor": round(random.uniform(0.8, 1.2), 6)}),
                    ("other places", {"seed": draw + 1})):
                found, weights, _ = self.look(self.sites[near], what=what, **settings)
                values = siting.values_of(found, weights)
                best = int(np.argmax(values))
                yield what, draw, int(near[best]), best != winner, values[best], values[winner]


def write_table(path, header, rows):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def draw_plan(path, search, value, networks):
    """Candidates by value, buildings, runways and where nothing may stand; the gain curve beside it."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, (plan, gain) = pyplot.subplots(1, 2, figsize=(13, 8), width_ratios=(1.6, 1), layout="constrained")
    for outline in search.outlines:
        plan.fill(*outline.T, color="0.93")
    for runway in search.runways:
        plan.plot(*np.transpose([runway.start, runway.end]), color="0.5", linewidth=3)
    for outline in search.buildings:
        plan.fill(*outline.T, color="0.3")
    x, y, _ = search.sites.T
    order = np.argsort(value)
    dots = plan.scatter(x[order], y[order], c=value[order], s=28, cmap="viridis")
    figure.colorbar(dots, ax=plan, label="share detected in one scan, one sensor", shrink=0.7)
    best = list(networks[-1].sites)
    plan.scatter(x[best], y[best], s=160, facecolors="none", edgecolors="red", linewidths=2, label=f"best {len(best)} together")
    top = int(np.argmax(value))
    plan.scatter(x[top], y[top], s=90, marker="x", color="red", linewidths=2, label="best alone")
    plan.set(aspect="equal", xlabel="east (m)", ylabel="north (m)", title=f"{len(value)} candidates")
    plan.legend(loc="upper left")
    gain.plot(range(1, len(networks) + 1), [network.value for network in networks], "o-")
    gain.set(xlabel="sensors", ylabel="share detected in one scan", title="Gain", ylim=(0, None),
             xticks=range(1, len(networks) + 1))
    gain.grid(alpha=0.4)
    figure.savefig(path, dpi=100)


def main(argv=None):
    options, ranks = arguments(argv), Ranks()
    search = Search(options, ranks)
    options.out.mkdir(parents=True, exist_ok=True)
    begin = time.perf_counter()
    found, weights, regions = search.look(search.sites)
    print(f"{found.shape[0]} sites x {found.shape[1]} species x {found.shape[2]} places: {time.perf_counter() - begin:.1f} s",
          file=sys.stderr)
    value = siting.values_of(found, weights)
    changes = list(search.changes(value))
    if ranks.rank:
        return
    begin = time.perf_counter()
    networks = siting.search(found, weights, min(options.sensors, len(found)))
    print(f"search: {time.perf_counter() - begin:.1f} s", file=sys.stderr)
    order = np.argsort(-value, kind="stable")
    member = np.isin(order, networks[-1].sites).astype(np.int32)
    columns = {"rank": np.arange(1, len(order) + 1), "value": value[order], "in_network": member}
    for k, name in enumerate(search.mix):
        for region, numbers in regions.items():
            columns[f"{name}_{region}".replace(" ", "_")] = found[order, k][:, numbers].mean(axis=1, dtype=float)
    siting.write_sites(options.out, search.sites[order], columns, search.scene.geodetic_origin)
    rank_of = np.argsort(order, kind="stable") + 1
    write_table(options.out / "gain.csv", ("sensors", "value", "ranks of the sites"),
                [(n, f"{network.value:.6f}", " ".join(str(rank_of[i]) for i in network.sites))
                 for n, network in enumerate(networks, 1)])
    write_table(options.out / "robustness.csv",
                ("change", "draw", "rank of the winner", "value of the winner", "value of rank 1"),
                [(what, draw, rank_of[site], f"{best:.6f}", f"{old:.6f}") for what, draw, site, _, best, old in changes])
    draw_plan(options.out / "siting.png", search, value, networks)
    for n, network in enumerate(networks, 1):
        where = ", ".join(f"({x:g}, {y:g}, {z:g})" for x, y, z in search.sites[list(network.sites)])
        print(f"{n} sensors: {network.value:.3f} at {where}")
    for what in dict.fromkeys(row[0] for row in changes):
        rows = [row for row in changes if row[0] == what]
        print(f"{what}: another winner in {sum(row[3] for row in rows)} of {len(rows)} draws, at most "
              f"{100 * max(1.0 - row[5] / row[4] for row in rows):.1f} % better")


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, OSError, ValueError, LookupError) as error:
        if Ranks().size > 1:  # the other ranks must not wait for this one
            traceback.print_exc()
            sys.stderr.flush()
            os._exit(2)
        sys.exit(f"siting.py: {error}")
