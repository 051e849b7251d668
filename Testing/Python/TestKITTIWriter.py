# SPDX-License-Identifier: BSD-3-Clause
"""KITTI scans read by the Mobile Robot Programming Toolkit, scans and SemanticKITTI's labels by NumPy as that data set's own
tools do, and by the reader."""

import os
import re
import shutil
import subprocess
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, cloud, echoes, field, points, read, read_error, unit, write
from echotools import Messages, array

FILE, LABELS = "TestKITTIWriter.bin", "TestKITTIWriter.label"

# Frozen: (LAS, SemanticKITTI) of the words for classes of objects.
WORDS = {
    "ground": (2, 72), "grass": (2, 72), "terrain": (2, 72), "water": (9, 49), "apron": (11, 44), "parking": (11, 44),
    "runway": (11, 40), "taxiway": (11, 40), "road": (11, 40), "terminal": (6, 50), "hangar": (6, 50),
    "building": (6, 50), "tower": (6, 50), "house": (6, 50), "bridge": (17, 52), "jetway": (1, 52),
    "structure": (1, 52), "scenery": (1, 52), "fence": (1, 51), "mast": (1, 80), "pole": (1, 80), "lamp": (1, 80),
    "sign": (1, 81), "vegetation": (5, 70), "tree": (5, 70), "car": (1, 10), "truck": (1, 18), "vehicle": (1, 20),
    "aircraft": (1, 20), "bird": (1, 99),
}


def parse():
    scan = np.fromfile(FILE, dtype="<f4").reshape(-1, 4)
    label = np.fromfile(LABELS, dtype="<u4")
    return scan, label & 0xFFFF, label >> 16


def ids(values):
    """A cloud with one point for each object."""
    data = cloud([[i, 1, 2] for i in range(len(values))])
    add_field(data, "position", (0.0, 0.0, 0.0))
    add_array(data, "object_id", np.array(values))
    return data


