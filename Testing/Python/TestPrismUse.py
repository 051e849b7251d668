# SPDX-License-Identifier: BSD-3-Clause
"""Coverage, ranges of birds and labelled sequences with beams that differ from scan to scan."""
import json
import pathlib
import tempfile
import unittest
import warnings

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
from avianlidar import reach
from helpertools import WALL

PRISMS = "Mid40", "Avia", "Mid360"


def window(sensor, number):
    """A copy of a scan's beams."""
    sensor.algorithm.UpdateTimeStep(number / sensor.rotation_rate)
    copied = vtkPolyData()
    copied.DeepCopy(sensor.algorithm.GetOutput())
    return al.Cloud(copied)


class Use(unittest.TestCase):
    def test_coverage_is_that_of_the_beams_of_a_window(self):
        sensor = al.Sensor("Mid40")
        random = np.random.default_rng(2)
        lines = np.column_stack([random.uniform(-0.3, 0.3, 2000), np.ones(2000), random.uniform(-0.3, 0.3, 2000)])
        lines /= np.linalg.norm(lines, axis=1)[:, None]
        beams = np.array(sensor.beams["direction"])
        right = np.cross(beams, [0, 0, 1])
        right /= np.linalg.norm(right, axis=1)[:, None]
        ahead = lines @ beams.T
        squares = sum((lines @ across.T / ahead / np.tan(half))**2 for across, half in (
            (right, sensor.half_beamwidth), (np.cross(right, beams), sensor.half_beamwidth_across)))
        held = np.sum((squares <= 1) & (ahead > 0), axis=1)
        cover = al.Coverage(al.Scene(WALL), sensor, places=5.0 * lines)
        cover.set(clutter=False)
        with self.assertWarnsRegex(RuntimeWarning, "track_probability takes all NumberOfScans for the one that is here"):
            cover["track_probability"]
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            cover.set(number_of_scans=1, required_detections=1)
            np.testing.assert_array_equal(cover["track_probability"], cover["detection_probability"])
        near = np.min(np.abs(squares - 1), axis=1) < 1e-9
        np.testing.assert_array_equal(np.array(cover["beams_per_scan"])[~near], np.minimum(held, 255)[~near])
        self.assertGreater((held > 0).mean(), 0.03)

    def test_a_sequence_has_the_clutter_of_each_scan(self):
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            (place / "flat.lidarscene.json").write_text(json.dumps({
                "version": 1, "lidar": {"position": [0, 0, 3]},
                "objects": [{"name": "Ground", "class": "ground", "ground": {"size": 400, "height": 0}, "material": "Wall"}]}))
            (place / "flat.scenario.json").write_text(json.dumps({
                "scene": "flat.lidarscene.json", "number_of_scans": 3, "scans_per_sequence": 3, "seed": 1,
                "sensor": {"preset": "Mid40"}, "birds": [{"pattern": "Circles", "species": "crow", "number_of_birds": 3, "radius": 40,
                                                          "heights": [5, 9]}]}))
            sequence = al.Sequence(place / "flat.scenario.json", threads=1)
            for k, _, species in sequence.frames(0):
                self.assertEqual(len(sequence.truth(k, species)), 3)
                beams = window(al.Sensor("Mid40"), k)
                order = np.searchsorted(beams["beam_id"], sequence.clutter.beams)
                ranges = -3 / beams["direction"][order, 2]
                self.assertGreater(len(ranges), 2000)
                near = ranges < 30
                np.testing.assert_allclose(sequence.clutter.ranges[near], ranges[near], rtol=0.05)

    def test_reach(self):
        for name in PRISMS:
            with self.subTest(name):
                found = reach.within_beams(al.Sensor(name), "herring gull", [5.0, 20.0, 2000.0], birds=200)
                self.assertGreaterEqual(found.one_scan[0], found.one_scan[1])
                self.assertGreater(found.one_scan[1], 0.0)
                self.assertEqual(found.one_scan[2], 0.0)


if __name__ == "__main__":
    unittest.main()
