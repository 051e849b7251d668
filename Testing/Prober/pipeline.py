# SPDX-License-Identifier: BSD-3-Clause
"""The pipeline that is probed: all filters whose output follows from inputs and settings alone, connected one way or
another. What can be set, and between which values, is read from the panels (Plugin/*.xml)."""

import glob
import os
import sys

import vtk

from avianlidar import vtkAvianLidar as al
from data import contents, polydata

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.append(os.path.join(SOURCE, "Plugin"))
import make_proxies
# What the classes say may be another number in a filter that has run before: costs, and what is known of skipped
# energy, of which there is less where more has been traced. Threads change nothing, and are not the same here.
MAY_DIFFER = ("candidates", "nodes_visited", "rays_traced", "skipped", "skipped_bound")
ALGORITHMS = {
    "sensor": al.vtkAvianLidarBeamSource, "material": al.vtkAvianLidarMaterial, "medium": al.vtkAvianLidarMedium,
    "bird": al.vtkAvianLidarBirdSource, "tracks": al.vtkAvianLidarTracks, "group": vtk.vtkMultiBlockDataGroupFilter,
    "tree": al.vtkAvianLidarCollisionTree, "echo": al.vtkAvianLidarEchoFilter, "view": al.vtkAvianLidarBeamView,
    "coverage": al.vtkAvianLidarCoverage, "colour": al.vtkAvianLidarHSBColorMap, "image": al.vtkAvianLidarRangeImage,
    "comparison": al.vtkAvianLidarCloudComparison, "geodetic": al.vtkAvianLidarGeodeticTransform,
    "units": al.vtkAvianLidarUnitNames}
WHOLE = ("comparison", "image", "tree", "coverage", "view", "tracks")  # there are no pieces of these
# Other values than around the default: small scans of what stands near, and scenes in which a setting counts.
VALUES = {
    "AzimuthStep": (7.0, 10.0, 20.0), "NumberOfChannels": (1, 2, 5), "ElevationStep": (0.5, 1.0, 3.0),
    "MinimumElevation": (-10.0, 0.0), "AzimuthRange": ((0.0, 360.0), (-20.0, 100.0), (300.0, 420.0)),
    "NumberOfRevolutions": (1, 2, 3), "StepsPerRevolution": (1, 2, 3), "HalfBeamwidth": (5.6e-3, 0.03, 0.08, 0.1),
    "HalfBeamwidthAcross": (0.0, 0.0, 1e-3, 0.02), "RangeGate": (40.0, 200.0, 4000.0),
    "LowerEnergyLimit": (0.0, 1e-12, 1e-8, 1e-7, 2e-6), "UpperEnergyLimit": (1e-5, 6.25e-5, 1e-3),
    "NoisePhotonRate": (0.0, 2e4, 1e12, 1e18), "ReceiverAperture": (0.0, 0.0, 0.008, 10.0),
    "SamplingInterval": (1e-9, 5e-9), "PulseWidth": (0.0, 5e-9, 2e-8), "FiringInterval": (0.0, 5e-6, 3e-3),
    "RotationRate": (0.5, 1.0, 10.0), "EncoderJitter": (0.0, 0.1), "SwayAmplitude": (0.0, 0.1, 3.0),
    "RaysPerBeam": (1, 2, 7, 16, 40), "NumberOfConnections": (0, 2, 8),
    "AttenuationCoefficient": (0.0, 3.5e-5, 1e-3, 0.05), "Preset": (0, 0, 0, 1), "NumberOfThreads": (0, 1, 2, 3),
    "MaximumCacheSize": (0, 1, 1024), "Seed": (0, 1, -5, 2**31 - 1), "MaximumLeafSize": (1, 2, 4, 16),
    "DisplayLevel": (-1, 0, 2), "Material": (0, 1, 2, 3, 4, 5), "BlockNamePattern": ("*", "block 1", "inn?r *", ""),
    "NameOfObject": ("", "thing"), "Species": ("herring gull", "starling", "no bird"), "NumberOfBirds": (0, 1, 3),
    "Radius": (20.0, 60.0), "Heights": ((1.0, 9.0),), "TimeRange": ((-5.0, 5.0),),
    "Lengths": ((40.0, 40.0, 9.0), (100.0, 9.0, 20.0)), "Center": ((0.0, 0.0, 0.0), (30.0, 9.0, 1.0)),
    "Bounds": ((-60.0, 60.0, -60.0, 60.0, 0.0, 9.0), (-9.0, 90.0, 0.0, 60.0, 0.0, 9.0)),
    "Spacing": ((30.0, 30.0, 9.0), (20.0, 30.0, 9.0)), "Origin": ((31.0, 121.0, 3.0), (31.0, 121.0, 9.0)),
    "NumberOfScans": (1, 2, 3), "AllSpecies": (0,), "PoseProbabilities": (0,), "Name": ("fog", "x")}
