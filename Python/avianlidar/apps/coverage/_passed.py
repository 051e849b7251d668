# SPDX-License-Identifier: BSD-3-Clause
"""Coverage of a lidar that moves: which share of birds it detects while it passes.

A coverage is computed for the pose at the start of each scan along the trajectory, or of every n-th scan of a long one,
which then stands for n scans. A bird stays at its place; scans are independent."""
from __future__ import annotations

import math
import pathlib
from typing import Any, Callable, Dict, List, Tuple

import numpy as np

from ..._cloud import point_array
from ..._numbers import figures
from ..._pipeline import update
from ..._sensor import Sensor
from ..inputs._tables import write_table
from ..sequences._scores import weighted
from ..sequences._trajectory import read_trajectory
from ._plan import Plan, restored

MOST = 100  # coverages along a trajectory


def _poses(sensor: Sensor, line, position, orientation) -> List[Tuple[Tuple[float, ...], Tuple[float, ...]]]:
    """Position and orientation of a sensor at the start of each scan of which the trajectory knows all beams."""
    times = point_array(line, "time")
    last = 1e-6 * float(sensor.beams["timestamp"].max(initial=0.0))
    begin, end = math.ceil(times[0] * sensor.rotation_rate), math.floor((times[-1] - last) * sensor.rotation_rate)
    found = []
    with restored(sensor, "trajectory", "position", "orientation"):
        sensor.trajectory, sensor.position, sensor.orientation = line, position, orientation
        for k in range(begin, max(end, begin) + 1):  # at least one, whose error says what is missing
            update(sensor.algorithm, run=lambda: sensor.algorithm.UpdateTimeStep(k / sensor.rotation_rate))
            fields = sensor.algorithm.GetOutput().GetFieldData()
            found.append((fields.GetArray("position").GetTuple(0), fields.GetArray("orientation").GetTuple(0)))
    return found


def passed(plan: Plan, file, progress: Callable[[str, int, int], Any] = lambda *_: None,
           position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0), **settings: Any) -> List[Dict[str, Any]]:
    """Rows of shares by region and species, and of all places: the share of birds detected at least once while the
    lidar passes along a trajectory, with its standard error, and the mean share in one scan.

    position     position of the sensor in the frame of the platform (right, forward, up), m
    orientation  yaw, pitch and roll of the sensor in this frame, deg
    settings     of `read_trajectory`
    """
    sensor, cover = plan.sensor, plan.regions
    poses = _poses(sensor, read_trajectory(file, plan.scene, **settings), position, orientation)
    step = -(-len(poses) // MOST)
    missed = np.ones((len(plan.mix), len(plan.points)))
    mean = np.zeros_like(missed)
    with restored(sensor, "position", "orientation"), restored(cover, "species", "all_species"):
        cover.all_species = False
        for number in range(0, len(poses), step):
            sensor.position, sensor.orientation = poses[number]
            scans = min(step, len(poses) - number)
            for row, species in enumerate(plan.mix):
                cover.species = species
                seen = cover["detection_probability"].astype(float)
                missed[row] *= (1.0 - seen) ** scans
                mean[row] += seen * scans / len(poses)
            progress("coverages along the trajectory", number // step + 1, -(-len(poses) // step))
    weights, rows = plan.weights(plan.points), []
    everywhere = np.arange(len(plan.points))
    for region, members in [*plan.members.items(), *[("all places", everywhere)] * (len(plan.members) > 1)]:
        for species, chosen in [*((name, [row]) for row, name in enumerate(plan.mix)),
                                *[(plan.bird, list(range(len(plan.mix))))] * (len(plan.mix) > 1)]:
            part = np.ix_(np.array(chosen), members)
            heaviness = weights[part].sum(axis=0)
            shares = [(weights[part] * values[part]).sum(axis=0) / np.maximum(heaviness, 1e-300)
                      for values in (1.0 - missed, mean)]
            whole, error, _ = weighted(shares[0], heaviness)
            rows.append({"region": region, "species": species, "places": len(members), "scans": len(poses),
                         "coverages": -(-len(poses) // step), "detected_while_passing": whole, "std_error": error,
                         "detected_in_a_scan": weighted(shares[1], heaviness)[0]})
    return rows


def write_passed(plan: Plan, file, folder, progress: Callable[[str, int, int], Any], **settings: Any) -> str:
    """Writes passing.csv. @return a sentence on the shares"""
    rows = passed(plan, file, progress, **settings)
    write_table(pathlib.Path(folder) / "passing.csv", rows)
    last = rows[-1]
    return (f"passing.csv: {plan.name} on {pathlib.Path(file).name} detects {100 * last['detected_while_passing']:.3g} % "
            f"(standard error {figures(100 * last['std_error'], 2)} %) of birds {plan.where} at least once in "
            f"{last['scans']} scans, {100 * last['detected_in_a_scan']:.3g} % in one scan on average")
