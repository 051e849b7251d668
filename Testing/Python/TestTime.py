# SPDX-License-Identifier: BSD-3-Clause
"""Time: beams sweep in steps and go from revolution to revolution, a moving scene is sampled at the start of each, noise
is that of the revolution, and nothing known is traced again."""

import os
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support
from vtk.util.vtkAlgorithm import VTKPythonAlgorithmBase

from avianlidar import vtkAvianLidar as al
from echotools import RAYS, Messages, array, arrays, assert_same_bits, box, scan, sensor, town

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
    information = algorithm.GetOutputInformation(port)
    count = information.Length(PIPELINE.TIME_STEPS())
    return [information.Get(PIPELINE.TIME_STEPS(), i) for i in range(count)]


def range_of(algorithm, port=0):
    algorithm.UpdateInformation()
    return algorithm.GetOutputInformation(port).Get(PIPELINE.TIME_RANGE())


def field(data, name):
    return data.GetFieldData().GetArray(name).GetComponent(0, 0)


def copy_of(data):
    copy = data.NewInstance()
    copy.DeepCopy(data)
    return copy


def sensor_output(columns):
    lidar = sensor(columns, 4)
    lidar.Update()
    return lidar.GetOutput()


def sweeping(columns=36, channels=4, revolutions=3, steps=9, rate=2.0):
    lidar = sensor(columns, channels)
    lidar.SetRotationRate(rate)
    lidar.SetNumberOfRevolutions(revolutions)
    lidar.SetStepsPerRevolution(steps)
    return lidar


def noisy(lidar):
    """A photon counter: noise shows in every echo."""
    photon = 6.62607015e-34 * 3.313e14
    lidar.SetLowerEnergyLimit(40 * photon)
    lidar.SetUpperEnergyLimit(1e6 * photon)
    lidar.SetPulseEnergy(2e5 * photon)
    lidar.SetNoisePhotonRate(20 / 5e-9)
    return lidar


