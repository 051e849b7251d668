# SPDX-License-Identifier: BSD-3-Clause
"""Waveforms against closed forms: energies of range units, pulses on plates, two plates, range walk, Rice's false alarms,
and the law of detection."""
import contextlib
import csv
import io
import os
import pathlib
import re
import runpy
import tempfile
import unittest
import warnings

import numpy as np
from scipy import stats

import avianlidar as al
from avianlidar._cloud import add_array
from avianlidar._command import main

C = 299792458.0
FWHM = 2.0 * np.sqrt(2.0 * np.log(2.0))  # of a Gaussian, over its standard deviation
NORTH = {"directions": [(0, 1, 0)]}
# One beam of 2 mrad (full) without noise; Qlow is far below all echoes.
PLAIN = {"half_beamwidth": 1e-3, "lower_energy_limit": 1e-12, "upper_energy_limit": 1.0, "range_gate": 400.0,
         "noise_photon_rate": 0.0}
QUIET = {"noise": False, "number_of_reflections": 1, "attenuation_coefficient": 0.0}


def plate(range_, x=(-9.0, 9.0), slope=0.0):
    """A wall to the north at a range, m. @param slope change of the range per metre to the east"""
    (a, b), z = x, 9.0
    return al.mesh([(a, range_ + slope * a, -z), (b, range_ + slope * b, -z), (b, range_ + slope * b, z),
                    (a, range_ + slope * a, z)], [(0, 1, 2), (0, 2, 3)])


def scan_of(parts, sensor=None, preset="Airport16", material="Wall", **settings):
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData
    scene = vtkAppendPolyData()
    for part in parts:
        scene.AddInputData(part)
    scene.Update()
    lidar = al.Sensor(preset, **{**NORTH, **(PLAIN if preset == "Airport16" else {}), **(sensor or {})})
    return al.Scan(al.Scene(scene.GetOutput(), material=material), lidar,
                   **{**QUIET, "record_waveforms": True, **settings})


def units_of(scan):
    """Sums of the mean signal in range units, by (beam, unit)."""
    waves, length = scan.waveforms, 0.5 * C * scan.sensor.sampling_interval
    found = {}
    for number in range(waves.number_of_stretches):
        one = waves.stretch(number)
        for unit, energy in zip(np.floor(one["distance_m"] / length).astype(int), one["signal"]):
            found[one.beam_id, unit] = found.get((one.beam_id, unit), 0.0) + energy
    return found


