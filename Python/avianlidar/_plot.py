# SPDX-License-Identifier: BSD-3-Clause
"""Pictures with Matplotlib, which is imported here only."""
from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable

from . import vtkAvianLidar as _wrapped

LABELS = {"distance_m": "distance (m)", "energy": "energy (\u00b5J)", "candidates": "triangles looked at",
          "nodes_visited": "nodes visited", "rays_traced": "rays traced", "skipped_bound": "skipped, at most (J)",
          "small_targets_left_out": "small targets left out"}
# What becomes of a beam, by `status`, and the colours of ParaView's preset "Avian lidar status".
STATUS = {"echo": (0, 0.62, 0.45), "no surface": (0.83, 0.83, 0.83), "below the lower limit": (0, 0.45, 0.7),
          "saturated": (0.84, 0.37, 0), "outside the gate": (0.8, 0.47, 0.65)}


def hue_colors():
    """The colours of energy as a Matplotlib colour map, blue (lower limit) to red (upper limit): paper, Eq. 13."""
    from matplotlib.colors import ListedColormap
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    _wrapped.vtkAvianLidarHSBColorMap().FillLookupTable(table)
    return ListedColormap(vtk_to_numpy(table.GetTable()) / 255.0, name="avianlidar_energy")


def _axis(values, name: str, unit: str, count: str):
    """Positions and label of rows or columns: angles where they increase, else numbers."""
    if (np.diff(values) > 0).all():
        return values, f"{name} ({unit})"
    return np.arange(len(values)), count


def _status_colours(axes):
    """Options for pixels of `status`, and their legend."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch
    axes.legend(handles=[Patch(color=colour, label=name) for name, colour in STATUS.items()], ncol=len(STATUS),
                loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    return {"cmap": ListedColormap(list(STATUS.values())), "vmin": -0.5, "vmax": len(STATUS) - 0.5}


def plot_range_image(scan, array: str = "distance_m", axes=None, **options):
    """Draw the range image of a scan with Matplotlib: azimuth (degrees from north, clockwise) by elevation (degrees).

    array    `distance_m` (m), `energy` (shown in microjoules, in the colours of vtkAvianLidarHSBColorMap between the
             limits of the sensor), `object_id` (each object a colour), `status` (what became of each beam), or what a
             beam cost and did without: `nodes_visited`, `candidates`, `rays_traced`, `skipped_bound` (J),
             `small_targets_left_out`
    axes     of Matplotlib to draw into; default: new ones
    options  of Matplotlib's `pcolormesh`

    Returns the axes. Where there is no echo, nothing is drawn of echoes.
    """
    import matplotlib.pyplot as plt

    image = scan.range_image()
    known = ("distance_m", "energy", "object_id", "status", *list(LABELS)[2:])
    if array not in known:
        raise ValueError(f"cannot draw {array!r} of a range image; known are {', '.join(known)}")
    if axes is None:
        _, axes = plt.subplots(figsize=(10, 3), constrained_layout=True)
    values = np.ma.masked_invalid(image[array].astype(float))
    if array == "energy":
        low, high = (1e6 * scan.echoes.fields[name] for name in ("lower_energy_limit", "upper_energy_limit"))
        values = 1e6 * values
        options = {"cmap": hue_colors(), "vmin": low, "vmax": high, **options}
    elif array == "object_id":
        values = np.ma.masked_less(values, 0) % 20
        options = {"cmap": "tab20", "vmin": -0.5, "vmax": 19.5, **options}
    elif array == "status":
        options = {**_status_colours(axes), **options}
    x, across = _axis(image["column_azimuths"], "azimuth", "deg from north", "column")
    y, up = _axis(image["row_elevations"], "elevation", "deg", "channel")
    mesh = axes.pcolormesh(x, y, values, **{"shading": "nearest", "rasterized": True, **options})
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    if array in LABELS:
        axes.figure.colorbar(mesh, ax=axes, label=LABELS[array])
    return axes
