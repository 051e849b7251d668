# SPDX-License-Identifier: BSD-3-Clause
"""Against reality: one room seen by four real lidars, or any scans that the point cloud reader reads. For each in turn
the surface is made from the other scans (of one scan alone, from itself), the scan is simulated from the sensor's real
place with its real beams, and compared with what it saw. Leaves tables (.csv, .md) and range images.

    Testing/Studies/run.py room --data DATA     # default: AVIANLIDAR_DATA_DIR
    Testing/Studies/run.py room --no-pictures --sensors xt32 --only-main
    Testing/Studies/run.py room --no-pictures --scans a.pcd b.las c.bin --poses poses.json --desk 0

A scan is a file of one turn in the sensor's frame, or with the sensor's place in its header. Poses are {"a": {"T": [4
rows of 4 numbers]}, ...}, from the coordinates of the file to common ones; without one they are the same.

Documentation/evidence/real-scans.md says what they are and what comes out.
"""
import os
import pathlib

import numpy as np
from vtkmodules.vtkIOPLY import vtkPLYReader

import room_compare as compare
import room_data
import room_surface as surface
import running
import tools
from running import argument

DESK = 1.2  # m around the middle of the sensors: what lay there differs from scan to scan
SAME = 0.1  # m: a beam met the same thing in both scans
FARTHEST = 9.0  # m, of the colours of the room's ranges


def complete(options):
    """Adds the room's scans and poses, unless other scans are given, and the names of the scans to simulate."""
    options.published = None
    if options.scans:
        options.poses = room_data.read_poses(options.poses) if options.poses else {}
    else:
        folder = pathlib.Path(options.data) / "lidar_room"
        if not folder.is_dir():
            raise ValueError(f"there is no folder lidar_room in the data folder '{options.data}'")
        options.scans, options.poses = room_data.room_files(folder)
        options.published = folder / room_data.MESH
    names = [file.stem for file in options.scans]
    if len(set(names)) < len(names):
        raise ValueError(f"scans of the same name: {' '.join(names)}")
    for wanted, what in ((options.sensors or [], "--sensors"), (options.poses, "--poses")):
        for name in wanted:
            if name not in names:
                raise ValueError(f"{what}: there is no scan {name} among {' '.join(names)}")
    options.sensors = options.sensors or names


class Room:
    """The scans, which beams left the desk, and the triangles that each scan alone makes."""

    def __init__(self, options):
        self.published, self.desk = options.published, options.desk
        self.scans = {file.stem: room_data.read_scan(file, options.poses.get(file.stem)) for file in options.scans}
        self.names = {name: room_data.ROOM.get(name, name) if self.published else name for name in self.scans}
        self.eye = np.mean([scan.origin for scan in self.scans.values()], axis=0)
        self.used = {name: self._beyond_the_desk(scan) for name, scan in self.scans.items()}
        self.parts = {name: surface.triangulated(scan, self.used[name]) for name, scan in self.scans.items()}
        # Each sensor has an intensity scale of its own.
        self.scale = {name: np.median(bright[bright > 0]) if (bright > 0).any() else 1.0
                      for name, (_, bright) in self.parts.items()}

    def _beyond_the_desk(self, scan):
        places = scan.origin + np.nan_to_num(scan.range)[:, None] * scan.directions()
        return scan.answered & (np.linalg.norm(places - self.eye, axis=1) > self.desk)

    def far_from_desk(self, corners):
        return corners[(np.linalg.norm(corners - self.eye, axis=2) > self.desk).all(axis=1)]

    def without(self, sensor, carve=True):
        """Triangles of the other scans, or of the only one, and their brightness on a common scale."""
        others = self.others(sensor)
        corners, brightness = [], []
        for name in others:
            part, bright = self.parts[name]
            keep = surface.carved(part, [self.scans[n] for n in others if n != name]) if carve else slice(None)
            corners.append(part[keep])
            brightness.append(bright[keep] / self.scale[name])
        return np.concatenate(corners), np.concatenate(brightness)

    def others(self, sensor):
        return [name for name in self.scans if name != sensor] or [sensor]

    def as_published(self):
        """The surface of all four scans that comes with the data."""
        reader = vtkPLYReader()
        reader.SetFileName(str(self.published))
        running.update(reader)
        return self.far_from_desk(surface.triangles_of(reader.GetOutput()))


