#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What it costs to share a scene between MPI ranks, to trace and to gather, and what follows for 1000 ranks.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Testing/Benchmarks/ranks.py --page

starts itself under `pvbatch --sym` on 1 and 2 ranks of one thread each, in turns, and leaves results.json in --out;
--page brings the tables into Documentation/results/parallel.md. Times are the least of all rounds: whatever else the
machine does only adds to them. Tracing, and the constant of merging and building, are processor time, all else wall
time. The page says how many rounds there were, and the load before each of them.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
SCENES = {"airport": None, "terrain": 240}  # cells on a side of the terrain, of two triangles each
PIECES = (8, 128)


# ---------------------------------------------------------------------------------------------------------------------
# On each rank.

def surfaces_of(name):
    from vtkmodules.vtkFiltersSources import vtkPlaneSource
    from avianlidar.vtkAvianLidar import vtkAvianLidarMaterial, vtkAvianLidarSceneReader
    if name == "airport":
        reader = vtkAvianLidarSceneReader()
        reader.SetFileName(str(SOURCE / "Examples" / "airport" / "scene" / "hongqiao.lidarscene.json"))
        reader.Update()
        return reader.GetOutput()
    cells = SCENES[name]
    plane = vtkPlaneSource()  # 4 km of hills around the lidar
    plane.SetOrigin(-2000, -2000, -5)
    plane.SetPoint1(2000, -2000, -5)
    plane.SetPoint2(-2000, 2000, -5)
    plane.SetResolution(cells, cells)
    plane.SetOutputPointsPrecision(1)
    plane.Update()
    hills = plane.GetOutput()
    points = hills.GetPoints()
    for i in range(points.GetNumberOfPoints()):
        x, y, z = points.GetPoint(i)
        far = math.hypot(x, y) / 2000
        points.SetPoint(i, x, y, z + 30 * min(1, 5 * far) * (1 + math.sin(x / 97) * math.cos(y / 71)))
    paint = vtkAvianLidarMaterial()
    paint.SetInputData(hills)
    paint.Update()
    return paint.GetOutput()


class Alone:
    """Filters that run in here take this process for the only one."""

    def __enter__(self):
        from vtkmodules.vtkParallelCore import vtkDummyController, vtkMultiProcessController
        self.before = vtkMultiProcessController.GetGlobalController()
        vtkMultiProcessController.SetGlobalController(vtkDummyController())

    def __exit__(self, *_):
        from vtkmodules.vtkParallelCore import vtkMultiProcessController
        vtkMultiProcessController.SetGlobalController(self.before)


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
    return tree, sensor, echo


def timed(work):
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def memory():
    with open("/proc/self/status", encoding="ascii") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmRSS"))


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
        before = memory()
        tree, sensor, echo = pipeline(surfaces, rank == 0)
        controller.Barrier()
        least("share", timed(lambda: tree.UpdatePiece(rank, ranks, 0)))
        found["memory"] = max(found.get("memory", 0), memory() - before)
        found["sent"] = tree.GetNumberOfBytesSent()
        with Alone():
            alone = pipeline(surfaces, True)[0]
            begin = time.process_time()
            least("merge and build", timed(alone.Update))
            least("processor for it", time.process_time() - begin)
            found["triangles"] = alone.GetOutput().GetNumberOfCells()
    echo.UpdatePiece(rank, ranks, 0)
    for _ in range(3):
        controller.Barrier()
        echo.SetSeed(echo.GetSeed() + 1)
        least("scan", timed(lambda: echo.UpdatePiece(rank, ranks, 0)))
    found["sent again"] = echo.GetNumberOfBytesSent()
    found["beams"] = sensor.GetOutput().GetNumberOfPoints()
    found["echoes"] = echo.GetOutput().GetNumberOfPoints()
    found["echo bytes"] = 1024 * echo.GetOutput().GetActualMemorySize()

    def gather():
        if rank:
            controller.Send(echo.GetOutput(), 0, 77)
        for other in range(1, ranks if rank == 0 else 0):
            controller.Receive(vtkPolyData(), other, 77)
    for _ in range(5):
        controller.Barrier()
        least("gather", timed(gather))
    with Alone():  # the processor time of tracing, without the others
        echo = pipeline(surfaces, True)[2]
        echo.UpdatePiece(rank, ranks, 0)
        for _ in range(3):
            echo.SetSeed(echo.GetSeed() + 1)
            begin = time.process_time()
            echo.UpdatePiece(rank, ranks, 0)
            least("trace", time.process_time() - begin)
    if ranks == 1:
        with Alone():
            found["pieces"] = {str(pieces): imbalance(surfaces, pieces) for pieces in PIECES}
    found["peak"] = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return rank, found


def imbalance(surfaces, pieces):
    """The dearest of so many pieces of the beams against the mean."""
    _, _, echo = pipeline(surfaces, True)
    costs = []
    for piece in range(pieces):
        echo.UpdatePiece(piece, pieces, 0)  # makes what all pieces share
        echo.SetSeed(echo.GetSeed() + 1)
        begin = time.process_time()
        echo.UpdatePiece(piece, pieces, 0)
        costs.append(time.process_time() - begin)
    return max(costs) * pieces / sum(costs)


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
                key = f"{scene} {ranks}"
                best[key] = [least_of(a, b) for a, b in zip(best.get(key, found), found)]
    return best, loads


def least_of(one, other):
    """Times are the least of all rounds, all else is of the last."""
    times = ("share", "scan", "gather", "merge and build", "processor for it", "trace")
    result = {name: min(one[name], value) if name in times else value for name, value in other.items()}
    if "pieces" in one:
        result["pieces"] = {n: min(one["pieces"][n], value) for n, value in other["pieces"].items()}
    return result