class Integral(unittest.TestCase):
    SHAPES = ({}, {"pulse_shape": "Gaussian"}, {"response_time": 2e-9}, {"pulse_width": 0.0},
              {"pulse_shape": "Gaussian", "pulse_width": 3e-9, "response_time": 1e-9})

    def check(self, sensor, **settings):
        scan = al.Scan(al.example_scene(), sensor, noise=False, record_waveforms=True, **settings)
        units = units_of(scan)
        scan.return_mode = "RangeUnits"  # a point for each range unit above the limit, without its waveform
        length = 0.5 * C * sensor.sampling_interval
        self.assertGreater(len(scan["energy"]), 300)
        for beam, range_, energy in zip(scan["beam_id"], scan["distance_m"], scan["energy_received"]):
            self.assertLess(abs(units[beam, int(range_ / length)] / energy - 1.0), 1e-12)

    def test_samples_of_a_range_unit_add_up_to_its_energy(self):
        for shape in self.SHAPES:
            for rate in (0.0, 1e9):
                with self.subTest(shape=shape, rate=rate):
                    self.check(al.Sensor("Airport16", position=(0, 0, 3), azimuth_step=1, digitiser_rate=rate, **shape))

    def test_of_rays_and_of_two_reflections(self):
        sensor = al.Sensor("Airport16", position=(0, 0, 3), azimuth_step=1, digitiser_rate=1e9)
        self.check(sensor, beam_samples="Rays")

    def test_echoes_of_polygons_do_not_depend_on_waveforms(self):
        scene, position = al.example_scene(), (0, 0, 3)
        plain = al.Scan(scene, al.Sensor("Search905", position=position))
        for rate in (0.0, 1e9):
            scan = al.Scan(scene, al.Sensor("Search905", position=position, digitiser_rate=rate), record_waveforms=True)
            views, beams = plain.report["view"], plain["beam_id"]
            kept = views[beams] == 2 if rate else np.ones(len(beams), bool)
            self.assertGreater(kept.sum(), 2000)
            for name in plain:
                np.testing.assert_array_equal(plain[name][kept], scan[name][kept], name)

    def test_fog_returns_the_same_light(self):
        sensor = al.Sensor("Search905", position=(0, 0, 3), **NORTH, digitiser_rate=1e9)
        scene = al.Scene(plate(150.0), material="Wall")
        fog = al.Scan(scene, sensor, visibility=300.0, air_backscatter=True, noise=False)
        clear = al.Scan(scene, sensor, visibility=300.0, noise=False)
        waves, other = fog.waveforms, clear.waveforms
        near = [one["signal"][one["distance_m"] < 140.0].sum() for one in (waves, other)]
        self.assertGreater(near[0], 1e-14)
        self.assertEqual(near[1], 0.0)
        ranges, signal = waves["distance_m"], waves["signal"]
        before = (ranges > 20) & (ranges < 140)
        slope = np.polyfit(ranges[before], np.log(signal[before] * ranges[before]**2), 1)[0]
        self.assertLess(abs(slope + 2.0 * fog.echoes.fields["attenuation_coefficient"]), 2e-4)


