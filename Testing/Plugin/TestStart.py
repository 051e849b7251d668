# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window as a newcomer meets it: the state alone brings the plugin and the scanned airport, the macros are
there without having been imported, and the help has the plugin's pages.

Run by the system's Python: TestStart.py paraview pvpython [folder]. Photographs go to the folder for temporary files or
to the folder given; that is how Documentation/images/start.png is made."""

import os
import subprocess
import sys
import tempfile
import time

from TestGui import SIZE, STYLE, check_picture
from gui_testing import HERE, OUTPUT_DIR, PLUGIN_DIR, photograph, problems, wait_for, window, write_png

STATE = os.path.join(PLUGIN_DIR, "States", "avian_lidar_airport.py")
SAVED = os.path.join(OUTPUT_DIR, "TestStart.pvsm")
LOG = os.path.join(OUTPUT_DIR, "TestStart.log")
TIMEOUT = 120


def scanned(frame_buffer):
    """The photo, once the scanned airport is on the screen."""
    end = time.monotonic() + TIMEOUT
    while True:
        assert not problems(LOG), problems(LOG)
        picture = photograph(frame_buffer)
        try:
            check_picture(picture)
        except AssertionError:
            if time.monotonic() > end:
                write_png(os.path.join(OUTPUT_DIR, "TestStart-problem.png"), picture)
                raise
            time.sleep(0.5)
        else:
            # Let the window draw itself to the end.
            time.sleep(2)
            return photograph(frame_buffer)


def test_state(paraview, folder):
    """The state is all that ParaView is told."""
    with tempfile.TemporaryDirectory() as home, open(LOG, "w", encoding="utf-8") as log:
        with window(paraview, home, log, ["--state", STATE], SIZE, STYLE, plugin=False) as (_, frame_buffer):
            write_png(os.path.join(folder, "start.png"), scanned(frame_buffer))


def test_macros_and_help(paraview, pvpython, folder):
    """start_gui.xml: the macro out of the menu, which nobody has imported, then the help."""
    if os.path.exists(SAVED):
        os.remove(SAVED)
    script = ["--test-directory", OUTPUT_DIR, "--test-script", os.path.join(HERE, "start_gui.xml")]
    with tempfile.TemporaryDirectory() as home, open(LOG, "w", encoding="utf-8") as log:
        with window(paraview, home, log, script, SIZE, STYLE) as (process, frame_buffer):
            wait_for(SAVED, process, LOG)
            time.sleep(2)
            picture = photograph(frame_buffer)
    assert not problems(LOG), problems(LOG)
    write_png(os.path.join(folder, "start-help.png"), picture)
    # The window of the help lies at the upper left.
    assert (picture[100:600, 300:1000] > 200).mean() > 0.5, "no page of the help"
    subprocess.run([pvpython, __file__, "--check-saved"], check=True)


def check_saved():
    """In pvpython: what the macro made gives the echoes that a script gets."""
    from paraview import simple

    from plugin_testing import airport, assert_same, fetch, load_plugin

    load_plugin()
    simple.LoadState(SAVED)
    found = fetch(simple.FindSource("Echoes"))
    assert len(found["energy"]) > 1000
    _, _, _, echoes = airport()
    assert_same(found, fetch(echoes))


def main(paraview, pvpython, folder=OUTPUT_DIR):
    test_state(paraview, folder)
    test_macros_and_help(paraview, pvpython, folder)


if __name__ == "__main__":
    if sys.argv[1] == "--check-saved":
        check_saved()
    else:
        main(*sys.argv[1:])
