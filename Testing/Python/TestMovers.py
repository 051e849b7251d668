# SPDX-License-Identifier: BSD-3-Clause
"""Objects that move: each beam meets them where they are at its own timestamp. Bad poses are
named and the next good ones work. That what rests is a surface is TestMovedBeams' (kernel)."""
import re
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData

import avianlidar as al
import echotools
from avianlidar import Error, _cloud
from avianlidar._pipeline import update
from echotools import bird, copy_of
from faulttools import text_array
from helpertools import same

CLOCK = dict(azimuth_range=(0.0, 360.0), azimuth_step=1.0, rotation_rate=1.0, number_of_channels=4, elevation_step=1.0,
             half_beamwidth=1e-2)


def painted(points, triangles, name="plate", material="Wall"):
    """A surface with a material and a name."""
    scene = al.Scene((points, triangles), material=material, name=name)
    update(scene.tree)
    surface = vtkPolyData()
    surface.ShallowCopy(scene.tree.GetOutput())
    return surface


def plate(width, height, **words):
    """Across y, about the origin."""
    x, z = width / 2, height / 2
    return painted([(-x, 0, -z), (x, 0, -z), (x, 0, z), (-x, 0, z)], [(0, 1, 2), (0, 2, 3)], **words)


def with_fields(surface, **fields):
    """The surface with other field data; None removes one."""
    changed = copy_of(surface)
    for name, values in fields.items():
        changed.GetFieldData().RemoveArray(name)
        if values is not None:
            _cloud.add_array(changed.GetFieldData(), name,
                             [values] if isinstance(values, str) else np.array(values, dtype=float))
    return changed


