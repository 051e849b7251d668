# SPDX-License-Identifier: BSD-3-Clause
"""Birds that cross a strip or an approach: the share that is detected at least twice, against birds that are flown
through the echo filter, scan after scan, and against the binomial law; where the birds fly."""
import itertools
import math
import unittest
import unittest.mock
import warnings

import numpy as np
from scipy.stats import binom

import avianlidar as al
import exampletools  # noqa: F401  (finds the studies)
import flown
from avianlidar import Coverage
from avianlidar.apps.coverage import _crossing
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.inputs._read import read_plan
from reporttools import plan, written

SPEED = 12.5  # airspeed of a herring gull in Filters/Birds/species.csv, m/s


def wanted(**changes):
    return Plan(read_plan(written("crossing", plan(
                                      **{"siting": None, "sensor": {"preset": "Search905", "position": [-60, 2900, 10]},
                                         "regions": {"approaches": {"18L": 1}}, "heights": [15, 40], "places": 200,
                                         "coverage": {"visibility": 10e3, "clutter": False}, **changes}))))


class Crossings(unittest.TestCase):
    def test_detections_of_independent_scans(self):
        p = np.full((1, 7), 0.3)
        for times in (1, 2, 3):
            self.assertAlmostEqual(_crossing.detected_at_least(times, p)[0], binom.sf(times - 1, 7, 0.3), delta=1e-12)
        p = np.random.default_rng(1).uniform(size=(4, 6))
        ways = np.array(list(itertools.product((0, 1), repeat=6)))
        each = np.prod(np.where(ways[None] == 1, p[:, None], 1.0 - p[:, None]), axis=2)
        np.testing.assert_allclose(_crossing.detected_at_least(2, p), each[:, ways.sum(axis=1) >= 2].sum(axis=1),
                                   atol=1e-12)

    def test_speeds_are_those_of_the_species(self):
        for species, speed in (("herring gull", SPEED), ("kestrel", 10.0), ("Canada goose", 16.5)):
            self.assertEqual(_crossing.speed_of(species), speed)

    def test_birds_cross_at_right_angles(self):
        """From one side of the region to the other, at the height and the distance of a drawn place, a step in each
        scan."""
        asked = wanted(regions={"strips": 1, "approaches": {"18L": 1}},
                       sensor={"preset": "Search905", "rotation_rate": 0.4})
        chosen, positions, headings = _crossing.flights(asked, SPEED, np.random.default_rng(2))
        region_of = {number: name for name, members in asked.ends.items() for number in members}
        self.assertEqual(len(chosen), 200)
        spans = []
        for number, of, heading in zip(chosen, positions, headings):
            place, name = asked.points[number], region_of[number]
            runway = next(one for one in asked.runways if name.rpartition(" ")[2] in one.name)
            axis, side = runway.axes()
            np.testing.assert_allclose(of[:, 2], place[2])
            np.testing.assert_allclose(np.diff(of[:, :2], axis=0) @ axis, 0.0, atol=1e-6)
            self.assertAlmostEqual((place - of[0])[:2] @ axis, 0.0, delta=1e-6)
            way = np.array([math.sin(heading), math.cos(heading)])
            np.testing.assert_allclose(np.diff(of[:, :2], axis=0) @ way, SPEED / 0.4, atol=1e-6)
            self.assertAlmostEqual(abs(way @ side), 1.0, delta=1e-9)
            beyond = max(0.0, *(float((place[:2] - end) @ out) for end, out in runway.ends()))
            half = 150.0 if name.startswith("strip") else 75.0 + 0.15 * beyond
            off = (of[:, :2] - runway.start) @ side
            self.assertLessEqual(np.abs(off).max(), half + 1e-6)
            self.assertGreater(len(of) + 1, 2.0 * half / (SPEED / 0.4) - 1e-6)
            spans.append(2.0 * half / SPEED)
        found = _crossing.crossing(asked)
        self.assertAlmostEqual(found.seconds, np.mean(spans), delta=0.1)
        self.assertAlmostEqual(found.scans, 0.4 * np.mean(spans), delta=0.1)

    def test_headings_to_both_sides_of_the_line_of_sight_are_alike(self):
        """A bird is symmetric. Silhouettes are drawn at this elevation, 0. Headings of gliding birds are sampled
        symmetrically. Flapping birds have a small error of interpolation, because the mirror image of a phase's
        headings is that of another phase."""
        cover = Coverage(al.Scene(), al.Sensor("Search905"), species="herring gull", visibility=23e3, clutter=False,
                         pose_probabilities=True)
        aside = np.radians(np.arange(5.0, 180.0, 10.0))
        for gliding, error in ((True, 1e-6), (False, 0.006)):
            cover.gliding = gliding
            for line in np.radians([0.0, 90.0, 225.0]):
                there = np.tile(500.0 * np.array([math.sin(line), math.cos(line), 0.0]), (2 * len(aside), 1))
                left, right = np.split(_crossing._seen(cover, there, np.concatenate([line - aside, line + aside])), 2)
                self.assertGreater(np.ptp(left), 0.9)
                np.testing.assert_allclose(left, right, atol=error, err_msg=f"{gliding} {line}")

    def test_places_that_are_too_far_away_are_not_computed(self):
        """The same as if all were computed, for a lidar that sees 700 m and for one that sees 60 m."""
        for sensor, most in (("Search905", 0.95), ("OS2_128", 0.3)):
            asked = wanted(sensor={"preset": sensor, "position": [-60, 2900, 3]}, places=60, heights=[3, 15])
            _, positions, headings = _crossing.flights(asked, SPEED, np.random.default_rng(3))
            places, ways = np.concatenate(positions)[::7], np.repeat(headings, [len(of) for of in positions])[::7]
            cover = asked.regions.set(species="herring gull", all_species=False, pose_probabilities=True)
            every = _crossing._seen(cover, places, ways)
            computed = []
            seen = _crossing._seen
            with unittest.mock.patch.multiple(_crossing, PROBED=100, _seen=lambda cover, places, ways: (
                    computed.append(len(places)) or seen(cover, places, ways))):
                np.testing.assert_array_equal(_crossing._seen_near(cover, places, ways),
                                              np.where(every > 1e-5, every, _crossing._seen_near(cover, places, ways)))
            self.assertGreater(every.max(), 0.01)
            self.assertLess(sum(computed) / 2 / len(places), most)

    def test_the_coverage_is_as_before_after_ctrl_c(self):
        asked = wanted(places=10)
        names = ("places", "species", "all_species", "pose_probabilities")
        before = [getattr(asked.regions, name) for name in names]
        for work in (_crossing.crossing, lambda plan: plan.in_airs([{"visibility": 5e3}]),
                     lambda plan: plan.mixed(plan.regions)):
            stopped = unittest.mock.PropertyMock(side_effect=KeyboardInterrupt)
            with unittest.mock.patch.multiple(Coverage, data=stopped, table=stopped), \
                    self.assertRaises(KeyboardInterrupt):
                work(asked)
            self.assertEqual([getattr(asked.regions, name) for name in names], before)

    def test_share_is_that_of_flown_birds(self):
        """Within three standard errors of three flights of each bird."""
        asked = wanted()
        found = _crossing.crossing(asked)
        self.assertEqual((found.birds, found.speed), (200, SPEED))
        self.assertTrue(0.2 < found.share < 0.8, found)
        _, positions, headings = _crossing.flights(asked, SPEED, np.random.default_rng(asked.seed))
        places, counts = np.concatenate(positions), np.array([len(of) for of in positions])
        of_bird, ways = np.repeat(np.arange(len(positions)), counts), np.repeat(headings, counts)
        # a tenth of the gulls are detected to 700 m
        near = np.linalg.norm(places - asked.sensor.position, axis=1) < 900.0
        air = float(asked.regions.data.GetFieldData().GetArray("attenuation_coefficient").GetValue(0))
        times = 3
        twice = []
        for seed in range(times):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about beams without echoes
                seen, _ = flown.fly(asked.scene, asked.sensor, places[near], 1, "herring gull", air, 1000, seed,
                                    ways[near])
            twice.append(np.bincount(of_bird[near], seen, len(positions)) >= 2)
        share = np.mean(twice)
        self.assertAlmostEqual(share, found.share,
                               delta=3.0 * math.sqrt(found.share * (1.0 - found.share) / (times * len(positions))))
