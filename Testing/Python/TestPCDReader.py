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
        file.write("\n".join(lines).encode("utf-8") + b"\n" + data)


def one(data, fields, types, **changes):
    """A file of one point in ASCII: types as "F4 U1"."""
    kinds = types.split()
    write(data, FIELDS=fields, SIZE=" ".join(kind[1] for kind in kinds), TYPE=" ".join(kind[0] for kind in kinds),
          **{"COUNT": " ".join("1" * len(kinds)), "WIDTH": 1, "POINTS": 1, **changes})


def literal(data):
    """LZF without any packing: runs of at most 32 bytes behind their length."""
    return b"".join(bytes([len(data[i:i + 32]) - 1]) + data[i:i + 32] for i in range(0, len(data), 32))


class TestPCDReader(unittest.TestCase):
    def tearDown(self):
        os.remove(FILE)

    def test_the_same_two_points(self):
        """Other ends of lines, what a header may leave out, words in any case, COUNT 0 of old converters, plus signs."""
        for changes in ({}, {"data": LINES.replace(b"\n", b"\r\n").replace(b" ", b"\t ") + b"\n\n"}, {"data": LINES[:-1]},
                        *({key: None} for key in ("VERSION", "COUNT", "VIEWPOINT", "POINTS", "HEIGHT")), {"WIDTH": None, "HEIGHT": None},
                        {"VERSION": "0.5\nCOLUMNS x y z", "FIELDS": None}, {"TYPE": "f F f"}, {"COUNT": "0 0 0"}, {"DATA": "ASCII"},
                        {"data": LINES.replace(b"1", b"+1")}, {"VERSION": "0.7\nfields x y z\nSize 4 4 4", "FIELDS": None, "SIZE": None}):
            write(**changes)
            self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]], changes)

    def test_every_type(self):
        kinds = {"I1": "i1", "U1": "u1", "I2": "<i2", "U2": "<u2", "I4": "<i4", "U4": "<u4", "I8": "<i8", "U8": "<u8",
                 "F4": "<f4", "F8": "<f8"}
        record = np.dtype([(axis, "<f4") for axis in "xyz"] + list(kinds.items()))
        rows = np.zeros(3, record)
        for name, kind in kinds.items():
            limits = np.finfo(kind) if name[0] == "F" else np.iinfo(kind)
            rows[name] = [limits.min, 1, limits.max]
        columns = b"".join(np.ascontiguousarray(rows[name]).tobytes() for name in record.names)
        packed = literal(columns)
        text = "".join(" ".join(repr(value.item()) for value in row) + "\n" for row in rows)
        for kind, data in (("binary", rows.tobytes()), ("ascii", text.encode("ascii")),
                           ("binary_compressed", struct.pack("<II", len(packed), len(columns)) + packed)):
            one(data, " ".join(record.names), " ".join(["F4 F4 F4", *kinds]), DATA=kind, WIDTH=3, POINTS=3)
            got = read(FILE)
            for name, dtype in kinds.items():
                self.assertEqual(array(got, name).dtype, np.dtype(dtype), (kind, name))
                np.testing.assert_array_equal(array(got, name), rows[name], f"{kind} {name}")

    def test_fields(self):
        """Several values, padding, names of other programs, a name twice; whole numbers written as others."""
        one(b"1 7 8 9 2 3 0.5 0.25\n", "x _ y z normal", "F4 U1 F4 F4 F4", COUNT="1 3 1 1 2")
        data = read(FILE)
        self.assertEqual((points(data).tolist(), array(data, "normal").tolist()), ([[1, 2, 3]], [[0.5, 0.25]]))
        self.assertNotIn("_", names(data))
        one(b"0 1 0 5 6 7 8 1e3 2.5e3\n", "x y z intensity ring azimuth strange strange n", "F4 F4 F4 U1 U2 F4 F4 I8 U8")
        data = read(FILE)
        self.assertEqual(set(names(data)), {"intensity", "laser_id", "file_azimuth", "strange", "file_strange", "n", "azimuth", "distance_m",
                                            "vertical_angle"})
        self.assertEqual(unit(data, "intensity"), "1")
        self.assertEqual([array(data, name)[0] for name in ("azimuth", "file_azimuth", "strange", "file_strange", "n")], [0, 7, 8, 1000, 2500])
        one(b"0 1 0 5 6\n", "x y z channel ring", "F4 F4 F4 U1 U2")
        self.assertEqual(array(read(FILE), "laser_id")[0], 6)

    def test_empty_cells_are_left_out(self):
        one(b"1 2 3 7\nnan nan nan -1\n4 5 6 8\n-nan 1 2 9\n1 nan 2 9\n1 2 inf 9\n", "x y z n", "F4 F4 F4 I4", WIDTH=2, HEIGHT=3, POINTS=6)
        data = read(FILE)
        self.assertEqual((points(data).tolist(), array(data, "n").tolist()), ([[1, 2, 3], [4, 5, 6]], [7, 8]))

    def test_viewpoint(self):
        write(VIEWPOINT="1 2 -7 1 0 0 0")
        data = read(FILE)
        self.assertEqual((field(data, "position"), array(data, "distance_m")[0], array(data, "vertical_angle")[0]), ([1, 2, -7], 10, 90))
        write(b"-1e-30 1 0\n1 1 0\n")
        self.assertEqual(array(read(FILE), "azimuth").tolist(), [0, 4500])  # not 360 degrees

    def test_comments_and_notes(self):
        write(comments=(".PCD v0.7 - Point Cloud Data file format", "by hand", "{not json"))
        self.assertEqual(field(read(FILE), "comment"), [" by hand", " {not json"])
        one(b"0 1 0 70\n", "x y z azimuth", "F4 F4 F4 F4", comments=[
            '{"avian_lidar": {"units": {"azimuth": "0.01 deg", "x": 3}, "field_data": {"a": {"value": [1.5]}, "b": {"value": ["t", "u"]}, '
            '"c": {"value": [1, "mixed"]}, "d": 7, "e": {"value": []}}}}'])
        data = read(FILE)
        self.assertEqual((field(data, "a"), field(data, "b"), array(data, "azimuth")[0]), ([1.5], ["t", "u"], 70))
        self.assertFalse(any(data.GetFieldData().HasArray(name) for name in "cde"))
        for text, kept in (('{"avian_lidar": 7}', True), ('["avian_lidar"] {', True),
                           ('{"avian_lidar": {"units": 7, "field_data": [7]}}', False)):
            write(comments=[text])
            self.assertEqual(bool(read(FILE).GetFieldData().HasArray("comment")), kept, text)

    def test_more_points_than_the_header_says(self):
        for changes in ({"data": LINES + b"7 8 9\n"}, {"data": np.ones((3, 3), "<f4").tobytes(), "DATA": "binary"}):
            write(**changes)
            self.assertEqual(read(FILE, said=["it has 2 points, and more follow"]).GetNumberOfPoints(), 2)
        write(data=np.concatenate([np.ones((2, 3)), np.zeros((100, 3))]).astype("<f4").tobytes(), DATA="binary")
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)  # PCL fills its last page

    def test_errors(self):
        packed = {"DATA": "binary_compressed"}
        for words, changes in (
            ("no line DATA", {"DATA": None, "data": b""}),
            ('has the line "1 2 3"', {"DATA": None}),
            ("DATA is missing", {"DATA": ""}),
            ("as many values", {"FIELDS": None}),
            ("expected I or U", {"SIZE": "4 4 3"}),
            ("expected I or U", {"TYPE": "F F FF"}),
            ("COUNT 70000", {"COUNT": "1 1 70000"}),
            ("expected a number", {"WIDTH": "99999999999999999999"}),
            ("WIDTH times HEIGHT", {"POINTS": "3"}),
            ("above 4294967295", {"HEIGHT": "4294967296", "POINTS": None}),
            ("no fields x, y and z", {"FIELDS": "x y y"}),
            ("seven values", {"VIEWPOINT": "0 0 0"}),
            ("not finite", {"VIEWPOINT": "0 0 nan 1 0 0 0"}),
            ("cut short", {"WIDTH": "4000000000", "HEIGHT": "4000000000", "POINTS": None}),
            ("cut short", {"WIDTH": "3", "POINTS": "3", "data": LINES + b"           \n\n\n"}),
            ("point 1 has too many values", {"data": b"1 2 3\n4 5 6 7\n"}),
            ("too few values", {"data": b"1 2\n3 4 5\n     "}),
            ("expected a number", {"data": b"1 2 three\n4 5 6\n"}),
            ("cut short", {"DATA": "binary", "data": b"\0" * 23}),
            ("ends before", {**packed, "data": b"\0" * 7}),
            ("have 25 bytes", {**packed, "data": struct.pack("<II", 26, 25) + b"\0" * 26}),
            ("ends before", {**packed, "data": struct.pack("<II", 26, 24) + b"\x17" + b"\0" * 24}),
            ("damaged", {**packed, "data": struct.pack("<II", 5, 24) + b"\xff" * 5}),
            ("damaged", {**packed, "data": struct.pack("<II", 8, 4294967280) + b"\xff" * 8, "WIDTH": "357913940", "POINTS": None}),
        ):
            write(**changes)
            self.assertIn(words, read_error(FILE), changes)
        for data in (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 10, b""):
            with open(FILE, "wb") as file:
                file.write(data)
            self.assertIn("no PCD file", read_error(FILE))
            self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 0)

    def test_abort(self):
        columns = np.ones(3 * 40000, "<f4").tobytes()
        packed = literal(columns)
        for data, kind in ((LINES * 20000, "ascii"), (struct.pack("<II", len(packed), len(columns)) + packed, "binary_compressed")):
            write(data, WIDTH=40000, POINTS=40000, DATA=kind)
            reader = al.vtkAvianLidarPointCloudReader()
            heard = Messages(reader)
            reader.SetFileName(FILE)
            reader.AddObserver("ProgressEvent", lambda caller, _: caller.SetAbortExecute(int(0 < caller.GetProgress() < 1)))
            reader.Update()
            self.assertEqual((reader.GetOutput().GetNumberOfPoints(), heard.errors), (0, []))


if __name__ == "__main__":
    unittest.main()
