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


def report(name, wanted, *words, pictures=False):
    """The page that a plan gives."""
    with quick(pictures):
        assert main(["report", str(written(name, wanted)), "-o", str(HERE / f"{name}.html"), *words]) == 0
    return HERE / f"{name}.html"


def rows_of(file, **wanted):
    return [row for row in helpertools.rows_of(HERE / file)
            if all(row[name] == value for name, value in wanted.items())]


def same_numbers(test, browser, file):
    """Numbers of the page are those of the table. @return both"""
    cells = browser.run("return [...document.querySelectorAll('td[data-column]')].map(c => [{...c.dataset}, "
                        "c.textContent])")
    rows = {(row["receiver"], row["region"], row["species"], float(row["height_from [m]"])): row
            for row in rows_of(file)}
    for of, text in cells:
        row = rows[of["receiver"], of["region"], of["species"], float(of["from"])]
        value, column = float(row[of["column"]]), of["column"]
        if text == "–":  # an error of a share that is not told from 0 or 1
            test.assertTrue(column.endswith("_std_error")
                            and (value < 1e-6 or float(row[column.replace("_std_error", "_probability")]) < 5e-4), of)
        elif text[0] in "<>":
            test.assertTrue(value <= float(text[2:]) <= 0.5 if text[0] == "<" else value >= float(text[2:]) >= 0.5,
                            (of, text, value))
        else:
            digits = len(text.partition(".")[2])
            test.assertAlmostEqual(float(text), value, delta=0.501 * 10.0 ** -digits, msg=of)
            if column == "detection_probability" and float(row["detection_std_error"]) > 0.0:  # one digit of the error
                test.assertTrue(0.1 * float(row["detection_std_error"]) <= 10.0 ** -digits <= 1.001
                                * float(row["detection_std_error"]) or digits == 0, (of, text))
    return cells, rows
