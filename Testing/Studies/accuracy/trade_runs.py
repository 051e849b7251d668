# SPDX-License-Identifier: BSD-3-Clause
"""Scans to judge: what is scanned, one scan with its cost, the converged reference, and the errors of a scan
against it."""
import argparse
import dataclasses
import pathlib
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter

import corridor_scene
import field_scene
import running
from running import AIRPORT, rms

HALF_LIGHT_SPEED = 0.5 * 299792458.0  # m/s: metres of range per second of delay
SENSORS = {"airport16": "Airport16", "airport32": "Airport32", "corridor": "CorridorC16"}
AIR = vtkAvianLidarEchoFilter().GetAttenuationCoefficient()
ARRAYS = ("beam_id", "distance_m", "energy_received", "return_energy", "energy_std_error", "secondary_share")


def scene_name(text):
    return text if text in ("airport", "corridor", "field") else str(running.file(text))


def scene_and_sensor(text):
    """(scene, sensor or ""), for argparse."""
    name, _, sensor = text.partition(":")
    if sensor and sensor not in SENSORS:
        raise argparse.ArgumentTypeError(f"there is no sensor {sensor}, expected one of {', '.join(SENSORS)}")
    return scene_name(name), sensor


SCENES = running.argument("scenes", nargs="+", type=scene_and_sensor,
                          help="airport, corridor, field, or a .lidarscene.json file, and after a colon airport16 (the "
                          "default), airport32 or corridor")


def measured(options, measure):
    """What `measure(scene, sensor, options)` returns for each scene; prints it to the error stream as soon as it is
    there."""
    for name, sensor in options.scenes:
        for row in measure(name, sensor, options):
            print(*row, sep=" | ", file=sys.stderr, flush=True)
            yield row


def scene_of(name):
    """Surfaces of a scene, place of the lidar, m, and attenuation coefficient, 1/m."""
    if name == "corridor":
        return corridor_scene.build(), corridor_scene.LIDAR, corridor_scene.HAZE
    if name == "field":
        return field_scene.build(), field_scene.LIDAR, AIR
    scene = running.read_scene(AIRPORT if name == "airport" else name).GetOutput()
    place = scene.GetFieldData().GetArray("lidar_position")
    return scene, place.GetTuple(0) if place else (0, 0, 3), AIR


class Subject:
    """Surfaces with their tree, and a sensor at a place (m). `coarser` makes the steps of azimuth that many times as
    wide."""

    axis = None  # direction of a single beam, many times, instead of the sensor's beams

    def __init__(self, name, surfaces, sensor, place, attenuation=AIR, coarser=1):
        self.name, self.sensor_name, self.attenuation = name, sensor, attenuation
        self.tree, self.sensor = vtkAvianLidarCollisionTree(), vtkAvianLidarBeamSource()
        running.made(self.tree, InputDataObject=surfaces)
        getattr(self.sensor, "SetPresetTo" + sensor)()
        running.made(self.sensor, Position=tuple(place), AzimuthStep=coarser * self.sensor.GetAzimuthStep())
        self.lower_limit = self.sensor.GetLowerEnergyLimit()
        self.unit = HALF_LIGHT_SPEED * self.sensor.GetSamplingInterval()
        self.tolerance = self.unit + HALF_LIGHT_SPEED * self.sensor.GetPulseWidth()

    @property
    def title(self):
        return f"{self.name}, {self.sensor_name}"

    @property
    def number_of_beams(self):
        return self.sensor.GetOutput().GetNumberOfPoints()


def subject_of(name, sensor="", coarser=1, place=None):
    """A scene with the sensor in it, by default that of the scene, at `place` (m) instead of the scene's own."""
    surfaces, own, attenuation = scene_of(name)
    sensor = sensor or ("corridor" if name == "corridor" else "airport16")
    return Subject(pathlib.Path(name).name.split(".")[0], surfaces, SENSORS.get(sensor, sensor),
                   own if place is None else place, attenuation, coarser)


@dataclasses.dataclass
class Scan:
    """One execution of the filter: its echoes in the order of beams and ranges, and what it cost."""

    echoes: dict
    cpu: float  # s, of the process
    rays: float  # traced per beam, those of paths included


def scan(subject, settings, seed, threads=1):
    """A new filter scans: nothing is known from an earlier scan, the tree and the beams are there. Noise is off in all
    scans: it belongs to the receiver and is no error."""
    begin = time.process_time()
    lidar = running.scanned(subject.sensor, subject.tree, **{
        "AttenuationCoefficient": subject.attenuation, "Noise": False, "NumberOfThreads": threads, "Seed": seed,
        **settings})
    cpu = time.process_time() - begin
    columns = {name: running.column(lidar.GetOutput(), name) for name in ARRAYS}
    order = np.lexsort((columns["distance_m"], columns["beam_id"]))
    return Scan({name: values[order] for name, values in columns.items()}, cpu,
                lidar.GetNumberOfTracedRays() / subject.number_of_beams)


