# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of mesh files, arrays and mappings, materials for each triangle, copies, what is shown of a scene, a sensor
and a scan, and warnings where a sensor can see nothing."""
import copy
import pickle
import subprocess
import sys
import types
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
import exampletools
from avianlidar import _sight
from boxfiles import CORNERS, TRIANGLES, obj, stl, y_up
from helpertools import WALL, box, same, warned
from scenetools import SHIPPED

OUTPUT = exampletools.emptied("helper-scenes")
BOUNDS = (1, 2, 2, 4, 0, 3)


def cells(scene, name):
    scene.number_of_triangles  # noqa: B018  # updates the tree
    return vtk_to_numpy(scene.tree.GetOutput().GetCellData().GetArray(name))


class Sources(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stl = OUTPUT / "hangar.stl"
        cls.stl.write_text(stl(CORNERS, TRIANGLES), "utf-8")
        cls.las = OUTPUT / "cloud.las"
        cls.las.write_bytes(b"LASF")

    def test_a_mesh_file(self):
        for file in (self.stl, str(self.stl)):
            self.assertEqual(warned(lambda: al.Scene(file))[1], [])
            scene = al.Scene(file)
            self.assertEqual((scene.objects, scene.bounds, scene.number_of_triangles), (["hangar"], BOUNDS, 12))
        scene = al.Scene(self.stl, scale=0.001, material="Metal", name="shed")
        self.assertEqual(scene.objects, ["shed"])
        self.assertTrue(np.allclose(scene.bounds, np.array(BOUNDS) * 0.001))
        self.assertEqual(set(cells(scene, "material_id")), {2})
        self.assertEqual(al.Scene(self.stl, scale=(1, 2, 3)).bounds, (1, 2, 4, 8, 0, 9))

    def test_the_axis_that_is_up(self):
        file = OUTPUT / "up.stl"
        file.write_text(stl(y_up(CORNERS), TRIANGLES), "utf-8")
        self.assertEqual(al.Scene(file, up_axis="y").bounds, BOUNDS)
        self.assertEqual(al.Scene(file, up_axis="z").bounds, (1, 2, 0, 3, -4, -2))

    def test_known_names_of_materials(self):
        file = OUTPUT / "panes.obj"
        file.write_text(obj(CORNERS, TRIANGLES, ("Glass", "paint")), "utf-8")
        self.assertRegex(" ".join(warned(lambda: al.Scene(file))[1]),
                         "no material or material_map for .*paint.*: taken as Wall")
        self.assertEqual(warned(lambda: al.Scene(file, material="Metal"))[1], [])
        self.assertEqual(sorted(cells(al.Scene(file), "material_id")), [0] * 6 + [1] * 6)

    def test_meshes_of_other_libraries(self):
        """By their attributes."""
        class PolyData(vtkPolyData):  # PyVista's is such a class
            pass

        theirs, corners = PolyData(), np.asarray(WALL[0], dtype=float)
        theirs.ShallowCopy(al.mesh(*WALL))
        # whose triangles are points
        trimesh = types.SimpleNamespace(vertices=corners, faces=WALL[1], triangles=corners[WALL[1]])
        meshes = [types.SimpleNamespace(vertices=WALL[0], triangles=WALL[1]),
                  types.SimpleNamespace(vertices=corners, faces=WALL[1]), trimesh]
        points = [types.SimpleNamespace(points=WALL[0])]
        wanted = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=5)).echoes
        for number, mesh in enumerate([theirs, *meshes]):
            with self.subTest(number):
                self.assertTrue(same(al.Scan(al.Scene(mesh, material="Wall"), al.Sensor(azimuth_step=5)).echoes,
                                     wanted))
        for cloud in (*points, theirs):
            self.assertEqual(al.Cloud(cloud).points.tolist(), corners.tolist())
        self.assertTrue(same(al.Cloud(wanted), wanted))

    def test_a_mapping(self):
        description = {"version": 1, "origin": {"latitude": 31, "longitude": 121, "height": 3},
                       "lidar": {"position": [0, 0, 2]}, "objects": [{"ground": {"size": 50}, "material": "Wall"},
                                                                     {"file": str(self.stl), "position": [9, 0, 0],
                                                                      "material": "Metal"}]}
        scene = al.Scene(description)
        self.assertEqual((scene.objects, scene.geodetic_origin, scene.lidar_position),
                         (["Ground", "hangar"], (31, 121, 3), (0, 0, 2)))
        with self.assertRaisesRegex(al.Error, r"scene: objects\[0\]\.grond"):
            al.Scene({"version": 1, "objects": [{"ground": {"size": 5}, "grond": 1}]})

    def test_a_material_for_each_triangle(self):
        names, known = np.array(["metal", "Glass"] * 6), al.materials()
        scene = al.Scene(*WALL, material=names)
        rows = np.array([(0.1 + 0.01 * (i % 3), 0.2, 30 + i % 3, 0.1 * (i % 3)) for i in range(12)])
        given, even = al.Scene(*WALL, material=rows), al.Scene(*WALL, material=rows[:, :3])
        for column, key in enumerate(("kd", "ks", "kp")):
            self.assertEqual(cells(scene, key).tolist(), [known[name.capitalize()][column] for name in names], key)
            self.assertEqual(cells(given, key).tolist(), rows[:, column].tolist(), key)
        self.assertEqual(cells(given, "roughness").tolist(), rows[:, 3].tolist())
        self.assertEqual((len(set(cells(even, "material_id"))), set(cells(even, "roughness"))), (3, {0}))
        self.assertEqual(len(set(cells(al.Scene(*WALL, material=["wall", "Wall"] * 6), "material_id"))), 1)
        count = 5000  # rows that all differ take no time
        points = np.random.default_rng(3).uniform(-50, 50, (3 * count, 3))
        scene = al.Scene(points, np.arange(3 * count).reshape(-1, 3),
                         material=np.random.default_rng(4).uniform(0, 0.4, (count, 3)))
        self.assertEqual(scene.number_of_triangles, count)
        self.assertEqual(al.Scene(self.stl, material=["Wood"] * 12).number_of_triangles, 12)

    def test_errors_say_what_is_expected(self):
        text = OUTPUT / "text.stl"
        text.write_text("no mesh", "utf-8")
        points, faces = WALL
        for kind, words, call in (
                (TypeError, "material=", lambda: al.Scene(self.stl, "Glass")),
                (TypeError, "not int", lambda: al.Scene(3)),
                (TypeError, "complex128", lambda: al.Scene(points * 1j, faces)),
                (ValueError, r"\(8, 2\)", lambda: al.Scene(points[:, :2], faces)),
                (ValueError, r"\(12,\)", lambda: al.Scene(points, faces[:, 0])),
                (TypeError, "float64", lambda: al.Scene(points, faces * 1.0)),
                (IndexError, "there are 8", lambda: al.Scene(points, faces + 1)),
                (TypeError, r"\(8, 3\) without faces", lambda: al.Scene(points)),
                (TypeError, "3 is not a text", lambda: al.Scene(WALL, name=3)),
                (ValueError, "scale is nan", lambda: al.Scene(self.stl, scale=float("nan"))),
                (TypeError, "scale is for mesh files", lambda: al.Scene(WALL, scale=2)),
                (al.Error, "up_axis: ", lambda: al.Scene(self.stl, up_axis="x")),
                (TypeError, "material is 7", lambda: al.Scene(*WALL, material=7)),
                (ValueError, r"shape \(3,\) for 12 triangles", lambda: al.Scene(*WALL, material=["Glass"] * 3)),
                (al.Error, "Kd", lambda: al.Scene(*WALL, material=np.full((12, 3), 2.0))),
                (ValueError, "has no surfaces", lambda: al.Scene(self.las)),
                (al.Error, "text.stl: ", lambda: al.Scene(text)),
                (FileNotFoundError, "none.stl", lambda: al.Scene("none.stl")),
                (TypeError, "a sensor is .*not int", lambda: al.Scan(al.Scene(), 7))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()

    def test_any_beams(self):
        sensor = al.Sensor("Airport16")
        expected = al.Scan(al.Scene(WALL), sensor).echoes
        for beams in ("Airport16", "airport_16", sensor.beams, sensor.beams.data, sensor.algorithm):
            self.assertTrue(same(al.Scan(al.Scene(WALL), beams).echoes, expected), type(beams))


class Copies(unittest.TestCase):
    def test_scenes(self):
        scene = al.Scene(SHIPPED)
        scene.add(box((199, 299, 0), (201, 301, 30)), material="Metal", name="mast")
        scene.tree.SetMaximumLeafSize(7)
        sensor = al.Sensor(azimuth_step=2)
        expected = al.Scan(scene, sensor, noise=False).echoes
        for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene), copy.copy(scene)):
            self.assertEqual((again.objects, again.materials, again.bounds, again.geodetic_origin,
                              again.lidar_position), (scene.objects, scene.materials, scene.bounds,
                                                      scene.geodetic_origin, scene.lidar_position))
            self.assertEqual(again.tree.GetMaximumLeafSize(), 7)
            self.assertTrue(same(al.Scan(again, sensor, noise=False).echoes, expected))
            again.add(WALL, name="wall")  # a copy does not change the first
            self.assertEqual(len(again.objects), len(scene.objects) + 1)
        self.assertEqual(pickle.loads(pickle.dumps(al.Scene())).number_of_triangles, 0)

    def test_a_scan_is_not_copied(self):
        scan = al.Scan(al.Scene(WALL))
        for call in (lambda: copy.copy(scan), lambda: copy.deepcopy(scan), lambda: pickle.dumps(scan)):
            with self.assertRaisesRegex(TypeError, "copy its scene and its sensor"):
                call()


class Shown(unittest.TestCase):
    def test_words(self):
        scene, sensor = al.Scene(SHIPPED), al.Sensor("Airport16", position=(0, 0, 3))
        scan = al.Scan(scene, sensor)
        scan.update()
        scan.seed = 5
        self.assertRegex(repr(scan), "not yet run")
        number = scan.echoes.number_of_points
        self.assertRegex(repr(scan), f"<Scan: beams 15360; echoes {number}; ")
        self.assertRegex(repr(scene), "<Scene: cells 5510; extent east -6000 to 6000")
        east, north = (axis.ravel() for axis in np.meshgrid(np.arange(150.0), np.arange(150.0)))
        corner = np.arange(150 * 150).reshape(150, 150)[:-1, :-1].ravel()
        hills = al.Scene(np.column_stack([east, north, np.sin(east / 20)]),
                         np.column_stack([corner, corner + 1, corner + 150]))
        # the last has too many triangles for their outlines
        for thing, rows in ((scan, 4), (scene, 6), (sensor, 11), (hills, 4)):
            page = thing._repr_html_()
            self.assertEqual(page.count("<tr>"), rows)
            self.assertRegex(page, r"<img alt='picture' src='data:image/png;base64,[A-Za-z0-9+/=]{1000,}'/>")

    def test_representations_show_failures(self):
        self.assertIn("<Scene: cells 0", repr(al.Scene()))
        self.assertIn("<table>", al.Scene()._repr_html_())
        foggy = al.Scan(al.Scene(WALL), al.Sensor("Search905", azimuth_step=5), visibility=300).update()
        self.assertIn("limit nothing beyond", repr(foggy))
        self.assertNotIn("limit", repr(foggy.set(visibility=50000).update()))
        bad = al.Sensor(range_gate=-1)
        self.assertRegex(repr(bad), "<Sensor: .*RangeGate")
        self.assertRegex(bad._repr_html_(), "<b>Sensor</b> .*RangeGate")

    def test_a_table_of_pandas(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("there is no pandas")
        echoes = al.Scan(al.Scene(WALL), "Search905").echoes
        frame = echoes.to_pandas()
        self.assertEqual(frame.shape, (echoes.number_of_points, 3 + len(echoes)))
        self.assertTrue(np.array_equal(frame[["x", "y", "z"]], echoes.points))
        self.assertEqual(frame["energy"].tolist(), echoes["energy"].tolist())
        self.assertEqual((frame.attrs["units"]["energy"], frame.attrs["fields"]["range_gate"]), ("J", 4000))
        self.assertEqual([frame.attrs["units"].get(axis) for axis in "xyz"], ["m"] * 3)
        self.assertEqual(len(pandas.concat([frame, frame])), 2 * len(frame))  # its attributes can be compared

    def test_without_pandas_and_matplotlib(self):
        program = ("import sys; sys.modules['pandas'] = sys.modules['matplotlib'] = None\nimport avianlidar as "
                   "al\npage = al.Sensor()._repr_html_()\nassert '<table>' in page and '<img' not in page\ntry:\n "
                   "al.Sensor().beams.to_pandas()\nexcept ImportError as error:\n assert 'needs pandas' in "
                   "str(error)\nelse:\n assert False")
        subprocess.run([sys.executable, "-c", program], check=True)


class NothingToSee(unittest.TestCase):
    """Warnings of scans that see nothing, or of scenes that are not as they were meant."""

    def words(self, scene, **sensor):
        return warned(al.Scan(scene, al.Sensor(azimuth_step=5, **sensor)).update)[1]

    def test_likely_mistakes_are_named(self):
        airport, walls = al.Scene(SHIPPED), al.Scene(WALL)
        hill = al.Scene([(-500, -500, 0), (500, -500, 0), (500, 500, 40), (-500, 500, 40)], [(0, 1, 2), (0, 2, 3)])
        tall = np.concatenate([box((-50, 300, 0), (50, 340, 12))[0], box((80, -300, 0), (90, -290, 30))[0]])
        faces = np.concatenate([WALL[1], WALL[1] + 8])
        millimetres = r"the scene extends east -.*millimetres, read it with the scale 0.001"
        for scene, sensor, words in (
                (airport, {"position": (0, 0, -50)},
                 "^the sensor at .0, 0, -50. m is below the scene, .* 0 m no echoes of 1152 beams: "),
                (hill, {"position": (0, 0, 10)}, "has surfaces above it and none below"),
                (al.Scene(box((-20, 50000, -5), (20, 50002, 15))), {},
                 "no echoes of .* 50000 m away or more, the range gate ends at 4000 m$"),
                (walls, {"minimum_elevation": 40},
                 "^no echoes of 1152 beams: no surface 1152; the beams point 40 to 45.62 deg up, .* north 50 to 52"),
                (walls, {"pulse_energy": 1e-12}, r"^no echoes of 1152 beams: .*below the lower limit \d+$"),
                (al.Scene(box((-900, 9000, 0), (900, 13500, 1500))), {}, millimetres),
                (al.Scene(y_up(tall), faces), {}, "lowest point is 340 m below the origin.*read it with the up axis y"),
                (al.Scene(box((346600, 3451000, 3), (346700, 3451100, 30))), {"position": (0, 0, 3)},
                 "of a map, such as UTM")):
            with self.subTest(words):
                self.assertRegex(" ".join(self.words(scene, **sensor)), words)
        self.assertNotIn("none below", " ".join(self.words(hill, position=(0, 0, 30))))
        self.assertNotIn("up axis y", " ".join(self.words(al.Scene(tall, faces))))

    def test_a_place_inside_a_closed_surface(self):
        """Also where triangles are single, twice there or turned, of one of two solids in an object, below a roof on
        walls without a floor, in a room of thick walls and in such a wall, and on a diagonal; not beside a solid, in an
        open box or below a loose roof."""
        low, high = np.array([-4.0, -3, 0]), np.array([4.0, 3, 5])
        points, faces = box(low, high)
        soup = points[faces.ravel()], np.arange(36).reshape(-1, 3)
        others = np.concatenate([points, points + (20, 0, 0)]), np.concatenate([faces, faces + 8])
        room = np.concatenate([points, box(low + 1, high - 1)[0]]), others[1]
        normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
        down, up = ((normals[:, 2] != 0) & (points[faces][:, :, 2].max(axis=1) == z) for z in (0, 5))
        twice = np.concatenate([faces, faces[:, ::-1]])
        for name, (corners, triangles), place, expected in (
                ("box", (points, faces), (0, 0, 2), True), ("beside", (points, faces), (9, 0, 2), False),
                ("above", (points, faces), (0, 0, 9), False), ("below", (points, faces), (0, 0, -2), False),
                ("turned", (points, np.where(np.arange(12)[:, None] % 2, faces, faces[:, ::-1])), (0, 0, 2), True),
                ("single", soup, (1, 1, 2), True), ("twice", (points, twice), (1, 1, 2), True),
                ("second", others, (20, 0, 2), True), ("between", others, (10, 0, 2), False),
                ("no floor", (points, faces[~down]), (0, 0, 2), True),
                ("no roof", (points, faces[~up]), (0, 0, 2), False), ("roof", (points, faces[up]), (0, 0, 2), False),
                ("room", room, (0, 0, 2), True), ("in a wall", room, (3.5, 0, 2), True),
                ("diagonal", (points, faces), (1.6, 1.2, 2), True)):
            with self.subTest(name):
                ground = al.mesh([(-90, -90, -0.5), (90, -90, -0.5), (90, 90, -0.5), (-90, 90, -0.5)],
                                 [(0, 1, 2), (0, 2, 3)])
                scene = al.Scene(ground, material="Grass", name="ground")
                scene.add((corners, triangles), material="Wall", name=name)
                words = [text for text in self.words(scene, position=place) if "closed surface" in text]
                self.assertEqual([f"is inside the closed surface of '{name}'" in text for text in words],
                                 [True] * expected)
        with self.assertWarnsRegex(RuntimeWarning, "inside the closed surface of 'object'"):
            al.Coverage(al.Scene(al.mesh(points, faces), material="Wall", name="object"),
                        al.Sensor("Search905", position=(0, 0, 2)), places=[(0, 9, 2)]).update()

    def test_scenes_that_are_as_meant(self):
        """Each has echoes, or nothing wrong but that."""
        for scene, place in ((SHIPPED, (0, 0, 3)), (SHIPPED, (0, 0, 0)), (box((-20, 50, 0.3), (20, 52, 15)), (0, 0, 0)),
                             (box((-10, 300, 40), (10, 320, 60)), (0, 0, 32)),
                             (box((-15, 0, -10), (15, 0.2, 20)), (0, -60, 3)),
                             (box((-5, 0, -30), (5, 10, 30)), (0, -60, 3))):
            self.assertEqual(self.words(al.Scene(scene), position=place), [], place)
        self.assertEqual(list(_sight.of_scene((-10000, 10000, -10000, 10000, 1500, 4000))), [])  # hills
        bird = al.mover(al.mesh(*box((-1, 80, 2), (1, 82, 4))), [(0, 0, 0)])
        self.assertEqual(warned(al.Scan(al.Scene(), al.Sensor(), movers=[bird]).update)[1], [])

    def test_said_once_and_when_it_runs_only(self):
        scan = al.Scan(al.Scene(SHIPPED), al.Sensor(position=(0, 0, -50), azimuth_step=5))
        self.assertEqual([len(warned(scan.update)[1]) for _ in range(3)], [2, 0, 0])
        scan.attenuation_coefficient = 1e-5
        self.assertRegex(" ".join(warned(lambda: scan["energy"])[1]), "^no echoes of")
        scan.sensor.position = (0, 0, -40)
        self.assertRegex(" ".join(warned(scan.update)[1]), r"^the sensor at \(0, 0, -40\) m")
