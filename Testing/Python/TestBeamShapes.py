# SPDX-License-Identifier: BSD-3-Clause
"""Beams that are not round, at the shipped airport: echoes against rays that NumPy draws and a locator of VTK follows; coverage against birds
that fly; field data, files, orientation."""
import json
import math
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

import avianlidar as al
import scenetools as st

sys.path.insert(0, os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "coverage"))
import flown  # noqa: E402

SHAPES = ({"half_beamwidth": 2e-3, "half_beamwidth_across": 8e-3, "beam_rotation": 30},
          {"half_beamwidth": 8e-3, "half_beamwidth_across": 3e-3, "beam_outline": "Rectangle", "beam_rotation": -20},
          {"half_beamwidth": 8e-3, "half_beamwidth_across": 3e-3, "beam_profile": "Gaussian", "gaussian_truncation": 1.5})
RAYS = 150
KD = 0.5


def rotation(yaw, pitch, roll):
    """Of the documentation: yaw clockwise from north, pitch nose up, roll to the right."""
    y, p, r = np.radians([yaw, pitch, roll])
    c, s = np.cos, np.sin
    return (np.array([[c(y), s(y), 0], [-s(y), c(y), 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c(p), -s(p)], [0, s(p), c(p)]]) @
            np.array([[c(r), 0, s(r)], [0, 1, 0], [-s(r), 0, c(r)]]))


def places(random, shape):
    """Rays of a beam in its half-widths, with their weights."""
    at = random.uniform(-1, 1, (2 * RAYS, 2))
    if shape.get("beam_outline") != "Rectangle":
        at = at[np.sum(at**2, axis=1) <= 1]
    fall = 2 * shape.get("gaussian_truncation", 1)**2 if "beam_profile" in shape else 0
    return at, np.exp(-fall * np.sum(at**2, axis=1))


class Airport(unittest.TestCase):
    def setUp(self):
        self.corners = np.concatenate([st.corners(block) for block in st.Read(st.SHIPPED).blocks])
        surface = al.mesh(self.corners.reshape(-1, 3), np.arange(3 * len(self.corners)).reshape(-1, 3))
        self.scene = al.Scene(surface, material=(KD, 0, 1))
        self.tree = vtkStaticCellLocator()
        self.tree.SetDataSet(surface)
        self.tree.BuildLocator()

    def follow(self, origin, directions):
        """Cosine of incidence where each ray ends; 0 where it does not."""
        found = np.zeros(len(directions))
        t, x, pcoords, sub, cell = mutable(0), [0.0] * 3, [0.0] * 3, mutable(0), mutable(0)
        for i, direction in enumerate(directions):
            if self.tree.IntersectWithLine(origin, origin + 5000 * direction, 1e-9, t, x, pcoords, sub, cell):
                a, b, c = self.corners[cell.get()]
                normal = np.cross(b - a, c - a)
                found[i] = abs(normal @ direction) / np.linalg.norm(normal)
        return found

    def test_echoes_are_those_of_many_rays(self):
        random = np.random.default_rng(8)
        origin, turned = np.array([0.0, 0.0, 20.0]), (40, 3, 25)
        matrix = rotation(*turned)
        for shape in SHAPES:
            sensor = al.Sensor("Airport16", position=origin, orientation=turned, azimuth_step=15, minimum_elevation=-4, elevation_step=1,
                               lower_energy_limit=0, upper_energy_limit=1, sampling_interval=1e-4, range_gate=5000, pulse_width=0, **shape)
            scan = al.Scan(self.scene, sensor, attenuation_coefficient=0, number_of_reflections=1, noise=False, rays_per_beam=400)
            echoes = scan.echoes
            received = dict(zip(echoes["beam_id"].tolist(), zip(echoes["energy_received"], echoes["energy_std_error"])))
            beams = sensor.beams
            off, errors = [], []
            for beam, axis in zip(beams["beam_id"], np.array(beams["direction"])):
                if random.uniform() > 0.15:
                    continue
                at, weight = places(random, shape)
                right = np.cross(axis, matrix[:, 2])
                right /= np.linalg.norm(right)
                up = np.cross(right, axis)
                turn = math.radians(shape.get("beam_rotation", 0))
                widths = np.tan([shape["half_beamwidth"], shape.get("half_beamwidth_across", shape["half_beamwidth"])])
                along, across = math.cos(turn) * right + math.sin(turn) * up, math.cos(turn) * up - math.sin(turn) * right
                rays = axis + widths[0] * at[:, :1] * along + widths[1] * at[:, 1:] * across
                cosine = self.follow(origin, rays / np.linalg.norm(rays, axis=1)[:, None])
                share = np.sum(weight * cosine) / weight.sum()
                error = np.sqrt(np.sum((weight * (cosine - share))**2)) / weight.sum()
                energy, stated = received.get(int(beam), (0.0, 0.0))
                off.append(energy / (KD * sensor.pulse_energy) - share)
                errors.append(math.hypot(error, stated / (KD * sensor.pulse_energy)))
            off, errors = np.array(off), np.array(errors)
            lit = errors > 1e-9
            with self.subTest(**shape):
                self.assertGreater(lit.sum(), 20)
                self.assertLess(np.max(np.abs(off) / (4 * errors + 2e-3)), 1.0)
                self.assertLess(abs(off[lit].mean()), 3.5 * np.sqrt(np.sum(errors[lit]**2)) / lit.sum() + 2e-4)