class Shapes(unittest.TestCase):
    def test_gaussian_on_a_tilted_plate_has_the_width_of_the_convolution(self):
        range_, slope, theta = 100.0, 4.0, 1e-3
        width, response = 3e-9, 2e-9
        scan = scan_of([plate(range_, slope=slope)], {"pulse_shape": "Gaussian", "pulse_width": width,
                       "response_time": response, "digitiser_rate": 5e9}, waveform_floor=1e-6)
        wave = scan.waveforms.strongest()
        times, signal = wave["sample_time"], wave["signal"]
        # Own integral over a uniform disc: ranges of a plane, and the light of a matt and glossy surface.
        y, x = np.mgrid[-1:1:801j, -1:1:801j]
        inside = x**2 + y**2 <= 1.0
        x, y = theta * x[inside], theta * y[inside]
        ranges = range_ / (1.0 - slope * x) * np.sqrt(1.0 + x**2 + y**2)
        deviation = np.hypot(width, response) / FWHM
        step = times[1] - times[0]
        below = stats.norm.cdf((times[:, None] + 0.5 * step - 2.0 * np.sort(ranges)[None, ::40] / C) / deviation)
        above = stats.norm.cdf((times[:, None] - 0.5 * step - 2.0 * np.sort(ranges)[None, ::40] / C) / deviation)
        expected = (below - above).mean(axis=1) * signal.sum()
        self.assertLess(np.abs(signal - expected).max() / expected.max(), 2e-3)
        mean = (times * signal).sum() / signal.sum()
        variance = ((times - mean)**2 * signal).sum() / signal.sum()
        own = deviation**2 + np.var(2.0 * ranges / C) + step**2 / 12.0
        self.assertLess(abs(variance / own - 1.0), 2e-3)

    def test_rectangle_on_a_flat_plate(self):
        scan = scan_of([plate(100.0)], {"digitiser_rate": 1e10, "pulse_width": 3e-9})
        shape = {name: scan[name][0] for name in ("echo_width", "echo_rise_time", "echo_amplitude", "echo_integral")}
        energy = scan["return_energy"][0]
        self.assertAlmostEqual(shape["echo_width"] * 1e9, 3.0, delta=0.05)
        self.assertLess(shape["echo_rise_time"], 2e-10)
        self.assertAlmostEqual(shape["echo_amplitude"] * 3e-9 / energy, 1.0, delta=0.01)
        self.assertAlmostEqual(shape["echo_integral"] / energy, 1.0, delta=0.01)
        self.assertIn(scan["echo_samples"].tolist(), ([30], [31]))

    def test_two_plates_merge_where_theory_says(self):
        near, width = 100.0, 4e-9
        for shape, limit in (("Rectangle", 1.0), ("Gaussian", 2.0 / FWHM)):  # Gaussians: two peaks from 2 sigma on
            for share in (0.1, 0.5, 0.8, 0.9, 0.95, 1.1, 1.5, 2.0, 3.0):
                if abs(share - limit) < 0.04:
                    continue
                far = near + 0.5 * C * width * share
                scan = scan_of([plate(near, (-9.0, 0.0)), plate(far, (0.0, 9.0))],
                               {"pulse_shape": shape, "pulse_width": width, "digitiser_rate": 1e10}, waveform_floor=1e-6)
                signal = scan.waveforms.strongest()["signal"]
                signal = np.where(signal > 0.3 * signal.max(), signal, 0.0)
                steps = np.sign(np.diff(np.concatenate([[0.0], (signal / signal.max()).round(5), [0.0]])))
                steps = steps[steps != 0]
                peaks = int(((steps[:-1] > 0) & (steps[1:] < 0)).sum())
                self.assertEqual(peaks, 1 if share < limit else 2, (shape, share))

    def test_walk_of_a_threshold_and_of_a_constant_fraction(self):
        rise = 5e-9  # of samples of 5 ns, through which a rectangle of 5 ns slides
        base = scan_of([plate(100.0)], {"digitiser_rate": 1e9, "pulse_width": 5e-9, "response_time": 2e-9})
        wave = base.waveforms.strongest()
        fractions = [wave.constant_fraction(0.2 * wave["signal"].max(), 0.5, "signal")[0]]
        for share in (0.1, 0.3, 0.6):
            signal = wave["signal"].max()
            found = wave.crossings(share * signal, "signal")[0]
            # The flank is a Gaussian integral of the response about the beginning of the pulse.
            flank = 2.0 * 99.99999 / C - 0.5 * rise + 2e-9 / FWHM * stats.norm.ppf(share)
            self.assertAlmostEqual(found, 0.5 * C * flank, delta=0.02)
            fractions.append(wave.constant_fraction(share * 0.5 * signal, 0.5, "signal")[0])
        self.assertLess(np.ptp(fractions), 1e-9)  # no walk
        # A straight flank has the walk of the sensor's model: w Qlow/Q, w the length of the flank in range.
        ramp = {"pulse_shape": "Samples", "pulse_file_name": self.ramp()}
        wave = scan_of([plate(100.0)], {**ramp, "digitiser_rate": 2e10}).waveforms.strongest()
        signal = wave["signal"].max()
        begin, length = wave.crossings(0.02 * signal, "signal")[0], 0.5 * C * 4e-9
        for share in (0.1, 0.25, 0.5, 0.9):
            walk = wave.crossings(share * signal, "signal")[0] - begin
            self.assertAlmostEqual(walk, length * (share - 0.02), delta=0.02 * length)

    def ramp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = pathlib.Path(folder.name) / "ramp.csv"
        file.write_text("time_s,power\n0,0\n4e-9,1\n4.1e-9,0\n")
        return str(file)

    def test_range_does_not_depend_on_the_shape(self):
        for shape in ({}, {"pulse_shape": "Gaussian"}, {"response_time": 3e-9},
                      {"pulse_shape": "Samples", "pulse_file_name": self.ramp()}):
            scan = scan_of([plate(100.0)], {**shape, "digitiser_rate": 1e10}, waveform_floor=1e-6)
            self.assertAlmostEqual(scan["distance_m"][0], 100.0, delta=1e-4)
            wave = scan.waveforms.strongest()
            mean = (wave["distance_m"] * wave["signal"]).sum() / wave["signal"].sum()
            self.assertAlmostEqual(mean, 100.0, delta=2e-3)


