# SPDX-License-Identifier: BSD-3-Clause
"""What a scan leaves out stays within the bounds that it states: every example, against the full model."""
import math
import unittest

import numpy as np

import echotools
import exampletools as et
import airport
import corridor

SECONDARY, BEAM, NOISE, BEYOND, DIRECT = 1, 2, 4, 8, 16
FIELDS = ("lower_energy_limit", "pulse_energy", "noise_modelled", "noise_bound", "secondary_reflections_modelled",
          "perceivable_range", "skipped_energy_bound", "missed_detail_energy", "light_energy_constraint_bound",
          "attenuation_coefficient", "rays_per_beam", "full_model")


class Found:
    """Echoes and report of the filter as it is now."""

    def __init__(self, lidar):
        lidar.Update()
        # The reports of a scan lit again may share arrays with those of the next.
        self.echoes = {name: values.copy() for name, values in et.arrays(lidar.GetOutput(0)).items()}
        self.report = {name: values.copy() for name, values in et.arrays(lidar.GetOutput(1)).items()}
        self.fields = {name: et.number(lidar.GetOutput(0), name) for name in FIELDS}
        places = self.echoes["distance_m"]
        self.units = {(beam, place): energy for beam, place, energy in
                      zip(self.echoes["beam_id"], places, self.echoes["energy_received"])}


def example_filters():
    """(name, echo filter) of every example; the filters keep their inputs."""
    out = et.folder("ModelNeeds")
    _, results = airport.main(["--no-pictures", "--rays", "100", "--out", out])
    for name, (_, lidar, _) in results.items():
        yield name, lidar
    _, _, lidar = corridor.main(["--no-pictures", "--out", out])
    yield "corridor", lidar


class ModelNeeds(unittest.TestCase):
    def compare(self, name, needed, full):
        """Unit by unit: energies within the beam's bound, and what one of them lacks within it of Qlow."""
        lower = full.fields["lower_energy_limit"]
        skipped = dict(zip(needed.report["beam_id"], needed.report["skipped"]))
        bound = dict(zip(needed.report["beam_id"], needed.report["skipped_bound"]))
        differing = 0
        for unit in needed.units.keys() | full.units.keys():
            one, other = needed.units.get(unit, lower), full.units.get(unit, lower)
            self.assertLessEqual(abs(one - other), bound[unit[0]] + 1e-12 * other, (name, unit))
            self.assertFalse(skipped[unit[0]] & BEAM, (name, unit))
            differing += one != other
        self.assertGreater(len(needed.units), 500)
        # Something was left out, or the comparison says nothing.
        self.assertGreater(differing + (needed.report["skipped"] & BEAM != 0).sum(), 10, name)

    def check_reports(self, needed, full):
        lower = needed.fields["lower_energy_limit"]
        skipped, bound = needed.report["skipped"], needed.report["skipped_bound"]
        self.assertTrue((full.report["skipped"] == 0).all() and (full.report["skipped_bound"] == 0.0).all())
        whole = (skipped & BEAM) != 0
        self.assertTrue((bound[whole] < lower).all())
        self.assertTrue((needed.report["status"][whole] == 2).all())
        self.assertTrue((bound[~whole] <= needed.fields["skipped_energy_bound"] * (1.0 + 1e-9)).all())
        self.assertTrue((skipped & NOISE != 0).all())
        self.assertFalse((skipped & BEYOND).any())
        self.assertTrue((bound > 0.0).all())  # of the noise at least

    def check_fields(self, needed, full):
        f = needed.fields
        lower, pulse = f["lower_energy_limit"], f["pulse_energy"]
        self.assertEqual((f["noise_modelled"], f["full_model"], f["secondary_reflections_modelled"]), (0, 0, 1))
        self.assertEqual((full.fields["noise_modelled"], full.fields["full_model"]), (1, 1))
        self.assertEqual(full.fields["skipped_energy_bound"], 0.0)
        self.assertEqual(full.fields["light_energy_constraint_bound"], 0.0)
        self.assertAlmostEqual(f["skipped_energy_bound"] / (1e-3 * lower + f["noise_bound"]), 1.0, places=12)
        # Of the largest kd + ks, from the range at which air leaves Qlow of it.
        largest = lower / pulse * math.exp(2.0 * f["attenuation_coefficient"] * f["perceivable_range"])
        self.assertAlmostEqual(f["missed_detail_energy"] / (
            pulse * largest * (1.0 - 0.05 ** (1.0 / f["rays_per_beam"]))), 1.0, places=6)
        self.assertTrue(0.1 < largest <= 1.0)

    def test_full_model_is_within_the_bounds(self):
        for name, lidar in example_filters():
            with self.subTest(name):
                lidar.SetReturnModeToRangeUnits()
                needed = Found(lidar)
                lidar.FullModelOn()
                full = Found(lidar)
                self.compare(name, needed, full)
                self.check_reports(needed, full)
                self.check_fields(needed, full)
                # And back: what is known by now changes no echo.
                lidar.FullModelOff()
                again = Found(lidar)
                self.assertEqual(again.units, needed.units)

    def test_bounds_follow_air_and_limits(self):
        """Beams that stay without echoes are not lit again: their bounds are those of the present air and limits."""
        town = echotools.town()
        lidar = echotools.scan(town)
        lower = Found(lidar).fields["lower_energy_limit"]
        before, beyond = None, 0
        for air in (1e-4, 1e-3, 5e-3, 0.01, 0.02, 0.05):
            lidar.SetAttenuationCoefficient(air)
            found = Found(lidar)
            fresh = Found(echotools.scan(town, AttenuationCoefficient=air))
            self.assertEqual(found.units, fresh.units)
            reach = math.log(found.fields["pulse_energy"] * 0.872 / lower) / (2.0 * air)
            self.assertAlmostEqual(found.fields["perceivable_range"] / reach, 1.0, places=8)
            skipped, bound = found.report["skipped"], found.report["skipped_bound"]
            np.testing.assert_array_equal(skipped & BEYOND, fresh.report["skipped"] & BEYOND)
            self.assertTrue((skipped[(skipped & BEYOND) != 0] & BEAM != 0).all())
            beyond += ((skipped & BEYOND) != 0).sum()
            silent = found.report["status"] == 2
            self.assertTrue((bound[silent] < lower).all())
            # In thicker air what stays silent can bring back less.
            if before is not None:
                both = silent & before[0] & (found.report["skipped"] & BEAM != 0)
                self.assertTrue((bound[both] <= before[1][both] * (1.0 + 1e-9)).all())
                self.assertGreater(both.sum(), 5)
            before = silent & (skipped & BEAM != 0), bound
        self.assertGreater(beyond, 20)

    def test_dark_scene_needs_no_second_reflection(self):
        """Where the brightest surface twice returns less than the tolerance, paths over two are not looked for."""
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
            lidar = echotools.scan(dark, beams, ReturnMode=4)
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
