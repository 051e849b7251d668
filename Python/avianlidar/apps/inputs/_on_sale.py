# SPDX-License-Identifier: BSD-3-Clause
"""Lidars that somebody sells, and lidars that are ideas. The key `maker` of a sensor's file decides."""
from __future__ import annotations

import functools
import math
from typing import Iterable, Tuple

from ..._properties import snake
from ..._sensor import Sensor
from ..pages._words import listed, plural
from ._json import packaged

PLACE = ("position", "orientation")  # settings that say how a lidar stands
# Settings that the owner of a lidar chooses; other changes make a lidar that nobody sells.
CHOSEN = ("preset", "name", *PLACE, "rotation_rate", "azimuth_step", "azimuth_range", "number_of_revolutions",
          "background_radiance", "seed")


@functools.lru_cache(maxsize=None)
def on_sale() -> Tuple[str, ...]:
    """The presets of lidars that somebody sells."""
    return tuple(name for name in Sensor.presets() if Sensor(name).on_sale)


def idea(name: str, sensor: Sensor, given: Iterable[str] = ()) -> str:
    """A sentence if nobody sells a lidar, else empty. @param name of the lidar @param given names of properties that
    are set, `range_gate` or `RangeGate`"""
    changed = [one for one in map(snake, given) if one not in CHOSEN]
    if not sensor.on_sale:
        ours = name in Sensor.presets()
        return f"{name} is an idea: {'nobody sells this lidar' if ours else 'its sensor file names no maker'}."
    differs = "differs from that" if len(changed) == 1 else "differ from those"
    return f"{name} is an idea: its {listed(changed)} {differs} of the lidar on sale." if changed else ""


def half_range(name: str, species: str) -> float:
    """The range to which one scan of a preset detects half of the birds in its beams in clear air, m; nan for a species
    without a range. Testing/Studies/coverage/ranges.py computes these ranges."""
    table = packaged("inputs/ranges.json")
    half = table["shares"].index(0.5)
    return float(table["ranges"].get(name, {}).get(species, {half: math.nan})[half])


def farthest(species: str) -> str:
    """A sentence on the greatest of the lidars' ranges in clear air; empty for a species without a range."""
    ranges = {name: half_range(name, species) for name in on_sale()}
    best = max(ranges, key=lambda name: ranges[name])
    return "" if math.isnan(ranges[best]) else (
        f"In clear air, one scan of a lidar on sale detects half of the {plural(species)} in its beams to at "
        f"most {float(f'{ranges[best]:.2g}'):g} m ({best}).")
