# SPDX-License-Identifier: BSD-3-Clause
"""Echoes at an airport are found where they are: integrated beams invent or miss hardly any, and where beams are sampled,
refinement near the receiver's lower limit decides soundly: few are wrong where many are without it."""
import unittest

import numpy as np

import exampletools  # noqa: F401  (finds the examples)
import trade_runs

SAMPLED = {"PlaneIntegration": False}
UNREFINED = {"RefineNearLimit": False}


class Detection(unittest.TestCase):
    def shares(self, name, rays):
        """Invented and missed echoes, over the true ones: by default, and sampled, refined and not. The truth is sampled,
        too, by so many rays."""
        subject = trade_runs.Subject(name, "airport16", 2)
        reference = trade_runs.Reference(subject, rays)
        self.assertGreater(len(reference.echoes["beam_id"]), 500)
        found = []
        for settings in ({}, UNREFINED, SAMPLED, {**SAMPLED, **UNREFINED}):
            judged = [trade_runs.judge(reference, trade_runs.scan(subject, settings, seed)) for seed in range(3)]
            wrong = np.mean([one["missed"] + one["false"] for one in judged])
            found.append(wrong / len(reference.echoes["beam_id"]))
        print(f"{name}: {100 * found[0]:.2f} %, without refinement {100 * found[1]:.2f} %; "
              f"sampled {100 * found[2]:.2f} %, without refinement {100 * found[3]:.2f} %")
        return found

    def test_airport(self):
        default, unrefined, refined, plain = self.shares("airport", 5000)
        self.assertLess(default, 0.005)
        self.assertLess(unrefined, 0.005)
        self.assertLess(refined, 0.02)
        self.assertGreater(plain, 0.04)

    def test_field_of_poles_rails_and_boxes(self):
        default, unrefined, refined, plain = self.shares("field", 5000)
        self.assertLess(default, 0.005)
        self.assertLess(unrefined, 0.005)
        self.assertLess(refined, 0.05)
        self.assertGreater(plain, 0.1)


if __name__ == "__main__":
    unittest.main()
