# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestMacroWindow.py: clicks the buttons of the macros, looks at the birds on the screen, and
takes everything back.

The results: {"buttons": [[name, is it enabled]] of the toolbar with nothing open, "states": what there is before the
first macro and after each, "labels": of Edit > Undo after each, "items": [[parent, name]] of the pipeline browser,
"ports": names of outputs, "birds": {kind: [colour on the screen at each echo]}, "undone": states after each undo,
"redone": the state after redoing the first, "scanned": [echoes before, after that],
"nothing": does a macro that finds nothing to do leave no step, "own": states before a scan of a box that was not applied yet,
and after taking that back}."""

import os

import client_window
from client_qt import QtCore, QtWidgets
from client_window import FOLDER, action, app, find, main_window, photo, press, until
from paraview import servermanager, simple

MACROS = ["avian_lidar_airport_scan", "avian_lidar_birds_over_the_airport", "avian_lidar_coverage"]
KINDS = ["gulls", "crows", "starlings"]


def state(first):
    """What is open, and what the first view shows, from where."""
    shown = []
    for (name, _), source in simple.GetSources().items():
        for port in range(source.SMProxy.GetNumberOfOutputPorts()):
            display = servermanager.GetRepresentation(source[port], first)
            if display and display.Visibility:
                shown.append([name, port])
    camera = [round(value, 3) for value in (*first.CameraPosition, first.CameraParallelScale)]
    return {"sources": sorted(name for name, _ in simple.GetSources()), "views": len(simple.GetViews()),
            "shown": sorted(shown), "camera": camera}


def items():
    """The lines of the pipeline browser: (parent, name); links to inputs, which repeat names, are left out."""
    models = main_window().findChildren(QtCore.QAbstractItemModel)
    model = next(model for model in models if model.metaObject().className() == "pqPipelineModel")
    sources = {name for name, _ in simple.GetSources()}
    found = []

    def walk(parent, depth):
        for row in range(model.rowCount(parent)):
            index = model.index(row, 0, parent)
            name = str(index.data())
            link = depth > 1 and name in sources and not model.rowCount(index) and [str(parent.data()), name] in found
            if not link:
                found.append([str(parent.data()), name])
            walk(index, depth + 1)

    walk(model.index(0, 0), 1)
    return found


def ports():
    return sorted({source.SMProxy.GetOutputPortName(port) for source in simple.GetSources().values()
                   for port in range(source.SMProxy.GetNumberOfOutputPorts())
                   if source.SMProxy.GetNumberOfOutputPorts() > 1})


def birds(view):
    """The colours of the pixels where the echoes of birds are, as the screen shows them."""
    canvas = next(widget for widget in app.allWidgets()
                  if widget.isVisible() and [widget.width(), widget.height()] == list(view.ViewSize)
                  and "QVTK" in widget.metaObject().className())
    corner = canvas.mapToGlobal(QtCore.QPoint(0, 0))
    width, height = canvas.width(), canvas.height()
    picture = app.primaryScreen().grabWindow(0, corner.x(), corner.y(), width, height).toImage()
    matrix = view.GetActiveCamera().GetCompositeProjectionTransformMatrix(width / height, -1, 1)
    colours = {}
    for kind in KINDS:
        # Fetch would be a step to undo.
        data = simple.FindSource("Echoes of " + kind).SMProxy.GetClientSideObject().GetOutputDataObject(0)
        colours[kind] = []
        for i in range(data.GetNumberOfPoints()):
            x, y = matrix.MultiplyPoint([*data.GetPoint(i), 1])[:2]
            pixel = picture.pixelColor(round((x + 1) * width / 2), round((1 - y) * height / 2))
            colours[kind].append(list(pixel.getRgb()[:3]))
    return colours


def steps(results):
    yield from until(lambda: find("AvianLidarToolbar") and action("AvianLidarEchoFilter"), "the toolbar")
    yield 1
    results["buttons"] = [[button.objectName(), button.isEnabled()]
                          for button in find("AvianLidarToolbar", QtWidgets.QToolBar).actions()]
    view = simple.GetActiveView()
    undo, redo = action("actionEditUndo"), action("actionEditRedo")
    results["states"], results["labels"], results["undone"] = [state(view)], [], []
    for macro in MACROS:
        simple.SetActiveSource(None)
        yield 0.3
        yield from press(action(macro))
        results["states"].append(state(view))
        results["labels"].append(undo.text())
        photo(os.path.join(FOLDER, macro + ".png"), main_window())
        if "birds" in macro:
            results["birds"] = birds(view)
    results["items"], results["ports"] = items(), ports()
    count = simple.FindSource("Scan").GetDataInformation().GetNumberOfPoints()
    for _ in MACROS:
        yield from press(undo)
        results["undone"].append(state(view))
    yield from press(redo)
    results["redone"] = state(view)
    scan = simple.FindSource("Scan")
    scan.UpdatePipeline()
    results["scanned"] = [count, scan.GetDataInformation().GetNumberOfPoints()]
    photo(os.path.join(FOLDER, "redone.png"), main_window())
    yield from press(undo)
    simple.SetActiveSource(None)
    yield 0.3
    label = undo.text()
    yield from press(action("avian_lidar_energy_colours"))
    results["nothing"] = undo.text() == label
    box = simple.Box(XLength=20, Center=[0, 60, 0])
    before = state(view)
    simple.SetActiveSource(box)
    yield 0.3
    yield from press(action(MACROS[0]))
    yield from press(undo)
    results["own"] = [before, state(view)]


client_window.run(steps)
