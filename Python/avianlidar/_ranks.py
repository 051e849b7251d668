# SPDX-License-Identifier: BSD-3-Clause
"""Jobs that compute many results on several MPI ranks: the rank of this process, and checksums of inputs."""
import contextlib
import hashlib
import json
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkParallelCore import vtkCommunicator, vtkMultiProcessController

from ._cloud import as_numpy, field_values
from ._pipeline import Error
from ._scene import COEFFICIENTS
from ._version import __version__


class AnotherFailed(Error):
    """The error of ranks that did not fail themselves."""


class Ranks:
    """This process among the processes of the job. Without MPI there is one process."""

    def __init__(self, ends_job: bool = False) -> None:
        """@param ends_job whether an exception of one process ends all processes at once, as in the command"""
        self.ends_job = ends_job
        self.controller = vtkMultiProcessController.GetGlobalController()
        self.size = self.controller.GetNumberOfProcesses() if self.controller else 1
        self.rank = self.controller.GetLocalProcessId() if self.controller else 0
        if self.size > 1:
            from paraview.modules.vtkRemotingCore import vtkProcessModule
            if not vtkProcessModule.GetProcessModule().GetSymmetricMPIMode():
                sys.exit("Every rank has to run this script: start it with `pvbatch --sym`.")

    def wait(self) -> None:
        """Waits until all ranks have arrived. `Error` if one rank failed, see `together`."""
        if not self._all(True):
            raise AnotherFailed("another rank failed; its own error says why")

    @contextlib.contextmanager
    def together(self) -> Iterator[None]:
        """Work that all ranks end together: an exception of one rank becomes an `Error` on the ranks that wait."""
        try:
            yield
            self.wait()
        except AnotherFailed:
            raise
        except BaseException:
            if not self.ends_job:
                self._all(False)
            raise

    def _all(self, mine: bool) -> bool:
        if self.size == 1:
            return mine
        said, least = (numpy_to_vtk(np.array([mine], np.int32), deep=True) for _ in range(2))
        self.controller.AllReduce(said, least, vtkCommunicator.MIN_OP)
        return bool(least.GetValue(0))

    def agree(self, folder, known: Callable[[], Any]) -> None:
        """`Error` on all ranks unless all ranks would write the same files to a folder. @param known everything that
        decides what is written, with equal text (`repr`) for equal values; called only in a job of several ranks"""
        if self.size == 1:
            return
        with self.together():
            mine = hashlib.sha256(repr((__version__, str(folder), known())).encode()).digest()
        first = numpy_to_vtk(np.frombuffer(mine, np.uint8), deep=True)
        self.controller.Broadcast(first, 0)
        if not self._all(as_numpy(first).tobytes() == mine):
            raise Error(f"{folder}: the ranks would write different files to this folder, expected the same "
                        "files, settings and version on all")

    def first_says(self, so: bool) -> bool:
        """The value on the first rank, on all ranks."""
        return self._all(so or self.rank > 0)


def as_json(value: Any) -> bytes:
    """JSON text that is equal for equal values."""
    return (json.dumps(value, indent=1, sort_keys=True, allow_nan=False) + "\n").encode()


def digest_of(surfaces) -> str:
    """Checksum of everything in a collision tree's merged surfaces that a scan depends on."""
    fields = field_values(surfaces)
    digest = hashlib.sha256(str(fields["tree_checksum"]).encode())
    for name in ("object_id", "material_id", *COEFFICIENTS):
        digest.update(as_numpy(surfaces.GetCellData().GetArray(name)).tobytes())
    for name in ("object_names", "object_classes", "material_names"):
        digest.update(json.dumps(list(fields.get(name, ()))).encode())
    return digest.hexdigest()


def digest_of_arrays(data: vtkPolyData) -> str:
    """Checksum of all points and point arrays, whatever their names, without arrays of cells."""
    digest = hashlib.sha256(as_numpy(data.GetPoints().GetData()).tobytes())
    for arrays in (data.GetPointData(), data.GetFieldData()):
        for i in range(arrays.GetNumberOfArrays()):
            array = arrays.GetAbstractArray(i)
            digest.update(repr((array.GetName(), array.GetClassName(), array.GetNumberOfComponents())).encode())
            numbers = isinstance(array, vtkDataArray)
            digest.update(as_numpy(array).tobytes() if numbers else
                          json.dumps([array.GetValue(k) for k in range(array.GetNumberOfValues())]).encode())
    return digest.hexdigest()
