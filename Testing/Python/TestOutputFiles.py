# SPDX-License-Identifier: BSD-3-Clause
"""Files that the package and the applications write: whole or not at all, in pairs too, with an error that names the
file. Permissions, links, and folders and devices stay. Parts of a killed process are removed at the next writing."""
import contextlib
import errno
import os
import pathlib
import signal
import socket
import stat
import subprocess
import sys
import tempfile
from unittest import mock

import numpy as np

import avianlidar as al
from avianlidar import _pipeline, _suffixes, _writers, vtkAvianLidar as wrapped
from avianlidar._disk import only_run, replacing
from avianlidar.apps.coverage import _maps
from avianlidar.apps.pages._drawing import draw
from cloudtools import echoes
from echotools import InFolder, Messages
from faulttools import disk

NAMES = ["echoes" + suffix for suffix in (*_suffixes.WRITERS, *_suffixes.OWN)
         if suffix != ".laz" or os.environ["AVIANLIDAR_LASZIP"] == "1"]

NOISE = np.random.default_rng(1).uniform(0.0, 1.0, (200, 200)).astype(np.float32)
PLACE, ORIGIN = ((0, 0), (1, 1)), (0.0, 0.0, 0.0)
# Files of the applications, and how they are written.
MAPS = {
    "map.tif": lambda _, file: _maps.write_geotiff(file, NOISE, *PLACE, ORIGIN, "p"),
    "status.tif": lambda _, file: _maps.write_geotiff(file, (9 * NOISE).astype(int), *PLACE, None, "s", "",
                                                      list("abcdefghi")),
    "areas.geojson": lambda folder, file: _maps.write_areas(file, folder / "from.tif", "words"),
    "table.csv": lambda _, file: _maps.write_table(file, [{"value": i} for i in range(9000)]),
    "picture.png": lambda _, file: draw(file, (4, 4), lambda axes: axes.imshow(NOISE))}
ALL = (*NAMES, *MAPS)

# Writes the cloud of data.pcd, a pair or a file that needs a reference system, and says whether that went well.
WRITE = """
import sys
from avianlidar import vtkAvianLidar as wrapped
reader = wrapped.vtkAvianLidarPointCloudReader()
reader.SetFileName("data.pcd")
writer = wrapped.vtkAvianLidarLASWriter() if sys.argv[1].endswith(".las") else wrapped.vtkAvianLidarKITTIWriter()
writer.SetInputConnection(reader.GetOutputPort())
writer.SetFileName(sys.argv[1])
raise SystemExit(0 if writer.Write() else 3)
"""


@contextlib.contextmanager
def read_only(folder):
    """Nothing may be made there, not even by root."""
    user = os.geteuid()
    folder.chmod(0o555)
    os.seteuid(user or 65534)  # nobody
    try:
        yield
    finally:
        os.seteuid(user)
        folder.chmod(0o755)


def parts():
    return [name for name in os.listdir() if "part" in name]


