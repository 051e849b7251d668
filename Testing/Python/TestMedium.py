# SPDX-License-Identifier: BSD-3-Clause
"""Media in part of a scene: the source, echoes and coverage through it, scene files with trees."""
import json
import math
import unittest

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkPlaneSource

import avianlidar as al
import scenetools as st
from avianlidar.vtkAvianLidar import (vtkAvianLidarCollisionTree, vtkAvianLidarCoverage, vtkAvianLidarEchoFilter,
                                      vtkAvianLidarMedium)
from cloudtools import field as texts
from echotools import InFolder, Messages, array, box, given, group, output

WALL = 200.0  # m north


def medium(source=None, **properties):
    return output(given(source or vtkAvianLidarMedium(), **properties))


def wall():
    return box((0, WALL + 1, 0), (500, 1, 500), "Concrete", "wall")


def beams(sensor="Search905", **properties):
    return al.Sensor(sensor, directions=[(0, 1, 0)] * 20, times=[1e-3 * k for k in range(20)], **properties).algorithm


def echoes(surfaces, source=None, **properties):
    scan = vtkAvianLidarEchoFilter()
    source = source or beams()  # a port does not keep its source
    scan.SetInputConnection(0, source.GetOutputPort())
    scan.SetInputDataObject(1, surfaces)
    given(scan, **{"AttenuationCoefficient": 0, "Noise": False, **properties}).Update()
    return al.Cloud(scan.GetOutput())


class Source(unittest.TestCase):
    def test_what_it_draws_and_says(self):
        box = medium(Kind=1, Visibility=200.0, Shape=2, Center=(10.0, 20.0, 30.0), Lengths=(2.0, 4.0, 6.0), Name="bank")
        self.assertEqual(box.GetBounds(), (9, 11, 18, 22, 27, 33))
        said = json.loads(box.GetFieldData().GetAbstractArray("medium").GetValue(0))
        self.assertEqual((said["kind"], said["visibility"], said["shape"]), ("fog", 200.0, "box"))
        turned = medium(Shape=3, Lengths=(2.0, 10.0, 2.0), Heading=90.0)
        np.testing.assert_allclose(turned.GetBounds(), (-5, 5, -1, 1, -1, 1), atol=0.03)
        layer = medium(Bottom=0.0, Top=10.0, DisplaySize=100.0)
        self.assertEqual(layer.GetBounds(), (-50, 50, -50, 50, 0, 10))
        self.assertEqual(medium(Kind=5, Shape=3).GetFieldData().GetAbstractArray("object_classes").GetValue(0),
                         "vegetation")

    def test_bad_values_are_named(self):
        plane = vtkPlaneSource()
        opened = vtkAvianLidarMedium()
        opened.SetInputConnection(plane.GetOutputPort())
        for source, properties, part in (
                (None, {"Visibility": -1.0}, "medium 'medium': visibility: "), (None, {"Kind": 7}, "Kind is 7"),
                (None, {"DisplaySize": 0.0}, "DisplaySize is 0"), (opened, {"Shape": 4}, "4 edges with one triangle")):
            with self.subTest(part):
                source = given(source or vtkAvianLidarMedium(), **properties)
                errors = Messages(source).errors
                source.Update()
                self.assertIn(part, "".join(errors))
                self.assertEqual(source.GetOutput().GetNumberOfCells(), 0)


