# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar report`: the page in Chromium without a network; its numbers against its tables, and these against coverage of
places drawn here; plans that ask for less, or for what is wrong."""
import csv
import html
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import sys
import unittest

import numpy as np

import avianlidar as al
import exampletools
from avianlidar import Coverage, reach, siting
from avianlidar._command import main, parser
from avianlidar.apps._maps import Plan, read_plan
from avianlidar.apps._report import Report
from avianlidar.apps._sites import Sites
from browser import Browser
from reporttools import quick

sys.path.append(os.path.join(exampletools.EXAMPLES, "coverage"))
import flown  # noqa: E402

PLAN = pathlib.Path(exampletools.EXAMPLES) / "coverage" / "hongqiao.coverage.json"
HERE = pathlib.Path(exampletools.OUTPUT) / "TestReport"
TARGET = {"species": "", "effective_area": 0.03, "clutter": False, "all_species": False}  # m2: quicker than birds
STEP = 1.5  # degrees, few beams
SENSOR = {"preset": "Search905", "name": "Search905", "azimuth_step": STEP}


def plan(**changes):
    """The airport's plan, coarse. A change to None takes away."""
    wanted = json.loads(PLAN.read_text(encoding="utf-8"))
    for name in ("scene", "runways"):
        wanted[name] = str((PLAN.parent / wanted[name]).resolve())
    wanted.update({"spacing": 100, "places": 200, "extent": [-600, 600, -600, 600], "compare_with": None, "sensor": SENSOR, **changes})
    return {name: value for name, value in wanted.items() if value is not None}


def written(name, wanted):
    HERE.mkdir(parents=True, exist_ok=True)
    file = HERE / f"{name}.coverage.json"
    file.write_text(json.dumps(wanted), encoding="utf-8")
    return file


def report(name, wanted, *words, pictures=False):
    """The page that a plan gives."""
    with quick(pictures):
        assert main(["report", str(written(name, wanted)), "-o", str(HERE / f"{name}.html"), *words]) == 0
    return HERE / f"{name}.html"


def rows_of(file, **wanted):
    with open(HERE / file, encoding="utf-8") as stream:
        return [row for row in csv.DictReader(stream) if all(row[name] == value for name, value in wanted.items())]


