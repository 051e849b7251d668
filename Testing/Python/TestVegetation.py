# SPDX-License-Identifier: BSD-3-Clause
"""What Examples/weather/vegetation.py measures of crowns, on beams of known extinction; foliage simulated before it."""
import os
import sys
import unittest
from unittest import mock

import numpy as np

sys.path.insert(0, os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "weather"))
import vegetation  # noqa: E402

EXTINCTION = 0.7  # 1/m


class Vegetation(unittest.TestCase):
    def setUp(self):
        azimuth, elevation = (angle.ravel() for angle in np.meshgrid(np.radians(np.arange(-8, 8, 0.2)), np.radians(np.arange(-5, 6))))
        self.azimuth = np.degrees(azimuth) % 360
        self.directions = np.stack([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)], axis=1)
        corners = np.array([(x, y, z) for x in (-2, 2) for y in (18, 22) for z in (-1.5, 1.5)], dtype=float)
        self.outline = vegetation.Outline(corners)
        enter, leave = self.outline.crossing(self.directions)
        self.reached = leave > enter
        self.enter, self.leave = enter[self.reached], leave[self.reached]

    def test_rays_cross_a_box(self):
        ahead = vegetation.Outline(self.outline.hull.points).crossing(np.array([(0.0, 1, 0), (0, -1, 0), (0.6, 0.8, 0)]))
        np.testing.assert_allclose([ahead[0][0], ahead[1][0]], (18, 22))
        self.assertLess(ahead[1][1], 0)           # behind the lidar
        self.assertGreater(ahead[0][2], ahead[1][2])  # beside it

    def test_a_known_extinction_is_found(self):
        depths = np.random.default_rng(1).exponential(1 / EXTINCTION, len(self.enter))
        ranges = np.where(depths < self.leave - self.enter, self.enter + depths, 60.0)
        seen = vegetation.Seen(self.enter, self.leave, ranges)
        numbers, errors = seen.numbers(), vegetation.standard_errors(seen, self.azimuth[self.reached])
        self.assertLess(abs(numbers[3] - EXTINCTION), 3 * errors[3])
        self.assertLess(abs(vegetation.extinction_left(numbers[0], seen.chords) - EXTINCTION), 0.1)
        self.assertLess(errors[3], 0.2)

    @mock.patch.multiple(vegetation, SEEDS=2, HALVINGS=5)
    def test_more_leaves_stop_more_beams(self):
        crown = vegetation.Crown("box", "", "OS2_128", (), ())
        ranges = np.where(np.arange(len(self.enter)) % 2, 30.0, self.enter + 1)
        simulated = vegetation.Simulated(crown, self.outline, self.directions[self.reached], vegetation.Seen(self.enter, self.leave, ranges))
        share, _, _, extinction = np.transpose([simulated.numbers(density) for density in (0.1, 1.0, 10.0)])
        self.assertTrue((np.diff(share) < 0).all() and (np.diff(extinction) > 0).all())
        density, there, found = simulated.fitted(0, 0.3)
        self.assertTrue(found and 0.1 < density < 10)
        self.assertAlmostEqual(there[0], 0.3, delta=0.1)


if __name__ == "__main__":
    unittest.main()
