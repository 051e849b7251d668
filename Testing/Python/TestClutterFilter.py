# SPDX-License-Identifier: BSD-3-Clause
"""The clutter filter on scans made by hand: persistence in closed form and point by point in NumPy, tolerances, time, tables,
real frames, bad input."""

import os
import pathlib
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

from avianlidar import vtkAvianLidar as al
from echotools import Messages, box, scan, sensor

WINDOW = 20.0


def place(azimuth, elevation, distance):
    """Points at azimuths (degrees clockwise from y), elevations and ranges."""
    a, e, r = (np.asarray(values, float) for values in np.broadcast_arrays(np.radians(azimuth), np.radians(elevation), distance))
    return np.stack([r * np.cos(e) * np.sin(a), r * np.cos(e) * np.cos(a), r * np.sin(e)], axis=-1).reshape(-1, 3)


def cloud(points, time=None, kind=vtkPolyData, **fields):
    data = kind()
    holder = vtkPoints()
    holder.SetData(numpy_to_vtk(np.ascontiguousarray(points, float).reshape(-1, 3), deep=1))
    data.SetPoints(holder)
    if time is not None:
        data.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
    for name, value in fields.items():
        array = numpy_to_vtk(np.atleast_2d(np.asarray(value, float)), deep=1)
        array.SetName(name)
        data.GetFieldData().AddArray(array)
    return data


class Stream:
    """A filter that is given one cloud after the other."""

    def __init__(self, table=None, **settings):
        self.filter = al.vtkAvianLidarClutterFilter()
        for name, value in {"Window": WINDOW, "WarmUp": 0, **settings}.items():
            getattr(self.filter, "Set" + name)(value)
        if table is not None:
            self.filter.SetInputDataObject(1, table)
        self.messages = Messages(self.filter)

    def give(self, data):
        """clutter_probability and is_clutter of a cloud."""
        self.filter.SetInputDataObject(0, data)
        self.filter.Update()
        return self.result()

    def result(self):
        points = self.filter.GetOutputDataObject(0).GetPointData()
        return tuple(vtk_to_numpy(points.GetArray(name)).copy() for name in ("clutter_probability", "is_clutter"))

    def field(self, name):
        return self.filter.GetOutputDataObject(0).GetFieldData().GetArray(name).GetTuple(0)

    def learned(self):
        return int(self.field("learned_scans")[0])

    def table(self):
        data = vtkPolyData()
        data.DeepCopy(self.filter.GetOutputDataObject(1))
        return data

    def cells(self):
        points = self.filter.GetOutputDataObject(1).GetPointData()
        return vtk_to_numpy(points.GetArray("clutter_cell")), vtk_to_numpy(points.GetArray("clutter_probability"))


def share(hits, window=WINDOW):
    """Persistence of a cell: `hits` says for each scan, the last one last, if it had an echo."""
    weights = (1 - 1 / window) ** np.arange(len(hits))[::-1]
    return float((weights * hits).sum() / weights.sum())


def random_scan(rng, count=300):
    """Walls that jitter, and points anywhere."""
    azimuths = rng.integers(0, 60, count) * 0.375
    return place(np.concatenate([azimuths, rng.uniform(0, 360, 40)]),
                 np.concatenate([rng.integers(0, 4, count) * 0.375, rng.uniform(-10, 80, 40)]),
                 np.concatenate([50 + azimuths + rng.normal(0, 0.5, count), rng.uniform(1, 500, 40)]))


def brute_force(scans, window, steps, tolerances):
    """The probabilities of the last scan, by its definition."""
    def cells(points):
        x, y, z = points.T
        return np.stack([np.rint(np.degrees(np.arctan2(x, y)) / steps[1]).astype(int) % round(360 / steps[1]),
                         np.rint(np.degrees(np.arctan2(z, np.hypot(x, y))) / steps[2]).astype(int),
                         np.floor(np.sqrt((points ** 2).sum(axis=1)) / steps[0]).astype(int)], axis=1)
    known = {}
    for k, points in enumerate(scans[:-1]):
        for cell in set(map(tuple, cells(points))):
            known.setdefault(cell, np.zeros(len(scans) - 1))[k] = 1
    keys, values = np.array(list(known)), np.array([share(hits, window) for hits in known.values()])
    result = []
    for own in cells(scans[-1]):
        off = np.abs(keys - own)
        off[:, 0] = np.minimum(off[:, 0], round(360 / steps[1]) - off[:, 0])
        near = (off[:, 0] <= tolerances[1]) & (off[:, 1] <= tolerances[1]) & (off[:, 2] <= tolerances[0])
        result.append(values[near].max(initial=0))
    return np.array(result)


