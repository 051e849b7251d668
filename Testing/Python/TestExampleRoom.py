# SPDX-License-Identifier: BSD-3-Clause
"""The room example on its real scans and on those of other sensors, which are not in the repository: without
AVIANLIDAR_DATA_DIR skipped (77)."""
import os
import pathlib
import sys
import unittest

import numpy as np

import avianlidar as al
import exampletools as et
import room
import room_data

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")


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


class OtherSensors(unittest.TestCase):
    """(file, rings, columns of a turn, fewest answers): beams that fire together stay apart, those that nothing answered
    are found. The Helios stands on a vehicle, most of whose points lie within a metre: there its beams, which leave it
    beside its middle, cross, and cannot be told apart by azimuth."""
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


if __name__ == "__main__":
    if not DATA:
        print("AVIANLIDAR_DATA_DIR is not set: skipped")
        sys.exit(77)
    unittest.main()
