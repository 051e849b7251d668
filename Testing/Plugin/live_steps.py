# SPDX-License-Identifier: BSD-3-Clause
"""Live changes in ParaView's window: with Auto Apply each step of a value in the panel lights the scan anew and draws
it, tracing nothing that is known; the echoes are those of a new scan, bit for bit. Testing/Studies/speed/live.py runs
this file to measure."""

import os
import time

import numpy
from client_qt import QtCore, QtTest, QtWidgets
from client_window import AIRPORT, action, delete_all, find, later, panel, panel_of, results, run, type_in, until
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

# What may depend on what is known from before (Documentation/guide/accuracy.md).
COSTS = ("candidates", "nodes_visited", "rays_traced", "skipped", "skipped_bound")
WEAK = 1e-5  # share of the first scan's rays that a step may trace: some weak paths were left out before


class Scan:
    """The airport's pipeline in a view, and clocks at the echo filter and the view."""

    def __init__(self, **beams):
        scene = simple.OpenDataFile(AIRPORT)
        self.material = simple.AvianLidarMaterial(Input=scene, Material="Custom", BlockNamePattern="*Terminal*")
        tree = simple.AvianLidarCollisionTree(Input=self.material)
        self.beams = simple.AvianLidarAirport32(Position=[0, 0, 3], **beams)
        # Integrated beams have no rays to keep.
        self.settings = {"Beams": self.beams, "Surfaces": tree, "BeamSamples": "Rays" if beams else "Cells"}
        self.echoes = simple.AvianLidarEchoFilter(**self.settings)
        view = simple.GetActiveViewOrCreate("RenderView")
        simple.Show(tree, view)
        simple.ColorBy(simple.Show(self.echoes, view), ("POINTS", "energy"))
        simple.Render(view)
        self.filter, self.view = Clock(self.echoes.GetClientSideObject()), Clock(view.SMProxy.GetRenderWindow())
        self.frames = 0  # when the filter last was done
        self.echoes.GetClientSideObject().AddObserver("EndEvent", self.made)

    def made(self, *_):
        self.frames = self.view.count

    def rays(self):
        self.echoes.UpdatePipelineInformation()
        return self.echoes.NumberOfTracedRays

    def differences(self):
        """What differs, bit for bit, from a scan by a new filter."""
        fresh = simple.AvianLidarEchoFilter(**self.settings)
        for name in ("AttenuationCoefficient", "Noise", "Preset", "ReturnMode"):
            setattr(fresh, name, self.echoes.GetPropertyValue(name))
        found = []
        for port in (0, 1):
            one, other = (bytes_of(servermanager.Fetch(scan, idx=port).GetPointData()) for scan in (self.echoes, fresh))
            found += [name for name in {*one, *other} if one.get(name) != other.get(name)]
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


def bytes_of(data):
    arrays = {data.GetArrayName(i): data.GetArray(i) for i in range(data.GetNumberOfArrays())}
    return {name: vtk_to_numpy(array).tobytes() for name, array in arrays.items() if name not in COSTS}


def widget(prop, name, kind=QtWidgets.QWidget):
    """A widget inside that of a property in the panel. A key to none would end ParaView."""
    found = find(name, kind, find(prop, parent=panel()))
    assert found, f"{prop} has no {name}"
    return found


def key(prop, name, *codes):
    """One key after the other, over and over."""
    return lambda step: QtTest.QTest.keyClick(widget(prop, name), codes[step % len(codes)])


def typed(prop, value):
    return lambda step: type_in(prop, f"{value(step):.6g}")


