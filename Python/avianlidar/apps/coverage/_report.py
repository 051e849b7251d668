# SPDX-License-Identifier: BSD-3-Clause
"""A report of coverage as one page of HTML: the command `avianlidar report`."""
from __future__ import annotations

import json
import math
import os
import pathlib
import warnings
from typing import Any, Callable, Dict, List, Optional

import numpy as np

from ... import reach
from ..._cloud import field_values
from ..._disk import only_run, write_whole
from ..._pipeline import Error
from ..._version import __version__
from ..inputs._json import load_json, naming
from ..inputs._on_sale import half_range, on_sale
from ..inputs._tables import write_table
from ..pages import _drawing as drawing
from ..pages._html import First, render
from ..pages._words import counted, listed
from ..places._candidates import NOT_CHECKED
from ..places._geojson import to_geodetic
from ..places._regions import rounded
from ..sequences._card import read_card
from ..view import _view
from . import _answer
from . import _pictures as pictures
from . import _sites_page
from ._answer import LEAST, decimals, metres, percent, place, share_of, twice
from ._crossing import Crossing, crossing
from ._plan import OTHER_PLACES, Plan
from ._sites import BEST, Sites

VISIBILITIES = (200.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0, 20_000.0)  # in the section on weather, m
RAINS = (0.0, 1.0, 5.0, 10.0, 25.0, 50.0)  # rain rates, mm/h
ANSWERED = 1000.0  # visibility whose share is given in a sentence, m
SECTOR = 1000  # 0.01 deg: a lidar with beams in each sector of this width looks all around
SHOWN = 3  # greatest number of sensors and runways on paper; files have all
MAPPED = 2  # greatest number of sensors with maps on paper
LONGEST = 400  # letters of a scene's comment on paper
BESIDE = (("fog:1000",), ("rain:10",))  # weathers for which best sites are searched if the plan gives no year

# Numbers of a sensor in the table: property, words, unit, factor from the property to the unit.
COMMON = (("number_of_channels", "beams above one another", "", 1.0), ("azimuth_step", "step in azimuth", "°", 1.0),
          ("rotation_rate", "scans a second", "", 1.0), ("half_beamwidth", "half beamwidth", "mrad", 1e3),
          ("half_beamwidth_across", "half beamwidth across (0: the same)", "mrad", 1e3),
          ("pulse_energy", "energy of a pulse", "mJ", 1e3), ("pulse_width", "length of a pulse", "ns", 1e9),
          ("wavelength", "wavelength", "nm", 1.0), ("range_gate", "range gate", "m", 1.0))
PHOTONS = (("receiver_aperture", "area of the receiver's aperture", "cm²", 1e4),
           ("receiver_efficiency", "efficiency of optics and detector", "", 1.0),
           ("filter_bandwidth", "bandwidth of the filter", "nm", 1.0),
           ("background_radiance", "radiance of the sky", "W/(m² sr nm)", 1.0),
           ("amplifier_noise", "noise of the amplifier, electrons", "", 1.0),
           ("excess_noise_factor", "excess noise factor", "", 1.0),
           ("range_noise_floor", "noise of ranges of strong echoes", "cm", 100.0),
           ("false_alarms_per_scan", "false alarms in a scan", "", 1.0), ("dynamic_range", "dynamic range", "dB", 1.0))
LIMITS = (("lower_energy_limit", "lower energy limit", "µJ", 1e6),
          ("upper_energy_limit", "upper energy limit", "µJ", 1e6))


def assumptions(plans: List[Plan]) -> List[Dict[str, Any]]:
    """Rows of numbers of the receivers: receiver, number, unit, value, and whether the value is assumed."""
    rows = []
    for plan in plans:
        beams, sensor = plan.sensor.beams.fields, plan.sensor
        band = not {"elevation_step", "minimum_elevation"}.isdisjoint(plan.assumed)
        numbers = [("elevation of the beams' middles", "°", "{:.2f} to {:.2f}".format(*reach.band(sensor)), band)]
        if any(sensor.orientation):
            numbers.append(("yaw, pitch, roll", "°", "{:g}, {:g}, {:g}".format(*sensor.orientation), False))
        facts = (*COMMON, *(PHOTONS if int(beams["receiver_model"]) == 1 else LIMITS))
        numbers += [(words, unit, f"{factor * float(beams[name]):.4g}", name in plan.assumed)
                    for name, words, unit, factor in facts
                    if name in beams and not (name == "number_of_channels" and "prism_wedge_angles" in beams)]
        rows += [{"receiver": plan.name, "number": words, "unit": unit, "value": value, "assumed": int(marked)}
                 for words, unit, value, marked in numbers]
    return rows


