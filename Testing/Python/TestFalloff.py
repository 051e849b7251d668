# SPDX-License-Identifier: BSD-3-Clause
"""The fall of signal with range, of a made frame: its planes are found where they are, the estimator returns n = 2 of
its signal and of the simulation, and n = 0 of a reflectivity from which range was taken out."""
import contextlib
import io

import numpy as np

import avianlidar as al
import cloudtools
import exampletools
import falloff
from echotools import InFolder

GROUND = falloff.Plane("ground", np.array([0.03, 0.04, -np.sqrt(1 - 0.0025)]), 1.8, np.array([], int))
WALL = falloff.Plane("wall", np.array([0.0, -1.0, 0.0]), 6.0, np.array([], int))
ELEVATIONS = np.arange(-15.0, 16.0, 2.0)


def cloud(points, ring, **fields):
    data = cloudtools.cloud(points)
    for name, values in {"laser_id": ring.astype(np.uint16), **fields}.items():
        cloudtools.add_array(data, name, values)
    return al.Cloud(data)


def scanned(random):
    """Points of a turn over ground, with a wall on one side, with range noise: points, ring, signal h/r^3."""
    azimuth, elevation = np.meshgrid(np.radians(np.arange(0, 360, 0.35)), np.radians(ELEVATIONS))
    way = np.column_stack([(np.cos(elevation) * np.sin(azimuth)).ravel(), (np.cos(elevation) * np.cos(azimuth)).ravel(),
                           np.sin(elevation).ravel()])
    ring = np.repeat(np.arange(len(ELEVATIONS)), azimuth.shape[1])
    with np.errstate(divide="ignore"):
        ranges = np.array([np.where(way @ plane.normal > 1e-9, plane.distance / (way @ plane.normal), np.inf)
                           for plane in (GROUND, WALL)])
    which, nearest = ranges.argmin(axis=0), ranges.min(axis=0)
    seen = nearest < 25
    distance = nearest[seen]
    signal = 1e6 * np.array([GROUND.distance, WALL.distance])[which[seen]] / distance**3
    return way[seen] * (distance + random.normal(0, 0.01, len(distance)))[:, None], ring[seen], signal, which[seen]


class Planes(InFolder):
    def test_frames(self):
        random = np.random.default_rng(5)
        points, ring, signal, which = scanned(random)
        found = falloff.find_planes(points, ring)
        self.assertEqual(sorted(plane.kind for plane in found), ["ground", "wall"])
        for plane in found:
            made = GROUND if plane.kind == "ground" else WALL
            self.assertAlmostEqual(plane.distance, made.distance, delta=0.01)
            np.testing.assert_allclose(plane.normal, made.normal, atol=3e-3)
            self.assertGreater((which[plane.points] == (plane.kind == "wall")).mean(), 0.98)
        for name, values, n in (("signal", signal, 2.0), ("reflectivity", signal * (points**2).sum(axis=1), 0.0)):
            noisy = values * random.lognormal(0, 0.3, len(values))
            file = self.folder / f"{name}.pcd"
            al.save(cloud(points, ring, **{name: noisy.astype(np.float32)}), file)
            with contextlib.redirect_stdout(io.StringIO()):
                study, = falloff.main(["--clouds", str(file), "--field", name, "--out", str(self.folder)])
            self.assertEqual(len(study.planes), 2)
            for _, windows in study.planes:
                (_, every), _, (_, model) = windows[0]
                self.assertAlmostEqual(every[0], n, delta=3 * every[1] + 0.01)
                self.assertLess(every[1], 0.1)
                self.assertAlmostEqual(model[0], 2.0, delta=0.1)
            self.assertTrue((self.folder / "falloff-planes.md").exists())
