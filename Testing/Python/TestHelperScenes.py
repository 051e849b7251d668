# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of mesh files, arrays and mappings, materials for each triangle, copies, what is shown of a scene, a sensor and a
scan, and warnings where a sensor can see nothing."""
import copy
import itertools
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import types
import unittest
import warnings

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPartitionedDataSetCollection, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import avianlidar as al
from avianlidar import _display, _sight
from avianlidar import vtkAvianLidar as wrapped
from boxfiles import CORNERS, TRIANGLES, obj, stl, y_up
from helpertools import WALL, box, same

OUTPUT = pathlib.Path(os.environ.get("AVIANLIDAR_TEST_OUTPUT_DIR", "/tmp")) / "helper-scenes"
SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
BOUNDS = (1, 2, 2, 4, 0, 3)


def cells(scene, name):
    return vtk_to_numpy(al.Scan(scene).update().scene.tree.GetOutput().GetCellData().GetArray(name))


def parts(source, **arguments):
    """What a scene consists of once a source was added to it, by what an argument may change."""
    scene = al.Scene()
    warned = said(lambda: (scene.add(source, **arguments), scene.number_of_triangles))
    merged = scene.tree.GetOutput()
    values = {array.GetName(): vtk_to_numpy(array).tolist() for array in map(merged.GetCellData().GetArray, range(
        merged.GetCellData().GetNumberOfArrays()))}
    ids, fields = values.pop("object_id"), al.Cloud(merged).fields
    materials, objects = scene.materials, scene.objects
    return {"surface": (scene.bounds, scene.number_of_triangles), "place": (scene.geodetic_origin, scene.lidar_position),
            "material": (warned, [materials[number] for number in values.pop("material_id")], values),
            "name": [objects[number] for number in ids],
            "object": (ids, fields.get("object_classes"), str(fields.get("media")).replace("gull 1", "Medium"))}


def bird():
    source = wrapped.vtkAvianLidarBirdSource()
    source.SetPosition(0, 60, 5)
    source.SetObjectId(7)
    source.Update()
    return source


def said(run):
    """The texts of the warnings of a call."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run()
    return [str(warning.message) for warning in caught]


