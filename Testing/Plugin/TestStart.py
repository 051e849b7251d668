# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window as a newcomer meets it: the state alone brings the plugin and the scanned airport; loading the plugin
brings its macros, which nobody has imported, icons and help.

Run by the system's Python: TestStart.py paraview pvpython [--documentation]. Photographs go to the folder for temporary
files; with --documentation also to Documentation/images."""

import os
import shutil
import subprocess
import sys
import tempfile
import time

import numpy

from TestGui import SIZE, STYLE, check_picture
from gui_testing import OUTPUT_DIR, PLUGIN_DIR, SOURCE_DIR, empty, photograph, problems, run_script, window, write_png

PHOTOS = os.path.join(OUTPUT_DIR, "TestStart")
STATE = os.path.join(PLUGIN_DIR, "States", "avian_lidar_airport.py")
LOG = os.path.join(OUTPUT_DIR, "TestStart.log")
MACROS = ["avian_lidar_wizard", "avian_lidar_airport_scan", "avian_lidar_birds_over_the_airport", "avian_lidar_birds_tracked", "avian_lidar_coverage",
          "avian_lidar_ground_fog", "avian_lidar_energy_colours", "avian_lidar_status_colours", "avian_lidar_show_beam", "avian_lidar_class_colours"]
IN_MENU = ("avian_lidar_wizard", "avian_lidar_birds_tracked", "avian_lidar_ground_fog", "avian_lidar_show_beam",
           "avian_lidar_class_colours")  # alone: the toolbar fits beside ParaView's
TIMEOUT = 120


def scanned(frame_buffer):
    """The photo, once the scanned airport is on the screen and the window at rest."""
    end = time.monotonic() + TIMEOUT
    before = photograph(frame_buffer)
    while True:
        time.sleep(2)
        assert not problems(LOG), problems(LOG)
        picture = photograph(frame_buffer)
        try:
            assert numpy.array_equal(before, picture), "the window does not come to rest"
            check_picture(picture)
            return picture
        except AssertionError:
            if time.monotonic() > end:
                write_png(os.path.join(PHOTOS, "problem.png"), picture)
                raise
        before = picture


def view_of(picture):
    """The part of the window that draws, within its blue frame, at half the size."""
    blue = (picture[:, :, 0] == 0) & (picture[:, :, 1] == 0) & (picture[:, :, 2] > 120)
    rows = numpy.flatnonzero(blue.mean(axis=1) > 0.6)
    columns = numpy.flatnonzero(blue.mean(axis=0) > 0.6)
    view = picture[rows[0] + 2 : rows[-1] - 1, columns[0] + 2 : columns[-1] - 1]
    height, width = view.shape[0] // 2, view.shape[1] // 2
    return view[: 2 * height, : 2 * width].reshape(height, 2, width, 2, 3).mean(axis=(1, 3)).astype(numpy.uint8)


def test_state(paraview):
    """The state is all that ParaView is told."""
    with tempfile.TemporaryDirectory() as home, open(LOG, "w", encoding="utf-8") as log:
        with window(paraview, home, log, ["--state", STATE], SIZE, STYLE, plugin=False) as (_, frame_buffer):
            picture = scanned(frame_buffer)
    write_png(os.path.join(PHOTOS, "start.png"), picture)
    view = view_of(picture)
    write_png(os.path.join(PHOTOS, "start-view.png"), view)
    # Left of the legend: the strongest echoes are seen, not covered by weaker ones.
    red, green, blue = (view[:, : 3 * view.shape[1] // 4, i].astype(int) for i in range(3))
    count = numpy.count_nonzero((red > 150) & (green < 60) & (blue < 60))
    assert count > 15, f"{count} red pixels"


def look_at_plugin(paraview, **environment):
    """What start_client.py finds."""
    return run_script(paraview, "start_client.py", PHOTOS, SIZE, style=STYLE, plugin=False, **environment)


def test_plugin(paraview, pvpython):
    found = look_at_plugin(paraview)
    assert (found["before"], found["macros"]) == ([], MACROS), found
    assert found["toolbar"] == [*(name for name in MACROS if name not in IN_MENU), "AvianLidarEchoFilter"], found
    assert len(found["icons"]) >= 12 and all(found["icons"].values()), found["icons"]
    assert "One click" in found["pages"]["Start here"]
    assert "AvianLidarEchoFilter" in found["pages"]["Filters/Echo Filter"]
    assert "AvianLidarAirport16" in found["asked"], found["asked"]
    assert "2D" in found["mode"], found["mode"]
    subprocess.run([pvpython, __file__, "--check-clicked"], check=True)


def test_auto_load(paraview):
    """Loaded before there is a window: the macros are there, too. A scene that is not yet applied is, by its scan."""
    plugins = os.path.join(PHOTOS, "plugins.xml")
    with open(plugins, "w", encoding="utf-8") as file:
        library = os.environ["AVIANLIDAR_PLUGIN"]
        file.write(f'<Plugins><Plugin name="AvianLidarPlugin" filename="{library}" auto_load="1" /></Plugins>')
    found = look_at_plugin(paraview, PV_PLUGIN_CONFIG_FILE=plugins)
    assert (found["macros"], found["apply"], found["shown"]) == (MACROS, False, False), found


def check_clicked():
    """In pvpython: what the macro made gives the echoes that a script gets."""
    from plugin_testing import assert_state_has_airport

    assert_state_has_airport(os.path.join(PHOTOS, "clicked.pvsm"), "Scan")


def main(paraview, pvpython, option=None):
    empty(PHOTOS)
    test_state(paraview)
    test_plugin(paraview, pvpython)
    test_auto_load(paraview)
    if option == "--documentation":
        for name in ("start.png", "start-view.png", "range-image.png"):
            shutil.copyfile(os.path.join(PHOTOS, name), os.path.join(SOURCE_DIR, "Documentation", "images", name))


if __name__ == "__main__":
    if sys.argv[1] == "--check-clicked":
        check_clicked()
    else:
        main(*sys.argv[1:])
