# SPDX-License-Identifier: BSD-3-Clause
"""Sequences and tracks in them that two ranks share are those of one process. Arguments: mpiexec, pvbatch."""

import json
import sys
import unittest

from ranktools import SOURCE, on_ranks

sys.path.insert(0, str(SOURCE / "Testing" / "Python"))
import TestSequence as one  # noqa: E402
import avianlidar as al  # noqa: E402
from avianlidar._disk import LOCK, only_run  # noqa: E402
from exampletools import emptied  # noqa: E402


class Ranks(unittest.TestCase):
    def test_share_sequences_and_tracks(self):
        """Three sequences of different length, so that one rank has more to do."""
        home = emptied("sequence", "ranks")
        file = one.scenario_file(home, scans_per_sequence=3, number_of_scans=8)
        wanted = al.Sequence(file).write(home / "alone")["sequences"]
        done = on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "made")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads((home / "made" / "manifest.json").read_text())["sequences"], wanted)
        self.assertEqual({path.name for path in (home / "made").iterdir()},
                         {"datasheet.md", "manifest.json", "semantic-kitti.yaml", "sequences", "view.html"})
        al.BirdTracks([home / "made"], learning_scans=1).write(home / "tracks", page=lambda: True)  # linked by the card
        done = on_ranks("-m", "avianlidar", "track", home / "made", "-o", home / "together", "--learn", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        (home / "together" / "view.html").unlink()  # which only the command writes
        alone, together = ({path.relative_to(out): path.read_bytes() for path in out.rglob("*") if path.is_file()}
                           for out in (home / "tracks", home / "together"))
        self.assertEqual(alone.keys(), together.keys())
        for path, content in alone.items():  # unittest would compare the bytes of pictures for minutes
            self.assertTrue(content == together[path], path)

    def test_an_error_ends_the_job(self):
        home = emptied("sequence", "ranks-bad")
        file = one.scenario_file(home, birds=[{"pattern": "Crossings", "species": "dodo"}])
        done = on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "out")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)

    def test_ranks_that_would_write_different_things_write_nothing(self):
        """Scenarios of other seeds or numbers of scans, learned scans, places, a folder that another run has and one
        that no rank can lock: an error on all ranks in a script of one's own, and nobody waits."""
        home = emptied("sequence", "ranks-differ")
        file = one.scenario_file(home, scans_per_sequence=1, number_of_scans=2, birds=[])
        al.Sequence(file).write(home / "made")
        (home / "out5" / LOCK).mkdir(parents=True)
        script = home / "differ.py"
        script.write_text(f"""
import pathlib, avianlidar as al
from avianlidar import siting
from avianlidar._ranks import Ranks
rank, home, file = Ranks().rank, pathlib.Path({str(home)!r}), {str(file)!r}
wall = al.Scene(([(-9, 50, -9), (9, 50, -9), (9, 50, 9)], [(0, 1, 2)]), material="Wall")
narrow = al.Sensor(azimuth_range=(-1.0, 1.0))
for k, work in enumerate((lambda out: al.Sequence(file, seed=rank).write(out),
                          lambda out: al.Sequence(file, number_of_scans=1 + rank).write(out),
                          lambda out: al.BirdTracks([home / "made"], learning_scans=rank).write(out),
                          lambda out: siting.look(wall, narrow, [(rank, 0, 2)], [(0, 200, 1)], ["crow"], out),
                          lambda out: al.Sequence(file).write(out), lambda out: al.Sequence(file).write(out))):
    try:
        work(home / f"out{{k}}")
        heard = "no error"
    except Exception as error:
        heard = str(error)
    with open(home / f"heard{{rank}}.txt", "a", encoding="utf-8") as stream:
        stream.write(heard.splitlines()[0] + "\\n")
""", "utf-8")
        with only_run(home / "out4"):
            done = on_ranks(script)
        self.assertEqual(done.returncode, 0, done.stderr)
        for rank in range(2):
            heard = (home / f"heard{rank}.txt").read_text("utf-8").splitlines()
            self.assertEqual(len(heard), 6, heard)
            for k, words in enumerate(4 * ("the ranks would write different files",)
                                      + ("another run writes there", "")):
                self.assertIn(words, heard[k])
                self.assertIn(str(home / f"out{k}"), heard[k])
        self.assertEqual([path for k in range(4) for path in (home / f"out{k}").rglob("*") if path.is_file()], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
