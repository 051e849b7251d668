# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestWindow.py: all that a user does there, from the state that brings the plugin on."""

import functools
import os

import client_window
import numpy
from choices_steps import beam, sensors, undo, wizard
from client_qt import QtCore, QtTest, QtWidgets
from client_window import (AIRPORT, action, app, apply, apply_button, apply_value, canvas, delete_all, dialog_of, find,
                           later, main_window, menu, panel, photo, pixels, points_of, press, run, shown, take, until)
from error_steps import cases, walks
from live_steps import live
from panel_steps import advise, panels
from paraview import servermanager, simple

FILTER, MACRO = "AvianLidarEchoFilter", "avian_lidar_airport_scan"
ENTRY = "Avian Lidar Echo Filter: Scan Surfaces and Birds"


def macros():
    """The names of those beside the plugin."""
    return {os.path.splitext(file)[0]
            for file in os.listdir(os.path.join(os.environ["AVIANLIDAR_PLUGIN_COPY"], "Macros"))}


def fewer_beams():
    """In the macros that follow."""
    simple.AvianLidarSearch905 = functools.partial(simple.AvianLidarSearch905, AzimuthStep=0.75)


def toolbar():
    """{object of a button: is it enabled}, of what is to be seen with a picture and a tooltip."""
    bar = find("AvianLidarToolbar", QtWidgets.QToolBar)
    found = {}
    for entry in bar.actions() if bar else ():
        button = bar.widgetForAction(entry)
        assert button.isVisible() and not button.icon().pixmap(
            24, 24).isNull() and "lidar" in entry.toolTip().lower(), entry.objectName()
        found[entry.objectName()] = entry.isEnabled()
    return found


def start():
    """The state alone has brought the plugin with its macros and icons, and shows the scanned airport."""
    scan = yield from until(lambda: simple.FindSource("Scan"), "the state")
    # The filter comes with the menu of filters, a moment later than the macros.
    yield from until(lambda: action(FILTER), "the filter")
    yield 1
    found = {entry.objectName() for entry in menu("menu_Macros").actions() if "Avian Lidar" in entry.text()}
    assert found == macros(), found
    assert len(toolbar()) > 4 and FILTER in toolbar() and {*toolbar()} <= found | {FILTER}, toolbar()
    for name in ("menuSources", "menuFilters"):
        ours = menu(name).findChild(QtWidgets.QMenu, "Avian Lidar").actions()
        assert len(ours) > 4 and not any(entry.icon().pixmap(24, 24).isNull() for entry in ours), name
    fewer_beams()
    yield 1
    picture = pixels(canvas(simple.GetActiveView()))
    photo("start.png", main_window())
    photo("start-view.png", canvas(simple.GetActiveView()))
    red, green, blue = (picture[:, :, i] for i in range(3))
    # Echoes of many energies on grey surfaces; left of the legend the strongest are seen, not covered by weaker ones.
    left = numpy.arange(picture.shape[1]) < 0.75 * picture.shape[1]
    counts = [numpy.count_nonzero(one) for one in (
        (blue > 200) & (red < 50) & (green < 100), (blue > 150) & (green > 150) & (red < 50),
        (abs(red - green) < 12) & (abs(green - blue) < 14) & (red > 80) & (red < 200),
        (red > 150) & (green < 60) & (blue < 60) & left)]
    assert min(counts[:3]) > 300 and counts[3] > 60, counts
    assert simple.GetActiveSource() == scan and points_of(scan) > 1000


def information():
    """What a scan left out and why is in the Information panel: each note a line of its own, whole."""
    scan = simple.FindSource("Scan")
    simple.SetActiveSource(scan)
    fields = servermanager.Fetch(scan).GetFieldData()
    arrays = [fields.GetAbstractArray(i) for i in range(fields.GetNumberOfArrays())]
    expected = {one.GetName(): one.GetValue(0) for one in arrays if one.GetName().startswith("note_")}
    browser, window = find("pipelineBrowserDock"), main_window()
    dock = next(one for one in window.findChildren(QtWidgets.QDockWidget) if one.windowTitle() == "Information")
    browser.hide()  # leaves its height to the panel
    dock.show()
    dock.raise_()
    window.resizeDocks([dock], [1000], QtCore.Qt.Orientation.Horizontal)
    yield 0.5
    table = next(one for one in dock.findChildren(QtWidgets.QTreeView) if one.objectName() == "dataArraysTable")
    model = table.model()

    def notes():
        lines = [[model.index(row, column) for column in (0, 2)] for row in range(model.rowCount())]
        return {name.data(): (text.data(), name) for name, text in lines if name.data().startswith("note_")}

    found = yield from until(notes, "notes in the Information panel")
    assert len(expected) > 5 and {name: text for name, (text, _) in found.items()} == expected, (found, expected)
    table.scrollTo(next(iter(found.values()))[1], QtWidgets.QAbstractItemView.ScrollHint.PositionAtTop)
    yield 0.5
    photo("information.png", dock, table)
    window.resizeDocks([dock], [290], QtCore.Qt.Orientation.Horizontal)
    find("propertiesDock").raise_()
    browser.show()
    yield 0.3


