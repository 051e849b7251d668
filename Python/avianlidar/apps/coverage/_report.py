# SPDX-License-Identifier: BSD-3-Clause
"""A report of coverage as one page of HTML: the command `avianlidar report`."""
from __future__ import annotations

import json
import math
import os
import pathlib
import warnings
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

from ... import reach
from ..._cloud import field_values
from ..._disk import only_run, write_whole
from ..._numbers import figures
from ..._pipeline import Error
from ..._version import __version__
from ..inputs._air import gathers_light
from ..inputs._json import load_json, naming
from ..inputs._on_sale import half_range, on_sale
from ..inputs._tables import write_table
from ..pages import _drawing as drawing
from ..pages._html import embedded, render
from ..pages._words import counted, listed
from ..places._candidates import NOT_CHECKED
from ..places._geojson import to_geodetic
from ..places._regions import rounded
from ..sequences._card import read_card
from ..view import _view
from . import _answer
from . import _pictures as pictures
from . import _sites_page
from ._answer import LEAST, LEAST_WORDS, birds_of, cell, decimals, how_sure, metres, percent, place, share_of
from ._crossing import Crossing, crossing
from ._maps import height_name
from ._plan import OTHER_PLACES, Plan
from ._sites import BEST, FEWEST_DRAWS, Sites

VISIBILITIES = (200.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0, 20_000.0)  # in the section on weather, m
RAINS = (0.0, 1.0, 5.0, 10.0, 25.0, 50.0)  # rain rates, mm/h
ANSWERED = 1000.0  # visibility whose share is given in a sentence, m
SECTOR = 1000  # 0.01 deg: a lidar with beams in each sector of this width looks all around
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
LIMITS = (("lower_energy_limit", "lower energy limit", "J", 1.0),
          ("upper_energy_limit", "upper energy limit", "J", 1.0))


def assumptions(plans: List[Plan]) -> List[Dict[str, Any]]:
    """Numbers of the receivers: words, unit, and a pair (text, whether assumed) for each receiver."""
    rows = [{"words": "elevation of the beams' middles", "unit": "°",
             "cells": [("{:.2f} to {:.2f}".format(*reach.band(plan.sensor)),
                        not {"elevation_step", "minimum_elevation"}.isdisjoint(plan.assumed)) for plan in plans]}]
    if any(any(plan.sensor.orientation) for plan in plans):
        rows.append({"words": "yaw, pitch, roll", "unit": "°",
                     "cells": [("{:g}, {:g}, {:g}".format(*plan.sensor.orientation), False) for plan in plans]})
    fields = [plan.sensor.beams.fields for plan in plans]
    photons = [int(beams["receiver_model"]) == 1 for beams in fields]
    for facts, concerned in ((COMMON, [True] * len(plans)), (PHOTONS, photons), (LIMITS, [not p for p in photons])):
        for name, words, unit, factor in facts if any(concerned) else ():
            known = [this and name in beams and not (name == "number_of_channels" and "prism_wedge_angles" in beams)
                     for beams, this in zip(fields, concerned)]
            rows.append({"words": words, "unit": unit, "cells": [
                (f"{factor * float(beams[name]):.4g}", name in plan.assumed) if there else ("–", False)
                for plan, beams, there in zip(plans, fields, known)]})
    return rows


