# SPDX-License-Identifier: BSD-3-Clause
"""PCD files against the Point Cloud Library's own programs: they read ours, and what they write of them is the same."""

import json
import os
import subprocess
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import (add_array, add_field, assert_same_arrays, cloud, echoes, field, names, points, read, unit,
                        write)
from echotools import Messages, array, scan, town

FILE, OTHER, PLY = "TestPCDWriter.pcd", "TestPCDWriter-pcl.pcd", "TestPCDWriter.ply"
KINDS = {("F", "4"): "<f4", ("F", "8"): "<f8", ("U", "1"): "u1", ("I", "4"): "<i4", ("U", "4"): "<u4"}
Writer = al.vtkAvianLidarPCDWriter


def parse(name):
    """Header and fields of a PCD file, ASCII or binary, read by NumPy."""
    with open(name, "rb") as file:
        data = file.read()
    header, at = {}, 0
    while "DATA" not in header:
        end = data.index(b"\n", at)
        key, *words = data[at:end].decode("ascii").split() or [""]
        header.setdefault(key, words)
        at = end + 1
    record = np.dtype([(n, KINDS[k]) for n, k in zip(header["FIELDS"], zip(header["TYPE"], header["SIZE"]))])
    if header["DATA"] == ["binary"]:
        return header, np.frombuffer(data, record, int(header["POINTS"][0]), at)
    rows = [tuple(line.split()) for line in data[at:].decode("ascii").splitlines()]
    return header, np.array([tuple(map(float, row)) for row in rows]).T, record.names


def through_pcl(kind, name=FILE):
    """PCL reads the file and writes it: 0 ASCII, 1 binary, 2 compressed. Returns what it says."""
    run = subprocess.run(["pcl_convert_pcd_ascii_binary", name, OTHER, str(kind)], capture_output=True, text=True,
                         check=True)
    return run.stdout + run.stderr


