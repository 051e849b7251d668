# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories of platforms, such as cars and drones, from files: VTK, tables, GPX, KML and bags of ROS.

Sources: the schema of GPX 1.1 (topografix.com/GPX/1/1); KML 2.3 (OGC 12-007r2), and Google's reference for gx:Track."""
from __future__ import annotations

import csv
import io
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
from ..inputs._json import naming
from ..places._candidates import ground_of
from ._flights import check_level, check_metres, columns_of, lines_of, origin_of, points_of
from ._logs import LEVELS, OUTLIERS, SINCE_1970, Log, seconds_of

TABLES, MARKUP, FOLDER = (".csv", ".tsv", ".txt"), (".gpx", ".kml", ".kmz"), "or a folder"
USERS = {"columns": TABLES, "track": TABLES + MARKUP, "frame": (*SUFFIXES, FOLDER)}  # suffixes by the argument
LEAST, WINDOW = 0.5, 1.0  # m, s: a shorter way in a leg, or in this time about it, gives no heading (assumed)
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
    start_time        time 0: a datetime or a text in ISO 8601 (in UTC without a zone), or seconds since 1970; default:
                      the first time if times count from 1970, else as in the file
    origin            latitude, longitude (deg) and height (m) of the scene's origin; default: from the scene
    height_reference  level that heights count from: sea, ground or ellipsoid, or clamp: the platform stands on the
                      ground, as points without a height do; default: as the file says
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
    notes = "; ".join([*read.notes, *([f"left out: {left}"] if left else [])])
    order = order[~again]
    if len(order) < 2:
        raise Error(f"{name}: expected 2 or more points with a position and a time, has {len(order)}; {notes}")
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
        if start_time is not None and not since_1970:
            raise Error(f"is given, but {name} has no times since 1970")
        start = (times[0] if start_time is None else seconds_of(start_time)) if since_1970 else 0.0
        times = times - start
    turned = (read.turns[order] if read.turns is not None else
              _turns(times, points, read.angles[order] if read.angles is not None else np.full((len(order), 3), np.nan))
              ).as_quat()[:, [3, 0, 1, 2]]
    if not np.isfinite(turned).all():
        raise Error(f"{name}: a quaternion is missing, expected the unit quaternion of a rotation at each point")
    turned[1:] *= np.cumprod(np.where((turned[1:] * turned[:-1]).sum(axis=1) < 0.0, -1.0, 1.0))[:, None]
    if notes:
        warnings.warn(f"{name}: {notes}", RuntimeWarning, stacklevel=callers_level())
    line = lines_of([np.column_stack([points, times])])
    add_array(line.GetPointData(), "pose_orientation", turned, "1")
    if since_1970:
        add_array(line.GetFieldData(), "start_time", np.array([start]), "s")
    return line


def _turns(times: np.ndarray, points: np.ndarray, angles: np.ndarray) -> Any:
    """Rotations by angles. Where the heading is NaN, it is the mean direction of the legs before and after. A short leg
    goes with the way of WINDOW about its middle, and has the last heading if this way is short, too."""
    from scipy.spatial.transform import Rotation
    lasts, middles, along = np.diff(times), 0.5 * (times[1:] + times[:-1]), np.zeros(len(times))
    is_short = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1) <= LEAST
    half = 0.5 * np.where(is_short, np.maximum(lasts, WINDOW), lasts)
    ends = middles - half, middles + half
    ways = np.array([np.diff([np.interp(end, times, x) for end in ends], axis=0)[0] for x in points[:, :2].T])
    sizes = np.linalg.norm(ways, axis=0)
    counting = np.flatnonzero(sizes > LEAST)
    if len(counting):
        last = counting[np.maximum(np.searchsorted(counting, np.arange(len(lasts)), side="right") - 1, 0)]
        east, north = ways[:, last] / sizes[last]
        after = 1.0 + 1e-9  # weight of the leg after, which counts where the way turns back
        along = np.degrees(np.arctan2(*(np.append(x[:1], x) + after * np.append(x, x[-1:]) for x in (east, north))))
    heading = np.where(np.isnan(angles[:, 0]), along, angles[:, 0])
    return Rotation.from_euler("ZXY", np.column_stack([-heading, np.nan_to_num(angles[:, 1:])]), degrees=True)


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
        turns = Rotation.from_quat(known["pose_orientation"][:, [1, 2, 3, 0]]) if "pose_orientation" in known else None
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
        turns = (Rotation.from_quat(np.column_stack([qx, qy, qz, qw])) * Rotation.from_matrix(TURNED.T)
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
        raise Error(f"has no points of a track, but {routes} of routes (rtept), which have no times, and {stamps} "
                    "places with a TimeStamp: expected trkpt (GPX), or gx:Track with when and gx:coord (KML)")
    return rows
