# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window: the echo filter is found by what it does, takes beams alone as Beams, says what is not connected; the
first Apply colours echoes and shows a range image; undo, delete, reload and reset lead out of every state of error, alone
and as a client of pvserver.

Run by the system's Python: TestWindow.py paraview pvpython [server]."""

import os
import sys
import tempfile

from gui_testing import OUTPUT_DIR, empty, run_script
from TestClientServer import server

SIZE = (1400, 900)
ENTRY = "Avian Lidar Echo Filter: Scan Surfaces and Birds"
LIMITS = [2e-6, 6.25e-5]
# What each state of error says, one line for each object that fails.
SAID = {"value": ["AttenuationCoefficient is -1"], "file": ["is not JSON", "its producer failed"],
        "input": ["Input port 1 (surfaces) is not connected"]}
SCENE, BEAMS, ECHOES = "AvianLidarSceneReader1", "AvianLidarAirport161", "AvianLidarEchoFilter1"
LEFT = {"undo": [BEAMS, ECHOES, SCENE], "delete": [BEAMS, SCENE], "reload": [BEAMS, ECHOES, SCENE], "reset": []}


def check_found(found):
    assert "Avian Lidar" not in found["found"]["avian"], found["found"]["avian"]  # which would hide the toolbar
    for word, entries in found["found"].items():
        assert entries.get(ENTRY) is False, (word, entries)  # a mesh with normals gives no beams
    assert ENTRY in found["menu"], found["menu"]
    assert (found["mesh"], found["beams"]) == (False, True), found
    assert found["tip"].startswith("Requires a point attribute array"), found["tip"]
    assert len(found["missing"]) == 1 and "Input port 1 (surfaces) is not connected" in found["missing"][0], found["missing"]
    assert "Edit > Change Input > Surfaces" in found["missing"][0], found["missing"]


def check_shown(found):
    for name, representation, mode in (("echoes", "Points", "3D"), ("image", "Slice", "2D")):
        shown = found[name]
        assert shown["array"] == ["POINTS", "energy"] and representation in shown["representation"], shown
        assert shown["limits"] == LIMITS and shown["legend"] == ["energy (J)", 1] and mode in shown["mode"], shown
    assert found["image"]["own"] and found["image"]["width"] > 300, found["image"]


def check_walk(state, way, walk):
    assert len(walk["errors"]) == len(SAID[state]), (state, way, walk)
    for words, error in zip(SAID[state], walk["errors"]):
        assert words in error, (state, way, walk)
    assert walk["echoes"] > 500 and not walk["later"], (state, way, walk)
    assert walk["left"] == sorted(LEFT[way]), (state, way, walk)


def check(found, states, ways):
    check_found(found)
    check_shown(found)
    assert sorted(found["walks"]) == sorted(f"{state}/{way}" for state in states for way in ways), found["walks"]
    for name, walk in found["walks"].items():
        check_walk(*name.split("/"), walk)


def run(paraview, name, arguments, states, ways):
    folder = os.path.join(OUTPUT_DIR, "TestWindow-" + name)
    empty(folder)
    given = {"AVIANLIDAR_STATES": " ".join(states), "AVIANLIDAR_WAYS": " ".join(ways)}
    found = run_script(paraview, "window_steps.py", folder, SIZE, arguments, expected=("ERR|", "Avian lidar"),
                       AVIANLIDAR_SERVER=str(len(arguments)), **given)
    check(found, states, ways)


def main(paraview, _, where="window"):
    if where == "window":
        run(paraview, where, [], SAID, LEFT)
        return
    with tempfile.TemporaryDirectory() as folder, server(folder, 1, "start") as port:
        # TestErrors.py reloads a file of a server.
        run(paraview, "server", [f"--server-url=cs://localhost:{port}"], ["value", "input"], ["delete"])


if __name__ == "__main__":
    main(*sys.argv[1:])
