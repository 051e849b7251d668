# SPDX-License-Identifier: BSD-3-Clause
"""The ranges at which a lidar detects birds and other targets, and the elevation that the beams need for birds at a
height.

>>> import avianlidar as al
>>> from avianlidar import reach
>>> gulls = reach.within_beams(al.Sensor("Search905"), "herring gull", visibility=23e3)  # m
>>> round(gulls.to(0.5), -1)  # half of them by one scan, m
580.0
"""
import copy
import dataclasses
import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from . import vtkAvianLidar as _wrapped
from ._coverage import Coverage
from ._numbers import figures
from ._pipeline import Progress
from ._scene import Scene
from ._sensor import Sensor
from ._weather import weather
from .apps.coverage._plan import Plan
from .apps.coverage._targets import PHASES, Target, flock, look, met, own_species, places_in_flock, scan_of, target
from .apps.inputs._air import as_received
from .apps.pages._words import plural
from .apps.places._candidates import TABLE

RANGES = 48
NEAR = 200  # beams nearest to an elevation from which the azimuths of a pattern without columns are found
BIRDS = 256  # birds at each range
FEW = 40  # birds at each range in the search for the end of the ranges
SEED = 1
# Roberts' sequence in the unit square: the powers 1 and 2 of 1/1.3247..., the real root of x^3 = x + 1. Its points are
# evenly spread, so that a share is as sure as with at least twice as many random birds.
EVENLY = np.array([0.7548776662466927, 0.5698402909980532])
SEARCHED = 0.3  # share of the work in the search for the end of the ranges
LEAST = 0.005  # least share that counts as detected when the end of the ranges is searched
RAISES = 8  # number of raised bands that are tried
SHARES = (0.9, 0.5, 0.1)  # shares of birds for which the report gives ranges
TARGETS = 64  # targets at each range
STEPS = 12  # ranges between which those of SHARES are searched
HALVINGS = 3  # of the steps around the ranges of SHARES
CONE = 2.0  # half angle about a line in which beams are counted, deg
CLEAR = 23e3  # visibility of the air if no weather is given, m


@dataclasses.dataclass(frozen=True)
class Reach:
    """Shares of birds by range, in free air without a scene.

    ranges           n, m            one_scan  share of birds detected by one scan, n
    error            standard error of one_scan if birds were drawn at random, n; the evenly spread birds err less
    several_scans    share detected by `required_detections` of `number_of_scans` scans, n
    """

    ranges: np.ndarray
    one_scan: np.ndarray
    error: np.ndarray
    several_scans: np.ndarray

    def to(self, share: float, several: bool = False) -> float:
        """The greatest range to which at least a share of birds is detected, m; 0 without such a range."""
        values = self.several_scans if several else self.one_scan
        above = np.flatnonzero(values >= share)
        last = slice(above[-1], above[-1] + 2) if len(above) else slice(0)
        return float(np.interp(share, values[last][::-1], self.ranges[last][::-1])) if len(above) else 0.0


def band(sensor: Sensor) -> tuple[float, float]:
    """Lowest and highest elevation of the beam centres, deg."""
    up = np.degrees(np.arcsin(np.clip(sensor.beams["direction"][:, 2], -1.0, 1.0)))
    return float(up.min()), float(up.max())


