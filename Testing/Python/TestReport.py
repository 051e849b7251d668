# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar report`: the page in Chromium without a network; its numbers against its tables, and these
against coverage of places drawn here. Plans that ask for less, or for what is wrong, are TestReportPlans'."""
import json
import pathlib
import re
import shutil
import unittest

import numpy as np

import avianlidar as al
import exampletools  # noqa: F401  (finds the examples)
from avianlidar import siting
from avianlidar.apps.coverage._answer import share_of
from avianlidar.apps.coverage._crossing import crossing
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.inputs._read import read_plan
from browser import Browser
from reporttools import HERE, ON_SALE, PLAN, STEP, TARGET, letters, plan, report, rows_of


class Page(unittest.TestCase):
    """Targets at 50 to 100 m over both runways, within 150 m."""

    @classmethod
    def setUpClass(cls):
        exampletools.emptied("TestReport")
        where = pathlib.Path(plan()["scene"])
        scene = {**json.loads(where.read_text("utf-8")), "comment": {"by": "<me>"}}
        for item in scene["objects"]:
            if "footprints" in item:
                item["footprints"] = str(where.parent / item["footprints"])
        (HERE / "page.lidarscene.json").write_text(json.dumps(scene), "utf-8")
        cls.asked = plan(
            scene="page.lidarscene.json", description="<script>throw 1</script> & gulls?", heights=[50, 100],
            regions={"strips": 1}, coverage={**TARGET, "clutter": True, "visibility": 10e3},
            siting={"bounds": [-1200, 800, 500, 1500], "spacing": 1000, "masts": [5, 10], "draws": 0, "sensors": 2})
        with letters() as cls.letters:
            page = report("report", cls.asked, pictures=True)
        cls.text = page.read_text("utf-8")
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
        # and the azimuth step, which is changed
        self.assertEqual(len(rows_of("report_files/assumptions.csv", assumed="1")),
                         len(al.Sensor("Search905").beams.fields["assumed"]) + 1)

    def test_is_printed_on_six_pages(self):
        self.browser.check_printed(self)
        self.assertGreaterEqual(min(self.letters), 8.0)

    def test_pictures_and_captions_say_what_was_asked(self):
        pictures = self.browser.run("return [...document.images].map(i => [i.complete, i.naturalWidth, i.alt])")
        # The answer, maps, reasons, sections, ranges, weather, candidates.
        for complete, width, words in pictures:
            self.assertTrue(complete and width > 300, words)
            self.assertRegex(words, r"\d")
        captions = self.browser.run("return [...document.querySelectorAll('figcaption')].map(c => c.textContent)")
        self.assertEqual((len({*captions}), len({words for _, _, words in pictures})), (7, 7))
        for words in captions:
            self.assertRegex(words, r"^[A-Z][^.]*(\.\d[^.]*)*\.$")  # one sentence
            self.assertNotIn("gulls?", words)  # the question

    def test_the_first_page_distinguishes_ideas_from_lidars_on_sale(self):
        """In the first paragraph and in a table, whose numbers are those of coverage at the best site."""
        self.assertRegex(self.browser.run("return document.querySelector('#answer').innerText"),
                         "^Search905 would stand best .* of Runway 18[LR]/36[LR].*: one scan detects .* of targets.$")
        first = self.browser.run("return document.querySelector('#assumed p').textContent")
        self.assertRegex(first,
                         "^Search905 is an idea: nobody sells this lidar. At the same place, each of 2 lidars on "
                         "sale detects under [0-9.]+.% of the same birds by one scan, and under [0-9.]+.% at least "
                         "twice while they cross\\. ")
        shown = self.browser.run(
            "return [...document.querySelectorAll('#offers tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        self.assertEqual([row[1] for row in shown], ["nobody", *2 * ["Ouster (formerly Velodyne)"]])
        self.assertEqual([row[2] for row in shown], ["2\u00a0s", "0.1\u00a0s", "0.1\u00a0s"])
        self.assertEqual({row[0] for row in shown[1:]}, set(ON_SALE))
        self.assertEqual(shown[0][-1], "–")
        for name, *_, interval in shown[1:]:
            low, high = al.Sensor(name).description["range_interval"]["value"]
            self.assertEqual(interval, f"{low:g} to {high:g}")
        asked = Plan(read_plan(HERE / "report.coverage.json"))
        for name, _, _, share, *_ in shown:
            there = asked.at(self.position(), "there", 1 << 40)
            if name != "Search905":
                there = there.with_lidar(name)
            row, = rows_of("report_files/on-sale.csv", receiver=name)
            self.assertAlmostEqual(float(row["detection_probability"]), there.overall["detection_probability"], delta=1e-6)
            self.assertEqual(share, share_of(there.overall))
        self.assertEqual(self.number(0), shown[0][3].partition(" ±")[0] + "\u00a0%")
        steps = self.browser.run("return document.querySelector('#next').textContent")
        self.assertIn("Do not plan to buy Search905.", steps)
        self.assertNotIn("Ask the maker", steps)

    def test_the_first_page_says_what_the_share_means(self):
        said = self.browser.run("return document.querySelector('#full').textContent")
        self.assertIn("one of 9 sites that are equally good within the error, of 9 candidates", said)
        self.assertIn("on a mast of 5 m, 200 m west and 500 m north, 5 m up from", said.replace("\xa0", " "))
        self.assertIn("One scan takes 2\u00a0s. The share is the mean over the whole length", said)
        twice = crossing(Plan(read_plan(HERE / "report.coverage.json")).at(self.position(), "there", 1 << 40))
        self.assertIn("at right angles at 15\xa0m/s", said)
        self.assertRegex(self.text, "in 20 s or (9.[0-9]|10) scans on average")
        share = 0.01 * float(re.match("[0-9.]+", self.number(2).removeprefix("under "))[0])
        self.assertAlmostEqual(share, twice.share, delta=4.0 * twice.error + 0.006)
        for words in ("take-off climb surfaces", "inner horizontal surfaces", "conical surfaces", "ILS"):
            self.assertIn(words, self.text)

    def number(self, which):
        return self.browser.run("return document.querySelectorAll('#numbers .value')[arguments[0]].textContent", which)

    def position(self):
        """The best site."""
        return [float(rows_of("report_files/best.csv")[0][f"{axis} [m]"]) for axis in "xyz"]

    def test_is_read_on_a_phone(self):
        shown = {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": True}
        self.browser.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", shown)
        self.addCleanup(self.browser.driver.execute_cdp_cmd, "Emulation.setDeviceMetricsOverride",
                        {**shown, "width": 1150, "mobile": False})
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 390)
        scales = self.browser.run("return [...document.images].map(i => i.width / i.naturalWidth)")
        self.assertGreaterEqual(min(scales) * 8 * 150 / 72, 7.5)  # 8 points of 1/72 inch at 150 pixels an inch

    def test_numbers_are_those_of_the_tables(self):
        table = np.genfromtxt(HERE / "report_files" / "sites.csv", delimiter=",", names=True, encoding="utf-8")
        shown = self.browser.run(
            "return [...document.querySelectorAll('#best tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
        for row, known in zip(shown, table):
            np.testing.assert_allclose([float(text) for text in row[1:4]], [known[i] for i in range(3)], atol=0.051)
        gain = [float(row["value"]) for row in rows_of("report_files/gain.csv")]
        texts = self.browser.run("return [...document.querySelectorAll('#gain td:nth-child(2)')].map(c => c.innerText)")
        np.testing.assert_allclose([0.01 * float(text.partition(" ")[0]) for text in texts], gain, atol=0.0051)
        # The best site has one number: of one scan from there, wherever the page has it.
        best = next(row for row in rows_of("report_files/shares.csv", receiver="Search905 at its best site")
                    if row["height_from [m]"] == "-inf")
        self.assertAlmostEqual(gain[0], float(best["detection_probability"]), delta=1e-6)
        self.assertEqual([text.partition(" ±")[0] + "\xa0%" for text in (shown[0][4], texts[0])], 2 * [self.number(0)])
        ends = {row["region"]: float(row["detection_probability"])
                for row in rows_of("report_files/ends.csv", receiver="Search905 at its best site")}
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
        np.testing.assert_allclose(table[next(name for name in table.dtype.names if name.startswith("value"))], values,
                                   atol=1e-6)
        self.assertGreater(len(values), 5)
        self.assertEqual(np.argmax(values), 0)
        # the page states sites at other places than those by which they are ranked, with clutter
        cover.places = drawn(1 << 40)
        for row in rows_of("report_files/gain.csv"):
            missed = np.prod([1.0 - shares([float(c) for c in place.split()], True)
                              for place in row["sites"].split(";")], axis=0)
            self.assertAlmostEqual(float(row["value"]), (1.0 - missed).mean(), delta=1e-6)
        x, y, z = positions[0]
        for words in (f"{abs(x):g}\u00a0m {'east' if x > 0 else 'west'} and {abs(y):g}\u00a0m "
                      f"{'north' if y > 0 else 'south'}", "of a lattice of 1000 m",
                      "How sure the winner is was not computed"):
            self.assertIn(words, self.text)
        for row in rows_of("report_files/masts.csv"):
            chosen = positions[:, 2] == float(row["mast [m]"])
            best = positions[chosen][np.argmax(values[chosen])]
            self.assertAlmostEqual(float(row["detects"]), shares(best, True).mean(), delta=1e-5)
