# SPDX-License-Identifier: BSD-3-Clause
"""The rich sceneries load through the scene reader with every triangle that their sources count.

They are not in the repository: without AVIANLIDAR_DATA_DIR the test is skipped (exit code 77)."""
import bz2
import functools
import os
import shutil
import sys
import unittest

import numpy as np

import scenetools as st

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
SCENES = os.environ.get("AVIANLIDAR_SCENES_DIR", "")


@functools.lru_cache(1)
def read(name):
    return st.Read(os.path.join(SCENES, name + ".lidarscene.json"))


class SceneryData(unittest.TestCase):
    def check(self, name, block, count):
        scene = read(name)
        self.assertEqual((scene.errors, scene.warnings, scene.block(block).GetNumberOfPolys()), ([], [], count))
        self.assertTrue(np.isfinite(st.corners(scene.block(block))).all())
        self.assertTrue(scene.strings("attribution"))
        return scene

    def test_airports_streets_towers_and_an_office(self):
        """Triangles, materials, and the extents that the sources state."""
        for name, block, count, materials, low, high in (
                ("zsss_structures", "Scenery", 81087, "Wall Glass Metal", (-1219.0, -2763.6, -89.6),
                 (975.0, 2822.6, 26.9)),
                ("phnl", "Structures", 116215, "Wall Glass Metal", (-4754.9, -1300.5, -478.2), (4537.7, 5011.3, 169.7)),
                ("phnl", "Ground", 80265, "Grass Asphalt Concrete Sand Water", None, None),
                ("avz_office", "Office floor", 12151, "Wall", None, None),
                ("ingolstadt", "Street", 151179, "Wall Glass Metal Wood Concrete Brick", None, None),
                ("shanghai_cbd", "Towers", 37083, "", None, (None, None, 640.1))):
            with self.subTest(name=name, block=block):
                scene = self.check(name, block, count)
                names = scene.strings("material_names")
                if materials:
                    self.assertEqual({names[i] for i in st.cells(scene.block(block), "material_id")},
                                     set(materials.split()))
                points = st.corners(scene.block(block)).reshape(-1, 3)
                for wanted, found in ((low, points.min(axis=0)), (high, points.max(axis=0))):
                    for a, b in zip(wanted or (), found):
                        self.assertTrue(a is None or abs(a - b) < 0.06, (wanted, found))
                if name == "ingolstadt":
                    # In UTM the street measures 190.488 x 490.658 x 24.008 m; the scene's frame is turned by the
                    # meridian's convergence (1.8 degrees), and the map's scale of 0.9996 to 1.0004 is undone.
                    self.assertAlmostEqual(np.ptp(points[:, 2]), 24.008, delta=0.02)
                    self.assertAlmostEqual(np.linalg.norm(np.ptp(points[:, :2], axis=0)), np.hypot(190.488, 490.658),
                                           delta=5)

    def test_a_town_from_geojson_and_from_raw_osm(self):
        source = bz2.open(os.path.join(DATA, "osm_neubrandenburg", "neubrandenburg.osm.bz2"))
        with source, open(os.path.join(SCENES, "neubrandenburg.osm"), "wb") as target:
            shutil.copyfileobj(source, target)
        self.addCleanup(os.remove, target.name)
        for name in ("neubrandenburg", "neubrandenburg_osm"):
            scene = self.check(name, "Runway", 6)
            # 15,338 buildings, most of them four walls; 3 have a height, all others the default of 8 m.
            triangles = st.corners(scene.block("Buildings"))
            self.assertAlmostEqual(len(triangles) / 252200, 1, delta=0.001)
            report = " ".join(scene.strings("scene_report"))
            self.assertRegex(report, r"Buildings: 1533\d features have no usable height attribute")
            walls = abs(st.normals(triangles)[:, 2]) < 1e-9 * st.areas(triangles)
            roofs = triangles[~walls & (triangles[:, 0, 2] > 0)]
            self.assertGreater((roofs[:, 0, 2] == 8).mean(), 0.999)
            # The runway of 2,093 m by 50 m.
            self.assertAlmostEqual(st.areas(st.corners(scene.block("Runway"))).sum() / (2093 * 50), 1, delta=0.005)


if __name__ == "__main__":
    if not DATA:
        print("AVIANLIDAR_DATA_DIR is not set: skipped")
        sys.exit(77)
    unittest.main()
