# SPDX-License-Identifier: BSD-3-Clause
"""What is kept between executions is kept only while it is true: after every change of surfaces, materials, names or
beams, in place or upstream, a pipeline that has run before gives what one that never ran gives."""

import numpy as np
import vtk
from vtk.util import numpy_support

from avianlidar import vtkAvianLidar as al
from echotools import COSTS, Messages, array, assert_same_bits, scan, sensor, town

blocks = town(count=12)
# Some of triangles, which are repainted in place, some of quads.
for number in range(1, blocks.GetNumberOfBlocks(), 2):
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(blocks.GetBlock(number))
    triangles.Update()
    blocks.SetBlock(number, triangles.GetOutput())
lidar = sensor()
paint = al.vtkAvianLidarMaterial()
paint.SetInputDataObject(blocks)
paint.SetBlockNamePattern("house 1*")
paint.SetMaterialToCustom()
tree = al.vtkAvianLidarCollisionTree()
tree.SetInputConnection(paint.GetOutputPort())
chain = scan(tree, lidar)
chain.Update()
tree_builds = tree.GetNumberOfBuilds()


def copy_of(data):
    copy = vtk.vtkPolyData()
    copy.DeepCopy(data)
    return copy


def assert_as_if_new(pipeline, surfaces, beams):
    """Echoes and report of an echo filter that has run before are those of one that never ran, on copies: of the
    report what it found, as costs and bounds of what was skipped may be from before."""
    other = scan(surfaces if surfaces is tree else copy_of(surfaces), beams if beams is lidar else copy_of(beams))
    other.Update()
    assert_same_bits(pipeline.GetOutput(), other.GetOutput())
    assert_same_bits(pipeline.GetOutput(1), other.GetOutput(1), without=(*COSTS, "skipped", "skipped_bound"))


def fresh():
    """A pipeline without a past, on copies of the present data."""
    copy = vtk.vtkMultiBlockDataSet()
    copy.DeepCopy(blocks)
    for i in range(blocks.GetNumberOfBlocks()):
        copy.GetMetaData(i).Copy(blocks.GetMetaData(i))
    other_paint = al.vtkAvianLidarMaterial()
    other_paint.SetInputDataObject(copy)
    other_paint.SetBlockNamePattern(paint.GetBlockNamePattern())
    other_paint.SetMaterialToCustom()
    other_paint.SetKd(paint.GetKd())
    other_paint.SetKs(paint.GetKs())
    other_paint.SetNameOfObject(paint.GetNameOfObject())
    other_tree = al.vtkAvianLidarCollisionTree()
    other_tree.SetInputConnection(other_paint.GetOutputPort())
    lidar.Update()
    beams = copy_of(lidar.GetOutput())
    other = scan(other_tree, beams)
    other.Update()
    return other


def fields(data, name):
    strings = data.GetFieldData().GetAbstractArray(name)
    return [strings.GetValue(i) for i in range(strings.GetNumberOfValues())]


def check(what, noticed=True):
    before = copy_of(chain.GetOutput())
    chain.Update()
    other = fresh()
    assert_same_bits(chain.GetOutput(), other.GetOutput())
    for name in ("object_names", "material_names"):
        assert fields(chain.GetOutput(), name) == fields(other.GetOutput(), name), (what, name)
    checksums = [
        data.GetFieldData().GetAbstractArray("scene_checksum").GetVariantValue(0).ToString()
        for data in (chain.GetOutput(), other.GetOutput(), before)
    ]
    assert checksums[0] == checksums[1], what
    assert (checksums[0] != checksums[2]) == noticed, what


def energies():
    return array(chain.GetOutput(), "energy_received").copy()


check("nothing", noticed=False)

# Materials: no tree is built, no ray is traced for what shines less than before.
for kd in (0.1, 0.05):
    paint.SetKd(kd)
    dark = energies()
    check("kd upstream")
    assert chain.GetNumberOfTracedRays() == 0
    assert not np.array_equal(dark, energies())
assert tree.GetNumberOfBuilds() == tree_builds
paint.SetBlockNamePattern("house 2")
check("another block painted")
paint.SetNameOfObject("painted")
check("another name", noticed=False)
paint.SetNameOfObject("")
check("the old name", noticed=False)
assert tree.GetNumberOfBuilds() == tree_builds

