# SPDX-License-Identifier: BSD-3-Clause
"""Small scenes, messages and comparisons for the tests of the echo filter and its neighbours."""

import contextlib
import pathlib
import tempfile
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

from avianlidar import vtkAvianLidar as al
from avianlidar._pipeline import update

# Values of BeamSamples.
CELLS = al.vtkAvianLidarEchoFilter.BEAM_SAMPLES_CELLS
RAYS = al.vtkAvianLidarEchoFilter.BEAM_SAMPLES_RAYS


class InFolder(unittest.TestCase):
    """Each test runs in a new folder, which is removed after it."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.enterContext(contextlib.chdir(self.folder))


class Messages:
    """What an algorithm says instead of printing it."""

    def __init__(self, *algorithms):
        self.errors = []
        self.warnings = []
        for algorithm in algorithms:
            for event, into in (("ErrorEvent", self.errors), ("WarningEvent", self.warnings)):
                self._observe(algorithm, event, into)
            self._observe(algorithm.GetExecutive(), "ErrorEvent", [])

    def all(self):
        return self.errors + self.warnings

    @staticmethod
    def _observe(algorithm, event, into):
        def heard(_, __, text):
            into.append(text)

        heard.CallDataType = vtk.VTK_STRING
        algorithm.AddObserver(event, heard)


def box(center, half, material=None, name=None):
    """A box as vtkPolyData of quads, with a material if one is named."""
    x, y, z = (2 * side for side in half)
    cube = output(given(vtk.vtkCubeSource(), Center=center, XLength=x, YLength=y, ZLength=z,
                        OutputPointsPrecision=vtk.vtkAlgorithm.DOUBLE_PRECISION))
    return cube if material is None else painted(cube, material, NameOfObject=name or "")


def painted(data, material, **properties):
    """Surfaces with a material."""
    paint = given(al.vtkAvianLidarMaterial(), InputDataObject=data, **properties)
    getattr(paint, f"SetMaterialTo{material}")()
    return output(paint)


def group(*parts):
    """A multiblock of parts, of which some may be None."""
    blocks = vtk.vtkMultiBlockDataSet()
    for number, part in enumerate(parts):
        blocks.SetBlock(number, part)
    return blocks


def town(seed=1, count=40):
    """A multiblock of boxes around the origin."""
    random = np.random.default_rng(seed)
    blocks = vtk.vtkMultiBlockDataSet()
    for i in range(count):
        angle = 2 * np.pi * random.random()
        distance = 40 + 250 * random.random()
        half = 2 + 8 * random.random(3)
        center = (distance * np.cos(angle), distance * np.sin(angle), half[2] - 3)
        material = ("Wall", "Glass", "Metal", "Wood")[i % 4]
        blocks.SetBlock(i, box(center, half, material))
        blocks.GetMetaData(i).Set(vtk.vtkCompositeDataSet.NAME(), f"house {i}")
    return blocks


def copy_of(data):
    """A copy to change, or to keep beyond the next run."""
    copy = data.NewInstance()
    copy.DeepCopy(data)
    return copy


def output(algorithm):
    """The first output of an algorithm, up to date."""
    algorithm.Update()
    return algorithm.GetOutputDataObject(0)


def given(algorithm, **properties):
    """An algorithm with properties."""
    for name, value in properties.items():
        getattr(algorithm, "Set" + name)(value)
    return algorithm


def bird(**properties):
    """The surface of a bird."""
    source = given(al.vtkAvianLidarBirdSource(), **properties)
    update(source)
    return source.GetOutput()


def sensor(columns=90, channels=4):
    """A beam source of few beams."""
    return given(al.vtkAvianLidarBeamSource(), AzimuthStep=360.0 / columns, NumberOfChannels=channels,
                 ElevationStep=1.0)


def scan(surfaces, beams=None, **properties):
    """An echo filter on data or the output of an algorithm, not yet updated."""
    echo = al.vtkAvianLidarEchoFilter()
    source = beams or sensor()
    if source.IsA("vtkAlgorithm"):
        echo.SetInputConnection(0, source.GetOutputPort())
    else:
        echo.SetInputData(0, source)
    if surfaces.IsA("vtkAlgorithm"):
        echo.SetInputConnection(1, surfaces.GetOutputPort())
    else:
        echo.SetInputData(1, surfaces)
    return given(echo, **properties)


def array(data, name):
    return numpy_support.vtk_to_numpy(data.GetPointData().GetArray(name))


def arrays(data):
    """All point arrays and the points, sorted by beam and return, as {name: numpy array}."""
    points = data.GetPointData()
    names = [points.GetArrayName(i) for i in range(points.GetNumberOfArrays()) if points.GetArray(i)]  # numbers
    result = {name: array(data, name) for name in names}
    if data.GetNumberOfPoints():
        result["points"] = numpy_support.vtk_to_numpy(data.GetPoints().GetData())
    keys = [result[name] for name in ("return_number", "beam_id") if name in result]
    if keys:
        result = {name: values[np.lexsort(keys)] for name, values in result.items()}
    return result


# What a run costs, not what it finds.
COSTS = ("candidates", "nodes_visited", "rays_traced")


def assert_same_bits(one, two, without=()):
    """The same echoes or reports, bit for bit (NaN included)."""
    assert_same(arrays(one), arrays(two), without)


def assert_same(first, second, without=()):
    """The same arrays of two dictionaries."""
    assert first.keys() - without == second.keys() - without, (first.keys(), second.keys())
    for name in first.keys() - without:
        values = first[name]
        assert values.dtype == second[name].dtype, name
        assert values.shape == second[name].shape, (name, values.shape, second[name].shape)
        assert values.tobytes() == second[name].tobytes(), f"{name} differs"
