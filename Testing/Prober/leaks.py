# SPDX-License-Identifier: BSD-3-Clause
"""A pipeline that is executed again and again holds no more memory, as the C library counts it."""

import ctypes
import gc
import random
import sys

import vtk

from pipeline import SINKS
from steps import World

MALLINFO = type("mallinfo2", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_size_t) for name in (
    "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")]})
ROUNDS, MOST = 15, 1000  # bytes an execution: of a filter without a leak less than 400, an empty polydata alone more than 1,000


def in_use():
    gc.collect()
    said = ctypes.CDLL(None).mallinfo2
    said.restype = MALLINFO
    return said().uordblks + said().hblkhd


def growth(pipeline, sink, moment):
    """Bytes an execution."""
    for number in range(2 * ROUNDS):
        if number == ROUNDS:
            before = in_use()
        pipeline.algorithms[sink[0]].Modified()
        pipeline.update(sink, moment)
    return (in_use() - before) / ROUNDS


world = World(random.Random(sys.argv[-1]))
pipeline = world.fresh()
pipeline.set("geodetic", "UseFieldDataOrigin", 0)
found = {name: growth(pipeline, (name, port), world.moment) for name, port in SINKS if port == 0}
blocks = vtk.vtkMultiBlockDataGroupFilter()
blocks.AddInputConnection(pipeline.algorithms["echo"].GetOutputPort())
pipeline.algorithms["geodetic"].SetInputConnection(0, blocks.GetOutputPort())
found["geodetic, in blocks"] = growth(pipeline, ("geodetic", 0), world.moment)
print(*(f"{name}: {bytes_:.0f} bytes an execution" for name, bytes_ in found.items()), sep="\n")
assert not pipeline.heard, pipeline.heard
sys.exit(f"more than {MOST} bytes" if max(found.values()) > MOST else 0)