class Beams(unittest.TestCase):
    def test_steps_to_play(self):
        lidar = al.vtkAvianLidarBeamSource()
        for port in (0, 1):
            self.assertEqual(steps_of(lidar, port), [])
            self.assertEqual(range_of(lidar, port), (0.0, 0.0))
        lidar = sweeping()
        for port in (0, 1):
            self.assertEqual(steps_of(lidar, port), [(k + j / 9) / 2.0 for k in range(3) for j in range(9)])
            self.assertEqual(range_of(lidar, port), (0.0, 26 / 18))
        lidar.SetNumberOfRevolutions(1)
        lidar.SetStepsPerRevolution(1)
        for port in (0, 1):
            self.assertEqual(steps_of(lidar, port), [])

    def test_other_times_are_served_where_there_is_nothing_to_play(self):
        lidar = sensor(36, 4)
        for time, revolution in ((0.0, 0), (1.9, 0), (2.0, 1), (7.0, 3), (0.0, 0)):
            self.assertEqual(field(at(lidar, time), "revolution"), revolution)
            self.assertEqual(lidar.GetOutput().GetNumberOfPoints(), 144)

    def test_update_without_a_time_is_for_the_one_before(self):
        lidar = sweeping()
        at(lidar, 0.5)
        lidar.SetHalfBeamwidth(2 * lidar.GetHalfBeamwidth())
        lidar.Update()
        self.assertEqual(field(lidar.GetOutput(), "revolution"), 1)
        self.assertEqual(lidar.GetOutput().GetNumberOfPoints(), 16)

    def test_a_sweep_shows_what_has_been_fired(self):
        lidar = sweeping()
        lidar.Update()
        whole = copy_of(lidar.GetOutput())
        before = 0
        for step, time in enumerate(steps_of(lidar)):
            beams = at(lidar, time)
            revolution, j = divmod(step, 9)
            self.assertEqual(field(beams, "revolution"), revolution)
            self.assertEqual(beams.GetNumberOfPoints(), 16 * (j + 1))
            self.assertGreater(beams.GetNumberOfPoints(), before if j else 0)
            before = beams.GetNumberOfPoints()
            timestamps = array(beams, "timestamp")
            self.assertTrue(np.all(timestamps >= 1e6 * revolution / 2.0 - 1e-3))
            self.assertTrue(np.all(timestamps < 1e6 * (revolution + (j + 1) / 9) / 2.0))
            shown = array(beams, "beam_id")
            for name in ("beam_id", "direction", "laser_id", "azimuth", "vertical_angle"):
                np.testing.assert_array_equal(array(beams, name), array(whole, name)[shown], name)
            shown = shown.copy()
            rays = at(lidar, time, 1)
            found = numpy_support.vtk_to_numpy(rays.GetCellData().GetArray("beam_id"))
            np.testing.assert_array_equal(found, shown)
            self.assertEqual(field(rays, "revolution"), revolution)

    def test_without_a_time_there_is_the_whole_of_revolution_0(self):
        plain, swept = sensor(36, 4), sweeping(rate=0.5)
        plain.Update()
        swept.Update()
        assert_same_bits(plain.GetOutput(), swept.GetOutput())
        self.assertEqual(field(swept.GetOutput(), "revolution"), 0)
        self.assertFalse(swept.GetOutput().GetInformation().Has(vtk.vtkDataObject.DATA_TIME_STEP()))
        other = sensor(36, 4)
        assert_same_bits(plain.GetOutput(), at(other, 0.0))

    def test_any_time_is_served(self):
        for rate in (0.3, 1 / 3, 20.0, 1e-20, 1e20):
            lidar = sweeping(steps=1, rate=rate)
            lidar.SetFiringInterval(0)
            for revolution in (-5, -1, 0, 1, 2, 3, 49, 1000003):
                beams = at(lidar, revolution / rate)
                self.assertEqual(field(beams, "revolution"), revolution, rate)
                first = array(beams, "timestamp")[0]
                self.assertEqual(first, 1e6 * (revolution / rate))
                self.assertEqual(field(at(lidar, (revolution + 0.7) / rate), "revolution"), revolution, rate)

    def test_a_time_beyond_all_revolutions_is_an_error(self):
        lidar = sweeping()
        quiet = Messages(lidar)
        at(lidar, 1.0)
        for time in (1e300, -1e300, 2.0**31, float("nan")):
            quiet.errors.clear()
            self.assertEqual(at(lidar, time).GetNumberOfPoints(), 0)
            self.assertIn("RotationRate", quiet.errors[0])
        self.assertEqual(at(lidar, 1.0).GetNumberOfPoints(), 16)

    def test_bad_values_are_named(self):
        for name, value in (("NumberOfRevolutions", 0), ("StepsPerRevolution", 0), ("StepsPerRevolution", 37),
                            ("NumberOfRevolutions", 2**31 - 1)):
            lidar = sweeping()
            quiet = Messages(lidar)
            getattr(lidar, "Set" + name)(value)
            self.assertEqual(range_of(lidar)[0], 0.0)
            lidar.Update()
            self.assertEqual(lidar.GetOutput().GetNumberOfPoints(), 0)
            self.assertIn(name, quiet.errors[0])
        lidar = sweeping()
        quiet = Messages(lidar)
        lidar.SetRotationRate(0.0)
        self.assertEqual(steps_of(lidar), [])
        lidar.Update()
        self.assertIn("RotationRate", quiet.errors[0])

    def test_from_one_revolution_to_the_next_timestamps_alone_are_new(self):
        lidar = sweeping(steps=1)
        beams = at(lidar, 0.0)
        names = ("beam_id", "direction", "laser_id", "azimuth", "vertical_angle")
        before = copy_of(beams)
        beams = at(lidar, 0.5)
        for name in names:
            np.testing.assert_array_equal(array(beams, name), array(before, name))
        np.testing.assert_allclose(array(beams, "timestamp") - array(before, "timestamp"), 5e5, rtol=1e-12)
        # The rest of a revolution shows no other time.
        before = copy_of(beams)
        np.testing.assert_array_equal(array(at(lidar, 0.7), "timestamp"), array(before, "timestamp"))

    def test_pieces_sweep_as_well(self):
        lidar, whole = sweeping(), sweeping()
        for time in (0.0, 0.25, 0.5 + 1 / 18, 1.45):
            expected = arrays(at(whole, time))
            parts = []
            for piece in range(3):
                lidar.UpdateTimeStep(time, piece, 3, 0, None)
                columns = np.unique(array(lidar.GetOutput(), "beam_id") // 4)
                self.assertTrue(np.all(columns % 3 == piece))
                parts.append(copy_of(lidar.GetOutput()))
            ids = np.concatenate([array(part, "beam_id") for part in parts])
            order = np.argsort(ids)
            for name in ("beam_id", "direction", "timestamp"):
                joined = np.concatenate([array(part, name) for part in parts])[order]
                np.testing.assert_array_equal(joined, expected[name], name)


class Echoes(unittest.TestCase):
    def test_steps_are_those_of_the_beams(self):
        self.assertEqual(steps_of(scan(MovingBox(), sweeping())), steps_of(sweeping()))
        beams = sensor()
        beams.Update()
        for port in (0, 1):
            self.assertEqual(steps_of(scan(MovingBox(), copy_of(beams.GetOutput())), port), list(range(11)))
            self.assertEqual(steps_of(scan(MovingBox(), sensor()), port), list(range(11)))
            self.assertEqual(steps_of(scan(town(), sensor()), port), [])

    def test_a_sweep_traces_nothing_twice(self):
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(town())
        lidar = sweeping(90, 4, 3, 36)
        one = scan(tree, sensor(90, 4), BeamSamples=RAYS)  # integrated beams have no rays to count
        one.Update()
        whole = one.GetNumberOfTracedRays()
        self.assertGreater(whole, 0)
        echo = scan(tree, lidar, BeamSamples=RAYS)
        rays, counts = [], []
        for time in steps_of(lidar):
            counts.append(at(echo, time).GetNumberOfPoints())
            rays.append(echo.GetNumberOfTracedRays())
        self.assertEqual(sum(rays[:36]), whole)
        self.assertEqual(sum(rays[36:]), 0)
        self.assertEqual(counts[:36], counts[36:72])
        self.assertEqual(counts, sorted(counts[:36]) * 3)
        self.assertEqual(counts[35], one.GetOutput().GetNumberOfPoints())
        self.assertEqual(tree.GetNumberOfBuilds(), 1)
        self.assertEqual(echo.GetNumberOfTreeBuilds(), 0)
        # The end of the sweep is the scan.
        expected, found = arrays(one.GetOutput()), arrays(at(echo, steps_of(lidar)[35]))
        for name in expected.keys() - {"timestamp"}:
            self.assertEqual(expected[name].tobytes(), found[name].tobytes(), name)

    def test_every_step_is_what_a_fresh_scan_gives(self):
        lidar = noisy(sweeping())
        echo = scan(town(), lidar)
        for time in (0.0, 0.5 - 1 / 18, 0.5, 0.25, 1.3, 0.0):
            fresh = scan(town(), noisy(sweeping()))
            assert_same_bits(at(echo, time), at(fresh, time))

    def test_noise_is_that_of_the_revolution(self):
        lidar = noisy(sweeping(steps=1, revolutions=5))
        wall = box((0, 100, 0), (300, 1, 100), "Wall")
        echo = scan(wall, lidar)
        runs = [copy_of(at(echo, k / 2.0)) for k in range(5)]
        self.assertEqual(field(runs[3], "noise_modelled"), 1)
        self.assertEqual(field(runs[3], "revolution"), 3)
        plain = scan(wall, noisy(sweeping(steps=1)))
        plain.Update()
        assert_same_bits(plain.GetOutput(), runs[0])
        at(echo, 1.0)
        self.assertEqual(echo.GetNumberOfTracedRays(), 0)
        assert_same_bits(echo.GetOutput(), runs[2])
        quiet = scan(wall, noisy(sweeping(steps=1)), Noise=False)
        quiet.Update()

        def noise_of(run):
            """Photons that the strongest unit of each beam's wall has too many, by beam."""
            data, base = arrays(run), arrays(quiet.GetOutput())
            clean = dict(zip(base["beam_id"], base["energy_received"]))
            energy = {}
            for beam, value in zip(data["beam_id"], data["energy_received"]):
                if beam in clean:
                    energy[beam] = max(energy.get(beam, 0), value)
            return {beam: value - clean[beam] for beam, value in energy.items()}

        for first, second in ((0, 1), (1, 2), (0, 4)):
            one, two = noise_of(runs[first]), noise_of(runs[second])
            beams = sorted(one.keys() & two.keys())
            self.assertGreater(len(beams), 50)
            x, y = (np.array([noise[beam] for beam in beams]) for noise in (one, two))
            self.assertGreater(np.count_nonzero(x != y), len(beams) / 2)
            self.assertLess(abs(np.corrcoef(x, y)[0, 1]), 4.5 / np.sqrt(len(beams)))

    def test_revolution_of_beams_of_any_source(self):
        lidar = noisy(sweeping(steps=1))
        expected = copy_of(at(scan(town(), lidar), 1.0))
        beams = copy_of(at(lidar, 1.0))
        self.assertEqual(field(beams, "revolution"), 2)
        echo = scan(town(), beams)
        echo.Update()
        assert_same_bits(echo.GetOutput(), expected)
        beams.GetFieldData().RemoveArray("revolution")
        beams.Modified()
        echo.Update()
        first = copy_of(at(scan(town(), lidar), 0.0))
        for name in ("energy_received", "distance_m"):
            np.testing.assert_array_equal(array(echo.GetOutput(), name), array(first, name))
        for value in (-3, 2**31 - 1, -(2**31), 7):
            number = vtk.vtkFloatArray() if value == 7 else vtk.vtkTypeInt64Array()
            number.SetName("revolution")
            number.InsertNextValue(value)
            beams.GetFieldData().AddArray(number)
            beams.Modified()
            echo.Update()
            self.assertEqual(field(echo.GetOutput(), "revolution"), value)
            self.assertEqual(field(echo.GetOutput(1), "revolution"), value)
            self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 0)

    def test_what_is_no_revolution_is_named(self):
        lidar = sensor()
        lidar.Update()
        text = vtk.vtkStringArray()
        text.InsertNextValue("third")
        empty = vtk.vtkIntArray()
        numbers = []
        for value in (0.5, 2.0**31, float("nan"), float("inf")):
            number = vtk.vtkDoubleArray()
            number.InsertNextValue(value)
            numbers.append(number)
        two = vtk.vtkIntArray()
        two.InsertNextValue(1)
        two.InsertNextValue(2)
        three = vtk.vtkIntArray()
        three.SetNumberOfComponents(3)
        three.InsertNextTuple3(1, 2, 3)
        for bad in (text, empty, two, three, *numbers):
            beams = copy_of(lidar.GetOutput())
            bad.SetName("revolution")
            beams.GetFieldData().AddArray(bad)
            echo = scan(town(), beams)
            quiet = Messages(echo)
            echo.Update()
            self.assertIn("'revolution'", quiet.errors[0])
            self.assertEqual(echo.GetOutput().GetNumberOfPoints(), 0)

    def test_an_abort_while_playing_empties_that_frame_alone(self):
        lidar = noisy(sweeping(360, 8, 3, 6))
        echo = scan(town(), lidar, NumberOfThreads=1)
        times = steps_of(echo)
        at(echo, times[0])
        observer = echo.AddObserver("ProgressEvent", lambda *_: echo.AbortExecuteOn())
        self.assertEqual(at(echo, times[1]).GetNumberOfPoints(), 0)
        self.assertEqual(echo.GetOutput(1).GetNumberOfPoints(), 0)
        echo.RemoveObserver(observer)
        echo.AbortExecuteOff()
        for time in (times[2], times[7]):
            fresh = scan(town(), noisy(sweeping(360, 8, 3, 6)))
            self.assertGreater(at(echo, time).GetNumberOfPoints(), 0)
            assert_same_bits(echo.GetOutput(), at(fresh, time))

    def test_files_say_which_revolution(self):
        echo = scan(town(), sweeping())
        at(echo, 1.0)
        writer = vtk.vtkXMLPolyDataWriter()
        writer.SetFileName("TestTime.vtp")
        writer.SetDataModeToBinary()
        writer.SetInputData(echo.GetOutput())
        self.assertTrue(writer.Write())
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName("TestTime.vtp")
        reader.Update()
        os.remove("TestTime.vtp")
        self.assertEqual(field(reader.GetOutput(), "revolution"), 2)
        self.assertEqual(field(reader.GetOutput(), "TimeValue"), 1.0)
        assert_same_bits(echo.GetOutput(), reader.GetOutput())

    def test_ports_at_different_times(self):
        for pipeline in (sweeping(), scan(town(), sweeping())):
            for time in (0.25, 0.0, 0.3, 0.0):
                for port in (0, 1, 0):
                    self.assertEqual(field(at(pipeline, time, port), "revolution"), 0)
                whole = sweeping()
                self.assertEqual(at(pipeline, time, 1).GetNumberOfCells(), at(whole, time).GetNumberOfPoints())
            self.assertGreater(at(pipeline, 0.25, 1).GetNumberOfCells(), 16)
            self.assertEqual(field(at(pipeline, 0.5), "revolution"), 1)
            self.assertEqual(field(at(pipeline, 0.0, 1), "revolution"), 0)
            self.assertEqual(field(at(pipeline, 0.5), "revolution"), 1)


