#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What labelled sequences cost: scans per second, where the time goes, memory, and what fewer rays lose.

    /usr/bin/python3 Examples/sequence/measure.py --out build/sequence-measured --page

Leaves a Markdown table for each of these in the folder; --page puts those that are there into
Documentation/sequences.md. Time is that of the processor, all threads and ranks together, unless a column says wall.

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`).
"""
import csv
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

from avianlidar import Sequence
from avianlidar.apps._sequence import read_scenario

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402

PAGE = HERE.parent.parent / "Documentation" / "sequences.md"
SCENARIO = HERE / "hongqiao.scenario.json"
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
    lines = ["| sway and jitter | scans | one process of two threads: CPU, s | wall, s | two ranks of one thread: CPU, s | wall, s |",
             "|---|" + "---:|" * 5]
    for name, sensor in MOTION.items():
        whole = scenario(None, sensor, number_of_scans=2 * options.scans, scans_per_sequence=options.scans)
        found = [job(whole, parallel, folder) for parallel in (False, True)]
        if found[0][2] != found[1][2]:
            sys.exit(f"{name}: two ranks leave other files than one process")
        cells = [f"{value:.1f}" for cpu, wall, _ in found for value in (cpu, wall)]
        lines.append(f"| {name} | {2 * options.scans} | " + " | ".join(cells) + " |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def speed(options, folder):
    """Scans per second against birds, channels, motion, and ranks."""
    lines = ["| channels | gulls | sway and jitter | one rank: CPU of a scan, ms | scans/s | two ranks: CPU of a scan, ms "
             "| scans/s |", "|---:|---:|---|" + "---:|" * 4]
    for channels, sensor in CHANNELS.items():
        for birds in options.birds:
            for name, motion in MOTION.items():
                scans = options.scans if birds < 1000 else options.scans_of_many
                whole = scenario(None, {**sensor, **motion}, birds=gulls(birds), objects=[])
                whole["scans_per_sequence"] = scans
                one = stamps({**whole, "number_of_scans": scans}, folder)
                two = stamps_of_ranks({**whole, "number_of_scans": 2 * scans}, folder)
                lines.append(f"| {channels} | {birds:,} | {name} | {1000 * one[0]:.0f} | {1 / one[1]:.1f} | "
                             f"{1000 * two[:, 0].mean():.0f} | {sum(1 / two[:, 1]):.1f} |")
                print(lines[-1], file=sys.stderr, flush=True)
    return lines


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
    lines = ["| sway and jitter | a scan, ms | birds and objects | noise | labels, truth and files | the rest |",
             "|---|" + "---:|" * 5]
    none = {"birds": [], "objects": []}
    for name, sensor in MOTION.items():
        cases = {"whole": (scenario(None, sensor), True), "movers": (scenario(None, sensor, **none), True),
                 "noise": (scenario({"noise": False}, sensor), True), "files": (scenario(None, sensor), False)}
        found = {key: [] for key in cases}
        for _ in range(options.rounds):
            for key, (whole, writing) in cases.items():
                found[key].append(stamps({**whole, "number_of_scans": options.scans}, folder, writing)[0])
        cost = {key: 1000 * min(values) for key, values in found.items()}  # other work only adds
        parts = [cost["whole"] - cost[key] for key in ("movers", "noise", "files")]
        cells = [*parts, cost["whole"] - sum(parts)]
        lines.append(f"| {name} | {cost['whole']:.0f} | " +
                     " | ".join(f"{max(0, cell):.0f} ({100 * max(0, cell) / cost['whole']:.0f} %)" for cell in cells) + " |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


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
    lines = ["| sway and jitter | " + " | ".join(f"after scan {k:,}" for k in memory_scans(options)) + " |",
             "|---|" + "---:|" * len(memory_scans(options))]
    for name, sensor in MOTION.items():
        whole = scenario(None, sensor, number_of_scans=options.memory_scans, scans_per_sequence=50)
        (folder / "memory.json").write_text(json.dumps(whole), encoding="utf-8")
        shutil.rmtree(folder / "memory", ignore_errors=True)
        said = subprocess.run([sys.executable, "-c", WATCH, str(folder / "memory.json"), str(folder / "memory")], check=True,
                              stdout=subprocess.PIPE).stdout
        seen = json.loads(said)
        lines.append(f"| {name} | " + " | ".join(f"{seen[k - 1]:.0f} MB" for k in memory_scans(options)) + " |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def memory_scans(options):
    return sorted({1, 50, *range(100, options.memory_scans, 100), options.memory_scans})


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
    lines = ["| rays | birds compared | rms relative difference of energy | mean "
             "| off by more than 10 % | no energy at all | birds seen | points of birds |", "|---|" + "---:|" * 7]
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
        cells = [f"{len(keys):,}", *(["–"] * 4 if rays == options.rays else differences), f"{sum(p > 0 for p in points):,}",
                 f"{sum(points):,}"]
        lines.append(f"| {rays:,} | " + " | ".join(cells) + " |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def long(options, folder):
    """The command at work for as many scans as a training set may have, wall time."""
    lines = ["| sway and jitter | scans | CPU, s | wall, s | scans/s | size of the files, MB |", "|---|" + "---:|" * 5]
    for name, sensor in MOTION.items():
        scans = options.long_scans if name == "none" else options.long_scans // 10
        cpu, wall, _ = job(scenario(None, sensor, number_of_scans=scans), False, folder)
        size = sum(path.stat().st_size for path in (folder / "job").rglob("*") if path.is_file())
        lines.append(f"| {name} | {scans:,} | {cpu:,.0f} | {wall:,.0f} | {scans / wall:.1f} | {1e-6 * size:,.0f} |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def insert(page, folder):
    """Put the tables of the folder between their marks."""
    text = page.read_text(encoding="utf-8")
    for file in sorted(folder.glob("sequences-*.md")):
        begin, end = f"<!-- table: {file.stem} -->\n", "<!-- end -->"
        if begin not in text:
            sys.exit(f"{page}: no place for {file.stem}")
        table = begin + file.read_text(encoding="utf-8") + end
        text = re.sub(re.escape(begin) + ".*?" + end, lambda _, table=table: table, text, flags=re.S)
    page.write_text(text, encoding="utf-8")


TABLES = {"speed": speed, "ranks": ranks, "shares": shares, "memory": memory, "energies": energies, "long": long}


def main(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/sequence-measured"), help="folder for tables")
    parser.add_argument("--only", nargs="*", choices=TABLES, default=list(TABLES), help="these tables; default: all")
    parser.add_argument("--page", action="store_true", help="put the tables into Documentation/sequences.md")
    parser.add_argument("--birds", nargs="*", type=running.whole(0, 50000), default=[0, 10, 100, 1000], help="numbers of gulls")
    parser.add_argument("--scans", type=running.whole(4, 100), default=12, help="of a run, default 12")
    parser.add_argument("--scans-of-many", type=running.whole(4, 100), default=6, help="with 1000 birds, default 6")
    parser.add_argument("--memory-scans", type=running.whole(100, 100000), default=400, help="default 400")
    parser.add_argument("--rounds", type=running.whole(1, 100), default=3, help="of which the shortest is taken, default 3")
    parser.add_argument("--rays", type=running.whole(100, 1000000), default=10000, help="of the reference, default 10,000")
    parser.add_argument("--long-scans", type=running.whole(100, 100000), default=10000,
                        help="without motion, a tenth of it with; default 10,000")
    options = parser.parse_args(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    # As root, mpiexec starts nothing otherwise.
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    with tempfile.TemporaryDirectory(dir=options.out) as folder:
        for name in options.only:
            lines = TABLES[name](options, pathlib.Path(folder))
            (options.out / f"sequences-{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    if options.page:
        insert(PAGE, options.out)


if __name__ == "__main__":
    main()
