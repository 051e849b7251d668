# SPDX-License-Identifier: BSD-3-Clause
"""Waveform packets of LAS 1.4 against a reader and a writer of this test, straight from the specification (R15)."""

import os
import pathlib
import struct
import unittest

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import avianlidar
from avianlidar import _cloud, vtkAvianLidar as al
from cloudtools import add_field, assert_refused, cloud, field, names, points, unit, write
from echotools import InFolder, Messages, array, copy_of, given

C = 299792458.0
FILE = "TestLasWaveforms.las"
WDP = "TestLasWaveforms.wdp"
ORIGIN = (31.1979, 121.3363, 3.0)
PACKET = {4: 28, 5: 34, 9: 30, 10: 38}  # offset of the waveform packet in a point, bytes


def scan(bits=12, rate=1e9, **settings):
    """Echoes and waveforms of a scan of the example scene, as copies to change."""
    sensor = avianlidar.Sensor("Search905", position=(0, 0, 3), azimuth_step=4, digitiser_rate=rate,
                               digitiser_bits=bits)
    scan = avianlidar.Scan(avianlidar.example_scene(), sensor, record_waveforms=True, **settings)
    scan.update()
    echoes, waves = (copy_of(scan.algorithm.GetOutput(port)) for port in (0, 3))
    for data in (echoes, waves):
        add_field(data, "geodetic_origin", ORIGIN, "deg deg m")
    return echoes, waves


def save(data, waves=None, name=FILE, **properties):
    """Writes and returns the warnings."""
    writer = al.vtkAvianLidarLASWriter()
    if waves is not None:
        writer.SetWaveformsData(waves)
    return write(writer, data, name, **properties)


def bounds(waves):
    return vtk_to_numpy(waves.GetLines().GetOffsetsArray())


def waves_of(name=FILE, said=(), **properties):
    """Points and waveforms of a file; a warning has the words."""
    reader = given(al.vtkAvianLidarPointCloudReader(), FileName=name, **properties)
    heard = Messages(reader)
    reader.Update()
    assert not heard.errors and len(heard.warnings) == bool(said), heard.all()
    assert all(words in heard.warnings[0] for words in said), heard.warnings
    return reader.GetOutput(0), reader.GetOutput(1)


