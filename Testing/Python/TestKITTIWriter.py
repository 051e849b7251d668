# SPDX-License-Identifier: BSD-3-Clause
"""KITTI scans read by the Mobile Robot Programming Toolkit, scans and SemanticKITTI's labels by NumPy as that data
set's own tools do, and by the reader."""

import os
import pathlib
import re
import subprocess

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, assert_refused, cloud, echoes, field, points, read, read_error, unit, write
from echotools import InFolder, Messages, array, given

FILE, LABELS = "TestKITTIWriter.bin", "TestKITTIWriter.label"

# (LAS, SemanticKITTI) of the words for classes of objects, as the page has them; a few as the standards do.
with open(os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Documentation", "reference", "formats.md"),
          encoding="utf-8") as page:
    ROWS = re.findall(r"^\| ((?:`\w+`(?:, )?)+) \| (\d+)[^|]*\| (\d+)[^|]*\|$", page.read(), re.M)
WORDS = {word: (int(las), int(kitti)) for words, las, kitti in ROWS for word in re.findall(r"`(\w+)`", words)}
STANDARD = {"ground": (2, 72), "water": (9, 49), "runway": (11, 40), "building": (6, 50), "bridge": (17, 52),
            "fence": (1, 51), "pole": (1, 80), "sign": (1, 81), "tree": (5, 70), "car": (1, 10), "truck": (1, 18),
            "vehicle": (1, 20), "bird": (1, 99)}


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


class TestKITTIWriter(InFolder):
    def setUp(self):
        super().setUp()
        self.data = echoes()
        self.writer = al.vtkAvianLidarKITTIWriter()

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
        # The toolkit's reader finds the same floats in the same order.
        result = subprocess.run([os.environ["AVIANLIDAR_KITTI_READER"], FILE], capture_output=True, text=True,
                                check=True)
        np.testing.assert_array_equal(np.array([line.split() for line in result.stdout.splitlines()], dtype="f4"), scan)

    def test_labels(self):
        objects, classes = array(self.data, "object_id"), field(self.data, "object_classes")
        named = [WORDS.get(classes[i], (1, 0))[1] if i >= 0 else 0 for i in objects]
        for source, expected in ((0, named), (1, (300 + array(self.data, "material_id")).tolist())):
            self.write(LabelSource=source)
            _, label, instance = parse()
            self.assertEqual((label.tolist(), instance.tolist()), (expected, (objects + 1).tolist()))

    def test_table_of_words(self):
        self.assertEqual({word: WORDS[word] for word in STANDARD}, STANDARD)
        self.assertGreater(len(WORDS), 29)
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
        self.assertEqual(classes.tolist(), [las for las, _ in WORDS.values()] + [11, 1])

    def test_instances_wrap(self):
        self.write(ids([-1, 0, 65534, 65535, 65536]))
        self.assertEqual(parse()[2].tolist(), [0, 1, 65535, 0, 1])

    def test_points_alone_and_bright_ones(self):
        """x forward, y to the left, z up; intensities beyond a byte are cut with a warning."""
        data = cloud([[1, 2, 3], [4, 5, 6], [7, 8, 9]])
        add_array(data, "intensity", np.array([-1.0, 51.0, 65535.0]))
        first, second = self.write(data, WriteLabels=False)
        self.assertIn("'position'", first)
        self.assertIn("2 points have an intensity that is not within 0 and 255", second)
        self.assertFalse(os.path.exists(LABELS))
        np.testing.assert_array_equal(np.fromfile(FILE, "<f4")[:4], [2, -1, 3, 0])
        np.testing.assert_allclose(array(read(FILE), "intensity"), [0, 51, 255], rtol=1e-6)

    def test_measured_clouds(self):
        """Without objects: the labels that were read, or none; far from the sensor, the loss in single precision and
        its remedy."""
        near = cloud([[1, 2, 3], [4, 5, 6]])
        far = cloud(points(near) + (448123.4, 5412345.6, 420.1))
        position, none, lost = self.write(far)
        self.assertIn("'position' of a sensor: its points are taken for coordinates in the sensor's frame", position)
        self.assertIn("no labels are written, because the input has no point array 'object_id' or 'semantic_label'",
                      none)
        loss = np.abs(np.float32(points(far)) - points(far)).max()
        self.assertRegex(lost,
                         rf"moves coordinates by up to {round(loss, 3):g} m: set .*'position', or --position of "
                         r"avianlidar convert")
        self.assertFalse(os.path.exists(LABELS))
        add_field(far, "position", (448123.4, 5412345.6, 420.1))
        self.assertEqual(len(self.write(far)), 1)
        np.testing.assert_allclose(points(read(FILE)), points(near), rtol=0, atol=1e-6)
        for name, values in (("semantic_label", (40, 252)), ("instance_id", (0, 65535))):
            add_array(far, name, np.array(values, np.uint16))
        self.assertEqual(self.write(far), [])
        again = read(FILE)
        self.assertEqual([array(again, name).tolist() for name in ("semantic_label", "instance_id")],
                         [[40, 252], [0, 65535]])
        before = pathlib.Path(FILE).read_bytes()  # these labels would label other points
        heard = Messages(self.writer)
        self.assertEqual(given(self.writer, InputData=near, FileName=FILE).Write(), 0)
        self.assertRegex(heard.errors[0], f"would get the labels of .*{LABELS}: remove this file")
        self.assertEqual(pathlib.Path(FILE).read_bytes(), before)

    def test_read_again(self):
        self.data = echoes(orientation=(0.0, 0.0, 0.0))
        self.write()
        again = read(FILE)
        np.testing.assert_allclose(points(again), points(self.data) - (10, 20, 3), rtol=0, atol=512 * 2.0**-25 * 1.01)
        for name, rounding in (("intensity", (1e-7, 0)), ("distance_m", (1e-6, 0)), ("azimuth", (0, 0.01)),
                               ("vertical_angle", (1e-7, 1e-4))):
            np.testing.assert_allclose(array(again, name), array(self.data, name), *rounding, err_msg=name)
        self.assertEqual(array(again, "instance_id").tolist(), (array(self.data, "object_id") + 1).tolist())
        self.assertEqual(set(array(again, "semantic_label")), {0, 40, 50, 51, 72})
        self.assertEqual(unit(again, "azimuth"), "0.01 deg")

    def test_labels_in_a_folder_of_their_own(self):
        name, label = pathlib.Path("velodyne", "000000.bin"), pathlib.Path("labels", "000000.label")
        for one in (name, label):
            one.parent.mkdir()
        write(self.writer, self.data, str(name))
        name.with_suffix(".label").rename(label)
        self.assertTrue(read(str(name)).GetPointData().HasArray("semantic_label"))
        label.write_bytes(label.read_bytes() + b"1234")
        self.assertIn("labels", read_error(str(name)))
        label.unlink()
        self.assertFalse(read(str(name)).GetPointData().HasArray("semantic_label"))

    def test_bad_input_leaves_neither_file(self):
        broken = ids([1, 2])
        broken.GetPoints().SetPoint(1, 0, 0, np.inf)
        for data, words, source in ((ids([1]), "'material_id'", 1), (broken, "point 1", 0)):
            self.writer.SetLabelSource(source)
            assert_refused(self, self.writer, data, FILE, words)
            self.assertFalse(os.path.exists(LABELS))
