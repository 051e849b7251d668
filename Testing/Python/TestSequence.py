# SPDX-License-Identifier: BSD-3-Clause
"""Sequences: files that SemanticKITTI's programs read, labels that name the owner of the light, birds as often seen as
expected, the same bits from the manifest, and work that goes on after a kill."""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest
import unittest.mock

import numpy as np
import yaml

import avianlidar as al
from avianlidar import _command, _pipeline
from avianlidar.apps.sequences import _labels
from avianlidar.apps.sequences._simulation import Clutter, STATUSES, SUBSETS, TRUTH
from boxfiles import CORNERS, LOW, TRIANGLES, stl
from echotools import bird as bird_of
from exampletools import emptied
from helpertools import rows_of

EXAMPLE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "sequence"
BOX = {"name": "box", "material": "Wall", "class": "car", "boxes": [[-1, 1, -2, 2, 0, 2]], "speed": 10.0, "every": 30,
       "route": [[-80, 150, 0], [80, 150, 0], [80, 250, 0]]}
SCENE = {"version": 1, "lidar": {"position": [5, -8, 3]}, "objects": [
    {"name": "Ground", "class": "ground", "ground": {"size": 4000, "height": 0}, "material": "Wall"},
    {"name": "House", "class": "building", "file": "house.stl", "material": "Wall"}]}
SCENARIO = {"scene": "small.lidarscene.json", "number_of_scans": 12, "scans_per_sequence": 3, "seed": 5,
            "sensor": {"preset": "Search905", "orientation": [30.0, 0.0, 0.0], "azimuth_step": 0.75,
                       "sway_amplitude": 0.02, "encoder_jitter": 0.01},
            "scan": {"attenuation_coefficient": 8.9e-5, "number_of_reflections": 1, "rays_per_beam": 50},
            "birds": [{"pattern": "Crossings", "species": "herring gull", "number_of_birds": 20, "radius": 450,
                       "heights": [5, 40]}, {"pattern": "Circles", "species": "crow", "number_of_birds": 10,
                                             "radius": 700, "heights": [8, 50]}], "objects": [BOX]}


def scenario_file(where, around=SCENE, **changes):
    """A scenario with a scene of its own."""
    (where / "small.lidarscene.json").write_text(json.dumps(around), "utf-8")
    house = np.where(CORNERS == LOW, (-40.0, 300.0, 0.0), (40.0, 310.0, 12.0))
    (where / "house.stl").write_text(stl(house, TRIANGLES), "utf-8")
    path = where / "small.scenario.json"
    path.write_text(json.dumps({**SCENARIO, **changes}), "utf-8")
    return path


def truth_of(out):
    return [row for path in sorted(out.glob("sequences/*/truth.csv")) for row in rows_of(path)]


