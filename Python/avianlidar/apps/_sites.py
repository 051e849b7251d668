# SPDX-License-Identifier: BSD-3-Clause
"""Search for sites of lidars: a plan's `siting`, the command `avianlidar siting`."""
from __future__ import annotations

import csv
import dataclasses
import io
import itertools
import pathlib
import tempfile
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np

from .._files import read_regular
from .._pipeline import Error
from .._ranks import Ranks
from .._scene import load_scene
from . import _pictures
from ._air import Air
from ._candidates import MOST_CANDIDATES, NAMES, SAME_PLACE, Surfaces, candidates, ground_of, is_near, lattice, pierced, table
from ._geojson import read_outlines, with_other_heights
from ._json import naming
from ._looks import look, require_memory, value_of_same_birds
from ._networks import Network, search, value_of, values_of
from ._plan import Plan
from ._regions import by_kind, rounded, runway_outline
from ._tables import write_sites, write_table

NEAR = 40  # number of candidates, best alone, whose networks of one to three are compared, together with the members of the best network
DRAWS = 10
FEWEST_DRAWS = 10  # least number of draws that shows how sure a winner is
BEST = 10  # number of sites whose shares are shown
OTHER_PLACES = 1 << 40  # offset of the seed for places that were not used to choose sites
SPACING = 200.0  # default spacing of the lattice, m
HEIGHT_ERROR = 5.0  # error of building heights, m; assumed
AREA_ERROR = 0.2  # relative error of the mean effective area; assumed

Progress = Callable[[str, int, int], Any]


@dataclasses.dataclass(frozen=True)
class Change:
    """The effect of a draw of other heights, areas or places on networks of one size."""

    what: str
    draw: int
    winner: Network  # best network, with its value in this draw
    value: float  # value of the original winner in this draw

    def is_another(self, networks: List[Network]) -> bool:
        """Whether a different network wins."""
        return sorted(self.winner.sites) != sorted(networks[len(self.winner.sites) - 1].sites)


def listed(words: Sequence[str]) -> str:
    """a, b and c."""
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def _read_points(name: str) -> np.ndarray:
    """The columns x and y of a CSV file, n x 2, m."""
    text = read_regular(name)
    try:
        table = csv.DictReader(io.StringIO(text.decode("utf-8-sig"), newline=""), skipinitialspace=True)
        rows = itertools.islice(table, MOST_CANDIDATES + 1)
        points = np.array([(float(row["x"]), float(row["y"])) for row in rows]).reshape(-1, 2)
    except (KeyError, TypeError, ValueError, csv.Error) as error:
        raise Error(f"{name}: expected the columns x and y in the first line and numbers (m) below ({error})") from None
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if not len(points):
        raise Error(f"{name}: has no rows, expected numbers (m) below the first line")
    if len(wrong):
        raise Error(f"{name}: row {wrong[0] + 1} is not finite, expected numbers (m)")
    return points


