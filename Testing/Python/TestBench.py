# SPDX-License-Identifier: BSD-3-Clause
"""Predictions held against labels: counts by hand, thresholds and curves by brute force, tracks lost, files and their
errors."""
import itertools
import json
import math
import shutil
import unittest
import unittest.mock
import warnings

import numpy as np

import avianlidar as al
from avianlidar import _command
from avianlidar.apps.sequences import _bench
from avianlidar.apps.sequences._bench import Points, write_bench
from browser import Browser
from exampletools import emptied
from helpertools import rows_of

OUTPUT = emptied("bench")
BIRD, WALL, CAR = 99, 50, 252
SCANS = 6


def points(**columns):
    """Points of one scan, all clutter of the sky that nobody calls a bird, but for what is given."""
    count = len(next(iter(columns.values())))
    nothing = {"scan": np.zeros(count, int), "bird": np.zeros(count, bool), "other": np.zeros(count, bool),
               "instance": np.zeros(count, int), "subset": np.zeros(count, np.uint8), "range": np.full(count, 100.0),
               "called": np.zeros(count, bool), "score": None}
    return Points(**{**nothing, **{name: np.array(values) for name, values in columns.items()}})


def drawn(seed, count=400):
    """Scores with ties."""
    draw = np.random.default_rng(seed)
    bird, other = draw.random(count) < 0.2, draw.random(count) < 0.1
    return np.round(draw.normal(bird, 0.7), 1).astype(np.float32), bird & ~other, other


def write_set(home, bird_class=BIRD, sequences=2):
    """A small set with random points. @return labels by (sequence, scan)"""
    draw, found = np.random.default_rng(5), {}
    for number in range(sequences):
        folder = home / "sequences" / f"{number:02d}"
        for name in ("velodyne", "labels", "subsets"):
            (folder / name).mkdir(parents=True)
        for scan in range(SCANS):
            count = int(draw.integers(60, 90))
            kind = draw.choice([bird_class, WALL, CAR, 0], count, p=(0.3, 0.5, 0.1, 0.1))
            instance = np.where(kind == bird_class, 10001 + draw.integers(3, size=count), 1)
            name = f"{scan:06d}"
            draw.normal(0, 300, (count, 4)).astype("<f4").tofile(folder / "velodyne" / f"{name}.bin")
            (kind + (instance << 16)).astype("<u4").tofile(folder / "labels" / f"{name}.label")
            draw.integers(3, size=count).astype(np.uint8).tofile(folder / "subsets" / f"{name}.subset")
            found[f"{number:02d}", name] = kind
        (folder / "truth.csv").write_text("bird,species\n10000,crow\n10001,crow\n10002,starling\n", "utf-8")
    scenario = {"scene": "s.lidarscene.json", "sensor": {"preset": "Search905"}, "bird_class": bird_class,
                "weather": ["rain:2"]}
    (home / "manifest.json").write_text(
        json.dumps({"scenario": scenario, "sequences": {f"{k:02d}": {} for k in range(sequences)}}), "utf-8")
    return found


def write_predictions(home, labels, called, score=None):
    """@param called, score functions of the labels of a scan"""
    for (number, name), kind in labels.items():
        folder = home / "sequences" / number / "predictions"
        folder.mkdir(parents=True, exist_ok=True)
        called(kind).astype("<u4").tofile(folder / f"{name}.label")
        if score:
            score(kind).astype("<f4").tofile(folder / f"{name}.score")


