# SPDX-License-Identifier: BSD-3-Clause
"""The page of `avianlidar view` in a browser without a network: what it shows, what a click and a measurement say, and
that names in files stay names."""
import json
import shutil
import time
import unittest

import numpy as np

import avianlidar as al
import exampletools
import helpertools
from avianlidar._look import class_colour
from avianlidar.apps.view import _view
from browser import Browser

EVIL = "<img src=x onerror=\"document.title='taken'\"></script><script>document.title='taken'</script>"
WALL = 40.0  # m north of the lidar
HERE = exampletools.emptied("TestView")


def write_inputs():
    """A scene with a wall, echoes of a scan, a sequence of one bird, and maps at two heights."""
    corners = [(-10, WALL, 0), (10, WALL, 0), (10, WALL, 8), (-10, WALL, 8)]
    (HERE / "wall.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 2 3\nf 1 3 4\n", "utf-8")
    (HERE / "field.lidarscene.json").write_text(json.dumps({
        "version": 1, "lidar": {"position": [0, 0, 3]}, "objects": [
            {"name": "Field", "class": "grass", "ground": {"size": 160, "height": 0}, "material": "Grass"},
            {"name": EVIL, "class": "hangar", "file": "wall.obj", "material": "Concrete"}]}), "utf-8")
    scan = al.Scan(al.Scene(HERE / "field.lidarscene.json"), al.Sensor("Airport16", position=(0, 0, 3)))
    al.save(scan.echoes, HERE / "echoes.vtp")
    sequence = HERE / "sequences" / "sequences" / "00"
    (sequence / "velodyne").mkdir(parents=True)
    for number in range(3):
        np.array([5, 5, 1, 0.5], "<f4").tofile(sequence / "velodyne" / f"{number:06d}.bin")
    (sequence / "times.txt").write_text("0.0\n1.0\n2.0\n", "utf-8")
    rows = "".join(f"{scan},10000,{EVIL.replace(',', ' ')},{scan}.0,{10.0 * scan},-30,12,3\n" for scan in range(3))
    (sequence / "truth.csv").write_text("scan,bird,species,time_s,x_m,y_m,z_m,points\n" +
                                        rows.replace(EVIL, '"' + EVIL.replace('"', '""') + '"'), "utf-8")
    from avianlidar.apps.coverage._maps import write_geotiff
    (HERE / "maps").mkdir()
    for height, share in ((10, 0.25), (20, 0.75)):
        write_geotiff(HERE / "maps" / f"detection_probability_{height}m.tif", np.full((8, 8), share), (-70, -70),
                      (20, 20), None, "detection_probability")
    return scan


def setUpModule():
    global SCAN
    SCAN = write_inputs()


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        code, out, error = helpertools.run(
            "view", HERE / "field.lidarscene.json", HERE / "echoes.vtp", "--sequence", HERE / "sequences",
            "--coverage", HERE / "maps", "-o", HERE / "view.html")
        assert code == 0, error
        cls.browser = Browser(1280, 720, graphics=True)
        cls.addClassCleanup(cls.browser.driver.quit)
        cls.loaded = cls.browser.open(HERE / "view.html")
        end = time.monotonic() + 60
        while not cls.browser.run("return Boolean(window.avianLidar)"):
            assert time.monotonic() < end, cls.browser.run("return document.body.innerText")
            time.sleep(0.1)

    def pixel_of(self, place):
        """The pixel at which a place (m) is seen."""
        return self.browser.run("""
            const a = window.avianLidar, p = new THREE.Vector3(...arguments[0]).sub(new THREE.Vector3(...a.centre));
            p.project(a.camera);
            return [(p.x + 1) / 2 * innerWidth, (1 - p.y) / 2 * innerHeight];""", place)

    def said_at(self, place):
        """What a click at a place (m) says."""
        x, y = self.pixel_of(place)
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
                "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1})
        return self.browser.run("return document.getElementById('picked').textContent")

    def set(self, control, value):
        """Moves a slider, ticks a box or chooses an entry."""
        self.browser.run("""
            const [id, value] = arguments, one = document.getElementById(id);
            one[one.type === 'checkbox' ? 'checked' : 'value'] = value;
            one.dispatchEvent(new Event('input'));
            one.dispatchEvent(new Event('change'));""", control, value)

    def test_asks_for_nothing_and_runs_no_text(self):
        self.assertEqual([url[:60] for url in self.loaded if not url.startswith(("file:", "data:", "blob:"))], [])
        self.assertEqual([one for one in self.browser.complaints() if one["level"] == "SEVERE"], [])
        self.assertEqual(self.browser.run("return document.title"), "field")
        self.assertEqual(self.browser.run("return document.images.length"), 0)
        self.assertIn(EVIL, self.browser.run("return document.getElementById('legend').innerText"))  # a species

    def test_a_click_names_the_echo(self):
        points, energy = SCAN.echoes.points, SCAN.echoes["energy"]
        of_wall = np.flatnonzero(np.abs(points[:, 1] - WALL) < 0.5)
        which = of_wall[np.argmin(np.linalg.norm(points[of_wall] - (0, WALL, 3), axis=1))]
        said = self.said_at(points[which].tolist())
        self.assertIn(f"echo of {EVIL}", said)
        self.assertIn(f"range {np.linalg.norm(points[which] - (0, 0, 3)):.1f} m", said)
        self.assertRegex(said, rf"energy {1e6 * energy[which]:.3g}0* µJ")

    def test_a_measured_distance(self):
        self.set("layer echoes", False)
        self.browser.run("document.getElementById('measure').click()")
        before = self.browser.pixels().astype(int)
        self.said_at((-30.0, 0.0, 0.0))
        said = self.said_at((30.0, 0.0, 0.0))
        drawn = np.abs(self.browser.pixels().astype(int) - before).max(axis=2) > 60
        self.browser.run("document.getElementById('measure').click()")
        self.set("layer echoes", True)
        self.assertAlmostEqual(float(said.split()[1]), 60.0, delta=0.5)  # a pixel is 0.2 m
        (left, row), (right, _) = (map(round, self.pixel_of((x, 0.0, 0.0))) for x in (-30.0, 30.0))
        line = drawn[row - 3:row + 4, left:right].any(axis=0)
        self.assertGreater(np.count_nonzero(line), 0.9 * (right - left))

    def test_birds_move_with_the_slider(self):
        self.set("time", 1.5)
        self.assertIn(EVIL, self.said_at((15.0, -30.0, 12.0)))
        self.assertIn("at 15.0 m east, -30.0 m north, 12.0 m up", self.said_at((15.0, -30.0, 12.0)))

    def test_the_slice_of_coverage(self):
        self.set("layer coverage", True)
        for number, share in ((0, "0.25"), (1, "0.75")):
            self.set("height", number)
            self.assertIn(f"{share} of the scans detect the bird", self.said_at((40.0, -40.0, 10.0 + 10 * number)))
        self.set("layer coverage", False)

    def test_the_picture_shows_the_colours(self):
        """The wall's echoes by energy have the colours of the paper's hue, and by class the class's own colour."""
        def colours():
            pixels = self.browser.pixels()
            return {tuple(row) for row in np.unique(pixels.reshape(-1, 3), axis=0).tolist()}
        from avianlidar._look import CLASSES
        hangar = tuple(int(0.55 * int(CLASSES["hangar"][i:i + 2], 16)) for i in (1, 3, 5))  # darker than the wall
        self.set("layer surfaces", False)
        self.set("colouring", "class")
        self.assertIn(hangar, colours())
        self.set("colouring", "energy")
        hues = {tuple(np.rint(255 * np.asarray(row[:3])).astype(int).tolist()) for row in al.hue_colors().colors}
        self.assertNotIn(hangar, colours())
        self.assertTrue(hues & colours())
        self.set("layer surfaces", True)