def other_runs(room, sensor, options):
    """(label, surface, half beamwidth) of the runs that tell what a difference is due to."""
    main, others = room.without(sensor)[0], room.others(sensor)
    half = compare.SENSOR["half_beamwidth"]
    rows = [("half beamwidth 0.5 mrad", main, 0.5e-3), ("half beamwidth 3 mrad", main, 3e-3),
            ("what moved is kept", room.without(sensor, carve=False)[0], half)]
    if not room.published:
        return rows
    distance = room.far_from_desk(surface.distance_surface([room.scans[n] for n in others],
                                                           [room.used[n] for n in others]))
    return rows + [("VTK's signed distance", distance, half),
                   ("the published mesh of all four", room.as_published(), half)]


def fitted_row(room, sensor, options):
    """Range errors from the pose that fits best to the others' surface, and how far that is from the given one."""
    corners, scan = room.without(sensor)[0], room.scans[sensor]
    fitted = compare.fitted_pose(scan, room.used[sensor], corners)
    run = compare.simulate(fitted, corners, rays=options.rays, threads=options.threads)
    turn = np.trace(scan.pose[:3, :3].T @ fitted.pose[:3, :3])
    moved = {"moved": np.linalg.norm(fitted.origin - scan.origin),
             "turned": np.degrees(np.arccos(min(1, (turn - 1) / 2)))}
    return error_row(room, sensor, run, "pose fitted"), moved


def error_row(room, sensor, run, what, mask=True):
    """Range errors of one run as a row of errors.csv."""
    scan, used = room.scans[sensor], room.used[sensor]
    both = used & np.isfinite(run.range) & mask
    return {"sensor": sensor, "what": what, "beams": int(both.sum()),
            **compare.spread_of((run.range - scan.range)[both])}


def cloud_row(room, sensor, run, what, real, simulated):
    scan = room.scans[sensor]
    place = scan.origin + run.range[simulated, None] * scan.directions()[simulated]
    seen = scan.origin + scan.range[real, None] * scan.directions()[real]
    return {"sensor": sensor, "what": what, "real": len(seen), "simulated": len(place), **compare.clouds(place, seen)}


def fitted_kd(brightness, region, number):
    """Diffuse coefficients from the brightness seen by the other three: of each region, and of each triangle."""
    middle = np.ones(number + 1)
    for i in range(number + 1):
        if (region == i).any():
            middle[i] = np.median(brightness[region == i])
    return (np.clip(compare.KD * values, 1e-3, 1.0) for values in (middle[region], brightness))


def intensity_rows(room, sensor, runs, names):
    """Rank correlation of simulated energy with real intensity, and the spread of their ratio, by region."""
    scan, rows = room.scans[sensor], []
    first = next(iter(runs.values()))
    same = room.used[sensor] & (abs(first.range - scan.range) < SAME)
    same &= np.all([np.isfinite(run.energy) for run in runs.values()], axis=0)
    for i, name in [(None, "all"), *enumerate(names)]:
        mask = same if i is None else same & (first.region == i)
        row = {"sensor": sensor, "region": name, "beams": int(mask.sum())}
        for model, run in runs.items():
            row[f"rank {model}"] = compare.rank_correlation(run.energy[mask], scan.intensity[mask])
            row[f"factor {model}"] = compare.factor(run.energy[mask], scan.intensity[mask])
        rows.append(row)
    return rows


class Result:
    """Rows of the tables, and what the pictures need."""

    def __init__(self):
        self.summary, self.errors, self.clouds, self.intensity, self.runs = [], [], [], [], {}


