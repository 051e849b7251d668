# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestLive.py: with Auto Apply, values of an Airport32 scan are changed in the panel, key by
key, as a user does who wants to see each step.

The results: {"changes": {name: {"steps": number, "executions": of the echo filter, "frames": drawn, "rays": traced,
"differences": [arrays that differ from a new scan's], "preset", "wall", "main", "cpu", "filter", "drawing": [seconds of each
step, of the clock, of the main thread, of all threads, in the echo filter, in the view]}},
"drag": [applied while a mouse button was down, applied when it was released], "first_rays": {preset: number},
"scripted": {"update", "render": [seconds of each step by a script]}}"""

import os
import time

import client_window
from client_qt import QAction, QtCore, QtGui, QtTest, QtWidgets
import numpy
from client_window import find, later, main_window, panel, until
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
STEPS = int(os.environ["AVIANLIDAR_STEPS"])
SAMPLES = os.environ["AVIANLIDAR_SAMPLES"]
# What may depend on what is known from before (Documentation/model-needs.md).
COSTS = ("candidates", "nodes_visited", "rays_traced", "skipped", "skipped_bound")


class Scan:
    """The pipeline in a view of its own, and clocks at the echo filter and the view."""

    def __init__(self):
        scene = simple.OpenDataFile(SCENE)
        self.material = simple.AvianLidarMaterial(Input=scene, Material="Custom", BlockNamePattern="*Terminal*")
        self.tree = simple.AvianLidarCollisionTree(Input=self.material)
        self.beams = simple.AvianLidarAirport32(Position=[0, 0, 3])
        self.echoes = simple.AvianLidarEchoFilter(Beams=self.beams, Surfaces=self.tree, BeamSamples=SAMPLES)
        view = simple.GetActiveViewOrCreate("RenderView")
        simple.Show(self.tree, view)
        simple.ColorBy(simple.Show(self.echoes, view), ("POINTS", "energy"))
        simple.Render(view)
        self.filter = Clock(self.echoes.GetClientSideObject())
        self.view = Clock(view.SMProxy.GetRenderWindow())
        self.frames = 0  # when the filter last was done
        self.echoes.GetClientSideObject().AddObserver("EndEvent", self.made)

    def made(self, *_):
        self.frames = self.view.count

    def drawn(self, executions):
        """Whether the filter has executed more often than that, and what it made has been drawn."""
        return self.filter.count > executions and self.view.count > self.frames

    def rays(self):
        self.echoes.UpdatePipelineInformation()
        return self.echoes.NumberOfTracedRays

    def differences(self):
        """What differs, bit for bit, from a scan by a new filter."""
        fresh = simple.AvianLidarEchoFilter(Beams=self.beams, Surfaces=self.tree)
        for name in ("AttenuationCoefficient", "BeamSamples", "Noise", "Preset", "ReturnMode"):
            setattr(fresh, name, self.echoes.GetPropertyValue(name))
        found = []
        for port in (0, 1):
            one, other = (servermanager.Fetch(scan, idx=port) for scan in (self.echoes, fresh))
            found += [name for name in names_of(one, other) if values_of(one, name) != values_of(other, name)]
        simple.Delete(fresh)
        return found


class Clock:
    """Counts what a VTK object does between its StartEvent and EndEvent, and for how long."""

    def __init__(self, subject):
        self.count, self.seconds, self.start = 0, 0.0, None
        subject.AddObserver("StartEvent", self.begin)
        subject.AddObserver("EndEvent", self.end)

    def begin(self, *_):
        self.start = time.perf_counter()

    def end(self, *_):
        if self.start is not None:
            self.count, self.seconds, self.start = self.count + 1, self.seconds + time.perf_counter() - self.start, None


def names_of(*datasets):
    data = [dataset.GetPointData() for dataset in datasets]
    return sorted({each.GetArrayName(i) for each in data for i in range(each.GetNumberOfArrays())} - set(COSTS))


def values_of(dataset, name):
    array = dataset.GetPointData().GetArray(name)
    return array and numpy.ascontiguousarray(vtk_to_numpy(array)).tobytes()


def widget(prop, name, kind=QtWidgets.QWidget):
    """A widget inside that of a property in the panel. A key to none would end ParaView."""
    found = find(name, kind, find(prop, parent=panel()))
    assert found, f"{prop} has no {name}"
    return found


def key(prop, name, *codes):
    """One key after the other, over and over."""
    return lambda step: QtTest.QTest.keyClick(widget(prop, name), codes[step % len(codes)])


def choose(prop, count):
    return lambda step: widget(prop, "ComboBox", QtWidgets.QComboBox).setCurrentIndex((step + 1) % count)


def type_in(prop, value):
    return lambda step: client_window.type_in(prop, f"{value(step):.6g}")


def changes(scan):
    """(name, preset, proxy whose panel is open, property, what changes a value)."""
    right, left, space = QtCore.Qt.Key.Key_Right, QtCore.Qt.Key.Key_Left, QtCore.Qt.Key.Key_Space
    air, lower, upper = "AttenuationCoefficient", "LowerEnergyLimit", "UpperEnergyLimit"
    clearest = 3.4e-5 * 0.95 ** (STEPS - 1)
    clearer = type_in(air, lambda step: 3.4e-5 * 0.95**step)
    hazier = type_in(air, lambda step: clearest * 1.05 ** (step + 1))
    return (
        ("Attenuation Coefficient, up", "Custom", scan.echoes, air, key(air, "Slider", right)),
        ("Attenuation Coefficient, down", "Custom", scan.echoes, air, clearer),
        ("Kd", "Custom", scan.material, "Kd", key("Kd", "Slider", left, right)),
        ("Ks", "Custom", scan.material, "Ks", key("Ks", "Slider", left, right)),
        ("Kp", "Custom", scan.material, "Kp", key("Kp", "Slider", right, left)),
        ("Lower Energy Limit, up", "Custom", scan.beams, lower, type_in(lower, lambda step: 2.1e-6 + 1e-7 * step)),
        ("Lower Energy Limit, down", "Custom", scan.beams, lower, type_in(lower, lambda step: 1.9e-6 * 0.95**step)),
        ("Upper Energy Limit", "Custom", scan.beams, upper, type_in(upper, lambda step: 6.2e-5 - 1e-7 * step)),
        ("Noise", "Custom", scan.echoes, "Noise", key("Noise", "CheckBox", space)),
        ("Return Mode", "Custom", scan.echoes, "ReturnMode", choose("ReturnMode", 5)),
        ("Attenuation Coefficient, preset Standard", "Standard", scan.echoes, air, hazier),
    )


def measure(scan, change):
    """Each step from the key to the end of its frame, to be yielded from."""
    found = {"wall": [], "main": [], "cpu": [], "filter": [], "drawing": [], "rays": 0}
    executions, frames = scan.filter.count, scan.view.count
    for step in range(STEPS):
        before = [clock.seconds for clock in (scan.filter, scan.view)]
        executed, start = scan.filter.count, time.perf_counter()
        cpu, main = time.process_time(), time.thread_time()
        later(lambda step=step: change(step))
        yield from until(lambda executed=executed: scan.drawn(executed), "a frame", 30)
        found["wall"].append(time.perf_counter() - start)
        found["cpu"].append(time.process_time() - cpu)
        found["main"].append(time.thread_time() - main)
        for name, clock, old in zip(("filter", "drawing"), (scan.filter, scan.view), before):
            found[name].append(clock.seconds - old)
        found["rays"] += scan.rays()
    found.update(steps=STEPS, executions=scan.filter.count - executions, frames=scan.view.count - frames)
    return found


def scripted(scan):
    """Seconds of each step as a script makes it: the filter alone, and with drawing."""
    found = {"update": [], "render": []}
    values = iter(numpy.linspace(4e-5, 9e-5, 2 * STEPS))
    for name, work in (("update", scan.echoes.UpdatePipeline), ("render", simple.Render)):
        for _ in range(STEPS):
            start = time.perf_counter()
            scan.echoes.AttenuationCoefficient = next(values)
            work()
            found[name].append(time.perf_counter() - start)
    return found


def mouse(slider, kind, x):
    left, none = QtCore.Qt.MouseButton.LeftButton, QtCore.Qt.MouseButton.NoButton
    pressed = none if kind == QtCore.QEvent.Type.MouseButtonRelease else left
    button = none if kind == QtCore.QEvent.Type.MouseMove else left
    place = QtCore.QPointF(x, slider.height() / 2)
    screen = QtCore.QPointF(slider.mapToGlobal(place.toPoint()))
    keys = QtCore.Qt.KeyboardModifier.NoModifier
    client_window.app.sendEvent(slider, QtGui.QMouseEvent(kind, place, screen, button, pressed, keys))


def handle_of(slider):
    """Where the mouse takes a horizontal slider."""
    option = QtWidgets.QStyleOptionSlider()
    option.initFrom(slider)
    option.minimum, option.maximum = slider.minimum(), slider.maximum()
    option.sliderPosition = option.sliderValue = slider.value()
    style = QtWidgets.QStyle
    return slider.style().subControlRect(style.ComplexControl.CC_Slider, option, style.SubControl.SC_SliderHandle, slider).center().x()


def drag(scan):
    """How often a value is applied while its slider is dragged, and at the end; to be yielded from."""
    simple.SetActiveSource(scan.echoes)
    yield from until(lambda: find("AttenuationCoefficient", parent=panel()), "the panel")
    slider = widget("AttenuationCoefficient", "Slider")
    yield 1
    count = scan.filter.count
    handle = handle_of(slider)
    mouse(slider, QtCore.QEvent.Type.MouseButtonPress, handle)
    for i in range(1, 6):
        mouse(slider, QtCore.QEvent.Type.MouseMove, handle + 2 * i)
        yield 0.2
    moving = scan.filter.count - count
    mouse(slider, QtCore.QEvent.Type.MouseButtonRelease, handle + 10)
    yield from until(lambda: scan.filter.count > count + moving, "what Auto Apply does")
    return [moving, scan.filter.count - count - moving]


def steps(results):
    scan = Scan()
    results["first_rays"] = {"Custom": scan.rays()}
    results["scripted"] = scripted(scan)
    find("actionAutoApply", QAction, main_window()).trigger()
    results["changes"] = {}
    for name, preset, proxy, prop, change in changes(scan):
        if scan.echoes.Preset != preset:
            scan.echoes.Preset = preset
            simple.Render()
            results["first_rays"][preset] = scan.rays()
        simple.SetActiveSource(proxy)
        yield from until(lambda prop=prop: find(prop, parent=panel()), "the panel with " + prop)
        results["changes"][name] = found = yield from measure(scan, change)
        found.update(differences=scan.differences(), preset=preset)
    results["drag"] = yield from drag(scan)


client_window.run(steps)
