# SPDX-License-Identifier: BSD-3-Clause
"""Files and folders of the applications (sequence, coverage, siting, report): names that become file names, what is read, one
run in a folder, files that are whole or as they were, and folders that go on with the same inputs only."""
import contextlib
import errno
import gzip
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
import unittest.mock

import numpy as np

import avianlidar as al
from avianlidar import siting as _siting
from avianlidar._command import main
from avianlidar.apps import _maps, _report, _sites
from osgeo import gdal
from reporttools import quick

OUTPUT = pathlib.Path(os.environ.get("AVIANLIDAR_TEST_OUTPUT_DIR", "/tmp")) / "applications"
SCENE = {"version": 1, "origin": {"latitude": 0, "longitude": 0, "height": 0}, "lidar": {"position": [5, -8, 3]}, "objects": [
    {"name": "Ground", "class": "ground", "ground": {"size": 4000, "height": 0}, "material": "Wall"},
    {"name": "Board", "file": "board.obj", "material": "Wall"}]}
BOARD = "v 20 90 0\nv 60 80 0\nv 60 80 9\nv 20 90 9\nf 1 2 3 4\n"
RUNWAY = {"type": "Feature", "properties": {"kind": "runway", "name": "09/27", "width": 45},
          "geometry": {"type": "LineString", "coordinates": [[0.001, 0.002], [0.006, 0.002]]}}
SENSOR = {"preset": "Search905", "azimuth_range": [0, 90], "azimuth_step": 1}
PLAN = {"scene": "s.lidarscene.json", "sensor": SENSOR, "runways": "runways.geojson", "coverage": {"species": "crow"}, "heights": [30],
        "extent": [-200, 200, -200, 200], "spacing": 50, "places": 100,
        "siting": {"bounds": [-200, 200, -200, 200], "spacing": 200, "draws": 0, "sensors": 1}}
SCENARIO = {"scene": "s.lidarscene.json", "sensor": SENSOR, "number_of_scans": 4, "scans_per_sequence": 2, "seed": 5,
            "birds": [{"pattern": "Crossings", "number_of_birds": 3, "radius": 300, "heights": [5, 40]}]}

# Runs commands, each a line of arguments; what is read may wait for ever, or never end.
CHILD = """
import json, resource, sys
resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
from avianlidar._command import main
for line in sys.stdin:
    print(line.rstrip(), file=sys.stderr, flush=True)
    print("status", main(json.loads(line)), file=sys.stderr, flush=True)
"""

# Writes files for which the disk is too small: says what was raised.
FULL = """
import resource, signal, sys
import numpy as np
import TestApplicationFiles as test
from avianlidar import _ranks
from avianlidar.apps import _maps, _pictures
import avianlidar as al
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
home = test.pathlib.Path(sys.argv[1])
noise = np.random.default_rng(1).uniform(0.0, 1.0, (200, 200)).astype(np.float32)
def report():
    with test.quick():
        test._report.Report(_maps.read_plan(home / "p.coverage.json", siting={})).write(home / "report.html")
work = {
    "map.tif": lambda: _maps.write_geotiff(home / "map.tif", noise, (0, 0), (1, 1), test.ORIGIN, "p"),
    "status.tif": lambda: _maps.write_geotiff(home / "status.tif", (9 * noise).astype(int), (0, 0), (1, 1), None, "s", "", list("abcdefghi")),
    "areas.geojson": lambda: _maps.write_areas(home / "areas.geojson", home / "from.tif", "words"),
    "table.csv": lambda: _maps.write_table(home / "table.csv", [{"value": i} for i in range(9000)]),
    "picture.png": lambda: _pictures.draw(home / "picture.png", (4, 4), lambda axes: axes.imshow(noise)),
    "report.html": report,
    "sequences": lambda: al.Sequence(home / "q.scenario.json").write(home)}
for name in sys.argv[2:]:
    if name == "from.tif":
        _maps.write_geotiff(home / "from.tif", noise, (0, 0), (1, 1), test.ORIGIN, "p")
        continue
    resource.setrlimit(resource.RLIMIT_FSIZE, (200 if name == "sequences" else 5000, resource.RLIM_INFINITY))
    try:
        work[name]()
        print(name, "no error")
    except (OSError, RuntimeError) as error:
        print(name, "error:", type(error).__name__, error)
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
"""
ORIGIN = (0.0, 0.0, 0.0)

