# SPDX-License-Identifier: BSD-3-Clause
"""Part of cliffs.py: what paths with two reflections cost, above all in beams that return no echo.

A place is a scene and a lidar. Each row of a place is the processor time of a scan with two reflections over that of a
scan with one, by one thread. Sceneries that are not part of the repository are left out where AVIANLIDAR_DATA_DIR is
empty; their scene files lie in AVIANLIDAR_SCENES_DIR (default: build/paraview/Testing/Scenes).

The three own scenes are a town beside a field, the apron before a terminal, and terrain. The worst scene known is a
plain with 20,000 low metal boxes, 2 to 8 m wide and up to 1 m high, that a lidar sees from a mast of 15 m at grazing
incidence, 100 to 3,000 m away. A beam there sees up to hundreds of mirrors that face each other, over hundreds of
metres, so that each range unit receives little direct light."""
import math
import os
import pathlib
import warnings

import numpy as np

import avianlidar as al
from cliffs import Row, interleaved

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = pathlib.Path(os.environ.get("AVIANLIDAR_SCENES_DIR") or ROOT / "build" / "paraview" / "Testing" / "Scenes")
PHOTONS = {"receiver_model": "Photons", "receiver_aperture": 0.01, "background_radiance": 0.1,
           "receiver_efficiency": 0.3}
SIDES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
                  (0, 6, 4), (1, 5, 7), (1, 7, 3)])


class Mesh:
    """Triangles with a material each."""

    def __init__(self):
        self.points, self.triangles, self.materials, self.count = [], [], [], 0

    def add(self, points, triangles, material):
        self.points.append(np.asarray(points, float))
        self.triangles.append(np.asarray(triangles) + self.count)
        self.materials += [material] * len(triangles)
        self.count += len(points)

    def box(self, low, size, material, turn=0.0):
        """An upright box. @param low middle of its base, m @param turn about the vertical, rad"""
        corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)]) * size
        cosine, sine = np.cos(turn), np.sin(turn)
        self.add(corners @ np.array([(cosine, sine, 0), (-sine, cosine, 0), (0, 0, 1)]) + low, SIDES, material)

    def pane(self, one, two, bottom, top, material):
        """An upright rectangle over the line from `one` to `two`."""
        points = [(*one, bottom), (*two, bottom), (*two, top), (*one, top)]
        self.add(points, [(0, 1, 2), (0, 2, 3)], material)

    def heights(self, size, number, height, material):
        """A square of `number` times `number` points, `size` m wide. @param height function of x and y, m"""
        x, y = np.meshgrid(*2 * (np.linspace(-0.5 * size, 0.5 * size, number),))
        corner = (np.arange(number - 1)[:, None] * number + np.arange(number - 1)).ravel()
        self.add(np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()]),
                 np.concatenate([corner[:, None] + (0, 1, number + 1), corner[:, None] + (0, number + 1, number)]),
                 material)

    def scene(self):
        names = {"Ground": (0.22, 0.0, 1.0), "Concrete": (0.31, 0.0, 1.0),
                 **{name: values[:3] for name, values in al.materials().items()}}
        return al.Scene(np.concatenate(self.points), np.concatenate(self.triangles),
                        material=[names[name] for name in self.materials])


def waves(random, shortest, longest, steepness):
    """Sums of waves as a function of x and y: heights of ground."""
    lengths = np.geomspace(longest, shortest, 24)
    angles, phases = random.uniform(0, 2 * np.pi, (2, 24))

    def height(x, y):
        return sum(steepness * length / 24
                   * np.sin(2 * np.pi / length * (np.cos(angle) * x + np.sin(angle) * y) + phase)
                   for length, angle, phase in zip(lengths, angles, phases))
    return height


def town():
    """Houses with windows and gables in streets north of the lidar, a rough field south of it."""
    random, mesh = np.random.default_rng(1), Mesh()
    mesh.heights(2400, 161, lambda x, y: np.where(y < 20, 0.4 * waves(random, 30, 300, 0.1)(x, y), 0.0), "Ground")
    for row in range(12):
        for column in range(-15, 16):
            x, y = 32 * column + random.uniform(-4, 4), 60 + 45 * row + random.uniform(-4, 4)
            width, depth, height = random.uniform((8, 8, 4), (16, 12, 10))
            mesh.box((x, y, 0), (width, depth, height), "Wall")
            for side in (-1, 1):
                face = y + side * (0.5 * depth + 0.02)
                for window in np.arange(-0.5 * width + 1, 0.5 * width - 1.5, 2.5):
                    for floor in np.arange(1, height - 1.5, 2.8):
                        mesh.pane((x + window, face), (x + window + 1.3, face), floor, floor + 1.3, "Glass")
            a, b, top = 0.5 * width + 0.4, 0.5 * depth + 0.4, height + 0.4 * depth
            mesh.add([(x - a, y - b, height), (x + a, y - b, height), (x + a, y, top), (x - a, y, top),
                      (x - a, y + b, height), (x + a, y + b, height)],
                     [(0, 1, 2), (0, 2, 3), (4, 3, 2), (4, 2, 5), (0, 3, 4), (1, 5, 2)], "Wood")
    return mesh.scene(), (0, 0, 3)


