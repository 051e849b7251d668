# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of coverage."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Sequence, Tuple

import numpy as np

from ..._coverage import Coverage
from ..._plot import status_colours
from ...reach import Reach
from ..pages._drawing import WIDTH, finish, series
from ..pages._placing import Label, place_labels
from ..places._from_above import draw_airport, draw_land
from ..places._regions import APPROACH_LENGTH, Runway, end_names, ends_of, region_outlines
from ._plan import Plan

# Colours of vtkAvianLidarCoverage's statuses.
STATUS_COLOURS = ["#" + "".join(f"{round(255 * value):02x}" for value in colour)
                  for colour in status_colours("AvianLidarCoverageStatus.json").values()]
HIGH = 160.0  # height of the section, m; one tenth more than the plan's greatest height if that is larger
GLIDE_PATH = 3.0  # slope of the glide path, deg
THRESHOLD_HEIGHT = 15.0  # height of the glide path above a runway's end, m
OUTLINES = (0.1, 0.5)  # probabilities whose outlines are drawn on the first page
AROUND_SITES = 150.0  # margin around the candidates on their map, m
SHOWN = 250  # pixels along the longer side of the map on the first page
NEAR = 0.3  # part of an approach that is on the map on the first page
AROUND = 0.07  # margin around the map on the first page, as a share of the longer side
SIDES = (0.4, 0.56)  # least and greatest ratio of height to width of the map on the first page
BAR = (1.03, 0.0, 0.04, 1.0)  # place of a colour bar as high as the map, in parts of the map
MOST_MAPS = 5  # greatest number of maps in a row
STEP = (10.0, 2.0)  # steps of the section along the runway and upwards, m


def map_heights(plan: Plan) -> List[float]:
    """The heights of the maps on a page, at most MOST_MAPS."""
    chosen = np.linspace(0, len(plan.heights) - 1, min(len(plan.heights), MOST_MAPS)).round().astype(int)
    return [plan.heights[i] for i in chosen]


def row_size(plan: Plan, most: float) -> Tuple[float, float]:
    """Size of a row of maps, inches. @param most greatest height"""
    count, beside, above = len(map_heights(plan)), 1.4, 1.0  # inches for labels and colour bar
    x0, x1, y0, y1 = plan.extent
    ratio = float(np.clip((y1 - y0) / max(x1 - x0, 1e-9), 0.25, 3.0))
    height = min((WIDTH - beside) / count * ratio + above, most)
    return min(WIDTH, max((height - above) / ratio * count + beside, 6.2)), height


def draw_maps(panels, plan: Plan, quantity: str) -> None:
    """Draws maps of probabilities or of statuses, one for each of `map_heights`, with one colour bar or legend."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch
    panels, is_status, there = np.ravel(panels).tolist(), quantity == "status", np.zeros(len(STATUS_COLOURS), bool)
    style: Dict[str, Any] = {"cmap": "viridis", "vmin": 0.0, "vmax": 1.0}
    if is_status:
        limits = np.arange(len(STATUS_COLOURS) + 1) - 0.5
        style = {"cmap": ListedColormap(STATUS_COLOURS), "norm": BoundaryNorm(limits, len(STATUS_COLOURS))}
    for axes, height in zip(panels, map_heights(plan)):
        cover = plan.map_at(height)
        values = cover["status"] if is_status else plan.mixed(cover, quantity)
        there[np.unique(cover["status"])] = True
        data = cover.data
        first, step, count = (np.array(of[:2]) for of in (data.GetOrigin(), data.GetSpacing(), data.GetDimensions()))
        extent = np.transpose([first - 0.5 * step, first + (count - 0.5) * step]).ravel()
        image = axes.imshow(values[0], origin="lower", extent=extent, interpolation="nearest", **style)
        draw_airport(axes, plan, "0.1" if is_status else "0.75")
        axes.locator_params(nbins=3)
        axes.set_title(f"{height:g} m up")
        if axes is not panels[0]:
            axes.set(ylabel="", yticklabels=[])
    figure = panels[0].figure
    if is_status:
        names = zip(cover.status_names, STATUS_COLOURS, there)
        patches = [Patch(facecolor=colour, edgecolor="0.5", label=name) for name, colour, seen in names if seen]
        room = (0.15 + 0.19 * -(-len(patches) // 4)) / figure.get_figheight()
        figure.get_layout_engine().set(rect=(0.0, room, 1.0, 1.0 - room))
        figure.legend(handles=patches, loc="lower center", ncols=4, frameon=False)
    else:
        figure.colorbar(image, ax=panels, label="probability of one scan", fraction=0.05, pad=0.01)


def _near(plan: Plan) -> Dict[str, np.ndarray]:
    """Outlines of the plan's strips and of the beginnings of its approaches, which would make the map small."""
    parts = {name: (outline, NEAR if name.startswith("approach") else 1.0)
             for name, outline in region_outlines(plan.runways).items() if name in plan.ends}
    return {name: np.array([a, a + part * (b - a), d + part * (c - d), d])
            for name, ((a, b, c, d), part) in parts.items()}


