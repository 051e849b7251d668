# SPDX-License-Identifier: BSD-3-Clause
"""Data objects as dictionaries of bytes, to be compared bit by bit; deep copies; and random surfaces."""

import math

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from avianlidar._cloud import add_array

NAME = vtk.vtkCompositeDataSet.NAME()
CELLS = ("Verts", "Lines", "Polys", "Strips")


def leaves(data):
    """(block, index, leaf) of all leaves that are vtkPolyData, in order; a vtkPolyData alone is its own leaf."""
    if data.IsA("vtkPolyData"):
        return [(None, 0, data)]
    blocks = [(data, i, data.GetBlock(i)) for i in range(data.GetNumberOfBlocks())]
    found = [[one] if one[2].IsA("vtkPolyData") else leaves(one[2]) for one in blocks if one[2] is not None]
    return sum(found, [])


def copy_of(data):
    """A deep copy that shares nothing, with the names of blocks."""
    copy = data.NewInstance()
    copy.DeepCopy(data)
    _copy_names(data, copy)
    return copy


def _copy_names(data, copy):
    for i in range(data.GetNumberOfBlocks() if data.IsA("vtkMultiBlockDataSet") else 0):
        if data.HasMetaData(i):
            copy.GetMetaData(i).Copy(data.GetMetaData(i), 1)
        if data.GetBlock(i) is not None:
            _copy_names(data.GetBlock(i), copy.GetBlock(i))


def contents(data, without=()):
    """{where: what} of points, cells, arrays and field data. `without`: names of arrays to leave out."""
    found = {}
    _add(found, "", data, without)
    return found


def difference(one, two):
    """The places where two contents differ, in words; empty if nowhere."""
    return "\n".join(f"{where}: {_short(one.get(where))} / {_short(two.get(where))}"
                     for where in sorted(one.keys() | two.keys()) if one.get(where) != two.get(where))


def is_empty(found):
    return not any(where.endswith("/points") and what[0] for where, what in found.items())


def _short(what):
    if what is None or not isinstance(what[-1], bytes):
        return repr(what)[:300]
    kind = {"double": "f8", "float": "f4", "int": "i4"}.get(str(what[1:2] and what[1]), "u1")
    return repr(what[:-1]) + np.array2string(np.frombuffer(what[-1], kind), threshold=12, edgeitems=6).replace("\n", "")


def _add(found, where, data, without):
    found[where + "/class"] = (data and data.GetClassName(),)
    if data is None:
        return
    _add_arrays(found, where + "/field", data.GetFieldData(), without)
    if data.IsA("vtkMultiBlockDataSet"):
        for i in range(data.GetNumberOfBlocks()):
            found[f"{where}/{i} name"] = (data.GetMetaData(i).Get(NAME) if data.HasMetaData(i) else None,)
            _add(found, f"{where}/{i}", data.GetBlock(i), without)
        return
    if data.IsA("vtkTable"):
        return _add_arrays(found, where + "/row", data.GetRowData(), without)
    for kind, arrays in (("point", data.GetPointData()), ("cell", data.GetCellData())):
        _add_arrays(found, f"{where}/{kind}", arrays, without)
        found[f"{where}/scalars of {kind}"] = (arrays.GetScalars() and arrays.GetScalars().GetName(),)
    if data.IsA("vtkImageData"):
        found[where + "/image"] = (data.GetExtent(), data.GetOrigin(), data.GetSpacing())
        found[where + "/points"] = (data.GetNumberOfPoints(),)
        return
    found[where + "/points"] = _array(data.GetPoints().GetData() if data.GetNumberOfPoints() else None)
    for kind in CELLS if data.IsA("vtkPolyData") else ():
        cells = getattr(data, "Get" + kind)()
        parts = (cells.GetOffsetsArray(), cells.GetConnectivityArray()) if cells.GetNumberOfCells() else ()
        found[f"{where}/{kind}"] = (b"".join(vtk_to_numpy(part).astype(np.int64).tobytes() for part in parts),)


def _add_arrays(found, where, arrays, without):
    for i in range(arrays.GetNumberOfArrays()):
        array = arrays.GetAbstractArray(i)
        if array.GetName() not in without:
            found[f"{where} {array.GetName()}"] = _array(array)


def _array(array):
    if array is None:
        return (0,)
    info = array.GetInformation() if array.HasInformation() else None
    unit = info.Get(vtk.vtkDataArray.UNITS_LABEL()) if info and info.Has(vtk.vtkDataArray.UNITS_LABEL()) else None
    shape = (array.GetNumberOfTuples(), array.GetDataTypeAsString(), array.GetNumberOfComponents(), unit)
    if array.IsA("vtkDataArray"):
        return shape + (vtk_to_numpy(array).tobytes(),)
    return shape + (tuple(map(array.GetValue, range(array.GetNumberOfValues()))),)


