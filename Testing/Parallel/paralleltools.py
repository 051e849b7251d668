# SPDX-License-Identifier: BSD-3-Clause
"""What the tests on several ranks share. Every rank runs the same script (pvbatch --sym)."""

import ctypes
import os
import sys
import traceback

import numpy as np
import vtk
from vtkmodules.vtkParallelCore import vtkMultiProcessController

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

import cloudtools  # noqa: E402
import echotools  # noqa: E402

CONTROLLER = vtkMultiProcessController.GetGlobalController()
RANK = CONTROLLER.GetLocalProcessId()
RANKS = CONTROLLER.GetNumberOfProcesses()
LAST = RANKS - 1


def main(tests):
    """Run the tests; a failure on one rank ends the job on all, with its traceback."""
    expected = int(sys.argv[1])
    try:
        assert RANKS == expected, f"{RANKS} ranks, expected {expected}"
        for test in tests:
            if RANK == 0:
                print(test.__name__, flush=True)
            test()
            CONTROLLER.Barrier()
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)  # mpiexec ends the others


def tests_of(*modules):
    """Every test of these modules, so that one start of the ranks has many."""
    return [test for module in modules for name, test in vars(module).items() if name.startswith("test_")]


def failing_new():
    """The functions of FailingNew.cxx, if this process has preloaded it."""
    library = ctypes.CDLL(None)
    library.failing_new_begin.argtypes = (ctypes.c_long, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_bool, ctypes.c_int)
    library.failing_new_end.restype = ctypes.c_long
    return library


def update(algorithm):
    """As ParaView does: every rank its own piece. True if all went well."""
    algorithm.UpdatePiece(RANK, RANKS, 0)
    return algorithm


def exchange(text):
    """The texts of all ranks, by rank, on every rank."""
    mine = vtk.vtkPolyData()
    cloudtools.add_field(mine, "text", [text])
    return [part.GetFieldData().GetAbstractArray("text").GetValue(0) for part in collect(mine)]


def collect(data):
    """The data of all ranks, by rank, on every rank."""
    parts = [vtk.vtkPolyData() for _ in range(RANKS)]
    parts[RANK].ShallowCopy(data)
    for sender, part in enumerate(parts):
        CONTROLLER.Broadcast(part, sender)
    return parts


def total(number):
    return sum(float(text) for text in exchange(repr(float(number))))


def joined(data):
    """The point arrays of all ranks as one dictionary, sorted by beam and return, on every rank."""
    columns = {}
    for part in collect(data):
        for name, values in point_arrays(part).items():
            columns.setdefault(name, []).append(values)
    return in_order({name: np.concatenate(values) for name, values in columns.items()}) if columns else {}


def blocks_of(blocks, mine):
    """A multiblock with the blocks that are this rank's; the others are there without data."""
    part = vtk.vtkMultiBlockDataSet()
    name = vtk.vtkCompositeDataSet.NAME()
    for i in range(blocks.GetNumberOfBlocks()):
        part.SetBlock(i, blocks.GetBlock(i) if mine(i) else None)
        part.GetMetaData(i).Set(name, blocks.GetMetaData(i).Get(name))
    return part


def table(ids):
    """Some beams of the sensor as anyone's script would make them."""
    source = echotools.sensor()
    source.Update()
    whole = source.GetOutput()
    beams = cloudtools.cloud([whole.GetPoint(beam) for beam in ids])
    beams.GetPointData().CopyAllocate(whole.GetPointData())
    for i, beam in enumerate(ids):
        beams.GetPointData().CopyData(whole.GetPointData(), beam, i)
    beams.GetFieldData().PassData(whole.GetFieldData())
    return beams


def point_arrays(data):
    """Point arrays and points, without those that are empty."""
    return {name: values for name, values in echotools.arrays(data).items() if len(values)}


def in_order(arrays):
    """By beam and return, or by all that there is."""
    keys = [arrays[name] for name in ("return_number", "beam_id") if name in arrays]
    order = np.lexsort(keys or [column for name in sorted(arrays) for column in np.atleast_2d(arrays[name].T)])
    return {name: values[order] for name, values in arrays.items()}


COSTS = echotools.COSTS


def assert_same(found, expected):
    """The same arrays, bit for bit; costs may differ."""
    echotools.assert_same(found, expected, COSTS)


def field_texts(data, without=()):
    """Field data as text, by name."""
    fields = data.GetFieldData()
    result = {}
    for i in range(fields.GetNumberOfArrays()):
        array = fields.GetAbstractArray(i)
        values = [array.GetVariantValue(k).ToString() for k in range(array.GetNumberOfValues())]
        if array.GetName() not in without:
            result[array.GetName()] = values
    return result
