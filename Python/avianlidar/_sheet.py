# SPDX-License-Identifier: BSD-3-Clause
"""Fit of a receiver to all points of the maker's data sheet.

A data sheet gives the range at which a board of a reflectance is detected with some probability in some light. One
fitted number cannot reproduce all points: with 1/r^2 a board of 80 % is detected 2.83 times as far as a board of 10 %;
data sheets give ratios of 1.7 to 2.5. The model: a board of width w at the range R fills f = min(1, w^2/(Omega R^2)) of
a round beam, and (1 - exp(-2 k^2 f))/(1 - exp(-2 k^2)) of a Gaussian beam with the truncation k. Signal, noise and
threshold are those of Documentation/method/receiver.md in clear air (a visibility of 23 km). Daylight comes from the
board, and from the sky beside the board, which is the sensor's `background_radiance` in 100 klx and less in less light.
Up to three numbers are fitted, as far as the points determine them:
- the aperture, which sets how much light is received;
- the filter's bandwidth (at most BANDWIDTH), which sets the received daylight, also of a view wider than the beam;
- the width of boards without a given width, which belongs to the test and not to the receiver.
The fit is SciPy's least squares over logarithms of ranges.
"""
import copy
import dataclasses
import itertools
import json
import math
import numbers
from collections.abc import Sequence
from typing import Any

import numpy as np

from ._disk import write_whole
from ._numbers import figures

# Spectral irradiance of the sun for 100 klx, W/(m2 nm), by wavelength in nm; the nearest value holds outside.
# Second-hand: read off the reference spectrum ASTM G173-03 (global, 37 degrees), which has some 109 klx.
DAYLIGHT = np.array([(532, 1.40), (650, 1.40), (785, 1.05), (850, 0.83), (905, 0.70), (1064, 0.59), (1550, 0.25)])
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
    left_out   residual of each point in a fit without the point; nan if the other points do not determine all fitted
               numbers
    bar        expected relative error of ranges by this receiver: the largest of |residuals| and |left_out|; nan if no
               point could be left out
    limit      empty, or a sentence: the bandwidth ended at its bound
    """
    numbers: dict[str, float]
    board: float
    predicted: list[float]
    residuals: list[float]
    left_out: list[float]
    bar: float
    limit: str = ""


def check(points: Sequence[dict[str, Any]]) -> None:
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
            least = 0.0 if key == "light" else 1e-4
            most = MOST.get(key, 0.0)
            if key == "source":
                if not isinstance(value, str):
                    raise ValueError(f"{at}.source is {value!r}, expected a text")
            elif key not in MOST:
                raise ValueError(f"{at}: {key} is not known, expected {', '.join((*MOST, 'source'))}")
            elif isinstance(value, bool) or not isinstance(value, numbers.Real) or not least <= float(value) <= most:
                raise ValueError(f"{at}.{key} is {value!r}, expected {least:g} to {most:g}{UNITS[key]}")


def irradiance(light: float, wavelength: float) -> float:
    """Spectral irradiance, W/(m2 nm), of daylight of `light` klx at a wavelength, nm."""
    return 0.01 * light * float(np.interp(wavelength, *DAYLIGHT.T))


def solid_angle_of(sensor) -> float:
    """Solid angle of a sensor's beams, sr."""
    half, across = sensor.half_beamwidth, sensor.half_beamwidth_across
    one, two = np.tan(half), np.tan(across or half)
    if sensor.beam_outline == "Rectangle":
        return 4 * np.arctan(one * two / np.sqrt(1 + one**2 + two**2))
    return np.pi * one * two * (1 - 0.375 * (one**2 + two**2)) if across else 4 * np.pi * np.sin(0.5 * half) ** 2


def share_on_board(sensor, tangent):
    """Share of a beam's energy that falls on a square board, upright and centred. @param tangent tangent of the angle
    at which a board's side appears, one or many. A round beam, whose border may cut the board's corners, counts as if
    the board were a disc of the same area."""
    half, across = sensor.half_beamwidth, sensor.half_beamwidth_across
    if sensor.beam_rotation % 180 == 90:
        half, across = across or half, half
    fall = 2 * sensor.gaussian_truncation**2 if sensor.beam_profile == "Gaussian" else 0.0
    rectangle = sensor.beam_outline == "Rectangle"
    if not rectangle and not across:
        filled = np.minimum(1.0, tangent**2 / solid_angle_of(sensor))
        return np.expm1(-fall * filled) / np.expm1(-fall) if fall else filled
    if sensor.beam_rotation % 90:
        raise ValueError(f"beam_rotation is {sensor.beam_rotation!r}, expected a multiple of 90 deg to fit upright "
                         "boards")
    from scipy.special import erf
    nodes, weights = np.polynomial.legendre.leggauss(64)

    def within(u, v):  # share of the plane within u and v, in half-widths
        x, root = nodes * u[..., None], np.sqrt(fall)
        height = np.minimum(1.0 if rectangle else np.sqrt(1 - x * x), v[..., None])
        light = np.exp(-fall * x * x) * erf(root * height) / root if fall else height
        return u * (weights * light).sum(axis=-1)

    u, v = (np.minimum(1.0, 0.5 * tangent / np.tan(width)) for width in (half, across or half))
    return within(u, v) / within(np.ones(1), np.ones(1))


