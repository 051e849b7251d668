# SPDX-License-Identifier: BSD-3-Clause
"""Files and folders of the applications (sequence, coverage, siting, report): names that become file names, what is
read, one run in a folder, files that are whole or as they were, and folders that go on with the same inputs only."""
import errno
import gzip
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest
import unittest.mock

import numpy as np

import avianlidar as al
from avianlidar._disk import only_run
from avianlidar.apps.coverage import _maps, _report
from avianlidar.apps.inputs import _read as _inputs
from osgeo import gdal
import helpertools
import scenetools as st
from exampletools import emptied
from faulttools import disk
from filetools import Table
from reporttools import quick

ORIGIN = (0.0, 0.0, 0.0)
SCENE = {"version": 1, "origin": {"latitude": 0, "longitude": 0, "height": 0}, "lidar": {"position": [5, -8, 3]},
         "objects": [
    {"name": "Ground", "class": "ground", "ground": {"size": 4000, "height": 0}, "material": "Wall"},
    {"name": "Board", "file": "board.obj", "material": "Wall"}]}
BOARD = "v 20 90 0\nv 60 80 0\nv 60 80 9\nv 20 90 9\nf 1 2 3 4\n"
RUNWAY = "LineString", [[0.001, 0.002], [0.006, 0.002]], {"kind": "runway", "name": "09/27", "width": 45}
SENSOR = {"preset": "Search905", "azimuth_range": [0, 90], "azimuth_step": 3}
PLAN = {"scene": "s.lidarscene.json", "sensor": SENSOR, "runways": "runways.geojson", "coverage": {"species": "crow"},
        "heights": [30],
        "extent": [-200, 200, -200, 200], "spacing": 50, "places": 100,
        "siting": {"bounds": [-200, 200, -200, 200], "spacing": 200, "draws": 0, "sensors": 1}}
SCENARIO = {"scene": "s.lidarscene.json", "sensor": SENSOR, "number_of_scans": 4, "scans_per_sequence": 2, "seed": 5,
            "birds": [{"pattern": "Crossings", "number_of_birds": 3, "radius": 300, "heights": [5, 40]}]}

# Has a folder for itself until it is killed.
HOLDER = """
import sys, time
from avianlidar._disk import only_run
with only_run(sys.argv[1]):
    print("has it", flush=True)
    time.sleep(600)
"""


def run(*arguments):
    """The command, here. @return its status, what it says to the error stream"""
    return helpertools.run(*arguments)[::2]


