# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestWindow.py: looks for the echo filter as a user does, applies it and a range image, and
walks by undo, delete, reload and reset out of every state of error.

The results: {"found": {word: {entry of the quick launch: is it enabled}}, "menu": [entries], "mesh" and "beams": is the
filter enabled with that selected, "tip": why not, "missing": [errors without surfaces], "echoes" and "image": what the
first Apply shows, "walks": {state/way: {"errors": [errors of the state], "left": [sources after the way out], "echoes":
points of a good scan after it, "later": [errors of that]}}}."""

import json
import os

import client_window
from client_qt import QtCore, QtTest, QtWidgets
from client_window import FOLDER, action, app, find, later, main_window, panel, photo, type_in, until
from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import VTK_STRING, vtkOutputWindow

SCENE = os.path.join(FOLDER, "window.lidarscene.json")
FILTER = "AvianLidarEchoFilter"
STATES = os.environ["AVIANLIDAR_STATES"].split()
WAYS = os.environ["AVIANLIDAR_WAYS"].split()
COLUMNS, ROWS = 90, 16
errors = []


def hear():
    def heard(_, __, text):
        errors.append(text)

    heard.CallDataType = VTK_STRING
    vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", heard)


def take():
    texts = [text for text in errors if "In vtkAvianLidar" in text]
    errors.clear()
    return texts


def write_scene(good=True):
    objects = [{"name": "ground", "ground": {"size": 200, "height": -1}, "material": "concrete"}]
    with open(SCENE, "w", encoding="utf-8") as file:
        file.write(json.dumps({"version": 1, "objects": objects}) if good else "{")


def trigger(name):
    later(action(name).trigger)
    yield 0.3


def press_apply():
    button = find("Accept", QtWidgets.QAbstractButton, panel())
    yield from until(button.isEnabled, "Apply")
    later(button.click)
    yield from until(lambda: not button.isEnabled(), "the end of Apply")
    yield 0.3


def apply_value(source, prop, text):
    """Types a value into the panel and applies it."""
    simple.SetActiveSource(source)
    yield from until(lambda: find(prop, parent=panel()), "the panel with " + prop)
    yield 0.1
    type_in(prop, text)
    yield from press_apply()


def quick_launch(word):
    """What Ctrl+Space offers for a word, to be yielded from."""
    later(main_window().findChild(QtWidgets.QMenu, "menuFilters").actions()[0].trigger)
    dialog = yield from until(app.activeModalWidget, "the quick launch")
    QtTest.QTest.keyClicks(dialog, word)
    yield 0.2
    texts = {}
    for options in dialog.findChildren(QtWidgets.QListView):
        entries = [options.model().index(i, 0) for i in range(options.model().rowCount())]
        for entry in entries:
            enabled = bool(entry.flags() & QtCore.Qt.ItemFlag.ItemIsEnabled)
            texts[entry.data()] = enabled and options.objectName() != "DisabledProxies"  # a list of its own in ParaView 5.13
    dialog.reject()
    yield 0.1
    return texts


def find_filter(results):
    """The mesh with normals, then the beams are selected."""
    found = results["found"] = {}
    button = find("AvianLidarToolbar", QtWidgets.QToolBar).actions()[-1]
    mesh = simple.Sphere(Radius=20, Center=[0, 60, 0])
    simple.Show(mesh)
    yield 0.3
    for word in ("scan", "lidar", "bird", "avian"):
        found[word] = yield from quick_launch(word)
    results["mesh"], results["tip"] = button.isEnabled(), button.statusTip()
    beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=360 / COLUMNS)
    simple.Show(beams)
    yield 0.3
    results["beams"] = button.isEnabled()
    results["menu"] = [entry.text() for entry in client_window.our_entries("menuFilters")]
    later(button.trigger)
    dialog = yield from until(lambda: find("SelectInputDialog"), "the dialog of inputs")
    yield 0.2
    later(dialog.accept)
    echoes = yield from until(lambda: simple.FindSource(FILTER + "1"), "the filter")
    take()
    yield from press_apply()
    results["missing"] = take()
    return mesh, beams, echoes


def look(source, view):
    """How a source is shown in a view."""
    display = simple.GetDisplayProperties(source, view)
    table = simple.GetColorTransferFunction("energy")
    bar = simple.GetScalarBar(table, view)
    return {
        "array": [str(name) for name in display.ColorArrayName],
        "representation": str(display.Representation),
        "limits": [table.RGBPoints[0], table.RGBPoints[-4]],
        "legend": [str(bar.Title), bar.Visibility],
        "mode": str(view.InteractionMode),
    }


def first_apply(results, mesh, beams, echoes):
    """The first Apply of good echoes, and of a range image."""
    first = simple.GetActiveView()
    echoes.Surfaces = mesh
    yield from apply_value(echoes, "AttenuationCoefficient", "4e-5")
    results["echoes"] = look(echoes, first)
    image = simple.AvianLidarRangeImage(Echoes=echoes, Beams=beams)
    simple.SetActiveSource(image)
    yield 0.3
    find("AdvancedButton", parent=panel()).click()
    yield 0.3
    type_in("Rows", str(ROWS))
    yield from apply_value(image, "Columns", str(COLUMNS))
    # The window is laid out anew meanwhile.
    yield from until(lambda: "2D" in str(simple.GetActiveView().InteractionMode), "the view of the range image")
    yield 1
    own = simple.GetActiveView()
    results["image"] = dict(look(image, own), own=own != first, width=int(own.ViewSize[0]))
    photo(os.path.join(FOLDER, "window.png"), main_window())


def make_scan(state=None):
    """A pipeline from the file, shown; in the state without surfaces."""
    scene = simple.OpenDataFile(SCENE)
    beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=4, MinimumElevation=-30)
    echoes = simple.AvianLidarEchoFilter(Beams=beams, **({} if state == "input" else {"Surfaces": scene}))
    simple.Show(echoes)
    simple.Render()
    simple.SetActiveSource(echoes)
    return scene, beams, echoes


def fail(state, scene, echoes):
    if state == "value":
        yield from apply_value(echoes, "AttenuationCoefficient", "-1")
    elif state == "file":
        write_scene(good=False)
        simple.SetActiveSource(scene)
        yield 0.2
        yield from trigger("actionReloadFiles")
        yield from until(lambda: any("its producer failed" in text for text in errors), "the error of the file")
    yield 0.1


def leave(way, echoes):
    """The way out of a state of error; the file is good by then."""
    write_scene()
    if way == "reload":
        simple.SetActiveSource(simple.FindSource("AvianLidarSceneReader1"))
        yield from trigger("actionReloadFiles")
        return
    simple.SetActiveSource(echoes)
    yield 0.2
    if way == "reset":
        later(action("actionDelete_All").trigger)
        box = yield from until(lambda: app.activeModalWidget() or not simple.GetSources(), "the reset")
        if box is not True:
            yield 0.1
            box.button(QtWidgets.QMessageBox.StandardButton.Yes).click() if isinstance(box, QtWidgets.QMessageBox) else box.accept()
        yield from until(lambda: not simple.GetSources(), "an empty session")
        yield 0.5
    else:
        yield from trigger({"undo": "actionEditUndo", "delete": "actionDelete"}[way])


def walk(state, way):
    write_scene()
    for source in reversed(list(simple.GetSources().values())):
        simple.Delete(source)
    # The legend's action of ParaView 5.13 may else keep a representation whose view is gone, which ends the program.
    yield 0.3
    take()
    scene, _, echoes = make_scan(state)
    yield from fail(state, scene, echoes)
    found = {"errors": take()}
    yield from leave(way, echoes)
    found["left"] = sorted(name for name, _ in simple.GetSources())
    take()
    # The next good input works: beside what is left.
    _, _, again = make_scan()
    yield 0.2
    found["echoes"], found["later"] = again.GetDataInformation().GetNumberOfPoints(), take()
    return found


def steps(results):
    hear()
    remote = os.environ["AVIANLIDAR_SERVER"] == "1"
    yield from until(lambda: servermanager.ActiveConnection, "a connection")
    yield from until(lambda: servermanager.ActiveConnection.IsRemote() == remote, "the server")
    yield from until(lambda: find("AvianLidarToolbar"), "the toolbar")
    yield 1
    parts = yield from find_filter(results)
    yield from first_apply(results, *parts)
    results["walks"] = {}
    for state in STATES:
        for way in WAYS:
            results["walks"][f"{state}/{way}"] = yield from walk(state, way)


client_window.run(steps)
