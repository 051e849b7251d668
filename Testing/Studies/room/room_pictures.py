# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the room: real and simulated cloud side by side, range images, range errors, intensity by region."""
import numpy as np
from matplotlib import colormaps
from corridor_pictures import View

import room_surface as surface
import tools

LOW, HIGH = np.array((-9.0, -6.5, -1.5)), np.array((9.0, 4.0, 3.0))  # what is shown of the room, m
HEIGHTS, FARTHEST = (-0.8, 2.4), 9.0  # of its colours, m


class Shown:
    """What is shown: the room's inside, or where nine tenths of the points of other scans lie."""

    def __init__(self, room):
        self.low, self.high, self.heights, self.farthest = LOW, HIGH, HEIGHTS, FARTHEST
        if not room.published:
            points = np.concatenate([scan.points(room.desk)[0] for scan in room.scans.values()])
            self.low, self.high = np.percentile(points, (5, 95), axis=0) + np.array([[-1.0], [1.0]])
            self.heights = tuple(np.percentile(points[:, 2], (5, 95)))
            self.farthest = np.nanpercentile(np.concatenate([scan.range for scan in room.scans.values()]), 95)
        self.size = np.linalg.norm(self.high - self.low)

    def eye(self):
        """Where the pictures are taken from, and what they look at."""
        middle = self.low + (self.high - self.low) * (0.456, 0.467, 0.444)
        return middle + self.size * np.array((0.202, 0.521, 0.376)), middle


def side_by_side(room, result, sensor, file, shown):
    """The real and the simulated cloud in two views from one place, coloured by height."""
    scan, (main, *_), used = room.scans[sensor], result.runs[sensor], room.used[sensor]
    bottom, top = shown.heights
    with tools.figure(file, 1, 2, figsize=(18, 8)) as axes:
        for axis, words, ranges, mask in ((axes[0], "what the sensor saw", scan.range, used),
                                          (axes[1], "simulated from the others", main.range, np.isfinite(main.range))):
            points = scan.origin + ranges[mask, None] * scan.directions()[mask]
            points = points[((points > shown.low) & (points < shown.high)).all(axis=1)]
            view = View(900, 760)
            view.dots(points, 255 * colormaps["turbo"](np.clip((points[:, 2] - bottom) / (top - bottom), 0, 1))[:, :3], 0.00212 * shown.size)
            view.dots([scan.origin], [(217, 0, 0)], 0.0141 * shown.size)
            axis.imshow(view.image(*shown.eye(), 42))
            axis.set_axis_off()
            axis.set_title(f"{room.names[sensor]}, {words}: {mask.sum()} points", loc="left")
        bar = axes[0].scatter([], [], c=[], cmap="turbo", vmin=bottom, vmax=top)
        axes[0].figure.colorbar(bar, ax=list(axes), label="height (m)", shrink=0.6)


def range_images(room, result, sensor, file, farthest):
    """Real range, simulated range and their difference over azimuth and elevation, beam by beam."""
    scan, (main, *_) = room.scans[sensor], result.runs[sensor]
    real = np.where(room.used[sensor], scan.range, np.nan)
    shown = ((real, "what the sensor saw beyond the desk", "viridis", 0, farthest, "range (m)"),
             (main.range, "simulated from the others", "viridis", 0, farthest, "range (m)"),
             (main.range - real, "simulated minus real", "RdBu_r", -0.3, 0.3, "difference (m)"))
    with tools.figure(file, 3, 1, figsize=(13, 8), dpi=90, sharex=True) as axes:
        for axis, (values, title, colors, low, high, label) in zip(axes, shown):
            there = np.isfinite(values)
            dots = axis.scatter(scan.azimuth[there] % 360, scan.elevation[there], c=values[there], s=2.5, marker="s", linewidths=0, cmap=colors,
                                vmin=low, vmax=high, rasterized=True)
            axis.set(facecolor="0.93", ylabel="elevation (deg)", xlim=(0, 360))
            axis.set_title(f"{room.names[sensor]}: {title}", loc="left", fontsize=12)
            axis.figure.colorbar(dots, ax=axis, label=label, pad=0.01)
        axis.set_xlabel("azimuth in the sensor's frame (deg)")


def error_plot(room, result, file):
    """Left: how many beams have an error below d. Right: the errors themselves."""
    with tools.figure(file, 1, 2, figsize=(13, 5), dpi=90) as (left, right):
        for sensor, (main, *_) in result.runs.items():
            both = room.used[sensor] & np.isfinite(main.range)
            errors = (main.range - room.scans[sensor].range)[both]
            size = np.sort(abs(errors))
            left.plot(100 * size, 100 * np.arange(1, len(size) + 1) / len(size), label=room.names[sensor])
            counts, edges = np.histogram(100 * errors, bins=np.arange(-30, 30.5, 0.5))
            right.plot((edges[1:] + edges[:-1]) / 2, 100 * counts / len(errors))
        left.set(xscale="log", xlim=(0.1, 1000), ylim=(0, 100), xlabel="size of the range error (cm)", ylabel="beams with an error below (%)")
        left.legend(loc="lower right")
        right.set(xlabel="simulated minus real range (cm)", ylabel="beams per 0.5 cm (%)")
        for axis in (left, right):
            axis.grid(alpha=0.3)


def intensity_plot(room, result, sensor, file):
    """Real intensity over simulated energy, the larger regions in colours of their own."""
    scan, (main, _, names, bright) = room.scans[sensor], result.runs[sensor]
    same = room.used[sensor] & (abs(main.range - scan.range) < 0.1) & np.isfinite(bright.energy)
    with tools.figure(file, figsize=(8, 6), dpi=90) as axis:
        for i in (len(names) - 1, *range(len(names) - 1)):
            mask, other = same & (main.region == i), names[i] == surface.OTHER
            if mask.sum() >= 50:
                axis.scatter(bright.energy[mask], scan.intensity[mask], s=5, linewidths=0, alpha=0.35 if other else 0.9,
                             color="0.7" if other else None, label=f"{names[i]} ({mask.sum()} beams)")
        axis.set(xlabel="simulated energy (J of a pulse of 1 J), kd as the others saw it", ylabel="real intensity (0 to 255)")
        axis.set_title(room.names[sensor], loc="left")
        axis.legend(markerscale=3, fontsize=9, loc="upper left")
        axis.grid(alpha=0.3)


def draw(room, result, folder):
    error_plot(room, result, folder / "errors.png")
    shown = Shown(room)
    for sensor in result.runs:
        side_by_side(room, result, sensor, folder / f"{sensor}-clouds.png", shown)
        range_images(room, result, sensor, folder / f"{sensor}-ranges.png", shown.farthest)
        intensity_plot(room, result, sensor, folder / f"{sensor}-intensity.png")
