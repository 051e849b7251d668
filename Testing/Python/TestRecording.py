# SPDX-License-Identifier: BSD-3-Clause
"""Recordings: numbered files, times, bags in every compression, nuScenes, and what is damaged."""
import datetime
import json
import pathlib
import sqlite3
import struct
import zlib

import lz4.frame
import numpy as np
import zstandard
from scipy.spatial.transform import Rotation

import avianlidar as al
from avianlidar import _bags, _ros
from avianlidar.vtkAvianLidar import vtkAvianLidarPointCloudReader
from avianlidar.apps.sequences import _rosbag
from cloudtools import pose_line, write_sequence
from echotools import InFolder
from helpertools import warned

UTC = datetime.timezone.utc
MOMENT = datetime.datetime(2023, 5, 17, 8, 59, 59, 250000, UTC)
SECONDS = MOMENT.timestamp()
TURNED = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])  # x forward, y left to x right, y forward


def points_of(count, seed=1):
    return np.random.default_rng(seed).uniform(-50, 50, (count, 3)).astype(np.float32)


def message(stamp, rows, frame="lidar", height=1, row_gap=0, big=False):
    """A PointCloud2 of a structured array, by the layout in the definition of the message."""
    kinds = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}
    fields = [(name, offset, kinds[kind.base.str[1:]], int(np.prod(kind.shape, dtype=int)))
              for name, (kind, offset, *_) in rows.dtype.fields.items()]
    width = len(rows) // height
    lines = [rows[k * width:(k + 1) * width].tobytes() + bytes(row_gap) for k in range(height)]
    return _ros.packed(_ros.CLOUD, (divmod(stamp, 10**9), frame), height, width, fields, big, rows.itemsize,
                       width * rows.itemsize + row_gap, b"".join(lines), True)


def transform(stamp, parent, child, place, turn):
    return _ros.packed(_ros.TRANSFORMS, [((divmod(stamp, 10**9), parent), child, (place, turn))])


def record(kind, content):
    return struct.pack("<BQ", kind, len(content)) + content


def text(content):
    return struct.pack("<I", len(content)) + content


def mcap(file, messages, compression="", cut=0, checksum=None):
    """Writes messages (topic, kind, time, data) as chunks of two messages, without any index."""
    pack = {"": bytes, "lz4": lz4.frame.compress, "zstd": zstandard.ZstdCompressor().compress}[compression]
    topics = {topic: (number, kind) for number, (topic, kind) in enumerate(dict(m[:2] for m in messages).items(), 1)}
    known = b"".join(record(3, struct.pack("<H", n) + text(kind.replace("/", "/msg/").encode()) + text(b"ros2msg")
                            + text(b"")) + record(4, struct.pack("<HH", n, n) + text(topic.encode()) + text(b"cdr")
                                                  + text(b"")) for topic, (n, kind) in topics.items())
    content = b"\x89MCAP0\r\n" + record(1, text(b"ros2") + text(b"test"))
    for k in range(0, len(messages), 2):
        inner = known if k == 0 else b""
        for topic, _, time, data in messages[k:k + 2]:
            inner += record(5, struct.pack("<HIQQ", topics[topic][0], k, time, time) + data)
        small, check = pack(inner), zlib.crc32(inner) if checksum is None else checksum
        content += record(6, struct.pack("<QQQI", 0, 0, len(inner), check) + text(compression.encode())
                          + struct.pack("<Q", len(small)) + small)
    content += record(15, bytes(4)) + record(2, bytes(20)) + b"\x89MCAP0\r\n"
    pathlib.Path(file).parent.mkdir(exist_ok=True)
    pathlib.Path(file).write_bytes(content[:len(content) - cut])
    return file


