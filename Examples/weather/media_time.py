#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How long scans of the airport through media take, beside clear air: a first scan, and one that lights known hits again.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/weather/media_time.py --out build/weather-media
"""
import argparse
import pathlib
import statistics
import time
import warnings

from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

import avianlidar as al
from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter, vtkAvianLidarMedium, vtkAvianLidarSceneReader

SCENE = pathlib.Path(__file__).resolve().parent.parent / "airport" / "scene" / "hongqiao.lidarscene.json"
SENSOR, RUNS = "Search905", 5
FOG = {"Kind": 1, "Visibility": 300.0}
TREES = [{"Kind": 5, "Shape": 3, "Center": (100.0 + 20 * (k % 10), 50.0 + 20 * (k // 10), 6.0), "Lengths": (7.0, 7.0, 9.0)} for k in range(100)]
CASES = (
    ("clear air", [], {}),
    ("fog everywhere, 800 m", [], {"Visibility": 800.0, "AirBackscatter": True}),
    ("rain everywhere, 10 mm/h", [], {"RainRate": 10.0}),
    ("a bank of fog, 300 m across", [{**FOG, "Shape": 2, "Center": (200.0, 200.0, 0.0), "Lengths": (300.0, 300.0, 60.0)}], {}),
    ("ground fog, 300 m below 10 m", [{**FOG, "Shape": 1, "Top": 10.0, "Softness": 5.0}], {}),
    ("a hundred trees", TREES, {}),
    ("a shower of 10 mm/h, 400 m across",
     [{"Kind": 3, "RainRate": 10.0, "Shape": 3, "Center": (200.0, 200.0, 0.0), "Lengths": (400.0, 400.0, 900.0)}], {}),
)


def set_all(algorithm, properties):
    for name, value in properties.items():
        getattr(algorithm, "Set" + name)(*value if isinstance(value, tuple) else (value,))
    return algorithm


def scan(scene, media, properties):
    """A scan with its collision tree built, and its beams."""
    blocks = vtkMultiBlockDataSet()
    blocks.ShallowCopy(scene)
    for number, medium in enumerate(media):
        source = set_all(vtkAvianLidarMedium(), medium)
        source.Update()
        blocks.SetBlock(scene.GetNumberOfBlocks() + number, source.GetOutput())
    tree = vtkAvianLidarCollisionTree()
    tree.SetInputData(blocks)
    tree.Update()
    beams = al.Sensor(SENSOR, position=scene.GetFieldData().GetArray("lidar_position").GetTuple(0))
    echo = set_all(vtkAvianLidarEchoFilter(), properties)
    echo.ReportMoversOff()
    echo.SetInputConnection(0, beams.algorithm.GetOutputPort())
    echo.SetInputConnection(1, tree.GetOutputPort())
    beams.algorithm.Update()
    return echo


def seconds(work):
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/weather-media"), help="folder, default build/weather-media")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore", RuntimeWarning)
    reader = vtkAvianLidarSceneReader()
    reader.SetFileName(str(SCENE))
    reader.Update()
    times = {name: ([], []) for name, *_ in CASES}
    points = {}
    for _ in range(RUNS):  # in turns: all meet the same noise of the machine
        for name, media, properties in CASES:
            echo = scan(reader.GetOutput(), media, properties)
            times[name][0].append(seconds(echo.Update))
            points[name] = echo.GetOutput().GetNumberOfPoints()
            echo.SetAttenuationCoefficient(3.6e-5)
            echo.Modified()
            times[name][1].append(seconds(echo.Update))
    clear = [statistics.median(values) for values in times["clear air"]]
    lines = ["| | points | first, s | of clear air | lit again, s | of clear air |", "|---|---:|---:|---:|---:|---:|"]
    for name, values in times.items():
        first, again = (statistics.median(value) for value in values)
        lines.append(f"| {name} | {points[name]:,} | {first:.2f} | {first / clear[0]:.1f} | {again:.2f} | {again / clear[1]:.1f} |")
    text = "\n".join(lines) + "\n"
    (options.out / "weather-media.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
