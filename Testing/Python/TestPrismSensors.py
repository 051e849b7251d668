# SPDX-License-Identifier: BSD-3-Clause
"""Sensors with rotating prisms: scans are windows of time, fields of view are the makers'; echoes, coverage and
sequences with beams that differ from scan to scan; and what is said where a file is wrong."""
import json
import os
import pathlib
import re
import unittest

import numpy as np

import avianlidar as al
from echotools import InFolder, copy_of
from helpertools import WALL, wall

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
FILES = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Filters" / "Sensors"
PRISMS = {"Mid40": 10_000, "Avia": 24_000, "Mid360": 20_000}  # beams of a window


def window(sensor, number):
    """A copy of a scan's beams."""
    sensor.algorithm.UpdateTimeStep(number / sensor.rotation_rate)
    return al.Cloud(copy_of(sensor.algorithm.GetOutput()))


def angles_of(directions):
    """Directions with azimuths and elevations, deg."""
    return directions, np.degrees(np.arctan2(directions[:, 0],
                                             directions[:, 1])), np.degrees(np.arcsin(directions[:, 2]))


class Windows(unittest.TestCase):
    def test_each_scan_has_directions_of_its_own(self):
        for name, count in PRISMS.items():
            with self.subTest(name):
                sensor = al.Sensor(name)
                first, second, again = (window(sensor, number) for number in (0, 1, 0))
                self.assertEqual(first.number_of_points, count)
                self.assertEqual(count * sensor.rotation_rate,
                                 sensor.description["data_sheet"]["points_per_second"]["value"])
                np.testing.assert_array_equal(first["direction"], again["direction"])
                self.assertGreater(np.abs(first["direction"] - second["direction"]).max(axis=1).mean(), 0.05)
                np.testing.assert_allclose(second["timestamp"], first["timestamp"] + 1e5, atol=1e-6)
                self.assertEqual([int(cloud.fields["revolution"]) for cloud in (first, second)], [0, 1])

    def test_field_data_say_what_there_is(self):
        fields = al.Sensor("Mid40").beams.fields
        np.testing.assert_array_equal(fields["prism_wedge_angles"], [18, -18])
        self.assertFalse({"azimuth_step", "azimuth_range", "prism_axis_elevation"} & set(fields))
        self.assertEqual(float(fields["firing_interval"]), 1e-5)
        self.assertEqual(float(al.Sensor("Mid360").beams.fields["prism_axis_elevation"]), 21.68)
        self.assertNotIn("prism_wedge_angles", al.Sensor("Mid360").beams.fields["assumed"])
        self.assertNotIn("prism_wedge_angles", al.Sensor("Mid40").beams.fields["assumed"])
        # Beams of one's own in their place, and another sensor.
        own = al.Sensor("Mid40", directions=[(0, 1, 0)]).beams.fields
        self.assertFalse({"prism_wedge_angles", "firing_interval"} & set(own))
        sensor = al.Sensor("Mid360").algorithm
        sensor.SetPresetToAirport16()
        self.assertEqual(sensor.GetNumberOfPrisms(), 0)


class FieldsOfView(unittest.TestCase):
    def extent(self, name, windows):
        sensor = al.Sensor(name)
        return angles_of(np.concatenate([window(sensor, number)["direction"] for number in range(windows)]))

    def test_makers_figures(self):
        directions, _, _ = self.extent("Mid40", 10)
        self.assertAlmostEqual(2 * np.degrees(np.arccos(directions[:, 1].min())), 38.4, delta=0.05)
        _, azimuth, elevation = self.extent("Avia", 20)
        self.assertAlmostEqual(np.ptp(azimuth), 70.4, delta=0.1)
        self.assertAlmostEqual(np.ptp(elevation), 77.2, delta=0.5)  # 76.8: nothing was fitted to it
        _, azimuth, elevation = self.extent("Mid360", 10)
        self.assertAlmostEqual(elevation.min(), -7, delta=1.2)
        self.assertAlmostEqual(elevation.max(), 52, delta=1.2)
        self.assertLess(np.diff(np.sort(azimuth)).max(), 0.2)


