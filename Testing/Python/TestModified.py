# SPDX-License-Identifier: BSD-3-Clause
"""Whoever edits values in place and calls Modified() on anything gets a fresh look: the array itself, what holds it or
any other part of the data. Each kind of edit with each kind of Modified(), on filters that have run before against
filters that never ran, bit by bit; and what was not changed is kept: no ray is traced for a Modified() alone."""
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

import echotools
from echotools import CELLS, RAYS
from avianlidar import vtkAvianLidar as al

RANDOM = np.random.default_rng(5)
# What a run costs, and bounds that may be from before, not what it finds.
WITHOUT = (*echotools.COSTS, "skipped", "skipped_bound")


def view(array):
    """The values themselves, not a copy."""
    return numpy_support.vtk_to_numpy(array)


def add(attributes, name, values):
    array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    attributes.AddArray(array)


def texts(name, values):
    array = vtk.vtkStringArray()
    array.SetName(name)
    for value in values:
        array.InsertNextValue(value)
    return array


def house(seed, triangles=True):
    """A box of triangles or of quads around the lidar's circle, each face an object of its own, with names."""
    random = np.random.default_rng(seed)
    angle = 2.1 * seed
    source = vtk.vtkCubeSource()
    source.SetOutputPointsPrecision(vtk.vtkAlgorithm.DOUBLE_PRECISION)
    source.SetCenter(60 * np.sin(angle), 60 * np.cos(angle), 0)
    source.SetXLength(30)
    source.SetYLength(25)
    source.SetZLength(20)
    cut = vtk.vtkTriangleFilter()
    cut.SetInputConnection(source.GetOutputPort())
    last = cut if triangles else source
    last.Update()
    data = vtk.vtkPolyData()
    data.DeepCopy(last.GetOutput())
    count = data.GetNumberOfCells()
    for name, values in (("kd", 0.1 + 0.2 * random.random(count)), ("ks", np.full(count, 0.1)),
                         ("kp", 50 + 50 * random.random(count)),
                         ("object_id", (np.arange(count) // (count // 6) + 10 * seed).astype(np.int32)),
                         ("material_id", np.zeros(count, dtype=np.int32))):
        add(data.GetCellData(), name, values)
    add(data.GetCellData(), vtk.vtkDataSetAttributes.GhostArrayName(), np.zeros(count, dtype=np.uint8))
    data.GetFieldData().AddArray(texts("object_names", [f"face {i}" for i in range(40)]))
    data.GetFieldData().AddArray(texts("object_classes", [f"class {i}" for i in range(40)]))
    data.GetFieldData().AddArray(texts("material_names", [f"paint of {seed}", "other"]))
    return data


def town():
    """A composite of three houses, one of them of quads, two in a composite of their own."""
    inner = vtk.vtkMultiBlockDataSet()
    inner.SetBlock(0, house(1))
    inner.SetBlock(1, house(2, triangles=False))
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.SetBlock(0, house(0))
    blocks.SetBlock(1, inner)
    for i, name in enumerate(("first", "others")):
        blocks.GetMetaData(i).Set(vtk.vtkCompositeDataSet.NAME(), name)
    return blocks


def leaves_of(data):
    if data.IsA("vtkPolyData"):
        return [data]
    return [leaf for i in range(data.GetNumberOfBlocks()) for leaf in leaves_of(data.GetBlock(i))]


def nodes_of(data):
    """Composites, the outermost first."""
    if data.IsA("vtkPolyData"):
        return []
    return [data] + [node for i in range(data.GetNumberOfBlocks()) for node in nodes_of(data.GetBlock(i))]


def copy_of(data):
    copy = data.NewInstance()
    copy.DeepCopy(data)
    return copy


# ---------------------------------------------------------------- edits in place, without a word to VTK

def coefficient(name, low, high):
    def edit(leaf):
        values = view(leaf.GetCellData().GetArray(name))
        values[RANDOM.integers(len(values))] = low + (high - low) * RANDOM.random()
    return edit


def move(leaf):
    view(leaf.GetPoints().GetData())[:] += RANDOM.random(3) - 0.5


def turn_cells(leaf):
    """Cells go round the other way, or lose a corner to another one."""
    array = leaf.GetPolys().GetConnectivityArray()
    values = view(array)
    values[:] = np.roll(values, 1)


def shift_offsets(leaf):
    """The cells between the first and the last begin elsewhere."""
    values = view(leaf.GetPolys().GetOffsetsArray())
    whole, corners = values[-1], values[-1] // (len(values) - 1)
    values[1:-1] = np.arange(1, len(values) - 1) * corners + (0 if values[1] != corners else 1)
    values[-1] = whole


def objects(leaf):
    values = view(leaf.GetCellData().GetArray("object_id"))
    values[RANDOM.integers(len(values))] = RANDOM.integers(200)


def materials(leaf):
    values = view(leaf.GetCellData().GetArray("material_id"))
    values[RANDOM.integers(len(values))] ^= 1


def ghosts(leaf):
    values = view(leaf.GetCellData().GetArray(vtk.vtkDataSetAttributes.GhostArrayName()))
    values[RANDOM.integers(len(values))] ^= 1


def name_of(array):
    def edit(leaf):
        names = leaf.GetFieldData().GetAbstractArray(array)
        names.SetValue(int(RANDOM.integers(2)), f"new {RANDOM.integers(1000)}")
    return edit


SURFACE_EDITS = {
    "points": (move, lambda d: d.GetPoints().GetData()),
    "connectivity": (turn_cells, lambda d: d.GetPolys().GetConnectivityArray()),
    "offsets": (shift_offsets, lambda d: d.GetPolys().GetOffsetsArray()),
    "kd": (coefficient("kd", 0, 0.5), lambda d: d.GetCellData().GetArray("kd")),
    "ks": (coefficient("ks", 0, 0.4), lambda d: d.GetCellData().GetArray("ks")),
    "kp": (coefficient("kp", 10, 1000), lambda d: d.GetCellData().GetArray("kp")),
    "object_id": (objects, lambda d: d.GetCellData().GetArray("object_id")),
    "material_id": (materials, lambda d: d.GetCellData().GetArray("material_id")),
    "ghosts": (ghosts, lambda d: d.GetCellData().GetArray(vtk.vtkDataSetAttributes.GhostArrayName())),
    "object_names": (name_of("object_names"), lambda d: d.GetFieldData().GetAbstractArray("object_names")),
    "object_classes": (name_of("object_classes"), lambda d: d.GetFieldData().GetAbstractArray("object_classes")),
    "material_names": (name_of("material_names"), lambda d: d.GetFieldData().GetAbstractArray("material_names")),
}
# Whose Modified() is called, of a leaf; `array` is what was edited.
TELLS = {
    "array": lambda leaf, array: array,
    "points": lambda leaf, array: leaf.GetPoints(),
    "array of points": lambda leaf, array: leaf.GetPoints().GetData(),
    "polygons": lambda leaf, array: leaf.GetPolys(),
    "connectivity": lambda leaf, array: leaf.GetPolys().GetConnectivityArray(),
    "poly data": lambda leaf, array: leaf,
    "cell data": lambda leaf, array: leaf.GetCellData(),
    "point data": lambda leaf, array: leaf.GetPointData(),
    "field data": lambda leaf, array: leaf.GetFieldData(),
    "an array of cells": lambda leaf, array: leaf.GetCellData().GetArray("kp"),
}


def turn_beams(beams):
    values = view(beams.GetPointData().GetArray("direction"))
    values[RANDOM.integers(len(values))] += 0.1 * RANDOM.random(3)


def move_beams(beams):
    view(beams.GetPoints().GetData())[:] += RANDOM.random(3) - 0.5


def beam_values(name):
    def edit(beams):
        values = view(beams.GetPointData().GetArray(name))
        if name == "beam_id":
            values[0] += 100000
        else:
            values[RANDOM.integers(len(values))] += 1
    return edit


def beam_field(name):
    def edit(beams):
        view(beams.GetFieldData().GetArray(name)).flat[0] *= 1 + 0.1 * RANDOM.random()
    return edit


BEAM_FIELDS = ("half_beamwidth", "pulse_energy", "lower_energy_limit", "range_gate", "display_length", "position")
BEAM_ARRAYS = ("beam_id", "laser_id", "azimuth", "vertical_angle", "timestamp")
BEAM_EDITS = {
    "directions": (turn_beams, lambda d: d.GetPointData().GetArray("direction")),
    "points": (move_beams, lambda d: d.GetPoints().GetData()),
    **{name: (beam_values(name), lambda d, name=name: d.GetPointData().GetArray(name)) for name in BEAM_ARRAYS},
    **{name: (beam_field(name), lambda d, name=name: d.GetFieldData().GetArray(name)) for name in BEAM_FIELDS},
}
BEAM_TELLS = {
    "array": lambda data, array: array,
    "points": lambda data, array: data.GetPoints(),
    "poly data": lambda data, array: data,
    "point data": lambda data, array: data.GetPointData(),
    "cell data": lambda data, array: data.GetCellData(),
    "field data": lambda data, array: data.GetFieldData(),
    "vertices": lambda data, array: data.GetVerts(),
    "another array": lambda data, array: data.GetPointData().GetArray("timestamp"),
}


# ---------------------------------------------------------------- chains of filters

class Chain:
    """Filters on surfaces and beams; their outputs are compared. What is kept are polygons and cells, or the hits of
    rays."""

    def __init__(self, surfaces, beams, samples):
        self.surfaces, self.beams, self.samples = surfaces, beams, samples
        self.algorithms, self.outputs = [], []

    def make(self, algorithm, *inputs, **properties):
        for port, source in enumerate(inputs):
            if source.IsA("vtkAlgorithm"):
                algorithm.SetInputConnection(port, source.GetOutputPort())
            else:
                algorithm.SetInputDataObject(port, source)
        for name, value in properties.items():
            getattr(algorithm, "Set" + name)(value)
        if algorithm.IsA("vtkAvianLidarEchoFilter"):
            algorithm.SetRaysPerBeam(20)
            algorithm.SetBeamSamples(self.samples)
            algorithm.SetNumberOfThreads(1)
        self.algorithms.append(algorithm)
        self.outputs += [(algorithm, port) for port in range(algorithm.GetNumberOfOutputPorts())]
        return algorithm

    def update(self):
        for algorithm in self.algorithms:
            algorithm.Update()
        return self

    def touch(self):
        """VTK does not execute for a Modified() of what it does not look at (cells, blocks); a user who sees that no filter
        executes calls Modified() on the filter."""
        for algorithm in self.algorithms:
            algorithm.Modified()


def echoes_alone(chain):
    chain.make(al.vtkAvianLidarEchoFilter(), chain.beams, chain.surfaces)


def with_tree(chain):
    tree = chain.make(al.vtkAvianLidarCollisionTree(), chain.surfaces)
    chain.make(al.vtkAvianLidarEchoFilter(), chain.beams, tree)


def with_copied_tree(chain):
    """A filter between hands on copies that share the arrays."""
    tree = chain.make(al.vtkAvianLidarCollisionTree(), chain.surfaces)
    between = vtk.vtkPassThrough()
    between.SetInputConnection(tree.GetOutputPort())
    chain.make(al.vtkAvianLidarEchoFilter(), chain.beams, between)


def with_material(chain):
    material = chain.make(al.vtkAvianLidarMaterial(), chain.surfaces, BlockNamePattern="first")
    material.SetMaterialToCustom()
    chain.make(al.vtkAvianLidarEchoFilter(), chain.beams, material)


def all_that_follows(chain):
    """What reads echoes and beams; the surfaces' positions, too."""
    echo = chain.make(al.vtkAvianLidarEchoFilter(), chain.beams, chain.surfaces)
    chain.make(al.vtkAvianLidarRangeImage(), echo, chain.beams)
    chain.make(al.vtkAvianLidarCloudComparison(), echo, chain.beams)
    chain.make(al.vtkAvianLidarHSBColorMap(), echo)
    chain.make(al.vtkAvianLidarGeodeticTransform(), chain.surfaces, UseFieldDataOrigin=False)


# All kinds of Modified() with the first two, these with the others.
FEW = ("array", "poly data", "field data")
CHAINS = (echoes_alone, with_tree, with_copied_tree, with_material, all_that_follows)
BOTH_WAYS = [(build, samples) for build in CHAINS for samples in (CELLS, RAYS)]


def contents(data, without):
    """All that a data object holds, by name."""
    if not data.IsA("vtkDataSet"):
        return {(i, *key): values for i, leaf in enumerate(leaves_of(data)) for key, values in contents(leaf, without).items()}
    found = {}
    for kind, attributes in (("point", data.GetPointData()), ("cell", data.GetCellData()), ("field", data.GetFieldData())):
        for i in range(attributes.GetNumberOfArrays()):
            array = attributes.GetAbstractArray(i)
            if array.GetName() in without:
                continue
            found[kind, array.GetName()] = (view(array).tobytes() if array.IsA("vtkDataArray") else
                                            [array.GetValue(k) for k in range(array.GetNumberOfValues())])
    if data.IsA("vtkPolyData"):
        found["points"] = view(data.GetPoints().GetData()).tobytes() if data.GetNumberOfPoints() else b""
        for kind in ("Verts", "Lines", "Polys", "Strips"):
            cells = getattr(data, "Get" + kind)()
            found[kind] = [view(a).tolist() for a in (cells.GetOffsetsArray(), cells.GetConnectivityArray())] \
                if cells.GetNumberOfCells() else []
    elif data.IsA("vtkImageData"):
        found["geometry"] = (data.GetExtent(), data.GetOrigin(), data.GetSpacing())
    return found


def differences(one, two):
    return [key for key in one.keys() | two.keys() if one.get(key) != two.get(key)]


class Modified(unittest.TestCase):
    def assert_as_if_new(self, chain, build):
        new = Chain(copy_of(chain.surfaces), copy_of(chain.beams), chain.samples)
        build(new)
        new.update()
        chain.update()
        for (algorithm, port), (other, _) in zip(chain.outputs, new.outputs):
            one, two = (contents(a.GetOutputDataObject(port), WITHOUT) for a in (algorithm, other))
            self.assertEqual(differences(one, two), [], algorithm.GetClassName())

    @staticmethod
    def make(build, surfaces, samples=CELLS):
        chain = Chain(surfaces, copy_of(Modified.beams()), samples)
        build(chain)
        return chain.update()

    @staticmethod
    def beams():
        source = echotools.sensor(40, 2)
        source.Update()
        return source.GetOutput()

    def test_surfaces(self):
        done = 0
        for build, samples in BOTH_WAYS:
            for make in (house, town):
                chain = self.make(build, make(0) if make is house else make(), samples)
                tells = {told: whose for told, whose in TELLS.items() if build in CHAINS[:2] or told in FEW}
                for i in range(len(nodes_of(chain.surfaces))):
                    tells[f"composite {i}"] = lambda leaf, array, i=i: nodes_of(chain.surfaces)[i]
                    tells[f"field data of composite {i}"] = (
                        lambda leaf, array, i=i: nodes_of(chain.surfaces)[i].GetFieldData())
                for edited, (edit, array_of) in SURFACE_EDITS.items():
                    for told, whose in tells.items():
                        with self.subTest(chain=build.__name__, samples=samples, surfaces=make.__name__,
                                          edit=edited, told=told):
                            leaves = leaves_of(chain.surfaces)
                            leaf = leaves[RANDOM.integers(len(leaves))]
                            edit(leaf)
                            whose(leaf, array_of(leaf)).Modified()
                            chain.touch()
                            self.assert_as_if_new(chain, build)
                            done += 1
        print(done, "edits of surfaces")

    def test_beams(self):
        done = 0
        for build, samples in BOTH_WAYS:
            chain = self.make(build, house(0), samples)
            tells = {told: whose for told, whose in BEAM_TELLS.items() if build in CHAINS[:2] or told in FEW}
            for edited, (edit, array_of) in BEAM_EDITS.items():
                for told, whose in tells.items():
                    with self.subTest(chain=build.__name__, samples=samples, edit=edited, told=told):
                        edit(chain.beams)
                        whose(chain.beams, array_of(chain.beams)).Modified()
                        chain.touch()
                        self.assert_as_if_new(chain, build)
                        done += 1
        print(done, "edits of beams")

    def test_the_usual_way(self):
        """NumPy's: the values, then Modified() on the data alone, which VTK sees by itself."""
        for build, samples in BOTH_WAYS:
            for make in (house, town):
                chain = self.make(build, make(0) if make is house else make(), samples)
                for edited, (edit, _) in SURFACE_EDITS.items():
                    with self.subTest(chain=build.__name__, samples=samples, surfaces=make.__name__, edit=edited):
                        edit(leaves_of(chain.surfaces)[-1])
                        chain.surfaces.Modified()
                        self.assert_as_if_new(chain, build)
                for edited, (edit, _) in BEAM_EDITS.items():
                    with self.subTest(chain=build.__name__, samples=samples, edit=edited):
                        edit(chain.beams)
                        chain.beams.Modified()
                        self.assert_as_if_new(chain, build)

    def test_what_did_not_change_is_kept(self):
        for build in (echoes_alone, with_tree, with_copied_tree):
            for make in (house, town):
                # Integrated beams have no rays to count.
                chain = self.make(build, make(0) if make is house else make(), samples=RAYS)
                echo = chain.algorithms[-1]
                builds = [a.GetNumberOfBuilds() for a in chain.algorithms if a.IsA("vtkAvianLidarCollisionTree")]
                self.assertGreater(echo.GetNumberOfTracedRays(), 0)
                tree_builds = echo.GetNumberOfTreeBuilds()
                for told, whose in TELLS.items():
                    whose(leaves_of(chain.surfaces)[0], chain.surfaces).Modified()
                    chain.touch()
                    chain.update()
                    self.assertEqual(echo.GetNumberOfTracedRays(), 0, told)
                for told, whose in BEAM_TELLS.items():
                    whose(chain.beams, chain.beams).Modified()
                    chain.touch()
                    chain.update()
                    self.assertEqual(echo.GetNumberOfTracedRays(), 0, told)
                for name in ("kd", "object_names"):
                    SURFACE_EDITS[name][0](leaves_of(chain.surfaces)[0])
                    chain.surfaces.Modified()
                    chain.update()
                    # A brighter triangle may need some weak paths that were left out before.
                    self.assertLess(echo.GetNumberOfTracedRays(), 20, name)
                self.assertEqual(echo.GetNumberOfTreeBuilds(), tree_builds)
                self.assertEqual(
                    [a.GetNumberOfBuilds() for a in chain.algorithms if a.IsA("vtkAvianLidarCollisionTree")], builds)

    def test_outputs_edited_in_place(self):
        """What follows sees it; the next execution makes what it makes without it."""
        for samples in (CELLS, RAYS):
            with self.subTest(samples=samples):
                self.edit_outputs(samples)

    def edit_outputs(self, samples):
        lidar = echotools.sensor(40, 2)
        surfaces = town()
        chain = Chain(surfaces, lidar, samples)
        tree = chain.make(al.vtkAvianLidarCollisionTree(), surfaces, DisplayLevel=2)
        echo = chain.make(al.vtkAvianLidarEchoFilter(), lidar, tree)
        chain.algorithms.insert(0, lidar)
        chain.outputs += [(lidar, 0), (lidar, 1)]
        chain.update()
        before = [contents(a.GetOutputDataObject(port), WITHOUT) for a, port in chain.outputs]
        last = self.echoes_of(tree, lidar, samples)
        for algorithm, port in chain.outputs:
            if algorithm is echo and port == 0:
                continue  # made anew each time
            data = algorithm.GetOutputDataObject(port)
            arrays = [attributes.GetArray(i) for attributes in (data.GetPointData(), data.GetCellData())
                      for i in range(attributes.GetNumberOfArrays())] + [data.GetPoints().GetData()]
            names = [array.GetName() for array in arrays]
            for i, name in enumerate(names):
                for told in ("array", "data", "attributes"):
                    with self.subTest(output=f"{algorithm.GetClassName()} {port}", array=name, told=told):
                        data = algorithm.GetOutputDataObject(port)
                        array = ([attributes.GetArray(k) for attributes in (data.GetPointData(), data.GetCellData())
                                  for k in range(attributes.GetNumberOfArrays())] + [data.GetPoints().GetData()])[i]
                        values = view(array)
                        values[:] = values * 0.5 if values.dtype.kind == "f" else values[::-1].copy() * 0
                        {"array": array, "data": data, "attributes": data.GetPointData()}[told].Modified()
                        if name == "kd" or array is data.GetPoints().GetData() and algorithm is tree and port == 0:
                            echo.Modified()
                            self.assertTrue(differences(self.echoes_of(tree, lidar, samples), last))
                            echo.Update()
                            self.assertEqual(
                                differences(contents(echo.GetOutput(), WITHOUT), self.echoes_of(tree, lidar, samples)),
                                [])
                        chain.touch()
                        chain.update()
                        for (a, p), values in zip(chain.outputs, before):
                            now = contents(a.GetOutputDataObject(p), WITHOUT)
                            self.assertEqual(differences(now, values), [], (a.GetClassName(), p))

    @staticmethod
    def echoes_of(tree, lidar, samples):
        """Those of a new filter, on copies of the outputs of others as they are now."""
        echo = al.vtkAvianLidarEchoFilter()
        echo.SetRaysPerBeam(20)
        echo.SetBeamSamples(samples)
        for port, source in enumerate((lidar, tree)):
            data = vtk.vtkPolyData()
            data.DeepCopy(source.GetOutput())
            for name in ("tree_checksum",) if source is tree else ():
                data.GetFieldData().RemoveArray(name)
            echo.SetInputDataObject(port, data)
        echo.Update()
        return contents(echo.GetOutput(), WITHOUT)

    def test_nothing_after_a_tree(self):
        """A scene of no blocks is not the one before it."""
        chain = self.make(with_tree, house(0))
        echo = chain.algorithms[-1]
        self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 0)
        echo.SetInputDataObject(1, vtk.vtkMultiBlockDataSet())
        echo.Update()
        self.assertEqual(echo.GetOutput().GetNumberOfPoints(), 0)

    def test_an_array_of_the_wrong_kind_is_an_error_after_a_run_too(self):
        def wrong_cells(data):
            data.GetCellData().AddArray(texts("kd", ["x"] * data.GetNumberOfCells()))

        def wrong_ids(data):
            data.GetCellData().AddArray(texts("object_id", ["x"] * data.GetNumberOfCells()))

        def wrong_names(data):
            add(data.GetFieldData(), "object_names", [1.0, 2.0])

        for edit in (wrong_cells, wrong_ids, wrong_names):
            for bare in (False, True):
                with self.subTest(edit.__name__, bare=bare):
                    data = house(0)
                    if bare:
                        for name in ("object_id",):
                            data.GetCellData().RemoveArray(name)
                        data.GetFieldData().RemoveArray("object_names")
                        for name in ("kd", "ks", "kp"):
                            data.GetCellData().RemoveArray(name)
                    tree = al.vtkAvianLidarCollisionTree()
                    tree.SetInputData(data)
                    heard = echotools.Messages(tree)
                    tree.Update()
                    self.assertEqual(heard.errors, [])
                    edit(data)
                    tree.Update()
                    self.assertEqual(len(heard.errors), 1)
                    self.assertEqual(tree.GetOutput().GetNumberOfCells(), 0)

    def test_a_text_array_of_beams_is_an_error_after_a_run_too(self):
        lidar = echotools.sensor()
        lidar.Update()
        beams = vtk.vtkPolyData()
        beams.DeepCopy(lidar.GetOutput())
        beams.GetPointData().RemoveArray("timestamp")
        echo = echotools.scan(house(0), beams)
        echo.Update()
        heard = echotools.Messages(echo)
        beams.GetPointData().AddArray(texts("timestamp", ["x"] * beams.GetNumberOfPoints()))
        echo.Update()
        self.assertEqual(len(heard.errors), 1)

    def test_of_two_arrays_of_a_name_the_first_counts(self):
        """As GetArray() of VTK says; AddArray() would replace it, SetName() afterwards does not."""
        data = house(0)
        add(data.GetCellData(), "other", np.full(data.GetNumberOfCells(), 0.9))
        data.GetCellData().GetArray("other").SetName("kd")
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(data)
        tree.Update()
        np.testing.assert_array_equal(view(tree.GetOutput().GetCellData().GetArray("kd")), view(data.GetCellData().GetArray("kd")))


if __name__ == "__main__":
    unittest.main()
