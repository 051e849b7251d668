# SPDX-License-Identifier: BSD-3-Clause
"""Panels in ParaView's window: every one opens, no text has less room than it needs in the width that ParaView starts
with, also in the options of Save Data; the button Advise sets the panel's values and applies nothing."""

import os
import re

import client_window
from client_qt import QtWidgets
from client_window import (AIRPORT, FOLDER, SOURCE_DIR, apply, apply_button, delete_all, dialog_of, find, later, panel,
                           panel_of, photo, press, take, texts_cut, type_in, until)
from paraview import servermanager, simple

SENSOR = os.path.join(SOURCE_DIR, "Filters", "Sensors", "VLP32C.lidarsensor.json")
WIDTH = 300  # pixels of a panel, at most: ParaView starts with 290
# ParaView's way to write 9.62751e-16: longer than a field. 5.13 writes 0.000004166666666666667.
SIXTEEN_DIGITS = re.compile(r"[1-9]\.?\d{15}")
# Values that show or enable other properties.
VARIANTS = {
    "AvianLidarMedium": {"Kind": "Rain", "Shape": "Ellipsoid"},
    "AvianLidarMaterial": {"Material": "Custom"},
    "AvianLidarEchoFilter": {"Preset": "Standard"},
    "AvianLidarGeodeticTransform": {"MovePoints": 1, "UseFieldDataOrigin": 0, "Origin": [31.2, 121.3, 5]},
    "AvianLidarHSBColorMap": {"UseFieldDataRange": 0},
    "AvianLidarTracks": {"Pattern": "Approach"},
}
ADVISED = ("Preset", "BeamSamples", "RaysPerBeam", "Sampling", "NumberOfReflections", "NumberOfConnections")


def names_of(group):
    """The plugin's proxies of a group, of sensors one with each receiver: they have one panel."""
    manager = servermanager.ProxyManager()
    iterator = manager.SMProxyManager.GetProxyDefinitionManager().NewSingleGroupIterator(group)
    iterator.UnRegister(None)
    found = {}
    while not iterator.IsDoneWithTraversal():
        name = iterator.GetProxyName()
        if name.startswith("AvianLidar"):
            receiver = manager.GetPrototypeProxy(group, name).GetProperty("ReceiverModel")
            found.setdefault(receiver.GetElement(0) if receiver else name, name)
        iterator.GoToNextItem()
    return sorted(found.values())


class Pipeline:
    """Inputs for filters, by the names of their properties; files for readers."""

    def __init__(self):
        self.scene = simple.Sphere(Center=[0, 60, 0], Radius=30)
        beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=10)
        echoes, other = (simple.AvianLidarEchoFilter(Beams=beams, Surfaces=self.scene, Seed=seed) for seed in (0, 1))
        self.echoes = echoes
        self.ports = {"Beams": beams, "Surfaces": self.scene, "Echoes": echoes, "Input": echoes, "Simulated": other,
                      "Reference": echoes}
        cloud, times = os.path.join(FOLDER, "cloud.pcd"), os.path.join(FOLDER, "times.txt")
        simple.SaveData(cloud, proxy=echoes)
        os.makedirs(os.path.join(FOLDER, "velodyne"), exist_ok=True)
        for name, content in (("velodyne/000000.bin", bytes(16)), ("times.txt", b"0\n")):
            with open(os.path.join(FOLDER, name), "wb") as file:
                file.write(content)
        self.files = {"AvianLidarSceneReader": AIRPORT, "AvianLidarSensorReader": SENSOR,
                      "AvianLidarPointCloudReader": cloud, "AvianLidarSequenceReader": times}

    def make(self, group, name):
        if name in self.files:
            return simple.OpenDataFile(self.files[name])
        prototype = servermanager.ProxyManager().GetPrototypeProxy(group, name)
        inputs = {port: proxy for port, proxy in self.ports.items() if prototype.GetProperty(port)}
        if name in ("AvianLidarMaterial", "AvianLidarCollisionTree", "AvianLidarMediumInSurface"):
            inputs["Input"] = self.scene
        return getattr(simple, name)(**(inputs if group == "filters" else {}))


