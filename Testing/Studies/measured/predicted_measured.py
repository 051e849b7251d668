# SPDX-License-Identifier: BSD-3-Clause
"""What is predicted of lidars that one can buy, beside what was measured: sheets, the near range, where ground ends,
noise of ranges, false alarms, the least reflectance, what frames and their simulations lack.

    Testing/Studies/run.py predicted_measured --data DATA       # default: AVIANLIDAR_DATA_DIR

Leaves tables (Markdown, CSV) and a picture. Documentation/evidence/predicted-and-measured.md says what each comparison
knew before, and has them all, also those that fail.
"""
import types

import numpy as np
from scipy.optimize import least_squares

import avianlidar as al
import falloff
import frames
import lacks
import room
import tools
from running import rms, study

GOOD = 0.1      # of a point of a sheet that was left out
ENDS = 0.25     # of the range where ground ends
DARK = 20.0     # reflectivity up to which a point of the ground is ground: brighter ones are paint and things
FALLS = 0.3     # standard error of an exponent from which on it says nothing
MODELS = ("LambertBlinnPhong", "OrenNayar")
NAMED = ("Asphalt", "Concrete", "Grass")


def sheets():
    """Each point of a sheet, predicted by a receiver fitted to the others."""
    rows = []
    for name in al.Sensor.presets():
        sensor = al.Sensor(name)
        points = sensor.description.get("sheet", {}).get("points", [])
        if len(points) < 2:
            continue
        found = sensor.fit()
        for point, off, left in zip(points, found.residuals, found.left_out):
            trust = point["source"].split(":")[0]
            known = "cannot be", "not known", "-"
            if left == left:
                known = f"{100 * left:+.0f} %", f"± {100 * found.bar:.0f} %", frames.verdict(abs(left) <= GOOD)
            rows.append((name, f"{point['reflectance']:g}", f"{point.get('light', 0):g}",
                         f"{point.get('probability', 0.5):g}", f"{point['range']:g}", trust, f"{100 * off:+.0f} %",
                         *known))
    return ("sensor", "reflectance", "light (klx)", "seen with", "range (m)", "source", "fitted to all", "left out",
            "bar of the sensor", f"within {100 * GOOD:.0f} %"), rows


def ground_of(data):
    """Planes of ground of the VLP-16's frame: (plane, distances, cosines, reflectivity in %, rings)."""
    frame = falloff.FRAMES[-1]
    points, ring, distance, shown = falloff.beyond_nearest(al.load_cloud(data / frame.file), frame.field)
    for plane in falloff.find_planes(points, ring):
        on = plane.points[shown[plane.points] <= DARK]
        if plane.kind == "ground":
            yield plane, distance[on], np.abs(points[on] @ plane.normal) / distance[on], shown[on], ring[on]


def rough(kd, s, cosine):
    """What a rough surface returns straight back (Documentation/method/reflectance.md, OrenNayar)."""
    return kd * ((1 - 0.5 * s**2 / (s**2 + 0.33)) * cosine + 0.45 * s**2 / (s**2 + 0.09) * (1 - cosine**2))


def fitted_ground(cosine, reflectivity):
    """kd and roughness (rad) of the ground by Oren and Nayar, to medians of bins of the cosine; and the rms left, of
    the medians."""
    bins = np.round(cosine / 0.02).astype(int)
    x, y = np.array([(cosine[bins == b].mean(), np.median(reflectivity[bins == b]) / 100) for b in np.unique(bins)
                     if (bins == b).sum() >= 20]).T
    best = least_squares(lambda p: rough(*p, x) / y - 1, (0.2, 0.6), bounds=((0.01, 0), (1, 0.5 * np.pi)))
    return *best.x, rms(best.fun)


def end_of(plane, material, model):
    """The range (m) to which VLP16 sees the whole plane, without noise."""
    echoes = al.Scan(al.Scene(falloff.square_on(plane, 200), material=material), al.Sensor("VLP16"),
                     reflectance_model=model, attenuation_coefficient=falloff.AIR, noise=False).echoes
    return float(echoes["distance_m"].max())


def ground(data):
    """Where the ground of the VLP-16's frame ends, and where that of the preset does; the fit of its roughness."""
    planes = list(ground_of(data))
    cosine, shown = (np.concatenate([one[k] for one in planes]) for k in (2, 3))
    kd, roughness, left = fitted_ground(cosine, shown)
    materials = [(name, model, name, model) for name in NAMED for model in MODELS]
    materials.append(("fitted to its reflectivity", "OrenNayar", (kd, 0, 1, roughness), "OrenNayar"))
    rows = []
    for plane, distance, *_ in planes:
        tilt = np.degrees(np.arccos(abs(plane.normal[2])))
        real = float(np.percentile(distance, 99.5))
        for name, model, material, of in materials:
            end = end_of(plane, material, of)
            rows.append((f"{plane.distance:.2f}", f"{tilt:.1f}", name, model, f"{real:.1f}", f"{end:.1f}",
                         f"{end / real:.2f}", frames.verdict(abs(end / real - 1) <= ENDS)))
    header = ("height (m)", "tilt (deg)", "ground", "model", "measured end (m)", "predicted end (m)", "ratio",
              f"within {100 * ENDS:.0f} %")
    return header, rows, (kd, roughness, left)


