# SPDX-License-Identifier: BSD-3-Clause
"""Scores of tracks: OSPA in closed form and by all permutations, crossings made by hand, errors against the spread of
many draws."""
import itertools
import math
import unittest

import numpy as np
from scipy.spatial.distance import cdist

from avianlidar.apps.sequences import _scores as scores


def brute(distance, cutoff, order):
    """OSPA by all permutations."""
    distance = distance if distance.shape[0] <= distance.shape[1] else distance.T
    m, n = distance.shape
    if n == 0:
        return 0.0
    cut = np.minimum(distance, cutoff) ** order
    least = min(sum(cut[i, j] for i, j in enumerate(of)) for of in itertools.permutations(range(n), m))
    return ((least + cutoff ** order * (n - m)) / n) ** (1.0 / order)


class Ospa(unittest.TestCase):
    def test_closed_forms(self):
        self.assertEqual(scores.ospa(np.zeros((0, 0)), 10.0), (0.0, 0.0, 0.0))
        self.assertEqual(scores.ospa(np.zeros((0, 3)), 10.0), (10.0, 0.0, 10.0))
        self.assertEqual(scores.ospa(np.zeros((2, 0)), 10.0, 1.0), (10.0, 0.0, 10.0))
        # Order 1 is the mean distance of each object: 2 m, 4 m and one that is missing with 10 m.
        self.assertAlmostEqual(scores.ospa([[2.0, 99.0], [99.0, 4.0], [99.0, 99.0]], 10.0, 1.0).distance, 16.0 / 3.0)

    def test_all_permutations_and_parts(self):
        random = np.random.default_rng(1)
        for m, n, order in itertools.product((0, 1, 2, 4), (0, 1, 3, 5), (1.0, 3.5)):
            distance = cdist(random.uniform(0, 30, (m, 3)), random.uniform(0, 30, (n, 3)))
            found = scores.ospa(distance, 12.0, order)
            self.assertAlmostEqual(found.distance, brute(distance, 12.0, order))
            self.assertAlmostEqual(found.distance ** order, found.localisation ** order + found.cardinality ** order)

    def test_other_settings_are_errors(self):
        for cutoff, order in ((0.0, 1.0), (math.nan, 1.0), (1.0, 0.5), (1.0, math.inf)):
            with self.assertRaisesRegex(ValueError, "cutoff is"):
                scores.ospa(np.zeros((1, 1)), cutoff, order)


class Assignment(unittest.TestCase):
    def test_sum_is_least_and_the_cut_off_ends_pairs(self):
        self.assertEqual(scores.assign([[1.0, 2.0], [1.5, 9.0]], 10.0), [(0, 1), (1, 0)])  # not the nearest first
        self.assertEqual(scores.assign([[1.0, 20.0], [3.0, 20.0]], 10.0), [(0, 0)])
        self.assertEqual(scores.assign([[10.0]], 10.0), [])
        self.assertEqual(scores.assign(np.zeros((0, 2)), 10.0), [])

    @staticmethod
    def crossing(swap):
        """Two birds that pass one another 1 m apart; tracks follow them, or swap where they meet. Tracks by bird and
        scan."""
        history, before = {"a": [], "b": []}, {}
        for k in range(11):
            truth = np.array([[k - 5.0, 0.5, 0.0], [5.0 - k, -0.5, 0.0]]) * (4.0, 1.0, 1.0)
            tracks = truth[::-1] if swap and k >= 5 else truth
            before = scores.follow(cdist(truth, tracks), "ab", (7, 8), 3.0, before)
            for bird, of in history.items():
                of.append(before.get(bird))
        return history

    def test_crossings(self):
        for swap, wanted in ((False, [7] * 11), (True, [7] * 6 + [8] * 5)):
            history = self.crossing(swap)
            self.assertEqual(history["a"], wanted)  # pairs stay where they meet
            self.assertEqual([scores.switches(of) for of in history.values()], [swap, swap])

    def test_pairs_stay_within_the_cut_off(self):
        distance = np.array([[2.0, 1.0], [1.0, 2.0]])
        self.assertEqual(scores.follow(distance, "ab", (0, 1), 3.0, {}), {"a": 1, "b": 0})
        self.assertEqual(scores.follow(distance, "ab", (0, 1), 3.0, {"a": 0}), {"a": 0, "b": 1})
        self.assertEqual(scores.follow(distance, "ab", (0, 1), 1.5, {"a": 0}), {"a": 1, "b": 0})
        self.assertEqual(scores.follow(np.zeros((2, 0)), "ab", (), 3.0, {"a": 0}), {})

    def test_switches_over_gaps(self):
        for of, count in (([], 0), ([None, 1, 1], 0), ([1, None, 1], 0), ([1, None, 2], 1), ([1, 2, 1, None, 3], 3)):
            self.assertEqual(scores.switches(of), count)


