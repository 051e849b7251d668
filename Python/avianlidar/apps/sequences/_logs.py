# SPDX-License-Identifier: BSD-3-Clause
"""Tables (CSV) of positions, as radars, loggers and Movebank write them: columns by their meaning, times, tracks."""
from __future__ import annotations

import contextlib
import csv
import datetime
import io
import json
import math
import re
from numbers import Real
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np

from ..._files import read_regular
from ..._pipeline import Error
from ..._properties import unknown

# Words of a column's name that change nothing, and units with their size in m, s or deg
FILLERS = {"gps", "gnss", "location", "position", "pos", "fix", "coordinate", "coord", "decimal", "utc", "gmt", "osd"}
UNITS = {"m": 1.0, "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0, "km": 1000.0, "ft": 0.3048, "feet": 0.3048,
         "foot": 0.3048, "cm": 0.01, "centimetres": 0.01, "centimeters": 0.01, "mm": 1e-3, "millimetres": 1e-3,
         "millimeters": 1e-3, "s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3,
         "millis": 1e-3, "milliseconds": 1e-3, "deg": 1.0, "degree": 1.0, "degrees": 1.0, "dd": 1.0,
         "rad": 180 / math.pi, "radians": 180 / math.pi}
# The names of columns without their units. If several columns fit, the first list with a column counts.
NAMES: Dict[str, Sequence[Set[str]]] = {
    "time": ({"timestamp", "time stamp", "datetime", "date time"},
             {"epoch", "epoch time", "unixtime", "unix time", "unix timestamp"}, {"time", "t"}),
    "date": ({"date"},),
    "longitude": ({"longitude", "long", "lon", "lng"},), "latitude": ({"latitude", "lat"},),
    "x": ({"x", "east"},), "y": ({"y", "north"},), "z": ({"z", "up"},),
    "id": ({"track id", "trackid", "track", "track number", "track no", "track nr", "track num", "target id", "target"},
           {"individual local identifier", "individual id", "individual", "animal id", "animal", "bird id", "bird"},
           {"tag local identifier", "tag id", "tag", "device id", "device", "device info serial", "logger id"},
           {"id", "identifier", "object id", "name"}),
    "species": ({"species", "species name"}, {"individual taxon canonical name", "taxon canonical name", "taxon",
                                              "taxon name", "scientific name", "common name"}),
    "heading": ({"heading", "compass heading", "true heading", "heading true"}, {"yaw"},
                {"course", "course over ground", "cog"}),
    "pitch": ({"pitch"},), "roll": ({"roll"},),
    **{f"q{axis}": ({f"q{axis}", f"q {axis}", f"quaternion {axis}", f"orientation {axis}"},) for axis in "xyzw"}}
CLOCKS = "time", "timestamp"  # ends of other names of times
HEIGHTS = {"height", "altitude", "alt", "elevation", "ele", "elev", "z"}
PRESSURE = {"baro", "barometric"}  # such heights count if there are no others
PLAUSIBLE = -500.0, 20000.0  # m
UNKNOWN = (-9999, -999, 9999, 32767)  # numbers that stand for an unknown height, in metres or feet
# Meanings of which one suffices
ALTERNATIVES = (("longitude", "x"), ("latitude", "y"), ("height", "z"), ("time",), ("id",), ("species",))
MAP = {"easting", "northing", "utm"}  # words in names of a map's coordinates
LEVELS = {"sea": r"above (?:mean )?(?:sea(?: level)?|a?msl)|a?msl|asl|orthometric",
          "ground": r"above ground(?: level)?|agl",
          "ellipsoid": r"above (?:wgs ?84 )?ellipsoid|ellipsoid(?:al)?|hae|wgs ?84"}