class TestPCDWriter(unittest.TestCase):
    def setUp(self):
        self.data = echoes()
        self.writer = Writer()

    def tearDown(self):
        for name in (FILE, OTHER, PLY):
            if os.path.exists(name):
                os.remove(name)

    def write(self, data=None, **properties):
        return write(self.writer, data or self.data, FILE, **properties)

    def assert_echoes(self, data, got):
        """A structured array has the echoes as they were, coordinates and intensities as floats."""
        for axis in range(3):
            np.testing.assert_array_equal(got["xyz"[axis]], points(data)[:, axis].astype("<f4"))
        np.testing.assert_array_equal(got["intensity"], array(data, "intensity").astype("<f4"))
        for name in names(data):
            if name != "intensity":
                np.testing.assert_array_equal(got[name], array(data, name), name)

    def test_binary(self):
        self.assertEqual(self.write(), [])
        said = through_pcl(1)
        self.assertIn(f"Loaded a point cloud with {self.data.GetNumberOfPoints()} points", said)
        self.assertIn("channels: x y z intensity energy ", said)
        header, got = parse(OTHER)
        self.assertEqual(header["HEIGHT"], ["1"])
        self.assertEqual(set(header["FIELDS"]), {"x", "y", "z", *names(self.data)})
        self.assert_echoes(self.data, got)

    def test_ascii_has_every_digit(self):
        self.write(FileType=Writer.FILE_TYPE_ASCII)
        self.assertEqual(parse(FILE)[0]["DATA"], ["ascii"])
        through_pcl(1)
        self.assert_echoes(self.data, parse(OTHER)[1])

    def test_types(self):
        self.write()
        header, _ = parse(FILE)
        types = dict(zip(header["FIELDS"], zip(header["TYPE"], header["SIZE"])))
        for name in ("x", "y", "z", "intensity"):
            self.assertEqual(types[name], ("F", "4"), name)
        for name in ("energy", "distance_m", "timestamp", "beam_id"):
            self.assertEqual(types[name], ("F", "8"), name)
        for name in ("laser_id", "object_id", "material_id", "return_number"):
            self.assertEqual(types[name], ("I", "4"), name)

    def test_compressed_by_pcl_is_read(self):
        self.write()
        through_pcl(2)
        again = read(OTHER)
        np.testing.assert_array_equal(points(again), points(self.data).astype("f4"))
        # PCL drops the comment, and with it the units.
        np.testing.assert_array_equal(array(again, "file_energy"), array(self.data, "energy"))
        np.testing.assert_array_equal(array(again, "laser_id"), array(self.data, "laser_id"))

    def test_organised(self):
        self.data = echoes(ReturnMode=1)  # the strongest echo of a beam only
        for kind in (Writer.FILE_TYPE_BINARY, Writer.FILE_TYPE_ASCII):
            self.assertEqual(self.write(FileType=kind), [])
            through_pcl(1)
            header, got = parse(OTHER)
            self.assertEqual((header["WIDTH"], header["HEIGHT"]), (["90"], ["4"]))
            grid = got.reshape(4, 90)
            full = np.isfinite(grid["x"])
            self.assertEqual(full.sum(), self.data.GetNumberOfPoints())
            # Rows are channels, the highest first, columns go with the azimuth; all cells know their beam.
            np.testing.assert_array_equal(grid["laser_id"], np.repeat([[3], [2], [1], [0]], 90, axis=1))
            np.testing.assert_array_equal(grid["beam_id"], 4 * np.arange(90) + grid["laser_id"])
            order = np.argsort(array(self.data, "beam_id"))
            for name in names(self.data):
                by_beam = grid[name][full][np.argsort(grid["beam_id"][full])]
                expected = array(self.data, name)[order]
                np.testing.assert_array_equal(by_beam, expected.astype("f4") if name == "intensity" else expected, name)
            empty = grid[~full]
            self.assertGreater(len(empty), 10)
            for name, value in {"energy": np.nan, "y": np.nan, "object_id": -1, "return_number": 0}.items():
                np.testing.assert_array_equal(empty[name], np.full(len(empty), value, empty[name].dtype), name)
            again = read(FILE)
            self.assertEqual(again.GetNumberOfPoints(), self.data.GetNumberOfPoints())

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
        header, got = parse(FILE)
        self.assertEqual((header["WIDTH"], header["HEIGHT"]), (["45"], ["3"]))
        self.assertEqual([row[0] for row in got.reshape(3, 45)["laser_id"]], [2, 0, 1])

    def test_several_returns_of_a_beam(self):
        returns = array(self.data, "number_of_returns")
        self.assertGreater(returns.max(), 1)
        self.write()
        self.assertEqual(parse(FILE)[0]["HEIGHT"], ["1"])
        self.write(Organisation=Writer.ORGANISATION_ORGANISED)
        header, got = parse(FILE)
        self.assertEqual(header["HEIGHT"], ["4"])
        full = got[np.isfinite(got["x"])]
        strongest = {}
        for beam, energy in zip(array(self.data, "beam_id"), array(self.data, "energy_received")):
            strongest[beam] = max(energy, strongest.get(beam, 0))
        self.assertEqual(dict(zip(full["beam_id"].astype(int), full["energy_received"])), strongest)

    def test_list(self):
        self.data = echoes(ReturnMode=1)
        self.write(Organisation=Writer.ORGANISATION_LIST)
        header, got = parse(FILE)
        self.assertEqual(header["HEIGHT"], ["1"])
        self.assert_echoes(self.data, got)

    def test_what_is_no_grid(self):
        def refuse(change, words):
            data = echoes(ReturnMode=1)
            change(data)
            self.write(data, Organisation=Writer.ORGANISATION_AUTOMATIC)
            self.assertEqual(parse(FILE)[0]["HEIGHT"], ["1"])
            os.remove(FILE)
            self.writer.SetOrganisationToOrganised()
            heard = Messages(self.writer)
            self.assertEqual(self.writer.Write(), 0)
            self.assertEqual(len(heard.errors), 1)
            self.assertIn(words, heard.errors[0])
            self.assertFalse(os.path.exists(FILE))

        refuse(lambda data: data.GetFieldData().RemoveArray("azimuth_step"), "'azimuth_step'")
        refuse(lambda data: data.GetPointData().RemoveArray("laser_id"), "'laser_id'")
        refuse(lambda data: add_field(data, "azimuth_step", (1e-5,)), "100 million")
        for step in (0.0, -1.0, 1e-320, 1e308, np.nan):
            refuse(lambda data, step=step: add_field(data, "azimuth_step", (step,)), "it cannot be organised")
        refuse(lambda data: data.GetPointData().GetArray("laser_id").SetValue(0, 99), "laser_id 99")
        refuse(lambda data: data.GetPointData().GetArray("beam_id").SetValue(0, 360), "beam_id 360")

    def test_viewpoint(self):
        self.data = echoes(orientation=(30.0, 2.0, 1.0))
        self.write()
        viewpoint = [float(word) for word in parse(FILE)[0]["VIEWPOINT"]]
        self.assertEqual(viewpoint[:3], [10, 20, 3])
        w, x, y, z = viewpoint[3:]
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])

        def about(axis, degrees):
            c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
            i, j = [k for k in range(3) if k != axis]
            result = np.eye(3)
            result[i, i], result[j, j], result[i, j], result[j, i] = c, c, -s, s
            return result if axis != 1 else result.T

        # Yaw is clockwise seen from above, pitch nose up about x (right), roll to the right about y (forward).
        expected = about(2, -30.0) @ about(0, 2.0) @ about(1, 1.0)
        np.testing.assert_allclose(turn, expected, rtol=0, atol=1e-12)
        for orientation in ((180.0, 0.0, 0.0), (0.0, 180.0, 0.0), (0.0, 0.0, 180.0), (190.0, 0.0, 0.0)):
            self.write(echoes(orientation=orientation))
            quaternion = [float(word) for word in parse(FILE)[0]["VIEWPOINT"]][3:]
            self.assertAlmostEqual(np.linalg.norm(quaternion), 1, 12)

    def test_notes_stand_in_a_comment_that_pcl_passes_over(self):
        self.write()
        with open(FILE, "rb") as file:
            comment = file.read().split(b"\n")[1].decode("ascii")
        notes = json.loads(comment[2:])["avian_lidar"]
        self.assertEqual(notes["units"]["azimuth"], "0.01 deg")
        self.assertEqual(notes["field_data"]["range_gate"], {"unit": "m", "value": [4000.0]})

    def test_read_again(self):
        for kind in (Writer.FILE_TYPE_BINARY, Writer.FILE_TYPE_ASCII):
            self.write(FileType=kind, Precision=Writer.PRECISION_DOUBLE)
            again = read(FILE)
            np.testing.assert_array_equal(points(again), points(self.data))
            assert_same_arrays(self.data, again, left_out=("intensity",))
            np.testing.assert_array_equal(array(again, "intensity"), array(self.data, "intensity").astype("f4"))
            for name in ("position", "orientation", "geodetic_origin", "lower_energy_limit", "object_classes"):
                self.assertEqual(field(again, name), field(self.data, name), name)

    def test_single_precision_far_away_is_warned_of(self):
        far = cloud(np.array([[340000.123, 3450000.456, 3.0]]))
        warnings = self.write(far)
        self.assertEqual(len(warnings), 1)
        self.assertIn("Precision", warnings[0])
        self.assertEqual(self.write(far, Precision=Writer.PRECISION_DOUBLE), [])
        np.testing.assert_array_equal(points(read(FILE)), points(far))

    def test_colours(self):
        n = self.data.GetNumberOfPoints()
        rgb = np.random.default_rng(5).integers(0, 256, (n, 3)).astype(np.uint8)
        add_array(self.data, "rgb", rgb, "1")
        for kind in (Writer.FILE_TYPE_BINARY, Writer.FILE_TYPE_ASCII):
            self.write(FileType=kind)
            np.testing.assert_array_equal(array(read(FILE), "rgb"), rgb)
        subprocess.run(["pcl_pcd2ply", "-format", "0", FILE, PLY], check=True, capture_output=True)
        with open(PLY, encoding="ascii") as file:
            head, body = file.read().split("end_header\n")
        place = [line.split()[-1] for line in head.splitlines() if line.startswith("property") and "list" not in line]
        rows = [line.split() for line in body.splitlines()[:n]]
        got = [[int(row[place.index(c)]) for c in ("red", "green", "blue")] for row in rows]
        np.testing.assert_array_equal(got, rgb)

    def test_no_points(self):
        self.write(cloud([]))
        self.assertEqual(parse(FILE)[0]["POINTS"], ["0"])
        self.assertEqual(read(FILE).GetNumberOfPoints(), 0)

    def test_names_are_words(self):
        data = cloud([[1, 2, 3]])
        add_array(data, "two words", np.array([4.0]))
        self.write(data)
        self.assertEqual(unit(read(FILE), "two_words"), None)

    def test_names_that_are_taken(self):
        data = cloud([[1, 2, 3]])
        for name in ("x", "two words", "two_words", "intensity"):
            add_array(data, name, np.array([4.0]))
        (warning,) = self.write(data)
        self.assertIn("'x', 'two_words'", warning)
        self.assertEqual(parse(FILE)[0]["FIELDS"], ["x", "y", "z", "intensity", "two_words"])
        np.testing.assert_array_equal(points(read(FILE)), [[1, 2, 3]])

    def test_beyond_single_precision(self):
        data = cloud([[1, 2, 3], [1, 1e39, 3]])
        heard = Messages(self.writer)
        self.writer.SetInputData(data)
        self.writer.SetFileName(FILE)
        self.assertEqual(self.writer.Write(), 0)
        self.assertIn("point 1 ", heard.errors[0])
        self.assertIn("Precision", heard.errors[0])
        self.assertFalse(os.path.exists(FILE))
        self.assertEqual(self.write(data, Precision=Writer.PRECISION_DOUBLE), [])
        np.testing.assert_array_equal(points(read(FILE)), points(data))

    def test_bad_input(self):
        add_field(self.data, "position", (1.0, np.nan, 0.0))
        heard = Messages(self.writer)
        self.writer.SetInputData(self.data)
        self.writer.SetFileName(FILE)
        self.assertEqual(self.writer.Write(), 0)
        self.assertIn("'position'", heard.errors[0])
        self.assertFalse(os.path.exists(FILE))


if __name__ == "__main__":
    unittest.main()
