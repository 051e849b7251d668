# SPDX-License-Identifier: BSD-3-Clause
"""What follows an execution that failed: whoever is updated next says so, by the input port and the first error, and has no
output; a file stays as it is; the next good input works. As VTK has it, and with errors as data, as ParaView has it."""

import os
import shutil
import tempfile
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

import cloudtools
from avianlidar import vtkAvianLidar as al
from echotools import assert_same_bits, box, Messages, RAYS, scan, sensor, town

FILE = "TestFailedProducers"
SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}


class Producer:
    """An algorithm of ours that can be made to fail and be mended again."""

    def __init__(self, algorithm, setter, good, bad, words, port=0):
        self.algorithm, self.setter, self.good, self.bad, self.words = algorithm, setter, good, bad, words
        self.port = algorithm.GetOutputPort(port)
        self.mend()

    def fail(self):
        getattr(self.algorithm, self.setter)(self.bad)

    def mend(self):
        getattr(self.algorithm, self.setter)(self.good)


def beams():
    return Producer(sensor(), "SetPulseEnergy", 3.6e-4, -1.0, "PulseEnergy")


def surfaces(data=None):
    material = al.vtkAvianLidarMaterial()
    material.SetMaterialToCustom()
    material.SetInputData(data or town(3, 12))
    return Producer(material, "SetKd", 0.3, -1.0, "Material: ")


def echoes(port=0):
    filter_ = scan(town(3, 12), **SETTINGS)
    return Producer(filter_, "SetAttenuationCoefficient", 3.5e-5, -1.0, "AttenuationCoefficient", port)


def with_origin():
    data = vtk.vtkPolyData()
    data.DeepCopy(town(3, 1).GetBlock(0))
    origin = vtk.vtkDoubleArray()
    origin.SetName("geodetic_origin")
    origin.SetNumberOfComponents(3)
    origin.InsertNextTuple3(31, 121, 3)
    data.GetFieldData().AddArray(origin)
    return surfaces(data)


def timed():
    """A cloud of a time: executed again it is the same scan."""
    data = vtk.vtkPolyData()
    data.DeepCopy(town(3, 1).GetBlock(0))
    time = vtk.vtkDoubleArray()
    time.SetName("TimeValue")
    time.InsertNextValue(3.0)
    data.GetFieldData().AddArray(time)
    return surfaces(data)


def trails():
    return Producer(al.vtkAvianLidarTracks(), "SetRadius", 500.0, -1.0, "Radius", 1)


# Every class with inputs: the producers of its ports.
FILTERS = {
    "Advisor": (beams, surfaces),
    "BeamView": (beams, surfaces),
    "CloudComparison": (echoes, echoes),
    "ClutterFilter": (echoes,),
    "CollisionTree": (surfaces,),
    "Coverage": (beams, surfaces),
    "EchoFilter": (beams, surfaces),
    "GeodeticTransform": (with_origin,),
    "HSBColorMap": (echoes,),
    "Material": (surfaces,),
    "Medium": (lambda: surfaces(box((0, 100, 0), (5, 5, 5))),),
    "RangeImage": (echoes, lambda: beams_of(echoes)),
    "Tracker": (timed,),
    "Tracks": (trails,),
    "UnitNames": (echoes,),
}
WRITERS = {name + "Writer": suffix[1:] for name, suffix in cloudtools.WRITERS.items()}


def beams_of(_):
    """The beams that the echoes of the first port come from, as far as the range image wants to know."""
    return beams()


def pipeline(name):
    """(filter, its producers)"""
    filter_ = getattr(al, "vtkAvianLidar" + name)()
    if name == "Tracks":
        filter_.SetPatternToLines()
    if name == "Medium":
        filter_.SetShapeToSurface()
    if name == "BeamView":
        seen = scan(town(3, 12), **SETTINGS)
        seen.Update()
        filter_.SetBeamId(seen.GetOutput().GetPointData().GetArray("beam_id").GetValue(0))
    producers = [make() for make in FILTERS[name]]
    for port, producer in enumerate(producers):
        filter_.SetInputConnection(port, producer.port)
    return filter_, producers


def update(algorithm):
    """What the executive says: 0 for a failure."""
    return algorithm.GetExecutive().Update(0)


def copies(filter_):
    result = []
    for port in range(filter_.GetNumberOfOutputPorts()):
        result.append(filter_.GetOutputDataObject(port).NewInstance())
        result[-1].DeepCopy(filter_.GetOutputDataObject(port))
    return result


def elements(data):
    return sum(data.GetNumberOfElements(kind) for kind in (vtk.vtkDataObject.POINT, vtk.vtkDataObject.CELL, vtk.vtkDataObject.ROW))


