# SPDX-License-Identifier: BSD-3-Clause
"""Reading clouds: LAS of all formats made by hand, wrong files, real frames, and a real scan beside a simulated one."""

import os
import struct
import unittest

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from cloudtools import add_field, cloud, echoes, field, names, points, read, read_error, unit, write
from echotools import Messages, array

FILE = "TestPointCloudReader.las"
CORE = {0: 20, 1: 28, 2: 26, 3: 34, 6: 30, 7: 36, 8: 38}
DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")


def vlr(user, record, content):
    return struct.pack("<H16sHH32s", 0, user, record, len(content), b"") + content


def extra(name, kind, options=0, scale=(1, 1, 1), offset=(0, 0, 0), description=b""):
    return struct.pack("<HBB32sI24s24s24s3d3d32s", 0, kind, options, name, 0, b"", b"", b"", *scale, *offset, description)


def point(form, i):
    """A record of that format: (100 + i, 200, -i) in steps of 0.01 m."""
    position = struct.pack("<3iH", 10000 + 100 * i, 20000, -100 * i, 257 * i)
    time, rgb, nir = struct.pack("<d", 0.5 * i), struct.pack("<3H", 256 * i, 512, 65535), struct.pack("<H", 7)
    if form < 6:
        core = position + struct.pack("<BBbBH", 1 | 2 << 3, 2 | 1 << 5, -30, 9, 4)
    else:
        core = position + struct.pack("<BBBBhHd", 3 | 5 << 4, 2, 11, 9, 5000, 4, 0.5 * i)
    rest = {0: b"", 1: time, 2: rgb, 3: time + rgb, 6: b"", 7: rgb, 8: rgb + nir}[form]
    assert len(core + rest) == CORE[form]
    return core + rest


def las(form, n=5, minor=None, records=(), behind=b"", tail=b"", length=None, **patch):
    minor = (4 if form >= 6 else 2) if minor is None else minor
    size = {4: 375, 3: 235}.get(minor, 227)
    vlrs = b"".join(records)
    length = length or CORE[form] + len(behind)
    header = bytearray(size)
    struct.pack_into("<4s", header, 0, b"LASF")
    struct.pack_into("<BB", header, 24, 1, minor)
    struct.pack_into("<HIIBHI", header, 94, size, size + len(vlrs), len(records), form, length, n if form < 6 else 0)
    struct.pack_into("<6d", header, 131, 0.01, 0.01, 0.01, 1000, 2000, 0)
    if minor == 4:
        struct.pack_into("<QIQ", header, 235, size + len(vlrs) + n * length if tail else 0, 1 if tail else 0, n)
    for offset, (kind, value) in patch.get("patch", {}).items():
        struct.pack_into(kind, header, offset, value)
    with open(FILE, "wb") as file:
        file.write(bytes(header) + vlrs + b"".join(point(form, i) + behind for i in range(n)) + tail)


