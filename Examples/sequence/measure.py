#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What labelled sequences cost: scans per second, where the time goes, memory, and what faster settings lose.

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
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

from avianlidar import Sequence
from avianlidar._sequence import read_scenario

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402

PAGE = HERE.parent.parent / "Documentation" / "sequences.md"
SCENARIO = HERE / "hongqiao.scenario.json"
# The shipped scenario has 400 rays.
SETTINGS = {"100 rays": {"rays_per_beam": 100}, "400 rays": {"rays_per_beam": 400},
            "faster": {"rays_per_beam": 100, "plane_integration": False, "refine_near_limit": False}}
STILL = {"sway_amplitude": 0.0, "encoder_jitter": 0.0}
CHANNELS = {16: {}, 32: {"channel_elevations": [6 * k / 31 for k in range(32)]}}
LONGEST = 24  # scans of a run, so that birds cross in as many revolutions in all


def scenario(scan=None, sensor=None, **others):
    """The shipped scenario with changes."""
    whole = {**read_scenario(SCENARIO), **others}
    return {**whole, "scan": {**whole["scan"], **(scan or {})}, "sensor": {**whole["sensor"], **(sensor or {})}}


def gulls(number):
    """Crossings near the lidar, in revolutions 0 to LONGEST - 1, whatever the number of scans."""
    return [{"pattern": "Crossings", "species": "herring gull", "number_of_birds": number, "radius": 300,
             "heights": [2, 40], "time_range": [0, 2 * LONGEST]}]


