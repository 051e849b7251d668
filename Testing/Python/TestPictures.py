# SPDX-License-Identifier: BSD-3-Clause
"""The comparison of pictures sees, in each baseline, a hue that is 5 degrees off and a shift by 2 pixels.

Testing/Faults/pictures.py plants what needs pictures drawn again."""
import os
import pathlib
import unittest

import numpy as np
from matplotlib.colors import hsv_to_rgb, rgb_to_hsv
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

from pictures import MOST, colours_of, difference

BASELINES = sorted(pathlib.Path(os.environ["AVIANLIDAR_BASELINE_DIR"]).glob("*.png"))


def as_array(image):
    columns, rows, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, 3)


def as_image(colours):
    image = vtkImageData()
    image.SetDimensions(colours.shape[1], colours.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(colours.reshape(-1, 3)), deep=True))
    return image


def turned(colours, degrees):
    """The colours with another hue."""
    codes, place = np.unique(colours.astype(np.uint32) @ (65536, 256, 1), return_inverse=True)
    hsv = rgb_to_hsv(np.stack([codes // 65536, codes // 256 % 256, codes % 256], axis=-1) / 255.0)
    hsv[..., 0] = (hsv[..., 0] + degrees / 360.0) % 1.0
    return np.round(255.0 * hsv_to_rgb(hsv)).astype(np.uint8)[place].reshape(colours.shape)


class Planted(unittest.TestCase):
    def test_each_baseline_shows_hue_and_shift(self):
        self.assertGreater(len(BASELINES), 10)
        for file in BASELINES:
            picture = colours_of(str(file))
            colours = as_array(picture)
            for change, other in {"hue": turned(colours, 5.0), "to the right": np.roll(colours, 2, axis=1),
                                  "upwards": np.roll(colours, 2, axis=0)}.items():
                with self.subTest(file=file.name, change=change):
                    self.assertGreater(difference(as_image(other), picture).GetThresholdedError(), 2.0 * MOST)

