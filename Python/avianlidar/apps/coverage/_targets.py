# SPDX-License-Identifier: BSD-3-Clause
"""Objects for which `reach` computes ranges: birds, flocks, boards, spheres, drones, people, walls and ground.

The echo filter scans boards, spheres, drones, people and birds as movers at places in the pattern of the sensor. Walls
and ground fill the beam, so single beams that meet them suffice. Sizes and reflectances that nobody has given stand in
targets.json and are assumed.
"""
import copy
import dataclasses
import itertools
import math
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from ... import vtkAvianLidar as _wrapped
from ..._cloud import add_array, field_values
from ..._pipeline import update
from ..._properties import set_properties, unknown
from ..._scan import Scan
from ..._scene import Scene, mover
from ..._sensor import Sensor
from ..inputs._json import packaged
from ..pages._words import plural

FORMS = {"board": "board:SIDE", "sphere": "sphere:DIAMETER", "drone": "drone", "person": "person", "wall": "wall",
         "ground": "ground"}
MOST = 100.0  # largest board or sphere, m
PHASES = 8  # phases of wingbeats, and places in a range unit at which a beam meets a wall
MARGIN = 1.5  # a surface that fills the beam, in half beamwidths; a rectangular beam's corners are at 1.41
SPEED_OF_LIGHT = 299792458.0  # m/s
GOLDEN = 0.6180339887498949  # its multiples, modulo 1, are evenly spread
ASSUMED = " (assumed)"
SIDES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
                  (0, 6, 4), (1, 5, 7), (1, 7, 3)])


def box(middle, half, turn: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Points (m) and triangles of a box that is turned about z. @param half half sizes, m @param turn rad"""
    c, s = math.cos(turn), math.sin(turn)
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    return corners * half @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)]) + middle, SIDES


def joined(parts) -> tuple[np.ndarray, np.ndarray]:
    """One mesh of several. @param parts pairs of points and triangles"""
    firsts = np.cumsum([0, *(len(points) for points, _ in parts)])
    return (np.concatenate([points for points, _ in parts]),
            np.concatenate([faces + first for (_, faces), first in zip(parts, firsts)]))


def quadcopter(thick: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Points (m, nose towards +x) and triangles of a quadcopter. @param thick thickness of its parts, 1: assumed"""
    drone = packaged("coverage/targets.json")["drone"]
    across, arm, motor, leg = (drone[name] for name in ("across", "arm", "motor", "leg"))
    parts = [box(np.array(middle), np.array(half) * thick) for middle, half in drone["body"]]
    for angle in np.radians((45, 135, 225, 315)):
        out = np.array((np.cos(angle), np.sin(angle), 0))
        parts.append(box(0.25 * across * out, np.array((0.25 * across, arm[0] * thick, arm[1] * thick)), angle))
        parts.append(box(0.5 * across * out + (0, 0, 0.01), np.array((motor[0], motor[0], motor[1])) * thick))
        parts.append(box(0.3 * across * out - (0, 0, 0.04), np.array((leg[0] * thick, leg[0] * thick, leg[1]))))
    return joined(parts)


def sphere(diameter: float, rings: int = 8) -> tuple[np.ndarray, np.ndarray]:
    """Points (m) and triangles of a polyhedron with the surface of a sphere, and therefore with its mean silhouette."""
    down, about = np.meshgrid(np.linspace(0.0, np.pi, rings + 1), np.arange(2 * rings) * np.pi / rings, indexing="ij")
    points = np.stack([np.sin(down) * np.cos(about), np.sin(down) * np.sin(about), np.cos(down)], axis=-1)
    points = points.reshape(-1, 3)
    number = np.arange(len(points)).reshape(down.shape)
    next_to = np.roll(number, -1, axis=1)
    faces = np.concatenate([np.stack([number[:-1], number[1:], next_to[1:]], axis=-1)[:-1].reshape(-1, 3),
                            np.stack([number[:-1], next_to[1:], next_to[:-1]], axis=-1)[1:].reshape(-1, 3)])
    a, b, c = (points[faces[:, k]] for k in range(3))
    surface = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    return 0.5 * diameter * math.sqrt(4.0 * np.pi / surface) * points, faces


@dataclasses.dataclass(frozen=True)
class Target:
    """What is looked for; `target` and `flock` make one.

    kind         a key of FORMS, or "flock"
    size         side of a board, diameter of a sphere, m; number of birds of a flock
    reflectance  of a Lambertian surface, 1
    height       of the sensor above the ground, m
    species      of a flock
    words        the target in words, with what is assumed
    """

    kind: str
    size: float = 0.0
    reflectance: float = 0.0
    height: float = 0.0
    species: str = ""
    words: str = ""

    @property
    def fills(self) -> bool:
        """Whether the target fills the beam."""
        return self.kind in ("wall", "ground")

    @property
    def mesh(self) -> tuple[np.ndarray, np.ndarray]:
        """Points (m: right, away from the sensor, up) and triangles."""
        half = 0.5 * self.size
        if self.kind == "board":
            return half * np.array([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)]), np.array([(0, 1, 2), (0, 2, 3)])
        if self.kind == "person":
            return box((0.0, 0.0, 0.0), 0.5 * np.array(packaged("coverage/targets.json")["person"]["size"]))
        return sphere(self.size) if self.kind == "sphere" else quadcopter()


