# SPDX-License-Identifier: BSD-3-Clause
"""Does a lidar's signal fall with range as the photon receiver says? Ground and walls of real frames, beam by beam,
against the same beams simulated on the same planes.

    Testing/Studies/run.py falloff --data DATA       # default: AVIANLIDAR_DATA_DIR
    Testing/Studies/run.py falloff --clouds my.pcd --field signal

Planes are found by random samples (Fischler and Bolles, CACM 24(6), 1981). On a plane at distance h the cosine of
incidence is h/r, so the signal cos/r^n of a matt plane is h/r^(n + 1): n is the slope of ln signal over ln r with its
sign turned, less one. Slopes are fitted to medians of bins of range, of each beam and of all beams of a plane. Leaves
tables.

Documentation/evidence/real-scans.md says what they are and what comes out.
"""
import dataclasses
import os
import pathlib

import numpy as np
from scipy.optimize import least_squares

import avianlidar as al
import running
import tools
from running import argument, rms, study


@dataclasses.dataclass
class Frame:
    name: str
    file: str
    field: str       # what is held against range
    scale: str = ""  # a field of reflectivity with the range taken out
    top: float = 0   # up to which the scale is linear in reflectance


FRAMES = (Frame("OS0-32", "lidar_ouster/os0_32.pcd", "signal", "reflectivity", 100),
          Frame("OS1-32", "lidar_ouster/os1_32.pcd", "signal", "reflectivity", 100),
          Frame("OS2-32", "lidar_ouster/os2_32.pcd", "signal", "reflectivity", 10000),
          Frame("Helios-16P (0)", "lidar_outdoor/helios16p_frame0.pcd", "intensity"),
          Frame("Helios-16P (1)", "lidar_outdoor/helios16p_frame1.pcd", "intensity"),
          Frame("PandarXT-16", "lidar_outdoor/xt16.pcd", "intensity"),
          Frame("VLP-16", "lidar_vlp16_mrpt/vlp16.pcd", "intensity"))

NEAREST = 1.5     # m: the vehicle, and where the planes of walls and ground are not
THICK = 0.05      # m on either side of a plane
SAMPLES = 1500    # planes tried for each that is found
SMALLEST = 400    # points of a plane
CLOSEST = 1.0     # m from the sensor to a plane: those that pass nearer are slices through other things
UPRIGHT = 10.0    # deg from level or upright
RUN = 5           # neighbours of a ring at least: fewer are where a plane cuts through other things
PLANES = 6        # looked for in a frame
BIN = 0.05        # of ln r
IN_BIN = 3        # points at least
BINS = 5          # of a beam at least
LEVER = 1.3       # farthest over nearest bin, at least
FAINT = 4.0       # times the smallest signal: where medians are lower, the weak part of the points is missing
FULL = 0.9        # default; of the most that a sensor's own scale makes of 1/r^2: nearer than that it receives less
SCALE_TO = 35.0   # m, to which that scale is looked at ...
BRIGHT = 15.0     # ... and from which signal on: signals are whole numbers
AIR = 8.9e-5      # 1/m at 905 nm, visibility 23 km


@dataclasses.dataclass
class Plane:
    kind: str
    normal: np.ndarray  # towards the plane from the sensor, which is at 0
    distance: float     # m
    points: np.ndarray  # which of the cloud


def refined(points, normal, distance):
    """The least squares plane through the points near one, a few times; its normal points away from the sensor."""
    for _ in range(5):
        near = np.abs(points @ normal - distance) < THICK
        middle = points[near].mean(axis=0)
        normal = np.linalg.svd(points[near] - middle, full_matrices=False)[2][2]
        distance = middle @ normal
    return (normal, distance) if distance > 0 else (-normal, -distance)


def kind_of(normal):
    """Ground, wall or neither."""
    slope = np.degrees(np.arcsin(min(abs(normal[2]), 1.0)))
    return "ground" if slope > 90 - UPRIGHT else "wall" if slope < UPRIGHT else ""


def in_runs(on_plane, ring, azimuth):
    """Those with enough neighbours of the same ring on the plane, too."""
    order = np.lexsort((azimuth, ring))
    run = np.cumsum(np.r_[0, (np.diff(ring[order]) != 0) | (np.diff(on_plane[order].astype(int)) != 0)])
    kept = np.zeros(len(order), bool)
    kept[order] = np.bincount(run)[run] >= RUN
    return kept & on_plane


