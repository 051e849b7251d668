#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's configuration beside this project's default: scans the corridor and the airport with both, counts the
echoes that are invented or missed, and leaves a table and a picture.

    PYTHONPATH=$(cat build/paraview/python-path) xvfb-run -a /usr/bin/python3 Examples/paper/paper.py

TREE and SCAN are the paper's configuration: copy them. Documentation/paper.md says sentence by sentence what the paper
claims and where this project differs.
"""
import copy
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree as Tree
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter
from avianlidar.vtkAvianLidar import vtkAvianLidarHSBColorMap

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common"), str(HERE.parent / "airport"), str(HERE.parent / "accuracy_speed")]
import running  # noqa: E402
import tables  # noqa: E402
import trade_results  # noqa: E402
import trade_runs  # noqa: E402

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

# Of the picture: the northern end of the facade of Terminal 1 that faces the lidar. x, x, y, y in metres.
FACADE = (440, 500, -102, -32)


def configured(subject, tree_settings):
    """The same scene and sensor with another tree."""
    other = copy.copy(subject)
    other.tree = Tree()
    other.tree.SetInputDataObject(subject.tree.GetInputDataObject(0, 0))
    for name, value in tree_settings.items():
        getattr(other.tree, "Set" + name)(value)
    running.update(other.tree)
    return other


def scan(subject, settings, seed, threads):
    """A filter that has scanned."""
    lidar = Filter()
    lidar.SetInputConnection(0, subject.sensor.GetOutputPort())
    lidar.SetSurfacesConnection(subject.tree.GetOutputPort())
    lidar.SetAttenuationCoefficient(subject.attenuation)
    lidar.SetSeed(seed)
    lidar.SetNumberOfThreads(threads)
    for name, value in settings.items():
        getattr(lidar, "Set" + name)(value)
    running.update(lidar)
    return lidar


def errors(reference, subject, settings, seeds):
    """Rows about the returns, runs of range units, of several scans against the reference, and the time of one core."""
    settings = {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}
    judged, seconds = [], []
    for seed in range(seeds):
        found = trade_runs.scan(subject, settings, seed)
        judged.append(trade_runs.judge(reference, found))
        seconds.append(found.cpu)
    true = len(reference.echoes["beam_id"])
    energy = trade_runs.rms(np.concatenate([one["energy"] for one in judged]))
    return [*((f"  {kind}", f"{100 * np.mean([one[name] for one in judged]) / true:.1f} %")
              for kind, name in (("missed", "missed"), ("invented", "false"))),
            ("rms error of energy", trade_results.amount("energy", energy)),
            ("time of one core (s)", f"{np.median(seconds):.3f}")]


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
    colors = vtkAvianLidarHSBColorMap()
    colors.SetInputData(echoes)
    running.update(colors)
    rows = tables.hue_of(name, colors.GetOutput())
    return rows[0][1] if rows else "-"


def counts(subject, lidar, returns):
    """Rows of what was counted in one scan."""
    report = {name: vtk_to_numpy(lidar.GetOutput(1).GetPointData().GetArray(name))
              for name in ("status", "candidates", "rays_traced")}
    perceived = np.isin(report["status"], (0, 3))
    return [("nodes of the tree", subject.tree.GetNumberOfNodes()), ("beams", len(perceived)),
            ("  with echoes", int(perceived.sum())), ("rays traced, as reported", int(report["rays_traced"].sum())),
            ("triangles tested per beam with echoes", f"{report['candidates'][perceived].mean():.1f}"),
            ("points", lidar.GetOutput().GetNumberOfPoints()),
            ("median hue of Terminal 1 (deg)", hue_of("Terminal 1", lidar.GetOutput())), ("returns", returns)]


def facade_view(subject, lidar, words):
    """What a scan shows of the facade."""
    import views  # only here: numbers need no display
    colors = vtkAvianLidarHSBColorMap()
    colors.SetInputConnection(lidar.GetOutputPort())
    running.update(colors)
    scene = subject.tree.GetInputDataObject(0, 0)
    return views.from_above(views.plan(scene), colors.GetOutput(), words, "Airport16", FACADE, 9)


def draw(views, file):
    """The views beside each other on one page."""
    from vtkmodules.vtkIOImage import vtkPNGReader
    import pictures
    page = pictures.Page(sum(view.width for view in views), max(view.height for view in views))
    left = 0
    for view in views:
        view.save(file)
        reader = vtkPNGReader()
        reader.SetFileName(str(file))
        reader.Update()
        colors = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
        page.pixels(left, 0, colors[:, :3].reshape(view.height, view.width, 3))
        left += view.width
    page.save(file)


def main(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--seeds", type=running.whole(1, 100), default=3, help="scans to judge, default 3")
    parser.add_argument("--reference-rays", type=running.whole(100, 1000000), default=10000, help="default 10000")
    parser.add_argument("--turns", type=running.whole(1, 100), default=7, help="of timed scans, default 7")
    parser.add_argument("--seed", type=running.whole(-2**31, 2**31 - 1), default=0, help="of what is counted and drawn")
    parser.add_argument("--threads", type=running.whole(0, 4096), default=0, help="default 0: as many as there are cores")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/paper"), help="folder for results")
    parser.add_argument("--no-pictures", action="store_true", help="needs no display")
    options = running.parse(parser, argv)
    columns, scans, views, ratios = {}, {}, [], {}
    for name, sensor in SENSORS:
        subject = trade_runs.Subject(name, sensor)
        reference = trade_runs.Reference(subject, options.reference_rays)
        for words, (tree_settings, settings) in CONFIGURATIONS.items():
            mine = configured(subject, tree_settings)
            returns = scan(mine, {**settings, "ReturnMode": Filter.RETURN_MODE_ALL}, options.seed, options.threads)
            lidar = scan(mine, settings, options.seed, options.threads)
            column = f"{subject.sensor_name}, {words}"
            scans[column] = mine, lidar
            columns[column] = [*counts(mine, lidar, returns.GetOutput().GetNumberOfPoints()),
                               ("returns of the reference", len(reference.echoes["beam_id"])),
                               *errors(reference, mine, settings, options.seeds)]
            if words == "paper":
                ratios[subject.sensor_name] = times(mine, options.turns)
            if subject.sensor_name == "Airport16" and not options.no_pictures:
                views.append(facade_view(mine, lidar, f"Terminal 1, {words}"))
    tables.write(options.out, "paper-times", tables.table(ratios))
    table = tables.table(columns)
    tables.write(options.out, "table", table)
    if views:
        draw(views, options.out / "facade.png")
    print(table)
    return scans


if __name__ == "__main__":
    main()
