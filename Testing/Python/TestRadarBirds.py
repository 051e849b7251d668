# SPDX-License-Identifier: BSD-3-Clause
"""Tables of tracks as radars, GPS loggers and Movebank write them: the same birds from each, heights above the sea, the
ground and the ellipsoid, what is left out, what is wrong; scenarios that scan these birds, and warn of birds that are
far away."""
import datetime
import json
import os
import pathlib
import unittest
import warnings

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

import TestSequence
import avianlidar as al
import scenetools
from avianlidar import reach
from avianlidar._pipeline import update
from avianlidar.apps.sequences._flights import read_flights
from avianlidar.vtkAvianLidar import vtkAvianLidarTracks
from exampletools import emptied
from helpertools import rows_of, run, warned

ORIGIN = (47.45, 8.55, 420.0)
# latitude, longitude, m above the sea
PLACES = [(47.4512, 8.5523, 445.0), (47.4513, 8.5525, 446.5), (47.4515, 8.5526, 448.0)]
CLOCK = [37353, 37354.5, 37357]  # s of 4 May 2021
DAY = 1620086400  # s from 1970 to 4 May 2021
SCENE = {**TestSequence.SCENE, "origin": dict(zip(("latitude", "longitude", "height"), ORIGIN)),
         "lidar": {"position": [0, 0, 3]}}
SCENARIO = {"scene": "small.lidarscene.json", "number_of_scans": 6, "scans_per_sequence": 3,
            "scan": {"rays_per_beam": 30}, "sensor": {"preset": "Search905", "azimuth_step": 0.75}, "objects": []}


def closed_form(places, origin=ORIGIN):
    """East, north and up (m) of latitudes, longitudes (deg) and heights (m)."""
    names = "latitude", "longitude", "height"
    return np.array([scenetools.frame(dict(zip(names, origin)), dict(zip(names, place)))[0] for place in places])


def clock(second, separator="T"):
    return f"2021-05-04{separator}{int(second // 3600):02d}:{int(second // 60 % 60):02d}:{second % 60:06.3f}"


def table(header, row, separator="\n", decimal="."):
    """A header and a row for each place: latitude, longitude, height, also in other units, and the time in several
    forms."""
    rows = [row.format(*(f"{number}".replace(".", decimal) for number in (lat, lon, h)), ft=f"{h / 0.3048:.6f}",
                       hae=h + 47, km=h / 1000, T=clock(s), t=clock(s, " "), day=clock(s)[11:], later=clock(s + 7200),
                       comma=clock(s).replace(".", ","), s=DAY + s, ms=round((DAY + s) * 1000))
            for (lat, lon, h), s in zip(PLACES, CLOCK)]
    return separator.join([header, *rows, ""])


WRITTEN = {
    "Movebank's download": table(
        "event-id,visible,timestamp,location-long,location-lat,gps:dop,ground-speed,height-above-ellipsoid,"
        "height-above-msl,sensor-type,individual-taxon-canonical-name,tag-local-identifier,individual-local-identifier,"
        "study-name", '1,true,{t},{1},{0},1.2,9.1,{hae},{2},"gps","Larus argentatus","T 7","Emma #3","Gulls, 2021"'),
    "Movebank in R": table("location.long,location.lat,timestamp,height.above.msl,tag.local.identifier,"
                           "individual.local.identifier", "{1},{0},{t},{2},T 7,Emma #3"),
    "Movebank's service": table("individual_local_identifier,timestamp,location_lat,location_long,height_above_msl,"
                                "visible", "Emma #3,{t},{0},{1},{2},TRUE"),
    "UvA-BiTS": table("device_info_serial,date_time,latitude,longitude,altitude,altitude_agl",
                      "Emma #3,{t},{0},{1},{2},25"),
    "Ornitela": table("device_id,UTC_datetime,UTC_date,UTC_time,datatype,satcount,Latitude,Longitude,MSL_altitude_m",
                      "Emma #3,{t},2021-05-04,{day},GPS,8,{0},{1},{2}"),
    "a time in one word": table("GPStime,lat,lon,alt", "{T}Z,{0},{1},{2}"),
    "GPX as CSV": table("lat,lon,ele,time", "{0},{1},{2},{T}Z"),
    "a logger with date and time": table("Date,Time,Latitude,Longitude,Altitude(m),Speed",
                                         "2021/05/04,{day},{0},{1},{2},3"),
    "a radar, ms, feet": table("TrackID,TimestampMs,Latitude (deg),Longitude (deg),Altitude AMSL (ft),RCS [dBm2]",
                               "Emma #3,{ms},{0},{1},{ft},-21"),
    "a radar with its own x and y": table("track_id,timestamp,x,y,latitude,longitude,altitude",
                                          "Emma #3,{s},511.0,-93.1,{0},{1},{2}"),
    "a European spreadsheet": "\ufeffsep=;\r\n" + table("Track;Zeit;Breite;Länge;Höhe",
                                                        "Emma #3;{T}+00:00;{0};{1};{2}", "\r\n", ","),
    "another zone, tabs, comments": "# MERLIN\n\n" + table("track number\ttime\tlat\tlng\talt_msl\n# begins",
                                                         "Emma #3\t{later}+02:00\t{0}\t{1}\t{2}"),
    "a header that is a comment": "# a radar, 1.5 GHz\n" + table("# track_id, timestamp, latitude, longitude, altitude",
                                                                "Emma #3,{s},{0},{1},{2}"),
    "a comment with the header's words": table("#id,time,lat,lon,alt\ntrack_id,timestamp,latitude,longitude,altitude",
                                               "Emma #3,{s},{0},{1},{2}"),
    "kilometres": table("id,epoch,position_lat,lon_wgs84,height_km", "Emma #3,{s},{0},{1},{km}"),
    "quotes": table('"trackId","dateTime","decimalLatitude","decimalLongitude","heightAboveMSL"',
                    '"Emma #3","{comma} UTC","{0}","{1}","{2}"')}
