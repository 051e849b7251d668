# SPDX-License-Identifier: BSD-3-Clause
"""A prediction, made before any measurement was looked up: how far a Livox Avia sees a small quadcopter, in the sun and in the dark.

    Testing/Studies/run.py quadcopter

A quadcopter 0.4 m across, near the sensor's axis, is flown outward; a frame is 0.1 s. Each flight draws, evenly within stated intervals, its
reflectance, the thickness of its parts, its attitude, where it is off the axis, and the bar of the sensor's ranges. Leaves tables: distance
of the last return (5 to 95 % of the flights) and points a frame against distance. What explains the flights of others, which
were published later:

    Testing/Studies/run.py quadcopter --flights 8 --reflectance 0.25 0.5 --off-axis 0.5 --bar 0
"""
import dataclasses
import warnings

import numpy as np
from scipy.spatial.transform import Rotation

import avianlidar as al
import tools
from avianlidar import _sheet
from avianlidar.apps.coverage._targets import box, quadcopter  # noqa: F401 intervals.py takes `box` from here
from avianlidar.apps.inputs._json import packaged
from running import above_zero, argument, finite, study, whole

ACROSS = packaged("coverage/targets.json")["drone"]["across"]  # m, from motor to motor over the middle
REFLECTANCE = 0.05, 0.5  # assumed: dark plastic and carbon to light grey
THICK = 0.8, 1.25        # assumed: of the parts in targets.json
OFF_AXIS = 2.0           # deg at most, evenly over the disc
TILT = 25.0              # deg at most
STEP = 2.0               # m, between frames
FARTHEST = 320.0         # m
AIR = 8.9e-5             # 1/m, visibility 23 km
LIGHTS = (100, 0)        # klx
SKY = 0.05               # W/(m2 sr nm) in 100 klx, assumed
FRAMES = 150             # in turn, begun anywhere


@dataclasses.dataclass
class Flight:
    """What one flight saw: points of each frame, at its distance (m)."""
    light: float
    distance: np.ndarray
    points: np.ndarray

    def last(self):
        seen = np.flatnonzero(self.points)
        return self.distance[seen[-1]] if len(seen) else 0.0


def fitted(bar):
    """An Avia whose receiver is fitted to its sheet; its ranges times 1 + bar."""
    sensor = al.Sensor("Avia")
    points = [{**point, "range": point["range"] * (1 + bar)} for point in sensor.description["sheet"]["points"]]
    sensor.set(range_gate=max(sensor.range_gate, max(point["range"] for point in points)))
    sensor.fit(points)
    return sensor


def windows_of(number):
    """Directions of the beams of successive frames."""
    sensor = al.Sensor("Avia", number_of_revolutions=number)
    found = []
    for k in range(number):
        sensor.algorithm.UpdateTimeStep(k / sensor.rotation_rate)
        found.append(np.array(sensor.beams["direction"]))
    return found


def fly(sensor, windows, light, seed, reflectance=REFLECTANCE, off_axis=OFF_AXIS):
    random = np.random.default_rng(seed)
    points, faces = quadcopter(random.uniform(*THICK))
    yaw, (pitch, roll) = random.uniform(0, 2 * np.pi), np.radians(random.uniform(-TILT, TILT, 2))
    off, around = np.radians(off_axis) * np.sqrt(random.random()), random.uniform(0, 2 * np.pi)
    kd = random.uniform(*reflectance)
    middle = np.array((np.sin(off) * np.cos(around), np.cos(off), np.sin(off) * np.sin(around)))
    shape = Rotation.from_euler("ZYX", (yaw, pitch, roll)).apply(points)
    distance = np.arange(STEP, FARTHEST + STEP, STEP)
    sensor.set(sunlight=_sheet.irradiance(light, 905.0), sun_azimuth=180, sun_elevation=45, background_radiance=SKY * light / 100)
    seen = []
    first = random.integers(len(windows))
    for i, at in enumerate(distance):
        beams = windows[(first + i) % len(windows)]
        near = np.flatnonzero(beams @ middle > np.cos(np.arctan(0.8 * ACROSS / at) + 3e-3))
        if not len(near):
            seen.append(0)
            continue
        own = al.Sensor("Avia", directions=beams[near], rotation_rate=10)
        own.set(**{name: value for name, value in sensor.properties().items() if name in KEPT})
        own.set(false_alarms_per_scan=max(1e-9, sensor.false_alarms_per_scan * len(near) / len(beams)))
        scan = al.Scan(al.Scene(shape + at * middle, faces, material=(kd, 0, 1)), own, attenuation_coefficient=AIR, number_of_reflections=1,
                       seed=int(random.integers(2**30)), return_mode="First")
        seen.append(int((scan.echoes["object_id"] >= 0).sum()))
    return Flight(light, distance, np.array(seen))


KEPT = ("receiver_model", "receiver_aperture", "filter_bandwidth", "sunlight", "sun_azimuth", "sun_elevation", "background_radiance")


def tables_of(flights):
    rows, last = [], []
    for light in LIGHTS:
        own = [flight for flight in flights if flight.light == light]
        ends = np.array([flight.last() for flight in own])
        last.append((f"{light}", len(own), *(f"{np.percentile(ends, p):.0f}" for p in (5, 50, 95))))
        counts = np.array([flight.points for flight in own])
        for at in (5, 10, 20, 30, 40, 50, 60, 80, 100, 120, 150, 180):
            k = int(np.argmin(np.abs(own[0].distance - at)))
            near = counts[:, max(k - 1, 0):k + 2].mean(axis=1)
            rows.append((f"{light}", f"{at}", *(f"{np.percentile(near, p):.1f}" for p in (5, 50, 95)), f"{100 * (counts[:, k] > 0).mean():.0f} %"))
    return {"quadcopter-last": (("light (klx)", "flights", "5 % (m)", "50 % (m)", "95 % (m)"), last),
            "quadcopter-points": (("light (klx)", "distance (m)", "5 %", "50 %", "95 %", "frames with a point"), rows)}


@study(argument("--flights", type=whole(2, 10000), default=40, help="in each light, default 40"),
       argument("--reflectance", type=above_zero, nargs=2, default=REFLECTANCE, metavar=("LOW", "HIGH"), help="default 0.05 0.5"),
       argument("--off-axis", type=above_zero, default=OFF_AXIS, help="deg at most, default 2"),
       argument("--bar", type=finite,
                help="ranges of all flights are those of the sheet times 1 + this; default: drawn within the sensor's bar"))
def main(options):
    bar = al.Sensor("Avia").description["sheet"]["bar"]
    warnings.simplefilter("ignore", RuntimeWarning)  # frames without an echo are expected
    flights, windows = [], windows_of(FRAMES)
    for i in range(options.flights):
        sensor = fitted(np.random.default_rng(1000 + i).uniform(-bar, bar) if options.bar is None else options.bar)
        flights += [fly(sensor, windows, light, i, options.reflectance, options.off_axis) for light in LIGHTS]
    for name, (header, rows) in tables_of(flights).items():
        tools.leave(options.out, name, header, rows, 2)
    return flights
