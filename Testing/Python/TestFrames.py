# SPDX-License-Identifier: BSD-3-Clause
"""The least reflectance that is predicted for a sensor is that of a wall which the simulation just sees."""
import unittest

import numpy as np

import avianlidar as al
import exampletools  # noqa: F401: where the examples are
import falloff
import frames

BEAMS = 2000
WALL = falloff.Plane("wall", np.array([0.0, 1.0, 0.0]), 8.0, None)


class Predicted(unittest.TestCase):
    def test_the_least_reflectance_is_just_seen(self):
        """By limits: with a wall a little brighter there is an echo, a little darker none."""
        distance, seen = 60.0, frames.Seen("VLP16")
        wall = falloff.square_on(falloff.Plane("wall", WALL.normal, distance, None), 5)
        for factor, count in ((1.01, 1), (0.99, 0)):
            sensor = al.Sensor("VLP16", directions=[(0, 1, 0)])
            echoes = al.Scan(al.Scene(wall, material=(factor * seen.least(distance), 0, 1)), sensor, noise=False,
                             attenuation_coefficient=falloff.AIR).echoes
            self.assertEqual(len(echoes["distance_m"]), count)
        # By photons half of many beams see such a wall, and a third more of the reflectance is seen by nearly all.
        distance, seen = 40.0, frames.Seen("OS1_64")
        wall = falloff.square_on(falloff.Plane("wall", WALL.normal, distance, None), 5)
        whole = al.Sensor("OS1_64")
        for factor, low, high in ((1.0, 0.4, 0.6), (1.33, 0.85, 1.0)):
            sensor = al.Sensor("OS1_64", directions=[(0, 1, 0)] * BEAMS, background_radiance=0,
                               false_alarms_per_scan=whole.false_alarms_per_scan * BEAMS / whole.beams.number_of_points)
            echoes = al.Scan(al.Scene(wall, material=(factor * seen.least(distance), 0, 1)), sensor,
                             attenuation_coefficient=falloff.AIR).echoes
            share = (np.abs(echoes["distance_m"] - distance) < 5).sum() / BEAMS
            self.assertTrue(low <= share <= high, f"{factor}: {share}")


if __name__ == "__main__":
    unittest.main()
