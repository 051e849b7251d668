# SPDX-License-Identifier: BSD-3-Clause
"""The command: every verb does what the classes do, a mesh is a scene, errors are one line with exit status 2, a bar is
drawn on a terminal and nowhere else, and manual page and completion are the parser's. Formats are tested where their
readers and writers are."""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import unittest
import unittest.mock

import numpy as np
from scipy.spatial import cKDTree

import avianlidar as al
import exampletools
from avianlidar import _command, _terminal, reach
from avianlidar._advising import per_cent
from avianlidar._numbers import figures
from boxfiles import CORNERS, TRIANGLES, poly_data, stl
from cloudtools import CLOUDS, READ_BACK
import helpertools
import scenetools as st
from helpertools import from_terminal

SOURCE, SCENE = pathlib.Path(st.SOURCE), pathlib.Path(st.SHIPPED)
OUTPUT = exampletools.emptied("command")
SHARE = next((folder / "share" for folder in pathlib.Path(al.__file__).resolve().parents
              if (folder / "share" / "man").is_dir()), None)
FEW = ("--sensor-set", "azimuth_step=1.875")  # beams: 3,072


def run(*arguments):
    """(exit status, lines of output, lines of errors) of the command."""
    code, *said = helpertools.run(*arguments)
    return code, *(stream.splitlines() for stream in said)