def same_numbers(test, browser, file):
    """Numbers of the page are those of the table. @return both"""
    cells = browser.run("return [...document.querySelectorAll('td[data-column]')].map(c => [{...c.dataset}, c.textContent])")
    rows = {(row["receiver"], row["region"], row["species"], float(row["height_from [m]"])): row for row in rows_of(file)}
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
    """Targets at 50 to 100 m over both runways, within 150 m."""

    @classmethod
    def setUpClass(cls):
        shutil.rmtree(HERE, ignore_errors=True)
        HERE.mkdir(parents=True)
        where = pathlib.Path(plan()["scene"])
        scene = {**json.loads(where.read_text(encoding="utf-8")), "comment": {"by": "<me>"}}
        for item in scene["objects"]:
            if "footprints" in item:
                item["footprints"] = str(where.parent / item["footprints"])
        (HERE / "page.lidarscene.json").write_text(json.dumps(scene), encoding="utf-8")
        cls.asked = plan(scene="page.lidarscene.json", description="<script>throw 1</script> & gulls?", heights=[50, 100], regions={"strips": 1},
                         coverage={**TARGET, "clutter": True, "visibility": 10e3},
                         siting={"bounds": [-1200, 800, -1500, 0], "spacing": 1000, "masts": [5, 10], "draws": 0, "sensors": 2})
        page = report("report", cls.asked, pictures=True)
        cls.text = page.read_text(encoding="utf-8")
        (HERE / "alone").mkdir()  # without the folder beside it
        shutil.copyfile(page, HERE / "alone" / "report.html")
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.driver.quit)
        cls.loaded = cls.browser.open(HERE / "alone" / "report.html")

    def test_loads_without_a_network(self):
        self.assertEqual([url[:60] for url in self.loaded if not url.startswith(("file:", "data:"))], [])
        self.assertEqual(sum(url.startswith("file:") for url in self.loaded), 1)  # the page itself
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual(self.browser.run("return document.querySelector('h1').textContent"), self.asked["description"])
        self.assertIn("{&#34;by&#34;: &#34;&lt;me&gt;&#34;}", self.text)
        self.assertNotIn(str(PLAN.parent), self.text)
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('#first a')].filter(a => !document.querySelector(a.hash)).length"), 0)
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        self.assertEqual(self.browser.run("return getComputedStyle(document.querySelector('#first')).breakAfter"), "page")
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        marked = self.browser.run("return [...document.querySelectorAll('#receivers tr')].filter(r => r.querySelector('.assumed')).length")
        self.assertEqual(marked, len(al.Sensor("Search905").beams.fields["assumed"]) + 1)  # and the azimuth step, which is changed

    def test_pictures_and_captions_say_what_was_asked(self):
        pictures = self.browser.run("return [...document.images].map(i => [i.complete, i.naturalWidth, i.alt])")
        # Here and at the best site: maps, reasons, sections, clutter. Candidates, gain, the curve of ranges, the answer, fog and rain.
        self.assertEqual(len(pictures), 2 * (2 + 2 + 2 + 1) + 2 + 1 + 1 + 2)
        for complete, width, words in pictures:
            self.assertTrue(complete and width > 300, words)
            self.assertRegex(words, r"\d")
        self.assertEqual(len({words for _, _, words in pictures}), len(pictures))
        captions = self.browser.run("return [...document.querySelectorAll('figcaption, caption')].map(c => c.textContent)")
        self.assertEqual(len(captions), self.browser.run("return document.querySelectorAll('table').length + document.images.length"))
        for words in captions:
            self.assertRegex(words, "Search905.*; asked for: .* in strips, 50 to 100 m high")

    def test_is_read_on_a_phone(self):
        shown = {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": True}
        self.browser.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", shown)
        self.addCleanup(self.browser.driver.execute_cdp_cmd, "Emulation.setDeviceMetricsOverride", {**shown, "width": 1150, "mobile": False})
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 390)
        # Labels of pictures have 9 points of 1/72 inch at 150 pixels an inch.
        scales = self.browser.run("return [...document.images].map(i => i.getBoundingClientRect().width / i.naturalWidth)")
        self.assertGreaterEqual(min(scales) * 9 * 150 / 72, 7.5)

    def test_numbers_are_those_of_the_tables(self):
        cells, _ = same_numbers(self, self.browser, "report_files/shares.csv")
        self.assertGreater(len(cells), 10)
        self.assertEqual({of["receiver"] for of, _ in cells}, {"Search905", "Search905 at its best site"})
        table = np.genfromtxt(HERE / "report_files" / "sites.csv", delimiter=",", names=True, encoding="utf-8")
        shown = self.browser.run("return [...document.querySelectorAll('#best tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        for row, known in zip(shown, table):
            np.testing.assert_allclose([float(text) for text in row[1:4]], [known[i] for i in range(3)], atol=0.051)
        gain = [float(row["value"]) for row in rows_of("report_files/gain.csv")]
        texts = self.browser.run("return [...document.querySelectorAll('[data-sensors]')].map(c => c.textContent)")
        np.testing.assert_allclose([0.01 * float(text.partition(" ")[0]) for text in texts], gain, atol=0.0051)
        # The best site has one number: of one scan from there, wherever the page has it.
        best = next(row for row in rows_of("report_files/shares.csv", receiver="Search905 at its best site") if row["height_from [m]"] == "-inf")
        self.assertAlmostEqual(gain[0], float(best["detection_probability"]), delta=1e-6)
        self.assertEqual([shown[0][4], texts[0]], 2 * [self.browser.run("return document.querySelector('#answer b').textContent")])
        ends = {row["region"]: float(row["detection_probability"]) for row in rows_of("report_files/ends.csv", receiver="Search905 at its best site")}
        self.assertEqual(set(ends), {"strip 18L/36R", "strip 18R/36L"})
        self.assertAlmostEqual(np.mean(list(ends.values())), gain[0], delta=2e-4)  # as many places each

    def test_tables_are_those_of_arrays(self):
        """Every share and the best site, by places drawn here and coverage of each candidate."""
        scene = al.load_scene(plan()["scene"])
        runways = siting.read_runways(self.asked["runways"], scene.geodetic_origin)

        def drawn(seed):
            random, places = np.random.default_rng(seed), []
            for runway in runways:
                axis, length = runway.axis()
                along, aside = random.uniform(0.0, length, 100), random.uniform(-150.0, 150.0, 100)
                ground = runway.start + along[:, None] * axis + aside[:, None] * np.array([axis[1], -axis[0]])
                places.append(np.column_stack([ground, random.uniform(50.0, 100.0, 100)]))
            return np.concatenate(places)
        sensor = al.Sensor("Search905", azimuth_step=STEP, position=(0, 0, 3))
        cover = al.Coverage(scene, sensor, places=drawn(0), visibility=10e3, species="", effective_area=0.03)

        def shares(position, clutter):
            sensor.position = position
            cover.set(clutter=clutter)
            return cover["detection_probability"].astype(float)
        rows = rows_of("report_files/shares.csv", receiver="Search905", species="")
        self.assertEqual({row["region"] for row in rows}, {"strips"})
        self.assertEqual({row["height_from [m]"] for row in rows if float(row["places"])}, {"50", "-inf"})
        self.assertAlmostEqual(float(rows[-1]["detection_probability"]), shares((0, 0, 3), True).mean(), delta=1e-6)
        table = np.genfromtxt(HERE / "report_files" / "sites.csv", delimiter=",", names=True, encoding="utf-8")
        positions = np.column_stack([table[name] for name in table.dtype.names[:3]])
        values = np.array([shares(position, False).mean() for position in positions])
        np.testing.assert_allclose(table[next(name for name in table.dtype.names if name.startswith("value"))], values, atol=1e-6)
        self.assertGreater(len(values), 5)
        self.assertEqual(np.argmax(values), 0)
        cover.places = drawn(1 << 40)  # the page states sites at other places than those by which they are ranked, with clutter
        for row in rows_of("report_files/gain.csv"):
            missed = np.prod([1.0 - shares([float(c) for c in place.split()], True) for place in row["sites"].split(";")], axis=0)
            self.assertAlmostEqual(float(row["value"]), (1.0 - missed).mean(), delta=1e-6)
        x, y, z = positions[0]
        for words in (f"{abs(x):g}\u00a0m {'east' if x > 0 else 'west'} and {abs(y):g}\u00a0m {'north' if y > 0 else 'south'}, {z:g}\u00a0m up",
                      "of a lattice of 1000 m", "<td>strips</td><td class=\"left line\">50 to 100 m</td>",
                      "How sure the winner is was not looked at"):
            self.assertIn(words, self.text)
        for mast, share in re.findall(r"([0-9]+) m: ([0-9.]+) ± [0-9.]+.% at", self.text):
            best = positions[positions[:, 2] == float(mast)][np.argmax(values[positions[:, 2] == float(mast)])]
            self.assertAlmostEqual(0.01 * float(share), shares(best, True).mean(), delta=5.1e-3)


class Less(unittest.TestCase):
    def test_a_plan_of_a_map_alone(self):
        """Of two receivers, one of which is changed, and without sites and runways; the mean of the map within four standard errors."""
        twice = {**SENSOR, "name": "twice the pulse", "pulse_energy": 7.2e-4}
        page = report("map", plan(runways=None, siting=None, compare_with=[twice], heights=[20], coverage=TARGET))
        with Browser() as browser:
            browser.open(page)
            self.assertEqual(browser.run("return document.images.length"), 2 * (3 + 1) + 1 + 2)  # map, reasons, clutter; the curve; the answer; fog and rain
            self.assertIsNone(browser.run("return document.querySelector('#section, #sites')"))
            _, rows = same_numbers(self, browser, "map_files/shares.csv")
            known = browser.run("return [...document.querySelectorAll('#receivers tr')].map(r => [...r.cells].map(c => c.textContent.trim()))")
        self.assertEqual(known[0], ["receiver", "Search905", "twice the pulse"])
        self.assertIn(["energy of a pulse (mJ)", "0.36", "0.72 assumed"], known)
        shares = []
        for name, changes in (("Search905", {}), ("twice the pulse", {"pulse_energy": 7.2e-4})):
            row = next(row for key, row in rows.items() if key[0] == name and key[3] == -np.inf)
            cover = al.Coverage(plan()["scene"], al.Sensor("Search905", azimuth_step=STEP, position=(0, 0, 3), **changes), **TARGET, visibility=23e3,
                                bounds=(-600, 600, -600, 600, 20, 20), spacing=(40, 40, 1))
            shares.append(cover["detection_probability"].mean())
            self.assertAlmostEqual(float(row["detection_probability"]), shares[-1], delta=4 * float(row["detection_std_error"]), msg=name)
        self.assertGreater(shares[1], 1.1 * shares[0])

    def test_one_end_and_every_option(self):
        """Regions by runway end; commands that say every option that the report was made with."""
        wanted = plan(heights=[20], places=100, spacing=400, regions={"approaches": {"18L": 3, "36R": 1}}, spread="area", coverage=TARGET,
                      siting={"bounds": [-1200, 0, -1500, -300], "spacing": 1200, "draws": 0, "sensors": 1})
        HERE.mkdir(parents=True, exist_ok=True)
        (HERE / "hours.txt").write_text("ZSSS 010000Z 00000KT 9999 15/10 Q1020\nZSSS 010100Z 00000KT 0500 FG 15/14 Q1020\n", encoding="utf-8")
        words = ["--weather", "fog:1500", "--metar", str(HERE / "hours.txt"), "--sensor-set", "range_gate=1200", "--sensor-set", "azimuth_range=0,360",
                 "--coverage-set", "effective_area=0.04", "--siting-set", "surfaces=off"]
        text = html.unescape(report("one end", wanted, *words).read_text(encoding="utf-8"))
        commands = [shlex.split(found) for found in re.findall("<code>(avianlidar [^<]*)</code>", text)]
        self.assertTrue({tuple(command[:3]) for command in commands} <= {("avianlidar", verb, "one end.coverage.json") for verb in ("coverage", "report")})
        made, asked = parser().parse_args(commands[-1][1:]), parser().parse_args(["report", "x.json", "-o", "x.html", *words])
        self.assertEqual((made.weather, made.metar), (asked.weather, asked.metar))
        for name in ("sensor_set", "coverage_set", "siting_set"):
            self.assertEqual(getattr(made, name)[:len(getattr(asked, name))], getattr(asked, name))
        self.assertEqual(dict(made.coverage_set)["reflectance"], 0.15)
        self.assertEqual([(row["region"], row["places"]) for row in rows_of("one end_files/ends.csv")][:2], [("approach 18L", "75"), ("approach 36R", "25")])

    def test_a_winner_at_the_edge_of_the_lattice(self):
        for bounds, there in (([800, 1600, -400, 400], True), ([-1600, 1600, -2400, 2400], False)):
            sites = Sites(self.small(siting={"bounds": bounds, "spacing": 400, "draws": 0, "sensors": 1})).look()
            self.assertEqual(sites.at_the_edge, there, sites.positions[sites.order[0]])

    def test_strikes_weight_sites_as_the_table(self):
        HERE.mkdir(parents=True, exist_ok=True)
        (HERE / "origin.csv").write_text("x,y\n800,0\n")
        whole = Report(read_plan(written("strikes", plan(sensor={**SENSOR, "position": [800, 0, 3]}, coverage={**TARGET, "strike_height_weights": True},
                                                         siting={"points": str(HERE / "origin.csv"), "masts": [3], "draws": 0, "sensors": 1}))))
        self.assertAlmostEqual(whole.sites[0].look().values[0], whole.plans[0].overall["detection_probability"], delta=1e-6)
        heights = {(row["region"], row["heights"]) for row in whole._tables(whole.plans)["heights"]}
        self.assertTrue({("strips", "0.5 to 15 m"), ("strips", "30 to 60 m"), ("approaches", "150 to 202 m")} <= heights, heights)

    def test_sites_are_ranked_by_the_mix(self):
        HERE.mkdir(parents=True, exist_ok=True)
        (HERE / "one.csv").write_text("x,y\n800,0\n")
        wanted = self.small(mix={"starling": 1, "herring gull": 3}, heights=[20, 40], places=16, coverage={"clutter": False, "all_species": False},
                            siting={"points": str(HERE / "one.csv"), "masts": [5], "draws": 0, "sensors": 1})
        sites = Sites(wanted)
        found, weights, _ = sites._look(sites.positions, sites.airs)  # the first of its looks
        sensor = al.Sensor("Search905", azimuth_step=STEP, position=(800, 0, 5))
        cover = al.Coverage(wanted.scene, sensor, places=wanted.points, visibility=23e3, clutter=False)
        p = []
        for cover.species in ("starling", "herring gull"):
            p.append(cover["detection_probability"].astype(float).mean())
        self.assertGreater(p[1], 1.1 * p[0])
        self.assertAlmostEqual(siting.values_of(found, weights)[0], 0.25 * p[0] + 0.75 * p[1], delta=1e-6)

    def small(self, **changes):
        return Plan(read_plan(written("small", plan(**{"siting": None, "coverage": TARGET, **changes}))))

    def test_how_high_the_band_must_go(self):
        """By the heights' tangents; what is tried is what a sensor so changed detects."""
        wanted = self.small(heights=[50, 100])
        low, high = reach.band(wanted.sensor)
        rows = reach.heights_in_band(wanted, [3.0, 50.0, 100.0, 700.0], 600.0)
        self.assertEqual(rows[0]["from"], 0.0)
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
        self.assertIsNone(reach.advice(self.small(), 600.0))  # no heights are asked for
        self.assertIsNone(reach.advice(self.small(heights=[5, 15]), 600.0))
        far = reach.advice(self.small(heights=[900]), 600.0)
        self.assertEqual((far["needed"], far["ways"]), (None, []))

    def test_how_far_a_gull_is_seen(self):
        """The curve against birds of random heading, wing phase and place in the band that are flown through one scan."""
        distance, birds = 550.0, 150
        curve = reach.within_beams(al.Sensor("Search905"), "herring gull", np.array([distance]), visibility=23e3)
        self.assertLess(curve.error.max(), 0.02)
        random = np.random.default_rng(5)
        air = Coverage(al.Scene(), al.Sensor("Search905"), visibility=23e3, places=[(0, 9, 9)]).data.GetFieldData().GetArray("attenuation_coefficient").GetValue(0)
        about, up = random.uniform(0, 2 * np.pi, birds), np.radians(random.uniform(0.0, 5.625, birds))
        lines = np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)])
        seen, _ = flown.fly(al.Scene(), al.Sensor("Search905"), distance * lines, 1, "herring gull", air, 2000, int(distance))
        share = curve.one_scan[0]
        self.assertAlmostEqual(seen.mean(), share, delta=4 * math.sqrt(share * (1.0 - share) / birds))
        straight = reach.Reach(np.array([10.0, 20.0, 30.0]), np.array([1.0, 0.6, 0.2]), np.zeros(3), np.array([1.0, 1.0, 0.0]))
        self.assertEqual([straight.to(share) for share in (1.0, 0.5, 0.1)], [10.0, 22.5, 30.0])
        self.assertEqual((straight.to(0.5, several=True), straight.to(1.1)), (25.0, 0.0))

    def test_what_is_wrong_is_named(self):
        for change, words in (({"compare_with": ["Airport17"]}, "Airport17"),
                              ({"sensor": {"preset": "Search905"}, "compare_with": ["Search905"]}, "twice")):
            with self.assertRaisesRegex((al.Error, ValueError), words):
                Report(read_plan(written("bad", plan(heights=[20], siting=None, coverage=TARGET, **change)))).write(HERE / "bad.html")
            self.assertFalse((HERE / "bad.html").exists())
        good = written("good", plan())
        with self.assertRaisesRegex(al.Error, "siting.masts"):
            read_plan(good, siting={"masts": (5, "high")})
        self.assertEqual(read_plan(good, siting={"masts": 7})["siting"]["masts"], [7])
        self.assertEqual(main(["report", str(good), "-o", os.path.join(HERE, "bad.pdf")]), 2)


if __name__ == "__main__":
    unittest.main()
