# SPDX-License-Identifier: BSD-3-Clause
"""Scans an airport, moves it by its place in UTM, turns it about the vertical, the lidar with it, scans it again, and
tells what differs: the shipped airport, and that with structures where AVIANLIDAR_SCENES_DIR names the folder of its
scene. Half a minute.

    Testing/Studies/run.py moved_scenes
"""
import itertools

import numpy as np
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter

import avianlidar as al
import tools
from avianlidar._pipeline import update
from running import AIRPORT, built_scene, rms, study

HEAD = ("scene", "moved by", "turned by (deg)", "echoes, before", "after", "the same", "energy differs by 1e-6",
        "by 1 %", "by 10 %", "most", "rms", "most, in stated standard errors", "range: most (m)", "rms (m)",
        "all energy")
UTM = (351234.567, 3452345.678, 0.0)  # m
UNIT = 0.75  # m, a range unit
# The second is between grid north of zone 51 and true north at Hongqiao.
TURNS = (0.0, -0.862, 30.0, 90.0, 123.456)  # degrees, clockwise


class Airport:
    """Scans of one airport without noise, here and elsewhere."""

    def __init__(self, file):
        self.scene = al.Scene(str(file))
        update(self.scene.tree)
        self.here = self.scan()

    def scan(self, shift=(0.0, 0.0, 0.0), turn=0.0, **properties):
        transform = vtkTransform()
        transform.Translate(shift)
        transform.RotateZ(-turn)
        move = vtkTransformPolyDataFilter()
        move.SetTransform(transform)
        move.SetInputData(self.scene.tree.GetOutput())
        move.SetOutputPointsPrecision(move.DOUBLE_PRECISION)
        move.Update()
        position = transform.TransformPoint(*self.scene.lidar_position)
        sensor = al.Sensor("Airport16", position=position, orientation=(turn, 0, 0))
        return al.Scan(move.GetOutput(), sensor, noise=False, **properties)

    def compare(self, *arguments, **properties):
        """What differs in another scan, as numbers by name."""
        return compare(self.here, self.scan(*arguments, **properties))


def same_echoes(one, other):
    """Indices of pairs of echoes of the same beam and object, within a range unit of each other."""
    there = {}
    for key, index, distance in zip(zip(other["beam_id"], other["object_id"]), itertools.count(), other["distance_m"]):
        there.setdefault(key, []).append((distance, index))
    pairs = []
    for key, index, distance in zip(zip(one["beam_id"], one["object_id"]), itertools.count(), one["distance_m"]):
        near = [found for found in there.get(key, []) if abs(found[0] - distance) < UNIT]
        if near:
            nearest = min(near, key=lambda found, at=distance: abs(found[0] - at))
            there[key].remove(nearest)
            pairs.append((index, nearest[1]))
    return np.array(pairs).T


def compare(one, other):
    a, b = same_echoes(one, other)
    energy, energy_there = one["energy_received"][a], other["energy_received"][b]
    difference = abs(energy_there - energy)
    relative = difference / energy
    differs = relative > 1e-6
    error = np.hypot(one["energy_std_error"][a], other["energy_std_error"][b])
    with np.errstate(divide="ignore"):
        errors = difference[differs] / error[differs]
    distance = abs(other["distance_m"][b] - one["distance_m"][a])
    return {
        "before": len(one["beam_id"]), "after": len(other["beam_id"]), "same": len(a), "1e-6": int(differs.sum()),
        "1 %": int((relative > 0.01).sum()), "10 %": int((relative > 0.1).sum()), "most": relative.max(),
        "rms": rms(relative), "errors": errors.max(initial=0.0), "range": distance.max(),
        "range rms": rms(distance),
        "all": other["energy_received"].sum() / one["energy_received"].sum() - 1,
    }


def rows(name, file):
    airport = Airport(file)
    others = [("-", f"{turn:g}", airport.compare(turn=turn)) for turn in TURNS if turn != 0.0]
    others += [("UTM", f"{turn:g}", airport.compare(UTM, turn)) for turn in TURNS]
    others.append(("-", "0, other rays", airport.compare(seed=1)))
    for place, turn, d in others:
        yield (name, place, turn, f"{d['before']:,}", f"{d['after']:,}", f"{d['same']:,}", f"{d['1e-6']:,}", d["1 %"],
               d["10 %"], percent(d["most"]), percent(d["rms"]), f"{d['errors']:.1f}", f"{d['range']:.2g}",
               f"{d['range rms']:.2g}", percent(d["all"]))


def percent(share):
    return f"{100 * share:.{3 if abs(share) >= 0.995 else 2}g} %"


@study()
def main(options):
    found = list(rows("Hongqiao", AIRPORT))
    if built_scene("zsss_structures"):
        found += rows("Hongqiao, structures", built_scene("zsss_structures"))
    tools.leave(options.out, "moved", HEAD, found, 3)
    return found