class Volumes(unittest.TestCase):
    def test_strip(self):
        points = [[0, 0, 1], [100, 10, 60], [100, 10, 60.1], [100, 151, 1], [-1, 0, 1], [201, 0, 1], [200, -150, 0]]
        self.assertEqual(scores.in_wedge(points, (0, 0), (1.0, 0.0), 200.0, (150.0, 0.0), (60.0, 0.0)).tolist(),
                         [True, True, False, False, False, False, True])

    def test_wedge_rises_by_three_degrees(self):
        slope = math.tan(math.radians(3.0))
        on = np.array([[-1000.0, 0.0, 15.0 + 1000.0 * slope]])
        for move, inside in (((0, 0, -0.1), True), ((0, 0, 0.1), False), ((0, 224.9, -1), True),
                             ((0, 225.1, -1), False), ((1001, 0, -60), False), ((-2001, 0, 0), False)):
            found = scores.in_wedge(on + move, (0, 0), (-1.0, 0.0), 3000.0, (75.0, 0.15), (15.0, slope))
            self.assertEqual(bool(found[0]), inside, move)

    def test_entered(self):
        for inside, first in (([[0, 0, 1, 1]], 2), ([[0, 0, 0, 1]], 3), ([[0, 1, 0, 1]], 1),
                              ([[0, 0, 0, 1], [0, 1, 0, 0]], 1), ([[1, 1, 0, 0], [0, 0, 1, 1]], 2),
                              ([[1, 0, 1, 0], [0, 0, 0, 1]], 3)):  # from one volume into the other
            self.assertEqual(np.flatnonzero(scores.entered(np.array(inside, bool)))[0], first)
        for inside in ([[0, 0, 0, 0]], [[1, 1, 1, 0]], [[1, 0, 0, 1]], [[1, 1, 0, 0], [1, 1, 1, 1]], np.zeros((0, 4))):
            self.assertFalse(scores.entered(np.array(inside, bool)).any())


class Errors(unittest.TestCase):
    def test_jackknife_of_a_mean_is_its_error(self):
        values = np.random.default_rng(5).normal(size=50)
        np.testing.assert_allclose(scores.ratio(values, np.ones(50)), scores.mean(values))

    def test_errors_are_the_spread_of_many_draws(self):
        random = np.random.default_rng(6)
        shares, ratios, rates, means = [], [], [], []
        for _ in range(1200):
            shares.append(scores.share(int(random.binomial(60, 0.3)), 60)[:2])
            rates.append(scores.rate(int(random.poisson(25.0)), 0.5)[:2])
            means.append(scores.mean(random.exponential(2.0, 60))[:2])
            scans = random.integers(1, 40, 60)
            ratios.append(scores.ratio(random.binomial(scans, random.beta(2, 3, 60)), scans)[:2])
        for values, wanted in ((shares, 0.3), (ratios, 0.4), (rates, 50.0), (means, 2.0)):
            values, errors = np.transpose(values)
            self.assertAlmostEqual(values.mean() / wanted, 1.0, delta=0.02)
            self.assertAlmostEqual(errors.mean() / values.std(), 1.0, delta=0.06)

    def test_shares_of_0_and_1_have_an_error(self):
        for count in (0, 10):
            self.assertEqual(scores.share(count, 10).value, count / 10)
            self.assertAlmostEqual(scores.share(count, 10).error, math.sqrt(11 / 12 * 1 / 12 / 13))
        self.assertEqual(scores.rate(0, 2.0), (0.0, 0.5, 0))
        for nothing in (scores.share(0, 0), scores.mean([]), scores.ratio([], []), scores.ratio([0.0], [0.0]),
                        scores.rate(0, 0.0)):
            self.assertTrue(math.isnan(nothing.value) and math.isnan(nothing.error))
        self.assertTrue(math.isnan(scores.mean([1.0]).error))