class Scores(unittest.TestCase):
    def test_counts_by_hand(self):
        some = points(bird=[1, 1, 1, 0, 0, 0], other=[0, 0, 0, 0, 1, 1], called=[1, 1, 0, 1, 1, 0])
        some = some._replace(**{name: getattr(some, name).astype(bool) for name in ("bird", "other", "called")})
        found = _bench.scores(some, np.ones(6, bool), 2, ())
        self.assertEqual(found,
                         {"birds": 3.0, "recall": 2 / 3, "precision": 2 / 3, "iou": 2 / 4, "false": 0.5, "others": 0.5})

    def test_scores_without_bounds(self):
        """Points that all have the same infinite score are not told apart; nothing has no score."""
        bird, other = np.array([True, False, False, False]), np.zeros(4, bool)
        for value in (-np.inf, np.inf):
            rank = _bench.ranked(np.full(4, value, np.float32), bird, other)
            self.assertEqual((rank.birds.tolist(), rank.false.tolist()), ([1], [3]))
            self.assertTrue(np.isnan(_bench.threshold(rank, 1)))
            self.assertEqual(_bench.average_precision(rank), 0.25)
        rank = _bench.ranked(np.zeros(0, np.float32), np.zeros(0, bool), np.zeros(0, bool))
        for nothing in (_bench.average_precision(rank), _bench.curve(rank), _bench.threshold(rank, 1)):
            self.assertTrue(np.isnan(nothing).all())
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            mean, deviation = _bench._mean_curve([[math.nan, 1.0, 1.0], [math.nan, math.nan, 3.0]])
        np.testing.assert_array_equal(mean, [math.nan, 1, 2])
        np.testing.assert_allclose(deviation, [math.nan, math.nan, math.sqrt(2)])

    def test_threshold_by_brute_force(self):
        for seed, most in itertools.product(range(3), (0, 1, 40)):
            score, bird, other = drawn(seed)
            least = _bench.threshold(_bench.ranked(score, bird, other), most)
            fit = [value for value in np.unique(score) if np.count_nonzero((score >= value) & ~bird & ~other) <= most]
            # What lets the most birds through: the same birds, whatever stands between two scores.
            self.assertEqual(np.count_nonzero(bird & (score >= least)),
                             max((np.count_nonzero(bird & (score >= value)) for value in fit), default=0))

    def test_curve_and_average_precision_by_brute_force(self):
        for seed in range(3):
            score, bird, other = drawn(seed)
            rank, pairs = _bench.ranked(score, bird, other), []
            for value in np.unique(score[~other])[::-1]:
                hit = np.count_nonzero(bird & (score >= value))
                pairs.append((hit / bird.sum(), hit / np.count_nonzero(~other & (score >= value))))
            for recall, precision in zip(_bench.RECALLS, _bench.curve(rank)):
                self.assertAlmostEqual(precision, max(p for r, p in pairs if r >= recall - 1e-9))
            recalls, precisions = np.array([(0.0, 1.0), *pairs]).T
            # as scikit-learn defines it
            self.assertAlmostEqual(_bench.average_precision(rank), np.diff(recalls) @ precisions[1:])

    def test_tracks_lost(self):
        """A bird found in every second scan is not lost; one with three missed in a row is; one seen in two scans only
        is no track."""
        cases = {1: ((0, 1, 2, 3, 4, 5), (0, 2, 4)), 2: ((0, 1, 2, 3, 4), (0, 1)), 3: ((0, 1), ()),
                 4: ((0, 1, 3, 4), ()), 5: ((2, 3, 4), ())}
        rows = [(instance, scan, scan in found) for instance, (seen, found) in cases.items() for scan in seen]
        instance, scan, called = map(np.array, zip(*rows))
        some = points(instance=instance, scan=scan, called=called, bird=np.ones(len(scan), bool))
        self.assertEqual(_bench.lost(some), (3, 2))


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = OUTPUT / "set"
        cls.labels = write_set(cls.home)
        draw = np.random.default_rng(1)
        cls.noisy = {key: draw.normal(kind == BIRD, 0.5) for key, kind in cls.labels.items()}
        write_predictions(OUTPUT / "right", cls.labels, lambda kind: np.where(kind == BIRD, BIRD, 1),
                          lambda kind: kind == BIRD)
        write_predictions(OUTPUT / "all", cls.labels, lambda kind: np.full(len(kind), BIRD))
        scores = iter(cls.noisy.values())
        write_predictions(OUTPUT / "noisy", cls.labels, lambda kind: np.full(len(kind), BIRD + (7 << 16)),
                          lambda kind: next(scores))

    def test_right_predictions_have_all(self):
        scored = write_bench([self.home], [OUTPUT / "right"], OUTPUT / "out")[0][0]
        for score, value in {"recall_at_1": 1, "average_precision": 1, "iou": 1, "recall": 1, "precision": 1,
                             "false": 0, "lost": 0, "others": 0}.items():
            self.assertEqual(scored.value(("all", ""), score)[:2], (value, 0), score)

    def test_groups_hold_all_points(self):
        scored = write_bench([self.home], [OUTPUT / "all"], OUTPUT / "out")[0][0]
        birds = sum(int((kind == BIRD).sum()) for kind in self.labels.values())
        for by in ("all", "subset", "range", "species"):
            self.assertEqual(sum(scored.points(group) for group in scored.values if group[0] == by), birds, by)
        shares = [np.mean(np.concatenate([kind[kind != CAR] for (number, _), kind in self.labels.items() if number
                                          == one]) == BIRD) for one in ("00", "01")]
        self.assertAlmostEqual(scored.value(("all", ""), "precision").value, np.mean(shares))
        self.assertAlmostEqual(scored.value(("all", ""), "precision").error, np.std(shares, ddof=1) / np.sqrt(2))
        self.assertAlmostEqual(scored.value(("all", ""), "iou").value, np.mean(shares))
        self.assertEqual(scored.value(("all", ""), "others").value, 1)
        self.assertEqual(scored.value(("all", ""), "recall_at_1").number, 0)  # no scores

    def test_the_page_and_the_tables(self):
        out = OUTPUT / "page"
        by_name = [OUTPUT / "noisy", OUTPUT / "right"]
        self.assertIn(_command.main(["bench", str(self.home), "--predictions", *map(str, by_name), "--first", "2", "-o",
                                     str(out)]), (None, 0))
        page = (out / "bench.html").read_text()
        self.assertIn("The first 2 scans", page)
        self.assertEqual(page.count("data:image/png"), 1)
        with Browser() as browser:
            browser.open(out / "bench.html")
            browser.check_printed(self)
        rows = {(row["predictions"], row["by"], row["group"], row["score"]): row for row in rows_of(out / "bench.csv")}
        row = rows["noisy", "all", "", "recall at 1 false point a scan"]
        values = []
        for number in ("00", "01"):
            keys = [key for key in self.labels if key[0] == number and key[1] >= "000002"]
            kind, score = (np.concatenate([table[key] for key in keys]) for table in (self.labels, self.noisy))
            score = score.astype(np.float32)
            false = np.sort(score[(kind != BIRD) & (kind != CAR)])[::-1]
            values.append(np.mean(score[kind == BIRD] > false[SCANS - 2]))
        self.assertAlmostEqual(float(row["value"]), np.mean(values), places=5)
        self.assertEqual(int(row["sequences"]), 2)
        self.assertNotIn(("noisy", "species", "crow", "IoU"), rows)
        self.assertEqual(len(rows_of(out / "curves.csv")), 2 * len(_bench.RECALLS))

    def test_several_sets_and_another_class_of_birds(self):
        labels = write_set(OUTPUT / "second", bird_class=259, sequences=1)
        for name, found, bird in (("set", self.labels, BIRD), ("second", labels, 259)):
            write_predictions(OUTPUT / "both" / name, found, lambda kind, bird=bird: np.where(kind == bird, bird, 1))
        by_set = write_bench([self.home, OUTPUT / "second"], [OUTPUT / "both"], OUTPUT / "out", ["00"])
        self.assertEqual([(len(scored.values["all", ""]), scored.value(("all", ""), "iou").value)
                          for scored, in by_set], [(1, 1), (1, 1)])
        with self.assertRaisesRegex(al.Error, "right: holds no predictions for second"):
            write_bench([OUTPUT / "second", self.home], [OUTPUT / "right"], OUTPUT / "out")

    def test_leaves_no_new_folder_after_an_error(self):
        """The disk is full at the picture, after two tables."""
        out = OUTPUT / "full"
        with unittest.mock.patch.object(_bench.drawing, "draw", side_effect=OSError(28, "No space left on device")), \
                self.assertRaises(OSError):
            write_bench([self.home], [OUTPUT / "right"], out)
        self.assertFalse(out.exists())

    def test_bad_input(self):
        wrong = OUTPUT / "wrong"

        def spoilt(name, content):
            """Predictions with another file, or without it."""
            def make():
                file = wrong / "sequences" / "00" / "predictions" / name
                file.unlink() if content is None else file.write_bytes(content)
            return make
        damaged, lost = (shutil.copytree(self.home, OUTPUT / name / "set") for name in ("damaged", "lost"))
        (damaged / "sequences" / "00" / "done.json").write_text("{}", "utf-8")
        manifest = json.loads((lost / "manifest.json").read_text())
        manifest["sequences"]["00"] = {"sha256": "of a set that `avianlidar sequence` has made"}
        (lost / "manifest.json").write_text(json.dumps(manifest), "utf-8")
        for number, (key, value) in enumerate((("bird_class", "x"), ("weather", 5), ("sensor", 5), (None, 5))):
            other = OUTPUT / f"manifest{number}"
            other.mkdir(exist_ok=True)
            manifest = json.loads((self.home / "manifest.json").read_text())
            manifest["scenario"] = {**manifest["scenario"], key: value} if key else value
            (other / "manifest.json").write_text(json.dumps(manifest), "utf-8")
            with self.subTest(key), self.assertRaisesRegex(al.Error, f"manifest{number}/manifest.json: .*scenario"):
                write_bench([other], [OUTPUT / "right"], OUTPUT / "out-wrong")
        nan = np.full(len(self.labels["00", "000002"]), np.nan, "<f4").tobytes()
        for words, spoil, folder, options in (("its files differ from the sha256", None, damaged, {}),
                                              ("00/done.json: cannot be read", None, lost, {}),
                                              ("holds no manifest.json", None, OUTPUT / "right", {}),
                                              ("has no sequence 07", None, self.home, {"numbers": ["07"]}),
                                              ("no scan from number 6 on", None, self.home, {"first": 6}),
                                              ("000003.label: is missing", spoilt("000003.label", None), self.home, {}),
                                              ("000003.label: has 1 values", spoilt("000003.label", b"abcd"), self.home,
                                               {}), ("000002.score: has a score", spoilt("000002.score", nan),
                                                     self.home, {})):
            shutil.rmtree(wrong, ignore_errors=True)
            shutil.copytree(OUTPUT / "right", wrong)
            if spoil:
                spoil()
            with self.subTest(words), self.assertRaisesRegex(al.Error, words):
                write_bench([folder], [wrong], OUTPUT / "out-wrong", **options)
            self.assertFalse((OUTPUT / "out-wrong").exists())
        with self.assertRaisesRegex(al.Error, "two are called wrong"):
            write_bench([self.home], [wrong, wrong], OUTPUT / "out")


