# SPDX-License-Identifier: BSD-3-Clause
"""A sequence as one time series: which scan at which time, poses, labels, boxes, and what is refused."""
import os
import shutil

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

from avianlidar.vtkAvianLidar import vtkAvianLidarSequenceReader
from cloudtools import pose_line, read_error, write_sequence
from echotools import InFolder, Messages

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # a quarter to the left
SHIFT = np.array([100.0, 200.0, 3.0])
SCANS = [np.array([[10, 1, 0.5, 0.2], [20, -2, 1, 0.4]], "<f4"), np.array([[30, 3, 2, 0.6]], "<f4"),
         np.zeros((0, 4), "<f4")]
TIMES = (0.0, 0.5, 2.0)


class Sequence(InFolder):
    def setUp(self):
        super().setUp()
        write_sequence(self.folder, [(points, np.full(len(points), (7 << 16) + 99, "<u4")) for points in SCANS], TIMES,
                       pose_line(TURN, SHIFT))
        os.mkdir("boxes")
        self.write("boxes/000001.txt", "bird 0.00 0.00 30 3 2 2.0 1.0 0.5 0.5 10000 1\n")

    def write(self, name, text):
        (self.folder / name).write_text(text, "utf-8")

    def reader(self):
        reader = vtkAvianLidarSequenceReader()
        reader.SetFileName(os.path.join(self.folder, "times.txt"))
        return reader

    def at(self, reader, time):
        reader.UpdateTimeStep(time)
        return reader.GetOutputDataObject(0), reader.GetOutputDataObject(1)

    def test_each_scan_at_its_time_where_its_pose_puts_it(self):
        reader = self.reader()
        reader.UpdateInformation()
        for port in (0, 1):
            self.assertEqual(reader.GetOutputInformation(port).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()),
                             TIMES)
        for time, scan in ((0.0, 0), (0.4, 0), (0.5, 1), (1.9, 1), (2.0, 2), (9.0, 2), (-1.0, 0)):
            points, _ = self.at(reader, time)
            self.assertEqual(points.GetNumberOfPoints(), len(SCANS[scan]), time)
            if len(SCANS[scan]):
                expected = SCANS[scan][:, :3].astype(float) @ TURN.T + SHIFT
                np.testing.assert_allclose(vtk_to_numpy(points.GetPoints().GetData()), expected, atol=1e-9)
                data = points.GetPointData()
                self.assertEqual(data.GetScalars().GetName(), "semantic_label")
                self.assertEqual({data.GetArray("semantic_label").GetTuple1(0),
                                  data.GetArray("instance_id").GetTuple1(0)}, {99, 7})

    def test_a_calibration_turns_the_poses(self):
        """KITTI's poses are of the camera: Tr carries points to it, and back."""
        tr = np.column_stack([np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]), [0.1, 0.2, 0.3]])
        self.write("calib.txt", "Tr: " + " ".join(map(repr, tr.ravel().tolist())) + "\n")
        points, _ = self.at(self.reader(), 0.0)
        camera = SCANS[0][:, :3].astype(float) @ tr[:, :3].T + tr[:, 3]
        moved = camera @ TURN.T + SHIFT
        np.testing.assert_allclose(vtk_to_numpy(points.GetPoints().GetData()), (moved - tr[:, 3]) @ tr[:, :3],
                                   atol=1e-9)

    def test_boxes(self):
        reader = self.reader()
        self.assertEqual(self.at(reader, 0.0)[1].GetNumberOfCells(), 0)
        points, boxes = self.at(reader, 0.5)
        self.assertEqual((boxes.GetNumberOfCells(), boxes.GetNumberOfPoints()), (6, 8))
        c, s = np.cos(0.5), np.sin(0.5)
        corners = [(30 + x * c - y * s, 3 + x * s + y * c, 2 + z) for x in (-1, 1) for y in (-0.5, 0.5)
                   for z in (-0.25, 0.25)]
        found = vtk_to_numpy(boxes.GetPoints().GetData())
        np.testing.assert_allclose(np.sort(found, axis=0), np.sort(np.array(corners) @ TURN.T + SHIFT, axis=0),
                                   atol=1e-9)
        self.assertEqual([data.GetInformation().Get(vtkDataObject.DATA_TIME_STEP()) for data in (points, boxes)],
                         [0.5, 0.5])
        data = boxes.GetCellData()
        self.assertEqual((data.GetAbstractArray("object").GetValue(0), data.GetArray("object_id").GetValue(5)),
                         ("bird", 10000))

    def test_lines_of_white_space_alone(self):
        self.write("times.txt", "0\n\f\n0.5\n\v\n2\n \t\r\n")
        self.write("calib.txt", "\v\nTr: 1 0 0 0 0 1 0 0 0 0 1 0\n")
        points, _ = self.at(self.reader(), 0.5)
        np.testing.assert_allclose(points.GetPoint(0), SCANS[1][0, :3].astype(float) @ TURN.T + SHIFT, atol=1e-9)

    def test_wrong_sequences_are_refused(self):
        for name, text, said in (
                ("times.txt", "0\n0\n", "the time in line 2 of times.txt is not above the one before"),
                ("times.txt", "\n", "no time in it"), ("times.txt", "zero\n", 'has "zero", expected a number'),
                ("times.txt", "0\n1\n2\n3\n", "000003.bin"),
                ("poses.txt", "1 2 3\n", "line 1 of poses.txt has 3 numbers"),
                ("poses.txt", "\nnan 0 0 0 0 1 0 0 0 0 1 0\n",
                 'line 2 of poses.txt has "nan", expected a finite number'),
                ("calib.txt", "\v\nTr: inf 0 0 0 0 1 0 0 0 0 1 0\n", 'line 2 of calib.txt has "inf"'),
                ("boxes/000000.txt", "bird 1\n", "line 1 of 000000.txt has 2 words, expected the 12 of a box"),
                ("boxes/000000.txt", "bird 0 0 1 2 3 1 1 1 0 1e300 1\n", "expected a whole number of 32 bits")):
            with self.subTest(said):
                self.setUp()
                self.write(name, text)
                if "000003" in said:
                    reader = self.reader()
                    messages = Messages(reader)
                    reader.UpdateTimeStep(3.0)
                    self.assertEqual(reader.GetOutputDataObject(0).GetNumberOfPoints(), 0)
                    self.assertIn(said, messages.errors[0])
                else:
                    self.assertIn(said, read_error(os.path.join(self.folder, "times.txt")))
        self.assertIn("No such file", read_error(os.path.join(self.folder, "none.txt")))
        can = vtkAvianLidarSequenceReader.CanReadFile
        times, poses = (os.path.join(self.folder, name) for name in ("times.txt", "poses.txt"))
        self.assertEqual((can(times), can(poses)), (1, 0))
        shutil.rmtree(os.path.join(self.folder, "velodyne"))
        self.assertEqual(can(times), 0)
        reader = vtkAvianLidarSequenceReader()
        messages = Messages(reader)
        reader.Update()
        self.assertIn("FileName is not set", messages.errors[0])
