# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories of platforms, such as cars and drones, from files: VTK, tables, GPX, KML and bags of ROS.

Sources: the schema of GPX 1.1 (topografix.com/GPX/1/1); KML 2.3 (OGC 12-007r2), and Google's reference for gx:Track."""
from __future__ import annotations

import csv
import inspect
import io
import math
import os
import pathlib
import re
import warnings
import zipfile
import zlib
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple
from xml.etree import ElementTree

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from ..._bags import SUFFIXES
from ..._cloud import Cloud, add_array
from ..._files import LARGEST, load_cloud, read_regular
from ..._pipeline import Error, callers_level
from ..._properties import unknown
from ..._recording import TURNED, moving_poses
from ..._scene import load_scene
from ..._sensor import trajectory
from ..inputs._json import naming
from ..places._candidates import ground_of
from ._flights import check_level, check_metres, columns_of, origin_of, points_of
from ._logs import LEVELS, OUTLIERS, SINCE_1970, Log, seconds_of

TABLES, MARKUP, FOLDER = (".csv", ".tsv", ".txt"), (".gpx", ".kml", ".kmz"), "or a folder"
USERS = {"columns": TABLES, "track": TABLES + MARKUP, "frame": (*SUFFIXES, FOLDER)}  # suffixes by the argument
LEAST = 3.0  # m: a shorter way gives no heading, as standing GPS receivers scatter (assumed)
BEND = 10.0  # m before and after a bend of the way in which a platform turns (assumed)
STANDS = 0.6  # share of the time of a leg in which less than half of LEAST is covered, from which on a platform stands
LONG = 10.0  # s, and medians of steps: longer gaps between points are said
ANGLES, QUATERNION = ("heading", "pitch", "roll"), ("qx", "qy", "qz", "qw")
MODES = {"clampToGround": "clamp", "relativeToGround": "ground", "absolute": "sea"}  # levels by KML's altitudeMode


class _Points(NamedTuple):
    """The points of a file, in its order."""
    times: np.ndarray  # s; NaN if unknown
    places: np.ndarray  # n x 3: longitude, latitude (deg) and height (m), or x, y and z (m); NaN if unknown
    level: str = ""  # that heights count from, of LEVELS, or "clamp"; empty: the scene's origin
    in_degrees: bool = False
    angles: Any = None  # n x 3: heading, pitch and roll, deg; NaN if unknown
    turns: Any = None  # Rotation of each point, from x right, y forward, z up to east, north and up
    left: Mapping[str, int] = {}  # numbers of points that are left out, by reason
    notes: Sequence[str] = ()  # sentences on what may be missing


