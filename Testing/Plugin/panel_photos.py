# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestPanels.py: photographs the panel of every proxy of the plugin, and the dialogs of File
> Open and File > Save Data, and notes what they show and which texts have not enough room.

The results: {"panels": {proxy: {"default": [properties shown], "advanced": [...]}}, "writers": {...},
"open": [file filters], "save": [...], "cut": [texts], "samples": [texts], "width": pixels of the widest panel}"""

import os

import client_window
from client_qt import QAction, QtWidgets
from client_window import FOLDER, find, later, panel, photo, texts_cut, until
from paraview import servermanager, simple

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
SENSOR = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Filters", "Sensors", "VLP32C.lidarsensor.json")
TEXT = "Greatest wavelength"
WRITERS = {"las": "LAS", "pcd": "PCD", "ply": "PLY", "bin": "KITTI", "geojson": "GeoJSON"}
VARIANTS = {
    "AvianLidarMedium": ("Shower", {"Kind": "Rain", "Shape": "Ellipsoid"}),
    "AvianLidarMaterial": ("Custom", {"Material": "Custom"}),
    "AvianLidarEchoFilter": ("Standard", {"Preset": "Standard"}),
    "AvianLidarGeodeticTransform": ("Moved", {"MovePoints": 1, "UseFieldDataOrigin": 0, "Origin": [31.2, 121.3, 5]}),
    "AvianLidarHSBColorMap": ("Given", {"UseFieldDataRange": 0}),
    "AvianLidarTracks": ("Approach", {"Pattern": "Approach"}),
}


def names_of(group):
    """The plugin's proxies of a group."""
    definitions = servermanager.ProxyManager().SMProxyManager.GetProxyDefinitionManager()
    iterator = definitions.NewSingleGroupIterator(group)
    iterator.UnRegister(None)
    names = []
    while not iterator.IsDoneWithTraversal():
        if iterator.GetProxyName().startswith("AvianLidar"):
            names.append(iterator.GetProxyName())
        iterator.GoToNextItem()
    return sorted(names)


def shown(parent):
    """The properties of the proxy's panel that are to be seen, from top to bottom."""
    found = []
    for child in parent.findChildren(QtWidgets.QWidget):
        inner = child.parent().metaObject().className().endswith("PropertyWidget")
        if child.isVisible() and child.metaObject().className().endswith("PropertyWidget") and not inner:
            found.append((child.mapToGlobal(child.rect().topLeft()).y(), child.objectName()))
    return ["Position" if name == "InteractiveHandle" else name for _, name in sorted(found)]


class Pipeline:
    """Inputs for filters, by the names of their properties."""

    def __init__(self):
        self.scene = simple.OpenDataFile(SCENE)
        self.beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=1.5)
        self.echoes = simple.AvianLidarEchoFilter(Beams=self.beams, Surfaces=self.scene)
        self.other = simple.AvianLidarEchoFilter(Beams=self.beams, Surfaces=self.scene, Seed=1)

    def inputs(self, name):
        if name in ("AvianLidarMaterial", "AvianLidarCollisionTree"):
            return {"Input": self.scene}
        if name == "AvianLidarMediumInSurface":
            return {"Input": simple.Sphere()}
        ports = {"Beams": self.beams, "Surfaces": self.scene, "Echoes": self.echoes}
        ports.update(Input=self.echoes, Simulated=self.other, Reference=self.echoes)
        prototype = servermanager.ProxyManager().GetPrototypeProxy("filters", name)
        return {port: proxy for port, proxy in ports.items() if prototype.GetProperty(port)}

    def make(self, name, source):
        """A proxy to photograph; readers have read a file."""
        if name == "AvianLidarSceneReader":
            return simple.OpenDataFile(SCENE)
        if name == "AvianLidarSensorReader":
            return simple.OpenDataFile(SENSOR)
        if name == "AvianLidarPointCloudReader":
            cloud = os.path.join(FOLDER, "cloud.pcd")
            simple.SaveData(cloud, proxy=self.echoes)
            return simple.OpenDataFile(cloud)
        if name == "AvianLidarSequenceReader":
            os.makedirs(os.path.join(FOLDER, "velodyne"), exist_ok=True)
            with open(os.path.join(FOLDER, "velodyne", "000000.bin"), "wb") as scan, open(os.path.join(FOLDER, "times.txt"), "w", encoding="utf-8") as times:
                scan.write(bytes(16))
                times.write("0\n")
            return simple.OpenDataFile(times.name)
        return getattr(simple, name)(**({} if source else self.inputs(name)))


