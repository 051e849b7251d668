# SPDX-License-Identifier: BSD-3-Clause
"""Coverage against birds that are flown: at each place a bird of random heading and wing phase, scan after scan through the
echo filter, detected if it has an echo.

    flown.py scene.lidarscene.json --runways airport.geojson --places 2000 --scans 100 --out flown.csv

Echoes over two reflections are left out. Ranges vary by one range unit, as coverage is the mean over them. Beams that few triangles enter are integrated; others have
cells with some 32 rays for each of --rays: with fewer, birds before structures are missed.
"""
import argparse
import csv
import math
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
from avianlidar import siting
from avianlidar.vtkAvianLidar import vtkAvianLidarBirdSource

PHASES = 32
TOGETHER = 250  # birds in a scan, few enough that hardly one stands before another
FIRST = 100000  # object id
SPEED_OF_LIGHT = 299792458.0


def birds_of(species):
    """The bird in its frame at PHASES phases of a wingbeat."""
    found = []
    for phase in range(PHASES):
        source = vtkAvianLidarBirdSource()
        source.SetSpecies(species)
        source.SetWingPhase((phase + 0.5) / PHASES)
        source.Update()
        found.append(source.GetOutput())
    return found


def placed(bird, number, position, heading):
    """A bird at a place. @param heading rad, clockwise from north"""
    mover = vtkPolyData()
    mover.ShallowCopy(bird)
    turn = [math.cos(heading / 2), 0.0, 0.0, -math.sin(heading / 2)]
    for fields, name, values in (
            (mover.GetCellData(), "object_id", np.full(mover.GetNumberOfCells(), FIRST + number, dtype=np.int32)),
            (mover.GetFieldData(), "pose_position", np.array([position])),
            (mover.GetFieldData(), "pose_orientation", np.array([turn]))):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        fields.AddArray(array)
    return mover


def fly(scene, sensor, places, scans, species, air, rays, seed=0, say=lambda done: None):
    """@return of each place the share of scans in which its bird had an echo, and the mean of the probabilities that the
    mover report expects. @param air attenuation coefficient, 1/m"""
    random = np.random.default_rng(seed)
    birds = birds_of(species)
    scan = al.Scan(scene, sensor, rays_per_beam=rays, attenuation_coefficient=air, number_of_reflections=1)
    position = np.array(sensor.position)
    unit = SPEED_OF_LIGHT * sensor.sampling_interval / 2
    seen, expected = np.zeros(len(places)), np.zeros(len(places))
    sensor.algorithm.Update()
    beams = sensor.algorithm.GetOutput()
    for first in range(0, len(places), TOGETHER):
        numbers = range(first, min(first + TOGETHER, len(places)))
        for number in range(scans):
            movers = []
            for i in numbers:
                way = places[i] - position
                away = 1.0 + (random.uniform() - 0.5) * unit / np.linalg.norm(way)
                movers.append(placed(birds[random.integers(PHASES)], i, position + away * way, random.uniform(0, 2 * math.pi)))
            turned = vtkPolyData()  # the noise of another revolution
            turned.ShallowCopy(beams)
            revolution = numpy_to_vtk(np.array([number + 1], dtype=np.int32), deep=True)
            revolution.SetName("revolution")
            turned.GetFieldData().AddArray(revolution)
            scan.algorithm.SetInputData(0, turned)
            scan.movers = movers
            report = scan.mover_report
            ids = report["object_id"] - FIRST
            seen[ids] += report["number_of_echoes"] > 0
            expected[ids] += report["detection_probability"]
        say(numbers[-1] + 1)
    return seen / scans, expected / scans


def compare(probability, seen, scans):
    """Numbers of the comparison: `bias`, the mean of what was seen less what was expected, and the shares of places beyond three
    standard errors and, by the binomial law itself, outside 99.73 % of what chance gives."""
    error = np.sqrt(np.maximum(probability * (1.0 - probability), 1e-12) / scans)
    rare = 0.00135
    outside = []
    for p, times in zip(probability, np.rint(seen * scans).astype(int)):
        law = np.array([math.comb(scans, k) * p ** k * (1.0 - p) ** (scans - k) for k in range(scans + 1)])
        outside.append(law[:times + 1].sum() < rare or law[times:].sum() < rare)
    return {"bias": float((seen - probability).mean()), "beyond_3_std_errors": float((np.abs(seen - probability) > 3 * error + 1e-9).mean()),
            "outside_99.73_percent": float(np.mean(outside))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--runways", type=pathlib.Path, required=True, help="GeoJSON")
    parser.add_argument("--sensor", default="Search905")
    parser.add_argument("--species", default="herring gull")
    parser.add_argument("--places", type=int, default=2000)
    parser.add_argument("--scans", type=int, default=100)
    parser.add_argument("--rays", type=int, default=400)
    parser.add_argument("--reach", type=float, default=0.0, help="m: places within this distance of the sensor instead")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="CSV, one row per place")
    options = parser.parse_args()
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
    with options.out.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["x [m]", "y [m]", "z [m]", "status", "beams", "probability", "seen", "expected by the echo filter"])
        for row in zip(places, cover["status"], cover["beams_per_scan"], probability, seen, expected):
            writer.writerow([*(f"{c:.3f}" for c in row[0]), *row[1:3], *(f"{p:.6g}" for p in row[3:])])
    result = compare(probability, seen, options.scans)
    print(f"{options.places} places, {options.scans} scans: mean {probability.mean():.4f}, seen {seen.mean():.4f}, bias "
          f"{result['bias']:+.4f}, beyond 3 standard errors {100 * result['beyond_3_std_errors']:.2f} %, outside 99.73 % of the "
          f"binomial law {100 * result['outside_99.73_percent']:.2f} %")


if __name__ == "__main__":
    main()
