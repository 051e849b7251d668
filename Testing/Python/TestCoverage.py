# SPDX-License-Identifier: BSD-3-Clause
"""Coverage: ranges in free space, shares at an airport calculated elsewhere, gdal_viewshed's lines of sight, birds that
are flown through the echo filter, and what may not change the result."""
import math
import os
import subprocess
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import (vtkImageData, vtkPointSet, vtkPolyData, vtkRectilinearGrid,
                                           vtkUnstructuredGrid)
from vtkmodules.vtkFiltersCore import vtkPassThrough

import avianlidar as al
import exampletools
import flown
import flown_sensors
from avianlidar import siting
from avianlidar.vtkAvianLidar import vtkAvianLidarCoverage
from echotools import given
from helpertools import wall

AIRPORT = os.path.join(exampletools.EXAMPLES, "airport", "scene")
AIR = 8.9e-5  # 1/m
AREAS = (0.0052, 0.011, 0.018, 0.030, 0.067)  # m2
# Threshold (photoelectrons) and the ranges (m) at which a target of these areas and reflectance 0.3 gives as many in
# clear air.
SENSORS = {
    ("Search905", ()): (664.069, (436.15, 523.95, 590.83, 668.98, 812.60)),
    ("Search905", (("background_radiance", 0.0),)): (334.651, (515.82, 619.23, 697.91, 789.75, 958.23)),
    ("Search1550", ()): (423.621, (1116.45, 1339.81, 1509.67, 1707.81, 2071.05)),
    ("Automotive16", ()): (326.510, (93.28, 112.40, 127.05, 144.24, 176.08))}
NOTHING = (np.zeros((0, 3)), np.zeros((0, 3), dtype=int))
REGION = {"bounds": (-200.0, 200.0, 20.0, 300.0, 0.0, 30.0), "spacing": (40.0, 40.0, 10.0)}
SHAPE = (11, 8, 4)  # places of the region
TARGET = {"species": "", "effective_area": 0.03}  # m2: quicker than a bird, of which many views are made
WALL = wall(50, 9)


def airport():
    return al.load_scene(os.path.join(AIRPORT, "hongqiao.lidarscene.json"))


class FreeSpace(unittest.TestCase):
    def test_ranges_of_five_targets_and_four_sensors(self):
        scene = al.Scene(NOTHING, material="Wall")
        for (preset, changes), (threshold, ranges) in SENSORS.items():
            sensor = al.Sensor(preset, **dict(changes))
            elevation = math.radians(1.0 if preset == "Automotive16" else 3.0)  # of a channel, or within the band
            way = np.array([0.0, math.cos(elevation), math.sin(elevation)])
            places = [share * distance * way for distance in ranges for share in (1.0, 0.99, 1.01)]
            cover = al.Coverage(scene, sensor, places=places, species="", clutter=False)
            for number, cover.effective_area in enumerate(AREAS):
                here, near, far = cover["photoelectrons"][3 * number:3 * number + 3]
                self.assertGreater(near, threshold, (preset, number))
                self.assertLess(far, threshold, (preset, number))
                self.assertAlmostEqual(here / threshold, 1.0, delta=0.02)

    def test_a_height_limit_more(self):
        cover = al.Coverage(al.Scene(WALL, material="Wall"), al.Sensor("Search905"), **TARGET, places=[(0, 200, 1)],
                            clutter=False, height_limits=[])
        self.assertEqual(len(cover.table), 1)
        cover.algorithm.AddHeightLimit(0.0)
        self.assertEqual(len(cover.table), 2)

    def test_the_same_filter_for_a_bird_that_glides(self):
        def made(gliding):
            return al.Coverage(al.Scene(NOTHING, material="Wall"), al.Sensor("Search905"), species="herring gull",
                               places=[(0, 200, 10)], clutter=False, gliding=gliding)
        cover = made(False)
        before = float(cover["photoelectrons"][0])
        cover.gliding = True
        self.assertEqual(cover["photoelectrons"][0], made(True)["photoelectrons"][0])
        self.assertGreater(before, 1.2 * cover["photoelectrons"][0])


