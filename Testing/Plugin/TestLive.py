# SPDX-License-Identifier: BSD-3-Clause
"""With Auto Apply, each step of a value in the panel lights an Airport32 scan anew and draws it, without tracing; the
echoes are those of a new scan, bit for bit.

Run by the system's Python: TestLive.py paraview. Testing/Benchmarks/live.py measures with it."""

import json
import os
import sys
import tempfile

from gui_testing import HERE, OUTPUT_DIR, problems, wait_for, window

SIZE = (1600, 1000)


def live(paraview, steps, timeout=240):
    """The results of live_steps.py."""
    results = os.path.join(OUTPUT_DIR, "TestLive.json")
    if os.path.exists(results):
        os.remove(results)
    log_name = os.path.join(OUTPUT_DIR, "TestLive.log")
    environment = {"AVIANLIDAR_RESULTS": results, "AVIANLIDAR_STEPS": str(steps)}
    environment["PYTHONPATH"] = os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")])
    with tempfile.TemporaryDirectory() as folder, open(log_name, "w", encoding="utf-8") as log:
        arguments = ["--script", os.path.join(HERE, "live_steps.py")]
        with window(paraview, folder, log, arguments, SIZE, **environment) as (process, _):
            wait_for(results, process, log_name, timeout)
    assert not problems(log_name), problems(log_name)
    with open(results, encoding="utf-8") as file:
        found = json.load(file)
    assert not found["error"], found["error"]
    return found


def main(paraview, *_):
    found = live(paraview, 5)
    assert found["first_rays"] > 1e6, found["first_rays"]
    for name, change in found["changes"].items():
        assert change["executions"] == change["steps"], (name, change)
        # A filter whose input was drawn may be drawn twice.
        assert change["frames"] >= change["steps"], (name, change)
        # Brighter materials may need a weak path that was left out before.
        assert change["rays"] <= (1e-5 * found["first_rays"] if name in ("Kd", "Ks", "Kp") else 0), (name, change)
        assert not change["differences"], (name, change)
    # ParaView's sliders apply when the mouse lets go, not before.
    assert found["drag"] == [0, 1], found["drag"]


if __name__ == "__main__":
    main(*sys.argv[1:])
