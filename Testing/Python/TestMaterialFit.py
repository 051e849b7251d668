# SPDX-License-Identifier: BSD-3-Clause
"""Materials fitted to measured tables: the fit's models are those of the scan, cells of MERL tables lie where its
authors put them, known coefficients come back with and without noise, and files that are wrong are one line each."""
import contextlib
import io
import json
import unittest

import numpy as np
from scipy.spatial.transform import Rotation

import avianlidar as al
import exampletools  # noqa: F401  (finds the examples)
import check_fit
import fit
import running
from echotools import InFolder

MODELS = ("LambertBlinnPhong", "Phong", "Microfacet")
# kd, ks, kp: glossy, a mirror, broad.
MATERIALS = ((0.15, 0.05, 112.0), (0.02, 0.85, 8046.0), (0.3, 0.03, 20.0))


def merl_cell(source, viewer):
    """Number of the cell of two unit vectors: by the rotations of Rusinkiewicz and the indices of Matusik's reader."""
    half = (source + viewer) / np.linalg.norm(source + viewer)
    theta, phi = np.arccos(half[2]), np.arctan2(half[1], half[0])
    difference = Rotation.from_euler("zy", (-phi, -theta)).apply(source)
    theta_d, phi_d = np.arccos(min(difference[2], 1.0)), np.arctan2(difference[1], difference[0]) % np.pi
    i = int(np.sqrt(np.degrees(theta) / 90 * 90 * 90))
    j, k = int(np.degrees(theta_d)), int(np.degrees(phi_d))
    return (i * 90 + j) * 180 + k


class Models(unittest.TestCase):
    def test_they_are_those_of_the_scan(self):
        """A plate turned by an angle, looked at by one narrow beam through an aperture: energy r2/A is 1/sr."""
        distance, aperture, pulse = 100.0, 0.01, 1e-3
        sensor = al.Sensor("CorridorC16", channel_elevations=[0.0], azimuth_range=(90.0, 90.5), azimuth_step=1.0,
                           half_beamwidth=1e-6, pulse_energy=pulse, receiver_aperture=aperture,
                           lower_energy_limit=1e-30, upper_energy_limit=1.0, pulse_width=0.0)
        for angle in (0.0, 2.0, 60.0):
            turn = np.radians(angle)
            along = np.array([-np.sin(turn), np.cos(turn), 0.0])
            corners = [np.array([distance, 0, 0]) + i * along + j * np.array([0, 0, 1.0])
                       for i, j in ((-20, -20), (20, -20), (20, 20), (-20, 20))]
            g = fit.Geometry.of(*[np.array([[np.sin(turn), 0, np.cos(turn)]])] * 2)
            for material in MATERIALS:
                scene = al.Scene((corners, [(0, 1, 2), (0, 2, 3)]), material=material)
                for model in MODELS:
                    scan = al.Scan(scene, sensor, reflectance_model=model, attenuation_coefficient=0.0, noise=False,
                                   number_of_reflections=1)
                    self.assertEqual(len(scan["return_energy"]), 1)
                    seen = scan["return_energy"][0] / pulse * distance**2 / aperture
                    np.testing.assert_allclose(fit.reflected(model, material, g)[0], seen, rtol=1e-3,
                                               err_msg=f"{angle} {material} {model}")


