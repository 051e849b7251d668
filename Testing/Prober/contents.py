# SPDX-License-Identifier: BSD-3-Clause
"""Data objects as dictionaries of bytes, to be compared bit by bit, and deep copies of them."""

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

NAME = vtk.vtkCompositeDataSet.NAME()
NUMBERS = {"double": np.float64, "float": np.float32, "int": np.int32, "vtkIdType": np.int64, "long long": np.int64,
         "unsigned long long": np.uint64, "unsigned long": np.uint64}


def leaves(data):
    """(block, index, leaf) of all leaves that are vtkPolyData, in order; a vtkPolyData alone is its own leaf."""
    if data.IsA("vtkPolyData"):
        return [(None, 0, data)]
    found = []
    for i in range(data.GetNumberOfBlocks()):
        block = data.GetBlock(i)
        if block is None:
            continue
        found += [(data, i, block)] if block.IsA("vtkPolyData") else leaves(block)
    return found


def copy_of(data):
    """A deep copy that shares nothing, with the names of blocks."""
    copy = data.NewInstance()
    copy.DeepCopy(data)
    _copy_names(data, copy)
    return copy


def _copy_names(data, copy):
    if data.IsA("vtkMultiBlockDataSet"):
        for i in range(data.GetNumberOfBlocks()):
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
    words = []
    for where in sorted(one.keys() | two.keys()):
        a, b = one.get(where), two.get(where)
        if a != b:
            words.append(f"{where}: {_short(a)} / {_short(b)}")
    return "\n".join(words)


def is_empty(found):
    return not any(where.endswith("/points") and what[0] for where, what in found.items())


def _short(what):
    if what is None:
        return "not there"
    text = repr(what[:-1]) if isinstance(what[-1], bytes) else repr(what)
    if isinstance(what[-1], bytes) and len(what) == 5 and what[1] in NUMBERS:
        kind = NUMBERS[what[1]]
        values = np.frombuffer(what[-1], kind)
        text += " " + np.array2string(values, threshold=12, edgeitems=6, separator=",").replace("\n", "")
    return text[:400]


def _add(found, where, data, without):
    if data is None:
        found[where + "/none"] = (True,)
        return
    found[where + "/class"] = (data.GetClassName(),)
    _add_arrays(found, where + "/field", data.GetFieldData(), without)
    if data.IsA("vtkMultiBlockDataSet"):
        for i in range(data.GetNumberOfBlocks()):
            name = data.GetMetaData(i).Get(NAME) if data.HasMetaData(i) else None
            found[f"{where}/{i} name"] = (name,)
            _add(found, f"{where}/{i}", data.GetBlock(i), without)
        return
    for kind, arrays in (("point", data.GetPointData()), ("cell", data.GetCellData())):
        _add_arrays(found, f"{where}/{kind}", arrays, without)
        active = arrays.GetScalars()
        found[f"{where}/{kind} scalars"] = (active.GetName() if active else None,)
    if data.IsA("vtkImageData"):
        found[where + "/image"] = (data.GetExtent(), data.GetOrigin(), data.GetSpacing())
        found[where + "/points"] = (data.GetNumberOfPoints(),)
        return
    points = data.GetPoints().GetData() if data.GetPoints() and data.GetNumberOfPoints() else None
    found[where + "/points"] = _array(points)
    if data.IsA("vtkPolyData"):
        for kind in ("Verts", "Lines", "Polys", "Strips"):
            cells = getattr(data, "Get" + kind)()
            numbers = [] if not cells.GetNumberOfCells() else [
                vtk_to_numpy(part).astype(np.int64) for part in (cells.GetOffsetsArray(), cells.GetConnectivityArray())]
            found[f"{where}/{kind}"] = (cells.GetNumberOfCells(), b"".join(part.tobytes() for part in numbers))


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
    return shape + (tuple(array.GetVariantValue(i).ToString() for i in range(array.GetNumberOfValues())),)
