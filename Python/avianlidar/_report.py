# SPDX-License-Identifier: BSD-3-Clause
"""A report of coverage as one page of HTML: the command `avianlidar report`."""
from __future__ import annotations

import base64
import json
import math
import os
import pathlib
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

from . import _pictures as pictures
from . import siting
from ._cloud import field_values
from ._disk import only_run, write_whole
from ._json import load_json
from ._maps import Plan, height_name, write_table
from ._pipeline import Error
from ._ranks import version
from ._sites import Sites

BEST = 10  # sites in the table

# Numbers of a sensor that a reader should know: property, words, unit, what one unit of the property is in it.
COMMON = (("number_of_channels", "beams above one another", "", 1.0), ("azimuth_step", "step in azimuth", "°", 1.0),
          ("rotation_rate", "scans a second", "", 1.0), ("half_beamwidth", "half beamwidth", "mrad", 1e3),
          ("pulse_energy", "energy of a pulse", "mJ", 1e3), ("pulse_width", "length of a pulse", "ns", 1e9),
          ("wavelength", "wavelength", "nm", 1.0), ("range_gate", "range gate", "m", 1.0))
PHOTONS = (("receiver_aperture", "area of the receiver's aperture", "cm²", 1e4),
           ("receiver_efficiency", "efficiency of optics and detector", "", 1.0),
           ("filter_bandwidth", "bandwidth of the filter", "nm", 1.0),
           ("background_radiance", "radiance of the sky", "W/(m² sr nm)", 1.0),
           ("amplifier_noise", "noise of the amplifier, electrons", "", 1.0), ("excess_noise_factor", "excess noise factor", "", 1.0),
           ("false_alarms_per_scan", "false alarms in a scan", "", 1.0), ("dynamic_range", "dynamic range", "dB", 1.0))
LIMITS = (("lower_energy_limit", "lower energy limit", "J", 1.0), ("upper_energy_limit", "upper energy limit", "J", 1.0))


def assumptions(plans: List[Plan]) -> List[Dict[str, Any]]:
    """Numbers of the receivers: words, unit, and a pair (text, whether assumed) for each receiver."""
    bands = []
    for plan in plans:
        up = np.degrees(np.arcsin(np.clip(plan.sensor.beams["direction"][:, 2], -1.0, 1.0)))
        bands.append((f"{up.min():.2f} to {up.max():.2f}", "elevation_step" in plan.assumed or "minimum_elevation" in plan.assumed))
    rows = [{"words": "elevation of the beams' middles", "unit": "°", "cells": bands}]
    turned = [any(plan.sensor.orientation) for plan in plans]
    if any(turned):
        rows.append({"words": "yaw, pitch, roll", "unit": "°",
                     "cells": [(", ".join(f"{angle:g}" for angle in plan.sensor.orientation), False) for plan in plans]})
    fields = [plan.sensor.beams.fields for plan in plans]
    photons = [int(beams["receiver_model"]) == 1 for beams in fields]
    for facts, concerned in ((COMMON, [True] * len(plans)), (PHOTONS, photons), (LIMITS, [not p for p in photons])):
        for name, words, unit, factor in facts if any(concerned) else ():
            cells = [(f"{factor * float(beams[name]):.4g}", name in plan.assumed) if this else ("–", False)
                     for plan, beams, this in zip(plans, fields, concerned)]
            rows.append({"words": words, "unit": unit, "cells": cells})
    return rows


def _percent(share: Any) -> str:
    return f"{100.0 * share:.1f}\u00a0%"


def _embedded(file: pathlib.Path) -> str:
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


