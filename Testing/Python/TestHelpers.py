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
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkMultiBlockDataSet
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

import avianlidar as al
from avianlidar import _properties, reach, siting, vtkAvianLidar as wrapped
from cloudtools import add_array, cloud
from echotools import arrays, scan as plain_scan, town
from helpertools import WALL, box, same

SCENE = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")


# Properties of the sensor without a unit.
COUNTS = {"number_of_channels", "beam_outline", "beam_profile", "gaussian_truncation", "threshold_law", "number_of_revolutions", "steps_per_revolution", "receiver_model",
          "receiver_efficiency", "excess_noise_factor", "false_alarms_per_scan", "range_noise_exponent", "motion_seed"}


class Properties(unittest.TestCase):
    def test_every_property_by_both_names(self):
        for owner, cls in ((al.Sensor(), wrapped.vtkAvianLidarBeamSource), (al.Scan(al.Scene()),
                                                                          wrapped.vtkAvianLidarEchoFilter)):
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

    def test_documented_with_units(self):
        for cls, unitless in ((al.Sensor, COUNTS), (al.Scan, None)):
            for key, value in vars(cls).items():
                if isinstance(value, property):
                    with self.subTest(f"{cls.__name__}.{key}"):
                        self.assertTrue(value.__doc__)
                        if unitless is not None and key not in unitless and value.fset:
                            self.assertRegex(value.__doc__, "metres|degrees|radians|seconds|hertz|joules|square|electrons|decibels")

    def test_presets_and_choices(self):
        self.assertEqual(al.Sensor.presets(), ("Airport16", "Airport32", "Automotive16", "Avia", "CorridorC16", "HDL32E",
                                               "Helios16P", "Mid360", "Mid40", "OS0_128", "OS1_64", "OS2_128", "Pandar40P",
                                               "PandarXT32", "Search1550", "Search905", "VLP16", "VLP32C"))
        for preset in al.Sensor.presets():
            source = wrapped.vtkAvianLidarBeamSource()
            getattr(source, "SetPresetTo" + preset)()
            sensor = al.Sensor(preset.lower())
            self.assertEqual(sensor.range_gate, source.GetRangeGate())
            self.assertEqual(sensor.number_of_channels, source.GetNumberOfChannels())
        scan = al.Scan(al.Scene(), return_mode="range units", Sampling="monte carlo", preset=2)
        self.assertEqual(scan.algorithm.GetReturnMode(), wrapped.vtkAvianLidarEchoFilter.RETURN_MODE_RANGE_UNITS)
        self.assertEqual((scan.return_mode, scan.sampling, scan.preset), ("RangeUnits", "MonteCarlo", "Standard"))
        scan.algorithm.SetReturnMode(77)  # no word for it: the number itself
        self.assertEqual(scan.return_mode, 77)

    def test_a_read_makes_no_filter(self):
        """Nor does it listen to one that is up to date: VTK keeps observers for ever, and each slows the next read."""
        class Counted(wrapped.vtkAvianLidarEchoFilter):
            made = 0

            def __init__(self):
                Counted.made += 1

        one, made = Counted(), []
        for _ in range(3):
            for name in _properties.property_names(wrapped.vtkAvianLidarEchoFilter).values():
                _properties.get_property(one, name)
            made.append(Counted.made)
        self.assertGreater(made[0], 1)  # once, for the words of choices
        self.assertEqual(made, made[:1] * 3)

        scene, sensor = al.Scene(WALL), al.Sensor()

        def read():
            return scene.objects, scene.materials, scene.number_of_triangles, scene.bounds, sensor.beams.number_of_points
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

    def test_table_of_elevations_and_numpy_values(self):
        sensor = al.Sensor(channel_elevations=np.array([3.0, -1.0, 2.0]), position=np.array([1, 2, 3]),
                           number_of_channels=np.int64(5), azimuth_step=np.float32(5))
        self.assertEqual(sensor.channel_elevations, (3, -1, 2))
        self.assertEqual(sensor.position, (1, 2, 3))
        self.assertEqual(sensor.beams.number_of_points, 3 * 72)
        self.assertTrue(np.allclose(sensor.beams["vertical_angle"][:3], [3, -1, 2]))

    def test_unknown_names_say_the_nearest(self):
        scan = al.Scan(al.Scene())
        before = scan.properties()
        cases = (
            (TypeError, "pulse_energy", lambda: al.Sensor(pulse_enrgy=1)),
            (TypeError, "pulse_energy", lambda: al.Sensor(PulseEnrgy=1)),
            (TypeError, "rays_per_beam", lambda: scan.set(seed=9, ray_per_beam=1)),
            (TypeError, "known are air_backscatter, .*rays_per_beam", lambda: scan.set(colour=1)),
            (AttributeError, "return_mode", lambda: setattr(scan, "return_moed", "First")),
            (AttributeError, "rays_per_beam", lambda: scan.ray_per_beam),
            (ValueError, "'Airport16'", lambda: al.Sensor("Airprot16")),
            (ValueError, "'Strongest'", lambda: scan.set(return_mode="Strongst")),
            (ValueError, "'Glass'", lambda: al.Scene(WALL, material="Glas")),
            (ValueError, "kd, ks, kp", lambda: al.Scene(WALL, material="custom")),
            (TypeError, "rays_per_beam is 'many', expected an integer", lambda: scan.set(rays_per_beam="many")),
            (TypeError, "range_gate is 'x', expected a number", lambda: al.Sensor(range_gate="x")),
            (TypeError, "position is 3, expected 3 numbers", lambda: al.Sensor(position=3)),
            (TypeError, "channel_elevations are 3, expected a list of numbers", lambda: al.Sensor(channel_elevations=3)),
        )
        for kind, words, call in cases:
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        self.assertEqual(scan.properties(), before)  # nothing is set if one name is unknown


    def test_switches(self):
        """A text is no switch: "off" would turn it on."""
        scan = al.Scan(al.Scene(), noise=False)
        for value in ("off", "False", "", None, 2, 0.5, (), float("nan")):
            for call in (lambda v=value: scan.set(Noise=v), lambda v=value: setattr(scan, "noise", v),
                         lambda v=value: al.Scan(al.Scene(), noise=v),
                         lambda v=value: al.save(al.mesh(*WALL), "x.bin", write_labels=v)):
                with self.assertRaisesRegex(TypeError, "(noise|write_labels) is .*, expected True or False"):
                    call()
            self.assertIs(scan.noise, False)
        for value in (True, 1, np.bool_(True), 1.0, np.array(True)):
            scan.noise = False
            scan.noise = value
            self.assertIs(scan.noise, True)
        self.assertFalse(os.path.exists("x.bin"))

    def test_a_table_is_set_as_a_whole_or_not_at_all(self):
        sensor = al.Sensor(channel_elevations=(3, -1))
        for value in ([1, "a"], [1, None], "12", 5, [1, (2, 3)], np.array(["1", "2"])):
            with self.subTest(value), self.assertRaises(TypeError):
                sensor.channel_elevations = value
            self.assertEqual(sensor.channel_elevations, (3, -1))
        for value in ((2, 0.5), range(3), np.arange(4), []):
            sensor.channel_elevations = value
            self.assertEqual(sensor.channel_elevations, tuple(value))


