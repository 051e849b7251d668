# SPDX-License-Identifier: BSD-3-Clause
"""Labels cannot be read off what no receiver shows: who knows range, azimuth, elevation and amplitude of a point learns
nothing more about what it is from the place within its range unit, its place in the file, numbers that return in other
scans, or the last digits of numbers.

Points of two kinds are paired so that range and amplitude are alike, as these alone tell most points apart and would
hide a leak. Boosted trees are fitted to the four numbers, and to them and the cheat's; the gain is that of the area
under the curve (AUC), of points that the trees have not seen. Each post and each bird of a scan counts once where
places within the unit are compared, as its points share theirs. Skipped where scikit-learn is not installed."""
import json
import os
import pathlib
import sys
import unittest

import numpy as np

os.environ.setdefault("OMP_NUM_THREADS", "1")  # small trees: threads that wait for one another cost more than they gain
try:
    from scipy.spatial import cKDTree
    from sklearn.ensemble import HistGradientBoostingClassifier
    from sklearn.metrics import roc_auc_score
    from sklearn.model_selection import KFold
except ImportError:
    print("scikit-learn is not installed: skipped")
    sys.exit(77)

import avianlidar as al
import exampletools

OUTPUT = pathlib.Path(os.environ.get("AVIANLIDAR_TEST_OUTPUT_DIR", "/tmp")) / "no-leak"
MOST = 0.02     # gain of the AUC
FEWEST = 2000   # points of each kind
MANY = 60000    # that are enough to pair
UNIT = 299792458 * 5e-9 / 2  # m, of Search905
COLUMNS = 960   # of Search905
SHOWERS = {"preset": "Search905", "range_gate": 100, "false_alarms_per_scan": 100}
STILL = {"preset": "Search905", "range_gate": 850, "false_alarms_per_scan": 3000}
MOVED = {**STILL, "sway_amplitude": 0.02, "encoder_jitter": 0.01}
BIRDS = [{"pattern": "Crossings", "species": species, "number_of_birds": number, "radius": 800, "heights": [3, 70]}
         for species, number in (("herring gull", 30), ("crow", 150), ("starling", 500))]
