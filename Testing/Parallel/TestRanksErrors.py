# SPDX-License-Identifier: BSD-3-Clause
"""An error or an abort on one rank, or on all, ends the execution on all ranks, with a message and empty outputs.
The next good input gives all ranks the echoes of one process."""
import faulthandler
import json
import os
import sys

import numpy as np
import vtk

from paralleltools import (LAST, RANK, RANKS, assert_same, exchange, in_order, joined, main, point_arrays,
                           tests_of, total, update)
import cloudtools
import echotools
import faulttools
from avianlidar import vtkAvianLidar as al

# A case that hangs is named, with where it hangs, and ends the job.
SECONDS = 120
TOWN = echotools.town(3, 12)
SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}
WHO = [{LAST}, {0}, set(range(RANKS))]


def sizes(algorithm):
    return set(exchange(" ".join(str(algorithm.GetOutput(port).GetNumberOfPoints()) for port in (0, 1))))


def heard_by_all(messages):
    heard = exchange("\n".join(messages.errors))
    messages.errors.clear()
    return heard


def echoes_of(surfaces, beams=None):
    """The result of one process."""
    return in_order(point_arrays(echotools.output(echotools.scan(surfaces, beams, **SETTINGS))))


def check_good(echo, expected=None):
    """All execute once more."""
    echo.Modified()
    assert_same(joined(update(echo).GetOutput()), echoes_of(TOWN) if expected is None else expected)


def mine(good, bad):
    return bad if RANK == LAST else good


def check_bad(number, what, make, spoil, mend, expected, words):
    """One case. @param make gives the filters, the last of them the echo filter; rank 0 says whose error it is"""
    faulthandler.dump_traceback_later(SECONDS, exit=True, file=sys.__stderr__)
    who = WHO[number % len(WHO)]
    filters = make()
    echo, messages = filters[-1], echotools.Messages(*filters)
    if RANK in who:
        spoil(filters)
    for algorithm in filters:
        algorithm.Modified()
    ends = exchange(str(bool(echo.UpdatePiece(RANK, RANKS, 0))))
    heard = heard_by_all(messages)
    assert set(ends) == {"False"} and sizes(echo) == {"0 0"}, (what, who, ends, heard)
    assert all(heard[rank] for rank in who | {0}) and any(words in text for text in heard), (what, who, heard)
    if who == {LAST} and not what.startswith("surfaces"):
        assert words in heard[0] and f"Rank {LAST}" in heard[0], (what, heard)
    mend(filters)
    for algorithm in filters:
        algorithm.Modified()
    check_good(echo, expected)
    assert not any(heard_by_all(messages)), (what, who)
    faulthandler.cancel_dump_traceback_later()


def test_bad_input():
    """Each array, field and property once, on ranks in turn."""
    surfaces, beams = faulttools.surfaces(), faulttools.beams(RANK, RANKS)
    expected = echoes_of(surfaces, faulttools.beams())
    number = 0

    def scan(with_tree=False):
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(surfaces)
        return [tree, echotools.scan(tree if with_tree else surfaces, beams, **SETTINGS)]

    for port, reads in enumerate((faulttools.OF_BEAMS, faulttools.OF_SURFACES)):
        for where, name, ways in reads:
            for with_tree in (False, True) if port else (False,):
                number += 1
                how = ways[number % len(ways)]
                good, bad = ((beams, surfaces)[port], faulttools.spoil((beams, surfaces)[port], where, name, how))
                def give(filters, data, with_tree=with_tree, port=port):
                    filters[0 if with_tree else 1].SetInputData(0 if with_tree else port, data)

                check_bad(number, f"{('beams', 'surfaces')[port]} {name} {how} {with_tree}",
                          lambda with_tree=with_tree: scan(with_tree), lambda filters, bad=bad: give(filters, bad),
                          lambda filters, good=good: give(filters, good), expected, name)
    for which, name, value in ((1, "Preset", 6), (1, "RaysPerBeam", 0), (1, "AttenuationCoefficient", -1e-9),
                               (1, "ReturnMode", 5), (1, "NumberOfThreads", -1), (0, "SplitRule", 4),
                               (0, "BoundingVolume", -1), (0, "MaximumLeafSize", 0)):
        number += 1
        before = getattr(scan()[which], "Get" + name)()
        check_bad(number, name, lambda which=which: scan(which == 0),
                  lambda filters: getattr(filters[which], "Set" + name)(value),
                  lambda filters: getattr(filters[which], "Set" + name)(before), expected, name)


