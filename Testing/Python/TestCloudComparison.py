# SPDX-License-Identifier: BSD-3-Clause
"""Cloud comparison against brute force on clouds of every shape, closed forms of Eq. 19 and 20 and of the
density-aware Chamfer distance, and bad input."""

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
CHAMFER = {
    "density_aware_chamfer_distance": "GetDensityAwareChamferDistance",
    "density_aware_chamfer_simulated_to_reference": "GetDensityAwareChamferSimulatedToReference",
    "density_aware_chamfer_reference_to_simulated": "GetDensityAwareChamferReferenceToSimulated",
}


def cloud(points, kind=vtkPolyData):
    data = kind()
    holder = vtkPoints()
    holder.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    data.SetPoints(holder)
    return data


def compare(simulated, reference, alpha=None):
    comparison = Comparison()
    if alpha is not None:
        comparison.SetChamferAlpha(alpha)
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
        expected = [
            max(forth.max(), back.max()), forth.max(), back.max(),
            math.sqrt((forth ** 2).mean()), math.sqrt((back ** 2).mean())]
        for (field, getter), value in zip(FIELDS.items(), expected):
            self.assertAlmostEqual(getattr(comparison, getter)(), value, delta=1e-13 * value)
            for port in (0, 1):
                array = comparison.GetOutputDataObject(port).GetFieldData().GetArray(field)
                self.assertEqual(array.GetComponent(0, 0), getattr(comparison, getter)())
                self.assertEqual(array.GetInformation().Get(array.UNITS_LABEL()), "m")
        forth, back = density_aware(a, b, 1.0), density_aware(b, a, 1.0)
        for (field, getter), value in zip(CHAMFER.items(), ((forth + back) / 2, forth, back)):
            self.assertAlmostEqual(getattr(comparison, getter)(), value, delta=1e-13)
            for port in (0, 1):
                array = comparison.GetOutputDataObject(port).GetFieldData().GetArray(field)
                self.assertEqual(array.GetComponent(0, 0), getattr(comparison, getter)())
                self.assertEqual(array.GetInformation().Get(array.UNITS_LABEL()), "1")

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
        for getter in CHAMFER.values():
            self.assertAlmostEqual(getattr(comparison, getter)(), 1 - math.exp(-0.25), places=14)

    def test_swapping_swaps_the_directions(self):
        generator = np.random.default_rng(8)
        a, b = cloud(generator.normal(size=(90, 3))), cloud(generator.normal(size=(40, 3)))
        one, two = compare(a, b)[0], compare(b, a)[0]
        self.assertEqual(one.GetHausdorffDistance(), two.GetHausdorffDistance())
        self.assertEqual(one.GetRMSESimulatedToReference(), two.GetRMSEReferenceToSimulated())


