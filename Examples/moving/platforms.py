#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Birds that a lidar sees from a car on the perimeter road and from a drone above the approach. Scans both scenarios of
this folder, and writes the picture platforms.png of all scans and the moving picture moving.webp.

    platforms.py --out build/platforms
    platforms.py --scans 5

PYTHONPATH must contain the folder of the Python package (`cat build/paraview/python-path`).
"""
import pathlib
import sys

import numpy as np

import avianlidar as al
from avianlidar._look import species_colours

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "airport"))
import tools  # noqa: E402

# Title, the two coordinates that the picture shows (east 0, north 1, up 2), and its limits, m.
VIEWS = {"car": ("from a car, seen from above", (0, 1), ((-1100, 1000), (-2350, -1100))),
         "drone": ("from a drone, seen from the east", (1, 2), ((-2400, -1900), (-5, 95)))}
NAMES = "east (m)", "north (m)", "height (m)"
QUALITY = 60  # of the moving picture, 0 to 100


def scanned(name, scans):
    """The sequence of a scenario, and for each scan the sensor's place, points of clutter, and points of birds by
    species."""
    sequence, found = al.Sequence(HERE / f"{name}.scenario.json", **({"number_of_scans": scans} if scans else {})), []
    for _, scan, species in sequence.frames(0):
        echoes = scan.echoes
        birds = {kind: echoes.points[np.isin(echoes["object_id"], [k for k, its in species.items() if its == kind])]
                 for kind in dict.fromkeys(species.values())}
        clutter = ~np.isin(echoes["object_id"], [*species])
        found.append((np.array(echoes.fields["position"]), echoes.points[clutter], birds))
    return sequence, found


def draw(axes, name, made, number):
    """Draws a scan, with the birds of the scans before it."""
    sequence, scans = made
    title, ways, (across, up) = VIEWS[name]
    if ways == (0, 1):
        tools.plan(axes, al.Scene(sequence.scenario["scene"]).surfaces.GetBlock(0))
    way = al.Cloud(sequence.trajectory).points
    axes.plot(*way[:, ways].T, color="red", linewidth=1, zorder=3)
    place, clutter, _ = scans[number]
    axes.scatter(*clutter[:, ways].T, s=1.5, color="0.35", label="clutter", zorder=2)
    colours = species_colours(scans[0][2])
    for kind in scans[0][2]:
        before = np.concatenate([birds[kind] for *_, birds in scans[:number + 1]])
        axes.scatter(*before[:, ways].T, s=4, color=colours[kind], alpha=0.35, linewidths=0, zorder=4)
        axes.scatter(*scans[number][2][kind][:, ways].T, s=16, color=colours[kind], label=kind, zorder=5)
    axes.plot(*place[list(ways)], "s", color="red", markersize=8, label=name, zorder=6)
    axes.set(xlim=across, ylim=up, xlabel=NAMES[ways[0]], ylabel=NAMES[ways[1]],
             aspect="equal" if ways == (0, 1) else "auto")
    axes.set_title(f"{title}: {number + 1} scans in {(number + 1) / sequence.sensor.rotation_rate:.3g} s", loc="left")
    axes.legend(loc="upper left", fontsize=8)


def main(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scans", type=tools.number(int, 1, 10000), help="scans, default: as the scenarios say")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/platforms"), help="folder for results")
    options = parser.parse_args(argv)
    from PIL import Image
    made, frames = {name: scanned(name, options.scans) for name in VIEWS}, []
    count = max(len(scans) for _, scans in made.values())
    for number in range(count):
        page = options.out / "platforms.png"  # the last one stays
        with tools.figure(page, 2, 1, figsize=(9, 9)) as both:
            for axes, (name, one) in zip(both, made.items()):
                draw(axes, name, one, min(number, len(one[1]) - 1))
        frames.append(Image.open(page).convert("RGB").resize((630, 630)))
    frames[0].save(options.out / "moving.webp", save_all=True, append_images=frames[1:], duration=150, loop=0,
                   quality=QUALITY)
    print(options.out / "platforms.png")
    return 0


if __name__ == "__main__":
    main()
