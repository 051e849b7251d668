# SPDX-License-Identifier: BSD-3-Clause
"""Boxes about what moves: size, place and heading in closed form, what hides and what cuts them, and points of a
sequence that lie in them."""

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

import avianlidar as al
from avianlidar._cloud import add_array as _set
from avianlidar.apps.sequences._boxes import Boxes, _rotation
from avianlidar.apps.sequences._sequence import Sequence
from echotools import InFolder, group
from helpertools import box
from TestSequence import scenario_file

POSE = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]])  # x forward is north, y left is west
ELEVATIONS = (-10.0, 10.0)


def turned(degrees):
    """Clockwise from north."""
    half = np.radians(degrees) / 2
    return np.cos(half), 0, 0, -np.sin(half)


def tree_of(*surfaces):
    tree = al.vtkAvianLidar.vtkAvianLidarCollisionTree()
    tree.AddObserver("WarningEvent", lambda *_: None)  # there is no material
    tree.SetInputData(al.mesh(*surfaces))
    tree.Update()
    return tree


def one(size, place, heading=0.0, surfaces=None, points=3, name="car", **settings):
    """The words of the line of a mover of so much (x right, y forward, z up) in the middle of its frame. @param
    settings of the sensor"""
    low = -np.array(size) / 2
    thing = al.mover(al.mesh(*box(low, -low)), [place, place], [0, 10], [turned(heading)] * 2)
    _set(thing.GetCellData(), "object_id", np.full(thing.GetNumberOfCells(), 1007, np.int32))
    _set(thing.GetFieldData(), "object_classes", [name])
    report = al.mesh([place], np.empty((0, 3), int))
    for name, value in (("object_id", np.int32(1007)), ("timestamp", 2e6), ("number_of_echoes", np.int32(points))):
        _set(report.GetPointData(), name, np.array([value]))
    sensor = al.Sensor(**{"channel_elevations": list(np.linspace(*ELEVATIONS, 5)), "number_of_channels": 5,
                          "half_beamwidth": 0.001, "range_gate": 500.0, **settings})
    boxes = Boxes(tree_of(*surfaces) if surfaces else al.vtkAvianLidar.vtkAvianLidarCollisionTree(), sensor, POSE)
    return boxes.lines(al.Cloud(report), group(thing)).split()


