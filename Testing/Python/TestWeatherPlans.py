# SPDX-License-Identifier: BSD-3-Clause
"""Weather in plans and reports: words and properties by hand give the same, years are weighted sums, METAR reports by
known answers, errors."""
import math
import re
import shutil
import unittest

import numpy as np

import avianlidar as al
from avianlidar import siting
from avianlidar._command import main
from avianlidar.apps.coverage import _sites_page
from avianlidar.apps.coverage._plan import Plan
from avianlidar.apps.coverage._report import Report
from avianlidar.apps.coverage._sites import OTHER_PLACES, Sites
from avianlidar.apps.inputs import _metar
from avianlidar.apps.inputs._air import extinction_of_rain
from avianlidar.apps.inputs._read import read_plan
from helpertools import error_of, rows_of
from reporttools import HERE, SENSOR, airport, quick, written

TARGET = {"species": "", "effective_area": 0.03, "all_species": False}  # m2: quicker than birds
FOG = {"visibility": 1000, "air_backscatter": True}
YEAR = [{"weather": ["haze:20000"], "share": 0.8}, {"weather": ["fog:500"], "share": 0.15},
        {"weather": ["rain:10"], "share": 0.05}]


def plan(name, **changes):
    """The file of the airport's plan, small. A change to None takes away."""
    siting = {"bounds": [-1200, 1800, -1200, 0], "spacing": 1000, "masts": [5], "sensors": 2, "draws": 0}
    small = {"siting": siting, "coverage": {**TARGET, "visibility": 23000}, "spacing": 300, "places": 40,
             "heights": [20], "sensor": SENSOR}
    return written(name, airport(**{**small, **changes}))


class Coverage(unittest.TestCase):
    def test_words_are_the_properties_set_by_hand(self):
        tables = []
        for name, changes, words in (("hand", {"coverage": {**TARGET, **FOG, "rain_rate": 10}}, ()),
                                     ("key", {"coverage": {**TARGET}, "weather": ["fog:1000", "rain:10"]}, ()),
                                     ("command", {"coverage": {**TARGET, "visibility": 5000}, "weather": ["haze:3000"],
                                                  "year": YEAR}, ("--weather", "fog:1000", "rain:10"))):
            out = HERE / "maps" / name
            shutil.rmtree(out, ignore_errors=True)
            self.assertEqual(main(["coverage", str(plan(name, **changes)), "-o", str(out), *words]), 0)
            tables.append([(out / file).read_bytes()
                           for file in ("shares.csv", "detection_probability_20m.tif", "clutter.vtp")])
        self.assertEqual(tables[1:], 2 * tables[:1])

    def test_shares_in_other_airs_trace_nothing_and_leave_the_plan_as_it_was(self):
        one = Plan(read_plan(plan("airs", mix={"crow": 1, "herring gull": 3}, coverage={"all_species": False},
                                  places=20)))
        before = one.regions.properties()
        airs = ({"visibility": 1000, "air_backscatter": True, "rain_rate": 0},
                {"visibility": 23000, "air_backscatter": False, "rain_rate": 10})
        rows = one.in_airs([one.air_of(["fog:1000"]), one.air_of(["rain:10"])])
        self.assertEqual(one.regions.algorithm.GetNumberOfTracedPlaces(), 0)
        for air, of in zip(airs, rows):
            self.assertEqual([row["region"] for row in of], ["strips", "approaches", "all"])
            p = [al.Coverage(one.scene, one.sensor, places=one.points, species=name, **air)["detection_probability"]
                 for name in ("crow", "herring gull")]
            p = 0.25 * p[0].astype(float) + 0.75 * p[1]
            for row, members in zip(of, (one.members["strips"], one.members["approaches"], slice(None))):
                self.assertAlmostEqual(row["detection_probability"], p[members].mean(), delta=1e-7)
        self.assertEqual(before, one.regions.properties())


