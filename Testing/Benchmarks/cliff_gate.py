# SPDX-License-Identifier: BSD-3-Clause
"""Part of cliffs.py: what a short range gate saves. A place is a scene and a lidar; few of its triangles lie within the
gate. Each row is the processor time of a scan with a gate of 200 m over that of a scan with one of 4,000 m, by one thread."""
import os
import warnings

import numpy as np

import avianlidar as al
from cliff_silent import SCENES, Mesh, scan, terrain
from cliffs import Row, interleaved

NEAR, FAR = 200.0, 4000.0  # m


def blocks(near=50, far=20000):
    """Blocks of a city on a plain of two triangles, few of them within the gate."""
    random, mesh = np.random.default_rng(6), Mesh()
    mesh.heights(9000, 2, lambda x, _: 0.0 * x, "Ground")
    for number, closest, farthest in ((near, 60, NEAR), (far, NEAR + 20, 4000)):
        for _ in range(number):
            angle = random.uniform(0, 2 * np.pi)
            distance = np.sqrt(random.uniform(closest ** 2, farthest ** 2))
            mesh.box((distance * np.cos(angle), distance * np.sin(angle), 0), random.uniform((6, 6, 3), (20, 20, 30)),
                     "Wall", random.uniform(0, 3))
    return mesh.scene(), (0, 0, 10)


def places():
    """Name, scene, position of the lidar and aim."""
    if os.environ.get("AVIANLIDAR_DATA_DIR"):
        for what, name in (("Hongqiao with structures", "zsss_structures"), ("Honolulu", "phnl"),
                           ("Neubrandenburg", "neubrandenburg")):
            scene = al.Scene(str(SCENES / (name + ".lidarscene.json")))
            yield what, scene, scene.lidar_position, None
    yield "20,050 blocks, 50 of them within 200 m", *blocks(), 0.5
    yield "1,010 blocks, 10 of them within 200 m", *blocks(10, 1000), 0.5
    yield "blocks, none within 200 m", *blocks(0), 0.5
    yield "terrain", *terrain(), None


def rows(short):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of places where faces coincide or little is seen
        for what, scene, position, aim in places():
            scan(scene, position, 90.0, 1)  # builds the tree
            for reflections in (1, 2):
                times = interleaved({gate: lambda gate=gate: scan(scene, position, 1.5 if short else 0.5, reflections,
                                                                  {"range_gate": gate}) for gate in (NEAR, FAR)},
                                    5 if short else 10)
                yield Row("gate", f"{NEAR:.0f} m over {FAR:.0f} m, {what}, {reflections} "
                                  f"reflection{'s' if reflections > 1 else ''}", times[NEAR] / times[FAR], "", aim)
