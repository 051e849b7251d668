# SPDX-License-Identifier: BSD-3-Clause
"""Scenes: surfaces with materials that a lidar observes."""
import json
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_CHAR
from vtkmodules.vtkCommonCore import vtkCharArray
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkCompositeDataSet, vtkDataObject, vtkFieldData,
                                           vtkMultiBlockDataSet, vtkPolyData)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkAlgorithmOutput
from vtkmodules.vtkParallelCore import vtkCommunicator

from . import _display
from . import vtkAvianLidar as _wrapped
from ._cloud import add_array, as_numpy, field_values, rows_of, with_points
from ._pipeline import Error, Progress, file_name, is_current, text_of, update
from ._properties import choices, choose, get_property, property_names, set_properties
from ._suffixes import POINTS

# Names of the coefficients of a material, also used for cell arrays. Coefficients after the first three are optional.
COEFFICIENTS = tuple(filter(None, map(_wrapped.vtkAvianLidarMaterial.GetCoefficientName, range(100))))
_NUMBERS = range(3, len(COEFFICIENTS) + 1)
_ALL = f"{', '.join(COEFFICIENTS[:_NUMBERS[0]])}, and optionally {', '.join(COEFFICIENTS[_NUMBERS[0]:])}"

Material = str | Sequence[float] | Sequence[str] | np.ndarray


def mesh(points, triangles) -> vtkPolyData:
    """Triangles as vtkPolyData.

    points     n rows of x, y, z in metres, which are copied in double precision
    triangles  m rows of three indices into the points; their winding does not matter

    >>> mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]).GetNumberOfCells()
    1
    """
    places = rows_of("points", points, (3,))
    corners = np.asarray(triangles)
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise ValueError(f"triangles have the shape {corners.shape}, expected (m, 3)")
    if corners.dtype.kind not in "iu":
        raise TypeError(f"triangles are of the type {corners.dtype}, expected integers")
    if corners.size and (corners.min() < 0 or corners.max() >= len(places)):
        raise IndexError(f"triangles name points {corners.min()} to {corners.max()}, there are {len(places)}")
    surface, cells = with_points(places), vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(corners.ravel(), dtype=np.int64), deep=True))
    surface.SetPolys(cells)
    return surface


def mover(surface: vtkPolyData, positions, times=None, orientations=None) -> vtkPolyData:
    """A moving surface for `Scan(movers=...)`: vtkPolyData with poses.

    surface       vtkPolyData in its own frame (m), with materials
    positions     n rows of x, y, z in metres: positions of the frame's origin
    times         n ascending times in seconds, on the clock of the beams. The mover is absent before the first time and
                  after the last. None with one position: the mover is always present
    orientations  n unit quaternions w, x, y, z from the frame of the surface to the scene's frame; None: no rotation

    >>> pane = mesh([(0, 0, 0), (1, 0, 0), (0, 0, 1)], [(0, 1, 2)])
    >>> mover(pane, [(0, 50, 2), (10, 50, 2)], times=[0, 1]).GetFieldData().GetNumberOfArrays()
    2
    """
    moving = vtkPolyData()
    moving.ShallowCopy(surface)
    moving.SetFieldData(vtkFieldData())
    moving.GetFieldData().PassData(surface.GetFieldData())
    for name, what, values, row in (("pose_position", "positions", positions, (3,)), ("pose_time", "times", times, ()),
                                    ("pose_orientation", "orientations", orientations, (4,))):
        if values is not None:
            add_array(moving.GetFieldData(), name, rows_of(what, values, row))
    return moving


def time_of(data) -> int:
    """Time of the last change of data or of anything in the data; VTK's own time leaves out blocks of composites."""
    times = [data.GetMTime()]  # includes arrays, except cell arrays
    if isinstance(data, vtkPolyData):
        for cells in (data.GetVerts(), data.GetLines(), data.GetPolys(), data.GetStrips()):
            if cells.GetNumberOfCells():  # reading these arrays is slow
                times += cells.GetOffsetsArray().GetMTime(), cells.GetConnectivityArray().GetMTime()
    elif isinstance(data, vtkCompositeDataSet):
        nodes = data.NewIterator()
        if hasattr(nodes, "VisitOnlyLeavesOff"):
            nodes.VisitOnlyLeavesOff()
            nodes.TraverseSubTreeOff()
        nodes.InitTraversal()
        while not nodes.IsDoneWithTraversal():
            if nodes.HasCurrentMetaData():
                times.append(nodes.GetCurrentMetaData().GetMTime())
            times.append(time_of(nodes.GetCurrentDataObject()))
            nodes.GoToNextItem()
    return max(times)


