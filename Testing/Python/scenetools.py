# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the scene reader share: reading with messages caught, and measures of triangles."""
import json
import math
import os
import pathlib

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from avianlidar.vtkAvianLidar import vtkAvianLidarSceneReader
from echotools import Messages

SOURCE = os.environ["AVIANLIDAR_SOURCE_DIR"]
SHIPPED = os.path.join(SOURCE, "Examples", "airport", "scene", "hongqiao.lidarscene.json")


class Read:
    """A scene, read: output, its blocks by name, and what was said."""

    def __init__(self, file, piece=None):
        self.reader = vtkAvianLidarSceneReader()
        heard = Messages(self.reader)
        self.errors, self.warnings = heard.errors, heard.warnings
        self.reader.SetFileName(file)
        if piece is None:
            self.reader.Update()
        else:
            self.reader.UpdatePiece(piece[0], piece[1], 0)
        self.output = self.reader.GetOutput()
        self.names = self.strings("object_names")
        self.blocks = [self.output.GetBlock(i) for i in range(self.output.GetNumberOfBlocks())]

    def strings(self, name, data=None):
        array = (data or self.output).GetFieldData().GetAbstractArray(name)
        return [] if array is None else [array.GetValue(i) for i in range(array.GetNumberOfValues())]

    def block(self, name):
        return self.blocks[self.names.index(name)]


def corners(block):
    """Triangles as an array of n x 3 corners x 3 coordinates."""
    assert block.GetNumberOfCells() == block.GetNumberOfPolys()
    assert block.GetPoints().GetData().GetDataTypeAsString() == "double"
    cells = vtk_to_numpy(block.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(block.GetPoints().GetData())[cells]


def normals(triangles):
    """Normals whose lengths are the triangles' areas."""
    return 0.5 * np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def areas(triangles):
    return np.linalg.norm(normals(triangles), axis=1)


def cells(block, name):
    return vtk_to_numpy(block.GetCellData().GetArray(name))


def volume(triangles):
    """Volume of a closed surface with normals outwards, by the divergence theorem about its own centre."""
    about = triangles - triangles.mean(axis=(0, 1))
    return np.einsum("ij,ij->i", about[:, 0], np.cross(about[:, 1], about[:, 2])).sum() / 6


def is_closed(triangles):
    """Whether every edge belongs to two triangles, which run along it in opposite senses."""
    _, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    t = index.reshape(-1, 3)
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    sense = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, which, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    return bool((count == 2).all() and (np.bincount(which.ravel(), sense) == 0).all())


def write_scene(folder, name, scene):
    """Write a scene file and return its name."""
    file = os.path.join(folder, name + ".lidarscene.json")
    pathlib.Path(file).write_text(scene if isinstance(scene, str) else json.dumps(scene), "utf-8")
    return file


def features(*rows, **more):
    """GeoJSON as text. @param rows kind of the geometry, coordinates, properties; no kind: no geometry @param more
    members of the collection"""
    return json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": properties,
         "geometry": {"type": kind, "coordinates": coordinates} if kind else None}
        for kind, coordinates, properties in rows], **more})


def frame(origin, place):
    """Position and rotation of the tangent frame of a place in that of the origin, by ECEF (WGS84, the textbook's
    formula)."""
    def ecef(p):
        a, f = 6378137.0, 1 / 298.257223563
        lat, lon = math.radians(p["latitude"]), math.radians(p["longitude"])
        n = a / math.sqrt(1 - f * (2 - f) * math.sin(lat) ** 2)
        return np.array([(n + p["height"]) * math.cos(lat) * math.cos(lon),
                         (n + p["height"]) * math.cos(lat) * math.sin(lon),
                         (n * (1 - f) ** 2 + p["height"]) * math.sin(lat)])

    def axes(p):
        lat, lon = math.radians(p["latitude"]), math.radians(p["longitude"])
        return np.array([[-math.sin(lon), math.cos(lon), 0],
                         [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)],
                         [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]])

    return axes(origin) @ (ecef(place) - ecef(origin)), axes(origin) @ axes(place).T
