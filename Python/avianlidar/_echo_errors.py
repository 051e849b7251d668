# SPDX-License-Identifier: BSD-3-Clause
"""Errors of echoes compared with a reference of the same beams: errors of energy and of range, and shares of missed or
invented echoes. The errors have bounds, because the beams are a weighted sample.

Echoes are rows of numbers, in the order of beam and range. Echoes of one beam are matched: two echoes match if each is
the nearest to the other within a tolerance. Energy and range are judged for strong echoes that are not ghosts; a ghost
has more than half of its energy from paths with two reflections. A missed strong echo has an energy error of -1. Ghosts
count only as found or missed. Echoes that only some scans of the reference have are not judged.

Bounds are one-sided, 95 %, and hold for a scan of all beams with another seed. They follow from the spread among beams
(variance of a ratio of weighted sums, linearised: Cochran, Sampling Techniques, 3rd ed., section 6, second-hand). The
spread counts twice where all beams were scanned once, because both scans are random; further seeds of the measured scan
reduce its part. Two terms are added: three times the share of a single beam, because a few wrong beams say little about
the number of wrong beams, and the error of the reference. An rms of fewer than 30 beams has no bound.
"""
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

# Columns of echoes; RANGE in m, ENERGY and TOTAL in J, SECONDARY a share of the energy.
BEAM, RANGE, ENERGY, SECONDARY, TOTAL, OBJECT = range(6)
GHOST = 0.5  # least share of a ghost's energy that comes from two reflections
SURELY = 1.645  # standard deviations of a one-sided bound of 95 %
FEW = 3.0  # 95 % bound of a small count, beyond its square root
FEWEST = 30  # least number of beams for the bound of an rms


class Known(NamedTuple):
    """Reference values of some beams, which count as true."""

    sure: np.ndarray  # echoes that are judged
    unsure: np.ndarray  # echoes that are not judged
    x: np.ndarray  # spread of the mean by kind of error and beam ...
    y: np.ndarray  # ... and the divisor of x

    def some(self, which: np.ndarray) -> "Known":
        """The values of some beams, which are counted from 0."""
        places = np.full(self.x.shape[1], -1)
        places[which] = np.arange(len(which))
        sure, unsure = (rows[places[rows[:, BEAM].astype(int)] >= 0] for rows in self[:2])
        for rows in (sure, unsure):
            rows[:, BEAM] = places[rows[:, BEAM].astype(int)]
        return Known(in_order(sure), in_order(unsure), self.x[:, which], self.y[:, which])

    def beams_between(self, least: float, most: float) -> np.ndarray:
        """The beams with an echo that has a share of energy from two reflections between `least` and `most`."""
        share = self.sure[:, SECONDARY]
        return np.unique(self.sure[(share > least) & (share <= most), BEAM]).astype(int)

    def replaced(self, which: np.ndarray, other: "Known") -> "Known":
        """This Known with the values of another Known for some beams."""
        parts = []
        for mine, rows in zip(self[:2], other[:2]):
            there = rows.copy()
            there[:, BEAM] = which[rows[:, BEAM].astype(int)]
            parts.append(in_order(np.concatenate((mine[~np.isin(mine[:, BEAM], which)], there))))
        x, y = self.x.copy(), self.y.copy()
        x[:, which], y[:, which] = other.x, other.y
        return Known(parts[0], parts[1], x, y)


