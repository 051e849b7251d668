# SPDX-License-Identifier: BSD-3-Clause
"""LAZ holds the bits that LAS holds, for us and for a program that is not ours (laspy); damaged files are errors; a
build without LASzip says so."""

import importlib.util
import os
import pathlib
import resource
import struct
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, assert_refused, cloud, names, points, read, read_error, write
from echotools import InFolder, array
from faulttools import limited

LASZIP = os.environ["AVIANLIDAR_LASZIP"] == "1"
LASPY = importlib.util.find_spec("laspy") and importlib.util.find_spec("laszip")
LAS, LAZ = "TestLaz.las", "TestLaz.laz"
CHUNK = 50000


def random_cloud(count, rgb):
    """Numbers that fill the fields of LAS, and extra bytes of every type."""
    draw = np.random.default_rng(count)
    data = cloud(draw.uniform(-500, 500, (count, 3)))
    add_field(data, "geodetic_origin", (31.0, 121.0, 3.0))
    for name, most, kind in (("return_number", 16, "u1"), ("number_of_returns", 16, "u1"),
                             ("classification", 256, "u1"), ("classification_flags", 16, "u1"),
                             ("user_data", 256, "u1"), ("point_source_id", 65536, "u2")):
        add_array(data, name, draw.integers(0, most, count).astype(kind))
    add_array(data, "intensity", draw.uniform(0, 255, count), "1")
    add_array(data, "scan_angle", draw.uniform(-180, 180, count), "deg")
    add_array(data, "timestamp", draw.uniform(0, 1e9, count), "us")
    if rgb:
        add_array(data, "rgb", draw.integers(0, 256, (count, 3)).astype("u1"))
    for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"):
        add_array(data, "an_" + kind, draw.integers(0, 100, count).astype(kind))
    return data


def bits(data):
    return {"points": points(data).tobytes(),
            **{name: (array(data, name).dtype, array(data, name).tobytes()) for name in names(data)}}


@unittest.skipUnless(LASZIP, "built without LASzip")
class TestLaz(InFolder):
    def test_the_same_as_las(self):
        """Of many points some are flagged as withheld: these are left out, with a warning."""
        for count in (0, 3, CHUNK + 1):
            for rgb in (False, True):
                for name in (LAS, LAZ):
                    write(al.vtkAvianLidarLASWriter(), random_cloud(count, rgb), name)
                said = ["flagged as withheld"] if count > CHUNK else []
                self.assertEqual(bits(read(LAZ, said)), bits(read(LAS, said)), (count, rgb))
        self.assertLess(os.path.getsize(LAZ), 0.8 * os.path.getsize(LAS))

    def assert_damaged(self, whole, words="damaged or cut short"):
        pathlib.Path(LAZ).write_bytes(whole)
        error = read_error(LAZ)
        self.assertIn(LAZ, error)
        self.assertRegex(error, words)

    def test_damaged_files(self):
        write(al.vtkAvianLidarLASWriter(), random_cloud(200, True), LAZ)
        whole = pathlib.Path(LAZ).read_bytes()
        data, length = struct.unpack_from("<I", whole, 96)[0], struct.unpack_from("<H", whole, 105)[0]
        record = whole.index(b"laszip encoded") - 2
        table = struct.unpack_from("<Q", whole, data)[0]
        layers = data + 8 + length + 4
        for cut in (0, 200, data, layers, table - 1, len(whole) - 1):
            self.assert_damaged(whole[:cut], "damaged or cut short|not a LAS file|ends before")
        # Behind the header numbers of the table of chunks, of layers and of the record that describes the packing.
        # (FuzzPointCloud has more.)
        for offset, kind, value in ((96, "<I", 2**32 - 1), (247, "<Q", 201), (247, "<Q", 199), (105, "<H", length - 1),
                                    (data, "<q", -1), (table, "<I", 1), (table + 4, "<I", 2**32 - 1),
                                    (layers - 4, "<I", 199), (layers, "<I", 2**32 - 1), (record + 2, "<B", 0),
                                    (record + 92, "<H", 9)):
            changed = bytearray(whole)
            struct.pack_into(kind, changed, offset, value)
            with self.subTest(offset=offset - data, value=value):
                self.assert_damaged(bytes(changed), "damaged or cut short|memory|ends before|cut short")

    def test_points_far_into_the_file(self):
        """LASzip holds what comes before them."""
        write(al.vtkAvianLidarLASWriter(), random_cloud(200, True), LAZ)
        whole = bytearray(pathlib.Path(LAZ).read_bytes())
        data, far = struct.unpack_from("<I", whole, 96)[0], 2**32 - 2**20
        table = struct.unpack_from("<Q", whole, data)[0]
        struct.pack_into("<I", whole, 96, far)
        struct.pack_into("<Q", whole, data, table + far - data)
        with open(LAZ, "wb") as file:
            file.write(whole[:data])
            file.seek(far)
            file.write(whole[data:])
        with limited(resource.RLIMIT_AS, 6 << 30):
            self.assertRegex(read_error(LAZ), "4,293,918,720 bytes before the points need about .* are available")

    @unittest.skipUnless(LASPY, "laspy is not installed")
    def test_laspy_reads_ours_and_we_its(self):
        import laspy
        for rgb in (False, True):
            for name in (LAS, LAZ):
                write(al.vtkAvianLidarLASWriter(), random_cloud(CHUNK + 1, rgb), name)
            las, laz = laspy.read(LAS), laspy.read(LAZ)
            self.assertEqual(laz.points.array.tobytes(), las.points.array.tobytes())
            self.assertEqual((laz.header.point_format.id, laz.header.point_count), (7 if rgb else 6, CHUNK + 1))
            np.testing.assert_array_equal(laz.header.maxs, las.header.maxs)
            self.assertEqual(laz.vlrs.get("WktCoordinateSystemVlr")[0].string,
                             las.vlrs.get("WktCoordinateSystemVlr")[0].string)
        draw = np.random.default_rng(4)
        for form in (0, 1, 2, 3, 6, 7, 8):
            header = laspy.LasHeader(point_format=form, version="1.4" if form > 5 else "1.2")
            header.add_extra_dims([laspy.ExtraBytesParams("a", "float32"), laspy.ExtraBytesParams("b", "uint8")])
            las = laspy.LasData(header, laspy.ScaleAwarePointRecord.zeros(CHUNK + 500, header=header))
            las.points.array.view("u1")[:] = draw.integers(0, 256, las.points.array.view("u1").shape)
            for name in (LAS, LAZ):
                las.write(name)
            self.assertEqual(bits(read(LAZ, ["withheld"])), bits(read(LAS, ["withheld"])), form)


@unittest.skipIf(LASZIP, "built with LASzip")
class TestWithout(InFolder):
    def test_reading_and_writing(self):
        words = f"{LAZ}: LAZ needs LASzip, which this build is without: install liblaszip-dev"
        assert_refused(self, al.vtkAvianLidarLASWriter(), random_cloud(1, False), LAZ, words)
        write(al.vtkAvianLidarLASWriter(), random_cloud(1, False), LAS)
        whole = bytearray(pathlib.Path(LAS).read_bytes())
        whole[104] |= 128
        for count in (1, 10**12):
            struct.pack_into("<Q", whole, 247, count)
            pathlib.Path(LAZ).write_bytes(whole)
            self.assertIn(words, read_error(LAZ))