def _side_by_side(rows: List[Dict[str, Any]], names: List[str]) -> List[List[str]]:
    """Rows of `assumptions` as a table with a column for each receiver."""
    known = {(row["receiver"], row["number"]): row["value"] + ", assumed" * row["assumed"] for row in rows}
    units = {row["number"]: row["unit"] for row in rows}
    return [[f"{number}, {unit}" if unit else number, *(known.get((name, number), "–") for name in names)]
            for number, unit in units.items()]


class Report:
    """Pictures, tables and words of a plan: for the plan's sensor and each sensor for comparison, each at its best site
    or, without sites, at the place in the plan."""

    def __init__(self, plan: Dict[str, Any], threads: int = 0,
                 progress: Optional[Callable[[str, int, int], Any]] = None):
        self.plan, self.progress = plan, progress or (lambda *_: None)
        self.plans = Plan.all_of(plan, threads)
        self.scene = load_json(plan["scene"])
        with naming(f"{plan['file']}: tracks"):
            self.tracks = read_card(plan["tracks"]) if "tracks" in plan else None
        self.sites = [Sites(one, progress=progress, beside=[words for words in BESIDE if words != one.air])
                      for one in self.plans] if "siting" in plan else []

    def _maps(self, views: List[Plan], folder: pathlib.Path) -> List[Dict[str, Any]]:
        """Rows of maps: of probabilities for each sensor, and of reasons for the first."""
        found, rows = [], min(len(views), MAPPED)
        height = (drawing.HEIGHT - 1.7 - 0.8 * min(len(views), SHOWN)) / (rows + 1) - 0.4
        for view in views:
            where, columns = f"{view.title} by height above {view.above}", len(pictures.map_heights(view))
            shares = [f"{percent(float(view.mixed(view.map_at(one)).mean()))} at {one:g} m"
                      for one in pictures.map_heights(view)]
            found.append(drawing.picture(
                folder / f"maps-{view.name}.png", pictures.row_size(view, height), "Maps of the probability",
                f"{where}: the mean probability that one scan detects a {view.bird} is {listed(shares)}.",
                lambda axes: pictures.draw_maps(axes, view, "detection_probability"), columns=columns))
        view = views[0]
        return [*found[:rows], drawing.picture(
            folder / "reasons.png", pictures.row_size(view, height), "Maps of reasons",
            f"Why {view.name} misses birds by height, with buildings and runways in black.",
            lambda axes: pictures.draw_maps(axes, view, "status"), columns=len(pictures.map_heights(view)))]

    @staticmethod
    def _sections(view: Plan, folder: pathlib.Path) -> List[Dict[str, Any]]:
        """Sections along the longest runways."""
        longest = sorted(view.runways, key=lambda runway: -runway.axis()[1])[:SHOWN]
        limits = ", dotted: heights of the plan" if view.asked else ""
        return [drawing.picture(
            folder / "sections.png", (drawing.WIDTH, 0.5 + 1.8 * len(longest)), "Sections along runways",
            f"{view.name} along the middle of {listed([one.name for one in longest])} (white) and approaches to 3 km, "
            f"with stretched heights (dashed: glide paths of {pictures.GLIDE_PATH:g} degrees{limits}).",
            lambda axes: pictures.draw_sections(axes, view, longest), rows=len(longest))] if longest else []

    def _siting(self, sites: Sites, folder: pathlib.Path) -> Dict[str, Any]:
        """Writes the tables of sites. @return facts for the page"""
        changes, plan = list(sites.look().changes()), sites.plan
        _sites_page.write(sites, folder, changes)
        axes, best, rows = ("x [m]", "y [m]", "z [m]"), [], []
        for rank, i in enumerate(sites.order[:BEST].tolist(), 1):
            (value, own), (less, error) = sites.share([i]), sites.difference(i)
            digits = decimals(100.0 * error) if error > 0.0 else 0
            best.append({"rank": rank, **dict(zip(axes, map(float, sites.positions[i]))), "detects": value,
                         "std_error": own, "less": less, "less_std_error": error})
            rows.append([rank, *rounded(sites.positions[i]), percent(value, own, plan.count),
                         f"{100.0 * less:.{digits}f} ± {100.0 * error:.{digits}f}" if error > 0.0 else "–"])
        masts, airs = sites.best_by_mast(), sites.best_by_air()
        write_table(folder / "best.csv", best)
        write_table(folder / "masts.csv", [{"mast [m]": row["mast"], **dict(zip(axes, map(float, row["position"]))),
                                            "detects": row["share"][0], "std_error": row["share"][1]} for row in masts])
        write_table(folder / "by-weather.csv", [
            {"weather": row["weather"], "share_of_hours": row["share"],
             **dict(zip(axes, map(float, sites.positions[row["site"]]))), "detects": row["value"],
             "first_site_detects": row["value of the first"]} for row in airs])
        gain, first = sites.gain(), sites.order[0]
        networks = [[row["sensors"], percent(row["value"], row["std_error"], plan.count),
                     percent(row["value of the same birds"], row["std_error"], plan.count, False),
                     row["ranks of the sites"]] for row in gain]
        return {"rows": rows[:SHOWN + 2], "networks": networks, "gain": gain, "lattice": sites.lattice,
                "alike": sites.count_alike(), "edge": sites.at_the_edge, "degrees": self._degrees(sites),
                "first": sites.positions[first], "detects": float(sites.values[first]) >= LEAST, "draws": sites.draws,
                "robustness": sites.robustness(changes), "count": len(sites.positions), "higher": sites.higher_mast,
                "taken": sites.stands_wrong(plan.sensor.position), "surfaces": _sites_page.kept_surfaces(sites),
                "heights_varied": sites.varies_heights, "masts": masts,
                "map": drawing.shown(folder / "sites.png", _sites_page.SITES_SIZE[0], "Map of candidates", (
                    f"{plan.name} at {counted(len(sites.positions), 'candidate')}, of {sites.lattice} (light grey: "
                    "areas where no lidar may stand)."))}

    def _degrees(self, sites: Sites) -> str:
        """Longitude and latitude of the best site."""
        origin = sites.plan.scene.geodetic_origin
        if origin is None:
            return ""
        longitude, latitude, _ = to_geodetic(sites.positions[sites.order[:1]], origin)[0]
        return (f"{abs(latitude):.5f}° {'N' if latitude >= 0.0 else 'S'}, "
                f"{abs(longitude):.5f}° {'E' if longitude >= 0.0 else 'W'}")

    def _reaches(self, plan: Plan) -> Dict[str, Any]:
        """The ranges to which the plan's birds are detected."""
        without = "species", "all_species", "height_limits", "clutter"
        settings = {name: value for name, value in plan.settings.items() if name not in without}
        of = {species or "target": reach.within_beams(plan.sensor, species, **settings) for species in plan.mix}
        several = f"{plan.coverage.required_detections} of {plan.coverage.number_of_scans} scans"
        limits = {species or "target": reach.in_interval(plan.sensor, species, **settings) for species in plan.mix}
        table = [{"receiver": plan.name, "species": name, "range": float(r), "one_scan": float(p),
                  "one_scan_std_error": float(e), "several_scans": float(k)} for name, one in of.items()
                 for r, p, e, k in zip(one.ranges, one.one_scan, one.error, one.several_scans)]
        ends, rows = [], []
        for name, one in of.items():
            for scans in ("one scan", several):
                row = [plan.name, name]
                for share in reach.SHARES:
                    to, *edges = (edge.to(share, scans == several) for edge in (one, *(limits[name] or ())))
                    ends.append({"receiver": plan.name, "species": name, "detected_by": scans, "share": share,
                                 "range [m]": to, **dict(zip(("from [m]", "to [m]"), edges or (None, None)))})
                    row.append(metres(to))
                    if edges and edges[1] > 0.0:
                        row[-1] += f" ({metres(edges[0])} to {metres(edges[1])})"
                rows += [row] * (scans == "one scan")
        return {"of": of, "several": several, "table": table, "ends": ends, "limits": limits, "rows": rows,
                "uncertainty": reach.uncertainty(plan.name, plan.sensor)}

    def _reach_picture(self, reaches: List[Dict[str, Any]], folder: pathlib.Path) -> Dict[str, Any]:
        shown, names = reaches[:SHOWN], [plan.name for plan in self.plans]

        def draw(panels) -> None:
            for axes, found, name in zip(np.ravel(panels), shown, names):
                pictures.draw_reach(axes, found["of"], found["several"])
                axes.set_title(name)
        return drawing.picture(
            folder / "range.png", (drawing.WIDTH, 2.4), "Curves",
            f"Share of the birds between the lowest and the highest beam of {listed(names[:SHOWN])} that are detected, "
            "by range in free air, with one standard error.", draw, columns=len(shown))

    def _weather(self, views: List[Plan], folder: pathlib.Path) -> Dict[str, Any]:
        """Shares of the places in fog, in rain, and over the plan's year, for each view, and their picture."""
        probability = ("detection_probability", "detection_std_error")
        year = views[0].year
        kinds: List[Any] = [("visibility", "visibility", VISIBILITIES, "m"), ("rain", "rain_rate", RAINS, "mm/h")]
        names: List[Any] = [(f"{kind} {value:.10g} {unit}", None) for kind, _, of, unit in kinds for value in of]
        names += [(air.name, air.share) for air in year]
        table: List[Dict[str, Any]] = []
        shares = []  # first index view, second index air
        for view in views:
            given = [view.air_of(air_backscatter=True, **{name: value})
                     for _, name, values, _ in kinds for value in values]
            rows = view.in_airs(given + [air.settings for air in view.year])
            shares.append([row[-1] for row in rows])
            # Places are equal in all weathers, so the error of the mean is at most the mean of the errors.
            if year:
                names = [*names[:len(rows)], ("all hours", 1.0)]
                rows.append([{**row, **{key: sum(air.share * of[k][key] for air, of in zip(year, rows[-len(year):]))
                                        for key in probability}} for k, row in enumerate(rows[-1])])
            shares[-1].append(rows[-1][-1])  # all hours, if the plan has a year
            table += [{"receiver": view.title, "weather": name, "share_of_hours": hours,
                       **{key: row[key] for key in ("region", "species", "places", *probability)}}
                      for (name, hours), of in zip(names, rows) for row in of]
        write_table(folder / "weather.csv", table)
        shown = [view for view in views if view.name != view.title or not self.sites][:SHOWN] or views[:SHOWN]

        def draw(panels) -> None:
            first = 0
            for axes, (kind, _, values, unit) in zip(panels, kinds):
                curves = {view.name: (values, *([row[name] for row in of[first:first + len(values)]]
                                                for name in probability)) for view, of in zip(views, shares)
                          if view in shown}
                pictures.draw_weather(axes, curves, f"{kind}, {unit}", kind == "visibility")
                first += len(values)
        caption = f"Share detected by one scan of {listed([view.title for view in shown])} in fog and in rain."
        first = len(VISIBILITIES) + len(RAINS)
        return {"answered": [of[VISIBILITIES.index(ANSWERED)] for of in shares],
                "over_the_year": [of[-1] for of in shares],
                "year": [[air.name, f"{100.0 * air.share:.1f} %", *(share_of(of[first + k]) for of in shares[:SHOWN])]
                         for k, air in enumerate(year)],
                "picture": drawing.picture(folder / "weather.png", (drawing.WIDTH, 2.3), "Curves", caption, draw, 1, 2)}

    def _advice(self, view: Plan, reaches: Dict[str, Any], crosses: Optional[Crossing]) -> Optional[Dict[str, Any]]:
        """The height to which the band must reach, and the shares that this band would detect. @param crosses the share
        of birds that the plan's sensor detects at least twice"""
        found = reach.advice(view, max(one.to(0.5) for one in reaches["of"].values()))
        if found:
            low, high = reach.band(view.sensor)
            found.update(name=view.title, low=low, high=high, now=view.overall, crossing=crosses)
            for way in found["ways"]:
                changed = [view.at(view.sensor.position, view.title, **changes) for changes in way["changes"]]
                tried = [{"then": one.in_airs([{}])[0][-1], "crossing": crossing(one) if view.runways else None,
                          "changes": changes} for one, changes in zip(changed, way["changes"])]
                way.update(max(tried, key=_answer.detects))
                changes = way["changes"]
                words = ", ".join(f"{name} {value:.4g}" for name, value in changes.items())
                way["what"] = f"{way['what'](changes)} ({words})"
            now = _answer.detects({"then": view.overall, "crossing": crosses})
            found["ways"] = [way for way in found["ways"] if any(np.greater(_answer.detects(way), now))]
        return found

    def _offers(self, view: Plan, crosses: Optional[Crossing], folder: pathlib.Path) -> List[Dict[str, Any]]:
        """A lidar that nobody sells, and what lidars on sale detect at its place, the best first."""
        if not view.idea:
            return []
        names, offers = on_sale(), []
        for number, name in enumerate(names, 1):
            there = view.with_lidar(name)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about sensors that the user has not chosen
                row, found = there.in_airs([{}])[0][-1], crossing(there) if there.runways else None
            offers.append({"name": name, "maker": there.sensor.description["maker"], "takes": _answer.takes(there),
                           "row": row, "crossing": found, "half": half_range(name, next(iter(view.mix))),
                           "interval": reach.interval(there.sensor),
                           "looks_around": len(np.unique(there.sensor.beams["azimuth"] // SECTOR)) == 36000 // SECTOR})
            self.progress("lidars on sale", number, len(names))
        species = next(iter(view.mix))
        half = reach.within_beams(view.sensor, species, visibility=reach.CLEAR).to(0.5) if species else math.nan
        own = {"name": view.name, "maker": "nobody", "takes": _answer.takes(view), "row": view.overall,
               "crossing": crosses, "interval": reach.interval(view.sensor), "half": half}
        write_table(folder / "on-sale.csv", [
            {"receiver": one["name"], "maker": one["maker"], "scan_takes": one["takes"].replace("\u00a0", " "),
             **_shares(one, "row"), "half_to [m]": one["half"],
             **dict(zip(("real_units_from", "real_units_to"), one["interval"] or (None, None))),
             "looks_around": int(one.get("looks_around", True))} for one in [own, *offers]])
        return [own, *sorted(offers, key=_answer.merit, reverse=True)]

    @staticmethod
    def _offer_rows(offers: List[Dict[str, Any]]) -> List[List[str]]:
        return [[one["name"] + ("" if one.get("looks_around", True) else " (one direction)"), one["maker"],
                 one["takes"], share_of(one["row"]), *_if_crossing(one),
                 "–" if math.isnan(one["half"]) else metres(one["half"]),
                 "{:.3g} to {:.3g}".format(*one["interval"]) if one["interval"] else "–"]
                for one in offers[:2 * SHOWN]]

    def _first_picture(self, view: Plan, folder: pathlib.Path, reaches: Dict[str, Any]) -> Dict[str, Any]:
        """The airport with the sensor, the regions of the plan, and where birds are detected at each height."""
        extent = pictures.answer_extent(view, max(one.to(pictures.OUTLINES[0]) for one in reaches["of"].values()))
        found = pictures.found_at(view, extent)
        seen = ", ".join(f"{percent(float(np.mean(classes == 2)))} of the map at {height:g} m"
                         for height, classes in found)
        shares = {row["region"]: share_of(row, bar=False) for row in view.by_end}
        kinds = " and ".join(view.members).replace("approaches", "beginnings of approaches")
        regions = f", dotted: {kinds} with the share detected in each region" if view.runways else ""
        left_out: List[str] = []
        picture = drawing.picture(
            folder / "answer.png", drawing.map_size(extent, drawing.WIDTH, 0.0, 0.2 + 0.2 * math.ceil(len(found) / 4)),
            f"Map of the airport: one scan detects half or more of the birds on {seen} above {view.above}",
            f"Filled: one scan of {view.name} (red triangle) detects half or more of the birds, dashed: a tenth"
            f"{regions}.", lambda axes: left_out.extend(pictures.draw_answer(axes, view, found, extent, shares)))
        if left_out:
            picture["caption"] = (f"{picture['caption'][:-1]} (no room for "
                                  f"{listed([' '.join(one.split()) for one in left_out])}).")
        return picture

    def write(self, file) -> pathlib.Path:
        """Writes the page. Beside the page, a folder with the page's name and `_files` gets shares.csv, ends.csv,
        range.csv, weather.csv, pictures and tables of sites. @return this folder"""
        file = pathlib.Path(file)
        if file.suffix not in (".html", ".htm") or file.is_dir():
            raise Error(f"{file}: is not the name of a page, expected one that ends in .html")
        folder = file.with_name(f"{file.stem}_files")
        with only_run(folder, goes_on=False):
            write_whole(file, self._page(folder))
        return folder

    def _page(self, folder: pathlib.Path) -> bytes:
        """The page. Its tables and pictures are written to the folder."""
        first = self.plans[0]
        sited = [self._siting(sites, folder if number == 0 else folder / sites.plan.name)
                 for number, sites in enumerate(self.sites)]
        best = [plan.at(site["first"], f"{plan.name} at its best site", plan.seed + OTHER_PLACES)
                for plan, site in zip(self.plans, sited) if site["detects"]]
        views = [*self.plans, *best]
        if "extent" not in self.plan:
            points = np.array([point for view in views
                               for point in (view.extent[::2], view.extent[1::2], view.sensor.position[:2])])
            (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
            for view in views:
                view.extent = (x0, x1, y0, y1)
        reaches = [self._reaches(plan) for plan in self.plans]
        answering = [next((view for view in best if view.name == plan.name), plan) for plan in self.plans]
        weather = self._weather(views, folder)
        site_of: List[Any] = [*sited] or [None] * len(self.plans)
        crossings = [crossing(view) if view.runways else None for view in answering]
        offers = self._offers(answering[0], crossings[0], folder)
        advices = [self._advice(*each) for each in zip(answering, reaches, crossings)]
        numbers = assumptions(self.plans)
        for name, rows in {
                "shares": [{"receiver": view.title, **row, **_heights(view, row)}
                           for view in views for row in view.shares],
                "ends": [{"receiver": view.title, **row} for view in views for row in view.by_end],
                "range": [row for found in reaches for row in found["table"]],
                "reach": [row for found in reaches for row in found["ends"]], "assumptions": numbers,
                "heights": [{"receiver": one["name"], **row} for one in advices if one for row in one["rows"]],
                "beams": [{"receiver": one["name"], "beams": way["what"], "cost": way["cost"], **_shares(way, "then")}
                          for one in advices if one for way in _ways(one)]}.items():
            write_table(folder / f"{name}.csv", rows)
        asked = _shown({name: part for name, part in self.plan.items()
                        if name not in ("file", "hours", "options", *(["year"] if "metar" in self.plan else []))})
        write_whole(folder / "plan.json", json.dumps(asked, indent=1, ensure_ascii=False).encode())
        said = [" ".join(_answer.details(plan, view, site, weather["over_the_year"][views.index(view)], crosses))
                for plan, view, site, crosses in zip(self.plans, answering, site_of, crossings)]
        there = self._in_three_dimensions(answering[0], folder / "view.html")
        fog = weather["answered"][views.index(answering[0])]
        page = First(
            self.plan.get("description") or f"Where is a {first.bird} detected?",
            _answer.sentence(answering[0], site_of[0]), self._first_picture(answering[0], folder, reaches[0]),
            _answer.numbers(answering[0], reaches[0], crossings[0], fog),
            _answer.next_steps(first, answering[0], site_of[0], advices[0], offers[1:]),
            _answer.assumed(answering[0], offers[1:]), f"{folder.name}/view.html" if there else "")
        return render(
            "coverage/report.html.jinja", first=page, plan=first, names=[plan.name for plan in self.plans][:SHOWN],
            said=said[:SHOWN], maps=self._maps(answering, folder), sections=self._sections(answering[0], folder),
            reach={"picture": self._reach_picture(reaches, folder),
                   "rows": [row for found in reaches for row in found["rows"]][:2 * SHOWN + 2],
                   "words": [found["uncertainty"] for found in reaches if found["uncertainty"]][:SHOWN]},
            offers=self._offer_rows(offers), count=len(offers) - 1, beams=[
                [way["what"], way["cost"], share_of(way["then"]), *_if_crossing(way)]
                for way in (_ways(advices[0]) if advices[0] and advices[0]["ways"] else [])],
            weather=weather, hours=self.plan.get("hours", ""),
            titles=[view.title for view in views][:SHOWN], site=site_of[0],
            sure=_answer.certainty(site_of[0]) if sited else [], facts=self._facts(first, numbers),
            receivers=_side_by_side(numbers, [plan.name for plan in self.plans][:SHOWN]), tracks=self.tracks,
            not_checked=listed(NOT_CHECKED), attribution=_lines(self.scene.get("attribution")), files=folder.name,
            version=__version__)

    def _facts(self, plan: Plan, numbers: List[Dict[str, Any]]) -> List[List[str]]:
        """Rows on birds, air and places."""
        cover, known = plan.coverage, field_values(plan.regions.data)
        area = float(np.ravel(known["effective_area"])[0])
        size = f", mean effective area {area:.4f} m²" if len(plan.mix) == 1 else ""
        air = [f"rain {cover.rain_rate:g} mm/h (assumed)"] * (cover.rain_rate > 0.0)
        air += [f"visibility {cover.visibility / 1000.0:g} km (assumed)"] * (cover.visibility > 0.0)
        air += [f"attenuation {float(known['attenuation_coefficient']):.3g} per metre"]
        ground = "not in the scene" if plan.ground is None else f"at {rounded([plan.ground])[0]} m"
        lines = " ".join(_lines(self.scene.get("comment")))
        if len(lines) > LONGEST:  # whole sentences
            lines = lines[:LONGEST].rpartition(". ")[0] + ". (Continued in the scene file.)"
        spread = f", {plan.spread_words}" if plan.runways else ""
        return [["birds", f"{plan.bird}{size}, reflectance {cover.reflectance:g} (all assumed)"],
                ["air", f"{', '.join(air)}; air sends light back only if the plan's weather says so"],
                ["sensor", f"{place(plan.sensor.position)} from the scene's origin; heights are above this origin, and "
                           f"the ground below the sensor is {ground}"],
                ["clutter", "of surfaces that stand still, not of vehicles" if cover.clutter else "not counted"],
                ["places", f"{int(plan.overall['places']):,}, drawn {plan.where}{spread} (assumed)"],
                *([["runways", "; ".join(runway.words() for runway in plan.runways)]] if plan.runways else []),
                ["scene", f"{pathlib.Path(self.plan['scene']).name}. {lines}"]]

    def _in_three_dimensions(self, view: Plan, file: pathlib.Path) -> bool:
        """Writes a page with the scene, the sensor and the maps in three dimensions. @return whether it is there"""
        maps = []
        for height in view.heights:
            cover = view.map_at(height)
            (west, south), step = cover.data.GetOrigin()[:2], cover.data.GetSpacing()[:2]
            values = view.mixed(cover)[0][::-1]
            north = south + (len(values) - 0.5) * step[1]
            maps.append(_view.map_of(height, west - step[0] / 2, north, step, values))
        return _view.beside(file, view.scene, self.plan.get("description") or file.parent.name, coverage=maps,
                            lidar=view.sensor.position)


def _heights(view: Plan, row: Dict[str, Any]) -> Dict[str, Any]:
    """Least and greatest height of the places of a row of shares."""
    low, high = view.heights_of(row["region"])
    return {"lowest [m]": max(low, row["height_from"]), "highest [m]": min(high, row["height_to"])}


def _shares(of: Dict[str, Any], row: str) -> Dict[str, Any]:
    """Cells of tables with the shares detected by one scan and at least twice."""
    across = (of["crossing"].share, of["crossing"].error) if of["crossing"] else (None, None)
    return {**{name: of[row][name] for name in ("detection_probability", "detection_std_error")},
            **dict(zip(("twice", "twice_std_error"), across))}


def _if_crossing(of: Dict[str, Any]) -> List[str]:
    return [twice(of["crossing"])] if of["crossing"] else []


def _ways(advice: Dict[str, Any]) -> List[Dict[str, Any]]:
    """The beams as they are, and other beams in the same place."""
    return [{"what": "unchanged", "cost": "", "then": advice["now"], "crossing": advice["crossing"]}, *advice["ways"]]


def _lines(value: Any) -> List[str]:
    """A comment, which may be any value, in lines."""
    parts = value if isinstance(value, list) else [] if value is None else [value]
    return [part if isinstance(part, str) else json.dumps(part, ensure_ascii=False) for part in parts]


def _shown(value: Any) -> Any:
    """A plan without folders of this computer."""
    if isinstance(value, dict):
        return {name: _shown(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_shown(part) for part in value]
    return os.path.basename(value) if isinstance(value, str) and os.path.isabs(value) else value