class Airport(unittest.TestCase):
    """The reference shares are of 12,000 places by an independent program: birds without mutual shadow of body and
    wings (gull 0.0297 m2), points for the beams, one beam per direction, pulses not shared between units, 0 to 0.004 by
    chance."""

    @classmethod
    def setUpClass(cls):
        cls.scene = airport()
        runways = siting.read_runways(os.path.join(AIRPORT, "hongqiao.geojson"), cls.scene.geodetic_origin)
        cls.middle = 0.5 * (np.array(runways[0].start) + runways[0].end)
        cls.points, cls.regions = siting.strips_and_approaches(runways, 12000, seed=1)
        # Effective areas of gulls of random heading and wing phase, over their mean.
        sensor = al.Sensor("Search905")
        empty = al.Scene(NOTHING, material="Wall")
        random = np.random.default_rng(2)
        birds = flown.birds_of("herring gull")
        scan = al.Scan(empty, sensor, movers=[flown.placed(birds[random.integers(flown.PHASES)], i,
                                                           (0.1 * i, 900.0, 47.0), random.uniform(0, 2 * math.pi))
                                              for i in range(400)])
        areas = np.sort(scan.mover_report["effective_area"])
        cls.relative = areas.reshape(20, 20).mean(axis=1) / areas.mean()

    def cover(self, preset, places=None, **settings):
        sensor = al.Sensor(preset, position=(*self.middle, 3.0))
        return al.Coverage(self.scene, sensor,
                           places=al.places_of(self.points, self.regions) if places is None else places, visibility=0.0,
                           attenuation_coefficient=AIR, clutter=False, **settings)

    def test_shares_calculated_elsewhere(self):
        threshold, dark, excess = 664.069, 119.062, 3.0
        cover = self.cover("Search905", species="")
        for area, wanted in ((0.0297, 0.124), (0.0052, 0.045), (0.0670, 0.174)):
            cover.effective_area = area
            n = cover["photoelectrons"][:, None] * self.relative
            p = 0.5 * np.vectorize(math.erfc)((threshold - n) / np.sqrt(2 * (dark ** 2 + excess * n)))
            self.assertAlmostEqual(p.mean(), wanted, delta=0.01)
        shares = cover.table[-1]
        in_band = 1.0 - sum(shares[f"share_{s}"] for s in ("outside_the_gate", "above_the_band", "below_the_band"))
        elevation = np.degrees(np.arctan2(self.points[:, 2] - 3.0,
                                          np.linalg.norm(self.points[:, :2] - self.middle, axis=1)))
        self.assertAlmostEqual(np.mean((elevation > -0.32) & (elevation < 5.95)), 0.944, delta=0.01)
        far = np.linalg.norm(self.points - [*self.middle, 3.0], axis=1) > 4000.0
        self.assertAlmostEqual(in_band, np.mean((elevation > -0.32) & (elevation < 5.95) & ~far), delta=0.002)
        self.assertAlmostEqual(1.0 - shares["share_shadowed"], 0.997, delta=0.01)

    def test_shares_by_the_full_definition(self):
        """Mean share of gulls as points over their effective areas. Birds are not points: they are deep, and borders of
        beams cross them."""
        cover, shares = self.cover("Search905", species=""), []
        for area in self.relative:
            cover.effective_area = 0.0297 * area
            shares.append(cover["detection_probability"].astype(float))
        points = np.mean(shares, axis=0)
        self.assertAlmostEqual(points.mean(), 0.116, delta=0.01)
        birds = self.cover("Search905", self.points[::10], species="herring gull", effective_area=0.0297)
        gull = birds["detection_probability"].mean()
        birds.effective_area = 0.0
        self.assertLess(birds["detection_probability"].mean(), gull)
        self.assertTrue(0.8 * points[::10].mean() < gull < points[::10].mean(), gull)

    def test_table_is_the_mean_of_the_places(self):
        """Regions and heights; weights of strikes by height: 74 % below 152.4 m, the others falling by 0.001265 a
        metre."""
        strips = np.isin(np.arange(len(self.points)), self.regions["strips"])[::20]
        places, heights = self.points[::20], self.points[::20, 2]
        cover = self.cover("Search905", al.places_of(places, {"strips": np.flatnonzero(strips),
                                                              "approaches": np.flatnonzero(~strips)}))
        p, track = cover["detection_probability"], cover["track_probability"]
        rows = {(r["region"], r["species"], r["height_from"]): r for r in cover.table}
        for region, where in (("strips", strips), ("approaches", ~strips), ("all", strips | ~strips)):
            for low, high in ((0.0, 15.0), (60.0, 150.0), (-np.inf, np.inf)):
                chosen = where & (heights >= low) & (heights < high)
                if not chosen.any():
                    continue
                row = rows[region, "herring gull", low]
                self.assertEqual(row["places"], chosen.sum())
                for name, values in (("detection", p[chosen]), ("track", track[chosen])):
                    self.assertAlmostEqual(row[f"{name}_probability"], values.mean(), delta=1e-6)
                    self.assertAlmostEqual(row[f"{name}_std_error"], values.std(ddof=1) / math.sqrt(len(values)),
                                           delta=1e-6)
        cover.set(strike_height_weights=True)
        weight = np.where(heights <= 152.4, 0.74 / 152.4, 0.26 * 0.001265 * np.exp(-0.001265 * (heights - 152.4)))
        self.assertAlmostEqual(cover.table[-1]["detection_probability"], np.average(p, weights=weight), delta=1e-3)
        np.testing.assert_allclose([v for n, v in cover.table[-1].items() if n.startswith("share_")],
                                   np.bincount(cover["status"], weights=weight, minlength=8) / weight.sum(), atol=1e-3)

    def test_birds_that_are_flown(self):
        """The mean of 40 places varies by up to 0.5/sqrt(400) = 0.025 of a scan's result, that of the expected
        probabilities by a third."""
        sensor = al.Sensor("Search905", position=self.scene.lidar_position, azimuth_range=(60.0, 120.0))
        random = np.random.default_rng(7)
        bearing, away = np.radians(random.uniform(60.5, 119.0, 40)), 750 * np.sqrt(random.uniform(0.01, 1, 40))
        places = np.column_stack([away * np.sin(bearing), away * np.cos(bearing), random.uniform(8, 50, 40)])
        p = al.Coverage(self.scene, sensor, places=places, visibility=0.0, clutter=False,
                        attenuation_coefficient=AIR)["detection_probability"].astype(float)
        seen, expected = flown.fly(self.scene, sensor, places, 10, "herring gull", AIR, rays=3000)
        result = flown.compare(p, seen, 10)
        self.assertGreater(np.count_nonzero((p > 0.1) & (p < 0.9)), 8)
        self.assertLess(abs(result["bias"]), 0.03)
        self.assertLess(abs((expected - p).mean()), 0.025)
        self.assertLessEqual(result["outside_99.73_percent"], 0.025)

    def test_near_birds_that_hundreds_of_beams_meet(self):
        """The wings of a gull 4.8 m away span more beams than are followed, between channels 5 degrees apart."""
        sensor = al.Sensor("Pandar40P")
        random = np.random.default_rng(3)
        up = np.array(sensor.channel_elevations)
        bearing = np.radians(np.arange(16) * 22.5 + random.uniform(0, 5, 16))
        elevation = np.radians(random.uniform(up.min(), up.max(), 16))
        places = 4.8 * np.column_stack([np.cos(elevation) * np.sin(bearing), np.cos(elevation) * np.cos(bearing),
                                        np.sin(elevation)])
        scene = al.Scene(([(0, 0, -900), (1, 0, -900), (0, 1, -900)], [(0, 1, 2)]))
        p = al.Coverage(scene, sensor, places=places, visibility=0.0, clutter=False,
                        attenuation_coefficient=AIR)["detection_probability"]
        seen, _ = flown.fly(scene, sensor, places, 15, "herring gull", AIR, rays=100)
        self.assertLess(abs(p.mean() - seen.mean()), 0.025)