class Noise(unittest.TestCase):
    def beams(self, count):
        angles = np.linspace(0.0, 0.5, count)
        return {"directions": np.column_stack([np.sin(angles), np.cos(angles), np.zeros(count)])}

    def whole(self, scan):
        waves = scan.waveforms
        return [waves.stretch(number) for number in range(waves.number_of_stretches)]

    def test_false_alarms_of_smoothed_noise_follow_rice(self):
        sensor = {**self.beams(40), "range_gate": 3000.0, "digitiser_rate": 4e9, "response_time": 3e-9}
        scan = scan_of([plate(9000.0)], sensor, "Search905", noise=True, waveform_floor=0.0)
        s = 3e-9 / FWHM
        for level in (1.0, 2.0, 3.0):
            crossings = time = 0.0
            values = np.concatenate([one["sample"] for one in self.whole(scan)])
            deviation = values.std()
            for one in self.whole(scan):
                above = one["sample"] > level * deviation
                crossings += (~above[:-1] & above[1:]).sum()
                time += np.ptp(one["sample_time"])
            rate = np.exp(-0.5 * level**2) / (2.0 * np.pi * np.sqrt(2.0) * s)  # Rice, for a Gaussian response
            self.assertLess(abs(crossings - rate * time), 4.0 * np.sqrt(rate * time) + 0.01 * rate * time, level)

    def test_noise_of_a_range_unit_keeps_its_variance(self):
        for response in (0.0, 3e-9):
            sensor = {**self.beams(40), "range_gate": 1500.0, "digitiser_rate": 1e9, "response_time": response}
            scan = scan_of([plate(9000.0)], sensor, "Search905", noise=True, waveform_floor=0.0)
            units = np.concatenate([one["sample"].reshape(-1, 5).sum(axis=1) for one in self.whole(scan)])
            fields = scan.echoes.fields
            electrons = units * fields["receiver_efficiency"] / (6.626e-34 * fields["frequency"])
            background = scan.waveforms["background"][0] * 5.0 * fields["receiver_efficiency"] / (
                6.626e-34 * fields["frequency"])
            own = fields["excess_noise_factor"] * background + fields["amplifier_noise"]**2
            self.assertLess(abs(electrons.var() / own - 1.0), 4.0 * np.sqrt(2.0 / len(units)))

    def test_detection_from_drawn_waveforms_is_that_of_the_filter(self):
        count, range_, half = 3000, 300.2, 0.05
        directions = np.array(self.beams(count)["directions"])
        points, triangles = [], []
        for number, (x, y, _) in enumerate(directions):  # a plate that fills the beam
            points += [(range_ * x + side * y, range_ * y - side * x, up) for side in (-half, half) for up in (-half, half)]
            triangles += [(4 * number, 4 * number + 1, 4 * number + 3), (4 * number, 4 * number + 3, 4 * number + 2)]
        plates = al.mesh(points, triangles)
        for response in (0.0, 2e-9):
            sensor = {"directions": directions, "range_gate": 400.0, "digitiser_rate": 1e9, "response_time": response,
                      "half_beamwidth": 1e-5, "half_beamwidth_across": 0.0}
            loud = scan_of([plates], sensor, "Search905").waveforms.strongest()
            unit = loud["signal"].reshape(-1, 5).sum(axis=1).max()
            energy = al.Sensor("Search905").pulse_energy * loud["threshold"][0] / unit  # half of the beams detect it
            scan = scan_of([plates], {**sensor, "pulse_energy": energy}, "Search905", noise=True, waveform_floor=1e-3)
            seen = set(scan["beam_id"].tolist())
            waves, drawn, expected = scan.waveforms, 0, []
            fields = scan.echoes.fields
            per_joule = fields["receiver_efficiency"] / (6.626e-34 * fields["frequency"])
            background = waves["background"][0] * 5.0 * per_joule
            dark = fields["excess_noise_factor"] * background + fields["amplifier_noise"]**2
            for beam in range(count):
                one = max(waves.of(beam), key=lambda each: each["signal"].max())
                samples = one["sample"].reshape(-1, 5).sum(axis=1)
                mean = one["signal"].reshape(-1, 5).sum(axis=1)
                threshold = one["threshold"][::5]
                found = bool((samples > threshold).any())
                drawn += found
                if response == 0.0:
                    np.testing.assert_allclose(samples, one["energy_received"][::5], rtol=1e-9, atol=1e-25)
                    self.assertTrue(not found or beam in seen)
                noise = np.sqrt(dark + fields["excess_noise_factor"] * mean * per_joule)
                missed = stats.norm.cdf((threshold - mean) * per_joule / noise)
                expected.append(1.0 - np.prod(missed))
            law = float(np.mean(expected))
            self.assertTrue(0.1 < law < 0.9, law)
            spread = np.sqrt(law * (1.0 - law) / count)
            self.assertLess(abs(drawn / count - law), 4.0 * spread)
            self.assertLess(abs(len(seen) / count - law), 4.0 * spread)

    def test_bits(self):
        plain = scan_of([plate(100.0)], {"digitiser_rate": 1e9}, noise=False, waveform_floor=0.0)
        rounded = scan_of([plate(100.0)], {"digitiser_rate": 1e9, "digitiser_bits": 10}, noise=False, waveform_floor=0.0)
        highest = PLAIN["upper_energy_limit"] / 5.0
        step = highest / (1023.0 - 64.0)  # 0 is a level, and 64 of the 1,024 lie below
        codes = rounded.waveforms["sample"] / step
        np.testing.assert_allclose(codes, codes.round(), atol=1e-6)
        difference = np.abs(rounded.waveforms["sample"] - plain.waveforms["sample"]).max()
        self.assertLessEqual(difference, 0.5001 * step)

    def test_poisson_noise_is_divided_among_samples(self):
        sensor = {"noise_photon_rate": 2e10, "lower_energy_limit": 1e-17, "digitiser_rate": 1e9}
        scan = scan_of([plate(9000.0)], sensor, noise=True, waveform_floor=0.0)
        photons = scan.waveforms["sample"] / (6.626e-34 * scan.sensor.frequency)
        np.testing.assert_allclose(photons, photons.round(), atol=1e-6)
        self.assertLess(abs(photons.mean() - 20.0), 4.0 * np.sqrt(20.0 / len(photons)))
        self.assertLess(abs(photons.var() / 20.0 - 1.0), 4.0 * np.sqrt(2.0 / len(photons)))


