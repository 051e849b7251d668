# SPDX-License-Identifier: BSD-3-Clause
"""Coverage against birds that are flown: at each place a bird of random heading and wing phase, scan after scan through the
echo filter, detected if it has an echo.

    Testing/Studies/run.py flown scene.lidarscene.json --runways airport.geojson --places 2000 --scans 100 --file flown.csv

Echoes over two reflections are left out. Ranges vary by one range unit, as coverage is the mean over them. Beams that few triangles enter are integrated; others have
cells with some 32 rays for each of --rays: with fewer, birds before structures are missed.
"""
import csv
import math
import pathlib
import sys

import numpy as np
from scipy.stats import binom
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
import running
from avianlidar import siting
from avianlidar.vtkAvianLidar import vtkAvianLidarBirdSource
from running import argument, study

PHASES = 32
TOGETHER = 250  # birds in a scan
FIRST = 100000  # object id
SPEED_OF_LIGHT = 299792458.0
RARE = 0.00135


def birds_of(species):
    """The bird in its frame at PHASES phases of a wingbeat."""
    return [running.made(vtkAvianLidarBirdSource(), Species=species, WingPhase=(phase + 0.5) / PHASES) for phase in range(PHASES)]


def placed(bird, number, position, heading):
    """A bird at a place. @param heading rad, clockwise from north"""
    turn = [math.cos(heading / 2), 0.0, 0.0, -math.sin(heading / 2)]
    mover = al.mover(bird, [position], orientations=[turn])
    ids = numpy_to_vtk(np.full(mover.GetNumberOfCells(), FIRST + number, dtype=np.int32), deep=True)
    ids.SetName("object_id")
    mover.GetCellData().AddArray(ids)
    return mover


def apart(places, positions, reach=1.0):
    """Groups of at most TOGETHER places, none of whose birds stands before another as seen from one of the positions: lists of
    numbers, the nearest first. @param reach of a bird, m"""
    ways = places[:, None] - np.asarray(positions)
    ranges = np.linalg.norm(ways, axis=2)
    ways, angles = ways / ranges[:, :, None], np.arcsin(np.minimum(1.0, reach / ranges))
    groups = []
    for number in np.argsort(ranges.min(axis=1), kind="stable"):
        for group in groups:
            cosines = (ways[group] * ways[number]).sum(axis=2)
            if len(group) < TOGETHER and np.all(np.arccos(np.clip(cosines, -1.0, 1.0)) > angles[group] + angles[number]):
                group.append(number)
                break
        else:
            groups.append([number])
    return groups


def near(beams, places, position, half_beamwidth, reach=1.0):
    """The beams that a bird at one of the places may be in: vtkPolyData. @param reach of a bird, m"""
    directions = vtk_to_numpy(beams.GetPointData().GetArray("direction"))
    wanted = np.zeros(len(directions), dtype=bool)
    for way in places - position:
        away = np.linalg.norm(way)
        wanted |= directions @ (way / away) >= math.cos(math.asin(min(1.0, reach / away)) + half_beamwidth)
    return running.some_beams(beams, np.flatnonzero(wanted))