def find_planes(points, ring, seed=0):
    """Ground below the sensor and walls, one after the other those with the most points."""
    random, left, found = np.random.default_rng(seed), np.ones(len(points), bool), []
    azimuth = np.arctan2(points[:, 0], points[:, 1])
    for _ in range(PLANES):
        if left.sum() < SMALLEST:
            break
        own, best = points[left], (0, None, None)
        for _ in range(SAMPLES):
            one = own[random.integers(len(own))]
            near = own[np.abs(own - one).sum(axis=1) < 5.0]
            two, three = near[random.integers(len(near), size=2)]
            normal = np.cross(two - one, three - one)
            length = np.linalg.norm(normal)
            if length < 0.01 or not kind_of(normal / length) or abs(one @ normal / length) < CLOSEST:
                continue
            normal /= length
            count = (np.abs((own - one) @ normal) < THICK).sum()
            if count > best[0]:
                best = count, normal, one @ normal
        if best[0] < SMALLEST:
            break
        normal, distance = refined(own, *best[1:])
        on_plane = left & (np.abs(points @ normal - distance) < THICK)
        left &= ~on_plane
        kept = np.flatnonzero(in_runs(on_plane, ring, azimuth))
        if len(kept) >= SMALLEST and distance >= CLOSEST and not (kind_of(normal) == "ground" and normal[2] > 0):
            found.append(Plane(kind_of(normal), normal, distance, kept))
    return found


def medians(distance, signal, least=IN_BIN):
    """ln r and ln signal: of the medians of the bins of range with enough points; and the bins' numbers."""
    bins = np.floor(np.log(distance) / BIN).astype(int)
    numbers = np.array([b for b, count in zip(*np.unique(bins, return_counts=True)) if count >= least], int)
    middle = np.array([[np.median(values[bins == b]) for b in numbers] for values in (distance, signal)]).reshape(2, -1)
    bright = middle[1] > 0
    return np.log(middle[:, bright]), numbers[bright]


def slope(x, y, groups=None):
    """Of y over x by least squares, each group with an offset of its own, and its standard error."""
    groups = np.zeros(len(x), int) if groups is None else groups
    names, place = np.unique(groups, return_inverse=True)
    count = np.bincount(place)
    dx, dy = (values - (np.bincount(place, values) / count)[place] for values in (x, y))
    b = dx @ dy / (dx @ dx)
    return b, np.sqrt(((dy - b * dx)**2).sum() / max(len(x) - len(names) - 1, 1) / (dx @ dx))


def jackknifed(x, y, groups, blocks):
    """The slope, and its standard error from leaving out one block after the other: what lies in one place of a plane
    is bright or dark for all beams."""
    names = np.unique(blocks)
    without = np.array([slope(*(values[blocks != name] for values in (x, y, groups)))[0] for name in names])
    return slope(x, y, groups)[0], np.sqrt((len(names) - 1) / len(names) * ((without - without.mean())**2).sum())


def faint_from(distance, signal, least):
    """The range from which on the medians of a plane lie below `least`: there only its brightest parts are seen."""
    (x, y), _ = medians(distance, signal)
    faint = np.flatnonzero((y < np.log(least)) & (np.arange(len(y)) > np.argmax(y)))
    return np.exp(x[faint[0]] - BIN / 2) if len(faint) else np.inf


def exponents(distance, signal, ring, kind, near=0.0, far=np.inf):
    """{beam: (n, standard error, nearest, farthest, points)} of the beams whose range varies enough, and the same of
    all together or None: of a wall each beam with a gain of its own, of ground one gain, as a beam's range varies
    little there."""
    there = (distance >= near) & (distance < far)
    distance, signal, ring = distance[there], signal[there], ring[there]

    def row(fitted, x, count):
        return -fitted[0] - 1, fitted[1], np.exp(x.min()), np.exp(x.max()), count

    beams, every = {}, [np.zeros((4, 0))]
    for one in np.unique(ring):
        (x, y), bins = medians(distance[ring == one], signal[ring == one])
        if kind == "ground" or len(x) > 1:
            every.append((x, y, np.full(len(x), one), bins))
        if len(x) >= BINS and np.ptp(x) >= np.log(LEVER):
            beams[int(one)] = row(slope(x, y), x, int((ring == one).sum()))
    x, y, group, bins = np.concatenate(every, axis=1)
    if len(x) < BINS or np.ptp(x) < np.log(LEVER) or len(np.unique(group)) < 3:
        return beams, None
    fitted = jackknifed(x, y, group, bins) if kind == "wall" else jackknifed(x, y, np.zeros(len(x), int), group)
    return beams, row(fitted, x, len(distance))


