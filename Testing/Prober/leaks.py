# SPDX-License-Identifier: BSD-3-Clause
"""Memory leaks: a filter that is executed again and again must not hold more and more memory, as counted by the C
library."""

import ctypes
import gc
import random
import sys

import vtk

from pipeline import SINKS
from steps import World

MALLINFO = type("mallinfo2", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_size_t) for name in (
    "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")]})
# MOST in bytes per execution: filters without a leak stay below 400, one polydata that leaks takes more than 1,000
ROUNDS, MOST = 15, 1000


def in_use():
    gc.collect()
    said = ctypes.CDLL(None).mallinfo2
    said.restype = MALLINFO
    return said().uordblks + said().hblkhd


def growth(pipeline, sink, moment):
    """Growth of the memory in use, in bytes per execution."""
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
