# SPDX-License-Identifier: BSD-3-Clause
"""Cloud comparison against brute force on clouds of every shape, closed forms of Eq. 19 and 20, and bad input."""

import math
import time
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid

from avianlidar.vtkAvianLidar import vtkAvianLidarCloudComparison as Comparison

from echotools import Messages

FIELDS = {
    "hausdorff_distance": "GetHausdorffDistance",
    "hausdorff_simulated_to_reference": "GetHausdorffSimulatedToReference",
    "hausdorff_reference_to_simulated": "GetHausdorffReferenceToSimulated",
    "rmse_simulated_to_reference": "GetRMSESimulatedToReference",
    "rmse_reference_to_simulated": "GetRMSEReferenceToSimulated",
}


def cloud(points, kind=vtkPolyData):
    data = kind()
    holder = vtkPoints()
    holder.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    data.SetPoints(holder)
    return data


def compare(simulated, reference):
    comparison = Comparison()
    comparison.SetInputDataObject(0, simulated)
    comparison.SetInputDataObject(1, reference)
    messages = Messages(comparison)
    comparison.Update()
    return comparison, messages


def nearest(a, b):
    a, b = np.asarray(a, float), np.asarray(b, float)
    return np.sqrt(np.array([((b - p) ** 2).sum(axis=1).min() for p in a]))


class BruteForce(unittest.TestCase):
    def check(self, a, b):
        comparison, messages = compare(cloud(a), cloud(b))
        self.assertEqual(messages.all(), [])
        forth, back = nearest(a, b), nearest(b, a)
        # Both sides round a handful of operations on the same doubles.
        for port, expected in ((0, forth), (1, back)):
            array = comparison.GetOutputDataObject(port).GetPointData().GetArray("nearest_distance")
            np.testing.assert_allclose(vtk_to_numpy(array), expected, rtol=1e-15, atol=0)
        expected = [
            max(forth.max(), back.max()), forth.max(), back.max(),
            math.sqrt((forth ** 2).mean()), math.sqrt((back ** 2).mean())]
        for (field, getter), value in zip(FIELDS.items(), expected):
            self.assertAlmostEqual(getattr(comparison, getter)(), value, delta=1e-13 * value)
            for port in (0, 1):
                array = comparison.GetOutputDataObject(port).GetFieldData().GetArray(field)
                self.assertEqual(array.GetComponent(0, 0), getattr(comparison, getter)())
                self.assertEqual(array.GetInformation().Get(array.UNITS_LABEL()), "m")

    def test_random_clouds(self):
        generator = np.random.default_rng(1920)
        for n, m in ((1, 1), (1, 50), (300, 200), (700, 900)):
            self.check(generator.normal(size=(n, 3)), generator.normal(size=(m, 3)))

    def test_clouds_far_apart(self):
        generator = np.random.default_rng(1921)
        self.check(generator.uniform(size=(100, 3)), generator.uniform(size=(100, 3)) + (5e3, -2e3, 40.0))

    def test_flat_straight_and_coinciding_clouds(self):
        generator = np.random.default_rng(1922)
        plane = generator.uniform(size=(200, 3)) * (10.0, 10.0, 0.0)
        line = generator.uniform(size=(200, 3)) * (10.0, 0.0, 0.0)
        heap = np.ones((20, 3))
        clouds = (plane, line, heap, plane[::-1])
        for a in clouds:
            for b in clouds:
                self.check(a, b)

    def test_clusters_with_voids(self):
        generator = np.random.default_rng(1923)
        clusters = np.vstack([generator.normal(scale=0.01, size=(60, 3)) + c
                              for c in ((0, 0, 0), (1000, 0, 0), (0, 1000, 50), (-3000, 2, 1))])
        self.check(clusters, generator.uniform(-3000.0, 3000.0, (200, 3)))

    def test_utm_coordinates_and_single_precision(self):
        generator = np.random.default_rng(1924)
        shift = np.array((338036.3, 3453012.2, 3.0))
        self.check(generator.uniform(size=(200, 3)) * 50 + shift, generator.uniform(size=(200, 3)) * 50 + shift)
        self.check(generator.uniform(size=(80, 3)).astype(np.float32), generator.uniform(size=(90, 3)))

    def test_type_of_points_is_kept(self):
        comparison, _ = compare(cloud([[0.0, 0.0, 0.0]], vtkUnstructuredGrid), cloud([[1.0, 0.0, 0.0]]))
        self.assertIsInstance(comparison.GetOutputDataObject(0), vtkUnstructuredGrid)
        self.assertIsInstance(comparison.GetOutputDataObject(1), vtkPolyData)


