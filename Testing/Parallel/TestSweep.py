# SPDX-License-Identifier: BSD-3-Clause
"""The sweep: killed again and again and started again, it ends with the files of a run that nobody disturbed, at no
moment is a half-written file among them, and a scan that fails leaves none. Arguments: mpiexec, pvbatch."""

import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from ranktools import LAUNCHER, SOURCE, fresh, on_ranks

EXAMPLE = SOURCE / "Examples" / "sequence" / "sweep.py"
sys.path.insert(0, str(EXAMPLE.parent))
import sweep  # noqa: E402

FEW = ["--rays", "10"]
ARGUMENTS = [*FEW, "--seed", "0", "1", "--attenuation", "3.5e-5", "8.8e-5", "--position", "0", "0", "3", "--position",
             "100", "0", "3"]
SCANS = 8


def children_of(pid):
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if int((process / "stat").read_text().rsplit(")", 1)[1].split()[1]) == pid:
                found.append(int(process.name))
        except (OSError, IndexError):
            pass  # it has ended meanwhile
    return found


def kill(job):
    for pid in children_of(job.pid) + [job.pid]:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    job.wait()


def contents(path):
    return {file.name: file.read_bytes() for file in path.iterdir()}


class Sweep(unittest.TestCase):
    @staticmethod
    def sweep(out, *more):
        """In this process."""
        sweep.main([*FEW, *more, "--out", str(out)])
        return out

    def assert_files_are_whole(self, path):
        for file in path.glob("[!.]*.vtp"):
            reader = vtkXMLPolyDataReader()
            reader.SetFileName(str(file))
            reader.Update()
            self.assertGreater(reader.GetOutput().GetNumberOfPoints(), 0, file)
        for file in path.glob("[!.]*.json"):
            entry = json.loads(file.read_text())
            content = (path / entry["file"]).read_bytes()
            self.assertEqual(hashlib.sha256(content).hexdigest(), entry["sha256"], file)

    def test_killed_and_started_again(self):
        out, (mpiexec, pvbatch) = fresh("SweepKilled"), LAUNCHER
        command = [mpiexec, "-n", "2", pvbatch, "--sym", str(EXAMPLE), *ARGUMENTS, "--out", str(out)]
        job = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        end = time.monotonic() + 120
        while len(list(out.glob("[!.]*.json"))) < 3 and job.poll() is None and time.monotonic() < end:
            time.sleep(0.002)
        self.assertIsNone(job.poll(), "it ended before it could be killed")
        kill(job)
        self.assert_files_are_whole(out)
        self.assertFalse((out / "manifest.json").exists())
        subprocess.run([*command, "--verify"], check=True, stdout=subprocess.DEVNULL, timeout=240)
        wanted = contents(self.sweep(fresh("SweepUndisturbed"), *ARGUMENTS))  # one process
        self.assertEqual(len([name for name in wanted if name.endswith(".vtp")]), SCANS)
        self.assertEqual(contents(out), wanted)

    def test_a_scan_that_fails_is_not_done(self):
        """It is named with its reason and leaves no file; those before and after are what they are without it."""
        here, bad, there = ([word for x in places for word in ("--position", x, "0", "3")]
                            for places in (["0"], ["1e31"], ["100"]))
        alone = contents(self.sweep(fresh("SweepGood"), *here, *there))
        del alone["manifest.json"]
        out = fresh("SweepFailed")
        job = on_ranks(EXAMPLE, *FEW, "--seed", "0", *here, *bad, *there, "--out", out)
        self.assertNotEqual(job.returncode, 0)
        self.assertRegex(job.stderr, r"Airport16_at_1e\+31_0_3_seed_0\S* failed: .*[Pp]osition")
        self.assertIn("1 of 3 scans failed", job.stderr)
        self.assertEqual(contents(out), alone)
        with self.assertRaises(SystemExit) as end:  # with the same sensor each fails by itself
            self.sweep(out, *here, *bad, *there, "--attenuation", "3.5e-5", "8.8e-5", "--seed", "0", "1")
        self.assertEqual(end.exception.code, 1)
        self.assertFalse(list(out.glob("*1e+31*")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
