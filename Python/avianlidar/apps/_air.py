# SPDX-License-Identifier: BSD-3-Clause
"""Air for coverage, with its share of the hours of a year."""
from __future__ import annotations

import functools
import warnings
from typing import Any, Dict, NamedTuple, Tuple

from .._cloud import field_values
from .._coverage import Coverage
from .._scene import Scene
from .._sensor import Sensor
from .._weather import in_words


class Air(NamedTuple):
    """A weather, and its share of the hours."""

    words: Tuple[str, ...]
    share: float
    settings: Dict[str, Any]  # of coverage

    @property
    def name(self) -> str:
        """For a reader."""
        return in_words(self.words) or "the plan's air"


def extinction(sensor: Sensor, **air: Any) -> float:
    """Of the air at the sensor's wavelength, 1/m. @param air settings of coverage"""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that there are no surfaces
        cover = Coverage(Scene(), sensor, places=[(0.0, 0.0, 0.0)], species="", all_species=False, effective_area=0.03,
                         number_of_threads=1, **air)
        return float(field_values(cover.data)["attenuation_coefficient"])


@functools.lru_cache(maxsize=None)
def extinction_of_rain(rate: float, half_beamwidth: float = 5.6e-3, wavelength: float = 905.0, half_beamwidth_across: float = 0.0) -> float:
    """1/m, for a view that keeps most of the light which drops diffract, as eyes do that look for a dark object of half a degree. @param rate
    mm/h @param half_beamwidth rad @param wavelength nm @param half_beamwidth_across rad; 0: a round beam"""
    seen = Sensor("Search905", half_beamwidth=half_beamwidth, half_beamwidth_across=half_beamwidth_across, wavelength=wavelength)
    return extinction(seen, visibility=0.0, attenuation_coefficient=0.0, rain_rate=rate)


def gathers_light(sensor: Sensor) -> bool:
    """Whether the receiver has an aperture, into which air may send light back."""
    return float(sensor.beams.fields.get("receiver_aperture", 0.0)) > 0.0


def as_received(sensor: Sensor, air: Dict[str, Any]) -> Dict[str, Any]:
    """Air as a sensor knows it: without an aperture that of the same extinction which sends no light back. @param air settings of coverage"""
    if gathers_light(sensor):
        return air
    dry = {**air, "air_backscatter": False, "rain_rate": 0.0}
    if not air["rain_rate"]:
        return dry
    of_rain = extinction_of_rain(air["rain_rate"], sensor.half_beamwidth, sensor.wavelength, sensor.half_beamwidth_across)
    return {**dry, "visibility": 0.0, "attenuation_coefficient": extinction(sensor, **dry) + of_rain}
