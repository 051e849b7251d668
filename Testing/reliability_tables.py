#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the tables of Documentation/evidence/reliability.md.

    reliability_tables.py branches build/coverage    what run_branches.sh measured there
    reliability_tables.py fuzzing                    the sums of Fuzzing/runs.csv
"""
import csv
import json
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[1]
sys.path.append(str(SOURCE / "Documentation"))
import page_tables  # noqa: E402

ALL, ALL_OF_KERNEL = "IO, Filters and Python", "kernel"


def share(taken, of):
    return f"{100 * taken / of:.1f}" if of else ""


def counts(tree):
    """Lines, lines that ran, branches and branches taken, by file."""
    files = {}
    for file in (file for name in ("branches", "kernel")
                 for file in json.loads((tree / f"{name}.json").read_text("utf-8"))["files"]):
        files[file["filename"]] = [file[name]
                                   for name in ("line_total", "line_covered", "branch_total", "branch_covered")]
    for name, file in json.loads((tree / "python.json").read_text("utf-8"))["files"].items():
        files["Python/" + name.split("/dist-packages/")[-1]] = [
            file["summary"][key] for key in ("num_statements", "covered_lines", "num_branches", "covered_branches")]
    return files


def branches(tree):
    files = counts(pathlib.Path(tree))
    folders = {}
    for name, file in files.items():
        of_kernel = name.startswith(("Filters/Kernel/", "Filters/VolumeTree/"))
        for folder in (str(pathlib.PurePath(name).parent), ALL_OF_KERNEL if of_kernel else ALL):
            folders[folder] = [a + b for a, b in zip(folders.get(folder, (0, 0, 0, 0)), file)]
    rows = ""
    for folder, (lines, run, count, taken) in sorted(folders.items(),
                                                     key=lambda one: (one[0] in (ALL, ALL_OF_KERNEL), one[0])):
        name = folder if folder in (ALL, ALL_OF_KERNEL) else f"`{folder}`"
        rows += f"| {name} | {lines:,} | {share(run, lines)} | {count:,} | {share(taken, count)} |\n"
    yield "branches", ("| folder | lines | of them run, % | branches | of them taken, % |\n"
                       "|---|---:|---:|---:|---:|\n" + rows)


def fuzzing():
    with open(SOURCE / "Testing" / "Fuzzing" / "runs.csv", encoding="utf-8", newline="") as lines:
        runs = list(csv.DictReader(lines))
    rows = ""
    for name in sorted({run["fuzzer"] for run in runs}):
        own = [run for run in runs if run["fuzzer"] == name]
        since = own[max((i + 1 for i, run in enumerate(own) if int(run["found"])), default=0):]
        last = own[-1]
        hours, hours_since = (sum(int(run["minutes"]) for run in some) / 60 for some in (own, since))
        inputs = sum(int(run["inputs"]) for run in since)
        rows += (f"| `Fuzz{name}` | {hours:.1f} | {sum(int(run['found']) for run in own)} | {hours_since:.1f} | "
                 f"{inputs:,} | {last['date']}, {last['commit']} |\n")
    yield "fuzzing", ("| fuzzer | hours in all | runs that found something | hours since | inputs since | last run |\n"
                      "|---|---:|---:|---:|---:|---|\n" + rows)


def main(which, *arguments):
    for name, table in {"branches": branches, "fuzzing": fuzzing}[which](*arguments):
        page_tables.put(name, table)
        print(table)


if __name__ == "__main__":
    main(*sys.argv[1:])