def fly(scene, sensor, places, scans, species, air, rays, seed=0, say=lambda done: None):
    """@return of each place the share of scans in which its bird had an echo, and the mean of the probabilities that the
    mover report expects. @param sensor or several that look at the same bird, of which one must see it @param air attenuation
    coefficient, 1/m"""
    random = np.random.default_rng(seed)
    birds = birds_of(species)
    sensors = sensor if isinstance(sensor, (list, tuple)) else [sensor]
    looking = [al.Scan(scene, one, rays_per_beam=rays, attenuation_coefficient=air, number_of_reflections=1) for one in sensors]
    positions = [np.array(one.position) for one in sensors]
    unit = SPEED_OF_LIGHT * sensors[0].sampling_interval / 2
    seen, expected = np.zeros(len(places)), np.zeros(len(places))
    for one in sensors:
        one.algorithm.Update()
    done = 0
    for numbers in apart(places, positions):
        lit = [near(one.algorithm.GetOutput(), places[numbers], position, math.sqrt(2) * max(one.half_beamwidth, one.half_beamwidth_across))
               for one, position in zip(sensors, positions)]
        for number in range(scans):
            movers = []
            for i in numbers:
                way = places[i] - positions[0]
                away = 1.0 + (random.uniform() - 0.5) * unit / np.linalg.norm(way)
                movers.append(placed(birds[random.integers(PHASES)], i, positions[0] + away * way, random.uniform(0, 2 * math.pi)))
            found, missed = np.zeros(len(places), dtype=bool), np.ones(len(places))
            for scan, beams in zip(looking, lit):
                turned = vtkPolyData()  # the noise of another revolution
                turned.ShallowCopy(beams)
                revolution = numpy_to_vtk(np.array([number + 1], dtype=np.int32), deep=True)
                revolution.SetName("revolution")
                turned.GetFieldData().AddArray(revolution)
                scan.algorithm.SetInputData(0, turned)
                scan.movers = movers
                report = scan.mover_report
                ids = report["object_id"] - FIRST
                found[ids] |= report["number_of_echoes"] > 0
                missed[ids] *= 1.0 - report["detection_probability"]
            seen += found
            expected += 1.0 - missed
        done += len(numbers)
        say(done)
    return seen / scans, expected / scans


def compare(probability, seen, scans):
    """Numbers of the comparison: `bias`, the mean of what was seen less what was expected, and the shares of places beyond three
    standard errors and, by the binomial law itself, outside 99.73 % of what chance gives."""
    error = np.sqrt(np.maximum(probability * (1.0 - probability), 1e-12) / scans)
    times = np.rint(seen * scans)
    outside = (binom.cdf(times, scans, probability) < RARE) | (binom.sf(times - 1, scans, probability) < RARE)
    return {"bias": float((seen - probability).mean()), "beyond_3_std_errors": float((np.abs(seen - probability) > 3 * error + 1e-9).mean()),
            "outside_99.73_percent": float(np.mean(outside))}


@study(argument("scene", type=pathlib.Path), argument("--runways", type=pathlib.Path, required=True, help="GeoJSON"),
       argument("--sensor", default="Search905"), argument("--species", default="herring gull"), argument("--places", type=int, default=2000),
       argument("--scans", type=int, default=100), argument("--rays", type=int, default=400),
       argument("--reach", type=float, default=0.0, help="m: places within this distance of the sensor instead"),
       argument("--seed", type=int, default=1), argument("--file", type=pathlib.Path, required=True, help="CSV, one row per place"))
def main(options):
    scene = al.load_scene(options.scene)
    sensor = al.Sensor(options.sensor, position=scene.lidar_position)
    if options.reach:
        random = np.random.default_rng(options.seed)
        bearing, away = random.uniform(0, 2 * math.pi, options.places), options.reach * np.sqrt(random.uniform(0.0025, 1, options.places))
        places = np.column_stack([away * np.sin(bearing), away * np.cos(bearing), random.uniform(0.5, 60.0, options.places)])
    else:
        places, _ = siting.strips_and_approaches(
            siting.read_runways(options.runways, scene.geodetic_origin), options.places, options.seed)
    cover = al.Coverage(scene, sensor, places=places, species=options.species)
    probability = cover["detection_probability"].astype(float)
    air = cover.data.GetFieldData().GetArray("attenuation_coefficient").GetValue(0)
    seen, expected = fly(scene, sensor, places, options.scans, options.species, air, options.rays, options.seed,
                         lambda done: print(f"{done} of {options.places} places", file=sys.stderr, flush=True))
    with options.file.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["x [m]", "y [m]", "z [m]", "status", "beams", "probability", "seen", "expected by the echo filter"])
        for row in zip(places, cover["status"], cover["beams_per_scan"], probability, seen, expected):
            writer.writerow([*(f"{c:.3f}" for c in row[0]), *row[1:3], *(f"{p:.6g}" for p in row[3:])])
    result = compare(probability, seen, options.scans)
    print(f"{options.places} places, {options.scans} scans: mean {probability.mean():.4f}, seen {seen.mean():.4f}, bias "
          f"{result['bias']:+.4f}, beyond 3 standard errors {100 * result['beyond_3_std_errors']:.2f} %, outside 99.73 % of the "
          f"binomial law {100 * result['outside_99.73_percent']:.2f} %")
