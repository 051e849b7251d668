# SPDX-License-Identifier: BSD-3-Clause
"""What a user chooses in ParaView's window: sensors by maker, the wizard, the beam of an echo, macros that Undo takes
back."""

import json
import os

from client_qt import QtWidgets
from client_window import (FOLDER, SOURCE_DIR, action, canvas, close_messages, delete_all, find, later, main_window,
                           names, photo, pixels, points_of, press, shown, take, until)
from paraview import servermanager, simple

FOLDERS = [os.path.join(SOURCE_DIR, "Filters", folder) for folder in ("Sensors", "Birds")]
BOX = os.path.join(FOLDER, "box.obj")
VLP16 = "Ouster (formerly Velodyne) VLP-16"
SEES_MUCH = 11408  # a beam that sees walls, panes, the apron, and the sky
MACROS = ("avian_lidar_airport_scan", "avian_lidar_birds_over_the_airport", "avian_lidar_coverage")


def sensors_by_maker():
    """{maker: {name}} of the files of sensors."""
    found = {}
    for file in os.listdir(FOLDERS[0]):
        if file.endswith(".lidarsensor.json"):
            with open(os.path.join(FOLDERS[0], file), encoding="utf-8") as text:
                sensor = json.load(text)
            found.setdefault(sensor.get("maker"), set()).add(f"{sensor.get('maker')} {sensor.get('model')}")
    return found


def sensors():
    """The menu Sources by maker, and what is chosen there."""
    yield from delete_all()
    sources = main_window().findChild(QtWidgets.QMenu, "menuSources")
    sources.popup(main_window().pos())
    yield 0.3
    mark = "Avian Lidar: "
    entries = {entry.text().replace("&", ""): entry for entry in sources.actions() if entry.menu()}
    # ParaView 5.13 writes Robo Sense.
    ours = {text[len(mark):].replace(" ", ""): entry for text, entry in entries.items() if text.startswith(mark)}
    expected = {maker.replace(" ", ""): labels for maker, labels in sensors_by_maker().items() if maker}
    lidars = {maker: [one.text() for one in entry.menu().actions() if one.text()] for maker, entry in ours.items()}
    assert len(lidars.pop("Assumed")) == len(expected.pop("assumed")), lidars
    assert {maker: {*labels} for maker, labels in lidars.items()} == expected, lidars
    sources.setActiveAction(ours["Ouster"])
    ours["Ouster"].menu().popup(sources.mapToGlobal(sources.actionGeometry(ours["Ouster"]).topRight()))
    yield 0.3
    photo("sensors.png", main_window())
    ours["Ouster"].menu().close()
    sources.close()
    for _ in range(2):
        yield from press(action("AvianLidarOS164"))
    assert names() == ["Ouster OS1-64", "Ouster OS1-64 (2)"], names()
    yield from press(action("actionEditUndo"))
    assert names() == ["Ouster OS1-64"], names()


def ask(button, turn=0, **answers):
    """Opens the wizard, turns pages, answers and presses a button; to be yielded from."""
    done = []
    later(lambda: (action("avian_lidar_wizard").trigger(), done.append(1)))
    dialog = yield from until(lambda: find("AvianLidarWizard"), "the wizard")
    for number in range(turn):
        yield 0.2
        photo(f"wizard-{number}.png", dialog)
        dialog.next()
    for name, value in answers.items():
        if name == "Scene":
            next(one for one in dialog.findChildren(QtWidgets.QLineEdit) if one.parent().objectName()
                 == name).setText(value)
        elif isinstance(value, int):
            dialog.findChild(QtWidgets.QSpinBox, name).setValue(value)
        else:
            choice = dialog.findChild(QtWidgets.QComboBox, name)
            choice.setCurrentText(value)
            assert choice.currentText() == value, (name, value)
    choices = [dialog.findChild(QtWidgets.QComboBox, name) for name in ("Species", "Sensor", "Weather")]
    texts = [[choice.itemText(i) for i in range(choice.count())] for choice in choices]
    yield 0.2
    later(dialog.button(getattr(QtWidgets.QWizard.WizardButton, button)).click)
    yield from until(lambda: done, "what the wizard makes", 150)
    yield 0.5
    return texts