def _number(name: str, value: float | None, default: float, most: float, unit: str) -> tuple[float, str]:
    """A number and words that say whether it is assumed."""
    if value is not None and not 0.0 < value <= most:
        raise ValueError(f"{name} is {value:g}, expected above 0 to {most:g}{unit}")
    return (default, ASSUMED) if value is None else (float(value), "")


def target(form: str, reflectance: float | None = None, height: float | None = None) -> Target:
    """A target for `within_beams`.

    form         board:SIDE (m; a square plate, met squarely), sphere:DIAMETER (m), drone, person, wall (met squarely)
                 or ground (level, met at a grazing angle)
    reflectance  of the Lambertian surface, above 0 to 1; default: assumed by kind
    height       of the sensor above the ground, m; default: assumed

    >>> target("board:0.5", reflectance=0.1).words
    'board of 0.5 m, reflectance 0.1'
    """
    kind, colon, text = form.partition(":")
    known = packaged("coverage/targets.json")
    if kind not in FORMS:
        raise ValueError(unknown("target", kind, FORMS.values()))
    size = 0.0
    if (":" in FORMS[kind]) != bool(colon):
        raise ValueError(f"target is {form}, expected {FORMS[kind]}{'' if colon else f' in m, as in {kind}:0.5'}")
    if colon:
        try:
            size = float(text)
        except ValueError:
            raise ValueError(f"target is {form}, expected {FORMS[kind]} with a number in m, as in {kind}:0.5") from None
        _number(f"the size of target {form}", size, 0.0, MOST, " m")
    if height is not None and kind != "ground":
        raise ValueError(f"height is {height:g} m, expected no height for the target {form}: it is for ground")
    shine, guess = _number("reflectance", reflectance, known["reflectance"][kind], 1.0, "")
    above, high = _number("height", height, known["ground"]["height"], 1e4, " m")
    across = known["drone"]["across"]
    sides = " x ".join(f"{one:g}" for one in known["person"]["size"])
    words = {"board": f"board of {size:g} m", "sphere": f"sphere of {size:g} m",
             "drone": f"drone of {across:g} m{ASSUMED}", "person": f"person of {sides} m{ASSUMED}",
             "ground": f"ground {above:g} m{high} below"}.get(kind, kind)
    return Target(kind, size, shine, above, "", f"{words}, reflectance {shine:g}{guess}")


def flock(species: str, number: int) -> Target:
    """A flock for `within_beams`, which is detected if one of its birds is. @param number of birds, 1 to 1000

    >>> flock("starling", 20).words
    'flock of 20 starlings'
    """
    if not 1 <= number <= 1000:
        raise ValueError(f"flock is {number}, expected 1 to 1000 birds")
    return Target("flock", number, species=species, words=f"flock of {number} {plural(species)}")


