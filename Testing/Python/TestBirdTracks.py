# SPDX-License-Identifier: BSD-3-Clause
"""The report card of tracks: scores of tracks made by hand, times of points, bad input, small sequences as a whole,
work that goes on."""
import json
import shutil
import unittest

import numpy as np

import TestSequence
import avianlidar as al
from avianlidar import _command
from avianlidar.apps.coverage import _report
from avianlidar.apps.inputs._read import read_plan
from avianlidar.apps.sequences import _card, _following, _sequence
from avianlidar.apps.sequences._following import Input, Live, ORIGINS, TRACK, score
from avianlidar.siting import Runway
from browser import Browser
from exampletools import emptied
from helpertools import rows_of
from reporttools import letters, quick

BIRD, CLUTTER, VEHICLE = (ORIGINS.index(name) for name in ("bird", "surface", "vehicle"))
EAST = {"type": "Feature", "properties": {"kind": "runway", "name": "09/27"},
        "geometry": {"type": "LineString", "coordinates": [[8.0030, 47.0], [8.0130, 47.0]]}}
SCENE = {**TestSequence.SCENE, "origin": {"latitude": 47.0, "longitude": 8.0, "height": 400.0},
         "lidar": {"position": [0, 0, 3]}}
SCENARIO = {"scene": "small.lidarscene.json", "number_of_scans": 50, "scans_per_sequence": 25, "seed": 5,
            "sensor": {"preset": "Search905", "orientation": [30.0, 0.0, 0.0]},
            "scan": {"attenuation_coefficient": 8.9e-5, "rays_per_beam": 50},
            "birds": [{"pattern": "Crossings", "species": "herring gull", "number_of_birds": 12, "radius": 300,
                       "heights": [4, 20]}, {"pattern": "Circles", "species": "crow", "number_of_birds": 4,
                                             "radius": 200, "heights": [5, 15]}],
            "objects": [{"name": "box", "material": "Wall", "class": "car", "boxes": [[-1, 1, -2, 2, 0, 2]],
                         "speed": 5.0, "route": [[-80, 150, 0], [80, 150, 0]]}]}