class Recording(unittest.TestCase):
    def test_stretches_surround_echoes_and_follow_the_floor(self):
        scene = al.example_scene()
        scan = al.Scan(scene, al.Sensor("Search905", position=(0, 0, 3), azimuth_step=1), record_waveforms=True)
        waves, stretches = scan.waveforms, {}
        for number in range(waves.number_of_stretches):
            one = waves.stretch(number)
            self.assertTrue((np.diff(one["distance_m"]) > 0).all())
            np.testing.assert_allclose(np.linalg.norm(one._owner.points[one._place] - one.origin, axis=1),
                                       one["distance_m"], rtol=1e-12)
            stretches.setdefault(one.beam_id, []).append(one["distance_m"][[0, -1]])
        for beam, range_ in zip(scan["beam_id"], scan["distance_m"]):
            self.assertTrue(any(low < range_ < high for low, high in stretches[beam]))
        counts = []
        for floor in (0.01, 0.1, 1.0, 1e9):
            scan.waveform_floor = floor
            counts.append(scan.waveforms.number_of_points)
        self.assertEqual(counts, sorted(counts, reverse=True))
        self.assertGreater(counts[-1], 0)  # around echoes

    def test_threads_pieces_and_movers(self):
        scene = al.example_scene()
        bird = al.mover(al.mesh([(-1, 0, -1), (1, 0, -1), (0, 0, 1)], [(0, 1, 2)]), [(0, 60, 3)])
        found = []
        for threads in (1, 2):
            scan = al.Scan(scene, al.Sensor("Search905", position=(0, 0, 3), azimuth_step=1, digitiser_rate=1e9),
                           movers=[bird], number_of_threads=threads, record_waveforms=True)
            found.append(scan.waveforms)
            self.assertTrue((scan["object_id"] >= 0).any())
        for name in found[0]:
            np.testing.assert_array_equal(found[0][name], found[1][name])
        near = [one for beam in np.unique(found[0].beam_ids) for one in found[0].of(beam)
                if (abs(one["distance_m"][one["signal"].argmax()] - 60) < 1) and abs(one.origin[2] - 3) < 1]
        self.assertTrue(near)

    def test_near_stretches_in_fog_are_parts_of_the_whole_beam(self):
        """Also before and behind a dark plate, whose neighbourhood is looked up for the noise of two stretches."""
        plates = [plate(100.0, (-9.0, -0.03)), plate(109.9, (-0.03, 0.03)), plate(116.0, (0.03, 9.0))]
        for part, kd in zip(plates, (0.2, 1e-12, 0.2)):
            for name, value in (("kd", kd), ("ks", 0.0), ("kp", 1.0)):
                add_array(part.GetCellData(), name, np.full(2, value))
        found = []
        for floor in (1e3, 0.0):
            scan = scan_of(plates, {"digitiser_rate": 1e9, "response_time": 10e-9, "range_gate": 200.0,
                           "half_beamwidth": 1e-3, "half_beamwidth_across": 0.0}, "Search905", None, noise=True,
                           waveform_floor=floor, visibility=2000.0, air_backscatter=True)
            waves = scan.waveforms
            found.append({name: dict(zip(waves["sample_time"].round(12), waves[name]))
                          for name in ("signal", "sample", "energy_received", "threshold")})
            if floor:
                ends = [waves.stretch(number)["distance_m"][[0, -1]] for number in range(waves.number_of_stretches)]
        self.assertTrue(any(108.0 < begin < 109.8 for begin, _ in ends), ends)
        for name, values in found[0].items():
            for time, value in values.items():
                self.assertLess(abs(value - found[1][name][time]), 1e-9 * abs(value) + 1e-25, (name, time))

    def test_writers_keep_shapes_of_echoes(self):
        scan = scan_of([plate(100.0)], {"digitiser_rate": 1e9})
        echoes = scan.waveforms and scan.echoes
        with tempfile.TemporaryDirectory() as folder:
            for suffix in (".las", ".pcd", ".ply", ".vtp"):
                echoes.save(pathlib.Path(folder) / ("echoes" + suffix))
                read = al.load_cloud(pathlib.Path(folder) / ("echoes" + suffix))
                for name in ("echo_width", "echo_rise_time", "echo_amplitude", "echo_integral", "echo_samples"):
                    np.testing.assert_array_equal(read[name], echoes[name], suffix)
                    self.assertEqual(read.units[name], echoes.units[name])

    def test_a_later_scan_without_waveforms_has_none(self):
        scan = scan_of([plate(100.0)])
        self.assertGreater(scan.waveforms.number_of_points, 0)
        scan.record_waveforms = False
        self.assertNotIn("echo_width", scan.echoes)
        self.assertEqual(scan.algorithm.GetOutput(3).GetNumberOfPoints(), 0)

    def test_bad_values_are_named(self):
        for sensor, words in (({"digitiser_rate": 1.1e8}, "digitiser_rate|DigitiserRate"),
                              ({"digitiser_rate": 3e10}, "DigitiserRate"), ({"digitiser_bits": 3}, "DigitiserBits"),
                              ({"digitiser_bits": 8.5}, "DigitiserBits"), ({"response_time": -1e-9}, "ResponseTime"),
                              ({"response_time": 1.0}, "ResponseTime"),
                              ({"pulse_shape": "Samples"}, "number of samples is 0"),
                              ({"pulse_shape": "Samples", "pulse_file_name": "none.csv"}, "none.csv")):
            with self.subTest(sensor=sensor), self.assertRaisesRegex(Exception, words):
                scan_of([plate(100.0)], sensor).update()
        for text, words in (("time_s,power\n0,1\n0,1\n", "after that of the sample before"), ("time_s,power\n0,0\n1e-9,0\n", "more than 0"),
                            ("time,power\n0,0\n", "time_s,power"), ("time_s,power\n0,1\n1,1\n", "1000 times"),
                            ("time_s,power\n0,-1\n1e-9,1\n", "power")):
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / "pulse.csv"
                file.write_text(text)
                with self.assertRaisesRegex(Exception, words):
                    scan_of([plate(100.0)], {"pulse_shape": "Samples", "pulse_file_name": str(file)}).update()
        with self.assertRaisesRegex(Exception, "waveform_floor|WaveformFloor"):
            scan_of([plate(100.0)], waveform_floor=-1.0).update()
        huge = al.Scan(al.example_scene(), al.Sensor("Airport16", digitiser_rate=2e10), record_waveforms=True,
                       waveform_floor=0.0)
        with self.assertRaisesRegex(Exception, "samples of waveforms"):
            huge.update()

    def test_files_and_shell(self):
        with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
            warnings.simplefilter("error")
            folder = pathlib.Path(name)
            scan = scan_of([plate(100.0), plate(140.0, (0.0, 9.0))], {"digitiser_rate": 1e9})
            waves = scan.waveforms
            waves.save(folder / "own.csv")
            rows = list(csv.reader((folder / "own.csv").read_text().splitlines()))
            self.assertEqual(len(rows), 1 + waves.number_of_points)
            column = rows[0].index("signal [J]")
            self.assertEqual([float(row[column]) for row in rows[1:]], [float(f"{x:.15g}") for x in waves["signal"]])
            for suffix in (".vtp", ".png"):
                waves.save(folder / ("own" + suffix))
            self.assertEqual((folder / "own.png").read_bytes()[:4], b"\x89PNG")
            scene = folder / "wall.ply"
            self.write_ply(scene)
            text = io.StringIO()
            with contextlib.redirect_stdout(text):
                code = main(["scan", str(scene), "--sensor", "Search905", "--out", str(folder / "e.csv"), "--waveforms",
                             str(folder / "w.csv"), "--sensor-set", "digitiser_rate=1e9", "--material", "Wall"])
            self.assertEqual(code, 0)
            self.assertRegex(text.getvalue(), r"w\.csv: waveforms of \d+ beams, \d+ stretches with \d+ samples")
            self.assertIn("echo_width", (folder / "e.csv").read_text().splitlines()[0])
            for bad in (["--waveforms", str(folder / "w.xyz")], ["--beam", "3"],
                        ["--waveforms", str(folder / "w.csv"), "--beam", "3"],
                        ["--waveforms", str(folder / "w.png"), "--beam", "99999999"]):
                with contextlib.redirect_stderr(io.StringIO()):
                    self.assertEqual(main(["scan", str(scene), "--out", str(folder / "e.csv"), *bad]), 2)

    def test_the_gull_before_the_hangar(self):
        """Range units separate pulses of 3 ns, and not those of 5 ns."""
        file = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "waveforms", "gull_before_hangar.py")
        text = io.StringIO()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(text):
            runpy.run_path(str(file))["main"](pathlib.Path(folder))
        five, three, _ = (part.split() for part in re.split("beam", text.getvalue())[1:])
        self.assertEqual([five.count("gull"), five.count("hangar")], [0, 1])
        self.assertEqual([three.count("gull"), three.count("hangar")], [1, 1])

    def write_ply(self, file):
        from vtkmodules.vtkIOPLY import vtkPLYWriter
        writer = vtkPLYWriter()
        writer.SetInputData(plate(100.0))
        writer.SetFileName(str(file))
        writer.Write()


if __name__ == "__main__":
    unittest.main()
