# SPDX-License-Identifier: BSD-3-Clause
"""PCD files of every kind, made by hand, and every way in which they can be wrong; what is written is read by the Point
Cloud Library's own programs, and what they write of it is the same."""

import os
import pathlib
import struct
import subprocess

import numpy as np
from scipy.spatial.transform import Rotation

from avianlidar import vtkAvianLidar as al
from cloudtools import (add_array, add_field, assert_extremes, assert_refused, cloud, echoes, extremes, field, names,
                        points, read, read_error, unit, write)
from echotools import InFolder, array, copy_of, given, scan, town

FILE, OTHER, PLY = "TestPCD.pcd", "TestPCD-pcl.pcd", "TestPCD.ply"
HEADER = {"VERSION": "0.7", "FIELDS": "x y z", "SIZE": "4 4 4", "TYPE": "F F F", "COUNT": "1 1 1", "WIDTH": "2",
          "HEIGHT": "1", "VIEWPOINT": "0 0 0 1 0 0 0", "POINTS": "2", "DATA": "ascii"}
LINES = b"1 2 3\n4 5 6\n"
KINDS = {("F", "4"): "<f4", ("F", "8"): "<f8", ("I", "4"): "<i4", ("U", "4"): "<u4"}
Writer = al.vtkAvianLidarPCDWriter
KINDS_OF_FILE = (Writer.FILE_TYPE_BINARY, Writer.FILE_TYPE_ASCII)


def parse(name=FILE):
    """Header and fields of a binary PCD file, read by NumPy."""
    data = pathlib.Path(name).read_bytes()
    header, at = {}, 0
    while "DATA" not in header:
        end = data.index(b"\n", at)
        key, *words = data[at:end].decode("ascii").split() or [""]
        header.setdefault(key, words)
        at = end + 1
    record = np.dtype([(n, KINDS[k]) for n, k in zip(header["FIELDS"], zip(header["TYPE"], header["SIZE"]))])
    return header, np.frombuffer(data, record, int(header["POINTS"][0]), at)


def shape(name=FILE):
    header, _ = parse(name)
    return int(header["HEIGHT"][0]), int(header["WIDTH"][0])


def through_pcl(kind):
    """PCL reads the file and writes it: 0 ASCII, 1 binary, 2 compressed. Returns what it says."""
    run = subprocess.run(["pcl_convert_pcd_ascii_binary", FILE, OTHER, str(kind)], capture_output=True, text=True,
                         check=True)
    return run.stdout + run.stderr


def value_of(data, name):
    """Values as the file has them: intensities are floats there."""
    return array(data, name).astype("<f4") if name == "intensity" else array(data, name)


def put(data=LINES, comments=(), **changes):
    lines = [f"# {comment}" for comment in comments]
    lines += [f"{key} {value}" for key, value in {**HEADER, **changes}.items() if value is not None]
    pathlib.Path(FILE).write_bytes("\n".join(lines).encode("utf-8") + b"\n" + data)


def one(data, fields, types, **changes):
    """A file of one point in ASCII: types as "F4 U1"."""
    kinds = types.split()
    put(data, FIELDS=fields, SIZE=" ".join(kind[1] for kind in kinds), TYPE=" ".join(kind[0] for kind in kinds),
          **{"COUNT": " ".join("1" * len(kinds)), "WIDTH": 1, "POINTS": 1, **changes})


def literal(data):
    """LZF without any packing: runs of at most 32 bytes behind their length."""
    return b"".join(bytes([len(data[i:i + 32]) - 1]) + data[i:i + 32] for i in range(0, len(data), 32))


