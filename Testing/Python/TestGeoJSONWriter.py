# SPDX-License-Identifier: BSD-3-Clause
"""GeoJSON against GDAL's own programs: ogrinfo opens it, ogr2ogr finds every point and property."""

import csv
import io
import json
import pathlib
import subprocess

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, assert_refused, cloud, echoes, field, geodetic, names, write
from echotools import InFolder, array, given, output

FILE = "TestGeoJSONWriter.geojson"
# Half of the ninth decimal of a degree and of the fourth of a metre, and a little for the digits.
DEGREE, HEIGHT = 0.51e-9, 0.51e-4


def features():
    """What GDAL reads: a dictionary of texts for each feature, X, Y, Z first."""
    run = subprocess.run(["ogr2ogr", "-f", "CSV", "/vsistdout/", FILE, "-lco", "GEOMETRY=AS_XYZ"], capture_output=True,
                         text=True, check=True)
    assert not run.stderr, run.stderr
    return list(csv.DictReader(io.StringIO(run.stdout)))


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


class TestGeoJSONWriter(InFolder):
    def setUp(self):
        super().setUp()
        self.data = echoes()
        self.writer = al.vtkAvianLidarGeoJSONWriter()

    def write(self, data=None, **properties):
        self.assertEqual(write(self.writer, data or self.data, FILE, **properties), [])

    def ogrinfo(self):
        return subprocess.run(["ogrinfo", "-ro", "-al", "-so", FILE], capture_output=True, text=True, check=True).stdout

    def assert_places(self, rows):
        for axis, values, bound in zip("XYZ", geodetic(self.data, "Geodetic").T, (DEGREE, DEGREE, HEIGHT)):
            self.assertLess(np.abs(column(rows, axis) - values).max(), bound, axis)

    def test_every_echo_and_property(self):
        pair = np.random.default_rng(7).normal(size=(self.data.GetNumberOfPoints(), 2))
        add_array(self.data, "pair", pair)
        self.write()
        told = self.ogrinfo()
        for words in (f"Feature Count: {self.data.GetNumberOfPoints()}", "Geometry: 3D Point", 'GEOGCRS["WGS 84"',
                      "energy: Real", "object_id: Integer", "material: String"):
            self.assertIn(words, told)
        rows = features()
        self.assert_places(rows)
        whole = json.loads(pathlib.Path(FILE).read_text("utf-8"))
        np.testing.assert_array_equal([[one["properties"][f"pair_{c}"] for c in (0, 1)] for one in whole["features"]],
                                      pair)
        for name in set(names(self.data)) - {"pair"}:  # GDAL writes 15 digits; the file has them all
            np.testing.assert_allclose(column(rows, name), array(self.data, name), rtol=1e-14, err_msg=name)
            np.testing.assert_array_equal([one["properties"][name] for one in whole["features"]],
                                          array(self.data, name), name)
        for name, ids, texts in (("object", "object_id", "object_names"),
                                 ("object_class", "object_id", "object_classes"),
                                 ("material", "material_id", "material_names")):
            self.assertEqual([row[name] for row in rows], [field(self.data, texts)[i] for i in array(self.data, ids)])
        self.assertNotIn("crs", whole)  # RFC 7946: it is always WGS84
        self.assertEqual([whole["units"].get(name) for name in ("energy", "distance_m", "object_id")], ["J", "m", None])

    def test_names_that_collide(self):
        add_array(self.data, "pair_0", np.zeros(self.data.GetNumberOfPoints()))
        add_array(self.data, "pair", np.ones((self.data.GetNumberOfPoints(), 2)))
        (said,) = write(self.writer, self.data, FILE)
        self.assertIn("is without the point arrays 'pair'", said)
        self.assertEqual({float(one["pair_0"]) for one in features()}, {0.0})

    def test_places_from_the_arrays_of_the_geodetic_transform(self):
        transform = given(al.vtkAvianLidarGeodeticTransform(), InputData=self.data, MovePoints=True)
        transform.SetTargetFrameToUTM()
        self.write(output(transform))
        rows = features()
        self.assert_places(rows)
        self.assertNotIn("longitude", rows[0])

    def test_limit(self):
        """An echo at the limit is in the file."""
        energy = array(self.data, "energy")
        limit = np.sort(energy)[len(energy) // 2]
        self.write(UseFieldDataLimit=False, MinimumEnergy=limit)
        np.testing.assert_allclose(column(features(), "energy"), energy[energy >= limit], rtol=1e-14)
        self.assertLess((energy >= limit).sum(), len(energy))
        add_field(self.data, "lower_energy_limit", (limit,))
        self.write(UseFieldDataLimit=True, MinimumEnergy=0)
        self.assertEqual(len(features()), (energy >= limit).sum())
        self.data.GetFieldData().RemoveArray("lower_energy_limit")
        self.write()
        self.assertEqual(len(features()), len(energy))
        for data in (self.data, cloud([])):
            self.write(data, UseFieldDataLimit=False, MinimumEnergy=1.0)
            self.assertIn("successful", self.ogrinfo())
            self.assertEqual(json.loads(pathlib.Path(FILE).read_text("utf-8"))["features"], [])

    def test_values_that_json_lacks(self):
        data = cloud([[0, 0, 0], [1, 0, 0]])
        add_field(data, "geodetic_origin", (31.0, 121.0, 3.0))
        add_array(data, "energy", np.array([1.0, 2.0]))
        add_array(data, "share", np.array([np.nan, np.inf]))
        add_array(data, "object_id", np.array([0, 7]))
        add_field(data, "object_names", ['a "quoted" name\\\n\u00e9'])
        self.write(data)
        properties = [one["properties"] for one in json.loads(pathlib.Path(FILE).read_text("utf-8"))["features"]]
        self.assertEqual([(one["share"], one["object"]) for one in properties],
                         [(None, 'a "quoted" name\\\n\u00e9'), (None, "")])

    def test_bad_input(self):
        for change, words in (
                (lambda data: data.GetFieldData().RemoveArray("geodetic_origin"), "vtkAvianLidarGeodeticTransform"),
                (lambda data: add_field(data, "crs_wkt", ["PROJCS[...]"]), "vtkAvianLidarGeodeticTransform"),
                (lambda data: data.GetPoints().SetPoint(2, np.nan, 0, 0), "point 2")):
            data = echoes()
            change(data)
            assert_refused(self, self.writer, data, FILE, words)
