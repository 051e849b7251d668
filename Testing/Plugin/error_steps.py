# SPDX-License-Identifier: BSD-3-Clause
"""Errors in ParaView's window, alone or as a client: each is said each time by every object that it hits, there is
nothing to see while it lasts, what comes after it is seen, and undo, reload and reset lead out of it."""

import json
import os
import pathlib

from client_qt import QtWidgets
from client_window import (FOLDER, action, app, apply_button, apply_value, delete_all, errors, later, names, points_of,
                           press, take, until)
from paraview import simple
from vtkmodules.vtkCommonDataModel import vtkDataObject

SCENE = os.path.join(FOLDER, "errors.lidarscene.json")
# What follows what, and the class of each.
CHAIN = {
    "Scene": ("Material", "Tree", "Echoes", "Colours", "Image"),
    "Sensor": ("Echoes", "Colours", "Image"),
    "Echoes": ("Colours", "Image"),
}
CLASSES = {"Scene": "SceneReader", "Material": "Material", "Tree": "CollisionTree", "Sensor": "BeamSource",
           "Echoes": "EchoFilter", "Colours": "HSBColorMap", "Image": "RangeImage"}
WRITTEN = ("las", "pcd", "csv")  # ours keep a good file by themselves, ParaView's by the window alone


def write_scene(width=200):
    """A ground of a width, m; without one a file that is not a scene."""
    ground = {"ground": {"size": width, "height": -1}, "material": "wall", "name": "ground"}
    pathlib.Path(SCENE).write_text(json.dumps({"version": 1, "objects": [ground]}) if width else "{", "utf-8")


class Pipeline:
    """Every object of CLASSES, shown."""

    def __init__(self):
        write_scene(120)
        scene = simple.OpenDataFile(SCENE)
        material = simple.AvianLidarMaterial(Input=scene, Material="Custom", Kd=0.5)
        tree = simple.AvianLidarCollisionTree(Input=material)
        sensor = simple.AvianLidarBeamSource(Position=[0, 0, 3], AzimuthStep=3, MinimumElevation=-30, ElevationStep=1.5)
        echoes = simple.AvianLidarEchoFilter(Beams=sensor, Surfaces=tree)
        parts = (scene, material, tree, sensor, echoes, simple.AvianLidarHSBColorMap(Input=echoes),
                 simple.AvianLidarRangeImage(Echoes=echoes, Beams=sensor))
        self.all = dict(zip(CLASSES, parts))
        self.view = simple.GetActiveViewOrCreate("RenderView")
        for name, proxy in self.all.items():
            simple.RenameSource(name, proxy)
            simple.Show(proxy, self.view)
        simple.Render(self.view)

    def look(self):
        """{name: (elements of its output, elements drawn, is there an error)}"""
        found = {}
        for name, proxy in self.all.items():
            data = proxy.GetDataInformation(0).DataInformation
            drawn = simple.GetRepresentation(proxy, self.view).SMProxy.GetRepresentedDataInformation()
            error = data.GetArrayInformation("error", vtkDataObject.FIELD)
            found[name] = (*(one.GetNumberOfPoints() + one.GetNumberOfCells() for one in (data, drawn)), bool(error))
        return found

    def case(self, name, change, values):
        """Each odd value is wrong, each even one right; to be yielded from."""
        seen = self.look()
        hit = (name, *CHAIN[name])
        for step, value in enumerate(values):
            yield from change(value)
            said, look = take(), self.look()
            if step % 2:
                assert not said and all(data and drawn and not error
                                        for data, drawn, error in look.values()), (name, said, look)
                assert look["Echoes"] != seen["Echoes"], (name, value, look)  # those of the new value
                seen = look
                continue
            assert len(said) == len(hit), (name, value, said)
            for each in hit:  # once, the first one what it is
                (text,) = [text for text in said if f"vtkAvianLidar{CLASSES[each]} (" in text]
                assert ("its producer failed" in text) == (each != name), text
            for each, (data, drawn, error) in look.items():
                assert error == (each in hit), (name, each, look)
                # An image has its extent, and no numbers.
                assert each == "Image" or (data == 0, drawn == 0) == (each in hit,) * 2, (name, each, look)

    def by_panel(self, name, prop):
        return lambda value: apply_value(self.all[name], prop, f"{value:.6g}")

    def by_file(self, width):
        write_scene(width)
        simple.SetActiveSource(self.all["Scene"])
        yield 0.2
        yield from press(action("actionReloadFiles"))


def cases(*chosen):
    """The chosen cases and Save Data of what failed; to be yielded from."""
    yield from delete_all()
    pipeline = Pipeline()
    yield 0.5
    assert not apply_button().isEnabled(), "nothing was changed"
    air = pipeline.by_panel("Echoes", "AttenuationCoefficient")
    yield from pipeline.case("Echoes", air, (-1, 0.05, -2, 0.01))  # the second time, too
    given = {"Sensor": (pipeline.by_panel("Sensor", "PulseEnergy"), (-1, 5e-5)),
             "Scene": (pipeline.by_file, (None, 30))}
    for name in chosen:
        yield from pipeline.case(name, *given[name])
    yield from save(pipeline, air)
    yield from delete_all()


def save(pipeline, change):
    """Save Data is there for good data alone, also for those of a filter behind that loses the error."""
    echoes = pipeline.all["Echoes"]
    behind = simple.AppendDatasets(Input=[simple.Sphere(), echoes])
    contents = {}
    for value in (None, -1, 0.02):
        if value:
            yield from change(value)
        behind.UpdatePipeline()
        for proxy in (echoes, behind):
            simple.SetActiveSource(proxy)
            yield 0.1
            assert action("actionFileSaveData").isEnabled() == (value != -1), (value, names())
        for name in WRITTEN:
            file = pathlib.Path(FOLDER, "saved." + name)
            if value != -1 or name != "csv":
                simple.SaveData(str(file), proxy=echoes, **({"CoordinateSystem": "Local"} if name == "las" else {}))
            before, contents[name] = contents.get(name), file.read_bytes()
            assert value is None or (contents[name] == before) == (value == -1), (name, value)
        take()


def walks():
    """From an error, by undo and reset, to what is left; the next good scan works beside that."""
    write_scene()

    def scan():
        beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=4, MinimumElevation=-30)
        echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=simple.OpenDataFile(SCENE))
        simple.Show(echoes)
        simple.Render()
        simple.SetActiveSource(echoes)
        return echoes

    for way in ("actionEditUndo", "actionDelete_All"):
        yield from delete_all()
        yield from apply_value(scan(), "AttenuationCoefficient", "-1")
        (said,) = take()
        assert "AttenuationCoefficient" in said, said
        left = names()
        if way == "actionDelete_All":
            left = []
            later(action(way).trigger)
            box = yield from until(lambda: app.activeModalWidget() or not names(), "the reset")
            if box is not True:
                yield 0.1
                message = isinstance(box, QtWidgets.QMessageBox)
                (box.button(QtWidgets.QMessageBox.StandardButton.Yes).click if message else box.accept)()
            yield from until(lambda: not names(), "an empty session")
            yield 0.5
        else:
            yield from press(action(way))
        assert names() == left, (names(), left)
        take()
        again = scan()
        yield 0.2
        assert points_of(again) > 500 and not errors, errors
    yield from delete_all()
