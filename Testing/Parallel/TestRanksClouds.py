# SPDX-License-Identifier: BSD-3-Clause
"""Behind the echo filter: the comparison of clouds, the clutter filter and the range image of several ranks are
together those of one process, and nothing is traced twice for them. TestRanks runs these."""

import math

import numpy as np
import vtk
from vtk.util import numpy_support

from paralleltools import (LAST, RANK, RANKS, assert_same, collect, exchange, in_order, joined, point_arrays, table,
                           total, update)
import cloudtools
import echotools
from avianlidar import vtkAvianLidar as al

TOWN = echotools.town(3, 24)
SETTINGS = {"RaysPerBeam": 40, "NumberOfThreads": 1, "BeamSamples": echotools.RAYS}  # rays are counted
NUMBERS = ("HausdorffDistance", "HausdorffSimulatedToReference", "HausdorffReferenceToSimulated",
           "RMSESimulatedToReference", "RMSEReferenceToSimulated", "DensityAwareChamferDistance",
           "DensityAwareChamferSimulatedToReference", "DensityAwareChamferReferenceToSimulated")


def scan(**settings):
    return echotools.scan(TOWN, **{**SETTINGS, **settings})


def compared(simulated, reference):
    comparison = al.vtkAvianLidarCloudComparison()
    for port, cloud in enumerate((simulated, reference)):
        comparison.SetInputConnection(port, cloud.GetOutputPort(0))
    return comparison


def image_of(echo, beams=None, port=1):
    image = al.vtkAvianLidarRangeImage()
    image.SetInputConnection(0, echo.GetOutputPort(0))
    image.SetInputConnection(1, (beams or echo).GetOutputPort(port))
    return image


def producer_of(data):
    producer = vtk.vtkTrivialProducer()
    producer.SetOutput(data)
    return producer


def whole_image(image):
    """The images of all ranks put together by their extents, as arrays by name; every cell must be somewhere."""
    mine, carrier = image.GetOutput(), cloudtools.cloud(np.zeros((image.GetOutput().GetNumberOfPoints(), 3)))
    carrier.GetPointData().ShallowCopy(mine.GetPointData())
    size = image.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
    shape = size[3] + 1, size[1] + 1
    extents = [eval(text) for text in exchange(repr(mine.GetExtent()))]
    whole, covered = {}, np.zeros(shape, dtype=int)
    for extent, part in zip(extents, collect(carrier)):
        cut = (slice(extent[2], extent[3] + 1), slice(extent[0], extent[1] + 1))
        covered[cut] += 1
        for name, values in point_arrays(part).items():
            if name != "points":
                whole.setdefault(name, np.zeros(shape, values.dtype))[cut] = values.reshape(covered[cut].shape)
    assert covered.all(), covered
    # Neighbours share a column or row of points, as with any image in pieces.
    assert RANKS == 1 or (covered == 1).sum() > 0.5 * covered.size, (extents, covered.sum())
    return whole


def serial_image(image):
    image.Update()
    columns, rows, _ = image.GetOutput().GetDimensions()
    data = image.GetOutput().GetPointData()
    names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
    return {name: echotools.array(image.GetOutput(), name).reshape(rows, columns) for name in names}


def assert_same_numbers(one, other):
    for name in NUMBERS:
        found, expected = getattr(one, f"Get{name}")(), getattr(other, f"Get{name}")()
        assert expected > 0 and math.isclose(found, expected, rel_tol=1e-12), (name, found, expected)
        assert not name.startswith("Hausdorff") or found == expected, (name, found, expected)


def test_ties_are_those_of_one_process():
    """Points of a few places, on all ranks, each with several nearest ones: n counts those of all ranks."""
    def clouds(ranks):
        for step in (0.5, 1.0):
            yield producer_of(cloudtools.cloud([np.random.default_rng(i).integers(-3, 3, (50, 3)) * step
                                                for i in ranks]))

    serial = compared(*clouds(range(RANKS)))
    serial.Update()
    together = update(compared(*clouds([RANK])))
    assert_same_numbers(together, serial)
    together.SetChamferAlpha(2.0 if RANK == LAST else 3.0)
    messages = echotools.Messages(together)
    update(together)
    assert RANKS == 1 or math.isnan(together.GetDensityAwareChamferDistance())
    assert RANKS == 1 or RANK != 0 or "ChamferAlpha is 3 on rank 0 and 2 on rank" in messages.errors[0], messages.errors


