# SPDX-License-Identifier: BSD-3-Clause
"""The paper's configuration beside this project's default: scans the corridor and the airport with both, counts the
echoes that are invented or missed, and leaves a table and a picture.

    Testing/Studies/run.py paper

TREE and SCAN are the paper's configuration: copy them. Documentation/paper.md says sentence by sentence what the paper
claims and where this project differs.
"""
import copy

import numpy as np

import avianlidar as al
from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree as Tree
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter
from avianlidar.vtkAvianLidar import vtkAvianLidarHSBColorMap

import running
import tools
import trade_results
import trade_runs
from running import argument, column, study, whole

# Properties of vtkAvianLidarCollisionTree: a k-D tree of boxes (Sec. 5.1), one triangle in a leaf (Algorithm 1).
TREE = {"SplitRule": Tree.SPLIT_RULE_MEDIAN, "BoundingVolume": Tree.BOUNDING_VOLUME_AABB, "MaximumLeafSize": 1}

# Properties of vtkAvianLidarEchoFilter.
SCAN = {"RaysPerBeam": 100,                                                     # N of Table 2
        "Sampling": Filter.SAMPLING_MONTE_CARLO,                                # Sec. 2.1: no strata
        "BatchCollisionDetection": Filter.BATCH_COLLISION_DETECTION_BEAMS,      # Sec. 3.2, 3.3: to S_potential
        "BeamConstraint": True, "LightEnergyConstraint": True,                  # Sec. 3.4
        "LightEnergyThreshold": Filter.LIGHT_ENERGY_THRESHOLD_LIMIT,            # Sec. 3.4
        "NumberOfReflections": 2,                                               # Sec. 3.4
        "ReflectanceModel": Filter.REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG,       # Eq. 8
        "Noise": True,                                                          # Eq. 11
        "ReturnMode": Filter.RETURN_MODE_RANGE_UNITS,                           # Eq. 10, 12: one point per range unit
        "BeamSamples": Filter.BEAM_SAMPLES_RAYS}                                # Sec. 2.1: N rays

# What original ray tracing does without.
ORIGINAL = {"BatchCollisionDetection": Filter.BATCH_COLLISION_DETECTION_RAYS, "BeamConstraint": False, "LightEnergyConstraint": False}
PAPER_RATIOS = {"CorridorC16": "130/83 = 1.57", "Airport16": "1439/1122 = 1.28", "Airport32": "1831/1633 = 1.12"}

SENSORS = (("corridor", "corridor"), ("airport", "airport16"), ("airport", "airport32"))
CONFIGURATIONS = {"paper": (TREE, SCAN), "default": ({}, {})}

# Of the picture: the northern end of the facade of Terminal 1 that faces the lidar, m.
FACADE = (440, 500), (-102, -32)


def configured(subject, tree_settings):
    """The same scene and sensor with another tree."""
    other = copy.copy(subject)
    other.tree = Tree()
    running.made(other.tree, InputDataObject=subject.tree.GetInputDataObject(0, 0), **tree_settings)
    return other


def scan(subject, settings, seed, threads):
    """A filter that has scanned."""
    return running.scanned(subject.sensor, subject.tree, AttenuationCoefficient=subject.attenuation, Seed=seed,
                           NumberOfThreads=threads, **settings)


def errors(reference, subject, settings, seeds):
    """Rows about the returns, runs of range units, of several scans against the reference, and the time of one core."""
    settings = {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}
    runs = trade_runs.judged(reference, settings, range(seeds), subject)
    true = len(reference.echoes["beam_id"])
    energy = trade_runs.rms_of(runs, "energy")
    return [*((f"- {kind}", f"{100 * np.mean([one[name] for one, _ in runs]) / true:.1f} %")
              for kind, name in (("missed", "missed"), ("invented", "false"))),
            ("rms error of energy", trade_results.amount("energy", energy)),
            ("time of one core (s)", f"{np.median([run.cpu for _, run in runs]):.3f}")]


