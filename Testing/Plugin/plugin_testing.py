# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the plugin share."""

import os

import avianlidar.vtkAvianLidar as module
import numpy
from paraview import servermanager, simple
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkParallelCore import vtkDummyController, vtkMultiProcessController

PLUGIN = os.environ["AVIANLIDAR_PLUGIN"]
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
OUTPUT_DIR = os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]
SCENE = os.path.join(SOURCE_DIR, "Examples", "airport", "scene", "hongqiao.lidarscene.json")

THRESHOLD = 15  # image error

# What a run costs, not what it finds.
COSTS = ("candidates", "nodes_visited", "rays_traced")


def load_plugin():
    """Loads the plugin; its functions are then in paraview.simple."""
    simple.LoadPlugin(PLUGIN, remote=False, ns=vars(simple))


def airport(columns=960, **settings):
    """The airport pipeline: (scene, tree, beams, echoes)."""
    scene = simple.OpenDataFile(SCENE)
    tree = simple.AvianLidarCollisionTree(Input=scene)
    beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=360 / columns)
    echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree, **settings)
    return scene, tree, beams, echoes


def arrays_of(dataset):
    """Points and point arrays of a data set by name, sorted by (beam_id, return_number), without costs."""
    data = dataset.GetPointData()
    arrays = {
        data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).copy()
        for i in range(data.GetNumberOfArrays())
        if data.GetArrayName(i) not in COSTS
    }
    if dataset.GetNumberOfPoints():
        arrays["points"] = vtk_to_numpy(dataset.GetPoints().GetData()).copy()
    keys = [arrays[name] for name in ("return_number", "beam_id") if name in arrays]
    order = numpy.lexsort(keys)
    return {name: values[order] for name, values in arrays.items()}


def fetch(source, port=0):
    """The output of a proxy as sorted arrays in this process."""
    return arrays_of(servermanager.Fetch(source, idx=port))


def assert_same(one, other):
    """The same arrays, bit for bit."""
    assert sorted(one) == sorted(other), (sorted(one), sorted(other))
    for name in one:
        a, b = one[name], other[name]
        assert a.dtype == b.dtype and a.shape == b.shape, (name, a.dtype, b.dtype, a.shape, b.shape)
        assert a.tobytes() == b.tobytes(), f"{name} differs in {numpy.count_nonzero(a != b)} values"


def direct_echoes(columns):
    """The airport's scan with the classes themselves, in this process alone: (beams, echo filter)."""
    reader = module.vtkAvianLidarSceneReader()
    reader.SetFileName(SCENE)
    beams = module.vtkAvianLidarBeamSource()
    beams.SetPresetToAirport16()
    beams.SetPosition(0, 0, 3)
    beams.SetAzimuthStep(360 / columns)
    echoes = module.vtkAvianLidarEchoFilter()
    echoes.SetInputConnection(0, beams.GetOutputPort())
    echoes.SetInputConnection(1, reader.GetOutputPort())
    before = vtkMultiProcessController.GetGlobalController()
    vtkMultiProcessController.SetGlobalController(vtkDummyController())
    try:
        echoes.Update()
    finally:
        vtkMultiProcessController.SetGlobalController(before)
    return beams, echoes


def compare(name):
    """The picture in the folder for temporary files with the baseline of that name."""
    readers = vtkPNGReader(), vtkPNGReader()
    for reader, folder in zip(readers, (OUTPUT_DIR, os.environ["AVIANLIDAR_BASELINE_DIR"])):
        reader.SetFileName(os.path.join(folder, name))
    difference = vtkImageDifference()
    difference.SetInputConnection(readers[0].GetOutputPort())
    difference.SetImageConnection(readers[1].GetOutputPort())
    difference.Update()
    error = difference.GetThresholdedError()
    if error > THRESHOLD:
        writer = vtkPNGWriter()
        writer.SetFileName(os.path.join(OUTPUT_DIR, name.replace(".png", ".diff.png")))
        writer.SetInputConnection(difference.GetOutputPort())
        writer.Write()
    assert error <= THRESHOLD, f"{name}: image error {error:.3f}, allowed {THRESHOLD}"
