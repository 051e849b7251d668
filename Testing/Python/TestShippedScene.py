# SPDX-License-Identifier: BSD-3-Clause
"""The shipped airport: counts, places, areas, volumes and materials, against its GeoJSON by other ways."""
import json
import math
import os
import sys
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import scenetools as st

sys.path.insert(0, os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Testing", "Stability"))
import moved_scenes  # noqa: E402

WALL, GLASS, METAL, GRASS, ASPHALT, CONCRETE = 0, 1, 2, 4, 5, 6
ORIGIN = (31.1979, 121.3363, 3.0)


def ecef(latitude, longitude, height):
    """WGS84, the textbook's formula."""
    a, f = 6378137.0, 1 / 298.257223563
    e2 = f * (2 - f)
    lat, lon = math.radians(latitude), math.radians(longitude)
    n = a / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    return np.array([(n + height) * math.cos(lat) * math.cos(lon), (n + height) * math.cos(lat) * math.sin(lon),
                     (n * (1 - e2) + height) * math.sin(lat)])


def enu(longitude, latitude):
    """East and north of the origin, by ECEF."""
    lat, lon = math.radians(ORIGIN[0]), math.radians(ORIGIN[1])
    east = np.array([-math.sin(lon), math.cos(lon), 0])
    north = np.array([-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)])
    d = ecef(latitude, longitude, ORIGIN[2]) - ecef(*ORIGIN)
    return [east @ d, north @ d]


