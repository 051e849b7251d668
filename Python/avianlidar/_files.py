# SPDX-License-Identifier: BSD-3-Clause
"""Reading and writing of clouds, names of files, and regular files."""
import csv
import gzip
import io
import math
import os
import pathlib
import re
import unicodedata
import warnings
import zlib
from typing import Any

import numpy as np

from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud, add_array, vertices
from ._pipeline import Error, callers_level, file_name, plain, update
from ._properties import set_properties
from ._suffixes import PACKETS, READERS, TABLES
from ._writers import refuse, suffixes, write

# Limits of compressed files, as in UnpackedSize.h: the greatest number of bytes after decompression, and the greatest
# growth of files larger than SMALL. Text grows 5 to 30 times.
LARGEST, SMALL, GROWTH = 256 << 20, 16 << 20, 100
MOST_PACKED = 1000  # greatest number of points for each byte of a file
LONGEST = 200  # bytes of a name; the names of files add suffixes
MOST_LINES = 1000  # greatest number of lines above the first row of a table
COMMENTS = ("#", "//", "%", "!")  # beginnings of lines above the rows
_NAME_AND_UNIT = re.compile(r"(.*?)(?: \[([^\[\]]*)\])?", re.S)
_AXIS = re.compile(r"(?://)?\s*([xyz])(?:\s*[(\[]m[)\]])?", re.I)  # of CloudCompare, LAStools and spreadsheets
_POINTS = ("Points:", "Points_", "Points_m_XYZ:", "Points_m_XYZ_")  # of ParaView and VeloView, before a number
# Columns of HELIOS++, which writes no line of names.
_HELIOS = [*"xyz", "intensity", "echo_width", "return_number", "number_of_returns", "fullwave_index", "hit_object_id",
           "classification", "gps_time"]


def checked_name(name: str, what: str) -> str:
    """The name, if files and folders may have this name. @param what the input that gives the name"""
    control = any(unicodedata.category(letter) in ("Cc", "Cs", "Zl", "Zp") for letter in name)
    if not name or name.startswith(".") or "/" in name or control or len(name.encode()) > LONGEST:
        raise Error(f"{what} is {name!r}, expected 1 to {LONGEST} bytes of text for names of files: no / and no "
                    "control character, no dot at the beginning")
    return name


def require_regular(path: pathlib.Path) -> None:
    """Raises `Error` for a folder, for a pipe, which may wait for ever, and for a device, which may never end. The
    library's RegularFile.h does the same."""
    if path.exists() and not path.is_file():
        what = "it is a folder" if path.is_dir() else "it is not a regular file but a pipe or a device"
        raise Error(f"{path}: {what}")


