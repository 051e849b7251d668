# SPDX-License-Identifier: BSD-3-Clause
"""What a real frame holds that its simulation lacks, and the reverse, by class; and the room's results beside what was predicted of
them. `predicted_measured.py` runs it."""
import pathlib
import types

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al

import frames
import falloff
import room
import room_compare
import running

SAME = 0.05         # deg of azimuth: returns of one beam
WHOLE = 200.0       # m, half of the side of a plane
APART = 0.15        # m: what lies so far from its neighbours or from the surface is another thing, as where the room's surface is made
GRAZING = 75.0      # deg of incidence, from which on a matt surface returns a quarter or less
UNIT = {**room_compare.SENSOR, "sampling_interval": 5e-9, "pulse_width": 0.0}  # as assumed in the files of lidars that can be bought
NEAR = 0.25         # of the distance of two returns
WEAKEST = 25        # % of the beams, by their predicted energy
TOP = 255           # of the scales of 8 bits
WHITE = 100.0       # % of reflectivity: brighter is a mirror, a sign or wet
HALO = 0.1          # of a bright point's reflectivity: less beside it, at its range, is its light beside the beam
ACCURACY = 0.02     # m: of the sheets of most of these sensors
MILLIMETRE = 1e-3   # m: ranges in files are rounded
WITHIN = 0.05       # m: about twice that, with the surface's error (1.4 to 1.9 cm) and the pose's (1 cm) beside it
LIKE = 0.95         # of ranges within it: so predicted of two deviations
LOST = 0.01         # of the beams may find no answer where a surface is: the sheets see all but black to ten times the room's size
RANK = 0.5          # of intensity: less is no prediction of single beams


def percent(part, whole):
    return f"{100 * np.sum(part) / max(np.sum(whole), 1):.2f} %"


def in_ring(around, values):
    """Which beams lie between both neighbours of their ring and apart from them, and which before or behind both."""
    left, right = around.ranges(values)[:, :2].T
    one, other = values - left, values - right
    apart = np.minimum(np.abs(one), np.abs(other)) > np.maximum(APART, values * around.slope[:, :2].max(axis=1))
    return apart & (one * other < 0), apart & (one * other > 0)


def bright_and_halo(around, values, shown):
    """Brighter than white; and points beside one, at its range, with a tenth of its reflectivity or less."""
    bright = shown > WHITE
    near = around.ranges(np.where(bright, values, np.nan))
    light = np.where(around.beams >= 0, shown[around.beams], 0)
    return bright, ((np.abs(near - values[:, None]) < APART) & (shown[:, None] <= HALO * light)).any(axis=1)


def seconds(beam, distance):
    """Beams with two returns apart, and the distances (m) between these. @param beam of each return"""
    order = np.lexsort((distance, beam))
    step = np.diff(distance[order])[np.diff(beam[order]) == 0]
    return step[step > APART]


def of_points(frame, data):
    """Beam and distance of each point of a frame with two returns."""
    cloud = al.load_cloud(pathlib.Path(data) / frame.file)
    points, ring = np.array(cloud.points, float), np.array(cloud["laser_id"], int)
    azimuth = np.degrees(np.arctan2(points[:, 0], points[:, 1])) % 360
    return np.round(azimuth / SAME).astype(int) + ring * int(400 / SAME), np.linalg.norm(points, axis=1)


def of_returns(scan, corners, sensor):
    """The same of its simulation when all returns are asked for."""
    lidar = room_compare.echo_filter(scan, corners, sensor=sensor)
    lidar.SetReturnModeToAll()
    running.update(lidar)
    points = lidar.GetOutput().GetPointData()
    return tuple(vtk_to_numpy(points.GetArray(name)) for name in ("beam_id", "distance_m"))


def off_planes(scan, used, planes):
    """Beams without an answer between two that met one plane, of all on planes; and the deviation of points from their planes (cm): of
    the frame, and of its simulation on these planes as wholes."""
    squares = [falloff.square_on(plane, WHOLE) for plane in planes]
    run = room_compare.simulate(scan, np.concatenate([points[np.array(faces)] for points, faces in squares]),
                                region=np.repeat(np.arange(len(planes)), 2))
    plane, between = np.full(len(scan.range), -1), np.full(len(scan.range), -1)
    for i, one in enumerate(planes):
        plane[np.flatnonzero(used)[one.points]] = i
    for a, b in zip(scan.rings(), scan.rings()[1:]):
        known = a + np.flatnonzero(scan.answered[a:b])
        for left, right in zip(known, known[1:]):
            if 1 < right - left <= falloff.RUN and plane[left] == plane[right]:
                between[left + 1:right] = plane[left]
    there, spread = (plane >= 0) | (between >= 0), []
    for ranges, of in ((scan.range, plane), (run.range, np.where(there, run.region, -1))):
        spread.append(np.std(np.concatenate([(ranges[of == i, None] * scan.directions()[of == i]) @ one.normal - one.distance
                                             for i, one in enumerate(planes)])))
    return [percent(lost & there, there) for lost in (between >= 0, ~np.isfinite(run.range))], [f"{100 * value:.1f}" for value in spread]


