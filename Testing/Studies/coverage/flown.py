# SPDX-License-Identifier: BSD-3-Clause
"""Coverage against birds that are flown: at each place a bird of random heading and wing phase, scan after scan through the
echo filter, detected if it has an echo. flown_sensors.py runs it.

Echoes after two reflections are left out. Ranges vary by one range unit, as coverage is the mean over them. Beams that few triangles enter are integrated; others have
cells with some 32 rays for each of --rays: with fewer, birds before structures are missed.
"""
import math

import numpy as np
from scipy.stats import binom
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
import running
from avianlidar.vtkAvianLidar import vtkAvianLidarBirdSource

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


def fly(scene, sensor, places, scans, species, air, rays, seed=0, headings=None):
    """@return of each place the share of scans in which its bird had an echo, and the mean of the probabilities that the
    mover report expects. @param sensor or several that look at the same bird, of which one must see it @param air attenuation
    coefficient, 1/m @param headings of the birds, rad clockwise from north; default: random in each scan"""
    random = np.random.default_rng(seed)
    birds = birds_of(species)
    sensors = sensor if isinstance(sensor, (list, tuple)) else [sensor]
    looking = [al.Scan(scene, one, rays_per_beam=rays, attenuation_coefficient=air, number_of_reflections=1) for one in sensors]
    positions = [np.array(one.position) for one in sensors]
    unit = SPEED_OF_LIGHT * sensors[0].sampling_interval / 2
    seen, expected = np.zeros(len(places)), np.zeros(len(places))
    for one in sensors:
        one.algorithm.Update()
    for numbers in apart(places, positions):
        lit = [near(one.algorithm.GetOutput(), places[numbers], position, math.sqrt(2) * max(one.half_beamwidth, one.half_beamwidth_across))
               for one, position in zip(sensors, positions)]
        for number in range(scans):
            movers = []
            for i in numbers:
                way = places[i] - positions[0]
                away = 1.0 + (random.uniform() - 0.5) * unit / np.linalg.norm(way)
                movers.append(placed(birds[random.integers(PHASES)], i, positions[0] + away * way, random.uniform(0, 2 * math.pi) if headings is None else headings[i]))
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
    return seen / scans, expected / scans


def compare(probability, seen, scans):
    """Numbers of the comparison: `bias`, the mean of what was seen less what was expected, and the shares of places beyond three
    standard errors and, by the binomial law itself, outside 99.73 % of what chance gives."""
    error = np.sqrt(np.maximum(probability * (1.0 - probability), 1e-12) / scans)
    times = np.rint(seen * scans)
    outside = (binom.cdf(times, scans, probability) < RARE) | (binom.sf(times - 1, scans, probability) < RARE)
    return {"bias": float((seen - probability).mean()), "beyond_3_std_errors": float((np.abs(seen - probability) > 3 * error + 1e-9).mean()),
            "outside_99.73_percent": float(np.mean(outside))}
