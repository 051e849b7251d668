# SPDX-License-Identifier: BSD-3-Clause
"""What a scan left out and why stands in field data as sentences: with the numbers of the bounds, the same whatever was
known before and however many threads there are."""
import re
import unittest

from avianlidar._cloud import field_values
import echotools

NOTES = ("note_all_left_out", "note_noise", "note_two_reflections", "note_further_reflections", "note_faint_paths", "note_small_objects",
         "note_detail_between_rays", "note_planes", "note_perceivable_range")
TOWN = echotools.town(count=20)


def notes_of(echo, port=0):
    echo.Update()
    return {name: value[0] for name, value in field_values(echo.GetOutput(port)).items() if name.startswith("note_")}


class ModelNotes(unittest.TestCase):
    def test_numbers_are_those_of_the_fields(self):
        echo = echotools.scan(TOWN, echotools.given(echotools.sensor(), LowerEnergyLimit=7e-6), LightEnergyFraction=0.25)
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
                (scanned(), {"all_left_out": "at most", "further_reflections": "not modelled: [^,]*$", "noise": "left out", "two_reflections": "modelled, without", "faint_paths": "left out",
                             "small_objects": "more rays", "planes": "integrated", "perceivable_range": "nothing beyond .* km"}),
                # No light over two reflections reaches such a limit.
                (scanned({"PulseEnergy": 1e-3, "LowerEnergyLimit": 10.0, "UpperEnergyLimit": 20.0}),
                 {"two_reflections": "left out", "further_reflections": "not modelled: .*, which return at most", "perceivable_range": "nothing beyond 0 m"}),
                (scanned(AttenuationCoefficient=0.0, FullModel=True),
                 {"all_left_out": "nothing", "noise": "modelled", "two_reflections": "modelled$", "faint_paths": "followed",
                  "perceivable_range": "without end"}),
                # Each faint path is below the limit, but the bound of their sum is far above it.
                (scanned(LightEnergyThreshold=1), {"all_left_out": "paths over two reflections below the lower energy limit$",
                                                   "faint_paths": "left out below the lower energy limit$"}),
                (scanned({"ReceiverAperture": 0.01}, NumberOfReflections=1, Noise=False, BeamSamples=echotools.RAYS),
                 {"noise": "not modelled", "two_reflections": "not modelled", "further_reflections": "not modelled: paths over two",
                  "planes": "sampled"})):
            notes = notes_of(echo)
            for name, text in expected.items():
                self.assertRegex(notes["note_" + name], "^" + text, name)


if __name__ == "__main__":
    unittest.main()