class Reader(InFolder):
    def test_the_same_two_points(self):
        """Other ends of lines, what a header may leave out, words in any case, COUNT 0 of old converters, plus
        signs."""
        for changes in ({}, {"data": LINES.replace(b"\n", b"\r\n").replace(b" ", b"\t ") + b"\n\n"},
                        {"data": LINES[:-1]},
                        *({key: None} for key in ("VERSION", "COUNT", "VIEWPOINT", "POINTS", "HEIGHT")),
                        {"WIDTH": None, "HEIGHT": None}, {"VERSION": "0.5\nCOLUMNS x y z", "FIELDS": None},
                        {"TYPE": "f F f"}, {"COUNT": "0 0 0"}, {"DATA": "ASCII"}, {"data": LINES.replace(b"1", b"+1")},
                        {"VERSION": "0.7\nfields x y z\nSize 4 4 4", "FIELDS": None, "SIZE": None}):
            put(**changes)
            self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]], changes)

    def test_every_type(self):
        kinds = {kind.upper(): kind for kind in "i1 u1 i2 u2 i4 u4 i8 u8 f4 f8".split()}
        rows, text = extremes(kinds)
        columns = b"".join(np.ascontiguousarray(rows[name]).tobytes() for name in rows.dtype.names)
        packed = literal(columns)
        for kind, data in (("binary", rows.tobytes()), ("ascii", text),
                           ("binary_compressed", struct.pack("<II", len(packed), len(columns)) + packed)):
            one(data, " ".join(rows.dtype.names), " ".join(["F4 F4 F4", *kinds]), DATA=kind, WIDTH=3, POINTS=3)
            assert_extremes(read(FILE), rows, kinds)

    def test_fields(self):
        """Several values, padding, names of other programs, a name twice; whole numbers written as others."""
        one(b"1 7 8 9 2 3 0.5 0.25\n", "x _ y z normal", "F4 U1 F4 F4 F4", COUNT="1 3 1 1 2")
        data = read(FILE)
        self.assertEqual((points(data).tolist(), array(data, "normal").tolist()), ([[1, 2, 3]], [[0.5, 0.25]]))
        self.assertNotIn("_", names(data))
        one(b"0 1 0 5 6 7 8 1e3 2.5e3\n", "x y z intensity ring azimuth strange strange n",
            "F4 F4 F4 U1 U2 F4 F4 I8 U8")
        data = read(FILE)
        self.assertEqual(set(names(data)), {"intensity", "laser_id", "file_azimuth", "strange", "file_strange", "n",
                                            "azimuth", "distance_m", "vertical_angle"})
        self.assertEqual(unit(data, "intensity"), "1")
        self.assertEqual([array(data, name)[0] for name in ("azimuth", "file_azimuth", "strange", "file_strange", "n")],
                         [0, 7, 8, 1000, 2500])
        one(b"0 1 0 5 6\n", "x y z channel ring", "F4 F4 F4 U1 U2")
        self.assertEqual(array(read(FILE), "laser_id")[0], 6)

    def test_empty_cells_are_left_out(self):
        one(b"1 2 3 7\nnan nan nan -1\n4 5 6 8\n-nan 1 2 9\n1 nan 2 9\n1 2 inf 9\n", "x y z n", "F4 F4 F4 I4", WIDTH=2,
            HEIGHT=3, POINTS=6)
        data = read(FILE, said=["3 points whose coordinates are not finite are left out"])
        self.assertEqual((points(data).tolist(), array(data, "n").tolist()), ([[1, 2, 3], [4, 5, 6]], [7, 8]))
        put(b"nan nan nan\n4 5 6\n")  # no grid, in which such cells are empty
        self.assertEqual(points(read(FILE, said=["1 points whose coordinates are not finite"])).tolist(), [[4, 5, 6]])

    def test_viewpoint(self):
        put(VIEWPOINT="1 2 -7 1 0 0 0")
        data = read(FILE)
        self.assertEqual((field(data, "position"), array(data, "distance_m")[0], array(data, "vertical_angle")[0]),
                         ([1, 2, -7], 10, 90))
        put(b"-1e-30 1 0\n1 1 0\n")
        self.assertEqual(array(read(FILE), "azimuth").tolist(), [0, 4500])  # not 360 degrees

    def test_comments_and_notes(self):
        put(comments=(".PCD v0.7 - Point Cloud Data file format", "by hand", "{not json"))
        self.assertEqual(field(read(FILE), "comment"), [" by hand", " {not json"])
        one(b"0 1 0 70\n", "x y z azimuth", "F4 F4 F4 F4", comments=[
                '{"avian_lidar": {"units": {"azimuth": "0.01 deg", "x": 3}, "field_data": {"a": {"value": [1.5]}, "b": '
                '{"value": ["t", "u"]}, "c": {"value": [1, "mixed"]}, "d": 7, "e": {"value": []}}}}'])
        data = read(FILE)
        self.assertEqual((field(data, "a"), field(data, "b"), array(data, "azimuth")[0]), ([1.5], ["t", "u"], 70))
        self.assertFalse(any(data.GetFieldData().HasArray(name) for name in "cde"))
        for text, kept in (('{"avian_lidar": 7}', True), ('["avian_lidar"] {', True),
                           ('{"avian_lidar": {"units": 7, "field_data": [7]}}', False)):
            put(comments=[text])
            self.assertEqual(bool(read(FILE).GetFieldData().HasArray("comment")), kept, text)

    def test_more_points_than_the_header_says(self):
        for changes in ({"data": LINES + b"7 8 9\n"}, {"data": np.ones((3, 3), "<f4").tobytes(), "DATA": "binary"}):
            put(**changes)
            self.assertEqual(read(FILE, said=["it has 2 points, and more follow"]).GetNumberOfPoints(), 2)
        put(data=np.concatenate([np.ones((2, 3)), np.zeros((100, 3))]).astype("<f4").tobytes(), DATA="binary")
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)  # PCL fills its last page

    def test_errors(self):
        packed = {"DATA": "binary_compressed"}
        for words, changes in (("no line DATA", {"DATA": None, "data": b""}), ('has the line "1 2 3"', {"DATA": None}),
                               ("as many values", {"FIELDS": None}), ("expected I or U", {"SIZE": "4 4 3"}),
                               ("COUNT 70000", {"COUNT": "1 1 70000"}), ("WIDTH times HEIGHT", {"POINTS": "3"}),
                               ("above 4294967295", {"HEIGHT": "4294967296", "POINTS": None}),
                               ("no fields x, y and z", {"FIELDS": "x y y"}), ("seven values", {"VIEWPOINT": "0 0 0"}),
                               ("not finite", {"VIEWPOINT": "0 0 nan 1 0 0 0"}),
                               ("cut short", {"WIDTH": "4000000000", "HEIGHT": "4000000000", "POINTS": None}),
                               ("too few values", {"data": b"1 2\n3 4 5\n     "}),
                               ("cut short", {"WIDTH": "3", "POINTS": "3", "data": LINES + b"           \n\n\n"}),
                               ("point 1 has too many values", {"data": b"1 2 3\n4 5 6 7\n"}),
                               ("expected a number", {"data": b"1 2 three\n4 5 6\n"}),
                               ("cut short", {"DATA": "binary", "data": b"\0" * 23}),
                               ("ends before", {**packed, "data": b"\0" * 7}),
                               ("have 25 bytes", {**packed, "data": struct.pack("<II", 26, 25) + b"\0" * 26}),
                               ("ends before", {**packed, "data": struct.pack("<II", 26, 24) + b"\x17" + b"\0" * 24}),
                               ("damaged", {**packed, "data": struct.pack("<II", 5, 24) + b"\xff" * 5}),
                               ("damaged", {**packed, "data": struct.pack("<II", 8, 4294967280) + b"\xff" * 8,
                                            "WIDTH": "357913940", "POINTS": None})):
            put(**changes)
            self.assertIn(words, read_error(FILE), changes)
        for data in (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 10, b""):
            pathlib.Path(FILE).write_bytes(data)
            self.assertIn("not a PCD file", read_error(FILE))
            self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 0)

    def test_rgba(self):
        one(b"1 2 3 13132900\n", "x y z rgba", "F4 F4 F4 U4")  # 0x00C86464
        self.assertEqual(array(read(FILE), "rgb").tolist(), [[200, 100, 100]])