class Written(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.data = echoes()
        cls.inputs = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.inputs.chmod(0o755)
        _maps.write_geotiff(cls.inputs / "from.tif", NOISE[:40, :40], *PLACE, ORIGIN, "p")

    def save(self, name):
        kind = next((kind for kind in MAPS if os.path.basename(name).endswith(kind)), None)
        MAPS[kind](self.inputs, pathlib.Path(name)) if kind else al.save(self.data, name)

    def run_child(self, name, **environment):
        """Writes in a process of its own with that environment."""
        al.save(self.data, "data.pcd")
        ended = subprocess.run([sys.executable, "-c", WRITE, name], env={**os.environ, **environment},
                               capture_output=True, text=True, timeout=120, check=False)
        os.remove("data.pcd")
        return ended

    def killed(self, name):
        """Ends while a child writes: the signal."""
        def die(*_):
            os.kill(os.getpid(), signal.SIGKILL)

        child = os.fork()
        if not child:
            advanced, csv = _pipeline.Updates._advanced, _writers.OWN[".csv"]
            _pipeline.Updates._advanced = lambda listener, caller, event: (
                die() if caller.GetProgress() < 1 and parts() else advanced(listener, caller, event))
            _writers.OWN[".csv"] = lambda cloud, file: (csv(cloud, file), die())
            al.save(self.data, name)
            os._exit(0)
        return os.waitpid(child, 0)[1]

    def refused(self, name, words, kinds=(OSError, al.Error, RuntimeError)):
        with self.assertRaisesRegex(kinds, words) as caught:
            self.save(name)
        self.assertIn(os.path.basename(name), str(caught.exception))

    def kitti(self, name="echoes.bin"):
        writer = wrapped.vtkAvianLidarKITTIWriter()
        writer.SetInputData(self.data)
        writer.SetFileName(name)
        return writer, Messages(writer)


class Single(Written):
    def test_what_was_there_is_replaced(self):
        """With its permissions; through a link; nothing else is touched."""
        for name in ALL:
            for mode in (0o600, 0o2750):
                with self.subTest(name, mode=oct(mode)):
                    file, other = self.folder / name, self.folder / (name + ".part0")
                    file.write_text("x" * 2_000_000)
                    other.write_text("not yours")
                    file.chmod(mode)
                    os.symlink(name, "link-" + name)
                    self.save("link-" + name)
                    self.assertTrue(os.path.islink("link-" + name))
                    self.assertEqual(stat.S_IMODE(file.stat().st_mode), mode)
                    self.assertTrue(100 < file.stat().st_size < 1_000_000)
                    self.assertEqual(other.read_text(), "not yours")
                    for one in os.listdir():
                        os.remove(one)

    def test_what_is_no_ordinary_file_stays(self):
        """A file moved onto it would take its place: refused, whether it is named or a link leads to it."""
        os.mkfifo("pipe")
        os.mkdir("folder")
        server = socket.socket(socket.AF_UNIX)
        self.addCleanup(server.close)
        server.bind("socket")
        with contextlib.suppress(PermissionError):  # only root may
            os.mknod("device", 0o600 | stat.S_IFCHR, os.makedev(1, 3))
        things = {name: os.lstat(name) for name in os.listdir()}
        for name in ALL:
            for thing, before in things.items():
                with self.subTest(f"{name}: {thing}"):
                    os.rename(thing, name)
                    os.symlink(name, "link" + name)
                    for one in (name, "link" + name):
                        self.refused(one, "it exists and is not a regular file")
                    self.assertTrue(os.path.samestat(os.lstat(name), before))
                    os.remove("link" + name)
                    os.rename(name, thing)
                    self.assertEqual(set(os.listdir()), set(things))

    def test_links_that_lead_to_no_file(self):
        """To an open pipe, as /dev/stdout is, a name of no file system; to themselves."""
        ends = os.pipe()
        for end in ends:
            self.addCleanup(os.close, end)
        for name in ("echoes.vtp", "echoes.csv"):
            for place, words in ((f"/proc/self/fd/{ends[1]}", "it exists and is not a regular file"), (name, name)):
                os.symlink(place, name)
                self.refused(name, words, OSError)
                self.assertEqual(os.readlink(name), place)
                os.remove(name)

    def test_links_to_what_is_not_there(self):
        """In a folder that is missing, or still to be made."""
        for name in ALL:
            with self.subTest(name):
                os.symlink("missing/other-" + name, "missing-" + name)
                missing = (rf"No such file or directory: '?(/.*/)?missing-{name}(\.aux\.xml)?'?\Z|missing-{name}: "
                           r".*No such file or directory\.\Z")
                self.refused("missing-" + name, missing)
                os.symlink("other-" + name, name)
                self.save(name)
                self.assertEqual((os.readlink(name), os.path.isfile("other-" + name)), ("other-" + name, True))

    def test_a_folder_that_is_only_read(self):
        """Files that are there stay, new ones are not made, and no run has the folder."""
        for name in ALL:
            self.save(name)
        before = {path.name: path.read_bytes() for path in self.folder.iterdir()}
        with read_only(self.folder):
            for name in ALL:
                for one in (name, "new-" + name):
                    with self.subTest(one):
                        self.refused(one, "Permission denied")
            for folder in (".", "new"):
                with self.assertRaisesRegex(PermissionError, folder), only_run(folder):
                    self.fail("it goes on")
        self.assertEqual({path.name: path.read_bytes() for path in self.folder.iterdir()}, before)

    def test_two_write_one_file(self):
        """Python's own and any writer: each its own part, the last to end counts."""
        for name in ALL:
            with self.subTest(name), replacing(self.folder / name) as part:
                pathlib.Path(part).write_text("last")
                self.save(name)
                self.assertGreater(os.path.getsize(name), 100)
            self.assertEqual(((self.folder / name).read_text(), parts()), ("last", []))

    def test_names_that_are_none(self):
        for name in ALL:
            self.refused(os.path.join("none", name), "No such file or directory")
        os.symlink("b.label", "b.bin")
        # Points that are their own labels.
        for name in (None, "x.label", str(self.folder / "x.label"), "./x.label", "b.bin"):
            writer, heard = self.kitti(name)
            self.assertEqual((writer.Write(), len(heard.errors)), (0, 1), name)
            self.assertIn(".label" if name else "FileName is not set", heard.errors[0])
        self.assertEqual(os.listdir(), ["b.bin"])

    def test_a_disk_that_is_too_small(self):
        """For the first byte, for some of them, for the last one: an error, the old file and nothing else, whatever
        lies beside it."""
        beside = pathlib.Path("status.tif.aux.xml")
        self.save("status.tif")
        beside.write_text("good")
        for name in ALL:
            self.save(name)
            whole = os.path.getsize(name)
            beside.write_text("good")
            for size in (0, whole // 2, whole - 1):
                with self.subTest(name, size=size):
                    pathlib.Path(name).write_text("old")
                    before = set(os.listdir())
                    with disk(size):
                        self.refused(name, "File too large|too large|cannot be written to its end")
                    self.assertEqual((pathlib.Path(name).read_text(), set(os.listdir())), ("old", before))
                    self.assertEqual(beside.read_text(), "good")

    def test_a_disk_that_fails_at_the_end(self):
        """A file gets its name only when its bytes are on the disk."""
        names = ("echoes.las", "echoes.bin", "echoes.label", "echoes.csv")
        for name in names:
            (self.folder / name).write_text("old")
        for name in names[:2]:
            ended = self.run_child(name, LD_PRELOAD=os.environ["AVIANLIDAR_FAILING_FILES"], NO_SYNC="1")
            self.assertEqual(ended.returncode, 3, ended.stderr)
            self.assertIn("cannot be written to its end: Input/output error", ended.stderr)
        with mock.patch.object(os, "fsync", side_effect=OSError(errno.EIO, "Input/output error")):
            self.refused("echoes.csv", "Input/output error")
        self.assertEqual({name: (self.folder / name).read_text() for name in os.listdir()}, dict.fromkeys(names, "old"))

    def test_what_a_killed_process_leaves(self):
        for name in ("echoes.las", "echoes.bin", "echoes.csv"):
            with self.subTest(name):
                (self.folder / name).write_text("old")
                self.assertEqual(self.killed(name), signal.SIGKILL)
                self.assertEqual((self.folder / name).read_text(), "old")
                self.assertGreater(len(os.listdir()), 1, "nothing was left: the test tests nothing")
                al.save(self.data, self.folder / name)
                left = {name} | ({"echoes.label"} if name == "echoes.bin" else set())
                self.assertEqual(set(os.listdir()), left)
                for one in left:
                    os.remove(one)

    def test_without_the_database_of_proj(self):
        ended = self.run_child("cloud.las", PROJ_DATA=os.devnull, PROJ_LIB=os.devnull)
        self.assertRegex(ended.stderr, r"GDAL does not know EPSG:\d+ ")


class Pairs(Written):
    """Points and labels of KITTI: both are new, or both as they were."""

    def write_after(self, action, labels=b"old", points=b"older"):
        """Over a pair; the action is called once parts are there."""
        for name, content in (("echoes.label", labels), ("echoes.bin", points)):
            if content:
                (self.folder / name).write_bytes(content)
        writer, heard = self.kitti()
        done = []
        writer.AddObserver("ProgressEvent", lambda *_: done.append(action()) if parts() and not done else None)
        return writer.Write(), heard.errors

    def assert_old(self, labels=b"old", points=b"older"):
        for name, content in (("echoes.label", labels), ("echoes.bin", points)):
            self.assertEqual((self.folder / name).read_bytes() if os.path.isfile(name) else None, content)

    def test_labels_are_beside_the_target_of_a_link(self):
        os.mkdir("real")
        (self.folder / "real" / "a.label").write_bytes(b"old")
        os.symlink("real/a.bin", "echoes.bin")
        self.assertEqual(self.kitti()[0].Write(), 1)
        self.assertEqual((sorted(os.listdir()), sorted(os.listdir("real"))),
                         (["echoes.bin", "real"], ["a.bin", "a.label"]))
        self.assertEqual((self.folder / "real" / "a.label").stat().st_size, 4 * self.data.GetNumberOfPoints())
        self.assertIn("semantic_label", al.load_cloud("echoes.bin"))

    def test_two_write_one_pair(self):
        """Each its own parts, the last to end counts."""
        inner = []
        self.assertEqual(self.write_after(lambda: inner.append(self.kitti()[0].Write())), (1, []))
        self.assertEqual((inner, sorted(os.listdir())), ([1], ["echoes.bin", "echoes.label"]))

    def test_the_points_fail(self):
        """At the last moment: something else took their name; or the labels fit on the disk and the points do not."""
        for labels in (b"old", None):
            written, errors = self.write_after(lambda: os.mkdir("echoes.bin"), labels, None)
            self.assertEqual((written, len(errors), parts()), (0, 1, []))
            self.assertIn("cannot be given its name", errors[0])
            self.assert_old(labels, None)
            os.rmdir("echoes.bin")
            if labels:
                os.remove("echoes.label")
        with disk(4 * self.data.GetNumberOfPoints() + 8):
            written, errors = self.write_after(lambda: None)
        self.assertEqual((written, len(errors), parts()), (0, 1, []))
        self.assertIn("cannot be written to its end", errors[0])
        self.assert_old()

    def test_names_that_cannot_be_exchanged(self):
        """The points get no name after the labels: the old labels are back, or the error says that they are gone."""
        failing = {"RENAMED_TO": "echoes.bin", "BEFORE_RENAME": "false"}
        for environment, code, words in (({"NO_EXCHANGE": "1"}, 0, ""),
                                         (failing, 3, "cannot be given its name: Input/output error"),
                                         ({"NO_EXCHANGE": "1", **failing}, 3, "echoes.label is replaced already")):
            with self.subTest(environment):
                for name, content in (("echoes.label", b"old"), ("echoes.bin", b"older")):
                    (self.folder / name).write_bytes(content)
                ended = self.run_child("echoes.bin", LD_PRELOAD=os.environ["AVIANLIDAR_FAILING_FILES"], **environment)
                self.assertEqual((ended.returncode, parts()), (code, []), ended.stderr)
                self.assertIn(words, ended.stderr)
                if code and environment == failing:
                    self.assert_old()
                else:
                    self.assertNotEqual((self.folder / "echoes.label").read_bytes(), b"old")
