# SPDX-License-Identifier: BSD-3-Clause
"""Packets of a VLP-16 in pcap and pcapng files: points in closed form, those of a real revolution as another program
decoded it, files of every kind, and every way in which they can be wrong."""
import os
import pathlib
import struct
import unittest
import warnings

import numpy as np
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

import avianlidar
from avianlidar import vtkAvianLidar as al
from cloudtools import field, points, read, read_error, unit
from echotools import InFolder, Messages, array
from helpertools import error_of, run

FILE = "TestPacketReader.pcap"
REAL = pathlib.Path(os.environ.get("AVIANLIDAR_DATA_DIR", "none")) / "lidar_vlp16_mrpt"
STRONGEST, LAST, DUAL = 0x37, 0x38, 0x39
ELEVATIONS = np.array([-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15])  # as the lasers fire


def payload(azimuth, time=0, mode=STRONGEST, step=40, value=lambda block, shot: (5000, 100), product=0x22):
    """The bytes of a packet that begins at an azimuth (0.01 deg), with (distance / 2 mm, reflectivity) of each shot."""
    blocks = b""
    for block in range(12):
        turned = (azimuth + step * (block // 2 if mode == DUAL else block)) % 36000
        blocks += struct.pack("<HH", 0xEEFF, turned) + b"".join(struct.pack("<HB", *value(block, shot))
                                                                for shot in range(32))
    return blocks + struct.pack("<IBB", time, mode, product)


def datagram(data, port=2368, options=b"", fragment=0, protocol=17, last=201):
    """IPv4 with UDP."""
    udp = struct.pack(">HHHH", 2368, port, 8 + len(data), 0) + data
    head = struct.pack(">BBHHHBBH4s4s", 0x45 + len(options) // 4, 0, 20 + len(options) + len(udp), 0, fragment, 64,
                       protocol, 0, bytes([192, 168, 1, last]), bytes([255] * 4))
    return head + options + udp


def ethernet(data, tags=b"", **options):
    return bytes(12) + tags + b"\x08\x00" + datagram(data, **options)


def pcap(frames, link=1, order="<", magic=0xA1B2C3D4):
    head = struct.pack(order + "IHHiIII", magic, 2, 4, 0, 0, 65535, link)
    return head + b"".join(struct.pack(order + "IIII", 0, 0, len(frame), len(frame)) + frame for frame in frames)


def pcapng(frames, order="<", simple=False, old=False):
    def block(kind, body):
        body += bytes(-len(body) % 4)
        return struct.pack(order + "II", kind, 12 + len(body)) + body + struct.pack(order + "I", 12 + len(body))
    whole = block(0x0A0D0D0A,
                  struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1)) + block(1, struct.pack(order + "HHI", 1, 0, 0))
    whole += block(5, bytes(12))  # statistics, which are passed over
    for frame in frames:
        head = struct.pack(order + "I", len(frame)) if simple else struct.pack(
            order + "IIIII", 0, 0, 0, len(frame), len(frame))
        whole += block(3 if simple else 6, head + frame) if not old else block(
            2, struct.pack(order + "HHIIII", 0, 0, 0, 0, len(frame), len(frame)) + frame)
    return whole


def write(data):
    pathlib.Path(FILE).write_bytes(data)


def times_of(reader):
    reader.UpdateInformation()
    return reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())


def turns():
    """The revolutions of the file, and their times."""
    reader = al.vtkAvianLidarPointCloudReader()
    heard = Messages(reader)
    reader.SetFileName(FILE)
    found = []
    for time in times_of(reader):
        reader.UpdateTimeStep(time)
        found.append(avianlidar.Cloud(reader.GetOutput()))
        assert reader.GetOutput().GetInformation().Get(reader.GetOutput().DATA_TIME_STEP()) == time
    assert not heard.errors, heard.errors
    return found, times_of(reader)


