#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tables (Markdown) and plots (PNG) of a run of the benchmarks, from its CSV files.

    report.py FOLDER            tables.md and *.png into the same folder
    report.py FOLDER --page     also into Documentation/results/speed.md and Documentation/images/speed-*.png
    report.py FOLDER --page movers    also into Documentation/results/movers.md
    report.py FOLDER --page paper-figures    also into Documentation/results/paper-figures.md and its pictures

In a page, tables stand between <!-- table: NAME --> and <!-- end -->; the words around them stay as they are."""
import math
import pathlib
import re
import shutil
import sys
from collections import OrderedDict

import numpy as np
import paper_figures
import plots
from results import count, fit, ratio_text, read, seconds, table

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "Documentation" / "results"
AIRPORTS = ("Hongqiao", "Hongqiao, structures", "Hongqiao, everything", "Honolulu")


# ---------------------------------------------------------------------------------------------- the matrix

def cells(folder):
    """{(scene, channels, N, half-beamwidth, threads): {contender: ns per ray}}, and the triangles of each scene."""
    found, triangles = OrderedDict(), OrderedDict()
    for r in read(folder, "matrix"):
        key = (r["scene"], int(r["channels"]), int(r["rays_per_beam"]), r["half_beamwidth"], int(r["threads"]))
        found.setdefault(key, {})[r["contender"]] = 1e9 * r["median_s"] / (r["beams"] * r["rays_per_beam"])
        triangles[r["scene"]] = int(r["triangles"])
    return found, triangles


def tracing_seconds(folder):
    """{cell: s of ours}"""
    return {(r["scene"], int(r["channels"]), int(r["rays_per_beam"]), r["half_beamwidth"], int(r["threads"])):
            r["median_s"] for r in read(folder, "matrix") if r["contender"] == "ours"}


def best_of_embree(times):
    return min(times["embree single"], times["embree packets"])


def summary_table(found):
    """For each number of rays: the span of Embree's best mode over ours, and in how many cells Embree is faster."""
    rows = []
    for n in sorted({k[2] for k in found}, reverse=True):
        ratios = {k: best_of_embree(t) / t["ours"] for k, t in found.items() if k[2] == n}
        spans = [[v for k, v in ratios.items() if k[0] in scenes] for scenes in (AIRPORTS, {k[0] for k in ratios})]
        rows.append([count(n), *(" to ".join(ratio_text(f(v)).strip("*") for f in (min, max)) if v else "-"
                                 for v in spans), f"{sum(v < 1.0 for v in ratios.values())} of {len(ratios)}"])
    return table(["rays per beam", "Embree's best / ours, airports", "all scenes", "cells where Embree is faster"], rows)


def matrix_table(found, triangles, threads):
    """Embree's best mode over ours, one row a scene, one column for each N and half-beamwidth."""
    columns = sorted({k[2:4] for k in found if k[4] == threads})
    channels = {}
    for k in found:
        channels.setdefault(k[0], k[1])
    rows = []
    for scene in triangles:
        row = [found.get((scene, channels[scene], *c, threads)) for c in columns]
        if any(row):
            rows.append([scene, *(ratio_text(best_of_embree(t) / t["ours"]) if t else "" for t in row)])
    return table(["scene", *(f"N = {n}, {w:g}" for n, w in columns)], rows)


def airport_table(found, triangles):
    """ns per ray of the airports at N = 100 and the paper's half-beamwidth."""
    rows = []
    for (scene, channels, n, width, threads), t in found.items():
        if scene in AIRPORTS and n == 100 and width == 5.6e-3 and "ours per ray" in t:
            names = ("ours", "ours beams", "ours per ray", "embree packets", "embree single",
                     "embree robust packets", "embree robust single")
            best = best_of_embree(t)
            rows.append([f"{scene}, {channels} channels", count(triangles[scene]), threads,
                         *(f"{t[name]:.2f}" for name in names), f"{best / t['ours']:.1f}",
                         f"{t['embree single'] / t['ours']:.1f}"])
    return table(["scene", "triangles", "threads", "ours", "every beam alone", "one descent per ray",
                  "Embree packets", "Embree single", "robust packets", "robust single", "best / ours",
                  "single / ours"], rows)


