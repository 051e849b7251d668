# SPDX-License-Identifier: BSD-3-Clause
"""With Auto Apply, each step of a value in the panel lights an Airport32 scan anew and draws it, tracing nothing that is
known; the echoes are those of a new scan, bit for bit.

Run by the system's Python: TestLive.py paraview. Testing/Benchmarks/live.py measures with it."""

import os
import sys

from gui_testing import OUTPUT_DIR, run_script

SIZE = (1600, 1000)
# Share of the first scan's rays that a step may trace, on the average; of others none. Brighter materials, clearer air and a
# lower limit need some weak paths that were left out before, so may another return mode after these.
WEAK = 1e-5
TRACED = {
    "Kd": WEAK,
    "Ks": WEAK,
    "Kp": WEAK,
    "Attenuation Coefficient, down": WEAK,
    "Lower Energy Limit, down": WEAK,
    "Return Mode": WEAK,
}


def live(paraview, steps, timeout=240, samples="Cells"):
    """The results of live_steps.py with these BeamSamples."""
    folder = os.path.join(OUTPUT_DIR, "TestLive")
    return run_script(paraview, "live_steps.py", folder, SIZE, timeout=timeout, AVIANLIDAR_STEPS=str(steps),
                      AVIANLIDAR_SAMPLES=samples)


def main(paraview, *_):
    found = live(paraview, 5, samples="Rays")  # integrated beams have no rays to keep
    assert min(found["first_rays"].values()) > 1e6, found["first_rays"]
    for name, change in found["changes"].items():
        assert change["executions"] == change["steps"], (name, change)
        # A filter whose input was drawn may be drawn twice.
        assert change["frames"] >= change["steps"], (name, change)
        share = change["rays"] / change["steps"] / found["first_rays"][change["preset"]]
        assert share <= TRACED.get(name, 0), (name, share, change)
        assert not change["differences"], (name, change)
    # ParaView's sliders apply when the mouse lets go, not before.
    assert found["drag"] == [0, 1], found["drag"]


if __name__ == "__main__":
    main(*sys.argv[1:])
