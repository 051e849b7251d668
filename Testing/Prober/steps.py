# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of steps: what is done to a pipeline and to its data between two looks at its outputs. A step draws all that it
does from its own numbers, so that a sequence keeps its meaning when others are left out."""

import math

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import scenes
from contents import copy_of, leaves
from pipeline import Route, SINKS

NAN = float("nan")

SENSOR = {
    "Position": lambda r: [r.uniform(-20, 20), r.uniform(-20, 20), r.uniform(0, 8)],
    "Orientation": lambda r: [r.uniform(-180, 180), r.choice((0.0, 3.0)), r.choice((0.0, -2.0))],
    "NumberOfChannels": lambda r: r.randint(1, 5),
    "MinimumElevation": lambda r: r.uniform(-15, 5),
    "ElevationStep": lambda r: r.choice((0.5, 1.0, 3.0)),
    "ChannelElevations": lambda r: [r.uniform(-10, 20) for _ in range(r.choice((0, 0, 1, 4)))],
    "AzimuthRange": lambda r: r.choice(([0.0, 360.0], [-20.0, 100.0], [300.0, 420.0])),
    "AzimuthStep": lambda r: r.choice((7.0, 10.0, 20.0)),
    "HalfBeamwidth": lambda r: r.choice((1e-3, 5.6e-3, 0.03, 0.1)),
    "HalfBeamwidthAcross": lambda r: r.choice((0.0, 0.0, 1e-3, 0.02)),
    "BeamOutline": lambda r: r.choice((0, 0, 1)),
    "BeamRotation": lambda r: r.choice((0.0, 30.0)),
    "BeamProfile": lambda r: r.randint(0, 1),
    "GaussianTruncation": lambda r: r.choice((0.5, 1.0, 2.0)),
    "RotationRate": lambda r: r.choice((0.5, 1.0, 10.0)),
    "FiringInterval": lambda r: r.choice((0.0, 5e-6, 30e-6)),
    "NumberOfRevolutions": lambda r: r.randint(1, 3),
    "StepsPerRevolution": lambda r: r.randint(1, 4),
    "SwayAmplitude": lambda r: r.choice((0.0, 0.0, 0.1, 3.0)),
    "SwayFrequency": lambda r: r.choice((0.1, 0.5, 20.0)),
    "EncoderJitter": lambda r: r.choice((0.0, 0.0, 0.1)),
    "MotionSeed": lambda r: r.choice((0, 3, -(2**31))),
    "PulseEnergy": lambda r: r.choice((1e-5, 2.5e-4, 3.6e-4)),
    "PulseWidth": lambda r: r.choice((0.0, 5e-9, 2e-8)),
    "Frequency": lambda r: r.choice((3.313e14, 1.9e14)),
    "SamplingInterval": lambda r: r.choice((1e-9, 5e-9)),
    "RangeGate": lambda r: r.choice((40.0, 200.0, 4000.0)),
    "NoisePhotonRate": lambda r: r.choice((0.0, 2e4, 1e12, 1e18)),
    "LowerEnergyLimit": lambda r: r.choice((0.0, 1e-8, 1e-7, 2e-6)),
    "UpperEnergyLimit": lambda r: r.choice((1e-5, 6.25e-5, 1e-3)),
    "ReceiverAperture": lambda r: r.choice((0.0, 0.0, 0.0, 10.0)),
    "DisplayLength": lambda r: r.choice((10.0, 1000.0)),
}
MATERIAL = {
    "Material": lambda r: r.randint(0, 4),
    "Kd": lambda r: r.uniform(0, 0.5),
    "Ks": lambda r: r.uniform(0, 0.5),
    "Kp": lambda r: r.choice((0.0, 1.0, 112.0, 1e4)),
    "ObjectId": lambda r: r.randint(-1, 3),
    "NameOfObject": lambda r: r.choice(("", "painted", "thing")),
    "BlockNamePattern": lambda r: r.choice(("*", "block 1", "block *", "inner ?", "")),
}
TREE = {
    "SplitRule": lambda r: r.randint(0, 3),
    "BoundingVolume": lambda r: r.randint(0, 2),
    "MaximumLeafSize": lambda r: r.choice((1, 2, 4, 16)),
    "DisplayLevel": lambda r: r.randint(-1, 4),
}
ECHO = {
    "Preset": lambda r: r.choice((0, 0, 0, 1, 2)),
    "RaysPerBeam": lambda r: r.choice((1, 2, 7, 16, 40)),
    "Sampling": lambda r: r.randint(0, 1),
    "BeamSamples": lambda r: r.randint(0, 1),
    "Seed": lambda r: r.choice((0, 1, -5, 2**31 - 1)),
    "AttenuationCoefficient": lambda r: r.choice((0.0, 3.5e-5, 1e-3, 0.05)),
    "ReflectanceModel": lambda r: r.randint(0, 2),
    "NumberOfReflections": lambda r: r.randint(1, 2),
    "BeamConstraint": lambda r: r.random() < 0.7,
    "LightEnergyConstraint": lambda r: r.random() < 0.5,
    "LightEnergyThreshold": lambda r: r.choice((0, 0, 1)),
    "LightEnergyFraction": lambda r: r.choice((0.0, 1e-3, 1e-3, 0.1)),
    "BatchCollisionDetection": lambda r: r.randint(0, 2),
    "Noise": lambda r: r.random() < 0.5,
    "FullModel": lambda r: r.random() < 0.3,
    "ReturnMode": lambda r: r.randint(0, 4),
    "NumberOfConnections": lambda r: r.choice((0, 2, 8)),
    "ReportMovers": lambda r: r.random() < 0.5,
    "NumberOfThreads": lambda r: r.randint(0, 3),
    "MaximumCacheSize": lambda r: r.choice((0, 1, 1024)),
}
COLOUR = {
    "UseFieldDataRange": lambda r: r.random() < 0.6,
    "EnergyRange": lambda r: [1e-7, r.choice((1e-5, 1e-3))],
}
PROPERTIES = {"sensor": SENSOR, "material": MATERIAL, "tree": TREE, "echo": ECHO, "colour": COLOUR}

BAD = [
    ("sensor", "HalfBeamwidth", -1.0), ("sensor", "AzimuthStep", 0.0), ("sensor", "PulseEnergy", NAN),
    ("sensor", "LowerEnergyLimit", 1.0), ("sensor", "NumberOfChannels", 0), ("sensor", "Position", [NAN, 0.0, 0.0]),
    ("sensor", "StepsPerRevolution", 0), ("sensor", "ChannelElevations", [0.0, 91.0]), ("sensor", "RotationRate", 0.0),
    ("sensor", "SwayAmplitude", 11.0), ("sensor", "EncoderJitter", NAN),
    ("material", "Material", 9), ("material", "ObjectId", -2), ("tree", "SplitRule", 4), ("tree", "MaximumLeafSize", 0),
    ("tree", "BoundingVolume", -1), ("echo", "RaysPerBeam", 0), ("echo", "AttenuationCoefficient", -1.0),
    ("echo", "BeamSamples", 2), ("echo", "ReturnMode", 5), ("echo", "Preset", -1),
    ("echo", "MaximumCacheSize", -1), ("echo", "NumberOfConnections", -1), ("echo", "NumberOfThreads", -1),
    ("echo", "LightEnergyFraction", -1.0), ("echo", "Sampling", 7), ("echo", "ReflectanceModel", -1), ("echo", "NumberOfReflections", 3),
    ("colour", "EnergyRange", [1.0, 0.0]),
]


class World:
    """What there is now: data, settings, how all is connected, and the pipeline that has run before."""

    def __init__(self, r, without):
        self.without = without
        self.settings = {}
        self.data = scenes.scene(r)
        self.table = None
        self.route = Route()
        self.route.material, self.route.tree = r.random() < 0.5, r.random() < 0.6
        self.moment = (0, 1, None)
        self.used = None
        self.held = []
        self.said = []
        for name, key in (("sensor", "NumberOfChannels"), ("sensor", "AzimuthStep"), ("echo", "RaysPerBeam")):
            self.settings[name, key] = PROPERTIES[name][key](r)
        for _ in range(r.randint(0, 6)):
            name = r.choice(("sensor", "echo", "echo", "material"))
            key = r.choice(sorted(PROPERTIES[name]))
            self.settings[name, key] = PROPERTIES[name][key](r)

    def say(self, words):
        self.said.append(words)

    def defaults(self, name, key):
        """What a property is when nobody has set it."""
        if key == "ChannelElevations":
            return []
        return getattr(self.used.algorithms[name].NewInstance(), "Get" + key)()

    def set(self, name, key, value):
        self.settings[name, key] = value
        self.used.set(name, key, value)

    def connect(self):
        self.used.connect(self.data, self.table, self.route)

    def pick(self, r):
        """A leaf with cells, or None."""
        full = [one for one in leaves(self.data) if one[2].GetNumberOfCells()]
        return r.choice(full)[2] if full else None

    def modified(self, r, leaf, array, holder):
        """Say that an array was edited in place by one Modified(), as people do; around a block the composite needs one
        of its own, or VTK's pipeline does not hear of it."""
        kind = r.choice(("array", "holder", "leaf", "root"))
        owned = leaf is not self.data and leaf is not self.table
        if kind == "array" or "stale" in self.without:
            array.Modified()
        if kind == "holder" or "stale" in self.without:
            holder.Modified()
        if kind == "leaf" or kind == "root" and not owned or kind == "array" and holder.IsA("vtkCellArray") and not owned:
            leaf.Modified()
        if owned:
            self.data.Modified()
        self.say(f"Modified() of {kind}")


