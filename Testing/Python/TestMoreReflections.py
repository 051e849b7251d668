# SPDX-License-Identifier: BSD-3-Clause
"""What the echo filter leaves out over three reflections and more: the tracer that measures it is exact in corners of
mirrors, and has the orders one and two of the filter. And what the paper's second reflection brings, read to the letter."""
import math
import unittest

import numpy as np

import exampletools  # noqa: F401  # the path of the examples
import more_reflections as mr
import second_reflection as sr

KD, KS, KP = 0.020, 0.852, 8046  # glass (paper, Table 1)
HALF = 5.6e-3


def folded(origin, axis, rays, mirrors):
    """What each ray brings back over `mirrors` reflections, one on each of the planes x = 0, y = 0 (and z = 0) of a corner:
    seen through the mirrors the ray is straight, so its last point is where it meets the last plane, folded back."""
    steps = -origin[:mirrors] / rays[:, :mirrors]
    last = steps.argmax(axis=1)
    points = origin + steps.max(axis=1)[:, None] * rays
    points[:, :mirrors] = abs(points[:, :mirrors])
    outgoing = rays * np.where(np.arange(3) < mirrors, -1, 1)
    way = points - origin
    far = np.linalg.norm(way, axis=1, keepdims=True)
    sine = np.linalg.norm(np.cross(outgoing, -way / far), axis=1)
    lobe = KS * (1 - sine**2) ** (KP / 2)
    in_cone = (way / far) @ axis >= math.cos(HALF)
    return in_cone * KS ** (mirrors - 1) * (KD * abs(rays[np.arange(len(rays)), last]) + lobe)


def differences(found):
    """Tracer less filter, in standard errors, for the orders one and two."""
    one, two = (mr.Measured.mean((found.orders - np.pad(found.filter, ((0, 0), (0, mr.ORDERS - 2))))[:, m]) for m in (0, 1))
    return one[0] / max(one[1], 1e-12), two[0] / max(two[1], 1e-12)


class Mirrors(unittest.TestCase):
    def traced(self, subject, rays, random, connections=0):
        origin, axis = np.array(subject.sensor.GetPosition()), np.array(subject.axis)
        surfaces = mr.Surfaces(subject.tree.GetOutput())
        return np.array([mr.Beam(surfaces, origin, axis, HALF, ray[None], 0.0, random, connections).throughput for ray in rays])

    def test_corners_are_exact(self):
        random = np.random.default_rng(1)
        for mirrors, make in ((2, mr.two_mirrors), (3, mr.corner)):
            subject = make()
            axis = np.array(subject.axis)
            rays = mr.rays_of(axis, HALF, 500, random)
            found = self.traced(subject, rays, random)
            exact = folded(np.array(subject.sensor.GetPosition()), axis, rays, mirrors)
            self.assertGreater((exact > 0).sum(), 450)
            np.testing.assert_allclose(found[:, mirrors - 1], exact, rtol=1e-9, atol=1e-15)
            np.testing.assert_array_equal(found[:, mirrors:], 0)
            # First hit: kd cos, as the mirrors stand far from squarely.
            steps = -np.array(subject.sensor.GetPosition())[:mirrors] / rays[:, :mirrors]
            direct = KD * abs(rays[np.arange(len(rays)), steps.argmin(axis=1)])
            np.testing.assert_allclose(found[:, 0], direct, rtol=1e-9)


class AgainstTheFilter(unittest.TestCase):
    def test_orders_one_and_two(self):
        for subject, beams, rays, connections in ((mr.two_mirrors(), 100, 20, 0), (mr.corner(), 100, 20, 0),
                                                  (mr.corridor(), 300, 20, 2)):
            found = mr.measure(subject, beams, rays, connections)
            self.assertEqual(len(found.orders), beams)
            for order, difference in enumerate(differences(found), 1):
                self.assertLess(abs(difference), 4, f"order {order}")
            self.assertGreater(found.filter[:, 1].sum(), 0)
        share, error = found.share(found.more())
        self.assertLess(share + 3 * error, 1e-3)  # of a corridor; over three mirrors comes twenty times what the filter has


class ToTheLetter(unittest.TestCase):
    def corner(self, **material):
        """Two perpendicular plates with the edge upright."""
        paint = mr.vtkAvianLidarMaterial()
        paint.SetInputData(mr.corridor_scene.quads([[(0, 0, -3), (3, 0, -3), (3, 0, 3), (0, 0, 3)],
                                                    [(0, 0, -3), (0, 3, -3), (0, 3, 3), (0, 0, 3)]]))
        paint.SetMaterialToCustom()
        for name, value in material.items():
            getattr(paint, "Set" + name)(value)
        mr.running.update(paint)
        axis = -np.array((1.0, 1.0, 0.0)) / math.sqrt(2)
        return mr.subject("corner", paint.GetOutputDataObject(0), "Airport16", tuple(-100 * axis), 1e-4, tuple(axis))

    def test_two_rays_by_hand(self):
        subject = self.corner(Kd=0.3, Ks=0.5, Kp=3.0)
        origin = np.array(subject.sensor.GetPosition())
        places = np.array([[0.2, 0.0, 0.1], [0.0, 0.3, -0.2]])
        rays = (places - origin) / np.linalg.norm(places - origin, axis=1, keepdims=True)
        beam = sr.Beam(mr.Surfaces(subject.tree.GetOutput()), origin, np.array(subject.axis), HALF, rays, 1e-4,
                       np.random.default_rng(0))
        way = (places[1] - places[0]) / np.linalg.norm(places[1] - places[0])
        expected = 0.0
        for ray, on, back, n1, n2 in ((rays[0], way, -rays[1], (0, 1, 0), (1, 0, 0)), (rays[1], -way, -rays[0], (1, 0, 0), (0, 1, 0))):
            product = 1.0
            for come, go, n in ((ray, on, np.array(n1)), (on, back, np.array(n2))):
                mirror = come - 2 * (come @ n) * n
                product *= 0.3 * -(come @ n) + 0.5 * max(0.0, mirror @ go) ** 3
            expected += product / 2
        length = np.linalg.norm(places - origin, axis=1).sum() + np.linalg.norm(places[1] - places[0])
        for reading in ("mean", "one", "all"):
            self.assertAlmostEqual(beam.second[reading] / (expected * math.exp(-1e-4 * length)), 1, delta=1e-9)

    def test_without_a_lobe_the_mean_is_that_of_the_filter(self):
        subject = self.corner(Kd=0.3, Ks=0.0, Kp=0.0)
        beams, _ = sr.measure(subject, 40, 30)
        here, mean, one, whole = (np.array([beam.second[name] for beam in beams]) for name in sr.READINGS)
        self.assertGreater(mean.min(), 1e-3)
        found = mr.Measured.mean(here - mean)
        self.assertLess(abs(found[0]), 4 * found[1])
        np.testing.assert_allclose(whole, 29 * mean, rtol=1e-9)
        self.assertTrue(((one > mean) & (one < whole)).all())
        # Each of many targets in whole: more than there is.
        self.assertEqual([beams[0].beyond[name] > 0 for name in sr.READINGS], [False, False, False, True])


if __name__ == "__main__":
    unittest.main()
