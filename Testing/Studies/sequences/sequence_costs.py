# SPDX-License-Identifier: BSD-3-Clause
"""What labelled sequences cost: scans per second and the size of the files.

    Testing/Studies/run.py sequence_costs --only speed
    Testing/Studies/run.py pages --from build sequence_costs

Time is that of the processor, all threads and ranks together, unless a column says wall.
"""
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

import tools
from avianlidar import Sequence
from avianlidar.apps.inputs._read import read_scenario
from running import AIRPORT, argument, study, whole

SCENARIO = AIRPORT.parents[2] / "sequence" / "hongqiao.scenario.json"
# The shipped scenario has 400 rays, sway and jitter.
MOTION = {"none": {"sway_amplitude": 0.0, "encoder_jitter": 0.0}, "as shipped": {}}
CHANNELS = {16: {}, 32: {"channel_elevations": [6 * k / 31 for k in range(32)]}}


def scenario(sensor, **others):
    """The shipped scenario with changes."""
    whole = {**read_scenario(SCENARIO), **others}
    return {**whole, "sensor": {**whole["sensor"], **sensor}}


def gulls(number):
    """Crossings near the lidar."""
    return [{"pattern": "Crossings", "species": "herring gull", "number_of_birds": number, "radius": 300,
             "heights": [2, 40]}]


def job(whole, folder):
    """Write sequences by the command: CPU time and wall time in s."""
    file = folder / "job.scenario.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    out = folder / "job"
    shutil.rmtree(out, ignore_errors=True)

    def spent():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return np.array([usage.ru_utime + usage.ru_stime, time.monotonic()])
    before = spent()
    subprocess.run([sys.executable, "-m", "avianlidar", "sequence", str(file), "-o", str(out), "--threads", "2"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    return spent() - before


def speed(options, folder):
    """Scans per second against birds, channels, motion, and ranks."""
    yield "channels", "gulls", "sway and jitter", "one rank: CPU of a scan, ms", "scans/s", "two ranks: CPU of a scan, ms", "scans/s"
    for channels, sensor in CHANNELS.items():
        for birds in options.birds:
            for name, motion in MOTION.items():
                scans = options.scans if birds < 1000 else options.scans_of_many
                what = scenario({**sensor, **motion}, birds=gulls(birds), objects=[])
                what["scans_per_sequence"] = scans
                one = stamps({**what, "number_of_scans": scans}, folder)
                two = stamps_of_ranks({**what, "number_of_scans": 2 * scans}, folder)
                yield (channels, f"{birds:,}", name, f"{1000 * one[0]:.0f}", f"{1 / one[1]:.1f}", f"{1000 * two[:, 0].mean():.0f}",
                       f"{sum(1 / two[:, 1]):.1f}")


RANK = """
import json, sys, time
from avianlidar import Sequence
from avianlidar._ranks import Ranks
times, ranks = [], Ranks()
Sequence(json.load(open(sys.argv[1])), threads=1).write(
    sys.argv[2], ranks, lambda *_: times.append((time.process_time(), time.monotonic())))
json.dump(times, open(f"{sys.argv[2]}/{ranks.rank}.json", "w"))
"""


def stamps_of_ranks(whole, folder):
    """The same of each of two ranks, which make a sequence each at the same time."""
    shutil.rmtree(folder / "ranks", ignore_errors=True)
    (folder / "ranks.json").write_text(json.dumps(whole), encoding="utf-8")
    (folder / "rank.py").write_text(RANK, encoding="utf-8")
    subprocess.run(["mpiexec", "-n", "2", "pvbatch", "--sym", str(folder / "rank.py"), str(folder / "ranks.json"),
                    str(folder / "ranks")], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    return np.array([np.median(np.diff(json.loads((folder / "ranks" / f"{rank}.json").read_text()), axis=0), axis=0)
                     for rank in (0, 1)])


def stamps(whole, folder):
    """Medians of the CPU time and the wall time of a scan in s, of all but the first, on one thread."""
    sequence, times = Sequence(whole, threads=1), []

    def stamp(*_):
        times.append((time.process_time(), time.monotonic()))
    shutil.rmtree(folder / "stamps", ignore_errors=True)
    sequence.write(folder / "stamps", progress=stamp)
    return np.median(np.diff(times, axis=0), axis=0)


def long(options, folder):
    """The command at work for as many scans as a training set may have, wall time."""
    yield "sway and jitter", "scans", "CPU, s", "wall, s", "scans/s", "size of the files, MB"
    for name, sensor in MOTION.items():
        scans = options.long_scans if name == "none" else options.long_scans // 10
        cpu, wall = job(scenario(sensor, number_of_scans=scans), folder)
        size = sum(path.stat().st_size for path in (folder / "job").rglob("*") if path.is_file())
        yield name, f"{scans:,}", f"{cpu:,.0f}", f"{wall:,.0f}", f"{scans / wall:.1f}", f"{1e-6 * size:,.0f}"


TABLES = {"speed": speed, "long": long}


@study(argument("--only", nargs="*", choices=TABLES, default=list(TABLES), help="these tables; default: all"),
       argument("--birds", nargs="*", type=whole(0, 50000), default=[0, 10, 100, 1000], help="numbers of gulls"),
       argument("--scans", type=whole(4, 100), default=12, help="of a run, default 12"),
       argument("--scans-of-many", type=whole(4, 100), default=6, help="with 1000 birds, default 6"),
       argument("--long-scans", type=whole(100, 100000), default=10000, help="without motion, a tenth of it with; default 10,000"))
def main(options):
    # As root, mpiexec starts nothing otherwise.
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.only:
            head, *rows = TABLES[name](options, pathlib.Path(folder))
            tools.leave(options.out, f"sequences-{name}", head, rows)