def _painter(surfaces, material: Material | None, name: str | None):
    paint = _wrapped.vtkAvianLidarMaterial()
    paint.SetInputData(surfaces)
    if material is None:
        paint.SetMaterial(paint.MATERIAL_UNCHANGED)
    elif isinstance(material, str):
        if material.lower() == "custom":
            raise ValueError(f"a new material is given by its coefficients ({_ALL})")
        set_properties(paint, "Scene", material=material)
    else:
        try:
            numbers = [float(value) for value in material]
            if len(numbers) not in _NUMBERS:
                raise ValueError
        except (TypeError, ValueError):
            raise TypeError(f"material is {material!r}, expected a name ({', '.join(materials())}), the coefficients "
                            f"({_ALL}), or a name or coefficients for each triangle") from None
        set_properties(paint, "Scene", material="Custom", **dict(zip(COEFFICIENTS, numbers)))
    if name is not None:
        paint.SetNameOfObject(text_of(name))
    update(paint)
    return paint


def materials() -> dict[str, tuple[float, ...]]:
    """The materials that are known by name, with their coefficients: diffuse, specular, glossiness (pure numbers;
    paper, Eq. 6 and 7), and further coefficients in the order of `vtkAvianLidarMaterial.GetCoefficientName`.

    >>> materials()["Wall"][:3]
    (0.146, 0.054, 112.0)
    """
    known = _wrapped.vtkAvianLidarMaterial
    return {name: tuple(known.GetMaterialCoefficient(value, k) for k in range(len(COEFFICIENTS)))
            for name, value in choices(known, "Material").items() if known.GetMaterialName(value)}


def _paint_triangles(data, material, name: str | None) -> vtkPolyData:
    """A copy of triangles with one material for each: m names, or m rows of coefficients."""
    try:
        values = np.asarray(material)
        names_only = values.dtype.kind in "UO" and all(isinstance(value, str) for value in values.flat)
        values = values.astype(str if names_only else float)
    except (TypeError, ValueError):
        raise TypeError(f"materials of the triangles are neither names nor rows ({_ALL}) alone") from None
    while isinstance(data, vtkMultiBlockDataSet) and data.GetNumberOfBlocks() == 1:
        data = data.GetBlock(0)
    number = data.GetNumberOfCells() if isinstance(data, vtkPolyData) else None
    if number is None or values.shape[:1] != (number,) or values.shape[1:] not in ((), *((n,) for n in _NUMBERS)):
        raise ValueError(f"materials of the shape {values.shape} for {number or 'a composite of'} triangles, expected "
                         f"one name or one row ({_ALL}) for each triangle of one mesh")
    if values.ndim == 1:
        words = {word: choose(_wrapped.vtkAvianLidarMaterial, "Material", word) for word in np.unique(values)}
        found, numbers = np.unique([words[word] for word in values], return_inverse=True)
        names, rows = list(found), np.array([materials()[name] for name in found])
    else:
        rows, numbers = np.unique(values, axis=0, return_inverse=True)
        names = [f"Custom {i + 1}" for i in range(len(rows))]
        sums = np.column_stack([rows, rows[:, 0] + rows[:, 1]])
        # A coefficient outside its range is an error. The rows of extreme values, also of NaN, stand for all.
        for row in {*sums.argmin(axis=0), *sums.argmax(axis=0)}:
            _painter(mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), rows[row], None)
    painted = vtkPolyData()
    painted.ShallowCopy(_painter(data, "Wall", name).GetOutputDataObject(0))
    ids = numbers.reshape(-1).astype(np.int32)
    for key, column in (("material_id", ids), *zip(COEFFICIENTS, rows.T[:, ids])):
        add_array(painted.GetCellData(), key, column)
    add_array(painted.GetFieldData(), "material_names", names)
    return painted


