# SPDX-License-Identifier: BSD-3-Clause
"""Cells of vtkPolyData that are no area, lie where no points are, or begin where no cell is: nothing kills the process,
what has no triangles counts for nothing, the rest is an error; and errors count the cells of the user's data."""
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

import echotools
from avianlidar import vtkAvianLidar as al
from echotools import Messages

CORNERS = ((10, -5, -5), (10, 5, -5), (10, 5, 5), (10, -5, 5))
TRIANGLES = ((0, 1, 2), (0, 2, 3))
KINDS = ("Verts", "Lines", "Polys", "Strips")
OFFSETS = "the offsets of its cells do not fit their points"


def cells_of(cells):
    array = vtk.vtkCellArray()
    for cell in cells:
        array.InsertNextCell(len(cell))
        for point in cell:
            array.InsertCellPoint(point)
    return array


def raw_cells(offsets, connectivity, kind):
    """Cells as a file or a script may give them, of 32 or 64 bits."""
    array = vtk.vtkCellArray()
    convert = numpy_support.numpy_to_vtkIdTypeArray if kind == np.int64 else numpy_support.numpy_to_vtk
    array.SetData(*(convert(np.array(values, dtype=kind), deep=True) for values in (offsets, connectivity)))
    return array


def surface(polys=TRIANGLES, points=CORNERS, **others):
    """A wall 10 m away, of the two triangles alone or with other cells; kd is a hundredth of the cell's number."""
    data = vtk.vtkPolyData()
    if points is not None:
        data.SetPoints(vtk.vtkPoints())
        for point in points:
            data.GetPoints().InsertNextPoint(point)
    data.SetPolys(cells_of(polys))
    for kind, cells in others.items():
        getattr(data, "Set" + kind)(cells if isinstance(cells, vtk.vtkCellArray) else cells_of(cells))
    return data


def with_materials(data):
    count = data.GetNumberOfCells()
    for name, values in (("kd", np.arange(count) / 100), ("ks", np.full(count, 0.1)), ("kp", np.full(count, 50.0)),
                         ("object_id", np.arange(count, dtype=np.int32))):
        array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetCellData().AddArray(array)
    return data


def algorithms(data):
    """Each of those that take surfaces."""
    lidar = echotools.sensor(8, 1)
    echo = echotools.scan(data, lidar)
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(data)
    return {"echo": echo, "tree": tree}


