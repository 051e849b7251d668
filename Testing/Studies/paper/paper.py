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

# Of the pictures, x and y in m: main buildings and lidar (Fig. 16), a part of the facade of Terminal 1 (Fig. 17), and its
# northern end, which faces the lidar.
AIRPORT = (-700, 900), (-1300, 900)
SMEARED = (444, 480), (-120, -20)
FACADE = (440, 500), (-102, -32)

BLUE = 210  # deg: hues from here to 240 are called blue


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


def hues_of(name, echoes):
    """Eq. 13 over the points of an object, degrees; none where the scene does not have it."""
    known = tools.strings(echoes, "object_names")
    coloured = running.made(vtkAvianLidarHSBColorMap(), InputData=echoes)
    return column(coloured, "hue")[column(coloured, "object_id") == known.index(name)] if name in known else np.empty(0)


def smear(name, echoes):
    """Row of how far the points of one beam on an object lie apart in range."""
    known = tools.strings(echoes, "object_names")
    mine = column(echoes, "object_id") == (known.index(name) if name in known else -1)
    beams, ranges = column(echoes, "beam_id")[mine], column(echoes, "distance_m")[mine]
    spans = [np.ptp(ranges[beams == beam]) for beam in np.unique(beams)]
    return [(f"range between the first and the last point of a beam on {name}, median and 90 % (m)",
             "{:.1f}, {:.1f}".format(*np.percentile(spans, (50, 90))) if spans else "-")]


def median_of(hues):
    return f"{np.median(hues):.0f}" if len(hues) else "-"


def hue_rows(subject, lidar, settings):
    """Rows of the colours of Terminal 1, also with a pulse and range units of 1 ns instead of 5 ns."""
    own = {name: getattr(subject.sensor, "Get" + name)() for name in ("PulseWidth", "SamplingInterval")}
    running.set_all(subject.sensor, dict.fromkeys(own, 1e-9))
    finer = scan(subject, settings, 0, 0)
    running.set_all(subject.sensor, own)
    rows = []
    for one, words in ((lidar, ""), (finer, " in range units of 1 ns")):
        hues = hues_of("Terminal 1", one.GetOutput())
        rows += [(f"median hue of Terminal 1{words} (deg)", median_of(hues)),
                 (f"- {BLUE} or more{words}", f"{100 * np.mean(hues >= BLUE):.0f} %" if len(hues) else "-")]
    return rows


def counts(subject, lidar, returns):
    """Rows of what was counted in one scan."""
    report = {name: column(lidar.GetOutput(1), name) for name in ("status", "candidates", "rays_traced")}
    perceived = np.isin(report["status"], (0, 3))
    return [("nodes of the tree", subject.tree.GetNumberOfNodes()), ("beams", len(perceived)),
            ("- with echoes", int(perceived.sum())), ("rays traced, as reported", int(report["rays_traced"].sum())),
            ("triangles tested per beam with echoes", f"{report['candidates'][perceived].mean():.1f}"),
            ("points", lidar.GetOutput().GetNumberOfPoints()),
            ("returns", returns), *smear("Terminal 1", lidar.GetOutput())]


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
                *counts(mine, lidar, returns.GetOutput().GetNumberOfPoints()), *hue_rows(mine, lidar, settings),
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
        with tools.figure(options.out / "terminal-1.png", 1, 3, figsize=(13, 7), width_ratios=(1.9, 1, 1)) as axes:
            by_paper = [one for one in shown if one[2].endswith("paper")]
            tools.from_above(axes[0], *by_paper[0][:2], AIRPORT, by_paper[0][2], legend=False)
            for axis, (scene, echoes, title) in zip(axes[1:], by_paper):
                dots = tools.from_above(axis, scene, echoes, SMEARED, title, 24, legend=False)
                axis.set_title(title, loc="left")
            axes[-1].figure.colorbar(dots, ax=axes, label="energy (µJ)", shrink=0.6)
    return scans