# Has a folder for itself until it is killed.
HOLDER = """
import sys, time
from avianlidar._disk import only_run
with only_run(sys.argv[1]):
    print("has it", flush=True)
    time.sleep(600)
"""


def child(program, *arguments, **options):
    path = os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), os.environ.get("PYTHONPATH", "")])
    return subprocess.Popen([sys.executable, "-c", program, *map(str, arguments)], env={**os.environ, "PYTHONPATH": path}, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


def run(*arguments):
    """The command, here. @return its status, what it says to the error stream"""
    with contextlib.redirect_stderr(io.StringIO()) as said, contextlib.redirect_stdout(io.StringIO()):
        status = main([str(argument) for argument in arguments])
    return status, said.getvalue()


def tree(folder):
    """{name: content} of all files below."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


class Applications(unittest.TestCase):
    def setUp(self):
        self.enterContext(quick())
        self.home = OUTPUT / self.id().rpartition(".")[2]
        shutil.rmtree(self.home, ignore_errors=True)
        self.home.mkdir(parents=True)
        (self.home / "board.obj").write_text(BOARD)
        self.write("s.lidarscene.json", SCENE)
        self.write("runways.geojson", {"type": "FeatureCollection", "features": [RUNWAY]})
        self.plan, self.scenario = self.write("p.coverage.json", PLAN), self.write("q.scenario.json", SCENARIO)

    def write(self, name, document):
        (self.home / name).write_text(json.dumps(document), encoding="utf-8")
        return self.home / name


class Names(Applications):
    BAD = ("..", ".", "", "a/b", "/a", "a\0b", "a\nb", "a\x7f", ".hidden", "\ud800", "x" * 300, "\u2028")

    def test_are_checked_before_anything_is_written(self):
        for verb in ("coverage", "report"):
            for name in self.BAD:
                for change in ({"compare_with": [{**SENSOR, "name": name}]}, {"sensor": {**SENSOR, "name": name}}):
                    with self.subTest(verb=verb, change=change):
                        plan = self.write("bad.coverage.json", {**PLAN, **change})
                        before = tree(self.home)
                        status, said = run(verb, plan, "-o", self.home / "in" / ("report.html" if verb == "report" else "out"))
                        self.assertEqual(status, 2)
                        self.assertEqual(len(said.splitlines()), 1, said)
                        self.assertIn("bad.coverage.json", said)
                        self.assertIn(".name" if "sensor" in change else "compare_with[0]", said)
                        self.assertEqual(tree(self.home), before)

    def test_of_sensor_files(self):
        """A name that the plan does not say is that of the file."""
        (self.home / ".lidarsensor.json").write_text("{}")
        plan = self.write("bad.coverage.json", {**PLAN, "sensor": {"preset": ".lidarsensor.json"}})
        status, said = run("coverage", plan, "-o", self.home / "out")
        self.assertEqual(status, 2)
        self.assertIn("bad.coverage.json: sensor.name", said)

    def test_others_are_taken(self):
        for name in ("Search905 at 5 m", "日本", "a.b", "x" * 100, "~a\\b"):
            _maps.read_plan(self.write("good.coverage.json", {**PLAN, "sensor": {**SENSOR, "name": name}}))
            self.assertEqual(_maps.sensor_name({**SENSOR, "name": name}), name)


class Inputs(Applications):
    def commands(self, file, kind):
        """{what is no regular file: a command that reads it}"""
        def plan(name, **changes):
            siting = {**PLAN["siting"], **changes.pop("siting", {})}
            return str(self.write(f"{kind}-{name}.coverage.json", {**PLAN, "siting": siting, **changes}))

        def scenario(name, **changes):
            bird = {**SCENARIO["birds"][0], **changes.pop("bird", {})}
            return str(self.write(f"{kind}-{name}.scenario.json", {**SCENARIO, "birds": [bird], **changes}))
        out = ["-o", str(self.home / "out")]
        found = {
            "plan": ["coverage", file, *out], "scenario": ["sequence", file, *out],
            "runways": ["coverage", plan("runways", runways=file), *out],
            "points": ["siting", plan("points", siting={"points": file}), *out],
            "exclusions": ["siting", plan("exclusions", siting={"exclusions": [file]}), *out],
            "species of a plan": ["coverage", plan("species", coverage={"species_file_name": file, "species": "crow"}), *out],
            "species of sites": ["siting", plan("kept", coverage={"species_file_name": file, "species": "crow"}), *out],
            "tracks": ["sequence", scenario("tracks", bird={"pattern": "File", "file_name": file}), *out],
            "species of a scenario": ["sequence", scenario("species", bird={"species_file_name": file}), *out]}
        if kind == "pipe":  # their names say what they are; a link's is followed
            for name in ("pipe.lidarscene.json", "pipe.lidarsensor.json"):
                os.mkfifo(self.home / name)
            found.update({
                "scene of a plan": ["coverage", plan("scene", scene="pipe.lidarscene.json"), *out],
                "sensor of a plan": ["coverage", plan("sensor", sensor={"preset": "pipe.lidarsensor.json"}), *out],
                "scene of a scenario": ["sequence", scenario("scene", scene="pipe.lidarscene.json"), *out],
                "sensor of a scenario": ["sequence", scenario("sensor", sensor={"preset": "pipe.lidarsensor.json"}), *out]})
        return found

    def said(self, commands):
        """What each command says, run one after the other in one process. The test does not wait for ever."""
        job = child(CHILD, stdin=subprocess.PIPE)
        try:
            _, said = job.communicate("".join(json.dumps(command) + "\n" for command in commands), timeout=100)
        except subprocess.TimeoutExpired:
            job.kill()
            self.fail("waits for ever: " + job.communicate()[1].splitlines()[-1])
        self.assertEqual(job.returncode, 0, said)
        return said

    def test_are_regular_files(self):
        os.mkfifo(self.home / "pipe")
        os.symlink("/dev/zero", self.home / "device")
        commands = {f"{kind}: {what}": command for kind in ("pipe", "device")
                    for what, command in self.commands(str(self.home / kind), kind).items()}
        said = self.said(commands.values()).splitlines()
        self.assertEqual(len(said), 3 * len(commands), "\n".join(said))
        for (what, command), (line, message, status) in zip(commands.items(), zip(said[::3], said[1::3], said[2::3])):
            with self.subTest(what):
                self.assertEqual((json.loads(line), status), (command, "status 2"))
                self.assertIn("it is no regular file but a pipe or a device", message)
                self.assertIn(what.partition(":")[0], message)

    def test_folders_are_none(self):
        for verb in ("coverage", "siting", "report", "sequence"):
            status, said = run(verb, self.home, "-o", self.home / "out.html")
            self.assertEqual(status, 2)
            self.assertRegex(said, f"{self.home}.*it is a folder")

    def test_gzip_has_a_limit(self):
        """Parts that follow each other are one text: 2 GiB of blanks."""
        (self.home / "bomb.coverage.json").write_bytes(gzip.compress(b" " * (1 << 26)) * 32)
        self.assertLess((self.home / "bomb.coverage.json").stat().st_size, 1 << 22)
        said = self.said([["coverage", str(self.home / "bomb.coverage.json"), "-o", str(self.home / "out")]])
        self.assertRegex(said, r"bomb.coverage.json: holds more than 256 MiB, once decompressed")
        self.assertIn("status 2", said)
        (self.home / "good.coverage.json").write_bytes(gzip.compress(self.plan.read_bytes()))
        plans = [_maps.read_plan(file) for file in (self.home / "good.coverage.json", self.plan)]
        for plan in plans:
            plan.pop("file")
        self.assertEqual(*plans)


class OneRun(Applications):
    def again(self, where, *arguments):
        """While the command writes, it is started once more. @param where what is called meanwhile @return what both say"""
        owner, name = where
        method, second = getattr(owner, name), []

        def meanwhile(*given, **named):
            if not second:
                second.append(None)
                second[0] = run(*arguments)
            return method(*given, **named)
        with unittest.mock.patch.object(owner, name, meanwhile):
            first = run(*arguments)
        self.assertEqual(len(second), 1)
        return first, second[0]

    def test_has_a_folder_alone(self):
        for verb, file, out, folder, where in (
                ("sequence", self.scenario, "sets", "sets", (al.Sequence, "_write_one")),
                ("coverage", self.plan, "maps", "maps", (_maps, "write_table")),
                ("siting", self.plan, "sites", "sites", (_sites.Sites, "write")),
                ("report", self.plan, "r.html", "r_files", (_report.Report, "_tables"))):
            with self.subTest(verb):
                one_thread = [] if verb == "siting" else ["--threads", "1"]
                first, second = self.again(where, verb, file, "-o", self.home / out, *one_thread)
                self.assertEqual(first[0], 0, first)
                self.assertEqual(second[0], 2, second)
                self.assertEqual(len(second[1].splitlines()), 1)
                self.assertRegex(second[1], f"{self.home / folder}: another run writes there")
                self.assertEqual([path for path in self.home.rglob("*") if ".part" in path.name or ".avian" in path.name], [])
        for verb, file, out in (("sequence", self.scenario, "sets"), ("coverage", self.plan, "maps")):
            self.assertEqual(run(verb, file, "-o", self.home / f"alone-{out}")[0], 0)
            self.assertEqual(tree(self.home / out), tree(self.home / f"alone-{out}"))
            self.assertEqual(run(verb, file, "-o", self.home / out)[0], 0)  # the folder is free again

    def test_that_was_killed_has_none(self):
        out = self.home / "sets"
        job = child(HOLDER, out)
        self.assertEqual(job.stdout.readline(), "has it\n")
        try:
            with self.assertRaisesRegex(al.Error, f"{out}: another run writes there"):
                al.Sequence(self.scenario).write(out)
        finally:
            job.send_signal(signal.SIGKILL)
            job.communicate()
        al.Sequence(self.scenario).write(out)
        self.assertEqual(sorted(path.name for path in out.iterdir()), ["datasheet.md", "manifest.json", "semantic-kitti.yaml", "sequences"])


    def test_where_files_have_no_locks(self):
        """As of some network file systems: a file that is made counts as the lock, and who was killed leaves it."""
        def refuse(*_):
            raise OSError(errno.ENOLCK, "No locks available")
        out = self.home / "maps"
        with unittest.mock.patch("fcntl.flock", refuse):
            first, second = self.again((_maps, "write_table"), "coverage", self.plan, "-o", out, "--threads", 1)
            self.assertEqual(first[0], 0, first)
            self.assertEqual(second[0], 2, second)
            self.assertRegex(second[1], f"{out}: another run writes there; .*have no locks: if no other run is there, remove {out}/.avianlidar.lock")
            self.assertFalse((out / ".avianlidar.lock").exists())
            (out / ".avianlidar.lock").touch()
            self.assertEqual(run("coverage", self.plan, "-o", out)[0], 2)
            (out / ".avianlidar.lock").unlink()
            self.assertEqual(run("coverage", self.plan, "-o", out, "--threads", 1)[0], 0)
        (out / ".avianlidar.lock").touch()  # where there are locks a killed run's is free
        self.assertEqual(run("coverage", self.plan, "-o", out, "--threads", 1)[0], 0)


class Stopped(Applications):
    """By Ctrl-C, or by an error: nothing stays that was not there before, unless the same command goes on with it."""

    def stop(self, where, arguments, times=1, error=KeyboardInterrupt):
        """@param where what is stopped in its call of this number"""
        owner, name = where
        method, calls = getattr(owner, name), []

        def meanwhile(*given, **named):
            calls.append(name)
            if len(calls) == times:
                raise error
            return method(*given, **named)
        with unittest.mock.patch.object(owner, name, meanwhile):
            return run(*arguments)

    def test_leaves_nothing_behind(self):
        before = tree(self.home), sorted(self.home.rglob("*"))
        for verb, file, out, where in (("report", self.plan, "in/here/r.html", (_report.Report, "_tables")),
                                       ("coverage", self.plan, "in/maps", (_maps, "write_table")),
                                       ("siting", self.plan, "in/sites", (al.Coverage, "set")),
                                       ("sequence", self.scenario, "in/sets", (al.Sequence, "truth"))):
            for error, status in ((KeyboardInterrupt, 130), (al.Error("no more"), 2)):
                with self.subTest(verb=verb, error=error):
                    times = 5 if verb == "siting" else 1
                    code, said = self.stop(where, (verb, file, "-o", self.home / out), times, error)
                    self.assertEqual((code, said), (status, "avianlidar: stopped\n" if status == 130 else "avianlidar: no more\n"))
                    self.assertEqual((tree(self.home), sorted(self.home.rglob("*"))), before)

    def test_by_a_signal(self):
        before = sorted(self.home.rglob("*"))
        job = subprocess.Popen([sys.executable, "-m", "avianlidar", "report", str(self.plan), "-o", str(self.home / "new" / "r.html")],
                               stderr=subprocess.PIPE, text=True)
        while job.poll() is None and not (self.home / "new").exists():
            time.sleep(0.005)
        job.send_signal(signal.SIGINT)
        self.assertEqual(job.communicate(timeout=60)[1], "avianlidar: stopped\n")
        self.assertEqual(job.returncode, 130)
        self.assertEqual(sorted(self.home.rglob("*")), before)

    def test_what_was_there_stays(self):
        files, page = self.home / "r_files", self.home / "r.html"
        files.mkdir()
        (files / "notes.txt").write_text("mine")
        page.write_text("old")
        self.assertEqual(self.stop((_report.Report, "_tables"), ("report", self.plan, "-o", page))[0], 130)
        self.assertEqual(((files / "notes.txt").read_text(), page.read_text()), ("mine", "old"))

    def test_what_is_there_to_go_on_with(self):
        out = self.home / "sites"
        code, said = self.stop((_siting, "write_whole"), ("siting", self.plan, "-o", out), 3)
        self.assertEqual((code, said), (130, f"avianlidar: stopped: {out}: candidates kept: 2; the same command goes on\n"))
        self.assertEqual(len(list((out / "coverage").iterdir())), 2)
        self.assertEqual(run("siting", self.plan, "-o", out)[0], 0)
        out = self.home / "sets"
        code, said = self.stop((al.Sequence, "_write_one"), ("sequence", self.scenario, "-o", out), 2)
        self.assertEqual((code, said), (130, f"avianlidar: stopped: {out}: whole sequences: 1; the same command goes on\n"))
        self.assertEqual([path.name for path in (out / "sequences").iterdir()], ["00"])
        two = self.write("two.coverage.json", {**PLAN, "compare_with": [{**SENSOR, "name": "other"}]})
        out = self.home / "maps"
        self.assertEqual(self.stop((_maps, "write_table"), ("coverage", two, "-o", out), 3)[0], 130)
        self.assertEqual([path.name for path in out.iterdir()], ["Search905 changed"])


class Sequences(Applications):
    def test_a_scan_that_is_lost_while_others_are_written(self):
        """Whoever removes it: the sequence does not count as whole."""
        def lose(number, done, _):
            if (number, done) == (1, 2):
                next((self.home / "out" / "sequences").glob(".01*/*/000000.label")).unlink()
        with self.assertRaisesRegex(al.Error, "01.*: 1 of 2 scans are whole"):
            al.Sequence(self.scenario).write(self.home / "out", progress=lose)
        self.assertEqual([path.name for path in (self.home / "out" / "sequences").iterdir()], ["00"])
        al.Sequence(self.scenario).write(self.home / "out")

    def test_scans_that_are_lost_later(self):
        """What is there is counted before it is taken as whole, and before anything is made."""
        out = self.home / "out"
        al.Sequence(self.scenario).write(out)
        shutil.rmtree(out / "sequences" / "01")
        scan = out / "sequences" / "00" / "velodyne" / "000001.bin"
        kept = scan.read_bytes()
        for damage, words in ((lambda: scan.write_bytes(kept[:-16]), "1 of 2 scans are whole"), (scan.unlink, "1 of 2 scans are whole"),
                              (lambda: (out / "sequences" / "00" / "done.json").write_text("{"), "done.json: is no JSON"),
                              (lambda: (out / "sequences" / "00" / "done.json").write_text("[]"), "00 is of another scenario"),
                              (lambda: (out / "sequences" / "00" / "done.json").unlink(), "00: is there without done.json")):
            damage()
            before = tree(out)
            with self.assertRaisesRegex(al.Error, words):
                al.Sequence(self.scenario).write(out)
            self.assertEqual(tree(out), before)
            if words.startswith("1"):
                scan.write_bytes(kept)

    def test_go_on_with_the_same_inputs_only(self):
        out = self.home / "out"
        al.Sequence(self.scenario, threads=1, number_of_scans=2).write(out)
        before = tree(out)
        for words, scene, changes in (
                (r"sensor\.position \[5\.0, -8\.0, 3\.0\], now \[6\.0, -8\.0, 3\.0\]", {"lidar": {"position": [6, -8, 3]}}, {}),
                ("scene", {"objects": [SCENE["objects"][0], {**SCENE["objects"][1], "material": "Metal"}]}, {}),
                (r"scan\.rays_per_beam 100, now 50", {}, {"scan": {"rays_per_beam": 50}}),
                (r"sensor\.sway_amplitude .* now 0\.5", {}, {"sensor": {**SENSOR, "sway_amplitude": 0.5}}),
                (r"scenario\.birds", {}, {"birds": []})):
            with self.subTest(words):
                self.write("s.lidarscene.json", {**SCENE, **scene})
                with self.assertRaisesRegex(al.Error, f"00 is of another scenario, scene or version: .*{words}"):
                    al.Sequence(self.scenario, **{"number_of_scans": 4, **changes}).write(out)
                self.assertEqual(tree(out), before)
        # What decides no bit may differ: threads, more scans, the order of keys, a place in the scene that the scenario overrules.
        self.write("s.lidarscene.json", SCENE)
        self.write("q.scenario.json", {**SCENARIO, "birds": [dict(reversed(SCENARIO["birds"][0].items()))]})
        al.Sequence(self.scenario, threads=2).write(out)
        fixed = self.write("fixed.scenario.json", {**SCENARIO, "sensor": {**SENSOR, "position": [5, -8, 3]}})
        al.Sequence(fixed).write(self.home / "fixed")
        self.write("s.lidarscene.json", {**SCENE, "lidar": {"position": [6, -8, 3]}})
        al.Sequence(fixed).write(self.home / "fixed")


    def test_more_scans_go_on_and_fewer_are_an_error(self):
        """Three scans in sequences of two, then five: the second sequence was short, and flights depend on its length."""
        out, fresh = self.home / "out", self.home / "fresh"
        al.Sequence(self.scenario, number_of_scans=5).write(fresh)
        al.Sequence(self.scenario, number_of_scans=3).write(out)
        kept = (out / "sequences" / "00" / "truth.csv").stat().st_mtime_ns
        status, said = run("sequence", self.scenario, "-o", out, "--scans", 5, "--threads", 1)
        self.assertEqual(status, 0, said)
        self.assertRegex(said, "^avianlidar: warning: .*01: has fewer scans than are wanted now, and is made again")
        self.assertEqual(len(said.splitlines()), 1, said)
        self.assertEqual(tree(out), tree(fresh))
        self.assertEqual((out / "sequences" / "00" / "truth.csv").stat().st_mtime_ns, kept)
        for scans, words in ((4, "02: is there, and number_of_scans is 4"), (1, "01: is there, and number_of_scans is 1")):
            status, said = run("sequence", self.scenario, "-o", out, "--scans", scans)
            self.assertEqual(status, 2)
            self.assertRegex(said, f"^avianlidar: .*{words}: ask for as many scans as there are, or choose another folder\n$")
            self.assertEqual(tree(out), tree(fresh))
        al.Sequence(self.scenario).write(self.home / "even")
        with self.assertRaisesRegex(al.Error, "01: has 2 scans, and number_of_scans is 3"):
            al.Sequence(self.scenario, number_of_scans=3).write(self.home / "even")

    def test_both_spellings_of_a_property_are_one(self):
        """What one of them names is found from the scenario's folder, and decides a bit."""
        tracks = "id,species,time,x,y,z\n1,crow,0,-30,100,20\n1,crow,20,30,100,20\n"
        bird = {"pattern": "File", "FileName": "t.csv"}
        elsewhere = self.home / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "t.csv").write_text("no tracks")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(elsewhere)
        (self.home / "t.csv").write_text(tracks)
        written = []
        for name, changes in (("old", {}), ("new", {"file_name": "t.csv"})):
            birds = [{**bird, **changes}]
            if changes:
                del birds[0]["FileName"]
            file = self.write(f"{name}.scenario.json", {**SCENARIO, "birds": birds, "sensor": {**SENSOR, "RangeGate": 900}})
            al.Sequence(file, number_of_scans=2).write(self.home / name)
            written.append(tree(self.home / name))
        self.assertEqual(*written)
        self.assertIn("crow", (self.home / "old" / "sequences" / "00" / "truth.csv").read_text())
        (self.home / "t.csv").write_text(tracks.replace("100", "101"))
        with self.assertRaisesRegex(al.Error, r"00 is of another scenario.*scenario\.birds"):
            al.Sequence(self.home / "old.scenario.json", number_of_scans=2).write(self.home / "old")
        for changes, words in (({"birds": [{**bird, "file_name": "t.csv"}]}, r"birds\[0\]: file_name is given twice, also as FileName"),
                               ({"birds": [{**bird, "FileName": 5}]}, r"birds\[0\].file_name: 5 is not of type 'string'"),
                               ({"birds": [{**bird, "Seed": 5}]}, r"birds\[0\].seed: is not to be given here"),
                               ({"sensor": {**SENSOR, "AzimuthStep": 1}}, "sensor: azimuth_step is given twice")):
            with self.assertRaisesRegex(al.Error, f"twice.scenario.json: {words}"):
                al.Sequence(self.write("twice.scenario.json", {**SCENARIO, **changes}))
        # An option comes before the scenario, whatever its spelling.
        out = self.home / "told"
        self.assertEqual(run("sequence", self.scenario, "-o", out, "--scans", 2, "--sensor-set", "AzimuthStep=2"), (0, ""))
        self.assertEqual(json.loads((out / "manifest.json").read_text())["scenario"]["sensor"]["azimuth_step"], 2)

    def test_files_that_were_changed_later(self):
        """Whatever its size: what is there is compared with what was written."""
        out = self.home / "out"
        al.Sequence(self.scenario).write(out)
        first = out / "sequences" / "00"
        (first / "predictions").mkdir()  # of others
        (first / "predictions" / "000000.label").write_bytes(b"1234")
        al.Sequence(self.scenario).write(out)
        for name in ("truth.csv", "times.txt", "poses.txt", "calib.txt", "velodyne/000000.bin", "labels/000001.label", "subsets/000000.subset"):
            file = first / name
            kept = file.read_bytes()
            damages = [bytes([kept[0] ^ 1]) + kept[1:]] + ([kept[:-1], None] if "/" not in name else [])
            for content in damages:
                with self.subTest(file=name, size=None if content is None else len(content) - len(kept)):
                    file.unlink()
                    if content is not None:
                        file.write_bytes(content)
                    before = tree(out)
                    with self.assertRaisesRegex(al.Error, "00: its files are not those .* sha256 .*Remove the folder: it is made again"):
                        al.Sequence(self.scenario).write(out)
                    self.assertEqual(tree(out), before)
                    file.write_bytes(kept)
        done = first / "done.json"
        kept = json.loads(done.read_text())
        for name in kept:
            for value in (None, "x", {"x": 1}):
                content = {**kept, name: value}
                if value is None:
                    del content[name]
                done.write_text(json.dumps(content))
                if name == "inputs":  # for people
                    al.Sequence(self.scenario).write(out)
                    continue
                with self.subTest(name=name, value=value):
                    words = "00 is of another" if name == "identity" else "00: its files" if name == "sha256" else rf"00/done.json: {name} is missing or no count"
                    with self.assertRaisesRegex(al.Error, words):
                        al.Sequence(self.scenario).write(out)
        done.write_text(json.dumps(kept))
        shutil.rmtree(first)
        al.Sequence(self.scenario).write(out)