class Sources(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(OUTPUT, ignore_errors=True)
        OUTPUT.mkdir(parents=True)
        cls.stl = OUTPUT / "hangar.stl"
        cls.stl.write_text(stl(CORNERS, TRIANGLES), encoding="utf-8")
        cls.las = OUTPUT / "cloud.las"
        cls.las.write_bytes(b"LASF")

    def test_a_mesh_file(self):
        for file in (self.stl, str(self.stl)):
            self.assertEqual(said(lambda: al.Scene(file)), [])
            scene = al.Scene(file)
            self.assertEqual((scene.objects, scene.bounds, scene.number_of_triangles), (["hangar"], BOUNDS, 12))
        scene = al.Scene(self.stl, scale=0.001, material="Metal", name="shed")
        self.assertEqual(scene.objects, ["shed"])
        self.assertTrue(np.allclose(scene.bounds, np.array(BOUNDS) * 0.001))
        self.assertEqual(set(cells(scene, "material_id")), {2})
        self.assertEqual(al.Scene(self.stl, scale=(1, 2, 3)).bounds, (1, 2, 4, 8, 0, 9))

    def test_the_axis_that_is_up(self):
        file = OUTPUT / "up.stl"
        file.write_text(stl(y_up(CORNERS), TRIANGLES), encoding="utf-8")
        self.assertEqual(al.Scene(file, up_axis="y").bounds, BOUNDS)
        self.assertEqual(al.Scene(file, up_axis="z").bounds, (1, 2, 0, 3, -4, -2))

    def test_known_names_of_materials(self):
        file = OUTPUT / "panes.obj"
        file.write_text(obj(CORNERS, TRIANGLES, ("Glass", "paint")), encoding="utf-8")
        self.assertRegex(" ".join(said(lambda: al.Scene(file))), "no material or material_map for .*paint.*: taken as Wall")
        self.assertEqual(said(lambda: al.Scene(file, material="Metal")), [])
        self.assertEqual(sorted(cells(al.Scene(file), "material_id")), [0] * 6 + [1] * 6)

    def test_an_argument_changes_nothing_else(self):
        files = {name: OUTPUT / name for name in ("Glass.obj", "Metal.stl", "bird.vtp")}
        files["Glass.obj"].write_text(obj(CORNERS, TRIANGLES, ("Glass", "Wood")), encoding="utf-8")
        files["Metal.stl"].write_text(stl(CORNERS, TRIANGLES), encoding="utf-8")
        writer = vtkXMLPolyDataWriter()
        writer.SetInputData(bird().GetOutput())
        writer.SetDataModeToBinary()
        writer.SetFileName(str(files["bird.vtp"]))
        writer.Write()
        blocks = vtkMultiBlockDataSet()
        for number, surface in enumerate((bird().GetOutput(), al.Scene(WALL, material="Glass", name="pane").surfaces.GetBlock(0))):
            blocks.SetBlock(number, surface)
        house = {"file": str(files["Glass.obj"]), "name": "house", "class": "house", "material_map": {"*": "Grass"}}
        scene = {"version": 1, "origin": {"latitude": 31, "longitude": 121, "height": 3}, "lidar": {"position": [0, 0, 2]}, "objects": [house]}
        tree = {"kind": "foliage", "leaf_area_density": 1, "shape": "box", "center": [9, 9, 9], "lengths": [2, 2, 2]}
        sources = {"bird": bird(), "data": bird().GetOutput(), "blocks": blocks, "bare": al.mesh(*WALL), "arrays": WALL, "scene": scene,
                   "wood": {**scene, "objects": [{"ground": {"size": 9}, "material": "Wood"}, {"medium": tree}]}, **files}
        for name, source in sources.items():
            choices = [("", {}), ("name", {"name": "gull 1"}), ("progress", {"progress": lambda *_: None}),
                       ("material", {"material": "Metal"}), ("material", {"material": (0.1, 0.2, 30, 0.5)})]
            if name not in ("blocks", "wood"):
                choices.append(("material", {"material": ["Wood"] * parts(source)["surface"][1]}))
            if name in files:
                choices += [("scale", {"scale": 1}), ("up_axis", {"up_axis": "z"})]
            found = [(what, values, parts(source, **values)) for what, values in choices]
            for (one, values, alone), (other, more, beside) in itertools.combinations(found, 2):
                both = parts(source, **values, **more) if one != other else {}
                for part, value in both.items():
                    with self.subTest(name, part=part, arguments=(one, other)):
                        self.assertTrue(part == one or value == beside[part])
                        self.assertTrue(part == other or value == alone[part])
        echoes = [al.Scan(al.Scene(bird(), name=name), "Search905", noise=False).echoes for name in (None, "gull 1")]
        self.assertTrue(same(*echoes) and echoes[0].number_of_points > 0)

    def test_the_name_of_a_mesh_file_says_nothing_of_its_material(self):
        file = OUTPUT / "Wood.obj"
        for content, expected in ((obj(CORNERS, TRIANGLES, ("Wood",)), "Wood"), (obj(CORNERS, TRIANGLES).replace("usemtl", "#"), "Wall")):
            file.write_text(content, encoding="utf-8")
            scene = al.Scene(file)
            self.assertEqual({scene.materials[number] for number in cells(scene, "material_id")}, {expected})

    def test_arrays(self):
        one, other = al.Scene(*WALL, material="Glass"), al.Scene(WALL, material="Glass")
        self.assertTrue(same(al.Scan(one).echoes, al.Scan(other).echoes))
        self.assertEqual(al.Scene(WALL[0].tolist(), WALL[1].tolist()).bounds, one.bounds)

    def test_meshes_of_other_libraries(self):
        """By their attributes; Open3D's own, too, where it is."""
        class PolyData(vtkPolyData):  # PyVista's is such a class
            pass

        theirs, corners = PolyData(), np.asarray(WALL[0], dtype=float)
        theirs.ShallowCopy(al.mesh(*WALL))
        meshes = [types.SimpleNamespace(vertices=WALL[0], triangles=WALL[1]), types.SimpleNamespace(vertices=corners, faces=WALL[1])]
        clouds = [types.SimpleNamespace(points=WALL[0])]
        try:
            import open3d
        except ImportError:
            pass
        else:
            points = open3d.utility.Vector3dVector(corners)
            meshes.append(open3d.geometry.TriangleMesh(points, open3d.utility.Vector3iVector(np.asarray(WALL[1]))))
            clouds.append(open3d.geometry.PointCloud(points))
        wanted = al.Scan(al.Scene(WALL)).echoes
        for number, mesh in enumerate([theirs, *meshes]):
            with self.subTest(number):
                self.assertTrue(same(al.Scan(al.Scene(mesh, material="Wall")).echoes, wanted))
        self.assertTrue(same(al.Scan(al.Scene(meshes[0])).echoes, wanted))
        for cloud in clouds:
            self.assertEqual(al.Cloud(cloud).points.tolist(), corners.tolist())
            al.save(cloud, OUTPUT / "points.csv")
            self.assertEqual(al.load_cloud(OUTPUT / "points.csv").points.tolist(), corners.tolist())
        self.assertEqual(al.Cloud(theirs).number_of_points, len(corners))
        self.assertTrue(same(al.Cloud(wanted), wanted))
        with self.assertRaisesRegex(ValueError, r"triangles have the shape \(1, 4\), expected \(m, 3\)"):
            al.Scene(types.SimpleNamespace(vertices=corners, faces=[(0, 1, 2, 3)]))
        with self.assertRaisesRegex(ValueError, r"points have the shape \(3, 2\), expected \(n, 3\)"):
            al.Cloud(types.SimpleNamespace(points=corners[:3, :2]))

    def test_a_mapping(self):
        description = {"version": 1, "origin": {"latitude": 31, "longitude": 121, "height": 3}, "lidar": {"position": [0, 0, 2]},
                       "objects": [{"ground": {"size": 50}, "material": "Wall"},
                                   {"file": str(self.stl), "position": [9, 0, 0], "material": "Metal"}]}
        scene = al.Scene(description)
        self.assertEqual(scene.objects, ["Ground", "hangar"])
        self.assertEqual(scene.geodetic_origin, (31, 121, 3))
        self.assertEqual(scene.lidar_position, (0, 0, 2))
        with self.assertRaisesRegex(al.Error, r"scene: objects\[0\]\.grond"):
            al.Scene({"version": 1, "objects": [{"ground": {"size": 5}, "grond": 1}]})

    def test_a_material_for_each_triangle(self):
        names = np.array(["metal", "Glass"] * 6)
        scene = al.Scene(*WALL, material=names)
        known = al.materials()
        for key, column in (("kd", 0), ("ks", 1), ("kp", 2)):
            self.assertEqual(cells(scene, key).tolist(), [known[name.capitalize()][column] for name in names], key)
        rows = np.array([(0.1 + 0.01 * (i % 3), 0.2, 30 + i % 3) for i in range(12)])
        scene = al.Scene(*WALL, material=rows)
        for key, column in (("kd", 0), ("ks", 1), ("kp", 2)):
            self.assertEqual(cells(scene, key).tolist(), rows[:, column].tolist(), key)
        self.assertEqual(len(set(cells(scene, "material_id"))), 3)
        self.assertEqual(set(cells(scene, "roughness")), {0})
        rough = np.column_stack([rows, np.linspace(0, 1.5, 12)])
        self.assertEqual(cells(al.Scene(*WALL, material=rough), "roughness").tolist(), rough[:, 3].tolist())
        scene = al.Scene(*WALL, material=["wall", "Wall"] * 6)
        self.assertEqual(len(set(cells(scene, "material_id"))), 1)
        count = 20000  # rows that all differ are no work
        points = np.random.default_rng(3).uniform(-50, 50, (3 * count, 3))
        scene = al.Scene(points, np.arange(3 * count).reshape(-1, 3), material=np.random.default_rng(4).uniform(0, 0.4, (count, 3)))
        self.assertEqual(scene.number_of_triangles, count)
        self.assertEqual(al.Scene(self.stl, material=["Wood"] * 12).number_of_triangles, 12)
        self.assertTrue(same(al.Scan(al.Scene(*WALL, material=["Metal"] * 12), noise=False).echoes,
                             al.Scan(al.Scene(*WALL, material="Metal"), noise=False).echoes))

    def test_rough_ground_is_seen_farther(self):
        ground = ([(-9, 1, 0), (9, 1, 0), (9, 5000, 0), (-9, 5000, 0)], [(0, 1, 2), (0, 2, 3)])
        # At 80 degrees of incidence; half the beam's width changes the cosine by 0.06 %.
        sensor = al.Sensor("Airport16", channel_elevations=[-10.0], azimuth_range=(0, 0.1), half_beamwidth=1e-4,
                           position=(0, 0, 10), lower_energy_limit=1e-12)

        def energies(scene):
            return al.Scan(scene, sensor, reflectance_model="OrenNayar", number_of_reflections=1, noise=False,
                           attenuation_coefficient=0).echoes["return_energy"]

        for slope in (0.0, 0.52):
            scene = al.Scene(*ground, material=(0.2, 0, 1, slope))
            even, facets = 1 - 0.5 * slope**2 / (slope**2 + 0.33), 0.45 * slope**2 / (slope**2 + 0.09)
            expected = 3.6e-4 * 0.2 * (even * np.sin(np.radians(10)) + facets * np.cos(np.radians(10)) ** 2)
            np.testing.assert_allclose(energies(scene), [expected], rtol=3e-3)
            bare = vtkPolyData()  # a surface without the array is even
            bare.DeepCopy(scene.surfaces.GetBlock(0))
            bare.GetCellData().RemoveArray("roughness")
            self.assertEqual(np.array_equal(energies(al.Scene(bare)), energies(scene)), slope == 0.0)

    def test_a_mesh_of_trimesh(self):
        """Its `triangles` are points: the corners of each face."""
        class Trimesh:
            vertices, faces = np.array(WALL[0], float), np.array(WALL[1])
            triangles = vertices[faces]
        scene = al.Scene(Trimesh())
        self.assertEqual((scene.number_of_triangles, scene.bounds), (12, al.Scene(*WALL).bounds))

    def test_errors_say_what_is_expected(self):
        text = OUTPUT / "text.stl"
        text.write_text("no mesh", encoding="utf-8")
        cases = ((TypeError, "takes n rows of x, y, z and m rows of three indices, not .*; a material is given as material=", lambda: al.Scene(self.stl, "Glass")),
                 (TypeError, "takes n rows .*, not tuple and tuple", lambda: al.Scene(WALL, (0.1, 0.2, 30))),
                 (TypeError, "not PosixPath and list", lambda: al.Scene(self.stl, [(0, 1, 2)] * 100000)),
                 (TypeError, "points are of the type complex128", lambda: al.Scene(WALL[0] * 1j, WALL[1])),
                 (TypeError, "not tuple$", lambda: al.Scene(("a.stl", "b.stl"))),
                 (TypeError, "3 is no text", lambda: al.Scene(WALL, name=3)),
                 (TypeError, "vtkMultiBlockDataSet of it, not vtkPartitionedDataSetColl", lambda: al.Scene(vtkPartitionedDataSetCollection())),
                 (TypeError, "scale is 'mm', expected a number", lambda: al.Scene(self.stl, scale="mm")),
                 (ValueError, "scale is nan, expected finite", lambda: al.Scene(self.stl, scale=float("nan"))),
                 (TypeError, "neither names nor rows", lambda: al.Scene(*WALL, material=np.array(["Glass", None] * 6, object))),
                 (ValueError, "has no surfaces, expected a mesh", lambda: al.Scene(self.las)),
                 (ValueError, "is no ordinary file", lambda: al.Scene(OUTPUT)),
                 (TypeError, r"points of the shape \(8, 3\) without faces", lambda: al.Scene(WALL[0])),
                 (TypeError, "material is 7, expected a name .Wall, Glass", lambda: al.Scene(*WALL, material=7)),
                 (TypeError, r"material is \(1, 2\), expected a name", lambda: al.Scene(*WALL, material=(1, 2))),
                 (ValueError, r"shape \(3,\) for 12 triangles", lambda: al.Scene(*WALL, material=["Glass"] * 3)),
                 (ValueError, "'Glas' is not known; did you mean 'Glass'", lambda: al.Scene(*WALL, material=["Glas"] * 12)),
                 (al.Error, "Kd", lambda: al.Scene(*WALL, material=np.full((12, 3), 2.0))),
                 (al.Error, "K[ds] is nan", lambda: al.Scene(*WALL, material=[(0.1, 0.2, 30)] * 11 + [(0.1, float("nan"), 30)])),
                 (TypeError, "scale is for mesh files", lambda: al.Scene(WALL, scale=2)),
                 (TypeError, "up_axis of a scene: expected a mesh file", lambda: al.Scene(SCENE, up_axis="y")),
                 (al.Error, "^/[^:]*hangar.stl: scale: must be greater than 0, is -1", lambda: al.Scene(self.stl, scale=-1)),
                 (al.Error, 'up_axis: must be "y" or "z"', lambda: al.Scene(self.stl, up_axis="x")),
                 (al.Error, "^/[^:]*text.stl: [^:]*Assimp", lambda: al.Scene(text)), (ValueError, "ends in .lidarscene.json", lambda: al.Scene(os.path.join(
                     os.environ["AVIANLIDAR_SOURCE_DIR"], "CMakePresets.json"))),
                 (FileNotFoundError, "no such file: none.stl", lambda: al.Scene("none.stl")),
                 (TypeError, "a sensor is a Sensor, a preset's name, .*not int", lambda: al.Scan(al.Scene(), 7)),
                 (ValueError, "did you mean 'Airport16'", lambda: al.Scan(al.Scene(), "Airport17")))
        for kind, words, call in cases:
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        self.assertEqual(al.Scene(self.stl).bounds, BOUNDS)

    def test_any_beams(self):
        scene = al.Scene(SCENE)
        sensor = al.Sensor("Airport16", position=scene.lidar_position)
        expected = al.Scan(scene, sensor).echoes
        for beams in ("Airport16", "airport_16", sensor.beams, sensor.beams.data, sensor.algorithm):
            self.assertTrue(same(al.Scan(scene, beams).echoes, expected), type(beams))


class Copies(unittest.TestCase):
    def test_scenes(self):
        scene = al.Scene(SCENE)
        scene.add(box((199, 299, 0), (201, 301, 30)), material="Metal", name="mast")
        scene.tree.SetMaximumLeafSize(7)
        expected = al.Scan(scene, noise=False).echoes
        for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene), copy.copy(scene)):
            self.assertEqual((again.objects, again.materials, again.bounds, again.geodetic_origin, again.lidar_position),
                             (scene.objects, scene.materials, scene.bounds, scene.geodetic_origin, scene.lidar_position))
            self.assertEqual(again.tree.GetMaximumLeafSize(), 7)
            self.assertTrue(same(al.Scan(again, noise=False).echoes, expected))
            again.add(WALL, name="wall")  # a copy does not change the first
            self.assertEqual(len(again.objects), len(scene.objects) + 1)
        self.assertEqual(pickle.loads(pickle.dumps(al.Scene())).number_of_triangles, 0)

    def test_sensors(self):
        sensor = al.Sensor("Search905", position=(1, 2, 3), channel_elevations=(1, 3, 2), sway_amplitude=0.1)
        for again in (pickle.loads(pickle.dumps(sensor)), copy.deepcopy(sensor)):
            self.assertEqual(again.properties(), sensor.properties())
            self.assertTrue(same(again.beams, sensor.beams))


