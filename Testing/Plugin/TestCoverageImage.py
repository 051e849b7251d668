# SPDX-License-Identifier: BSD-3-Clause
"""The coverage of the airport as the macro shows it: probability on a slice under the surface of 0.5, and the reasons.

New baselines: copy TestCoverageImage.png and TestCoverageImage-reasons.png from the folder for temporary files to
Testing/Data/Baseline and look at them. With --documentation a larger picture of both goes to Documentation/images."""

import os
import sys

from paraview import simple

from TestMacros import COVERAGE, load_macro
from TestPipelineImage import compare
from plugin_testing import OUTPUT_DIR, SOURCE_DIR, load_plugin

NAMES = ("TestCoverageImage.png", "TestCoverageImage-reasons.png")
SIZE = [500, 400]
DOCUMENTED = [1600, 700]


def cover(size):
    """The macro in a window of that size: its layout and views."""
    view = simple.CreateRenderView(ViewSize=size)
    layout = simple.CreateLayout("Coverage")
    simple.AssignViewToLayout(view, layout)
    macro = load_macro(COVERAGE)
    macro.cover(view)
    return layout, view, simple.FindView(macro.REASONS)


def main():
    load_plugin()
    if "--documentation" in sys.argv:
        layout, *_ = cover(DOCUMENTED)
        file = os.path.join(SOURCE_DIR, "Documentation", "images", "paraview-coverage.png")
        simple.SaveScreenshot(file, layout, ImageResolution=DOCUMENTED)
        return
    _, *views = cover([2 * SIZE[0], SIZE[1]])
    for name, view in zip(NAMES, views):
        view.ViewSize = SIZE
        view.OrientationAxesVisibility = 0
        simple.SaveScreenshot(os.path.join(OUTPUT_DIR, name), view, ImageResolution=SIZE)
    for name in NAMES:
        compare(name)


if __name__ == "__main__":
    main()
