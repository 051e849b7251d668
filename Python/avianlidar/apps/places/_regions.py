# SPDX-License-Identifier: BSD-3-Clause
"""Runways, the regions along and before runways, and random places in these regions."""
from __future__ import annotations

import dataclasses
import math
import re
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set, Tuple

import numpy as np

from ... import vtkAvianLidar as _wrapped

# Dimensions of strips and approaches: assumed, simplified from obstacle limitation surfaces of ICAO Annex 14.
STRIP_HALF_WIDTH = 150.0  # distance to either side of a runway's middle, m
STRIP_HEIGHTS = (0.5, 60.0)  # least and greatest height, m
APPROACH_LENGTH = 3000.0  # distance beyond a runway's end, m
APPROACH_HALF_WIDTH = (75.0, 0.15)  # half width at the end, m, and its increase per metre
APPROACH_HEIGHT = (45.0, 0.0524)  # height at the end, m, and its increase per metre (3 degrees)
APPROACH_LOWEST = 0.02  # least height as a share of the height
KINDS = {"strip": "strips", "approach": "approaches"}  # kinds by the first word of a region's name
SPREADS = ("distance", "area")  # distributions of places over a region
WINDS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")
Places = Tuple[np.ndarray, Dict[str, np.ndarray]]  # n x 3, m, and the numbers of the places in each region


@dataclasses.dataclass(frozen=True)
class Runway:
    """A runway in the scene's coordinates (m east and north)."""

    name: str
    start: Tuple[float, float]
    end: Tuple[float, float]
    width: float
    displaced: Tuple[float, float] = (0.0, 0.0)  # displacement of the thresholds at the start and at the end, m

    def words(self) -> str:
        """The name, length, width and displaced thresholds, in words."""
        names = self.name.split("/") if self.name.count("/") == 1 else ("its start", "its end")
        found = [f"of {name} by {away:.0f} m" for name, away in zip(names, self.displaced) if away > 0.0]
        return (f"{self.name}: {self.axis()[1]:.0f} m long, {self.width:g} m wide"
                f"{'; threshold displaced: ' + ', '.join(found) if found else ''}")

    def axis(self) -> Tuple[np.ndarray, float]:
        """The unit vector from start to end, and the length, m."""
        way = np.subtract(self.end, self.start)
        length = float(np.hypot(*way))
        return way / length, length

    def axes(self) -> np.ndarray:
        """The unit vectors from start to end and to the right, 2 x 2."""
        axis, _ = self.axis()
        return np.array([axis, (axis[1], -axis[0])])

    def beside(self, other: Runway) -> Tuple[float, float]:
        """How far another runway's ends lie beside this runway's line, and the gap between both along this line, m."""
        axis, length = self.axis()
        off = np.subtract([other.start, other.end], self.start)
        at = off @ axis
        return float(np.abs(off @ (-axis[1], axis[0])).max()), float(max(at.min() - length, -at.max(), 0.0))

    def ends(self) -> List[Tuple[np.ndarray, np.ndarray]]:
        """The start and the end, each with the unit vector away from the runway."""
        axis, _ = self.axis()
        return [(np.asarray(self.start), -axis), (np.asarray(self.end), axis)]


def ends_of(runways: Sequence[Runway]) -> np.ndarray:
    """The starts and ends of runways, n x 2, m."""
    return np.array([end for runway in runways for end in (runway.start, runway.end)], dtype=float).reshape(-1, 2)


def rounded(position: Sequence[float]) -> List[str]:
    """Coordinates in tenths of a metre, which is finer than the accuracy of terrain and maps."""
    return [f"{round(float(value), 1) + 0.0:.10g}" for value in position]


def wind(way: np.ndarray) -> str:
    """The direction (east, north) as one of eight winds."""
    return WINDS[round(math.atan2(way[0], way[1]) / (math.pi / 4)) % 8]


def designators(name: str) -> Set[str]:
    """The designators in a runway's name, as "09L" in "9L/27R", and those of the other ends. The words of a name
    without designators."""
    found: Set[str] = set()
    for number, letter in re.findall(r"(?<![0-9A-Z])([0-9]{1,2})([A-Z]?)(?![0-9A-Z])", name.upper()):
        other = {"L": "R", "R": "L"}.get(letter, letter)
        found |= {f"{int(number):02d}{letter}", f"{(int(number) + 17) % 36 + 1:02d}{other}"}
    return found or {word.strip().upper() for word in re.split(r"[/;-]", name) if word.strip()}


