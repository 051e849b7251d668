# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the examples against baselines (Testing/Data/Baseline/Example*.png)."""
import os
import unittest

import exampletools as et
import airport
import birds_over_airport
import corridor
from pictures import compare


class Pictures(unittest.TestCase):
    def test_airport(self):
        folder = et.folder("ExamplePicturesAirport")
        airport.main(["--out", folder])
        for view in ("top", "close", "range"):
            compare(os.path.join(folder, f"Airport16-{view}.png"), f"ExampleAirport-{view}.png")
        compare(os.path.join(folder, "Airport32-close.png"), "ExampleAirport32-close.png")

    def test_corridor(self):
        folder = et.folder("ExamplePicturesCorridor")
        corridor.main(["--out", folder])
        for view in ("door", "stairwell", "corridor", "top", "range"):
            self.assertTrue(os.path.exists(os.path.join(folder, view + ".png")))
        for view in ("door", "stairwell", "corridor"):
            compare(os.path.join(folder, view + ".png"), f"ExampleCorridor-{view}.png")

    def test_preset_paper(self):
        """By the method of the paper, with its random rays and Eq. 13."""
        for name, example, picture in (("Airport", airport, "Airport16-close"), ("Corridor", corridor, "door")):
            folder = et.folder("ExamplePicturesPaper" + name)
            example.main(["--paper", "--out", folder, *(["--preset", "Airport16"] if example is airport else [])])
            compare(os.path.join(folder, picture + ".png"), f"ExamplePaper-{name.lower()}.png")

    def test_birds_over_airport(self):
        folder = et.folder("ExamplePicturesBirds")
        birds_over_airport.main(["--scans", "2", "--shown", "2", "--out", folder])
        for name in ("from-above", "range"):
            compare(os.path.join(folder, f"{name}.png"), f"ExampleBirds-{name}.png")
