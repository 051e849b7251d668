# SPDX-License-Identifier: BSD-3-Clause
"""Every writer of clouds: what goes wrong is said, leaves nothing behind, and leaves alone what was there."""

import os
import resource
import shutil
import subprocess
import sys
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkStringArray

import cloudtools
from avianlidar import vtkAvianLidar as al
from cloudtools import add_array, add_field, cloud, echoes
from echotools import Messages

WRITERS = {suffix[1:]: getattr(al, f"vtkAvianLidar{name}Writer") for name, suffix in cloudtools.WRITERS.items()}
if os.environ["AVIANLIDAR_LASZIP"] == "1":
    WRITERS["laz"] = al.vtkAvianLidarLASWriter
FOLDER = "TestWriterErrors"


def large(count=100000):
    data = cloud(np.random.default_rng(3).uniform(-100, 100, (count, 3)))
    add_array(data, "energy", np.ones(count), "J")
    add_array(data, "object_id", np.zeros(count, int))
    add_field(data, "geodetic_origin", (31.0, 121.0, 3.0))
    add_field(data, "position", (0.0, 0.0, 0.0))
    return data


class TestWriterErrors(unittest.TestCase):
    def setUp(self):
        shutil.rmtree(FOLDER, ignore_errors=True)
        os.makedirs(FOLDER)

    def tearDown(self):
        shutil.rmtree(FOLDER, ignore_errors=True)

    def each(self, data, name="cloud"):
        """(writer, its messages, its file) of every format."""
        for ending, make in WRITERS.items():
            writer = make()
            heard = Messages(writer)
            file = os.path.join(FOLDER, f"{name}.{ending}")
            if data:
                writer.SetInputData(data)
            writer.SetFileName(file)
            yield writer, heard, file

    def assert_failed(self, writer, heard, words):
        self.assertEqual(writer.Write(), 0)
        self.assertEqual(len(heard.errors), 1, heard.errors)
        self.assertIn(words, heard.errors[0])

    def test_no_file_name(self):
        data = echoes()
        for writer, heard, _ in self.each(data):
            for name in (None, ""):
                heard.errors.clear()
                writer.SetFileName(name)
                self.assert_failed(writer, heard, "FileName is not set")
        self.assertEqual(os.listdir(FOLDER), [])

    def test_no_such_folder(self):
        for writer, heard, _ in self.each(echoes()):
            writer.SetFileName(os.path.join(FOLDER, "none", "cloud"))
            self.assert_failed(writer, heard, "No such file or directory")

    def test_a_folder_in_the_way(self):
        for writer, heard, file in self.each(echoes()):
            os.makedirs(file)
            self.assert_failed(writer, heard, "no ordinary file")
            self.assertEqual(os.listdir(file), [])

    def test_a_device_is_no_file(self):
        for writer, heard, _ in self.each(echoes()):
            if writer.IsA("vtkAvianLidarKITTIWriter"):
                writer.WriteLabelsOff()
            writer.SetFileName("/dev/full")
            self.assert_failed(writer, heard, "no ordinary file")
        self.assertTrue(os.path.exists("/dev/full"))

    def test_a_full_disk(self):
        """Files may not grow beyond 64 KiB: as if the disk were full. What was there stays."""
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        data = large()
        for writer, heard, file in self.each(data):
            with open(file, "w", encoding="ascii") as there:
                there.write("what was there")
            resource.setrlimit(resource.RLIMIT_FSIZE, (65536, limits[1]))
            try:
                self.assertEqual(writer.Write(), 0)
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            self.assertEqual(len(heard.errors), 1)
            self.assertIn("cannot be written to its end: File too large", heard.errors[0])
            with open(file, encoding="ascii") as there:
                self.assertEqual(there.read(), "what was there")
        self.assertEqual(sorted(os.listdir(FOLDER)), sorted(f"cloud.{ending}" for ending in WRITERS))

    def test_a_disk_that_is_full_at_the_last_byte(self):
        """What fails only when the buffer is emptied at the end."""
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        data = large(3)
        for writer, heard, file in self.each(data):
            self.assertEqual(writer.Write(), 1)
            size = os.path.getsize(file)
            os.remove(file)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size - 1, limits[1]))
            try:
                self.assertEqual(writer.Write(), 0)
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            self.assertIn("cannot be written to its end", heard.errors[0])
            self.assertFalse(os.path.exists(file))
        self.assertEqual([name for name in os.listdir(FOLDER) if ".part" in name], [])

    def test_abort(self):
        data = large()
        for writer, heard, file in self.each(data):
            seen = []

            def stop(caller, _, seen=seen):
                seen.append(caller.GetProgress())
                if 0 < seen[-1] < 1:
                    caller.SetAbortExecute(1)

            tag = writer.AddObserver("ProgressEvent", stop)
            self.assertEqual(writer.Write(), 0)
            self.assertEqual(heard.errors, [])
            self.assertTrue(any(0 < one < 1 for one in seen))
            self.assertEqual(os.listdir(FOLDER), [])
            # And once more, to the end.
            writer.RemoveObserver(tag)
            writer.SetAbortExecute(0)
            self.assertEqual(writer.Write(), 1)
            self.assertTrue(os.path.exists(file))
            for name in os.listdir(FOLDER):
                os.remove(os.path.join(FOLDER, name))

    def test_progress_rises_to_the_end(self):
        data = large()
        for writer, _, _ in self.each(data):
            seen = []
            writer.AddObserver("ProgressEvent", lambda caller, _, seen=seen: seen.append(caller.GetProgress()))
            self.assertEqual(writer.Write(), 1)
            self.assertEqual(seen, sorted(seen))
            self.assertEqual((seen[0], seen[-1]), (0, 1))
            self.assertGreater(len(seen), 5)

    def test_a_file_that_is_there_is_replaced(self):
        data = echoes()
        for writer, _, file in self.each(data):
            with open(file, "w", encoding="ascii") as there:
                there.write("x" * 10_000_000)
            self.assertEqual(writer.Write(), 1)
            self.assertLess(os.path.getsize(file), 1_000_000)

    def test_a_link_stays_a_link(self):
        data = echoes()
        for writer, _, file in self.each(data):
            os.symlink(os.path.basename(file) + "-real", file)
            self.assertEqual(writer.Write(), 1)
            self.assertTrue(os.path.islink(file))
            self.assertGreater(os.path.getsize(file + "-real"), 100)

    def test_somebody_elses_temporary_file_is_left_alone(self):
        data = echoes()
        for writer, _, file in self.each(data):
            with open(file + ".part0", "w", encoding="ascii") as there:
                there.write("not yours")
            self.assertEqual(writer.Write(), 1)
            with open(file + ".part0", encoding="ascii") as there:
                self.assertEqual(there.read(), "not yours")

    def test_arrays_of_another_size(self):
        """Known or not, an array that has no value for each point is named."""
        for name in ("energy", "mine"):
            data = large(5)
            add_array(data, name, np.ones(2), "J")
            for writer, heard, file in self.each(data):
                if file.endswith("bin"):
                    continue  # has neither
                self.assert_failed(writer, heard, f"'{name}'")
                self.assertFalse(os.path.exists(file))

    def test_coordinates_beyond_single_precision(self):
        data = large(5)
        data.GetPoints().SetPoint(3, 1e39, 0, 0)
        for writer, heard, file in self.each(data):
            if not file.endswith("geojson"):  # text has a number for everything
                self.assert_failed(writer, heard, "point 3")
                self.assertFalse(os.path.exists(file))

    def test_colours_of_another_shape(self):
        for colours, words in ((np.zeros((5, 4), np.uint8), "4 components"), (np.zeros((5, 3)), "double"),
                               (np.zeros((2, 3), np.uint8), "2")):
            data = large(5)
            add_array(data, "rgb", colours)
            for writer, heard, file in self.each(data):
                if file.endswith(("las", "pcd")):
                    self.assert_failed(writer, heard, "'rgb'")
                    self.assertIn(words, heard.errors[0])
                    self.assertFalse(os.path.exists(file))

    def test_colours_that_are_texts(self):
        data = large(5)
        texts = vtkStringArray()
        texts.SetName("rgb")
        texts.SetNumberOfValues(5)
        data.GetPointData().AddArray(texts)
        for writer, heard, file in self.each(data):
            if file.endswith(("las", "pcd", "ply")):
                self.assert_failed(writer, heard, "the point array 'rgb' holds no numbers, expected numbers")

    def test_an_array_without_a_name_is_told(self):
        data = large(5)
        data.GetPointData().AddArray(numpy_to_vtk(np.ones(5), deep=True))
        writer, heard, file = next(self.each(data))
        self.assertEqual(writer.Write(), 1)
        self.assertIn(f"{file} is without the point arrays 'point array 2' (it has no name)", heard.warnings[0])

    def test_without_the_database_of_proj(self):
        words = "GDAL does not know EPSG:32631 (is PROJ's database proj.db installed?)"
        program = ("import avianlidar as al\nfrom cloudtools import add_field, cloud\ndata = cloud([[1, 2, 3]])\n"
                   "add_field(data, 'geodetic_origin', (31.0, 1.0, 3.0))\n"
                   f"al.save(data, '{FOLDER}/cloud.las')")
        nowhere = {"PROJ_DATA": os.devnull, "PROJ_LIB": os.devnull}
        path = os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), os.environ["PYTHONPATH"]])
        ended = subprocess.run([sys.executable, "-c", program], env={**os.environ, **nowhere, "PYTHONPATH": path}, capture_output=True,
                               text=True, check=False)
        self.assertIn(words, ended.stderr)

    def test_no_input(self):
        for writer, heard, file in self.each(None):
            self.assertEqual(writer.Write(), 0)
            self.assertEqual(len(heard.errors), 1)
            self.assertFalse(os.path.exists(file))


if __name__ == "__main__":
    unittest.main()
