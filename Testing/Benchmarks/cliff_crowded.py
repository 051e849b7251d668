# SPDX-License-Identifier: BSD-3-Clause
"""Beams that many small objects enter: two scenes of objects with an object_id each, beside the same triangles as one
object. Aprons hold detailed cars, crates and cones 1 to 3 km away; a town has houses, trees and masts. Materials are
assumed. Errors are those of energies, against scans with --reference rays."""
import math

import numpy as np
from avianlidar import vtkAvianLidar as al
from avianlidar._scene import mesh
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkAppendPolyData

from cliffs import Row, interleaved

Source = al.vtkAvianLidarBeamSource
UNIT = 0.75  # m, half of what a pulse of 5 ns covers
REFERENCE = 6400
TURNS_OF_BIRDS = 12  # scans of birds alone, of which the mean counts as true
# Sensors: the paper's, whose energies do not depend on the range, and a photon receiver with an aperture.
SENSORS = ("Airport16", "Search905")


def lathe(radii, heights, around):
    """(points, triangles): a solid of revolution about z, closed by its first and last radius."""
    angle = 2 * math.pi * np.arange(around) / around
    rings = len(radii)
    points = np.stack([np.outer(radii, np.cos(angle)), np.outer(radii, np.sin(angle)),
                       np.repeat(heights, around).reshape(rings, around)], axis=-1).reshape(-1, 3)
    one = np.arange((rings - 1) * around).reshape(rings - 1, around)
    two = np.roll(one, -1, axis=1)
    sides = np.concatenate([np.stack([one, two, two + around], -1), np.stack([one, two + around, one + around], -1)])
    fan = np.arange(1, around - 1)
    lid = np.stack([np.zeros_like(fan), fan, fan + 1], -1)
    return points, np.concatenate([sides.reshape(-1, 3), lid, lid + (rings - 1) * around])


def block(lengths, parts):
    """(points, triangles): a box on z = 0, each face of parts x parts quadrilaterals."""
    a, b = np.meshgrid(np.linspace(-1, 1, parts + 1), np.linspace(-1, 1, parts + 1))
    points, triangles = [], []
    i = (np.arange(parts)[:, None] * (parts + 1) + np.arange(parts)).ravel()
    face = np.concatenate([np.stack([i, i + 1, i + parts + 2], -1), np.stack([i, i + parts + 2, i + parts + 1], -1)])
    for axis in range(3):
        for side in (-1.0, 1.0):
            corner = np.stack([np.full(a.size, side), a.ravel(), b.ravel()], -1)
            points.append(np.roll(corner, axis, axis=1))
            triangles.append(face + a.size * (2 * axis + (side > 0)))
    return 0.5 * (np.concatenate(points) + (0, 0, 1)) * lengths, np.concatenate(triangles)


def together(parts):
    points = np.concatenate([p for p, _ in parts])
    first = np.cumsum([0] + [len(p) for p, _ in parts[:-1]])
    return points, np.concatenate([t + f for (_, t), f in zip(parts, first)])


def at(part, place):
    return part[0] + place, part[1]


def prop(random):
    """A crate, a cone or a car of 500 to 5,000 triangles."""
    kind = random.integers(3)
    many = 10 ** random.uniform(math.log10(500), math.log10(5000))
    if kind == 0:
        return block(random.uniform(0.4, 3.0, 3), round(math.sqrt(many / 12)))
    if kind == 1:
        around = round(math.sqrt(many / 2))
        height = random.uniform(0.5, 2.0)
        return lathe(np.linspace(0.3 * height, 0.02, around + 1), np.linspace(0, height, around + 1), around)
    length, parts = random.uniform(3.0, 9.0), round(math.sqrt(many / 48))
    wheel = lathe([0.05, 0.35, 0.35, 0.05], [-0.1, -0.1, 0.1, 0.1], max(8, round(many / 48)))
    wheel = wheel[0][:, [0, 2, 1]], wheel[1]
    return together([at(block((length, 1.8, 0.9), parts), (0, 0, 0.3)),
                     at(block((0.5 * length, 1.6, 0.7), parts), (0, 0, 1.2)),
                     *(at(wheel, (x * length, y, 0.35)) for x in (-0.3, 0.3) for y in (-0.9, 0.9))])


