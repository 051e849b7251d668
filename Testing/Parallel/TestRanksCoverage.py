# SPDX-License-Identifier: BSD-3-Clause
"""Several ranks together compute the coverage of one process: places, table, clutter. An error on one rank is an error
on all. TestRanks runs these tests."""

import numpy as np
import vtk
from vtk.util import numpy_support

from paralleltools import CONTROLLER, LAST, RANK, RANKS, blocks_of, collect, exchange, update
import cloudtools
import echotools
from avianlidar import vtkAvianLidar as al

TOWN = echotools.town(3, 24)


def cover(surfaces, places=None, controller=CONTROLLER):
    filter_ = al.vtkAvianLidarCoverage()
    filter_.SetController(controller)
    beams = al.vtkAvianLidarBeamSource()
    beams.SetPresetToSearch905()
    echotools.given(beams, AzimuthRange=(0.0, 90.0), AzimuthStep=0.5, Position=(0.0, 0.0, 2.0))
    filter_.SetInputConnection(0, beams.GetOutputPort())
    filter_.SetInputData(1, surfaces)
    echotools.given(filter_, NumberOfThreads=1, Bounds=(0.0, 400.0, 0.0, 400.0, 0.0, 40.0), Spacing=(40.0, 40.0, 10.0),
                    Species="", EffectiveArea=0.003)  # m2: quicker than birds
    if places is not None:
        filter_.SetInputData(2, places)
    return filter_


def rows_of(filter_):
    table = filter_.GetOutputDataObject(1)
    return [[table.GetValue(row, column).ToString() if column < 2 else table.GetValue(row, column).ToDouble()
             for column in range(table.GetNumberOfColumns())] for row in range(table.GetNumberOfRows())]


def same_table(mine, alone):
    """The rows of rank 0, on all; the others have none."""
    rows = [eval(text, {"nan": np.nan, "inf": np.inf}) for text in exchange(repr(rows_of(mine)))]
    assert all(not r for r in rows[1:]), rows
    wanted = rows_of(alone)
    assert len(rows[0]) == len(wanted) > 3, (rows[0], wanted)
    for found, row in zip(rows[0], wanted):
        assert found[:2] == row[:2], (found, row)
        np.testing.assert_allclose(found[2:], row[2:], rtol=1e-9)


def test_image():
    alone = cover(TOWN, controller=None)
    alone.Update()
    wanted = numpy_support.vtk_to_numpy(alone.GetOutputDataObject(0).GetPointData().GetArray("detection_probability"))
    wanted = wanted.reshape(5, 11, 11)
    mine = update(cover(blocks_of(TOWN, lambda i: i % RANKS == RANK)))
    data = mine.GetOutputDataObject(0)
    x0, x1, y0, y1, z0, z1 = data.GetExtent()
    values = numpy_support.vtk_to_numpy(data.GetPointData().GetArray("detection_probability"))
    assert np.count_nonzero((wanted > 0.0) & (wanted < 1.0)) > 20
    assert np.array_equal(values.reshape(z1 - z0 + 1, y1 - y0 + 1, x1 - x0 + 1),
                          wanted[z0:z1 + 1, y0:y1 + 1, x0:x1 + 1])
    same_table(mine, alone)
    clutter = sum(part.GetNumberOfPoints() for part in collect(mine.GetOutputDataObject(2)))
    assert clutter == alone.GetOutputDataObject(2).GetNumberOfPoints() > 0, clutter
    for one in (mine, alone):
        one.SetEffectiveArea(0.01)
    update(mine)
    alone.Update()
    assert mine.GetNumberOfTracedPlaces() == mine.GetNumberOfTracedRays() == 0  # nothing is traced again
    same_table(mine, alone)


def points_of(numbers):
    """Places, each in a region; ranks know regions that others do not."""
    i = np.array(numbers)
    data = cloudtools.cloud(np.column_stack([10.0 + 3.0 * (i % 97), 15.0 + 2.0 * (i % 131), 1.0 + i % 30]))
    cloudtools.add_array(data, "region_id", (i * 4 // 100).astype(np.int32))
    return data


def test_points():
    alone = cover(TOWN, points_of(range(100)), controller=None)
    alone.Update()
    first, end = 100 * RANK // RANKS, 100 * (RANK + 1) // RANKS
    mine = update(cover(TOWN if RANK == 0 else vtk.vtkMultiBlockDataSet(), points_of(range(first, end))))
    wanted = numpy_support.vtk_to_numpy(alone.GetOutputDataObject(0).GetPointData().GetArray("status"))[first:end]
    found = numpy_support.vtk_to_numpy(mine.GetOutputDataObject(0).GetPointData().GetArray("status"))
    assert np.array_equal(found, wanted)
    same_table(mine, alone)


def test_error_of_one_is_one_of_all():
    places = points_of(range(10))
    if RANK == LAST:
        places.GetPointData().GetArray("region_id").SetNumberOfTuples(3)
    filter_ = cover(TOWN, places)
    errors = echotools.Messages(filter_).errors
    update(filter_)
    assert filter_.GetOutputDataObject(0).GetNumberOfPoints() == 0
    assert bool(errors) == (RANK in (0, LAST)), errors
    filter_.SetInputData(2, points_of(range(10)))
    update(filter_)
    assert filter_.GetOutputDataObject(0).GetNumberOfPoints() == 10


def test_places_and_settings_are_those_of_all():
    """Places on one rank alone, and settings that differ, are not mixed: an error on all, and the next good ones
    work."""
    cases = [("Input port 2 (places) is", lambda one: one.SetInputData(2, points_of(range(10))),
              lambda one: one.RemoveAllInputConnections(2))]
    for name, bad, good in (("Bounds", (0.0, 300.0, 0.0, 400.0, 0.0, 40.0), (0.0, 400.0, 0.0, 400.0, 0.0, 40.0)),
                            ("Spacing", (20.0, 40.0, 10.0), (40.0, 40.0, 10.0)), ("Species", ("starling",), ("",)),
                            ("NumberOfScans", (4,), (3,)), ("Seed", (3,), (0,))):
        cases.append((name, *(lambda one, name="Set" + name, values=values: getattr(one, name)(*values)
                              for values in (bad, good))))
    filter_ = cover(TOWN)
    messages = echotools.Messages(filter_)
    for words, spoil, mend in cases:
        if RANK == LAST:
            spoil(filter_)
        filter_.Modified()
        update(filter_)
        assert filter_.GetOutputDataObject(1).GetNumberOfRows() == 0, words
        heard = exchange("\n".join(messages.errors))
        assert all("expected the same on all ranks" in text for text in heard) and words in heard[0], (words, heard)
        messages.errors.clear()
        if RANK == LAST:
            mend(filter_)
        filter_.Modified()
        update(filter_)
        assert not any(exchange("".join(messages.errors))), (words, messages.errors)
        assert RANK > 0 or filter_.GetOutputDataObject(1).GetNumberOfRows() > 3, words
