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
