#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tables (Markdown) and plots (PNG) of a run of the benchmarks, from its CSV files.

    report.py FOLDER            tables.md and *.png into the same folder
    report.py FOLDER --pages    also into Documentation/ (page_tables.py), pictures as images/speed-*.png or images/paper-*.png
"""
import argparse
import pathlib
import shutil

import paper_figures
import plots
from results import columns_of, count, page_tables, pivot, put_into_pages, ratio_text, read, seconds, table

AIRPORTS = ("Hongqiao", "Hongqiao, structures", "Hongqiao, everything", "Honolulu")


def cells(folder):
    """{(scene, channels, N, half-beamwidth, threads): {contender: ns per ray}} of the matrix."""
    return pivot(read(folder, "matrix"),
                 lambda r: (r["scene"], int(r["channels"]), int(r["rays_per_beam"]), r["half_beamwidth"], int(r["threads"])),
                 lambda r: r["contender"], lambda r: 1e9 * r["median_s"] / (r["beams"] * r["rays_per_beam"]))


def best_of_embree(times):
    return min(times["embree single"], times["embree packets"])


def summary_table(folder):
    """For each number of rays: the span of Embree's best mode divided by this project's time, and in how many cells Embree is faster."""
    rows = []
    ratios = {k: best_of_embree(t) / t["ours"] for k, t in cells(folder).items()}
    for n in sorted({k[2] for k in ratios}, reverse=True):
        every = [v for k, v in ratios.items() if k[2] == n]
        spans = [[v for k, v in ratios.items() if k[2] == n and k[0] in AIRPORTS], every]
        rows.append([count(n), *(" to ".join(ratio_text(f(v)).strip("*") for f in (min, max)) if v else "-"
                                 for v in spans), f"{sum(v < 1.0 for v in every)} of {len(every)}"])
    return table(["rays per beam", "airports: time of Embree's best mode / time of this project", "all scenes", "cells where Embree is faster"], rows)


def matrix_table(folder):
    """Embree's best mode divided by this project's time on one thread, one row a scene, one column for each N and half-beamwidth."""
    found = {}
    for (scene, _, *column, threads), t in cells(folder).items():
        if threads == 1:  # the first channels of a scene, as the others come later
            found.setdefault(scene, {}).setdefault(tuple(column), ratio_text(best_of_embree(t) / t["ours"]))
    columns = sorted(columns_of(found))
    return table(["scene", *(f"N = {n}, {w:g}" for n, w in columns)],
                 [[scene, *(row.get(c, "") for c in columns)] for scene, row in found.items()])


def airport_table(folder):
    """ns per ray of the airports at N = 100 and the paper's half-beamwidth."""
    triangles = {r["scene"]: r["triangles"] for r in read(folder, "matrix")}
    names = ("ours", "ours beams", "ours per ray", "embree packets", "embree single")
    rows = [[f"{scene}, {channels} channels", count(triangles[scene]), threads, *(f"{t[name]:.2f}" for name in names),
             f"{best_of_embree(t) / t['ours']:.1f}", f"{t['embree single'] / t['ours']:.1f}"]
            for (scene, channels, n, width, threads), t in cells(folder).items()
            if scene in AIRPORTS and n == 100 and width == 5.6e-3 and "ours per ray" in t]
    return table(["scene", "triangles", "threads", "ours", "every beam alone", "one descent per ray", "Embree packets",
                  "Embree single", "best / ours", "single / ours"], rows)


def hits_table(folder):
    groups = {}
    for r in read(folder, "hits") + read(folder, "locators"):
        sums = groups.setdefault(r["contender"], [0, 0, 0, 0])
        for i, key in enumerate(("rays", "hits", "differ", "at_edges")):
            sums[i] += int(r[key])
    return table(["against", "rays compared", "hits", "ranges that differ by more than 1e-3", "of those, at edges",
                  "unexplained"],
                 [[name, *map(count, g), f"{(g[2] - g[3]) / max(g[0], 1):.1e}"] for name, g in groups.items()])


def machine_table(folder):
    return table(["machine", ""], [[r["what"], str(r["is"]).removesuffix(".0")]
                                   for name in ("machine", "libraries") for r in read(folder, name)], words=True)


def pivot_table(head, found):
    """One row a group, one column a column of a pivot; what is not there is -."""
    columns = columns_of(found)
    return table([head, *columns], [[group, *(row.get(c, "-") for c in columns)] for group, row in found.items()])


def locator_table(folder):
    def cell(r):
        return (f"{seconds(r['build_s'])}; " if r["build_s"] else "") + f"{r['ns_per_ray']:,.0f}; {r['ratio']:,.0f}"

    return pivot_table("scene", pivot(read(folder, "locators"), lambda r: r["scene"], lambda r: r["contender"], cell))


