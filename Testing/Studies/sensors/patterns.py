# SPDX-License-Identifier: BSD-3-Clause
"""Patterns of the sensors that are built in, as pictures, and how much of their field of view those with rotating prisms cover.

    Testing/Studies/run.py patterns --out build/patterns

The share is that of the directions in the field of view that lie in a beam; the field of view are the
directions within MARGIN of a beam of the first LONG seconds. Directions are drawn evenly by solid angle.
"""
import numpy as np
from matplotlib.collections import EllipseCollection
from scipy.spatial import cKDTree

import avianlidar as al
import tools
from running import study

PRISMS = ("Mid40", "Avia", "Mid360")
ASSUMED = {"Mid40": "", "Avia": "prisms assumed", "Mid360": "pattern fitted"}
WINDOWS = (0.1, 0.5, 2.0)  # s, shown
TIMES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)  # s, in the table
LONG = 5.0  # s
MARGIN = 0.5  # deg
DRAWN = 40000  # directions
SEED = 1
WIDE = 6.0  # deg of azimuth that are shown of rotors
COLUMNS = 5


def window(sensor, number):
    """Directions and times (s) of a scan."""
    sensor.algorithm.UpdateTimeStep(number / sensor.rotation_rate)
    beams = al.Cloud(sensor.algorithm.GetOutput())
    return np.array(beams["direction"]), 1e-6 * np.array(beams["timestamp"])


def directions_until(sensor, seconds):
    """Of all beams fired before."""
    number = int(round(seconds * sensor.rotation_rate))
    return np.concatenate([window(sensor, scan)[0] for scan in range(number)])


def angles(directions):
    """Azimuth, within 180 of north, and elevation, deg."""
    return (np.degrees(np.arctan2(directions[:, 0], directions[:, 1])), np.degrees(np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))))


def first_beams(sensor, beams, drawn):
    """Of each direction the number of the first beam that holds it, or inf. Beams are upright ellipses."""
    half = np.array([sensor.half_beamwidth, sensor.half_beamwidth_across or sensor.half_beamwidth])
    near = cKDTree(drawn).query_ball_point(beams, 2 * np.sin(half.max() / 2))
    beam = np.repeat(np.arange(len(beams)), [len(one) for one in near])
    direction = np.concatenate([np.array(one, dtype=int) for one in near])
    axis = beams[beam]
    right = np.cross(axis, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right, axis=1)[:, None]
    away = drawn[direction] / np.sum(drawn[direction] * axis, axis=1)[:, None]
    place = np.column_stack([np.sum(away * right, axis=1), np.sum(away * np.cross(right, axis), axis=1)]) / np.tan(half)
    held = np.sum(place**2, axis=1) <= 1
    first = np.full(len(drawn), np.inf)
    np.minimum.at(first, direction[held], beam[held])
    return first


def coverage(sensor, times=TIMES):
    """Shares of the field of view that are covered after `times`, and the field of view: solid angle (sr), azimuths and
    elevations (deg)."""
    beams = directions_until(sensor, LONG)
    azimuth, elevation = angles(beams)
    random = np.random.default_rng(SEED)
    low, high = np.sin(np.radians([elevation.min() - MARGIN, elevation.max() + MARGIN]))
    least, most = np.radians([azimuth.min() - MARGIN, azimuth.max() + MARGIN])
    up, about = random.uniform(low, high, DRAWN), random.uniform(least, most, DRAWN)
    drawn = np.column_stack([np.sqrt(1 - up * up) * np.sin(about), np.sqrt(1 - up * up) * np.cos(about), up])
    chord = 2 * np.sin(np.radians(MARGIN) / 2)
    drawn = drawn[cKDTree(beams).query(drawn, distance_upper_bound=chord)[0] < chord]
    solid = (high - low) * (most - least) * len(drawn) / DRAWN
    first = first_beams(sensor, beams, drawn)
    shares = [np.mean(first < round(time * len(beams) / LONG)) for time in times]
    return np.array(shares), solid, (azimuth.min(), azimuth.max()), (elevation.min(), elevation.max())


def rows():
    for name in PRISMS:
        shares, _, azimuths, elevations = coverage(al.Sensor(name))
        yield (f"`{name}`", *(f"{low:.1f} to {high:.1f}°".replace("-", "−") for low, high in (azimuths, elevations)),
               *(f"{100 * share:.0f} %" for share in shares))


def draw_prisms(file):
    with tools.figure(file, len(PRISMS), len(WINDOWS), figsize=(10.5, 11.0)) as panels:
        for name, row in zip(PRISMS, panels):
            sensor = al.Sensor(name)
            for seconds, axes in zip(WINDOWS, row):
                azimuth, elevation = angles(directions_until(sensor, seconds))
                axes.plot(azimuth, elevation, ",", color="k", alpha=1.0 if seconds < 0.2 else 0.5)
                axes.set(aspect="equal" if name != "Mid360" else "auto", title=f"{name}, {seconds:g} s", xlabel="azimuth, deg from the front")
                axes.tick_params(labelsize=8)
            row[0].set_ylabel(f"elevation, deg\n{ASSUMED[name]}".strip())


def draw_rotors(file):
    """Beams as wide as they are, of a few columns."""
    names = [name for name in al.Sensor.presets() if name not in PRISMS]
    with tools.figure(file, -(-len(names) // COLUMNS), COLUMNS, figsize=(12.0, 9.5)) as panels:
        for name, axes in zip(names, panels.flat):
            sensor = al.Sensor(name)
            azimuth, elevation = angles(window(sensor, 0)[0])
            near = np.abs(azimuth) < WIDE
            wide, high = 2 * np.degrees((sensor.half_beamwidth, sensor.half_beamwidth_across or sensor.half_beamwidth))
            axes.add_collection(EllipseCollection(np.full(near.sum(), wide), np.full(near.sum(), high), np.zeros(near.sum()), units="xy",
                                                  transOffset=axes.transData, offsets=np.column_stack([azimuth[near], elevation[near]]),
                                                  facecolor="0.6", edgecolor="k", linewidth=0.3))
            axes.set(xlim=(-WIDE / 2, WIDE / 2), ylim=(elevation.min() - 1, elevation.max() + 1))
            axes.set_title(f"{name}: {len(azimuth):,} beams", fontsize=9)
            axes.tick_params(labelsize=8)
        for axes in panels.flat[len(names):]:
            axes.set_axis_off()
        axes.figure.supxlabel("azimuth, deg from the front", fontsize=9)
        axes.figure.supylabel("elevation, deg", fontsize=9)


@study()
def main(options):
    draw_prisms(options.out / "prisms.png")
    draw_rotors(options.out / "rotors.png")
    tools.leave(options.out, "patterns-coverage", ("", "azimuths", "elevations", *(f"{time:g} s" for time in TIMES)), list(rows()))
