# SPDX-License-Identifier: BSD-3-Clause
"""What the studies share: their arguments, pipelines of VTK classes, and beams."""
import csv
import functools
import os
import pathlib
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

from avianlidar._cloud import vertices
from avianlidar._pipeline import update
from avianlidar.apps.coverage._targets import SIDES as BOX_SIDES  # noqa: F401 of BOX
from avianlidar.vtkAvianLidar import (vtkAvianLidarCloudComparison, vtkAvianLidarEchoFilter, vtkAvianLidarMaterial,
                                      vtkAvianLidarSceneReader)

import tools
from tools import above_zero, file, finite  # noqa: F401  (types of arguments)

AIRPORT = pathlib.Path(__file__).resolve().parents[3] / "Examples" / "airport" / "scene" / "hongqiao.lidarscene.json"
FOOTPRINTS = AIRPORT.with_name("hongqiao.geojson")
# Corners and triangles of a box with sides of 1.
BOX = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])


def whole(low, high):
    """The type of an argument: an integer from low to high."""
    return tools.number(int, low, high)


def argument(*flags, **options):
    """An argument of a study, as argparse has it."""
    return flags, options


def study(*arguments, data=(), out=None):
    """Make `main(options)` of a study take arguments: `main(argv)`, with --out and those given here.

    data  files and folders below --data (default: AVIANLIDAR_DATA_DIR) that have to be there
    out   folder for results below build/, default: the name of the study
    """
    def decorate(work):
        @functools.wraps(work)
        def main(argv=None):
            name = work.__module__
            parser = tools.Parser(prog=f"run.py {name}", description=sys.modules[name].__doc__.split("\n\n")[0])
            folder = pathlib.Path("build", out or name)
            parser.add_argument("-o", "--out", type=pathlib.Path, default=folder,
                                help=f"folder for results, default {folder}")
            for flags, more in arguments:
                parser.add_argument(*flags, **more)
            if data:
                parser.add_argument("--data", type=pathlib.Path,
                                    default=pathlib.Path(os.environ.get("AVIANLIDAR_DATA_DIR", "")),
                                    help="the data folder, default AVIANLIDAR_DATA_DIR")
            options = parser.parse_args(argv)
            missing = [str(options.data / one) for one in data if not (options.data / one).exists()]
            if missing:
                parser.error(f"--data: there is no {missing[0]}")
            return work(options)
        return main
    return decorate


def set_all(algorithm, properties):
    """Set properties by their names in C++, values of several numbers as tuples."""
    for name, value in properties.items():
        getattr(algorithm, "Set" + name)(*value if isinstance(value, tuple) else (value,))
    return algorithm


def made(algorithm, **properties):
    """The output of a source or filter with these properties."""
    update(set_all(algorithm, properties))
    return algorithm.GetOutputDataObject(0)


def scanned(beams, tree, **properties):
    """An echo filter that has scanned. @param beams data, or an algorithm"""
    lidar = vtkAvianLidarEchoFilter()
    if beams.IsA("vtkDataObject"):
        lidar.SetInputDataObject(0, beams)
    else:
        lidar.SetInputConnection(0, beams.GetOutputPort())
    lidar.SetSurfacesConnection(tree.GetOutputPort())
    update(set_all(lidar, properties))
    return lidar


def seconds_of(work):
    """How long it takes, s."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def rms(values):
    """The root mean square; NaN without values."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def rows_of(path):
    """The rows of a CSV file as dictionaries."""
    with open(path, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def column(data, name):
    """A copy of a point array."""
    return vtk_to_numpy(data.GetPointData().GetArray(name)).copy()


def apart(simulated, actual):
    """The comparison of two clouds (n x 3, m): Hausdorff distance, RMSE (paper, Eq. 19, 20), density-aware Chamfer
    distance."""
    comparison = vtkAvianLidarCloudComparison()
    comparison.SetInputData(0, vertices(np.asarray(simulated, float)))
    comparison.SetInputData(1, vertices(np.asarray(actual, float)))
    update(comparison)
    return comparison


def some_beams(beams, numbers):
    """A copy of some beams."""
    found = vertices(vtk_to_numpy(beams.GetPoints().GetData())[numbers])
    for i in range(beams.GetPointData().GetNumberOfArrays()):
        array = beams.GetPointData().GetArray(i)
        copy = numpy_to_vtk(vtk_to_numpy(array)[numbers], deep=True, array_type=array.GetDataType())
        copy.SetName(array.GetName())
        found.GetPointData().AddArray(copy)
    found.GetFieldData().DeepCopy(beams.GetFieldData())
    return found


def quads(corners):
    """Surfaces of n quadrangles from n x 4 x 3 coordinates; corners in one place are one point."""
    data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    places, number = np.unique(np.array(corners, dtype=float).reshape(-1, 3), axis=0, return_inverse=True)
    points.SetData(numpy_to_vtk(places, deep=True))
    for quad in number.reshape(-1, 4):
        cells.InsertNextCell(4, quad)
    data.SetPoints(points)
    data.SetPolys(cells)
    return data


def painted(scene, materials):
    """Blocks with their materials. @param materials patterns of names, each with its material, the later ones win"""
    for pattern, material in materials:
        painter = vtkAvianLidarMaterial()
        painter.SetInputData(scene)
        painter.SetBlockNamePattern(pattern)
        getattr(painter, "SetMaterialTo" + material)()
        painter.Update()
        scene = painter.GetOutputDataObject(0)
    return scene


def built_scene(name):
    """The file of a scene that the build makes from the data folder, in AVIANLIDAR_SCENES_DIR; None without it."""
    path = pathlib.Path(os.environ.get("AVIANLIDAR_SCENES_DIR", ""), f"{name}.lidarscene.json")
    return path if path.is_file() else None


def read_scene(name):
    """The reader of a scene that has surfaces."""
    reader = vtkAvianLidarSceneReader()
    reader.SetFileName(str(name))
    update(reader)
    if reader.GetOutput().GetNumberOfBlocks() == 0:
        sys.exit(f"{name}: no surfaces")
    return reader
