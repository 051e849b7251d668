# SPDX-License-Identifier: BSD-3-Clause
"""Designs that two ranks share are those of one process. Arguments: mpiexec, pvbatch."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
PLAN = SOURCE / "Examples" / "design" / "hongqiao.coverage.json"
WRITTEN = ("design.csv", "sensitivities.csv", "front.png", "sensitivities.png", "design.html")


def fresh(name):
    folder = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]) / "TestDesignRanks" / name
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def run(*command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, timeout=200)


def few(folder, **coverage):
    """The example's plan with fewer places and designs, and without clutter."""
    plan = json.loads(PLAN.read_text(encoding="utf-8"))
    plan.update({name: str((PLAN.parent / plan[name]).resolve()) for name in ("scene", "runways")}, places=300)
    plan["coverage"].update({"clutter": False, **coverage})
    plan["design"]["designs"] = 10
    plan["sensor"]["azimuth_step"] = 1.5
    folder.mkdir(parents=True)
    file = folder / "few.coverage.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    return "-m", "avianlidar", "design", file, "-o", folder / "out"


def on_ranks(*arguments):
    mpiexec, pvbatch = sys.argv[1:3]
    return run(mpiexec, "-n", "2", pvbatch, "--sym", *arguments)


class Ranks(unittest.TestCase):
    def test_share_designs(self):
        alone, together = fresh("alone"), fresh("together")
        done = run(sys.executable, *few(alone))
        self.assertEqual(done.returncode, 0, done.stderr)
        command = few(together)
        done = on_ranks(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        kept = sorted((together / "out" / "coverage").iterdir())
        self.assertEqual({file.name: file.read_bytes() for file in kept}, {file.name: file.read_bytes() for file in (alone / "out" / "coverage").iterdir()})
        for file in kept[::2]:  # half is lost: the ranks go on
            file.unlink()
        done = on_ranks(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in WRITTEN:
            self.assertEqual((alone / "out" / name).read_bytes(), (together / "out" / name).read_bytes(), name)

    def test_an_error_ends_the_job(self):
        done = on_ranks(*few(fresh("bad"), species="dodo"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