def _azimuths(directions: np.ndarray, elevations: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Azimuths, rad, at shares of the way between the outermost of the NEAR beams nearest to each elevation."""
    directions = directions[np.argsort(directions[:, 2], kind="stable")]
    up, about = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0)), np.arctan2(directions[:, 0], directions[:, 1])
    count = min(NEAR, len(about))
    first = np.clip(np.searchsorted(up, elevations) - count // 2, 0, len(about) - count)
    near = about[first[:, None] + np.arange(count)]
    return near.min(axis=1) + shares * (near.max(axis=1) - near.min(axis=1))


def _lines(sensor: Sensor, count: int, inset: float = 0.0) -> np.ndarray:
    """Directions evenly in the band, less `inset` (rad) at both ends, about beams that are drawn with a fixed seed."""
    directions = sensor.beams["direction"]
    random, (low, high) = np.random.default_rng(SEED), np.radians(band(sensor))
    heights, shares = (EVENLY * np.arange(0.5, count)[:, None] % 1.0).T
    up = low + inset + (high - low - 2.0 * inset) * heights
    if sensor.algorithm.GetNumberOfPrisms() > 0:
        about = _azimuths(directions, up, shares)
    else:
        of = directions[random.integers(len(directions), size=count)]
        about = np.arctan2(of[:, 0], of[:, 1]) + np.radians((shares - 0.5) * sensor.azimuth_step)
    return np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)])


def within_beams(sensor: Sensor, species: str | Target = "herring gull", ranges: Sequence[float] | None = None,
                 birds: int = BIRDS, *, progress: Progress | None = None, **settings: Any) -> Reach:
    """Birds in the band of a level sensor: elevations evenly between the lowest and the highest beam, azimuths about
    beams that are drawn with a fixed seed. With rotating prisms, azimuths lie evenly between the leftmost and the
    rightmost beam at the elevation, and the scan is the first scan. There are no surfaces, and therefore no shadows and
    no clutter.

    species   of the bird; or a `flock`, of which one bird must be detected; or another `target`. Birds of a flock count
              as independent and do not hide one another. For walls and ground, shares of the beams that meet them
    ranges    m; default: the part of RANGES in which birds are detected
    birds     number of birds at each range; flocks are fewer, and other targets are TARGETS
    progress  as for Coverage
    settings  properties of Coverage, for example visibility=10e3 (m), required_detections=2, number_of_scans=3,
              species_file_name="my.csv"

    >>> board = within_beams(Sensor("OS1_64"), target("board:0.5", reflectance=0.1))
    >>> round(board.to(0.5), -1)  # half of the boards, m
    50.0
    """
    if birds < 2:
        raise ValueError(f"birds is {birds}, expected at least 2 at each range")
    sensor = _level(sensor)
    if isinstance(species, Target) and species.kind != "flock":
        return _of_target(sensor, species, ranges, progress, settings)
    places, few = np.zeros((birds, 1, 3)), FEW
    if isinstance(species, Target):
        file, number = str(settings.get("species_file_name", "")), int(species.size)
        flocks, few = max(birds // number, min(birds, TARGETS)), max(FEW // number, 8)
        places = np.array([places_in_flock(species.species, number, SEED + k, file) for k in range(flocks)])
    part = [0.0, 0.0 if ranges is not None else SEARCHED]  # of the work that runs

    def tell(share: float, name: str) -> None:
        if progress and name == cover.algorithm.GetClassName():  # other filters count from 0 to 1, too
            progress(part[0] + share * (part[1] - part[0]), name)

    cover = Coverage(Scene(), sensor, progress=tell if progress else None)
    cover.set(**{**settings, "species": getattr(species, "species", species), "clutter": False})
    lines = _lines(sensor, len(places))

    def at(distances: np.ndarray, lines: np.ndarray) -> list[np.ndarray]:
        middles = (distances[:, None, None] * lines)[:, :, None]
        cover.places = (middles + places[:len(lines)]).reshape(-1, 3)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about missing surfaces
            one, several = (cover[name].reshape(len(distances), len(lines), -1).astype(float)
                            for name in ("detection_probability", "track_probability"))
        if one.shape[2] == 1:
            return [one[:, :, 0], several[:, :, 0]]
        any_bird = 1.0 - np.prod(1.0 - one, axis=2)
        return [any_bird, _several(any_bird, cover.required_detections, cover.number_of_scans)]

    if ranges is None:
        end, found = math.inf, sensor.range_gate
        for k in range(4):
            if found > 0.5 * end:
                break
            part[:] = 0.25 * SEARCHED * k, 0.25 * SEARCHED * (k + 1)
            end, tried = found, np.linspace(found / RANGES, found, RANGES)
            seen = np.flatnonzero(at(tried, lines[:few])[0].mean(axis=1) > LEAST)
            found = tried[min(seen[-1] + 1, RANGES - 1)] if len(seen) else tried[0]
        ranges = np.linspace(found / RANGES, found, RANGES)
    distances, part[:] = np.asarray(ranges, dtype=float), (part[1], 1.0)
    one, several = at(distances, lines)
    return Reach(distances, one.mean(axis=1), one.std(axis=1) / math.sqrt(len(lines)), several.mean(axis=1))


def _level(sensor: Sensor) -> Sensor:
    """The sensor at the origin, upright."""
    return copy.deepcopy(sensor).set(position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0))


def _several(one: np.ndarray, required: int, scans: int) -> np.ndarray:
    """Probability of `required` detections in independent scans. @param one probability of one"""
    ways = (math.comb(scans, k) * one ** k * (1.0 - one) ** (scans - k) for k in range(required, scans + 1))
    return np.sum(list(ways), axis=0)


def _of_target(sensor: Sensor, what: Target, ranges: Sequence[float] | None, progress: Progress | None,
               settings: dict[str, Any]) -> Reach:
    """`within_beams` for all targets but birds and flocks."""
    air = {"visibility": CLEAR, **settings}
    scan, lines, done = scan_of(sensor, air, SEED), _lines(sensor, TARGETS), 0
    low, high = np.radians(band(sensor))

    def at(distances: np.ndarray) -> np.ndarray:
        nonlocal done
        done += len(distances)
        if progress:
            progress(done / (done + STEPS), "reach")
        if not what.fills:
            return np.array([look(scan, what, distance, lines, settings, SEED)[0] for distance in distances])
        up = -np.arcsin(np.minimum(1.0, what.height / distances))
        inside = (what.kind == "wall") | (distances > what.height) & (low <= up) & (up <= high)
        found = np.zeros((len(distances), PHASES))
        if inside.any():
            found[inside] = met(sensor, what, distances[inside], air, SEED)
        return found

    if ranges is None:
        one, distances = _searched(at, sensor.range_gate, 0.9 if what.fills else 0.5)
    else:
        distances = np.asarray(ranges, dtype=float)
        one = at(distances)
    required, scans = settings.get("required_detections", 2), settings.get("number_of_scans", 3)
    return Reach(distances, one.mean(axis=1), one.std(axis=1) / math.sqrt(one.shape[1]),
                 _several(one, required, scans).mean(axis=1))


def _searched(at: Callable[[np.ndarray], np.ndarray], gate: float, factor: float) -> tuple[np.ndarray, np.ndarray]:
    """Probabilities of detection and their ranges, which are dense about those of SHARES. @param gate longest range, m
    @param factor between ranges at which the end is searched"""
    end = near = gate
    while near > gate / 2048.0 and at(np.array([near])).mean() <= LEAST:
        end, near = near, factor * near
    ranges = np.linspace(end / STEPS, end, STEPS)
    found = at(ranges)
    for _ in range(HALVINGS):
        mean = found.mean(axis=1)
        last = {int(k) for share in SHARES for k in np.flatnonzero(mean >= share)[-1:] if k + 1 < len(mean)}
        new = np.array([0.5 * (ranges[k] + ranges[k + 1]) for k in sorted(last)])
        if len(new):
            order = np.argsort(np.concatenate([ranges, new]))
            ranges, found = (np.concatenate([old, more])[order] for old, more in ((ranges, new), (found, at(new))))
    return found, ranges


def points(sensor: Sensor, what: str | Target, distance: float, **settings: Any) -> float:
    """Mean number of points of one scan on a bird, flock or other target at a distance (m) in the beams; for walls and
    ground, points per square metre. @param settings as for `within_beams`"""
    sensor, air = _level(sensor), {"visibility": CLEAR, **settings}
    if not isinstance(what, Target) or not what.fills:
        lines = _lines(sensor, TARGETS)
        return float(look(scan_of(sensor, air, SEED), what, distance, lines, settings, SEED)[1].mean())
    low, high = np.radians(band(sensor))
    cone, sine = min(math.radians(CONE), 0.25 * (high - low)), 1.0
    lines = _lines(sensor, TARGETS, cone)
    if what.kind == "ground":
        sine = what.height / distance
        about, down = np.arctan2(lines[:, 0], lines[:, 1]), -math.asin(sine)
        if not low <= down <= high:
            return 0.0
        up = np.clip(down, low + cone, high - cone)
        lines = np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), 0.0 * about + np.sin(up)])
    beams = (sensor.beams["direction"] @ lines.T >= math.cos(cone)).sum(axis=0).mean()  # in a cone
    per_steradian = beams / (2.0 * math.pi * (1.0 - math.cos(cone)))
    return float(met(sensor, what, np.array([distance]), air, SEED).mean() * per_steradian * sine / distance ** 2)


def air_of(sensor: Sensor, words: Sequence[str] | None = None) -> dict[str, Any]:
    """Settings of `within_beams` for words of `--weather`; the visibility is CLEAR if no word gives a visibility. For a
    receiver without an aperture, air and drops only weaken light."""
    attenuation = _wrapped.vtkAvianLidarCoverage().GetAttenuationCoefficient()
    return as_received(sensor, {"attenuation_coefficient": attenuation, "visibility": CLEAR, "air_backscatter": False,
                                "rain_rate": 0.0, **weather(words)})


def interval(sensor: Sensor) -> tuple[float, float] | None:
    """What the ranges of real units are of the ranges by a sensor's file, the least and the greatest factor, for
    surfaces that fill the beam: `range_interval` of the file, else the error of the fit; None if both are missing."""
    said = sensor.description
    bar = said.get("sheet", {}).get("bar")
    low, high = said.get("range_interval", {}).get("value", (1.0 - (bar or 0.0), 1.0 + (bar or 0.0)))
    return None if low == high else (max(low, 0.01), high)


def in_interval(sensor: Sensor, species: str | Target, *, progress: Progress | None = None,
                **settings: Any) -> tuple[Reach, Reach] | None:
    """What the least and the most sensitive unit of a sensor's interval detect. Such a unit receives the square of its
    factor times the light. @param settings as for within_beams"""
    factors = interval(sensor)
    if factors is None:
        return None

    def unit(factor: float, begin: float) -> Reach:
        def tell(share: float, name: str) -> None:
            if progress:
                progress(begin + 0.5 * share, name)
        other = copy.deepcopy(sensor).set(pulse_energy=factor ** 2 * sensor.pulse_energy)
        return within_beams(other, species, progress=tell, **settings)

    return unit(factors[0], 0.0), unit(factors[1], 0.5)


def uncertainty(name: str, sensor: Sensor) -> str:
    """A sentence on the interval of a sensor; empty if its file gives no interval."""
    factors = interval(sensor)
    return "" if factors is None else (
        f"Units of {name} see surfaces {factors[0]:.3g} to {factors[1]:.3g} times as far as computed "
        f"({sensor.description.get('range_interval', {}).get('source', 'the error of the fit to its data sheet')}).")


def metres(value: float) -> str:
    """A range with the two digits that the random draw of birds allows."""
    return f"{float(f'{value:.2g}'):g} m" if value > 0.0 else "–"


def in_words(found: Reach, limits: tuple[Reach, Reach] | None, share: float = 0.5, several: bool = False) -> str:
    """The range to which a share of birds is detected, with its interval. @param limits of `in_interval`"""
    first, last = (one.to(share, several) for one in limits) if limits else (0.0, 0.0)
    if last == 0.0:
        return metres(found.to(share, several))
    low = f"{first:.2g}" if first < 100.0 else f"{float(f'{first:.2g}'):g}"
    return f"{metres(found.to(share, several))} ({low} to {metres(last)})"


def half(sensor: Sensor, found: Reach) -> str:
    """The range to which half of the birds are detected, without the interval of units like `sensor` (`in_words`)."""
    return in_words(found, None)


def sentence(name: str, what: str | Target, found: Reach, limits: tuple[Reach, Reach] | None,
             number: float | None = None, gate: float = math.inf) -> str:
    """Sentences on the range to which half of the birds or targets are detected. The range of birds is compared with
    the width of a runway's strip. @param limits of `in_interval` @param number of points at half of the range @param
    gate end of the range gate, m"""
    to, width = found.to(0.5), 2.0 * TABLE["precision"]["4"]["strip"]["half_width"]
    kind, of = "bird", ""
    if isinstance(what, Target):
        kind, where = what.kind, "at half of the places in its beams"
        if what.fills:
            where = "with half of the beams that meet it"
        of = f"{'' if kind == 'ground' else 'a '}{what.words}, {where},"
    if kind in ("bird", "flock"):
        of = f"half of the {getattr(what, 'words', plural(str(what))).replace('flock', 'flocks', 1)} in its beams"
    if to == 0.0:
        return f"{name} sees {of} at no range."
    text = f"{name} sees {of} to {in_words(found, limits)}"
    if kind == "bird":
        text += f", {'less' if to < width else 'more'} than the {width:g} m that the strip of a large runway is wide"
    if to > 0.99 * gate:
        text += ", where its range gate ends"
    if kind == "ground" and number == 0.0:
        text += ". At half of this range, no beam meets the ground"
    elif number is not None:
        on = {"wall": "in a square metre", "ground": "in a square metre"}.get(kind)
        on = on or f"on a {what if kind == 'bird' else kind}"
        text += f". At half of this range, one scan has {figures(number, 2)} points {on}"
    return f"{text}."


def heights_in_band(plan: Plan, heights: Sequence[float], detected_to: float) -> list[dict[str, float]]:
    """A row for each height (z, m): the ground distances from which and until which the band of the plan's sensor
    contains the height, and the ground distance to which birds are near enough, m; `from` is inf and `to` is 0 if no
    distance fulfils the condition.

    detected_to  m along the line of sight, for example Reach.to(0.5)
    """
    low, high = band(plan.sensor)
    rows = []
    for height in heights:
        above = height - plan.sensor.position[2]
        # Limits of the band, deg, on the side of the horizon where the bird is
        near, far = (high, low) if above >= 0.0 else (-low, -high)
        start = 0.0 if near >= 90.0 or above == 0.0 and far <= 0.0 <= near else math.inf
        if 0.0 < near < 90.0 and above != 0.0:
            start = abs(above) / math.tan(math.radians(near))
        rows.append({"height": float(height), "above": above, "from": start,
                     "until": abs(above) / math.tan(math.radians(far)) if far > 0.0 else math.inf,
                     "to": math.sqrt(max(detected_to ** 2 - above ** 2, 0.0))})
    return rows


def advice(plan: Plan, detected_to: float) -> dict[str, Any] | None:
    """How high the band must reach, if the band contains one of the plan's heights only beyond half of the distance to
    which birds are detected. None if the plan gives no heights, or if all heights are contained.

    @return `needed` (elevation of the highest beams, deg; None if birds are too far away for any elevation), `rows` as
    in `heights_in_band`, and `ways`: changes in words (`what`), their costs, and `changes` to try (properties of the
    sensor)
    """
    if not plan.asked:
        return None
    rows = heights_in_band(plan, plan.heights, detected_to)
    if all(row["from"] <= 0.5 * row["to"] for row in rows):
        return None
    near = [row for row in rows if row["above"] > 0.0 and row["to"] > 0.0]
    if not near:
        return {"needed": None, "rows": rows, "ways": []}
    sensor = plan.sensor
    low, high = band(sensor)
    needed = max(math.degrees(math.atan2(row["above"], 0.5 * row["to"])) for row in near)
    ways: list[dict[str, Any]] = []
    regular = (not sensor.channel_elevations and sensor._beams is None and sensor.elevation_step > 0.0 and
               not any(sensor.orientation) and not sensor.algorithm.GetNumberOfPrisms())
    if high < needed < 90.0 and regular:
        number, lowest = sensor.number_of_channels, sensor.minimum_elevation
        more = number + math.ceil((needed - high) / sensor.elevation_step - 1e-9)
        slower = round(sensor.rotation_rate * number / more, 6)
        raised = [{"minimum_elevation": lowest + (needed - high) * k / RAISES} for k in range(1, RAISES + 1)]
        ways = [{"what": lambda _: f"{more} beams above one another instead of {number}, at the same step",
                 "cost": f"scans that take {figures(more / number, 2)} times as long, at the same pulses a second",
                 "changes": [{"number_of_channels": more, "rotation_rate": slower}]},
                {"what": lambda changes: f"the same beams, all higher, from {changes['minimum_elevation']:.1f} to "
                                         f"{changes['minimum_elevation'] + high - low:.1f}°: the best of {RAISES} "
                                         "tried",
                 "cost": "birds that fly lower", "changes": raised}]
    return {"needed": needed, "rows": rows, "ways": ways}
