# SPDX-License-Identifier: BSD-3-Clause
"""Cloud comparison against brute force on clouds of every shape, closed forms of Eq. 19 and 20, and bad input."""

import math
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkIOGeometry import vtkSTLReader

from avianlidar.vtkAvianLidar import vtkAvianLidarCloudComparison as Comparison

from cloudtools import cloud
from echotools import Messages, given

FIELDS = {
    "hausdorff_distance": "GetHausdorffDistance",
    "hausdorff_simulated_to_reference": "GetHausdorffSimulatedToReference",
    "hausdorff_reference_to_simulated": "GetHausdorffReferenceToSimulated",
    "rmse_simulated_to_reference": "GetRMSESimulatedToReference",
    "rmse_reference_to_simulated": "GetRMSEReferenceToSimulated",
}
CHAMFER = {
    "density_aware_chamfer_distance": "GetDensityAwareChamferDistance",
    "density_aware_chamfer_simulated_to_reference": "GetDensityAwareChamferSimulatedToReference",
    "density_aware_chamfer_reference_to_simulated": "GetDensityAwareChamferReferenceToSimulated",
}


def compare(simulated, reference, alpha=None):
    return compared(given(Comparison(), **({} if alpha is None else {"ChamferAlpha": alpha})), simulated, reference)


def compared(comparison, simulated, reference):
    """It with other clouds, and what it says."""
    comparison.SetInputDataObject(0, simulated)
    comparison.SetInputDataObject(1, reference)
    messages = Messages(comparison)
    comparison.Update()
    return comparison, messages


def nearest(a, b):
    a, b = np.asarray(a, float), np.asarray(b, float)
    return np.sqrt(np.array([((b - p) ** 2).sum(axis=1).min() for p in a]))


def density_aware(a, b, alpha):
    """One direction, by its definition: of equally near places of b the first by x, y, z."""
    a, b = np.asarray(a, float), np.unique(np.asarray(b, float), axis=0)
    squares = np.array([(p[0] - b[:, 0]) ** 2 + (p[1] - b[:, 1]) ** 2 + (p[2] - b[:, 2]) ** 2 for p in a])
    place = squares.argmin(axis=1)
    return (1 - np.exp(-alpha * np.sqrt(squares.min(axis=1))) / np.bincount(place)[place]).mean()


def chamfer(simulated, reference, alpha=None):
    """The distance and its two directions."""
    comparison, messages = compare(cloud(simulated), cloud(reference), alpha)
    assert not messages.all(), messages.all()
    return [getattr(comparison, getter)() for getter in CHAMFER.values()]


class BruteForce(unittest.TestCase):
    def check(self, a, b):
        comparison, messages = compare(cloud(a), cloud(b))
        self.assertEqual(messages.all(), [])
        forth, back = nearest(a, b), nearest(b, a)
        # Both sides round a handful of operations on the same doubles.
        for port, expected in ((0, forth), (1, back)):
            array = comparison.GetOutputDataObject(port).GetPointData().GetArray("nearest_distance")
            np.testing.assert_allclose(vtk_to_numpy(array), expected, rtol=1e-15, atol=0)
        expected = [max(forth.max(), back.max()), forth.max(), back.max(), math.sqrt((forth ** 2).mean()),
                    math.sqrt((back ** 2).mean())]
        self.check_fields(comparison, FIELDS, expected, "m")
        forth, back = density_aware(a, b, 1.0), density_aware(b, a, 1.0)
        self.check_fields(comparison, CHAMFER, ((forth + back) / 2, forth, back), "1")

    def check_fields(self, comparison, fields, expected, unit):
        for (field, getter), value in zip(fields.items(), expected, strict=True):
            self.assertAlmostEqual(getattr(comparison, getter)(), value, delta=1e-13 * (value if unit == "m" else 1))
            for port in (0, 1):
                array = comparison.GetOutputDataObject(port).GetFieldData().GetArray(field)
                self.assertEqual(array.GetComponent(0, 0), getattr(comparison, getter)())
                self.assertEqual(array.GetInformation().Get(array.UNITS_LABEL()), unit)

    def test_clouds_of_every_shape(self):
        """Sizes of one and more, far apart, flat, straight, in one place, in clusters, far from the origin, and in
        single precision."""
        draw = np.random.default_rng(1920)
        plane = draw.uniform(size=(200, 3)) * (10.0, 10.0, 0.0)
        line, heap = plane * (1.0, 0.0, 0.0), np.ones((20, 3))
        clusters = np.vstack([draw.normal(scale=0.01, size=(60, 3)) + c
                              for c in ((0, 0, 0), (1000, 0, 0), (0, 1000, 50), (-3000, 2, 1))])
        utm = np.array((338036.3, 3453012.2, 3.0))
        for a, b in (*((draw.normal(size=(n, 3)), draw.normal(size=(m, 3))) for n, m in ((1, 1), (1, 50), (300, 200))),
                     *((a, b) for a in (plane, line, heap) for b in (plane[::-1], line, heap)),
                     (line, line + (5e3, -2e3, 40.0)), (clusters, draw.uniform(-3000.0, 3000.0, (200, 3))),
                     (plane + utm, draw.uniform(size=(200, 3)) * 50 + utm),
                     (plane.astype(np.float32), draw.uniform(size=(90, 3)))):
            self.check(a, b)

    def test_type_of_points_is_kept(self):
        comparison, _ = compare(cloud([[0.0, 0.0, 0.0]], vtkUnstructuredGrid), cloud([[1.0, 0.0, 0.0]]))
        self.assertIsInstance(comparison.GetOutputDataObject(0), vtkUnstructuredGrid)
        self.assertIsInstance(comparison.GetOutputDataObject(1), vtkPolyData)


