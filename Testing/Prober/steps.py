# SPDX-License-Identifier: BSD-3-Clause
"""What is done to a pipeline and to its data between two looks at its outputs. A step draws all that it does from its
own numbers, so that a sequence keeps its meaning when others are left out, and returns how it is undone, if it can be:
what is bad is mended."""

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import data as surfaces
from data import copy_of, leaves
from pipeline import ALGORITHMS, Pipeline, Route, properties, value_of

SET = {name: sorted(properties(name)) + ["ChannelElevations"] * (name == "sensor") for name in ALGORITHMS
       if properties(name)}


class World:
    """What there is now: data, settings, how all is connected, and the pipeline that has run before."""

    def __init__(self, r):
        self.settings, self.said, self.held = {}, [], []
        self.data, self.table, self.route, self.moment = surfaces.scene(r), None, Route(r), (0, 1, None)
        self.movers = vtk.vtkMultiBlockDataSet()
        for i in range(r.randint(1, 3)):
            self.movers.SetBlock(i, surfaces.mover(r, surfaces.leaf(r)))
        for key in ("NumberOfChannels", "AzimuthStep", "ReceiverModel"):
            self.settings["sensor", key] = value_of("sensor", key, r)
        self.settings["echo", "RaysPerBeam"] = value_of("echo", "RaysPerBeam", r)
        # Beams so wide that little is between them.
        self.settings["sensor", "HalfBeamwidth"] = r.choice((0.03, 0.08))
        self.settings["sensor", "MinimumElevation"] = -1.0
        self.settings["sensor", "LowerEnergyLimit"] = r.choice((1e-9, 1e-8, 2e-6))
        if self.settings["sensor", "ReceiverModel"]:
            self.settings["sensor", "ReceiverAperture"] = 0.008
        self.used = Pipeline(self.settings)
        self.used.connect(self)

    def say(self, words):
        self.said.append(words)

    def fresh(self):
        """A pipeline that never ran, on deep copies of the data, with another number of threads."""
        pipeline = Pipeline(self.settings)
        for name in ("echo", "view", "coverage"):
            threads = pipeline.algorithms[name]
            if threads.GetNumberOfThreads() >= 0:  # a bad number stays bad
                threads.SetNumberOfThreads(1 if threads.GetNumberOfThreads() != 1 else 2)
        copies = World.__new__(World)
        copies.route, copies.data, copies.movers = self.route, copy_of(self.data), copy_of(self.movers)
        copies.table = self.table and copy_of(self.table)
        pipeline.connect(copies)
        pipeline.copied = copies
        return pipeline

    def set(self, name, key, value):
        self.settings.pop((name, key), None)  # the last one counts where two set the same
        self.settings[name, key] = value
        self.used.set(name, key, value)

    def before(self):
        """[how to come back to the present data and their connections]"""
        data, route, table = self.data.NewInstance(), vars(self.route).copy(), self.table
        data.ShallowCopy(self.data)

        def restore():
            self.data, self.table = data, table
            vars(self.route).update(route)
            self.used.connect(self)

        return [restore]

    def roots(self):
        """All data that is read: surfaces, movers, and beams of a table."""
        return [self.data] + [self.movers] * (self.route.movers == "data") + [self.table] * self.route.table

    def pick(self, r):
        """(what holds it, a leaf with points), or None twice."""
        root = r.choice(self.roots())
        full = [leaf for _, _, leaf in leaves(root) if leaf.GetNumberOfPoints()]
        return (root, r.choice(full)) if full else (None, None)

    def modified(self, r, root, leaf, array, holder):
        """Say that an array was edited in place by one Modified(), as people do; around a block the composite needs one
        of its own, and cells, which VTK does not look at, need one of the data."""
        kind = r.choice(("array", "holder", "leaf", "root"))
        {"array": array, "holder": holder, "leaf": leaf, "root": root}[kind].Modified()
        if leaf is not root or isinstance(holder, vtk.vtkCellArray):
            root.Modified()
        self.say(f"Modified() of {kind}")


