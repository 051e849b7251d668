# SPDX-License-Identifier: BSD-3-Clause
"""Ranges of boards, spheres, drones, people, walls, ground, flocks and birds of one's own table: against closed forms
of the radar equation, and against scans of still surfaces or flown flocks by the echo filter."""
import math
import re
import unittest
import unittest.mock

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

import avianlidar as al
from avianlidar import _sheet, reach
from avianlidar.apps.coverage import _targets
from avianlidar.vtkAvianLidar import vtkAvianLidarTracks
import helpertools
from exampletools import emptied

OUTPUT = emptied("reach")
TABLE = """species,mass [kg],length [m],span [m],wing area [m2],passerine,airspeed [m/s]
buzzard,0.9,0.54,1.2,0.22,no,11
bunting,0.045,0.18,0.29,0.018,yes,13
"""


def run(*arguments):
    """(exit status, lines of output, text of errors) of the command."""
    code, out, errors = helpertools.run("reach", *arguments)
    return code, out.splitlines(), errors


def in_band(sensor, distance, count, seed):
    """Random places at a distance, evenly between the lowest and the highest beam of a lidar that looks around."""
    random, (low, high) = np.random.default_rng(seed), np.radians(reach.band(sensor))
    up, about = random.uniform(low, high, count), random.uniform(0.0, 2.0 * np.pi, count)
    return distance * np.column_stack([np.sin(about) * np.cos(up), np.cos(about) * np.cos(up), np.sin(up)])


def share_seen(sensor, mesh, kd, distance, squarely, count=400, seed=2):
    """The share of still surfaces at random places with a point, and the mean number of their points, in one scan with
    noise."""
    points, faces = mesh
    scene, random = al.Scene(), np.random.default_rng(1000 + seed)
    for number, place in enumerate(in_band(sensor, distance, count, seed)):
        # within one range unit
        place *= 1.0 + random.uniform(-0.25, 0.25) * 299792458.0 * sensor.sampling_interval / distance
        turn = math.atan2(place[0], place[1]) if squarely else random.uniform(0.0, 2.0 * np.pi)
        right, ahead = (math.cos(turn), -math.sin(turn), 0.0), np.array([math.sin(turn), math.cos(turn), 0.0])
        up = np.array([0.0, 0.0, 1.0])
        if squarely:
            ahead = place / np.linalg.norm(place)
            up = np.cross(right, ahead)
        scene.add(points @ np.array([right, ahead, up]) + place, faces, material=(kd, 0.0, 1.0), name=str(number))
    echoes = al.Scan(scene, sensor, visibility=reach.CLEAR, number_of_reflections=1, seed=seed).echoes
    found = np.bincount(echoes["object_id"][echoes["object_id"] >= 0], minlength=count)
    return (found > 0).mean(), found.mean()


