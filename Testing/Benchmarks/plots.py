# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the benchmarks: ours against Embree, Fig. 9, 10 and 11 redrawn, epsilon, growth."""
import pathlib
from collections import OrderedDict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

MARKS = "os^vDPX*hp<>"


def curves(rows, x, group, y):
    """{group: ([x], [y])} in the order of the rows."""
    result = OrderedDict()
    for row in rows:
        xs, ys = result.setdefault(group(row), ([], []))
        xs.append(row[x])
        ys.append(row[y])
    return result


def growth_series(rows):
    """{contender: ([triangles], [ns per ray])}"""
    return curves([{**r, "ns": 1e9 * r["median_s"] / r["rays"]} for r in rows], "triangles",
                  lambda r: r["contender"], "ns")


def finish(figure, axes, file, xlabel, ylabel, title=None):
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    if title:
        axes.set_title(title, fontsize=10)
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    plt.close(figure)
    return file


def plot_curves(series, file, ylabel, title, dashed=lambda name: False):
    figure, axes = plt.subplots(figsize=(7.5, 5))
    for i, (name, (xs, ys)) in enumerate(series.items()):
        axes.loglog(xs, ys, marker=MARKS[i % len(MARKS)], markersize=4, linewidth=1.2, label=name,
                    linestyle="--" if dashed(name) else "-")
    return finish(figure, axes, file, "triangles", ylabel, title)


def plot_matrix(rows, file):
    """Every cell of one thread: Embree's best mode over ours."""
    best = OrderedDict()
    for r in rows:
        key = (r["scene"], r["channels"], r["rays_per_beam"], r["half_beamwidth"], r["threads"])
        best.setdefault(key, {})[r["contender"]] = r["median_s"]
    scenes = list(OrderedDict((k[0], None) for k in best))
    figure, axes = plt.subplots(figsize=(7.5, 5))
    for i, n in enumerate(sorted({k[2] for k in best})):
        points = [(scenes.index(k[0]) + 0.18 * (i - 1.5),
                   min(t["embree single"], t["embree packets"]) / t["ours"]) for k, t in best.items() if k[2] == n]
        axes.semilogy(*zip(*points), MARKS[i], markersize=4, alpha=0.7, label=f"N = {n:g}")
    axes.axhline(1.0, color="black", linewidth=1)
    axes.axhline(3.0, color="black", linewidth=0.7, linestyle=":")
    axes.set_xticks(range(len(scenes)), scenes, rotation=40, ha="right", fontsize=8)
    return finish(figure, axes, file, "", "time of Embree's best mode / ours",
                  "Every cell: half-beamwidths 1e-4 to 2e-2, one and two threads")


def plot_figure9(rows, file):
    """Building and detection side by side; the paper's four trees, and boxes eight at a time."""
    rows = [r for r in rows if r["split_rule"][:3] in ("BVH", "k-D") and r["volume"] != "OBB"]
    figure, panes = plt.subplots(1, 3, figsize=(13, 4.5))
    for axes, (part, word) in zip(panes, (("build_s", "building"), ("detection_s", "detection"), ("total_s", "total"))):
        series = curves(rows, "triangles", lambda r: f"{r['split_rule']}, {r['volume']}", part)
        for i, (name, (xs, ys)) in enumerate(series.items()):
            axes.loglog(xs, ys, marker=MARKS[i % len(MARKS)], markersize=4, linewidth=1.2, label=name,
                        linestyle="--" if "eight" in name else "-")
        axes.set_xlabel("triangles")
        axes.set_ylabel(f"{word}, s")
        axes.grid(True, which="major", alpha=0.3)
    panes[0].legend(fontsize=7)
    figure.suptitle("Fig. 9: split rules and bounding volumes, every beam by itself", fontsize=10)
    figure.tight_layout()
    figure.savefig(file, dpi=100)
    plt.close(figure)
    return file


def plot_epsilon(rows, file):
    """Share of the echoes' energy that is lost, over epsilon."""
    figure, axes = plt.subplots(figsize=(7.5, 5))
    scenes = OrderedDict()
    for r in rows:
        scenes.setdefault(r["scene"], []).append(r)
    for i, (scene, (off, *choices)) in enumerate(scenes.items()):
        lost = [max(1e-9, 1.0 - r["energy_j"] / off["energy_j"]) for r in choices]
        axes.loglog([r["fraction"] for r in choices], lost, marker=MARKS[i % len(MARKS)], markersize=5, linewidth=1.2,
                    label=scene)
    for x, word in ((4.0, "Qlow/N"), (400.0, "Qlow")):
        axes.axvline(x, color="black", linewidth=0.7, linestyle=":")
        axes.text(x, 2e-9, f" {word}", fontsize=8)
    axes.set_xlim(4e-7, 4e3)
    return finish(figure, axes, file, "epsilon (LightEnergyFraction)", "energy lost / energy of all echoes (at least 1e-9)",
                  "Light-energy constraint: what is lost")


def make(folder, read):
    """Draws what there are results for; returns the files."""
    folder = pathlib.Path(folder)
    files = []

    def draw(name, rows, function):
        if rows:
            files.append(function(rows, folder / f"{name}.png"))

    draw("matrix", read(folder, "matrix"), plot_matrix)
    def spheres(name):
        return [r for r in read(folder, name) if r["scene"].startswith("sphere")]

    draw("figure9", spheres("figure9"), plot_figure9)
    draw("figure10", spheres("figure10"), lambda rows, file: plot_curves(
        curves(rows, "triangles", lambda r: r["method"], "scan_s"), file, "scan, s", "Fig. 10: methods, trees ready",
        dashed=lambda name: "one reflection" in name))
    draw("figure11", spheres("figure11"), lambda rows, file: plot_curves(
        curves(rows, "triangles", lambda r: r["switches"], "best_s"), file, "scan, s",
        "Fig. 11: which accelerations are on", dashed=lambda name: "batch" not in name))
    draw("epsilon", read(folder, "epsilon"), plot_epsilon)
    draw("growth", read(folder, "growth"), lambda rows, file: plot_curves(
        growth_series(rows), file, "ns per ray", "The same facade, more and more triangles hidden behind it"))
    return files
