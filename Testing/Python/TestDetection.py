# SPDX-License-Identifier: BSD-3-Clause
"""Echoes at an airport are found where they are: polygons and cells invent or miss hardly any, 100 rays many. The example's shares of
birds are those of the law of detection, however many birds there are."""
import argparse
import os
import tempfile
import unittest
import unittest.mock

import numpy as np
from scipy.special import erfc
from vtkmodules.util.numpy_support import vtk_to_numpy

import exampletools  # noqa: F401  (finds the examples)
import birds
from echotools import RAYS
import trade_runs



class Detection(unittest.TestCase):
    def shares(self, name, rays):
        """Invented and missed echoes, over the true ones: by default and with rays alone. The truth has so many rays."""
        subject = trade_runs.Subject(name, "airport16", 2)
        reference = trade_runs.Reference(subject, rays)
        self.assertGreater(len(reference.echoes["beam_id"]), 500)
        found = []
        for settings in ({}, {"BeamSamples": RAYS}):
            judged = [trade_runs.judge(reference, trade_runs.scan(subject, settings, seed)) for seed in range(3)]
            wrong = np.mean([one["missed"] + one["false"] for one in judged])
            found.append(wrong / len(reference.echoes["beam_id"]))
        print(f"{name}: {100 * found[0]:.2f} %, rays alone {100 * found[1]:.2f} %")
        return found

    def test_airport(self):
        default, rays = self.shares("airport", 5000)
        self.assertLess(default, 0.005)
        self.assertGreater(rays, 0.04)

    def test_field_of_poles_rails_and_boxes(self):
        default, rays = self.shares("field", 5000)
        self.assertLess(default, 0.005)
        self.assertGreater(rays, 0.1)


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
        count = 1200
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
            self.assertAlmostEqual(float(cell[2]), np.sqrt(share * (1 - share) / count), delta=1e-3)

    def test_no_bird_is_in_the_beam_of_another(self):
        half_beamwidth = 5.6e-3
        for species, distance in (("Canada goose", 12), ("Canada goose", 100), ("starling", 400)):
            count = birds.most_in_flock(species, distance, half_beamwidth)
            self.assertGreater(count, 1)
            blocks = birds.flock(species, distance, count, np.random.default_rng(1)).surfaces
            data = blocks.GetBlock(0)  # the scene's one part: all birds
            nearest = np.inf
            azimuth, up = 2 * np.pi * np.arange(count) / count, np.radians(birds.ELEVATION)
            axes = np.column_stack([np.sin(azimuth) * np.cos(up), np.cos(azimuth) * np.cos(up), np.full(count, np.sin(up))])
            for k in range(count):
                points = vtk_to_numpy(data.GetBlock(k).GetPoints().GetData()).astype(float)
                cosine = points @ axes.T / np.linalg.norm(points, axis=1)[:, None]
                angle = np.arccos(np.minimum(np.delete(cosine, k, axis=1), 1.0)).min()
                nearest = min(nearest, angle)
            self.assertGreater(nearest, half_beamwidth)


if __name__ == "__main__":
    unittest.main()