def db3(file, messages, compress=False):
    db = sqlite3.connect(file)
    db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
               "offered_qos_profiles TEXT)")
    db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
    topics = dict(m[:2] for m in messages)
    for number, (topic, kind) in enumerate(topics.items(), 1):
        db.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", (number, topic, kind.replace("/", "/msg/")))
    for topic, _, time, data in messages:
        data = zstandard.ZstdCompressor().compress(data) if compress else data
        db.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                   (list(topics).index(topic) + 1, time, data))
    db.commit()
    db.close()


class Files(InFolder):
    def write(self, *names, folder="."):
        """Scans of 3, 4, ... points in files of these names."""
        home = self.folder / folder
        home.mkdir(parents=True, exist_ok=True)
        for number, name in enumerate(names):
            suffix = name.rpartition(".")[2]
            if suffix == "bin":
                np.hstack([points_of(3 + number), np.full((3 + number, 1), 0.5, np.float32)]).tofile(home / name)
            else:
                cloud = al.Cloud(type("points", (), {"points": points_of(3 + number)})())
                al.save(cloud, home / name)
        return home

    def check(self, source, times, origin, counts=None, **options):
        recording = al.load_clouds(source, **options)
        np.testing.assert_allclose(recording.times, times, rtol=0, atol=1e-6)
        self.assertIn(origin, recording.times_from)
        counts = [*range(3, 3 + len(times))] if counts is None else counts
        clouds = list(recording)
        self.assertEqual([cloud.number_of_points for cloud in clouds], counts)
        np.testing.assert_allclose([cloud.fields["TimeValue"] for cloud in clouds], times, rtol=0, atol=1e-6)

    def test_formats_without_times(self):
        """Numbers count at 10 Hz, which is assumed, and a missing number is a gap."""
        for suffix in ("pcd", "las", "ply", "csv", "vtp", "bin"):
            with self.subTest(suffix):
                home = self.write(*(f"16_scan_{k}.{suffix}" for k in (9, 10, 11, 13)), folder=suffix)
                self.check(home, [0, 0.1, 0.2, 0.4], "10 scans a second, assumed")
        self.check(str(home / "*_1?.bin"), [0, 0.1, 0.3], "assumed", [4, 5, 6])
        self.check(home, [0, 0.05, 0.1, 0.2], "20 scans a second, as given", rate=20)
        self.check([home / "16_scan_13.bin", home / "16_scan_9.bin"], [0, 0.4], "assumed", [3, 6])
        self.check(home / "16_scan_13.bin", [0], "one file", [6])
        words = self.write("b.pcd", "a.pcd", folder="words")
        self.check([words / "b.pcd", words / "a.pcd"], [0, 0.1], "assumed")

    def test_times_in_names(self):
        later = [MOMENT + datetime.timedelta(seconds=k / 4) for k in range(3)]
        expected = [SECONDS, SECONDS + 0.25, SECONDS + 0.5]
        forms = {
            "ns": [f"{round(one.timestamp() * 4) * 250000000}.pcd" for one in later],
            "us": [f"n015-2018-07-24-11-22-45+0800__LIDAR_TOP__{round(1e6 * one.timestamp())}.pcd" for one in later],
            "ms": [f"scan{round(1e3 * one.timestamp())}.pcd" for one in later],
            "s_ns": [f"{int(one.timestamp())}.{one.microsecond:06d}000.pcd" for one in later],
            "iso": [f"{one:%Y-%m-%dT%H-%M-%S}.{one.microsecond:06d}Z.pcd" for one in later],
            "short": [f"a_{one:%Y%m%d_%H%M%S}.{one.microsecond:06d}_b.pcd" for one in later],
            "zone": [f"{one.astimezone(datetime.timezone(datetime.timedelta(hours=-7))):%Y-%m-%d %H:%M:%S.%f%z}.pcd"
                     for one in later],
            "hours": [f"{one.astimezone(datetime.timezone(datetime.timedelta(hours=8))):%Y-%m-%dT%H-%M-%S.%f}+08.pcd"
                      for one in later],
            "dash": [f"{one:%Y-%m-%d-%H-%M-%S}-{one.microsecond:06d}.pcd" for one in later],
            "compact": [f"{one:%Y%m%d%H%M%S}{one.microsecond // 1000:03d}.pcd" for one in later],
            "s.ms": [f"{int(one.timestamp())}.{one.microsecond // 1000:03d}.pcd" for one in later],
            "s.us": [f"{int(one.timestamp())}.{one.microsecond:06d}.pcd" for one in later]}
        for form, names in forms.items():
            with self.subTest(form):
                self.check(self.write(*names, folder=form), expected, "names of the files, s since 1970")
        self.check(self.write(*(f"{int(SECONDS) + k}.pcd" for k in range(2)), folder="s"),
                   [int(SECONDS), int(SECONDS) + 1], "since 1970")
        self.check(self.write("sn1234567890_001.pcd", "sn1234567890_003.pcd", folder="serial"), [0, 0.2], "assumed")
        self.check(self.write("0000000001.pcd", "0000000003.pcd", folder="kitti"), [0, 0.2], "assumed")
        self.check(self.write("20231345_101010.pcd", "20231346_101010.pcd", folder="no-day"), [0, 0.1], "assumed")

    def test_files_of_times(self):
        home = self.write("000000.bin", "000002.bin", folder="00/velodyne")
        (self.folder / "00/times.txt").write_text("1.5\n2.5\n\n4.0\n")
        self.check(self.folder / "00", [1.5, 4.0], "times.txt")
        self.check([str(one) for one in home.iterdir()], [1.5, 4.0], "times.txt")
        raw = self.write("a.pcd", "b.pcd", folder="raw/velodyne_points/data")
        (raw.parent / "timestamps.txt").write_text("2023-05-17 08:59:59.250000000\n2023-05-17 08:59:59.350000000\n")
        self.check(self.folder / "raw", [SECONDS, SECONDS + 0.1], "timestamps.txt")
        for content, words in (("1\n", "has 1 times, expected one for each of 2 scans"), ("1\nx\n", 'line 2 has "x"'),
                               ("1\n1\n", "have the same time, 1 s")):
            (raw.parent / "timestamps.txt").write_text(content)
            with self.assertRaisesRegex(al.Error, words):
                al.load_clouds(self.folder / "raw")

    def test_refusals(self):
        home = self.write("a.pcd", "b.las", folder="mixed")
        two = self.write("left_0.pcd", "right_0.pcd", ".hidden.pcd", folder="two")
        for source, words in ((two, "left_0.pcd and right_0.pcd, expected names that differ by numbers alone"),
                              (home, "has 1 .pcd, 1 .las, expected the files of one kind"),
                              (self.folder / "none", "no such file or folder"),
                              (self.folder / "*.pcd", "is not a recording: expected numbered files"),
                              ([], "is not a recording"),
                              (__file__, "is not a recording: .*TestRecording.py: expected")):
            with self.assertRaisesRegex((ValueError, OSError), words):
                al.load_clouds(source)
        for options, words in (({"rate": 0}, "rate is 0, expected above 0"), ({"rate": float("nan")}, "rate is nan"),
                               ({"topic": "/a"}, "topic is '/a', expected none")):
            with self.assertRaisesRegex(ValueError, words):
                al.load_clouds(home / "a.pcd", **options)

    def test_time_steps_of_vtk(self):
        home = self.write(*(f"{k}.pcd" for k in (0, 2, 4)))
        reader = vtkAvianLidarPointCloudReader()
        for name in (4, 0, 2):
            reader.AddFileName(str(home / f"{name}.pcd"))
        for time, count in ((-1, 3), (0.2, 4), (0.39, 4), (7, 5)):
            reader.UpdateTimeStep(time)
            self.assertEqual(reader.GetOutput().GetNumberOfPoints(), count)
        field = reader.GetOutput().GetFieldData().GetAbstractArray("scan_times")
        self.assertEqual(field.GetValue(0), "10 scans a second, assumed")
        self.assertEqual([reader.GetScanFileName(k) for k in (-1, 1, 3)], [None, str(home / "2.pcd"), None])
        reader.SetFileName(str(home / "4.pcd"))
        reader.Update()
        self.assertEqual((reader.GetNumberOfFileNames(), reader.GetOutput().GetNumberOfPoints()), (1, 5))


