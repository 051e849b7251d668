# SPDX-License-Identifier: BSD-3-Clause
"""The helpers give what the wrapped classes give: properties by name, surfaces of any kind, frames, range images."""
import doctest
import importlib
import os
import unittest
import warnings
from unittest import mock

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

import avianlidar as al
from avianlidar import reach, siting, vtkAvianLidar as wrapped
from cloudtools import cloud
from echotools import assert_same_bits, box as colored_box, copy_of, given, group, scan as plain_scan, town
from helpertools import WALL, box, same
from scenetools import SHIPPED


class Properties(unittest.TestCase):
    def test_every_property_by_both_names(self):
        for owner, cls in ((al.Sensor(), wrapped.vtkAvianLidarBeamSource),
                           (al.Scan(al.Scene()), wrapped.vtkAvianLidarEchoFilter)):
            own = {m for base in cls.__mro__ if base.__name__.startswith("vtkAvianLidar") for m in vars(base)}
            names = [m[3:] for m in own if m.startswith("Set") and hasattr(cls, "Get" + m[3:])]
            names = [n for n in names if n not in ("ChannelElevation", "NumberOfChannelElevations", "ErrorsAsData")]
            self.assertGreater(len(names), 18)
            self.assertEqual(len(owner.properties()), len(names) + isinstance(owner, al.Sensor))
            for name in names:
                with self.subTest(name):
                    key = "".join("_" + c.lower() if c.isupper() else c for c in name).lstrip("_")
                    value = getattr(owner, key)
                    self.assertEqual(owner.properties()[key], value)
                    owner.set(**{name: value})
                    self.assertEqual(getattr(owner, key), value)
                    changed = {bool: lambda v: not v, int: lambda v: v + 1, float: lambda v: v + 0.5,
                               tuple: lambda v: tuple(x + 1 for x in v)}.get(type(value))
                    if changed:
                        setattr(owner, key, changed(value))
                        self.assertEqual(getattr(owner.algorithm, "Get" + name)(), changed(value))

    def test_choices(self):
        scan = al.Scan(al.Scene(), return_mode="range units", Sampling="monte carlo", preset=2)
        self.assertEqual(scan.algorithm.GetReturnMode(), wrapped.vtkAvianLidarEchoFilter.RETURN_MODE_RANGE_UNITS)
        self.assertEqual((scan.return_mode, scan.sampling, scan.preset), ("RangeUnits", "MonteCarlo", "Standard"))
        scan.algorithm.SetReturnMode(77)  # no word for it: the number itself
        self.assertEqual(scan.return_mode, 77)

    def test_a_read_runs_nothing(self):
        """It does not listen to what is up to date: VTK keeps observers for ever, and each slows the next read."""
        scene, sensor = al.Scene(WALL), al.Sensor(azimuth_step=10)

        def read():
            return [scene.objects, scene.materials, scene.number_of_triangles, scene.bounds,
                    sensor.beams.number_of_points]
        known = read()
        with mock.patch("avianlidar._scene.update") as one, mock.patch("avianlidar._sensor.update") as other:
            self.assertEqual(read(), known)
            self.assertFalse(one.called or other.called)
        scene.tree.GetOutput().ReleaseData()
        sensor.algorithm.GetOutput().ReleaseData()
        self.assertEqual(read(), known)
        scene.add(WALL, name="another")
        sensor.number_of_channels += 1
        for now, before in zip(read()[::2], known[::2]):
            self.assertNotEqual(now, before)

    def test_tables_are_set_as_a_whole_or_not_at_all(self):
        sensor = al.Sensor(channel_elevations=np.array([3.0, -1.0, 2.0]), position=np.array([1, 2, 3]),
                           azimuth_step=np.float32(5))
        self.assertEqual((sensor.channel_elevations, sensor.position), ((3, -1, 2), (1, 2, 3)))
        self.assertEqual(sensor.beams["vertical_angle"][:3].tolist(), [3, -1, 2])
        self.assertEqual(sensor.beams.number_of_points, 3 * 72)
        for value in ([1, "a"], [1, None], "12", 5, [1, (2, 3)], np.array(["1", "2"])):
            with self.subTest(value), self.assertRaises(TypeError):
                sensor.channel_elevations = value
            self.assertEqual(sensor.channel_elevations, (3, -1, 2))
        for value in ((2, 0.5), range(3), []):
            sensor.channel_elevations = value
            self.assertEqual(sensor.channel_elevations, tuple(value))

    def test_unknown_names_say_the_nearest(self):
        scan = al.Scan(al.Scene())
        before = scan.properties()
        for kind, words, call in (
                (TypeError, "pulse_energy", lambda: al.Sensor(PulseEnrgy=1)),
                (TypeError, "rays_per_beam", lambda: scan.set(seed=9, ray_per_beam=1)),
                (AttributeError, "return_mode", lambda: setattr(scan, "return_moed", "First")),
                (AttributeError, "rays_per_beam", lambda: scan.ray_per_beam),
                (ValueError, "'Airport16'", lambda: al.Sensor("Airprot16")),
                (ValueError, "'Strongest'", lambda: scan.set(return_mode="Strongst")),
                (ValueError, "kd, ks, kp", lambda: al.Scene(WALL, material="custom")),
                (TypeError, "rays_per_beam is 'many'", lambda: scan.set(rays_per_beam="many")),
                (TypeError, "position is 3", lambda: al.Sensor(position=3))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        self.assertEqual(scan.properties(), before)  # nothing is set if one name is unknown

    def test_switches(self):
        """A text is not a switch: "off" would turn it on."""
        scan = al.Scan(al.Scene(), noise=False)
        for value in ("off", None, 2):
            for call in (lambda v=value: scan.set(Noise=v),
                         lambda v=value: al.save(al.mesh(*WALL), "x.bin", write_labels=v)):
                with self.assertRaisesRegex(TypeError, "(noise|write_labels) is "):
                    call()
            self.assertIs(scan.noise, False)
        for scan.noise in (True, 1, np.bool_(True)):
            self.assertIs(scan.noise, True)
        self.assertFalse(os.path.exists("x.bin"))


class Scans(unittest.TestCase):
    def test_numbers_of_the_wrapped_classes(self):
        source = given(wrapped.vtkAvianLidarBeamSource(), AzimuthStep=4.0, Position=(1, 2, 3))
        echo = plain_scan(town(), source, RaysPerBeam=64, Seed=5)
        echo.Update()
        scan = al.Scan(al.Scene(town()), al.Sensor(azimuth_step=4, position=(1, 2, 3)), rays_per_beam=64, seed=5)
        for port, found in ((0, scan.echoes), (1, scan.report)):
            self.assertGreater(found.number_of_points, 20)
            # costs, which the shared tree may change
            assert_same_bits(echo.GetOutput(port), found.data, ("candidates", "nodes_visited"))
        self.assertEqual(scan["energy"].tobytes(), scan.echoes["energy"].tobytes())

    def test_units_and_fields(self):
        scan = al.Scan(al.Scene(WALL, material=(0.1, 0.2, 30), name="wall"), al.Sensor(azimuth_step=5))
        echoes = scan.echoes
        key = vtkDataArray.UNITS_LABEL()
        for name in echoes:
            information = scan.algorithm.GetOutput().GetPointData().GetArray(name).GetInformation()
            self.assertEqual(echoes.units[name], information.Get(key) or "")
        self.assertEqual((echoes.units["energy"], echoes.units["azimuth"]), ("J", "0.01 deg"))
        self.assertEqual(echoes.fields["object_names"], ["wall"])
        self.assertEqual((echoes.fields["pulse_energy"], echoes.field_units["pulse_energy"]), (3.6e-4, "J"))
        self.assertEqual(echoes.fields["position"].tolist(), [0, 0, 0])
        table = echoes.structured()
        self.assertEqual(table["energy"].tobytes(), echoes["energy"].tobytes())
        self.assertEqual(table["points"].shape, echoes.points.shape)

    def test_another_sensor_and_another_scene(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2))
        first = scan.echoes
        sensor, scene = al.Sensor(azimuth_step=3), al.Scene(box((-20, 80, -5), (20, 82, 15)))
        scan.sensor = sensor
        self.assertEqual(scan.report.number_of_points, 16 * 120)
        scan.scene = scene
        self.assertIs(scan.scene, scene)
        self.assertTrue(same(scan.echoes, al.Scan(scene, sensor).echoes))
        self.assertTrue(first == first and first != scan.echoes and len({first, scan.echoes}) == 2)
        scan.scene = WALL
        self.assertLess(scan["distance_m"].min(), 60)
        scene = al.load_scene(SHIPPED)  # which says where its lidar stands
        self.assertEqual(al.Scan(scene).sensor.position, scene.lidar_position)

    def test_range_image(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2))
        image = scan.range_image()
        self.assertEqual(image["distance_m"].shape, (16, 180))
        self.assertTrue(np.allclose(image["column_azimuths"], np.arange(0, 360, 2)))
        self.assertTrue(np.allclose(image["row_elevations"], 0.375 * np.arange(16)))
        column, row = np.divmod(np.unique(scan["beam_id"]), 16)  # which echo is TestRangeImage's (C++)
        self.assertEqual(set(zip(*np.nonzero(np.isfinite(image["distance_m"])))), set(zip(row, column)))

    def test_empty_scene(self):
        scan = al.Scan(al.Scene(), al.Sensor(azimuth_step=10))
        self.assertEqual((scan.echoes.points.shape, scan["energy"].shape), ((0, 3), (0,)))
        self.assertTrue(np.isnan(scan.range_image()["distance_m"]).all())

    def test_the_checksum_is_that_of_the_scene_with_its_materials(self):
        def of(kd, sensor="Search905"):
            scene = al.Scene()
            scene.add(al.mesh([(-9, 50, -9), (9, 50, -9), (9, 50, 9)], [(0, 1, 2)]),
                      material=np.array([(kd, 0.0, 1.0)]))
            return al.Scan(scene, sensor).echoes.fields["scene_checksum"]
        self.assertEqual(of(0.5), of(0.5, "Search1550"))
        self.assertNotEqual(of(0.5), of(0.4))

    def test_equal_limits_are_full_intensity(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor(lower_energy_limit=1e-6, upper_energy_limit=1e-6), noise=False)
        self.assertEqual(set(scan["intensity"].tolist()), {255.0})