def read_trajectory(file, scene=None, start_time: Any = None, origin: Any = None, height_reference: str = "",
                    geoid_undulation: Optional[float] = None, columns: Optional[Dict[str, str]] = None,
                    track: str = "", frame: str = "") -> vtkPolyData:
    """The trajectory of a moving platform: a line in metres east, north and up, with the point arrays `time` (s) and
    `pose_orientation` (unit quaternions w, x, y, z, from x right, y forward, z up to east, north and up). If times
    count from 1970, the field data `start_time` is time 0 in s since 1970.

    file              vtkPolyData or .vtp (arrays `time`, and `pose_orientation` or `heading`, `pitch`, `roll`), a table
                      (.csv, .tsv, .txt), .gpx, .kml, .kmz, or a bag of ROS or its folder (the transforms)
    scene             a Scene or the name of a scene file, for longitudes and latitudes and for the ground
    start_time        time 0: seconds of the file's clock, or, if it counts from 1970, a datetime or a text in ISO 8601
                      (in UTC without a zone); default: the first time if times count from 1970, else as in the file
    origin            latitude, longitude (deg) and height (m) of the scene's origin; default: from the scene
    height_reference  level that heights count from: sea, ground or ellipsoid, or clamp: the platform stands on the
                      ground, as points of GPX and KML without a height do; default: as the file says
    geoid_undulation  height of the sea level above the ellipsoid, m
    columns           names of columns of a table by meaning, also heading, pitch, roll, qx, qy, qz and qw
    track             name of one of several tracks in a file
    frame             name of the platform's frame in a bag; default: that of the clouds, else the only one that moves

    Degrees are clockwise from north (heading), nose up (pitch) and right side down (roll). A platform without them
    heads along its way, and is level. Points without a position or a time are left out, with a warning."""
    given = isinstance(file, vtkPolyData)
    name, path = "the trajectory" if given else str(file), pathlib.Path("" if given else file)
    suffix = ".vtp" if given else FOLDER if path.is_dir() else path.suffix.lower()
    suffixes = (".vtp", *USERS["track"], *USERS["frame"])
    if suffix not in suffixes:
        raise ValueError(f"{name}: is not a trajectory, expected {', '.join(suffixes)}")
    for what, value in (("columns", columns), ("track", track), ("frame", frame)):
        if value and suffix not in USERS[what]:
            raise ValueError(f"{name}: {what} is {value!r}, expected none: it is for {', '.join(USERS[what])}")
    if height_reference not in ("", "clamp", *LEVELS):
        raise Error(f"{name}: {unknown('height_reference', height_reference, (*LEVELS, 'clamp'))}")
    if geoid_undulation is not None and not isinstance(geoid_undulation, (int, float)):
        raise Error(f"{name}: geoid_undulation is {geoid_undulation!r}, expected metres")
    scene = load_scene(scene) if isinstance(scene, (str, os.PathLike)) else scene
    origin = origin_of(origin) if origin is not None else scene.geodetic_origin if scene is not None else None
    read = (_of_data(Cloud(file) if given else load_cloud(path), name) if suffix == ".vtp" else
            _of_table(Log(name), columns, height_reference, track, origin) if suffix in TABLES else
            _of_markup(name, height_reference, track) if suffix in MARKUP else _of_bag(path, frame))
    level = height_reference or read.level

    placed, timed = np.isfinite(read.places[:, :2]).all(axis=1), np.isfinite(read.times)
    order = np.flatnonzero(placed & timed)
    order = order[np.argsort(read.times[order], kind="stable")]
    again = np.diff(read.times[order], prepend=-np.inf) == 0.0
    counts = {**read.left, "points without a position": np.sum(~placed),
              "points without a time": np.sum(placed & ~timed), "points of the same time as before": np.sum(again)}
    left = ", ".join(f"{reason} ({count})" for reason, count in counts.items() if count)
    notes = [*read.notes, *([f"left out: {left}"] if left else [])]
    order = order[~again]
    if len(order) < 2:
        raise Error(f"{name}: expected 2 or more points with a position and a time, "
                    f"has {'; '.join([f'{len(order)}', *notes])}")
    times, places, heights = read.times[order], read.places[order, :2], read.places[order, 2]
    heights = np.where(level == "clamp", np.nan, heights)
    on_ground = np.isnan(heights)
    with naming(name):
        check_level("heights", level, read.in_degrees, origin, geoid_undulation, scene)
        if on_ground.any() and scene is None:
            raise Error("points without a height stand on the ground, but there is no scene: expected scene")
    points = points_of(places, np.where(on_ground, 0.0 if origin is None else origin[2], heights), level,
                       read.in_degrees, origin, geoid_undulation)
    on_ground |= level == "ground"
    if on_ground.any():
        ground = ground_of(scene, points[on_ground, :2])
        points[on_ground, 2] = np.nan_to_num(heights[on_ground]) + np.nan_to_num(ground)
    since_1970 = np.abs(times).max() > SINCE_1970
    with naming("start_time"):
        if isinstance(start_time, str) and not since_1970:
            raise Error(f"is {start_time!r}, but {name} has no times since 1970: expected a number of its clock, s")
        start = (times[0] if since_1970 else 0.0) if start_time is None else seconds_of(start_time)
        times = times - start
    steps = np.diff(times)
    if steps.max() > LONG * max(float(np.median(steps)), 1.0):
        notes += [f"the longest gap between its points is {steps.max():.6g} s, which it passes in a straight line"]
    turns, said = read.turns[order] if read.turns is not None else None, ""
    if turns is None:
        times, points, turns, said = _levelled(times, points, None if read.angles is None else read.angles[order])
    notes += [said] if said else []
    turned = turns.as_quat()[:, [3, 0, 1, 2]]
    turned[1:] *= np.cumprod(np.where((turned[1:] * turned[:-1]).sum(axis=1) < 0.0, -1.0, 1.0))[:, None]
    if notes:
        warnings.warn(f"{name}: {'; '.join(notes)}", RuntimeWarning, stacklevel=callers_level())
    line = trajectory(points, times, turned)
    if since_1970:
        add_array(line.GetFieldData(), "start_time", np.array([start]), "s")
    return line


