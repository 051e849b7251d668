# SPDX-License-Identifier: BSD-3-Clause
"""How do the birds look, how much do they show, and how far are they seen? Draws the species, prints their effective
areas, and draws the share of birds that one pulse detects against range, with its standard error: each of many birds at
that range has its own heading, wing phase, and beam through its body, and no two birds are in one beam.

    Testing/Studies/run.py birds --out build/birds"""
import sys
import warnings

import numpy as np
from matplotlib.collections import PolyCollection
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

from avianlidar import Scan, Scene, Sensor
from avianlidar.vtkAvianLidar import vtkAvianLidarBirdSource

import tools
from running import argument, made, study, whole

SPECIES = ("starling", "kestrel", "pigeon", "crow", "herring gull", "Canada goose")
AIR = 8.9e-5  # 1/m
ELEVATION = 3.0  # deg, of the beams
IN_FLOCK = 300  # birds around the lidar in one scene, or fewer where beams or birds are so wide that they would meet


def bird_of(**properties):
    """The surface of a bird."""
    return made(vtkAvianLidarBirdSource(), **properties)


def draw_species(file):
    """Each from above, from the side and from the front, at the same scale."""
    # Which coordinates run to the right and up (sign, axis), and towards whom.
    views = {"above": ((1, 0), (1, 1), 2), "side": ((1, 1), (1, 2), 0), "front": ((-1, 0), (1, 2), 1)}
    light = np.array((0.5, 0.4, 0.77))
    with tools.figure(file, len(views), len(SPECIES), figsize=(13, 4), sharex=True, sharey=True) as axes:
        for column, species in enumerate(SPECIES):
            surface = bird_of(Species=species, WingPhase=0.07)
            cells = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            bird = vtk_to_numpy(surface.GetPoints().GetData())[cells]
            normals = np.cross(bird[:, 1] - bird[:, 0], bird[:, 2] - bird[:, 0])
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            shade = 0.35 + 0.5 * np.clip(normals @ light, 0, 1)
            for axis, (view, (right, up, towards)) in zip(axes[:, column], views.items()):
                order = np.argsort(bird.mean(axis=1)[:, towards])
                shapes = np.stack([right[0] * bird[:, :, right[1]], up[0] * bird[:, :, up[1]]], axis=2)[order]
                axis.add_collection(PolyCollection(shapes, facecolors=np.repeat(shade[order, None], 3, axis=1),
                                                   edgecolors="face", linewidths=0.5))
                axis.set(aspect="equal", xlim=(-0.9, 0.9), ylim=(-0.4, 0.4), ylabel=f"{view} (m)" if column == 0 else "")
                axis.grid(alpha=0.3)
            axes[0, column].set_title(species)
            axes[-1, column].set_xlabel("m")


def flock(species, distance, count, random, gliding=False):
    """Birds all around at this distance, each an object, at any heading and wing phase. The distances differ by a metre:
    a pulse is shared by two range units."""
    birds = vtkMultiBlockDataSet()
    for k in range(count):
        azimuth = 2 * np.pi * k / count
        away = distance + random.uniform(-1, 1)
        up, level = away * np.sin(np.radians(ELEVATION)), away * np.cos(np.radians(ELEVATION))
        birds.SetBlock(k, bird_of(Species=species, ObjectId=k, Gliding=gliding, Heading=random.uniform(0, 360), WingPhase=random.uniform(0, 1),
                                  Position=(level * np.sin(azimuth), level * np.cos(azimuth), up)))
    return Scene(birds)


def most_in_flock(species, distance, half_beamwidth):
    """So many birds stand all around at a distance that none reaches into the beam of another."""
    reach = np.sqrt(3) * np.abs(bird_of(Species=species).GetBounds()).max()  # of any point, in any pose
    apart = half_beamwidth + np.arcsin(min(1.0, reach / (distance - 1)))
    level = np.sin(apart / 2) / np.cos(np.radians(ELEVATION))
    return min(IN_FLOCK, int(np.pi / np.arcsin(level))) if level < 1 else 1