def check_files(test, out, bird):
    """Scans, labels and configuration by the rules of semantic-kitti-api: labels are mapped by a table and predictions
    scored. @return instances"""
    rules = yaml.safe_load((out / "semantic-kitti.yaml").read_text())
    labels, learned, back = rules["labels"], rules["learning_map"], rules["learning_map_inv"]
    for table in (learned, rules["color_map"], rules["content"]):
        test.assertEqual(set(labels), set(table))
    test.assertTrue(all(len(color) == 3 and all(type(c) is int and 0 <= c < 256 for c in color)
                        for color in rules["color_map"].values()))
    test.assertEqual((sorted(back), set(learned.values())), (list(range(len(back))), set(back)))
    test.assertEqual(rules["learning_ignore"], {k: k == 0 for k in back})
    test.assertTrue(all(learned[label] == number for number, label in back.items()))
    test.assertTrue(all(learned[label] for label in labels if label))  # nothing else is left out
    parts = [number for name in ("train", "valid", "test") for number in rules["split"][name]]
    test.assertEqual([f"{number:02d}" for number in sorted(parts)],
                     sorted(path.name for path in (out / "sequences").iterdir()))
    table = np.zeros(max(learned) + 100, np.int32)
    table[list(learned)] = list(learned.values())
    confusion, counts, found = np.zeros((2, len(back), len(back)), int), dict.fromkeys(labels, 0), {}
    for number in parts:
        home = out / "sequences" / f"{number:02d}"
        for scan, file in zip(*(sorted((home / folder).iterdir()) for folder in ("velodyne", "labels"))):
            test.assertEqual(scan.stem, file.stem)
            points, words = np.fromfile(scan, np.float32).reshape(-1, 4), np.fromfile(file, np.uint32)
            test.assertEqual(len(points), len(words))
            test.assertTrue(np.isfinite(points).all() and (points[:, 3] >= 0).all() and (points[:, 3] <= 1).all())
            subset = np.fromfile(home / "subsets" / f"{scan.stem}.subset", np.uint8)
            test.assertTrue(len(subset) == len(points) and subset.max(initial=0) < len(SUBSETS))
            classes, objects = (words & 0xFFFF).astype(int), (words >> 16).astype(int) - 1
            for label, count in zip(*np.unique(classes, return_counts=True)):
                counts[int(label)] += int(count)  # a label that it does not know is a KeyError
            # the scenario's box is a car
            for label, here in ((bird, objects >= 10000), (252, (objects >= 1000) & (objects < 10000))):
                test.assertTrue((classes[here] == label).all())
                found.setdefault(label, set()).update(objects[here])
            # the second is of a network that sees no bird
            for k, guess in enumerate((classes, np.where(classes == bird, 50, classes))):
                np.add.at(confusion[k], (table[guess], table[classes]), 1)
    for label, share in rules["content"].items():
        test.assertAlmostEqual(share, counts[label] / sum(counts.values()), delta=1e-9)
    for k, scores in enumerate(confusion):
        scores[:, 0] = 0  # what is ignored
        union = scores.sum(axis=0) + scores.sum(axis=1) - np.diag(scores)
        test.assertEqual(scores[:, learned[bird]].sum(), counts[bird])  # every point of a bird is scored
        test.assertEqual(np.diag(scores)[learned[bird]] / union[learned[bird]], 1 - k)
    test.assertRegex((out / "datasheet.md").read_text(), rf"\| {bird} \| .*birds.* \| \d+")
    return found