def plans():
    file = os.path.join(os.path.dirname(st.SHIPPED), "hongqiao.geojson")
    with open(file, encoding="utf-8") as stream:
        features = json.load(stream)["features"]
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
        cls.airport = moved_scenes.Airport(st.SHIPPED)

    def buildings(self):
        for name, (properties, rings) in self.plans.items():
            if "height" in properties:
                yield name, properties, rings, self.scene.block(name)

    def test_reads_in_silence(self):
        self.assertEqual((self.scene.errors, self.scene.warnings), ([], []))

    def test_every_feature_is_one_block(self):
        self.assertEqual(sorted(self.scene.names), sorted(["Ground", *self.plans]))
        names = [self.scene.output.GetMetaData(i).Get(self.scene.output.NAME()) for i in range(len(self.scene.names))]
        self.assertEqual(names, self.scene.names)
        classes = self.scene.strings("object_classes")
        counts = {c: classes.count(c) for c in classes}
        self.assertEqual(
            counts, {"ground": 1, "apron": 4, "runway": 2, "terminal": 4, "hangar": 4, "building": 7})
        for i, block in enumerate(self.scene.blocks):
            self.assertEqual(set(st.cells(block, "object_id")), {i})
            self.assertEqual(self.scene.strings("object_names", block), [names[i]])
            self.assertEqual(self.scene.strings("object_classes", block), [classes[i]])

    def test_field_data(self):
        fields = self.scene.output.GetFieldData()
        np.testing.assert_array_equal(vtk_to_numpy(fields.GetArray("geodetic_origin")), [ORIGIN])
        np.testing.assert_array_equal(vtk_to_numpy(fields.GetArray("lidar_position")), [[0, 0, 3]])
        self.assertIn("OpenStreetMap contributors, ODbL", " ".join(self.scene.strings("attribution")))
        self.assertIn("USGS", " ".join(self.scene.strings("attribution")))
        self.assertIn("lidar: 0 surfaces above, 2 below", self.scene.strings("scene_report"))

    def test_footprints_have_their_areas(self):
        for name, _, rings, block in self.buildings():
            triangles = st.corners(block)
            roof = triangles[st.normals(triangles)[:, 2] > 1e-9]
            expected = ring_area(rings[0])
            self.assertAlmostEqual(st.areas(roof).sum() / expected, 1, delta=1e-9, msg=name)
        # As the author of the extract measured them.
        self.assertAlmostEqual(ring_area(self.plans["Terminal 1"][1][0]) / 54459, 1, delta=0.001)
        self.assertAlmostEqual(ring_area(self.plans["Terminal 2"][1][0]) / 139673, 1, delta=0.001)

    def test_buildings_stand_where_the_map_says(self):
        for name, properties, rings, block in self.buildings():
            points = vtk_to_numpy(block.GetPoints().GetData())
            for p in rings[0]:
                below = points[np.hypot(*(points[:, :2] - p).T) < 1e-6]
                self.assertEqual(sorted(set(below[:, 2])), [0, properties["height"]], msg=name)

    def test_buildings_are_closed_solids(self):
        for name, properties, rings, block in self.buildings():
            triangles = st.corners(block)
            self.assertTrue(st.is_closed(triangles), msg=name)
            expected = ring_area(rings[0]) * properties["height"]
            self.assertAlmostEqual(st.volume(triangles) / expected, 1, delta=1e-9, msg=name)
            self.assertTrue((st.areas(triangles) > 0).all(), msg=name)

    def test_facades_have_their_share_of_glass(self):
        for name, properties, rings, block in self.buildings():
            triangles = st.corners(block)
            facade = abs(st.normals(triangles)[:, 2]) < 1e-9
            area, material = st.areas(triangles), st.cells(block, "material_id")
            expected = ring_length(rings[0]) * properties["height"]
            self.assertAlmostEqual(area[facade].sum() / expected, 1, delta=1e-9, msg=name)
            glass = area[material == GLASS].sum() / area[facade].sum()
            terminal = properties["kind"] == "terminal"
            self.assertAlmostEqual(glass, 0.4 if terminal else 0, delta=1e-9, msg=name)
            self.assertFalse((facade == 0)[material == GLASS].any(), msg=name)
            other = {METAL} if properties["kind"] == "hangar" else {WALL}
            self.assertEqual(set(material) - {GLASS}, other, msg=name)

    def test_every_stretch_of_a_facade_has_that_share(self):
        # One long facade, in windows of one bay: nowhere more glass than one strip, nowhere none.
        block = self.scene.block("Terminal 1")
        triangles, material = st.corners(block), st.cells(block, "material_id")
        ring = self.plans["Terminal 1"][1][0]
        lengths = np.linalg.norm(np.diff(ring, axis=0), axis=1)
        longest = int(np.argmax(lengths))
        a, b = ring[longest], ring[longest + 1]
        along, across = (b - a) / lengths[longest], np.array([a[1] - b[1], b[0] - a[0]]) / lengths[longest]
        on = (abs((triangles[:, :, :2] - a) @ across) < 1e-6).all(axis=1) & (material == GLASS)
        t = ((triangles[on][:, :, :2] - a) @ along).reshape(-1, 3)
        bays = round(lengths[longest] / 12)
        width = lengths[longest] / bays
        self.assertEqual(len(t), 2 * bays)
        middle = 0.5 * (t.min(axis=1) + t.max(axis=1))
        np.testing.assert_allclose(np.sort(middle)[::2], (np.arange(bays) + 0.5) * width, atol=1e-6)
        np.testing.assert_allclose(t.max(axis=1) - t.min(axis=1), 0.4 / 0.96 * width, atol=1e-6)

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
            self.assertEqual(set(triangles[:, :, 2].ravel()), {height}, msg=name)
            self.assertTrue((st.normals(triangles)[:, 2] > 0).all(), msg=name)
            self.assertEqual(set(st.cells(block, "material_id")), {material}, msg=name)
            self.assertAlmostEqual(st.areas(triangles).sum() / area, 1, delta=1e-9, msg=name)

    def test_lidar_stands_on_the_runway(self):
        ends = self.plans["Runway 18L/36R"][1][0]
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        offset = abs(along[0] * -ends[0][1] - along[1] * -ends[0][0])
        self.assertLess(offset, 57.6 / 2)
        self.assertLess(abs(np.linalg.norm(ends[0]) - np.linalg.norm(ends[1])), 50)

    def test_coefficients(self):
        expected = {WALL: (0.146, 0.054, 112), GLASS: (0.020, 0.852, 8046), METAL: (0.075, 0.634, 6803),
                    GRASS: (0.2204, 0, 1), ASPHALT: (0.1298, 0, 1), CONCRETE: (0.3104, 0, 1)}
        self.assertEqual(self.scene.strings("material_names"),
                         ["Wall", "Glass", "Metal", "Wood", "Grass", "Asphalt", "Concrete"])
        seen = set()
        for block in self.scene.blocks:
            rows = np.column_stack([st.cells(block, k) for k in ("material_id", "kd", "ks", "kp")])
            for row in np.unique(rows, axis=0):
                self.assertEqual(tuple(row[1:]), expected[int(row[0])])
                seen.add(int(row[0]))
            for name, kind in (("object_id", "int"), ("material_id", "int"), ("kd", "double"), ("ks", "double"),
                               ("kp", "double")):
                self.assertEqual(block.GetCellData().GetArray(name).GetDataTypeAsString(), kind)
        self.assertEqual(seen, set(expected))

    def test_piece_0_has_all_and_others_nothing(self):
        first, second = (st.Read(st.SHIPPED, piece=(i, 2)) for i in (0, 1))
        self.assertEqual(first.names, second.names)
        self.assertEqual([b.GetNumberOfCells() for b in first.blocks],
                         [b.GetNumberOfCells() for b in self.scene.blocks])
        self.assertEqual(second.blocks, [None] * len(second.names))
        for name in ("object_classes", "material_names", "attribution"):
            self.assertEqual(first.strings(name), second.strings(name), name)
        self.assertEqual(second.strings("scene_report"), [])
        for name in ("geodetic_origin", "lidar_position"):
            one, other = (vtk_to_numpy(read.output.GetFieldData().GetArray(name)) for read in (first, second))
            np.testing.assert_array_equal(one, other)

    def test_a_scan_in_coordinates_of_a_map_is_the_same(self):
        """Moved by the place in UTM, corners are rounded by 0.5 nm; no beam may be looked into in another way for that. Where
        polygons are cut in another way, mirror paths are sampled at other points: within their standard error."""
        direct = moved_scenes.compare(self.airport.scan(NumberOfReflections=1),
                                      self.airport.scan(moved_scenes.UTM, NumberOfReflections=1))
        self.expect_found_same(direct, energy=1e-4, distance=1e-3, errors=0.1)
        self.expect_same(moved_scenes.UTM, 0.0, energy=0.05, distance=0.05, errors=1.5)

    def test_a_scan_of_the_airport_turned_has_the_same_echoes(self):
        """The rays of a beam meet other points, so echoes that rays decide differ by their sampling."""
        for turn in moved_scenes.TURNS[1:]:
            self.expect_same((0.0, 0.0, 0.0), turn, energy=0.5, distance=0.5, errors=4.0)

    def expect_same(self, shift, turn, energy, distance, errors):
        self.expect_found_same(self.airport.compare(shift, turn), energy, distance, errors)

    def expect_found_same(self, found, energy, distance, errors):
        self.assertGreater(found["before"], 1500)
        self.assertEqual((found["after"], found["same"]), (found["before"], found["before"]))
        self.assertLess(found["most"], energy)
        self.assertLess(found["range"], distance)
        self.assertLess(found["errors"], errors)
        self.assertLess(found["rms"], 0.03)
        self.assertLess(abs(found["all"]), 1e-3)


if __name__ == "__main__":
    unittest.main()
