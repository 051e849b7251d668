# SPDX-License-Identifier: BSD-3-Clause
"""Errors of echoes against a reference of the same beams: of energy, of range, and echoes missed or invented. They have
bounds, as the beams are a weighted sample.

Echoes are rows of numbers, in the order of beam and range. They are matched within a beam: each is the nearest of the
other, within a tolerance. Energy and range are judged for strong echoes that are not ghosts (at most half of the energy
over two reflections). A strong echo that is missed has an energy error of -1. Ghosts count as found or missed alone.
Echoes that only some scans of the reference have are not judged.

Bounds are one-sided, 95 %, and hold for a scan of all beams with another seed. They follow from the spread among beams
(variance of a ratio of weighted sums, linearised: Cochran, Sampling Techniques, 3rd ed., section 6, second-hand). The
spread counts twice where all beams were taken, as both scans are random. Three times the share of a single beam is
added, as a few beams that err say little about how many do, and the reference's own error. An rms of fewer than 30
beams has no bound.
"""
from __future__ import annotations

from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

BEAM, RANGE, ENERGY, SECONDARY, TOTAL, OBJECT = range(6)  # columns of echoes: m, J, share, J
GHOST = 0.5  # share of the energy over two reflections
SURELY = 1.645  # standard deviations of a one-sided bound of 95 %
FEW = 3.0  # 95 % bound of a count, beyond its square root, if few were seen
FEWEST = 30  # beams from which a bound of an rms follows


class Known(NamedTuple):
    """What is taken for true of some beams."""

    sure: np.ndarray  # echoes
    unsure: np.ndarray  # echoes that are not judged
    x: np.ndarray  # by kind of error and beam: spread of the mean, ...
    y: np.ndarray  # ... and what it is divided by

    def replaced(self, which: np.ndarray, other: "Known") -> "Known":
        """With what another one has of some beams."""
        parts = []
        for mine, rows in zip(self[:2], other[:2]):
            there = rows.copy()
            there[:, BEAM] = which[rows[:, BEAM].astype(int)]
            parts.append(in_order(np.concatenate((mine[~np.isin(mine[:, BEAM], which)], there))))
        x, y = self.x.copy(), self.y.copy()
        x[:, which], y[:, which] = other.x, other.y
        return Known(parts[0], parts[1], x, y)


