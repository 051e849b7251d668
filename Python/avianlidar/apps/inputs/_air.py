# SPDX-License-Identifier: BSD-3-Clause
"""Air for coverage, with the share of the hours of a year in which the air occurs."""
from __future__ import annotations

import functools
import warnings
from typing import Any, Dict, NamedTuple, Tuple

from ..._cloud import field_values
from ..._coverage import Coverage
from ..._scene import Scene
from ..._sensor import Sensor
from ..._weather import in_words


class Air(NamedTuple):
    """A weather, and the share of the hours in which the weather occurs."""

    words: Tuple[str, ...]
    share: float
    settings: Dict[str, Any]  # properties of coverage

    @property
    def name(self) -> str:
        """The name for a reader."""
        return in_words(self.words) or "the plan's air"


def extinction(sensor: Sensor, **air: Any) -> float:
    """Extinction coefficient of the air at the sensor's wavelength, 1/m. @param air properties of coverage"""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about missing surfaces
        cover = Coverage(Scene(), sensor, places=[(0.0, 0.0, 0.0)], species="", all_species=False, effective_area=0.03,
                         number_of_threads=1, **air)
        return float(field_values(cover.data)["attenuation_coefficient"])


@functools.lru_cache(maxsize=None)
def extinction_of_rain(rate: float, half_beamwidth: float = 5.6e-3, wavelength: float = 905.0,
                       half_beamwidth_across: float = 0.0) -> float:
    """Extinction coefficient of rain, 1/m, for a view that receives most of the light that drops diffract. The default
    view is an eye that looks for a dark object of half a degree. @param rate mm/h @param half_beamwidth rad @param
    wavelength nm @param half_beamwidth_across rad; 0: a round beam"""
    seen = Sensor("Search905", half_beamwidth=half_beamwidth, half_beamwidth_across=half_beamwidth_across,
                  wavelength=wavelength)
    return extinction(seen, visibility=0.0, attenuation_coefficient=0.0, rain_rate=rate)


def gathers_light(sensor: Sensor) -> bool:
    """Whether the receiver has an aperture, so that light from the air can be received."""
    return float(sensor.beams.fields.get("receiver_aperture", 0.0)) > 0.0


def scatters(scan: Any) -> bool:
    """Whether the air of a scan sends light back."""
    return scan.rain_rate > 0.0 or (scan.air_backscatter and scan.visibility > 0.0)


def check_received(scan: Any, name: str, other: str) -> None:
    """ValueError if the air of a scan sends light back that the sensor cannot receive. @param name name of the sensor
    @param other how the user chooses another sensor"""
    if scatters(scan) and not gathers_light(scan.sensor):
        raise ValueError(f"weather: the air sends light back, and {name} has no receiver_aperture for this light: "
                         f"choose for example {other}")


def as_received(sensor: Sensor, air: Dict[str, Any]) -> Dict[str, Any]:
    """Air for a sensor. A sensor without an aperture receives no light from the air, so only the extinction is kept.
    @param air properties of coverage"""
    if gathers_light(sensor):
        return air
    dry = {**air, "air_backscatter": False, "rain_rate": 0.0}
    if not air["rain_rate"]:
        return dry
    of_rain = extinction_of_rain(air["rain_rate"], sensor.half_beamwidth, sensor.wavelength,
                                 sensor.half_beamwidth_across)
    return {**dry, "visibility": 0.0, "attenuation_coefficient": extinction(sensor, **dry) + of_rain}
