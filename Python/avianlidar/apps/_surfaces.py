# SPDX-License-Identifier: BSD-3-Clause
"""Obstacle limitation surfaces of runways, below which masts stay: strip, approach and transitional surfaces of ICAO Annex 14.

`surfaces.json` has the dimensions with their source, and says what is assumed. Inner horizontal and conical surfaces, 45 m and more above
the aerodrome, and take-off climb surfaces are not modelled.
"""
from __future__ import annotations

import dataclasses
import functools
import pathlib
from typing import Any, Dict, List, Mapping, Optional, Sequence

import numpy as np

from ._json import load_json
from .siting import Runway, ground_of, runway_outline

NAMES = ("strip", "approach", "transitional")
STEP = 100.0  # m, along a runway between places where its height is taken from the scene


@functools.lru_cache(maxsize=None)
def table() -> Dict[str, Any]:
    """All dimensions, their source, and what is assumed (`surfaces.json`)."""
    return load_json(pathlib.Path(__file__).with_name("surfaces.json"))


def code_of(length: float) -> int:
    """The code number, 1 to 4, that goes with a runway's length, m."""
    return 1 + int(np.searchsorted(table()["codes"]["lengths"], length, side="right"))


@dataclasses.dataclass(frozen=True)
class Surfaces:
    """The surfaces of a runway.

    code      number, 1 to 4              category  of the approach: non-instrument, non-precision, precision
    numbers   dimensions of each surface that is kept, as in `surfaces.json`
    profile   distances from the runway's start, m, and the heights (z, m) of its middle there
    """

    runway: Runway
    code: int
    category: str
    numbers: Dict[str, Dict[str, Any]]
    profile: np.ndarray

    @classmethod
    def of(cls, runway: Runway, scene=None, changes: Optional[Mapping[str, Any]] = None) -> Surfaces:
        """The surfaces by the table. @param scene its lowest surface is the ground, which is at z = 0 where it has none
        @param changes code, category, and of surfaces False, which leaves one out, or other dimensions"""
        changes = changes or {}
        length = runway.axis()[1]
        code, category = changes.get("code", code_of(length)), changes.get("category", table()["category"]["default"])
        numbers = {name: {**table()[category][str(code)][name], "kept": changes.get(name) is not False,
                          **(changes[name] if isinstance(changes.get(name), dict) else {})} for name in NAMES}
        along = np.linspace(0.0, length, int(length / STEP) + 2)
        places = np.asarray(runway.start) + along[:, None] * runway.axis()[0]
        ground = np.zeros(len(along)) if scene is None else np.nan_to_num(ground_of(scene, places))
        return cls(runway, code, category, numbers, np.array([along, ground]))

    @property
    def kept(self) -> List[str]:
        """Names of the surfaces that count."""
        return [name for name in NAMES if self.numbers[name]["kept"]]

    @property
    def strip(self) -> np.ndarray:
        """The outline of the strip, 4 x 2, m."""
        return runway_outline(self.runway, self.numbers["strip"]["beyond"], self.numbers["strip"]["half_width"])

    def limits(self, points) -> Dict[str, np.ndarray]:
        """The height (z, m) of each surface that is kept above or below each point: infinite where there is none, minus infinity in the
        strip, where nothing may stand. @param points n x 2 or n x 3, m"""
        axis, length = self.runway.axis()
        off = np.asarray(points, dtype=float)[:, :2] - self.runway.start
        along, aside = off @ axis, np.abs(off @ np.array([axis[1], -axis[0]]))
        beyond = np.maximum(-along, along - length)  # the nearer end; below 0 beside the runway
        ground = np.interp(along, *self.profile)
        strip, approach, transitional = (self.numbers[name] for name in NAMES)
        lengths, slopes = np.transpose(approach["sections"])
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        away = beyond - approach["from"]
        before = (away >= 0.0) & (away <= ends[-1])
        rise = np.interp(away, ends, np.concatenate([[0.0], np.cumsum(lengths * slopes)]))
        half_width = np.where(before, approach["half_width"] + approach["divergence"] * away, strip["half_width"])
        in_strip = (beyond <= strip["beyond"]) & (aside <= strip["half_width"])
        up = rise + transitional["slope"] * (aside - half_width)
        beside = (before | (beyond <= strip["beyond"])) & (aside > half_width) & (up <= transitional["height"])
        found = {"strip": np.where(in_strip, -np.inf, np.inf), "approach": np.where(before & (aside <= half_width), ground + rise, np.inf),
                 "transitional": np.where(beside, ground + up, np.inf)}
        return {name: found[name] for name in self.kept}


def pierced(surfaces: Sequence[Surfaces], tops) -> np.ndarray:
    """Which surface each top pierces first: 0 for none, else 1 more than its number in NAMES. @param tops of masts, n x 3, m"""
    tops = np.asarray(tops, dtype=float)
    found = np.zeros(len(tops), dtype=int)
    for number, name in enumerate(NAMES, 1):
        for one in surfaces:
            if name in one.kept:
                found[(found == 0) & (tops[:, 2] > one.limits(tops)[name])] = number
    return found
