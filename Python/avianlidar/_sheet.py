# SPDX-License-Identifier: BSD-3-Clause
"""Fit of a receiver to all points of the maker's data sheet.

A data sheet gives the range at which a board of a reflectance is detected with some probability in some light. One fitted number cannot
reproduce all points: with 1/r^2 a board of 80 % is detected 2.83 times as far as a board of 10 %; data sheets give ratios of 1.7 to 2.5.
The model: a board of width w at the range R fills f = min(1, w^2/(Omega R^2)) of a round beam, and
(1 - exp(-2 k^2 f))/(1 - exp(-2 k^2)) of a Gaussian beam with the truncation k. The filled part returns
n = eta E rho A exp(-2 mu R)/(pi R^2 h nu) electrons, with mu of clear air (a visibility of 23 km). Sky and sun add background: daylight
from the board, and the sky beside the board, which is the sensor's `background_radiance` in 100 klx and less in less light. The board is
detected with the probability that n and Gaussian noise exceed the threshold (Documentation/reference/sensor-files.md).
Up to three numbers are fitted, as far as the points determine them:
- the aperture A, which sets how much light is received;
- the filter's bandwidth (at most BANDWIDTH), which sets how much daylight is received, including daylight of a view wider than the beam;
- the width of boards without a given width, which belongs to the test and not to the receiver.
The fit is SciPy's least squares over logarithms of ranges.
"""
from __future__ import annotations

import dataclasses
import itertools
import json
import numbers
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ._disk import write_whole

# Spectral irradiance of the sun divided by illuminance, W/(m2 nm) for 100 klx, by wavelength in nm; the nearest value holds outside.
# Second-hand: read off the reference spectrum ASTM G173-03 (global, 37 degrees), which has some 109 klx.
DAYLIGHT = ((532, 1.40), (650, 1.40), (785, 1.05), (850, 0.83), (905, 0.70), (1064, 0.59), (1550, 0.25))
APERTURE = 1e-4  # start value of fits, m2
BANDWIDTH = 100.0  # widest filter of a fit, nm: assumed; filters of lidars are 1 to some tens of nm wide
LIMIT = (f"filter_bandwidth ends at the bound of the fit, {BANDWIDTH:g} nm: the sheet's ranges in the light "
         "and in the dark differ by more than the daylight that the filter of a lidar lets through")
HALF = 0.5  # probability of a point without a given probability: assumed
UNITS = {"range": " m", "probability": "", "reflectance": "", "light": " klx", "board": " m"}
MOST = {"range": 1e6, "probability": 0.9999, "reflectance": 1.0, "light": 1000.0, "board": 1e4}


@dataclasses.dataclass
class Fit:
    """A receiver fitted to a data sheet.

    numbers    receiver_aperture (m2; with the assumed energy of the pulse) and, if the points differ in light,
               filter_bandwidth (nm; with a view as wide as the beam)
    board      fitted width of boards without a given width, m; nan if no point determines it: such boards fill the beam
    predicted  fitted range of each point, m
    residuals  fitted range over the data sheet's range, less 1
    left_out   residual of each point in a fit without the point; nan if the other points do not determine all fitted numbers
    bar        expected relative error of ranges by this receiver: the largest of |residuals| and |left_out|; nan if no point
               could be left out
    limit      empty, or a sentence: the bandwidth ended at its bound
    """
    numbers: Dict[str, float]
    board: float
    predicted: List[float]
    residuals: List[float]
    left_out: List[float]
    bar: float
    limit: str = ""


def check(points: Sequence[Dict[str, Any]]) -> None:
    """Raises ValueError that names what is wrong with a data sheet's points."""
    if isinstance(points, (str, dict)) or not points:
        raise ValueError("the sheet has no points, expected at least one of range, reflectance, source")
    for i, point in enumerate(points):
        at = f"sheet.points[{i}]"
        if not isinstance(point, dict):
            raise ValueError(f"{at} is {point!r}, expected range, reflectance, source by name")
        for key in ("range", "reflectance", "source"):
            if key not in point:
                raise ValueError(f"{at}: {key} is missing")
        for key, value in point.items():
            least, most = 0.0 if key == "light" else 1e-4, MOST.get(key, 0.0)
            if key == "source":
                if not isinstance(value, str):
                    raise ValueError(f"{at}.source is {value!r}, expected a text")
            elif key not in MOST:
                raise ValueError(f"{at}: {key} is not known, expected {', '.join((*MOST, 'source'))}")
            elif isinstance(value, bool) or not isinstance(value, numbers.Real) or not least <= float(value) <= most:
                raise ValueError(f"{at}.{key} is {value!r}, expected {least:g} to {most:g}{UNITS[key]}")