# Columns and rows go with the table of beams; the others are other names of a setting, or need files.
NOT_SET = {"Columns", "Rows", "BeamwidthMilliradians", "Wavelength", "ErrorsAsData", "FileName", "SpeciesFileName",
           "BeamId"}
SMALL = {("coverage", "Bounds"): VALUES["Bounds"][0], ("coverage", "Spacing"): VALUES["Spacing"][0],
         ("coverage", "RaysPerBeam"): 9, ("tracks", "NumberOfBirds"): 2, ("tracks", "Radius"): 40.0,
         ("tracks", "Heights"): (1.0, 9.0), ("tracks", "TimeRange"): (-5.0, 5.0)}


def _read_panels():
    """{class: {property: (its element, domain or None)}} of all properties with a setter and a getter."""
    found = {}
    for proxy in make_proxies.expanded(glob.glob(os.path.join(SOURCE, "Plugin", "*", "*.xml"))).iter("SourceProxy"):
        kind = getattr(al, proxy.get("class") or "", None)
        for element in proxy.iterfind("./*[@default_values]") if kind else ():
            name = (element.get("command") or "")[3:]
            there = hasattr(kind, "Set" + name) and hasattr(kind, "Get" + name)
            if there and name not in NOT_SET and name != "ChannelElevation":
                found.setdefault(proxy.get("class"), {})[name] = element, element.find("./*[@name]")
    return found


PANELS = _read_panels()


def properties(name):
    return PANELS.get(ALGORITHMS[name]().GetClassName(), {})


def value_of(name, key, r, bad=False):
    """A random value of a property; `bad`: one out of its range, if it has one."""
    if key == "ChannelElevations":
        return [r.uniform(-10, 20) for _ in range(r.choice((0, 0, 1, 4)))] + [91.0] * bad
    element, domain = properties(name)[key]
    whole, text = element.tag.startswith("Int"), element.tag.startswith("String")
    tag = "" if domain is None else domain.tag
    if tag == "EnumerationDomain":
        return 99 if bad else int(r.choice(domain).get("value"))
    if key in VALUES and not bad:
        value = r.choice(VALUES[key])
        return list(value) if isinstance(value, tuple) else value
    if tag == "BooleanDomain" or text:
        return element.get("default_values") if text else int(r.random() < 0.5)
    low, high = ([float(x) for x in (domain.get(side) or "").split()] if domain is not None else []
                 for side in ("min", "max"))
    values = []
    for i, default in enumerate(map(float, element.get("default_values").split())):
        least, most = (side[min(i, len(side) - 1)] if side else None for side in (low, high))
        near = default * r.choice((0.5, 0.9, 1.1, 2.0)) if default else r.choice((0.0, 0.1, 1.0, 7.0, -3.0))
        value = max(near if least is None else max(near, least), -1e9)
        value = value if most is None else min(value, most)
        if bad:
            if not whole:
                value = r.choice((float("nan"), float("inf"), -1e31))
            elif least is not None:
                value = least - 1
        values.append(int(value) if whole else value)
    return values if len(values) > 1 else values[0]


class Route:
    """How the pipeline is connected."""

    def __init__(self, r):
        self.material, self.tree, self.medium = r.random() < 0.5, r.random() < 0.6, r.random() < 0.2
        self.movers = r.choice((None, None, "data", "tracks"))
        self.table = False  # beams are a table in place of the source
        self.size = (0, 0)  # columns and rows of the table


class Result:
    def __init__(self, errors, by_sink, executed, data):
        # all; the sink's own; whether it was executed
        self.errors, self.by_sink, self.executed = errors, by_sink, executed
        self.found = contents(data, MAY_DIFFER)


