# SPDX-License-Identifier: BSD-3-Clause
"""What a scan left out and why stands in field data as sentences: with the numbers of the bounds, the same whatever was
known before and however many threads there are."""
import re
import unittest

import echotools

NOTES = ("note_all_left_out", "note_noise", "note_two_reflections", "note_further_reflections", "note_faint_paths", "note_small_objects",
         "note_detail_between_rays", "note_planes", "note_perceivable_range")
TOWN = echotools.town(count=20)


def fields(data):
    """{name: first value} of field data."""
    all_fields = data.GetFieldData()
    return {all_fields.GetArrayName(i): all_fields.GetAbstractArray(i).GetVariantValue(0)
            for i in range(all_fields.GetNumberOfArrays())}


def notes_of(echo, port=0):
    echo.Update()
    return {name: value.ToString() for name, value in fields(echo.GetOutput(port)).items() if name.startswith("note_")}


class ModelNotes(unittest.TestCase):
    def test_numbers_are_those_of_the_fields(self):
        echo = echotools.scan(TOWN, echotools.given(echotools.sensor(), LowerEnergyLimit=7e-6), LightEnergyFraction=0.25)
        notes = notes_of(echo)
        self.assertEqual((tuple(notes), notes_of(echo, 1)), (NOTES, notes))
        found = {name: value.ToDouble() for name, value in fields(echo.GetOutput()).items()}
        for note, field, unit in (("all_left_out", "skipped_energy_bound", "J"), ("noise", "noise_bound", "J"),
                                  ("further_reflections", "further_reflections_bound", "J"),
                                  ("faint_paths", "light_energy_constraint_bound", "J"),
                                  ("detail_between_rays", "missed_detail_energy", "J"),
                                  ("perceivable_range", "perceivable_range", "km")):
            number = float(re.search(rf"([-+.e0-9]+) {unit}\b", notes["note_" + note])[1])
            number *= 1000.0 if unit == "km" else 1.0
            self.assertAlmostEqual(number / found[field], 1.0, delta=6e-3, msg=note)
        self.assertIn("(25 % of the lower energy limit)", notes["note_faint_paths"])
        self.assertEqual((found["light_energy_constraint_bound"], found["light_energy_fraction"]), (0.25 * 7e-6, 0.25))


if __name__ == "__main__":
    unittest.main()