class Written(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.several, cls.single = echoes(), echoes(ReturnMode=1)  # the strongest echo of a beam only

    def setUp(self):
        super().setUp()
        self.data = copy_of(self.several)
        self.writer = Writer()

    def write(self, data=None, **properties):
        return write(self.writer, data or self.data, FILE, **properties)

    def assert_echoes(self, data, got):
        for axis in range(3):
            np.testing.assert_array_equal(got["xyz"[axis]], points(data)[:, axis].astype("<f4"))
        for name in names(data):
            np.testing.assert_array_equal(got[name], value_of(data, name), name)

    def test_pcl_reads_it(self):
        for kind in KINDS_OF_FILE:
            self.assertEqual(self.write(FileType=kind), [])
            self.assertIn(f"Loaded a point cloud with {self.data.GetNumberOfPoints()} points", through_pcl(1))
            header, got = parse(OTHER)
            self.assertEqual((header["HEIGHT"], set(header["FIELDS"])), (["1"], {"x", "y", "z", *names(self.data)}))
            self.assert_echoes(self.data, got)
        through_pcl(2)
        again = read(OTHER)
        np.testing.assert_array_equal(points(again), points(self.data).astype("f4"))
        # PCL drops the comment, and with it the units.
        np.testing.assert_array_equal(array(again, "file_energy"), array(self.data, "energy"))
        np.testing.assert_array_equal(array(again, "laser_id"), array(self.data, "laser_id"))

    def test_organised(self):
        data = self.single
        for kind in KINDS_OF_FILE:
            self.assertEqual(self.write(data, FileType=kind), [])
            through_pcl(1)
            self.assertEqual(shape(OTHER), (4, 90))
            grid = parse(OTHER)[1].reshape(4, 90)
            full = np.isfinite(grid["x"])
            # Rows are channels, the highest first, columns go with the azimuth; all cells know their beam.
            np.testing.assert_array_equal(grid["laser_id"], np.repeat([[3], [2], [1], [0]], 90, axis=1))
            np.testing.assert_array_equal(grid["beam_id"], 4 * np.arange(90) + grid["laser_id"])
            order = np.argsort(array(data, "beam_id"))
            for name in names(data):
                by_beam = grid[name][full][np.argsort(grid["beam_id"][full])]
                np.testing.assert_array_equal(by_beam, value_of(data, name)[order], name)
            empty = grid[~full]
            self.assertGreater(len(empty), 10)
            for name, value in {"energy": np.nan, "y": np.nan, "object_id": -1, "return_number": 0}.items():
                np.testing.assert_array_equal(empty[name], np.full(len(empty), value, empty[name].dtype), name)
            self.assertEqual(read(FILE).GetNumberOfPoints(), data.GetNumberOfPoints())
        self.write(data, Organisation=Writer.ORGANISATION_LIST, FileType=Writer.FILE_TYPE_BINARY)
        self.assert_echoes(data, parse()[1])

    def test_unequal_elevations(self):
        beams = given(al.vtkAvianLidarBeamSource(), NumberOfChannelElevations=3, AzimuthRange=(10, 100), AzimuthStep=2)
        for channel, elevation in enumerate((1.0, -0.5, 2.0)):
            beams.SetChannelElevation(channel, elevation)
        lidar = scan(town(), beams, ReturnMode=1)
        lidar.Update()
        self.write(lidar.GetOutput())
        self.assertEqual(shape(), (3, 45))
        self.assertEqual([row[0] for row in parse()[1].reshape(3, 45)["laser_id"]], [2, 0, 1])
        lidar = scan(town(), given(beams, NumberOfChannelElevations=1), ReturnMode=1)
        lidar.Update()
        self.write(lidar.GetOutput())
        self.assertEqual((shape(), np.isfinite(parse()[1]["x"]).all()), ((1, 45), np.False_))
        # empty cells give no warning
        self.assertEqual(read(FILE).GetNumberOfPoints(), lidar.GetOutput().GetNumberOfPoints())

    def test_several_returns_of_a_beam(self):
        self.assertGreater(array(self.data, "number_of_returns").max(), 1)
        self.write(Organisation=Writer.ORGANISATION_ORGANISED)
        self.assertEqual(shape()[0], 4)
        got = parse()[1]
        full = got[np.isfinite(got["x"])]
        strongest = {}
        for beam, energy in zip(array(self.data, "beam_id"), array(self.data, "energy_received")):
            strongest[beam] = max(energy, strongest.get(beam, 0))
        self.assertEqual(dict(zip(full["beam_id"].astype(int), full["energy_received"])), strongest)

    def test_clouds_without_a_grid(self):
        for change, words in (
                (lambda data: data.GetFieldData().RemoveArray("azimuth_step"), "'azimuth_step'"),
                (lambda data: data.GetPointData().RemoveArray("laser_id"), "'laser_id'"),
                (lambda data: add_field(data, "azimuth_step", (1e-5,)), "100 million"),
                *((lambda data, step=step: add_field(data, "azimuth_step", (step,)), "it cannot be organised")
                  for step in (0.0, 1e-320, 1e308, np.nan)),
                (lambda data: data.GetPointData().GetArray("laser_id").SetValue(0, 99), "laser_id 99"),
                (lambda data: data.GetPointData().GetArray("beam_id").SetValue(0, 360), "beam_id 360")):
            self.data.DeepCopy(self.single)
            change(self.data)
            self.write(Organisation=Writer.ORGANISATION_AUTOMATIC)
            self.assertEqual(shape()[0], 1)
            os.remove(FILE)
            self.writer.SetOrganisationToOrganised()
            assert_refused(self, self.writer, self.data, FILE, words)

    def test_viewpoint(self):
        """Yaw is clockwise seen from above, pitch nose up about x (right), roll to the right about y (forward)."""
        for yaw, pitch, roll in ((30.0, 2.0, 1.0), (180.0, 0.0, 0.0), (0.0, 180.0, 0.0), (0.0, 0.0, 180.0)):
            self.write(echoes(orientation=(yaw, pitch, roll), columns=180))
            viewpoint = [float(word) for word in parse()[0]["VIEWPOINT"]]
            self.assertEqual(viewpoint[:3], [10, 20, 3])
            self.assertAlmostEqual(np.linalg.norm(viewpoint[3:]), 1, 12)
            turn = Rotation.from_quat(np.roll(viewpoint[3:], -1))
            wanted = Rotation.from_euler("ZXY", (-yaw, pitch, roll), degrees=True)
            np.testing.assert_allclose(turn.as_matrix(), wanted.as_matrix(), rtol=0, atol=1e-12)

    def test_precision_follows_the_coordinates(self):
        """A cloud in coordinates of a map keeps them in double precision, automatically or as is set; in PLY, too."""
        far, beyond = cloud([[340000.123, 3450000.456, 3.0]]), cloud([[1, 2, 3], [1, 1e39, 3]])
        (words,) = self.write(far, Precision=Writer.PRECISION_SINGLE)
        loss = np.abs(np.float32(points(far)) - points(far)).max()
        self.assertIn(f"single precision moves coordinates by up to {round(loss, 3):g} m: set Precision to Double",
                      words)
        os.remove(FILE)
        assert_refused(self, self.writer, beyond, FILE, "point 1 ")
        self.assertEqual(self.write(beyond, Precision=Writer.PRECISION_DOUBLE), [])
        np.testing.assert_array_equal(points(read(FILE)), points(beyond))
        degrees = cloud([[121.3363123, 31.1979456, 3.0]])
        add_field(degrees, "crs_wkt", [
                      'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS '
                      '84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]'])
        off = np.abs(np.float32(points(degrees)) - points(degrees)).max() * 111320  # m along the equator
        for kind, name in ((al.vtkAvianLidarPCDWriter, FILE), (al.vtkAvianLidarPLYWriter, PLY)):
            self.assertEqual(kind().GetPrecision(), Writer.PRECISION_SINGLE)
            for data, said in ((far, "double precision, because single precision moves coordinates by up to 0.044 m"),
                               (degrees, f"by up to {round(off, 3):g} m"),
                               (beyond, "because single precision cannot hold all coordinates"),
                               (cloud(np.float32(points(far)).astype(float)), ""),
                               (cloud([[4000.123, 16000.456, 3.0]]), "")):
                warned = write(kind(), data, name, Precision=2)
                self.assertEqual([said in text for text in warned], [True] * bool(said))
                exact = points(data) if said else np.float32(points(data))
                np.testing.assert_array_equal(points(read(name)), exact)
                os.remove(name)
        las = al.vtkAvianLidarLASWriter()
        write(las, degrees, "degrees.las")  # a billionth of a degree is 0.1 mm
        found = read("degrees.las", said=["not in metres but in degree"])
        np.testing.assert_allclose(points(found), points(degrees), rtol=0, atol=0.5001e-9)

    def test_colours(self):
        n = self.data.GetNumberOfPoints()
        rgb = np.random.default_rng(5).integers(0, 256, (n, 3)).astype(np.uint8)
        add_array(self.data, "rgb", rgb, "1")
        self.write()
        subprocess.run(["pcl_pcd2ply", "-format", "0", FILE, PLY], check=True, capture_output=True)
        head, body = pathlib.Path(PLY).read_text("ascii").split("end_header\n")
        place = [line.split()[-1] for line in head.splitlines() if line.startswith("property") and "list" not in line]
        rows = [line.split() for line in body.splitlines()[:n]]
        got = [[int(row[place.index(c)]) for c in ("red", "green", "blue")] for row in rows]
        np.testing.assert_array_equal(got, rgb)

    def test_names(self):
        """They are words; of two arrays of one name the second is left out with a warning."""
        data = cloud([[1, 2, 3]])
        for name in ("x", "two words", "two_words"):
            add_array(data, name, np.array([4.0]))
        (warning,) = self.write(data)
        self.assertIn("'x', 'two_words'", warning)
        self.assertEqual((parse()[0]["FIELDS"], points(read(FILE)).tolist()),
                         (["x", "y", "z", "two_words"], [[1, 2, 3]]))

    def test_several_components(self):
        velocity = np.random.default_rng(7).normal(size=(self.data.GetNumberOfPoints(), 3))
        add_array(self.data, "velocity", velocity, "m/s")
        self.write()
        got = read(FILE)
        for c in range(3):
            np.testing.assert_array_equal(array(got, f"velocity_{c}"), velocity[:, c])
            self.assertEqual(unit(got, f"velocity_{c}"), "m/s")

    def test_too_many_fields(self):
        """More than the reader takes, of one array."""
        add_array(self.data, "wide", np.zeros((self.data.GetNumberOfPoints(), 4100)))
        assert_refused(self, self.writer, self.data, FILE, "would have more than 4096 fields")
