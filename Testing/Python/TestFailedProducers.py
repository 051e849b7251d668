# SPDX-License-Identifier: BSD-3-Clause
"""What follows an execution that failed or was stopped: whoever is updated next says so, by the input port and the
first error, and has no output; a file stays as it is; the next good input works. As VTK has it, and with errors as
data, as ParaView has it."""
import os

import numpy as np
import vtk
from vtk.util import numpy_support

import cloudtools
from avianlidar import vtkAvianLidar as al
from avianlidar._paraview import Advisor
from cloudtools import add_field, cloud
from echotools import RAYS, InFolder, Messages, assert_same_bits, group, scan, sensor, town
from faulttools import (CLASSES, SETTINGS, algorithms, copy_of, error_of, make, outputs, produced_beams,
                        produced_echoes, produced_surfaces,
                        size_of, writer)
from scenetools import SHIPPED

FILTERS = {name: (properties, *inputs) for name, properties, *inputs in CLASSES if not name.endswith("Writer")}


def pipeline(name):
    """(filter, its producers)"""
    properties, *inputs = FILTERS[name]
    filter_, producers = make(name, **properties), [produce() for produce, _ in inputs]
    for port, producer in enumerate(producers):
        filter_.SetInputConnection(port, producer.port)
    return filter_, producers


def update(algorithm):
    """What the executive says: 0 for a failure."""
    return algorithm.GetExecutive().Update(0)


def content(name):
    with open(name, "rb") as file:
        return file.read()