def hits_table(folder):
    groups = OrderedDict()
    for name in ("hits", "locators"):
        for r in read(folder, name):
            if r["rays"] != "":
                g = groups.setdefault(r["contender"], [0, 0, 0, 0])
                for i, key in enumerate(("rays", "hits", "differ", "at_edges")):
                    g[i] += int(r[key])
    return table(["against", "rays compared", "hits", "ranges that differ by more than 1e-3", "of those, at edges",
                  "unexplained"],
                 [[name, *map(count, g), f"{(g[2] - g[3]) / max(g[0], 1):.1e}"] for name, g in groups.items()])


# ---------------------------------------------------------------------------------------------- the rest

def machine_table(folder):
    rows = [[r["what"], str(r["is"]).removesuffix(".0")]
            for name in ("machine", "libraries") for r in read(folder, name)]
    return table(["machine", ""], rows, words=True)


def locator_table(folder):
    """One row a scene, one column a peer."""
    peers, scenes = OrderedDict(), OrderedDict()
    for r in read(folder, "locators"):
        peers[r["contender"]] = None
        if r["ns_per_ray"] != "":
            build = f"{seconds(r['build_s'])}; " if r["build_s"] else ""
            scenes.setdefault(r["scene"], {})[r["contender"]] = f"{build}{r['ns_per_ray']:,.0f}; {r['ratio']:,.0f}"
    return table(["scene", *peers], [[scene, *(cells.get(peer, "-") for peer in peers)]
                                     for scene, cells in scenes.items()])


def build_table(folder):
    """One row a scene: ours, Embree and Embree / ours with each number of threads, and the bytes per triangle."""
    found, scenes = OrderedDict(), OrderedDict()
    for r in read(folder, "build"):
        scenes[r["scene"]] = r["triangles"]
        found[r["scene"], int(r["threads"])] = r
    threads = sorted({t for _, t in found})
    rows = []
    for scene, triangles in scenes.items():
        row = [scene, count(triangles)]
        for t in threads:
            r = found.get((scene, t))
            row += [seconds(r["ours_s"]), seconds(r["embree_s"]), ratio_text(r["ratio"])] if r else ["-"] * 3
        first = found[scene, min(t for s, t in found if s == scene)]
        rows.append([*row, *(f"{first[f'{who}_bytes_per_triangle']:.0f}" for who in ("ours", "embree"))])
    names = [f"{t} thread{'s' * (t > 1)}: ours" for t in threads]
    columns = [column for name in names for column in (name, "Embree", "Embree / ours")]
    return table(["scene", "triangles", *columns, "bytes per triangle, ours", "Embree"], rows)


def filter_runs(folder):
    runs = OrderedDict()
    for r in read(folder, "filter"):
        key = (r["scene"], int(r["channels"]), int(r["threads"]))
        runs.setdefault(key, OrderedDict())[r["stage"]] = r["median_s"]
    return runs


def filter_table(folder):
    runs = OrderedDict((k, r) for k, r in filter_runs(folder).items() if (k[1] == 32) == (k[2] == 2))
    stages = list(OrderedDict((s, None) for run in runs.values() for s in run))
    rows = [[stage, *(seconds(run.get(stage, "")) for run in runs.values())] for stage in stages]
    update = "Update(), tree ready"
    rows.append(["Update() / tracing primary rays",
                 *(f"{r[update] / r['tracing primary rays']:.1f}" for r in runs.values())])
    rows.append(["Update() / (scan - energies): primary rays, paths, and all that finds them",
                 *(f"{r[update] / (r['scan without VTK'] - r['energies, hits known']):.1f}" for r in runs.values())])
    for stage in (s for s in stages if s.startswith("re-lit")):
        rows.append([f"Update() / {stage}", *(f"{r[update] / r[stage]:.1f}" for r in runs.values())])
    return table(["", *(f"{s}, {c} channels, {t} thread{'s' * (t > 1)}" for s, c, t in runs)], rows)


