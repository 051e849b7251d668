# SPDX-License-Identifier: BSD-3-Clause
"""Lidar designs within bounds, with shares and costs: a plan's `design`, the command `avianlidar design`."""
from __future__ import annotations

import dataclasses
import hashlib
import itertools
import math
import os
import pathlib
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ..._coverage import Coverage, places_of
from ..._pipeline import Error, Updates, update
from ..._ranks import Ranks
from ..._sensor import Sensor
from ..inputs._air import Air, gathers_light
from ..inputs._json import naming
from ..inputs._read import read_plan, read_scenario
from ..inputs._tables import read_table
from ..sequences import _scores as scores
from ..sequences._tracks import LEARNING, BirdTracks
from ._formula import Formula
from ._looks import files_of, fill, require_memory
from ._plan import OTHER_PLACES, Plan

DESIGNS = 128
FINALISTS = 5  # number of designs that are tracked
LIGHTS = 4  # designs of one geometry that are computed together: the differences change no line of sight and no hit
TOLD = 2.0  # standard errors by which a share must lie above or below the required share to be decided
CHANGE = 0.2  # change of a number to either side, for sensitivities
MOST_SCANS = 100  # greatest NumberOfScans of vtkAvianLidarCoverage
PUPIL = math.pi * 0.0035 ** 2  # area of a pupil in the dark, 7 mm across, m2

Progress = Callable[[str, int, int], Any]


class Field(NamedTuple):
    """A number of a design."""

    unit: str
    words: str
    light: bool  # whether a change of the number leaves all hits of beams unchanged
    shown: Tuple[float, str]  # factor and unit on pages
    least: float = 0.0  # lower limit of the number, exclusive
    whole: bool = False

    def text(self, value: float) -> str:
        """A value with its unit, for a reader."""
        return f"{self.shown[0] * value:.4g}{self.shown[1]}"


FIELDS = {
    "mast": Field("m", "mast above the ground", False, (1.0, " m")),
    "number_of_channels": Field("1", "beams above one another", False, (1.0, ""), whole=True),
    "minimum_elevation": Field("deg", "elevation of the lowest beams", False, (1.0, "°"), -90.0),
    "maximum_elevation": Field("deg", "elevation of the highest beams", False, (1.0, "°"), -90.0),
    "azimuth_step": Field("deg", "step in azimuth", False, (1.0, "°")),
    "half_beamwidth": Field("rad", "half beamwidth", False, (1e3, " mrad")),
    "receiver_aperture": Field("m2", "area of the receiver's aperture", True, (1e4, " cm²")),
    "pulse_energy": Field("J", "energy of a pulse", True, (1e3, " mJ")),
    "rotation_rate": Field("Hz", "scans a second", True, (1.0, ""))}
BAND = ("number_of_channels", "minimum_elevation", "maximum_elevation")
PULSES = ("pulse_rate", "average_power")  # further names for formulas: mean pulses a second, Hz, and average power, W


def spread(number: int, count: int) -> np.ndarray:
    """Points first, first + 1, ... of a sequence that fills the unit cube evenly: the additive recurrence k -> frac(1/2
    + k a) with a_j = phi^-(j + 1), phi^(d + 1) = phi + 1 (M. Roberts, 2018). A longer sequence begins with the same
    points. @param number number of dimensions, d @param count number of points @return count x d"""
    phi = 2.0
    for _ in range(100):
        phi = (1.0 + phi) ** (1.0 / (number + 1))
    return np.modf(0.5 + np.outer(np.arange(1, count + 1), phi ** -np.arange(1.0, number + 1.0)))[0]


def on_the_front(costs, shares) -> np.ndarray:
    """For each design, whether no other design has at least the same share at a lower cost, or a larger share at no
    higher cost: n of bool. A design with NaN is never on the front."""
    costs, shares = np.asarray(costs, float), np.asarray(shares, float)
    order, found = np.lexsort((-shares, costs)), np.zeros(len(costs), bool)
    order = order[np.isfinite(costs + shares)[order]]
    # The cheapest design with at least the share of each design.
    first = order[np.searchsorted(np.maximum.accumulate(shares[order]), shares[order])]
    found[order] = (shares[first] == shares[order]) & (costs[first] == costs[order])
    return found


