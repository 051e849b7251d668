# SPDX-License-Identifier: BSD-3-Clause
"""Places where a lidar may stand: outside of outlines, on the ground, with masts below obstacle limitation surfaces of
runways.

The surfaces are the strip, approach and transitional surfaces of ICAO Annex 14. `surfaces.json` has the dimensions,
their source and assumptions. NOT_CHECKED names what is not modelled.
"""
from __future__ import annotations

import dataclasses
import warnings
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

from ..._cloud import rows_of
from ..._pipeline import callers_level, update
from ..inputs._json import packaged
from ._regions import Runway, runway_outline

MOST_CANDIDATES = 100_000
SAME_PLACE = 1e-3  # m: candidates with equal coordinates to this precision are one candidate
NAMES = ("strip", "approach", "transitional")
# Inner horizontal and conical surfaces lie 45 m and more above the aerodrome.
NOT_CHECKED = ("take-off climb surfaces", "inner horizontal surfaces", "conical surfaces",
               "areas that protect ILS and other radio aids")
TABLE: Dict[str, Any] = packaged("places/surfaces.json")  # dimensions of the surfaces, their source, assumptions
STEP = 100.0  # distance along a runway between places at which the runway's height is taken from the scene, m


def is_near(points, outline, margin: float = 0.0) -> np.ndarray:
    """Which points (n x 2, m) lie in an outline or within `margin` (m) of the outline: n of bool. @param outline a ring
    (m x 2, m), or several rings: the outer ring and holes"""
    from ._gdal import geometry
    points = np.asarray(points, dtype=float)[:, :2]
    rings = [np.asarray(ring) for ring in (outline if np.ndim(outline[0]) == 2 else [outline])]
    for ring in rings:
        if ring.ndim != 2 or ring.shape[1] != 2 or len(ring) < 3:
            raise ValueError(f"an outline has the shape {ring.shape}, expected n x 2 with n at least 3")
    shape, reach = geometry("Polygon", [[*ring, ring[0]] for ring in rings]), max(margin, 0.0)
    west, east, south, north = shape.GetEnvelope()
    near = ((points >= (west - reach, south - reach)) & (points <= (east + reach, north + reach))).all(axis=1)
    away = np.array([shape.Distance(geometry("Point", place)) for place in points[near]])
    near[near] = (away < reach) | (away == 0.0)
    return near


def lattice(bounds: Sequence[float], spacing: float) -> np.ndarray:
    """Points n x 2 (m), x fastest. @param bounds least and greatest x, least and greatest y, m, inclusive"""
    if not spacing > 0.0 or bounds[1] < bounds[0] or bounds[3] < bounds[2]:
        raise ValueError(f"spacing {spacing} and bounds {tuple(bounds)} make no lattice")
    counts = [np.floor((high - low) / spacing + 1e-9) + 1.0 for low, high in (bounds[:2], bounds[2:])]
    _check_count(counts[0] * counts[1], f"spacing {spacing} and bounds {tuple(bounds)} make",
                 "take a larger spacing or smaller bounds")
    x, y = (np.arange(low, high + 1e-9 * spacing, spacing) for low, high in (bounds[:2], bounds[2:]))
    return np.column_stack([np.tile(x, len(y)), np.repeat(y, len(x))])


def _check_count(count: float, what: str, instead: str) -> None:
    if not count < MOST_CANDIDATES + 1.0:
        number = f"{count:,.0f}" if count < 1e15 else f"{count:.2g}"
        raise ValueError(f"{what} {number} candidates, expected at most {MOST_CANDIDATES:,}: {instead}")


def _along_verticals(scene, points) -> List[np.ndarray]:
    """z of all surfaces above and below each point (n x 2, m), ascending."""
    update(scene.tree)
    surfaces = scene.tree.GetOutput()
    low, high = surfaces.GetBounds()[4:]
    locator: Any = vtkStaticCellLocator()
    if vtkVersion().GetVTKMinorVersion() < 2:  # the locator of VTK 9.1 finds one surface alone
        from vtkmodules.vtkFiltersFlowPaths import vtkModifiedBSPTree
        locator = vtkModifiedBSPTree()
    locator.SetDataSet(surfaces)
    locator.BuildLocator()
    hits, cells, found = vtkPoints(), vtkIdList(), []
    for x, y in np.asarray(points, dtype=float):
        locator.IntersectWithLine((x, y, low - 1.0), (x, y, high + 1.0), 0.0, hits, cells)
        found.append(np.sort([hits.GetPoint(i)[2] for i in range(hits.GetNumberOfPoints())]))
    return found