def own_gain(distance, signal, scale, top):
    """What a sensor's own scale makes of 1/r^2: medians of signal r^2/scale over bins of range, over their largest."""
    known = (signal >= BRIGHT) & (scale >= top / 10) & (scale <= top) & (distance < SCALE_TO)
    (x, y), _ = medians(distance[known], (signal * distance**2 / np.maximum(scale, 1))[known], 20)
    return np.exp(x), np.exp(y - y.max())


def near_range(distance, gain):
    """Overlap and defocus range (m) of a sensor (Documentation/reference/sensor-files.md) fitted to its own gain up to
    its largest, with a level of its own, and the rms of what is left, of the level."""
    there = distance <= distance[np.argmax(gain)]
    r, y = distance[there], gain[there]

    def off(x):
        overlap, defocus, level = np.exp(x)
        return level * -np.expm1(-(r / overlap) ** 2) / (1 + (defocus / r) ** 2) - y

    half = r[np.argmax(y >= 0.5)]
    best = min((least_squares(off, np.log([part * half, (1 - part) * half, 1.0]),
                              bounds=(np.log([1e-3, 1e-3, 0.5]), np.log([1e3, 1e3, 2])))
                for part in (0.1, 0.5, 0.9)), key=lambda found: found.cost)
    overlap, defocus, level = np.exp(best.x)
    return overlap, defocus, rms(best.fun) / level