def times(subject, turns):
    """Rows of the time of one core, in turns: original ray tracing, without the three accelerations, and the paper's method."""
    ways = {"original ray tracing (s)": {**SCAN, **ORIGINAL}, "proposed (s)": SCAN}
    seconds = {name: [] for name in ways}
    for turn in range(turns):
        for name, settings in ways.items():
            seconds[name].append(trade_runs.scan(subject, settings, turn).cpu)
    original, proposed = (np.median(seconds[name]) for name in ways)
    return [("triangles", subject.tree.GetOutput().GetNumberOfCells()),
            *((name, f"{np.median(values):.3f}") for name, values in seconds.items()),
            ("original / proposed", f"{original / proposed:.2f}"), ("the paper", PAPER_RATIOS[subject.sensor_name])]


def hue_of(name, echoes):
    """The median of Eq. 13 over the points of an object."""
    rows = tools.hue_of(name, running.made(vtkAvianLidarHSBColorMap(), InputData=echoes))
    return rows[0][1] if rows else "-"


def counts(subject, lidar, returns):
    """Rows of what was counted in one scan."""
    report = {name: column(lidar.GetOutput(1), name) for name in ("status", "candidates", "rays_traced")}
    perceived = np.isin(report["status"], (0, 3))
    return [("nodes of the tree", subject.tree.GetNumberOfNodes()), ("beams", len(perceived)),
            ("- with echoes", int(perceived.sum())), ("rays traced, as reported", int(report["rays_traced"].sum())),
            ("triangles tested per beam with echoes", f"{report['candidates'][perceived].mean():.1f}"),
            ("points", lidar.GetOutput().GetNumberOfPoints()),
            ("median hue of Terminal 1 (deg)", hue_of("Terminal 1", lidar.GetOutput())), ("returns", returns)]


@study(argument("--seeds", type=whole(1, 100), default=3, help="scans to judge, default 3"),
       argument("--reference-rays", type=whole(100, 1000000), default=10000, help="default 10000"),
       argument("--turns", type=whole(1, 100), default=7, help="of timed scans, default 7"),
       argument("--seed", type=whole(-2**31, 2**31 - 1), default=0, help="of what is counted and drawn"),
       argument("--threads", type=whole(0, 4096), default=0, help="default 0: as many as there are cores"),
       argument("--no-pictures", action="store_true", help="tables alone"))
def main(options):
    columns, scans, shown, ratios = {}, {}, [], {}
    for name, sensor in SENSORS:
        subject = trade_runs.Subject(name, sensor)
        reference = trade_runs.Reference(subject, options.reference_rays)
        for words, (tree_settings, settings) in CONFIGURATIONS.items():
            mine = configured(subject, tree_settings)
            returns = scan(mine, {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}, options.seed, options.threads)
            lidar = scan(mine, settings, options.seed, options.threads)
            scans[f"{subject.sensor_name}, {words}"] = mine, lidar
            columns[f"{subject.sensor_name}, {words}"] = [
                *counts(mine, lidar, returns.GetOutput().GetNumberOfPoints()), ("returns of the reference", len(reference.echoes["beam_id"])),
                *errors(reference, mine, settings, options.seeds)]
            if words == "paper":
                ratios[subject.sensor_name] = times(mine, options.turns)
            if subject.sensor_name == "Airport16":
                shown.append((mine.tree.GetInputDataObject(0, 0), al.Cloud(lidar.GetOutput()), f"Terminal 1, {words}"))
    tools.leave(options.out, "paper-times", *tools.columns(ratios))
    tools.leave(options.out, "table", *tools.columns(columns))
    if not options.no_pictures:
        with tools.figure(options.out / "facade.png", 1, 2, figsize=(16, 8)) as axes:
            for axis, (scene, echoes, title) in zip(axes, shown):
                tools.from_above(axis, scene, echoes, FACADE, title, 40)
    return scans