class Scans(unittest.TestCase):
    def test_numbers_of_the_wrapped_classes(self):
        source = wrapped.vtkAvianLidarBeamSource()
        source.SetAzimuthStep(4.0)
        source.SetPosition(1, 2, 3)
        echo = plain_scan(town(), source, RaysPerBeam=64, Seed=5)
        echo.Update()
        scan = al.Scan(al.Scene(town()), al.Sensor(azimuth_step=4, position=(1, 2, 3)), rays_per_beam=64, seed=5)
        for port, cloud in ((0, scan.echoes), (1, scan.report)):
            expected = arrays(echo.GetOutput(port))
            self.assertEqual(set(cloud) | {"points"}, set(expected))
            self.assertGreater(cloud.number_of_points, 20)
            # `arrays` sorts by beam and return, which is the order of both.
            for name in set(cloud) - {"candidates", "nodes_visited"}:  # costs, which the shared tree may change
                self.assertEqual(cloud[name].tobytes(), expected[name].tobytes(), name)
        self.assertEqual(scan["energy"].tobytes(), scan.echoes["energy"].tobytes())

    def test_units_and_fields(self):
        scan = al.Scan(al.Scene(WALL, material=(0.1, 0.2, 30), name="wall"), al.Sensor(azimuth_step=5))
        echoes = scan.echoes
        self.assertEqual({name: echoes.units[name] for name in ("energy", "distance_m", "azimuth", "object_id")},
                         {"energy": "J", "distance_m": "m", "azimuth": "0.01 deg", "object_id": ""})
        key = vtkDataArray.UNITS_LABEL()
        for name in echoes:
            information = scan.algorithm.GetOutput().GetPointData().GetArray(name).GetInformation()
            self.assertEqual(echoes.units[name], information.Get(key) or "")
        self.assertEqual(echoes.fields["object_names"], ["wall"])
        self.assertEqual(echoes.fields["pulse_energy"], 3.6e-4)
        self.assertEqual(echoes.field_units["pulse_energy"], "J")
        self.assertEqual(echoes.fields["position"].tolist(), [0, 0, 0])
        table = echoes.structured()
        self.assertEqual(table["energy"].tobytes(), echoes["energy"].tobytes())
        self.assertEqual(table["points"].shape, echoes.points.shape)

    def test_lit_again_without_a_ray(self):
        sampled = {"beam_samples": "rays"}  # an integrated wall needs no ray at all
        scan = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2), **sampled)
        first = scan.echoes
        self.assertGreater(scan.number_of_traced_rays, 0)
        energies = first["energy"].copy()
        scan.attenuation_coefficient = 5e-4
        second = scan.echoes
        self.assertEqual(scan.number_of_traced_rays, 0)
        fresh = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2), attenuation_coefficient=5e-4, **sampled)
        self.assertTrue(same(second, fresh.echoes))
        self.assertLess(second["energy"].mean(), energies.mean())
        self.assertTrue(np.array_equal(first["energy"], energies))  # what was handed out stays as it was
        scan.sensor.position = (0, 10, 0)
        self.assertLess(scan["distance_m"].min(), first["distance_m"].min() - 9)

    def test_one_tree_for_all_scans(self):
        scene = al.Scene(town())
        scans = [al.Scan(scene, al.Sensor(azimuth_step=10), seed=seed).update() for seed in range(3)]
        self.assertEqual(scene.tree.GetNumberOfBuilds(), 1)
        self.assertEqual([scan.algorithm.GetNumberOfTreeBuilds() for scan in scans], [0, 0, 0])

    def test_a_sensor_stands_where_the_scene_says(self):
        scene = al.load_scene(SCENE)
        self.assertEqual(al.Scan(scene).sensor.position, scene.lidar_position)
        self.assertEqual(al.Scan(WALL).sensor.position, (0, 0, 0))

    def test_another_sensor_and_another_scene(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2))
        first = scan.echoes
        sensor, scene = al.Sensor(azimuth_step=3), al.Scene(box((-20, 80, -5), (20, 82, 15)))
        scan.sensor = sensor
        self.assertEqual(scan.report.number_of_points, 16 * 120)
        scan.scene = scene
        self.assertIs(scan.scene, scene)
        self.assertTrue(same(scan.echoes, al.Scan(scene, sensor).echoes))
        self.assertFalse(same(scan.echoes, first))
        self.assertTrue(first == first and first != scan.echoes and len({first, scan.echoes}) == 2)

    def test_range_image(self):
        scan = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2))
        image = scan.range_image()
        self.assertEqual(image["distance_m"].shape, (16, 180))
        self.assertTrue(np.allclose(image["column_azimuths"], np.arange(0, 360, 2)))
        self.assertTrue(np.allclose(image["row_elevations"], 0.375 * np.arange(16)))
        echoes = scan.echoes
        strongest = {}
        for i, beam in enumerate(echoes["beam_id"]):
            if echoes["energy_received"][i] > strongest.get(beam, (-1, 0))[0]:
                strongest[beam] = echoes["energy_received"][i], echoes["distance_m"][i]
        for beam, (_, distance) in strongest.items():
            self.assertEqual(image["distance_m"][beam % 16, beam // 16], distance)
        self.assertEqual(int(np.isfinite(image["distance_m"]).sum()), len(strongest))

    def test_empty_scene(self):
        scan = al.Scan(al.Scene(), al.Sensor(azimuth_step=10))
        self.assertEqual(scan.echoes.number_of_points, 0)
        self.assertEqual(scan.echoes.points.shape, (0, 3))
        self.assertEqual(scan["energy"].shape, (0,))
        self.assertTrue(np.isnan(scan.range_image()["distance_m"]).all())


class Surfaces(unittest.TestCase):
    def echoes(self, *args, **options):
        return al.Scan(al.Scene(*args, **options), al.Sensor(azimuth_step=2)).echoes

    def test_the_same_wall_from_everywhere(self):
        expected = self.echoes(WALL, material="Metal", name="wall")
        cube = vtkCubeSource()
        cube.SetBounds(-20, 20, 50, 52, -5, 15)
        cube.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
        paint = wrapped.vtkAvianLidarMaterial()
        paint.SetInputData(al.mesh(*WALL))
        paint.SetMaterialToMetal()
        for surfaces in (al.mesh(*WALL), list(WALL), (WALL[0].tolist(), WALL[1].astype(np.uint8)), paint,
                         paint.GetOutputPort()):
            found = self.echoes(surfaces, material="Metal", name="wall")
            self.assertTrue(same(found, expected), type(surfaces))
        self.assertTrue(np.allclose(self.echoes(cube, material=(0.075, 0.634, 6803))["distance_m"], expected["distance_m"],
                                    rtol=1e-6))

    def test_arrays_are_copied(self):
        points, triangles = WALL[0].copy(), WALL[1].copy()
        scene = al.Scene((points, triangles))
        before = scene.bounds
        points += 1000
        triangles[:] = 0
        self.assertEqual(al.Scene(scene.surfaces).bounds, before)
        self.assertTrue(same(al.Scan(scene, al.Sensor(azimuth_step=2)).echoes, self.echoes(WALL)))

    def test_materials_and_names(self):
        scene = al.Scene()
        scene.add(WALL, material="Glass", name="pane")
        scene.add(box((100, 0, 0), (110, 10, 9)), material=(0.1, 0.2, 30), name="crate")
        scene.add(box((-110, 0, 0), (-100, 10, 9)))
        self.assertEqual(scene.objects[:2], ["pane", "crate"])
        self.assertEqual(len(scene.objects), 3)
        self.assertEqual(scene.number_of_triangles, 36)
        self.assertEqual(scene.bounds, (-110, 110, 0, 52, -5, 15))
        cells = al.Scene(WALL, material=(0.1, 0.2, 30)).tree
        cells.Update()
        self.assertEqual([cells.GetOutput().GetCellData().GetArray(k).GetValue(0) for k in ("kd", "ks", "kp")],
                         [0.1, 0.2, 30])

    def test_adding_to_a_scene_changes_its_scans(self):
        scene = al.load_scene(SCENE)
        scan = al.Scan(scene)
        before = scan.echoes
        scene.add(box((199, 299, 0), (201, 301, 30)), material="Metal", name="mast")
        after = scan.echoes
        mast = scene.objects.index("mast")
        self.assertEqual(scene.objects[0], "Ground")
        self.assertNotIn("mast", before.fields["object_names"])
        self.assertGreater((after["object_id"] == mast).sum(), 5)
        self.assertGreater(after["distance_m"][after["object_id"] == mast].min(), 358)
        self.assertEqual(after.fields["geodetic_origin"].tolist(), list(scene.geodetic_origin))

    def test_bad_surfaces(self):
        points, triangles = WALL
        cases = ((ValueError, r"\(8, 2\)", (points[:, :2], triangles)), (ValueError, r"\(12,\)", (points, triangles[:, 0])),
                 (TypeError, "float64", (points, triangles * 1.0)), (IndexError, "there are 8", (points, triangles + 1)),
                 (TypeError, "not int", 3), (FileNotFoundError, "no such file: x.obj", "x.obj"), (TypeError, "without faces", points),
                 (al.Error, "none.lidarscene.json: cannot be opened", "none.lidarscene.json"))
        for kind, words, surfaces in cases:
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                al.Scene(surfaces)


class EditsInPlace(unittest.TestCase):
    """Surfaces that were given as VTK data are edited by NumPy; Modified() of anything in them gives a fresh look."""

    def surfaces(self, composite):
        data = al.mesh(*WALL)
        for name, value in (("kd", 0.1), ("ks", 0.2), ("kp", 30)):
            add_array(data, name, np.full(12, float(value)))
            data.GetCellData().AddArray(data.GetPointData().GetArray(name))
            data.GetPointData().RemoveArray(name)
        if not composite:
            return data, data
        inner, outer = vtkMultiBlockDataSet(), vtkMultiBlockDataSet()
        inner.SetBlock(0, data)
        outer.SetBlock(0, inner)
        return outer, data

    def echoes(self, scene):
        return al.Scan(scene, al.Sensor(azimuth_step=2)).echoes

    def edits(self, data):
        """{words: (array, the edit of its values)}; each goes on from the one before."""
        return {"points": (data.GetPoints().GetData(), lambda values: values.__iadd__((0, 20, 0))),
                "corners": (data.GetPolys().GetConnectivityArray(),
                            lambda values: values.__setitem__(slice(None), np.roll(values, 1))),
                "kd": (data.GetCellData().GetArray("kd"), lambda values: values.__imul__(1.1))}

    def told(self, whole, data, array):
        inner = [whole.GetBlock(0)] if whole is not data else []
        return [whole, *inner, data, data.GetPoints(), data.GetPolys(), data.GetCellData(), array]

    def test_every_edit_with_every_modified(self):
        for composite in (False, True):
            for material in (None, "Glass", (0.1, 0.2, 30)):
                whole, data = self.surfaces(composite)
                scene = al.Scene(whole, material=material)
                scan = al.Scan(scene, al.Sensor(azimuth_step=2))
                before = scan.echoes
                for what, (array, edit) in self.edits(data).items():
                    for i in range(len(self.told(whole, data, array))):
                        with self.subTest(composite=composite, material=material, what=what, told=i):
                            edit(vtk_to_numpy(array))
                            self.told(whole, data, array)[i].Modified()
                            copy = whole.NewInstance()
                            copy.DeepCopy(whole)
                            fresh = self.echoes(al.Scene(copy, material=material))
                            self.assertTrue(same(scan.echoes, fresh))
                            if what == "points" or what == "kd" and not material:
                                self.assertFalse(same(fresh, before))
                            before = fresh
                            self.assertEqual(scene.bounds, al.Scene(copy).bounds)

    def test_without_modified_nothing_runs(self):
        for material in (None, "Glass"):
            whole, data = self.surfaces(True)
            scan = al.Scan(al.Scene(whole, material=material), al.Sensor(azimuth_step=2))
            heard = []
            scan.progress = lambda share, name, heard=heard: heard.append(name)
            scan.update()
            self.assertIn("vtkAvianLidarCollisionTree", heard)
            heard.clear()
            scan.update()
            self.assertEqual((heard, scan.scene.bounds), ([], (-20, 20, 50, 52, -5, 15)))
            data.Modified()  # and nothing else: a look, and no ray
            scan.update()
            self.assertIn("vtkAvianLidarCollisionTree", heard)
            self.assertEqual((scan.scene.tree.GetNumberOfBuilds(), scan.number_of_traced_rays), (1, 0))

    def test_an_edit_that_fails_and_is_mended(self):
        whole, data = self.surfaces(False)
        for material in (None, "Glass"):
            scan = al.Scan(al.Scene(whole, material=material), al.Sensor(azimuth_step=2))
            before = scan.echoes
            values = vtk_to_numpy(data.GetPoints().GetData())
            values[0, 0] = np.nan
            data.GetPoints().Modified()
            for _ in range(2):
                with self.assertRaises(al.Error):
                    scan.update()
            values[0, 0] = -20
            data.GetPoints().Modified()
            self.assertTrue(same(scan.echoes, before))

    def test_what_an_algorithm_makes_anew(self):
        """A scene runs it once; whoever updates it changes the scene."""
        for material in (None, "Glass"):
            cube = vtkCubeSource()
            cube.SetBounds(-20, 20, 50, 52, -5, 15)
            scene = al.Scene(cube, material=material or "Wall")
            self.assertEqual(scene.bounds[:2], (-20, 20))
            cube.SetBounds(-10, 20, 50, 52, -5, 15)
            self.assertEqual(scene.bounds[:2], (-20, 20))
            cube.Update()
            self.assertEqual(scene.bounds[:2], (-10, 20))


class Frames(unittest.TestCase):
    def test_sensor_frame_has_the_angles_of_the_pattern(self):
        sensor = al.Sensor(azimuth_step=7, position=(3, -4, 5), orientation=(40, 12, -9))
        scan = al.Scan(box((-60, -60, -60), (60, 60, 60)), sensor, return_mode="Strongest")
        echoes = scan.echoes
        right, forward, up = echoes.coordinates("sensor").T
        column, channel = echoes["beam_id"] // 16, echoes["beam_id"] % 16
        self.assertGreater(len(column), 700)
        turn = np.degrees(np.arctan2(right, forward)) - 7 * column
        self.assertLess(abs((turn + 180) % 360 - 180).max(), 1e-9)
        self.assertLess(abs(np.degrees(np.arcsin(up / echoes["distance_m"])) - 0.375 * channel).max(), 1e-9)

    def test_places_on_the_earth(self):
        scan = al.Scan(al.load_scene(SCENE))
        echoes = scan.echoes
        self.assertTrue(np.shares_memory(echoes.coordinates("enu"), echoes.points))
        transform = wrapped.vtkAvianLidarGeodeticTransform()
        transform.SetInputData(scan.algorithm.GetOutput())
        transform.Update()
        expected = arrays(transform.GetOutput())
        places = echoes.coordinates("geodetic")
        for i, name in enumerate(("longitude", "latitude", "height")):
            self.assertTrue(np.allclose(places[:, i], expected[name], rtol=0, atol=1e-9))
        utm, ecef = echoes.coordinates("utm"), echoes.coordinates("ecef")
        self.assertTrue((abs(utm[:, 0] - 341700) < 5000).all())
        self.assertTrue((abs(np.linalg.norm(ecef, axis=1) - 6372400) < 5000).all())

    def test_what_is_needed(self):
        echoes = al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=5)).echoes
        for frame, words in (("geodetic", "geodetic_origin"), ("polar", "enu, sensor, geodetic, utm, ecef")):
            with self.assertRaisesRegex(ValueError, words):
                echoes.coordinates(frame)


