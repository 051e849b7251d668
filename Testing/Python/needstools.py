# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of model needs share: results of an echo filter, and whether what it left out is within its bounds."""
import pathlib
import sys

import exampletools as et  # finds the examples
import airport
import corridor

BEAM, NOISE, BEYOND = 2, 4, 8
FIELDS = ("lower_energy_limit", "pulse_energy", "noise_modelled", "noise_bound", "secondary_reflections_modelled",
          "perceivable_range", "skipped_energy_bound", "missed_detail_energy", "light_energy_constraint_bound",
          "attenuation_coefficient", "rays_per_beam", "beam_samples", "full_model")
OUT = pathlib.Path(sys.argv[-1]).stem  # folder of what the examples leave, one for each test


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


def airport_filters(name, *arguments):
    """(name, echo filter) of each sensor of the airport example; the filters keep their inputs."""
    _, results = airport.main(["--no-pictures", "--rays", "100", "--out", et.folder(OUT), *arguments])
    for preset, (_, lidar, _) in results.items():
        yield f"{name}, {preset}", lidar


def corridor_filter(*arguments):
    return corridor.main(["--no-pictures", "--out", et.folder(OUT), *arguments])[2]


def needed_and_full(test, name, lidar):
    """The filter's results without and with FullModel, range unit by range unit, after they were compared."""
    lidar.SetReturnModeToRangeUnits()
    lidar.FullModelOff()  # it may be on from a comparison that failed
    needed = Found(lidar)
    lidar.FullModelOn()
    full = Found(lidar)
    differing = compare_units(test, name, needed, full)
    test.assertGreater(len(needed.units), 500)
    # Something was left out, or the comparison says nothing.
    test.assertGreater(differing + (needed.report["skipped"] & BEAM != 0).sum(), 5, name)
    _check_reports(test, needed, full)
    # And back: what is known by now changes no echo.
    lidar.FullModelOff()
    test.assertEqual(Found(lidar).units, needed.units)
    return needed, full


def compare_units(test, name, needed, full):
    """Energies within the beam's bound, and what one of the results lacks within it of Qlow; the number of units that
    differ."""
    lower = full.fields["lower_energy_limit"]
    skipped = dict(zip(needed.report["beam_id"], needed.report["skipped"]))
    bound = dict(zip(needed.report["beam_id"], needed.report["skipped_bound"]))
    differing = 0
    for unit in needed.units.keys() | full.units.keys():
        one, other = needed.units.get(unit, lower), full.units.get(unit, lower)
        test.assertLessEqual(abs(one - other), bound[unit[0]] + 1e-12 * other, (name, unit))
        test.assertFalse(skipped[unit[0]] & BEAM, (name, unit))
        differing += one != other
    return differing


def _check_reports(test, needed, full):
    fields, skipped, bound = needed.fields, needed.report["skipped"], needed.report["skipped_bound"]
    test.assertEqual((fields["full_model"], full.fields["full_model"]), (0, 1))
    test.assertEqual((full.fields["skipped_energy_bound"], full.fields["light_energy_constraint_bound"]), (0.0, 0.0))
    test.assertTrue((full.report["skipped"] == 0).all() and (full.report["skipped_bound"] == 0.0).all())
    whole = (skipped & BEAM) != 0
    test.assertTrue((bound[whole] < fields["lower_energy_limit"]).all())
    test.assertTrue((needed.report["status"][whole] == 2).all())
    test.assertTrue((bound[~whole] <= fields["skipped_energy_bound"] * (1.0 + 1e-9)).all())
    test.assertFalse((skipped & BEYOND).any())
    noise = fields["noise_bound"] > 0.0 and not fields["noise_modelled"]
    test.assertTrue((((skipped & NOISE) != 0) == noise).all())
    test.assertTrue((bound[(skipped & ~BEYOND) != 0] > 0.0).all())
