# SPDX-License-Identifier: BSD-3-Clause
"""The airport example: its files, columns and table agree with each other, and the echoes with the scene."""
import contextlib
import io
import os
import pathlib
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkAppendPolyData

import exampletools as et
import airport



class Airport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = et.folder("ExampleAirport")
        cls.scene, cls.results = airport.main(["--no-pictures", "--preset", "Airport16", "--rays", "40", "--seed", "3",
                                               "--out", cls.folder])
        cls.found = et.arrays(cls.results["Airport16"][0])

    def test_leaves_files(self):
        echoes, found = self.results["Airport16"][0], self.found
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([f"Airport16.{kind}"
                                                                  for kind in ("vtp", "csv", "las", "pcd", "geojson")]
                                                                 + ["table.csv", "table.md"]))
        self.assertEqual([et.number(echoes, name) for name in ("seed", "rays_per_beam")], [3, 40])
        table = et.read_table(os.path.join(self.folder, "table.md"))["Airport16"]
        self.assertEqual([int(table[name]) for name in ("triangles", "beams", "rays emitted", "echoes")],
                         [5510, 15360, 40 * 15360, echoes.GetNumberOfPoints()])
        self.assertEqual(sum(int(value) for key, value in table.items() if key.startswith("- ")), 15360)
        self.assertEqual(int(table["- with echoes below saturation"]) + int(table["- saturated"]),
                         len(np.unique(found["beam_id"])))
        # No beam looks down, and none higher than a cone's half-width above 25 m meets anything. The ground is 3 m
        # above the ellipsoid, which curves away below the plane by d^2/2R.
        up, sagitta = found["points"][:, 2], (found["points"][:, :2] ** 2).sum(axis=1) / (2 * 6.37e6)
        self.assertTrue(((up >= 3 - 1e-9) & (up < 25 + 5.7e-3 * found["distance_m"])).all())
        np.testing.assert_allclose(found["height"], 3 + up + sagitta, atol=0.01)

    def test_echoes_lie_on_the_surfaces(self):
        append = vtkAppendPolyData()
        for i in range(self.scene.GetNumberOfBlocks()):
            append.AddInputData(self.scene.GetBlock(i))
        append.Update()
        locator = vtkStaticCellLocator()
        locator.SetDataSet(append.GetOutput())
        locator.BuildLocator()
        nearest, cell, part, squared = [0.0] * 3, reference(0), reference(0), reference(0.0)
        off = []
        for point in self.found["points"]:
            locator.FindClosestPoint(point, nearest, cell, part, squared)
            off.append(float(squared) ** 0.5)
        # A point is the mean range of all that a beam meets in an echo, up to 11 m across at 1 km, set on its axis.
        self.assertLess(np.median(off), 0.5)
        self.assertLess(np.percentile(off, 95), 4)


class AllWall(unittest.TestCase):
    """Against another program's simulation of the same plans (all wall, brute force, double precision, 5,000 rays): it
    perceives 84 % of 1,748 beams, in 1,512 returns; the hue of Terminal 1 is 190 degrees in the median."""

    def test_numbers(self):
        _, results = airport.main(["--no-pictures", "--all-wall", "--preset", "Airport16", "--rays", "1000",
                                   "--out", et.folder("ExampleAirportWall")])
        echoes = results["Airport16"][0]
        found = et.arrays(echoes)
        self.assertAlmostEqual(len(np.unique(found["beam_id"])) / (0.84 * 1748), 1, delta=0.02)
        self.assertAlmostEqual(len(found["beam_id"]) / 1512, 1, delta=0.02)
        terminal = found["object_id"] == et.strings(echoes, "object_names").index("Terminal 1")
        self.assertAlmostEqual(np.median(found["hue"][terminal]), 190, delta=2)

    def test_hue_in_range_units_of_1_ns(self):
        # As Documentation/guide/airport.md says.
        folder = et.folder("ExampleAirportUnit")
        airport.main(["--no-pictures", "--all-wall", "--preset", "Airport16", "--unit", "1", "--rays", "100", "--out",
                      folder])
        rows = et.read_table(os.path.join(folder, "table.md"))["Airport16"]
        self.assertAlmostEqual(int(rows["median hue of Terminal 1 (deg)"]), 228, delta=2)


class Documentation(unittest.TestCase):
    def test_numbers_of_the_page(self):
        folder = et.folder("ExampleAirportPage")
        airport.main(["--no-pictures", "--out", folder])
        et.assert_documented(self, et.read_table(os.path.join(folder, "table.md")), "airport")


class Arguments(unittest.TestCase):
    def test_bad_arguments_end_with_one_line_and_no_files(self):
        out = pathlib.Path(et.folder("ExampleBadArguments"), "out")
        for option, value in (("--rays", "0"), ("--rays", "many"), ("--threads", "-1"), ("--seed", "99999999999"),
                              ("--scene", "no-such-scene.json")):
            with contextlib.redirect_stderr(io.StringIO()) as said, self.assertRaises(SystemExit) as end:
                airport.main(["--no-pictures", option, value, "--out", str(out)])
            self.assertEqual((end.exception.code, said.getvalue().count("\n"), out.exists()), (2, 1, False))
            self.assertRegex(said.getvalue(), f"{option}.*{value}")
        page = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "README.md")
        # Python prints it, returns 1
        with self.assertRaisesRegex(SystemExit, r"\A.*README.md: (is not JSON|.*No suitable reader).*\Z"):
            airport.main(["--no-pictures", "--scene", page, "--out", str(out)])
        self.assertFalse(out.exists())
