# SPDX-License-Identifier: BSD-3-Clause
"""Fits kd, ks, kp of a material to measured tables of reflectance (BRDF, 1/sr).

    Testing/Studies/run.py fit chrome.binary nickel.binary -o build/materials    tables of the MERL database
    Testing/Studies/run.py fit wall.csv --within 180                             to all directions

A table is a MERL file (.binary), or a CSV file with the header `incidence,view,azimuth,brdf` or, straight back alone,
`incidence,brdf`: angles in degrees to the normal, azimuth from the source to the viewer about it (180: the mirror's
side). Leaves materials.json, whose content goes into a .lidarscene.json, and a picture for each table.
Documentation/method/reflectance.md says what is fitted and why.
"""
import csv
import dataclasses
import json
import pathlib

import numpy as np
from scipy.optimize import least_squares, nnls

import tools
from running import argument, rms, study

# MERL: half-angle parametrisation of Rusinkiewicz, 90 x 90 x 180 cells, red, green and blue one after the other
# (Matusik, Pfister, Brand, McMillan: A Data-Driven Reflectance Model, ACM TOG 22(3), 2003).
MERL_SHAPE = (90, 90, 180)
MERL_SCALE = {"red": 1.0 / 1500, "green": 1.15 / 1500, "blue": 1.66 / 1500}
MERL_STEPS = (1, 3, 6)  # every cell of the lobe, every third of the difference angle, every sixth of its azimuth
GRAZING = 80.0  # deg: beyond it MERL's values are unreliable (Ngan, Durand, Matusik, EGSR 2005)
BACK = 2.0      # deg from straight back: what is plotted as a lidar sees it
MOST = 0.9999   # kd + ks after rounding is at most 1
LEAST = 1e-8    # kd + ks: no logarithm of 0
LARGEST_KP = 1e6
FAINT = 1e-3    # a lobe whose peak is this much weaker than the diffuse part is none


@dataclasses.dataclass
class Geometry:
    """Angles at one reflection, as ReflectionGeometry of Filters/Kernel/Scene/Reflectance.h."""
    cos_incidence: np.ndarray
    cos_outgoing: np.ndarray
    cos_lobe: np.ndarray        # to the mirror direction
    sin2_lobe: np.ndarray
    sin2_half: np.ndarray       # of the half vector to the normal
    cos_difference: np.ndarray  # of either direction to the half vector

    @classmethod
    def of(cls, source, viewer):
        """From unit vectors to the source and to the viewer; the normal is z."""
        mirror = source * (-1.0, -1.0, 1.0)
        half = source + viewer
        length2 = np.maximum((half**2).sum(axis=1), 1e-300)
        return cls(source[:, 2], viewer[:, 2], (mirror * viewer).sum(axis=1),
                   np.minimum((np.cross(mirror, viewer)**2).sum(axis=1), 1.0),
                   (half[:, :2]**2).sum(axis=1) / length2, 0.5 * np.sqrt(length2))

    def __getitem__(self, chosen):
        return Geometry(*(getattr(self, field.name)[chosen] for field in dataclasses.fields(self)))

    def incidence(self):
        return np.degrees(np.arccos(self.cos_incidence))

    def off_mirror(self):
        return np.degrees(np.arctan2(np.sqrt(self.sin2_lobe), self.cos_lobe))

    def off_back(self):
        """Degrees between the directions to the source and to the viewer."""
        return 2 * np.degrees(np.arccos(np.minimum(self.cos_difference, 1.0)))


def lobe(g, kp):
    """cos^kp of the angle to the mirror direction, accurate near its peak."""
    lit = g.cos_lobe > 0
    return np.where(lit, np.exp(0.5 * kp * np.log1p(-np.where(lit, np.minimum(g.sin2_lobe, 1 - 1e-16), 0.0))), 0.0)


def lambert_blinn_phong(kp, g):
    return g.cos_incidence, np.zeros_like(g.cos_lobe), lobe(g, kp)


def phong(kp, g):
    return g.cos_incidence, np.zeros_like(g.cos_lobe), lobe(g, kp) * g.cos_incidence


def microfacet(kp, g):
    rise = (1 - np.minimum(g.cos_difference, 1.0))**5
    a2 = 1 / (2 * kp + 1)
    spread = a2 / (a2 * (1 - g.sin2_half) + g.sin2_half)
    ci, co = g.cos_incidence, g.cos_outgoing
    masking = np.minimum(2 * ci * co / (co * np.sqrt(a2 + (1 - a2) * ci**2) + ci * np.sqrt(a2 + (1 - a2) * co**2)), 1.0)
    return ci * (1 - rise), rise * spread**2 * masking, spread**2 * masking


# f_d/kd, f_s/kd and f_s/ks of each ReflectanceModel.
MODELS = {"LambertBlinnPhong": lambert_blinn_phong, "Phong": phong, "Microfacet": microfacet}