class ClosedForms(unittest.TestCase):
    def test_each_direction_is_divided_by_its_own_number_of_points(self):
        # Simulated: one point. Reference: three points at 3, 4 and 12 m from it.
        comparison, _ = compare(
            cloud([[0.0, 0.0, 0.0]]), cloud([[3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 12.0]]))
        self.assertEqual(comparison.GetRMSESimulatedToReference(), 3.0)
        self.assertAlmostEqual(comparison.GetRMSEReferenceToSimulated(), math.sqrt((9 + 16 + 144) / 3), places=14)
        self.assertEqual(comparison.GetHausdorffSimulatedToReference(), 3.0)
        self.assertEqual(comparison.GetHausdorffReferenceToSimulated(), 12.0)
        self.assertEqual(comparison.GetHausdorffDistance(), 12.0)

    def test_a_cloud_and_itself(self):
        points = np.random.default_rng(7).normal(size=(500, 3))
        comparison, _ = compare(cloud(points), cloud(points))
        self.assertEqual(comparison.GetHausdorffDistance(), 0.0)
        self.assertEqual(comparison.GetRMSEReferenceToSimulated(), 0.0)

    def test_shifted_grid(self):
        grid = np.stack(np.meshgrid(*[np.arange(8.0)] * 3), axis=-1).reshape(-1, 3)
        comparison, _ = compare(cloud(grid + (0.25, 0.0, 0.0)), cloud(grid))
        for getter in FIELDS.values():
            self.assertEqual(getattr(comparison, getter)(), 0.25)

    def test_swapping_swaps_the_directions(self):
        generator = np.random.default_rng(8)
        a, b = cloud(generator.normal(size=(90, 3))), cloud(generator.normal(size=(40, 3)))
        one, two = compare(a, b)[0], compare(b, a)[0]
        self.assertEqual(one.GetHausdorffDistance(), two.GetHausdorffDistance())
        self.assertEqual(one.GetRMSESimulatedToReference(), two.GetRMSEReferenceToSimulated())


class Cost(unittest.TestCase):
    """Processor time on clouds that leave all but a few buckets of a grid empty, over that on a cloud that fills them. Of
    the search itself TestPointTree counts the distances."""
    SIZE = 20000

    @staticmethod
    def seconds(a, b):
        start = time.process_time()
        compare(cloud(a), cloud(b))
        return time.process_time() - start

    def test_no_cloud_is_quadratic(self):
        random = np.random.default_rng(5)
        box = random.uniform(-50, 50, (self.SIZE, 3))
        noise = random.normal(0, 0.02, box.shape)
        even = max(0.05, self.seconds(box, box + noise))

        def with_outliers(count):
            points = box.copy()
            points[:count] = random.uniform(-1e7, 1e7, (count, 3))
            return points

        line = np.outer(np.linspace(0, 100, self.SIZE), (1.0, 2.0, -3.0))
        scales = np.where(np.arange(self.SIZE)[:, None] % 2, 1e-5 * box, 1e3 * box)
        for name, points in (("an outlier", with_outliers(1)), ("ten outliers", with_outliers(10)), ("a line", line),
                             ("one place", np.zeros_like(box)), ("two scales", scales)):
            with self.subTest(name):
                self.assertLess(self.seconds(points, points + noise), 10 * even)
                self.assertLess(self.seconds(points, box), 10 * even)
                self.assertLess(self.seconds(points, points), 10 * even)


class BadInput(unittest.TestCase):
    def test_every_kind(self):
        good, empty = [[0.0, 0.0, 0.0]], np.empty((0, 3))
        bad = [[0.0, 0.0, 0.0], [0.0, math.nan, 0.0]]
        infinite = [[math.inf, 0.0, 0.0]]
        for a, b, text in (
                (empty, good, "input port 0 (simulated cloud) has no points"),
                (good, empty, "input port 1 (reference cloud) has no points"),
                (empty, empty, "input port 0"),
                (bad, good, "input port 0 (simulated cloud): point 1"),
                (good, infinite, "input port 1 (reference cloud): point 0")):
            comparison, messages = compare(cloud(np.array(a)), cloud(np.array(b)))
            self.assertTrue(any(text in said for said in messages.errors), (text, messages.all()))
            for port in (0, 1):
                self.assertEqual(comparison.GetOutputDataObject(port).GetNumberOfPoints(), 0)
            for getter in FIELDS.values():
                self.assertTrue(math.isnan(getattr(comparison, getter)()))

    def test_a_good_result_is_forgotten_after_a_bad_one(self):
        comparison, _ = compare(cloud([[0.0, 0.0, 0.0]]), cloud([[1.0, 0.0, 0.0]]))
        self.assertEqual(comparison.GetHausdorffDistance(), 1.0)
        comparison.AddObserver("ErrorEvent", lambda *_: None)
        comparison.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        comparison.SetInputDataObject(1, cloud(np.empty((0, 3))))
        comparison.Update()
        self.assertTrue(math.isnan(comparison.GetHausdorffDistance()))
        self.assertEqual(comparison.GetOutputDataObject(0).GetNumberOfPoints(), 0)

    def test_abort_leaves_empty_outputs(self):
        points = np.random.default_rng(9).normal(size=(60000, 3))
        comparison = Comparison()
        comparison.SetInputDataObject(0, cloud(points))
        comparison.SetInputDataObject(1, cloud(points))
        seen = []

        def stop(caller, event):
            seen.append(comparison.GetProgress())
            if comparison.GetProgress() > 0.3:
                comparison.SetAbortExecute(1)
        comparison.AddObserver("ProgressEvent", stop)
        comparison.Update()
        self.assertTrue(math.isnan(comparison.GetHausdorffDistance()))
        for port in (0, 1):
            self.assertEqual(comparison.GetOutputDataObject(port).GetNumberOfPoints(), 0)


if __name__ == "__main__":
    unittest.main()
