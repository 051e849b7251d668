# SPDX-License-Identifier: BSD-3-Clause
"""Time: beams go from revolution to revolution, a moving scene is sampled at the start of each, and noise is that of
the revolution. Steps of a sweep are TestScanClock's and TestScanSweep's (kernel)."""

import unittest

import numpy as np
import vtk
from vtk.util.vtkAlgorithm import VTKPythonAlgorithmBase

from avianlidar import vtkAvianLidar as al
from cloudtools import field
from echotools import array, assert_same_bits, box, copy_of, given, output, scan, sensor, town

PIPELINE = vtk.vtkStreamingDemandDrivenPipeline


class MovingBox(VTKPythonAlgorithmBase):
    """A box that moves away to the north by 1 m per second, from 50 m on, and notes for which times it was asked."""

    def __init__(self, steps=range(11)):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkPolyData")
        self.steps = [float(step) for step in steps]
        self.asked = []

    def RequestInformation(self, request, inputs, outputs):
        information = outputs.GetInformationObject(0)
        information.Set(PIPELINE.TIME_STEPS(), self.steps, len(self.steps))
        information.Set(PIPELINE.TIME_RANGE(), [self.steps[0], self.steps[-1]], 2)
        return 1

    def RequestData(self, request, inputs, outputs):
        information = outputs.GetInformationObject(0)
        time = information.Get(PIPELINE.UPDATE_TIME_STEP()) if information.Has(PIPELINE.UPDATE_TIME_STEP()) else 0.0
        self.asked.append(time)
        output = vtk.vtkPolyData.GetData(information)
        output.ShallowCopy(box((0, 51 + time, 0), (20, 1, 20), "Wall"))
        output.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), time)
        return 1


class PassedOn(VTKPythonAlgorithmBase):
    """A filter of anyone's, that knows nothing of time."""

    def __init__(self, upstream):
        super().__init__(nInputPorts=1, inputType="vtkPolyData", nOutputPorts=1, outputType="vtkPolyData")
        self.SetInputConnection(upstream.GetOutputPort())

    def RequestData(self, request, inputs, outputs):
        vtk.vtkPolyData.GetData(outputs).ShallowCopy(vtk.vtkPolyData.GetData(inputs[0]))
        return 1


def at(algorithm, time, port=0):
    """The output at a time."""
    algorithm.UpdateInformation()
    algorithm.GetOutputInformation(port).Set(PIPELINE.UPDATE_TIME_STEP(), time)
    algorithm.Update(port)
    return algorithm.GetOutputDataObject(port)


def steps_of(algorithm, port=0):
    algorithm.UpdateInformation()
    return list(algorithm.GetOutputInformation(port).Get(PIPELINE.TIME_STEPS()) or ())


def sensor_output(columns):
    return output(sensor(columns, 4))


def sweeping(columns=36, channels=4, revolutions=3, steps=9, rate=2.0):
    return given(sensor(columns, channels), RotationRate=rate, NumberOfRevolutions=revolutions,
                 StepsPerRevolution=steps)


def noisy(lidar):
    """A photon counter: noise shows in every echo."""
    photon = 6.62607015e-34 * 3.313e14
    return given(lidar, LowerEnergyLimit=40 * photon, UpperEnergyLimit=1e6 * photon, PulseEnergy=2e5 * photon,
                 NoisePhotonRate=20 / 5e-9)


