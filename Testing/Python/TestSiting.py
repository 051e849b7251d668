# SPDX-License-Identifier: BSD-3-Clause
"""Siting: outlines, weights, searches against brute force, coverage that is kept, the airport's reference curve, files,
plans that are wrong."""
import functools
import gzip
import itertools
import json
import math
import os
import pathlib
import unittest
import unittest.mock

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.path import Path
from osgeo import gdal

import avianlidar as al
import exampletools
import TestCoverage
from avianlidar import siting
from avianlidar.apps.airport._osm import read_extract
from avianlidar.apps.coverage import _pictures, _sites, _sites_page
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.coverage._sites import Sites
from avianlidar.apps.inputs._json import load_json, packaged
from avianlidar.apps.inputs._read import read_plan
from avianlidar.apps.pages import _drawing
from avianlidar.apps.places._candidates import Surfaces, code_of, pierced
from avianlidar.apps.places._features import properties_of
import scenetools as st
from helpertools import error_of, warned

AIRPORT = pathlib.Path(exampletools.EXAMPLES) / "airport" / "scene"
PLAN, SCENE = AIRPORT / "hongqiao.geojson", AIRPORT / "hongqiao.lidarscene.json"
COVERAGE = AIRPORT.parent.parent / "coverage" / "hongqiao.coverage.json"
TARGET = {"species": "", "effective_area": 0.03, "clutter": False}  # m2: quicker than birds
GREEDY = (0.105, 0.206, 0.292, 0.357, 0.405, 0.446)
fresh = functools.partial(exampletools.emptied, "TestSiting")


def drawn(sites, species, places, seed):
    """Coverage as if of sites that each see a part, and weights."""
    random = np.random.default_rng(seed)
    found = random.uniform(size=(sites, species, places)) * (random.uniform(size=(sites, species, places)) < 0.3)
    weights = random.uniform(size=(species, places))
    return found.astype(np.float32), weights / weights.sum()


