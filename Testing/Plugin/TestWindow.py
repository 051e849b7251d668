# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window as a user meets it, started once, with the state that brings the plugin; window_steps.py does all
the steps.

Run by the system's Python: TestWindow.py paraview pvpython [--documentation | auto]. With auto the plugin is loaded by
itself, and macros are taken back. Pictures and the seconds of processor of each part go to the folder TestWindow in the
one for temporary files; with --documentation (and Debian's libqt5svg5, without which ParaView has no icons) pictures go
to Documentation/images."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from gui_testing import HERE, OUTPUT_DIR, PLUGIN_DIR, SOURCE_DIR, run_script

SIZE, DOCUMENTED = (1280, 1024), (1600, 1900)
IMAGES = {"start": "start", "start-view": "start-view", "sensors": "paraview-sensors", "beam": "paraview-beam",
          "sequence": "paraview-sequence", "AvianLidarEchoFilter-default": "panel-echo-filter"}
FINE, COARSE = "SPACING = [12.0, 12.0, 7.5]", "SPACING = [60.0, 60.0, 15.0]"
AUTO = '<Plugins><Plugin name="AvianLidarPlugin" filename="{}" auto_load="1" /></Plugins>'


def main(paraview, _, option=None):
    with tempfile.TemporaryDirectory() as folder:
        copy = shutil.copytree(PLUGIN_DIR, os.path.join(folder, "o'brien" if option == "auto" else "AvianLidarPlugin"))
        given = {"AVIANLIDAR_PLUGIN_COPY": copy}
        coverage = pathlib.Path(copy, "Macros", "avian_lidar_coverage.py")
        text = coverage.read_text("utf-8")
        assert FINE in text
        coverage.write_text(text.replace(FINE, COARSE), "utf-8")  # TestMacros.py looks at what it finds
        if option == "auto":
            given["PV_PLUGIN_CONFIG_FILE"] = plugins = os.path.join(folder, "plugins.xml")
            pathlib.Path(plugins).write_text(AUTO.format(os.path.join(copy, "AvianLidarPlugin.so")), "utf-8")
            run_script(paraview, "TestWindow-auto", SIZE, ["--script", os.path.join(HERE, "window_steps.py")], **given)
            return
        if option:
            scenario = os.path.join(SOURCE_DIR, "Examples", "sequence", "hongqiao.scenario.json")
            subprocess.run([sys.executable, "-m", "avianlidar", "sequence", scenario, "-o", folder, "--scans", "4"],
                           check=True)
            given["AVIANLIDAR_DOCUMENTATION"] = os.path.join(folder, "sequences", "00", "times.txt")
        state = os.path.join(copy, "States", "avian_lidar_airport.py")
        with open(state, "a", encoding="utf-8") as file:  # ParaView takes no script beside it
            file.write("\nimport window_steps\n")
        run_script(paraview, "TestWindow", DOCUMENTED if option else SIZE, ["--state", state], **given)
    for name, image in IMAGES.items() if option else ():
        shutil.copyfile(os.path.join(OUTPUT_DIR, "TestWindow", name + ".png"),
                        os.path.join(SOURCE_DIR, "Documentation", "images", image + ".png"))


if __name__ == "__main__":
    main(*sys.argv[1:])
