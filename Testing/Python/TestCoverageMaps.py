# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar coverage`: maps as GDAL's programs read them. Shares are TestReport's, plans that are wrong
TestSiting's."""
import json
import os
import subprocess
import unittest

import numpy as np

import avianlidar as al
import exampletools
import helpertools
from avianlidar import siting
from avianlidar._command import main
from avianlidar.apps.places._gdal import coordinate_system
from osgeo import osr
from reporttools import airport, written

ORIGIN = (31.1979, 121.3363, 3.0)


def run(*arguments):
    return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = exampletools.folder("TestCoverageMaps")
        plan = airport(heights=[30], extent=[-400, 600, -300, 500], spacing=50, places=100)
        assert main(["coverage", str(written("small", plan)), "-o", cls.folder, "--sensor-set", "azimuth_range=0,180",
                     "--coverage-set", "species=crow"]) == 0
        sensor = al.Sensor("Search905", position=(0, 0, 3), azimuth_range=(0.0, 180.0))
        cls.cover = al.Coverage(plan["scene"], sensor, species="crow", visibility=23000.0,
                                bounds=(-400, 600, -300, 500, 30, 30), spacing=(50, 50, 1))

    def test_maps_lie_where_they_belong(self):
        info = json.loads(run("gdalinfo", "-json", os.path.join(self.folder, "detection_probability_30m.tif")))
        self.assertEqual(info["size"], [21, 17])
        self.assertEqual(info["geoTransform"], [-425.0, 50.0, 0.0, 525.0, 0.0, -50.0])
        self.assertEqual((info["bands"][0]["type"], info["bands"][0]["description"]),
                         ("Float32", "detection_probability at 30 m"))
        self.assertIn("assumed", info["metadata"][""]["target"])
        # to a tenth of a metre, by the coordinates that scenes have
        for corner, place in ((1, (-425.0, -325.0)), (3, (625.0, 525.0))):
            longitude, latitude = info["wgs84Extent"]["coordinates"][0][corner][:2]
            np.testing.assert_allclose(siting.to_enu([(longitude, latitude)], ORIGIN)[0], place, atol=0.1)

    def test_maps_hold_what_coverage_says(self):
        for name in ("detection_probability", "track_probability", "photoelectrons", "minimum_effective_area",
                     "status"):
            text = run("gdal_translate", "-q", "-of", "XYZ", os.path.join(self.folder, f"{name}_30m.tif"),
                       "/vsistdout/")
            rows = np.array([[float(value) for value in line.split()] for line in text.splitlines()])
            x, y = np.meshgrid(np.arange(-400, 601, 50), np.arange(500, -301, -50))
            np.testing.assert_array_equal(rows[:, :2], np.column_stack([x.ravel(), y.ravel()]))
            found, wanted = rows[:, 2].reshape(17, 21)[::-1], self.cover[name][0]
            np.testing.assert_allclose(found[np.isfinite(wanted)], wanted[np.isfinite(wanted)], rtol=1e-5)
        self.assertGreater(np.count_nonzero(self.cover["status"] == 7), 20)
        names = run("gdalinfo", "-stats", os.path.join(self.folder, "status_30m.tif"))
        for number, word in enumerate(self.cover.status_names):
            self.assertIn(f"{number}: {word}", names)
        said = json.loads(run("gdalinfo", "-json", "-stats",
                              os.path.join(self.folder, "minimum_effective_area_30m.tif")))["bands"][0]
        self.assertTrue(np.isfinite(said["maximum"]) and np.isfinite(said["mean"]))  # missing values are marked
        self.assertGreater(al.load_cloud(os.path.join(self.folder, "clutter.vtp")).number_of_points, 100)

    def test_the_birds_of_a_mix_are_named(self):
        """The share that the command prints is the mean over the species, not that of the first species."""
        plan = airport(heights=[30], extent=[-100, 100, -100, 100], spacing=100, places=50, coverage={"clutter": False},
                       mix={"crow": 3, "herring gull": 1})
        folder = exampletools.folder("TestCoverageMapsMix")
        code, words, _ = helpertools.run("coverage", written("mix", plan), "-o", folder)
        self.assertEqual(code, 0)
        self.assertIn("bird (crow 75 %, herring gull 25 %) detected in one scan", words)

    def test_areas_are_those_of_the_map(self):
        p = self.cover["detection_probability"][0]
        with open(os.path.join(self.folder, "detection_probability_30m.geojson"), encoding="utf-8") as file:
            features = json.load(file)["features"]
        found = {0.1: 0.0, 0.5: 0.0, 0.9: 0.0}
        for feature in features:
            for number, ring in enumerate(feature["geometry"]["coordinates"]):
                x, y = siting.to_enu(ring, ORIGIN).T
                area = 0.5 * abs(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1]))
                found[feature["properties"]["probability_from"]] += area if number == 0 else -area
        for low, high in ((0.1, 0.5), (0.5, 0.9), (0.9, 1.1)):
            self.assertAlmostEqual(found[low] / 2500.0, np.count_nonzero((p >= low) & (p < high)), delta=0.2)
        self.assertGreater(max(found.values()), 0.0)
        info = run("ogrinfo", "-al", "-so", os.path.join(self.folder, "detection_probability_30m.geojson"))
        self.assertIn(f"Feature Count: {len(features)}", info)
        self.assertIn("WGS 84", info)

    def test_coordinates_hold_at_any_height(self):
        points = np.array([(3000.0, 0.0, 0.0), (0.0, 3000.0, 0.0), (-2000.0, -2000.0, 0.0)])
        for origin in (ORIGIN, (39.86, -104.67, 1655.0), (-16.5, -68.2, 4061.0), (78.2, 15.5, 28.0)):
            system = coordinate_system(origin)
            degrees = osr.SpatialReference()
            degrees.ImportFromEPSG(4326)
            degrees.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
            there = osr.CoordinateTransformation(degrees, system)
            found = [there.TransformPoint(lon, lat)[:2] for lon, lat, _ in siting.to_geodetic(points, origin)]
            np.testing.assert_allclose(found, points[:, :2], atol=0.012)
