# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar coverage`: maps as GDAL's programs read them, shares, and plans that are wrong."""
import csv
import json
import os
import subprocess
import sys
import unittest

import numpy as np

import avianlidar as al
import exampletools
from avianlidar import siting
from avianlidar._command import main
from avianlidar.apps._maps import Plan, coordinate_system, read_plan
from osgeo import osr

PLAN = os.path.join(exampletools.EXAMPLES, "coverage", "hongqiao.coverage.json")
OUTPUT = os.path.join(exampletools.OUTPUT, "TestCoverageMapsOfTwo")
ORIGIN = (31.1979, 121.3363, 3.0)


def run(*arguments):
    return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = exampletools.folder("TestCoverageMaps")
        with open(PLAN, encoding="utf-8") as file:
            plan = json.load(file)
        for name in ("scene", "runways"):
            plan[name] = os.path.join(os.path.dirname(PLAN), plan[name])
        cls.plan = {**plan, "compare_with": [], "heights": [30, 60], "extent": [-400, 600, -300, 500], "spacing": 20, "places": 1000}
        cls.file = os.path.join(cls.folder, "small.coverage.json")
        with open(cls.file, "w", encoding="utf-8") as file:
            json.dump(cls.plan, file)
        assert main(["coverage", cls.file, "-o", cls.folder, "--sensor-set", "azimuth_range=0,180", "--coverage-set", "species=crow"]) == 0
        sensor = al.Sensor("Search905", position=(0, 0, 3), azimuth_range=(0.0, 180.0))
        cls.cover = al.Coverage(plan["scene"], sensor, species="crow", visibility=23000.0,
                                bounds=(-400, 600, -300, 500, 30, 30), spacing=(20, 20, 1))

    def test_maps_lie_where_they_belong(self):
        info = json.loads(run("gdalinfo", "-json", os.path.join(self.folder, "detection_probability_30m.tif")))
        self.assertEqual(info["size"], [51, 41])
        self.assertEqual(info["geoTransform"], [-410.0, 20.0, 0.0, 510.0, 0.0, -20.0])
        self.assertEqual(info["bands"][0]["type"], "Float32")
        self.assertEqual(info["bands"][0]["description"], "detection_probability at 30 m")
        self.assertIn("assumed", info["metadata"][""]["target"])
        # A corner, to a tenth of a metre, by the coordinates that scenes have.
        west, south, east, north = -410.0, -310.0, 610.0, 510.0
        for name, place in (("lowerLeft", (west, south)), ("upperRight", (east, north))):
            longitude, latitude = json.loads(run("gdalinfo", "-json", os.path.join(self.folder, "status_60m.tif")))["wgs84Extent"][
                "coordinates"][0][1 if name == "lowerLeft" else 3][:2]
            np.testing.assert_allclose(siting.to_enu([(longitude, latitude)], ORIGIN)[0], place, atol=0.1)

    def test_maps_hold_what_coverage_says(self):
        for name in ("detection_probability", "track_probability", "photoelectrons", "minimum_effective_area", "status"):
            text = run("gdal_translate", "-q", "-of", "XYZ", os.path.join(self.folder, f"{name}_30m.tif"), "/vsistdout/")
            rows = np.array([[float(value) for value in line.split()] for line in text.splitlines()])
            x, y = np.meshgrid(np.arange(-400, 601, 20), np.arange(500, -301, -20))
            np.testing.assert_array_equal(rows[:, :2], np.column_stack([x.ravel(), y.ravel()]))
            np.testing.assert_allclose(rows[:, 2].reshape(41, 51)[::-1], self.cover[name][0], rtol=1e-5)
        self.assertGreater(np.count_nonzero(self.cover["status"] == 7), 100)
        names = run("gdalinfo", os.path.join(self.folder, "status_30m.tif"))
        for number, word in enumerate(self.cover.status_names):
            self.assertIn(f"{number}: {word}", names)

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
            self.assertAlmostEqual(found[low] / 400.0, np.count_nonzero((p >= low) & (p < high)), delta=0.2)
        self.assertGreater(min(found.values()), 0.0)
        info = run("ogrinfo", "-al", "-so", os.path.join(self.folder, "detection_probability_30m.geojson"))
        self.assertIn(f"Feature Count: {len(features)}", info)
        self.assertIn("WGS 84", info)
        self.assertIn("effective area", info)

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

    def test_what_is_not_a_number_is_marked(self):
        said = json.loads(run("gdalinfo", "-json", "-stats", os.path.join(self.folder, "minimum_effective_area_60m.tif")))["bands"][0]
        self.assertTrue(np.isfinite(said["maximum"]) and np.isfinite(said["mean"]))

    def test_a_plan_that_compares_has_a_folder_each(self):
        file = os.path.join(self.folder, "both.coverage.json")
        with open(file, "w", encoding="utf-8") as stream:
            json.dump({**self.plan, "compare_with": ["Airport16"], "heights": [30]}, stream)
        self.assertEqual(main(["coverage", file, "-o", os.path.join(OUTPUT, "both")]), 0)
        infos = [json.loads(run("gdalinfo", "-json", os.path.join(OUTPUT, "both", name, "status_30m.tif"))) for name in
                 ("Search905", "Airport16")]
        self.assertEqual([info["metadata"][""]["sensor"] for info in infos], ["Search905", "Airport16"])

    def test_shares_are_the_table(self):
        with open(os.path.join(self.folder, "shares.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["region"] for row in rows}, {"strips", "approaches", "all"})
        self.assertEqual(len({row["species"] for row in rows}), 6)
        points, regions = siting.strips_and_approaches(siting.read_runways(self.plan["runways"], ORIGIN), 1000, heights=(30.0, 60.0))
        self.cover.places, self.cover.height_limits = al.places_of(points, regions), [30.0, 60.0]
        wanted = next(row for row in self.cover.table if row["region"] == "strips" and row["height_from"] == 30.0)
        found = next(row for row in rows if (row["region"], row["species"], row["height_from [m]"]) == ("strips", "crow", "30"))
        self.assertAlmostEqual(float(found["detection_probability"]), wanted["detection_probability"], places=5)
        self.assertEqual(float(found["places"]), wanted["places"])
        self.cover.places = None

    def test_clutter_is_written(self):
        clutter = al.load_cloud(os.path.join(self.folder, "clutter.vtp"))
        self.assertGreater(clutter.number_of_points, 100)

    def test_plans_that_are_wrong_say_where(self):
        for change, words in (({"sensor": {}}, "preset"), ({"spacing": 0}, "spacing"), ({"heigts": [3]}, "heigts"),
                              ({"coverage": {"bounds": [1]}}, "bounds"), ({"scene": "none.lidarscene.json"}, "none.lidarscene.json"),
                              ({"runways": "none.geojson"}, "none.geojson"), ({"coverage": {"species": "dodo"}}, "Species")):
            with open(self.file + ".bad", "w", encoding="utf-8") as file:
                json.dump({**self.plan, **change}, file)
            with self.assertRaises(al.Error) as caught:
                Plan(read_plan(self.file + ".bad")).map_at(30.0).update()
            self.assertIn(words, str(caught.exception))
        self.assertEqual(main(["coverage", self.file + ".none", "-o", self.folder]), 2)


if __name__ == "__main__":
    sys.exit(unittest.main())