class Movers(unittest.TestCase):
    def test_wings_flap(self):
        gull = bird()
        radius = 0.5 * np.sqrt(4 * 0.00813 * 0.95**0.666 / np.pi)
        flaps = dict(flap_hinge=[(-radius, 0, 0), (radius, 0, 0)], flap_axis=[(0, 1, 0), (0, -1, 0)],
                     flap_amplitude=np.radians([35, 35]))
        sensor = al.Sensor("Search905", channel_elevations=(3.0,), azimuth_step=0.5, azimuth_range=(90.0, 90.4))
        sensor.number_of_revolutions = 2
        flaps.update(flap_frequency=[0.125] * 2, flap_phase=[0, 0])  # up when the second revolution begins, at 2 s
        scans = []
        at = (200 * np.cos(np.radians(3)), 0.0, 200 * np.sin(np.radians(3)))
        for movers in (with_fields(al.mover(gull, [at]), **flaps), al.mover(bird(WingPhase=0.25), [at]),
                       al.mover(gull, [at])):
            scan = al.Scan(al.Scene(), sensor, noise=False, movers=movers)
            scan.algorithm.UpdateTimeStep(2.0)
            scans.append(al.Cloud(scan.algorithm.GetOutput(0))["photoelectrons"].sum())
        self.assertAlmostEqual(scans[0] / scans[1], 1, delta=1e-6)
        self.assertNotAlmostEqual(scans[0] / scans[2], 1, delta=0.1)

    def test_the_report_says_what_is_expected_of_each(self):
        # A gull at 500 m and one behind a wall; a third is above the beams, a fourth comes later.
        east, up = 500 * np.cos(np.radians(3)), 500 * np.sin(np.radians(3))
        wall = painted([(-30, 100, 0), (30, 100, 0), (30, 100, 60), (-30, 100, 60)], [(0, 1, 2), (0, 2, 3)])
        gulls = [al.mover(bird(ObjectId=k), [place], **more) for k, place, more in (
            (7, (east, 0, up), {}), (3, (0, east, up), {}), (9, (east, 0, 90), {}))]
        gulls.append(al.mover(bird(ObjectId=5), [(0, 0, 9)] * 2, times=[50, 60]))
        scan = al.Scan(al.Scene(wall), al.Sensor("Search905"), attenuation_coefficient=8.9e-5, movers=gulls)
        report = scan.mover_report
        self.assertEqual(list(report["object_id"]), [3, 7, 9])
        hidden, seen, above = range(3)
        np.testing.assert_allclose(report["distance_m"][seen], 500, rtol=1e-12)
        np.testing.assert_allclose(report["azimuth"][[hidden, seen]], [0, 9000], atol=1e-9)
        np.testing.assert_allclose(report["vertical_angle"][[hidden, seen]], 3, atol=1e-9)
        beams = report["number_of_beams"]
        self.assertTrue(beams[hidden] > 0 and beams[seen] > 0 and beams[above] == 0)
        electrons, probability = report["photoelectrons"], report["detection_probability"]
        self.assertTrue(electrons[hidden] == electrons[above] == probability[hidden] == probability[above] == 0)
        # Flying north it is seen from the side: 2193 electrons for 0.03 m2, shared by two range units.
        share = electrons[seen] / (2193.11 * report["effective_area"][seen] / 0.03)
        self.assertTrue(0.5 <= share <= 1.0, share)
        self.assertGreater(probability[seen], 0.1 if electrons[seen] < 500 else 0.3)
        self.assertEqual(report["number_of_echoes"][seen], (scan["object_id"] == 7).sum())
        self.assertGreater(report["effective_area"][hidden], 0.0)

    def test_the_report_is_made_for_those_who_read_it(self):
        gulls = [al.mover(bird(ObjectId=k), [(20 * k, 100, 0)]) for k in range(3)]
        scan = al.Scan(al.Scene(), al.Sensor("Search905", azimuth_step=2), movers=gulls)
        echoes = scan.echoes
        self.assertEqual((scan.report_movers, scan.algorithm.GetOutput(2).GetNumberOfPoints()), (False, 0))
        self.assertEqual(scan.mover_report.number_of_points, 3)
        self.assertTrue(same(scan.echoes, echoes))
        scan.attenuation_coefficient = 0.0  # from then on with the rest
        scan.update()
        self.assertEqual(scan.algorithm.GetOutput(2).GetNumberOfPoints(), 3)
        # The class makes it unless it is told not to: VTK's programs read any output after Update().
        self.assertTrue(type(scan.algorithm)().GetReportMovers())

    def test_ids_and_names(self):
        """Numbers of an existing object, of two objects, and numbers with a gap."""
        for ids, expected in (((1, 2), [3, 4]), ((10, 12), [10, 12])):
            gulls = [al.mover(bird(ObjectId=k), [(0, 30, 1)]) for k in ids]
            names = al.Scan(al.Scene(echotools.town(3, 3)), al.Sensor(**CLOCK),
                            movers=gulls).echoes.fields["object_names"]
            self.assertEqual(list(names[:3]), ["house 0", "house 1", "house 2"])
            self.assertEqual([k for k, name in enumerate(names) if name == "herring gull"], expected)

    def test_bad_movers_are_named_and_the_next_good_ones_work(self):
        good = with_fields(al.mover(bird(), [(0, 30, 1), (5, 30, 1)], times=[0, 9]), flap_hinge=[(0, 0, 0)],
                           flap_axis=[(0, 1, 0)], flap_amplitude=[0.1], flap_frequency=[3], flap_phase=[0])
        parts = good.GetCellData().GetArray("part")
        for k in range(parts.GetNumberOfTuples()):
            parts.SetValue(k, min(1, parts.GetValue(k)))
        scan = al.Scan(al.Scene(echotools.town(3, 3)), al.Sensor(**CLOCK), movers=good)
        wanted = scan["energy"].copy()
        for words, fields in (("pose_position' is missing", dict(pose_position=None)),
                              ("pose_position' holds no numbers", dict(pose_position="here")),
                              ("pose_position' has 2 components", dict(pose_position=[(1, 2), (3, 4)])),
                              ("pose_time' has 3 values", dict(pose_time=[1, 2, 3])),
                              ("pose 1: its time is not later", dict(pose_time=[9, 0])),
                              ("flap_axis' has 0 values", dict(flap_axis=None))):
            with self.subTest(words):
                scan.movers = with_fields(good, **fields)
                with self.assertRaisesRegex(Error, "movers(.|\n)*" + re.escape(words)):
                    scan.update()
                self.assertEqual(scan.algorithm.GetOutput().GetNumberOfPoints(), 0)
                scan.movers = good
                np.testing.assert_array_equal(scan["energy"], wanted)
        scan.movers = wrong = with_fields(good)
        wrong.GetCellData().GetArray("part").SetValue(3, 2)
        with self.assertRaisesRegex(Error, "cell 3: cell array 'part' is neither 0 nor a row of 'flap_hinge'"):
            scan.update()
        wrong.GetCellData().RemoveArray("part")
        wrong.Modified()
        with self.assertRaisesRegex(Error, "cell array 'part' is missing, expected with 'flap_hinge'"):
            scan.update()

    def test_shapes_are_checked(self):
        """Turned or flat arrays are not rows; older versions read them in another order."""
        row = np.array([(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)])
        turn = np.array([(1.0, 0.0, 0.0, 0.0)] * 3)
        for kind, words, arguments in (
                (ValueError, r"positions have the shape \(3, 2\)", (row.T, [0, 1])),
                (ValueError, r"times have the shape \(1, 2\)", (row, [[0, 1]])),
                (ValueError, r"orientations have the shape \(4, 3\)", (np.ones((3, 3)), [0, 1, 2], turn.T)),
                (TypeError, "positions are of the type", ([("a", "b", "c")],)),
                (TypeError, "times are of the type", ([(0.0, 0.0, 0.0)], ["now"]))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                al.mover(bird(), *arguments)
        fields = al.mover(bird(), row, [0, 1], turn[:2]).GetFieldData()
        self.assertEqual([fields.GetArray(name).GetTuple(1)
                          for name in ("pose_position", "pose_time", "pose_orientation")],
                         [(4.0, 5.0, 6.0), (1.0,), (1.0, 0.0, 0.0, 0.0)])

    def test_the_report_has_both_ends_of_the_revolution(self):
        """What the last column and the first meet is there twice, at two places; elsewhere it is within some
        columns."""
        seam = al.mover(plate(2.0, 4.0), [(0, 50, 0), (0, 70, 0)], times=[0, 1])
        side = al.mover(plate(2.0, 4.0), [(50, 0, 0), (50, 20, 0)], times=[0, 1],
                        orientations=[(np.sqrt(0.5), 0, 0, np.sqrt(0.5))] * 2)
        report = al.Scan(al.Scene(), al.Sensor(**CLOCK), movers=[seam, side], noise=False).mover_report
        first, last = np.array(report["first_timestamp"]), np.array(report["last_timestamp"])
        at_seam, aside = np.argsort(np.abs(np.array(report.points)[:, 0]))
        np.testing.assert_allclose([first[at_seam], last[at_seam]], [0.0, 1e6 * 359 / 360], atol=1e6 * 0.5 / 360)
        self.assertTrue(first[aside] <= report["timestamp"][aside] <= last[aside] < first[aside] + 1e6 * 8 / 360)
        for when, time in (("first", first), ("last", last)):
            places = np.array(report[when + "_position"])
            np.testing.assert_allclose(places[at_seam], (0, 50 + 20e-6 * time[at_seam], 0), atol=1e-9)
            np.testing.assert_allclose(places[aside], (50, 20e-6 * time[aside], 0), atol=1e-9)

    def test_edits_in_place_are_seen(self):
        for several in (False, True):
            one = al.mover(bird(), [(0, 100, 3)])
            scan = al.Scan(al.Scene(), al.Sensor(**CLOCK), movers=[one] if several else one)
            self.assertEqual(scan.mover_report.points[0][1], 100)
            one.GetFieldData().GetArray("pose_position").SetTuple3(0, 0, 200, 3)
            one.GetFieldData().GetArray("pose_position").Modified()
            one.Modified()
            self.assertEqual(scan.mover_report.points[0][1], 200)

    def test_beams_need_timestamps(self):
        scan = al.Scan(al.Scene(echotools.town(3, 3)), al.Sensor(**CLOCK), movers=al.mover(bird(), [(0, 30, 1)]))
        beams = vtkPolyData()
        beams.ShallowCopy(scan.sensor.beams.data)
        beams.GetPointData().RemoveArray("timestamp")
        scan.algorithm.SetInputData(0, beams)
        with self.assertRaisesRegex(Error, "point array 'timestamp' is missing"):
            scan.update()
        scan.movers = None
        self.assertGreater(scan.echoes.number_of_points, 0)

    def test_legal_and_empty(self):
        for movers in ([], [al.mover(vtkPolyData(), [(0, 0, 0)])], vtkPolyData(), [vtkPolyData()]):
            scan = al.Scan(al.Scene(echotools.town(3, 3)), al.Sensor(**CLOCK), movers=movers)
            self.assertGreater(scan.echoes.number_of_points, 0)

    def test_an_array_block_name_is_the_users_own(self):
        """It renames nothing, and an empty one is not read."""
        named = vtkMultiBlockDataSet()
        named.SetBlock(0, al.mover(bird(), [(0, 30, 1)]))
        named.GetMetaData(0).Set(vtkMultiBlockDataSet.NAME(), "visitor")
        named.GetBlock(0).GetFieldData().RemoveArray("object_names")
        for array in (None, text_array(1, "other"), text_array(0), numpy_to_vtk(np.array([7.0]), deep=True)):
            named.GetBlock(0).GetFieldData().RemoveArray("block_name")
            if array:
                array.SetName("block_name")
                named.GetBlock(0).GetFieldData().AddArray(array)
            echoes = al.Scan(al.Scene(echotools.town(3, 3)), al.Sensor(**CLOCK), movers=named).echoes
            self.assertEqual(list(echoes.fields["object_names"]), ["house 0", "house 1", "house 2", "visitor"])
