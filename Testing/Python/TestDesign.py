# SPDX-License-Identifier: BSD-3-Clause
"""Designs: closed forms of the link budget, the front against brute force, formulas that attack, bounds that are wrong,
work that goes on."""
import functools
import json
import math
import re
import shutil
import unittest
import unittest.mock

import numpy as np

import TestBirdTracks
from avianlidar import Error
from avianlidar.apps.coverage import _design_page
from avianlidar.apps.coverage._design import is_told, on_the_front, spread
from avianlidar.apps.coverage._design_page import Designs
from avianlidar.apps.coverage._formula import Formula
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.inputs._read import read_plan
from browser import Browser
from exampletools import emptied
from helpertools import rows_of, run

BOUNDS = {"pulse_energy": {"from": 1e-4, "to": 4e-3, "logarithmic": True}, "receiver_aperture": [0.005, 0.02]}
DESIGN = {"share": 0.12, "bounds": BOUNDS, "cost": "1000 * pulse_energy + 100 * receiver_aperture", "designs": 8}
TARGET = {"species": "", "effective_area": 0.03, "clutter": False}  # m2: quicker than birds
FAINT = {"coverage": {**TARGET, "effective_area": 0.001}, "places": 3000}  # which more energy sees from farther
GULL = {"species": "herring gull", "clutter": False}
NIGHT = {"preset": "Search905", "azimuth_step": 2.0, "background_radiance": 0.0}
fresh = functools.partial(emptied, "design")


def plan_of(where, **changes):
    """A plan file in a folder, whose scene is level ground and a house."""
    TestBirdTracks.scenario_file(where)
    plan = {"scene": "small.lidarscene.json", "sensor": NIGHT, "coverage": TARGET, "extent": [-400, 400, -400, 400],
            "heights": [10, 40], "places": 400, "design": DESIGN, **changes}
    file = where / "small.coverage.json"
    file.write_text(json.dumps(plan), "utf-8")
    return file


def study_of(where, design=(), **changes):
    return Designs(Plan(read_plan(plan_of(where, design={**DESIGN, **dict(design)}, **changes)), 1), where / "out")


def looked(study):
    """Its shares, without sensitivities: half of the time."""
    with unittest.mock.patch.object(Designs, "_sensitivities", return_value=[]):
        return study.look()


class Formulas(unittest.TestCase):
    def test_arithmetic(self):
        values = {"x": 3.0, "y": 0.5}
        for text, expected in (("1 + 2 * x ** 2 / 3", 7.0), ("-(x - y) ** 2", -6.25), ("2 ** 3 ** 2", 512.0),
                               ("sqrt(x * 3) + min(x, y, 1)", 3.5), ("ceil(y) + floor(y) + max(1, 2)", 3.0),
                               ("log(exp(2)) + log10(100) + abs(-1)", 5.0)):
            self.assertAlmostEqual(Formula(text, values)(values), expected, msg=text)

    def test_attacks(self):
        """All are a ValueError at once that names the formula: none runs, none fills the memory."""
        texts = ("__import__('os').system('touch broken')", "x.__class__", "9 ** 9 ** 9 ** 9", "10 ** 400 * 0",
                 "1 / (x - 3)", "(-8) ** (1 / 3)", "'a' * 9", "lambda: 1", "min()", "exp(1e9)",
                 "(" * 300 + "1" + ")" * 300, "9" * 5000, "open('f')", "True", "1j", "max(*[1, 2])", "log(0)", "",
                 "sqrt(x, 1)", "f'{x}'", "(z := 1)", "x < 2", "min(x, key=abs)", "\x00", "z", "x; x", "#",
                 "-" * 995 + "x")
        for text in texts:
            with self.subTest(text[:40]), self.assertRaisesRegex(ValueError, re.escape(text.strip()[:20])):
                Formula(text, ["x"])({"x": 3.0})

