# SPDX-License-Identifier: BSD-3-Clause
"""Rasters of heights as files. Each suffix opens with its own driver of GDAL, and no file leads to another server.

GDAL opens what a file names: sources of a mosaic (.vrt), masks and overviews beside a file. These files are checked
first, because GDAL would open them with any driver, also with drivers for servers. GDAL also reads as many pixels as a
file declares, although the file may have a few bytes. The work is therefore counted before it is done.
"""
from __future__ import annotations

import os
import pathlib
import re
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple
from xml.etree import ElementTree

import numpy as np
from osgeo import gdal

from ..._pipeline import Error
from ..inputs._json import naming
from ..places._gdal import expect_file, open_file, warning_of

DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".asc": "AAIGrid", ".hgt": "SRTMHGT", ".vrt": "VRT"}
FORMATS = {"GTiff": "a GeoTIFF (.tif)", "AAIGrid": "an ASCII grid (.asc)", "SRTMHGT": "an SRTM tile (.hgt)",
           "VRT": "a mosaic of GDAL (.vrt)"}
BESIDE = (".prj", ".tfw", ".tifw", ".wld", ".aux.xml", ".msk", ".ovr")  # files that GDAL reads with a raster
MOST_PIXELS = 500_000_000  # pixels that are read, which takes about 20 s
MOST_IN_BLOCK = 256 << 20  # bytes of a block, which GDAL keeps in memory as a whole
MOST_TEXT = 16 << 20  # bytes of a mosaic, and of a file of metadata beside a raster
MOST_SOURCES = 10_000

# Elements of a mosaic with the elements that they may have; elements of DROPPED are left out. `gdalbuildvrt` and
# `gdal_translate` write no others. Any other element may name a file or a program.
SOURCE = ("SourceFilename", "SourceBand", "SourceProperties", "SrcRect", "DstRect", "NODATA", "ScaleOffset",
          "ScaleRatio", "UseMaskBand", "LUT")
KNOWN: Dict[str, Tuple[str, ...]] = {
    "VRTDataset": ("SRS", "GeoTransform", "VRTRasterBand", "MaskBand"), "MaskBand": ("VRTRasterBand",),
    "VRTRasterBand": ("NoDataValue", "ColorInterp", "Description", "UnitType", "Scale", "Offset", "CategoryNames",
                      "ColorTable", "SimpleSource", "ComplexSource", "AveragedSource"),
    "SimpleSource": SOURCE, "ComplexSource": SOURCE, "AveragedSource": SOURCE,
    "CategoryNames": ("Category",), "ColorTable": ("Entry",)}
DROPPED = ("Metadata", "Histograms", "HideNoDataValue", "OverviewList", "Overview", "BlockXSize", "BlockYSize")


class Source(NamedTuple):
    """A part of a mosaic."""
    file: pathlib.Path
    band: int
    inside: Optional[np.ndarray]  # column, row, width and height in the file; None: the whole file
    into: Optional[np.ndarray]    # the same in the mosaic


class Raster(NamedTuple):
    file: pathlib.Path
    data: Any  # GDAL's dataset
    sources: List[List[Source]]  # of a mosaic, for each band


def open_raster(file: pathlib.Path) -> Raster:
    driver = DRIVERS.get(file.suffix.lower())
    if not driver:
        raise Error(f"{file}: is not a raster of heights by its name, expected {', '.join(FORMATS.values())}")
    expect_file(file)
    if driver != "VRT":
        return Raster(file, _opened(file, driver), [])
    with warning_of(file):
        root, sources = _mosaic(file)
    text = ElementTree.tostring(root, encoding="unicode")
    return Raster(file, open_file(file, f"heights, expected {FORMATS[driver]}", [driver], gdal.OF_RASTER,
                                  content=text), sources)


def _opened(file: pathlib.Path, driver: str):
    """A file with its own driver, once the files beside it are known to be what they should be."""
    beside = [file.name]
    for stem in {file.stem, file.name}:
        for path in (file.with_name(stem + end) for suffix in BESIDE for end in (suffix, suffix.upper())):
            if os.path.lexists(path):
                _check_beside(file, path)
                beside += [path.name] if path.suffix.lower() != ".ovr" else []
    return open_file(file, f"heights, expected {FORMATS[driver]}", [driver], gdal.OF_RASTER, beside=beside)


def _check_beside(file: pathlib.Path, path: pathlib.Path) -> None:
    suffix, wrong = path.suffix.lower(), ""
    if not path.is_file():
        wrong = "is not a regular file"
    elif suffix in (".msk", ".ovr"):
        found = gdal.IdentifyDriverEx(os.path.abspath(path))
        wrong = "" if found and found.ShortName == "GTiff" else "is not a GeoTIFF"
    elif suffix == ".xml" and (path.stat().st_size > MOST_TEXT or b"OVERVIEW_FILE" in path.read_bytes()):
        wrong = "names another file, or is very large"
    if wrong:
        raise Error(f"{file}: belongs together with {path.name}, which {wrong}")


def _rectangle(part: Optional[ElementTree.Element]) -> Optional[np.ndarray]:
    return None if part is None else np.array([float(part.get(name, "nan"))
                                               for name in ("xOff", "yOff", "xSize", "ySize")])


