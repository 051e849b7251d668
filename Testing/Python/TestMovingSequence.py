# SPDX-License-Identifier: BSD-3-Clause
"""Labelled scans and coverage of a lidar that drives: poses, points with and without motion correction, and the command.
Oracles: SciPy's interpolation, the echoes of the same scans, and independent scans of one place."""
import json
import os
import pathlib
import runpy
import unittest

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

import avianlidar as al
from avianlidar._recording import load_clouds
from avianlidar.apps.coverage._passed import passed
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.inputs._read import read_plan
from avianlidar.apps.sequences import _following
from echotools import InFolder
from helpertools import rows_of, run
from TestSequence import scenario_file

EXAMPLE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "moving" / "platforms.py"
TIMES, PLACES = [0.0, 5.0, 14.0], np.array([[-40, -30, 0], [20, 10, 0], [20, 100, 0]], float)  # s, m
HEADINGS = [40.0, 90.0, 10.0]  # deg
ROOF = [0.0, 0.5, 2.0]  # place of the lidar on the car, m
SENSOR = {"preset": "Search905", "azimuth_step": 1.5, "position": ROOF, "orientation": [30.0, 0.0, 0.0]}


class TestMovingSequence(InFolder):
    def setUp(self):
        super().setUp()
        rows = [f"{t},{x},{y},{z},{h}" for t, (x, y, z), h in zip(TIMES, PLACES, HEADINGS)]
        (self.folder / "car.csv").write_text("\n".join(["time,x,y,z,heading", *rows, ""]), "utf-8")
        self.file = scenario_file(self.folder, sensor=SENSOR, trajectory={"file_name": "car.csv"}, number_of_scans=4,
                                  scans_per_sequence=2)

    @staticmethod
    def turn_at(time):
        return Rotation.from_euler("Z", -np.interp(time, TIMES, HEADINGS), degrees=True)

    def test_poses_and_points(self):
        for corrected in (True, False):
            out = self.folder / f"out-{corrected}"
            sequence = al.Sequence(self.file, motion_correction=corrected)
            sequence.write(out)
            first, points = out / "sequences" / "01", 0
            poses = np.loadtxt(first / "poses.txt").reshape(-1, 3, 4)
            for k, scan, species in sequence.frames(1):
                echoes, pose = scan.echoes, poses[k - 2]
                at = 2.0 * k
                place = [np.interp(at, TIMES, x) for x in PLACES.T] + self.turn_at(at).apply(ROOF)
                np.testing.assert_allclose(pose[:, 3], place, atol=1e-6)
                ahead = Rotation.from_euler("Z", -30 - np.interp(at, TIMES, HEADINGS), degrees=True).apply([0, 1, 0])
                np.testing.assert_allclose(pose[:, 0], ahead, atol=1e-8)
                stored = np.fromfile(first / "velodyne" / f"{k - 2:06d}.bin", "<f4").reshape(-1, 4)[:, :3].astype(float)
                if corrected:
                    back = stored @ pose[:, :3].T + pose[:, 3]
                else:
                    turns = Rotation.from_quat(echoes["sensor_orientation"][:, [1, 2, 3, 0]])
                    back = turns.apply(stored @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]) + echoes["sensor_position"]
                np.testing.assert_allclose(back, echoes.points, atol=1e-3)
                points += np.isin(echoes["object_id"], [*species]).sum()
                self.check_boxes(first, k - 2)
            self.assertGreater(points, 5)
            offsets = np.fromfile(first / "offsets" / "000001.offset", "<f4") if not corrected else ()
            if not corrected:
                np.testing.assert_allclose(offsets, 1e-6 * echoes["timestamp"] - 6, atol=1e-6)
                self.assertEqual(run("convert", first, self.folder / "raw.mcap")[0], 0)
                *_, last = load_clouds(str(self.folder / "raw.mcap"))
                np.testing.assert_allclose(last["timestamp"] - last["timestamp"].min(),
                                           1e6 * (offsets - offsets.min()), atol=2)
            line = al.read_trajectory(out / "trajectory.vtp")
            np.testing.assert_array_equal(al.Cloud(line).points, PLACES)

    def check_boxes(self, folder, number):
        """Points of a mover lie in its box, up to the errors of ranges and the beam's width."""
        points = np.fromfile(folder / "velodyne" / f"{number:06d}.bin", "<f4").reshape(-1, 4)[:, :3]
        instances = np.fromfile(folder / "labels" / f"{number:06d}.label", "<u4") >> 16
        for line in (folder / "boxes" / f"{number:06d}.txt").read_text().splitlines():
            *_, x, y, z, length, width, height, _, mover, count = line.split()
            mine = points[instances == (int(mover) + 1) % 65536]
            self.assertEqual(len(mine), int(count))
            if len(mine):
                reach = 0.5 * float(np.linalg.norm([float(length), float(width), float(height)]))
                off = np.linalg.norm(mine - [float(x), float(y), float(z)], axis=1)
                self.assertLess(off.min(), reach + 0.01 * np.linalg.norm(mine, axis=1).max() + 1.0, line)

    def test_work_goes_on_and_other_trajectories_are_refused(self):
        out = self.folder / "out"
        made = al.Sequence(self.file, number_of_scans=2).write(out)
        more = al.Sequence(self.file).write(out)
        self.assertEqual(made["sequences"]["00"], more["sequences"]["00"])
        al.Sequence(out / "manifest.json").write(out)  # the manifest names the trajectory
        (self.folder / "car.csv").write_text("time,x,y,z\n0,0,0,0\n9,9,0,0\n", "utf-8")
        with self.assertRaisesRegex(al.Error, "made from another scenario.*trajectory"):
            al.Sequence(self.file).write(out)
        with self.assertRaisesRegex(al.Error, "the sensor moves, expected one that stands still"):
            _following.Input(out, "out")

    def test_a_recording_of_the_scans_moves(self):
        out = self.folder / "out"
        al.Sequence(self.file).write(out)
        self.assertEqual(run("convert", out / "sequences" / "00", self.folder / "drive.mcap")[0], 0)
        recording = load_clouds(str(self.folder / "drive.mcap"))
        self.assertTrue(recording.moves)
        np.testing.assert_allclose(recording.pose(1)[:, 3], np.loadtxt(
            out / "sequences" / "00" / "poses.txt").reshape(-1, 3, 4)[1][:, 3], atol=1e-6)
        line = al.read_trajectory(self.folder / "drive.mcap")
        np.testing.assert_allclose(al.Cloud(line).points[1], recording.pose(1)[:, 3], atol=1e-6)

    def test_scans_beyond_the_trajectory_are_an_error_at_once(self):
        with self.assertRaisesRegex(al.Error, "sensor: .*from 0 to 14 s, but the beams of revolution 7 are from 14 to"):
            al.Sequence(self.file, number_of_scans=8)

    def test_the_command(self):
        gpx = "<gpx><trk><trkseg>" + "".join(
            f'<trkpt lat="{47 + 1e-5 * k}" lon="8.5"><ele>3</ele><time>2026-05-04T06:00:0{k}Z</time></trkpt>'
            for k in range(6)) + "</trkseg></trk></gpx>"
        (self.folder / "car.gpx").write_text(gpx, "utf-8")
        options = ("--trajectory", self.folder / "car.gpx", "--trajectory-set", "origin=47,8.5,0")
        # The lidar of a scenario stands in the scene, not on the platform.
        plain = scenario_file(self.folder, number_of_scans=1, sensor={**SENSOR, "position": [500, 40, 3]})
        code, _, errors = run("sequence", plain, "-o", self.folder / "out", "--sensor-set", "position=0,0,2", *options)
        self.assertEqual(code, 0, errors)
        pose = np.loadtxt(self.folder / "out" / "sequences" / "00" / "poses.txt").reshape(3, 4)
        np.testing.assert_allclose(pose[:, 3], [0, 0, 5], atol=1e-3)
        np.testing.assert_allclose(pose[:, 0], [0, 1, 0], atol=1e-3)
        for words in (("columns=time",), ("foo=1",)):
            code, _, errors = run("scan", self.folder / "small.lidarscene.json", *options, "-o", self.folder / "e.vtp",
                                  "--trajectory-set", *words)
            self.assertEqual((code, "--trajectory-set: " in errors), (2, True), errors)
        code, said, errors = run("scan", self.folder / "small.lidarscene.json", "--sensor", "Search905", "--position", 0, 0,
                                 2, "-o", self.folder / "echoes.vtp", *options)
        self.assertEqual(code, 0, errors)
        self.assertIn("when the scan begins, as --trajectory and --position say", said)
        echoes = al.load_cloud(self.folder / "echoes.vtp")
        along = echoes["sensor_position"][:, 1]  # 1e-5 deg of latitude are 1.11 m
        np.testing.assert_allclose(along, 1.1118e-6 * echoes["timestamp"], atol=2e-3)
        code, _, errors = run("scan", self.folder / "small.lidarscene.json", "--trajectory-set", "track=a", "-o",
                              self.folder / "echoes.vtp")
        self.assertEqual(code, 2)
        self.assertIn("expected --trajectory FILE", errors)

    def test_the_example(self):
        """A car and a drone see birds, and the moving picture has a frame for each scan."""
        platforms = runpy.run_path(str(EXAMPLE))
        platforms["main"](["--scans", "2", "--out", str(self.folder)])
        with Image.open(self.folder / "moving.webp") as moving, Image.open(self.folder / "platforms.png") as last:
            self.assertEqual((moving.n_frames, last.size), (2, (900, 900)))
        for name in ("car", "drone"):
            _, scans = platforms["scanned"](name, 2)
            self.assertGreater(sum(len(points) for *_, birds in scans for points in birds.values()), 2, name)
            self.assertGreater(np.linalg.norm(scans[1][0] - scans[0][0]), 5)

    def test_a_clock_of_the_scenario(self):
        """Times since 1970 count from the scenario's start_time, other clocks from the trajectory's own."""
        rows = "".join(f"2026-05-04T06:00:{t:02}Z,{t},0,0\n" for t in (0, 20))
        (self.folder / "day.csv").write_text(f"time,x,y,z\n{rows}", "utf-8")
        for line, start, east in (({"file_name": "day.csv"}, "2026-05-04T06:00:07Z", 7),
                                  ({"file_name": "day.csv"}, None, 0), ({"file_name": "car.csv", "start_time": 5}, None, 20)):
            own = {"trajectory": line, "number_of_scans": 1, **({"start_time": start} if start else {})}
            file = scenario_file(self.folder, sensor={**SENSOR, "position": [0, 0, 0]}, **own)
            sequence = al.Sequence(file)
            self.assertAlmostEqual(sequence.sensor.beams.fields["position"][0], east)

    def test_coverage_while_standing_and_passing(self):
        (self.folder / "still.csv").write_text("time,x,y,z,heading\n0,5,-8,1,0\n9,5,-8,1,0\n", "utf-8")
        plan = self.folder / "small.coverage.json"
        plan.write_text(json.dumps({"scene": "small.lidarscene.json", "sensor": {"preset": "Search905"}, "places": 300,
                                    "extent": [-300, 300, -300, 300], "heights": [5, 40], "spacing": 50,
                                    "mix": {"crow": 3, "herring gull": 1}}), "utf-8")
        question = Plan(read_plan(plan))
        rows = passed(question, self.folder / "still.csv", position=(0, 0, 2))
        question.sensor.position = (5, -8, 3)
        weights, seen = question.weights(question.points), []
        for species in question.mix:
            question.regions.set(species=species, all_species=False)
            seen.append(question.regions["detection_probability"].astype(float))
        scans = 4  # of 2 s in 9 s
        expected = float((weights * (1 - (1 - np.array(seen))**scans)).sum())
        self.assertEqual((rows[-1]["scans"], rows[-1]["species"]), (scans, question.bird))
        self.assertAlmostEqual(rows[-1]["detected_while_passing"], expected, places=12)
        self.assertAlmostEqual(rows[-1]["detected_in_a_scan"], float((weights * seen).sum()), places=12)
        self.assertGreater(expected, rows[-1]["detected_in_a_scan"] + 0.001)
        code, said, errors = run("coverage", plan, "-o", self.folder / "maps", "--trajectory", self.folder / "car.csv",
                                 "--trajectory-set", "position=0,0,2")
        self.assertEqual(code, 0, errors)
        self.assertIn("at least once in 7 scans", said)
        self.assertEqual(len(rows_of(self.folder / "maps" / "passing.csv")), len(rows))


if __name__ == "__main__":
    unittest.main()
