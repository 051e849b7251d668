# SPDX-License-Identifier: BSD-3-Clause
"""Point clouds of VTK as NumPy arrays, without copies."""
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkPointSet, vtkPolyData

from . import _plot, _writers
from . import vtkAvianLidar as _wrapped
from ._pipeline import update
from ._properties import set_property, unknown

FRAMES = ("enu", "sensor", "geodetic", "utm", "ecef")


def as_numpy(array) -> np.ndarray:
    """The memory of a VTK array as a read-only NumPy array that keeps the VTK array alive. Filters reuse such arrays in
    their next execution, so change a copy."""
    view = vtk_to_numpy(array).view()
    view.flags.writeable = False
    return view


def unit_of(array) -> str:
    """The unit of a VTK array (UNITS_LABEL): "1" for pure numbers, "" for arrays without a unit such as identifiers."""
    return array.GetInformation().Get(vtkDataArray.UNITS_LABEL()) or ""


def _field_arrays(data) -> list[Any]:
    fields = data.GetFieldData()
    return [fields.GetAbstractArray(i) for i in range(fields.GetNumberOfArrays())]


def field_values(data) -> dict[str, Any]:
    """The field data of a VTK data set by name: a list of texts, a number, or a NumPy array of several numbers."""
    found: dict[str, Any] = {}
    for array in _field_arrays(data):
        if isinstance(array, vtkStringArray):
            found[array.GetName()] = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
        else:
            values = as_numpy(array)[0] if array.GetNumberOfTuples() == 1 else as_numpy(array)
            found[array.GetName()] = values if values.ndim else values.item()
    return found


def leaves_of(data) -> Iterator[Any]:
    """The data sets in a composite."""
    nodes = data.NewIterator()
    nodes.InitTraversal()
    while not nodes.IsDoneWithTraversal():
        yield nodes.GetCurrentDataObject()
        nodes.GoToNextItem()


def array_names(data) -> list[str]:
    """Names of the numeric point arrays."""
    arrays = data.GetPointData()
    return [arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays()) if arrays.GetArray(i)]


def point_array(data, name: str) -> np.ndarray:
    """A point array by name."""
    array = data.GetPointData().GetArray(name) if isinstance(name, str) else None
    if array is None:
        raise KeyError(unknown("array", str(name), array_names(data)))
    return as_numpy(array)


def triangles_of(surface) -> tuple[np.ndarray, np.ndarray]:
    """Points (n x 3) of vtkPolyData, and the point numbers of the triangles' corners (m x 3)."""
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(surface.GetPoints().GetData()), corners


def rows_of(what: str, values, row: tuple[int, ...]) -> np.ndarray:
    """Numbers as an array in double precision whose rows have the shape `row`."""
    rows = np.asarray(values)
    if rows.dtype.kind not in "biuf":
        raise TypeError(f"{what} are of the type {rows.dtype}, expected real numbers")
    if rows.ndim != 1 + len(row) or rows.shape[1:] != row:
        expected = f"(n, {row[0]})" if row else "(n,)"
        raise ValueError(f"{what} have the shape {rows.shape}, expected {expected}")
    return np.ascontiguousarray(rows, dtype=float)


def add_array(arrays, name: str, values, unit: str = "") -> None:
    """Adds a copy of numbers (a NumPy array) or texts to point, cell or field data."""
    if isinstance(values, np.ndarray):
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    else:
        array = vtkStringArray()
        for value in values:
            array.InsertNextValue(str(value))
    array.SetName(name)
    if unit:
        array.GetInformation().Set(vtkDataArray.UNITS_LABEL(), unit)
    arrays.AddArray(array)


def with_points(rows, deep: bool = True) -> vtkPolyData:
    """vtkPolyData whose points are n rows of x, y, z, without cells. @param deep whether the points are a copy"""
    data, places = vtkPolyData(), vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(rows), deep=deep))
    data.SetPoints(places)
    return data


