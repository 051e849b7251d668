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
from cloudtools import (ORIGIN, add_array, add_field, assert_refused, assert_same_arrays, cloud, echoes, field, geodetic,
                        names, points, read, unit, write)
from echotools import array

FILE = "TestLASWriter.las"
EXTRA = ["energy", "energy_received", "return_energy", "energy_std_error", "object_id", "material_id", "secondary_share",
         "incidence_angle", "distance_m", "laser_id"]
# In fields that LAS has for them.
CORE = {"intensity", "return_number", "number_of_returns", "timestamp"}
# What the reader adds: other fields of LAS.
ADDED = {"classification", "classification_flags", "user_data", "scan_angle", "point_source_id"}


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


class TestLASWriter(unittest.TestCase):
    def setUp(self):
        self.data = echoes()
        self.writer = al.vtkAvianLidarLASWriter()

    def tearDown(self):
        if os.path.exists(FILE):
            os.remove(FILE)

    def write(self, data=None, **properties):
        warnings = write(self.writer, data or self.data, FILE, **properties)
        return outside(), warnings

    def assert_within_bound(self, found, expected):
        bound = self.writer.GetRoundingBound()
        self.assertLess(np.abs(positions(found) - expected).max(), bound)
        self.assertLess(bound, 1e-6)
        return bound

    def test_header(self):
        found, warnings = self.write(SourceId=7)
        self.assertEqual(warnings, [])
        header, n = found["header"], self.data.GetNumberOfPoints()
        self.assertEqual((header["majorVersion"], header["minorVersion"]), (1, 4))
        self.assertEqual(header["pointDataRecordFormat"], 6)
        self.assertEqual(header["globalEncoding"], 16)  # WKT, and time of no epoch
        self.assertEqual(header["fileSourceId"], 7)
        self.assertEqual(header["systemIdentifier"], "SIMULATION")
        self.assertRegex(header["generatingSoftware"], r"^avian-lidar \d+\.\d+\.\d+$")
        made = datetime.date(header["fileCreationYear"], 1, 1) + datetime.timedelta(header["fileCreationDayOfYear"] - 1)
        self.assertLessEqual(abs((datetime.datetime.now(datetime.timezone.utc).date() - made).days), 1)
        self.assertEqual(header["headerLength"], 375)
        self.assertEqual(header["pointCount"], n)
        self.assertEqual(found["endOfPoints"], found["size"])
        counts = np.bincount(array(self.data, "return_number"), minlength=16)[1:]
        self.assertEqual(header["pointCountByReturn"], counts.tolist())
        found_points = positions(found)
        np.testing.assert_allclose(header["min"], found_points.min(axis=0), rtol=0, atol=1e-8)
        np.testing.assert_allclose(header["max"], found_points.max(axis=0), rtol=0, atol=1e-8)

    def test_points_in_utm(self):
        found, _ = self.write()
        self.assert_within_bound(found, geodetic(self.data, "UTM"))
        wkt = text_of(found, "LASF_Projection", 2112)
        self.assertTrue(wkt.endswith("\0"))
        self.assertIn('AUTHORITY["EPSG","32651"]', wkt)
        self.assertIn('VERT_DATUM["Ellipsoid",2002]', wkt)
        told = subprocess.run(["projinfo", wkt[:-1]], capture_output=True, text=True, check=True).stdout
        self.assertIn("UTM zone 51N", told)

    def test_points_in_the_southern_hemisphere_and_in_a_zone_of_choice(self):
        self.data = echoes(origin=(-33.9461, 151.1772, 6.0))
        found, _ = self.write()
        self.assertIn('"32756"', text_of(found, "LASF_Projection", 2112))
        self.assert_within_bound(found, geodetic(self.data, "UTM"))
        found, _ = self.write(UTMZone=-55)
        self.assertIn('"32755"', text_of(found, "LASF_Projection", 2112))
        self.assertGreater(positions(found)[:, 0].min(), 834e3)  # beyond the zone's edge

    def test_geocentric_points(self):
        found, _ = self.write(CoordinateSystem=al.vtkAvianLidarLASWriter.COORDINATE_SYSTEM_GEOCENTRIC)
        self.assert_within_bound(found, geodetic(self.data, "ECEF"))
        wkt = text_of(found, "LASF_Projection", 2112)
        self.assertTrue(wkt.startswith("GEOCCS["))
        told = subprocess.run(["projinfo", wkt[:-1]], capture_output=True, text=True, check=True).stdout
        self.assertIn("geocentricX", told)

    def test_local_points(self):
        found, warnings = self.write(CoordinateSystem=al.vtkAvianLidarLASWriter.COORDINATE_SYSTEM_LOCAL)
        self.assertEqual(warnings, [])
        self.assertIsNone(text_of(found, "LASF_Projection", 2112))
        self.assert_within_bound(found, points(self.data))

    def test_without_an_origin_there_is_a_warning_and_no_system(self):
        self.data = echoes(origin=None)
        found, warnings = self.write()
        self.assertEqual(len(warnings), 1)
        self.assertIn("geodetic_origin", warnings[0])
        self.assertIsNone(text_of(found, "LASF_Projection", 2112))
        self.assert_within_bound(found, points(self.data))

    def test_points_of_another_system_stay(self):
        self.write()
        away = read(FILE, LocalCoordinates=False)
        self.assertIn("32651", field(away, "crs_wkt")[0])
        self.assertEqual(field(away, "utm_zone"), [51])
        self.assertFalse(away.GetFieldData().HasArray("geodetic_origin"))
        found, warnings = self.write(away)
        self.assertEqual(warnings, [])
        self.assertIn("32651", text_of(found, "LASF_Projection", 2112))
        self.assertLess(np.abs(positions(found) - points(away)).max(), 1e-6)

    def test_dimensions(self):
        found, _ = self.write(SourceId=65535)
        got = {name: np.array(values) for name, values in found["points"].items()}
        np.testing.assert_array_equal(got["Intensity"], np.rint(array(self.data, "intensity") * 257))
        self.assertGreater(len(set(got["Intensity"])), 10)
        np.testing.assert_array_equal(got["ReturnNumber"], array(self.data, "return_number"))
        np.testing.assert_array_equal(got["NumberOfReturns"], array(self.data, "number_of_returns"))
        self.assertGreater(got["NumberOfReturns"].max(), 1)
        np.testing.assert_allclose(got["GpsTime"], array(self.data, "timestamp") * 1e-6, rtol=1e-15)
        np.testing.assert_allclose(got["ScanAngle"], 90 + array(self.data, "vertical_angle"), rtol=0, atol=0.00301)
        self.assertEqual(set(got["PointSourceId"]), {65535})
        self.assertEqual(set(got["Synthetic"]), {1})
        by_class = {"terminal": 6, "ground": 2, "runway": 11, "fence": 1, "no such word": 1}
        classes = [by_class[one] for one in field(self.data, "object_classes")]
        expected = [classes[i] if i >= 0 else 1 for i in array(self.data, "object_id")]
        self.assertEqual(got["Classification"].tolist(), expected)
        self.assertEqual(set(expected), {1, 2, 6, 11})

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
        """Only the arrays of the list; what is left out then is the user's choice, and no warning says so."""
        found, warnings = self.write(WriteAllArrays=False)
        self.assertEqual(warnings, [])
        self.check_extra_bytes(found, EXTRA)
        # The description, which this version of copc looks for at another place: bytes 160 to 192 of an entry.
        text = text_of(found, "LASF_Spec", 4)
        self.assertEqual(len(text), 192 * len(EXTRA))
        words = {name: text[192 * i + 160:192 * (i + 1)].rstrip("\0") for i, name in enumerate(EXTRA)}
        self.assertEqual(words["energy"], "within receiver limits [J]")
        self.assertEqual(words["distance_m"], "range [m]")
        self.assertEqual(words["incidence_angle"], "at the surface [deg]")
        for name, description in words.items():
            self.assertTrue(0 < len(description) < 32, name)

    def test_all_arrays(self):
        """By default every numeric array is in the file, once."""
        found, warnings = self.write()
        self.assertEqual(warnings, [])
        others = [name for name in names(self.data) if name not in CORE and name not in EXTRA]
        self.assertLessEqual({"azimuth", "beam_id", "label_share", "vertical_angle"}, set(others))
        self.check_extra_bytes(found, EXTRA + others)
        self.assertEqual(set(names(read(FILE))), set(names(self.data)) | ADDED)

    def test_types_and_components(self):
        n = self.data.GetNumberOfPoints()
        generator = np.random.default_rng(3)
        kinds = (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64, np.float32, np.float64)
        for kind in kinds:
            add_array(self.data, f"of {kind.__name__}", generator.integers(0, 100, n).astype(kind), "m")
        add_array(self.data, "direction", generator.uniform(-1, 1, (n, 3)), "1")
        add_array(self.data, "tensor", generator.uniform(-1, 1, (n, 9)).astype(np.float32))
        found, warnings = self.write()
        self.assertEqual(warnings, [])
        self.assertEqual([one["name"] for one in found["extraBytes"]][-12:],
                         [*(f"direction [{c}]" for c in range(3)), *(f"tensor [{c}]" for c in range(9))])
        assert_same_arrays(self.data, read(FILE), left_out=("intensity", "timestamp"))

    def test_what_is_left_out_or_changed_is_named(self):
        n = self.data.GetNumberOfPoints()
        words = vtk.vtkStringArray()
        words.SetName("words")
        words.SetNumberOfValues(n)
        self.data.GetPointData().AddArray(words)
        add_array(self.data, "serial", np.full(n, 2**53 + 1))
        for end in "ab":
            add_array(self.data, "n" * 31 + end, np.zeros(n))
        add_array(self.data, "user_data", np.full(n, 2.5))
        found, warnings = self.write()
        self.assertEqual(len(warnings), 2)
        for words in ("is without the point arrays 'words' (no numbers), 'serial' (whole numbers beyond 2^53), '" + "n" * 31 +
                      "b' (another's name begins with the same 31 bytes)", "LAS has no place"):
            self.assertIn(words, warnings[0])
        self.assertIn("has other values or names of the point arrays '" + "n" * 31 + "a' (its name is cut to 31 bytes), 'user_data' (no",
                      warnings[1])
        self.assertEqual(set(found["points"]["UserData"]), {0})
        np.testing.assert_array_equal(array(read(FILE), "file_user_data"), np.full(n, 2.5))

    def test_more_arrays_than_fit(self):
        """A record of extra bytes describes 341 at most."""
        data = cloud([[0, 0, 0], [1, 1, 1]])
        for i in range(350):
            add_array(data, f"array {i}", np.array([i, 2 * i]))
        _, warnings = self.write(data, CoordinateSystem=2)
        self.assertEqual(len(warnings), 1)
        self.assertEqual(warnings[0].count("(no room)"), 9)
        self.assertIn("'array 341' (no room)", warnings[0])
        again = read(FILE)
        self.assertEqual(array(again, "array 340").tolist(), [340, 680])
        self.assertNotIn("array 341", names(again))

    def test_what_other_files_have_stays(self):
        """Fields of LAS that no scan of this project has go back to where they were read."""
        n = self.data.GetNumberOfPoints()
        generator = np.random.default_rng(4)
        for name, high, kind in (("classification", 256, np.uint8), ("classification_flags", 16, np.uint8),
                                 ("user_data", 256, np.uint8), ("point_source_id", 65536, np.uint16)):
            add_array(self.data, name, generator.integers(0, high, n).astype(kind))
        add_array(self.data, "scan_angle", generator.integers(-30000, 30001, n) * 0.006, "deg")
        found, warnings = self.write(SourceId=7)
        self.assertEqual(warnings, [])
        self.assertEqual(found["header"]["fileSourceId"], 7)
        self.assertEqual(found["points"]["Classification"], array(self.data, "classification").tolist())
        again = read(FILE)
        self.assertEqual(set(names(again)), set(names(self.data)))
        assert_same_arrays(self.data, again, left_out=("intensity", "timestamp"))
        # And once more.
        _, warnings = self.write(again)
        self.assertEqual(warnings, [])
        self.assertEqual(set(names(read(FILE))), set(names(self.data)))
        assert_same_arrays(again, read(FILE), left_out=("timestamp",))

    def test_names_are_cut_between_characters(self):
        """31 bytes are what there is: names of 30, 31 and 32 bytes, the last of whose characters has two."""
        wanted = {"n" * 28 + "é": "n" * 28 + "é", "o" * 29 + "é": "o" * 29 + "é", "p" * 30 + "é": "p" * 30,
                  "q" * 27 + "é€": "q" * 27 + "é"}
        for name in wanted:
            add_array(self.data, name, np.zeros(self.data.GetNumberOfPoints()))
        found, _ = self.write()
        # The library copc takes bytes, with their sign, for characters.
        every = {bytes(ord(c) & 255 for c in one["name"]).decode() for one in found["extraBytes"]}
        self.assertLessEqual(set(wanted.values()), every)
        self.assertLessEqual(set(wanted.values()), set(names(read(FILE))))

    def test_colours(self):
        n = self.data.GetNumberOfPoints()
        rgb = np.arange(3 * n, dtype=np.uint8).reshape(n, 3)
        add_array(self.data, "rgb", rgb)
        found, _ = self.write()
        self.assertEqual(found["header"]["pointDataRecordFormat"], 7)
        got = np.column_stack([found["points"][name] for name in ("Red", "Green", "Blue")])
        np.testing.assert_array_equal(got, rgb.astype(int) * 257)
        np.testing.assert_array_equal(array(read(FILE), "rgb"), rgb)

    def test_text_area_holds_field_data(self):
        found, _ = self.write()
        notes = json.loads(text_of(found, "LASF_Spec", 3))["avian_lidar"]
        self.assertEqual(notes["field_data"]["geodetic_origin"], {"unit": "deg deg m", "value": list(ORIGIN)})
        self.assertEqual(notes["field_data"]["las_rounding_bound"],
                         {"unit": "m", "value": [self.writer.GetRoundingBound()]})
        self.assertEqual(notes["field_data"]["seed"]["value"], field(self.data, "seed"))
        self.assertEqual(notes["field_data"]["scene_checksum"]["value"],
                         [str(self.data.GetFieldData().GetArray("scene_checksum").GetValue(0))])
        self.assertEqual(notes["units"]["energy"], "J")

    def test_field_data_that_do_not_fit_are_left_out_and_named(self):
        add_field(self.data, "object_names", ["n" * 1000] * 80)
        found, warnings = self.write()
        self.assertEqual(len(warnings), 1)
        self.assertIn("'object_names'", warnings[0])
        notes = json.loads(text_of(found, "LASF_Spec", 3))["avian_lidar"]["field_data"]
        self.assertNotIn("object_names", notes)
        self.assertIn("geodetic_origin", notes)

    def test_read_again(self):
        for system in (0, 1, 2):
            self.write(CoordinateSystem=system)
            again = read(FILE)
            error = np.abs(points(again) - points(self.data)).max()
            # Turned into another frame, a corner of the box of rounding shows: sqrt(3) as far.
            self.assertLess(error, 1.8 * self.writer.GetRoundingBound())
            assert_same_arrays(self.data, again, left_out=("intensity", "return_number", "number_of_returns", "timestamp"))
            for name in ("return_number", "number_of_returns"):
                np.testing.assert_array_equal(array(again, name), array(self.data, name))
            self.assertEqual(unit(again, "timestamp"), "us")
            np.testing.assert_allclose(array(again, "timestamp"), array(self.data, "timestamp"), rtol=1e-15)
            np.testing.assert_allclose(array(again, "intensity"), array(self.data, "intensity"), rtol=0, atol=0.5 / 257)
            for name in ("position", "lower_energy_limit", "geodetic_origin", "object_names"):
                self.assertEqual(field(again, name), field(self.data, name), name)

    def test_scale_follows_the_extent(self):
        generator = np.random.default_rng(1)
        for extent, scale in ((1.0, 1e-6), (4e3, 1e-6), (5e3, 1e-5), (40e3, 1e-5), (4e6, 1e-3), (1e12, 1e3), (1e15, 1e6)):
            spread = generator.uniform(-0.5, 0.5, (100, 3)) * extent
            spread[:2] = [[-0.5 * extent] * 3, [0.5 * extent] * 3]
            found, _ = self.write(cloud(spread + 1000), CoordinateSystem=2)
            self.assertEqual(found["header"]["scale"], [scale] * 3, extent)
            bound = self.writer.GetRoundingBound()
            self.assertLessEqual(np.abs(positions(found) - spread - 1000).max(), bound)
            self.assertLess(bound, 0.5001 * scale)

    def test_points_alone(self):
        generator = np.random.default_rng(2)
        found, _ = self.write(cloud(generator.uniform(-9, 9, (40000, 3))), CoordinateSystem=2)
        self.assertEqual(found["header"]["systemIdentifier"], "OTHER")
        self.assertEqual(found["extraBytes"], [])
        self.assertEqual(set(found["points"]["Synthetic"]), {0})
        self.assertEqual(set(found["points"]["ReturnNumber"]), {1})
        self.assertEqual(set(found["points"]["Classification"]), {1})

    def test_no_points(self):
        found, _ = self.write(cloud([]), CoordinateSystem=2)
        self.assertEqual(found["header"]["pointCount"], 0)
        self.assertEqual(read(FILE).GetNumberOfPoints(), 0)

    def test_more_returns_than_fit(self):
        data = cloud([[i, 0, 0] for i in range(20)])
        add_array(data, "return_number", np.arange(1, 21))
        add_array(data, "number_of_returns", np.full(20, 20))
        found, warnings = self.write(data, CoordinateSystem=2)
        self.assertEqual(found["points"]["ReturnNumber"], [*range(1, 16), *[15] * 5])
        self.assertEqual(found["points"]["return_number"], list(range(1, 21)))
        self.assertEqual(len(warnings), 1)
        self.assertIn("'return_number' (no", warnings[0])
        self.assertEqual(found["header"]["pointCountByReturn"], [*[1] * 14, 6])

    def test_bad_input(self):
        def bad(change, words):
            data = echoes()
            change(data)
            assert_refused(self, self.writer, data, FILE, words)

        bad(lambda data: data.GetPoints().SetPoint(3, np.nan, 0, 0), "point 3")
        self.writer.SetCoordinateSystemToLocal()
        for value in (np.inf, -np.inf, 1e308, -1.1e15):
            bad(lambda data: data.GetPoints().SetPoint(3, 0, value, 0), "point 3")
        self.writer.SetCoordinateSystemToUTM()
        bad(lambda data: data.GetPoints().SetPoint(4, 1e9, 0, 0), "point 4")
        bad(lambda data: add_field(data, "geodetic_origin", (91.0, 0.0, 0.0)), "latitude is 91")
        bad(lambda data: add_field(data, "geodetic_origin", (1.0, 2.0)), "expected three")
        n = self.data.GetNumberOfPoints()
        bad(lambda data: add_array(data, "intensity", np.zeros((n, 2))), "'intensity' has 2 components")
        bad(lambda data: add_array(data, "timestamp", np.zeros(n - 1)), "'timestamp' has")
        for text in ("garbage", "[", "+proj=utm +zone=51 (north)", "<gml>PROJCS[</gml>"):
            bad(lambda data: add_field(data, "crs_wkt", [text]), "'crs_wkt' is no WKT")


if __name__ == "__main__":
    if not os.path.isdir(os.path.join(os.environ["NODE_PATH"], "copc")):
        print("Skipped: the package copc is not there; the test NodeModules fetches it, with a network")
        sys.exit(77)
    unittest.main()