def scan_table(folder):
    scenes = OrderedDict()
    for r in read(folder, "scan"):
        scenes.setdefault(r["scene"], OrderedDict())[r["contender"]] = (r["median_s"], r["speed"])
    contenders = list(OrderedDict((name, None) for times in scenes.values() for name in times))
    return table(["scene", *contenders],
                 [[scene, *(f"{seconds(times[name][0])} ({times[name][1]:.2f})" for name in contenders)]
                  for scene, times in scenes.items()])


def front_runs(folder, reflections):
    """{scene: {contender: (seconds, rms, wrong)}}"""
    scenes = OrderedDict()
    for r in read(folder, "front"):
        if int(r["reflections"]) == reflections:
            scenes.setdefault(r["scene"], OrderedDict())[r["contender"]] = (r["best_s"], r["rms"], r["wrong"])
    return scenes


def front_table(folder, reflections):
    scenes = front_runs(folder, reflections)
    names = [n for n in list(OrderedDict((n, None) for runs in scenes.values() for n in runs)) if "other" not in n]
    return table(["milliseconds; rms error of energy, echoes missed or invented", *names],
                 [[scene, *(f"{1e3 * runs[n][0]:.0f}; {100 * runs[n][1]:.2g} %, {100 * runs[n][2]:.2g} %" for n in names)]
                  for scene, runs in scenes.items()])


def seconds_to(runs, prefix, wanted):
    """Seconds to an error, between the measured ones along straight lines of the logarithms; None beyond them."""
    points = sorted((r[1], r[0]) for name, r in runs.items() if name.startswith(prefix) and "other" not in name)
    for (better, slower), (worse, faster) in zip(points, points[1:]):
        if better <= wanted <= worse and slower > faster:
            share = np.log(wanted / better) / np.log(worse / better)
            return float(np.exp(np.log(slower) + share * np.log(faster / slower)))
    return None


def front_ratio_table(folder):
    """How many times as long Embree's packets alone trace for the same error as a whole scan by cells takes."""
    rows = []
    for scene, runs in front_runs(folder, 1).items():
        row = [scene]
        for wanted in (0.01, 0.003):
            ours, theirs = seconds_to(runs, "cells", wanted), seconds_to(runs, "Embree", wanted)
            least = min((r for name, r in runs.items() if name.startswith("cells") and "other" not in name), key=lambda r: r[0])
            if ours is None and least[1] <= wanted:
                ours = least[0]  # the fastest is better than that
            more = ""
            if theirs is None:  # all those measured are worse
                more, theirs = "more than ", max(r[0] for name, r in runs.items() if name.startswith("Embree"))
            row.append("-" if ours is None else f"{more}{theirs / ours:.2g}")
        fresh = runs["cells, 100"][0]
        row += [f"{fresh / runs[f'cells, 100, other {what}'][0]:.2g}" for what in ("air", "limit")]
        rows.append(row)
    return table(["Embree's packets over a scan by cells", "to 1 % rms", "to 0.3 % rms", "new scan over other air",
                  "over another limit"], rows)


def movers_table(folder):
    """One row a scene: times of a scan whose static hits are known, by the number of birds."""
    scenes = OrderedDict()
    for r in read(folder, "movers"):
        scenes.setdefault((r["scene"], r["triangles"]), {})[int(r["birds"])] = (
            f"{seconds(r['scan_s'])} ({count(r['touched_beams'])})")
    counts = sorted({birds for times in scenes.values() for birds in times})
    return table(["scene", "triangles", *(f"{count(n)} birds" for n in counts)],
                 [[scene, count(triangles), *(times.get(n, "-") for n in counts)]
                  for (scene, triangles), times in scenes.items()])