class Judge:
    """Compares echoes. @param tolerance between echoes that are one, m @param strong least energy that is judged, J"""

    def __init__(self, tolerance: float, strong: float):
        self.tolerance, self.strong = tolerance, strong

    def match(self, one: np.ndarray, other: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Rows of echoes that are each the nearest of the other."""
        if not len(one) or not len(other):
            return np.zeros(0, int), np.zeros(0, int)
        apart = 2 * (max(one[:, RANGE].max(), other[:, RANGE].max()) + self.tolerance)
        keys, others = (rows[:, BEAM] * apart + rows[:, RANGE] for rows in (one, other))  # ascending

        def nearest(these, among):
            after = np.searchsorted(among, these)
            before, after = np.maximum(after - 1, 0), np.minimum(after, len(among) - 1)
            return np.where(np.abs(among[before] - these) <= np.abs(among[after] - these), before, after)

        theirs = nearest(keys, others)
        mutual = nearest(others, keys)[theirs] == np.arange(len(keys))
        found = mutual & (np.abs(keys - others[theirs]) < self.tolerance)
        return np.flatnonzero(found), theirs[found]

    def judged(self, rows: np.ndarray) -> np.ndarray:
        """Whether energy and range count."""
        return (rows[:, ENERGY] >= self.strong) & (rows[:, SECONDARY] <= GHOST)

    def average(self, scans: Sequence[np.ndarray], count: int) -> Known:
        """The mean of scans of so many beams; an echo is sure if seven of eight have it, of fewer all."""
        values, others = np.full((len(scans), *scans[0].shape), np.nan), []
        for into, scan in zip(values, scans):
            i, j = self.match(scans[0], scan)
            into[i] = scan[j]
            others.append(np.delete(scan, j, axis=0))
        found = np.isfinite(values[:, :, BEAM]).sum(axis=0)
        mean = np.nanmean(values, axis=0) if len(found) else scans[0]
        sure = found >= len(scans) - len(scans) // 8
        unsure = in_order(np.concatenate((*others, mean[~sure])))
        strong = sure & self.judged(mean)
        true, off, number = mean[strong], values[:, strong], found[strong]
        squares = [np.nansum(one**2, axis=0) / (number * (number - 1)) for one in
                   (off[:, :, ENERGY] / true[:, ENERGY] - 1, off[:, :, RANGE] - true[:, RANGE])]
        x = np.stack((*(per_beam(true, count, one) for one in squares), per_beam(unsure, count)))
        return Known(mean[sure], unsure, x, np.stack([per_beam(rows, count) for rows in (true, true, mean[sure])]))

    def compare(self, scans: Sequence[np.ndarray], known: Known) -> Tuple[np.ndarray, np.ndarray]:
        """By beam, of energy and range: the product of what two scans by other means are off by, and the number of
        echoes. The two are independent, so the mean of the product is the square of what both have in common."""
        (i, j), (k, l) = (self.match(known.sure, scan) for scan in scans)
        common, first, second = np.intersect1d(i, k, return_indices=True)
        strong = self.judged(known.sure[common])
        true, one, other = known.sure[common[strong]], scans[0][j[first[strong]]], scans[1][l[second[strong]]]
        count = known.x.shape[1]
        squares = ((one[:, ENERGY] / true[:, ENERGY] - 1) * (other[:, ENERGY] / true[:, ENERGY] - 1),
                   (one[:, RANGE] - true[:, RANGE]) * (other[:, RANGE] - true[:, RANGE]))
        return np.stack([per_beam(true, count, square) for square in squares]), np.stack([per_beam(true, count)] * 2)

    def count(self, found: np.ndarray, known: Known) -> Tuple[np.ndarray, np.ndarray]:
        """The errors of a scan by kind and beam: sums, and what they are divided by."""
        count = known.x.shape[1]
        i, j = self.match(known.sure, found)
        strong = self.judged(known.sure[i])
        true, seen, rest = known.sure[i[strong]], found[j[strong]], np.delete(found, j, axis=0)
        invented = np.delete(rest, self.match(rest, known.unsure)[0], axis=0)
        energies, ranges, echoes = (per_beam(rows, count) for rows in
                                    (known.sure[self.judged(known.sure)], true, known.sure))
        return (np.stack((per_beam(true, count, (seen[:, ENERGY] / true[:, ENERGY] - 1) ** 2) + energies - ranges,
                          per_beam(true, count, (seen[:, RANGE] - true[:, RANGE]) ** 2),
                          echoes - per_beam(known.sure[i], count) + per_beam(invented, count))),
                np.stack((energies, ranges, echoes)))


def in_order(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort((rows[:, RANGE], rows[:, BEAM]))]


def per_beam(rows: np.ndarray, count: int, values: Optional[np.ndarray] = None) -> np.ndarray:
    """Sums over the echoes of each beam; of 1 without values."""
    return np.bincount(rows[:, BEAM].astype(int), values, count).astype(float)


def ratio_of(x: np.ndarray, y: np.ndarray, weights: np.ndarray) -> Tuple[float, float]:
    """The ratio of weighted sums and its standard deviation; 0 of nothing."""
    x, y = weights * x, weights * y
    ratio = x.sum() / y.sum() if y.sum() else 0.0
    return ratio, np.sqrt(((1 + 1 / weights) * (x - ratio * y) ** 2).sum()) / (y.sum() or 1.0)


def bounds(x: np.ndarray, y: np.ndarray, weights: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Value, least and most of each kind of error. @param own errors of the reference"""
    errors = np.zeros((3, 3))
    squared = (1 + 1 / weights) * weights**2
    for kind in range(3):
        ratio, deviation = ratio_of(x[kind], y[kind], weights)
        total = (weights * y[kind]).sum() or 1.0
        by = SURELY * deviation + (FEW * (squared * x[kind] ** 2).sum() / (ratio * total**2) if ratio > 0 else 0)
        if kind == 2:  # a share
            none = FEW * (squared * y[kind] ** 2).sum() / total**2
            errors[kind] = ratio, max(0, ratio - by - own[kind]), max(ratio + by, none) + own[kind]
        elif np.count_nonzero(y[kind]) < FEWEST:
            errors[kind] = np.sqrt(ratio), 0, np.inf
        else:
            low, value, high = np.sqrt((max(0, ratio - by), ratio, ratio + by))
            errors[kind] = value, max(0, low - own[kind]), high + own[kind]
    return errors
