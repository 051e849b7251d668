# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of birds in the coordinates of a scene, from tables of radars, GPS loggers and Movebank."""
from __future__ import annotations

import dataclasses
import json
import math
import os
import textwrap
import warnings
from collections.abc import Mapping
from numbers import Real
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from ... import vtkAvianLidar as _wrapped
from ..._cloud import add_array, lines_of
from ..._pipeline import Error, callers_level, update
from ..._properties import set_properties, unknown
from ..._scene import load_scene
from ..inputs._json import naming
from ..pages._words import counted
from ..places._candidates import ground_of
from ..places._geojson import placed
from ._logs import FROM_MAP, LEVELS, OUTLIERS, Column, Columns, Log, seconds_of

SCIENTIFIC = {"sturnus vulgaris": "starling", "falco tinnunculus": "kestrel", "columba livia": "pigeon",
              "corvus corone": "crow", "larus argentatus": "herring gull", "branta canadensis": "Canada goose"}
KNOWN_SPECIES = f"{', '.join([*SCIENTIFIC.values()][:-1])} or Canada goose, or one of a table (species_file_name)"
FAR = 5e4  # m: birds that are all farther away make one look for a mistake in their coordinates
MAP_FROM = 1e5  # m: x and y beyond are probably coordinates of a map
NEAR = 2e4  # m: a mistake is likely if birds without this mistake are nearer
SETTINGS = ("file_name", "origin", "height_reference", "geoid_undulation", "columns")  # keys of a group with a file