class Shown(unittest.TestCase):
    def test_words(self):
        scene, sensor = al.Scene(SCENE), al.Sensor("Airport16", position=(0, 0, 3))
        scan = al.Scan(scene, sensor)
        self.assertRegex(repr(scan), "not yet run")
        scan.update()
        scan.seed = 5
        self.assertRegex(repr(scan), "not yet run")
        number = scan.echoes.number_of_points
        self.assertRegex(repr(scan), f"<Scan: beams 15360; echoes {number}; ")
        self.assertRegex(repr(scene), "<Scene: cells 5510; extent east -6000 to 6000, north .* up 0 to 25 m; origin .*; lidar ")
        self.assertRegex(repr(sensor), r"<Sensor: beams 15360; channels 16; .*position \(0, 0, 3\) m; wavelength 904")
        for thing, rows in ((scan, 4), (scene, 6), (sensor, 11)):
            page = thing._repr_html_()
            self.assertEqual(page.count("<tr>"), rows)
            self.assertRegex(page, r"<img alt='picture' src='data:image/png;base64,[A-Za-z0-9+/=]{1000,}'/>")

    def test_what_fails_is_shown_all_the_same(self):
        self.assertIn("<Scene: cells 0", repr(al.Scene()))
        self.assertIn("<table>", al.Scene()._repr_html_())
        bad = al.Sensor(range_gate=-1)
        self.assertRegex(repr(bad), "<Sensor: .*RangeGate")
        self.assertRegex(bad._repr_html_(), "<b>Sensor</b> .*RangeGate")

    def test_a_scene_of_many_triangles(self):
        east, north = (axis.ravel() for axis in np.meshgrid(np.arange(150.0), np.arange(150.0)))
        corner = np.arange(150 * 150).reshape(150, 150)[:-1, :-1].ravel()
        faces = np.concatenate([np.column_stack([corner, corner + 1, corner + 150]),
                                np.column_stack([corner + 1, corner + 151, corner + 150])])
        scene = al.Scene(np.column_stack([east, north, np.sin(east / 20)]), faces)
        figure = __import__("matplotlib.figure").figure.Figure()
        axes = figure.add_subplot()
        _display.draw_from_above(scene, axes)
        self.assertEqual(axes.images[0].get_array().max(), scene.bounds[5])

    def test_names_of_arrays(self):
        scan = al.Scan(al.Scene(WALL))
        self.assertEqual(list(scan), list(scan.echoes))
        self.assertTrue("energy" in scan and "energi" not in scan)
        for name in (0, -1, None):
            with self.assertRaises(KeyError):
                scan.echoes[name]

    def test_a_scan_is_not_copied(self):
        scan = al.Scan(al.Scene(WALL))
        for call in (lambda: copy.copy(scan), lambda: copy.deepcopy(scan), lambda: pickle.dumps(scan)):
            with self.assertRaisesRegex(TypeError, "a Scan is not copied: copy its scene and its sensor"):
                call()

    def test_another_scene_of_any_kind(self):
        scan = al.Scan(al.Scene())
        scan.scene = WALL
        self.assertGreater(scan.echoes.number_of_points, 0)
        with self.assertRaises(FileNotFoundError):
            scan.scene = "none.stl"
        self.assertGreater(scan.echoes.number_of_points, 0)

    def test_names_that_are_unknown(self):
        scan = al.Scan(al.Scene(WALL))
        for cloud in (scan, scan.echoes, scan.report):
            with self.assertRaisesRegex(KeyError, "'energi' is not known; (did you mean 'energy'|known are)"):
                cloud["energi"]

    def test_a_table_of_pandas(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("there is no pandas")
        echoes = al.Scan(al.Scene(WALL), "Search905").echoes
        frame = echoes.to_pandas()
        self.assertTrue(frame.equals(al.Scan(al.Scene(WALL), "Search905").to_pandas()))
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(frame.shape, (echoes.number_of_points, 3 + len(echoes)))
        self.assertTrue(np.array_equal(frame[["x", "y", "z"]], echoes.points))
        self.assertEqual(frame["energy"].tolist(), echoes["energy"].tolist())
        self.assertEqual((frame.attrs["units"]["energy"], frame.attrs["fields"]["range_gate"]), ("J", 4000))
        frame["energy"] *= 2  # a copy
        both = pandas.concat([echoes.to_pandas(), al.Scan(al.Scene(WALL), "Search905", seed=3).echoes.to_pandas()])
        self.assertGreater(len(both), len(frame))

    def test_without_pandas_there_is_no_table(self):
        program = ("import sys; sys.modules['pandas'] = None\nimport avianlidar as al\n"
                   "try:\n al.Sensor().beams.to_pandas()\nexcept ImportError as error:\n assert 'needs pandas' in str(error)\n"
                   "else:\n assert False")
        subprocess.run([sys.executable, "-c", program], check=True)

    def test_without_matplotlib_there_is_no_picture(self):
        program = ("import sys; sys.modules['matplotlib'] = None\nimport avianlidar as al\n"
                   "page = al.Sensor()._repr_html_()\nassert '<table>' in page and '<img' not in page")
        subprocess.run([sys.executable, "-c", program], check=True)


class NothingToSee(unittest.TestCase):
    def words(self, scene, **sensor):
        return said(al.Scan(scene, al.Sensor(azimuth_step=2, **sensor)).update)

    def test_a_good_scene_has_no_warning(self):
        scene = al.Scene(SCENE)
        self.assertEqual(self.words(scene, position=(0, 0, 3)), [])
        self.assertEqual(self.words(scene), [])  # on the ground

    def test_below_the_ground(self):
        words = self.words(al.Scene(SCENE), position=(0, 0, -50))
        self.assertRegex(words.pop(0), "faces coincide.*: 'Ground' over 'Terminal 2'")  # floors, seen from below
        self.assertEqual(words[0], "the sensor at (0, 0, -50) m is below the scene, whose lowest point is at 0 m")
        self.assertRegex(words[1], "^no echoes of 2880 beams: ")
        hill = al.Scene([(-500, -500, 0), (500, -500, 0), (500, 500, 40), (-500, 500, 40)], [(0, 1, 2), (0, 2, 3)])
        self.assertRegex(self.words(hill, position=(0, 0, 10))[0], "has surfaces above it and none below")
        self.assertNotIn("none below", " ".join(self.words(hill, position=(0, 0, 30))))

    def test_far_away(self):
        words = self.words(al.Scene(box((-20, 50000, -5), (20, 50002, 15))))
        self.assertRegex(words[-1], "^no echoes of .*the scene is 50000 m away or more, the range gate ends at 4000 m$")

    def test_beams_that_pass(self):
        words = self.words(al.Scene(WALL), minimum_elevation=40)
        self.assertRegex(words[-1], "^no echoes of 2880 beams: no surface 2880; the beams look 40 to 45.62 deg up, the scene "
                         "extends east -20 to 20, north 50 to 52, up -5 to 15 m$")

    def test_too_weak(self):
        words = self.words(al.Scene(WALL), pulse_energy=1e-12)
        self.assertRegex(words[-1], r"^no echoes of 2880 beams: .*below the lower limit \d+$")

    def test_no_surfaces(self):
        self.assertEqual(self.words(al.Scene()), ["the scene has no triangles"])

    def test_millimetres(self):
        terminal, airport = box((-90e3, 200e3, 0), (90e3, 240e3, 21e3)), box((-500e3, 0, 0), (500e3, 600e3, 20e3))
        car, hangar = box((-900, 9000, 0), (900, 13500, 1500)), box((-30e3, 100e3, 0), (30e3, 140e3, 15e3))
        for surfaces in (terminal, airport, car, hangar):
            self.assertRegex(" ".join(self.words(al.Scene(surfaces))), r"the scene extends east -.*millimetres, read it with the scale 0.001")
        self.assertEqual(list(_sight.of_scene((-10000, 10000, -10000, 10000, 1500, 4000))), [])  # hills

    def test_y_up(self):
        points = np.concatenate([box((-50, 300, 0), (50, 340, 12))[0], box((80, -300, 0), (90, -290, 30))[0]])
        faces = np.concatenate([WALL[1], WALL[1] + 8])
        self.assertRegex(" ".join(self.words(al.Scene(y_up(points), faces))), r"lowest point is 340 m below the origin.*read it with the up axis y")
        self.assertNotIn("up axis y", " ".join(self.words(al.Scene(points, faces))))
        house = al.Scene(y_up(box((-20, 50, 0), (20, 80, 12))[0]), WALL[1])
        self.assertIn("up axis y", " ".join(self.words(house, position=(0, 0, 5))))

    def test_scenes_that_are_as_meant(self):
        """Each has echoes, or nothing wrong but that."""
        for surfaces, place in ((box((-20, 50, 0.3), (20, 52, 15)), (0, 0, 0)), (box((-10, 300, 40), (10, 320, 60)), (0, 0, 32)),
                                (box((-15, 0, -10), (15, 0.2, 20)), (0, -60, 3)), (box((-5, 0, -30), (5, 10, 30)), (0, -60, 3))):
            self.assertEqual(self.words(al.Scene(surfaces), position=place), [], surfaces[0][0])
        bird = al.mover(al.mesh(*box((-1, 80, 2), (1, 82, 4))), [(0, 0, 0)])
        self.assertEqual(said(al.Scan(al.Scene(), al.Sensor(), movers=[bird]).update), [])

    def test_coordinates_of_a_map(self):
        words = self.words(al.Scene(box((346600, 3451000, 3), (346700, 3451100, 30))), position=(0, 0, 3))
        self.assertRegex(words[-1], "those of a map, such as UTM, subtract an offset")

    def test_the_place_is_looked_at_once(self):
        scan = al.Scan(al.Scene(SCENE), al.Sensor(position=(0, 0, -50), azimuth_step=2))
        self.assertEqual(len(said(scan.update)), 3)
        scan.attenuation_coefficient = 1e-5
        self.assertNotRegex(" ".join(said(scan.update)), "the sensor at")
        scan.sensor.position = (0, 0, -40)
        self.assertRegex(" ".join(said(scan.update)), r"the sensor at \(0, 0, -40\) m")

    def test_said_when_it_runs_only(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor(minimum_elevation=40, azimuth_step=2))
        self.assertEqual([len(said(scan.update)) for _ in range(3)], [1, 0, 0])
        scan.seed = 3
        self.assertRegex(said(lambda: scan["energy"])[0], "^no echoes of")


if __name__ == "__main__":
    unittest.main()