def build_table(folder):
    """One row a scene: ours, Embree and Embree / ours on one and two threads, and the bytes per triangle."""
    found = pivot(read(folder, "build"), lambda r: (r["scene"], r["triangles"]), lambda r: int(r["threads"]), dict)
    columns = [f"{n}: {name}" if name == "ours" else name for n in ("1 thread", "2 threads")
               for name in ("ours", "Embree", "Embree / ours")]
    return table(["scene", "triangles", *columns, "bytes per triangle, ours", "Embree"],
                 [[scene, count(triangles), *(text for r in by.values() for text in (
                     seconds(r["ours_s"]), seconds(r["embree_s"]), ratio_text(r["ratio"]))),
                   *(f"{by[1][f'{who}_bytes_per_triangle']:.0f}" for who in ("ours", "embree"))]
                  for (scene, triangles), by in found.items()])


UPDATE = "Update(), tree ready"


def filter_table(folder):
    """One column a run, one row a stage; below them how many times the others the whole update takes."""
    found = pivot(read(folder, "filter"), lambda r: r["stage"],
                  lambda r: f"{r['scene']}, {r['channels']:.0f} channels, {r['threads']:.0f} thread{'s' * (r['threads'] > 1)}",
                  lambda r: r["median_s"])
    rows = {stage: {run: seconds(t) for run, t in times.items()} for stage, times in found.items()}
    if found:
        rows["Update() / tracing primary rays"] = {
            run: f"{t / found['tracing primary rays'][run]:.1f}" for run, t in found[UPDATE].items()}
        rows["Update() / (scan - energies): primary rays, paths, and all that finds them"] = {
            run: f"{t / (found['scan without VTK'][run] - found['energies, hits known'][run]):.1f}"
            for run, t in found[UPDATE].items()}
        rows.update({f"Update() / {stage}": {run: f"{found[UPDATE][run] / t:.1f}" for run, t in times.items()}
                     for stage, times in found.items() if stage.startswith("re-lit")})
    return pivot_table("", rows)


def scan_table(folder):
    return pivot_table("scene", pivot(read(folder, "scan"), lambda r: r["scene"], lambda r: r["contender"],
                                      lambda r: f"{seconds(r['median_s'])} ({r['speed']:.2f})"))


def movers_table(folder):
    """One row a scene: times of a scan whose static hits are known, by the number of birds."""
    found = {}
    for r in read(folder, "movers"):
        row = found.setdefault(f"{r['scene']}, {count(r['triangles'])} triangles", {})
        row[f"{count(r['birds'])} birds"] = f"{seconds(r['scan_s'])} ({count(r['touched_beams'])})"
        row["tree and scan of one time"] = row.pop("tree and scan of one time", seconds(r["one_time_s"]))  # the last
    return pivot_table("scene", found)


def memory_table(folder):
    sizes = ("surfaces_mib", "tree_mib", "peak_of_tree_build_mib", "peak_of_scan_mib")
    return table(["scene", "triangles", "surfaces", "tree and merged surfaces", "most while the tree is built",
                  "most while scanned (61,440 beams)", "echoes"],
                 [[r["scene"], count(r["triangles"]), *(f"{r[k]:.0f} MiB" for k in sizes), count(r["echoes"])]
                  for r in read(folder, "memory")])


TABLES = {"machine": machine_table, "summary": summary_table, "airports": airport_table, "matrix-1": matrix_table,
          "hits": hits_table, "locators": locator_table, "build": build_table, "scan": scan_table, "filter": filter_table,
          "memory": memory_table, "movers": movers_table, **paper_figures.TABLES}


def make(folder):
    """Writes tables.md and the plots; returns the files that should be there now."""
    folder = pathlib.Path(folder)
    text = "\n".join(f"## {name}\n\n{body(folder)}" for name, body in TABLES.items())
    (folder / "tables.md").write_text(text, encoding="utf-8")
    return [folder / "tables.md", *plots.make(folder)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--pages", action="store_true", help="also into Documentation/")
    arguments = parser.parse_args()
    make(arguments.folder)
    if arguments.pages:
        put_into_pages({name: body(arguments.folder) for name, body in TABLES.items()})
        for picture in arguments.folder.glob("*.png"):
            for target in page_tables.DOCUMENTATION.glob(f"images/*-{picture.name}"):
                if target.name in (f"speed-{picture.name}", f"paper-{picture.name}"):
                    shutil.copyfile(picture, target)


if __name__ == "__main__":
    main()