def change_property(name, bad=False):
    def step(world, r):
        key = r.choice(SET[name])
        before, value = world.used.get(name, key), value_of(name, key, r, bad)
        world.say(f"{name}: {key} = {value}")
        world.set(name, key, value)
        return lambda: world.set(name, key, before)

    return step


def arrays_of(leaf):
    """(array, what holds it) of all that a leaf holds."""
    found = [(leaf.GetPoints().GetData(), leaf.GetPoints())] * 2
    for cells in (leaf.GetPolys(), leaf.GetStrips()):
        if cells.GetNumberOfCells():
            found.append((cells.GetConnectivityArray(), cells))
    for holder in (leaf.GetCellData(), leaf.GetPointData(), leaf.GetFieldData()):
        found += [(holder.GetAbstractArray(i), holder) for i in range(holder.GetNumberOfArrays())]
    return [one for one in found if one[0].GetNumberOfValues()]


def edit_values(array, r):
    """Change some values of an array in place, so that they stay what they are: coefficients, directions, ids, names,
    ghosts."""
    if array.IsA("vtkStringArray"):
        return array.SetValue(r.randrange(array.GetNumberOfValues()), f"new {r.randint(0, 99)}")
    values = vtk_to_numpy(array)
    first = r.randrange(len(values))
    some = values[first : r.choice((first + 1, len(values)))]
    if values.dtype.kind == "f" and array.GetName() in (None, "Points", "pose_position"):
        some += np.array([r.uniform(-4, 4) for _ in range(3)]).astype(values.dtype)
    elif values.dtype.kind == "f":
        some *= np.array([r.uniform(0.2, 1.2) for _ in range(some[0].size)]).astype(values.dtype).reshape(some[0].shape)
    elif values.dtype == np.int64:  # corners, numbers of beams
        some[:] = r.choice((some[::-1].copy(), r.choice(values)))
    else:
        some[:] = r.randint(0, 3)


def edit(world, r, bad=False):
    """Values of any array, in place; another array in its place, of another type; or none."""
    root, leaf = world.pick(r)
    if leaf is None:
        return None
    array, holder = r.choice(arrays_of(leaf))
    before = array.NewInstance()
    before.DeepCopy(array)
    what = "values"
    if isinstance(holder, vtk.vtkFieldData) and not bad:
        what = r.choice(("values",) * 9 + ("type", "type", "text", "none"))
    world.say(f"{array.GetName()}: {'bad ' * bad}{what}")

    def restore():
        array.DeepCopy(before)
        if isinstance(holder, vtk.vtkFieldData):
            holder.AddArray(array)
        leaf.Modified()
        root.Modified()

    if what == "none":
        holder.RemoveArray(array.GetName())
    elif what == "text":
        surfaces.add_array(holder, array.GetName(), ["x"] * array.GetNumberOfTuples())
    elif what == "type" and not array.IsA("vtkStringArray"):
        values = vtk_to_numpy(array).astype(r.choice((np.float64, np.float32, np.int32)))
        surfaces.add_array(holder, array.GetName(), values)
    elif bad and array.IsA("vtkDataArray") and vtk_to_numpy(array).dtype.kind == "f":
        array.SetComponent(r.randrange(array.GetNumberOfTuples()), 0, r.choice((float("nan"), float("inf"), -1e31)))
    else:
        edit_values(array, r)
    if what == "values":
        world.modified(r, root, leaf, array, holder)
        for other in [other for _, _, other in leaves(root) if other is not leaf and other.GetNumberOfPoints()
                      and r.random() < 0.5]:
            for array_of, holder_of in arrays_of(other):
                if array_of.GetName() == array.GetName() and isinstance(holder_of, type(holder)) and not bad:
                    edit_values(array_of, r)
                    world.modified(r, root, other, array_of, holder_of)
    else:
        leaf.Modified()
        root.Modified()
    return restore