class Echoes(unittest.TestCase):
    def test_surfaces_behind_a_bank_are_weakened(self):
        bank = medium(Kind=6, Extinction=0.02, BackscatterRatio=1e9, Shape=2, Center=(0.0, 100.0, 0.0),
                      Lengths=(100.0, 30.0, 100.0))
        behind = echoes(group(wall(), bank))["energy_received"].mean()
        self.assertAlmostEqual(behind / echoes(wall())["energy_received"].mean() / math.exp(-2 * 0.6), 1, delta=1e-6)
        cube = vtkCubeSource()
        cube.SetBounds(-50, 50, 85, 115, -50, 50)
        body = vtkAvianLidarMedium()
        body.SetInputConnection(cube.GetOutputPort())
        body = medium(body, Kind=6, Extinction=0.02, BackscatterRatio=1e9, Shape=4)
        self.assertAlmostEqual(echoes(group(wall(), body))["energy_received"].mean() / behind, 1, delta=1e-4)
        surfaces = group(wall(), bank)
        for _ in range(2):  # by a tree, and by what a tree merged, merged again
            tree = vtkAvianLidarCollisionTree()
            tree.SetInputData(surfaces)
            tree.Update()
            self.assertEqual(echoes(tree.GetOutput())["energy_received"].mean(), behind)
            surfaces = group(tree.GetOutput())

    def test_a_tree_by_beer_and_lambert(self):
        crown = medium(Kind=5, LeafAreaDensity=0.4, Shape=3, Center=(0.0, 100.0, 0.0), Lengths=(6.0, 6.0, 6.0),
                       Name="oak")
        seen = echoes(group(wall(), crown))
        behind = seen["distance_m"] > 150
        # There and back through all leaves; a beam of some width meets others on its way back (TestBeamCrowns.cxx).
        weakened = seen["energy_received"][behind].mean() / echoes(wall())["energy_received"].mean()
        self.assertTrue(math.exp(-2 * 0.5 * 0.4 * 6) < weakened < math.exp(-0.5 * 0.4 * 6), weakened)
        ids = seen["object_id"][~behind]
        self.assertGreater(len(ids), 15)
        self.assertEqual({texts(seen.data, "object_names")[i] for i in ids}, {"oak"})
        self.assertEqual({texts(seen.data, "object_classes")[i] for i in ids}, {"vegetation"})
        self.assertTrue((np.abs(seen["distance_m"][~behind] - 100) < 3.5).all())

    def test_trees_without_a_name_are_named_as_surfaces_are(self):
        trees = [medium(Kind=5, Shape=2, Center=(0.0, 50.0 + 50 * k, 0.0), Lengths=(40.0, 1.0, 40.0), Name="")
                 for k in range(3)]
        blocks = group(wall(), *trees)
        blocks.GetMetaData(1).Set(vtkMultiBlockDataSet.NAME(), "lime")
        seen = echoes(blocks)
        self.assertEqual(texts(seen.data, "object_names"), ["wall", "lime", "block 2", "block 3"])
        self.assertGreaterEqual(set(seen["object_id"]), {0, 1, 2, 3})
        self.assertEqual(texts(echoes(trees[0]).data, "object_names"), ["object 0"])

    def test_a_shower_passes(self):
        shower = {"Kind": 3, "RainRate": 50.0, "Shape": 2, "Lengths": (40.0, 40.0, 200.0), "Velocity": (10.0, 0.0, 0.0)}
        there = echoes(group(wall(), medium(**shower, Center=(0.0, 80.0, 0.0))), Noise=True)
        gone = echoes(group(wall(), medium(**shower, Center=(60.0, 80.0, 0.0))), Noise=True)
        self.assertGreater((there["object_id"] == -2).sum(), 50)
        self.assertEqual((gone["object_id"] == -2).sum(), 0)
        # 6 s later the second is where the first was.
        later = al.Sensor("Search905", directions=[(0, 1, 0)] * 20, times=[6 + 1e-3 * k for k in range(20)]).algorithm
        came = echoes(group(wall(), medium(**shower, Center=(-60.0, 80.0, 0.0))), later, Noise=True)
        self.assertGreater((came["object_id"] == -2).sum(), 50)


