# SPDX-License-Identifier: BSD-3-Clause
"""An error in ParaView's window, alone and as a client of pvserver on two ranks: said each time, nothing to see while it
lasts, and what comes after it is seen; Save Data leaves a good file alone.

Run by the system's Python: TestErrors.py paraview."""

import os
import sys
import tempfile

from gui_testing import OUTPUT_DIR, empty, run_script
from TestClientServer import server

SIZE = (1000, 800)
# What follows what.
CHAIN = {
    "Scene": ("Material", "Tree", "Echoes", "Colours", "Image"),
    "Material": ("Tree", "Echoes", "Colours", "Image"),
    "Sensor": ("Echoes", "Colours", "Image"),
    "Echoes": ("Colours", "Image"),
}
CLASSES = {
    "Scene": "SceneReader",
    "Material": "Material",
    "Tree": "CollisionTree",
    "Sensor": "BeamSource",
    "Echoes": "EchoFilter",
    "Colours": "HSBColorMap",
    "Image": "RangeImage",
}


def in_window(paraview):
    return run(paraview, "1", [])


def on_server(paraview, ranks):
    with tempfile.TemporaryDirectory() as folder, server(folder, ranks, "start") as port:
        return run(paraview, str(ranks) + "-server", [f"--server-url=cs://localhost:{port}"])


def run(paraview, name, arguments):
    folder = os.path.join(OUTPUT_DIR, "TestErrors-" + name)
    empty(folder)
    return run_script(paraview, "error_steps.py", folder, SIZE, arguments, expected=("ERR|", "Avian lidar"))


def check_case(name, looks):
    first, failed, mended, failed_again, mended_again = looks
    hit = (name, *CHAIN[name])
    for look in (failed, failed_again):
        # Each says it once, the first one what it is.
        for each in hit:
            said = [text for text in look["errors"] if f"vtkAvianLidar{CLASSES[each]} (" in text]
            assert len(said) == 1, (name, each, look["errors"])
            assert ("its producer failed" in said[0]) == (each != name), said
        assert len(look["errors"]) == len(hit), look["errors"]
        for each in CLASSES:
            elements, error = look["information"][each]
            assert error == (each in hit), (name, each, look)
            if each != "Image":  # that has its extent, and no numbers
                assert (elements == 0) == (each in hit), (name, each, look)
                assert (look["shown"][each] == 0) == (each in hit), (name, each, look)
    for look in (first, mended, mended_again):
        assert not look["errors"], look["errors"]
        for each in CLASSES:
            assert look["information"][each][0] > 0 and not look["information"][each][1], (name, each, look)
            assert look["shown"][each] > 0, (name, each, look)
    # Other echoes than before: those of the mended value.
    for one, other in ((first, mended), (mended, mended_again)):
        assert one["information"]["Echoes"] != other["information"]["Echoes"], (name, one, other)
        assert one["shown"]["Echoes"] != other["shown"]["Echoes"], (name, one, other)
    for one, other in zip(looks, looks[1:]):
        assert one["picture"] != other["picture"], (name, one, other)


def check(found, ranks):
    assert found["server"] == ranks, found["server"]
    assert not found["applies"], "Apply can be pressed though nothing was changed"
    for name in CHAIN:
        check_case(name, found["cases"][name])
    # The filters behind, before, after the error and after the good value.
    assert found["files"].pop("behind") == [True, True, False, False, True, True], found["files"]
    for name, steps in found["files"].items():
        (allowed, _, size), (allowed_then, same_then, _), (allowed_again, same_again, _) = steps
        assert size > 1000, (name, steps)
        assert [allowed, allowed_then, allowed_again] == [True, False, True], (name, steps)
        assert same_then and not same_again, (name, steps)


def main(paraview, *_):
    check(in_window(paraview), 1)
    check(on_server(paraview, 2), 2)


if __name__ == "__main__":
    main(*sys.argv[1:])