def _along(times: np.ndarray, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray, List[float]]:
    """Times and headings (deg, without jumps) of a platform that heads along its way, and the times at which the heading
    begins or ends to change between points. A leg begins at a point, and ends at the first point that is more than LEAST
    away. It has one heading, except within BEND of its ends, where the platform turns. A platform that stands keeps its
    heading."""
    (x, y), begin = points[:, :2].T.tolist(), 0
    knots: List[Tuple[float, float]] = []
    own: List[float] = []
    for end in range(1, len(times)):
        east, north = x[end] - x[begin], y[end] - y[begin]
        length = math.hypot(east, north)
        if length <= LEAST:
            continue
        heading, first, last = math.degrees(math.atan2(east, north)), times[begin], times[end]
        away = np.linalg.norm(points[begin:end, :2] - points[begin, :2], axis=1)
        leaves = times[begin + int(np.flatnonzero(away <= LEAST / 2)[-1])]
        if leaves - first > STANDS * (last - first):
            first = leaves
            knots.append((first, knots[-1][1] if knots else heading))
            own.append(first)
        part = min(BEND / length, 0.5) * (last - first)
        knots += [(first + part, heading), (last - part, heading)]
        own += [first + part, last - part] if length > 2.0 * BEND else []
        begin = end
    found = np.array(knots).reshape(-1, 2)
    return found[:, 0], np.unwrap(found[:, 1], period=360.0), own


def _levelled(times: np.ndarray, points: np.ndarray, angles: Any) -> Tuple[np.ndarray, np.ndarray, Any, str]:
    """Times, points and rotations by angles, and a sentence if there is no heading, else an empty text. If no point has
    a heading, points are added where the heading along the way begins or ends to change."""
    from scipy.spatial.transform import Rotation
    angles = np.full((len(times), 3), np.nan) if angles is None else angles
    unknown_heading, said = np.isnan(angles[:, 0]), ""
    if unknown_heading.any():
        knots, headings, own = _along(times, points)
        if not len(knots):
            knots, headings, said = times[:1], np.zeros(1), f"it never moves by {LEAST:g} m, and heads north"
        moments = np.union1d(times, own) if unknown_heading.all() else times
        points = np.column_stack([np.interp(moments, times, axis) for axis in points.T])
        angles = np.column_stack([np.interp(moments, times, axis) for axis in angles.T])
        angles[:, 0], times = np.where(np.isnan(angles[:, 0]), np.interp(moments, knots, headings), angles[:, 0]), moments
    turns = Rotation.from_euler("ZXY", np.column_stack([-angles[:, 0], np.nan_to_num(angles[:, 1:])]), degrees=True)
    return times, points, turns, said


def _rotations(quaternions: np.ndarray) -> Any:
    """Rotations by quaternions x, y, z, w."""
    from scipy.spatial.transform import Rotation
    lengths = np.linalg.norm(quaternions, axis=1)
    wrong = np.flatnonzero(~(np.abs(lengths - 1.0) < 1e-2))
    if len(wrong):
        raise Error(f"the quaternion of point {wrong[0] + 1} has the length {lengths[wrong[0]]:g}, expected 1 (x, y, z and "
                    "w of a rotation)")
    return Rotation.from_quat(quaternions)


