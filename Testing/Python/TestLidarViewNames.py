# SPDX-License-Identifier: BSD-3-Clause
"""Arrays that LidarView has, too, carry its names and units, whether simulated or read.

The list is frozen from LidarView's source, IO/Lidar/Velodyne/vtkVelodynePacketInterpreter.cxx (CreateNewEmptyFrame and
PushFiringData, also in VeloView; Apache-2.0): azimuth counts hundredths of a degree below 36000, vertical_angle is in
degrees, distance_m in metres, timestamp counts microseconds, intensity goes to 255, laser_id counts from 0. Its other
arrays (X, Y, Z, adjustedtime, distance_raw, dual_*) have no counterpart here."""

import os

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import echoes, names, points, read, unit, write
from echotools import array, sensor

LIDARVIEW = {"azimuth": "0.01 deg", "vertical_angle": "deg", "distance_m": "m", "timestamp": "us", "intensity": "1",
             "laser_id": None}

data = echoes(orientation=(0.0, 0.0, 0.0))
for name, its in LIDARVIEW.items():
    assert name in names(data), name
    assert unit(data, name) == its, (name, unit(data, name))

beams = sensor()
beams.Update()
for name in ("azimuth", "vertical_angle", "timestamp", "laser_id"):
    assert unit(beams.GetOutput(), name) == LIDARVIEW[name], name

# What the units mean.
turn = array(beams.GetOutput(), "azimuth")
assert turn.min() == 0 and 35000 < turn.max() < 36000
assert array(beams.GetOutput(), "vertical_angle").max() == 3.0
assert 1e5 < array(beams.GetOutput(), "timestamp").max() < 2e6  # one turn takes two seconds
assert array(beams.GetOutput(), "laser_id").min() == 0
assert array(data, "intensity").max() <= 255
away = points(data) - (10, 20, 3)
np.testing.assert_allclose(array(data, "distance_m"), np.linalg.norm(away, axis=1), rtol=1e-12)
np.testing.assert_allclose(np.radians(array(data, "azimuth") / 100), np.arctan2(away[:, 0], away[:, 1]) % (2 * np.pi),
                           rtol=0, atol=1e-9)

# The same through files: what is computed on reading is what was simulated.
for writer, name in ((al.vtkAvianLidarPCDWriter(), "TestLidarViewNames.pcd"),
                     (al.vtkAvianLidarLASWriter(), "TestLidarViewNames.las")):
    write(writer, data, name)
    again = read(name)
    os.remove(name)
    for array_name, its in LIDARVIEW.items():
        assert unit(again, array_name) == its, (name, array_name, unit(again, array_name))
        np.testing.assert_allclose(array(again, array_name), array(data, array_name), rtol=1e-6, atol=1 / 257)
with open("TestLidarViewNames.pcd", "w", encoding="ascii") as file:
    file.write("FIELDS x y z intensity ring\nSIZE 4 4 4 4 2\nTYPE F F F F U\nWIDTH 4\nHEIGHT 1\nDATA ascii\n"
               "0 2 0 1 0\n2 0 0 2 1\n0 -2 0 3 2\n-2 0 2 255 3\n")
plain = read("TestLidarViewNames.pcd")
os.remove("TestLidarViewNames.pcd")
assert array(plain, "azimuth").tolist() == [0, 9000, 18000, 27000]
np.testing.assert_allclose(array(plain, "vertical_angle"), [0, 0, 0, 45], rtol=1e-15)
np.testing.assert_allclose(array(plain, "distance_m"), [2, 2, 2, 8**0.5], rtol=1e-15)
assert array(plain, "laser_id").tolist() == [0, 1, 2, 3]
for array_name, its in LIDARVIEW.items():
    if array_name != "timestamp":
        assert unit(plain, array_name) == its, array_name