def parts(model, kp, g):
    """Columns of kd and ks: what a receiver's solid angle collects of the ray's energy, 1/sr."""
    diffuse, lobe_of_kd, lobe_of_ks = MODELS[model](kp, g)
    lobe_scale = (kp + 1) / (2 * np.pi)
    return diffuse / np.pi + lobe_scale * lobe_of_kd, lobe_scale * lobe_of_ks


def reflected(model, material, g):
    kd, ks, kp = material
    of_kd, of_ks = parts(model, kp, g)
    return kd * of_kd + ks * of_ks


def directions(theta, phi):
    return np.column_stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def merl_geometry(steps=MERL_STEPS):
    """The middles of every steps-th cell: geometry, and the cells' numbers. theta_half rises with the square of its
    number."""
    half, difference, azimuth = np.meshgrid(*(np.arange(0, n, step) for n, step in zip(MERL_SHAPE, steps)),
                                            indexing="ij")
    cells = np.ravel_multi_index([half, difference, azimuth], MERL_SHAPE).ravel()
    theta = np.radians((half.ravel() + 0.5)**2 / 90)
    along = directions(np.radians(difference.ravel() + 0.5), np.radians(azimuth.ravel() + 0.5))
    source, viewer = (np.column_stack([x * np.cos(theta) + along[:, 2] * np.sin(theta), y,
                                       along[:, 2] * np.cos(theta) - x * np.sin(theta)])
                      for x, y in ((along[:, 0], along[:, 1]), (-along[:, 0], -along[:, 1])))
    return Geometry.of(source, viewer), cells


def read_merl(file, channel):
    """Geometry and BRDF (1/sr) of the cells."""
    count = int(np.prod(MERL_SHAPE))
    size, expected = file.stat().st_size, 12 + 3 * 8 * count
    shape = tuple(np.fromfile(file, "<i4", 3)) if size >= 12 else ()
    if shape != MERL_SHAPE or size != expected:
        raise ValueError(f"{file}: expected a MERL table of {MERL_SHAPE} cells in {expected} bytes, "
                         f"found {tuple(map(int, shape))} in {size}")
    g, cells = merl_geometry()
    start = list(MERL_SCALE).index(channel) * count
    values = np.fromfile(file, "<f8", count, offset=12 + 8 * start)
    return g, MERL_SCALE[channel] * values[cells]


def read_csv(file):
    columns = (["incidence", "view", "azimuth", "brdf"], ["incidence", "brdf"])
    with file.open(newline="", encoding="utf-8") as stream:
        lines = [(number, row) for number, row in enumerate(csv.reader(stream), 1) if row]
    header = [name.strip().lower() for name in lines[0][1]] if lines else []
    if header not in columns:
        expected = " or ".join(",".join(names) for names in columns)
        raise ValueError(f"{file}: expected the header {expected}, found '{','.join(header)}'")
    table = []
    for number, row in lines[1:]:
        try:
            values = [float(value) for value in row]
        except ValueError:
            values = []
        if len(values) != len(header) or not np.isfinite(values).all():
            raise ValueError(f"{file}: line {number}: expected {len(header)} numbers, found '{','.join(row)}'")
        if not all(0 <= angle <= 90 for angle in values[:1 if len(header) == 2 else 2]):
            raise ValueError(f"{file}: line {number}: expected angles to the normal from 0 to 90 degrees, found "
                             f"'{','.join(row)}'")
        table.append(values)
    if not table:
        raise ValueError(f"{file}: no lines below the header; expected measurements")
    table = np.array(table)
    incidence, view, azimuth = np.radians(table[:, :3] if len(header) == 4 else table[:, [0, 0, 0]] * (1, 1, 0)).T
    return Geometry.of(directions(incidence, 0 * azimuth), directions(view, azimuth)), table[:, -1]


def read_table(file, channel="red"):
    """Geometry and BRDF (1/sr) of a file."""
    if file.suffix.lower() == ".binary":
        return read_merl(file, channel)
    if file.suffix.lower() == ".csv":
        return read_csv(file)
    raise ValueError(f"{file}: expected a table .binary (MERL) or .csv")


def is_usable(g, brdf, grazing=GRAZING):
    """Which values are measured, and no farther than `grazing` degrees from the normal."""
    return (brdf > 0) & (np.minimum(g.cos_incidence, g.cos_outgoing) >= np.cos(np.radians(grazing)))


