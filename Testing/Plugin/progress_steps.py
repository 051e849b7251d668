# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestProgress.py: a long scan shows its progress in the status bar, stops when the abort button
there is pressed, is whole after the next Apply, and stops when a script tells it to.

The results: {"progress": [[percent, text], ...], "enabled", "idle": may one press the button while it works, and
when nothing does, "painted": times the status bar was drawn, "pressed": {"events": numbers of progress events before and
after the press, "echoes", "report": numbers of points, "apply": may one press Apply}, "kept": number of echoes after a press
when nothing works, "events": number of progress events of the scan after Apply, "whole": number of echoes after Apply, "differences": [arrays that differ from those of a scan that
was never stopped], "script": {"echoes", "report": numbers of points of a scan stopped by a script, "differences": of the next one}}"""

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


def tell(step, button):
    """TestProgress.py waits for this file, which says where the button is on the screen."""
    name = os.path.join(FOLDER, step)
    corner = button.mapToGlobal(button.rect().center())
    with open(name + ".part", "w", encoding="utf-8") as file:
        file.write(f"{corner.x()} {corner.y()}")
    os.replace(name + ".part", name)


def told(step):
    return os.path.exists(os.path.join(FOLDER, step))


def count_events(algorithm, counts):
    """Counts progress events, before and after the wish to stop."""

    def count(*_):
        counts[1 if algorithm.GetAbortExecute() else 0] += 1

    return algorithm.AddObserver("ProgressEvent", count)


def press(results, scan, watch):
    algorithm = scan.GetClientSideObject()
    counts = [0, 0]
    tag = count_events(algorithm, counts)
    tell("press", watch.button)
    simple.Show(scan)
    algorithm.RemoveObserver(tag)
    yield 0.5
    apply = find("Accept", parent=client_window.panel()).isEnabled()
    results["pressed"] = {"events": counts, "echoes": points(scan, 0), "report": points(scan, 1), "apply": apply}
    simple.Render()
    results["idle"] = watch.button.isEnabled()
    tell("idle", watch.button)
    yield from until(lambda: told("idle-pressed"), "the press when nothing works")
    yield 0.5
    results["kept"] = points(scan, 0)


def apply_again(results, scan, watch):
    algorithm = scan.GetClientSideObject()
    progress = results["progress"] = []
    handler = servermanager.ActiveConnection.Session.GetProgressHandler()
    tag = handler.AddObserver(
        "ProgressEvent", lambda *_: progress.append([handler.GetLastProgress(), handler.GetLastProgressText()])
    )
    counts = [0, 0]
    counting = count_events(algorithm, counts)
    tell("working", watch.button)
    watch.painted, watch.enabled = 0, False
    later(find("Accept", parent=client_window.panel()).click)
    yield from until(lambda: points(scan, 0) and algorithm.GetProgress() == 1, "the scan")
    handler.RemoveObserver(tag)
    algorithm.RemoveObserver(counting)
    results["events"] = counts[0]
    results["painted"], results["enabled"] = watch.painted, watch.enabled
    results["whole"] = points(scan, 0)


def stop_by_script(results, scan, whole):
    algorithm = scan.GetClientSideObject()

    def stop(*_):
        if algorithm.GetProgress() > 0.1 and not algorithm.GetAbortExecute():
            algorithm.SetAbortExecuteAndUpdateTime()

    tag = algorithm.AddObserver("ProgressEvent", stop)
    scan.Seed = 1
    scan.UpdatePipeline()
    results["script"] = {"echoes": points(scan, 0), "report": points(scan, 1)}
    algorithm.RemoveObserver(tag)
    yield 0.2
    algorithm.SetAbortExecute(0)
    scan.Seed = 0
    scan.UpdatePipeline()
    again = arrays(scan)
    results["script"]["differences"] = [name for name in whole if whole[name] != again.get(name)]


def steps(results):
    watch = Watch()
    scene = simple.OpenDataFile(SCENE)
    beams = simple.AvianLidarAirport32(Position=[0, 0, 3], AzimuthStep=1)
    settings = {"Beams": beams, "Surfaces": scene, "Preset": "Reference", "NumberOfThreads": 1}
    scan = simple.AvianLidarEchoFilter(**settings)
    simple.SetActiveSource(scan)
    yield 0.5
    yield from press(results, scan, watch)
    yield from apply_again(results, scan, watch)
    never_stopped = simple.AvianLidarEchoFilter(**settings)
    never_stopped.UpdatePipeline()
    whole, found = arrays(never_stopped), arrays(scan)
    results["differences"] = [name for name in whole if whole[name] != found.get(name)]
    yield from stop_by_script(results, scan, whole)


client_window.run(steps)
