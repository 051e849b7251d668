# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar report`: the page in Chromium without a network, its numbers, plans that ask for less."""
import csv
import json
import os
import pathlib
import shutil
import sys
import unittest

import numpy as np

import avianlidar as al
import exampletools
from avianlidar._command import main
from avianlidar._maps import read_plan
from avianlidar._report import Report
from browser import Browser

PLAN = pathlib.Path(exampletools.EXAMPLES) / "coverage" / "hongqiao.coverage.json"
HERE = pathlib.Path(exampletools.OUTPUT) / "TestReport"


def plan(**changes):
    """The airport's plan, coarse. A change to None takes away."""
    wanted = json.loads(PLAN.read_text(encoding="utf-8"))
    for name in ("scene", "runways"):
        wanted[name] = str((PLAN.parent / wanted[name]).resolve())
    wanted["siting"].update(spacing=800, draws=1)
    wanted.update({"spacing": 50, "places": 1000, **changes})
    return {name: value for name, value in wanted.items() if value is not None}


def report(name, wanted):
    """The page that a plan gives."""
    HERE.mkdir(parents=True, exist_ok=True)
    file = HERE / f"{name}.coverage.json"
    file.write_text(json.dumps(wanted), encoding="utf-8")
    assert main(["report", str(file), "-o", str(HERE / f"{name}.html")]) == 0
    return HERE / f"{name}.html"


