# SPDX-License-Identifier: BSD-3-Clause
"""PCD files against the Point Cloud Library's own programs: they read ours, and what they write of them is the same."""

import json
import os
import subprocess
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, assert_refused, cloud, echoes, names, points, read, unit, write
from echotools import array, scan, town

FILE, OTHER, PLY = "TestPCDWriter.pcd", "TestPCDWriter-pcl.pcd", "TestPCDWriter.ply"
KINDS = {("F", "4"): "<f4", ("F", "8"): "<f8", ("I", "4"): "<i4", ("U", "4"): "<u4"}
Writer = al.vtkAvianLidarPCDWriter
KINDS_OF_FILE = (Writer.FILE_TYPE_BINARY, Writer.FILE_TYPE_ASCII)


def parse(name=FILE):
    """Header and fields of a binary PCD file, read by NumPy."""
    with open(name, "rb") as file:
        data = file.read()
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
    run = subprocess.run(["pcl_convert_pcd_ascii_binary", FILE, OTHER, str(kind)], capture_output=True, text=True, check=True)
    return run.stdout + run.stderr


def value_of(data, name):
    """Values as the file has them: intensities are floats there."""
    return array(data, name).astype("<f4") if name == "intensity" else array(data, name)


class TestPCDWriter(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.several, cls.single = echoes(), echoes(ReturnMode=1)  # the strongest echo of a beam only

    def setUp(self):
        self.data = self.several.NewInstance()
        self.data.DeepCopy(self.several)
        self.writer = Writer()
        self.addCleanup(lambda: [os.remove(name) for name in (FILE, OTHER, PLY) if os.path.exists(name)])

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
        with open(FILE, "rb") as file:
            notes = json.loads(file.read().split(b"\n")[1][2:])["avian_lidar"]
        self.assertEqual((notes["units"]["azimuth"], notes["field_data"]["range_gate"]), ("0.01 deg", {"unit": "m", "value": [4000.0]}))
        self.write(data, Organisation=Writer.ORGANISATION_LIST, FileType=Writer.FILE_TYPE_BINARY)
        self.assert_echoes(data, parse()[1])

    def test_unequal_elevations(self):
        beams = al.vtkAvianLidarBeamSource()
        beams.SetNumberOfChannelElevations(3)
        for channel, elevation in enumerate((1.0, -0.5, 2.0)):
            beams.SetChannelElevation(channel, elevation)
        beams.SetAzimuthRange(10, 100)
        beams.SetAzimuthStep(2)
        lidar = scan(town(), beams, ReturnMode=1)
        lidar.Update()
        self.write(lidar.GetOutput())
        self.assertEqual(shape(), (3, 45))
        self.assertEqual([row[0] for row in parse()[1].reshape(3, 45)["laser_id"]], [2, 0, 1])

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

    def test_what_is_no_grid(self):
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
        def about(axis, degrees):
            c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
            i, j = (axis + 1) % 3, (axis + 2) % 3
            result = np.eye(3)
            result[i, i], result[j, j], result[i, j], result[j, i] = c, c, -s, s
            return result

        for yaw, pitch, roll in ((30.0, 2.0, 1.0), (180.0, 0.0, 0.0), (0.0, 180.0, 0.0), (0.0, 0.0, 180.0), (190.0, 0.0, 0.0)):
            self.write(echoes(orientation=(yaw, pitch, roll), columns=180))
            viewpoint = [float(word) for word in parse()[0]["VIEWPOINT"]]
            w, x, y, z = viewpoint[3:]
            turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
            self.assertEqual(viewpoint[:3], [10, 20, 3])
            np.testing.assert_allclose(turn, about(2, -yaw) @ about(0, pitch) @ about(1, roll), rtol=0, atol=1e-12)

    def test_single_precision_far_away_is_warned_of_or_refused(self):
        for far, refused in ((cloud([[340000.123, 3450000.456, 3.0]]), False), (cloud([[1, 2, 3], [1, 1e39, 3]]), True)):
            self.writer.SetPrecision(Writer.PRECISION_SINGLE)
            if refused:
                assert_refused(self, self.writer, far, FILE, "point 1 ")
            else:
                self.assertRegex(" ".join(self.write(far)), "Precision")
            self.assertEqual(self.write(far, Precision=Writer.PRECISION_DOUBLE), [])
            np.testing.assert_array_equal(points(read(FILE)), points(far))
            os.remove(FILE)

    def test_colours(self):
        n = self.data.GetNumberOfPoints()
        rgb = np.random.default_rng(5).integers(0, 256, (n, 3)).astype(np.uint8)
        add_array(self.data, "rgb", rgb, "1")
        self.write()
        subprocess.run(["pcl_pcd2ply", "-format", "0", FILE, PLY], check=True, capture_output=True)
        with open(PLY, encoding="ascii") as file:
            head, body = file.read().split("end_header\n")
        place = [line.split()[-1] for line in head.splitlines() if line.startswith("property") and "list" not in line]
        rows = [line.split() for line in body.splitlines()[:n]]
        got = [[int(row[place.index(c)]) for c in ("red", "green", "blue")] for row in rows]
        np.testing.assert_array_equal(got, rgb)

    def test_names(self):
        """They are words; of two arrays of one name the second is left out with a warning."""
        data = cloud([[1, 2, 3]])
        for name in ("x", "two words", "two_words", "intensity"):
            add_array(data, name, np.array([4.0]))
        (warning,) = self.write(data)
        self.assertIn("'x', 'two_words'", warning)
        self.assertEqual(parse()[0]["FIELDS"], ["x", "y", "z", "intensity", "two_words"])
        self.assertEqual((points(read(FILE)).tolist(), unit(read(FILE), "two_words")), ([[1, 2, 3]], None))

    def test_no_points(self):
        self.write(cloud([]))
        self.assertEqual((parse()[0]["POINTS"], read(FILE).GetNumberOfPoints()), (["0"], 0))


if __name__ == "__main__":
    unittest.main()
