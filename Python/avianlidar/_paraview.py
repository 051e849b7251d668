# SPDX-License-Identifier: BSD-3-Clause
"""The advisor that ParaView's button Advise runs on the server; Plugin/Filters/AvianLidarAdvisor.xml is its proxy."""
from typing import Any

import numpy as np
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkTable
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkParallelCore import vtkMultiProcessController

from . import vtkAvianLidar as _wrapped
from ._advice import SETTINGS, UNITS, Advice
from ._advising import measure
from ._cloud import add_array
from ._pipeline import Error

ASKED = {"SetEnergyError": "energy", "SetRangeError": "range", "SetMissedShare": "missed", "SetSampleBeams": "beams"}


class Advisor(VTKPythonAlgorithmBase):
    """Inputs and properties are those of the echo filter, and the limits of the errors. The output is the table of an
    Advice, with the number of the `advised` row and the `advice` in words as field data. In a job of several ranks,
    each rank requests all inputs, and the first rank measures. After an error the table is empty, and its field data
    `error` give the message."""

    def __init__(self) -> None:
        self._like = _wrapped.vtkAvianLidarEchoFilter()
        self._asked: dict[str, Any] = {"energy": 0.02, "range": 0.05, "missed": 0.01, "beams": 1000}
        self._advice: Advice | None = None
        super().__init__(nInputPorts=3, nOutputPorts=1, outputType="vtkTable")

    def __getattr__(self, name: str) -> Any:
        """Methods that the server manager calls: methods for limits and advice, else methods of the echo filter."""
        if not name.startswith(("Get", "Set")):
            raise AttributeError(name)

        def call(*values: Any) -> Any:
            if name in ASKED:
                self._asked[ASKED[name]] = values[0]
                return self.Modified()
            if name.startswith("GetAdvised"):
                place = SETTINGS.index(name[len("GetAdvised"):])
                return self._advice.setting(self._advice.row)[place] if self._advice and self._advice.row >= 0 else -1
            self.Modified()
            return getattr(self._like, name)(*values)
        return call

    def GetAdvice(self) -> str:
        return str(self._advice or "")

    def FillInputPortInformation(self, port: int, info: Any) -> int:
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject" if port else "vtkPolyData")
        info.Set(vtkAlgorithm.INPUT_IS_OPTIONAL(), int(port == 2))
        return 1

    def RequestUpdateExtent(self, request: Any, inputs: Any, outputs: Any) -> int:
        for port in inputs:
            if port.GetNumberOfInformationObjects():
                info = port.GetInformationObject(0)
                info.Set(vtkStreamingDemandDrivenPipeline.UPDATE_PIECE_NUMBER(), 0)
                info.Set(vtkStreamingDemandDrivenPipeline.UPDATE_NUMBER_OF_PIECES(), 1)
        return 1

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        table, self._advice = vtkTable.GetData(outputs), None
        table.Initialize()
        controller = vtkMultiProcessController.GetGlobalController()
        if controller and controller.GetLocalProcessId() > 0:
            return 1
        data = [vtkDataObject.GetData(port) for port in inputs]  # None where an optional input is missing
        asked = {kind: value for kind, value in self._asked.items() if kind != "beams"}
        try:
            advice = measure(self._like, data, asked, self._asked["beams"], lambda share, _: self.UpdateProgress(share))
        except (Error, ValueError) as error:
            vtkOutputWindow.GetInstance().DisplayErrorText(f"ERROR: {error}\n")
            add_array(table.GetFieldData(), "error", [error])
            return 1
        self._advice = advice
        for name, values in advice.table.items():
            add_array(table.GetRowData(), name, values, UNITS.get(name, "1"))
        add_array(table.GetFieldData(), "advised", np.array([advice.row]))
        add_array(table.GetFieldData(), "advice", advice.lines)
        return 1
