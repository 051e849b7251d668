# SPDX-License-Identifier: BSD-3-Clause
"""Suffixes of the files of clouds, in one list for the package. The module needs no VTK, because the command's help uses the list."""
from __future__ import annotations

from typing import Iterable

PACKETS = (".pcap", ".pcapng")  # files of which each revolution is a cloud
# Classes of the wrapped module, some of which a build may lack. The writers replace a file as a whole themselves.
READERS = {suffix: "vtkAvianLidarPointCloudReader" for suffix in (".las", ".laz", ".pcd", ".ply", ".bin", *PACKETS)}
WRITERS = {".las": "vtkAvianLidarLASWriter", ".laz": "vtkAvianLidarLASWriter", ".pcd": "vtkAvianLidarPCDWriter",
           ".ply": "vtkAvianLidarPLYWriter", ".bin": "vtkAvianLidarKITTIWriter", ".geojson": "vtkAvianLidarGeoJSONWriter"}
# Suffixes that need none of these classes.
OWN = (".vtp", ".csv")
TABLES = (".csv", ".xyz")  # files that are read; .csv is also written
POINTS = (*(suffix for suffix in READERS if suffix != ".ply"), *TABLES)  # files that never contain surfaces
OF_SENSOR = (".bin", *PACKETS)  # files in the frame of the sensor


def listed(classes: Iterable[str]) -> str:
    """The suffixes of classes and of this package in words: .las, .vtp or .csv."""
    *most, last = *classes, *OWN
    return f"{', '.join(most)} or {last}"