class Parts(unittest.TestCase):
    def test_front_is_brute_force(self):
        random = np.random.default_rng(1)
        for levels in (1000, 6):  # many ties
            costs, shares = random.integers(0, levels, (2, 300)).astype(float)
            costs[:3], shares[3:5] = math.nan, math.nan
            brute = [math.isfinite(costs[i] + shares[i])
                     and not any(costs[k] <= costs[i] and shares[k] >= shares[i]
                                 and (costs[k] < costs[i] or shares[k] > shares[i]) for k in range(300))
                     for i in range(300)]
            self.assertEqual(on_the_front(costs, shares).tolist(), brute)
        self.assertEqual(on_the_front([], []).tolist(), [])

    def test_points_fill_the_cube(self):
        for number in (1, 2, 5):
            points = spread(number, 200)
            np.testing.assert_array_equal(points[:50], spread(number, 50))  # more keep those before
            for column in points.T:  # no tenth is empty, none has twice its part
                counts = np.histogram(column, 10, (0.0, 1.0))[0]
                self.assertTrue(14 <= counts.min() and counts.max() <= 26 and counts.sum() == 200, counts)


class LinkBudget(unittest.TestCase):
    def test_twice_the_aperture_is_twice_the_energy_without_background(self):
        bounds = {"pulse_energy": [3.6e-4, 7.2e-4, 1.44e-3], "receiver_aperture": [0.0078539816, 0.0157079632]}
        study = looked(study_of(fresh("energy"), {"bounds": bounds}, **FAINT))
        of = {(round(one.values["pulse_energy"] / 3.6e-4), round(one.values["receiver_aperture"] / 0.0078539816)): one
              for one in study.candidates}
        self.assertEqual(len(of), 6)
        for energy in (1, 2):
            self.assertAlmostEqual(of[energy, 2].share.value, of[2 * energy, 1].share.value, delta=1e-6)
        self.assertGreater(of[2, 1].share.value, of[1, 1].share.value + 0.005)
        self.assertAlmostEqual(of[1, 2].pulses["exposure"], of[1, 1].pulses["exposure"] / 2)

    def test_more_energy_detects_more(self):
        study = looked(study_of(fresh("more"), {"bounds": {"pulse_energy": BOUNDS["pulse_energy"]}, "designs": 12},
                                **FAINT))
        order = sorted(study.candidates, key=lambda one: one.values["pulse_energy"])
        self.assertTrue((np.diff([one.share.value for one in order]) > 0.0).all())
        self.assertTrue(all(one.front for one in order))  # as costs rise with energy
        self.assertIs(study.chosen, next(one for one in order if one.share.value - 2.0 * one.share.error >= 0.12))

    def test_the_plans_own_lidar_has_the_plans_own_share(self):
        where = fresh("own")
        clutter = {"coverage": {"species": "herring gull", "all_species": False}, "places": 100}
        plan = Plan(read_plan(plan_of(where, **clutter)), 1)
        overall = plan.overall
        base = {name: [getattr(plan.sensor, name)]
                for name in ("pulse_energy", "receiver_aperture", "number_of_channels", "rotation_rate")}
        study = looked(study_of(where, {"bounds": {**base, "mast": [3.0], "maximum_elevation": [15 * 0.375]}},
                                **clutter))
        one, = study.candidates
        self.assertAlmostEqual(one.share.value, overall["detection_probability"], delta=1e-6)
        self.assertAlmostEqual(one.share.error, overall["detection_std_error"], delta=2e-5)
        self.assertEqual(one.values, study.base)

    def test_a_mix_in_the_weathers_of_a_year(self):
        year = [{"weather": ["haze:20000"], "share": 0.75}, {"weather": ["fog:300"], "share": 0.25}]
        where = fresh("year")
        study = looked(study_of(where, {"bounds": {"pulse_energy": [3.6e-4]}}, coverage={"clutter": False},
                                mix={"herring gull": 3, "crow": 1}, year=year, places=100))
        plan = Plan(read_plan(where / "small.coverage.json"), 1)
        rows = [rows[-1]["detection_probability"] for rows in plan.in_airs([air.settings for air in plan.year])]
        self.assertAlmostEqual(study.candidates[0].share.value, 0.75 * rows[0] + 0.25 * rows[1], delta=1e-6)
        self.assertGreater(rows[0], rows[1] + 0.01)

    def test_scans_within_a_time(self):
        """2 of the scans in 10 s, Coverage's own number, by the binomial law at each place."""
        study = looked(study_of(fresh("within"), {"bounds": {"rotation_rate": [0.1, 0.2, 0.5]}, "within": 10},
                                coverage={**TARGET, "number_of_scans": 2}))
        self.assertIn("by 2 or more of the scans in 10 s", _design_page.does(study))
        once = study_of(fresh("once"), {"bounds": {"rotation_rate": [0.5]}})
        p = once._found("one", [once.candidates[0].values], once.plan.points)[0].astype(float)
        for one, scans in zip(study.candidates, (1, 2, 5)):
            expected = 1.0 - (1.0 - p) ** scans - scans * p * (1.0 - p) ** (scans - 1)
            self.assertAlmostEqual(one.share.value, expected.mean(), delta=2e-6)


