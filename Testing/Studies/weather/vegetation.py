# SPDX-License-Identifier: BSD-3-Clause
"""Crowns of trees in real frames, beam by beam, beside the same beams simulated before foliage of the same outline: how many pass, and how
deep in the crown the others end.

    Testing/Studies/run.py vegetation --data DATA   # default: AVIANLIDAR_DATA_DIR

The data are not part of the project: Documentation/evidence/real-scans.md says what they are."""
import dataclasses
import pathlib
import warnings

import numpy as np
from scipy.optimize import brentq
from scipy.spatial import ConvexHull, cKDTree

import avianlidar as al
import room_data
import tools
from avianlidar.vtkAvianLidar import vtkAvianLidarMedium
from running import made, study

ALONE = 0.7          # m: points of a box without another one so near do not bound the crown
EDGE = 0.05          # m: range noise beyond the outline is still the crown
PARTS = 8            # of the crown by azimuth, for standard errors: neighbours meet the same branches
SEEDS = 5            # scans simulated of each density
REFLECTANCE = 0.3    # assumed: of what stands behind a crown
DENSITIES = 0.05, 50.0  # m2/m3, between which one is looked for ...
HALVINGS = 9         # ... to 0.7 % either way


@dataclasses.dataclass
class Crown:
    """A box about a crown, m, in the sensor's frame, drawn by eye on views from above and from two sides: crowns above a stem, free of
    ground, cars and walls."""
    name: str
    file: str
    preset: str  # the sensor file that is nearest
    low: tuple
    high: tuple


CROWNS = (
    Crown("VLP-16, 1", "lidar_vlp16_mrpt/vlp16.pcd", "VLP16", (-8.6, 13.4, 0.0), (-3.3, 18.6, 5.0)),
    Crown("VLP-16, 2", "lidar_vlp16_mrpt/vlp16.pcd", "VLP16", (-6.0, -14.5, 0.0), (-0.4, -8.4, 5.0)),
    Crown("VLP-16, 3", "lidar_vlp16_mrpt/vlp16.pcd", "VLP16", (1.8, -13.2, 0.0), (7.4, -7.8, 5.0)),
    Crown("OS2-32, A", "lidar_ouster/os2_32.pcd", "OS2_128", (-26.2, -30.6, 2.3), (-20.6, -18.5, 9.0)),
    Crown("OS2-32, B", "lidar_ouster/os2_32.pcd", "OS2_128", (22.2, -9.3, 0.4), (31.0, -0.5, 6.5)),
    Crown("OS1-32, A", "lidar_ouster/os1_32.pcd", "OS1_64", (-25.2, -30.6, 2.3), (-19.8, -17.5, 9.0)),
    Crown("OS1-32, B", "lidar_ouster/os1_32.pcd", "OS1_64", (23.8, -9.8, 0.4), (32.5, -1.2, 6.5)),
)


class Outline:
    """The convex hull of points."""

    def __init__(self, points):
        self.hull = ConvexHull(points)

    def crossing(self, directions):
        """Where rays from 0 enter and leave it, m; those that miss it leave before they enter."""
        slope, offset = directions @ self.hull.equations[:, :3].T, self.hull.equations[:, 3]
        with np.errstate(divide="ignore", invalid="ignore"):
            at = -offset / slope
        return np.where(slope < 0, at, -np.inf).max(axis=1), np.where(slope > 0, at, np.inf).min(axis=1)

    def surface(self):
        used = self.hull.vertices
        number = np.full(len(self.hull.points), -1)
        number[used] = np.arange(len(used))
        triangles = number[self.hull.simplices]
        corners = self.hull.points[self.hull.simplices]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inward = (normal * self.hull.equations[:, :3]).sum(axis=1) < 0
        triangles[inward] = triangles[inward, ::-1]
        return self.hull.points[used], triangles


def extinction_of(depths, chords):
    """Most likely extinction, 1/m, of depths where beams ended that would have gone so far; 0 where they end too deep for any."""
    def slope(extinction):
        x = extinction * chords
        return (1 / extinction - depths - chords / np.expm1(np.minimum(x, 700))).sum()
    return brentq(slope, 1e-6, 1e4) if slope(1e-6) > 0 else 0.0


def extinction_left(share, chords):
    """Extinction, 1/m, that leaves so large a share of beams."""
    return brentq(lambda extinction: np.exp(-extinction * chords).mean() - share, 0, 1e4) if 0 < share < 1 else np.nan


@dataclasses.dataclass
class Seen:
    """Beams that reach the outline. Ranges in m, NaN without an answer."""
    enter: np.ndarray
    leave: np.ndarray
    range: np.ndarray

    def __post_init__(self):
        self.chords = self.leave - self.enter
        self.passed = self.range > self.leave + EDGE
        self.nothing = np.isnan(self.range)
        self.ended = ~self.passed & ~self.nothing
        self.depths = np.clip(self.range - self.enter, 0, self.chords)[self.ended]

    def numbers(self):
        """Share that passes, without an answer among them; standard deviation and interquartile range of depths, m; extinction by them."""
        if self.ended.sum() < 5:
            return np.array([1 - self.ended.mean(), np.nan, np.nan, np.nan])
        low, high = np.percentile(self.depths, (25, 75))
        return np.array([1 - self.ended.mean(), self.depths.std(), high - low, extinction_of(self.depths, self.chords[self.ended])])

    def part(self, chosen):
        return Seen(self.enter[chosen], self.leave[chosen], self.range[chosen])


def standard_errors(seen, azimuth):
    """Of the numbers: the jackknife over parts of the crown."""
    order = np.argsort(np.argsort((azimuth - azimuth[0] + 180) % 360)) * PARTS // len(azimuth)
    left_out = np.array([seen.part(order != part).numbers() for part in range(PARTS)])
    return np.sqrt((PARTS - 1) / PARTS * ((left_out - left_out.mean(axis=0))**2).sum(axis=0))