class DegenerateCells(unittest.TestCase):
    def errors(self, data):
        """What each algorithm says; all outputs are empty then."""
        said = {}
        for name, algorithm in algorithms(data).items():
            heard = Messages(algorithm)
            algorithm.Update()
            if heard.errors:
                said[name] = heard.errors[0]
                self.assertEqual(algorithm.GetOutput().GetNumberOfPoints(), 0)
        return said

    def assert_same_scene(self, data, expected):
        """Every algorithm makes the same of both, without a word of error; bounds of triangles of no area may differ."""
        self.assertEqual(self.errors(data), {})
        for name, (one, other) in {name: (one, algorithms(expected)[name])
                                   for name, one in algorithms(data).items()}.items():
            with self.subTest(algorithm=name):
                heard = Messages(one, other)
                one.Update()
                other.Update()
                self.assertEqual(heard.errors, [])
                if name == "echo":
                    echotools.assert_same_bits(one.GetOutput(), other.GetOutput())
                else:
                    self.assertEqual(one.GetOutput().GetNumberOfCells(), other.GetOutput().GetNumberOfCells())
                if name == "tree":
                    for array in ("kd", "object_id"):
                        np.testing.assert_array_equal(
                            *(numpy_support.vtk_to_numpy(a.GetOutput().GetCellData().GetArray(array))
                              for a in (one, other)))

    def test_cells_of_few_points_have_no_triangles(self):
        for points in range(3):
            short = tuple(range(points))
            with self.subTest(points=points):
                self.assert_same_scene(surface(Strips=[short]), surface())
                self.assert_same_scene(surface(TRIANGLES + (short,)), surface())
                self.assert_same_scene(surface((short,) + TRIANGLES, Verts=[short], Lines=[short]), surface())
                for empty in (surface([], Strips=[short]), surface([short]), surface([], Verts=[short])):
                    self.assert_same_scene(empty, surface([]))
                    self.assertEqual(algorithms(empty)["tree"].GetNumberOfNodes(), 0)

    def test_cells_without_points(self):
        self.assert_same_scene(surface([], None, Strips=[()]), surface([]))
        self.assert_same_scene(surface([()], None), surface([]))
        said = self.errors(surface(TRIANGLES, None))
        self.assertEqual(list(said), ["echo", "tree"])
        for text in said.values():
            self.assertIn("its cells have points, and there are none", text)

    def test_others_keep_their_arrays(self):
        """Numbers of cells go on over short ones."""
        short = with_materials(surface([(0,), (0, 1, 2), (), (0, 2, 3)], Strips=[(), (1, 2, 3), (0, 1)], Lines=[(0, 1)]))
        tree = algorithms(short)["tree"]
        tree.Update()
        found = numpy_support.vtk_to_numpy(tree.GetOutput().GetCellData().GetArray("kd"))
        np.testing.assert_array_equal(found, np.array([2, 4, 6]) / 100)

    def test_offsets_that_are_none(self):
        bad = {"beyond": [0, 3, 7], "far beyond": [0, 3, 2**31 - 1], "down": [0, 5, 3, 6], "negative": [0, -3, 3, 6],
               "not from 0": [3, 6], "short": [0, 3], "none": []}
        for kind in KINDS:
            for bits in (np.int32, np.int64):
                for name, offsets in bad.items():
                    with self.subTest(kind=kind, bits=bits, offsets=name):
                        data = surface(**{kind: raw_cells(offsets, [0, 1, 2, 0, 2, 3], bits)})
                        said = self.errors(data)
                        self.assertEqual(list(said), ["echo", "tree"])
                        for text in said.values():
                            self.assertIn(OFFSETS, text)

    def test_point_ids_that_are_none(self):
        for kind in ("Polys", "Strips"):
            for bits in (np.int32, np.int64):
                for point in (-1, 4, 99999):
                    with self.subTest(kind=kind, bits=bits, point=point):
                        said = self.errors(surface(**{kind: raw_cells([0, 3], [0, 1, point], bits)}))
                        self.assertEqual(list(said), ["echo", "tree"])
                        for text in said.values():
                            self.assertIn("a cell has a point id outside 0 to 3", text)

    def test_material_counts_cells(self):
        """The Material filter makes arrays for cells: without offsets VTK counts -1 of them."""
        blocks = vtk.vtkMultiBlockDataSet()
        blocks.SetBlock(0, surface(Lines=raw_cells([], [0, 1, 2], np.int64)))
        for data in [surface(**{kind: raw_cells([], [0, 1, 2], np.int64)}) for kind in KINDS] + [blocks]:
            material = al.vtkAvianLidarMaterial()
            material.SetInputData(data)
            heard = Messages(material)
            material.Update()
            self.assertEqual(len(heard.errors), 1)
            self.assertIn(OFFSETS, heard.errors[0])
            self.assertIn("Input port 0", heard.errors[0])

    def test_arrays_of_other_layouts(self):
        """One array for each component, and single bits: the same scene as from arrays of the usual kind."""
        other = with_materials(surface())
        points = vtk.vtkSOADataArrayTemplate["float32"]()
        points.DeepCopy(other.GetPoints().GetData())
        other.GetPoints().SetData(points)
        for name in ("kd", "ks", "kp"):
            array = vtk.vtkSOADataArrayTemplate["float64"]()
            array.DeepCopy(other.GetCellData().GetArray(name))
            array.SetName(name)
            other.GetCellData().AddArray(array)
        bits = vtk.vtkBitArray()
        bits.DeepCopy(other.GetCellData().GetArray("object_id"))
        bits.SetName("object_id")
        other.GetCellData().AddArray(bits)
        self.assert_same_scene(other, with_materials(surface()))

    def test_errors_count_cells_as_the_user_does(self):
        """Not the triangles that polygons and strips are made into, nor what is left without lines and ghosts."""
        quads = [(0, 1, 2, 3)] * 5
        cases = ((surface(quads), 3), (surface(quads, Lines=[(0, 1)] * 3), 6), (surface(quads, Verts=[(0,)]), 5),
                 (surface(quads, Strips=[(0, 1, 3, 2)] * 2), 6), (surface(TRIANGLES * 4), 6),
                 (surface([(0,), (), (0, 1, 2, 3, 0), (0, 1, 2)]), 3))
        for data, cell in cases:
            for name, value in (("kd", -0.5), ("ks", 1.5), ("kp", np.nan), ("object_id", 1e12)):
                with_materials(data)
                if name == "object_id":
                    array = vtk.vtkDoubleArray()
                    array.DeepCopy(data.GetCellData().GetArray(name))
                    array.SetName(name)
                    data.GetCellData().AddArray(array)
                data.GetCellData().GetArray(name).SetComponent(cell, 0, value)
                said = self.errors(data)
                self.assertEqual(list(said), ["echo", "tree"])
                for text in said.values():
                    self.assertIn(f"surfaces: cell {cell}: ", text)
                    self.assertIn(name, text)

    def test_materials_of_what_is_not_there(self):
        """Ghosts, lines and cells without triangles may have any: nothing is made of them."""
        data = with_materials(surface(TRIANGLES + ((0, 1), (0, 1, 2)), Lines=[(0, 1)]))
        ghosts = vtk.vtkUnsignedCharArray()
        ghosts.SetName(vtk.vtkDataSetAttributes.GhostArrayName())
        ghosts.SetNumberOfTuples(data.GetNumberOfCells())
        ghosts.Fill(0)
        ghosts.SetValue(4, 1)
        data.GetCellData().AddArray(ghosts)
        for cell in (0, 3, 4):
            data.GetCellData().GetArray("kd").SetValue(cell, -1.0)
        self.assertEqual(self.errors(data), {})
        data.GetCellData().GetArray("kd").SetValue(2, -1.0)
        self.assertEqual(len(self.errors(data)), 2)


if __name__ == "__main__":
    unittest.main()
