# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestProgress.py: a long scan shows its progress in the status bar, and stops when it is told
to as ParaView's abort button does where it works.

The results: {"progress": [[percent, text], ...], "button": was the abort button ever enabled, "painted": times the
status bar was drawn, "stopped": {"after": progress events from the wish to the end, "echoes", "report": numbers of points},
"again": number of echoes of the next execution, "differences": [arrays that differ from a scan's that was never stopped]}"""

import os

import client_window
from client_window import FOLDER, find, later, main_window, until
from paraview import servermanager, simple
from PyQt5 import QtCore
from vtkmodules.util.numpy_support import vtk_to_numpy

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")


class Watch(QtCore.QObject):
    """Counts how often the progress widget is drawn, and sees whether one may press its button."""

    def __init__(self):
        super().__init__(main_window())
        self.painted, self.enabled = 0, False
        self.button = find("AbortButton")
        find("ProgressBar").installEventFilter(self)

    def eventFilter(self, _, event):
        if event.type() == QtCore.QEvent.Paint:
            self.painted += 1
            self.enabled = self.enabled or self.button.isEnabled()
        return False


def arrays(proxy):
    data = servermanager.Fetch(proxy).GetPointData()
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).tobytes() for i in range(data.GetNumberOfArrays())}


def points(proxy, port):
    return proxy.GetDataInformation(port).GetNumberOfPoints()


def steps(results):
    watch = Watch()
    scene = simple.OpenDataFile(SCENE)
    beams = simple.AvianLidarAirport32(Position=[0, 0, 3], AzimuthStep=1)
    settings = {"Beams": beams, "Surfaces": scene, "Preset": "Reference", "NumberOfThreads": 1}
    scan = simple.AvianLidarEchoFilter(**settings)
    simple.SetActiveSource(scan)
    algorithm = scan.GetClientSideObject()
    progress = results["progress"] = []
    handler = servermanager.ActiveConnection.Session.GetProgressHandler()
    tag = handler.AddObserver(
        "ProgressEvent", lambda *_: progress.append([handler.GetLastProgress(), handler.GetLastProgressText()])
    )
    yield 0.5

    # A scan to its end.
    open(os.path.join(FOLDER, "working"), "w", encoding="utf-8").close()
    watch.painted = 0
    later(scan.UpdatePipeline)
    yield from until(lambda: points(scan, 0) and algorithm.GetProgress() == 1, "the scan")
    results["painted"], results["button"] = watch.painted, watch.enabled
    handler.RemoveObserver(tag)
    whole = arrays(scan)

    # Another seed, stopped after a tenth.
    events = []

    def stop(*_):
        events.append(algorithm.GetProgress())
        if events[-1] > 0.1 and not algorithm.GetAbortExecute():
            algorithm.SetAbortExecuteAndUpdateTime()

    tag = algorithm.AddObserver("ProgressEvent", stop)
    scan.Seed = 1
    scan.UpdatePipeline()
    results["stopped"] = {"after": sum(event > 0.1 for event in events) - 1, "echoes": points(scan, 0), "report": points(scan, 1)}
    algorithm.RemoveObserver(tag)
    yield 0.2

    # The flag is the caller's to take back.
    algorithm.SetAbortExecute(0)
    scan.Seed = 0
    scan.UpdatePipeline()
    results["again"] = points(scan, 0)
    again = arrays(scan)
    results["differences"] = [name for name in whole if whole[name] != again.get(name)]


client_window.run(steps)