def pages(parent, name):
    """The properties as they first are and with the advanced ones: texts that are cut; to be yielded from."""
    cut, button = [], find("AdvancedButton", parent=parent)
    for page in ("default", "advanced") if button else ("default",):
        if page == "advanced":
            button.click()
        yield 0.1
        # A dialog that grows keeps its lower end on the screen.
        frame = find("PropertiesFrame", parent=parent)
        if client_window.DOCUMENTED:
            yield 0.2
            photo(f"{name}-{page}.png", parent, frame)
        cut += [f"{name} ({page}): {text}" for text in texts_cut(frame or parent) if not SIXTEEN_DIGITS.search(text)]
    if frame and button:
        button.click()
    assert not cut and panel().width() <= WIDTH, (cut, panel().width())


def panels():
    yield from delete_all()
    find("pipelineBrowserDock").setVisible(not client_window.DOCUMENTED)  # leaves its height to the panel
    pipeline = Pipeline()
    for group in ("sources", "filters"):
        for name in names_of(group):
            proxy = pipeline.make(group, name)
            for variant in ({}, VARIANTS[name]) if name in VARIANTS else ({},):
                for prop, value in variant.items():
                    setattr(proxy, prop, value)
                simple.SetActiveSource(proxy)
                yield from until(lambda: find("ProxyPanel", parent=panel()), "the panel of " + name)
                proxy.UpdatePipeline()
                yield from pages(panel(), name + "".join(map(str, variant.values())))
            if proxy.GetProperty("Species"):
                species = find("Species", parent=panel()).findChild(QtWidgets.QComboBox)
                assert species.findText("crow") >= 0 and species.currentText() == proxy.Species[0], name
            simple.Delete(proxy)
    simple.SetActiveSource(pipeline.echoes)
    dialog = yield from dialog_of("actionFileSaveData", "FileSaveDialog")
    yield 0.2
    box = find("EntityType", QtWidgets.QComboBox, dialog)
    box.setCurrentIndex(next(i for i in range(box.count()) if "*.las " in box.itemText(i)))
    name = os.path.join(FOLDER, "dialog.las")
    find("EntityName", QtWidgets.QLineEdit, dialog).setText(name)
    later(find("OK", parent=dialog).click)
    options = yield from until(lambda: find("WriterSettingsDialog"), "the options of Save Data")
    yield from pages(options, "SaveData-LAS")
    later(options.accept)
    yield from until(lambda: os.path.exists(name), name)
    find("pipelineBrowserDock").show()
    left = take()
    # the error names the missing array, and the panel still opens
    assert all("geodetic_origin" in text for text in left), left
    yield from delete_all()


def advise():
    """Preset becomes Custom, as another one overrides what is advised; Apply takes it over. An error is said, nothing
    is set."""
    yield from delete_all()
    sphere = simple.Sphere(Center=[0, 60, 0], Radius=20, ThetaResolution=32, PhiResolution=32)
    echoes = simple.AvianLidarEchoFilter(Beams=simple.AvianLidarBeamSource(AzimuthStep=0.5), Surfaces=sphere,
                                         Preset="Standard")
    echoes.UpdatePipeline()
    simple.Show(echoes, simple.GetActiveViewOrCreate("RenderView"))
    yield 0.3
    yield from panel_of(echoes, "Advise")
    yield 0.3
    properties = {name: echoes.SMProxy.GetProperty(name) for name in ADVISED}
    before = {name: prop.GetElement(0) for name, prop in properties.items()}
    button = find("Advise", QtWidgets.QAbstractButton, panel())
    yield from press(button)
    answer = find("AdviseAnswer", QtWidgets.QLabel, panel())
    advised = {name: prop.GetUncheckedElement(0) for name, prop in properties.items()}
    assert {name: prop.GetElement(0) for name, prop in properties.items()} == before, "applied"
    assert (before["Preset"], advised["Preset"], advised["NumberOfReflections"]) == (2, 0, 1), (before, advised)
    preset = find("Preset", parent=panel()).findChild(QtWidgets.QComboBox)
    assert preset.currentText() == "Custom" and apply_button().isEnabled()
    # A convex body cannot light itself.
    assert "One reflection is enough" in answer.text(), answer.text()
    assert f"{advised['RaysPerBeam']}" in answer.toolTip(), answer.toolTip()
    yield from apply()
    assert {name: prop.GetElement(0) for name, prop in properties.items()} == advised, "not applied"
    take()
    type_in("AttenuationCoefficient", "-1")
    yield 0.3
    yield from press(button)
    assert any("AttenuationCoefficient" in text for text in take()) and "No advice" in answer.text(), answer.text()
    assert len(simple.GetSources()) == 3, simple.GetSources()  # what the button makes is not shown
    yield from delete_all()
