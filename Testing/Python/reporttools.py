# SPDX-License-Identifier: BSD-3-Clause
"""Reports that are made in seconds, of the airport's plan, and their tables."""
import base64
import contextlib
import json
import pathlib
import sys
import unittest.mock

import exampletools
from avianlidar._command import main
from avianlidar import reach
from avianlidar.apps.coverage import _crossing, _report
from avianlidar.apps.pages import _drawing
import helpertools
from matplotlib.figure import Figure
from matplotlib.text import Text

PIXEL = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9Q"
                         "DwADhgGAWjR9awAAAABJRU5ErkJggg==")


@contextlib.contextmanager
def quick(pictures=False):
    """Reports have one visibility, one rain, few ranges, two lidars on sale and few crossing birds, and a pixel for
    each picture unless `pictures` is set."""
    with contextlib.ExitStack() as changed:
        changed.enter_context(unittest.mock.patch.multiple(_report, VISIBILITIES=(_report.ANSWERED,), RAINS=(0.0,)))
        changed.enter_context(unittest.mock.patch.object(reach, "RANGES", 12))
        changed.enter_context(unittest.mock.patch.object(_report, "on_sale", lambda: ON_SALE))
        changed.enter_context(unittest.mock.patch.multiple(_crossing, BIRDS=200, PROBED=2000))
        if not pictures:
            pixel = unittest.mock.patch.object(_drawing, "draw", lambda file, *_: pathlib.Path(file).write_bytes(PIXEL))
            changed.enter_context(pixel)
        yield


ON_SALE = ("VLP16", "HDL32E")
PLAN = pathlib.Path(exampletools.EXAMPLES) / "coverage" / "hongqiao.coverage.json"
HERE = pathlib.Path(exampletools.OUTPUT) / pathlib.Path(sys.argv[-1]).stem  # of the test
TARGET = {"species": "", "effective_area": 0.03, "clutter": False, "all_species": False}  # m2: quicker than birds
STEP = 1.5  # degrees, few beams
SENSOR = {"preset": "Search905", "name": "Search905", "azimuth_step": STEP}


def airport(**changes):
    """The airport's plan, of one sensor. A change to None takes away."""
    wanted = json.loads(PLAN.read_text("utf-8"))
    for name in ("scene", "runways"):
        wanted[name] = str((PLAN.parent / wanted[name]).resolve())
    wanted.update({"compare_with": None, **changes})
    return {name: value for name, value in wanted.items() if value is not None}


def plan(**changes):
    """The same, coarse."""
    return airport(**{"spacing": 100, "places": 200, "extent": [-600, 600, -600, 600], "sensor": SENSOR, **changes})


def written(name, wanted):
    HERE.mkdir(parents=True, exist_ok=True)
    file = HERE / f"{name}.coverage.json"
    file.write_text(json.dumps(wanted), "utf-8")
    return file


@contextlib.contextmanager
def letters():
    """Sizes, in points, of letters of the pictures that are drawn meanwhile."""
    sizes, save = set(), Figure.savefig

    def savefig(figure, *arguments, **options):
        sizes.update(one.get_fontsize() for one in figure.findobj(Text) if one.get_visible() and one.get_text())
        return save(figure, *arguments, **options)
    with unittest.mock.patch.object(Figure, "savefig", savefig):
        yield sizes


def report(name, wanted, *words, pictures=False):
    """The page that a plan gives."""
    with quick(pictures):
        assert main(["report", str(written(name, wanted)), "-o", str(HERE / f"{name}.html"), *words]) == 0
    return HERE / f"{name}.html"


def rows_of(file, **wanted):
    return [row for row in helpertools.rows_of(HERE / file)
            if all(row[name] == value for name, value in wanted.items())]
