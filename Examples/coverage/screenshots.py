#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The airport's report as pictures: its head, maps, reasons, section, weather and sites, as Chromium shows them.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/coverage/screenshots.py --out build/screenshots
"""
import argparse
import pathlib
import sys

from avianlidar._command import main as avianlidar

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
from browser import Browser  # noqa: E402

# Name of the picture: the heading that it begins with, and the one before which it ends.
PARTS = {"head": ("h1", "#full"), "range": ("#range", "#assumptions"), "maps": ("#maps", "#reasons"), "reasons": ("#reasons", "#section"),
         "section": ("#section", "#clutter"),
         "clutter": ("#clutter", "#shares"), "weather": ("#weather", "#sites"), "sites": ("#sites", "#limits")}


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan", nargs="?", default=str(HERE / "hongqiao.coverage.json"))
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    page = options.out / "report.html"
    code = avianlidar(["report", options.plan, "-o", str(page)])
    if code:
        return code
    with Browser(width=1100) as browser:
        browser.open(page)
        for name, (first, end) in PARTS.items():
            browser.picture_between(first, end, options.out / f"{name}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
