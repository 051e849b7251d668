# SPDX-License-Identifier: BSD-3-Clause
"""The clutter filter on scans made by hand: time, tables, bad input. Persistence in closed form, neighbours by brute
force, order and memory of the map are TestClutterMap's (kernel), NaN in each property TestBadInput's."""

import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData, vtkUnstructuredGrid

import cloudtools
from avianlidar import vtkAvianLidar as al
from echotools import Messages, box, copy_of, given, scan, sensor

WINDOW = 20.0


def place(azimuth, elevation, distance):
    """Points at azimuths (degrees clockwise from y), elevations and ranges."""
    a, e, r = (np.asarray(values, float)
               for values in np.broadcast_arrays(np.radians(azimuth), np.radians(elevation), distance))
    return np.stack([r * np.cos(e) * np.sin(a), r * np.cos(e) * np.cos(a), r * np.sin(e)], axis=-1).reshape(-1, 3)


HERE = place(0, 0, 20)


def cloud(points, time=None, kind=vtkPolyData, **fields):
    data = cloudtools.cloud(points, kind)
    if time is not None:
        data.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
    for name, value in fields.items():
        cloudtools.add_field(data, name, tuple(np.atleast_1d(value)))
    return data


class Stream:
    """A filter that is given one cloud after the other."""

    def __init__(self, table=None, **settings):
        self.filter = given(al.vtkAvianLidarClutterFilter(), **{"Window": WINDOW, "WarmUp": 0, **settings})
        if table is not None:
            self.filter.SetInputDataObject(1, table)
        self.messages = Messages(self.filter)

    def give(self, data):
        """clutter_probability and is_clutter of a cloud."""
        self.filter.SetInputDataObject(0, data)
        self.filter.Update()
        points = self.filter.GetOutputDataObject(0).GetPointData()
        return tuple(vtk_to_numpy(points.GetArray(name)).copy() for name in ("clutter_probability", "is_clutter"))

    def stand_still(self, scans):
        """One point, scan after scan."""
        for k in range(scans):
            self.give(cloud(HERE, time=k))
        return self

    def error(self, data):
        """The one message that a cloud gives; nothing comes out."""
        self.messages.errors.clear()
        self.filter.SetInputDataObject(0, data)
        self.filter.Update()
        assert [self.filter.GetOutputDataObject(port).GetNumberOfPoints() for port in (0, 1)] == [0, 0]
        message, = self.messages.all()
        return message

    def field(self, name):
        return self.filter.GetOutputDataObject(0).GetFieldData().GetArray(name).GetTuple(0)

    def table(self):
        return copy_of(self.filter.GetOutputDataObject(1))

    def learned(self):
        return int(self.field("learned_scans")[0])


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


