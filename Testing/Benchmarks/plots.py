# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the benchmarks: ours against Embree, Fig. 9, 10 and 11 redrawn, epsilon."""
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import paper_figures  # noqa: E402
from results import pivot, read  # noqa: E402

MARKS = "os^vDPX*hp<>"


def curves(rows, x, group, y):
    """{group: ([x], [y])} in the order of the rows."""
    found = {}
    for row in rows:
        xs, ys = found.setdefault(group(row), ([], []))
        xs.append(row[x])
        ys.append(row[y])
    return found


def draw(axes, series, ylabel, dashed=lambda name: False, xlabel="triangles", title=None):
    for i, (name, (xs, ys)) in enumerate(series.items()):
        axes.loglog(xs, ys, marker=MARKS[i % len(MARKS)], markersize=4, linewidth=1.2, label=name,
                    linestyle="--" if dashed(name) else "-")
    axes.set(xlabel=xlabel, ylabel=ylabel)
    axes.set_title(title, fontsize=10)
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=7)


def matrix(rows, axes):
    """Every cell: Embree's best mode divided by this project's time."""
    found = pivot(rows, lambda r: (r["scene"], r["rays_per_beam"], r["channels"], r["half_beamwidth"], r["threads"]),
                  lambda r: r["contender"], lambda r: r["median_s"])
    scenes = list(dict.fromkeys(k[0] for k in found))
    for i, n in enumerate(sorted({k[1] for k in found})):
        points = [(scenes.index(k[0]) + 0.18 * (i - 1.5), min(t["embree single"], t["embree packets"]) / t["ours"])
                  for k, t in found.items() if k[1] == n]
        axes.semilogy(*zip(*points), MARKS[i], markersize=4, alpha=0.7, label=f"N = {n:g}")
    axes.axhline(1.0, color="black", linewidth=1)
    axes.set_xticks(range(len(scenes)), scenes, rotation=40, ha="right", fontsize=8)
    draw(axes, {}, "time of Embree's best mode / time of this project", xlabel="",
         title="Every cell: half-beamwidths 1e-4 to 2e-2, one and two threads")


def figure9(rows, *panes):
    """Building and detection side by side; the paper's four trees, and boxes eight at a time."""
    for axes, (part, word) in zip(panes, (("build_s", "building"), ("detection_s", "detection"), ("total_s", "total"))):
        draw(axes, curves(spheres(rows), "triangles", lambda r: f"{r['split_rule']}, {r['volume']}", part), f"{word}, s",
             lambda name: "eight" in name, title=f"Fig. 9: {word}, every beam by itself")


def figure10(rows, axes):
    draw(axes, curves(on_preset(rows), "triangles", lambda r: r["method"], "scan_s"), "scan, s",
         lambda name: "one reflection" in name, title="Fig. 10: methods, trees ready")


def figure11(rows, axes):
    others = {*paper_figures.READINGS, "share"} - {paper_figures.PRESET}
    wanted = [r for r in on_preset(rows) if not others.intersection(r["switches"].split(" + "))]
    draw(axes, curves(wanted, "triangles", lambda r: r["switches"], "best_s"), "scan, s",
         lambda name: "batch" not in name, title="Fig. 11: which accelerations are on")


def on_preset(rows):
    """Spheres, on the tree of preset Paper."""
    return [r for r in spheres(rows) if r["boxes"] == "two"]


def spheres(rows):
    return [r for r in rows if r["scene"].startswith("sphere")]


def epsilon(rows, axes):
    """Share of the echoes' energy that is lost, over epsilon."""
    off = {r["scene"]: r["energy_j"] for r in rows if r["choice"] == "off"}
    lost = [{**r, "lost": max(1e-9, 1.0 - r["energy_j"] / off[r["scene"]])} for r in rows if r["choice"] != "off"]
    for x, word in ((4.0, "Qlow/N"), (400.0, "Qlow")):
        axes.axvline(x, color="black", linewidth=0.7, linestyle=":")
        axes.text(x, 2e-9, f" {word}", fontsize=8)
    axes.set_xlim(4e-7, 4e3)
    draw(axes, curves(lost, "fraction", lambda r: r["scene"], "lost"), "energy lost / energy of all echoes (at least 1e-9)",
         xlabel="epsilon (LightEnergyFraction)", title="Light-energy constraint: what is lost")


def make(folder):
    """Draws what there are results for; returns the files."""
    files = []
    for function in (matrix, figure9, figure10, figure11, epsilon):
        rows = read(folder, function.__name__)
        if rows:
            panes = 3 if function is figure9 else 1
            figure, axes = plt.subplots(1, panes, figsize=(13, 4.5) if panes > 1 else (7.5, 5), squeeze=False)
            function(rows, *axes[0])
            figure.tight_layout()
            files.append(pathlib.Path(folder) / f"{function.__name__}.png")
            figure.savefig(files[-1], dpi=100)
            plt.close(figure)
    return files
