# SPDX-License-Identifier: BSD-3-Clause
"""Real frames beam by beam: points that no surface explains, and the least reflectance that is still seen at a distance, each beside
what the sensor's receiver predicts. `predicted_measured.py` runs it."""
import dataclasses
import pathlib

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, poisson

import avianlidar as al
import falloff
import room_compare
import room_data
import tools
from avianlidar import _sheet, reach


@dataclasses.dataclass
class Frame:
    name: str
    file: str
    preset: str = ""        # the sensor file whose receiver predicts it
    reflectivity: str = ""  # a field in % of a white board, range taken out
    signal: str = ""        # a field in proportion to the light received
    dual: bool = False      # the strongest and the last return
    room: bool = False
    top: bool = False       # intensity ends at 255


FRAMES = (Frame("VLP-16", "lidar_vlp16_mrpt/vlp16.pcd", "VLP16", "intensity"),
          Frame("Helios-16P (0)", "lidar_outdoor/helios16p_frame0.pcd", "Helios16P", "intensity"),
          Frame("Helios-16P (1)", "lidar_outdoor/helios16p_frame1.pcd", "Helios16P", "intensity"),
          Frame("PandarXT-16", "lidar_outdoor/xt16.pcd", "PandarXT32", "intensity", dual=True),
          Frame("OS0-32", "lidar_ouster/os0_32.pcd", "OS0_128", "reflectivity", "signal"),
          Frame("OS1-32", "lidar_ouster/os1_32.pcd", "OS1_64", "reflectivity", "signal"),
          Frame("OS2-32", "lidar_ouster/os2_32.pcd", "OS2_128", "", "signal"),
          *(Frame(room_data.ROOM[name], f"lidar_room/{name}.pcd", preset, dual=True, room=True, top=True) for name, preset in
            (("pandar64", ""), ("pandar40p", "Pandar40P"), ("xt32", "PandarXT32"), ("qt64", ""))))

STEEPEST = 80.0    # deg of incidence: what is met more obliquely is no surface here, as where the room's surface is made
CLOSE = 0.5        # m: nearer neighbours are of the same thing, whatever the incidence: a bush is one thing
EMPTY = 5, 2       # columns and rings to either side without an answer: nearer to things there are leaves and wires ...
SIZES = (1, 1), (5, 1), EMPTY, (10, 2)  # ... as these show
ROUND = 0.5        # of a whole number
EDGES = (5, 10, 20, 30, 40, 60, 80, 120, 160)  # m, of bins of distance
FEW = 20           # points of a bin, at least
LEAST = 1.0        # % of the points of a bin that are darker than the least reflectance


def verdict(fine):
    return "yes" if fine else "**no**"


class Around:
    """The beams around each of a scan, by columns to either side and rings above and below, and how far apart in range a surface is
    there. The first two are left and right."""

    def __init__(self, scan, columns=1, rings=1):
        starts, offsets = scan.rings(), np.r_[np.arange(-columns, columns + 1)]
        places = [(0, offset) for offset in sorted(offsets[offsets != 0], key=abs)]
        places += [(ring, offset) for ring in range(-rings, rings + 1) if ring for offset in offsets]
        self.beams = np.full((len(scan.range), len(places)), -1)
        for ring, (a, b) in enumerate(zip(starts, starts[1:])):
            for k, (up, aside) in enumerate(places):
                if 0 <= ring + up < len(starts) - 1:
                    low, high = starts[ring + up:ring + up + 2]
                    near = np.arange(a, b) if up == 0 else scan.nearest_in_ring(ring + up, scan.azimuth[a:b])
                    self.beams[a:b, k] = low + (near - low + aside) % (high - low)
        directions = scan.directions()
        cosine = np.stack([(directions * directions[near]).sum(axis=1) for near in self.beams.T], axis=1)
        self.slope = np.arccos(np.clip(cosine, -1, 1)) * np.tan(np.radians(STEEPEST))  # how far apart, of the range

    def ranges(self, values):
        """The value of the beams around; NaN without such beams or without an answer."""
        return np.where(self.beams >= 0, values[self.beams], np.nan)

    def isolated(self, values):
        """Which have no neighbour that a surface could join them with; and which of these lie between neighbours' ranges."""
        near = self.ranges(values)
        joined = np.abs(near - values[:, None]) < np.maximum(CLOSE, values[:, None] * self.slope)
        alone = np.isfinite(values) & ~joined.any(axis=1)
        return alone, alone & (np.fmin.reduce(near, axis=1) < values) & (values < np.fmax.reduce(near, axis=1))

    def empty(self, values):
        """Around which nothing answers."""
        return ~np.isfinite(self.ranges(values)).any(axis=1)


