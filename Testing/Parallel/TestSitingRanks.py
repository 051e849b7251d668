# SPDX-License-Identifier: BSD-3-Clause
"""Sites that two ranks share are those of one process. Arguments: mpiexec, pvbatch."""

import os
import pathlib
import shutil
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
PROGRAM = SOURCE / "Examples" / "siting" / "siting.py"
LAUNCHER = sys.argv[1:3]
FEW = ("--spacing", "600", "--places", "500", "--draws", "1")


def fresh(name):
    folder = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]) / "TestSitingRanks" / name
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def run(*command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, timeout=200)


def on_ranks(*arguments):
    mpiexec, pvbatch = LAUNCHER
    return run(mpiexec, "-n", "2", pvbatch, "--sym", PROGRAM, *arguments)


class Ranks(unittest.TestCase):
    def test_share_sites(self):
        alone, together = fresh("alone"), fresh("together")
        done = run(sys.executable, PROGRAM, *FEW, "-o", alone)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = on_ranks(*FEW, "-o", together)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("sites.csv", "sites.geojson", "sites.vtp", "gain.csv", "robustness.csv"):
            self.assertEqual((alone / name).read_bytes(), (together / name).read_bytes(), name)
        self.assertTrue((together / "siting.png").exists())
        files = [{file.name for file in (folder / "coverage").iterdir()} for folder in (alone, together)]
        self.assertEqual(*files)

    def test_an_error_ends_the_job(self):
        done = on_ranks(*FEW, "--mix", "dodo=1", "-o", fresh("bad"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