def test_block_of_2_gib():
    """More than VTK sends at once: an error on all ranks that names the block."""
    large = echotools.box((50, 0, 0), (5, 5, 5), "Metal")
    if RANK == LAST:
        large.GetPoints().GetData().Resize(90_000_000)  # 24 bytes each; never written, so they take no memory
        large.GetPoints().GetData().SetNumberOfTuples(90_000_000)
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.ShallowCopy(TOWN)
    blocks.SetBlock(3, mine(None, large))
    echo = echotools.scan(blocks, **SETTINGS)
    messages = echotools.Messages(echo)
    update(echo)
    heard = heard_by_all(messages)
    assert sizes(echo) == {"0 0"}
    assert all("block 'house 3': too large to send" in heard[rank] for rank in (0, LAST)), heard
    echo.SetInputData(1, TOWN)
    check_good(echo)


def test_settings_of_every_filter():
    """A setting of one rank that differs is an error on all, which names it; the next good settings work."""
    def timed(data, time=1.0, **fields):
        data.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), time)
        for name, values in fields.items():
            cloudtools.add_field(data, name, values)
        return data

    def cloud(**fields):
        places = np.random.default_rng(RANK).uniform(-100, 100, (20, 3))
        return timed(cloudtools.cloud(places), **{"position": (1.0, 2.0, 3.0), **fields})

    def filter_of(name, *data):
        made = getattr(al, "vtkAvianLidar" + name)()
        for port, one in enumerate(data):
            made.SetInputData(port, one)
        return made

    source = echotools.sensor()
    source.UpdatePiece(RANK, RANKS, 0)
    beams = echotools.copy_of(source.GetOutput())

    def image():
        made, sensor = filter_of("RangeImage"), echotools.sensor()
        echo = echotools.scan(TOWN, sensor, **SETTINGS)
        made.SetInputConnection(0, echo.GetOutputPort())
        made.SetInputConnection(1, sensor.GetOutputPort())
        return made

    cases = [(lambda: filter_of("ClutterFilter", cloud()), (
                  ("Window", 9.0), ("ClutterThreshold", 0.5), ("RangeStep", 3.0), ("AzimuthStep", 1.0),
                  ("ElevationStep", 1.0), ("RangeTolerance", 3), ("AngularTolerance", 4), ("WarmUp", 7))),
             (lambda: filter_of("ClutterFilter", cloud()), (("InputData", cloud(position=(1.0, 2.0, 3.5))),)),
             (lambda: filter_of("Tracker", cloud()),
              (("ClusterDistance", 3.0), ("MotionModel", 0), ("SensorPosition", (1.0, 0.0, 0.0)))),
             (lambda: filter_of("Tracker", cloud()),
              (("InputData", cloud(position=(1.0, 2.0, 3.5))), ("InputData", cloud(time=2.0)))),
             (lambda: filter_of("CollisionTree", TOWN),
              (("SplitRule", 1), ("BoundingVolume", 1), ("MaximumLeafSize", 9), ("Preset", 1))),
             (lambda: echotools.scan(TOWN, beams, **SETTINGS),
              (("ReportMovers", False), ("RaysPerBeam", 30), ("Visibility", 1000.0), ("ReturnMode", 1))),
             (image, (("Columns", 40), ("Rows", 2)))]
    for make, settings in cases:
        for name, value in settings:
            made = make()
            messages = echotools.Messages(made)
            of_data = name == "InputData"
            before = made.GetInputDataObject(0, 0) if of_data else getattr(made, "Get" + name)()
            getattr(made, "Set" + name)(mine(before, value))
            update(made)
            words = name
            if of_data:
                words = "position" if made.IsA("vtkAvianLidarClutterFilter") else "different times, positions"
            for heard in heard_by_all(messages):
                assert words in heard, (made.GetClassName(), name, heard)
                assert of_data or f"on rank {LAST}, expected the same on all ranks" in heard, heard
            assert not made.GetOutputDataObject(0).GetNumberOfElements(vtk.vtkDataObject.POINT)
            getattr(made, "Set" + name)(before)
            made.Modified()
            update(made)
            assert not any(heard_by_all(messages)), (made.GetClassName(), name)
            if made.IsA("vtkAvianLidarEchoFilter"):
                check_good(made)


def test_a_rank_without_points_learns_clutter():
    """It takes the sensor's position from the ranks that have points."""
    def played(parts):
        filter_ = al.vtkAvianLidarClutterFilter()
        for time in range(3):
            data = cloudtools.cloud(np.random.default_rng(5).uniform(-50, 50, (30, 3))[parts])
            data.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), float(time))
            if data.GetNumberOfPoints():
                cloudtools.add_field(data, "position", (5.0, 6.0, 7.0))
            filter_.SetInputData(data)
            yield filter_

    for serial, together in zip(played(slice(None)), played(slice(0, 0) if RANK == 0 and RANKS > 1
                                                            else slice(RANK - 1, None, max(1, RANKS - 1)))):
        serial.SetController(None)
        serial.Update()
        update(together)
    table = joined(together.GetOutputDataObject(1))
    assert_same(table, in_order(point_arrays(serial.GetOutputDataObject(1))))