def scenario_file(where, **changes):
    (where / "runways.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [EAST]}), "utf-8")
    return TestSequence.scenario_file(where, SCENE, **{**SCENARIO, **changes})


def row(bird, time, place, within=True):
    return {"bird": bird, "species": "crow", "in": within, "time": time, "place": place, "range": 100.0,
            "weather": "clear"}


def live(time, *tracks, points=()):
    """Tracks (id, confirmed, place, velocity) at a time; points by their tracks."""
    states = [(track, sure, time, tuple(place), velocity) for track, sure, place, velocity in tracks]
    return Live(np.array(states, TRACK), np.array(points, int), np.zeros(len(points), bool))


class Scores(unittest.TestCase):
    """Scans every 2 s of a bird that flies east at 10 m/s into a strip, and of one that nothing tracks."""

    @classmethod
    def setUpClass(cls):
        scans = []
        for k in range(12):
            time, place = 2.0 * k, (20.0 * k, 3.0, 10.0)
            rows = [row(1, time + 0.5, (20.0 * k + 5.0, 3.0, 10.0), within=k >= 2), row(2, time, (0.0, 500.0, 10.0))]
            tracks = []
            if k >= 3:  # another track from the 7th scan on; it has not met the bird in the 6th
                tracks.append((0 if k < 7 else 5, k >= 5 and k != 6, place, (10.0, 0.0, 0.0)))
            if k >= 4:
                tracks += [(1, True, (300.0, 300.0, 5.0), (0.0, 0.0, 0.0)),
                           (2, k > 8, (-50.0, 60.0, 1.0), (5.0, 0.0, 0.0))]
            scans.append((k, rows, live(time, *tracks, points=[track for track, *_ in tracks]),
                          np.array([{1: CLUTTER, 2: VEHICLE}.get(t, BIRD) for t, *_ in tracks], int)))
        cls.found = score(scans, 10.0, 1.0, [Runway("09/27", (150.0, 0.0), (1000.0, 0.0), 45.0)])
        cls.birds = {bird["bird"]: bird for bird in cls.found["birds"]}
        cls.tracks = {track["track"]: track for track in cls.found["tracks"]}

    def test_birds(self):
        bird = self.birds[1]
        # scans 2 to 11, tracked in 5 and 7 to 11
        self.assertEqual((bird["scans"], bird["tracked"], bird["switches"]), (10, 6, 1))
        self.assertEqual((bird["came_s"], bird["found_s"]), (4.5, 10.5))
        self.assertEqual(bird["strip"], 16.5)  # at x = 165 in scan 8, at 145 in scan 7
        np.testing.assert_allclose(_card.warnings_of(self.found["birds"], "strip"), [6.0])
        self.assertEqual((self.birds[2]["scans"], self.birds[2]["tracked"], self.birds[2]["found_s"]), (12, 0, None))

    def test_from_one_volume_into_the_other(self):
        """Two runways, two ends: birds that begin in a strip or below a glide path are warned of before the other one.
        One that stays counts nowhere."""
        runways = [Runway("a", (0.0, 0.0), (1000.0, 0.0), 45.0), Runway("b", (0.0, 400.0), (1000.0, 400.0), 45.0)]
        scans = []
        # Bird 1 flies north from strip to strip, 20 m a scan. Bird 2 flies east over a runway from one glide path to
        # the other, 100 m a scan. Bird 3 flies back and forth.
        for k in range(20):
            rows = [row(1, 2.0 * k, (500.0, 20.0 * k, 10.0)), row(2, 2.0 * k, (100.0 * k - 450.0, 0.0, 40.0)),
                    row(3, 2.0 * k, (500.0, 160.0 * (k % 2), 10.0))]
            tracks = [(0, k >= 5, rows[0]["place"], (0.0, 10.0, 0.0))]
            scans.append((k, rows, live(2.0 * k, *tracks, points=[0]), np.array([BIRD])))
        birds = score(scans, 10.0, 1.0, runways)["birds"]
        self.assertEqual([(bird["strip"], bird["glide path"]) for bird in birds],
                         [(26.0, None), (10.0, 30.0), (None, None)])
        np.testing.assert_allclose(_card.warnings_of(birds, "strip"), [16.0, 0.0])
        np.testing.assert_allclose(_card.warnings_of(birds, "glide path"), [0.0])

    def test_tracks(self):
        self.assertEqual({number: track["origin"] for number, track in self.tracks.items()},
                         {0: "bird", 1: "surface", 2: "vehicle", 5: "bird"})
        self.assertEqual((self.tracks[1]["scans"], self.tracks[1]["assigned"], self.tracks[1]["begin"]),
                         (8, 0, [300.0, 300.0, 5.0]))
        self.assertEqual(self.tracks[0]["confirmed_s"], 10.0)
        self.assertEqual({state[9] for state in self.found["states"] if state[1] in (0, 5)}, {1})

    def test_ospa(self):
        """Order 1, cut-off 10 m. Predicted to the beam's time the track is where the bird is."""
        distances = [distance for distance, _, _ in self.found["ospa"]]
        self.assertEqual(distances[:2], [10.0, 10.0])  # a bird in the volume, no track
        self.assertEqual(distances[4], 10.0)  # two birds, one false track
        self.assertEqual(distances[5], 5.0)   # one of two birds at its place, the false track is 10 m off
        self.assertEqual(distances[11], 5.0)  # the vehicle's track is not asked for

    def test_card(self):
        of = _card.of_birds(self.found["birds"])
        self.assertEqual((of["birds tracked"][1].value, of["birds tracked"][1].number), (0.5, 2))
        self.assertAlmostEqual(of["share of time"][1].value, 6 / 22)
        self.assertEqual((of["delay"][1].value, of["identity switches"][1].value), (6.0, 1.0))
        tracks = _card.of_tracks([{**self.found, "seconds": 24.0}])
        self.assertAlmostEqual(tracks["false tracks an hour"][1].value, 150.0)
        self.assertAlmostEqual(tracks["tracks of vehicles an hour"][1].value, 150.0)
        self.assertAlmostEqual(tracks["OSPA distance"][1].value,
                               np.mean([distance for distance, _, _ in self.found["ospa"]]))

    def test_a_second_track_of_a_bird(self):
        scans = [(k, [row(1, 2.0 * k, (0.0, 0.0, 10.0))], live(
                      2.0 * k, (0, True, (0.0, 0.0, 10.0), (0, 0, 0)), (1, True, (4.0, 0.0, 10.0), (0, 0, 0)),
                      points=[0, 1, 1]), np.array([BIRD, BIRD, CLUTTER])) for k in range(3)]
        found = score(scans, 10.0, 2.0, [])
        self.assertEqual([track["origin"] for track in found["tracks"]], ["bird", "second track of a bird"])

    def test_flocks(self):
        """One track for two birds: one is tracked, both are beside it."""
        scans = [(k, [row(1, 2.0 * k, (0.0, 0.0, 10.0)), row(2, 2.0 * k, (2.0, 0.0, 10.0))],
                  live(2.0 * k, (0, True, (0.5, 0.0, 10.0), (0, 0, 0)), points=[0]), np.array([BIRD]))
                 for k in range(3)]
        birds = score(scans, 10.0, 2.0, [])["birds"]
        self.assertEqual([(bird["tracked"], bird["near"]) for bird in birds], [(3, 3), (0, 3)])
        self.assertEqual([value.value for _, value in list(_card.of_birds(birds).values())[:2]], [0.5, 1.0])

    def test_origins_of_labels(self):
        labels = np.array([99 | 10001 << 16, 252 | 1001 << 16, 1, 0, 50 | 3 << 16, 0 | 4 << 16], np.uint32)
        self.assertEqual([ORIGINS[k] for k in _following.origin_of(labels)],
                         ["bird", "vehicle", "air", "false alarm", "surface", "surface"])

    def test_bands_and_warnings_at_their_borders(self):
        self.assertEqual([_card.band_of(h) for h in (-1, 9.9, 10, 59, 60)],
                         ["below 10 m", "below 10 m", "10 to 30 m", "30 to 60 m", "above 60 m"])
        self.assertEqual([score.value for _, score in _card.of_warnings(np.array([0.0, 10, 29, 60])).values()],
                         [24.75, 0.75, 0.75, 0.25, 0.25])


class Files(unittest.TestCase):
    SCANS = 10

    @classmethod
    def setUpClass(cls):
        cls.home = emptied("bird-tracks", "files")
        cls.file = scenario_file(cls.home, number_of_scans=2 * cls.SCANS, scans_per_sequence=cls.SCANS)
        cls.made = cls.home / "made"
        al.Sequence(cls.file, threads=1).write(cls.made)
        cls.out = cls.home / "out"
        with letters() as cls.letters:
            cls.card = cls.tracks().write(cls.out)

    @classmethod
    def tracks(cls, *inputs, **settings):
        return al.BirdTracks(inputs or [cls.made],
                             **{"runways": cls.home / "runways.geojson", "learning_scans": 3, **settings})

    def test_times_of_points(self):
        """A point's time is that of the beam that it lies on: those of birds lie between the truth's first and last
        time."""
        of, checked = Input(self.made, "made"), 0
        truth = {(int(r["scan"]), int(r["bird"])): r for r in rows_of(self.made / "sequences/01/truth.csv") if r["x_m"]}
        for scan, start, points, placed, times, labels in of.scans("01"):
            self.assertTrue(((times >= 1e6 * start) & (times < 1e6 * (start + 2.0))).all())
            np.testing.assert_allclose(np.linalg.norm(points, axis=1),
                                       np.linalg.norm(placed - of.sensor.position, axis=1), atol=1e-3)
            for time, place, label in zip(times, placed, labels):
                if label >> 16 > 10000:
                    r = truth[scan, (label >> 16) - 1]
                    if float(r["last_time_s"]) - float(r["first_time_s"]) > 1.0:
                        continue  # met twice, at both ends of the revolution
                    self.assertLessEqual(float(r["first_time_s"]) - 1e-5, 1e-6 * time)
                    self.assertGreaterEqual(float(r["last_time_s"]) + 1e-5, 1e-6 * time)
                    self.assertLess(np.hypot(place[0] - float(r["x_m"]), place[1] - float(r["y_m"])), 10.0)
                    checked += 1
        self.assertGreater(checked, 20)

    def test_birds_are_tracked(self):
        scores = {r["score"]: r for r in rows_of(self.out / "card.csv") if r["by"] == "all"}
        self.assertGreater(float(scores["birds tracked"]["value"]), 0.4)
        self.assertGreater(float(scores["birds tracked"]["std_error"]), 0.0)
        self.assertLess(float(scores["OSPA distance"]["value"]), 20.0)
        birds = rows_of(self.out / "birds.csv")
        self.assertEqual(int(scores["birds tracked"]["count"]), len(birds))
        self.assertEqual(float(scores["birds tracked"]["value"]), sum(bool(b["found_s"]) for b in birds) / len(birds))
        # Positions of tracks lie at birds, to the errors of a beam.
        truth = {(int(r["scan"]), int(r["bird"])): r for k in "01"
                 for r in rows_of(self.made / f"sequences/0{k}/truth.csv") if r["x_m"]}
        states = [s for s in rows_of(self.out / "tracks.csv") if s["bird"] != "-1"]
        off = [np.hypot(*(float(s[n]) - float(truth[int(s["scan"]), int(s["bird"])][n]) for n in ("x_m", "y_m")))
               for s in states]
        self.assertGreater(len(off), 20)
        self.assertLess(np.median(off), 2.0)
        groups = [r for r in rows_of(self.out / "card.csv") if r["by"] == "species" and r["score"] == "birds tracked"]
        self.assertEqual(sum(int(r["count"]) for r in groups), len(birds))

    def test_page(self):
        page = (self.out / "card.html").read_text("utf-8").replace("\u00a0", " ")
        self.assertEqual(page.count("data:image/png"), 4)
        self.assertNotIn("http", page)
        with Browser() as browser:
            browser.open(self.out / "card.html")
            browser.check_printed(self)
        self.assertGreaterEqual(min(self.letters), 8.0)
        for text in (cell for line in self.card["overall"] for cell in line["cells"]):
            self.assertIn(text.replace("\u00a0", " "), page)

    def test_goes_on(self):
        """What is there of the same stays; other settings or damage make it again; the same bits."""
        file = self.out / "followed/made/01.json"
        before, content = file.stat().st_mtime_ns, file.read_bytes()
        self.assertEqual(self.tracks().write(self.out), self.card)
        self.assertEqual(file.stat().st_mtime_ns, before)
        for damaged in ({}, {**json.loads(content), "birds": 5}):
            file.write_text(json.dumps(damaged), "utf-8")
            self.tracks().write(self.out)
            self.assertEqual(file.read_bytes(), content)
        other = self.home / "other"
        shutil.copytree(self.out, other)
        self.tracks(cutoff=5.0).write(other)
        self.assertNotEqual((other / "followed/made/01.json").read_bytes(), content)

    def test_command_makes_and_compares_scenarios(self):
        out = self.home / "compared"
        code = _command.main(["track", str(self.file), "-o", str(out), "--sensor", "Search905", "--sensor",
                              "Search1550", "--scans", "2", "--learn", "1", "--weather", "fog:2000", "--tracker-set",
                              "confirm_hits=2"])
        self.assertIn(code, (None, 0))
        self.assertTrue((out / "sequences/small-Search1550/manifest.json").is_file())
        weathers = {(r["input"], r["group"]) for r in rows_of(out / "card.csv") if r["by"] == "weather"}
        self.assertEqual(weathers, {(f"small-{name}", "visibility 2000 m") for name in ("Search905", "Search1550")})
        self.assertNotIn(">Warning<", (out / "card.html").read_text("utf-8"))  # without runways

    def test_section_of_the_report(self):
        plan = self.home / "p.coverage.json"
        plan.write_text(json.dumps({"scene": "small.lidarscene.json",
                                    "sensor": {"preset": "Search905", "azimuth_step": 6}, "heights": [20],
                                    "extent": [-200, 200, -200, 200], "spacing": 200, "places": 10, "tracks": "out",
                                    "coverage": {"species": "", "effective_area": 0.03, "clutter": False}}), "utf-8")
        with quick():  # what the report says else has its own test
            _report.Report(read_plan(plan), 1).write(self.home / "report.html")
        page = (self.home / "report.html").read_text("utf-8")
        self.assertIn('id="tracks"', page)
        self.assertIn(self.card["overall"][0]["cells"][0], page)
        plan.write_text(json.dumps({"scene": "small.lidarscene.json", "sensor": {"preset": "Search905"},
                                    "tracks": "made"}), "utf-8")
        with self.assertRaisesRegex(al.Error, "tracks: .*holds no card.json"):
            _report.Report(read_plan(plan))

    def broken(self, name):
        where = self.home / name
        shutil.rmtree(where, ignore_errors=True)
        shutil.copytree(self.made, where)
        return where

    def test_bad_input(self):
        empty, cut, changed = emptied("bird-tracks", "files/empty"), self.broken("cut"), self.broken("changed")
        other = self.broken("sensor")
        (cut / "sequences/01/truth.csv").unlink()
        (changed / "sequences/00/truth.csv").write_text("scan,bird\n", "utf-8")
        manifest = json.loads((other / "manifest.json").read_text())
        manifest["scenario"]["sensor"]["preset"] = "Search1550"
        (other / "manifest.json").write_text(json.dumps(manifest), "utf-8")
        spoilt = []
        for name, change, words in (
                ("velodyne/000000.bin", -16, "label: has .* bytes"), ("labels/000000.label", -3, "label: has"),
                ("subsets/000000.subset", 1, "subset: has"),
                ("velodyne/000099.bin", 16, "velodyne: expected the files"), ("times.txt", -10, "times.txt: expected"),
                ("poses.txt", -40, "poses.txt: expected"),
                ("truth.csv", lambda text: text.replace(b"seen", b"lost"), "truth.csv: line .*: status is 'lost'"),
                ("truth.csv", lambda text: text.replace(b"10001", b"10000"), "bird 10000 is in scan 0 twice"),
                ("truth.csv", lambda text: text + b"\xff", "truth.csv: is not text in UTF-8")):
            folder = self.broken(f"spoilt{len(spoilt)}")
            file, done = folder / "sequences/00" / name, folder / "sequences/00/done.json"
            content = file.read_bytes() if file.exists() else b""
            file.write_bytes(change(content) if callable(change) else content[:change] if change < 0 else content
                             + bytes(change))
            done.write_text(json.dumps({**json.loads(done.read_text()), "sha256": _sequence._digest(done.parent)}),
                            "utf-8")
            spoilt.append((folder, words))
        (self.home / "none.geojson").write_text('{"features": []}', "utf-8")
        for inputs, settings, words in (
                *(((folder,), {}, words) for folder, words in spoilt), ((empty,), {}, "no manifest.json"),
                ((cut,), {}, "truth.csv: is missing"), ((changed,), {}, "its files differ from the sha256"),
                ((other,), {}, "another sensor"), ((self.made, self.made), {}, "twice"),
                ((self.made,), {"learning_scans": self.SCANS}, "more than the"),
                ((self.made,), {"runways": self.home / "none.geojson"}, "holds no runway"),
                ((self.made,), {"tracker": {"hits": 3}}, "hits"), ((self.made,), {"cutoff": 0.0}, "cutoff is 0"),
                ((self.made,), {"weather": ["fog:100"]}, "weather")):
            with self.subTest(words), self.assertRaisesRegex((al.Error, ValueError, TypeError), words):
                self.tracks(*inputs, **settings).write(self.home / "bad")
            self.assertFalse((self.home / "bad").exists())
        with self.assertRaisesRegex(ValueError, "no sequences"):
            al.BirdTracks([])
