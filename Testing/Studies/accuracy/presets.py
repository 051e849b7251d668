# SPDX-License-Identifier: BSD-3-Clause
"""Error of energy, wrong echoes and processor time of the presets of the echo filter, at the shipped airport and in the scenes
that AVIANLIDAR_SCENES_DIR names. The helps of the presets quote it.

    Testing/Studies/run.py presets
"""
import os
import pathlib

import numpy as np
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import paper_times
import tools
import trade_results
import trade_runs
from running import argument, study, whole

# The preset Paper sets ReturnMode, too, which the judge needs otherwise: its settings one by one.
PRESETS = {"Preview": {"Preset": Filter.PRESET_PREVIEW}, "Draft": {"Preset": Filter.PRESET_DRAFT}, "default": {},
           "Standard": {"Preset": Filter.PRESET_STANDARD}, "Reference": {"Preset": Filter.PRESET_REFERENCE}, "Paper": paper_times.SCAN}
SCENES = "zsss_structures", "phnl"


@study(argument("--seeds", type=whole(1, 100), default=3, help="scans to judge, default 3"),
       argument("--reference-rays", type=whole(100, 1000000), default=10000, help="default 10000"))
def main(options):
    folder, found = os.environ.get("AVIANLIDAR_SCENES_DIR"), {}
    for scene in ("airport", *(pathlib.Path(folder, f"{name}.lidarscene.json") for name in SCENES if folder)):
        subject = trade_runs.Subject(scene, "airport16")
        reference = trade_runs.Reference(subject, options.reference_rays)
        for name, settings in PRESETS.items():
            runs = trade_runs.judged(reference, {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}, range(options.seeds))
            wrong = [100 * np.mean([one[kind] for one, _ in runs]) / len(reference.echoes["beam_id"]) for kind in ("missed", "false")]
            found.setdefault(name, []).append((subject.name, [
                trade_results.amount("energy", trade_runs.rms_of(runs, "energy")), *(f"{share:.2f} %" for share in wrong),
                f"{np.median([run.cpu for _, run in runs]):.2f} s"]))
    head = "scene", "preset", "rms error of energy", "missed", "invented", "time of one core"
    rows = [(scene, name, *values) for name, scenes in found.items() for scene, values in scenes]
    tools.leave(options.out, "presets", head, sorted(rows, key=lambda row: (row[0] != "airport", row[0])), left=2)
    return rows
