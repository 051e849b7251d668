# SPDX-License-Identifier: BSD-3-Clause
"""The paper's claim of time (Sec. 5.3): how much longer original ray tracing takes than the proposed method at the
airport, with 16 and 32 channels, and which of the three accelerations the ratio comes from. All rows run this project's
code on one core; only their settings and the tree differ: the k-D tree of preset Paper, with two boxes a node, and the
same k-D tree with eight boxes a node, as this project descends it. Takes a minute and leaves a table.

    Testing/Studies/run.py paper_times
"""
import numpy as np

from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree as Tree
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import tools
import trade_runs
from running import argument, set_all, study, update, whole

# Properties of vtkAvianLidarEchoFilter: the preset Paper, setting by setting.
SCAN = {"RaysPerBeam": 100,                                                     # N of Table 2
        "NumberOfConnections": 2,
        "Sampling": Filter.SAMPLING_MONTE_CARLO,                                # Sec. 2.1: no strata
        "BatchCollisionDetection": Filter.BATCH_COLLISION_DETECTION_BEAMS,      # Sec. 3.2, 3.3: to S_potential
        "BeamConstraint": True, "LightEnergyConstraint": True,                  # Sec. 3.4
        "LightEnergyThreshold": Filter.LIGHT_ENERGY_THRESHOLD_LIMIT,            # Sec. 3.4
        "NumberOfReflections": 2,                                               # Sec. 3.4
        "ReflectanceModel": Filter.REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG,       # Eq. 8
        "Noise": True,                                                          # Eq. 11
        "ReturnMode": Filter.RETURN_MODE_RANGE_UNITS,                           # Eq. 10, 12: one point per range unit
        "BeamSamples": Filter.BEAM_SAMPLES_RAYS}                                # Sec. 2.1: N rays
SINGLE = {"BatchCollisionDetection": Filter.BATCH_COLLISION_DETECTION_RAYS}
# From the original to the proposed method: each row has the acceleration of its name and those above it.
STEPS = {"original ray tracing": {**SINGLE, "BeamConstraint": False, "LightEnergyConstraint": False},
         "batch collision detection": {"BeamConstraint": False, "LightEnergyConstraint": False},
         "beam constraint": {"LightEnergyConstraint": False},
         "light-energy constraint (proposed)": {}}
ORIGINAL, *_, PROPOSED = STEPS
PAPER = {"CorridorC16": "130/83 = 1.57", "Airport16": "1439/1122 = 1.28", "Airport32": "1831/1633 = 1.12"}


TREES = {"two boxes": {"Preset": Tree.PRESET_PAPER},
         "eight boxes": {"SplitRule": Tree.SPLIT_RULE_MEDIAN, "MaximumLeafSize": 1}}


def times(subject, turns):
    """Rows of one sensor by tree: seconds of one core, medians of turns that alternate, the rays of each step, and the
    ratio with its least and largest value of the turns."""
    columns = {}
    for tree, settings in TREES.items():
        set_all(subject.tree, {"Preset": Tree.PRESET_CUSTOM, **settings})
        update(subject.tree)
        runs = {name: [] for name in STEPS}
        for turn in range(turns):
            for name, changed in STEPS.items():
                runs[name].append(trade_runs.scan(subject, {**SCAN, **changed}, turn))
        cpu = {name: np.array([run.cpu for run in all_of_it]) for name, all_of_it in runs.items()}
        proposed = cpu[PROPOSED]
        is_first = not columns  # rays and the paper's ratio are the same for all trees
        rows = [(name, f"{np.median(seconds):.3f} s, " + f"{runs[name][0].rays:.0f} rays, " * is_first +
                 f"{np.median(seconds) / np.median(proposed):.2f}") for name, seconds in cpu.items()]
        ratios = cpu[ORIGINAL] / proposed
        columns[f"{subject.sensor_name}, {tree}"] = [
            *rows, ("original / proposed", f"{np.median(ratios):.2f} ({ratios.min():.2f} to {ratios.max():.2f})"),
            ("the paper's original / proposed", PAPER[subject.sensor_name] if is_first else "")]
    return columns


WIDTHS = (5.6e-4, 5.6e-3, 2.8e-2)  # half-beamwidths, rad: a tenth of Table 2, Table 2, five times


def widths(subject, turns):
    """Rows by half-beamwidth: seconds of one core with the tree of preset Paper, and the ratio with its spread."""
    set_all(subject.tree, {"Preset": Tree.PRESET_PAPER})
    update(subject.tree)
    rows = []
    for width in WIDTHS:
        set_all(subject.sensor, {"HalfBeamwidth": width})
        update(subject.sensor)
        cpu = np.array([[trade_runs.scan(subject, {**SCAN, **STEPS[name]}, turn).cpu for name in (ORIGINAL, PROPOSED)]
                        for turn in range(turns)])
        ratios = cpu[:, 0] / cpu[:, 1]
        rows.append((f"{1e3 * width:g} mrad", *(f"{seconds:.3f} s" for seconds in np.median(cpu, axis=0)),
                     f"{np.median(ratios):.2f} ({ratios.min():.2f} to {ratios.max():.2f})"))
    return rows


@study(argument("--turns", type=whole(1, 100), default=3, help="of timed scans, default 3"))
def main(options):
    found = {}
    for sensor in ("airport16", "airport32"):
        found.update(times(trade_runs.subject_of("airport", sensor), options.turns))
    tools.leave(options.out, "paper-times", *tools.columns(found))
    tools.leave(options.out, "paper-widths", ("half-beamwidth", ORIGINAL, "proposed", "original / proposed"),
                widths(trade_runs.subject_of("airport", "airport16"), options.turns))
    return found
