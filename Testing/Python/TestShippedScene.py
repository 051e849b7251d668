# SPDX-License-Identifier: BSD-3-Clause
"""The shipped airport: counts, places, areas, volumes and kinds of materials (what they reflect is TestMaterial's),
against its GeoJSON by other ways."""
import json
import pathlib
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import scenetools as st


WALL, GLASS, METAL, GRASS, ASPHALT, CONCRETE = 0, 1, 2, 4, 5, 6
ORIGIN = {"latitude": 31.1979, "longitude": 121.3363, "height": 3.0}


def enu(longitude, latitude):
    """East and north of the origin."""
    return st.frame(ORIGIN, {**ORIGIN, "latitude": latitude, "longitude": longitude})[0][:2]


def plans():
    features = json.loads(pathlib.Path(st.SHIPPED).with_name("hongqiao.geojson").read_text("utf-8"))["features"]
    result = {}
    for feature in features:
        geometry = feature["geometry"]
        rings = geometry["coordinates"] if geometry["type"] == "Polygon" else [geometry["coordinates"]]
        result[feature["properties"]["name"]] = (
            feature["properties"], [np.array([enu(*p) for p in ring]) for ring in rings])
    return result


def ring_area(ring):
    x, y = (ring - ring[0]).T
    return abs(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def ring_length(ring):
    return np.linalg.norm(np.diff(ring, axis=0), axis=1).sum()


class ShippedScene(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = st.Read(st.SHIPPED)
        cls.plans = plans()

    def buildings(self):
        for name, (properties, rings) in self.plans.items():
            if "height" in properties:
                yield name, properties, rings, self.scene.block(name)

    def test_every_feature_is_one_block(self):
        self.assertEqual((self.scene.errors, self.scene.warnings), ([], []))
        self.assertEqual(sorted(self.scene.names), sorted(["Ground", *self.plans]))
        classes = self.scene.strings("object_classes")
        self.assertEqual({c: classes.count(c) for c in classes},
                         {"ground": 1, "apron": 4, "runway": 2, "terminal": 4, "hangar": 4, "building": 7})
        for i, block in enumerate(self.scene.blocks):
            name = self.scene.output.GetMetaData(i).Get(self.scene.output.NAME())
            self.assertEqual(set(st.cells(block, "object_id")), {i})
            self.assertEqual((self.scene.strings("object_names", block), self.scene.names[i]), ([name], name))
            self.assertEqual(self.scene.strings("object_classes", block), [classes[i]])
        fields = self.scene.output.GetFieldData()
        np.testing.assert_array_equal(vtk_to_numpy(fields.GetArray("geodetic_origin")), [[*ORIGIN.values()]])
        np.testing.assert_array_equal(vtk_to_numpy(fields.GetArray("lidar_position")), [[0, 0, 3]])
        self.assertIn("OpenStreetMap contributors, ODbL", " ".join(self.scene.strings("attribution")))
        self.assertIn("lidar: 0 surfaces above, 2 below", self.scene.strings("scene_report"))
        self.assertEqual(self.scene.strings("material_names"),
                         ["Wall", "Glass", "Metal", "Wood", "Grass", "Asphalt", "Concrete"])

    def test_buildings_stand_where_the_map_says(self):
        """Closed solids on their outlines, whose facades have their share of glass."""
        for name, properties, rings, block in self.buildings():
            points, triangles = vtk_to_numpy(block.GetPoints().GetData()), st.corners(block)
            material = st.cells(block, "material_id")
            for p in rings[0]:
                below = points[np.hypot(*(points[:, :2] - p).T) < 1e-6]
                self.assertEqual(sorted(set(below[:, 2])), [0, properties["height"]], msg=name)
            area, up, ground = st.areas(triangles), st.normals(triangles)[:, 2], ring_area(rings[0])
            facade = abs(up) < 1e-9
            self.assertTrue(st.is_closed(triangles) and (area > 0).all(), msg=name)
            self.assertAlmostEqual(area[up > 1e-9].sum() / ground, 1, delta=1e-9, msg=name)
            self.assertAlmostEqual(st.volume(triangles) / ground / properties["height"], 1, delta=1e-9, msg=name)
            self.assertAlmostEqual(area[facade].sum() / ring_length(rings[0]) / properties["height"], 1, delta=1e-9,
                                   msg=name)
            self.assertAlmostEqual(area[material == GLASS].sum() / area[facade].sum(),
                                   0.4 if properties["kind"] == "terminal" else 0, delta=1e-9, msg=name)
            self.assertTrue(facade[material == GLASS].all(), msg=name)
            self.assertEqual(set(material) - {GLASS}, {METAL} if properties["kind"] == "hangar" else {WALL})
        for name, area in (("Terminal 1", 54459), ("Terminal 2", 139673)):  # as the author of the extract measured them
            self.assertAlmostEqual(ring_area(self.plans[name][1][0]) / area, 1, delta=0.001)

    def test_ground_aprons_and_runways_lie_flat(self):
        expected = {"Ground": (0, GRASS, 12000.0 ** 2)}
        for name, (properties, rings) in self.plans.items():
            if properties["kind"] == "apron":
                expected[name] = (0.02, CONCRETE, ring_area(rings[0]))
            elif properties["kind"] == "runway":
                expected[name] = (0.02, ASPHALT, ring_length(rings[0]) * properties["width"])
        self.assertEqual(len(expected), 7)
        for name, (height, material, area) in expected.items():
            block = self.scene.block(name)
            triangles = st.corners(block)
            self.assertEqual((set(triangles[:, :, 2].ravel()), set(st.cells(block, "material_id"))),
                             ({height}, {material}), msg=name)
            self.assertTrue((st.normals(triangles)[:, 2] > 0).all(), msg=name)
            self.assertAlmostEqual(st.areas(triangles).sum() / area, 1, delta=1e-9, msg=name)

    def test_lidar_stands_on_the_runway(self):
        ends = self.plans["Runway 18L/36R"][1][0]
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        offset = abs(along[0] * -ends[0][1] - along[1] * -ends[0][0])
        self.assertLess(offset, 57.6 / 2)
        self.assertLess(abs(np.linalg.norm(ends[0]) - np.linalg.norm(ends[1])), 50)
