# SPDX-License-Identifier: BSD-3-Clause
"""Reports of plans that ask for less than TestReport's, sites by mix and strikes, reach of receivers, and plans that
are wrong."""
import html
import itertools
import math
import os
import pathlib
import re
import shlex
import types
import unittest

import numpy as np

import avianlidar as al
import exampletools  # noqa: F401  (finds the examples)
import flown
from avianlidar import Coverage, reach, siting
from avianlidar._command import main, parser
from avianlidar.apps.coverage import _answer, _report
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.coverage._report import Report
from avianlidar.apps.coverage._sites import Sites
from avianlidar.apps.inputs._json import packaged
from avianlidar.apps.inputs._on_sale import on_sale
from avianlidar.apps.inputs._read import read_plan
from avianlidar.apps.pages._words import plural
from browser import Browser
from reporttools import HERE, SENSOR, STEP, TARGET, plan, report, rows_of, written


SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
SPECIES = ("starling", "kestrel", "pigeon", "crow", "herring gull", "Canada goose")


class Less(unittest.TestCase):
    def test_a_plan_of_a_map_alone(self):
        """Two receivers, one of them changed, without sites and runways. The mean of the map is within four standard
        errors."""
        twice = {**SENSOR, "name": "twice the pulse", "pulse_energy": 7.2e-4}
        page = report("map", plan(runways=None, siting=None, compare_with=[twice], heights=[20], coverage=TARGET),
                      pictures=True)
        with Browser() as browser:
            browser.open(page)
            # The answer, maps of both, reasons, ranges, weather.
            self.assertEqual(browser.run("return document.images.length"), 6)
            self.assertIsNone(browser.run("return document.querySelector('#sites')"))
            browser.check_printed(self)
            known = browser.run("return [...document.querySelectorAll('#receivers tr')].map(r => [...r.cells].map(c => "
                                "c.textContent.trim()))")
        self.assertEqual(known[0], ["number of the lidar", "Search905", "twice the pulse"])
        self.assertIn(["energy of a pulse, mJ", "0.36", "0.72, assumed"], known)
        shares = []
        for name, changes in (("Search905", {}), ("twice the pulse", {"pulse_energy": 7.2e-4})):
            row, = rows_of("map_files/shares.csv", receiver=name, **{"height_from [m]": "-inf", "height_to [m]": "inf"})
            cover = al.Coverage(plan()["scene"],
                                al.Sensor("Search905", azimuth_step=STEP, position=(0, 0, 3), **changes), **TARGET,
                                visibility=23e3, bounds=(-600, 600, -600, 600, 20, 20), spacing=(40, 40, 1))
            shares.append(cover["detection_probability"].mean())
            self.assertAlmostEqual(float(row["detection_probability"]), shares[-1],
                                   delta=4 * float(row["detection_std_error"]), msg=name)
        self.assertGreater(shares[1], 1.1 * shares[0])

    def test_one_end_and_every_option(self):
        """Regions by runway end; commands that say every option that the report was made with."""
        wanted = plan(heights=[20], places=100, spacing=400, regions={"approaches": {"18L": 3, "36R": 1}},
                      spread="area", coverage=TARGET,
                      siting={"bounds": [-1200, 0, -1500, -300], "spacing": 1200, "draws": 0, "sensors": 1})
        HERE.mkdir(parents=True, exist_ok=True)
        (HERE / "hours.txt").write_text(
            "ZSSS 010000Z 00000KT 9999 15/10 Q1020\nZSSS 010100Z 00000KT 0500 FG 15/14 Q1020\n", "utf-8")
        words = ["--weather", "fog:1500", "--metar", str(HERE / "hours.txt"), "--sensor-set", "range_gate=1200",
                 "--sensor-set", "azimuth_range=0,360", "--coverage-set", "effective_area=0.04", "--siting-set",
                 "surfaces=off"]
        text = html.unescape(report("one end", wanted, *words).read_text("utf-8"))
        commands = [shlex.split(found) for found in re.findall("<code>(avianlidar [^<]*)</code>", text)]
        self.assertTrue({tuple(command[:3]) for command in commands} <= {
                            ("avianlidar", verb, "one end.coverage.json") for verb in ("coverage", "report")})
        made = parser().parse_args(commands[-1][1:])
        asked = parser().parse_args(["report", "x.json", "-o", "x.html", *words])
        self.assertEqual((made.weather, made.metar), (asked.weather, asked.metar))
        for name in ("sensor_set", "coverage_set", "siting_set"):
            self.assertEqual(getattr(made, name)[:len(getattr(asked, name))], getattr(asked, name))
        self.assertEqual(dict(made.coverage_set)["reflectance"], 0.15)
        self.assertEqual([(row["region"], row["places"]) for row in rows_of("one end_files/ends.csv")][:2],
                         [("approach 18L", "75"), ("approach 36R", "25")])

    def test_a_winner_at_the_edge_of_the_lattice(self):
        for bounds, there in (([800, 1600, -400, 400], True), ([-1600, 1600, -2400, 2400], False)):
            sites = Sites(self.small(siting={"bounds": bounds, "spacing": 400, "draws": 0, "sensors": 1})).look()
            self.assertEqual(sites.at_the_edge, there, sites.positions[sites.order[0]])

    def test_strikes_weight_sites_as_the_table(self):
        HERE.mkdir(parents=True, exist_ok=True)
        (HERE / "origin.csv").write_text("x,y\n800,0\n")
        whole = Report(read_plan(written("strikes", plan(
            sensor={**SENSOR, "position": [800, 0, 3]}, coverage={**TARGET, "strike_height_weights": True},
            siting={"points": str(HERE / "origin.csv"), "masts": [3], "draws": 0, "sensors": 1}))))
        self.assertAlmostEqual(whole.sites[0].look().values[0], whole.plans[0].overall["detection_probability"],
                               delta=1e-6)
        first = whole.plans[0]
        heights = {(row["region"], *_report._heights(first, row).values()) for row in first.shares}
        self.assertTrue({("strips", 0.5, 15.0), ("strips", 30.0, 60.0)} <= heights, heights)
        self.assertIn(("approaches", 150, 202), {(name, low, round(high)) for name, low, high in heights})

    def test_sites_are_ranked_by_the_mix(self):
        HERE.mkdir(parents=True, exist_ok=True)
        (HERE / "one.csv").write_text("x,y\n800,0\n")
        wanted = self.small(mix={"starling": 1, "herring gull": 3}, heights=[20, 40], places=16,
                            coverage={"clutter": False, "all_species": False},
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
        """The curve against birds of random heading, wing phase and place in the band that are flown through one
        scan."""
        distance, birds = 550.0, 150
        curve = reach.within_beams(al.Sensor("Search905"), "herring gull", np.array([distance]), visibility=23e3)
        self.assertLess(curve.error.max(), 0.02)
        random = np.random.default_rng(5)
        cover = Coverage(al.Scene(), al.Sensor("Search905"), visibility=23e3, places=[(0, 9, 9)])
        air = cover.data.GetFieldData().GetArray("attenuation_coefficient").GetValue(0)
        about, up = random.uniform(0, 2 * np.pi, birds), np.radians(random.uniform(0.0, 5.625, birds))
        lines = np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)])
        seen, _ = flown.fly(al.Scene(), al.Sensor("Search905"), distance * lines, 1, "herring gull", air, 2000,
                            int(distance))
        share = curve.one_scan[0]
        self.assertAlmostEqual(seen.mean(), share, delta=4 * math.sqrt(share * (1.0 - share) / birds))
        straight = reach.Reach(np.array([10.0, 20.0, 30.0]), np.array([1.0, 0.6, 0.2]), np.zeros(3),
                               np.array([1.0, 1.0, 0.0]))
        self.assertEqual([straight.to(share) for share in (1.0, 0.5, 0.1)], [10.0, 22.5, 30.0])
        self.assertEqual((straight.to(0.5, several=True), straight.to(1.1)), (25.0, 0.0))

    def test_ranges_of_the_package_are_those_of_the_table(self):
        """For all sensors and species; one of them is computed again."""
        ranges = packaged("inputs/ranges.json")["ranges"]
        table = rows_of(SOURCE / "Documentation" / "evidence" / "tables" / "coverage-ranges.csv")
        self.assertEqual({(row["receiver"], row["bird"]) for row in table},
                         {(name, bird) for name in al.Sensor.presets() for bird in SPECIES})
        for row in table:
            shown = [float(row[head].partition(" ")[0].replace("–", "0"))
                     for head in ("9 of 10, to", "half, to", "a tenth, to")]
            np.testing.assert_allclose(shown, ranges[row["receiver"]][row["bird"]], rtol=0.051, atol=0.06)  # two digits
        found = reach.within_beams(al.Sensor("Search905"), "crow", visibility=reach.CLEAR)
        np.testing.assert_allclose(ranges["Search905"]["crow"], [found.to(share) for share in reach.SHARES], atol=0.06)

    def test_ideas_are_marked(self):
        self.assertEqual({name for name in al.Sensor.presets() if name not in on_sale()},
                         {"Airport16", "Airport32", "Automotive16", "CorridorC16", "Search905", "Search1550"})
        for sensor, words in (({"preset": "OS2_128"}, ""), ({"preset": "OS2_128", "rotation_rate": 20}, ""),
                              ({"preset": "OS2_128", "pulse_energy": 1.0},
                               "OS2_128 changed is an idea: its pulse_energy differs from that of the lidar on sale."),
                              ({"preset": "OS2_128", "RangeGate": 90, "pulse_energy": 1.0, "Position": [0, 0, 3]},
                               "OS2_128 changed is an idea: its range_gate and pulse_energy differ from those of the "
                               "lidar on sale."),
                              ({"preset": "Search1550"}, "Search1550 is an idea: nobody sells this lidar."),
                              ({"preset": "Airport16"}, "Airport16 is an idea: nobody sells this lidar.")):
            self.assertEqual(self.small(sensor=sensor).idea, words)

    def test_the_answer_is_one_short_sentence(self):
        """With and without sites, without runways, for a mix, for long names, and if nothing is detected."""
        runways = [siting.Runway("Runway 18L/36R", (0.0, 0.0), (-150.0, 3000.0), 60.0)]
        found, nothing = {"detects": True, "count": 9}, {"detects": False, "count": 9}
        for name, (mix, bird), lines, site, idea, share in itertools.product(
                ("Search905", "a lidar of two words and nine more, which nobody has"),
                (([1], "herring gull"), ([0.5, 0.5], "bird (herring gull 50 %, crow 50 %)")), (runways, []),
                (None, found, nothing), ("", "Nobody sells it."), (0.0, 0.012)):
            row = {"detection_probability": share, "detection_std_error": 0.1 * share, "places": 12000}
            view = types.SimpleNamespace(name=name, mix=mix, bird=bird, runways=lines, idea=idea, overall=row,
                                         sensor=types.SimpleNamespace(position=(400.0, 700.0, 5.0)))
            said = _answer.sentence(view, site)
            self.assertLessEqual(len(said.split()), 25, said)
            self.assertRegex(said, "^[A-Za-z].* detect.*[a-z]\\.$")
            self.assertIn("0.05\xa0%" if share == 0.0 or site is nothing else "1.2\xa0%", said)

    def test_lidars_on_sale_are_ordered_by_shares_that_are_numbers(self):
        def offer(twice, once, half):
            return {"crossing": types.SimpleNamespace(share=twice), "row": {"detection_probability": once},
                    "half": half}
        best_first = [offer(0.02, 0.001, 5.0), offer(0.01, 0.009, 90.0), offer(1e-9, 1e-8, 60.0),
                      offer(1e-4, 1e-7, 50.0), offer(0.0, 0.0, math.nan)]
        self.assertEqual(sorted(best_first[::-1], key=_answer.merit, reverse=True), best_first)

    def test_a_lidar_on_sale_is_advised_as_one(self):
        """No table of other lidars; the maker is asked. Without a winner, the page says where its numbers hold."""
        page = report("sold", plan(
            sensor={"preset": "OS2_128", "azimuth_step": STEP}, coverage=TARGET, places=60,
            siting={"bounds": [-1200, 0, 500, 1500], "spacing": 1200, "draws": 0, "sensors": 1}))
        text = html.unescape(page.read_text("utf-8"))
        self.assertIn("Nowhere: at none of", text)
        self.assertIn("The other numbers of this page are for the sensor's place in the plan or its scene (at the "
                      "origin, 3\u00a0m up).", text)
        self.assertIn("Ask the maker of", text)
        for words in ("is an idea", 'id="offers"', "Do not plan to buy"):
            self.assertNotIn(words, text)

    def test_the_highest_mast_may_be_too_low(self):
        for masts, words in (([5, 10], "the highest mast of the plan (10 m)"),
                             ([10], "the only mast of the plan (10 m)"), ([5, 10, 400], None)):
            sites = Sites(self.small(heights=[20], siting={
                "bounds": [800, 1600, -400, 400], "spacing": 400, "draws": 0, "sensors": 1, "masts": masts})).look()
            away = {row["mast"]: np.abs(sites.positions - row["position"]).sum(axis=1) for row in sites.best_by_mast()}
            mast = max(away, key=lambda mast: sites.values[np.argmin(away[mast])])
            said = sites.higher_mast
            self.assertEqual(bool(said), mast == max(masts), (said, mast))
            if words and said:
                self.assertIn(words, said[0])

    def test_other_draws_in_words(self):
        def site(*rows):
            return {"robustness": [{"sensors": 1, "draws": 10, "change": change, "another winner": count,
                                    "gain at most": gain} for change, count, gain in rows]}
        said = _answer._other_draws
        self.assertEqual(said(site()), [])
        self.assertEqual(said(site(("other places", 0, 0.0))),
                         ["The choice is sharp: with other random places this site wins in all 10 draws."])
        self.assertEqual(said(site(("effective area ±20 %", 0, 0.0), ("other places", 3, 0.042))),
                         ["The choice is not sharp: with other random places another site wins in 3 of 10 draws. The "
                          "other site then detects at most 4\u00a0% more birds than this site."])

    def test_plurals(self):
        for one, several in (("herring gull", "herring gulls"), ("Canada goose", "Canada geese"), ("", "targets"),
                             ("goldfinch", "goldfinches"), ("albatross", "albatrosses"), ("canary", "canaries"),
                             ("jay", "jays"), ("osprey", "ospreys"), ("grouse", "grouse")):
            self.assertEqual(plural(one), several)

    def test_a_step_keeps_one_position(self):
        """The next steps replace a position that the options give by its name in C++."""
        read = read_plan(written("position", plan(heights=[20], siting=None, coverage=TARGET)),
                         sensor={"Position": (5, 6, 7), "RangeGate": 900})
        self.assertTrue(_answer.command(Plan(read), "coverage", "maps", **{"sensor.position": "1,2,3"}).endswith(
            "-o maps --sensor-set RangeGate=900 --sensor-set position=1,2,3"))

    def test_wrong_plans_are_named(self):
        for change, words in (({"compare_with": ["Airport17"]}, "Airport17"),
                              ({"sensor": {"preset": "Search905"}, "compare_with": ["Search905"]}, "twice")):
            with self.assertRaisesRegex((al.Error, ValueError), words):
                Report(read_plan(written("bad", plan(heights=[20], siting=None, coverage=TARGET,
                                                     **change)))).write(HERE / "bad.html")
            self.assertFalse((HERE / "bad.html").exists())
        good = written("good", plan())
        with self.assertRaisesRegex(al.Error, "siting.masts"):
            read_plan(good, siting={"masts": (5, "high")})
        self.assertEqual(read_plan(good, siting={"masts": 7})["siting"]["masts"], [7])
        self.assertEqual(main(["report", str(good), "-o", os.path.join(HERE, "bad.pdf")]), 2)

    def test_a_bird_below_the_sensor(self):
        sensor = al.Sensor(channel_elevations=[-2.0, 6.0], number_of_channels=2, position=(0, 0, 30))
        row, = reach.heights_in_band(types.SimpleNamespace(sensor=sensor), [10.0], 600.0)
        self.assertAlmostEqual(row["from"], 20 / math.tan(math.radians(2.0)), delta=1e-9)
