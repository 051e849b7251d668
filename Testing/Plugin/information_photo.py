# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestInformation.py: the notes on what a scan left out, in the Information panel.

The results: {"notes": {name: text}}"""

import os

import client_window
from client_qt import QtCore, QtWidgets
from client_window import FOLDER, find, main_window, photo, until
from paraview import simple

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")


def notes_in(table):
    """What the panel's table of arrays shows of notes, {name: text}, and the row of the first."""
    model = table.model()
    notes, first = {}, None
    for row in range(model.rowCount()):
        name, text = (model.index(row, column).data() for column in (0, 2))
        if name.startswith("note_"):
            first = row if first is None else first
            notes[name] = text
    return notes, first


def information(echoes, results):
    """The panel, wide enough for most of the words."""
    simple.SetActiveSource(echoes)
    dock = next(d for d in main_window().findChildren(QtWidgets.QDockWidget) if d.windowTitle() == "Information")
    find("pipelineBrowserDock").hide()  # leaves its height to the panel
    dock.show()
    dock.raise_()
    main_window().resizeDocks([dock], [1250], QtCore.Qt.Orientation.Horizontal)
    yield 1
    table = next(t for t in dock.findChildren(QtWidgets.QTreeView) if t.objectName() == "dataArraysTable")
    yield from until(lambda: notes_in(table)[0], "notes in the Information panel")
    results["notes"], first = notes_in(table)
    table.scrollTo(table.model().index(first, 0), QtWidgets.QAbstractItemView.ScrollHint.PositionAtTop)
    yield 1
    photo(os.path.join(FOLDER, "information.png"), dock, table)


def steps(results):
    scene = simple.OpenDataFile(SCENE)
    tree = simple.AvianLidarCollisionTree(Input=scene)
    beams = simple.AvianLidarAirport16(Position=[0, 0, 3])
    echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree)
    simple.Show(echoes)
    simple.Render()
    yield 1
    yield from information(echoes, results)


client_window.run(steps)
