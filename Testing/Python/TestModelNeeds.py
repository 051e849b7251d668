# SPDX-License-Identifier: BSD-3-Clause
"""What a scan leaves out stays within the bounds that it states: the examples' own scenes against the full model (that
of speed and accuracy has the same), other air and limits, dark surfaces. TestModelNeedsScenery.py has the scenes that
are not in the repository."""
import math
import unittest

import numpy as np

import echotools
from echotools import CELLS, RAYS
from needstools import BEAM, BEYOND, Found, airport_filters, compare_units, corridor_filter, needed_and_full


class ModelNeeds(unittest.TestCase):
    def check_fields(self, needed, full):
        f = needed.fields
        lower, pulse = f["lower_energy_limit"], f["pulse_energy"]
        self.assertEqual((f["noise_modelled"], full.fields["noise_modelled"]), (0, 1))
        self.assertEqual(f["secondary_reflections_modelled"], 1)
        self.assertAlmostEqual(f["skipped_energy_bound"] / (1e-3 * lower + f["noise_bound"]), 1.0, places=12)
        # Of the largest kd + ks, from the range at which air leaves Qlow of it.
        largest = lower / pulse * math.exp(2.0 * f["attenuation_coefficient"] * f["perceivable_range"])
        self.assertEqual(f["rays_per_beam"], 100)
        rays = 100 if f["beam_samples"] == RAYS else 1024 * math.pi  # of the grid
        self.assertAlmostEqual(f["missed_detail_energy"] / (pulse * largest * (1.0 - 0.05 ** (1.0 / rays))), 1.0, places=6)
        self.assertTrue(0.1 < largest <= 1.0)

    def test_full_model_is_within_the_bounds(self):
        scenes = (*airport_filters("airport"), *airport_filters("airport of walls", "--all-wall"),
                  ("corridor", corridor_filter()))
        for name, lidar in scenes:
            # Sampled, the corridor leaves out too little to compare.
            for samples in (CELLS,) if name == "corridor" else (CELLS, RAYS):
                with self.subTest(name, samples=samples):
                    lidar.SetBeamSamples(samples)
                    self.check_fields(*needed_and_full(self, name, lidar))

    def test_bounds_follow_air_and_limits(self):
        """Beams that stay without echoes are not lit again: their bounds are those of the present air and limits."""
        for samples in (CELLS, RAYS):
            with self.subTest(samples=samples):
                self.check_bounds_in_air(samples)

    def check_bounds_in_air(self, samples):
        town = echotools.town()
        lidar = echotools.scan(town, BeamSamples=samples)
        lower = Found(lidar).fields["lower_energy_limit"]
        before, beyond, compared = None, 0, 0
        for air in (1e-4, 1e-3, 5e-3, 0.01, 0.02, 0.05):
            lidar.SetAttenuationCoefficient(air)
            found = Found(lidar)
            fresh = Found(echotools.scan(town, AttenuationCoefficient=air, BeamSamples=samples))
            self.assertEqual(found.units, fresh.units)
            reach = math.log(found.fields["pulse_energy"] * 0.872 / lower) / (2.0 * air)
            self.assertAlmostEqual(found.fields["perceivable_range"] / reach, 1.0, places=8)
            skipped, bound = found.report["skipped"], found.report["skipped_bound"]
            np.testing.assert_array_equal(skipped & BEYOND, fresh.report["skipped"] & BEYOND)
            self.assertTrue(((skipped[(skipped & BEYOND) != 0] & BEAM) != 0).all())
            beyond += ((skipped & BEYOND) != 0).sum()
            silent = found.report["status"] == 2
            self.assertTrue((bound[silent] < lower).all())
            # In thicker air what stays silent can bring back less.
            if before is not None:
                both = silent & before[0] & ((skipped & BEAM) != 0)
                self.assertTrue((bound[both] <= before[1][both] * (1.0 + 1e-9)).all())
                compared += both.sum()
            before = silent & ((skipped & BEAM) != 0), bound
        self.assertGreater(beyond, 20)
        self.assertGreater(compared, 25)

    def test_dark_scene_needs_no_second_reflection(self):
        """Where the brightest surface twice returns less than the tolerance, paths over two are not looked for."""
        beams = echotools.sensor()
        beams.SetLowerEnergyLimit(3.6e-8)
        for samples, kd, modelled in ((CELLS, 2e-4, 0), (CELLS, 5e-4, 1), (RAYS, 2e-4, 0), (RAYS, 5e-4, 1)):
            with self.subTest(samples=samples, kd=kd):
                paint = echotools.al.vtkAvianLidarMaterial()
                paint.SetMaterialToCustom()
                paint.SetKd(kd)
                paint.SetKs(0.0)
                paint.SetInputData(echotools.town())
                paint.Update()
                lidar = echotools.scan(paint.GetOutputDataObject(0), beams, ReturnMode=4, BeamSamples=samples)
                found = Found(lidar)
                lidar.FullModelOn()
                full = Found(lidar)
                self.assertEqual([one.fields["secondary_reflections_modelled"] for one in (found, full)], [modelled, 1])
                compare_units(self, "a dark town", found, full)


if __name__ == "__main__":
    unittest.main()