def read_regular(file, most: int = LARGEST) -> bytes:
    """The content of a regular file, or of a link to a regular file; gzip is decompressed. @param most greatest number
    of bytes after decompression"""
    try:
        require_regular(pathlib.Path(file))
        content = pathlib.Path(file).read_bytes()
    except (OSError, ValueError) as error:  # ValueError for a name that no file can have
        raise Error(f"{file}: cannot be read ({getattr(error, 'strerror', error)})") from None
    if not content.startswith(b"\x1f\x8b"):
        return content
    allowed = min(most, max(SMALL, GROWTH * len(content)))
    try:
        unpacked = gzip.GzipFile(fileobj=io.BytesIO(content)).read(allowed + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise Error(f"{file}: its compression by gzip is damaged ({error})") from None
    if len(unpacked) > allowed:
        raise Error(f"{file}: holds more than {allowed >> 20} MiB, which is too much for {len(content):,} bytes of "
                    "gzip: decompress it first")
    return unpacked


def _axes(names: list[str]) -> list[str]:
    """The names, with x, y and z in place of other programs' names of coordinates, unless the names have x, y and z."""
    if set("xyz") <= {_NAME_AND_UNIT.fullmatch(name)[1] for name in names}:  # type: ignore[index]
        return names
    for points in _POINTS:
        axes = {f"{points}{i}": axis for i, axis in enumerate("xyz")}
        if axes.keys() <= set(names):
            return [axes.get(name, name) for name in names]
    found = [_AXIS.fullmatch(name) for name in names]
    return [axis[1].lower() if axis else name for axis, name in zip(found, names)]


def _header(stream: io.StringIO, separators: str) -> tuple[list[str], str | None] | None:
    """Names of columns at the position of the stream, and the separator (None: blanks), if x, y and z are among the
    names. The position is then below the names."""
    at = stream.tell()
    line = stream.readline()
    separator = max(separators, key=re.sub(r'"[^"]*"', "", line).count)  # outside of quotation marks
    for delimiter in (separator, None):
        stream.seek(at)
        try:
            names = next(csv.reader(stream, delimiter=delimiter)) if delimiter else stream.readline().split()
        except csv.Error:
            continue
        names = _axes([name.strip() for name in names])
        if set("xyz") <= {_NAME_AND_UNIT.fullmatch(name)[1] for name in names}:  # type: ignore[index]
            return names, delimiter
    return None


def _is_numbers(line: str) -> bool:
    """Whether a line is a row of a table: only numbers, and empty cells between separators."""
    try:
        words = re.split(r"[,;\s]+", line.partition("#")[0].replace('"', ""))
        return len([float(word) for word in words if word]) > 0
    except ValueError:
        return False


def _names_and_rows(path: pathlib.Path) -> tuple[list[str], str, str | None]:
    """Names of the columns, the rows below, and their separator (None: blanks). Other lines may stand above the
    names."""
    stream = io.StringIO(read_regular(path).decode("utf-8-sig"), newline="")
    is_xyz = path.suffix.lower() == ".xyz"
    separators = ",;" if is_xyz else ",;\t"
    found: tuple[list[str], str | None] | None = None
    comments: list[list[str]] = []  # names in comments
    for _ in range(MOST_LINES):
        at = stream.tell()
        line = stream.readline()
        words = line.strip().strip('",;')
        if not line:
            break
        if words.lower().startswith("sep=") and len(words) in (4, 5):  # a line that Excel writes
            separators = line.strip()[4]
        elif words.startswith(COMMENTS):
            named = _header(io.StringIO(words.lstrip("".join(COMMENTS))), separators)
            comments += [named[0]] if named else []
        elif _is_numbers(line):
            if is_xyz and len(words.split()) == 1 and not set(",;") & set(words):
                raise ValueError("the first line has one word, as files of molecules have it")
            stream.seek(at)
            break
        elif words:
            stream.seek(at)
            found = _header(stream, separators)
            if found:
                break
            stream.seek(at)
            stream.readline()
    rows = stream.read()
    if "#" in rows:
        rows = re.sub(r"[ \t]*#.*", "", rows)
    first = next(filter(None, map(str.strip, io.StringIO(rows))), "")
    delimiter: str | None = max(separators, key=first.count)
    if found and (found[1] or "") in first:
        delimiter = found[1]
    delimiter = delimiter if delimiter and delimiter in first or not first else None
    if found is None:  # numbers follow
        count = len(first.strip(delimiter).split(delimiter))
        fitting = sorted((one for one in comments if len(one) == count or is_xyz and len(one) < count), key=len)
        names = (comments + fitting or [[]])[-1]
        if is_xyz:
            names = fitting[-1] if fitting else _HELIOS if count == len(_HELIOS) else [*"xyz"][:count]
            names = [*names, *(f"column_{i}" for i in range(len(names) + 1, count + 1))]
    else:
        names = found[0]
    if delimiter in (";", "\t"):  # then a comma may be a decimal mark
        if "," in rows and "." in rows:
            raise ValueError("numbers have points and commas: either may be the decimal mark")
        rows = rows.replace(",", ".")
    return names, rows, delimiter


def _numbers(rows: str, delimiter: str | None, width: int) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of rows of text, with NaN for empty cells, and whether a cell is empty. Separators at the end of a
    row are ignored."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about missing rows
            table = np.loadtxt(io.StringIO(rows), delimiter=delimiter, quotechar='"', comments=None, ndmin=2)
        return table, np.zeros(table.shape, bool)
    except ValueError:
        if delimiter is None:
            raise
    found = []
    for row in csv.reader(io.StringIO(rows, newline=""), delimiter=delimiter):
        cells = [cell.strip() for cell in row]
        while len(cells) > width and not cells[-1]:
            cells.pop()
        if any(cells):
            found.append(cells)
            if len(cells) != width:
                raise ValueError(f"rows have {len(cells)} cells, the first line {width}")
    return np.array([[float(cell or "nan") for cell in cells] for cells in found]), np.array(found) == ""


def _table(path: pathlib.Path) -> tuple[dict[str, str], np.ndarray]:
    """Units of the columns by name, and the rows."""
    try:
        names, rows, delimiter = _names_and_rows(path)
        units: dict[str, str] = {}
        for number, cell in enumerate(names, 1):
            name, unit = _NAME_AND_UNIT.fullmatch(cell or f"column_{number}").groups("")  # type: ignore[union-attr]
            if name in units:
                raise ValueError(f"the column {name!r} is there twice")
            units[name] = unit
        wrong = [axis for axis in "xyz" if units.get(axis, "no") not in ("", "m")]
        if wrong:
            raise ValueError(f"has no column {wrong[0]} in metres")
        table, gaps = _numbers(rows, delimiter, len(names))
        if not table.size:
            table, gaps = np.empty((0, len(units))), np.empty((0, len(units)), bool)
        if table.shape[1] != len(units):
            raise ValueError(f"rows have {table.shape[1]} cells, the first line {len(units)}")
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}: is not a cloud ({error}): expected a first line of names, among them x, y and z "
                         "(m), some with units, as 'energy [J]', and numbers below; of .xyz numbers alone, x, y and z "
                         "(m) first") from None
    columns = list(units)
    # Separators at the ends of lines make columns without a name and without numbers.
    kept = [bool(cell) or not gaps[:, place].all() for place, cell in enumerate(names)]
    empty = sum(gaps[:, place].sum() for place, name in enumerate(columns) if kept[place] and name not in tuple("xyz"))
    if empty:
        warnings.warn(f"{path}: {empty} empty cells are read as NaN", RuntimeWarning, stacklevel=callers_level())
    return {name: units[name] for name, keep in zip(columns, kept) if keep}, table[:, kept]