def change_blocks(world, r):
    if world.data.IsA("vtkPolyData"):
        world.data = surfaces.leaf(r)
        world.say("another surface")
        return world.used.connect(world)
    count = world.data.GetNumberOfBlocks()
    what, i = r.choice(("add", "remove", "empty", "none", "same twice", "cells", "name")), r.randrange(max(1, count))
    block = world.data.GetBlock(i) if count else None
    world.say(f"block {i}: {what}")
    if what == "add" or block is None:
        world.data.SetBlock(count, surfaces.leaf(r))
    elif what == "remove":
        world.data.RemoveBlock(i)
    elif what in ("empty", "none"):
        world.data.SetBlock(i, vtk.vtkPolyData() if what == "empty" else None)
    elif what == "same twice":
        world.data.SetBlock(count, block)
    elif what == "name":
        world.data.GetMetaData(i).Set(surfaces.NAME, f"block {r.randint(0, 9)}")
    elif block.IsA("vtkPolyData"):
        block.DeepCopy(surfaces.leaf(r))
    world.data.Modified()


def replace_data(world, r):
    what = r.choice(("deep", "shallow", "other", "tree"))
    world.say(f"surfaces: {what}")
    source = world.used.algorithms["tree"].GetOutput() if what == "tree" else world.data
    if what == "other" or what == "tree" and not source.GetNumberOfPoints():
        world.data = surfaces.scene(r)
    elif what == "deep":
        world.data = copy_of(source)
    else:
        world.data = source.NewInstance()
        world.data.ShallowCopy(source)
    world.used.connect(world)


def change_route(world, r):
    route, what = world.route, r.choice(("material", "tree", "table", "movers", "medium"))
    if what == "movers":
        route.movers = r.choice((None, "data", "tracks"))
    else:
        setattr(route, what, not getattr(route, what))
    if what == "table" and route.table:
        world.used.algorithms["sensor"].UpdatePiece(0, 1, 0)
        world.table = copy_of(world.used.algorithms["sensor"].GetOutput())
        rows = world.table.GetFieldData().GetArray("number_of_channels")
        route.size = (world.table.GetNumberOfPoints() // int(rows.GetValue(0)),
                      int(rows.GetValue(0))) if rows else (0, 0)
    world.say(f"way: {vars(route)}")
    world.used.connect(world)


def change_moment(world, r):
    piece, pieces, time = world.moment
    if r.random() < 0.3:
        pieces = r.choice((1, 1, 2, 3, 50))
        piece = r.randrange(pieces)
    else:
        time = r.choice((0.0, 0.4, 1.0, 2.0, 3.7, -1.5))  # once asked for, there is always one
    world.moment = (piece, pieces, time)
    world.say(f"piece {piece} of {pieces}, time {time}")


def hold(world, r):
    """Somebody keeps a shallow copy of what came out; later executions must not write into it."""
    name, port = r.choice((("echo", 0), ("echo", 1), ("tree", 0), ("colour", 0), ("image", 0)))
    output = world.used.algorithms[name].GetOutputDataObject(port)
    copy = output.NewInstance()
    copy.ShallowCopy(output)
    world.held = world.held[-2:] + [(name, copy)]
    world.say(f"{name} is held")


KINDS = {**{name: change_property(name) for name in SET}, "edit": edit, "blocks": change_blocks, "data": replace_data,
         "route": change_route, "moment": change_moment, "hold": hold,
         "bad data": lambda world, r: edit(world, r, True),
         **{"bad " + name: change_property(name, True) for name in ("sensor", "echo", "tree", "material", "medium")}}
# How often each is drawn, in place of once.
WEIGHTS = {"edit": 40, "echo": 6, "sensor": 5, "moment": 4, "route": 3, "material": 2, "blocks": 2}
WEIGHTS.update({"scribble": 3, "coverage": 0.3})  # scribble: same_bits.py
