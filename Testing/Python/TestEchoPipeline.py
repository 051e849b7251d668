# SPDX-License-Identifier: BSD-3-Clause
"""The echo filter in a pipeline: the same bits however it is run, progress and abort. What the tree shows, and the beam
report as a map: azimuth by elevation of status, cost and what was left out."""
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

from avianlidar import vtkAvianLidar as al
from cloudtools import names
from echotools import RAYS, array, arrays, assert_same_bits, copy_of, given, output, scan, sensor, town

# By default all beams of this town are integrated, and none needs a ray: what is about rays traces them. Beams that
# meet the wall, of which more than 100 triangles enter each, have cells.
SAMPLED = {"BeamSamples": RAYS}
TOWN, FEW = town(), town(count=20)
LABELS = ("laser_id", "azimuth", "vertical_angle")


def town_with_wall():
    wall, blocks = vtk.vtkPlaneSource(), town()
    for set_corner, corner in ((wall.SetOrigin, (-20, 100, -2)), (wall.SetPoint1, (20, 100, -2)),
                               (wall.SetPoint2, (-20, 100, 6))):
        set_corner(*corner)
    wall.SetResolution(280, 56)
    wall.Update()
    blocks.SetBlock(blocks.GetNumberOfBlocks(), wall.GetOutput())
    return blocks


def ran(*arguments, **properties):
    echo = scan(*arguments, **properties)
    echo.Update()
    return echo


def shuffled_beams():
    beams, shuffled, points = output(sensor()), vtk.vtkPolyData(), vtk.vtkPoints()
    points.SetDataTypeToDouble()
    shuffled.SetPoints(points)
    shuffled.GetPointData().CopyAllocate(beams.GetPointData())
    for new, old in enumerate(np.random.default_rng(0).permutation(beams.GetNumberOfPoints())):
        points.InsertNextPoint(beams.GetPoint(int(old)))
        shuffled.GetPointData().CopyData(beams.GetPointData(), int(old), new)
    shuffled.GetFieldData().PassData(beams.GetFieldData())
    return shuffled


class EchoPipeline(unittest.TestCase):
    def test_the_same_bits_however_it_is_run(self):
        for town_, properties, views in ((town_with_wall(), {}, {2, 3}), (TOWN, SAMPLED, {4}), (TOWN, {}, {2})):
            reference = ran(town_, NumberOfThreads=1, **properties)
            echoes, report = reference.GetOutput(), reference.GetOutput(1)
            self.assertEqual(echoes.GetPointData().GetScalars().GetName(), "energy")
            self.assertGreater(echoes.GetNumberOfPoints(), 50)
            self.assertEqual(echoes.GetNumberOfVerts(), echoes.GetNumberOfPoints())
            self.assertEqual((report.GetNumberOfPoints(), reference.GetNumberOfTreeBuilds()), (360, 1))
            self.assertLessEqual(set(array(report, "status")), {0, 1, 2, 3, 4})
            lit = np.isin(array(report, "beam_id"), array(echoes, "beam_id"))
            self.assertEqual(set(array(report, "view")[lit]), views)
            others = [ran(town_, NumberOfThreads=threads, **properties) for threads in (0, 3)]
            others.append(ran(town_, shuffled_beams(), **properties))
            tree = al.vtkAvianLidarCollisionTree()  # that comes with the surfaces, of any kind
            tree.SetInputData(town_)
            for rule, volume in ((0, 0), (1, 1), (2, 2), (3, 0)):
                tree.SetSplitRule(rule)
                tree.SetBoundingVolume(volume)
                others += [ran(tree, **properties), ran(copy_of(tree.GetOutput()), **properties)]
                self.assertEqual([other.GetNumberOfTreeBuilds() for other in others[-2:]], [0, 0])
            for constraint, batch in ((True, 0), (False, 1), (False, 2)):  # accelerations change costs alone
                others.append(ran(town_, BeamConstraint=constraint, BatchCollisionDetection=batch, **properties))
            for other in others:
                assert_same_bits(echoes, other.GetOutput())
            append, count = vtk.vtkAppendPolyData(), 0  # pieces, each by itself
            for piece in range(3):
                part = scan(town_, **properties)
                part.UpdatePiece(piece, 3, 0)
                append.AddInputData(copy_of(part.GetOutput()))
                count += part.GetOutput(1).GetNumberOfPoints()
            append.Update()
            self.assertEqual(count, 360)
            assert_same_bits(echoes, append.GetOutput())

    def test_arrays(self):
        """Units are TestGlossary's."""
        echo = ran(TOWN)
        data, names = arrays(echo.GetOutput()), echo.GetOutput().GetFieldData().GetAbstractArray("object_names")
        self.assertTrue(np.all((data["energy"] <= 6.25e-5) & (data["energy"] > 2e-6)))
        np.testing.assert_allclose(data["intensity"], 255 * (data["energy"] - 2e-6) / (6.25e-5 - 2e-6), atol=1)
        self.assertTrue(np.all((data["label_share"] > 0) & (data["label_share"] <= 1)))
        np.testing.assert_allclose(np.linalg.norm(data["points"], axis=1), data["distance_m"], rtol=1e-12)
        azimuth = np.degrees(np.arctan2(data["points"][:, 0], data["points"][:, 1])) % 360
        np.testing.assert_allclose(azimuth * 100, data["azimuth"], atol=1e-6)
        self.assertTrue(names.GetValue(int(data["object_id"][0])).startswith("house "))
        text = str(scan(TOWN, RaysPerBeam=1000000, Seed=-123456789))  # printed, numbers have all their digits
        for line in ("RaysPerBeam: 1000000", "Seed: -123456789", "AttenuationCoefficient: 3.5e-05 1/m",
                     "MaximumCacheSize: 1024 MiB"):
            self.assertIn(line, text)