def look(source, view, representation, mode):
    """Coloured by energy over the receiver's limits, with a legend."""
    display, table = simple.GetDisplayProperties(source, view), simple.GetColorTransferFunction("energy")
    bar = simple.GetScalarBar(table, view)
    assert list(display.ColorArrayName) == ["POINTS", "energy"], display.ColorArrayName
    assert representation in display.Representation, display.Representation
    assert (table.RGBPoints[0], table.RGBPoints[-4]) == (2e-6, 6.25e-5), table.RGBPoints
    assert (bar.Title, bar.Visibility) == ("energy (\u00b5J)", 1), bar.Title
    assert mode in view.InteractionMode, view.InteractionMode


def image():
    """The first Apply of a range image: a view of its own, wide enough to see."""
    first = simple.GetActiveView()
    source = simple.AvianLidarRangeImage(Echoes=simple.FindSource("Scan"), Beams=simple.FindSource("Airport 16"))
    simple.SetActiveSource(source)
    yield 0.3
    find("AdvancedButton", parent=panel()).click()
    yield from apply_value(source, "Columns", "960")
    find("AdvancedButton", parent=panel()).click()
    yield from until(lambda: "2D" in simple.GetActiveView().InteractionMode, "the view of the range image")
    yield 1  # the window is laid out anew
    own = simple.GetActiveView()
    look(source, own, "Slice", "2D")
    assert own != first and own.ViewSize[0] > 300, own.ViewSize
    photo("range-image.png", main_window())
    yield from delete_all()
    simple.Delete(own)
    yield 0.3


def quick_launch(word):
    """{what Ctrl+Space offers for a word: is it enabled}, to be yielded from."""
    later(main_window().findChild(QtWidgets.QMenu, "menuFilters").actions()[0].trigger)
    dialog = yield from until(app.activeModalWidget, "the quick launch")
    QtTest.QTest.keyClicks(dialog, word)
    yield 0.2
    texts = {}
    for options in dialog.findChildren(QtWidgets.QListView):
        for entry in (options.model().index(i, 0) for i in range(options.model().rowCount())):
            # A list of its own in ParaView 5.13.
            enabled = bool(entry.flags()
                           & QtCore.Qt.ItemFlag.ItemIsEnabled) and options.objectName() != "DisabledProxies"
            texts[entry.data()] = enabled
    dialog.reject()
    yield 0.1
    return texts


def echo_filter():
    """Found by what it does; takes beams alone as Beams, and says what is not connected; its first Apply colours
    echoes."""
    disabled = {name for name, is_enabled in toolbar().items() if not is_enabled}
    # with nothing open
    assert disabled == {FILTER, "avian_lidar_energy_colours", "avian_lidar_status_colours"}, disabled
    button = find("AvianLidarToolbar", QtWidgets.QToolBar).actions()[-1]
    mesh = simple.Sphere(Radius=20, Center=[0, 60, 0])
    simple.Show(mesh)
    yield 0.3
    for word in ("scan", "lidar", "bird", "avian"):
        found = yield from quick_launch(word)
        # A mesh with normals gives no beams; an entry of this name would hide the toolbar.
        assert found.get(ENTRY) is False and "Avian Lidar" not in found, (word, found)
    assert not button.isEnabled() and "Requires" in button.statusTip(), button.statusTip()
    beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=4)
    simple.Show(beams)
    yield 0.3
    assert button.isEnabled()
    later(button.trigger)
    dialog = yield from until(lambda: find("SelectInputDialog"), "the dialog of inputs")
    yield 0.2
    later(dialog.accept)
    echoes = yield from until(lambda: simple.FindSource(FILTER + "1"), "the filter")
    yield from apply()
    (said,) = take("vtkAvianLidar")
    assert "surfaces" in said and "Edit > Change Input" in said, said
    echoes.Surfaces = mesh
    yield from apply_value(echoes, "AttenuationCoefficient", "4e-5")
    look(echoes, simple.GetActiveView(), "Points", "3D")
    # A preset hides what it overrides.
    preset = find("Preset", parent=panel()).findChild(QtWidgets.QComboBox)
    for text, there in (("Draft", False), ("Custom", True)):
        preset.setCurrentText(text)
        yield 0.2
        assert bool(find("RaysPerBeam", parent=panel())) == there, text
    yield from delete_all()


