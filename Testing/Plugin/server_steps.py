# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestServer.py, connected to a pvserver: the airport from the menus gives the echoes of
the classes in one process, bit for bit; files and a state are saved; errors and the button Advise are as without a
server."""

import contextlib
import io
import os

from client_qt import QAction, QtWidgets
from client_window import (AIRPORT, FOLDER, apply, delete_all, dialog_of, find, later, main_window, menu, points_of,
                           run, take, until)
from error_steps import cases
from panel_steps import advise
from paraview import servermanager, simple
from plugin_testing import PLUGIN, arrays_of, assert_same, direct_echoes, fetch

COLUMNS = 240
STATE = os.path.join(os.path.dirname(PLUGIN), "States", "avian_lidar_airport.py")
RANKS, LATER = int(os.environ["AVIANLIDAR_RANKS"]), bool(os.environ["AVIANLIDAR_LATER"])


def connected():
    """The menus have what the server has: nothing before the plugin is loaded there, all after."""
    connection = yield from until(lambda: servermanager.ActiveConnection and servermanager.ActiveConnection.IsRemote()
                                  and servermanager.ActiveConnection, "the server")
    assert connection.GetNumberOfDataPartitions() == RANKS
    if LATER:
        yield 1
        assert not find("AvianLidarAirport16", QAction)
        printed = io.StringIO()
        with open(STATE, encoding="utf-8") as file, contextlib.redirect_stdout(printed):
            exec(compile(file.read(), STATE, "exec"), {"__name__": "__main__", "__file__": STATE})
        assert "load the plugin on the server" in printed.getvalue() and not simple.GetSources(), printed.getvalue()
        simple.LoadPlugin(PLUGIN, remote=True, ns=vars(simple))
    take()


def choose(name_of_menu, name, made):
    """Chooses a source or filter of the menus, and applies; to be yielded from."""
    def entry():
        menu(name_of_menu)
        return next((one for one in main_window().findChildren(QAction, name) if one.isEnabled()), None)

    (yield from until(entry, name)).trigger()
    proxy = yield from until(lambda: simple.FindSource(made), made)
    yield from apply()
    return proxy


def airport():
    handler, texts = servermanager.ActiveConnection.Session.GetProgressHandler(), set()
    tag = handler.AddObserver("ProgressEvent", lambda *_: texts.add(handler.GetLastProgressText()))
    dialog = yield from dialog_of("actionFileOpen", "FileOpenDialog")  # shows the server's files
    find("EntityName", QtWidgets.QLineEdit, dialog).setText(AIRPORT)
    later(find("OK", parent=dialog).click)
    scene = yield from until(simple.GetActiveSource, "the scene")
    yield from apply()
    tree = yield from choose("menuFilters", "AvianLidarCollisionTree", "AvianLidarCollisionTree1")
    beams = yield from choose("menuSources", "AvianLidarAirport16", "AvianLidarAirport161")
    beams.BeamwidthMilliradians = 8
    assert beams.HalfBeamwidth == 4e-3
    beams.HalfBeamwidth = 5.6e-3
    assert beams.BeamwidthMilliradians == 11.2
    beams.Position, beams.AzimuthStep = [0, 0, 3], 360 / COLUMNS
    echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree)
    simple.Hide(scene)
    for source in (echoes, tree):
        simple.Show(source)
    simple.Render()
    yield 0.5
    handler.RemoveObserver(tag)
    assert any("AvianLidar" in text for text in texts), texts  # the server's progress reaches the client
    _, direct = direct_echoes(COLUMNS)
    expected = [arrays_of(direct.GetOutput(port)) for port in (0, 1)]
    assert len(expected[0]["energy"]) > 100
    for port in (0, 1):
        assert_same(fetch(echoes, port), expected[port])
    file, state = (os.path.join(FOLDER, name) for name in ("echoes.las", "state.pvsm"))
    simple.SaveData(file, proxy=echoes)
    back = simple.OpenDataFile(file)
    back.UpdatePipeline()
    assert points_of(back) == points_of(echoes) and os.path.getsize(file) > 1000
    simple.Delete(back)
    simple.SaveState(state)
    yield from delete_all()
    simple.LoadState(state)
    assert_same(fetch(simple.FindSource("AvianLidarEchoFilter1")), expected[0])
    yield from delete_all()


def failures():
    yield from cases("Scene")


run(connected, airport, *([] if LATER else [failures, advise]))
