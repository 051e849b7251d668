# SPDX-License-Identifier: BSD-3-Clause
"""Files of the helpers: everything comes back, faults leave nothing, unknown suffixes are told. Pictures have the
numbers."""
import csv
import errno
import os
import signal
import stat
import unittest
from unittest import mock

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData

import avianlidar as al
from avianlidar import _disk
from cloudtools import add_array, add_field, cloud
from echotools import InFolder, box, copy_of
from helpertools import WALL, same, warned


class Files(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.scan = al.Scan(al.Scene(WALL, name="wall"), al.Sensor(azimuth_step=2))

    def test_vtp(self):
        file = self.folder / "echoes.vtp"
        self.scan.save(file)
        again, echoes = al.load_cloud(file), self.scan.echoes
        self.assertTrue(same(again, echoes))
        self.assertEqual(again.units, echoes.units)
        self.assertEqual(again.fields["object_names"], ["wall"])
        self.assertIn(b'format="binary"', file.read_bytes())
        al.save(self.scan.algorithm.GetOutput(), str(file))  # plain VTK data, a name as text, over a file
        self.assertTrue(same(al.load_cloud(file), echoes))
        mask = os.umask(0)
        os.umask(mask)
        self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o666 & ~mask)
        self.assertEqual(os.listdir(self.folder), ["echoes.vtp"])

    def test_csv(self):
        """Columns have names with units, quoted where they have to be."""
        echoes, data = self.scan.echoes, copy_of(self.scan.echoes.data)
        odd = ["a, b", "two\nlines", 'a "word"', "return\r"]
        for name in odd:
            add_array(data, name, np.arange(data.GetNumberOfPoints()), "m")
        file = self.folder / "echoes.csv"
        al.save(data, file)
        with open(file, encoding="utf-8", newline="") as stream:
            header, *rows = csv.reader(stream)
        self.assertEqual(header[:4], ["x [m]", "y [m]", "z [m]", "energy [J]"])
        self.assertEqual([name.split(" [")[0] for name in header[-len(odd):]], odd)
        table = np.array(rows, dtype=float)
        np.testing.assert_allclose(table[:, :3], echoes.points, rtol=1e-14)
        for column, name in enumerate(header[3:-len(odd)], 3):
            np.testing.assert_allclose(table[:, column], echoes[name.split(" [")[0]], rtol=1e-14, err_msg=name)
        al.save(self.scan.sensor.beams, file)
        self.assertIn("direction_2", file.read_text("utf-8").splitlines()[0])
        # Numbers come back with 15 digits, units (but for pure numbers), colours as bytes, and whole numbers as such.
        echoes = echoes.annotated()
        al.save(echoes, file)
        found = al.load_cloud(file)
        self.assertEqual((list(found), found.fields), (list(echoes), {}))
        for name, values in (("points", echoes.points), *echoes.items()):
            again = found.points if name == "points" else found[name]
            np.testing.assert_allclose(again, values, rtol=1e-14, err_msg=name)
            self.assertEqual(again.dtype.kind == "f", not (values == np.round(values)).all(), name)
        self.assertEqual(found["rgb"].dtype, np.uint8)
        self.assertEqual(found.units, {name: unit * (unit != "1") for name, unit in echoes.units.items()})

    def test_tables_of_other_programs(self):
        """First lines of ParaView, VeloView, CloudCompare, LAStools and spreadsheets; HELIOS++ and .xyz without one."""
        helios = "1.5 -2 3 0.25 0.0 1 2 7 12 6 300000.5"
        bom = b"\xef\xbb\xbf"
        # Comments and other lines above the names, names in comments, separators at the ends of lines.
        for suffix, text, arrays in (
                (".csv", "Points:0,Points:1,Points:2,energy\n1.5,-2,3,4\n", {"energy": 4}),
                (".csv", '"Point ID","Points_0","Points_1","Points_2","Points_Magnitude"\n0,1.5,-2,3,4\n',
                 {"Point ID": 0, "Points_Magnitude": 4}),
                (".csv", '"intensity","Points_m_XYZ:0","Points_m_XYZ:1","Points_m_XYZ:2"\n7,1.5,-2,3\n',
                 {"intensity": 7}),
                (".csv", "Normals:0,Normals:1,Normals:2,Points:0,Points:1,Points:2\n0,0,1,1.5,-2,3\n",
                 {"Normals": [0, 0, 1]}), (".csv", bom + b"X (m);Y (m);Z (m);i\r\n1,5;-2;3;0,25\r\n", {"i": 0.25}),
                (".csv", '\ufeffx,y [m],z,"a, b [1/s]",n_0,n_1,m_0\r\n1.5,-2,"3",-1e3,1,2.5,7\r\n',
                 {"a, b": -1000, "n": [1, 2.5], "m_0": 7}),
                (".csv", "sep=;\nx;y;z\n1,5;-2;3\n", {}), (".csv", "x\ty\tz\n1.5\t-2\t3\n", {}),
                (".xyz", "1.5  -2\t3\n", {}), (".xyz", "1.5,-2,3,8\n", {"column_4": 8}),
                (".xyz", "//X Y Z c\n1.5 -2 3 8\n", {"c": 8}),
                (".csv", "# made by hand, 2026\n\n# more\nx,y,z,i\n1.5,-2,3,4\n# end\n", {"i": 4}),
                (".csv", '"# a ""b"", c",,,\n,,,\nx,y,z,i\n1.5,-2,3,4\n,,,\n', {"i": 4}),
                (".csv", "Survey: hangar\nDate;2026-11-29\nx;y;z;i;\n1,5;-2;3;4;\n", {"i": 4}),
                (".csv", "x,y,z\n1.5,-2,3,\n", {}), (".csv", "# x,y,z,i\n1.5,-2,3,4\n", {"i": 4}),
                (".csv", "# x y z\n1.5,-2,3\n", {}), (".csv", "x y z\n1.5 -2 3\n", {}),
                (".csv", "sep=;\n# c\nx;y;z\n1,5;-2;3\n", {}), (".csv", ",x,y,z\n7,1.5,-2,3\n", {"column_1": 7}),
                (".csv", "x\ty\tz\t\n1.5\t-2\t3\t\n", {}), (".csv", "//X,Y,Z,R\n1.5,-2,3,4\n", {"R": 4}),
                (".xyz", "\n1.5 -2 3\n", {}), (".xyz", "# x y z\n1.5 -2 3\n", {}),
                (".xyz", "#x y z i\n1.5 -2 3 4\n", {"i": 4}),
                (".xyz", "# a cloud\n\n# x, y, z\n1.5 -2 3 8\n", {"column_4": 8}),
                (".xyz", "# the columns x y z\n1.5 -2 3\n", {}), (".xyz", "% y x z\n-2,1.5,3 # first\n", {}),
                (".xyz", "x y z\n1.5 -2 3\n", {}),
                (".xyz", helios, {"intensity": 0.25, "echo_width": 0, "return_number": 1, "number_of_returns": 2,
                                  "fullwave_index": 7, "hit_object_id": 12, "classification": 6,
                                  "gps_time": 300000.5})):
            with self.subTest(text):
                file = self.folder / f"table{suffix}"
                file.write_bytes(text if isinstance(text, bytes) else text.encode())
                cloud = al.load_cloud(file)
                self.assertEqual(cloud.points.tolist(), [[1.5, -2, 3]])
                self.assertEqual({name: values[0].tolist() for name, values in cloud.items()}, arrays)
        for suffix, text, words in (
                (".xyz", "\n\n3\nwater\nO 0 0 0\n", "one word, as files of molecules"),
                (".csv", "# only\n", "no column x"), (".csv", "# the columns x y z\n1,2,3\n", "rows have 3 cells"),
                (".csv", "a title\n1,2,3\n", "no column x"), (".csv", "x,y,z\n1,2,3,9\n4,5,6,\n", "rows have 4 cells"),
                (".xyz", "3\nwater\nO 0 0 0\n", "one word, as files of molecules"), (".xyz", "1 2\n", "no column z"),
                (".csv", "x;y;z\n1.234,5;2;3\n", "points and commas"),
                (".csv", "X (mm),Y (mm),Z (mm)\n1,2,3\n", "no column x in metres"),
                (".xyz", "1 2 3\n1 2\n", "columns"), (".csv", "", "no column x"), (".csv", "x,y,z\n1,2\n", "2 cells"),
                (".csv", "x,y,z,x\n1,2,3,4\n", "'x' is there twice"), (".csv", "x,y,z\n1,2,word\n", "word"),
                (".csv", b"x,y,z,\xe4\n1,2,3,4\n", "decode")):
            with self.subTest(text):
                file = self.folder / f"table{suffix}"
                file.write_bytes(text if isinstance(text, bytes) else text.encode())
                with self.assertRaisesRegex(ValueError, f"table{suffix}: is not a cloud .*{words}"):
                    al.load_cloud(file)
        for suffix, text in ((".csv", "x,y,z,i\n1,2,nan,5\n1,2,3,6\n1,1e400,2,7\n"),
                             (".xyz", "1 2 inf 5\n1 2 3 6\n-inf 2 2 7\n")):
            file = self.folder / f"table{suffix}"
            file.write_text(text, "ascii")
            with self.assertWarnsRegex(RuntimeWarning,
                                       f"{file}: 2 points whose coordinates are not finite are left out"):
                cloud = al.load_cloud(file)
            self.assertEqual((cloud.points.tolist(), *cloud.values())[::-1], ([6], [[1, 2, 3]]))
        file = self.folder / "gaps.csv"
        file.write_text("x,y,z,i,j\n1,2,3,,5\n4,5,6,7,\n7,8,,9,10\n", "ascii")
        cloud, said = warned(lambda: al.load_cloud(file))
        self.assertEqual(said, [f"{file}: 2 empty cells are read as NaN",
                                f"{file}: 1 points whose coordinates are not finite are left out"])
        np.testing.assert_array_equal(np.column_stack([cloud.points, cloud["i"], cloud["j"]]),
                                      [(1, 2, 3, np.nan, 5), (4, 5, 6, 7, np.nan)])

    def test_no_points_at_all(self):
        """vtkPolyData as it is made, without an object for points; and no echoes."""
        for data in (vtkPolyData(), al.Cloud(vtkPolyData()), al.Scan(al.Scene(), al.Sensor(azimuth_step=10))):
            for suffix in (".vtp", ".csv"):
                al.save(data, self.folder / f"none{suffix}")
            self.assertEqual(al.load_cloud(self.folder / "none.vtp").number_of_points, 0)
            self.assertEqual(len((self.folder / "none.csv").read_text("utf-8").splitlines()), 1)

    def test_faults(self):
        cases = ((ValueError, r"'echoes.doc' by its suffix, expected one of \.vtp, \.csv",
                  lambda: self.scan.save("echoes.doc")),
                 (ValueError, r"expected one of \.vtp", lambda: al.load_cloud("echoes.doc")),
                 (FileNotFoundError, "none", lambda: self.scan.save(self.folder / "none" / "echoes.vtp")),
                 (FileNotFoundError, "no such file: none.vtp", lambda: al.load_cloud("none.vtp")),
                 (ValueError, r"expected one of \.vtp, \.csv, \.las", lambda: al.load_cloud("echoes.geojson")),
                 (TypeError, "property 'no_such_thing'", lambda: self.scan.save("echoes.pcd", no_such_thing=1)),
                 (TypeError, "has no properties: precision", lambda: self.scan.save("echoes.csv", precision=3)))
        for kind, words, call in cases:
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        lying = self.folder / "lying.vtp"
        lying.write_text('<VTKFile type="PolyData" version="1.0"><PolyData><Piece NumberOfPoints="4000000000" '
                         'NumberOfPolys="0"/></PolyData></VTKFile>')
        with self.assertRaisesRegex(ValueError,
                                    "lying.vtp: says that it has 4000000000 points, but has only [0-9]+ bytes"):
            al.load_cloud(lying)
        damaged = self.folder / "damaged.vtp"
        self.scan.save(damaged)
        whole = damaged.read_bytes()
        for content in (b"<VTKFile", whole[:-99], whole.replace(b"NumberOfPoints=\"", b"NumberOfPoints=\"9")):
            damaged.write_bytes(content)
            with self.assertRaisesRegex(al.Error, r"\A.*damaged\.vtp: [^\n]*\Z"):
                al.load_cloud(damaged)

    def test_file_systems_without_locks(self):
        """Files are written; parts of others, which nobody can tell from abandoned ones there, stay."""
        file, part = self.folder / "echoes.csv", self.folder / "echoes.csv.avianpart0"
        for number in (errno.ENOLCK, errno.EOPNOTSUPP):
            with mock.patch.object(_disk.fcntl, "flock", side_effect=OSError(number, os.strerror(number))):
                self.scan.save(file)
                self.assertEqual(os.listdir(self.folder), ["echoes.csv"])
                part.write_text("others'", "utf-8")
                self.scan.save(file)
                self.assertEqual(part.read_text("utf-8"), "others'")
            os.remove(part)
            os.remove(file)

    def test_an_interrupt_while_a_folder_is_taken(self):
        hold = _disk._hold

        def interrupted(*given):
            held = hold(*given)
            signal.raise_signal(signal.SIGINT)
            return held

        with mock.patch.object(_disk, "_hold", interrupted), self.assertRaises(KeyboardInterrupt), \
                _disk.only_run("taken"):
            self.fail("it goes on")
        self.assertFalse(os.path.exists("taken"))


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        import matplotlib
        matplotlib.use("Agg")

    def setUp(self):
        self.scan = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=5))
        self.addCleanup(__import__("matplotlib.pyplot").pyplot.close, "all")

    def drawn(self, array, scan=None):
        scan = scan or self.scan
        axes = scan.plot_range_image(array)
        return axes, axes.collections[0], axes.collections[0].get_array().reshape(scan.range_image()["status"].shape)

    def test_the_numbers_are_drawn(self):
        image, echoes = self.scan.range_image(), self.scan.echoes
        there = image["echo"] >= 0
        self.assertTrue(np.array_equal(echoes["distance_m"][image["echo"][there]], image["distance_m"][there]))
        # of echoes where there are some, and of the report everywhere
        for array in {*echoes, "status", "nodes_visited"}:
            axes, mesh, drawn = self.drawn(array)
            values = image[array] if array in image else np.where(there, echoes[array][image["echo"]], np.nan)
            shown = there if array in echoes else np.ones_like(there)
            factor = 1e6 if array == "energy" else 1
            np.testing.assert_allclose(drawn[shown], factor * values[shown], rtol=1e-12, err_msg=array)
            self.assertTrue(np.array_equal(~np.ma.getmaskarray(drawn), shown), array)
            __import__("matplotlib.pyplot").pyplot.close(axes.figure)
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("azimuth (deg from north)", "elevation (deg)"))
        self.assertEqual(self.drawn("energy")[1].get_clim(), (2.0, 62.5))
        axes, mesh, _ = self.drawn("status")
        words = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertEqual(words, ["echo", "no surface", "below the lower limit", "saturated", "outside the gate"])
        self.assertEqual(mesh.to_rgba(3)[:3], (0.84, 0.37, 0))
        with self.assertRaisesRegex(KeyError, "'hue' is not known; .*energy"):
            self.scan.plot_range_image("hue")

    def test_what_returns_fills_the_picture_and_has_names(self):
        """A wall with a name and a bird before it: limits of the axes, the name above the wall, a circle on the bird."""
        blocks = vtkMultiBlockDataSet()
        for number, (block, word) in enumerate(((box((40, 0, 0.5), (1, 10, 0.5), "Wall", "Old wall"), "structure"),
                                                (box((20, 5, 0.5), (0.3, 0.3, 0.3), "Plumage", "gull"), "bird"))):
            add_field(block, "object_classes", [word])
            blocks.SetBlock(number, block)
        scan = al.Scan(al.Scene(blocks), al.Sensor(azimuth_step=1))
        image = scan.range_image()
        there, axes = image["echo"] >= 0, scan.plot_range_image()
        for limits, ends, values in ((axes.get_xlim(), there.any(axis=0), image["column_azimuths"]),
                                     (axes.get_ylim(), there.any(axis=1), image["row_elevations"])):
            inside = values[ends]
            self.assertTrue(limits[0] <= inside.min() and inside.max() <= limits[1])
            self.assertLess(limits[1] - limits[0], 0.8 * np.ptp(values))
        (name,), (circles,) = axes.texts, axes.lines
        rows, columns = np.nonzero(image["object_id"] == scan.scene.objects.index("Old wall"))
        self.assertEqual((name.get_text(), name.xy[0]), ("Old wall", np.median(image["column_azimuths"][columns])))
        self.assertGreater(name.xy[1], image["row_elevations"][rows.max()])
        rows, columns = np.nonzero(image["object_id"] == scan.scene.objects.index("gull"))
        self.assertTrue(len(rows))
        np.testing.assert_array_equal(circles.get_xydata(), np.stack(
            [image["column_azimuths"][columns], image["row_elevations"][rows]], axis=1))
        self.assertEqual(len(scan.plot_range_image(names=False).texts), 0)

    def test_maps_and_their_units(self):
        echoes, axes = self.scan.echoes, self.scan.plot_map("incidence_angle")
        self.assertTrue(np.allclose(axes.collections[0].get_offsets(), echoes.points[:, :2]))
        self.assertTrue(np.allclose(axes.collections[0].get_array(), echoes["incidence_angle"]))
        self.assertEqual(axes.figure.axes[1].get_ylabel(), "incidence angle (deg)")
        self.assertEqual(echoes.plot_map().collections[0].get_clim(), (2.0, 62.5))
        weak = al.Scan(al.Scene(WALL), al.Sensor("Search905", azimuth_step=5))  # a prefix that fits
        self.assertEqual(weak.plot_map().figure.axes[1].get_ylabel(), "energy (pJ)")
        # Its limits are four decades apart: colours are by the logarithm, from the threshold to the largest energy.
        mesh, energy = weak.plot_range_image("energy").collections[0], weak.echoes["energy"]
        low = weak.echoes.fields["lower_energy_limit"]
        np.testing.assert_allclose(mesh.get_clim(), (1e12 * low, 1e12 * energy.max()))
        np.testing.assert_allclose(mesh.norm(1e12 * energy), np.log(energy / low) / np.log(energy.max() / low),
                                   atol=1e-6)

    def test_colours_and_tilted_sensors(self):
        colors = al.hue_colors()
        self.assertEqual((colors(0.0)[:3], colors(1.0)[:3]), ((0, 0, 1), (1, 0, 0)))
        axes, _, values = self.drawn("distance_m",
                                     al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2, orientation=(30, 5, 5))))
        self.assertIn("column", axes.get_xlabel())
        self.assertGreater(values.count(), 10)

    def test_no_object_has_no_colour(self):
        data = cloud([(0, 1, 0), (1, 1, 0)])
        add_array(data, "object_id", np.array([-1, 3], np.int32))
        self.assertEqual(al.Cloud(data).plot_map("object_id").collections[0].get_array().mask.tolist(), [True, False])
