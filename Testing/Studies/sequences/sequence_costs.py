# SPDX-License-Identifier: BSD-3-Clause
"""What labelled sequences cost: scans per second, where the time goes, memory, and what fewer rays lose.

    Testing/Studies/run.py sequence_costs --only speed ranks
    Testing/Studies/run.py pages --from build sequence_costs

Time is that of the processor, all threads and ranks together, unless a column says wall.
"""
import csv
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
from avianlidar.apps._inputs import read_scenario
from running import AIRPORT, argument, study, whole

SCENARIO = AIRPORT.parents[2] / "sequence" / "hongqiao.scenario.json"
# The shipped scenario has 400 rays, sway and jitter.
RAYS = (100, 400)
MOTION = {"none": {"sway_amplitude": 0.0, "encoder_jitter": 0.0}, "as shipped": {}}
CHANNELS = {16: {}, 32: {"channel_elevations": [6 * k / 31 for k in range(32)]}}


def scenario(scan=None, sensor=None, **others):
    """The shipped scenario with changes."""
    whole = {**read_scenario(SCENARIO), **others}
    return {**whole, "scan": {**whole["scan"], **(scan or {})}, "sensor": {**whole["sensor"], **(sensor or {})}}


def gulls(number):
    """Crossings near the lidar."""
    return [{"pattern": "Crossings", "species": "herring gull", "number_of_birds": number, "radius": 300,
             "heights": [2, 40]}]


