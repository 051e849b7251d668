# SPDX-License-Identifier: BSD-3-Clause
"""Air that sends light back: walls and birds behind it, coverage, labels, and what is said of it. The lidar equation in each
range unit and its noise are TestAir's (kernel)."""
import math
import os
import pathlib
import tempfile
import unittest

import numpy as np
from scipy import integrate, stats

import avianlidar as al
from helpertools import run

import exampletools  # noqa: F401  (finds the studies)
from others import kept_in_view

LIGHT, PLANCK = 299792458.0, 6.626e-34  # the constants of the receiver
EXTINCTION = 3.912e-3 * (905 / 550)**-0.5  # 1/m, of 905 nm where one sees 1 km, by Kruse's law with Kim's exponent
NOTHING = al.Scene(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), material="Wall")
FOG = {"visibility": 1000, "air_backscatter": True}


def electrons_of_air(sensor, unit, mu, ratio):
    """The lidar equation, in a range unit."""
    length = LIGHT * sensor.sampling_interval / 2
    value, _ = integrate.quad(lambda r: np.exp(-2 * mu * r) / r**2, unit * length, (unit + 1) * length, epsrel=1e-10)
    energy = sensor.pulse_energy * mu / ratio * sensor.receiver_aperture * value
    return energy * sensor.receiver_efficiency * 1e-9 * sensor.wavelength / (PLANCK * LIGHT)


def looking(name="Search905", beams=1, **settings):
    return al.Sensor(name, directions=np.tile([0.0, 1.0, 0.0], (beams, 1)), rotation_rate=1e-2, **settings)


def per_joule(sensor):
    return sensor.receiver_efficiency * 1e-9 * sensor.wavelength / (PLANCK * LIGHT)


class Law(unittest.TestCase):
    def test_walls_behind_are_weakened(self):
        wall = al.Scene([(-9, 80, -9), (9, 80, -9), (9, 80, 9), (-9, 80, 9)], [(0, 1, 2), (0, 2, 3)], material=(0.5, 0, 1))
        sensor = looking()
        clear = al.Scan(wall, sensor, noise=False, attenuation_coefficient=0).echoes["return_energy"]
        for weather, mu in ((FOG, EXTINCTION), ({"rain_rate": 25, "attenuation_coefficient": 0}, 2.7708e-3 * (1 - kept_in_view(5.6e-3, 905e-9, 25) / 2))):
            echoes = al.Scan(wall, sensor, noise=False, **weather).echoes
            self.assertEqual(len(echoes["return_energy"]), 1)  # the threshold follows
            self.assertAlmostEqual(echoes["return_energy"][0] / clear[0] / math.exp(-160 * mu), 1, delta=1e-3)
        fixed = al.Scan(wall, looking(threshold_law="Fixed"), noise=False, return_mode="RangeUnits", **FOG).echoes
        self.assertIn(-2, fixed["object_id"])


class Coverage(unittest.TestCase):
    def test_a_target_in_fog_is_seen_with_its_probability(self):
        sensor = al.Sensor("Search905")
        mu, threshold = EXTINCTION, float(sensor.beams.fields["lower_energy_limit"]) * per_joule(sensor)
        elevation = math.radians(1.5)
        ranges = np.arange(150.2, 420, 15)
        places = ranges[:, None] * np.array([[0, math.cos(elevation), math.sin(elevation)]])
        cover = al.Coverage(NOTHING, sensor, places=places, species="", effective_area=0.03, reflectance=0.3, **FOG)
        found = cover["detection_probability"].astype(float)
        background = per_joule(sensor) * 0.05 * 10 * 4 * np.pi * np.sin(2.8e-3)**2 * sensor.receiver_aperture * 5e-9
        dark = 3 * background + 60**2
        for r, p in zip(ranges, found):
            air = electrons_of_air(sensor, int(r / (LIGHT * 2.5e-9)), mu, 18.8)
            shown = per_joule(sensor) * sensor.pulse_energy * 0.03 / (np.pi * 5.6e-3**2 * r**2) * \
                0.3 * sensor.receiver_aperture / (np.pi * r**2) * np.exp(-2 * mu * r)
            limit = threshold * np.sqrt(1 + 3 * air / dark)
            # The pulse is as long as a unit: its share in the better of two is evenly 0.5 to 1.
            shares = np.linspace(0.5, 1, 101)
            better = [1 - stats.norm.cdf((limit - s * shown) / np.sqrt(dark + 3 * (air + s * shown))) for s in shares]
            other = [1 - stats.norm.cdf((limit - (1 - s) * shown) / np.sqrt(dark + 3 * (air + (1 - s) * shown))) for s in shares]
            truth = np.mean(1 - (1 - np.array(better)) * (1 - np.array(other)))
            self.assertAlmostEqual(p, truth, delta=0.03)
        self.assertTrue(0.1 < found.mean() < 0.9)


class Labels(unittest.TestCase):
    def test_points_of_rain_are_known_as_such(self):
        echoes = al.Scan(NOTHING, looking(beams=100), rain_rate=20).echoes
        air = np.array(echoes["object_id"]) == -2
        self.assertGreater(air.sum(), 500)
        self.assertTrue(np.all(np.array(echoes["material_id"])[air] == -1))
        self.assertTrue(np.all(np.array(echoes["label_share"])[air] > 0.5))
        self.assertEqual(float(echoes.fields["rain_rate"]), 20)
        self.assertEqual(int(echoes.fields["air_backscatter"]), 0)
        with tempfile.TemporaryDirectory() as folder:
            al.save(echoes, pathlib.Path(folder) / "rain.las")
            self.assertEqual(set(np.array(al.load_cloud(pathlib.Path(folder) / "rain.las")["classification"])[air]), {7})
            al.save(echoes, pathlib.Path(folder) / "rain.bin")
            self.assertEqual(set((np.fromfile(pathlib.Path(folder) / "rain.label", np.uint32) & 0xffff)[air]), {1})


class Words(unittest.TestCase):
    def test_what_is_wrong_is_named(self):
        with self.assertRaisesRegex(al.Error, "receiver_aperture above 0"):
            al.Scan(NOTHING, al.Sensor("Airport16"), rain_rate=1).echoes
        scan = al.Scan(NOTHING, looking(), rain_rate=501)
        with self.assertRaisesRegex(al.Error, "RainRate is 501"):
            scan.echoes
        self.assertGreater(len(scan.set(rain_rate=50).echoes["object_id"]), 0)  # the next good input works

    def test_weather_on_the_command_line(self):
        scene = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
        with tempfile.TemporaryDirectory() as folder:
            for words, wrong in (("fog:2000 rain:5", ""), ("fog:-1", "weather 'fog:-1'"),
                                 ("fog:800 rain:1 haze:5000", "weather 'haze:5000' after 'fog:800'")):
                code, out, error = run("scan", scene, "--sensor", "Search905", "--sensor-set", "azimuth_step=6", "-o",
                                       os.path.join(folder, "a.vtp"), "--weather", *words.split())
                self.assertEqual(code, 2 if wrong else 0, words)
                self.assertIn(wrong, error)
                self.assertEqual("of the air (object_id -2)" in out, not wrong)


if __name__ == "__main__":
    unittest.main()
