# SPDX-License-Identifier: BSD-3-Clause
"""mypy finds what is wrong in a program that uses the package, and nothing in what is right or in the package
itself."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import avianlidar

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
       ("text: str = source.GetPulseEnergy()", "str"), ("al.Sensor(16)", "Sensor"),
       ("al.load_scenes('x')", "load_scenes"), ("al.save(scan)", "save"), ("siting.Runway('a')", "Runway"),
       ("avianlidar.reach.within('a')", "within"))
CONFIGURATION = """[mypy]
ignore_missing_imports = True
[mypy-vtkmodules.*,vtk.*]
follow_imports = skip
"""


class Types(unittest.TestCase):
    def test_a_program_and_the_package(self):
        self.assertTrue(importlib.util.find_spec("mypy"),
                        f"{sys.executable} has no mypy, which CMake/debian-packages.txt lists")
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "program.py").write_text(GOOD + "".join(f"{line}\n" for line, _ in BAD), "utf-8")
            pathlib.Path(folder, "mypy.ini").write_text(CONFIGURATION, "utf-8")
            run = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", "cache", "-p", "avianlidar", "-m",
                                  "program"], cwd=folder, capture_output=True, text=True, check=False,
                                 env={**os.environ, "MYPYPATH": f"{PACKAGE.parent}:{folder}"})
        # VTK's generator names classes of VTK that it does not import.
        found = [line for line in run.stdout.splitlines() if " error: " in line and 'Name "vtk' not in line]
        first = GOOD.count("\n") + 1
        self.assertEqual(len(found), len(BAD), run.stdout + run.stderr)
        for number, (line, words) in enumerate(BAD, first):
            self.assertTrue(any(re.search(rf"program\.py:{number}: error: .*{words}", one) for one in found), line)
        self.assertRegex(run.stdout, "checked [0-9]{2,3} source files")
