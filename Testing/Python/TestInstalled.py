# SPDX-License-Identifier: BSD-3-Clause
"""What `cmake --install` puts into a folder is enough: the package with its stubs, used from a clean environment, and
the plugin."""
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import avianlidar

BUILD = pathlib.Path(os.environ["AVIANLIDAR_BUILD_DIR"])
SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
PREFIX = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]) / "TestInstalled"
BUILT = pathlib.Path(avianlidar.__file__).parent
PROGRAM = """
import pathlib, sys
import avianlidar as al
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter
prefix = pathlib.Path(sys.argv[1])
assert pathlib.Path(al.__file__).is_relative_to(prefix), al.__file__
assert pathlib.Path(al.vtkAvianLidar.__file__).is_relative_to(prefix)
libraries = {line.split()[-1] for line in open("/proc/self/maps") if "libvtkAvianLidar" in line}
assert libraries and all(pathlib.Path(name).is_relative_to(prefix) for name in libraries), libraries
scan = al.Scan(al.load_scene(al.example_scene()), preset="Draft")
assert isinstance(scan.algorithm, vtkAvianLidarEchoFilter)
scan.save("echoes.vtp")
print(scan.echoes.number_of_points, al.load_cloud("echoes.vtp").number_of_points)
"""


def names(folder):
    """Checksums of the files in a folder and its subfolders."""
    return {str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file()}


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(PREFIX, ignore_errors=True)
        subprocess.run(["cmake", "--install", BUILD, "--prefix", PREFIX], check=True, stdout=subprocess.DEVNULL)
        cls.package = PREFIX / BUILT.relative_to(BUILD)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(PREFIX, ignore_errors=True)

    def test_every_file_of_the_package(self):
        sources = names(SOURCE / "Python" / "avianlidar")
        wanted = {name[:-3] if name.endswith(".in") else name for name in sources if not name.endswith(".pyc")}
        wanted |= {file.name for file in BUILT.glob("*.pyi")} | {"py.typed", "vtkAvianLidar.so"}
        self.assertEqual(wanted - names(self.package), set())

    def test_used_from_a_clean_environment(self):
        vtk = [path for path in os.environ["PYTHONPATH"].split(os.pathsep)[1:] if path]  # one that is not the system's
        environment = {"PATH": "/usr/bin:/bin", "HOME": str(PREFIX), "PYTHONDONTWRITEBYTECODE": "1",
                       "PYTHONPATH": os.pathsep.join([str(self.package.parent), *vtk])}
        program = PREFIX / "program.py"
        program.write_text(PROGRAM, "utf-8")
        for interpreter in [sys.executable] if vtk else [sys.executable, "pvpython", "pvbatch"]:
            with self.subTest(interpreter):
                result = subprocess.run([interpreter, program, PREFIX], cwd=PREFIX, env=environment,
                                        capture_output=True, text=True)
                self.assertEqual(result.returncode, 0, result.stderr)
                written, read = map(int, result.stdout.split())
                self.assertTrue(written == read > 1000, result.stdout)

    def test_the_plugin(self):
        """What lies beside it, and nothing less: presets, macros, the state, the scene."""
        for file in BUILD.glob("lib/**/AvianLidarPlugin.so"):
            beside = [one for one in file.parent.rglob("*") if one.is_file()]
            self.assertGreater(len(beside), 8)
            for one in beside:
                installed = PREFIX / one.relative_to(BUILD)
                self.assertTrue(installed.exists() and (one == file or installed.read_bytes() == one.read_bytes()),
                                installed)
