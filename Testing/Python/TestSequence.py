# SPDX-License-Identifier: BSD-3-Clause
"""Sequences: files that SemanticKITTI's programs read, labels that name the owner of the light, birds as often seen as
expected, the same bits from the manifest, and work that goes on after a kill."""
import csv
import hashlib
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
import yaml
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkIOGeometry import vtkSTLWriter

import avianlidar as al
from avianlidar import _pipeline
from avianlidar.apps import _labels
from avianlidar.apps._sequence import STATUSES, SUBSETS, TRUTH, Clutter
from avianlidar.vtkAvianLidar import vtkAvianLidarBirdSource
from exampletools import emptied

EXAMPLE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "sequence"
BOX = {"name": "box", "material": "Wall", "class": "car", "boxes": [[-1, 1, -2, 2, 0, 2]], "speed": 10.0, "every": 30,
       "route": [[-80, 150, 0], [80, 150, 0], [80, 250, 0]]}
SCENE = {"version": 1, "lidar": {"position": [5, -8, 3]}, "objects": [
    {"name": "Ground", "class": "ground", "ground": {"size": 4000, "height": 0}, "material": "Wall"},
    {"name": "House", "class": "building", "file": "house.stl", "material": "Wall"}]}
SCENARIO = {
    "scene": "small.lidarscene.json", "number_of_scans": 40, "scans_per_sequence": 10, "seed": 5,
    "sensor": {"preset": "Search905", "orientation": [30.0, 0.0, 0.0], "sway_amplitude": 0.02, "encoder_jitter": 0.01},
    "scan": {"attenuation_coefficient": 8.9e-5, "number_of_reflections": 1},
    "birds": [{"pattern": "Crossings", "species": "herring gull", "number_of_birds": 20, "radius": 450, "heights": [5, 40]},
              {"pattern": "Circles", "species": "crow", "number_of_birds": 10, "radius": 700, "heights": [8, 50]}],
    "objects": [BOX]}


def scenario_file(where, **changes):
    """A scenario with a scene of its own."""
    (where / "small.lidarscene.json").write_text(json.dumps(SCENE), encoding="utf-8")
    house, triangles, writer = vtkCubeSource(), vtkTriangleFilter(), vtkSTLWriter()
    house.SetBounds(-40, 40, 300, 310, 0, 12)
    triangles.SetInputConnection(house.GetOutputPort())
    writer.SetInputConnection(triangles.GetOutputPort())
    writer.SetFileName(str(where / "house.stl"))
    writer.Write()
    path = where / "small.scenario.json"
    path.write_text(json.dumps({**SCENARIO, **changes}), encoding="utf-8")
    return path


def truth_of(out):
    rows = []
    for path in sorted(out.glob("sequences/*/truth.csv")):
        with open(path, newline="", encoding="utf-8") as stream:
            rows += list(csv.DictReader(stream))
    return rows


