# SPDX-License-Identifier: BSD-3-Clause
"""Mast sway and encoder jitter in the filters: beams leave in other directions than the sensor reports. Ranges are
those of the real directions, echoes lie along the reported ones. How large both are is tested in
TestPointingErrors.cxx."""
import unittest

import numpy as np

from avianlidar import vtkAvianLidar as al
from cloudtools import points
from echotools import COSTS, RAYS, Messages, array, assert_same_bits, box, copy_of, given, output, scan, sensor, town

FIELDS = ("sway_amplitude", "sway_frequency", "encoder_jitter", "motion_seed")


def moving(sway=0.3, jitter=0.0, seed=0):
    return given(sensor(90, 4), SwayAmplitude=sway, EncoderJitter=jitter, MotionSeed=seed)


def at(algorithm, time):
    """A copy of the output at a time."""
    algorithm.UpdateTimeStep(time)
    return copy_of(algorithm.GetOutputDataObject(0))


class Beams(unittest.TestCase):
    def test_off_adds_nothing(self):
        plain, lidar = output(sensor()), moving(0.0, 0.0, 5)
        lidar.SetSwayFrequency(3.0)
        assert_same_bits(plain, output(lidar))
        self.assertFalse(plain.GetPointData().HasArray("reported_direction"))
        for port in (0, 1):
            self.assertFalse([name for name in FIELDS if lidar.GetOutput(port).GetFieldData().HasArray(name)])

    def test_the_sensor_reports_what_it_always_did(self):
        plain = output(sensor())
        for sway, jitter in ((0.3, 0), (0, 0.2)):
            lidar = moving(sway, jitter, 7)
            lidar.SetDisplayLength(100)
            beams = output(lidar)
            for name in ("beam_id", "laser_id", "azimuth", "vertical_angle", "timestamp"):
                np.testing.assert_array_equal(array(beams, name), array(plain, name))
            np.testing.assert_array_equal(array(beams, "reported_direction"), array(plain, "direction"))
            real = array(beams, "direction")
            angles = np.degrees(np.linalg.norm(real - array(plain, "direction"), axis=1))
            self.assertTrue((angles > 0).all())
            self.assertLess(angles.max(), 5.7 * 2**0.5 * (sway + jitter))
            # Rays to look at are the real ones.
            np.testing.assert_allclose(points(lidar.GetOutput(1))[1::2], 100 * real, atol=1e-12)

    def test_fields_say_what_is_on(self):
        sway = {"sway_amplitude": (0.3, "deg"), "sway_frequency": (0.5, "Hz"), "motion_seed": (7, None)}
        jitter = {"encoder_jitter": (0.2, "deg"), "motion_seed": (7, None)}
        for settings, expected in (((0.3, 0.0, 7), sway), ((0.0, 0.2, 7), jitter)):
            lidar = moving(*settings)
            echo = scan(town(), lidar)
            echo.Update()
            for data in (lidar.GetOutput(0), lidar.GetOutput(1), echo.GetOutput(0), echo.GetOutput(1)):
                fields = [(name, data.GetFieldData().GetArray(name)) for name in FIELDS]
                self.assertEqual({name: (field.GetComponent(0, 0), field.GetInformation().Get(field.UNITS_LABEL()))
                                  for name, field in fields if field}, expected)


class Echoes(unittest.TestCase):
    def test_a_wall_is_as_far_as_the_real_beam_says(self):
        """A wall 100 m to the north: the range is 100 m / the north component of the real direction. Echoes and report
        lie on the reported one."""
        lidar = moving(1.0, 1.0, 3)
        given(lidar, AzimuthRange=(-40, 40), MinimumElevation=20, HalfBeamwidth=1e-5, Position=(3, 0, 1))
        echo = scan(box((0, 101, 0), (900, 1, 900), "Wall"), lidar)
        echo.Update()
        echoes, beams = echo.GetOutput(), lidar.GetOutput()
        rows = np.searchsorted(array(beams, "beam_id"), array(echoes, "beam_id"))
        self.assertEqual(len(rows), beams.GetNumberOfPoints())
        ranges, reported = array(echoes, "distance_m"), array(beams, "reported_direction")
        np.testing.assert_allclose(ranges, 100 / array(beams, "direction")[rows, 1], rtol=1e-5)
        self.assertGreater(np.abs(ranges - 100 / reported[rows, 1]).max(), 0.5)
        np.testing.assert_allclose(points(echoes) - (3, 0, 1), ranges[:, None] * reported[rows], atol=1e-9)
        away = points(echo.GetOutput(1)) - (3, 0, 1)
        np.testing.assert_allclose(away / np.linalg.norm(away, axis=1)[:, None], reported, atol=1e-12)

    def test_revolutions_differ_and_come_again(self):
        echo = scan(town(), moving(0.3, 0.1), BeamSamples=RAYS)
        first, second = at(echo, 0.0), at(echo, 2.0)
        self.assertGreater(echo.GetNumberOfTracedRays(), 0)
        self.assertFalse(np.array_equal(array(first, "energy"), array(second, "energy")))
        assert_same_bits(first, at(echo, 0.0), COSTS)
        assert_same_bits(second, at(scan(town(), moving(0.3, 0.1), BeamSamples=RAYS), 2.0), COSTS)

    def test_a_range_image_has_the_sensors_grid(self):
        """Also of a table without angles, whose grid is that of the directions reported."""
        lidar, tilted = moving(0.5, 0.3), moving(0.5, 0.3)
        tilted.SetOrientation(30, 5, -3)
        table = copy_of(output(lidar))
        for name in ("azimuth", "vertical_angle"):
            table.GetPointData().RemoveArray(name)
        for beams in (output(lidar), output(tilted), table):
            image, echo = given(al.vtkAvianLidarRangeImage(), Columns=90, Rows=4), scan(town(), beams)
            image.SetInputConnection(0, echo.GetOutputPort(0))
            image.SetInputData(1, beams)
            messages = Messages(image, echo)
            image.Update()
            self.assertEqual(messages.all(), [])
            distances = array(image.GetOutput(), "distance_m")
            seen = len(set(array(echo.GetOutput(), "beam_id")))
            self.assertEqual((len(distances), np.isfinite(distances).sum()), (360, seen))