def irradiance(light: float, wavelength: float) -> float:
    """Spectral irradiance, W/(m2 nm), of daylight of `light` klx at a wavelength, nm."""
    return 0.01 * light * float(np.interp(wavelength, [row[0] for row in DAYLIGHT], [row[1] for row in DAYLIGHT]))


def solid_angle_of(sensor) -> float:
    """Solid angle of a sensor's beams, sr."""
    half, across = float(sensor.half_beamwidth), float(sensor.half_beamwidth_across)
    one, two = np.tan(half), np.tan(across or half)
    if int(sensor.algorithm.GetBeamOutline()) == 1:
        return 4 * np.arctan(one * two / np.sqrt(1 + one**2 + two**2))
    return np.pi * one * two * (1 - 0.375 * (one**2 + two**2)) if across else 4 * np.pi * np.sin(0.5 * half) ** 2


def share_on_board(sensor, tangent):
    """Share of a beam's energy that falls on a square board, upright and centred. @param tangent tangent of the angle at which a board's
    side appears, one or many. A round beam, whose border may cut the board's corners, counts as if the board were a disc of
    the same area."""
    tangent = np.asarray(tangent, dtype=float)
    half, across = float(sensor.half_beamwidth), float(sensor.half_beamwidth_across)
    if sensor.beam_rotation % 180 == 90:
        half, across = across or half, half
    fall = 2 * float(sensor.gaussian_truncation) ** 2 if int(sensor.algorithm.GetBeamProfile()) == 1 else 0.0
    rectangle = int(sensor.algorithm.GetBeamOutline()) == 1
    if not rectangle and not across:
        filled = np.minimum(1.0, tangent**2 / solid_angle_of(sensor))
        return np.expm1(-fall * filled) / np.expm1(-fall) if fall else filled
    if sensor.beam_rotation % 90:
        raise ValueError(f"beam_rotation is {sensor.beam_rotation!r}, expected a multiple of 90 deg to fit upright boards")
    from scipy.special import erf
    nodes, weights = np.polynomial.legendre.leggauss(64)

    def within(u, v):  # share of the plane within u and v, in half-widths
        x = nodes * u[..., None]
        height = np.minimum(1.0 if rectangle else np.sqrt(1 - x * x), v[..., None])
        root = np.sqrt(fall)
        light = np.exp(-fall * x * x) * erf(root * height) / root if fall else height
        return u * (weights * light).sum(axis=-1)

    ones = np.ones_like(tangent)
    return within(*(np.minimum(1.0, 0.5 * tangent / np.tan(width)) for width in (half, across or half))) / within(ones, ones)


