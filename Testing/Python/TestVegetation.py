# SPDX-License-Identifier: BSD-3-Clause
"""What Testing/Studies/weather/vegetation.py measures of crowns, on beams of known extinction."""
import unittest

import numpy as np

import exampletools  # noqa: F401  (finds the studies)
import vegetation

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

    def test_a_known_extinction_is_found(self):
        depths = np.random.default_rng(1).exponential(1 / EXTINCTION, len(self.enter))
        ranges = np.where(depths < self.leave - self.enter, self.enter + depths, 60.0)
        seen = vegetation.Seen(self.enter, self.leave, ranges)
        numbers, errors = seen.numbers(), vegetation.standard_errors(seen, self.azimuth[self.reached])
        self.assertLess(abs(numbers[3] - EXTINCTION), 3 * errors[3])
        self.assertLess(abs(vegetation.extinction_left(numbers[0], seen.chords) - EXTINCTION), 0.1)
        self.assertLess(errors[3], 0.2)


if __name__ == "__main__":
    unittest.main()
