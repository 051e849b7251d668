# SPDX-License-Identifier: BSD-3-Clause
"""LAS files against a reader that is not ours (the library copc, in Node.js): header, coordinate reference system,
points within the bound that the writer states, all dimensions, extra bytes. WKT is understood by PROJ's projinfo."""

import datetime
import json
import os
import subprocess
import sys
import unittest

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from cloudtools import (add_array, add_field, assert_refused, assert_same_arrays, cloud, echoes, field, geodetic,
                        names, points, read, write)
from echotools import InFolder, array, copy_of

FILE = "TestLASWriter.las"
EXTRA = ["energy", "energy_received", "return_energy", "energy_std_error", "object_id", "material_id",
         "secondary_share", "incidence_angle", "distance_m", "laser_id"]
# In fields that LAS has for them.
CORE = {"intensity", "return_number", "number_of_returns", "timestamp"}


def outside(name=FILE):
    """What copc reads."""
    script = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Testing", "IO", "las_to_json.js")
    run = subprocess.run([os.environ["AVIANLIDAR_NODE"], script, name], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


def text_of(found, user, record):
    texts = [one["text"] for one in found["records"] if (one["userId"], one["recordId"]) == (user, record)]
    assert len(texts) <= 1
    return texts[0] if texts else None


def positions(found):
    return np.column_stack([found["points"][axis] for axis in "XYZ"])


class TestLASWriter(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.made = echoes()

    def setUp(self):
        super().setUp()
        self.data = copy_of(self.made)
        self.writer = al.vtkAvianLidarLASWriter()

    def write(self, data=None, **properties):
        """What copc reads of the file; nothing is warned of."""
        self.assertEqual(write(self.writer, data or self.data, FILE, **properties), [])
        return outside()

    def assert_within_bound(self, found, expected):
        bound = self.writer.GetRoundingBound()
        self.assertLess(np.abs(positions(found) - expected).max(), bound)
        self.assertLess(bound, 1e-6)

    def test_header_and_dimensions(self):
        found = self.write(SourceId=65535)
        header, n = found["header"], self.data.GetNumberOfPoints()
        for name, value in {"majorVersion": 1, "minorVersion": 4, "pointDataRecordFormat": 6, "globalEncoding": 16,
                            "fileSourceId": 65535, "systemIdentifier": "SIMULATION", "headerLength": 375,
                            "pointCount": n}.items():
            self.assertEqual(header[name], value, name)  # the encoding: WKT, and time of no epoch
        self.assertEqual(found["endOfPoints"], found["size"])
        counts = np.bincount(array(self.data, "return_number"), minlength=16)[1:]
        self.assertEqual(header["pointCountByReturn"], counts.tolist())
        np.testing.assert_allclose([header["min"], header["max"]],
                                   [positions(found).min(axis=0), positions(found).max(axis=0)], rtol=0, atol=1e-8)
        got = {name: np.array(values) for name, values in found["points"].items()}
        np.testing.assert_array_equal(got["Intensity"], np.rint(array(self.data, "intensity") * 257))
        np.testing.assert_array_equal(got["ReturnNumber"], array(self.data, "return_number"))
        np.testing.assert_array_equal(got["NumberOfReturns"], array(self.data, "number_of_returns"))
        self.assertGreater(got["NumberOfReturns"].max(), 1)
        np.testing.assert_allclose(got["GpsTime"], array(self.data, "timestamp") * 1e-6, rtol=1e-15)
        np.testing.assert_allclose(got["ScanAngle"], 90 + array(self.data, "vertical_angle"), rtol=0, atol=0.00301)
        self.assertEqual((set(got["PointSourceId"]), set(got["Synthetic"])), ({65535}, {1}))
        by_class = {"terminal": 6, "ground": 2, "runway": 11, "fence": 1, "no such word": 1}
        classes = [by_class[one] for one in field(self.data, "object_classes")]
        expected = [classes[i] if i >= 0 else 1 for i in array(self.data, "object_id")]
        self.assertEqual((got["Classification"].tolist(), set(expected)), (expected, {1, 2, 6, 11}))
        made = datetime.date(header["fileCreationYear"], 1, 1) + datetime.timedelta(header["fileCreationDayOfYear"] - 1)
        self.assertLessEqual(abs((datetime.datetime.now(datetime.timezone.utc).date() - made).days), 1)
        text = text_of(found, "LASF_Spec", 4)
        words = {name: text[192 * i + 160:192 * (i + 1)].rstrip("\0") for i, name in enumerate(EXTRA)}
        self.assertEqual([words[name] for name in ("energy", "incidence_angle", "distance_m", "laser_id")],
                         ["within receiver limits [J]", "at the surface [deg]", "range [m]", "channel"])
        notes = json.loads(text_of(found, "LASF_Spec", 3))["avian_lidar"]["field_data"]
        self.assertEqual(notes["scene_checksum"]["value"],
                         [str(self.data.GetFieldData().GetArray("scene_checksum").GetValue(0))])

    def test_coordinate_systems(self):
        """Places are those of the geodetic transform, and PROJ understands the system."""
        south = echoes(origin=(-33.9461, 151.1772, 6.0))
        for data, settings, frame, words, name in (
                (self.data, {}, "UTM", ('AUTHORITY["EPSG","32651"]', 'VERT_DATUM["Ellipsoid",2002]'), "UTM zone 51N"),
                (south, {}, "UTM", ('"32756"',), "UTM zone 56S"),
                (south, {"UTMZone": -55}, None, ('"32755"',), "UTM zone 55S"),
                (self.data, {"CoordinateSystem": 1}, "ECEF", ("GEOCCS[",), "geocentricX"),
                (self.data, {"CoordinateSystem": 2}, None, (), "")):
            with self.subTest(name):
                found = self.write(data, **settings)
                if frame:
                    self.assert_within_bound(found, geodetic(data, frame))
                wkt = text_of(found, "LASF_Projection", 2112) or "\0"
                self.assertTrue(wkt.endswith("\0") and all(one in wkt for one in words), wkt)
                if name:
                    told = subprocess.run(["projinfo", wkt[:-1]], capture_output=True, text=True, check=True).stdout
                    self.assertIn(name, told)
                if "UTMZone" in settings:
                    self.assertGreater(positions(found)[:, 0].min(), 834e3)  # beyond the zone's edge
        self.assertEqual(wkt, "\0")
        self.assert_within_bound(found, points(self.data))

    def test_without_an_origin_there_is_a_warning_and_no_system(self):
        self.data.GetFieldData().RemoveArray("geodetic_origin")
        (warning,) = write(self.writer, self.data, FILE)
        self.assertIn("geodetic_origin", warning)
        found = outside()
        self.assertIsNone(text_of(found, "LASF_Projection", 2112))
        self.assert_within_bound(found, points(self.data))

    def test_points_of_another_system_stay(self):
        write(self.writer, self.data, FILE)
        away = read(FILE, LocalCoordinates=False)
        self.assertIn("32651", field(away, "crs_wkt")[0])
        self.assertEqual((field(away, "utm_zone"), away.GetFieldData().HasArray("geodetic_origin")), ([51], 0))
        found = self.write(away)
        self.assertIn("32651", text_of(found, "LASF_Projection", 2112))
        self.assertLess(np.abs(positions(found) - points(away)).max(), 1e-6)

    def check_extra_bytes(self, found, expected):
        described = found["extraBytes"]
        self.assertEqual([one["name"] for one in described], expected)
        for one in described:
            values = array(self.data, one["name"])
            kind = {"f": "float", "i": "signed", "u": "unsigned"}[values.dtype.kind]
            self.assertEqual((one["type"], one["length"]), (kind, values.dtype.itemsize), one)
            self.assertNotIn("scale", one)
            np.testing.assert_array_equal(np.array(found["points"][one["name"]]), values, one["name"])

    def test_extra_bytes(self):
        """Every numeric array once, or only those of the list: what is left out then is the user's choice, and no
        warning says so."""
        others = [name for name in names(self.data) if name not in CORE and name not in EXTRA]
        self.assertLessEqual({"azimuth", "beam_id", "label_share", "vertical_angle"}, set(others))
        self.check_extra_bytes(self.write(), EXTRA + others)
        found = self.write(WriteAllArrays=False)
        self.check_extra_bytes(found, EXTRA)

    def test_components(self):
        n = self.data.GetNumberOfPoints()
        add_array(self.data, "tensor", np.random.default_rng(3).uniform(-1, 1, (n, 9)).astype(np.float32))
        self.assertEqual([one["name"] for one in self.write()["extraBytes"]][-9:], [f"tensor [{c}]" for c in range(9)])
        assert_same_arrays(self.data, read(FILE), left_out=("intensity", "timestamp"))

    def test_changes_and_omissions_are_named(self):
        n = self.data.GetNumberOfPoints()
        words = vtk.vtkStringArray()
        words.SetName("words")
        words.SetNumberOfValues(n)
        self.data.GetPointData().AddArray(words)
        add_array(self.data, "serial", np.full(n, 2**53 + 1))
        # 31 bytes are what there is: cut between characters
        for name in ("n" * 31 + "a", "n" * 31 + "b", "q" * 27 + "é€"):
            add_array(self.data, name, np.zeros(n))
        add_array(self.data, "user_data", np.full(n, 2.5))
        add_field(self.data, "object_names", ["n" * 1000] * 80)
        warnings = " ".join(sorted(write(self.writer, self.data, FILE)))
        for words in ("'words' (no numbers)", "'serial' (whole numbers beyond 2^53)", "n" * 31 + "b' (another's name",
                      "n" * 31 + "a' (its name is cut", "'user_data' (no", "'object_names'"):
            self.assertIn(words, warnings)
        self.assertEqual(set(outside()["points"]["UserData"]), {0})
        again = read(FILE)
        np.testing.assert_array_equal(array(again, "file_user_data"), np.full(n, 2.5))
        self.assertIn("q" * 27 + "é", names(again))
        self.assertEqual([again.GetFieldData().HasArray(name) for name in ("object_names", "geodetic_origin")], [0, 1])

    def test_more_arrays_than_fit(self):
        """A record of extra bytes describes 341 at most."""
        data = cloud([[0, 0, 0], [1, 1, 1]])
        for i in range(350):
            add_array(data, f"array {i}", np.array([i, 2 * i]))
        (warning,) = write(self.writer, data, FILE, CoordinateSystem=2)
        self.assertEqual((warning.count("(no room)"), "'array 341' (no room)" in warning), (9, True))
        again = read(FILE)
        self.assertEqual((array(again, "array 340").tolist(), "array 341" in names(again)), ([340, 680], False))

    def test_fields_of_other_files_stay(self):
        """Fields of LAS that no scan of this project has go back to where they were read."""
        n, draw = self.data.GetNumberOfPoints(), np.random.default_rng(4)
        for name, high, kind in (("classification", 256, "u1"), ("classification_flags", 16, "u1"),
                                 ("user_data", 256, "u1"), ("point_source_id", 65536, "u2")):
            withheld = 4 if name == "classification_flags" else 0  # such points are not read
            add_array(self.data, name, (draw.integers(0, high, n) & ~withheld).astype(kind))
        add_array(self.data, "scan_angle", draw.integers(-30000, 30001, n) * 0.006, "deg")
        add_array(self.data, "rgb", np.arange(3 * n, dtype=np.uint8).reshape(n, 3))
        found = self.write(SourceId=7)
        self.assertEqual((found["header"]["fileSourceId"], found["header"]["pointDataRecordFormat"]), (7, 7))
        self.assertEqual(found["points"]["Classification"], array(self.data, "classification").tolist())
        got = np.column_stack([found["points"][name] for name in ("Red", "Green", "Blue")])
        np.testing.assert_array_equal(got, array(self.data, "rgb").astype(int) * 257)
        again = read(FILE)
        self.assertEqual(set(names(again)), set(names(self.data)))
        assert_same_arrays(self.data, again, left_out=("intensity", "timestamp", "rgb"))

    def test_scale_follows_the_extent(self):
        draw = np.random.default_rng(1)
        for extent, scale in ((4e3, 1e-6), (5e3, 1e-5), (1e15, 1e6)):
            spread = draw.uniform(-0.5, 0.5, (100, 3)) * extent
            spread[:2] = [[-0.5 * extent] * 3, [0.5 * extent] * 3]
            found = self.write(cloud(spread + 1000), CoordinateSystem=2)
            self.assertEqual(found["header"]["scale"], [scale] * 3, extent)
            bound = self.writer.GetRoundingBound()
            self.assertLessEqual(np.abs(positions(found) - spread - 1000).max(), bound)
            self.assertLess(bound, 0.5001 * scale)
        # Points alone are of no scan.
        self.assertEqual((found["header"]["systemIdentifier"], found["extraBytes"]), ("OTHER", []))
        for name, value in {"Synthetic": 0, "ReturnNumber": 1, "Classification": 1}.items():
            self.assertEqual(set(found["points"][name]), {value}, name)
        self.assertEqual(self.write(cloud([]))["header"]["pointCount"], 0)
        self.assertEqual(read(FILE).GetNumberOfPoints(), 0)

    def test_more_returns_than_fit(self):
        data = cloud([[i, 0, 0] for i in range(20)])
        add_array(data, "return_number", np.arange(1, 21))
        (warning,) = write(self.writer, data, FILE, CoordinateSystem=2)
        found = outside()
        self.assertIn("'return_number' (no", warning)
        self.assertEqual(found["points"]["ReturnNumber"], [*range(1, 16), *[15] * 5])
        self.assertEqual((found["points"]["return_number"], found["header"]["pointCountByReturn"]),
                         (list(range(1, 21)), [*[1] * 14, 6]))

    def test_bad_input(self):
        def place(i, x, y):
            return lambda data: data.GetPoints().SetPoint(i, x, y, 0)

        def given(name, value):
            return lambda data: add_field(data, name, value)

        for system, change, words in (
                (0, place(3, np.nan, 0), "point 3"), (2, place(3, 0, -1.1e15), "point 3"),
                (0, place(4, 1e9, 0), "point 4"), (0, given("geodetic_origin", (91.0, 0.0, 0.0)), "latitude is 91"),
                *((0, given("crs_wkt", [text]), "'crs_wkt'") for text in ("[", "<gml>PROJCS[</gml>"))):
            self.data.DeepCopy(self.made)
            change(self.data)
            self.writer.SetCoordinateSystem(system)
            assert_refused(self, self.writer, self.data, FILE, words)


if __name__ == "__main__":
    if not os.path.isdir(os.path.join(os.environ["NODE_PATH"], "copc")):
        print("Skipped: the package copc is not there; the test NodeModules fetches it, with a network")
        sys.exit(77)
    unittest.main()
