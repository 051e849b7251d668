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
    def test_share_sequences(self):
        home = emptied("sequence", "ranks")
        file = one.scenario_file(home, scans_per_sequence=8, number_of_scans=20)
        wanted = al.Sequence(file).write(home / "alone")["sequences"]
        done = on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "together")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads((home / "together" / "manifest.json").read_text())["sequences"], wanted)

    def test_share_tracks(self):
        """Three sequences of different length, so that one rank has more to do."""
        home = emptied("sequence", "ranks-tracks")
        file = one.scenario_file(home, scans_per_sequence=8, number_of_scans=22)
        al.Sequence(file).write(home / "made")
        al.BirdTracks([home / "made"], learning_scans=3).write(home / "alone")
        done = on_ranks("-m", "avianlidar", "track", home / "made", "-o", home / "together", "--learn", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        files = [{path.relative_to(home / name): path.read_bytes() for path in (home / name).rglob("*") if path.is_file()} for name in ("alone", "together")]
        self.assertEqual(*map(sorted, files))
        self.assertEqual([name for name, content in files[0].items() if files[1][name] != content], [])

    def test_an_error_ends_the_job(self):
        home = emptied("sequence", "ranks-bad")
        file = one.scenario_file(home, birds=[{"pattern": "Crossings", "species": "dodo"}])
        done = on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "out")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Species is 'dodo'", done.stderr)

    def test_ranks_that_would_write_different_things_write_nothing(self):
        """Scenarios of other seeds, as many scans, and learned scans of tracks: an error on all ranks, in a script of one's own, too."""
        home = emptied("sequence", "ranks-differ")
        file = one.scenario_file(home, scans_per_sequence=1, number_of_scans=2)
        al.Sequence(file).write(home / "made")
        script = home / "differ.py"
        script.write_text(f"""
import pathlib, avianlidar as al
from avianlidar import siting
from avianlidar._ranks import Ranks
rank, home = Ranks().rank, pathlib.Path({str(home)!r})
wall = al.Scene(([(-9, 50, -9), (9, 50, -9), (9, 50, 9)], [(0, 1, 2)]), material="Wall")
for k, work in enumerate((lambda out: al.Sequence({str(file)!r}, seed=rank).write(out), lambda out: al.Sequence({str(file)!r}, number_of_scans=1 + rank).write(out),
                          lambda out: al.BirdTracks([home / "made"], learning_scans=rank).write(out),
                          lambda out: siting.look(wall, al.Sensor(azimuth_range=(-1.0, 1.0)), [(rank, 0, 2)], [(0, 200, 1)], ["crow"], out))):
    try:
        work(home / f"out{{k}}")
        heard = "no error"
    except al.Error as error:
        heard = str(error)
    with open(home / f"heard{{rank}}.txt", "a", encoding="utf-8") as stream:
        stream.write(heard + "\\n")
""", encoding="utf-8")
        done = on_ranks(script)
        self.assertEqual(done.returncode, 0, done.stderr)
        for rank in range(2):
            heard = (home / f"heard{rank}.txt").read_text(encoding="utf-8").splitlines()
            self.assertEqual(heard, [f"{home / f'out{k}'}: the ranks are to write different things there, expected the same files, settings and "
                                     "version on all" for k in range(4)], done.stderr)
        self.assertEqual([path for k in range(4) for path in (home / f"out{k}").rglob("*") if path.is_file()], [])

    def test_a_folder_that_another_run_has(self):
        """An error on all ranks, which does not wait; afterwards the ranks have the folder, which is none's in the end."""
        home = emptied("sequence", "ranks-held")
        file = one.scenario_file(home, scans_per_sequence=1, number_of_scans=2)
        with only_run(home / "out"):
            done = on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "out")
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(f"{home / 'out'}: another run writes there", done.stderr)
        (home / "other" / LOCK).mkdir(parents=True)  # no rank can lock it
        done = on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "other")
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(on_ranks("-m", "avianlidar", "sequence", file, "-o", home / "out").returncode, 0)
        self.assertEqual(sorted(path.name for path in (home / "out").iterdir()), ["datasheet.md", "manifest.json", "semantic-kitti.yaml", "sequences"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
