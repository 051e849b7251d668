# SPDX-License-Identifier: BSD-3-Clause
"""Noise of ranges against an independent Monte Carlo of the sampled waveform (pulse, noise in each range unit,
threshold, centroid of the strongest unit and its larger neighbour). Places of false alarms are TestReceiver's
(kernel)."""
import unittest

import numpy as np

import avianlidar as al

UNIT = 0.5 * 299792458.0 * 5e-9  # m
DARK, EXCESS = 119.062, 3.0  # of Search905: sigma0, F (Documentation/reference/sensor-files.md)
PER_JOULE = 0.4 / (6.626e-34 * 299792458.0 / 905e-9)  # electrons
WALL = 200.0  # m, from the middle of the places


def waveform(electrons, threshold, count, seed):
    """(errors of ranges in m of what is perceived, their share). @param electrons of the whole pulse, one unit wide
    @param threshold electrons"""
    random = np.random.default_rng(seed)
    units = np.arange(7)
    place = 3.5 + random.uniform(-0.5, 0.5, (count, 1))
    light = electrons * np.clip(np.minimum(units + 1, place + 0.5) - np.maximum(units, place - 0.5), 0, None)
    received = light + random.normal(size=light.shape) * np.sqrt(DARK**2 + EXCESS * light)
    strongest = received[:, 1:-1].argmax(axis=1) + 1
    row = np.arange(count)
    middle = received[row, strongest]
    sides = np.stack([received[row, strongest - 1], received[row, strongest + 1]])
    larger = np.maximum(sides.max(axis=0), 0)
    found = strongest + 0.5 + np.where(sides[0] > sides[1], -1, 1) * larger / (middle + larger)
    perceived = middle > threshold
    return UNIT * (found - place[:, 0])[perceived], perceived.mean()


def scan(places, electrons, **settings):
    """Echoes of a wall that gives so many electrons to beams which begin at these places, m before and behind the
    middle."""
    corners = [(WALL, -0.5, -50), (WALL, 0.5, -50), (WALL, 0.5, 50), (WALL, -0.5, 50)]
    wall = al.Scene(corners, [(0, 1, 2), (0, 2, 3)], material=(0.3, 0, 1))
    bright = PER_JOULE * 3.6e-4 * 0.3 * 0.0078539816 / (np.pi * WALL**2)  # electrons
    options = {"half_beamwidth": 1e-5, "background_radiance": 0.05 * (5.6e-3 / 1e-5) ** 2,
               "pulse_energy": 3.6e-4 * electrons / bright, "range_gate": 400.0, "range_noise_floor": 0, **settings}
    sensor = al.Sensor("Search905", directions=np.tile([1.0, 0.0, 0.0], (len(places), 1)),
                       positions=np.column_stack([places, 0 * places, 0 * places]), **options)
    return al.Scan(wall, sensor, attenuation_coefficient=0, number_of_reflections=1).echoes


class RangeNoise(unittest.TestCase):
    def test_against_the_waveform(self):
        places = np.random.default_rng(5).uniform(-0.5 * UNIT, 0.5 * UNIT, 10000)
        # The ratio of the whole pulse is n/sqrt(sigma0^2 + F n). At 8, noise decides which three in five are perceived.
        for ratio, most in ((8, 0.25), (25, 0.14), (300, 0.1)):
            with self.subTest(ratio=ratio):
                electrons = 0.5 * (EXCESS * ratio**2 + np.sqrt(EXCESS**2 * ratio**4 + 4 * ratio**2 * DARK**2))
                echoes = scan(places, electrons, false_alarms_per_scan=1e-3)
                threshold = PER_JOULE * echoes.fields["lower_energy_limit"]
                expected, share = waveform(electrons, threshold, 10000, ratio)
                true = WALL - places[echoes["beam_id"]]
                errors = echoes["distance_m"] - true
                self.assertAlmostEqual(len(errors) / len(places), share, delta=0.02)
                rms, wanted = np.sqrt(np.mean(errors**2)), np.sqrt(np.mean(expected**2))
                self.assertLess(abs(rms / wanted - 1), most, (rms, wanted))
                said = echoes["distance_std_error"]
                self.assertLess(abs(np.sqrt(np.mean(said**2)) / rms - 1), 0.05)

    def test_off_quantum_and_walk(self):
        places = np.linspace(-1, 1, 50)
        exact = scan(places, 1e5, range_noise=0)
        self.assertNotIn("distance_std_error", exact.fields)
        self.assertLess(np.abs(exact["distance_m"] - (WALL - places[exact["beam_id"]])).max(), 1e-6)
        echoes = scan(places, 1e5, range_noise=0, range_walk=2.0, range_quantum=0.1)
        late = 2.0 * echoes.fields["lower_energy_limit"] / echoes["energy_received"]
        self.assertLess(np.abs(echoes["distance_m"] / 0.1 - np.round(echoes["distance_m"] / 0.1)).max(), 1e-9)
        np.testing.assert_allclose(echoes["distance_m"], WALL - places[echoes["beam_id"]] + late, atol=0.1)
