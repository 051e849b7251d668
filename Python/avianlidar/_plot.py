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
LONGEST = 40  # letters of a name in a picture
CJK = ("Noto Sans CJK JP", "WenQuanYi Micro Hei")  # fonts for letters that Matplotlib's own font lacks


def shortened(name: str) -> str:
    """A name that leaves room for others."""
    return name if len(name) <= LONGEST else name[:LONGEST - 1] + "\u2026"


def fonts():
    """Matplotlib's own font, and fonts with Chinese and Japanese letters as far as there are."""
    from matplotlib import font_manager
    known = {font.name for font in font_manager.fontManager.ttflist}
    return ["DejaVu Sans", *(name for name in CJK if name in known)]


def _borders(values):
    """Borders between positions that rise."""
    if len(values) < 2:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    inner = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2 * values[0] - inner[0]], inner, [2 * values[-1] - inner[-1]]])


def _crop(axes, x, y, shown, turns: bool) -> float:
    """Limits the axes to what returns, with room for names above. @param turns whether x is an azimuth
    @return azimuth at which the drawn turn begins, behind the widest gap, if what returns lies about north, else nan"""
    columns, rows = x[shown.any(axis=0)], y[shown.any(axis=1)]
    gaps = np.diff(columns)
    start = columns[np.argmax(gaps) + 1] if turns and len(gaps) and gaps.max() > 180.0 else np.nan
    columns = np.where(columns < start, columns + 360.0, columns)
    for values, ends, set_limits, room in ((x, columns, axes.set_xlim, 0.02), (y, rows, axes.set_ylim, 0.08)):
        borders = _borders(values)
        step = 0.5 * float(np.diff(borders).mean())
        low, high = ends.min() - step, ends.max() + step
        margin = room * (high - low) + step
        set_limits(max(low - margin, borders[0]), high + margin if values is y or start == start else
                   min(high + margin, borders[-1]))
    return float(start)


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
            name, (rows, columns) = shortened(names[number]), np.nonzero(objects == number)
            (low, high), middle = axes.get_xlim(), float(np.median(x[columns]))
            half = 0.005 * len(name) * (high - low)
            at = min(max(middle, low + half), high - half)
            if all(abs(at - other) > half + width for other, width in taken):  # else two names would overlap
                taken.append((at, half))
                axes.annotate(name, (at, _borders(y)[rows.max() + 1]), (0, 2), textcoords="offset points", ha="center",
                              va="bottom", fontsize=8, annotation_clip=True, parse_math=False, family=fonts())


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
    options = {"rasterized": True, **options}
    mesh = axes.pcolormesh(_borders(x), _borders(y), values, **options)
    axes.set(xlabel=across, ylabel=up)
    if array in echoes and (image["echo"] >= 0).any():
        start = _crop(axes, x, y, image["echo"] >= 0, "azimuth" in across)
        if start == start:  # the columns before the start follow those at the end
            axes.pcolormesh(_borders(x) + 360.0, _borders(y), values, **options)
            axes.xaxis.set_major_formatter(lambda at, _: f"{at % 360:g}")
        if names:
            _mark(axes, image["object_id"], echoes.fields, np.where(x < start, x + 360.0, x), y)
    if array not in ("object_id", "status"):
        axes.figure.colorbar(mesh, ax=axes, label=label)
    return axes
