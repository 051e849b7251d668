# SPDX-License-Identifier: BSD-3-Clause
"""Materials fitted to measured tables: the fit's models are those of the scan, cells of MERL tables lie where its authors put
them, known coefficients come back with and without noise, and files that are wrong are one line each. With
AVIANLIDAR_DATA_DIR also a row of the documented table."""
import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import avianlidar as al
import exampletools
import check_fit
import fit
import running

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
MODELS = ("LambertBlinnPhong", "Phong", "Microfacet")
# kd, ks, kp: glossy, a mirror, broad, dark.
MATERIALS = ((0.15, 0.05, 112.0), (0.02, 0.85, 8046.0), (0.3, 0.03, 20.0), (0.003, 0.001, 5.0))


def merl_cell(source, viewer):
    """Number of the cell of two unit vectors: by the rotations of Rusinkiewicz and the indices of Matusik's reader."""
    half = (source + viewer) / np.linalg.norm(source + viewer)
    theta, phi = np.arccos(half[2]), np.arctan2(half[1], half[0])

    def turned(v, angle, axis):
        c, s = np.cos(angle), np.sin(angle)
        rows = {"z": [[c, -s, 0], [s, c, 0], [0, 0, 1]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
        return np.array(rows[axis]) @ v

    difference = turned(turned(source, -phi, "z"), -theta, "y")
    theta_d, phi_d = np.arccos(min(difference[2], 1.0)), np.arctan2(difference[1], difference[0]) % np.pi
    i = int(np.sqrt(np.degrees(theta) / 90 * 90 * 90))
    j, k = int(np.degrees(theta_d)), int(np.degrees(phi_d))
    return (i * 90 + j) * 180 + k


class Models(unittest.TestCase):
    def test_they_are_those_of_the_scan(self):
        """A plate turned by an angle, looked at by one narrow beam through an aperture: energy r2/A is 1/sr."""
        distance, aperture, pulse = 100.0, 0.01, 1e-3
        sensor = al.Sensor("CorridorC16", channel_elevations=[0.0], azimuth_range=(90.0, 90.5), azimuth_step=1.0,
                           half_beamwidth=1e-6, pulse_energy=pulse, receiver_aperture=aperture, lower_energy_limit=1e-30,
                           upper_energy_limit=1.0, pulse_width=0.0)
        for angle in (0.0, 2.0, 20.0, 60.0):
            turn = np.radians(angle)
            along = np.array([-np.sin(turn), np.cos(turn), 0.0])
            corners = [np.array([distance, 0, 0]) + i * along + j * np.array([0, 0, 1.0])
                       for i, j in ((-20, -20), (20, -20), (20, 20), (-20, 20))]
            g = fit.Geometry.of(*[np.array([[np.sin(turn), 0, np.cos(turn)]])] * 2)
            for material in MATERIALS:
                scene = al.Scene((corners, [(0, 1, 2), (0, 2, 3)]), material=material)
                for model in MODELS:
                    with self.subTest(angle=angle, material=material, model=model):
                        scan = al.Scan(scene, sensor, reflectance_model=model, attenuation_coefficient=0.0, noise=False,
                                       number_of_reflections=1)
                        self.assertEqual(len(scan["return_energy"]), 1)
                        seen = scan["return_energy"][0] / pulse * distance**2 / aperture
                        np.testing.assert_allclose(fit.reflected(model, material, g)[0], seen, rtol=1e-3)

    def test_geometry(self):
        random = np.random.default_rng(1)
        source, viewer = (fit.directions(np.arccos(random.uniform(0.05, 1, 500)), random.uniform(0, 7, 500)) for _ in range(2))
        g = fit.Geometry.of(source, viewer)
        mirror = 2 * source[:, 2:] * (0, 0, 1) - source
        np.testing.assert_allclose(g.cos_lobe, (mirror * viewer).sum(axis=1), atol=1e-14)
        np.testing.assert_allclose(g.sin2_lobe, 1 - g.cos_lobe**2, atol=1e-14)
        np.testing.assert_allclose(np.cos(np.radians(g.off_back())), (source * viewer).sum(axis=1), atol=1e-12)
        np.testing.assert_allclose(g.sin2_half, 1 - ((source + viewer)[:, 2] / np.linalg.norm(source + viewer, axis=1))**2,
                                   atol=1e-14)


class Merl(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.g, _ = fit.merl_geometry((1, 1, 1))

    def test_cells_lie_where_its_authors_put_them(self):
        half, difference, azimuth = np.unravel_index(np.arange(0, self.g.cos_lobe.size, 7919), fit.MERL_SHAPE)
        for i, j, k in zip(half, difference, azimuth):
            theta, along = np.radians((i + 0.5)**2 / 90), fit.directions(np.radians([j + 0.5]), np.radians([k + 0.5]))[0]
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
        for model in MODELS:
            for material in MATERIALS:
                exact = fit.reflected(model, material, self.g) / np.maximum(self.g.cos_outgoing, 1e-6)
                for noise, tolerance in ((0.0, 1e-4), (0.1, 0.03)):
                    with self.subTest(model=model, material=material, noise=noise):
                        table = self.write(exact * random.lognormal(0, noise, exact.size))
                        found, log, *_ = check_fit.fitted(table, model=model)
                        np.testing.assert_allclose(found, material, rtol=tolerance)
                        self.assertAlmostEqual(log, noise, delta=1e-4 + 0.05 * noise)

    def test_a_half_vector_lobe_straight_back_has_a_quarter_of_the_exponent(self):
        """cos^n of theta is cos^(n/4) of 2 theta near the peak, and (n + 2) ks = (n/4 + 1) 4 ks about."""
        for kd, ks, n in ((0.0864, 0.015, 1290.0), (0.293, 0.00424, 1250.0)):  # alum-bronze, yellow-matte-plastic
            found, log, *_ = check_fit.fitted(self.write(check_fit.blinn_phong(self.g, kd, ks, n)), within=2.0)
            np.testing.assert_allclose(found, (kd, 4 * ks, n / 4), rtol=0.01)
            self.assertLess(log, 0.02)
            # To all directions the model cannot follow, and the misfit says so.
            self.assertGreater(check_fit.fitted(self.folder / "made.binary", within=180.0)[1], 0.3)

    def test_channels(self):
        counts = np.arange(3.0 * self.g.cos_lobe.size)
        file = self.folder / "made.binary"
        with file.open("wb") as stream:
            np.array(fit.MERL_SHAPE, "<i4").tofile(stream)
            counts.tofile(stream)
        for start, (channel, scale) in enumerate((("red", 1 / 1500), ("green", 1.15 / 1500), ("blue", 1.66 / 1500))):
            _, values = fit.read_table(file, channel)
            self.assertAlmostEqual(values[0], scale * start * self.g.cos_lobe.size)

    def test_no_more_comes_back_than_went_in(self):
        for error in ("log", "linear"):
            usable = fit.is_usable(self.g, self.g.cos_lobe * 0 + 5.0)
            g = self.g[usable][::50]
            kd, ks, kp = fit.fit("LambertBlinnPhong", g, 5.0 * g.cos_outgoing, error)
            self.assertLessEqual(kd + ks, 1.0)
            self.assertTrue(kd >= 0 and ks >= 0 and 0 <= kp <= 1e6)
            self.assertGreater(kd + ks, 0.99)

    def test_a_matt_table_has_no_lobe(self):
        kd, ks, kp = check_fit.fitted(self.write(0.4 / np.pi * np.ones(self.g.cos_lobe.size)), within=2.0)[0]
        self.assertAlmostEqual(kd, 0.4, delta=0.002)
        self.assertEqual((ks, kp), (0.0, 0.0))


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def table(self, name, header, rows):
        file = self.folder / name
        file.write_text("\n".join([header, *(",".join(f"{value:.10g}" for value in row) for row in rows)]) + "\n", "utf-8")
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
        rows = []
        for i in angles[::4]:
            for o in angles[::4]:
                for p in (0.0, 90.0, 150.0, 180.0):
                    ti, to, phi = np.radians([i, o, p])
                    # The mirror direction is at the source's angle, on the other side.
                    lobe = np.cos(ti) * np.cos(to) - np.sin(ti) * np.sin(to) * np.cos(phi)
                    share = kd / np.pi * np.cos(ti) + ks * (kp + 1) / (2 * np.pi) * max(lobe, 0)**kp
                    rows.append((i, o, p, share / np.cos(to)))
        other = self.table("all.csv", "Incidence, View, Azimuth, BRDF", rows)
        said = self.run_it(one, other, "--within", 180)
        written = json.loads((self.folder / "out" / "materials.json").read_text("utf-8"))
        self.assertIn(json.dumps(written, indent=2), said)
        for name in ("back", "all"):
            found = written["materials"][name]
            np.testing.assert_allclose([found[key] for key in ("kd", "ks", "kp")], material, rtol=1e-4)
            self.assertGreater((self.folder / "out" / f"{name}.png").stat().st_size, 5000)
        scene = {"version": 1, **written, "objects": [{"ground": {"size": 10}, "material": "back"}]}
        file = self.folder / "made.lidarscene.json"
        file.write_text(json.dumps(scene), "utf-8")
        ground = running.read_scene(file).GetOutput().GetBlock(0).GetCellData()
        self.assertEqual([ground.GetArray(key).GetTuple1(0) for key in ("kd", "ks", "kp")],
                         [written["materials"]["back"][key] for key in ("kd", "ks", "kp")])

    def test_bad_files_are_one_line_that_names_them(self):
        short = self.folder / "short.binary"
        short.write_bytes(np.array([90, 90, 180], "<i4").tobytes() + bytes(100))
        other = self.folder / "other.binary"
        other.write_bytes(np.array([2, 2, 2], "<i4").tobytes() + bytes(192))
        cases = ((short, "expected a MERL table"), (other, "expected a MERL table"),
                 (self.folder / "none.csv", "No such file"), (self.table("t.txt", "", []), "expected a table"),
                 (self.table("head.csv", "angle,brdf", []), "expected the header incidence,view,azimuth,brdf"),
                 (self.table("empty.csv", "incidence,brdf", []), "no lines below the header"),
                 (self.table("width.csv", "incidence,brdf", [(1, 2, 3)]), "line 2: expected 2 numbers"),
                 (self.table("nan.csv", "incidence,brdf", [(1, np.nan)]), "line 2: expected 2 numbers"),
                 (self.table("angle.csv", "incidence,brdf", [(1, 1), (91, 1)]), "line 3: expected angles"),
                 (self.table("few.csv", "incidence,brdf", [(1, 1), (2, -1), (85, 1)]), "1 values above 0"))
        for file, words in cases:
            with self.subTest(file.name):
                done = subprocess.run([sys.executable, fit.__file__, str(file), "-o", str(self.folder / "bad")],
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, f"^fit.py: .*{file.name}.*\n$")
                self.assertIn(words, done.stderr)
                self.assertFalse((self.folder / "bad").exists())

    @unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is not set")
    def test_the_documented_row(self):
        name = "yellow-matte-plastic"
        with contextlib.redirect_stdout(io.StringIO()):
            check_fit.main(["--only", name, "-o", str(self.folder / "check")])
        with (self.folder / "check" / "materials-all.md").open(encoding="utf-8") as stream:
            made = exampletools.parse_table(stream.read().splitlines())
        documented = exampletools.documented_table("results/materials.md", "materials-all")
        for column, rows in made.items():
            np.testing.assert_allclose(float(rows[name]), float(documented[column][name]), rtol=0.02, err_msg=column)


if __name__ == "__main__":
    unittest.main()
