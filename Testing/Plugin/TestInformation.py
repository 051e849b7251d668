# SPDX-License-Identifier: BSD-3-Clause
"""What a scan left out and why is readable in ParaView's Information panel: every note is a line of its own, whole.

Run by the system's Python: TestInformation.py paraview pvpython [--documentation]. With the option the picture of the
panel becomes Documentation/images/panel-information.png (with Debian's libqt5svg5, without which ParaView has no icons)."""

import os
import shutil
import sys

from gui_testing import OUTPUT_DIR, SOURCE_DIR, empty, run_script

PHOTOS = os.path.join(OUTPUT_DIR, "TestInformation")
SIZE = (1400, 1000)
NOTES = {
    "note_all_left_out": "at most 2e-09 J (0.1 % of the lower energy limit) of any range unit of a beam with an echo, but for further reflections",
    "note_noise": "left out: at most",
    "note_two_reflections": "modelled, but for faint paths",
    "note_further_reflections": "not modelled: paths over three and more return at most",
    "note_faint_paths": "left out: at most 2e-09 J (0.1 % of the lower energy limit) of any range unit",
    "note_small_objects": "more rays where an object_id would have few",
    "note_detail_between_rays": "may be missed, with more than 5 % probability, if it returns less than 2.92e-07 J and has no object_id",
    "note_planes": "integrated without rays",
    "note_perceivable_range": "nothing beyond 72.2 km",
}


def main(paraview, _, option=None):
    empty(PHOTOS)
    found = run_script(paraview, "information_photo.py", PHOTOS, SIZE)
    assert sorted(found["notes"]) == sorted(NOTES), found["notes"]
    for name, text in NOTES.items():
        assert found["notes"][name].startswith(text), (name, found["notes"][name])
    if option == "--documentation":
        target = os.path.join(SOURCE_DIR, "Documentation", "images", "panel-information.png")
        shutil.copyfile(os.path.join(PHOTOS, "information.png"), target)


if __name__ == "__main__":
    main(*sys.argv[1:])
