# SPDX-License-Identifier: BSD-3-Clause
"""Mast sway and encoder jitter: beams leave in other directions than the sensor reports. Ranges are those of the real
directions, echoes lie along the reported ones."""

import os
import tempfile
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

from avianlidar import vtkAvianLidar as al
from echotools import COSTS, RAYS, Messages, array, arrays, assert_same_bits, box, scan, sensor, town

PIPELINE = vtk.vtkStreamingDemandDrivenPipeline
NOMINAL = ("beam_id", "laser_id", "azimuth", "vertical_angle", "timestamp")


def moving(sway=0.3, jitter=0.0, seed=0, columns=90, channels=4):
    lidar = sensor(columns, channels)
    lidar.SetSwayAmplitude(sway)
    lidar.SetEncoderJitter(jitter)
    lidar.SetMotionSeed(seed)
    return lidar


def at(algorithm, time, port=0):
    """A copy of the output at a time."""
    algorithm.UpdateInformation()
    algorithm.GetOutputInformation(port).Set(PIPELINE.UPDATE_TIME_STEP(), time)
    algorithm.Update(port)
    copy = algorithm.GetOutputDataObject(port).NewInstance()
    copy.DeepCopy(algorithm.GetOutputDataObject(port))
    return copy


def output(algorithm):
    algorithm.Update()
    return algorithm.GetOutput()


def points(data):
    return numpy_support.vtk_to_numpy(data.GetPoints().GetData())


def nominal(data):
    """Unit vectors of the angles that the sensor reports."""
    azimuth, elevation = np.radians(array(data, "azimuth") / 100), np.radians(array(data, "vertical_angle"))
    return np.column_stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)])


def rotation(before, after):
    """The matrix that turns unit vectors, and its axis times its angle (rad)."""
    left, _, right = np.linalg.svd(after.T @ before)
    turn = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    np.testing.assert_allclose(before @ turn.T, after, atol=1e-14)
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    return turn, axis / np.linalg.norm(axis) * np.arcsin(np.linalg.norm(axis) / 2)


