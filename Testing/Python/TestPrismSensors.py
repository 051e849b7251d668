# SPDX-License-Identifier: BSD-3-Clause
"""Sensors with rotating prisms: scans are windows of time, fields of view are the makers', filters take their beams; and what is
said where a file is wrong."""
import copy
import json
import os
import pathlib
import pickle
import tempfile
import unittest

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersSources import vtkSphereSource

import avianlidar as al
from avianlidar import vtkAvianLidar
from helpertools import WALL

FILES = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Filters" / "Sensors"
PRISMS = {"Mid40": 10_000, "Avia": 24_000, "Mid360": 20_000}  # beams of a window


def window(sensor, number):
    """A copy of a scan's beams."""
    sensor.algorithm.UpdateTimeStep(number / sensor.rotation_rate)
    copied = vtkPolyData()
    copied.DeepCopy(sensor.algorithm.GetOutput())
    return al.Cloud(copied)


def traced(wedges, indices, rates, phases, time, enters):
    """Light through prisms, by the component along a face that a refraction keeps."""
    light = np.array(enters, dtype=float)
    for wedge, index, rate, phase in zip(np.radians(wedges), indices, rates, np.radians(phases)):
        turn = 2 * np.pi * rate * time + phase
        inclined = np.column_stack([-np.sin(wedge) * np.sin(turn), np.full(len(time), np.cos(wedge)), -np.sin(wedge) * np.cos(turn)])
        plane = np.broadcast_to([0.0, 1.0, 0.0], inclined.shape)
        wave = light
        for normal, behind in zip((plane, inclined) if wedge >= 0 else (inclined, plane), (index, 1.0)):
            along = np.sum(wave * normal, axis=1)[:, None]
            kept = wave - along * normal
            wave = kept + np.sqrt(behind ** 2 - np.sum(kept ** 2, axis=1)[:, None]) * normal
        light = wave
    return light