SIDES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def posts(file, draw, number, ranges, sizes):
    """Small boxes all around the lidar (OBJ). @return their middles, m from the lidar"""
    distance = np.sqrt(draw.uniform(ranges[0]**2, ranges[1]**2, number))
    azimuth, height = 2 * np.pi * draw.random(number), distance * np.tan(np.radians(draw.uniform(-0.2, 5.8, number)))
    middles = np.column_stack([distance * np.sin(azimuth), distance * np.cos(azimuth), height])
    extents = sizes[0] * (sizes[1] / sizes[0])**draw.random((number, 1, 3))
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    points = (middles[:, None] + corners * extents).reshape(-1, 3)
    faces = (SIDES + 8 * np.arange(number)[:, None, None] + 1).reshape(-1, 4)
    file.write_text("".join(f"v {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in points)
                    + "".join(f"f {' '.join(map(str, face))}\n" for face in faces), "utf-8")
    return middles


def bits(values):
    """The bits of numbers in single precision."""
    return np.ascontiguousarray(values, "<f4").view("<u4").astype(np.int64)


def times(*columns):
    """How often the same numbers are there, at each of them."""
    _, inverse, counts = np.unique(np.stack(columns, 1), axis=0, return_inverse=True, return_counts=True)
    return counts[inverse.ravel()]


class Points:
    """Points of sequences that have a place each."""

    def __init__(self, folders):
        """@param folders (of a sequence, middles of its posts)"""
        parts = [self.read(folder, middles, first) for first, (folder, middles) in enumerate(folders)]
        self.scan, self.order, self.points, self.kind, self.owner = (np.concatenate(column) for column in zip(*parts))

    @staticmethod
    def read(folder, middles, first):
        columns = []
        for number, file in enumerate(sorted((folder / "sequences" / "00" / "velodyne").iterdir())):
            points = np.fromfile(file, "<f4").reshape(-1, 4)
            words = np.fromfile(folder / "sequences" / "00" / "labels" / f"{file.stem}.label", "<u4")
            x, y, z, _ = points.astype(float).T
            kind, nothing = words & 0xffff, np.arange(len(words)) + 10**6 * (number + 1)
            # The key is the id and the scan for a bird, the number for a post, and the point for other echoes.
            owner = np.where(kind == 99, (words >> 16) + 10**5 * (number + 1),
                             np.where(kind == 80, cKDTree(middles).query(np.column_stack([-y, x, z]))[1], nothing))
            columns.append((np.full(len(words), number + 100 * first), np.arange(len(words)), points, kind,
                            owner + 10**9 * first))
        return tuple(np.concatenate(column) for column in zip(*columns))

    def known(self):
        """Range (m), azimuth and elevation (deg), amplitude."""
        x, y, z, amplitude = self.points.astype(float).T
        return np.column_stack([np.sqrt(x * x + y * y + z * z), np.degrees(np.arctan2(-y, x)) % 360,
                                np.degrees(np.arctan2(z, np.hypot(x, y))), amplitude])

    def cheats(self):
        """What else a file has, by name."""
        distance, azimuth, elevation, amplitude = self.known().T
        place = distance / UNIT % 1
        column = np.rint(azimuth * (COLUMNS / 360))
        sorted_place = np.lexsort((distance, np.rint(elevation * 1000), column % COLUMNS, self.scan))
        rank = np.empty(len(distance), int)
        rank[sorted_place] = np.arange(len(distance))
        first = np.searchsorted(self.scan, self.scan)  # scans follow one another
        words = bits(self.points).reshape(-1, 4).T
        return {"range unit": np.column_stack([place, abs(place - 0.5)]),
                "order": np.column_stack([rank - first - self.order, self.order % 2, self.order % 16]),
                "repetition": np.column_stack([times(words[3]), times(*words[:3]), times(*words)]),
                "bits": np.column_stack([words.T & 255, np.log2(np.maximum(1, words & -words)).T]),
                "digits": np.column_stack([np.floor(value * 10**k) % 10
                                           for value, range_of in ((amplitude, range(4, 9)), (distance, range(1, 5)))
                                           for k in range_of]),
                "direction": np.column_stack([azimuth * (COLUMNS / 360) - column, elevation * 1000 % 1])}

    def once(self, kind, draw):
        """Points of a kind, one of each owner."""
        mine = draw.permutation(np.flatnonzero(self.kind == kind))
        return mine[np.unique(self.owner[mine], return_index=True)[1]]


def paired(known, one, other, draw, within=4.0):
    """Points of two kinds, each with one of the other kind of about the same range, amplitude and elevation."""
    scaled = np.column_stack([np.log(known[:, 0]) / 0.03, np.log(known[:, 3] + 1e-7) / 0.1, known[:, 2] / 2])
    one, other = sorted((draw.permutation(one)[:MANY], draw.permutation(other)[:MANY]), key=len)
    distance, nearest = cKDTree(scaled[other]).query(scaled[one], distance_upper_bound=within)
    near = np.isfinite(distance)
    found, first = np.unique(nearest[near], return_index=True)
    return one[near][first], other[found]


def area(features, truth):
    """Mean AUC of boosted trees on points that they have not seen."""
    areas = []
    for learned, asked in KFold(4, shuffle=True, random_state=0).split(features):
        trees = HistGradientBoostingClassifier(max_iter=50, max_leaf_nodes=8, min_samples_leaf=40, random_state=0)
        trees.fit(features[learned], truth[learned])
        areas.append(roc_auc_score(truth[asked], trees.predict_proba(features[asked])[:, 1]))
    return float(np.mean(areas))


def gains(points, pair):
    """(AUC of what is known, gain of each cheat and of all together by name)."""
    both, truth = np.concatenate(pair), np.repeat([0, 1], [len(part) for part in pair])
    known = points.known()[both]
    cheats = {name: values[both] for name, values in points.cheats().items()}
    least = area(known, truth)
    return least, {name: area(np.column_stack([known, values]), truth) - least
                   for name, values in {**cheats, "all": np.column_stack(list(cheats.values()))}.items()}


class NoLeak(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        exampletools.emptied("no-leak")
        cls.draw = np.random.default_rng(1)
        cls.fair = Points([cls.make(f"fair{k}", 2500, (80, 800), (0.04, 0.8), 3, sensor=sensor, seed=k, birds=BIRDS)
                           for k, sensor in enumerate((STILL, MOVED) * 3)])
        cls.rain = Points([cls.make("rain", 6000, (15, 95), (0.002, 0.015), 1, sensor=SHOWERS,
                                    scan={"rain_rate": 1.0})])

    @classmethod
    def make(cls, name, number, ranges, sizes, scans, sensor, scan=None, **changes):
        """A sequence among posts. @return its folder, the middles of the posts"""
        out = OUTPUT / name
        out.mkdir()
        middles = posts(out / "posts.obj", cls.draw, number, ranges, sizes)
        scene = {"version": 1, "lidar": {"position": [0, 0, 0]},
                 "objects": [{"name": "Posts", "class": "mast", "file": "posts.obj", "material": "Wall"}]}
        (out / "posts.lidarscene.json").write_text(json.dumps(scene), "utf-8")
        scan = {"attenuation_coefficient": 8.9e-5, "number_of_reflections": 1, **(scan or {})}
        al.Sequence({"scene": str(out / "posts.lidarscene.json"), "number_of_scans": scans, "sensor": sensor,
                     "scan": scan, **changes}).write(out)
        return out, middles

    def check(self, points, one, other):
        known = points.known()
        pair = paired(known, one, other, self.draw)
        self.assertGreaterEqual(len(pair[0]), FEWEST)
        least, found = gains(points, pair)
        print(f"{self.id().split('.')[-1]}: {len(pair[0])} points of each, AUC {least:.3f},",
              ", ".join(f"{name} {gain:+.3f}" for name, gain in found.items()))
        self.assertLess(least, 0.75)  # a leak would show
        self.assertLessEqual(max(found.values()), MOST, found)

    def test_birds_and_clutter(self):
        self.check(self.fair, self.fair.once(99, self.draw), self.fair.once(80, self.draw))

    def test_surfaces_and_false_alarms(self):
        self.check(self.fair, np.flatnonzero(np.isin(self.fair.kind, (80, 99))), np.flatnonzero(self.fair.kind == 0))

    def test_clutter_and_drops(self):
        self.check(self.rain, np.flatnonzero(self.rain.kind == 80), np.flatnonzero(self.rain.kind == 1))
