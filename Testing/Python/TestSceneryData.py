# SPDX-License-Identifier: BSD-3-Clause
"""The rich sceneries load through the scene reader with every triangle that their sources count.

They are not in the repository: without AVIANLIDAR_DATA_DIR the test is skipped (exit code 77)."""
import bz2
import os
import shutil
import sys
import unittest

import numpy as np

import scenetools as st

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
SCENES = os.environ.get("AVIANLIDAR_SCENES_DIR", "")


class SceneryData(unittest.TestCase):
    def check(self, name, counts):
        scene = st.Read(os.path.join(SCENES, name + ".lidarscene.json"))
        self.assertEqual((scene.errors, scene.warnings), ([], []))
        for block, count in counts.items():
            self.assertEqual(scene.block(block).GetNumberOfPolys(), count, msg=block)
        for name_, block in zip(scene.names, scene.blocks):
            self.assertTrue(np.isfinite(st.corners(block)).all(), msg=name_)
        self.assertTrue(scene.strings("attribution"))
        return scene

    def materials(self, scene, block):
        names = scene.strings("material_names")
        ids, counts = np.unique(st.cells(scene.block(block), "material_id"), return_counts=True)
        return {names[i]: int(n) for i, n in zip(ids, counts)}

    def test_hongqiao_with_structures(self):
        scene = self.check("zsss_structures", {"Scenery": 81087})
        low, high = self.extents(scene.block("Scenery"))
        np.testing.assert_allclose(low, [-1219.0, -2763.6, -89.6], atol=0.06)
        np.testing.assert_allclose(high, [975.0, 2822.6, 26.9], atol=0.06)
        self.assertEqual(set(self.materials(scene, "Scenery")), {"Wall", "Glass", "Metal"})

    def test_hongqiao_with_everything(self):
        scene = self.check("zsss_all", {"Scenery": 742757})
        self.assertEqual(set(self.materials(scene, "Scenery")), {"Wall", "Glass", "Metal", "Asphalt"})
        # Both sources are in one frame: the scenery's jetways stand at the map's terminals.
        points = st.corners(scene.block("Scenery"))[:, 0, :2]
        terminal = st.corners(scene.block("Terminal 1"))[:, :, :2].reshape(-1, 2)
        low, high = terminal.min(axis=0) - 30, terminal.max(axis=0) + 30
        self.assertGreater(((points > low) & (points < high)).all(axis=1).sum(), 1000)

    def test_honolulu(self):
        scene = self.check("phnl", {"Structures": 116215, "Ground": 80265})
        self.assertEqual(set(self.materials(scene, "Ground")), {"Grass", "Asphalt", "Concrete", "Sand", "Water"})
        self.assertEqual(set(self.materials(scene, "Structures")), {"Wall", "Glass", "Metal"})
        low, high = self.extents(scene.block("Structures"))
        np.testing.assert_allclose(low, [-4754.9, -1300.5, -478.2], atol=0.06)
        np.testing.assert_allclose(high, [4537.7, 5011.3, 169.7], atol=0.06)

    def test_ingolstadt(self):
        scene = self.check("ingolstadt", {"Street": 151179})
        self.assertEqual(set(self.materials(scene, "Street")), {"Wall", "Glass", "Metal", "Wood", "Concrete", "Brick"})
        low, high = self.extents(scene.block("Street"))
        # In UTM the street measures 190.488 x 490.658 x 24.008 m; the scene's frame is turned by the meridian's
        # convergence (1.8 degrees), and the map's scale of 0.9996 to 1.0004 is undone.
        self.assertAlmostEqual((high - low)[2], 24.008, delta=0.02)
        diagonal = np.linalg.norm((high - low)[:2])
        self.assertAlmostEqual(diagonal, np.hypot(190.488, 490.658), delta=5)
        self.assertLess(abs(0.5 * (low + high)[:2]).max(), 20)

    def test_shanghai(self):
        scene = self.check("shanghai_cbd", {"Towers": 37083})
        self.assertAlmostEqual(self.extents(scene.block("Towers"))[1][2], 640.1, delta=0.06)

    def test_office(self):
        scene = self.check("avz_office", {"Office floor": 12151})
        self.assertEqual(self.materials(scene, "Office floor"), {"Wall": 12151})
        low, high = self.extents(scene.block("Office floor"))
        np.testing.assert_allclose((high - low)[:2], [27.85, 48.49], atol=0.01)
        self.assertIn("lidar: 2 surfaces above, 2 below", scene.strings("scene_report"))

    def test_town_from_geojson(self):
        scene = self.check("neubrandenburg", {"Runway": 6})
        self.check_town(scene)

    def test_town_from_raw_osm(self):
        packed = os.path.join(DATA, "osm_neubrandenburg", "neubrandenburg.osm.bz2")
        unpacked = os.path.join(SCENES, "neubrandenburg.osm")
        with bz2.open(packed) as source, open(unpacked, "wb") as target:
            shutil.copyfileobj(source, target)
        scene = self.check("neubrandenburg_osm", {"Runway": 6})
        self.check_town(scene)
        os.remove(unpacked)

    def check_town(self, scene):
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

    @staticmethod
    def extents(block):
        points = st.corners(block).reshape(-1, 3)
        return points.min(axis=0), points.max(axis=0)


if __name__ == "__main__":
    if not DATA:
        print("AVIANLIDAR_DATA_DIR is not set: skipped")
        sys.exit(77)
    unittest.main()