def house(random):
    """A house with a gable, or a mast of thin bars, or a tree of small leaves."""
    kind = random.integers(5)
    if kind == 0:
        height = random.uniform(6, 20)
        bars = [at(block((0.06, 0.06, height), 1), (x, y, 0)) for x in (-0.4, 0.4) for y in (-0.4, 0.4)]
        return together(bars + [at(block((0.8, 0.04, 0.04), 1), (0, y, z))
                                for y in (-0.4, 0.4) for z in np.arange(0.5, height, 0.5)])
    if kind < 3:
        leaves = int(random.uniform(300, 900))
        middle = random.normal(size=(leaves, 3))
        middle *= (random.uniform(0, 1, leaves) ** (1 / 3) / np.linalg.norm(middle, axis=1))[:, None]
        points = (middle * (2.0, 2.0, 2.5) + (0, 0, 5.0))[:, None] + random.normal(scale=0.12, size=(leaves, 3, 3))
        return together([lathe([0.15, 0.1], [0.0, 4.0], 8), (points.reshape(-1, 3), np.arange(3 * leaves).reshape(-1, 3))])
    x, y, z = random.uniform((7, 6, 3), (14, 10, 8))
    roof = np.array([(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z), (-x, 0, z + y / 2), (x, 0, z + y / 2)]) * (0.55, 0.55, 1)
    windows = [at(block((1.0, 0.1, 1.2), 2), (dx, side * y / 2, dz))
               for side in (-1, 1) for dx in np.arange(-x / 2 + 1, x / 2 - 1, 2) for dz in np.arange(1, z - 1.3, 2.5)]
    return together([block((x, y, z), 1), (roof, np.array([(0, 1, 5), (0, 5, 4), (2, 3, 4), (2, 4, 5), (0, 4, 3), (1, 2, 5)])),
                     *windows])


def scattered(make, count, places, seed):
    """Points, triangles, ids from 1 on and diffuse coefficients of `count` objects at places(random)."""
    random = np.random.default_rng(seed)
    parts, ids, kds = [], [], []
    for number in range(count):
        points, triangles = make(random)
        angle = random.uniform(0, 2 * math.pi)
        turn = np.array([(math.cos(angle), -math.sin(angle), 0), (math.sin(angle), math.cos(angle), 0), (0, 0, 1)])
        parts.append((points @ turn.T + places(random), triangles))
        ids.append(np.full(len(triangles), number + 1))
        kds.append(np.full(len(triangles), random.uniform(0.05, 0.7)))
    return *together(parts), np.concatenate(ids), np.concatenate(kds)


def on_aprons(random):
    """A place on one of four aprons 1 to 3 km north."""
    apron = random.integers(4)
    return (-300 + 200 * apron + random.uniform(-80, 80), (1000, 1500, 2100, 2900)[apron] + random.uniform(-60, 60), 0)


def in_town(random):
    return random.uniform(-400, 400), random.uniform(700, 2200), 0


def surface_of(points, triangles, ids, kds):
    data = mesh(points, triangles)
    for name, values in (("object_id", ids.astype(np.int32)), ("kd", kds), ("ks", 0 * kds), ("kp", 1 + 0 * kds)):
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetCellData().AddArray(array)
    return data


def scene_of(objects, with_ids, more=()):
    """The tree of objects on the ground, which is object 0. @param more other surfaces"""
    points, triangles, ids, kds = objects
    ground = surface_of(*at(block((9000, 9000, 0.2), 1), (0, 0, -0.2)), np.zeros(12), np.full(12, 0.2))
    both = vtkAppendPolyData()
    both.SetOutputPointsPrecision(1)
    for data in (ground, surface_of(points, triangles, ids if with_ids else 0 * ids, kds), *more):
        both.AddInputData(data)
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputConnection(both.GetOutputPort())
    tree.Update()
    return tree


def beams_of(sensor, columns):
    source = Source()
    getattr(source, "SetPresetTo" + sensor)()
    source.SetAzimuthRange(-26, 26)
    source.SetAzimuthStep(52 / columns)
    source.SetNumberOfChannels(6)
    source.SetMinimumElevation(-0.75)
    source.SetPosition(0, 0, 6)
    source.Update()
    return source


def scan(tree, beams, rays=100, seed=0):
    echoes = al.vtkAvianLidarEchoFilter()
    echoes.SetNumberOfThreads(1)
    echoes.SetNumberOfReflections(1)
    echoes.SetNoise(0)
    echoes.SetRaysPerBeam(rays)
    echoes.SetSeed(seed)
    echoes.SetInputConnection(0, beams.GetOutputPort())
    echoes.SetInputConnection(1, tree.GetOutputPort())
    echoes.AddObserver("WarningEvent", lambda *_: None)  # faces that coincide
    echoes.Update()
    return echoes


def echoes_of(filter_):
    """Beam, range (m) and energy (J) of each echo."""
    points = filter_.GetOutput().GetPointData()
    return [vtk_to_numpy(points.GetArray(name)).copy() for name in ("beam_id", "distance_m", "energy_received")]