class PatternOfTheMid360(unittest.TestCase):
    """The numbers are those of 0.1 s of scan_mode/mid360.csv of Livox's simulator."""

    def test_beams_are_where_the_makers_are(self):
        for number in (0, 1, 17):
            with self.subTest(number):
                _, azimuth, elevation = angles_of(window(al.Sensor("Mid360"), number)["direction"])
                met, _, _ = np.histogram2d(elevation, azimuth, [np.arange(-7, 53), np.arange(-180, 181)])
                self.assertAlmostEqual((met > 0).mean(), 0.630, delta=0.02)  # cells of 1 degree
                for middle in (0, 20, 30):  # windows of 2 by 2 degrees around each degree of azimuth
                    about = azimuth[np.abs(elevation - middle) < 1]
                    off = np.abs((about - np.arange(-180, 180)[:, None] + 180) % 360 - 180)
                    self.assertLessEqual(np.mean(off.min(axis=1) >= 1), 0.02 if number else 0)
                for low, high, expected in ((5, 15, 3210), (15, 25, 3483), (45, 55, 2602)):
                    solid = 2 * np.pi * np.ptp(np.sin(np.radians([low, high])))
                    density = np.count_nonzero((elevation >= low) & (elevation < high)) / solid
                    self.assertAlmostEqual(density / expected, 1, delta=0.04)

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is empty")
    def test_each_beam_follows_the_makers_file(self):
        theirs = np.load(pathlib.Path(DATA) / "lidars_measured" / "mid360_directions.npy").astype(float)
        ours = np.array(window(al.Sensor("Mid360"), 0)["direction"])
        turn = np.angle(np.sum((theirs[:, 0] + 1j * theirs[:, 1]) * (ours[:, 0] - 1j * ours[:, 1])))
        about = (ours[:, 0] + 1j * ours[:, 1]) * np.exp(1j * turn)
        off = np.linalg.norm(np.column_stack([about.real, about.imag, ours[:, 2]]) - theirs, axis=1)
        self.assertLess(np.degrees(np.sqrt(np.mean(off**2))), 0.5)
        self.assertLess(np.degrees(off.max()), 1.3)