class Merl(InFolder):
    def setUp(self):
        super().setUp()
        self.g, _ = fit.merl_geometry((1, 1, 1))

    def test_cells_lie_where_its_authors_put_them(self):
        half, difference, azimuth = np.unravel_index(np.arange(0, self.g.cos_lobe.size, 7919), fit.MERL_SHAPE)
        for i, j, k in zip(half, difference, azimuth):
            theta = np.radians((i + 0.5)**2 / 90)
            along = fit.directions(np.radians([j + 0.5]), np.radians([k + 0.5]))[0]
            turn = np.array([[np.cos(theta), 0, np.sin(theta)], [0, 1, 0], [-np.sin(theta), 0, np.cos(theta)]])
            source, viewer = turn @ along, turn @ (along * (-1, -1, 1))
            number = (i * 90 + j) * 180 + k
            if min(source[2], viewer[2]) <= 0:
                continue
            self.assertEqual(merl_cell(source, viewer), number)
            self.assertAlmostEqual(self.g.cos_incidence[number], source[2], places=12)
            self.assertAlmostEqual(self.g.cos_lobe[number], (source * (-1, -1, 1)) @ viewer, places=12)

    def write(self, brdf):
        file = self.folder / "made.binary"
        check_fit.write_merl(file, np.where(self.g.cos_outgoing > 0, brdf, -1.0))
        return file

    def test_coefficients_come_back(self):
        random = np.random.default_rng(2)
        for model, material, noise, tolerance in zip(MODELS, MATERIALS, (0.0, 0.0, 0.1), (1e-4, 1e-4, 0.03)):
            with self.subTest(model=model, material=material, noise=noise):
                exact = fit.reflected(model, material, self.g) / np.maximum(self.g.cos_outgoing, 1e-6)
                found, log, *_ = check_fit.fitted(self.write(exact * random.lognormal(0, noise, exact.size)),
                                                  model=model)
                np.testing.assert_allclose(found, material, rtol=tolerance)
                self.assertAlmostEqual(log, noise, delta=1e-4 + 0.05 * noise)


class Command(InFolder):
    def table(self, name, header, rows):
        file = self.folder / name
        file.write_text("\n".join([header, *(",".join(f"{value:.10g}" for value in row) for row in rows)]) + "\n",
                        "utf-8")
        return file

    def run_it(self, *arguments):
        with contextlib.redirect_stdout(io.StringIO()) as said:
            fit.main([*map(str, arguments), "-o", str(self.folder / "out")])
        return said.getvalue()

    def test_tables_as_csv_and_the_scene_that_reads_the_result(self):
        kd, ks, kp = material = (0.15, 0.05, 112.0)
        angles = np.arange(0, 80, 1.0)
        back = [(a, (kd / np.pi * np.cos(t) + ks * (kp + 1) / (2 * np.pi) * max(np.cos(2 * t), 0)**kp) / np.cos(t))
                for a in angles for t in [np.radians(a)]]
        one = self.table("back.csv", "incidence,brdf", back)
        said = self.run_it(one, "--within", 180)
        written = json.loads((self.folder / "out" / "materials.json").read_text("utf-8"))
        self.assertIn(json.dumps(written, indent=2), said)
        np.testing.assert_allclose([written["materials"]["back"][key] for key in ("kd", "ks", "kp")], material,
                                   rtol=1e-4)
        self.assertGreater((self.folder / "out" / "back.png").stat().st_size, 5000)
        scene = {"version": 1, **written, "objects": [{"ground": {"size": 10}, "material": "back"}]}
        file = self.folder / "made.lidarscene.json"
        file.write_text(json.dumps(scene), "utf-8")
        ground = running.read_scene(file).GetOutput().GetBlock(0).GetCellData()
        self.assertEqual([ground.GetArray(key).GetTuple1(0) for key in ("kd", "ks", "kp")],
                         [written["materials"]["back"][key] for key in ("kd", "ks", "kp")])

    def test_bad_files_are_one_line_that_names_them(self):
        short = self.folder / "short.binary"
        short.write_bytes(np.array([90, 90, 180], "<i4").tobytes() + bytes(100))
        for file, words in ((short, "expected a MERL table"), (self.folder / "none.csv", "No such file"),
                            (self.table("t.txt", "", []), "expected a table"),
                            (self.table("head.csv", "angle,brdf", []), "expected the header"),
                            (self.table("width.csv", "incidence,brdf", [(1, 2, 3)]), "line 2: expected 2 numbers"),
                            (self.table("angle.csv", "incidence,brdf", [(1, 1), (91, 1)]), "line 3: expected angles"),
                            (self.table("few.csv", "incidence,brdf", [(1, 1), (85, 1)]), "1 values above 0")):
            with self.subTest(file.name), self.assertRaises((OSError, ValueError)) as caught:
                self.run_it(file)
            self.assertRegex(str(caught.exception), f"{words}.*{file.name}|{file.name}.*{words}")
            self.assertFalse((self.folder / "out").exists())
