# SPDX-License-Identifier: BSD-3-Clause
"""Scores of tracks compared with true flights: assignment, OSPA, switches, and means with standard errors."""
from __future__ import annotations

import math
from typing import Any, Dict, Hashable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np


class Value(NamedTuple):
    """A number with its standard error (nan without one) and the number of samples."""
    value: float
    error: float
    number: int


class Ospa(NamedTuple):
    """The OSPA distance of two sets, m, and its two parts."""
    distance: float
    localisation: float
    cardinality: float


def assign(distance, cutoff: float) -> List[Tuple[int, int]]:
    """Pairs of a row and a column, at most one pair for each, nearer than the cut-off. The sum of all distances is
    least, where each row or column without a partner counts as the cut-off. @param distance n x m"""
    from scipy.optimize import linear_sum_assignment
    distance = np.asarray(distance, float)
    pairs = zip(*linear_sum_assignment(np.minimum(distance, cutoff)))
    return [(int(i), int(j)) for i, j in pairs if distance[i, j] < cutoff]


def follow(distance, truths: Sequence[Hashable], tracks: Sequence[Hashable], cutoff: float,
           before: Mapping[Any, Any]) -> Dict[Any, Any]:
    """The track of each truth in a scan. A pair of the scan before is kept while it is nearer than the cut-off; all
    others are assigned again (Bernardin & Stiefelhagen 2008, CLEAR MOT). @param distance truths x tracks @param before
    tracks by truth"""
    distance = np.array(distance, float).reshape(len(truths), len(tracks))
    row, column = ({name: number for number, name in enumerate(names)} for names in (truths, tracks))
    kept = {truth: track for truth, track in before.items()
            if truth in row and track in column and distance[row[truth], column[track]] < cutoff}
    distance[[row[truth] for truth in kept]] = np.inf
    distance[:, [column[track] for track in kept.values()]] = np.inf
    return {**kept, **{truths[i]: tracks[j] for i, j in assign(distance, cutoff)}}


def ospa(distance, cutoff: float, order: float = 2.0) -> Ospa:
    """Optimal subpattern assignment distance of two sets (Schuhmacher, Vo & Vo 2008, doi:10.1109/TSP.2008.920469, eq.
    3): 0 if both sets are empty, the cut-off if one set is empty. `distance` to the power of the order is the sum of
    the parts to that power. @param distance n x m, values of a metric @param order p, 1 or more, finite"""
    if not 0.0 < cutoff < math.inf or not 1.0 <= order <= 20.0:
        raise ValueError(f"cutoff is {cutoff} m and order {order}, expected more than 0 m, and 1 to 20")
    distance = np.asarray(distance, float)
    most, least = max(distance.shape), min(distance.shape)
    if most == 0:
        return Ospa(0.0, 0.0, 0.0)
    from scipy.optimize import linear_sum_assignment
    powers = np.minimum(distance, cutoff) ** order
    near = powers[linear_sum_assignment(powers)].sum() / most
    missing = cutoff ** order * (most - least) / most
    return Ospa(*(float(part ** (1.0 / order)) for part in (near + missing, near, missing)))


def switches(tracks: Sequence[Optional[Hashable]]) -> int:
    """Number of changes of a truth from one track to another. @param tracks track in each scan, None without one"""
    had = [track for track in tracks if track is not None]
    return sum(a != b for a, b in zip(had, had[1:]))


def in_wedge(points, threshold, outwards, length: float, half_width: Tuple[float, float],
             height: Tuple[float, float]) -> np.ndarray:
    """Which points lie below and beside the glide path before a threshold, or in the box over a runway. @param points n
    x 3, m @param outwards unit vector away from the runway, or along the runway @param half_width, height m at the
    threshold, and increase per metre outwards"""
    points = np.asarray(points, float).reshape(-1, 3)
    x, y = outwards
    along, aside = ((points[:, :2] - np.asarray(threshold)) @ [[x, y], [y, -x]]).T
    is_beside = np.abs(aside) <= half_width[0] + half_width[1] * along
    is_below = points[:, 2] <= height[0] + height[1] * along
    return (along >= 0.0) & (along <= length) & is_beside & is_below


def entered(inside: np.ndarray) -> np.ndarray:
    """When a bird is inside any volume except those in which it begins. @param inside volumes x times"""
    return (inside & ~inside[:, :1]).any(axis=0)


def mean(values) -> Value:
    """Mean, and its standard error from the spread of the values."""
    values = np.asarray(values, float)
    count = len(values)
    error = float(values.std(ddof=1)) / math.sqrt(count) if count > 1 else math.nan
    return Value(float(values.mean()) if count else math.nan, error, count)


def weighted(values: np.ndarray, weights: np.ndarray) -> Value:
    """The weighted mean over places, with the standard error of randomly drawn places; nan if no place has a weight."""
    count, total = len(values), float(weights.sum())
    if not total:
        return Value(math.nan, math.nan, count)
    mean = float(np.vdot(weights, values.astype(float))) / total
    squares = float(np.sum((weights * (values - mean)) ** 2))
    return Value(mean, math.sqrt(squares * count / max(count - 1, 1)) / total, count)


def ratio(parts, wholes) -> Value:
    """Sum of the parts over the sum of the wholes, with the error from leaving out one bird at a time (jackknife)."""
    parts, wholes = np.asarray(parts, float), np.asarray(wholes, float)
    parts, wholes = parts[wholes > 0.0], wholes[wholes > 0.0]
    count, part, whole = len(parts), float(parts.sum()), float(wholes.sum())
    error = math.sqrt(count - 1) * float(np.std((part - parts) / (whole - wholes))) if count > 1 else math.nan
    return Value(part / whole if count else math.nan, error, count)


def share(count: int, of: int) -> Value:
    """A share. Its error is the standard deviation of the beta distribution of count + 1 and of - count + 1, which
    follows from a uniform prior. The error is above 0 also for a share of 0 or 1."""
    p = (count + 1.0) / (of + 2.0)
    return Value(count / of, math.sqrt(p * (1.0 - p) / (of + 3.0)), of) if of else Value(math.nan, math.nan, 0)


def rate(count: int, time: float) -> Value:
    """Events per unit of time. Its error is that of the gamma distribution of count + 1, for a Poisson process; it is
    above 0 also for no event."""
    return Value(count / time, math.sqrt(count + 1.0) / time, count) if time > 0.0 else Value(math.nan, math.nan, count)