# ---------------------------------------------------------------- random surfaces

def polydata(points, cells, double=True):
    data, holder, polygons = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    holder.SetDataType(vtk.VTK_DOUBLE if double else vtk.VTK_FLOAT)
    for point in points:
        holder.InsertNextPoint(*point)
    for cell in cells:
        polygons.InsertNextCell(len(cell), cell)
    data.SetPoints(holder)
    data.SetPolys(polygons)
    return data


def place(r):
    angle, distance = 2 * math.pi * r.random(), r.choice((8, 15, 30, 80)) * (0.5 + r.random())
    return np.array([distance * math.sin(angle), distance * math.cos(angle), r.uniform(-3, 6)])


def _box(r):
    c, h = place(r), np.array([r.choice((0.1, 1, 1)) * r.uniform(0.3, 8) for _ in range(3)])
    corners = [c + h * np.array([x, y, z]) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return corners, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def _wall(r):
    c, along = place(r), np.array([r.gauss(0, 20), r.gauss(0, 20), r.gauss(0, 1)])
    up = np.array([0, 0, r.uniform(5, 30)])
    return [c - along, c + along, c + along + up, c - along + up], [[0, 1, 2, 3]]


def _soup(r):
    """Triangles anywhere, and now and then some that are none."""
    c, n, size = place(r), r.randint(1, 20), r.choice((0.1, 4, 4))
    points = [c + np.array([r.gauss(0, size) for _ in range(3)]) for _ in range(3 * n)]
    return points, [[3 * i, 3 * i + 1, 3 * i + 2] for i in range(n)] + r.choice(([], [[0, 0, 0], [0, 1, 0]]))


def leaf(r):
    """One object of any kind, as polygons, triangles or strips, with or without materials, ids and names."""
    data = polydata(*r.choice((_box, _box, _wall, _soup))(r), double=r.random() < 0.7)
    for share, change in ((0.5, vtk.vtkTriangleFilter), (0.15, vtk.vtkStripper)):
        if r.random() < share:
            change = change()
            change.SetInputData(data)
            change.Update()
            data = vtk.vtkPolyData()
            data.CopyStructure(change.GetOutput())
    count, cells = data.GetNumberOfCells(), data.GetCellData()
    if r.random() < 0.75:
        kind = r.choice((np.float64, np.float64, np.float32))
        for name, values in (("kd", (0.0, 0.1, 0.3, 0.5)), ("ks", (0.0, 0.05, 0.45)), ("kp", (1.0, 112.0, 8046.0))):
            add_array(cells, name, np.array([r.choice(values) for _ in range(count)], dtype=kind))
    for name, more in (("material", ("names",)), ("object", ("names", "classes"))):
        if r.random() < 0.5:
            add_array(cells, name + "_id", np.array([r.randint(0, 3) for _ in range(count)], dtype=np.int32))
            for words in more:
                add_array(data.GetFieldData(), f"{name}_{words}", [f"{name} {r.randint(0, 9)}" for _ in range(4)])
    if r.random() < 0.3:
        add_array(cells, vtk.vtkDataSetAttributes.GhostArrayName(), np.zeros(count, dtype=np.uint8))
    return data


def scene(r):
    """A vtkPolyData, or blocks of it, some nested, empty or missing."""
    if r.random() < 0.2:
        return leaf(r)
    blocks = vtk.vtkMultiBlockDataSet()
    for i in range(r.randint(1, 8)):
        kind = r.random()
        block = None if kind < 0.05 else vtk.vtkPolyData() if kind < 0.1 else leaf(r) if kind < 0.9 else scene(r)
        blocks.SetBlock(i, block)
        if r.random() < 0.8:
            blocks.GetMetaData(i).Set(NAME, f"block {i}")
    return blocks


def mover(r, surface):
    """The surface, in a frame of its own that moves."""
    data, times = copy_of(surface), np.array([-5.0, 5.0])
    centre = np.array(data.GetCenter())
    vtk_to_numpy(data.GetPoints().GetData())[:] -= centre
    at = place(r)
    add_array(data.GetFieldData(), "pose_time", times)
    add_array(data.GetFieldData(), "pose_position", np.array([at, at + [r.gauss(0, 40), r.gauss(0, 40), 0]]))
    return data