def study(room, sensor, options, result):
    """One sensor against the surface of the other three."""
    scan, used = room.scans[sensor], room.used[sensor]
    corners, brightness = room.without(sensor)
    planes = surface.find_planes(corners, room.eye)
    region = surface.regions(corners, room.eye, planes)
    names = [plane[0] for plane in planes] + [surface.OTHER]
    of_region, of_triangle = fitted_kd(brightness, region, len(planes))

    def simulate(surfaces=corners, half=compare.SENSOR["half_beamwidth"], rays=options.rays, **more):
        return compare.simulate(scan, surfaces, half_beamwidth=half, rays=rays, threads=options.threads, **more)

    runs = {"one kd": simulate(region=region), "kd of the region": simulate(region=region, kd=of_region),
            "kd as others saw it": simulate(region=region, kd=of_triangle)}
    main = runs["one kd"]
    axis = simulate(half=1e-7, rays=2)
    seen, both = np.isfinite(main.range), used & np.isfinite(main.range)
    on_plane = (main.region >= 0) & (main.region < len(planes))
    result.errors += [error_row(room, sensor, main, "all"), error_row(room, sensor, main, "on planes", on_plane),
                      error_row(room, sensor, main, "not on planes", ~on_plane),
                      error_row(room, sensor, axis, "rays on the axes")]
    own = simulate(room.parts[sensor][0])
    own_both = used & np.isfinite(own.range)
    result.clouds += [cloud_row(room, sensor, main, "all", used, seen),
                      cloud_row(room, sensor, main, "beams with both", both, both),
                      cloud_row(room, sensor, main, "on planes", both & on_plane, both & on_plane),
                      cloud_row(room, sensor, own, "from its own scan", own_both, own_both)]
    result.errors.append(error_row(room, sensor, own, "its own scan"))
    if not options.only_main:
        for label, surfaces, half in other_runs(room, sensor, options):
            result.errors.append(error_row(room, sensor, simulate(surfaces, half), label))
    row, moved = fitted_row(room, sensor, options)
    result.errors.append(row)
    off, _ = compare.Nearest(corners)(scan.origin + scan.range[both, None] * scan.directions()[both], 0.5)
    result.intensity += intensity_rows(room, sensor, runs, names)
    against_axis = compare.spread_of((main.range - axis.range)[both & np.isfinite(axis.range)])
    result.summary.append({
        "sensor": sensor, "beams": len(used), "answered": int(scan.answered.sum()), "beyond the desk": int(used.sum()),
        "triangles": len(corners), "with both": int(both.sum()), "missed": int((used & ~seen).sum()),
        "no surface on the axis": int((used & ~np.isfinite(axis.range)).sum()),
        "false": int((seen & ~scan.answered).sum()),
        "from the surface, median": np.median(off), "from the surface, 90 %": np.percentile(off, 90),
        "beam against axis, spread": against_axis["spread"], "range noise": compare.range_noise(scan, used),
        "missed from its own scan": int((used & ~own_both).sum()), **moved})
    result.runs[sensor] = main, region, names, runs["kd as others saw it"]


