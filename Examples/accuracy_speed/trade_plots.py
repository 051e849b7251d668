# SPDX-License-Identifier: BSD-3-Clause
"""Error against time, one picture for each kind of error: every setting a dot, the front a line, presets named."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import trade_results  # noqa: E402
from trade_grid import PRESETS  # noqa: E402

MARKS = "os^vDPX<>ph8d"
COLORS = ("tab:blue", "tab:green", "tab:orange", "tab:purple", "tab:brown", "tab:olive", "tab:gray", "tab:pink",
          "tab:cyan", "navy", "darkgreen", "goldenrod")


def groups(results):
    """{words of the legend: results}; presets are one group."""
    found = {}
    for result in results:
        name = result.choice.family
        found.setdefault("presets" if name in PRESETS else name, []).append(result)
    return found


def draw(results, subject, reference, kind, file):
    figure, axes = plt.subplots(figsize=(8.5, 6))
    shown = groups(results)
    # Zeros have no place on a logarithmic axis: they lie on its lower end.
    least = min((r.error(kind) for r in results if r.error(kind) > 0), default=1e-6)
    floor = 0.5 * least

    def places(some):
        return [r.median("cpu") for r in some], [max(r.error(kind), floor) for r in some]

    for i, (name, some) in enumerate((n, s) for n, s in shown.items() if n != "presets"):
        x, y = places(some)
        axes.plot(x, y, MARKS[i % len(MARKS)], markersize=5, alpha=0.8, label=name, color=COLORS[i % len(COLORS)])
    x, y = places(trade_results.front(results, kind))
    axes.plot(x, y, "-", color="black", linewidth=1.2, label="front", zorder=1)
    for result in shown.get("presets", []):
        x, y = places([result])
        axes.plot(x, y, "*", markersize=15, color="crimson", markeredgecolor="white", zorder=5)
        axes.annotate(result.choice.family, (x[0], y[0]), xytext=(0, 10), textcoords="offset points", color="crimson",
                      weight="bold", ha="center", zorder=6)
    if kind != "detection" and reference.own[kind] > 0:
        axes.axhline(reference.own[kind], color="grey", linestyle=":", linewidth=1)
        axes.annotate("the reference's own error", (0.99, reference.own[kind]), xycoords=("axes fraction", "data"),
                      ha="right", va="bottom", fontsize=8, color="grey")
    axes.margins(x=0.1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(f"time of one core for {subject.number_of_beams} beams (s)")
    axes.set_ylabel(trade_results.KINDS[kind])
    strong = int(reference.strong.sum())
    axes.set_title(f"{subject.title}: {strong} echoes of at least twice the lower limit", fontsize=11)
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(fontsize=8, ncol=2, loc="upper right" if kind != "detection" else "best")
    figure.tight_layout()
    figure.savefig(file, dpi=110)
    plt.close(figure)