def settings_of(words: Sequence[Tuple[str, Any]], *more: str) -> Dict[str, Any]:
    """Settings of `read_trajectory` in a command, by name; columns as in time:seconds,z:height. @param more further
    names"""
    known, found = [*list(inspect.signature(read_trajectory).parameters)[2:], *more], dict(words)
    for name in found:
        if name not in known:
            raise ValueError(unknown("--trajectory-set:", name, known))
    if "columns" in found:
        pairs = [f"{word}".partition(":") for word in np.atleast_1d(found["columns"])]
        if not all(name for *_, name in pairs):
            raise ValueError(f"--trajectory-set: columns is {found['columns']}, expected words such as time:seconds")
        found["columns"] = {meaning: name for meaning, _, name in pairs}
    return {name: f"{value}" if name in ("track", "frame") else value for name, value in found.items()}


def _choose(names: Sequence[str], track: str) -> np.ndarray:
    """Which points are of the track. @param names of the points' tracks"""
    known = dict.fromkeys(names)
    if track not in known if track else len(known) > 1:
        raise Error(f"has {', '.join(known)[:400] or 'no names'} as tracks, expected one of them as track")
    return np.array([not track or name == track for name in names], bool)


def _of_data(data: Cloud, name: str) -> _Points:
    from scipy.spatial.transform import Rotation
    shapes = {"time": (), "pose_orientation": (4,), **{what: () for what in ANGLES}}
    known = {what: data[what].astype(float) for what in shapes if what in data}
    if "time" not in known or any(known[what].shape[1:] != shapes[what] for what in known):
        raise Error(f"{name}: has the point arrays {', '.join(data) or 'none'}, expected time with one number for each "
                    "point, and pose_orientation with four, or heading, pitch and roll with one")
    angles = np.column_stack([known.get(what, np.full(len(known["time"]), np.nan)) for what in ANGLES])
    with naming(name):
        turns = _rotations(known["pose_orientation"][:, [1, 2, 3, 0]]) if "pose_orientation" in known else None
    return _Points(known["time"], data.points.astype(float), angles=angles, turns=turns)


def _of_bag(path: pathlib.Path, frame: str) -> _Points:
    from scipy.spatial.transform import Rotation
    notes: List[str] = []
    times, poses = moving_poses(path, frame, notes)
    return _Points(1e-9 * times, poses[..., 3], turns=Rotation.from_matrix(poses[..., :3]), notes=notes)


def _of_table(reader: Log, columns: Optional[Dict[str, str]], height_reference: str, track: str,
              origin: Optional[Sequence[float]]) -> _Points:
    from scipy.spatial.transform import Rotation
    with naming(reader.file):
        chosen, across, level = columns_of(reader, columns, height_reference,
                                           ("id", "date", *OUTLIERS, *ANGLES, *QUATERNION))
    frame = reader.rows(chosen, across)
    # An id that each row has for itself is the number of the row.
    names = frame["id"].str.strip().tolist() if "id" in frame and frame["id"].duplicated().any() else [""] * len(frame)
    with naming(reader.file):
        frame = frame[_choose(names, track)]
    times, _ = reader.times(frame, chosen["time"].unit)
    places = frame[[*across]].to_numpy(float)
    if across[0] == "x" and origin is not None:
        check_metres(reader.file, chosen, places, origin)
    heights, *angles, qx, qy, qz, qw = (
        reader.numbers(frame, what, chosen[what].unit if what in ANGLES else 1.0, "a number")
        if what in chosen else np.full(len(frame), np.nan) for what in ("height", *ANGLES, *QUATERNION))
    with naming(reader.file):
        turns = (_rotations(np.column_stack([qx, qy, qz, qw])) * Rotation.from_matrix(TURNED.T)
                 if {*QUATERNION} & {*chosen} else None)
    return _Points(times, np.column_stack([places, heights]), level, across[0] == "longitude", np.column_stack(angles),
                   turns, reader.left)


