# SPDX-License-Identifier: BSD-3-Clause
"""How far a lidar detects a bird, and how high its band must go for birds at a height.

>>> import avianlidar as al
>>> from avianlidar import reach
>>> gulls = reach.within_beams(al.Sensor("Search905"), "herring gull", visibility=23e3)  # m
>>> round(gulls.to(0.5), -1)  # half of them by one scan, m
580.0
"""
from __future__ import annotations

import copy
import dataclasses
import math
import warnings
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from . import vtkAvianLidar as _wrapped
from ._coverage import Coverage
from ._scene import Scene
from ._sensor import Sensor
from ._weather import weather
from .apps._air import as_received
from .apps._plan import Plan
from .apps._candidates import table

RANGES = 48
NEAR = 200  # beams, of a pattern without columns, that say how far it reaches to the sides at an elevation
BIRDS = 400  # at each range
FEW = 40  # of them, that say where ranges end
SEED = 1
LEAST = 0.005  # share that still counts as detected, to find where ranges end
RAISES = 8  # of the band, that are tried
SHARES = (0.9, 0.5, 0.1)  # of birds, whose ranges the report gives
CLEAR = 23e3  # m, visibility of air of which nothing is said


@dataclasses.dataclass(frozen=True)
class Reach:
    """Shares of birds by range, in free air: without a scene.

    ranges           n, m            one_scan  share of birds that one scan detects, n
    error            standard error of one_scan, as birds are drawn at random, n
    several_scans    share that `required_detections` of `number_of_scans` scans detect, n
    """

    ranges: np.ndarray
    one_scan: np.ndarray
    error: np.ndarray
    several_scans: np.ndarray

    def to(self, share: float, several: bool = False) -> float:
        """The greatest range to which at least a share of birds is detected, m; 0 where there is none."""
        values = self.several_scans if several else self.one_scan
        above = np.flatnonzero(values >= share)
        last = slice(above[-1], above[-1] + 2) if len(above) else slice(0)
        return float(np.interp(share, values[last][::-1], self.ranges[last][::-1])) if len(above) else 0.0


def band(sensor: Sensor) -> Tuple[float, float]:
    """Least and greatest elevation of the beams' middles, deg."""
    up = np.degrees(np.arcsin(np.clip(sensor.beams["direction"][:, 2], -1.0, 1.0)))
    return float(up.min()), float(up.max())


