# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the plugin share."""

import importlib.util
import os
import sys

import avianlidar.vtkAvianLidar as module
from paraview import servermanager, simple
from vtkmodules.vtkParallelCore import vtkDummyController, vtkMultiProcessController

PLUGIN = os.environ["AVIANLIDAR_PLUGIN"]
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
OUTPUT_DIR = os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]
SCENE = os.path.join(SOURCE_DIR, "Examples", "airport", "scene", "hongqiao.lidarscene.json")


sys.path.insert(0, os.path.join(SOURCE_DIR, "Testing", "Python"))
import echotools  # noqa: E402
import pictures  # noqa: E402
from echotools import assert_same  # noqa: E402,F401  # for the tests


def load_macro(path):
    spec = importlib.util.spec_from_file_location("macro", path)
    macro = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(macro)
    return macro


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
    return {name: values.copy() for name, values in echotools.arrays(dataset).items() if name not in echotools.COSTS}


def fetch(source, port=0):
    """The output of a proxy as sorted arrays in this process."""
    return arrays_of(servermanager.Fetch(source, idx=port))


def direct_echoes(columns):
    """The airport's scan with the classes themselves, in this process alone: (beams, echo filter)."""
    reader = module.vtkAvianLidarSceneReader()
    reader.SetFileName(SCENE)
    beams = module.vtkAvianLidarBeamSource()
    beams.SetPresetToAirport16()
    echotools.given(beams, Position=(0, 0, 3), AzimuthStep=360 / columns)
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


def colour_of(function, value):
    """The colour of a value by a function of colours."""
    colour = [0.0, 0.0, 0.0]
    function.GetColor(value, colour)
    return colour


def compare(name):
    """The picture in the folder for temporary files with the baseline of that name."""
    pictures.compare(os.path.join(OUTPUT_DIR, name), name)
