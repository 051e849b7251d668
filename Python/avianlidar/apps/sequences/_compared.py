# SPDX-License-Identifier: BSD-3-Clause
"""A recording beside the simulation of its scene: echoes, ranges, intensities and drop-outs, on one page."""
from __future__ import annotations

import pathlib
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence as Many, Tuple

import numpy as np

from ..._cloud import triangles_of
from ..._disk import only_run, write_whole
from ..._pipeline import Error, update
from ..._recording import OF_FILE, Recording
from ..._scan import Scan
from ..._scene import Scene
from ..._sensor import Sensor
from ..._version import __version__
from ..._writers import as_csv
from ..inputs._tables import texts
from ..pages import _drawing as drawing
from ..pages._html import First, Number, render, short_enough
from ..pages._words import counted

SAME = 0.5  # m: a beam meets the same thing in simulation and recording (assumed)
NEIGHBOURS = 1.0  # steps between beams within which a recorded point belongs to a beam
LANDMARKS = 2000  # points that are aligned
ROUNDS = 60  # of alignment, at most
STILL = 1e-4  # m: a change that ends the alignment
FAR = 3.0  # medians of distance from which on a point has no weight
LEAST_FAR = 0.3  # m, least distance of a point without weight
NEAR = 0.05  # share of the median range: points that are nearer to surfaces, at the median, are on them
WIDEST = 45.0  # deg: greatest turn of an alignment
GRAZED = 0.1  # cosine of incidence below which a surface returns little: a point near it is of another surface
# A direction in which distances change by this share of the greatest change stays as it is: first, and near the end.
OPEN = (0.1, 0.02)
ANGLES = np.arange(0.0, 361.0, 45.0)  # limits of sectors, deg from north, clockwise
RANGES = (0.0, 10.0, 25.0, 50.0, 100.0, 200.0, 400.0, np.inf)  # limits of bands, m


class Pose(NamedTuple):
    """The place and the turn of a sensor in the scene's frame."""

    turn: np.ndarray  # 3 x 3, from right, forward and up of the sensor
    place: np.ndarray  # m

    def of(self, points: np.ndarray) -> np.ndarray:
        return points @ self.turn.T + self.place

    def orientation(self) -> Tuple[float, float, float]:
        """Yaw from north, pitch and roll, deg."""
        from scipy.spatial.transform import Rotation
        turn, pitch, roll = Rotation.from_matrix(self.turn).as_euler("ZXY", degrees=True)
        return -float(turn), float(pitch), float(roll)

    def words(self) -> str:
        return ("({:.2f}, {:.2f}, {:.2f}) m".format(*(round(float(one), 2) + 0.0 for one in self.place))
                + ", yaw {:.2f}, pitch {:.2f}, roll {:.2f} deg".format(*(round(one, 2) + 0.0 for one in
                                                                         self.orientation())))


def relative(recording: Recording, cloud) -> np.ndarray:
    """The points of a cloud relative to its sensor."""
    return cloud.points - cloud.fields.get("position", np.zeros(3)) if recording.frame == OF_FILE else cloud.points


def pose_of(recording: Recording, cloud, scene: Scene, position: Optional[Many[float]], heading: Optional[float]) -> Pose:
    """The pose of the sensor: as given, else as the recording says, else at the lidar's place in the scene."""
    from scipy.spatial.transform import Rotation
    pose = recording.pose(0)
    turn = pose[:, :3] if recording.poses is not None else np.eye(3)
    if heading is not None:
        turn = Rotation.from_euler("Z", -heading, degrees=True).as_matrix()
    place = cloud.fields.get("position", np.zeros(3)) if recording.frame == OF_FILE else np.zeros(3)
    places = [position, pose[:, 3] if recording.poses is not None else None,
              place if np.any(place) else None, scene.lidar_position, (0, 0, 0)]  # (0, 0, 0) may be a default of PCD
    return Pose(turn, np.array(next(place for place in places if place is not None), float))