def job(whole, ranks, folder):
    """Write two sequences by the command. (CPU time in s, wall time in s, sums of the files)"""
    file = folder / "job.scenario.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    out = folder / "job"
    shutil.rmtree(out, ignore_errors=True)
    start = ["mpiexec", "-n", "2", "pvbatch", "--sym"] if ranks else [sys.executable]

    def spent():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return np.array([usage.ru_utime + usage.ru_stime, time.monotonic()])
    before = spent()
    subprocess.run([*start, str(HERE / "sequence.py"), str(file), "-o", str(out), "--threads", "1" if ranks else "2"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    cpu, wall = spent() - before
    parts = json.loads((out / "manifest.json").read_text())["sequences"]
    return cpu, wall, [part["sha256"] for part in parts.values()]


def ranks(options, folder):
    """The command on one process and on two ranks; the files are the same or the run fails."""
    lines = ["| settings | scans | one process of two threads: CPU, s | wall, s | two ranks of one thread: CPU, s | wall, s |",
             "|---|" + "---:|" * 5]
    for name in ("100 rays", "faster"):
        whole = scenario(SETTINGS[name], number_of_scans=2 * options.scans, scans_per_sequence=options.scans)
        found = [job(whole, parallel, folder) for parallel in (False, True)]
        if found[0][2] != found[1][2]:
            sys.exit(f"{name}: two ranks leave other files than one process")
        cells = [f"{value:.1f}" for cpu, wall, _ in found for value in (cpu, wall)]
        lines.append(f"| {name} | {2 * options.scans} | " + " | ".join(cells) + " |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def speed(options, folder):
    """Scans per second against birds, channels, settings, and threads."""
    lines = ["| channels | gulls | settings | one thread: CPU of a scan, ms | scans/s of a core "
             "| two threads: CPU of a scan, ms | wall, ms |", "|---:|---:|---|" + "---:|" * 4]
    for channels, sensor in CHANNELS.items():
        for birds in options.birds:
            for name in ("100 rays", "faster"):
                scans = options.scans if birds < 1000 else options.scans_of_many
                whole = scenario(SETTINGS[name], sensor, birds=gulls(birds), objects=[], number_of_scans=scans)
                one, two = (stamps(whole, folder, threads=threads) for threads in (1, 2))
                lines.append(f"| {channels} | {birds:,} | {name} | {1000 * one[0]:.0f} | {1 / one[0]:.1f} | "
                             f"{1000 * two[0]:.0f} | {1000 * two[1]:.0f} |")
                print(lines[-1], file=sys.stderr, flush=True)
    return lines


def stamps(whole, folder, writing=True, threads=1):
    """Medians of the CPU time and the wall time of a scan in s, of all but the first."""
    sequence, times = Sequence(whole, threads=threads), []

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
    lines = ["| settings | sway and jitter | a scan, ms | birds and objects | noise | labels, truth and files | the rest |",
             "|---|---|" + "---:|" * 5]
    none = {"birds": [], "objects": []}
    for name, scan in SETTINGS.items():
        for sway, sensor in (("on", {}), ("off", STILL)):
            cases = {"whole": (scenario(scan, sensor), True), "movers": (scenario(scan, sensor, **none), True),
                     "noise": (scenario({**scan, "noise": False}, sensor), True),
                     "files": (scenario(scan, sensor), False)}
            found = {key: [] for key in cases}
            for _ in range(options.rounds):
                for key, (whole, writing) in cases.items():
                    found[key].append(stamps({**whole, "number_of_scans": options.scans}, folder, writing)[0])
            cost = {key: 1000 * statistics.median(values) for key, values in found.items()}
            parts = [cost["whole"] - cost[key] for key in ("movers", "noise", "files")]
            cells = [*parts, cost["whole"] - sum(parts)]
            lines.append(f"| {name} | {sway} | {cost['whole']:.0f} | " +
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
    lines = ["| settings | " + " | ".join(f"after scan {k:,}" for k in memory_scans(options)) + " |",
             "|---|" + "---:|" * len(memory_scans(options))]
    for name in ("100 rays", "faster"):
        whole = scenario(SETTINGS[name], number_of_scans=options.memory_scans, scans_per_sequence=50)
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
    lines = ["| settings | birds compared | rms relative difference of energy | mean "
             "| off by more than 10 % | no energy at all | birds seen | points of birds |", "|---|" + "---:|" * 7]
    reference = expected(scenario({"rays_per_beam": options.rays}, number_of_scans=options.scans), folder)
    keys = [key for key, (_, probability, _) in reference.items() if probability > 0.1]
    true = np.array([reference[key][0] for key in keys])
    cases = {**SETTINGS, f"{options.rays:,} rays": None}
    for name, scan in cases.items():
        found = reference if scan is None else expected(scenario(scan, number_of_scans=options.scans), folder)
        energy = np.array([found[key][0] for key in keys])
        away = energy / true - 1
        points = [found[key][2] for key in keys]
        differences = [f"{100 * np.sqrt(np.mean(away**2)):.0f} %", f"{100 * away.mean():+.1f} %",
                       f"{100 * np.mean(abs(away) > 0.1):.1f} %", f"{100 * np.mean(energy == 0):.1f} %"]
        cells = [f"{len(keys):,}", *(["–"] * 4 if scan is None else differences), f"{sum(p > 0 for p in points):,}",
                 f"{sum(points):,}"]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
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


TABLES = {"speed": speed, "ranks": ranks, "shares": shares, "memory": memory, "energies": energies}


def main(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/sequence-measured"), help="folder for tables")
    parser.add_argument("--only", nargs="*", choices=TABLES, default=list(TABLES), help="these tables; default: all")
    parser.add_argument("--page", action="store_true", help="put the tables into Documentation/sequences.md")
    parser.add_argument("--birds", nargs="*", type=running.whole(0, 50000), default=[0, 10, 100, 1000], help="numbers of gulls")
    parser.add_argument("--scans", type=running.whole(4, LONGEST), default=20, help="of a run, default 20")
    parser.add_argument("--scans-of-many", type=running.whole(4, LONGEST), default=6, help="with 1000 birds, default 6")
    parser.add_argument("--memory-scans", type=running.whole(100, 100000), default=400, help="default 400")
    parser.add_argument("--rounds", type=running.whole(1, 100), default=3, help="of which the median is taken, default 3")
    parser.add_argument("--rays", type=running.whole(100, 1000000), default=10000, help="of the reference, default 10,000")
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
