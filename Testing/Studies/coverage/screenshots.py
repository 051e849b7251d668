# SPDX-License-Identifier: BSD-3-Clause
"""The airport's report as pictures: its head, maps, reasons, section, weather and sites, as Chromium shows them.

    Testing/Studies/run.py screenshots --out build/screenshots
"""
from avianlidar._command import main as avianlidar
from browser import Browser
from running import AIRPORT, argument, study

# Name of the picture: the heading that it begins with, and the one before which it ends.
PARTS = {"head": ("h1", "#full"), "range": ("#range", "#assumptions"), "maps": ("#maps", "#reasons"), "reasons": ("#reasons", "#section"),
         "section": ("#section", "#clutter"),
         "clutter": ("#clutter", "#shares"), "weather": ("#weather", "#sites"), "sites": ("#sites", "#limits")}


@study(argument("plan", nargs="?", default=str(AIRPORT.parents[2] / "coverage" / "hongqiao.coverage.json")))
def main(options):
    page = options.out / "report.html"
    options.out.mkdir(parents=True, exist_ok=True)
    code = avianlidar(["report", options.plan, "-o", str(page)])
    if not code:
        with Browser(width=1100) as browser:
            browser.open(page)
            for name, (first, end) in PARTS.items():
                browser.picture_between(first, end, options.out / f"{name}.png")
    return code
