# SPDX-License-Identifier: BSD-3-Clause
"""Error of energy, wrong echoes and processor time of the presets of the echo filter, at the shipped airport and in the
scenes that AVIANLIDAR_SCENES_DIR names. The helps of the presets quote it.

    Testing/Studies/run.py presets
"""
import numpy as np
from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree as Tree
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import paper_times
import running
import tools
import trade_results
import trade_runs
from running import argument, built_scene, study, whole

# The preset Paper sets ReturnMode, too, which the judge needs otherwise: its settings one by one. It has its own tree.
PRESETS = {"Preview": {"Preset": Filter.PRESET_PREVIEW}, "Draft": {"Preset": Filter.PRESET_DRAFT}, "default": {},
           "Standard": {"Preset": Filter.PRESET_STANDARD}, "Reference": {"Preset": Filter.PRESET_REFERENCE},
           "Paper": paper_times.SCAN}
# Name in the table, scene, sensor; where AVIANLIDAR_SCENES_DIR does not have the file, there is no row.
SCENES = (("airport", "airport", "airport16"), ("airport", "airport", "airport32"),
          ("Neubrandenburg, town and airport", "neubrandenburg", "airport16"),
          ("Shanghai, 63 towers", "shanghai_cbd", "airport16"),
          ("Hongqiao with masts and jetways", "zsss_structures", "airport16"),
          ("Honolulu with terrain", "phnl", "airport16"), ("Ingolstadt, a street", "ingolstadt", "airport16"),
          ("900 poles, rails, boxes", "field", "airport16"), ("corridor", "corridor", "corridor"))
BUILT_IN = "airport", "field", "corridor"


def measured(subject, reference, name, seeds):
    """Error of energy, time of one core, and missed and invented echoes as a share of the true ones."""
    settings = PRESETS[name]
    running.set_all(subject.tree, {"Preset": Tree.PRESET_PAPER if name == "Paper" else Tree.PRESET_CUSTOM})
    running.update(subject.tree)
    runs = trade_runs.judged(reference, {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}, range(seeds), subject)
    energy, wrong = trade_runs.energy_and_wrong(runs)
    seconds = np.median([run.cpu for _, run in runs])
    return f"{trade_results.amount('energy', energy)}, {seconds:.2g} s, {100 * wrong:.2g} %"


@study(argument("--seeds", type=whole(1, 100), default=3, help="scans to judge, default 3"),
       argument("--reference-rays", type=whole(100, 1000000), default=10000, help="default 10000"))
def main(options):
    rows = []
    for title, scene, sensor in SCENES:
        file = scene if scene in BUILT_IN else built_scene(scene)
        if not file:
            continue
        subject = trade_runs.subject_of(file, sensor)
        reference = trade_runs.Reference(subject, options.reference_rays)
        rows.append((f"{title}, {subject.sensor_name}",
                     *(measured(subject, reference, name, options.seeds) for name in PRESETS)))
    tools.leave(options.out, "presets",
                ("scene, sensor", *(name if name == "default" else f"`{name}`" for name in PRESETS)), rows)
    return rows
