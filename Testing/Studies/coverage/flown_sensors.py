# SPDX-License-Identifier: BSD-3-Clause
"""Coverage against birds that are flown, for beams wider and narrower than a bird: for each sensor and species places in free
space, at random azimuths, elevations of 0 to 10 degrees and distances, scan after scan through the echo filter.

    Testing/Studies/run.py flown_sensors --places 2000 --scans 100 --file flown.csv
    Testing/Studies/run.py flown_sensors --flown flown.csv
"""
import csv
import pathlib

import numpy as np

import avianlidar as al
import flown
import tools
from running import argument, study

AIR = 8.9e-5  # 1/m
# m, about as far as a gull, a goose and a starling are detected
REACH = {"VLP16": (55, 60, 40), "OS1_64": (80, 95, 60), "Pandar40P": (180, 220, 110), "Automotive16": (150, 175, 95),
         "Airport16": (130, 180, 60), "Search905": (850, 1000, 550), "Avia": (130, 160, 90)}
ASIDE = {"Avia": 35.0}  # deg from the front, of those that do not look all around
SPECIES = ("herring gull", "Canada goose", "starling")
NEAREST = 5.0  # m
NOTHING = (np.zeros((0, 3)), np.zeros((0, 3), dtype=int))


def places_for(sensor, species, count, seed=0):
    """Places, count x 3, m: azimuth, elevation and distance are uniform."""
    random = np.random.default_rng(seed)
    azimuth, elevation = random.uniform(0, 2 * np.pi, count), np.radians(random.uniform(0, 10, count))
    if sensor in ASIDE:
        azimuth = np.radians(ASIDE[sensor]) * (azimuth / np.pi - 1)
    away = random.uniform(NEAREST, REACH[sensor][SPECIES.index(species)], count)
    return away[:, None] * np.column_stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth),
                                            np.sin(elevation)])


def stated(sensor, species, places):
    """The probability that coverage states at each place."""
    cover = al.Coverage(al.Scene(NOTHING, material="Wall"), sensor, places=places, species=species, visibility=0.0,
                        attenuation_coefficient=AIR)
    return cover["detection_probability"].astype(float)


def flights(name, species, count, scans, seed=0):
    """Places, and in how many scans a bird there had an echo and was expected to have one: count x 5."""
    sensor, places = al.Sensor(name, position=(0.0, 0.0, 0.0)), places_for(name, species, count, seed)
    seen, expected = flown.fly(al.Scene(NOTHING, material="Wall"), sensor, places, scans, species, AIR, 400, seed + 1000)
    return np.column_stack([places, np.rint(scans * seen), scans * expected])


def compare(name, species, table, scans):
    """A row of the table: what coverage states against flights."""
    probability = stated(al.Sensor(name, position=(0.0, 0.0, 0.0)), species, table[:, :3])
    seen = table[:, 3] / scans
    return {"sensor": name, "species": species, "stated": probability.mean(), "flown": seen.mean(),
            "expected": table[:, 4].mean() / scans, **flown.compare(probability, seen, scans),
            "between": int(np.count_nonzero((probability > 0.01) & (probability < 0.99)))}


HEAD = ("sensor", "bird", "places, scans", "stated", "flown", "bias", "beyond 3 standard errors", "outside 99.73 %",
        "neither certain nor hopeless")


def line(row, places, scans):
    return (row["sensor"], row["species"], f"{places:,}, {scans}", f"{row['stated']:.4f}", f"{row['flown']:.4f}", f"{row['bias']:+.4f}",
            f"{100 * row['beyond_3_std_errors']:.2f} %", f"{100 * row['outside_99.73_percent']:.2f} %", row["between"])


def lines_of(file):
    """Rows: flights that were written before, against what is stated now."""
    found = {}
    with open(file, encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            found.setdefault((row["sensor"], row["species"], int(row["scans"])), []).append(
                [float(row[name]) for name in ("x [m]", "y [m]", "z [m]", "seen", "expected")])
    return [line(compare(name, species, np.array(rows), scans), len(rows), scans) for (name, species, scans), rows in found.items()]


@study(argument("--sensors", nargs="+", default=list(REACH), choices=list(REACH)),
       argument("--species", nargs="+", default=list(SPECIES), choices=list(SPECIES)),
       argument("--places", type=int, default=2000), argument("--scans", type=int, default=100), argument("--seed", type=int, default=0),
       argument("--file", type=pathlib.Path, default=pathlib.Path("flown.csv"), help="CSV, one row per place, default flown.csv"),
       argument("--flown", type=pathlib.Path, help="what --file left: nothing is flown, only stated again"))
def main(options):
    if not options.flown:
        with options.file.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(["sensor", "species", "scans", "x [m]", "y [m]", "z [m]", "seen", "expected"])
            for name in options.sensors:
                for species in options.species:
                    for row in flights(name, species, options.places, options.scans, options.seed):
                        writer.writerow([name, species, options.scans, *(f"{value:.6g}" for value in row)])
    tools.leave(options.out, "coverage-flown", HEAD, lines_of(options.flown or options.file), 2)
