# SPDX-License-Identifier: BSD-3-Clause
"""Holds fit.py to known materials: the 86 Blinn-Phong fits to the MERL database by Ngan, Durand and Matusik (EGSR
2005).

    Testing/Studies/run.py check_fit --data DATA      default: AVIANLIDAR_DATA_DIR; about four minutes

The MERL tables themselves are not at hand. For each material three tables are written in their format and fitted: this
project's model with the material's numbers, the same with noise of 10 %, and the Blinn-Phong lobe of the fit. Leaves
tables of what comes back (Documentation/evidence/materials.md) and a picture.
"""
import pathlib
import re
import tempfile

import numpy as np

import fit
import tools
from running import argument, rows_of, study

FOLDER = "reflectance/merl_ngan2005_fits"
NOISE = 0.1
WINDOWS = (2.0, 30.0, 180.0)  # deg from straight back
SHOWN = "silver-metallic-paint"


def blinn_phong(g, kd, ks, n):
    """Ngan, Durand, Matusik: kd/pi + ks (n + 2)/(2 pi) cos^n of the half vector, 1/sr."""
    return kd / np.pi + ks * (n + 2) / (2 * np.pi) * np.exp(0.5 * n * np.log1p(-g.sin2_half))


def write_merl(file, red):
    """A MERL table of the red values (1/sr) of all cells; the other channels are 0."""
    with open(file, "wb") as stream:
        np.array(fit.MERL_SHAPE, "<i4").tofile(stream)
        (red / fit.MERL_SCALE["red"]).astype("<f8").tofile(stream)
        np.zeros(2 * red.size).tofile(stream)


def materials(folder):
    """name: (kd, ks, n), red; and Ward's alpha of the same names."""
    rows = {row["material"]: (float(row["kd_r"]), float(row["ks_r"]), float(row["n"]))
            for row in rows_of(folder / "ngan_blinnphong.csv")}
    text = (folder / "ngan_ward.fit").read_text(encoding="utf-8")
    return rows, {name: float(alpha) for name, alpha in re.findall(r"^(\S+) = .*roughness = ([\d.e+-]+)", text, re.M)}


def fitted(file, within=30.0, model="LambertBlinnPhong"):
    """The material of a table, its misfits, and what they are of."""
    g, brdf = fit.read_table(file)
    usable = fit.is_usable(g, brdf)
    g, measured = g[usable], (brdf * g.cos_outgoing)[usable]
    used = g.off_back() <= within
    material = fit.fit(model, g[used], measured[used])
    return material, *fit.misfit(model, material, g[used], measured[used]), g, measured


@study(argument("--only", nargs="+", metavar="MATERIAL", help="default: all 86"), data=[FOLDER])
def main(options):
    rows, ward = materials(options.data / FOLDER)
    g, _ = fit.merl_geometry((1, 1, 1))
    random = np.random.default_rng(0)
    off = {"without noise": [], f"with noise of {100 * NOISE:.0f} %": []}
    misfits, ratios, lines = {}, {}, []
    for name in options.only or rows:
        if name not in rows:
            raise ValueError(f"there is no material {name} among {', '.join(rows)}")
        kd, ks, n = rows[name]
        own = (kd, 4 * ks, n / 4 if ks else 0.0)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / f"{name}.binary"
            exact = fit.reflected("LambertBlinnPhong", own, g) / np.maximum(g.cos_outgoing, 1e-6)
            for what, factor in zip(off, (1.0, random.lognormal(0, NOISE, exact.size))):
                write_merl(file, np.where(g.cos_outgoing > 0, exact * factor, -1.0))
                off[what].append([abs(value - true) / max(true, 1e-9) for value, true in zip(fitted(file)[0], own)])
            write_merl(file, blinn_phong(g, kd, ks, n))
            found = {(model, within): fitted(file, within, model) for model in fit.MODELS for within in WINDOWS}
        for key, (material, log, linear, *_) in found.items():
            misfits.setdefault(key, []).append((log, linear))
            if key[0] == "LambertBlinnPhong" and ks:
                ratios.setdefault(key[1], []).append((material[0] / kd, material[1] / ks, material[2] / n))
        material, log, linear, sampled, measured = found["LambertBlinnPhong", 30.0]
        lines.append((name, kd, ks, f"{n:g}", *(f"{value:.4g}" for value in material), f"{log:.3f}", f"{linear:.2g}",
                      f"{found['LambertBlinnPhong', 2.0][1]:.3f}", f"{found['LambertBlinnPhong', 180.0][1]:.3f}"))
        if name == SHOWN:
            fit.draw(options.out / f"{name}.png",
                     f"{name}: kd {material[0]:.3g}, ks {material[1]:.3g}, kp {material[2]:.3g}", "LambertBlinnPhong",
                     material, sampled, measured)
    tools.leave(options.out, "materials-returned", ("table", "kd off by at most", "ks", "kp"), [
        (what, *(f"{100 * value:.2g} %" for value in np.max(values, axis=0))) for what, values in off.items()])
    tools.leave(options.out, "materials-models", (
        "model", "within (deg)", "rms ln, median", "largest", "rms (1/sr), median", "largest"), [
        (model, f"{within:g}", f"{np.median(log):.3f}", f"{max(log):.3f}", f"{np.median(linear):.2g}",
         f"{max(linear):.2g}")
        for (model, within), values in misfits.items() for log, linear in [np.transpose(values)]])
    tools.leave(options.out, "materials-ratios", (
        "within (deg)", "kd over theirs", "ks over theirs", "kp over their n"), [
        (f"{within:g}",
         *("{1:.3f} ({0:.3f} to {2:.3f})".format(*np.percentile(column, (5, 50, 95))) for column in zip(*values)))
        for within, values in ratios.items()])
    tools.leave(options.out, "materials-all", ("material", "kd", "ks", "n", "fitted kd", "fitted ks", "fitted kp",
                                               "rms ln", "rms (1/sr)", "rms ln, within 2 deg", "all directions"), lines)
    ratio = [n * ward[name]**2 / 2 for name, (_, _, n) in rows.items() if name in ward]
    low, middle, high = np.percentile(ratio, (25, 50, 75))
    print(f"n alpha^2/2, alpha of the Ward fits: median {middle:.2f}, quartiles {low:.2f} to {high:.2f} "
          "(1: n is of the half vector, 4: of the mirror direction)")
