# SPDX-License-Identifier: BSD-3-Clause
"""Birds that cross a strip or an approach, and the share of them that is detected at least twice on the way.

A bird flies level and straight, at right angles to the runway, from one side of the region to the other. The drawn
places of the plan give the distance along the region and the height. The speed is the airspeed of the species, without
wind. A scan detects the bird with the probability of its heading, averaged over the phases of its wings; scans are
independent for a bird of this heading.
"""
from __future__ import annotations

import dataclasses
import functools
import math
import warnings
from typing import List, Tuple

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ... import vtkAvianLidar as _wrapped
from ..._coverage import Coverage
from ..._pipeline import update
from ..._properties import set_properties
from ..places._regions import APPROACH_HALF_WIDTH, STRIP_HALF_WIDTH, region_names
from ..sequences._scores import weighted
from ._plan import Plan, restored

TWICE = 2  # detections
BIRDS = 2000  # greatest number of birds
PROBED = 30_000  # positions in scans that show how far birds are detected
SURELY = 1.25  # beyond this multiple of the greatest distance at which a bird is detected, no bird is
LEAST = 1e-5  # probability that counts as none: of two detections in 400 scans then below 1e-5
SPEED = 15.0  # speed of a target without a species, m/s; assumed
FLIGHTS = 400  # flights from which the speed of a species is taken
HEADINGS = 16  # headings of each phase of flapping wings: BirdHeadings of Filters/Kernel/Targets/BirdViews.h
TOGETHER = 20_000  # positions whose poses are in memory together


@dataclasses.dataclass(frozen=True)
class Crossing:
    """The share of birds that is detected at least TWICE while they cross a region.

    share, error  share and its standard error, because birds are drawn; an upper bound for a mix of species
    birds         number of birds
    speed         mean speed of the species of the plan, m/s              scans  mean number of scans of a crossing
    seconds       mean duration of a crossing, s
    """

    share: float
    error: float
    birds: int
    speed: float
    scans: float
    seconds: float


@functools.lru_cache(maxsize=None)
def speed_of(species: str, table: str = "") -> float:
    """Speed of a species, m/s: mean of the flights of vtkAvianLidarTracks, to 0.5 m/s. @param table the user's table of
    species"""
    if not species:
        return SPEED
    tracks = _wrapped.vtkAvianLidarTracks()
    set_properties(tracks, species=species, number_of_birds=FLIGHTS, species_file_name=table)
    update(tracks)
    trails = tracks.GetOutputDataObject(1)
    times = vtk_to_numpy(trails.GetPointData().GetArray("time"))
    points = vtk_to_numpy(trails.GetPoints().GetData())
    lines = np.split(vtk_to_numpy(trails.GetLines().GetConnectivityArray()),
                     vtk_to_numpy(trails.GetLines().GetOffsetsArray())[1:-1])
    speeds = [np.linalg.norm(np.diff(points[line], axis=0), axis=1).sum() / np.ptp(times[line]) for line in lines]
    return round(2.0 * float(np.mean(speeds))) / 2.0


def detected_at_least(times: int, probabilities: np.ndarray) -> np.ndarray:
    """The probability that at least `times` independent scans detect each bird. @param probabilities birds x scans"""
    fewer = np.zeros((times, len(probabilities)))  # by the number of detections
    fewer[0] = 1.0
    for p in probabilities.T:
        fewer[1:] = fewer[1:] * (1.0 - p) + fewer[:-1] * p
        fewer[0] *= 1.0 - p
    return 1.0 - fewer.sum(axis=0)


