# SPDX-License-Identifier: BSD-3-Clause
"""What a scan left out and why is readable in ParaView's Information panel: every note is a line of its own, whole. And
Tree Visits: the menu asks for its two inputs, the boxes come as wires coloured by visits.

Run by the system's Python: TestInformation.py paraview pvpython [--documentation]. With the option the picture of the
panel becomes Documentation/images/panel-information.png (with Debian's libqt5svg5, without which ParaView has no icons)."""

import json
import os
import shutil
import sys
import tempfile

from gui_testing import HERE, OUTPUT_DIR, SOURCE_DIR, problems, wait_for, window

PHOTOS = os.path.join(OUTPUT_DIR, "TestInformation")
NOTES = {
    "note_all_left_out": "at most 2e-09 J (0.1 % of the lower energy limit) of any range unit of a beam with an echo",
    "note_noise": "left out: at most",
    "note_two_reflections": "modelled, but for faint paths",
    "note_faint_paths": "left out: at most 2e-09 J (0.1 % of the lower energy limit) of any range unit",
    "note_small_objects": "rays of their own",
    "note_detail_between_rays": "may be missed, with more than 5 % probability, if it returns less than 9.",
    "note_planes": "integrated without rays",
    "note_perceivable_range": "nothing beyond 72.2 km",
}


def take_photograph(paraview):
    shutil.rmtree(PHOTOS, ignore_errors=True)
    os.makedirs(PHOTOS)
    results = os.path.join(PHOTOS, "results.json")
    log_name = os.path.join(OUTPUT_DIR, "TestInformation.log")
    environment = {"AVIANLIDAR_PHOTOS": PHOTOS, "PYTHONPATH": os.pathsep.join([HERE, os.environ["PYTHONPATH"]])}
    with tempfile.TemporaryDirectory() as folder, open(log_name, "w", encoding="utf-8") as log:
        arguments = ["--script", os.path.join(HERE, "information_photo.py")]
        with window(paraview, folder, log, arguments, (1400, 1000), **environment) as (process, _):
            wait_for(results, process, log_name)
    assert not problems(log_name), problems(log_name)
    with open(results, encoding="utf-8") as file:
        found = json.load(file)
    assert not found["error"], found["error"]
    return found


def main(paraview, _, option=None):
    found = take_photograph(paraview)
    assert sorted(found["notes"]) == sorted(NOTES), found["notes"]
    for name, text in NOTES.items():
        assert found["notes"][name].startswith(text), (name, found["notes"][name])
    assert found["dialog"]
    assert found["representation"] == "Wireframe", found["representation"]
    assert found["coloured"] == ["CELLS", "visits"], found["coloured"]
    if option == "--documentation":
        target = os.path.join(SOURCE_DIR, "Documentation", "images", "panel-information.png")
        shutil.copyfile(os.path.join(PHOTOS, "information.png"), target)


if __name__ == "__main__":
    main(*sys.argv[1:])