class Persistence(unittest.TestCase):
    def test_closed_forms(self):
        wall, door, bird = place(10, 1, 50), place(90, 0, 30), place(200, 3, 80)
        stream = Stream(ClutterThreshold=0.3)
        open_door = [k % 3 == 0 for k in range(30)]
        for k, shut in enumerate(open_door):
            here = np.concatenate([wall, door] if shut else [wall])
            found, _ = stream.give(cloud(here, time=2.0 * k))
            self.assertEqual(stream.learned(), k + 1)
            self.assertAlmostEqual(found[0], 1.0 if k else 0.0, 12)
            if shut:
                self.assertAlmostEqual(found[1], share(open_door[:k]) if k else 0.0, 12)
        found, clutter = stream.give(cloud(np.concatenate([wall, door, bird]), time=60.0))
        np.testing.assert_allclose(found, [1, share(open_door), 0], atol=1e-12)
        np.testing.assert_array_equal(clutter, found >= 0.3)
        self.assertEqual(stream.messages.all(), [])

    def test_point_by_point(self):
        for settings, steps, tolerances in (({}, (1.5, 0.375, 0.375), (1, 1)),
                                            ({"RangeTolerance": 0, "AngularTolerance": 0}, (1.5, 0.375, 0.375), (0, 0)),
                                            ({"RangeStep": 0.7, "AzimuthStep": 2.0, "ElevationStep": 1.0, "RangeTolerance": 3,
                                              "AngularTolerance": 2}, (0.7, 2.0, 1.0), (3, 2))):
            rng = np.random.default_rng(1)
            scans = [random_scan(rng) for _ in range(12)]
            stream = Stream(**settings)
            for k, points in enumerate(scans):
                found, _ = stream.give(cloud(points, time=k))
            np.testing.assert_allclose(found, brute_force(scans, WINDOW, steps, tolerances), atol=1e-12)
            if tolerances != (3, 2):
                self.assertGreater(np.count_nonzero((found > 0) & (found < 0.9)), 50)

    def test_tolerance(self):
        wall = place(100, 1.5, 50.25)  # in the middle of its cell of 1.5 m
        near = place([100, 100, 100, 100.375, 100, 100.375, 100.75], [1.5, 1.5, 1.5, 1.5, 1.875, 1.125, 1.5],
                     [50.25, 51.75, 53.25, 50.25, 50.25, 48.75, 50.25])
        for tolerances, expected in (((0, 0), [1, 0, 0, 0, 0, 0, 0]), ((1, 0), [1, 1, 0, 0, 0, 0, 0]),
                                     ((0, 1), [1, 0, 0, 1, 1, 0, 0]), ((1, 1), [1, 1, 0, 1, 1, 1, 0]),
                                     ((2, 2), [1, 1, 1, 1, 1, 1, 1])):
            stream = Stream(RangeTolerance=tolerances[0], AngularTolerance=tolerances[1])
            stream.give(cloud(wall, time=0))
            found, _ = stream.give(cloud(near, time=1))
            np.testing.assert_allclose(found, expected, atol=1e-12)

    def test_north(self):
        stream = Stream()
        stream.give(cloud(place(359.8, 0, 20), time=0))
        found, _ = stream.give(cloud(place([0.1, 359.5, 1.0], 0, 20), time=1))
        np.testing.assert_array_equal(found, [1, 1, 0])

    def test_order_of_points(self):
        rng = np.random.default_rng(2)
        one, other = Stream(), Stream()
        for k in range(8):
            points = random_scan(rng)
            order = rng.permutation(len(points))
            found, _ = one.give(cloud(points, time=k))
            shuffled, _ = other.give(cloud(points[order], time=k))
            self.assertEqual(found[order].tobytes(), shuffled.tobytes())
        for a, b in zip(one.cells(), other.cells()):
            self.assertEqual(a.tobytes(), b.tobytes())

    def test_warm_up(self):
        stream = Stream(WarmUp=3)
        for k in range(6):
            found, clutter = stream.give(cloud(place([0, 90 + 10 * k], 0, 20), time=k))
            self.assertEqual(found[1], 0)
            np.testing.assert_array_equal(clutter, [1, k < 3])

    def test_memory_is_bounded(self):
        stream = Stream(Window=5.0)
        for k in range(400):
            stream.give(cloud(place(np.arange(3) * 20, 0, 5 + 2 * k), time=k))
        cells, persistence = stream.cells()
        self.assertGreaterEqual(persistence.min(), 0.001)
        self.assertLess(len(cells), 3 * 30)

    def test_kinds_of_data(self):
        for kind in (vtkPolyData, vtkUnstructuredGrid):
            stream = Stream()
            data = cloud(place(0, 0, 20), time=0, kind=kind)
            stream.give(data)
            self.assertTrue(stream.filter.GetOutputDataObject(0).IsA(data.GetClassName()))

    def test_field_data(self):
        stream = Stream(WarmUp=7, SensorPosition=(1, 2, 3))
        stream.give(cloud(place(0, 0, 20) + (1, 2, 3), time=0))
        expected = {"clutter_window": 20, "clutter_threshold": 0.05, "clutter_range_step": 1.5, "clutter_azimuth_step": 0.375,
                    "clutter_elevation_step": 0.375, "clutter_range_tolerance": 1, "clutter_angular_tolerance": 1,
                    "clutter_warm_up": 7, "clutter_learning": 1, "learned_scans": 1}
        for port in (0, 1):
            fields = stream.filter.GetOutputDataObject(port).GetFieldData()
            self.assertEqual({name: fields.GetArray(name).GetTuple1(0) for name in expected}, expected)
            self.assertEqual(fields.GetArray("position").GetTuple3(0), (1, 2, 3))