class Windows(unittest.TestCase):
    def test_each_scan_has_directions_of_its_own(self):
        for name, count in PRISMS.items():
            with self.subTest(name):
                sensor = al.Sensor(name)
                values = sensor.description["values"]
                first, second, again = (window(sensor, number) for number in (0, 1, 0))
                self.assertEqual(first.number_of_points, count)
                self.assertEqual(count * sensor.rotation_rate, sensor.description["data_sheet"]["points_per_second"]["value"])
                np.testing.assert_array_equal(first["direction"], again["direction"])
                self.assertGreater(np.abs(first["direction"] - second["direction"]).max(axis=1).mean(), 0.05)
                np.testing.assert_allclose(second["timestamp"], first["timestamp"] + 1e5, atol=1e-6)
                self.assertEqual([int(cloud.fields["revolution"]) for cloud in (first, second)], [0, 1])
                # Against another way to refract, over the seventh window.
                beams = window(sensor, 7)
                time = 1e-6 * beams["timestamp"]
                lasers = beams["laser_id"]
                up = np.radians(np.array(values["channel_elevations"]["value"] if "channel_elevations" in values else [0]))[lasers]
                aside = np.radians(np.array(values.get("channel_azimuth_offsets", {"value": [0] * 9})["value"]))[lasers]
                enters = np.column_stack([np.cos(up) * np.sin(aside), np.cos(up) * np.cos(aside), np.sin(up)])
                expected = traced(*(values[f"prism_{key}"]["value"] for key in ("wedge_angles", "refractive_indices", "rotation_rates",
                                                                               "phases")), time, enters)
                tilt = np.radians(values.get("prism_axis_elevation", {"value": 0})["value"])
                x, y, z = expected[:, 0], np.cos(tilt) * expected[:, 1] - np.sin(tilt) * expected[:, 2], \
                    np.sin(tilt) * expected[:, 1] + np.cos(tilt) * expected[:, 2]
                turn = 2 * np.pi * values.get("prism_axis_rotation_rate", {"value": 0})["value"] * time
                expected = np.column_stack([np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x, z])
                np.testing.assert_allclose(beams["direction"], expected, atol=1e-9)

    def test_steps_and_pieces_are_the_whole(self):
        sensor = al.Sensor("Avia", steps_per_revolution=4, number_of_revolutions=3)
        whole = window(al.Sensor("Avia"), 2)
        sensor.algorithm.UpdateTimeStep(0.2 + 0.025)
        half = al.Cloud(sensor.algorithm.GetOutput())
        self.assertEqual(half.number_of_points, 6000 * 2)
        fired = np.sort(whole["timestamp"])
        np.testing.assert_array_equal(np.sort(half["timestamp"]), fired[fired < 2.5e5])
        ids = []
        for piece in range(3):
            sensor.algorithm.UpdatePiece(piece, 3, 0)
            ids += list(al.Cloud(sensor.algorithm.GetOutput())["beam_id"])
        self.assertEqual(len(set(ids)), len(ids))

    def test_field_data_say_what_there_is(self):
        fields = al.Sensor("Mid40").beams.fields
        np.testing.assert_array_equal(fields["prism_wedge_angles"], [18, -18])
        self.assertFalse({"azimuth_step", "azimuth_range", "prism_axis_elevation"} & set(fields))
        self.assertEqual(float(fields["firing_interval"]), 1e-5)
        self.assertEqual(float(al.Sensor("Mid360").beams.fields["prism_axis_elevation"]), 22.55)
        self.assertIn("prism_wedge_angles", al.Sensor("Mid360").beams.fields["assumed"])
        self.assertNotIn("prism_wedge_angles", al.Sensor("Mid40").beams.fields["assumed"])
        # Beams of one's own in their place, and another sensor.
        own = al.Sensor("Mid40", directions=[(0, 1, 0)]).beams.fields
        self.assertFalse({"prism_wedge_angles", "firing_interval"} & set(own))
        sensor = vtkAvianLidar.vtkAvianLidarBeamSource()
        sensor.SetPresetToMid360()
        self.assertEqual(sensor.GetNumberOfPrisms(), 2)
        self.assertIn("PrismWedgeAngles: (2) 26.4 -26.4\n", str(sensor))
        sensor.SetPresetToAirport16()
        self.assertEqual(sensor.GetNumberOfPrisms(), 0)

    def test_copies_are_the_same(self):
        sensor = al.Sensor("Avia", position=(1, 2, 3), orientation=(20, 5, 0))
        for same in (copy.deepcopy(sensor), pickle.loads(pickle.dumps(sensor))):
            np.testing.assert_array_equal(window(same, 5)["direction"], window(sensor, 5)["direction"])

    def test_sway_moves_them_too(self):
        sensor = al.Sensor("Mid40", sway_amplitude=0.5)
        beams = window(sensor, 3)
        np.testing.assert_allclose(beams["reported_direction"], window(al.Sensor("Mid40"), 3)["direction"], atol=1e-15)
        apart = np.degrees(np.linalg.norm(beams["direction"] - beams["reported_direction"], axis=1))
        self.assertGreater(apart.max(), 0.05)