class Producers(InFolder):
    def check_failed(self, filter_, messages, port, words):
        """One error, and no output but the error, without the place in the code."""
        self.assertEqual(len(messages.errors), 1, messages.errors)
        said = messages.errors[0].split("): ", 1)[1].strip()
        self.assertIn(f"Input port {port}: its producer failed: ", said)
        self.assertEqual(said.count("its producer failed"), 1)
        self.assertIn(words, said)
        for data in outputs(filter_):
            if data.IsA("vtkImageData") and filter_.GetErrorsAsData():
                self.assertTrue(np.isnan(numpy_support.vtk_to_numpy(data.GetPointData().GetScalars())).all())
            else:
                self.assertEqual(size_of(data), 0)
            self.assertEqual((error_of(data), data.GetFieldData().GetNumberOfArrays()), (said, 1))

    def assert_emptied(self, filter_, *words):
        """Every output is empty, and its field data say why."""
        for data in outputs(filter_):
            self.assertEqual((size_of(data), data.GetFieldData().GetNumberOfArrays()), (0, 1))
            for text in words:
                self.assertIn(text, error_of(data))

    def test_nothing_stays_in_an_output_after_a_failure(self):
        """In plain VTK, at the first update: an input that is taken away or of a wrong type."""
        for name, ports in FILTERS.items():
            for port in range(len(ports) - 1):
                with self.subTest(name, port=port):
                    filter_, producers = pipeline(name)
                    self.assertEqual(update(filter_), 1)
                    self.assertGreater(size_of(outputs(filter_)[0]), 0)
                    Messages(filter_)  # also what the executive says
                    for spoil in (lambda: filter_.RemoveAllInputConnections(port),
                                  lambda: filter_.SetInputDataObject(port, vtk.vtkTable())):
                        spoil()
                        if update(filter_):  # not every input has to be there
                            continue
                        self.assert_emptied(filter_)
                        filter_.SetInputConnection(port, producers[port].port)
                        self.assertEqual(update(filter_), 1)
                        self.assertGreater(size_of(outputs(filter_)[0]), 0)

    def test_the_error_is_that_of_the_last_update(self):
        """After an own error that is mended, an error upstream, and other ones, in plain VTK."""
        first, source = produced_surfaces(), produced_beams()
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(first.port)
        echo = scan(tree, source.algorithm, **SETTINGS)
        heard = [Messages(one) for one in (first.algorithm, tree, echo, source.algorithm)]
        echo.SetRaysPerBeam(-1)
        self.assertEqual(update(echo), 0)
        self.assert_emptied(echo, "RaysPerBeam")
        echo.SetRaysPerBeam(20)
        first.set(-1.0)
        self.assertEqual(update(echo), 0)
        self.assert_emptied(echo, "Input port 1: its producer failed")
        self.assertNotIn("RaysPerBeam", error_of(outputs(echo)[0]))
        first.set(0.3)
        source.algorithm.SetBeamOutline(2)
        self.assertEqual(update(echo), 0)
        self.assert_emptied(echo, "Input port 0: its producer failed")
        self.assertTrue(heard[0].errors)

    def test_every_class_with_inputs_is_here(self):
        found = {name[len("vtkAvianLidar"):] for name in dir(al) if name.startswith("vtkAvianLidar")}
        # A SensorReader is a BeamSource with values of a file.
        found = {name for name in found - {"CloudWriter", "ScanFilter", "SensorReader"} if make(name).GetNumberOfInputPorts()}
        self.assertEqual(found, {*FILTERS, *(name + "Writer" for name in cloudtools.WRITERS)})

    def test_an_error_upstream_is_not_an_empty_input(self):
        """Plain, VTK does not execute what is downstream of a failure, whose outputs are empty at once; the second
        update says so, as VTK considers what failed up to date. With errors as data one update executes the whole
        pipeline, and each algorithm says what is wrong, once."""
        for name, ports in FILTERS.items():
            filter_, producers = pipeline(name)
            self.assertEqual(update(filter_), 1)
            expected = [copy_of(data) for data in outputs(filter_)]
            self.assertGreater(size_of(expected[0]), 0)
            messages = Messages(filter_)
            for as_data in (False, True):
                for algorithm in (filter_, *(producer.algorithm for producer in producers)):
                    algorithm.SetErrorsAsData(as_data)
                for port in range(len(ports) - 1):
                    with self.subTest(name, port=port, as_data=as_data):
                        upstream = Messages(*(producer.algorithm for producer in producers))
                        producers[port].set(-1.0)
                        self.assertEqual(update(filter_), as_data)
                        self.assertEqual(len(upstream.errors), 1, upstream.errors)
                        self.assertIn(producers[port].words, upstream.errors[0])
                        if not as_data:
                            self.assert_emptied(filter_, f"Input port {port}: its producer failed: ",
                                                producers[port].words)
                            self.assertEqual(messages.errors, [])
                            filter_.Modified()
                            self.assertEqual(update(filter_), 0)
                        self.check_failed(filter_, messages, port, producers[port].words)
                        messages.errors.clear()
                        producers[port].set(producers[port].good)
                        self.assertEqual(update(filter_), 1)
                        for data, before in zip(outputs(filter_), expected):
                            self.assertEqual((error_of(data), size_of(data)), ("", size_of(before)))
                            if data.IsA("vtkPolyData"):
                                assert_same_bits(data, before)
                        self.assertEqual(messages.errors, [])

    def test_the_first_error_of_a_chain(self):
        """Each says it once, a filter of VTK between passes it on, and what was known is still known afterwards. In
        plain VTK all outputs are empty at the first update, also of a second consumer."""
        for as_data in (False, True):
            first, source, between = produced_surfaces(), produced_beams(), vtk.vtkMultiBlockDataGroupFilter()
            between.SetInputConnection(first.port)
            tree = al.vtkAvianLidarCollisionTree()
            tree.SetInputConnection(between.GetOutputPort())
            echo = scan(tree, source.algorithm, BeamSamples=RAYS, **SETTINGS)  # so that it has rays to trace
            colours = al.vtkAvianLidarHSBColorMap()
            colours.SetInputConnection(echo.GetOutputPort())
            chain, other = (first.algorithm, tree, echo, colours), scan(tree, source.algorithm, **SETTINGS)
            for algorithm in (*chain, other):
                algorithm.SetErrorsAsData(as_data)
            for one in (colours, other):
                self.assertEqual(update(one), 1)
            known = colours.GetOutput().GetNumberOfPoints(), tree.GetNumberOfBuilds(), echo.GetNumberOfTracedRays()
            self.assertTrue(all(known))
            said, _ = [Messages(algorithm) for algorithm in chain], Messages(other)
            first.set(-1.0)
            for last, through in ((colours, (tree, echo, colours)), (other, (other,))) if not as_data else ():
                self.assertEqual(update(last), 0)
                for one in through:
                    self.assert_emptied(one, "its producer failed")
            for _ in (*chain, between):  # without errors as data each update comes one further
                update(colours)
            self.assertEqual([len(messages.errors) for messages in said], [1, 1, 1, 1])
            for messages, port in zip(said[1:], (0, 1, 0)):
                self.assertIn(f"): Input port {port}: its producer failed: Material: ", messages.errors[0])
            first.set(0.3)
            for one in (other, colours):
                self.assertEqual(update(one), 1)
                self.assertGreater(size_of(outputs(one)[0]), 0)
            self.assertEqual((colours.GetOutput().GetNumberOfPoints(), tree.GetNumberOfBuilds(),
                              echo.GetNumberOfTracedRays()), (*known[:2], 0))

    def test_a_failed_image_has_the_extent_that_it_promised(self):
        """VTK's imaging filters crash without it."""
        image, producers = pipeline("RangeImage")
        for algorithm in (image, *(producer.algorithm for producer in producers)):
            algorithm.ErrorsAsDataOn()
        shift = vtk.vtkImageShiftScale()
        shift.SetInputConnection(image.GetOutputPort())
        messages = Messages(image, producers[0].algorithm)
        producers[0].set(-1.0)
        self.assertEqual((update(shift), len(messages.errors)), (1, 2))
        self.assertEqual(shift.GetOutput().GetExtent(), (0, 35, 0, 1, 0, 0))

    def test_data_without_a_pipeline(self):
        """The empty output of what failed, handed on by a script; as a block, also of blocks. A field `error` of the
        user's own is no error."""
        failing = produced_surfaces()
        failing.algorithm.ErrorsAsDataOn()
        heard = Messages(failing.algorithm)
        failing.set(-1.0)
        update(failing.algorithm)
        self.assertTrue(heard.errors)
        failed = failing.algorithm.GetOutputDataObject(0)
        blocks = group(town(3, 1).GetBlock(0), vtk.vtkPolyData())
        blocks.GetBlock(1).SetFieldData(failed.GetFieldData())
        for data in (failed, blocks, group(town(3, 1).GetBlock(0), failed)):
            echo = scan(data, **SETTINGS)
            messages = Messages(echo)
            self.assertEqual(update(echo), 0)
            self.check_failed(echo, messages, 1, failing.words)
        data = copy_of(town(3, 1).GetBlock(0))
        add_field(data, "error", (0.5,))
        self.assertEqual(update(scan(data, **SETTINGS)), 1)

    def test_the_advisor(self):
        """A wrong value and a failed producer are said as field data of an empty table; the next good input works."""
        advisor, given, failing = Advisor(), produced_beams(18, 1), produced_surfaces()
        failing.algorithm.SetErrorsAsData(True)
        Messages(failing.algorithm)
        advisor.SetInputConnection(0, given.port)
        advisor.SetInputConnection(1, failing.port)
        for count, value, said in ((1, failing.good, "beams is 1, expected 50"), (50, -1.0, failing.words),
                                   (50, failing.good, "")):
            advisor.SetSampleBeams(count)
            failing.set(value)
            advisor.Update()
            table = advisor.GetOutputDataObject(0)
            self.assertIn(said, error_of(table))
            self.assertEqual((table.GetNumberOfRows(), bool(error_of(table))), (0 if said else 37, bool(said)))

    def test_writers_leave_the_file(self):
        for name in cloudtools.WRITERS:
            for as_data in (False, True):
                with self.subTest(name, as_data=as_data):
                    producer, write = produced_echoes(), writer(name)
                    producer.algorithm.SetErrorsAsData(as_data)
                    write.SetInputConnection(producer.port)
                    self.assertEqual(write.Write(), 1)
                    before = content(write.GetFileName())
                    messages, upstream = Messages(write), Messages(producer.algorithm)
                    producer.set(-1.0)
                    for _ in range(2):
                        write.Write()
                    self.assertEqual(len(upstream.errors), 1)
                    self.assertIn("Input port 0: its producer failed: Attenuation", messages.errors[-1])
                    self.assertEqual(write.GetErrorCode(), vtk.vtkErrorCode.UserError)
                    self.assertEqual(content(write.GetFileName()), before)
                    producer.set(producer.good)
                    self.assertEqual(write.Write(), 1)

    def test_a_reader_of_vtk_that_leaves_an_error_code(self):
        """A change downstream does not make its failure an empty scene; a writer leaves the file."""
        cut = vtk.vtkTriangleFilter()
        cut.SetInputData(town(3, 1).GetBlock(0))
        stl = vtk.vtkSTLWriter()
        stl.SetInputConnection(cut.GetOutputPort())
        stl.SetFileName("box.stl")
        stl.Write()
        reader, tree = vtk.vtkSTLReader(), al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(reader.GetOutputPort())
        for filter_, first in ((reader, False), (reader, True), (tree, True)):
            with self.subTest(filter_.GetClassName(), first=first):
                reader.SetFileName("box.stl")
                echo, write = scan(filter_, **SETTINGS), writer("PCD")
                write.SetInputConnection(echo.GetOutputPort())
                self.assertEqual(write.Write(), 1)
                self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 0)
                before = content("echoes.pcd")
                heard = Messages(reader, echo, write, filter_)
                reader.SetFileName("no.stl")
                update(echo if first else reader)
                if first:
                    self.assert_emptied(echo, "producer failed")
                for attenuation in (1e-4, 2e-4):
                    echo.SetAttenuationCoefficient(attenuation)
                    self.assertEqual(update(echo), 0)
                    write.Write()
                    self.assertEqual(content("echoes.pcd"), before)
                self.assertTrue(heard.errors)

    def test_aborts(self):
        """Every algorithm hears it at the first progress and later: no error, and an empty output or the whole one.
        Without it all goes on, and progress rises from 0 to 1."""
        good = writer("PCD")
        good.SetInputData(cloud(np.ones((50000, 3))))
        self.assertEqual(good.Write(), 1)
        cases = [(make("BeamSource"), []), (make("Tracks"), []), (make("PointCloudReader", FileName="echoes.pcd"), []),
                 (make("SceneReader", FileName=SHIPPED), [])]
        cases += [(one, inputs) for one, inputs, _ in algorithms() if not isinstance(one, al.vtkAvianLidarCloudWriter)]
        for algorithm, inputs in cases:
            for port, data in enumerate(inputs):
                algorithm.SetInputData(port, data)
            seen, found, least = [], [], [0]

            def stop(caller, _, seen=seen, least=least):
                seen.append(caller.GetProgress())
                caller.SetAbortExecute(least[0] <= seen[-1] < 1)

            algorithm.AddObserver("ProgressEvent", stop)
            heard = Messages(algorithm)
            with self.subTest(algorithm.GetClassName()):
                for least[0] in (0, 2, 0.3, 2):
                    seen.clear()
                    algorithm.SetAbortExecute(0)
                    algorithm.Modified()
                    algorithm.Update()
                    self.assertEqual(heard.errors, [])
                    found.append([size_of(data) for data in outputs(algorithm)])
                self.assertFalse(any(found[0]))
                self.assertTrue(any(found[1]))
                self.assertIn(found[2], (found[0], found[1]))
                self.assertEqual(found[3], found[1])
                self.assertEqual((seen, seen[0], seen[-1]), (sorted(seen), 0, 1))

    def test_writers_stop_and_report_on_the_way(self):
        """At the first progress and later: no error and no file."""
        data = cloud(np.random.default_rng(3).uniform(-100, 100, (50000, 3)))
        cloudtools.add_array(data, "energy", np.ones(50000), "J")
        cloudtools.add_array(data, "object_id", np.zeros(50000, int))
        for name, values in (("geodetic_origin", cloudtools.ORIGIN), ("position", (0.0, 0.0, 0.0))):
            add_field(data, name, values)
        for name in cloudtools.WRITERS:
            for least in (0, 1e-9, 2):
                write, seen = writer(name), []
                heard = Messages(write)
                write.SetInputData(data)

                def stop(caller, _, seen=seen, least=least):
                    seen.append(caller.GetProgress())
                    if least <= seen[-1] < 1:
                        caller.SetAbortExecute(1)

                write.AddObserver("ProgressEvent", stop)
                with self.subTest(name, least=least):
                    self.assertEqual((write.Write(), heard.errors), (int(least == 2), []))
                    self.assertEqual(bool(os.listdir()), least == 2)
            self.assertEqual((seen, seen[0], seen[-1]), (sorted(seen), 0, 1))
            self.assertGreater(len(seen), 5)
            for file in os.listdir():
                os.remove(file)