def of_all(best, scene, ranks, name):
    return [rank[name] for rank in best[f"{scene} {ranks}"]]


def times_table(best):
    lines = ["| scene | triangles | ranks | merge and build alone, ms | share and build, ms | trace, dearest rank, ms | "
             "speed-up | scan together, ms | gather, ms |", "|---|---:|---:|---:|---:|---:|---:|---:|---:|"]
    for scene in SCENES:
        serial = max(of_all(best, scene, 1, "trace"))
        for ranks in (1, 2):
            def ms(name):
                return 1e3 * max(of_all(best, scene, ranks, name))
            lines.append(f"| {scene} | {best[f'{scene} {ranks}'][0]['triangles']:,} | {ranks} | {ms('merge and build'):.1f} | "
                         f"{ms('share'):.1f} | {ms('trace'):.0f} | {1e3 * serial / ms('trace'):.2f} | {ms('scan'):.0f} | "
                         f"{ms('gather'):.1f} |")
    return lines


def constants(best):
    result = {}
    for scene in SCENES:
        one, two = best[f"{scene} 1"][0], best[f"{scene} 2"]
        triangles = one["triangles"]
        result[scene] = {
            "bytes sent a triangle": two[0]["sent"] / triangles,
            "bytes sent again": sum(rank["sent again"] for rank in two),
            "merge and build, ns a triangle": 1e9 * one["processor for it"] / triangles,
            "share, ns a triangle beyond that": 1e9 * max(
                0.0, max(rank["share"] for rank in two) - max(rank["merge and build"] for rank in two)) / triangles,
            "beams a second and core": one["beams"] / one["trace"],
            "bytes an echo": one["echo bytes"] / max(1, one["echoes"]),
            "echoes a beam": one["echoes"] / one["beams"],
            "memory, bytes a triangle": max(rank["memory"] for rank in two) / triangles,
            **{f"dearest of {n} pieces against the mean": value for n, value in one["pieces"].items()}}
    return result


def constants_table(found):
    lines = ["| constant | " + " | ".join(found) + " |", "|---|" + "---:|" * len(found)]
    for name in next(iter(found.values())):
        lines.append(f"| {name} | " + " | ".join(f"{column[name]:,.4g}" if column[name] < 1e4 else f"{column[name]:,.0f}"
                                                 for column in found.values()) + " |")
    return lines


def model(c, triangles, beams, ranks, bandwidth=10e9 / 8, latency=5e-6):
    """Seconds to share, trace and gather; see the page."""
    steps = math.ceil(math.log2(ranks)) if ranks > 1 else 0
    chunk = 2**20
    agree = 16 * steps * latency
    sent = c["bytes sent a triangle"] * triangles if ranks > 1 else 0
    share = sent / bandwidth + steps * (latency + min(chunk, sent) / bandwidth)
    build = 1e-9 * (c["merge and build, ns a triangle"] + (c["share, ns a triangle beyond that"] if ranks > 1 else 0)) * triangles
    uneven = c["dearest of 128 pieces against the mean"] if ranks > 1 else 1.0
    trace = uneven * beams / (ranks * c["beams a second and core"])
    gather = beams * c["echoes a beam"] * c["bytes an echo"] / bandwidth if ranks > 1 else 0
    return build + share, trace + agree, gather


def model_table(c):
    lines = ["| triangles | beams | ranks | share and build, s | trace, s | gather, s | speed-up of a first scan | of a next one |",
             "|---:|---:|---:|---:|---:|---:|---:|---:|"]
    for triangles, beams in ((1e6, 1e7), (1e7, 1e9)):
        alone = model(c, triangles, beams, 1)
        for ranks in (1, 10, 100, 1000):
            share, trace, gather = model(c, triangles, beams, ranks)
            first = sum(alone) / (share + trace + gather)
            later = sum(alone[1:]) / (trace + gather)
            lines.append(f"| {triangles:.0e} | {beams:.0e} | {ranks} | {share:.2f} | {trace:.4g} | {gather:.2f} | "
                         f"{first:.0f} | {later:.0f} |")
    return lines


def machine_table(loads):
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        name = next(line.split(":")[1].strip() for line in info if line.startswith("model name"))
    return ["| machine | |", "|---|---|", f"| processor | {name} |", f"| cores | {os.cpu_count()} |",
            f"| rounds | {len(loads)} |", f"| load before each | {', '.join(f'{load:.1f}' for load in loads)} |", "| MPI | Open MPI 4.1, shared memory |",
            f"| date | {time.strftime('%Y-%m-%d')} |"]


def bring_into_page(tables):
    page = SOURCE / "Documentation" / "results" / "parallel.md"
    text = page.read_text(encoding="utf-8")
    for name, lines in tables.items():
        head, rest = text.split(f"<!-- table: {name} -->\n")
        text = head + f"<!-- table: {name} -->\n" + "\n".join(lines) + "\n<!-- end -->" + rest.split("<!-- end -->", 1)[1]
    page.write_text(text, encoding="utf-8")


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
    found = constants(best)
    (options.out / "results.json").write_text(json.dumps({"best": best, "loads": loads, "constants": found}, indent=1))
    tables = {"machine": machine_table(loads), "times": times_table(best), "constants": constants_table(found),
              "model": model_table({**found["terrain"], **{name: found["airport"][name]
                                                           for name in ("echoes a beam", "bytes an echo")}})}
    for lines in tables.values():
        print("\n".join(lines), end="\n\n")
    if options.page:
        bring_into_page(tables)


if __name__ == "__main__":
    main()
