# SPDX-License-Identifier: BSD-3-Clause
"""Every array through every format that keeps arrays; LAS of all formats made by hand; wrong files; real frames."""

import os
import pathlib
import struct
import unittest

import numpy as np

import avianlidar
from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, cloud, echoes, field, names, points, read, read_error, unit, write
from echotools import InFolder, Messages, array, given, output
from helpertools import WALL

FILE = "TestPointCloudReader.las"
# Writer, suffix, settings, types that change, and relative and absolute rounding: LAS has intensities of 16 bits,
# returns in a byte and time in seconds; the others have intensities as floats and whole numbers of 64 bits as doubles.
FLOATS = {"i8": "f8", "u8": "f8", "intensity": "f4"}, {"intensity": (6e-8, 0)}
BYTES = {"return_number": "u1", "number_of_returns": "u1"}, {"intensity": (0, 0.5 / 257), "timestamp": (1e-15, 0)}
FORMATS = [(al.vtkAvianLidarLASWriter, ".las", {"CoordinateSystem": system}, *BYTES) for system in (0, 1, 2)] + [
    (writer, suffix, {"FileType": kind, "Precision": 1}, *FLOATS)
    for writer, suffix in ((al.vtkAvianLidarPCDWriter, ".pcd"), (al.vtkAvianLidarPLYWriter, ".ply")) for kind in (0, 1)]
CORE = {0: 20, 1: 28, 2: 26, 3: 34, 4: 57, 5: 63, 6: 30, 7: 36, 8: 38, 9: 59, 10: 67}
DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")


def vlr(user, record, content):
    return struct.pack("<H16sHH32s", 0, user, record, len(content), b"") + content


def extra(name, kind, options=0, scale=(1, 1, 1), offset=(0, 0, 0), description=b""):
    return struct.pack("<HBB32sI24s24s24s3d3d32s", 0, kind, options, name, 0, b"", b"", b"", *scale, *offset,
                       description)


def point(form, i, colour=None):
    """A record of that format: (100 + i, 200, -i) in steps of 0.01 m."""
    position = struct.pack("<3iH", 10000 + 100 * i, 20000, -100 * i, 257 * i)
    time, rgb = struct.pack("<d", 0.5 * i), struct.pack("<3H", *(colour or (256 * i, 512, 65535)))
    nir = struct.pack("<H", 7)
    wave = bytes(range(29))
    if form < 6:
        core = position + struct.pack("<BBbBH", 1 | 2 << 3, 2 | 1 << 5, -30, 9, 4)
    else:
        core = position + struct.pack("<BBBBhHd", 3 | 5 << 4, 2, 11, 9, 5000, 4, 0.5 * i)
    rest = {0: b"", 1: time, 2: rgb, 3: time + rgb, 4: time + wave, 5: time + rgb + wave, 6: b"", 7: rgb, 8: rgb + nir,
            9: wave, 10: rgb + nir + wave}[form]
    assert len(core + rest) == CORE[form]
    return core + rest


def las(form, n=5, minor=None, records=(), behind=b"", tail=b"", length=None, colour=None, **patch):
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
    pathlib.Path(FILE).write_bytes(bytes(header) + vlrs + b"".join(point(form, i, colour) + behind for i in range(n))
                                   + tail)