class Candidates(unittest.TestCase):
    def test_margins_are_those_of_all_pairs(self):
        """Every point against every edge, and what Matplotlib says is inside."""
        random = np.random.default_rng(2)
        angle = np.sort(random.uniform(0, 2 * np.pi, 400))
        outline = random.uniform(20, 60, (400, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
        points = np.concatenate([random.uniform(-90, 90, (2000, 2)), outline[:5], 0.5 * (outline[:5] + outline[1:6])])
        ends, inside = np.roll(outline, -1, axis=0), Path(outline).contains_points(points[:2000])
        for margin in (0.0, 0.3, 7.0, 50.0):
            away = np.full(len(points), np.inf)
            for a, b in zip(outline, ends):
                t = np.clip(((points - a) @ (b - a)) / ((b - a) @ (b - a)), 0.0, 1.0)
                away = np.minimum(away, np.hypot(*(points - a - t[:, None] * (b - a)).T))
            found = siting.is_near(points, outline, margin)
            np.testing.assert_array_equal(found[:2000], inside | (away[:2000] < margin))
            np.testing.assert_array_equal(siting.is_near(points, outline[::-1], margin)[:2000], found[:2000])
            self.assertTrue(found[2000:].all() or margin == 0.0)
        self.assertEqual(siting.is_near([(15, 5), (14.9, 5), (9, 5)], [(0, 0), (10, 0), (10, 10), (0, 10)],
                                        5.0).tolist(), [False, True, True])

    def test_holes_of_outlines_are_not_drawn(self):
        square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        for outline, inner in ((4 * square, 0.9), ([4 * square, square], 1.0), ([4 * square[::-1], square], 1.0)):
            shown = []

            def draw(axes, outline=outline, shown=shown):
                axes.set(xlim=(-5, 5), ylim=(-5, 5))
                _pictures.draw_outline(axes, outline)
                canvas = FigureCanvasAgg(axes.figure)
                canvas.draw()
                places = axes.transData.transform([(0, 0), (2.5, 0.3), (4.6, 0.3)]).astype(int)
                shown.extend(np.asarray(canvas.buffer_rgba())[::-1][y, x, 0] / 255 for x, y in places)
            _drawing.drawn((4, 4), draw)
            np.testing.assert_allclose(shown, (inner, 0.9, 1.0), atol=0.005)

    def test_two_in_one_place_are_one(self):
        with self.assertWarnsRegex(RuntimeWarning, "^8 of 12 candidates stand at the place of another candidate"):
            found = siting.candidates([(1, 2), (3, 4), (1, 2), (1.00001, 2)], (5.0, 8.0, 5.0))
        np.testing.assert_allclose(found, [(1, 2, 5), (3, 4, 5), (1, 2, 8), (3, 4, 8)], atol=1e-4)

    def test_masts_stand_on_the_ground(self):
        hill = np.array([(-100, -100, 20), (100, -100, 20), (100, 100, 40), (-100, 100, 40)], dtype=float)
        roof = np.array([(-30, -30, 50), (0, -30, 50), (0, 30, 50), (-30, 30, 50)], dtype=float)
        scene = al.Scene((np.concatenate([hill, roof]), [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)]), material="Wall")
        np.testing.assert_allclose(siting.ground_of(scene, [(50, 0), (-10, 0), (500, 0)]), [30.0, 30.0, np.nan])
        found = siting.candidates([(50, 0), (-10, 0), (500, 0)], (5.0, 25.0), scene=scene)
        np.testing.assert_allclose(found, [(50, 0, 35), (500, 0, 5), (50, 0, 55), (-10, 0, 55), (500, 0, 25)])

    def test_runway_outline_and_coordinates(self):
        outline = siting.runway_outline(siting.Runway("09/27", (0.0, 0.0), (1000.0, 0.0), 45.0), 60.0, 185.0)
        self.assertEqual([outline.min(axis=0).tolist(), outline.max(axis=0).tolist()],
                         [[-60.0, -185.0], [1060.0, 185.0]])
        origin = (31.2, 121.3, 3.0)
        points = np.array([(0.0, 0.0, 0.0), (1500.0, -900.0, 0.0)])
        degrees = siting.to_geodetic(points, origin)
        np.testing.assert_allclose(degrees[0], (121.3, 31.2, 3.0), atol=1e-9)
        np.testing.assert_allclose(siting.to_enu(degrees[:, :2], origin), points[:, :2], atol=1e-3)

    def test_weights_by_region_and_species(self):
        weights = siting.weights_of(6, {"a": [0, 1], "b": [2, 3, 4]}, {"a": 3.0, "b": 1.0}, {"crow": 1.0, "gull": 4.0})
        self.assertAlmostEqual(weights.sum(), 1.0)
        np.testing.assert_allclose(weights[1], 0.8 * np.array([0.375, 0.375, 1 / 12, 1 / 12, 1 / 12, 0.0]))


class Places(unittest.TestCase):
    RUNWAYS = [siting.Runway("08/26", (0.0, 0.0), (3000.0, 0.0), 45.0),
               siting.Runway("Runway 18R/36L", (500.0, -900.0), (500.0, 100.0), 30.0)]

    def test_ends_are_called_by_where_aircraft_land(self):
        grass = siting.Runway("grass", (0.0, 0.0), (-500.0, 0.0), 20.0)
        magnetic = siting.Runway("RWY 35/17", (0.0, 0.0), (60.0, 500.0), 20.0)
        self.assertEqual(siting.end_names([*self.RUNWAYS, grass, magnetic]),
                         [("08", "26"), ("36L", "18R"), ("grass east", "grass west"), ("35", "17")])
        self.assertEqual(siting.region_names(self.RUNWAYS), {
                             "strips": ["strip 08/26", "strip 18R/36L"],
                             "approaches": ["approach 08", "approach 26", "approach 36L", "approach 18R"]})
        self.assertEqual(siting.end_names(2 * [grass])[1], ("grass east (2)", "grass west (2)"))

    def test_shares_by_end(self):
        points, regions = siting.places_by_region(self.RUNWAYS, 1000, 3,
                                                  {"strips": {"18R/36L": 1}, "approaches": {"08": 2, "26": 1}})
        self.assertEqual({name: len(numbers) for name, numbers in regions.items()},
                         {"strip 18R/36L": 250, "approach 08": 500, "approach 26": 250})
        self.assertLess(points[regions["approach 08"], 0].max(), 0.0)  # aircraft that land on 08 come from the west
        self.assertGreater(points[regions["approach 26"], 0].min(), 3000.0)
        self.assertLessEqual(np.abs(points[regions["strip 18R/36L"], 0] - 500.0).max(), 150.0)
        for shares, words in (({"approaches": {"09": 1}}, "approaches has '09', expected some of 08, 26, 36L, 18R"),
                              ({"approaches": {"08": 0}}, "a sum above 0")):
            with self.assertRaisesRegex(ValueError, words):
                siting.strips_and_approaches(self.RUNWAYS, 100, shares=shares)

    def test_spread_by_distance_and_by_area(self):
        """Over an approach of the half-width 75 m + 0.15 d, to d = 3000 m: the share of its area before d is (75 d +
        0.075 d^2) / 900,000 m^2."""
        for spread, before, long_one in (("distance", lambda d: d / 3000.0, 0.5),
                                         ("area", lambda d: (75 * d + 0.075 * d * d) / 900e3, 0.75)):
            points, regions = siting.places_by_region(self.RUNWAYS, 40000, 1, spread=spread)
            away = -points[regions["approach 08"], 0]
            for d in (500.0, 1500.0, 2500.0):
                self.assertAlmostEqual(np.mean(away < d), before(d), delta=4 * np.sqrt(0.25 / len(away)))
            self.assertAlmostEqual(len(regions["strip 08/26"]) / 20000, long_one, delta=1e-3)
            self.assertEqual(len({len(regions[name]) for name in siting.region_names(self.RUNWAYS)["approaches"]}), 1)


class ObstacleLimits(unittest.TestCase):
    """Against heights by hand, from the dimensions of ICAO Annex 14."""

    def at(self, runway, *local):
        """Places by (m beyond the runway's end, m to its right)."""
        axis, _ = runway.axis()
        return np.array([np.add(runway.end, beyond * axis + aside * np.array([axis[1], -axis[0]]))
                         for beyond, aside in local])

    def test_code_numbers(self):
        self.assertEqual([code_of(length) for length in (799.9, 800, 1199.9, 1200, 1799.9, 1800)], [1, 2, 2, 3, 3, 4])

    def test_heights_by_hand(self):
        slanted = siting.Runway("04/22", (100.0, -50.0), (100.0 + 3000 * 0.6, -50.0 + 3000 * 0.8), 45.0)
        inf = np.inf
        # Code 4, precision. The point 285 m beyond the end and 174 m aside is 225 m from the inner edge, where the
        # approach is 173.75 m wide.
        rows = (((285, 174), inf, 4.5 + 0.143 * 0.25), ((285, -173.7), 4.5, inf), ((310, 0), 5.0, inf),
                ((60 + 3000 + 1000, 500), 85.0, inf), ((60 + 6600 + 8000, -2000), 150.0, inf),
                ((60 + 15001, 0), inf, inf), ((-1500, 185), inf, 45 * 0.143), ((-1500, -454.6), inf, 314.6 * 0.143),
                ((-1500, 455), inf, inf), ((60 + 2000, 140 + 300 + 30), inf, 40 + 30 * 0.143),
                ((60 + 2000, 140 + 300 + 36), inf, inf), ((-3000 - 310, 0), 5.0, inf), ((-1500, 139.9), inf, inf))
        found = Surfaces.of(slanted).limits(self.at(slanted, *(place for place, _, _ in rows)))
        np.testing.assert_allclose(found["approach"], [row[1] for row in rows], atol=1e-9)
        np.testing.assert_allclose(found["transitional"], [row[2] for row in rows], atol=1e-9)
        self.assertEqual(np.flatnonzero(found["strip"] == -inf).tolist(), [len(rows) - 1])
        short = siting.Runway("09/27", (0.0, 0.0), (700.0, 0.0), 18.0)  # code 1
        visual = Surfaces.of(short, changes={"category": "non-instrument"}).limits(
            self.at(short, (30 + 100, 39), (30 + 100, 41), (-300, 50), (31, 0), (29, 29)))
        np.testing.assert_allclose(visual["approach"], [5.0, inf, inf, 0.05, inf], atol=1e-9)
        np.testing.assert_allclose(visual["transitional"], [inf, 5.0 + 0.2, 4.0, inf, inf], atol=1e-9)
        self.assertEqual(visual["strip"].tolist(), [inf] * 4 + [-inf])

    def test_heights_are_above_the_thresholds(self):
        """Ground that rises 1 in 100 along the runway: 10 m at its start, 40 m at its end."""
        slope = np.array([(-9000, -9000, -80), (9000, -9000, 100), (9000, 9000, 100), (-9000, 9000, -80)], dtype=float)
        runway = siting.Runway("09/27", (0.0, 0.0), (3000.0, 0.0), 45.0)
        scene = al.Scene((slope, [(0, 1, 2), (0, 2, 3)]), material="Wall")
        limits = Surfaces.of(runway, scene).limits([(3310.0, 0.0), (-310.0, 0.0), (1500.0, 185.0)])
        np.testing.assert_allclose(limits["approach"][:2], [45.0, 15.0], atol=1e-6)
        self.assertAlmostEqual(limits["transitional"][2], 25.0 + 45 * 0.143, delta=1e-6)

    def test_plans_change_surfaces(self):
        runway = siting.Runway("09/27", (0.0, 0.0), (3000.0, 0.0), 45.0)
        tops = np.column_stack([self.at(runway, (0, 0), (285, 174), (310, 0), (310, 0), (-1500, 200)),
                                [5, 10, 5.01, 4.99, 8.5]])
        for changes, wanted in (({}, [1, 3, 2, 0, 0]), ({"strip": False}, [0, 3, 2, 0, 0]),
                                ({"approach": False, "transitional": True}, [1, 3, 0, 0, 0]),
                                ({"transitional": {"slope": 0.1}}, [1, 3, 2, 0, 3]),
                                ({"code": 1, "category": "non-instrument"}, [1, 0, 0, 0, 0])):
            self.assertEqual(pierced([Surfaces.of(runway, changes=changes)], tops).tolist(), wanted, changes)
        self.assertEqual(pierced([], tops).tolist(), [0] * 5)


class Search(unittest.TestCase):
    def test_exhaustive_is_brute_force(self):
        found, weights = drawn(30, 1, 40, 3)
        for count in (1, 2, 3):
            values = {sites: weights.sum() - (weights * np.prod(1.0 - found[list(sites)].astype(float), axis=0)).sum()
                      for sites in itertools.combinations(range(len(found)), count)}
            best = siting.exhaustive(found, weights, count)
            self.assertEqual(best.sites, max(values, key=values.get))
            self.assertAlmostEqual(best.value, max(values.values()), delta=1e-12)
            self.assertEqual(siting.search(found, weights, 3)[count - 1], best)
        self.assertEqual(siting.exhaustive(found[:2], weights, 2).sites, (0, 1))

    def test_one_mast_at_a_place(self):
        """By a brute force over all networks of sites at different places."""
        random = np.random.default_rng(6)
        found, spots = random.random((9, 1, 40)).astype(np.float32), np.array([0, 0, 0, 1, 1, 2, 3, 3, 3])
        found[:3] = np.maximum(found[:3], 0.7)  # the best three are at one place
        weights = np.full((1, 40), 1 / 40)
        for count in (2, 3):
            allowed = [sites for sites in itertools.combinations(range(9), count) if len(set(spots[list(sites)]))
                       == count]
            best = max(allowed, key=lambda sites: siting.value_of(found, weights, sites))
            self.assertEqual(siting.exhaustive(found, weights, count, spots).sites, best)
            for largest in (0, 60):
                network = siting.search(found, weights, count, largest, spots)[count - 1]
                self.assertEqual(len(set(spots[list(network.sites)])), count)
        self.assertEqual(siting.search(found[:3], weights, 2, spots=spots[:3])[1].value,
                         siting.search(found[:3], weights, 2)[1].value)

    def test_exchange_is_never_below_greedy(self):
        better = 0
        for seed in range(4):
            found, weights = drawn(20, 2, 30, seed)
            greedy, best = siting.greedy(found, weights, 5), siting.search(found, weights, 5, largest=0)
            for one, other in zip(greedy, best):
                self.assertGreaterEqual(other.value, one.value)
                self.assertEqual(len(set(other.sites)), len(one.sites))
                self.assertAlmostEqual(other.value, siting.value_of(found, weights, other.sites), delta=1e-12)
                better += other.value > one.value
            self.assertGreaterEqual(siting.exhaustive(found, weights, 3).value, best[2].value - 1e-12)
        self.assertGreater(better, 0)
        np.testing.assert_allclose(siting.values_of(found, weights),
                                   [siting.value_of(found, weights, [i]) for i in range(20)])

    def test_rank_correlation(self):
        self.assertAlmostEqual(siting.rank_correlation([1, 2, 2, 3], [3, 2, 2, 1]), -1.0)
        self.assertAlmostEqual(siting.rank_correlation([1, 2, 3, 4, 5], [2, 1, 4, 3, 5]), 0.8)


class Kept(unittest.TestCase):
    def test_a_stopped_run_goes_on(self):
        scene = al.Scene(TestCoverage.WALL, material="Wall")
        sensor = al.Sensor("Search905", azimuth_range=(-60.0, 60.0), position=(1, 2, 3))
        sites = np.array([(0, 0, 2), (10, 0, 2), (-30, 0, 2)], dtype=float)
        places = np.random.default_rng(1).uniform((-200, 60, 0), (200, 500, 40), (20, 3))
        target = {"effective_area": 0.003}
        wanted = siting.look(scene, sensor, sites, places, [""], **target)
        other = al.Sensor("Search905", azimuth_range=(-60.0, 60.0))
        cover = al.Coverage(scene, other, places=places, clutter=False, species="", **target)
        for i, other.position in enumerate(sites):
            np.testing.assert_array_equal(wanted[i, 0], cover["detection_probability"])
        birds = siting.look(scene, sensor, sites[2:], places, ("crow", "herring gull"))
        self.assertEqual((birds.shape, birds.dtype), ((1, 2, 20), np.float32))
        cover.species, cover.effective_area = "herring gull", 0.0
        np.testing.assert_array_equal(birds[0, 1], cover["detection_probability"])
        folder, made = fresh("kept"), []

        def stop(done, _):
            if done == 2:
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            siting.look(scene, sensor, sites, places, [""], folder, progress=stop, **target)
        self.assertEqual(len(list(folder.iterdir())), 2)
        again = siting.look(scene, sensor, sites, places, [""], folder, progress=lambda *numbers: made.append(numbers),
                            **target)
        np.testing.assert_array_equal(again, wanted)
        self.assertEqual((made, sensor.position), ([(1, 1)], (1, 2, 3)))
        # What differs in anything has files of its own.
        self.assertGreater(siting.look(scene, sensor, sites[:1], places, [""], folder, area_factor=1.2, **target).sum(),
                           wanted[0, 0].sum())
        siting.look(scene, sensor, sites[:1], places + 1.0, [""], folder, **target)
        siting.look(scene, sensor, sites[:1], places, [""], folder, visibility=5e3, **target)
        sensor.receiver_efficiency = 0.5 * sensor.receiver_efficiency
        self.assertLess(siting.look(scene, sensor, sites[:1], places, [""], folder, **target).sum(), wanted[0, 0].sum())
        self.assertEqual(len(list(folder.iterdir())), 3 + 4)

    def test_damaged_files_are_made_again(self):
        scene = al.Scene(TestCoverage.WALL, material="Wall")
        sensor = al.Sensor("Search905", azimuth_range=(-60.0, 60.0))
        sites = [(k, 0, 2) for k in range(7)]
        places = np.random.default_rng(1).uniform((-200, 60, 0), (200, 500, 40), (20, 3))
        folder = fresh("damaged")
        wanted = siting.look(scene, sensor, sites, places, ["crow"], folder)
        files = sorted(folder.iterdir())
        good, values = files[0].read_bytes(), np.load(files[3])
        files[0].write_bytes(good[:-1])
        files[1].write_bytes(b"")
        np.save(files[2], values[:, :-1])
        np.save(files[3], np.where(np.arange(20) == 7, np.nan, values))
        files[4].unlink()
        os.mkfifo(files[4])
        content = bytearray(files[5].read_bytes())
        content[-40:-32] = np.float32([1e6, -1e30]).tobytes()  # other numbers, the size is right
        files[5].write_bytes(content)
        with self.assertWarns(Warning) as said:
            np.testing.assert_array_equal(siting.look(scene, sensor, sites, places, ["crow"], folder), wanted)
        self.assertEqual(os.path.basename(said.filename), "TestSiting.py")  # where it was called
        self.assertEqual([file.name in str(said.warning) for file in files], [True] * 6 + [False])
        siting.look(scene, sensor, sites, places, ["crow"], folder, progress=lambda *_: self.fail("made again"))
        self.assertEqual(files[0].read_bytes(), good)


class Airport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = al.load_scene(SCENE)
        origin = cls.scene.geodetic_origin
        cls.runways = siting.read_runways(PLAN, origin)
        outlines = siting.read_outlines(PLAN, origin, "height") + [*map(siting.runway_outline, cls.runways)]
        cls.sites = siting.candidates(siting.lattice((-2000, 1600, -2200, 2200), 200), (5.0,),
                                      [(o, 0.0) for o in outlines])
        cls.sensor = al.Sensor("Search905")

    def test_greedy_curve_calculated_elsewhere(self):
        """One beam per direction, pulses that no units share, a gull that is a point, of 0.0297 m2 in the mean."""
        TestCoverage.Airport.setUpClass()
        points, regions = siting.strips_and_approaches(self.runways, 2000)
        electrons = siting.look(self.scene, self.sensor, self.sites, points, [""], effective_area=0.0297,
                                array="photoelectrons", visibility=0.0, attenuation_coefficient=TestCoverage.AIR)
        threshold, dark, excess = 664.069, 119.062, 3.0
        mean = np.concatenate([[0.0], np.logspace(1, 5, 4001)])
        n = mean[:, None] * TestCoverage.Airport.relative
        p = 0.5 * np.vectorize(math.erfc)((threshold - n) / np.sqrt(2 * (dark ** 2 + excess * n)))
        found = np.interp(electrons, mean, p.mean(axis=1)).astype(np.float32)
        weights = siting.weights_of(len(points), regions, {"strips": 1.0, "approaches": 1.0}, {"": 1.0})
        np.testing.assert_allclose([network.value for network in siting.greedy(found, weights, 6)], GREEDY, atol=0.02)

    def test_other_heights_make_another_scene(self):
        offsets = iter([5.0, -5.0, *[2.0] * 13])
        other = al.load_scene(siting.with_other_heights(SCENE, fresh("heights"), lambda: next(offsets)))
        self.assertEqual(list(offsets), [])
        self.assertEqual([*other.bounds[:5], other.bounds[5] - 5.0], [*self.scene.bounds])

    def test_heights_may_be_texts(self):
        """As the scene reader takes them; what it takes for no height is left alone."""
        folder = fresh("texts")
        square = next(f for f in load_json(PLAN)["features"] if f["properties"].get("height"))
        heights = [15, "15", "15 m", "15m", "tall", True, -3, None, "15 ft", {}]
        (folder / "town.json").write_text(json.dumps({"type": "FeatureCollection", "features": [
            {**square, "properties": {"height": height}} for height in heights]}))
        (folder / "town.lidarscene.json").write_text(
            json.dumps({"version": 1, "origin": {"latitude": 31.1979, "longitude": 121.3363, "height": 3},
                        "objects": [{"footprints": "town.json", "height": 5, "height_attribute": "height",
                                     "material": "Wall"}]}))
        scene = siting.with_other_heights(folder / "town.lidarscene.json", folder / "out", lambda: 2.0)
        changed = load_json(load_json(scene)["objects"][0]["footprints"])
        self.assertEqual([f["properties"]["height"] for f in changed["features"]], [17.0] * 4 + heights[4:])
        self.assertEqual(al.load_scene(scene).bounds[5], 17.0)

    def test_a_plan_says_where_nothing_may_stand(self):
        """The best pair of the others, by brute force; draws of the unknown."""
        folder = fresh("plan")
        square = siting.to_geodetic([(100, -700, 0), (500, -700, 0), (500, 700, 0), (100, 700, 0), (100, -700, 0)],
                                    self.scene.geodetic_origin)[:, :2].tolist()
        (folder / "taken.geojson").write_text(st.features(("Polygon", [square], None)))
        wanted = {"spacing": 400, "bounds": [-400, 800, -600, 600], "masts": [5, 8], "draws": 2, "sensors": 2}
        plan = {**read_plan(COVERAGE), "places": 100, "coverage": TARGET, "spacing": 100.0}
        free = Sites(Plan({**plan, "siting": wanted})).positions
        sites = Sites(Plan({**plan, "siting": {**wanted, "exclusions": [str(folder / "taken.geojson")]}})).look()
        inside = (free[:, 0] > 100) & (free[:, 0] < 500) & (np.abs(free[:, 1]) < 700)
        self.assertGreater(np.count_nonzero(inside), 3)
        np.testing.assert_array_equal(sites.positions, free[~inside])
        self.assertEqual(set(free[:, 2]), {5.0, 8.0})
        pairs = [siting.value_of(sites.found, sites.weights, pair)
                 for pair in itertools.combinations(range(len(sites.positions)), 2)
                 if (sites.positions[pair[0], :2] != sites.positions[pair[1], :2]).any()]  # not two masts at one place
        self.assertAlmostEqual(sites.networks[1].value, max(pairs), delta=1e-9)
        self.assertEqual([sites.rank_of(i) for i in sites.order[:3]], [1, 2, 3])
        changes = list(sites.changes())
        self.assertEqual(len(changes), 2 * 3 * 2)  # draws, kinds, sizes of networks
        for change in changes:
            self.assertGreaterEqual(change.winner.value, change.value - 1e-12)
            if not change.is_another(sites.networks):
                self.assertAlmostEqual(change.winner.value, change.value, delta=1e-12)
        # each draw has another
        self.assertEqual(len({c.winner.value for c in changes if c.what.startswith("effective area")}), 4)
        self.assertEqual(sites.robustness(changes), [])  # two draws say nothing
        self.assertEqual([(row["sensors"], row["draws"]) for row in sites.robustness(5 * changes)],
                         [(1, 10), (2, 10)] * 3)

    def test_masts_keep_below_surfaces_unless_the_plan_says_otherwise(self):
        """Surfaces are those that ObstacleLimits has by hand."""
        def sites(**of):
            return Sites(Plan({**read_plan(COVERAGE), "places": 100, "siting": {
                                   "spacing": 300, "bounds": [-2000, 2600, -2600, 2600], "masts": [5, 10], "draws": 0,
                                   **of}}))
        whole, kept = sites(surfaces=False), sites()
        self.assertEqual(whole.pierced, {})
        self.assertIn("the plan switches the surfaces off", _sites_page.words(whole)["obstacle limits"])
        high = pierced([Surfaces.of(runway, self.scene) for runway in self.runways], whole.positions) > 0
        np.testing.assert_array_equal(kept.positions, whole.positions[~high])
        self.assertEqual(sum(kept.pierced.values()), np.count_nonzero(high))
        self.assertGreater(min(kept.pierced.values()), 0)
        self.assertIn(f"{np.count_nonzero(high)} of {len(high)} candidates", _sites_page.words(kept)["obstacle limits"])
        with self.assertRaisesRegex(al.Error, "siting.surfaces: "):
            x, y = np.mean([self.runways[0].start, self.runways[0].end], axis=0)
            sites(masts=[50], bounds=[x - 200, x + 200, y - 500, y + 500], spacing=100)

    def test_files_say_where_sites_are(self):
        folder = fresh("files")
        sites, value = self.sites[:5], np.linspace(0.5, 0.1, 5)
        siting.write_sites(folder, sites, {"rank": np.arange(1, 6), "value": value}, self.scene.geodetic_origin)
        cloud = al.load_cloud(folder / "sites.vtp")
        np.testing.assert_array_equal(cloud["value"], value)
        np.testing.assert_allclose(cloud.points, sites)
        np.testing.assert_allclose(np.genfromtxt(folder / "sites.csv", delimiter=",", skip_header=1)[:, :3], sites)
        features = json.loads((folder / "sites.geojson").read_text())["features"]
        self.assertEqual([f["properties"] for f in features], [{"rank": i + 1, "value": value[i]} for i in range(5)])
        degrees = np.array([f["geometry"]["coordinates"] for f in features])
        np.testing.assert_allclose(siting.to_enu(degrees[:, :2], self.scene.geodetic_origin), sites[:, :2], atol=0.01)


class Plans(unittest.TestCase):
    """All that a plan holds is checked before the first site is looked at; what is wrong is named by file and
    member."""

    @classmethod
    def setUpClass(cls):
        cls.folder = fresh("plans")
        cls.shapes = json.loads(PLAN.read_text("utf-8"))

    def write(self, name="my", **changes):
        """A plan's file. @param changes of the plan, to None: without it; as `runway_features` of the runways' file"""
        features = changes.pop("runway_features", None)
        wanted = {"scene": str(SCENE), "sensor": {"preset": "Airport16", "azimuth_step": 5.0}, "runways": str(PLAN),
                  "places": 20, "heights": [15], "spacing": 500, "siting": {"spacing": 1500, "draws": 1, "sensors": 1}}
        if features is not None:
            (self.folder / "airport.geojson").write_text(json.dumps({**self.shapes, "features": features}))
            wanted["runways"] = "airport.geojson"
        file = self.folder / f"{name}.coverage.json"
        file.write_text(json.dumps({key: value for key, value in {**wanted, **changes}.items() if value is not None}))
        return file

    def said(self, file):
        """What the command says of a plan that is refused before any site is looked at."""
        with unittest.mock.patch.object(_sites, "look", side_effect=AssertionError("looked")):
            words = error_of("siting", file, "-o", self.folder / "out")
        self.assertEqual(words.count("\n"), 1)
        return words

    def test_wrong_plans_are_named(self):
        lattice = {"spacing": 1500}
        (self.folder / "none.geojson").write_text(st.features())
        (self.folder / "nowhere.lidarscene.json").write_text(
            '{"version": 1, "objects": [{"ground": {"size": 100}, "material": "wall"}]}')
        for member, change in (
                ("siting.spacing: ", {"siting": {"spacing": 0.001}}), ("extent: ", {"extent": [1, 0, 0, 1]}),
                ("preset", {"sensor": {}}), ("'heigts' is not known; did you mean 'heights'?", {"heigts": [3]}),
                ("siting: 'mast' is not known; did you mean 'masts'?", {"siting": {**lattice, "mast": [5]}}),
                ("my.coverage.json: 'sensors' is not known; did you mean 'sensor'?",
                 {"sensor": None, "sensors": {"preset": "Search905"}}),
                ("spread: 'distanse' is not known; did you mean 'distance'?", {"spread": "distanse"}),
                ("regions: 'strip' is not known; did you mean 'strips'?", {"regions": {"strip": 1}}),
                ("siting.surfaces: 'categroy' is not known; did you mean 'category'?",
                 {"siting": {**lattice, "surfaces": {"categroy": "precision"}}}),
                ("siting.surfaces.code: '5' is not one of [1, 2, 3, 4]",
                 {"siting": {**lattice, "surfaces": {"code": "5"}}}),
                ("sensor: Sensor: property 'range_gat' is not known; did you mean 'range_gate'?",
                 {"sensor": {"preset": "Search905", "range_gat": 9}}), ("Species", {"coverage": {"species": "dodo"}}),
                ("heights: ", {"heights": [15, 15.0]}), ("heights[0]: ", {"heights": [1e30]}),
                ("heights: -50 m is below the sensor and all surfaces", {"heights": [20, -50]}),
                ("mix: ", {"mix": {"crow": 1.0, "dodo": 1.0}}),
                ("coverage.species: ", {"mix": {"crow": 1}, "coverage": {"species": "crow"}}),
                ("regions: ", {"regions": {"taxiways": 1}}),
                ("siting.masts[0]: ", {"siting": {**lattice, "masts": [0]}}),
                ("coverage: ", {"coverage": {"visibility": -1}}),
                ("sensor: ", {"sensor": {"preset": "Airport16", "pulse_energy": "much"}}),
                ("scene: ", {"scene": "a\0b"}), ("siting.points: ", {"siting": {"points": "none.csv"}}),
                ("siting: no candidate", {"siting": {"spacing": 9000, "bounds": [0, 1, 0, 1]}}),
                ("siting: needs runways", {"runways": None}),
                ("none.geojson: holds no polygon", {"siting": {**lattice, "exclusions": ["none.geojson"]}}),
                ("nowhere.lidarscene.json: has no origin", {"scene": "nowhere.lidarscene.json"})):
            with self.subTest(member):
                file = self.write(**change)
                words = self.said(file)
                self.assertIn(str(file), words)
                self.assertIn(member, words)
        with unittest.mock.patch.object(os, "sysconf", return_value=200):  # 40 kB of memory
            self.assertRegex(self.said(self.write(siting={"spacing": 100})),
                             "my.coverage.json: siting: [0-9,]+ candidates, 1 species and 20 places need")
        file = self.write()
        file.write_text(file.read_text().replace('"places": 20', '"seed": NaN'))
        self.assertIn("my.coverage.json: is not JSON", self.said(file))

    def test_runways_that_are_wrong_are_named(self):
        features = self.shapes["features"]
        line = next(f for f in features if f["properties"].get("kind") == "runway")
        square = next(f for f in features if f["properties"].get("height"))
        for number, wrong in enumerate((None, {**line, "properties": {"kind": "runway", "displaced_end": "far"}},
                                        {**square, "geometry": {"type": "Polygon", "coordinates": [[]]}},
                                        {**line, "geometry": {"type": "LineString",
                                                              "coordinates": [[121.0, 31.0], [121.0, 31.0]]}})):
            file = self.write(runway_features=[*features, wrong])
            with self.subTest(number):
                self.assertRegex(self.said(file),
                                 rf"my.coverage.json: runways: .*airport.geojson: features\[{len(features)}\]")
        (self.folder / "cut.geojson").write_bytes(gzip.compress(PLAN.read_bytes())[:-100])
        self.assertRegex(self.said(self.write(runways="cut.geojson")),
                         "my.coverage.json: runways: .*cut.geojson: its compression by gzip is damaged")

    def test_runways_in_several_lines(self):
        """Lines of one feature that continue one another are one runway, other lines are runways of their own."""
        origin = (53.6, 13.3, 0.0)
        ends = siting.to_geodetic([(-900, 0, 0), (-10, 1, 0), (10, 0, 0), (900, 1, 0), (-900, 300, 0), (900, 300, 0)],
                                  origin)[:, :2].tolist()
        file = self.folder / "lines.geojson"
        for order, wanted in (([(2, 3), (0, 1)], [(-900, 0, 900, 1)]), ([(1, 0), (3, 2)], [(900, 1, -900, 0)]),
                              ([(0, 3), (4, 5)], [(-900, 0, 900, 1), (-900, 300, 900, 300)])):
            shape = {"type": "MultiLineString", "coordinates": [[ends[a], ends[b]] for a, b in order]}
            file.write_text(json.dumps({"features": [{"properties": {"aeroway": "runway", "ref": "09/27"},
                                                      "geometry": shape}]}))
            found = siting.read_runways(file, origin)
            np.testing.assert_allclose([(*one.start, *one.end) for one in found], wanted, atol=1e-3)
            self.assertEqual([(one.name, one.width) for one in found], [("09/27", 45.0)] * len(wanted))
        file.write_text('{"features": [{"properties": {"kind": "runway"}, "geometry": {"type": "MultiLineString", '
                        '"coordinates": []}}]}')
        self.assertRaisesRegex(al.Error, "features.0.: the coordinates of a MultiLineString", siting.read_runways, file,
                               origin)

    def test_runways_that_may_be_one_or_none(self):
        """Two of one name, or on one line, give a warning; closed and private ones are not in use."""
        origin, file = (53.6, 13.3, 0.0), self.folder / "pieces.geojson"

        def read(*rows):
            features = [{"properties": {"aeroway": "runway", **tags},
                         "geometry": {"type": "LineString", "coordinates": siting.to_geodetic(
                                          [(*end, 0) for end in ends], origin)[:, :2].tolist()}} for ends, tags in rows]
            file.write_text(json.dumps({"features": features}))
            found, heard = warned(lambda: siting.read_runways(file, origin))
            return [one.name for one in found], "".join(heard)

        west, east, north = [(-900, 0), (-100, 0)], [(100, 1), (900, 1)], [(-900, 300), (900, 300)]
        far = [(9000, 0), (9900, 0)]
        for one, other, said in (((west, {"ref": "09/27"}), (east, {"ref": "09/27"}),
                                  "pieces.geojson: 09/27 and 09/27 lie on one line, 200 m apart; .* up to 150 m apart"),
                                 ((west, {"ref": "09"}), (east, {"ref": "27"}), "lie on one line"),
                                 ((west, {}), (east, {}), "lie on one line"),
                                 ((west, {"ref": "09/27"}), (west[::-1], {"ref": "09/27"}),
                                  "lie on one line, 0 m apart"),
                                 ((west, {"ref": "09"}), (north, {"ref": "27"}), "09 and 27 have one name"),
                                 ((west, {"ref": "9L"}), (far, {"ref": "27R"}), "9L and 27R have one name"),
                                 ((west, {"name": "Grass"}), (north, {"name": "grass"}), "have one name"),
                                 ((west, {"ref": "09L"}), (north, {"ref": "09R"}), ""), ((west, {}), (north, {}), ""),
                                 ((west, {"ref": "09/27"}), (far, {"ref": "08/26"}), ""),
                                 ((west, {"ref": "09/27"}), ([(-500, -700), (-500, 700)], {"ref": "18/36"}), "")):
            names, heard = read(one, other)
            self.assertEqual(len(names), 2)
            self.assertRegex(heard, f"^{said}$" if not said else said, (one, other))
        # TestExtracts has all tags of runways that are out of use.
        for tags in ({"disused": True}, {"abandoned:aeroway": "runway", "kind": "runway"}, {"status": "closed"},
                     {"other_tags": '"access"=>"private"'}):
            self.assertEqual(read((west, {"ref": "09/27"}), (north, {"ref": "09/27", **tags})), (["09/27"], ""), tags)
        self.assertRaisesRegex(al.Error, "holds no runway in use .left out: private", read,
                               (west, {"access": "private"}))

    def test_runways_that_gdal_writes(self):
        """GDAL's own GeoJSON of OpenStreetMap has most tags in one text. Names and widths are those that `avianlidar
        airport` takes."""
        ways = ({"name": "Main, \"old\"", "ref": "09/27", "width": "45"}, {"ref": "18L/36R", "width": "30 m"},
                {"ref": "18R/36L", "width": "148 ft"}, {"ref": "05/23"}, {"ref": "13/31", "width": "wide"},
                {"ref": "01/19", "surface": "water"}, {"ref": "02/20", "runway": "closed"})
        nodes = "".join(f'<node id="{2 * k + end + 1}" lat="{53.6 + 0.01 * end}" lon="{13.3 + 0.01 * k}"/>'
                        for k in range(len(ways)) for end in range(2))
        text = "".join(f'<way id="{k + 1}"><nd ref="{2 * k + 1}"/><nd ref="{2 * k + 2}"/><tag k="aeroway" v="runway"/>'
                       + "".join(f'<tag k="{key}" v="{value.replace(chr(34), "&quot;")}"/>'
                                 for key, value in way.items()) + "</way>" for k, way in enumerate(ways))
        (self.folder / "a.osm").write_text(f'<osm version="0.6">{nodes}{text}</osm>')
        gdal.VectorTranslate(str(self.folder / "a.geojson"), str(self.folder / "a.osm"), format="GeoJSON",
                             layers=["lines"])
        self.assertIn("other_tags", (self.folder / "a.geojson").read_text())
        found, heard = warned(lambda: siting.read_runways(self.folder / "a.geojson", (53.6, 13.3, 0.0)))
        self.assertEqual([(one.name, round(one.width, 2)) for one in found],
                         [('Main, "old"', 45.0), ("18L/36R", 30.0), ("18R/36L", 45.11), ("05/23", 45.0),
                          ("13/31", 45.0)])
        self.assertEqual([one.partition("a.geojson: ")[2] for one in heard],
                         ["13/31: width is 'wide', expected metres above 0; the runway counts as 45 m wide"])
        extract = read_extract(self.folder / "a.osm", packaged("places/airport.json"))
        rows = [properties_of(one, packaged("places/airport.json")) for one in extract.features]
        self.assertEqual([(one.name, round(one.width, 3)) for one in found],
                         [(row.get("name") or row["ref"], row["width"]) for row in rows])
        # Tags in an object, as of Overpass' JSON, and as the hstore of QGIS; numbers and null beside them
        shape = {"type": "LineString", "coordinates": [[13.3, 53.6], [13.3, 53.61]]}
        for tags in ({"tags": {"aeroway": "runway", "ref": "18/36", "width": "45 m"}},
                     {"aeroway": "RUNWAY", "ref": "18/36", "width": 45, "name": None},
                     {"other_tags": '"aeroway"=>"runway","ref"=>"18/36","width"=>"45"'},
                     {"kind": "runway", "ref": "18/36", "width": "45.0"},
                     {"other_tags": '{"aeroway": "runway", "ref": "18/36"}'},
                     {"source_tags": {"aeroway": "runway", "ref": "18/36"}, "names": {"primary": None}},
                     {"tags": {"aeroway": "runway", "name": None, "ref": "18/36", "width": ""},
                      "meta": {"name": "editor", "width": "wide"}}):
            odd = [{"properties": {"kind": "road", name: text}, "geometry": shape}
                   for name in ("tags", "other_tags", "names")
                   for text in ("{a,b}", "{1: 2}", "{" * 100000, '"a"=>', "[1]", [1], 7, None)]
            (self.folder / "b.geojson").write_text(json.dumps({
                "features": [*odd, {"properties": tags, "geometry": shape}]}))
            one, = siting.read_runways(self.folder / "b.geojson", (53.6, 13.3, 0.0))
            self.assertEqual((one.name, one.width), ("18/36", 45.0))

    def test_points_of_a_spreadsheet(self):
        file = self.write(siting={"points": "points.csv"})
        table = self.folder / "points.csv"
        table.write_bytes(b"\xef\xbb\xbfx, y\r\n300, -900\r\n600, -900\r\n300, -900\r\n")  # as spreadsheets save UTF-8
        sites, (said,) = warned(lambda: Sites(Plan(read_plan(file))))
        np.testing.assert_allclose(sites.positions[:, :2], [(300, -900), (600, -900)])
        self.assertEqual(said[:6], "1 of 3")
        for content, words in (("x,y\n1,2\n3,nan\n", "row 2"), ("x,z\n1,2\n", "columns x and y"),
                               ('x,y\n1,2\n"3,4\n5,6\n', "points.csv: line 3: is not CSV")):
            table.write_text(content)
            with self.subTest(words):
                self.assertRegex(self.said(file), f"my.coverage.json: siting.*{words}")


class BadInput(unittest.TestCase):
    def test_is_named(self):
        scene, sensor = al.Scene(TestCoverage.WALL, material="Wall"), al.Sensor("Search905")
        found, weights = drawn(5, 2, 30, 1)
        for words, work in (("outline", lambda: siting.is_near([(0, 0)], [(0, 0), (1, 1)])),
                            ("spacing", lambda: siting.lattice((0, 1, 0, 1), 0.0)),
                            ("points", lambda: siting.candidates([(0, 0, 0)])),
                            ("share", lambda: siting.weights_of(2, {"a": [0, 1]}, {"a": -1.0}, {"crow": 1.0})),
                            ("'b'", lambda: siting.weights_of(2, {"a": [0, 1]}, {"b": 1.0}, {"crow": 1.0})),
                            ("sites", lambda: siting.look(scene, sensor, [(0, 0)], [(0, 200, 1)], ["crow"])),
                            ("places", lambda: siting.look(scene, sensor, [(0, 0, 2)], [(0, 200)], ["crow"])),
                            ("area_factor",
                             lambda: siting.look(scene, sensor, [(0, 0, 2)], [(0, 200, 1)], ["crow"], area_factor=0.0)),
                            ("array",
                             lambda: siting.look(scene, sensor, [(0, 0, 2)], [(0, 200, 1)], ["crow"], array="none")),
                            ("weights", lambda: siting.search(found, weights[:1], 2)),
                            ("count", lambda: siting.exhaustive(found, weights, 4))):
            with self.assertRaisesRegex((ValueError, al.Error), words):
                work()