class Surfaces(unittest.TestCase):
    def echoes(self, *args, **options):
        return al.Scan(al.Scene(*args, **options), al.Sensor(azimuth_step=2)).echoes

    def test_the_same_wall_from_everywhere(self):
        expected = self.echoes(WALL, material="Metal", name="wall")
        paint = wrapped.vtkAvianLidarMaterial()
        paint.SetInputData(al.mesh(*WALL))
        paint.SetMaterialToMetal()
        for surfaces in (al.mesh(*WALL), list(WALL), (WALL[0].tolist(), WALL[1].astype(np.uint8)), paint,
                         paint.GetOutputPort()):
            self.assertTrue(same(self.echoes(surfaces, material="Metal", name="wall"), expected), type(surfaces))
        self.assertTrue(same(self.echoes(*WALL, material="Metal", name="wall"), expected))
        cube = vtkCubeSource()
        cube.SetBounds(-20, 20, 50, 52, -5, 15)
        cube.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
        self.assertTrue(np.allclose(self.echoes(cube, material=(0.075, 0.634, 6803))["distance_m"],
                                    expected["distance_m"], rtol=1e-6))

    def test_arrays_are_copied(self):
        points, triangles = WALL[0].copy(), WALL[1].copy()
        scene = al.Scene((points, triangles))
        points += 1000
        triangles[:] = 0
        self.assertTrue(same(al.Scan(scene, al.Sensor(azimuth_step=2)).echoes, self.echoes(WALL)))

    def test_materials_and_names(self):
        scene = al.Scene()
        scene.add(WALL, material="Glass", name="pane")
        scene.add(box((100, 0, 0), (110, 10, 9)), material=(0.1, 0.2, 30), name="crate")
        scene.add(box((-110, 0, 0), (-100, 10, 9)))
        self.assertEqual((scene.objects[:2], len(scene.objects)), (["pane", "crate"], 3))
        self.assertEqual((scene.number_of_triangles, scene.bounds), (36, (-110, 110, 0, 52, -5, 15)))
        merged = scene.tree.GetOutput().GetCellData()
        self.assertEqual([merged.GetArray(k).GetValue(12) for k in ("kd", "ks", "kp")], [0.1, 0.2, 30])

    def test_adding_to_a_scene_changes_its_scans(self):
        scene = al.load_scene(SHIPPED)
        scan = al.Scan(scene)
        self.assertNotIn("mast", scan.echoes.fields["object_names"])
        scene.add(box((199, 299, 0), (201, 301, 30)), material="Metal", name="mast")
        after = scan.echoes
        hits = after["object_id"] == scene.objects.index("mast")
        self.assertGreater(hits.sum(), 5)
        self.assertGreater(after["distance_m"][hits].min(), 358)
        self.assertEqual(after.fields["geodetic_origin"].tolist(), list(scene.geodetic_origin))


