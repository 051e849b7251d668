# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the room: real and simulated cloud side by side, range images, range errors, intensity by region."""
import matplotlib
import numpy as np
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.util.numpy_support import numpy_to_vtk

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import pictures  # noqa: E402
import room_surface as surface  # noqa: E402

LOW, HIGH = np.array((-9.0, -6.5, -1.5)), np.array((9.0, 4.0, 3.0))  # what is shown of the room, m
HEIGHTS, FARTHEST = (-0.8, 2.4), 9.0  # of its colours, m


class View(pictures.Picture):
    """A picture without a hue bar, so without room for one."""
    right = 20


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


def _colored(points, shown):
    """A cloud of what is shown, coloured by height."""
    points = points[((points > shown.low) & (points < shown.high)).all(axis=1)]
    bottom, top = shown.heights
    colors = (255 * plt.get_cmap("turbo")(np.clip((points[:, 2] - bottom) / (top - bottom), 0, 1))[:, :3]).astype(np.uint8)
    data = surface.cloud(points)
    array = numpy_to_vtk(colors, deep=True, array_type=vtkUnsignedCharArray().GetDataType())
    array.SetName("rgb")
    data.GetPointData().AddArray(array)
    return data


def side_by_side(room, result, sensor, file, shown):
    """Two views from one place, each drawn alone and joined."""
    scan, (main, *_), used = room.scans[sensor], result.runs[sensor], room.used[sensor]
    halves = []
    for words, ranges, mask in (("what the sensor saw", scan.range, used),
                                ("simulated from the others", main.range, np.isfinite(main.range))):
        points = scan.origin + ranges[mask, None] * scan.directions()[mask]
        picture = View(room.names[sensor], f"{words}: {mask.sum()} points", 900, 760)
        picture.dots(_colored(points, shown), 0.00212 * shown.size)
        picture.lidar(scan.origin, 0.0141 * shown.size)
        picture.look(*shown.eye(), 42)
        picture.note("colour: height, {:.1f} m (blue) to {:.1f} m (red); red plus: the lidar".format(*shown.heights))
        half = file.with_name(f"{file.stem}-{len(halves)}.png")
        picture.save(half)
        halves.append(plt.imread(half))
        half.unlink()
    plt.imsave(file, np.hstack(halves))


def range_images(room, result, sensor, file, farthest):
    """Real range, simulated range and their difference over azimuth and elevation, beam by beam."""
    scan, (main, *_) = room.scans[sensor], result.runs[sensor]
    real = np.where(room.used[sensor], scan.range, np.nan)
    figure, axes = plt.subplots(3, 1, figsize=(13, 8), sharex=True, constrained_layout=True)
    shown = ((real, "what the sensor saw beyond the desk", "viridis", 0, farthest, "range (m)"),
             (main.range, "simulated from the others", "viridis", 0, farthest, "range (m)"),
             (main.range - real, "simulated minus real", "RdBu_r", -0.3, 0.3, "difference (m)"))
    for axis, (values, title, colors, low, high, label) in zip(axes, shown):
        there = np.isfinite(values)
        dots = axis.scatter(scan.azimuth[there] % 360, scan.elevation[there], c=values[there], s=2.5, marker="s",
                            linewidths=0, cmap=colors, vmin=low, vmax=high, rasterized=True)
        axis.set_facecolor("0.93")
        axis.set_title(f"{room.names[sensor]}: {title}", loc="left", fontsize=12)
        axis.set_ylabel("elevation (deg)")
        figure.colorbar(dots, ax=axis, label=label, pad=0.01)
    axes[-1].set_xlim(0, 360)
    axes[-1].set_xlabel("azimuth in the sensor's frame (deg)")
    figure.savefig(file, dpi=90)
    plt.close(figure)


def error_plot(room, result, file):
    """Left: how many beams have an error below d. Right: the errors themselves."""
    figure, axes = plt.subplots(1, 2, figsize=(13, 5), constrained_layout=True)
    for sensor, (main, *_) in result.runs.items():
        both = room.used[sensor] & np.isfinite(main.range)
        errors = (main.range - room.scans[sensor].range)[both]
        size = np.sort(abs(errors))
        axes[0].plot(100 * size, 100 * np.arange(1, len(size) + 1) / len(size), label=room.names[sensor])
        counts, edges = np.histogram(100 * errors, bins=np.arange(-30, 30.5, 0.5))
        axes[1].plot((edges[1:] + edges[:-1]) / 2, 100 * counts / len(errors))
    axes[0].set_xscale("log")
    axes[0].set_xlim(0.1, 1000)
    axes[0].set_ylim(0, 100)
    axes[0].set_xlabel("size of the range error (cm)")
    axes[0].set_ylabel("beams with an error below (%)")
    axes[0].legend(loc="lower right")
    axes[1].set_xlabel("simulated minus real range (cm)")
    axes[1].set_ylabel("beams per 0.5 cm (%)")
    for axis in axes:
        axis.grid(alpha=0.3)
    figure.savefig(file, dpi=90)
    plt.close(figure)


def intensity_plot(room, result, sensor, file):
    """Real intensity over simulated energy, the larger regions in colours of their own."""
    scan, (main, _, names, bright) = room.scans[sensor], result.runs[sensor]
    same = room.used[sensor] & (abs(main.range - scan.range) < 0.1) & np.isfinite(bright.energy)
    figure, axis = plt.subplots(figsize=(8, 6), constrained_layout=True)
    for i in (len(names) - 1, *range(len(names) - 1)):
        mask = same & (main.region == i)
        if mask.sum() < 50:
            continue
        other = names[i] == surface.OTHER
        axis.scatter(bright.energy[mask], scan.intensity[mask], s=5, linewidths=0, alpha=0.35 if other else 0.9,
                     color="0.7" if other else None, label=f"{names[i]} ({mask.sum()} beams)")
    axis.set_xlabel("simulated energy (J of a pulse of 1 J), kd as the others saw it")
    axis.set_ylabel("real intensity (0 to 255)")
    axis.set_title(room.names[sensor], loc="left")
    axis.legend(markerscale=3, fontsize=9, loc="upper left")
    axis.grid(alpha=0.3)
    figure.savefig(file, dpi=90)
    plt.close(figure)


def draw(room, result, folder):
    error_plot(room, result, folder / "errors.png")
    shown = Shown(room)
    for sensor in result.runs:
        side_by_side(room, result, sensor, folder / f"{sensor}-clouds.png", shown)
        range_images(room, result, sensor, folder / f"{sensor}-ranges.png", shown.farthest)
        intensity_plot(room, result, sensor, folder / f"{sensor}-intensity.png")