def error_of(data):
    """The field data `error`, or nothing."""
    array = data.GetFieldData().GetAbstractArray("error")
    return array.GetValue(0) if array else ""


def text_of(message):
    """What an error event says, without the place in the code."""
    return message.split("): ", 1)[1].strip()


class TestFailedProducers(unittest.TestCase):
    def for_each_port(self, check):
        for name, ports in FILTERS.items():
            for port in range(len(ports)):
                with self.subTest(f"{name}, port {port}"):
                    check(port, *pipeline(name))

    def check_failed(self, filter_, messages, port, words):
        """One error more, and no output but the error."""
        self.assertEqual(len(messages.errors), 1, messages.errors)
        self.assertIn(f"Input port {port}: its producer failed: ", messages.errors[0])
        self.assertEqual(messages.errors[0].count("its producer failed"), 1)
        self.assertIn(words, messages.errors[0])
        for output in range(filter_.GetNumberOfOutputPorts()):
            data = filter_.GetOutputDataObject(output)
            if data.IsA("vtkImageData") and filter_.GetErrorsAsData():
                self.assertTrue(np.isnan(numpy_support.vtk_to_numpy(data.GetPointData().GetScalars())).all())
            else:
                self.assertEqual(elements(data), 0)
            self.assertEqual(error_of(data), text_of(messages.errors[0]))
            self.assertEqual(data.GetFieldData().GetNumberOfArrays(), 1)

    def check_mended(self, filter_, expected):
        self.assertEqual(update(filter_), 1)
        for data, before in zip(copies(filter_), expected):
            self.assertEqual(error_of(data), "")
            self.assertEqual(elements(data), elements(before))
            if data.IsA("vtkPolyData"):
                assert_same_bits(data, before)

    def test_every_class_with_inputs_is_here(self):
        found = set()
        for name in dir(al):
            if name.startswith("vtkAvianLidar") and name not in ("vtkAvianLidarCloudWriter", "vtkAvianLidarScanFilter"):
                if getattr(al, name)().GetNumberOfInputPorts():
                    found.add(name[len("vtkAvianLidar") :])
        self.assertEqual(found, {*FILTERS, *WRITERS})

    def test_an_error_upstream_is_not_an_empty_input(self):
        """VTK considers what failed up to date: the second update runs on its empty outputs."""

        def check(port, filter_, producers):
            self.assertEqual(update(filter_), 1)
            expected = copies(filter_)
            self.assertGreater(elements(expected[0]), 0)
            messages = Messages(filter_)
            upstream = Messages(*(producer.algorithm for producer in producers))
            producers[port].fail()
            self.assertEqual(update(filter_), 0)
            self.assertIn(producers[port].words, "".join(upstream.errors))
            messages.errors.clear()
            filter_.Modified()
            self.assertEqual(update(filter_), 0)
            self.check_failed(filter_, messages, port, producers[port].words)
            producers[port].mend()
            self.check_mended(filter_, expected)
            self.assertEqual(len(messages.errors), 1)

        self.for_each_port(check)

    def test_errors_as_data(self):
        """One update, and the whole pipeline has executed: each algorithm has said what is wrong, once."""

        def check(port, filter_, producers):
            for algorithm in (filter_, *(producer.algorithm for producer in producers)):
                algorithm.ErrorsAsDataOn()
            self.assertEqual(update(filter_), 1)
            expected = copies(filter_)
            messages = Messages(filter_)
            for _ in range(2):
                upstream = Messages(producers[port].algorithm)
                producers[port].fail()
                self.assertEqual(update(filter_), 1)
                self.assertEqual(len(upstream.errors), 1, upstream.errors)
                self.assertEqual(error_of(producers[port].algorithm.GetOutputDataObject(0)), text_of(upstream.errors[0]))
                self.check_failed(filter_, messages, port, producers[port].words)
                messages.errors.clear()
                producers[port].mend()
                self.check_mended(filter_, expected)
            self.assertFalse(messages.errors)

        self.for_each_port(check)

    def test_the_first_error_of_a_chain(self):
        for as_data in (False, True):
            first, source = surfaces(), beams()
            tree = al.vtkAvianLidarCollisionTree()
            tree.SetInputConnection(first.port)
            echo = scan(tree, source.algorithm, BeamSamples=RAYS, **SETTINGS)  # so that it has rays to trace
            colours = al.vtkAvianLidarHSBColorMap()
            colours.SetInputConnection(echo.GetOutputPort())
            chain = (first.algorithm, tree, echo, colours)
            for algorithm in chain:
                algorithm.SetErrorsAsData(as_data)
            update(colours)
            count = colours.GetOutput().GetNumberOfPoints()
            builds, traced = tree.GetNumberOfBuilds(), echo.GetNumberOfTracedRays()
            self.assertTrue(count and builds and traced)
            said = [Messages(algorithm) for algorithm in chain]
            first.fail()
            for _ in chain:  # without errors as data each update comes one further
                update(colours)
            self.assertEqual([len(messages.errors) for messages in said], [1, 1, 1, 1])
            for messages, port in zip(said[1:], (0, 1, 0)):
                self.assertTrue(
                    text_of(messages.errors[0]).startswith(f"Input port {port}: its producer failed: Material: "),
                    messages.errors,
                )
            first.mend()
            self.assertEqual(update(colours), 1)
            self.assertEqual(colours.GetOutput().GetNumberOfPoints(), count)
            # What was known is still known.
            self.assertEqual((tree.GetNumberOfBuilds(), echo.GetNumberOfTracedRays()), (builds, 0))

    def test_a_filter_between_passes_the_error_on(self):
        """As VTK does with the field data of a first input."""
        for as_data in (False, True):
            for between in (vtk.vtkTriangleFilter(), vtk.vtkMultiBlockDataGroupFilter()):
                with self.subTest(between.GetClassName(), as_data=as_data):
                    failing = surfaces(town(3, 1).GetBlock(0))
                    between.SetInputConnection(failing.port)
                    tree = al.vtkAvianLidarCollisionTree()
                    tree.SetInputConnection(between.GetOutputPort())
                    for algorithm in (failing.algorithm, tree):
                        algorithm.SetErrorsAsData(as_data)
                    update(tree)
                    whole = tree.GetOutput().GetNumberOfCells()
                    heard, messages = Messages(failing.algorithm, between), Messages(tree)
                    failing.fail()
                    update(tree)
                    if not as_data:
                        update(tree)
                    self.assertEqual(len(heard.errors), 1)
                    self.check_failed(tree, messages, 0, failing.words)
                    failing.mend()
                    self.assertEqual(update(tree), 1)
                    self.assertEqual(tree.GetOutput().GetNumberOfCells(), whole)

    def test_a_failed_image_has_the_extent_that_it_promised(self):
        """VTK's imaging filters crash without it."""
        for before in (True, False):
            image, producers = pipeline("RangeImage")
            for algorithm in (image, *(producer.algorithm for producer in producers)):
                algorithm.ErrorsAsDataOn()
            shift = vtk.vtkImageShiftScale()
            shift.SetInputConnection(image.GetOutputPort())
            if before:
                update(shift)
            messages = Messages(image, producers[0].algorithm)
            producers[0].fail()
            self.assertEqual(update(shift), 1)
            self.assertEqual(len(messages.errors), 2)
            self.assertEqual(shift.GetOutput().GetExtent(), (0, 89, 0, 3, 0, 0))

    def test_data_without_a_pipeline(self):
        """The empty output of what failed, handed on by a script; as a block, too."""
        failing = surfaces()
        failing.algorithm.ErrorsAsDataOn()
        heard = Messages(failing.algorithm)
        failing.fail()
        update(failing.algorithm)
        self.assertTrue(heard.errors)
        blocks = vtk.vtkMultiBlockDataSet()
        blocks.SetBlock(0, town(3, 1).GetBlock(0))
        blocks.SetBlock(1, vtk.vtkPolyData())
        blocks.GetBlock(1).SetFieldData(failing.algorithm.GetOutputDataObject(0).GetFieldData())
        for data in (failing.algorithm.GetOutputDataObject(0), blocks):
            echo = scan(data, **SETTINGS)
            messages = Messages(echo)
            self.assertEqual(update(echo), 0)
            self.check_failed(echo, messages, 1, failing.words)

    def test_numbers_named_error_are_no_error(self):
        data = vtk.vtkPolyData()
        data.DeepCopy(town(3, 1).GetBlock(0))
        numbers = vtk.vtkDoubleArray()
        numbers.SetName("error")
        numbers.InsertNextValue(0.5)
        data.GetFieldData().AddArray(numbers)
        self.assertEqual(update(scan(data, **SETTINGS)), 1)

    def test_writers_leave_the_file(self):
        for name, ending in WRITERS.items():
            for as_data in (False, True):
                with self.subTest(name, as_data=as_data):
                    producer = echoes()
                    origin = vtk.vtkDoubleArray()
                    origin.SetName("geodetic_origin")
                    origin.SetNumberOfComponents(3)
                    origin.InsertNextTuple3(31, 121, 3)
                    surfaces_ = producer.algorithm.GetInputDataObject(1, 0)
                    surfaces_.GetFieldData().AddArray(origin)
                    producer.algorithm.SetErrorsAsData(as_data)
                    writer = getattr(al, "vtkAvianLidar" + name)()
                    writer.SetInputConnection(producer.port)
                    writer.SetFileName(f"{FILE}.{ending}")
                    self.assertEqual(writer.Write(), 1)
                    content = np.fromfile(writer.GetFileName(), np.uint8)
                    messages, upstream = Messages(writer), Messages(producer.algorithm)
                    producer.fail()
                    for _ in range(2):
                        writer.Write()
                    self.assertEqual(len(upstream.errors), 1)
                    self.assertIn("Input port 0: its producer failed: Attenuation", messages.errors[-1])
                    self.assertEqual(writer.GetErrorCode(), vtk.vtkErrorCode.UserError)
                    np.testing.assert_array_equal(np.fromfile(writer.GetFileName(), np.uint8), content)
                    producer.mend()
                    self.assertEqual(writer.Write(), 1)
                    for extra in (ending, "label"):
                        if os.path.exists(f"{FILE}.{extra}"):
                            os.remove(f"{FILE}.{extra}")