def own_species(file) -> list[str]:
    """Names of the birds of the user's table, as for vtkAvianLidarBirdSource."""
    known = len(_wrapped.vtkAvianLidarBirdSource().GetKnownSpecies().splitlines())
    birds = _wrapped.vtkAvianLidarBirdSource()
    set_properties(birds, "birds", species_file_name=str(file))
    update(birds)  # reports what is wrong with the table
    return birds.GetKnownSpecies().splitlines()[known:]


def places_in_flock(species: str, number: int, seed: int, file: str = "") -> np.ndarray:
    """Places of a flock's birds about their middle, number x 3, m."""
    tracks = _wrapped.vtkAvianLidarTracks()
    set_properties(tracks, "flock", species=species, species_file_name=file, pattern="Flock", number_of_birds=number,
                   time_range=(0.0, 1.0), center=(0.0, 0.0, 0.0), radius=0.0, heights=(0.0, 0.0), seed=seed)
    update(tracks)
    blocks = tracks.GetOutputDataObject(0)
    places = np.array([field_values(blocks.GetBlock(k))["pose_position"][0] for k in range(number)])
    return places - places.mean(axis=0)


def _surfaces(what: str | Target, reflectance: float, gliding: bool, file: str) -> list[vtkPolyData]:
    """Surfaces of a target, or of a bird by the phase of its wings."""
    if isinstance(what, Target) and what.kind != "flock":
        return [Scene(*what.mesh, material=(what.reflectance, 0.0, 1.0)).surfaces.GetBlock(0)]
    birds = []
    for phase in range(PHASES):
        bird = _wrapped.vtkAvianLidarBirdSource()
        set_properties(bird, "bird", species=getattr(what, "species", what), species_file_name=file, gliding=gliding,
                       reflectance=reflectance, wing_phase=(phase + 0.5) / PHASES)
        update(bird)
        birds.append(bird.GetOutput())
    return birds


def scan_of(sensor: Sensor, settings: dict[str, Any], seed: int) -> Scan:
    """A scan without surfaces, in the air of the settings of a coverage. Two reflections on one object are left out."""
    scan = Scan(Scene(), sensor, number_of_reflections=1, seed=seed)
    known = scan.properties()
    return scan.set(**{name: value for name, value in settings.items() if name in known})


def _apart(lines: np.ndarray, angle: float) -> Iterator[np.ndarray]:
    """Groups of numbers of lines, rad; no two lines of a group are nearer to one another than the angle."""
    left = np.arange(len(lines))
    near = lines @ lines.T > math.cos(min(angle, math.pi))
    while len(left):
        group: list[int] = []
        for number in left:
            if not near[number, group].any():
                group.append(number)
        yield np.array(group)
        left = np.setdiff1d(left, group)


