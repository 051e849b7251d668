# SPDX-License-Identifier: BSD-3-Clause
"""The room example on scans that are made here and written as PCD, LAS and KITTI: a scan from its own surface is the scan, and
so it is from that of another one where the poses are right."""
import json
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
from echotools import box, copy_of, given, scan, sensor

import exampletools as et
import room

COLUMNS, CHANNELS = 240, 12
KINDS = {"pcd": {}, "las": {"coordinate_system": "Local"}, "bin": {}}


class Scans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # A hall around the sensor.
        cls.hall = scan(box((1.0, 2.0, 0.5), (12.0, 9.0, 4.0), "Wall"), given(sensor(COLUMNS, CHANNELS), ElevationStep=2.0))
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


if __name__ == "__main__":
    unittest.main()
