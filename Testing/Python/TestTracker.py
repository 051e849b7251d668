# SPDX-License-Identifier: BSD-3-Clause
"""The tracker, scan by scan, against one of NumPy and SciPy, with the points of a cloud in any order; times of clouds,
what is forgotten, bad input. Turns, crossings and false tracks are TestTracker.cxx's (kernel), birds that a lidar scans
TestBirdTracks'."""

import unittest

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.stats
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject

from avianlidar.vtkAvianLidar import vtkAvianLidarTracker as Tracker

from cloudtools import add_array, add_field, cloud, field
from echotools import Messages, array as point_array, assert_same_bits, given

EXACT = {"ClusterDistance": 0.0, "ClusterAngle": 0.0, "HalfBeamwidth": 0.0}
STRAIGHT = {"MotionModel": Tracker.MOTION_CONSTANT_VELOCITY, "AccelerationDensity": 2.0}


def tracker(**settings):
    return given(Tracker(), **settings)


def feed(made, points, time=None, **arrays):
    """One cloud; what comes out: tracks, points."""
    data = cloud(points)
    if time is not None:
        data.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
    for name, values in arrays.items():
        add_array(data, name, np.asarray(values))
    made.SetInputData(data)
    made.Update()
    return made.GetOutput(0), made.GetOutput(1)


def cell_array(data, name):
    return vtk_to_numpy(data.GetCellData().GetArray(name))


class Oracle:
    """The same method in NumPy, without clusters, at times that are equal within a cloud."""

    def __init__(self, q=2.0, speed=25.0, climb=5.0, extent=0.2, error=0.5, p=0.99, hits=3, scans=4, misses=3):
        self.gate = scipy.stats.chi2.ppf(p, 3)
        self.first = scipy.linalg.block_diag(np.zeros((3, 3)), np.diag([speed, speed, climb]) ** 2 / self.gate)
        self.q, self.extent, self.error = q, extent, error
        self.hits, self.scans, self.misses = hits, scans, misses
        self.tracks, self.next = [], 0

    def noise(self, place):
        line = place / np.linalg.norm(place)
        return self.extent**2 * np.eye(3) + self.error**2 * np.outer(line, line)

    def predict(self, track, time):
        t = time - track["time"]
        f = np.kron([[1, t], [0, 1]], np.eye(3))
        noise = self.q * np.kron([[t**3 / 3, t**2 / 2], [t**2 / 2, t]], np.eye(3))
        return f @ track["mean"], f @ track["covariance"] @ f.T + noise

    def update(self, places, time):
        order = np.lexsort(places.T[::-1])
        ids = np.full(len(places), -1)
        states = [self.predict(track, time) for track in self.tracks]
        costs = np.full((len(states), len(places)), np.inf)
        largest = -np.inf
        for i, (mean, covariance) in enumerate(states):
            for j, place in enumerate(places):
                s = covariance[:3, :3] + self.noise(place)
                d2 = (place - mean[:3]) @ np.linalg.solve(s, place - mean[:3])
                if d2 <= self.gate:
                    log = np.linalg.slogdet(s)[1]
                    largest = max(largest, log)
                    costs[i, j] = d2 + log
        pairs = []
        if np.isfinite(costs).any():
            without = np.full((len(states), len(states)), 1e9)
            np.fill_diagonal(without, self.gate + largest)
            all_costs = np.hstack([np.where(np.isfinite(costs), costs, 1e9), without])
            pairs = [(i, j) for i, j in zip(*scipy.optimize.linear_sum_assignment(all_costs)) if j < len(places)]
        of = dict(pairs)
        for i, track in enumerate(self.tracks):
            track["recent"] = [*track["recent"], i in of][-self.scans:]
            if i not in of:
                track["misses"] += 1
                continue
            mean, covariance = states[i]
            gain = covariance[:, :3] @ np.linalg.inv(covariance[:3, :3] + self.noise(places[of[i]]))
            track["mean"] = mean + gain @ (places[of[i]] - mean[:3])
            track["covariance"] = covariance - gain @ covariance[:3]
            track.update(time=time, misses=0)
            track["confirmed"] |= sum(track["recent"]) >= self.hits
            ids[of[i]] = track["id"]
        self.tracks = [track for track in self.tracks
                       if track["misses"] < (self.misses if track["confirmed"] else self.scans - self.hits + 1)]
        for j in order:
            if ids[j] < 0:
                covariance = self.first + scipy.linalg.block_diag(self.noise(places[j]), np.zeros((3, 3)))
                self.tracks.append({"id": self.next, "mean": np.append(places[j], [0, 0, 0]), "covariance": covariance,
                                    "time": time, "misses": 0, "recent": [True], "confirmed": False})
                ids[j] = self.next
                self.next += 1
        return ids


