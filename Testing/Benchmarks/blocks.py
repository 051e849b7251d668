#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does it cost that a scene is many blocks? Times Update() of the collision tree and of the echo filter (Airport16) on
scenes of many blocks, over the times on the same triangles in one block.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Testing/Benchmarks/blocks.py [scene.lidarscene.json ...]

Where AVIANLIDAR_DATA_DIR names the folder of the data, the placed models of an airport are measured, too."""
import csv
import json
import os
import pathlib
import statistics
import sys
import tempfile
import time

import numpy as np
import vtk
from vtk.util import numpy_support

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "Examples" / "common"))
import running  # noqa: E402
from avianlidar.vtkAvianLidar import (vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree,  # noqa: E402
                                      vtkAvianLidarEchoFilter)

ROUNDS = 9


def block(points):
    """Triangles of three points each, of the material Wall."""
    poly, cells, place = vtk.vtkPolyData(), vtk.vtkCellArray(), vtk.vtkPoints()
    place.SetData(numpy_support.numpy_to_vtk(points, deep=True))
    poly.SetPoints(place)
    corners = np.arange(len(points))
    cells.SetData(numpy_support.numpy_to_vtkIdTypeArray(np.append(corners[::3], len(points)), deep=True),
                  numpy_support.numpy_to_vtkIdTypeArray(corners, deep=True))
    poly.SetPolys(cells)
    for name, value in (("kd", 0.146), ("ks", 0.054), ("kp", 112.0)):
        array = numpy_support.numpy_to_vtk(np.full(len(points) // 3, value), deep=True)
        array.SetName(name)
        poly.GetCellData().AddArray(array)
    return poly


def crowd(blocks, triangles):
    """Blocks of so many random triangles within 8 m, all within 2 km."""
    random = np.random.default_rng(1)
    scene = vtk.vtkMultiBlockDataSet()
    for i in range(blocks):
        centre = random.uniform((-2000, -2000, 0), (2000, 2000, 20))
        middles = centre + random.uniform(-8, 8, (triangles, 1, 3))
        points = (middles + random.uniform(-3, 3, (triangles, 3, 3))).reshape(-1, 3)
        scene.SetBlock(i, block(np.abs(points, where=[False, False, True], out=points)))
        scene.GetMetaData(i).Set(vtk.vtkCompositeDataSet.NAME(), f"object {i}")
    return scene


def placed(folder, number):
    """The models of a folder with instances.csv, placed as it says, the whole again 7 km on until there are so many."""
    with open(folder / "instances.csv", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    scene = {"version": 1, "objects": []}
    for i in range(number):
        row, turn = rows[i % len(rows)], i // len(rows)
        place = [float(row["east_m"]) + 7000 * (turn % 4), float(row["north_m"]) + 7000 * (turn // 4), float(row["up_m"])]
        scene["objects"].append({"name": f"object {i}", "file": str(folder / "models" / row["model_obj"]),
                                 "position": place, "rotation": -float(row["stg_heading_deg"]), "material": "Wall"})
    with tempfile.TemporaryDirectory() as temporary:
        file = pathlib.Path(temporary) / "placed.lidarscene.json"
        file.write_text(json.dumps(scene), encoding="utf-8")
        begin = time.perf_counter()
        made = running.read_scene(str(file)).GetOutput()
        print(f"{number:,} placed models read in {time.perf_counter() - begin:.2f} s", file=sys.stderr)
        return made


def leaves(scene):
    iterator = scene.NewIterator()
    iterator.UnRegister(None)
    found = []
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        found.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return found


def in_one(scene):
    append = vtk.vtkAppendPolyData()
    for leaf in leaves(scene):
        append.AddInputData(leaf)
    append.SetOutputPointsPrecision(vtk.vtkAlgorithm.DOUBLE_PRECISION)
    append.Update()
    return append.GetOutput()


def tree_of(scene):
    tree = vtkAvianLidarCollisionTree()
    tree.SetInputData(scene)
    return tree


def echoes_of(scene):
    beams, echoes = vtkAvianLidarBeamSource(), vtkAvianLidarEchoFilter()
    beams.SetPresetToAirport16()
    beams.SetPosition(0, 0, 3)
    beams.Update()
    echoes.SetInputConnection(beams.GetOutputPort())
    echoes.SetInputData(1, scene)
    return echoes


def seconds(algorithm):
    begin = time.perf_counter()
    running.update(algorithm)
    return time.perf_counter() - begin


def main(files):
    scenes = {"4,000 blocks of 50 random triangles": crowd(4000, 50), "5,221 blocks of 422 random triangles": crowd(5221, 422)}
    if os.environ.get("AVIANLIDAR_DATA_DIR"):
        folder = pathlib.Path(os.environ["AVIANLIDAR_DATA_DIR"]) / "airport_zsss"
        for number in (500, 5221):
            scenes[f"Hongqiao, {number:,} placed models"] = placed(folder, number)
    for file in files:
        scenes[pathlib.Path(file).name.split(".")[0]] = running.read_scene(file).GetOutput()
    print("| scene | blocks | triangles | tree, ms in one block | over that | echo filter, ms in one block | over that |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name, many in scenes.items():
        if isinstance(many, vtk.vtkPolyData):
            print(f"{name}: is one block", file=sys.stderr)
            continue
        one, cells = in_one(many), []
        for make in (tree_of, echoes_of):
            times = [(seconds(make(one)), seconds(make(many))) for _ in range(ROUNDS)]  # by turns
            alone, parted = (statistics.median(each) for each in zip(*times))
            cells.append(f"{1000 * alone:.1f} | {parted / alone:.2f}")
        print(f"| {name} | {len(leaves(many)):,} | {one.GetNumberOfPolys():,} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