def rebuilt_table(folder):
    """One row a scene: movers against a tree for each beam."""
    rows = [[r["scene"], seconds(r["scan_s"]), seconds(r["above_still_s"]), seconds(r["one_time_s"]),
             seconds(r["build_s"]), seconds(r["each_beam_s"]), f"**{r['ratio']:,.0f}**",
             seconds(r["each_touched_beam_s"]), f"{r['ratio_touched']:,.0f}", count(r["sampled_beams"]),
             f"{count(r['seeing_compared'])} of {count(r['seeing_beams'])}"]
            for r in read(folder, "movers") if r["ratio"] != ""]
    return table(["scene", "movers", "of it above no birds", "tree and scan of one time", "one tree",
                  "a tree for each beam", "over movers", "a tree for each touched beam", "over movers",
                  "beams sampled", "beams with an echo of a bird, compared"], rows)


def memory_table(folder):
    return table(["scene", "triangles", "surfaces", "tree and merged surfaces", "most while the tree is built",
                  "most while scanned (61,440 beams)", "echoes"],
                 [[r["scene"], count(r["triangles"]), *(f"{r[k]:.0f} MiB" for k in (
                     "surfaces_mib", "tree_mib", "peak_of_tree_build_mib", "peak_of_scan_mib")), count(r["echoes"])]
                  for r in read(folder, "memory")])


def growth_fit(folder):
    """{contender: (ns per ray and doubling, ns at 5,000 triangles, R^2, exponent of a power law)}"""
    series = plots.growth_series(read(folder, "growth"))
    result = OrderedDict()
    for name, (ns, times) in series.items():
        slope, intercept, quality = fit([math.log2(n) for n in ns], times)
        power, _, _ = fit([math.log(n) for n in ns], [math.log(t) for t in times])
        result[name] = (slope, intercept + slope * math.log2(ns[0]), quality, power)
    return result


def growth_table(folder):
    return table(["contender", "ns per ray at the start", "more with each doubling", "R^2 of that line",
                  "exponent of a power law"],
                 [[name, f"{start:.2f}", f"{slope:+.3f} ns ({100 * slope / start:+.1f} %)", f"{quality:.2f}",
                   f"{power:.3f}"] for name, (slope, start, quality, power) in growth_fit(folder).items()])


# ---------------------------------------------------------------------------------------------- the aims

