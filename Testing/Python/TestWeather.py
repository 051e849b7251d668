# SPDX-License-Identifier: BSD-3-Clause
"""Air that sends light back: walls and birds behind it, coverage, labels, and what is said of it. The lidar equation in
each range unit and its noise are TestAir's (kernel).

What others published: extinction by Koschmieder, Kruse and Kim; the fog of another simulator (M. Hahner et al., Fog
Simulation on Real LiDAR Point Clouds, ICCV 2021, after R. H. Rasshofer et al., Adv. Radio Sci. 9, 2011), its hard and
its soft target; Mie's theory of droplets and drops."""
import math
import unittest

import numpy as np
from scipy import integrate, stats

import avianlidar as al
from echotools import InFolder
from helpertools import run, wall
from scenetools import SHIPPED

import exampletools  # noqa: F401  (finds the studies)
import drops
import others

LIGHT, PLANCK = 299792458.0, 6.626e-34  # the constants of the receiver
EXTINCTION = 3.912e-3 * (905 / 550)**-0.5  # 1/m, of 905 nm where one sees 1 km, by Kruse's law with Kim's exponent
NOTHING = al.Scene(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), material="Wall")
FOG = {"visibility": 1000, "air_backscatter": True}
RATIO = 18.8  # sr, of fog here


def looking(name="Search905", beams=1, **settings):
    return al.Sensor(name, directions=np.tile([0.0, 1.0, 0.0], (beams, 1)), rotation_rate=1e-2, **settings)


def per_joule(sensor):
    return sensor.receiver_efficiency * 1e-9 * sensor.wavelength / (PLANCK * LIGHT)


def electrons_of_air(sensor, unit, mu):
    """The lidar equation, in a range unit."""
    length = LIGHT * sensor.sampling_interval / 2
    value, _ = integrate.quad(lambda r: np.exp(-2 * mu * r) / r**2, unit * length, (unit + 1) * length, epsrel=1e-10)
    return per_joule(sensor) * sensor.pulse_energy * mu / RATIO * sensor.receiver_aperture * value


def soft_target(distance, extinction, width, crossing):
    """Hahner's received power of fog, Eq. of the soft target, over C_A P0 beta: a pulse sin^2(pi t/(2 width)) of 2
    width, whose maximum is put at the distance. @param crossing m, between which the view begins to cover the beam, and
    does"""
    def integrand(t):
        r = distance + LIGHT * (width - t) / 2
        share = np.clip((r - crossing[0]) / (crossing[1] - crossing[0]), 0, 1)
        return np.sin(np.pi * t / (2 * width))**2 * np.exp(-2 * extinction * r) / r**2 * share if r > 0 else 0.0
    kinks = [width + 2 * (distance - r) / LIGHT for r in crossing]
    return integrate.quad(integrand, 0, 2 * width, points=[t for t in kinks if 0 < t < 2 * width], epsrel=1e-10,
                          limit=200)[0]


def of_air(visibility, sampling_interval, gate):
    """Middles of the range units, m, and energy in each by the filter, over pulse energy and aperture."""
    sensor = looking(receiver_model="EnergyLimits", lower_energy_limit=0, upper_energy_limit=1e9, noise_photon_rate=0,
                     sampling_interval=sampling_interval, pulse_width=0, range_gate=gate)
    echoes = al.Scan(NOTHING, sensor, noise=False, return_mode="RangeUnits", visibility=visibility,
                     air_backscatter=True).echoes
    length = LIGHT * sampling_interval / 2
    units = np.floor(np.array(echoes["distance_m"]) / length).astype(int)
    order = np.argsort(units)
    energies = np.array(echoes["energy_received"])[order]
    return (units[order] + 0.5) * length, energies / sensor.pulse_energy / sensor.receiver_aperture


