# SPDX-License-Identifier: BSD-3-Clause
"""Weather in sequences: labels of drops, birds that air hides, media of the scene, and folders that are of one
weather."""
import json
import unittest

import numpy as np

from avianlidar._command import main
import helpertools
from exampletools import emptied
from helpertools import error_of

HOUSE = {"version": 1, "lidar": {"position": [0, 0, 3]}, "objects": [
    {"name": "Ground", "class": "ground", "ground": {"size": 4000, "height": 0}, "material": "Wall"}]}
SCENARIO = {"scene": "field.lidarscene.json", "number_of_scans": 2, "scans_per_sequence": 2, "seed": 5,
            "sensor": {"preset": "Search905", "azimuth_step": 1.5},
            "birds": [{"pattern": "Circles", "species": "herring gull", "number_of_birds": 60, "radius": 500,
                       "heights": [5, 40]}]}


def rows_of(out):
    return helpertools.rows_of(out / "sequences" / "00" / "truth.csv")


def labels_of(out):
    return np.concatenate([np.fromfile(file, np.uint32)
                           for file in sorted((out / "sequences" / "00" / "labels").iterdir())])


class Sequences(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = emptied("TestWeatherSequences")
        (cls.home / "field.lidarscene.json").write_text(json.dumps(HOUSE), "utf-8")
        cls.file = cls.scenario("field")
        for name, words in (("clear", []), ("fog", ["fog:400"]), ("rain", ["rain:10"])):
            assert main(["sequence", str(cls.file), "-o", str(cls.home / name),
                         *(["--weather", *words] if words else [])]) == 0

    @classmethod
    def scenario(cls, name, **changes):
        file = cls.home / f"{name}.scenario.json"
        file.write_text(json.dumps({**SCENARIO, **changes}), "utf-8")
        return file

    def test_drops_are_outliers(self):
        clear, rain = labels_of(self.home / "clear"), labels_of(self.home / "rain")
        self.assertFalse(np.any(clear & 0xffff == 1))
        drops = rain & 0xffff == 1
        self.assertGreater(drops.sum(), 10000)
        self.assertTrue(np.all(rain[drops] >> 16 == 0))
        self.assertGreater((rain & 0xffff == 99).sum(), 10)
        self.assertIn(f"  1: {drops.mean():.9f}", (self.home / "rain" / "semantic-kitti.yaml").read_text())

    def test_birds_that_air_hides(self):
        clear, fog = rows_of(self.home / "clear"), rows_of(self.home / "fog")
        self.assertEqual({(row["visibility_m"], row["rain_mm_h"]) for row in fog}, {("400", "0")})
        self.assertEqual({(row["visibility_m"], row["rain_mm_h"], row["clear_probability"]) for row in clear},
                         {("", "0", "")})
        statuses = {}
        for there, here in zip(clear, fog):
            statuses.setdefault(here["status"], []).append(there["status"])
            if not here["clear_probability"]:
                continue
            p, without = float(here["expected_probability"]), float(here["clear_probability"])
            self.assertAlmostEqual(without, float(there["expected_probability"]), delta=1e-5)
            self.assertLessEqual(p, without + 1e-6)
            if here["status"] in ("air", "too weak"):
                self.assertEqual(here["status"] == "air", without >= 0.1)
                self.assertLess(p, 0.1)
            if there["status"] in ("hidden", "outside", "too weak"):
                self.assertIn(here["status"], (there["status"], "seen"))
        self.assertGreater(len(statuses["air"]), 10)
        self.assertLessEqual(set(statuses["air"]), {"seen", "missed"})
        self.assertIn(f"| air | {len(statuses['air'])} |", (self.home / "fog" / "datasheet.md").read_text())

    def test_media_of_the_scene_are_air_but_crowns_are_things(self):
        fog = {"name": "fog", "medium": {"kind": "fog", "visibility": 400, "shape": "everywhere"}}
        wood = {"name": "wood", "medium": {"kind": "foliage", "leaf_area_density": 2, "shape": "box",
                                           "center": [-60, 0, 0], "lengths": [8, 1200, 200]}}
        found = {name: rows_of(self.home / name) for name in ("clear", "fog")}
        for name, media in (("woody", [wood]), ("both", [fog, wood])):
            (self.home / f"{name}.lidarscene.json").write_text(
                json.dumps({**HOUSE, "objects": [*HOUSE["objects"], *media]}), "utf-8")
            self.assertEqual(main(["sequence", str(self.scenario(name, scene=f"{name}.lidarscene.json")), "-o",
                                   str(self.home / name)]), 0)
            found[name] = rows_of(self.home / name)
        behind = {"hidden": 0, "air": 0}
        for clear, fog, wood, both in zip(*(found[name] for name in ("clear", "fog", "woody", "both"))):
            self.assertEqual(wood["clear_probability"], "")
            self.assertEqual(both["clear_probability"],
                             wood["expected_probability"] if both["status"] != "absent" else "")
            if wood["status"] == "hidden" and clear["status"] != "hidden":
                behind["hidden"] += 1
                self.assertGreaterEqual(float(clear["expected_probability"]), 0.1)
                self.assertLess(float(wood["expected_probability"]), 0.1)
                self.assertLess(float(clear["x_m"]), 0)
                self.assertEqual(both["status"], "hidden")
            elif both["status"] == "air":
                behind["air"] += 1
                self.assertIn(wood["status"], ("seen", "missed"))
        self.assertGreater(min(behind.values()), 5, behind)

    def test_weather_belongs_to_what_a_folder_is_made_of(self):
        self.assertIn('scenario.weather ["fog:400"], now ["fog:500"]',
                      error_of("sequence", self.file, "-o", self.home / "fog", "--weather", "fog:500"))
        wrong = self.scenario("wrong", weather=["fog:500"], scan={"Visibility": 3000})
        self.assertIn("weather: is given beside visibility 3000",
                      error_of("sequence", wrong, "-o", self.home / "wrong"))
        deaf = self.scenario("deaf", weather=["rain:3"], sensor={"preset": "Airport16"})
        self.assertRegex(error_of("sequence", deaf, "-o", self.home / "deaf"),
                         'weather: the air sends light back, and the sensor has no receiver_aperture .*: choose for '
                         'example the preset "Search905"')
        over = self.scenario("over", weather=["rain:3"], scan={"visibility": 9000})
        self.assertEqual(main(["sequence", str(over), "-o", str(self.home / "over"), "--weather", "fog:400"]), 0)
        np.testing.assert_array_equal(labels_of(self.home / "over"), labels_of(self.home / "fog"))