GERMAN = {"time": "Zeit", "latitude": "Breite", "longitude": "Länge", "height": "Höhe"}


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = emptied("radar-birds", "tables")

    def read(self, text, **settings):
        file = self.home / "own.csv"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_flights(file, **{"origin": ORIGIN, **settings})

    def refused(self, words, text, **settings):
        with self.subTest(words), self.assertRaisesRegex(al.Error, f"own.csv: {words}"):
            self.read(text, **settings)

    def test_the_same_birds_from_all_programs(self):
        for name, text in WRITTEN.items():
            with self.subTest(name):
                found = self.read(text, columns=GERMAN if "Zeit" in text else None)
                np.testing.assert_allclose(found.points, closed_form(PLACES), atol=2e-4)
                np.testing.assert_allclose(found.times, np.add(CLOCK, DAY), atol=2e-3)
                self.assertTrue(found.since_1970)
                self.assertEqual((found.ids, found.species), (["Emma #3" if "Emma" in text else "1"], ["herring gull"]))
                self.assertEqual(found.warning, "")

    def test_the_chosen_columns_are_printed(self):
        """Which columns were taken, and how."""
        words = self.read(WRITTEN["Movebank in R"]).words
        self.assertRegex(" ".join(words.split()),
                         "own.csv: 1 track with 3 positions time is timestamp, longitude is location.long, latitude is "
                         "location.lat, height is height.above.msl, id is individual.local.identifier heights are "
                         "above the sea times without a zone are UTC$")
        self.assertEqual([line for line in words.split("\n")[1:] if len(line) > 120], [])
        self.assertIn("times are milliseconds since 1970",
                      self.read(WRITTEN["a radar, ms, feet"].replace("TimestampMs", "timestamp")).words)
        self.assertNotIn("zone", self.read(WRITTEN["GPX as CSV"]).words)

    def test_metres_of_the_scene(self):
        """The format of vtkAvianLidarTracks, with times from the first scan, and the same flights."""
        text = ("id,species,time,x,y,z\n17,herring gull,0,0,0,20\nb,crow,1,0,0,30\n17,herring gull,4,0,50,20\n"
                "b,crow,3,26,0,30\n")
        found = self.read(text, origin=None)
        self.assertEqual((found.ids, found.species, found.since_1970), (["17", "b"], ["herring gull", "crow"], False))
        tracks, from_file = vtkAvianLidarTracks(), vtkAvianLidarTracks()
        tracks.SetPatternToLines()
        tracks.SetInputData(found.lines(-np.inf, np.inf)[0])
        from_file.SetPatternToFile()
        from_file.SetFileName(str(self.home / "own.csv"))
        for one in (tracks, from_file):
            update(one)
        for k in range(2):
            for name in ("pose_time", "pose_position", "pose_orientation", "flap_phase"):
                ours, theirs = (vtk_to_numpy(one.GetOutputDataObject(0).GetBlock(k).GetFieldData().GetArray(name))
                                for one in (tracks, from_file))
                np.testing.assert_array_equal(ours, theirs)

    def test_lines_for_other_programs(self):
        """As ParaView reads them: times begin with the table, or with the given time."""
        file = self.home / "lines.csv"
        file.write_text(WRITTEN["a radar with its own x and y"])
        lines = al.read_tracks(file, origin=ORIGIN, start_time="2021-05-04T10:22:30Z")
        np.testing.assert_allclose(vtk_to_numpy(lines.GetPointData().GetArray("time")), [3, 4.5, 7], atol=1e-6)
        al.save(al.read_tracks(file, origin=ORIGIN, species="crow"), self.home / "lines.vtp")
        reader, tracks = vtkXMLPolyDataReader(), vtkAvianLidarTracks()
        reader.SetFileName(str(self.home / "lines.vtp"))
        tracks.SetInputConnection(reader.GetOutputPort())
        tracks.SetPatternToLines()
        update(tracks)
        fields = tracks.GetOutputDataObject(0).GetBlock(0).GetFieldData()
        np.testing.assert_allclose(vtk_to_numpy(fields.GetArray("pose_time")), [0, 1.5, 4], atol=1e-6)
        np.testing.assert_allclose(vtk_to_numpy(fields.GetArray("pose_position")), closed_form(PLACES), atol=2e-4)
        self.assertEqual(fields.GetAbstractArray("species").GetValue(0), "crow")
        moment = datetime.datetime(2021, 5, 4, 10, 22, 30)
        zone = datetime.timezone(datetime.timedelta(hours=8))
        for start in (moment, moment.replace(hour=18, tzinfo=zone), DAY + 37350, np.int64(DAY + 37350)):
            lines = al.read_tracks(file, origin=ORIGIN, start_time=start)
            np.testing.assert_allclose(vtk_to_numpy(lines.GetPointData().GetArray("time")), [3, 4.5, 7], atol=1e-6)

    def test_wrong_settings_are_named(self):
        file = self.home / "settings.csv"
        file.write_text(WRITTEN["a radar with its own x and y"])
        for settings, words in (
                ({"start_time": "yesterday"}, "start_time: is 'yesterday', expected 2026-05-04T10:22:33Z"),
                ({"start_time": float("nan")}, "start_time: is nan, expected"),
                ({"start_time": [1]}, r"start_time: is \[1\], expected"),
                ({"height_reference": "Sea"}, "settings.csv: height_reference 'Sea' is not known; did you mean 'sea'"),
                ({"height_reference": "qnh"},
                 "height_reference 'qnh' is not known; expected one of sea, ground, ellipsoid"),
                ({"columns": {"hight": "altitude"}},
                 "settings.csv: columns: 'hight' is not known; did you mean 'height'"),
                ({"height_reference": "ground"},
                 r"settings.csv: heights \(altitude\) are above the ground, but there is no scene: expected scene")):
            with self.subTest(words), self.assertRaisesRegex(al.Error, words):
                al.read_tracks(file, **{"origin": ORIGIN, **settings})
        file.write_text("time,x,y,altitude_agl\n0,5,6,30\n1,6,6,30\n")
        self.assertRaisesRegex(al.Error, r"heights \(altitude_agl\) are above the ground, but there is no scene",
                               al.read_tracks, file)
        file.write_text("time,x,y,z\n0,5,6,30\n1,6,6,30\n")
        self.assertRaisesRegex(al.Error, "start_time: is given, but .*settings.csv has no times since 1970",
                               al.read_tracks, file, start_time=DAY)

    def test_levels_of_heights(self):
        head, row = "time,lat,lon,{}\n", "{},47.4512,8.5523,{}\n"
        up = closed_form([(*PLACES[0][:2], ORIGIN[2])])[0][2]  # of a place at the origin's height

        def z(name, height, **settings):
            return self.read(head.format(name) + row.format(0, height) + row.format(1, height), **settings).points[0, 2]
        for name in ("altitude", "height", "alt_msl", "height-above-msl", "Altitude ASL [m]", "z"):
            self.assertAlmostEqual(z(name, 445) - up, 25.0, places=3)
        for name in ("altitude", "height_above_ellipsoid", "alt hae", "altitude_wgs84"):
            self.assertAlmostEqual(z(name, 492, geoid_undulation=47.0, height_reference="ellipsoid") - up, 25.0,
                                   places=3)
        ground = al.Scene((np.array([(-1e4, -1e4, 0.0), (1e4, -1e4, 0.0), (0.0, 1e4, 0.0)]), np.array([(0, 1, 2)])))
        for name in ("height", "altitude_agl", "AGL", "height above ground level (m)"):
            self.assertEqual(z(name, 25, height_reference="ground", scene=ground), 25.0)
        self.assertEqual(z("altitude_agl", 25, scene=ground), 25.0)
        both = "ground_elevation,height_agl,altitude,height_above_ellipsoid"
        for level, wanted in (("", 25.0), ("sea", 25.0), ("ellipsoid", 20.0)):
            self.assertAlmostEqual(z(both, "400,30,445,487", height_reference=level, geoid_undulation=47.0) - up,
                                   wanted, places=3)
        self.assertEqual(z(both, "400,30,445,487", height_reference="ground", scene=ground), 30.0)
        self.assertAlmostEqual(z("altitude_m,altitude_ft", "445,1") - up, 25.0, places=3)
        self.refused(r"heights \(height-above-ellipsoid\) are above the ellipsoid.* expected geoid_undulation",
                     head.format("height-above-ellipsoid") + row.format(0, 492))
        self.refused("height_reference is 'sea', but the column 'alt_hae' is above the ellipsoid by its name",
                     head.format("alt_hae") + row.format(0, 492), height_reference="sea")
        local = "time,x,y,{}\n0,5,6,450\n1,6,6,450\n"
        for name, settings, wanted in (("z", {}, 450), ("altitude", {}, 450), ("altitude_msl", {}, 30),
                                       ("altitude", {"height_reference": "sea"}, 30),
                                       ("hae", {"geoid_undulation": 47.0}, -17)):
            np.testing.assert_allclose(self.read(local.format(name), **settings).points[0], (5, 6, wanted))

    def test_names_of_heights(self):
        for name, size in (("Altitude (m a.s.l.)", 1), ("height a.m.s.l.", 1), ("GPSAltitude", 1), ("baro_altitude", 1),
                           ("z_msl", 1), ("height (cm)", 0.01), ("alt_mm", 0.001), ("altitude,barometric altitude", 1)):
            with self.subTest(name):
                row = f",{445 / size:g}" + ",1" * name.count(",")
                found = self.read(f"time,lat,lon,{name}\n0,47.4512,8.5523{row}\n1,47.4512,8.5523{row}\n")
                np.testing.assert_allclose(found.points[0], closed_form(PLACES)[0], atol=1e-6)
        self.refused(r"heights \(Height \(m a.g.l.\)\) are above the ground, but there is no scene",
                     "time,lat,lon,Height (m a.g.l.)\n0,47,8,30\n1,47,8,30\n")

    def test_impossible_heights(self):
        rows = "".join(f"{t},47.45,8.55,{height}\n"
                       for t, height in enumerate((440, -9999, 9999, -32768, 32767, -999, -501, 20001, -499, 19999)))
        found = self.read("time,lat,lon,alt\n" + rows)
        self.assertEqual(found.times.tolist(), [0, 8, 9])
        self.assertRegex(found.warning, r"own.csv: left out: rows with an impossible height \(7\)$")
        feet = self.read(
            "time,lat,lon,alt_ft\n0,47.45,8.55,-9999\n1,47.45,8.55,9999\n2,47.45,8.55,1400\n3,47.45,8.55,1500\n")
        self.assertEqual(feet.times.tolist(), [2, 3])
        self.assertEqual(self.read("time,lat,lon,alt_mm\n0,47.45,8.55,9999\n2,47.45,8.55,9999\n").warning, "")

    def test_columns_without_a_value(self):
        """As Movebank writes heights of loggers that have one of them; beyond the first rows, too."""
        for before in (0, 1500):
            text = "timestamp,location-long,location-lat,x,height-above-ellipsoid,height-above-msl,id,tag\n" + "".join(
                f"{t},8.5523,47.4512,,492,,,\n" for t in range(before + 2))
            found = self.read(text, geoid_undulation=47.0)
            np.testing.assert_allclose(found.points[0], closed_form(PLACES)[0], atol=1e-6)
            self.assertEqual((found.ids, len(found.times), found.warning), (["1"], before + 2, ""))
            self.assertIn("columns without a value are ignored: x, height-above-msl, id, tag", found.words)
        both = text + "3000,8.5523,47.4512,,492,445,,\n3001,8.5523,47.4512,,492,445,,\n"
        found = self.read(both)
        self.assertEqual(found.times.tolist(), [3000, 3001])
        self.assertRegex(found.warning, r"left out: rows without a height \(1502\)$")
        self.assertRegex(self.read("time,lat,lon,alt\n0,47,8,\n1,47,8,\n").warning,
                         r"left out: rows without a height \(2\)$")

    def test_times(self):
        """ISO 8601 in its basic form, times that people have written, and leap seconds."""
        for text, second in (("20210504T102233Z", 37353), ("20210504T102233.5+0200", 30153.5),
                             ("2021-05-04 9:30:00", 34200), ("2021-05-04T1022Z", 37320),
                             ("2021-05-04T24:00:00Z", 86400), ("2021-05-04T23:59:60Z", 86400),
                             ("2021/05/04 10:22", 37320)):
            with self.subTest(text):
                found = self.read(f"time,lat,lon,alt\n2021-05-04T00:00:00Z,47.45,8.55,440\n{text},47.45,8.55,440\n")
                self.assertAlmostEqual(found.times[1] - DAY, second, places=5)
        for text in ("2021-05-04T24:00:01Z", "2021-05-04T10:22:61Z", "2021-0504T10:22:33Z", "2021-02-29T10:22:33Z",
                     "20210504T10223Z", "2021-05-04T25:00"):
            self.refused(f"line 2: time is '{text}",
                         f"time,lat,lon,alt\n{text},47.45,8.55,440\n2021-05-04T00:00:00Z,47.45,8.55,440\n")
        for name in ("UpdateTime(UTC)", "Detection Time", "local_timestamp", "Update Time,time", "Event DateTime"):
            with self.subTest(name):
                count = name.count(",") + 1
                found = self.read(f"lat,lon,alt,{name}\n47.45,8.55,440{count * ',7'}\n47.45,8.55,440{count * ',9'}\n")
                self.assertEqual(found.times.tolist(), [7, 9])
        self.refused("the columns 'Update Time' and 'Detection Time' may both be the time",
                     "lat,lon,alt,Update Time,Detection Time\n1,2,3,4,5\n")

    def test_degrees_in_x_and_y(self):
        """As QGIS writes them, in both orders. Metres near the origin are metres."""
        for head, first, second, words in (
                ("X,Y,Z", "8.5523", "47.4512", '"columns": {"longitude": "X", "latitude": "Y"}'),
                ("x,y,alt", "47.4512", "8.5523", '"columns": {"latitude": "x", "longitude": "y"}')):
            text = f"{head},id,timestamp\n{first},{second},445,1,1\n{first},{second},445,1,2\n"
            self.refused(f"x and y look like longitude and latitude, .*{words}", text)
            found = self.read(text, columns=json.loads(words.partition(":")[2]), height_reference="sea")
            np.testing.assert_allclose(found.points[0], closed_form(PLACES)[0], atol=1e-6)
            self.assertEqual(self.read(text, origin=None).points[0, 0], float(first))
        self.assertEqual(self.read("x,y,z,time\n8,12,3,1\n60,70,3,2\n").points[0].tolist(), [8, 12, 3])

    def test_above_the_ground_of_a_slope(self):
        """Ground that rises by one metre in ten, below a roof; level beyond."""
        ground = [(x, y, 0.1 * x) for x in (0, 1000) for y in (0, 1000)]
        roof = [(x, y, 150.0) for x in (100, 300) for y in (100, 300)]
        scene = al.Scene((np.array(ground + roof, float), np.array([(0, 2, 1), (1, 2, 3), (4, 6, 5), (5, 6, 7)])))
        found = self.read("time,x,y,height_agl\n0,200,210,30\n5,400,210,30\n9,-50,210,30\n", scene=scene)
        lines, _ = found.lines(0.0, 10.0)
        np.testing.assert_allclose(vtk_to_numpy(lines.GetPoints().GetData()),
                                   [(200, 210, 50), (400, 210, 70), (-50, 210, 30)], atol=1e-9)
        self.assertAlmostEqual(found.nearest((200, 210, 0), 0.0, 0.5)[0], 50.0)  # the bird rises, and flies away
        self.assertAlmostEqual(found.nearest((300, 210, 0), 0.0, 4.0)[0], 60 * 200 / np.hypot(200, 20), places=9)
        # not later, when it is nearer
        self.assertAlmostEqual(found.nearest((300, 210, 0), 0.0, 0.5)[0], np.hypot(80, 52))
        self.assertAlmostEqual(found.nearest((300, 210, 0), 4.0, 5.0)[0], np.hypot(60, 66))  # nor earlier
        self.assertAlmostEqual(found.nearest((-50, 210, 0), 9.0, 9.5)[0], 30.0)

    def test_rows_that_are_left_out_are_counted(self):
        found = self.read("track_id,time,latitude,longitude,altitude,visible\n" + "".join(f"{row}\n" for row in (
            "1,0,47.451,8.552,440,true", "2,0,47.452,8.552,440,true", "1,2,47.453,8.552,440,true", "2,1,0,0,0,true",
            "2,5,47.451,8.553,,true", "2,4,47.451,8.553,440,true", "2,4,47.4511,8.553,440,true",
            "3,1,47.451,8.553,440,true", "1,1,47.4515,8.552,440,true", "1,6,47.5,9.5,440,FALSE",
            ",6,47.5,9.5,440,true", "1,NA,47.5,9.5,440,true", "1,7,NaN,9.5,440,true")))
        self.assertEqual((found.ids, found.times.tolist(), found.begins.tolist()),
                         (["1", "2"], [0, 1, 2, 0, 4], [0, 3, 5]))
        self.assertRegex(found.warning,
                         r"own.csv: left out: rows marked as outliers \(1\), rows without a position \(1\), rows "
                         r"without a height \(1\), rows at 0, 0 degrees \(1\), rows without a time \(1\), rows without "
                         r"an id \(1\), rows of a time that their track already has \(1\), tracks of one position "
                         r"\(1\)$")
        marked = "timestamp,lat,lon,height,manually-marked-outlier\n" + "".join(
            f"{k},47.45,8.55,440,{'true' if k == 1 else ''}\n" for k in range(3))
        self.assertEqual(self.read(marked).times.tolist(), [0, 2])

    def test_rows_without_a_date(self):
        text = ("date,time,lat,lon,height\n{0},10:00:02,47.45,8.55,440\n,10:00:03,47.46,8.55,440\n"
                "{0},9:00:04,47.47,8.55,440\n")
        found = self.read(text.format("2021-05-04"))
        self.assertEqual(found.times.tolist(), [DAY + 32404, DAY + 36002])
        self.assertRegex(found.warning, r"own.csv: left out: rows without a date \(1\)$")
        found = self.read(text.format(""))
        self.assertEqual((found.ids, found.times.tolist()), ([], []))
        self.assertRegex(found.warning, r"own.csv: left out: rows without a date \(3\)$")
        unused = self.read("date,timestamp,lat,lon,height\n,2021-05-04T10:00:02Z,47.45,8.55,440\n"
                           ",2021-05-04T10:00:03Z,47.46,8.55,440\n")
        self.assertEqual((unused.times.tolist(), unused.warning), ([DAY + 36002, DAY + 36003], ""))
        with warnings.catch_warnings():  # tracks of one position alone
            warnings.simplefilter("ignore")
            (self.home / "one.csv").write_text("timestamp,lat,lon,height\n2021-05-04T10:00:02Z,47.45,8.55,440\n")
            self.assertEqual(al.read_tracks(self.home / "one.csv", origin=ORIGIN).GetNumberOfPoints(), 0)

    def test_species(self):
        text = "bird_id,species,time,x,y,z\n" + "".join(f"{k},{name},{t},0,{t},5\n" for k, name in enumerate(
            ("Crow", "Branta canadensis", "", "canada goose", "Larus fuscus")) for t in (0, 1))
        found = self.read(text, species="pigeon")
        self.assertEqual(found.species, ["crow", "Canada goose", "pigeon", "Canada goose", "pigeon"])
        self.assertIn("tracks of unknown species fly as pigeon: Larus fuscus (1)", found.words)
        self.refused("the species 'Larus fuscus' are not known: expected starling", text)
        (self.home / "species.csv").write_text(
            "species,mass [kg],length [m],span [m],wing area [m2],passerine,airspeed [m/s]\nLarus "
            "fuscus,0.8,0.54,1.3,0.19,no,12\n")
        self.assertEqual(self.read(text, species_file_name=str(self.home / "species.csv")).species[-2:],
                         ["Canada goose", "Larus fuscus"])

    def test_columns_that_are_named(self):
        text = "Zeit,Breite,lat,lon,z,height\n0,47.4512,1,8.5523,1,445\n1,47.4513,1,8.5525,2,446.5\n"
        found = self.read(text, columns={"time": "Zeit", "latitude": "Breite", "height": "height"})
        np.testing.assert_allclose(found.points, closed_form(PLACES[:2]), atol=1e-3)
        # units and levels of names are taken
        for name, height in (("BirdHt_ft", 445 / 0.3048), ("Vogel (km)", 0.445), ("Vogel", 445)):
            one = self.read(f"Uhr ms,lat,lon,{name}\n0,47.4512,8.5523,{height:.6f}\n2000,47.4513,8.5525,{height:.6f}\n",
                            columns={"time": "Uhr ms", "height": name})
            np.testing.assert_allclose(one.points[0], closed_form(PLACES)[0], atol=1e-3)
            self.assertEqual(one.times.tolist(), [0, 2])
        one = self.read("time,x,y,BirdHt AMSL [ft]\n0,5,6,1500\n1,6,6,1500\n", columns={"height": "BirdHt AMSL [ft]"})
        np.testing.assert_allclose(one.points[0], (5, 6, 1500 * 0.3048 - ORIGIN[2]))
        self.refused(r"has no column 'Uhr' \(time\), but Zeit, Breite", text, columns={"time": "Uhr"})

    def test_bad_tables_are_named(self):
        good = WRITTEN["GPX as CSV"]
        for text, words in (
                ("", "expected the names of columns"), ("lat lon ele time\n", "expected the names of columns"),
                ("lat,lon,ele\n1,2,3\n", "has no column for the time, but lat, lon, ele; expected"),
                ("lat,lon,ele,a,Zeit\n", 'has no column for the time.* or "columns": {"time": "Zeit"}'),
                ("lat,lon,time,a,Höhe\n", '"columns": {"height": "Höhe"}'),
                ("a,Lat_N,Long_E,time,ele\n", '"columns": {"latitude": "Lat_N", "longitude": "Long_E"}'),
                ("a,b,time,ele\n", '"columns": {"latitude": "...", "longitude": "..."}'),
                ("easting,northing,time,ele\n", r"coordinates of a map \(UTM\) must be converted"),
                ("a,time,z\n1,2,3\n",
                 "has no column for the position, but a, time, z; expected latitude and longitude in"),
                ("lat,time,ele\n1,2,3\n", "has no column for the longitude"),
                ("lat,lon,time\n1,2,3\n", "has no column for the height"),
                ("lat,latitude,lon,ele,time\n",
                 "columns 'lat' and 'latitude' may both be the latitude: choose one, as in .columns.: {.latitude"),
                ("track_id,Track ID,lat,lon,ele,time\n", "columns 'track_id' and 'Track ID' may both be the id"),
                ("lat,lon,ele,time,timestamp,datetime\n", "columns 'timestamp' and 'datetime' may both be the time"),
                (good.replace("8.5525", "8°33"), "line 3: longitude is '8°33', expected degrees"),
                (good.replace("446.5", "high"), "line 3: height is 'high'"),
                (good.replace("47.4513", "5255000"),
                 r"line 3: latitude \(lat\) is 5.255e\+06, expected degrees within -90 and 90$"),
                (good.replace("47.", "97."),
                 "line 2: latitude .* 97.4512, .*; latitude and longitude may be exchanged"),
                (good.replace("-05-04T", "/04/05 4.").replace("2021", "5"),
                 "line 2: time is '5/04/05 4.10:22:33.000Z', expected 2026-05-04T10:22:33Z, with"),
                (good.replace("T10:22:34", "T10:61:34"), "line 3: time is '2021-05-04T10:61:34.500Z', expected"),
                ("time,lat,lon,ele\n20210504102233,1,2,3\n20210504102234,1,2,3\n",
                 "line 3: time is '20210504102234', expected"),
                ("time,lat,lon,ele\n\n# x\n1,1,2,3\n1,1,3,3\n",
                 "line 5: a bird is at two places at one time, expected a column with the ids"),
                (good + '"', "not a table that can be read"), (good.encode("utf-16"), "is in UTF-16, expected UTF-8"),
                (good.replace("lat,", "lat,\u00fc").encode("latin-1"), "not text in UTF-8")):
            self.refused(f".*{words}", text)
        self.refused("has longitudes and latitudes, but the scene has no origin", good, origin=None)
        with self.assertRaisesRegex(al.Error, "nowhere.csv: cannot be read"):
            read_flights(self.home / "nowhere.csv")

    def test_part_of_a_track(self):
        """Poses in a part are those of the whole flight, also in a turn."""
        t = np.arange(0.0, 60.0, 1.3)
        found = self.read("id,time,x,y,z\n"
                          + "".join(f"a,{s:.3f},{90 * np.cos(s / 9):.4f},{90 * np.sin(s / 9):.4f},{20 + s / 9:.4f}\n"
                                    for s in t) + "b,70,0,0,1\nb,80,0,0,1\n")
        poses = []
        for begin, end in ((0.0, 60.0), (20.0, 26.0)):
            lines, ids = found.lines(begin, end)
            self.assertEqual(ids, ["a"])
            tracks = vtkAvianLidarTracks()
            tracks.SetPatternToLines()
            tracks.SetInputData(lines)
            update(tracks)
            fields = tracks.GetOutputDataObject(0).GetBlock(0).GetFieldData()
            times, turned = (vtk_to_numpy(fields.GetArray(name)).copy() for name in ("pose_time", "pose_orientation"))
            self.assertTrue(times[0] <= begin and times[-1] >= min(end, 59.8))
            near = (times >= 20.0 - 1.3) & (times <= 26.0 + 1.3)
            poses.append(turned[near])
        self.assertLess(len(times), 15)
        np.testing.assert_allclose(*poses, atol=1e-12)


