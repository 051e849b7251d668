# SPDX-License-Identifier: BSD-3-Clause
"""Writing of clouds to files, by the suffix of the file."""
from __future__ import annotations

import csv
import io
import os
import pathlib
from typing import Any, Callable, Dict, Iterable, Iterator, List, Sequence, Tuple

import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints

from . import vtkAvianLidar as _wrapped
from ._disk import replacing
from ._pipeline import Error, file_name, update
from ._properties import set_properties
from ._suffixes import WRITERS


def suffixes(classes: Dict[str, str]) -> List[str]:
    """The suffixes whose classes this build has. @param classes names of classes of the wrapped module, by suffix"""
    return [*OWN, *(suffix for suffix, name in classes.items() if hasattr(_wrapped, name))]


def refuse(what: str, path: pathlib.Path, known: List[str]) -> ValueError:
    """The error for a file with an unknown suffix."""
    return ValueError(f"cannot {what} {path.name!r} by its suffix, expected one of {', '.join(known)}")


def _write(writer, file: str) -> None:
    if update(writer, run=writer.Write) != 1:
        raise Error(f"{writer.GetClassName()}: {file} was not written")


def vtp(surface) -> bytes:
    """The bytes of a file of vtkPolyData. VTK makes only the text, because VTK's writer ends the process when a disk is
    full."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
    data = surface.NewInstance()
    data.ShallowCopy(surface)
    if not data.GetPoints():
        data.SetPoints(vtkPoints())  # without points, VTK writes a file that VTK does not read
    writer.SetInputData(data)
    writer.WriteToOutputStringOn()
    _write(writer, "the text")
    text = writer.GetOutputString()  # bytes if a name in the data is not UTF-8
    del writer  # frees the writer's copy of the text
    return text.encode() if isinstance(text, str) else text


def _write_vtp(cloud, name: str) -> None:
    pathlib.Path(name).write_bytes(vtp(cloud.data))


def columns_of(cloud) -> Iterator[Tuple[str, str, np.ndarray]]:
    """Name, unit and numbers of each column of a table: x, y, z, and each component of each array."""
    units = cloud.units
    yield from ((axis, "m", part) for axis, part in zip("xyz", cloud.points.T))
    for name, values in cloud.items():
        if values.ndim == 1:
            yield name, units[name], values
        else:
            yield from ((f"{name}_{i}", units[name], part) for i, part in enumerate(values.T))


def as_csv(rows: Iterable[Sequence[Any]], end: str = "\n") -> bytes:
    """Rows as the bytes of a CSV file."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator=end).writerows(rows)
    return text.getvalue().encode()


def write_csv(cloud, name: str, first: Sequence[Tuple[str, str, np.ndarray]] = ()) -> None:
    """Writes one row per point. Names and units are joined as in vtkAvianLidarUnitNames, and quoted according to
    RFC 4180. @param first columns before those of the cloud: name, unit and numbers"""
    columns = [*first, *columns_of(cloud)]
    names = [_wrapped.vtkAvianLidarUnitNames.NameWithUnit(key, unit) for key, unit, _ in columns]
    table = np.rec.fromarrays([values for _, __, values in columns])
    formats = ["%.15g" if values.dtype.kind == "f" else "%d" for _, __, values in columns]
    header = as_csv([names], "\r\n")[:-2].decode()
    np.savetxt(name, table, fmt=formats, delimiter=",", header=header, comments="", encoding="utf-8")


OWN: Dict[str, Callable[..., None]] = {".vtp": _write_vtp, ".csv": write_csv}


def check_suffix(file, more: Sequence[str] = ()) -> None:
    """Raises ValueError for a file that `save` would not write, by its suffix. @param more further allowed suffixes"""
    path = pathlib.Path(file)
    known = [*suffixes(WRITERS), *more]
    if path.suffix.lower() not in known:
        raise refuse("write", path, known)


def check_target(path: pathlib.Path, others: Sequence[pathlib.Path] = ()) -> None:
    """Raises an error for a file that could not be written, before the work starts.
    @param others files that must not be overwritten"""
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no folder {path.parent}")
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a folder, expected a file")
    if not os.access(path.parent, os.W_OK):
        raise PermissionError(f"{path}: the folder {path.parent} may not be written to")
    for other in others:
        if path.resolve() == other.resolve():
            raise ValueError(f"{path}: is named twice")


def write(cloud, file, waveforms=None, **properties: Any) -> None:
    """Writes a Cloud; see `save`. @param waveforms lines of samples for a .las file, or None"""
    path = pathlib.Path(file)
    file_name(path)
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
    if suffix in (".pcd", ".ply"):
        properties = {"precision": "Automatic", **properties}
    set_properties(writer, **properties)
    writer.SetInputData(cloud.data)
    if waveforms is not None:
        writer.SetWaveformsData(waveforms)
    writer.SetFileName(file_name(path))
    _write(writer, str(path))
