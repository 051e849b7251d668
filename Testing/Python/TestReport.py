# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar report`: the page in Chromium without a network, its numbers, plans that ask for less."""
import csv
import json
import math
import os
import pathlib
import re
import shutil
import sys
import unittest

import numpy as np

import avianlidar as al
import exampletools
from avianlidar import Coverage, reach, siting
from avianlidar._command import main
from avianlidar.apps import _answer
from avianlidar.apps._maps import Plan, read_plan
from avianlidar.apps._report import Report
from avianlidar.apps._sites import Sites
from browser import Browser
from reporttools import curves, quick

sys.path.append(os.path.join(exampletools.EXAMPLES, "coverage"))
import flown  # noqa: E402

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
    with curves() if name == "report" else quick():
        assert main(["report", str(file), "-o", str(HERE / f"{name}.html")]) == 0
    return HERE / f"{name}.html"


def same_numbers(test, browser, file):
    """Numbers of the page are those of the table. @return both"""
    cells = browser.run("return [...document.querySelectorAll('td[data-column]')].map(c => [{...c.dataset}, c.textContent])")
    with open(file, encoding="utf-8") as stream:
        rows = {(row["receiver"], row["region"], row["species"], float(row["height_from [m]"])): row for row in csv.DictReader(stream)}
    for of, text in cells:
        row = rows[of["receiver"], of["region"], of["species"], float(of["from"])]
        value, column = float(row[of["column"]]), of["column"]
        if text == "–":  # an error of a share that is not told from 0 or 1
            test.assertTrue(column.endswith("_std_error") and (value < 1e-6 or float(row[column.replace("_std_error", "_probability")]) < 5e-4), of)
        elif text[0] in "<>":
            test.assertTrue(value <= float(text[2:]) <= 0.5 if text[0] == "<" else value >= float(text[2:]) >= 0.5, (of, text, value))
        else:
            digits = len(text.partition(".")[2])
            test.assertAlmostEqual(float(text), value, delta=0.501 * 10.0 ** -digits, msg=of)
            if column == "detection_probability" and float(row["detection_std_error"]) > 0.0:  # one digit of the error
                test.assertTrue(0.1 * float(row["detection_std_error"]) <= 10.0 ** -digits <= 1.001 * float(row["detection_std_error"]) or digits == 0, (of, text))
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
        # Two receivers where the plan puts them, and one at its best site, as the paper's sees nothing from any: four maps, four
        # reasons, two sections, clutter. Of each receiver candidates, gain and the curve of ranges. The answer, fog and rain.
        self.assertEqual(len(pictures), 3 * (4 + 4 + 2 + 1) + 2 * 3 + 1 + 2)
        for complete, width, words in pictures:
            self.assertTrue(complete and width > 300, words)
            self.assertRegex(words, r"\d")
            self.assertGreater(len(words), 40)
        self.assertEqual(len({words for _, _, words in pictures}), len(pictures))

    def test_captions_say_what_was_asked(self):
        captions = self.browser.run("return [...document.querySelectorAll('figcaption, caption')].map(c => c.textContent)")
        self.assertEqual(len(captions), self.browser.run("return document.querySelectorAll('table').length + document.images.length"))
        for words in captions:
            self.assertRegex(words, "(Search905|Airport16).*; asked for: herring gull in strips .to 60 m high. and approaches .to 202 m high.$")

    def test_the_first_page_answers(self):
        said = self.browser.run("return [...document.querySelectorAll('#answer .said')].map(p => p.textContent)")
        with open(HERE / "report_files" / "shares.csv", encoding="utf-8") as file:
            row = next(row for row in csv.DictReader(file) if row["receiver"].endswith("best site") and row["region"] == "all"
                       and row["species"] == "herring gull" and row["height_from [m]"] == "-inf")
        self.assertTrue(0.1 <= 100 * float(row["detection_std_error"]) < 1.0)  # which has one digit
        share = " ± ".join(f"{100 * float(row[name]):.1f}" for name in ("detection_probability", "detection_std_error")) + "\u00a0%"
        with open(HERE / "report_files" / "sites.csv", encoding="utf-8") as file:
            x, y = (float(value) for value in list(csv.reader(file))[1][:2])
        self.assertEqual(len(said), 3)
        for words in ("Search905 should stand", f"{abs(x):g}\u00a0m {'east' if x > 0 else 'west'} and {abs(y):g}\u00a0m {'north' if y > 0 else 'south'}", "of Runway 18",
                      f"one scan detects {share} of herring gulls over the strips of both runways", "60 and 202\u00a0m high at 23\u00a0km visibility"):
            self.assertIn(words, said[0])
        with open(HERE / "report_files" / "ends.csv", encoding="utf-8") as file:
            ends = {row["region"]: row for row in csv.DictReader(file) if row["receiver"].endswith("best site")}
        self.assertEqual(list(ends), ["strip 18L/36R", "strip 18R/36L", "approach 18L", "approach 36R", "approach 36L", "approach 18R"])
        self.assertAlmostEqual(sum(int(of["places"]) * float(of["detection_probability"]) for of in ends.values()) / 1000,
                               float(row["detection_probability"]), delta=1e-6)
        words = {f"{kind} {name}": share for share, kind, names in re.findall(
            "((?:under )?[0-9.]+(?: ± [0-9.]+)?)\u00a0% in the (strip|approach) (?:of|to) ((?:[0-9]{2}[LR](?:/[0-9]{2}[LR])?(?:, | and |[.]))+)", said[1])
            for name in re.split(", | and |[.]", names) if name}
        self.assertEqual(set(words), set(ends))
        for name, of in ends.items():
            told = words[name]
            wanted = 100 * float(of["detection_probability"])
            self.assertTrue(float(told[6:]) >= wanted if told.startswith("under ") else abs(float(told.partition(" ")[0]) - wanted) <= 0.5, (name, told, wanted))
        self.assertRegex(said[2], "^Within its beams, 0.0 to 5.6° up, one scan detects half of herring gulls to 580.m and a tenth to 7[012]0.m.$")
        heads = self.browser.run("return [...document.querySelectorAll('#next b')].map(b => b.textContent)")
        self.assertEqual(heads, ["Weigh a second lidar.", "Check the site.", "Replace what is assumed."])
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('#first a')].filter(a => !document.querySelector(a.hash)).length"), 0)

    def test_the_first_page_is_one(self):
        """Of a screen, and of A4 with margins of 0.4 inch."""
        def bottom(width, media):
            self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media})
            self.browser.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False})
            return self.browser.run("return document.querySelector('#first').getBoundingClientRect().bottom + scrollY")
        try:
            self.assertLess(bottom(1280, ""), 900)
            self.assertLess(bottom(717, "print"), 1046)
            self.assertEqual(self.browser.run("return getComputedStyle(document.querySelector('#first')).breakAfter"), "page")
        finally:
            bottom(1150, "")

    def test_numbers_are_those_of_the_table(self):
        cells, rows = same_numbers(self, self.browser, HERE / "report_files" / "shares.csv")
        self.assertGreater(len(cells), 100)
        self.assertEqual({of["receiver"] for of, _ in cells}, {"Search905", "Airport16", "Search905 at its best site"})
        self.assertGreater(max(float(text) for of, text in cells if of["column"] == "detection_probability" and text[0].isdigit()), 0.1)
        answers = self.browser.run("return [...document.querySelectorAll('.answer b')].map(b => b.textContent)")
        for text, name in zip(answers, ("Search905", "Airport16")):
            row = rows[name, "all", "herring gull", -np.inf]
            value, error = (100 * float(row[f"detection_{what}"]) for what in ("probability", "std_error"))
            self.assertEqual(text.replace("\u00a0", " "), "under 0.3 %" if value < 0.05 else f"{value:.1f} ± {error:.1f} %")  # 3 of 1000 places

    def test_sites_are_those_of_the_tables(self):
        with open(HERE / "report_files" / "sites.csv", encoding="utf-8") as file:
            table = np.genfromtxt(file, delimiter=",", names=True)
        shown = self.browser.run("return [...document.querySelectorAll('#best tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        self.assertEqual(len(shown), 10)
        for row, known in zip(shown, table):
            np.testing.assert_allclose([float(text) for text in row[1:4]], [known[i] for i in range(3)], atol=0.051)
        with open(HERE / "report_files" / "gain.csv", encoding="utf-8") as file:
            gain = [float(row["value"]) for row in csv.DictReader(file)]
        texts = self.browser.run("return [...document.querySelectorAll('[data-sensors]')].map(c => c.textContent)")
        np.testing.assert_allclose([0.01 * float(text.partition(" ")[0]) for text in texts], gain, atol=0.0051)
        self.assertEqual(sorted(gain), gain)
        # The best site has one number: of one scan from there, wherever the page has it.
        with open(HERE / "report_files" / "shares.csv", encoding="utf-8") as file:
            best = next(float(row["detection_probability"]) for row in csv.DictReader(file) if row["receiver"].endswith("best site") and row["region"] == "all"
                        and row["species"] == "herring gull" and row["height_from [m]"] == "-inf")
        self.assertAlmostEqual(gain[0], best, delta=1e-6)
        self.assertEqual([shown[0][4], texts[0]], 2 * [self.browser.run("return document.querySelector('#answer b').textContent")])
        one = texts[0].partition(" ")[0] + "\u00a0%"
        said = self.browser.run("return document.querySelector('#next').textContent")
        self.assertIn(f"Where one detects {one}", said)
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('#by-weather tbody tr')][0].cells[4].textContent"), one)

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
            self.assertEqual(browser.run("return document.images.length"), 3 + 1 + 1 + 2)  # map, reasons, clutter; the curve; the answer; fog and rain
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

    def test_where_a_place_lies_by_runways(self):
        north, east = siting.Runway("A", (0, 0), (0, 3000), 45), siting.Runway("B", (-1500, -400), (500, -400), 45)
        for position, words in (((-300, 1000, 5), "300\u00a0m west of A, 1000\u00a0m from its south end"), ((0, 3400, 5), "400\u00a0m north of the north end of A"),
                                ((0.2, 2900, 5), "on A, 100\u00a0m from its north end"), ((-300, 3300, 5), "420\u00a0m north-west of the north end of A")):
            self.assertEqual(_answer.beside(position, [north]), words)
        self.assertEqual(_answer.beside((100, -300, 5), [north, east]), "100\u00a0m north of B, 400\u00a0m from its east end, and 320\u00a0m south of the south end of A")
        self.assertEqual(_answer.beside((100, -300, 5), []), "")
        self.assertEqual(_answer.listed(["a"]), "a")
        self.assertEqual(_answer.listed(["a", "b", "c"]), "a, b and c")

    def test_a_winner_at_the_edge_of_the_lattice(self):
        for bounds, there in (([800, 2000, -600, 600], True), ([-1600, 1600, -2400, 2400], False)):
            wanted = Plan({**read_plan(self.small()), "places": 300, "siting": {"bounds": bounds, "spacing": 400, "draws": 0, "sensors": 1}})
            sites = Sites(wanted).look()
            self.assertEqual(sites.at_the_edge, there, sites.positions[sites.order[0]])

    def test_rows_hold_the_heights_that_they_say(self):
        page = report("rows", plan(siting=None, compare_with=None, places=400, coverage={"species": "crow", "clutter": False}))
        text = page.read_text(encoding="utf-8")
        for words, there in (("<td>strips</td><td class=\"left line\">0.5 to 15 m</td>", True), ("<td>strips</td><td class=\"left line\">30 to 60 m</td>", True),
                             ("<td>approaches</td><td class=\"left line\">150 to 202 m</td>", True), ("<td>strips</td><td class=\"left line\">60", False)):
            self.assertEqual(words in text, there, words)

    def test_strikes_weight_sites_as_the_table(self):
        asked = {**plan(compare_with=None, places=600, coverage={"species": "crow", "clutter": False, "strike_height_weights": True}),
                 "siting": {"points": str(HERE / "origin.csv"), "masts": [3], "draws": 0, "sensors": 1}}
        (HERE / "origin.csv").write_text("x,y\n800,0\n")
        file = HERE / "strikes.coverage.json"
        file.write_text(json.dumps({**asked, "sensor": {"preset": "Search905", "position": [800, 0, 3]}}), encoding="utf-8")
        whole = Report(read_plan(file))
        self.assertAlmostEqual(whole.sites[0].look().values[0], whole.plans[0].overall["detection_probability"], delta=1e-6)

    def test_how_high_the_band_must_go(self):
        """By the heights' tangents; what is tried is what a sensor so changed detects."""
        wanted = Plan({**read_plan(self.small()), "heights": [50, 100], "places": 400})
        low, high = reach.band(wanted.sensor)
        rows = reach.heights_in_band(wanted, [3.0, 50.0, 100.0, 700.0], 600.0)
        self.assertEqual([row["from"] for row in rows[:1]], [0.0])
        for row in rows[1:]:
            self.assertAlmostEqual(math.degrees(math.atan2(row["above"], row["from"])), high, delta=1e-9)
        self.assertAlmostEqual(rows[2]["to"], math.sqrt(600.0 ** 2 - 97.0 ** 2), delta=1e-9)
        self.assertEqual(rows[3]["to"], 0.0)
        found = reach.advice(wanted, 600.0)
        self.assertAlmostEqual(found["needed"], math.degrees(math.atan2(97.0, 0.5 * rows[2]["to"])), delta=1e-9)
        more = found["ways"][0]["changes"][0]
        self.assertGreaterEqual(low + (more["number_of_channels"] - 1) * 0.375, found["needed"])
        self.assertLess(low + (more["number_of_channels"] - 2) * 0.375, found["needed"])
        changed = wanted.at(wanted.sensor.position, "changed", **more)
        self.assertEqual(reach.band(changed.sensor)[0], low)
        self.assertGreater(changed.overall["detection_probability"], wanted.overall["detection_probability"])
        self.assertIsNone(reach.advice(Plan({**read_plan(self.small()), "places": 400}), 600.0))  # no heights are asked for
        self.assertIsNone(reach.advice(Plan({**read_plan(self.small()), "heights": [5, 15], "places": 400}), 600.0))
        far = reach.advice(Plan({**read_plan(self.small()), "heights": [900], "places": 400}), 600.0)
        self.assertEqual((far["needed"], far["ways"]), (None, []))
        tilted = Plan({**read_plan(self.small()), "sensor": {"preset": "Search905", "orientation": [0, 2, 0]}, "heights": [100], "places": 400})
        self.assertEqual(reach.advice(tilted, 600.0)["ways"], [])

    def small(self):
        file = HERE / "small.coverage.json"
        file.write_text(json.dumps(plan(siting=None, compare_with=None, coverage={"species": "herring gull", "clutter": False})), encoding="utf-8")
        return file

    def test_both_spellings_of_a_property(self):
        file = HERE / "spelt.coverage.json"
        file.write_text(json.dumps({**plan(siting=None, compare_with=None), "sensor": {"preset": "Search905", "Position": [50, 60, 7]},
                                    "coverage": {"Species": "crow", "Visibility": 5e3}}), encoding="utf-8")
        wanted = Plan(read_plan(file))
        self.assertEqual((wanted.sensor.position, wanted.mix, wanted.coverage.visibility), ((50, 60, 7), {"crow": 1.0}, 5e3))
        file.write_text(json.dumps({**plan(), "sensor": {"preset": "Search905", "Position": [0, 0, 3], "position": [0, 0, 4]}}), encoding="utf-8")
        with self.assertRaisesRegex((al.Error, TypeError, ValueError), "sensor: .*position is given twice"):
            read_plan(file)

    def test_how_far_a_gull_is_seen(self):
        """The curve against birds of random heading, wing phase and place in the band that are flown through one scan."""
        ranges, birds = np.array([300.0, 500.0, 600.0]), 400
        curve = reach.within_beams(al.Sensor("Search905"), "herring gull", ranges, visibility=23e3)
        self.assertLess(curve.error.max(), 0.02)
        random = np.random.default_rng(5)
        air = Coverage(al.Scene(), al.Sensor("Search905"), visibility=23e3, places=[(0, 9, 9)]).data.GetFieldData().GetArray("attenuation_coefficient").GetValue(0)
        for distance, share in zip(ranges, curve.one_scan):
            about, up = random.uniform(0, 2 * np.pi, birds), np.radians(random.uniform(0.0, 5.625, birds))
            lines = np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)])
            seen, _ = flown.fly(al.Scene(), al.Sensor("Search905"), distance * lines, 1, "herring gull", air, 2000, int(distance))
            error = math.sqrt(max(share * (1.0 - share), 0.01) / birds)
            print(f"{distance:g} m: {share:.3f}, flown {seen.mean():.3f} +- {error:.3f}")
            self.assertAlmostEqual(seen.mean(), share, delta=4 * error)
        straight = reach.Reach(np.array([10.0, 20.0, 30.0]), np.array([1.0, 0.6, 0.2]), np.zeros(3), np.array([1.0, 1.0, 0.0]))
        self.assertEqual([straight.to(share) for share in (1.0, 0.5, 0.1)], [10.0, 22.5, 30.0])
        self.assertEqual((straight.to(0.5, several=True), straight.to(1.1)), (25.0, 0.0))
        whole = reach.within_beams(al.Sensor("Search905"), "herring gull", visibility=23e3)
        self.assertAlmostEqual(np.interp(500.0, whole.ranges, whole.one_scan), curve.one_scan[1], delta=0.01)
        self.assertLess(whole.one_scan[-1], 0.01)

    def test_what_is_wrong_is_named(self):
        (HERE / "no-header.csv").write_text("100,200\n300,400\n")
        for change, words in (({"runways": None}, "siting: needs runways"), ({"siting": {"draw": 1}}, "'draw' was unexpected"),
                              ({"compare_with": ["Airport17"]}, "Airport17"), ({"compare_with": ["Search905"]}, "'Search905' is there twice"),
                              ({"siting": {"points": "none.csv"}}, "none.csv"), ({"siting": {"points": "no-header.csv"}}, "columns x and y"),
                              ({"siting": {"exclusions": ["none.geojson"]}}, "none.geojson"), ({"mix": {"dodo": 1.0}, "coverage": {}}, "dodo")):
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
