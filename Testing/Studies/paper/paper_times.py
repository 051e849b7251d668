# SPDX-License-Identifier: BSD-3-Clause
"""The paper's claim of time (Sec. 5.3): how much longer original ray tracing takes than the proposed method at the
airport, with 16 and 32 channels, and which of the three accelerations the ratio comes from. All rows run this project's
code on one core and one k-D tree; only their settings differ. The tree has eight boxes a node: the descent of single
rays through the binary tree of the preset Paper is slow enough to make the ratio 41. Takes half a minute and leaves a
table.

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
         "light-energy constraint (proposed)": {},
         "original with one reflection": {**SINGLE, "BeamConstraint": False, "LightEnergyConstraint": False,
                                          "NumberOfReflections": 1}}
PAPER = {"CorridorC16": "130/83 = 1.57", "Airport16": "1439/1122 = 1.28", "Airport32": "1831/1633 = 1.12"}


def on_a_kd_tree(subject):
    set_all(subject.tree, {"SplitRule": Tree.SPLIT_RULE_MEDIAN, "MaximumLeafSize": 1})
    update(subject.tree)
    return subject


def times(subject, turns):
    """Rows of one sensor: seconds of one core, medians of turns that alternate, and the rays of each step."""
    runs = {name: [] for name in STEPS}
    for turn in range(turns):
        for name, changed in STEPS.items():
            runs[name].append(trade_runs.scan(subject, {**SCAN, **changed}, turn))
    cpu = {name: np.median([run.cpu for run in all_of_it]) for name, all_of_it in runs.items()}
    proposed = cpu["light-energy constraint (proposed)"]
    rows = [(name, f"{seconds:.3f} s, {runs[name][0].rays:.0f} rays a beam, {seconds / proposed:.2f}")
            for name, seconds in cpu.items()]
    return [("triangles", subject.tree.GetOutput().GetNumberOfCells()), *rows,
            ("original / proposed", f"{cpu['original ray tracing'] / proposed:.2f}"),
            ("the paper's original / proposed", PAPER[subject.sensor_name])]


@study(argument("--turns", type=whole(1, 100), default=5, help="of timed scans, default 5"))
def main(options):
    found = {}
    for sensor in ("airport16", "airport32"):
        subject = on_a_kd_tree(trade_runs.subject_of("airport", sensor))
        found[subject.sensor_name] = times(subject, options.turns)
    tools.leave(options.out, "paper-times", *tools.columns(found))
    return found
