# SPDX-License-Identifier: BSD-3-Clause
"""The trade of speed for accuracy on a small scene: errors fall and standard errors hold as theory says, and the table
has every column."""
import os
import unittest

import numpy as np

import exampletools as et
from helpertools import rows_of
import accuracy_speed
import trade_grid
import trade_results


class Trade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = et.folder("ExampleTrade")
        _, _, cls.results, _ = accuracy_speed.main(["airport", "--quick", "--out", cls.folder])

    def named(self, family, rays):
        return next(r for r in self.results
                    if r.choice.family == family and r.choice.settings["RaysPerBeam"] == rays)

    def test_errors_fall_as_theory_says(self):
        # Independent rays: -1/2. Two in each cell: -3/4 where an edge cuts the beam. Both sample every beam.
        self.assertAlmostEqual(trade_results.rate(self.results, "Monte Carlo")[0], -0.5, delta=0.07)
        self.assertAlmostEqual(trade_results.rate(self.results, "stratified")[0], -0.75, delta=0.12)

    def test_standard_errors_hold(self):
        # 1.96 of them: 95 % if estimates were normal, and what is missed is not held.
        for family, rays, wanted in (("Monte Carlo", 64, 0.93), ("Monte Carlo", 400, 0.93), ("stratified", 8, 0.9),
                                     ("stratified", 64, 0.93)):
            with self.subTest(family, rays=rays):
                self.assertGreater(self.named(family, rays).mean("held"), wanted)

    def test_table_is_complete(self):
        self.assertEqual(len(self.results), len(trade_grid.choices(True)))
        rows = rows_of(os.path.join(self.folder, "table.csv"))
        self.assertLessEqual({f"the preset {name}" for name in trade_grid.PRESETS}, {row["setting"] for row in rows})
        for kind in trade_results.KINDS:
            self.assertGreater(sum(kind in row["on the front of"] for row in rows), 2)
            self.assertTrue(all(np.isfinite(result.error(kind)) for result in self.results), kind)
