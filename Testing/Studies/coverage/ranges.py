# SPDX-License-Identifier: BSD-3-Clause
"""How far birds are detected: the share of them by range for each receiver, as a picture and a table.

    Testing/Studies/run.py ranges --out build/ranges
"""
import numpy as np

import avianlidar as al
import tools
from avianlidar import reach
from avianlidar.apps._pictures import draw_reach
from running import study

SENSORS = ("Search905", "Search1550", "Automotive16", "Airport16")
ON_SALE = ("OS0_128", "OS1_64", "OS2_128", "VLP16", "VLP32C", "HDL32E", "Helios16P", "Pandar40P", "PandarXT32", "Mid40", "Mid360", "Avia")
SPECIES = ("starling", "crow", "herring gull", "Canada goose")
VISIBILITY = 23e3  # m


def row(name, sensor, species, found):
    """Of the table. Ranges have the two digits that the draw of birds leaves of them."""
    return (f"`{name}`", species, reach.metres(found.to(0.9)), f"**{reach.half(sensor, found)}**", reach.metres(found.to(0.1)),
            reach.metres(found.to(0.9, True)))


@study()
def main(options):
    rows = []
    with tools.figure(options.out / "ranges.png", 2, 2, figsize=(9.0, 7.0)) as panels:
        for name, axes in zip(SENSORS, np.ravel(panels)):
            sensor = al.Sensor(name)
            found = {species: reach.within_beams(sensor, species, visibility=VISIBILITY) for species in SPECIES}
            rows += [row(name, sensor, species, one) for species, one in found.items()]
            draw_reach(axes, found, "2 of 3 scans")
            axes.set_title(f"{name}{'' if name == 'Airport16' else ', assumed receiver'}", fontsize=10)
    for name in ON_SALE:
        sensor = al.Sensor(name)
        rows.append(row(name, sensor, "herring gull", reach.within_beams(sensor, "herring gull", birds=100, visibility=VISIBILITY)))
    tools.leave(options.out, "coverage-ranges", (
        "receiver", "bird", "9 of 10, to", "half, to", "a tenth, to", "9 of 10 by 2 of 3 scans, to"), rows, 2)
