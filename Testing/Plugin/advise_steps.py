# SPDX-License-Identifier: BSD-3-Clause
"""Run in ParaView's window by TestAdvise.py, alone or connected to a pvserver: Advise is pressed for a sphere, applied,
and pressed with a value that is wrong.

The results: "before", "advised", "applied": {"applied": {property: value}, "shown": the same as the panel has it, "combo": the text of
Preset's widget, "accept": may Apply be pressed}, "answer" and "answer_tip" beside the button, "errors" said after a wrong value,
"answer_of_error", "sources" in the pipeline, "server": number of its processes. A photo of the panel is advise.png."""

import os

import client_window
from client_qt import QtWidgets
from client_window import FOLDER, Messages, apply, apply_button, find, later, panel, type_in, until
from paraview import servermanager, simple

NAMES = ("Preset", "BeamSamples", "RaysPerBeam", "Sampling", "NumberOfReflections", "NumberOfConnections")


def look(echoes):
    proxy = echoes.SMProxy
    combo = find("Preset", parent=panel()).findChild(QtWidgets.QComboBox)
    return {
        "applied": {name: proxy.GetProperty(name).GetElement(0) for name in NAMES},
        "shown": {name: proxy.GetProperty(name).GetUncheckedElement(0) for name in NAMES},
        "combo": combo.currentText(),
        "accept": apply_button().isEnabled(),
    }


def answer():
    return find("AdviseAnswer", QtWidgets.QLabel, panel())


def press():
    """Presses Advise and waits for the answer, to be yielded from."""
    button = find("Advise", QtWidgets.QAbstractButton, panel())
    done = []
    later(lambda: (button.click(), done.append(1)))
    yield from until(lambda: done, "the answer", 150)
    yield 0.3


def steps(results):
    results["server"] = servermanager.ActiveConnection.GetNumberOfDataPartitions()
    sphere = simple.Sphere(Center=[0, 60, 0], Radius=20, ThetaResolution=32, PhiResolution=32)
    sensor = simple.AvianLidarBeamSource(AzimuthStep=0.5)
    echoes = simple.AvianLidarEchoFilter(Beams=sensor, Surfaces=sphere, Preset="Standard")
    echoes.UpdatePipeline()
    simple.Show(echoes, simple.GetActiveViewOrCreate("RenderView"))
    simple.SetActiveSource(echoes)
    messages = Messages()
    yield from until(lambda: find("Advise", QtWidgets.QAbstractButton, panel()), "the button")
    yield 0.5
    results["before"] = look(echoes)
    yield from press()
    results["advised"] = look(echoes)
    results["answer"], results["answer_tip"] = answer().text(), answer().toolTip()
    panel().grab().save(os.path.join(FOLDER, "advise.png"))
    yield from apply()
    results["applied"] = look(echoes)
    messages.take()
    type_in("AttenuationCoefficient", "-1")
    yield 0.3
    yield from press()
    results["errors"] = messages.take()
    results["answer_of_error"] = answer().text()
    results["sources"] = len(simple.GetSources())


client_window.run(steps)
