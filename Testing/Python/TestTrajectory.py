# SPDX-License-Identifier: BSD-3-Clause
"""A sensor on a platform that moves: poses, echoes and errors. Oracles: SciPy's interpolation of rotations, own
intersections of rays with planes, and that only relative motion matters."""
import pickle
import tempfile
import unittest

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

import avianlidar as al
from TestMovers import painted

TIMES = [0.0, 0.9, 2.5]  # s
PLACES = np.array([[0, 0, 2], [15, 7, 3], [40, -5, 2]], float)
TURNS = Rotation.from_euler("ZXY", [[-30, 2, 1], [-80, -3, 4], [-200, 1, 0]], degrees=True)
ARM, MOUNT = (0.3, -0.2, 1.1), (10.0, 5.0, -4.0)  # m; yaw, pitch and roll, deg
NARROW = 1e-9  # half-beamwidth, rad


def wxyz(turns):
    return turns.as_quat()[:, [3, 0, 1, 2]]


def moving():
    return al.trajectory(PLACES, TIMES, wxyz(TURNS))


def pose_at(times):
    """Positions and rotations of the platform by SciPy."""
    return np.stack([np.interp(times, TIMES, PLACES[:, k]) for k in range(3)], 1), Slerp(TIMES, TURNS)(times)


def wall(y=120.0, half=4000.0):
    return al.Scene(([(-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)], [(0, 1, 2), (0, 2, 3)]),
                    material="Wall")


def arrays_of(cloud):
    return {"points": cloud.points, **{name: cloud[name] for name in cloud}}