class Coverage(unittest.TestCase):
    def probabilities(self, surfaces, **properties):
        coverage = vtkAvianLidarCoverage()
        sensor = al.Sensor("Search905", azimuth_step=2)
        coverage.SetInputConnection(0, sensor.algorithm.GetOutputPort())
        coverage.SetInputDataObject(1, surfaces)
        given(coverage, Bounds=(-600, 600, 100, 700, 20, 60), Spacing=(100, 100, 20), **properties).Update()
        return array(coverage.GetOutputDataObject(0), "detection_probability")

    def test_it_knows_media(self):
        ground = box((0, 0, -6), (900, 900, 1), "Grass", "ground")
        clear_air = {"Visibility": 0.0, "AttenuationCoefficient": 0.0}
        clear = self.probabilities(ground, **clear_air)
        weather = self.probabilities(ground, Visibility=800.0, AirBackscatter=True)
        everywhere = self.probabilities(group(ground, medium(Visibility=800.0, Shape=0)), **clear_air)
        np.testing.assert_allclose(everywhere, weather, atol=1e-6)
        self.assertGreater(clear.sum(), 1.5 * weather.sum())
        bank = medium(Visibility=100.0, Shape=2, Center=(0.0, 50.0, 0.0), Lengths=(40.0, 60.0, 500.0))
        behind = self.probabilities(group(ground, bank), **clear_air)
        self.assertTrue((behind <= clear + 1e-6).all() and (behind < clear - 0.2).any()
                        and (behind[clear > 0.9] > 0.9).any())


class SceneFiles(InFolder):
    def scene(self, objects):
        return st.write_scene(self.folder, "airport", {"version": 1, "objects": objects})

    def test_fog_trees_rows_and_woods(self):
        plan = st.features(
            ("Point", [10.0, 50.0], {"natural": "tree"}), ("Point", [20.0, 50.0], {"natural": "tree", "height": "12"}),
            ("LineString", [[0.0, 100.0], [30.0, 100.0]], {"natural": "tree_row"}),
            ("Polygon", [[[-60, 80], [-20, 80], [-20, 120], [-60, 120], [-60, 80]]], {"natural": "wood"}))
        trees = {"footprints": "trees.geojson", "crs": "local", "name": "trees", "class": "vegetation", "base": 2,
                 "height": 8, "height_attribute": "height", "width": 6,
                 "medium": {"kind": "foliage", "leaf_area_density": 0.5}}
        (self.folder / "trees.geojson").write_text(plan, "utf-8")
        file = self.scene([{"ground": {"size": 1000}, "name": "ground", "material": "Grass"}, trees,
                           {"medium": {"kind": "fog", "visibility": 200, "shape": "layer", "top": 3, "softness": 2},
                            "name": "ground fog"}])
        scene = al.Scene(file)
        scan = al.Scan(scene, al.Sensor("Search905", position=(0, 0, 5), azimuth_range=(-50, 50)), noise=False)
        kinds = [json.loads(said)["kind"] for said in texts(scan.echoes.data, "media")]
        self.assertEqual(sorted(kinds), ["fog", "foliage", "foliage"])
        names = texts(scan.echoes.data, "object_names")
        crowns = scan.echoes.points[[number >= 0 and names[number] == "trees" for number in scan["object_id"]]]
        # The two trees, the row (crowns at 3, 9, ... 27 m), the wood.
        for x, y in ((10, 50), (20, 50), (3, 100), (27, 100), (-40, 82)):
            self.assertTrue((np.hypot(crowns[:, 0] - x, crowns[:, 1] - y) < 3.6).any(), (x, y))
        near = crowns[crowns[:, 1] < 60]
        self.assertTrue((near[np.abs(near[:, 0] - 10) < 3][:, 2] < 10.5).all())
        self.assertGreater(near[np.abs(near[:, 0] - 20) < 3][:, 2].max(), 10.1)

    def test_bad_ones_are_named(self):
        fog = {"kind": "fog", "visibility": 5, "shape": "layer", "top": 3}
        for one, part in (({"medium": 3}, "objects[0].medium: "),
                          ({"medium": {"kind": "soup", "shape": "layer"}, "name": "x"}, "kind: "),
                          ({"medium": {**fog, "rain_rate": 3}}, "rain_rate: unknown key"),
                          ({"medium": {**fog, "shape": "everywhere"}}, "top: unknown key"),
                          ({"ground": {"size": 5}, "medium": {"kind": "fog", "visibility": 5, "shape": "box"}},
                           "objects[0]")):
            with self.subTest(part), self.assertRaises(al.Error) as raised:
                al.Scene(self.scene([one]))
            self.assertIn(part, str(raised.exception))
