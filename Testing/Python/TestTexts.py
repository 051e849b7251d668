# SPDX-License-Identifier: BSD-3-Clause
"""Text that is not UTF-8 or holds a NUL, in files and in their names: no message is lost, no name is cut, and Python
reads them all."""
import os
import warnings

import vtk

import avianlidar as al
from avianlidar import _pipeline, _suffixes, vtkAvianLidar as wrapped
from cloudtools import READ_BACK, field
from echotools import InFolder, Messages, box, output
from helpertools import WALL, same, warned

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
LATIN = "B\u00e4ume"  # in Latin-1 no UTF-8


class Texts(InFolder):
    def latin_name(self, name):
        """A path whose last part is in Latin-1."""
        return self.folder / os.fsdecode(name.encode("latin-1"))

    def scene(self, objects, encoding="utf-8"):
        file = self.folder / "a.lidarscene.json"
        file.write_bytes(('{"version": 1, "objects": [%s]}' % objects).encode(encoding))
        return file

    def test_scenes(self):
        """An error, in Python's text and VTK's; names of materials in a warning."""
        file = self.scene('{"file": "%s.obj"}' % LATIN, "latin-1")
        with self.assertRaisesRegex(al.Error, r"is not JSON.*B\\xE4"):
            al.load_scene(file)
        sensor = self.folder / "a.lidarsensor.json"
        sensor.write_bytes('{"version": 1}'.encode("utf-16"))
        with self.assertRaisesRegex(al.Error, r"a\.lidarsensor\.json: is not JSON.*\\xFF"):
            al.Sensor(sensor)
        reader = wrapped.vtkAvianLidarSceneReader()
        reader.SetFileName(str(file))
        heard = Messages(reader)
        reader.Update()
        self.assertEqual(len(heard.errors), 1)
        self.assertIn("is not JSON", heard.errors[0])
        (self.folder / "m.mtl").write_bytes(b"newmtl B\xe4ume\n")
        (self.folder / "m.obj").write_bytes(b"mtllib m.mtl\n" + TRIANGLE + b"usemtl B\xe4ume\nf 1 2 3\n")
        _, (said,) = warned(lambda: al.load_scene(self.scene('{"file": "m.obj"}')))
        self.assertRegex(said,
                         r"no material or material_map[\s\S]*B\\xE4ume|B\\xE4ume[\s\S]*no material or material_map")

    def test_names_in_data(self):
        """What other programs' files bring: names as bytes, of blocks, objects and features."""
        for name in (b"B\xe4ume", "\u6811".encode()):
            blocks = vtk.vtkMultiBlockDataSet()
            blocks.SetBlock(0, box((9, 0, 0), (1, 1, 1), "Wall"))
            blocks.GetMetaData(0).Set(vtk.vtkCompositeDataSet.NAME(), name)
            self.assertEqual([one.lower() for one in al.Scene(blocks).objects],
                             [name.decode("utf-8", "backslashreplace").lower()])
            blocks.GetBlock(0).GetCellData().RemoveArray("kd")
            with self.assertRaisesRegex(al.Error, "kd, ks, kp"):
                al.Scan(al.Scene(blocks), al.Sensor(azimuth_step=30)).update()
        paint = wrapped.vtkAvianLidarMaterial()
        paint.SetInputData(box((9, 0, 0), (1, 1, 1)))
        paint.SetNameOfObject(b"B\xe4ume")
        self.assertEqual(field(output(paint), "object_names"), [r"B\xE4ume"])

    def test_names_of_files(self):
        echoes = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2)).echoes
        for suffix in READ_BACK:
            file = self.latin_name(LATIN + suffix)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # LAS without a reference system
                echoes.save(file)
            self.assertTrue(file.exists())
            read = al.load_cloud(file)
            self.assertTrue(same(read, echoes) if suffix == ".vtp" else read.number_of_points
                            == echoes.number_of_points)
            if suffix not in (".bin", ".csv"):
                file.write_bytes(b"<VTKFile nonsense")
                # VTK's own says nothing that is text
                with self.assertRaisesRegex(al.Error, "" if suffix == ".vtp" else r"B\\xE4ume\."):
                    al.load_cloud(file)
        with self.assertRaisesRegex(al.Error, r"\\xE4/x.las: cannot be opened"):
            echoes.save(self.latin_name("\u00e4") / "x.las")
        scene = self.latin_name(LATIN + ".lidarscene.json")
        scene.write_text('{"version": 2}')
        with self.assertRaisesRegex(al.Error, r"B\\xE4ume.lidarscene.json: version"):
            al.load_scene(scene)
        source = wrapped.vtkAvianLidarBeamSource()
        source.AddObserver("StartEvent", lambda caller, _: caller.InvokeEvent("ErrorEvent", b"B\xe4ume\n"))
        with self.assertRaisesRegex(al.Error, "not UTF-8"):
            _pipeline.update(source)

    def test_a_nul_ends_no_name(self):
        """Names in C end there: of "a\\0b.las" would be written "a"."""
        echoes = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2)).echoes
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
        (self.folder / "a.obj").write_bytes(TRIANGLE + b"f 1 2 3\n")
        with self.assertRaisesRegex(al.Error, "objects\\[0\\].file.*NUL"):
            al.load_scene(self.scene('{"file": "a.obj\\u0000b.obj"}'))