class Receiver:
    """The numbers of a sensor that the fit needs (formulas: Documentation/method/receiver.md)."""

    def __init__(self, sensor):
        from scipy.special import erfcinv
        self.solid_angle, self.wavelength = solid_angle_of(sensor), sensor.wavelength
        self.tangents = np.geomspace(1e-8, 10, 4000)  # tangents of the angles of boards
        self.shares = share_on_board(sensor, self.tangents)
        photon = 6.62607015e-34 * 299792458.0 / (1e-9 * self.wavelength)  # J
        per_joule = sensor.receiver_efficiency / photon
        self.electrons = per_joule * sensor.pulse_energy  # if all light of a pulse were received
        self.background = per_joule * self.solid_angle * sensor.sampling_interval
        self.dark, self.excess = sensor.amplifier_noise**2, sensor.excess_noise_factor
        self.sky = 0.01 * sensor.background_radiance  # radiance of the sky in 1 klx
        self.attenuation = sensor.algorithm.GetClearAirAttenuation()
        self.overlap, self.defocus = sensor.overlap_range, sensor.defocus_range
        unit = 0.5 * 299792458.0 * sensor.sampling_interval
        in_gate = np.floor(sensor.range_gate / unit) - np.floor(sensor.minimum_range / unit)
        units = sensor.beams.number_of_points * in_gate
        self.factor = float(np.sqrt(2) * erfcinv(2 * sensor.false_alarms_per_scan / units))

    def excess_of(self, distance, point: dict[str, Any], aperture: float, bandwidth: float, board: float):
        """Signal of a board minus the threshold, in standard deviations of the noise. @param distance m, one or many"""
        rho, light, board = point["reflectance"], point.get("light", 0.0), point.get("board", board)
        filled = np.ones_like(distance)
        if np.isfinite(board):
            filled = np.interp(board / distance, self.tangents, self.shares)
        near = 1 - np.exp(-(distance / self.overlap) ** 2) if self.overlap else 1.0
        received = near / (1 + (self.defocus / distance) ** 2) * np.exp(-2 * self.attenuation * distance)
        signal = self.electrons * filled * received * np.minimum(1.0, rho * aperture / (np.pi * distance**2))
        sky = self.sky * light
        board_radiance = rho * (sky + irradiance(light, self.wavelength) / np.pi)
        before_sky, dark = (self.dark + self.excess * self.background * bandwidth * aperture * radiance
                            for radiance in (sky, filled * board_radiance + (1 - filled) * sky))
        threshold = self.factor * np.sqrt(np.maximum(before_sky, dark))  # at least the threshold of the sky
        return (signal - threshold) / np.sqrt(dark + self.excess * signal)

    def range(self, point: dict[str, Any], *numbers: float) -> float:
        """The largest range, m, at which a point's board is detected with the point's probability."""
        from scipy.special import erfcinv
        wanted = -np.sqrt(2) * erfcinv(2 * point.get("probability", HALF))
        x = np.linspace(np.log(point["range"]) - 5, np.log(point["range"]) + 5, 1001)
        over = self.excess_of(np.exp(x), point, *numbers) - wanted
        seen = np.flatnonzero(over > 0)
        if not len(seen) or seen[-1] == len(x) - 1:
            return float(np.exp(x[-1] if len(seen) else x[0]))
        k = seen[-1]
        return float(np.exp(x[k] + (x[k + 1] - x[k]) * over[k] / (over[k] - over[k + 1])))


def _told(points, spare: int = 1) -> list[str]:
    """Names of the numbers that these points determine. @param spare number of surplus points for fitting boards"""
    found = ["aperture"]
    if len({point.get("light", 0.0) for point in points}) > 1:
        found.append("bandwidth")
    unknown = [point for point in points if "board" not in point]
    if len({point["reflectance"] for point in unknown}) > 1 and len(points) > len(found) + spare:
        found.append("board")
    return found