def answer_extent(plan: Plan, reach: float) -> Tuple[float, float, float, float]:
    """Extent of the map on the first page, m: the runways, the plan's regions near runways, and the circle about the
    sensor where birds are detected; without runways the plan's map. @param reach radius of the circle, m"""
    outlines = [*_near(plan).values()]
    corners = np.reshape(plan.extent, (2, 2)).T
    if outlines:
        around = np.array(plan.sensor.position[:2]) + np.outer([-reach, reach], [1.0, 1.0])
        corners = np.concatenate([*outlines, ends_of(plan.runways), around])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = (1.0 + 2.0 * AROUND) * np.maximum(high - low, 1.0) if outlines else high - low
    width = max(size[0], size[1] / SIDES[1])
    half = 0.5 * np.array([width, max(size[1], width * SIDES[0])])
    middle = 0.5 * (low + high)
    (x0, y0), (x1, y1) = (middle - half).tolist(), (middle + half).tolist()
    return x0, x1, y0, y1


def found_at(plan: Plan, extent: Sequence[float]) -> List[Tuple[float, np.ndarray]]:
    """For each height of the plan, m, the number of OUTLINES that the probability reaches, rows from south to north."""
    x0, x1, y0, y1 = extent
    step = max(x1 - x0, y1 - y0, 1.0) / (SHOWN - 1)
    cover, spacing, classes = plan.coverage, plan.coverage.spacing, []
    for height in plan.heights:
        cover.set(bounds=(x0, x1, y0, y1, height, height), spacing=(step, step, 1.0))
        classes.append((height, np.digitize(plan.mixed(cover)[0], OUTLINES)))
    cover.spacing = spacing
    return classes


def draw_answer(axes, plan: Plan, found: Sequence[Tuple[float, np.ndarray]], extent: Tuple[float, float, float, float],
                shares: Mapping[str, str]) -> List[str]:
    """Draws the airport with the sensor, the regions of the plan, and for each height the areas where the probability
    is above OUTLINES. @param found result of `found_at` @param shares shares of each region in words @return labels for
    which there is no room"""
    from matplotlib import colormaps, patches
    x0, x1, y0, y1 = extent
    legend = []
    lines = [np.linspace(runway.start, runway.end, 50) for runway in plan.runways]
    for number, (height, classes) in enumerate(found):
        colour = colormaps["viridis"](0.9 * number / max(len(found) - 1, 1))
        here = (np.linspace(x0, x1, classes.shape[1]), np.linspace(y0, y1, classes.shape[0]))
        for limit in (1, 2):
            if min(classes.shape) > 1 and classes.min() < limit <= classes.max():
                outlines = axes.contour(*here, classes, [limit - 0.5], colors=[colour], linewidths=1.0,
                                        linestyles="--" if limit == 1 else "-")
                lines += [part for level in outlines.allsegs for part in level]
        if min(classes.shape) > 1 and (classes == 2).any():
            axes.contourf(*here, classes, [1.5, 2.5], colors=[colour], alpha=0.45)
        words = {2: "", 1: ": nowhere half", 0: ": nowhere a tenth"}[int(classes.max(initial=0))]
        legend.append(patches.Patch(facecolor=colour, alpha=0.6, label=f"{height:g} m up{words}"))
    draw_land(axes, plan)
    outlines = region_outlines(plan.runways)
    for name in plan.ends if plan.runways else ():
        axes.plot(*np.concatenate([outlines[name], outlines[name][:1]]).T, ":", color="0.3", linewidth=1.0)
    draw_airport(axes, plan, "0.55")
    axes.set(xlim=(x0, x1), ylim=(y0, y1))
    place = plan.sensor.position[:2]
    axes.plot(*place, "r^", markersize=11, markeredgecolor="white", zorder=5)
    axes.legend(handles=legend, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4, frameon=False)
    return place_labels(axes, labels_of(plan, shares), [place], np.concatenate([np.empty((0, 2)), *lines]))


