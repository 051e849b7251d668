# SPDX-License-Identifier: BSD-3-Clause
"""Suffixes of the files of clouds, in one list for the package. The module needs no VTK, because the command's help
uses the list."""
from collections.abc import Iterable

PACKETS = (".pcap", ".pcapng")  # files of which each revolution is a cloud
# Classes of the wrapped module, some of which a build may lack. The writers replace a file as a whole themselves.
READERS = dict.fromkeys((".las", ".laz", ".pcd", ".ply", ".bin", *PACKETS), "vtkAvianLidarPointCloudReader")
WRITERS = {suffix: f"vtkAvianLidar{kind}Writer" for suffix, kind in (
    (".las", "LAS"), (".laz", "LAS"), (".pcd", "PCD"), (".ply", "PLY"), (".bin", "KITTI"), (".geojson", "GeoJSON"))}
# Suffixes that need none of these classes.
OWN = (".vtp", ".csv")
TABLES = (".csv", ".xyz")  # files that are read; .csv is also written
POINTS = (*(suffix for suffix in READERS if suffix != ".ply"), *TABLES)  # files that never contain surfaces
OF_SENSOR = (".bin", *PACKETS)  # files in the frame of the sensor


def listed(classes: Iterable[str]) -> str:
    """The suffixes of classes and of this package in words: .las, .vtp or .csv."""
    *most, last = *classes, *OWN
    return f"{', '.join(most)} or {last}"