class Classes:
    """Rows of a table: each class, and of each frame what is measured and, where it is a count of its own, what is simulated of it."""

    def __init__(self):
        self.cells = {}

    def add(self, name, frame, measured, simulated=None):
        self.cells.setdefault(name, {})[frame] = str(measured) if simulated is None else f"{measured} / {simulated}"

    def table(self, names):
        return ("class", *names), [(name, *(cells.get(one, "-") for one in names)) for name, cells in self.cells.items()]


def sees_nearer(preset, least):
    """Does it see a white wall at half its sheet's least range (m)?"""
    wall = falloff.square_on(falloff.Plane("wall", np.array((0.0, 1, 0)), 0.5 * least, None), 10)
    echoes = al.Scan(al.Scene(wall, material=(0.9, 0, 1)), al.Sensor(preset, directions=[(0, 1, 0)]), noise=False).echoes
    return len(echoes["distance_m"]) > 0


def without_answer(azimuth):
    """Degrees of the turn in which no azimuth (deg) lies."""
    return 360 - len(np.unique(np.floor(np.asarray(azimuth) % 360)))


def counted(scan, used, run):
    """Beams whose points count, of the frame and of its simulation: without those that end before, as at a desk."""
    return used, np.isfinite(run.range) & ~(scan.answered & ~used)


def shared(found, frame, data, scan, used, corners):
    """What can be counted in every frame. @param used beams whose points count"""
    run = room_compare.simulate(scan, corners, sensor=UNIT)
    around, name, made, masks = frames.Around(scan), frame.name, np.isfinite(run.range), counted(scan, used, run)
    ranges = [np.where(mask, values, np.nan) for mask, values in zip(masks, (scan.range, run.range))]
    found.add("points", name, *(int(mask.sum()) for mask in masks))
    found.add("answers where the surface has a gap", name, percent(used & ~made, used))
    found.add("no answer where the simulation has one", name, percent(made & ~scan.answered, made & (used | ~scan.answered)))
    found.add("isolated", name, *(percent(around.isolated(values)[0], mask) for mask, values in zip(masks, ranges)))
    for k, what in enumerate(("mixed pixels: between both neighbours of the ring", "spikes: before or behind both")):
        found.add(what, name, *(percent(in_ring(around, values)[k], mask) for mask, values in zip(masks, ranges)))
    if frame.dual:
        steps = seconds(*of_points(frame, data)), seconds(*of_returns(scan, corners, UNIT))
        found.add("two returns", name, *(percent(len(one), mask) for one, mask in zip(steps, (scan.answered, masks[1]))))
    if frame.top:
        found.add("at the top of the scale", name, percent((scan.intensity >= TOP) & used, used),
                  percent(run.energy >= room_compare.SENSOR["upper_energy_limit"], made))
    if frame.reflectivity:
        bright, halo = bright_and_halo(around, ranges[0], frames.field(frame, data, frame.reflectivity))
        found.add("brighter than white", name, int((bright & used).sum()))
        found.add("halo beside these", name, int((halo & used).sum()))
    if frame.preset:
        sensor = al.Sensor(frame.preset)
        if frame.room:
            found.add("rings that answer, or have beams", name, len(np.unique(scan.ring)), len(sensor.channel_elevations))
        found.add("degrees of azimuth without an answer, or a beam", name, without_answer(scan.azimuth[scan.answered]),
                  without_answer(np.degrees(np.arctan2(*np.asarray(sensor.beams["direction"])[:, :2].T))))
        least = sensor.minimum_range
        if least:
            found.add("nearer than the sheet's least range", name, int((scan.range < least - MILLIMETRE).sum()),
                      "seen" if sees_nearer(frame.preset, least) else "none")


def outdoors(data):
    """Each outdoor frame on the surface that it makes itself, and on its planes."""
    found, chosen = Classes(), [frame for frame in frames.FRAMES if not frame.room]
    for frame in chosen:
        file = pathlib.Path(data) / frame.file
        one = room.Room(types.SimpleNamespace(scans=[file], poses={}, desk=falloff.NEAREST, published=None))
        scan, used, corners = one.scans[file.stem], one.used[file.stem], one.parts[file.stem][0]
        shared(found, frame, data, scan, used, corners)
        planes = falloff.find_planes(scan.range[used, None] * scan.directions()[used], scan.ring[used])
        if planes:
            lost, spread = off_planes(scan, used, planes)
            found.add("drop-outs on planes", frame.name, *lost)
            found.add("points off their plane (cm)", frame.name, *spread)
    return found.table([frame.name for frame in chosen])


