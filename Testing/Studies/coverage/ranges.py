# SPDX-License-Identifier: BSD-3-Clause
"""How far birds are detected: the share of them by range for each receiver, as a picture, a table of all sensors and
species, and ranges.json, the same ranges (m) for the package.

    Testing/Studies/run.py ranges --out build/ranges
"""
import json

import numpy as np

import avianlidar as al
import tools
from avianlidar import reach
from avianlidar.apps.coverage._pictures import draw_reach
from running import study

SHOWN = ("Search905", "Search1550", "Automotive16", "Airport16")  # in the picture
DRAWN = ("starling", "crow", "herring gull", "Canada goose")
SPECIES = ("starling", "kestrel", "pigeon", "crow", "herring gull", "Canada goose")
VISIBILITY = reach.CLEAR  # m


def row(name, species, found, limits):
    """Of the table. Ranges have the two digits that the choice of birds leaves of them."""
    return (f"`{name}`", species, reach.metres(found.to(0.9)), f"**{reach.in_words(found, limits)}**",
            reach.metres(found.to(0.1)), reach.metres(found.to(0.9, True)))


@study()
def main(options):
    rows, numbers, curves = [], {}, {}
    for name in (*SHOWN, *(name for name in al.Sensor.presets() if name not in SHOWN)):
        sensor = al.Sensor(name)
        for species in SPECIES:
            found = reach.within_beams(sensor, species, visibility=VISIBILITY)
            limits = reach.in_interval(sensor, species, visibility=VISIBILITY)
            rows.append(row(name, species, found, limits))
            numbers.setdefault(name, {})[species] = [round(found.to(share), 1) for share in reach.SHARES]
            if name in SHOWN and species in DRAWN:
                curves.setdefault(name, {})[species] = found
    with tools.figure(options.out / "ranges.png", 2, 2, figsize=(9.0, 7.0)) as panels:
        for name, axes in zip(SHOWN, np.ravel(panels)):
            draw_reach(axes, curves[name], "2 of 3 scans")
            axes.set_title(f"{name}{'' if name == 'Airport16' else ', assumed receiver'}", fontsize=10)
    # One line for each bird.
    birds = {name: ",\n".join(f"   {json.dumps(bird)}: {json.dumps(metres)}" for bird, metres in of.items())
             for name, of in numbers.items()}
    table = ",\n".join(f"  {json.dumps(name)}: {{\n{rows}}}" for name, rows in birds.items())
    head = f'{{"shares": {json.dumps(reach.SHARES)}, "visibility": {VISIBILITY},'
    (options.out / "ranges.json").write_text(f'{head}\n "ranges": {{\n{table}}}}}\n', encoding="utf-8")
    tools.leave(options.out, "coverage-ranges", (
        "receiver", "bird", "9 of 10, to", "half, to", "a tenth, to", "9 of 10 by 2 of 3 scans, to"), rows, 2)
