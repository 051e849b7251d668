# SPDX-License-Identifier: BSD-3-Clause
"""Visits of the collision tree that several ranks count together are those that one counts alone, wherever the surfaces
are; rank 0 shows them; what is wrong with the beams of one rank is an error on all."""

import numpy as np
import vtk

from paralleltools import LAST, RANK, RANKS, collect, main, update
import echotools
from avianlidar import vtkAvianLidar as al
from vtk.util import numpy_support

TOWN = echotools.town(3, 24)


def tree_of(surfaces):
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces)
    tree.SetBoundingVolumeToSphere()
    return tree


def visits_of(surfaces, beams=None):
    visits = al.vtkAvianLidarTreeVisits()
    visits.SetDisplayLevel(4)
    for port, source in ((0, beams or echotools.sensor()), (1, surfaces)):
        if source.IsA("vtkAlgorithm"):
            visits.SetInputConnection(port, source.GetOutputPort())
        else:
            visits.SetInputData(port, source)
    return visits


def cells(data):
    arrays = data.GetCellData()
    return {arrays.GetArrayName(i): numpy_support.vtk_to_numpy(arrays.GetArray(i)).copy()
            for i in range(arrays.GetNumberOfArrays())}


def alone(surfaces):
    """The visits of one process: as one piece nothing is exchanged."""
    visits = visits_of(surfaces)
    visits.Update()
    return cells(visits.GetOutput())


def check(visits, expected):
    parts = [cells(part) for part in collect(update(visits).GetOutput())]
    for name, values in expected.items():
        np.testing.assert_array_equal(parts[0][name], values, name)
    assert not any(len(values) for part in parts[1:] for values in part.values())
    assert expected["visits"].max() > 0


def test_everybody_has_all():
    check(visits_of(tree_of(TOWN)), alone(tree_of(TOWN)))
    check(visits_of(TOWN), alone(TOWN))


def test_one_rank_has_all():
    mine = TOWN if RANK == LAST else vtk.vtkMultiBlockDataSet()
    check(visits_of(tree_of(mine)), alone(tree_of(TOWN)))
    check(visits_of(mine), alone(TOWN))


def test_one_rank_has_bad_beams():
    beams = echotools.sensor()
    beams.UpdatePiece(RANK, RANKS, 0)
    data = vtk.vtkPolyData()
    data.DeepCopy(beams.GetOutput())
    if RANK == LAST:
        data.GetPointData().RemoveArray("direction")
    visits = visits_of(TOWN, data)
    heard = echotools.Messages(visits)
    update(visits)
    assert visits.GetOutput().GetNumberOfCells() == 0
    if RANK in (0, LAST):
        assert len(heard.errors) == 1 and "'direction'" in heard.errors[0], heard.errors
        assert RANK == LAST or f"Rank {LAST}: " in heard.errors[0], heard.errors


if __name__ == "__main__":
    main([test_everybody_has_all, test_one_rank_has_all] + [test_one_rank_has_bad_beams] * (RANKS > 1))
