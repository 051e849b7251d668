# SPDX-License-Identifier: BSD-3-Clause
"""The paper's configuration beside this project's default: scans the corridor and the airport with both, counts the
echoes that are invented or missed, and leaves a table and a picture.

    Testing/Studies/run.py paper

The paper's configuration is that of the presets Paper, set one by one (paper_times.py) where a run differs in one of
them. Documentation/evidence/paper.md has the paper's claims and where this project differs.
"""
import copy

import numpy as np

import avianlidar as al
from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree as Tree
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter
from avianlidar.vtkAvianLidar import vtkAvianLidarHSBColorMap

import paper_times
import running
import tools
import trade_results
import trade_runs
from paper_times import SCAN
from running import argument, column, study, whole

SENSORS = (("corridor", "corridor"), ("airport", "airport16"), ("airport", "airport32"))
CONFIGURATIONS = {"paper": ({"Preset": Tree.PRESET_PAPER}, SCAN), "default": ({}, {})}

# Of the pictures, x and y in m: the facade of Terminal 1, and its northern end, which faces the lidar.
TERMINAL_1 = (445, 565), (-460, 0)
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
       argument("--no-pictures", action="store_true", help="tables alone"))
def main(options):
    columns, scans, shown, ratios = {}, {}, [], {}
    for name, sensor in SENSORS:
        subject = trade_runs.subject_of(name, sensor)
        reference = trade_runs.Reference(subject, options.reference_rays)
        for words, (tree_settings, settings) in CONFIGURATIONS.items():
            mine = configured(subject, tree_settings)
            returns = scan(mine, {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}, 0, 0)
            lidar = scan(mine, settings, 0, 0)
            scans[f"{subject.sensor_name}, {words}"] = mine, lidar
            columns[f"{subject.sensor_name}, {words}"] = [
                *counts(mine, lidar, returns.GetOutput().GetNumberOfPoints()),
                ("returns of the reference", len(reference.echoes["beam_id"])),
                *errors(reference, mine, settings, options.seeds)]
            if name == "airport":
                shown.append((mine.tree.GetInputDataObject(0, 0), al.Cloud(lidar.GetOutput()),
                              f"{subject.sensor_name}, {words}"))
        ratios.update(paper_times.times(subject, options.turns))
    tools.leave(options.out, "paper-times", *tools.columns(ratios))
    tools.leave(options.out, "table", *tools.columns(columns))
    if not options.no_pictures:
        with tools.figure(options.out / "facade.png", 1, 2, figsize=(16, 8)) as axes:
            for axis, (scene, echoes, title) in zip(axes, shown):
                tools.from_above(axis, scene, echoes, FACADE, f"Terminal 1, {title}", 40)
        with tools.figure(options.out / "terminal-1.png", 1, 4, figsize=(18, 10)) as axes:
            for axis, (scene, echoes, title) in zip(axes, shown):
                tools.from_above(axis, scene, echoes, TERMINAL_1, title)
    return scans