def matches(one, other, tolerance):
    """Pairs (i, j) of echoes of one beam, each the nearest to the other and closer than the tolerance (m)."""
    def nearest(here, there):
        places = there["beam_id"] * 1e5 + there["distance_m"]
        wanted = here["beam_id"] * 1e5 + here["distance_m"]
        after = np.clip(np.searchsorted(places, wanted), 1, max(len(places) - 1, 1))
        closer = abs(places[np.minimum(after, len(places) - 1)] - wanted) < abs(places[after - 1] - wanted)
        return np.minimum(np.where(closer, after, after - 1), len(places) - 1)

    if not len(one["beam_id"]) or not len(other["beam_id"]):
        return np.zeros((2, 0), dtype=int)
    there, back = nearest(one, other), nearest(other, one)
    i = np.flatnonzero(back[there] == np.arange(len(there)))
    j = there[i]
    near = (one["beam_id"][i] == other["beam_id"][j]) & (
        abs(one["distance_m"][i] - other["distance_m"][j]) < tolerance)
    return np.array([i[near], j[near]])


def totals(echoes, beams):
    """The energy of all returns of each beam, J."""
    place = np.searchsorted(beams, echoes["beam_id"])
    return np.bincount(place, echoes["return_energy"], len(beams))


class Reference:
    """The mean of two converged scans with seeds of their own. Half of their difference is the reference's own error.
    Echoes that only one of them has are too near to the limit to be judged: finding them is right, missing them too."""

    def __init__(self, subject, rays, seeds=(1000003, 1000033), samples=vtkAvianLidarEchoFilter.BEAM_SAMPLES_RAYS,
                 connections=2):
        self.subject = subject
        settings = {"RaysPerBeam": rays, "BeamSamples": samples, "NumberOfConnections": connections}
        one, other = (scan(subject, settings, seed, 0).echoes for seed in seeds)
        i, j = matches(one, other, subject.tolerance)
        self.rays = rays
        self.echoes = {name: one[name][i] if name == "beam_id" else 0.5 * (one[name][i] + other[name][j])
                       for name in ARRAYS}
        self.undecided = {name: np.concatenate([np.delete(one[name], i), np.delete(other[name], j)]) for name in ARRAYS}
        order = np.lexsort((self.undecided["distance_m"], self.undecided["beam_id"]))
        self.undecided = {name: values[order] for name, values in self.undecided.items()}
        self.strong = self.echoes["energy_received"] >= 2 * subject.lower_limit
        self.beams = vtk_to_numpy(subject.sensor.GetOutput().GetPointData().GetArray("beam_id"))
        assert (np.diff(self.beams) > 0).all()
        sums = totals(one, self.beams), totals(other, self.beams)
        self.totals = 0.5 * (sums[0] + sums[1])
        self.lit = self.totals >= 2 * subject.lower_limit
        half = {name: 0.5 * (one[name][i] - other[name][j])[self.strong] for name in ("energy_received", "distance_m")}
        self.own = {"energy": rms(half["energy_received"] / self.echoes["energy_received"][self.strong]),
                    "total": rms((0.5 * (sums[0] - sums[1]) / np.maximum(self.totals, 1e-300))[self.lit]),
                    "range": rms(half["distance_m"]),
                    "detection": len(self.undecided["beam_id"]) / max(len(i), 1)}


def judge(reference, found):
    """Differences of one scan from the reference: of energies (relative), of totals (relative), of ranges (m), over
    echoes and beams of at least twice the lower limit; whether 1.96 standard errors hold these energies; numbers of
    echoes missed and made up. The energy of a missed echo is wrong by all of it, -1, and not held: a setting must not
    look better for what it does not see. A missed echo has no range to judge."""
    subject, truth = reference.subject, reference.echoes
    i, j = matches(truth, found.echoes, subject.tolerance)
    strong = reference.strong[i]
    energy = np.full(len(truth["beam_id"]), -1.0)
    energy[i] = found.echoes["energy_received"][j] / truth["energy_received"][i] - 1
    held = np.zeros(len(energy), dtype=bool)
    held[i] = abs(energy[i]) * truth["energy_received"][i] <= 1.96 * np.hypot(
        found.echoes["energy_std_error"][j], truth["energy_std_error"][i] / np.sqrt(2))  # the truth is a mean of two
    away = found.echoes["distance_m"][j] - truth["distance_m"][i]
    rest = {name: np.delete(values, j) for name, values in found.echoes.items()}
    excused = matches(rest, reference.undecided, subject.tolerance).shape[1]
    total = totals(found.echoes, reference.beams)[reference.lit] / reference.totals[reference.lit] - 1
    return {"energy": energy[reference.strong], "held": held[reference.strong], "range": away[strong], "total": total,
            "missed": len(truth["beam_id"]) - len(i), "false": len(rest["beam_id"]) - excused,
            "true": len(truth["beam_id"])}


def wrong(found):
    """The share of the true echoes that is missed or made up."""
    return (found["missed"] + found["false"]) / max(found["true"], 1)


def judged(reference, settings, seeds, subject=None):
    """[(differences, cost)] of scans with several seeds."""
    runs = [scan(subject or reference.subject, settings, seed) for seed in seeds]
    return [(judge(reference, run), run) for run in runs]


def rms_of(runs, kind):
    """The rms of the differences of all runs."""
    return rms(np.concatenate([found[kind] for found, _ in runs]))


def energy_and_wrong(runs):
    """The rms error of energy, and the share of the true echoes that is missed or made up."""
    return rms_of(runs, "energy"), np.mean([wrong(found) for found, _ in runs])