OUTLIERS = {f"{who} marked outlier": True for who in ("manually", "import", "algorithm")} | {"visible": False}
ISO = re.compile(r"(\d{4})([-/]?)(\d\d)\2(\d\d)[T ]+(\d?\d(?=:)|\d\d):?(\d\d)(?::?(\d\d(?:[.,]\d+)?))?\s*"
                 r"(Z|UTC|GMT|([+-])(\d\d):?(\d\d)?)?", re.IGNORECASE)
CLOCK = r"\d\d?:\d\d(?::\d\d.*)?"
COMMENT = re.compile(rb"(?m)^[ \t]*#+([^\n]*)$")
BEFORE_TABLE = re.compile(rb"(?:[ \t]*(?:#[^\n]*)?\n)*")
HINTS = {"time": ("time", "zeit", "date", "utc"), "latitude": ("lat", "breit"), "longitude": ("lon", "läng"),
         "height": ("alt", "ele", "hei", "höhe", "hoehe")}  # parts of names that may be meant
FROM_MAP = ("coordinates of a map (UTM) must be converted to longitude and latitude, for example by "
            "ogr2ogr -t_srs EPSG:4326 as in the guide on birds of a radar")
ISO_EXPECTED = "2026-05-04T10:22:33Z, with or without a zone, or seconds"
SINCE_1970, LATEST = 1e8, 8e9  # s: greater times count from 1970, and lie before the year 2223


class Column(NamedTuple):
    name: str
    number: int
    unit: float  # in m, s or deg
    rank: int  # place in the lists of NAMES
    level: str = ""  # of LEVELS, or empty


def _meaning(name: str, number: int) -> Tuple[str, Column]:
    """What a column holds: a key of NAMES, "height", an outlier's mark, or nothing; and the column."""
    joined = re.sub(r"\b([A-Za-z])\.(?=[A-Za-z]\b)", r"\1", name)  # a.s.l.
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", joined)
    words = [word.lower() for word in re.findall(r"[^\W_]+", apart)]
    unit = next((UNITS[word] for word in words[1:] if word in UNITS), 1.0)
    said = " ".join(word for i, word in enumerate(words) if word not in FILLERS and (i == 0 or word not in UNITS))
    for what, lists in NAMES.items():
        for rank, names in enumerate(lists):
            if said.removesuffix(" wgs84") in names:
                return what, Column(name, number, unit, rank)
    if said in OUTLIERS:
        return said, Column(name, number, unit, 0)
    levels = {level: re.sub(rf"\b(?:{words})\b", "", said) for level, words in LEVELS.items()}
    level = next((level for level, rest in levels.items() if rest != said), "")
    rest = levels.get(level, said).split()
    if not set(rest) - HEIGHTS - PRESSURE and (set(rest) & HEIGHTS or level):
        return "height", Column(name, number, unit, int(not PRESSURE.isdisjoint(rest)), level)
    if said.endswith(CLOCKS):
        return "time", Column(name, number, unit, len(NAMES["time"]))
    return "", Column(name, number, unit, 0, level)


def _with_header(raw: bytes) -> bytes:
    """A table. If its header is a comment before the first line, the mark of this comment is removed."""
    start = BEFORE_TABLE.match(raw).end()  # type: ignore[union-attr]  # always matches
    end = raw.find(b"\n", start)
    first, fits = _cells(raw[start:end if end >= 0 else len(raw)])
    for comment in COMMENT.finditer(raw, 0, start) if fits < 3 else ():
        if len(_cells(comment[1])[0]) == len(first) and _cells(comment[1])[1] >= 3:
            return raw[:comment.start()] + comment[1] + raw[comment.end():]
    return raw


def _cells(line: bytes) -> Tuple[List[str], int]:
    """The cells of a line, and how many of them are names with a meaning."""
    text = line.decode(errors="replace")
    cells = [cell.strip(' "') for cell in text.split(_separator(text))]
    return cells, sum(_meaning(cell, 0)[0] != "" for cell in cells)


def _separator(line: str) -> str:
    return max(",;\t|", key=line.count)


