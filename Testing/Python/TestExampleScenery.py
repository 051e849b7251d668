# SPDX-License-Identifier: BSD-3-Clause
"""The examples on rich sceneries where AVIANLIDAR_DATA_DIR names their folder: airports, a street, a town, an office."""
import os
import sys
import unittest

import numpy as np

import exampletools as et
import airport
import corridor
import detail

SCENES = os.environ.get("AVIANLIDAR_SCENES_DIR", "")


def scene(name):
    return os.path.join(SCENES, name + ".lidarscene.json")


class Scenery(unittest.TestCase):
    def scan(self, name):
        _, results = airport.main(["--no-pictures", "--preset", "Airport16", "--scene", scene(name),
                                   "--out", et.folder("ExampleScenery")])
        return results["Airport16"]

    def test_scenes(self):
        # Triangles, and about how many echoes.
        for name, triangles, number in (("zsss_structures", 86597, 1636), ("phnl", 196480, 1941),
                                        ("ingolstadt", 151179, 12923), ("neubrandenburg", 252212, 276)):
            with self.subTest(name):
                echoes, lidar, _ = self.scan(name)
                self.assertEqual(lidar.GetInputDataObject(1, 0).GetNumberOfPolys(), triangles)
                self.assertAlmostEqual(echoes.GetNumberOfPoints() / number, 1, delta=0.03)
                found = et.arrays(echoes)
                self.assertTrue((found["distance_m"] < 4000).all())
                self.assertTrue((found["longitude"].std() < 0.1) and np.isfinite(found["latitude"]).all())

    def test_levels_of_detail(self):
        # Fewer rays than the page has: its numbers within a few of a hundred.
        folder = et.folder("ExamplePaperDetail")
        rows = detail.main(["--rays", "500", "--out", folder])
        table, documented = et.read_table(folder + "/table.md"), et.documented_table("paper.md", "detail")
        self.assertEqual(list(table), list(documented))
        self.assertEqual(len(rows), 10)
        for column in ("missed", "invented"):  # the models differ, not the rays
            for row, text in table[f"other rays, detailed: {column}"].items():
                self.assertLess(float(text.split()[0]), 2, msg=(column, row))
        for column, page in documented.items():
            for row, text in page.items():
                found, wanted = (float(one.split()[0]) for one in (table[column][row], text))
                self.assertAlmostEqual(found, wanted, delta=0.05 * wanted + (4 if text.endswith("%") else 0.1), msg=(column, row))

    def test_masts_and_jetways_add_echoes(self):
        echoes, _, _ = self.scan("zsss_structures")
        names = et.strings(echoes, "object_names")
        self.assertGreater((et.arrays(echoes)["object_id"] == names.index("Scenery")).sum(), 50)

    def test_office(self):
        # In its corridor, about 1.2 m from the west wall: that wall is seen beyond 4 m and vanishes before 13 m.
        position = (0.0, -11.0, 1.3)
        _, echoes, lidar = corridor.main(["--no-pictures", "--scene", scene("avz_office"), "--out",
                                          et.folder("ExampleOffice"), "--position", *map(str, position)])
        found = et.arrays(echoes)
        self.assertEqual(lidar.GetInputDataObject(1, 0).GetNumberOfPolys(), 12151)
        self.assertGreater(len(found["points"]), 2500)
        # A diffuse wall returns what its incidence angle says, here as in the built corridor.
        share = found["return_energy"] / et.expected_energy(found, 2.5e-4, corridor.HAZE)
        near = (found["label_share"] > 0.999) & (found["incidence_angle"] < 35) & (found["number_of_returns"] == 1)
        self.assertAlmostEqual(np.median(share[near]), 1, delta=1e-3)
        # The wall in the west, by the beam that looks there.
        level = abs(found["vertical_angle"]) < 2
        west = found["points"][level & (found["azimuth"] == 27000)][:, 0].mean()
        aside = position[0] - west
        self.assertAlmostEqual(aside, 1.2, delta=0.2)
        wall = level & (abs(found["points"][:, 0] - west) < 0.02) & (found["points"][:, 1] > position[1])
        along = found["points"][wall][:, 1] - position[1]
        self.assertGreater(along.max(), 4)
        self.assertLess(along.max(), 13)


if __name__ == "__main__":
    if not os.environ.get("AVIANLIDAR_DATA_DIR"):
        print("AVIANLIDAR_DATA_DIR is not set")
        sys.exit(77)
    unittest.main()
