# SPDX-License-Identifier: BSD-3-Clause
"""METAR reports as a year's weather: shares of the hours with some visibilities and rain rates.

Source: the code form FM 15 METAR (WMO No. 306) and its spellings in archives: statute miles, kilometres, visibility by
direction, lower case, and reports that continue on the next line. By day the visibility of a report is a meteorological
optical range (ICAO Annex 3), and by night the range of lamps of 1000 cd. Reports do not say whether it is night, so all
are read as by day. Rain rates are assumed. Debian has no parser of such
lines for Python (`python3-pymetar` reads the decoded pages of one service), so this module has its own grammar. The
grammar reads visibility and precipitation, and skips the rest of a report.
"""
from __future__ import annotations

import collections
import dataclasses
import itertools
import math
import pathlib
import re
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from ..._files import read_regular
from ..._pipeline import Error
from ._air import extinction_of_rain

MILE = 1609.344  # m
KOSCHMIEDER = 3.912  # visibility of a setting (2 % of contrast) times extinction at 550 nm
OPTICAL_RANGE = -math.log(0.05)  # the same for the visibility of a report
FOG = 1306.0  # visibility of a setting up to which air is called fog, m: an optical range of 1 km
LAMP = 1000.0  # intensity of a lamp by night, cd (ICAO Annex 3)
SEEN = 1e-6  # illuminance by a lamp that is just seen, lx; assumed
LEAST = 50.0  # visibility of the group 0000, which means "less than 50 m", m
MOST = 10_000.0  # visibility from which on reports do not distinguish, m
CLEAR = 23_000.0  # visibility in place of MOST and more, m; assumed
LIMITS = (500.0, 1000.0, 2000.0, 5000.0, MOST)  # limits between classes of visibility without rain, m ...
LIMITS_IN_RAIN = (2000.0,)  # ... and with rain
RAIN = {"-": 1.0, "": 5.0, "+": 15.0}  # mm/h; assumed
DRIZZLE = 0.5  # rain rate of drizzle of any intensity, mm/h; assumed
NOT_MODELLED = {"SN": "snow", "SG": "snow grains", "IC": "ice crystals", "PL": "ice pellets", "GR": "hail",
                "GS": "small hail", "UP": "unknown precipitation"}
# A station and a time. A time without Z counts only before a wind, because heads of bulletins also have six digits.
START = re.compile(r"\b([A-Z][A-Z0-9]{3})\s+(\d{6})(?:Z\b|(?=\s+(?:(?:AUTO|COR)\s+)?\S{3,8}(?:KT|MPS|KMH)\b))")
TIME = re.compile(r"(?:0[1-9]|[12]\d|3[01])(?:[01]\d|2[0-3])[0-5]\d")  # day, hour and minute
DATE = re.compile(r"\b((?:19|20)\d\d)-?(0[1-9]|1[0-2])-?(0[1-9]|[12]\d|3[01])")
FORECAST = re.compile(r"(?:\d{4}/\d{4}|\d{6})\s")  # validity period of a TAF (forecast)
# Remarks, trends, and the end of a report; clouds, temperatures and pressure.
END = re.compile(r"\s(?:RMKS?|NOSIG|TEMPO|BECMG|INTER|PROB\d\d|FM\d{4,6}|TTF)\b.*|=.*")
AFTER = re.compile(r"FEW|SCT|BKN|OVC|VV|NSC|NCD|SKC|CLR|M?\d\d/(?:M?\d\d|//)?$|[QA]\d{4}$")
METRES = re.compile(r"[MP]?(\d{3,4})(?:M|NDV|(N|NE|E|SE|S|SW|W|NW))?$")
MILES = re.compile(r"([MP]?)(\d+)(?:/([1-9]\d*))?(SM|KM)$")
PRESENT = re.compile(r"([-+]?)(?:MI|PR|BC|DR|BL|SH|TS|FZ)*"
                     r"((?:DZ|RA|SN|SG|IC|PL|GR|GS|UP|BR|FG|FU|VA|DU|SA|HZ|PY|PO|SQ|FC|SS|DS)*)$")


