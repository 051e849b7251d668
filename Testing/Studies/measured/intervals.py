# SPDX-License-Identifier: BSD-3-Clause
"""Whether the interval of a lidar's ranges holds what frames of its kind show, what a Mid-360 sees of a small drone, and how far an
assumed rangefinder sees seabirds.

    Testing/Studies/run.py intervals --data DATA       # default: AVIANLIDAR_DATA_DIR

The least reflectance of a bin of distance is measured (frames.py; strangers' bins are in lidars_measured). The square root of the
predicted over the measured one is how much farther the real unit sees. A bin counts unless its whole interval lies below the 1 % that
the sensor's scale can show. It lies inside if some value that rounds to it does. Widths and spreads are the greatest factor over the
least. The rule of the intervals in the sensor files: from the least to the greatest of the chosen frame's factors and of the error of
the fit, and WIDER times as far at both ends, for units that nobody has measured.
"""
import csv
import warnings

import numpy as np

import avianlidar as al
import frames
import quadcopter
import tools
from avianlidar import reach
from frames import ROUND
from running import study

# The frame that was kept out when the interval was chosen, if a kind has another one
KINDS = {"OS0_128": ("OS0-32", "OS0-128"), "OS1_64": ("OS1-32", "OS1-128"), "VLP16": ("", "VLP-16"), "HDL32E": ("", "HDL-32E")}
WIDER = 1.05
# Wing areas, m2 (Pennycuick 2008, second-hand), and farthest readings, m (Berwick Bank offshore wind farm, appendix 11.7, part 4)
SEABIRDS = {"kittiwake": (0.101, 948), "gannet": (0.262, 800)}
LIT = 0.15  # effective area over wing area, as for a herring gull
BEAM = np.pi * 0.125e-3 * 0.9e-3  # sr: 0.25 by 1.8 mrad, assumed
BOARDS = (800, 2000)  # m: the range of a surface as bright as the bird that fills the beam, assumed
DISTANCES = (10, 15, 20, 25)  # m
SIZES = (0.35, 0.6)  # m, from motor to motor
SCANS = 60
ROTOR = 0.12  # m of radius for a drone of 0.4 m (assumed); a disc of which blades cover a tenth


