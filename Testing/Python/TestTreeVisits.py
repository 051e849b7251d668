# SPDX-License-Identifier: BSD-3-Clause
"""How many beams visit each node of the collision tree: what the beam report counts where the search goes node by node,
and the same picture of a scene for every tree; the tree and what comes out of the tree filter stay as they are."""
import os
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

import echotools
from avianlidar import vtkAvianLidar as al
from echotools import Messages

TOWN = echotools.town(count=30)
VOLUMES = ("AABB", "OBB", "Sphere")
RULES = ("Halves", "Median", "PrincipalPlane", "SurfaceAreaHeuristic")


def tree_of(surfaces, volume="AABB", rule="SurfaceAreaHeuristic", leaf_size=4):
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces)
    getattr(tree, f"SetBoundingVolumeTo{volume}")()
    getattr(tree, f"SetSplitRuleTo{rule}")()
    tree.SetMaximumLeafSize(leaf_size)
    return tree


def visits_filter(surfaces, beams, level=8):
    visits = al.vtkAvianLidarTreeVisits()
    for port, source in ((0, beams), (1, surfaces)):
        if source.IsA("vtkAlgorithm"):
            visits.SetInputConnection(port, source.GetOutputPort())
        else:
            visits.SetInputData(port, source)
    visits.SetDisplayLevel(level)
    return visits


def cells(data):
    arrays = data.GetCellData()
    return {arrays.GetArrayName(i): numpy_support.vtk_to_numpy(arrays.GetArray(i)).copy()
            for i in range(arrays.GetNumberOfArrays())}


def nodes(data):
    """The cell arrays, one value for each node, after a check that all faces of a node say the same."""
    found = cells(data)
    numbers, first, inverse = np.unique(found["node_id"], return_index=True, return_inverse=True)
    for name, values in found.items():
        np.testing.assert_array_equal(values, values[first][inverse], name)
    return {"node_id": numbers, **{name: values[first] for name, values in found.items() if name != "node_id"}}


def level_sums(visits, depth):
    """(visits, leaves met) of the whole tree, from the pictures of all its levels."""
    total = leaves = 0
    for level in range(depth + 1):
        visits.SetDisplayLevel(level)
        visits.Update()
        shown = nodes(visits.GetOutput())
        total += shown["visits"][shown["depth"] == level].sum()
    leaves = shown["beams_met"].sum()  # at the last level leaves alone are shown
    return total, leaves


