# SPDX-License-Identifier: BSD-3-Clause
"""Weather against what others published: extinction by Koschmieder, Kruse and Kim; the fog of another simulator (M. Hahner et al., Fog Simulation
on Real LiDAR Point Clouds, ICCV 2021, after R. H. Rasshofer et al., Adv. Radio Sci. 9, 2011), its hard and its soft target; Mie's theory of
droplets and drops; light scattered more than once."""
import math
import unittest

import numpy as np
from scipy import integrate

import avianlidar as al

import exampletools  # noqa: F401  (finds the studies)
import multiple_scattering
import others

LIGHT = 299792458.0
NOTHING = al.Scene(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), material="Wall")
RATIO = 18.8  # sr, of fog here


def soft_target(distance, extinction, width, crossing):
    """Hahner's received power of fog, Eq. of the soft target, over C_A P0 beta: a pulse sin^2(pi t/(2 width)) of 2 width, whose maximum is put
    at the distance. @param crossing m, between which the view begins to cover the beam, and does"""
    def integrand(t):
        r = distance + LIGHT * (width - t) / 2
        share = np.clip((r - crossing[0]) / (crossing[1] - crossing[0]), 0, 1)
        return np.sin(np.pi * t / (2 * width))**2 * np.exp(-2 * extinction * r) / r**2 * share if r > 0 else 0.0
    kinks = [width + 2 * (distance - r) / LIGHT for r in crossing]
    return integrate.quad(integrand, 0, 2 * width, points=[t for t in kinks if 0 < t < 2 * width], epsrel=1e-10, limit=200)[0]


def of_air(visibility, sampling_interval, gate):
    """Middles of the range units, m, and energy in each by the filter, over pulse energy and aperture."""
    sensor = others.looking("Search905", receiver_model="EnergyLimits", lower_energy_limit=0, upper_energy_limit=1e9, noise_photon_rate=0,
                            sampling_interval=sampling_interval, pulse_width=0, range_gate=gate)
    echoes = al.Scan(NOTHING, sensor, noise=False, return_mode="RangeUnits", visibility=visibility, air_backscatter=True).echoes
    length = LIGHT * sampling_interval / 2
    units = np.floor(np.array(echoes["distance_m"]) / length).astype(int)
    order = np.argsort(units)
    return (units[order] + 0.5) * length, np.array(echoes["energy_received"])[order] / sensor.pulse_energy / sensor.receiver_aperture


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
            self.assertAlmostEqual(found / ((efficiency - kept) * moment), 1, delta=0.015)  # Mie's is 2.008 to 2.013 areas, ours 2


class AnotherSimulator(unittest.TestCase):
    def test_fog_returns_the_same_over_range(self):
        # In units of 0.75 m ours is of a short pulse. A pulse of 2 x 5 ns shifts its light by a variance of 0.074 m^2, which raises a law
        # exp(-2 mu r)/r^2 by half of that times 6/r^2 + 8 mu/r + 4 mu^2: the tolerance, and 1e-3 for the floats of the filter.
        width, constant = 5e-9, LIGHT / 2
        for visibility in (50, 450):
            mu = 3.912 / visibility
            middles, energies = of_air(visibility, 5e-9, 120.0)
            for r, energy in zip(middles[6::36], energies[6::36]):
                half = LIGHT * 2.5e-9 / 2
                theirs = np.mean([soft_target(r + x * half, mu, width, (0.01, 0.02)) for x in (-0.7746, 0, 0.7746)] * np.array([5, 8, 5]) / 6)
                theirs *= constant * mu / RATIO / width * 5e-9  # C_A P0 beta, for the time of a unit
                raised = 0.037 * (6 / r**2 + 8 * mu / r + 4 * mu**2)
                self.assertAlmostEqual(energy / theirs, 1, delta=1e-3 + 1.3 * raised, msg=f"{visibility} m, {r} m")


class Mie(unittest.TestCase):

    def test_droplets_return_what_ceilometers_found(self):
        for fog in others.FOGS:
            self.assertAlmostEqual(others.ratio_of_fog(fog) / RATIO, 1, delta=0.1, msg=fog)


class Multiple(unittest.TestCase):
    def test_photons_follow_the_lidar_equation_and_then_the_closed_form(self):
        half, lobe = 5.6e-3, 905e-9 / (math.pi * 5e-6)
        runs = [multiple_scattering.followed(half, lobe, 20_000, seed) for seed in range(8)]
        for k, depth in enumerate(multiple_scattering.DEPTHS):
            single = [run[0, k] / 20_000 for run in runs]
            law, _ = integrate.quad(lambda r: np.exp(-2 * r) / r**2 / RATIO, depth - multiple_scattering.HALF, depth + multiple_scattering.HALF)
            self.assertAlmostEqual((np.mean(single) - law) / (np.std(single, ddof=1) / 8**0.5), 0, delta=4)
            more = np.mean([run[1:, k].sum() / run[0, k] for run in runs])
            # The closed form is of a beam without width; at the edge of a beam as wide as the view more is lost.
            bound = np.expm1(multiple_scattering.share_kept(half / lobe) * depth)
            self.assertTrue(0.7 * bound < more < 1.02 * bound, (depth, more, bound))


if __name__ == "__main__":
    unittest.main()
