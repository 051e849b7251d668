#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What it costs to share a scene between MPI ranks, to trace and to gather.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Testing/Benchmarks/ranks.py --page

starts itself under `pvbatch --sym` on 1 and 2 ranks of one thread each, in turns, and prints tables;
--page brings the tables into Documentation/guide/parallel.md. Times are the least of all rounds: whatever else the
machine does only adds to them. Tracing, and the constant of merging and building, are processor time, all else wall
time. The page says how many rounds there were, and the load before each of them.
"""
import argparse
import contextlib
import json
import math
import os
import pathlib
import subprocess
import sys
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import results  # noqa: E402

AIRPORT = HERE.parents[1] / "Examples" / "airport" / "scene" / "hongqiao.lidarscene.json"
SCENES = ("airport", "terrain")


# ---------------------------------------------------------------------------------------------------------------------
# On each rank.

def surfaces_of(name):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersSources import vtkPlaneSource
    from avianlidar.vtkAvianLidar import vtkAvianLidarMaterial, vtkAvianLidarSceneReader
    if name == "airport":
        made = vtkAvianLidarSceneReader()
        made.SetFileName(str(AIRPORT))
    else:
        plane = vtkPlaneSource()  # 4 km of hills around the lidar, of 240 x 240 cells
        plane.SetOrigin(-2000, -2000, -5)
        plane.SetPoint1(2000, -2000, -5)
        plane.SetPoint2(-2000, 2000, -5)
        plane.SetResolution(240, 240)
        plane.SetOutputPointsPrecision(1)
        plane.Update()
        points = vtk_to_numpy(plane.GetOutput().GetPoints().GetData())
        x, y, _ = points.T
        points[:, 2] += 30 * np.minimum(1, np.hypot(x, y) / 400) * (1 + np.sin(x / 97) * np.cos(y / 71))
        made = vtkAvianLidarMaterial()
        made.SetInputData(plane.GetOutput())
    made.Update()
    return made.GetOutput()


@contextlib.contextmanager
def alone():
    """Filters that run in here take this process for the only one."""
    from vtkmodules.vtkParallelCore import vtkDummyController, vtkMultiProcessController
    before = vtkMultiProcessController.GetGlobalController()
    vtkMultiProcessController.SetGlobalController(vtkDummyController())
    yield
    vtkMultiProcessController.SetGlobalController(before)


def pipeline(surfaces, own):
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter
    tree = vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces if own else vtkPolyData())
    sensor = vtkAvianLidarBeamSource()
    sensor.SetPresetToAirport32()
    sensor.SetPosition(0, 0, 3)
    echo = vtkAvianLidarEchoFilter()
    echo.SetInputConnection(0, sensor.GetOutputPort())
    echo.SetSurfacesConnection(tree.GetOutputPort())
    echo.SetNumberOfThreads(1)
    echo.SetMaximumCacheSize(0)  # every scan is a first one
    return tree, echo


def timed(work):
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def work_of_rank(scene):
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkParallelCore import vtkMultiProcessController
    controller = vtkMultiProcessController.GetGlobalController()
    rank, ranks = controller.GetLocalProcessId(), controller.GetNumberOfProcesses()
    surfaces = surfaces_of(scene)
    found = {}

    def least(name, seconds):
        found[name] = min(found.get(name, math.inf), seconds)

    for _ in range(8):
        tree, echo = pipeline(surfaces, rank == 0)
        controller.Barrier()
        least("share", timed(lambda: tree.UpdatePiece(rank, ranks, 0)))
        with alone():
            own = pipeline(surfaces, True)[0]
            least("merge and build", timed(own.Update))
            found["triangles"] = own.GetOutput().GetNumberOfCells()
    echo.UpdatePiece(rank, ranks, 0)
    for _ in range(3):
        controller.Barrier()
        echo.SetSeed(echo.GetSeed() + 1)
        least("scan", timed(lambda: echo.UpdatePiece(rank, ranks, 0)))

    def gather():
        if rank:
            controller.Send(echo.GetOutput(), 0, 77)
        for other in range(1, ranks if rank == 0 else 0):
            controller.Receive(vtkPolyData(), other, 77)
    for _ in range(5):
        controller.Barrier()
        least("gather", timed(gather))
    with alone():  # the processor time of tracing, without the others
        echo = pipeline(surfaces, True)[1]
        echo.UpdatePiece(rank, ranks, 0)
        for _ in range(3):
            echo.SetSeed(echo.GetSeed() + 1)
            begin = time.process_time()
            echo.UpdatePiece(rank, ranks, 0)
            least("trace", time.process_time() - begin)
    return rank, found


# ---------------------------------------------------------------------------------------------------------------------
# Outside.

def run(ranks, scene, out):
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe", OMPI_MCA_plm="isolated", OMP_NUM_THREADS="1",
                       OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_MCA_mpi_yield_when_idle="1")
    subprocess.run(["mpiexec", "-n", str(ranks), "pvbatch", "--sym", str(pathlib.Path(__file__).resolve()), "--rank", scene,
                    "--out", str(out)], check=True, env=environment)
    return [json.loads((out / f"rank{rank}.json").read_text()) for rank in range(ranks)]


def measure(out, rounds):
    best, loads = {}, []
    for _ in range(rounds):
        loads.append(os.getloadavg()[0])
        for scene in SCENES:
            for ranks in (1, 2):
                found = run(ranks, scene, out)
                best[scene, ranks] = [least_of(*pair) for pair in zip(best.get((scene, ranks), found), found)]
    return best, loads


def least_of(one, other):
    """Times are the least of all rounds, all else is of the last."""
    return {name: value if name == "triangles" else min(one[name], value) for name, value in other.items()}


def times_table(best):
    rows = []
    for (scene, ranks), found in best.items():
        serial = best[scene, 1][0]["trace"]
        ms = {name: 1e3 * max(rank[name] for rank in found)
              for name in ("merge and build", "share", "trace", "scan", "gather")}
        rows.append([scene, f"{found[0]['triangles']:,}", ranks, f"{ms['merge and build']:.1f}", f"{ms['share']:.1f}",
                     f"{ms['trace']:.0f}", f"{1e3 * serial / ms['trace']:.2f}", f"{ms['scan']:.0f}", f"{ms['gather']:.1f}"])
    return results.table(["scene", "triangles", "ranks", "merge and build alone, ms", "share and build, ms",
                          "trace, dearest rank, ms", "speed-up", "scan together, ms", "gather, ms"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/ranks"), help="folder for results")
    parser.add_argument("--rounds", type=int, default=3, help="each in processes of their own")
    parser.add_argument("--page", action="store_true", help="bring the tables into the page")
    parser.add_argument("--rank", help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    if options.rank:
        rank, found = work_of_rank(options.rank)
        (options.out / f"rank{rank}.json").write_text(json.dumps(found))
        return
    best, loads = measure(options.out.resolve(), options.rounds)
    machine = [*results.machine(), ("rounds", len(loads)), ("load before each", ", ".join(f"{load:.1f}" for load in loads))]
    tables = {"machine": results.table(["machine", ""], machine, words=True), "ranks-times": times_table(best)}
    print(*tables.values(), sep="\n")
    if options.page:
        results.put_into_pages(tables)


if __name__ == "__main__":
    main()