def _azimuths(directions: np.ndarray, elevations: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Evenly between the outermost of the NEAR beams that are nearest to each elevation, rad: of a pattern without columns."""
    up = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))
    order = np.argsort(up, kind="stable")
    about = np.arctan2(directions[order, 0], directions[order, 1])
    count = min(NEAR, len(about))
    first = np.clip(np.searchsorted(up[order], elevations) - count // 2, 0, len(about) - count)
    near = about[first[:, None] + np.arange(count)]
    return random.uniform(near.min(axis=1), near.max(axis=1))


def within_beams(sensor: Sensor, species: str = "herring gull", ranges: Optional[Sequence[float]] = None, birds: int = BIRDS,
                 **settings: Any) -> Reach:
    """Birds in the band of a sensor, which is taken to stand level: elevations evenly between its lowest and its highest beam,
    azimuths about its beams (with rotating prisms evenly between the leftmost and the rightmost beam at that elevation, and one
    scan is the first), drawn with a fixed seed. Without surfaces, so without shadows and clutter.

    ranges    m; default RANGES of them to where next to nothing is detected
    birds     at each range
    settings  properties of Coverage, for example visibility=10e3 (m), required_detections=2, number_of_scans=3
    """
    if birds < 2:
        raise ValueError(f"birds is {birds}, expected at least 2 at each range")
    sensor = copy.deepcopy(sensor).set(position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0))
    directions = sensor.beams["direction"]
    cover = Coverage(Scene(), sensor).set(**{**settings, "species": species, "clutter": False})
    random = np.random.default_rng(SEED)
    up = np.radians(random.uniform(*band(sensor), birds))
    if sensor.algorithm.GetNumberOfPrisms() > 0:
        about = _azimuths(directions, up, random)
    else:
        of = directions[random.integers(len(directions), size=birds)]
        about = np.arctan2(of[:, 0], of[:, 1]) + np.radians(random.uniform(-0.5, 0.5, birds) * sensor.azimuth_step)
    lines = np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)])

    def at(distances: np.ndarray, lines: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        cover.places = (distances[:, None, None] * lines).reshape(-1, 3)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that there are no surfaces
            return cover["detection_probability"].reshape(len(distances), -1), cover["track_probability"].reshape(len(distances), -1)

    if ranges is None:
        end, found = math.inf, sensor.range_gate
        for _ in range(4):
            if found > 0.5 * end:
                break
            end, tried = found, np.linspace(found / RANGES, found, RANGES)
            seen = np.flatnonzero(at(tried, lines[:FEW])[0].mean(axis=1) > LEAST)
            found = tried[min(seen[-1] + 1, RANGES - 1)] if len(seen) else tried[0]
        ranges = np.linspace(found / RANGES, found, RANGES)
    distances = np.asarray(ranges, dtype=float)
    one, several = at(distances, lines)
    return Reach(distances, one.mean(axis=1, dtype=float), one.std(axis=1, dtype=float) / math.sqrt(birds), several.mean(axis=1, dtype=float))


def air_of(sensor: Sensor, words: Optional[Sequence[str]] = None) -> Dict[str, Any]:
    """Settings of `within_beams` in a weather, by words as of `--weather`; CLEAR where they say no visibility. Where a receiver has no aperture,
    air and drops only weaken."""
    attenuation = _wrapped.vtkAvianLidarCoverage().GetAttenuationCoefficient()
    return as_received(sensor, {"attenuation_coefficient": attenuation, "visibility": CLEAR, "air_backscatter": False, "rain_rate": 0.0, **weather(words)})


def left_open(sensor: Sensor) -> float:
    """What ranges by a sensor's fitted receiver are good for, relative; nan for one that is not fitted to several points of a sheet."""
    return float(sensor.description.get("sheet", {}).get("bar", math.nan))


def metres(value: float) -> str:
    """A range in the two digits that the draw of birds leaves of it."""
    return f"{float(f'{value:.2g}'):g} m" if value > 0.0 else "–"


def half(sensor: Sensor, found: Reach) -> str:
    """The range to which half of the birds are detected, with the ranges that the fit of the receiver leaves open."""
    to, bar = found.to(0.5), left_open(sensor)
    between = "" if math.isnan(bar) or to == 0.0 else f" ({metres((1.0 - bar) * to).removesuffix(' m')} to {metres((1.0 + bar) * to)})"
    return metres(to) + between


def sentence(name: str, species: str, sensor: Sensor, found: Reach) -> str:
    """How far half of the birds are seen, beside the width of a runway's strip."""
    to, width = found.to(0.5), 2.0 * table()["precision"]["4"]["strip"]["half_width"]
    if to == 0.0:
        return f"{name} sees half of the {species}s in its beams at no range."
    return (f"{name} sees half of the {species}s in its beams to {half(sensor, found)}, {'less' if to < width else 'more'} than the {width:g} m that the strip "
            "of a large runway is wide.")


def heights_in_band(plan: Plan, heights: Sequence[float], detected_to: float) -> List[Dict[str, float]]:
    """A row for each height (z, m): from which distance on the ground the band of the plan's sensor holds it, and to which one
    birds are near enough, m; inf and 0 where that is never.

    detected_to  m along the line of sight, for example Reach.to(0.5)
    """
    low, high = band(plan.sensor)
    rows = []
    for height in heights:
        above = height - plan.sensor.position[2]
        limit = high if above >= 0.0 else -low  # deg, to the side of the horizon where the bird is
        start = abs(above) / math.tan(math.radians(limit)) if 0.0 < limit < 90.0 else 0.0 if limit >= 90.0 or above == 0.0 else math.inf
        rows.append({"height": float(height), "above": above, "from": start,
                     "to": math.sqrt(max(detected_to ** 2 - above ** 2, 0.0))})
    return rows


def advice(plan: Plan, detected_to: float) -> Optional[Dict[str, Any]]:
    """How high the band must go, if a height that is asked for is not in it before half of the distance to which birds are detected:
    so that it is. None where the plan asks for no heights, or nothing is to be mended.

    @return `needed` (elevation of the highest beams, deg; None where no elevation helps, as birds there are too far away), `rows`
    as above, and `ways`: what could be done (words for `changes`), what it costs, and `changes` to try (properties of the sensor)
    """
    if not plan.asked:
        return None
    rows = heights_in_band(plan, plan.heights, detected_to)
    if all(row["from"] <= 0.5 * row["to"] for row in rows):
        return None
    near = [row for row in rows if row["above"] > 0.0 and row["to"] > 0.0]
    if not near:
        return {"needed": None, "rows": rows, "ways": []}
    low, high = band(plan.sensor)
    needed = max(math.degrees(math.atan2(row["above"], 0.5 * row["to"])) for row in near)
    ways: List[Dict[str, Any]] = []
    sensor = plan.sensor
    regular = (not sensor.channel_elevations and sensor._beams is None and sensor.elevation_step > 0.0 and
               not any(sensor.orientation) and not sensor.algorithm.GetNumberOfPrisms())
    if high < needed < 90.0 and regular:
        number = sensor.number_of_channels
        more = number + math.ceil((needed - high) / sensor.elevation_step - 1e-9)
        raised = [{"minimum_elevation": sensor.minimum_elevation + (needed - high) * k / RAISES} for k in range(1, RAISES + 1)]
        ways = [{"what": lambda _: f"{more} beams above one another instead of {number}, at the same step",
                 "cost": f"scans that take {more / number:.2g} times as long, at the same pulses a second",
                 "changes": [{"number_of_channels": more, "rotation_rate": round(sensor.rotation_rate * number / more, 6)}]},
                {"what": lambda changes: f"the same beams, all higher, from {changes['minimum_elevation']:.1f} to "
                                         f"{changes['minimum_elevation'] + high - low:.1f}°: the best of {RAISES} tried",
                 "cost": "birds that fly lower", "changes": raised}]
    return {"needed": needed, "rows": rows, "ways": ways}