def field(frame, data, name):
    """Another field of the points of `room_data.read_scan`, by beam."""
    cloud = al.load_cloud(pathlib.Path(data) / frame.file)
    return room_data.beams_of(np.array(cloud.points, float), np.array(cloud[name], float), np.array(cloud["laser_id"], int))[4]


def read(frame, data):
    return room_data.read_scan(pathlib.Path(data) / frame.file)


def poisson_most(count):
    """Upper end of the 95 % interval of the mean, by a count (Garwood)."""
    return chi2.ppf(0.975, 2 * count + 2) / 2


def alarms_of(sensor):
    """False alarms in a beam, or NaN: limits in joules have no noise."""
    photons = sensor and sensor.receiver_model == "Photons"
    return float(sensor.false_alarms_per_scan) / sensor.beams.number_of_points if photons else np.nan


def false_alarms(data, room):
    """Two tables: isolated points of each frame, and answers where nothing around answers, beside the false alarms predicted there;
    and the latter by how much around has to be empty. @param room the room's scans and surfaces (room.Room)"""
    names, counts, others, rates, empties = [], [], [], [], []
    for frame in FRAMES:
        scan = read(frame, data)
        alone, mixed = Around(scan).isolated(scan.range)
        alone &= scan.range > falloff.NEAREST
        off = "-"
        if frame.room:
            own = room.scans[scan.sensor]
            place = scan.range[alone, None] * scan.directions()[alone] @ own.pose[:3, :3].T + own.origin
            off = int((room_compare.Nearest(room.without(scan.sensor)[0])(place, CLOSE)[0] >= CLOSE).sum())
        far = ~(scan.range <= falloff.NEAREST)
        empty = {size: Around(scan, *size).empty(scan.range) & far for size in SIZES}
        empties.append([(mask.sum(), (mask & scan.answered).sum()) for mask in empty.values()])
        counts.append([scan.answered.sum(), alone.sum(), (alone & mixed).sum(), *empties[-1][SIZES.index(EMPTY)]])
        rates.append(alarms_of(al.Sensor(frame.preset)) if frame.preset else np.nan)
        others.append((off, "no noise" if frame.preset else "no sensor file"))
        names.append(frame.name)
    counts, rates, empties = np.array(counts), np.array(rates), np.array(empties)
    noisy = np.isfinite(rates)
    mean = rates * counts[:, 3]
    counts = np.vstack([counts, counts[noisy].sum(axis=0), counts.sum(axis=0)])
    rows = []
    for name, (points, alone, mixed, beams, found), expected, (off, otherwise) in zip(
            (*names, "those with noise", "all"), counts, (*mean, mean[noisy].sum(), np.nan), (*others, ("-", "-"), ("-", "-"))):
        low, high = poisson.ppf((0.025, 0.975), expected)
        known = expected == expected
        rows.append((name, points, alone, mixed, off, beams, found, f"{expected:.2f} ({low:.0f} to {high:.0f})" if known else otherwise,
                     f"{1e4 * poisson_most(found) / beams:.1f}",
                     ("open: more" if found > high else verdict(found >= low)) if known else "-"))
    sizes = []
    for size, sums in zip(SIZES, empties.transpose(1, 0, 2)):
        cells = [(beams, found, f"{1e4 * poisson_most(found) / beams:.1f}") for beams, found in (sums[noisy].sum(axis=0), sums.sum(axis=0))]
        sizes.append((*size, *cells[0], *cells[1]))
    answers = "answered", "at most, of 10,000"
    return (("frame", "points", "isolated", "between neighbours", "off the other scans", "beams in the empty", "answered",
             "false alarms predicted", "at most, of 10,000", "as predicted"), rows), (
        ("columns either side", "rings either side", "beams, those with noise", *answers, "beams, all", *answers), sizes)