class TreeVisits(unittest.TestCase):
    def test_arrays(self):
        tree, lidar = tree_of(TOWN), echotools.sensor()
        visits = visits_filter(tree, lidar, 5)
        visits.Update()
        tree.SetDisplayLevel(5)
        tree.Update()
        plain, found = cells(tree.GetOutput(1)), cells(visits.GetOutput())
        self.assertEqual(list(plain), ["node_id", "triangles", "depth"])
        self.assertEqual(list(found), ["node_id", "triangles", "depth", "visits", "beams_met"])
        for name, values in plain.items():
            np.testing.assert_array_equal(values, found[name])
        self.assertEqual(tree.GetOutput(1).GetBounds(), visits.GetOutput().GetBounds())
        self.assertEqual(tree.GetOutput(1).GetCellData().GetScalars().GetName(), "depth")
        self.assertEqual(visits.GetOutput().GetCellData().GetScalars().GetName(), "visits")
        units = vtk.vtkDataArray.UNITS_LABEL()
        for name in ("triangles", "depth", "visits", "beams_met"):
            self.assertEqual(visits.GetOutput().GetCellData().GetArray(name).GetInformation().Get(units), "1")
        self.assertEqual(plain["depth"].max(), 5)
        self.assertTrue(((plain["depth"] == 5) | (plain["triangles"] <= 4)).all())

    def test_root_and_children(self):
        lidar = echotools.sensor()
        visits = visits_filter(tree_of(TOWN), lidar, 0)
        visits.Update()
        root = nodes(visits.GetOutput())
        self.assertEqual(root["visits"].tolist(), [lidar.GetOutput().GetNumberOfPoints()])
        visits.SetDisplayLevel(1)
        visits.Update()
        children = nodes(visits.GetOutput())
        self.assertEqual(children["visits"].tolist(), 2 * root["beams_met"].tolist())
        self.assertTrue((children["beams_met"] <= children["visits"]).all() and children["beams_met"].sum() > 0)

    def test_sums_are_what_the_report_counts(self):
        """Boxes turned and spheres: the nodes of the search itself, and of each beam's one packet of rays its list of
        leaves, eight at a time. One beam at a time, as every beam's list is rounded up."""
        lidar = echotools.sensor(30, 2)
        lidar.Update()
        for volume in ("OBB", "Sphere"):
            for rule, leaf_size in zip(RULES, (1, 2, 4, 9)):
                tree = tree_of(TOWN, volume, rule, leaf_size)
                echo = echotools.scan(tree, lidar, RaysPerBeam=40, NumberOfReflections=1, PlaneIntegration=False,
                                      SmallTargets=False)
                echo.Update()
                report = echotools.arrays(echo.GetOutput(1))
                met = 0
                for i in range(0, 60, 3):
                    total, leaves = level_sums(visits_filter(tree, self.one(lidar, i)), tree.GetDepth())
                    self.assertEqual(total + 8 * -(-leaves // 8), report["nodes_visited"][i], (volume, rule, i))
                    met += leaves
                self.assertGreater(met, 20)
                # All beams together: those that meet no leaf cost what they visit, exactly.
                total, leaves = level_sums(visits_filter(tree, lidar), tree.GetDepth())
                cost = report["nodes_visited"].sum()
                self.assertTrue(total + leaves <= cost <= total + 8 * leaves, (total, leaves, cost))

    @staticmethod
    def one(lidar, i):
        """One beam of a scan."""
        beam = vtk.vtkPolyData()
        points = vtk.vtkPoints()
        points.SetDataTypeToDouble()
        points.InsertNextPoint(lidar.GetOutput().GetPoint(i))
        beam.SetPoints(points)
        beam.GetPointData().CopyAllocate(lidar.GetOutput().GetPointData(), 1)
        beam.GetPointData().CopyData(lidar.GetOutput().GetPointData(), i, 0)
        beam.GetFieldData().PassData(lidar.GetOutput().GetFieldData())
        return beam

    def test_every_tree_leads_to_what_is_hit(self):
        lidar = echotools.sensor()
        echo = echotools.scan(TOWN, lidar)
        echo.Update()
        hit = (echotools.array(echo.GetOutput(1), "status") != 1).sum()
        for volume in VOLUMES:
            for rule in RULES:
                visits = visits_filter(tree_of(TOWN, volume, rule), lidar, 0)
                visits.Update()
                root = nodes(visits.GetOutput())
                self.assertGreaterEqual(root["beams_met"][0], hit)
                # At the last level: a beam that hits something has met a leaf.
                visits.SetDisplayLevel(100)
                visits.Update()
                self.assertGreaterEqual(nodes(visits.GetOutput())["beams_met"].sum(), hit)

    def test_surfaces_without_a_tree(self):
        """As the echo filter: one of default options is built, once."""
        lidar = echotools.sensor()
        expected = visits_filter(tree_of(TOWN), lidar)
        expected.Update()
        visits = visits_filter(TOWN, lidar)
        visits.Update()
        for name, values in cells(expected.GetOutput()).items():
            np.testing.assert_array_equal(cells(visits.GetOutput())[name], values)
        # The tree that comes is the one that is shown.
        other = tree_of(TOWN, "Sphere")
        visits.SetInputConnection(1, other.GetOutputPort())
        visits.Update()
        self.assertGreater(visits.GetOutput().GetNumberOfCells(), 10 * expected.GetOutput().GetNumberOfCells())
        visits.SetInputData(1, TOWN)
        visits.Update()
        self.assertEqual(visits.GetOutput().GetNumberOfCells(), expected.GetOutput().GetNumberOfCells())

    def test_embedded_tree_from_a_file(self):
        tree, lidar = tree_of(TOWN, "OBB", "Median"), echotools.sensor()
        tree.EmbedTreeOn()
        writer = vtk.vtkXMLPolyDataWriter()
        writer.SetInputConnection(tree.GetOutputPort())
        writer.SetFileName("TestTreeVisits.vtp")
        writer.SetDataModeToBinary()
        writer.Write()
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName("TestTreeVisits.vtp")
        found, expected = visits_filter(reader, lidar), visits_filter(tree, lidar)
        found.Update()
        expected.Update()
        os.remove("TestTreeVisits.vtp")
        for name, values in cells(expected.GetOutput()).items():
            np.testing.assert_array_equal(cells(found.GetOutput())[name], values)

    def test_the_tree_and_echoes_stay(self):
        tree, lidar = tree_of(TOWN), echotools.sensor()
        echo = echotools.scan(tree, lidar)
        visits = visits_filter(tree, lidar)
        visits.Update()
        echo.Update()
        output, before = tree.GetOutput().GetMTime(), nodes(visits.GetOutput())
        lidar.SetPosition(3.0, 2.0, 1.0)
        visits.Update()
        self.assertFalse(np.array_equal(nodes(visits.GetOutput())["visits"], before["visits"]))
        lidar.SetPosition(0.0, 0.0, 0.0)
        visits.SetDisplayLevel(3)
        visits.Update()
        echo.Update()
        self.assertEqual((tree.GetNumberOfBuilds(), tree.GetOutput().GetMTime()), (1, output))
        self.assertEqual((echo.GetNumberOfTracedRays(), echo.GetNumberOfTreeBuilds()), (0, 0))

    def test_pieces_and_order_do_not_matter(self):
        lidar = echotools.sensor()
        lidar.Update()
        expected = visits_filter(tree_of(TOWN), lidar)
        expected.Update()
        turned = vtk.vtkPolyData()
        turned.DeepCopy(lidar.GetOutput())
        count = turned.GetNumberOfPoints()
        for i in range(count):
            turned.GetPointData().CopyData(lidar.GetOutput().GetPointData(), count - 1 - i, i)
        for beams, piece in ((turned, (0, 1)), (lidar, (1, 3))):
            visits = visits_filter(tree_of(TOWN), beams)
            visits.UpdatePiece(*piece, 0)
            for name, values in cells(expected.GetOutput()).items():
                np.testing.assert_array_equal(cells(visits.GetOutput())[name], values)

    def test_nothing(self):
        lidar = echotools.sensor()
        for visits in (visits_filter(vtk.vtkPolyData(), lidar), visits_filter(TOWN, lidar, -1)):
            heard = Messages(visits)
            visits.Update()
            self.assertEqual((heard.all(), visits.GetOutput().GetNumberOfCells()), ([], 0))
        lidar.SetAzimuthRange(0.0, 1e-9)
        lidar.Update()
        no_beams = vtk.vtkPolyData()
        no_beams.GetFieldData().PassData(lidar.GetOutput().GetFieldData())
        visits = visits_filter(TOWN, no_beams)
        heard = Messages(visits)
        visits.Update()
        self.assertEqual(heard.all(), [])
        self.assertTrue((nodes(visits.GetOutput())["visits"] == 0).all())

    def test_bad_input_is_named(self):
        lidar = echotools.sensor()
        lidar.Update()
        for name, fields in (("direction", False), ("half_beamwidth", True)):
            beams = vtk.vtkPolyData()
            beams.DeepCopy(lidar.GetOutput())
            (beams.GetFieldData() if fields else beams.GetPointData()).RemoveArray(name)
            visits = visits_filter(TOWN, beams)
            heard = Messages(visits)
            visits.Update()
            self.assertRegex(heard.errors[0], rf"Input port 0 \(beams\).*'{name}'")
            self.assertEqual(visits.GetOutput().GetNumberOfCells(), 0)
        bad = vtk.vtkPolyData()
        bad.DeepCopy(TOWN.GetBlock(0))
        bad.GetPoints().SetPoint(0, float("nan"), 0.0, 0.0)
        visits = visits_filter(bad, lidar)
        heard = Messages(visits)
        visits.Update()
        self.assertRegex(heard.errors[0], "Input port 1")


if __name__ == "__main__":
    unittest.main()
