# SPDX-License-Identifier: BSD-3-Clause
"""The fall of signal with range: the estimator returns n = 2 of simulated ground and walls and n = 0 of a reflectivity from
which range was taken out, its standard error is that of the noise, and planes are found where they are. With
AVIANLIDAR_DATA_DIR also what the page says of the OS0-32."""
import contextlib
import io
import os
import pathlib
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData

import avianlidar as al
import exampletools
import falloff

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
GROUND = falloff.Plane("ground", np.array([0.03, 0.04, -np.sqrt(1 - 0.0025)]), 1.8, np.array([], int))
WALL = falloff.Plane("wall", np.array([0.0, -1.0, 0.0]), 6.0, np.array([], int))
ELEVATIONS = np.arange(-15.0, 16.0, 2.0)


def cloud(points, ring, **fields):
    data, places = vtkPolyData(), vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    data.SetPoints(places)
    for name, values in {"laser_id": ring.astype(np.uint16), **fields}.items():
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
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


class Estimator(unittest.TestCase):
    def test_simulated_planes_have_two(self):
        for plane in (GROUND, WALL):
            distance, energy, beam = falloff.simulated(plane, ELEVATIONS)
            near = distance < 20  # farther, an oblique footprint is longer than the sum of units that are perceived
            beams, every = falloff.exponents(distance[near], energy[near], beam[near], plane.kind)
            self.assertAlmostEqual(every[0], 2.0, delta=max(3 * every[1], 0.01))
            self.assertLess(every[1], 0.01)
            if plane is WALL:
                self.assertGreater(len(beams), 12)
                for found in beams.values():
                    self.assertAlmostEqual(found[0], 2.0, delta=max(4 * found[1], 0.01))
            # A reflectivity: the range taken out, the cosine left.
            _, every = falloff.exponents(distance[near], (energy * distance**2)[near], beam[near], plane.kind)
            self.assertAlmostEqual(every[0], 0.0, delta=max(3 * every[1], 0.01))

    def test_beams_are_those_of_the_elevations(self):
        distance, _, beam = falloff.simulated(falloff.Plane("ground", np.array([0, 0, -1.0]), 2.0, None), ELEVATIONS[[3, 0, 5]])
        for ring, elevation in enumerate(ELEVATIONS[[3, 0, 5]]):
            np.testing.assert_allclose(distance[beam == ring], 2.0 / np.sin(np.radians(-elevation)), rtol=2e-3)

    def test_standard_errors_hold(self):
        """Patches of a wall that are bright for all beams, and beams that see farther the brighter they are: 1.96 errors
        hold n in about 95 of 100 draws."""
        random, held, draws = np.random.default_rng(3), 0, 200
        distance = np.concatenate([np.geomspace(4, 10 + i, 400) for i in range(12)])
        ring = np.repeat(np.arange(12), 400)
        bins = np.floor(np.log(distance) / falloff.BIN).astype(int)
        for _ in range(draws):
            patch, gain = random.normal(0, 0.2, bins.max() + 1), 0.2 * np.arange(12)
            signal = distance**-3.0 * np.exp(patch[bins] + gain[ring] + random.normal(0, 0.3, len(ring)))
            _, every = falloff.exponents(distance, signal, ring, "wall")
            held += abs(every[0] - 2) < 1.96 * every[1]
        self.assertGreater(held, 0.88 * draws)
        self.assertLess(held, draws)

    def test_too_little_range_says_nothing(self):
        distance = np.linspace(5, 5.5, 300)
        beams, every = falloff.exponents(distance, distance**-3, np.arange(300) % 4, "wall")
        self.assertEqual((beams, every), ({}, None))

    def test_where_only_bright_parts_are_seen(self):
        distance = np.geomspace(2, 20, 2000)
        self.assertAlmostEqual(falloff.faint_from(distance, 8000 / distance**3, 8.0), 10.0, delta=0.6)
        self.assertEqual(falloff.faint_from(distance, 8000 / distance**3, 0.5), np.inf)

    def test_own_scale(self):
        """A sensor that receives half nearer than 10 m, and whose scale knows it."""
        random = np.random.default_rng(4)
        distance, share = random.uniform(3, 30, 20000), random.uniform(20, 90, 20000)
        gain = np.where(distance < 10, 0.5, 1.0)
        x, y = falloff.own_gain(distance, 1000 * gain * share / distance**2, share, 100)
        np.testing.assert_allclose(y[x < 9.5], 0.5, rtol=0.02)
        np.testing.assert_allclose(y[x > 10.5], 1.0, rtol=0.02)


class Planes(unittest.TestCase):
    def test_what_a_plane_cuts_through_is_left_out(self):
        ring, azimuth = np.repeat([0, 1], 20), np.tile(np.arange(20.0), 2)
        on_plane = np.zeros(40, bool)
        on_plane[[0, 1, 2, 3, 16, 17, 18, 19]] = True  # two short runs, and one that goes on in the next ring
        on_plane[20:20 + falloff.RUN] = True
        order = np.random.default_rng(6).permutation(40)
        kept = falloff.in_runs(on_plane[order], ring[order], azimuth[order])
        self.assertEqual(sorted(order[kept]), list(range(20, 20 + falloff.RUN)))

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
        with tempfile.TemporaryDirectory() as folder:
            for name, values, n in (("signal", signal, 2.0), ("reflectivity", signal * (points**2).sum(axis=1), 0.0)):
                noisy = values * random.lognormal(0, 0.3, len(values))
                file = pathlib.Path(folder) / f"{name}.pcd"
                al.save(cloud(points, ring, **{name: noisy.astype(np.float32)}), file)
                with contextlib.redirect_stdout(io.StringIO()):
                    study, = falloff.main(["--clouds", str(file), "--field", name, "--out", folder])
                self.assertEqual(len(study.planes), 2)
                for _, windows in study.planes:
                    (_, every), _, (_, model) = windows[0]
                    self.assertAlmostEqual(every[0], n, delta=3 * every[1] + 0.01)
                    self.assertLess(every[1], 0.1)
                    self.assertAlmostEqual(model[0], 2.0, delta=0.1)
                self.assertGreater((pathlib.Path(folder) / "signal.png").stat().st_size, 5000)
            with self.assertRaisesRegex(ValueError, "signal.pcd: no field intensity; found "):
                falloff.main(["--clouds", str(pathlib.Path(folder) / "signal.pcd"), "--field", "intensity"])
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()):
            falloff.main(["--data", "no-such-folder"])

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is not set")
    def test_the_documented_frame(self):
        frame = falloff.FRAMES[0]
        with contextlib.redirect_stdout(io.StringIO()):
            made = falloff.tables([falloff.study(frame, pathlib.Path(DATA) / frame.file)])["falloff-planes"]
        file = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Documentation" / "results" / "falloff.md"
        for row in made.splitlines()[2:]:
            self.assertIn(row, file.read_text("utf-8"))
        self.assertRegex(made, r"OS0-32 \| wall, 4.2 m \| \d+ \| 5.\d \| 14.5 \| 2.2\d ± 0.0\d \| 0.0\d ")


if __name__ == "__main__":
    unittest.main()