class Targets(unittest.TestCase):
    def test_walls_are_seen_as_far_as_the_radar_equation_says(self):
        """Photons: by the formulas of the fit to data sheets. EnergyLimits: a wall's light falls as the square of the
        range and in the air."""
        for reflectance in (0.1, 0.8):
            wall = reach.target("wall", reflectance)
            sensor = al.Sensor("OS1_64", background_radiance=0.0, sunlight=0.0)
            point = {"range": 50.0, "reflectance": reflectance}
            expected = _sheet.Receiver(sensor).range(point, sensor.receiver_aperture, sensor.filter_bandwidth, math.nan)
            self.assertAlmostEqual(reach.within_beams(sensor, wall).to(0.5) / expected, 1.0, delta=0.01)
            sensor = al.Sensor("VLP16")
            air, tried = sensor.algorithm.GetClearAirAttenuation(), np.arange(1.0, sensor.range_gate, 0.01)
            light = reflectance / tried ** 2 * np.exp(-2.0 * air * tried)
            expected = tried[light >= 0.5 / 100.0 ** 2 * math.exp(-2.0 * air * 100.0)][-1]  # 100 m at 50 % in the sheet
            self.assertAlmostEqual(reach.within_beams(sensor, wall).to(0.5) / expected, 1.0, delta=0.01)
        sensor, wall = al.Sensor("VLP16"), reach.target("wall", 0.1)
        half = reach.within_beams(sensor, wall).to(0.5)
        for one, factor in zip(reach.in_interval(sensor, wall), reach.interval(sensor)):
            self.assertAlmostEqual(one.to(0.5) / half / factor, 1.0, delta=0.02)  # less by the air

    def test_ground_is_a_wall_of_less_reflectance(self):
        """By the cosine of incidence, for thin beams whose light on the ground is shorter than a range unit."""
        sensor = al.Sensor("Search905", half_beamwidth=1e-5, minimum_elevation=-40.0, elevation_step=2.5,
                           background_radiance=0.0, pulse_width=1e-11)
        sensor.pulse_energy *= 0.008
        ground = reach.target("ground", 0.1, height=300.0)
        found = reach.within_beams(sensor, ground).to(0.5)
        receiver, expected = _sheet.Receiver(sensor), 500.0
        for _ in range(30):
            point = {"range": expected, "reflectance": 0.1 * 300.0 / expected}
            expected = receiver.range(point, sensor.receiver_aperture, sensor.filter_bandwidth, math.nan)
        self.assertGreater(expected, 300.0 / math.sin(math.radians(40.0)))  # within the beams
        self.assertAlmostEqual(found / expected, 1.0, delta=0.02)
        up = reach.within_beams(al.Sensor("Search905"), reach.target("ground"))  # no beam points down
        self.assertEqual(up.one_scan.max(), 0.0)

    def test_points_on_a_wall_are_as_dense_as_beams(self):
        sensor = al.Sensor("VLP16")  # 2 degrees between channels
        density = 1.0 / (math.radians(2.0) * math.radians(sensor.azimuth_step)) / 30.0 ** 2
        self.assertAlmostEqual(reach.points(sensor, reach.target("wall", 0.5), 30.0) / density, 1.0, delta=0.05)
        ground = reach.target("ground", 0.5, height=5.0)
        self.assertAlmostEqual(reach.points(sensor, ground, 25.0) / (density * 30.0 ** 2 / 25.0 ** 2 * 5.0 / 25.0), 1.0,
                               delta=0.3)  # rings
        self.assertEqual(reach.points(sensor, ground, 6.0), 0.0)  # below the beams
        seen = reach.Reach(np.array([10.0, 20.0]), np.array([1.0, 0.5]), np.zeros(2), np.zeros(2))
        self.assertTrue(reach.sentence("VLP16", ground, seen, None, 0.0).endswith(
                            " to 20 m. At half of this range, no beam meets the ground."))

    def test_half_of_still_targets_have_a_point_at_the_printed_range(self):
        """Within four standard errors of 400 surfaces; points at half of the range within a tenth."""
        for name, form, reflectance in (("Search905", "board:0.5", 0.1), ("Search905", "drone", None),
                                        ("VLP16", "person", None), ("OS1_64", "sphere:0.3", 0.5)):
            with self.subTest(f"{name} {form}"):
                sensor, target = al.Sensor(name), reach.target(form, reflectance)
                half = reach.within_beams(sensor, target).to(0.5)
                seen, _ = share_seen(sensor, target.mesh, target.reflectance, half, form.startswith("board"))
                self.assertAlmostEqual(seen, 0.5, delta=0.1 if name != "VLP16" else 0.12)
                _, points = share_seen(sensor, target.mesh, target.reflectance, 0.5 * half, form.startswith("board"),
                                       100)
                self.assertAlmostEqual(reach.points(sensor, target, 0.5 * half) / points, 1.0, delta=0.15)

    def test_sphere_has_the_surface_of_a_sphere(self):
        points, faces = _targets.sphere(0.5)
        a, b, c = (points[faces[:, k]] for k in range(3))
        self.assertAlmostEqual(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum(), math.pi * 0.5 ** 2,
                               delta=1e-9)
        self.assertAlmostEqual(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0 / (math.pi * 0.5 ** 3 / 6.0), 1.0,
                               delta=0.05)  # closed

    def test_a_flock_is_seen_if_one_of_its_birds_is(self):
        """Flocks of vtkAvianLidarTracks at random places, scanned with noise."""
        sensor, few = al.Sensor("Search905"), {"birds": 64}
        alone = reach.within_beams(sensor, "starling", **few)
        np.testing.assert_array_equal(reach.within_beams(sensor, reach.flock("starling", 1), **few).one_scan,
                                      alone.one_scan)
        flock = reach.flock("starling", 20)
        half = reach.within_beams(sensor, flock).to(0.5)
        self.assertGreater(half, 1.1 * alone.to(0.5))
        flocks, blocks = 80, vtkMultiBlockDataSet()
        for number, place in enumerate(in_band(sensor, half, flocks, 7)):
            birds = vtkAvianLidarTracks()
            birds.SetPatternToFlock()
            birds.SetNumberOfBirds(20)
            birds.SetTimeRange(0.0, 0.1)
            birds.SetCenter(*place)
            birds.SetRadius(0.0)
            birds.SetHeights(0.0, 0.0)
            birds.SetSeed(100 + number)
            birds.SetFirstObjectId(1000 * (number + 1))
            birds.Update()
            for k in range(20):
                poses = birds.GetOutputDataObject(0).GetBlock(k)
                still = al.mover(poses, [poses.GetFieldData().GetArray("pose_position").GetTuple(0)],
                                 orientations=[poses.GetFieldData().GetArray("pose_orientation").GetTuple(0)])
                for name in ("pose_time", "flap_hinge", "flap_axis", "flap_amplitude", "flap_frequency", "flap_phase"):
                    still.GetFieldData().RemoveArray(name)
                blocks.SetBlock(20 * number + k, still)
        echoes = al.Scan(al.Scene(), sensor, movers=blocks, visibility=reach.CLEAR, number_of_reflections=1,
                         seed=8).echoes
        seen = np.unique(echoes["object_id"][echoes["object_id"] >= 1000] // 1000)
        self.assertAlmostEqual(len(seen) / flocks, 0.5, delta=4.0 * 0.5 / math.sqrt(flocks))

    def test_numbers_and_forms_that_are_wrong(self):
        for words, call in (
                ("target 'bord' is not known; .*board:SIDE", lambda: reach.target("bord:1")),
                ("target is board, expected board:SIDE in m", lambda: reach.target("board")),
                ("target is wall:2, expected wall$", lambda: reach.target("wall:2")),
                ("target is sphere:x, expected sphere:DIAMETER with a number", lambda: reach.target("sphere:x")),
                ("target board:-1 is -1, expected above 0 to 100 m", lambda: reach.target("board:-1")),
                ("reflectance is nan, expected above 0 to 1", lambda: reach.target("wall", math.nan)),
                ("height is 5 m, expected no height for the target wall", lambda: reach.target("wall", height=5)),
                ("flock is 0, expected 1 to 1000", lambda: reach.flock("crow", 0))):
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                call()


class Verb(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.table = OUTPUT / "my.csv"
        cls.table.write_text(TABLE, "utf-8")

    def test_targets_of_the_command(self):
        with unittest.mock.patch.object(reach, "TARGETS", 8):
            code, lines, _ = run("--sensor", "VLP16", "--target", "person", "--target", "wall", "--reflectance", 0.4)
            person, wall = (reach.within_beams(al.Sensor("VLP16"), reach.target(form, 0.4),
                                               **reach.air_of(al.Sensor("VLP16"))) for form in ("person", "wall"))
        self.assertEqual(code, 0)
        self.assertEqual(re.split("  +", lines[1])[1], "person of 0.5 x 0.3 x 1.75 m (assumed), reflectance 0.4")
        for line, found in zip(lines[1:3], (person, wall)):
            cells = re.split("  +", line)[2:5]
            self.assertEqual([cell.split(" ")[0] for cell in cells],
                             [reach.metres(found.to(share)).split(" ")[0] for share in reach.SHARES])
            self.assertTrue(all(re.search(r" m \([0-9.]+ to [0-9.]+ m\)$", cell) for cell in cells), line)
        self.assertRegex(lines[4],
                         r"^VLP16 sees a wall, reflectance 0\.4, with half of the beams that meet it, to \d+ m \(\d+ "
                         r"to \d+ m\)\. At half of this range, one scan has [0-9.]+ points in a square metre\.$")

    def test_birds_of_a_table_and_their_flocks(self):
        code, lines, _ = run("--sensor", "Search905", "--birds", self.table)
        self.assertEqual(code, 0)
        for line, species in zip(lines[2:4], ("buzzard", "bunting")):
            found = reach.within_beams(al.Sensor("Search905"), species, species_file_name=str(self.table),
                                       visibility=reach.CLEAR)
            self.assertEqual(re.split("  +", line)[:4],
                             ["Search905", species, reach.metres(found.to(0.9)), reach.metres(found.to(0.5))])
        code, lines, _ = run("--sensor", "Search905", "--birds", self.table, "--species", "bunting", "--flock", 5)
        self.assertRegex(lines[-2],
                         r"^Search905 sees half of the flocks of 5 buntings in its beams to \d+ m\. At half of this "
                         r"range, one scan has [0-9.]+ points on a flock\.$")

    def test_options_that_are_wrong(self):
        for words, arguments in (
                (r"--height 2 is for the ground, expected --target ground as well", ("--height", 2)),
                (r"--flock 3 is for birds, expected --species or --birds as well", ("--target", "wall", "--flock", 3)),
                (r"SpeciesFileName .*none.csv cannot be read", ("--birds", OUTPUT / "none.csv")),
                (r"reflectance is 2, expected above 0 to 1", ("--target", "wall", "--reflectance", 2))):
            with self.subTest(words):
                self.assertRegex(helpertools.error_of("reach", "--sensor", "VLP16", *arguments), words)
