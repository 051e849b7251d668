# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories of platforms from VTK, tables, GPX, KML and bags of ROS: places against a closed form, orientations
against vectors and SciPy, times, the choice of a track and of a frame, what is left out and what is wrong."""
import zipfile

import numpy as np
from scipy.spatial.transform import Rotation, Slerp
from vtkmodules.util.numpy_support import vtk_to_numpy

import TestRecording
import avianlidar as al
import scenetools
from avianlidar import _ros
from avianlidar._cloud import add_array, vertices
from avianlidar.apps.sequences._trajectory import read_trajectory, settings_of
from echotools import InFolder
from helpertools import warned

ORIGIN = (47.45, 8.55, 420.0)
DAY = 1620086400  # s from 1970 to 4 May 2021
SLOPE = al.Scene(([(x, y, 0.1 * x) for x in (-1000, 1000) for y in (-1000, 1000)], [(0, 2, 1), (1, 2, 3)]))
PLACES = [(47.4512, 8.5523, 445.0), (47.4513, 8.5525, 446.5), (47.4515, 8.5526, 448.0)]  # deg, m above the sea
WHEN = ["2021-05-04T10:00:03.000Z", "2021-05-04T10:00:04.5Z", "2021-05-04T12:00:07.25+02:00"]
POINTS = [f'<trkpt lat="{lat}" lon="{lon}"><ele>{height}</ele><time>{when}</time><extensions><ns3:TrackPointExtension>'
          "<ns3:hr>9</ns3:hr></ns3:TrackPointExtension></extensions></trkpt>"
          for (lat, lon, height), when in zip(PLACES, WHEN)]
GPX = f"""\ufeff<?xml version="1.0" encoding="UTF-8"?>
<gpx creator="Garmin Connect" version="1.1" xmlns:ns3="http://www.garmin.com/xmlschemas/TrackPointExtension/v1"
 xmlns="http://www.topografix.com/GPX/1/1"><metadata><time>2021-05-04T09:00:00.000Z</time></metadata>
