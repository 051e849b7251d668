# SPDX-License-Identifier: BSD-3-Clause
"""The airport example: its files, columns and table agree with each other, and the echoes with the scene."""
import json
import os
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkAppendPolyData

import exampletools as et
import airport
import airport_search
import airport_time
from avianlidar.vtkAvianLidar import vtkAvianLidarPointCloudReader

SENSORS = {"Airport16": 960 * 16, "Airport32": 1920 * 32}


class Airport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = et.folder("ExampleAirport")
        cls.scene, cls.results = airport.main(["--no-pictures", "--rays", "40", "--seed", "3", "--out", cls.folder])
        cls.found = {name: et.arrays(result[0]) for name, result in cls.results.items()}

    def test_both_sensors_leave_files(self):
        self.assertEqual(list(self.results), list(SENSORS))
        self.assertEqual(sorted(os.listdir(self.folder)),
                         sorted([f"{name}.{kind}" for name in SENSORS for kind in ("vtp", "csv", "las", "pcd", "geojson")] + ["table.csv", "table.md"]))

    def test_vtp_has_everything(self):
        for name, (echoes, _, _) in self.results.items():
            written = et.read(os.path.join(self.folder, name + ".vtp"))
            for array, values in et.arrays(echoes).items():
                np.testing.assert_array_equal(et.arrays(written)[array], values, array)
            self.assertEqual(et.number(written, "seed"), 3)
            self.assertEqual(et.number(written, "rays_per_beam"), 40)
            self.assertEqual(et.strings(written, "object_names"), et.strings(self.scene, "object_names"))

    def test_las_and_pcd_have_every_echo(self):
        for name, (echoes, _, _) in self.results.items():
            for kind in ("las", "pcd"):
                reader = vtkAvianLidarPointCloudReader()
                reader.SetFileName(os.path.join(self.folder, f"{name}.{kind}"))
                reader.Update()
                written, found = et.arrays(reader.GetOutput()), self.found[name]
                np.testing.assert_allclose(written["points"], found["points"], rtol=0, atol=2e-4)
                np.testing.assert_array_equal(written["energy"], found["energy"])
                np.testing.assert_array_equal(written["rgb"], found["rgb"])
            with open(os.path.join(self.folder, f"{name}.geojson"), encoding="utf-8") as file:
                self.assertEqual(len(json.load(file)["features"]), echoes.GetNumberOfPoints())

    def test_csv_has_15_digits(self):
        for name, found in self.found.items():
            file = os.path.join(self.folder, name + ".csv")
            with open(file, encoding="utf-8") as stream:
                header = stream.readline().strip().split(",")
            self.assertEqual(header[:4], ["x [m]", "y [m]", "z [m]", "energy [J]"])
            self.assertTrue({"longitude [deg]", "latitude [deg]", "height [m]", "hue [deg]"} < set(header))
            rows = dict(zip(header, np.loadtxt(file, delimiter=",", skiprows=1).T))
            for column, values in rows.items():
                key = column.split(" [")[0]
                name, _, part = key.rpartition("_")
                wanted = found["points"][:, "xyz".index(key)] if key in "xyz" else \
                    found[name][:, int(part)] if part.isdigit() else found[key]
                np.testing.assert_allclose(values, wanted, rtol=1e-14, atol=1e-300, err_msg=column)
            # An error in the last digit of a longitude is far below a micrometre.
            self.assertLess(abs(rows["longitude [deg]"] - found["longitude"]).max() * 111e3, 1e-6)

    def test_echoes_are_at_the_airport(self):
        for found in self.found.values():
            self.assertTrue(((found["longitude"] > 121.31) & (found["longitude"] < 121.37)).all())
            self.assertTrue(((found["latitude"] > 31.17) & (found["latitude"] < 31.23)).all())
            # No beam looks down, and none higher than a cone's half-width above 25 m meets anything.
            up = found["points"][:, 2]
            self.assertTrue(((up >= 3 - 1e-9) & (up < 25 + 5.7e-3 * found["distance_m"])).all())
            # The ground is 3 m above the ellipsoid, which curves away below the plane by d^2/2R.
            sagitta = (found["points"][:, :2] ** 2).sum(axis=1) / (2 * 6.37e6)
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
        for point in self.found["Airport16"]["points"]:
            locator.FindClosestPoint(point, nearest, cell, part, squared)
            off.append(float(squared) ** 0.5)
        # A point is the mean range of all that a beam meets in an echo, up to 11 m across at 1 km, set on its axis.
        self.assertLess(np.median(off), 0.5)
        self.assertLess(np.percentile(off, 95), 4)

    def test_numbers_of_echoes(self):
        self.assertTrue(1450 < len(self.found["Airport16"]["points"]) < 1850)
        self.assertTrue(5700 < len(self.found["Airport32"]["points"]) < 7400)
        for found in self.found.values():
            self.assertTrue((found["energy"] > 2e-6).all())
            self.assertTrue((found["energy"] <= 6.25e-5).all())

    def test_table_agrees(self):
        table = et.read_table(os.path.join(self.folder, "table.md"))
        self.assertEqual(list(table), list(SENSORS))
        for name, rows in table.items():
            self.assertEqual(int(rows["triangles"]), 5510)
            self.assertEqual(int(rows["beams"]), SENSORS[name])
            parts = [int(rows[key]) for key in rows if key.startswith("- ")]
            self.assertEqual(sum(parts), SENSORS[name])
            self.assertEqual(int(rows["rays emitted"]), 40 * SENSORS[name])
            # Most beams are integrated or meet nothing.
            self.assertGreater(int(rows["rays traced"]), 0)
            self.assertLess(int(rows["rays traced"]), 0.2 * int(rows["rays emitted"]))
            self.assertEqual(int(rows["echoes"]), len(self.found[name]["points"]))
            seen = int(rows["- with echoes below saturation"]) + int(rows["- saturated"])
            self.assertEqual(seen, len(np.unique(self.found[name]["beam_id"])))
            stages = ("read the scene", "build the tree", "beams", "trace and light", "colour, coordinates", "write")
            for stage in stages:
                self.assertGreaterEqual(float(rows[stage + " (s)"]), 0)

    def test_range_image(self):
        for name, (_, _, image) in self.results.items():
            seen = np.isfinite(image["distance_m"])
            self.assertEqual(seen.size, SENSORS[name])
            self.assertEqual(seen.sum(), len(np.unique(self.found[name]["beam_id"])))


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
        # As Documentation/airport.md says.
        for rays, hue in ((100, 228), (1000, 228)):
            folder = et.folder("ExampleAirportUnit")
            airport.main(["--no-pictures", "--all-wall", "--preset", "Airport16", "--unit", "1", "--rays", str(rays),
                          "--out", folder])
            rows = et.read_table(os.path.join(folder, "table.md"))["Airport16"]
            self.assertAlmostEqual(int(rows["median hue of Terminal 1 (deg)"]), hue, delta=2)


