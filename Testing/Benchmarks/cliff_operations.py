# SPDX-License-Identifier: BSD-3-Clause
"""Part of cliffs.py: whole commands, each in a process of its own. The range of gulls for all lidars on sale, and the
report of gulls for the example airport: processor time of all threads, peak memory, and wall time by two threads over
wall time by one, which other work on the machine makes larger. Scans of a labelled sequence, the scan of a scene with
many models, and an airport, which needs AVIANLIDAR_DATA_DIR. With --short, only the ranges of two lidars, without an
aim."""
import bz2
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

from avianlidar.apps.inputs._on_sale import on_sale
from cliffs import Row

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "Examples"
PLAN, SCENARIO = EXAMPLES / "coverage" / "gulls.coverage.json", EXAMPLES / "sequence" / "hongqiao.scenario.json"
MODELS = 5221  # number of models, each in a file of its own
SCANS = 20
FEW = ("VLP16", "OS1_64")  # lidars of --short


class Run(NamedTuple):
    wall: float       # s
    processor: float  # s, of all threads
    memory: float     # greatest resident memory, MB


def run(*words) -> Run:
    """Runs the command with these words. RuntimeError with its last lines if it fails."""
    with tempfile.TemporaryFile() as said:
        start = time.monotonic()
        child = subprocess.Popen([sys.executable, "-m", "avianlidar", *map(str, words)], stdout=said, stderr=said)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            said.seek(0)
            raise RuntimeError(said.read().decode()[-1000:])
        return Run(time.monotonic() - start, used.ru_utime + used.ru_stime, 1024e-6 * used.ru_maxrss)


def placed_models(folder: pathlib.Path) -> pathlib.Path:
    """Writes a scene of pyramids in rows of 73, 10 m apart, and returns the scene file."""
    objects = []
    for number in range(MODELS):
        corners = f"v 0 0 {5.0 + 1e-3 * number:.3f}\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
        (folder / f"{number}.obj").write_text(f"{corners}f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\n")
        objects.append({"file": f"{number}.obj", "material": "Wall",
                        "position": [10.0 * (number % 73) - 360.0, 10.0 * (number // 73) - 360.0, 0.0]})
    scene = folder / "models.lidarscene.json"
    scene.write_text(json.dumps({"version": 1, "objects": objects}))
    return scene


def rows(short):
    lidars = FEW if short else on_sale()
    reach = run("reach", *(word for name in lidars for word in ("--sensor", name)), "--species", "herring gull")
    yield Row("operations", f"avianlidar reach, {len(lidars)} lidars", reach.processor, "s", None if short else 30.0)
    if short:
        return
    with tempfile.TemporaryDirectory() as folder:
        by = {threads: run("report", PLAN, "-o", pathlib.Path(folder) / f"{threads}.html", "--threads", threads)
              for threads in (1, 2)}
    yield Row("operations", "avianlidar report of gulls, one thread", by[1].processor, "s", 75.0)
    yield Row("operations", "avianlidar report of gulls, peak memory by two threads", by[2].memory, "MB", 700.0)
    yield Row("operations", "avianlidar report of gulls, wall time by two threads over one", by[2].wall / by[1].wall,
              "", 0.6)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scans = run("sequence", SCENARIO, "-o", folder / "scans", "--scans", SCANS, "--threads", 1)
        yield Row("operations", f"avianlidar sequence, {SCANS} scans, one thread", scans.processor, "s", 4.0)
        scan = run("scan", placed_models(folder), "-o", folder / "echoes.pcd")
        yield Row("operations", f"avianlidar scan of {MODELS:,} placed models", scan.processor, "s", 5.0)
        if os.environ.get("AVIANLIDAR_DATA_DIR"):
            packed = pathlib.Path(os.environ["AVIANLIDAR_DATA_DIR"]) / "osm_neubrandenburg" / "neubrandenburg.osm.bz2"
            (folder / "map.osm").write_bytes(bz2.decompress(packed.read_bytes()))
            airport = run("airport", folder / "map.osm", "-o", folder / "airport")
            yield Row("operations", "avianlidar airport of Neubrandenburg", airport.processor, "s", 3.0)