def leave_tables(result, names, folder):
    """The tables of the page. Regions of intensity are those met by at least 100 beams."""
    def cm(value):
        return "-" if np.isnan(value) else f"{100 * value:.1f}"

    def share(part, whole=1):
        return f"{100 * part / max(whole, 1):.1f} %"

    def leave(name, rows, *columns):
        """@param columns heading and what makes a cell of a row"""
        tools.leave(folder, f"room-{name}", ("held out", *(heading for heading, _ in columns)), [
            (names[row["sensor"]], *(cell(row) for _, cell in columns)) for row in rows], 2)

    def keys(shown, **headings):
        return ((heading, lambda row, key=key: shown(row[key])) for key, heading in headings.items())

    def beyond(key):
        return lambda row: share(row[key], row["beyond the desk"])

    leave("summary", result.summary, ("", lambda row: ""), *keys(str, beams="beams"),
          ("answered", lambda row: share(row["answered"], row["beams"])),
          *keys(str, **{"beyond the desk": "from beyond the desk"}), ("with an echo in both", beyond("with both")),
          ("missed", beyond("missed")), ("without surface on the axis", beyond("no surface on the axis")),
          ("missed from its own scan", beyond("missed from its own scan")), *keys(str, false="false"))
    leave("errors", result.errors, *keys(str, what="run", beams="beams"),
          *keys(cm, median="median (cm)", spread="spread (cm)", p05="5 % (cm)", p95="95 % (cm)"),
          *keys(share, in2cm="within 2 cm", in5cm="5 cm", in10cm="10 cm"))
    leave("clouds", result.clouds, *keys(str, what="points", real="real", simulated="simulated"),
          *keys("{:.3f}".format, rmse_rs="RMSE, real to simulated (m)", rmse_sr="RMSE, simulated to real (m)"),
          *keys("{:.2f}".format, hausdorff="Hausdorff (m)", density_aware_chamfer="density-aware Chamfer"))
    leave("parts", result.summary, ("", lambda row: ""), *keys(cm, **{
        "from the surface, median": "real points from the surface: median (cm)", "from the surface, 90 %": "90 % (cm)",
        "beam against axis, spread": "beam against its axis: spread (cm)",
        "range noise": "range noise of the sensor (cm)",
        "moved": "fitted pose: moved (cm)"}), *keys("{:.2f}".format, turned="turned (deg)"))
    models = [key[5:] for key in result.intensity[0] if key.startswith("rank ")]
    leave("intensity", [row for row in result.intensity if row["beams"] >= 100],
          *keys(str, region="region", beams="beams"),
          *keys(lambda value: "-" if np.isnan(value) else f"{value:.2f}",
                **{f"rank {m}": f"rank correlation, {m}" for m in models},
                **{f"factor {m}": f"factor, {m}" for m in models}))


def draw(room, result, sensor, file):
    """Real range, simulated range and their difference over azimuth and elevation, beam by beam."""
    scan, (main, *_) = room.scans[sensor], result.runs[sensor]
    real = np.where(room.used[sensor], scan.range, np.nan)
    farthest = FARTHEST if room.published else np.nanpercentile(scan.range, 95)
    shown = ((real, "what the sensor saw beyond the desk", "viridis", 0, farthest, "range (m)"),
             (main.range, "simulated from the others", "viridis", 0, farthest, "range (m)"),
             (main.range - real, "simulated minus real", "RdBu_r", -0.3, 0.3, "difference (m)"))
    with tools.figure(file, 3, 1, figsize=(13, 8), dpi=90, sharex=True) as axes:
        for axis, (values, title, colors, low, high, label) in zip(axes, shown):
            there = np.isfinite(values)
            dots = axis.scatter(scan.azimuth[there] % 360, scan.elevation[there], c=values[there], s=2.5, marker="s",
                                linewidths=0, cmap=colors, vmin=low, vmax=high, rasterized=True)
            axis.set(facecolor="0.93", ylabel="elevation (deg)", xlim=(0, 360))
            axis.set_title(f"{room.names[sensor]}: {title}", loc="left", fontsize=12)
            axis.figure.colorbar(dots, ax=axis, label=label, pad=0.01)
        axis.set_xlabel("azimuth in the sensor's frame (deg)")


@running.study(
    argument("--data", default=os.environ.get("AVIANLIDAR_DATA_DIR", ""), help="the data folder; it holds lidar_room"),
    argument("--scans", nargs="+", type=running.file, help="files to take instead of the room's: .pcd, .las, .bin"),
    argument("--poses", type=running.file, help="JSON, where the scans' coordinates lie in common ones"),
    argument("--desk", type=running.finite, default=DESK,
             help=f"m around the middle of the sensors that are left out, default {DESK}"),
    argument("--sensors", nargs="+", metavar="SCAN", help="which are simulated, by name of file, default all"),
    argument("--only-main", action="store_true", help="no other surfaces and beamwidths to compare with"),
    argument("--rays", type=running.whole(1, 1000000), default=100, help="rays per beam, default 100"),
    argument("--threads", type=running.whole(0, 4096), default=0, help="default 0: all cores"),
    argument("--no-pictures", action="store_true", help="tables alone"))
def main(options):
    complete(options)
    room, result = Room(options), Result()
    for sensor in options.sensors:
        study(room, sensor, options, result)
    leave_tables(result, room.names, options.out)
    if not options.no_pictures:
        for sensor in result.runs:
            draw(room, result, sensor, options.out / f"{sensor}-ranges.png")
    return room, result
