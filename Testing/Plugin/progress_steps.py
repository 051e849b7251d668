# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestProgress.py: a long scan shows its progress in the status bar, and stops when a script sets
its abort flag.

The results: {"progress": [[percent, text], ...], "painted": times the progress bar was drawn, "events": number of progress
events of the whole scan, "steps": their percents, "whole": its number of echoes, "stopped": {"events": numbers of progress
events before and after the flag is set, "echoes", "report": numbers of points}, "differences": [arrays of the next scan that
differ from those of the first]}"""

import os

import client_window
from client_qt import QtCore
from client_window import FOLDER, find, main_window
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")


class Watch(QtCore.QObject):
    """Counts how often the progress bar is drawn."""

    def __init__(self):
        super().__init__(main_window())
        self.painted = 0
        find("ProgressBar").installEventFilter(self)

    def eventFilter(self, _, event):
        self.painted += event.type() == QtCore.QEvent.Type.Paint
        return False


def arrays(proxy):
    data = servermanager.Fetch(proxy).GetPointData()
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).tobytes() for i in range(data.GetNumberOfArrays())}


def points(proxy, port):
    return proxy.GetDataInformation(port).GetNumberOfPoints()


def show(results, scan):
    algorithm = scan.GetClientSideObject()
    progress, events = [], []
    handler = servermanager.ActiveConnection.Session.GetProgressHandler()
    usual = handler.GetProgressInterval()
    handler.SetProgressInterval(0.01)  # s between two events that are shown, the least: on a fast machine there are few
    tag = handler.AddObserver(
        "ProgressEvent", lambda *_: progress.append([handler.GetLastProgress(), handler.GetLastProgressText()])
    )
    counting = algorithm.AddObserver("ProgressEvent", lambda *_: events.append(algorithm.GetProgress()))
    watch = Watch()
    open(os.path.join(FOLDER, "working"), "w", encoding="utf-8").close()
    yield 0.5
    simple.Show(scan)
    handler.RemoveObserver(tag)
    handler.SetProgressInterval(usual)
    algorithm.RemoveObserver(counting)
    results.update(progress=progress, painted=watch.painted, events=len(events), steps=[int(100 * share) for share in events], whole=points(scan, 0))


def stop(results, scan):
    algorithm = scan.GetClientSideObject()
    counts = [0, 0]

    def count_and_stop(*_):
        counts[1 if algorithm.GetAbortExecute() else 0] += 1
        if algorithm.GetProgress() > 0.1 and not algorithm.GetAbortExecute():
            algorithm.SetAbortExecuteAndUpdateTime()

    tag = algorithm.AddObserver("ProgressEvent", count_and_stop)
    scan.Seed = 1
    scan.UpdatePipeline()
    results["stopped"] = {"events": counts, "echoes": points(scan, 0), "report": points(scan, 1)}
    algorithm.RemoveObserver(tag)
    yield 0.2
    algorithm.SetAbortExecute(0)
    scan.Seed = 0
    scan.UpdatePipeline()


def steps(results):
    scene = simple.OpenDataFile(SCENE)
    beams = simple.AvianLidarAirport32(Position=[0, 0, 3], AzimuthStep=1)
    scan = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=scene, Preset="Reference", NumberOfThreads=1)
    simple.SetActiveSource(scan)
    yield 0.5
    yield from show(results, scan)
    whole = arrays(scan)
    yield from stop(results, scan)
    again = arrays(scan)
    results["differences"] = [name for name in whole if whole[name] != again.get(name)]


client_window.run(steps)
