# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the room: real and simulated cloud side by side, range images, range errors, intensity by region."""
import matplotlib
import numpy as np
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.util.numpy_support import numpy_to_vtk

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import pictures  # noqa: E402
import room_data  # noqa: E402
import room_surface as surface  # noqa: E402

ROOM = (-9.0, 9.0, -6.5, 4.0, -1.5, 3.0)  # what is shown, m


class View(pictures.Picture):
    """A picture without a hue bar, so without room for one."""
    right = 20


def _colored(points):
    """A cloud of the room's inside, coloured by height."""
    low, high = np.array(ROOM)[::2], np.array(ROOM)[1::2]
    points = points[((points > low) & (points < high)).all(axis=1)]
    colors = (255 * plt.get_cmap("turbo")(np.clip((points[:, 2] + 0.8) / 3.2, 0, 1))[:, :3]).astype(np.uint8)
    data = surface.cloud(points)
    array = numpy_to_vtk(colors, deep=True, array_type=vtkUnsignedCharArray().GetDataType())
    array.SetName("rgb")
    data.GetPointData().AddArray(array)
    return data


def side_by_side(room, result, sensor, file):
    """Two views from one place, each drawn alone and joined."""
    scan, (main, *_), used = room.scans[sensor], result.runs[sensor], room.used[sensor]
    halves = []
    for words, ranges, mask in (("what the sensor saw", scan.range, used),
                                ("simulated from the other three", main.range, np.isfinite(main.range))):
        points = scan.origin + ranges[mask, None] * scan.directions()[mask]
        picture = View(room_data.NAMES[sensor], f"{words}: {mask.sum()} points", 900, 760)
        picture.dots(_colored(points), 0.045)
        picture.lidar(scan.origin, 0.3)
        picture.look((3.5, 9.5, 8.5), (-0.8, -1.6, 0.5), 42)
        picture.note("colour: height, -0.8 m (blue) to 2.4 m (red); red plus: the lidar")
        half = file.with_name(f"{file.stem}-{len(halves)}.png")
        picture.save(half)
        halves.append(plt.imread(half))
        half.unlink()
    plt.imsave(file, np.hstack(halves))


def range_images(room, result, sensor, file):
    """Real range, simulated range and their difference over azimuth and elevation, beam by beam."""
    scan, (main, *_) = room.scans[sensor], result.runs[sensor]
    real = np.where(room.used[sensor], scan.range, np.nan)
    figure, axes = plt.subplots(3, 1, figsize=(13, 8), sharex=True, constrained_layout=True)
    shown = ((real, "what the sensor saw beyond the desk", "viridis", 0, 9, "range (m)"),
             (main.range, "simulated from the other three", "viridis", 0, 9, "range (m)"),
             (main.range - real, "simulated minus real", "RdBu_r", -0.3, 0.3, "difference (m)"))
    for axis, (values, title, colors, low, high, label) in zip(axes, shown):
        there = np.isfinite(values)
        dots = axis.scatter(scan.azimuth[there] % 360, scan.elevation[there], c=values[there], s=2.5, marker="s",
                            linewidths=0, cmap=colors, vmin=low, vmax=high, rasterized=True)
        axis.set_facecolor("0.93")
        axis.set_title(f"{room_data.NAMES[sensor]}: {title}", loc="left", fontsize=12)
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
        axes[0].plot(100 * size, 100 * np.arange(1, len(size) + 1) / len(size), label=room_data.NAMES[sensor])
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
    axis.set_xlabel("simulated energy (J of a pulse of 1 J), kd as the other three saw it")
    axis.set_ylabel("real intensity (0 to 255)")
    axis.set_title(room_data.NAMES[sensor], loc="left")
    axis.legend(markerscale=3, fontsize=9, loc="upper left")
    axis.grid(alpha=0.3)
    figure.savefig(file, dpi=90)
    plt.close(figure)


def draw(room, result, folder):
    error_plot(room, result, folder / "errors.png")
    for sensor in result.runs:
        side_by_side(room, result, sensor, folder / f"{sensor}-clouds.png")
        range_images(room, result, sensor, folder / f"{sensor}-ranges.png")
        intensity_plot(room, result, sensor, folder / f"{sensor}-intensity.png")