class TestKITTIWriter(unittest.TestCase):
    def setUp(self):
        self.data = echoes()
        self.writer = al.vtkAvianLidarKITTIWriter()

    def tearDown(self):
        for name in (FILE, LABELS):
            if os.path.exists(name):
                os.remove(name)

    def write(self, data=None, **properties):
        return write(self.writer, data or self.data, FILE, **properties)

    def test_points_in_the_frame_of_the_sensor(self):
        self.assertEqual(self.write(), [])
        scan, _, _ = parse()
        # Along the beams, as the sensor's own frame has them: unturned they are the pattern's angles.
        beam, laser = array(self.data, "beam_id"), array(self.data, "laser_id")
        azimuth, elevation = np.radians((beam // 4) * 4.0), np.radians(laser * 1.0)
        forward = np.cos(elevation) * np.cos(azimuth)
        left = -np.cos(elevation) * np.sin(azimuth)
        expected = array(self.data, "distance_m")[:, None] * np.column_stack([forward, left, np.sin(elevation)])
        # A float is off by 2^-25 of the next power of two; distances are below 512 m.
        self.assertLess(np.abs(scan[:, :3] - expected).max(), 512 * 2.0**-25 * 1.01)
        np.testing.assert_array_equal(scan[:, 3], (array(self.data, "intensity") / 255).astype("f4"))

    def test_read_by_others(self):
        """The toolkit's reader finds the same floats in the same order."""
        self.write()
        result = subprocess.run([os.environ["AVIANLIDAR_KITTI_READER"], FILE], capture_output=True, text=True, check=True)
        found = np.array([line.split() for line in result.stdout.splitlines()], dtype="f4")
        self.assertEqual(len(found), self.data.GetNumberOfPoints())
        np.testing.assert_array_equal(found, parse()[0])

    def test_labels(self):
        self.write()
        _, label, instance = parse()
        objects = array(self.data, "object_id")
        classes = field(self.data, "object_classes")
        expected = [WORDS.get(classes[i], (1, 0))[1] if i >= 0 else 0 for i in objects]
        self.assertEqual(label.tolist(), expected)
        self.assertEqual(instance.tolist(), (objects + 1).tolist())
        self.write(LabelSource=al.vtkAvianLidarKITTIWriter.LABEL_SOURCE_MATERIAL)
        _, label, instance = parse()
        self.assertEqual(label.tolist(), (300 + array(self.data, "material_id")).tolist())
        self.assertEqual(instance.tolist(), (objects + 1).tolist())

    def test_table_of_words(self):
        words = [*WORDS, "RUNWAY", "whatever"]
        data = ids(range(len(words)))
        add_field(data, "object_classes", words)
        self.write(data)
        _, label, _ = parse()
        expected = [kitti for _, kitti in WORDS.values()] + [40, 0]
        self.assertEqual(label.tolist(), expected)
        las = al.vtkAvianLidarLASWriter()
        write(las, data, "TestKITTIWriter.las", CoordinateSystem=2)
        classes = array(read("TestKITTIWriter.las"), "classification")
        os.remove("TestKITTIWriter.las")
        self.assertEqual(classes.tolist(), [las for las, _ in WORDS.values()] + [11, 1])

    def test_the_table_is_documented(self):
        with open(os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Documentation", "formats.md"), encoding="utf-8") as f:
            rows = re.findall(r"^\| ((?:`\w+`(?:, )?)+) \| (\d+)[^|]*\| (\d+)[^|]*\|$", f.read(), re.M)
        found = {word: (int(las), int(kitti)) for words, las, kitti in rows for word in re.findall(r"`(\w+)`", words)}
        self.assertEqual(found, WORDS)

    def test_instances_wrap(self):
        self.write(ids([-1, 0, 65534, 65535, 65536]))
        _, label, instance = parse()
        self.assertEqual(instance.tolist(), [0, 1, 65535, 0, 1])
        self.assertEqual(label.tolist(), [0] * 5)

    def test_points_alone(self):
        data = cloud([[1, 2, 3]])
        warnings = self.write(data, WriteLabels=False)
        self.assertEqual(len(warnings), 1)
        self.assertIn("'position'", warnings[0])
        self.assertFalse(os.path.exists(LABELS))
        np.testing.assert_array_equal(np.fromfile(FILE, "<f4"), [2, -1, 3, 0])

    def test_intensities_of_more_than_a_byte(self):
        data = cloud([[1, 2, 3], [4, 5, 6], [7, 8, 9]])
        add_array(data, "intensity", np.array([-1.0, 51.0, 65535.0]))
        warnings = self.write(data, WriteLabels=False)
        self.assertIn("2 points have an intensity that is not within 0 and 255", warnings[-1])
        np.testing.assert_allclose(array(read(FILE), "intensity"), [0, 51, 255], rtol=1e-6)

    def test_read_again(self):
        self.data = echoes(orientation=(0.0, 0.0, 0.0))
        self.write()
        again = read(FILE)
        np.testing.assert_allclose(points(again), points(self.data) - (10, 20, 3), rtol=0, atol=512 * 2.0**-25 * 1.01)
        np.testing.assert_allclose(array(again, "intensity"), array(self.data, "intensity"), rtol=1e-7)
        np.testing.assert_allclose(array(again, "distance_m"), array(self.data, "distance_m"), rtol=1e-6)
        np.testing.assert_allclose(array(again, "azimuth"), array(self.data, "azimuth"), rtol=0, atol=0.01)
        np.testing.assert_allclose(array(again, "vertical_angle"), array(self.data, "vertical_angle"), atol=1e-4)
        self.assertEqual(array(again, "instance_id").tolist(), (array(self.data, "object_id") + 1).tolist())
        self.assertEqual(set(array(again, "semantic_label")), {0, 40, 50, 51, 72})
        self.assertEqual(unit(again, "azimuth"), "0.01 deg")

    def test_labels_in_a_folder_of_their_own(self):
        shutil.rmtree("TestKITTI", ignore_errors=True)
        os.makedirs("TestKITTI/velodyne")
        os.makedirs("TestKITTI/labels")
        name = "TestKITTI/velodyne/000000.bin"
        write(self.writer, self.data, name)
        shutil.move("TestKITTI/velodyne/000000.label", "TestKITTI/labels/000000.label")
        self.assertTrue(read(name).GetPointData().HasArray("semantic_label"))
        with open("TestKITTI/labels/000000.label", "ab") as file:
            file.write(b"1234")
        self.assertIn("labels", read_error(name))
        os.remove("TestKITTI/labels/000000.label")
        self.assertFalse(read(name).GetPointData().HasArray("semantic_label"))
        with open(name, "ab") as file:
            file.write(b"1234")
        self.assertIn("multiple of 16", read_error(name))
        shutil.rmtree("TestKITTI")

    def test_no_points(self):
        data = ids([])
        self.write(data)
        self.assertEqual((os.path.getsize(FILE), os.path.getsize(LABELS)), (0, 0))
        self.assertEqual(read(FILE).GetNumberOfPoints(), 0)

    def test_bad_input_leaves_neither_file(self):
        def bad(data, words, **properties):
            heard = Messages(self.writer)
            self.writer.SetInputData(data)
            self.writer.SetFileName(FILE)
            for name, value in properties.items():
                getattr(self.writer, "Set" + name)(value)
            self.assertEqual(self.writer.Write(), 0)
            self.assertEqual(len(heard.errors), 1, heard.errors)
            self.assertIn(words, heard.errors[0])
            self.assertFalse(os.path.exists(FILE) or os.path.exists(LABELS))

        without = cloud([[1, 2, 3]])
        add_field(without, "position", (0.0, 0.0, 0.0))
        bad(without, "'object_id'")
        bad(ids([1]), "'material_id'", LabelSource=1)
        broken = ids([1, 2])
        broken.GetPoints().SetPoint(1, 0, 0, np.inf)
        bad(broken, "point 1", LabelSource=0)


if __name__ == "__main__":
    unittest.main()