class Year(unittest.TestCase):
    def test_sites_are_ranked_by_the_weighted_sum(self):
        few = {"preset": "Search905", "name": "Search905", "azimuth_step": 4}  # beams
        sites = Sites(Plan(read_plan(plan("year", year=YEAR, sensor=few)), 1)).look()
        alone = []
        for part in YEAR:
            words = part["weather"]
            rain = {"visibility": 23000, "rain_rate": 10} if words == ["rain:10"] else {}
            coverage = {**TARGET, "visibility": 23000} if rain else {**TARGET}
            alone.append(Sites(Plan(read_plan(plan("part", coverage=coverage, weather=words, sensor=few)), 1)).look())
        wanted = sum(part["share"] * one.values for part, one in zip(YEAR, alone))
        np.testing.assert_allclose(sites.values, wanted, rtol=1e-9)
        np.testing.assert_allclose(sites.by_air, np.transpose([one.values for one in alone]), rtol=1e-9)
        self.assertGreater(len(sites.values), 3)
        # In each weather, two sensors have their own probability that one of them detects.
        pair = sites.networks[1]
        of_pair = sum(part["share"] * siting.value_of(one.found, one.weights, pair.sites)
                      for part, one in zip(YEAR, alone))
        self.assertAlmostEqual(pair.value, of_pair, delta=1e-9)
        # What is told of networks is of other places, with clutter as the plan has it.
        points, _ = sites.plan.places(sites.plan.seed + OTHER_PLACES)
        same = sum(part["share"]
                   * siting.value_of_same_birds(
                       one.plan.scene, one.plan.sensor, one.positions[list(pair.sites)], points, [""], one.told_weights,
                       **{**one.settings, "clutter": one.plan.coverage.clutter}) for part, one in zip(YEAR, alone))
        self.assertAlmostEqual(sites.of_same_birds[1], same, delta=1e-9)
        out = HERE / "sites"
        _sites_page.write(sites, out, [])
        table = np.genfromtxt(out / "sites.csv", delimiter=",", names=True)
        np.testing.assert_allclose(table["value"], sites.values[sites.order], rtol=1e-9)
        np.testing.assert_allclose(table["value_fog_500"], alone[1].values[sites.order], rtol=1e-9)
        region = sum(part["share"] * one.found[sites.order, 0][:, one.regions["strips"]].mean(axis=1)
                     for part, one in zip(YEAR, alone))
        np.testing.assert_allclose(table["target_strips"], region, rtol=1e-5)
        self.assertIn("fog of 500 m 15 %", _sites_page.words(sites)["weather"])

    def test_the_report_says_fog_and_the_year(self):
        question = {"siting": None, "runways": None, "extent": [-600, 600, -600, 600], "spacing": 200}
        with quick():
            Report(read_plan(plan("report", year=YEAR, **question)), 2).write(HERE / "report.html")
        text = (HERE / "report.html").read_text("utf-8")
        rows = {(row["weather"], row["region"]): float(row["detection_probability"])
                for row in rows_of(HERE / "report_files" / "weather.csv")}
        in_fog = Plan(read_plan(plan("fog", coverage={**TARGET}, weather=["fog:1000"],
                                     **question))).overall["detection_probability"]
        self.assertAlmostEqual(rows["visibility 1000 m", "map"], in_fog, delta=1e-6)
        self.assertGreater(rows["rain 0 mm/h", "map"], in_fog)
        told = re.search("<dd class=\"value\">([0-9.]+)\xa0%</dd><dt>in fog of 1 km", text)
        self.assertAlmostEqual(float(told[1]), 100 * in_fog, delta=0.51)
        year = sum(part["share"] * rows[name, "map"]
                   for part, name in zip(YEAR, ("visibility of 20,000 m", "fog of 500 m", "rain of 10 mm/h")))
        told = float(re.search(", ([0-9.]+) ± [0-9.]+\xa0% over the year", text)[1])
        self.assertAlmostEqual(told, 100 * year, delta=0.51)
        self.assertAlmostEqual(rows["all hours", "map"], year, delta=1e-6)

    def test_wrong_years_are_named(self):
        half = [{"weather": ["fog:500"], "share": 0.5}]
        plan("wrong").with_name("empty.txt").write_text("# nothing\nstation,valid,metar\n", "utf-8")
        for changes, words in (({"weather": ["snow:3"]}, "weather: "),
                               ({"weather": ["fog:500"]}, "weather: is given beside visibility"),
                               ({"year": half}, "year: shares sum to 0.5"),
                               ({"year": [*half, {"weather": ["rain:501"], "share": 0.5}]}, "RainRate is 501"),
                               ({"weather": ["rain:1e30"], "coverage": {}, "sensor": {"preset": "Airport16"}},
                                "json: weather: vtkAvianLidarCoverage: RainRate is 1e+30"),
                               ({"year": YEAR, "metar": "year.txt"}, "metar: is given beside 'year'"),
                               ({"metar": "none.txt"}, "none.txt: cannot be read"),
                               ({"metar": "empty.txt"}, "empty.txt: holds no METAR report")):
            self.assertIn(words, error_of("coverage", plan("wrong", **changes), "-o", HERE / "wrong"))