def same_numbers(test, browser, file):
    """Numbers of the page are those of the table. @return both"""
    cells = browser.run("return [...document.querySelectorAll('td[data-column]')].map(c => [{...c.dataset}, c.textContent])")
    with open(file, encoding="utf-8") as stream:
        rows = {(row["receiver"], row["region"], row["species"], float(row["height_from [m]"])): row for row in csv.DictReader(stream)}
    for of, text in cells:
        row = rows[of["receiver"], of["region"], of["species"], float(of["from"])]
        test.assertAlmostEqual(float(text), float(row[of["column"]]), delta=0.00051, msg=of)
    return cells, rows


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(HERE, ignore_errors=True)
        cls.page = report("report", plan())
        alone = HERE / "alone"  # without the folder beside it
        alone.mkdir()
        shutil.copyfile(cls.page, alone / "report.html")
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.driver.quit)
        cls.asked = cls.browser.open(alone / "report.html")

    def test_loads_without_a_network(self):
        self.assertTrue(self.asked)
        self.assertEqual([url[:60] for url in self.asked if not url.startswith(("file:", "data:"))], [])
        self.assertEqual(sum(url.startswith("file:") for url in self.asked), 1)  # the page itself
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual(self.browser.run("return document.title"), plan()["description"])

    def test_pictures_are_there_with_words(self):
        pictures = self.browser.run("return [...document.images].map(i => [i.complete, i.naturalWidth, i.alt])")
        # Two receivers: four maps, four reasons, a section, clutter; candidates and gain.
        self.assertEqual(len(pictures), 2 * (4 + 4 + 1 + 1) + 2)
        for complete, width, words in pictures:
            self.assertTrue(complete and width > 300, words)
            self.assertRegex(words, r"\d")
            self.assertGreater(len(words), 40)
        self.assertEqual(len({words for _, _, words in pictures}), len(pictures))

    def test_numbers_are_those_of_the_table(self):
        cells, rows = same_numbers(self, self.browser, HERE / "report_files" / "shares.csv")
        self.assertGreater(len(cells), 100)
        self.assertEqual({of["receiver"] for of, _ in cells}, {"Search905", "Airport16"})
        self.assertGreater(max(float(text) for of, text in cells if of["column"] == "detection_probability"), 0.1)
        answers = self.browser.run("return [...document.querySelectorAll('.answer b')].map(b => b.textContent)")
        for text, name in zip(answers, ("Search905", "Airport16")):
            value = float(rows[name, "all", "herring gull", -np.inf]["detection_probability"])
            self.assertEqual(text, f"{100 * value:.1f} %")

    def test_sites_are_those_of_the_tables(self):
        with open(HERE / "report_files" / "sites.csv", encoding="utf-8") as file:
            table = np.genfromtxt(file, delimiter=",", names=True)
        value = next(name for name in table.dtype.names if name.startswith("value"))
        shown = self.browser.run("return [...document.querySelectorAll('#best tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        self.assertEqual(len(shown), 10)
        for row, known in zip(shown, table):
            np.testing.assert_allclose([float(text) for text in row[1:4]], [known[i] for i in range(3)], atol=1e-6)
            self.assertAlmostEqual(float(row[4]), known[value], delta=0.00051)
        with open(HERE / "report_files" / "gain.csv", encoding="utf-8") as file:
            gain = [float(row["value"]) for row in csv.DictReader(file)]
        shown = self.browser.run("return [...document.querySelectorAll('[data-sensors]')].map(c => +c.textContent)")
        np.testing.assert_allclose(shown, gain, atol=0.00051)
        self.assertEqual(sorted(gain), gain)

    def test_assumed_numbers_say_so(self):
        marked = self.browser.run("return [...document.querySelectorAll('#receivers tr')].filter(r => r.querySelector('.assumed')).length")
        self.assertEqual(marked, len(al.Sensor("Search905").beams.fields["assumed"]))
        text = self.browser.run("return document.body.innerText")
        for words in ("0.0248 m² assumed", "reflectance 0.3 assumed", "Heights are not surveyed", "Eye safety is not assessed",
                      "no claim about real birds", "OpenStreetMap", "visibility 23 km"):
            self.assertIn(words, text)
        self.assertNotIn(str(PLAN.parent), self.page.read_text(encoding="utf-8"))

    def test_is_read_on_a_phone_and_printed(self):
        with Browser(width=390, height=800) as phone:
            phone.open(self.page)
            self.assertEqual(phone.run("return innerWidth"), 390)
            self.assertLessEqual(phone.run("return document.documentElement.scrollWidth"), 390)
            widths = phone.run("return [...document.images].map(i => i.getBoundingClientRect().width)")
            self.assertGreater(min(widths), 300)
            self.assertGreaterEqual(phone.run("return parseFloat(getComputedStyle(document.querySelector('td')).fontSize)"), 12)
            # Labels of pictures have 9 points of 1/72 inch at 150 pixels an inch.
            scales = phone.run("return [...document.images].map(i => i.getBoundingClientRect().width / i.naturalWidth)")
            self.assertGreaterEqual(min(scales) * 9 * 150 / 72, 7.5)
        printed = self.browser.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": False, "paperWidth": 8.27, "paperHeight": 11.69})
        self.assertTrue(printed["data"].startswith("JVBERi0"))  # %PDF-
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        columns = self.browser.run("return getComputedStyle(document.querySelector('.maps')).gridTemplateColumns.split(' ').length")
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        self.assertEqual(columns, 4)


class Less(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        HERE.mkdir(parents=True, exist_ok=True)

    def test_a_plan_of_a_map_alone(self):
        page = report("map", plan(runways=None, siting=None, compare_with=None, heights=[20],
                                  description="<script>throw 1</script> & gulls?", coverage={"species": "crow", "clutter": False}))
        with Browser() as browser:
            browser.open(page)
            self.assertEqual(browser.complaints(), [])
            self.assertEqual(browser.run("return document.querySelector('h1').textContent"), "<script>throw 1</script> & gulls?")
            self.assertEqual(browser.run("return document.images.length"), 3)
            self.assertEqual(browser.run("return document.querySelector('#section, #sites')"), None)
            cells, rows = same_numbers(self, browser, HERE / "map_files" / "shares.csv")
            self.assertGreater(len(cells), 10)
            row = rows["Search905", "map", "crow", -np.inf]
            self.assertEqual(int(float(row["places"])), 1000)
            self.assertIn("on the map at 20 m", browser.run("return document.body.innerText"))
            # The mean of the map, within four standard errors.
            sensor = al.Sensor("Search905", position=(0, 0, 3))
            cover = al.Coverage(plan()["scene"], sensor, species="crow", clutter=False, bounds=(-1500, 1500, -1500, 1500, 20, 20), spacing=(10, 10, 1))
            self.assertAlmostEqual(float(row["detection_probability"]), cover["detection_probability"].mean(),
                                   delta=4 * float(row["detection_std_error"]))

    def test_is_the_same_again(self):
        wanted = plan(siting=None, compare_with=None, heights=[20])
        self.assertEqual(report("one", wanted).read_bytes(), report("one", wanted).read_bytes())

    def test_sensors_that_are_changed_say_so(self):
        page = report("changed", plan(siting=None, heights=[20], compare_with=[{"preset": "Search905", "name": "twice the pulse",
                                                                                "pulse_energy": 7.2e-4}]))
        with Browser() as browser:
            browser.open(page)
            row = browser.run("return [...document.querySelectorAll('#receivers tr')].map(r => [...r.cells].map(c => c.textContent.trim()))")
            self.assertEqual(row[0], ["receiver", "Search905", "twice the pulse"])
            self.assertIn(["energy of a pulse (mJ)", "0.36", "0.72 assumed"], row)
            share = browser.run("return [...document.querySelectorAll('.answer b')].map(b => parseFloat(b.textContent))")
            self.assertGreater(share[1], 1.2 * share[0])

    def test_other_heights_need_heights(self):
        scene = json.loads(pathlib.Path(plan()["scene"]).read_text(encoding="utf-8"))
        for item in scene["objects"]:
            if "footprints" in item:
                item["footprints"] = str((pathlib.Path(plan()["scene"]).parent / item["footprints"]).resolve())
            if item.pop("height_attribute", None):
                item["height"] = 20.0
        (HERE / "even.lidarscene.json").write_text(json.dumps(scene), encoding="utf-8")
        page = report("even", plan(scene=str(HERE / "even.lidarscene.json"), heights=[20], places=200, compare_with=None,
                                   siting={"spacing": 1000, "draws": 1, "sensors": 1}))
        text = page.read_text(encoding="utf-8")
        self.assertIn("varied: none is read", text)
        self.assertNotIn("building heights", text)

    def test_a_comment_may_be_anything(self):
        scene = json.loads(pathlib.Path(plan()["scene"]).read_text(encoding="utf-8"))
        scene["objects"] = [item for item in scene["objects"] if "footprints" not in item]
        for number, (comment, words) in enumerate(((5, "5"), ({"by": "<me>"}, "{&#34;by&#34;: &#34;&lt;me&gt;&#34;}"), (["a", 7.5], "7.5"))):
            (HERE / "comment.lidarscene.json").write_text(json.dumps({**scene, "comment": comment}), encoding="utf-8")
            page = report(f"comment{number}", plan(scene=str(HERE / "comment.lidarscene.json"), heights=[20], spacing=200, places=20, siting=None,
                                                   compare_with=None, coverage={"clutter": False}))
            self.assertIn(words, page.read_text(encoding="utf-8"))

    def test_what_is_wrong_is_named(self):
        (HERE / "no-header.csv").write_text("100,200\n300,400\n")
        for change, words in (({"runways": None}, "siting: needs runways"), ({"siting": {"draw": 1}}, "'draw' was unexpected"),
                              ({"compare_with": ["Airport17"]}, "Airport17"), ({"compare_with": ["Search905"]}, "'Search905' is there twice"),
                              ({"siting": {"points": "none.csv"}}, "none.csv"), ({"siting": {"points": "no-header.csv"}}, "columns x and y"),
                              ({"siting": {"exclusions": ["none.geojson"]}}, "none.geojson"), ({"siting": {"mix": {"dodo": 1.0}}}, "dodo")):
            file = HERE / "bad.coverage.json"
            file.write_text(json.dumps(plan(heights=[20], spacing=200, places=20, **change)), encoding="utf-8")
            with self.assertRaises((al.Error, ValueError)) as caught:
                Report(read_plan(file)).write(HERE / "bad.html")
            self.assertIn(words, str(caught.exception))
            self.assertFalse((HERE / "bad.html").exists())
        good = HERE / "good.coverage.json"
        good.write_text(json.dumps(plan()), encoding="utf-8")
        for changes, words in (({"siting": {"spaceing": 5}}, "'spaceing' was unexpected"), ({"siting": {"draws": "two"}}, "siting.draws"),
                               ({"siting": {"masts": (5, "high")}}, "siting.masts"), ({"coverage": {"bounds": (1, 2)}}, "coverage.bounds")):
            with self.assertRaises(al.Error) as caught:
                read_plan(good, **changes)
            self.assertIn(words, str(caught.exception))
        self.assertEqual(read_plan(good, siting={"masts": 7})["siting"]["masts"], [7])
        self.assertEqual(main(["report", str(good), "-o", os.path.join(HERE, "bad.pdf")]), 2)
        self.assertEqual(main(["report", str(HERE / "none.json"), "-o", os.path.join(HERE, "bad.html")]), 2)


if __name__ == "__main__":
    sys.exit(unittest.main())
