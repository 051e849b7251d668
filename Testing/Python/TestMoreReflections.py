# SPDX-License-Identifier: BSD-3-Clause
"""What the echo filter leaves out over three reflections and more: the tracer that measures it has the orders one and two of
the filter."""
import unittest

import numpy as np

import exampletools  # noqa: F401  # the path of the examples
import more_reflections as mr


def differences(found):
    """Tracer less filter, in standard errors, for the orders one and two."""
    one, two = (mr.Measured.mean((found.orders - np.pad(found.filter, ((0, 0), (0, mr.ORDERS - 2))))[:, m]) for m in (0, 1))
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
        self.assertLess(share + 3 * error, 1e-3)  # of a corridor; over three mirrors comes twenty times what the filter has


if __name__ == "__main__":
    unittest.main()