class FullDisk(Applications):
    def test_leaves_good_files(self):
        """The old file, and nothing beside it; the error names the file."""
        names = ("map.tif", "status.tif", "areas.geojson", "table.csv", "picture.png", "report.html")
        for name in (*names, "status.tif.aux.xml"):
            (self.home / name).write_text("good")
        al.Sequence(self.scenario, number_of_scans=2).write(self.home)
        before = tree(self.home)
        job = child(FULL, self.home, "from.tif", *names, "sequences")
        said, errors = job.communicate(timeout=200)
        self.assertEqual(job.returncode, 0, errors)
        said = dict(line.split(" ", 1) for line in said.splitlines())
        for name in names:
            self.assertRegex(said[name], f"error: OSError .*File too large.*{'report_files' if 'report' in name else name}")
        self.assertRegex(said["sequences"], "error: .*000000.*: cannot be written to its end: File too large")
        after = tree(self.home)
        after.pop("from.tif")
        self.assertEqual({name: content for name, content in after.items() if "report_files" not in name}, before)
        self.assertEqual([path.name for path in (self.home / "sequences").iterdir()], ["00"])

    def test_maps_are_read_back(self):
        values = np.random.default_rng(1).uniform(0.0, 1.0, (50, 50)).astype(np.float32)
        file = self.home / "map.tif"
        read = gdal.VSIFReadL
        file.write_text("good")
        for cut in (1, 5000):
            with unittest.mock.patch.object(gdal, "VSIFReadL", lambda *arguments: bytes(read(*arguments))[:-cut]):
                with self.assertRaisesRegex((al.Error, RuntimeError), f"{file}"):
                    _maps.write_geotiff(file, values, (0, 0), (1, 1), ORIGIN, "p")
            self.assertEqual(file.read_text(), "good")
        _maps.write_geotiff(file, values, (0, 0), (1, 1), ORIGIN, "p")
        with unittest.mock.patch.object(gdal, "VSIFReadL", lambda *arguments: bytes(read(*arguments))[:-5]):
            with self.assertRaisesRegex((al.Error, RuntimeError), "areas.geojson"):
                _maps.write_areas(self.home / "areas.geojson", file, "words")
        self.assertFalse((self.home / "areas.geojson").exists())
        np.testing.assert_array_equal(gdal.Open(str(file)).ReadAsArray()[::-1], values)

    def test_old_statistics_do_not_stay(self):
        """GDAL's programs keep them beside a map; those of the map that is replaced are wrong."""
        file, there = self.home / "map.tif", self.home / "map.tif.aux.xml"
        for value in (1.0, 2.0):
            _maps.write_geotiff(file, np.full((4, 4), value, np.float32), (0, 0), (1, 1), None, "p")
            self.assertFalse(there.exists())
            subprocess.run(["gdalinfo", "-stats", str(file)], check=True, capture_output=True)
            self.assertIn(f"STATISTICS_MEAN\">{value:g}", there.read_text())


if __name__ == "__main__":
    unittest.main()