class TestBoxes(InFolder):
    def test_place_size_and_heading(self):
        words = one((2, 4, 1.5), (-30, 100, 5), heading=90)
        self.assertEqual((words[0], words[-2:]), ("car", ["1007", "3"]))
        self.assertEqual([float(word) for word in words[1:-2]], [0, 0, 100, 30, 5, 4, 2, 1.5, round(-np.pi / 2, 4)])
        self.assertEqual(float(one((2, 4, 1.5), (0, 100, 0), heading=-30)[9]), round(np.radians(30), 4))

    def test_a_name_is_one_word(self):
        for name, expected in (("fire  engine", "fire_engine"), ("", "object"), ("Löschfahrzeug", "Löschfahrzeug")):
            words = one((2, 4, 1.5), (-30, 100, 5), name=name)
            self.assertEqual((words[0], len(words)), (expected, 12))

    def test_turns_between_poses(self):
        for share in (-0.5, 0.25, 1.0, 1.5):
            angle = np.radians(20 + 60 * np.clip(share, 0, 1))
            wanted = [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
            for sign in (1, -1):
                quaternions = np.array([turned(20), sign * np.array(turned(80))])
                self.assertLess(np.abs(_rotation(np.array([4.0, 6.0]), quaternions, 4 + 2 * share) - wanted).max(),
                                1e-12)

    def test_what_is_hidden(self):
        """A plate across the view, of which a wall covers the left half, all, or nothing."""
        plate = (40, 0.01, 1)
        self.assertEqual(one(plate, (0, 100, 0), surfaces=box((-30, 49, -5), (0.001, 50, 5)))[2], "0.50")
        self.assertEqual(one(plate, (0, 100, 0), surfaces=box((-30, 49, -5), (30, 50, 5)))[2], "1.00")
        self.assertEqual(one(plate, (0, 100, 0), surfaces=box((-30, 149, -5), (30, 150, 5)))[2], "0.00")

    def test_hidden_points_are_those_of_a_locator(self):
        random = np.random.default_rng(7)
        surfaces = random.normal(size=(300, 3, 3)) + random.uniform(-10, 10, (300, 1, 3))
        tree, place = tree_of(surfaces.reshape(-1, 3), np.arange(900).reshape(-1, 3)), (0.5, -0.2, 0.1)
        points = np.concatenate([random.uniform(-12, 12, (2000, 3)), [place, (np.nan, 0, 0), (np.inf, 0, 0)]])
        locator, hit = vtkStaticCellLocator(), (reference(0.0), [0.0] * 3, [0.0] * 3, reference(0))
        hidden = vtkUnsignedCharArray()
        locator.SetDataSet(tree.GetOutput())
        locator.BuildLocator()
        tree.FindHiddenPoints(place, numpy_to_vtk(points), hidden)
        expected = [bool(locator.IntersectWithLine(place, point, 0.0, *hit)) for point in points[:2000]]
        self.assertTrue(300 < sum(expected) < 1700)
        np.testing.assert_array_equal(vtk_to_numpy(hidden), [*expected, 0, 0, 0])
        self.assertEqual(
            al.vtkAvianLidar.vtkAvianLidarCollisionTree().FindHiddenPoints(place, numpy_to_vtk(points), hidden), None)
        self.assertFalse(vtk_to_numpy(hidden).any())  # without a tree
        said = []
        tree.AddObserver("ErrorEvent", lambda *_: said.append(1))
        tree.FindHiddenPoints(place, numpy_to_vtk(np.zeros((3, 2))), hidden)
        tree.FindHiddenPoints(place, None, hidden)
        self.assertEqual(len(said), 2)

    def test_what_is_cut(self):
        up = 100 * np.tan(np.radians(ELEVATIONS[1]) + 0.001)
        self.assertEqual(one((0.02, 0.02, 4), (0, 100, 0))[1], "0.00")
        self.assertIn(one((0.02, 0.02, 4), (0, 100, up))[1], ("0.50", "0.49", "0.51"))
        self.assertIn(one((0.02, 0.02, 4), (0, 100, -up))[1], ("0.50", "0.49", "0.51"))
        self.assertEqual(one((2, 2, 2), (0, 30, 0), minimum_range=40.0), [])
        self.assertEqual(one((2, 2, 2), (0, 100, 30)), [])
        self.assertEqual(one((2, 2, 2), (0, 503, 0)), [])
        forward = {"azimuth_range": (-45, 45)}
        self.assertEqual(one((2, 2, 2), (60, 100, 0), **forward)[1], "0.00")
        self.assertEqual(one((2, 2, 2), (120, 100, 0), **forward), [])
        self.assertEqual(one((2, 2, 2), (0, -100, 0), **forward), [])

    def test_points_of_a_sequence_lie_in_them(self):
        sequence = Sequence(scenario_file(self.folder, number_of_scans=4, scans_per_sequence=4), threads=1)
        sequence.write(self.folder / "out")
        folder = self.folder / "out" / "sequences" / "00"
        seen, near = 0, 0
        for file in sorted((folder / "boxes").iterdir()):
            points = np.fromfile(folder / "velodyne" / f"{file.stem}.bin", np.float32).reshape(-1, 4)[:, :3]
            owners = (np.fromfile(folder / "labels" / f"{file.stem}.label", np.uint32) >> 16).astype(int) - 1
            for line in file.read_text().splitlines():
                name, truncated, hidden, *words, number, count = line.split()
                x, y, z, length, width, height, yaw = map(float, words)
                self.assertTrue(name in ("bird", "car") and 0 <= float(truncated) < 1 and 0 <= float(hidden) <= 1)
                ours = points[owners == int(number)] - (x, y, z)
                self.assertEqual(len(ours), int(count))
                if name == "car":
                    self.assertEqual((length, width, height), (4, 2, 2))
                ahead = ours[:, :2] @ [np.cos(yaw), np.sin(yaw)]
                aside = ours[:, :2] @ [-np.sin(yaw), np.cos(yaw)]
                # Beams are metres wide there, and ranges have noise. Those that met it in the revolution before are
                # far.
                far = np.max(np.abs([ahead, aside, ours[:, 2]]) - np.array([[length], [width], [height]]) / 2,
                             axis=0, initial=-1)
                seen, near = seen + len(ours), near + np.count_nonzero(far < 4)
        self.assertGreater(seen, 10)
        self.assertGreater(near, 0.9 * seen)