REPORTS = """station,valid,metar
# of no account
METAR ZSSS 010000Z 34004MPS 9999 FEW030 12/08 Q1013 NOSIG=
2023-01-01 00:30 METAR ZSSS 010030Z 34004MPS CAVOK 12/08 Q1013 TEMPO 0800 FG=
202301010100 SPECI ZSSS 010100Z AUTO 34004MPS 0800 0300N R18L/0600U FG FEW030 12/08 Q1013 BECMG 9999=
ZSSS,2023-01-01 02:00,ZSSS 010200Z 00000KT 1 1/2SM -RA BR OVC005 10/09 A2992 RMK AO2 10SM RAB05
ZSSS 010300Z 00000KT M1/4SM FG VV001 05/05 A2992
ZSSS 010400Z 00000KT 10SM TS FEW020 10/09 A2992
ZSSS 010500Z 34004MPS 3000 +SHRA BKN010 12/08 Q1013
ZSSS 010600Z 34004MPS 0000 FG VV/// 05/05 Q1013
ZSSS 010700Z 34004MPS 5000 HZ VCSH NSC RERA 20/08 Q1013
ZSSS 010800Z 34004MPS 1500 +SN BLSN VV002 M02/M03 Q1013
ZSSS 010900Z 34004MPS 4000 TSRAGR BKN010 12/08 Q1013
ZSSS 011000Z 34004MPS 7000 -DZ OVC004 12/08 Q1013
ZSSS 011100Z 34004MPS //// // ////// 12/08 Q1013
ZSSS 011200Z NIL=
ZSSS 011300Z 24010KT P6SM SKC 12/08 A2992
"""