def fit(model, g, measured, error="log"):
    """(kd, ks, kp) of the model nearest to `measured`, 1/sr: by the rms of the logarithm of their ratio, or of their
    difference. For a given kp both coefficients follow from linear least squares: the best of many starts."""
    weight = 1 / measured if error == "log" else np.full_like(measured, 1 / np.sqrt(np.mean(measured**2)))

    def material(x):
        return x[0] * (1 - x[1]), x[0] * x[1], np.expm1(x[2])

    def residuals(x):
        fitted = reflected(model, material(x), g)
        return np.log(fitted / measured) if error == "log" else (fitted - measured) * weight

    upper = (MOST, 1 - 1e-9, np.log1p(LARGEST_KP))
    starts = []
    for kp in np.geomspace(1, LARGEST_KP / 2, 25):
        (kd, ks), _ = nnls(np.column_stack(parts(model, kp, g)) * weight[:, None], measured * weight)
        whole = np.clip(kd + ks, 2 * LEAST, 0.99 * MOST)
        x = (whole, np.clip(ks / max(kd + ks, LEAST), 1e-6, 0.999), np.log1p(kp))
        starts.append((np.sum(residuals(x)**2), x))
    best = min((least_squares(residuals, x, bounds=((LEAST, 0, 0), upper), x_scale="jac", xtol=1e-12, ftol=1e-12)
                for _, x in sorted(starts)[:3]), key=lambda result: result.cost)
    kd, ks, kp = material(best.x)
    if ks * (kp + 1) / 2 < FAINT * kd:
        kd, ks, kp = kd + ks, 0.0, 0.0
    return tuple(float(f"{value:.5g}") for value in (kd, ks, round(kp, 6)))


def misfit(model, material, g, measured):
    """rms of ln(fitted/measured), and of their difference (1/sr)."""
    fitted = reflected(model, material, g)
    return rms(np.log(fitted / measured)), rms(fitted - measured)


def draw(path, title, model, material, g, measured):
    back = g.off_back() <= BACK
    with tools.figure(path, 1, 2, figsize=(11, 4.2), dpi=80, sharey=True) as panels:
        for axis, angle, chosen, label in (
                (panels[0], g.incidence(), back, f"angle of incidence (deg), within {BACK:g} deg of straight back"),
                (panels[1], g.off_mirror(), ~back, "angle to the mirror direction (deg), other directions")):
            shown = np.random.default_rng(0).permutation(np.flatnonzero(chosen))[:4000]
            axis.plot(angle[shown], measured[shown], ".", color="0.6", markersize=4, label="measured")
            axis.plot(angle[shown], reflected(model, material, g[shown]), ".", color="C3", markersize=2, label="fitted")
            axis.set(xscale="log", yscale="log", xlabel=label, ylabel="BRDF × cos(view) (1/sr)")
            axis.grid(alpha=0.3)
        panels[0].legend(loc="lower left", markerscale=3)
        panels[0].figure.suptitle(title)


@study(argument("tables", nargs="+", type=pathlib.Path, help="MERL .binary or .csv"),
       argument("--channel", choices=MERL_SCALE, default="red", help="of MERL tables; default red, nearest to 905 nm"),
       argument("--model", choices=MODELS, default="LambertBlinnPhong", help="default LambertBlinnPhong, the paper's"),
       argument("--error", choices=("log", "linear"), default="log",
                help="whose rms is least: the logarithm of fitted/measured (default), or the difference"),
       argument("--within", type=float, default=30.0,
                help="deg between source and viewer, default 30: what a lidar sees; 180: all directions"),
       argument("--grazing", type=float, default=GRAZING,
                help=f"deg from the normal, beyond which nothing is used, default {GRAZING:g}"),
       argument("--no-pictures", action="store_true"))
def main(options):
    materials, lines = {}, []
    for file in options.tables:
        g, brdf = read_table(file, options.channel)
        usable = is_usable(g, brdf, options.grazing)
        g, measured = g[usable], (brdf * g.cos_outgoing)[usable]
        used = g.off_back() <= options.within
        if used.sum() < 4:
            raise ValueError(f"{file}: {used.sum()} values above 0 within {options.grazing:g} degrees of the normal "
                             f"and {options.within:g} of straight back; expected 4 or more")
        kd, ks, kp = material = fit(options.model, g[used], measured[used], options.error)
        log, linear = misfit(options.model, material, g[used], measured[used])
        materials[file.stem] = {"kd": kd, "ks": ks, "kp": kp, "comment": f"fitted to {file.name}, {options.model}, "
                                f"rms of ln(fitted/measured) {log:.3f}"}
        lines.append(f"{file.stem:24} {kd:9.5g} {ks:9.5g} {kp:9.5g} {log:7.3f} {linear:11.4g} {used.sum():8d}")
        if not options.no_pictures:
            draw(options.out / f"{file.stem}.png", f"{file.stem}: kd {kd:g}, ks {ks:g}, kp {kp:g}", options.model,
                 material, g, measured)
    options.out.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"materials": materials}, indent=2)
    (options.out / "materials.json").write_text(text + "\n", encoding="utf-8")
    print(f"{'':24} {'kd':>9} {'ks':>9} {'kp':>9} {'rms ln':>7} {'rms (1/sr)':>11} {'values':>8}", *lines, text,
          sep="\n")
    return materials
