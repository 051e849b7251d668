# SPDX-License-Identifier: BSD-3-Clause
"""The sweep: killed again and again and started again, it ends with the files of a run that nobody disturbed, at no
moment is a half-written file among them, and a scan that fails leaves none. Arguments: mpiexec, pvbatch."""

import contextlib
import hashlib
import io
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource

EXAMPLE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "sweep" / "sweep.py"
OUTPUT = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"])
sys.path.insert(0, str(EXAMPLE.parent))
import sweep  # noqa: E402

LAUNCHER = sys.argv[1:3]
ARGUMENTS = ["--rays", "10", "--seed", "0", "1", "2", "--attenuation", "3.5e-5", "8.8e-5",
             "--position", "0", "0", "3", "--position", "100", "0", "3"]
SCANS = 12


def folder(name):
    path = OUTPUT / name
    shutil.rmtree(path, ignore_errors=True)
    return path


def command(out, *more):
    mpiexec, pvbatch = LAUNCHER
    return [mpiexec, "-n", "2", pvbatch, "--sym", str(EXAMPLE), *ARGUMENTS, "--out", str(out), *more]


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
        out, job = folder("SweepKilled"), None
        for files in (1, 5, 9):
            job = subprocess.Popen(command(out), stdout=subprocess.DEVNULL)
            end = time.monotonic() + 60
            while len(list(out.glob("[!.]*.json"))) < files and job.poll() is None and time.monotonic() < end:
                time.sleep(0.002)
            self.assertIsNone(job.poll(), "it ended before it could be killed")
            kill(job)
            self.assert_files_are_whole(out)
            self.assertFalse((out / "manifest.json").exists())
        subprocess.run(command(out, "--verify"), check=True, stdout=subprocess.DEVNULL, timeout=120)
        undisturbed = folder("SweepUndisturbed")
        sweep.main([*ARGUMENTS, "--out", str(undisturbed)])  # one process
        self.assertEqual(len(list(undisturbed.glob("*.vtp"))), SCANS)
        found, wanted = contents(out), contents(undisturbed)
        self.assertEqual(sorted(found), sorted(wanted))
        for name in wanted:
            self.assertEqual(found[name], wanted[name], name)

    def test_a_scan_that_fails_is_not_done(self):
        """It is named with its reason and leaves no file; those before and after are what they are without it."""
        good = ["--rays", "10", "--position", "0", "0", "3", "--position", "100", "0", "3"]
        alone = folder("SweepGood")
        sweep.main([*good, "--out", str(alone)])
        bad = ["--rays", "10", "--seed", "0", "--position", "0", "0", "3", "--position", "1e31", "0", "0",
               "--position", "100", "0", "3"]
        mpiexec, pvbatch = LAUNCHER
        for launch in ([pvbatch, str(EXAMPLE)], [mpiexec, "-n", "2", pvbatch, "--sym", str(EXAMPLE)]):
            out = folder("SweepFailed")
            for _ in range(2):  # the second time it is the only one to do
                job = subprocess.run([*launch, *bad, "--out", str(out)], stdout=subprocess.DEVNULL,
                                     stderr=subprocess.PIPE, text=True, timeout=120)
                self.assertNotEqual(job.returncode, 0)
                self.assertRegex(job.stderr, r"Airport16_at_1e\+31_0_0_seed_0\S* failed: .*[Pp]osition")
                self.assertIn("1 of 3 scans failed", job.stderr)
                found = contents(out)
                self.assertEqual(sorted(found), sorted(set(contents(alone)) - {"manifest.json"}))
                for name, content in found.items():
                    self.assertEqual(content, contents(alone)[name], name)

    def test_scans_after_one_that_fails_with_the_same_sensor(self):
        """Each of them fails by itself: what a sensor that failed left is no beams."""
        out = folder("SweepFailedTwice")
        with self.assertRaises(SystemExit) as end:
            sweep.main(["--rays", "10", "--seed", "0", "1", "--attenuation", "3.5e-5", "8.8e-5",
                        "--position", "1e31", "0", "0", "--out", str(out)])
        self.assertEqual(end.exception.code, 1)
        self.assertEqual(list(out.glob("*")), [])

    def test_positions_are_numbers(self):
        out = folder("SweepNumbers")
        for word in ("nan", "inf", "here"):
            with self.assertRaises(SystemExit) as end, contextlib.redirect_stderr(io.StringIO()) as said:
                sweep.main(["--position", word, "0", "3", "--out", str(out)])
            self.assertEqual(end.exception.code, 2)
            self.assertIn(f"expected a finite number, not '{word}'", said.getvalue())
            self.assertFalse(out.exists())

    def test_manifest_names_everything(self):
        out = folder("SweepManifest")
        sweep.main(["--rays", "10", "--seed", "3", "--attenuation", "1e-4", "--out", str(out)])
        (entry,) = json.loads((out / "manifest.json").read_text())["scans"]
        self.assertTrue((out / entry["file"]).exists())
        self.assertEqual((entry["preset"], entry["seed"], entry["position"]), ("Airport16", 3, [0, 0, 3]))
        sensor = vtkAvianLidarBeamSource()
        sensor.SetPresetToAirport16()
        for name, value in (("seed", 3), ("attenuation_coefficient", 1e-4), ("rays_per_beam", 10),
                            ("pulse_energy", sensor.GetPulseEnergy()), ("range_gate", sensor.GetRangeGate())):
            self.assertEqual(entry["field_data"][name], value, name)
        self.assertEqual(entry["field_data"]["avian_lidar_version"], entry["avian_lidar_version"])

    def test_crash_while_writing(self):
        """Between the last byte and the name: nothing of the file stays."""
        out = folder("SweepCrash")
        arguments = ["--rays", "10", "--out", str(out)]
        replace = os.replace
        for at in (1, 2):  # the .vtp, the .json
            calls = []

            def crash(one, other):
                calls.append(other)
                if len(calls) == at:
                    raise OSError("crash")
                replace(one, other)

            os.replace = crash
            try:
                self.assertRaises(OSError, sweep.main, arguments)
            finally:
                os.replace = replace
            self.assertEqual(len(list(out.glob("*"))), at - 1)
            self.assertEqual([file.name for file in out.glob("*") if "part" in file.name], [])
        sweep.main(arguments)
        self.assertEqual(len(list(out.iterdir())), 3)

    def test_other_files_are_made_again(self):
        out = folder("SweepDamaged")
        arguments = ["--rays", "10", "--out", str(out)]
        sweep.main(arguments)
        (file,) = out.glob("*.vtp")
        whole = file.read_bytes()
        file.write_bytes(whole[:-7])
        sweep.main(arguments)
        self.assertEqual(file.read_bytes(), whole)
        file.write_bytes(b"x" + whole[1:])
        sweep.main(arguments + ["--verify"])
        self.assertEqual(file.read_bytes(), whole)

    def test_other_parameters_have_other_names(self):
        out = folder("SweepNames")
        for rays in ("10", "11"):
            sweep.main(["--rays", rays, "--out", str(out)])
        self.assertEqual(len(list(out.glob("*.vtp"))), 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
