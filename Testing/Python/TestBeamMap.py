# SPDX-License-Identifier: BSD-3-Clause
"""The beam report as a map: azimuth by elevation of status, cost and what was left out, from the report itself."""
import unittest

import numpy as np

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
    points = image.GetOutput().GetPointData()
    names = [points.GetArrayName(i) for i in range(points.GetNumberOfArrays())]
    return {name: echotools.array(image.GetOutput(), name).reshape(4, 90).copy() for name in names}


class BeamMap(unittest.TestCase):
    def test_report_has_the_labels_of_its_beams(self):
        """And angles of beams that have no labels."""
        lidar = echotools.sensor()
        lidar.Update()
        beams = echotools.copy_of(lidar.GetOutput())
        echo = echotools.scan(TOWN, beams)
        echo.Update()
        for name in LABELS:
            np.testing.assert_array_equal(echotools.arrays(echo.GetOutput(1))[name], echotools.array(beams, name), name)
            beams.GetPointData().RemoveArray(name)
        echo.Update()
        for name in LABELS[1:]:
            np.testing.assert_allclose(echotools.arrays(echo.GetOutput(1))[name], echotools.array(lidar.GetOutput(), name), atol=1e-8)

    def test_map_has_the_image_and_the_report(self):
        for orientation in ((0.0, 0.0, 0.0), (20.0, 5.0, -3.0)):
            lidar = echotools.sensor()
            lidar.SetOrientation(*orientation)
            echo = echotools.scan(TOWN, lidar)
            plain, found = image_of(echo, lidar.GetOutputPort()), image_of(echo, echo.GetOutputPort(1))
            self.assertEqual(sorted(plain), ["distance_m", "energy", "object_id"])
            for name, values in plain.items():
                self.assertEqual(found[name].tobytes(), values.tobytes(), name)
            report = echotools.arrays(echo.GetOutput(1))
            names = {"status", "candidates", "nodes_visited", "rays_traced", "skipped", "skipped_bound"}
            self.assertEqual(set(found) - set(plain), names)
            cell = report["beam_id"] // 4 + 90 * report["laser_id"]
            for name in names:
                np.testing.assert_array_equal(found[name].ravel()[cell], report[name], name)
            echoes = np.isfinite(found["distance_m"])
            np.testing.assert_array_equal(echoes, np.isin(found["status"], (0, 3)))
            self.assertTrue(echoes.any() and not echoes.all())


if __name__ == "__main__":
    unittest.main()