def change_property(name):
    def step(world, r):
        key = r.choice(sorted(PROPERTIES[name]))
        value = PROPERTIES[name][key](r)
        before = world.settings.get((name, key))
        before = world.defaults(name, key) if before is None else before
        world.say(f"{name}: {key} = {value}")
        world.set(name, key, value)
        return lambda: world.set(name, key, before)

    return step


def bad_property(world, r):
    name, key, value = r.choice(BAD)
    before = world.settings.get((name, key))
    before = world.defaults(name, key) if before is None else before
    world.say(f"bad {name}: {key} = {value}")
    world.set(name, key, value)
    return lambda: world.set(name, key, before)


def edit_points(world, r):
    leaf = world.pick(r)
    if leaf is None:
        return
    points = vtk_to_numpy(leaf.GetPoints().GetData())
    if r.random() < 0.5:
        points += np.array([r.uniform(-5, 5) for _ in range(3)]).astype(points.dtype)
        world.say("all points moved")
    else:
        i = r.randrange(len(points))
        points[i] += np.array([r.uniform(-3, 3) for _ in range(3)]).astype(points.dtype)
        world.say(f"point {i} moved")
    world.modified(r, leaf, leaf.GetPoints().GetData(), leaf.GetPoints())


def edit_connectivity(world, r):
    leaf = world.pick(r)
    if leaf is None or not leaf.GetNumberOfPolys():
        return
    cells = leaf.GetPolys()
    ids = vtk_to_numpy(cells.GetConnectivityArray())
    i, j = r.randrange(len(ids)), r.randrange(len(ids))
    ids[i] = ids[j]
    world.say(f"corner {i} is that of corner {j}")
    world.modified(r, leaf, cells.GetConnectivityArray(), cells)


