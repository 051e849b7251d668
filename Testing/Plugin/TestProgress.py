# SPDX-License-Identifier: BSD-3-Clause
"""The status bar of ParaView's window follows a long scan. A script that sets the abort flag stops it: empty outputs at once,
and whole ones after the flag is taken back.

Run by the system's Python: TestProgress.py paraview. A photo of the status bar, idle and at work, goes to TestProgress.png in
the folder for temporary files."""

import os
import sys
import time

import numpy

from gui_testing import OUTPUT_DIR, empty, photograph, run_script, wait_for, write_png

FOLDER = os.path.join(OUTPUT_DIR, "TestProgress")
SIZE = (1300, 800)
BAR = 34  # pixels of the status bar
CHANGED = 1000  # of them, at least, when it shows progress


def changed(before, now):
    return numpy.count_nonzero((before != now).any(axis=2))


def wait_for_change(frame_buffer, name):
    """The status bar before and after something shows up in it; at most until the file is there."""
    before = now = photograph(frame_buffer)[-BAR:]
    while not os.path.exists(name) and changed(before, now) < CHANGED:
        time.sleep(0.05)
        now = photograph(frame_buffer)[-BAR:]
    return before, now


def take(paraview):
    """(results of progress_steps.py, the status bar before the scan was at work, and while)."""
    bars = []

    def watch(process, log_name, frame_buffer, results):
        wait_for(os.path.join(FOLDER, "working"), process, log_name)
        bars.extend(wait_for_change(frame_buffer, results))

    empty(FOLDER)
    found = run_script(paraview, "progress_steps.py", FOLDER, SIZE, meanwhile=watch)
    return found, *bars


def main(paraview, *_):
    found, before, working = take(paraview)
    write_png(os.path.join(OUTPUT_DIR, "TestProgress.png"), numpy.concatenate([before, working]))
    assert changed(before, working) >= CHANGED, f"{changed(before, working)} pixels of the status bar changed"
    percents = [percent for percent, text in found["progress"] if "AvianLidarEchoFilter" in text]
    assert percents == sorted(percents) and len(set(percents)) > 5, percents
    # The filter itself says all that there is to show, whatever time it takes.
    assert found["steps"] == sorted(found["steps"]) and len(set(found["steps"])) > 80, found["steps"]
    assert found["painted"] > 3, found["painted"]
    assert found["whole"] > 1000, found["whole"]

    stopped = found["stopped"]
    assert stopped["echoes"] == stopped["report"] == 0, stopped
    # Counted in progress events, as seconds are the machine's: a few after the flag is set, and most of the scan is left out.
    assert stopped["events"][0] > 0 and stopped["events"][1] < 30, stopped
    assert sum(stopped["events"]) < 0.7 * found["events"], (stopped, found["events"])
    assert not found["differences"], found


if __name__ == "__main__":
    main(*sys.argv[1:])
