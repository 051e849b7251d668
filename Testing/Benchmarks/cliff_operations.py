# SPDX-License-Identifier: BSD-3-Clause
"""Part of cliffs.py: whole commands, each in a process of its own. The range of gulls for all lidars on sale, and the
report of gulls for the example airport: processor time of all threads, peak memory, and wall time by two threads over
wall time by one, which other work on the machine makes larger. With --short, only the ranges of two lidars, without an
aim."""
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

from avianlidar.apps._on_sale import on_sale
from cliffs import Row

PLAN = pathlib.Path(__file__).resolve().parents[2] / "Examples" / "coverage" / "gulls.coverage.json"
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