class Pulses(unittest.TestCase):
    def test_gates_end_before_the_next_pulse(self):
        """16 channels, 10 us apart: c/2 times that is 1,498.96 m."""
        for gate, ambiguous in ((1498, False), (1500, True)):
            study = study_of(fresh("gate"), {"ambiguous_ranges": True} if ambiguous else {},
                             sensor={**NIGHT, "firing_interval": 1e-5, "range_gate": gate})
            self.assertFalse(any(one.refused for one in study.candidates))
        with self.assertRaisesRegex(Error, "contain no possible lidar: range_gate is 1500 m, expected at most 1499 m"):
            study_of(fresh("gate"), sensor={**NIGHT, "firing_interval": 1e-5, "range_gate": 1500})

    def test_numbers(self):
        study = study_of(fresh("pulses"), {"bounds": {"rotation_rate": [0.25, 0.5]}, "exit_aperture": 2e-3,
                                           "cost": "pulse_rate + average_power"})
        for one in study.candidates:
            rate = 180 * 16 * one.values["rotation_rate"]  # steps of 2 degrees, 16 channels
            self.assertAlmostEqual(one.pulses["pulse_rate"], rate)
            self.assertAlmostEqual(one.pulses["average_power"], 3.6e-4 * rate)
            self.assertAlmostEqual(one.pulses["exposure"], 3.6e-4 / 2e-3)
            self.assertAlmostEqual(one.pulses["pupil"], 3.6e-4 * math.pi * 0.0035 ** 2 / 2e-3)
            self.assertAlmostEqual(one.pulses["shortest_interval"], 30e-6, delta=1e-9)
            self.assertAlmostEqual(one.cost, rate * (1.0 + 3.6e-4))

        study = study_of(fresh("narrow"), {"bounds": {"pulse_energy": [3.6e-4]}, "exit_aperture": 2e-5})
        self.assertEqual(study.candidates[0].pulses["pupil"], 3.6e-4)  # all that a narrower beam has

    def test_a_lidar_that_cannot_be_is_told(self):
        study = study_of(fresh("refused"), {"bounds": {"number_of_channels": [16, 4000]}})
        self.assertEqual([bool(one.refused) for one in study.candidates], [False, True])
        self.assertRegex(study.candidates[1].refused, "the 4000 firings of a column take")
        study.look()
        _design_page.write(study)
        rows = rows_of(study.folder / "design.csv")
        self.assertEqual([row["detected [1]"] == "nan" for row in rows], [False, True])