def bins_of(data):
    """{frame: rows of distance (m) and measured least reflectance (%)} with the preset of each."""
    found = {}
    for frame in frames.FRAMES:
        if frame.reflectivity and any(frame.name in names for names in KINDS.values()):
            found[frame.name] = [(at, float(least)) for _, _, _, least, at, *_ in frames.darkest(frame, data)]
    with open(data / "lidars_measured" / "least_reflectance.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found.setdefault(row["lidar"], []).append((float(row["at_m"]), float(row["least_reflectance_percent"])))
    return found


def judged(seen, bins):
    """Of the bins that count: whether each lies inside, and how much farther than predicted the unit sees."""
    inside, factors = [], []
    for at, least in bins:
        middle = 100 * seen.least(at)
        low, high = (middle * factor for factor in seen.factors)
        if high >= 1:
            inside.append(low <= least + ROUND and least - ROUND <= high)
            factors.append(np.sqrt(middle / max(least, ROUND)))
    return inside, factors


def intervals(data):
    rows, measured = [], bins_of(data)
    for preset, (kept, chosen) in KINDS.items():
        seen, (low, high) = frames.Seen(preset), reach.interval(al.Sensor(preset))
        inside, factors = judged(seen, measured[chosen])
        test, others = judged(seen, measured[kept]) if kept else ([], [])
        spread = max(factors + others) / min(factors + others)
        bar = seen.sensor.description.get("sheet", {}).get("bar", 0.0)
        rule = min(1 - bar, *factors) / WIDER, max(1 + bar, *factors) * WIDER
        if abs(low - rule[0]) > 0.006 or abs(high - rule[1]) > 0.006:
            print(f"{preset}: the rule gives {rule[0]:.2f} to {rule[1]:.2f}, its file {low:g} to {high:g}")
        share = 100 * (sum(inside) + sum(test)) / (len(inside) + len(test))
        rows.append((f"`{preset}`", f"{low:g} to {high:g}",
                     f"{min(factors + others):.2f} to {max(factors + others):.2f}", f"{high / low / spread:.2f}",
                     f"{chosen}: {sum(inside)} of {len(inside)}", f"{kept}: {sum(test)} of {len(test)}" if kept else "none", f"{share:.0f} %"))
    return ("preset", "interval", "measured", "width over spread", "bins inside", "kept out", "share"), rows


def seabirds():
    """Ranges by the rule of one point of a sheet: R^4 = R0^2 A / Omega."""
    rows = []
    for name, (wings, read) in SEABIRDS.items():
        near, far = (np.sqrt(board) * (LIT * wings / BEAM) ** 0.25 for board in BOARDS)
        rows.append((name, f"{LIT * wings:.3f}", f"{near:.0f} to {far:.0f}", read, frames.verdict(read <= far)))
    return ("bird", "effective area (m²)", "predicted (m)", "farthest reading (m)", "not farther"), rows


def drone(across, random):
    """Parts of a quadcopter: (points, triangles) of the body and of its four rotors, seen from the side as thin discs."""
    points, faces = quadcopter.quadcopter(across / quadcopter.ACROSS)
    points = points * across / quadcopter.ACROSS
    corners, triangles, first = [points], [faces], len(points)
    for angle in np.radians((45, 135, 225, 315)):
        middle = 0.5 * across * np.array((np.cos(angle), np.sin(angle), 0)) + (0, 0, 0.025)
        turn = random.uniform(0, np.pi)  # a blade of 0.02 m on either side of the hub
        blade, sides = quadcopter.box(middle, np.array((ROTOR * across / quadcopter.ACROSS, 0.01, 0.003)), turn)
        corners.append(blade)
        triangles.append(sides + first)
        first += len(blade)
    return np.concatenate(corners), np.concatenate(triangles)


def drones():
    """Points of a Mid-360 on a quadcopter at the elevation 5 to 40 degrees and any azimuth."""
    rows, random = [], np.random.default_rng(1)
    for across in SIZES:
        for distance in DISTANCES:
            counts = []
            for _ in range(SCANS):
                sensor = al.Sensor("Mid360", number_of_revolutions=100)
                sensor.algorithm.UpdateTimeStep(int(random.integers(100)) / sensor.rotation_rate)
                about, up = random.uniform(0, 2 * np.pi), np.radians(random.uniform(5, 40))
                middle = np.array((np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)))
                beams = np.array(sensor.beams["direction"])
                near = beams[beams @ middle > np.cos(np.arctan(across / distance) + 3e-3)]
                if not len(near):
                    counts.append(0)
                    continue
                own = al.Sensor("Mid360", directions=near, rotation_rate=10,
                                false_alarms_per_scan=max(1e-9, sensor.false_alarms_per_scan * len(near) / len(beams)))
                points, faces = drone(across, random)
                kd, yaw = random.uniform(*quadcopter.REFLECTANCE), random.uniform(0, 2 * np.pi)
                turned = points @ np.array(((np.cos(yaw), np.sin(yaw), 0), (-np.sin(yaw), np.cos(yaw), 0), (0, 0, 1)))
                scan = al.Scan(al.Scene(turned + distance * middle, faces, material=(kd, 0, 1)), own, attenuation_coefficient=8.9e-5,
                               number_of_reflections=1, return_mode="First", seed=int(random.integers(2**30)))
                counts.append(int((scan.echoes["object_id"] >= 0).sum()))
            counts = np.array(counts)
            rows.append((f"{across:g}", distance, f"{100 * (counts > 0).mean():.0f} %", f"{counts.mean():.1f}",
                         f"{counts[counts > 0].mean():.1f}" if counts.any() else "-"))
    return ("size (m)", "distance (m)", "scans with a point", "points a scan", "points where there is one"), rows


@study(data=["lidars_measured/least_reflectance.csv", *(frame.file for frame in frames.FRAMES)])
def main(options):
    warnings.simplefilter("ignore", RuntimeWarning)  # beams without an echo are expected
    found = {"measured-intervals": intervals(options.data), "measured-drones": drones(), "measured-seabirds": seabirds()}
    for name, (header, rows) in found.items():
        tools.leave(options.out, name, header, rows, 2)
    return found