class Foreign(unittest.TestCase):
    """A reader of VTK that leaves an error code."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.file = os.path.join(self.folder, "box.stl")
        cube = vtk.vtkCubeSource()
        cube.SetCenter(50, 0, 0)
        cube.SetXLength(20)
        cube.SetYLength(20)
        cube.SetZLength(20)
        cut = vtk.vtkTriangleFilter()
        cut.SetInputConnection(cube.GetOutputPort())
        writer = vtk.vtkSTLWriter()
        writer.SetInputConnection(cut.GetOutputPort())
        writer.SetFileName(self.file)
        writer.Write()
        self.reader = vtk.vtkSTLReader()
        self.reader.AddObserver("ErrorEvent", lambda *_: None)  # its own error is not printed

    def chains(self):
        """Echo filters behind the reader, and behind filters of ours."""
        material, tree = al.vtkAvianLidarMaterial(), al.vtkAvianLidarCollisionTree()
        for filter_ in (material, tree):
            filter_.SetInputConnection(self.reader.GetOutputPort())
        for filter_ in (self.reader, material, tree):
            yield filter_.GetClassName(), scan(filter_, **SETTINGS)

    def test_a_change_downstream_does_not_make_it_an_empty_scene(self):
        for name, echo in self.chains():
            for first in (echo, self.reader):
                with self.subTest(name, first=first.GetClassName()):
                    self.reader.SetFileName(self.file)
                    echo.Update()
                    self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 0)
                    self.reader.SetFileName(os.path.join(self.folder, "no.stl"))
                    first.Update()
                    for attenuation in (1e-4, 2e-4):
                        echo.SetAttenuationCoefficient(attenuation)
                        self.assertEqual(update(echo), 0)
                    self.reader.SetFileName(self.file)
                    echo.Update()
                    self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 0)

    def test_a_writer_leaves_the_file(self):
        self.reader.SetFileName(self.file)
        echo = scan(self.reader, **SETTINGS)
        writer = al.vtkAvianLidarPCDWriter()
        writer.SetInputConnection(echo.GetOutputPort())
        writer.SetFileName(os.path.join(self.folder, "echoes.pcd"))
        self.assertEqual(writer.Write(), 1)
        with open(writer.GetFileName(), "rb") as file:
            before = file.read()
        self.reader.SetFileName(os.path.join(self.folder, "no.stl"))
        for attenuation in (1e-4, 2e-4, 3e-4):
            echo.SetAttenuationCoefficient(attenuation)
            heard = Messages(echo, writer)
            writer.Write()
            with open(writer.GetFileName(), "rb") as file:
                self.assertEqual(file.read(), before, attenuation)
            del heard
        self.reader.SetFileName(self.file)
        self.assertEqual(writer.Write(), 1)

    def test_another_producer_may_be_older(self):
        good = vtk.vtkSTLReader()
        good.SetFileName(self.file)
        good.Update()
        self.reader.SetFileName(os.path.join(self.folder, "no.stl"))
        echo = scan(self.reader, **SETTINGS)
        self.assertEqual(update(echo), 0)
        echo.SetInputConnection(1, good.GetOutputPort())
        self.assertEqual(update(echo), 1)
        self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 0)

    def test_a_field_of_the_users_own_is_no_error(self):
        data = town(3, 12).GetBlock(0)
        own = vtk.vtkStringArray()
        own.SetName("error")
        own.InsertNextValue("none")
        data.GetFieldData().AddArray(own)
        echo = scan(data, **SETTINGS)
        heard = Messages(echo)
        echo.Update()
        self.assertEqual(heard.errors, [])


if __name__ == "__main__":
    unittest.main()