class Hour(NamedTuple):
    """The weather in one report."""

    station: str
    time: str  # day, hour, minute
    visibility: float  # as reported, m; infinite for 10 km or more
    rain: float  # mm/h
    others: Tuple[str, ...]  # codes of precipitation that is not modelled
    date: str = ""  # year, month and day before the report, if the file gives them


def night_factor(visibility: float) -> float:
    """Extinction by night over extinction by day at one reported visibility, by Allard's law for a lamp. @param
    visibility m"""
    return math.log(LAMP / (SEEN * visibility**2)) / OPTICAL_RANGE


def _plain(line: str) -> str:
    return re.sub(r"[,;\"\t]", " ", line.upper())


def report_of(line: str) -> Hour:
    """The weather in one report; ValueError names the missing part."""
    found = START.search(_plain(line))
    if not found:
        raise ValueError("expected a station and a time as in 'ZSSS 010000Z'")
    if not TIME.fullmatch(found[2]):
        raise ValueError("expected a day, an hour and a minute as in 010000Z")
    text = re.sub(r"(\d)\s+(SM|KM)\b", r"\1\2", END.sub("", found.string[found.end():])).strip()
    if re.search(r"\bTAF\b", found.string[:found.start()]) or FORECAST.match(text):
        raise ValueError("a forecast (TAF)")
    words = text.split()
    if "NIL" in words:
        raise ValueError("no observation (NIL)")
    visibility = _visibility(words)
    if visibility is None:
        raise ValueError("expected a visibility as in 0800, CAVOK or 1 1/2SM")
    rain, others = 0.0, []
    for word in words:
        present = PRESENT.match(word)
        if present:
            kinds = re.findall("..", present[2])
            if "RA" in kinds:
                rain = max(rain, RAIN[present[1]])
            elif "DZ" in kinds:
                rain = max(rain, DRIZZLE)
            others += [NOT_MODELLED[kind] for kind in kinds if kind in NOT_MODELLED]
    dates = ("".join(one.groups()) for one in DATE.finditer(found.string[:found.start()]))
    date = next((one for one in dates if one.endswith(found[2][:2])), "")  # others are not of the report
    return Hour(found[1], found[2], visibility, rain, tuple(others), date)


def _visibility(words: List[str]) -> Optional[float]:
    """Prevailing visibility in metres, or the least visibility that follows with a direction; None if it is missing."""
    # Visibility in metres stands before the clouds.
    first = next((k for k, word in enumerate(words) if AFTER.match(word)), len(words))
    for k, word in enumerate(words):
        metres, miles = METRES.match(word) if k < first else None, MILES.match(word)
        if word == "CAVOK":
            return math.inf
        if metres:
            sectors = itertools.takewhile(lambda sector: sector and sector[2], map(METRES.match, words[k + 1:]))
            found = min(float(one[1]) for one in (metres, *sectors) if one)
            return math.inf if found >= MOST - 1.0 else max(found, LEAST)
        if miles:
            before = int(words[k - 1]) if miles[3] and k and re.fullmatch(r"\d{1,2}", words[k - 1]) else 0
            found = (MILE if miles[4] == "SM" else 1000.0) * (before + _number(miles[2], miles[3]))
            return math.inf if found >= MOST or miles[1] == "P" else max(found, LEAST)
    return None


def _number(digits: str, denominator: Optional[str]) -> float:
    """A number, a fraction, or both without a space between them: 11/2 is one and a half."""
    if not denominator:
        return float(digits)
    whole = next((k for k in range(len(digits)) if digits[k] != "0" and int(digits[k:]) < int(denominator)), 0)
    return int(digits[:whole] or 0) + int(digits[whole:]) / int(denominator)