class TestTracker(unittest.TestCase):
    def test_against_numpy_and_scipy(self):
        """Crowded: many birds, of which some are missed, and false alarms, in each other's gates."""
        random = np.random.default_rng(4)
        start = random.uniform(-40, 40, (20, 3)) + [200, 0, 60]
        velocity = random.normal(0, [8, 8, 1], (20, 3))
        made, oracle = tracker(**EXACT, **STRAIGHT), Oracle()
        contested = 0
        for scan in range(10):
            time = 2.0 * scan
            birds = start + velocity * (time % 30)
            places = np.vstack([birds[random.random(20) < 0.8], random.uniform(-50, 50, (6, 3)) + [200, 0, 60]])
            places += random.normal(0, 0.3, places.shape)
            random.shuffle(places)
            tracks, points = feed(made, places, time)
            expected = oracle.update(places, time)
            np.testing.assert_array_equal(point_array(points, "track_id"), expected)
            alive = {track["id"]: track for track in oracle.tracks}
            ended = cell_array(tracks, "ended") > 0
            self.assertEqual(set(cell_array(tracks, "track_id")[~ended]), set(alive))
            contested += len(expected)
            for cell in np.flatnonzero(~ended):
                track = alive[cell_array(tracks, "track_id")[cell]]
                last = tracks.GetCell(cell).GetPointId(tracks.GetCell(cell).GetNumberOfPoints() - 1)
                np.testing.assert_allclose(tracks.GetPoint(last), track["mean"][:3], rtol=1e-9)
                np.testing.assert_allclose(point_array(tracks, "velocity")[last], track["mean"][3:], rtol=1e-7,
                                           atol=1e-9)
                xx, yy, zz, xy, yz, xz = point_array(tracks, "position_covariance")[last]
                np.testing.assert_allclose([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], track["covariance"][:3, :3],
                                           rtol=1e-7, atol=1e-12)
                self.assertEqual(point_array(tracks, "time")[last], track["time"])
                self.assertEqual(bool(cell_array(tracks, "confirmed")[cell]), track["confirmed"])
        self.assertGreater(contested, 170)
        self.assertGreater(oracle.next, 40)

    def test_arrays_and_fields(self):
        made = tracker(ConfirmHits=2, ConfirmScans=2, SensorPosition=(0, 0, 10), AccelerationDensity=0.1)
        first = [(100, 0, 50), (100.5, 0.2, 50), (300, 300, 60), (0, 500, 5)]
        feed(made, first, 10.0, is_clutter=[0, 0, 0, 1])
        tracks, points = feed(made, np.add(first, (0, 20, 0)), 12.0, is_clutter=[0, 0, 0, 1])
        self.assertEqual(list(point_array(points, "track_id")), [0, 0, 1, -1])
        self.assertEqual(list(point_array(points, "track_confirmed")), [1, 1, 1, 0])
        self.assertEqual([tracks.GetNumberOfVerts(), tracks.GetNumberOfLines()], [0, 2])
        self.assertEqual(list(cell_array(tracks, "hits")), [2, 2])
        self.assertEqual(list(point_array(tracks, "number_of_echoes")), [2, 2, 1, 1])
        self.assertEqual(list(point_array(tracks, "time")), [10, 12, 10, 12])
        np.testing.assert_allclose(point_array(tracks, "velocity")[1], [0, 10, 0], atol=0.2)
        for data in (tracks, points):
            self.assertEqual(field(data, "time"), [12.0])
            self.assertEqual(field(data, "confirm_hits"), [2])
            self.assertEqual(field(data, "sensor_position"), [0, 0, 10])
            self.assertEqual(data.GetInformation().Get(vtkDataObject.DATA_TIME_STEP()), 12.0)
        data = cloud(first)
        add_field(data, "position", (0.0, 0.0, 3.0))
        add_field(data, "half_beamwidth", (0.001,))
        add_field(data, "TimeValue", (14.0,))
        made.SetInputData(data)
        made.Update()
        self.assertEqual(field(made.GetOutput(0), "sensor_position"), [0, 0, 3])
        self.assertEqual(field(made.GetOutput(0), "half_beamwidth"), [0.001])
        self.assertEqual(field(made.GetOutput(0), "time"), [14.0])

    def test_a_cloud_of_the_same_time_replaces_the_last(self):
        random = np.random.default_rng(1)
        clouds = [random.uniform(0, 100, (20, 3)) for _ in range(4)]
        once, often = tracker(), tracker()
        for time, points in enumerate(clouds):
            feed(once, points, float(time))
            feed(often, random.uniform(0, 100, (30, 3)), float(time))
            often.SetMaximumSpeed(3.0)
            often.Update()
            often.SetMaximumSpeed(25.0)
            feed(often, points, float(time))
        for port in (0, 1):
            assert_same_bits(once.GetOutput(port), often.GetOutput(port))

    def test_times(self):
        made = tracker()
        messages = Messages(made)
        for expected in (0.0, 1.0, 2.0):  # no time: one after the other
            tracks, _ = feed(made, [(100, 0, 10)])
            self.assertEqual(field(tracks, "time"), [expected])
        made.SetMaximumSpeed(20.0)
        made.Update()  # the same data
        self.assertEqual(list(cell_array(made.GetOutput(0), "hits")), [3])
        self.assertEqual(messages.all(), [])
        tracks, _ = feed(made, [(100, 0, 10)], 1.0)
        self.assertEqual(len(messages.all()), 1)
        self.assertIn("earlier time", messages.all()[0])
        self.assertEqual([list(cell_array(tracks, name)) for name in ("hits", "track_id")], [[1], [0]])
        made.Reset()
        tracks, _ = feed(made, [(100, 0, 10)], 0.0)
        self.assertEqual(list(cell_array(tracks, "hits")), [1])
        self.assertEqual(len(messages.all()), 1)

    def test_timestamps(self):
        made = tracker(**EXACT, AccelerationDensity=0.1)
        messages = Messages(made)
        feed(made, [(100, 0, 10), (0, 100, 10)], 0.0, timestamp=[0.1e6, 1.5e6])
        tracks, _ = feed(made, [(100, 2, 10), (2, 100, 10)], 2.0, timestamp=[2.1e6, 3.5e6])
        self.assertEqual(list(point_array(tracks, "time")), [1.5, 3.5, 0.1, 2.1])
        np.testing.assert_allclose(point_array(tracks, "velocity")[1], [1, 0, 0], atol=0.02)
        self.assertEqual(messages.all(), [])
        for time in (4.0, 6.0):  # as if the clock began anew
            tracks, _ = feed(made, [(100, 2, 10), (2, 100, 10)], time, timestamp=[0.1e6, 1.5e6])
            self.assertEqual(len(messages.all()), 1)
            self.assertIn("timestamp", messages.all()[0])
        self.assertEqual(list(point_array(tracks, "time")), [1.5, 3.5, 4, 6, 0.1, 2.1, 4, 6])

    def test_a_pause_ends_tracks(self):
        for pause, ids in ((29.0, [0]), (31.0, [0, 1])):
            made = tracker(KeepTime=1e9)
            for scan in range(4):
                feed(made, [(100, 10 * scan, 10)], 2.0 * scan)
            tracks, points = feed(made, [(100, 60, 10)], 6.0 + pause)
            self.assertEqual(sorted(cell_array(tracks, "track_id")), ids)
            self.assertEqual(int(point_array(points, "track_id")[0]), ids[-1])

    def test_bad_input(self):
        """An error names what is wrong, and the memory stays. Numbers out of range are TestBadInput's."""
        made = tracker()
        feed(made, [(100, 0, 10)], 0.0)
        messages = Messages(made)

        def fails(words, points=((100, 0, 10),), time=1.0, **arrays):
            with self.subTest(words):
                messages.errors.clear()
                tracks, _ = feed(made, points, time, **arrays)
                self.assertEqual(len(messages.all()), 1)
                self.assertIn(words, messages.all()[0])
                self.assertIn(words, tracks.GetFieldData().GetAbstractArray("error").GetValue(0))
        fails("point 0", [(1e10, 0, 0)])
        fails("point 1", [(0, 1, 0), (float("nan"), 0, 0)])
        for name, values in (("distance_std_error", [-1.0]), ("timestamp", [float("inf")]), ("is_clutter", [0, 1])):
            fails(name, **{name: values})
        fails("time", time=float("nan"))
        tracks, _ = feed(made, [(100, 0, 10)], 1.0)
        self.assertEqual(list(cell_array(tracks, "hits")), [2])

    def test_an_empty_cloud_is_a_scan(self):
        made = tracker(MaximumMisses=2)
        for scan in range(4):
            feed(made, [(100, 10 * scan, 10)], float(scan))
        for scan, ended in ((4, 0), (5, 1), (6, 1)):
            tracks, points = feed(made, np.empty((0, 3)), float(scan))
            self.assertEqual(list(cell_array(tracks, "ended")), [ended])
            self.assertEqual(points.GetNumberOfPoints(), 0)

    def test_slow_tracks_are_not_confirmed(self):
        for least, sure in ((9.5, 1), (10.5, 0)):
            made = tracker(MinimumSpeed=least)
            for scan in range(20):
                tracks, _ = feed(made, [(100, 10 * scan, 10)], float(scan))
            self.assertEqual(list(cell_array(tracks, "confirmed")), [sure])