def walls(data):
    """The exponent by which signal falls with range on walls, matt, beyond the near range, and that of a simulation of
    them."""
    rows = []
    for frame in falloff.FRAMES:
        for plane, windows in falloff.study_of(frame, data / frame.file).planes if frame.field == "signal" else ():
            if plane.kind == "wall":
                # Where the sensor receives in full, if the plane reaches so far.
                (_, found), _, (_, model) = windows[-1]
                off, error = found[0] - model[0], found[1]
                rows.append((frame.name, f"{plane.distance:.1f}", f"{found[2]:.1f} to {found[3]:.1f}",
                             falloff.number(model), falloff.number(found),
                             frames.verdict(abs(off) <= 3 * error) if error < FALLS else "too few to say"))
    return ("frame", "wall (m)", "ranges (m)", "predicted n", "measured n", "within three standard errors"), rows


def noise_of_ranges(points, ring, distance):
    """Standard deviations (m) of ranges along rings on planes: of second differences of five neighbours and more, by
    plane."""
    azimuth = np.arctan2(points[:, 0], points[:, 1])
    found = []
    for plane in falloff.find_planes(points, ring):
        # The range at which the beam meets the plane is known: what is left is noise, and the plane's own shape, which
        # is slow.
        off = distance - plane.distance / np.maximum((points / distance[:, None]) @ plane.normal, 1e-3)
        second = []
        for one in np.unique(ring[plane.points]):
            on = plane.points[ring[plane.points] == one]
            on = on[np.argsort(azimuth[on])]
            step = np.diff(azimuth[on])
            near = step < 3 * np.median(step) if len(step) else step
            second.append(np.diff(off[on], 2)[near[1:] & near[:-1]] if len(on) > 2 else np.zeros(0))
        second = np.concatenate(second)
        cosine = np.median((points[plane.points] / distance[plane.points, None]) @ plane.normal)
        if len(second) >= 100 and cosine > 0.1:
            found.append((1.4826 * np.median(np.abs(second)) / np.sqrt(6), len(second),
                          float(np.median(distance[plane.points]))))
    return found


def ranges(data):
    """Noise of ranges on the planes of each frame, and what the maker's sheet or our sensor file says."""
    rows = []
    for frame in frames.FRAMES:
        name, preset = frame.name, frame.preset
        found = noise_of_ranges(*falloff.beyond_nearest(al.load_cloud(data / frame.file)))
        sheet = al.Sensor(preset).description["data_sheet"] if preset else {}
        said = sheet.get("range_repeatability", sheet.get("range_accuracy", {})).get("value", np.nan)
        quantum = sheet.get("range_resolution", {}).get("value", np.nan)
        if not found:
            rows.append((name, "-", "no plane", "-", f"{100 * said:.1f}", "-"))
            continue
        sigma = np.array([one[0] for one in found])
        rows.append((name, len(found), f"{100 * sigma.min():.2f} to {100 * sigma.max():.2f}",
                     f"{100 * quantum:.2f}" if quantum == quantum else "-",
                     f"{100 * said:.1f}" if said == said else "not in a file here",
                     frames.verdict(sigma.max() <= said) if said == said else "-"))
    return ("frame", "planes", "measured deviation (cm)", "step of the sheet (cm)", "the sheet's accuracy (cm)",
            "not larger"), rows


def of_room(data):
    """Tables of the room's lidars, and of all frames that need its surfaces (frames.py, lacks.py)."""
    options = types.SimpleNamespace(data=data, scans=None, poses=None, desk=room.DESK, sensors=None, only_main=True,
                                    rays=100, threads=0)
    room.complete(options)
    one, result = room.Room(options), room.Result()
    for sensor in options.sensors:
        room.study(one, sensor, options, result)
    alarms, empty = frames.false_alarms(data, one)
    return {"measured-alarms": alarms, "measured-empty": empty, "measured-room": lacks.room_results(one, result),
            "measured-units": lacks.units(data, one), "measured-indoors": lacks.indoors(data, one, result)}


@study(data=[frame.file for frame in frames.FRAMES])
def main(options):
    *table, fit = ground(options.data)
    found = {"measured-sheets": sheets(), "measured-ground": table, "measured-ranges": ranges(options.data),
             "measured-walls": walls(options.data), "measured-least": frames.least_reflectance(options.data),
             "measured-outdoors": lacks.outdoors(options.data), **of_room(options.data),
             "measured-fit": (("kd", "roughness (rad)", "rms left"), [[f"{value:.3f}" for value in fit]])}
    for name, (header, rows) in found.items():
        tools.leave(options.out, name, header, rows, 2)
    frames.picture(options.data, options.out)
    return found
