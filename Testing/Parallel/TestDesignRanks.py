# SPDX-License-Identifier: BSD-3-Clause
"""Designs that two ranks share are those of one process. Arguments: mpiexec, pvbatch."""

import json
import sys
import unittest

from ranktools import SOURCE, fresh, on_ranks, run

PLAN = SOURCE / "Examples" / "design" / "hongqiao.coverage.json"
WRITTEN = ("design.csv", "sensitivities.csv", "front.png", "sensitivities.png", "design.html")


def few(folder, **coverage):
    """The example's plan with fewer places and designs, and without clutter."""
    plan = json.loads(PLAN.read_text(encoding="utf-8"))
    plan.update({name: str((PLAN.parent / plan[name]).resolve()) for name in ("scene", "runways")}, places=300)
    plan["coverage"].update({"clutter": False, **coverage})
    plan["design"]["designs"] = 10
    plan["sensor"]["azimuth_step"] = 1.5
    folder.mkdir(parents=True)
    file = folder / "few.coverage.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    return "-m", "avianlidar", "design", file, "-o", folder / "out"


class Ranks(unittest.TestCase):
    def test_share_designs(self):
        alone, together = fresh("TestDesignRanks", "alone"), fresh("TestDesignRanks", "together")
        done = run(sys.executable, *few(alone))
        self.assertEqual(done.returncode, 0, done.stderr)
        command = few(together)
        done = on_ranks(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        kept = sorted((together / "out" / "coverage").iterdir())
        self.assertEqual({file.name: file.read_bytes() for file in kept}, {file.name: file.read_bytes() for file in (alone / "out" / "coverage").iterdir()})
        for file in kept[::2]:  # half is lost: the ranks go on
            file.unlink()
        done = on_ranks(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in WRITTEN:
            self.assertEqual((alone / "out" / name).read_bytes(), (together / "out" / name).read_bytes(), name)

    def test_an_error_ends_the_job(self):
        done = on_ranks(*few(fresh("TestDesignRanks", "bad"), species="dodo"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