class Judge:
    """Compares echoes. @param tolerance greatest distance of matching echoes, m @param strong least judged energy, J"""

    def __init__(self, tolerance: float, strong: float):
        self.tolerance, self.strong = tolerance, strong

    def match(self, one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Row numbers of matching echoes in two arrays of echoes."""
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
        """Whether energy and range of each echo are judged."""
        return (rows[:, ENERGY] >= self.strong) & (rows[:, SECONDARY] <= GHOST)

    def average(self, scans: Sequence[np.ndarray], count: int) -> Known:
        """The mean of scans of `count` beams. An echo is sure if 7 of 8 scans have the echo, or all of fewer scans."""
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
        squares = [np.nansum(one**2, axis=0) / (number * (number - 1)) for one in errors_of(off, true)]
        x = np.stack((*(per_beam(true, count, one) for one in squares), per_beam(unsure, count)))
        return Known(mean[sure], unsure, x, np.stack([per_beam(rows, count) for rows in (true, true, mean[sure])]))

    def compare(self, scans: Sequence[np.ndarray], known: Known) -> tuple[np.ndarray, np.ndarray]:
        """For energy and range, by beam: the product of the errors of two independent scans with other settings, and
        the number of echoes. The mean of the product is the square of the common error of both scans."""
        (i, j), (k, l) = (self.match(known.sure, scan) for scan in scans)
        common, first, second = np.intersect1d(i, k, return_indices=True)
        strong = self.judged(known.sure[common])
        true, one, other = known.sure[common[strong]], scans[0][j[first[strong]]], scans[1][l[second[strong]]]
        products, count = np.multiply(errors_of(one, true), errors_of(other, true)), known.x.shape[1]
        return np.stack([per_beam(true, count, kind) for kind in products]), np.stack([per_beam(true, count)] * 2)

    def count(self, found: np.ndarray, known: Known) -> tuple[np.ndarray, np.ndarray]:
        """The errors of a scan by kind and beam: sums and their divisors."""
        count = known.x.shape[1]
        i, j = self.match(known.sure, found)
        strong = self.judged(known.sure[i])
        true, rest = known.sure[i[strong]], np.delete(found, j, axis=0)
        invented = np.delete(rest, self.match(rest, known.unsure)[0], axis=0)
        energies, ranges, echoes, matched, more = (per_beam(rows, count) for rows in (
            known.sure[self.judged(known.sure)], true, known.sure, known.sure[i], invented))
        energy, distance = (per_beam(true, count, one**2) for one in errors_of(found[j[strong]], true))
        return (np.stack((energy + energies - ranges, distance, echoes - matched + more)),
                np.stack((energies, ranges, echoes)))


def errors_of(rows: np.ndarray, true: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Relative errors of energy, and errors of range, m."""
    return rows[..., ENERGY] / true[:, ENERGY] - 1, rows[..., RANGE] - true[:, RANGE]


def in_order(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort((rows[:, RANGE], rows[:, BEAM]))]


def per_beam(rows: np.ndarray, count: int, values: np.ndarray | None = None) -> np.ndarray:
    """Sums over the echoes of each beam; without values, the number of echoes."""
    return np.bincount(rows[:, BEAM].astype(int), values, count).astype(float)


class Found(NamedTuple):
    """Errors of scans with one or more seeds. Arrays have a row for each kind of error and a column for each beam."""

    x: np.ndarray  # sums of errors, mean over the seeds
    y: np.ndarray  # the divisors, mean over the seeds
    squares: np.ndarray  # means of x * x, x * y and y * y over the seeds: three such arrays
    seeds: np.ndarray  # number of seeds of each beam

    @classmethod
    def of(cls, x: np.ndarray, y: np.ndarray) -> "Found":
        """One seed."""
        return cls(x, y, np.stack((x * x, x * y, y * y)), np.ones(x.shape[1]))

    def beside(self, other: "Found") -> "Found":
        """The errors of these beams and of others."""
        return Found(*(np.concatenate(parts, axis=-1) for parts in zip(self, other)))

    def with_seed(self, which: np.ndarray, other: "Found") -> "Found":
        """The errors with a further seed for some of the beams."""
        seeds = self.seeds.copy()
        seeds[which] += 1
        x, y, squares = (mine.copy() for mine in self[:3])
        for mine, more in zip((x, y, squares), other):
            mine[..., which] += (more - mine[..., which]) / seeds[which]
        return Found(x, y, squares, seeds)

    def spread(self, weights: np.ndarray, alone: np.ndarray, squares: np.ndarray) -> float:
        """The variance of a weighted sum over the beams, for these scans and one of all beams with another seed.
        @param alone mean over the seeds @param squares mean of the squares"""
        return float((np.maximum(weights**2 - weights, 0) * alone**2 + weights * (1 + 1 / self.seeds) * squares).sum())


def ratio_of(x: np.ndarray, y: np.ndarray, weights: np.ndarray) -> tuple[float, float]:
    """The ratio of weighted sums and its standard deviation; 0 without data."""
    one = Found.of(x[None], y[None])
    return one_ratio(one, 0, weights)


def one_ratio(found: Found, kind: int, weights: np.ndarray) -> tuple[float, float]:
    """`ratio_of` for a kind of error."""
    x, y, (xx, xy, yy) = found.x[kind], found.y[kind], found.squares[:, kind]
    total = (weights * y).sum()
    ratio = (weights * x).sum() / total if total else 0.0
    variance = found.spread(weights, x - ratio * y, xx - 2 * ratio * xy + ratio**2 * yy)
    return ratio, np.sqrt(max(0.0, variance)) / (total or 1.0)


def bounds(found: Found, weights: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Value, lower and upper bound of each kind of error. @param own errors of the reference"""
    errors = np.zeros((3, 3))
    for kind in range(3):
        ratio, deviation = one_ratio(found, kind, weights)
        total = (weights * found.y[kind]).sum() or 1.0
        few = FEW * found.spread(weights, found.x[kind], found.squares[0, kind]) / total**2
        by = SURELY * deviation + (few / ratio if ratio > 0 else 0)
        if kind == 2:  # the kind of error is a share
            none = FEW * found.spread(weights, found.y[kind], found.squares[2, kind]) / total**2
            errors[kind] = ratio, max(0, ratio - by - own[kind]), max(ratio + by, none) + own[kind]
        elif np.count_nonzero(found.y[kind]) < FEWEST:
            errors[kind] = np.sqrt(ratio), 0, np.inf
        else:
            low, value, high = np.sqrt((max(0, ratio - by), ratio, ratio + by))
            errors[kind] = value, max(0, low - own[kind]), high + own[kind]
    return errors