class Receiver:
    """The numbers of a sensor that the fit needs (formulas: Documentation/reference/sensor-files.md)."""

    def __init__(self, sensor):
        from scipy.special import erfcinv
        self.solid_angle = solid_angle_of(sensor)
        self.wavelength = float(sensor.wavelength)
        self.tangents = np.geomspace(1e-8, 10, 4000)  # tangents of the angles of boards
        self.shares = share_on_board(sensor, self.tangents)
        self.interval = float(sensor.sampling_interval)
        photon = 6.62607015e-34 * 299792458.0 / (1e-9 * self.wavelength)
        self.per_joule = float(sensor.receiver_efficiency) / photon
        self.pulse_energy = float(sensor.pulse_energy)
        self.dark = float(sensor.amplifier_noise) ** 2
        self.background = self.per_joule * self.solid_angle * self.interval
        self.excess = float(sensor.excess_noise_factor)
        self.sky = 0.01 * float(sensor.background_radiance)  # radiance of the sky in 1 klx
        self.attenuation = float(sensor.algorithm.GetClearAirAttenuation())
        self.overlap, self.defocus = float(sensor.overlap_range), float(sensor.defocus_range)
        unit = 0.5 * 299792458.0 * self.interval
        in_gate = np.floor(float(sensor.range_gate) / unit) - np.floor(float(sensor.minimum_range) / unit)
        units = sensor.beams.number_of_points * in_gate
        self.factor = float(np.sqrt(2) * erfcinv(2 * float(sensor.false_alarms_per_scan) / units))

    def excess_of(self, distance, point: Dict[str, Any], aperture: float, bandwidth: float, board: float):
        """Signal of a board minus the threshold, in standard deviations of the noise. @param distance m, one or many"""
        distance = np.asarray(distance, dtype=float)
        rho, light, board = point["reflectance"], point.get("light", 0.0), point.get("board", board)
        filled = np.interp(board / distance, self.tangents, self.shares) if np.isfinite(board) else np.ones_like(distance)
        near = (1 - np.exp(-(distance / self.overlap) ** 2) if self.overlap else 1.0) / (1 + (self.defocus / distance) ** 2)
        near = near * np.exp(-2 * self.attenuation * distance)
        signal = self.per_joule * self.pulse_energy * filled * near * np.minimum(1.0, rho * aperture / (np.pi * distance**2))
        sky = self.sky * light
        board_radiance = rho * (sky + irradiance(light, self.wavelength) / np.pi)
        before_sky, dark = (self.dark + self.excess * self.background * bandwidth * aperture * radiance
                            for radiance in (sky, filled * board_radiance + (1 - filled) * sky))
        threshold = self.factor * np.sqrt(np.maximum(before_sky, dark))  # at least the threshold of the sky
        return (signal - threshold) / np.sqrt(dark + self.excess * signal)

    def range(self, point: Dict[str, Any], *numbers: float) -> float:
        """The largest range, m, at which a point's board is detected with the point's probability."""
        from scipy.special import erfcinv
        wanted = -np.sqrt(2) * erfcinv(2 * point.get("probability", HALF))
        x = np.linspace(np.log(point["range"]) - 5, np.log(point["range"]) + 5, 1001)
        over = self.excess_of(np.exp(x), point, *numbers) - wanted
        seen = np.flatnonzero(over > 0)
        if not len(seen) or seen[-1] == len(x) - 1:
            return float(np.exp(x[0] if not len(seen) else x[-1]))
        k = seen[-1]
        return float(np.exp(x[k] + (x[k + 1] - x[k]) * over[k] / (over[k] - over[k + 1])))


def _told(points, spare: int = 1) -> List[str]:
    """Names of the numbers that these points determine, by their need of points. @param spare surplus points for fitting boards"""
    found = ["aperture"]
    if len({point.get("light", 0.0) for point in points}) > 1 and len(points) > 1:
        found.append("bandwidth")
    unknown = [point for point in points if "board" not in point]
    if len({point["reflectance"] for point in unknown}) > 1 and len(points) > len(found) + spare:
        found.append("board")
    return found


def _fitted(receiver: Receiver, points, start: Tuple[float, float], frees: List[str]) -> Tuple[float, float, float]:
    """Aperture (m2), bandwidth (nm), board (m). @param start first two numbers before the fit @param frees names of fitted numbers"""
    from scipy.optimize import least_squares
    farthest = max(point["range"] for point in points)
    size = farthest * np.sqrt(receiver.solid_angle)  # width of a board that just fills the beam at the farthest range
    best: Tuple[float, Tuple[float, float, float]] = (np.inf, (start[0], start[1], np.nan))
    widths = (0.3 * size, 0.6 * size, 1.2 * size) if "board" in frees else (np.nan,)
    # Starts do not depend on the fitted numbers, so a fit of a fitted sensor gives the same numbers.
    most = {"bandwidth": np.log(BANDWIDTH)}
    for width, bandwidth in itertools.product(widths, (1.0, 10.0, 0.9 * BANDWIDTH) if "bandwidth" in frees else (start[1],)):
        value = {"aperture": APERTURE, "bandwidth": bandwidth, "board": width}

        def off(x, names):
            at = {**value, **dict(zip(names, np.exp(x)))}
            return [np.log(receiver.range(point, *at.values()) / point["range"]) for point in points]

        for names in (frees[:1], frees):  # the aperture first, so that the other numbers start from a good aperture
            found = least_squares(off, [np.log(value[name]) for name in names], args=(names,), diff_step=1e-4,
                                  bounds=(-np.inf, [most.get(name, np.inf) for name in names]))
            value = {**value, **dict(zip(names, np.exp(found.x)))}
        if found.cost < best[0]:
            best = found.cost, (float(value["aperture"]), float(value["bandwidth"]), float(value["board"]))
    return best[1]


