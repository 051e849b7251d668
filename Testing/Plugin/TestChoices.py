# SPDX-License-Identifier: BSD-3-Clause
"""What a user chooses in ParaView's window: sensors by maker under Sources, named so in the pipeline; the wizard, from Finish at
once to an error, and Cancel; Show Beam of a selected echo; a sequence that is opened, plays and has the colours of its classes. All
buttons of the toolbar are in a window of 1280 pixels.

Run by the system's Python: TestChoices.py paraview pvpython [--documentation]. The pictures go to the folder TestChoices in the
one for temporary files; with the option some become Documentation/images/paraview-*.png."""

import os
import shutil
import subprocess
import sys

from gui_testing import OUTPUT_DIR, SOURCE_DIR, empty, run_script

FOLDER = os.path.join(OUTPUT_DIR, "TestChoices")
SIZE = (1280, 1024)
SCANS = 4
DOCUMENTATION = {"sensors": "paraview-sensors", "wizard-1": "paraview-wizard", "beam": "paraview-beam", "sequence": "paraview-sequence"}
MADE = ["Airport Hongqiao", "Birds", "Collision tree", "Echoes of herring gull", "Herring gull", "Scan", "Search 905"]
SAID = ("select an echo first", "needs a sensor with a Receiver Aperture")
LIDARS = {"Hesai": ["Hesai Pandar40P", "Hesai PandarXT-32"], "Livox": ["Livox Avia", "Livox Mid-360", "Livox Mid-40"],
          "Ouster": ["Ouster OS0-128", "Ouster OS1-64", "Ouster OS2-128"], "RoboSense": ["RoboSense RS-Helios-16P"],
          "Velodyne": ["Velodyne HDL-32E", "Velodyne VLP-16", "Velodyne VLP-32C"],
          "Assumed": ["Avian Lidar Automotive 16", "Avian Lidar Search 1550", "Avian Lidar Search 905"]}


def species():
    with open(os.path.join(SOURCE_DIR, "Filters", "Birds", "species.csv"), encoding="utf-8") as file:
        return [line.split(",")[0] for line in file if not line.startswith("#")][1:]


def make_sequence():
    scenario = os.path.join(SOURCE_DIR, "Examples", "sequence", "hongqiao.scenario.json")
    target = os.path.join(FOLDER, "sequences")
    subprocess.run([sys.executable, "-m", "avianlidar", "sequence", scenario, "-o", target, "--scans", str(SCANS)], check=True,
                   stdout=subprocess.DEVNULL)
    return os.path.join(target, "sequences", "00", "times.txt")


def check_sensors(found):
    makers = {name.replace(" ", ""): lidars for name, lidars in found["lidars"].items()}  # ParaView 5.13 writes Robo Sense
    assert makers == LIDARS, found["lidars"]
    assert found["named"] == ["Ouster OS1-64", "Ouster OS1-64 (2)"], found["named"]
    assert found["left"] == ["Ouster OS1-64"], found["left"]


def check_wizard(found):
    assert found["species"] == species(), found["species"]
    assert sorted(label for labels in LIDARS.values() for label in labels if not label.startswith("Avian")) == sorted(
        label for label in found["sensors"] if label[-1] and label.split()[0] in LIDARS), found["sensors"]
    assert found["cancelled"] == [], found["cancelled"]
    assert found["made"] == MADE, found["made"]
    assert found["times"] == [2.0 * k for k in range(10)] and found["birds"] > 0 and found["air"] == 23000.0, found
    assert found["undone"] == [], found["undone"]
    assert found["refused"] == [], found["refused"]  # rain with Airport 16
    assert found["own"] == ["Birds", "Collision tree", "Scan", "Velodyne VLP-16", "box"], found["own"]


def check_beam(found):
    assert found["nothing"] == [], found["nothing"]
    beam = found["beam"]
    assert beam["id"] == beam["wanted"] and beam["again"] == [beam["other"], 1], beam
    assert abs(sum(beam["solid"]) - 1) < 1e-6 and abs(sum(beam["energy"]) - 1) < 1e-6, beam
    assert beam["shown"] == [True, True] and beam["cells"] > 0 and beam["rows"] == len(beam["solid"]) > 1, beam


def check_sequence(found):
    with open(os.path.join(os.path.dirname(found["file"]), "times.txt"), encoding="utf-8") as file:
        times = [float(line) for line in file]
    assert found["steps"] == times and len(times) == SCANS, (found["steps"], times)
    sizes = [os.path.getsize(os.path.join(os.path.dirname(found["file"]), "velodyne", f"{k:06d}.bin")) // 16 for k in range(SCANS)]
    assert found["points"] == sizes, (found["points"], sizes)
    assert found["colours"] == ["POINTS", "semantic_label"] and "bird" in found["annotations"], found
    assert found["boxes"] > 0, found


def main(paraview, _, option=None):
    empty(FOLDER)
    with open(os.path.join(FOLDER, "box.obj"), "w", encoding="utf-8") as file:
        file.write("v -10 60 0\nv 10 60 0\nv 10 60 10\nv -10 60 10\nf 1 2 3\nf 1 3 4\n")
    sequence = make_sequence()
    found = run_script(paraview, "choices_steps.py", FOLDER, SIZE, expected=SAID, AVIANLIDAR_SEQUENCE=sequence)
    assert found["hidden"] == [], found["hidden"]
    check_sensors(found)
    check_wizard(found)
    check_beam(found)
    check_sequence({**found["sequence"], "file": sequence})
    if option == "--documentation":
        for name, image in DOCUMENTATION.items():
            shutil.copyfile(os.path.join(FOLDER, name + ".png"), os.path.join(SOURCE_DIR, "Documentation", "images", image + ".png"))


if __name__ == "__main__":
    main(*sys.argv[1:])