def test_clutter_is_learned_from_the_points_of_all():
    """Three scans of a sensor that jitters; the second one twice, as it executes again."""
    def played(ask):
        beams = echotools.sensor()
        beams.SetNumberOfRevolutions(3)
        beams.SetEncoderJitter(0.5)
        echo = echotools.scan(TOWN, beams, **SETTINGS)
        clutter = al.vtkAvianLidarClutterFilter()
        clutter.SetInputConnection(echo.GetOutputPort())
        clutter.SetAngularTolerance(0)
        for k in (0, 1, 1, 2):
            clutter.Modified()
            ask(clutter, k / beams.GetRotationRate())
        return clutter

    serial = played(lambda clutter, time: clutter.UpdateTimeStep(time))
    together = played(lambda clutter, time: clutter.UpdateTimeStep(time, RANK, RANKS, 0))
    expected = in_order(point_arrays(serial.GetOutputDataObject(0)))
    assert {0.0, 0.5, 1.0} <= set(expected["clutter_probability"].round(2)), set(expected["clutter_probability"])
    assert_same(joined(together.GetOutputDataObject(0)), expected)
    assert_same(joined(together.GetOutputDataObject(1)), in_order(point_arrays(serial.GetOutputDataObject(1))))
    for port in (0, 1):
        assert together.GetOutputDataObject(port).GetFieldData().GetArray("learned_scans").GetValue(0) == 3


def test_a_cloud_that_one_rank_has():
    """Every point is there once, with its distances."""
    echo = scan()
    echo.Update()
    serial = compared(scan(Seed=5), producer_of(echo.GetOutput(0)))
    serial.Update()
    together = update(compared(scan(Seed=5), producer_of(echo.GetOutput(0) if RANK == LAST else vtk.vtkPolyData())))
    for port in (0, 1):
        assert_same(joined(together.GetOutputDataObject(port)),
                    in_order(point_arrays(serial.GetOutputDataObject(port))))
    assert_same_numbers(together, serial)
    assert (together.GetOutputDataObject(1).GetNumberOfPoints() > 0) == (RANK == LAST)


def test_bad_cloud_of_one_rank_is_an_error_on_all():
    comparison = compared(scan(), producer_of(cloudtools.cloud([(math.nan if RANK == LAST else 1.0, 0, 0)])))
    messages = echotools.Messages(comparison)
    update(comparison)
    assert math.isnan(comparison.GetHausdorffDistance())
    assert bool(messages.errors) == (RANK in (0, LAST)), messages.errors


def test_tracks_are_those_of_one_process():
    """One rank has no points; where the sensor is, says the first that has some."""
    random = np.random.default_rng(7)
    start, velocity = random.uniform(-100, 100, (40, 3)), random.normal(0, 10, (40, 3))
    owner = random.integers(0, RANKS, 40)
    owner[owner == LAST] = 0
    serial, together = al.vtkAvianLidarTracker(), al.vtkAvianLidarTracker()
    serial.SetController(None)
    for time in range(5):
        for tracker, mine in ((serial, np.ones(40, bool)), (together, owner == RANK)):
            data = cloudtools.cloud((start + time * velocity)[mine])
            data.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), float(time))
            if mine.any():
                cloudtools.add_field(data, "position", (5.0, 6.0, 7.0))
            tracker.SetInputData(data)
        serial.Update()
        update(together)
    if RANK == 0:
        assert_same(point_arrays(together.GetOutput(0)), point_arrays(serial.GetOutput(0)))
    assert RANK == 0 or together.GetOutput(0).GetNumberOfCells() == 0
    ids = numpy_support.vtk_to_numpy(serial.GetOutput(1).GetPointData().GetArray("track_id"))[owner == RANK]
    mine = together.GetOutput(1).GetPointData().GetArray("track_id")
    assert (numpy_support.vtk_to_numpy(mine) == ids).all() if len(ids) else mine.GetNumberOfTuples() == 0


def test_image_is_that_of_one_process():
    serial_scan, ranks_scan = scan(), scan()
    for echo in (serial_scan, ranks_scan):
        echo.GetInputAlgorithm(0, 0).SetOrientation(20, 5, -3)
    expected = serial_image(image_of(serial_scan))
    image = update(image_of(ranks_scan))
    assert_same(whole_image(image), expected)
    assert ranks_scan.GetNumberOfTracedRays() == serial_scan.GetNumberOfTracedRays() > 0
    assert total(ranks_scan.GetOutput(1).GetNumberOfPoints()) == 360


def test_nothing_is_traced_again_for_the_image():
    echo = scan()
    executions = []
    echo.AddObserver("EndEvent", lambda *_: executions.append(1))
    image = image_of(echo)
    for algorithm in (echo, image, compared(echo, echo), echo, image):
        update(algorithm)
    assert len(executions) == 1, executions


def test_image_of_a_sweep():
    lidar = echotools.sensor()
    lidar.SetStepsPerRevolution(9)
    echo = echotools.scan(TOWN, lidar, **SETTINGS)
    image = image_of(echo)
    for time in (0.0, 1.0, 1.9):
        image.UpdateInformation()
        image.GetOutputInformation(0).Set(vtk.vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP(), time)
        update(image)
        fired = total(echo.GetOutput(1).GetNumberOfPoints())
        assert (whole_image(image)["status"] >= 0).sum() == fired, (time, fired)


def test_image_of_a_table_of_beams():
    serial = image_of(scan(), producer_of(table(range(360))), 0)
    image = image_of(scan(), producer_of(table(range(RANK, 360, RANKS))), 0)
    for one in (serial, image):
        one.SetColumns(90)
        one.SetRows(4)
    update(image)
    assert_same(whole_image(image), serial_image(serial))
