# SPDX-License-Identifier: BSD-3-Clause
"""Files that are written: whole or not at all, in pairs too; permissions stay; what a killed process leaves goes with the
next writing."""
import fcntl
import os
import pathlib
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import unittest

import vtk

import avianlidar as al
from avianlidar import _suffixes, vtkAvianLidar as wrapped
from cloudtools import echoes
from echotools import Messages

NAMES = ["echoes" + suffix for suffix in (*_suffixes.WRITERS, *_suffixes.OWN) if suffix != ".laz"]

# Writes a file and is killed while it does.
KILLED = """
import os, signal, sys
import avianlidar as al
from avianlidar import _pipeline, _writers
from cloudtools import echoes
def die(*_):
    os.kill(os.getpid(), signal.SIGKILL)
listener = _pipeline._Listener._advanced
_pipeline._Listener._advanced = lambda self, caller, event: die() if caller.GetProgress() < 1 and list(
    one for one in os.listdir(".") if "part" in one) else None
write = _writers.OWN[".csv"]
_writers.OWN[".csv"] = lambda cloud, name: (write(cloud, name), die())
al.save(echoes(), sys.argv[1])
"""

# Writes a file for which the disk is too small.
TOO_SMALL = """
import resource, signal, sys
import avianlidar as al
from cloudtools import echoes
data = echoes()
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
for size in map(int, sys.argv[2:]):
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
    try:
        al.save(data, sys.argv[1])
    except (OSError, al.Error) as error:
        print(type(error).__name__, error)
"""

# Writes labels that fit and points that do not.
FULL = """
import resource, signal
from avianlidar import vtkAvianLidar as wrapped
from cloudtools import echoes
data = echoes()
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
size = 4 * data.GetNumberOfPoints() + 8
assert 16 * data.GetNumberOfPoints() < 4096, "all is buffered to the end"
resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
writer = wrapped.vtkAvianLidarKITTIWriter()
writer.SetInputData(data)
writer.SetFileName("echoes.bin")
assert writer.Write() == 0
"""


# Writes a pair, and says whether that went well.
PAIR = """
from avianlidar import vtkAvianLidar as wrapped
from cloudtools import echoes
writer = wrapped.vtkAvianLidarKITTIWriter()
writer.SetInputData(echoes())
writer.SetFileName("echoes.bin")
raise SystemExit(0 if writer.Write() else 3)
"""


class OutputFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = echoes()

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def run_child(self, program, *arguments, **environment):
        path = os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), os.environ.get("PYTHONPATH", "")])
        return subprocess.run([sys.executable, "-c", program, *arguments],
                              env={**os.environ, "PYTHONPATH": path, **environment}, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=120, check=False)

    def kitti(self, name="echoes.bin"):
        writer = wrapped.vtkAvianLidarKITTIWriter()
        writer.SetInputData(self.data)
        writer.SetFileName(name)
        return writer, Messages(writer)

    def test_permissions_stay(self):
        for name in NAMES:
            for mode in (0o600, 0o640, 0o755, 0o2750):
                file = self.folder / name
                file.write_text("old")
                file.chmod(mode)
                al.save(self.data, file)
                self.assertEqual(oct(stat.S_IMODE(file.stat().st_mode)), oct(mode), name)
                self.assertNotEqual(file.read_bytes(), b"old")

    def test_a_link_stays_a_link(self):
        for name in NAMES:
            os.symlink(name + "-real", name)
            al.save(self.data, self.folder / name)
            self.assertTrue(os.path.islink(name), name)
            self.assertGreater(os.path.getsize(name + "-real"), 100)

    def things_that_are_no_files(self):
        """{name: what tells one from another of its kind}; scratch nodes, never those of the system."""
        os.mkfifo("pipe")
        os.mkdir("folder")
        server = socket.socket(socket.AF_UNIX)
        self.addCleanup(server.close)
        server.bind("socket")
        try:
            os.mknod("device", 0o600 | stat.S_IFCHR, os.makedev(1, 3))
        except PermissionError:
            pass  # only root may
        return {name: os.lstat(name) for name in os.listdir()}

    def test_what_is_no_ordinary_file_stays(self):
        """A file moved onto it would take its place: refused, whether it is named or a link leads to it."""
        things = self.things_that_are_no_files()
        for name in NAMES:
            for thing, before in things.items():
                with self.subTest(f"{name}: {thing}"):
                    os.rename(thing, name)
                    os.symlink(name, "link" + name)
                    for one in (name, "link" + name):
                        with self.assertRaisesRegex((OSError, al.Error), "it is there and no ordinary file"):
                            al.save(self.data, one)
                    self.assertTrue(os.path.samestat(os.lstat(name), before))
                    os.remove("link" + name)
                    os.rename(name, thing)
                    self.assertEqual(set(os.listdir()), set(things))

    def test_links_to_open_pipes(self):
        """Such as /dev/stdout is: the name that it leads to is none of a file system."""
        ends = os.pipe()
        for end in ends:
            self.addCleanup(os.close, end)
        for name in ("echoes.vtp", "echoes.csv"):
            os.symlink(f"/proc/self/fd/{ends[1]}", name)
            with self.assertRaisesRegex(OSError, "it is there and no ordinary file"):
                al.save(self.data, name)
            self.assertTrue(os.path.islink(name))

    def test_links_that_lead_to_themselves(self):
        for name in ("echoes.vtp", "echoes.csv"):
            os.symlink(name, "other" + name)
            os.symlink("other" + name, name)
            with self.assertRaisesRegex(OSError, name):
                al.save(self.data, name)
            self.assertEqual((os.readlink(name), os.readlink("other" + name)), ("other" + name, name))
        self.assertEqual(len(os.listdir()), 4)

    def test_what_a_killed_process_leaves(self):
        for name in NAMES:
            with self.subTest(name):
                (self.folder / name).write_text("old")
                ended = self.run_child(KILLED, name)
                self.assertEqual(ended.returncode, -signal.SIGKILL, ended.stderr)
                self.assertEqual((self.folder / name).read_text(), "old")
                self.assertGreater(len(os.listdir()), 1, "nothing was left: the test tests nothing")
                al.save(self.data, self.folder / name)
                left = {name} | ({"echoes.label"} if name == "echoes.bin" else set())
                self.assertEqual(set(os.listdir()), left)
                for one in left:
                    os.remove(one)

    def test_parts_of_those_who_still_write_stay(self):
        """Two write one file: each its own, the last to end counts."""
        first, _ = self.kitti()
        inner = []

        def meanwhile(*_):
            if not inner:
                inner.append(0)
                second, heard = self.kitti()
                inner[0] = second.Write()
                self.assertEqual(heard.errors, [])

        first.AddObserver("ProgressEvent", lambda caller, _: meanwhile() if any("part" in n for n in os.listdir()) else None)
        self.assertEqual(first.Write(), 1)
        self.assertEqual(inner, [1])
        self.assertEqual(sorted(os.listdir()), ["echoes.bin", "echoes.label"])

    def assert_pair_is_old(self, labels):
        if labels is None:
            self.assertFalse(os.path.exists("echoes.label"))
        else:
            self.assertEqual((self.folder / "echoes.label").read_bytes(), labels)
        self.assertEqual([name for name in os.listdir() if "part" in name], [])

    def test_a_pair_of_which_the_points_fail(self):
        """At the last moment: something else took their name."""
        for labels in (b"old", None):
            if labels:
                (self.folder / "echoes.label").write_bytes(labels)
            writer, heard = self.kitti()
            writer.AddObserver(
                "ProgressEvent", lambda *_: os.mkdir("echoes.bin") if any("part" in n for n in os.listdir()) and
                not os.path.exists("echoes.bin") else None)
            self.assertEqual(writer.Write(), 0)
            self.assertEqual(len(heard.errors), 1)
            self.assertIn("cannot be given its name", heard.errors[0])
            self.assert_pair_is_old(labels)
            os.rmdir("echoes.bin")
            if labels:
                os.remove("echoes.label")

    def write_pair_after(self, action):
        """Over a pair; the action is called once parts are there."""
        (self.folder / "echoes.label").write_bytes(b"old")
        (self.folder / "echoes.bin").write_bytes(b"older")
        writer, heard = self.kitti()
        writer.AddObserver("ProgressEvent", lambda *_: action() if any("part" in name for name in os.listdir()) else None)
        return writer.Write(), heard.errors

    def test_what_others_keep_is_not_in_the_way(self):
        """The old labels of another writer, which holds them, and of one that was killed."""
        kept = self.folder / "echoes.label.avianpart0-old"
        self.assertEqual(self.write_pair_after(lambda: kept.write_bytes(b"others'")), (1, []))
        self.assertEqual(kept.read_bytes(), b"others'")
        with open(kept, "rb") as held:
            fcntl.flock(held, fcntl.LOCK_SH)
            self.assertEqual(self.kitti()[0].Write(), 1)
            self.assertEqual(kept.read_bytes(), b"others'")
        for mode in (0o644, 0o444):
            kept.write_bytes(b"others'")
            kept.chmod(mode)
            self.assertEqual(self.kitti()[0].Write(), 1)
            self.assertEqual(sorted(os.listdir()), ["echoes.bin", "echoes.label"])

    def test_old_labels_without_links(self):
        """A copy is kept where there are no hard links. Another writer leaves it alone; half of it does not stay."""
        preloaded = {"LD_PRELOAD": os.environ["AVIANLIDAR_FAILING_FILES"]}

        def write_pair(**environment):
            (self.folder / "echoes.label").write_bytes(b"old")
            (self.folder / "echoes.bin").write_bytes(b"older")
            return self.run_child(PAIR, **preloaded, **environment)

        (self.folder / "pair.py").write_text(PAIR)
        second = f"ls > names1; {sys.executable} pair.py && ls > names2"
        cases = ({}, 0, ""), ({"FAILING_COPY": "1"}, 3, "cannot be kept while it is replaced: No space left"), (
            {"RENAMED_TO": "echoes.bin", "BEFORE_RENAME": second}, 0, ""), (
            {"RENAMED_TO": "echoes.bin", "BEFORE_RENAME": "false"}, 3, "cannot be given its name")
        for environment, code, words in cases:
            with self.subTest(environment):
                ended = write_pair(**environment)
                self.assertEqual(ended.returncode, code, ended.stderr)
                self.assertIn(words, ended.stderr)
                self.assertNotIn("filesystem error", ended.stderr)
                self.assertEqual([name for name in os.listdir() if "part" in name], [])
                self.assertEqual((self.folder / "echoes.label").read_bytes() == b"old", code != 0)
                self.assertEqual((self.folder / "echoes.bin").read_bytes() == b"older", code != 0)
        for names in ("names1", "names2"):
            self.assertIn("echoes.label.avianpart0-old", (self.folder / names).read_text().split())

    def test_old_labels_that_cannot_be_kept(self):
        """Folders have all their names: an error, and both files as they were."""
        folders = [f"echoes.label.avianpart{i}-old" for i in range(16)]
        result, errors = self.write_pair_after(lambda: [os.makedirs(name + "/full", exist_ok=True) for name in folders])
        self.assertEqual(result, 0)
        self.assertEqual(len(errors), 1)
        self.assertIn("echoes.label cannot be kept while it is replaced: File exists", errors[0])
        self.assertNotIn("filesystem error", errors[0])
        self.assertEqual((self.folder / "echoes.label").read_bytes(), b"old")
        self.assertEqual((self.folder / "echoes.bin").read_bytes(), b"older")
        self.assertEqual(set(os.listdir()), {"echoes.bin", "echoes.label", *folders})

    def test_a_pair_for_which_the_disk_is_too_small(self):
        (self.folder / "echoes.label").write_bytes(b"old")
        (self.folder / "echoes.bin").write_bytes(b"older")
        ended = self.run_child(FULL)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertIn("cannot be written to its end", ended.stderr)
        self.assert_pair_is_old(b"old")
        self.assertEqual((self.folder / "echoes.bin").read_bytes(), b"older")

    def test_a_disk_that_is_too_small(self):
        """For the first byte, for some of them, for the last one: an exception, the old file and nothing else."""
        for name in NAMES[-2:]:
            with self.subTest(name):
                al.save(self.data, name)
                whole = os.path.getsize(name)
                (self.folder / name).write_text("old")
                ended = self.run_child(TOO_SMALL, name, "0", "1000", "9000", str(whole - 1))
                self.assertEqual(ended.returncode, 0, ended.stderr)
                self.assertEqual(ended.stderr, "")
                self.assertEqual(len(ended.stdout.splitlines()), 4, ended.stdout)
                for line in ended.stdout.splitlines():
                    self.assertIn("OSError", line)
                self.assertEqual((self.folder / name).read_text(), "old")
                self.assertEqual(os.listdir(), [name])
                os.remove(name)

    def test_the_bytes_of_the_vtp_writer(self):
        """Of any text in the data, too."""
        for name in (b"B\xe4ume", "\u6811".encode(), b"a"):
            field = vtk.vtkStringArray()
            field.SetName(name)
            field.InsertNextValue(name + b"\0\r\n")
            self.data.GetFieldData().AddArray(field)
            writer = vtk.vtkXMLPolyDataWriter()
            writer.SetDataModeToBinary()
            writer.SetInputData(self.data)
            writer.SetFileName("plain.vtp")
            self.assertEqual(writer.Write(), 1)
            al.save(self.data, "echoes.vtp")
            self.assertEqual((self.folder / "echoes.vtp").read_bytes(), (self.folder / "plain.vtp").read_bytes())
            self.data.GetFieldData().RemoveArray(name)

    def test_points_that_are_their_own_labels(self):
        os.symlink("b.label", "b.bin")
        for name in ("x.label", str(self.folder / "x.label"), "./x.label", "b.bin"):
            writer, heard = self.kitti(name)
            self.assertEqual(writer.Write(), 0, name)
            self.assertEqual(len(heard.errors), 1)
            self.assertIn(".label", heard.errors[0])
            self.assertEqual(os.listdir(), ["b.bin"])

    def test_no_name(self):
        for name in (None, ""):
            writer, heard = self.kitti(name)
            self.assertEqual(writer.Write(), 0)
            self.assertIn("FileName is not set", heard.errors[0])


if __name__ == "__main__":
    unittest.main()
