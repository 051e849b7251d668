# SPDX-License-Identifier: BSD-3-Clause
"""Lidars that can be bought: their patterns against real frames, their limits against their data sheets, what of them
is assumed; and beams of one's own."""
import copy
import json
import os
import pathlib
import pickle
import re
import unittest

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
import echotools
from echotools import InFolder
from avianlidar import _display, reach, vtkAvianLidar
from faulttools import text_array
from helpertools import error_of, rows_of, run, same, wall

FILES = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Filters" / "Sensors"
DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
# and the points a second of one return
REAL = {"VLP-16": 300_000, "VLP-32C": 600_000, "HDL-32E": 700_000, "Pandar40P": 720_000, "PandarXT-32": 640_000,
        "OS0-128": 1_310_720, "OS1-64": 655_360, "OS2-128": 1_310_720, "Helios-16P": 576_000}


def frame(name):
    """Azimuth and elevation (deg), and ring of the points of a real frame, in the order in which they were fired."""
    cloud = al.load_cloud(pathlib.Path(DATA) / name)
    if "elevation" in cloud:  # of the beams: near by, the lens stands beside the origin of the points
        return cloud["file_azimuth"] / 100, cloud["elevation"] / 100, cloud["laser_id"]
    x, y, z = cloud.points.astype(float).T
    return np.degrees(np.arctan2(x, y)) % 360, np.degrees(np.arctan2(z, np.hypot(x, y))), cloud["laser_id"]


def around(angle):
    """Within -180 to 180."""
    return (angle + 180) % 360 - 180


