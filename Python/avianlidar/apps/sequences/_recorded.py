# SPDX-License-Identifier: BSD-3-Clause
"""Tracks in recorded scans, which have no truth: tables, a map for GIS, a short page, and a state for ParaView."""
from __future__ import annotations

import collections
import csv
import datetime
import functools
import math
import pathlib
import types
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence as Many, Tuple

import numpy as np

from ..._disk import only_run, replacing, write_whole
from ..._pipeline import Error
from ..._ranks import as_json
from ..._recording import OF_FILE, Recording
from ..._sensor import Sensor
from ..._terminal import in_time, warn
from ..._version import __version__
from ..._writers import as_csv
from ..inputs._tables import texts
from ..pages import _drawing as drawing
from ..pages._html import First, Number, render, short_enough
from ..pages._words import counted
from ..places._from_above import draw_airport
from ..places._geojson import read_runways, to_geodetic
from ._card import cell, of_birds, of_tracks
from ._following import ORIGINS, Beams, Chain, Live, Scan, firing_times, read_truth, score
from ._labels import BIRD, MOVING

HEAD = ("track", "time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
DEGREES = ("longitude", "latitude", "height_m")
LOOKED_AT = 3  # scans in which the steps between beams are measured
STEPS = (0.05, 5.0)  # limits of these steps, deg
PAUSE = 10.0  # scans: a longer gap is a pause of the recording
LONG_ENOUGH = 600.0  # s from which on the page gives tracks an hour
FARTHEST = 20000.0  # m: median coordinate above which the origin is not the sensor
SINCE_1970 = 1e9  # times above are seconds since 1970
FASTEST = 2.0  # s: times of points further from the time of the scan are not used
NEAREST = 30.0  # least half width of the map, m
MOST_POINTS = 20000  # points of a scan on the map
HALF_BEAMWIDTH = 1.5e-3  # rad, of sensors that are not given (assumed)
NO_TRUTH = "Nothing says which of them are birds, and no score is known, because the recording has no truth."
MOST_HOURS = 24  # rows of the table on the page


class Track:
    """A confirmed track."""

    def __init__(self) -> None:
        self.rows: List[List[float]] = []  # time (s), place (m) and velocity (m/s)

    @property
    def path(self) -> np.ndarray:
        return np.array(self.rows)

    def facts(self) -> Dict[str, float]:
        """Start (s), duration (s), mean height (m), mean speed over ground (m/s), length of the path (m)."""
        path = self.path
        seconds, away = path[-1, 0] - path[0, 0], np.linalg.norm(np.diff(path[:, 1:4], axis=0), axis=1).sum()
        return {"start_s": path[0, 0], "duration_s": seconds, "mean_height_m": path[:, 3].mean(),
                "mean_speed_m_s": np.hypot(path[:, 4], path[:, 5]).mean(), "path_m": away, "scans": len(path)}


def _steps(cloud) -> Tuple[float, float]:
    """Median steps between beams in azimuth and elevation, deg; 0 if the cloud does not tell."""
    if "laser_id" not in cloud or not {"azimuth", "vertical_angle"} <= set(cloud):
        return 0.0, 0.0
    lasers, azimuth, elevation = (np.asarray(cloud[name], float) for name in ("laser_id", "azimuth", "vertical_angle"))
    across, up = [], []
    for laser in np.unique(lasers):
        of = lasers == laser
        up.append(np.median(elevation[of]))
        gaps = np.diff(np.sort(0.01 * azimuth[of]))
        across += gaps[gaps > 0.01].tolist()
    rise = np.diff(np.sort(up))
    rise = rise[rise > 0.01]
    return (float(np.median(across)) if across else 0.0), (float(np.median(rise)) if len(rise) else 0.0)


def beams_of(recording: Recording, sensor: Optional[Sensor], given: Optional[Many[float]] = None) -> Tuple[Beams, str]:
    """The steps between beams, from the sensor or else from the first scans, and words on where they come from. @param
    given position of the sensor"""
    placed = next(_scans(recording, given), None)
    position = placed[1] if placed else np.zeros(3)
    if sensor:
        return (Beams(sensor.azimuth_step, sensor.elevation_step, sensor.half_beamwidth, position),
                f"{sensor.azimuth_step:g} by {sensor.elevation_step:g} deg between beams, as the sensor has them")
    found = [_steps(cloud) for _, cloud in zip(range(LOOKED_AT), recording)]
    across, up = (float(np.median([one[axis] for one in found])) for axis in (0, 1))
    if not across or not up:
        return (Beams(0.0, 0.0, HALF_BEAMWIDTH, position),
                "no array laser_id, so the clutter filter's default cells are assumed")
    across, up = (float(np.clip(one, *STEPS)) for one in (across, up))
    return (Beams(across, up, HALF_BEAMWIDTH, position),
            f"{across:.3g} by {up:.3g} deg between beams, measured in the first scans")


def _scans(recording: Recording, given: Optional[Many[float]] = None,
           fired: Optional[Callable[[np.ndarray], np.ndarray]] = None) -> Iterator[Tuple[Scan, np.ndarray]]:
    """Each scan, and the position of the sensor. Points at the sensor, as of beams without an echo, are left out.
    @param given position of the sensor in the coordinates of files @param fired times of points by `firing_times`, if
    they have none"""
    for number, (cloud, time) in enumerate(zip(recording, recording.times.tolist())):
        points = cloud.points
        if recording.frame == OF_FILE:
            position = np.array(cloud.fields.get("position", np.zeros(3)) if given is None else given, float)
            relative, placed = points - position, points
            away = 0.0
            if len(points) and not position.any():
                away = float(np.linalg.norm(np.median(points[:, :2], axis=0)))
            if away > FARTHEST:
                raise Error(f"{recording.source}: points lie {away / 1e3:.0f} km from the origin of their coordinates, "
                            "and the files do not say where the sensor stands: expected --position X Y Z")
        else:
            pose = recording.pose(number)
            relative, placed, position = points, points @ pose[:, :3].T + pose[:, 3], pose[:, 3]
        times = np.asarray(cloud["timestamp"], float) if cloud.units.get("timestamp") == "us" else np.empty(0)
        known = times if len(times) and abs(1e-6 * times - time).max() < FASTEST else None
        if known is None and fired is not None:
            known = 1e6 * time + fired(placed - position)
        labels: np.ndarray = np.zeros(len(points), np.uint32)
        if "semantic_label" in cloud:
            labels = np.asarray(cloud["semantic_label"], np.uint32)
            if "instance_id" in cloud:
                labels = labels | np.asarray(cloud["instance_id"], np.uint32) << 16
        there = relative.any(axis=1)
        yield Scan(number, time, relative[there], placed[there], None if known is None else known[there],
                   labels[there]), position


class RecordedTracks:
    """Tracks of moving things in a recording: birds, and all else that moves, such as people, cars and leaves."""

    def __init__(self, recording: Recording, sensor: Optional[Sensor] = None, learning: int = 20,
                 clutter: Optional[Dict[str, Any]] = None, tracker: Optional[Dict[str, Any]] = None,
                 origin: Optional[Many[float]] = None, heading: float = 0.0, runways=None,
                 scans: Optional[int] = None, truth=None, cutoff: float = 20.0, order: float = 2.0,
                 position: Optional[Many[float]] = None):
        """Checks the inputs; `write` does the work.

        recording         of `load_clouds`; its sensor must stand still
        sensor            whose steps between beams and beam width are used; default: measured in the first scans
        learning          scans from which only clutter is learned; half of a recording that has fewer
        clutter, tracker  properties of vtkAvianLidarClutterFilter and vtkAvianLidarTracker by name
        origin            latitude, longitude (deg) and height (m) of the position, else of the recording's (0, 0, 0)
        heading           direction of the recording's y axis, deg from north, clockwise; it turns about the same place
        runways           a GeoJSON file, which needs an origin
        scans             number of scans that are read; default: all
        truth             a CSV file as truth.csv of a sequence, with places in the fixed frame of the recording;
                          default: the labels of birds, if the scans have labels
        cutoff, order     as in BirdTracks, for the scores
        position          of the sensor in the coordinates of files, m; default: as the files say
        """
        if origin is not None and not (abs(origin[0]) <= 90 and abs(origin[1]) <= 360 and abs(origin[2]) < 1e5):
            raise ValueError(f"the origin is {tuple(origin)}, expected latitude, longitude (deg) and height (m)")
        if scans is not None and scans < 1:
            raise ValueError(f"scans is {scans}, expected at least 1")
        if not math.isfinite(heading):
            raise ValueError(f"the heading is {heading}, expected degrees from north")
        if runways and origin is None:
            raise Error(f"{runways}: runways need an origin on the Earth, expected --origin LAT LON HEIGHT")
        self.recording, self.origin, self.heading = recording, origin, heading
        self.count = min(scans or len(recording), len(recording))
        self.learning = learning if self.count > learning else self.count // 2
        if self.learning < learning:
            warn(f"{recording.source}: has {counted(self.count, 'scan')}, so clutter is learned in the first "
                 f"{self.learning}, expected more than {learning}")
        if recording.moves:
            warn(f"{recording.source}: the sensor moves, but the clutter filter expects a sensor that stands still: "
                 "tracks may be walls")
        if position is not None and recording.frame != OF_FILE:
            raise ValueError(f"the position is {tuple(position)}, expected none: scans are {recording.frame}")
        self.position, self.anchor = position, np.zeros(3) if position is None else np.array(position, float)
        self.beams, self.beams_from = beams_of(recording, sensor, position)
        self.fired = firing_times(sensor) if sensor else None
        self.chain = Chain(self.beams, self.learning, dict(clutter or {}), dict(tracker or {}))
        self.runways = read_runways(runways, origin) if runways and origin is not None else []
        self.truth = None if truth is None else read_truth(truth)
        self.cutoff, self.order = cutoff, order
        self.scored: List[Tuple[int, List[Dict[str, Any]], Live, np.ndarray]] = []
        self.tracks: Dict[int, Track] = collections.defaultdict(Track)
        self.points = self.clutter = 0

    def _to_north(self, rows: np.ndarray) -> np.ndarray:
        """Rows with places and velocities in metres east, north and up."""
        turn = math.radians(self.heading)
        east = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        rows = rows.copy()
        rows[:, 1:3] = (rows[:, 1:3] - self.anchor[:2]) @ east.T + self.anchor[:2]
        rows[:, 4:6] = rows[:, 4:6] @ east.T
        return rows

    def _rows(self, progress: Callable[[str, int, int], Any]) -> Iterator[List[Any]]:
        """Rows of tracks.csv, as the scans are followed."""
        scans = (scan for scan, _ in _scans(self.recording, self.position, self.fired))
        for scan, live in self.chain.follow(scan for _, scan in zip(range(self.count), scans)):
            self.points += len(scan.points)
            self.clutter += int(live.clutter.sum())
            if scan.number >= self.learning:
                self._keep(scan, live)
            self.last, self.last_clutter = self._to_north(_padded(scan.placed))[:, 1:4], live.clutter
            for one in live.tracks[live.tracks["confirmed"]]:
                track = self.tracks[int(one["id"])]
                if track.rows and one["time"] <= track.rows[-1][0]:
                    continue
                row = self._to_north(np.array([[one["time"], *one["place"], *one["velocity"]]]))
                track.rows.append(row[0].tolist())
                degrees = [] if self.origin is None else to_geodetic(row[:, 1:4] - self.anchor, self.origin)[0].tolist()
                yield [int(one["id"]), f"{row[0, 0]:.6f}", *(f"{value:.3f}" for value in row[0, 1:]),
                       *(f"{value:.8f}" for value in degrees[:2]), *(f"{value:.2f}" for value in degrees[2:])]
            progress("scans followed", scan.number + 1, self.count)

    def _keep(self, scan: Scan, live: Live) -> None:
        """Keeps what the scores need, if the recording has a truth."""
        kind = scan.labels & 0xffff
        if self.truth is None:
            if not kind.any():
                return
            rows = []
            for bird in np.unique(scan.labels[kind == BIRD]):
                place = scan.placed[scan.labels == bird].mean(axis=0)
                rows.append({"bird": int(bird) >> 16, "species": "bird", "in": True, "time": scan.time,
                             "place": place.tolist(), "range": float(np.linalg.norm(place - self.beams.position)),
                             "weather": "as recorded"})
        else:
            rows = self.truth.get(scan.number, [])
        if kind.any():
            names = np.select([kind == BIRD, np.isin(kind, [*MOVING.values()])], ["bird", "vehicle"], "surface")
        else:  # a point near a bird is of the bird
            birds = np.array([row["place"] for row in rows]).reshape(-1, 1, 3)
            near = (np.linalg.norm(birds - scan.placed[live.of_points >= 0], axis=2) < self.cutoff).any(axis=0)
            names = np.full(len(scan.placed), "surface")
            names[live.of_points >= 0] = np.where(near, "bird", "surface")
        origins = np.array([ORIGINS.index(name) for name in names], np.uint8)
        self.scored.append((scan.number, rows, live, origins))

    def scores(self) -> List[List[str]]:
        """Rows of scores, with their errors by chance, if the recording has a truth and a bird."""
        if not any(rows for _, rows, _, _ in self.scored):
            return []
        found: Dict[str, Any] = {**score(self.scored, self.cutoff, self.order, []), "seconds": self.seconds()}
        return [[words, cell(value, unit)] for words, (unit, value) in
                {**of_birds(found["birds"]), **of_tracks([found])}.items()]

    def write(self, folder, progress: Callable[[str, int, int], Any] = lambda *_: None) -> Dict[str, Any]:
        """Writes tracks.csv (each position), summary.csv (each track), hours.csv, tracks.geojson with an origin,
        tracks.html and its pictures, and play.py for ParaView. @param progress called with the name of the work, the
        completed amount and the total @return numbers of the page"""
        out = pathlib.Path(folder)
        with only_run(out, goes_on=False):
            with replacing(out / "tracks.csv") as name, open(name, "w", newline="", encoding="utf-8") as stream:
                table = csv.writer(stream)
                table.writerow([*HEAD, *(DEGREES if self.origin is not None else ())])
                table.writerows(self._rows(progress))
            facts: List[Dict[str, float]] = [{"track": number, **track.facts()}
                                             for number, track in sorted(self.tracks.items())]
            hours = self._hours(facts)
            write_whole(out / "summary.csv", as_csv([[*facts[0]] if facts else ["track"],
                                                     *([row["track"], f"{row['start_s']:.6f}", *texts([*row.values()][2:])]
                                                       for row in facts)]))
            write_whole(out / "hours.csv", as_csv([HOUR_HEAD, *map(texts, hours)]))
            for name in ("tracks.geojson", "scores.csv"):  # of an earlier run
                (out / name).unlink(missing_ok=True)
            if self.origin is not None:
                write_whole(out / "tracks.geojson", as_json(self._shapes(facts)))
            if self.recording.files:
                write_whole(out / "play.py", self._script().encode())
            else:
                (out / "play.py").unlink(missing_ok=True)
            scores = self.scores()
            if scores:
                write_whole(out / "scores.csv", as_csv([["score", "value"], *scores]))
            found = {"scans": self.count, "tracks": len(facts), "seconds": self.seconds(), "points": self.points, "clutter": self.clutter, "scores": scores}
            write_whole(out / "tracks.html", render(
                "sequences/recorded.html.jinja", first=self._first(out, facts), pictures=self._pictures(out, facts),
                scores=scores, cutoff=self.cutoff,
                hours=[[f"{value:.3g}" if isinstance(value, float) else value for value in row]
                       for row in hours[:MOST_HOURS]], head=HOUR_HEAD, more=len(hours) - MOST_HOURS, recording=self.recording,
                learning=self.learning, share=self.clutter / max(self.points, 1),
                settings=", ".join(f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}" for name, value in
                                   {**self.chain.of_filter, **self.chain.of_tracker}.items()), version=__version__, source=str(self.recording.source),
                scans=counted(self.count, "scan")))
            return found

    def seconds(self) -> float:
        """Time after learning, s, with the time that the last scan takes and without pauses of the recording."""
        gaps = np.diff(self.recording.times[:self.count])
        middle = float(np.median(gaps)) if len(gaps) else 0.0
        seen = gaps[self.learning:]
        return float(np.where(seen > PAUSE * middle, middle, seen).sum()) + middle

    def _hours(self, facts: Many[Dict[str, float]]) -> List[List[Any]]:
        """A row for each hour in which a track begins."""
        first, rows = float(self.recording.times[0]), collections.defaultdict(list)
        for one in facts:
            begin = one["start_s"]
            rows[math.floor((begin if first > SINCE_1970 else begin - first) / 3600.0)].append(one)

        def name(hour: int) -> str:
            if first <= SINCE_1970:
                return f"hour {hour + 1}"
            return datetime.datetime.fromtimestamp(3600 * hour, datetime.timezone.utc).strftime("%Y-%m-%d %H:00 UTC")
        return [[name(hour), len(of), *(float(np.median([one[key] for one in of]))
                                        for key in ("duration_s", "mean_height_m", "mean_speed_m_s"))]
                for hour, of in sorted(rows.items())]

    def _shapes(self, facts: Many[Dict[str, float]]) -> Dict[str, Any]:
        assert self.origin is not None
        features = []
        for one in facts:
            degrees = to_geodetic(self.tracks[int(one["track"])].path[:, 1:4] - self.anchor, self.origin)
            line = [[round(lon, 8), round(lat, 8), round(up, 2)] for lon, lat, up in degrees.tolist()]
            features.append({"type": "Feature", "properties": {key: round(value, 3) for key, value in one.items()},
                             "geometry": {"type": "LineString", "coordinates": line if len(line) > 1 else line * 2}})
        return {"type": "FeatureCollection", "features": features, "description":
                f"Tracks of moving things in {pathlib.Path(str(self.recording.source)).name}; heights above WGS84"}

    def _script(self) -> str:
        def own(properties: Dict[str, Any]) -> Dict[str, Any]:
            """Properties by the names that ParaView has."""
            return {"".join(map(str.capitalize, name.split("_"))): value for name, value in properties.items()}
        return SCRIPT.format(files=[str(file.resolve()) for file in self.recording.files[:self.count]],
                             rate=self.recording.rate or 0.0, clutter=own(self.chain.of_filter),
                             tracker=own({**self.chain.of_tracker, "history_length": 200}))

    def _first(self, out: pathlib.Path, facts: Many[Dict[str, float]]) -> First:
        name, hours = pathlib.Path(str(self.recording.source)).name, max(self.seconds() / 3600.0, 1e-9)
        heights, speeds = ([one[key] for one in facts] for key in ("mean_height_m", "mean_speed_m_s"))

        def middle(values: Many[float], unit: str) -> str:
            return f"{np.median(values):.3g}\u00a0{unit}" if values else "–"
        heights_are = "above the origin" if self.recording.frame == OF_FILE or self.recording.poses else \
            "above the sensor"
        shown = drawing.picture(out / "map.png", (drawing.WIDTH, 4.4), "Map of tracks",
                                "Confirmed tracks (lines, with their ends), and the points of the last scan: grey is clutter.",
                                self._draw_map)
        steps = [("Look at single tracks.", "summary.csv has each track, tracks.csv each position."),
                 ("Play the recording.", "In ParaView, File > Load State opens play.py." if self.recording.files else
                  "`avianlidar convert` writes its scans as files, and `avianlidar track` of these makes a state for "
                  "ParaView."),
                 ("Try other settings.", "--clutter-set clutter_threshold=0.02 and --tracker-set minimum_speed=5 leave "
                  "out more of what sways and stands.")]
        return First(
            f"What moves in {name}?",
            short_enough(f"{counted(len(facts), 'thing')} moved through the beams in "
                         f"{in_time(self.seconds())}"
                         f"{f', {len(facts) / hours:,.0f} an hour' if self.seconds() >= LONG_ENOUGH else ''}."), shown,
            [Number(f"{len(facts)}", "confirmed tracks", f"in {counted(self.count, 'scan')}, of which the first "
                    f"{self.learning} only teach what stands still"),
             Number(middle(heights, "m"), "median height", f"of tracks, {heights_are}"),
             Number(middle(speeds, "m/s"), "median speed", "of tracks, over ground")],
            [{"head": head, "words": words, "command": ""} for head, words in steps],
            ["Tracks are of all that moves: birds, people, cars, leaves and rain. "
             f"{'The next page has scores by the truth.' if self.scored else NO_TRUTH} "
             f"{'' if self.heading or self.recording.poses else 'North is taken as the y axis of the recording. '}Times are from: "
             f"{self.recording.times_from}. Of the sensor: {self.beams_from}."])

    def _extent(self) -> Tuple[float, float, float, float]:
        x, y = self._to_north(_padded(np.array([self.beams.position])))[0, 1:3]
        places = np.vstack([track.path[:, 1:3] for track in self.tracks.values()]) if self.tracks else self.last[:, :2]
        away = np.abs(places - (x, y)).max(axis=1) if len(places) else np.zeros(1)
        half = max(NEAREST, 1.1 * float(np.quantile(away, 0.98)))
        return x - half, x + half, y - half, y + half

    def _draw_map(self, axes) -> None:
        extent = self._extent()
        position = self._to_north(_padded(np.array([self.beams.position])))[0, 1:4]
        draw_airport(axes, types.SimpleNamespace(runways=self.runways, scene=None, ground=None, extent=extent,
                                                 sensor=types.SimpleNamespace(position=position)))
        middle, half = 0.5 * (extent[0] + extent[1]), 0.85 * (extent[3] - extent[2])
        axes.set(xlim=(middle - half, middle + half))
        step = -(-len(self.last) // MOST_POINTS) or 1
        for chosen, colour in ((self.last_clutter, "0.7"), (~self.last_clutter, "black")):
            axes.plot(*self.last[chosen][::step, :2].T, ".", color=colour, markersize=1.0, zorder=0)
        for track in self.tracks.values():
            axes.plot(*track.path[:, 1:3].T, color="#0072b2", linewidth=1.0)
            axes.plot(*track.path[-1, 1:3], "o", color="#0072b2", markersize=2.5)

    def _pictures(self, out: pathlib.Path, facts: Many[Dict[str, float]]) -> List[Dict[str, Any]]:
        def bars(axes, key: str, label: str) -> None:
            axes.hist([one[key] for one in facts], bins=20, color="#0072b2")
            drawing.finish(axes, xlabel=label, ylabel="tracks")
        half = 0.5 * drawing.WIDTH - 0.1
        return [drawing.picture(out / f"{file}.png", (half, 2.4), words, f"{words} of {counted(len(facts), 'track')}.",
                                functools.partial(bars, key=key, label=label))
                for file, words, key, label in (("heights", "Mean heights", "mean_height_m", "mean height, m"),
                                                ("speeds", "Mean speeds", "mean_speed_m_s", "mean speed, m/s"))
                if facts]


HOUR_HEAD = ["hour", "tracks", "median duration (s)", "median height (m)", "median speed (m/s)"]


def _padded(places: np.ndarray) -> np.ndarray:
    """Places as rows of a track: a column of times before, and velocities behind."""
    return np.column_stack([np.zeros(len(places)), places, np.zeros((len(places), 3))])


SCRIPT = '''# SPDX-License-Identifier: BSD-3-Clause
"""ParaView state: a recording with its clutter (grey), what is left (black) and confirmed tracks (blue), to play. In
ParaView: File > Load State."""
from paraview import simple

FILES = {files!r}
if not hasattr(simple, "AvianLidarPointCloudReader"):
    simple.LoadDistributedPlugin("AvianLidarPlugin", remote=False, ns=vars(simple))
view = simple.GetActiveViewOrCreate("RenderView")
scans = simple.AvianLidarPointCloudReader(registrationName="Scans", FileName=FILES, ScanRate={rate!r})
clutter = simple.AvianLidarClutterFilter(registrationName="Clutter filter", Input=scans, **{clutter!r})
tracker = simple.AvianLidarTracker(registrationName="Tracker", Input=clutter, **{tracker!r})
tracks = simple.Threshold(registrationName="Tracks", Input=tracker, Scalars=["CELLS", "confirmed"],
                          ThresholdMethod="Above Upper Threshold", UpperThreshold=1)
view.UseColorPaletteForBackground, view.Background = 0, [1.0, 1.0, 1.0]
for name, value, colour, size in (("Clutter", 1, [0.7] * 3, 1), ("What is left", 0, [0.0] * 3, 4)):
    points = simple.Threshold(registrationName=name, Input=clutter, Scalars=["POINTS", "is_clutter"],
                              LowerThreshold=value - 0.5, UpperThreshold=value + 0.5)
    shown = simple.Show(points, view, Representation="Points", PointSize=size)
    shown.ColorArrayName, shown.AmbientColor, shown.DiffuseColor = ["POINTS", ""], colour, colour
shown = simple.Show(tracks, view, Representation="Wireframe", LineWidth=3)
shown.ColorArrayName, shown.AmbientColor, shown.DiffuseColor = ["POINTS", ""], [0.0, 0.45, 0.7], [0.0, 0.45, 0.7]
scene = simple.GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToFirst()
simple.ResetCamera(view)
'''