@dataclasses.dataclass
class Hours:
    """Reports of a file. Several reports in one hour share the hour."""

    file: str
    reports: List[Hour]
    bad: List[Tuple[int, str, str]]  # number and text of the line, and the problem

    def weighted(self) -> Iterator[Tuple[float, Hour]]:
        """Reports, each with its share of an hour."""
        # without a date, the same day and hour occur again in the next month
        hours: Dict[Any, List[Hour]] = collections.defaultdict(list)
        for number, (hour, group) in enumerate(itertools.groupby(self.reports, key=lambda one: one.time[:4])):
            together = list(group)
            hours[max(one.date for one in together) or number, hour] += together
        for together in hours.values():
            yield from ((1.0 / len(together), one) for one in together)

    def classes(self) -> Dict[Tuple[str, ...], float]:
        """Words of weather, with their hours. In a class without rain, the visibility follows from the mean extinction,
        to two digits. In a class with rain, the visibility is that of the haze in the rain, whose extinction is the
        reported extinction less that of the rain."""
        sums: Dict[Tuple[float, int], np.ndarray] = collections.defaultdict(lambda: np.zeros(2))
        for hours, one in self.weighted():
            number = sum(one.visibility >= limit for limit in (LIMITS_IN_RAIN if one.rain else LIMITS))
            sums[one.rain, number] += (hours, hours * max(OPTICAL_RANGE / one.visibility, KOSCHMIEDER / CLEAR))
        found: Dict[Tuple[str, ...], float] = collections.defaultdict(float)
        for (rain, _), (hours, total) in sorted(sums.items(), key=lambda item: item[0]):
            left = total / hours - (extinction_of_rain(rain) if rain else 0.0)
            visibility = float(f"{KOSCHMIEDER / max(left, KOSCHMIEDER / CLEAR):.2g}")
            haze = f"{'fog' if visibility <= FOG else 'haze'}:{visibility:.10g}"
            found[(haze, f"rain:{rain:g}") if rain else (haze,)] += float(hours)
        return dict(found)

    def year(self) -> List[Dict[str, Any]]:
        """The list `year` of a plan."""
        classes = self.classes()
        return [{"weather": list(words), "share": hours / sum(classes.values())} for words, hours in classes.items()]

    def words(self) -> str:
        """Words on the reports that were counted, the assumptions, and the lines that were left out."""
        hours = sum(share for share, _ in self.weighted())
        stations = ", ".join(dict.fromkeys(one.station for one in self.reports))
        said = f"{pathlib.Path(self.file).name}: {len(self.reports):,} METAR reports of {stations}, {hours:,.0f} hours"
        first = {why: (number, line) for number, line, why in reversed(self.bad)}
        for why, count in collections.Counter(why for _, _, why in self.bad).items():
            number, line = first[why]
            said += f"; left out: {count:,}, the first in line {number}, '{line[:60]}' ({why})"
        others = collections.Counter(name for one in self.reports for name in set(one.others))
        if others:
            counts = ", ".join(f"{name} ({count} reports)" for name, count in others.most_common())
            said += f"; not modelled, except for the visibility: {counts}"
        return (f"{said}. Assumed: {', '.join(f'{sign}RA {rate:g}' for sign, rate in RAIN.items())} and "
                f"DZ {DRIZZLE:g} mm/h; 10 km or more is {CLEAR / 1000:g} km; visibilities below are optical ranges, as by "
                f"day (in a setting times {KOSCHMIEDER / OPTICAL_RANGE:.2f}): by night, air of 500 m is "
                f"{night_factor(500.0):.1f} times as dense")


def _reports(text: str) -> Iterator[Tuple[int, str]]:
    """Reports with the numbers of their first lines. A report ends at its equals sign, at an empty line or at the next
    station and time. Lines that begin with # are comments."""
    number, report = 0, ""
    for here, line in enumerate(text.splitlines(), 1):
        if line.startswith("#"):
            continue
        for k, part in enumerate(line.split("=")):
            starts = START.search(_plain(part))
            if report and (starts or k or not line.strip()):
                yield number, report
                report = ""
            if report:
                report += " " + part.strip()
            elif starts:
                number, report = here, part.strip()
            elif k == 0 and part.strip():
                yield here, part.strip()
    if report:
        yield number, report


def read_metar(file) -> Hours:
    """The METAR and SPECI reports of a file, with any text before each report. `Error` if the file has none."""
    found = Hours(str(file), [], [])
    for number, report in _reports(read_regular(file).decode("utf-8", "replace")):
        try:
            found.reports.append(report_of(report))
        except ValueError as error:
            found.bad.append((number, report, str(error)))
    if not found.reports:
        first = f"; line {found.bad[0][0]}, '{found.bad[0][1][:60]}': {found.bad[0][2]}" if found.bad else ""
        raise Error(f"{file}: holds no METAR report, expected lines with a station, a time and a visibility{first}")
    return found