def command(*arguments):
    return [sys.executable, "-m", "avianlidar", *map(str, arguments)]


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = emptied("sequence", "files")
        cls.file = scenario_file(cls.home)
        cls.out = cls.home / "out"
        cls.manifest = al.Sequence(cls.file, threads=1).write(cls.out)

    def test_is_read_by_the_rules_of_semantic_kitti(self):
        instances = check_files(self, self.out, 99)
        self.assertLessEqual(instances[99], set(range(10000, 10030)))
        self.assertGreater(len(instances[99]), 10)
        self.assertGreater(len(instances[252]), 0)
        for number in range(4):
            sequence = self.out / "sequences" / f"{number:02d}"
            self.assertEqual([p.name for p in sorted((sequence / "velodyne").iterdir())],
                             [f"{k:06d}.bin" for k in range(3)])
            poses = np.loadtxt(sequence / "poses.txt").reshape(3, 3, 4)
            # Yaw 30 degrees, clockwise: forward is (sin 30, cos 30, 0).
            forward, right = np.array((0.5, np.sqrt(0.75), 0)), np.array((np.sqrt(0.75), -0.5, 0))
            np.testing.assert_allclose(
                poses, np.tile(np.column_stack([forward, -right, (0, 0, 1), (5, -8, 3)]), (3, 1, 1)), atol=1e-8)
            np.testing.assert_allclose(np.loadtxt(sequence / "times.txt"), 2.0 * np.arange(3) + 6.0 * number, atol=1e-6)
            self.assertRegex((sequence / "calib.txt").read_text(), r"(?m)^Tr: 1 0 0 0 0 1 0 0 0 0 1 0$")

    def test_truth_has_a_row_for_every_bird_and_scan(self):
        rows = truth_of(self.out)
        self.assertEqual((tuple(rows[0]), len(rows)), (TRUTH, 12 * 30))
        by = {(int(r["scan"]), int(r["bird"])): r for r in rows}
        self.assertEqual(set(by), {(k, 10000 + b) for k in range(12) for b in range(30)})
        self.assertLessEqual({r["status"] for r in rows}, set(STATUSES))
        self.assertEqual({r["species"] for r in rows}, {"herring gull", "crow"})

        def place_of(r, when=""):
            return np.array([float(r[when + c]) for c in ("x_m", "y_m", "z_m")])
        for r in rows:
            self.assertEqual(r["status"] == "seen", int(r["points"]) > 0)
            if r["x_m"]:
                self.assertAlmostEqual(np.linalg.norm(place_of(r) - (5, -8, 3)) - float(r["range_m"]), 0, delta=1e-3)
                times = [float(r[name]) for name in ("first_time_s", "time_s", "last_time_s")]
                self.assertEqual(times, sorted(times))
                self.assertLess(times[2] - times[0], 2.0)
        # The points of a bird are those of its instance, and lie where it is: within the beam, a range unit, and the
        # bird's way between beams, which are at one place, or at both ends of a whole revolution.
        pose, counts = np.loadtxt(self.out / "sequences" / "00" / "poses.txt")[0].reshape(3, 4), dict.fromkeys(by, 0)
        for label in self.out.glob("sequences/*/labels/*.label"):
            scan = 3 * int(label.parts[-3]) + int(label.stem)
            words = np.fromfile(label, np.uint32)
            points = np.fromfile(label.parent.parent / "velodyne" / f"{label.stem}.bin", np.float32)
            points = points.reshape(-1, 4)[:, :3] @ pose[:, :3].T + pose[:, 3]
            for point, word in zip(points[words & 0xFFFF == 99], words[words & 0xFFFF == 99]):
                key = scan, int(word >> 16) - 1
                counts[key] += 1
                away = min(np.linalg.norm(point - place_of(by[key], when)) for when in ("", "first_", "last_"))
                self.assertLess(away, 0.01 * np.linalg.norm(point) + 2.5)
        self.assertEqual(counts, {key: int(r["points"]) for key, r in by.items()})
        self.assertGreater(sum(counts.values()), 50)

    def test_the_configuration_has_fixed_numbers(self):
        """Trained networks keep their meaning: what is looked for comes first, then the classes of
        Documentation/guide/sequences.md."""
        made = yaml.safe_load(_labels.configuration(99, {99: 1, 252: 3}, range(10)))
        self.assertEqual([made["content"][k] for k in (99, 252, 0)], [0.25, 0.75, 0])
        order = [0, 99, 252, 258, 259, 10, 18, 20, 40, 44, 49, 50, 51, 52, 70, 72, 80, 81, 1]
        self.assertEqual(made["learning_map_inv"], dict(enumerate(order)))
        self.assertEqual([made["labels"][k] for k in (0, 10, 50, 72, 99, 259)],
                         ["unlabeled", "car", "building", "terrain", "bird", "moving-other-vehicle"])
        self.assertEqual(made["split"], {"train": [0, 3, 4, 5, 8, 9], "valid": [1, 6], "test": [2, 7]})

    def test_birds_may_have_another_label(self):
        out = emptied("sequence", "birds-300")
        al.Sequence(self.file, threads=1, number_of_scans=3, bird_class=300).write(out)
        check_files(self, out, 300)
        for label, words in ((50, "bird_class is 50, .*building"), (0, "bird_class: 0 is less than")):
            with self.assertRaisesRegex(al.Error, words):
                al.Sequence(self.file, bird_class=label)

    def test_birds_are_seen_as_often_as_expected(self):
        rows = [r for r in truth_of(self.out) if r["subset"] == "sky" and r["expected_probability"]]
        p = np.array([float(r["expected_probability"]) for r in rows])
        seen = np.array([r["status"] == "seen" for r in rows])
        self.assertGreater(((p > 0.05) & (p < 0.95)).sum(), 10)
        self.assertLess(abs(seen.sum() - p.sum()), 3 * np.sqrt((p * (1 - p)).sum() + 1))
        clear = p > 0.999
        self.assertGreater(seen[clear].mean(), 0.99)

    def test_the_manifest_makes_the_same_bits_after_a_kill(self):
        """With another number of threads. What was whole when the process was killed stays."""
        wanted, out = self.manifest["sequences"], self.home / "killed"
        job = subprocess.Popen(command("sequence", self.out / "manifest.json", "-o", out), stderr=subprocess.DEVNULL)
        end = time.monotonic() + 120
        while job.poll() is None and time.monotonic() < end and not list(out.glob("sequences/[0-9]*")):
            time.sleep(0.02)
        job.send_signal(signal.SIGKILL)
        job.wait()
        whole = {path: path.stat().st_mtime_ns for path in out.glob("sequences/[0-9]*/velodyne/*")}
        self.assertTrue(0 < len(whole) < 12 and not (out / "manifest.json").exists())
        self.assertEqual(al.Sequence(self.out / "manifest.json", threads=2).write(out)["sequences"], wanted)
        self.assertEqual({path: path.stat().st_mtime_ns for path in whole}, whole)
        self.assertEqual(list(out.glob("sequences/.*")), [])
        files = [{p.relative_to(home): p.read_bytes() for p in home.glob("sequences/*/*/*")}
                 for home in (self.out, out)]
        self.assertEqual(len(files[0]), 4 * 3 * 4)
        self.assertEqual(*files)

    def test_observers_are_added_once_for_all_scans(self):
        """VTK looks through all observers that there ever were when one is removed."""
        added, enter = [], _pipeline.Updates.__enter__

        def count(updates):
            added.append(updates)
            return enter(updates)
        numbers = []
        for scans in (1, 2):
            sequence = al.Sequence(self.file, threads=1, number_of_scans=scans, birds=[])
            added.clear()
            with unittest.mock.patch.object(_pipeline.Updates, "__enter__", count):
                sequence.write(emptied("sequence", "observers"))
            numbers.append(len(added))
        self.assertGreater(numbers[0], 0)
        self.assertEqual(*numbers)