def _mosaic(file: pathlib.Path) -> Tuple[ElementTree.Element, List[List[Source]]]:
    """A mosaic without elements that are not needed and with absolute names of files, and the sources of each band."""
    expected = "expected a mosaic of files as gdalbuildvrt makes it; `gdal_translate` makes a GeoTIFF of any other"
    if file.stat().st_size > MOST_TEXT:
        raise Error(f"{file}: holds more than {MOST_TEXT >> 20} MiB, {expected}")
    text = file.read_bytes()
    try:
        root = ElementTree.fromstring(b"" if b"<!DOCTYPE" in text else text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise Error(f"{file}: is not {FORMATS['VRT']} ({error}), {expected}") from None
    if root.tag != "VRTDataset":
        raise Error(f"{file}: is not {FORMATS['VRT']} but {root.tag[:40]!r}, {expected}")
    known: Dict[pathlib.Path, bool] = {}
    _check_element(file, root, expected)
    for name in root.iter("SourceFilename"):
        path = pathlib.Path(name.text or "")
        path = pathlib.Path(os.path.abspath(file.parent / path if name.get("relativeToVRT") == "1" else path))
        name.text, name.attrib = str(path), {"relativeToVRT": "0", "shared": "0"}
        if path not in known:
            known[path] = _check_source(file, path)
    if len(known) > MOST_SOURCES:
        raise Error(f"{file}: names {len(known):,} files, expected at most {MOST_SOURCES:,}")
    return root, [[Source(pathlib.Path(one.findtext("SourceFilename", "")),
                          int((one.findtext("SourceBand") or "1").rpartition(",")[2]),
                          _rectangle(one.find("SrcRect")), _rectangle(one.find("DstRect")))
                   for one in band if one.tag.endswith("Source")] for band in root.findall("VRTRasterBand")]


def _check_element(file: pathlib.Path, one: ElementTree.Element, expected: str) -> None:
    if one.get("subClass"):
        raise Error(f"{file}: holds {one.tag} of the class {one.get('subClass', '')[:40]!r}, {expected}")
    for part in list(one):
        if part.tag in DROPPED:
            one.remove(part)
        elif part.tag not in KNOWN.get(one.tag, ()):
            raise Error(f"{file}: holds {part.tag[:40]!r} in {one.tag}, {expected}")
        else:
            _check_element(file, part, expected)
        if part.tag == "SRS" and re.search("://|^ *[/<]", part.text or ""):
            raise Error(f"{file}: its coordinate reference system is {(part.text or '')[:80]!r}, expected its text")


def _check_source(file: pathlib.Path, path: pathlib.Path) -> bool:
    """Raises an error unless a source of a mosaic is a file that GDAL will open with the driver of its suffix."""
    driver = DRIVERS.get(path.suffix.lower(), "VRT")
    if driver == "VRT":
        raise Error(f"{file}: names {str(path)[:200]!r}, expected files .tif, .asc and .hgt")
    expect_file(path, f"{file}: names {path}")
    found = gdal.IdentifyDriverEx(str(path))
    if found is None or found.ShortName != driver:
        raise Error(f"{file}: names {path}, which is not {FORMATS[driver]}")
    with naming(str(file)):
        return _opened(path, driver) is not None


class Blocks(NamedTuple):
    """Blocks of a band, which GDAL reads as a whole."""
    size: Tuple[int, int]   # of the file, pixels
    block: Tuple[int, int]  # of a block, pixels
    together: int           # number of bands in a block

    def within(self, window: Sequence[int]) -> int:
        """The number of pixels in all blocks that a window touches. @param window column, row, width and height"""
        counts = [(window[i] + window[i + 2] - 1) // self.block[i] - window[i] // self.block[i] + 1 for i in (0, 1)]
        return counts[0] * counts[1] * self.block[0] * self.block[1] * self.together


def _blocks(data, number: int) -> Blocks:
    """`Error` for blocks that are too large."""
    band = data.GetRasterBand(number)
    wide, high = band.GetBlockSize()
    together = data.RasterCount if data.GetMetadataItem("INTERLEAVE", "IMAGE_STRUCTURE") == "PIXEL" else 1
    if wide * high * together * gdal.GetDataTypeSize(band.DataType) / 8 > MOST_IN_BLOCK:
        raise Error(f"its blocks have {wide:,} x {high:,} pixels, expected at most {MOST_IN_BLOCK >> 20} MiB in each; "
                    "`gdal_translate -co TILED=YES` makes smaller blocks")
    return Blocks((data.RasterXSize, data.RasterYSize), (wide, high), together)


def pixels_to_read(raster: Raster, number: int, window: Sequence[int]) -> int:
    """The number of pixels in all blocks of a band that a window touches; `Error` for a block that is too large.
    @param window column, row, width and height"""
    if not raster.sources:
        return _blocks(raster.data, number).within(window)
    known: Dict[Tuple[pathlib.Path, int], Blocks] = {}
    return sum(_of_source(one, window, known) for one in raster.sources[number - 1])


def _of_source(source: Source, window: Sequence[int], known: Dict[Tuple[pathlib.Path, int], Blocks]) -> int:
    def blocks() -> Blocks:
        key = source.file, source.band
        if key not in known:
            with naming(str(source.file)):
                known[key] = _blocks(_opened(source.file, DRIVERS[source.file.suffix.lower()]), source.band)
        return known[key]

    inside, into = (np.array([0.0, 0.0, *blocks().size]) if one is None else one
                    for one in (source.inside, source.into))
    low = np.maximum(into[:2], window[:2])
    high = np.minimum(into[:2] + into[2:], np.add(window[:2], window[2:]))
    if not (high > low).all():
        return 0
    scale = inside[2:] / into[2:]
    first, size = np.floor(inside[:2] + (low - into[:2]) * scale), np.ceil((high - low) * scale) + 1.0
    return blocks().within([*first.astype(int).tolist(), *size.astype(int).tolist()])