class TreeDisplay(unittest.TestCase):
    def test_volumes_of_a_level_hold_the_scene(self):
        """Each volume has the form of its kind; together they hold every triangle once, and every point."""
        for volume, (corners, faces) in enumerate(((8, 6), (8, 6), (13 * 24, 12 * 24))):
            tree = al.vtkAvianLidarCollisionTree()
            tree.SetInputData(TOWN)
            tree.SetBoundingVolume(volume)
            for level in (0, 3):
                tree.SetDisplayLevel(level)
                tree.Update()
                shown, scene = tree.GetOutput(1), numpy_support.vtk_to_numpy(tree.GetOutput().GetPoints().GetData())
                node, triangles, depth = (numpy_support.vtk_to_numpy(
                                              shown.GetCellData().GetArray(name)).reshape(-1, faces)
                                          for name in ("node_id", "triangles", "depth"))
                volumes = numpy_support.vtk_to_numpy(shown.GetPoints().GetData()).reshape(-1, corners, 3)
                self.assertEqual(len(volumes), len(set(node[:, 0])))
                self.assertEqual(triangles[:, 0].sum(), 12 * TOWN.GetNumberOfBlocks())
                self.assertEqual((depth.max(), len(volumes) <= 2**level), (level, True))
                held = np.zeros(len(scene), dtype=bool)
                for points in volumes:
                    if corners == 8:
                        axes = 0.5 * (points[[1, 2, 4]] - points[0])
                        away = (scene - points.mean(axis=0)) @ axes.T / (axes**2).sum(axis=1)
                        held |= (np.abs(away) < 1 + 1e-6).all(axis=1)
                        if volume == 0:
                            np.testing.assert_allclose(axes, np.diag(np.diag(axes)), atol=1e-9)
                        np.testing.assert_allclose(axes @ axes.T, np.diag((axes**2).sum(axis=1)),
                                                   atol=1e-6 * (axes**2).sum())
                    else:
                        center, radius = 0.5 * (points[0] + points[-1]), 0.5 * np.linalg.norm(points[0] - points[-1])
                        np.testing.assert_allclose(np.linalg.norm(points - center, axis=1), radius, rtol=1e-9)
                        held |= np.linalg.norm(scene - center, axis=1) < radius * (1 + 1e-6)
                self.assertTrue(held.all())
                # The faces of a box look outwards, and none is twisted: they enclose what its edges span.
                if corners == 8:
                    quads = numpy_support.vtk_to_numpy(shown.GetPolys().GetConnectivityArray()).reshape(-1, 4)
                    a, b, c, d = np.moveaxis(volumes.reshape(-1, 3)[quads], 1, 0)
                    enclosed = ((a + b + c + d) * np.cross(c - a, d - b)).sum(axis=1).reshape(-1, 6).sum(axis=1) / 24
                    edges = volumes[:, [1, 2, 4]] - volumes[:, :1]
                    np.testing.assert_allclose(enclosed, np.abs(np.linalg.det(edges)), rtol=1e-6)
                if (volume, level) == (0, 0):
                    np.testing.assert_allclose(shown.GetBounds(), tree.GetOutput().GetBounds(), rtol=1e-6)


def image_of(echo, beams):
    """The range image as {name: rows by columns}; beams are what is given, or the report."""
    image = al.vtkAvianLidarRangeImage()
    image.SetInputConnection(0, echo.GetOutputPort())
    image.SetInputConnection(1, beams)
    image.Update()
    return {name: array(image.GetOutput(), name).reshape(4, 90).copy() for name in names(image.GetOutput())}


class BeamMap(unittest.TestCase):
    def test_report_has_the_labels_of_its_beams(self):
        """And angles of beams that have no labels."""
        lidar = sensor()
        lidar.Update()
        beams = copy_of(lidar.GetOutput())
        echo = scan(FEW, beams)
        echo.Update()
        for name in LABELS:
            np.testing.assert_array_equal(arrays(echo.GetOutput(1))[name], array(beams, name), name)
            beams.GetPointData().RemoveArray(name)
        echo.Update()
        for name in LABELS[1:]:
            np.testing.assert_allclose(arrays(echo.GetOutput(1))[name], array(lidar.GetOutput(), name), atol=1e-8)

    def test_map_has_the_image_and_the_report(self):
        for orientation in ((0.0, 0.0, 0.0), (20.0, 5.0, -3.0)):
            lidar = given(sensor(), Orientation=orientation)
            echo = scan(FEW, lidar)
            plain, found = image_of(echo, lidar.GetOutputPort()), image_of(echo, echo.GetOutputPort(1))
            self.assertEqual(sorted(plain), ["distance_m", "energy", "object_id"])
            for name, values in plain.items():
                self.assertEqual(found[name].tobytes(), values.tobytes(), name)
            report = arrays(echo.GetOutput(1))
            columns = {"status", "candidates", "nodes_visited", "rays_traced", "skipped", "skipped_bound"}
            self.assertEqual(set(found) - set(plain), columns)
            cell = report["beam_id"] // 4 + 90 * report["laser_id"]
            for name in columns:
                np.testing.assert_array_equal(found[name].ravel()[cell], report[name], name)
            echoes = np.isfinite(found["distance_m"])
            np.testing.assert_array_equal(echoes, np.isin(found["status"], (0, 3)))
            self.assertTrue(echoes.any() and not echoes.all())
