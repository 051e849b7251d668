# SPDX-License-Identifier: BSD-3-Clause
"""Tracks in recordings whose moving things are known, and what the command says about recordings."""
import csv
import json
import math
import os
import pathlib

import numpy as np

import avianlidar as al
from avianlidar._cloud import add_array
from avianlidar.apps.sequences._recorded import RecordedTracks
from echotools import InFolder
from helpertools import run

SPEED, CLIMB = np.array([9.0, -4.0]), 0.5  # m/s
START = np.array([-40.0, 60.0, 12.0])
RATE = 5.0  # Hz
SCENARIO = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "sequence" / "hongqiao.scenario.json"
RADIUS = 6371000.0


def ring_of(points, step=0.4):
    """Lasers of points, by elevation."""
    return np.round(np.degrees(np.arctan2(points[:, 2], np.hypot(*points[:, :2].T))) / step).astype(np.int32)


def scan(number, place=(0.0, 0.0, 0.0)):
    """A wall, and four points of a bird that flies along a line, around a sensor."""
    azimuth, elevation = np.radians(np.mgrid[-30:30:0.4, 0:8:0.4].reshape(2, -1))
    wall = np.stack([100 * np.tan(azimuth), np.full(azimuth.size, 100.0),
                     100 / np.cos(azimuth) * np.tan(elevation)], axis=1)
    time = number / RATE
    middle = START + [*(SPEED * time), CLIMB * time]
    bird = middle + 0.15 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    points = np.vstack([wall, bird]) + place
    cloud = al.Cloud(type("points", (), {"points": points})())
    add_array(cloud.data.GetPointData(), "laser_id", ring_of(points - place))
    add_array(cloud.data.GetFieldData(), "position", np.array(place), "m")
    return cloud


def score_birds(followed):
    return {row["bird"] for _, rows, _, _ in followed.scored for row in rows}