class EditsInPlace(unittest.TestCase):
    """Surfaces that were given as VTK data are edited by NumPy; Modified() of anything in them gives a fresh look."""

    def test_edits_with_each_kind_of_modified(self):
        for material in (None, "Glass"):
            data = colored_box((0, 51, 5), (20, 1, 10), "Metal")
            whole = group(group(data))
            scene = al.Scene(whole, material=material)
            scan = al.Scan(scene, al.Sensor(azimuth_step=4))
            before = scan.echoes
            points, kd = data.GetPoints().GetData(), data.GetCellData().GetArray("kd")
            for array, told in ((points, whole), (points, whole.GetBlock(0)), (points, data.GetPoints()),
                                (points, points), (kd, kd)):
                values = vtk_to_numpy(array)
                values *= 1.1
                told.Modified()
                copy = copy_of(whole)
                fresh = al.Scan(al.Scene(copy, material=material), al.Sensor(azimuth_step=4)).echoes
                self.assertTrue(same(scan.echoes, fresh), told.GetClassName())
                self.assertEqual(same(fresh, before), array is kd and material is not None)
                before = fresh
                self.assertEqual(scene.bounds, al.Scene(copy).bounds)


class Frames(unittest.TestCase):
    def test_sensor_frame_has_the_angles_of_the_pattern(self):
        sensor = al.Sensor(azimuth_step=7, position=(3, -4, 5), orientation=(40, 12, -9))
        echoes = al.Scan(box((-60, -60, -60), (60, 60, 60)), sensor, return_mode="Strongest").echoes
        right, forward, up = echoes.coordinates("sensor").T
        column, channel = echoes["beam_id"] // 16, echoes["beam_id"] % 16
        self.assertGreater(len(column), 700)
        turn = np.degrees(np.arctan2(right, forward)) - 7 * column
        self.assertLess(abs((turn + 180) % 360 - 180).max(), 1e-9)
        self.assertLess(abs(np.degrees(np.arcsin(up / echoes["distance_m"])) - 0.375 * channel).max(), 1e-9)