def _read_table(path: pathlib.Path) -> Cloud:
    """Reads what `_write_csv` writes, and tables of other programs: whole numbers become int64, columns name_0, name_1,
    ... (or name:0, ...) become one array, and colours (rgb) become bytes."""
    units, table = _table(path)
    finite = np.isfinite(table[:, [axis in tuple("xyz") for axis in units]]).all(axis=1)
    if not finite.all():
        warnings.warn(f"{path}: {np.sum(~finite)} points whose coordinates are not finite are left out", RuntimeWarning,
                      stacklevel=callers_level())
    columns = dict(zip(units, table[finite].T))
    data = vertices(np.column_stack([columns.pop(axis) for axis in "xyz"]))
    while columns:
        name = next(iter(columns))
        stem, parts = name[:-1], [name]
        while name.endswith(("_0", ":0")) and f"{stem}{len(parts)}" in columns:
            parts.append(f"{stem}{len(parts)}")
        values = np.column_stack([columns.pop(part) for part in parts])
        if (np.abs(values) < 2.0**53).all() and (values == np.floor(values)).all():  # NaN fails both conditions
            colours = stem[:-1] == "rgb" and len(parts) == 3 and ((values >= 0) & (values < 256)).all()
            values = values.astype(np.uint8 if colours else np.int64)
        several = len(parts) > 1
        add_array(data.GetPointData(), stem[:-1] if several else name, values if several else values[:, 0], units[name])
    return Cloud(data)


def save(cloud, file, **properties: Any) -> None:
    """Writes a cloud (a Cloud, a Scan, or any source of a Cloud) in the format of the suffix.

    .vtp      VTK's format: everything, with units and field data
    .csv      15 digits, units in the header (`energy [J]`); x, y and z are in metres
    others    if this build has the writer (Documentation/reference/formats.md); `properties` are properties of the
              writer, by name. LAS and LAZ are in UTM, or in the scene's frame if the scene has no origin on the Earth

    The file is replaced completely or not at all. An unknown suffix is a ValueError that names the known suffixes.
    """
    file_name(pathlib.Path(file))  # before a scan runs
    write(Cloud(getattr(cloud, "echoes", cloud)), file, **properties)