class Recorded(InFolder):
    def write(self, count, place=(0.0, 0.0, 0.0)):
        home = self.folder / "scans"
        home.mkdir()
        for number in range(count):
            al.save(scan(number, place), home / f"{number}.pcd")
        return home

    def rows(self, name):
        with open(self.folder / "out" / name, encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    def test_a_bird_before_a_wall(self):
        home = self.write(40, (5.0, 7.0, 2.0))
        recording = al.load_clouds(home, rate=RATE)
        found = RecordedTracks(recording, learning=10, origin=(52.0, 13.0, 30.0), heading=90.0).write(
            self.folder / "out")
        self.assertEqual((found["tracks"], found["points"]), (1, 40 * scan(0).number_of_points))
        rows = self.rows("tracks.csv")
        for row in rows[5:]:  # behind the first scans the velocity is known
            time = float(row["time_s"])
            x, y, z = START + (5, 7, 2) + [*(SPEED * time), CLIMB * time]
            east, north = y, -x  # the y axis of the recording points east
            self.assertLess(math.dist([float(row[name]) for name in ("x_m", "y_m", "z_m")], (east, north, z)), 0.5)
            self.assertLess(math.dist([float(row[name]) for name in ("vx_m_s", "vy_m_s", "vz_m_s")],
                                      (SPEED[1], -SPEED[0], CLIMB)), 1.0)
            self.assertAlmostEqual(float(row["latitude"]), 52 + math.degrees(north / RADIUS), delta=2e-5)
            self.assertAlmostEqual(float(row["longitude"]),
                                   13 + math.degrees(east / RADIUS / math.cos(math.radians(52))), delta=2e-5)
            self.assertAlmostEqual(float(row["height_m"]), 30 + z, delta=0.6)
        (one,) = self.rows("summary.csv")
        self.assertAlmostEqual(float(one["mean_speed_m_s"]), np.hypot(*SPEED), delta=1.0)
        (hour,) = self.rows("hours.csv")
        self.assertEqual((hour["hour"], hour["tracks"]), ("hour 1", "1"))
        (shape,) = json.loads((self.folder / "out" / "tracks.geojson").read_text())["features"]
        self.assertEqual(shape["geometry"]["coordinates"][3][:2],
                         [float(rows[3][name]) for name in ("longitude", "latitude")])
        page = (self.folder / "out" / "tracks.html").read_text()
        self.assertIn("1 thing moved through the beams in 6 s", page)
        self.assertIn("0.4 by 0.4 deg between beams, measured in the first scans", page)
        self.assertIn("5 scans a second, as given", page)

    def test_scores_are_those_of_the_report_card(self):
        """Of a sequence as a recording with its truth; with the labels alone, birds that return are known."""
        made = al.Sequence(SCENARIO, number_of_scans=24)
        made.write(self.folder / "made")
        home = self.folder / "made" / "sequences" / "00"
        card = al.BirdTracks([self.folder / "made"], learning_scans=10).write(self.folder / "card")
        followed = RecordedTracks(al.load_clouds(home), al.Sensor("Search905", position=made.sensor.position), 10,
                                  truth=home / "truth.csv")
        found = dict(followed.write(self.folder / "out")["scores"])
        self.assertEqual(found, {row["words"]: row["cells"][0] for row in card["overall"]})
        labelled = RecordedTracks(al.load_clouds(home), learning=10)
        found = dict(labelled.write(self.folder / "labels")["scores"])
        birds = {label for k in range(10, 24) for label in np.fromfile(home / "labels" / f"{k:06d}.label", "<u4")
                 if label & 0xffff == 99}
        self.assertEqual(len(score_birds(labelled)), len(birds))
        self.assertIn("birds tracked", found)

    def test_empty_scans_and_pauses(self):
        """A scan without points anywhere, and a pause of hours that is not observed."""
        home = self.write(24)
        for number in (3, 15):
            al.save(al.Cloud(type("points", (), {"points": np.empty((0, 3))})()), home / f"{number}.pcd")
        (home / "times.txt").write_text("".join(f"{k / RATE + (5000 if k > 18 else 0)}\n" for k in range(24)))
        followed = RecordedTracks(al.load_clouds(home), learning=10)
        self.assertEqual(followed.write(self.folder / "out")["scans"], 24)
        self.assertAlmostEqual(followed.seconds(), 14 / RATE)

    def test_coordinates_of_a_map(self):
        """Files that do not say where the sensor stands, and beams without an echo at the sensor."""
        place = np.array([500000.0, 5400000.0, 200.0])
        (self.folder / "map").mkdir()
        for number in range(24):
            cloud = scan(number, place)
            points = np.vstack([cloud.points, np.tile(place, (50, 1))])
            al.save(al.Cloud(type("points", (), {"points": points})()), self.folder / "map" / f"{number}.csv")
        recording = al.load_clouds(self.folder / "map", rate=RATE)
        with self.assertRaisesRegex(al.Error, r"points lie \d+ km from the origin .* expected --position X Y Z"):
            RecordedTracks(recording)
        found = RecordedTracks(recording, learning=10, position=place).write(self.folder / "out")
        self.assertEqual((found["tracks"], found["points"]), (1, 24 * scan(0).number_of_points))
        first = self.rows("tracks.csv")[0]
        RecordedTracks(recording, learning=10, position=place, origin=(52, 13, 30), heading=90).write(self.folder / "out")
        row = self.rows("tracks.csv")[0]
        x, y, _ = START + [*(SPEED * float(row["time_s"])), 0]
        self.assertAlmostEqual(float(row["latitude"]), 52 + math.degrees(-x / RADIUS), delta=2e-5)
        self.assertAlmostEqual(float(row["longitude"]), 13 + math.degrees(y / RADIUS / math.cos(math.radians(52))),
                               delta=3e-5)
        self.assertTrue((self.folder / "out" / "tracks.geojson").exists())
        RecordedTracks(recording, learning=10, position=place).write(self.folder / "out")
        self.assertFalse((self.folder / "out" / "tracks.geojson").exists())
        self.assertLess(math.dist([float(first[name]) for name in ("x_m", "y_m")], place[:2]), 100)

    def test_the_command(self):
        home, out = self.write(8), self.folder / "out"
        code, said, errors = run("track", home, "-o", out)
        self.assertEqual(code, 0)
        self.assertIn("8 scans; times from: 10 scans a second, assumed", said)
        self.assertIn("so clutter is learned in the first 4, expected more than 20", errors)
        for words, expected in (((home, "x.scenario.json"), "is a recording, but other inputs are sequences"),
                                ((home, "--weather", "fog:100"), "--weather is for scenarios"),
                                ((home, "--origin", 95, 0, 0), "expected latitude, longitude"),
                                ((home, "--heading", "nan"), "the heading is nan"),
                                ((home, "--runways", "r.geojson"), "runways need an origin on the Earth"),
                                ((home, "--sensor", "a", "--sensor", "b"), "--sensor is given 2 times"),
                                ((home, "--rate", -1), "rate is -1.0, expected above 0")):
            self.assertIn(expected, run("track", *words, "-o", self.folder / "no")[2])
        code, said, _ = run("info", home, "--rate", 4)
        self.assertEqual(code, 0)
        self.assertRegex(said, r"recording of 8 scans[\s\S]*duration +1.75 s[\s\S]*rate +4 Hz[\s\S]*laser_id")
        code, said, _ = run("convert", home, self.folder / "copy", "--rate", 4)
        self.assertEqual(code, 0)
        copy = al.load_clouds(self.folder / "copy")
        np.testing.assert_allclose(copy.times, np.arange(8) / 4, atol=1e-9)
        for one, two in zip(copy, al.load_clouds(home), strict=True):
            np.testing.assert_array_equal(one.points, two.points)
        self.assertIn("--rate is for recordings", run("info", al.example_scene(), "--rate", 5)[2])
