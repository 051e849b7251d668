# SPDX-License-Identifier: BSD-3-Clause
"""GeoJSON against GDAL's own programs: ogrinfo opens it, ogr2ogr finds every point and property."""

import csv
import io
import json
import os
import subprocess
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, assert_refused, cloud, echoes, field, geodetic, names, write
from echotools import array

FILE = "TestGeoJSONWriter.geojson"
# Half of the ninth decimal of a degree and of the fourth of a metre, and a little for the digits.
DEGREE, HEIGHT = 0.51e-9, 0.51e-4


def ogrinfo():
    return subprocess.run(["ogrinfo", "-ro", "-al", "-so", FILE], capture_output=True, text=True, check=True).stdout


def features():
    """What GDAL reads: a dictionary of texts for each feature, X, Y, Z first."""
    run = subprocess.run(["ogr2ogr", "-f", "CSV", "/vsistdout/", FILE, "-lco", "GEOMETRY=AS_XYZ"], capture_output=True,
                         text=True, check=True)
    assert not run.stderr, run.stderr
    return list(csv.DictReader(io.StringIO(run.stdout)))


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


class TestGeoJSONWriter(unittest.TestCase):
    def setUp(self):
        self.data = echoes()
        self.writer = al.vtkAvianLidarGeoJSONWriter()

    def tearDown(self):
        if os.path.exists(FILE):
            os.remove(FILE)

    def write(self, data=None, **properties):
        self.assertEqual(write(self.writer, data or self.data, FILE, **properties), [])

    def assert_places(self, rows, expected):
        self.assertLess(np.abs(column(rows, "X") - expected[:, 0]).max(), DEGREE)
        self.assertLess(np.abs(column(rows, "Y") - expected[:, 1]).max(), DEGREE)
        self.assertLess(np.abs(column(rows, "Z") - expected[:, 2]).max(), HEIGHT)

    def test_gdal_opens_it(self):
        self.write()
        told = ogrinfo()
        self.assertIn("using driver `GeoJSON' successful", told)
        self.assertIn(f"Feature Count: {self.data.GetNumberOfPoints()}", told)
        self.assertIn("Geometry: 3D Point", told)
        self.assertIn('GEOGCRS["WGS 84"', told)
        self.assertIn("energy: Real", told)
        self.assertIn("object_id: Integer", told)
        self.assertIn("material: String", told)

    def test_every_echo_and_property(self):
        self.write()
        rows = features()
        self.assertEqual(len(rows), self.data.GetNumberOfPoints())
        self.assert_places(rows, geodetic(self.data, "Geodetic"))
        for name in names(self.data):
            np.testing.assert_allclose(column(rows, name), array(self.data, name), rtol=1e-14, err_msg=name)
        with open(FILE, encoding="utf-8") as file:
            whole = json.load(file)
        for name in names(self.data):  # GDAL writes 15 digits; the file has them all
            values = [one["properties"][name] for one in whole["features"]]
            np.testing.assert_array_equal(values, array(self.data, name), name)
        for name, ids, texts in (("object", "object_id", "object_names"), ("object_class", "object_id", "object_classes"),
                                 ("material", "material_id", "material_names")):
            found = [row[name] for row in rows]
            self.assertEqual(found, [field(self.data, texts)[i] for i in array(self.data, ids)])

    def test_units(self):
        self.write()
        with open(FILE, encoding="utf-8") as file:
            whole = json.load(file)
        self.assertEqual(whole["type"], "FeatureCollection")
        self.assertNotIn("crs", whole)  # RFC 7946: it is always WGS84
        self.assertEqual(whole["units"]["energy"], "J")
        self.assertEqual(whole["units"]["distance_m"], "m")
        self.assertNotIn("object_id", whole["units"])

    def test_places_from_the_arrays_of_the_geodetic_transform(self):
        transform = al.vtkAvianLidarGeodeticTransform()
        transform.SetInputData(self.data)
        transform.MovePointsOn()
        transform.SetTargetFrameToUTM()
        transform.Update()
        self.write(transform.GetOutput())
        rows = features()
        self.assert_places(rows, geodetic(self.data, "Geodetic"))
        self.assertNotIn("longitude", rows[0])

    def test_limit(self):
        energy = array(self.data, "energy")
        limit = np.median(energy)
        self.write(UseFieldDataLimit=False, MinimumEnergy=limit)
        np.testing.assert_allclose(column(features(), "energy"), energy[energy >= limit], rtol=1e-14)
        self.assertLess((energy >= limit).sum(), len(energy))
        add_field(self.data, "lower_energy_limit", (limit,))
        self.write(UseFieldDataLimit=True, MinimumEnergy=0)
        self.assertEqual(len(features()), (energy >= limit).sum())
        self.data.GetFieldData().RemoveArray("lower_energy_limit")
        self.write()
        self.assertEqual(len(features()), len(energy))

    def test_nothing_above_the_limit(self):
        self.write(UseFieldDataLimit=False, MinimumEnergy=1.0)
        with open(FILE, encoding="utf-8") as file:
            self.assertEqual(json.load(file)["features"], [])
        self.write(cloud([]))
        self.assertIn("successful", ogrinfo())

    def test_what_json_has_no_words_for(self):
        data = cloud([[0, 0, 0], [1, 0, 0]])
        add_field(data, "geodetic_origin", (31.0, 121.0, 3.0))
        add_array(data, "energy", np.array([1.0, 2.0]))
        add_array(data, "share", np.array([np.nan, np.inf]))
        add_array(data, "object_id", np.array([0, 7]))
        add_field(data, "object_names", ['a "quoted" name\\\n\u00e9'])
        self.write(data)
        with open(FILE, encoding="utf-8") as file:
            properties = [one["properties"] for one in json.load(file)["features"]]
        self.assertEqual([one["share"] for one in properties], [None, None])
        self.assertEqual([one["object"] for one in properties], ['a "quoted" name\\\n\u00e9', ""])

    def test_bad_input(self):
        def bad(change, words):
            data = echoes()
            change(data)
            assert_refused(self, self.writer, data, FILE, words)

        bad(lambda data: data.GetPointData().RemoveArray("energy"), "'energy'")
        bad(lambda data: data.GetFieldData().RemoveArray("geodetic_origin"), "vtkAvianLidarGeodeticTransform")
        bad(lambda data: add_field(data, "crs_wkt", ["PROJCS[...]"]), "vtkAvianLidarGeodeticTransform")
        bad(lambda data: data.GetPoints().SetPoint(2, np.nan, 0, 0), "point 2")


if __name__ == "__main__":
    unittest.main()
