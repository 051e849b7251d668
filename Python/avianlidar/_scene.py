# SPDX-License-Identifier: BSD-3-Clause
"""What the lidar sees: surfaces with materials."""
from __future__ import annotations

import os
from typing import Any, Dict, Iterator, List, Optional, Sequence, Union

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkCompositeDataSet, vtkDataObject, vtkFieldData,
                                           vtkMultiBlockDataSet, vtkPolyData)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkAlgorithmOutput

from . import vtkAvianLidar as _wrapped
from ._cloud import field_values
from ._pipeline import Progress, file_name, text_of, update
from ._properties import set_properties

Material = Union[str, Sequence[float]]


def mesh(points, triangles) -> vtkPolyData:
    """Triangles as vtkPolyData.

    points     n rows of x, y, z in metres (any numbers; a copy is kept, in double precision)
    triangles  m rows of three indices into the points; winding does not count

    >>> mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]).GetNumberOfCells()
    1
    """
    places = np.ascontiguousarray(points, dtype=float)
    corners = np.asarray(triangles)
    if places.ndim != 2 or places.shape[1] != 3:
        raise ValueError(f"points have the shape {places.shape}, expected (n, 3)")
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise ValueError(f"triangles have the shape {corners.shape}, expected (m, 3)")
    if corners.dtype.kind not in "iu":
        raise TypeError(f"triangles are of the type {corners.dtype}, expected integers")
    if corners.size and (corners.min() < 0 or corners.max() >= len(places)):
        raise IndexError(f"triangles name points {corners.min()} to {corners.max()}, there are {len(places)}")
    vertices, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    vertices.SetData(numpy_to_vtk(places, deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(corners.ravel(), dtype=np.int64), deep=True))
    surface.SetPoints(vertices)
    surface.SetPolys(cells)
    return surface


def mover(surface: vtkPolyData, positions, times=None, orientations=None) -> vtkPolyData:
    """A surface that moves, for `Scan(movers=...)`: the same surface with poses.

    surface       vtkPolyData in a frame of its own (m), with materials as surfaces have them
    positions     n rows of x, y, z in metres: where the origin of its frame is
    times         n rising times in seconds, on the clock of the beams: absent before the first and after the last;
                  None with one position: always there
    orientations  n unit quaternions w, x, y, z from its frame to the scene's; None: not turned

    >>> pane = mesh([(0, 0, 0), (1, 0, 0), (0, 0, 1)], [(0, 1, 2)])
    >>> mover(pane, [(0, 50, 2), (10, 50, 2)], times=[0, 1]).GetFieldData().GetNumberOfArrays()
    2
    """
    moving = vtkPolyData()
    moving.ShallowCopy(surface)
    moving.SetFieldData(vtkFieldData())
    moving.GetFieldData().PassData(surface.GetFieldData())
    for name, values, width in (("pose_position", positions, 3), ("pose_time", times, 1),
                                ("pose_orientation", orientations, 4)):
        if values is not None:
            rows = np.array(values, dtype=float).reshape(-1, width)
            array = numpy_to_vtk(rows if width > 1 else rows.ravel(), deep=True)
            array.SetName(name)
            moving.GetFieldData().AddArray(array)
    return moving


def _leaf_times(data: vtkPolyData) -> Iterator[int]:
    yield data.GetMTime()  # of its arrays, too, but for those of cells
    for cells in (data.GetVerts(), data.GetLines(), data.GetPolys(), data.GetStrips()):
        if cells.GetNumberOfCells():  # asking for arrays is slow
            yield from (array.GetMTime() for array in (cells.GetOffsetsArray(), cells.GetConnectivityArray()) if array)


def _times(data) -> Iterator[int]:
    if isinstance(data, vtkPolyData):
        yield from _leaf_times(data)
        return
    yield data.GetMTime()
    if isinstance(data, vtkCompositeDataSet):
        nodes = data.NewIterator()
        if hasattr(nodes, "VisitOnlyLeavesOff"):
            nodes.VisitOnlyLeavesOff()
        nodes.InitTraversal()
        while not nodes.IsDoneWithTraversal():
            if nodes.HasCurrentMetaData():
                yield nodes.GetCurrentMetaData().GetMTime()
            node = nodes.GetCurrentDataObject()
            yield from _leaf_times(node) if isinstance(node, vtkPolyData) else (node.GetMTime(),)
            nodes.GoToNextItem()


def time_of(data) -> int:
    """When data or anything in them were last modified: VTK asks a composite, which does not ask its blocks."""
    return max(_times(data))


def _painter(surfaces, material: Optional[Material], name: Optional[str]):
    paint = _wrapped.vtkAvianLidarMaterial()
    paint.SetInputData(surfaces)
    if isinstance(material, str):
        if material.lower() == "custom":
            raise ValueError("a material of one's own is given by its coefficients (kd, ks, kp)")
        set_properties(paint, "Scene", material=material)
    elif material is not None:
        kd, ks, kp = material
        set_properties(paint, "Scene", material="Custom", kd=float(kd), ks=float(ks), kp=float(kp))
    if name:
        paint.SetNameOfObject(text_of(name))
    update(paint)
    return paint


def _read(file: str, progress: Optional[Progress]):
    if not file.endswith(".lidarscene.json"):
        raise ValueError(f"{file}: a scene file ends in .lidarscene.json; read other files with VTK")
    reader = _wrapped.vtkAvianLidarSceneReader()
    reader.SetFileName(file_name(file))
    update(reader, progress)
    return reader.GetOutput()