SCENE = ".lidarscene.json"
FOOTPRINTS = (".geojson", ".osm", ".gpkg", ".shp", ".fgb", ".gml", ".kml")  # formats that contain no mesh


def _mesh_scene(file: str, painted: bool, options: dict[str, Any]) -> dict[str, Any]:
    """The description of a mesh file, as in a scene file. @param painted whether a material replaces the file's own"""
    name = os.path.basename(file)
    if not os.path.exists(file):
        raise FileNotFoundError(f"no such file: {file}")
    if not os.path.isfile(file):
        raise ValueError(f"{file}: is not a regular file")
    if not os.access(file, os.R_OK):
        raise PermissionError(f"{file}: may not be read")
    suffix = os.path.splitext(name)[1].lower()
    if suffix == ".json":
        raise ValueError(f"{file}: a scene file ends in {SCENE}")
    if suffix in FOOTPRINTS:
        words = json.dumps({"version": 1, "origin": dict.fromkeys(("latitude", "longitude", "height"), "?"),
                            "objects": [{"footprints": name, "height": 10}]}).replace('"?"', "?")
        raise ValueError(f"{file}: holds footprints, which become buildings in a scene file: scan a file my{SCENE} "
                         f"beside it with {words}, the origin in degrees and metres "
                         "(Documentation/reference/scene-files.md)")
    if suffix in POINTS:
        raise ValueError(f"{file}: has no surfaces, expected a mesh or a scene file")
    text_of(file)
    if "scale" in options:
        try:
            options["scale"] = np.asarray_chkfinite(options["scale"], dtype=float).tolist()
        except (TypeError, ValueError):
            raise ValueError(f"scale is {options['scale']!r}, expected a finite number or one for each axis") from None
    stem = os.path.splitext(name[:-3] if suffix == ".gz" else name)[0]
    rules = {known: known for known in choices(_wrapped.vtkAvianLidarMaterial, "Material") if known != "Custom"}
    unnamed = {"*" if painted else "DefaultMaterial": "Wall"}  # Assimp's name for a missing material
    return {"version": 1, "objects": [{"file": name, "name": stem, "material_map": {**rules, **unnamed}, **options}]}


def _read(source, progress: Progress | None, painted: bool, **options: Any):
    """The scene of a scene file, of a mapping with the keys of such a file, or of a mesh file with options."""
    reader, is_map = _wrapped.vtkAvianLidarSceneReader(), isinstance(source, Mapping)
    file = "scene" if is_map else os.fsdecode(source)
    reader.SetFileName(file_name(file))
    options = {key: value for key, value in options.items() if value is not None}
    if not is_map and not file.lower().endswith(SCENE):
        reader.SetText(json.dumps(_mesh_scene(file, painted, options)))
        try:
            update(reader, progress)
        except Error as error:  # the error names only the mesh
            text = re.sub(r"^\w+: ", "", str(error)).replace(f"objects[0].file: {os.path.abspath(file)}: ", "")
            raise Error(text.replace("objects[0].", "")) from None
        return reader.GetOutput()
    if options:
        raise TypeError(f"{' and '.join(options)} of a scene: expected a mesh file; a scene file gives these options "
                        "for each object")
    if is_map:
        reader.SetText(text_of(json.dumps(source)))
    update(reader, progress)
    return reader.GetOutput()