# Arrays changed in place, by whoever owns them.
house = blocks.GetBlock(5)
kd = house.GetCellData().GetArray("kd")
kd.SetValue(0, 0.01)
kd.Modified()
house.Modified()
blocks.Modified()
check("kd in place")
ids = house.GetCellData().GetArray("object_id")
ids.Fill(77)
ids.Modified()
house.Modified()
blocks.Modified()
check("object ids in place", noticed=False)  # houses are told apart by blocks
assert tree.GetNumberOfBuilds() == tree_builds
house.GetPoints().SetPoint(0, 30.0, 31.0, 20.0)
house.GetPoints().Modified()
house.Modified()
blocks.Modified()
check("a corner moved in place")
assert tree.GetNumberOfBuilds() == tree_builds + 1
ghosts = vtk.vtkUnsignedCharArray()
ghosts.SetName(vtk.vtkDataSetAttributes.GhostArrayName())
ghosts.SetNumberOfTuples(house.GetNumberOfCells())
ghosts.Fill(0)
ghosts.SetValue(1, vtk.vtkDataSetAttributes.DUPLICATECELL)
house.GetCellData().AddArray(ghosts)
house.Modified()
blocks.Modified()
check("a cell became a ghost")
blocks.GetMetaData(3).Set(vtk.vtkCompositeDataSet.NAME(), "barn")
blocks.Modified()
check("a block renamed", noticed=False)
blocks.RemoveBlock(7)
blocks.Modified()
check("a block removed")

# Several things at once, and what somebody holds of the surfaces stays as it was.
house = blocks.GetBlock(9)
paint.SetBlockNamePattern("house 2")


def coefficients(data):
    return [numpy_support.vtk_to_numpy(data.GetCellData().GetArray(name)).tobytes() for name in ("kd", "ks", "kp")]


def change(name, values):
    changed = numpy_support.numpy_to_vtk(np.asarray(values), deep=True)
    changed.SetName(name)
    house.GetCellData().AddArray(changed)
    house.Modified()
    blocks.Modified()


for held in (False, True):
    if held:
        shallow, deep = vtk.vtkPolyData(), vtk.vtkPolyData()
        shallow.ShallowCopy(tree.GetOutput())
        deep.DeepCopy(tree.GetOutput())
    cells = house.GetNumberOfCells()
    change("kd", np.linspace(0.01, 0.3, cells) * (0.5 if held else 1.0))
    check("kd of each cell")
    change("kp", np.full(cells, 5.0 + held, dtype=np.float32))
    check("kp of another type")
    change("material_id", np.arange(cells, dtype=np.int32) % (3 + held))
    check("material ids")
    change("kd", np.full(cells, 0.2 + 0.1 * held))
    change("material_id", np.arange(cells, dtype=np.float64) % (2 + held))
    check("kd and material ids")
    change("object_id", np.arange(cells, dtype=np.int32) % (3 - held))
    check("object ids")
    if held:
        assert coefficients(shallow) == coefficients(deep)
        assert coefficients(shallow) != coefficients(tree.GetOutput())
del shallow


# A bad value is an error, again while it stays, and gone when it is mended.
quiet = Messages(tree, chain)
good = np.full(house.GetNumberOfCells(), 0.2)
for other_kd in (0.11, 0.12):
    bad = good.copy()
    bad[-1] = 2.0
    change("kd", bad)
    paint.SetKd(other_kd)
    chain.Update()
    assert quiet.errors and "cell" in quiet.errors[-1], quiet.errors
    quiet.errors.clear()
    assert tree.GetOutput().GetNumberOfCells() == 0
change("kd", good)
check("mended")
assert not quiet.errors

# What comes with the tree is not believed where an array was exchanged behind it, or changed in place.
surfaces = vtk.vtkPolyData()
surfaces.ShallowCopy(tree.GetOutput())
behind = scan(surfaces, lidar)
behind.Update()
assert behind.GetNumberOfTreeBuilds() == 0
assert_same_bits(behind.GetOutput(), chain.GetOutput())
numbers = numpy_support.vtk_to_numpy(surfaces.GetCellData().GetArray("ks")) * 0.5
half = numpy_support.numpy_to_vtk(numbers, deep=True)
half.SetName("ks")
surfaces.GetCellData().AddArray(half)
for change in ("exchanged", "in place"):
    if change == "in place":
        half.SetValue(3, 0.0)
        half.Modified()
        surfaces.Modified()
    behind.Update()
    assert_as_if_new(behind, surfaces, lidar)
    assert not np.array_equal(array(behind.GetOutput(), "energy"), array(chain.GetOutput(), "energy")), change

# Beams.
lidar.SetPulseEnergy(5e-4)
check("pulse energy", noticed=False)
lidar.SetPosition(1.0, 2.0, 3.0)
check("position", noticed=False)
beams = copy_of(lidar.GetOutput())
moved = scan(tree, beams)
moved.Update()
directions = beams.GetPointData().GetArray("direction")
for i in range(0, directions.GetNumberOfTuples(), 3):
    directions.SetTuple3(i, 0.0, 1.0, 0.01 * (i % 5))
directions.Modified()
beams.GetPointData().GetArray("timestamp").SetValue(0, 123.0)
beams.GetPointData().GetArray("timestamp").Modified()
beams.Modified()
moved.Update()
assert_as_if_new(moved, tree, beams)
