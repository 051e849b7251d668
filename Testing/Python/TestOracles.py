# SPDX-License-Identifier: BSD-3-Clause
"""The echo filter gives what closed forms give (Testing/Oracles), sampled and integrated."""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Testing", "Oracles"))
import run_filter

# What a mesh of the sphere and the end of a plate cost.
GEOMETRY = {"sphere, underfills the beam": 5e-5, "ground, axis on the horizon": 1e-6}


def is_of_paths(row):
    """Paths over two reflections are sampled, in integrated beams, too."""
    return row["quantity"].startswith("secondary")


class Oracles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rows = run_filter.results()

    def test_sampled_beams_lie_within_their_standard_errors(self):
        beyond_three = []
        for row in self.rows:
            if row["how"] == "integrated" and not is_of_paths(row):
                continue
            with self.subTest(**row):
                error = abs(row["found"] - row["expected"])
                allowed = GEOMETRY.get(row["case"], 1e-6 if "sphere" in row["case"] else 1e-10) * row["expected"]
                self.assertLess(error, 5 * row["standard_error"] + allowed)
                beyond_three.append(error > 3 * row["standard_error"] + allowed)
        self.assertLessEqual(sum(beyond_three), 2)

    def test_whole_beams_of_many_rays_are_exact(self):
        for row in self.rows:
            if row["quantity"] in ("energy (J)", "mean range (m)"):
                with self.subTest(**row):
                    few = row["case"] == "edge at 5e-3 rad"  # a fiftieth of the beam
                    self.assertLess(abs(row["found"] / row["expected"] - 1), 5e-3 if few else 5e-4)

    def test_integrated_beams_are_exact(self):
        rows = [row for row in self.rows if row["how"] == "integrated" and not is_of_paths(row)]
        self.assertGreater(len(rows), 50)
        for row in rows:
            with self.subTest(**row):
                error = abs(row["found"] - row["expected"])
                self.assertLess(error, 1e-6 * row["expected"])
                # Energies state a bound. It must hold, but for the digits of the oracles and the end of a plate.
                if row["standard_error"] > 0:
                    allowed = GEOMETRY.get(row["case"], 1e-12) * row["expected"]
                    self.assertLess(error, row["standard_error"] + allowed)


if __name__ == "__main__":
    unittest.main()