class Columns:
    """The columns of a table by their meaning."""

    def __init__(self, names: Sequence[str], given: Dict[str, str]):
        self.names, self.given = names, given
        self.found: Dict[str, List[Column]] = {}
        for number, name in enumerate(names):
            what, column = _meaning(name, number)
            if what and what not in given and name not in given.values():
                self.found.setdefault(what, []).append(column)
        for what, name in given.items():
            if what not in (*NAMES, "height"):
                raise Error(unknown("columns:", what, (*NAMES, "height")))
            if name not in names:
                raise Error(f"has no column {name!r} ({what}), but {', '.join(names)}")
            self.found[what] = [_meaning(name, names.index(name))[1]]

    def ignore(self, find_empty: Callable[[Sequence[Column]], Set[int]]) -> List[str]:
        """Takes columns without a value away if others have what they lack, and empty ids; the names of these columns.
        @param find_empty the numbers of those columns without a value"""
        groups = [[(what, one) for what in group if what not in self.given for one in self.found.get(what, ())]
                  for group in ALTERNATIVES]
        empty, ignored = find_empty([one for group in groups for _, one in group]), []
        for group in groups:
            without = [(what, one) for what, one in group if one.number in empty]
            if len(without) < len(group) or group and group[0][0] == "id":
                for what, one in without:
                    self.found[what].remove(one)
                    ignored.append(one.name)
        self.found = {what: columns for what, columns in self.found.items() if columns}
        return ignored

    def remedy(self, *meanings: str) -> str:
        """The setting that names columns, for an error, with columns that may be meant."""
        strange, chosen = [name for name in self.names if name and not _meaning(name, 0)[0]], {}
        for what in meanings:
            hints = [name for name in strange if any(part in name.lower() for part in HINTS.get(what, ()))]
            chosen[what] = next(iter(hints or (strange if len(strange) == len(meanings) == 1 else ())), "...")
            strange = [name for name in strange if name != chosen[what]]
        return f"\"columns\": {json.dumps(chosen, ensure_ascii=False)}"

    def find(self, what: str, level: Optional[str] = None) -> Optional[Column]:
        """The column of a meaning. @param level of the height; None: not a height"""
        fits = [one for one in self.found.get(what, ()) if level is None or one.level == level]
        best = [one for one in fits if one.rank == min(other.rank for other in fits)]
        metres = [one for one in best if one.unit == 1.0]
        best = metres if len(metres) == 1 else best
        if len(best) > 1:
            raise Error(f"the columns {best[0].name!r} and {best[1].name!r} may both be the {what}: "
                        f"choose one, as in \"columns\": {json.dumps({what: best[0].name}, ensure_ascii=False)}")
        return best[0] if best else None

    def need(self, what: str) -> Column:
        column = self.find(what)
        if column is None and what not in ("x", "y"):
            raise Error(f"has no column for the {what}, but {', '.join(self.names)}; expected a name such as "
                        f"{', '.join(sorted(NAMES[what][0]))}, or {self.remedy(what)} with a column of the table")
        if column is None:
            on_map = any(word in name.lower() for name in self.names for word in MAP)
            remedy = FROM_MAP if on_map else f"or {self.remedy('latitude', 'longitude')} with columns of the table"
            raise Error(f"has no column for the position, but {', '.join(self.names)}; expected latitude and longitude "
                        f"in degrees, or x and y in metres east and north of the scene's origin; {remedy}")
        return column


def seconds_of(moment: Any) -> float:
    """Seconds since 1970 of a datetime or a text in ISO 8601, in UTC without a zone, or of a number of seconds since
    1970."""
    with contextlib.suppress(ValueError):
        if isinstance(moment, datetime.datetime):
            seconds = (moment if moment.tzinfo else moment.replace(tzinfo=datetime.timezone.utc)).timestamp()
        else:
            seconds = float(moment if isinstance(moment, Real) else _iso([moment])[0][0])
        if math.isfinite(seconds):
            return seconds
    raise ValueError(f"is {moment!r}, expected {ISO_EXPECTED} since 1970")