class TestPointCloudReader(unittest.TestCase):
    def tearDown(self):
        if os.path.exists(FILE):
            os.remove(FILE)

    def test_las_formats(self):
        for form, minor in [(0, 0), (1, 1), (0, 2), (1, 2), (2, 2), (3, 2), (3, 3), (0, 4), (3, 4), (6, 4), (7, 4), (8, 4)]:
            las(form, minor=minor)
            data = read(FILE)
            i = np.arange(5)
            # offset + 0.01 m * n
            expected = np.column_stack([1100 + i, np.full(5, 2200.0), -i])
            np.testing.assert_allclose(points(data), expected, rtol=1e-15, err_msg=f"{form}")
            np.testing.assert_allclose(array(data, "intensity"), i, rtol=1e-15)
            new = form >= 6
            for name, value in {
                "return_number": 3 if new else 1, "number_of_returns": 5 if new else 2, "classification": 11 if new else 2,
                "classification_flags": 2 if new else 1, "user_data": 9, "point_source_id": 4,
            }.items():
                self.assertEqual(set(array(data, name)), {value}, (form, name))
            np.testing.assert_allclose(array(data, "scan_angle"), 30 if new else -30, rtol=1e-12)
            self.assertEqual("timestamp" in names(data), form in (1, 3, 6, 7, 8))
            if "timestamp" in names(data):
                np.testing.assert_allclose(array(data, "timestamp"), 0.5e6 * i)
                self.assertEqual(unit(data, "timestamp"), "us")
            self.assertEqual("rgb" in names(data), form in (2, 3, 7, 8))
            if "rgb" in names(data):
                np.testing.assert_array_equal(array(data, "rgb"), np.column_stack([i, i * 0 + 2, i * 0 + 255]))
            self.assertEqual("near_infrared" in names(data), form == 8)

    def test_las_extra_bytes(self):
        described = [extra(b"a", 9, description=b"of something [m/s]"), extra(b"skipped", 0, options=3),
                     extra(b"b", 3, options=24, scale=(0.5, 1, 1), offset=(10, 0, 0)), extra(b"three", 22),
                     extra(b"energy", 10), extra(b"beyond", 10)]
        behind = struct.pack("<f3sH3bd", 1.5, b"???", 4, 1, -2, 3, 2.5)
        las(6, records=[vlr(b"LASF_Spec", 4, b"".join(described)), vlr(b"LASF_Spec", 3, b"free words\0"),
                        vlr(b"somebody", 4, b"else")], behind=behind)
        data = read(FILE)
        self.assertEqual(set(array(data, "a")), {1.5})
        self.assertEqual(unit(data, "a"), "m/s")
        self.assertEqual(set(array(data, "b")), {12.0})
        np.testing.assert_array_equal(array(data, "three"), [[1, -2, 3]] * 5)
        self.assertEqual(array(data, "three").dtype, np.int8)
        self.assertEqual(set(array(data, "file_energy")), {2.5})  # of what unit?
        for name in ("skipped", "beyond"):
            self.assertNotIn(name, names(data))
        self.assertEqual(field(data, "description"), ["free words"])

    def test_las_record_behind_the_points(self):
        wkt = b'PROJCS["somewhere"]\0'
        las(6, tail=struct.pack("<H16sHQ32s", 0, b"LASF_Projection", 2112, len(wkt), b"") + wkt)
        data = read(FILE)
        self.assertEqual(field(data, "crs_wkt"), ['PROJCS["somewhere"]'])
        self.assertFalse(data.GetFieldData().HasArray("utm_zone"))

    def test_las_errors(self):
        las(6)
        with open(FILE, "rb") as file:
            whole = file.read()
        for cut, words in ((0, "no LAS file"), (3, "no LAS file"), (226, "no LAS file"), (len(whole) - 1, "cut short")):
            with open(FILE, "wb") as file:
                file.write(whole[:cut])
            self.assertIn(words, read_error(FILE), cut)
        tail = struct.pack("<H16sHQ32s", 0, b"x", 1, 2**63, b"")
        for words, changes in [
            ("version is 2.4", {"patch": {24: ("<B", 2)}}),
            ("version is 1.5", {"patch": {25: ("<B", 5)}}),
            ("record format is 5", {"patch": {104: ("<B", 5)}}),
            ("have 29 bytes", {"patch": {105: ("<H", 29)}}),
            ("cut short", {"patch": {247: ("<Q", 6)}}),
            ("cut short", {"patch": {247: ("<Q", 2**63)}}),
            ("cut short", {"patch": {96: ("<I", 2**32 - 1)}}),
            ("not finite", {"patch": {131: ("<d", float("nan"))}}),
            ("not finite", {"patch": {163: ("<d", float("inf"))}}),
            ("ends before", {"patch": {100: ("<I", 2**32 - 1)}}),
            ("ends before", {"records": [vlr(b"x", 1, b"")[:-34] + struct.pack("<H", 65535) + b"\0" * 32]}),
            ("longer than the file", {"tail": tail}),
        ]:
            las(6, **changes)
            self.assertIn(words, read_error(FILE), changes)

    def test_files_that_cannot_be_read(self):
        self.assertIn("No such file", read_error("TestPointCloudReader-none.las"))
        with open("TestPointCloudReader.txt", "w", encoding="ascii") as file:
            file.write("1 2 3\n")
        self.assertIn("does not end with", read_error("TestPointCloudReader.txt"))
        os.remove("TestPointCloudReader.txt")
        os.makedirs("TestPointCloudReader-folder.las", exist_ok=True)
        self.assertIn("folder", read_error("TestPointCloudReader-folder.las"))
        os.rmdir("TestPointCloudReader-folder.las")
        reader = al.vtkAvianLidarPointCloudReader()
        heard = Messages(reader)
        reader.Update()
        self.assertIn("FileName is not set", heard.errors[0])

    def test_can_read_file(self):
        can = al.vtkAvianLidarPointCloudReader.CanReadFile
        las(6)
        self.assertEqual(can(FILE), 1)
        os.rename(FILE, "TestPointCloudReader.LAS")
        self.assertEqual(can("TestPointCloudReader.LAS"), 1)
        os.rename("TestPointCloudReader.LAS", "TestPointCloudReader.pcd")
        self.assertEqual(can("TestPointCloudReader.pcd"), 0)
        os.rename("TestPointCloudReader.pcd", "TestPointCloudReader.bin")
        self.assertEqual(can("TestPointCloudReader.bin"), int(os.path.getsize("TestPointCloudReader.bin") % 16 == 0))
        os.remove("TestPointCloudReader.bin")
        for name in ("TestPointCloudReader.bin", "", None, ".", "x.vtp"):
            self.assertEqual(can(name), 0, name)

    def test_origin_that_is_no_place(self):
        data = cloud([[1, 2, 3]])
        add_field(data, "geodetic_origin", (31.0, 121.0, 3.0))
        writer = al.vtkAvianLidarLASWriter()
        write(writer, data, FILE)
        with open(FILE, "rb") as file:
            whole = file.read()
        with open(FILE, "wb") as file:
            file.write(whole.replace(b"[31.0,121.0,3.0]", b"[99.0,121.0,3.0]"))
        self.assertIn("no place on the Earth", read_error(FILE))

    def test_pieces(self):
        las(6)
        reader = al.vtkAvianLidarPointCloudReader()
        reader.SetFileName(FILE)
        found = []
        for piece in range(3):
            reader.UpdatePiece(piece, 3, 0)
            found.append(reader.GetOutput().GetNumberOfPoints())
        self.assertEqual(found, [5, 0, 0])

    def test_moving_points_leaves_no_wrong_system(self):
        write(al.vtkAvianLidarLASWriter(), echoes(), FILE)
        away = read(FILE, LocalCoordinates=False)
        transform = al.vtkAvianLidarGeodeticTransform()
        transform.SetInputData(away)
        transform.SetSourceFrameToUTM()
        transform.SetTargetFrameToENU()
        transform.UseFieldDataOriginOff()
        transform.SetOrigin(31.1979, 121.3363, 3.0)
        transform.Update()
        self.assertTrue(transform.GetOutput().GetFieldData().HasArray("crs_wkt"))  # they have not moved
        transform.MovePointsOn()
        transform.Update()
        self.assertFalse(transform.GetOutput().GetFieldData().HasArray("crs_wkt"))
        self.assertTrue(away.GetFieldData().HasArray("crs_wkt"))
        np.testing.assert_allclose(points(transform.GetOutput()), points(echoes()), rtol=0, atol=1e-6)

    def assert_compared(self, real):
        """A cloud through the comparison with itself, moved."""
        moved = vtk.vtkTransform()
        moved.Translate(0, 0, 0.001)
        other = vtk.vtkTransformPolyDataFilter()
        other.SetTransform(moved)
        other.SetInputData(real)
        comparison = al.vtkAvianLidarCloudComparison()
        comparison.SetInputData(0, real)
        comparison.SetInputConnection(1, other.GetOutputPort())
        comparison.Update()
        self.assertAlmostEqual(comparison.GetHausdorffDistance(), 0.001, 9)

    def assert_coloured(self, real, energy, limits):
        """A cloud through the colours."""
        colours = al.vtkAvianLidarHSBColorMap()
        colours.SetInputData(real)
        colours.SetInputArrayToProcess(0, 0, 0, 0, energy)
        if limits:
            colours.UseFieldDataRangeOff()
            colours.SetEnergyRange(*limits)
        colours.Update()
        hue = array(colours.GetOutput(), "hue")
        self.assertGreaterEqual(hue.min(), 0)
        self.assertLessEqual(hue.max(), 240)
        self.assertGreater(np.ptp(hue), 50)

    def test_a_cloud_that_was_written_is_as_good_as_the_echoes(self):
        data = echoes()
        for writer, name in ((al.vtkAvianLidarLASWriter(), FILE), (al.vtkAvianLidarPCDWriter(), "TestPointCloudReader.pcd")):
            write(writer, data, name)
            again = read(name)
            self.assert_compared(again)
            self.assert_coloured(again, "energy", None)  # the limits came along as field data
            if name != FILE:
                os.remove(name)

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is empty")
    def test_real_frames(self):
        frames = {
            "lidar_room/pandar64": 179121, "lidar_room/pandar40p": 108663, "lidar_room/xt32": 121648,
            "lidar_room/qt64": 74842, "lidar_outdoor/helios16p_frame0": 15258, "lidar_outdoor/helios16p_frame1": 15795,
            "lidar_outdoor/xt16": 26287, "lidar_vlp16_mrpt/vlp16": 22591, "lidar_ouster/os0_32": 21631,
            "lidar_ouster/os1_32": 27310, "lidar_ouster/os2_32": 28541,
        }
        listed = {f"{folder}/{name[:-4]}" for folder in os.listdir(DATA) if folder.startswith("lidar_")
                  for name in os.listdir(os.path.join(DATA, folder)) if name.endswith(".pcd")}
        self.assertEqual(set(frames), listed)
        for frame, count in frames.items():
            name = os.path.join(DATA, frame + ".pcd")
            self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(name), 1)
            data = read(name)
            self.assertEqual(data.GetNumberOfPoints(), count, frame)
            for needed, its in (("laser_id", None), ("distance_m", "m"), ("azimuth", "0.01 deg"), ("vertical_angle", "deg")):
                self.assertEqual(unit(data, needed), its, (frame, needed))
            if "file_azimuth" in names(data) and "helios" in frame:
                # Hundredths of a degree here; the sensor's optical centre is not its axis, so far points only.
                far = array(data, "distance_m") > 20
                turn = array(data, "azimuth")[far] - array(data, "file_azimuth")[far]
                turn = (turn - np.median(turn) + 18000) % 36000 - 18000
                self.assertLess(np.percentile(np.abs(turn), 95), 20)
            bright = "intensity" if "intensity" in names(data) else "signal"
            self.assert_coloured(data, bright, (0.0, 255.0))
            if "vlp16" in frame:
                self.assert_compared(data)

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is empty")
    def test_a_real_scan_through_las(self):
        first = read(os.path.join(DATA, "lidar_vlp16_mrpt", "vlp16.pcd"))
        write(al.vtkAvianLidarLASWriter(), first, FILE, CoordinateSystem=2)
        again = read(FILE)
        comparison = al.vtkAvianLidarCloudComparison()
        comparison.SetInputData(0, first)
        comparison.SetInputData(1, again)
        comparison.Update()
        self.assertLess(comparison.GetHausdorffDistance(), 1e-6)
        np.testing.assert_allclose(array(again, "intensity"), array(first, "intensity"), rtol=1e-14)
        np.testing.assert_array_equal(array(again, "laser_id"), array(first, "laser_id"))


if __name__ == "__main__":
    unittest.main()
