# SPDX-License-Identifier: BSD-3-Clause
"""The status bar of ParaView's window follows a long scan; a scan that is told to stop leaves empty outputs at once, and the
next one is whole.

ParaView 5.11 never enables its abort button; releases that do make the call that is made here.

Run by the system's Python: TestProgress.py paraview. A photo of the status bar goes to TestProgress.png in the folder for
temporary files."""

import os
import sys
import time

import numpy

from gui_testing import OUTPUT_DIR, empty, photograph, run_script, wait_for, write_png

FOLDER = os.path.join(OUTPUT_DIR, "TestProgress")
SIZE = (1300, 800)
BAR = 34  # pixels of the status bar
CHANGED = 1000  # of them, at least, when it shows progress


def take(paraview):
    """(results of progress_steps.py, the status bar before the scan, and while it was at work)."""
    bars = []

    def watch(process, log_name, frame_buffer, results):
        wait_for(os.path.join(FOLDER, "working"), process, log_name)
        before = working = photograph(frame_buffer)[-BAR:]
        while not os.path.exists(results) and changes(before, working) < CHANGED and process.poll() is None:
            time.sleep(0.05)
            working = photograph(frame_buffer)[-BAR:]
        bars.extend([before, working])

    empty(FOLDER)
    found = run_script(paraview, "progress_steps.py", FOLDER, SIZE, meanwhile=watch)
    return found, *bars


def changes(before, after):
    """Pixels that differ."""
    return numpy.count_nonzero((before != after).any(axis=2))


def main(paraview, *_):
    found, before, working = take(paraview)
    write_png(os.path.join(OUTPUT_DIR, "TestProgress.png"), numpy.concatenate([before, working]))
    changed = changes(before, working)
    assert changed >= CHANGED, f"{changed} pixels of the status bar changed"
    percents = [percent for percent, text in found["progress"] if "AvianLidarEchoFilter" in text]
    assert percents == sorted(percents) and len(set(percents)) > 20, percents
    assert found["painted"] > 10, found["painted"]
    assert not found["button"], "the abort button works: say so in Documentation/paraview.md, and press it here"

    # At once: in progress events, as the clock shows what else the machine does.
    stopped = found["stopped"]
    assert 0 <= stopped["after"] <= 3, stopped
    assert stopped["echoes"] == stopped["report"] == 0, stopped
    assert found["again"] > 1000 and not found["differences"], found


if __name__ == "__main__":
    main(*sys.argv[1:])
