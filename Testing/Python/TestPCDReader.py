# SPDX-License-Identifier: BSD-3-Clause
"""PCD files of every kind, made by hand, and every way in which they can be wrong."""

import os
import struct
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import field, names, points, read, read_error, unit
from echotools import Messages, array

FILE = "TestPCDReader.pcd"
HEADER = {
    "VERSION": "0.7", "FIELDS": "x y z", "SIZE": "4 4 4", "TYPE": "F F F", "COUNT": "1 1 1", "WIDTH": "2", "HEIGHT": "1",
    "VIEWPOINT": "0 0 0 1 0 0 0", "POINTS": "2", "DATA": "ascii",
}
LINES = b"1 2 3\n4 5 6\n"


def write(data=LINES, comments=(), **changes):
    lines = [f"# {comment}" for comment in comments]
    lines += [f"{key} {value}" for key, value in {**HEADER, **changes}.items() if value is not None]
    with open(FILE, "wb") as file:
        file.write("\n".join(lines).encode("ascii") + b"\n" + data)


def literal(data):
    """LZF without any packing: runs of at most 32 bytes behind their length."""
    return b"".join(bytes([len(data[i:i + 32]) - 1]) + data[i:i + 32] for i in range(0, len(data), 32))


class TestPCDReader(unittest.TestCase):
    def tearDown(self):
        if os.path.exists(FILE):
            os.remove(FILE)

    def test_ascii(self):
        write()
        self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]])
        write(LINES.replace(b"\n", b"\r\n").replace(b" ", b"\t ") + b"\n\n")
        self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]])
        write(b"1 2 3\n4 5 6")  # no end of the last line
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)

    def test_what_a_header_may_leave_out(self):
        for key in ("VERSION", "COUNT", "VIEWPOINT", "POINTS", "HEIGHT"):
            write(**{key: None})
            self.assertEqual(read(FILE).GetNumberOfPoints(), 2, key)
        write(WIDTH=None, HEIGHT=None)
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)
        write(VERSION="0.5\nCOLUMNS x y z", FIELDS=None)
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)

    def test_every_type(self):
        kinds = {"I1": "i1", "U1": "u1", "I2": "<i2", "U2": "<u2", "I4": "<i4", "U4": "<u4", "I8": "<i8", "U8": "<u8",
                 "F4": "<f4", "F8": "<f8"}
        record = np.dtype([(axis, "<f4") for axis in "xyz"] + list(kinds.items()))
        rows = np.zeros(3, record)
        for name, kind in kinds.items():
            limits = np.finfo(kind) if name[0] == "F" else np.iinfo(kind)
            rows[name] = [limits.min, 1, limits.max]
        header = {
            "FIELDS": " ".join(record.names), "SIZE": "4 4 4 " + " ".join(name[1] for name in kinds),
            "TYPE": "F F F " + " ".join(name[0] for name in kinds), "COUNT": " ".join(["1"] * len(record.names)),
            "WIDTH": 3, "POINTS": 3,
        }
        columns = b"".join(np.ascontiguousarray(rows[name]).tobytes() for name in record.names)
        packed = literal(columns)
        text = "".join(" ".join(repr(value.item()) for value in row) + "\n" for row in rows)
        for kind, data in (("binary", rows.tobytes()), ("ascii", text.encode("ascii")),
                           ("binary_compressed", struct.pack("<II", len(packed), len(columns)) + packed)):
            write(data, DATA=kind, **header)
            got = read(FILE)
            for name, dtype in kinds.items():
                self.assertEqual(array(got, name).dtype, np.dtype(dtype), (kind, name))
                np.testing.assert_array_equal(array(got, name), rows[name], f"{kind} {name}")

    def test_whole_numbers_written_otherwise(self):
        write(b"1 2 3 1e3 2.5e3\n", FIELDS="x y z n m", SIZE="4 4 4 8 8", TYPE="F F F I U", COUNT="1 1 1 1 1", WIDTH=1, POINTS=1)
        self.assertEqual((array(read(FILE), "n")[0], array(read(FILE), "m")[0]), (1000, 2500))

    def test_several_values_and_padding(self):
        write(b"1 7 8 9 2 3 0.5 0.25\n", FIELDS="x _ y z normal", SIZE="4 1 4 4 4", TYPE="F U F F F", COUNT="1 3 1 1 2",
              WIDTH=1, POINTS=1)
        data = read(FILE)
        self.assertEqual(points(data).tolist(), [[1, 2, 3]])
        self.assertEqual(array(data, "normal").tolist(), [[0.5, 0.25]])
        self.assertNotIn("_", names(data))

    def test_empty_cells_are_left_out(self):
        write(b"1 2 3 7\nnan nan nan -1\n4 5 6 8\n-nan 1 2 9\n1 nan 2 9\n1 2 inf 9\n", FIELDS="x y z n", SIZE="4 4 4 4",
              TYPE="F F F I", COUNT="1 1 1 1", WIDTH=2, HEIGHT=3, POINTS=6)
        data = read(FILE)
        self.assertEqual(points(data).tolist(), [[1, 2, 3], [4, 5, 6]])
        self.assertEqual(array(data, "n").tolist(), [7, 8])

    def test_names(self):
        write(b"0 1 0 5 6 7 8\n", FIELDS="x y z intensity ring azimuth strange", SIZE="4 4 4 1 2 4 4",
              TYPE="F F F U U F F", COUNT="1 1 1 1 1 1 1", WIDTH=1, POINTS=1)
        data = read(FILE)
        self.assertEqual(set(names(data)), {"intensity", "laser_id", "file_azimuth", "strange", "azimuth", "distance_m",
                                            "vertical_angle"})
        self.assertEqual(unit(data, "intensity"), "1")
        self.assertEqual((array(data, "azimuth")[0], array(data, "file_azimuth")[0]), (0, 7))
        write(b"0 1 0 5 6\n", FIELDS="x y z channel ring", SIZE="4 4 4 1 2", TYPE="F F F U U", COUNT="1 1 1 1 1",
              WIDTH=1, POINTS=1)
        self.assertEqual(array(read(FILE), "laser_id")[0], 6)

    def test_the_same_name_twice(self):
        write(b"0 1 0 5 6\n", FIELDS="x y z n n", SIZE="4 4 4 1 2", TYPE="F F F U U", COUNT="1 1 1 1 1", WIDTH=1, POINTS=1)
        data = read(FILE)
        self.assertEqual((array(data, "n")[0], array(data, "file_n")[0]), (5, 6))

    def test_viewpoint(self):
        write(VIEWPOINT="1 2 -7 1 0 0 0")
        data = read(FILE)
        self.assertEqual(field(data, "position"), [1, 2, -7])
        self.assertEqual(array(data, "distance_m")[0], 10)
        self.assertEqual(array(data, "vertical_angle")[0], 90)
        write(b"-1e-30 1 0\n1 1 0\n")
        self.assertEqual(array(read(FILE), "azimuth").tolist(), [0, 4500])  # not 360 degrees

    def test_comments(self):
        write(comments=(".PCD v0.7 - Point Cloud Data file format", "by hand", "{not json"))
        self.assertEqual(field(read(FILE), "comment"), [" by hand", " {not json"])

    def test_any_bytes(self):
        write(b"0 1 0 7\n", FIELDS="x y z n?", SIZE="4 4 4 4", TYPE="F F F F", COUNT="1 1 1 1", WIDTH=1, POINTS=1)
        with open(FILE, "rb") as file:
            whole = file.read()
        with open(FILE, "wb") as file:
            file.write(b"# caf\xc3\xa9 \xff\x01\n" + whole.replace(b"n?", b"n\xfe"))
        data = read(FILE)
        self.assertEqual(field(data, "comment"), [" caf\u00e9 \ufffd?"])
        self.assertEqual(array(data, "n\ufffd")[0], 7)

    def test_notes(self):
        write(comments=['{"avian_lidar": {"units": {"azimuth": "0.01 deg", "x": 3}, "field_data": {"a": {"value": [1.5]},'
                        ' "b": {"value": ["t", "u"]}, "c": {"value": [1, "mixed"]}, "d": 7, "e": {"value": []}}}}'],
              data=b"0 1 0 70\n", FIELDS="x y z azimuth", SIZE="4 4 4 4", TYPE="F F F F", COUNT="1 1 1 1", WIDTH=1, POINTS=1)
        data = read(FILE)
        self.assertEqual((field(data, "a"), field(data, "b")), ([1.5], ["t", "u"]))
        self.assertEqual(array(data, "azimuth")[0], 70)
        for name in ("c", "d", "e"):
            self.assertFalse(data.GetFieldData().HasArray(name), name)

    def test_notes_of_another_shape_are_comments_or_nothing(self):
        for text, kept in (('{"avian_lidar": 7}', True), ('["avian_lidar"] {', True), ('{"other": "avian_lidar"}', True),
                           ('{"avian_lidar": {"units": 7, "field_data": [7]}}', False),
                           ('{"avian_lidar": {"field_data": {"a": {"value": 7}, "b": {"unit": "m"}, "c": {"value": [null]}}}}', False)):
            write(comments=[text])
            fields = read(FILE).GetFieldData()
            self.assertEqual(bool(fields.HasArray("comment")), kept, text)
            self.assertFalse(any(fields.HasArray(name) for name in "abc"), text)

    def test_dialects(self):
        """Types, keys and words in any case, COUNT 0 of old converters, a byte-order mark, plus signs."""
        for changes in ({"TYPE": "f F f"}, {"COUNT": "0 0 0"}, {"DATA": "ASCII"}, {"data": LINES.replace(b"1", b"+1")},
                        {"VERSION": "0.7\nfields x y z\nSize 4 4 4", "FIELDS": None, "SIZE": None}):
            write(**changes)
            self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]], changes)
        write(struct.pack("<3fB3fB", 1, 2, 3, 7, 4, 5, 6, 8), FIELDS="x y z n", SIZE="4 4 4 1", TYPE="f f f u", COUNT="1 1 1 0", DATA="binary")
        with open(FILE, "rb") as file:
            whole = file.read()
        with open(FILE, "wb") as file:
            file.write(b"\xef\xbb\xbf" + whole)
        data = read(FILE)
        self.assertEqual((points(data).tolist(), array(data, "n").tolist()), ([[1, 2, 3], [4, 5, 6]], [7, 8]))

    def test_more_points_than_the_header_says(self):
        for changes in ({"data": LINES + b"7 8 9\n"}, {"data": np.ones((3, 3), "<f4").tobytes(), "DATA": "binary"}):
            write(**changes)
            self.assertEqual(read(FILE, said=["its header says that it has 2 points, and more follow, which are left out"]).GetNumberOfPoints(), 2)

        write(data=np.concatenate([np.ones((2, 3)), np.zeros((100, 3))]).astype("<f4").tobytes(), DATA="binary")
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)  # PCL fills its last page

    def test_errors(self):
        cases = [
            ("no line DATA", {"DATA": None, "data": b""}),
            ('has the line "1 2 3"', {"DATA": None, "data": LINES}),
            ("DATA is missing", {"DATA": ""}),
            ("DATA is zip", {"DATA": "zip"}),
            ("as many values", {"SIZE": "4 4"}),
            ("as many values", {"TYPE": "F F"}),
            ("as many values", {"COUNT": "1"}),
            ("as many values", {"FIELDS": None}),
            ("expected I or U", {"SIZE": "4 4 3"}),
            ("expected I or U", {"TYPE": "F F Q"}),
            ("expected I or U", {"SIZE": "2 4 4"}),
            ("COUNT 70000", {"COUNT": "1 1 70000"}),
            ("expected a number", {"WIDTH": "two"}),
            ("expected a number", {"WIDTH": "-2"}),
            ("expected a number", {"WIDTH": "99999999999999999999"}),
            ("WIDTH times HEIGHT", {"POINTS": "3"}),
            ("above 4294967295", {"WIDTH": "4294967296", "POINTS": None}),
            ("above 4294967295", {"HEIGHT": "4294967296", "POINTS": None}),
            ("expected I or U", {"TYPE": "F F FF"}),
            ("more than one value", {"WIDTH": "2 2"}),
            ("no fields x, y and z", {"FIELDS": "x y w"}),
            ("no fields x, y and z", {"FIELDS": "x y y"}),
            ("seven values", {"VIEWPOINT": "0 0 0"}),
            ("not finite", {"VIEWPOINT": "0 0 nan 1 0 0 0"}),
            ("cut short", {"WIDTH": "1000000000", "POINTS": None}),
            ("cut short", {"WIDTH": "4000000000", "HEIGHT": "4000000000", "POINTS": None}),
            ("cut short", {"WIDTH": "3", "POINTS": "3", "data": LINES + b"           \n\n\n"}),
            ("point 1 has too many values", {"data": b"1 2 3\n4 5 6 7\n"}),
            ("too few values", {"data": b"1 2\n3 4 5\n     "}),
            ("expected a number", {"data": b"1 2 three\n4 5 6\n"}),
            ("cut short", {"DATA": "binary", "data": b"\0" * 23}),
            ("ends before", {"DATA": "binary_compressed", "data": b"\0" * 7}),
            ("have 25 bytes", {"DATA": "binary_compressed", "data": struct.pack("<II", 26, 25) + b"\0" * 26}),
            ("have 0 bytes", {"DATA": "binary_compressed", "data": b"\0" * 8}),
            ("damaged", {"DATA": "binary_compressed", "data": struct.pack("<II", 0, 24)}),
            ("ends before", {"DATA": "binary_compressed", "data": struct.pack("<II", 26, 24) + b"\x17" + b"\0" * 24}),
            ("damaged", {"DATA": "binary_compressed", "data": struct.pack("<II", 5, 24) + b"\xff" * 5}),
            ("damaged", {"DATA": "binary_compressed", "data": struct.pack("<II", 8, 4294967280) + b"\xff" * 8,
                         "WIDTH": "357913940", "POINTS": None, "SIZE": "4 4 4"}),
        ]
        for words, changes in cases:
            write(**changes)
            self.assertIn(words, read_error(FILE), changes)
            # Whether it can be read is decided by the header, and by what it promises.
            of_the_data = "data" in changes and changes.get("DATA", "ascii") == "ascii" or "compressed" in (changes.get("DATA") or "")
            readable = of_the_data and changes.get("DATA", "") is not None or words == "no fields x, y and z"
            self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), int(readable), changes)
        with open(FILE, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 10)
        self.assertIn("no PCD file", read_error(FILE))
        with open(FILE, "wb"):
            pass
        self.assertIn("no PCD file", read_error(FILE))

    def test_abort(self):
        write(LINES * 20000, WIDTH=40000, POINTS=40000)
        self.assert_stops()
        columns = np.ones(3 * 40000, "<f4").tobytes()
        write(struct.pack("<II", len(literal(columns)), len(columns)) + literal(columns), DATA="binary_compressed", WIDTH=40000, POINTS=40000)
        self.assert_stops()

    def assert_stops(self):
        reader = al.vtkAvianLidarPointCloudReader()
        heard = Messages(reader)
        reader.SetFileName(FILE)
        seen = []

        def stop(caller, _):
            seen.append(caller.GetProgress())
            if seen[-1] > 0:
                caller.SetAbortExecute(1)

        reader.AddObserver("ProgressEvent", stop)
        reader.Update()
        self.assertEqual(reader.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(heard.errors, [])
        self.assertTrue(any(0 < one < 1 for one in seen), seen)


if __name__ == "__main__":
    unittest.main()