def _iso(texts: Sequence[str]) -> Tuple[np.ndarray, bool]:
    """Seconds since 1970, and whether a text has no zone. ValueError holds the first wrong text."""
    days, seconds, is_local = [], [], False
    for text in texts:
        found = ISO.fullmatch(text) if isinstance(text, str) else None
        if not found:
            raise ValueError(text)
        year, _, month, day, hour, minute, second, own, sign, hours, minutes = found.groups()
        clock = int(hour), int(minute), float((second or "0").replace(",", "."))
        if clock != (24, 0, 0.0) and not (clock[0] < 24 and clock[1] < 60 and clock[2] < 61.0):  # 60: a leap second
            raise ValueError(text)
        shift = 0 if sign is None else int(f"{sign}1") * (int(hours) * 3600 + int(minutes or 0) * 60)
        days.append(f"{year}-{month}-{day}")
        seconds.append(clock[0] * 3600 + clock[1] * 60 + clock[2] - shift)
        is_local |= own is None
    try:
        midnights = np.array(days, "datetime64[D]").astype(np.int64) * 86400.0
    except ValueError:
        if len(days) == 1:
            raise ValueError(texts[0]) from None
        for text in texts:  # names the wrong one
            _iso([text])
        raise
    return midnights + np.array(seconds), is_local


def as_time(seconds: float) -> str:
    """A time since 1970 in ISO 8601."""
    moment = datetime.datetime(1970, 1, 1) + datetime.timedelta(seconds=seconds)
    return moment.isoformat(timespec="milliseconds" if moment.microsecond else "seconds") + "Z"