class Inputs(unittest.TestCase):
    def test_faults_are_named(self):
        scene = HERE / "field.lidarscene.json"
        for words, expected in (
                ((scene, "-o", HERE / "view.txt"), "view.txt: expected a name that ends in .html"),
                ((scene, "--coverage", HERE, "-o", HERE / "x.html"), "expected the maps of `avianlidar coverage`"),
                ((scene, "--sequence", HERE, "-o", HERE / "x.html"), "folder that `avianlidar sequence` has made"),
                ((scene, "--tracks", HERE / "none.csv", "-o", HERE / "x.html"), "none.csv")):
            code, _, error = helpertools.run("view", *words)
            self.assertEqual(code, 2)
            self.assertIn(expected, error)
            self.assertFalse((HERE / "x.html").exists())

    def test_damaged_numbers_are_named(self):
        """Garbage and NaN in tables, maps that are no maps, and times without a scan."""
        home = HERE / "damaged"
        shutil.copytree(HERE / "sequences" / "sequences" / "00", home)
        (home / "boxes").mkdir()
        (HERE / "garbage").mkdir()
        truth, times = home / "truth.csv", home / "times.txt"
        for file, content, option, folder in (
                (truth, truth.read_text("utf-8").replace("10.0", "nan"), "--sequence", home),
                (truth, truth.read_text("utf-8").replace("10.0", "ten"), "--sequence", home),
                (times, "", "--sequence", home),
                (home / "boxes" / "000000.txt", "car 0 0 1 2\n", "--sequence", home),
                (HERE / "garbage" / "detection_probability_5m.tif", "no map", "--coverage", HERE / "garbage"),
                (HERE / "tracks.csv", "track,time_s,x_m,y_m,z_m\n1,0,inf,0,0\n", "--tracks", HERE / "tracks.csv")):
            before = file.read_bytes() if file.exists() else None
            file.write_text(content, "utf-8")
            code, _, error = helpertools.run("view", HERE / "field.lidarscene.json", option, folder, "-o",
                                             HERE / "x.html")
            self.assertEqual((code, len(error.splitlines())), (2, 1), error)
            self.assertIn(file.name, error)
            self.assertFalse((HERE / "x.html").exists())
            file.unlink() if before is None else file.write_bytes(before)

    def test_sharp_edges_and_borders(self):
        """A box without a lid, from triangles that share no points: its twelve edges, and no diagonal."""
        points, cells = helpertools.box((0, 0, 0), (1, 2, 3))
        lid = (points[cells][:, :, 2] == 3).all(axis=1)
        triangles = points[cells[~lid]]
        found = _view._edges(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)).reshape(-1, 2, 3)
        self.assertEqual(sorted(np.abs(found[:, 0] - found[:, 1]).sum(axis=1).tolist()),
                         [1.0] * 4 + [2.0] * 4 + [3.0] * 4)

    def test_birds_and_false_alarms_have_colours_of_their_own(self):
        walls = {class_colour(word) for word in ("building", "hangar", "terminal", "")}
        for word in ("bird", "noise", "air"):
            self.assertNotIn(class_colour(word), walls)