class Bags(InFolder):
    def setUp(self):
        super().setUp()
        self.kind = np.dtype({"names": ["x", "y", "z", "intensity", "ring", "t", "pair"],
                              "formats": ["<f4", "<f4", "<f4", "<f4", "<u2", "<u4", ("<f4", 2)],
                              "offsets": [0, 4, 8, 16, 20, 24, 28], "itemsize": 48})
        self.rows = np.zeros(24, self.kind)
        self.rows["x"], self.rows["y"], self.rows["z"] = points_of(24).T
        self.rows["intensity"], self.rows["ring"] = np.arange(24) * 10.0, np.arange(24) % 4
        self.rows["t"] = np.arange(24) * 1000000
        self.rows["pair"] = np.arange(48).reshape(24, 2)
        self.stamps = [10**18 + k * 10**8 + 1 for k in range(5)]
        self.messages = [("/points", _ros.CLOUD, stamp, message(stamp, self.rows)) for stamp in self.stamps]

    def check_rows(self, cloud, rows=None):
        rows = self.rows if rows is None else rows
        np.testing.assert_array_equal(cloud.points, np.stack([-rows["y"], rows["x"], rows["z"]], axis=1))
        np.testing.assert_array_equal(cloud["laser_id"], rows["ring"])
        np.testing.assert_array_equal(cloud["intensity"], rows["intensity"])
        np.testing.assert_array_equal(cloud["pair"], rows["pair"])

    def test_containers_and_compressions(self):
        writers = [lambda file, kind=kind: mcap(file, self.messages, kind) for kind in ("", "lz4", "zstd")]
        writers += [lambda file, zipped=zipped: db3(file, self.messages, zipped) for zipped in (False, True)]
        for number, writer in enumerate(writers):
            with self.subTest(number):
                file = self.folder / f"{number}.{'mcap' if number < 3 else 'db3'}"
                writer(file)
                recording = al.load_clouds(file)
                np.testing.assert_allclose(recording.times, 1e-9 * np.array(self.stamps), rtol=1e-15)
                clouds = list(recording)
                self.assertEqual((len(clouds), recording.left_out, recording.poses), (5, {}, None))
                self.check_rows(clouds[4])
                np.testing.assert_allclose(clouds[1]["timestamp"], 1e-3 * self.stamps[1] + 1000.0 * np.arange(24), rtol=1e-15)
                self.assertEqual(clouds[1].units["timestamp"], "us")

    def test_bags_of_ros_1(self):
        """As rosbag writes them, compressed and not."""
        import genpy
        import geometry_msgs.msg
        import rosbag
        import sensor_msgs.msg
        import tf2_msgs.msg
        fields = [sensor_msgs.msg.PointField(name, offset, {"f4": 7, "u2": 4, "u4": 6}[kind.base.str[1:]],
                                             int(np.prod(kind.shape, dtype=int)))
                  for name, (kind, offset, *_) in self.rows.dtype.fields.items()]
        for compression in ("none", "bz2", "lz4"):
            file = self.folder / f"{compression}.bag"
            with rosbag.Bag(str(file), "w", compression=compression) as bag:
                for number, stamp in enumerate(self.stamps):
                    cloud = sensor_msgs.msg.PointCloud2(height=1, width=24, fields=fields, point_step=48,
                                                        row_step=48 * 24, data=self.rows.tobytes(), is_dense=True)
                    cloud.header.stamp, cloud.header.frame_id = genpy.Time(*divmod(stamp, 10**9)), "velodyne"
                    bag.write("/points", cloud, genpy.Time(number + 1))
                pose = geometry_msgs.msg.TransformStamped(child_frame_id="velodyne")
                pose.header.frame_id, pose.transform.translation.z, pose.transform.rotation.w = "map", 2.5, 1.0
                bag.write("/tf_static", tf2_msgs.msg.TFMessage([pose]), genpy.Time(1))
            recording = al.load_clouds(file)
            np.testing.assert_allclose(recording.times, 1e-9 * np.array(self.stamps), rtol=1e-15)
            self.check_rows(list(recording)[4])
            np.testing.assert_allclose(recording.pose(2)[:, 3], (0, 0, 2.5))
        (self.folder / "no.bag").write_bytes(b"nothing")
        with self.assertRaisesRegex(ValueError, "no.bag: is not a bag of ROS 1"):
            al.load_clouds(self.folder / "no.bag")
        (self.folder / "cut.bag").write_bytes(file.read_bytes()[:-300])
        with self.assertRaisesRegex(ValueError, "cut.bag: (has no index|is not a bag)"):
            al.load_clouds(self.folder / "cut.bag")

    def test_the_folder_of_a_bag(self):
        """Parts in the order of their numbers, not of their names."""
        for number, place in ((10, slice(3, 5)), (9, slice(0, 3))):
            mcap(self.folder / f"bag_{number}.mcap", self.messages[place])
        (self.folder / "metadata.yaml").write_text("rosbag2_bagfile_information:\n")
        self.assertEqual((len(al.load_clouds(self.folder)), al.load_clouds(self.folder).left_out), (5, {}))
        (packed := self.folder / "zipped").mkdir()
        (packed / "a_0.db3.zstd").write_bytes(b"")
        with self.assertRaisesRegex(ValueError, "a_0.db3.zstd is compressed as a whole"):
            al.load_clouds(packed)

    def test_layouts(self):
        """Rows with gaps, the other byte order, empty cells, empty clouds, and doubles."""
        swapped = self.rows.astype(self.rows.dtype.newbyteorder(">"))
        empty = self.rows.copy()
        empty["x"][[3, 7]] = np.nan
        silent = self.rows.copy()
        for axis in "xyz":
            silent[axis][[2, 5]] = 0  # no echo
        for data, rows in ((message(1, self.rows, height=4, row_gap=5), self.rows),
                           (message(1, swapped, big=True), self.rows), (message(1, empty), np.delete(empty, [3, 7])),
                           (message(1, silent), np.delete(silent, [2, 5])),
                           (message(1, self.rows[:0]), self.rows[:0])):
            mcap(self.folder / "a.mcap", [("/points", _ros.CLOUD, 1, data)])
            (cloud,) = al.load_clouds(self.folder / "a.mcap")
            self.check_rows(cloud, rows)

    def test_times_of_points(self):
        """Of Velodyne (s), Ouster (ns), Hesai (s since 1970), Livox (ns since 1970, as doubles), and others."""
        offsets, stamp = np.arange(24) * 1e-3, 1_700_000_000_500_000_000  # s; ns
        for name, kind, values in (("time", "<f4", offsets), ("time", "<f4", offsets - 0.1), ("t", "<u4", 1e9 * offsets),
                                   ("time", "<u4", 1e6 * offsets),
                                   ("timestamp", "<f8", 1.7e9 + 0.5 + offsets),
                                   ("timestamp", "<f8", 1.7e18 + 5e8 + 1e9 * offsets)):
            rows = np.zeros(24, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), (name, kind)])
            rows["x"], rows[name] = 1, values
            mcap(self.folder / "a.mcap", [("/points", _ros.CLOUD, stamp, message(stamp, rows))])
            (cloud,) = al.load_clouds(self.folder / "a.mcap")
            shift = -0.1 if values[0] < 0 else 0
            np.testing.assert_allclose(cloud["timestamp"], 1e6 * (1.7e9 + 0.5 + offsets + shift), rtol=0, atol=1)

    def test_topics(self):
        both = self.messages + [("/other", _ros.CLOUD, 5, message(5, self.rows[:7]))]
        mcap(self.folder / "a.mcap", both)
        with self.assertRaisesRegex(ValueError, r"clouds in /points \(5\), /other \(1\), expected the choice of one"):
            al.load_clouds(self.folder / "a.mcap")
        with self.assertRaisesRegex(ValueError, "has no clouds in /mine, expected one of /points"):
            al.load_clouds(self.folder / "a.mcap", topic="/mine")
        (cloud,) = al.load_clouds(self.folder / "a.mcap", topic="/other")
        self.check_rows(cloud, self.rows[:7])
        mcap(self.folder / "b.mcap", [("/velodyne_packets", "velodyne_msgs/VelodyneScan", 5, b"\0\1\0\0")])
        with self.assertRaisesRegex(ValueError, "has no message of sensor_msgs/PointCloud2"):
            al.load_clouds(self.folder / "b.mcap")

    def test_poses(self):
        """map to base moves and turns, base to lidar stands still; poses between two times are interpolated."""
        half = Rotation.from_euler("z", 60, degrees=True)
        mount = Rotation.from_euler("x", 90, degrees=True)
        tf = [("/tf_static", _ros.TRANSFORMS, 0, transform(0, "base", "lidar", (0, 0, 2), mount.as_quat()))]
        tf += [("/tf", _ros.TRANSFORMS, stamp, transform(stamp, "/map", "base", place, turn.as_quat()))
               for stamp, place, turn in ((self.stamps[0], (0, 0, 0), Rotation.identity()),
                                          (self.stamps[4], (8, 0, 4), half))]
        mcap(self.folder / "a.mcap", self.messages + tf)  # transforms come late
        recording = al.load_clouds(self.folder / "a.mcap")
        self.assertTrue(recording.moves)
        for k in range(5):
            base = Rotation.from_euler("z", 15 * k, degrees=True)
            expected = base.as_matrix() @ mount.as_matrix() @ TURNED.T
            np.testing.assert_allclose(recording.pose(k)[:, :3], expected, atol=1e-6)
            np.testing.assert_allclose(recording.pose(k)[:, 3], (2 * k, 0, k + 2), atol=1e-6)
        self.assertTrue(al.load_clouds(self.folder / "a.mcap").poses)
        mcap(self.folder / "b.mcap", self.messages + tf[:1])
        self.assertFalse(al.load_clouds(self.folder / "b.mcap").moves)
        again = [("/tf_static", _ros.TRANSFORMS, 9, transform(9 * 10**9, "base", "lidar", (5, 0, 2), (0, 0, 0, 1)))]
        mcap(self.folder / "d.mcap", self.messages + tf[:1] + again)  # the last one holds for all scans
        np.testing.assert_allclose(al.load_clouds(self.folder / "d.mcap").pose(0)[:, 3], (5, 0, 2))
        early = [tf[0], *(("/tf", _ros.TRANSFORMS, k, transform(self.stamps[k], "map", "base", (k, 0, 0), (0, 0, 0, 1)))
                          for k in (0, 1))]
        recording, heard = warned(lambda: al.load_clouds(mcap(self.folder / "e.mcap", self.messages + early)))
        self.assertRegex(" ".join(heard), "1 of 5 scans are before the first or after the last pose of /tf")
        bad = [("/tf", _ros.TRANSFORMS, 0, transform(0, "map", "lidar", (0, 0, 0), (0, 0, 0, 0)))]
        mcap(self.folder / "f.mcap", self.messages + bad)
        with self.assertRaisesRegex(ValueError, "f.mcap: a message of /tf gives lidar .* expected finite numbers and a unit"):
            al.load_clouds(self.folder / "f.mcap")
        loop = [("/tf", _ros.TRANSFORMS, 0, transform(0, a, b, (0, 0, 0), (0, 0, 0, 1)))
                for a, b in (("map", "lidar"), ("lidar", "map"))]
        mcap(self.folder / "c.mcap", self.messages + loop)
        with self.assertRaisesRegex(ValueError, "is above itself"):
            al.load_clouds(self.folder / "c.mcap")

    def test_what_is_torn_or_late(self):
        mcap(self.folder / "a.mcap", self.messages, cut=400)
        recording, heard = warned(lambda: al.load_clouds(self.folder / "a.mcap"))
        self.assertEqual((len(list(recording)), recording.left_out), (4, {}))
        self.assertRegex(" ".join(heard), "a.mcap: ends within a record: its last scans may be missing")
        for number, part in enumerate((self.messages[:2], self.messages[2:4], self.messages[4:])):
            mcap(self.folder / f"parts/bag_{number}.mcap", part, cut=400 if number == 1 else 0)
        recording, heard = warned(lambda: al.load_clouds(self.folder / "parts"))
        self.assertEqual(len(list(recording)), 3)  # the part behind the torn one is read
        self.assertRegex(" ".join(heard), "bag_1.mcap: ends within a record")
        (self.folder / "parts/metadata.yaml").write_text("  relative_file_paths:\n    - bag_0.mcap\n    - bag_7.mcap\n")
        _, heard = warned(lambda: al.load_clouds(self.folder / "parts"))
        self.assertRegex(" ".join(heard), "names bag_7.mcap, which is missing .1 of 2 parts")
        late = [self.messages[k] for k in (0, 2, 1, 2, 3)]
        late.insert(2, ("/points", _ros.CLOUD, 1, message(0, self.rows)))
        late.insert(4, ("/points", _ros.CLOUD, 5, self.messages[0][3][:300]))
        mcap(self.folder / "b.mcap", late)
        recording, heard = warned(lambda: al.load_clouds(self.folder / "b.mcap"))
        self.assertEqual(len(list(recording)), 4)  # in the order of their times
        np.testing.assert_allclose(recording.times, 1e-9 * np.array(self.stamps[:4]), rtol=1e-15)
        self.assertEqual([*recording.left_out.items()][:1], [("without a time", 1)])
        self.assertEqual(recording.left_out["of the same time as the scan before"], 1)
        self.assertRegex(" ".join(heard), "b.mcap: 1 scan is left out: damaged: ends within")
        unset = [("/points", _ros.CLOUD, 7, message(0, self.rows))]  # a driver without a clock
        mcap(self.folder / "c.mcap", unset)
        self.assertAlmostEqual(al.load_clouds(self.folder / "c.mcap").times[0], 7e-9, delta=1e-20)

    def test_damage(self):
        whole = message(1, self.rows)
        short = np.zeros(2, [("x", "<f4"), ("y", "<f4")])
        for data, words in ((b"\0\3\0\0" + whole[4:], "not CDR"), (whole[:30], "ends"), (whole[:100], "ends"),
                            (message(1, short), "has the fields x, y, expected x, y and z"),
                            (whole[:-200], "ends within")):
            mcap(self.folder / "a.mcap", [("/points", _ros.CLOUD, 1, data)])
            with self.assertRaisesRegex(ValueError, f"a.mcap.*{words}"):
                list(al.load_clouds(self.folder / "a.mcap"))
        mcap(self.folder / "b.mcap", self.messages, checksum=5)
        with self.assertRaisesRegex(ValueError, "b.mcap: a chunk does not have its checksum"):
            al.load_clouds(self.folder / "b.mcap")
        for name, content, words in (("c.mcap", b"nothing at all", "is not an MCAP file"),
                                     ("c.db3", b"nothing at all" * 100, "is not a bag of ROS 2")):
            (self.folder / name).write_bytes(content)
            with self.assertRaisesRegex(ValueError, words):
                al.load_clouds(self.folder / name)
        good = (self.folder / "d.mcap")
        mcap(good, self.messages, "zstd")
        content = bytearray(good.read_bytes())
        rng = np.random.default_rng(5)
        for _ in range(300):  # never another kind of error than one that names the file
            broken = bytearray(content)
            for place in rng.integers(8, len(content), 3):
                broken[place] = rng.integers(256)
            good.write_bytes(broken)
            try:
                warned(lambda: list(al.load_clouds(good)))
            except ValueError as error:
                self.assertIn("d.mcap", str(error))

    def test_sequences_come_back(self):
        """Points of .bin, .mcap and .db3 are the same, bit by bit."""
        chance = np.random.default_rng(3)
        scans = [(chance.random((count, 4), np.float32), chance.integers(0, 2**32, count, np.uint32))
                 for count in (5, 0, 700)]
        turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])
        write_sequence(self.folder / "00", scans, (0, 2.5, 1234567.000001), pose_line(turn, (10, -20, 3)))
        first = al.load_clouds(self.folder / "00")
        for suffix in (".mcap", ".db3"):
            self.assertEqual(_rosbag.write(self.folder / "00", self.folder / f"out{suffix}"), 3)
            second = al.load_clouds(self.folder / f"out{suffix}")
            np.testing.assert_allclose(second.times, first.times, rtol=0, atol=1e-9)
            np.testing.assert_allclose(second.poses, first.poses, atol=1e-12)
            np.testing.assert_allclose(first.pose(0), np.column_stack([turn @ TURNED.T, (10, -20, 3)]), atol=1e-12)
            for one, two in zip(first, second, strict=True):
                self.assertEqual(one.points.tobytes(), two.points.tobytes())
                for name in ("semantic_label", "instance_id"):
                    np.testing.assert_array_equal(one[name], two[name])