class Log:
    """Reads a table of tracks."""

    def __init__(self, file: str, made: Optional[bytes] = None):
        """@param made a table that was made of the points of a file"""
        import pandas
        self.pandas, self.file, self.is_made = pandas, file, made is not None
        raw = read_regular(file) if made is None else made
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            raise Error(f"{file}: is in UTF-16, expected UTF-8: save the table again as CSV in UTF-8")
        raw = COMMENT.sub(b"", _with_header(raw.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")))
        chosen = re.match(rb'\s*"?sep=(.)"?[ \t]*\n', raw)  # of spreadsheets
        self.raw = raw[chosen.end():] if chosen else raw
        self.skipped = raw[:chosen.end()].count(b"\n") if chosen else 0
        try:
            head = self.raw.lstrip().partition(b"\n")[0].decode()
        except UnicodeDecodeError:
            raise Error(f"{file}: is not text in UTF-8: save the table again as CSV in UTF-8") from None
        self.separator = chosen[1].decode() if chosen else _separator(head)
        cells = csv.reader([head], delimiter=self.separator, skipinitialspace=True)
        self.names = [name.strip() for name in next(cells, [])]
        if len(self.names) < 3:
            raise Error(f"{file}: its first line is {head[:80]!r}, expected the names of columns, such as "
                        "track_id,timestamp,latitude,longitude,altitude")
        self.left: Dict[str, int] = {}  # number of rows or tracks left out, by reason
        self.notes: List[str] = []

    def line(self, row: int) -> str:
        """A row's line in the file in words."""
        if self.is_made:
            return f"point {row + 1}"
        lines = (number for number, text in enumerate(self.raw.split(b"\n"), 1) if text.strip())
        return f"line {next(number for k, number in enumerate(lines) if k == row + 1) + self.skipped}"

    def _table(self, numbers: List[str], dtype: Any, **more: Any) -> Any:
        try:
            return self.pandas.read_csv(
                io.BytesIO(self.raw), sep=self.separator, header=0, names=[f"{i}" for i in range(len(self.names))],
                usecols=numbers, index_col=False, skipinitialspace=True, low_memory=False, na_values=["-", "--"],
                dtype=dtype, **more)
        except ValueError as error:  # also pandas' ParserError, and text that is not UTF-8
            raise Error(f"{self.file}: is not a table that can be read ({str(error).strip()})") from None

    def empty(self, columns: Sequence[Column]) -> Set[int]:
        """The numbers of those columns without a value in any row."""
        left, rows = [column.number for column in columns], 0
        while left:
            part = self._table([*map(str, left)], str, nrows=1000 if not rows else None)
            left = [number for number in left if part[f"{number}"].isna().all()]
            if rows or len(part) < 1000:
                return {*left} if len(part) else set()
            rows = len(part)
        return set()

    def read(self, chosen: Dict[str, Column], texts: Set[str]) -> Any:
        """A frame of the chosen columns, by meaning; those of `texts` hold text."""
        of = {f"{column.number}": what for what, column in chosen.items()}
        frame = self._table([*of], {number: str for number, what in of.items() if what in texts})
        return frame.rename(columns=of)

    def numbers(self, frame, what: str, unit: float, expected: str) -> np.ndarray:
        """The numbers of a column; NaN for empty cells."""
        column = frame[what]
        if column.dtype == object:
            text = column.str.strip() if hasattr(column, "str") else column
            text = text.str.replace(",", ".", regex=False) if self.separator != "," else text
            numbers = self.pandas.to_numeric(text, errors="coerce")
            wrong = np.flatnonzero(numbers.isna() & column.notna() & (text != ""))
            if len(wrong):
                raise Error(f"{self.file}: {self.line(frame.index[wrong[0]])}: {what} is "
                            f"{str(column.iloc[wrong[0]])[:40]!r}, expected {expected}")
            column = numbers
        found = column.to_numpy(dtype=float)
        return np.where(np.isfinite(found), found, np.nan) * unit

    def leave(self, frame, keep, reason: str):
        """The rows to keep. Those left out are counted."""
        self.left[reason] = self.left.get(reason, 0) + int(len(frame) - np.count_nonzero(keep))
        return frame[keep]

    def rows(self, chosen: Dict[str, Column], across: Tuple[str, str]) -> Any:
        """The rows with a position, a time and an id; of points of a file, also those without a height.
        @param across names of the horizontal coordinates"""
        frame = self.read(chosen, {"time", "id", "species", "date", *OUTLIERS})
        for what, sign in OUTLIERS.items():
            if what in frame:
                says_yes = frame[what].str.strip().str.lower().isin(["true", "t", "1", "1.0", "yes"])
                frame = self.leave(frame, frame[what].isna() | (says_yes != sign), "rows marked as outliers")
        for what in (what for what in (*across, "height") if what in chosen):
            expected = "degrees, as in 121.3363" if what in ("longitude", "latitude") else "a number in metres"
            frame = frame.assign(**{what: self.numbers(frame, what, chosen[what].unit, expected)})
            if what == across[1]:
                frame = self.leave(frame, frame[[*across]].notna().all(axis=1), "rows without a position")
        if "height" in chosen:
            frame = self.leave(frame, frame["height"].notna() | self.is_made, "rows without a height")
            heights, unit = frame["height"], chosen["height"].unit
            known = ~(heights / unit).round(6).isin(UNKNOWN) | (unit < 0.3)
            possible = heights.between(*PLAUSIBLE) & known | heights.isna()
            frame = self.leave(frame, possible, "rows with an impossible height")
        if across[0] == "longitude":
            frame = self.leave(frame, (frame[[*across]] != 0.0).any(axis=1), "rows at 0, 0 degrees")
            self.check_degrees(frame, chosen)
        frame = self.leave(frame, frame["time"].notna(), "rows without a time")
        times = frame["time"].str.strip()
        if "date" in frame and times.str.fullmatch(CLOCK).all():
            dated = frame["date"].str.strip() + " " + times
            frame = self.leave(frame.assign(time=dated), dated.notna(), "rows without a date")
        return self.leave(frame, frame["id"].notna(), "rows without an id") if "id" in frame else frame

    def check_degrees(self, frame, chosen: Dict[str, Column]) -> None:
        """Raises an error for a longitude or latitude out of its range."""
        for what, most in (("latitude", 90.0), ("longitude", 360.0)):
            wrong = np.flatnonzero(frame[what].abs() > most)
            if len(wrong):
                may_be = what == "latitude" and (frame[["longitude", what]].abs().max() <= (90.0, 360.0)).all()
                raise Error(f"{self.file}: {self.line(frame.index[wrong[0]])}: {what} ({chosen[what].name}) is "
                            f"{frame[what].iloc[wrong[0]]:g}, expected degrees within {-most:g} and {most:g}"
                            f"{'; latitude and longitude may be exchanged' if may_be else ''}")

    def tracks(self, frame, times: np.ndarray, across: Tuple[str, str]) -> Tuple[np.ndarray, np.ndarray, List[str]]:
        """The order of rows by tracks and times, the beginning of each track in this order with the number of all rows,
        and the tracks' ids. Tracks of one position are left out."""
        codes, ids = np.zeros(len(frame), int), ["1"]
        if "id" in frame:
            codes, ids = self.pandas.factorize(frame["id"].str.strip())
        order = np.lexsort((times, codes))
        same = np.append(False, (np.diff(codes[order]) == 0) & (np.diff(times[order]) == 0.0))[:len(order)]
        if "id" not in frame and same.any():
            one, other = order[np.flatnonzero(same)[0] - 1:][:2]
            if (frame[[*across]].iloc[one] != frame[[*across]].iloc[other]).any():
                raise Error(f"{self.file}: {self.line(frame.index[other])}: a bird is at two places at one time, "
                            "expected a column with the ids of the tracks, such as track_id, or its name in columns")
        self.left["rows of a time that their track already has"] = int(same.sum())
        order = order[~same]
        size = np.bincount(codes[order], minlength=len(ids))
        self.left["tracks of one position"] = int((size == 1).sum())
        order = order[size[codes[order]] > 1]
        starts = np.flatnonzero(np.diff(codes[order], prepend=-1))
        return order, np.append(starts, len(order)), [str(ids[code]) for code in codes[order[starts]]]

    def times(self, frame, unit: float) -> Tuple[np.ndarray, bool]:
        """Times, s, and whether they count from 1970."""
        texts = frame["time"].str.strip()
        numbers = self.pandas.to_numeric(texts.str.replace(",", ".", regex=False), errors="coerce")
        if numbers.notna().all():
            found = numbers.to_numpy(float) * unit
            size = np.abs(found).max(initial=0.0)
            for least, name, part in ((1e17, "nano", 1e-9), (1e14, "micro", 1e-6), (1e11, "milli", 1e-3)):
                if size > least:
                    found, size = found * part, size * part
                    self.notes.append(f"times are {name}seconds since 1970")
                    break
            if size > LATEST:
                worst = int(np.abs(found).argmax())
                raise Error(f"{self.file}: {self.line(frame.index[worst])}: time is {texts.iloc[worst]!r}, "
                            f"expected {ISO_EXPECTED} since 1970 or since the first scan")
            return found, bool(size > SINCE_1970)
        codes, values = self.pandas.factorize(texts)
        try:
            found, is_local = _iso(list(values))
        except ValueError as error:
            row = int(np.flatnonzero(codes == list(values).index(str(error)))[0])
            raise Error(f"{self.file}: {self.line(frame.index[row])}: time is {str(error)[:40]!r}, "
                        f"expected {ISO_EXPECTED}") from None
        if is_local:
            self.notes.append("times without a zone are UTC")
        return found[codes], True
