#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How far birds are detected: the share of them by range for each receiver, as a picture and a table.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/coverage/ranges.py --out build/ranges
"""
import argparse
import pathlib

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import avianlidar as al
from avianlidar import reach
from avianlidar.apps._pictures import draw_reach

SENSORS = ("Search905", "Search1550", "Automotive16", "Airport16")
ON_SALE = ("OS0_128", "OS1_64", "OS2_128", "VLP16", "VLP32C", "HDL32E", "Helios16P", "Pandar40P", "PandarXT32", "Mid40", "Mid360", "Avia")
SPECIES = ("starling", "crow", "herring gull", "Canada goose")
VISIBILITY = 23e3  # m


def row(name, sensor, species, found):
    """Of the table. Ranges have the two digits that the draw of birds leaves of them."""
    return (f"| `{name}` | {species} | {reach.metres(found.to(0.9))} | **{reach.half(sensor, found)}** | {reach.metres(found.to(0.1))} | "
            f"{reach.metres(found.to(0.9, True))} |")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/ranges"), help="folder, default build/ranges")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    lines = ["| receiver | bird | 9 of 10, to | half, to | a tenth, to | 9 of 10 by 2 of 3 scans, to |", "|---|---|---:|---:|---:|---:|"]
    for name, axes in zip(SENSORS, np.ravel(figure.subplots(2, 2))):
        found = {species: reach.within_beams(al.Sensor(name), species, visibility=VISIBILITY) for species in SPECIES}
        lines += [row(name, al.Sensor(name), species, one) for species, one in found.items()]
        draw_reach(axes, found, "2 of 3 scans")
        axes.set_title(f"{name}{'' if name == 'Airport16' else ', assumed receiver'}", fontsize=10)
    for name in ON_SALE:
        sensor = al.Sensor(name)
        found = reach.within_beams(sensor, "herring gull", birds=100, visibility=VISIBILITY)
        lines.append(row(name, sensor, "herring gull", found))
        print(reach.sentence(name, "herring gull", sensor, found))
    figure.savefig(options.out / "ranges.png", dpi=100)
    table = "\n".join(lines) + "\n"
    (options.out / "coverage-ranges.md").write_text(table, encoding="utf-8")
    print(table)


if __name__ == "__main__":
    main()
