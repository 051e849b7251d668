# SPDX-License-Identifier: BSD-3-Clause
"""The best networks of sites, from what each site alone detects."""
from __future__ import annotations

import dataclasses
import itertools
from typing import Any, List, Mapping, Optional, Sequence, Tuple

import numpy as np

ROUNDING = 1e-12  # difference of shares that counts as none


@dataclasses.dataclass(frozen=True)
class Network:
    """Sites that work together, by their numbers, and the weighted share that they detect."""

    sites: Tuple[int, ...]
    value: float


def weights_of(count: int, regions: Mapping[str, Any], shares: Mapping[str, float],
               mix: Mapping[str, float]) -> np.ndarray:
    """The weight of each place for each species: species x places, with the sum 1.

    count    number of places
    regions  names, each with the numbers of its places
    shares   share of each region, by name; the places of a region divide the share evenly
    mix      share of each species, by name
    """
    for what, given in (("share", shares), ("mix", mix)):
        if not given or min(given.values()) < 0.0 or not 0.0 < sum(given.values()) < np.inf:
            raise ValueError(f"{what} is {dict(given)}, expected numbers from 0 with a sum above 0")
    weights = np.zeros(count)
    for name, share in shares.items():
        if name not in regions or not len(regions[name]):
            raise ValueError(f"no place lies in the region {name!r}; regions are {', '.join(regions)}")
        weights[np.asarray(regions[name])] += share / len(regions[name])
    species = np.array(list(mix.values()), dtype=float)
    return np.outer(species / species.sum(), weights / weights.sum())


def values_of(found: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The weighted share that each site alone detects. @param found sites x species x places"""
    _check_weights(found, weights)
    return np.array([np.vdot(site.astype(float), weights) for site in found])


def value_of(found: np.ndarray, weights: np.ndarray, sites: Sequence[int]) -> float:
    """The weighted share that at least one of the sites detects, for independent sensors."""
    return float(weights.sum() - _missed(found, weights, sites).sum())


def _missed(found, weights, sites) -> np.ndarray:
    """Weights times the probability that none of the sites detects, species x places."""
    left = weights.astype(float)
    for i in sites:
        left = left * (1.0 - found[i].astype(float))
    return left


def greedy(found: np.ndarray, weights: np.ndarray, count: int, spots: Optional[np.ndarray] = None) -> List[Network]:
    """Networks of 1 to `count` sites; each is the one before with the site that adds most. @param spots as in
    `search`"""
    chosen: List[Network] = []
    sites: Tuple[int, ...] = ()
    for _ in range(_count(found, weights, count)):
        sites += (int(np.argmax(_gains(found, weights, sites, spots))),)
        chosen.append(Network(sites, value_of(found, weights, sites)))
    return chosen


def _check_weights(found, weights) -> None:
    if found.shape[1:] != weights.shape:
        raise ValueError(f"weights have the shape {weights.shape}, "
                         f"expected that of each site's coverage, {found.shape[1:]}")


def _count(found, weights, count) -> int:
    _check_weights(found, weights)
    if not 1 <= count <= len(found):
        raise ValueError(f"count is {count}, expected 1 to {len(found)}, the number of sites")
    return count


def _gains(found, weights, sites, spots) -> np.ndarray:
    """The share that each site would add to the given sites; negative for the spots of the given sites."""
    spots = np.arange(len(found)) if spots is None else spots
    gains = found.reshape(len(found), -1) @ _missed(found, weights, sites).astype(found.dtype).ravel()
    gains[np.isin(spots, spots[list(sites)])] = -1.0
    return gains


def exchange(found: np.ndarray, weights: np.ndarray, network: Network, spots: Optional[np.ndarray] = None) -> Network:
    """A network that no exchange of one site improves, at least as good as the given network. @param spots as in
    `search`"""
    best = network
    while True:
        tried = [best.sites[:k] + best.sites[k + 1:] for k in range(len(best.sites))]
        swapped = [(*rest, int(np.argmax(_gains(found, weights, rest, spots)))) for rest in tried]
        value, sites = max((value_of(found, weights, sites), sites) for sites in swapped)
        if not value > best.value + 1e-9:
            return best
        best = Network(sites, value)


def exhaustive(found: np.ndarray, weights: np.ndarray, count: int, spots: Optional[np.ndarray] = None) -> Network:
    """The best of all networks of one, two or three sites. @param spots as in `search`"""
    if _count(found, weights, count) > 3:
        raise ValueError(f"count is {count}, expected at most 3: larger networks are too many")
    n = len(found)
    spots = np.arange(n) if spots is None else spots
    missed = 1.0 - found.reshape(n, -1).astype(float)
    left = missed * weights.ravel()
    by_one, by_two = left.sum(axis=1), left @ missed.T if count > 1 else None
    all_sites = np.array([*itertools.combinations(range(n), count)])
    all_sites = all_sites[(np.diff(np.sort(spots[all_sites], axis=1), axis=1) > 0).all(axis=1)]
    if count == 1:
        least = by_one
    elif count == 2:
        least = by_two[tuple(all_sites.T)]
    else:
        # A site adds no more to two sites than to one of them, so three sites miss at least this.
        i, j, k = all_sites.T
        least = np.max([by_two[a, b] + by_two[a, c] - by_one[a] for a, b, c in ((i, j, k), (j, i, k), (k, i, j))],
                       axis=0)
    best = Network((), 0.0)
    for number in np.argsort(least, kind="stable"):
        if best.sites and weights.sum() - least[number] <= best.value + ROUNDING:
            break
        sites = tuple(all_sites[number].tolist())
        value = value_of(found, weights, sites)
        best = Network(sites, value) if value > best.value or not best.sites else best
    return best


def search(found: np.ndarray, weights: np.ndarray, count: int = 3, largest: int = 60,
           spots: Optional[np.ndarray] = None) -> List[Network]:
    """The best networks of 1 to `count` sites. The search is exhaustive for one site, and for up to three of at most
    `largest` sites. Otherwise the greedy network is improved by exchange.

    found    sites x species x places, from look
    weights  species x places, from weights_of
    spots    a number for each site: a network has at most one of the sites with equal numbers, such as masts at one
             place. Default: all sites may work together. Ignored if there are fewer than `count` different numbers
    """
    if spots is not None and len(np.unique(spots)) < count:
        spots = None
    return [exhaustive(found, weights, n, spots) if n == 1 or (n <= 3 and len(found) <= largest) else
            exchange(found, weights, start, spots) for n, start in enumerate(greedy(found, weights, count, spots), 1)]


def rank_correlation(a, b) -> float:
    """Spearman's rank correlation of two rows of numbers; equal numbers share their mean rank."""
    from scipy.stats import spearmanr
    return float(spearmanr(a, b)[0])