class Scenarios(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = emptied("radar-birds", "scenarios")

    def scenario(self, rows, around=SCENE, head="track_id,timestamp,latitude,longitude,altitude", group=None,
                 **changes):
        """A scenario with a table of tracks."""
        (self.home / "radar.csv").write_text("\n".join([head, *(",".join(map(str, row)) for row in rows), ""]), "utf-8")
        birds = [{"pattern": "File", "file_name": "radar.csv", **(group or {})}]
        return TestSequence.scenario_file(self.home, around, **{**SCENARIO, "birds": birds, **changes})

    def made(self, rows, **more):
        """The sequence of a scenario, and the warnings."""
        return warned(lambda: al.Sequence(self.scenario(rows, **more), threads=1))

    def warned(self, words, rows, count=1, **more):
        """@param words of all warnings; empty: there is no warning"""
        with self.subTest(words):
            _, heard = self.made(rows, **more)
            self.assertEqual(len(heard), count if words else 0, heard)
            self.assertRegex(" ".join(heard), words or "^$")

    def refused(self, words, rows, **more):
        with self.subTest(words), self.assertRaisesRegex(al.Error, f"small.scenario.json: {words}"):
            al.Sequence(self.scenario(rows, **more))

    def track(self, name, east, north, height=440.0, begin=0.0, seconds=12.0, swap=False):
        """A bird that flies north at 10 m/s, as rows; the degrees follow from the radii of curvature."""
        sine = np.sin(np.radians(ORIGIN[0]))
        across = 6378137.0 / np.sqrt(1 - 0.00669437999 * sine ** 2)
        along = across * (1 - 0.00669437999) / (1 - 0.00669437999 * sine ** 2)
        for t in np.arange(begin, begin + seconds + 0.1, 2.0):
            degrees = [round(float(x), 7)
                       for x in (ORIGIN[0] + np.degrees((north + 10 * (t - begin)) / along),
                                 ORIGIN[1] + np.degrees(east / across) / np.cos(np.radians(ORIGIN[0])))]
            yield (name, clock(36000 + t) + "Z", *(reversed(degrees) if swap else degrees), height)

    def test_labelled_scans(self):
        """The scene lends its origin. Truth and labels have birds where the table has them, and the table's ids."""
        rows = sorted([*self.track("A7", 100, 150), *self.track("B2", -120, 160, begin=7.0, seconds=4.0)],
                      key=lambda row: row[1])
        out = self.home / "out"
        sequence, heard = self.made(rows, group={"species": "Canada goose"})
        sequence.write(out)
        self.assertEqual(heard, [])
        truth = [row for file in sorted(out.glob("sequences/*/truth.csv")) for row in rows_of(file)]
        first, second = (rows_of(out / f"sequences/0{k}/truth.csv") for k in range(2))
        self.assertEqual({row["track"] for row in first}, {"A7"})  # B2 is under way only in the second sequence
        self.assertEqual({(row["track"], row["bird"]) for row in second}, {("A7", "10000"), ("B2", "10001")})
        self.assertEqual({row["species"] for row in truth}, {"Canada goose"})
        seen = [row for row in truth if row["status"] == "seen"]
        self.assertGreater(len(seen), 5)
        for row in (row for row in truth if row["x_m"]):
            east, north, begin = (100, 150, 0) if row["track"] == "A7" else (-120, 160, 7)
            wanted = (east, north + 10 * (float(row["time_s"]) - begin), 20)
            np.testing.assert_allclose([float(row[f"{axis}_m"]) for axis in "xyz"], wanted, atol=0.1)
        for row in seen:
            scan = int(row["scan"])
            file = out / f"sequences/{scan // 3:02d}/velodyne/{scan % 3:06d}.bin"
            points = np.fromfile(file, "<f4").reshape(-1, 4)
            labels = np.fromfile(file.parents[1] / "labels" / f"{file.stem}.label", "<u4")
            of_bird = points[labels == (99 | (int(row["bird"]) + 1) << 16)]
            self.assertLess(np.abs(np.linalg.norm(of_bird[:, :3], axis=1) - float(row["range_m"])).min(), 4.0)
        manifest = json.loads((out / "manifest.json").read_text())
        self.assertEqual(manifest["scenario"]["start_time"], "2021-05-04T10:00:00Z")
        al.Sequence(out / "manifest.json", threads=1).write(out)  # the same inputs

    def test_origin(self):
        """One of the group wins over that of the scene. Without both there is an error."""
        rows = [*self.track("A7", 100, 150)]
        own = (ORIGIN[0] - 0.0009, ORIGIN[1], 430.0)  # 100 m further south, 10 m higher
        place = al.Sequence(self.scenario(rows, group={"origin": own})).flights[0].points[0]
        np.testing.assert_allclose(place, (100, 250.07, 10), atol=0.02)
        around = {name: part for name, part in SCENE.items() if name != "origin"}
        np.testing.assert_allclose(al.Sequence(self.scenario(rows, around, group={"origin": own})).flights[0].points[0],
                                   place)
        self.refused(r"birds\[0\]: .*radar.csv: has longitudes and latitudes, but the scene has no origin on the "
                     "Earth: expected the key origin", rows, around=around)
        named = dict(zip(("latitude", "longitude", "height"), own))
        np.testing.assert_array_equal(al.Sequence(self.scenario(rows, group={"origin": named})).flights[0].points[0],
                                      place)
        for wrong in ([1, 2], [1, 2, 3, 4], {"latitude": 1, "longitude": 2}, {**named, "hight": 1}, "47.4, 8.5, 430",
                      [147.45, 8.55, 3], [1, 2, None], [1, 2, True], 47, None, {**named, "height": "430"}):
            with self.subTest(wrong):
                self.refused(r"birds\[0\]: origin is .*, expected latitude and longitude in degrees and height in "
                             r'metres, as in \{"latitude"', rows, group={"origin": wrong})

    def test_far_birds(self):
        """One warning for each file, with distances; a guess if another reading brings birds near."""
        gate = al.Sensor("Search905").range_gate
        near, far = [*self.track("A", 100, 150)], [*self.track("B", 0, gate + 500), *self.track("C", 0, -gate - 3000)]
        for rows, group, words in (
                ([*near, *far], {},
                 rf"radar.csv: 2 of 3 birds never come within the lidar's range gate of {gate:g} m: they pass the "
                 rf"lidar at {gate + 500:.0f} m to {gate + 2880:.0f} m$"),
                (self.track("A", 100, 150, swap=True), {},
                 r"the bird never comes .*: it passes the lidar at 5,\d\d\d km; probably latitude and longitude are "
                 "exchanged: corrected, the nearest bird is 18[0-9] m away$"),
                ([(name, t, lat, -lon, h) for name, t, lat, lon, h in near], {},
                 "probably the longitude has the wrong sign"),
                ([(name, t, -lat, lon, h) for name, t, lat, lon, h in near], {},
                 "probably the latitude has the wrong sign"),
                (near, {"origin": [31.2, 121.3, 3]},
                 r"it passes the lidar at 8,\d\d\d km; the origin is 31.2, 121.3 \(latitude, longitude\)$")):
            self.warned(words, rows, group=group)
        metres = [(name, t, 683000 + k, 5257000, 440) for k, (name, t, *_) in enumerate(near)]
        self.warned("x and y are metres east and north of the scene's origin; coordinates of a map .UTM. must be "
                    "converted .*ogr2ogr -t_srs EPSG:4326", metres, head="track_id,timestamp,x,y,z")
        # inside the gate before the first scan alone
        self.warned(f"the bird never comes .*: it passes the lidar at {gate + 300:.0f} m$",
                    [*self.track("A", 0, gate - 500, seconds=100)][::50], start_time=DAY + 36080)
        circles = [{"pattern": "Circles", "number_of_birds": 3, "center": [20000, 0, 0], "radius": 100}]
        self.warned(r"small.scenario.json: birds\[0\]: 3 of 3 birds never come within", [], birds=circles)

    def test_birds_above_and_below_all_beams(self):
        sensor = al.Sensor("Search905")
        low, high = reach.band(sensor)
        sea = {height: [*self.track("A", 100, 300, height)] for height in (420.0 + 3 + 20, 420.0 + 400, 20.0, 500.0)}
        for height, words in (
                (443, ""),
                (820, rf"radar.csv: the one bird within the range gate of {sensor.range_gate:g} m stays above the "
                 rf"beams \({low:.1f} to {high:.1f} deg\): the lowest elevation is 4[0-9].[0-9] deg, 397 m above the "
                 r"lidar; check height_reference \(heights count from the sea\) and the height of the scene's origin "
                 r"\(420 m\)$"),
                (20, "the one bird .* stays below the beams .*the highest elevation is -4[0-9].[0-9] deg, 403 m below "
                 "the lidar; check height_reference")):
            self.warned(words, sea[height])
        self.warned("", [*sea[820], *self.track("B", 100, 300)])  # one of two birds is at the height of the beams
        self.warned("1 of 3 birds never .*all 2 birds within the range gate of .* stay above the beams",
                    [*sea[820], *self.track("B", 50, 200, 900), *self.track("far", 0, sensor.range_gate + 900, 443)], 2)
        self.warned("", sea[820], sensor={**SCENARIO["sensor"], "orientation": [0, 40, 0]})  # a tilted lidar
        # passes the beams between two rows
        self.warned("", [("A", clock(36000 + t) + "Z", 47.4527, 8.5513, height) for t, height in ((0, 900), (12, 20))])

    def test_start(self):
        rows = [*self.track("A", 100, 150), *self.track("B", -100, 150, begin=600.0)]
        late, heard = self.made(rows, start_time="2021-05-04T12:10:00+02:00")
        self.assertEqual((heard, late.flights[0].lines(0.0, 12.0)[1]), ([], ["B"]))
        self.warned("radar.csv: no track is under way in the 12 s of the scans: from 2021-05-04T10:00:00Z to "
                    "2021-05-04T10:10:12Z; first scan at 2021-05-04T10:01:40Z; choose start_time or number_of_scans$",
                    rows, start_time=DAY + 36100)
        for changes in ({}, {"start_time": "2021-05-04T12:10:00+02:00"}):
            one, heard = self.made(rows[:1], **changes)
            self.assertEqual(one.flights[0].ids, [])
            self.assertRegex(" ".join(heard), r"left out: tracks of one position \(1\) .*radar.csv: holds no track of "
                             "two or more positions$")
        for start, rows, words in (("yesterday", rows, "start_time: is 'yesterday', expected 2026"),
                                   ("2021-05-04", [("A", 0, 47.45, 8.55, 440), ("A", 9, 47.45, 8.55, 440)],
                                    "start_time: is given, but no file of birds")):
            self.refused(f".*{words}", rows, start_time=start)

    def test_the_shipped_example(self):
        out = self.home / "shipped"
        code, words, warned = run("sequence",
                                  pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
                                  / "Examples/sequence/radar.scenario.json", "-o", out, "--scans", "3")
        self.assertEqual(code or 0, 0, warned)
        self.assertRegex(words,
                         r"(?s)radar.csv: 10 tracks with 412 positions\n.*height is altitude_m.*\n  heights are above "
                         r"the sea\n.*  from 2026.* first scan at")
        self.assertEqual([line for line in words.split("\n") if line.startswith(" ") and len(line) > 120], [])
        self.assertRegex(warned, r"left out: rows without a height \(1\)")
        self.assertRegex(warned, "1 of [0-9]+ birds never come within the lidar's range gate of 4000 m")
        self.assertGreater(sum(row["status"] == "seen" for row in rows_of(out / "sequences/00/truth.csv")), 8)

    def test_wrong_keys(self):
        rows = [*self.track("A", 100, 150)]
        self.refused(r"birds\[0\]: file_name is missing", rows, birds=[{"pattern": "File"}])
        for group, words in (
                ({"height_reference": "msl"}, "height_reference"), ({"geoid_undulation": 470}, "geoid_undulation"),
                ({"columns": {"hight": "z"}}, "columns"), ({"height_ref": "sea"}, "height_ref"),
                ({"height_referense": "sea"}, "'height_referense' is not known; did you mean 'height_reference'"),
                ({"geoid_undulaton": 4}, "did you mean 'geoid_undulation'"), ({"colums": {}}, "did you mean 'columns'"),
                ({"first_object_id": 7}, r"birds\[0\].first_object_id: is not to be given here"),
                ({"species": "heron"}, r"birds\[0\]: species 'heron' is not known: expected starling"),
                ({"pattern": "Circles", "species": "heron"}, r"birds\[0\]: .*[Ss]pecies is 'heron'"),
                ({"pattern": "Circles", "height_reference": "sea"},
                 r"birds\[0\].height_reference: is only for groups with the pattern File")):
            self.refused(f".*{words}", rows, group=group)
        with self.assertRaises(al.Error) as raised:
            al.Sequence(self.scenario(rows, group={"zzz": 1}))
        listed = str(raised.exception).partition("expected one of ")[2].split(", ")
        self.assertLessEqual({"pattern", "species", "file_name", "height_reference", "geoid_undulation", "columns",
                              "origin"}, {*listed})
        self.assertTrue({"first_object_id", "seed", "time_range"}.isdisjoint(listed))


class Covered(unittest.TestCase):
    def test_shares_are_those_of_simulated_scans(self):
        """Of the shipped table: the expected number of scans that detect each bird, and the scans that do."""
        examples = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples"
        out = emptied("covered")
        code, said, errors = run("coverage", examples / "coverage" / "hongqiao.coverage.json", "-o", out / "maps",
                                 "--tracks", examples / "sequence" / "radar.csv")
        self.assertEqual(code, 0, errors)
        self.assertIn("of 10 recorded birds", said)
        found = {row["track"]: row for row in rows_of(out / "maps" / "Search905" / "birds.csv")}
        al.Sequence(examples / "sequence" / "radar.scenario.json").write(out / "scans")
        seen = dict.fromkeys(found, 0)
        for row in rows_of(out / "scans" / "sequences" / "00" / "truth.csv"):
            seen[row["track"]] += row["status"] == "seen"
        self.assertEqual(sum(seen.values()) > 200, True)
        for track, row in found.items():
            expected, scans = float(row["detected_scans"]), int(row["scans"])
            error = np.sqrt(max(expected * (1 - expected / max(scans, 1)), 0.25))
            # a scan more or less at the ends of a track, and when the bird is next to a wall
            self.assertLess(abs(seen[track] - expected), 3 * error + 2, row)
        self.assertEqual(float(found["1104"]["detected_twice"]), 0.0)

