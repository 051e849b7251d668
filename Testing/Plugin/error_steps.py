# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestErrors.py, alone or connected to a pvserver: things are made to fail and are mended again,
as a user does it: by the panel with Apply, and by a file with F5.

The results: {"server": number of its processes, "cases": {name: [what there is to see at first, after the error, mended,
after the second error, mended again]}, "files": {name: [the same of a file: may one choose Save Data, is it what it was]},
"applies": may Apply be pressed for what was only made}.
What there is to see: {"errors": [the sources that have said something new], "shown": {name: points and cells that its
representation has}, "information": {name: [points and cells, error]}, "picture": checksum of the view}."""

import json
import os
import zlib

import client_window
from client_qt import QAction
from client_window import FOLDER, Messages, apply, apply_button, find, later, main_window, panel, type_in, until
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject

SCENE = os.path.join(FOLDER, "errors.lidarscene.json")
GOOD, OTHER = 120, 30  # the width of the ground, metres
FORMATS = {1: ("vtp", "csv", "las", "pcd"), 2: ("csv", "las", "pcd")}  # by the number of the server's processes
NAMES = ("Scene", "Material", "Tree", "Sensor", "Echoes", "Colours", "Image")


def write_scene(width):
    """A ground; without a width a file that is none."""
    if width is None:
        text = '{"version": 1, "objects": ['
    else:
        ground = {"ground": {"size": width, "height": -1}, "material": "wall", "name": "ground"}
        text = json.dumps({"version": 1, "objects": [ground]})
    with open(SCENE, "w", encoding="utf-8") as file:
        file.write(text)


class Pipeline:
    def __init__(self):
        self.scene = simple.OpenDataFile(SCENE)
        self.material = simple.AvianLidarMaterial(Input=self.scene, Material="Custom")
        self.tree = simple.AvianLidarCollisionTree(Input=self.material)
        self.sensor = simple.AvianLidarBeamSource(
            Position=[0, 0, 3], AzimuthStep=2, MinimumElevation=-30, ElevationStep=1.5
        )
        self.echoes = simple.AvianLidarEchoFilter(Beams=self.sensor, Surfaces=self.tree)
        self.colours = simple.AvianLidarHSBColorMap(Input=self.echoes)
        self.image = simple.AvianLidarRangeImage(Echoes=self.echoes, Beams=self.sensor)
        self.all = (self.scene, self.material, self.tree, self.sensor, self.echoes, self.colours, self.image)
        self.view = simple.GetActiveViewOrCreate("RenderView")
        for name, proxy in zip(NAMES, self.all):
            simple.RenameSource(name, proxy)
            simple.Show(proxy, self.view)
        simple.ResetCamera(self.view)
        simple.Render(self.view)
        self.messages = Messages()

    def look(self):
        found = {"errors": self.messages.take(), "shown": {}, "information": {}}
        for name, proxy in zip(NAMES, self.all):
            information = proxy.GetDataInformation(0).DataInformation
            error = information.GetArrayInformation("error", vtkDataObject.FIELD)
            found["information"][name] = [elements(information), bool(error)]
            representation = simple.GetRepresentation(proxy, self.view).SMProxy
            found["shown"][name] = elements(representation.GetRepresentedDataInformation())
        picture = self.view.SMProxy.CaptureWindow(1)
        found["picture"] = zlib.crc32(vtk_to_numpy(picture.GetPointData().GetScalars()).tobytes())
        picture.UnRegister(None)
        return found


def elements(information):
    return information.GetNumberOfPoints() + information.GetNumberOfCells()


def by_panel(proxy, prop, values):
    """Types a value into the panel, and applies it; a generator for each step."""

    def change(step):
        simple.SetActiveSource(proxy)
        yield from until(lambda: find(prop, parent=panel()), "the panel with " + prop)
        yield 0.1
        type_in(prop, f"{values[step]:.6g}")
        yield from apply()

    return change


def by_file(widths):
    def change(step):
        write_scene(widths[step])
        simple.SetActiveSource(simple.FindSource("Scene"))
        yield 0.1
        later(find("actionReloadFiles", QAction, main_window()).trigger)
        yield 0.7

    return change


def case(pipeline, change, steps):
    """What there is to see at first and after each step; to be yielded from."""
    pipeline.messages.take()
    found = [pipeline.look()]
    for step in range(steps):
        yield from change(step)
        found.append(pipeline.look())
    return found


def can_save(proxy):
    simple.SetActiveSource(proxy)
    return find("actionFileSaveData", QAction, main_window()).isEnabled()


def file_of(name):
    with open(name, "rb") as file:
        return file.read()


def save(pipeline, fail):
    """Save Data of good data, of what failed, and of good data again; to be yielded from."""
    found, contents = {}, {}
    # Filters behind the echoes, which may lose the error.
    sphere = simple.Sphere()
    behind = [simple.PassArrays(Input=pipeline.echoes), simple.AppendDatasets(Input=[sphere, pipeline.echoes])]
    for proxy in behind:
        proxy.UpdatePipeline()
    for step in range(3):
        if step:
            yield from fail(step - 1)
        for proxy in behind:
            proxy.UpdatePipeline()
            found.setdefault("behind", []).append(can_save(proxy))
        for name in FORMATS[servermanager.ActiveConnection.GetNumberOfDataPartitions()]:
            file_name = os.path.join(FOLDER, "echoes." + name)
            allowed = can_save(pipeline.echoes)
            yield 0.05
            # ParaView's own writers are kept from it by the window alone, ours by themselves.
            if allowed or name not in ("vtp", "csv"):
                save_data(pipeline.echoes, file_name)
            content = file_of(file_name)
            found.setdefault(name, []).append([allowed, contents.setdefault(name, content) == content, len(content)])
    for proxy in (*behind, sphere):
        simple.Delete(proxy)
    return found


def save_data(proxy, file_name):
    options = {"las": {"CoordinateSystem": "Local"}, "vtp": {"DataMode": "Binary"}}.get(file_name[-3:], {})
    simple.SaveData(file_name, proxy=proxy, **options)


def steps(results):
    results["server"] = servermanager.ActiveConnection.GetNumberOfDataPartitions()
    write_scene(GOOD)
    pipeline = Pipeline()
    yield 0.5
    results["applies"] = apply_button().isEnabled()
    results["cases"] = cases = {}
    air = by_panel(pipeline.echoes, "AttenuationCoefficient", (-1, 0.05, -2, 0.01))
    cases["Echoes"] = yield from case(pipeline, air, 4)
    kd = by_panel(pipeline.material, "Kd", (-1, 0.05, -2, 0.5))
    cases["Material"] = yield from case(pipeline, kd, 4)
    energy = by_panel(pipeline.sensor, "PulseEnergy", (-1, 5e-5, -2, 3.6e-4))
    cases["Sensor"] = yield from case(pipeline, energy, 4)
    cases["Scene"] = yield from case(pipeline, by_file((None, OTHER, None, GOOD)), 4)
    results["files"] = yield from save(pipeline, by_panel(pipeline.echoes, "AttenuationCoefficient", (-1, 0.02)))


client_window.run(steps)