class Recorded(unittest.TestCase):
    def test_recorded_scans_have_the_scores_of_their_labels(self):
        """Without manifest, subsets and truth, and beside the simulated set."""
        simulated, recorded = OUTPUT / "both" / "simulated", OUTPUT / "both" / "recorded"
        labels = write_set(simulated)
        shutil.copytree(simulated, recorded)
        for path in (recorded / "manifest.json", *recorded.glob("sequences/*/truth.csv")):
            path.unlink()
        for path in recorded.glob("sequences/*/subsets"):
            shutil.rmtree(path)
        for name in ("simulated", "recorded"):
            write_predictions(OUTPUT / "both" / "mine" / name, labels, lambda kind: np.where(kind == WALL, 0, BIRD))
        found = write_bench([simulated, recorded], [OUTPUT / "both" / "mine"], OUTPUT / "both" / "out")
        one, two = (scored.values[_bench.ALL] for (scored,) in found)
        self.assertEqual(one, two)
        self.assertEqual([scored.set.weather for (scored,) in found], ["rain of 2 mm/h", "recorded"])
        text = (OUTPUT / "both" / "out" / "bench.html").read_text("utf-8")
        self.assertIn("recorded", text)
        with self.assertRaisesRegex(al.Error, "recorded scans in sequences/NN/velodyne and labels"):
            write_bench([OUTPUT / "both" / "out"], [OUTPUT / "both" / "mine"], OUTPUT / "both" / "no")
