# SPDX-License-Identifier: BSD-3-Clause
"""Sites and designs that two ranks share are those of one process; what one rank raises ends or reaches the others.
Arguments: mpiexec, pvbatch."""

import json
import sys
import unittest

from ranktools import SOURCE, fresh, on_ranks, run

EXAMPLES = SOURCE / "Examples"
PLAN, DESIGN = EXAMPLES / "coverage" / "hongqiao.coverage.json", EXAMPLES / "coverage" / "design.coverage.json"
TARGET = {"species": "", "effective_area": 0.03, "clutter": False}  # m2: quicker than birds


def few(folder, verb="siting", **parts):
    """The airport's plan with few places, candidates and designs. @param parts further parts of it"""
    plan = json.loads((PLAN if verb == "siting" else DESIGN).read_text("utf-8"))
    plan.update({name: str((PLAN.parent / plan[name]).resolve()) for name in ("scene", "runways")}, compare_with=[],
                places=50, coverage=TARGET)
    plan.update(parts)
    if verb == "siting":
        plan["siting"].update(spacing=800, bounds=[-1200, 1600, -1200, 1200], masts=[5], draws=0, sensors=2)
    else:
        plan["design"]["designs"] = 6
        plan["sensor"]["azimuth_step"] = 3.0
    folder.mkdir(parents=True)
    file = folder / "few.coverage.json"
    file.write_text(json.dumps(plan), "utf-8")
    return "-m", "avianlidar", verb, file, "-o", folder / "out"


class Ranks(unittest.TestCase):
    def test_share_sites_and_designs(self):
        """In the weathers of a year; half is lost, and the ranks go on."""
        year = [{"weather": ["haze:20000"], "share": 0.75}, {"weather": ["fog:700", "rain:5"], "share": 0.25}]
        for verb, parts, names in (("siting", {"year": year},
                                    ("sites.csv", "sites.geojson", "sites.vtp", "gain.csv", "sites.png")),
                                   ("design", {"coverage": {**TARGET, "number_of_scans": 2}},
                                    ("design.csv", "sensitivities.csv", "front.png", "design.html"))):
            alone, together = fresh("TestSitingRanks", f"{verb}-alone"), fresh("TestSitingRanks", f"{verb}-together")
            done = run(sys.executable, *few(alone, verb, **parts))
            self.assertEqual(done.returncode, 0, done.stderr)
            command = few(together, verb, **parts)
            wanted = {file.name: file.read_bytes() for file in (alone / "out" / "coverage").iterdir()}
            (together / "out" / "coverage").mkdir(parents=True)
            for name in sorted(wanted)[::2]:
                (together / "out" / "coverage" / name).write_bytes(wanted[name])
            done = on_ranks(*command)
            self.assertEqual(done.returncode, 0, done.stderr)
            for name in names:
                self.assertEqual((alone / "out" / name).read_bytes(), (together / "out" / name).read_bytes(), name)
            self.assertEqual({file.name: file.read_bytes() for file in (together / "out" / "coverage").iterdir()},
                             wanted)

    def test_an_error_in_the_work_ends_the_job_at_once(self):
        """The other rank would be at its own site for half an hour."""
        command = few(fresh("TestSitingRanks", "work"))
        script = command[3].with_name("work.py")
        script.write_text(f"""
import time
from avianlidar import _command
from avianlidar.apps.coverage import _looks
from avianlidar._ranks import Ranks
def kept(values):
    if Ranks().rank == 0:
        time.sleep(1800)
    raise OSError("no space for rank 1")
_looks.packed = kept
_command.main(["siting", {str(command[3])!r}, "-o", {str(command[5])!r}])
""", "utf-8")
        done = on_ranks(script)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no space for rank 1", done.stderr)

    def test_what_one_rank_raises_all_hear_of(self):
        """In a script of one's own, where the job goes on."""
        folder = fresh("TestSitingRanks", "raises")
        folder.mkdir(parents=True)
        script = folder / "raises.py"
        script.write_text(f"""
import numpy as np, avianlidar as al
from avianlidar import siting
from avianlidar._ranks import Ranks
ranks, home = Ranks(), {str(folder)!r}
def stop(done, total):
    if ranks.rank == 1:
        raise KeyError("mine")
wall = al.Scene(([(-9, 50, -9), (9, 50, -9), (9, 50, 9)], [(0, 1, 2)]), material="Wall")
again = al.Sequence({str(SOURCE / 'Examples' / 'sequence' / 'hongqiao.scenario.json')!r}, number_of_scans=4,
                    scans_per_sequence=1, scan={{"rays_per_beam": 20}},
                    sensor={{"preset": "Airport16", "azimuth_step": 5.0}})
narrow, sites = al.Sensor(azimuth_range=(-1.0, 1.0)), [(k, 0, 2) for k in range(4)]
for work in (lambda: siting.look(wall, narrow, sites, [(0, 200, 1)], ["crow"], home, ranks, stop),
             lambda: again.write(home + "/sequence", ranks, lambda *_: stop(0, 0))):
    try:
        work()
        heard = "no error"
    except (KeyError, al.Error) as error:
        heard = str(error)
    with open(f"{{home}}/heard{{ranks.rank}}.txt", "a", encoding="utf-8") as file:
        file.write(heard + "\\n")
""", "utf-8")
        done = on_ranks(script)
        self.assertEqual(done.returncode, 0, done.stderr)
        for rank, words in enumerate(("another rank failed; its own error says why", "'mine'")):
            # A file for each rank: what two ranks print may stand in one line.
            heard = (folder / f"heard{rank}.txt").read_text("utf-8")
            self.assertEqual(heard, 2 * (words + "\n"), done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
