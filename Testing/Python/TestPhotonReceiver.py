# SPDX-License-Identifier: BSD-3-Clause
"""The photon receiver through the filters: presets are files, files that are wrong say where, echoes have electrons,
and a changed receiver traces nothing. False alarms of empty sky are the kernel's."""
import json
import os
import pathlib
import re
import unittest
import warnings

import jsonschema
import numpy as np

import avianlidar
from avianlidar import Error, Scan, Sensor
from echotools import InFolder, box

SENSORS = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Filters" / "Sensors"
FILES = sorted(SENSORS.glob("*.lidarsensor.json"))
PLANCK = 6.626e-34  # J s, the paper's


def wall():
    return avianlidar.Scene(box((150, 0, 0), (1, 100, 20)))


def text_of(sensor):
    """All properties; without the address of the object."""
    return str(sensor.algorithm).split("\n", 1)[1]


class Files(InFolder):
    def setUp(self):
        super().setUp()
        self.good = json.loads((SENSORS / "Search905.lidarsensor.json").read_text("utf-8"))

    def load(self, content):
        (self.folder / "own.lidarsensor.json").write_text(json.dumps(content), "utf-8")
        return Sensor("own.lidarsensor.json")

    def test_presets_are_the_files(self):
        self.assertEqual({file.name.split(".")[0] for file in FILES}, set(Sensor.presets()))
        for file in FILES:
            preset, loaded = Sensor(file.name.split(".")[0]), Sensor(file)
            for name, value in preset.properties().items():
                self.assertEqual(value, loaded.properties()[name], (file.name, name))
            self.assertEqual(preset.beams.fields.get("assumed"), loaded.beams.fields.get("assumed"))

    def test_every_number_has_a_unit_and_a_source(self):
        schema = json.loads((SENSORS / "lidarsensor.schema.json").read_text("utf-8"))
        jsonschema.Draft202012Validator.check_schema(schema)
        with self.assertRaises(jsonschema.ValidationError):
            jsonschema.validate({**self.good, "values": {"pulse_energy": {"value": 1, "unit": "mJ", "source": "x"}}},
                                schema)
        for file in FILES:
            jsonschema.validate(json.loads(file.read_text("utf-8")), schema)
            values = json.loads(file.read_text("utf-8"))["values"]
            fields = Sensor(file).beams
            for name, entry in values.items():
                self.assertEqual(set(entry), {"value", "unit", "source"})
                self.assertEqual(entry["unit"], fields.field_units[name] or "1", (file.name, name))
                np.testing.assert_allclose(fields.fields[name], entry["value"], rtol=1e-12)

    def test_what_is_assumed_says_so_until_it_is_changed(self):
        sensor = Sensor("Search905")
        self.assertIn("amplifier_noise", sensor.beams.fields["assumed"])
        self.assertNotIn("pulse_energy", sensor.beams.fields["assumed"])
        sensor.amplifier_noise = 10.0
        self.assertNotIn("amplifier_noise", sensor.beams.fields["assumed"])
        self.assertNotIn("assumed", Sensor("Airport16").beams.fields)
        self.good["values"].update({"channel_elevations": {"value": [1, 2], "unit": "deg", "source": "assumed"},
                                    "beam_profile": {"value": 1, "unit": "1", "source": "assumed"}})
        sensor = self.load(self.good)
        self.assertLessEqual({"channel_elevations", "beam_profile"}, set(sensor.beams.fields["assumed"]))
        sensor.set(channel_elevations=(1, 3), beam_profile="Uniform")
        self.assertFalse({"channel_elevations", "beam_profile"} & set(sensor.beams.fields["assumed"]))
        self.assertIn("receiver_efficiency",
                      Sensor("Airport16", receiver_model="Photons", receiver_aperture=0.01).beams.fields["assumed"])

    def test_channels_and_sectors_of_ones_own(self):
        self.good["values"].update({
            "channel_elevations": {"value": [0, 2, 1], "unit": "deg", "source": "test"},
            "channel_azimuth_offsets": {"value": [1, 0, -1], "unit": "deg", "source": "test"},
            "channel_firing_times": {"value": [0, 2e-5, 1e-5], "unit": "s", "source": "test"},
            "blanked_sectors": {"value": [90, 180], "unit": "deg", "source": "assumed"}})
        sensor = self.load(self.good)
        sensor.azimuth_step = 10.0
        beams = sensor.beams
        self.assertEqual(beams.number_of_points, 27 * 3)
        column, channel = np.divmod(beams["beam_id"], 3)
        self.assertEqual(set(range(36)) - set(column), set(range(9, 18)))
        np.testing.assert_allclose(beams["azimuth"], 100 * ((10 * column + np.array([1, 0, -1])[channel]) % 360))
        np.testing.assert_allclose(beams["timestamp"], 1e6 * (column * 2 / 36 + np.array([0, 2e-5, 1e-5])[channel]))
        self.assertIn("blanked_sectors", beams.fields["assumed"])
        self.assertEqual(list(beams.fields["blanked_sectors"]), [90, 180])
        # A range image has a column for each step, however the offsets are grouped, and nothing where no beam is.
        self.good["values"]["channel_azimuth_offsets"]["value"] = [0.1, 0.1, -0.1]
        grouped = self.load(self.good)
        grouped.azimuth_step = 10.0
        for one in (grouped, sensor):
            image = Scan(wall(), one, noise=False).range_image()["distance_m"]
            self.assertEqual(image.shape, (3, 36))
            self.assertTrue(np.isnan(image[:, 9:18]).all())
        sensor.algorithm.SetPresetToAirport16()  # which has none of this
        self.assertEqual(sensor.beams.number_of_points, 15360)

    def test_bad_files_name_the_key_and_change_nothing(self):
        def values(**entries):
            return {**self.good, "values": {name: {"value": value, "unit": unit, "source": "test"}
                                            for name, (value, unit) in entries.items()}}

        cases = [({**self.good, "format": "lidarsensor 2"}, "format: "),
                 ({**self.good, "wings": 2}, "wings: unknown key"),
                 ({key: value for key, value in self.good.items() if key != "name"}, "name: is missing"),
                 (values(pulse_energi=(1, "J")), "values.pulse_energi: "),
                 (values(pulse_energy=(1, "mJ")), "values.pulse_energy: its unit is \"mJ\""),
                 (values(pulse_energy=(-1, "J")), "PulseEnergy is -1"),
                 (values(number_of_channels=(1.5, "1")), "values.number_of_channels: "),
                 (values(azimuth_range=([1], "deg")), "values.azimuth_range: "),
                 (values(receiver_model=(1, "1")), "ReceiverAperture is 0"),
                 (values(channel_firing_times=([0], "s")), "ChannelFiringTimes has 1 values"),
                 ([], "must be an object")]
        sensor = Sensor("CorridorC16")
        before = text_of(sensor)
        for content, words in cases:
            with self.subTest(words), self.assertRaisesRegex(Error, "own.lidarsensor.json(.|\n)*" + re.escape(words)):
                self.load(content)
            self.assertFalse(sensor.algorithm.LoadSensor("own.lidarsensor.json"))
        self.assertEqual(text_of(sensor), before)
        self.assertEqual(self.load(self.good).wavelength, 905)