class TestTrajectory(unittest.TestCase):
    def assert_same_bits(self, one, other, left_out=()):
        for name, values in arrays_of(one).items():
            if name not in left_out:
                np.testing.assert_array_equal(values, arrays_of(other)[name], name)

    def test_beams_leave_the_interpolated_pose(self):
        on_platform = al.Sensor("Airport16", position=ARM, orientation=MOUNT).beams
        beams = al.Sensor("Airport16", position=ARM, orientation=MOUNT, trajectory=moving()).beams
        places, turns = pose_at(1e-6 * beams["timestamp"])
        np.testing.assert_allclose(beams.points, places + turns.apply(on_platform.points), rtol=0, atol=1e-12)
        np.testing.assert_allclose(beams["direction"], turns.apply(on_platform["direction"]), rtol=0, atol=1e-13)
        np.testing.assert_allclose(beams["sensor_position"], places + turns.apply(ARM), rtol=0, atol=1e-12)
        mounted = turns * Rotation.from_euler("ZXY", (-MOUNT[0], *MOUNT[1:]), degrees=True)
        found = Rotation.from_quat(beams["sensor_orientation"][:, [1, 2, 3, 0]])
        self.assertLess((found.inv() * mounted).magnitude().max(), 1e-13)
        x, y, z = beams["direction"].T
        np.testing.assert_allclose(beams["azimuth"], 100 * (np.degrees(np.arctan2(x, y)) % 360), atol=1e-9)
        np.testing.assert_allclose(beams["vertical_angle"], np.degrees(np.arcsin(z)), atol=1e-9)

    def test_fields_have_the_pose_at_the_start(self):
        """Yaw, pitch and roll give the same rotation, also for a sensor that looks straight down."""
        for mount in (MOUNT, (25.0, -90.0, 0.0)):
            fields = al.Sensor("Airport16", position=ARM, orientation=mount, trajectory=moving()).beams.fields
            np.testing.assert_allclose(fields["position"], PLACES[0] + TURNS[0].apply(ARM), atol=1e-12)
            expected = TURNS[0] * Rotation.from_euler("ZXY", (-mount[0], *mount[1:]), degrees=True)
            yaw, pitch, roll = fields["orientation"]
            found = Rotation.from_euler("ZXY", (-yaw, pitch, roll), degrees=True)
            self.assertLess((found.inv() * expected).magnitude(), 1e-12)

    def test_echoes_lie_where_rays_meet_the_wall(self):
        sensor = al.Sensor("Airport16", position=ARM, half_beamwidth=NARROW, lower_energy_limit=0,
                           trajectory=moving())
        echoes = al.Scan(wall(), sensor, noise=False).echoes
        self.assertGreater(echoes.number_of_points, 1000)
        beams = sensor.beams
        number = np.searchsorted(beams["beam_id"], echoes["beam_id"])
        places, turns = pose_at(1e-6 * beams["timestamp"][number])
        standing = al.Sensor("Airport16", position=ARM).beams
        origins, ways = places + turns.apply(ARM), turns.apply(standing["direction"][number])
        ranges = (120.0 - origins[:, 1]) / ways[:, 1]
        near = ranges < 1000
        np.testing.assert_allclose(echoes["distance_m"][near], ranges[near], rtol=0, atol=1e-9)
        np.testing.assert_allclose(echoes.points[near], (origins + ranges[:, None] * ways)[near], rtol=0, atol=1e-9)
        np.testing.assert_array_equal(echoes["timestamp"], beams["timestamp"][number])
        np.testing.assert_array_equal(echoes["sensor_position"], beams["sensor_position"][number])
        np.testing.assert_array_equal(echoes["sensor_orientation"], beams["sensor_orientation"][number])

    def test_a_wall_stays_flat(self):
        """A photon receiver errs along the beam by the stated standard deviation, and by nothing else."""
        sensor = al.Sensor("OS1_64", trajectory=al.trajectory(PLACES, [0, 0.04, 0.11], wxyz(TURNS)))
        echoes = al.Scan(wall(60.0), sensor).echoes
        seen = echoes["object_id"] == 0
        ways = echoes.points - echoes["sensor_position"]
        along = np.abs(ways[:, 1]) / np.linalg.norm(ways, axis=1)
        steep = seen & (along > 0.5)
        errors = (echoes.points[:, 1] - 60.0)[steep] / (echoes["distance_std_error"] * along)[steep]
        self.assertGreater(len(errors), 3000)
        # The range is quantized, and a tilted wall has a mean over the beam: within a tenth.
        self.assertLess(abs(np.std(errors) - 1.0), 0.1)

    def test_standing_is_the_mast_bit_by_bit(self):
        place, settings = (7.0, -3.0, 3.0), {"sway_amplitude": 0.02, "encoder_jitter": 0.01}
        scene = al.example_scene()
        mast = al.Scan(scene, al.Sensor("Search905", position=place, **settings)).echoes
        line = al.trajectory([place, place], [0, 9])
        standing = al.Scan(scene, al.Sensor("Search905", trajectory=line, **settings)).echoes
        self.assert_same_bits(mast, standing)
        for name, value in mast.fields.items():
            np.testing.assert_array_equal(value, standing.fields[name], name)

    def test_only_relative_motion_matters(self):
        """A mover that drives beside the sensor, in air that scatters light."""
        panel = painted([(-3, 30, -1), (3, 30, -1), (0, 30, 4)], [(0, 1, 2)])
        settings = {"visibility": 900.0, "noise": False}
        still = al.Scan(al.Scene(), al.Sensor("Search905", range_gate=200), movers=[al.mover(panel, [(0, 0, 0)])],
                        **settings).echoes
        beside = al.mover(panel, PLACES, times=TIMES, orientations=wxyz(TURNS))
        scan = al.Scan(al.Scene(), al.Sensor("Search905", range_gate=200, trajectory=moving()), movers=[beside],
                       **settings)
        echoes = scan.echoes
        self.assertGreater(echoes.number_of_points, 5)
        np.testing.assert_array_equal(still["beam_id"], echoes["beam_id"])
        np.testing.assert_allclose(still["distance_m"], echoes["distance_m"], rtol=0, atol=1e-9)
        np.testing.assert_allclose(still["energy_received"], echoes["energy_received"], rtol=1e-9)
        np.testing.assert_allclose(echoes.coordinates("sensor", motion_correction=False), still.points, atol=1e-9)
        self.assertGreater(np.abs(echoes.coordinates("sensor") - still.points).max(), 1.0)
        with tempfile.TemporaryDirectory() as folder:
            echoes.save(f"{folder}/a.ply")  # one field for each component
            read = al.load_cloud(f"{folder}/a.ply")
        np.testing.assert_allclose(read.coordinates("sensor", motion_correction=False), still.points, atol=1e-4)

    def test_threads_and_pieces_give_the_same_bits(self):
        sensor = al.Sensor("Search905", trajectory=moving(), position=ARM, sway_amplitude=0.1)
        one, four = (al.Scan(al.example_scene(), sensor, number_of_threads=n).echoes for n in (1, 4))
        self.assert_same_bits(one, four)
        whole, parts = sensor.beams, []
        for piece in range(3):
            sensor.algorithm.UpdatePiece(piece, 3, 0)
            part = al.Cloud(sensor.algorithm.GetOutput())
            parts.append({name: np.array(values) for name, values in arrays_of(part).items()})
        ids = np.concatenate([part["beam_id"] for part in parts])
        for name, values in arrays_of(whole).items():
            np.testing.assert_array_equal(np.concatenate([part[name] for part in parts])[np.argsort(ids)], values, name)

    def test_later_revolutions_and_a_copy(self):
        sensor = al.Sensor("Search905", range_gate=2000, trajectory=al.trajectory(PLACES, [0, 30, 100]))
        sensor.algorithm.UpdateTimeStep(7 / sensor.rotation_rate)
        seen = al.Cloud(sensor.algorithm.GetOutput())
        at = 1e-6 * seen["timestamp"]
        self.assertAlmostEqual(at.min(), 7 / sensor.rotation_rate, places=4)
        np.testing.assert_allclose(seen.points[:, 0], np.interp(at, [0, 30, 100], PLACES[:, 0]), atol=1e-12)
        copy = pickle.loads(pickle.dumps(sensor))
        copy.algorithm.UpdateTimeStep(7 / sensor.rotation_rate)
        self.assert_same_bits(seen, al.Cloud(copy.algorithm.GetOutput()))
        sensor.trajectory = None
        self.assertIsNone(sensor.trajectory)
        self.assertNotIn("sensor_position", sensor.beams)

    def test_errors_name_what_is_wrong(self):
        bad = al.trajectory(PLACES, TIMES, wxyz(TURNS) * [[1], [2], [1]])
        no_times = al.trajectory(PLACES, TIMES)
        no_times.GetPointData().RemoveArray("time")
        for line, words in (
                (al.trajectory(PLACES, [0, 0.5, 1]), "its poses are from 0 to 1 s, but the beams of revolution 0 are "
                 "from 0 to 1.99[0-9]+ s"),
                (al.trajectory(PLACES, [5, 6, 9]), "its poses are from 5 to 9 s"),
                (al.trajectory(PLACES, [0, 3, 3]), "pose 2: its time is not later"),
                (al.trajectory(PLACES * [[1], [np.nan], [1]], TIMES), "pose 1: its position is not finite"),
                (bad, "pose 1: length of pose_orientation is 2"), (no_times, "point array 'time' is missing")):
            with self.subTest(words):
                sensor = al.Sensor("Airport16", trajectory=line)
                with self.assertRaisesRegex(al.Error, r"Input port 0 \(trajectory\), .*" + words):
                    sensor.beams.points
                sensor.trajectory = moving()
                self.assertEqual(sensor.beams.number_of_points, 15360)
        with self.assertRaisesRegex(TypeError, "not list"):
            al.Sensor(trajectory=[1])
        with self.assertRaisesRegex(ValueError, "1 positions, 2 times and no orientations"):
            al.trajectory([(0, 0, 2)], [0, 1])
        with self.assertWarnsRegex(RuntimeWarning, "Position is 1838 m from the origin of the platform"):
            al.Sensor("Search905", range_gate=2000, position=(419, -1790, 5), trajectory=moving()).beams.points
        self.assertIn("trajectory 3 poses from 0 to 2.5 s", repr(al.Sensor(trajectory=moving())))


if __name__ == "__main__":
    unittest.main()