class Scene:
    """Surfaces with materials, and the collision tree over them, which all scans of the scene share.

    >>> scene = Scene()
    >>> scene.add(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Glass", name="pane")
    >>> scene.objects
    ['pane']
    """

    surfaces: vtkMultiBlockDataSet  # one block for each that was added
    tree: Any  # the vtkAvianLidarCollisionTree

    def __init__(self, surfaces=None, material: Optional[Material] = None, name: Optional[str] = None,
                 progress: Optional[Progress] = None):
        """The arguments are those of `add`; without surfaces the scene is empty. Properties of the tree are set on
        `tree`."""
        self.surfaces = vtkMultiBlockDataSet()
        self._painters: List[Any] = []  # filters that give materials and names to what was added
        self._seen = 0  # VTK's time of the last look at the surfaces
        self.tree = _wrapped.vtkAvianLidarCollisionTree()
        self.tree.SetInputData(self.surfaces)
        if surfaces is not None:
            self.add(surfaces, material, name, progress)

    def add(self, surfaces, material: Optional[Material] = None, name: Optional[str] = None,
            progress: Optional[Progress] = None) -> None:
        """Add surfaces, coordinates in metres east, north and up of the scene's origin.

        surfaces  a scene file (.lidarscene.json); vtkPolyData or a composite of it; a VTK algorithm, which is run; or
                  a pair (points, triangles) of arrays as for `mesh`
        material  `Wall`, `Glass`, `Metal`, `Wood`, or the coefficients (kd, ks, kp), pure numbers; default: what the
                  surfaces have, `Wall` for arrays; VTK data without are taken as `Wall`, with a warning
        name      of the object; default: what the surfaces have
        progress  called with the share done (0 to 1) and the name of the class at work
        """
        if isinstance(surfaces, (str, os.PathLike)):
            data = _read(os.fspath(surfaces), progress)
        elif isinstance(surfaces, vtkAlgorithmOutput):
            update(surfaces.GetProducer(), progress)
            data = surfaces.GetProducer().GetOutputDataObject(surfaces.GetIndex())
        elif isinstance(surfaces, vtkAlgorithm):
            update(surfaces, progress)
            data = surfaces.GetOutputDataObject(0)
        elif isinstance(surfaces, vtkDataObject):
            data = surfaces
        elif isinstance(surfaces, (tuple, list)) and len(surfaces) == 2:
            data = mesh(*surfaces)
            material = "Wall" if material is None else material
        else:
            raise TypeError(f"surfaces are a scene file, VTK data, an algorithm or (points, triangles), not "
                            f"{type(surfaces).__name__}")
        if not isinstance(data, (vtkPolyData, vtkCompositeDataSet)):
            raise TypeError(f"surfaces are vtkPolyData or a composite of it, not {data.GetClassName()}")
        if material is not None or name:
            self._painters.append(_painter(data, material, name))
            data = self._painters[-1].GetOutputDataObject(0)
        self._append(data, name)

    def refresh(self) -> None:
        """See what was edited in place since, as `Modified()` of anything in the surfaces says. The scene and its scans
        do so themselves whenever they are asked; `Update()` of their algorithms does not."""
        for paint in self._painters:
            if time_of(paint.GetInputDataObject(0, 0)) > self._seen:
                paint.Modified()
                update(paint)
        if time_of(self.surfaces) > self._seen:
            self.surfaces.Modified()
            self._seen = self.surfaces.GetMTime()

    def _append(self, data, name: Optional[str]) -> None:
        number = self.surfaces.GetNumberOfBlocks()
        self.surfaces.SetBlock(number, data)
        if name:
            self.surfaces.GetMetaData(number).Set(vtkCompositeDataSet.NAME(), name)
        # Where the scene stands is said by its root; the first that says it counts.
        for field in ("geodetic_origin", "lidar_position"):
            array = data.GetFieldData().GetAbstractArray(field)
            if array and not self.surfaces.GetFieldData().HasArray(field):
                self.surfaces.GetFieldData().AddArray(array)

    def _merged(self) -> vtkPolyData:
        self.refresh()
        update(self.tree)
        return self.tree.GetOutput()

    def _fields(self) -> Dict[str, Any]:
        return field_values(self._merged())

    @property
    def objects(self) -> List[str]:
        """Names of the objects, in the order of `object_id`."""
        return self._fields().get("object_names", [])

    @property
    def materials(self) -> List[str]:
        """Names of the materials, in the order of `material_id`."""
        return self._fields().get("material_names", [])

    @property
    def number_of_triangles(self) -> int:
        """Number of triangles."""
        return self._merged().GetNumberOfPolys()

    @property
    def bounds(self):
        """Least and greatest x, y and z in metres: (x0, x1, y0, y1, z0, z1)."""
        return self._merged().GetBounds()

    @property
    def geodetic_origin(self):
        """Latitude and longitude in degrees and height above the ellipsoid in metres of the origin, or None."""
        return self._root_field("geodetic_origin")

    @property
    def lidar_position(self):
        """Where the scene file puts the lidar, in metres east, north and up, or None."""
        return self._root_field("lidar_position")

    def _root_field(self, name):
        value = field_values(self.surfaces).get(name)
        return None if value is None else tuple(np.ravel(value).tolist())


def load_scene(file, progress: Optional[Progress] = None) -> Scene:
    """The scene of a file .lidarscene.json: meshes, footprints, materials, and where they stand on the Earth.

    `progress` is called with the share done (0 to 1) and the name of the class at work.
    """
    return Scene(os.fspath(file), progress=progress)