def outlined(points, directions, ranges):
    """The outline of points that have others near, which beams reach it, and what they saw."""
    outline = Outline(points[cKDTree(points).query(points, 2)[0][:, 1] < ALONE])
    enter, leave = outline.crossing(directions)
    reached = (enter > 0) & (leave > enter + EDGE) & ~(ranges < enter - EDGE)
    return outline, reached, Seen(enter[reached], leave[reached], ranges[reached])


def measured(crown, data):
    """Outline, directions and azimuths (deg) of the beams that reach it, and what they saw."""
    scan = room_data.read_scan(pathlib.Path(data) / crown.file)
    points, _ = scan.points()
    points = points[((points > crown.low) & (points < crown.high)).all(axis=1)]
    outline, reached, seen = outlined(points, scan.directions(), scan.range)
    return outline, scan.directions()[reached], scan.azimuth[reached], seen


def behind(directions, seen):
    """Range of what stands behind the crown in each beam, NaN for the sky: as in the nearest beam that passed."""
    through = np.flatnonzero(~seen.ended)
    return seen.range[through[cKDTree(directions[through]).query(directions)[1]]]


def squares(directions, ranges, side):
    """Facing ones, a beam each. @param side half of it, of the range"""
    right = np.cross(directions, (0, 0, 1))
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(right, directions)
    corners = [(directions + side * (a * right + b * up)) * ranges[:, None] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    first = 4 * np.arange(len(ranges))[:, None]
    return np.stack(corners, axis=1).reshape(-1, 3), np.concatenate([first + (0, 1, 2), first + (0, 2, 3)])


class Simulated:
    """The same beams before foliage of the outline."""

    def __init__(self, crown, outline, directions, seen):
        self.seen, self.directions = seen, directions
        self.sensor = al.Sensor(crown.preset, directions=directions, rotation_rate=1e-2)
        ranges = behind(directions, seen)
        there = np.isfinite(ranges)
        self.behind = squares(directions[there], ranges[there], 1.2 * self.sensor.half_beamwidth)
        self.surface = al.mesh(*outline.surface())

    def scans(self, density):
        """What is seen, by seed."""
        foliage = made(vtkAvianLidarMedium(), Kind=vtkAvianLidarMedium.KIND_FOLIAGE, LeafAreaDensity=density,
                       Shape=vtkAvianLidarMedium.SHAPE_SURFACE, InputData=self.surface)
        scene = al.Scene(*self.behind, material=(REFLECTANCE, 0, 1))
        scene.add(foliage)
        for seed in range(SEEDS):
            echoes = al.Scan(scene, self.sensor, return_mode="Strongest", seed=seed).echoes
            ranges = np.full(len(self.seen.range), np.nan)
            ranges[np.array(echoes["beam_id"], int)] = echoes["distance_m"]
            yield Seen(self.seen.enter, self.seen.leave, ranges)

    def numbers(self, density):
        return np.mean([seen.numbers() for seen in self.scans(density)], axis=0)

    def by_own_outline(self, density):
        """The numbers where points are simulated, too, and the outline is theirs."""
        found = [outlined((self.directions * seen.range[:, None])[seen.ended], self.directions, seen.range)[2] for seen in self.scans(density)]
        return np.mean([seen.numbers() for seen in found], axis=0)

    def fitted(self, which, wanted):
        """The density of which a number, 0 the share or 3 the extinction, is as wanted, and the numbers there; or the last one tried and False."""
        low, high = DENSITIES
        sign = -1 if which == 0 else 1
        numbers = self.numbers(high)
        if sign * (numbers[which] - wanted) < 0:
            return high, numbers, False
        for _ in range(HALVINGS):
            middle = np.sqrt(low * high)
            numbers = self.numbers(middle)
            low, high = (middle, high) if sign * (numbers[which] - wanted) < 0 else (low, middle)
        return middle, numbers, True


def cells(numbers, errors=None):
    """Of a table."""
    plus = [""] * 4 if errors is None else [f" ± {100 * errors[0]:.1f}", *(f" ± {error:.2f}" for error in errors[1:])]
    share, *others = numbers
    return f"{100 * share:.1f}{plus[0]} %", *(f"{value:.2f}{error}" for value, error in zip(others, plus[1:]))


def rows(data):
    for crown in CROWNS:
        outline, directions, azimuth, seen = measured(crown, data)
        numbers = seen.numbers()
        yield (f"**{crown.name}**, {np.median(seen.enter):.0f} m: {len(azimuth)} beams, {seen.nothing.sum()} without an answer, "
               f"{seen.chords.mean():.1f} m of crown", f"{2 * extinction_left(numbers[0], seen.chords):.2f} by share, {2 * numbers[3]:.2f} by depths",
               *cells(numbers, standard_errors(seen, azimuth)))
        simulated = Simulated(crown, outline, directions, seen)
        for which, name in ((0, "share"), (3, "extinction")):
            density, there, found = simulated.fitted(which, numbers[which])
            yield f"simulated, same {name}", f"{density:.2f}" if found else f"none up to {density:.0f}", *cells(there)
            if which == 0 and found:
                yield "the same, outline of its own points", f"{density:.2f}", *cells(simulated.by_own_outline(density))


@study(data=[crown.file for crown in CROWNS])
def main(options):
    warnings.simplefilter("ignore", RuntimeWarning)  # a scan without an echo is expected
    tools.leave(options.out, "weather-vegetation", (
        "", "leaf area density, m²/m³", "share that passes", "depths: standard deviation, m", "interquartile range, m",
        "extinction by depths, 1/m"), list(rows(options.data)))