def tree(folder):
    """{name: content} of all files below."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


class Applications(unittest.TestCase):
    def setUp(self):
        self.enterContext(quick())
        self.home = emptied("applications", self.id().rpartition(".")[2])
        (self.home / "board.obj").write_text(BOARD)
        self.write("s.lidarscene.json", SCENE)
        (self.home / "runways.geojson").write_text(st.features(RUNWAY))
        self.plan, self.scenario = self.write("p.coverage.json", PLAN), self.write("q.scenario.json", SCENARIO)

    def write(self, name, document):
        (self.home / name).write_text(json.dumps(document), encoding="utf-8")
        return self.home / name


class Inputs(Applications, Table):
    def test_names_are_checked_before_anything_is_written(self):
        (self.home / ".lidarsensor.json").write_text("{}")  # a name that the plan does not say is that of the file
        bad = ("..", "", "a/b", "a\0b", "a\nb", ".hidden", "\ud800", "x" * 300)
        cases = [("coverage", {"sensor": {**SENSOR, "name": name}}, "sensor.name") for name in bad]
        cases += [("coverage", {"sensor": {"preset": ".lidarsensor.json"}}, "sensor.name"),
                  ("coverage", {"compare_with": [{**SENSOR, "name": "a/b"}]}, "compare_with[0]")]
        for verb, change, words in cases:
            with self.subTest(verb=verb, change=change):
                plan = self.write("bad.coverage.json", {**PLAN, **change})
                before = tree(self.home)
                status, said = run(verb, plan, "-o", self.home / "in" / ("report.html" if verb == "report" else "out"))
                self.assertEqual((status, len(said.splitlines())), (2, 1), said)
                self.assertIn("bad.coverage.json", said)
                self.assertIn(words, said)
                self.assertEqual(tree(self.home), before)
        for name in ("Search905 at 5 m", "日本", "a.b", "x" * 100, "~a\\b"):
            _inputs.read_plan(self.write("good.coverage.json", {**PLAN, "sensor": {**SENSOR, "name": name}}))
            self.assertEqual(_inputs.sensor_name({**SENSOR, "name": name}), name)

    def commands(self, kind):
        """Commands that read a pipe or a device: plans, scenarios and what these name."""
        file, out = str(self.home / kind), ["-o", str(self.home / "out")]
        bird, species = SCENARIO["birds"][0], {"species_file_name": file, "species": "crow"}
        yield ["coverage", file, *out]
        yield ["sequence", file, *out]
        plans = [("coverage", {"runways": file}), ("coverage", {"coverage": species}),
                 ("siting", {"siting": {**PLAN["siting"], "points": file}}),
                 ("siting", {"siting": {**PLAN["siting"], "exclusions": [file]}})]
        scenarios = [{"birds": [{**bird, "pattern": "File", "file_name": file}]},
                     {"birds": [{**bird, "species_file_name": file}]}]
        if kind == "pipe":  # their names say what they are; a link's is followed
            for name in ("pipe.lidarscene.json", "pipe.lidarsensor.json"):
                os.mkfifo(self.home / name)
            changes = [{"scene": "pipe.lidarscene.json"}, {"sensor": {"preset": "pipe.lidarsensor.json"}}]
            plans += [("coverage", change) for change in changes]
            scenarios += changes
        for i, (verb, change) in enumerate(plans):
            yield [verb, str(self.write(f"{kind}{i}.coverage.json", {**PLAN, **change})), *out]
        for i, change in enumerate(scenarios):
            yield ["sequence", str(self.write(f"{kind}{i}.scenario.json", {**SCENARIO, **change})), *out]

    def test_are_regular_files(self):
        """Neither pipes nor devices nor folders; gzip has a limit, also where parts that follow each other are one text
        of 2 GiB."""
        os.mkfifo(self.home / "pipe")
        os.symlink("/dev/zero", self.home / "device")
        (self.home / "bomb.coverage.json").write_bytes(gzip.compress(b" " * (1 << 26)) * 32)
        (self.home / "good.coverage.json").write_bytes(gzip.compress(self.plan.read_bytes()))
        expected = [(command, f"{kind}.*it is not a regular file but a pipe or a device")
                    for kind in ("pipe", "device") for command in self.commands(kind)]
        expected += [([verb, str(self.home), "-o", str(self.home / "out.html")], "it is a folder")
                     for verb in ("coverage", "siting", "report", "sequence")]
        expected.append((["coverage", str(self.home / "bomb.coverage.json"), "-o", str(self.home / "out")],
                         "bomb.coverage.json: holds more than 64 MiB"))
        self.assert_said(expected)
        plans = [_inputs.read_plan(file) for file in (self.home / "good.coverage.json", self.plan)]
        for plan in plans:
            plan.pop("file")
        self.assertEqual(*plans)


class OneRun(Applications):
    """A run has its folder alone. One that is stopped, by Ctrl-C or by an error, leaves nothing that was not there
    before, unless the same command goes on with it."""

    def stop(self, where, arguments, times=1, error=KeyboardInterrupt, meanwhile=lambda: None):
        """@param where what is stopped in its call of this number"""
        owner, name = where
        method, calls = getattr(owner, name), []

        def stopped(*given, **named):
            calls.append(name)
            if len(calls) == times:
                meanwhile()
                raise error
            return method(*given, **named)

        with unittest.mock.patch.object(owner, name, stopped):
            return run(*arguments)

    def test_has_a_folder_alone_and_leaves_nothing_behind(self):
        before = tree(self.home), sorted(self.home.rglob("*"))
        for verb, file, out, folder, where, times in (
                ("report", self.plan, "in/here/r.html", "in/here/r_files", (_report.Report, "_facts"), 1),
                ("coverage", self.plan, "in/maps", "in/maps", (_maps, "write_table"), 1),
                ("siting", self.plan, "in/sites", "in/sites", (al.Coverage, "set"), 5),
                ("sequence", self.scenario, "in/sets", "in/sets", (al.Sequence, "_truth"), 1)):
            for error, status in ((KeyboardInterrupt, 130), (al.Error("no more"), 2)):
                with self.subTest(verb=verb, error=error):
                    arguments, second = (verb, file, "-o", self.home / out,
                                         *([] if verb == "siting" else ["--threads", "1"])), []
                    code, said = self.stop(where, arguments, times, error, lambda: second.append(run(*arguments)))
                    self.assertEqual((code, said),
                                     (status, "avianlidar: stopped\n" if status == 130 else "avianlidar: no more\n"))
                    self.assertEqual((second[0][0], len(second[0][1].splitlines())), (2, 1))
                    self.assertIn(f"{self.home / folder}: another run writes there", second[0][1])
                    self.assertEqual((tree(self.home), sorted(self.home.rglob("*"))), before)

    def test_that_was_killed_has_none(self):
        out = self.home / "sets"
        job = subprocess.Popen([sys.executable, "-c", HOLDER, str(out)], text=True, stdout=subprocess.PIPE)
        self.assertEqual(job.stdout.readline(), "has it\n")
        try:
            with self.assertRaisesRegex(al.Error, f"{out}: another run writes there"):
                al.Sequence(self.scenario).write(out)
        finally:
            job.send_signal(signal.SIGKILL)
            job.communicate()
        al.Sequence(self.scenario).write(out)
        self.assertEqual(sorted(path.name for path in out.iterdir()),
                         ["datasheet.md", "manifest.json", "semantic-kitti.yaml", "sequences"])

    def test_where_files_have_no_locks(self):
        """As of some network file systems: a file that is made counts as the lock, and who was killed leaves it."""
        out = self.home / "maps"
        lock = out / ".avianlidar.lock"
        out.mkdir()
        with unittest.mock.patch("fcntl.flock", side_effect=OSError(errno.ENOLCK, "No locks available")):
            with only_run(out):
                self.assertTrue(lock.exists())
                with self.assertRaisesRegex(al.Error, f"{out}: another run writes there; .*have no locks: if no other "
                                                      f"run is there, remove {lock}"):
                    with only_run(out):
                        pass
            self.assertFalse(lock.exists())
            lock.touch()
            self.assertEqual(run("coverage", self.plan, "-o", out)[0], 2)
        with only_run(out):  # where there are locks a killed run's is free
            pass

    def test_a_signal(self):
        before = sorted(self.home.rglob("*"))
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            job = subprocess.Popen([sys.executable, "-m", "avianlidar", "report", str(self.plan), "-o",
                                    str(self.home / "new" / "r.html")],
                                   stderr=subprocess.PIPE, text=True)
            while job.poll() is None and not (self.home / "new").exists():
                time.sleep(0.005)
            job.send_signal(number)
            self.assertEqual(job.communicate(timeout=60)[1], "avianlidar: stopped\n")
            self.assertEqual(job.returncode, status)
            self.assertEqual(sorted(self.home.rglob("*")), before)

    def test_what_was_there_stays(self):
        files, page = self.home / "r_files", self.home / "r.html"
        files.mkdir()
        (files / "notes.txt").write_text("mine")
        page.write_text("old")
        self.assertEqual(self.stop((_report.Report, "_facts"), ("report", self.plan, "-o", page))[0], 130)
        self.assertEqual(((files / "notes.txt").read_text(), page.read_text()), ("mine", "old"))


class Sequences(Applications):
    def test_a_full_disk(self):
        """The error names the folder, in which all is as it was."""
        al.Sequence(self.scenario, number_of_scans=2).write(self.home)
        before = tree(self.home)
        with disk(200), self.assertRaisesRegex((OSError, RuntimeError, al.Error),
                                               "File too large.*000000|000000.*File too large"):
            al.Sequence(self.scenario).write(self.home)
        self.assertEqual(tree(self.home), before)

    def refused(self, out, words, **changes):
        """Nothing is changed."""
        before = tree(out)
        with self.assertRaisesRegex(al.Error, words):
            al.Sequence(self.scenario, **changes).write(out)
        self.assertEqual(tree(out), before)

    def test_files_that_were_lost_or_changed_later(self):
        """What is there is counted, and compared with what was written, whatever its size, before anything is made."""
        out = self.home / "out"
        al.Sequence(self.scenario).write(out)
        first = out / "sequences" / "00"
        (first / "predictions").mkdir()  # of others
        (first / "predictions" / "000000.label").write_bytes(b"1234")
        al.Sequence(self.scenario).write(out)
        shutil.rmtree(out / "sequences" / "01")
        for name, damage, words in (("truth.csv", "gone", "its files differ from the sha256"),
                                    ("labels/000001.label", "changed", "its files differ from the sha256"),
                                    ("velodyne/000000.bin", "changed", "its files differ from the sha256"),
                                    ("velodyne/000000.bin", "short", "its files differ from the sha256")):
            with self.subTest(name, damage=damage):
                file = first / name
                kept = file.read_bytes()
                file.unlink()
                if damage != "gone":
                    file.write_bytes(kept[:-16] if damage == "short" else bytes([kept[0] ^ 1]) + kept[1:])
                self.refused(out, words)
                file.write_bytes(kept)
        done = first / "done.json"
        kept = json.loads(done.read_text())
        for text, words in (("{", "done.json: is not JSON"), ("[]", "00 was made from another scenario"),
                            (None, "00: has no done.json")):
            done.unlink()
            if text:
                done.write_text(text)
            self.refused(out, words)
            done.write_text(json.dumps(kept))
        for name in ("scans", "scans_with_birds_seen"):
            for count in (-5, 3):
                if (name, count) != ("scans_with_birds_seen", 3):
                    done.write_text(json.dumps({**kept, name: count}))
                    self.refused(out, "expected the files of 3 scans|is not a count")
        done.write_text(json.dumps(kept)[:-1] + ', "scans": 2}')
        self.refused(out, "done.json: is not JSON .the key 'scans' is there twice")
        for name in set(kept) - {"inputs"}:  # for people
            done.write_text(json.dumps({**kept, name: "x"}))
            with self.subTest(name=name):
                self.refused(out, "00 was made from another|00: its files|is missing or is not a count")
        shutil.rmtree(first)
        al.Sequence(self.scenario).write(out)

    def test_go_on_with_the_same_inputs_only(self):
        out = self.home / "out"
        al.Sequence(self.scenario, threads=1, number_of_scans=2).write(out)
        for words, scene, changes in (
                (r"sensor\.position \[5\.0, -8\.0, 3\.0\], now \[6\.0, -8\.0, 3\.0\]",
                 {"lidar": {"position": [6, -8, 3]}}, {}),
                ("scene", {"objects": [SCENE["objects"][0], {**SCENE["objects"][1], "material": "Metal"}]}, {}),
                (r"scan\.rays_per_beam 100, now 50", {}, {"scan": {"rays_per_beam": 50}}),
                (r"sensor\.sway_amplitude .* now 0\.5", {}, {"sensor": {**SENSOR, "sway_amplitude": 0.5}}),
                (r"scenario\.birds", {}, {"birds": []})):
            with self.subTest(words):
                self.write("s.lidarscene.json", {**SCENE, **scene})
                self.refused(out, f"00 was made from another scenario, scene or version: .*{words}",
                             **{"number_of_scans": 4, **changes})
        # What decides no bit may differ: threads, more scans, the order of keys, a place in the scene that the scenario
        # overrules.
        self.write("s.lidarscene.json", SCENE)
        self.write("q.scenario.json", {**SCENARIO, "birds": [dict(reversed(SCENARIO["birds"][0].items()))]})
        al.Sequence(self.scenario, threads=2).write(out)
        fixed = self.write("fixed.scenario.json",
                           {**SCENARIO, "number_of_scans": 2, "sensor": {**SENSOR, "position": [5, -8, 3]}})
        al.Sequence(fixed).write(self.home / "fixed")
        self.write("s.lidarscene.json", {**SCENE, "lidar": {"position": [6, -8, 3]}})
        al.Sequence(fixed).write(self.home / "fixed")

    def test_more_scans_go_on_and_fewer_are_an_error(self):
        """Three scans in sequences of two, then four: the second sequence was short, and flights depend on its
        length."""
        out, fresh = self.home / "out", self.home / "fresh"
        al.Sequence(self.scenario).write(fresh)
        al.Sequence(self.scenario, number_of_scans=3).write(out)
        kept = (out / "sequences" / "00" / "truth.csv").stat().st_mtime_ns
        status, said = run("sequence", self.scenario, "-o", out, "--scans", 4, "--threads", 1)
        self.assertEqual((status, len(said.splitlines())), (0, 1), said)
        self.assertRegex(said, "^avianlidar: warning: .*01: has fewer scans than requested, and is made again")
        (out / "view.html").unlink()  # which only the command writes
        self.assertEqual(tree(out), tree(fresh))
        self.assertEqual((out / "sequences" / "00" / "truth.csv").stat().st_mtime_ns, kept)
        for scans, words in ((3, "01: has 2 scans, but number_of_scans is 3"),
                             (2, "01: exists, but number_of_scans is 2")):
            status, said = run("sequence", self.scenario, "-o", out, "--scans", scans)
            self.assertEqual(status, 2)
            self.assertRegex(said, f"^avianlidar: .*{words}: choose at least as many scans as the folder has, or "
                                   "another folder\n$")
            self.assertEqual(tree(out), tree(fresh))

    def test_both_spellings_of_a_property_are_one(self):
        """What one of them names is found from the scenario's folder, and decides a bit."""
        tracks = "id,species,time,x,y,z\n1,crow,0,-30,100,20\n1,crow,20,30,100,20\n"
        elsewhere = self.home / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "t.csv").write_text("no tracks")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(elsewhere)
        (self.home / "t.csv").write_text(tracks)
        written = []
        for name, key in (("old", "FileName"), ("new", "file_name")):
            file = self.write(f"{name}.scenario.json",
                              {**SCENARIO, "number_of_scans": 2, "birds": [{"pattern": "File", key: "t.csv"}],
                               "sensor": {**SENSOR, "RangeGate": 900}})
            al.Sequence(file).write(self.home / name)
            written.append(tree(self.home / name))
        self.assertEqual(*written)
        self.assertIn("crow", (self.home / "old" / "sequences" / "00" / "truth.csv").read_text())
        (self.home / "t.csv").write_text(tracks.replace("100", "101"))
        with self.assertRaisesRegex(al.Error, r"00 was made from another scenario.*scenario\.birds"):
            al.Sequence(self.home / "old.scenario.json").write(self.home / "old")
        bird = {"pattern": "File", "FileName": "t.csv"}
        for changes, words in (({"birds": [{**bird, "file_name": "t.csv"}]}, r"birds\[0\]: file_name is given twice"),
                               ({"sensor": {**SENSOR, "AzimuthStep": 1}}, "sensor: azimuth_step is given twice")):
            with self.assertRaisesRegex(al.Error, f"twice.scenario.json: {words}"):
                al.Sequence(self.write("twice.scenario.json", {**SCENARIO, **changes}))
        # An option comes before the scenario, whatever its spelling.
        out = self.home / "told"
        self.assertEqual(run("sequence", self.scenario, "-o", out, "--scans", 2, "--sensor-set", "AzimuthStep=2"),
                         (0, ""))
        self.assertEqual(json.loads((out / "manifest.json").read_text())["scenario"]["sensor"]["azimuth_step"], 2)