class Manuals(InFolder):
    def test_names_and_what_a_file_says(self):
        for name, rate in REAL.items():
            with self.subTest(name):
                sensor = al.Sensor(name.lower())
                said = sensor.description
                self.assertEqual(sensor.beams.number_of_points * sensor.rotation_rate,
                                 {"VLP-16": 289_280, "VLP-32C": 578_560, "HDL-32E": 694_400}.get(name, rate))
                self.assertEqual(said["data_sheet"]["points_per_second"]["value"], rate)  # of Velodyne's, rounded
                # What nobody told is assumed, and printed with every scan.
                assumed = {key for key, entry in said["values"].items() if entry["source"].startswith("assumed")}
                self.assertLessEqual({"pulse_energy", "pulse_width", "receiver_aperture"}, assumed)
                self.assertEqual(set(sensor.beams.fields["assumed"]), assumed)
                self.assertFalse({"wavelength", "channel_elevations", "channel_firing_times"} & assumed)
        sensor.pulse_energy = 1e-6
        self.assertNotIn("pulse_energy", sensor.beams.fields["assumed"])
        self.assertEqual(al.Sensor("Airport16").description["name"], "Airport16")
        self.assertEqual(al.Sensor(FILES / "VLP16.lidarsensor.json").description, al.Sensor("VLP16").description)

    def test_limits_and_ranges_are_those_of_the_data_sheets(self):
        for name in REAL:
            with self.subTest(name):
                sensor = al.Sensor(name)
                if "sheet" in sensor.description:
                    continue
                sheet = {key: entry["value"] for key, entry in sensor.description["data_sheet"].items()}
                limits = sensor.lower_energy_limit, sensor.upper_energy_limit
                sensor.algorithm.SetLimitsFromDataSheet(sheet["detection_range"], sheet["detection_reflectance"])
                np.testing.assert_allclose(limits, (sensor.lower_energy_limit, sensor.upper_energy_limit), rtol=1e-5)
                if name == "PandarXT-32":
                    sensor = al.Sensor(name, directions=[(0, 1, 0)])
                    for y, seen in ((0.995, 1), (1.005, 0)):
                        board = al.Scene(wall(y * sheet["detection_range"], 9),
                                         material=(sheet["detection_reflectance"], 0, 0))
                        scan = al.Scan(board, sensor, noise=False, visibility=23e3)
                        self.assertEqual(scan.echoes.number_of_points, seen)

    def test_clear_air_is_not_seen(self):
        """No sensor sees the air of a visibility of 23 km, so that the strongest return of a beam is a wall at 20 m."""
        def ranges(sensor, y, **settings):
            scan = al.Scan(al.Scene(wall(y), material=(0.3, 0, 1)), sensor, visibility=23e3,
                           air_backscatter=sensor.receiver_aperture > 0, noise=False, **settings)
            return scan.echoes["distance_m"], scan.echoes["energy_received"]

        for name in al.Sensor.presets():
            with self.subTest(name):
                sensor = al.Sensor(name, directions=[(0, 1, 0)])
                for mode in ("All", "Strongest"):
                    np.testing.assert_allclose(ranges(sensor, 20, return_mode=mode)[0], [20], atol=0.1)
                self.assertEqual(len(ranges(sensor, -20)[0]), 0)
                # What is nearer than the maker's minimum range is not recorded, and what is farther is.
                least, far = sensor.minimum_range, 2.15 * max(sensor.overlap_range, 1)
                if least:
                    self.assertEqual(len(ranges(sensor, 0.98 * least)[0]), 0)
                    self.assertEqual(len(ranges(sensor, 1.02 * least)[0]), 1)
                if sensor.overlap_range and not sensor.defocus_range:
                    energy = ranges(sensor, far, return_mode="Last")[1]
                    sensor.overlap_range = 0
                    np.testing.assert_allclose(energy / ranges(sensor, far, return_mode="Last")[1], 1, atol=0.01)

    def test_fitted_receivers_are_those_of_their_sheets(self):
        """What a file says of its fit is what the fit gives again, and no fit is better than its bar. One of each
        maker; TestSheets.py has what the others see."""
        for name in ("OS1_64", "Mid40"):
            with self.subTest(name):
                sensor = al.Sensor(name)
                said, aperture = sensor.description["sheet"], sensor.receiver_aperture
                found = sensor.fit()
                np.testing.assert_allclose(found.residuals, said["residuals"], atol=2e-3)
                self.assertAlmostEqual(found.numbers["receiver_aperture"] / aperture, 1, delta=0.01)
                np.testing.assert_allclose(found.bar, said.get("bar", np.nan), atol=5e-3)

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is empty")
    def test_intervals_hold_what_strangers_measured(self):
        """Bins of distance with the least reflectance (%, whole numbers) in frames of others. For OS0 and OS1 the table
        has the prediction. With EnergyLimits a surface's least reflectance grows with the square of the range and the
        air."""
        rows = rows_of(pathlib.Path(DATA) / "lidars_measured" / "least_reflectance.csv")
        ours = [(row["frame"], row["measured over predicted"]) for row in rows_of(
                    FILES.parents[1] / "Documentation" / "evidence" / "tables" / "measured-least.csv")]
        for kind, other, name in (("OS0-128", "OS0-32", "OS0_128"), ("OS1-128", "OS1-32", "OS1_64"),
                                  ("HDL-32E", "", "HDL32E")):
            with self.subTest(name):
                sensor = al.Sensor(name)
                low, high = sensor.description["range_interval"]["value"]
                factors = [float(ratio)**-0.5 for frame, ratio in ours if frame == other and ratio != "-"]
                inside, air = [], sensor.algorithm.GetClearAirAttenuation()
                for row in (row for row in rows if row["lidar"] == kind):
                    at, least, predicted = (float(row[key])
                                            for key in ("at_m", "least_reflectance_percent", "predicted_percent"))
                    if name == "HDL32E":
                        predicted = 100 * 0.35 * (at / 100)**2 * np.exp(2 * air * (at - 100))
                    if predicted / low**2 >= 1:  # else below what a scale of whole percents shows
                        inside.append(predicted / high**2 <= least + 0.5 and least - 0.5 <= predicted / low**2)
                        factors.append(np.sqrt(predicted / least))
                self.assertGreaterEqual(len(inside), 6)
                self.assertGreaterEqual(np.mean(inside), 0.9)
                self.assertLessEqual(high / low, 1.2 * max(factors) / min(factors))

    def test_each_lidar_on_sale_has_an_interval(self):
        for name in al.Sensor.presets():
            sensor = al.Sensor(name)
            self.assertEqual(reach.interval(sensor) is not None, sensor.on_sale, name)
        self.assertIn("0.84 to 1.81 times", _display.sensor_rows(al.Sensor("VLP16"))["interval of ranges"])
        sensor = al.Sensor("VLP16")
        found = reach.within_beams(sensor, "herring gull", birds=64).to(0.5)
        low, high = (one.to(0.5) for one in reach.in_interval(sensor, "herring gull", birds=64))
        self.assertTrue(0 < low < found < high)
        for bad, words in (([1.2, 2.0], "at most 1"), ([0.5], "at most 1"), ([0, 2], "at most 1")):
            file = self.folder / "bad.lidarsensor.json"
            file.write_text(json.dumps({**sensor.description,
                                        "range_interval": {"value": bad, "unit": "1", "source": "x"}}))
            with self.assertRaisesRegex(al.Error, words):
                al.Sensor(file)

    def test_numbers_that_a_file_lacks_are_marked(self):
        """The guide's example gives neither pattern nor pulse."""
        guide = (FILES.parents[1] / "Documentation" / "guide" / "lidars.md").read_text("utf-8")
        file = self.folder / "mine.lidarsensor.json"
        file.write_text(re.search(r"```json\n(.*?)```", guide, re.DOTALL)[1], "utf-8")
        rows = _display.sensor_rows(al.Sensor(file))
        for key in ("beams", "elevations", "pulse energy", "rate", "range gate"):
            self.assertIn("not given", str(rows[key]), key)
        self.assertNotIn("not given", rows["wavelength"])
        self.assertIn("500 m at 10 %", rows["point 1 of the sheet"])
        self.assertIn("does not give azimuth_step, elevation_step", error_of("reach", "--sensor", file))
        _, shown, _ = run("sensors", "Mid360")
        self.assertLessEqual(max(map(len, shown.splitlines())), 120)
        self.assertIn("61 %", shown)
        for name in al.Sensor.presets():
            self.assertEqual(al.Sensor(name).not_given, (), name)

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is empty")
    def test_patterns_are_those_of_real_frames(self):
        # Hesai's manuals have the angles of the design, the frames those of a unit; the tolerances are what these
        # differ by.
        for name, file, up, across in (("VLP-16", "lidar_vlp16_mrpt/vlp16.pcd", 1e-4, 0.005),
                                       ("Pandar40P", "lidar_room/pandar40p.pcd", 0.21, 0.011),
                                       ("PandarXT-32", "lidar_room/xt32.pcd", 0.09, 0.02),
                                       ("Helios-16P", "lidar_outdoor/helios16p_frame0.pcd", 0.01, 0.03)):
            with self.subTest(name):
                sensor = al.Sensor(name)
                azimuth, elevation, ring = frame(file)
                tabled = np.array(sensor.channel_elevations)
                rings = np.unique(ring)
                middle = np.array([np.median(elevation[ring == one]) for one in rings])
                # Each ring is nearest to a channel of its own.
                channel_of = np.abs(middle[:, None] - tabled).argmin(axis=1)
                self.assertEqual(len(set(channel_of)), len(rings))
                self.assertGreaterEqual(len(rings), len(tabled) - 4)  # one room shows nothing below
                self.assertLess(np.abs(middle - tabled[channel_of]).max(), up)
                # Lasers of one firing, in the order of their channels, are as far apart as the table says.
                channel = channel_of[np.searchsorted(rings, ring)]
                offsets = np.asarray(sensor.beams.fields.get("channel_azimuth_offsets", np.zeros(len(tabled))))
                next_to = np.flatnonzero(np.diff(channel) == (-1 if channel[1] < channel[0] else 1))
                turned = around(azimuth[next_to + 1] - azimuth[next_to])
                told = offsets[channel[next_to + 1]] - offsets[channel[next_to]]
                self.assertGreater(np.mean(np.abs(turned - told) < across), 0.99)  # where nothing is lost between two
                self.assertGreater(len(next_to), 0.4 * len(ring))
                # Neighbours of a ring are a step of the pattern apart.
                steps = np.concatenate([np.diff(np.sort(azimuth[ring == one])) for one in rings])
                self.assertAlmostEqual(np.median(steps[steps > 0.05]), sensor.azimuth_step, delta=0.002)

    def test_minimum_ranges_are_those_of_the_makers(self):
        least = {file.name.split(".")[0]: al.Sensor(file.name.split(".")[0]).minimum_range
                 for file in FILES.glob("*.lidarsensor.json")}
        self.assertEqual({name: m for name, m in least.items() if m},
                         {"HDL32E": 0.05, "Helios16P": 0.2, "Mid360": 0.1, "Mid40": 2.0, "OS0_128": 0.3, "OS1_64": 0.8,
                          "OS2_128": 1.0, "Pandar40P": 0.3, "PandarXT32": 0.05})