class FieldsOfView(unittest.TestCase):
    def extent(self, name, windows=20):
        sensor = al.Sensor(name)
        directions = np.concatenate([window(sensor, number)["direction"] for number in range(windows)])
        azimuth = np.degrees(np.arctan2(directions[:, 0], directions[:, 1]))
        elevation = np.degrees(np.arcsin(directions[:, 2]))
        return directions, azimuth, elevation

    def test_makers_figures(self):
        directions, _, _ = self.extent("Mid40")
        self.assertAlmostEqual(2 * np.degrees(np.arccos(directions[:, 1].min())), 38.4, delta=0.05)
        _, azimuth, elevation = self.extent("Avia")
        self.assertAlmostEqual(np.ptp(azimuth), 70.4, delta=0.1)
        self.assertAlmostEqual(np.ptp(elevation), 77.2, delta=0.5)  # 76.8: nothing was fitted to it
        _, azimuth, elevation = self.extent("Mid360")
        self.assertAlmostEqual(elevation.min(), -7, delta=0.2)
        self.assertAlmostEqual(elevation.max(), 52, delta=0.2)
        self.assertLess(np.diff(np.sort(azimuth)).max(), 0.1)

    def test_more_of_it_is_covered_with_time(self):
        sensor = al.Sensor("Mid40")
        random = np.random.default_rng(3)
        up = 1 - random.uniform(0, 1 - np.cos(np.radians(19)), 3000)
        about = random.uniform(0, 2 * np.pi, 3000)
        drawn = np.column_stack([np.sqrt(1 - up ** 2) * np.cos(about), up, np.sqrt(1 - up ** 2) * np.sin(about)])
        seen, shares = np.zeros(3000, dtype=bool), []
        for number in range(10):
            axis = window(sensor, number)["direction"]
            right = np.cross(axis, [0, 0, 1])
            right /= np.linalg.norm(right, axis=1)[:, None]
            ahead = drawn @ axis.T
            place = [drawn @ across.T / ahead / np.tan(half) for across, half in (
                (right, sensor.half_beamwidth), (np.cross(right, axis), sensor.half_beamwidth_across))]
            seen |= np.any((place[0]**2 + place[1]**2 <= 1) & (ahead > 0), axis=1)
            shares.append(seen.mean())
        # 10,000 ellipses with the area of discs of 0.8 mrad have 5.7 % of the field's, and overlap.
        self.assertTrue(0.03 < shares[0] < 0.057, shares[0])
        self.assertGreater(shares[-1], 7 * shares[0])
        self.assertTrue(all(np.diff(shares) >= 0))


class Use(unittest.TestCase):
    def test_echoes_lie_on_the_wall_at_their_time(self):
        y = 20.0
        corners = [(-30, y, -30), (30, y, -30), (30, y, 30), (-30, y, 30)]
        scan = al.Scan(al.Scene((corners, [(0, 1, 2), (0, 2, 3)])), al.Sensor("Mid40"), noise=False, rays_per_beam=16)
        for number in (0, 4):
            scan.algorithm.UpdateTimeStep(0.1 * number)
            echoes = al.Cloud(scan.algorithm.GetOutput())
            self.assertEqual(echoes.number_of_points, 10_000)
            np.testing.assert_allclose(echoes.points[:, 1], y, atol=0.02)
            beams = window(al.Sensor("Mid40"), number)
            np.testing.assert_array_equal(echoes["timestamp"], beams["timestamp"][np.searchsorted(beams["beam_id"], echoes["beam_id"])])

    def test_movers_are_met_where_they_are(self):
        ball = vtkSphereSource()
        ball.SetRadius(1.5)
        ball.Update()
        flying = al.mover(ball.GetOutput(), [(-8, 25, 0), (8, 25, 0)], times=[0, 1])
        scan = al.Scan(al.Scene(WALL), al.Sensor("Mid40"), movers=[flying], noise=False, rays_per_beam=16)
        for number in (1, 5, 8):
            scan.algorithm.UpdateTimeStep(0.1 * number)
            echoes = al.Cloud(scan.algorithm.GetOutput())
            near = np.abs(np.array(echoes.points[:, 1]) - 24.5) < 1.6
            self.assertGreater(near.sum(), 20)
            middle = -8 + 16 * 1e-6 * np.array(echoes["timestamp"])[near]
            self.assertLess(np.abs(echoes.points[near, 0] - middle).max(), 1.6)

    def test_a_range_image_has_a_row_for_each_laser(self):
        sensor = al.Sensor("Avia")
        scan = al.Scan(al.Scene(WALL), sensor, noise=False, rays_per_beam=16)
        image = vtkAvianLidar.vtkAvianLidarRangeImage()
        image.SetInputConnection(0, scan.algorithm.GetOutputPort(0))
        image.SetInputConnection(1, sensor.algorithm.GetOutputPort(0))
        image.SetColumns(4000)
        image.SetRows(6)
        image.Update()
        self.assertIn(image.GetOutput().GetDimensions()[:2], ((4000, 6), (4001, 7)))
        own = scan.range_image()
        self.assertEqual(own["distance_m"].shape, (6, 4000))
        self.assertEqual(np.isfinite(own["distance_m"]).sum(), scan.echoes.number_of_points)

    def test_pcd_files_are_lists(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor("Mid40"), noise=False, rays_per_beam=16)
        scan.update()
        with tempfile.TemporaryDirectory() as folder:
            file = str(pathlib.Path(folder) / "echoes.pcd")
            scan.echoes.save(file)
            self.assertEqual(al.load_cloud(file).number_of_points, scan.echoes.number_of_points)