def edit_coefficients(world, r):
    leaf = world.pick(r)
    if leaf is None or not leaf.GetCellData().HasArray("kd"):
        return
    kd, ks, kp = scenes.coefficients(r, leaf.GetNumberOfCells())
    which = r.choice(("kd", "kp", "ks"))
    array = leaf.GetCellData().GetArray(which)
    values, new = vtk_to_numpy(array), {"kd": kd, "ks": ks, "kp": kp}[which]
    if r.random() < 0.5:
        values[:] = new
        world.say(f"{which} of all cells")
    else:
        i = r.randrange(len(values))
        values[i] = new[i]
        world.say(f"{which} of cell {i}")
    world.modified(r, leaf, array, leaf.GetCellData())


def edit_ids(world, r):
    leaf = world.pick(r)
    name = r.choice(("object_id", "material_id"))
    if leaf is None or not leaf.GetCellData().HasArray(name):
        return
    array = leaf.GetCellData().GetArray(name)
    vtk_to_numpy(array)[r.randrange(array.GetNumberOfTuples()) :] = r.randint(0, 3)
    world.say(name)
    world.modified(r, leaf, array, leaf.GetCellData())


def edit_names(world, r):
    found = leaves(world.data)
    if not found:
        return
    parent, index, leaf = r.choice(found)
    if parent is not None and r.random() < 0.5:
        parent.GetMetaData(index).Set(scenes.NAME, f"block {r.randint(0, 9)}")
        world.say("block renamed")
        world.data.Modified()
        return
    name = r.choice(("object_names", "material_names"))
    array = leaf.GetFieldData().GetAbstractArray(name)
    if array is None:
        scenes.add_names(leaf, name, [f"n{r.randint(0, 9)}" for _ in range(4)])
        array = leaf.GetFieldData().GetAbstractArray(name)
        world.say(f"{name} added")
    else:
        array.SetValue(0, f"n{r.randint(0, 99)}")
        world.say(f"{name} edited")
    world.modified(r, leaf, array, leaf.GetFieldData())