class Use(InFolder):
    """What uses beams that differ from scan to scan."""

    def test_echoes_lie_on_the_wall_at_their_time(self):
        y = 20.0
        scan = al.Scan(al.Scene(wall(y, 30)), al.Sensor("Mid40"), noise=False, rays_per_beam=16)
        scan.algorithm.UpdateTimeStep(0.4)
        echoes = al.Cloud(scan.algorithm.GetOutput())
        self.assertEqual(echoes.number_of_points, 10_000)
        np.testing.assert_allclose(echoes.points[:, 1], y, atol=0.02)
        beams = window(al.Sensor("Mid40"), 4)
        np.testing.assert_array_equal(echoes["timestamp"],
                                      beams["timestamp"][np.searchsorted(beams["beam_id"], echoes["beam_id"])])

    def test_a_range_image_has_a_row_for_each_laser(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor("Avia"), noise=False, rays_per_beam=16)
        image = scan.range_image()
        self.assertEqual(image["distance_m"].shape, (6, 4000))
        self.assertEqual(np.isfinite(image["distance_m"]).sum(), scan.echoes.number_of_points)

    def test_coverage_is_that_of_the_beams_of_a_window(self):
        sensor, random = al.Sensor("Mid40"), np.random.default_rng(2)
        beams = np.array(sensor.beams["direction"])
        lines = beams[::100] + random.normal(0, 2e-3, (100, 3))  # within a beam and beside it
        lines /= np.linalg.norm(lines, axis=1)[:, None]
        right = np.cross(beams, [0, 0, 1])
        right /= np.linalg.norm(right, axis=1)[:, None]
        ahead = lines @ beams.T
        squares = sum((lines @ across.T / ahead / np.tan(half))**2 for across, half in (
            (right, sensor.half_beamwidth), (np.cross(right, beams), sensor.half_beamwidth_across)))
        held = np.sum((squares <= 1) & (ahead > 0), axis=1)
        cover = al.Coverage(al.Scene(WALL), sensor, places=5.0 * lines)
        cover.set(clutter=False)
        with self.assertWarnsRegex(RuntimeWarning,
                                   "track_probability assumes that all NumberOfScans have the beams of this scan"):
            cover["track_probability"]
        cover.set(number_of_scans=1, required_detections=1)
        np.testing.assert_array_equal(cover["track_probability"], cover["detection_probability"])
        near = np.min(np.abs(squares - 1), axis=1) < 1e-9
        np.testing.assert_array_equal(np.array(cover["beams_per_scan"])[~near], np.minimum(held, 255)[~near])
        self.assertTrue(0.03 < (held > 0).mean() < 0.97)

    def test_a_sequence_has_the_clutter_of_each_scan(self):
        (self.folder / "flat.lidarscene.json").write_text(
            json.dumps({"version": 1, "lidar": {"position": [0, 0, 3]},
                        "objects": [{"name": "Ground", "class": "ground", "ground": {"size": 400, "height": 0},
                                     "material": "Wall"}]}))
        (self.folder / "flat.scenario.json").write_text(
            json.dumps({"scene": "flat.lidarscene.json", "number_of_scans": 2, "scans_per_sequence": 2, "seed": 1,
                        "sensor": {"preset": "Mid40"}, "birds": [
                            {"pattern": "Circles", "species": "crow", "number_of_birds": 3, "radius": 40,
                             "heights": [5, 9]}]}))
        sequence = al.Sequence(self.folder / "flat.scenario.json", threads=1)
        for k, _, species in sequence.frames(0):
            self.assertEqual(len(sequence.truth(k, species)), 3)
            beams = window(al.Sensor("Mid40"), k)
            order = np.searchsorted(beams["beam_id"], sequence.clutter.beams)
            ranges = -3 / beams["direction"][order, 2]
            self.assertGreater(len(ranges), 2000)
            near = ranges < 30
            np.testing.assert_allclose(sequence.clutter.ranges[near], ranges[near], rtol=0.05)


class BadFiles(InFolder):
    def test_values_are_named(self):
        """Values of their own are those of the kernel, tested in TestPrisms.cxx: the file, the unit, and what does not
        go with prisms."""
        good = json.loads((FILES / "Mid40.lidarsensor.json").read_text("utf-8"))
        for name, value, unit, words in (
                ("prism_wedge_angles", [18, -70], "deg", "PrismWedgeAngles is -70"),
                ("prism_rotation_rates", [1, 2, 3], "Hz", "PrismRotationRates has 3 values"),
                ("prism_axis_elevation", 10, "rad", 'its unit is "rad"'),
                ("prism_wedge_angles", None, None, "PrismWedgeAngles is empty"),
                ("blanked_sectors", [0, 10], "deg", "BlankedSectors has values"),
                ("encoder_jitter", 0.1, "deg", ", expected 0 with prisms"),
                ("firing_interval", 1, "s", "expected at most the 0.1 s")):
            values = {key: entry for key, entry in good["values"].items() if key != name}
            if value is not None:
                values[name] = {"value": value, "unit": unit, "source": "test"}
            file = self.folder / "bad.lidarsensor.json"
            file.write_text(json.dumps({**good, "values": values}), "utf-8")
            words = "bad.lidarsensor.json(.|\n)*" + re.escape(words)
            with self.subTest(words), self.assertRaisesRegex(al.Error, words):
                al.Sensor(file).beams
