# SPDX-License-Identifier: BSD-3-Clause
"""Representations of scenes, sensors and scans in a notebook: a small table and, with Matplotlib, a picture."""
import base64
import html
import io
import itertools
import re
from collections.abc import Callable
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ._advice import to_act_on
from ._cloud import field_values, point_array, triangles_of
from ._numbers import figures
from ._properties import PATTERN
from ._sight import extent

MOST = 20000  # number of triangles or beams in a picture, at most
# Lines of a scene's report on sizes and on the lidar's place
_SIZE = re.compile(r": (\d+ triangles, \d+ degenerate|\d+ ellipsoids), east |: a medium that is not bounded|^lidar: \d")


def page(thing, rows: Callable[[Any], dict[str, Any]], draw: Callable[[Any], None] | None = None,
         size=(4.0, 3.0)) -> str:
    """HTML of a table and a picture; after an exception, its message.
    @param draw draws into axes of Matplotlib @param size size of the picture, inches"""
    try:
        lines = "".join(f"<tr><th style='text-align:left'>{html.escape(key)}</th><td style='text-align:left'>"
                        f"{html.escape(str(value))}</td></tr>" for key, value in rows(thing).items())
        return f"<b>{type(thing).__name__}</b><table>{lines}</table>{_picture(draw, size) if draw else ''}"
    except Exception as error:
        return f"<b>{type(thing).__name__}</b> {html.escape(' '.join(str(error).split()))}"


def _picture(draw: Callable[[Any], None], size) -> str:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return ""
    figure = Figure(figsize=size, layout="constrained")
    draw(figure.add_subplot())
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return f"<img alt='picture' src='data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}'/>"


def place_rows(scene) -> dict[str, Any]:
    """The rows of a scene that need no merged surfaces."""
    rows = {"cells": scene.surfaces.GetNumberOfCells()}
    if rows["cells"]:
        bounds = [0.0] * 6
        scene.surfaces.GetBounds(bounds)
        rows["extent"] = extent(bounds)
    if scene.geodetic_origin:
        rows["origin"] = "latitude {:.6f}, longitude {:.6f} deg, height {:.10g} m".format(*scene.geodetic_origin)
    if scene.lidar_position:
        rows["lidar"] = "({:.10g}, {:.10g}, {:.10g}) m".format(*scene.lidar_position)
    return rows


def scene_notes(scene) -> list[str]:
    """Lines of the report of scene files on what was left out, repaired or assumed."""
    blocks = (scene.surfaces.GetBlock(number) for number in range(scene.surfaces.GetNumberOfBlocks()))
    lines = (line for block in blocks if block is not None for line in field_values(block).get("scene_report", ()))
    return [line for line in lines if not _SIZE.search(line)]


def scene_rows(scene) -> dict[str, Any]:
    """The rows of a scene's table."""
    rows = {"objects": len(scene.objects), "triangles": scene.number_of_triangles}
    if scene.number_of_triangles:
        used = np.unique(vtk_to_numpy(scene.tree.GetOutput().GetCellData().GetArray("material_id")))
        rows["materials"] = ", ".join(scene.materials[number] for number in used if 0 <= number < len(scene.materials))
    return {**rows, **{key: value for key, value in place_rows(scene).items() if key != "cells"}}


def draw_from_above(scene, axes) -> None:
    """Draws the surfaces from above; higher surfaces are darker."""
    from matplotlib.collections import PolyCollection
    if not scene.number_of_triangles:
        return
    corners, triangles = triangles_of(scene.tree.GetOutput())
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.5 * (high[2] - low[2]) + 1
    shades: dict[str, Any] = {"cmap": "Greys", "clim": (low[2] - margin, high[2] + margin)}
    if len(triangles) > MOST:  # draw the highest corner in each cell of a raster
        column, row, _ = (199.999 * (corners - low) / np.maximum(high - low, 1e-9)).astype(int).T
        raster = np.full((200, 200), -np.inf)
        np.maximum.at(raster, (row, column), corners[:, 2])
        axes.imshow(np.ma.masked_invalid(raster), origin="lower", extent=(low[0], high[0], low[1], high[1]), **shades)
    else:
        triangles = corners[triangles]
        heights = triangles[:, :, 2].max(axis=1)
        order = np.argsort(heights)
        axes.add_collection(PolyCollection(triangles[order, :, :2], array=heights[order], edgecolors="face",
                                           linewidths=0.3, **shades))
        axes.autoscale_view()
    if scene.lidar_position:
        axes.plot(*scene.lidar_position[:2], "r+")
    axes.set(xlabel="east (m)", ylabel="north (m)", aspect="equal")


