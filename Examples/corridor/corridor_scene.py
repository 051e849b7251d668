# SPDX-License-Identifier: BSD-3-Clause
"""The corridor of the paper, Sec. 5.2: the scene file, and the surfaces without the object that represents the air."""
import pathlib

from avianlidar import Scene

SCENE = pathlib.Path(__file__).resolve().parent / "scene" / "corridor.lidarscene.json"
LIDAR = (0.0, 0.0, 1.3)  # position of the lidar, m, as in the file; 1.2 m from each wall
WEST = -3.5              # x of the near end, m
HAZE = 8.8e-5            # attenuation, 1/m; Table 2 of the paper has 0.088 without unit, read as 1/km


def build():
    """The surfaces as one named block per object, without the air, which is the last object of the file."""
    scene = Scene(SCENE).surfaces.GetBlock(0)
    scene.RemoveBlock(scene.GetNumberOfBlocks() - 1)
    return scene


def names(scene):
    return [scene.GetMetaData(i).Get(scene.NAME()) for i in range(scene.GetNumberOfBlocks())]