class Persistence(unittest.TestCase):
    def test_warm_up(self):
        stream = Stream(WarmUp=3)
        for k in range(6):
            found, clutter = stream.give(cloud(place([0, 90 + 10 * k], 0, 20), time=k))
            self.assertEqual(found[1], 0)
            np.testing.assert_array_equal(clutter, [1, k < 3])

    def test_field_data(self):
        stream = Stream(WarmUp=7, SensorPosition=(1, 2, 3))
        stream.give(cloud(HERE + (1, 2, 3), time=0, kind=vtkUnstructuredGrid))
        self.assertTrue(stream.filter.GetOutputDataObject(0).IsA("vtkUnstructuredGrid"))
        expected = {"clutter_window": 20, "clutter_threshold": 0.05, "clutter_range_step": 1.5,
                    "clutter_azimuth_step": 0.375, "clutter_elevation_step": 0.375, "clutter_range_tolerance": 1,
                    "clutter_angular_tolerance": 1, "clutter_warm_up": 7, "clutter_learning": 1, "learned_scans": 1}
        for port in (0, 1):
            fields = stream.filter.GetOutputDataObject(port).GetFieldData()
            self.assertEqual({name: fields.GetArray(name).GetTuple1(0) for name in expected}, expected)
            self.assertEqual(fields.GetArray("position").GetTuple3(0), (1, 2, 3))

    def test_steps_and_tolerances(self):
        """Cells of other sizes, each of which only its own setting makes; the first point is across north."""
        steps = {"RangeStep": 1.0, "AzimuthStep": 2.0, "ElevationStep": 0.5}
        near = place([359.4, 2, 0, 0, 2, 4], [1.5, 1.5, 2, 1.5, 2, 1.5], [50.5, 50.5, 50.5, 51.5, 51.5, 50.5])
        for tolerances, expected in (((0, 0), [1, 0, 0, 0, 0, 0]), ((1, 0), [1, 0, 0, 1, 0, 0]),
                                     ((0, 1), [1, 1, 1, 0, 0, 0]),
                                     ((1, 1), [1, 1, 1, 1, 1, 0]), ((0, 2), [1, 1, 1, 0, 0, 1])):
            stream = Stream(RangeTolerance=tolerances[0], AngularTolerance=tolerances[1], **steps)
            stream.give(cloud(place(0.4, 1.5, 50.5), time=0))
            found, _ = stream.give(cloud(near, time=1))
            np.testing.assert_allclose(found, expected, atol=1e-12)