class LasFile:
    """Reads a file as the specification says."""

    def __init__(self, name=FILE):
        whole = pathlib.Path(name).read_bytes()
        self.encoding, = struct.unpack_from("<H", whole, 6)
        begin, vlrs, self.form, length, legacy = struct.unpack_from("<IIBHI", whole, 96)
        self.legacy = legacy, struct.unpack_from("<5I", whole, 111)
        self.waves_at, evlrs_at, evlrs, self.count = struct.unpack_from("<QQIQ", whole, 227)
        self.returns = struct.unpack_from("<15Q", whole, 255)
        scale, offset = np.reshape(struct.unpack_from("<6d", whole, 131), (2, 3))
        at, self.descriptors, self.words = struct.unpack_from("<H", whole, 94)[0], {}, set()
        for _ in range(vlrs):
            user, record, size, words = struct.unpack_from("<2x16sHH32s", whole, at)
            if user.rstrip(b"\0") == b"LASF_Spec" and 100 <= record < 355:
                assert size == 26
                self.descriptors[record - 99] = struct.unpack_from("<BBIIdd", whole, at + 54)
                self.words.add(words.rstrip(b"\0"))
            at += 54 + size
        assert at == begin
        self.rows = [whole[begin + i * length:begin + (i + 1) * length] for i in range(self.count)]
        self.points = np.array([struct.unpack_from("<3i", row) for row in self.rows]) * scale + offset
        self.packets = [struct.unpack_from("<BQIffff", row, PACKET[self.form]) for row in self.rows]
        end = begin + self.count * length
        if self.encoding & 2:
            assert (self.waves_at, evlrs_at, evlrs) == (end, end, 1)
            self.waves = whole[end:]
        else:
            assert (self.waves_at, evlrs_at, evlrs, len(whole)) == (0, 0, 0, end)
            self.waves = pathlib.Path(name).with_suffix(".wdp").read_bytes()
        user, record, size = struct.unpack_from("<2x16sHQ", self.waves)
        assert (user.rstrip(b"\0"), record, size) == (b"LASF_Spec", 65535, len(self.waves) - 60)

    def unpack(self, kind, offset):
        """A field of all points."""
        return np.array([struct.unpack_from("<" + kind, row, offset)[0] for row in self.rows])

    def samples(self, point):
        """Raw samples of a point, and their values, J."""
        index, at, size, *_ = self.packets[point]
        bits, compression, count, _, gain, offset = self.descriptors[index]
        assert (compression, size) == (0, count * bits // 8) and 60 <= at <= len(self.waves) - size
        raw = np.frombuffer(self.waves, {8: "<u1", 16: "<u2", 32: "<u4"}[bits], count, at)
        return raw, offset + gain * raw.astype(float)


def stretches_of(echoes, waves):
    """For each echo, the line of the same beam and time that contains its range; -1 without one."""
    ends, ranges = bounds(waves), array(waves, "distance_m")
    cells = [vtk_to_numpy(waves.GetCellData().GetArray(name)) for name in ("beam_id", "timestamp")]
    half = 0.5 * (ranges[1] - ranges[0])
    found = []
    for beam, time, range_ in zip(*(array(echoes, name) for name in ("beam_id", "timestamp", "distance_m"))):
        found.append(next((line for line in np.flatnonzero((cells[0] == beam) & (cells[1] == time))
                           if ranges[ends[line]] - half <= range_ <= ranges[ends[line + 1] - 1] + half), -1))
    return np.array(found)


class TestLasWaveforms(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.echoes, cls.waves = scan()

    def check_packets(self, file, echoes, waves, step, spacing):
        """Samples and times of the packets are those of the lines, and packets of one line are one."""
        lines, ends = stretches_of(echoes, waves), bounds(waves)
        self.assertGreater((lines >= 0).sum(), 50)
        samples, times = array(waves, "sample"), array(waves, "sample_time")
        echo_times = 2.0 / C * array(echoes, "distance_m")
        places = {}
        for point, line in enumerate(lines):
            index, at, size, location, *slope = file.packets[point]
            if line < 0:
                self.assertEqual(file.packets[point], (0, 0, 0, 0, 0, 0, 0))
                continue
            mine = slice(ends[line], ends[line + 1])
            raw, values = file.samples(point)
            np.testing.assert_allclose(values[:mine.stop - mine.start], samples[mine], rtol=0, atol=0.5001 * step)
            np.testing.assert_allclose(values[mine.stop - mine.start:], 0.0, rtol=0, atol=0.5001 * step)
            self.assertAlmostEqual(location, 1e12 * (echo_times[point] - times[mine.start]), delta=0.1)
            speed = 0.5e-12 * C if mine.stop - mine.start > 1 else 0.0  # m/ps; one sample has no direction
            self.assertAlmostEqual(np.linalg.norm(slope), speed, delta=1e-3 * speed)
            places.setdefault(line, set()).add((at, index))
        self.assertTrue(all(len(one) == 1 for one in places.values()))
        self.assertEqual(len({one for all_of in places.values() for one in all_of}), len(places))
        for bits, _, _, ps, gain, offset in file.descriptors.values():
            self.assertEqual((ps, gain), (spacing, step))
        self.assertEqual(file.words, {b"Waveform samples [J]"})
        return len(places)

    def test_formats(self):
        """Each format inside and outside of the file; the other fields are those of the formats 6 and 7."""
        coloured = copy_of(self.echoes)
        colours = vtk.vtkUnsignedCharArray()
        colours.SetName("rgb")
        colours.SetNumberOfComponents(3)
        for i in range(coloured.GetNumberOfPoints()):
            colours.InsertNextTuple3(i % 256, 7, 255)
        coloured.GetPointData().AddArray(colours)
        upper = field(self.waves, "upper_energy_limit")[0] / 5  # five samples in a range unit of 5 ns
        step = upper / (4095 - 256)
        for form, data in ((9, self.echoes), (4, self.echoes), (10, coloured), (5, coloured)):
            for beside in (False, True):
                with self.subTest(form, beside=beside):
                    save(data)
                    plain = pathlib.Path(FILE).read_bytes()
                    self.assertEqual(save(data, self.waves, LegacyFormat=form < 6, ExternalWaveforms=beside), [])
                    self.assertEqual(os.path.exists(WDP), beside)
                    file = LasFile()
                    self.assertEqual((file.form, file.encoding), (form, 16 | (4 if beside else 2)))
                    used = self.check_packets(file, data, self.waves, step, 1000)
                    self.assertEqual({kind[0] for kind in file.descriptors.values()}, {16})
                    self.assertAlmostEqual(file.descriptors[1][5], -256 * step, delta=1e-9 * upper)
                    returns = np.minimum(array(data, "return_number"), 7 if form < 6 else 15)
                    counts = np.bincount(returns, minlength=16)[1:]
                    self.assertEqual(file.returns, tuple(counts))
                    self.assertEqual(file.legacy,
                                     (file.count, tuple(counts[:5])) if form < 6 else (0, (0,) * 5))
                    count, _, length = file.count, *struct.unpack_from("<BH", plain, 104)
                    old = [plain[at:at + length] for at in range(len(plain) - count * length, len(plain), length)]
                    for row, before in zip(file.rows, old):
                        core = PACKET[form]
                        self.assertEqual(row[core + 29:], before[36 if form in (5, 10) else 30:])  # extra bytes
                        if form > 6:
                            self.assertEqual(row[:30], before[:30])
                            self.assertEqual(row[30:core], before[30:36] + b"\0\0" if form == 10 else b"")
                        else:
                            self.assertEqual((row[:14], row[18:28]), (before[:14], before[20:30]))
                            self.assertEqual(row[14], min(before[14] & 15, 7) | min(before[14] >> 4, 7) << 3)
                            self.assertEqual(row[15], before[16] | (before[15] & 7) << 5)
                            angle, = struct.unpack_from("<h", before, 18)
                            self.assertEqual(row[16], np.clip(round(angle * 0.006), -90, 90))
                            self.assertEqual(row[28:core], before[30:36] if form == 5 else b"")
                    self.assertGreater(used, 50)
                if beside:
                    os.remove(WDP)

    def test_legacy_fields_are_limited(self):
        data, waves = copy_of(self.echoes), self.waves
        for name, value in (("return_number", 9), ("number_of_returns", 12)):
            vtk_to_numpy(data.GetPointData().GetArray(name))[:] = value
        save(data, waves, LegacyFormat=True)
        file = LasFile()
        self.assertEqual(set(file.unpack("B", 14)), {7 | 7 << 3})
        self.assertEqual(file.returns, (0,) * 6 + (file.count,) + (0,) * 8)

    def test_levels(self):
        """Codes of 8, 16 or 32 bits; samples that are not codes are stored in 32 bits without loss of half a step."""
        for bits, stored in ((0, 32), (6, 8), (8, 8), (16, 16), (20, 32)):
            with self.subTest(bits):
                echoes, waves = scan(bits=bits)
                save(echoes, waves)
                file = LasFile()
                highest = field(waves, "upper_energy_limit")[0] / 5  # five samples in a range unit of 5 ns
                step = highest / (2**bits * 15 / 16 - 1) if bits else file.descriptors[1][4]
                self.check_packets(file, echoes, waves, step, 1000)
                self.assertEqual({kind[0] for kind in file.descriptors.values()}, {stored})
                self.assertTrue(bits or step <= 2 * np.ptp(array(waves, "sample")) / 2**32)
        changed = copy_of(self.waves)
        vtk_to_numpy(changed.GetPointData().GetArray("sample"))[:] *= 1.01
        save(self.echoes, changed)
        file = LasFile()
        self.assertEqual(file.descriptors[1][0], 32)
        self.check_packets(file, self.echoes, changed, file.descriptors[1][4], 1000)

    def test_many_lengths_are_rounded_up(self):
        """301 lengths become multiples of 2; the padding is 0 J."""
        count = 301
        lengths = np.arange(1, count + 1)
        total, ends = lengths.sum(), np.concatenate([[0], np.cumsum(lengths)])
        times = (np.arange(total) - np.repeat(ends[:-1], lengths)) * 2e-9 + 1e-7
        data, waves = cloud(np.zeros((count, 3))), cloud(np.outer(0.5 * C * times, [0, 1, 0]))
        lines = vtk.vtkCellArray()
        for line in range(count):
            lines.InsertNextCell(int(lengths[line]), list(range(ends[line], ends[line + 1])))
        waves.SetLines(lines)
        draw = np.random.default_rng(1)
        add = _cloud.add_array
        add(waves.GetPointData(), "sample_time", times, "s")
        add(waves.GetPointData(), "distance_m", 0.5 * C * times, "m")
        add(waves.GetPointData(), "sample", draw.uniform(1.0, 2.0, total), "J")
        for one in (data.GetPointData(), waves.GetCellData()):
            add(one, "beam_id", np.arange(count), "")
            add(one, "timestamp", np.zeros(count), "us")
        add(data.GetPointData(), "distance_m", 0.5 * C * times[ends[:-1]], "m")
        self.assertEqual(save(data, waves, CoordinateSystem=2), [])
        file = LasFile()
        self.assertEqual([kind[2] for kind in file.descriptors.values()], list(range(2, 303, 2)))
        self.check_packets(file, data, waves, array(waves, "sample").max() / (2**32 - 1), 2000)

    def test_without_waveforms_the_bytes_are_the_same(self):
        save(self.echoes)
        plain = pathlib.Path(FILE).read_bytes()
        self.assertEqual(plain[104], 6)
        for waves in (vtk.vtkPolyData(), None):
            save(self.echoes, waves, LegacyFormat=True, ExternalWaveforms=True)
            self.assertEqual(pathlib.Path(FILE).read_bytes(), plain)
            self.assertFalse(os.path.exists(WDP))

    def test_lines_in_each_system(self):
        """The places of samples are on the beam: exactly in the scene's system, in UTM to the second order."""
        lines, ends, places = stretches_of(self.echoes, self.waves), bounds(self.waves), points(self.waves)
        times = array(self.waves, "sample_time")
        for system, accuracy in ((2, 2e-5), (0, 1e-3), (1, 2e-5)):
            with self.subTest(system):
                save(self.echoes, self.waves, CoordinateSystem=system)
                transform = given(al.vtkAvianLidarGeodeticTransform(), InputData=self.waves, MovePoints=True)
                getattr(transform, "SetTargetFrameTo" + ("UTM", "ECEF", "ENU")[system])()
                transform.Update()
                wanted = points(transform.GetOutput()) if system < 2 else places
                file = LasFile()
                for point, line in enumerate(lines[:200]):
                    if line >= 0:
                        mine = slice(ends[line], ends[line + 1])
                        _, _, _, location, *slope = file.packets[point]
                        t = 1e12 * (times[mine] - times[mine.start])
                        found = file.points[point] + np.outer(t - location, slope)
                        far = np.abs(t - location).max() * 0.5e-12 * C
                        np.testing.assert_allclose(found, wanted[mine], rtol=0, atol=accuracy * max(1.0, far / 50)**2)

    def test_round_trip(self):
        lines, ends = stretches_of(self.echoes, self.waves), bounds(self.waves)
        used = list(dict.fromkeys(lines[lines >= 0]))  # in the order of the echoes
        for legacy in (False, True):
            for beside in (False, True):
                for system in (0, 1, 2):
                    with self.subTest(legacy=legacy, beside=beside, system=system):
                        save(self.echoes, self.waves, LegacyFormat=legacy, ExternalWaveforms=beside,
                             CoordinateSystem=system)
                        got, waves = waves_of()
                        self.assertEqual(got.GetNumberOfPoints(), self.echoes.GetNumberOfPoints())
                        rows = np.concatenate([np.arange(ends[line], ends[line + 1]) for line in used])
                        np.testing.assert_array_equal(np.diff(bounds(waves)), np.diff(ends)[used])
                        for name, accuracy in (("sample_time", 1e-14), ("distance_m", 2e-6), ("sample", 1e-24)):
                            np.testing.assert_allclose(array(waves, name), array(self.waves, name)[rows], rtol=0,
                                                       atol=accuracy, err_msg=name)
                        np.testing.assert_allclose(points(waves), points(self.waves)[rows], rtol=0, atol=2e-3)
                        for name in ("beam_id", "timestamp"):
                            cells = [data.GetCellData().GetArray(name) for data in (waves, self.waves)]
                            np.testing.assert_allclose(vtk_to_numpy(cells[0]), vtk_to_numpy(cells[1])[used], rtol=1e-15)
                        units = [unit(waves, name) for name in ("sample_time", "distance_m", "sample")]
                        self.assertEqual(units, ["s", "m", "J"])
                        self.assertEqual(field(waves, "digitiser_bits"), [12])
                        if beside:
                            os.remove(WDP)
        save(got, waves, CoordinateSystem=2, LegacyFormat=True)  # what was read can be written
        again = waves_of()[1]
        np.testing.assert_allclose(array(again, "sample"), array(waves, "sample"), rtol=0, atol=1e-24)

    def test_points_without_a_waveform(self):
        data = copy_of(self.echoes)
        beams = vtk_to_numpy(data.GetPointData().GetArray("beam_id"))
        times = vtk_to_numpy(data.GetPointData().GetArray("timestamp"))
        ranges = vtk_to_numpy(data.GetPointData().GetArray("distance_m"))
        beams[0], times[1], ranges[2] = 10**6, -1.0, 1e5
        (warning,) = save(data, self.waves)
        self.assertIn(f"3 of {data.GetNumberOfPoints()} points without a waveform", warning)
        file = LasFile()
        self.assertEqual([packet[0] > 0 for packet in file.packets[:5]], [False] * 3 + [True] * 2)
        waves_of()

    def test_wrong_waveforms(self):
        writer = al.vtkAvianLidarLASWriter()
        for kind, name in (("Point", "sample"), ("Point", "sample_time"), ("Cell", "beam_id"), ("Cell", "timestamp")):
            waves = copy_of(self.waves)
            getattr(waves, f"Get{kind}Data")().RemoveArray(name)
            writer.SetWaveformsData(waves)
            assert_refused(self, writer, self.echoes, FILE, f"input port 1 (waveforms): the array '{name}' is missing")
        waves = copy_of(self.waves)
        vtk_to_numpy(waves.GetPointData().GetArray("sample"))[:] = np.nan
        writer.SetWaveformsData(waves)
        assert_refused(self, writer, self.echoes, FILE, "a sample of the waveforms is not finite")
        writer.SetWaveformsData(self.waves)
        for name in ("beam_id", "timestamp", "distance_m"):
            data = copy_of(self.echoes)
            data.GetPointData().RemoveArray(name)
            assert_refused(self, writer, data, FILE, f"no numeric point array '{name}'")
        assert_refused(self, writer, self.echoes, FILE.replace(".las", ".laz"), "LAZ cannot hold waveforms")
        given(writer, ExternalWaveforms=True)
        assert_refused(self, writer, self.echoes, WDP, "expected another ending")

    def test_aborted_runs_leave_no_file(self):
        for beside in (False, True):
            for share in (0.2, 0.4, 0.6, 0.8):
                writer = given(al.vtkAvianLidarLASWriter(), InputData=self.echoes, FileName=FILE,
                               ExternalWaveforms=beside)
                writer.SetWaveformsData(self.waves)
                writer.AddObserver("ProgressEvent", lambda who, _: who.SetAbortExecute(who.GetProgress() >= share))
                writer.Write()
                self.assertEqual(os.listdir("."), [], share)

    def test_time_steps(self):
        """The waveforms of several files follow the requested time, whichever port asks."""
        counts = []
        for step in range(2):
            mask = given(vtk.vtkMaskPoints(), InputData=self.echoes, OnRatio=1 + step)
            mask.Update()
            save(mask.GetOutput(), self.waves, name=f"{step}.las")
            counts.append((mask.GetOutput().GetNumberOfPoints(), waves_of(f"{step}.las")[1].GetNumberOfLines()))
        self.assertGreater(counts[0][1], counts[1][1])
        reader = al.vtkAvianLidarPointCloudReader()
        for name in ("0.las", "1.las"):
            reader.AddFileName(name)
        reader.SetScanRate(1.0)
        reader.UpdateInformation()
        for port, time in ((0, 0.0), (1, 1.0), (0, 0.0), (1, 0.0), (1, 1.0), (0, 1.0)):
            info = reader.GetOutputInformation(port)
            info.Set(vtk.vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP(), time)
            reader.Update(port)
            self.assertEqual((reader.GetOutput(0).GetNumberOfPoints(), reader.GetOutput(1).GetNumberOfLines()),
                             counts[int(time)], (port, time))


def foreign(rows, descriptors, waves, form=4, encoding=4, minor=3, start=0, beside=True,
            words=b"of a digitizer [counts]"):
    """A file of another program: points (x, y, z, packet, flags), descriptors by index."""
    size = {3: 235, 4: 375}[minor]
    vlrs = b"".join(struct.pack("<2x16sHH32s", b"LASF_Spec", 99 + index, 26, words) + struct.pack("<BBIIdd", *one)
                    for index, one in descriptors.items())
    header = bytearray(size)
    struct.pack_into("<4sHH", header, 0, b"LASF", 0, encoding)
    struct.pack_into("<BB", header, 24, 1, minor)
    length = PACKET[form] + 29
    struct.pack_into("<HIIBHI", header, 94, size, size + len(vlrs), len(descriptors), form, length, len(rows))
    struct.pack_into("<6d", header, 131, 0.01, 0.01, 0.01, 1000, 2000, 0)
    end = size + len(vlrs) + len(rows) * length
    struct.pack_into("<Q", header, 227, 0 if beside else end if start == 0 else start)
    body = b""
    for x, y, z, packet, flags in rows:
        core = struct.pack("<3iHBBbBHd", x, y, z, 257, 1 | 1 << 3, 2 | flags << 5, 0, 0, 0, 0.5) if form < 6 else \
            struct.pack("<3iHBBBBhHd", x, y, z, 257, 1 | 1 << 4, flags, 2, 0, 0, 0, 0.5)
        body += core.ljust(PACKET[form], b"\0") + struct.pack("<BQIffff", *packet)
    tail = struct.pack("<H16sHQ32s", 0, b"LASF_Spec", 65535, len(waves), b"") + waves
    pathlib.Path(FILE).write_bytes(bytes(header) + vlrs + body + (b"" if beside else tail))
    if beside:
        pathlib.Path(WDP).write_bytes(tail)


class TestForeignWaveforms(InFolder):
    LINE = (1000.0, 0.0, 1.5e-4, 0.0)  # L in ps, and d in m/ps
    SHORT = {1: (8, 0, 4, 500, 2.0, -10.0), 3: (16, 0, 3, 1000, 0.5, 1.0)}
    WAVES = bytes([1, 2, 3, 255]) + struct.pack("<3H", 1, 2, 65535)

    def rows(self):
        return [(0, 0, 0, (1, 60, 4, *self.LINE), 0), (100, 0, 0, (0, 0, 0, 0, 0, 0, 0), 0),
                (200, 0, 0, (3, 64, 6, *self.LINE), 0), (300, 0, 0, (1, 60, 4, *self.LINE), 0),
                (400, 0, 0, (3, 64, 6, *self.LINE), 4)]

    def check(self, data, waves):
        self.assertEqual((data.GetNumberOfPoints(), waves.GetNumberOfLines()), (4, 2))
        self.assertEqual(bounds(waves).tolist(), [0, 4, 7])
        np.testing.assert_allclose(array(waves, "sample"), [-8, -6, -4, 500, 1.5, 2, 32768.5])
        np.testing.assert_allclose(array(waves, "sample_time"), np.array([0, 500, 1000, 1500, 0, 1000, 2000]) * 1e-12)
        np.testing.assert_allclose(points(waves)[:, 0], [1000] * 4 + [1002] * 3)
        np.testing.assert_allclose(points(waves)[:, 1], 2000 + np.array([-1000, -500, 0, 500, -1000, 0, 1000]) * 1.5e-4)
        self.assertEqual(names(waves), ["sample_time", "sample"])
        self.assertEqual(vtk_to_numpy(waves.GetCellData().GetArray("timestamp")).tolist(), [5e5] * 2)
        self.assertIsNone(waves.GetCellData().GetArray("beam_id"))

    def test_files_of_other_programs(self):
        for form, minor in ((4, 3), (5, 3), (4, 4), (9, 4), (10, 4)):
            for beside in (True, False):
                for encoding in (4 if beside else 2, 0):
                    with self.subTest(form, minor=minor, beside=beside, encoding=encoding):
                        foreign(self.rows(), self.SHORT, self.WAVES, form, encoding, minor, beside=beside)
                        data, waves = waves_of(said=["1 point that is flagged as withheld"])
                        self.check(data, waves)
                        self.assertEqual(unit(waves, "sample"), "counts")
                        if beside:
                            os.remove(WDP)
        foreign(self.rows(), self.SHORT, self.WAVES, words=b"")
        os.rename(WDP, WDP.replace(".wdp", ".WDP"))
        self.assertEqual(unit(waves_of(said=["flagged"])[1], "sample"), "V")

    def test_24_and_32_bits(self):
        for bits, raw in ((24, [1, 2**24 - 1]), (32, [2**32 - 1, 3])):
            waves = b"".join(value.to_bytes(bits // 8, "little") for value in raw)
            foreign([(0, 0, 0, (255, 60, len(waves), *self.LINE), 0)], {255: (bits, 0, 2, 1000, 1.0, 0.0)}, waves)
            np.testing.assert_array_equal(array(waves_of()[1], "sample"), raw)

    def test_malformed_files(self):
        good = (1, 60, 4, *self.LINE)
        for words, packet, kind in (
                ("the waveforms of 1 points are left out: there is no waveform packet descriptor 2",
                 (2, 60, 4, *self.LINE), None),
                ("expected samples of 8, 16, 24 or 32 bits but found 12", good, (12, 0, 2, 500, 1.0, 0.0)),
                ("found type 1", good, (8, 1, 4, 500, 1.0, 0.0)),
                ("shorter than their samples", (1, 60, 3, *self.LINE), None),
                ("beyond the end of the file", (1, 61, 4, *self.LINE), None),
                ("beyond the end of the file", (1, 2**64 - 2, 4, *self.LINE), None),
                ("beyond the end of the file", (1, 60, 2**32 - 1, *self.LINE), (8, 0, 2**32 - 1, 1, 1.0, 0.0)),
                ("lines are not finite", (1, 60, 4, 0, float("nan"), 0, 0), None)):
            for beside in (True, False):
                with self.subTest(words, beside=beside):
                    foreign([(0, 0, 0, packet, 0)] + [(0, 0, 0, (0,) * 7, 0)] * 3,
                            {1: kind or (8, 0, 4, 500, 1.0, 0.0)}, bytes(4), beside=beside, encoding=4 if beside else 2)
                    data, waves = waves_of(said=[words])
                    self.assertEqual((data.GetNumberOfPoints(), waves.GetNumberOfPoints()), (4, 0))
        foreign(self.rows()[:4], self.SHORT, self.WAVES)
        os.remove(WDP)
        data, waves = waves_of(said=["the waveforms of 3 points are left out: the file with the ending .wdp is"])
        self.assertEqual((data.GetNumberOfPoints(), waves.GetNumberOfLines()), (4, 0))
        os.mkdir(WDP)
        waves_of(said=["is missing or cannot be opened"])
        foreign(self.rows()[:4], self.SHORT, self.WAVES, beside=False, encoding=2, start=2**64 - 1)
        waves_of(said=["the waveforms of 3 points are left out: their packets lie beyond the end"])

    def test_packets_that_need_too_much_memory(self):
        """Packets that overlap: 30,000 times a million samples in a file of 3 MB."""
        count = 10**6
        rows = [(0, 0, 0, (1, 60 + i, count, *self.LINE), 0) for i in range(30000)]
        foreign(rows, {1: (8, 0, count, 500, 1.0, 0.0)}, bytes(count + len(rows)))
        data, waves = waves_of(said=["its waveforms are left out: 30,000,000,000 samples of waveforms need about"])
        self.assertEqual((data.GetNumberOfPoints(), waves.GetNumberOfPoints()), (len(rows), 0))

    def test_a_file_that_ends_within_its_waveforms(self):
        echoes, waves = scan()
        save(echoes, waves)
        whole = pathlib.Path(FILE).read_bytes()
        pathlib.Path(FILE).write_bytes(whole[:-10])
        data, got = waves_of(said=["packets lie beyond the end of the file"])
        self.assertEqual(data.GetNumberOfPoints(), echoes.GetNumberOfPoints())
        self.assertGreater(got.GetNumberOfLines(), 50)

    def test_other_formats_have_no_waveforms(self):
        write(al.vtkAvianLidarPCDWriter(), cloud([[1, 2, 3]]), "a.pcd")
        self.assertEqual(waves_of("a.pcd")[1].GetNumberOfPoints(), 0)


if __name__ == "__main__":
    unittest.main()