def unapplied():
    """File > Open, and at once the macro: it applies what was opened, and leaves nothing to the button."""
    dialog = yield from dialog_of("actionFileOpen", "FileOpenDialog")
    yield 0.2
    box = find("EntityType", QtWidgets.QComboBox, dialog)
    types = " ".join(box.itemText(i) for i in range(box.count()))
    assert all(one in types for one in ("*.lidarscene.json", "*.lidarsensor.json", "*.las *.laz", "*.pcap")), types
    find("EntityName", QtWidgets.QLineEdit, dialog).setText(AIRPORT)
    later(find("OK", parent=dialog).click)
    scene = yield from until(simple.GetActiveSource, "the scene")
    yield from until(apply_button().isEnabled, "Apply")
    yield from press(action(MACRO))
    assert simple.GetActiveSource() == simple.FindSource("Scan")
    simple.SetActiveSource(scene)
    yield from until(lambda: os.path.basename(AIRPORT) in find("PropertiesButton", parent=panel()).text(), "its panel")
    assert not apply_button().isEnabled() and not shown(scene, simple.GetActiveView())
    yield from delete_all()


def documentation():
    """Pictures that no part takes: the airport from the air, and a scan of a sequence by its classes."""
    if not client_window.DOCUMENTED:
        return
    simple.SetActiveSource(None)
    yield from press(action(MACRO))
    view, tree = simple.GetActiveView(), simple.FindSource("Collision tree")
    grey = simple.GetColorTransferFunction("kd", simple.GetDisplayProperties(tree, view))
    grey.ApplyPreset("Grayscale", True)
    grey.RescaleTransferFunction(-0.05, 0.6)  # concrete in a middle grey: dots and legend stand out
    simple.GetDisplayProperties(simple.FindSource("Scan"), view).PointSize = 5
    simple.GetDisplayProperties(simple.FindSource("Airport 16"), view).PointSize = 12
    # Its depth buffer tells an apron from the grass 2 cm below it.
    view.CameraParallelProjection, view.CameraParallelScale = 1, 760
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [50, -4000, 4000], [-210, -190, 0], [0, 0, 1]
    simple.Render(view)
    yield 2
    photo("airport.png", main_window())
    yield from delete_all()
    reader = simple.OpenDataFile(os.environ["AVIANLIDAR_DOCUMENTATION"])
    simple.Show(reader)
    simple.SetActiveSource(reader)
    yield from press(action("avian_lidar_class_colours"))
    view.CameraFocalPoint, view.CameraPosition, view.CameraViewUp = [0, 0, 0], [-600, -400, 700], [0, 0, 1]
    simple.ResetCamera(view)
    simple.HideUnusedScalarBars(view)
    simple.Render()
    yield 1
    photo("sequence.png", canvas(view))


def failures():
    yield from cases("Sensor")


def loaded_before():
    """The plugin, told to load by itself, comes before there is a window; a macro's path, which goes into a script, has
    an apostrophe."""
    yield from until(lambda: action(FILTER) and find("AvianLidarToolbar"), "the toolbar")
    yield 1
    assert {entry.objectName() for entry in menu("menu_Macros").actions()} >= macros(), macros()
    yield from press(action("avian_lidar_show_beam"))
    assert "select an echo" in take()[-1]
    beams = simple.AvianLidarAirport16()
    for energy in (5e-5, -1, 5e-5):  # an output with an error cannot be saved
        beams.PulseEnergy = energy
        beams.UpdatePipeline()
        simple.SetActiveSource(beams)
        yield 0.3
        assert action("actionFileSaveData").isEnabled() == (energy > 0), energy
    assert "PulseEnergy" in take()[-1]
    simple.Delete(beams)
    fewer_beams()


if "PV_PLUGIN_CONFIG_FILE" in os.environ:
    run(loaded_before, undo)
else:
    # Last what leaves Auto Apply on.
    run(start, information, beam, image, echo_filter, unapplied, sensors, wizard, walks, failures, advise,
        panels, documentation, live)