def flights(plan: Plan, speed: float, random: np.random.Generator) -> Tuple[np.ndarray, List[np.ndarray], np.ndarray]:
    """Birds that cross the plan's regions. @return number of the drawn place of each bird; its positions in scans,
    n x 3, m; its heading, rad clockwise from north"""
    step, names = speed / plan.sensor.rotation_rate, region_names(plan.runways)  # step in m
    base, wider = APPROACH_HALF_WIDTH
    begins = {name: (np.asarray(runway.start), runway, STRIP_HALF_WIDTH, 0.0)
              for name, runway in zip(names["strips"], plan.runways)}
    ends = [(end, runway) for runway in plan.runways for end, _ in runway.ends()]
    begins.update({name: (end, runway, base, wider) for name, (end, runway) in zip(names["approaches"], ends)})
    half: np.ndarray = np.zeros(len(plan.points))
    middle, across = np.zeros((2, len(plan.points), 2))
    for name, members in plan.ends.items():
        begin, runway, width, more = begins[name]
        axis, side = runway.axes()
        along = (plan.points[members, :2] - begin) @ axis
        half[members], across[members] = width + more * np.abs(along), side
        middle[members] = begin + along[:, None] * axis
    count = max(min(BIRDS, len(half)), 2)
    chosen = np.sort(random.choice(len(half), count, replace=False))
    way = across[chosen] * random.choice([-1.0, 1.0], count)[:, None]
    first = random.uniform(0.0, step, count)
    positions = []
    for i, start, to in zip(chosen, first, way):
        flown = np.arange(start, 2.0 * half[i], step)  # m
        ground = middle[i] + (flown - half[i])[:, None] * to
        positions.append(np.column_stack([ground, np.full(len(flown), plan.points[i, 2])]))
    return chosen, positions, np.arctan2(way[:, 0], way[:, 1])


def crossing(plan: Plan) -> Crossing:
    """The share of the plan's birds that is detected at least TWICE while they cross. The plan has runways."""
    cover = plan.regions  # which keeps the clutter
    weights, total, parts = plan.weights(plan.points), np.zeros(3), []
    with restored(cover, "places", "species", "all_species", "pose_probabilities"):
        cover.all_species, cover.pose_probabilities = False, True
        for number, (species, mixed) in enumerate(plan.mix.items()):
            speed = speed_of(species, cover.species_file_name or "")
            chosen, positions, headings = flights(plan, speed, np.random.default_rng(plan.seed))
            cover.species = species
            counts = np.array([len(of) for of in positions])
            found = _seen_near(cover, np.concatenate(positions), np.repeat(headings, counts))
            probabilities = np.zeros((len(chosen), counts.max(initial=1)))
            probabilities[np.arange(counts.max(initial=1)) < counts[:, None]] = found
            share, error, _ = weighted(detected_at_least(TWICE, probabilities), weights[number, chosen])
            parts.append((mixed * share, mixed * error, len(chosen)))
            total += mixed * np.array([speed, counts.mean(), counts.mean() / plan.sensor.rotation_rate])
    share, error = np.sum([part[:2] for part in parts], axis=0).tolist()
    return Crossing(share, error, min(part[2] for part in parts), *total.tolist())


def _seen_near(cover: Coverage, places: np.ndarray, headings: np.ndarray) -> np.ndarray:
    """The same as `_seen`, where most places are too far away. Some places show how far birds are detected. Places
    beyond this range are not computed, unless they are nearer than the nearest of these."""
    away = np.linalg.norm(places - cover.sensor.position, axis=1)
    some = np.arange(0, len(places), max(len(places) // PROBED, 1))
    found = np.zeros(len(places))
    found[some] = _seen(cover, places[some], headings[some])
    detected = some[found[some] > LEAST]
    limit = SURELY * max(away[some].min(initial=math.inf), away[detected].max(initial=0.0))
    rest = np.setdiff1d(np.flatnonzero(away <= limit), some)
    found[rest] = _seen(cover, places[rest], headings[rest])
    return found


def _seen(cover: Coverage, places: np.ndarray, headings: np.ndarray) -> np.ndarray:
    """Probabilities that one scan detects a bird of a heading (rad) at each place, averaged over its wing phases."""
    found = [np.empty(0)]
    for first in range(0, len(places), TOGETHER):
        part = slice(first, first + TOGETHER)
        cover.places = places[part]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the plan's coverage has warned
            of_poses = cover["pose_probabilities"].astype(float).reshape(len(places[part]), -1)
        poses = of_poses.shape[1]
        phases = 1 if cover.gliding or poses == 1 else poses // HEADINGS
        count = poses // phases  # headings of each phase, which phases shift by a part of a step
        at = headings[part, None] / (2.0 * math.pi) * count - (np.arange(phases) + 0.5) / phases
        low = np.floor(at).astype(int)
        below, above = (np.take_along_axis(of_poses, np.arange(phases) * count + number % count, axis=1)
                        for number in (low, low + 1))
        found.append((below + (at - low) * (above - below)).mean(axis=1))
    return np.concatenate(found)
