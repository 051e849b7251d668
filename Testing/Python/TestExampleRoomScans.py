# SPDX-License-Identifier: BSD-3-Clause
"""The room example on scans that are made here and written as PCD, LAS and KITTI: beams with and without an answer are
found again from the points, with or without rings, and a scan from its own surface is the scan."""
import json
import pathlib
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from avianlidar import vtkAvianLidar as al
from echotools import box, scan, sensor

import exampletools as et
import room
import room_data
import running

COLUMNS, CHANNELS = 240, 12
WRITERS = {"pcd": al.vtkAvianLidarPCDWriter, "las": al.vtkAvianLidarLASWriter, "bin": al.vtkAvianLidarKITTIWriter}


def lidar(surfaces):
    beams = sensor(COLUMNS, CHANNELS)
    beams.SetElevationStep(2.0)
    echo = scan(surfaces, beams)
    running.update(echo)
    return beams.GetOutput(), echo


def write(echo, folder, kind):
    name = pathlib.Path(folder) / f"cloud_{kind}.{kind}"
    writer = WRITERS[kind]()
    if kind == "las":
        writer.SetCoordinateSystemToLocal()
    writer.SetInputConnection(echo.GetOutputPort())
    writer.SetFileName(str(name))
    running.write(writer)
    return name


def turned(degrees, shift):
    pose, angle = np.eye(4), np.radians(degrees)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pose[:3, 3] = shift
    return pose


class Scans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = et.folder("ExampleRoomScans")
        # A hall around the sensor; and a wall before it, past which nothing answers.
        cls.hall = lidar(box((1.0, 2.0, 0.5), (12.0, 9.0, 4.0), "Wall"))
        cls.wall = lidar(box((0.0, 20.0, 0.0), (10.0, 1.0, 5.0), "Wall"))
        cls.files = {kind: write(cls.hall[1], cls.folder, kind) for kind in WRITERS}

    def test_every_beam_is_found(self):
        directions = vtk_to_numpy(self.hall[0].GetPointData().GetArray("direction"))
        points = np.sort(vtk_to_numpy(self.hall[1].GetOutput().GetPoints().GetData()), axis=0)
        for kind, file in self.files.items():
            with self.subTest(kind):
                found = room_data.read_scan(file)
                self.assertEqual(found.sensor, f"cloud_{kind}")
                self.assertTrue(found.answered.all())
                np.testing.assert_array_equal(np.diff(found.rings()), CHANNELS * [COLUMNS])
                beams = found.directions()
                for some, others in ((beams, directions), (directions, beams)):  # each direction has a beam, and each beam a direction
                    nearest = (some @ others.T).max(axis=1)
                    self.assertLess(np.sqrt(2 * (1 - np.minimum(nearest, 1))).max(), 1e-3)
                np.testing.assert_allclose(np.sort(found.points()[0], axis=0), points, atol=1e-3)

    def test_beams_that_nothing_answered(self):
        answered = np.unique(vtk_to_numpy(self.wall[1].GetOutput().GetPointData().GetArray("beam_id")))
        found = room_data.read_scan(write(self.wall[1], et.folder("ExampleRoomScansWall"), "pcd"))
        self.assertEqual(found.answered.sum(), len(answered))
        # Where no ring answers for several degrees the sensor may not have looked: these beams are not made up.
        self.assertLess(len(found.range), 0.3 * COLUMNS * CHANNELS)
        # A hole in the wall is no such place.
        hall = room_data.read_scan(self.files["pcd"])
        own = (hall.points()[0][np.abs(hall.azimuth - 100) > 2])
        azimuth, elevation, _, distance, _ = room_data.beams_of(own, np.ones(len(own)))
        self.assertEqual(np.isnan(distance).sum(), len(hall.range) - len(own))
        np.testing.assert_allclose(azimuth, hall.azimuth, atol=0.02)
        np.testing.assert_allclose(elevation, hall.elevation, atol=0.05)

    def test_poses(self):
        file, pose = self.files["pcd"], turned(30.0, (1.0, -2.0, 0.5))
        plain, moved = room_data.read_scan(file), room_data.read_scan(file, pose)
        np.testing.assert_allclose(moved.points()[0], plain.points()[0] @ pose[:3, :3].T + pose[:3, 3], atol=1e-9)
        np.testing.assert_allclose(moved.origin, pose[:3, 3])

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
        mover = al.vtkAvianLidarPCDWriter()
        pose = turned(-20.0, (0.0, 0.0, 0.0))
        moved = self.hall[1].GetOutput().NewInstance()
        moved.DeepCopy(self.hall[1].GetOutput())
        places = vtk_to_numpy(moved.GetPoints().GetData())
        places[:] = places @ np.linalg.inv(pose[:3, :3]).T
        mover.SetInputData(moved)
        mover.SetFileName(str(other))
        running.write(mover)
        poses = self.files["pcd"].with_name("poses.json")
        poses.write_text(json.dumps({"turned": {"T": pose.tolist()}}))
        scans = ("--rays", "10", "--scans", str(other), str(self.files["bin"]), "--sensors", "turned")
        self.assertGreater(self.study("all", *scans, "--poses", str(poses))["in5cm"], 0.9)
        self.assertLess(self.study("all", *scans)["in5cm"], 0.5)


if __name__ == "__main__":
    unittest.main()