class TestPacketReader(InFolder):
    def test_points_in_closed_form(self):
        write(pcap([ethernet(payload(9000, 1000, value=lambda block, shot: (1000 * block + shot, block)))]))
        data = read(FILE)
        block, shot = np.divmod(np.arange(1, 12 * 32), 32)  # the first has no return
        after = 55.296 * (shot // 16) + 2.304 * (shot % 16)  # us; the manual, "Firing sequence timing"
        turned = 9000 + 40 * block + 40 * after / 110.592
        wanted = 0.002 * (1000 * block + shot)
        up = ELEVATIONS[shot % 16]
        for name, values, unit_ in (("distance_m", wanted, "m"), ("azimuth", turned, "0.01 deg"),
                                    ("vertical_angle", up, "deg"), ("timestamp", 1000 + 110.592 * block + after, "us"),
                                    ("intensity", block, "1"), ("laser_id", (up + 15) // 2, None),
                                    ("return_number", 1, "1"), ("number_of_returns", 1, "1")):
            self.assertTrue(np.allclose(array(data, name), values, rtol=1e-15, atol=0), name)
            self.assertEqual(unit(data, name), unit_)
        a, e = np.radians(turned / 100), np.radians(up)
        places = wanted[:, None] * np.column_stack([np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)])
        self.assertLess(np.abs(points(data) - places).max(), 1e-13)
        self.assertEqual((field(data, "revolution"), field(data, "number_of_revolutions")), ([0], [1]))

    def test_two_returns(self):
        # last, strongest
        ranges = {0: (1000, 3000), 1: (2000, 2000), 2: (0, 700), 3: (3000, 1000), 4: (0, 0), 5: (600, 0)}
        write(pcap([ethernet(payload(100, mode=DUAL, value=lambda block, shot: (ranges[shot % 6][block % 2], block)))]))
        data = read(FILE)
        first = np.floor((array(data, "azimuth") - 100) / 40) == 0
        seen = {}
        for distance, laser, number, count in zip(*(array(data, name)[first] for name in (
                "distance_m", "vertical_angle", "return_number", "number_of_returns"))):
            seen.setdefault(laser, []).append((round(distance / 0.002), number, count))
        two = [(1000, 1, 2), (3000, 2, 2)]
        self.assertEqual((seen[-15][:2], seen[3][:2]), (two, two))
        self.assertEqual((seen[1][0], seen[-13][0], seen[5][0]), ((2000, 1, 1), (700, 1, 1), (600, 1, 1)))
        self.assertTrue(array(data, "azimuth").max() < 100 + 6 * 40 and array(data, "timestamp").max() < 6 * 110.592)

    def test_revolutions_are_time_steps(self):
        write(pcap([ethernet(payload(18000 + 480 * number, int(3_599_950_000 + 1327.104 * number) % 3_600_000_000))
                    for number in range(3 * 75)]))
        found, times = turns()
        self.assertEqual([cloud.number_of_points for cloud in found], [n * 384 for n in (37.5, 75, 75, 37.5)])
        wanted = [3599.95 + 1e-6 * 1327.104 * n for n in (0, 37.5, 112.5, 187.5)]
        self.assertTrue(np.allclose(times, wanted, rtol=0, atol=1.1e-6))  # across the full hour
        for number, (cloud, start) in enumerate(zip(found, times)):
            self.assertEqual((cloud.fields["revolution"], cloud.fields["number_of_revolutions"]), (number, 4))
            self.assertTrue(np.all(np.diff(cloud["azimuth"].reshape(-1, 32)[:, 0]) > 0))
            self.assertAlmostEqual(cloud["timestamp"][0] * 1e-6, start, delta=1e-9)
            self.assertTrue(np.all(np.diff(cloud["timestamp"].reshape(-1, 32)[:, 0]) > 0))
        with self.assertWarnsRegex(RuntimeWarning, "has 4 revolutions, of which the first was read"):
            self.assertEqual(avianlidar.load_cloud(FILE).number_of_points, 37.5 * 384)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for time, revolution in ((times[1] + 0.05, 1), (0, 0)):
                self.assertEqual(avianlidar.load_cloud(FILE, time=time).fields["revolution"], revolution)
        with self.assertRaisesRegex(ValueError, "time is nan, expected seconds"):
            avianlidar.load_cloud(FILE, time=float("nan"))
        with self.assertRaisesRegex(TypeError, r"a \.csv file has no revolutions"):
            avianlidar.load_cloud("cloud.csv", time=1)

    def test_missing_packets(self):
        """The azimuth goes on as it did before."""
        write(pcap([ethernet(payload(0)), ethernet(payload(9000))]))
        azimuth = array(read(FILE), "azimuth").reshape(24, 32)
        self.assertTrue(np.allclose(azimuth[11] - azimuth[10], 40) and np.allclose(azimuth[23] - azimuth[22], 40))

    def test_every_kind_of_file(self):
        data = payload(500)
        whole = pcap([ethernet(data)])
        write(whole)
        wanted = points(read(FILE)).tolist()
        tag = struct.pack(">HH", 0x8100, 7)
        kinds = {"turned": pcap([ethernet(data)], order=">"), "nanoseconds": pcap([ethernet(data)], magic=0xA1B23C4D),
                 "both": pcap([ethernet(data)], order=">", magic=0xA1B23C4D),
                 "tags": pcap([ethernet(data, tags=tag + tag)]),
                 "options": pcap([ethernet(data, options=bytes(8))]), "bare": pcap([datagram(data)], link=101),
                 "cooked": pcap([bytes(14) + b"\x08\x00" + datagram(data)], link=113),
                 "cooked2": pcap([b"\x08\x00" + bytes(18) + datagram(data)], link=276), "ng": pcapng([ethernet(data)]),
                 "ng old": pcapng([ethernet(data)], old=True), "loopback": pcap([b"\2\0\0\0" + datagram(data)], link=0),
                 "another port": pcap([ethernet(data, port=2370)]),
                 "ng turned": pcapng([ethernet(data)], order=">"), "ng simple": pcapng([ethernet(data)], simple=True),
                 "others": pcap([b"", ethernet(bytes(1206), port=8308), ethernet(data[:-1]), ethernet(data, protocol=6),
                                 ethernet(data, fragment=1), bytes(60), ethernet(data), ethernet(b"")])}
        for name, content in kinds.items():
            with self.subTest(name):
                write(content)
                self.assertEqual(points(read(FILE)).tolist(), wanted)
                self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 1)

    @unittest.skipUnless(REAL.is_dir(), "the data folder is not there")
    def test_a_real_revolution(self):
        raw = (REAL / "vlp16_packets.bin").read_bytes()
        write(pcap([ethernet(raw[at:at + 1206]) for at in range(0, len(raw), 1206)]))
        found, times = turns()
        measured = avianlidar.load_cloud(REAL / "vlp16.pcd")  # decoded by another program
        self.assertEqual((len(found), len(times)), (2, 2))
        self.assertTrue(1461.0 < times[0] < times[1] < times[0] + 0.1)
        self.assertEqual(sum(cloud.number_of_points for cloud in found), measured.number_of_points)
        self.assertLess(np.abs(np.concatenate([cloud.points for cloud in found]) - measured.points).max(), 1e-5)
        for name in ("laser_id", "intensity"):
            self.assertTrue(np.array_equal(np.concatenate([cloud[name] for cloud in found]), measured[name]))
        turned = np.concatenate([cloud["azimuth"] for cloud in found]) / 100
        self.assertLess(np.abs(turned - measured["file_azimuth"]).max(), 2e-5)

    def test_two_sensors(self):
        """One is chosen by its address, or by the port where addresses are the same; without a choice an error lists
        them."""
        near, far = (payload(500, value=lambda block, shot, d=d: (d, 100)) for d in (1000, 3000))
        later = payload(500, time=1327, value=lambda block, shot: (1000, 100))
        for address, port, exact in ((202, 2368, "192.168.1.202"), (201, 2369, "192.168.1.201:2369")):
            write(pcap([ethernet(near), ethernet(far, last=address, port=port), ethernet(later)]))
            self.assertIn("(--sensor-address) of one of these: 192.168.1.201:2368 (2 packets), "
                          f"192.168.1.{address}:{port} (1 packets)", read_error(FILE))
            self.assertEqual(set(array(read(FILE, SensorAddress=exact), "distance_m")), {6.0})
            cloud = avianlidar.load_cloud(FILE, sensor_address="192.168.1.201:2368")
            self.assertEqual((cloud.number_of_points, set(cloud["distance_m"])), (768, {2.0}))
        with self.assertRaisesRegex(avianlidar.Error, "has no packets of the sensor 192.168.1.7, expected"):
            avianlidar.load_cloud(FILE, sensor_address="192.168.1.7")
        self.assertIn("(--sensor-address)", error_of("convert", FILE, "out.pcd"))
        code, _, said = run("convert", FILE, "out.pcd", "--sensor-address", "192.168.1.201:2369", "--time", 0)
        self.assertEqual(code, 0, said)
        self.assertEqual(avianlidar.load_cloud("out.pcd").number_of_points, 384)

    def test_two_sensors_of_one_address_are_an_error(self):
        frames = [ethernet(payload((480 * number + turned) % 36000, 1327 * number + turned // 100))
                  for number in range(20) for turned in (0, 9000)]
        write(pcap(frames))
        self.assertIn("more than one sensor with the same address: the azimuth goes back 19 times in 40 packets",
                      read_error(FILE))
        # a motor that stands still
        write(pcap([ethernet(payload(100 + number % 2, 1327 * number, step=0)) for number in range(20)]))
        self.assertEqual(read(FILE).GetNumberOfPoints(), 20 * 384)

    def places(self, content, **said):
        write(content)
        return points(read(FILE, **said)).tolist()

    def test_damaged_packets_are_left_out(self):
        """With one warning, whatever their number; a cut end, and what was recorded twice, too."""
        good = [ethernet(payload(480 * number, 1327 * number)) for number in range(20)]
        twice = self.places(pcap([frame for frame in good for _ in range(2)]),
                            said=["20 packets were recorded twice, and are taken once"])
        self.assertEqual(twice, self.places(pcap(good)))
        without = good[:4] + good[5:]
        wanted = self.places(pcap(without))
        bad = payload(1920, 5308)
        for frame in (bad[:300] + b"\0\0" + bad[302:], bad[:302] + struct.pack("<H", 36000) + bad[304:],
                      payload(1920, mode=0x40), payload(1920, product=0x21), payload(1920, 0xFFFFFFFF)):
            said = ["1 of 20 packets of the lidar are left out: packet 4 of the lidar "]
            self.assertEqual(self.places(pcap(good[:4] + [ethernet(frame)] + good[5:]), said=said), wanted)
        for frame in (good[4][:700], ethernet(bad, fragment=0x2000)):  # recorded with a limit; a fragment
            for form in (pcap, pcapng):
                self.assertEqual(self.places(form(good[:4] + [frame] + good[5:]),
                                             said=["1 of 20 packets of the lidar are left out"]), wanted)
        cut = pcap(without + [ethernet(payload(480 * 20, 1327 * 20))])[:-400]
        self.assertEqual(self.places(cut, said=["is cut short: a packet that begins at byte ",
                                                ", and the last 864 bytes are left out"]), wanted)
        self.assertEqual(self.places(pcapng(without)[:-7], said=["is cut short"]), self.places(pcap(without[:-1])))

    def test_packets_that_come_late(self):
        """They are sorted by the sensor's clock, at the full hour, too: points and revolutions are the same."""
        for start in (0, 3_599_990_000):
            good = [ethernet(payload(35000 + 480 * number, int(start + 1327.104 * number) % 3_600_000_000))
                    for number in range(30)]
            late = [good[0], *(good[at + turn] for at in range(1, 29, 2) for turn in (1, 0)), good[29]]
            found = []
            for frames in (good, late):
                write(pcap(frames))
                found.append([(cloud.number_of_points, cloud["timestamp"].tolist()) for cloud in turns()[0]])
            self.assertEqual(*found)

    def test_errors(self):
        good = payload(0)
        broken = good[:100] + b"\0" + good[101:]
        ng = pcapng([ethernet(good)])
        for content, words in (
                (pcap([]), "has no packet of a VLP-16: UDP with 1206 bytes"),
                (pcap([ethernet(good)])[:-1], "is cut short: a packet that begins at byte 24 goes beyond its end"),
                (pcap([ethernet(good)[:900]]), "packet 0 of the lidar has 858 of its 1206 bytes"),
                (pcap([ethernet(broken), ethernet(broken)]),
                 "packet 0 of the lidar has no azimuth below 360 deg in block 1"),
                (pcap([ethernet(payload(0, product=0x21))]), "is of the product 33, expected 34, a VLP-16"),
                (pcap([ethernet(payload(0, mode=0x40))]),
                 "has the return mode 64, expected 55 (strongest), 56 (last) or 57 (dual)"), (ng[:-4], "is cut short"),
                (ng[:32] + struct.pack("<I", 6) + ng[36:],
                 "the block at byte 28 has the length 6, expected at least 16"), (b"", "is not a pcap or pcapng file")):
            with self.subTest(words):
                write(content)
                self.assertIn(words, read_error(FILE))
        self.assertEqual(al.vtkAvianLidarPointCloudReader.CanReadFile(FILE), 0)
