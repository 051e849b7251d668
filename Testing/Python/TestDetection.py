# SPDX-License-Identifier: BSD-3-Clause
"""The example's shares of birds are those of the law of detection, however many birds there are."""
import argparse
import os
import tempfile
import unittest
import unittest.mock

import numpy as np
from scipy.special import erfc

import exampletools  # noqa: F401  (finds the examples)
import birds


def share_of_law(areas, distance):
    """Share of birds of these effective areas (m2) that one pulse of Search905 detects, in daylight: electrons of a target that
    underfills the beam, shared by two range units in any proportion; each unit against the threshold of 15,360 beams."""
    planck_light, threshold, dark, excess = 6.62607015e-34 * 299792458, 664.069, 119.062, 3
    solid_angle, aperture = 2 * np.pi * (1 - np.cos(5.6e-3)), np.pi * 0.05**2

    def electrons(area, far):
        return 0.4 * 3.6e-4 * 905e-9 / planck_light * area / (solid_angle * far**2) * 0.3 * aperture / (np.pi * far**2) * np.exp(-2 * 8.9e-5 * far)

    def probability(n):
        return 0.5 * erfc((threshold - n) / np.sqrt(2 * (dark**2 + excess * n)))
    assert abs(electrons(0.03, 300) - 17535.4) < 1
    split = (np.arange(100) + 0.5) / 100
    n = electrons(np.asarray(areas)[:, None], distance)
    return np.mean(1 - (1 - probability(split * n)) * (1 - probability((1 - split) * n)))


class Birds(unittest.TestCase):
    def test_many_birds_are_detected_as_the_law_says(self):
        count = 300
        options = argparse.Namespace(birds=count, seed=3, ranges=(400, 600))
        with tempfile.TemporaryDirectory() as home, unittest.mock.patch.object(birds, "SPECIES", ("herring gull",)):
            (row,) = birds.draw_detection("Search905", os.path.join(home, "detection.png"), options)[2:]
        cells = [cell.split() for cell in row.strip(" |").split("|")[1:]]
        shares = [float(cell[0]) for cell in cells]
        self.assertGreater(shares[0], 0.85)
        random = np.random.default_rng(5)
        areas = np.concatenate([birds.effective_areas("herring gull", False, random) for _ in range(4)])
        for share, cell, distance in zip(shares, cells, options.ranges):
            law = share_of_law(areas, distance)
            error = np.sqrt(law * (1 - law) / count)
            self.assertLess(abs(share - law), 4 * np.sqrt(2) * error, (distance, share, law))
            self.assertEqual(cell[1], "±")
            self.assertAlmostEqual(float(cell[2]), np.sqrt(share * (1 - share) / count), delta=2e-3)


if __name__ == "__main__":
    unittest.main()