def exchange_array(world, r):
    """Another array takes the place, often of another type."""
    leaf = world.pick(r)
    if leaf is None:
        return
    name = r.choice(("kd", "ks", "kp", "object_id", "material_id"))
    if name in ("kd", "ks", "kp") and not leaf.GetCellData().HasArray("kd"):
        return
    count = leaf.GetNumberOfCells()
    if name in ("kd", "ks", "kp"):
        values = dict(zip(("kd", "ks", "kp"), scenes.coefficients(r, count)))[name]
        values = values.astype(r.choice((np.float64, np.float32)))
    else:
        values = np.array([r.randint(0, 3) for _ in range(count)]).astype(r.choice((np.int32, np.int64, np.float64)))
    scenes.add_cells(leaf, name, values)
    world.say(f"another {name}, {values.dtype}")
    world.data.Modified()


def remove_arrays(world, r):
    leaf = world.pick(r)
    if leaf is None:
        return
    names = r.choice((("kd", "ks", "kp"), ("object_id",), ("material_id",)))
    if leaf.GetCellData().HasArray(names[0]):
        for name in names:
            leaf.GetCellData().RemoveArray(name)
    elif names[0] == "kd":
        for name, values in zip(names, scenes.coefficients(r, leaf.GetNumberOfCells())):
            scenes.add_cells(leaf, name, values)
    world.say(f"arrays {names} taken away or given")
    leaf.Modified()
    world.data.Modified()


def edit_ghosts(world, r):
    leaf = world.pick(r)
    if leaf is None:
        return
    name = vtk.vtkDataSetAttributes.GhostArrayName()
    if not leaf.GetCellData().HasArray(name):
        scenes.add_cells(leaf, name, np.zeros(leaf.GetNumberOfCells(), np.uint8))
    ghosts = leaf.GetCellData().GetArray(name)
    vtk_to_numpy(ghosts)[r.randrange(ghosts.GetNumberOfTuples())] = r.choice((0, 1, 2, 32))
    world.say("ghost cells")
    world.modified(r, leaf, ghosts, leaf.GetCellData())


def empty_strip(world, r):
    """Cells without points, which VTK allows."""
    leaf = world.pick(r)
    if leaf is None:
        return
    kind = r.choice(("Strips", "Polys", "Lines"))
    cells = vtk.vtkCellArray()
    cells.DeepCopy(getattr(leaf, "Get" + kind)())
    for _ in range(r.randint(1, 2)):
        size = r.choice((0, 0, 1, 2))
        cells.InsertNextCell(size, [0] * size)
    getattr(leaf, "Set" + kind)(cells)
    for i in range(leaf.GetCellData().GetNumberOfArrays()):
        array = leaf.GetCellData().GetArray(i)
        old = array.GetNumberOfTuples()
        array.Resize(leaf.GetNumberOfCells())
        array.SetNumberOfTuples(leaf.GetNumberOfCells())
        for j in range(old, array.GetNumberOfTuples()):
            array.SetTuple(j, array.GetTuple(0))
    world.say(f"short {kind}")
    leaf.Modified()
    world.data.Modified()