class Labels(unittest.TestCase):
    def test_the_label_is_the_owner_of_the_largest_share(self):
        """Each owner alone with its reflectance, all others black: what it adds to each range unit."""
        wall = ([(-30, 200, 0), (30, 200, 0), (30, 200, 40), (-30, 200, 40)], [(0, 1, 2), (0, 2, 3)])
        sensor = al.Sensor("Airport16", channel_elevations=tuple(np.arange(0.4, 6, 0.2)), azimuth_range=(-8.0, 8.0),
                           azimuth_step=0.15, lower_energy_limit=0.0, upper_energy_limit=1.0)

        def scan(light):
            scene = al.Scene(wall, material=(0.146, 0.0, 1.0) if "wall" in light else (0.0, 0.0, 1.0))
            gulls = []
            for k in range(6):
                gull = bird_of(ObjectId=50 + k, Reflectance=0.3 if k in light else 0.0, Heading=40.0 * k)
                # owners compete: within a range unit of the wall
                gulls.append(al.mover(gull, [(-15 + 6 * k, 199.4 - 0.1 * k, 3 + 2 * k)]))
            echoes = al.Scan(scene, sensor, noise=False, number_of_reflections=1, return_mode="RangeUnits",
                             attenuation_coefficient=0, movers=gulls).echoes
            unit = np.floor(np.array(echoes["distance_m"]) / 0.75 + 1e-9).astype(int)
            keys = list(zip(np.array(echoes["beam_id"]), unit))
            return dict(zip(keys, np.array(echoes["energy_received"]))), dict(zip(keys, np.array(echoes["object_id"])))

        energy, label = scan({"wall", *range(6)})
        alone = {owner: scan({owner})[0] for owner in ("wall", *range(6))}
        ids = {"wall": 0, **{k: 50 + k for k in range(6)}}
        of_birds = contested = 0
        for key, total in energy.items():
            shares = {ids[owner]: part.get(key, 0.0) for owner, part in alone.items()}
            self.assertAlmostEqual(sum(shares.values()) / total, 1, delta=1e-6)
            best, second = sorted(shares.values())[-1:-3:-1]
            if best > second * (1 + 1e-6):
                self.assertEqual(shares[label[key]], best, (key, shares))
                of_birds += label[key] >= 50
                contested += second > 0.05 * best
        self.assertGreater(of_birds, 5)
        self.assertGreater(contested, 5)

    def test_subsets_are_what_they_are_said_to_be(self):
        class Still:
            echoes = {"beam_id": np.array([7, 3, 3, 9]), "distance_m": np.array([50.0, 200.0, 100.0, 10.0]),
                      "energy_received": np.ones(4), "object_id": np.array([0, 5, -1, -2])}  # the last is of the air
        distance, subset = Clutter(Still, 15.0).look([3, 3, 3, 3, 7, 9], [90.0, 120.0, 80.0, 190.0, 50.0, 10.0])
        np.testing.assert_array_equal(distance, [10, 20, 20, 10, 0, np.inf])
        self.assertEqual([SUBSETS[k] for k in subset],
                         ["near_clutter", "through_edges", "near_clutter", "through_edges", "near_clutter", "sky"])


