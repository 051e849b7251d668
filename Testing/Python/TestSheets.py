#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Receivers fitted to the points of a sheet: numbers that are known come back, boards at the fitted ranges are seen as
often as the sheet says when they are simulated, and bad sheets are named."""
import json

import numpy as np

import avianlidar as al
from echotools import InFolder
from helpertools import run
from avianlidar import _sheet

HALF = 2e-3  # rad


def sensor(**settings):
    return al.Sensor("Automotive16", **{"half_beamwidth": HALF, "range_gate": 600.0, "overlap_range": 0,
                                        "defocus_range": 0, "background_radiance": 0, "range_noise": 0,
                                        "range_noise_floor": 0, **settings})


def points(receiver, numbers, *rows):
    """Points of a sheet of rows (reflectance, probability, light). @param numbers of Receiver.range()"""
    made = [{"reflectance": rho, "probability": p, "light": light, "range": 100.0, "source": "made"}
            for rho, p, light in rows]
    return [{**point, "range": receiver.range(point, *numbers)} for point in made]


class Sheets(InFolder):

    def test_known_numbers_come_back(self):
        start = sensor()
        numbers = 3e-4, 40.0, 0.6
        rows = [(0.1, 0.5, 0), (0.8, 0.5, 0), (0.1, 0.9, 100), (0.8, 0.5, 100), (0.8, 0.9, 100)]
        found = _sheet.fit(start, points(_sheet.Receiver(start), numbers, *rows))
        np.testing.assert_allclose([*found.numbers.values(), found.board], numbers, rtol=0.01)
        self.assertLess(found.bar, 1e-3)
        # Boards that points tell are theirs.
        own = [{**point, "board": board}
               for point, board in zip(points(_sheet.Receiver(start), (3e-4, 10.0, 2.0), *rows[:2]), (0.5, 2.0))]
        own = [{**point, "range": _sheet.Receiver(start).range(point, 3e-4, 10.0, np.nan)} for point in own]
        self.assertAlmostEqual(_sheet.fit(start, own).numbers["receiver_aperture"] / 3e-4, 1, delta=1e-3)
        # One point is enough to fit one number, and then no point can be left out.
        one = _sheet.fit(start, points(_sheet.Receiver(start), (3e-4, 10.0, np.nan), (0.1, 0.5, 0)))
        self.assertAlmostEqual(one.numbers["receiver_aperture"] / 3e-4, 1, delta=1e-3)
        self.assertTrue(np.isnan(one.left_out[0]) and np.isnan(one.board) and np.isnan(one.bar))

    def test_a_filter_has_a_bound(self):
        start, rows = sensor(), [(0.1, 0.5, 0), (0.8, 0.5, 0), (0.8, 0.5, 100), (0.8, 0.9, 100)]
        found = _sheet.fit(start, points(_sheet.Receiver(start), (3e-4, 2000.0, 0.6), *rows))
        self.assertIn("filter_bandwidth ends at the bound", found.limit)
        self.assertAlmostEqual(found.numbers["filter_bandwidth"] / 100.0, 1, delta=0.02)
        self.assertGreater(found.bar, 0.01)
        for name in al.Sensor.presets():
            self.assertLessEqual(al.Sensor(name).filter_bandwidth, 100, name)

    def check_board(self, looking, point, half, delta):
        """The share of beams on a square board at the range of a point that see it, its probability by the sheet."""
        x = point["range"]
        scene = al.Scene([(x, -half, -half), (x, half, -half), (x, half, half), (x, -half, half)],
                         [(0, 1, 2), (0, 2, 3)], material=(point["reflectance"], 0, 1))
        echoes = al.Scan(scene, looking, visibility=23e3, number_of_reflections=1).echoes
        share = (echoes["object_id"] >= 0).sum() / looking.beams.number_of_points
        self.assertAlmostEqual(share, point.get("probability", 0.5), delta=delta)

    def test_boards_are_seen_as_often_when_simulated(self):
        """1,000 beams on a board at a fitted range, in the dark and in the sun: a standard deviation of 0.016 at
        most."""
        numbers = 3e-4, 60.0, 0.5
        for rho, p, light in ((0.1, 0.9, 0), (0.8, 0.5, 100)):
            with self.subTest(reflectance=rho, light=light):
                whole = sensor()
                looking = sensor(directions=np.tile([1.0, 0, 0], (1000, 1)), receiver_aperture=numbers[0],
                                 pulse_width=0,
                                 false_alarms_per_scan=whole.false_alarms_per_scan * 1000
                                 / whole.beams.number_of_points, filter_bandwidth=numbers[1], sun_azimuth=270,
                                 sun_elevation=0, sunlight=_sheet.irradiance(light, sensor().wavelength))
                # The simulated board is not quite what fills so much of the beam: 2 % of the signal.
                self.check_board(looking, points(_sheet.Receiver(sensor()), numbers, (rho, p, light))[0],
                                 0.5 * numbers[2], 0.05)

    def test_presets_see_the_boards_of_their_sheets(self):
        """Each fitted preset as it is shipped, on the first and the last board of its own points, at the fitted ranges
        that its file states: 400 beams, whose share has a standard deviation of 0.025."""
        for name in al.Sensor.presets():
            of = al.Sensor(name)
            if "sheet" not in of.description:
                continue
            sheet = of.description["sheet"]
            half, share = 0.5 * sheet.get("board", 100), 400 / of.beams.number_of_points
            for at in (0, -1):
                point = {**sheet["points"][at], "range": sheet["points"][at]["range"] * (1 + sheet["residuals"][at])}
                light = point.get("light", 0)
                with self.subTest(name, reflectance=point["reflectance"], light=light):
                    looking = al.Sensor(name, directions=np.tile([1.0, 0, 0], (400, 1)), sun_azimuth=270,
                                        sun_elevation=0, sunlight=_sheet.irradiance(light, of.wavelength),
                                        range_noise=0, background_radiance=0.01 * light * of.background_radiance,
                                        false_alarms_per_scan=share * of.false_alarms_per_scan)
                    # The board is a square, the fit takes a disc of its area: up to 10 % of the signal where it just
                    # fills the beam.
                    self.check_board(looking, point, half, 0.13)

    def test_wrong_sheets_are_named(self):
        good = {"range": 100, "reflectance": 0.1, "source": "x"}
        for bad, words in (({**good, "range": -1}, r"points\[0\].range is -1"),
                           ({**good, "probability": 1}, "probability is 1"),
                           ({"range": 1, "source": "x"}, "reflectance is missing"),
                           ({**good, "ligth": 100}, "ligth is not known"), ({**good, "range": 700}, "range is 700")):
            with self.assertRaisesRegex(ValueError, words):
                sensor().fit([bad])
        with self.assertRaisesRegex(ValueError, "no points"):
            sensor().fit()

    def test_a_fit_starts_by_itself(self):
        point = {"range": 100, "reflectance": 0.1, "source": "x"}
        started = [sensor(receiver_aperture=aperture).fit([point]).numbers["receiver_aperture"]
                   for aperture in (0, 1e-6, 1)]
        np.testing.assert_allclose(started, started[0], rtol=1e-6)
        self.assertAlmostEqual(sensor(receiver_aperture=0).fit([point]).predicted[0], 100, delta=1e-3)

    def test_the_command_writes_a_sensor(self):
        start = sensor()
        sheet = points(_sheet.Receiver(start), (3e-4, 10.0, 0.6), (0.1, 0.5, 0), (0.1, 0.9, 0), (0.8, 0.5, 0),
                       (0.8, 0.9, 0))
        made, fitted = (self.folder / f"{name}.lidarsensor.json" for name in ("made", "fitted"))
        description = al.Sensor("Automotive16").description
        description["values"]["half_beamwidth"]["value"] = HALF
        description["values"]["range_gate"]["value"] = 600.0
        description["values"]["background_radiance"]["value"] = 0.0
        made.write_text(json.dumps({**description, "sheet": {"points": sheet}}), "utf-8")
        code, out, errors = run("sensors", "--fit", made, "-o", fitted)
        self.assertEqual(code, 0, errors)
        self.assertIn("ranges by this receiver have an error of about 0 %", out)
        # Over itself: a fit of what is fitted is the same.
        before = fitted.read_text("utf-8")
        self.assertEqual(run("sensors", "--fit", fitted, "-o", fitted)[0], 0)
        self.assertEqual(fitted.read_text("utf-8"), before)
        self.assertEqual(sorted(path.name for path in made.parent.iterdir()), sorted((made.name, fitted.name)))
        of = al.Sensor(fitted)
        self.assertAlmostEqual(of.receiver_aperture / 3e-4, 1, delta=0.01)
        self.assertEqual((of.description["sheet"]["bar"] < 0.01, len(of.description["sheet"]["residuals"])),
                         (True, 4))