class Seen:
    """The least reflectance that a sensor sees at a distance (m), by what its file says, and by which factor either way."""

    def __init__(self, name):
        self.sensor = al.Sensor(name)
        sheet = self.sensor.description["data_sheet"]
        self.photons = self.sensor.receiver_model == "Photons"
        self.receiver = _sheet.Receiver(self.sensor) if self.photons else None
        self.range, self.reflectance = (None if self.photons else sheet[f"detection_{key}"]["value"] for key in ("range", "reflectance"))
        low, high = reach.interval(self.sensor)
        self.factors = high**-2, low**-2

    def least(self, distance):
        if not self.photons:
            return self.reflectance * (distance / self.range)**2 * np.exp(2 * falloff.AIR * (distance - self.range))
        numbers = float(self.sensor.receiver_aperture), float(self.sensor.filter_bandwidth), np.nan  # surfaces fill the beam
        air = np.exp(2 * falloff.AIR * distance)  # sheets and limits are of clear air
        return air * np.exp(brentq(lambda x: self.receiver.excess_of(distance, {"reflectance": np.exp(x)}, *numbers), -20, 5))


def verdict_of(shown, low, high):
    """Of a least reflectance in whole percents beside the predicted interval (%)."""
    if high < 1:
        return "below the scale"
    return "**no**: sees darker" if shown + ROUND < low else "open: nothing darker" if shown - ROUND > high else "yes"


def darkest(frame, data):
    """By bins of distance: (nearest, farthest, points, least reflectivity in %, the distance of those, what is predicted there and its
    interval, least signal). Isolated points are left out: noise is one of them."""
    scan, seen, shown = read(frame, data), Seen(frame.preset), field(frame, data, frame.reflectivity)
    signal = field(frame, data, frame.signal or frame.reflectivity)
    used = scan.answered & ~Around(scan).isolated(scan.range)[0]
    for near, far in zip(EDGES, EDGES[1:]):
        there = np.flatnonzero(used & (scan.range >= near) & (scan.range < far))
        if len(there) >= FEW:
            least = np.percentile(shown[there], LEAST, method="lower")
            at = float(np.median(scan.range[there[shown[there] <= least]]))
            middle = 100 * seen.least(at)
            yield (near, far, len(there), least, at, middle, *(middle * factor for factor in seen.factors),
                   np.percentile(signal[there], LEAST))


def least_reflectance(data):
    """The least reflectivity that each frame shows, by distance, and what its sensor's receiver predicts."""
    rows = []
    for frame in FRAMES:
        if not frame.reflectivity and not frame.room:
            rows.append((frame.name, "-", "-", "not in a file here", *"-----"))
        for near, far, count, least, at, middle, low, high, signal in darkest(frame, data) if frame.reflectivity else ():
            rows.append((frame.name, f"{near} to {far}", count, f"{least:.0f}", f"{at:.1f}", f"{middle:.1f} ({low:.1f} to {high:.1f})",
                         f"{least / middle:.2f}" if middle > 1 else "-", f"{signal:.0f}" if frame.signal else "-",
                         verdict_of(least, low, high)))
    return ("frame", "distance (m)", "points", "least reflectivity (%)", "at (m)", "predicted there (%)", "measured over predicted",
            "least signal (photons)", "as predicted"), rows


def picture(data, folder):
    """The least reflectivity over distance, of frames of which it is predicted to show."""
    with tools.figure(folder / "least.png", figsize=(6, 3.8), dpi=110) as axis:
        for frame in FRAMES:
            rows = [row for row in darkest(frame, data) if row[7] >= 1] if frame.reflectivity else []
            if len(rows) > 2:
                *_, least, at, _, _, _, _ = np.transpose(rows)
                line = axis.errorbar(at, np.maximum(least, ROUND), ROUND, fmt="o", label=frame.name)
                distance, seen = np.geomspace(min(at), max(at), 50), Seen(frame.preset)
                middle = 100 * np.array([seen.least(one) for one in distance])
                axis.plot(distance, middle, color=line[0].get_color())
                axis.fill_between(distance, *(middle * factor for factor in seen.factors), color=line[0].get_color(), alpha=0.15)
        axis.set(xscale="log", yscale="log", xlabel="distance (m)", ylabel="least reflectivity (%)", ylim=(0.3, 100))
        axis.xaxis.set_major_formatter("{x:g}")  # 2, 3, 5, 10, ... instead of powers of ten
        axis.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:g}"[0] in "235" else "")
        axis.yaxis.set_major_formatter("{x:g}")
        axis.legend()