def end_names(runways: Sequence[Runway]) -> List[Tuple[str, str]]:
    """The designators of the start and the end of each runway, such as ("08", "26"). The designator of an end gives the
    direction in which aircraft land at this end. Ends of a runway without two designators are named by the wind:
    ("grass west", "grass east")."""
    end = _wrapped.vtkAvianLidarLandmarks.EndName
    names = [(end(runway.name, *-runway.axis()[0]), end(runway.name, *runway.axis()[0])) for runway in runways]
    known = [name for pair in names for name in pair]
    return [pair if all(known.count(name) == 1 for name in pair) else (f"{pair[0]} ({number})", f"{pair[1]} ({number})")
            for number, pair in enumerate(names, 1)]


def region_names(runways: Sequence[Runway]) -> Dict[str, List[str]]:
    """Names of strips and approaches in the order of the runways: "strip 08/26", "approach 08"."""
    pairs = end_names(runways)
    strips = ["/".join(sorted(pair)) if all(name in runway.name for name in pair) else runway.name
              for runway, pair in zip(runways, pairs)]
    return {"strips": [f"strip {name}" if strips.count(name) == 1 else f"strip {name} ({number})"
                       for number, name in enumerate(strips, 1)],
            "approaches": [f"approach {name}" for pair in pairs for name in pair]}


def runway_outline(runway: Runway, beyond: float = 60.0, beside: float = 185.0) -> np.ndarray:
    """The rectangle (4 x 2, m) around a runway where no lidar may stand. @param beyond distance beyond the ends, m
    @param beside distance from the middle, m"""
    axis, across = runway.axes() * [[beyond], [beside]]
    start, end = runway.start - axis, runway.end + axis
    return np.array([start - across, end - across, end + across, start + across])


def region_outlines(runways: Sequence[Runway]) -> Dict[str, np.ndarray]:
    """Each strip and approach seen from above, 4 x 2, m, by its name."""
    names, found = region_names(runways), {}
    half_width, wider = APPROACH_HALF_WIDTH
    for number, runway in enumerate(runways):
        near, far = np.outer([half_width, half_width + wider * APPROACH_LENGTH], runway.axes()[1])
        found[names["strips"][number]] = runway_outline(runway, 0.0, STRIP_HALF_WIDTH)
        for name, (end, way) in zip(names["approaches"][2 * number:], runway.ends()):
            outer = end + APPROACH_LENGTH * way
            found[name] = np.array([end - near, outer - far, outer + far, end + near])
    return found


def region_heights(name: str, heights: Optional[Tuple[float, float]] = None) -> Tuple[float, float]:
    """Least and greatest height (m) of places in "strips" or "approaches". @param heights of the plan, if any"""
    if heights is not None:
        return heights
    if name == "strips":
        return STRIP_HEIGHTS
    return APPROACH_LOWEST * APPROACH_HEIGHT[0], APPROACH_HEIGHT[0] + APPROACH_HEIGHT[1] * APPROACH_LENGTH


def _region_shares(runways: Sequence[Runway], shares: Optional[Mapping[str, Any]], spread: str
                   ) -> Dict[str, Dict[str, float]]:
    """The share of the places in each region of each kind, with the sum 1 over all regions."""
    wanted = {"strips": 1.0, "approaches": 1.0} if shares is None else dict(shares)
    wrong = f"shares are {wanted}, expected numbers from 0 of strips and approaches with a sum above 0"
    if not wanted.keys() <= {"strips", "approaches"}:
        raise ValueError(wrong)
    if spread not in SPREADS:
        raise ValueError(f"spread is {spread!r}, expected {' or '.join(SPREADS)}")
    found: Dict[str, Dict[str, float]] = {}
    for kind, names in region_names(runways).items():
        given = wanted.get(kind, 0.0)
        if isinstance(given, Mapping):
            short = [name.partition(" ")[2] for name in names]
            known = {**dict(zip(names, names)), **dict(zip(short, names))}
            known.update({runway.name: name for runway, name in zip(runways, names)} if kind == "strips" else {})
            for word in given:
                if word not in known:
                    raise ValueError(f"{kind} has {word!r}, expected some of {', '.join(short)}")
            found[kind] = {**dict.fromkeys(names, 0.0), **{known[word]: float(share) for word, share in given.items()}}
        else:
            sizes = ([runway.axis()[1] for runway in runways] if (kind, spread) == ("strips", "area") else
                     [1.0] * len(names))
            found[kind] = {name: float(given) * size / sum(sizes) for name, size in zip(names, sizes)}
    each = [share for of in found.values() for share in of.values()]
    if not 0.0 < sum(each) < np.inf or min(each) < 0.0:
        raise ValueError(wrong)
    return {kind: {name: share / sum(each) for name, share in of.items()} for kind, of in found.items()}


