# SPDX-License-Identifier: BSD-3-Clause
"""How long scans of the airport through media take, beside clear air: a first scan, and one that lights known hits again.

    Testing/Studies/run.py media_time --out build/weather-media
"""
import warnings

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

import avianlidar as al
import tools
from avianlidar.vtkAvianLidar import vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter, vtkAvianLidarMedium
from running import AIRPORT, made, read_scene, seconds_of, set_all, study

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


def scan(scene, media, properties):
    """A scan with its collision tree built, and its beams."""
    blocks = vtkMultiBlockDataSet()
    blocks.ShallowCopy(scene)
    for number, medium in enumerate(media):
        blocks.SetBlock(scene.GetNumberOfBlocks() + number, made(vtkAvianLidarMedium(), **medium))
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


@study()
def main(options):
    warnings.simplefilter("ignore", RuntimeWarning)
    reader = read_scene(AIRPORT)
    times = {name: ([], []) for name, *_ in CASES}
    points = {}
    for _ in range(RUNS):  # in turns: all meet the same noise of the machine
        for name, media, properties in CASES:
            echo = scan(reader.GetOutput(), media, properties)
            times[name][0].append(seconds_of(echo.Update))
            points[name] = echo.GetOutput().GetNumberOfPoints()
            echo.SetAttenuationCoefficient(3.6e-5)
            echo.Modified()
            times[name][1].append(seconds_of(echo.Update))
    medians = {name: np.median(values, axis=1) for name, values in times.items()}
    clear = medians["clear air"]
    tools.leave(options.out, "weather-media", ("", "points", "first, s", "of clear air", "lit again, s", "of clear air"), [
        (name, f"{points[name]:,}", f"{first:.2f}", f"{first / clear[0]:.1f}", f"{again:.2f}", f"{again / clear[1]:.1f}")
        for name, (first, again) in medians.items()])
