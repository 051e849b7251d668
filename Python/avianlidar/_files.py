# SPDX-License-Identifier: BSD-3-Clause
"""Clouds to and from files."""
from __future__ import annotations

import csv
import io
import os
import pathlib
import re
import warnings
from typing import Any, Dict, List, Sequence, Tuple

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkDataArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray

from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud
from ._disk import read_regular, replacing
from ._pipeline import Error, file_name, update
from ._properties import set_properties
from ._scene import mesh

# By suffix: classes of the wrapped module, which replace a file as a whole themselves.
WRITERS = {".las": "vtkAvianLidarLASWriter", ".laz": "vtkAvianLidarLASWriter", ".pcd": "vtkAvianLidarPCDWriter",
           ".ply": "vtkAvianLidarPLYWriter", ".bin": "vtkAvianLidarKITTIWriter", ".geojson": "vtkAvianLidarGeoJSONWriter"}
READERS = {suffix: "vtkAvianLidarPointCloudReader" for suffix in (".las", ".laz", ".pcd", ".ply", ".bin")}


def _suffixes(classes: Dict[str, str], own: List[str]) -> List[str]:
    return own + [suffix for suffix, name in classes.items() if hasattr(_wrapped, name)]


def _refuse(what: str, path: pathlib.Path, known: List[str]):
    return ValueError(f"cannot {what} {path.name!r} by its suffix; known are {', '.join(known)}")


def _write(writer, file: str) -> None:
    if update(writer, run=writer.Write) != 1:
        raise Error(f"{writer.GetClassName()}: {file} was not written")