class Maps(Applications):
    def test_maps_are_read_back(self):
        values = np.random.default_rng(1).uniform(0.0, 1.0, (50, 50)).astype(np.float32)
        file = self.home / "map.tif"
        read = gdal.VSIFReadL
        file.write_text("good")
        with unittest.mock.patch.object(gdal, "VSIFReadL", lambda *arguments: bytes(read(*arguments))[:-1]):
            with self.assertRaisesRegex((al.Error, RuntimeError), f"{file}"):
                _maps.write_geotiff(file, values, (0, 0), (1, 1), ORIGIN, "p")
        self.assertEqual(file.read_text(), "good")
        _maps.write_geotiff(file, values, (0, 0), (1, 1), ORIGIN, "p")
        np.testing.assert_array_equal(gdal.Open(str(file)).ReadAsArray()[::-1], values)

    def test_old_statistics_do_not_stay(self):
        """GDAL's programs keep them beside a map; those of the map that is replaced are wrong."""
        file, there = self.home / "map.tif", self.home / "map.tif.aux.xml"
        for value in (1.0, 2.0):
            _maps.write_geotiff(file, np.full((4, 4), value, np.float32), (0, 0), (1, 1), None, "p")
            self.assertFalse(there.exists())
            subprocess.run(["gdalinfo", "-stats", str(file)], check=True, capture_output=True)
            self.assertIn(f"STATISTICS_MEAN\">{value:g}", there.read_text())
