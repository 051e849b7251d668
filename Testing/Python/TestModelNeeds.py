# SPDX-License-Identifier: BSD-3-Clause
"""What a scan leaves out stays within the bounds that it states: the examples' own scenes against the full model (that
of speed and accuracy has the same), other air and limits, dark surfaces. TestModelNeedsScenery.py has the scenes that
are not in the repository."""
import math
import unittest

import numpy as np

import echotools
from echotools import CELLS, RAYS
from needstools import BEAM, BEYOND, Found, airport_filters, corridor_filter, needed_and_full


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
        for samples in (CELLS, RAYS):
            with self.subTest(samples=samples):
                self.check_dark_scene(samples)

    def check_dark_scene(self, samples):
        beams = echotools.sensor()
        for kd, modelled in ((2e-4, 0), (5e-4, 1)):
            scene = echotools.town()
            paint = echotools.al.vtkAvianLidarMaterial()
            paint.SetMaterialToCustom()
            paint.SetKd(kd)
            paint.SetKs(0.0)
            paint.SetInputData(scene)
            paint.Update()
            dark = paint.GetOutputDataObject(0)
            beams.SetLowerEnergyLimit(3.6e-8)
            lidar = echotools.scan(dark, beams, ReturnMode=4, BeamSamples=samples)
            found = Found(lidar)
            self.assertEqual(found.fields["secondary_reflections_modelled"], modelled)
            lidar.FullModelOn()
            full = Found(lidar)
            self.assertEqual(full.fields["secondary_reflections_modelled"], 1)
            bound = dict(zip(found.report["beam_id"], found.report["skipped_bound"]))
            lower = found.fields["lower_energy_limit"]
            for unit in found.units.keys() | full.units.keys():
                self.assertLessEqual(
                    abs(found.units.get(unit, lower) - full.units.get(unit, lower)), bound[unit[0]] + 1e-18)


if __name__ == "__main__":
    unittest.main()