def apron():
    """A terminal's glass front with piers and bridges, and aircraft and vehicles before it."""
    random, mesh = np.random.default_rng(2), Mesh()
    mesh.heights(3000, 2, lambda x, _: 0.0 * x, "Concrete")
    mesh.box((0, 330, 0), (700, 60, 22), "Wall")
    for x in np.arange(-345, 345, 6.0):
        mesh.pane((x, 299.9), (x + 5.6, 299.9), 1, 20, "Glass")
    for stand in range(-6, 7):
        x = 52 * stand + random.uniform(-2, 2)
        mesh.box((x - 14, 280, 4), (3, 40, 3), "Metal", random.uniform(-0.2, 0.2))
        length, y, angle = random.uniform(34, 40), 262, np.linspace(0, 2 * np.pi, 25)[:-1]
        ring = 2 * np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
        ends = np.concatenate([ring * s + (x, y - 0.5 * length + length * t, 4)
                               for t, s in ((0, 0.2), (0.15, 1), (0.75, 1), (1, 0.3))])
        side = (24 * np.arange(3)[:, None] + np.arange(24)).ravel()
        after = side // 24 * 24 + (side + 1) % 24
        mesh.add(ends, np.concatenate([np.column_stack([side, after, after + 24]),
                                       np.column_stack([side, after + 24, side + 24])]), "Metal")
        mesh.box((x, y, 3), (34, 5, 0.6), "Metal")
        mesh.box((x, y - 0.45 * length, 5), (0.5, 4, 7), "Metal")
        for _ in range(6):
            mesh.box((x + random.uniform(-20, 20), y + random.uniform(-25, 25), 0.3),
                     random.uniform((2, 2, 1), (7, 3, 3)), "Metal", random.uniform(0, 3))
    return mesh.scene(), (0, 0, 3)


def terrain():
    """Hills with crags over 3 km, 250,000 triangles."""
    mesh, height = Mesh(), waves(np.random.default_rng(3), 25, 1500, 0.6)
    mesh.heights(3000, 355, height, "Ground")
    return mesh.scene(), (0, 0, float(height(0, 0)) + 3)


def sheets(number=20000):
    """The worst scene: see above."""
    random, mesh = np.random.default_rng(4), Mesh()
    mesh.heights(8000, 2, lambda x, _: 0.0 * x, "Concrete")
    for _ in range(number):
        mesh.box((random.uniform(-1200, 1200), random.uniform(100, 3000), 0), random.uniform((2, 2, 0.3), (8, 8, 1)),
                 "Metal", random.uniform(0, 3))
    return mesh.scene(), (0, 0, 15)


def plates(number):
    """Small panes of any direction before a wall, `number` in each beam of a column."""
    random, mesh = np.random.default_rng(5), Mesh()
    mesh.pane((-5, 102), (5, 102), -5, 15, "Wall")
    for _ in range(10 * number):
        at, (one, two) = random.uniform((-0.6, 97, -0.6), (0.6, 101, 10.6)), random.normal(0, 1, (2, 3))
        one, two = (0.03 * v / np.linalg.norm(v) for v in (one, two))
        mesh.add([at, at + one, at + one + two, at + two], [(0, 1, 2), (0, 2, 3)], "Glass")
    return mesh.scene(), (0, 0, 0)


def scan(scene, position, step, reflections, sensor=(), **settings):
    return al.Scan(scene, al.Sensor("Airport16", position=position, azimuth_step=step, **dict(sensor)),
                   number_of_threads=1,
                   number_of_reflections=reflections, **settings).update()


def times_of(scene, position, step, rounds, sensor=(), **settings):
    """Processor times (s) of scans with one and two reflections."""
    scan(scene, position, 90.0, 1)  # builds the tree
    return interleaved({number: lambda number=number: scan(scene, position, step, number, sensor, **settings)
                        for number in (1, 2)}, rounds)


def slope(fewer, more, rounds):
    """Exponent with which the time of second reflections grows with the number of panes in a beam."""
    seconds = []
    for number in (fewer, more):
        times = times_of(*plates(number), 90.0, 8 * rounds)  # short scans
        seconds.append(times[2] - times[1])
    return math.log(seconds[1] / seconds[0]) / math.log(more / fewer)


def places():
    """Name, scene, position of the lidar, properties of the sensor and aim."""
    if os.environ.get("AVIANLIDAR_DATA_DIR"):
        for what, name in (("Hongqiao with structures", "zsss_structures"), ("Honolulu", "phnl"),
                           ("Neubrandenburg", "neubrandenburg")):
            scene = al.Scene(str(SCENES / (name + ".lidarscene.json")))
            yield what, scene, scene.lidar_position, {}, 1.6
    scene = al.Scene(al.example_scene())
    yield "the shipped airport", scene, scene.lidar_position, {}, 1.6
    yield "a town beside a field", *town(), {}, 1.6
    yield "the apron of a terminal", *apron(), {}, 1.6
    yield "terrain", *terrain(), {}, 1.6
    yield "metal sheets seen from a mast (the worst)", *sheets(), {"orientation": (0, -4, 0)}, 2.0


def rows(short):
    rounds = 5 if short else 10
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of places where faces coincide or little is seen
        for what, scene, position, sensor, aim in places():
            times = times_of(scene, position, 3.0 if short else 1.5, rounds, sensor)
            yield Row("silent", f"two reflections over one, {what}", times[2] / times[1], "", aim)
        scene, position = sheets()
        times = times_of(scene, position, 6.0 if short else 3.0, rounds, {**PHOTONS, "orientation": (0, -4, 0)},
                         rain_rate=10.0, visibility=5000.0, air_backscatter=True)
        yield Row("silent", "two reflections over one, the same with a photon receiver in rain", times[2] / times[1],
                  "", 2.0)
        for fewer, more in ((12, 48), (100, 400)):
            yield Row("silent", f"growth of second reflections with panes in a beam, {fewer} to {more}",
                      slope(fewer, more, rounds), "", 1.1)
