# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestChoices.py, which says what is looked for in the results."""

import os

import client_window
from client_qt import QtWidgets
from client_window import FOLDER, action, find, later, main_window, panel, photo, press, until
from paraview import servermanager, simple

SCENE = os.path.join(FOLDER, "box.obj")
SEQUENCE = os.environ["AVIANLIDAR_SEQUENCE"]
SEES_MUCH = 11408
WIZARD, BEAM = "avian_lidar_wizard", "avian_lidar_show_beam"


def names():
    return sorted(name for name, _ in simple.GetSources())


def delete_all():
    for source in sorted(simple.GetSources().values(), key=lambda one: -one.SMProxy.GetGlobalID()):  # consumers first
        simple.Delete(source)
    simple.SetActiveSource(None)
    yield 0.5


def entries(menu):
    return [entry.text() for entry in menu.actions() if entry.text()]


def sensors(results):
    """The menu Sources by maker, and what is chosen there."""
    menu = main_window().findChild(QtWidgets.QMenu, "menuSources")
    menu.popup(main_window().pos())
    yield 0.5
    ours = {}
    for entry in menu.actions():
        if entry.menu() and entry.text().replace("&", "").startswith("Avian Lidar: "):
            ours[entry.text().replace("&", "")[len("Avian Lidar: "):]] = entry.menu()
    results["lidars"] = {name: sorted(entries(each)) for name, each in ours.items()}
    menu.setActiveAction(next(entry for entry in menu.actions() if entry.menu() is ours["Ouster"] or "Ouster" in entry.text()))
    ours["Ouster"].popup(menu.mapToGlobal(menu.actionGeometry(menu.activeAction()).topRight()))
    yield 0.5
    photo(os.path.join(FOLDER, "sensors.png"), main_window())
    ours["Ouster"].close()
    menu.close()
    for _ in range(2):
        yield from press(action("AvianLidarOS164"))
    results["named"] = names()
    yield from press(action("actionEditUndo"))
    results["left"] = names()
    yield from delete_all()


def ask():
    """Opens the wizard."""
    later(action(WIZARD).trigger)
    dialog = yield from until(lambda: find("AvianLidarWizard"), "the wizard")
    yield 0.5
    return dialog


def click(dialog, kind):
    later(dialog.button(getattr(QtWidgets.QWizard.WizardButton, kind)).click)
    yield 0.5
    yield 2


def wizard(results):
    dialog = yield from ask()
    for number in range(4):
        photo(os.path.join(FOLDER, f"wizard-{number}.png"), dialog)
        choice = dialog.findChild(QtWidgets.QComboBox, "Sensor" if number == 1 else "Species")
        if number in (1, 2):
            results["sensors" if number == 1 else "species"] = [choice.itemText(i) for i in range(choice.count())]
        if number < 3:
            dialog.next()
            yield 0.3
    yield from click(dialog, "CancelButton")
    results["cancelled"] = names()
    dialog = yield from ask()
    yield from click(dialog, "FinishButton")
    results["made"] = names()
    results["times"] = list(simple.GetAnimationScene().TimeKeeper.TimestepValues)
    results["birds"] = simple.FindSource("Echoes of herring gull").GetDataInformation().GetNumberOfPoints()
    results["air"] = simple.FindSource("Scan").MeteorologicalVisibility
    photo(os.path.join(FOLDER, "made.png"), main_window())
    yield from press(action("actionEditUndo"))
    results["undone"] = names()
    dialog = yield from ask()
    dialog.findChild(QtWidgets.QComboBox, "Sensor").setCurrentText("Airport 16")
    dialog.findChild(QtWidgets.QComboBox, "Weather").setCurrentIndex(3)
    yield from click(dialog, "FinishButton")
    results["refused"] = names()
    dialog = yield from ask()
    dialog.findChild(QtWidgets.QComboBox, "Sensor").setCurrentText("Velodyne VLP-16")
    dialog.findChild(QtWidgets.QSpinBox, "Number").setValue(3)
    dialog.findChild(QtWidgets.QComboBox, "Species").setCurrentText("crow")
    line = next(one for one in dialog.findChildren(QtWidgets.QLineEdit) if one.parent().objectName() == "Scene")
    line.setText(SCENE)
    yield 0.3
    yield from click(dialog, "FinishButton")
    results["own"] = [name for name in names() if "crow" not in name.lower()]
    yield from delete_all()


