# SPDX-License-Identifier: BSD-3-Clause
"""The beam report as a map: azimuth by elevation of status, cost and what was left out, from the report itself."""
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

import echotools
from avianlidar import vtkAvianLidar as al

TOWN = echotools.town(count=20)
LABELS = ("laser_id", "azimuth", "vertical_angle")


def image_of(echo, beams):
    """The range image as {name: rows by columns}; beams are what is given, or the report."""
    image = al.vtkAvianLidarRangeImage()
    image.SetInputConnection(0, echo.GetOutputPort())
    image.SetInputConnection(1, beams)
    image.Update()
    data = image.GetOutput()
    columns, rows, _ = data.GetDimensions()
    points = data.GetPointData()
    return {points.GetArrayName(i): numpy_support.vtk_to_numpy(points.GetArray(i)).reshape(rows, columns).copy()
            for i in range(points.GetNumberOfArrays())}


class BeamMap(unittest.TestCase):
    def test_report_has_the_angles_of_its_beams(self):
        lidar = echotools.sensor()
        lidar.SetOrientation(10.0, 3.0, -2.0)
        echo = echotools.scan(TOWN, lidar)
        echo.Update()
        report = echotools.arrays(echo.GetOutput(1))
        for name in LABELS:
            np.testing.assert_array_equal(report[name], echotools.array(lidar.GetOutput(), name), name)

    def test_other_labels_of_the_same_beams(self):
        lidar = echotools.sensor()
        lidar.Update()
        beams = vtk.vtkPolyData()
        beams.DeepCopy(lidar.GetOutput())
        echo = echotools.scan(TOWN, beams)
        echo.Update()
        before = [echo.GetOutput(1).GetPointData().GetArray(name) for name in LABELS]
        for name in LABELS:
            array = beams.GetPointData().GetArray(name)
            array.SetComponent(5, 0, 17.0)
            array.Modified()
        beams.Modified()
        echo.Update()
        for name, old in zip(LABELS, before):
            self.assertEqual(echo.GetOutput(1).GetPointData().GetArray(name).GetComponent(5, 0), 17.0)
            self.assertNotEqual(old.GetComponent(5, 0), 17.0)
        self.assertEqual(echo.GetNumberOfTracedRays(), 0)

    def test_beams_without_angles(self):
        lidar = echotools.sensor()
        lidar.Update()
        bare = vtk.vtkPolyData()
        bare.DeepCopy(lidar.GetOutput())
        for name in LABELS:
            bare.GetPointData().RemoveArray(name)
        echo = echotools.scan(TOWN, bare)
        echo.Update()
        report = echotools.arrays(echo.GetOutput(1))
        for name in LABELS[1:]:
            np.testing.assert_allclose(report[name], echotools.array(lidar.GetOutput(), name), atol=1e-8)

    def test_map_has_the_image_and_the_report(self):
        for orientation in ((0.0, 0.0, 0.0), (20.0, 5.0, -3.0)):
            lidar = echotools.sensor()
            lidar.SetOrientation(*orientation)
            echo = echotools.scan(TOWN, lidar)
            plain = image_of(echo, lidar.GetOutputPort())
            found = image_of(echo, echo.GetOutputPort(1))
            self.assertEqual(sorted(plain), ["distance_m", "energy", "object_id"])
            for name, values in plain.items():
                self.assertEqual(found[name].tobytes(), values.tobytes(), name)
            report = echotools.arrays(echo.GetOutput(1))
            names = ("status", "candidates", "nodes_visited", "rays_traced", "skipped", "skipped_bound")
            self.assertEqual(sorted(set(found) - set(plain)), sorted(names))
            columns, rows = 90, 4
            cell = report["beam_id"] // rows + columns * report["laser_id"]
            for name in names:
                np.testing.assert_array_equal(found[name].ravel()[cell], report[name], name)
            echoes = np.isfinite(found["distance_m"])
            np.testing.assert_array_equal(echoes, np.isin(found["status"], (0, 3)))
            self.assertTrue(echoes.any() and not echoes.all())


if __name__ == "__main__":
    unittest.main()