def change_blocks(world, r):
    if world.data.IsA("vtkPolyData"):
        world.data = scenes.leaf(r)
        world.say("another surface")
        return world.connect()
    count = world.data.GetNumberOfBlocks()
    what, i = r.choice(("add", "remove", "empty", "none", "replace", "same twice", "cells")), r.randrange(max(1, count))
    world.say(f"block {i}: {what}")
    if what == "add" or not count:
        world.data.SetBlock(count, scenes.leaf(r))
        world.data.GetMetaData(count).Set(scenes.NAME, f"block {count}")
    elif what == "remove":
        world.data.RemoveBlock(i)
    elif what == "empty":
        world.data.SetBlock(i, vtk.vtkPolyData())
    elif what == "none":
        world.data.SetBlock(i, None)
    elif what == "replace":
        world.data.SetBlock(i, scenes.leaf(r))
    elif what == "same twice":
        block = world.data.GetBlock(i)
        if block is not None and block.IsA("vtkPolyData"):
            world.data.SetBlock(count, block)
    elif what == "cells":
        block = world.pick(r)
        if block is not None:
            block.DeepCopy(scenes.leaf(r))
    world.data.Modified()


def replace_data(world, r):
    what = r.choice(("deep", "shallow", "other"))
    world.say(f"surfaces: {what}")
    if what == "deep":
        world.data = copy_of(world.data)
    elif what == "shallow":
        copy = world.data.NewInstance()
        copy.ShallowCopy(world.data)
        world.data = copy
    else:
        world.data = scenes.scene(r)
    world.connect()


def change_route(world, r):
    route = world.route
    what = r.choice(("material", "tree", "copies", "table", "image"))
    if what == "material":
        route.material = not route.material
    elif what == "tree":
        route.tree = not route.tree
    elif what == "copies":
        route.copies = r.choice((None, "deep", "shallow"))
    elif what == "image":
        route.image_of_report = not route.image_of_report
    else:
        route.table = not route.table
        if route.table:
            make_table(world)
    world.say(f"way: {vars(route)}")
    world.connect()