def job(whole, ranks, folder):
    """Write sequences by the command. (CPU time in s, wall time in s, sums of the files)"""
    file = folder / "job.scenario.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    out = folder / "job"
    shutil.rmtree(out, ignore_errors=True)
    start = ["mpiexec", "-n", "2", "pvbatch", "--sym"] if ranks else [sys.executable]

    def spent():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return np.array([usage.ru_utime + usage.ru_stime, time.monotonic()])
    before = spent()
    subprocess.run([*start, "-m", "avianlidar", "sequence", str(file), "-o", str(out), "--threads", "1" if ranks else "2"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    cpu, wall = spent() - before
    parts = json.loads((out / "manifest.json").read_text())["sequences"]
    return cpu, wall, [part["sha256"] for part in parts.values()]


def ranks(options, folder):
    """The command on one process and on two ranks; the files are the same or the run fails."""
    yield ("sway and jitter", "scans", "one process of two threads: CPU, s", "wall, s", "two ranks of one thread: CPU, s", "wall, s")
    for name, sensor in MOTION.items():
        what = scenario(None, sensor, number_of_scans=2 * options.scans, scans_per_sequence=options.scans)
        found = [job(what, parallel, folder) for parallel in (False, True)]
        if found[0][2] != found[1][2]:
            sys.exit(f"{name}: two ranks leave other files than one process")
        yield name, 2 * options.scans, *(f"{value:.1f}" for cpu, wall, _ in found for value in (cpu, wall))


def speed(options, folder):
    """Scans per second against birds, channels, motion, and ranks."""
    yield "channels", "gulls", "sway and jitter", "one rank: CPU of a scan, ms", "scans/s", "two ranks: CPU of a scan, ms", "scans/s"
    for channels, sensor in CHANNELS.items():
        for birds in options.birds:
            for name, motion in MOTION.items():
                scans = options.scans if birds < 1000 else options.scans_of_many
                what = scenario(None, {**sensor, **motion}, birds=gulls(birds), objects=[])
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


def stamps(whole, folder, writing=True):
    """Medians of the CPU time and the wall time of a scan in s, of all but the first, on one thread."""
    sequence, times = Sequence(whole, threads=1), []

    def stamp(*_):
        times.append((time.process_time(), time.monotonic()))
    if writing:
        shutil.rmtree(folder / "stamps", ignore_errors=True)
        sequence.write(folder / "stamps", progress=stamp)
    else:
        for _ in sequence.frames(0):
            stamp()
    return np.median(np.diff(times, axis=0), axis=0)


def shares(options, folder):
    """Where the time of a scan goes, by leaving one thing out."""
    yield "sway and jitter", "a scan, ms", "birds and objects", "noise", "labels, truth and files", "the rest"
    none = {"birds": [], "objects": []}
    for name, sensor in MOTION.items():
        cases = {"whole": (scenario(None, sensor), True), "movers": (scenario(None, sensor, **none), True),
                 "noise": (scenario({"noise": False}, sensor), True), "files": (scenario(None, sensor), False)}
        found = {key: [] for key in cases}
        for _ in range(options.rounds):
            for key, (what, writing) in cases.items():
                found[key].append(stamps({**what, "number_of_scans": options.scans}, folder, writing)[0])
        cost = {key: 1000 * min(values) for key, values in found.items()}  # other work only adds
        parts = [cost["whole"] - cost[key] for key in ("movers", "noise", "files")]
        yield (name, f"{cost['whole']:.0f}", *(f"{max(0, cell):.0f} ({100 * max(0, cell) / cost['whole']:.0f} %)"
                                               for cell in (*parts, cost["whole"] - sum(parts))))


WATCH = """
import json, sys
from avianlidar import Sequence
seen = []
def watch(*_):
    seen.append(int(open("/proc/self/status").read().split("VmRSS:")[1].split()[0]) / 1024)
Sequence(json.load(open(sys.argv[1])), threads=2).write(sys.argv[2], progress=watch)
print(json.dumps(seen))
"""


def memory(options, folder):
    """Resident memory of the shipped scenario while it makes sequences of 50 scans."""
    scans = sorted({1, 50, *range(100, options.memory_scans, 100), options.memory_scans})
    yield ("sway and jitter", *(f"after scan {k:,}" for k in scans))
    for name, sensor in MOTION.items():
        what = scenario(None, sensor, number_of_scans=options.memory_scans, scans_per_sequence=50)
        (folder / "memory.json").write_text(json.dumps(what), encoding="utf-8")
        shutil.rmtree(folder / "memory", ignore_errors=True)
        said = subprocess.run([sys.executable, "-c", WATCH, str(folder / "memory.json"), str(folder / "memory")], check=True,
                              stdout=subprocess.PIPE).stdout
        seen = json.loads(said)
        yield (name, *(f"{seen[k - 1]:.0f} MB" for k in scans))


def expected(whole, folder):
    """(energy in J, probability, points) of each bird and scan."""
    shutil.rmtree(folder / "energies", ignore_errors=True)
    sequence = Sequence(whole, threads=2)
    sequence.write(folder / "energies")
    found = {}
    for text in sorted((folder / "energies").glob("sequences/*/truth.csv")):
        with open(text, encoding="utf-8") as rows:
            for row in csv.DictReader(rows):
                if row["status"] != "absent":
                    found[row["scan"], row["bird"]] = (float(row["expected_energy_J"]), float(row["expected_probability"]),
                                                       int(row["points"]))
    return found


def energies(options, folder):
    """What settings cost in the truth: energies of birds against a run of many rays."""
    yield ("rays", "birds compared", "rms relative difference of energy", "mean", "off by more than 10 %", "no energy at all", "birds seen",
           "points of birds")
    reference = expected(scenario({"rays_per_beam": options.rays}, number_of_scans=options.scans), folder)
    keys = [key for key, (_, probability, _) in reference.items() if probability > 0.1]
    true = np.array([reference[key][0] for key in keys])
    for rays in (*RAYS, options.rays):
        found = reference if rays == options.rays else expected(
            scenario({"rays_per_beam": rays}, number_of_scans=options.scans), folder)
        energy = np.array([found[key][0] for key in keys])
        away = energy / true - 1
        points = [found[key][2] for key in keys]
        differences = [f"{100 * np.sqrt(np.mean(away**2)):.0f} %", f"{100 * away.mean():+.1f} %",
                       f"{100 * np.mean(abs(away) > 0.1):.1f} %", f"{100 * np.mean(energy == 0):.1f} %"]
        yield (f"{rays:,}", f"{len(keys):,}", *(["–"] * 4 if rays == options.rays else differences), f"{sum(p > 0 for p in points):,}",
               f"{sum(points):,}")


def long(options, folder):
    """The command at work for as many scans as a training set may have, wall time."""
    yield "sway and jitter", "scans", "CPU, s", "wall, s", "scans/s", "size of the files, MB"
    for name, sensor in MOTION.items():
        scans = options.long_scans if name == "none" else options.long_scans // 10
        cpu, wall, _ = job(scenario(None, sensor, number_of_scans=scans), False, folder)
        size = sum(path.stat().st_size for path in (folder / "job").rglob("*") if path.is_file())
        yield name, f"{scans:,}", f"{cpu:,.0f}", f"{wall:,.0f}", f"{scans / wall:.1f}", f"{1e-6 * size:,.0f}"


TABLES = {"speed": speed, "ranks": ranks, "shares": shares, "memory": memory, "energies": energies, "long": long}


@study(argument("--only", nargs="*", choices=TABLES, default=list(TABLES), help="these tables; default: all"),
       argument("--birds", nargs="*", type=whole(0, 50000), default=[0, 10, 100, 1000], help="numbers of gulls"),
       argument("--scans", type=whole(4, 100), default=12, help="of a run, default 12"),
       argument("--scans-of-many", type=whole(4, 100), default=6, help="with 1000 birds, default 6"),
       argument("--memory-scans", type=whole(100, 100000), default=400, help="default 400"),
       argument("--rounds", type=whole(1, 100), default=3, help="of which the shortest is taken, default 3"),
       argument("--rays", type=whole(100, 1000000), default=10000, help="of the reference, default 10,000"),
       argument("--long-scans", type=whole(100, 100000), default=10000, help="without motion, a tenth of it with; default 10,000"))
def main(options):
    # As root, mpiexec starts nothing otherwise.
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.only:
            head, *rows = TABLES[name](options, pathlib.Path(folder))
            tools.leave(options.out, f"sequences-{name}", head, rows)