class TestPointCloudReader(InFolder):
    def test_every_array_through_every_format(self):
        data = echoes()
        n, draw = data.GetNumberOfPoints(), np.random.default_rng(3)
        for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"):
            add_array(data, "of_" + kind, draw.integers(0, 100, n).astype(kind), "m")
        add_array(data, "rgb", draw.integers(0, 256, (n, 3)).astype("u1"), "1")
        for kind, suffix, settings, kept, rounding in FORMATS:
            with self.subTest(suffix, **settings):
                writer, name = kind(), FILE.replace(".las", suffix)
                self.assertEqual(write(writer, data, name, **settings), [])
                again = read(name)
                # Turned into another frame, a corner of the box of rounding shows: sqrt(3) as far.
                bound = 1.8 * writer.GetRoundingBound() if suffix == ".las" else 0
                np.testing.assert_allclose(points(again), points(data), rtol=0, atol=bound)
                for one in names(data):
                    wanted, found = array(data, one), array(again, one)
                    relative, absolute = rounding.get(one, (0, 0))
                    np.testing.assert_allclose(found, wanted, rtol=relative, atol=absolute, err_msg=one)
                    self.assertEqual(found.dtype.str[1:],
                                     kept.get(one, kept.get(wanted.dtype.str[1:], wanted.dtype.str[1:])), one)
                    self.assertEqual(unit(again, one), unit(data, one), one)
                for one in ("position", "orientation", "lower_energy_limit", "geodetic_origin", "object_names",
                            "object_classes"):
                    self.assertEqual(field(again, one), field(data, one), one)

    def test_quantities_without_a_unit_are_the_files(self):
        """All that echoes of a photon receiver in daylight have."""
        echoes = avianlidar.Scan(avianlidar.Scene(WALL),
                                 avianlidar.Sensor("Search905", azimuth_step=2, sunlight=1)).echoes
        quantities = [name for name, unit in echoes.units.items() if unit not in ("", "1")]
        self.assertGreater(set(quantities), {"distance_std_error", "energy", "seen_radiance"})
        properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", *quantities))
        pathlib.Path("a.ply").write_text(
            f"ply\nformat ascii 1.0\nelement vertex 1\n{properties}end_header\n{'1 ' * (3 + len(quantities))}\n")
        self.assertEqual(names(read("a.ply")), ["file_" + name for name in quantities])

    def test_las_formats(self):
        for form, minor in [(0, 0), (1, 1), (2, 2), (3, 4), (6, 4), (7, 4), (8, 4), (4, 3), (5, 4), (9, 4), (10, 4)]:
            las(form, minor=minor)
            data = read(FILE)
            i = np.arange(5)
            # offset + 0.01 m * n
            expected = np.column_stack([1100 + i, np.full(5, 2200.0), -i])
            np.testing.assert_allclose(points(data), expected, rtol=1e-15, err_msg=f"{form}")
            np.testing.assert_allclose(array(data, "intensity"), i, rtol=1e-15)
            new = form >= 6
            found = {name: set(array(data, name))
                     for name in ("return_number", "number_of_returns", "classification", "classification_flags",
                                  "user_data", "point_source_id")}
            self.assertEqual(list(found.values()),
                             [{value} for value in ((3, 5, 11, 2, 9, 4) if new else (1, 2, 2, 1, 9, 4))], form)
            np.testing.assert_allclose(array(data, "scan_angle"), 30 if new else -30, rtol=1e-12)
            there = {name: name in names(data) for name in ("timestamp", "rgb", "near_infrared")}
            self.assertEqual(there, {"timestamp": form not in (0, 2), "rgb": form in (2, 3, 5, 7, 8, 10),
                                     "near_infrared": form in (8, 10)})
            if there["timestamp"]:
                np.testing.assert_allclose(array(data, "timestamp"), 0.5e6 * i)
                self.assertEqual(unit(data, "timestamp"), "us")
            if there["rgb"]:
                np.testing.assert_array_equal(array(data, "rgb"), np.column_stack([i, i * 0 + 2, i * 0 + 255]))

    def test_las_withheld_points(self):
        """Points that are flagged as deleted are left out and counted; the other flags stay: synthetic, key-point,
        overlap."""
        for form, length in CORE.items():
            for minor in (4,) if form >= 6 else (0, 1, 2, 3, 4):
                las(form, n=16, minor=minor)
                whole = bytearray(pathlib.Path(FILE).read_bytes())
                for flags, count in ((range(16), 8), ([4] * 16, 16), ([3] * 15 + [6], 1)):
                    for i, flag in enumerate(flags):
                        at = len(whole) - (16 - i) * length + 15
                        whole[at] = flag if form >= 6 else (flag & 7) << 5 | 3
                    pathlib.Path(FILE).write_bytes(whole)
                    data = read(FILE, said=[f"{count} point{'s that are' if count > 1 else ' that is'} flagged as "
                                            "withheld"])
                    kept = [(i, flag & (15 if form >= 6 else 7)) for i, flag in enumerate(flags) if not flag & 4]
                    self.assertEqual(array(data, "classification_flags").tolist(), [flag for _, flag in kept],
                                     (form, minor))
                    np.testing.assert_allclose(points(data),
                                               np.array([(1100 + i, 2200, -i) for i, _ in kept]).reshape(-1, 3))
                    self.assertEqual({array(data, name).shape[0] for name in names(data)}, {len(kept)})

    def test_las_colours(self):
        """Colours of 8 bits in fields of 16 stay as they are, unless a channel of the file is above 255."""
        for colour, wanted in (((0, 255, 1), (0, 255, 1)), ((0, 256, 255), (0, 1, 0)),
                               ((51400, 25700, 12850), (200, 100, 50))):
            las(3, colour=colour)
            self.assertEqual(array(read(FILE), "rgb").tolist(), [list(wanted)] * 5)

    def test_las_numbers_of_points(self):
        """A file of 1.4 may have the number of older versions alone, or its own alone."""
        for form, patch, said, count in ((3, {247: ("<Q", 0)}, "", 5), (3, {107: ("<I", 0)}, "", 5),
                                         (6, {247: ("<Q", 0)}, "it has no points, though 150 bytes follow", 0),
                                         (6, {247: ("<Q", 3)}, "it has 3 points, though 60 bytes follow", 3)):
            las(form, minor=4, patch=patch)
            self.assertEqual(read(FILE, said=[said] if said else []).GetNumberOfPoints(), count)

    def test_las_systems_in_keys_of_geotiff(self):
        def keys(*entries):
            return vlr(b"LASF_Projection", 34735, struct.pack("<4H", 1, 1, 0, len(entries))
                       + b"".join(struct.pack("<4H", *entry) for entry in entries))
        model, utm = (1024, 0, 1, 1), (3072, 0, 1, 32633)
        for records, said, words, zone in (
                ([keys(utm)], [], ["PROJCS", "zone 33N", "32633"], 33),
                ([keys(model, (3072, 0, 1, 32733))], [], ["zone 33S"], -33),
                ([keys(model, (3072, 0, 1, 26910), (4096, 0, 1, 5703), (4099, 0, 1, 9001))], [], ["COMPD_CS", "NAVD88"],
                 0), ([keys((1024, 0, 1, 2), (2048, 0, 1, 4326))], ["in degree"], ["GEOGCS", "4326"], 0),
                ([keys(model, (3072, 0, 1, 26910), (4096, 0, 1, 6360), (4099, 0, 1, 9003))],
                 ["in metre and US survey foot"], ["zone 10N"], 0),
                ([vlr(b"LASF_Projection", 34735, b"\1\0\1\0")], ["cannot read the coordinate system"], [], 0),
                ([keys(utm), vlr(b"LASF_Projection", 2112, b"\0")], [], ["zone 33N"], 33)):
            with self.subTest(words):
                las(3, records=records)
                data = read(FILE, said=said)
                fields = data.GetFieldData()
                system = field(data, "crs_wkt")[0] if fields.HasArray("crs_wkt") else ""
                self.assertTrue(bool(system) == bool(words) and all(word in system for word in words), system)
                self.assertEqual(field(data, "utm_zone") if fields.HasArray("utm_zone") else [], [zone] if zone else [])
        both = [keys(utm), vlr(b"LASF_Projection", 2112, b'LOCAL_CS["mine",UNIT["metre",1]]\0')]
        for flag, word in ((0, "zone 33N"), (16, "mine")):  # of the global encoding
            las(3, minor=4, records=both, patch={6: ("<H", flag)})
            self.assertIn(word, field(read(FILE), "crs_wkt")[0])

    def test_scans_of_other_data_sets(self):
        """Points of nuScenes are read, other numbers a point than four are an error, and intensities of 0 to 255 are
        taken as they are."""
        name = FILE.replace(".las", ".bin")
        draw = np.random.default_rng(7)
        places = draw.uniform(-50, 50, (1000, 3))
        ring, bright = draw.integers(0, 32, (1000, 1)), draw.integers(0, 256, (1000, 1))
        turned = np.linspace(0, np.pi / 2, 1000)[:, None]  # a scan about a corner: no coordinate below zero
        corner = np.hstack([30 * np.cos(turned), 20 * np.sin(turned), 2 + turned, 0.5 + 0 * turned, turned, turned])
        for count in (1000, 999):  # the first number of bytes would fit four float32 a point, too
            np.hstack([places, bright, ring])[:count].astype("<f4").tofile(name)
            data = read(name)
            np.testing.assert_array_equal(points(data), places[:count].astype("<f4"))
            np.testing.assert_array_equal(array(data, "intensity"), bright[:count, 0])
            np.testing.assert_array_equal(array(data, "laser_id"), ring[:count, 0])
        for rows, words in (([places[:999], bright[:999], ring[:999] + 0.5], "expected a multiple of 16, four float32"),
                            ([places, bright, ring, ring], "the fourth numbers of its points go from -"),
                            ([places, 300 + bright], "go from 0 to 55"),
                            *(([corner[:, :count]], f"it seems to have {count} float32 a point")
                              for count in (3, 5, 6))):
            np.hstack(rows).astype("<f4").tofile(name)
            self.assertIn(words, read_error(name))
        corner[:, :4].astype("<f4").tofile(name)
        self.assertEqual(read(name).GetNumberOfPoints(), 1000)
        np.hstack([places, bright]).astype("<f4").tofile(name)
        np.testing.assert_array_equal(array(read(name, said=["are taken for intensities of 0 to 255"]), "intensity"),
                                      bright[:, 0])
        rows = np.hstack([places, bright / 255]).astype("<f4")
        rows[5, 1] = rows[6] = np.nan
        rows.tofile(name)
        data = read(name, said=["2 points whose coordinates are not finite are left out"])
        np.testing.assert_allclose(array(data, "intensity"), np.delete(bright[:, 0], [5, 6]), rtol=1e-6)

    def test_las_extra_bytes(self):
        described = [extra(b"a", 9, description=b"of something [m/s]"), extra(b"skipped", 0, options=3),
                     extra(b"b", 3, options=24, scale=(0.5, 1, 1), offset=(10, 0, 0)), extra(b"three", 22),
                     extra(b"energy", 10), extra(b"beyond", 10)]
        behind = struct.pack("<f3sH3bd", 1.5, b"???", 4, 1, -2, 3, 2.5)
        wkt = b'PROJCS["somewhere"]\0'
        las(6, records=[vlr(b"LASF_Spec", 4, b"".join(described)), vlr(b"LASF_Spec", 3, b"free words\0"),
                        vlr(b"somebody", 4, b"else")], behind=behind,
            tail=struct.pack("<H16sHQ32s", 0, b"LASF_Projection", 2112, len(wkt), b"") + wkt)
        data = read(FILE)
        for name, value in {"a": 1.5, "b": 12.0, "file_energy": 2.5}.items():  # the last: of what unit?
            self.assertEqual(set(array(data, name)), {value}, name)
        self.assertEqual((unit(data, "a"), array(data, "three").dtype), ("m/s", np.int8))
        np.testing.assert_array_equal(array(data, "three"), [[1, -2, 3]] * 5)
        self.assertFalse({"skipped", "beyond"} & set(names(data)))
        self.assertEqual((field(data, "description"), field(data, "crs_wkt")),
                         (["free words"], ['PROJCS["somewhere"]']))

    def test_las_errors(self):
        las(6)
        whole = pathlib.Path(FILE).read_bytes()
        for cut, words in ((0, "not a LAS file"), (226, "not a LAS file"), (len(whole) - 1, "cut short")):
            pathlib.Path(FILE).write_bytes(whole[:cut])
            self.assertIn(words, read_error(FILE), cut)
        tail = struct.pack("<H16sHQ32s", 0, b"x", 1, 2**63, b"")
        for words, changes in [
                ("version is 2.4", {"patch": {24: ("<B", 2)}}), ("record format is 11", {"patch": {104: ("<B", 11)}}),
                ("cut short", {"patch": {247: ("<Q", 2**63)}}),
                ("waveforms (point data record format 4), which are read from LAS, not from LAZ",
                 {"patch": {104: ("<B", 0x84), 105: ("<H", 57)}}),
                ("a scale of its coordinates is 0", {"patch": {147: ("<d", 0.0)}}),
                ("have 29 bytes", {"patch": {105: ("<H", 29)}}), ("not finite", {"patch": {163: ("<d", float("inf"))}}),
                ("ends before", {"records": [vlr(b"x", 1, b"")[:-34] + struct.pack("<H", 65535) + b"\0" * 32]}),
                ("longer than the file", {"tail": tail})]:
            las(6, **changes)
            self.assertIn(words, read_error(FILE), changes)

    def test_files_that_cannot_be_read(self):
        can = al.vtkAvianLidarPointCloudReader.CanReadFile
        stem = FILE[:-len(".las")]
        self.assertIn("No such file", read_error(stem + "-none.las"))
        self.assertIn("does not end with", read_error(os.path.abspath(__file__)))
        os.mkdir("folder.las")
        self.assertIn("folder", read_error("folder.las"))
        reader = al.vtkAvianLidarPointCloudReader()
        heard = Messages(reader)
        reader.Update()
        self.assertIn("FileName is not set", heard.errors[0])
        las(6)
        self.assertEqual(can(FILE), 1)
        os.rename(FILE, stem + ".pcd")
        self.assertEqual(can(stem + ".pcd"), 0)
        for name in (None, ".", stem + ".bin"):
            self.assertEqual(can(name), 0, name)

    def test_an_origin_that_is_not_on_the_earth(self):
        data = cloud([[1, 2, 3]])
        add_field(data, "geodetic_origin", (31.0, 121.0, 3.0))
        write(al.vtkAvianLidarLASWriter(), data, FILE)
        with open(FILE, "r+b") as file:
            whole = file.read()
            file.seek(0)
            file.write(whole.replace(b"[31.0,121.0,3.0]", b"[99.0,121.0,3.0]"))
        self.assertIn("not a place on the Earth", read_error(FILE))

    def test_moving_points_leaves_no_wrong_system(self):
        write(al.vtkAvianLidarLASWriter(), echoes(), FILE)
        away = read(FILE, LocalCoordinates=False)
        transform = given(al.vtkAvianLidarGeodeticTransform(), InputData=away, UseFieldDataOrigin=False,
                          Origin=(31.1979, 121.3363, 3.0))
        transform.SetSourceFrameToUTM()
        transform.SetTargetFrameToENU()
        for move in (False, True):
            transform.SetMovePoints(move)
            self.assertNotEqual(bool(output(transform).GetFieldData().HasArray("crs_wkt")), move)
        self.assertTrue(away.GetFieldData().HasArray("crs_wkt"))
        np.testing.assert_allclose(points(transform.GetOutput()), points(echoes()), rtol=0, atol=1e-6)

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is empty")
    def test_real_frames(self):
        for frame, count in {"lidar_room/qt64": 74842, "lidar_outdoor/helios16p_frame0": 15258,
                             "lidar_ouster/os0_32": 21631}.items():
            data = read(os.path.join(DATA, frame + ".pcd"))
            self.assertEqual(data.GetNumberOfPoints(), count, frame)
            for needed, its in (("laser_id", None), ("distance_m", "m"), ("azimuth", "0.01 deg"),
                                ("vertical_angle", "deg")):
                self.assertEqual(unit(data, needed), its, (frame, needed))
            if "helios" in frame:
                # Hundredths of a degree here; the sensor's optical centre is not its axis, so far points only.
                far = array(data, "distance_m") > 20
                turn = array(data, "azimuth")[far] - array(data, "file_azimuth")[far]
                turn = (turn - np.median(turn) + 18000) % 36000 - 18000
                self.assertLess(np.percentile(np.abs(turn), 95), 20)