class BadFiles(unittest.TestCase):
    def message(self, change):
        text = json.loads((FILES / "Mid40.lidarsensor.json").read_text(encoding="utf-8"))
        change(text["values"])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "bad.lidarsensor.json"
            file.write_text(json.dumps(text), encoding="utf-8")
            with self.assertRaises(Exception) as caught:
                al.Sensor(file).beams
        self.assertIn("bad.lidarsensor.json", str(caught.exception))
        return str(caught.exception)

    def test_values_are_named(self):
        def number(name, value, unit=None):
            def change(values):
                values.setdefault(name, {"unit": unit, "source": "test"})["value"] = value
            return change

        for change, words in ((number("prism_wedge_angles", [18, -70]), "PrismWedgeAngles is -70, expected angles within [-60, 60]"),
                              (number("prism_wedge_angles", [45, -45]), "the light of channel 0 is totally reflected"),
                              (number("prism_refractive_indices", [1.5]), "PrismRefractiveIndices has 1 values, expected one for each of the 2"),
                              (number("prism_rotation_rates", [1, 2, 3]), "PrismRotationRates has 3 values"),
                              (number("prism_phases", [0, 400]), "PrismPhases is 400"),
                              (number("prism_axis_elevation", 100, "deg"), "PrismAxisElevation is 100"),
                              (number("prism_axis_elevation", 10, "rad"), 'its unit is "rad", expected "deg"'),
                              (number("prism_axis_rotation_rate", 1e7, "Hz"), "PrismAxisRotationRate is 10000000"),
                              (lambda values: values.pop("prism_wedge_angles"), "PrismWedgeAngles is empty"),
                              (number("blanked_sectors", [0, 10], "deg"), "BlankedSectors has values, expected none with prisms"),
                              (number("encoder_jitter", 0.1, "deg"), ", expected 0 with prisms, whose beams have no columns"),
                              (number("firing_interval", 0), "FiringInterval is 0, expected a time above 0 s with prisms"),
                              (number("firing_interval", 1), "expected at most the 0.1 s that RotationRate leaves to a scan")):
            with self.subTest(words):
                self.assertIn(words, self.message(change))


class Ouster(unittest.TestCase):
    def test_angles_and_ranges(self):
        for name, low, high, most in (("OS0-128", -46.26, 45.75, 11.35), ("OS2-128", -11.09, 10.76, 2.11)):
            with self.subTest(name):
                sensor = al.Sensor(name)
                self.assertEqual(sensor.beams.number_of_points * sensor.rotation_rate, 1_310_720)
                self.assertEqual((min(sensor.channel_elevations), max(sensor.channel_elevations)), (low, high))
                self.assertAlmostEqual(np.abs(sensor.beams.fields["channel_azimuth_offsets"]).max(), most)

    def test_no_number_pretends(self):
        for name in ("OS0_128", "OS2_128", *PRISMS):
            said = al.Sensor(name).description
            self.assertIn("second-hand", json.dumps(said))
            for key, entry in {**said["values"], **said["data_sheet"]}.items():
                self.assertRegex(entry["source"], "^(assumed|second-hand|calculated|fitted|ouster-sdk|OS|LiAir|Livox wiki)", f"{name}: {key}")


if __name__ == "__main__":
    unittest.main()