class NuScenes(InFolder):
    def test_scenes(self):
        turn = Rotation.from_euler("z", 30, degrees=True)
        quaternion = [turn.as_quat()[k] for k in (3, 0, 1, 2)]
        tables = {"scene": [{"token": "s1", "name": "scene-1"}, {"token": "s2", "name": "scene-2"}],
                  "sample": [{"token": "a", "scene_token": "s1"}, {"token": "b", "scene_token": "s2"}],
                  "ego_pose": [{"token": "e", "rotation": quaternion, "translation": [100, 200, 0]}],
                  "calibrated_sensor": [{"token": "c", "rotation": [1, 0, 0, 0], "translation": [1, 0, 2]}],
                  "sample_data": []}
        for sample, time in (("b", 3), ("a", 2), ("a", 1)):
            name = f"sweeps/LIDAR_TOP/n__LIDAR_TOP__{time}.pcd.bin"
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            rows = np.hstack([points_of(20 * time), np.full((20 * time, 1), 200), np.full((20 * time, 1), 31)])
            rows.astype("<f4").tofile(self.folder / name)
            tables["sample_data"].append({"filename": name, "timestamp": 10**6 * time, "sample_token": sample,
                                          "ego_pose_token": "e", "calibrated_sensor_token": "c"})
        (self.folder / "v1.0-mini").mkdir()
        for name, rows in tables.items():
            (self.folder / "v1.0-mini" / f"{name}.json").write_text(json.dumps(rows))
        recording = al.load_clouds(self.folder, topic="scene-1")
        np.testing.assert_array_equal(recording.times, [1, 2])
        clouds = list(recording)
        np.testing.assert_array_equal(clouds[1].points, points_of(40))
        self.assertEqual(set(clouds[0]["laser_id"]), {31})
        np.testing.assert_allclose(recording.pose(0)[:, 3], turn.apply([1, 0, 2]) + [100, 200, 0])
        with self.assertRaisesRegex(ValueError, "has the scans of scene-1, scene-2, expected the choice of one scene"):
            al.load_clouds(self.folder)
        (self.folder / "v1.0-mini" / "sample.json").write_text("[{}]")
        with self.assertRaisesRegex(ValueError, "v1.0-mini: its tables lack 'token'"):
            al.load_clouds(self.folder)
