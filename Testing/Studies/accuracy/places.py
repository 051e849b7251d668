# SPDX-License-Identifier: BSD-3-Clause
"""Do the numbers of Documentation/evidence/accuracy.md hold where nobody chose the place? Stands the lidar of each
scene at places that are drawn at random, 3 m above open ground, and leaves tables: errors of presets and settings, and
what paths after two reflections and connections cost there.

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
JUDGED = {"Draft": {"Preset": Filter.PRESET_DRAFT}, "Standard": {"Preset": Filter.PRESET_STANDARD},
          "Reference": {"Preset": Filter.PRESET_REFERENCE}, "default": {}, "100 rays, Rays": SAMPLED,
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
    return siting.candidates(np.column_stack([x + away * np.sin(angle), y + away * np.cos(angle)]), (MAST,),
                             scene=scene)


def costs(subject, turns):
    """Times over other times: of scans without connections, with two reflections, and by cells. Settings take turns, as
    the machine may do other work: medians of ratios within a turn."""
    took = {setting: [] for setting in TIMED}
    for turn in range(turns):
        for setting, values in TIMED.items():
            took[setting].append(trade_runs.scan(subject, values, turn).cpu)
    return [np.median(np.array(took[one]) / took[other]) for one, other in (
        ("no connections", "default"), ("default", "one reflection"), ("default", "rays"))]


def measure(name, sensor, options):
    """(title, errors by setting, ratios of times) of each place in a scene: rms error of energy and share of the true
    echoes that is missed or invented, in percent."""
    number = 0
    for place in places_in(name, options):
        if number == options.places:
            break
        subject = trade_runs.subject_of(name, sensor, options.coarser, place)
        if len(trade_runs.scan(subject, {}, 0).echoes["beam_id"]) < FEWEST:
            continue
        reference = trade_runs.Reference(subject, options.reference_rays)
        number += 1
        runs = (trade_runs.judged(reference, values, range(options.seeds)) for values in JUDGED.values())
        errors = [100 * np.array(trade_runs.energy_and_wrong(one)) for one in runs]
        yield subject.title, errors, costs(subject, options.turns)


def span(values, form, unit):
    """The smallest to the largest of values."""
    low, high = (form.format(value) for value in (min(values), max(values)))
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}"


@study(trade_runs.SCENES,
       argument("--places", type=whole(1, 100), default=3, help="of the lidar in each scene, default 3"),
       argument("--within", type=running.above_zero, default=500.0, help="m from the scene's own place, default 500"),
       argument("--coarser", type=whole(1, 100), default=4, help="steps of azimuth, default 4 times the sensor's"),
       argument("--seeds", type=whole(1, 100), default=2, help="scans with each setting, default 2"),
       argument("--turns", type=whole(1, 100), default=15, help="scans with each setting that is timed, default 15"),
       argument("--reference-rays", type=whole(1000, 1000000), default=30000, help="default 30000"),
       argument("--seed", type=whole(0, 1000000), default=1, help="of the places, default 1"))
def main(options):
    errors, times = [], []
    for name, sensor in options.scenes:
        found = list(measure(name, sensor, options))
        if not found:
            sys.exit(f"{name}: no place with {FEWEST} echoes was found")
        title = found[0][0]
        for k, setting in enumerate(JUDGED):
            errors.append((title, setting, *(span([one[k][i] for _, one, _ in found], "{:.2g}", " %") for i in (0, 1))))
        without, two, cells = zip(*(ratios for _, _, ratios in found))
        times.append((title, span([100 * (1 - ratio) for ratio in without], "{:.0f}", " %"),
                      span([100 * (ratio - 1) for ratio in two], "{:.0f}", " %"), span(cells, "{:.1f}", " times")))
    tools.leave(options.out, "accuracy-places", (
        "scene", "setting", "energy, rms, smallest to largest of the places",
        "echoes missed or invented, smallest to largest"), errors, 2)
    tools.leave(options.out, "accuracy-places-times", (
        "scene", "leaving connections out saves", "two reflections take more than one", "Cells take, over Rays"), times)
