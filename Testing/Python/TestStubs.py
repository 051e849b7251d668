# SPDX-License-Identifier: BSD-3-Clause
"""The type stubs say what the wrapped module has, and mypy finds with them what is wrong in a program."""
import ast
import inspect
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import avianlidar
from avianlidar import vtkAvianLidar as wrapped

PACKAGE = pathlib.Path(avianlidar.__file__).parent
GOOD = """
import avianlidar as al
import avianlidar.reach
from avianlidar import siting
from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarEchoFilter

source = vtkAvianLidarBeamSource()
source.SetPulseEnergy(1e-4)
energy: float = source.GetPulseEnergy()
echo = vtkAvianLidarEchoFilter()
echo.SetRaysPerBeam(100)
scan = al.Scan(al.load_scene("scene.lidarscene.json"), al.Sensor("Airport32", position=(0, 0, 3)), seed=1)
scan.attenuation_coefficient = 1e-4
names: list = scan.scene.objects
mean: float = scan["energy"].mean()
scan.save("echoes.vtp")
length: float = siting.Runway("a", (0, 0), (1000, 0), 45.0).axis()[1]
half: float = avianlidar.reach.within_beams(al.Sensor()).to(0.5)
"""
# Not among them: a method that is not there, as the bases, which are VTK's, have no types and may have it.
BAD = (("source.SetPulseEnergy('much')", "SetPulseEnergy"), ("source.SetPosition(1.0)", "SetPosition"),
       ("text: str = source.GetPulseEnergy()", "str"), ("al.Sensor(16)", "Sensor"), ("al.load_scenes('x')", "load_scenes"),
       ("al.save(scan)", "save"), ("siting.Runway('a')", "Runway"), ("avianlidar.reach.within('a')", "within"))


class Stubs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        tree = ast.parse((PACKAGE / "vtkAvianLidar.pyi").read_text(encoding="utf-8"))
        cls.classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}

    def methods(self, name):
        return {node.name for node in self.classes[name].body if isinstance(node, ast.FunctionDef)}

    def all_methods(self, name):
        """Also those of the bases that are ours."""
        bases = (ast.unparse(base).split(".")[-1] for base in self.classes[name].bases)
        return self.methods(name).union(*(self.all_methods(base) for base in bases if base in self.classes))

    def test_every_class_and_method(self):
        classes = {name: thing for name, thing in vars(wrapped).items() if inspect.isclass(thing)}
        self.assertGreaterEqual(len(classes), 9)
        self.assertEqual(set(self.classes), set(classes))
        for name, thing in classes.items():
            methods = {key for key, value in vars(thing).items() if callable(value) and not inspect.isclass(value)
                       and not key.startswith("_")}
            with self.subTest(name):
                self.assertEqual(methods - self.methods(name), set())

    def test_every_constant(self):
        for name, node in self.classes.items():
            said = {part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
            there = {key for key, value in vars(getattr(wrapped, name)).items() if isinstance(value, int) and key.isupper()}
            self.assertEqual(there - said, set(), name)

    def test_properties_of_the_contract(self):
        contract = {"vtkAvianLidarBeamSource": "Position Orientation NumberOfChannels HalfBeamwidth PulseEnergy RangeGate",
                    "vtkAvianLidarEchoFilter": "RaysPerBeam Seed AttenuationCoefficient ReturnMode NumberOfThreads Noise",
                    "vtkAvianLidarCoverage": "RaysPerBeam Seed Bounds Spacing Species Visibility NumberOfScans",
                    "vtkAvianLidarMaterial": "Material Kd Ks Kp ObjectId NameOfObject BlockNamePattern",
                    "vtkAvianLidarCollisionTree": "SplitRule BoundingVolume MaximumLeafSize DisplayLevel"}
        for name, properties in contract.items():
            for key in properties.split():
                self.assertLessEqual({"Set" + key, "Get" + key}, self.all_methods(name), key)

    def test_the_package_says_it_is_typed(self):
        self.assertTrue((PACKAGE / "py.typed").exists())


@unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
class Mypy(unittest.TestCase):
    def check(self, text):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program.py"
            program.write_text(text, encoding="utf-8")
            # VTK itself has no types here; the stubs and the package are looked into, not judged.
            config = pathlib.Path(folder) / "mypy.ini"
            config.write_text("[mypy]\nignore_missing_imports = True\n[mypy-avianlidar.*]\nfollow_imports = silent\n",
                              encoding="utf-8")
            result = subprocess.run(
                [sys.executable, "-m", "mypy", "--config-file", str(config), "--cache-dir", os.path.join(folder, "cache"),
                 str(program)], capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
        return result.stdout + result.stderr

    def test_a_good_program(self):
        self.assertIn("Success: no issues found", self.check(GOOD))

    def test_faults_are_found(self):
        found = self.check(GOOD + "".join(f"{line}\n" for line, _ in BAD))
        first = GOOD.count("\n") + 1
        for number, (line, words) in enumerate(BAD, first):
            with self.subTest(line):
                self.assertRegex(found, rf"program\.py:{number}: error: .*{words}")
        self.assertIn(f"Found {len(BAD)} errors", found)

    def test_the_package_itself(self):
        with tempfile.TemporaryDirectory() as folder:
            result = subprocess.run(
                [sys.executable, "-m", "mypy", "--ignore-missing-imports", "--cache-dir", folder, "-p", "avianlidar"],
                capture_output=True, text=True, cwd=folder, env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
        # VTK's generator names classes of VTK that it does not import.
        ours = [line for line in result.stdout.splitlines() if " error: " in line and "Name \"vtk" not in line]
        self.assertEqual(ours, [], result.stderr)
        self.assertRegex(result.stdout, "checked [2-9][0-9] source files")


if __name__ == "__main__":
    unittest.main()