class Image(unittest.TestCase):
    """A range image has the columns of the whole scan at any time; those not yet fired are empty."""

    def image_of(self, echo, beams, port):
        image = al.vtkAvianLidarRangeImage()
        image.SetInputConnection(0, echo.GetOutputPort(0))
        image.SetInputConnection(1, beams.GetOutputPort(port))
        return image

    def check(self, image, columns, fired):
        output = image.GetOutput()
        self.assertEqual(output.GetDimensions(), (columns, 4, 1))
        self.assertEqual(output.GetFieldData().GetArray("column_azimuths").GetNumberOfTuples(), columns)
        if output.GetPointData().HasArray("status"):
            status = array(output, "status").reshape(4, columns)
            np.testing.assert_array_equal((status >= 0).all(axis=0), [column < fired for column in range(columns)])

    def test_it_is_the_whole_scan_at_every_time(self):
        for tilt in ((0, 0, 0), (30, 5, -3)):
            lidar = sensor(90, 4)
            lidar.SetOrientation(*tilt)
            whole = self.image_of(echo := scan(town(), lidar), echo, 1)
            whole.Update()
            expected = copy_of(whole.GetOutput())
            lidar.SetStepsPerRevolution(90)
            for beams, port in ((echo, 1), (lidar, 0)):
                image = self.image_of(echo, beams, port)
                messages = Messages(image)
                for time, fired in ((0, 1), (1.999, 90), (1.0, 46), (0.5, 23), (2.5, 23)):
                    image.UpdateTimeStep(time)
                    if tilt == (0, 0, 0):
                        self.check(image, 90, fired)
                    self.assertEqual(image.GetOutput().GetDimensions(), (90, 4, 1))
                    self.assertEqual(image.GetOutput().GetInformation().Get(vtk.vtkDataObject.DATA_TIME_STEP()), time)
                image.UpdateTimeStep(1.999)
                np.testing.assert_array_equal(array(image.GetOutput(), "distance_m"),
                                              array(expected, "distance_m"))
                self.assertEqual(messages.all(), [])

    def test_it_is_the_whole_scan_without_a_beam(self):
        lidar = sensor(90, 4)
        none = vtk.vtkThresholdPoints()
        none.SetInputConnection(lidar.GetOutputPort())
        none.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, "azimuth")
        none.ThresholdByUpper(1e6)
        image = al.vtkAvianLidarRangeImage()
        image.SetInputData(0, vtk.vtkPolyData())
        image.SetInputConnection(1, none.GetOutputPort())
        messages = Messages(image)
        image.Update()
        self.assertEqual(none.GetOutput().GetNumberOfPoints(), 0)
        self.check(image, 90, 0)
        self.assertTrue(np.isnan(array(image.GetOutput(), "distance_m")).all())
        self.assertEqual(messages.all(), [])

    def test_the_report_is_not_traced_for_its_size(self):
        echo = scan(town(), sensor(90, 4))
        image = self.image_of(echo, echo, 1)
        image.UpdateInformation()
        self.assertEqual(echo.GetNumberOfTracedRays(), 0)
        self.assertEqual(image.GetOutputInformation(0).Get(PIPELINE.WHOLE_EXTENT()), (0, 89, 0, 3, 0, 0))

    def test_a_written_image_is_as_wide(self):
        lidar = sensor(90, 4)
        lidar.SetStepsPerRevolution(90)
        image = self.image_of(echo := scan(town(), lidar), echo, 1)
        image.UpdateTimeStep(0.0)
        writer = vtk.vtkXMLImageDataWriter()
        writer.SetInputConnection(image.GetOutputPort())
        writer.SetDataModeToBinary()  # Debian's expat breaks the default, Appended
        writer.WriteToOutputStringOn()
        writer.Write()
        reader = vtk.vtkXMLImageDataReader()
        reader.ReadFromInputStringOn()
        reader.SetInputString(writer.GetOutputString())
        reader.Update()
        self.assertEqual(reader.GetOutput().GetDimensions(), (90, 4, 1))

    def test_a_sensor_after_a_table(self):
        """What the image knew of a table is forgotten: the sensor tells the size, and nothing is traced for it."""
        lidar = sensor(90, 4)
        lidar.Update()
        echo = scan(town(), copy_of(lidar.GetOutput()))
        image = self.image_of(echo, echo, 1)
        image.SetColumns(90)
        image.SetRows(4)
        image.Update()
        self.check(image, 90, 90)
        image.SetColumns(0)
        other = scan(town(), sensor(60, 4))
        image.SetInputConnection(0, other.GetOutputPort(0))
        image.SetInputConnection(1, other.GetOutputPort(1))
        image.UpdateInformation()
        self.assertEqual(other.GetNumberOfTracedRays(), 0)
        image.Update()
        self.check(image, 60, 60)
        echo.SetInputConnection(0, lidar.GetOutputPort())
        image = self.image_of(echo, echo, 1)
        image.Update()
        echo.SetInputData(0, copy_of(sensor_output(30)))
        messages = Messages(image)
        image.Update()
        self.assertRegex(messages.errors[0], "30 columns and 4 rows, .* announced is 0 columns and 0 rows: set Columns and Rows")
        self.assertEqual(image.GetOutput().GetNumberOfPoints(), 0)
        image.SetColumns(30)
        image.SetRows(4)
        image.Update()
        self.check(image, 30, 30)

    def test_other_beams_than_announced_are_an_error(self):
        class Other(PassedOn):
            def RequestData(self, _, inputs, outputs):
                vtk.vtkPolyData.GetData(outputs).ShallowCopy(sensor_output(11))
                return 1

        between = Other(sensor(90, 4))
        image = self.image_of(scan(town(), between), between, 0)
        messages = Messages(image)
        image.Update()
        self.assertRegex(messages.errors[0], "11 columns and 4 rows, but the size announced is 90 columns and 4 rows")
        image.SetColumns(11)
        image.SetRows(4)
        image.Update()
        self.check(image, 11, 11)

    def test_beams_turned_on_the_way_have_a_grid_of_their_own(self):
        lidar = sensor(90, 4)
        turn = vtk.vtkTransform()
        turn.RotateZ(-8)
        turned = vtk.vtkTransformFilter()
        turned.SetTransform(turn)
        turned.SetInputConnection(lidar.GetOutputPort())
        lidar.Update()
        turned.Update()
        echo = scan(town())
        echo.SetInputConnection(0, turned.GetOutputPort())
        image = self.image_of(echo, echo, 1)
        image.Update()
        azimuths = numpy_support.vtk_to_numpy(image.GetOutput().GetFieldData().GetArray("column_azimuths"))
        report = array(echo.GetOutput(1), "azimuth") / 100
        np.testing.assert_allclose(azimuths, np.unique(np.round(report, 6)), atol=1e-4)