class ClosedForms(unittest.TestCase):
    def test_each_direction_is_divided_by_its_own_number_of_points(self):
        # Simulated: one point. Reference: three points at 3, 4 and 12 m from it.
        a, b = cloud([[0.0, 0.0, 0.0]]), cloud([[3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 12.0]])
        for comparison, turned in ((compare(a, b)[0], False), (compare(b, a)[0], True)):
            forth, back = (3.0, math.sqrt((9 + 16 + 144) / 3))[::-1 if turned else 1]
            self.assertAlmostEqual(comparison.GetRMSESimulatedToReference(), forth, places=14)
            self.assertAlmostEqual(comparison.GetRMSEReferenceToSimulated(), back, places=14)
            self.assertEqual([comparison.GetHausdorffSimulatedToReference(),
                              comparison.GetHausdorffReferenceToSimulated()], [3.0, 12.0][::-1 if turned else 1])
            self.assertEqual(comparison.GetHausdorffDistance(), 12.0)


class DensityAware(unittest.TestCase):
    def test_ties_do_not_depend_on_the_order(self):
        # Whole and half numbers: every distance is exact, and most are those to several places.
        draw = np.random.default_rng(32)
        a, b = draw.integers(-8, 8, (300, 3)) / 2.0, draw.integers(-4, 4, (200, 3)) * 1.0
        for alpha in (1e-6, 20.0, 1e6, 1.0):
            values = chamfer(a, b, alpha)
            self.assertAlmostEqual(values[1], density_aware(a, b, alpha), delta=1e-13)
            self.assertAlmostEqual(values[2], density_aware(b, a, alpha), delta=1e-13)
        draw.shuffle(a)
        draw.shuffle(b)
        np.testing.assert_allclose(chamfer(a, b), values, rtol=1e-13)


class BadInput(unittest.TestCase):
    def test_every_kind(self):
        good, empty, infinite = [[0.0, 0.0, 0.0]], np.empty((0, 3)), [[math.inf, 0.0, 0.0]]
        for a, b, alpha, text in (
                (empty, good, 1, "input port 0 (simulated cloud) has no points"),
                (good, infinite, 1, "input port 1 (reference cloud): point 0"),
                (good, good, 9e-7, "ChamferAlpha is ")):
            comparison, _ = compare(cloud(good), cloud([[1.0, 0.0, 0.0]]))  # whose result is forgotten
            self.assertEqual(comparison.GetHausdorffDistance(), 1.0)
            comparison.SetChamferAlpha(alpha)
            _, messages = compared(comparison, cloud(a), cloud(b))
            self.assertIn(text, " ".join(messages.errors))
            for port in (0, 1):
                self.assertEqual(comparison.GetOutputDataObject(port).GetNumberOfPoints(), 0)
            for getter in (*FIELDS.values(), *CHAMFER.values()):
                self.assertTrue(math.isnan(getattr(comparison, getter)()), getter)
            comparison.SetChamferAlpha(1e6)
            compared(comparison, cloud(good), cloud(good))
            self.assertEqual(comparison.GetDensityAwareChamferDistance(), 0)

    def test_a_source_without_its_file(self):
        reader = vtkSTLReader()
        reader.SetFileName("missing.stl")
        comparison, _ = compare(cloud([(0, 0, 0)]), cloud([(1, 0, 0)]))
        self.assertEqual(comparison.GetHausdorffDistance(), 1)
        Messages(reader, comparison)
        comparison.SetInputConnection(1, reader.GetOutputPort())
        comparison.Update()
        self.assertTrue(math.isnan(comparison.GetHausdorffDistance()))