def fit(sensor, points: Optional[Sequence[Dict[str, Any]]] = None) -> Fit:
    """Fits a sensor's receiver to points of a data sheet; the sensor is not changed. See `Sensor.fit`."""
    points = sensor.description.get("sheet", {}).get("points", []) if points is None else list(points)
    check(points)
    if sensor.receiver_aperture <= 0:
        raise ValueError("receiver_aperture is 0, expected more than 0 m2: without an aperture no signal decreases with the range")
    for i, point in enumerate(points):
        if point["range"] > sensor.range_gate:
            raise ValueError(f"sheet.points[{i}].range is {point['range']!r}, expected at most range_gate, {sensor.range_gate:g} m")
    receiver = Receiver(sensor)
    start = float(sensor.receiver_aperture), max(float(sensor.filter_bandwidth), 1e-3)
    frees = _told(points)
    numbers = _fitted(receiver, points, start, frees)
    at_bound = "bandwidth" in frees and numbers[1] > 0.99 * BANDWIDTH
    numbers = (numbers[0], BANDWIDTH if at_bound else numbers[1], numbers[2])
    predicted = [receiver.range(point, *numbers) for point in points]
    left_out = []
    for i, point in enumerate(points):
        others = points[:i] + points[i + 1:]
        left_out.append(receiver.range(point, *_fitted(receiver, others, start, frees)) / point["range"] - 1
                        if others and frees in (["aperture"], _told(others, 0)) else float("nan"))
    residuals = [value / point["range"] - 1 for value, point in zip(predicted, points)]
    bar = float(np.nanmax(np.abs([*residuals, *left_out]))) if np.isfinite(left_out).any() else float("nan")
    lights = len({point.get("light", 0.0) for point in points}) > 1
    return Fit({"receiver_aperture": numbers[0], **({"filter_bandwidth": numbers[1]} if lights else {})}, numbers[2], predicted,
               residuals, left_out, bar, LIMIT if at_bound else "")


def write(description: Dict[str, Any], found: Fit, file) -> None:
    """Writes the sensor file with the fitted numbers, the residuals and the bar. The old file is kept until the new file is complete."""
    number = len(description["sheet"]["points"])
    for name, value in found.numbers.items():
        unit = {"receiver_aperture": "m2", "filter_bandwidth": "nm"}[name]
        source = f"assumed: {found.limit}" if name == "filter_bandwidth" and found.limit else \
            f"assumed with the others: fitted to the {number} points of the sheet"
        description["values"][name] = {"value": float(f"{value:.6g}"), "unit": unit, "source": source}
    description["values"]["receiver_model"] = {"value": 1, "unit": "1", "source": "assumed: photons, by the fit"}
    description["sheet"]["residuals"] = [float(f"{value:.3g}") for value in found.residuals]
    for key, value in (("bar", found.bar), ("board", found.board)):
        description["sheet"].pop(key, None)
        if np.isfinite(value):
            description["sheet"][key] = float(f"{value:.3g}")
    write_whole(file, (_text(description) + "\n").encode())


def _text(value, indent: int = 0) -> str:
    """JSON with one line for each mapping of plain values."""
    is_map = isinstance(value, dict)
    parts = [*value.values()] if is_map else value if isinstance(value, list) else []
    deep = any(isinstance(one, dict) or (isinstance(one, list) and one and isinstance(one[0], dict)) for one in parts)
    if not deep and (indent or not is_map):
        return json.dumps(value, ensure_ascii=False)
    names, pad = [f"{json.dumps(key)}: " for key in value] if is_map else [""] * len(parts), "\n" + "  " * indent
    rows = ",".join(f"{pad}  {name}{_text(one, indent + 1)}" for name, one in zip(names, parts))
    return f"{{{rows}{pad}}}" if is_map else f"[{rows}{pad}]"
