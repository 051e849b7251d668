# SPDX-License-Identifier: BSD-3-Clause
"""What the echo filter leaves out after three reflections and more: the tracer that measures it has the orders one and
two of the filter. And what the paper's second reflection brings, read to the letter."""
import math
import unittest

import numpy as np

import exampletools  # noqa: F401  # the path of the examples
import more_reflections as mr
import second_reflection as sr

HALF = 5.6e-3


def differences(found):
    """Tracer less filter, in standard errors, for the orders one and two."""
    one, two = (mr.Measured.mean((found.orders - np.pad(found.filter, ((0, 0), (0, mr.ORDERS - 2))))[:, m])
                for m in (0, 1))
    return one[0] / max(one[1], 1e-12), two[0] / max(two[1], 1e-12)


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
        # of a corridor; over three mirrors comes twenty times what the filter has
        self.assertLess(share + 3 * error, 1e-3)


class ToTheLetter(unittest.TestCase):
    def corner(self, **material):
        """Two perpendicular plates with the edge upright."""
        paint = mr.running.vtkAvianLidarMaterial()
        paint.SetInputData(mr.running.quads([[(0, 0, -3), (3, 0, -3), (3, 0, 3), (0, 0, 3)],
                                                    [(0, 0, -3), (0, 3, -3), (0, 3, 3), (0, 0, 3)]]))
        paint.SetMaterialToCustom()
        for name, value in material.items():
            getattr(paint, "Set" + name)(value)
        mr.running.update(paint)
        axis = -np.array((1.0, 1.0, 0.0)) / math.sqrt(2)
        subject = mr.Subject("corner", paint.GetOutputDataObject(0), "Airport16", -100 * axis, 1e-4)
        subject.axis = tuple(axis)
        return subject

    def test_two_rays_by_hand(self):
        subject = self.corner(Kd=0.3, Ks=0.5, Kp=3.0)
        origin = np.array(subject.sensor.GetPosition())
        places = np.array([[0.2, 0.0, 0.1], [0.0, 0.3, -0.2]])
        rays = (places - origin) / np.linalg.norm(places - origin, axis=1, keepdims=True)
        beam = sr.Beam(mr.Surfaces(subject.tree.GetOutput()), origin, np.array(subject.axis), HALF, rays, 1e-4,
                       np.random.default_rng(0))
        way = (places[1] - places[0]) / np.linalg.norm(places[1] - places[0])
        expected = 0.0
        for ray, on, back, n1, n2 in ((rays[0], way, -rays[1], (0, 1, 0), (1, 0, 0)),
                                      (rays[1], -way, -rays[0], (1, 0, 0), (0, 1, 0))):
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
