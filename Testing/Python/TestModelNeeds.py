# SPDX-License-Identifier: BSD-3-Clause
"""What a scan leaves out stays within the bounds that it states: the examples' own scenes against the full model (that
of speed and accuracy has the same), other air and limits, dark surfaces. What was left out and why stands in field
data as sentences. TestModelNeedsScenery.py has the scenes that are not in the repository."""
import math
import re
import unittest

import numpy as np

import echotools
from avianlidar._cloud import field_values
from echotools import CELLS, RAYS
from needstools import BEAM, BEYOND, Found, airport_filters, compare_units, corridor_filter, needed_and_full

NOTES = ("note_all_left_out", "note_noise", "note_two_reflections", "note_further_reflections", "note_faint_paths",
         "note_small_objects", "note_detail_between_rays", "note_planes", "note_perceivable_range")
TOWN = echotools.town(count=20)


class ModelNeeds(unittest.TestCase):
    def check_fields(self, needed, full):
        f = needed.fields
        lower, pulse = f["lower_energy_limit"], f["pulse_energy"]
        self.assertEqual((f["noise_modelled"], full.fields["noise_modelled"]), (0, 1))
        self.assertEqual(f["secondary_reflections_modelled"], 1)
        self.assertAlmostEqual(f["skipped_energy_bound"] / (1e-3 * lower + f["noise_bound"]), 1.0, places=12)
        # The limit is that of the largest kd + ks, at the range where the air leaves Qlow.
        largest = lower / pulse * math.exp(2.0 * f["attenuation_coefficient"] * f["perceivable_range"])
        self.assertEqual(f["rays_per_beam"], 100)
        rays = 100 if f["beam_samples"] == RAYS else 1024 * math.pi  # of the grid
        self.assertAlmostEqual(f["missed_detail_energy"] / (pulse * largest * (1.0 - 0.05 ** (1.0 / rays))), 1.0,
                               places=6)
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
                dark = echotools.painted(echotools.town(), "Custom", Kd=kd, Ks=0.0)
                lidar = echotools.scan(dark, beams, ReturnMode=4, BeamSamples=samples)
                found = Found(lidar)
                lidar.FullModelOn()
                full = Found(lidar)
                self.assertEqual([one.fields["secondary_reflections_modelled"] for one in (found, full)], [modelled, 1])
                compare_units(self, "a dark town", found, full)


def notes_of(echo, port=0):
    echo.Update()
    return {name: value[0] for name, value in field_values(echo.GetOutput(port)).items() if name.startswith("note_")}


class ModelNotes(unittest.TestCase):
    def test_numbers_are_those_of_the_fields(self):
        echo = echotools.scan(TOWN, echotools.given(echotools.sensor(), LowerEnergyLimit=7e-6),
                              LightEnergyFraction=0.25)
        notes = notes_of(echo)
        self.assertEqual((tuple(notes), notes_of(echo, 1)), (NOTES, notes))
        found = field_values(echo.GetOutput())
        for note, field, unit in (("all_left_out", "skipped_energy_bound", "J"), ("noise", "noise_bound", "J"),
                                  ("faint_paths", "light_energy_constraint_bound", "J"),
                                  ("detail_between_rays", "missed_detail_energy", "J"),
                                  ("perceivable_range", "perceivable_range", "km")):
            number = float(re.search(rf"([-+.e0-9]+) {unit}\b", notes["note_" + note])[1])
            number *= 1000.0 if unit == "km" else 1.0
            self.assertAlmostEqual(number / found[field], 1.0, delta=6e-3, msg=note)
        self.assertIn("(25 % of the lower energy limit)", notes["note_faint_paths"])
        self.assertEqual((found["light_energy_constraint_bound"], found["light_energy_fraction"]), (0.25 * 7e-6, 0.25))

    def test_each_setting_changes_its_notes(self):
        def scanned(sensor=(), **settings):
            return echotools.scan(TOWN, echotools.given(echotools.sensor(), **dict(sensor)), **settings)

        for echo, expected in (
                (scanned(), {"all_left_out": "at most", "further_reflections": "not modelled: [^,]*$",
                             "noise": "left out", "two_reflections": "modelled, without", "faint_paths": "left out",
                             "small_objects": "more rays", "planes": "integrated",
                             "perceivable_range": "nothing beyond .* km"}),
                # No light after two reflections reaches such a limit.
                (scanned({"PulseEnergy": 1e-3, "LowerEnergyLimit": 10.0, "UpperEnergyLimit": 20.0}),
                 {"two_reflections": "left out", "further_reflections": "not modelled: .*, which return at most",
                  "perceivable_range": "nothing beyond 0 m"}),
                (scanned(AttenuationCoefficient=0.0, FullModel=True),
                 {"all_left_out": "nothing", "noise": "modelled", "two_reflections": "modelled$",
                  "faint_paths": "followed", "perceivable_range": "without end"}),
                # Each faint path is below the limit, but the bound of their sum is far above it.
                (scanned(LightEnergyThreshold=1),
                 {"all_left_out": "paths with two reflections below the lower energy limit$",
                  "faint_paths": "left out below the lower energy limit$"}),
                (scanned({"ReceiverAperture": 0.01}, NumberOfReflections=1, Noise=False, BeamSamples=echotools.RAYS),
                 {"noise": "not modelled", "two_reflections": "not modelled",
                  "further_reflections": "not modelled: paths over two", "planes": "sampled"})):
            notes = notes_of(echo)
            for name, text in expected.items():
                self.assertRegex(notes["note_" + name], "^" + text, name)