class Law(unittest.TestCase):
    def test_walls_behind_are_weakened(self):
        behind = al.Scene(wall(80, 9), material=(0.5, 0, 1))
        sensor = looking()
        clear = al.Scan(behind, sensor, noise=False, attenuation_coefficient=0).echoes["return_energy"]
        rain = 2.7708e-3 * (1 - others.kept_in_view(5.6e-3, 905e-9, 25) / 2)  # 1/m
        for weather, mu in ((FOG, EXTINCTION), ({"rain_rate": 25, "attenuation_coefficient": 0}, rain)):
            echoes = al.Scan(behind, sensor, noise=False, **weather).echoes
            self.assertEqual(len(echoes["return_energy"]), 1)  # the threshold follows
            self.assertAlmostEqual(echoes["return_energy"][0] / clear[0] / math.exp(-160 * mu), 1, delta=1e-3)
        fixed = al.Scan(behind, looking(threshold_law="Fixed"), noise=False, return_mode="RangeUnits", **FOG).echoes
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
            air = electrons_of_air(sensor, int(r / (LIGHT * 2.5e-9)), mu)
            shown = per_joule(sensor) * sensor.pulse_energy * 0.03 / (np.pi * 5.6e-3**2 * r**2) * \
                0.3 * sensor.receiver_aperture / (np.pi * r**2) * np.exp(-2 * mu * r)
            limit = threshold * np.sqrt(1 + 3 * air / dark)
            # The pulse is as long as a unit: its share in the better of two is evenly 0.5 to 1.
            shares = np.linspace(0.5, 1, 101)
            better = [1 - stats.norm.cdf((limit - s * shown) / np.sqrt(dark + 3 * (air + s * shown))) for s in shares]
            other = [1 - stats.norm.cdf((limit - (1 - s) * shown) / np.sqrt(dark + 3 * (air + (1 - s) * shown)))
                     for s in shares]
            truth = np.mean(1 - (1 - np.array(better)) * (1 - np.array(other)))
            self.assertAlmostEqual(p, truth, delta=0.03)
        self.assertTrue(0.1 < found.mean() < 0.9)


class Labels(InFolder):
    def test_points_of_rain_are_known_as_such(self):
        echoes = al.Scan(NOTHING, looking(beams=100), rain_rate=20).echoes
        air = np.array(echoes["object_id"]) == -2
        self.assertGreater(air.sum(), 500)
        self.assertTrue(np.all(np.array(echoes["material_id"])[air] == -1))
        self.assertTrue(np.all(np.array(echoes["label_share"])[air] > 0.5))
        self.assertEqual(float(echoes.fields["rain_rate"]), 20)
        self.assertEqual(int(echoes.fields["air_backscatter"]), 0)
        al.save(echoes, "rain.las")
        self.assertEqual(set(np.array(al.load_cloud("rain.las")["classification"])[air]), {7})
        al.save(echoes, "rain.bin")
        self.assertEqual(set((np.fromfile("rain.label", np.uint32) & 0xffff)[air]), {1})


class Words(InFolder):
    def test_wrong_weather_is_named(self):
        with self.assertRaisesRegex(al.Error, "receiver_aperture above 0, for example Search905"):
            al.Scan(NOTHING, al.Sensor("Airport16"), rain_rate=1).echoes

    def test_weather_on_the_command_line(self):
        for words, wrong in (("fog:2000 rain:5", ""), ("fog:-1", "weather 'fog:-1'"),
                             ("fog:800 rain:1 haze:5000", "weather 'haze:5000' after 'fog:800'")):
            code, out, error = run("scan", SHIPPED, "--sensor", "Search905", "--sensor-set", "azimuth_step=6", "-o",
                                   "a.vtp", "--weather", *words.split())
            self.assertEqual(code, 2 if wrong else 0, words)
            self.assertIn(wrong, error)
            self.assertEqual("of the air (object_id -2)" in out, not wrong)


class Extinction(unittest.TestCase):
    def test_is_that_of_koschmieder_kruse_and_kim(self):
        for visibility, exponent in ((40, 0), (700, 0.2), (3000, 0.82), (8000, 1.3), (60e3, 1.6)):
            for wavelength in (550, 905, 1550):
                law = 3.912 / visibility * (wavelength / 550)**-exponent
                self.assertAlmostEqual(others.extinction_in(wavelength, visibility=visibility) / law, 1, delta=1e-3,
                                       msg=f"{visibility} m, {wavelength} nm")

    def test_metres_of_rain_are_those_of_spheres(self):
        for rate in (1, 50):
            efficiency, _, _ = others.rain_of_spheres(rate, drops=200)  # efficiencies differ by parts in a thousand
            moment = 0.25e-6 * math.pi * 8000 * 2 * (rate**0.21 / 4.1)**3  # m^2 of drops in m^3, by Marshall and Palmer
            found = others.extinction_in(905, rain_rate=rate, attenuation_coefficient=0)
            kept = others.kept_in_view(5.6e-3, 905e-9, rate)  # of the half that is diffracted
            # Mie's is 2.008 to 2.013 areas, ours 2
            self.assertAlmostEqual(found / ((efficiency - kept) * moment), 1, delta=0.015)