def changes(scan, count):
    """(name, preset, proxy whose panel is open, property, what changes a value) of so many steps."""
    right, left, space = QtCore.Qt.Key.Key_Right, QtCore.Qt.Key.Key_Left, QtCore.Qt.Key.Key_Space
    air, lower, upper, modes = "AttenuationCoefficient", "LowerEnergyLimit", "UpperEnergyLimit", "ReturnMode"
    clearest = 3.4e-5 * 0.95 ** (count - 1)
    return (
        ("Attenuation Coefficient, up", "Custom", scan.echoes, air, key(air, "Slider", right)),
        ("Attenuation Coefficient, down", "Custom", scan.echoes, air, typed(air, lambda step: 3.4e-5 * 0.95**step)),
        ("Kd", "Custom", scan.material, "Kd", key("Kd", "Slider", left, right)),
        ("Ks", "Custom", scan.material, "Ks", key("Ks", "Slider", left, right)),
        ("Kp", "Custom", scan.material, "Kp", key("Kp", "Slider", right, left)),
        ("Lower Energy Limit, up", "Custom", scan.beams, lower, typed(lower, lambda step: 2.1e-6 + 1e-7 * step)),
        ("Lower Energy Limit, down", "Custom", scan.beams, lower, typed(lower, lambda step: 1.9e-6 * 0.95**step)),
        ("Upper Energy Limit", "Custom", scan.beams, upper, typed(upper, lambda step: 6.2e-5 - 1e-7 * step)),
        ("Noise", "Custom", scan.echoes, "Noise", key("Noise", "CheckBox", space)),
        ("Return Mode", "Custom", scan.echoes, modes,
         lambda step: widget(modes, "ComboBox", QtWidgets.QComboBox).setCurrentIndex((step + 1) % 5)),
        ("Attenuation Coefficient, preset Standard", "Standard", scan.echoes, air,
         typed(air, lambda step: clearest * 1.05 ** (step + 1))),
    )


def measure(scan, change, count):
    """Each step from the key to the end of its frame, to be yielded from: seconds of the clock, the main thread, the
    filter and the view."""
    found = {"wall": [], "main": [], "filter": [], "drawing": [], "rays": 0}
    executions = scan.filter.count
    for step in range(count):
        clocks = (scan.filter, scan.view)
        before, executed = [clock.seconds for clock in clocks], scan.filter.count
        start, main = time.perf_counter(), time.thread_time()
        later(lambda step=step: change(step))
        # Done, and what it made is drawn.
        yield from until(lambda old=executed: scan.filter.count > old and scan.view.count > scan.frames, "a frame", 30)
        for name, seconds in (("wall", time.perf_counter() - start), ("main", time.thread_time() - main),
                              *zip(("filter", "drawing"), (clock.seconds - old for clock, old in zip(clocks, before)))):
            found[name].append(seconds)
        found["rays"] += scan.rays()
    assert scan.filter.count - executions == count, (scan.filter.count, executions, count)
    return found


def follow(scan, count, names=None):
    """The changes of these names; to be yielded from."""
    first = {}
    action("actionAutoApply").trigger()
    results["changes"], results["first"] = {}, first
    for name, preset, proxy, prop, change in changes(scan, count):
        if names and name not in names:
            continue
        if scan.echoes.Preset != preset or preset not in first:
            scan.echoes.Preset = preset
            simple.Render()
            first[preset] = scan.rays()
        yield from panel_of(proxy, prop)
        results["changes"][name] = found = yield from measure(scan, change, count)
        differences = scan.differences()
        assert not differences, (name, differences)
        assert not names or found["rays"] / count <= WEAK * first[preset], (name, found, first)


def live():
    """Two steps of a slider and of a number, of three objects, on a few beams."""
    yield from delete_all()
    names = ("Attenuation Coefficient, up", "Kd", "Lower Energy Limit, up")
    yield from follow(Scan(AzimuthStep=6), 2, names)


def benchmark():
    """As many steps as AVIANLIDAR_STEPS says; before them as many by a script, with and without drawing."""
    scan, count = Scan(), int(os.environ["AVIANLIDAR_STEPS"])
    values = iter(numpy.linspace(4e-5, 9e-5, 2 * count))
    results["scripted"] = {"update": [], "render": []}
    for name, work in (("update", scan.echoes.UpdatePipeline), ("render", simple.Render)):
        for _ in range(count):
            start = time.perf_counter()
            scan.echoes.AttenuationCoefficient = next(values)
            work()
            results["scripted"][name].append(time.perf_counter() - start)
    yield from follow(scan, count)


if __name__ == "__main__":
    run(benchmark)