def aims(folder):
    """(what, aim, measured, met) of everything that is asked of the speed."""
    found, _ = cells(folder)
    ratios = {k: best_of_embree(t) / t["ours"] for k, t in found.items()}
    airport = {k: v for k, v in ratios.items() if k[0] in AIRPORTS and k[2] == 100 and k[3] == 5.6e-3}
    rows = []

    def add(what, aim, values, least=True, form="{:.2f}"):
        values = list(values)
        if values:
            worst = min(values) if least else max(values)
            rows.append((what, f"{'at least' if least else 'at most'} {aim:g}", form.format(worst),
                         "yes" if (worst >= aim if least else worst <= aim) else "**no**"))

    add("airports, N = 100: Embree's best mode / ours", 3.0, airport.values())
    add("airports, N = 100: Embree's single rays / ours", 15.0,
        (found[k]["embree single"] / found[k]["ours"] for k in airport))
    add("airports, N = 100: best VTK locator / ours", 50.0,
        (r["ratio"] for r in read(folder, "locators") if r["scene"] in AIRPORTS and r["ratio"] != ""))
    add("every cell: Embree's best mode / ours", 1.0, ratios.values())
    if ratios:
        short = sum(v < 1.0 for v in ratios.values())
        rows.append(("cells that fall short", "0", f"{short} of {len(ratios)}", "yes" if short == 0 else "**no**"))
    build = read(folder, "build")
    add("tree build: Embree / ours", 1.0, (r["ratio"] for r in build))
    add("bytes per triangle: ours / Embree", 1.0,
        (r["ours_bytes_per_triangle"] / r["embree_bytes_per_triangle"] for r in build), least=False)
    runs = filter_runs(folder)
    update = "Update(), tree ready"
    add("Update() with the tree ready / tracing primary rays", 2.0,
        (r[update] / r["tracing primary rays"] for r in runs.values()), least=False)
    add("Update() / re-lit Update(), 32 channels", 10.0,
        (r[update] / v for k, r in runs.items() if k[1] == 32 for s, v in r.items() if s.startswith("re-lit")),
        form="{:.1f}")
    add("one thread / two, where one takes over 50 ms: Update()", 1.8,
        (r[update] / runs[k[0], k[1], 2][update] for k, r in runs.items()
         if k[2] == 1 and (k[0], k[1], 2) in runs and r[update] > 0.05))
    long = {k[:4]: t for k, t in tracing_seconds(folder).items() if k[4] == 1 and t > 0.05}
    both = tracing_seconds(folder)
    add("one thread / two, where one takes over 50 ms: tracing", 1.8,
        (t / both[*k, 2] for k, t in long.items() if (*k, 2) in both))
    for name, (_, _, _, power) in growth_fit(folder).items():
        if name == "ours":
            rows.append(("growth with hidden triangles: exponent of a power law (1 would be linear)", "near 0",
                         f"{power:.3f}", "yes" if power < 0.1 else "**no**"))
    return rows


def tables(folder):
    found, triangles = cells(folder)
    return OrderedDict([
        ("machine", machine_table(folder)),
        ("summary", summary_table(found)),
        ("aims", table(["what", "aim", "worst measured", "met"], aims(folder))),
        ("airports", airport_table(found, triangles)),
        ("matrix-1", matrix_table(found, triangles, 1)),
        ("matrix-2", matrix_table(found, triangles, 2)),
        ("hits", hits_table(folder)),
        ("locators", locator_table(folder)),
        ("build", build_table(folder)),
        ("scan", scan_table(folder)),
        ("front-1", front_table(folder, 1)),
        ("front-2", front_table(folder, 2)),
        ("front-ratios", front_ratio_table(folder)),
        ("filter", filter_table(folder)),
        ("memory", memory_table(folder)),
        ("movers", movers_table(folder)),
        ("rebuilt", rebuilt_table(folder)),
        ("growth", growth_table(folder)),
        *paper_figures.tables(folder).items(),
    ])


def make(folder):
    """Writes tables.md and the plots; returns the files that should be there now."""
    folder = pathlib.Path(folder)
    made = tables(folder)
    text = "\n".join(f"## {name}\n\n{body}" for name, body in made.items())
    (folder / "tables.md").write_text(text, encoding="utf-8")
    return [folder / "tables.md", *plots.make(folder, read)]


def put_into_page(folder, name):
    """Tables that were measured and plots into a page of results."""
    page = RESULTS / f"{name}.md"
    text = page.read_text(encoding="utf-8")
    for key, body in tables(folder).items():
        if body.count("\n") < 2:
            continue  # no row
        block = rf"(<!-- table: {key} -->\n).*?(<!-- end -->)"
        text = re.sub(block, lambda m, body=body: m[1] + body + m[2], text, flags=re.S)
    page.write_text(text, encoding="utf-8")
    for picture in pathlib.Path(folder).glob("*.png"):
        target = ROOT / "Documentation" / "images" / f"{name.split('-')[0]}-{picture.name}"
        if f"images/{target.name}" in text:
            shutil.copyfile(picture, target)


def main():
    folder, *words = sys.argv[1:]
    make(folder)
    if words[:1] == ["--page"]:
        put_into_page(folder, words[1] if len(words) > 1 else "speed")


if __name__ == "__main__":
    main()
