# SPDX-License-Identifier: BSD-3-Clause
"""Recorded birds in a coverage: which share of the scans detects each bird of a radar or a GPS logger.

A bird flies straight between the positions of its track. A scan detects it with the probability of its place and
heading, averaged over the phases of its wings; scans are independent."""
from __future__ import annotations

import collections
import pathlib
import warnings
from typing import Any, Dict, List

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ..._pipeline import Error, callers_level
from ..inputs._tables import write_table
from ..sequences._flights import read_flights
from ._crossing import TWICE, _seen_near, detected_at_least
from ._plan import Plan, restored

MOST = 1_000_000  # positions of birds in scans


def flown(plan: Plan, file) -> List[Dict[str, Any]]:
    """A row for each track of a file (see `avianlidar.read_tracks`) with the expected share of scans that detect the
    bird, and the probability of at least two detections. Birds of unknown species have the first species of the plan,
    else of the library. The sensor scans at its rate from the begin of each track on."""
    species = next(iter(plan.mix)) or plan.coverage.species
    flights = read_flights(file, scene=plan.scene, species=species)
    if flights.warning:
        warnings.warn(flights.warning, RuntimeWarning, stacklevel=callers_level())
    lines, ids = flights.lines(-np.inf, np.inf)
    times, ends = vtk_to_numpy(lines.GetPointData().GetArray("time")), vtk_to_numpy(lines.GetLines().GetOffsetsArray())
    points = vtk_to_numpy(lines.GetPoints().GetData())
    rate, parts = plan.sensor.rotation_rate, []
    if rate * sum(times[high - 1] - times[low] for low, high in zip(ends[:-1], ends[1:])) > MOST:
        raise Error(f"{file}: its birds fly through more than {MOST:,} scans of the sensor, expected fewer or shorter "
                    "tracks")
    for low, high in zip(ends[:-1], ends[1:]):
        at = np.arange(times[low], times[high - 1], 1.0 / rate)
        places, later = (np.stack([np.interp(moment, times[low:high], points[low:high, axis]) for axis in range(3)],
                                  axis=1) for moment in (at, at + 0.5 / rate))
        ahead = later - places
        parts.append((places, np.arctan2(ahead[:, 0], ahead[:, 1])))
    cover, rows = plan.regions, []
    of_species = collections.defaultdict(list)
    for number, name in enumerate(flights.species):
        of_species[name].append(number)
    found: Dict[int, np.ndarray] = {}
    with restored(cover, "places", "species", "all_species", "pose_probabilities"):
        cover.all_species, cover.pose_probabilities = False, True
        for name, numbers in of_species.items():
            cover.species = name
            counts = [len(parts[number][0]) for number in numbers]
            seen = _seen_near(cover, *(np.concatenate([parts[number][k] for number in numbers]) for k in (0, 1)))
            found.update(zip(numbers, np.split(seen, np.cumsum(counts)[:-1])))
    for number, (track, name) in enumerate(zip(ids, flights.species)):
        places, seen = parts[number][0], found[number]
        away = np.linalg.norm(places - plan.sensor.position, axis=1)
        rows.append({"track": track, "species": name, "scans": len(seen), "seconds": len(seen) / rate,
                     "detected_scans": float(seen.sum()), "share_detected": float(seen.mean()) if len(seen) else 0.0,
                     "detected_twice": float(detected_at_least(TWICE, seen[None])[0]) if len(seen) else 0.0,
                     "nearest_m": float(away.min()) if len(away) else float("nan"),
                     "mean_height_m": float(places[:, 2].mean()) if len(places) else float("nan")})
    return rows


def write_flown(plan: Plan, file, folder) -> str:
    """Writes birds.csv. @return a sentence on the birds"""
    rows = flown(plan, file)
    write_table(pathlib.Path(folder) / "birds.csv", rows)
    if not rows:
        return f"{file}: has no track"
    share, twice = (100 * float(np.mean([row[name] for row in rows])) for name in ("share_detected", "detected_twice"))
    return (f"birds.csv: of {len(rows)} recorded birds, {twice:.3g} % are detected at least twice, on average in "
            f"{share:.3g} % of the scans of {plan.name} in which they fly")
