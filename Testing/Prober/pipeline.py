# SPDX-License-Identifier: BSD-3-Clause
"""The chain that is probed: sensor, material, tree, echoes and what follows them, connected one way or another."""

import random

import vtk

from avianlidar import vtkAvianLidar as al
from contents import contents
from echotools import COSTS
from scenes import place, polydata

# What the classes say may be another number in a filter that has run before: costs, and what is known of the energy
# that was skipped, which is less where more has been traced.
MAY_DIFFER = {
    "echoes": (),
    "report": (*COSTS, "skipped", "skipped_bound"),
    "image": (*COSTS, "skipped", "skipped_bound"),
}

ALGORITHMS = {
    "sensor": al.vtkAvianLidarBeamSource,
    "material": al.vtkAvianLidarMaterial,
    "tree": al.vtkAvianLidarCollisionTree,
    "echo": al.vtkAvianLidarEchoFilter,
    "colour": al.vtkAvianLidarHSBColorMap,
    "image": al.vtkAvianLidarRangeImage,
    "comparison": al.vtkAvianLidarCloudComparison,
}

# What is looked at: {name: (algorithm, output port)}.
SINKS = {
    "echoes": ("echo", 0),
    "report": ("echo", 1),
    "tree": ("tree", 0),
    "boxes": ("tree", 1),
    "colour": ("colour", 0),
    "image": ("image", 0),
    "comparison": ("comparison", 0),
}


class Route:
    """How the chain is connected."""

    def __init__(self):
        self.material = False  # surfaces go through the material filter
        self.tree = False  # and through the tree
        self.copies = None  # "deep", "shallow": what reaches the echo filter is a copy
        self.table = False  # beams are a table in place of the source
        self.size = (0, 0)  # columns and rows of the table
        self.image_of_report = False


class Result:
    """What an update brought."""

    def __init__(self, errors, by_sink, executed, found):
        self.errors = errors
        self.by_sink = by_sink  # errors of the sink's own
        self.executed = executed
        self.found = found


class Pipeline:
    def __init__(self, settings):
        self.algorithms = {name: kind() for name, kind in ALGORITHMS.items()}
        self.heard = []  # (algorithm, text)
        self.executions = dict.fromkeys(self.algorithms, 0)
        self.failed = set()  # those whose last execution was an error
        for name, algorithm in self.algorithms.items():
            self._listen(name, algorithm)
        for (name, key), value in settings.items():
            self.set(name, key, value)
        self.between = None
        self.upstream = None
        self.copies = None
        self.reference = polydata([place(random.Random(i)) for i in range(20)], [])

    def _listen(self, name, algorithm):
        def error(_, __, text):
            self.heard.append((name, text.split("): ", 1)[-1].strip()))
            self.failed.add(name)

        def start(*_):
            self.executions[name] += 1
            self.failed.discard(name)

        error.CallDataType = vtk.VTK_STRING
        algorithm.AddObserver("ErrorEvent", error)
        algorithm.AddObserver("StartEvent", start)
        algorithm.AddObserver("WarningEvent", lambda *_: None)
        algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)

    def set(self, name, key, value):
        algorithm = self.algorithms[name]
        if key == "ChannelElevations":
            algorithm.SetNumberOfChannelElevations(len(value))
            for i, elevation in enumerate(value):
                algorithm.SetChannelElevation(i, elevation)
        elif isinstance(value, (list, tuple)):
            getattr(algorithm, "Set" + key)(*value)
        else:
            getattr(algorithm, "Set" + key)(value)

    def connect(self, data, table, route):
        a = self.algorithms
        a["material"].SetInputDataObject(0, data)
        self.upstream = a["material"] if route.material else None
        self._give("tree", 0, data if self.upstream is None else self.upstream)
        if route.tree:
            self.upstream = a["tree"]
        surfaces = data if self.upstream is None else self.upstream
        self.copies = route.copies
        if route.copies:
            self.source = surfaces
            self.between = vtk.vtkPolyData() if route.tree else data.NewInstance()
            surfaces = self.between
        self._give("echo", 0, table if route.table else a["sensor"])
        self._give("echo", 1, surfaces)
        a["colour"].SetInputConnection(a["echo"].GetOutputPort())
        a["image"].SetInputConnection(0, a["echo"].GetOutputPort())
        a["image"].SetColumns(route.size[0] if route.table else 0)
        a["image"].SetRows(route.size[1] if route.table else 0)
        if route.image_of_report:
            a["image"].SetInputConnection(1, a["echo"].GetOutputPort(1))
        else:
            self._give("image", 1, table if route.table else a["sensor"])
        a["comparison"].SetInputConnection(0, a["echo"].GetOutputPort())
        a["comparison"].SetInputDataObject(1, self.reference)

    def _give(self, name, port, what):
        if what.IsA("vtkAlgorithm"):
            self.algorithms[name].SetInputConnection(port, what.GetOutputPort())
        else:
            self.algorithms[name].SetInputDataObject(port, what)

    def _copy(self):
        """The copy that stands between, made anew of what is before it now; false if that has failed."""
        data = self.source
        if data.IsA("vtkAlgorithm"):
            said = len(self.heard)
            data.Update()
            if len(self.heard) == said and self.failed & {"material", "tree"}:
                self.heard.append(("copy", "there is nothing to copy"))  # VTK does not execute again what has failed
            if len(self.heard) > said:
                return False
            data = data.GetOutputDataObject(0)
        if self.copies == "shallow":
            self.between.ShallowCopy(data)
        else:
            self.between.DeepCopy(data)
        self.between.Modified()
        return True

    def update(self, sink, moment):
        """Bring a sink up to date for (piece, pieces, time)."""
        name, port = SINKS[sink]
        algorithm = self.algorithms[name]
        self.heard.clear()
        before = self.executions[name]
        if not (self.copies and name not in ("tree", "material") and not self._copy()):
            piece, pieces, time = moment
            if name in ("comparison", "image", "tree"):
                piece, pieces = 0, 1
            if time is None:
                algorithm.UpdatePiece(piece, pieces, 0)
            else:
                algorithm.UpdateTimeStep(time, piece, pieces, 0)
        executed = self.executions[name] > before
        found = contents(algorithm.GetOutputDataObject(port), MAY_DIFFER.get(sink, ()))
        own = [text for who, text in self.heard if who == name]
        return Result([text for _, text in self.heard], own, executed, found)