class Beams(unittest.TestCase):
    def test_off_adds_nothing(self):
        plain = output(sensor())
        for seed, frequency in ((0, 0.5), (5, 3.0)):
            lidar = moving(0.0, 0.0, seed)
            lidar.SetSwayFrequency(frequency)
            assert_same_bits(plain, output(lidar))
            for port in (0, 1):
                fields = lidar.GetOutput(port).GetFieldData()
                for name in ("sway_amplitude", "sway_frequency", "encoder_jitter", "motion_seed"):
                    self.assertFalse(fields.HasArray(name), name)
        self.assertFalse(plain.GetPointData().HasArray("reported_direction"))

    def test_the_sensor_reports_what_it_always_did(self):
        plain = output(sensor())
        for sway, jitter in ((0.3, 0), (0, 0.2), (0.3, 0.2)):
            beams = output(moving(sway, jitter))
            for name in NOMINAL:
                np.testing.assert_array_equal(array(beams, name), array(plain, name))
            np.testing.assert_array_equal(array(beams, "reported_direction"), array(plain, "direction"))
            real = array(beams, "direction")
            np.testing.assert_allclose(np.linalg.norm(real, axis=1), 1, atol=1e-15)
            angles = np.linalg.norm(real - array(plain, "direction"), axis=1)
            self.assertTrue((angles > 0).all())
            self.assertLess(angles.max(), np.radians(5.7 * 2**0.5 * (sway + jitter)))

    def test_fields_say_what_is_on(self):
        for sway, jitter, expected in (
            (0.3, 0.0, {"sway_amplitude": (0.3, "deg"), "sway_frequency": (0.5, "Hz"), "motion_seed": (7, None)}),
            (0.0, 0.2, {"encoder_jitter": (0.2, "deg"), "motion_seed": (7, None)}),
        ):
            lidar = moving(sway, jitter, 7)
            echo = scan(town(), lidar)
            echo.Update()
            for data in (lidar.GetOutput(0), lidar.GetOutput(1), echo.GetOutput(0), echo.GetOutput(1)):
                for name in ("sway_amplitude", "sway_frequency", "encoder_jitter", "motion_seed"):
                    field = data.GetFieldData().GetArray(name)
                    self.assertEqual(field is not None, name in expected, name)
                    if field:
                        value, unit = expected[name]
                        self.assertEqual(field.GetComponent(0, 0), value)
                        self.assertEqual(field.GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL()), unit)

    def test_rays_to_look_at_are_the_real_ones(self):
        lidar = moving(2.0)
        lidar.SetDisplayLength(100)
        beams = output(lidar)
        ends = points(lidar.GetOutput(1))[1::2]
        np.testing.assert_allclose(ends, 100 * array(beams, "direction"), atol=1e-12)

    def test_jitter_turns_columns_and_sway_tilts_all(self):
        beams = output(moving(0.0, 0.5))
        real = array(beams, "direction").reshape(-1, 4, 3)
        azimuths = np.degrees(np.arctan2(real[:, :, 0], real[:, :, 1]))
        np.testing.assert_allclose(azimuths, azimuths[:, :1] * np.ones(4), atol=1e-12)
        np.testing.assert_allclose(real[:, :, 2], np.sin(np.radians(np.arange(4.0))) * np.ones((90, 1)), atol=1e-15)
        errors = np.remainder(azimuths[:, 0] - 4 * np.arange(90) + 180, 360) - 180
        self.assertEqual(len(set(errors)), 90)
        self.assertAlmostEqual(errors.std(), 0.5, delta=3 * 0.5 / (2 * 90) ** 0.5)

    def test_revolutions_pieces_and_steps(self):
        lidar = moving(0.3, 0.1)
        lidar.SetStepsPerRevolution(3)
        first, second = at(lidar, 1.99), at(lidar, 3.99)
        self.assertEqual(first.GetNumberOfPoints(), 360)
        np.testing.assert_array_equal(array(first, "reported_direction"), array(second, "reported_direction"))
        self.assertFalse((array(first, "direction") == array(second, "direction")).all(axis=1).any())
        part = at(lidar, 2.7)
        np.testing.assert_array_equal(array(part, "direction"), array(second, "direction")[: part.GetNumberOfPoints()])
        again = moving(0.3, 0.1)
        np.testing.assert_array_equal(array(at(again, 2.0), "direction"), array(second, "direction"))
        for pieces in (2, 7):
            for piece in range(pieces):
                some = moving(0.3, 0.1)
                some.UpdateInformation()
                some.GetOutputInformation(0).Set(PIPELINE.UPDATE_TIME_STEP(), 2.0)
                some.UpdatePiece(piece, pieces, 0)
                ids = array(some.GetOutput(), "beam_id")
                np.testing.assert_array_equal(array(some.GetOutput(), "direction"), array(second, "direction")[ids])

    def test_a_sensor_file_may_say_it(self):
        text = """{"format": "lidarsensor 1", "name": "Mast", "values": {
            "sway_amplitude": {"value": 0.02, "unit": "deg", "source": "assumed"},
            "sway_frequency": {"value": 0.8, "unit": "Hz", "source": "assumed"},
            "encoder_jitter": {"value": 0.01, "unit": "%s", "source": "data sheet"}}}"""
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "mast.lidarsensor.json")
            lidar = al.vtkAvianLidarBeamSource()
            for unit, good in (("deg", True), ("rad", False)):
                with open(name, "w", encoding="utf-8") as file:
                    file.write(text % unit)
                messages = Messages(lidar)
                self.assertEqual(lidar.LoadSensor(name), good)
                self.assertEqual(len(messages.errors), 0 if good else 1)
        self.assertEqual((lidar.GetSwayAmplitude(), lidar.GetSwayFrequency(), lidar.GetEncoderJitter()), (0.02, 0.8, 0.01))
        lidar.SetPresetToAirport16()
        self.assertEqual((lidar.GetSwayAmplitude(), lidar.GetEncoderJitter()), (0.0, 0.0))


