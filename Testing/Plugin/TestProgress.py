# SPDX-License-Identifier: BSD-3-Clause
"""The status bar of ParaView's window follows a long scan. Its abort button, pressed by events of the X server as by a user,
stops the scan: empty outputs at once, and whole ones after the next Apply. So does a script.

Run by the system's Python: TestProgress.py paraview. A photo of the status bar, idle and at work, goes to TestProgress.png in
the folder for temporary files."""

import os
import subprocess
import sys
import time

import numpy

from gui_testing import OUTPUT_DIR, empty, photograph, run_script, wait_for, write_png

FOLDER = os.path.join(OUTPUT_DIR, "TestProgress")
SIZE = (1300, 800)
BAR = 34  # pixels of the status bar
CHANGED = 1000  # of them, at least, when it shows progress


def press(place, display):
    """Moves the pointer to the place that the file says, and clicks twice."""
    with open(place, encoding="utf-8") as file:
        x, y = file.read().split()
    click = ["mousedown", "1", "sleep", "0.08", "mouseup", "1", "sleep", "0.1"]
    subprocess.run(["xdotool", "mousemove", x, y, *click, *click], check=True, env=dict(os.environ, DISPLAY=display))


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

    def press_and_watch(process, log_name, frame_buffer, results):
        for step in ("press", "idle", "working"):
            place = os.path.join(FOLDER, step)
            wait_for(place, process, log_name)
            if step == "press":
                wait_for_change(frame_buffer, os.path.join(FOLDER, "idle"))
            if step != "working":
                press(place, display_of(process))
            open(place + "-pressed", "w", encoding="utf-8").close()
        bars.extend(wait_for_change(frame_buffer, results))

    empty(FOLDER)
    found = run_script(paraview, "progress_steps.py", FOLDER, SIZE, meanwhile=press_and_watch)
    return found, *bars


def display_of(process):
    """The name of the display that the process draws on."""
    with open(f"/proc/{process.pid}/environ", encoding="utf-8") as file:
        variables = dict(line.split("=", 1) for line in file.read().split("\0") if "=" in line)
    return variables["DISPLAY"]


def main(paraview, *_):
    found, before, working = take(paraview)
    write_png(os.path.join(OUTPUT_DIR, "TestProgress.png"), numpy.concatenate([before, working]))
    assert changed(before, working) >= CHANGED, f"{changed(before, working)} pixels of the status bar changed"
    percents = [percent for percent, text in found["progress"] if "AvianLidarEchoFilter" in text]
    assert percents == sorted(percents) and len(set(percents)) > 20, percents
    assert found["painted"] > 10, found["painted"]

    assert found["enabled"] and not found["idle"], "the abort button may be pressed while a scan is at work, and only then"
    pressed, script = found["pressed"], found["script"]
    assert pressed["echoes"] == pressed["report"] == script["echoes"] == script["report"] == 0, found
    # Counted in progress events, as seconds are the machine's: a few after the press, and most of the scan is left out.
    assert pressed["events"][0] > 0 and pressed["events"][1] < 30, pressed
    assert sum(pressed["events"]) < 0.7 * found["events"], (pressed, found["events"])
    assert pressed["apply"], "Apply cannot be pressed after a stop"
    assert found["kept"] == 0, found["kept"]
    assert found["whole"] > 1000 and not found["differences"], found
    assert not script["differences"], script


if __name__ == "__main__":
    main(*sys.argv[1:])