def _write_vtp(cloud: Cloud, name: str) -> None:
    """Of VTK only the text is taken: its writer ends the process where a disk is full."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
    data = Cloud(cloud.data).data
    if not data.GetPoints():
        data.SetPoints(vtkPoints())  # without, VTK writes what it does not read
    writer.SetInputData(data)
    writer.WriteToOutputStringOn()
    _write(writer, name)
    text = writer.GetOutputString()  # bytes where a name in the data is not UTF-8
    del writer  # with its copy of the text
    with open(name, "wb") as file:
        file.write(text.encode() if isinstance(text, str) else text)


def _quoted(name: str) -> str:
    """A cell of CSV: in quotes if it has to be."""
    return '"' + name.replace('"', '""') + '"' if any(c in name for c in ',"\r\n') else name


def _write_csv(cloud: Cloud, name: str) -> None:
    """One row per point; names and units as vtkAvianLidarUnitNames joins them, quoted where CSV wants it (RFC 4180)."""
    columns = [(axis, "m", cloud.points[:, i]) for i, axis in enumerate("xyz")]
    for key, values in cloud.items():
        parts = [(key, values)] if values.ndim == 1 else [(f"{key}_{i}", part) for i, part in enumerate(values.T)]
        columns += [(part, cloud.units[key], numbers) for part, numbers in parts]
    header = ",".join(_quoted(_wrapped.vtkAvianLidarUnitNames.NameWithUnit(key, unit)) for key, unit, _ in columns)
    table = np.empty(cloud.number_of_points, dtype=[(f"c{i}", c[2].dtype) for i, c in enumerate(columns)])
    for i, (_, __, values) in enumerate(columns):
        table[f"c{i}"] = values
    formats = ["%.15g" if values.dtype.kind == "f" else "%d" for _, __, values in columns]
    np.savetxt(name, table, fmt=formats, delimiter=",", header=header, comments="", encoding="utf-8")


def _csv_table(path: pathlib.Path) -> Tuple[Dict[str, str], np.ndarray]:
    """Units by name of the columns, and the rows."""
    try:
        stream = io.StringIO(read_regular(path).decode("utf-8-sig"), newline="")
        units: Dict[str, str] = {}
        for cell in next(csv.reader(stream), []):
            name, unit = _NAME_AND_UNIT.fullmatch(cell.strip()).groups("")  # type: ignore[union-attr]
            if name in units:
                raise ValueError(f"the column {name!r} is there twice")
            units[name] = unit
        wrong = [axis for axis in "xyz" if units.get(axis, "no") not in ("", "m")]
        if wrong:
            raise ValueError(f"has no column {wrong[0]} in metres")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of no rows
            table = np.loadtxt(stream, delimiter=",", quotechar='"', comments=None, ndmin=2)
        table = table if table.size else np.empty((0, len(units)))
        if table.shape[1] != len(units):
            raise ValueError(f"rows have {table.shape[1]} cells, the first line {len(units)}")
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}: is no cloud ({error}): expected a first line of names, among them x, y and z (m), some with units, as "
                         "'energy [J]', and numbers below") from None
    return units, table


def _read_csv(path: pathlib.Path) -> Cloud:
    """What `_write_csv` has written: whole numbers as int64, columns name_0, name_1, ... as one array, colours (rgb) as bytes."""
    units, table = _csv_table(path)
    columns, cells = dict(zip(units, table.T)), vtkCellArray()
    data = mesh(np.column_stack([columns.pop(axis) for axis in "xyz"]), np.empty((0, 3), int))
    cells.SetData(1, numpy_to_vtkIdTypeArray(np.arange(len(table)), deep=True))
    data.SetVerts(cells)
    while columns:
        name = next(iter(columns))
        stem, parts = name[:-2], [name]
        while name.endswith("_0") and f"{stem}_{len(parts)}" in columns:
            parts.append(f"{stem}_{len(parts)}")
        values = np.column_stack([columns.pop(part) for part in parts])
        if (np.abs(values) < 2.0**53).all() and (values == np.floor(values)).all():  # of NaN neither
            colours = stem == "rgb" and len(parts) == 3 and ((values >= 0) & (values < 256)).all()
            values = values.astype(np.uint8 if colours else np.int64)
        array = numpy_to_vtk(values if len(parts) > 1 else values[:, 0].copy(), deep=True)
        array.SetName(stem if len(parts) > 1 else name)
        if units[name]:
            array.GetInformation().Set(vtkDataArray.UNITS_LABEL(), units[name])
        data.GetPointData().AddArray(array)
    return Cloud(data)


OWN = {".vtp": _write_vtp, ".csv": _write_csv}
_NAME_AND_UNIT = re.compile(r"(.*?)(?: \[([^\[\]]*)\])?", re.S)


def check_suffix(file) -> None:
    """ValueError for a file that `save` would not write, by its suffix."""
    path = pathlib.Path(file)
    known = _suffixes(WRITERS, list(OWN))
    if path.suffix.lower() not in known:
        raise _refuse("write", path, known)


def check_target(path: pathlib.Path, others: Sequence[pathlib.Path] = ()) -> None:
    """An error for a file that could not be written, before the work for it is done. @param others files that it must not be"""
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no folder {path.parent}")
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a folder, expected a file")
    if not os.access(path.parent, os.W_OK):
        raise PermissionError(f"{path}: the folder {path.parent} may not be written to")
    for other in others:
        if path.resolve() == other.resolve():
            raise ValueError(f"{path}: is named twice")


def save(cloud, file, **properties: Any) -> None:
    """Write a cloud (a Cloud, a Scan or vtkPolyData) to the kind of file that the suffix says.

    .vtp      VTK's: everything, units and field data too
    .csv      15 digits, units in the header (`energy [J]`); x, y, z are in metres
    .las, .laz, .pcd, .ply, .bin (KITTI), .geojson
              as far as this build has the writers; `properties` are theirs, by name. LAS and LAZ are in UTM, of a scene
              without an origin on the Earth in its own frame

    The file is replaced as a whole or not at all. An unknown suffix is a ValueError that says what is known.
    """
    path = pathlib.Path(file)
    file_name(path)
    if hasattr(cloud, "echoes"):
        cloud = cloud.echoes
    elif not isinstance(cloud, Cloud):
        cloud = Cloud(cloud)
    check_suffix(path)
    suffix = path.suffix.lower()
    if suffix in OWN:
        if properties:
            raise TypeError(f"a {suffix} file has no properties: {', '.join(properties)}")
        with replacing(path) as name:
            OWN[suffix](cloud, name)
        return
    writer = getattr(_wrapped, WRITERS[suffix])()
    if suffix in (".las", ".laz") and "geodetic_origin" not in cloud.fields:
        properties = {"coordinate_system": "Local", **properties}
    set_properties(writer, **properties)
    writer.SetInputData(cloud.data)
    writer.SetFileName(file_name(path))
    _write(writer, str(path))


def load_cloud(file, **properties: Any) -> Cloud:
    """Read a cloud: .vtp, .csv as `save` writes it, and as far as this build has the reader .las, .laz, .pcd, .ply and .bin
    (KITTI), whose `properties` are given by name. Coordinates are metres; arrays have the units that the file says (`Cloud.units`)."""
    path = pathlib.Path(file)
    file_name(path)
    suffix = path.suffix.lower()
    if suffix == ".csv":
        if properties:
            raise TypeError(f"a {suffix} file has no properties: {', '.join(properties)}")
        if path.exists():
            return _read_csv(path)
    elif suffix == ".vtp":
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
        reader = vtkXMLPolyDataReader()
        if path.is_file():
            with open(path, "rb") as stream:
                if b"<VTKFile" not in stream.read(4096):  # of which VTK says more than one thing
                    raise ValueError(f"{path}: it is no VTK XML file")
    elif suffix in READERS and hasattr(_wrapped, READERS[suffix]):
        reader = getattr(_wrapped, READERS[suffix])()
    else:
        raise _refuse("read", path, _suffixes(READERS, list(OWN)))
    if not path.is_file():
        raise FileNotFoundError(f"no such file: {path}")
    set_properties(reader, **properties)
    reader.SetFileName(file_name(path))
    update(reader)
    return Cloud(reader.GetOutput())