class AnotherSimulator(unittest.TestCase):
    def test_fog_returns_the_same_over_range(self):
        # In units of 0.75 m ours is of a short pulse. A pulse of 2 x 5 ns shifts its light by a variance of 0.074 m^2,
        # which raises a law exp(-2 mu r)/r^2 by half of that times 6/r^2 + 8 mu/r + 4 mu^2: the tolerance, and 1e-3 for
        # the floats of the filter.
        width, constant = 5e-9, LIGHT / 2
        for visibility in (50, 450):
            mu = 3.912 / visibility
            middles, energies = of_air(visibility, 5e-9, 120.0)
            for r, energy in zip(middles[6::36], energies[6::36]):
                half = LIGHT * 2.5e-9 / 2
                theirs = np.mean([soft_target(r + x * half, mu, width, (0.01, 0.02)) for x in (-0.7746, 0, 0.7746)]
                                 * np.array([5, 8, 5]) / 6)
                theirs *= constant * mu / RATIO / width * 5e-9  # C_A P0 beta, for the time of a unit
                raised = 0.037 * (6 / r**2 + 8 * mu / r + 4 * mu**2)
                self.assertAlmostEqual(energy / theirs, 1, delta=1e-3 + 1.3 * raised, msg=f"{visibility} m, {r} m")


def ratio_of_rain(rate, wavelength):
    """Twice the drops' areas over their backscatter, sr, by the light of a range unit. @param wavelength um"""
    sensor = looking(wavelength=1e3 * wavelength, receiver_model="EnergyLimits", lower_energy_limit=0,
                     upper_energy_limit=1e9, pulse_width=0, range_gate=60)
    echoes = al.Scan(NOTHING, sensor, noise=False, return_mode="RangeUnits", attenuation_coefficient=0,
                     rain_rate=rate).echoes
    extinction, length = float(echoes.fields["attenuation_coefficient"]), LIGHT * sensor.sampling_interval / 2
    k = int(np.argmax(echoes["distance_m"]))
    r = float(echoes["distance_m"][k])
    mean = sensor.receiver_aperture / r**2 * np.exp(-2 * extinction * r) * length
    areas = 0.25e-6 * math.pi * 8000 * 2 * (rate**0.21 / 4.1)**3
    return 2 * areas / (float(echoes["energy_received"][k]) / sensor.pulse_energy / mean)


class Mie(unittest.TestCase):
    def test_water_absorbs_the_light_from_the_rear_of_drops(self):
        for rate in (1, 10):
            _, ratio, error = others.rain_of_spheres(rate, 1200, wavelength=1.55, index=drops.index_of(1.55))
            self.assertLess(error, 0.1)
            self.assertAlmostEqual(ratio_of_rain(rate, 1.55) / ratio, 1, delta=0.2)
        self.assertAlmostEqual(ratio_of_rain(10, 0.905), 20, delta=1)

    def test_water_is_that_of_hale_and_querry(self):
        """Optical constants of water in the 200-nm to 200-um wavelength region, Applied Optics 12, 1973."""
        for wavelength, index, extinction in ((0.7, 1.331, 3.35e-8), (0.9, 1.328, 4.86e-7), (1.0, 1.327, 2.89e-6),
                                              (1.2, 1.324, 9.89e-6), (1.6, 1.317, 8.55e-5)):
            found = drops.index_of(wavelength)
            self.assertAlmostEqual(found.real, index, delta=0.008)
            self.assertAlmostEqual(found.imag / extinction, 1, delta=0.25)

    def test_droplets_return_what_ceilometers_found(self):
        for fog in others.FOGS:
            self.assertAlmostEqual(others.ratio_of_fog(fog) / RATIO, 1, delta=0.1, msg=fog)