def test_beams_of_two_sensors():
    source = echotools.sensor()
    source.Update()
    whole = echotools.copy_of(source.GetOutput())
    part = echotools.copy_of(update(source).GetOutput())
    other = echotools.copy_of(part)
    other.GetFieldData().GetArray("pulse_energy").SetValue(0, 1e-4)
    echo = echotools.scan(TOWN, whole, **SETTINGS)
    messages = echotools.Messages(echo)
    for beams, words in ((whole, "twice"), (mine(part, other), "different sensors")):
        echo.SetInputData(0, beams)
        echo.Modified()
        update(echo)
        assert all(words in text for text in heard_by_all(messages)), words
    echo.SetInputData(0, part)
    check_good(echo)


def test_files():
    """A reader upstream fails on one rank, whose filter VTK would not execute. Only rank 0 opens meshes: its error is
    the error of all ranks. A reader of VTK executes on rank 0 only and returns 0: the other ranks would wait."""
    base = os.path.join(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"], f"TestRanksErrors-{RANKS}-{RANK}")
    meshes = {"good": "v 50 -9 -9\nv 50 9 -9\nv 50 0 9\nf 1 2 3\n", "damaged": "nothing"}
    for name, mesh in meshes.items():
        with open(f"{base}-{name}.obj", "w", encoding="utf-8") as stream:
            stream.write(mesh)
        with open(f"{base}-{name}.lidarscene.json", "w", encoding="utf-8") as stream:
            wall = {"file": os.path.basename(f"{base}-{name}.obj"), "material": "wall"}
            json.dump({"version": 1, "objects": [wall]}, stream)
    good, damaged, missing = (f"{base}-{name}.lidarscene.json" for name in ("good", "damaged", "missing"))
    for with_tree in (False, True):
        for files in ((good, missing), (damaged, damaged)):
            reader = al.vtkAvianLidarSceneReader()
            reader.SetFileName(mine(*files))
            surfaces = al.vtkAvianLidarCollisionTree() if with_tree else reader
            if with_tree:
                surfaces.SetInputConnection(reader.GetOutputPort())
            echo = echotools.scan(surfaces, **SETTINGS)
            opened, messages = echotools.Messages(reader), echotools.Messages(*({surfaces, echo} - {reader}))
            update(echo)
            read, heard = heard_by_all(opened), heard_by_all(messages)
            if files[0] == damaged:
                assert "damaged.obj" in read[0] and not any(read[1:]), read
            else:
                assert "missing.lidarscene.json" in read[LAST], read
            assert "upstream" in heard[0] and sizes(echo) == {"0 0"}, heard
            reader.SetFileName(good)
            echo.Modified()
            assert len(joined(update(echo).GetOutput())["beam_id"]) > 0
            reader.SetFileName(mine(*files))
            for algorithm in {reader, surfaces, echo}:  # all ranks must execute the same filters
                algorithm.Modified()
            update(echo)
            assert sizes(echo) == {"0 0"}  # also after echoes
    reader = vtk.vtkSTLReader()
    reader.SetFileName("missing.stl")
    echo = echotools.scan(reader, **SETTINGS)
    messages = echotools.Messages(reader, echo)
    for words in ("upstream", "its producer failed"):
        update(echo)
        assert words in heard_by_all(messages)[0] and sizes(echo) == {"0 0"}
        echo.Modified()
    for name in meshes:
        os.remove(f"{base}-{name}.obj")
        os.remove(f"{base}-{name}.lidarscene.json")


def test_errors_as_data():
    """As in ParaView: outputs after a failure are empty, and the pipeline goes on. The error is named on
    the failed rank and on rank 0. The image is made again on all ranks or on none, even if a rank has no part of it."""
    words = "its producer failed: Material: "
    for rows in (4, 1):
        material = al.vtkAvianLidarMaterial()
        material.SetMaterialToCustom()
        material.SetInputData(TOWN)
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(material.GetOutputPort())
        source = echotools.sensor(RANKS - 1, rows)
        echo = echotools.scan(tree, source, **SETTINGS)
        image = al.vtkAvianLidarRangeImage()
        image.SetInputConnection(0, echo.GetOutputPort())
        image.SetInputConnection(1, source.GetOutputPort())
        consumers = [vtk.vtkDataSetSurfaceFilter(), vtk.vtkImageDataGeometryFilter()]
        for consumer in consumers:
            consumer.SetInputConnection(image.GetOutputPort())
        chain = (material, tree, echo, image)
        for algorithm in chain:
            algorithm.ErrorsAsDataOn()
        said = [echotools.Messages(algorithm) for algorithm in chain]
        for kd in (-1, -2):
            material.SetKd(mine(0.3, kd))
            material.Modified()
            for algorithm, messages in ((image, said[3]), (tree, said[1]), (echo, said[2])):
                update(algorithm)
                for port in range(algorithm.GetNumberOfOutputPorts()):
                    data = algorithm.GetOutputDataObject(port)
                    assert data.IsA("vtkImageData") or data.GetNumberOfPoints() == 0, data.GetNumberOfPoints()
                    assert words in faulttools.error_of(data), faulttools.error_of(data)
                heard = heard_by_all(messages)
                assert words in heard[0] and words in heard[LAST], heard
                assert all(text.count("ERROR:") == 1 for text in heard if text), heard
            # Up to date: nobody waits for anybody, and nothing is said again. Surfaces of images ask for their extent.
            for consumer in (image, *consumers):
                update(consumer)
            assert not any(exchange("".join("".join(messages.errors) for messages in said[1:])))
            material.SetKd(0.3)
            material.Modified()
            update(image)
            assert not faulttools.error_of(image.GetOutput()) and not faulttools.error_of(echo.GetOutput())
            assert total(image.GetOutput().GetNumberOfPoints()) >= (RANKS - 1) * rows
            said[0].errors.clear()


def test_abort():
    """One rank is aborted, at once or half-way, or while beams, materials or the tree are made: empty outputs and no
    error, also two filters further down."""
    for asked, fraction in ((3, 0.0), (3, 0.5), (0, 0.0), (1, 0.0), (2, 0.0)):
        material, tree = al.vtkAvianLidarMaterial(), al.vtkAvianLidarCollisionTree()
        material.SetInputData(TOWN)
        material.SetMaterial(material.MATERIAL_UNCHANGED)
        tree.SetInputConnection(material.GetOutputPort())
        sensor = echotools.sensor()
        filters = (sensor, material, tree, echotools.scan(tree, sensor, **SETTINGS))
        messages = echotools.Messages(*filters)

        def heard(caller, _, fraction=fraction):
            if RANK == LAST and caller.GetProgress() >= fraction:
                caller.SetAbortExecute(1)

        observer = filters[asked].AddObserver("ProgressEvent", heard)
        update(filters[-1])
        assert sizes(filters[-1]) == {"0 0"} and not any(heard_by_all(messages))
        assert not filters[-1].GetOutput().GetFieldData().GetAbstractArray("error")
        filters[asked].RemoveObserver(observer)
        for algorithm in filters:
            algorithm.SetAbortExecute(0)
            algorithm.Modified()
        check_good(filters[-1])


def test_abort_beside_an_error():
    """One rank is aborted and another fails: the error of all, and nobody waits for anybody at the next update."""
    echo = echotools.scan(TOWN, echotools.sensor(), **SETTINGS)
    messages = echotools.Messages(echo)
    echo.SetRaysPerBeam(mine(20, -1))
    observer = echo.AddObserver("ProgressEvent", lambda caller, _: RANK == 0 and caller.SetAbortExecute(1))
    faulthandler.dump_traceback_later(SECONDS, exit=True, file=sys.__stderr__)
    for _ in range(2):
        update(echo)
        assert sizes(echo) == {"0 0"}
        echo.Modified()
    assert "RaysPerBeam" in heard_by_all(messages)[LAST]
    echo.RemoveObserver(observer)
    echo.SetAbortExecute(0)
    echo.SetRaysPerBeam(20)
    check_good(echo)


def test_abort_of_a_tracker():
    """One rank is aborted while tracks are updated: no rank keeps this cloud, and all go on as without it."""
    places = np.random.default_rng(3).uniform(-100, 100, (20, 3))
    serial, together = al.vtkAvianLidarTracker(), al.vtkAvianLidarTracker()
    serial.SetController(None)
    told = []

    def heard(caller, _):
        told.append(caller)
        if RANK == LAST and len(told) == 2:  # the first is before the execution
            caller.SetAbortExecute(1)

    for time in range(4):
        for tracker, mine in ((serial, slice(None)), (together, slice(RANK, None, RANKS))):
            cloud = cloudtools.cloud((places + 5 * time)[mine])
            cloud.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), float(time))
            tracker.SetInputData(cloud)
        if time == 1:
            observer = together.AddObserver("ProgressEvent", heard)
            update(together)
            assert len(told) > 1 and sizes(together) == {"0 0"}, told
            together.RemoveObserver(observer)
            together.SetAbortExecute(0)
        else:
            update(together)
            serial.Update()
    found, expected = (echotools.array(tracker.GetOutput(1), "track_id") for tracker in (together, serial))
    assert (found == expected[RANK::RANKS]).all(), (found, expected)
    assert RANK != 0 or not assert_same(point_arrays(together.GetOutput(0)), point_arrays(serial.GetOutput(0)))


if __name__ == "__main__":
    main(tests_of(sys.modules[__name__]))