def differences(found, true):
    """Relative errors of energies of echoes found within a range unit, and the number of echoes missed or invented."""
    errors, matched = [], 0
    for beam, distance, energy in zip(*true):
        same = np.flatnonzero((found[0] == beam) & (np.abs(found[1] - distance) < UNIT))
        if len(same):
            matched += 1
            nearest = same[np.argmin(np.abs(found[1][same] - distance))]
            errors.append(found[2][nearest] / energy - 1)
    return np.array(errors), len(true[0]) + len(found[0]) - 2 * matched


def rms(errors):
    return 100 * float(np.sqrt(np.mean(np.square(errors)))) if len(errors) else math.nan


def birds_before(objects, beams, count):
    """Errors (%) of the energies of birds before the objects, against the birds alone, and the share not found (%)."""
    random = np.random.default_rng(5)
    bird = together([(p[:, [1, 2, 0]], t) for p, t in [lathe(
        0.06 * np.sin(np.linspace(0.05, math.pi - 0.05, 9)), 0.3 * -np.cos(np.linspace(0.05, math.pi - 0.05, 9)), 8)]] +
        [at(block((0.5, 0.16, 0.01), 1), (x, 0, 0)) for x in (-0.3, 0.3)])
    made, numbers = [], random.permutation(beams.GetOutput().GetNumberOfPoints())
    directions = vtk_to_numpy(beams.GetOutput().GetPointData().GetArray("direction"))
    low = numbers[directions[numbers, 2] < 0.004][:count]
    for number, beam in enumerate(low):
        d, reach = directions[beam], random.uniform(60, 400)
        aside = np.cross(d, (0, 0, 1)) * random.uniform(-0.8, 0.8) * 5.6e-3 * reach
        angle = random.uniform(0, 2 * math.pi)
        turn = np.array([(math.cos(angle), -math.sin(angle), 0), (math.sin(angle), math.cos(angle), 0), (0, 0, 1)])
        n = len(bird[1])
        made.append(surface_of(bird[0] @ turn.T + np.array((0, 0, 6)) + reach * d + aside, bird[1],
                               np.full(n, 1000000 + number), np.full(n, 0.5)))
    alone = tuple(np.empty((0,) + a.shape[1:], a.dtype) for a in objects)
    birds = scene_of(alone, True, made)
    true = echoes_of(scan(birds, beams, REFERENCE, 99))
    near = true[1] < 420  # the ground begins at 500 m
    true = [values[near] for values in true]
    for seed in range(100, 99 + TURNS_OF_BIRDS):  # single scans err by 0.8 % rms
        beam, distance, energy = echoes_of(scan(birds, beams, REFERENCE, seed))
        for number, (of, away) in enumerate(zip(*true[:2])):
            same = np.flatnonzero((beam == of) & (np.abs(distance - away) < UNIT))
            true[2][number] += energy[same[0]] if len(same) else math.nan
    true[2] /= TURNS_OF_BIRDS
    found = echoes_of(scan(scene_of(objects, True, made), beams))
    errors, _ = differences(found, true)
    return rms(errors), 100 * (1 - len(errors) / max(1, len(true[0]))), len(true[0])


def rows(short):
    share, rounds = (0.25, 3) if short else (1.0, 7)
    for name, make, places, count in (("aprons", prop, on_aprons, 3000), ("town", house, in_town, 6000)):
        objects = scattered(make, round(share * count), places, 1)
        own, one = (scene_of(objects, ids) for ids in (True, False))
        for sensor in SENSORS:
            beams = beams_of(sensor, 130)
            of = f"{name}, {sensor}"
            times = interleaved({"own": lambda: scan(own, beams), "one": lambda: scan(one, beams),
                                 "many": lambda: scan(own, beams, 1600)}, rounds)
            yield Row("crowded", f"{of}: an id each", times["own"], "s")
            yield Row("crowded", f"{of}: an id each / one object", times["own"] / times["one"], "", 2.0)
            yield Row("crowded", f"{of}: N = 100 / N = 1600", times["own"] / times["many"], "", 1.0)
            true = echoes_of(scan(own, beams, REFERENCE, 99))
            apart = [differences(echoes_of(scan(own, beams, seed=seed)), true) for seed in range(3)]
            yield Row("crowded", f"{of}: rms error of energies", rms(np.concatenate([e for e, _ in apart])), "%")
            yield Row("crowded", f"{of}: echoes missed or invented of {len(true[0])}",
                      100 * sum(n for _, n in apart) / (3 * max(1, len(true[0]))), "%")
            error, missed, birds = birds_before(objects, beams, 60)
            yield Row("crowded", f"{of}: rms error of {birds} birds", error, "%", 1.5)
            yield Row("crowded", f"{of}: birds missed", missed, "%", 0.0)
