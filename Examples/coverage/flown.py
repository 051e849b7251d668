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
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

import avianlidar as al
from avianlidar import siting
from avianlidar.vtkAvianLidar import vtkAvianLidarBirdSource

PHASES = 32
TOGETHER = 250  # birds in a scan
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
    found, points, vertices = vtkPolyData(), vtkPoints(), vtkCellArray()
    numbers = np.flatnonzero(wanted)
    points.SetData(numpy_to_vtk(vtk_to_numpy(beams.GetPoints().GetData())[numbers], deep=True))
    for i in range(len(numbers)):
        vertices.InsertNextCell(1, [i])
    found.SetPoints(points)
    found.SetVerts(vertices)
    for i in range(beams.GetPointData().GetNumberOfArrays()):
        whole = beams.GetPointData().GetArray(i)
        part = whole.NewInstance()
        part.SetName(whole.GetName())
        part.SetNumberOfComponents(whole.GetNumberOfComponents())
        part.SetNumberOfTuples(len(numbers))
        vtk_to_numpy(part)[:] = vtk_to_numpy(whole)[numbers]
        found.GetPointData().AddArray(part)
    found.GetFieldData().ShallowCopy(beams.GetFieldData())
    return found


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
