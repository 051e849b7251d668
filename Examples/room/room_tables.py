# SPDX-License-Identifier: BSD-3-Clause
"""The room's tables in Markdown."""
import numpy as np


def markdown(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" * 2 + "|---:" * (len(head) - 2) + "|"]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def _cm(value):
    return "-" if np.isnan(value) else f"{100 * value:.1f}"


def _share(part, whole):
    return f"{100 * part / max(whole, 1):.1f} %"


def summary(rows, names):
    return markdown(
        ["held out", "", "beams", "answered", "from beyond the desk", "with an echo in both", "missed",
         "without surface on the axis", "missed from its own scan", "false"],
        [[names[r["sensor"]], "", r["beams"], _share(r["answered"], r["beams"]), r["beyond the desk"],
          *(_share(r[k], r["beyond the desk"]) for k in ("with both", "missed", "no surface on the axis",
                                                         "missed from its own scan")), r["false"]] for r in rows])


def errors(rows, names):
    return markdown(
        ["held out", "run", "beams", "median (cm)", "spread (cm)", "5 % (cm)", "95 % (cm)", "within 2 cm", "5 cm",
         "10 cm"],
        [[names[r["sensor"]], r["what"], r["beams"],
          *(_cm(r[k]) for k in ("median", "spread", "p05", "p95")),
          *(_share(r[k], 1) for k in ("in2cm", "in5cm", "in10cm"))] for r in rows])


def clouds(rows, names):
    return markdown(
        ["held out", "points", "real", "simulated", "RMSE, real to simulated (m)", "RMSE, simulated to real (m)",
         "Hausdorff (m)", "density-aware Chamfer"],
        [[names[r["sensor"]], r["what"], r["real"], r["simulated"], f"{r['rmse_rs']:.3f}",
          f"{r['rmse_sr']:.3f}", f"{r['hausdorff']:.2f}", f"{r['density_aware_chamfer']:.2f}"] for r in rows])


def parts(rows, names):
    return markdown(
        ["held out", "", "real points from the surface: median (cm)", "90 % (cm)", "beam against its axis: spread (cm)",
         "range noise of the sensor (cm)", "fitted pose: moved (cm)", "turned (deg)"],
        [[names[r["sensor"]], "", *(_cm(r[k]) for k in (
            "from the surface, median", "from the surface, 90 %", "beam against axis, spread", "range noise", "moved")),
          f"{r['turned']:.2f}"]
         for r in rows])


def intensity(rows, names):
    """Regions met by at least 100 beams; intensity.csv has all."""
    models = [k[5:] for k in rows[0] if k.startswith("rank ")]
    return markdown(
        ["held out", "region", "beams", *(f"rank correlation, {m}" for m in models), *(f"factor, {m}" for m in models)],
        [[names[r["sensor"]], r["region"], r["beams"],
          *("-" if np.isnan(r[f"{k} {m}"]) else f"{r[f'{k} {m}']:.2f}" for k in ("rank", "factor") for m in models)]
         for r in rows if r["beams"] >= 100])


def tables(result, names):
    return {"room-summary": summary(result.summary, names), "room-errors": errors(result.errors, names),
            "room-clouds": clouds(result.clouds, names), "room-parts": parts(result.summary, names),
            "room-intensity": intensity(result.intensity, names)}
