# SPDX-License-Identifier: BSD-3-Clause
"""Do the numbers of Documentation/evidence/accuracy.md hold where nobody chose the place? Stands the lidar of each scene at
places that are drawn at random, 3 m above open ground, and prints a table: errors of presets and settings, and what paths
after two reflections and connections cost there.

    Testing/Studies/run.py places airport my.lidarscene.json --places 3"""
import sys

import numpy as np

import avianlidar as al
from avianlidar import siting
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import running
import tools
import trade_runs
from running import argument, study, whole

MAST = 3.0  # m
TRIES = 200  # points for a place that is not in a building
FEWEST = 100  # echoes, below which a place says nothing
SAMPLED = {"BeamSamples": Filter.BEAM_SAMPLES_RAYS}
JUDGED = {"`Draft`": {"Preset": Filter.PRESET_DRAFT}, "`Standard`": {"Preset": Filter.PRESET_STANDARD},
          "`Reference`": {"Preset": Filter.PRESET_REFERENCE}, "default": {},
          "100 rays, `Rays`": SAMPLED,
          "400 rays, no connections": {"RaysPerBeam": 400, "NumberOfConnections": 0},
          "64 rays, 1 reflection": {"RaysPerBeam": 64, "NumberOfReflections": 1}}
TIMED = {"default": {}, "no connections": {"NumberOfConnections": 0}, "one reflection": {"NumberOfReflections": 1},
         "rays": SAMPLED}


def places_in(name, options):
    """Places of the lidar, drawn at random up to `within` m from the scene's own."""
    scene = al.Scene(str(running.AIRPORT if name == "airport" else name))
    x, y, _ = scene.lidar_position or (0.0, 0.0, MAST)
    random = np.random.default_rng(options.seed)
    away, angle = options.within * np.sqrt(random.uniform(size=TRIES)), random.uniform(0.0, 2.0 * np.pi, TRIES)
    return siting.candidates(np.column_stack([x + away * np.sin(angle), y + away * np.cos(angle)]), (MAST,), scene=scene)


def costs(subject, turns):
    """{column of the table: its text}. Settings take turns, as the machine may do other work: medians of ratios within a turn."""
    took = {setting: [] for setting in TIMED}
    for turn in range(turns):
        for setting, values in TIMED.items():
            took[setting].append(trade_runs.scan(subject, values, turn).cpu)

    def over(one, other):
        return np.median(np.array(took[one]) / took[other])

    return {"no connections save": f"{100 * (1 - over('no connections', 'default')):.0f} %",
            "two reflections take more": f"{100 * (over('default', 'one reflection') - 1):.0f} %",
            "`Cells`, time over `Rays`": f"{over('default', 'rays'):.1f}"}


def judged(subject, options):
    """{setting: (rms error of energy, share of the true echoes that is missed or invented)}, and the reference."""
    reference = trade_runs.Reference(subject, options.reference_rays)
    return {setting: trade_runs.energy_and_wrong(trade_runs.judged(reference, values, range(options.seeds)))
            for setting, values in JUDGED.items()}, reference


def measure(name, sensor, options):
    """{column of the table: its text} of the places in a scene."""
    number = 0
    for place in places_in(name, options):
        if number == options.places:
            break
        subject = trade_runs.Subject(name, sensor, options.coarser, place)
        if len(trade_runs.scan(subject, {}, 0).echoes["beam_id"]) < FEWEST:
            continue
        found, reference = judged(subject, options)
        number += 1
        yield {"scene, sensor, place (m)": "{}, {:.0f} {:.0f} {:.0f}".format(subject.title, *place),
               "echoes": len(reference.echoes["beam_id"]), "reference's own error": f"{100 * reference.own['energy']:.2g} %",
               **{setting: f"{100 * rms:.2g} %, {100 * wrong:.2g} %" for setting, (rms, wrong) in found.items()},
               **costs(subject, options.turns)}


@study(trade_runs.SCENES, argument("--places", type=whole(1, 100), default=3, help="of the lidar in each scene, default 3"),
       argument("--within", type=running.above_zero, default=500.0, help="m from the scene's own place, default 500"),
       argument("--coarser", type=whole(1, 100), default=4, help="steps of azimuth, default 4 times the sensor's"),
       argument("--seeds", type=whole(1, 100), default=2, help="scans with each setting, default 2"),
       argument("--turns", type=whole(1, 100), default=15, help="scans with each setting that is timed, default 15"),
       argument("--reference-rays", type=whole(1000, 1000000), default=30000, help="default 30000"),
       argument("--seed", type=whole(0, 1000000), default=1, help="of the places, default 1"))
def main(options):
    rows = [row for name, sensor in options.scenes for row in measure(name, sensor, options)]
    if not rows:
        sys.exit(f"no place with {FEWEST} echoes was found")
    tools.leave(options.out, "table", list(rows[0]), [list(row.values()) for row in rows])
    return rows