def _split(count: int, shares: Sequence[float]) -> np.ndarray:
    """Whole numbers in proportion to shares, with the sum `count`. The remainder goes to the largest fractions."""
    total = sum(shares)
    exact = np.array(shares) * (count / total) if total > 0.0 else np.zeros(len(shares))
    numbers = np.floor(exact + 1e-9).astype(int)
    if total > 0.0:
        numbers[np.argsort(-np.round(exact - numbers, 9), kind="stable")[:count - numbers.sum()]] += 1
    return numbers


def places_by_region(runways: Sequence[Runway], count: int = 12000, seed: int = 0,
                     shares: Optional[Mapping[str, Any]] = None, heights: Optional[Tuple[float, float]] = None,
                     spread: str = "distance") -> Places:
    """The places of `strips_and_approaches`, with their numbers by strip and by the approach to each end."""
    if count < 2 * len(runways) or not runways:
        raise ValueError(f"count is {count}, expected at least 2 for each of at least one runway")
    if heights is not None and not -np.inf < heights[0] <= heights[1] < np.inf:
        raise ValueError(f"heights are {tuple(heights)}, expected the least and the greatest, m")
    wanted = _region_shares(runways, shares, spread)
    random = np.random.default_rng(seed)
    of_strips, of_approaches = (list(of.values()) for of in wanted.values())
    strips = int(count * sum(of_strips) + 1e-9)
    numbers = [*_split(strips, of_strips), *_split(count - strips, of_approaches)]
    begins = [(runway, np.asarray(runway.start), runway.axis()[0]) for runway in runways]
    begins += [(runway, *end) for runway in runways for end in runway.ends()]
    places = []
    for number, ((runway, point, way), n) in enumerate(zip(begins, numbers)):
        if number < len(runways):
            away = random.uniform(0.0, runway.axis()[1], n)
            aside = random.uniform(-STRIP_HALF_WIDTH, STRIP_HALF_WIDTH, n)
            height = random.uniform(*region_heights("strips", heights), n)
        else:
            away = random.uniform(0.0, APPROACH_LENGTH, n)
            base, wider = APPROACH_HALF_WIDTH
            if spread == "area":  # the width of an approach increases linearly with the distance
                area = away / APPROACH_LENGTH * (base * APPROACH_LENGTH + 0.5 * wider * APPROACH_LENGTH ** 2)
                away = (np.sqrt(base ** 2 + 2.0 * wider * area) - base) / wider
            aside = random.uniform(-1.0, 1.0, n) * (base + wider * away)
            top = APPROACH_HEIGHT[0] + APPROACH_HEIGHT[1] * away
            height = random.uniform(APPROACH_LOWEST, 1.0, n) * top if heights is None else random.uniform(*heights, n)
        ground = point + away[:, None] * way + aside[:, None] * runway.axes()[1]
        places.append(np.column_stack([ground, height]))
    names = [name for of in wanted.values() for name in of]
    parts = np.split(np.arange(count), np.cumsum(numbers)[:-1])
    return np.concatenate(places), {name: part for name, part in zip(names, parts) if len(part)}


def by_kind(regions: Mapping[str, np.ndarray]) -> Dict[str, np.ndarray]:
    """The numbers of all places in strips, in approaches, and in other regions, as from `places_by_region`."""
    kinds: Dict[str, List[np.ndarray]] = {}
    for name, numbers in regions.items():
        kinds.setdefault(KINDS.get(name.partition(" ")[0], name), []).append(numbers)
    return {kind: np.concatenate(parts) for kind, parts in kinds.items()}


def strips_and_approaches(runways: Sequence[Runway], count: int = 12000, seed: int = 0,
                          shares: Optional[Mapping[str, Any]] = None, heights: Optional[Tuple[float, float]] = None,
                          spread: str = "distance") -> Places:
    """Random places, and the region of each place. Strips lie along each runway, 150 m to either side, 0.5 to 60 m
    high. Approaches lie beyond each runway's end to 3 km, 75 m + 0.15 d to either side at the distance d, from 0.02
    times to 1 times 45 m + 0.0524 d high.

    shares   shares of the places by the name of the region, "strips" and "approaches"; default 1 for both. A region
             without a share is left out. In place of a number: shares of single regions by name (`region_names`), as
             in {"approaches": {"08": 1}}
    heights  least and greatest z of all places, m, in place of the regions' own heights; evenly distributed
    spread   "distance": equally many on each metre along strips and approaches. "area": equally many on each square
             metre
    @return n x 3 coordinates, m; the numbers of the places by the name of the region
    """
    points, regions = places_by_region(runways, count, seed, shares, heights, spread)
    return points, by_kind(regions)
