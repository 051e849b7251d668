# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar report`: more plans, each a report or two."""
import csv
import html
import json
import pathlib
import re
import shlex
import sys
import unittest

import numpy as np

import avianlidar as al
from avianlidar import siting
from avianlidar._command import main, parser
from reporttools import quick
from TestReport import HERE, Browser, plan, report


class Plans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        HERE.mkdir(parents=True, exist_ok=True)

    def test_heights_where_nothing_is_seen_say_why(self):
        text = report("high", plan(compare_with=None, heights=[100, 150], places=200, coverage={"visibility": 10e3, "clutter": False, "species": "crow"},
                                   siting={"spacing": 1500, "draws": 0, "sensors": 1})).read_text(encoding="utf-8")
        for words in ("candidates, of a lattice of 1500 m, detects 0.05\u00a0% of crows in strips and approaches, 100 to 150 m high",
                      "half of them are in its band and near enough at none", "its beams go up to 5.6°", "number_of_channels"):
            self.assertTrue(words in text, words)
        heads = re.findall("<li><b>([^<]*)</b>", text)
        self.assertEqual(heads, ["Change the beams first.", "Replace what is assumed."])

    def test_heights_regions_and_species_reach_every_number(self):
        """Gulls and starlings at 50 to 150 m over both runways, within 150 m: every share and the best site, by places drawn here and
        coverage of each candidate."""
        asked = plan(compare_with=None, heights=[50, 100, 150], regions={"strips": 1}, places=600, mix={"starling": 1, "herring gull": 3},
                     coverage={"visibility": 10e3}, siting={"bounds": [-1200, 800, -1500, 1500], "spacing": 800, "masts": [5, 10], "draws": 0, "sensors": 2})
        text = report("asked", asked).read_text(encoding="utf-8")
        scene = al.load_scene(asked["scene"])
        runways = siting.read_runways(asked["runways"], scene.geodetic_origin)

        def drawn(seed):
            random, places = np.random.default_rng(seed), []
            for runway in runways:
                axis, length = runway.axis()
                along, aside = random.uniform(0.0, length, 300), random.uniform(-150.0, 150.0, 300)
                ground = runway.start + along[:, None] * axis + aside[:, None] * np.array([axis[1], -axis[0]])
                places.append(np.column_stack([ground, random.uniform(50.0, 150.0, 300)]))
            return np.concatenate(places)
        sensor = al.Sensor("Search905", position=(0, 0, 3))
        cover = al.Coverage(scene, sensor, places=drawn(0), visibility=10e3)

        def by_species(position, clutter):
            sensor.position = position
            cover.set(clutter=clutter)
            found = []
            for cover.species in ("herring gull", "starling"):
                found.append(cover["detection_probability"].astype(float))
            return np.array(found)

        def shares(position, clutter):
            return np.array([0.75, 0.25]) @ by_species(position, clutter)
        with open(HERE / "asked_files" / "shares.csv", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["receiver"] == "Search905" and row["species"].startswith("bird (")]
        self.assertEqual({row["region"] for row in rows }, {"strips"})
        self.assertEqual({row["height_from [m]"] for row in rows if float(row["places"])}, {"50", "100", "-inf"})
        self.assertAlmostEqual(float(rows[-1]["detection_probability"]), shares((0, 0, 3), True).mean(), delta=1e-6)
        with open(HERE / "asked_files" / "sites.csv", encoding="utf-8") as file:
            table = np.genfromtxt(file, delimiter=",", names=True)
        positions = np.column_stack([table[name] for name in table.dtype.names[:3]])
        values = np.array([shares(position, False).mean() for position in positions])
        np.testing.assert_allclose(table[next(name for name in table.dtype.names if name.startswith("value"))], values, atol=1e-6)
        self.assertGreater(len(values), 10)
        self.assertEqual(np.argmax(values), 0)
        cover.places = drawn(1 << 40)  # the page states sites at other places than those by which they are ranked, with clutter
        with open(HERE / "asked_files" / "gain.csv", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                missed = np.prod([1.0 - by_species([float(c) for c in place.split()], True) for place in row["sites"].split(";")], axis=0)
                self.assertAlmostEqual(float(row["value"]), np.array([0.75, 0.25]) @ (1.0 - missed).mean(axis=1), delta=1e-6)
        x, y, z = positions[0]
        for words in (f"{abs(x):g}\u00a0m {'east' if x > 0 else 'west'} and {abs(y):g}\u00a0m {'north' if y > 0 else 'south'}, {z:g}\u00a0m up",
                      "of a lattice of 800 m", "in strips, 50 to 150 m high", "herring gull 75 %, starling 25 %", "its beams go up to 5.6°",
                      "<td>strips</td><td class=\"left line\">50 to 100 m</td>"):
            self.assertTrue(words in text, words)
        self.assertFalse("strips and approaches, 50" in text)
        with open(HERE / "asked_files" / "ends.csv", encoding="utf-8") as file:
            shown = {row["region"]: float(row["detection_probability"]) for row in csv.DictReader(file) if row["receiver"].endswith("best site")}
        self.assertEqual(set(shown), {"strip 18L/36R", "strip 18R/36L"})
        with open(HERE / "asked_files" / "shares.csv", encoding="utf-8") as file:
            best = next(float(row["detection_probability"]) for row in csv.DictReader(file) if row["receiver"].endswith("best site")
                        and row["species"].startswith("bird (") and row["height_from [m]"] == "-inf")
        self.assertAlmostEqual(np.mean(list(shown.values())), best, delta=2e-4)  # as many places each
        masts = dict(re.findall(r"([0-9]+) m: ([0-9.]+) ± [0-9.]+.% at", text))
        for mast in (5, 10):
            best = positions[positions[:, 2] == mast][np.argmax(values[positions[:, 2] == mast])]
            self.assertAlmostEqual(0.01 * float(masts[str(mast)]), shares(best, True).mean(), delta=5.1e-4)
        self.assertTrue("At the heights asked for, half of them are in its band and near enough at 50 m from " in text)
        self.assertTrue("How sure the winner is was not looked at" in text)

    def test_one_end_and_every_option(self):
        """Regions by runway end; commands that say every option that the report was made with."""
        file = HERE / "one end.coverage.json"
        file.write_text(json.dumps(plan(compare_with=None, heights=[20], places=200, spacing=400, regions={"approaches": {"18L": 3, "36R": 1}}, spread="area", coverage={"clutter": False},
                                        siting={"spacing": 1200, "draws": 0, "sensors": 1})), encoding="utf-8")
        (HERE / "hours.txt").write_text("ZSSS 010000Z 00000KT 9999 15/10 Q1020\nZSSS 010100Z 00000KT 0500 FG 15/14 Q1020\n", encoding="utf-8")
        words = ["--weather", "fog:1500", "--metar", str(HERE / "hours.txt"), "--sensor-set", "range_gate=1200", "--sensor-set", "azimuth_range=0,360",
                 "--coverage-set", "species=crow", "--siting-set", "surfaces=off"]
        with quick():
            self.assertEqual(main(["report", str(file), "-o", str(HERE / "one end.html"), *words]), 0)
        text = html.unescape((HERE / "one end.html").read_text(encoding="utf-8"))
        self.assertRegex(text, "By runway end it is .*% in the approach to 18L and .*36R[.]")
        for part in ("over the approach to 18L and 36R (to 3", "as many on each square metre", "in approach 18L, approach 36R, at 20 m", "the plan switches obstacle limitation surfaces off",
                     "200 in approaches"):
            self.assertIn(part, text)
        commands = [shlex.split(found) for found in re.findall("<code>(avianlidar [^<]*)</code>", text)]
        self.assertEqual([command[:3] for command in commands], [["avianlidar", verb, "one end.coverage.json"] for verb in ("coverage", "report")])
        for command, own in zip(commands, (["--siting-set", "--metar"], [])):
            made = parser().parse_args(command[1:])
            asked = parser().parse_args(["report", str(file), "-o", "x.html", *words])
            self.assertEqual(made.weather, asked.weather)
            for name in ("sensor_set", "coverage_set", *(() if own else ("siting_set", "metar"))):
                first = getattr(asked, name)
                self.assertEqual(getattr(made, name)[:len(first)] if name != "metar" else made.metar, first)
        self.assertEqual(dict(parser().parse_args(commands[1][1:]).coverage_set)["reflectance"], 0.15)
        with open(HERE / "one end_files" / "ends.csv", encoding="utf-8") as stream:
            self.assertEqual([(row["region"], row["places"]) for row in csv.DictReader(stream)][:2], [("approach 18L", "150"), ("approach 36R", "50")])

    def test_is_the_same_again(self):
        wanted = plan(siting=None, compare_with=None, heights=[20], spacing=200, places=200)
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
                                   siting={"bounds": [1000, 2000, -1000, 1000], "spacing": 2000, "draws": 10, "sensors": 1}))
        text = page.read_text(encoding="utf-8")
        self.assertTrue("varied: none is read" in text)
        self.assertFalse("building heights" in text)

    def test_a_comment_may_be_anything(self):
        scene = json.loads(pathlib.Path(plan()["scene"]).read_text(encoding="utf-8"))
        scene["objects"] = [item for item in scene["objects"] if "footprints" not in item]
        for number, (comment, words) in enumerate(((5, "5"), ({"by": "<me>"}, "{&#34;by&#34;: &#34;&lt;me&gt;&#34;}"), (["a", 7.5], "7.5"))):
            (HERE / "comment.lidarscene.json").write_text(json.dumps({**scene, "comment": comment}), encoding="utf-8")
            page = report(f"comment{number}", plan(scene=str(HERE / "comment.lidarscene.json"), heights=[20], spacing=200, places=20, siting=None,
                                                   compare_with=None, coverage={"clutter": False}))
            self.assertIn(words, page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    sys.exit(unittest.main())
