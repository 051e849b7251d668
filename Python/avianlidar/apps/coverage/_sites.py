# SPDX-License-Identifier: BSD-3-Clause
"""Search for sites of lidars, a plan's `siting`. `_sites_page` writes what is found."""
from __future__ import annotations

import dataclasses
import itertools
import pathlib
import tempfile
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np

from ..._pipeline import Error
from ..._ranks import Ranks
from ..._scene import load_scene
from ..inputs._air import Air
from ..inputs._json import naming
from ..inputs._tables import read_table
from ..places._candidates import NAMES, SAME_PLACE, Surfaces, candidates, ground_of, is_near, lattice, pierced
from ..places._geojson import read_outlines, with_other_heights
from ..places._regions import by_kind, rounded, runway_outline
from ._looks import look, require_memory, value_of_same_birds
from ._networks import Network, search, value_of, values_of
from ._plan import OTHER_PLACES, Plan

NEAR = 40  # number of candidates, best alone, whose networks are compared, together with the best network's members
DRAWS = 10
FEWEST_DRAWS = 10  # least number of draws that shows how sure a winner is
BEST = 10  # number of sites whose shares are shown
SPACING = 200.0  # default spacing of the lattice, m
HEIGHT_ERROR = 5.0  # error of building heights, m; assumed
AREA_ERROR = 0.2  # relative error of the mean effective area; assumed


@dataclasses.dataclass(frozen=True)
class Change:
    """The effect of a draw of other heights, areas or places on networks of one size."""

    what: str
    winner: Network  # best network, with its value in this draw
    value: float  # value of the original winner in this draw

    def is_another(self, networks: List[Network]) -> bool:
        """Whether a different network wins."""
        return sorted(self.winner.sites) != sorted(networks[len(self.winner.sites) - 1].sites)


def _read_points(name: str) -> np.ndarray:
    """The columns x and y of a CSV file, n x 2, m."""
    try:
        points = np.array([(float(row["x"]), float(row["y"])) for row in read_table(name)])
    except (KeyError, TypeError, ValueError) as error:
        raise Error(f"{name}: expected the columns x and y in the first line and numbers (m) below ({error})") from None
    if not len(points):
        raise Error(f"{name}: has no rows, expected numbers (m) below the first line")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise Error(f"{name}: row {wrong[0] + 1} is not finite, expected numbers (m)")
    return points


def _points(plan: Plan, options: Dict[str, Any]) -> Tuple[np.ndarray, str]:
    """The places of the plan's table of points, or of its lattice, n x 2, m, and their origin in words."""
    if "points" in options:
        with naming(f"{plan.file}: siting.points"):
            return _read_points(options["points"]), f"the places of {pathlib.Path(options['points']).name}"
    spacing = options.get("spacing", SPACING)
    with naming(f"{plan.file}: siting.spacing"):
        return lattice(options.get("bounds", plan.extent), spacing), f"a lattice of {spacing:g} m"


def _exclusions(plan: Plan, options: Dict[str, Any]) -> List[Tuple[np.ndarray, float]]:
    """Outlines (m) where no lidar may stand, each with its margin (m)."""
    origin, margin = plan.scene.geodetic_origin, float(options.get("margin", 0.0))
    with naming(f"{plan.file}: runways"):
        outlines = read_outlines(plan.plan["runways"], origin, "height")
    for number, file in enumerate(options.get("exclusions", ())):
        with naming(f"{plan.file}: siting.exclusions[{number}]"):
            found = read_outlines(file, origin)
            if not found:
                raise Error(f"{file}: holds no polygon, expected some where no lidar may stand")
            outlines += found
    return [*((outline, margin) for outline in outlines),
            *((runway_outline(runway, 0.0, runway.width / 2.0), 0.0) for runway in plan.runways)]