class Verbs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.files = {suffix[1:]: OUTPUT / f"echoes{suffix}" for suffix in (*CLOUDS, ".png")}
        outs = [word for file in cls.files.values() for word in ("-o", file)]
        cls.ran = run("scan", SCENE, "--sensor", "search-905", *FEW, "--sensor-set", "range_gate=3000", "--scan-set",
                      "seed=3", *outs)
        scene = al.load_scene(SCENE)
        cls.echoes = al.Scan(scene,
                             al.Sensor("Search905", position=scene.lidar_position, range_gate=3000, azimuth_step=1.875),
                             seed=3).echoes

    def test_scan_writes_every_format(self):
        code, lines, errors = self.ran
        self.assertEqual((code, errors), (0, []))
        self.assertEqual((lines[0], len(lines)),
                         ("the lidar stands at (0, 0, 3) m, as the scene file says", 1 + len(self.files)))
        self.assertTrue(lines[1].startswith(f"{self.files['las']}: {self.echoes.number_of_points} echoes of 3072 "
                                            "beams"), lines)
        self.assertTrue(lines[1 + CLOUDS.index(".bin")].endswith(", labels in echoes.label"), lines)
        written = al.load_cloud(self.files["vtp"])
        for name, values in self.echoes.items():
            self.assertTrue(np.array_equal(written[name], values, equal_nan=values.dtype.kind == "f"), name)
        self.assertEqual(set(written) - set(self.echoes), {"hue", "rgb", "longitude", "latitude", "height"})
        for suffix in READ_BACK:
            self.assertEqual(al.load_cloud(self.files[suffix[1:]]).number_of_points, self.echoes.number_of_points,
                             suffix)
        self.assertEqual(self.files["png"].read_bytes()[:4], b"\x89PNG")

    def test_a_mesh_is_a_scene(self):
        (OUTPUT / "box.stl").write_text(stl(CORNERS, TRIANGLES), "utf-8")
        al.save(poly_data(TRIANGLES), OUTPUT / "box.vtp")
        for file in (OUTPUT / "box.stl", OUTPUT / "box.vtp"):
            with self.subTest(file):
                code, lines, errors = run("info", file)
                self.assertEqual((code, lines[0]), (0, f"{file}: a scene"), errors)
                self.assertIn("extent     east 1 to 2, north 2 to 4, up 0 to 3 m", lines)
                out = OUTPUT / "mesh-echoes.vtp"
                code, lines, errors = run("scan", file, "--scale", "10", "--material", "metal", "--position", "15",
                                          "-90", "5", "-o", out)
                self.assertEqual(code, 0, errors)
                echoes = al.load_cloud(out)
                self.assertGreater(echoes.number_of_points, 100)
                self.assertEqual(set(echoes["material_id"]), {2})
                self.assertAlmostEqual(echoes["distance_m"].min(), 110, delta=0.1)
                self.assertEqual(run("convert", out, OUTPUT / "mesh.las")[0], 0)  # without an origin

    def test_where_the_lidar_stands(self):
        """The place and its source before the work, and a warning inside a solid."""
        hangar, out = OUTPUT / "hangar.stl", OUTPUT / "stands.vtp"
        hangar.write_text(stl(np.array(CORNERS) * 20 - (30, 60, 3), TRIANGLES), "utf-8")
        for words, expected, inside in (
                ((), "(0, 0, 0) m, the default; --position X Y Z moves it", True),
                (("--position", 9, -90, 2), "(9, -90, 2) m, as --position says", False),
                (("--sensor-set", "position=9,-90,1"), "(9, -90, 1) m, as --sensor-set says", False)):
            code, lines, errors = run("scan", hangar, *words, *FEW, "-o", out)
            self.assertEqual((code, lines[0]), (0, f"the lidar stands at {expected}"))
            self.assertEqual(["is inside the closed surface of 'hangar'" in error for error in errors], [True] * inside)
        self.assertEqual(len(run("scan", hangar, *FEW, "-o", out, "--quiet")[1]), 1)
        self.assertEqual(run("advise", hangar, "--position", 9, -90, 2, *FEW, "--beams", 100)[1][0],
                         "the lidar stands at (9, -90, 2) m, as --position says")

    def test_notes_are_those_that_a_user_can_act_on(self):
        """A scan says which energy ends the view; `info` has all notes of the field data."""
        out = OUTPUT / "weak.vtp"
        for weather, far in (("fog:300", True), ("haze:50000", False)):
            lines = run("scan", SCENE, "--sensor", "Search905", *FEW, "--weather", weather, "-o", out)[1]
            fields = al.load_cloud(out).fields
            self.assertEqual(fields["perceivable_range"] < fields["range_gate"], far)
            self.assertEqual(lines[2:],
                             [f"nothing beyond {fields['perceivable_range']:.0f} m is perceived, although the range "
                              "gate ends at 4000 m: more pulse "
                              "energy, a lower energy limit or clearer air would let the sensor see farther"] * far)
        text, notes = "\n".join(run("info", out)[1]), [name for name in fields if name.startswith("note_")]
        self.assertGreater(len(notes), 5)
        for name in notes:
            self.assertRegex(text, rf"(?m)^{name[5:].replace('_', ' ')} +{re.escape(fields[name][0])}$")
        self.assertNotIn("detail between rays", "".join(run("info", out, "--quiet")[1]))

    def test_info(self):
        for file, words in ((self.files["las"], r"a cloud of \d+ points"),
                            (self.files["vtp"], "distance_m +m +[0-9.]+ +[0-9.]+"), (SCENE, "triangles  5510"),
                            (SOURCE / "Examples/coverage/hongqiao.coverage.json", "a plan of coverage"),
                            (SOURCE / "Examples/sequence/hongqiao.scenario.json", "number_of_scans  1000")):
            code, lines, errors = run("info", file)
            self.assertEqual((code, errors), (0, []))
            self.assertRegex("\n".join(lines), words)

    def test_what_a_scene_assumes_and_leaves_out_is_printed(self):
        square = [[[0, 50], [9, 50], [9, 59], [0, 59], [0, 50]]]
        (OUTPUT / "plans.geojson").write_text(st.features(*(
            (kind, at, {"name": name, "h": "tall"})
            for name, kind, at in (("House", "Polygon", square), ("Lamp", "Point", [0, 0])))))
        scene = OUTPUT / "plans.lidarscene.json"
        scene.write_text(json.dumps({"version": 1, "objects": [{
            "footprints": "plans.geojson", "crs": "local", "height": 3, "height_attribute": "h", "material": "Wall"}]}))
        expected = ["plans: 1 features without an area were left out: Lamp",
                    'plans: 1 features have no usable height attribute and got the default height: House ("tall")',
                    "plans: 1 points were left out"]
        out = OUTPUT / "plans.csv"
        for words in (("info", scene), ("scan", scene, "--sensor", "Search905", *FEW, "-o", out)):
            code, lines, errors = run(*words)
            self.assertEqual((code, [line for line in lines if line.startswith("plans: ")]), (0, expected), errors)
        self.assertFalse(set(expected)
                         & set(run("scan", scene, "--sensor", "Search905", *FEW, "-o", out, "--quiet")[1]))

    def test_compare(self):
        def compared(one, other, *more):
            code, lines, errors = run("compare", one, other, *more)
            self.assertEqual(code, 0, errors)
            text = "\n".join(lines)
            return float(re.search(r"Hausdorff distance: (\S+) m", text).group(1)), text, errors
        distance, text, errors = compared(self.files["las"], self.files["pcd"], "-o", OUTPUT / "distances.vtp")
        self.assertLess(distance, 2e-4)  # LAS counts in 0.1 mm
        self.assertEqual(errors, [])
        self.assertRegex(text, r"density-aware Chamfer distance: \S+ \(alpha = 1 1/m\)")
        self.assertAlmostEqual(al.load_cloud(OUTPUT / "distances.vtp")["nearest_distance"].max(), distance, delta=1e-9)
        points = [al.load_cloud(self.files[name]).points for name in ("las", "pcd")]
        for column, (one, other) in enumerate((points, points[::-1])):
            nearest = cKDTree(other).query(one)[0]
            for share, words in ((25, "25 % are within"), (50, "median"), (75, "75 % are within"),
                                 (95, "95 % are within"), (99, "99 % are within")):
                found = re.search(rf"(?m)^{words} +(\S+) +(\S+)$", text).groups()
                self.assertAlmostEqual(float(found[column]), np.percentile(nearest, share), delta=2e-6)
        # One false alarm more, 5 km above, is the whole distance; without it nothing is left.
        head, *rows = self.files["csv"].read_text("utf-8").splitlines()
        names, row = [name.partition(" ")[0] for name in head.split(",")], rows[-1].split(",")
        row[names.index("z")], row[names.index("object_id")] = "5000", "-1"
        (OUTPUT / "alarm.csv").write_text("\n".join((head, *rows, ",".join(row), "")), "utf-8")
        distance, text, _ = compared(OUTPUT / "alarm.csv", self.files["csv"])
        self.assertGreater(distance, 4900)
        self.assertRegex(text, r"(?s)alarm.csv has .*Without these echoes the Hausdorff distance is 0 m")
        _, _, errors = compared(self.files["bin"], self.files["las"])
        self.assertRegex("".join(errors), r"warning: a \.bin file is in the frame of its sensor")

    def test_clouds_that_do_not_overlap(self):
        """Such as one in UTM; flat clouds that are a little apart do overlap."""
        rng, files = np.random.default_rng(1), [OUTPUT / "local.csv", OUTPUT / "other.csv"]
        flat = rng.uniform(0, 100, (200, 3)) * (1, 1, 0)
        for move, apart in (((346600, 3451000, 0), True), ((100.5, 0, 0), True), ((99.5, 0, 0), True),
                            ((90, 0, 0), False), ((0, 0, 0.5), False), ((0, 0, 30), True)):
            for file, points in zip(files, (flat, flat + move)):
                file.write_text("x,y,z\n" + "".join("%.3f,%.3f,%.3f\n" % tuple(point) for point in points), "utf-8")
            errors = run("compare", *files)[2]
            self.assertEqual(["do not overlap: local.csv extends east" in error for error in errors], [True] * apart,
                             move)
            self.assertEqual(["but other.csv extends east 34660" in error for error in errors], [move[1] > 0] * apart)

    def test_csv_becomes_every_format(self):
        for suffix in CLOUDS:
            self.assertEqual(run("convert", self.files["csv"], OUTPUT / f"from-csv{suffix}")[0], 0, suffix)
        self.assertEqual((OUTPUT / "from-csv.csv").read_bytes(), self.files["csv"].read_bytes())

    def test_numbers_in_sentences(self):
        """Significant digits without exponents: 100 %, not 1e+02 %; coordinates of a map to the centimetre."""
        for value, digits, text in ((99.6, 2, "100"), (9.96, 1, "10"), (1234567.0, 6, "1234570"), (1e6, 6, "1000000"),
                                    (-5412345.678, 3, "-5410000"), (np.float32(0.5), 3, "0.5"),
                                    (5.1234e-5, 3, "0.0000512"), (1e-4, 6, "0.0001"), (3e-9, 3, "3e-09"),
                                    (2e15, 3, "2e+15"), (0.0, 3, "0"), (np.inf, 3, "inf"), (np.nan, 2, "nan"),
                                    (99999.96, 6, "100000")):
            self.assertEqual(figures(value, digits), text)
        self.assertEqual(per_cent(9.996), "1000 %")
        file = OUTPUT / "utm.csv"
        file.write_text("x,y,z\n448123.456,5412345.678,420\n448000,5412000.25,400\n", "utf-8")
        self.assertIn("east 448000 to 448123.46, north 5412000.25 to 5412345.68, up 400 to 420 m",
                      "".join(run("info", file)[1]))

    def test_clouds_of_a_map_are_converted(self):
        """Every format keeps the coordinates, or says how much they move and which option helps."""
        rng = np.random.default_rng(6)
        places, file = rng.uniform(-50, 50, (100, 3)), OUTPUT / "map.csv"
        origin = (448123.4, 5412345.6, 420.0)
        np.savetxt(file, places + origin, "%.6f", ",", header="x,y,z", comments="")
        for suffix in (".las", ".pcd", ".ply", ".vtp", ".csv"):
            code, _, errors = run("convert", file, OUTPUT / f"map-out{suffix}")
            self.assertEqual(code, 0, errors)
            np.testing.assert_allclose(al.load_cloud(OUTPUT / f"map-out{suffix}").points, places + origin, rtol=0,
                                       atol=2e-6)
            self.assertEqual(["double precision" in error for error in errors], [True] * (suffix in (".pcd", ".ply")))
        out = OUTPUT / "map-out.bin"
        code, _, errors = run("convert", file, out)
        self.assertEqual((code, sum("--position of avianlidar convert" in error for error in errors)), (0, 2), errors)
        self.assertRegex(" ".join(errors), r"moves coordinates by up to 0\.2\d* m")
        code, _, errors = run("convert", file, out, "--position", *origin)
        self.assertEqual((code, len(errors), "no labels are written" in errors[0]), (0, 1, True))
        np.testing.assert_allclose(al.load_cloud(out).points, places, rtol=0, atol=5e-6)
        self.assertIn("poses.txt", run("convert", OUTPUT, OUTPUT / "a.mcap", "--position", 1, 2, 3)[2][0])

    def test_sensors_and_materials(self):
        code, lines, _ = run("sensors")
        self.assertEqual((code, [line.split()[0] for line in lines[1:]]), (0, list(al.Sensor.presets())))
        self.assertRegex("\n".join(lines), r"(?m)^VLP16 .*903 nm")
        self.assertRegex("\n".join(run("sensors", "VLP-16")[1]), r"(?s)pulse energy +0\.4 .*\(assumed\)")
        self.assertIn("beams            61440", run("sensors", "airport32")[1])
        _, lines, _ = run("materials")
        self.assertEqual({line.split()[0]: tuple(map(float, line.split()[1:1 + len(al.materials()["Wall"])]))
                          for line in lines[1:]}, al.materials())

    def test_errors_are_one_line_with_status_2(self):
        (OUTPUT / "text.stl").write_text("no mesh", "utf-8")
        (OUTPUT / "fake.vtp").write_text("no mesh", "utf-8")
        (OUTPUT / "cut.vtp").write_text('<VTKFile type="PolyData">', "utf-8")
        (OUTPUT / "table.csv").write_text("region,share [1]\nall,0.5\n", "utf-8")
        scan = ("scan", SCENE, "-o", "x.las")
        cases = (
            (("scan", "none.stl", "-o", "x.las"), "no such file: none.stl"),
            (("scan", SCENE, "-o", "x.doc"), "cannot write 'x.doc'"),
            (("scan", SCENE.parent / "hongqiao.geojson", "-o", "x.las"), "holds footprints"),
            (("scan", OUTPUT / "text.stl", "-o", "x.las"), "text.stl"),
            ((*scan, "--sensor", "Airport17"), "did you mean 'Airport16'"),
            ((*scan, "--scale", "2"), "scale of a scene"), ((*scan, "--sensor-set", "gate=3"), "'gate' is not known"),
            ((), "verb"), (("scan", SCENE, "-o", "none/x.las"), "there is no folder none"),
            ((*scan, "-o", "./x.las"), "is named twice"),
            ((*scan, "--scan-set", "rays_per_beam=1e30"), "rays_per_beam|int"),
            ((*scan, "--scan-set", "attenuation_coefficient=nan"), "not a finite number"),
            ((*scan, "--weather", "fog:500"),
             "Airport16 has no receiver_aperture .* choose for example --sensor Search905"),
            (("info", OUTPUT / "table.csv"), r"table.csv: is not a cloud"), (("info", OUTPUT / "fake.vtp"), "fake.vtp"),
            (("info", OUTPUT / "cut.vtp"), "cut.vtp: vtkXMLDataParser: Error parsing XML"),
            (("info", "none.vtp"), "no such file: none.vtp"), (("info", OUTPUT), "expected the files of one kind"),
            (("convert", self.files["las"], "x.doc"), "cannot write 'x.doc'"),
            (("sensors", "VLP99"), "'VLP99' is not known"))
        for arguments, words in cases:
            with self.subTest(arguments):
                code, lines, errors = run(*arguments)
                self.assertEqual((code, lines, len(errors)), (2, [], 1), errors)
                self.assertRegex(errors[0], "^avianlidar.*" + words)
        self.assertFalse([file for file in os.listdir() if file.startswith("x.")])

    def test_values_of_settings(self):
        code, _, errors = run("scan", SCENE, "--position", "-5e0", "-1e1", "3", *FEW, "--scan-set", "beam_samples=rays",
                              "--scan-set", "rays_per_beam=1e2", "--sensor-set", "position=1,2,3", "-o",
                              OUTPUT / "set.vtp")
        self.assertEqual((code, errors), (0, []))
        fields = al.load_cloud(OUTPUT / "set.vtp").fields
        self.assertEqual((fields["beam_samples"], fields["rays_per_beam"], fields["position"].tolist()),
                         (1, 100, [1, 2, 3]))

    def test_geojson_of_a_scene_without_an_origin_is_refused_before_the_scan(self):
        (OUTPUT / "box.stl").write_text(stl(CORNERS, TRIANGLES), "utf-8")
        code, lines, errors = run("scan", OUTPUT / "box.stl", "-o", OUTPUT / "early.vtp", "-o",
                                  OUTPUT / "early.geojson")
        self.assertEqual((code, lines, len(errors)), (2, [], 1))
        self.assertFalse((OUTPUT / "early.vtp").exists())