class Receiver(unittest.TestCase):
    def test_echoes_have_electrons_and_their_ratio_to_noise(self):
        sensor = Sensor("Search905")
        echoes = Scan(wall(), sensor).echoes
        fields = sensor.beams.fields
        per_joule = fields["receiver_efficiency"] / (PLANCK * fields["frequency"])
        electrons = echoes["photoelectrons"]
        self.assertGreater(len(electrons), 1000)
        np.testing.assert_allclose(electrons, per_joule * echoes["energy_received"], rtol=1e-12)
        np.testing.assert_allclose(echoes["signal_to_noise"], electrons / np.sqrt(119.062**2 + 3 * electrons),
                                   rtol=1e-5)
        self.assertGreater(electrons.min(), 664.069 * (1 - 1e-4))
        self.assertNotIn("photoelectrons", Scan(wall(), Sensor("Airport16")).echoes)

    def test_a_changed_receiver_traces_nothing_and_gives_what_a_fresh_one_does(self):
        changes = {"receiver_efficiency": 0.3, "background_radiance": 0.0, "wavelength": 1064.0,
                   "receiver_aperture": 0.005, "sampling_interval": 4e-9, "receiver_model": "EnergyLimits"}
        settings = {"beam_samples": "rays", "rays_per_beam": 40}
        scene, sensor = wall(), Sensor("Search905", azimuth_step=1.5)
        known = Scan(scene, sensor, **settings)
        known.update()
        self.assertGreater(known.number_of_traced_rays, 0)
        changed = {}
        for name, value in changes.items():
            with self.subTest(name):
                setattr(sensor, name, value)
                changed[name] = value
                fresh = Scan(scene, Sensor("Search905", azimuth_step=1.5, **changed), **settings)
                known.update()
                self.assertEqual(known.number_of_traced_rays, 0)
                for array in fresh.echoes:
                    np.testing.assert_array_equal(fresh.echoes[array], known.echoes[array])
                self.assertEqual(repr(dict(fresh.echoes.fields)), repr(dict(known.echoes.fields)))

    def test_few_electrons_are_warned_of_once(self):
        # 3.5 electrons of background: by SciPy a Poisson number exceeds the threshold 1,525 times as often as was asked
        # for.
        few = Sensor("Search905", amplifier_noise=0.0, excess_noise_factor=1.0,
                     background_radiance=0.05 * 3.5 / 3525.22)
        with self.assertWarnsRegex(RuntimeWarning, r"some 1\d\d\d times the FalseAlarmsPerScan") as caught:
            few.beams.number_of_points
        self.assertEqual(len(caught.warnings), 1)
        for sensor, words in ((Sensor("Search1550"),
                               "RangeGate is 4000 m, but the next pulse leaves after 15 us, that is 2248 m"),
                              (Sensor("Automotive16"), "RangeGate is 300 m.*1.3 us")):
            with self.assertWarnsRegex(RuntimeWarning, words):
                sensor.beams.number_of_points
        few.position = (0, 0, 3)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for sensor in (few, Sensor("Search905"), Sensor("Airport16"), Sensor("Search1550", range_gate=2248)):
                self.assertGreater(sensor.beams.number_of_points, 0)
        few.amplifier_noise = 0.1
        with self.assertWarns(RuntimeWarning):  # another number
            few.beams.number_of_points

    def test_limits_from_a_data_sheet(self):
        sensor = Sensor("Airport16", receiver_aperture=0.01, pulse_energy=1e-6)
        sensor.algorithm.SetLimitsFromDataSheet(200.0, 0.1, 1e-4)
        energy = 1e-6 * 0.1 * 0.01 / (np.pi * 200.0**2) * np.exp(-2 * 1e-4 * 200.0)
        self.assertAlmostEqual(sensor.lower_energy_limit / energy, 1, delta=1e-12)
        self.assertAlmostEqual(sensor.upper_energy_limit / energy, 1e4, delta=1e-6)
        clear = 3.912 / 23e3 * (sensor.wavelength / 550) ** -1.3  # by default, at the sensor's wavelength
        sensor.algorithm.SetLimitsFromDataSheet(200.0, 0.1)
        self.assertAlmostEqual(sensor.lower_energy_limit / energy, np.exp(-2 * (clear - 1e-4) * 200.0), delta=1e-12)
        sensor.algorithm.SetLimitsFromDataSheet(200.0, 0.1, 1e-4)
        # The last lets nothing through.
        for bad in ((0.0, 0.1), (200.0, 1.5), (200.0, 0.1, -1.0), (float("nan"), 0.1), (4000.0, 0.1, 1.0)):
            sensor.algorithm.SetLimitsFromDataSheet(*bad)
        self.assertAlmostEqual(sensor.lower_energy_limit / energy, 1, delta=1e-12)