def wizard():
    """Cancelled, finished at once, refused, and with answers."""
    yield from delete_all()
    species, sensors, weathers = yield from ask("CancelButton", turn=3)
    assert not names(), names()
    with open(os.path.join(FOLDERS[1], "species.csv"), encoding="utf-8") as file:
        assert species == [line.split(",")[0] for line in file if not line.startswith("#")][1:], species
    makers = sensors_by_maker()
    assert {*sensors} >= set.union(*(makers[maker] for maker in makers if maker not in (None, "assumed"))), sensors
    yield from ask("FinishButton")
    assert names() == ["Airport Hongqiao", "Birds", "Collision tree", "Echoes of herring gull", "Edges", "Herring gull",
                       "Landmarks", "Scan", "Search 905"], names()
    assert list(simple.GetAnimationScene().TimeKeeper.TimestepValues) == [2.0 * k for k in range(10)]
    assert points_of(simple.FindSource("Echoes of herring gull")) > 0
    assert simple.FindSource("Scan").MeteorologicalVisibility == 23000
    yield from press(action("actionEditUndo"))
    assert not names(), names()
    rain = next(text for text in weathers if "ain" in text)
    yield from ask("FinishButton", Sensor="Airport 16", Weather=rain)
    (said,) = take()
    assert "Receiver Aperture" in said and not names(), (said, names())
    yield from ask("FinishButton", Weather=rain)
    assert simple.FindSource("Scan").RainRate == 10
    yield from delete_all()
    with open(BOX, "w", encoding="utf-8") as file:
        file.write("v -10 60 0\nv 10 60 0\nv 10 60 10\nv -10 60 10\nf 1 2 3\nf 1 3 4\n")
    yield from ask("FinishButton", Sensor=VLP16, Number=3, Species="crow", Scene=BOX)
    own = [name for name in names() if "crow" not in name.lower()]
    assert own == sorted(["Birds", "Collision tree", "Edges", "Landmarks", "Scan", VLP16, "box"]), own
    yield from delete_all()


def beam():
    """The beam of a selected echo of the airport's scan, then of another echo."""
    button, scan, view = action("avian_lidar_show_beam"), simple.FindSource("Scan"), simple.GetActiveView()
    before = names()
    simple.SetActiveSource(scan)
    simple.ClearSelection()
    yield from press(button)
    (said,) = take()
    assert "select an echo" in said and names() == before, (said, names())
    data = servermanager.Fetch(scan).GetPointData()
    ids, share = data.GetArray("beam_id"), data.GetArray("label_share")
    count = ids.GetNumberOfTuples()
    echoes = (min(range(count), key=share.GetValue), next(i for i in range(count) if ids.GetValue(i) == SEES_MUCH))
    for echo in echoes:
        simple.SetActiveSource(scan)
        simple.SelectIDs(IDs=[-1, echo], FieldType="POINT", Source=scan)
        yield 0.3
        yield from press(button)
        beam = simple.FindSource("Beam")
        assert int(beam.BeamId) == ids.GetValue(echo) and len(names()) == len(before) + 1, (beam.BeamId, names())
    table = servermanager.Fetch(beam, idx=2)
    rows = range(table.GetNumberOfRows())
    for name in ("solid_angle_share", "energy_share"):
        assert abs(sum(table.GetValueByName(i, name).ToDouble() for i in rows) - 1) < 1e-6, name
    assert len(rows) > 1 and beam.GetDataInformation(0).GetNumberOfCells() > 0
    assert shown(beam, view) and shown(beam, view, 1)
    simple.ClearSelection()
    look_at(beam, view)
    yield 0.5
    photo("beam.png", main_window().centralWidget())
    simple.Delete(beam)
    yield 0.3