class Coverage(unittest.TestCase):
    NOTHING = al.Scene(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), material="Wall")

    def test_birds_are_seen_as_often_as_is_stated(self):
        random = np.random.default_rng(4)
        for shape in ({"half_beamwidth": 1e-3, "half_beamwidth_across": 3e-3, "beam_outline": "Rectangle", "beam_rotation": -20},
                      {"half_beamwidth": 4e-3, "half_beamwidth_across": 2e-3, "beam_profile": "Gaussian", "gaussian_truncation": 1.5}):
            sensor = al.Sensor("Search905", azimuth_step=0.75, pulse_energy=3e-5, **shape)
            azimuth, elevation = random.uniform(0, 2 * np.pi, 100), np.radians(random.uniform(0.5, 5, 100))
            away = random.uniform(150, 450, 100)
            places = away[:, None] * np.column_stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth),
                                                      np.sin(elevation)])
            cover = al.Coverage(self.NOTHING, sensor, places=places, species="herring gull", visibility=0, attenuation_coefficient=8.9e-5)
            stated = cover["detection_probability"].astype(float)
            seen, _ = flown.fly(self.NOTHING, sensor, places, 6, "herring gull", 8.9e-5, 400)
            with self.subTest(**shape):
                self.assertGreater(np.count_nonzero((stated > 0.05) & (stated < 0.95)), 20)
                error = np.sqrt(np.mean(stated * (1 - stated)) / 6 / len(places)) + 0.01
                self.assertLess(abs(np.mean(seen - stated)), 3 * error)

    def test_what_is_kept_follows_every_number(self):
        random = np.random.default_rng(5)
        places = np.column_stack([random.uniform(-300, 300, (500, 2)), random.uniform(5, 40, 500)])
        sensor = al.Sensor("Airport16", receiver_aperture=0.01, half_beamwidth=5e-4, half_beamwidth_across=8e-3)
        kept = al.Coverage(self.NOTHING, sensor, places=places, species="herring gull")
        kept["detection_probability"]
        for name, value in (("half_beamwidth", 4e-3), ("half_beamwidth_across", 6e-3), ("beam_rotation", 50), ("beam_outline", "Rectangle"),
                            ("orientation", (0, 0, 90)), ("beam_profile", "Gaussian"), ("gaussian_truncation", 2)):
            sensor.set(**{name: value})
            new = al.Coverage(self.NOTHING, sensor, places=places, species="herring gull")
            for array in ("detection_probability", "beams_per_scan", "status"):
                np.testing.assert_array_equal(kept[array], new[array], f"{array} after {name}")


class Sensors(unittest.TestCase):
    def test_shapes_are_in_field_data_and_files(self):
        sensor = al.Sensor("Airport16", half_beamwidth=2e-3, half_beamwidth_across=1e-3, beam_outline="Rectangle", beam_rotation=20,
                           gaussian_truncation=2, beam_profile="Gaussian")
        fields = sensor.beams.fields
        self.assertEqual([float(fields[name]) for name in ("half_beamwidth_across", "beam_outline", "beam_rotation", "gaussian_truncation")],
                         [1e-3, 1, 20, 2])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "mine.lidarsensor.json"
            file.write_text(json.dumps({"format": "lidarsensor 1", "name": "Mine", "values": {
                name: {"value": float(fields[name]), "unit": unit, "source": "made"} for name, unit in (
                    ("half_beamwidth", "rad"), ("half_beamwidth_across", "rad"), ("beam_outline", "1"), ("beam_rotation", "deg"),
                    ("beam_profile", "1"), ("gaussian_truncation", "1"))}}))
            read = al.Sensor(file).beams.fields
            for name in ("half_beamwidth_across", "beam_outline", "beam_rotation", "gaussian_truncation", "beam_profile"):
                self.assertEqual(float(read[name]), float(fields[name]))


if __name__ == "__main__":
    unittest.main()
