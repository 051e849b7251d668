# SPDX-License-Identifier: BSD-3-Clause
"""Beams that are not round reach echoes, coverage, field data and files. Their rays and energies are tested in
TestBeamShape.cxx."""
import json

import numpy as np

import avianlidar as al
from echotools import InFolder

SHAPE = {"half_beamwidth": 2e-3, "half_beamwidth_across": 1e-3, "beam_outline": "Rectangle", "beam_rotation": 20,
         "beam_profile": "Gaussian", "gaussian_truncation": 2}


class BeamShapes(InFolder):
    def test_a_turn_of_the_sensor_turns_its_beams(self):
        """A slit of light, upright, before two walls side by side; lying, of a sensor that lies on its side."""
        walls = al.Scene([(-9, 50, -9), (0, 50, -9), (0, 50, 9), (-9, 50, 9), (0, 60, -9), (9, 60, -9), (9, 60, 9),
                          (0, 60, 9)], [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)], material=(0.5, 0, 1))
        for roll, direction, count in ((0, (-0.001, 1, 0), 1), (90, (0, 1, 0.001), 2)):
            sensor = al.Sensor("Airport16", directions=[direction], orientation=(0, 0, roll), half_beamwidth=1e-4,
                               half_beamwidth_across=5e-3, range_gate=500)
            echoes = al.Scan(walls, sensor, number_of_reflections=1, noise=False, return_mode="All").echoes
            self.assertEqual(len(np.unique(np.round(echoes["distance_m"] / 10))), count)

    def test_what_coverage_keeps_follows_every_number(self):
        random = np.random.default_rng(5)
        nothing = al.Scene(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), material="Wall")
        azimuth = random.uniform(0, 2 * np.pi, 8)
        places = 200 * np.column_stack([np.cos(azimuth), np.sin(azimuth), np.full(8, 0.05)])
        sensor = al.Sensor("Search905", azimuth_step=2, half_beamwidth=1e-3, half_beamwidth_across=3e-3)
        kept = al.Coverage(nothing, sensor, places=places, species="herring gull")
        before = np.array(kept["detection_probability"])
        for name, value in (("half_beamwidth", 2e-3), ("half_beamwidth_across", 5e-3), ("beam_rotation", 50),
                            ("beam_outline", "Rectangle"), ("beam_profile", "Gaussian"), ("gaussian_truncation", 2),
                            ("orientation", (0.5, 0, 0))):
            sensor.set(**{name: value})
            new = al.Coverage(nothing, sensor, places=places, species="herring gull")
            for array in ("detection_probability", "beams_per_scan", "status"):
                np.testing.assert_array_equal(kept[array], new[array], f"{array} after {name}")
            self.assertFalse(np.array_equal(before, kept["detection_probability"]), name)
            before = np.array(kept["detection_probability"])

    def test_shapes_are_in_field_data_and_files(self):
        fields = {name: float(al.Sensor("Airport16", **SHAPE).beams.fields[name]) for name in SHAPE}
        self.assertEqual(fields, {**SHAPE, "beam_outline": 1, "beam_profile": 1})
        file = self.folder / "mine.lidarsensor.json"
        units = {name: "deg" if "rotation" in name else "rad" if name[:4] == "half" else "1" for name in fields}
        values = {name: {"value": value, "unit": units[name], "source": "made"} for name, value in fields.items()}
        file.write_text(json.dumps({"format": "lidarsensor 1", "name": "Mine", "values": values}))
        read = al.Sensor(file).beams.fields
        self.assertEqual({name: float(read[name]) for name in SHAPE}, fields)
