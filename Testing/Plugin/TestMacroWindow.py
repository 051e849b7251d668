# SPDX-License-Identifier: BSD-3-Clause
"""The macros in ParaView's window, small as on a laptop: what needs nothing selected comes first in the toolbar, every
bird is seen on the screen, each item of the pipeline has a name of its own, and Edit > Undo takes back a whole macro.

Run by the system's Python: TestMacroWindow.py paraview pvpython."""

import collections
import os
import shutil
import sys

import gui_testing
from gui_testing import OUTPUT_DIR, PLUGIN_DIR, empty, run_script

SIZE = (1200, 800)
LABELS = ["Avian Lidar: Scan Surfaces or an Airport", "Avian Lidar: Scan Birds over an Airport",
          "Avian Lidar: Map Where a Bird Is Seen"]
COLOURS = {"gulls": (230, 26, 128), "crows": (255, 153, 26), "starlings": (51, 230, 102)}
SAID = ("select the echoes first", "the sensor stands beside them")
MOST = 0.75  # of the echoes: birds and their ways hide one another


def is_of(colour, kind):
    return all(abs(a - b) < 10 for a, b in zip(colour, COLOURS[kind]))


def check_birds(found):
    for kind, colours in found.items():
        assert len(colours) > 10, (kind, colours)
        own = sum(is_of(colour, kind) for colour in colours)
        assert own >= MOST * len(colours), f"{own} of {len(colours)} echoes of {kind} are seen in their colour: {colours}"


def check_names(found):
    sources = found["states"][-1]["sources"]
    assert not set(sources) & set(found["ports"]), (sources, found["ports"])
    counts = collections.Counter(map(tuple, found["items"]))
    assert max(counts.values()) == 1, counts


def main(paraview, _):
    folder = os.path.join(OUTPUT_DIR, "TestMacroWindow")
    empty(folder)
    # A macro's path goes into a script.
    gui_testing.PLUGIN_DIR = shutil.copytree(PLUGIN_DIR, os.path.join(folder, "o'brien", "AvianLidarPlugin"))
    found = run_script(paraview, "macro_steps.py", folder, SIZE, expected=SAID)
    names, enabled = zip(*found["buttons"])
    assert names[-1] == "AvianLidarEchoFilter" and enabled == (*[True] * (len(names) - 1), False), found["buttons"]
    check_birds(found["birds"])
    check_names(found)
    assert found["labels"] == ["&Undo " + label for label in LABELS], found["labels"]
    states = found["states"]
    for undone, before in zip(found["undone"], reversed(states[:-1])):
        assert undone == before, (undone, before)
    assert found["redone"] == states[1], (found["redone"], states[1])
    assert found["nothing"]
    assert found["own"][0] == found["own"][1] and found["own"][0]["sources"] == ["Box1"], found["own"]
    assert found["scanned"][0] == found["scanned"][1] > 1000, found["scanned"]


if __name__ == "__main__":
    main(*sys.argv[1:])