class Work(unittest.TestCase):
    def test_folder_and_page(self):
        where = fresh("page")
        file = plan_of(where, description="<script>alert(1)</script> & what?",
                       design={**DESIGN, "cost_unit": "<b>kEUR"}, coverage=GULL)
        code, said, _ = run("design", file, "-o", where / "out")
        self.assertEqual(code, 0)
        self.assertEqual({path.name for path in (where / "out").iterdir()},
                         {"coverage", "design.csv", "design.html", "front.png", "sensitivities.csv",
                          "sensitivities.png"})
        rows = rows_of(where / "out" / "design.csv")
        self.assertEqual(len(rows), 8)
        for row in rows:
            self.assertAlmostEqual(float(row["radiant_exposure [J/m2]"]),
                                   float(row["pulse_energy [J]"]) / float(row["receiver_aperture [m2]"]), delta=1e-5)
            self.assertAlmostEqual(float(row["cost [<b>kEUR]"]),
                                   1000 * float(row["pulse_energy [J]"]) + 100 * float(row["receiver_aperture [m2]"]),
                                   delta=1e-3)
        self.assertEqual(sum(int(row["chosen"]) for row in rows), 1)
        page = (where / "out" / "design.html").read_text("utf-8")
        self.assertNotIn("<script", page)
        self.assertNotIn("<b>kEUR", page)
        self.assertNotRegex(page, r'(src|href)="(?!data:|#)')
        self.assertRegex(page, r"<p>The cheapest .* The designs are ideas: nobody sells these lidars\.</p>")
        with Browser() as browser:
            browser.open(where / "out" / "design.html")
            browser.check_printed(self)
        self.assertIn("The cheapest of 8 designs that detects 12 % of herring gulls on the map, 10 to 40 m, by one "
                      "scan costs ", page)
        chosen = next(row for row in rows if int(row["chosen"]))
        microjoules = 1e6 * float(chosen["pulse_energy [J]"]) * 38.4845e-6 / float(chosen["receiver_aperture [m2]"])
        for answer in (said.splitlines()[0], re.search("<p>(The cheapest.*?)</p>", page)[1]):
            first = re.search(r"^The cheapest of .*; eye safety is not assessed: at 905 nm each pulse puts (\S+) µJ "
                              r"through a pupil of 7 mm", answer)
            self.assertAlmostEqual(float(first[1]) / microjoules, 1.0, delta=0.05)
        for changed in rows_of(where / "out" / "sensitivities.csv"):
            up = float(changed["to"]) > float(changed["from"])
            self.assertEqual(float(changed["change_of_detected [1]"]) > 0.0, up)
            self.assertAlmostEqual(float(changed["to"]) / float(changed["from"]), 1.2 if up else 0.8, delta=1e-5)

    def test_other_masts_of_a_lidar_on_sale_are_not_ideas(self):
        for sensor, bounds, idea in (("VLP16", {"mast": [2.0, 3.0], "rotation_rate": [5, 10]}, False),
                                     ("VLP16", {"pulse_energy": [1e-6]}, True), ("Search905", {"mast": [2.0]}, True)):
            study = looked(study_of(fresh("sold"), {"bounds": bounds}, sensor={"preset": sensor}, places=20))
            self.assertEqual("nobody sells these lidars" in _design_page.answers(study)[0], idea)

    def test_shares_that_no_design_reaches(self):
        study = looked(study_of(fresh("none"), {"share": 0.999}))
        self.assertIsNone(study.chosen)
        self.assertEqual(study.about.share.value, max(one.share.value for one in study.candidates))
        self.assertRegex(_design_page.answers(study)[0],
                         "^None of 8 designs surely detects 99.9 % of .*; eye safety is not assessed: .* µJ through a "
                         "pupil of 7 mm")

    def test_what_the_error_does_not_tell(self):
        only = {"bounds": {"pulse_energy": BOUNDS["pulse_energy"]}}  # so that what costs more detects more
        study = looked(study_of(fresh("unsure"), only, **FAINT))
        middle = sorted(study.candidates, key=lambda one: one.cost)[2]
        again = looked(study_of(fresh("unsure"), {**only, "share": middle.share.value - middle.share.error}, **FAINT))
        self.assertIn(middle.number, [one.number for one in again.undecided()])
        self.assertGreater(again.chosen.cost, middle.cost)
        self.assertEqual([is_told(share, 0.01, 0.5) for share in (0.53, 0.515, 0.485, 0.47)], [True, None, None, False])
        self.assertRegex(" ".join(_design_page.answers(again)),
                         "the error does not decide, because .* within 2 standard errors")

    def test_a_killed_run_goes_on(self):
        where = fresh("killed")
        study, written = study_of(where), []

        def stop(what, done, total):
            written.append(done)
            if done == 3:
                raise KeyboardInterrupt
        study.progress = stop
        with self.assertRaises(KeyboardInterrupt):
            looked(study)
        kept = {file: file.read_bytes() for file in (where / "out" / "coverage").iterdir()}
        self.assertEqual(len(kept), 3)
        damaged = min(kept)
        damaged.write_bytes(kept[damaged][:-1] + b"\0")
        again, written = study_of(where), []
        again.progress = lambda what, done, total: written.append((what, total))
        looked(again)
        self.assertIn(("designs", 6), written)  # 8 but 2 that are whole
        for file, content in kept.items():
            self.assertEqual(file.read_bytes(), content)
        whole = looked(study_of(fresh("not-killed")))
        self.assertEqual([one.share for one in whole.candidates], [one.share for one in again.candidates])
        other = study_of(where, coverage={**TARGET, "effective_area": 0.04})
        with unittest.mock.patch.object(Designs, "_at_places", side_effect=RuntimeError(
                                            "made again")), self.assertRaisesRegex(RuntimeError, "made again"):
            looked(other)

    def test_tracked(self):
        where = fresh("tracked")
        scenario = TestBirdTracks.scenario_file(where, number_of_scans=25)
        study = study_of(where, {"measure": "tracked", "scenario": scenario.name, "finalists": 2, "share": 0.1,
                                 "bounds": {"pulse_energy": [1e-6, 3.6e-4]}}, heights=[0, 40],
                         sensor={"preset": "Search905"}, coverage=GULL, places=100).look()
        weak, strong = study.finalists
        self.assertLess(weak.tracked.value + 0.1, strong.tracked.value)
        self.assertIs(study.chosen, strong)
        folders = sorted((where / "out" / "tracks").iterdir(), key=lambda folder: folder.stat().st_mtime_ns)
        self.assertEqual(len(folders), 2)
        birds = rows_of(folders[1] / "birds.csv")
        gulls = [bird for bird in birds if bird["species"] == "herring gull"]
        self.assertEqual((strong.tracked.number, strong.tracked.value),
                         (len(gulls), sum(bird["found_s"] != "" for bird in gulls) / len(gulls)))
        _design_page.write(study)
        self.assertIn("tracks 10 % of herring gulls of the scenario at least once", _design_page.answers(study)[0])