class Time(unittest.TestCase):
    def test_the_same_time_replaces(self):
        stream = Stream()
        stream.give(cloud(HERE, time=0))
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
        stream = Stream().stand_still(5)
        for time, expected in ((2, (0, 1)), (3, (1, 2))):
            found, _ = stream.give(cloud(HERE, time=time))
            self.assertEqual((found[0], stream.learned()), expected)
            self.assertEqual([("goes back from 4 s to 2 s" in text) for text in stream.messages.all()], [True])

    def test_times_of_other_kinds(self):
        stream = Stream()
        for k in range(3):
            stream.give(cloud(HERE, TimeValue=10 + k))
        self.assertEqual(stream.learned(), 3)
        stream = Stream()
        for k in range(3):  # without times: each is the next
            data = cloud(HERE)
            stream.give(data)
            stream.filter.Modified()
            stream.give(data)
        self.assertEqual(stream.learned(), 3)
        data.GetPoints().SetPoint(0, 0, 30, 0)
        data.GetPoints().Modified()
        stream.give(data)
        self.assertEqual(stream.learned(), 4)

    def test_what_empties_the_memory(self):
        for name, value, left in (("RangeStep", 1.0, 1), ("AzimuthStep", 0.2, 1), ("ElevationStep", 0.2, 1),
                                  ("Window", 30.0, 1), ("SensorPosition", (1, 0, 0), 1), ("Forget", None, 1),
                                  ("ClutterThreshold", 0.5, 3), ("RangeTolerance", 3, 3), ("AngularTolerance", 0, 3),
                                  ("WarmUp", 9, 3)):
            stream = Stream().stand_still(3)
            stream.filter.Forget() if name == "Forget" else getattr(stream.filter, "Set" + name)(value)
            stream.filter.Update()
            self.assertEqual((stream.learned(), stream.messages.all()), (left, []), name)

    def test_position(self):
        stream = Stream(SensorPosition=(9, 9, 9))
        for k in range(2):
            found, _ = stream.give(cloud(place(30, 2, 20) + (1, 2, 3), time=k, position=(1, 2, 3)))
        self.assertEqual(stream.field("position"), (1, 2, 3))  # that of the data wins
        np.testing.assert_allclose(stream.filter.GetOutputDataObject(1).GetPoint(0),
                                   (place(30.0, 1.875, 20.25) + (1, 2, 3))[0])

    def test_scans_of_a_sensor(self):
        """Echoes bring position and time; the steps of a revolution are one scan."""
        source = given(sensor(36, 2), Position=(0, 0, 2), NumberOfRevolutions=4, StepsPerRevolution=3, RotationRate=0.5)
        echoes = scan(box((50, 0, 0), (1, 40, 40)), source)
        stream = Stream(AzimuthStep=10.0)
        stream.filter.SetInputConnection(0, echoes.GetOutputPort())
        for k in range(12):
            stream.filter.UpdateTimeStep(k * 2.0 / 3)
            self.assertEqual(stream.learned(), k // 3 + 1)
        found = vtk_to_numpy(stream.filter.GetOutputDataObject(0).GetPointData().GetArray("clutter_probability"))
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

    def test_a_table_goes_on(self):
        """Six scans, their table, six scans more: as twelve scans."""
        first, rng = self.learn()
        second = Stream(table=first.table(), WarmUp=6, ClutterThreshold=0.3)
        for k in range(6, 12):
            points = random_scan(rng)
            one, _ = first.give(cloud(points, time=k))
            other, clutter = second.give(cloud(points, time=k))
            np.testing.assert_allclose(other, one, atol=1e-12)
            np.testing.assert_array_equal(clutter, other >= 0.3)  # the table's scans count for WarmUp
            self.assertEqual(second.learned(), k + 1)

    def test_bad_tables(self):
        good = self.learn()[0].table()

        def spoilt(change):
            data = copy_of(good)
            change(data)
            return data

        def without(name):
            return lambda data: (data.GetPointData().RemoveArray(name), data.GetFieldData().RemoveArray(name))

        def field(name, value):
            return lambda data: data.GetFieldData().GetArray(name).SetComponent(0, 0, value)

        def point(name, number, value):
            return lambda data: data.GetPointData().GetArray(name).SetComponent(number, 0, value)

        for change, words in ((without("clutter_cell"), "'clutter_cell' are missing"),
                              (without("learned_scans"), "'learned_scans'"),
                              (field("clutter_azimuth_step", 0.2), "clutter_azimuth_step is 0.2"),
                              (field("learned_scans", -1), "'learned_scans'"),
                              (point("clutter_cell", 4, 960), "point 4: 'clutter_cell'"),
                              (point("clutter_probability", 5, 1.5), "point 5: .* is 1.5")):
            with self.subTest(words):
                self.assertRegex(Stream(table=spoilt(change)).error(cloud(HERE, time=0)),
                                 r"input port 1 \(table\).*" + words)

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

    def test_another_table_begins_anew(self):
        stream = Stream(table=Stream().stand_still(4).table())
        stream.give(cloud(HERE, time=7))
        stream.filter.SetInputDataObject(1, Stream().stand_still(3).table())
        stream.give(cloud(HERE, time=8))
        self.assertEqual(stream.learned(), 4)


class BadInput(unittest.TestCase):
    def test_messages(self):
        """Numbers out of range are TestBadInput's."""
        nan = float("nan")
        for settings, data, words in (
                ({"Learning": False}, cloud(HERE, 0), "Learning is off"),
                ({}, cloud([[0, 0, 1], [nan, 0, 0]], 0), "input port 0 .*: point 1"),
                ({}, cloud(HERE, nan), "its time"), ({}, cloud(HERE, 0, position=(1, nan, 2)), "'position'")):
            with self.subTest(words):
                self.assertRegex(Stream(**settings).error(data), words)

    def test_the_memory_stays(self):
        stream = Stream().stand_still(3)
        stream.error(cloud([[float("nan"), 0, 0]], time=3))
        found, _ = stream.give(cloud(HERE, time=3))
        self.assertEqual((found[0], stream.learned()), (1, 4))
        self.assertEqual(len(stream.give(cloud(np.zeros((0, 3)), time=4))[0]), 0)  # a scan without points is one
        found, _ = stream.give(cloud(HERE, time=5))
        self.assertAlmostEqual(found[0], share([1, 1, 1, 1, 0]), 12)