class Terrain(unittest.TestCase):
    def test_lines_of_sight_are_those_of_gdal_viewshed(self):
        n, cell, above, mast = 161, 10.0, 12.0, 5.0
        random = np.random.default_rng(11)
        x = (np.arange(n) - n // 2) * cell
        east, north = np.meshgrid(x, x)
        height = np.zeros((n, n))
        for _ in range(40):
            cx, cy, wide = random.uniform(-800, 800), random.uniform(-800, 800), random.uniform(40, 250)
            height += random.uniform(5, 45) * np.exp(-((east - cx) ** 2 + (north - cy) ** 2) / (2 * wide ** 2))
        height = np.round(height, 3)
        folder = exampletools.folder("TestCoverageTerrain")
        dem, seen_file, text = (os.path.join(folder, name) for name in ("dem.asc", "seen.tif", "seen.asc"))
        with open(dem, "w", encoding="ascii") as file:
            file.write(f"ncols {n}\nnrows {n}\nxllcorner {x[0] - cell / 2}\nyllcorner {x[0] - cell / 2}\ncellsize "
                       f"{cell}\n")
            np.savetxt(file, height[::-1], fmt="%.3f")
        subprocess.run(["gdal_viewshed", "-q", "-ox", "0", "-oy", "0", "-oz", str(mast), "-tz", str(above), "-cc", "0",
                        "-md", "0", dem, seen_file], check=True)
        subprocess.run(["gdal_translate", "-q", "-of", "AAIGrid", seen_file, text], check=True,
                       stderr=subprocess.DEVNULL)
        with open(text, encoding="ascii") as file:
            rows = [line for line in file if not line[0].isalpha()]
        theirs = np.loadtxt(rows)[::-1] > 0
        points = np.column_stack([east.ravel(), north.ravel(), height.ravel()])
        corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        triangles = np.concatenate([np.column_stack([corner, corner + 1, corner + n + 1]),
                                    np.column_stack([corner, corner + n + 1, corner + n])])
        # Beams of 59 degrees half-beamwidth to all sides: every place is in the band.
        sensor = al.Sensor("Search905", position=(0.0, 0.0, height[n // 2, n // 2] + mast), half_beamwidth=1.03,
                           azimuth_step=90.0, channel_elevations=(-90.0, 0.0, 90.0), range_gate=3000.0)
        cover = al.Coverage(al.Scene((points, triangles), material="Wall"), sensor, places=points + [0.0, 0.0, above],
                            species="", effective_area=1e3, number_of_reflections=1)
        status = cover["status"].reshape(n, n)
        self.assertFalse(np.any(status < vtkAvianLidarCoverage.STATUS_SHADOWED))
        ours = status != vtkAvianLidarCoverage.STATUS_SHADOWED
        self.assertGreater(np.count_nonzero(~ours), 2000)
        differ = ours != theirs
        self.assertLessEqual(differ.mean(), 0.005)
        # The rest lies within a cell of a shadow's edge.
        padded = np.pad(ours, 1, mode="edge")
        around = np.stack([padded[1 + i:n + 1 + i, 1 + j:n + 1 + j] for i in (-1, 0, 1) for j in (-1, 0, 1)])
        self.assertTrue(np.all((around.any(axis=0) & ~around.all(axis=0))[differ]))


class Work(unittest.TestCase):
    def test_threads_and_pieces_change_no_bit(self):
        """Pieces of any output and of both kinds of places count each place once, and the clutter is in the first."""
        scene, sensor = al.Scene(WALL, material="Wall"), al.Sensor("Search905", azimuth_range=(-30.0, 30.0))
        wanted = al.Coverage(scene, sensor, **REGION, **TARGET, number_of_threads=1)["detection_probability"]
        image = given(vtkImageData(), Dimensions=SHAPE, Origin=(-200, 20, 0), Spacing=(40, 40, 10))
        for places, port, ghosts in ((None, 0, 0), (None, 1, 0), (image, 0, 1), (image, 2, 1)):
            cover = al.Coverage(scene, sensor, places=places, **REGION, **TARGET)
            counts, clutter = [], []
            for piece in range(3):
                if port == 1:  # VTK 9.3 makes no other piece of a table that is there
                    cover = al.Coverage(scene, sensor, places=places, **REGION, **TARGET)
                passed = vtkPassThrough()
                passed.SetInputConnection(cover.algorithm.GetOutputPort(port))
                passed.UpdatePiece(piece, 3, ghosts)
                data, table, points = map(cover.algorithm.GetOutputDataObject, range(3))
                rows = table.GetNumberOfRows()
                counts.append(table.GetColumnByName("places").GetValue(rows - 1) if rows else 0)
                clutter.append(points.GetNumberOfPoints())
                if port == ghosts == 0:
                    x0, x1, y0, y1, z0, z1 = data.GetExtent()
                    values = al._cloud.as_numpy(data.GetPointData().GetArray(
                                                    "detection_probability")).reshape(data.GetDimensions()[::-1])
                    np.testing.assert_array_equal(values, wanted[z0:z1 + 1, y0:y1 + 1, x0:x1 + 1])
            self.assertEqual(sum(counts), math.prod(SHAPE), (places, port, ghosts, counts))
            self.assertGreater(clutter[0], 0)
            self.assertEqual(clutter[1:], [0, 0])
        ghostly = al.places_of([(0, 200, 1), (100, 200, 1)])
        ghostly.AllocatePointGhostArray()
        ghostly.GetPointGhostArray().SetValue(0, 1)
        self.assertEqual(al.Coverage(scene, sensor, places=ghostly, **TARGET).table[-1]["places"], 1)

    def test_beams_wider_and_narrower_than_the_bird(self):
        """A gull on the axis of a beam that is narrower than itself is seen; everywhere else as often as coverage
        states."""
        place = 35.0 * np.array([[0.0, math.cos(math.radians(1.0)), math.sin(math.radians(1.0))]])
        p = flown_sensors.stated(al.Sensor("VLP16"), "herring gull", place)[0]
        self.assertGreater(p, 0.9)
        _, expected = flown.fly(al.Scene(NOTHING, material="Wall"), al.Sensor("VLP16"), place, 30, "herring gull", AIR,
                                400)
        self.assertAlmostEqual(p, expected[0], delta=0.05)
        row = flown_sensors.compare("VLP16", "herring gull", 50, 10)
        self.assertGreater(row["between"], 5)
        self.assertLess(abs(row["bias"]), 0.03)  # 500 flights: at most 0.023 by chance
        self.assertLess(abs(row["expected"] - row["stated"]), 0.02)
        self.assertLessEqual(row["outside_99.73_percent"], 0.03)

    def test_several_sensors_and_the_same_bird(self):
        """The mean over poses is the probability, and of a pose sensors are independent. What poses are is
        TestBirdViews' (kernel)."""
        scene = al.Scene(NOTHING, material="Wall")
        sensor = al.Sensor("Search905", azimuth_range=(-60.0, 60.0))
        sites = np.array([(0.0, 0.0, 0.0), (700.0, 0.0, 0.0)])
        random = np.random.default_rng(3)
        places = random.uniform((290, 350, 8), (410, 500, 40), (40, 3))
        alone, by_pose = [], []
        cover = al.Coverage(scene, sensor, places=places, species="herring gull", visibility=0.0,
                            attenuation_coefficient=AIR, pose_probabilities=True)
        for site in sites:
            sensor.position = tuple(site)
            alone.append(cover["detection_probability"].copy())
            poses = cover["pose_probabilities"].copy()
            self.assertEqual(poses.shape, (40, 80))
            np.testing.assert_allclose(poses.mean(axis=1), alone[-1], atol=0.012)
            by_pose.append(poses)
        stated = 1.0 - np.prod([1.0 - poses for poses in by_pose], axis=0).mean(axis=1)
        independent = 1.0 - (1.0 - alone[0]) * (1.0 - alone[1])
        self.assertGreater(np.abs(independent - stated).max(), 0.02)
        image = al.Coverage(scene, sensor, bounds=(0, 100, 300, 340, 10, 20), spacing=(20, 20, 10),
                            pose_probabilities=True, gliding=True)
        self.assertEqual(image["pose_probabilities"].shape, (2, 3, 6, 80))
        point = al.Coverage(scene, sensor, places=[(0, 300, 10)], species="", effective_area=0.03,
                            pose_probabilities=True)
        self.assertEqual(point["pose_probabilities"].size, 1)
        weights = np.full((1, len(places)), 1.0 / len(places))
        value = siting.value_of_same_birds(scene, sensor, sites, places, ["herring gull"], weights, visibility=0.0,
                                           attenuation_coefficient=AIR)
        self.assertAlmostEqual(value, stated.mean(), delta=1e-5)
        for words, chosen, of in (("weights have the shape", sites, weights[:, 1:]),
                                  ("weights have -1", sites, -weights * len(places)),
                                  ("sites have the shape", sites[0], weights)):
            with self.assertRaisesRegex(ValueError, words):
                siting.value_of_same_birds(scene, sensor, chosen, places, ["herring gull"], of)

    def test_places_of_any_kind(self):
        scene, sensor = al.Scene(WALL, material="Wall"), al.Sensor("Search905", azimuth_range=(-30.0, 30.0))
        grid, plain = vtkUnstructuredGrid(), vtkPointSet()
        for data in (grid, plain):
            data.SetPoints(al.places_of([(0, 200, 1), (100, 200, 1)]).GetPoints())
        image = given(vtkImageData(), Dimensions=(2, 1, 1), Origin=(0, 200, 1), Spacing=(100, 1, 1))
        for places in (grid, image, plain):
            cover = al.Coverage(scene, sensor, places=places, clutter=False, **TARGET)
            self.assertEqual(cover["status"].ravel().tolist(), [4, 7])
            self.assertEqual(cover.data.GetClassName(), places.GetClassName())

    def test_clutter_is_the_scan_of_the_echo_filter(self):
        scene, sensor = al.Scene(WALL, material="Wall"), al.Sensor("Search905", azimuth_range=(-30.0, 30.0))
        clutter = al.Coverage(scene, sensor, visibility=0.0, attenuation_coefficient=AIR, **TARGET).clutter_map
        echoes = al.Scan(scene, sensor, noise=False, return_mode="RangeUnits",
                         attenuation_coefficient=AIR).echoes
        self.assertGreater(len(echoes.points), 100)
        np.testing.assert_array_equal(clutter["energy_received"], echoes["energy_received"])
        np.testing.assert_array_equal(clutter.points, echoes.points)
        often = clutter["detection_probability"]
        self.assertTrue(np.all((often > 0.49) & (often <= 1.0)))
        without = al.Coverage(scene, sensor, clutter=False, **TARGET)
        self.assertEqual(without.clutter_map.number_of_points, 0)
        self.assertFalse(np.any(without["status"] == vtkAvianLidarCoverage.STATUS_IN_CLUTTER))
        self.assertEqual(without.number_of_traced_rays, 0)

    def test_clutter_follows_each_change_of_the_scan(self):
        scene, sensor = al.Scene(WALL, material="Wall"), al.Sensor("Search905", azimuth_range=(-30.0, 30.0))
        turned = vtkPolyData()
        turned.DeepCopy(sensor.beams.data)
        azimuth = turned.GetPointData().GetArray("azimuth")
        azimuth.SetComponent(0, 0, azimuth.GetComponent(0, 0) + 1.0)
        near = al.Sensor("Search905", azimuth_range=(-30.0, 30.0), position=(0.0, 100.0, 1.0))
        settings, kept = dict(TARGET), al.Coverage(scene, sensor, places=[(0, 200, 1)], **TARGET)
        for of, change in ((sensor, {}), (sensor, {"effective_area": 0.5}), (sensor, {"visibility": 500.0}), (near, {}),
                           (turned, {}), (turned, {"rays_per_beam": 7}), (sensor, {"clutter": False}),
                           (sensor, {"clutter": True})):
            settings.update(change)
            kept.sensor = of
            found, again = (cover.clutter_map for cover in (kept.set(**settings),
                                                            al.Coverage(scene, of, places=[(0, 200, 1)], **settings)))
            with self.subTest(change=change):
                self.assertEqual(set(found), set(again))
                np.testing.assert_array_equal(found.points, again.points)
                for name in found:
                    np.testing.assert_array_equal(found[name], again[name])
        kept.places = [(0, 100, 1), (0, 200, 1)]
        self.assertEqual(len(kept["status"]), 2)
        self.assertEqual((kept.number_of_traced_rays, kept.clutter_map.number_of_points), (0, found.number_of_points))

    def test_an_empty_scene_is_not_an_error(self):
        scene = al.Scene(NOTHING, material="Wall")
        cover = al.Coverage(scene, al.Sensor("Search905"), places=np.zeros((0, 3)), **TARGET)
        self.assertEqual(len(cover["status"]), 0)
        self.assertEqual(cover.table, [])

    def test_bad_input_is_named_and_the_next_good_works(self):
        scene, sensor = al.Scene(WALL, material="Wall"), al.Sensor("Search905", azimuth_range=(-30.0, 30.0))
        cover = al.Coverage(scene, sensor, places=[(100, 200, 1)], clutter=False, **TARGET)
        wrong = al.places_of([(100, 200, 1)], {"here": [0]})
        wrong.GetPointData().GetArray("region_id").SetNumberOfTuples(3)
        box = (0.0, 100.0, 0.0, 100.0, 0.0, 15.0)
        for bad, good, words in (({"species": "dodo"}, {"species": ""}, "Species"),
                                 ({"effective_area": -1.0}, {"effective_area": 0.1}, "EffectiveArea"),
                                 ({"number_of_scans": 0}, {"number_of_scans": 3}, "NumberOfScans"),
                                 ({"required_detections": 4}, {"required_detections": 2}, "RequiredDetections"),
                                 ({"height_limits": (10.0, 5.0)}, {"height_limits": (5.0, 10.0)}, "HeightLimits"),
                                 ({"places": [(np.nan, 0, 0)]}, {"places": [(100, 200, 1)]}, "port 2"),
                                 ({"places": wrong}, {"places": [(100, 200, 1)]}, "region_id"),
                                 ({"places": None, "spacing": (1e-9, 1e-9, 1e-9)},
                                  {"spacing": (20.0, 20.0, 15.0), "bounds": box}, "Spacing|need"),
                                 ({"bounds": (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)}, {"bounds": box}, "Bounds")):
            for name, value in bad.items():
                setattr(cover, name, value)
            with self.subTest(words), self.assertRaisesRegex(al.Error, words):
                cover.update()
            for name, value in good.items():
                setattr(cover, name, value)
            status = cover["status"]
            self.assertTrue(status.tolist() == [7] or status.shape == (2, 6, 6), bad)
        # Before any of them is looked at: 1e15 places would take years.
        # more than 2^63
        for extent, words in (((0, 99999, 0, 99999, 0, 99999), r"port 2 \(places\), 1e\+15 places need about"),
                              ((0, 2147483646, 0, 2147483646, 0, 3),
                               r"port 2 \(places\), 1.8[0-9]*e\+19 places need about"),
                              ((0, 3, 7, 2, 4, -4), "port 2 .* from 7 to 2 on axis 1")):
            # Images of VTK 9.3 keep each coordinate of an axis, and end the program for an axis that has none.
            grids = [vtkRectilinearGrid]
            if vtkVersion.GetVTKMinorVersion() < 3 or max(extent) == 99999:
                grids.append(vtkImageData)
            for make in grids:
                grid = make()
                grid.SetExtent(extent)
                with self.assertRaisesRegex(al.Error, words):
                    al.Coverage(scene, sensor, places=grid).update()
        self.assertEqual(al.Coverage(scene, sensor, places=vtkImageData(), **TARGET)["status"].size, 0)
