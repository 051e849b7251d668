# SPDX-License-Identifier: BSD-3-Clause
"""Coverage against birds that are flown, for beams wider and narrower than a bird: for each sensor and species places
in free space, at random azimuths, elevations of 0 to 10 degrees and distances, scan after scan through the echo filter.

    Testing/Studies/run.py flown_sensors --places 2000 --scans 20
"""
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


def compare(name, species, count, scans, seed=0):
    """A row of the table: what coverage states against flights at so many places."""
    sensor, places = al.Sensor(name, position=(0.0, 0.0, 0.0)), places_for(name, species, count, seed)
    probability, scene = stated(sensor, species, places), al.Scene(NOTHING, material="Wall")
    seen, expected = flown.fly(scene, sensor, places, scans, species, AIR, 400, seed + 1000)
    return {"sensor": name, "species": species, "stated": probability.mean(), "flown": seen.mean(),
            "expected": expected.mean(), **flown.compare(probability, seen, scans),
            "between": int(np.count_nonzero((probability > 0.01) & (probability < 0.99)))}


HEAD = ("sensor", "bird", "places, scans", "stated", "flown", "bias", "beyond 3 standard errors", "outside 99.73 %",
        "neither certain nor hopeless")


def line(row, places, scans):
    return (row["sensor"], row["species"], f"{places:,}, {scans}", f"{row['stated']:.4f}", f"{row['flown']:.4f}",
            f"{row['bias']:+.4f}", f"{100 * row['beyond_3_std_errors']:.2f} %",
            f"{100 * row['outside_99.73_percent']:.2f} %", row["between"])


@study(argument("--sensors", nargs="+", default=list(REACH), choices=list(REACH)),
       argument("--species", nargs="+", default=list(SPECIES), choices=list(SPECIES)),
       argument("--places", type=int, default=2000), argument("--scans", type=int, default=100),
       argument("--seed", type=int, default=0))
def main(options):
    found = [compare(name, species, options.places, options.scans, options.seed)
             for name in options.sensors for species in options.species]
    tools.leave(options.out, "coverage-flown", HEAD, [line(row, options.places, options.scans) for row in found], 2)