def make_table(world):
    source = world.used.algorithms["sensor"]
    source.UpdatePiece(0, 1, 0)
    world.table = copy_of(source.GetOutput())
    fields = world.table.GetFieldData()
    rows = fields.GetArray("number_of_channels").GetValue(0) if fields.HasArray("number_of_channels") else 0
    world.route.size = (world.table.GetNumberOfPoints() // rows if rows else 0, rows)


def edit_beams(world, r):
    """Beams of a table, in place."""
    table = world.table
    if not world.route.table or not table.GetNumberOfPoints():
        return
    name = r.choice(("direction", "direction", "reported_direction", "points", "beam_id", "laser_id", "timestamp", "azimuth", "pulse_energy",
                     "half_beamwidth", "lower_energy_limit", "range_gate", "revolution", "display_length"))
    i = r.randrange(table.GetNumberOfPoints())
    if name == "points":
        vtk_to_numpy(table.GetPoints().GetData())[i:] += r.uniform(-1, 1)
        array, holder = table.GetPoints().GetData(), table.GetPoints()
    elif table.GetPointData().HasArray(name):
        array, holder = table.GetPointData().GetArray(name), table.GetPointData()
        values = vtk_to_numpy(array)
        if name.endswith("direction"):
            angle = r.uniform(0, 2 * math.pi)
            values[i] = [math.sin(angle), math.cos(angle), r.uniform(-0.1, 0.3)]
        elif name == "beam_id":
            j = r.randrange(len(values))
            values[[i, j]] = values[[j, i]]
        else:
            values[i] = r.randint(0, 9)
    elif table.GetFieldData().HasArray(name):
        array, holder = table.GetFieldData().GetArray(name), table.GetFieldData()
        factor = {"revolution": 0, "lower_energy_limit": 0.5}.get(name, r.choice((0.5, 2.0)))
        values = vtk_to_numpy(array)
        values[0] = values[0] * factor if factor else r.randint(-2, 2)
    else:
        return
    world.say(f"beams: {name}")
    world.modified(r, table, array, holder)


def bad_data(world, r):
    """A point, a coefficient or a direction that is none, until it is mended."""
    if world.route.table and r.random() < 0.3 and world.table.GetNumberOfPoints():
        array, holder, owner = world.table.GetPointData().GetArray("direction"), world.table.GetPointData(), world.table
    else:
        owner = world.pick(r)
        if owner is None:
            return None
        array, holder = owner.GetPoints().GetData(), owner.GetPoints()
        if r.random() < 0.5 and owner.GetCellData().HasArray("kd"):
            array, holder = owner.GetCellData().GetArray("kd"), owner.GetCellData()
    values = vtk_to_numpy(array)
    i, bad = r.randrange(len(values)), r.choice((NAN, float("inf"), -1e31))
    before = values[i].copy()
    values[i] = bad
    world.say(f"{array.GetName()} {i} = {bad}")
    world.modified(r, owner, array, holder)

    def mend():
        vtk_to_numpy(array)[i] = before
        world.modified(r, owner, array, holder)
        if owner is not world.data and owner is not world.table:
            world.data.Modified()

    return mend


def missing_array(world, r):
    leaf = world.pick(r)
    if leaf is None or not leaf.GetCellData().HasArray("ks"):
        return None
    array = leaf.GetCellData().GetArray("ks")
    leaf.GetCellData().RemoveArray("ks")
    leaf.Modified()
    world.data.Modified()
    world.say("ks is missing")

    def mend():
        leaf.GetCellData().AddArray(array)
        leaf.Modified()
        world.data.Modified()

    return mend


def change_moment(world, r):
    piece, pieces, time = world.moment
    if r.random() < 0.5:
        pieces = r.choice((1, 1, 2, 3, 50))
        piece = r.randrange(pieces)
    else:
        time = r.choice((0.0, 0.4, 1.0, 2.0, 3.7, -1.5))  # once asked for, there is always one
    world.moment = (piece, pieces, time)
    world.say(f"piece {piece} of {pieces}, time {time}")


def touch(world, r):
    """Modified() where nothing was."""
    found = leaves(world.data)
    what = r.choice(list(world.used.algorithms.values()) + [world.data] + [leaf for _, _, leaf in found])
    what.Modified()
    world.say(f"Modified() of {what.GetClassName()}")


def hold(world, r):
    """Somebody keeps a shallow copy of what came out; later executions must not write into it."""
    if world.held and r.random() < 0.3:
        world.held.pop(r.randrange(len(world.held)))
        world.say("a copy is let go")
        return
    sink = r.choice(("echoes", "tree", "colour", "image"))
    name, port = SINKS[sink]
    output = world.used.algorithms[name].GetOutputDataObject(port)
    copy = output.NewInstance()
    copy.ShallowCopy(output)
    world.held.append((sink, copy))
    world.say(f"{sink} are held")


def abort(world, r):
    """A wish to stop in the middle; then as if nothing had been. The driver looks at the outputs in between."""
    name = r.choice(("tree", "echo", "echo", "sensor", "material", "image", "comparison"))
    world.abort = (name, r.choice((0.0, 0.0, 0.05, 0.3, 0.7)))
    world.say(f"abort of {name} at {world.abort[1]}")


KINDS = {
    "sensor": change_property("sensor"),
    "material": change_property("material"),
    "tree": change_property("tree"),
    "echo": change_property("echo"),
    "colour": change_property("colour"),
    "points": edit_points,
    "connectivity": edit_connectivity,
    "coefficients": edit_coefficients,
    "ids": edit_ids,
    "names": edit_names,
    "exchange": exchange_array,
    "arrays": remove_arrays,
    "ghosts": edit_ghosts,
    "strips": empty_strip,
    "blocks": change_blocks,
    "data": replace_data,
    "route": change_route,
    "beams": edit_beams,
    "moment": change_moment,
    "touch": touch,
    "hold": hold,
    "abort": abort,
    "bad property": bad_property,
    "bad data": bad_data,
    "missing array": missing_array,
}
# How often each is drawn.
WEIGHTS = {"echo": 4, "sensor": 3, "points": 3, "coefficients": 3, "beams": 3, "route": 2, "material": 2, "blocks": 2}
