# SPDX-License-Identifier: BSD-3-Clause
"""What is counted in real frames, on a made one of which the numbers are known: isolated points and mixed pixels, answers in the empty,
drop-outs on a plane, bright points with a halo, two returns; and the least reflectance that is predicted is that of a wall which the simulation
just sees."""
import unittest

import numpy as np

import avianlidar as al
import exampletools  # noqa: F401: where the examples are
import falloff
import frames
import lacks
import room_data

RINGS, STEP = 12, 1.0  # deg from column to column; rings are 2 deg apart
BEAMS = 2000
WALL = falloff.Plane("wall", np.array([0.0, 1.0, 0.0]), 8.0, None)


def made():
    """A wall 8 m in front, from -30 to 30 deg; sky elsewhere."""
    azimuth, ring = np.tile(np.arange(0, 360, STEP), RINGS), np.repeat(np.arange(RINGS), int(360 / STEP))
    scan = room_data.Scan("made", np.eye(4), azimuth, 2.0 * ring - 11, ring, np.full(len(ring), np.nan), np.full(len(ring), 10.0))
    ahead = np.minimum(azimuth, 360 - azimuth) <= 30
    scan.range[ahead] = WALL.distance / scan.directions()[ahead, 1]
    return scan


def beam(ring, column):
    return ring * int(360 / STEP) + column


class Counted(unittest.TestCase):

    def test_isolated_mixed_and_empty(self):
        scan = made()
        self.assertFalse(any(found.any() for found in frames.Around(scan).isolated(scan.range)))
        scan.range[beam(5, 180)] = 40.0                       # in the sky
        scan.range[beam(5, 10)] = 4.0                         # before the wall
        scan.range[[beam(ring, column) for ring in (8, 9, 10) for column in range(21, 31)]] = 20.0
        scan.range[beam(9, 20)] = 13.0                        # between the wall and what is behind it
        around = frames.Around(scan)
        alone, mixed = around.isolated(scan.range)
        self.assertEqual(set(np.flatnonzero(alone)), {beam(5, 180), beam(5, 10), beam(9, 20)})
        self.assertEqual(set(np.flatnonzero(mixed)), {beam(9, 20)})
        between, spikes = lacks.in_ring(around, scan.range)
        self.assertEqual((list(np.flatnonzero(between)), list(np.flatnonzero(spikes))), ([beam(9, 20)], [beam(5, 10)]))
        empty = frames.Around(scan, *frames.EMPTY).empty(scan.range)
        self.assertEqual(list(np.flatnonzero(empty & scan.answered)), [beam(5, 180)])
        # A beam is not in the empty where the answer is in its 11 columns and 5 rings, nor within 5 columns of the wall.
        self.assertEqual(empty.sum(), RINGS * (299 - 2 * 5) - 5 * 11 + 1)

    def test_drop_outs_on_a_plane(self):
        scan = made()
        scan.range[[beam(4, 3), beam(4, 4), beam(7, 350)]] = np.nan
        scan.range[[beam(2, column) for column in range(1, 1 + falloff.RUN)]] = np.nan  # too many: it may be a thing that is black
        on = falloff.Plane("wall", WALL.normal, WALL.distance, np.arange(scan.answered.sum()))
        lost, off = lacks.off_planes(scan, scan.answered, [on])
        self.assertEqual(lost, [lacks.percent(3, scan.answered.sum() + 3), "0.00 %"])
        self.assertEqual(off, ["0.0", "0.0"])

    def test_halo_and_two_returns(self):
        scan = made()
        shown = np.where(scan.answered, 20.0, np.nan)
        shown[beam(5, 10)], shown[beam(5, 11)], shown[beam(3, 3)] = 220.0, 15.0, 5.0
        bright, halo = lacks.bright_and_halo(frames.Around(scan), scan.range, shown)
        self.assertEqual(list(np.flatnonzero(bright)), [beam(5, 10)])
        self.assertIn(beam(5, 11), np.flatnonzero(halo))
        self.assertNotIn(beam(3, 3), np.flatnonzero(halo))
        steps = lacks.seconds(np.array([1, 2, 1, 3, 2]), np.array([5.0, 4.0, 6.5, 2.0, 4.1]))
        self.assertEqual(list(steps), [1.5])

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

    def test_poisson(self):
        self.assertAlmostEqual(frames.poisson_most(0), 3.689, delta=1e-3)   # -ln 0.025
        self.assertAlmostEqual(frames.poisson_most(2), 7.225, delta=1e-3)   # Garwood 1936


if __name__ == "__main__":
    unittest.main()