def ground_of(scene, points) -> np.ndarray:
    """z of the lowest surface at each point, m; NaN without a surface. @param points n x 2, m"""
    return np.array([z[0] if len(z) else np.nan for z in _along_verticals(scene, points)])


def candidates(points, masts: Sequence[float] = (5.0,), exclusions: Sequence[Tuple[Any, float]] = (), scene=None
               ) -> np.ndarray:
    """Places where a lidar may stand, n x 3, m: each point outside all exclusions, with each mast. Candidates at equal
    places are reduced to the first, with a warning, because two sensors at one place would count as one.

    points      n x 2, m
    masts       heights above the ground, m
    exclusions  outlines (m x 2, m), each with the margin (m) around the outline
    scene       a Scene: its lowest surface is the ground, and no candidate may stand under another surface, as in a
                building. None: the ground is at z = 0, as it is where the scene has no surface
    """
    points = rows_of("points", points, (2,))
    _check_count(len(points) * len(masts), f"{len(points)} points and {len(masts)} masts make", "take fewer")
    free = np.ones(len(points), dtype=bool)
    for outline, margin in exclusions:
        free &= ~is_near(points, outline, margin)
    surfaces = _along_verticals(scene, points[free]) if scene is not None else [np.empty(0)] * np.count_nonzero(free)
    ground = np.array([z[0] if len(z) else 0.0 for z in surfaces])
    top = np.array([z[-1] if len(z) else -np.inf for z in surfaces])
    found = [np.column_stack([points[free], ground + mast])[ground + mast > top] for mast in masts]
    if not any(map(len, found)):
        raise ValueError(f"no candidate is left of {len(points)} points and {len(found)} masts: "
                         "exclusions hold them all")
    places = np.concatenate(found)
    first = np.sort(np.unique(np.round(places / SAME_PLACE), axis=0, return_index=True)[1])
    if len(first) < len(places):
        warnings.warn(f"{len(places) - len(first)} of {len(places)} candidates stand at the place of another "
                      "candidate, and are left out", RuntimeWarning, stacklevel=callers_level())
    return places[first]


def code_of(length: float) -> int:
    """The code number, 1 to 4, that belongs to a runway's length, m."""
    return 1 + int(np.searchsorted(TABLE["codes"]["lengths"], length, side="right"))


@dataclasses.dataclass(frozen=True)
class Surfaces:
    """The obstacle limitation surfaces of a runway.

    code      number, 1 to 4              category  category of the approach: non-instrument, non-precision, precision
    numbers   dimensions of each surface that counts, as in `surfaces.json`
    profile   distances from the runway's start, m, and heights (z, m) of the runway's middle line at these distances
    """

    runway: Runway
    code: int
    category: str
    numbers: Dict[str, Dict[str, Any]]
    profile: np.ndarray

    @classmethod
    def of(cls, runway: Runway, scene=None, changes: Optional[Mapping[str, Any]] = None) -> Surfaces:
        """The surfaces from the table. @param scene scene whose lowest surface is the ground; without a surface the
        ground is at z = 0 @param changes code, category, and for a surface False, which leaves the surface out, or
        other dimensions"""
        changes = changes or {}
        length = runway.axis()[1]
        code, category = changes.get("code", code_of(length)), changes.get("category", TABLE["category"]["default"])
        numbers = {name: {**TABLE[category][str(code)][name], "kept": changes.get(name) is not False,
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
        """The height (z, m) of each counting surface above or below each point: infinite outside the surface, minus
        infinity in the strip, where no lidar may stand. @param points n x 2 or n x 3, m"""
        length = self.runway.axis()[1]
        along, aside = self.runway.axes() @ (np.asarray(points, dtype=float)[:, :2] - self.runway.start).T
        aside = np.abs(aside)
        beyond = np.maximum(-along, along - length)  # distance beyond the nearer end, m; negative beside the runway
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
        found = {"strip": np.where(in_strip, -np.inf, np.inf),
                 "approach": np.where(before & (aside <= half_width), ground + rise, np.inf),
                 "transitional": np.where(beside, ground + up, np.inf)}
        return {name: found[name] for name in self.kept}


def pierced(surfaces: Sequence[Surfaces], tops) -> np.ndarray:
    """The first surface that each top pierces: 0 for none, else 1 + the number in NAMES. @param tops n x 3, m"""
    tops = np.asarray(tops, dtype=float)
    found = np.zeros(len(tops), dtype=int)
    for number, name in enumerate(NAMES, 1):
        for one in surfaces:
            if name in one.kept:
                found[(found == 0) & (tops[:, 2] > one.limits(tops)[name])] = number
    return found
