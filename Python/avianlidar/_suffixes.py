# SPDX-License-Identifier: BSD-3-Clause
"""Files of clouds, by suffix: the one list of the package. Without VTK, for the command's help."""
from __future__ import annotations

from typing import Iterable

PACKETS = (".pcap", ".pcapng")  # of which each revolution is a cloud
# Classes of the wrapped module, which a build may be without; the writers replace a file as a whole themselves.
READERS = {suffix: "vtkAvianLidarPointCloudReader" for suffix in (".las", ".laz", ".pcd", ".ply", ".bin", *PACKETS)}
WRITERS = {".las": "vtkAvianLidarLASWriter", ".laz": "vtkAvianLidarLASWriter", ".pcd": "vtkAvianLidarPCDWriter",
           ".ply": "vtkAvianLidarPLYWriter", ".bin": "vtkAvianLidarKITTIWriter", ".geojson": "vtkAvianLidarGeoJSONWriter"}
# What needs none of them.
OWN = (".vtp", ".csv")
TABLES = (".csv", ".xyz")  # that are read; the first is written, too
POINTS = (*(suffix for suffix in READERS if suffix != ".ply"), *TABLES)  # never surfaces
OF_SENSOR = (".bin", *PACKETS)  # in the frame of the sensor


def listed(classes: Iterable[str]) -> str:
    """Those and our own: .las, .vtp or .csv."""
    *most, last = *classes, *OWN
    return f"{', '.join(most)} or {last}"