class Shipped(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        sys.path.insert(0, str(EXAMPLE))

    def test_clutter_is_neither_too_easy_nor_hopeless(self):
        """The clutter filter that knows the whole sequence, on six scans of the shipped scenario: a cell met once is
        not clutter."""
        import clutter
        out = emptied("sequence", "shipped")
        al.Sequence(EXAMPLE / "hongqiao.scenario.json", number_of_scans=6, scans_per_sequence=6).write(out)
        files = [sorted((out / "sequences" / "00" / "velodyne").glob("*.bin"))]
        found = sum(dict(clutter.measure(files, {"ClutterThreshold": 0.2}))["all scans of its sequence"][0])
        for subset in ("near clutter", "through edges"):
            hit, false, missed = found[clutter.SUBSETS.index(subset), 0]
            self.assertTrue(0.05 < hit / (hit + false + missed) < 0.9, (subset, hit, false, missed))
        self.assertEqual({row["subset"] for row in truth_of(out) if row["status"] == "seen"}, set(SUBSETS))

    def test_the_picture_has_all_points(self):
        import labels
        out = emptied("sequence", "labels")
        counts = labels.main(["--scans", "1", "--out", str(out)])
        file, = (out / "sequences").glob("sequences/*/labels/*.label")
        written = np.unique(np.fromfile(file, "<u4") & 0xffff, return_counts=True)
        self.assertEqual(counts, dict(zip(*(values.tolist() for values in written))))
        self.assertGreater(counts[99], 20)
        self.assertGreater((out / "labels.png").stat().st_size, 10000)


class BadScenarios(unittest.TestCase):
    def test_are_named(self):
        home = emptied("sequence", "bad")
        bird = {"pattern": "Crossings", "number_of_birds": 3}
        for words, changes in {
                "number_of_scans: 0": {"number_of_scans": 0},
                "'number_of_scan' is not known; did you mean 'number_of_scans'?": {"number_of_scan": 3},
                "birds[0].pattern: 'Swarm'": {"birds": [{"pattern": "Swarm"}]},
                "Species is 'dodo'": {"birds": [{**bird, "species": "dodo"}]},
                "'radios' is not known": {"birds": [{**bird, "radios": 3}]},
                "birds[0].first_object_id: ": {"birds": [{**bird, "first_object_id": 7}]},
                "objects[0].route: ": {"objects": [{**BOX, "route": [[0, 1, 2], [0, 1, 2]]}]},
                "objects[0].every: more than 9000 objects": {"objects": [{**BOX, "every": 1e-4}]},
                "objects[0]: ": {"objects": [{**BOX, "boxes": [[-1, 1, -2, 2, 0, 1e40]]}]},
                "there is no.lidarscene.json": {"scene": "there is no.lidarscene.json"}}.items():
            file = scenario_file(home, **changes)
            with self.subTest(words), self.assertRaisesRegex(al.Error, re.escape(words)):
                al.Sequence(file)
        file.write_text("{")
        with self.assertRaisesRegex(al.Error, "is not JSON"):
            al.Sequence(file)


class Command(unittest.TestCase):
    def test_settings_of_a_sequence_are_those_of_a_changed_scenario(self):
        home = emptied("sequence", "settings")
        file = scenario_file(home, number_of_scans=1, scans_per_sequence=1, objects=[])
        code = _command.main(["sequence", str(file), "-o", str(home / "told"), "--sensor-set", "sway_amplitude=0",
                              "--sensor-set", "encoder_jitter=0", "--sensor-set", "number_of_channels=3",
                              "--sensor-set", "position=1,2,3", "--scan-set", "rays_per_beam=40", "--scan-set",
                              "noise=false"])
        self.assertIn(code, (None, 0))
        whole = json.loads((home / "told" / "manifest.json").read_text())["scenario"]
        self.assertEqual([whole["sensor"][name]
                          for name in ("sway_amplitude", "encoder_jitter", "number_of_channels", "position")],
                         [0, 0, 3, [1, 2, 3]])
        self.assertEqual(whole["scan"], {**SCENARIO["scan"], "rays_per_beam": 40, "noise": False})

    def test_the_launcher_finds_its_package(self):
        launcher = next(folder / "bin" / "avianlidar" for folder in pathlib.Path(al.__file__).resolve().parents
                        if (folder / "bin" / "avianlidar").exists())
        bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        done = subprocess.run([str(launcher), "--help"], capture_output=True, text=True, check=True, env=bare)
        self.assertRegex(done.stdout, "examples:\n  avianlidar scan")
