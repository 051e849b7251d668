# SPDX-License-Identifier: BSD-3-Clause
"""Objects of a scene: formats, placement, material names, footprints of every shape, warnings, abort."""
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_TETRA, vtkUnstructuredGrid
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataWriter, vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from boxfiles import CORNERS, MESHES, QUADS, TRIANGLES, collada, ifc, obj, poly_data, y_up
from avianlidar import vtkAvianLidar
from avianlidar.apps.places._features import length_of
from echotools import group
import scenetools as st


def canonical(triangles):
    """Triangles that differ in order or first corner only are equal."""
    rows = []
    for t in triangles.tolist():
        first = min(range(3), key=lambda k: t[k])
        rows.append(t[first] + t[(first + 1) % 3] + t[(first + 2) % 3])
    return np.array(sorted(rows))


def notes(scene):
    """The report of a scene as one text."""
    return " ".join(scene.strings("scene_report"))


BOX, NULL_ISLAND = CORNERS[np.array(TRIANGLES)], {"latitude": 0, "longitude": 0, "height": 0}


class SceneObjects(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = cls.holder.name
        for name, content in MESHES.items():
            pathlib.Path(cls.folder, name).write_bytes(content)
        cls.save("box.mtl", "newmtl painted\nKd 1 0 0\nnewmtl glazed\nKd 0 0 1\n")
        cls.save("quads.obj", obj(CORNERS, QUADS, ("painted", "glazed")))
        cls.save("y.dae", collada(y_up(CORNERS), TRIANGLES, "Y_UP"))
        cls.save("box.ifc", ifc(CORNERS, TRIANGLES))
        cls.write_vtk_files()

    @classmethod
    def write_vtk_files(cls):
        """The box as polygons, as one hexahedron, as two blocks of half its triangles each, and as a polyhedron between
        two tetrahedra."""
        grid = vtkUnstructuredGrid()
        grid.SetPoints(poly_data(TRIANGLES).GetPoints())
        grid.InsertNextCell(VTK_HEXAHEDRON, 8, (0, 1, 3, 2, 4, 5, 7, 6))
        blocks = group(poly_data(TRIANGLES[:6]), poly_data(TRIANGLES[6:]))
        mixed = vtkUnstructuredGrid()
        points = vtkPoints()
        for point in (*CORNERS,
                      *((x + i, y, z) for i in (20, 30) for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))):
            points.InsertNextPoint(*point)
        mixed.SetPoints(points)
        faces = vtkIdList()
        for value in (len(QUADS), *(value for quad in QUADS for value in (len(quad), *quad))):
            faces.InsertNextId(value)
        mixed.InsertNextCell(VTK_TETRA, 4, (8, 9, 10, 11))
        mixed.InsertNextCell(VTK_POLYHEDRON, faces)
        mixed.InsertNextCell(VTK_TETRA, 4, (12, 13, 14, 15))
        for writer, name, data in ((vtkXMLPolyDataWriter(), "box.vtp", poly_data(TRIANGLES)),
                                   (vtkPolyDataWriter(), "box.vtk", poly_data(TRIANGLES)),
                                   (vtkXMLUnstructuredGridWriter(), "box.vtu", grid),
                                   (vtkXMLUnstructuredGridWriter(), "mixed.vtu", mixed),
                                   (vtkXMLMultiBlockDataWriter(), "box.vtm", blocks)):
            writer.SetFileName(os.path.join(cls.folder, name))
            writer.SetInputData(data)
            if name != "box.vtk":
                writer.SetDataModeToBinary()
            writer.Write()

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    @classmethod
    def save(cls, name, text):
        pathlib.Path(os.path.join(cls.folder, name)).write_text(text, "utf-8")

    def read(self, *objects, silent=True, **keys):
        scene = {"version": 1, "material_map": {"*": "wall"}, "objects": list(objects), **keys}
        result = st.Read(st.write_scene(self.folder, "scene", scene))
        self.assertEqual(result.errors, [])
        if silent:
            self.assertEqual(result.warnings, [])
        return result

    def box(self, **keys):
        return st.corners(self.read({"file": "box.obj", **keys}).blocks[0])

    # --- formats

    def test_all_formats_give_the_same_box(self):
        expected = canonical(CORNERS[np.array(TRIANGLES)])
        for name in (*MESHES, "y.dae", "box.ifc", "box.vtp", "box.vtk", "box.vtm"):
            with self.subTest(file=name):
                block = self.read({"file": name}).blocks[0]
                self.assertEqual(block.GetNumberOfPoints(), 8)
                triangles = st.corners(block)
                if name == "box.ifc":
                    # Assimp turns it by a matrix in single precision whose zeros are 4e-8.
                    triangles = triangles.round(6) + 0.0
                np.testing.assert_array_equal(canonical(triangles), expected)
        told = st.corners(self.read({"file": "y.dae", "up_axis": "z"}).blocks[0])
        np.testing.assert_array_equal(canonical(told), canonical(y_up(CORNERS)[np.array(TRIANGLES)]))

    def test_polygons_and_outsides_of_volumes_are_triangulated(self):
        for name, count, volume in (("quads.obj", 12, 6), ("box.vtu", 12, 6), ("mixed.vtu", 12 + 2 * 4, 6 + 2 / 6)):
            triangles = st.corners(self.read({"file": name}).blocks[0])
            self.assertEqual(len(triangles), count)
            self.assertTrue(st.is_closed(triangles))
            self.assertAlmostEqual(st.volume(triangles), volume, places=6)

    # --- material names

    def test_names_are_mapped_by_the_first_pattern_that_fits(self):
        """The object's own map comes first, then the scene's. A material of the object comes before both."""
        of_scene = {"p?inted": "metal", "paint*": "glass", "*": "wood"}
        for item, names, expected in (({}, of_scene, {2: 6, 3: 6}), ({}, dict(reversed(of_scene.items())), {3: 12}),
                                      ({}, {"paint*": "glass", "p?inted": "metal", "*": "wood"}, {1: 6, 3: 6}),
                                      ({"material_map": {"glazed": "Glass"}}, {"*": "wall"}, {0: 6, 1: 6}),
                                      ({"material": "WOOD"}, of_scene, {3: 12}),
                                      ({"file": "box.vtp"}, {"glazed": "glass", "*": "wall"}, {0: 6, 1: 6}),
                                      ({"file": "box.vtk"}, {"glazed": "glass", "*": "wall"}, {0: 6, 1: 6})):
            block = self.read({"file": "quads.obj", **item}, material_map=names).blocks[0]
            self.assertEqual(dict(zip(*np.unique(st.cells(block, "material_id"), return_counts=True))), expected,
                             (item, names))

    def test_unmapped_names_are_wall_and_said_once(self):
        scene = self.read({"file": "quads.obj", "name": "A"}, {"file": "quads.obj", "name": "B"}, {"file": "box.stl"},
                          {"ground": {"size": 10}}, silent=False, material_map={"glazed": "glass"})
        self.assertEqual((len(scene.warnings), scene.warnings[0].count('"painted"')), (1, 1))
        self.assertIn("Ground: taken as Wall", scene.warnings[0])
        self.assertEqual(sorted(st.cells(scene.blocks[1], "material_id")), 6 * [0] + 6 * [1])

    def test_own_materials_follow_the_four(self):
        materials = {"Grass": {"kd": 0.2}, "wood": {"kd": 0.3, "ks": 0.1, "kp": 5},
                     "Ice": {"kd": 0, "ks": 1, "kp": 1e6}}
        scene = self.read({"file": "box.obj", "material": "ice"}, {"file": "box.obj", "material": "wood"},
                          {"file": "box.obj", "material": "grass"}, materials=materials)
        self.assertEqual(scene.strings("material_names"), ["Wall", "Glass", "Metal", "Wood", "Grass", "Ice"])
        self.assertEqual([set(st.cells(b, "material_id")) for b in scene.blocks], [{5}, {3}, {4}])
        self.assertEqual([st.cells(b, "kd")[0] for b in scene.blocks], [0, 0.3, 0.2])
        self.assertEqual([st.cells(b, "kp")[0] for b in scene.blocks], [1e6, 5, 1])

    # --- placement

    def test_scale_then_rotation_then_position(self):
        got = self.box(scale=[1, 2, 3], rotation=90, position=[100, 200, 300])
        scaled = CORNERS * [1, 2, 3]
        expected = np.column_stack([scaled[:, 1], -scaled[:, 0], scaled[:, 2]]) + [100, 200, 300]
        np.testing.assert_allclose(got, expected[np.array(TRIANGLES)], atol=1e-9)
        matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
        np.testing.assert_allclose(self.box(rotation=matrix), BOX @ np.transpose(matrix), atol=1e-12)
        for yaw in (30, 200):  # clockwise from north
            c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
            np.testing.assert_allclose(self.box(rotation=yaw), BOX @ [[c, -s, 0], [s, c, 0], [0, 0, 1]], atol=1e-12)

    def test_direction_is_where_north_goes(self):
        level = [math.sin(math.radians(30)), math.cos(math.radians(30)), 0]
        np.testing.assert_allclose(self.box(rotation=[5 * c for c in level]), self.box(rotation=30), atol=1e-12)
        got, start = self.box(rotation=[1, 2, 0.5]), BOX
        # which points and their images fix
        matrix = np.linalg.lstsq(start.reshape(-1, 3), got.reshape(-1, 3), rcond=None)[0].T
        np.testing.assert_allclose(matrix @ [0, 1, 0], np.array([1, 2, 0.5]) / math.sqrt(5.25), atol=1e-12)
        np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
        self.assertAlmostEqual((matrix @ [1, 0, 0])[2], 0, places=12)
        self.assertGreater((matrix @ [0, 0, 1])[2], 0.9)

    def test_geodetic_place_equals_the_same_place_in_metres(self):
        origin = {"latitude": 31.1979, "longitude": 121.3363, "height": 3}
        place = {"latitude": 31.3, "longitude": 121.6, "height": 70}
        got = st.corners(self.read({"file": "box.obj", "geodetic": place, "rotation": 20}, origin=origin).blocks[0])
        position, rotation = st.frame(origin, place)
        yaw = math.radians(20)
        turn = np.array([[math.cos(yaw), math.sin(yaw), 0], [-math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
        expected = st.corners(self.read({"file": "box.obj", "position": position.tolist(),
                                         "rotation": (rotation @ turn).tolist()}, origin=origin).blocks[0])
        np.testing.assert_allclose(got, expected, atol=1e-8)

    def test_projected_coordinates(self):
        origin = {"latitude": 48.7608, "longitude": 11.4235, "height": 412}
        offset = np.array([678016, 5403455, 412])
        got = st.corners(self.read({"file": "box.obj", "crs": "EPSG:32632", "position": offset.tolist()},
                                   origin=origin).blocks[0])
        lines = "".join("%.6f %.6f %.6f\n" % tuple(c + offset) for c in CORNERS)
        text = subprocess.run(["cs2cs", "-f", "%.12f", "EPSG:32632", "EPSG:4979"], input=lines, text=True,
                              capture_output=True, check=True).stdout
        places = [list(map(float, line.split())) for line in text.splitlines()]
        local = np.array([st.frame(origin, {"latitude": lat, "longitude": lon, "height": corner[2] + offset[2]})[0]
                          for (lat, lon, _), corner in zip(places, CORNERS)])
        np.testing.assert_allclose(got, local[np.array(TRIANGLES)], atol=1e-6)

    # --- footprints

    def plan(self, file, *rows, **keys):
        """A scene of features in metres."""
        self.save(file, st.features(*rows))
        return self.read({"footprints": file, "crs": "local", **keys})

    SQUARE = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]
    HOLE = [[5, 2], [5, 8], [15, 8], [15, 2], [5, 2]]

    def test_several_polygons_crossing_rings_and_repeated_vertices(self):
        other = [[[30, 0], [40, 0], [40, 0], [40, 10], [30, 10], [30, 0]]]
        scene = self.plan("multi.geojson", ("MultiPolygon", [[self.SQUARE], other], {}), height=2)
        self.assertAlmostEqual(st.volume(st.corners(scene.blocks[0])), 600, places=9)
        scene = self.plan("bow.geojson", ("Polygon", [[[0, 0], [10, 10], [10, 0], [0, 10], [0, 0]]], {}), height=2)
        self.assertAlmostEqual(st.volume(st.corners(scene.blocks[0])), 2 * 50, places=9)
        self.assertIn("1 footprints with crossing or overlapping rings were repaired", notes(scene))

    def test_degenerate_rings(self):
        spike = [*self.SQUARE[:3], [30, 10], *self.SQUARE[2:]]
        closed_twice = [*self.SQUARE[:-1], [1e-12, 0], [0, 0]]
        for rings in ([spike, self.HOLE], [self.SQUARE, self.HOLE, [[1, 1]] * 4], [closed_twice, self.HOLE[::-1]]):
            scene = self.plan("odd.geojson", ("Polygon", rings, {}), ("Polygon", [[[5, 5]] * 4], {}), height=4)
            self.assertAlmostEqual(st.volume(st.corners(scene.blocks[0])), 140 * 4, places=9)
        scene = self.plan("dot.geojson", ("LineString", [[5, 5], [5, 5]], {}), ("Polygon", [self.SQUARE], {}),
                          flat=True, width=3)
        self.assertAlmostEqual(st.areas(st.corners(scene.blocks[0])).sum(), 200, places=9)

    def test_courtyards_are_open_with_glazing_shares_of_every_size(self):
        for share, sense in ((0.3, 1), (1, -1)):
            for bay in (0.7, 1000):
                with self.subTest(share=share, bay=bay):
                    block = self.plan("glazed.geojson", ("Polygon", [self.SQUARE[::sense], self.HOLE[::sense]], {}),
                                      height=4, base=1, roof_material="wood",
                                      glazing={"share": share, "bay": bay}).blocks[0]
                    triangles, material = st.corners(block), st.cells(block, "material_id")
                    area = st.areas(triangles)
                    self.assertTrue(st.is_closed(triangles))
                    self.assertAlmostEqual(st.volume(triangles), (200 - 60) * 4, places=8)
                    self.assertEqual((triangles[:, :, 2].min(), triangles[:, :, 2].max()), (1, 5))
                    self.assertAlmostEqual(area[material == 1].sum(), share * (60 + 32) * 4, places=8)
                    self.assertAlmostEqual(area[material == 3].sum(), 2 * 140, places=8)

    def test_heights_that_are_not_numbers(self):
        """One true, false or list among numbers does not spoil the others; a list of one value is this value."""
        for wrong in (True, False, [3, 4], [], {"a": 1}, "true", None, [[5]]):
            for right in (7, 7.5, "7.5 m"):
                scene = self.plan("odd.geojson", *(("Polygon", [self.SQUARE], {"h": h, "w": False})
                                                   for h in (right, wrong)),
                                  features="separate", height_attribute="h", height=3, name="House")
                self.assertEqual([st.corners(b)[:, :, 2].max() for b in scene.blocks],
                                 [float(str(right).split()[0]), 3], (right, wrong))
                self.assertIn("House: 1 features have no usable height attribute", notes(scene))
        scene = self.plan("odd.geojson", *(("Polygon", [self.SQUARE], {"h": h}) for h in (7, [9])), features="separate",
                          height_attribute="h", height=3)
        self.assertEqual([st.corners(b)[:, :, 2].max() for b in scene.blocks], [7, 9])

    def test_lines_become_strips(self):
        scene = self.plan("road.geojson", ("LineString", [[0, 0], [100, 0], [100, 50]], {"w": "8 m"}), flat=True,
                          base=0.5, width_attribute="w", width=3)
        triangles = st.corners(scene.blocks[0])
        self.assertAlmostEqual(st.areas(triangles).sum(), 8 * 150, places=9)
        self.assertEqual(set(triangles[:, :, 2].ravel()), {0.5})
        self.assertTrue((st.normals(triangles)[:, 2] > 0).all())

    def test_attributes(self):
        rows = [*(("Polygon", [self.SQUARE], properties) for properties in (
            {"kind": "house", "h": "7.5 m", "label": "A", "n": 2}, {"kind": "hut", "h": None, "label": "", "n": 3},
            {"kind": "house", "h": "two storeys", "n": 2})), ("Point", [0, 0], {"kind": "house", "n": 2})]
        options = {"height_attribute": "h", "height": 3, "name_attribute": "label", "name": "House"}
        scene = self.plan("town.geojson", *rows, features="separate", **options)
        self.assertEqual(scene.names, ["A", "House 2", "House 3"])
        self.assertEqual([st.corners(b)[:, :, 2].max() for b in scene.blocks], [7.5, 3, 3])
        self.assertIn("House: 2 features have no usable height attribute and got the default height: House 2, House 3 "
                      '("two storeys")', notes(scene))
        self.assertIn("House: 1 points were left out", notes(scene))
        scene = self.plan("town.geojson", *rows, **options)
        self.assertEqual((scene.names, scene.blocks[0].GetNumberOfCells()), (["House"], 36))
        for height, expected in (("12m", 12), ("0", 3), ("1e999", 3), ("40 ft", 12.192), (True, 3), ([12], 12),
                                 ([12, 13], 3)):
            scene = self.plan("tall.geojson", ("Polygon", [self.SQUARE], {"h": height}), features="together", **options)
            self.assertEqual(st.corners(scene.blocks[0])[:, :, 2].max(), expected, height)
        for chosen, count in (({"kind": "ho*"}, 2), ({"label": "*"}, 2), ({"kind": "h*", "n": 3}, 1)):
            scene = self.plan("town.geojson", *rows, filter=chosen, **options)
            self.assertEqual(scene.blocks[0].GetNumberOfCells(), 12 * count, msg=chosen)

    def test_lengths_are_read_as_the_command_airport_reads_them(self):
        """Texts of maps, and texts put together from their pieces."""
        random = np.random.default_rng(4)
        pieces = ["12", "3,5", "1,200", "1 200", "7.25", "m", " ", "ft", "'", '"', "-", "\u2013", "~", ";", "/", "..",
                  "+", "\xb1", "cm", "\u2032", "\u2033", "\u2019", "\u043a\u043c", "\u043c\u0435\u0442\u0440", "\u7c73",
                  "storey", "in", "(x)", "agl", "up to", "e2", " \u043c", "\xa0", "\u2009"]
        texts = ["12,5", "~12", "12-15", "40 ft", "40'", "12.5 metres", "1.2e1", "12;15", "NaN", "0", "-5", "1e6",
                 "39'4\"", "39 ft 4 in", "12 \u041c\u0415\u0422\u0420\u041e\u0412", "12\u7c73\u9ad8", "12 \u043c\u043c",
                 "3 storeys", "1234,5", "999,999", "1,200 ft", "100000 mm", "1000", "1001", "12m5cm", "4 ; ;",
                 "\u0661\u0662", "6 m - 8 m",
                 *("".join(random.choice(pieces, random.integers(1, 6))) for _ in range(500))]
        scene = self.plan("lengths.geojson", *(("Polygon", [self.SQUARE], {"h": text}) for text in texts),
                          features="separate", height_attribute="h", height=7777)
        self.assertGreater(sum(length_of(text) is not None for text in texts), 45)
        for text, block in zip(texts, scene.blocks, strict=True):
            self.assertAlmostEqual(st.corners(block)[:, :, 2].max(), length_of(text) or 7777, places=9, msg=text)

    def test_one_feature_does_not_end_a_scene(self):
        """What cannot be made or read is left out, counted and named."""
        origin = {"latitude": 53.6, "longitude": 13.3, "height": 0}
        good = [[13.3, 53.6], [13.301, 53.6], [13.301, 53.601], [13.3, 53.6]]
        far = [[0, 0], [1e9, 0], [1e9, 1], [0, 0]]
        outside = ("1 features that cannot be made (coordinates lie outside their coordinate reference system) were "
                   "left out: B")
        for coordinates, more, note in (
                ([[*good[:1], [13.3, 95], *good[2:]]], {}, outside),
                ([[*good[:1], [math.nan, 53.6], *good[2:]]], {}, outside),
                ([[*good[:1], ["a", "b"], *good[2:]]], {}, "1 features without a geometry were left out: B"),
                ([good], {"height_attribute": "h"}, 'there is no height to assume) were left out: B'),
                ([far], {"crs": "local", "height": 1, "glazing": {"share": 0.5, "bay": 2}},
                 "bays of 2 m: a coordinate or 'bay' is wrong) were left out: B")):
            local = [[[1000 * (x - 13), 1000 * (y - 53)] for x, y in good]] if "crs" in more else [good]
            self.save("bad.geojson", st.features(("Polygon", local, {"name": "A", "h": 1}),
                                              ("Polygon", coordinates, {"name": "B"})))
            scene = self.read({"footprints": "bad.geojson", **({"height": 1} if not more else more)}, origin=origin)
            alone = self.plan("alone.geojson", ("Polygon", local, {"h": 1}),
                              **{"height": 1, "crs": "EPSG:4326", **more}) if "crs" in more else None
            self.assertIn(note, notes(scene))
            self.assertTrue(st.is_closed(st.corners(scene.blocks[0])))
            self.assertEqual(len(scene.blocks), 1)
            if alone:
                np.testing.assert_array_equal(st.corners(scene.blocks[0]), st.corners(alone.blocks[0]))

    def test_rings_that_touch(self):
        """Courtyards that meet in points and share edges, as ways in any order, sense and beginning. The area is that
        of the outer square less the courtyards, by the trapezoids of their corners."""
        random = np.random.default_rng(7)
        origin = {"latitude": 1.6, "longitude": 7.4, "height": 0}
        star = [[(5, 5), (4, 2), (2, 1), (3, 4)], [(5, 5), (8, 4), (9, 2), (6, 3)], [(5, 5), (2, 6), (1, 8), (4, 7)],
                [(5, 5), (6, 8), (8, 9), (7, 6)]]
        for case in range(24):
            moved = {(x, y): (x, y) + random.uniform(-0.3, 0.3, 2).round(4) * (case % 2) for x in range(11)
                     for y in range(11)}
            cells = [[(x, y), (x + 2, y), (x + 2, y + 2), (x, y + 2)] for x in range(1, 9, 2) for y in range(1, 9, 2)
                     if random.uniform() < 0.5]
            rings = [[(0, 0), (10, 0), (10, 10), (0, 10)], *(star if case < 4 else cells)]
            places = {corner: i for i, corner in enumerate(moved, 1)}
            ways, members = "", ""
            for number in random.permutation(len(rings)):
                ring = np.roll(rings[number], random.integers(4), axis=0)[::random.choice([-1, 1])].tolist()
                ways += f'<way id="{number + 1}" version="1">' + "".join(
                    f'<nd ref="{places[tuple(p)]}"/>' for p in [*ring, ring[0]]) + "</way>"
                members += f'<member type="way" ref="{number + 1}" role="{"inner" if number else "outer"}"/>'
            self.save("touch.osm",
                      '<osm version="0.6">'
                      + "".join(f'<node id="{i}" version="1" lat="{1.6 + 1e-3 * moved[p][1]:.9f}" '
                                f'lon="{7.4 + 1e-3 * moved[p][0]:.9f}"/>' for p, i in places.items()) + ways
                      + f'<relation id="1" version="1">{members}<tag k="type" v="multipolygon"/><tag k="building" '
                        'v="yes"/></relation></osm>')

            def area(ring):
                local = [st.frame(origin, {"latitude": 1.6 + 1e-3 * moved[p][1], "longitude": 7.4 + 1e-3 * moved[p][0],
                                           "height": 0})[0] for p in ring]
                return 0.5 * abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(local, local[1:] + local[:1])))

            scene = self.read({"footprints": "touch.osm", "layer": "multipolygons", "height": 1}, origin=origin)
            self.assertAlmostEqual(st.volume(st.corners(scene.blocks[0]))
                                   / (area(rings[0]) - sum(map(area, rings[1:]))), 1, places=6, msg=case)

    def test_polygons_that_overlap(self):
        """Polygons of a feature are united, holes too; a hole outside its polygon is left out."""
        square = np.array(self.SQUARE)
        for rings, area in (
                ([[square], [square + [5, 0]]], 250), ([[square], [square + [20, 0]]], 400),
                ([[square, self.HOLE, self.HOLE]], 140), ([[square, self.HOLE, np.array(self.HOLE) + [2, 0]]], 128),
                ([[square, self.HOLE, square + [30, 0]]], 140), ([[self.HOLE, square]], 140),
                ([[square], [square]], 200),
                ([[[*square[:4], [-9, 10], *square[3:]], self.HOLE], [square + [30, 0]]], 340),
                ([[[*square[:-1], [0, 0], [1, 1], [1, 2], [2, 2], [2, 1], [1, 1], [0, 0]], self.HOLE]], 139)):
            coordinates = [[np.array(ring).tolist() for ring in polygon] for polygon in rings]
            scene = self.plan("overlap.geojson", ("MultiPolygon", coordinates, {"name": "A"}), height=1)
            triangles = st.corners(scene.blocks[0])
            self.assertAlmostEqual(st.volume(triangles), area, places=9)
            self.assertTrue(st.is_closed(triangles))
            self.assertIn("overlap: 1 footprints with crossing or overlapping rings were repaired: A",
                          scene.strings("scene_report"))
            is_stray = len(coordinates[0]) == 3 and coordinates[0][2][0] == [30, 0]
            self.assertEqual(
                "overlap: 1 holes outside their outlines were left out: A" in scene.strings("scene_report"), is_stray)

    def test_undersides(self):
        """A canopy from 6 to 8 m, one whose underside is above its top."""
        scene = self.plan("roofs.geojson", ("Polygon", [self.SQUARE], {"h": 8, "u": "6 m"}),
                          ("Polygon", [self.SQUARE], {"h": 5, "u": 9}), ("Polygon", [self.SQUARE], {"h": 5}),
                          height_attribute="h", height=3, min_height_attribute="u", base=0.5, features="separate")
        self.assertEqual([(z.min(), z.max()) for z in (st.corners(block)[:, :, 2] for block in scene.blocks)],
                         [(6.5, 8.5), (0.5, 5.5), (0.5, 5.5)])
        self.assertIn("1 features have a least height that is not below their height", notes(scene))
        for under, is_wrong in (("abc", True), ("-5", True), ("0", False), ("0.0 m", False), ("", False), (0, False)):
            scene = self.plan("roofs.geojson", ("Polygon", [self.SQUARE], {"u": under, "name": "A"}), height=3,
                              min_height_attribute="u")
            self.assertEqual('roofs: 1 features have a least height that is not a length, and stand on the ground: A '
                             f'("{under}")' in scene.strings("scene_report"), is_wrong)

    def test_features_without_places(self):
        """What is left out is counted, and an error says what is wrong, whether there is a filter or not."""
        nowhere, origin = (None, None, {"k": "a"}), NULL_ISLAND
        for name, text, chosen, words in (
                ("null.geojson", st.features(nowhere, nowhere), {"k": "*"},
                 "none of its 2 features that fit the filter has a geometry"),
                ("none.geojson", st.features(), {}, "holds no features"),
                ("city.json", '{"type": "CityJSON", "version": "1.1", "CityObjects": {}, "vertices": []}', {},
                 "is CityJSON, which is not read"),
                ("A.CSV", "id,height\n1,2\n", {}, "a table needs the columns x and y")):
            self.save(name, text)
            item = {"footprints": name, "height": 3, "crs": "EPSG:4326", **({"filter": chosen} if chosen else {})}
            file = st.write_scene(self.folder, "scene", {"version": 1, "origin": origin, "objects": [item]})
            self.assertIn(words, " ".join(st.Read(file).errors))
        self.save("some.geojson", st.features(nowhere, ("Polygon", [[[0, 0], [0.001, 0], [0.001, 0.001], [0, 0]]], {})))
        scene = self.read({"footprints": "some.geojson", "height": 3}, origin=origin)
        self.assertIn("1 features without a geometry were left out", notes(scene))
        self.save("dof.csv", "OAS,LATDEC,LONDEC,AGL,AMSL\n01-1,0.001,0.002,00100,00200\n")
        for name, feet in (("AGL", 100), ("AMSL", 200)):
            scene = self.read({"footprints": "dof.csv", "height_attribute": name, "width": 2, "crs": "EPSG:4326"},
                              origin=origin)
            self.assertAlmostEqual(st.corners(scene.blocks[0])[:, :, 2].max(), 0.3048 * feet)

    def test_pieces_without_triangles(self):
        """They have the blocks of the whole, and open no mesh: a damaged one is an error of the first piece alone."""
        self.plan("row.geojson", *(("Polygon", [[[x + 30 * i, y] for x, y in self.SQUARE]], {}) for i in range(3)),
                  height=5)
        self.save("damaged.stl", "solid nothing")
        objects = [{"file": "box.obj", "name": "box", "class": "building"}, {"ground": {"size": 100}, "name": "lawn"},
                   {"footprints": "row.geojson", "crs": "local", "height": 5, "features": "separate", "name": "House"}]
        for damaged in (False, True):
            if damaged:
                objects[0]["file"] = "damaged.stl"
            file = st.write_scene(self.folder, "scene",
                                  {"version": 1, "material_map": {"*": "wall"}, "objects": objects})
            first, other = (st.Read(file, piece=(i, 4)) for i in (0, 3))
            self.assertEqual([len(first.errors), len(other.errors)], [int(damaged), 0], first.errors + other.errors)
            self.assertEqual(other.names, ["box", "lawn", "House 1", "House 2", "House 3"])
            self.assertEqual((other.strings("object_classes"), other.blocks),
                             (["building", "", "", "", ""], [None] * 5))
            if not damaged:
                self.assertEqual((first.names, first.strings("object_classes")),
                                 (other.names, other.strings("object_classes")))

    def test_tags_of_a_raw_osm_file(self):
        """With negative ids, as an editor writes them, in falling order."""
        nodes = "".join(f'<node id="{-i}" lat="{lat}" lon="{lon}" version="1"/>' for i, lat, lon in (
            (1, 0, 0), (2, 0, 0.001), (3, 0.001, 0.001), (4, 0.001, 0)))
        way = self.way(-9, -1, -2, -3, -4, -1, more=self.BUILDING + '<tag k="height" v="33"/>')
        self.save("town.osm", f'<osm version="0.6">{nodes}{way}</osm>')
        scene = self.read({"footprints": "town.osm", "layer": "multipolygons", "filter": {"building": "*"},
                           "height_attribute": "height"}, origin=NULL_ISLAND)
        triangles = st.corners(scene.blocks[0])
        self.assertEqual(triangles[:, :, 2].max(), 33)
        # A thousandth of a degree on the equator: 111.3195 m along it, 110.5743 m across.
        self.assertAlmostEqual(triangles[:, :, 0].max(), 111.3195, places=3)
        self.assertAlmostEqual(triangles[:, :, 1].max(), 110.5743, places=3)

    def test_nodes_of_a_raw_osm_file_without_a_place(self):
        """The square loses the corner, and is the triangle of the others. A value may hold what ends a tag."""
        whole = [(1, "0", "0"), (2, "0", "0.001"), (3, "+1e-3", " 0.001 "), (4, "0.001", "0")]
        for lat, lon in (("200", "0.001"), ("0.001", "180.1"), ("-90.5", "0.001"), ("nan", "0.001"), ("0,001", "0.001"),
                         ("", "0.001"), ("0x1", "0.001")):
            for form in ('<node id="{}" note="a>b" lat="{}" lon="{}"/>',
                         "<node\n id='{}' lat = '{}' lon='{}' ><tag k='note' v='>'/></node>"):
                town = "".join(form.format(i, lat if i == 3 else y, lon if i == 3 else x) for i, y, x in whole)
                way = self.way(9, 1, 2, 3, 4, 1, more=self.BUILDING)
                self.save("town.osm", f'<osm version="0.6">{town}{way}</osm>')
                scene = self.read({"footprints": "town.osm", "layer": "multipolygons", "height": 3},
                                  origin=NULL_ISLAND)
                self.assertIn("town: 1 nodes whose place is not in degrees were left out: 3",
                              scene.strings("scene_report"))
                corners = st.corners(scene.blocks[0]).reshape(-1, 3)
                roof = np.unique(corners[corners[:, 2] == 3, :2].round(3), axis=0)
                np.testing.assert_allclose(roof, [(0, 0), (0, 110.574), (111.320, 0)], atol=0.01)

    def osm(self, body, name="town.osm", **keys):
        """A scene of the buildings of OpenStreetMap's XML, one part each, 3 m high."""
        self.save(name, body if "<osm" in body else f'<?xml version="1.0"?><osm version="0.6">{body}</osm>')
        return {"version": 1, "origin": {"latitude": 53.6, "longitude": 13.3, "height": 0},
                "objects": [{"name": "town", "footprints": name, "layer": "multipolygons", "filter": {"building": "*"},
                             "height": 3, "features": "separate", "material": "Wall", **keys}]}

    def volumes(self, body, *said, **keys):
        """The buildings' volumes as shares of one whole square; the report has these notes alone."""
        scene = st.Read(st.write_scene(self.folder, "town", self.osm(body, **keys)))
        self.assertEqual(scene.errors, [], body)
        self.assertEqual([one for one in scene.strings("scene_report") if "triangles" not in one],
                         [f"town: {note}" for note in said], body)
        return [round(st.volume(st.corners(block)) / 22104, 2) for block in scene.blocks]

    def refused(self, body, words):
        self.assertIn(words, " ".join(st.Read(st.write_scene(self.folder, "town", self.osm(body))).errors))

    @staticmethod
    def way(number, *nodes, more=""):
        return f'<way id="{number}">' + "".join(f'<nd ref="{one}"/>' for one in nodes) + more + "</way>"

    @staticmethod
    def area(number, *members, more='<tag k="building" v="yes"/>'):
        return (f'<relation id="{number}">'
                + "".join(f'<member type="way" ref="{ref}" role="{role}"/>' for ref, role in members)
                + f'<tag k="type" v="multipolygon"/>{more}</relation>')

    # Squares of a thousandth of a degree: one of nodes 1 to 4, its courtyard (5 to 8) with 0.36 of the area, and
    # another building.
    NODES = "".join(f'<node id="{i}" lat="{53.6 + 1e-3 * y:.4f}" lon="{13.3 + 1e-3 * x:.4f}"/>'
                    for i, x, y in ((1, 0, 0), (2, 1, 0), (3, 1, 1), (4, 0, 1), (5, 0.2, 0.2), (6, 0.8, 0.2),
                                    (7, 0.8, 0.8), (8, 0.2, 0.8), (11, 5, 0), (12, 6, 0), (13, 6, 1), (14, 5, 1)))
    BUILDING = '<tag k="building" v="yes"/>'

    def test_incomplete_areas_of_osm_are_named(self):
        """As an extract's border leaves them, in every order, and what fits no filter is not named."""
        ring, court = self.way(1, 1, 2, 3, 4, 1), self.way(2, 5, 6, 7, 8, 5)
        other = self.way(19, 11, 12, 13, 14, 11, more=self.BUILDING)
        half = self.way(1, 1, 2, 3), self.way(3, 3, 4, 1)
        with_court, of_two = self.area(200, (1, "outer"), (2, "inner")), self.area(200, (1, "outer"), (3, "outer"))
        lacks, missing = "lack courtyards whose ways are missing or do not close", "with missing ways were left out"
        for body, expected, *said in (
                (ring + court + with_court, [0.64, 1]), (with_court + court + ring, [0.64, 1]),
                (ring + with_court, [1, 1], f"1 relations {lacks}: relation 200"),
                (ring + self.way(2, 5, 6, 7) + with_court, [1, 1], f"1 relations {lacks}: relation 200"),
                (court + with_court, [1], f"1 relations {missing}: relation 200"),
                (half[0] + of_two, [1], f"1 relations {missing}: relation 200"), ("".join(half) + of_two, [1, 1]),
                ('<node id="33" lat="53.601" lon="13.301"/>' + half[0] + self.way(3, 33, 4, 1) + of_two, [1, 1]),
                (half[0] + self.area(200, (1, "outer")), [1],
                 "1 relations whose outer ways do not close were left out: relation 200"),
                (self.area(200), [1], "1 relations without ways were left out: relation 200"),
                (self.area(200, more='<tag k="natural" v="wood"/>')
                 + half[0].replace("</way>", '<tag k="highway" v="path"/></way>'), [1]),
                (self.way(1, 1, 2, 3, 4, more=self.BUILDING), [1], "1 ways that are not closed were left out: way 1"),
                (self.way(1, 1, 2, 3, 77, 1, more=self.BUILDING), [0.5, 1],
                 "1 ways and relations lack corners whose nodes are missing: way 1"),
                (self.way(1, 77, 1, 2, 3, 77, more=self.BUILDING), [0.5, 1],
                 "1 ways and relations lack corners whose nodes are missing: way 1"),
                (self.way(1, 1, 2, 77, 78, 1, more=self.BUILDING), [1],
                 "1 ways of which too few nodes are in the file were left out: way 1"),
                (ring + self.area(200, (1, "outer"), (1, "outer")), [1, 1]),
                (ring + self.way(3, 3, 4, 1, 2, 3) + of_two, [1, 1],
                 "1 footprints with crossing or overlapping rings were repaired: town 1")):
            for text in (self.NODES + body + other, body + other + self.NODES):
                self.assertEqual(sorted(self.volumes(text, *said)), sorted(expected), body)

    def test_ways_of_other_relations_and_closed_lines_of_osm(self):
        """A building that is also the outline of a school stands, and a closed wall around an industrial site is a
        wall."""
        other = self.way(19, 11, 12, 13, 14, 11, more=self.BUILDING)
        ring, schools = self.way(1, 1, 2, 3, 4, 1, more=self.BUILDING), '<tag k="amenity" v="school"/>'
        for relation in (self.area(9, (1, "outer"), more=schools),
                         self.area(9, (1, "outer"), (19, "outer"), more=schools),
                         self.area(9, (1, "outer"), more='<tag k="name" v="A"/>'),
                         self.area(9, (1, "outer"), (77, "outer"), more=schools)):
            self.assertEqual(self.volumes(self.NODES + ring + other + relation), [1, 1], relation)
        tank = self.way(1, 1, 2, 3, 4, 1, more='<tag k="man_made" v="storage_tank"/><tag k="building:part" v="yes"/>')
        part = other.replace("</way>", '<tag k="building:part" v="yes"/></way>')
        self.assertEqual(self.volumes(self.NODES + tank + part, "1 closed ways that are lines by GDAL's rules were "
                                      "left out: way 1", filter={"building:part": "*"}), [1])
        whole = self.area(200, (1, "outer"))
        plain, member = self.way(1, 1, 2, 3, 4, 1), '<member type="{}" ref="{}" role="outer"/><tag'.format
        for body, expected, said in (
                (ring + whole.replace("multipolygon", "site"), [1, 1],
                 "1 relations that are not multipolygons were left out: relation 200"),
                (plain + whole.replace("<tag", member("relation", 5), 1), [1, 1],
                 "1 relations lack parts that are relations: relation 200"),
                (ring.replace('ref="4"', 'ref="4x"'), [0.5, 1],
                 "1 ways and relations lack corners whose nodes are missing: way 1"),
                (plain + whole.replace("<tag", member("way", "18x"), 1), [1],
                 "1 relations with missing ways were left out: relation 200")):
            self.assertEqual(sorted(self.volumes(self.NODES + other + body, said)), expected, body)
        self.refused(f'<osmChange version="0.6"><create>{self.NODES}{ring}</create></osmChange>',
                     "is a change of OpenStreetMap's data, expected a map")
        walls = [self.way(1, 1, 2, 3, 4, 1, more=f'<tag k="barrier" v="wall"/>{more}')
                 for more in ("", '<tag k="landuse" v="industrial"/>', self.BUILDING, '<tag k="area" v="yes"/>',
                              '<tag k="leisure" v="pitch"/><tag k="area" v="no"/>')]
        found = [self.volumes(self.NODES + wall, layer="lines", filter={"barrier": "wall"}, width=0.3)
                 for wall in walls]
        self.assertEqual(found, 5 * [found[0]])
        self.assertEqual(len(found[0]), 1)

    def test_repeated_and_deleted_objects_of_osm(self):
        ring = self.way(1, 1, 2, 3, 4, 1, more=self.BUILDING)
        other = self.way(19, 11, 12, 13, 14, 11, more=self.BUILDING)
        tagged = '<node id="1" lat="53.6" lon="13.3"><tag k="entrance" v="yes"/></node>'
        for body in (self.NODES + self.NODES + ring + ring, self.NODES + self.way(1, 1, 2) + ring + self.way(1),
                     tagged + self.NODES + ring, self.NODES + ring + tagged):
            self.assertEqual(self.volumes(body), [1])
        for mark in ("action='delete'", 'visible="false"'):
            self.assertEqual(self.volumes(self.NODES + ring + other.replace("<way", f"<way {mark}")
                                          + f'<node id="1" {mark} lat="0" lon="0"/>'), [1])

    def test_marks_of_xml_in_osm(self):
        ring = self.way(1, 1, 2, 3, 4, 1, more='<tag k="building" v="a &lt; &quot;b&quot;&#10;&amp; c"/>')
        wrong = '<node id="1" lat="x" lon="1">'
        for body in (f"<!-- it's {wrong} -->" + self.NODES,
                     f"<note><![CDATA[{wrong}]]></note><?none {wrong}?>" + self.NODES,
                     self.NODES.replace('lat="53.6', 'lat="5&#51;.6'),
                     self.NODES.replace("/>", "><!-- </node> '--></node >")):
            self.assertEqual(self.volumes(body + ring, filter={"building": 'a < "b"*& c'}), [1])
        corner = self.NODES.replace('id="3" lat="53', 'id="3" lat="{}53') + ring
        for name, sign in (("map.xml", "2"), ("x.osm.xml", "+-"), ("map", "2")):
            for head in ("", "\ufeff<?xml version='1.0' encoding='UTF-8'?>\n<!-- a map -->\n"):
                text = f'{head}<osm version="0.6">{corner.format(sign)}</osm>'
                self.assertEqual(self.volumes(text, "1 nodes whose place is not in degrees were left out: 3",
                                              "1 ways and relations lack corners whose nodes are missing: way 1",
                                              name=name), [0.5])
        self.refused(self.NODES.replace('lat="53', 'lat="253') + ring, "holds no features; 12 nodes whose place is not "
                     "in degrees were left out: 1, 2, 3, 4, 5, ...; 1 ways of which too few")
        self.assertEqual(self.volumes(self.NODES + ring + '<node id="1&#10;x" lat="1" lon="1"/>',
                                      '1 objects without a whole number as id were left out: node "1\\x0ax"'), [1])
        self.refused('<osm version="0.6">' + self.NODES + ring, "GDAL cannot read all of it: ")

    def test_long_names_and_line_breaks(self):
        square = [self.SQUARE]
        scene = self.plan("names.geojson", ("Polygon", square, {"name": "\u00e4" * 5000, "h": "x\ny"}),
                          ("Polygon", square, {"name": "a\navianlidar: error: fake"}), features="separate",
                          height_attribute="h", height=3)
        report = scene.strings("scene_report")
        self.assertLess(max(map(len, report)), 300)
        self.assertFalse([one for one in report if "\n" in one])
        self.assertIn("\u00e4" * 40 + "...: 12 triangles", " ".join(report))
        self.assertIn("a\\x0aavianlidar: error: fake: 12 triangles", " ".join(report))

    # --- what is said, and what is not

    def test_likely_mistakes_are_warnings(self):
        box, ground = {"file": "box.obj", "name": "Box"}, {"ground": {"size": 100}}
        far = {"file": "box.obj", "position": [678016, 5403455, 412]}
        inside = {"position": [1.5, 3, 1]}
        roof = {"ground": {"size": 10, "height": 5}}
        for objects, lidar, words in (
                ([box], inside, "the lidar is inside Box"), ([box], {**inside, "inside": True}, ""),
                ([ground], {"position": [0, 0, -1]}, "the lidar is under the scene"),
                ([ground, roof], {"position": [0, 0, 1]}, ""),
                ([far], inside, "box reaches more than 100 km from the origin"),
                ([{**far, "name": name} for name in "ABC"], inside,
                 "A and 2 more objects reach more than 100 km from the origin")):
            scene = self.read(*objects, silent=False, lidar=lidar)
            self.assertEqual(len(scene.warnings), int(bool(words)))
            self.assertIn(words, "".join(scene.warnings))

    def test_extents_and_degenerate_triangles_are_reported(self):
        self.save("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 3 1\nf 1 2 3\nf 1 2 4\nf 1 1 4\nl 1 2\n")
        scene = self.read({"file": "flat.obj", "name": "Flat"})
        self.assertIn("Flat: 3 triangles, 2 degenerate, east 0.00 to 2.00, north 0.00 to 3.00, up 0.00 to 1.00 m",
                      scene.strings("scene_report"))
        self.assertIn("Flat: 1 points or lines were left out", scene.strings("scene_report"))
        point = '{"type": "Point", "coordinates": [9, 4]}'
        self.save("trees.geojson", st.features(("Point", [3, 4], {}), ("Point", [9, 4], {})).replace(
            point, f'{{"type": "GeometryCollection", "geometries": [{point}]}}'))
        leaves = {"kind": "foliage", "leaf_area_density": 1}
        fog = self.read({"name": "Fog", "medium": {"kind": "fog", "visibility": 300, "shape": "everywhere"}},
                        {"footprints": "trees.geojson", "name": "Trees", "crs": "local", "height": 6, "width": 2,
                         "medium": leaves})
        self.assertEqual(fog.strings("scene_report")[-2:], [
            "Fog: a medium that is not bounded by triangles",
            "Trees: 2 ellipsoids, east 2.00 to 10.00, north 3.00 to 5.00, up 0.00 to 6.00 m"])
        self.assertEqual([scene.reader.CanReadFile(os.path.join(self.folder, name))
                          for name in ("scene.lidarscene.json", "flat.obj", "none.lidarscene.json", "")], [1, 0, 0, 0])

    def test_objects_of_one_file_are_as_if_each_were_alone(self):
        placed = [{}, {"position": [5, 0, 0], "scale": 2, "material": "Metal"}, {"rotation": 90, "up_axis": "y"},
                  {"material_map": {"glazed": "Glass", "*": "Wood"}, "position": [0, 7, 0], "up_axis": "z"}]
        for name in ("quads.obj", "box.gltf", "box.vtp"):
            objects = [{"file": name, "name": str(i), **more} for i, more in enumerate(placed)]
            scene = st.Read(st.write_scene(self.folder, "many", {
                "version": 1, "objects": [*objects[:2], {"file": "box.stl"}, *objects[2:]]}))
            for one in objects:
                block = scene.block(one["name"])
                own = st.Read(st.write_scene(self.folder, "one", {"version": 1, "objects": [one]})).blocks[0]
                np.testing.assert_array_equal(st.corners(block), st.corners(own))
                for array in ("material_id", "kd", "ks", "kp"):
                    np.testing.assert_array_equal(st.cells(block, array), st.cells(own, array))

    def test_the_collision_tree_shares_memory_with_the_reader(self):
        def arrays(surfaces):
            cells = surfaces.GetCellData()
            return [vtk_to_numpy(array)
                    for array in (surfaces.GetPoints().GetData(),
                                  *map(cells.GetArray, range(cells.GetNumberOfArrays())))]

        scene = self.read({"file": "box.obj", "name": "A"},
                          {"name": "Fog", "medium": {"kind": "fog", "visibility": 300, "shape": "everywhere"}},
                          {"file": "box.stl", "name": "B", "position": [5, 0, 0], "material": "Metal"}, silent=False)
        tree = vtkAvianLidar.vtkAvianLidarCollisionTree()
        blocks = scene.reader.GetOutput()
        tree.SetInputData(blocks)
        tree.Update()
        one, two, whole = blocks.GetBlock(0), blocks.GetBlock(2), arrays(tree.GetOutput())
        for first, last, all_ in zip(arrays(one), arrays(two), whole):
            np.testing.assert_array_equal(np.concatenate([first, last]), all_)
        self.assertTrue(all(np.shares_memory(block, all_) for part in (one, two)
                            for block, all_ in zip(arrays(part), whole)))
        copy = blocks.NewInstance()
        copy.DeepCopy(blocks)
        kept = [array.copy() for array in whole]
        copy.GetBlock(0).GetCellData().GetArray("kd").Fill(0.75)
        tree.SetInputData(copy)
        tree.Update()
        edited = arrays(tree.GetOutput())
        self.assertFalse(any(map(np.shares_memory, edited, whole)))
        self.assertEqual([np.array_equal(a, b) for a, b in zip(edited, kept)],
                         [True] * 3 + [False] + [True] * (len(kept) - 4))
        self.assertEqual(set(edited[3][:len(arrays(one)[3])]), {0.75})
        del scene, blocks, one, two, copy
        for after, before in zip(whole, kept):
            np.testing.assert_array_equal(after, before)

    def test_many_unmapped_names(self):
        self.save("many.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "".join(f"usemtl m{i}\nf 1 2 3\n" for i in range(13)))
        scene = self.read({"file": "many.obj"}, silent=False, material_map={})
        self.assertIn(" and 3 more: taken as Wall", scene.warnings[0])