def beam(results):
    """A scan of the airport, an echo of many surfaces selected, its beam, and another's."""
    yield from press(action(BEAM))
    results["nothing"] = names()
    yield from press(action("avian_lidar_airport_scan"))
    scan, view = simple.FindSource("Scan"), simple.GetActiveView()
    data = servermanager.Fetch(scan)
    share, ids = data.GetPointData().GetArray("label_share"), data.GetPointData().GetArray("beam_id")
    order = sorted(range(data.GetNumberOfPoints()), key=share.GetValue)
    found = results["beam"] = {"wanted": int(ids.GetValue(order[0]))}
    simple.SetActiveSource(scan)
    simple.SelectIDs(IDs=[-1, order[0]], FieldType="POINT", Source=scan)
    yield 0.5
    yield from press(action(BEAM))
    shown = simple.FindSource("Beam")
    table = servermanager.Fetch(shown, idx=2)
    found["id"], found["rows"] = int(shown.BeamId), table.GetNumberOfRows()
    found["solid"] = [table.GetValueByName(i, "solid_angle_share").ToDouble() for i in range(found["rows"])]
    found["energy"] = [table.GetValueByName(i, "energy_share").ToDouble() for i in range(found["rows"])]
    found["cells"] = shown.GetDataInformation(0).GetNumberOfCells()
    displays = [servermanager.GetRepresentation(shown[port], view) for port in (0, 1)]
    found["shown"] = [bool(display and display.Visibility) for display in displays]
    simple.SetActiveSource(scan)
    # One that sees walls, panes, the apron, and the sky.
    other = next(i for i in range(data.GetNumberOfPoints()) if ids.GetValue(i) == SEES_MUCH)
    found["other"] = int(ids.GetValue(other))
    simple.SelectIDs(IDs=[-1, other], FieldType="POINT", Source=scan)
    yield from press(action(BEAM))
    found["again"] = [int(shown.BeamId), len([name for name in names() if name.startswith("Beam")])]
    simple.ClearSelection()
    look_at_beam(shown, view)
    yield 1
    photo(os.path.join(FOLDER, "beam.png"), main_window().centralWidget())
    yield from delete_all()


def close_messages():
    """Output Messages opens by itself over the view."""
    for dock in main_window().findChildren(QtWidgets.QDockWidget):
        if "utput" in dock.objectName() or "utput" in dock.windowTitle():
            dock.hide()


def look_at_beam(beam, view):
    """From the lidar's side, from above."""
    close_messages()
    cone, parts = servermanager.Fetch(beam, idx=1), servermanager.Fetch(beam)
    share = parts.GetCellData().GetArray("energy_share")
    most = max(range(parts.GetNumberOfCells()), key=share.GetValue)
    bounds = parts.GetCell(most).GetBounds()
    centre = [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]
    way = [a - b for a, b in zip(centre, cone.GetPoint(0))]
    length = sum(one**2 for one in way) ** 0.5
    ahead = [one / length for one in way]
    view.CameraFocalPoint = centre
    view.CameraPosition = [c - 300 * a + side for c, a, side in zip(centre, ahead, (-120 * ahead[1], 120 * ahead[0], 90))]
    view.CameraViewUp, view.CameraParallelScale = [0, 0, 1], 18.0
    simple.HideUnusedScalarBars(view)
    simple.RenderAllViews()


def sequence(results):
    """Opened as by File > Open, applied, played."""
    found = results["sequence"] = {}
    reader = simple.OpenDataFile(SEQUENCE)
    simple.SetActiveSource(reader)
    found["proxy"] = reader.SMProxy.GetXMLName()
    simple.Show(reader)
    yield 0.5
    button = find("Accept", QtWidgets.QAbstractButton, panel())
    if button.isEnabled():
        later(button.click)
        yield 1
    if not simple.GetDisplayProperties(reader).ColorArrayName[1]:
        yield from press(action("avian_lidar_class_colours"))
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    found["steps"], found["points"] = list(scene.TimeKeeper.TimestepValues), []
    scene.GoToFirst()
    for _ in found["steps"]:
        simple.Render()
        found["points"].append(reader.GetDataInformation(0).GetNumberOfPoints())
        scene.GoToNext()
        yield 0.1
    yield from press(action("avian_lidar_class_colours"))
    found["colours"] = list(simple.GetDisplayProperties(reader).ColorArrayName)
    found["annotations"] = list(simple.GetColorTransferFunction("semantic_label").Annotations)
    found["boxes"] = servermanager.Fetch(reader, idx=1).GetNumberOfCells()
    view = simple.GetActiveView()
    view.CameraFocalPoint, view.CameraPosition, view.CameraViewUp = [0, 0, 0], [-600, -400, 700], [0, 0, 1]
    simple.ResetCamera(view)
    simple.HideUnusedScalarBars(view)
    close_messages()
    simple.Render()
    yield 0.5
    photo(os.path.join(FOLDER, "sequence.png"), next(one for one in main_window().centralWidget().findChildren(QtWidgets.QWidget)
                                                     if "QVTK" in one.metaObject().className() and one.isVisible()))


def steps(results):
    yield from until(lambda: find("AvianLidarToolbar") and action("AvianLidarEchoFilter"), "the toolbar")
    yield 1
    bar = find("AvianLidarToolbar", QtWidgets.QToolBar)
    results["hidden"] = [entry.objectName() for entry in bar.actions() if not bar.widgetForAction(entry).isVisible()]
    photo(os.path.join(FOLDER, "window.png"), main_window())
    yield from sensors(results)
    yield from wizard(results)
    yield from beam(results)
    yield from sequence(results)


client_window.run(steps)
