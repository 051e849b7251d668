# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the examples against baselines (Testing/Data/Baseline/Example*.png)."""
import json
import os
import unittest

import numpy as np
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
from vtkmodules.vtkImagingCore import vtkImageDifference, vtkImageExtractComponents

import exampletools as et
import airport
import airport_search
import airport_time
import birds_over_airport
import corridor
import paper

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
        if difference.GetThresholdedError() > THRESHOLD:
            writer = vtkPNGWriter()
            writer.SetInputConnection(difference.GetOutputPort())
            writer.SetFileName(os.path.join(et.OUTPUT, name + ".difference.png"))
            writer.Write()
        self.assertLessEqual(difference.GetThresholdedError(), THRESHOLD, f"{file} against {baseline}")

    def test_airport(self):
        folder = et.folder("ExamplePicturesAirport")
        airport.main(["--out", folder])
        for view in ("top", "close", "range"):
            self.compare(os.path.join(folder, f"Airport16-{view}.png"), f"ExampleAirport-{view}")
        self.compare(os.path.join(folder, "Airport32-close.png"), "ExampleAirport32-close")

    def test_sweep(self):
        folder = et.folder("ExamplePicturesTime")
        airport_time.main(["--revolutions", "3", "--out", folder])
        self.compare(os.path.join(folder, "sweep.png"), "ExampleTime-sweep")

    def test_search(self):
        folder = et.folder("ExamplePicturesSearch")
        airport_search.main(["--out", folder])
        for name in ("tree", "status"):
            self.compare(os.path.join(folder, name + ".png"), f"ExampleSearch-{name}")
        self.assertTrue(os.path.exists(os.path.join(folder, "cost.png")))

    def test_corridor(self):
        folder = et.folder("ExamplePicturesCorridor")
        corridor.main(["--out", folder])
        for view in ("door", "stairwell", "corridor", "top", "range"):
            self.assertTrue(os.path.exists(os.path.join(folder, view + ".png")))
        for view in ("door", "stairwell", "corridor"):
            self.compare(os.path.join(folder, view + ".png"), f"ExampleCorridor-{view}")

    def test_paper(self):
        folder = et.folder("ExamplePicturesPaper")
        paper.main(["--reference-rays", "100", "--seeds", "1", "--out", folder])
        self.compare(os.path.join(folder, "facade.png"), "ExamplePaper-facade")

    def test_birds_over_airport(self):
        folder = et.folder("ExamplePicturesBirds")
        made = birds_over_airport.main(["--scans", "2", "--shown", "2", "--out", folder])
        for name in ("from-above.png", "range-image.png", "points.png", "birds-over-airport.md"):
            self.assertTrue(os.path.exists(os.path.join(folder, name)), name)
        self.compare(os.path.join(folder, "from-above.png"), "ExampleBirds-from-above")
        truth = made["truth"]
        self.assertEqual(len(truth["scan"]), 2 * len(made["species"]))
        self.assertEqual(sum(map(len, made["trails"].values())), len(made["species"]))
        self.assertGreater((truth["status"] == "seen").sum(), len(made["species"]) / 2)
        # A bird that is seen lies on its way.
        seen = (truth["status"] == "seen") & (truth["species"] == "crow")
        for k in seen.nonzero()[0]:
            place = [float(truth[name][k]) for name in ("x_m", "y_m")]
            self.assertLess(min(distance(place, way) for way in made["trails"]["crow"]), 0.01)

    def test_no_echoes(self):
        # Flat ground alone is never perceived; the pictures are there all the same.
        folder = et.folder("ExamplePicturesNoEchoes")
        file = os.path.join(folder, "ground.lidarscene.json")
        with open(file, "w", encoding="utf-8") as stream:
            json.dump({"version": 1, "origin": {"latitude": 31, "longitude": 121, "height": 0},
                       "lidar": {"position": [0, 0, 3]},
                       "objects": [{"name": "Ground", "class": "ground", "ground": {"size": 5000, "height": 0},
                                    "material": "Wall"}]}, stream)
        _, results = airport.main(["--scene", file, "--preset", "Airport16", "--out", folder])
        self.assertEqual(results["Airport16"][0].GetNumberOfPoints(), 0)
        for view in ("top", "close", "range"):
            self.assertEqual(image(os.path.join(folder, f"Airport16-{view}.png")).GetPointData().GetNumberOfArrays(), 1)


if __name__ == "__main__":
    unittest.main()