def is_told(share: float, error: float, asked: float) -> Optional[bool]:
    """Whether a share is at least the required share; None if the share differs by less than its error."""
    if share - TOLD * error >= asked:
        return True
    if share + TOLD * error < asked:
        return False
    return None


@dataclasses.dataclass
class Candidate:
    """A design: its numbers by FIELDS, its cost, its pulses, and the shares of birds detected and tracked."""

    number: int
    values: Dict[str, float]
    cost: float = math.nan
    # pulse_rate Hz, shortest_interval s, average_power W, exit_aperture m2, exposure J/m2, pupil J
    pulses: Dict[str, float] = dataclasses.field(default_factory=dict)
    refused: str = ""  # reason why the sensor refuses the design
    share: scores.Value = scores.Value(math.nan, math.nan, 0)
    tracked: scores.Value = scores.Value(math.nan, math.nan, 0)
    front: bool = False


class Study:
    """Designs of a plan within its bounds; `look` computes the shares.

    candidates  all designs             base     numbers of the plan's own sensor
    swept       names of the FIELDS that differ, in the order of FIELDS
    chosen      after `look`: the cheapest design with the required share, None without such a design
    """

    def __init__(self, plan: Union[Plan, str, "os.PathLike[str]"], folder, ranks: Optional[Ranks] = None,
                 progress: Optional[Progress] = None):
        """Checks all that the plan says of its designs, and computes their costs. `Error` names the plan's file and the
        member.

        plan      a plan's file, or a Plan, whose sensor is left with the last computed design
        folder    holds the results of each design, so that a stopped run can continue, and the written files
        progress  called with the name of the work, the completed amount and the total amount
        """
        plan = plan if isinstance(plan, Plan) else Plan(read_plan(plan))
        if "design" not in plan.plan:
            raise Error(f"{plan.file}: design: is missing in the plan, expected share, bounds and cost of designs")
        self.plan, self.folder, self.ranks = plan, pathlib.Path(folder), ranks or Ranks()
        self.progress: Progress = progress if progress and not self.ranks.rank else lambda *_: None
        self.options: Dict[str, Any] = plan.plan["design"]
        self.asked, self.measure = float(self.options["share"]), self.options.get("measure", "detected")
        self.within, self.unit = float(self.options.get("within", 0.0)), str(self.options.get("cost_unit", ""))
        self.airs = plan.year or [Air(plan.air, 1.0, {})]
        sensor, self.ground = plan.sensor, plan.ground or 0.0
        highest = sensor.minimum_elevation + (sensor.number_of_channels - 1) * sensor.elevation_step
        ours = {"mast": sensor.position[2] - self.ground, "maximum_elevation": highest}
        self.base = {name: ours[name] if name in ours else float(getattr(sensor, name)) for name in FIELDS}
        self.swept = [name for name in FIELDS if name in self.options["bounds"]]
        self.levels = {name: self._levels(name) for name in self.swept}
        self._check()
        names = [*FIELDS, *PULSES]
        with naming(f"{plan.file}: design.cost"):
            self.cost = Formula(self.options["cost"], names)
        with naming(f"{plan.file}: design.exit_aperture"):
            self.exit = Formula(str(self.options.get("exit_aperture", "receiver_aperture")), names)
        self.candidates = [Candidate(number, values) for number, values in enumerate(self._all_values())]
        for one in self.candidates:
            self._judge(one)
        if all(one.refused for one in self.candidates):
            raise Error(f"{plan.file}: design.bounds: contain no possible lidar: {self.candidates[0].refused}")
        self.scenario = self._scenario() if self.measure == "tracked" else {}

    def _ends(self, name: str) -> List[float]:
        """Values of a bound, or its ends; for a number that is not varied, the sensor's own value."""
        given = self.options["bounds"].get(name, [self.base[name]])
        return [float(value) for value in (given if isinstance(given, list) else (given["from"], given["to"]))]

    def _levels(self, name: str) -> Callable[[float], float]:
        """Function from 0 to 1 onto all values of a bound. Checks the bound."""
        what, given = f"{self.plan.file}: design.bounds.{name}", self.options["bounds"][name]
        field, ends = FIELDS[name], self._ends(name)
        broken = [value for value in ends if not value.is_integer()]
        if min(ends) <= field.least:
            raise Error(f"{what}: holds {min(ends):g}, expected values above {field.least:g} {field.unit}")
        if field.whole and broken:
            raise Error(f"{what}: holds {broken[0]:g}, expected whole numbers")
        if isinstance(given, list):
            return lambda u: ends[min(int(u * len(ends)), len(ends) - 1)]
        low, high = ends
        logarithmic = given.get("logarithmic", False)
        if not low < high:
            raise Error(f"{what}: is from {low:g} to {high:g}, expected the smaller one first")
        if logarithmic and not low > 0.0:
            raise Error(f"{what}: begins at {low:g}, expected a number above 0 where it is logarithmic")
        levels = int(given.get("levels", 0))

        def at(u: float) -> float:
            part = min(int(u * levels), levels - 1) / (levels - 1) if levels else u
            if field.whole and not levels:
                return min(low + math.floor(u * (high - low + 1.0)), high)
            value = low * (high / low) ** part if logarithmic else low + part * (high - low)
            return float(round(value)) if field.whole else value
        return at

    def _check(self) -> None:
        """Checks the bounds together."""
        what, sensor = f"{self.plan.file}: design", self.plan.sensor
        regular = not sensor.channel_elevations and sensor._beams is None and not sensor.algorithm.GetNumberOfPrisms()
        of_band = [name for name in (*BAND, "azimuth_step") if name in self.swept]
        if of_band and not regular:
            raise Error(f"{what}.bounds.{of_band[0]}: the sensor's beams are a table, "
                        "expected channels at even steps, as of Search905")
        if "receiver_aperture" in self.swept and not gathers_light(sensor):
            raise Error(f"{what}.bounds.receiver_aperture: the sensor has no aperture, "
                        "expected a photon receiver, as of Search905")
        low, high = max(self._ends("minimum_elevation")), min(self._ends("maximum_elevation"))
        if of_band and not low < high:
            raise Error(f"{what}.bounds: beams begin at up to {low:g} deg and end from {high:g} deg on, "
                        "expected bounds of minimum_elevation below those of maximum_elevation")
        if of_band and min(self._ends("number_of_channels")) < 2.0:
            raise Error(f"{what}.bounds.number_of_channels: begins at 1, expected 2 or more, "
                        "of which the lowest and the highest are the band's ends")

    def _scans(self, values: Mapping[str, float]) -> int:
        """Number of scans within the time for which a bird is present."""
        return int(self.within * values["rotation_rate"] * (1.0 + 1e-12))

    def _all_values(self) -> List[Dict[str, float]]:
        """The numbers of all designs; designs of one geometry are neighbours."""
        bounds, count = self.options["bounds"], int(self.options.get("designs", DESIGNS))
        sizes = [len(of) if isinstance(of, list) else int(of.get("levels", 0))
                 for of in (bounds[name] for name in self.swept)]
        self.factorial = 0 < math.prod(sizes) <= count  # 0 if a bound is an interval
        if self.factorial:
            places = [[(k + 0.5) / size for k in range(size)] for size in sizes]
            units = [dict(zip(self.swept, point)) for point in itertools.product(*places)]
        else:
            light, hard = ([name for name in self.swept if FIELDS[name].light == wanted] for wanted in (True, False))
            of_one = LIGHTS if light and hard else 1
            of_light, of_hard = spread(max(len(light), 1), count), spread(max(len(hard), 1), -(-count // of_one))
            units = [{**dict(zip(hard, of_hard[k // of_one])), **dict(zip(light, of_light[k]))} for k in range(count)]
        found = [{**self.base, **{name: self.levels[name](point[name]) for name in self.swept}} for point in units]
        # Lists may give one design twice.
        return [dict(one) for one in dict.fromkeys(tuple(values.items()) for values in found)]

    def _set(self, values: Mapping[str, float]) -> None:
        """Sets the plan's sensor to a design. The sensor's `Error` says why a design is impossible."""
        sensor = self.plan.sensor
        x, y, _ = sensor.position
        changes: Dict[str, Any] = {name: values[name] for name in FIELDS
                                   if name not in ("mast", *BAND) and values[name] != getattr(sensor, name)}
        if "mast" in self.swept:
            changes["position"] = (x, y, self.ground + values["mast"])
        if any(name in self.swept for name in BAND):
            number, low, high = (values[name] for name in BAND)
            changes.update(number_of_channels=int(number), minimum_elevation=low,
                           elevation_step=(high - low) / max(number - 1.0, 1.0))
        sensor.set(**changes)
        update(sensor.algorithm)

    def changes(self, values: Mapping[str, float]) -> Dict[str, Any]:
        """Properties that turn the plan's sensor into a design."""
        self._set(values)
        names = {*self.swept, "position", "orientation"} - {"mast", "maximum_elevation"}
        if any(name in self.swept for name in BAND):
            names |= {"number_of_channels", "minimum_elevation", "elevation_step"}
        found = {name: getattr(self.plan.sensor, name) for name in sorted(names)}
        return {name: list(value) if isinstance(value, tuple) else value for name, value in found.items()}

    def _judge(self, one: Candidate) -> None:
        """Computes pulses and cost of a design."""
        try:
            if self._scans(one.values) > MOST_SCANS:
                raise Error(f"{self._scans(one.values)} scans in {self.within:g} s, expected at most {MOST_SCANS}")
            self._set(one.values)
            gate, limit = self.plan.sensor.range_gate, self.plan.sensor.algorithm.GetUnambiguousRange()
            if gate > limit and not self.options.get("ambiguous_ranges", False):
                raise Error(f"range_gate is {gate:g} m, expected at most {limit:.4g} m, so that an echo arrives before "
                            "the next pulse leaves, or design.ambiguous_ranges true")
        except Error as error:
            one.refused = str(error)
            return
        times = np.sort(1e-6 * np.asarray(self.plan.sensor.beams["timestamp"], float))
        rate, energy = len(times) * one.values["rotation_rate"], one.values["pulse_energy"]
        pulses = {"pulse_rate": rate, "average_power": rate * energy}
        numbers = {**one.values, **pulses}
        with naming(f"{self.plan.file}: design.cost"):
            one.cost = self.cost(numbers)
        with naming(f"{self.plan.file}: design.exit_aperture"):
            area = self.exit(numbers)
            if not area > 0.0:
                raise ValueError(f"{self.exit.text}: is {area:g} m2, expected more than 0")
        one.pulses = {**pulses, "shortest_interval": float(np.diff(times).min()) if len(times) > 1 else 1.0 / rate,
                      "exit_aperture": area, "exposure": energy / area, "pupil": energy * min(PUPIL / area, 1.0)}

    def _scenario(self) -> Dict[str, Any]:
        what = f"{self.plan.file}: design.scenario"
        if "scenario" not in self.options:
            raise Error(f"{what}: is missing in the plan, expected a scenario of sequences whose birds are tracked")
        with naming(what):
            found = read_scenario(self.options["scenario"])
        if pathlib.Path(found["scene"]).resolve() != pathlib.Path(self.plan.plan["scene"]).resolve():
            raise Error(f"{what}: has the scene {found['scene']}, expected the scene of the plan")
        return found

    def look(self) -> Study:
        """Computes the share of birds that each design detects, and that finalists track. @return this study"""
        possible = [one for one in self.candidates if not one.refused]
        self.weights = self.plan.weights(self.plan.points).sum(axis=0)
        found = self._found("designs", [one.values for one in possible], self.plan.points)
        for one, values in zip(possible, found):
            one.share = scores.weighted(values, self.weights)
        for one, is_on in zip(possible, on_the_front([one.cost for one in possible],
                                                     [one.share.value for one in possible])):
            one.front = bool(is_on)
        self.front = sorted((one for one in possible if one.front), key=lambda one: one.cost)
        self.finalists = self._tracked_ones() if self.measure == "tracked" else []
        self.chosen = min((one for one in self.judged if self.has_it(one)), key=lambda one: one.cost, default=None)
        self.about = self.chosen or max(self.judged, key=lambda one: self.of(one).value)
        points, _ = self.plan.places(self.plan.seed + OTHER_PLACES)
        weights = self.plan.weights(points).sum(axis=0)
        self.elsewhere = scores.weighted(self._found("other places", [self.about.values], points)[0], weights)
        self.sensitivities = self._sensitivities(found[possible.index(self.about)])
        return self

    @property
    def judged(self) -> List[Candidate]:
        """Designs whose share is known by the plan's measure."""
        return self.finalists if self.measure == "tracked" else [one for one in self.candidates if not one.refused]

    def of(self, one: Candidate) -> scores.Value:
        """The share by the plan's measure."""
        return one.tracked if self.measure == "tracked" else one.share

    def has_it(self, one: Candidate) -> Optional[bool]:
        """Whether a design has the required share; None if the error does not decide."""
        return is_told(*self.of(one)[:2], self.asked)

    def undecided(self) -> List[Candidate]:
        """Designs within the error of the required share that are cheaper than the chosen design, if there is one."""
        limit = self.chosen.cost if self.chosen else math.inf
        return [one for one in self.judged if one.cost < limit and self.has_it(one) is None]

    def _found(self, what: str, designs: Sequence[Mapping[str, float]], points: np.ndarray) -> np.ndarray:
        """The probability at each place for the plan's birds and weathers: float32, designs x places. Ranks share the
        designs; designs of one geometry stay together. Results in the folder are not computed again."""
        require_memory(4.0 * len(designs) * len(points), f"{len(designs):,} designs and {len(points):,} places",
                       "take fewer")
        folder, places = self.folder / "coverage", np.ascontiguousarray(points, float)
        settings = {name: value for name, value in self.plan.settings.items() if name != "height_limits"}
        cover = Coverage(self.plan.scene, self.plan.sensor, places=places_of(places), **settings)
        known = [self.plan.mix, [[air.share, air.settings] for air in self.airs], self.within,
                 {name: repr(value) for name, value in settings.items() if name != "number_of_threads"}]
        found, files = np.empty((len(designs), len(points)), np.float32), []
        for values in designs:
            self._set(values)
            files += files_of(cover, np.array([self.plan.sensor.position]), places, known, folder)
        with self.ranks.together():
            hard = [tuple(value for name, value in values.items() if not FIELDS[name].light) for values in designs]
            with Updates(cover.algorithm) as again:
                fill(found, files, self.ranks, lambda i: self._at_places(cover, designs[i], again),
                     lambda *done: self.progress(what, *done), lambda i: hard[i])
        return found

    def _at_places(self, cover: Coverage, values: Mapping[str, float], again: Callable[[], Any]) -> np.ndarray:
        self._set(values)
        name, total = "detection_probability", 0.0
        if self.within:
            name, scans = "track_probability", self._scans(values)
            if scans < cover.required_detections:
                return np.zeros(1, np.float32)  # one value for all places
            cover.number_of_scans = scans
        whole = sum(air.share for air in self.airs)
        for species, share in self.plan.mix.items():
            cover.species = species
            for air in self.airs:
                cover.set(**air.settings)
                again()
                array = cover.algorithm.GetOutputDataObject(0).GetPointData().GetArray(name)
                total = total + share * air.share / whole * vtk_to_numpy(array).astype(float)
        return np.asarray(total, np.float32)

    def _sensitivities(self, found: np.ndarray) -> List[Dict[str, Any]]:
        """Rows: each varied number of the design lower and higher by CHANGE (elevations by CHANGE of the band), one
        number at a time. A row has the changes of the detected share, at the same places, and of the cost."""
        about, changed = self.about.values, []
        width = about["maximum_elevation"] - about["minimum_elevation"]
        for name in self.swept:
            step = CHANGE * (width if name.endswith("_elevation") else about[name])
            for sign in (-1.0, 1.0):
                value = about[name] + sign * (max(round(step), 1.0) if FIELDS[name].whole else step)
                one = Candidate(-1, {**about, name: value})
                try:
                    self._judge(one)
                except Error as error:  # a formula may give no number outside the bounds
                    one.refused = str(error)
                changed.append((name, value, one))
        possible = [one for _, _, one in changed if not one.refused]
        for one, values in zip(possible, self._found("sensitivities", [one.values for one in possible],
                                                     self.plan.points)):
            one.share = scores.weighted(values - found, self.weights)
        return [{"field": name, "unit": FIELDS[name].unit, "from": about[name], "to": value, "refused": one.refused,
                 "cost": one.cost - self.about.cost, "share": one.share} for name, value, one in changed]

    def _tracked_ones(self) -> List[Candidate]:
        """Designs spread evenly along the front, with the number of tracked birds of the scenario."""
        count = min(int(self.options.get("finalists", FINALISTS)), len(self.front))
        finalists = [self.front[i] for i in np.unique(np.round(np.linspace(0, len(self.front) - 1, count)).astype(int))]
        with naming(f"{self.plan.file}: design.scenario"):
            rate = Sensor(**self.scenario["sensor"]).rotation_rate
        own = {name: value for name, value in self.plan.plan["sensor"].items() if name != "name"}
        each = int(self.scenario.get("scans_per_sequence", 100))
        for number, one in enumerate(finalists):
            # within equal times
            scans, learning = (max(round(count * one.values["rotation_rate"] / rate), 1) for count in (each, LEARNING))
            with naming(f"{self.plan.file}: design.scenario"):
                tracks = BirdTracks([self.options["scenario"]], learning_scans=learning, threads=self.plan.threads,
                                    sensor={**self.scenario["sensor"], **own, **self.changes(one.values)},
                                    scans_per_sequence=scans,
                                    number_of_scans=max(scans * self.scenario["number_of_scans"] // each, 1))
            folder = self.folder / "tracks" / hashlib.sha256(repr(one.values).encode()).hexdigest()[:16]
            which = f"design {number + 1} of {len(finalists)}"
            tracks.write(folder, self.ranks, lambda what, *done, which=which: self.progress(f"{which}: {what}", *done))
            with naming(f"{self.plan.file}: design.scenario"):
                one.tracked = self._tracked(read_table(folder / "birds.csv"))
        return finalists

    def _tracked(self, birds: Sequence[Mapping[str, str]]) -> scores.Value:
        """The share of tracked birds of the plan's species at the plan's heights. @param birds rows of birds.csv"""
        low, high = self.plan.asked or (-math.inf, math.inf)
        parts = []
        for species, share in self.plan.mix.items():
            of = [bird for bird in birds if bird["species"] == species and low <= float(bird["height"]) <= high]
            if not of:
                raise ValueError(f"has no {species or 'target'} at the plan's heights within the beams, expected some")
            parts.append((share, scores.share(sum(bird["found_s"] != "" for bird in of), len(of))))
        return scores.Value(sum(share * part.value for share, part in parts),
                            math.sqrt(sum((share * part.error) ** 2 for share, part in parts)),
                            sum(part.number for _, part in parts))