class MovingScene(unittest.TestCase):
    @staticmethod
    def distance(data):
        """Of the wall in front, m."""
        return array(data, "distance_m").min()

    def chain(self, lidar, wrap=lambda beams: beams, **settings):
        moving = MovingBox()
        paint = al.vtkAvianLidarMaterial()
        paint.SetInputConnection(moving.GetOutputPort())
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(paint.GetOutputPort())
        return moving, tree, scan(tree, wrap(lidar), **settings)

    def test_ranges_follow_by_revolution_and_not_within_one(self):
        lidar = sweeping(revolutions=4, steps=3, rate=0.5)
        moving, tree, echo = self.chain(lidar)
        for step, time in enumerate(steps_of(echo)):
            echoes = at(echo, time)
            self.assertAlmostEqual(self.distance(echoes), 50 + 2 * (step // 3), places=2)
        self.assertEqual(moving.asked, [0.0, 2.0, 4.0, 6.0])
        self.assertEqual(tree.GetNumberOfBuilds(), 4)
        # Back, beyond what is played, and before the beginning.
        for time, expected in ((2.5, 2), (9.99, 8), (123.0, 122), (-3.0, -4)):
            self.assertAlmostEqual(self.distance(at(echo, time)), 50 + expected, places=2)
        self.assertEqual(moving.asked[4:], [2.0, 8.0, 122.0, -4.0])

    def test_one_scan_to_play_has_its_revolutions_all_the_same(self):
        for wrap in (lambda lidar: lidar, PassedOn):
            lidar = sensor()
            lidar.SetRotationRate(0.5)
            moving, tree, echo = self.chain(lidar, wrap)
            for time in (0.0, 1.0, 2.0, 3.0, 7.0, 7.5):
                self.assertAlmostEqual(self.distance(at(echo, time)), 50 + time // 2 * 2, places=2)
                self.assertEqual(field(echo.GetOutput(), "revolution"), time // 2)
            self.assertEqual(moving.asked, [0.0, 2.0, 6.0])
            self.assertEqual(tree.GetNumberOfBuilds(), 3)

    def test_missing_materials_of_a_moving_scene_are_told_once(self):
        class Bare(MovingBox):
            def RequestData(self, request, inputs, outputs):
                super().RequestData(request, inputs, outputs)
                vtk.vtkPolyData.GetData(outputs).GetCellData().Initialize()
                return 1

        moving = Bare()
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(moving.GetOutputPort())
        for surfaces in (moving, tree):
            echo = scan(surfaces, sweeping(revolutions=4, steps=3, rate=0.5))
            heard = Messages(echo, tree)
            for time in steps_of(echo):
                self.assertGreater(at(echo, time).GetNumberOfPoints(), 0)
            self.assertEqual(len(heard.warnings), 1, heard.warnings)
            self.assertIn("Wall", heard.warnings[0])

    def test_a_static_scene_that_says_it_moves_is_not_traced_again(self):
        lidar = sweeping(revolutions=3, steps=2, rate=0.5)
        still = MovingBox()
        still_at = still.RequestData

        def without_moving(request, inputs, outputs):
            result = still_at(request, inputs, outputs)
            output = vtk.vtkPolyData.GetData(outputs.GetInformationObject(0))
            output.ShallowCopy(box((0, 51, 0), (20, 1, 20), "Wall"))
            return result

        still.RequestData = without_moving
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(still.GetOutputPort())
        echo = scan(tree, lidar, BeamSamples=RAYS)
        rays = []
        for time in steps_of(echo):
            at(echo, time)
            rays.append(echo.GetNumberOfTracedRays())
        self.assertEqual(still.asked, [0.0, 2.0, 4.0])
        self.assertGreater(rays[0], 0)
        self.assertEqual(sum(rays[2:]), 0)
        self.assertEqual(tree.GetNumberOfBuilds(), 1)

    def test_filters_between_pass_the_period_on(self):
        def transformed(lidar):
            turn = vtk.vtkTransform()
            turn.RotateZ(1)
            between = vtk.vtkTransformPolyDataFilter()
            between.SetTransform(turn)
            between.SetInputConnection(lidar.GetOutputPort())
            return between

        for wrap in (transformed, PassedOn, lambda lidar: PassedOn(transformed(lidar))):
            moving, _, echo = self.chain(sweeping(revolutions=2, steps=2, rate=0.5), wrap)
            for time in steps_of(echo):
                at(echo, time)
            self.assertEqual(moving.asked, [0.0, 2.0])

    def test_where_steps_are_changed_on_the_way_the_scene_has_the_time_itself(self):
        shift = vtk.vtkTemporalShiftScale()
        shift.SetPreShift(10)
        lidar = sweeping(revolutions=2, steps=2, rate=0.5)
        shift.SetInputConnection(lidar.GetOutputPort())
        moving = MovingBox()
        echo = scan(moving, shift)
        for time in (10.0, 11.0, 12.0):
            at(echo, time)
        self.assertEqual(moving.asked, [10.0, 11.0, 12.0])
        lidar.SetNumberOfRevolutions(1)
        lidar.SetStepsPerRevolution(1)
        at(echo, 13.0)
        self.assertEqual(moving.asked[3:], [13.0])

    def test_beams_of_a_file_have_no_revolutions(self):
        beams = sensor()
        beams.Update()
        moving = MovingBox()
        echo = scan(moving, copy_of(beams.GetOutput()))
        for time in (0.0, 0.7, 3.0):
            self.assertAlmostEqual(self.distance(at(echo, time)), 50 + time, places=2)
        self.assertEqual(moving.asked, [0.0, 0.7, 3.0])

    def test_other_beams_later_leave_nothing_behind(self):
        """A filter that stays while its input changes from the beam source to a file keeps no period of it."""
        for count in (1, 2):
            between = PassedOn(sweeping(revolutions=count, steps=count, rate=0.5))
            moving = MovingBox()
            echo = scan(moving, between)
            at(echo, 1.0)
            beams = sensor()
            beams.Update()
            between.SetInputDataObject(copy_of(beams.GetOutput()))
            at(echo, 3.0)
            self.assertEqual(moving.asked, [0.0, 3.0])


if __name__ == "__main__":
    unittest.main()