def square_on(plane, half):
    """Points and triangles of a square of a plane, around its foot. @param half of its side, m"""
    across = np.cross(plane.normal, np.eye(3)[np.argmin(np.abs(plane.normal))])
    across /= np.linalg.norm(across)
    along, middle = np.cross(plane.normal, across), plane.normal * plane.distance
    corners = [middle + half * (i * across + j * along) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array(corners), [(0, 1, 2), (0, 2, 3)]


def simulated(plane, elevations, step=360.0 / 1024):
    """Range, energy and beam of what a photon receiver gets from the whole plane by beams of these elevations."""
    scene = al.Scene()
    scene.add(square_on(plane, 500), material=(0.3, 0.0, 0.0), name="plane")
    sensor = al.Sensor("Automotive16", azimuth_step=step, channel_elevations=list(elevations), range_noise=0,
                       range_noise_floor=0)
    echoes = al.Scan(scene, sensor, attenuation_coefficient=AIR).echoes
    return echoes["distance_m"], echoes["return_energy"], np.asarray(echoes["beam_id"], int) % len(elevations)


@dataclasses.dataclass
class Study:
    """A frame, and its planes: each with its windows of range, and of each what `exponents` finds of the signal, of the
    sensor's scale and of the simulation."""
    frame: Frame
    elevation: list
    distance: np.ndarray
    signal: np.ndarray
    ring: np.ndarray
    gain: tuple = None
    planes: list = dataclasses.field(default_factory=list)


def beyond_nearest(cloud, *fields):
    """Points of a cloud but those of the vehicle, their rings, their distances, and fields."""
    points = np.array(cloud.points, float)
    distance = np.linalg.norm(points, axis=1)
    used = distance > NEAREST
    ring = np.array(cloud["laser_id"], int)
    return points[used], ring[used], distance[used], *(np.array(cloud[name], float)[used] for name in fields)


def study_of(frame, file, share=FULL):
    cloud = al.load_cloud(file)
    for name in (frame.field, "laser_id"):
        if name not in cloud:
            missing = "ring or channel" if name == "laser_id" else name
            raise ValueError(f"{file}: no field {missing}; found {', '.join(cloud)}")
    ring = np.array(cloud["laser_id"], int)
    elevation = [float(np.median(cloud["vertical_angle"][ring == i])) if (ring == i).any() else 90.0
                 for i in range(ring.max() + 1)]
    points, ring, distance, signal, *scale = beyond_nearest(cloud, frame.field, *([frame.scale] if frame.scale else []))
    result, scale, full = Study(frame, elevation, distance, signal, ring), scale[0] if scale else None, 0.0
    if frame.scale:
        result.gain = own_gain(distance, signal, scale, frame.top)
        full = result.gain[0][np.argmax(result.gain[1] >= share)]
    for plane in find_planes(points, ring):
        on = plane.points
        far = distance[on].max()
        if frame.field == "signal":
            far = min(far, faint_from(distance[on], signal[on], FAINT * signal[signal > 0].min()))
        ranges, energy, beam = simulated(plane, elevation)
        same = np.isin(beam, ring[on])
        windows = []
        for near in sorted({distance[on].min(), max(full, distance[on].min())}):
            own = exponents(distance[on], signal[on], ring[on], plane.kind, near, far)
            if own[1]:
                scaled = exponents(distance[on], scale[on], ring[on], plane.kind, near, far)[1] if frame.scale else None
                windows.append((own, scaled, exponents(ranges[same], energy[same], beam[same], plane.kind, near, far)))
        if windows:
            result.planes.append((plane, windows))
    return result


def of_beams(windows):
    """{ring: found} of the signal and of the simulation: where the sensor receives in full, or else at all ranges."""
    own, model = {}, {}
    for (each, _), _, (each_model, _) in windows:
        own |= each
        model |= {ring: each_model.get(ring) for ring in each}
    return own, model


def number(found):
    return f"{found[0]:.2f} ± {found[1]:.2f}" if found else "-"


def tables(studies):
    planes, beams, scales, near = [], [], [], []
    at = (2.5, 5.0, 10.0, 15.0, 20.0, 30.0)
    for one in studies:
        if one.gain:
            x, y = one.gain
            scales.append((one.frame.name, f"{x[np.argmax(y >= FULL)]:.1f}",
                           *(f"{np.interp(r, x, y):.2f}" if x[0] <= r <= x[-1] else "-" for r in at)))
            if y[0] < 0.5:  # else no near range is seen
                overlap, defocus, left = near_range(x, y)
                near.append((one.frame.name, f"{x[0]:.1f} to {x[np.argmax(y)]:.1f}", f"{overlap:.2f}", f"{defocus:.2f}",
                             f"{left:.3f}"))
        if not one.planes:
            planes.append((one.frame.name, "none long enough", *["-"] * 7))
        for plane, windows in one.planes:
            where = f"{plane.kind}, {plane.distance:.1f} m"
            for (each, found), scaled, (_, model) in windows:
                planes.append((one.frame.name, where, found[4], f"{found[2]:.1f}", f"{found[3]:.1f}", number(found),
                               number(scaled), number(model), len(each)))
            own, models = of_beams(windows)
            for ring, found in own.items():
                beams.append((one.frame.name, where, f"{one.elevation[ring]:.1f}", found[4], f"{found[2]:.1f}",
                              f"{found[3]:.1f}", number(found), number(models[ring])))
    return {"falloff-planes": (("sensor", "plane", "points", "from (m)", "to (m)", "n", "n of the reflectivity",
                                "n simulated", "beams alone"), planes),
            "falloff-scales": (("sensor", f"{FULL:g} from (m)", *(f"at {r:g} m" for r in at)), scales),
            "falloff-near": (("sensor", "ranges (m)", "`overlap_range` (m)", "`defocus_range` (m)", "rms left"), near),
            "falloff-beams": (("sensor", "plane", "elevation (deg)", "points", "from (m)", "to (m)", "n",
                               "n simulated"), beams)}


@study(argument("--data", type=pathlib.Path, default=pathlib.Path(os.environ.get("AVIANLIDAR_DATA_DIR", "")),
                help="the data folder"),
       argument("--clouds", nargs="+", type=running.file,
                help="files to take instead, each one turn in the sensor's frame"),
       argument("--field", default="signal", help="of these files, default signal"),
       argument("--full", type=running.above_zero, default=FULL,
                help=f"share of 1/r2 by the sensor's own scale, from which on its far field begins, default {FULL}"))
def main(options):
    frames = [(Frame(file.stem, file.name, options.field), file) for file in options.clouds or ()] or [
        (frame, options.data / frame.file) for frame in FRAMES]
    studies = [study_of(frame, file, options.full) for frame, file in frames]
    for name, (head, rows) in tables(studies).items():
        tools.leave(options.out, name, head, rows, 2)
    return studies
