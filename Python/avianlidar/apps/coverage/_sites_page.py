# SPDX-License-Identifier: BSD-3-Clause
"""Words on a search for sites of lidars, and the files that `avianlidar siting` writes: tables and pictures."""
from __future__ import annotations

import pathlib
from typing import Any, Dict, List

import numpy as np

from ..inputs._tables import write_table
from ..pages import _drawing as drawing
from ..places._candidates import NOT_CHECKED, TABLE
from ..places._geojson import write_sites
from . import _pictures as pictures
from ._sites import Change, Sites

SITES_SIZE = (3.8, 4.7)  # inches


def kept_surfaces(sites: Sites) -> str:
    """Words on the surfaces that masts stay below, and on the candidates that pierce a surface."""
    if not sites.pierced:
        return f"not checked, because the plan switches the surfaces off; also not checked: {', '.join(NOT_CHECKED)}"
    category = sites.surfaces[0].category + ("" if "category" in sites.changed else " (assumed)")
    code = "code number" if "code" in sites.changed else "code number by its length, assumed:"
    codes = "; ".join(f"{one.runway.name}: {code} {one.code}" for one in sites.surfaces)
    changed = ", ".join(name for name in sites.pierced if isinstance(sites.changed.get(name), dict))
    changes = f"; the plan changes {changed}" if changed else ""
    count = sum(sites.pierced.values())
    return (f"masts keep below {', '.join(sites.pierced)} surfaces of ICAO Annex 14 ({TABLE['year']}) for {category} "
            f"approaches, {codes}{changes}; {count} of "
            f"{count + len(sites.positions)} candidates pierced a surface and are left out ({sites.counted}); "
            f"not checked: {', '.join(NOT_CHECKED)}")


def words(sites: Sites) -> Dict[str, str]:
    """Words on the birds, candidates and conditions of the values."""
    plan, margin = sites.plan, sites.options.get("margin", 0.0)
    files = [f"the buildings (polygons with a height) of {pathlib.Path(plan.plan['runways']).name}",
             *(f"the polygons of {pathlib.Path(name).name}" for name in sites.options.get("exclusions", ()))]
    weather = sites.airs[0].name if not plan.year else "by the year's share of the hours: " + "; ".join(
        f"{air.name} {100 * air.share:.3g} %" for air in plan.year)
    return {"sensor": plan.name, "birds (sizes assumed)": f"{plan.bird} {plan.where}",
            "candidates": (f"{len(sites.positions)}, of {sites.lattice}; "
                           "places between the candidates were not computed"),
            "masts": ", ".join(f"{mast:g} m" for mast in sites.masts) + " above the ground below",
            **({"weather": weather} if plan.year or plan.air else {}),
            "clutter": "counted" if sites.settings.get("clutter") else "not counted",
            "nothing may stand": (f"on runways, under surfaces of the scene, and within {margin:g} m of "
                                  f"{' and '.join(files)}"),
            "obstacle limits": kept_surfaces(sites)}


def write(sites: Sites, folder, changes: List[Change]) -> None:
    """Writes sites (CSV, VTP, GeoJSON) by rank, gain.csv, robustness.csv, and a picture of sites."""
    folder, order = pathlib.Path(folder), sites.order
    columns: Dict[str, Any] = {"rank": np.arange(1, len(order) + 1), "value": sites.values[order],
                               "in_network": np.isin(order, sites.networks[-1].sites).astype(np.int32)}
    for k, name in enumerate(sites.mix):
        for region, numbers in sites.regions.items():
            columns[f"{name or 'target'}_{region}".replace(" ", "_")] = sites.over_the_year(order, k, numbers)
    for k, air in enumerate(sites.airs if len(sites.airs) > 1 else ()):
        columns["_".join(["value", *(air.words or ("plan",))]).replace(":", "_")] = sites.by_air[order, k]
    write_sites(folder, sites.positions[order], columns, sites.plan.scene.geodetic_origin,
                "; ".join(f"{name}: {text}" for name, text in words(sites).items()))
    write_table(folder / "gain.csv", sites.gain())
    write_table(folder / "robustness.csv", sites.robustness(changes))
    drawing.draw(folder / "sites.png", SITES_SIZE,
                  lambda axes: pictures.draw_sites(axes, sites))
