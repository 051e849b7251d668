# SPDX-License-Identifier: BSD-3-Clause
"""Text that is not UTF-8, in files and in their names: no message is lost, no name is cut, and Python reads them all."""
import os
import pathlib
import tempfile
import unittest
import warnings

import vtk

import avianlidar as al
from avianlidar import _pipeline, _suffixes, vtkAvianLidar as wrapped
from cloudtools import cloud
from echotools import Messages, box, scan
from helpertools import WALL, same

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
LATIN = "B\u00e4ume"  # in Latin-1 no UTF-8


class Texts(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def latin_name(self, name):
        """A path whose last part is in Latin-1."""
        return self.folder / os.fsdecode(name.encode("latin-1"))

    def scene(self, text, encoding="utf-8", name="a.lidarscene.json"):
        file = self.folder / name
        file.write_bytes(text.encode(encoding))
        return file

    def test_a_latin_1_scene_is_an_error(self):
        file = self.scene('{"version": 1, "objects": [{"file": "%s.obj"}]}' % LATIN, "latin-1")
        with self.assertRaisesRegex(al.Error, r"is not JSON.*B\\xE4ume|is not JSON.*B\\xE4"):
            al.load_scene(file)
        reader = wrapped.vtkAvianLidarSceneReader()
        reader.SetFileName(str(file))
        heard = Messages(reader)
        reader.Update()
        self.assertEqual(len(heard.errors), 1)
        self.assertIn("is not JSON", heard.errors[0])

    def test_names_of_materials_in_a_warning(self):
        (self.folder / "m.mtl").write_bytes(b"newmtl B\xe4ume\n")
        (self.folder / "m.obj").write_bytes(b"mtllib m.mtl\n" + TRIANGLE + b"usemtl B\xe4ume\nf 1 2 3\n")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            al.load_scene(self.scene('{"version": 1, "objects": [{"file": "m.obj"}]}'))
        self.assertEqual(len(caught), 1, [str(w.message) for w in caught])
        self.assertIn("no material or material_map", str(caught[0].message))
        self.assertIn(r"B\xE4ume", str(caught[0].message))

    def test_names_of_features(self):
        square = "[[[0,0],[0.001,0],[0.001,0.001],[0,0]]]"
        (self.folder / "f.geojson").write_bytes(
            ('{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"name": "%s"}, "geometry": '
             '{"type": "Polygon", "coordinates": %s}}]}' % (LATIN, square)).encode("latin-1"))
        try:
            scene = al.load_scene(self.scene(
                '{"version": 1, "origin": {"latitude": 0, "longitude": 0, "height": 0}, "material_map": {"*": "Wall"}, '
                '"objects": [{"footprints": "f.geojson", "height": 3, "features": "separate"}]}'))
        except al.Error:
            return  # a word is enough; GDAL decides
        self.assertTrue(all(isinstance(name, str) for name in scene.objects), scene.objects)

    def test_names_of_blocks_and_objects(self):
        """What other programs' files bring: names as bytes."""
        for name in (b"B\xe4ume", b"\xff\xfe", "\u6811".encode()):
            blocks = vtk.vtkMultiBlockDataSet()
            blocks.SetBlock(0, box((9, 0, 0), (1, 1, 1), "Wall"))
            blocks.GetMetaData(0).Set(vtk.vtkCompositeDataSet.NAME(), name)
            escaped = name.decode("utf-8", "backslashreplace").replace(r"\x", "\\x")
            scene = al.Scene(blocks)
            self.assertEqual([one.lower() for one in scene.objects], [escaped.lower()])
            spoilt = blocks.NewInstance()
            spoilt.DeepCopy(blocks)
            spoilt.GetBlock(0).GetCellData().RemoveArray("kd")
            with self.assertRaisesRegex(al.Error, "kd, ks, kp"):
                al.Scan(al.Scene(spoilt), al.Sensor(azimuth_step=30)).update()
            heard = Messages(echo := scan(spoilt))
            echo.Update()
            self.assertIsInstance(heard.errors[0], str)

    def test_names_of_materials_and_objects_of_a_filter(self):
        paint = wrapped.vtkAvianLidarMaterial()
        paint.SetInputData(box((9, 0, 0), (1, 1, 1)))
        paint.SetNameOfObject(b"B\xe4ume")
        paint.Update()
        self.assertEqual(paint.GetOutput().GetFieldData().GetAbstractArray("object_names").GetValue(0), r"B\xE4ume")

    def test_names_of_files(self):
        echoes = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2)).echoes
        for suffix in (".las", ".pcd", ".ply", ".bin", ".vtp", ".csv"):
            file = self.latin_name("B\u00e4ume" + suffix)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # LAS without a reference system
                echoes.save(file)
            self.assertTrue(file.exists())
            if suffix == ".vtp":
                self.assertTrue(same(al.load_cloud(file), echoes))
            else:
                self.assertEqual(al.load_cloud(file).number_of_points, echoes.number_of_points)
            if suffix in (".las", ".pcd", ".ply"):
                file.write_bytes(b"<VTKFile nonsense")
                with self.assertRaisesRegex(al.Error, r"B\\xE4ume\."):
                    al.load_cloud(file)
        nowhere = self.latin_name("\u00e4") / "x.las"
        with self.assertRaisesRegex(al.Error, r"\\xE4/x.las: cannot be opened"):
            echoes.save(nowhere)
        scene = self.latin_name("B\u00e4ume.lidarscene.json")
        scene.write_text('{"version": 2}')
        with self.assertRaisesRegex(al.Error, r"B\\xE4ume.lidarscene.json: version"):
            al.load_scene(scene)

    def test_an_error_without_a_text(self):
        """What VTK's own classes report of such names does not reach Python as text: still an exception."""
        file = self.latin_name("B\u00e4ume.vtp")
        file.write_bytes(b"<VTKFile nonsense")
        with self.assertRaises(al.Error):
            al.load_cloud(file)
        source = wrapped.vtkAvianLidarBeamSource()

        def fail(caller, _):
            caller.InvokeEvent("ErrorEvent", b"B\xe4ume\n")

        source.AddObserver("StartEvent", fail)
        with self.assertRaisesRegex(al.Error, "not UTF-8"):
            _pipeline.update(source)

    def test_a_nul_ends_no_name(self):
        """Names in C end there: of "a\\0b.las" would be written "a"."""
        echoes = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2)).echoes
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        for suffix in (*_suffixes.WRITERS, *_suffixes.OWN):
            for name in ("a\0b" + suffix, self.folder / ("a\0b" + suffix)):
                with self.assertRaisesRegex(ValueError, "NUL"):
                    echoes.save(name)
                with self.assertRaisesRegex(ValueError, "NUL|suffix"):
                    al.load_cloud(name)
        with self.assertRaisesRegex(ValueError, "NUL"):
            al.load_scene("a\0.lidarscene.json")
        self.assertEqual(os.listdir(self.folder), [])
        for name in ("a\0b", "\udce4"):  # the second would end the process
            with self.assertRaises(ValueError):
                al.Scene(WALL, name=name)

    def test_a_nul_in_a_scene(self):
        (self.folder / "a.obj").write_bytes(TRIANGLE + b"f 1 2 3\n")
        for text, path in (('{"version": 1, "objects": [{"file": "a.obj\\u0000b.obj"}]}', "objects\\[0\\].file"),
                           ('{"version": 1, "objects": [{"file": "a.obj", "name": "a\\u0000b"}]}', "objects\\[0\\].name"),
                           ('{"version": 1, "materials": {"a\\u0000b": {"kd": 0.1}}, "objects": []}', "materials")):
            with self.assertRaisesRegex(al.Error, path + ".*NUL"):
                al.load_scene(self.scene(text))

    def test_points_alone(self):
        """The tools of this test find nothing where all is well."""
        file = self.folder / "B\u00e4ume.pcd"
        al.save(cloud([(0, 0, 0)]), file)
        self.assertEqual(al.load_cloud(file).number_of_points, 1)


if __name__ == "__main__":
    unittest.main()
