# SPDX-License-Identifier: BSD-3-Clause
"""The room example on scans that are made here and written as PCD, LAS and KITTI: a scan from its own surface is the
scan, and so it is from that of another one where the poses are right. And on its real scans and on those of other
sensors, which are not in the repository: without AVIANLIDAR_DATA_DIR skipped."""
import json
import os
import pathlib
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
from echotools import box, copy_of, given, scan, sensor

import exampletools as et
import room
import room_data

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
COLUMNS, CHANNELS = 240, 12
KINDS = {"pcd": {}, "las": {"coordinate_system": "Local"}, "bin": {}}


class Scans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # A hall around the sensor.
        cls.hall = scan(box((1.0, 2.0, 0.5), (12.0, 9.0, 4.0), "Wall"),
                        given(sensor(COLUMNS, CHANNELS), ElevationStep=2.0))
        cls.hall.Update()
        cls.files = {kind: et.emptied("ExampleRoomScans", kind) / f"cloud.{kind}" for kind in KINDS}
        for kind, settings in KINDS.items():
            al.save(cls.hall.GetOutput(), cls.files[kind], **settings)

    def test_a_scan_alone(self):
        for kind, file in self.files.items():
            with self.subTest(kind):
                own = self.study("its own scan", "--rays", "10", "--scans", str(file))
                self.assertGreater(own["beams"], 0.9 * COLUMNS * CHANNELS)
                self.assertGreater(own["in5cm"], 0.95)
                self.assertLess(abs(own["median"]), 0.01)

    @staticmethod
    def study(what, *arguments):
        """A row of the table of errors."""
        _, result = room.main(["--no-pictures", "--only-main", "--out", et.folder("ExampleRoomScans-2"), *arguments])
        return {row["what"]: row for row in result.errors}[what]

    def test_scans_of_each_other(self):
        other = self.files["pcd"].with_name("turned.pcd")
        pose, angle = np.eye(4), np.radians(-20.0)
        pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        moved = copy_of(self.hall.GetOutput())
        places = vtk_to_numpy(moved.GetPoints().GetData())
        places[:] = places @ np.linalg.inv(pose[:3, :3]).T
        al.save(moved, other)
        poses = self.files["pcd"].with_name("poses.json")
        poses.write_text(json.dumps({"turned": {"T": pose.tolist()}}))
        scans = ("--rays", "10", "--scans", str(other), str(self.files["bin"]), "--sensors", "turned")
        self.assertGreater(self.study("all", *scans, "--poses", str(poses))["in5cm"], 0.9)
        self.assertLess(self.study("all", *scans)["in5cm"], 0.5)


@unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is not set")
class Room(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = et.folder("ExampleRoom")
        cls.room, cls.result = room.main(["--no-pictures", "--only-main", "--sensors", "xt32", "--rays", "30",
                                          "--out", cls.folder])
        cls.errors = {row["what"]: row for row in cls.result.errors}
        cls.clouds = {row["what"]: row for row in cls.result.clouds}

    def test_a_scan_from_its_own_surface_is_the_scan(self):
        own, clouds = self.errors["its own scan"], self.clouds["from its own scan"]
        self.assertGreater(own["in2cm"], 0.98)
        self.assertLess(own["spread"], 0.003)
        self.assertLess(abs(own["median"]), 0.001)
        self.assertLess(clouds["rmse_rs"], 0.007)
        self.assertLess(clouds["hausdorff"], 0.1)

    def test_a_scan_from_the_others_surface(self):
        every, both = self.errors["all"], self.clouds["beams with both"]
        self.assertGreater(every["beams"], 16000)
        self.assertGreater(every["in5cm"], 0.53)
        self.assertGreater(every["in10cm"], 0.63)
        self.assertLess(abs(every["median"]), 0.02)
        self.assertLess(self.errors["on planes"]["spread"], 0.04)
        self.assertLess(both["rmse_rs"], 0.16)
        self.assertLess(both["rmse_sr"], 0.13)


@unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is not set")
class OtherSensors(unittest.TestCase):
    """(file, rings, columns of a turn, fewest answers): beams that fire together stay apart, those that nothing
    answered are found. The Helios stands on a vehicle, most of whose points lie within a metre: there its beams, which
    leave it beside its middle, cross, and cannot be told apart by azimuth."""
    FILES = (("lidar_ouster/os0_32.pcd", 32, 1024, 1.0), ("lidar_ouster/os1_32.pcd", 32, 1024, 1.0),
             ("lidar_ouster/os2_32.pcd", 32, 1024, 1.0), ("lidar_outdoor/xt16.pcd", 16, 2000, 0.95),
             ("lidar_vlp16_mrpt/vlp16.pcd", 16, 1809, 1.0), ("lidar_outdoor/helios16p_frame0.pcd", 16, None, 0.7),
             ("lidar_outdoor/helios16p_frame1.pcd", 16, None, 0.7))

    def test_beams(self):
        for name, rings, columns, answers in self.FILES:
            with self.subTest(name):
                file = pathlib.Path(DATA) / name
                scan = room_data.read_scan(file)
                self.assertEqual(scan.ring[-1] + 1, rings)
                self.assertGreaterEqual(scan.answered.sum(), answers * al.load_cloud(file).number_of_points)
                if columns:
                    np.testing.assert_allclose(np.diff(scan.rings()), columns, rtol=0.01)
