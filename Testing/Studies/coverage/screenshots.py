# SPDX-License-Identifier: BSD-3-Clause
"""The head of the airport's report, as Chromium shows it.

    Testing/Studies/run.py screenshots --out build/screenshots
"""
from avianlidar._command import main as avianlidar
from browser import Browser
from running import AIRPORT, argument, study

@study(argument("plan", nargs="?", default=str(AIRPORT.parents[2] / "coverage" / "hongqiao.coverage.json")))
def main(options):
    page = options.out / "report.html"
    options.out.mkdir(parents=True, exist_ok=True)
    code = avianlidar(["report", options.plan, "-o", str(page)])
    if not code:
        with Browser(width=1100) as browser:
            browser.open(page)
            browser.picture_between("h1", "#full", options.out / "head.png")
    return code
