# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window: airport_gui.xml builds the airport from the menus, the state that it saves gives the echoes that
a script gets, and the window is photographed.

Run by the system's Python: TestGui.py paraview pvpython [picture.png]. The window's photo goes to TestGui.png in the
folder for temporary files or to the picture; that is how Documentation/images/paraview.png is made (with Debian's
libqt5svg5, without which ParaView has no icons)."""

import os
import shutil
import subprocess
import sys
import tempfile
import time

import numpy

from gui_testing import HERE, OUTPUT_DIR, PLUGIN_DIR, SOURCE_DIR, photograph, problems, wait_for, window, write_png

SIZE = (1600, 1000)

# A panel wide enough for its texts; by default ParaView makes it as narrow as it can.
STYLE = "#propertiesPanel { min-width: 400px; }"


def play(paraview, folder):
    """Plays the script; the photo of the window at its end."""
    macros = os.path.join(folder, "macros")
    os.makedirs(macros)
    shutil.copy(os.path.join(HERE, "airport_gui_style.py"), macros)
    state = os.path.join(OUTPUT_DIR, "TestGui.pvsm")
    if os.path.exists(state):
        os.remove(state)
    log_name = os.path.join(OUTPUT_DIR, "TestGui.log")
    arguments = ["--data-directory", os.path.join(SOURCE_DIR, "Examples", "airport", "scene")]
    arguments += ["--test-directory", OUTPUT_DIR, "--test-script", os.path.join(HERE, "airport_gui.xml")]
    with open(log_name, "w", encoding="utf-8") as log:
        with window(paraview, folder, log, arguments, SIZE, STYLE, PV_MACRO_PATH=macros) as (process, frame_buffer):
            wait_for(state, process, log_name)
            # The state is written in one go; let the window draw itself.
            time.sleep(3)
            picture = photograph(frame_buffer)
    assert not problems(log_name), problems(log_name)
    return picture


def check_picture(picture):
    """Echoes of all colours between blue and green, on grey surfaces."""
    red, green, blue = (picture[:, :, i].astype(int) for i in range(3))
    for name, found in (
        ("blue", (blue > 200) & (red < 50) & (green < 100)),
        ("cyan", (blue > 150) & (green > 150) & (red < 50)),
        ("grey", (abs(red - green) < 12) & (abs(green - blue) < 14) & (red > 80) & (red < 200)),
    ):
        count = numpy.count_nonzero(found)
        assert count > 300, f"{count} {name} pixels"


def check_state():
    """In pvpython: the saved state and the same pipeline as a script give the same echoes."""
    from plugin_testing import assert_state_has_airport

    assert_state_has_airport(os.path.join(OUTPUT_DIR, "TestGui.pvsm"), "AvianLidarEchoFilter1")


def main(paraview, pvpython, picture_name=None):
    with tempfile.TemporaryDirectory() as folder:
        picture = play(paraview, folder)
    write_png(picture_name or os.path.join(OUTPUT_DIR, "TestGui.png"), picture)
    check_picture(picture)
    subprocess.run([pvpython, __file__, "--check-state"], check=True)


if __name__ == "__main__":
    if sys.argv[1] == "--check-state":
        check_state()
    else:
        main(*sys.argv[1:])