def labels_of(plan: Plan, shares: Mapping[str, str]) -> List[Label]:
    """Labels of the map on the first page: the sensor, the ends of the runways, and the plan's regions with the share
    of each. @param shares shares of the regions in words"""
    found = [Label(plan.name, plan.sensor.position[:2], style={"color": "red"})]
    for runway, names in zip(plan.runways, end_names(plan.runways)):
        found += [Label(name, end, way, {"weight": "bold"})
                  for name, (end, way) in zip(names, runway.ends())]
    middle = ends_of(plan.runways).mean(axis=0) if plan.runways else np.zeros(2)
    for name, outline in _near(plan).items():
        sides = 0.5 * (outline[[0, 3]] + outline[[1, 2]])  # the middles of both sides
        outer = max(sides, key=lambda side: round(float(np.hypot(*(side - middle))), 3))
        words = "\n".join(filter(None, (name, shares.get(name, ""))))
        found.append(Label(words, outer, outer - outline.mean(axis=0)))
    return found


def section(plan: Plan, runway: Runway) -> Tuple[np.ndarray, Tuple[float, float, float, float]]:
    """Probabilities above the middle of a runway and its approaches, rows from the ground up, and their extent: m along
    the runway from its first end, m above ground."""
    axis, length = runway.axis()
    along = np.arange(-APPROACH_LENGTH, length + APPROACH_LENGTH, STEP[0])
    heights = np.arange(0.0, max(HIGH, 1.1 * plan.asked[1] if plan.asked else 0.0) + 1.0, STEP[1])
    ground = np.asarray(runway.start) + along[:, None] * axis
    places = np.concatenate([np.column_stack([ground, np.full(len(along), z)]) for z in heights])
    values = plan.mixed(Coverage(plan.scene, plan.sensor, places=places, **plan.settings))
    return (values.reshape(len(heights), -1),
            (along[0] - STEP[0] / 2, along[-1] + STEP[0] / 2, -STEP[1] / 2, heights[-1] + STEP[1] / 2))


def draw_sections(panels, plan: Plan, runways: Sequence[Runway]) -> None:
    """Draws sections with the runway, glide paths that end 15 m above its ends, and the heights of the plan."""
    panels = np.ravel(panels).tolist()
    for axes, runway in zip(panels, runways):
        values, extent = section(plan, runway)
        _, length = runway.axis()
        image = axes.imshow(values, origin="lower", aspect="auto", extent=extent, cmap="viridis", vmin=0.0, vmax=1.0)
        axes.plot([0.0, length], [0.5, 0.5], color="white", linewidth=3)
        top = THRESHOLD_HEIGHT + np.tan(np.radians(GLIDE_PATH)) * APPROACH_LENGTH
        for start, sign in ((0.0, -1.0), (length, 1.0)):
            axes.plot([start, start + sign * APPROACH_LENGTH], [THRESHOLD_HEIGHT, top], "w--", linewidth=1)
        for height in plan.asked or ():
            axes.axhline(height, color="white", linestyle=":", linewidth=1)
        axes.set(xlim=extent[:2], ylim=(0.0, extent[3]), ylabel="m up", title=runway.name)
        axes.xaxis.set_major_formatter(lambda value, _: f"{value / 1000.0:g}")
    panels[-1].set_xlabel("km along the runway from its first end")
    panels[0].figure.colorbar(image, ax=panels, label="probability of one scan", fraction=0.05, pad=0.01)


