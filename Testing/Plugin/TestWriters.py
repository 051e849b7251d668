# SPDX-License-Identifier: BSD-3-Clause
"""Save Data and Open File: every format is written and read through its proxies (TestProxies.py looks at their
properties).

Run by pvpython in one process and by pvbatch on two ranks (the argument), where the first rank gathers and writes."""

import os
import sys
import unittest

import numpy
from avianlidar import vtkAvianLidar as wrapped
from avianlidar._suffixes import READERS, WRITERS
from paraview import simple

from plugin_testing import OUTPUT_DIR, airport, fetch, load_plugin

RANKS = int(sys.argv.pop()) if len(sys.argv) > 1 and sys.argv[-1].isdigit() else 1
ENDINGS = {name[len("vtkAvianLidar"):]: suffix[1:] for suffix, name in reversed(WRITERS.items())}  # the first of each


def path(ending):
    return os.path.join(OUTPUT_DIR, f"TestWriters-{RANKS}.{ending}")


class TestWriters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene, cls.tree, cls.beams, cls.echoes = airport(columns=120)
        cls.echoes.UpdatePipeline()
        cls.expected = fetch(cls.echoes)

    def save(self, ending, **options):
        simple.SaveData(path(ending), proxy=self.echoes, **options)
        self.assertTrue(os.path.exists(path(ending)))

    def open(self, ending):
        reader = simple.OpenDataFile(path(ending))
        self.assertEqual(reader.SMProxy.GetVTKClassName(), "vtkAvianLidarPointCloudReader")
        got = fetch(reader)
        simple.Delete(reader)
        os.remove(path(ending))
        return got

    def test_clouds_come_back(self):
        """By one setting of each format; what every setting keeps is TestPointCloudReader's (Python)."""
        settings = {"CoordinateSystem": "Geocentric", "FileType": "ASCII", "Precision": "Double"}
        for writer, ending in ENDINGS.items():
            if "." + ending not in READERS or ending == "bin":  # KITTI has axes of its own: test_kitti
                continue
            options = {key: value for key, value in settings.items()
                       if hasattr(getattr(wrapped, "vtkAvianLidar" + writer), "Set" + key)}
            self.save(ending, **options)
            got = self.open(ending)
            accuracy = 0 if "Precision" in options else 2e-6
            numpy.testing.assert_allclose(got["points"], self.expected["points"], 0, accuracy, err_msg=ending)
            numpy.testing.assert_array_equal(got["energy"], self.expected["energy"], ending)

    def test_a_mesh_stays_one(self):
        """ParaView takes our writer for it, by the name, and its own reader."""
        sphere = simple.Sphere()
        simple.SaveData(path("ply"), proxy=sphere)
        reader = simple.OpenDataFile(path("ply"))
        self.assertEqual(reader.SMProxy.GetXMLName(), "PLYReader")
        reader.UpdatePipeline()
        self.assertEqual(reader.GetDataInformation().GetNumberOfCells(), 96)
        for proxy in (reader, sphere):
            simple.Delete(proxy)
        os.remove(path("ply"))

    def test_field_data_come_through(self):
        """The organised grid, the sensor's frame and the origin of all ranks are in field data."""
        self.save("pcd", Organisation="Organised")
        with open(path("pcd"), "rb") as file:
            lines = [next(file) for _ in range(12)]
        for line in (b"WIDTH 120\n", b"HEIGHT 16\n", b"VIEWPOINT 0 0 3 1 0 0 0\n"):
            self.assertIn(line, lines)
        os.remove(path("pcd"))

    def test_kitti(self):
        self.save("bin")
        points = numpy.fromfile(path("bin"), dtype="<f4").reshape(-1, 4)
        instances = numpy.fromfile(path("label"), dtype="<u4") >> 16
        reader = simple.OpenDataFile(path("bin"))
        reader.UpdatePipeline()
        self.assertEqual(reader.GetDataInformation().GetNumberOfPoints(), len(points))
        self.assertIsNotNone(reader.PointData["semantic_label"])
        simple.Delete(reader)
        for ending in ("bin", "label"):
            os.remove(path(ending))
        numpy.testing.assert_allclose(sorted(points[:, 0]), sorted(self.expected["points"][:, 1]), rtol=1e-6)
        self.assertEqual(sorted(instances), sorted(self.expected["object_id"] + 1))

    def test_series(self):
        """A file for every step, where the name says, with a folder or without; not in the root folder, say."""
        beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=6, StepsPerRevolution=2)
        echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=self.tree)
        echoes.UpdatePipeline(0)
        folder = os.path.abspath(os.path.join(OUTPUT_DIR, f"TestWritersSeries-{RANKS}"))
        before = os.getcwd()
        os.makedirs(os.path.join(folder, "sub"), exist_ok=True)
        os.chdir(folder)
        self.addCleanup(os.chdir, before)
        for ending in (*ENDINGS.values(), *["laz"] * int(os.environ["AVIANLIDAR_LASZIP"])):
            for name, steps in (("bare", True), ("bare", False), ("sub/inner", True),
                                (os.path.join(folder, "whole"), True)):
                simple.SaveData(f"{name}.{ending}", proxy=echoes, WriteTimeSteps=steps)
                files = [f"{name}_{step}.{ending}" for step in range(2)] if steps else [f"{name}.{ending}"]
                sizes = [os.path.getsize(file) for file in files]
                self.assertEqual(sizes, sorted(set(sizes)))  # the last one is the whole scan
                for file in files:
                    os.remove(file)
        simple.Delete(echoes)
        simple.Delete(beams)


if __name__ == "__main__":
    load_plugin()
    if RANKS == 1:
        unittest.main()
    else:
        # An exception on one of several ranks ends the job by itself; sys.exit() would not wait for the others.
        result = unittest.TextTestRunner().run(unittest.defaultTestLoader.loadTestsFromTestCase(TestWriters))
        assert result.wasSuccessful()