class Echoes(unittest.TestCase):
    def test_a_wall_is_as_far_as_the_real_beam_says(self):
        """A wall 100 m to the north: the range is 100 m / the north component of the real direction."""
        for sway, jitter in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
            lidar = moving(sway, jitter, 3)
            lidar.SetAzimuthRange(-40, 40)
            lidar.SetMinimumElevation(20)
            lidar.SetHalfBeamwidth(1e-5)
            echo = scan(box((0, 101, 0), (900, 1, 900), "Wall"), lidar)
            echo.Update()
            echoes = echo.GetOutput()
            beams = lidar.GetOutput()
            index = {beam: i for i, beam in enumerate(array(beams, "beam_id"))}
            rows = [index[beam] for beam in array(echoes, "beam_id")]
            self.assertEqual(len(rows), len(index))
            ranges = array(echoes, "distance_m")
            expected = 100 / array(beams, "direction")[rows, 1]
            np.testing.assert_allclose(ranges, expected, rtol=1e-5)
            unmoved = 100 / array(beams, "reported_direction")[rows, 1]
            self.assertGreater(np.abs(ranges - unmoved).max(), 0.5)
            np.testing.assert_allclose(points(echoes), ranges[:, None] * array(beams, "reported_direction")[rows],
                                       atol=1e-12)

    def test_beams_of_one_moment_share_one_tilt(self):
        """A column fired at once is turned by one rotation about a horizontal axis, and a wall's ranges are its closed form."""
        lidar = moving(2.0, 0.0, 1, 1, 5)
        lidar.SetMinimumElevation(20)
        lidar.SetFiringInterval(0.0)
        lidar.SetHalfBeamwidth(1e-5)
        echo = scan(box((0, 101, 0), (900, 1, 900), "Wall"), lidar)
        angles = []
        for revolution in range(4):
            ranges = array(at(echo, 2.0 * revolution), "distance_m")
            beams = at(lidar, 2.0 * revolution)
            turn, tilt = rotation(array(beams, "reported_direction"), array(beams, "direction"))
            elevation = np.radians(20 + np.arange(5.0))
            north = turn[1, 1] * np.cos(elevation) + turn[1, 2] * np.sin(elevation)
            np.testing.assert_allclose(ranges, 100 / north, rtol=1e-5)
            self.assertAlmostEqual(tilt[2], 0, places=10)
            angles.append(np.degrees(tilt[:2]))
        self.assertGreater(np.std(angles), 0.5)
        self.assertLess(np.std(angles), 6)

    def test_echoes_and_report_lie_on_reported_directions(self):
        lidar = moving(0.5, 0.3)
        lidar.SetPosition(3, -2, 1)
        lidar.SetOrientation(30, 5, -3)
        echo = scan(town(), lidar)
        echo.Update()
        echoes, beam_report = echo.GetOutput(0), echo.GetOutput(1)
        self.assertGreater(echoes.GetNumberOfPoints(), 20)
        offsets = points(echoes) - (3, -2, 1)
        np.testing.assert_allclose(offsets, array(echoes, "distance_m")[:, None] * nominal(echoes), atol=1e-9)
        offsets = points(beam_report) - (3, -2, 1)
        np.testing.assert_allclose(offsets / np.linalg.norm(offsets, axis=1)[:, None],
                                   array(lidar.GetOutput(), "reported_direction"), atol=1e-12)

    def test_off_is_a_scan_as_before(self):
        plain, off = scan(town()), scan(town(), moving(0.0, 0.0, 9))
        plain.Update()
        off.Update()
        for port in (0, 1):
            assert_same_bits(plain.GetOutput(port), off.GetOutput(port))

    def test_revolutions_differ_and_come_again(self):
        echo = scan(town(), moving(0.3, 0.1), BeamSamples=RAYS)
        first = at(echo, 0.0)
        second = at(echo, 2.0)
        self.assertGreater(echo.GetNumberOfTracedRays(), 0)
        self.assertFalse(np.array_equal(array(first, "energy"), array(second, "energy")))
        assert_same_bits(first, at(echo, 0.0), COSTS)
        assert_same_bits(second, at(scan(town(), moving(0.3, 0.1), BeamSamples=RAYS), 2.0), COSTS)

    def test_angles_not_given_are_those_reported(self):
        beams = output(moving(2.0))
        table = vtk.vtkPolyData()
        table.DeepCopy(beams)
        for name in ("azimuth", "vertical_angle"):
            table.GetPointData().RemoveArray(name)
        given, derived = scan(town(), beams), scan(town(), table)
        given.Update()
        derived.Update()
        for name in ("azimuth", "vertical_angle"):
            np.testing.assert_allclose(array(given.GetOutput(1), name), array(derived.GetOutput(1), name), atol=1e-9)

    def test_a_changed_report_moves_echoes_and_traces_nothing(self):
        beams = output(moving(0.3))
        table = vtk.vtkPolyData()
        table.DeepCopy(beams)
        echo = scan(town(), table)
        echo.Update()
        before = arrays(echo.GetOutput())
        values = table.GetPointData().GetArray("reported_direction")
        numpy_support.vtk_to_numpy(values)[:] = 2 * array(beams, "direction")
        values.Modified()
        echo.Update()
        self.assertEqual(echo.GetNumberOfTracedRays(), 0)
        after = arrays(echo.GetOutput())
        np.testing.assert_array_equal(before["energy"], after["energy"])
        np.testing.assert_allclose(after["points"], after["distance_m"][:, None] * array(beams, "direction")[after["beam_id"]],
                                   atol=1e-9)
        self.assertFalse(np.array_equal(before["points"], after["points"]))

    def test_bad_reports_are_named(self):
        for spoil, words in (
            (lambda a: a.SetTuple3(5, 0, 0, 0), "beam 5: point array 'reported_direction' is zero"),
            (lambda a: a.SetTuple3(5, 0, float("nan"), 0), "beam 5: point array 'reported_direction' is not finite"),
            (lambda a: a.SetNumberOfTuples(1), "'reported_direction' has 1 values"),
        ):
            table = vtk.vtkPolyData()
            table.DeepCopy(output(moving()))
            spoil(table.GetPointData().GetArray("reported_direction"))
            echo = scan(town(), table)
            messages = Messages(echo)
            echo.Update()
            self.assertIn(words, messages.errors[0])
            self.assertEqual(echo.GetOutput().GetNumberOfPoints(), 0)