class Sites:
    """Candidates of a plan, and the shares that lidars at the candidates would detect.

    positions  n x 3, m, in the order of the lattice   networks  the best of 1, 2, ... sensors
    values     weighted share of each candidate alone  order     candidates from the best to the worst
    airs       weathers with their shares of the year  by_air    weighted share of each candidate alone in each weather
    surfaces   of each runway, limiting the masts      pierced   candidates left out for each kind of surface, by name
    told       shares of the best candidates, by number, at places that were not used to choose them

    `look` sets all of these except positions, airs, surfaces and pierced.
    """

    def __init__(self, plan: Plan, folder=None, ranks: Optional[Ranks] = None,
                 progress: Optional[Callable[[str, int, int], Any]] = None, beside: Sequence[Sequence[str]] = ()):
        """Finds the candidates and checks the plan; `look` computes the shares. `Error` names the plan's file and the
        member.

        folder    holds each candidate's coverage, so that a stopped run can continue; required on several ranks
        progress  called with the name of the work, the completed amount and the total amount
        beside    words of further weathers that are computed but do not count
        """
        if not plan.runways:
            raise Error(f"{plan.file}: runways: is missing in the plan, expected a GeoJSON file, because sites are "
                        "compared by strips and approaches")
        self.plan, self.folder, self.ranks, self.mix = plan, folder, ranks or Ranks(), plan.mix
        self.progress = progress if progress and not self.ranks.rank else lambda *_: None
        self.options = plan.plan.get("siting", {})
        self.masts = tuple(self.options.get("masts", (5.0,)))
        self.settings = {name: value for name, value in plan.settings.items()
                         if name not in ("species", "all_species", "height_limits")}
        self.count, self.draws = int(self.options.get("sensors", 3)), int(self.options.get("draws", DRAWS))
        self.airs = plan.year or [Air(plan.air, 1.0, {})]
        if beside and not plan.year:
            own = {name: self.settings.get(name, value) for name, value in plan.air_of().items()}
            self.airs = [Air(plan.air, 1.0, own), *(Air(tuple(words), 0.0, plan.air_of(words)) for words in beside)]
        self.counting = [i for i, air in enumerate(self.airs) if air.share > 0.0]
        self.exclusions = _exclusions(plan, self.options)
        points, self.lattice = _points(plan, self.options)
        with naming(f"{plan.file}: siting"):
            self.positions = candidates(points, self.masts, self.exclusions, plan.scene)
            require_memory(4.0 * len(self.positions) * len(self.mix) * len(self.airs) * plan.count,
                           f"{len(self.positions):,} candidates, {len(self.mix)} species and {plan.count:,} places"
                           f"{f' in {len(self.airs)} weathers' if len(self.airs) > 1 else ''}",
                           "take a larger spacing, fewer masts or places")
        with naming(f"{plan.file}: siting.surfaces"):
            self._keep_below()
        self.varies_heights = False

        def as_it_is() -> float:  # called for each building height that is read from an attribute
            self.varies_heights = True
            return 0.0
        if self.draws:
            with naming(f"{plan.file}: scene"), tempfile.TemporaryDirectory() as copy:
                with_other_heights(plan.plan["scene"], copy, as_it_is)

    def _keep_below(self) -> None:
        """Leaves out candidates whose masts pierce an obstacle limitation surface."""
        asked = self.options.get("surfaces", True)
        self.changed = asked if isinstance(asked, dict) else {}  # changed parts of the surfaces
        self.surfaces = [Surfaces.of(runway, self.plan.scene, self.changed)
                         for runway in (self.plan.runways if asked is not False else ())]
        found = pierced(self.surfaces, self.positions)
        self.pierced = {name: int(np.count_nonzero(found == number)) for number, name in enumerate(NAMES, 1)
                        if self.surfaces and name in self.surfaces[0].kept}
        if found.all():
            raise Error(f"the masts of all {len(found)} candidates pierce a surface ({self.counted}): take lower masts "
                        "or wider bounds, change the surfaces, or switch the surfaces off (false)")
        self.positions = self.positions[found == 0]

    @property
    def counted(self) -> str:
        """The number of candidates that pierce each kind of surface, in words."""
        return ", ".join(f"{name} {count}" for name, count in self.pierced.items())

    def stands_wrong(self, position: Sequence[float]) -> bool:
        """Whether no candidate may stand at a place, m."""
        place = np.array([position], dtype=float)
        return bool(pierced(self.surfaces, place)[0]) or any(is_near(place, *near)[0] for near in self.exclusions)

    def look(self) -> Sites:
        """Computes the shares of all candidates, and compares networks. @return this object"""
        self.found, self.weights, self.regions = self._look(
            self.positions, self.airs, progress=lambda *done: self.progress("sites", *done))
        of_species = self.plan.weights(self.plan.points)
        every = self.found.reshape(len(self.positions), len(self.mix), len(self.airs), -1)
        self.by_air = self._shares_by_air(every, of_species)
        if len(self.counting) < len(self.airs):
            self.found = every[:, :, self.counting].reshape(len(self.positions), -1, every.shape[-1])
        self.values = values_of(self.found, self.weights)
        self.order = np.argsort(-self.values, kind="stable")
        first = search(self.found, self.weights, min(self.count, len(self.positions)), spots=self._spots())
        members = [site for network in first for site in network.sites]
        self.near = np.array(list(dict.fromkeys([*self.order[:NEAR], *members])))
        self.networks = self._search(self.found[self.near], self.weights, first)
        self._look_again()
        return self

    @staticmethod
    def _shares_by_air(found: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weighted shares, sites x weathers. @param found sites x species x weathers x places @param weights species x
        places, as one weather has them"""
        return np.array([[np.vdot(site[:, air].astype(float), weights) for air in range(found.shape[2])]
                         for site in found])

    def _look_again(self) -> None:
        """Computes the best sites and networks again, at places that were not used to choose them, and with clutter if
        the plan has clutter. The reported shares are these."""
        of_air = list(dict.fromkeys(map(int, [self.order[0], *np.argmax(self.by_air, axis=0)])))
        members = [site for network in self.networks for site in network.sites]
        with_masts = [site for _, site in self._best_with_masts()]
        told = list(dict.fromkeys(map(int, [*self.order[:BEST], *members, *with_masts, *of_air])))
        seed, clutter = self.plan.seed + OTHER_PLACES, {"clutter": self.plan.coverage.clutter}
        found, self.told_weights, _ = self._look(self.positions[told], None, seed, **clutter)
        self.told = dict(zip(told, found))
        points, _ = self.plan.places(seed)
        found, _, _ = self._look(self.positions[of_air], self.airs, seed, **clutter)
        every = found.reshape(len(of_air), len(self.mix), len(self.airs), -1)
        self.told_by_air = dict(zip(of_air, self._shares_by_air(every, self.plan.weights(points)).tolist()))
        airs, settings = [self.airs[i].settings for i in self.counting], {**self.settings, **clutter}
        with self.ranks.together():
            self.of_same_birds = [
                value_of_same_birds(self.plan.scene, self.plan.sensor, self.positions[list(network.sites)], points,
                                    list(self.mix), self.told_weights, airs, **settings) for network in self.networks]

    def share(self, sites: Sequence[int]) -> Tuple[float, float]:
        """The share of the birds that one scan of at least one site detects, and its standard error. @param sites
        numbers of best candidates or of members of networks"""
        missed: np.ndarray = np.prod([1.0 - self.told[int(site)].astype(float) for site in sites], axis=0)
        value = float(np.vdot(self.told_weights, 1.0 - missed))
        off = (self.told_weights * (1.0 - missed)).sum(axis=0) - value * self.told_weights.sum(axis=0)
        return value, float(np.sqrt(np.sum(off ** 2) * len(off) / (len(off) - 1)))

    def _look(self, positions, airs: Optional[List[Air]] = None, seed: Optional[int] = None, scene=None, progress=None,
              **settings: Any):
        """Coverage of sites, weights of places (species and weathers x places), and regions. @param airs default: the
        weathers that count @param seed seed of other places for the same question; default: the places of the plan"""
        points, ends = (self.plan.points, self.plan.ends) if seed is None else self.plan.places(seed)
        counting = [self.airs[i] for i in self.counting]
        shares = np.array([air.share for air in counting])
        weights = self.plan.weights(points)[:, None] * (shares / shares.sum())[:, None]
        found = look(scene or self.plan.scene, self.plan.sensor, positions, points, list(self.mix), self.folder,
                     self.ranks, progress, airs=[air.settings for air in airs or counting],
                     **{**self.settings, **settings})
        return found, weights.reshape(-1, len(points)), by_kind(ends)

    def _spots(self) -> np.ndarray:
        """A number for each candidate; masts at one place have one number."""
        return np.unique(self.positions[:, :2], axis=0, return_inverse=True)[1].ravel()

    def _search(self, found, weights, known=()) -> List[Network]:
        """The best networks of the near candidates."""
        best = search(found, weights, min(self.count, len(self.near)), 2 * NEAR, self._spots()[self.near])
        own = [Network(tuple(int(self.near[i]) for i in network.sites), network.value) for network in best]
        return [max(pair, key=lambda network: network.value) for pair in zip(own, known or own)]

    def changes(self) -> Iterator[Change]:
        """Tests whether other networks of the near candidates win with other building heights, mean effective areas or
        places: `draws` draws of each, uniform within HEIGHT_ERROR and AREA_ERROR."""
        random, done = np.random.default_rng(1), itertools.count(1)
        number = {int(site): i for i, site in enumerate(self.near)}
        for draw in range(self.draws):
            factor = round(random.uniform(1.0 - AREA_ERROR, 1.0 + AREA_ERROR), 6)
            kinds: Dict[str, Dict[str, Any]] = {}
            if self.varies_heights:
                with tempfile.TemporaryDirectory() as folder:
                    other = load_scene(with_other_heights(
                        self.plan.plan["scene"], folder, lambda: random.uniform(-HEIGHT_ERROR, HEIGHT_ERROR)))
                    other.refresh()
                kinds[f"building heights ±{HEIGHT_ERROR:g} m"] = {"scene": other}
            kinds[f"effective area ±{100 * AREA_ERROR:g} %"] = {"area_factor": factor}
            kinds["other places"] = {"seed": self.plan.seed + draw + 1}
            for what, settings in kinds.items():
                found, weights, _ = self._look(self.positions[self.near], **settings)
                self.progress("draws", next(done), len(kinds) * self.draws)
                for before, winner in zip(self.networks, self._search(found, weights)):
                    yield Change(what, winner, value_of(found, weights, [number[s] for s in before.sites]))

    def difference(self, site: int) -> Tuple[float, float]:
        """How much less one of the best sites detects than the first site, and the standard error at the same places.
        The difference may be negative, because these places were not used to rank the sites."""
        less = (self.told_weights * (self.told[int(self.order[0])].astype(float) - self.told[site])).sum(axis=0)
        return float(less.sum()), float(np.sqrt(len(less) * np.var(less)))

    def count_alike(self) -> int:
        """The number of other candidates within twice the standard error of the best, where sites are ranked."""
        first = self.found[self.order[0]].astype(float)
        all_less = (((first - self.found[site]) * self.weights).sum(axis=0) for site in self.order[1:])
        return sum(bool(less.sum() <= 2.0 * np.sqrt(sum(len(of) * np.var(less[of]) for of in self.regions.values())))
                   for less in all_less)

    def rank_of(self, site: int) -> int:
        """The rank of a site, 1 for the best candidate."""
        return int(np.flatnonzero(self.order == site)[0]) + 1

    def gain(self) -> List[Dict[str, Any]]:
        """A row for each number of sensors."""
        return [{"sensors": len(n.sites), **dict(zip(("value", "std_error"), self.share(n.sites))),
                 "value of the same birds": same, "ranks of the sites": " ".join(str(self.rank_of(i)) for i in n.sites),
                 "sites": "; ".join(" ".join(rounded(place)) for place in self.positions[list(n.sites)])}
                for n, same in zip(self.networks, self.of_same_birds)]

    def robustness(self, changes: List[Change]) -> List[Dict[str, Any]]:
        """A row for each kind of change and number of sensors: draws, how often another network wins, and its greatest
        lead as a share of the original winner's value. Empty for fewer than FEWEST_DRAWS draws."""
        alike: Dict[Tuple[str, int], List[Change]] = {}
        for change in changes:
            alike.setdefault((change.what, len(change.winner.sites)), []).append(change)
        return [{"change": what, "sensors": size, "draws": len(of),
                 "another winner": sum(one.is_another(self.networks) for one in of),
                 "gain at most": max(one.winner.value / one.value - 1.0 if one.value > 0.0 else 0.0 for one in of)}
                for (what, size), of in alike.items() if len(of) >= FEWEST_DRAWS]

    @property
    def at_the_edge(self) -> bool:
        """Whether the best candidate lies at the edge of the lattice, so that a better candidate may lie beyond."""
        if "points" in self.options:
            return False
        bounds = np.array(self.options.get("bounds", self.plan.extent)).reshape(2, 2)
        spacing = float(self.options.get("spacing", SPACING))
        place = self.positions[self.order[0], :2]
        return bool(((place - bounds[:, 0] < spacing) | (bounds[:, 1] - place < spacing)).any())

    def _best_with_masts(self) -> List[Tuple[float, int]]:
        """Each mast with its best candidate. Masts without a candidate are left out."""
        above = self.positions[:, 2] - np.nan_to_num(ground_of(self.plan.scene, self.positions[:, :2]))
        found = [(mast, np.flatnonzero(np.abs(above - mast) < SAME_PLACE)) for mast in self.masts]
        return [(mast, int(numbers[np.argmax(self.values[numbers])])) for mast, numbers in found if len(numbers)]

    def best_by_mast(self) -> List[Dict[str, Any]]:
        """The best candidate with each mast: height of the mast above the ground, m, place, m, and share."""
        return [{"mast": mast, "position": self.positions[site], "share": self.share([site])}
                for mast, site in self._best_with_masts()]

    @property
    def higher_mast(self) -> List[str]:
        """A sentence if the best candidate has the highest mast of the plan, so that a higher mast may be better."""
        masts = self.best_by_mast()
        best = next((row["mast"] for row in masts
                     if np.array_equal(row["position"], self.positions[self.order[0]])), None)
        if best is None or best < max(self.masts):
            return []
        which = "highest" if len(self.masts) > 1 else "only"
        return [f"The best site has the {which} mast of the plan ({best:g} m): a higher mast may be better. Add its "
                "height to siting.masts."]

    def over_the_year(self, order, species: int, places) -> np.ndarray:
        """The mean share of some places at each site over the year. @param order of the sites @param species number of
        the species @param places numbers of the places"""
        shares = [self.airs[i].share for i in self.counting]
        of_species = self.found[:, species * len(shares):(species + 1) * len(shares)]
        each = (share * of_species[order, air][:, places].mean(axis=1, dtype=float) for air, share in enumerate(shares))
        return sum(each, np.zeros(len(order))) / sum(shares)

    def best_by_air(self) -> List[Dict[str, Any]]:
        """A row for each weather: the best site in this weather, and what the first site detects there."""
        return [{"weather": air.name, "share": air.share, "site": int(site), "value": self.told_by_air[int(site)][k],
                 "value of the first": self.told_by_air[int(self.order[0])][k]}
                for k, (air, site) in enumerate(zip(self.airs, np.argmax(self.by_air, axis=0)))]