def _of_markup(file: str, height_reference: str, track: str) -> _Points:
    """The points of GPX and KML, by way of a table."""
    content = read_regular(file)
    with naming(file):
        rows = _rows(_root(content))
        rows = [row for row, keep in zip(rows, _choose([row[0] for row in rows], track)) if keep]
        levels = {MODES[row[1]] for row in rows} - {"clamp"}
        if len(levels) > 1 and not height_reference:
            raise Error("has altitudes above the ground and above the sea, expected one altitudeMode in a track")
    level, table = height_reference or (levels or {"clamp"}).pop(), io.StringIO()
    csv.writer(table).writerows([("time", "longitude", "latitude", "altitude", *ANGLES), *(
        (*row[2:5], row[5] if height_reference or MODES[row[1]] != "clamp" else "", *row[6:]) for row in rows)])
    points = _of_table(Log(file, table.getvalue().encode()), None, level, "", None)
    # Tilt and roll of KML are clockwise, as the heading is: nose down, left side down. Some programs write 0 0 0.
    return points._replace(angles=points.angles * (1, -1, -1) if np.nan_to_num(points.angles).any() else None)


def _root(content: bytes) -> ElementTree.Element:
    """The root of XML, which may be in a zip file, as in KMZ."""
    try:
        if content.startswith(b"PK"):
            with zipfile.ZipFile(io.BytesIO(content)) as packed:
                inside = [one for one in packed.infolist() if one.filename.lower().endswith(".kml")][:1]
                if not inside or inside[0].file_size > LARGEST:
                    raise Error(f"has no .kml file of at most {LARGEST >> 20} MiB inside, expected doc.kml")
                content = packed.read(inside[0])
        return ElementTree.fromstring(content.lstrip())
    except (ElementTree.ParseError, zipfile.BadZipFile, zlib.error) as error:
        raise Error(f"is damaged, expected XML of GPX or KML ({error})") from None


def _rows(root: ElementTree.Element) -> List[Tuple[str, ...]]:
    """Name of the track, altitudeMode, time, longitude, latitude, height, heading, tilt and roll of each point."""
    rows: List[Tuple[str, ...]] = []
    for number, track in enumerate(root.iterfind(".//{*}trk"), 1):
        name = (track.findtext("{*}name") or f"{number}").strip()
        rows += [(name, "absolute", one.findtext("{*}time") or "", one.get("lon", ""), one.get("lat", ""),
                  one.findtext("{*}ele") or "", "", "", "") for one in track.iterfind(".//{*}trkpt")]
    for number, holder in enumerate(root.iterfind(".//{*}Placemark"), 1):
        name = (holder.findtext("{*}name") or f"{number}").strip()
        for track in holder.iterfind(".//{*}Track"):
            whens, coords, angles = ([one.text or "" for one in track.iterfind(f"{{*}}{what}")]
                                     for what in ("when", "coord", "angles"))
            mode = (track.findtext("{*}altitudeMode") or holder.findtext("{*}MultiTrack/{*}altitudeMode")
                    or "clampToGround").strip()
            if not len(whens) == len(coords) == len(angles or coords) or mode not in MODES:
                raise Error(f"the track {name} has {len(whens)} when, {len(coords)} coord, {len(angles)} angles and "
                            f"altitudeMode {mode}, expected as many of each, and one of {', '.join(MODES)}")
            places, turns = ([[*re.split(r"[\s,]+", text.strip()), "", ""][:3] for text in texts]
                             for texts in (coords, angles or [""] * len(coords)))
            rows += [(name, mode, when, *place, *turn) for when, place, turn in zip(whens, places, turns)]
    if not rows:
        routes, stamps = (len(root.findall(f".//{{*}}{tag}")) for tag in ("rtept", "TimeStamp"))
        raise Error(f"has no points of a track with times, but {routes} of routes (rtept) and {stamps} places with a "
                    "TimeStamp: expected trkpt (GPX), or gx:Track with when and gx:coord (KML); a LineString has no times")
    return rows