class DensityAware(unittest.TestCase):
    def test_two_points(self):
        for distance, alpha in ((0.0, 1.0), (0.3, 1.0), (0.3, 10.0), (2.0, 0.01), (1e5, 1e6)):
            for value in chamfer([[1.0, 2.0, 3.0]], [[1.0, 2.0, 3.0 + distance]], alpha):
                self.assertAlmostEqual(value, 1 - math.exp(-alpha * distance), delta=1e-15 * (1 + 1e3 * alpha))

    def test_a_cloud_and_itself(self):
        points = np.random.default_rng(30).normal(size=(400, 3))
        self.assertEqual(chamfer(points, points), [0, 0, 0])
        # Every point twice: alone each is the only one for its place; of a pair each is one of two.
        twice = np.repeat(points, 2, axis=0)
        self.assertEqual(chamfer(points, twice), [0.25, 0, 0.5])
        self.assertEqual(chamfer(twice, twice), [0.5, 0.5, 0.5])

    def test_a_point_and_a_heap(self):
        # 1 point at 1 m from 5 in one place: 1 - exp(-1) forth, 1 - exp(-1) / 5 back.
        _, forth, back = chamfer([[0.0, 0.0, 0.0]], np.tile((1.0, 0.0, 0.0), (5, 1)))
        self.assertAlmostEqual(forth, 1 - math.exp(-1), delta=1e-15)
        self.assertAlmostEqual(back, 1 - math.exp(-1) / 5, delta=1e-15)

    def test_brute_force_with_other_alphas(self):
        generator = np.random.default_rng(31)
        a, b = generator.normal(size=(300, 3)), generator.normal(size=(500, 3))
        for alpha in (1e-6, 0.1, 20.0, 1e6):
            total, forth, back = chamfer(a, b, alpha)
            self.assertAlmostEqual(forth, density_aware(a, b, alpha), delta=1e-13)
            self.assertAlmostEqual(back, density_aware(b, a, alpha), delta=1e-13)
            self.assertTrue(0 <= min(total, forth, back) <= max(total, forth, back) <= 1)

    def test_ties_do_not_depend_on_the_order(self):
        # Whole and half numbers: every distance is exact, and most are those to several places.
        generator = np.random.default_rng(32)
        a, b = generator.integers(-8, 8, (600, 3)) / 2.0, generator.integers(-4, 4, (400, 3)) * 1.0
        values = chamfer(a, b)
        self.assertAlmostEqual(values[1], density_aware(a, b, 1.0), delta=1e-13)
        self.assertAlmostEqual(values[2], density_aware(b, a, 1.0), delta=1e-13)
        for _ in range(3):
            generator.shuffle(a)
            generator.shuffle(b)
            np.testing.assert_allclose(chamfer(a, b), values, rtol=1e-13)

    def test_exchange_and_motion(self):
        generator = np.random.default_rng(33)
        a, b = generator.normal(size=(300, 3)), generator.normal(size=(200, 3))
        total, forth, back = chamfer(a, b)
        self.assertEqual(chamfer(b, a), [total, back, forth])
        turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
        np.testing.assert_allclose(chamfer(a @ turn + (5, -7, 3), b @ turn + (5, -7, 3)), [total, forth, back], rtol=1e-12)

    def test_densities_of_one_surface(self):
        """A square of 10 m with 200 points/m2 against others at random with 1, 2 and 4 times as many: the page's table, and a
        closed form where alpha is small."""
        generator = np.random.default_rng(34)

        def square(times):
            return generator.uniform(size=(20000 * times, 3)) * (10.0, 10.0, 0.0)

        sparse = square(1)
        for move, scale, totals in (((0, 0, 0), 1, (0.44, 0.44, 0.47)), ((0, 0, 0.1), 1, (0.48, 0.48, 0.51)),
                                    ((0, 0, 1), 1, (0.79, 0.79, 0.80)), ((0, 0, 0), (0.5, 1, 1), (0.62, 0.68, 0.71))):
            for times, total in zip((1, 2, 4), totals):
                self.assertAlmostEqual(chamfer(square(times) * scale + move, sparse)[0], total, delta=0.01)
        for times in (1, 2, 4):
            _, forth, back = chamfer(square(times), sparse, 1e-6)
            # Cells of random points have areas of a gamma distribution of shape 3.575 (about); the share with a point in it.
            self.assertAlmostEqual(forth, 1 - (1 - (1 + times / 3.575) ** -3.575) / times, delta=0.01)
            self.assertAlmostEqual(back, 1 - times * (1 - (1 + 1 / times / 3.575) ** -3.575), delta=0.01)
            self.assertGreaterEqual(forth, 1 - 1 / times)


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
            for getter in (*FIELDS.values(), *CHAMFER.values()):
                self.assertTrue(math.isnan(getattr(comparison, getter)()))

    def test_alpha_out_of_range(self):
        good = [[0.0, 0.0, 0.0]]
        for alpha in (0.0, -1.0, 9e-7, 2e6, math.inf, math.nan):
            comparison, messages = compare(cloud(good), cloud(good), alpha)
            self.assertEqual(len(messages.errors), 1, messages.all())
            self.assertRegex(messages.errors[0], r"ChamferAlpha is \S+, expected 1e-6 to 1e6 1/m")
            self.assertTrue(math.isnan(comparison.GetDensityAwareChamferDistance()))
            self.assertEqual(comparison.GetOutputDataObject(0).GetNumberOfPoints(), 0)
        comparison.SetChamferAlpha(1e6)
        comparison.Update()
        self.assertEqual(comparison.GetDensityAwareChamferDistance(), 0)

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
        self.assertTrue(math.isnan(comparison.GetDensityAwareChamferDistance()))
        for port in (0, 1):
            self.assertEqual(comparison.GetOutputDataObject(port).GetNumberOfPoints(), 0)


if __name__ == "__main__":
    unittest.main()