def look(scan: Scan, what: str | Target, distance: float, lines: np.ndarray, settings: dict[str, Any],
         seed: int) -> tuple[np.ndarray, np.ndarray]:
    """For targets at a distance, m, along lines: the probability that one scan detects each, and its number of points.
    Yaw and wings are random, except for boards; ranges vary evenly by one range unit."""
    random, sensor, file = np.random.default_rng(seed), scan.sensor, str(settings.get("species_file_name", ""))
    surfaces = _surfaces(what, settings.get("reflectance", 0.3), settings.get("gliding", False), file)
    kind, flocks = "bird", [np.zeros((1, 3))]
    if isinstance(what, Target):
        kind = what.kind
        if kind == "flock":
            flocks = [places_in_flock(what.species, int(what.size), seed + k, file) for k in range(PHASES)]
    bounds = np.array(surfaces[0].GetBounds()).reshape(3, 2)
    size = float(np.linalg.norm(bounds[:, 1] - bounds[:, 0]))
    size += 2.0 * float(np.linalg.norm(flocks, axis=2).max())
    distance = max(distance, size)  # nearer targets contain the sensor
    unit = 0.5 * SPEED_OF_LIGHT * sensor.sampling_interval
    missed, points = np.ones(len(lines)), np.zeros(len(lines))
    for group in _apart(lines, size / distance):
        movers: list[vtkPolyData] = []
        owners: list[int] = []
        for number in group:
            middle = (distance + unit * ((number + 0.5) * GOLDEN % 1.0 - 0.5)) * lines[number]
            turn, tilt = 2.0 * np.pi * random.random(), 0.0
            if kind == "board":
                turn, tilt = math.atan2(*middle[:2]), math.asin(lines[number, 2])
            c, s = math.cos(turn), math.sin(turn)
            a, b = 0.5 * turn, 0.5 * tilt
            turned = [math.cos(a) * math.cos(b), math.cos(a) * math.sin(b), -math.sin(a) * math.sin(b),
                      -math.sin(a) * math.cos(b)]  # first about x, then clockwise about z
            for place in flocks[random.integers(len(flocks))] @ np.array([(c, -s, 0), (s, c, 0), (0, 0, 1)]):
                surface = surfaces[random.integers(len(surfaces))]
                movers.append(mover(surface, [middle + place], orientations=[turned]))
                add_array(movers[-1].GetCellData(), "object_id",
                          np.full(surface.GetNumberOfCells(), len(owners), dtype=np.int32))
                owners.append(number)
        scan.movers = movers
        report = _report(scan)
        of = np.array(owners)[report["object_id"]]
        np.multiply.at(missed, of, 1.0 - report["detection_probability"])
        np.add.at(points, of, report["number_of_echoes"])
    return 1.0 - missed, points


def _report(scan: Scan):
    """The report on the movers of a scan without surfaces."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about missing surfaces
        return scan.mover_report


def met(sensor: Sensor, what: Target, distances: np.ndarray, settings: dict[str, Any], seed: int) -> np.ndarray:
    """The probability that a beam which meets a wall or the ground at each distance, m, gives a point: a row for each
    distance, a column for each of PHASES places in a range unit. The threshold is that of all beams of the sensor."""
    unit = 0.5 * SPEED_OF_LIGHT * sensor.sampling_interval
    phases = unit * ((np.arange(PHASES) + 0.5) / PHASES - 0.5)
    ways = np.maximum((np.asarray(distances)[:, None] + phases).ravel(), 0.1 * unit)
    half = MARGIN * max(sensor.half_beamwidth, sensor.half_beamwidth_across)
    grazing = np.zeros(len(ways))
    near = far = ways
    if what.kind == "ground":
        grazing = np.arcsin(np.minimum(1.0, what.height / ways))
        near = what.height / np.tan(np.minimum(grazing + half, 0.5 * np.pi))
        far = what.height / np.tan(np.maximum(grazing - half, what.height / (ways + sensor.range_gate)))
    wide = half * np.maximum(far, ways) + 0.1
    places = np.cumsum(2.0 * wide) - wide
    own = copy.deepcopy(sensor)
    own._beams = (np.column_stack([0.0 * ways, np.cos(grazing), -np.sin(grazing)]), None,
                  np.column_stack([places, 0.0 * ways, 0.0 * ways]))
    own._take_beams(*own._beams)
    own.false_alarms_per_scan = sensor.false_alarms_per_scan * len(ways) / sensor.beams.number_of_points
    movers = []
    for k, x in enumerate(wide):
        first, last = (ways[k], -x), (ways[k], x)
        if what.kind == "ground":
            first, last = (near[k], -what.height), (far[k], -what.height)
        corners = np.array([(-x, *first), (x, *first), (x, *last), (-x, *last)])
        surface = Scene(corners, [(0, 1, 2), (0, 2, 3)], material=(what.reflectance, 0.0, 1.0)).surfaces.GetBlock(0)
        movers.append(mover(surface, [(places[k], 0.0, 0.0)]))
        add_array(movers[-1].GetCellData(), "object_id", np.full(2, k, dtype=np.int32))
    scan = scan_of(own, settings, seed)
    scan.movers = movers
    report, found = _report(scan), np.zeros(len(ways))
    found[report["object_id"]] = report["detection_probability"]
    return found.reshape(-1, PHASES)