class Scene:
    """Surfaces with materials, and their collision tree, which all scans of the scene share.

    >>> scene = Scene()
    >>> scene.add(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Glass", name="pane")
    >>> scene.objects
    ['pane']
    """

    surfaces: vtkMultiBlockDataSet  # one block for each added surface
    tree: Any  # the vtkAvianLidarCollisionTree

    def __init__(self, surfaces=None, faces=None, *, material: Material | None = None, name: str | None = None,
                 scale=None, up_axis: str | None = None, progress: Progress | None = None):
        """The arguments are those of `add`; without surfaces the scene is empty. `tree` has properties of its own."""
        self.surfaces = vtkMultiBlockDataSet()
        self._painters: list[Any] = []  # filters that set materials and names of the added surfaces
        self._seen = 0  # VTK's time of the last known change of the surfaces
        self.tree = _wrapped.vtkAvianLidarCollisionTree()
        self.tree.SetInputData(self.surfaces)
        if surfaces is not None:
            self.add(surfaces, faces, material=material, name=name, scale=scale, up_axis=up_axis, progress=progress)

    def add(self, surfaces, faces=None, *, material: Material | None = None, name: str | None = None, scale=None,
            up_axis: str | None = None, progress: Progress | None = None) -> None:
        """Adds surfaces, with coordinates in metres east, north and up of the scene's origin.

        surfaces  a mesh file (STL, OBJ, PLY, glTF, VTP, ...: Documentation/reference/scene-files.md), a scene file
                  (.lidarscene.json) or a mapping with the keys of a scene file; vtkPolyData (also from PyVista) or a
                  multiblock of vtkPolyData; a VTK algorithm, which is run; n rows of x, y, z, with `faces`; a pair
                  (points, faces) as for `mesh`; a mesh of Open3D or trimesh (`vertices` with `triangles` or `faces`),
                  which is copied
        faces     m rows of three indices into the points
        material  a name (`materials()`), or coefficients (kd, ks, kp, ...; optional after kp). One mesh may also have a
                  sequence of m names or m rows of coefficients, one for each triangle. Default: the surfaces' own
                  materials; else `Wall`, with a warning for VTK data
        name      name of the object, or of each block, which then is one object and keeps its material; default: the
                  name that the surfaces have, or the name of the mesh file
        scale     unit of a mesh file in metres (0.001: millimetres), one number or one for each axis; default 1
        up_axis   axis of a mesh file that points up, "y" or "z"; default: y for glTF, FBX and some other formats, else
                  z
        progress  called with the completed share (0 to 1) and the name of the running class
        """
        if faces is not None:
            pair = isinstance(surfaces, (tuple, list)) and len(surfaces) == 2 and np.ndim(surfaces[0]) == 2
            if pair or isinstance(faces, str) or np.ndim(surfaces) != 2:
                raise TypeError("Scene(points, faces) takes n rows of x, y, z and m rows of three indices, not "
                                f"{type(surfaces).__name__} and {type(faces).__name__}; "
                                "a material is given as material=...")
            surfaces = (surfaces, faces)
        # In trimesh, `triangles` are points.
        triangles = getattr(surfaces, "faces", getattr(surfaces, "triangles", None))
        if hasattr(surfaces, "vertices") and triangles is not None and not isinstance(surfaces, vtkDataObject):
            surfaces = (np.asarray(surfaces.vertices), np.asarray(triangles))
        data = self._data_of(surfaces, progress, material is not None, scale=scale, up_axis=up_axis)
        if isinstance(surfaces, (tuple, list)) and material is None:
            material = "Wall"
        if not isinstance(data, (vtkPolyData, vtkMultiBlockDataSet)):
            raise TypeError(f"surfaces are vtkPolyData or a vtkMultiBlockDataSet of it, not {data.GetClassName()}")
        fields, number, kinds = data.GetFieldData(), self.surfaces.GetNumberOfBlocks(), np.asarray(material)
        if not isinstance(material, str) and (kinds.ndim > 1 or kinds.ndim == 1 and kinds.dtype.kind in "UO"):
            data = _paint_triangles(data, material, name)
        elif material is not None or name:
            self._painters.append(_painter(data, material, name))
            data = self._painters[-1].GetOutputDataObject(0)
        self.surfaces.SetBlock(number, data)
        if name:
            self.surfaces.GetMetaData(number).Set(vtkCompositeDataSet.NAME(), name)
        # The root of a composite gives the scene's place on the Earth; the first root with a place counts.
        own = self.surfaces.GetFieldData()
        for field in ("geodetic_origin", "lidar_position"):
            if fields.HasArray(field) and not own.HasArray(field):
                own.AddArray(fields.GetAbstractArray(field))

    @staticmethod
    def _data_of(surfaces, progress: Progress | None, painted: bool, **options: Any):
        if isinstance(surfaces, (str, os.PathLike, Mapping)):
            return _read(surfaces, progress, painted, **options)
        for key, value in options.items():
            if value is not None:
                raise TypeError(f"{key} is for mesh files; scale and turn data before you add the data")
        if isinstance(surfaces, vtkAlgorithm):
            surfaces = surfaces.GetOutputPort()
        if isinstance(surfaces, vtkAlgorithmOutput):
            update(surfaces.GetProducer(), progress)
            return surfaces.GetProducer().GetOutputDataObject(surfaces.GetIndex())
        if isinstance(surfaces, vtkDataObject):
            return surfaces
        pair = isinstance(surfaces, (tuple, list)) and len(surfaces) == 2
        if pair and not isinstance(surfaces[0], (str, os.PathLike)):
            return mesh(*surfaces)
        if isinstance(surfaces, np.ndarray):
            raise TypeError(f"points of the shape {surfaces.shape} without faces: expected Scene(points, faces)")
        raise TypeError("surfaces are a mesh file, a scene file, VTK data, an algorithm or (points, faces), not "
                        f"{type(surfaces).__name__}")

    def refresh(self) -> None:
        """Registers changes in place, after `Modified()` of any part of the surfaces. The scene and its scans call this
        function themselves whenever results are read. `Update()` of their algorithms does not."""
        for paint in self._painters:
            if time_of(paint.GetInputDataObject(0, 0)) > self._seen:
                paint.Modified()
                update(paint)
        if time_of(self.surfaces) > self._seen:
            self.surfaces.Modified()
            self._seen = self.surfaces.GetMTime()

    def __repr__(self) -> str:
        return _display.line(self, _display.place_rows)

    def _repr_html_(self) -> str:
        return _display.page(self, _display.scene_rows, lambda axes: _display.draw_from_above(self, axes))

    def __getstate__(self) -> dict[str, Any]:
        """The state for pickle and copy: the surfaces, and the tree's properties."""
        self.refresh()
        buffer = vtkCharArray()
        if not vtkCommunicator.MarshalDataObject(self.surfaces, buffer):
            raise ValueError("the surfaces cannot be copied")
        return {"surfaces": vtk_to_numpy(buffer).tobytes(),
                "tree": {name: get_property(self.tree, name) for name in property_names(type(self.tree)).values()}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        Scene.__init__(self)
        buffer = numpy_to_vtk(np.frombuffer(state["surfaces"], dtype=np.int8), deep=True, array_type=VTK_CHAR)
        vtkCommunicator.UnMarshalDataObject(buffer, self.surfaces)
        set_properties(self.tree, **state["tree"])

    def _merged(self) -> vtkPolyData:
        self.refresh()
        if not is_current(self.tree):
            update(self.tree)
        return self.tree.GetOutput()

    @property
    def objects(self) -> list[str]:
        """Names of the objects, in the order of `object_id`."""
        return field_values(self._merged()).get("object_names", [])

    @property
    def materials(self) -> list[str]:
        """Names of the materials, in the order of `material_id`."""
        return field_values(self._merged()).get("material_names", [])

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
        """Latitude and longitude (degrees) of the origin, and its height (metres) above the ellipsoid or the sea, as in
        the scene file; or None."""
        return self._root_field("geodetic_origin")

    @property
    def lidar_position(self):
        """The lidar position of the scene file, in metres east, north and up, or None."""
        return self._root_field("lidar_position")

    def _root_field(self, name):
        array = self.surfaces.GetFieldData().GetArray(name)
        return tuple(as_numpy(array).ravel().tolist()) if array else None


def load_scene(file, progress: Progress | None = None) -> Scene:
    """The scene in a .lidarscene.json file: meshes, footprints, materials, and the place on the Earth. `progress` is
    called with the completed share (0 to 1) and the name of the running class."""
    return Scene(os.fspath(file), progress=progress)


def example_scene() -> str:
    """The name of the shipped scene file, the airport Shanghai Hongqiao, in the folder of this package.

    >>> load_scene(example_scene()).lidar_position
    (0.0, 0.0, 3.0)
    """
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "scene", "hongqiao.lidarscene.json")