class Metar(unittest.TestCase):
    def test_lines_of_known_answers(self):
        mile = 1609.344
        wanted = [(math.inf, 0), (math.inf, 0), (300, 0), (1.5 * mile, 1), (0.25 * mile, 0), (math.inf, 0), (3000, 15),
                  (50, 0), (5000, 0), (1500, 0), (4000, 5), (7000, 0.5), (math.inf, 0)]
        (HERE / "year.txt").parent.mkdir(parents=True, exist_ok=True)
        (HERE / "year.txt").write_text(REPORTS, "utf-8")
        hours = _metar.read_metar(HERE / "year.txt")
        self.assertEqual([(one.visibility, one.rain) for one in hours.reports], wanted)
        self.assertEqual([number for number, _, _ in hours.bad], [1, 15, 16])
        self.assertEqual([hours.reports[k].others for k in (9, 10)], [("snow", "snow"), ("hail",)])
        # Two in the first hour count half each; the same hour of another month is another one.
        again = _metar.Hours("", [*hours.reports, hours.reports[0]], [])
        self.assertEqual([share for share, _ in again.weighted()], [0.5, 0.5] + 12 * [1])
        self.assertRegex(hours.words(), "13 METAR reports of ZSSS, 12 hours; left out: 1, the first in line 1")

    def test_spellings_of_archives(self):
        mile = 1609.344
        for words, visibility, rain in (
                ("11/2SM BR", 1.5 * mile, 0), ("111/16SM BR", 27 / 16 * mile, 0), ("2 1/2 SM HZ", 2.5 * mile, 0),
                ("10SM", math.inf, 0), ("6KM HZ", 6000, 0), ("20KM VCSH", math.inf, 0), ("9999NDV -RA", math.inf, 1),
                ("9999 3100 SHRA", math.inf, 5), ("1500NE 7000SW BR", 1500, 0), ("4000 1200N BR", 1200, 0),
                ("0600SW R18R/P1500 FG", 600, 0), ("9999 FU 2000SE", math.inf, 0), ("350 FG", 350, 0),
                ("0800M FG", 800, 0), ("//// -RA BKN010 10/09 1013", None, 0)):
            for head in ("EGLL 010020Z 24005KT", "EGLL,2020-01-01 00:20,EGLL 010020Z 0000KT",
                         "METAR EGLL 010020Z /////", "SPECI EGLL 010020 COR 24005MPS"):
                for line in (f"{head} {words} BKN010 10/09 Q1020", f"{head} {words}".lower()):
                    with self.subTest(line):
                        if visibility is None:
                            self.assertRaisesRegex(ValueError, "expected a visibility", _metar.report_of, line)
                        else:
                            found = _metar.report_of(line)
                            self.assertEqual((found.station, found.rain), ("EGLL", rain))
                            self.assertAlmostEqual(found.visibility, visibility)

    def test_reports_go_on_in_the_next_line_and_forecasts_do_not_count(self):
        text = """SAUK31 EGRR 010020
METAR EGLL 010020Z 24005MPS 200V280
 2000
# a comment
+RA BR TEMPO 0800
FG= METAR EGKK 010020Z 24005KT CAVOK=

TAF EGLL 010500Z 0106/0212 24005MPS CAVOK
 BECMG 0108/0109 1200 +RA=
EGLL 010500Z 010606 24005MPS CAVOK
EGLL 010120Z 24005MPS 3000
             -RA

no report
EGLL 010220Z NIL=
"""
        (HERE / "wrapped.txt").parent.mkdir(parents=True, exist_ok=True)
        (HERE / "wrapped.txt").write_text(text, "utf-8")
        hours = _metar.read_metar(HERE / "wrapped.txt")
        self.assertEqual([(one.station, one.visibility, one.rain) for one in hours.reports],
                         [("EGLL", 2000, 15), ("EGKK", math.inf, 0), ("EGLL", 3000, 1)])
        for line in (1, 8, 15):
            self.assertIn(f"the first in line {line}, ", hours.words())

    def test_times_that_are_wrong_or_there_twice(self):
        def hours(text):
            (HERE / "times.txt").parent.mkdir(parents=True, exist_ok=True)
            (HERE / "times.txt").write_text(text, "utf-8")
            return _metar.read_metar(HERE / "times.txt").words()

        for time in ("320100Z", "000100Z", "012500Z", "010060Z"):
            self.assertRegex(hours(f"EGLL 010000Z 24005KT CAVOK\nEGLL {time} 24005KT 0100 FG\n"),
                             f"1 METAR reports of EGLL, 1 hours; left out: 1, the first in line 2, 'EGLL {time} .*' "
                             ".expected a day, an hour")
        # of a download
        for dates, number in (({"": 1, " ": 1}, 48), ({"202001": 2}, 24), ({"2020-01-": 2}, 24),
                              ({"202001": 2, "202002": 2}, 48), ({"20250630 ": 1, "20250630\t": 1}, 48)):
            day = "".join(f"{month}{'01' if month.strip() else ''} EGLL 01{hour:02d}00Z 24005KT CAVOK\n"
                          for month, times in dates.items() for _ in range(times) for hour in range(24))
            self.assertIn(f" METAR reports of EGLL, {number} hours", hours(day), dates)

    def test_hours_are_counted_by_class(self):
        hours = _metar.Hours("", [_metar.report_of(line) for line in REPORTS.splitlines()[2:] if "////" not in line
                                  and "NIL" not in line], [])
        found = {tuple(part["weather"]): 12 * part["share"] for part in hours.year()}
        self.assertAlmostEqual(sum(found.values()), 12)
        self.assertAlmostEqual(found["haze:23000",], 3)
        # setting over report: 5 % of a beam is left at a meteorological optical range (ICAO Annex 3)
        mor = 3.912 / math.log(20)
        low = 3 * mor / (1 / 50 + 1 / 300 + 1 / (0.25 * 1609.344))
        self.assertAlmostEqual(found[f"fog:{float(f'{low:.2g}'):g}",], 3)
        self.assertAlmostEqual(found["haze:2000",], 1)
        # Rain takes its part of the extinction that was reported.
        for visibility, rate in ((4000, 5), (1.5 * 1609.344, 1)):
            left = math.log(20) / visibility - extinction_of_rain(float(rate))
            self.assertAlmostEqual(found[f"haze:{float(f'{3.912 / left:.2g}'):g}", f"rain:{rate}"], 1)

    def test_visibility_is_an_optical_range(self):
        for code, word in (("0600 FG", "fog:780"), ("0990 FG", "fog:1300"), ("1100 BR", "haze:1400"),
                           ("4000 HZ", "haze:5200"), ("9000", "haze:12000")):
            one = _metar.Hours("a", [_metar.report_of(f"ZSSS 010000Z 00000KT {code} Q1013")], [])
            self.assertEqual(one.year()[0]["weather"], [word])
        self.assertIn("optical ranges, as by day (in a setting times 1.31): by night, air of 500 m is 2.8 times as "
                      "dense", one.words())
        # A lamp of 1000 cd gives 1e-6 lx after 600 m in air that leaves 5 % of a beam after 227 m.
        self.assertAlmostEqual(1000 * 0.05**(600 / 226.7) / 600**2, 1e-6, delta=1e-8)
        self.assertAlmostEqual(_metar.night_factor(600), 600 / 226.7, delta=1e-3)

    def test_a_file_is_the_year_of_its_hours(self):
        (HERE / "few.txt").write_text("".join(f"ZSSS 01{hour:02d}00Z 00000KT {'0500 FG' if hour < 6 else 'CAVOK'} "
                                              "Q1013\n" for hour in range(24)))
        by_file = read_plan(plan("metar", metar="few.txt"))
        by_option = read_plan(plan("metar", year=YEAR), metar=HERE / "few.txt")
        self.assertEqual(by_file["year"],
                         [{"weather": ["fog:650"], "share": 0.25}, {"weather": ["haze:23000"], "share": 0.75}])
        self.assertEqual(by_option["year"], by_file["year"])