def lines_of(parts: Sequence[np.ndarray]) -> vtkPolyData:
    """Lines with the point array `time` (s). @param parts positions of each line with their times, n x 4"""
    rows = np.concatenate([*parts, np.empty((0, 4))])
    lines, cells = with_points(rows[:, :3]), vtkCellArray()
    cells.SetData(numpy_to_vtkIdTypeArray(np.cumsum([0, *map(len, parts)]), deep=True),
                  numpy_to_vtkIdTypeArray(np.arange(len(rows)), deep=True))
    lines.SetLines(cells)
    add_array(lines.GetPointData(), "time", rows[:, 3], "s")
    return lines


def vertices(points) -> vtkPolyData:
    """vtkPolyData with one vertex for each of n rows of x, y, z, which are copied."""
    data, cells = with_points(rows_of("points", points, (3,))), vtkCellArray()
    cells.SetData(1, numpy_to_vtkIdTypeArray(np.arange(data.GetNumberOfPoints()), deep=True))
    data.SetVerts(cells)
    return data


class Cloud(Mapping):
    """A vtkPointSet as a read-only mapping from the names of its point arrays to NumPy arrays.

    The arrays are VTK's own memory, stay valid as long as you hold them, and cannot be written to. `points` are the
    coordinates, in metres east, north and up unless the data have another frame. `units` and `fields` describe the
    data.

    >>> scene = Scene(([(-5, 9, -5), (5, 9, -5), (0, 9, 5)], [(0, 1, 2)]), material="Wood")
    >>> scan = Scan(scene, Sensor(azimuth_step=6))
    >>> cloud = scan.echoes
    >>> float(cloud["distance_m"].min()) >= 9, cloud.units["distance_m"]
    (True, 'm')
    >>> cloud.points.shape == (len(cloud["energy"]), 3)
    True
    """

    data: Any
    __eq__ = object.__eq__  # not the equality of a mapping, because arrays compare element by element
    __hash__ = object.__hash__

    def __init__(self, data):
        """`data` is a vtkPointSet (also a PolyData of PyVista), of which the Cloud holds a shallow copy: arrays are
        shared, and later changes of the point set do not show. A point cloud of Open3D, or any object with `points`
        that NumPy reads as n rows of x, y, z, is copied."""
        if isinstance(data, Cloud):
            data = data.data
        elif not isinstance(data, vtkDataObject) and hasattr(data, "points"):  # VTK 9.4 gives images `points`, too
            data = vertices(data.points)
        if not isinstance(data, vtkPointSet):
            raise TypeError(f"a cloud is made of a vtkPointSet, not of {type(data).__name__}")
        self.data = data.NewInstance()
        self.data.ShallowCopy(data)

    def __getitem__(self, name: str) -> np.ndarray:
        """The point array of a name, in its unit (`units`): n values, or n rows of components."""
        return point_array(self.data, name)

    def __iter__(self) -> Iterator[str]:
        return iter(array_names(self.data))

    def __len__(self) -> int:
        return len(array_names(self.data))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.data.GetNumberOfPoints()} points: {', '.join(self)}>"

    @property
    def number_of_points(self) -> int:
        """Number of points."""
        return self.data.GetNumberOfPoints()

    @property
    def points(self) -> np.ndarray:
        """Coordinates as n rows of x, y, z, in the frame of the data, which for scans is metres east, north and up."""
        if not self.data.GetNumberOfPoints():
            return np.zeros((0, 3))
        return as_numpy(self.data.GetPoints().GetData())

    @property
    def units(self) -> dict[str, str]:
        """The unit of every point array: "1" for pure numbers, "" for identifiers."""
        return {name: unit_of(self.data.GetPointData().GetArray(name)) for name in self}

    @property
    def fields(self) -> dict[str, Any]:
        """Field data: sensor, settings and names, in SI units and degrees (`field_units`)."""
        return field_values(self.data)

    @property
    def field_units(self) -> dict[str, str]:
        """The unit of every array of the field data."""
        return {array.GetName(): unit_of(array) for array in _field_arrays(self.data)}

    def structured(self) -> np.ndarray:
        """A copy as one structured array with the fields `points` (m) and one field for each point array."""
        columns = {"points": self.points, **self}
        result = np.empty(self.number_of_points, [(name, of.dtype, of.shape[1:]) for name, of in columns.items()])
        for name, values in columns.items():
            result[name] = values
        return result

    def annotated(self) -> "Cloud":
        """A copy of an echo cloud with arrays for maps and viewers: `hue` (deg) and `rgb` (paper, Eq. 13). With an
        origin on the Earth, also `longitude`, `latitude` (deg) and `height` (m above the ellipsoid WGS84)."""
        last: Any = _wrapped.vtkAvianLidarHSBColorMap()
        last.SetInputData(self.data)
        if "geodetic_origin" in self.fields:
            colours, last = last, _wrapped.vtkAvianLidarGeodeticTransform()
            last.SetInputConnection(colours.GetOutputPort())
        update(last)
        return Cloud(last.GetOutputDataObject(0))

    def to_pandas(self):
        """A copy as a pandas DataFrame with one row for each point: `x`, `y`, `z` (m) and every point array. An array
        of several components becomes `name_0`, `name_1`, ...; `attrs` holds `units` and `fields`. Needs pandas."""
        try:
            import pandas
        except ImportError:
            raise ImportError("a table needs pandas, which is not installed: install python3-pandas, "
                              "or pandas with pip") from None
        frame = pandas.DataFrame({name: values.copy() for name, _, values in _writers.columns_of(self)})
        fields = {name: value.tolist() if isinstance(value, np.ndarray) else value
                  for name, value in self.fields.items()}
        frame.attrs = {"units": {**dict.fromkeys("xyz", "m"), **self.units}, "fields": fields}  # pandas compares them
        return frame

    def coordinates(self, frame: str = "enu", motion_correction: bool = True) -> np.ndarray:
        """Coordinates of an echo cloud or a cloud of beams in another frame, as n rows of three numbers.

        enu       metres east, north, up of the scene's origin (the array `points`, not a copy)
        sensor    metres right, forward, up of the sensor, including its orientation. If the sensor moves: at the start
                  of the scan; without `motion_correction` at the firing of each point's beam, as lidars record
        geodetic  longitude and latitude in degrees, height above the ellipsoid WGS84 in metres
        utm       easting, northing in metres (zone of the origin), height above the ellipsoid in metres
        ecef      geocentric metres

        All frames but `enu` and `sensor` need a scene with an origin on the Earth (field data `geodetic_origin`).
        """
        if frame == "enu":
            return self.points
        if frame not in FRAMES:
            raise ValueError(f"frame {frame!r} is unknown, expected one of {', '.join(FRAMES)}")
        fields = self.fields
        if frame == "sensor":
            if "position" not in fields or "orientation" not in fields:
                raise ValueError("the frame 'sensor' needs field data 'position' and 'orientation'")
            from scipy.spatial.transform import Rotation
            if not motion_correction and {"sensor_orientation", "sensor_orientation_0"} & {*self}:  # _0 from PCD, PLY
                places, turns = (self[name] if name in self else np.column_stack([self[f"{name}_{i}"] for i in range(n)])
                                 for name, n in (("sensor_position", 3), ("sensor_orientation", 4)))
                return Rotation.from_quat(turns[:, [1, 2, 3, 0]]).apply(self.points - places, inverse=True)
            yaw, pitch, roll = fields["orientation"]  # clockwise from north, nose up, roll to the right
            turn = Rotation.from_euler("ZXY", (-yaw, pitch, roll), degrees=True)
            return turn.apply(self.points - fields["position"], inverse=True)
        if "geodetic_origin" not in fields:
            raise ValueError(f"the frame {frame!r} needs field data 'geodetic_origin'; the scene has no origin")
        transform = _wrapped.vtkAvianLidarGeodeticTransform()
        transform.SetInputData(self.data)
        transform.MovePointsOn()
        set_property(transform, "TargetFrame", frame)
        update(transform)
        return Cloud(transform.GetOutputDataObject(0)).points

    plot_map = _plot.plot_map
    save = _writers.write
