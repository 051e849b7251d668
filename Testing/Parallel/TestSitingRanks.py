# SPDX-License-Identifier: BSD-3-Clause
"""Sites that two ranks share are those of one process. Arguments: mpiexec, pvbatch."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
PLAN = SOURCE / "Examples" / "coverage" / "hongqiao.coverage.json"
LAUNCHER = sys.argv[1:3]


def fresh(name):
    folder = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]) / "TestSitingRanks" / name
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def run(*command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, timeout=200)


def few(folder, **siting):
    """The airport's plan with fewer places, candidates and draws."""
    plan = json.loads(PLAN.read_text(encoding="utf-8"))
    plan.update({name: str((PLAN.parent / plan[name]).resolve()) for name in ("scene", "runways")}, places=500)
    plan["siting"].update(spacing=600, draws=1, **siting)
    folder.mkdir(parents=True)
    file = folder / "few.coverage.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    return "-m", "avianlidar", "siting", file, "-o", folder


def on_ranks(*arguments):
    mpiexec, pvbatch = LAUNCHER
    return run(mpiexec, "-n", "2", pvbatch, "--sym", *arguments)


class Ranks(unittest.TestCase):
    def test_share_sites(self):
        alone, together = fresh("alone"), fresh("together")
        done = run(sys.executable, *few(alone))
        self.assertEqual(done.returncode, 0, done.stderr)
        done = on_ranks(*few(together))
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("sites.csv", "sites.geojson", "sites.vtp", "gain.csv", "robustness.csv", "sites.png"):
            self.assertEqual((alone / name).read_bytes(), (together / name).read_bytes(), name)
        files = [{file.name for file in (folder / "coverage").iterdir()} for folder in (alone, together)]
        self.assertEqual(*files)

    def test_an_error_ends_the_job(self):
        done = on_ranks(*few(fresh("bad"), mix={"dodo": 1}))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