def effective_areas(species, gliding, random):
    """Silhouettes of birds weighted by the cosine of incidence, m2, as the echo filter receives them: seen from 3 degrees
    below, at any heading and wing phase."""
    distance, reflectance = 300.0, 0.3  # m: any species fits IN_FLOCK times
    sensor = Sensor("Airport16", receiver_aperture=0.01, lower_energy_limit=0, upper_energy_limit=1, pulse_width=0,
                    sampling_interval=1e-3, channel_elevations=(ELEVATION,), azimuth_step=360 / IN_FLOCK,
                    firing_interval=0.0, range_gate=1e6)
    scan = Scan(flock(species, distance, IN_FLOCK, random, gliding), sensor, attenuation_coefficient=0,
                number_of_reflections=1, noise=False)
    echoes = scan.echoes
    solid_angle = 4 * np.pi * np.sin(sensor.half_beamwidth / 2)**2
    areas = np.zeros(IN_FLOCK)
    areas[echoes["beam_id"]] = (echoes["energy"] / sensor.pulse_energy * solid_angle * np.pi / sensor.receiver_aperture
                                / reflectance * echoes["distance_m"]**4)
    return areas


def area_rows(options):
    for species in SPECIES:
        row = [species]
        for gliding in (False, True):
            random = np.random.default_rng(options.seed)
            areas = np.concatenate([effective_areas(species, gliding, random) for _ in range(options.flocks)])
            row += [f"{areas.mean():.4f}", ", ".join(f"{q:.4f}" for q in np.percentile(areas, (5, 50, 95)))]
        print(*row, sep=" | ", file=sys.stderr, flush=True)
        yield row


def detected(species, distance, name, birds, random):
    """Number of birds that one pulse detects, of so many."""
    sensor = Sensor(name)
    alarms = sensor.false_alarms_per_scan / sensor.beams.number_of_points  # of a beam: the threshold is that of all beams
    most = most_in_flock(species, distance, sensor.half_beamwidth)
    seen = 0
    for first in range(0, birds, most):
        count = min(most, birds - first)
        sensor.set(channel_elevations=(ELEVATION,), azimuth_step=360 / count, firing_interval=0.0,
                   false_alarms_per_scan=alarms * count)
        scan = Scan(flock(species, distance, count, random), sensor, attenuation_coefficient=AIR,
                    seed=int(random.integers(1 << 30)))
        echoes = scan.echoes
        near = abs(echoes["distance_m"] - distance) < 3.0
        seen += len(np.unique(echoes["beam_id"][near]))
    return seen


def detection_rows(options):
    """Shares of birds detected by one pulse at each range, with their standard errors."""
    for species in SPECIES:
        random = np.random.default_rng(options.seed)
        shares = np.array([detected(species, distance, options.sensor, options.birds, random) for distance in options.ranges]) / options.birds
        print(species, *shares, file=sys.stderr, flush=True)
        yield species, shares, np.sqrt(shares * (1 - shares) / options.birds)


@study(argument("--sensor", choices=Sensor.presets(), default="Search905", help="default Search905"),
       argument("--birds", type=whole(10, 1000000), default=2100, help="at each range, default 2100: standard errors of 0.011 at most"),
       argument("--flocks", type=whole(1, 1000), default=11, help=f"of {IN_FLOCK} birds for the areas, default 11"),
       argument("--ranges", type=whole(10, 100000), nargs="*", help="m", default=(200, 300, 400, 500, 600, 700, 800, 1000)),
       argument("--seed", type=whole(0, 1 << 30), default=1, help="default 1"))
def main(options):
    warnings.filterwarnings("ignore", "the sensor at .* is below the scene")  # all birds are above it
    draw_species(options.out / "species.png")
    tools.leave(options.out, "birds-areas", ("species", "flapping, m²: mean", "5, 50, 95 %", "gliding: mean", "5, 50, 95 %"),
                list(area_rows(options)))
    found = list(detection_rows(options))
    with tools.figure(options.out / "detection.png", figsize=(7, 4.2)) as axes:
        for species, shares, errors in found:
            axes.errorbar(options.ranges, shares, errors, marker="o", label=species)
        axes.set(xlabel="range (m)", ylabel="share of birds that one pulse detects", ylim=(-0.02, 1.02),
                 title=f"{options.sensor}, daylight, assumed receiver and birds")
        axes.grid(alpha=0.3)
        axes.legend()
    tools.leave(options.out, "birds-detection", (options.sensor, *(f"{distance} m" for distance in options.ranges)), [
        (species, *(f"{share:.3f} ± {error:.3f}" for share, error in zip(shares, errors))) for species, shares, errors in found])
