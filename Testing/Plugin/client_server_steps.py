# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestClientServer.py, connected to a pvserver: builds the airport from the menus and dialogs
of the window, saves echoes and state.

The results: {"server": number of its processes, "without": are there menus without the plugin, "told": what
the state says then, "made": the objects that it makes, "echoes": number,
"progress": [texts seen]}; beside them portN.npz with the arrays of the outputs, echoes.las, state.pvsm and window.png."""

import contextlib
import io
import os

import client_window
from client_qt import QAction, QtWidgets
import numpy
from client_window import FOLDER, action_of, find, later, main_window, panel, photo, until
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
STATE = os.path.join(os.path.dirname(os.environ["AVIANLIDAR_PLUGIN"]), "States", "avian_lidar_airport.py")


def press_apply(proxy):
    """Apply, once it can be pressed, and what it makes; to be yielded from."""
    button = find("Accept", parent=panel())
    yield from until(button.isEnabled, "Apply")
    button.click()
    yield from until(lambda: proxy.GetDataInformation(0).GetMemorySize(), "its data")


def choose(menu_name, name, made):
    """Chooses a source or filter of the menus, to be yielded from. @return the proxy of the name made"""
    action = yield from until(lambda: action_of(menu_name, name), name)
    action.trigger()
    proxy = yield from until(lambda: simple.FindSource(made), made)
    yield from press_apply(proxy)
    return proxy


def open_scene():
    """File > Open: the dialog shows the server's files."""
    later(find("actionFileOpen", QAction).trigger)
    dialog = yield from until(lambda: find("FileOpenDialog"), "the dialog")
    find("EntityName", QtWidgets.QLineEdit, dialog).setText(SCENE)
    later(find("OK", parent=dialog).click)
    scene = yield from until(lambda: simple.GetActiveSource(), "the scene")
    yield from press_apply(scene)
    return scene


def load_on_server(results):
    """The menus have what the server has: nothing before the plugin is loaded there, all after; to be yielded from."""
    yield 1
    results["without"] = bool(find("AvianLidarAirport16", QAction))
    printed = io.StringIO()
    with open(STATE, encoding="utf-8") as file, contextlib.redirect_stdout(printed):
        exec(compile(file.read(), STATE, "exec"), {"__name__": "__main__", "__file__": STATE})
    results["told"], results["made"] = printed.getvalue(), len(simple.GetSources())
    simple.LoadPlugin(os.environ["AVIANLIDAR_PLUGIN"], remote=True, ns=vars(simple))


def steps(results):
    yield from until(lambda: servermanager.ActiveConnection and servermanager.ActiveConnection.IsRemote(), "the server")
    connection = servermanager.ActiveConnection
    results["server"] = connection.GetNumberOfDataPartitions()
    if os.environ["AVIANLIDAR_LOAD"] == "later":
        yield from load_on_server(results)
    handler, texts = connection.Session.GetProgressHandler(), set()
    handler.AddObserver("ProgressEvent", lambda *_: texts.add(handler.GetLastProgressText()))

    scene = yield from open_scene()
    tree = yield from choose("menuFilters", "AvianLidarCollisionTree", "AvianLidarCollisionTree1")
    beams = yield from choose("menuSources", "AvianLidarAirport16", "AvianLidarAirport161")
    beams.BeamwidthMilliradians = 8
    results["half_beamwidth"] = beams.HalfBeamwidth
    beams.HalfBeamwidth = 5.6e-3
    results["beamwidth"] = beams.BeamwidthMilliradians
    beams.Position = [0, 0, 3]
    echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree)
    simple.Hide(scene)
    simple.Show(echoes)
    simple.Show(tree)
    simple.ResetCamera()
    simple.Render()
    yield 1
    results["echoes"] = echoes.GetDataInformation(0).GetNumberOfPoints()
    results["progress"] = sorted(texts)
    for port in (0, 1):
        data = servermanager.Fetch(echoes, idx=port).GetPointData()
        arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
        numpy.savez(os.path.join(FOLDER, f"port{port}.npz"), **arrays)
    simple.SaveData(os.path.join(FOLDER, "echoes.las"), proxy=echoes)
    simple.SaveState(os.path.join(FOLDER, "state.pvsm"))
    photo(os.path.join(FOLDER, "window.png"), main_window())


client_window.run(steps)
