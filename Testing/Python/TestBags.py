# SPDX-License-Identifier: BSD-3-Clause
"""A sequence as a bag: what the libraries @mcap/core and rosmsg2-serialization read of it (Node.js), and what is wrong
with a folder."""
import base64
import json
import os
import pathlib
import shutil
import subprocess

import numpy as np
from scipy.spatial.transform import Rotation

import avianlidar
from avianlidar.apps.sequences import _rosbag
from cloudtools import pose_line, write_sequence
from echotools import InFolder
from helpertools import run

READER = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Testing" / "IO" / "mcap_to_json.js"
MODULES = pathlib.Path(os.environ.get("NODE_PATH", "none"))
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])  # a rotation of whole fractions
COUNTS = (5, 0, 70000)
TIMES = (0.0, 2.5, 1234567.000001)


class TestBags(InFolder):
    def setUp(self):
        super().setUp()
        self.sequence, self.out = self.folder / "00", self.folder / "out.mcap"
        chance = np.random.default_rng(3)
        self.scans = [(chance.random((count, 4), np.float32), chance.integers(0, 2**32, count, np.uint32))
                      for count in COUNTS]
        write_sequence(self.sequence, self.scans, TIMES, pose_line(TURN, (10, -20, 3)))

    def put(self, name, text):
        (self.sequence / name).write_text(text, "utf-8")

    def read(self):
        self.assertEqual(_rosbag.write(self.sequence, self.out), 3)
        if not (MODULES / "@mcap").is_dir():
            self.skipTest("the node modules of Testing/IO are not there")
        return json.loads(subprocess.run([os.environ["AVIANLIDAR_NODE"], READER, self.out], check=True,
                                         capture_output=True).stdout)

    def test_other_programs_read_the_file(self):
        found = self.read()
        self.assertEqual((found["header"]["profile"], found["done"], found["strange"]), ("ros2", True, []))
        self.assertEqual(found["statistics"]["channelMessageCounts"], {"1": "3", "2": "3"})
        for number, ((points, labels), time) in enumerate(zip(self.scans, TIMES)):
            (tf, cloud), stamp = found["messages"][2 * number:2 * number + 2], round(time * 1e9)
            self.assertEqual([(one["topic"], one["schema"], one["logTime"]) for one in (tf, cloud)], [
                ("/tf", "tf2_msgs/msg/TFMessage", str(stamp)), ("/points", "sensor_msgs/msg/PointCloud2", str(stamp))])
            header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": "lidar"}
            self.check_cloud(cloud["message"], header, points, labels)
            self.check_transform(tf["message"], {**header, "frame_id": "map"}, TURN, (10, -20, 3))

    def check_cloud(self, message, header, points, labels):
        fields = [(name, 4 * k, 7)
                  for k, name in enumerate(("x", "y", "z", "intensity"))] + [("label", 16, 4), ("instance", 18, 4)]
        data = base64.b64decode(message.pop("data"))
        self.assertEqual(message, {"header": header, "height": 1, "width": len(points), "is_bigendian": False,
                                   "point_step": 20, "row_step": 20 * len(points), "is_dense": True,
                                   "fields": [{"name": name, "offset": at, "datatype": kind, "count": 1}
                                              for name, at, kind in fields]})
        rows = np.frombuffer(data, [("points", "<f4", 4), ("label", "<u2"), ("instance", "<u2")])
        self.assertTrue(np.array_equal(rows["points"], points * np.float32([1, 1, 1, 255])))
        self.assertTrue(np.array_equal(rows["label"], labels % 65536)
                        and np.array_equal(rows["instance"], labels // 65536))

    def check_transform(self, message, header, rotation, place):
        (one,) = message["transforms"]
        self.assertEqual((one["header"], one["child_frame_id"]), (header, "lidar"))
        self.assertEqual([one["transform"]["translation"][axis] for axis in "xyz"], list(place))
        turn = [one["transform"]["rotation"][axis] for axis in "xyzw"]
        self.assertAlmostEqual(np.linalg.norm(turn), 1, 9)
        self.assertLess(np.abs(Rotation.from_quat(turn).as_matrix() - rotation).max(), 1e-9)

    def test_files_of_another_program(self):
        if not (MODULES / "@mcap").is_dir():
            self.skipTest("the node modules of Testing/IO are not there")
        for chunks in ("true", "false"):
            subprocess.run([os.environ["AVIANLIDAR_NODE"], READER.with_name("write_mcap.js"), self.out, chunks], check=True)
            recording = avianlidar.load_clouds(self.out)
            np.testing.assert_allclose(recording.times, [7.0000005, 8.0000005], rtol=0, atol=1e-12)
            first, second = recording
            np.testing.assert_array_equal(second.points, [[-9, 8, 10], [-14, 13, 15], [-19, 18, 20]])
            np.testing.assert_array_equal(first["laser_id"], [4, 9, 14])
            # half a turn about z, then x right and y forward
            np.testing.assert_allclose(recording.pose(1), [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]], atol=1e-12)

    def test_boxes(self):
        (self.sequence / "boxes").mkdir()
        for number, text in enumerate(("bird 0.00 0.25 -180.25 -226.5 27.75 0.5 1.25 0.125 1.6271 10000 3\ncar 0.5 "
                                       "1.00 1 2 3 4 2 2 -3 7 0\n", "", "")):
            self.put(f"boxes/{number:06d}.txt", text)
        found = self.read()
        self.assertEqual((found["strange"], found["statistics"]["channelMessageCounts"]),
                         ([], {"1": "3", "2": "3", "3": "3"}))
        of = [message["message"]["markers"] for message in found["messages"] if message["topic"] == "/boxes"]
        self.assertEqual([one["color"]["g"] > one["color"]["b"] for one in of[0][1:]], [True, False])  # a bird is green
        # all go, then these come
        self.assertEqual([[one["action"] for one in markers] for markers in of], [[3, 0, 0], [3], [3]])
        for marker, name, number, middle, size, yaw, words in zip(
                of[0][1:], ("bird", "car"), (10000, 7), ((-180.25, -226.5, 27.75), (1, 2, 3)),
                ((0.5, 1.25, 0.125), (4, 2, 2)), (1.6271, -3),
                ("truncated 0.00, hidden 0.25, points 3", "truncated 0.50, hidden 1.00, points 0")):
            self.assertEqual((marker["ns"], marker["id"], marker["type"], marker["text"], marker["header"]["frame_id"]),
                             (name, number, 1, words, "lidar"))
            self.assertEqual([marker["pose"]["position"][axis] for axis in "xyz"], list(middle))
            self.assertEqual([marker["scale"][axis] for axis in "xyz"], list(size))
            turned = marker["pose"]["orientation"]
            self.assertAlmostEqual(2 * np.arctan2(turned["z"], turned["w"]), yaw, delta=1e-12)
        self.put("boxes/000002.txt", "bird 0 0 1 2 3\n")
        with self.assertRaisesRegex(ValueError,
                                    "000002.txt: expected lines of a class, 9 numbers, an id and a number of points"):
            _rosbag.write(self.sequence, self.out)

    def test_poses_of_a_camera(self):
        """KITTI's: x right, y down, z forward. One that drives forward drives along x of the lidar."""
        camera = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
        self.put("calib.txt", "Tr: " + pose_line(camera, (0, 0, 0)))
        self.put("poses.txt", pose_line(np.eye(3), (0, 0, 7)) * 3)
        found = self.read()
        self.check_transform(found["messages"][0]["message"], {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"},
                             np.eye(3), (7, 0, 0))

    def test_half_turns(self):
        """Where the largest component of a quaternion is another one."""
        turns = (np.diag([1, -1, -1]), np.diag([-1, 1, -1]), np.diag([-1, -1, 1]))
        self.put("poses.txt", "".join(pose_line(rotation, (1, 2, 3)) for rotation in turns))
        for message, rotation in zip(self.read()["messages"][::2], turns):
            self.check_transform(message["message"],
                                 {**message["message"]["transforms"][0]["header"], "frame_id": "map"}, rotation,
                                 (1, 2, 3))

    def test_a_sequence_without_labels(self):
        shutil.rmtree(self.sequence / "labels")
        self.assertEqual(_rosbag.write(self.sequence, self.out), 3)

    def test_errors(self):
        """What the command says, and each file with what is wrong in it; no file is left."""
        def refused(words, source=None):
            with self.assertRaises((ValueError, avianlidar.Error)) as caught:
                _rosbag.write(pathlib.Path(source or self.sequence), self.out)
            self.assertIn(words, str(caught.exception))
            self.assertFalse(self.out.exists())

        code, out, errors = run("convert", self.folder, self.out)
        self.assertEqual((code, out, self.out.exists()), (2, "", False))
        self.assertIn(f"{self.folder}: is not a folder of a sequence", errors)
        refused("cloud.las: is not a folder of a sequence", "cloud.las")
        pose = pose_line(TURN, (0, 0, 0))
        for name, text, words, mended in (("times.txt", "0\n1\n", "has 3 scans, 2 times and 3 poses", ""),
                                          ("times.txt", "0\n1\ntwo\n", "1 in each", ""),
                                          ("times.txt", "0\n1\n1e10\n", "from 0 to 2e9", "0\n1\n2\n"),
                                          ("poses.txt", "1 2 3\n", "12 in each", pose * 3),
                                          ("calib.txt", "P0: 1\n", "expected one line Tr:", ""),
                                          ("calib.txt", "Tr: " + "0 " * 12, "with a rotation", "Tr: " + pose)):
            self.put(name, text)
            refused(words)
            self.put(name, mended)
        label, scan = (self.sequence / folder / name
                       for folder, name in (("labels", "000001.label"), ("velodyne", "000001.bin")))
        label.unlink()
        refused("000001.label: cannot be read (No such file or directory)")
        label.write_bytes(b"")
        scan.write_bytes(bytes(15))
        refused("000001.bin: has 15 bytes, and its labels have 0, expected 16 and 4")
        label.write_bytes(bytes(5))
        refused("its labels have 5, expected 16 and 4")
        shutil.rmtree(self.sequence / "labels")
        refused("000001.bin: has 15 bytes")
        (self.sequence / "calib.txt").unlink()
        refused("calib.txt")
