# SPDX-License-Identifier: BSD-3-Clause
"""Pictures with Matplotlib, which only the functions import."""
import json
import pathlib

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable

from . import vtkAvianLidar as _wrapped
from ._look import scale_of

LABELS = {"distance_m": "distance (m)", "candidates": "triangles tested", "skipped_bound": "skipped, at most (J)"}


def status_colours(preset: str):
    """{name: (red, green, blue)} of the statuses in a colour preset of ParaView, a file of this package."""
    (found,) = json.loads(pathlib.Path(__file__).with_name(preset).read_text(encoding="utf-8"))
    return dict(zip(found["Annotations"][1::2], map(tuple, np.reshape(found["IndexedColors"], (-1, 3)).tolist())))


STATUS = status_colours("AvianLidarStatus.json")  # of beams


def hue_colors():
    """The colours of energy as a Matplotlib colour map, from blue (lower limit) to red (upper limit): paper, Eq. 13."""
    from matplotlib.colors import ListedColormap
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    _wrapped.vtkAvianLidarHSBColorMap().FillLookupTable(table)
    return ListedColormap(vtk_to_numpy(table.GetTable()) / 255.0, name="avianlidar_energy")


def _axis(values, name: str, unit: str, count: str):
    """Positions and label of rows or columns: angles if these increase, else numbers."""
    if (np.diff(values) > 0).all():
        return values, f"{name} ({unit})"
    return np.arange(len(values)), count


