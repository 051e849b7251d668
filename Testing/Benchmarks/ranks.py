#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The table of Documentation/guide/parallel.md: times of tracing and of whole scans on MPI ranks.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Testing/Benchmarks/ranks.py

starts itself under `pvbatch --sym` on 1 and 2 ranks of one thread each, in turns, and prints the table, the machine, and
the load before each round. Times are the least of all rounds: whatever else the machine does only adds to them. Tracing is
processor time, whole scans are wall time.
"""
import argparse
import contextlib
import json
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


def work_of_rank(scene):
    from vtkmodules.vtkParallelCore import vtkMultiProcessController
    controller = vtkMultiProcessController.GetGlobalController()
    rank, ranks = controller.GetLocalProcessId(), controller.GetNumberOfProcesses()
    surfaces = surfaces_of(scene)

    def least(clock, echo):
        """Time of a scan of which nothing is known."""
        echo.UpdatePiece(rank, ranks, 0)
        seconds = []
        for _ in range(3):
            controller.Barrier()
            echo.SetSeed(echo.GetSeed() + 1)
            begin = clock()
            echo.UpdatePiece(rank, ranks, 0)
            seconds.append(clock() - begin)
        return min(seconds)

    tree, echo = pipeline(surfaces, rank == 0)
    found = {"scan": least(time.perf_counter, echo), "triangles": tree.GetOutput().GetNumberOfCells()}
    with alone():  # the processor time of tracing, without the others
        found["trace"] = least(time.process_time, pipeline(surfaces, True)[1])
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
    return {name: min(one[name], value) for name, value in other.items()}


def times_table(best):
    rows = []
    for (scene, ranks), found in best.items():
        trace, scan = (1e3 * max(rank[name] for rank in found) for name in ("trace", "scan"))
        speedup = 1e3 * best[scene, 1][0]["trace"] / trace
        rows.append([scene, f"{found[0]['triangles']:,}", ranks, f"{trace:.0f}", f"{speedup:.2f}", f"{scan:.0f}"])
    return results.table(["scene", "triangles", "ranks", "tracing, ms", "speed-up", "whole scan, ms"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/ranks"), help="folder for results")
    parser.add_argument("--rounds", type=int, default=3, help="each in processes of their own")
    parser.add_argument("--rank", help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    if options.rank:
        rank, found = work_of_rank(options.rank)
        (options.out / f"rank{rank}.json").write_text(json.dumps(found))
        return
    best, loads = measure(options.out.resolve(), options.rounds)
    print(times_table(best), results.table(["machine", ""], results.machine(), words=True), f"load before each round: {loads}", sep="\n")


if __name__ == "__main__":
    main()