class Refused(unittest.TestCase):
    def test_values_are_named(self):
        cover, sensor = al.Coverage(al.Scene(), al.Sensor()), al.Sensor(azimuth_step=5)
        runway, points = siting.Runway("a", (0, 0), (1000, 0), 45.0), al.Cloud(cloud([(1, 2, 3)]))
        for kind, words, call in (
                (KeyError, "array 'x' is not known; expected one of .*status", lambda: cover["x"]),
                (ValueError, "birds is 1, expected at least 2", lambda: reach.within_beams(sensor, birds=1)),
                (ValueError, "count is 1, expected at least 2", lambda: siting.strips_and_approaches([runway], 1)),
                (ValueError, "count is 9, expected at least 2", lambda: siting.strips_and_approaches([], 9)),
                (ValueError, r"heights are \(5, 1\)", lambda: siting.strips_and_approaches([runway], heights=(5, 1))),
                (ValueError, "weights have the shape", lambda: siting.values_of(np.zeros((1, 2, 3)), np.zeros((3, 2)))),
                (TypeError, "surfaces are vtkPolyData or a vtkMultiBlockDataSet", lambda: al.Scene(vtkImageData())),
                (ValueError, "'sensor' needs field data", lambda: points.coordinates("sensor")),
                (ValueError, "geodetic_origin", lambda: points.coordinates("geodetic")),
                (ValueError, "enu, sensor, geodetic, utm, ecef", lambda: points.coordinates("polar")),
                (ValueError, "cannot draw 'direction', which has 3 components",
                 lambda: sensor.beams.plot_map("direction"))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        self.assertEqual(len(cover.height_limits), cover.algorithm.GetNumberOfHeightLimits())


class Docstrings(unittest.TestCase):
    def test_examples_run(self):
        names, tried = {name: getattr(al, name) for name in al.__all__}, 0
        for module in ("_cloud", "_files", "_pipeline", "_plot", "_properties", "_scan", "_scene", "_sensor",
                       "_writers"):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                result = doctest.testmod(importlib.import_module("avianlidar." + module), extraglobs=names)
            self.assertEqual(result.failed, 0, module)
            tried += result.attempted
        self.assertGreater(tried, 15)