def draw_reach(axes, reaches: Mapping[str, Reach], several: str) -> None:
    """Draws shares of birds by range, with bars of one standard error. @param reaches by the name of the curve @param
    several name of the dashed curve, such as "2 of 3 scans" """
    series(axes)
    for name, reach in reaches.items():
        line = axes.errorbar(reach.ranges, reach.one_scan, reach.error, linewidth=1.5, elinewidth=1.0, markevery=6,
                             label=f"{name}, one scan")
        axes.plot(reach.ranges, reach.several_scans, "--", color=line[0].get_color(), linewidth=1.2, marker="")
    axes.plot([], [], "--", color="0.4", linewidth=1.2, marker="", label=several)
    finish(axes, xlim=(0.0, None), ylim=(0.0, 1.02), xlabel="range, m", ylabel="share of birds detected")


def draw_weather(axes, curves: Mapping[str, Tuple[Sequence[float], ...]], words: str, logarithmic: bool) -> None:
    """Draws shares of birds by weather, with bars of one standard error. @param curves by name: weathers, shares,
    errors @param words label of the weathers' axis"""
    series(axes)
    for name, (weathers, shares, errors) in curves.items():
        axes.errorbar(weathers, 100.0 * np.array(shares), 100.0 * np.array(errors), linewidth=1.5, elinewidth=1.0,
                      label=name)
    if logarithmic:
        axes.set_xscale("log")
        axes.set_xticks(weathers, [f"{weather:g}" for weather in weathers])
        axes.minorticks_off()
    finish(axes, ylim=(0.0, None), xlabel=words, ylabel="birds detected by one scan, %")


def draw_outline(axes, outline) -> None:
    """Draws in light grey an area where no lidar may stand. @param outline a ring (n x 2, m), or a ring and holes"""
    from matplotlib import patches, path
    paths = []
    for number, ring in enumerate([outline] if np.ndim(outline[0]) == 1 else outline):
        turns_left = np.cross(ring, np.roll(ring, -1, axis=0)).sum() > 0.0
        ring = ring if turns_left == (number == 0) else ring[::-1]  # holes turn the other way
        paths.append(path.Path([*ring, ring[0]], closed=True))
    axes.add_patch(patches.PathPatch(path.Path.make_compound_path(*paths), color="0.9", zorder=0))


def draw_sites(axes, sites) -> None:
    """Draws candidates by value, areas where no lidar may stand, and the best network."""
    draw_land(axes, sites.plan)
    draw_airport(axes, sites.plan, "0.1")
    for outline, _ in sites.exclusions:
        draw_outline(axes, outline)
    for one in sites.surfaces:
        if "strip" in one.kept:
            draw_outline(axes, one.strip)
    x, y, _ = sites.positions[sites.order[::-1]].T
    dots = axes.scatter(x, y, c=100.0 * sites.values[sites.order[::-1]], s=22, cmap="viridis")
    axes.figure.colorbar(dots, cax=axes.inset_axes(BAR), label="share by which candidates are ranked, %")
    members = list(sites.networks[-1].sites)
    axes.scatter(*sites.positions[members, :2].T, s=130, facecolors="none", edgecolors="red", linewidths=2,
                 label=f"best {len(members)} together" if len(members) > 1 else "best")
    axes.plot([], [], "r^", markersize=5, label="where the plan puts the sensor")
    axes.scatter(*sites.positions[sites.order[0], :2], s=80, marker="x", color="red", linewidths=2, label="best alone")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2, handletextpad=0.2, columnspacing=1, frameon=False)
    extent = sites_extent(sites)
    axes.set(xlim=extent[:2], ylim=extent[2:])
    places = sites.positions[:, :2]
    place_labels(axes, [Label(f"rank {sites.rank_of(site)}", tuple(places[site])) for site in members], places[members])


def sites_extent(sites) -> Tuple[float, float, float, float]:
    """Extent of the map of candidates, m."""
    low, high = sites.positions[:, :2].min(axis=0) - AROUND_SITES, sites.positions[:, :2].max(axis=0) + AROUND_SITES
    return low[0], high[0], low[1], high[1]
