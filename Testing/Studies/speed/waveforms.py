# SPDX-License-Identifier: BSD-3-Clause
"""What waveforms cost on six scenes: time of a scan with waveforms, divided by the time without, and memory. Also makes
the picture of a gull before a hangar.

    AVIANLIDAR_SCENES_DIR=build/paraview/Testing/Scenes Testing/Studies/run.py waveforms

Every scan is a new one. Ratios are medians of --turns turns, in which scans without waveforms, with one sample in a
range unit and with five are timed one after another.
"""
import pathlib
import runpy
import statistics
import time

import avianlidar as al
import tools
from avianlidar._pipeline import update
from running import argument, built_scene, study, whole

SCENES = {"Hongqiao, shipped": (None, (0.0, 0.0, 3.0)), "Hongqiao, structures": ("zsss_structures", (0.0, 0.0, 3.0)),
          "Honolulu": ("phnl", (0.0, 0.0, 2.82)), "Shanghai, centre": ("shanghai_cbd", (1429.6, -84.3, 3.0)),
          "Neubrandenburg": ("neubrandenburg", (0.0, 0.0, 3.0)), "Ingolstadt": ("ingolstadt", (0.0, 0.0, 3.0))}
SENSORS = ("Airport16", "Search905")
SETTINGS = ({}, {"record_waveforms": True}, {"record_waveforms": True, "digitiser_rate": 1e9})
EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "Examples" / "waveforms" / "gull_before_hangar.py"


def scan(scene, position, sensor, digitiser_rate=0.0, **settings):
    """Seconds of a new scan, and megabytes of its waveforms."""
    made = al.Scan(scene, al.Sensor(sensor, position=position, digitiser_rate=digitiser_rate), **settings)
    update(made.sensor.algorithm)
    begin = time.perf_counter()
    update(made.algorithm)
    return time.perf_counter() - begin, made.algorithm.GetOutput(3).GetActualMemorySize() / 1024.0


def loaded_scenes():
    """Title, scene and place of the lidar of each of SCENES that is there."""
    for title, (name, position) in SCENES.items():
        file = built_scene(name) if name else al.example_scene()
        if file is not None:
            scene = al.Scene(file)
            update(scene.tree)
            yield title, scene, position


@study(argument("--turns", type=whole(1, 1000), default=7, help="turns, default 7"))
def main(options):
    rows = []
    for title, scene, position in loaded_scenes():
        row = [title]
        for sensor in SENSORS:
            turns = [[scan(scene, position, sensor, **one) for one in SETTINGS] for _ in range(options.turns)]
            plain, coarse, fine = zip(*turns)
            ratios = (f"{statistics.median(more / less for (more, _), (less, _) in zip(those, plain)):.2f}"
                      for those in (coarse, fine))
            row.append(f"{', '.join(ratios)}, {fine[0][1]:.0f} MB")
        rows.append(row)
    tools.leave(options.out, "waveforms", ("scene", *SENSORS), rows, 1)
    runpy.run_path(str(EXAMPLE))["main"](options.out)