def look_at(beam, view):
    """From the lidar's side, from above."""
    close_messages()
    cone, parts = servermanager.Fetch(beam, idx=1), servermanager.Fetch(beam)
    share = parts.GetCellData().GetArray("energy_share")
    bounds = parts.GetCell(max(range(parts.GetNumberOfCells()), key=share.GetValue)).GetBounds()
    centre = [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]
    way = [a - b for a, b in zip(centre, cone.GetPoint(0))]
    ahead = [one / sum(one**2 for one in way) ** 0.5 for one in way]
    view.CameraFocalPoint = centre
    view.CameraPosition = [c - 300 * a + side
                           for c, a, side in zip(centre, ahead, (-120 * ahead[1], 120 * ahead[0], 90))]
    view.CameraViewUp, view.CameraParallelScale = [0, 0, 1], 18.0
    simple.HideUnusedScalarBars(view)
    simple.RenderAllViews()


def state(first):
    """What is open, and what the first view shows, from where."""
    camera = [round(value, 3) for value in (*first.CameraPosition, first.CameraParallelScale)]
    sources = {name: source for (name, _), source in simple.GetSources().items()}
    seen = {(name, port) for name, source in sources.items() for port in range(source.SMProxy.GetNumberOfOutputPorts())
            if shown(source, first, port)}
    return sorted(sources), len(simple.GetViews()), sorted(seen), camera


def check_birds(view):
    """Every kind is seen on the screen in its colour where its echoes are; birds and their ways hide one another."""
    picture = pixels(canvas(view))
    height, width, _ = picture.shape
    matrix = view.GetActiveCamera().GetCompositeProjectionTransformMatrix(width / height, -1, 1)
    for kind in ("gulls", "crows", "starlings"):
        # Fetch would be a step to undo.
        echoes = simple.FindSource("Echoes of " + kind)
        data = echoes.SMProxy.GetClientSideObject().GetOutputDataObject(0)
        colour = simple.GetDisplayProperties(echoes, view).DiffuseColor
        own = []
        for i in range(data.GetNumberOfPoints()):
            x, y = matrix.MultiplyPoint([*data.GetPoint(i), 1])[:2]
            pixel = picture[round((1 - y) * height / 2), round((x + 1) * width / 2)]
            own.append((abs(pixel - [round(255 * value) for value in colour]) < 10).all())
        assert len(own) > 5 and sum(own) >= 0.75 * len(own), (kind, own)


def undo():
    """Edit > Undo takes back a whole macro, its views, too, and Redo brings it back; names in the pipeline are
    unique."""
    yield from delete_all()
    view, back = simple.GetActiveView(), action("actionEditUndo")
    states = [state(view)]
    for macro in MACROS:
        simple.SetActiveSource(None)
        yield 0.3
        yield from press(action(macro))
        states.append(state(view))
        assert back.text() == "&Undo " + action(macro).text(), back.text()
        photo(macro + ".png", main_window())
        if "birds" in macro:
            check_birds(view)
    ports = {source.SMProxy.GetOutputPortName(port) for source in simple.GetSources().values()
             for port in range(source.SMProxy.GetNumberOfOutputPorts()) if source.SMProxy.GetNumberOfOutputPorts() > 1}
    assert len({*names()}) == len(names()) and not ports & {*names()}, (ports, names())
    count = points_of(simple.FindSource("Scan"))
    for before in states[-2::-1]:
        yield from press(back)
        assert state(view) == before, (state(view), before)
    yield from press(action("actionEditRedo"))
    assert state(view) == states[1], (state(view), states[1])
    scan = simple.FindSource("Scan")
    scan.UpdatePipeline()
    assert points_of(scan) == count
    yield from press(back)
    # A macro that finds nothing to do leaves no step, and one that applies what was opened leaves that.
    simple.SetActiveSource(None)
    yield 0.3
    label = back.text()
    yield from press(action("avian_lidar_energy_colours"))
    assert back.text() == label
    box = simple.Box(XLength=20, Center=[0, 60, 0])
    before = state(view)
    simple.SetActiveSource(box)
    yield 0.3
    yield from press(action(MACROS[0]))
    take()
    yield from press(back)
    assert state(view) == before, (state(view), before)
    yield from delete_all()
