# SPDX-License-Identifier: BSD-3-Clause
"""What scenes, sensors and scans look like in a notebook: a small table and, with Matplotlib, a picture."""
from __future__ import annotations

import base64
import html
import io
from typing import Any, Callable, Dict, Optional

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ._sight import extent

MOST = 20000  # triangles or beams that a picture shows


def page(title: str, rows: Dict[str, Any], draw: Optional[Callable[[Any], None]] = None, size=(4.0, 3.0)) -> str:
    """HTML of a table and a picture. @param draw draws into axes of Matplotlib @param size of the picture, inches"""
    lines = "".join(f"<tr><th style='text-align:left'>{html.escape(key)}</th><td style='text-align:left'>"
                    f"{html.escape(str(value))}</td></tr>" for key, value in rows.items())
    return f"<b>{html.escape(title)}</b><table>{lines}</table>{_picture(draw, size) if draw else ''}"


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


def scene_rows(scene) -> Dict[str, Any]:
    """The rows of a scene's table."""
    rows = {"objects": len(scene.objects), "triangles": scene.number_of_triangles}
    if scene.number_of_triangles:
        used = np.unique(vtk_to_numpy(scene.tree.GetOutput().GetCellData().GetArray("material_id")))
        rows["materials"] = ", ".join(scene.materials[number] for number in used if 0 <= number < len(scene.materials))
        rows["extent"] = extent(scene.bounds)
    if scene.geodetic_origin:
        rows["origin"] = "latitude {:.6f}, longitude {:.6f} deg, height {:g} m".format(*scene.geodetic_origin)
    if scene.lidar_position:
        rows["lidar"] = "({:g}, {:g}, {:g}) m".format(*scene.lidar_position)
    return rows


def draw_plan(scene, axes) -> None:
    """The triangles from above, darker where they are higher."""
    from matplotlib.collections import PolyCollection
    surfaces = scene.tree.GetOutput()
    if not surfaces.GetNumberOfPolys():
        return
    corners = vtk_to_numpy(surfaces.GetPoints().GetData())
    triangles = vtk_to_numpy(surfaces.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    triangles = corners[triangles[::-(-len(triangles) // MOST)]]
    heights = triangles[:, :, 2].max(axis=1)
    order = np.argsort(heights)
    axes.add_collection(PolyCollection(triangles[order, :, :2], array=heights[order], cmap="Greys", edgecolors="0.4",
                                       linewidths=0.3, clim=(heights.min() - 0.5 * max(np.ptp(heights), 1), heights.max() + 1e-9)))
    if scene.lidar_position:
        axes.plot(*scene.lidar_position[:2], "r+")
    axes.autoscale_view()
    axes.set(xlabel="east (m)", ylabel="north (m)", aspect="equal")


def sensor_rows(sensor) -> Dict[str, Any]:
    """The rows of a sensor's table."""
    beams = sensor.beams
    rows = {"beams": beams.number_of_points}
    if beams.number_of_points:
        rows["channels"] = len(np.unique(beams["laser_id"]))
        rows["elevations"] = "{:.4g} to {:.4g} deg".format(beams["vertical_angle"].min(), beams["vertical_angle"].max())
    rows.update({"position": "({:g}, {:g}, {:g}) m".format(*sensor.position), "wavelength": f"{sensor.wavelength:g} nm",
                 "range gate": f"{sensor.range_gate:g} m", "pulse energy": f"{1e6 * sensor.pulse_energy:g} \u00b5J",
                 "full beam width": f"{2e3 * sensor.half_beamwidth:g} mrad", "rate": f"{sensor.rotation_rate:g} Hz"})
    if "assumed" in beams.fields:
        rows["assumed"] = ", ".join(beams.fields["assumed"])
    said = sensor.description
    rows.update({title: said[key] for title, key in (("what", "comment"), ("source", "source")) if key in said})
    return rows


def draw_pattern(sensor, axes) -> None:
    """The beams by azimuth and elevation."""
    beams = sensor.beams
    step = -(-max(beams.number_of_points, 1) // MOST)
    axes.plot(beams["azimuth"][::step] / 100, beams["vertical_angle"][::step], ",k")
    axes.set(xlabel="azimuth (deg from north)", ylabel="elevation (deg)")


def scan_rows(scan) -> Dict[str, Any]:
    """The rows of a scan's table, of what is known without running it."""
    if not scan.is_current():
        return {"state": "not yet run: ask for scan.echoes, scan[\"energy\"], scan.update()"}
    echoes = scan.echoes
    rows = {"beams": scan.report.number_of_points, "echoes": echoes.number_of_points, "arrays": ", ".join(echoes)}
    if echoes.number_of_points:
        rows["distances"] = "{:.5g} to {:.5g} m".format(echoes["distance_m"].min(), echoes["distance_m"].max())
    return rows


def line(thing, rows: Callable[[Any], Dict[str, Any]]) -> str:
    """For `repr`: never an error."""
    try:
        return f"<{type(thing).__name__}: " + "; ".join(f"{key} {value}" for key, value in rows(thing).items()) + ">"
    except Exception as error:
        return f"<{type(thing).__name__}: {' '.join(str(error).split())}>"