def numbers_of(file: pathlib.Path, columns: int, least: float = -2e9, key: str = "") -> np.ndarray:
    """The numbers of each line that begins with the key, lines x columns. @param least least allowed number"""
    try:
        lines = read_regular(file).decode().splitlines()
        rows = np.array([line[len(key):].split() for line in lines if line.startswith(key)], float)
        rows = rows if rows.size else np.empty((0, columns))
        if rows.shape[1] == columns and ((rows >= least) & (rows < 2e9)).all():
            return rows
    except ValueError:  # also raised for text that is not UTF-8
        pass
    raise ValueError(f"{file}: expected lines of {key or 'numbers'}, {columns} in each, from {least:g} to 2e9")


def _check_xml(path: pathlib.Path) -> None:
    """Raises the error of XML that is damaged. The parser of VTK's reader would print the error instead."""
    from vtkmodules.vtkIOXMLParser import vtkXMLDataParser
    parser, errors = vtkXMLDataParser(), []

    def heard(_, event, message):
        errors.append(plain(message or ""))

    setattr(heard, "CallDataType", "string0")
    parser.AddObserver("ErrorEvent", heard)
    parser.SetFileName(file_name(path))
    parser.Parse()
    if errors:
        raise Error(f"{path}: {errors[0]}")


def _check_size(path) -> None:
    """Refuses a VTK XML file that says that it has far more points than its bytes can hold: VTK ends the process."""
    with open(path, "rb") as stream:
        said = re.findall(rb'\bNumberOfPoints\s*=\s*["\']\s*(\d{1,18})', stream.read(1 << 20))
    points = sum(map(int, said))
    size = os.path.getsize(path)
    if points > MOST_PACKED * size:
        raise ValueError(f"{path}: says that it has {points} points, but has only {size} bytes")


def load_cloud(file, time: float | None = None, **properties: Any) -> Cloud:
    """Reads a cloud from .vtp, .csv (as `save` and other programs write it), .xyz, or another format for which this
    build has a reader (Documentation/reference/formats.md); `properties` are properties of the reader, by name.
    Coordinates are metres. `Cloud.units` gives the units of arrays.

    Packets (.pcap, .pcapng) give the revolution at `time` (s since the full hour); default: the first revolution, with
    a warning if the file has several. `sensor_address` chooses among the sensors of a recording, as "192.168.1.201"."""
    path = pathlib.Path(file)
    file_name(path)
    suffix = path.suffix.lower()
    if time is not None and suffix not in PACKETS:
        raise TypeError(f"a {suffix} file has no revolutions, expected no time, got {time!r}")
    if time is not None and not math.isfinite(time):
        raise ValueError(f"time is {time}, expected seconds since the full hour")
    if suffix not in (".vtp", *TABLES) and not hasattr(_wrapped, READERS.get(suffix, "")):
        raise refuse("read", path, [*suffixes(READERS), *TABLES[1:]])
    if not path.exists():
        raise FileNotFoundError(f"no such file: {path}")
    if suffix in TABLES:
        if properties:
            raise TypeError(f"a {suffix} file has no properties: {', '.join(properties)}")
        return _read_table(path)
    if suffix == ".vtp":
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
        reader = vtkXMLPolyDataReader()
        require_regular(path)
        with open(path, "rb") as stream:
            if b"<VTKFile" not in stream.read(4096):  # VTK reports several errors for such files
                raise ValueError(f"{path}: this is not a VTK XML file")
        _check_xml(path)
        _check_size(path)
    else:
        reader = getattr(_wrapped, READERS[suffix])()
    set_properties(reader, **properties)
    reader.SetFileName(file_name(path))
    try:
        update(reader, run=(lambda: reader.UpdateTimeStep(time)) if time is not None else None)
    except Error as error:
        raise Error(f"{path}: {error}" if suffix == ".vtp" else str(error)) from None
    cloud = Cloud(reader.GetOutput())
    revolutions = cloud.fields["number_of_revolutions"] if time is None and suffix in PACKETS else 1
    if revolutions > 1:
        warnings.warn(f"{path}: has {revolutions:g} revolutions, of which the first was read; load_cloud(file, "
                      "time=...) or --time of the command reads another revolution", RuntimeWarning,
                      stacklevel=callers_level())
    return cloud
