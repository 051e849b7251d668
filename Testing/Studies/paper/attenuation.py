# SPDX-License-Identifier: BSD-3-Clause
"""Which unit may the paper's attenuation coefficient have? Scans the corridor with 0.088 and the airport with 0.035 in
every unit of a grid, over the way there and back or one way, and leaves a table: does the end of the corridor vanish,
as the text to Fig. 15 says, and is Terminal 1 there, as in Fig. 17?

    Testing/Studies/run.py attenuation
"""
import math

import numpy as np

import paper
import tools
import trade_runs
from running import column, study

CORRIDOR, AIRPORT = 0.088, 0.035  # Table 2 and Sec. 5.3, without unit
PULSES = {"corridor": 2.5e-4, "airport": 3.6e-4}  # J
WALL, LIMIT = 0.2, 2e-6  # kd + ks of Table 1; J
FAR = 24.0  # m to the far end of the corridor

# What one unit is in 1/m, over the way there and back, as Eq. 9 has it; one way is half of it.
DECIBEL = math.log(10) / 10
NAMED = {"1/m": 1.0, "dB/m": DECIBEL, "1/(10 m)": 0.1, "1/(100 m)": 0.01, "1/km": 1e-3, "dB/km": 1e-3 * DECIBEL}
SCALES = np.logspace(0, -4, 33)  # and everything between, eight to a decade
END_IS_ABSENT, TERMINAL_IS_THERE = "Fig. 15: the end is absent", "Fig. 17: Terminal 1 is there"


def grid():
    """(name, factor to 1/m), the largest first."""
    units = [(name + way, factor * part) for name, factor in NAMED.items()
             for way, part in (("", 1.0), (", one way", 0.5))]
    units += [(f"{scale:.3g} 1/m", scale) for scale in SCALES if not any(math.isclose(scale, f) for _, f in units)]
    return sorted(units, key=lambda unit: -unit[1])


def reach(scene, mu):
    """The range at which air alone takes a wall that is met squarely below the limit, m."""
    return math.log(PULSES[scene] * WALL / LIMIT) / (2 * mu)


def on(lidar, name):
    """Which echoes lie on an object."""
    known = tools.strings(lidar.GetOutput(), "object_names")
    return column(lidar.GetOutput(), "object_id") == known.index(name)


def scan(subject, mu):
    subject.attenuation = mu
    lidar = paper.scan(subject, {**paper.SCAN, "ReturnMode": 0}, 0, 0)
    return lidar, column(lidar.GetOutput(), "distance_m")


def measure():
    """A row for each unit of the grid, the clear air first."""
    corridor, airport = (paper.configured(trade_runs.subject_of(name, sensor), paper.CONFIGURATIONS["paper"][0])
                         for name, sensor in (("corridor", "corridor"), ("airport", "airport16")))
    rows = []
    for name, factor in [("no air", 0.0), *grid()]:
        near, ranges = scan(corridor, factor * CORRIDOR)
        far, _ = scan(airport, factor * AIRPORT)
        side = on(near, "North wall") | on(near, "South wall")
        row = {"unit": name, "factor to 1/m": factor,
               "air over 24 m and back": f"{100 * (1 - math.exp(-2 * factor * CORRIDOR * FAR)):.2g} %",
               "a wall vanishes at, corridor (m)": reach("corridor", factor * CORRIDOR) if factor else math.inf,
               "side walls end at (m)": ranges[side].max() if side.any() else 0.0,
               "echoes of the far end": int(on(near, "Far end").sum()),
               "a wall vanishes at, airport (m)": reach("airport", factor * AIRPORT) if factor else math.inf,
               "echoes of Terminal 1": int(on(far, "Terminal 1").sum()),
               "their median hue (deg)": paper.median_of(paper.hues_of("Terminal 1", far.GetOutput()))}
        clear = rows[0] if rows else row
        # Areas that are farther away are absent; both clouds capture the facade: at least half of what clear air shows.
        row[END_IS_ABSENT] = "yes" if row["echoes of the far end"] == 0 else "no"
        row[TERMINAL_IS_THERE] = "yes" if 2 * row["echoes of Terminal 1"] >= clear["echoes of Terminal 1"] else "no"
        rows.append(row)
    return rows


def both(rows):
    """Units that fit both figures."""
    return [row["unit"] for row in rows if row[END_IS_ABSENT] == row[TERMINAL_IS_THERE] == "yes"]


def text(value):
    return value if isinstance(value, str) else str(value) if isinstance(value, int) else f"{value:.3g}"


@study()
def main(options):
    rows = measure()
    shown = [row for row in rows if row["unit"] == "no air" or row["unit"].removesuffix(", one way") in NAMED]
    tools.leave(options.out, "table", ("", *list(rows[0])[1:]), [list(map(text, row.values())) for row in shown])
    print(f"{len(rows) - 1} units, of which fit both figures: {len(both(rows))}")
    return rows