def aligned(points: np.ndarray, pose: Pose, scene: Scene) -> Tuple[Pose, str]:
    """The pose for which points lie nearest to the surfaces, by iterative closest points with distances from planes
    (Chen and Medioni 1992), and words on the change. Points far from all surfaces, such as cars and leaves, have no
    weight, and what the surfaces leave open does not change. @param points relative to the sensor"""
    from scipy.spatial.transform import Rotation
    from vtkmodules.vtkCommonCore import mutable
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
    update(scene.tree)
    surfaces = scene.tree.GetOutput()
    corners, triangles = triangles_of(surfaces)
    sides = corners[triangles[:, 1:]] - corners[triangles[:, :1]]
    normals = np.cross(sides[:, 0], sides[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surfaces)
    locator.BuildLocator()
    chosen = points[::-(-len(points) // LANDMARKS) or 1]

    def nearest(places: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """The nearest points of the surfaces, and the surfaces' normals there."""
        found, at, cell, part, square = [], [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
        for place in places.tolist():
            locator.FindClosestPoint(place, at, cell, part, square)
            found.append((*at, int(cell)))
        table = np.array(found)
        return table[:, :3], normals[table[:, 3].astype(int)]
    now, first, away, reach = pose, np.nan, np.empty(0), np.maximum(np.linalg.norm(chosen, axis=1), 1e-9)
    closed, enough, best = 0, max(LEAST_FAR, NEAR * float(np.median(reach))), None

    def turned(at: Pose) -> float:
        """The angle from the given pose, deg."""
        return float(np.degrees(np.arccos(np.clip((np.trace(at.turn @ pose.turn.T) - 1) / 2, -1, 1))))
    for _ in range(ROUNDS):
        places = now.of(chosen)
        on, normal = nearest(places)
        away = np.linalg.norm(places - on, axis=1)
        first = float(np.median(away)) if np.isnan(first) else first
        weight = np.clip(1.0 - (away / max(FAR * float(np.median(away)), LEAST_FAR))**2, 0.0, 1.0)
        facing = np.abs((normal * (places - now.place)).sum(axis=1)) / reach
        weight *= np.where(facing > GRAZED, facing, 0.0)
        middle = places.mean(axis=0)
        size = float(np.linalg.norm(places - middle, axis=1).mean())
        rows = np.hstack([normal, np.cross(places - middle, normal) / size]) * weight[:, None]
        step = np.linalg.lstsq(rows, -weight * ((places - on) * normal).sum(axis=1), rcond=OPEN[closed])[0]
        turn = Rotation.from_rotvec(step[3:] / size).as_matrix()
        now = Pose(turn @ now.turn, turn @ (now.place - middle) + middle + step[:3])
        if np.abs(step).max() < STILL:
            closed += 1
            middle_off = float(np.median(away))
            if middle_off <= min(first, enough) and turned(now) < WIDEST and (best is None or middle_off <= best[1]):
                best = now, middle_off
            if closed == len(OPEN):
                break
    if best is None:
        return pose, (f"Not aligned, the pose is as given: no pose was found near by at which the points lie on the "
                      f"surfaces; their median distance stays {first:.2f} m.")
    now, middle_off = best
    return now, (f"Aligned: moved by {float(np.linalg.norm(now.place - pose.place)):.2f} m and turned by "
                 f"{turned(now):.2f} deg; the median distance of points from surfaces went from {first:.2f} to "
                 f"{middle_off:.2f} m.")


class Comparison:
    """A recording beside the simulation of its scene."""

    def __init__(self, scene: Scene, recording: Recording, sensor: Sensor, position: Optional[Many[float]] = None,
                 heading: Optional[float] = None, align: bool = False, scans: Optional[int] = None,
                 progress: Callable[[str, int, int], Any] = lambda *_: None, **settings: Any):
        """Simulates one scan, and compares each recorded scan with it.

        scene      whose frame has metres east, north and up
        recording  of `load_clouds`
        sensor     the lidar that recorded
        position   of the sensor in the scene, m; default: of the recording, else the lidar's place in the scene
        heading    direction of the sensor's forward axis, deg from north, clockwise; default: of the recording, else 0
        align      whether the pose is improved so that the recorded points lie on the surfaces
        scans      number of scans that are read; default: all
        settings   properties of the scan
        """
        from scipy.spatial import cKDTree
        self.scene, self.recording = scene, recording
        if scans is not None and scans < 1:
            raise ValueError(f"scans is {scans}, expected at least 1")
        self.count = min(scans or len(recording), len(recording))
        first = next(iter(recording))
        self.pose, self.change = pose_of(recording, first, scene, position, heading), ""
        if align:
            self.pose, self.change = aligned(relative(recording, first), self.pose, scene)
        self.sensor = sensor.set(position=tuple(self.pose.place), orientation=self.pose.orientation(),
                                 number_of_revolutions=1)
        self.scan = Scan(scene, self.sensor, **settings)
        echoes, beams = self.scan.echoes, self.sensor.beams
        self.direction = np.array(beams["direction"])
        strongest = np.full(len(self.direction), -1)
        rising = np.argsort(echoes["energy"], kind="stable")
        strongest[echoes["beam_id"][rising]] = rising
        self.seen = strongest >= 0

        def of_beams(name: str, nothing: float) -> np.ndarray:
            return np.where(self.seen, np.append(np.asarray(echoes[name], float), nothing)[strongest], nothing)
        self.simulated, self.light = of_beams("distance_m", np.nan), of_beams("intensity", np.nan)
        self.material = of_beams("material_id", -1).astype(int)
        self.materials = list(echoes.fields.get("material_names", ()))
        steps = [step for step in (sensor.azimuth_step, sensor.elevation_step) if step > 0.0] or [0.5]
        tree, widest = cKDTree(self.direction), np.radians(NEIGHBOURS * max(steps))
        self.hits = np.zeros(len(self.direction), int)
        self.ranges = np.full(len(self.direction), np.nan)  # of the last scan with a point
        self.bright = np.full(len(self.direction), np.nan)
        self.differences, self.others, self.points = [], 0, 0
        self.recorded_bins = np.zeros((len(ANGLES) - 1, len(RANGES) - 1))
        for number, cloud in zip(range(self.count), recording):
            places = relative(recording, cloud) @ self.pose.turn.T
            away = np.linalg.norm(places, axis=1)
            known = away > 0.0
            places, away = places[known], away[known]
            off, beam = tree.query(places / away[:, None], distance_upper_bound=widest)
            inside = np.isfinite(off)
            self.points += len(places)
            self.others += int((~inside).sum())
            light = np.asarray(cloud["intensity"], float)[known][inside] if "intensity" in cloud else -away[inside]
            order = np.argsort(light, kind="stable")  # of several points the brightest one stays, else the nearest one
            beam, away = beam[inside][order], away[inside][order]
            if "intensity" in cloud:
                self.bright[beam] = light[order]
            self.ranges[beam] = away
            self.hits[np.unique(beam)] += 1
            last = np.full(len(self.direction), np.nan)
            last[beam] = away
            there = np.isfinite(last)
            self.recorded_bins += _bins(self.direction[there], last[there])
            self.differences.append((last - self.simulated)[np.isfinite(last) & self.seen])
            progress("scans compared", number + 1, self.count)
        if not self.hits.any():
            raise Error(f"{recording.source}: none of its {self.points} points lies in a beam of the sensor at "
                        f"{self.pose.words()}, expected its lidar and its pose")
        self.simulated_bins = _bins(self.direction[self.seen], self.simulated[self.seen])

    def numbers(self) -> Dict[str, float]:
        """Shares of beams and differences of ranges."""
        off = np.concatenate(self.differences) if self.differences else np.empty(0)
        share = self.hits / self.count
        both = share[self.seen]
        return {"beams": len(self.direction), "simulated": float(self.seen.mean()), "recorded": float(share.mean()),
                "drop_outs": float(1.0 - both.mean()) if len(both) else np.nan,
                "missing": float(share[~self.seen].sum() / max(share.sum(), 1e-9)),
                "median": float(np.median(off)) if len(off) else np.nan,
                "spread": float(np.median(np.abs(off - np.median(off)))) if len(off) else np.nan,
                "agree": float((np.abs(off) <= SAME).sum() / self.hits.sum()),
                "same": float((np.abs(off) <= SAME).mean()) if len(off) else np.nan,
                "nearer": float((off < -SAME).mean()) if len(off) else np.nan,
                "farther": float((off > SAME).mean()) if len(off) else np.nan,
                "outside": self.others / max(self.points, 1)}

    def by_material(self) -> List[List[Any]]:
        """A row for each material that the simulation meets."""
        rows = []
        for number in np.unique(self.material[self.seen]):
            of = self.seen & (self.material == number)
            name = self.materials[number] if 0 <= number < len(self.materials) else "noise and air"
            same = of & (np.abs(self.ranges - self.simulated) <= SAME)
            rows.append([name, int(of.sum()), float(self.hits[of].mean() / self.count),
                         *(float(np.median(values[same])) if same.any() else np.nan
                           for values in (self.light, self.bright))])
        return rows

    def by_place(self) -> Dict[str, List[List[Any]]]:
        """Beams with an echo in a scan, simulated and recorded, by direction and by range."""
        recorded = self.recorded_bins / self.count
        return {"azimuth": [[f"{low:g} to {high:g}°", float(a), float(b)] for low, high, a, b in zip(
            ANGLES[:-1], ANGLES[1:], self.simulated_bins.sum(axis=1), recorded.sum(axis=1))],
                "range": [[f"{low:g} m on" if np.isinf(high) else f"{low:g} to {high:g} m", float(a), float(b)]
                          for low, high, a, b in zip(RANGES[:-1], RANGES[1:], self.simulated_bins.sum(axis=0),
                                                     recorded.sum(axis=0))]}

    def write(self, folder) -> Dict[str, float]:
        """Writes compare.html, its picture, numbers.csv, materials.csv, places.csv and beams.csv. @return numbers"""
        out, found, places = pathlib.Path(folder), self.numbers(), self.by_place()
        names = ["material", "beams", "recorded share", "simulated intensity", "recorded intensity"]
        with only_run(out, goes_on=False):
            write_whole(out / "numbers.csv", as_csv([["number", "value"], *(texts(row) for row in found.items())]))
            write_whole(out / "materials.csv", as_csv([names, *map(texts, self.by_material())]))
            write_whole(out / "places.csv", as_csv([["by", "part", "simulated", "recorded"], *(
                texts([by, *row]) for by, rows in places.items() for row in rows)]))
            columns = (*self._angles(), self.simulated, self.ranges, self.hits / self.count, self.light, self.bright)
            write_whole(out / "beams.csv", as_csv([
                ["azimuth_deg", "elevation_deg", "simulated_m", "recorded_m", "recorded_share", "simulated_intensity",
                 "recorded_intensity"], *(texts(row) for row in zip(*(values.tolist() for values in columns)))]))
            write_whole(out / "compare.html", render(
                "sequences/compared.html.jinja", first=self._first(out, found), found=found, version=__version__,
                materials=[[row[0], row[1], *(_cell(value) for value in row[2:])] for row in self.by_material()],
                names=names, places={by: [[row[0], *map(_cell, row[1:])] for row in rows]
                                     for by, rows in places.items()},
                source=str(self.recording.source), recording=self.recording, pose=self.pose.words(),
                change=self.change, scans=counted(self.count, "scan"), same=SAME))
        return found

    def sentence(self, found: Dict[str, float]) -> str:
        if not self.seen.any():
            return "The simulation has no echo: the scene is out of reach of the sensor at this pose."
        return short_enough(f"{100 * found['agree']:.3g} % of recorded echoes lie within {SAME:g} m of the simulated "
                            f"ones; {100 * found['drop_outs']:.3g} % of simulated echoes are not recorded.")

    def _angles(self) -> Tuple[np.ndarray, np.ndarray]:
        """Azimuth from north and elevation of the beams, deg."""
        east, north, up = self.direction.T
        return np.degrees(np.arctan2(east, north)) % 360.0, np.degrees(np.arcsin(np.clip(up, -1, 1)))

    def _first(self, out: pathlib.Path, found: Dict[str, float]) -> First:
        shown = drawing.picture(out / "ranges.png", (drawing.WIDTH, 4.6), "Range images",
                                "Ranges as simulated and as recorded, and recorded minus simulated (dark grey: only "
                                "one of them has an echo, light grey: none).", self._draw, rows=3)
        steps = [("Look at the difference.", "Red parts are farther away in the recording, blue parts nearer: the scene "
                  "lacks or has something, or the pose is wrong."),
                 ("Improve the pose.", self.change or "--align moves the sensor until the points lie on the surfaces."),
                 ("Adapt materials.", "materials.csv has the share of recorded echoes and the intensities by material.")]
        assumed = ("Simulated with the sensor's numbers, of which assumed are: "
                   f"{', '.join(self.sensor.beams.fields.get('assumed', [])) or 'none'}. A point belongs to the nearest "
                   f"beam; {100 * found['outside']:.3g} % of the points belong to no beam of the sensor. Intensities of "
                   "real lidars have units of their own: compare materials with each other, not the columns.")
        return First("Does the simulation look like the recording?",
                     self.sentence(found), shown,
                     [Number(f"{100 * found['recorded']:.3g}\u00a0%", "of beams return", "in the recording; simulated "
                             f"{100 * found['simulated']:.3g} %"),
                      Number(f"{_cell(found['median'])}\u00a0m", "recorded minus simulated", "median of ranges; the median "
                             f"deviation from it is {_cell(found['spread'])} m"),
                      Number(f"{_cell(100 * found['drop_outs'])}\u00a0%", "drop-outs", "of simulated echoes, which the "
                             f"recording lacks in {counted(self.count, 'scan')}")],
                     [{"head": head, "words": words, "command": ""} for head, words in steps], [assumed])

    def _draw(self, axes) -> None:
        azimuth, elevation = self._angles()
        both = np.concatenate([self.simulated[self.seen], self.ranges[np.isfinite(self.ranges)], [1.0]])
        most = float(np.quantile(both, 0.99))
        off = self.ranges - self.simulated
        limit = max(SAME, float(np.nanquantile(np.abs(off), 0.9)) if np.isfinite(off).any() else SAME)
        used = self.seen | np.isfinite(self.ranges)
        size = 0.5 if len(azimuth) > 20000 else 1.5
        for ax, values, colours, limits, label in (
                (axes[0], self.simulated, "viridis", (0, most), "simulated (m)"),
                (axes[1], self.ranges, "viridis", (0, most), "recorded (m)"),
                (axes[2], off, "RdBu_r", (-limit, limit), "difference (m)")):
            known = np.isfinite(values)
            if ax is axes[2]:
                one = used & ~known
                ax.set_facecolor("0.9")
                ax.scatter(azimuth[one], elevation[one], s=size, c="0.55", marker="s", linewidths=0, rasterized=True)
            dots = ax.scatter(azimuth[known], elevation[known], s=size, c=values[known], cmap=colours, vmin=limits[0],
                              vmax=limits[1], marker="s", linewidths=0, rasterized=True)
            ax.figure.colorbar(dots, ax=ax, label=label)
            rows = elevation[used] if used.any() else elevation
            ax.set(xlim=(0, 360), ylim=(rows.min() - 1, rows.max() + 1), ylabel="elevation (deg)")
        axes[2].set(xlabel="azimuth (deg from north)")


def _bins(directions: np.ndarray, away: np.ndarray) -> np.ndarray:
    """Numbers of beams by sector and band of range."""
    azimuth = np.degrees(np.arctan2(directions[:, 0], directions[:, 1])) % 360.0
    limits: Any = (ANGLES, np.array([*RANGES[:-1], 1e9]))
    return np.histogram2d(azimuth, away, bins=limits)[0]


def _cell(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