class Pipeline:
    def __init__(self, settings):
        self.algorithms = {name: kind() for name, kind in ALGORITHMS.items()}
        self.heard = []  # (algorithm, text)
        self.executions = dict.fromkeys(self.algorithms, 0)
        for name, algorithm in self.algorithms.items():
            self._listen(name, algorithm)
        for (name, key), value in {**SMALL, **settings}.items():
            self.set(name, key, value)
        self.reference = polydata([(9.0 * i, 40.0 - 5 * i, 1.0) for i in range(12)], [])
        a = self.algorithms
        for name in ("colour", "comparison", "image", "geodetic", "units"):
            a[name].SetInputConnection(0, a["echo"].GetOutputPort())
        a["comparison"].SetInputDataObject(1, self.reference)
        a["tracks"].SetInputConnection(a["bird"].GetOutputPort())

    def _listen(self, name, algorithm):
        def error(_, __, text):
            self.heard.append((name, text.split("): ", 1)[-1].strip()))

        def start(*_):
            self.executions[name] += 1

        error.CallDataType = vtk.VTK_STRING
        for event, heard in (("ErrorEvent", error), ("StartEvent", start), ("WarningEvent", lambda *_: None)):
            algorithm.AddObserver(event, heard)
        algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)

    def set(self, name, key, value):
        algorithm = self.algorithms[name]
        if key == "ChannelElevations":
            algorithm.SetNumberOfChannelElevations(len(value))
            for i, elevation in enumerate(value):
                algorithm.SetChannelElevation(i, elevation)
        else:
            getattr(algorithm, "Set" + key)(*(value if isinstance(value, (list, tuple)) else [value]))

    def get(self, name, key):
        algorithm = self.algorithms[name]
        if key != "ChannelElevations":
            return getattr(algorithm, "Get" + key)()
        return [algorithm.GetChannelElevation(i) for i in range(algorithm.GetNumberOfChannelElevations())]

    def connect(self, world):
        """Connect all as the world's route says."""
        a, route = self.algorithms, world.route
        a["material"].SetInputDataObject(0, world.data)
        surfaces = a["material"] if route.material else world.data
        if route.medium:
            a["group"].RemoveAllInputs()
            for one in (surfaces, a["medium"]):
                if one.IsA("vtkAlgorithm"):
                    a["group"].AddInputConnection(one.GetOutputPort())
                else:
                    a["group"].AddInputDataObject(one)
            surfaces = a["group"]
        self._give("tree", 0, surfaces)
        beams = world.table if route.table else a["sensor"]
        movers = {None: None, "data": world.movers, "tracks": a["tracks"]}[route.movers]
        for name in ("echo", "view", "coverage"):
            self._give(name, 0, beams)
            self._give(name, 1, a["tree"] if route.tree else surfaces)
            if name != "coverage":
                self._give(name, 2, movers)
        a["image"].SetColumns(route.size[0] if route.table else 0)
        a["image"].SetRows(route.size[1] if route.table else 0)
        self._give("image", 1, beams)

    def _give(self, name, port, what):
        if what is None:
            self.algorithms[name].SetInputConnection(port, None)
        elif what.IsA("vtkAlgorithm"):
            self.algorithms[name].SetInputConnection(port, what.GetOutputPort())
        else:
            self.algorithms[name].SetInputDataObject(port, what)

    def update(self, sink, moment):
        """Bring a sink, (name, port), up to date for (piece, pieces, time)."""
        name, port = sink
        algorithm, before, (piece, pieces, time) = self.algorithms[name], self.executions[name], moment
        self.heard.clear()
        piece, pieces = (0, 1) if name in WHOLE else (piece, pieces)
        if time is None:
            algorithm.UpdatePiece(piece, pieces, 0)
        else:
            algorithm.UpdateTimeStep(time, piece, pieces, 0)
        own = [text for who, text in self.heard if who == name]
        return Result([text for _, text in self.heard], own, self.executions[name] > before,
                      algorithm.GetOutputDataObject(port))


SINKS = [(name, port) for name, kind in ALGORITHMS.items() if name not in ("group", "medium", "material", "bird")
         for port in range(kind().GetNumberOfOutputPorts())]
