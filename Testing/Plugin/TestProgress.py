# SPDX-License-Identifier: BSD-3-Clause
"""The status bar of ParaView's window follows a long scan; a scan that is told to stop leaves empty outputs at once, and the
next one is whole.

ParaView 5.11 never enables its abort button; releases that do make the call that is made here.

Run by the system's Python: TestProgress.py paraview. A photo of the status bar goes to TestProgress.png in the folder for
temporary files."""

import json
import os
import sys
import tempfile
import time

import numpy

from gui_testing import HERE, OUTPUT_DIR, photograph, problems, wait_for, window, write_png

SIZE = (1300, 800)
BAR = 34  # pixels of the status bar
CHANGED = 1000  # of them, at least, when it shows progress


def take(paraview):
    """(results of progress_steps.py, the status bar while the scan was at work, and before)."""
    log_name = os.path.join(OUTPUT_DIR, "TestProgress.log")
    with tempfile.TemporaryDirectory() as folder, open(log_name, "w", encoding="utf-8") as log:
        results = os.path.join(folder, "results.json")
        environment = {"AVIANLIDAR_RESULTS": results, "AVIANLIDAR_PHOTOS": folder}
        environment["PYTHONPATH"] = os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")])
        arguments = ["--script", os.path.join(HERE, "progress_steps.py")]
        with window(paraview, folder, log, arguments, SIZE, **environment) as (process, frame_buffer):
            wait_for(os.path.join(folder, "working"), process, log_name)
            before = working = photograph(frame_buffer)[-BAR:]
            while not os.path.exists(results) and numpy.count_nonzero((before != working).any(axis=2)) < CHANGED:
                time.sleep(0.05)
                working = photograph(frame_buffer)[-BAR:]
            wait_for(results, process, log_name)
            with open(results, encoding="utf-8") as file:
                found = json.load(file)
    assert not problems(log_name), problems(log_name)
    assert not found["error"], found["error"]
    return found, before, working


def main(paraview, *_):
    found, before, working = take(paraview)
    write_png(os.path.join(OUTPUT_DIR, "TestProgress.png"), numpy.concatenate([before, working]))
    changed = numpy.count_nonzero((before != working).any(axis=2))
    assert changed >= CHANGED, f"{changed} pixels of the status bar changed"
    own = [(seconds, percent) for seconds, percent, text in found["progress"] if "AvianLidarEchoFilter" in text]
    percents = [percent for _, percent in own]
    assert percents == sorted(percents) and len(set(percents)) > 20, percents
    assert found["painted"] > 10, found["painted"]
    assert not found["button"], "the abort button works: say so in Documentation/paraview.md, and press it here"

    seconds = own[-1][0] - own[0][0]
    stopped = found["stopped"]
    assert stopped["after"] < 0.1 * seconds, (stopped, seconds)
    assert stopped["echoes"] == stopped["report"] == 0, stopped
    assert found["again"] > 1000 and not found["differences"], found


if __name__ == "__main__":
    main(*sys.argv[1:])
