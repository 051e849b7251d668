# SPDX-License-Identifier: BSD-3-Clause
"""Sites that two ranks share are those of one process. Arguments: mpiexec, pvbatch."""

import json
import sys
import unittest

from ranktools import SOURCE, fresh, on_ranks, run

PLAN = SOURCE / "Examples" / "coverage" / "hongqiao.coverage.json"


def few(folder, parts=(), **siting):
    """The airport's plan with one sensor and fewer places and candidates. @param parts further parts of it"""
    plan = json.loads(PLAN.read_text(encoding="utf-8"))
    plan.update({name: str((PLAN.parent / plan[name]).resolve()) for name in ("scene", "runways")}, compare_with=[], places=300, **dict(parts))
    plan["siting"].update({"spacing": 1200, "masts": [5], "draws": 5, **siting})
    folder.mkdir(parents=True)
    file = folder / "few.coverage.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    return "-m", "avianlidar", "siting", file, "-o", folder


class Ranks(unittest.TestCase):
    def test_share_sites(self):
        alone, together = fresh("TestSitingRanks", "alone"), fresh("TestSitingRanks", "together")
        done = run(sys.executable, *few(alone))
        self.assertEqual(done.returncode, 0, done.stderr)
        done = on_ranks(*few(together))
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("sites.csv", "sites.geojson", "sites.vtp", "gain.csv", "robustness.csv", "sites.png"):
            self.assertEqual((alone / name).read_bytes(), (together / name).read_bytes(), name)
        files = [{file.name for file in (folder / "coverage").iterdir()} for folder in (alone, together)]
        self.assertEqual(*files)

    def test_share_the_weathers_of_a_year(self):
        alone, together = fresh("TestSitingRanks", "year-alone"), fresh("TestSitingRanks", "year-together")
        year = {"year": [{"weather": ["haze:20000"], "share": 0.75}, {"weather": ["fog:700", "rain:5"], "share": 0.25}]}
        done = run(sys.executable, *few(alone, year, draws=0))
        self.assertEqual(done.returncode, 0, done.stderr)
        command = few(together, year, draws=0)
        self.assertEqual(run(sys.executable, *command).returncode, 0)  # of which half is lost: the ranks go on
        kept = sorted((together / "coverage").iterdir())
        for file in kept[::2]:
            file.unlink()
        done = on_ranks(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("sites.csv", "sites.geojson", "sites.vtp", "gain.csv"):
            self.assertEqual((alone / name).read_bytes(), (together / name).read_bytes(), name)
        self.assertEqual({file.name: file.read_bytes() for file in kept}, {file.name: file.read_bytes() for file in (alone / "coverage").iterdir()})

    def test_an_error_ends_the_job(self):
        command = few(fresh("TestSitingRanks", "bad"))
        command[3].write_text(command[3].read_text().replace("herring gull", "dodo"))
        done = on_ranks(*command)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)

    def test_an_error_in_the_work_ends_the_job_at_once(self):
        """The other rank would be at its own site for half an hour."""
        command = few(fresh("TestSitingRanks", "work"))
        script = command[3].with_name("work.py")
        script.write_text(f"""
import time
from avianlidar import _command, siting
from avianlidar._ranks import Ranks
def kept(values):
    if Ranks().rank == 0:
        time.sleep(1800)
    raise OSError("no space for rank 1")
siting._kept = kept
_command.main(["siting", {str(command[3])!r}, "-o", {str(command[5])!r}])
""", encoding="utf-8")
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
again = al.Sequence({str(SOURCE / 'Examples' / 'sequence' / 'hongqiao.scenario.json')!r}, number_of_scans=4, scans_per_sequence=1,
                    scan={{"rays_per_beam": 20}}, sensor={{"preset": "Airport16", "azimuth_step": 5.0}})
for work in (lambda: siting.look(wall, al.Sensor(azimuth_range=(-1.0, 1.0)), [(k, 0, 2) for k in range(4)], [(0, 200, 1)], ["crow"], home, ranks, stop),
             lambda: again.write(home + "/sequence", ranks, lambda *_: stop(0, 0))):
    try:
        work()
        heard = "no error"
    except (KeyError, al.Error) as error:
        heard = str(error)
    with open(f"{{home}}/heard{{ranks.rank}}.txt", "a", encoding="utf-8") as file:
        file.write(heard + "\\n")
""", encoding="utf-8")
        done = on_ranks(script)
        self.assertEqual(done.returncode, 0, done.stderr)
        for rank, words in enumerate(("another rank failed; its own error says why", "'mine'")):
            # A file for each rank: what two ranks print may stand in one line.
            heard = (folder / f"heard{rank}.txt").read_text(encoding="utf-8")
            self.assertEqual(heard, 2 * (words + "\n"), done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
