# SPDX-License-Identifier: BSD-3-Clause
"""PLY files of every kind, made by hand, and every way in which they can be wrong; what is written is read by VTK, by
the Point Cloud Library's programs and by NumPy."""

import json
import os
import pathlib
import subprocess

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray
from vtkmodules.vtkIOPLY import vtkPLYReader

import avianlidar
from avianlidar import vtkAvianLidar as al
from cloudtools import (add_array, assert_extremes, assert_refused, cloud, echoes, extremes, field, names, points, read,
                        read_error, write)
from echotools import InFolder, array, given, output

FILE, OTHER = "TestPLY.ply", "TestPLY.pcd"
TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
         "double": "f8"}
VERTEX = "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
LINES = b"1 2 3\n4 5 6\n"


def put(data=LINES, elements=VERTEX, form="ascii"):
    pathlib.Path(FILE).write_bytes(f"ply\nformat {form} 1.0\n{elements}end_header\n".encode("ascii") + data)


def parse(name):
    """Comments, and vertices as a structured array, of a binary file that has nothing else, read by NumPy."""
    head, data = pathlib.Path(name).read_bytes().split(b"end_header\n", 1)
    lines = head.decode("ascii").splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"], lines
    record = np.dtype([(words[2], "<" + TYPES[words[1]]) for words in map(str.split, lines) if words[0] == "property"])
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex "))
    assert len(data) == count * record.itemsize
    return [line[8:] for line in lines if line.startswith("comment ")], np.frombuffer(data, record)


class Reader(InFolder):
    def test_every_type_in_every_form(self):
        other = {"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
                 "float32": "f4", "float64": "f8"}
        kinds = {f"v_{name}": (name, kind) for name, kind in {**TYPES, **other}.items()}
        elements = "element vertex 3\n" + "".join(f"property float {axis}\n" for axis in "xyz")
        elements += "".join(f"property {word} {name}\n" for name, (word, _) in kinds.items())
        kinds = {name: kind for name, (_, kind) in kinds.items()}
        for order, form in (("<", "binary_little_endian"), (">", "binary_big_endian"), ("", "ascii")):
            rows, text = extremes(kinds, order)
            put(rows.tobytes() if order else text, elements, form)
            assert_extremes(read(FILE), rows, kinds)

    def test_other_elements_are_passed_over(self):
        before = ("element camera 2\nproperty float f\nproperty short s\nelement strip 2\nproperty list uchar int v\n"
                  "property int w\n")
        after = "element face 1\nproperty list uchar int vertex_indices\n"
        put(b"1.5 2\n2.5 3\n2 7 8 9\n0 1\n" + LINES + b"3 0 1 1\n", before + VERTEX + after)
        self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]])
        self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 0)  # a mesh is another reader's
        put(elements=VERTEX + after.replace("1", "0"))
        self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 1)  # a file without faces is a cloud
        for order, form in (("<", "binary_little_endian"), (">", "binary_big_endian")):
            data = np.array([(1.5, 2), (2.5, 3)], dtype=[("f", order + "f4"), ("s", order + "i2")]).tobytes()
            data += b"\2" + np.array([7, 8, 9], order + "i4").tobytes() + b"\0" + np.array([1], order + "i4").tobytes()
            put(data + np.array([1, 2, 3, 4, 5, 6], order + "f4").tobytes() + b"\3", before + VERTEX + after, form)
            self.assertEqual(points(read(FILE)).tolist(), [[1, 2, 3], [4, 5, 6]])
            put(data, before + VERTEX.replace("2", "0", 1), form)
            self.assertEqual(read(FILE).GetNumberOfPoints(), 0)

    def test_names_colours_and_holes(self):
        properties = "".join(f"property {name}\n" for name in (
            "uchar red", "uchar green", "uchar blue", "ushort ring", "float azimuth"))
        put(b"0 1 0 9 8 7 6 5\nnan 0 0 1 1 1 1 1\n", f"comment by hand\nobj_info of nothing\n{VERTEX}{properties}")
        data = read(FILE, said=["1 points whose coordinates are not finite are left out"])
        self.assertEqual(data.GetNumberOfPoints(), 1)
        self.assertEqual(set(names(data)), {"rgb", "laser_id", "file_azimuth"})
        self.assertEqual(array(data, "rgb").tolist(), [[9, 8, 7]])
        self.assertEqual(field(data, "comment"), ["by hand", "of nothing"])
        put(b"0 1 0 9 8\n0 0 0 1 1\n", f"{VERTEX}property uchar red\nproperty float green\n")
        self.assertEqual(set(names(read(FILE))), {"red", "green"})
        put(LINES.replace(b"\n", b"\r\n"), VERTEX.replace("\n", "\r\n"), "ascii 1.0\r")
        self.assertEqual(read(FILE).GetNumberOfPoints(), 2)

    def test_errors(self):
        lists = "element strip 9\nproperty list uint int v\n"
        little = "binary_little_endian"
        for words, *arguments in (
            ("cut short: it says that it has 2 points, and has 1", b"1 2 3\n      \n"),
            ("point 1 has too few values", b"1 2 3\n4 5    \n"),
            ("cut short", b"\0" * 23, VERTEX, little),
            ("cut short", LINES, VERTEX.replace("2", "18446744073709551615", 1), "binary_big_endian"),
            ('format is "zip"', LINES, VERTEX, "zip"),
            ("no element vertex", LINES, VERTEX.replace("vertex", "point")),
            ("no fields x, y and z", LINES, VERTEX.replace("z", "w")),
            ("vertices have the list v, expected one number", LINES, VERTEX + "property list uchar int v\n"),
            ('has the type "long"', LINES, VERTEX + "property long n\n"),
            ("count of type float", LINES, VERTEX + "property list float int v\n"),
            ('has the line "property int n"', LINES, "property int n\n" + VERTEX),
            ("up to 4096 properties", LINES, VERTEX + "property int n\n" * 4094),
            ("its element strip has no end", b"\0\0", lists + VERTEX, little),
            ("a line is longer than 16 MiB", b"1" * (2**24 + 2**17)),
        ):
            put(*arguments)
            with self.subTest(words):
                self.assertIn(words, read_error(FILE))
        for whole, words in ((b"", "does not begin with"), (b"plyx\n", "does not begin with"),
                             (b"ply\nformat ascii 1.0\n", "no line end_header")):
            pathlib.Path(FILE).write_bytes(whole)
            self.assertIn(words, read_error(FILE))
            self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 0)


