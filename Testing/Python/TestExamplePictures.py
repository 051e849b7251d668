# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the examples against baselines (Testing/Data/Baseline/Example*.png)."""
import os
import unittest

import numpy as np
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkImagingCore import vtkImageDifference, vtkImageExtractComponents

import exampletools as et
import airport
import birds_over_airport
import corridor

# As VTK's tests: the sum of differences that no shift by a pixel explains.
THRESHOLD = 10


def distance(place, way):
    """Of a point from a polyline."""
    begin, along = way[:-1], np.diff(way, axis=0)
    share = np.clip(((place - begin) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-12), 0, 1)
    return np.linalg.norm(begin + share[:, None] * along - place, axis=1).min()


def image(file):
    reader = vtkPNGReader()
    reader.SetFileName(file)
    colours = vtkImageExtractComponents()  # VTK 9.1 compares no pictures with transparency
    colours.SetInputConnection(reader.GetOutputPort())
    colours.SetComponents(0, 1, 2)
    colours.Update()
    return colours.GetOutput()


class Pictures(unittest.TestCase):
    def compare(self, file, name):
        baseline = os.path.join(os.environ["AVIANLIDAR_BASELINE_DIR"], name + ".png")
        self.assertTrue(os.path.exists(baseline), f"no baseline {baseline}; this picture is {file}")
        difference = vtkImageDifference()
        difference.SetInputData(image(file))
        difference.SetImageData(image(baseline))
        difference.Update()
        self.assertLessEqual(difference.GetThresholdedError(), THRESHOLD, f"{file} against {baseline}")

    def test_airport(self):
        folder = et.folder("ExamplePicturesAirport")
        airport.main(["--out", folder])
        for view in ("top", "close", "range"):
            self.compare(os.path.join(folder, f"Airport16-{view}.png"), f"ExampleAirport-{view}")
        self.compare(os.path.join(folder, "Airport32-close.png"), "ExampleAirport32-close")

    def test_corridor(self):
        folder = et.folder("ExamplePicturesCorridor")
        corridor.main(["--out", folder])
        for view in ("door", "stairwell", "corridor", "top", "range"):
            self.assertTrue(os.path.exists(os.path.join(folder, view + ".png")))
        for view in ("door", "stairwell", "corridor"):
            self.compare(os.path.join(folder, view + ".png"), f"ExampleCorridor-{view}")

    def test_birds_over_airport(self):
        folder = et.folder("ExamplePicturesBirds")
        made = birds_over_airport.main(["--scans", "2", "--shown", "2", "--out", folder])
        self.compare(os.path.join(folder, "from-above.png"), "ExampleBirds-from-above")
        truth = made["truth"]
        self.assertEqual(len(truth["scan"]), 2 * len(made["species"]))
        self.assertEqual(sum(map(len, made["trails"].values())), len(made["species"]))
        # A bird that is seen lies on its way.
        seen = (truth["status"] == "seen") & (truth["species"] == "crow")
        self.assertTrue(seen.any())
        for k in seen.nonzero()[0]:
            place = [float(truth[name][k]) for name in ("x_m", "y_m")]
            self.assertLess(min(distance(place, way) for way in made["trails"]["crow"]), 0.01)


if __name__ == "__main__":
    unittest.main()