class Documentation(unittest.TestCase):
    def test_numbers_of_the_page(self):
        folder = et.folder("ExampleAirportPage")
        airport.main(["--no-pictures", "--out", folder])
        et.assert_documented(self, et.read_table(os.path.join(folder, "table.md")), "airport.md", "airport")

    def test_numbers_of_the_page_on_collision_detection(self):
        folder = et.folder("ExampleAirportSearch")
        airport_search.main(["--no-pictures", "--out", folder])
        table = et.read_table(os.path.join(folder, "search.md"))
        et.assert_documented(self, table, "collision-detection.md", "search")
        self.assertEqual(table["boxes"]["0"], "1")


    def test_numbers_of_the_page_on_time(self):
        folder = et.folder("ExampleAirportTime")
        frames = airport_time.main(["--no-pictures", "--out", folder])
        et.assert_documented(self, et.read_table(os.path.join(folder, "time.md")), "time.md", "time")
        self.assertEqual(len(frames), 72)
        self.assertEqual(sum(traced for _, _, (traced, _) in frames), 15360)
        self.assertEqual(sum(traced for _, _, (traced, _) in frames[12:]), 0)
        for number, (time, echoes, _) in enumerate(frames):
            written = et.read(os.path.join(folder, f"echoes_{number:04d}.vtp"))
            self.assertEqual(et.number(written, "TimeValue"), time)
            self.assertEqual(et.number(written, "revolution"), number // 12)
            np.testing.assert_array_equal(et.arrays(written)["energy"], et.arrays(echoes)["energy"])
        for number in range(11, 72, 12):  # whole scans
            self.assert_seen_in_time(frames[number][1])

    def assert_seen_in_time(self, echoes):
        """Echoes of the aircraft lie within it, where it is at the time of each, but for the width of beam and pulse."""
        mine = airport_time.of_aircraft(echoes)
        self.assertGreater(mine.sum(), 20)
        north = et.arrays(echoes)["points"][mine, 1] - echoes.GetFieldData().GetArray("position").GetTuple(0)[1]
        ahead = north + 240 - 40 * 1e-6 * et.arrays(echoes)["timestamp"][mine]
        self.assertLess(np.abs(ahead).max(), 19 + 3)


class Arguments(unittest.TestCase):
    def test_bad_arguments_end_with_one_line_and_no_files(self):
        et.assert_bad_arguments(self, airport.main, "airport.py")
        et.assert_bad_arguments(self, airport_search.main, "airport_search.py")
        et.assert_bad_arguments(self, airport_time.main, "airport_time.py")


if __name__ == "__main__":
    unittest.main()
