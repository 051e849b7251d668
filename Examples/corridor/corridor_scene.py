# SPDX-License-Identifier: BSD-3-Clause
"""The corridor of the paper, Sec. 5.2: its scene file, and its surfaces without the air."""
import pathlib

from avianlidar import Scene

SCENE = pathlib.Path(__file__).resolve().parent / "scene" / "corridor.lidarscene.json"
LIDAR = (0.0, 0.0, 1.3)  # m, as in the file; 1.2 m from both walls
WEST = -3.5              # m, the near end
HAZE = 8.8e-5            # 1/m: paper, Table 2: 0.088, without unit, read as per kilometre


def build():
    """The surfaces as one named block per object. The air, the last object of the file, is left out."""
    scene = Scene(SCENE).surfaces.GetBlock(0)
    scene.RemoveBlock(scene.GetNumberOfBlocks() - 1)
    return scene


def names(scene):
    return [scene.GetMetaData(i).Get(scene.NAME()) for i in range(scene.GetNumberOfBlocks())]