class Wrong(unittest.TestCase):
    def test_plans(self):
        where = fresh("wrong")
        for design, changes, words in (
                ({"share": 1.5}, {}, "design.share"), ({"bounds": {"color": [1]}}, {}, "design.bounds.*'color'"),
                ({"bounds": {"mast": [0]}}, {}, "design.bounds.mast: holds 0"),
                ({"bounds": {"pulse_energy": {"from": 2, "to": 1}}}, {}, "pulse_energy: is from 2 to 1"),
                ({"bounds": {"minimum_elevation": {"from": -2, "to": 1, "logarithmic": True}}}, {}, "begins at -2"),
                ({"bounds": {"number_of_channels": [16, 16.5]}}, {}, "number_of_channels: holds 16.5"),
                ({"bounds": {"maximum_elevation": [0, 9]}}, {}, "beams begin at up to 0 deg"),
                ({"bounds": {"number_of_channels": [16]}}, {"sensor": {"preset": "VLP32C"}}, "beams are a table"),
                ({"bounds": {"receiver_aperture": {"from": 1, "to": 2}}}, {"sensor": {"preset": "Airport16"}},
                 "receiver_aperture: "),
                ({"bounds": {"number_of_channels": [5000]}}, {}, "design.bounds: contain no possible lidar"),
                ({"cost": "price"}, {}, "design.cost: price: "),
                ({"exit_aperture": "0 * mast"}, {}, "design.exit_aperture: "),
                ({"measure": "tracked"}, {}, "design.scenario: ")):
            with self.subTest(words), self.assertRaisesRegex(Error, words):
                study_of(where, design, **changes)
        scenario = json.loads(TestBirdTracks.scenario_file(where).read_text("utf-8"))
        shutil.copyfile(where / "small.lidarscene.json", where / "other.lidarscene.json")
        (where / "other.scenario.json").write_text(json.dumps({**scenario, "scene": "other.lidarscene.json"}), "utf-8")
        with self.assertRaisesRegex(
                Error, "design.scenario: has the scene .*other.lidarscene.json, expected the scene of the plan"):
            study_of(where, {"measure": "tracked", "scenario": "other.scenario.json"})
        self.assertFalse((where / "out").exists())