def _status_colours(axes):
    """Options for pixels of `status`, and the legend of the statuses."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch
    axes.legend(handles=[Patch(color=colour, label=name) for name, colour in STATUS.items()], ncol=len(STATUS),
                loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    return {"cmap": ListedColormap(list(STATUS.values())), "vmin": -0.5, "vmax": len(STATUS) - 0.5}


DECADES = 100.0  # ratio of energies above which the scale is logarithmic


def _label(name: str, unit: str) -> str:
    text = name.replace("_", " ").replace("$", r"\$")
    return LABELS.get(name, text if unit in ("", "1") else f"{text} ({unit})")


def _values(cloud, name: str):
    """An array of a cloud as numbers to draw, with drawing options and a label."""
    values = np.asarray(cloud[name], dtype=float)
    if values.ndim > 1:
        raise ValueError(f"cannot draw {name!r}, which has {values.shape[1]} components")
    if name == "energy":
        low, high = (cloud.fields.get(key) for key in ("lower_energy_limit", "upper_energy_limit"))
        least, most = values[values > 0.0].min(initial=np.inf), values.max(initial=0.0)
        # As for a photon receiver.
        decades = (least if low is None else low) * DECADES < (most if high is None else high)
        limits = {"vmin": least} if decades else {}
        if low is not None and high is not None:
            most = min(high, most) if decades and most > low else high
            limits = {"vmin": low, "vmax": most}
        unit, scale = scale_of(most)
        options = {"cmap": hue_colors(), **{key: limit * scale for key, limit in limits.items()}}
        return values * scale, {**options, "norm": "log"} if decades else options, _label(name, unit)
    if name == "object_id":
        return np.ma.masked_less(values, 0) % 20, {"cmap": "tab20", "vmin": -0.5, "vmax": 19.5}, name
    return values, {}, _label(name, cloud.units[name])


def plot_map(cloud, array: str = "energy", axes=None, **options):
    """Draws points from above with Matplotlib: east by north (m), coloured by an array.

    cloud    a Cloud, or a Scan, whose echoes are drawn
    array    any point array of one component. Energy has a unit that fits, such as microjoules, and the colours of
             vtkAvianLidarHSBColorMap between the limits of the sensor, logarithmic if the limits are decades apart
    axes     axes of Matplotlib to draw into; default: new axes
    options  options of Matplotlib's `scatter`

    Returns the axes.
    """
    import matplotlib.pyplot as plt
    cloud = getattr(cloud, "echoes", cloud)
    values, known, label = _values(cloud, array)
    if axes is None:
        _, axes = plt.subplots(figsize=(7, 6), constrained_layout=True)
    dots = axes.scatter(*cloud.points[:, :2].T, c=values, **{"s": 4, "rasterized": True, **known, **options})
    axes.set(xlabel="east (m)", ylabel="north (m)", aspect="equal")
    axes.figure.colorbar(dots, ax=axes, label=label)
    return axes


MOST_NAMES = 8  # objects with names in a range image


def _crop(axes, x, y, shown) -> None:
    """Limits the axes to what returns, with room for names above."""
    for values, ends, set_limits, room in ((x, shown.any(axis=0), axes.set_xlim, 0.02), (y, shown.any(axis=1),
                                                                                         axes.set_ylim, 0.08)):
        step = 0.5 * float(np.median(np.diff(values))) if len(values) > 1 else 0.5
        low, high = values[np.flatnonzero(ends)[[0, -1]]] + (-step, step)
        whole = values[0] - step, values[-1] + step
        margin = room * (high - low) + 2.0 * step
        set_limits(max(low - margin, whole[0]), high + margin if set_limits == axes.set_ylim else
                   min(high + margin, whole[1]))


def _mark(axes, objects, fields, x, y) -> None:
    """Marks birds by circles, and names the objects with the most pixels that have a name of their own."""
    names, classes = (list(fields.get(name, ())) for name in ("object_names", "object_classes"))
    birds = [number for number, word in enumerate(classes) if word == "bird"]
    rows, columns = np.nonzero(np.isin(objects, birds))
    if len(rows):
        axes.plot(x[columns], y[rows], "o", markerfacecolor="none", markeredgecolor="black", markersize=9, label="bird")
        axes.legend(loc="upper right")
    numbers, counts = np.unique(objects[objects >= 0], return_counts=True)
    taken: list[tuple[float, float]] = []  # middle and half width
    for number in numbers[np.argsort(-counts, kind="stable")]:
        if (number < len(names) and number not in birds and len(taken) < MOST_NAMES
                and _wrapped.vtkAvianLidarLandmarks.IsOwnName(names[number])):
            rows, columns = np.nonzero(objects == number)
            at, half = float(np.median(x[columns])), 0.005 * len(names[number]) * float(np.ptp(axes.get_xlim()))
            if all(abs(at - other) > half + width for other, width in taken):  # else two names would overlap
                taken.append((at, half))
                top = y[rows.max()] + (0.5 * (y[1] - y[0]) if len(y) > 1 else 0.5)
                axes.annotate(names[number], (at, top), (0, 2), textcoords="offset points", ha="center",
                              va="bottom", fontsize=8, annotation_clip=True)


def plot_range_image(scan, array: str = "distance_m", axes=None, names: bool = True, **options):
    """Draws the range image of a scan with Matplotlib: azimuth (degrees from north, clockwise) by elevation (degrees).
    Arrays of echoes are drawn where something returns, which limits the axes.

    array    `distance_m` (m), `energy` (in a unit that fits, such as microjoules, in the colours of
             vtkAvianLidarHSBColorMap between the limits of the sensor, logarithmic if the limits are decades apart),
             `object_id` (one colour for each object), `status` (the status of each beam), costs of each beam
             (`nodes_visited`, `candidates`, `rays_traced`), its `skipped_bound` (J), or any point array of the echoes,
             taken from the strongest echo of each beam
    axes     axes of Matplotlib to draw into; default: new axes
    names    whether birds and named objects are marked in arrays of echoes
    options  options of Matplotlib's `pcolormesh`

    Returns the axes. Arrays of echoes leave beams without an echo blank.
    """
    import matplotlib.pyplot as plt

    image, echoes = scan.range_image(), scan.echoes
    if axes is None:
        _, axes = plt.subplots(figsize=(10, 3), constrained_layout=True)
    if array in image and image[array].ndim == 2 and array not in echoes:
        values, known, label = np.ma.masked_invalid(image[array].astype(float)), {}, _label(array, "")
    else:
        values, known, label = _values(echoes, array)
        values = np.ma.masked_array(np.ma.append(values, np.ma.masked)[image["echo"]], image["echo"] < 0)
    options = {**known, **(_status_colours(axes) if array == "status" else {}), **options}
    x, across = _axis(image["column_azimuths"], "azimuth", "deg from north", "column")
    y, up = _axis(image["row_elevations"], "elevation", "deg", "channel")
    mesh = axes.pcolormesh(x, y, values, **{"shading": "nearest", "rasterized": True, **options})
    axes.set(xlabel=across, ylabel=up)
    if array in echoes and (image["echo"] >= 0).any():
        _crop(axes, x, y, image["echo"] >= 0)
        if names:
            _mark(axes, image["object_id"], echoes.fields, x, y)
    if array not in ("object_id", "status"):
        axes.figure.colorbar(mesh, ax=axes, label=label)
    return axes