class Images(unittest.TestCase):
    def test_a_range_image_has_the_sensors_grid(self):
        for tilt in ((0, 0, 0), (30, 5, -3)):
            lidar = moving(0.5, 0.3)
            lidar.SetOrientation(*tilt)
            for keep in (True, False):
                beams = lidar
                if not keep and tilt == (0, 0, 0):  # a table without angles: its grid is that of the directions reported
                    beams = vtk.vtkPolyData()
                    beams.DeepCopy(output(lidar))
                    beams.GetPointData().RemoveArray("azimuth")
                    beams.GetPointData().RemoveArray("vertical_angle")
                image = al.vtkAvianLidarRangeImage()
                echo = scan(town(), beams)
                image.SetInputConnection(0, echo.GetOutputPort(0))
                if beams is lidar:
                    image.SetInputConnection(1, lidar.GetOutputPort())
                else:
                    image.SetInputData(1, beams)
                    image.SetColumns(90)
                    image.SetRows(4)
                messages = Messages(image, echo)
                image.Update()
                self.assertEqual(messages.all(), [])
                self.assertEqual(image.GetOutput().GetDimensions(), (90, 4, 1))
                distances = array(image.GetOutput(), "distance_m")
                self.assertEqual(np.isfinite(distances).sum(), len(set(array(echo.GetOutput(), "beam_id"))))


if __name__ == "__main__":
    unittest.main()
