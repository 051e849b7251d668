# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar report`: more plans, each a report or two."""
import json
import pathlib
import re
import sys
import unittest

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
