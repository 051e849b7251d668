# SPDX-License-Identifier: BSD-3-Clause
"""Jobs of many results on several MPI ranks: who this process is, what results depend on, and files that are whole or not
there."""
from __future__ import annotations

import hashlib
import json
import os
import pathlib
import sys
from typing import Any

from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkParallelCore import vtkMultiProcessController

from . import vtkAvianLidar as _wrapped
from ._cloud import as_numpy, field_values
from ._pipeline import update

PART = ".part"  # ends the name of what is being written


class Ranks:
    """This process among those of the job. Without MPI it is alone."""

    def __init__(self) -> None:
        self.controller = vtkMultiProcessController.GetGlobalController()
        self.size = self.controller.GetNumberOfProcesses() if self.controller else 1
        self.rank = self.controller.GetLocalProcessId() if self.controller else 0
        if self.size > 1:
            from paraview.modules.vtkRemotingCore import vtkProcessModule
            if not vtkProcessModule.GetProcessModule().GetSymmetricMPIMode():
                sys.exit("Every rank has to run this script: start it with `pvbatch --sym`.")

    def wait(self) -> None:
        """Until all ranks are here."""
        if self.size > 1:
            self.controller.Barrier()


def synchronize(folder: pathlib.Path) -> None:
    """Names in the folder are on the disk."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def write_whole(path: pathlib.Path, content: bytes) -> None:
    """After this the file is there, whole, whatever happens then; before, it was as it had been."""
    part = path.with_name(f".{path.name}{PART}")
    with open(part, "wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(part, path)
    synchronize(path.parent)


def as_json(value: Any) -> bytes:
    """Text that is the same for equal values."""
    return (json.dumps(value, indent=1, sort_keys=True, allow_nan=False) + "\n").encode()


def digest_of(surfaces) -> str:
    """Of all that a scan depends on in the merged surfaces that a collision tree gives."""
    fields = field_values(surfaces)
    digest = hashlib.sha256(str(fields["tree_checksum"]).encode())
    for name in ("object_id", "material_id", "kd", "ks", "kp"):
        digest.update(as_numpy(surfaces.GetCellData().GetArray(name)).tobytes())
    for name in ("object_names", "object_classes", "material_names"):
        digest.update(json.dumps(list(fields.get(name, ()))).encode())
    return digest.hexdigest()


def version() -> str:
    """Of the filters: the echoes of no beam name it, too."""
    lidar = _wrapped.vtkAvianLidarEchoFilter()
    lidar.SetInputData(0, vtkPolyData())
    lidar.SetSurfacesData(vtkPolyData())
    update(lidar)
    return field_values(lidar.GetOutput())["avian_lidar_version"][0]
