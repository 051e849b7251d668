# SPDX-License-Identifier: BSD-3-Clause
"""Weather in words, as `--weather`, plans and scenarios give it: `fog:800` (visibility, m), `rain:10` (mm/h)."""
import math
from collections.abc import Iterable, Mapping
from typing import Any

from ._properties import snake

WEATHER = "fog:V or haze:V (visibility, m), rain:R (mm/h); several may be combined; the air then sends light back"
FAR = 10_000.0  # visibility, m, that reports of airports do not distinguish from larger ones
AIR = ("visibility", "air_backscatter", "rain_rate")  # properties that the words set


def weather(words: Iterable[str] | None) -> dict[str, Any]:
    """Settings of a scan or a coverage for words of `--weather`.

    >>> weather(["fog:800", "rain:10"])
    {'visibility': 800.0, 'air_backscatter': True, 'rain_rate': 10.0}
    """
    found: dict[str, Any] = {}
    known: dict[str, str] = {}
    for word in words or ():
        kind, colon, number = word.partition(":")
        try:
            value = float(number)
        except ValueError:
            value = math.nan
        if kind not in ("fog", "haze", "rain") or not 0 < value < math.inf:
            raise ValueError(f"weather {word!r}, expected {WEATHER.partition(';')[0]}")
        name = "rain rate" if kind == "rain" else "visibility"
        if name in known:
            raise ValueError(f"weather {word!r} after {known[name]!r}, expected one {name}")
        known[name] = word
        found.update({"rain_rate": value} if kind == "rain" else {"visibility": value, "air_backscatter": True})
    return found


def in_weather(settings: Mapping[str, Any], words: Iterable[str] | None) -> dict[str, Any]:
    """Settings together with those of weather words; other settings given by name are kept. ValueError if settings and
    words both give the visibility or the rain rate."""
    air = weather(words)
    for name in ("visibility", "rain_rate"):
        if name in air and name in settings:
            raise ValueError(f"is given beside {name} {settings[name]}, expected only one of them")
    return {**air, **settings}


def without_air(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings without the properties that words of weather set."""
    return {name: value for name, value in settings.items() if snake(name) not in AIR}


def in_words(words: Iterable[str]) -> str:
    """Words of weather as a reader sees them.

    >>> in_words(["fog:800", "rain:10"])
    'fog of 800 m, rain of 10 mm/h'
    """
    said = []
    for word in words:
        kind, value = word.partition(":")[0], float(word.partition(":")[2])
        name = "visibility" if kind == "haze" and value >= FAR else kind
        said.append(f"{name} of {value:.10g} mm/h" if kind == "rain" else f"{name} of {value:,.10g} m")
    return ", ".join(said)