class Refused(unittest.TestCase):
    def test_values_are_named(self):
        cover, sensor = al.Coverage(al.Scene(), al.Sensor()), al.Sensor(azimuth_step=5)
        runway = siting.Runway("a", (0, 0), (1000, 0), 45.0)
        for kind, words, call in (
                (KeyError, "there is no array 'x'; known are .*status", lambda: cover["x"]),
                (ValueError, "birds is 1, expected at least 2", lambda: reach.within_beams(sensor, birds=1)),
                (ValueError, "count is 1, expected at least 2", lambda: siting.strips_and_approaches([runway], 1)),
                (ValueError, "count is 9, expected at least 2", lambda: siting.strips_and_approaches([], 9)),
                (ValueError, r"heights are \(5, 1\)", lambda: siting.strips_and_approaches([runway], heights=(5, 1))),
                (ValueError, "weights have the shape", lambda: siting.values_of(np.zeros((1, 2, 3)), np.zeros((3, 2)))),
                (TypeError, "surfaces are vtkPolyData or a vtkMultiBlockDataSet", lambda: al.Scene(vtkImageData())),
                (ValueError, "'sensor' needs field data", lambda: al.Cloud(cloud([(1, 2, 3)])).coordinates("sensor")),
                (ValueError, "cannot draw 'direction', which has 3 components", lambda: sensor.beams.plot_map("direction"))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        self.assertEqual(len(cover.height_limits), cover.algorithm.GetNumberOfHeightLimits())
        self.assertRegex(repr(sensor.beams), "^<Cloud of [0-9]+ points: ")


class Docstrings(unittest.TestCase):
    def test_examples_run(self):
        names = {name: getattr(al, name) for name in al.__all__}
        tried = 0
        for module in ("_cloud", "_files", "_pipeline", "_plot", "_properties", "_scan", "_scene", "_sensor", "_writers"):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                result = doctest.testmod(importlib.import_module("avianlidar." + module), extraglobs=names)
            self.assertEqual(result.failed, 0, module)
            tried += result.attempted
        self.assertGreater(tried, 15)

    def test_everything_public_has_words(self):
        for name in set(al.__all__) - {"vtkAvianLidar"}:
            thing = getattr(al, name)
            self.assertTrue(thing.__doc__, name)
            for key, value in vars(thing).items() if isinstance(thing, type) else ():
                if not key.startswith("_") and callable(getattr(thing, key, None)):
                    self.assertTrue(getattr(thing, key).__doc__, f"{name}.{key}")


if __name__ == "__main__":
    unittest.main()
