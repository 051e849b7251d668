# SPDX-License-Identifier: BSD-3-Clause
"""The echoes that a C++ program wrote are those of the Python package. Arguments: scene, echoes.vtp, visibility (m)."""
import sys

import numpy as np

import avianlidar as al

scene, file, visibility = sys.argv[1:]
found = al.load_cloud(file)
scan = al.Scan(al.load_scene(scene), al.Sensor("Airport16", position=al.load_scene(scene).lidar_position),
               visibility=float(visibility))
wanted = scan.echoes
assert wanted.number_of_points > 1000
np.testing.assert_array_equal(found.points, wanted.points)
for name in wanted:
    np.testing.assert_array_equal(found[name], wanted[name], name)
assert float(found.fields["attenuation_coefficient"]) != 3.5e-5