def indoors(data, one, result):
    """The room's lidars, each on the surface of the other three. @param one the room, @param result of room.study()"""
    found, chosen = Classes(), [frame for frame in frames.FRAMES if frame.room]
    for frame in chosen:
        name = pathlib.Path(frame.file).stem
        scan, used, (run, _, names, bright) = one.scans[name], one.used[name], result.runs[name]
        shared(found, frame, data, scan, used, one.without(name)[0])
        made, wall = np.isfinite(run.range), (run.region >= 0) & (run.region < len(names) - 1)
        both, lost, steep = used & made, made & ~scan.answered, run.incidence > GRAZING
        found.add("no answer, of beams at grazing incidence", frame.name, percent(lost & steep, (lost | both) & steep))
        weak = bright.energy < np.nanpercentile(bright.energy[lost | both], WEAKEST)
        found.add("no answer, of the quarter that is predicted weakest", frame.name, percent(lost & weak, (lost | both) & weak))
        behind = both & (scan.range > run.range + APART)
        found.add("before what the others saw", frame.name, percent(both & (scan.range < run.range - APART), both))
        found.add("behind what the others saw", frame.name, percent(behind, both))
        found.add("behind a plane of the others", frame.name, percent(behind & wall, both & wall))
    return found.table([frame.name for frame in chosen])


def units(data, one):
    """Two returns and mixed pixels of the room's lidars, by the range unit and pulse that are assumed."""
    rows = []
    for frame in frames.FRAMES:
        if frame.room:
            name = pathlib.Path(frame.file).stem
            scan, used, corners = one.scans[name], one.used[name], one.without(name)[0]
            around, steps = frames.Around(scan), [seconds(*of_points(frame, data))]
            mixed = [percent(in_ring(around, np.where(used, scan.range, np.nan))[0], used)]
            for sensor in (UNIT, room_compare.SENSOR):
                run = room_compare.simulate(scan, corners, sensor=sensor)
                mask = counted(scan, used, run)[1]
                mixed.append(percent(in_ring(around, np.where(mask, run.range, np.nan))[0], mask))
                steps.append(seconds(*of_returns(scan, corners, sensor)))
            apart = [np.percentile(step, 1) for step in steps]
            rows.append((frame.name, *(f"{value:.2f}" for value in apart), frames.verdict(abs(apart[1] / apart[0] - 1) <= NEAR), *mixed))
    return ("held out", "two returns apart by (m)", "units of 5 ns", "units of 1 ns, pulse of 2 ns", f"5 ns within {100 * NEAR:.0f} %",
            "mixed pixels", "units of 5 ns", "units of 1 ns, pulse of 2 ns"), rows


def room_results(one, result):
    """The room's numbers beside what was predicted of them."""
    rows, names = [], [row["sensor"] for row in result.summary]

    def add(what, predicted, values, fine, shown="{:.0f} %"):
        rows.append((what, predicted, *(f"{shown.format(value)}, {frames.verdict(fine(value))}" for value in values)))

    def errors(what, key, factor=100):
        return [factor * row[key] for name in names for row in result.errors if (row["sensor"], row["what"]) == (name, what)]

    hits = [(100 * row["with both"] / row["beyond the desk"], 100 - 100 * row["missed from its own scan"] / row["beyond the desk"])
            for row in result.summary]
    rows.append(("points with an echo", "as many as on its own surface", *(
        f"{hit:.0f} of {own:.0f} %, {frames.verdict(hit >= own)}" for hit, own in hits)))
    add("range, median difference (cm)", f"0 ± {100 * ACCURACY:.0f}", errors("all", "median"), lambda x: abs(x) <= 100 * ACCURACY,
        "{:+.1f}")
    for what, label in (("all", ""), ("its own scan", ", on its own surface")):
        add(f"ranges within {100 * WITHIN:.0f} cm{label}", f"{100 * LIKE:.0f} % or more", errors(what, "in5cm"), lambda x: x >= 100 * LIKE)
    lost = [100 * row["false"] / (row["false"] + row["with both"]) for row in result.summary]
    add("no answer where the simulation has one", f"{100 * LOST:.0f} % or less", lost, lambda x: x <= 100 * LOST, "{:.1f} %")
    rank = [row["rank kd as others saw it"] for row in result.intensity if row["region"] == "all"]
    add("intensity, rank correlation", f"{RANK:g} or more", rank, lambda x: x >= RANK, "{:.2f}")
    return ("", "predicted", *(one.names[name] for name in names)), rows