class Own(InFolder):
    def test_beams_go_where_and_when_they_are_told(self):
        rng = np.random.default_rng(1)
        directions = rng.normal(size=(500, 3))
        times = rng.uniform(0, 1.9, 500)
        places = rng.normal(size=(500, 3))
        sensor = al.Sensor("Search905", directions=directions, times=times, positions=places, position=(1, 2, 3),
                           wavelength=1064.0)
        beams = sensor.beams
        unit = directions / np.linalg.norm(directions, axis=1)[:, None]
        np.testing.assert_allclose(beams["direction"], unit, atol=1e-15)
        np.testing.assert_allclose(beams.points, places + (1, 2, 3), atol=1e-15)
        np.testing.assert_allclose(beams["timestamp"], 1e6 * times)
        np.testing.assert_allclose(beams["azimuth"], 100 * (np.degrees(np.arctan2(unit[:, 0], unit[:, 1])) % 360))
        np.testing.assert_allclose(beams["vertical_angle"], np.degrees(np.arcsin(unit[:, 2])))
        np.testing.assert_array_equal(beams["beam_id"], np.arange(500))
        self.assertEqual(beams.fields["wavelength"], 1064.0)
        self.assertFalse({"number_of_channels", "azimuth_step", "minimum_elevation"} & set(beams.fields))
        sensor.orientation = (90, 0, 0)  # a quarter turn clockwise: north becomes east
        np.testing.assert_allclose(sensor.beams["direction"], np.column_stack([unit[:, 1], -unit[:, 0], unit[:, 2]]),
                                   atol=1e-15)
        # Times that a scan has no room for make it longer, unless it is told how long it is.
        self.assertEqual(al.Sensor(directions=[(0, 1, 0)], times=[4.0]).rotation_rate, 0.25)
        with self.assertRaisesRegex(al.Error, "the time of beam 0 is 4, expected 0 to the 2 s of a scan"):
            al.Sensor(directions=[(0, 1, 0)], times=[4.0], rotation_rate=0.5).beams  # noqa: B018
        sensor.algorithm.SetPresetToAirport16()
        self.assertEqual(sensor.beams.number_of_points, 15360)

    def test_the_pattern_as_a_table_has_the_same_echoes(self):
        scene = al.Scene(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Glass")
        pattern = al.Sensor("VLP-16", azimuth_range=(-6, 6))
        table = al.Sensor("VLP-16", directions=pattern.beams["direction"], times=1e-6 * pattern.beams["timestamp"])
        one, other = (al.Scan(scene, sensor, rays_per_beam=50) for sensor in (pattern, table))
        self.assertGreater(one.echoes.number_of_points, 10)
        for name in ("beam_id", "energy", "distance_m", "timestamp", "azimuth"):
            np.testing.assert_allclose(other[name], one[name], rtol=1e-12, err_msg=name)
        # no rows and columns
        other.save("list.pcd")
        self.assertEqual(al.load_cloud("list.pcd").number_of_points, other.echoes.number_of_points)
        with self.assertRaisesRegex(al.Error, "set Columns and Rows"):
            other.range_image()

    def test_copies(self):
        mine = {"directions": [(0, 1, 0), (1, 0, 0)], "times": [0, 1e-3], "positions": [(0, 0, 1), (0, 0, 2)]}
        for sensor in (al.Sensor("VLP-32C", pulse_energy=1e-6), al.Sensor("Avia", orientation=(20, 5, 0)),
                       al.Sensor("Search905", **mine, orientation=(10, 0, 0))):
            for again in (pickle.loads(pickle.dumps(sensor)), copy.deepcopy(sensor)):
                self.assertEqual(again.description, sensor.description)
                one, other = sensor.beams, again.beams
                self.assertEqual(repr(other.fields), repr(one.fields))
                self.assertTrue(same(one, other))
        with self.assertRaisesRegex(al.Error, "LoadSensorText: the text"):
            al.Sensor.__new__(al.Sensor).__setstate__({"text": "{}"})

    def test_wrong_tables_of_beams_are_errors(self):
        for words, arguments in (
                (r"directions have the shape \(3,\)", {"directions": (0, 1, 0)}),
                (r"times have the shape \(1,\)", {"directions": np.ones((2, 3)), "times": [0]}),
                (r"positions have the shape \(2,\)", {"directions": np.ones((2, 3)), "positions": [0, 1]}),
                ("beam 1: point array 'direction' is zero", {"directions": [(0, 1, 0), (0, 0, 0)]}),
                ("times and positions", {"times": [0]})):
            with self.subTest(words), self.assertRaisesRegex((ValueError, TypeError, al.Error), words):
                al.Sensor(**arguments).beams  # noqa: B018
        # Text does not count as a missing array; refused values change nothing.
        source = al.Sensor().algorithm
        beams, text = vtkPolyData(), text_array(2)
        beams.ShallowCopy(al.Sensor(directions=[(0, 1, 0), (1, 0, 0)], times=[0, 1e-3]).beams.data)
        text.SetName("timestamp")
        beams.GetPointData().AddArray(text)
        messages = echotools.Messages(source)
        self.assertFalse(source.SetBeams(beams))
        self.assertIn("SetBeams: point array 'timestamp' holds no numbers", " ".join(messages.errors))
        source.Update()
        self.assertEqual(source.GetOutput().GetNumberOfPoints(), 15360)


class Reader(InFolder):
    def test_reads_a_file_and_stays_in_its_place(self):
        reader = vtkAvianLidar.vtkAvianLidarSensorReader()
        reader.ErrorsAsDataOn()  # else VTK prints that it failed
        heard = []
        reader.AddObserver("ErrorEvent", lambda *_: heard.append(1))
        reader.SetPosition(1, 2, 3)
        reader.Update()
        self.assertEqual((len(heard), reader.GetOutput().GetNumberOfPoints()), (1, 0))
        file = self.folder / "own.lidarsensor.json"
        good = json.loads((FILES / "VLP32C.lidarsensor.json").read_text("utf-8"))
        file.write_text(json.dumps(good), "utf-8")
        reader.SetFileName(str(file))
        reader.Update()
        expected = al.Sensor(file, position=(1, 2, 3)).beams
        beams = al.Cloud(reader.GetOutput())
        self.assertEqual(beams.number_of_points, 57856)
        self.assertTrue(same(beams, expected))
        self.assertEqual(repr(beams.fields), repr(expected.fields))
        # A change of the file counts when it is asked for, and a bad one is an error until the next good one.
        del good["values"]["wavelength"]["source"]
        file.write_text(json.dumps(good), "utf-8")
        reader.Update()
        self.assertEqual(len(heard), 1)
        reader.Reload()
        reader.Update()
        self.assertEqual((len(heard), reader.GetOutput().GetNumberOfPoints()), (2, 0))
        reader.SetFileName(str(FILES / "VLP16.lidarsensor.json"))
        reader.Update()
        self.assertEqual((len(heard), reader.GetOutput().GetNumberOfPoints()), (2, 28928))
        self.assertEqual(reader.GetPosition(), (1, 2, 3))