def check_configuration(test, out, bird):
    """By the rules of semantic-kitti-api: how it reads scans, maps labels by a table, and scores predictions."""
    rules = yaml.safe_load((out / "semantic-kitti.yaml").read_text())
    labels, learned, back = rules["labels"], rules["learning_map"], rules["learning_map_inv"]
    test.assertEqual(set(labels), set(learned))
    test.assertEqual(set(labels), set(rules["color_map"]))
    test.assertEqual(set(labels), set(rules["content"]))
    test.assertTrue(all(len(color) == 3 and all(type(c) is int and 0 <= c < 256 for c in color) for color in rules["color_map"].values()))
    test.assertEqual(sorted(back), list(range(len(back))))
    test.assertEqual(set(learned.values()), set(back))
    test.assertEqual(set(rules["learning_ignore"]), set(back))
    test.assertEqual([k for k in back if rules["learning_ignore"][k]], [0])
    test.assertTrue(all(learned[label] == number for number, label in back.items()))
    test.assertTrue(all(label in (0,) or learned[label] for label in labels))  # nothing else is left out
    parts = [number for name in ("train", "valid", "test") for number in rules["split"][name]]
    test.assertEqual([f"{number:02d}" for number in sorted(parts)], sorted(path.name for path in (out / "sequences").iterdir()))
    table = np.zeros(max(learned) + 100, np.int32)
    table[list(learned)] = list(learned.values())
    confusion, counts = np.zeros((2, len(back), len(back)), int), dict.fromkeys(labels, 0)
    moving = 0
    for number in parts:
        home = out / "sequences" / f"{number:02d}"
        for scan, file in zip(sorted((home / "velodyne").iterdir()), sorted((home / "labels").iterdir())):
            words = np.fromfile(file, np.int32).reshape(-1)
            test.assertEqual(np.fromfile(scan, np.float32).reshape(-1, 4).shape[0], words.shape[0])
            classes, objects = words & 0xFFFF, (words.view(np.uint32) >> 16).astype(int) - 1
            for label, count in zip(*np.unique(classes, return_counts=True)):
                counts[int(label)] += int(count)  # a label that it does not know is a KeyError
            test.assertTrue((classes[objects >= 10000] == bird).all())
            under_way = (objects >= 1000) & (objects < 10000)
            test.assertTrue((classes[under_way] == 252).all())  # the scenario's box is a car
            moving += under_way.sum()
            blind = np.where(classes == bird, 50, classes)  # predictions of a network that sees no bird
            for k, guess in enumerate((classes, blind)):
                np.add.at(confusion[k], (table[guess], table[classes]), 1)
    test.assertGreater(moving, 0)
    total = sum(counts.values())
    for label, share in rules["content"].items():
        test.assertAlmostEqual(share, counts[label] / total, delta=1e-9)
    for k, scores in enumerate(confusion):
        scores = scores.copy()
        scores[:, 0] = 0  # what is ignored
        union = scores.sum(axis=0) + scores.sum(axis=1) - np.diag(scores)
        test.assertEqual(scores[:, learned[bird]].sum(), counts[bird])  # every point of a bird is scored
        test.assertEqual(np.diag(scores)[learned[bird]] / union[learned[bird]], 1 - k)


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
        sequences = sorted((self.out / "sequences").iterdir())
        self.assertEqual([path.name for path in sequences], ["00", "01", "02", "03"])
        instances = set()
        for sequence in sequences:
            scans, labels = sorted((sequence / "velodyne").iterdir()), sorted((sequence / "labels").iterdir())
            self.assertEqual([p.name for p in scans], [f"{k:06d}.bin" for k in range(10)])
            self.assertEqual([p.stem for p in labels], [p.stem for p in scans])
            for scan, label in zip(scans, labels):
                points = np.fromfile(scan, dtype=np.float32).reshape((-1, 4))
                words = np.fromfile(label, dtype=np.uint32).reshape(-1)
                self.assertEqual(len(points), len(words))
                self.assertTrue(np.isfinite(points).all() and (points[:, 3] >= 0).all() and (points[:, 3] <= 1).all())
                classes, instance = words & 0xFFFF, words >> 16
                np.testing.assert_array_equal(classes + (instance << 16), words)
                self.assertLessEqual(set(classes), {0, 50, 72, 99, 252})
                instances |= set(instance[classes == 99])
                subset = np.fromfile(sequence / "subsets" / f"{scan.stem}.subset", np.uint8)
                self.assertTrue(len(subset) == len(points) and subset.max(initial=0) < len(SUBSETS))
            poses = np.loadtxt(sequence / "poses.txt").reshape(10, 3, 4)
            # Yaw 30 degrees, clockwise: forward is (sin 30, cos 30, 0).
            forward, right = np.array((0.5, np.sqrt(0.75), 0)), np.array((np.sqrt(0.75), -0.5, 0))
            np.testing.assert_allclose(poses, np.tile(np.column_stack([forward, -right, (0, 0, 1), (5, -8, 3)]), (10, 1, 1)),
                                       atol=1e-8)
            self.assertEqual(len((sequence / "times.txt").read_text().split()), 10)
            self.assertRegex((sequence / "calib.txt").read_text(), r"(?m)^Tr: 1 0 0 0 0 1 0 0 0 0 1 0$")
        self.assertLessEqual(instances, set(range(10001, 10031)))
        self.assertGreater(len(instances), 10)

    def test_truth_has_a_row_for_every_bird_and_scan(self):
        rows = truth_of(self.out)
        self.assertEqual(len(rows), 40 * 30)
        self.assertEqual(tuple(rows[0]), TRUTH)
        self.assertEqual({(int(r["scan"]), int(r["bird"])) for r in rows},
                         {(k, 10000 + b) for k in range(40) for b in range(30)})
        self.assertLessEqual({r["status"] for r in rows}, set(STATUSES))
        self.assertEqual({r["species"] for r in rows}, {"herring gull", "crow"})
        for r in rows:
            self.assertEqual(r["status"] == "seen", int(r["points"]) > 0)
            self.assertAlmostEqual(np.linalg.norm([float(r["x_m"]) - 5, float(r["y_m"]) + 8, float(r["z_m"]) - 3]) - float(r["range_m"]),
                                   0, delta=1e-3)
        # The points of a bird are those of its instance, and lie where it is.
        pose, points_of_birds = np.loadtxt(self.out / "sequences" / "00" / "poses.txt")[0].reshape(3, 4), 0
        places = {(int(r["scan"]), int(r["bird"])): [np.array([float(r[when + c]) for c in ("x_m", "y_m", "z_m")])
                                                     for when in ("", "first_", "last_")] for r in rows if r["x_m"]}
        for number in range(4):
            counts = {}
            for k, label in enumerate(sorted((self.out / "sequences" / f"{number:02d}" / "labels").iterdir())):
                words = np.fromfile(label, np.uint32)
                for instance, count in zip(*np.unique(words[words & 0xFFFF == 99] >> 16, return_counts=True)):
                    counts[10 * number + k, int(instance) - 1] = int(count)
                points = np.fromfile(label.parent.parent / "velodyne" / f"{label.stem}.bin", np.float32).reshape(-1, 4)[:, :3]
                for point, word in zip(points @ pose[:, :3].T + pose[:, 3], words):
                    if word & 0xFFFF == 99:  # within the beam, a range unit, and the bird's way between beams
                        # ... which are at one place, or at both ends of a whole revolution
                        here = places[10 * number + k, int(word >> 16) - 1]
                        away = min(np.linalg.norm(point - place) for place in here)
                        self.assertLess(away, 0.01 * np.linalg.norm(point) + 2.5)
                        points_of_birds += 1
            here = {(int(r["scan"]), int(r["bird"])): int(r["points"]) for r in rows if int(r["scan"]) // 10 == number}
            self.assertEqual(counts, {key: count for key, count in here.items() if count})
        self.assertGreater(points_of_birds, 100)
        for r in rows:
            if r["x_m"]:
                times = [float(r[name]) for name in ("first_time_s", "time_s", "last_time_s")]
                self.assertEqual(times, sorted(times))
                self.assertLess(times[2] - times[0], 2.0)
        self.assertTrue(any(r["x_m"] and float(r["last_time_s"]) - float(r["first_time_s"]) > 1.9 for r in rows))

    def test_the_configuration_counts_every_class(self):
        check_configuration(self, self.out, 99)
        # Without the points, which differ, it is the one that is shipped.
        shipped = EXAMPLE / "semantic-kitti.yaml"
        scenario = json.loads((EXAMPLE / "hongqiao.scenario.json").read_text())
        points = {99: 1, 252: 3}
        made = yaml.safe_load(_labels.configuration(99, points, range(-(-scenario["number_of_scans"] // scenario["scans_per_sequence"]))))
        self.assertEqual([made["content"][k] for k in (99, 252, 0)], [0.25, 0.75, 0])
        shipped = yaml.safe_load(shipped.read_text())
        self.assertAlmostEqual(sum(shipped.pop("content").values()), 1, delta=1e-6)
        del made["content"]
        self.assertEqual(shipped, made)

    def test_birds_may_have_another_label(self):
        for bird in (259, 300):
            out = emptied("sequence", f"birds-{bird}")
            al.Sequence(self.file, threads=1, number_of_scans=10, bird_class=bird).write(out)
            check_configuration(self, out, bird)
            self.assertRegex((out / "datasheet.md").read_text(), rf"\| {bird} \| .*birds.* \| \d+")
        with self.assertRaisesRegex(al.Error, r"bird_class is 50, expected no label of what stands still \(building\)"):
            al.Sequence(self.file, bird_class=50)
        with self.assertRaisesRegex(al.Error, "bird_class: 0 is less than the minimum of 1"):
            al.Sequence(self.file, bird_class=0)

    def test_birds_are_seen_as_often_as_expected(self):
        rows = [r for r in truth_of(self.out) if r["subset"] == "sky" and r["expected_probability"]]
        p = np.array([float(r["expected_probability"]) for r in rows])
        seen = np.array([r["status"] == "seen" for r in rows])
        self.assertGreater(((p > 0.05) & (p < 0.95)).sum(), 20)
        self.assertLess(abs(seen.sum() - p.sum()), 3 * np.sqrt((p * (1 - p)).sum() + 1))
        clear = p > 0.999
        self.assertGreater(seen[clear].mean(), 0.99)

    def test_the_manifest_makes_the_same_bits(self):
        again = self.home / "again"
        manifest = al.Sequence(self.out / "manifest.json", threads=2).write(again)
        self.assertEqual(json.loads((self.out / "manifest.json").read_text())["sequences"], manifest["sequences"])
        for name, content in manifest["sequences"].items():
            digest = hashlib.sha256()
            where = again / "sequences" / name
            for path in sorted(p for p in where.rglob("*") if p.is_file() and p.name != "done.json"):
                digest.update(str(path.relative_to(where)).encode() + b"\0" + path.read_bytes())
            self.assertEqual(digest.hexdigest(), content["sha256"])
        self.assertIn("assumed", (again / "datasheet.md").read_text().lower())
        self.assertRegex((again / "datasheet.md").read_text(), r"\| 99 \| bird: birds \| \d+")

    def test_what_is_there_is_not_made_again_nor_overwritten_by_another_scenario(self):
        before = {p: p.stat().st_mtime_ns for p in self.out.rglob("*.bin")}
        al.Sequence(self.file).write(self.out)
        self.assertEqual(before, {p: p.stat().st_mtime_ns for p in self.out.rglob("*.bin")})
        with self.assertRaisesRegex(al.Error, "00 is of another scenario"):
            al.Sequence(self.file, seed=6).write(self.out)
        out = self.home / "shorter"  # another scene is another scenario
        shutil.copytree(self.out, out)
        house = self.home / "house.stl"
        kept = house.read_bytes()
        house.write_bytes(kept.replace(b" 12\n", b" 13\n").replace(b" 12 ", b" 13 "))
        self.assertNotEqual(house.read_bytes(), kept)
        with self.assertRaisesRegex(al.Error, "00 is of another scenario, scene or version"):
            al.Sequence(self.file).write(out)
        house.write_bytes(kept)

    def test_observers_are_added_once_for_all_scans(self):
        """VTK looks through all observers that there ever were when one is removed."""
        added, observe = [], _pipeline._Listener._observe

        def count(listener, caller, event, heard):
            added.append(event)
            observe(listener, caller, event, heard)
        numbers = []
        for scans in (2, 5):
            sequence = al.Sequence(self.file, threads=1, number_of_scans=scans, birds=[])
            added.clear()
            with unittest.mock.patch.object(_pipeline._Listener, "_observe", count):
                sequence.write(emptied("sequence", "observers"))
            numbers.append(len(added))
        self.assertGreater(numbers[0], 0)
        self.assertEqual(*numbers)

    def test_goes_on_after_kills(self):
        wanted = {name: part["sha256"] for name, part in self.manifest["sequences"].items()}
        out = self.home / "killed"
        for number in (1, 3):
            job = subprocess.Popen(command("sequence", self.file, "-o", out), stderr=subprocess.DEVNULL)
            end = time.monotonic() + 120
            while job.poll() is None and time.monotonic() < end and len(list(out.glob("sequences/[0-9]*"))) < number:
                time.sleep(0.02)
            time.sleep(0.1)
            job.send_signal(signal.SIGKILL)
            job.wait()
            for whole in out.glob("sequences/[0-9]*"):
                self.assertEqual(json.loads((whole / "done.json").read_text())["sha256"], wanted[whole.name])
            self.assertFalse((out / "manifest.json").exists() and number == 1)
        done = subprocess.run(command("sequence", self.file, "-o", out), capture_output=True, text=True, check=True)
        self.assertRegex(done.stdout, "40 scans in 4 sequences")
        self.assertEqual({name: part["sha256"] for name, part in
                          json.loads((out / "manifest.json").read_text())["sequences"].items()}, wanted)
        self.assertEqual(list(out.glob("sequences/.*")), [])


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
                source = vtkAvianLidarBirdSource()
                source.SetObjectId(50 + k)
                source.SetReflectance(0.3 if k in light else 0.0)
                source.SetHeading(40.0 * k)
                source.Update()
                # Within a range unit of the wall, where owners compete.
                gulls.append(al.mover(source.GetOutput(), [(-15 + 6 * k, 199.4 - 0.1 * k, 3 + 2 * k)]))
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
            echoes = {"beam_id": np.array([7, 3, 3, 9]), "distance_m": np.array([50.0, 200.0, 100.0, 10.0]), "energy_received": np.ones(4),
                      "object_id": np.array([0, 5, -1, -2])}  # the last is of the air
        distance, subset = Clutter(Still, 15.0).look([3, 3, 3, 3, 7, 9], [90.0, 120.0, 80.0, 190.0, 50.0, 10.0])
        np.testing.assert_array_equal(distance, [10, 20, 20, 10, 0, np.inf])
        self.assertEqual([SUBSETS[k] for k in subset],
                         ["near_clutter", "through_edges", "near_clutter", "through_edges", "near_clutter", "sky"])


class Shipped(unittest.TestCase):
    def test_clutter_is_neither_too_easy_nor_hopeless(self):
        """The clutter filter that knows the whole sequence, on 60 scans of the shipped scenario."""
        example = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "sequence"
        sys.path.insert(0, str(example))
        import clutter
        out = emptied("sequence", "shipped")
        al.Sequence(example / "hongqiao.scenario.json", number_of_scans=60, scans_per_sequence=60).write(out)
        files = [sorted((out / "sequences" / "00" / "velodyne").glob("*.bin"))]
        for share in (0.05, 0.2):
            found = sum(dict(clutter.measure(files, {"ClutterThreshold": share}))["all scans of its sequence"][0])
            for subset in ("near_clutter", "through_edges"):
                hit, false, missed = found[clutter.SUBSETS.index(subset.replace("_", " ")), 0]
                score = hit / (hit + false + missed)
                self.assertTrue(0.05 < score < 0.9, (share, subset, score))
        rows = truth_of(out)
        self.assertEqual({row["subset"] for row in rows if row["status"] == "seen"}, set(SUBSETS))

    def test_the_picture_has_all_points(self):
        sys.path.insert(0, str(pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "sequence"))
        import labels
        out = emptied("sequence", "labels")
        counts = labels.main(["--scans", "2", "--out", str(out)])
        written = [np.fromfile(file, "<u4") & 0xffff for file in (out / "sequences").glob("sequences/*/labels/*.label")]
        self.assertEqual(len(written), 2)
        self.assertEqual(counts, dict(zip(*(values.tolist() for values in np.unique(np.concatenate(written), return_counts=True)))))
        self.assertGreater(counts[99], 50)
        self.assertGreater((out / "labels.png").stat().st_size, 10000)


class BadScenarios(unittest.TestCase):
    def test_are_said_in_one_line(self):
        home = emptied("sequence", "bad")
        bird = {"pattern": "Crossings", "number_of_birds": 3}
        for words, changes in {
                "number_of_scans: 0 is less than the minimum of 1": {"number_of_scans": 0},
                "birds[0].pattern: 'Swarm' is not one of": {"birds": [{"pattern": "Swarm"}]},
                "birds[0].number_of_birds: -1 is less than": {"birds": [{**bird, "number_of_birds": -1}]},
                "'scene' is a required property": {"scene": None},
                "'speed' was unexpected": {"speed": 3},
                "Species is 'dodo'": {"birds": [{**bird, "species": "dodo"}]},
                "property 'radios' is not known; did you mean 'radius'?": {"birds": [{**bird, "radios": 3}]},
                "birds[0].first_object_id: is not to be given here": {"birds": [{**bird, "first_object_id": 7}]},
                "objects[0].route: two points that follow each other are the same":
                    {"objects": [{**BOX, "route": [[0, 1, 2], [0, 1, 2]]}]},
                "objects[0]: is under way from 1e+12 s": {"objects": [{**BOX, "first": 1e12}]},
                "objects[0].every: more than 9000 objects": {"objects": [{**BOX, "every": 1e-4}]},
                "property 'sway' is not known": {"sensor": {"preset": "Search905", "orientation": [30.0, 0.0, 0.0], "sway": 1}},
                "there is no.lidarscene.json": {"scene": "there is no.lidarscene.json"}}.items():
            file = scenario_file(home, **changes)
            if changes.get("scene", "") is None:
                scenario = json.loads(file.read_text())
                del scenario["scene"]
                file.write_text(json.dumps(scenario))
            done = subprocess.run(command("sequence", file, "-o", home / "out"), capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2, (words, done.stderr))
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for text, words in (("{", "is no JSON"), (None, "cannot be read")):
            file = home / "other.json"
            file.unlink(missing_ok=True)
            if text:
                file.write_text(text)
            done = subprocess.run(command("sequence", file, "-o", home / "out"), capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)


class Command(unittest.TestCase):
    def test_scan_writes_a_file(self):
        home = emptied("sequence", "command")
        scenario_file(home)
        for name in ("echoes.csv", "echoes.vtp", "echoes.bin"):
            done = subprocess.run(command("scan", home / "small.lidarscene.json", "--sensor", "Search905", "--sensor-set",
                                          "azimuth_step=1", "--scan-set", "noise=off", "-o", home / name),
                                  capture_output=True, text=True, check=True)
            self.assertRegex(done.stdout, r"echoes of 5760 beams")
            self.assertTrue((home / name).exists())
        self.assertGreater(al.load_cloud(home / "echoes.vtp").number_of_points, 0)

    def test_settings_of_a_sequence_are_those_of_a_changed_scenario(self):
        home = emptied("sequence", "settings")
        file = scenario_file(home, number_of_scans=2, scans_per_sequence=2, objects=[])
        done = subprocess.run(command("sequence", file, "-o", home / "told", "--sensor-set", "sway_amplitude=0", "--sensor-set",
                                      "encoder_jitter=0", "--scan-set", "rays_per_beam=50"),
                              capture_output=True, text=True, check=True)
        self.assertIn("2 scans in 1 sequences", done.stdout)
        manifest = json.loads((home / "told" / "manifest.json").read_text())
        whole = manifest["scenario"]
        self.assertEqual([whole["sensor"]["sway_amplitude"], whole["sensor"]["encoder_jitter"]], [0, 0])
        self.assertEqual(whole["scan"], {**SCENARIO["scan"], "rays_per_beam": 50})
        again = al.Sequence(home / "told" / "manifest.json", threads=1).write(home / "again")
        self.assertEqual(again["sequences"], manifest["sequences"])

    def test_errors_are_one_line_with_status_2(self):
        for arguments, words in ((["scan", "none.lidarscene.json", "-o", "x.vtp"], "none.lidarscene.json"),
                                 (["scan"], "required"), (["fly"], "invalid choice"),
                                 (["scan", "x.stl", "-o", "x.vtp"], "no such file: x.stl")):
            done = subprocess.run(command(*arguments), capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1)

    def test_help_has_examples(self):
        launcher = next(folder / "bin" / "avianlidar" for folder in pathlib.Path(al.__file__).resolve().parents
                        if (folder / "bin" / "avianlidar").exists())
        bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        for arguments, environment in ((command("--help"), None), ([str(launcher), "--help"], bare)):
            done = subprocess.run(arguments, capture_output=True, text=True, check=True, env=environment)
            self.assertRegex(done.stdout, "examples:\n  avianlidar scan")


if __name__ == "__main__":
    unittest.main()
