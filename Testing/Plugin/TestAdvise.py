# SPDX-License-Identifier: BSD-3-Clause
"""The button Advise of the echo filter's panel, in the window alone and as a client of pvserver on two ranks: it measures on the
filter's inputs, sets the panel's values (Preset to Custom, as another one overrides them) and applies nothing; Apply does.
What is wrong is said as other errors are, and nothing is set.

Run by the system's Python: TestAdvise.py paraview pvpython."""

import os
import sys
import tempfile

from gui_testing import OUTPUT_DIR, empty, run_script
from TestClientServer import server

SIZE = (1200, 1000)
CUSTOM, STANDARD = 0, 2


def check(found, ranks):
    assert found["server"] == ranks, found
    before, advised, applied = (found[name] for name in ("before", "advised", "applied"))
    assert before["applied"]["Preset"] == STANDARD, before
    # What is shown has changed, what is applied has not.
    assert advised["applied"] == before["applied"], (before, advised)
    assert advised["shown"]["Preset"] == CUSTOM and advised["shown"]["NumberOfReflections"] == 1, advised
    assert advised["combo"] == "Custom" and advised["accept"], advised
    assert "Advised: " in found["answer"] and "One reflection is enough: " in found["answer"], found["answer"]
    assert "a convex body cannot light itself" in found["answer"], found["answer"]
    for name, value in advised["shown"].items():
        assert f"{value}" in found["answer_tip"] or name in ("Preset", "BeamSamples", "Sampling"), (name, found["answer_tip"])
    assert applied["applied"] == advised["shown"] and not applied["accept"], (applied, advised)
    assert any("EchoSettings" in text or "AttenuationCoefficient" in text for text in found["errors"]), found["errors"]
    assert found["answer_of_error"] == "No advice: nothing was measured", found
    assert found["sources"] == 3, found["sources"]  # what the button makes is not shown


def run(paraview, name, ranks, arguments):
    folder = os.path.join(OUTPUT_DIR, "TestAdvise-" + name)
    empty(folder)
    check(run_script(paraview, "advise_steps.py", folder, SIZE, arguments, expected=("ERR|", "Avian")), ranks)


def main(paraview, *_):
    run(paraview, "window", 1, [])
    with tempfile.TemporaryDirectory() as folder, server(folder, 2, "start") as port:
        run(paraview, "server", 2, [f"--server-url=cs://localhost:{port}"])


if __name__ == "__main__":
    main(*sys.argv[1:])