<wpt lat="1" lon="2"><ele>3</ele><time>2021-05-04T10:00:00Z</time><name>home</name></wpt><trk><name>drive</name>
<trkseg>{POINTS[2]}</trkseg><trkseg>{POINTS[0]}{POINTS[1]}{{}}</trkseg></trk>{{}}</gpx>"""
WALK = '<trk><name>walk</name><trkseg><trkpt lat="47" lon="8"/></trkseg></trk>'
KML = f"""<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"><Placemark>
<name>flight</name><gx:Track>{{}}{"".join(f"<when>{WHEN[k]}</when>" for k in (0, 1, 1, 2))}
<gx:coord>8.5523 47.4512 445</gx:coord><gx:coord>8.5525 47.4513 446.5</gx:coord><gx:coord/>
<gx:coord>8.5526 47.4515 448</gx:coord>{{}}</gx:Track></Placemark></kml>"""


def closed_form(places):
    names = "latitude", "longitude", "height"
    return np.array([scenetools.frame(dict(zip(names, ORIGIN)), dict(zip(names, place)))[0] for place in places])


def parts_of(line):
    """Points, times and rotations."""
    time, turn = (vtk_to_numpy(line.GetPointData().GetArray(name)) for name in ("time", "pose_orientation"))
    points = vtk_to_numpy(line.GetPoints().GetData())
    assert line.GetNumberOfCells() == 1 and line.GetCell(0).GetNumberOfPoints() == len(points) and time.dtype == float
    assert (np.diff(time) > 0).all() and ((turn[1:] * turn[:-1]).sum(axis=1) >= 0).all()
    np.testing.assert_allclose(np.linalg.norm(turn, axis=1), 1, atol=1e-12)
    return points, time, Rotation.from_quat(turn[:, [1, 2, 3, 0]])


def headings(turns):
    east, north, up = turns.apply([0, 1, 0]).T
    np.testing.assert_allclose(up, 0, atol=1e-12)
    return np.degrees(np.arctan2(east, north))


class TestTrajectoryFiles(InFolder):
    def read(self, name, text, **settings):
        (self.folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        line, self.said = warned(lambda: read_trajectory(self.folder / name, **settings))
        return parts_of(line)

    def check(self, found, below=0.0):
        """The file's points; others may lie between them, where the heading changes."""
        rows = [int(np.abs(found[1] - time).argmin()) for time in (0, 1.5, 4.25)]
        np.testing.assert_allclose(found[1][rows], [0, 1.5, 4.25], atol=1e-6)
        np.testing.assert_allclose(found[0][rows], closed_form(np.array(PLACES) - [0, 0, below]), atol=1e-6)

    def test_gpx(self):
        self.check(self.read("a.gpx", GPX.format("", ""), origin=ORIGIN))
        plain = GPX.replace(' xmlns="http://www.topografix.com/GPX/1/1"', "").format("", "<trk/>")
        self.check(self.read("a.GPX", plain, origin=ORIGIN, height_reference="ellipsoid", geoid_undulation=47.0), 47.0)
        more = ('<trkpt lat="47.4516" lon="8.5526"><time>2021-05-04T10:00:09Z</time></trkpt><trkpt lat="47" lon="8"/>'
                '<trkpt lat="0" lon="0"><time>2021-05-04T10:00:02Z</time></trkpt>'
                '<trkpt lat="47" lon="8"><ele>5</ele><time>2021-05-04T10:00:04.5Z</time></trkpt>')
        found = self.read("a.gpx", GPX.format(more, ""), origin=ORIGIN, scene=SLOPE)
        self.check(found)
        east, north, _ = closed_form([(47.4516, 8.5526, ORIGIN[2])])[0]
        np.testing.assert_allclose(found[0][-1], (east, north, 0.1 * east), atol=1e-6)
        self.assertEqual([text.rpartition("a.gpx: ")[2] for text in self.said], [
            "left out: rows at 0, 0 degrees (1), rows without a time (1), points of the same time as before (1)"])

    def test_levels_of_heights(self):
        east, north, _ = closed_form([(*place[:2], ORIGIN[2]) for place in PLACES]).T
        table = "time,lat,lon\n" + "".join(f"{t},{lat},{lon}\n" for t, (lat, lon, _) in enumerate(PLACES))
        mode, heights = "<altitudeMode>relativeToGround</altitudeMode>", np.array(PLACES)[:, 2]
        for name, text, settings, above in (
                ("a.gpx", GPX.format("", ""), {"height_reference": "clamp"}, 0), ("a.kml", KML.format("", ""), {}, 0),
                ("a.csv", table, {"height_reference": "clamp"}, 0), ("a.kml", KML.format(mode, ""), {}, heights),
                ("a.gpx", GPX.format("", ""), {"height_reference": "ground"}, heights)):
            points, *_ = self.read(name, text, origin=ORIGIN, scene=SLOPE, **settings)
            points = points[[int(np.abs(points[:, 0] - one).argmin()) for one in east]]
            np.testing.assert_allclose(points, np.column_stack([east, north, 0.1 * east + above]), atol=1e-6)

    def test_kml(self):
        mode = "<altitudeMode>absolute</altitudeMode>"
        angles = "".join(f"<gx:angles>{text}</gx:angles>" for text in ("90 10 0", "90 0 20", "0 0 0", "-30 0 0"))
        text = KML.format(mode, angles)
        with zipfile.ZipFile(self.folder / "b.kmz", "w") as packed:
            packed.writestr("doc.kml", text)
        for found in (self.read("a.kml", text, origin=ORIGIN),
                      self.read("a.kmz", (self.folder / "b.kmz").read_bytes(), origin=ORIGIN)):
            self.check(found)
            tilt, roll = np.radians((10, 20))  # clockwise about x and y, as the heading is about z
            np.testing.assert_allclose(found[2].apply([0, 1, 0]), [
                (np.cos(tilt), 0, -np.sin(tilt)), (1, 0, 0), (-0.5, np.sqrt(0.75), 0)], atol=1e-12)
            np.testing.assert_allclose(found[2][1].apply([1, 0, 0]), (0, -np.cos(roll), np.sin(roll)), atol=1e-12)
        level = self.read("a.kml", KML.format(mode, "<gx:angles>0 0 0</gx:angles>" * 4), origin=ORIGIN)[2]
        east, north, _ = np.diff(closed_form(PLACES), axis=0)[0]
        self.assertAlmostEqual(headings(level)[0], np.degrees(np.arctan2(east, north)), places=6)

    def test_angles_and_quaternions_in_tables(self):
        head, rows = "time,x,y,z,", "".join(f"{t},{5 * t},0,5,{{}}\n" for t in range(3))
        heading, pitch, roll = np.radians((40, 25, -15))
        for names, values in (("yaw,pitch,roll", "40,25,-15"), ("roll,compass_heading(degrees),pitch", "-15,40,25"),
                              ("OSD.yaw [rad],pitch,roll", f"{heading},25,-15")):
            *_, turns = self.read("a.csv", f"{head}{names}\n{rows.format(*[values] * 3)}")
            np.testing.assert_allclose(turns[1].apply([0, 1, 0]), (
                np.sin(heading) * np.cos(pitch), np.cos(heading) * np.cos(pitch), np.sin(pitch)), atol=1e-12)
            self.assertAlmostEqual(turns[1].apply([1, 0, 0])[2], -np.sin(roll) * np.cos(pitch))
        *_, turns = self.read("a.csv", f"{head}heading\n{rows.format('', '50', '')}")
        np.testing.assert_allclose(headings(turns), [90, 50, 90])
        chance = Rotation.random(3, random_state=2)  # from x forward, y left, z up
        quats = [",".join(map(str, sign * quat)) for sign, quat in zip((1, -1, 1), chance.as_quat())]
        *_, turns = self.read("a.csv", f"{head}qx,qy,qz,qw\n{rows.format(*quats)}")
        for ours, theirs in (((0, 1, 0), (1, 0, 0)), ((1, 0, 0), (0, -1, 0)), ((0, 0, 1), (0, 0, 1))):
            np.testing.assert_allclose(turns.apply(ours), chance.apply(theirs), atol=1e-12)

    def test_heading_along_the_way(self):
        def along(ways, **settings):
            """Headings by time of a table of rows of time, x and y."""
            _, times, turns = self.read("a.csv", "time,x,y,z\n" + "".join("{},{},{},0\n".format(*row) for row in ways),
                                        **settings)
            found = np.unwrap(headings(turns), period=360)
            return lambda at: np.interp(at, times, found)

        # East, north after a stop in which the receiver scatters, and back.
        places = [(0, 0), (5, 0), (10, 0), (10.2, 0.3), (10.1, 0.1), (10.1, 5.1), (10.1, 9), (10.1, 5)]
        found = along((2 * t, *place) for t, place in enumerate(places))
        np.testing.assert_allclose([found(t) for t in (0, 4, 6, 8)], 90)
        np.testing.assert_allclose([found(10), found(14) % 360], [0, 180], atol=2)
        for radius, speed, step in ((20, 20, 0.01), (20, 0.4, 1.0), (200, 30, 0.5)):  # circles, also slow and dense ones
            times = np.arange(0, 3 * radius / speed, step)
            angle = times * speed / radius
            found = along(zip(times, radius * np.sin(angle), radius * np.cos(angle)))
            middle = times[len(times) // 4:-len(times) // 4]
            off = found(middle) - 90 - np.degrees(middle * speed / radius)
            self.assertLess(np.abs((off + 180) % 360 - 180).max(), 6)
        # Far points: the platform turns within 10 m of the bend.
        found = along([(0, 0, 0), (70, 0, 700), (140, 700, 700)])
        np.testing.assert_allclose([found(t) for t in (0, 40, 68.9, 70, 71.1, 140)], [0, 0, 0, 45, 90, 90], atol=1e-6)
        # A parked car, whose receiver scatters by 0.8 m (1 sigma is half of it).
        scatter = np.random.default_rng(3).normal(0, 0.4, (600, 2))
        way = [(t, 10 * t, 0) for t in range(20)] + [(20 + t, 200 + x, y) for t, (x, y) in enumerate(scatter)]
        found = along(way)
        np.testing.assert_allclose([found(t) for t in range(5, 619)], 90, atol=8)  # the last leg ends in the scatter
        self.assertEqual(along([(0, 5, 5), (1, 5.1, 5)])(0.5), 0)
        self.assertRegex(self.said[0], "a.csv: it never moves by 3 m, and heads north")
        along([*((t, 10 * t, 0) for t in range(20)), (99, 300, 0)])
        self.assertRegex(self.said[0], "a.csv: the longest gap between its points is 80 s")

    def test_vtk(self):
        (self.folder / "a.csv").write_text("time,x,y,z,yaw,pitch\n0,1,2,3,350,5\n1,2,2,3,20,-5\n2,3,2,3,10,0\n")
        line, data = read_trajectory("a.csv"), vertices([(1, 2, 3), (2, 2, 3), (3, 2, 3)])
        al.save(line, self.folder / "a.vtp")
        for name, values in (("time", [0, 1, 2]), ("heading", [350, 20, 10]), ("pitch", [5, -5, 0])):
            add_array(data.GetPointData(), name, np.array(values, np.float32))
        wanted = parts_of(line)
        for one in (self.folder / "a.vtp", line, data):
            points, times, turns = parts_of(read_trajectory(one))
            self.assertTrue(np.array_equal(points, wanted[0]) and np.array_equal(times, wanted[1]))
            self.assertLess((turns * wanted[2].inv()).magnitude().max(), 1e-9)

    def test_bags(self):
        """The platform moves every 0.1 s, a gimbal on it every 0.07 s; the lidar is fixed to the gimbal."""
        chance, still = np.random.default_rng(4), (0, 0, 0, 1)
        ways = {"base": (np.arange(0, 21) * 10**8, "map"), "gimbal": (np.arange(3, 25) * 7 * 10**7, "base")}
        poses = {name: (chance.normal(size=(len(times), 3)), Rotation.random(len(times), random_state=5))
                 for name, (times, _) in ways.items()}
        messages = [("/tf_static", _ros.TRANSFORMS, 0, TestRecording.transform(0, "gimbal", "lidar", (1, 0, 2), still))]
        messages += [("/tf", _ros.TRANSFORMS, 0, TestRecording.transform(
            DAY * 10**9 + int(time), parent, f"/{name}", place, turn.as_quat()))
            for name, (times, parent) in ways.items() for time, place, turn in zip(times, *poses[name])]
        TestRecording.mcap("a.mcap", messages)
        both = np.union1d(ways["base"][0], ways["gimbal"][0])
        both = both[(both >= 21 * 10**7) & (both <= 168 * 10**7)]
        for frame, place in (("gimbal", (0.0, 0.0, 0.0)), ("lidar", (1.0, 0.0, 2.0))):
            turn = Rotation.identity()
            for name in ("gimbal", "base"):
                step = Slerp(ways[name][0], poses[name][1])(both)
                place = step.apply(place) + np.array([np.interp(both, ways[name][0], x) for x in poses[name][0].T]).T
                turn = step * turn
            points, times, turns = parts_of(read_trajectory("a.mcap", frame=frame, start_time=DAY))
            np.testing.assert_allclose(points, place, atol=1e-6)
            np.testing.assert_allclose(times, both * 1e-9, atol=3e-7)
            np.testing.assert_allclose(turns.apply([0, 1, 0]), turn.apply([1, 0, 0]), atol=1e-6)
        _, times, _ = parts_of(read_trajectory("a.mcap"))  # of the gimbal, from its first time on
        self.assertEqual((len(times), times[0]), (len(both), 0))
        self.assertEqual(len(parts_of(read_trajectory("a.mcap", frame="base"))[1]), 21)
        rows = np.zeros(1, [(axis, "f4") for axis in "xyz"])
        TestRecording.mcap("a.mcap", [*messages, ("/points", _ros.CLOUD, 0, TestRecording.message(0, rows))])
        np.testing.assert_allclose(parts_of(read_trajectory("a.mcap"))[0], place, atol=1e-6)

    def test_times_and_tracks(self):
        day = "2021-05-04T00:00:0"
        text = f"id,time,x,y,z\na,{day}5Z,1,2,3\nb,{day}6Z,5,5,5\na,{day}9Z,2,2,3\nb,{day}8Z,5,5,5\n"
        self.assertEqual(self.read("a.csv", text, track="b")[1].tolist(), [0, 2])
        self.assertEqual(self.read("a.csv", text, track="a", start_time=DAY)[1].tolist(), [5, 9])
        self.assertEqual(self.read("a.csv", "id,time,x,y,z\n1,5,1,2,3\n2,7,2,2,3\n")[1].tolist(), [5, 7])
        two = GPX.format("", WALK)
        self.check(self.read("a.gpx", two, origin=ORIGIN, track="drive"))
        self.assertRaisesRegex(al.Error, "a.gpx: has drive, walk as tracks", self.read, "a.gpx", two, origin=ORIGIN)

    def test_errors(self):
        good, gpx = "time,x,y,z\n0,1,2,3\n1,2,2,3\n", GPX.format("", "")
        for name, text, settings, words in (
                ("a.las", "", {}, "is not a trajectory, expected .vtp, .csv"),
                ("a.csv", good, {"frame": "base"}, "frame is 'base', expected none"),
                ("a.csv", good, {"height_reference": "cramp"}, "height_reference 'cramp'.* did you mean 'clamp'"),
                ("a.csv", good, {"height_reference": "clamp"}, "points without a height.* expected scene"),
                ("a.csv", good, {"track": "a"}, "has no names as tracks"),
                ("a.csv", good[:-8], {}, "expected 2 or more points with a position and a time, has 1"),
                ("a.csv", good.replace("z", "z,qx"), {}, "the quaternion of point 1 has the length nan, expected 1"),
                ("a.csv", good, {"geoid_undulation": "a"}, "geoid_undulation is 'a', expected metres"),
                ("a.csv", "time,lat,lon,alt\n0,47,8,400\n1,47,8,400\n", {}, "has longitudes and latitudes, but"),
                ("a.gpx", gpx, {}, "has longitudes and latitudes, but"), ("a.gpx", "<gpx>", {}, "is damaged, expected"),
                ("a.gpx", GPX.format("", WALK), {"track": "walk"}, r"has 0; left out: rows without a time \(1\)"),
                ("a.gpx", "<gpx><rte><rtept/></rte></gpx>", {}, r"1 of routes \(rtept\)"),
                ("a.gpx", gpx.replace("47.4512", "147"), {"origin": ORIGIN}, "point 2: latitude"),
                ("a.gpx", gpx.replace("12:00", "noon"), {"origin": ORIGIN}, "point 1: time is"),
                ("a.kml", KML.format("<when/>", ""), {}, "the track flight has 5 when, 4 coord"),
                ("a.kml", "<kml><TimeStamp/></kml>", {}, "1 places with a TimeStamp: expected"),
                ("a.kmz", b"PK\x03\x04", {}, "is damaged"), ("a.vtp", "", {}, ""), ("a.mcap", "", {}, "")):
            words = f"{name}: .*{words}"
            with self.subTest(words), self.assertRaisesRegex((al.Error, ValueError), words):
                self.read(name, text, **settings)
        self.assertRaisesRegex(al.Error, "start_time: is '2021', but .*a.csv has no times since 1970", self.read,
                               "a.csv", good, start_time="2021")
        self.assertEqual(self.read("a.csv", good, start_time=-4)[1].tolist(), [4, 5])
        words = (("columns", ("time:t", "z:height")), ("track", 3), ("height_reference", "clamp"))
        self.assertEqual(settings_of(words), {"columns": {"time": "t", "z": "height"}, "track": "3",
                                              "height_reference": "clamp"})
        for name, value in (("heigt_reference", 1), ("columns", "time")):
            self.assertRaisesRegex(ValueError, f"--trajectory-set: .*{name}", settings_of, [(name, value)])
        self.assertRaisesRegex(al.Error, "the trajectory: has the point arrays none, expected time", read_trajectory,
                               vertices([(1, 2, 3)]))
        still = [TestRecording.transform(stamp, "map", "base", (1, 2, 3), (0, 0, 0, 1)) for stamp in (1, 2)]
        TestRecording.mcap("still.mcap", [("/tf", _ros.TRANSFORMS, 0, data) for data in still])
        for frame in ("", "base", "other"):
            self.assertRaisesRegex(ValueError, "still.mcap: .*expected the choice of one frame that moves",
                                   read_trajectory, "still.mcap", frame=frame)
