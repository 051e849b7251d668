# SPDX-License-Identifier: BSD-3-Clause
"""A recording beside the simulation of its scene: walls in closed form, what is missing, and poses that are found."""
import csv
import json
import os
import pathlib
import unittest

import numpy as np
from scipy.spatial.transform import Rotation

import TestRecording
import avianlidar as al
from avianlidar import _ros
from avianlidar._cloud import add_array
from avianlidar.apps.sequences._compared import Comparison, Pose, aligned
from echotools import InFolder
from helpertools import run

DATA = pathlib.Path(os.environ["AVIANLIDAR_DATA_DIR"]) if os.environ.get("AVIANLIDAR_DATA_DIR") else None
# A yard: half widths and height of its walls, m. All faces are seen from inside.
EAST, NORTH, HEIGHT = 30.0, 20.0, 12.0
PLACE = np.array([4.0, -3.0, 2.0])


def yard():
    """Floor and walls as one mesh."""
    x, y, h = EAST, NORTH, HEIGHT
    corners = np.array([(a * x, b * y, c) for c in (0, h) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float)
    faces = [(0, 1, 2), (0, 2, 3)]
    for k in range(4):
        n = (k + 1) % 4
        faces += [(k, n, 4 + n), (k, 4 + n, 4 + k)]
    return corners, np.array(faces)


def ranges(place, directions):
    """Ranges to the yard's faces in closed form."""
    with np.errstate(divide="ignore"):
        far = [(half - np.sign(along) * place[axis]) / np.abs(along)
               for axis, half, along in ((0, EAST, directions[:, 0]), (1, NORTH, directions[:, 1]))]
        down = np.where(directions[:, 2] < 0, place[2] / np.abs(directions[:, 2]), np.inf)
    return np.min([*far, down], axis=0)


class Compared(InFolder):
    def setUp(self):
        super().setUp()
        self.sensor = al.Sensor("Search905", number_of_channels=16, minimum_elevation=-10.0, elevation_step=1.0,
                                azimuth_step=2.0, position=tuple(PLACE))
        self.directions = np.array(self.sensor.beams["direction"])
        self.ranges = ranges(PLACE, self.directions)
        self.scene = al.Scene(yard(), material="Wall")

    def record(self, name, directions=None, away=None, light=None):
        """Writes a scan in the sensor's frame, and returns its file."""
        directions = self.directions if directions is None else directions
        away = self.ranges if away is None else away
        cloud = al.Cloud(type("points", (), {"points": directions * away[:, None]})())
        add_array(cloud.data.GetPointData(), "intensity", np.full(len(away), 9.0) if light is None else light)
        al.save(cloud, self.folder / name)
        return self.folder / name

    def compare(self, files, **options):
        return Comparison(self.scene, al.load_clouds(files), al.Sensor("Search905", number_of_channels=16,
                          minimum_elevation=-10.0, elevation_step=1.0, azimuth_step=2.0), **options)

    def test_the_same_yard(self):
        """One scan is the yard, one has a wall 2 m nearer in the north and no echo in the south."""
        azimuth = np.degrees(np.arctan2(*self.directions[:, :2].T)) % 360
        north, south = (azimuth > 350) | (azimuth < 10), np.abs(azimuth - 180) < 10
        nearer = np.where(north, self.ranges - 2, self.ranges)[~south]
        files = [self.record("0.pcd"), self.record("1.pcd", self.directions[~south], nearer)]
        found = self.compare(files, position=PLACE).numbers()
        self.assertEqual(found["beams"], len(azimuth))
        self.assertAlmostEqual(found["simulated"], 1.0)
        self.assertAlmostEqual(found["recorded"], 1 - 0.5 * south.mean())
        self.assertAlmostEqual(found["drop_outs"], 0.5 * south.mean())
        self.assertAlmostEqual(found["nearer"], north.sum() / (2 * len(azimuth) - south.sum()), delta=0.01)  # edges
        self.assertLess(abs(found["median"]), 0.1)
        self.assertEqual((found["missing"], found["outside"]), (0, 0))

    def test_pages_and_tables(self):
        light = np.where(self.directions[:, 2] < 0, 5.0, 7.0)
        file = self.record("scan.pcd", light=light)
        al.save(al.Cloud(self.scene.surfaces.GetBlock(0)), self.folder / "none.vtp")
        code, said, errors = run("compare", al.example_scene(), file, "--sensor", "Airport16", "-o", self.folder / "a")
        self.assertEqual(code, 0, errors)
        self.assertIn("the sensor stands at (0.00, 0.00, 3.00) m, yaw 0.00", said)
        compared = self.compare(file, position=PLACE)
        compared.write(self.folder / "b")
        with open(self.folder / "b" / "materials.csv", encoding="utf-8") as stream:
            (row,) = csv.DictReader(stream)
        self.assertEqual((row["material"], row["recorded share"]), ("Wall", "1"))
        self.assertEqual(float(row["recorded intensity"]), np.median(light))
        with open(self.folder / "b" / "places.csv", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        of = np.histogram(self.ranges, (0, 10, 25, 50, 100))[0]
        self.assertEqual([float(one["recorded"]) for one in rows if one["by"] == "range"][:4], of.tolist())
        self.assertIn("Simulated with the sensor", (self.folder / "b" / "compare.html").read_text())

    def test_poses_are_found(self):
        """The pose of a scan that stands and looks elsewhere, with a tenth of the points far from all surfaces."""
        chance = np.random.default_rng(3)
        for yaw, pitch, roll, shift in ((5, 1, -1, (0.8, -0.6, 0.3)), (-8, 0, 0, (-1, 0.5, 0)), (0, 0, 0, (0, 0, 0))):
            turn = Rotation.from_euler("ZXY", (-yaw, pitch, roll), degrees=True).as_matrix()
            away = ranges(PLACE, self.directions @ turn.T)
            away[::10] *= chance.uniform(0.3, 0.8, len(away[::10]))
            start = Pose(np.eye(3), PLACE + shift)
            pose, words = aligned(self.directions * away[:, None], start, self.scene)
            np.testing.assert_allclose(pose.place[:2], PLACE[:2], atol=0.01)
            self.assertAlmostEqual(pose.place[2], PLACE[2], delta=0.1)  # few beams meet the floor steeply
            np.testing.assert_allclose(pose.orientation(), (yaw, pitch, roll), atol=0.02)
            self.assertIn(f"moved by {np.linalg.norm(shift):.2f} m", words)

    def test_far_poses_stay(self):
        """A pose that is not found is not changed."""
        for shift, turn in (((500, 0, 0), 0), ((0, 0, 0), 180), ((60, 60, 60), 90)):
            start = Pose(Rotation.from_euler("Z", turn, degrees=True).as_matrix(), PLACE + shift)
            pose, words = aligned(self.directions * ranges(PLACE, self.directions)[:, None], start, self.scene)
            if words.startswith("Not aligned"):
                self.assertIs(pose, start)
            else:  # the yard looks nearly the same when it is turned by half a circle
                self.assertLess(float(words.split(" to ")[1].split()[0]), 1.0)

    def test_what_is_open_stays(self):
        """A single wall does not tell where along the wall, and how high, the sensor stands."""
        wall = al.Scene(([(-500, 30, -500), (500, 30, -500), (500, 30, 500), (-500, 30, 500)], [(0, 1, 2), (0, 2, 3)]))
        seen = self.directions[self.directions[:, 1] > 0.3]
        pose, _ = aligned(seen * (30 / seen[:, 1:2]), Pose(np.eye(3), np.array([1.0, 2.0, 3.0])), wall)
        np.testing.assert_allclose(pose.place, (1, 0, 3), atol=1e-3)

    def test_errors(self):
        file = self.record("scan.pcd")
        for words, expected in (((al.example_scene(), file, "-o", "x"), "expected --sensor"),
                                ((al.example_scene(), file, "--sensor", "Airport16"), "expected a folder for the page"),
                                ((file, file, "--align"), "--align is for a scene and a recording"),
                                ((al.example_scene(), self.folder / "none", "--sensor", "Airport16", "-o", "x"),
                                 "no such file or folder")):
            self.assertIn(expected, run("compare", *words)[2])


@unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is not set")
class RealFrames(InFolder):
    """Frames of other programs. The published pose of the PandarXT-32 in the mesh of the room is from another
    alignment."""

    def test_frames_are_recordings(self):
        for folder, count in (("lidar_ouster", 3), ("lidar_outdoor", 3), ("lidar_vlp16_mrpt", 1), ("lidar_room", 4)):
            files = sorted((DATA / folder).glob("*.pcd"))
            recording = al.load_clouds(files)
            self.assertEqual(len(recording), count)
            for cloud in recording:
                self.assertGreater(cloud.number_of_points, 10000, folder)
                self.assertTrue({"laser_id", "distance_m", "azimuth"} <= set(cloud) or "distance_m" in cloud, folder)

    def test_a_frame_as_a_bag(self):
        """All points and their fields, as ROS has them, come back."""
        cloud = al.load_cloud(DATA / "lidar_room" / "xt32.pcd")
        rows = np.zeros(cloud.number_of_points, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "u1"),
                                                 ("ring", "<u2")])
        rows["x"], rows["y"], rows["z"] = cloud.points[:, 1], -cloud.points[:, 0], cloud.points[:, 2]
        rows["intensity"], rows["ring"] = cloud["intensity"], cloud["laser_id"]
        TestRecording.db3(self.folder / "a.db3", [("/p", _ros.CLOUD, 1, TestRecording.message(1, rows))])
        (back,) = al.load_clouds(self.folder / "a.db3")
        np.testing.assert_array_equal(back.points, cloud.points)
        for name in ("intensity", "laser_id", "distance_m", "azimuth"):
            np.testing.assert_array_equal(back[name], cloud[name])

    def test_the_pose_in_the_room(self):
        known = json.loads((DATA / "lidar_room" / "transforms_to_pandar64.json").read_text())["xt32"]
        found = Comparison(al.Scene(DATA / "lidar_room" / "room_mesh_4sensors.ply", material="Wall"),
                           al.load_clouds(DATA / "lidar_room" / "xt32.pcd"), al.Sensor("PandarXT32"), align=True)
        np.testing.assert_allclose(found.pose.place, known["t"], atol=0.05)
        self.assertAlmostEqual(found.pose.orientation()[0], -known["yaw_deg"], delta=0.2)
        self.assertLess(found.numbers()["drop_outs"], 0.05)