class Surroundings(unittest.TestCase):
    def command(self, *arguments):
        return [sys.executable, "-m", "avianlidar", *map(str, arguments)]

    def test_a_bar_on_a_terminal_and_nowhere_else(self):
        work = self.command("scan", SCENE, *FEW, "-o", OUTPUT / "bar.vtp")
        self.assertEqual(subprocess.run(work, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=True).stderr,
                         b"")
        text, code = from_terminal(self, work, stdout=subprocess.DEVNULL)
        self.assertEqual(code, 0)
        self.assertRegex(text, r"scan: *100%")

    def test_a_log_says_that_long_work_is_alive(self):
        """A line at each interval, without carriage returns: the share and the time left once they are known."""
        begin = "import sys, time; from avianlidar import _command, _terminal; _terminal.INTERVAL = 0.1\n"
        command = begin + "sys.exit(_command.main(sys.argv[1:]))"
        unknown = begin + "with _terminal.alive('work'): time.sleep(1.5)"
        for program, words, expected in (
                (command, ("scan", SCENE, "--scan-set", "rays_per_beam=1000", "-o", OUTPUT / "log.vtp"),
                 r"scan: \d+ %, about \d+ s left"),
                (command, ("reach", "--sensor", "Search905"), r"reach: \d+ %, about \d+ s left"),
                (unknown, (), r"work: running for \d+ s")):
            done = subprocess.run([sys.executable, "-c", program, *map(str, words)], capture_output=True, text=True,
                                  check=True)
            lines = done.stderr.splitlines()
            self.assertEqual([line for line in lines
                              if not re.fullmatch(r"avianlidar: \w+: (\d+ %, about \d+ s left|running( for \d+ s)?)",
                                                  line)], [])
            self.assertTrue(any(re.fullmatch(f"avianlidar: {expected}", line) for line in lines), lines)
            self.assertNotIn("\r", done.stderr)
        self.assertEqual([_terminal.in_time(seconds) for seconds in (3.4, 99, 119, 5940, 7200)],
                         ["3 s", "99 s", "2 min", "99 min", "2.0 h"])

    def test_long_words_are_shortened(self):
        for verb, *more in (["info"], ["scan", "-o", OUTPUT / "none.vtp"]):
            done = subprocess.run(self.command(verb, 5000 * "x" + ".lidarscene.json", *more), capture_output=True,
                                  text=True, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, r"x{100}\.\.\.x+\.lidarscene\.json")
            self.assertLess(len(done.stderr), 400)

    def test_control_characters_of_names_do_not_reach_the_terminal(self):
        """Names of files, names in files, and wrong words, in messages of Python, VTK, Assimp, GDAL and the parser."""
        odd = "a\x1b[31m\r\x07\nb\u202e\x9bc"
        shown = r"a\x1b[31m\x0d\x07\x0ab\u202e\x9bc"
        folder = pathlib.Path(exampletools.OUTPUT) / "TestCommand" / odd
        folder.mkdir(parents=True, exist_ok=True)
        content = {".vtk": "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n",
                   ".obj": "v 1 a\n", ".dae": "<C", ".las": "LASF", ".pcd": "#", ".lidarscene.json": "{",
                   ".coverage.json": "{", ".csv": "x,y,z\n1,2,3\n", ".tif": "II", ".geojson": "{"}
        for suffix, text in content.items():
            (folder / (odd + suffix)).write_text(text)
        (folder / "named.lidarscene.json").write_text(json.dumps({"version": 1, "objects": [{"file": odd + ".dae"}]}))
        cases = [("info", odd + suffix) for suffix in content if suffix not in (".tif", ".geojson")]
        cases += [("convert", odd + ".csv", odd + ".pcd"), ("compare", odd + ".csv", odd + ".csv"),
                  ("info", "named.lidarscene.json"), ("airport", odd + ".geojson", "-o", odd),
                  ("info", odd + ".csv", odd), ("scan", odd + ".none", "-o", "x.csv"), (odd,),
                  ("reach", "--sensor", odd)]
        for words in cases:
            done = subprocess.run([sys.executable, "-m", "avianlidar", *words], cwd=folder, capture_output=True,
                                  check=False)
            text = (done.stdout + done.stderr).decode()
            self.assertTrue(shown.replace("\\x0a", " ") in text.replace(r"\x0a", " ") or repr(odd)[1:-1] in text,
                            (words, text))
            self.assertNotRegex(text, "[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e]", words)
            if done.returncode:
                self.assertEqual((done.returncode, text.count("\n")), (2, 1), (words, text))
        self.assertEqual(_terminal.shown("\udcff\u2028é\n"), "\\xff\\u2028é\n")

    def test_streams_that_are_closed(self):
        """Such as the streams of `| head` and of daemons."""
        done = subprocess.run(["bash", "-c", f"set -o pipefail; {shlex.join(self.command('sensors'))} | true"],
                              stderr=subprocess.PIPE, check=False)
        self.assertEqual((done.returncode, done.stderr), (141, b""))
        line = shlex.join(self.command("scan", SCENE, *FEW, "-o", OUTPUT / "closed.vtp"))
        (OUTPUT / "closed.vtp").unlink(missing_ok=True)
        subprocess.run(["bash", "-c", f"{line} >&- 2>&- <&-"], check=True)
        self.assertTrue((OUTPUT / "closed.vtp").exists())

    def test_a_picture_is_replaced_as_a_whole_or_not_at_all(self):
        picture = OUTPUT / "kept.png"
        picture.write_bytes(b"before")
        line = shlex.join(self.command("scan", SCENE, *FEW, "-o", picture))
        done = subprocess.run(["bash", "-c", f"ulimit -f 2; {line}"], capture_output=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual((picture.read_bytes(), list(OUTPUT.glob("kept.png.*"))), (b"before", []))

    def test_reach_is_that_of_birds_within_beams(self):
        """With the ranges of units that see boards 0.84 and 1.66 times as far, for which they need the squares of the
        light."""
        few = (*reach.within_beams.__defaults__[:2], 40)  # birds
        with unittest.mock.patch.object(reach, "RANGES", 6), unittest.mock.patch.object(
                reach.within_beams, "__defaults__", few):
            code, lines, _ = run("reach", "--sensor", "OS1_64", "--species", "herring gull", "--weather", "fog:500",
                                 "-o", OUTPUT / "reach.csv")
            found, dim, bright = (reach.within_beams(al.Sensor("OS1_64", pulse_energy=4e-7 * factor**2), "herring gull",
                                                     visibility=500.0, air_backscatter=True)
                                  for factor in (1, 0.84, 1.66))
        self.assertEqual(code, 0)
        half = found.to(0.5)
        self.assertGreater(half, 10.0)
        words = f"{half:.2g} m ({dim.to(0.5):.2g} to {bright.to(0.5):.2g} m)"
        nine = f"{found.to(0.9):.2g} m ({dim.to(0.9):.2g} to {bright.to(0.9):.2g} m)"
        self.assertEqual(re.split("  +", lines[1])[:4], ["OS1_64", "herring gull", nine, words])
        self.assertTrue(lines[2].startswith(f"OS1_64 sees half of the herring gulls in its beams to {words}, less than "
                                            "the 280 m"))
        table = np.genfromtxt(OUTPUT / "reach.csv", delimiter=",", skip_header=1)
        np.testing.assert_allclose(table[:, 2:4], np.column_stack([found.ranges, found.one_scan]), rtol=1e-5)

    def test_reach_says_first_which_lidars_are_ideas(self):
        with unittest.mock.patch.object(reach, "RANGES", 6):
            code, lines, _ = run("reach", "--sensor", "Search905", "--species", "herring gull")
        self.assertEqual(code, 0)
        self.assertEqual(lines[0], "Search905 is an idea: nobody sells this lidar.")
        few = (*reach.within_beams.__defaults__[:2], 40)  # birds
        with unittest.mock.patch.object(reach, "RANGES", 6), unittest.mock.patch.object(
                reach.within_beams, "__defaults__", few):
            _, placed, _ = run("reach", "--sensor", "OS1_64", "--species", "Canada goose", "--sensor-set",
                               "Position=0,0,3")
        self.assertRegex(placed[0], "^sensor ")  # no idea
        self.assertRegex(placed[2], "^OS1_64 sees half of the Canada geese in its beams to ")
        self.assertRegex(lines[1],
                         r"^In clear air, one scan of a lidar on sale detects half of the herring gulls in its beams "
                         r"to at most 6[0-9] m \(OS2_128\)\.$")

    def test_examples_are_understood(self):
        """Every example of the help and of the page is one that the parser takes, and every verb has one."""
        page = (SOURCE / "Documentation" / "reference" / "commands.md").read_text("utf-8")
        lines = [line for _, _, examples in _command.VERBS.values() for line in examples.splitlines()]
        lines += [line for block in re.findall(r"```sh\n(.*?)```", page, re.S)
                  for line in re.sub(r"\\\n", " ", block).splitlines()]
        verbs = {_command.parser().parse_args(words[1:]).verb for words in map(shlex.split, lines) if words[:1]
                 == ["avianlidar"]}
        self.assertEqual(verbs, set(_command.VERBS))
        for verb in verbs:
            self.assertRegex(page, rf"`{verb}\b")

    @unittest.skipUnless(SHARE, "made without python3-shtab and python3-argparse-manpage")
    def test_manual_page_and_completion(self):
        page = (SHARE / "man/man1/avianlidar.1").read_text("utf-8")
        for verb in _command.VERBS:
            self.assertRegex(page, rf"(?m)^\.SH (OPTIONS|COMMAND) .*'avianlidar {verb}'")
        script = f"source {SHARE}/bash-completion/completions/avianlidar; COMP_WORDS=(avianlidar %s); COMP_CWORD=%d; " \
                 "_shtab_avianlidar 2>/dev/null; echo ${COMPREPLY[@]}"
        for words, at, found in (("s", 1, "scan sequence siting sensors"), ("scan --material Me", 3, "Metal"),
                                 ("sensors Airport3", 2, "Airport32"), ("scan --pos", 2, "--position"),
                                 ("report --siting-set mar", 3, "margin=")):
            done = subprocess.run(["bash", "-c", script % (words, at)], capture_output=True, text=True, check=True)
            self.assertEqual(sorted(done.stdout.split()), sorted(found.split()))

    @unittest.skipUnless(SHARE, "made without python3-shtab and python3-argparse-manpage")
    def test_a_setting_is_completed_without_a_blank(self):
        """As bash does it on a terminal: the value comes right after the =."""
        line = f"source {SHARE}/bash-completion/completions/avianlidar; avianlidar() {{ echo \"<$3>\"; }}\n" \
               "avianlidar scan --sensor-set range_g\t800; exit\n"
        text, code = from_terminal(self, ["bash", "--norc", "-i"], typed=line, start_new_session=True)
        self.assertEqual(code, 0)
        self.assertIn("<range_gate=800>", text)