class Report:
    """Pictures, tables and words of a plan.

    plans  with the plan's sensor and each that it compares with
    """

    def __init__(self, plan: Dict[str, Any], threads: int = 0, progress: Optional[Callable[[str, int, int], Any]] = None):
        self.plan, self.progress = plan, progress
        self.plans = Plan.all_of(plan, threads)
        self.scene = load_json(plan["scene"])
        self.sites = Sites(self.plans[0], progress=progress) if "siting" in plan else None
        self.done = 0

    def _draw(self, file: pathlib.Path, size: Tuple[float, float], alt: str, caption: str, work) -> Dict[str, str]:
        pictures.draw(file, size, work)
        self.done += 1
        if self.progress:
            each = 2 * len(self.plans[0].heights) + 1 + bool(self.plans[0].runways)
            self.progress("pictures", self.done, each * len(self.plans))
        return {"source": _embedded(file), "alt": alt, "caption": caption}

    def _receiver(self, plan: Plan, folder: pathlib.Path) -> Dict[str, Any]:
        """Pictures of a receiver."""
        names = plan.coverage.status_names
        bird, maps, reasons = plan.coverage.species or "target", [], []
        for height in plan.heights:
            cover = plan.map_at(height)
            p, status = cover["detection_probability"], cover["status"]
            shares = np.bincount(status.ravel(), minlength=len(names)) / status.size
            caption = f"{height:g} m above {plan.above}: mean {p.mean():.3f}, at least 0.5 on {_percent(np.mean(p >= 0.5))} of the map"
            maps.append(self._draw(folder / f"{plan.name}-probability-{height_name(height)}.png", (3.3, 3.0),
                                   f"Map of the probability that one scan of {plan.name} detects a {bird} {caption}.", caption,
                                   lambda axes, cover=cover: pictures.draw_map(axes, plan, cover, "detection_probability")))
            words = ", ".join(f"{names[i]} {_percent(shares[i])}" for i in np.argsort(-shares)[:3] if shares[i] > 0.0)
            reasons.append(self._draw(folder / f"{plan.name}-reasons-{height_name(height)}.png", (3.3, 3.0),
                                      f"Map of reasons for {plan.name} {height:g} m above {plan.above}: {words}.",
                                      f"{height:g} m above {plan.above}: {words}",
                                      lambda axes, cover=cover: pictures.draw_map(axes, plan, cover, "status")))
        clutter = plan.coverage.clutter_map
        count = int(np.count_nonzero(clutter["detection_probability"] >= 0.5)) if clutter.number_of_points else 0
        found = {"name": plan.name, "maps": maps, "reasons": reasons, "overall": plan.overall,
                 "clutter": self._draw(folder / f"{plan.name}-clutter.png", (4.6, 3.8),
                                       f"Map of echoes of surfaces with {plan.name}: {count} in at least every second scan.",
                                       f"{plan.name}: {count} echoes of surfaces in at least every second scan",
                                       lambda axes: pictures.draw_clutter(axes, plan, clutter))}
        if plan.runways:
            values, extent = pictures.section(plan)
            name = pictures.nearest_runway(plan).name
            found["section"] = self._draw(folder / f"{plan.name}-section.png", (5.6, 2.6),
                                          f"Section along {name} with {plan.name}: at least 0.5 on "
                                          f"{_percent(np.mean(values >= 0.5))} of it, mean {values.mean():.3f}.",
                                          f"{plan.name}, along the middle of {name} (white) and its approaches to 3 km; dashed: glide "
                                          f"paths of {pictures.GLIDE_PATH:g} degrees; heights are stretched",
                                          lambda axes: pictures.draw_section(axes, plan, values, extent))
        return found

    def _tables(self) -> Dict[str, Any]:
        """Shares by region and height of the bird, by species, and reasons: rows with a row of shares for each receiver."""
        bird, shares = self.plans[0].coverage.species, [plan.shares for plan in self.plans]

        def height(row):
            low, high = row["height_from"], row["height_to"]
            return "all heights" if math.isinf(low) else f"{low:g} to {high:g} m" if math.isfinite(high) else f"above {low:g} m"
        rows = [{"region": of[0]["region"], "species": of[0]["species"], "heights": height(of[0]), "shares": of} for of in zip(*shares)]
        everywhere = [row for row in rows if row["region"] == self.plans[0].overall["region"] and row["heights"] == "all heights"]
        rows = [row for row in rows if row["shares"][0]["places"] > 0]
        return {"heights": [row for row in rows if row["species"] == bird],
                "species": everywhere if len(everywhere) > 1 else [],
                "reasons": [(name, f"share_{name.replace(' ', '_')}") for name in self.plans[0].coverage.status_names]}

    def _siting(self, sites: Sites, folder: pathlib.Path) -> Dict[str, Any]:
        changes = list(sites.changes())
        sites.write(folder, changes)
        best = []
        for k, i in enumerate(sites.order[:BEST].tolist()):
            less, error = sites.difference(i)
            best.append({"rank": k + 1, "position": sites.positions[i], "value": float(sites.values[i]), "less": less, "error": error})
        gain = sites.gain()
        words = "; ".join(f"{row['sensors']}: {row['value']:.3f}" for row in gain)
        x, y, _ = best[0]["position"]
        place = np.array([self.plans[0].sensor.position[:2]])
        pictured = {"plan": ("sites.png", f"Plan of {len(sites.positions)} candidates; best alone at {x:g} m east, {y:g} m north with "
                             f"{best[0]['value']:.3f}.", f"{len(sites.positions)} candidates; light grey: nothing may stand there"),
                    "curve": ("gain.png", f"Probability of one scan with the best networks of sensors: {words}.", "With more sensors")}
        return {"best": best, "gain": gain, "robustness": sites.robustness(changes), "words": sites.words(), "near": len(sites.near),
                "taken": any(siting.is_near(place, outline, margin)[0] for outline, margin in sites.exclusions),
                "heights_varied": any("heights" in change.what for change in changes), "drawn": bool(changes),
                **{key: {"source": _embedded(folder / name), "alt": alt, "caption": caption}
                   for key, (name, alt, caption) in pictured.items()}}

    def write(self, file) -> pathlib.Path:
        """Write the page, and beside it a folder of its name and `_files` with shares.csv, pictures and tables of sites.
        @return that folder"""
        file = pathlib.Path(file)
        if file.suffix not in (".html", ".htm") or file.is_dir():
            raise Error(f"{file}: is not the name of a page, expected one that ends in .html")
        folder = file.with_name(f"{file.stem}_files")
        with only_run(folder):
            write_whole(file, self._page(folder).encode())
        return folder

    def _page(self, folder: pathlib.Path) -> str:
        """The page; what it is made of is written to the folder."""
        import jinja2
        first = self.plans[0]
        receivers = [self._receiver(plan, folder) for plan in self.plans]
        write_table(folder / "shares.csv", [{"receiver": plan.name, **row} for plan in self.plans for row in plan.shares])
        sites = self._siting(self.sites.look(), folder) if self.sites else None
        known = field_values(first.regions.data)
        asked = {name: part for name, part in self.plan.items() if name != "file"}
        environment = jinja2.Environment(loader=jinja2.FileSystemLoader(pathlib.Path(__file__).parent), autoescape=True,
                                         undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
        environment.globals["zip"] = zip
        environment.filters["number"] = lambda value, form: "–" if math.isnan(value) else form % value
        return environment.get_template("report.html.jinja").render(
            question=self.plan.get("description") or f"Where is a {first.coverage.species or 'target'} detected?",
            bird=first.coverage.species or "target", cover=first.coverage, area=float(np.ravel(known["effective_area"])[0]),
            attenuation=float(known["attenuation_coefficient"]), plan=first, places=int(first.overall["places"]),
            assumptions=assumptions(self.plans), names=[plan.name for plan in self.plans], receivers=receivers,
            tables=self._tables(), sites=sites, colours=pictures.gradient(),
            statuses=list(zip(first.coverage.status_names, pictures.STATUS_COLOURS)),
            scene={"name": pathlib.Path(self.plan["scene"]).name, "comment": _lines(self.scene.get("comment")),
                   "attribution": _lines(self.scene.get("attribution"))},
            files=folder.name, version=version(), json=json.dumps(_shown(asked), indent=1, ensure_ascii=False))


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