def _fitted(receiver: Receiver, points, bandwidth: float, frees: list[str]) -> list[float]:
    """Aperture (m2), bandwidth (nm), board (m). @param bandwidth value if not fitted @param frees fitted numbers"""
    from scipy.optimize import least_squares
    farthest = max(point["range"] for point in points)
    size = farthest * np.sqrt(receiver.solid_angle)  # width of a board that just fills the beam at the farthest range
    # Starts do not depend on the fitted numbers, so a fit of a fitted sensor gives the same numbers.
    widths = (0.3 * size, 0.6 * size, 1.2 * size) if "board" in frees else (np.nan,)
    bandwidths = (1.0, 10.0, 0.9 * BANDWIDTH) if "bandwidth" in frees else (bandwidth,)
    most = {"bandwidth": np.log(BANDWIDTH)}
    fits = []
    for board, bandwidth in itertools.product(widths, bandwidths):
        value = {"aperture": APERTURE, "bandwidth": bandwidth, "board": board}

        def off(x, names):
            at = {**value, **dict(zip(names, np.exp(x)))}
            return [np.log(receiver.range(point, *at.values()) / point["range"]) for point in points]

        for names in (frees[:1], frees):  # the aperture first, so that the other numbers start from a good aperture
            found = least_squares(off, [np.log(value[name]) for name in names], args=(names,), diff_step=1e-4,
                                  bounds=(-np.inf, [most.get(name, np.inf) for name in names]))
            value = {**value, **dict(zip(names, np.exp(found.x)))}
        fits.append((found.cost, [float(number) for number in value.values()]))
    return min(fits, key=lambda one: one[0])[1]


def fit(sensor, points: Sequence[dict[str, Any]] | None = None) -> Fit:
    """Fits a sensor's receiver to points of a data sheet; the sensor is not changed. See `Sensor.fit`."""
    points = sensor.description.get("sheet", {}).get("points", []) if points is None else list(points)
    check(points)
    for i, point in enumerate(points):
        if point["range"] > sensor.range_gate:
            raise ValueError(f"sheet.points[{i}].range is {point['range']!r}, expected at most range_gate, "
                             f"{figures(sensor.range_gate)} m")
    if sensor.receiver_aperture <= 0:
        sensor = copy.deepcopy(sensor).set(receiver_aperture=APERTURE)
    receiver = Receiver(sensor)
    start, frees = max(sensor.filter_bandwidth, 1e-3), _told(points)
    aperture, bandwidth, board = _fitted(receiver, points, start, frees)
    numbers, limit = {"receiver_aperture": aperture}, ""
    if "bandwidth" in frees:
        if bandwidth > 0.99 * BANDWIDTH:
            bandwidth, limit = BANDWIDTH, LIMIT
        numbers["filter_bandwidth"] = bandwidth
    predicted = [receiver.range(point, aperture, bandwidth, board) for point in points]
    residuals = [value / point["range"] - 1 for value, point in zip(predicted, points)]
    left_out = []
    for i, point in enumerate(points):
        others, off = points[:i] + points[i + 1:], math.nan
        if others and frees in (["aperture"], _told(others, 0)):
            off = receiver.range(point, *_fitted(receiver, others, start, frees)) / point["range"] - 1
        left_out.append(off)
    bar = float(np.nanmax(np.abs([*residuals, *left_out]))) if np.isfinite(left_out).any() else math.nan
    return Fit(numbers, board, predicted, residuals, left_out, bar, limit)


def write(description: dict[str, Any], found: Fit, file) -> None:
    """Writes the sensor file with the fitted numbers, the residuals and the bar, as a whole."""
    values, sheet = description["values"], description["sheet"]
    source = f"assumed: fitted to the {len(sheet['points'])} points of the sheet"
    for name, value in found.numbers.items():
        unit = {"receiver_aperture": "m2", "filter_bandwidth": "nm"}[name]
        values[name] = {"value": float(f"{value:.6g}"), "unit": unit, "source": source}
    if found.limit:
        values["filter_bandwidth"]["source"] = f"assumed: {found.limit}"
    values["receiver_model"] = {"value": 1, "unit": "1", "source": "assumed: photons, by the fit"}
    sheet["residuals"] = [float(f"{value:.3g}") for value in found.residuals]
    for key, value in (("bar", found.bar), ("board", found.board)):
        sheet.pop(key, None)
        if np.isfinite(value):
            sheet[key] = float(f"{value:.3g}")
    write_whole(file, (_text(description) + "\n").encode())


def _text(value, indent: int = 0) -> str:
    """JSON with one line for each mapping of plain values."""
    is_map = isinstance(value, dict)
    if is_map:
        names, parts = [f"{json.dumps(key)}: " for key in value], [*value.values()]
    else:
        parts = value if isinstance(value, list) else []
        names = [""] * len(parts)
    deep = any(isinstance(one, dict) or (isinstance(one, list) and one and isinstance(one[0], dict)) for one in parts)
    if not deep and (indent or not is_map):
        return json.dumps(value, ensure_ascii=False)
    pad = "\n" + "  " * indent
    rows = ",".join(f"{pad}  {name}{_text(one, indent + 1)}" for name, one in zip(names, parts))
    return f"{{{rows}{pad}}}" if is_map else f"[{rows}{pad}]"
