# SPDX-License-Identifier: BSD-3-Clause
"""What moving costs on six scenes: time of a scan whose beams have 1,000 origins, or an origin each, along a straight
way of 20 m, divided by the time with one origin. Also makes the pictures of a car and of a drone.

    AVIANLIDAR_SCENES_DIR=build/paraview/Testing/Scenes Testing/Studies/run.py origins

Every scan is a new one. Ratios are medians of --turns turns, in which the three scans are timed one after another. The
beams of all three have the same directions.
"""
import pathlib
import runpy
import statistics
import time

import numpy as np

import avianlidar as al
import tools
from avianlidar._pipeline import update
from running import argument, study, whole
from waveforms import SENSORS, loaded_scenes

WAY = 20.0  # m
EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "Examples" / "moving" / "platforms.py"


def seconds(scene, position, preset, parts, **settings):
    """Seconds of a new scan. @param parts number of origins"""
    beams = al.Sensor(preset).beams
    count = beams.number_of_points
    part = np.arange(count) * min(parts, count) // count
    along = np.zeros((count, 3))
    along[:, 0] = WAY * part / max(part.max(), 1)
    sensor = al.Sensor(preset, position=position, directions=beams["direction"], times=1e-6 * beams["timestamp"],
                       positions=along)
    made = al.Scan(scene, sensor.beams, **settings)
    begin = time.perf_counter()
    update(made.algorithm)
    return time.perf_counter() - begin


@study(argument("--turns", type=whole(1, 1000), default=7, help="turns, default 7"))
def main(options):
    rows = []
    for title, scene, position in loaded_scenes():
        row = [title]
        for settings in ({}, {"beam_samples": "Rays"}):
            for preset in SENSORS:
                turns = [[seconds(scene, position, preset, parts, **settings) for parts in (1, 1000, 1 << 40)]
                         for _ in range(options.turns)]
                one, many, each = zip(*turns)
                row.append(", ".join(f"{statistics.median(more / less for more, less in zip(those, one)):.2f}"
                                     for those in (many, each)))
        rows.append(row)
    tools.leave(options.out, "origins", ("scene", *SENSORS, *(f"{preset}, rays" for preset in SENSORS)), rows, 1)
    runpy.run_path(str(EXAMPLE))["main"](["--out", str(options.out)])