@dataclasses.dataclass
class Flights:
    """Tracks of a file."""
    file: str
    ids: List[str]  # of the tracks
    species: List[str]  # of the tracks
    begins: np.ndarray  # of each track in times and points, and the number of all points
    times: np.ndarray  # s, rising in each track
    points: np.ndarray  # n x 3, m
    degrees: Optional[np.ndarray]  # longitude and latitude of the points
    since_1970: bool  # else times count from the first scan
    above: Any = None  # scene whose ground heights count from, if they do not count from the origin
    level: str = ""  # that heights count from, of LEVELS; empty: the scene's origin
    words: str = ""  # what was read, for people, in lines
    warning: str = ""

    def _under_way(self, begin: float, end: float, more: int) -> Tuple[np.ndarray, List[np.ndarray]]:
        """Numbers of the tracks under way at some time between begin and end (s), and the positions (m x 3) of each,
        with `more` positions before and after, with their times (fourth column)."""
        starts, stops = self.begins[:-1], self.begins[1:] - 1
        chosen = np.flatnonzero((self.times[starts] < end) & (self.times[stops] >= begin)) if len(starts) else starts
        parts = []
        for track in chosen:
            first, last = starts[track], stops[track] + 1
            low, high = np.searchsorted(self.times[first:last], (begin, end)) + (-more, more)
            parts.append(np.arange(first + max(low, 0), min(first + high, last)))
        rows = np.concatenate([*parts, np.empty(0, int)]).astype(int)
        points = np.column_stack([self.points[rows], self.times[rows]])
        if self.above is not None and len(rows):
            points[:, 2] += np.nan_to_num(ground_of(self.above, points[:, :2]))
        return chosen, np.split(points, np.cumsum([*map(len, parts)])[:-1]) if parts else []

    def lines(self, begin: float, end: float) -> Tuple[vtkPolyData, List[str]]:
        """Tracks under way at some time between begin and end (s), as lines, and their ids. The positions before and
        after, from which turns follow, are included."""
        chosen, parts = self._under_way(begin, end, 3)
        lines = lines_of(parts)
        if len(chosen):
            add_array(lines.GetCellData(), "species", [self.species[track] for track in chosen])
        return lines, [self.ids[track] for track in chosen]

    def nearest(self, place, begin: float, end: float) -> np.ndarray:
        """For each track under way at some time between begin and end (s), its least distance from a place in this
        time, m."""
        return np.array([least_distance(_cut(part, begin, end), place) for part in self._under_way(begin, end, 1)[1]])

    def within(self, place, reach: float, end: float) -> Tuple[np.ndarray, int]:
        """Positions (n x 3, m) about a place within its reach (m), of birds under way between the times 0 and end (s),
        also between the positions of the table; and the number of these birds."""
        found, count = [np.empty((0, 3))], 0
        for part in self._under_way(0.0, end, 1)[1]:
            track = _cut(part, 0.0, end) - np.asarray(place, float)
            at = np.linspace(0, len(track) - 1, 20 * (len(track) - 1) + 1)
            points = np.column_stack([np.interp(at, np.arange(len(track)), x) for x in track.T])
            found.append(points[np.linalg.norm(points, axis=1) <= reach])
            count += len(found[-1]) > 0
        return np.concatenate(found), count

    def mistake(self, place, origin: Sequence[float]) -> str:
        """Words on a likely mistake in coordinates that are all far away."""
        if self.degrees is None:
            away = np.abs(self.points[:, :2]).max(axis=1)
            return ("x and y are metres east and north of the scene's origin" +
                    (f"; {FROM_MAP}" if np.median(away) > MAP_FROM else ""))
        some = self.degrees[:: max(len(self.degrees) // 1000, 1)]
        for words, other in (("latitude and longitude are exchanged", some[:, ::-1]),
                             ("the longitude has the wrong sign", some * (-1, 1)),
                             ("the latitude has the wrong sign", some * (1, -1))):
            if np.abs(other[:, 1]).max() <= 90.0:
                level = np.column_stack([other, np.full(len(other), origin[2])])
                away = np.linalg.norm(placed(level, origin) - place, axis=1).min()
                if away < NEAR:
                    return f"probably {words}: corrected, the nearest bird is {away:.0f} m away"
        return f"the origin is {origin[0]:g}, {origin[1]:g} (latitude, longitude)"


def _cut(track: np.ndarray, begin: float, end: float) -> np.ndarray:
    """The positions (m x 3) of a track between two times (s). @param track positions with their times, n x 4"""
    times = track[:, 3]
    inside = times[(times > begin) & (times < end)]
    at = np.concatenate([[max(begin, times[0])], inside, [min(end, times[-1])]])
    return np.column_stack([np.interp(at, times, x) for x in track[:, :3].T])


def origin_of(given: Any) -> Tuple[float, float, float]:
    """Latitude and longitude (deg) and height (m) from an object, as in scene files, or from three numbers."""
    keys = ("latitude", "longitude", "height")
    parts: Any = None
    if isinstance(given, Mapping) and {*given} - {"comment"} == {*keys}:
        parts = [given[key] for key in keys]
    elif not isinstance(given, (str, Mapping)) and np.shape(given) == (3,):
        parts = given
    if parts is not None and all(isinstance(x, Real) and not isinstance(x, bool) and math.isfinite(x) for x in parts):
        latitude, longitude, height = map(float, parts)
        if abs(latitude) <= 90.0 and -180.0 <= longitude <= 360.0:
            return latitude, longitude, height
    raise Error(f"origin is {str(given)[:80]}, expected latitude and longitude in degrees and height in metres, as in "
                '{"latitude": 47.45, "longitude": 8.55, "height": 420} or [47.45, 8.55, 420]')


def least_distance(points: np.ndarray, place) -> float:
    """Least distance of a line (n x 3, m) from a place, m."""
    off = points - np.asarray(place, float)
    way = np.diff(off, axis=0)
    along = np.clip(-(off[:-1] * way).sum(axis=1) / np.maximum((way * way).sum(axis=1), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(np.vstack([off[:1], off[:-1] + along[:, None] * way]), axis=1).min())


def read_flights(file, origin: Any = None, scene=None, species: str = "",
                 species_file_name: str = "", height_reference: str = "", geoid_undulation: Optional[float] = None,
                 columns: Optional[Dict[str, str]] = None) -> Flights:
    """Tracks of a CSV file; `Error` names the file and what was expected.

    origin             latitude, longitude (deg) and height (m) of the scene's origin, as three numbers or by these
                       names; default: from the scene
    scene              a Scene, which heights above the ground need
    species            name of a species for tracks without a known species
    species_file_name  table of the user's species
    height_reference   level that heights count from: sea, ground or ellipsoid; default: as the column's name says, else
                       sea for longitudes and latitudes, and the scene's origin for x and y
    geoid_undulation   height of the sea level above the ellipsoid, m
    columns            names of columns by meaning
    """
    file = str(file)
    if origin is not None:
        origin = origin_of(origin)
    elif scene is not None:
        origin = scene.geodetic_origin
    if species and not _is_known(species, species_file_name):
        raise Error(f"species {species!r} is not known: expected {KNOWN_SPECIES}")
    reader = Log(file)
    try:
        if height_reference not in ("", *LEVELS):
            raise Error(unknown("height_reference", height_reference, LEVELS))
        chosen, across, level = columns_of(reader, columns, height_reference, ("id", "species", "date", *OUTLIERS))
        in_degrees = across[0] == "longitude"
        check_level(f"heights ({chosen['height'].name})", level, in_degrees, origin, geoid_undulation, scene)
    except Error as error:
        raise Error(f"{file}: {error}") from None
    frame = reader.rows(chosen, across)
    times, since_1970 = reader.times(frame, chosen["time"].unit)
    order, begins, ids = reader.tracks(frame, times, across)
    frame, times = frame.iloc[order], times[order]
    places, heights = frame[[*across]].to_numpy(float), frame["height"].to_numpy(float)
    if not in_degrees and origin is not None:
        check_metres(file, chosen, places, origin)
    points = points_of(places, heights, level, in_degrees, origin, geoid_undulation)
    names = ", ".join(f"{what} is {column.name}" for what, column in chosen.items() if what not in OUTLIERS)
    left = [f"{reason} ({count})" for reason, count in reader.left.items() if count]
    of_tracks = _species_of(reader, frame, begins, species, species_file_name)
    return Flights(
        file, ids, of_tracks, begins, times, points, places if in_degrees else None, since_1970,
        scene if level == "ground" else None,
        level, "\n".join([f"{file}: {counted(len(ids), 'track')} with {counted(len(times), 'position')}", *(
            line for text in (names, f"heights are above the {level or 'origin'}", *reader.notes)
            for line in textwrap.wrap(text, 118, initial_indent="  ", subsequent_indent="    "))]),
        f"{file}: left out: {', '.join(left)}" if left else "")


def read_tracks(file, scene=None, start_time: Any = None, **settings: Any) -> vtkPolyData:
    """Tracks of birds in a table (CSV) of a radar, a logger or Movebank, as lines with the point array `time` (s) and
    the cell array `species`, for the pattern Lines of vtkAvianLidarTracks.

    file        the table
    scene       a Scene or the name of a scene file, for longitudes and latitudes and for heights above the ground
    start_time  time 0 of the lines: a datetime or a text in ISO 8601 (in UTC without a zone), or seconds since 1970;
                default: the earliest time in the table
    settings    species, species_file_name, origin, height_reference, geoid_undulation and columns, as in scenarios
    """
    found = read_flights(file, scene=load_scene(scene) if isinstance(scene, (str, os.PathLike)) else scene, **settings)
    if found.warning:
        warnings.warn(found.warning, RuntimeWarning, stacklevel=callers_level())
    with naming("start_time"):
        if start_time is not None and not found.since_1970 and len(found.times):
            raise Error(f"is given, but {file} has no times since 1970")
        if found.since_1970:
            found.times -= found.times.min(initial=np.inf) if start_time is None else seconds_of(start_time)
    return found.lines(-np.inf, np.inf)[0]


def columns_of(reader: Log, columns: Optional[Dict[str, str]], height_reference: str, more: Sequence[str]
               ) -> Tuple[Dict[str, Column], Tuple[str, str], str]:
    """The columns of a table by their meaning, the names of the horizontal coordinates, and the level that heights
    count from. @param height_reference as of read_flights; "clamp" needs no heights @param more other meanings"""
    given = columns or {}
    known = Columns(reader.names, given)
    ignored = known.ignore(reader.empty)
    if ignored:
        reader.notes.append(f"columns without a value are ignored: {', '.join(ignored)}")
    in_degrees = ("longitude" in known.found or "latitude" in known.found) and not {"x", "y"} & {*given}
    across = ("longitude", "latitude") if in_degrees else ("x", "y")
    chosen, level = {what: known.need(what) for what in ("time", *across)}, height_reference
    if level != "clamp":
        chosen["height"], level = _height(known, in_degrees, height_reference)
    found = {what: known.find(what) for what in more}
    chosen.update((what, column) for what, column in found.items() if column)
    return chosen, across, level


def points_of(places: np.ndarray, heights: np.ndarray, level: str, in_degrees: bool,
              origin: Optional[Sequence[float]], geoid_undulation: Optional[float]) -> np.ndarray:
    """East, north, and up from the scene's origin or, for the level `ground`, from the ground, n x 3, m.

    places   n x 2: longitudes and latitudes (deg) or x and y (m)
    heights  n, m
    """
    above_sea = heights - (geoid_undulation or 0.0) * (level == "ellipsoid")
    if in_degrees:
        assert origin is not None
        points = placed(np.column_stack([places, above_sea if level != "ground" else np.full(len(places), origin[2])]),
                        origin)
    else:
        below = origin[2] if origin is not None and level in ("sea", "ellipsoid") else 0.0
        points = np.column_stack([places, above_sea - below])
    if level == "ground":
        points[:, 2] = heights
    return points


def check_level(what: str, level: str, in_degrees: bool, origin: Optional[Sequence[float]],
                geoid_undulation: Optional[float], scene) -> None:
    """Raises an error if the scene cannot place points of these coordinates. @param what the heights in words"""
    if origin is None and (in_degrees or level in ("sea", "ellipsoid")):
        coordinates = "longitudes and latitudes" if in_degrees else f"heights above the {level}"
        raise Error(f"has {coordinates}, but the scene has no origin on the Earth: expected the key origin in the "
                    "scene file, or origin beside the file's name (latitude and longitude in degrees, height in "
                    "metres)")
    if level == "ellipsoid" and geoid_undulation is None:
        raise Error(f"{what} are above the ellipsoid, and those of the scene above the sea: expected "
                    "geoid_undulation, the height of the sea level above the ellipsoid in metres (GUND in AD 2.2 of "
                    "the airport's AIP; 0 if the scene's heights are above the ellipsoid)")
    if level == "ground" and scene is None:
        raise Error(f"{what} are above the ground, but there is no scene: expected scene")


def check_metres(file: str, chosen: Dict[str, Column], places: np.ndarray, origin: Sequence[float]) -> None:
    """Raises an error for x and y that are longitude and latitude near the origin, or these exchanged."""
    if not len(places) or np.abs(places).max() > 400.0:
        return
    for first, degrees in (("longitude", places), ("latitude", places[:, ::-1])):
        if np.abs(degrees[:, 1]).max() <= 90.0:
            away = np.linalg.norm(placed(np.column_stack([degrees, np.full(len(places), origin[2])]), origin), axis=1)
            if np.quantile(away, 0.9) < FAR:
                names = {first: chosen["x"].name, "latitude" if first == "longitude" else "longitude": chosen["y"].name}
                raise Error(f"{file}: x and y look like longitude and latitude, expected metres east and north of "
                            f"the scene's origin: set \"columns\": {json.dumps(names, ensure_ascii=False)}")


def _height(known: Columns, in_degrees: bool, wanted: str) -> Tuple[Column, str]:
    """The column of heights, and the level that they count from: sea, ground, ellipsoid, or the scene's origin if
    empty."""
    kinds = [("height", ""), ("z", None)]
    plain = next(filter(None, (known.find(*kind) for kind in (
        kinds if in_degrees or "height" in known.given else reversed(kinds)))), None)
    usual = "sea" if in_degrees else ""
    named = {level: known.find("height", level) for level in LEVELS}
    if wanted:
        column = named[wanted] or plain
        if column is None:
            other = next((column for column in named.values() if column), None)
            if other:
                raise Error(f"height_reference is {wanted!r}, but the column {other.name!r} is above the {other.level} "
                            f"by its name: expected {other.level!r}, or another column, as in "
                            "\"columns\": {\"height\": \"...\"}")
        return column or _no_height(known), wanted
    if named["sea"]:
        return named["sea"], "sea"
    if plain:
        return plain, usual
    column = named["ground"] or named["ellipsoid"]
    return (column, column.level) if column else (_no_height(known), usual)


def _no_height(known: Columns) -> Column:
    raise Error(f"has no column for the height, but {', '.join(known.names)}; expected a name such as altitude, "
                f"height-above-msl, altitude_agl or z, or {known.remedy('height')} with a column of the table")


def _species_of(reader: Log, frame, begins: np.ndarray, species: str, species_file_name: str) -> List[str]:
    """The species of each track: that of the file if it is known, else the scenario's."""
    usual, count = species or "herring gull", len(begins) - 1
    if "species" not in frame:
        return [usual] * count
    said = frame["species"].str.strip()
    known: Dict[str, str] = {}
    for name in said.dropna().unique():
        known[name] = next((other for other in dict.fromkeys((name, name.lower(), name.capitalize(),
                                                              SCIENTIFIC.get(name.lower(), name)))
                            if _is_known(other, species_file_name)), "")
    first = said.groupby(np.repeat(np.arange(count), np.diff(begins))).first() if count else said
    found = [known.get(name, "") if isinstance(name, str) else usual for name in first]
    strange = [name for name, one in zip(first, found) if not one]
    if strange and not species:
        names = ", ".join(repr(name) for name in dict.fromkeys(strange))
        raise Error(f"{reader.file}: the species {names[:200]} are not known: expected {KNOWN_SPECIES}, or the "
                    "key species for such birds")
    if strange:
        names = ", ".join(f"{name} ({strange.count(name)})" for name in dict.fromkeys(strange))
        reader.notes.append(f"tracks of unknown species fly as {species}: {names[:200]}")
    return [one or usual for one in found]


def _is_known(species: str, species_file_name: str) -> bool:
    bird = _wrapped.vtkAvianLidarBirdSource()
    set_properties(bird, species=species, species_file_name=species_file_name)
    try:
        update(bird)
    except Error as error:
        if "Species is" in str(error):
            return False
        raise
    return True