class Sites:
    """Candidates of a plan, and the shares that lidars at the candidates would detect.

    positions  n x 3, m, in the order of the lattice   networks  the best of 1, 2, ... sensors
    values     weighted share of each candidate alone  order     candidates from the best to the worst
    airs       weathers with their shares of the year  by_air    weighted share of each candidate alone in each weather
    surfaces   of each runway, limiting the masts      pierced   number of candidates left out for each kind of surface, by name
    told       shares of the best candidates, by number, at places that were not used to choose them

    `look` sets all of these except positions, airs and surfaces.
    """

    def __init__(self, plan: Plan, folder=None, ranks: Optional[Ranks] = None, progress: Optional[Progress] = None,
                 beside: Sequence[Sequence[str]] = ()):
        """Finds the candidates and checks the plan; `look` computes the shares. `Error` names the plan's
        file and the member.

        folder    holds each candidate's coverage, so that a stopped run can continue; required on several ranks
        progress  called with the name of the work, the completed amount and the total amount
        beside    words of further weathers that are computed but do not count
        """
        if not plan.runways:
            raise Error(f"{plan.file}: runways: is missing in the plan, expected a GeoJSON file, because sites are compared by strips and "
                        "approaches")
        self.plan, self.folder, self.ranks, self.progress = plan, folder, ranks or Ranks(), progress
        self.options = plan.plan.get("siting", {})
        self.mix = plan.mix
        self.masts = tuple(self.options.get("masts", (5.0,)))
        self.settings = {name: value for name, value in plan.settings.items()
                         if name not in ("species", "all_species", "height_limits", "number_of_threads")}
        self.count = int(self.options.get("sensors", 3))
        self.airs = plan.year or [Air(plan.air, 1.0, {})]
        if beside and not plan.year:
            self.airs = [Air(plan.air, 1.0, {name: self.settings.get(name, value) for name, value in plan.air_of().items()}),
                         *(Air(tuple(words), 0.0, plan.air_of(words)) for words in beside)]
        self.counting = [i for i, air in enumerate(self.airs) if air.share > 0.0]
        self.exclusions = self._exclusions()
        points = self._points()
        with naming(f"{plan.file}: siting"):
            self.positions = candidates(points, self.masts, self.exclusions, plan.scene)
            require_memory(4.0 * len(self.positions) * len(self.mix) * len(self.airs) * plan.count,
                                  f"{len(self.positions):,} candidates, {len(self.mix)} species and {plan.count:,} places"
                                  + (f" in {len(self.airs)} weathers" if len(self.airs) > 1 else ""),
                                  "take a larger spacing, fewer masts or places")
        with naming(f"{plan.file}: siting.surfaces"):
            self._keep_below()
        if self.options.get("draws", DRAWS):
            with naming(f"{plan.file}: scene"), tempfile.TemporaryDirectory() as copy:
                with_other_heights(plan.plan["scene"], copy, lambda: 0.0)  # as `changes` will do

    def _keep_below(self) -> None:
        """Leaves out candidates whose masts pierce an obstacle limitation surface."""
        asked = self.options.get("surfaces", True)
        self.changed = asked if isinstance(asked, dict) else {}  # changed parts of the surfaces
        self.surfaces = [Surfaces.of(runway, self.plan.scene, self.changed) for runway in self.plan.runways] if asked is not False else []
        found = pierced(self.surfaces, self.positions)
        self.pierced = {name: int(np.count_nonzero(found == number)) for number, name in enumerate(NAMES, 1)
                        if self.surfaces and name in self.surfaces[0].kept}
        if found.all():
            raise Error(f"the masts of all {len(found)} candidates pierce a surface ({self._counted()}): take lower "
                        "masts or wider bounds, change the surfaces, or switch the surfaces off (false)")
        self.positions = self.positions[found == 0]

    def _counted(self) -> str:
        return ", ".join(f"{name} {count}" for name, count in self.pierced.items())

    @property
    def kept_surfaces(self) -> str:
        """Words on the surfaces that masts stay below, the code numbers of runways, and the number of candidates that pierce a surface."""
        if not self.pierced:
            return "no surface is used, because the plan switches the surfaces off"
        code = "code number" if "code" in self.changed else "code number by its length, assumed:"
        category = self.surfaces[0].category + ("" if "category" in self.changed else " (assumed)")
        changed = [name for name in self.pierced if isinstance(self.changed.get(name), dict)]
        return (f"masts keep below {', '.join(self.pierced)} surfaces of ICAO Annex 14 ({table()['year']}) for {category} approaches, "
                f"{'; '.join(f'{one.runway.name}: {code} {one.code}' for one in self.surfaces)}"
                f"{'; the plan changes ' + ', '.join(changed) if changed else ''}; {sum(self.pierced.values())} of "
                f"{sum(self.pierced.values()) + len(self.positions)} candidates pierced a surface and are left out ({self._counted()})")

    @property
    def surface_sentence(self) -> str:
        """Sentence on the checks of the place of a mast, for the first page."""
        if not self.pierced:
            return "The site is clear of runways, buildings and the plan's exclusions. The plan switches obstacle limitation surfaces off"
        assumed = "" if "category" in self.changed else ", assumed"
        return (f"The mast stays below the {listed(list(self.pierced))} surfaces of ICAO Annex 14 "
                f"({self.surfaces[0].category} approaches{assumed}), which {sum(self.pierced.values())} other candidates pierce "
                f"({self._counted()}), and is clear "
                "of buildings and the plan's exclusions")

    def stands_wrong(self, position: Sequence[float]) -> bool:
        """Whether no candidate may stand at a place, m."""
        place = np.array([position], dtype=float)
        return bool(pierced(self.surfaces, place)[0]) or any(is_near(place, outline, margin)[0] for outline, margin in self.exclusions)

    def look(self) -> Sites:
        """Computes the shares of all candidates, and compares networks. @return this object"""
        self.found, self.weights, self.regions = self._look(self.positions, self.airs, progress=lambda *done: self._tell("sites", *done))
        of_species = self.plan.weights(self.plan.points)
        every = self.found.reshape(len(self.positions), len(self.mix), len(self.airs), -1)
        self.by_air = np.array([[np.vdot(site[:, air].astype(float), of_species) for air in range(len(self.airs))] for site in every])
        if len(self.counting) < len(self.airs):
            self.found = every[:, :, self.counting].reshape(len(self.positions), -1, every.shape[-1])
        self.values = values_of(self.found, self.weights)
        self.order = np.argsort(-self.values, kind="stable")
        first = search(self.found, self.weights, min(self.count, len(self.positions)))
        members = [site for network in first for site in network.sites]
        self.near = np.array(list(dict.fromkeys([*self.order[:NEAR], *members])))
        self.networks = self._search(self.found[self.near], self.weights, first)
        self._look_again()
        return self

    def _look_again(self) -> None:
        """Computes the best sites and networks again, at places that were not used to choose them, and with clutter if the plan has
        clutter. The reported shares are these."""
        of_air = list(dict.fromkeys(map(int, [self.order[0], *np.argmax(self.by_air, axis=0)])))
        numbers = [*self.order[:BEST], *(site for network in self.networks for site in network.sites), *(site for _, site in self._best_with_masts()), *of_air]
        told = list(dict.fromkeys(map(int, numbers)))
        seed, clutter = self.plan.seed + OTHER_PLACES, {"clutter": self.plan.coverage.clutter}
        found, self.told_weights, _ = self._look(self.positions[told], None, seed, **clutter)
        self.told = dict(zip(told, found))
        points, _ = self.plan.places(seed)
        of_species = self.plan.weights(points)
        found = self._look(self.positions[of_air], self.airs, seed, **clutter)[0].reshape(len(of_air), len(self.mix), len(self.airs), -1)
        self.told_by_air = {site: [float(np.vdot(of[:, air].astype(float), of_species)) for air in range(len(self.airs))] for site, of in zip(of_air, found)}
        with self.ranks.together():
            self.of_same_birds = [value_of_same_birds(self.plan.scene, self.plan.sensor, self.positions[list(network.sites)], points,
                                                             list(self.mix), self.told_weights, [self.airs[i].settings for i in self.counting],
                                                             **{**self.settings, **clutter})
                                  for network in self.networks]

    def share(self, sites: Sequence[int]) -> Tuple[float, float]:
        """The share of the birds that one scan of at least one of the sites detects, and its standard error. @param sites numbers of best
        candidates or of members of networks"""
        missed: np.ndarray = np.prod([1.0 - self.told[int(site)].astype(float) for site in sites], axis=0)
        of_place = self.told_weights.sum(axis=0)
        value = float(np.vdot(self.told_weights, 1.0 - missed))
        off = (self.told_weights * (1.0 - missed)).sum(axis=0) - value * of_place
        return value, float(np.sqrt(np.sum(off ** 2) * len(off) / (len(off) - 1)))

    def _tell(self, what: str, done: int, total: int) -> None:
        if self.progress and self.ranks.rank == 0:
            self.progress(what, done, total)

    def _points(self) -> np.ndarray:
        if "points" not in self.options:
            with naming(f"{self.plan.file}: siting.spacing"):
                return lattice(self.options.get("bounds", self.plan.extent), self.options.get("spacing", SPACING))
        with naming(f"{self.plan.file}: siting.points"):
            return _read_points(self.options["points"])

    def _exclusions(self) -> List[Tuple[np.ndarray, float]]:
        """Outlines (m) where no lidar may stand, each with its margin (m)."""
        origin, margin = self.plan.scene.geodetic_origin, float(self.options.get("margin", 0.0))
        with naming(f"{self.plan.file}: runways"):
            outlines = read_outlines(self.plan.plan["runways"], origin, "height")
        for number, file in enumerate(self.options.get("exclusions", ())):
            with naming(f"{self.plan.file}: siting.exclusions[{number}]"):
                found = read_outlines(file, origin)
                if not found:
                    raise Error(f"{file}: holds no polygon, expected some where no lidar may stand")
                outlines += found
        return [(outline, margin) for outline in outlines] + [(runway_outline(r, 0.0, r.width / 2.0), 0.0) for r in self.plan.runways]

    def _look(self, positions, airs: Optional[List[Air]] = None, seed: Optional[int] = None, scene=None, progress=None, **settings: Any):
        """Coverage of sites, weights and regions. @param airs default: the weathers that count"""
        points, weights, regions = self._draw(seed)
        settings_of = [air.settings for air in airs or [self.airs[i] for i in self.counting]]
        found = look(scene or self.plan.scene, self.plan.sensor, positions, points, list(self.mix), self.folder, self.ranks,
                            progress, airs=settings_of, **{**self.settings, **settings})
        return found, weights, regions

    def _draw(self, seed: Optional[int] = None):
        """Places, their weights (species and weathers x places) and regions: those of the plan's table, or other places for the same
        question."""
        points, ends = (self.plan.points, self.plan.ends) if seed is None else self.plan.places(seed)
        shares = np.array([self.airs[i].share for i in self.counting])
        weights = self.plan.weights(points)[:, None] * (shares / shares.sum())[:, None]
        return points, weights.reshape(-1, len(points)), by_kind(ends)

    def _search(self, found, weights, known=()) -> List[Network]:
        """The best networks of the near candidates."""
        best = search(found, weights, min(self.count, len(self.near)), 2 * NEAR)
        own = [Network(tuple(int(self.near[i]) for i in network.sites), network.value) for network in best]
        return [max(pair, key=lambda network: network.value) for pair in zip(own, known or own)]

    def changes(self) -> Iterator[Change]:
        """Tests whether other networks of the near candidates win with other building heights, mean effective areas or places:
        `draws` draws of each, uniform within HEIGHT_ERROR and AREA_ERROR."""
        random = np.random.default_rng(1)
        draws = int(self.options.get("draws", DRAWS))
        for draw in range(draws):
            factor = round(random.uniform(1.0 - AREA_ERROR, 1.0 + AREA_ERROR), 6)
            offsets: List[float] = []

            def offset(offsets=offsets):
                offsets.append(random.uniform(-HEIGHT_ERROR, HEIGHT_ERROR))
                return offsets[-1]
            with tempfile.TemporaryDirectory() as folder:
                other = load_scene(with_other_heights(self.plan.plan["scene"], folder, offset))
                other.refresh()
            kinds: List[Tuple[str, Dict[str, Any]]] = [
                (f"building heights ±{HEIGHT_ERROR:g} m", {"scene": other}),
                (f"effective area ±{100 * AREA_ERROR:g} %", {"area_factor": factor}),
                ("other places", {"seed": self.plan.seed + draw + 1})]
            if not offsets:  # no building height of this scene is read from an attribute
                kinds = kinds[1:]
            for k, (what, settings) in enumerate(kinds):
                found, weights, _ = self._look(self.positions[self.near], **settings)
                self._tell("draws", len(kinds) * draw + k + 1, len(kinds) * draws)
                number = {int(site): i for i, site in enumerate(self.near)}
                for before, winner in zip(self.networks, self._search(found, weights)):
                    yield Change(what, draw, winner, value_of(found, weights, [number[s] for s in before.sites]))

    def difference(self, site: int) -> Tuple[float, float]:
        """How much less one of the best sites detects than the first site, and the standard error of the difference at the same places.
        The difference may be negative, because these places were not used to rank the sites."""
        less = (self.told_weights * (self.told[int(self.order[0])].astype(float) - self.told[site])).sum(axis=0)
        return float(less.sum()), float(np.sqrt(len(less) * np.var(less)))

    def count_alike(self) -> int:
        """The number of other candidates within twice the standard error of the best, at the places that were used for ranking."""
        first = self.found[self.order[0]].astype(float)
        all_less = (((first - self.found[site]) * self.weights).sum(axis=0) for site in self.order[1:])
        return sum(bool(less.sum() <= 2.0 * np.sqrt(sum(len(members) * np.var(less[members]) for members in self.regions.values())))
                   for less in all_less)

    def rank_of(self, site: int) -> int:
        """The rank of a site, 1 for the best candidate."""
        return int(np.flatnonzero(self.order == site)[0]) + 1

    def gain(self) -> List[Dict[str, Any]]:
        """A row for each number of sensors."""
        shares = [self.share(n.sites) for n in self.networks]
        return [{"sensors": len(n.sites), "value": value, "std_error": error, "value of the same birds": same,
                 "ranks of the sites": " ".join(str(self.rank_of(i)) for i in n.sites),
                 "sites": "; ".join(" ".join(rounded(place)) for place in self.positions[list(n.sites)])}
                for n, (value, error), same in zip(self.networks, shares, self.of_same_birds)]

    def robustness(self, changes: List[Change]) -> List[Dict[str, Any]]:
        """A row for each kind of change and number of sensors: draws, how often another network wins, and its greatest lead as a share of
        the original winner's value. Empty for fewer than FEWEST_DRAWS draws, which would show nothing."""
        alike: Dict[Tuple[str, int], List[Change]] = {}
        for change in changes:
            alike.setdefault((change.what, len(change.winner.sites)), []).append(change)
        return [{"change": what, "sensors": size, "draws": len(of), "another winner": sum(one.is_another(self.networks) for one in of),
                 "gain at most": max(one.winner.value / one.value - 1.0 if one.value > 0.0 else 0.0 for one in of)}
                for (what, size), of in alike.items() if len(of) >= FEWEST_DRAWS]

    @property
    def lattice(self) -> str:
        """The origin of the candidates, in words."""
        if "points" in self.options:
            return f"the places of {pathlib.Path(self.options['points']).name}"
        return f"a lattice of {self.options.get('spacing', SPACING):g} m"

    def words(self) -> Dict[str, str]:
        """Words on the birds, candidates and conditions of the values."""
        files = [f"the buildings (polygons with a height) of {pathlib.Path(self.plan.plan['runways']).name}",
                 *(f"the polygons of {pathlib.Path(name).name}" for name in self.options.get("exclusions", ()))]
        return {"sensor": self.plan.name, "birds (sizes assumed)": f"{self.plan.bird} {self.plan.where}",
                "candidates": f"{len(self.positions)}, of {self.lattice}; places between the candidates were not computed",
                "masts": ", ".join(f"{mast:g} m" for mast in self.masts) + " above the ground below",
                **({"weather": "by the year's share of the hours: " + "; ".join(f"{air.name} {100 * air.share:.3g} %" for air in self.plan.year)}
                   if self.plan.year else {"weather": self.airs[0].name} if self.plan.air else {}),
                "clutter": "counted" if self.settings.get("clutter") else "not counted",
                "nothing may stand": f"on runways, under surfaces of the scene, and within {self.options.get('margin', 0.0):g} m of {' and '.join(files)}",
                "obstacle limits": self.kept_surfaces}

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
        ground = np.nan_to_num(ground_of(self.plan.scene, self.positions[:, :2]))
        of = self.positions[:, 2] - ground
        found = [(mast, np.flatnonzero(np.abs(of - mast) < SAME_PLACE)) for mast in self.masts]
        return [(mast, int(numbers[np.argmax(self.values[numbers])])) for mast, numbers in found if len(numbers)]

    def best_by_mast(self) -> List[Dict[str, Any]]:
        """The best candidate with each mast: height of the mast above the ground, m, place, m, and share."""
        return [{"mast": mast, "position": self.positions[site], "share": self.share([site])} for mast, site in self._best_with_masts()]

    def _over_the_year(self, order, species: int, places) -> np.ndarray:
        """The mean share of some places at each site over the year. @param order of the sites @param species number of the species @param
        places numbers of the places"""
        total = np.zeros(len(order))
        for k, air in enumerate(self.counting):
            of = self.found[:, species * len(self.counting) + k]
            total += self.airs[air].share * of[order][:, places].mean(axis=1, dtype=float)
        return total / sum(self.airs[air].share for air in self.counting)

    def best_by_air(self) -> List[Dict[str, Any]]:
        """A row for each weather: the best site in this weather, and the share of the first site of the order in this weather."""
        return [{"weather": air.name, "share": air.share, "site": int(site), "value": self.told_by_air[int(site)][k],
                 "value of the first": self.told_by_air[int(self.order[0])][k]}
                for k, (air, site) in enumerate(zip(self.airs, np.argmax(self.by_air, axis=0)))]

    def write(self, folder, changes: List[Change]) -> None:
        """Writes sites (CSV, VTP, GeoJSON) by rank, gain.csv, robustness.csv, and pictures of sites and gain."""
        folder = pathlib.Path(folder)
        order = self.order
        columns: Dict[str, Any] = {"rank": np.arange(1, len(order) + 1), "value": self.values[order],
                                   "in_network": np.isin(order, self.networks[-1].sites).astype(np.int32)}
        for k, name in enumerate(self.mix):
            for region, numbers in self.regions.items():
                columns[f"{name or 'target'}_{region}".replace(" ", "_")] = self._over_the_year(order, k, numbers)
        if len(self.airs) > 1:
            for k, air in enumerate(self.airs):
                columns["_".join(["value", *(air.words or ("plan",))]).replace(":", "_")] = self.by_air[order, k]
        write_sites(folder, self.positions[order], columns, self.plan.scene.geodetic_origin,
                           "; ".join(f"{name}: {text}" for name, text in self.words().items()))
        write_table(folder / "gain.csv", self.gain())
        write_table(folder / "robustness.csv", self.robustness(changes))
        _pictures.draw(folder / "sites.png", _pictures.map_size(_pictures.sites_extent(self), 4.6, 0.8, 0.3), lambda axes: _pictures.draw_sites(axes, self))
        _pictures.draw(folder / "gain.png", (4.4, 2.8), lambda axes: _pictures.draw_gain(axes, self))