class Report:
    """Pictures, tables and words of a plan: for the plan's sensor and each sensor for comparison, at the place in the
    plan and at the best site of each sensor."""

    def __init__(self, plan: Dict[str, Any], threads: int = 0,
                 progress: Optional[Callable[[str, int, int], Any]] = None):
        self.plan, self.progress, self.done = plan, progress or (lambda *_: None), 0
        self.plans = Plan.all_of(plan, threads)
        self.scene = load_json(plan["scene"])
        with naming(f"{plan['file']}: tracks"):
            self.tracks = read_card(plan["tracks"]) if "tracks" in plan else None
        self.sites = [Sites(one, progress=progress, beside=[words for words in BESIDE if words != one.air])
                      for one in self.plans] if "siting" in plan else []
        views, pictures_of_each = 1 + bool(self.sites), 2 * len(self.plans[0].heights) + 1 + len(self.plans[0].runways)
        self.pictures = (pictures_of_each * views + 1) * len(self.plans) + 3  # at most

    def _figure(self, file: pathlib.Path, what: str, caption: str) -> Dict[str, str]:
        """A picture of the page. @param what kind of the picture, for readers who do not see it"""
        return {"source": embedded(file), "alt": f"{what}. {caption}.", "caption": caption}

    def _draw(self, file: pathlib.Path, size: Tuple[float, float], what: str, caption: str, work) -> Dict[str, str]:
        drawing.draw(file, size, work)
        self.done += 1
        self.progress("pictures", self.done, self.pictures)
        return self._figure(file, what, caption)

    def _view(self, plan: Plan, folder: pathlib.Path, name: str) -> Dict[str, Any]:
        """Pictures of a sensor at a place. @param name part of the names of files"""
        names = plan.map_at(plan.heights[0]).status_names
        maps, reasons, sections, size = [], [], [], drawing.map_size(plan.extent, 3.3)
        for height in plan.heights:
            cover, where = plan.map_at(height), f"{plan.title}, {height:g} m above {plan.above}"
            p = plan.mixed(cover)
            maps.append(self._draw(
                folder / f"{name}-probability-{height_name(height)}.png", size,
                f"Map of the probability that one scan detects a {plan.bird}",
                f"{where}: mean {percent(float(p.mean()))}, {_half(p)} of the map",
                lambda axes: pictures.draw_map(axes, plan, cover, "detection_probability")))
            shares = np.bincount(cover["status"].ravel(), minlength=len(names)) / cover["status"].size
            words = ", ".join(f"{names[i]} {percent(shares[i])}" for i in np.argsort(-shares)[:3] if shares[i] > 0.0)
            reasons.append(self._draw(
                folder / f"{name}-reasons-{height_name(height)}.png", size, "Map of reasons", f"{where}: {words}",
                lambda axes: pictures.draw_map(axes, plan, cover, "status")))
        clutter = plan.coverage.clutter_map
        count = int(np.count_nonzero(clutter["detection_probability"] >= 0.5)) if clutter.number_of_points else 0
        drawn = self._draw(
            folder / f"{name}-clutter.png", drawing.map_size(plan.extent, 4.0, 0.8), "Map of clutter",
            f"{plan.title}: {count} echoes of surfaces in at least every second scan",
            lambda axes: pictures.draw_clutter(axes, plan, clutter))
        limits = "; red: heights of the plan" if plan.asked else ""
        for number, runway in enumerate(plan.runways, 1):
            values, extent = pictures.section(plan, runway)
            sections.append(self._draw(
                folder / f"{name}-section{number}.png", (5.6, 2.6), "Section along a runway",
                f"{plan.title}, along the middle of {runway.name} (white) and its approaches to 3 km: "
                f"{_half(values)} of it, mean {percent(float(values.mean()))}; "
                f"dashed: glide paths of {pictures.GLIDE_PATH:g} degrees{limits}; heights are stretched",
                lambda axes: pictures.draw_section(axes, plan, runway, values, extent)))
        return {"name": plan.title, "maps": maps, "reasons": reasons, "sections": sections, "clutter": drawn,
                "overall": plan.overall, "position": place(plan.sensor.position)}

    def _tables(self, views: List[Plan]) -> Dict[str, Any]:
        """Shares by region and height of the bird, by species, and by reason: rows with a share of each view."""
        first, bird = views[0], views[0].overall["species"]

        def height(row):
            low, high = first.heights_of(row["region"])
            low, high = max(low, row["height_from"]), min(high, row["height_to"])
            return f"{figures(low, 3)} to {figures(high, 3)} m" if high > low else f"at {figures(low, 3)} m"
        rows = [{"region": of[0]["region"], "species": of[0]["species"], "heights": height(of[0]), "shares": of,
                 "all": math.isinf(of[0]["height_from"]) and math.isinf(of[0]["height_to"])}
                for of in zip(*(view.shares for view in views))]
        everywhere = [row for row in rows if row["region"] == first.overall["region"] and row["all"]]
        rows = [row for row in rows if row["shares"][0]["places"] > 0]
        whole = [(row["region"], row["heights"]) for row in rows if row["all"]]
        # a row for a single band repeats the row for all heights
        rows = [row for row in rows if row["all"] or (row["region"], row["heights"]) not in whole]
        ends = [{"region": of[0]["region"], "shares": of} for of in zip(*(view.by_end for view in views))]
        return {"heights": [row for row in rows if row["species"] == bird], "ends": ends if len(ends) > 1 else [],
                "species": everywhere if len(everywhere) > 1 else [],
                "reasons": [(name, f"share_{name.replace(' ', '_')}") for name in first.coverage.status_names]}

    def _siting(self, sites: Sites, folder: pathlib.Path) -> Dict[str, Any]:
        changes, plan = list(sites.look().changes()), sites.plan
        _sites_page.write(sites, folder, changes)
        best = []
        for rank, i in enumerate(sites.order[:BEST].tolist(), 1):
            less, error = (100.0 * part for part in sites.difference(i))
            digits = decimals(error) if error > 0.0 else 0
            value, own = sites.share([i])
            best.append({"rank": rank, "position": rounded(sites.positions[i]),
                         "value": percent(value, own, plan.count),
                         "less": f"{less:.{digits}f} ± {error:.{digits}f}" if error > 0.0 else "–"})
        gain, first = sites.gain(), sites.order[0]
        return {"name": plan.name, "best": best, "gain": gain, "lattice": sites.lattice, "alike": sites.count_alike(),
                "edge": sites.at_the_edge, "degrees": self._degrees(sites), "masts": sites.best_by_mast(),
                "first": sites.positions[first], "detects": float(sites.values[first]) >= LEAST, "places": plan.count,
                "by_air": [{**row, "position": rounded(sites.positions[row["site"]])} for row in sites.best_by_air()],
                "robustness": sites.robustness(changes), "words": _sites_page.words(sites), "near": len(sites.near),
                "count": len(sites.positions), "taken": sites.stands_wrong(plan.sensor.position),
                "surfaces": _sites_page.surface_sentence(sites), "draws": sites.draws,
                "heights_varied": sites.varies_heights, "higher": sites.higher_mast,
                "map": self._figure(folder / "sites.png", "Map of candidates",
                                    f"{plan.name}: {counted(len(sites.positions), 'candidate')}, of {sites.lattice}; "
                                    "light grey: areas where no lidar may stand"),
                "curve": self._figure(folder / "gain.png", "Probability of one scan with the best networks",
                                      f"{plan.name}: with more sensors; bars: standard error")}

    def _degrees(self, sites: Sites) -> str:
        """Longitude and latitude of the best site."""
        origin = sites.plan.scene.geodetic_origin
        if origin is None:
            return ""
        longitude, latitude, _ = to_geodetic(sites.positions[sites.order[:1]], origin)[0]
        return (f"{abs(latitude):.5f}° {'N' if latitude >= 0.0 else 'S'}, "
                f"{abs(longitude):.5f}° {'E' if longitude >= 0.0 else 'W'}")

    def _reaches(self, plan: Plan, folder: pathlib.Path) -> Dict[str, Any]:
        """The ranges to which the plan's birds are detected."""
        without = "species", "all_species", "height_limits", "clutter"
        settings = {name: value for name, value in plan.settings.items() if name not in without}
        of = {species or "target": reach.within_beams(plan.sensor, species, **settings) for species in plan.mix}
        several = f"{plan.coverage.required_detections} of {plan.coverage.number_of_scans} scans"
        limits = {species or "target": reach.in_interval(plan.sensor, species, **settings) for species in plan.mix}
        rows: List[Dict[str, Any]] = [
            {"receiver": plan.name, "species": name, "scans": scans,
             "limits": {share: [edge.to(share, scans == several) for edge in limits[name] or ()]
                        for share in reach.SHARES},
             "to": {share: one.to(share, scans == several) for share in reach.SHARES}}
            for name, one in of.items() for scans in ("one scan", several)]
        table = [{"receiver": plan.name, "species": name, "range": float(r), "one_scan": float(p),
                  "one_scan_std_error": float(e), "several_scans": float(k)} for name, one in of.items()
                 for r, p, e, k in zip(one.ranges, one.one_scan, one.error, one.several_scans)]
        unsure = reach.uncertainty(plan.name, plan.sensor)
        return {"of": of, "rows": rows, "table": table, "uncertainty": unsure, "picture": self._draw(
            folder / f"{plan.name}-range.png", (4.6, 3.4), "Curves",
            f"{plan.name}: share of birds in its band that are detected, by range, in free air; bars: standard error",
            lambda axes: pictures.draw_reach(axes, of, several))}

    def _weather(self, views: List[Plan], folder: pathlib.Path) -> Dict[str, Any]:
        """Shares of the places in fog, in rain, and over the plan's year, for each view."""
        probability = ("detection_probability", "detection_std_error")
        year = views[0].year
        kinds: List[Any] = [("visibility", "visibility", VISIBILITIES, "m"), ("rain", "rain_rate", RAINS, "mm/h")]
        names = [f"{kind} {value:.10g} {unit}" for kind, _, values, unit in kinds for value in values]
        names += [air.name for air in year]
        table: List[Dict[str, Any]] = []
        shares = []  # first index view, second index air
        for view in views:
            given = [view.air_of(air_backscatter=True, **{name: value})
                     for _, name, values, _ in kinds for value in values]
            rows = view.in_airs(given + [air.settings for air in view.year])
            shares.append([row[-1] for row in rows])
            table += [{"receiver": view.title, "weather": name,
                       **{key: row[key] for key in ("region", "species", "places", *probability)}}
                      for name, of in zip(names, rows) for row in of]
        write_table(folder / "weather.csv", table)
        found: Dict[str, Any] = {
            "beside": views[0].air_of()["visibility"], "pictures": [],
            "weaken": [plan.name for plan in self.plans if not gathers_light(plan.sensor)],
            "answered": [of[VISIBILITIES.index(ANSWERED)] for of in shares]}
        titles, first = ", ".join(view.title for view in views), 0
        for kind, _, values, unit in kinds:
            of_kind = [of[first:first + len(values)] for of in shares]
            first += len(values)
            curves = {view.title: (values, *([row[name] for row in of] for name in probability))
                      for view, of in zip(views, of_kind)}
            found["pictures"].append(self._draw(
                folder / f"weather-{kind}.png", (4.6, 3.4), "Curves",
                f"{titles}: share detected by one scan, by {kind}, {unit}; bars: standard error",
                lambda axes: pictures.draw_weather(axes, curves, f"{kind}, {unit}", kind == "visibility")))
            found[kind] = [{"value": value, "shares": of} for value, of in zip(values, zip(*of_kind))]
        of_year = [of[first:] for of in shares]
        found["year"] = [{"name": air.name, "share": air.share, "shares": of} for air, of in zip(year, zip(*of_year))]
        # Places are equal in all weathers, so the error of the mean is at most the mean of the errors.
        found["over_the_year"] = [
            {"places": view.overall["places"],
             **{name: sum(air.share * row[name] for air, row in zip(year, of)) for name in probability}}
            for view, of in zip(views, of_year)]
        return found

    def _weather_words(self, number: int, view: Plan, weather: Dict[str, Any]) -> str:
        """A sentence on fog and, if the plan has a year, on the year. @param number number of the view"""
        said = (f"At 1\u00a0km visibility one scan of {view.title} detects {share_of(weather['answered'][number])} "
                f"of {birds_of(view)} {view.where}.")
        if view.year:
            share = share_of(weather["over_the_year"][number])
            said += f" Over the year, by the hours of its weather, the share is {share}."
        return said

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

    def _besides(self, plan: Plan, view: Plan, site: Optional[Dict[str, Any]]) -> List[str]:
        """Further sentences on the best site: how sure it is, and what the plan's own place detects."""
        if not site or view is plan:
            return []
        said = [sentence for sentences in how_sure(site) for sentence in sentences]
        if plan is self.plans[0]:
            who = "the plan" if "position" in plan.plan["sensor"] else "the scene"
            but = ", but no lidar may stand there" if site["taken"] else ""
            said.append(f"At the sensor's position in {who}, {place(plan.sensor.position)}, the share is "
                        f"{share_of(plan.overall)}{but}.")
        return said

    def _offers(self, view: Plan, folder: pathlib.Path) -> List[Dict[str, Any]]:
        """What lidars on sale detect at the place of a lidar that nobody sells, the best first."""
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
        write_table(folder / "on-sale.csv", [
            {"receiver": one["name"], "maker": one["maker"],
             **{name: one["row"][name] for name in ("detection_probability", "detection_std_error")},
             "twice": one["crossing"].share if one["crossing"] else None,
             "twice_std_error": one["crossing"].error if one["crossing"] else None} for one in offers])
        return sorted(offers, key=_answer.merit, reverse=True)

    @staticmethod
    def _half_in_clear_air(plan: Plan) -> float:
        """The range of `half_range` for the plan's lidar, m; nan for a target without a species."""
        species = next(iter(plan.mix))
        return reach.within_beams(plan.sensor, species, visibility=reach.CLEAR).to(0.5) if species else math.nan

    def _first_picture(self, view: Plan, folder: pathlib.Path, reaches: Dict[str, Any]) -> Dict[str, str]:
        """The airport with the sensor, the regions of the plan, and where birds are detected at each height."""
        extent = pictures.answer_extent(view, max(one.to(pictures.OUTLINES[0]) for one in reaches["of"].values()))
        found = pictures.found_at(view, extent)
        seen = ", ".join(f"{percent(float(np.mean(classes == 2)))} of the map at {height:g} m"
                         for height, classes in found)
        shares = {row["region"]: share_of(row) for row in view.by_end}
        kinds = " and ".join(view.members)
        regions = f"; dotted: the plan's {kinds}, with the share detected in each" if view.runways else ""
        left_out: List[str] = []
        picture = self._draw(
            folder / "answer.png", drawing.map_size(extent, 5.9, 0.0, 0.2 * math.ceil(len(found) / 4) + 0.3),
            f"Map of the airport: one scan detects half or more of the birds on {seen} above {view.above}",
            f"{view.name} (red triangle), {place(view.sensor.position)}. "
            f"Filled: one scan detects half or more of the birds, dashed: a tenth{regions}",
            lambda axes: left_out.extend(pictures.draw_answer(axes, view, found, extent, shares)))
        if left_out:
            picture["caption"] += f". No room for the labels {listed([' '.join(one.split()) for one in left_out])}"
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
        reaches = [self._reaches(plan, folder) for plan in self.plans]
        shown = [self._view(view, folder, view.name if view in self.plans else f"{view.name}-best") for view in views]
        answering = [next((view for view in best if view.name == plan.name), plan) for plan in self.plans]
        weather = self._weather(views, folder)
        site_of: List[Any] = [*sited] or [None] * len(self.plans)
        crossings = [crossing(view) if view.runways else None for view in answering]
        said = [_answer.first_sentences(plan, view, site, of, weather["over_the_year"][views.index(view)], over)
                for plan, view, site, of, over in zip(self.plans, answering, site_of, reaches, crossings)]
        offers = self._offers(answering[0], folder)
        answers = [sentence for words, plan, view, site in zip(said, self.plans, answering, site_of)
                   for sentence in (*words, *self._besides(plan, view, site))]
        weather["words"] = [self._weather_words(views.index(view), view, weather) for view in answering]
        advices = [self._advice(*each) for each in zip(answering, reaches, crossings)]
        write_table(folder / "shares.csv", [{"receiver": view.title, **row} for view in views for row in view.shares])
        write_table(folder / "ends.csv", [{"receiver": view.title, **row} for view in views for row in view.by_end])
        write_table(folder / "range.csv", [row for found in reaches for row in found["table"]])
        there = self._in_three_dimensions(answering[0], folder / "view.html")
        known = field_values(first.regions.data)
        made = ("file", "hours", "options", *(["year"] if "metar" in self.plan else []))
        asked = {name: part for name, part in self.plan.items() if name not in made}
        text = json.dumps(_shown(asked), indent=1, ensure_ascii=False)
        return render(
            "coverage/report.html.jinja",
            filter_metres=metres, filter_share=percent, filter_of_row=share_of, filter_cell=cell,
            filter_rounded=rounded, filter_twice=_answer.twice, chance=share_of(answering[0].overall),
            said=[" ".join([_answer.in_short(answering[0], site_of[0], crossings[0]),
                            *_answer.about_idea(answering[0], offers)]), *said[0]], offers=offers,
            own={"name": first.name, "maker": "nobody", "takes": _answer.takes(first), "row": answering[0].overall,
                 "crossing": crossings[0], "half": self._half_in_clear_air(first),
                 "interval": reach.interval(first.sensor)},
            ideas=[plan.idea for plan in self.plans if plan.idea], not_checked=listed(NOT_CHECKED),
            question=self.plan.get("description") or f"Where is a {first.bird} detected?",
            first=self._first_picture(answering[0], folder, reaches[0]),
            steps=_answer.next_steps(first, answering[0], site_of[0], advices[0], offers),
            answer=[*answers, weather["words"][0]], bird=first.bird, cover=first.coverage,
            area=float(np.ravel(known["effective_area"])[0]), attenuation=float(known["attenuation_coefficient"]),
            plan=first, places=int(first.overall["places"]), assumptions=assumptions(self.plans),
            names=[plan.name for plan in self.plans], views=shown, reaches=reaches,
            advice=[one for one in advices if one],
            tables=self._tables(views), sites=sited, weather=weather, hours=self.plan.get("hours", ""),
            fewest=FEWEST_DRAWS, least=LEAST, least_words=LEAST_WORDS, colours=drawing.gradient(),
            statuses=list(zip(first.coverage.status_names, pictures.STATUS_COLOURS)), tracks=self.tracks,
            scene={"name": pathlib.Path(self.plan["scene"]).name, "comment": _lines(self.scene.get("comment")),
                   "attribution": _lines(self.scene.get("attribution"))},
            files=folder.name, version=__version__, json=text, view=there)

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


def _half(p: np.ndarray) -> str:
    return f"at least 0.5 on {percent(float(np.mean(p >= 0.5)))}"


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