def sensor_rows(sensor) -> dict[str, Any]:
    """The rows of a sensor's table."""
    beams = sensor.beams
    missing, open_pattern = sensor.not_given, set(sensor.not_given) & {*PATTERN, "rotation_rate"}
    rows = {"beams": f"{beams.number_of_points} (pattern not given: default)" if open_pattern else
            beams.number_of_points}
    if beams.number_of_points:
        rows["channels"] = len(np.unique(beams["laser_id"]))
        rows["elevations"] = "{:.4g} to {:.4g} deg".format(beams["vertical_angle"].min(), beams["vertical_angle"].max())
        if {"minimum_elevation", "elevation_step"} & open_pattern:
            rows["elevations"] += " (not given: default)"
    assumed = beams.fields.get("assumed", ())

    def value(name: str, unit: str, scale: float = 1.0) -> str:
        return f"{figures(scale * getattr(sensor, name))} {unit}" + (
            " (assumed)" if name in assumed else " (not given: default)" if name in missing else "")

    rows.update({"position": "({:.10g}, {:.10g}, {:.10g}) m".format(*sensor.position),
                 "wavelength": value("wavelength", "nm"), "range gate": value("range_gate", "m"),
                 "pulse energy": value("pulse_energy", "\u00b5J", 1e6),
                 "full beam width": value("half_beamwidth", "mrad", 2e3), "rate": value("rotation_rate", "Hz")})
    if sensor.trajectory:
        times = point_array(sensor.trajectory, "time")
        rows["trajectory"] = f"{len(times)} poses from {times[0]:.6g} to {times[-1]:.6g} s, in whose frame the position is"
    if sensor.half_beamwidth_across:
        rows["full beam width"] += " by " + value("half_beamwidth_across", "mrad", 2e3)
    said, gaussian = sensor.description, sensor.algorithm.GetBeamProfile() == 1
    shape = ["rectangle" if sensor.algorithm.GetBeamOutline() else "",
             f"turned by {sensor.beam_rotation:g} deg" if sensor.beam_rotation else "",
             f"Gaussian, cut at {sensor.gaussian_truncation:g} radii of 1/e2" if gaussian else ""]
    sheet, factors = said.get("sheet", {}), said.get("range_interval")
    points: list[dict[str, Any]] = sheet.get("points", [])
    errors = [f"; the fit errs by {100 * off:+.0f} %" for off in sheet.get("residuals", ())]
    for number, (point, error) in enumerate(zip(points, itertools.chain(errors, itertools.repeat(""))), 1):
        rows[f"point {number} of the sheet"] = (
            f"{point['range']:g} m at {100 * point['reflectance']:g} %, {point.get('light', 0):g} klx, detected in "
            f"{100 * point.get('probability', 0.5):g} %{'' if 'probability' in point else ' (assumed)'}{error} "
            f"({point['source']})")
    for name, entry in said.get("data_sheet", {}).items() if not sheet else ():
        if name.startswith("detection_"):
            unit = "" if entry["unit"] == "1" else f" {entry['unit']}"
            rows[name.replace("_", " ")] = f"{entry['value']:g}{unit} ({entry['source']})"
    if "bar" in sheet:
        rows["error of the fit"] = f"up to {100 * sheet['bar']:.0f} % of a range, for a point left out"
    if factors:
        rows["interval of ranges"] = f"{factors['value'][0]:g} to {factors['value'][1]:g} times ({factors['source']})"
    rows.update(beam=", ".join(filter(None, shape)), assumed=", ".join(assumed), what=said.get("comment"),
                source=said.get("source"))
    return {key: value for key, value in rows.items() if value not in ("", None)}


def draw_pattern(sensor, axes) -> None:
    """Draws the beams by azimuth and elevation."""
    beams = sensor.beams
    step = -(-max(beams.number_of_points, 1) // MOST)
    axes.plot(beams["azimuth"][::step] / 100, beams["vertical_angle"][::step], ",k")
    axes.set(xlabel="azimuth (deg from north)", ylabel="elevation (deg)")


def scan_rows(scan) -> dict[str, Any]:
    """The rows of a scan's table that need no execution."""
    if not scan.is_current():
        return {"state": "not yet run: read scan.echoes, scan[\"energy\"], scan.update()"}
    echoes = scan.echoes
    rows = {"beams": scan.report.number_of_points, "echoes": echoes.number_of_points, "arrays": ", ".join(echoes)}
    if echoes.number_of_points:
        rows["distances"] = "{} to {} m".format(*(figures(end(echoes["distance_m"]), 5) for end in (np.min, np.max)))
    return {**rows, **{"limit": text for text in to_act_on(echoes.fields)}}


def coverage_rows(cover) -> dict[str, Any]:
    """The rows of a coverage's table that need no execution."""
    air = f"attenuation {cover.attenuation_coefficient:g} per metre"
    rows = {"bird": cover.species or f"target of {cover.effective_area:g} m2",
            "air": f"visibility {figures(cover.visibility)} m" if cover.visibility > 0.0 else air,
            "sensor": "({:.10g}, {:.10g}, {:.10g}) m".format(*cover.sensor.position)}
    if cover.places is None:
        return {**rows, "image": extent(cover.bounds), "spacing": "({:g}, {:g}, {:g}) m".format(*cover.spacing)}
    return {**rows, "places": cover.places.GetNumberOfPoints()}


def line(thing, rows: Callable[[Any], dict[str, Any]]) -> str:
    """The text of `repr`. Never raises an exception."""
    try:
        return f"<{type(thing).__name__}: " + "; ".join(f"{key} {value}" for key, value in rows(thing).items()) + ">"
    except Exception as error:
        return f"<{type(thing).__name__}: {' '.join(str(error).split())}>"