class Written(InFolder):
    def setUp(self):
        super().setUp()
        self.data = echoes()
        self.writer = al.vtkAvianLidarPLYWriter()

    def test_other_programs_read_it(self):
        add_array(self.data, "rgb",
                  np.random.default_rng(1).integers(0, 256, (self.data.GetNumberOfPoints(), 3)).astype("u1"))
        self.assertEqual(write(self.writer, self.data, FILE), [])
        comments, got = parse(FILE)
        self.assertLess(max(map(len, comments)), 1000)  # RPly takes no longer ones
        self.assertEqual({comment[0] for comment in comments[1:]}, {"+"})
        self.assertIn("avian_lidar", json.loads(comments[0] + "".join(comment[1:] for comment in comments[1:])))
        for axis in range(3):
            np.testing.assert_array_equal(got["xyz"[axis]], points(self.data)[:, axis].astype("f4"))
        for name in set(names(self.data)) - {"rgb", "intensity"}:
            np.testing.assert_array_equal(got[name], array(self.data, name), name)
        by_vtk = output(given(vtkPLYReader(), FileName=FILE))
        np.testing.assert_array_equal(points(by_vtk), points(self.data).astype("f4"))
        np.testing.assert_array_equal(array(by_vtk, "RGB"), array(self.data, "rgb"))
        subprocess.run(["pcl_ply2pcd", FILE, OTHER], check=True, capture_output=True)
        through = read(OTHER)
        np.testing.assert_array_equal(points(through), points(self.data).astype("f4"))
        np.testing.assert_array_equal(array(through, "laser_id"), array(self.data, "laser_id"))

    def test_a_mesh(self):
        mesh = avianlidar.mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
        add_array(mesh, "two numbers", np.array([(1, 2), (3, 4), (5, 6), (7, 8)], dtype="i2"))
        for kind in (0, 1):
            self.assertEqual(write(self.writer, mesh, FILE, FileType=kind), [])
            by_vtk = output(given(vtkPLYReader(), FileName=FILE))
            np.testing.assert_array_equal(points(by_vtk), points(mesh))
            cells = by_vtk.GetPolys().GetConnectivityArray()
            np.testing.assert_array_equal(vtk_to_numpy(cells), (0, 1, 2, 0, 2, 3))
            self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 0)
            np.testing.assert_array_equal(array(read(FILE), "two_numbers_1"), (2, 4, 6, 8))
        os.remove(FILE)
        large = avianlidar.mesh(np.random.default_rng(1).normal(size=(300, 3)), [(0, 1, 2)])
        large.GetPolys().InsertNextCell(256, range(256))
        assert_refused(self, self.writer, large, FILE, "polygon 1 has 256 points, expected at most 255")
        strip = cloud(np.eye(3))
        strip.SetStrips(vtkCellArray())
        strip.GetStrips().InsertNextCell(3, (0, 1, 2))
        assert_refused(self, self.writer, strip, FILE, "triangle strips, expected polygons")

    def test_names_that_collide(self):
        data = cloud([(1, 2, 3)])
        add_array(data, "a b", np.array([1.0]))
        add_array(data, "a_b", np.array([2.0]))
        (said,) = write(self.writer, data, FILE)
        self.assertIn("is without the point arrays 'a_b'", said)
        os.remove(FILE)
        add_array(data, "red", np.array([2.0]))
        add_array(data, "rgb", np.array([[1, 2, 3]], dtype="u1"))
        (said,) = write(self.writer, data, FILE)
        self.assertIn("is without the point arrays 'a_b', 'rgb'", said)
