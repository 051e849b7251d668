# SPDX-License-Identifier: BSD-3-Clause
"""Part of cliffs.py: memory of a scene with its collision tree, and the time that building takes.

Bytes are those that malloc() hands out while a scene file is read and its tree is built, per triangle. A new process
measures each scene. It has read the file once before, so that memory that libraries keep for the process, such as
PROJ's for its database, is not counted as memory of triangles. The time of a build is its processor time with one
thread over that of Embree's builder of medium quality, if the program avianlidarBenchmarks was built
(AVIANLIDAR_BENCHMARKS names it; default: build/paraview/bin/avianlidarBenchmarks). The time of the tree's whole filter
is over that of building a vtkStaticCellLocator of the same triangles."""
import csv
import ctypes
import os
import pathlib
import subprocess
import sys
import tempfile

from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

from avianlidar import vtkAvianLidar
from cliffs import Row, interleaved

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = pathlib.Path(os.environ.get("AVIANLIDAR_SCENES_DIR") or ROOT / "build" / "paraview" / "Testing" / "Scenes")
PROGRAM = pathlib.Path(os.environ.get("AVIANLIDAR_BENCHMARKS") or ROOT / "build/paraview/bin/avianlidarBenchmarks")
PLACES = {"zsss_structures": "Hongqiao with structures", "phnl": "Honolulu", "neubrandenburg": "Neubrandenburg"}
HELD, BUILD = 160.0, 1.3  # aims: bytes per triangle, and times Embree's time


class Heap(ctypes.Structure):
    """struct mallinfo2 of the C library."""
    _fields_ = [(name, ctypes.c_size_t) for name in (
        "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")]


def held():
    """Bytes that malloc() has handed out."""
    library = ctypes.CDLL(None)
    library.mallinfo2.restype = Heap
    heap = library.mallinfo2()
    return heap.uordblks + heap.hblkhd


def reader_of(file):
    reader = vtkAvianLidar.vtkAvianLidarSceneReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader


def tree_of(surfaces):
    tree = vtkAvianLidar.vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces)
    tree.Update()
    return tree


def measure(file):
    """Prints the bytes per triangle of the surfaces as read, and of what the tree's filter adds."""
    reader_of(file)
    start = held()
    reader = reader_of(file)
    surfaces = held()
    tree = tree_of(reader.GetOutput())
    count = tree.GetOutput().GetNumberOfPolys()
    print((surfaces - start) / count, (held() - surfaces) / count)


def against_embree(short):
    """Rows of the program's suite of builds, with one thread."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([PROGRAM, "build", folder] + ["--short"] * short, check=True, stdout=subprocess.DEVNULL)
        with open(pathlib.Path(folder) / "build.csv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row["threads"] == "1":
                    yield Row("tree", f"build over Embree's, {row['scene']}, {row['triangles']} triangles",
                              1.0 / float(row["ratio"]), "", BUILD)


def against_locator(file, what, rounds):
    """A row of the time of the tree's filter, which merges and sorts the surfaces, too."""
    surfaces = reader_of(file).GetOutput()
    triangles = tree_of(surfaces).GetOutput()

    def locator():
        one = vtkStaticCellLocator()
        one.SetDataSet(triangles)
        one.BuildLocator()
    times = interleaved({"tree": lambda: tree_of(surfaces), "locator": locator}, rounds)
    yield Row("tree", f"filter of the tree over vtkStaticCellLocator, {what}", times["tree"] / times["locator"], "")


def rows(short):
    if os.environ.get("AVIANLIDAR_DATA_DIR"):
        for name, what in PLACES.items():
            file = SCENES / (name + ".lidarscene.json")
            result = subprocess.run([sys.executable, __file__, str(file)], check=True, capture_output=True, text=True)
            surfaces, tree = map(float, result.stdout.split())
            yield Row("tree", f"held per triangle, surfaces and tree, {what}", surfaces + tree, "B", HELD)
            yield Row("tree", f"held per triangle, of these by the surfaces as read, {what}", surfaces, "B")
            yield from against_locator(file, what, 3 if short else 9)
    if PROGRAM.exists():
        yield from against_embree(short)


if __name__ == "__main__":
    measure(sys.argv[1])