class Echoes(unittest.TestCase):
    def test_steps_are_those_of_the_beams(self):
        self.assertEqual(steps_of(sweeping()), [(k + j / 9) / 2.0 for k in range(3) for j in range(9)])
        self.assertEqual(steps_of(scan(MovingBox(), sweeping())), steps_of(sweeping()))
        for port in (0, 1):
            self.assertEqual(steps_of(scan(MovingBox(), sensor_output(90)), port), list(range(11)))
            self.assertEqual(steps_of(scan(MovingBox(), sensor()), port), list(range(11)))
            self.assertEqual(steps_of(scan(town(), sensor()), port), [])

    def test_noise_is_that_of_the_revolution(self):
        wall = box((0, 100, 0), (300, 1, 100), "Wall")
        echo = scan(wall, noisy(sweeping(steps=1, revolutions=5)))
        runs = [copy_of(at(echo, k / 2.0)) for k in range(3)]
        self.assertEqual((field(runs[2], "noise_modelled"), field(runs[2], "revolution")), ([1], [2]))
        plain = scan(wall, noisy(sweeping(steps=1)))
        plain.Update()
        assert_same_bits(plain.GetOutput(), runs[0])
        first, second = (dict(zip(array(run, "beam_id"), array(run, "energy_received"))) for run in runs[1:])
        both = sorted(first.keys() & second.keys())
        self.assertGreater(sum(first[beam] != second[beam] for beam in both), 50)
        at(echo, 1.0)
        self.assertEqual(echo.GetNumberOfTracedRays(), 0)
        assert_same_bits(echo.GetOutput(), runs[2])

    def test_revolution_of_beams_of_any_source(self):
        """It is a field of the beams; without the field it is 0."""
        lidar = noisy(sweeping(steps=1))
        expected, first = (copy_of(at(scan(town(), lidar), time)) for time in (1.0, 0.0))
        beams = copy_of(at(lidar, 1.0))
        echo = scan(town(), beams)
        echo.Update()
        assert_same_bits(echo.GetOutput(), expected)
        beams.GetFieldData().RemoveArray("revolution")
        beams.Modified()
        echo.Update()
        for name in ("energy_received", "distance_m"):
            np.testing.assert_array_equal(array(echo.GetOutput(), name), array(first, name))

    def test_ports_at_different_times(self):
        for pipeline in (sweeping(), scan(town(), sweeping())):
            for time, count in ((0.25, 80), (0.0, 16), (0.3, 96)):
                for port in (0, 1, 0):
                    self.assertEqual(field(at(pipeline, time, port), "revolution"), [0])
                self.assertEqual(at(pipeline, time, 1).GetNumberOfCells(), count)
            self.assertEqual(field(at(pipeline, 0.5), "revolution"), [1])
            self.assertEqual(field(at(pipeline, 0.0, 1), "revolution"), [0])


class MovingScene(unittest.TestCase):
    """The scene is asked for the time at which a revolution begins, and for no other."""

    @staticmethod
    def distance(data):
        """Range of the wall in front, m."""
        return array(data, "distance_m").min()

    def test_ranges_follow_by_revolution_and_not_within_one(self):
        moving, tree, paint = MovingBox(), al.vtkAvianLidarCollisionTree(), al.vtkAvianLidarMaterial()
        paint.SetInputConnection(moving.GetOutputPort())
        tree.SetInputConnection(paint.GetOutputPort())
        echo = scan(tree, sweeping(revolutions=4, steps=3, rate=0.5))
        for step, time in enumerate(steps_of(echo)):
            self.assertAlmostEqual(self.distance(at(echo, time)), 50 + 2 * (step // 3), places=2)
        self.assertEqual((moving.asked, tree.GetNumberOfBuilds()), ([0.0, 2.0, 4.0, 6.0], 4))
        # Back, beyond what is played, and before the beginning.
        for time, expected in ((2.5, 2), (123.0, 122), (-3.0, -4)):
            self.assertAlmostEqual(self.distance(at(echo, time)), 50 + expected, places=2)
        self.assertEqual(moving.asked[4:], [2.0, 122.0, -4.0])

    def test_which_times_a_scene_is_asked_for(self):
        def transformed(lidar):
            turn = vtk.vtkTransform()
            turn.RotateZ(1)
            return given(vtk.vtkTransformPolyDataFilter(), Transform=turn, InputConnection=lidar.GetOutputPort())

        def shifted(lidar):  # steps are changed on the way: the scene has the time itself
            return given(vtk.vtkTemporalShiftScale(), PreShift=10, InputConnection=lidar.GetOutputPort())

        def one_scan(_=None):  # has its revolutions all the same
            return sweeping(revolutions=1, steps=1, rate=0.5)

        cases = (("two filters between", lambda lidar: PassedOn(transformed(lidar)), (0, 1, 2, 3), [0, 2]),
                 ("one scan through a filter", lambda _: PassedOn(one_scan()), (0, 1, 2, 3, 7, 7.5), [0, 2, 6]),
                 ("other steps", shifted, (10, 11, 12), [10, 11, 12]),
                 ("beams of a file", lambda _: sensor_output(90), (0, 0.7, 3), [0, 0.7, 3]))
        for name, wrap, times, asked in cases:
            with self.subTest(name):
                moving, lidar = MovingBox(), sweeping(revolutions=2, steps=2, rate=0.5)
                source = wrap(lidar)
                echo = scan(moving, source)
                for time in times:
                    at(echo, float(time))
                self.assertEqual(moving.asked, asked)
                self.assertAlmostEqual(self.distance(echo.GetOutput()), 50 + asked[-1], places=1)