def pages(parent, name, results):
    """The properties as they first are and with the advanced ones, photographed; to be yielded from."""
    found = {}
    button = find("AdvancedButton", parent=parent)
    for page in ("default", "advanced"):
        if page == "advanced":
            if not button:  # nothing here is advanced
                break
            button.click()
        yield 0.2
        # A dialog that grows keeps its lower end on the screen.
        frame = find("PropertiesFrame", parent=parent)
        found[page] = shown(frame or parent)
        photo(os.path.join(FOLDER, f"{name}-{page}.png"), parent, frame)
        results["cut"] += [f"{name} ({page}): {text}" for text in texts_cut(frame or parent)]
        results["width"] = max(results["width"], panel().width())
    if frame and button:
        button.click()
    return found


def photograph_panel(name, proxy, results):
    """The panel of what was executed, to be yielded from."""
    simple.SetActiveSource(proxy)
    yield from until(lambda: find("ProxyPanel", parent=panel()), "the panel of " + name)
    proxy.UpdatePipeline()
    results["panels"][name] = yield from pages(panel(), name, results)


def panels(results):
    """Every source, reader and filter; some also with values that show or enable other properties."""
    pipeline = Pipeline()
    for group in ("sources", "filters"):
        for name in names_of(group):
            proxy = pipeline.make(name, group == "sources")
            yield from photograph_panel(name, proxy, results)
            if name in VARIANTS:
                variant, values = VARIANTS[name]
                for prop, value in values.items():
                    setattr(proxy, prop, value)
                yield from photograph_panel(name + variant, proxy, results)
            simple.Delete(proxy)
    simple.SetActiveSource(pipeline.echoes)


def file_types(dialog):
    box = find("EntityType", QtWidgets.QComboBox, dialog)
    return [box.itemText(i) for i in range(box.count())]


def dialog_of(action, name):
    """Opens a dialog by an action of the menus, to be yielded from."""
    later(find(action, QAction).trigger)
    return (yield from until(lambda: find(name), name))


def open_dialog(results):
    dialog = yield from dialog_of("actionFileOpen", "FileOpenDialog")
    yield 0.3
    results["open"] = file_types(dialog)
    photo(os.path.join(FOLDER, "File-Open.png"), dialog)
    dialog.reject()
    yield 0.3


def save_dialogs(results):
    for extension, name in WRITERS.items():
        dialog = yield from dialog_of("actionFileSaveData", "FileSaveDialog")
        yield 0.3
        results["save"] = file_types(dialog)
        box = find("EntityType", QtWidgets.QComboBox, dialog)
        box.setCurrentIndex(next(i for i, text in enumerate(results["save"]) if f"*.{extension} " in text))
        yield 0.1
        if extension == "las":
            photo(os.path.join(FOLDER, "File-SaveData.png"), dialog)
        find("EntityName", QtWidgets.QLineEdit, dialog).setText(os.path.join(FOLDER, "echoes." + extension))
        later(find("OK", parent=dialog).click)
        options = yield from until(lambda: find("WriterSettingsDialog"), "options of ." + extension)
        results["writers"][name] = yield from pages(options, "SaveData-" + name, results)
        options.reject()
        yield 0.3


def samples():
    """Widgets each of whose texts has not enough room: texts_cut() finds them all."""
    parent = QtWidgets.QWidget()
    widgets = [QtWidgets.QLabel(TEXT, parent), QtWidgets.QLineEdit(TEXT, parent), QtWidgets.QComboBox(parent)]
    widgets += [QtWidgets.QCheckBox(TEXT, parent), QtWidgets.QLabel(f"<p>{TEXT} {TEXT}</p>", parent)]
    widgets[2].addItems(["short", TEXT])
    widgets[4].setWordWrap(True)
    for widget in widgets:
        widget.setFixedSize(60, 20)
    parent.show()
    return parent


def steps(results):
    results.update(panels={}, writers={}, cut=[], width=0)
    sample = samples()
    yield 0.2
    results["samples"] = texts_cut(sample)
    sample.hide()
    find("pipelineBrowserDock").hide()  # leaves its height to the panel
    yield from panels(results)
    yield from open_dialog(results)
    yield from save_dialogs(results)


client_window.run(steps)