class Time(unittest.TestCase):
    def test_the_same_time_replaces(self):
        stream = Stream()
        stream.give(cloud(place(0, 0, 20), time=0))
        stream.give(cloud(place(10, 0, 20), time=1))
        stream.give(cloud(place(20, 0, 20), time=1))  # instead
        stream.filter.SetClutterThreshold(0.5)
        stream.filter.Update()
        stream.filter.Modified()
        stream.filter.Update()
        self.assertEqual(stream.learned(), 2)
        found, _ = stream.give(cloud(place([0, 10, 20], 0, 20), time=2))
        np.testing.assert_allclose(found, [share([1, 0]), 0, share([0, 1])], atol=1e-12)
        self.assertEqual(stream.learned(), 3)

    def test_time_back(self):
        stream = Stream()
        for k in range(5):
            stream.give(cloud(place(0, 0, 20), time=k))
        found, _ = stream.give(cloud(place(0, 0, 20), time=2))
        self.assertEqual((found[0], stream.learned()), (0, 1))
        self.assertEqual([("goes back from 4 s to 2 s" in text) for text in stream.messages.all()], [True])
        found, _ = stream.give(cloud(place(0, 0, 20), time=3))
        self.assertEqual((found[0], stream.learned()), (1, 2))

    def test_times_of_other_kinds(self):
        stream = Stream()
        for k in range(3):
            stream.give(cloud(place(0, 0, 20), TimeValue=10 + k))
        self.assertEqual(stream.learned(), 3)
        stream = Stream()
        for k in range(3):  # without times: each is the next
            data = cloud(place(0, 0, 20))
            stream.give(data)
            stream.filter.Modified()
            stream.give(data)
        self.assertEqual(stream.learned(), 3)
        data.GetPoints().SetPoint(0, 0, 30, 0)
        data.GetPoints().Modified()
        stream.give(data)
        self.assertEqual(stream.learned(), 4)

    def test_what_empties_the_memory(self):
        for setter, value in (("RangeStep", 1.0), ("AzimuthStep", 0.2), ("ElevationStep", 0.2), ("Window", 30.0),
                              ("SensorPosition", (1, 0, 0)), ("Forget", None)):
            stream = Stream()
            for k in range(3):
                stream.give(cloud(place(0, 0, 20), time=k))
            stream.filter.Forget() if setter == "Forget" else getattr(stream.filter, "Set" + setter)(value)
            stream.filter.Update()
            self.assertEqual(stream.learned(), 1, setter)
        for setter, value in (("ClutterThreshold", 0.5), ("RangeTolerance", 3), ("AngularTolerance", 0), ("WarmUp", 9)):
            stream = Stream()
            for k in range(3):
                stream.give(cloud(place(0, 0, 20), time=k))
            getattr(stream.filter, "Set" + setter)(value)
            stream.filter.Update()
            self.assertEqual(stream.learned(), 3, setter)
            self.assertEqual(stream.messages.all(), [])

    def test_position(self):
        stream = Stream(SensorPosition=(9, 9, 9))
        for k in range(2):
            found, _ = stream.give(cloud(place(30, 2, 20) + (1, 2, 3), time=k, position=(1, 2, 3)))
        self.assertEqual(stream.field("position"), (1, 2, 3))  # that of the data wins
        np.testing.assert_allclose(stream.filter.GetOutputDataObject(1).GetPoint(0), (place(30.0, 1.875, 20.25) + (1, 2, 3))[0])

    def test_scans_of_a_sensor(self):
        """Echoes bring position and time; the steps of a revolution are one scan."""
        source = sensor(36, 2)
        source.SetPosition(0, 0, 2)
        source.SetNumberOfRevolutions(4)
        source.SetStepsPerRevolution(3)
        source.SetRotationRate(0.5)
        echoes = scan(box((50, 0, 0), (1, 40, 40)), source)
        stream = Stream(AzimuthStep=10.0)
        stream.filter.SetInputConnection(0, echoes.GetOutputPort())
        for k in range(12):
            stream.filter.UpdateTimeStep(k * 2.0 / 3)
            self.assertEqual(stream.learned(), k // 3 + 1)
        found, _ = stream.result()
        self.assertGreater(len(found), 0)
        np.testing.assert_array_equal(found, 1)
        self.assertEqual(stream.field("position"), (0, 0, 2))
        self.assertEqual(stream.messages.all(), [])


class Table(unittest.TestCase):
    def learn(self, scans=6):
        rng = np.random.default_rng(3)
        stream = Stream()
        for k in range(scans):
            stream.give(cloud(random_scan(rng), time=k))
        return stream, rng

    def test_cells(self):
        stream, _ = self.learn()
        table, (cells, persistence) = stream.table(), stream.cells()
        self.assertEqual(table.GetNumberOfVerts(), len(cells))
        middles = np.array([table.GetPoint(i) for i in range(len(cells))])
        np.testing.assert_allclose(middles, place(cells[:, 0] * 0.375, cells[:, 1] * 0.375, (cells[:, 2] + 0.5) * 1.5), atol=1e-9)
        self.assertTrue(((persistence > 0) & (persistence <= 1)).all())
        order = np.lexsort((cells[:, 2], cells[:, 1], cells[:, 0]))
        np.testing.assert_array_equal(order, np.arange(len(cells)))

    def test_a_file_goes_on(self):
        """Six scans, a file, six scans more: as twelve scans."""
        first, rng = self.learn()
        with tempfile.TemporaryDirectory() as folder:
            writer = vtkXMLPolyDataWriter()
            writer.SetFileName(str(pathlib.Path(folder) / "table.vtp"))
            writer.SetDataModeToBinary()
            writer.SetInputData(first.table())
            writer.Write()
            reader = vtkXMLPolyDataReader()
            reader.SetFileName(writer.GetFileName())
            reader.Update()
        second = Stream(table=reader.GetOutput(), WarmUp=6)
        for k in range(6, 12):
            points = random_scan(rng)
            one, _ = first.give(cloud(points, time=k))
            other, clutter = second.give(cloud(points, time=k))
            np.testing.assert_allclose(other, one, atol=1e-12)
            np.testing.assert_array_equal(clutter, other >= 0.05)  # the table's scans count for WarmUp
            self.assertEqual(second.learned(), k + 1)

    def test_the_table_alone(self):
        first, rng = self.learn()
        table = first.table()
        stream = Stream(table=table, Learning=False, WarmUp=100)
        points = random_scan(rng)
        expected, _ = first.give(cloud(points, time=6))
        for k in range(3):
            found, clutter = stream.give(cloud(points, time=k))
            np.testing.assert_allclose(found, expected, atol=1e-12)
            np.testing.assert_array_equal(clutter, found >= 0.05)
            self.assertEqual(stream.learned(), 6)
        self.assertEqual(stream.table().GetNumberOfPoints(), table.GetNumberOfPoints())

    def test_bad_tables(self):
        good = self.learn()[0].table()

        def spoilt(change):
            data = vtkPolyData()
            data.DeepCopy(good)
            change(data)
            return data

        def without(name):
            return lambda data: (data.GetPointData().RemoveArray(name), data.GetFieldData().RemoveArray(name))

        cases = (
            (without("clutter_cell"), "'clutter_cell' are missing"),
            (without("clutter_probability"), "'clutter_probability' or"),
            (without("learned_scans"), "'learned_scans' is not a whole number"),
            (without("clutter_range_step"), "'clutter_range_step' is not one finite number"),
            (lambda data: data.GetFieldData().GetArray("clutter_azimuth_step").SetComponent(0, 0, 0.2),
             "clutter_azimuth_step is 0.2"),
            (lambda data: data.GetFieldData().GetArray("learned_scans").SetComponent(0, 0, -1), "'learned_scans'"),
            (lambda data: data.GetPointData().GetArray("clutter_cell").SetComponent(4, 0, 960), "point 4: 'clutter_cell'"),
            (lambda data: data.GetPointData().GetArray("clutter_probability").SetComponent(5, 0, 1.5),
             "point 5: clutter_probability is 1.5"),
            (lambda data: data.GetPointData().GetArray("clutter_probability").SetComponent(5, 0, float("nan")),
             "point 5: clutter_probability is nan"),
        )
        for change, words in cases:
            with self.subTest(words=words):
                stream = Stream(table=spoilt(change))
                stream.filter.SetInputDataObject(0, cloud(place(0, 0, 20), time=0))
                stream.filter.Update()
                self.assertEqual(len(stream.messages.all()), 1)
                self.assertIn(words, stream.messages.all()[0])
                self.assertIn("input port 1 (table)", stream.messages.all()[0])


class BadInput(unittest.TestCase):
    def test_messages(self):
        nan = float("nan")
        here = place(0, 0, 20)
        cases = (
            ({"Window": 0.5}, cloud(here, 0), "Window is 0.5"),
            ({"Window": nan}, cloud(here, 0), "Window is nan"),
            ({"ClutterThreshold": 0.0}, cloud(here, 0), "ClutterThreshold is 0"),
            ({"RangeStep": 0.0}, cloud(here, 0), "RangeStep is 0"),
            ({"AzimuthStep": 100.0}, cloud(here, 0), "AzimuthStep is 100"),
            ({"ElevationStep": nan}, cloud(here, 0), "ElevationStep is nan"),
            ({"RangeTolerance": 11}, cloud(here, 0), "RangeTolerance is 11"),
            ({"AngularTolerance": -1}, cloud(here, 0), "AngularTolerance is -1"),
            ({"WarmUp": -1}, cloud(here, 0), "WarmUp is -1"),
            ({"SensorPosition": (nan, 0, 0)}, cloud(here, 0), "SensorPosition: position"),
            ({"Learning": False}, cloud(here, 0), "Learning is off"),
            ({}, cloud([[0, 0, 1], [nan, 0, 0]], 0), "input port 0 (scan): point 1"),
            ({}, cloud(here, nan), "its time is not a finite number"),
            ({}, cloud(here, TimeValue=nan), "'TimeValue' is not one finite number"),
            ({}, cloud(here, 0, position=(1, nan, 2)), "'position' are not 3 finite numbers"),
        )
        for settings, data, words in cases:
            with self.subTest(words=words):
                stream = Stream(**settings)
                stream.filter.SetInputDataObject(0, data)
                stream.filter.Update()
                self.assertEqual(len(stream.messages.all()), 1)
                self.assertIn(words, stream.messages.all()[0])
                for port in (0, 1):
                    self.assertEqual(stream.filter.GetOutputDataObject(port).GetNumberOfPoints(), 0)

    def test_the_memory_stays(self):
        stream = Stream()
        for k in range(3):
            stream.give(cloud(place(0, 0, 20), time=k))
        stream.filter.SetInputDataObject(0, cloud([[float("nan"), 0, 0]], time=3))
        stream.filter.Update()
        self.assertEqual(len(stream.messages.all()), 1)
        found, _ = stream.give(cloud(place(0, 0, 20), time=3))
        self.assertEqual((found[0], stream.learned()), (1, 4))

    def test_no_points(self):
        stream = Stream()
        stream.give(cloud(place(0, 0, 20), time=0))
        self.assertEqual(len(stream.give(cloud(np.zeros((0, 3)), time=1))[0]), 0)
        found, _ = stream.give(cloud(place(0, 0, 20), time=2))
        self.assertAlmostEqual(found[0], share([1, 0]), 12)


class RealFrames(unittest.TestCase):
    """Two frames of one lidar that stands still: what the second one sees, the first one saw."""

    def test_two_frames(self):
        folder = os.environ.get("AVIANLIDAR_DATA_DIR")
        if not folder:
            self.skipTest("AVIANLIDAR_DATA_DIR is empty")
        stream = Stream(AzimuthStep=0.5, ElevationStep=0.5)
        for k in range(2):
            reader = al.vtkAvianLidarPointCloudReader()
            reader.SetFileName(str(pathlib.Path(folder) / "lidar_outdoor" / f"helios16p_frame{k}.pcd"))
            reader.Update()
            data = reader.GetOutput()
            data.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), 0.1 * k)
            found, _ = stream.give(data)
        self.assertGreater(len(found), 10000)
        self.assertEqual(set(np.unique(found)), {0.0, 1.0})
        self.assertGreater(found.mean(), 0.8)
        self.assertEqual(stream.messages.all(), [])


if __name__ == "__main__":
    unittest.main()
