# SPDX-License-Identifier: BSD-3-Clause
"""Classes of objects go with their objects: through scenes put together from several producers, new numbers, the
collision tree and the echo filter, to the labels of a file."""


import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from avianlidar._cloud import add_array
from cloudtools import add_field, field
from echotools import InFolder, array, bird, box, given, group, output, scan, sensor


def thing(name, azimuth, classes=None, ids=None):
    """A box 60 m away, one object, or with `ids` one for each of its six faces."""
    angle = np.radians(azimuth)
    data = box((60 * np.sin(angle), 60 * np.cos(angle), 2), (5, 5, 5), "Wall", name)
    if ids is not None:
        add_array(data.GetCellData(), "object_id", np.array(ids, dtype=np.int32))
        add_field(data, "object_names", [f"{name} {i}" for i in range(max(ids) + 1)])
    if classes:
        add_field(data, "object_classes", classes)
    return data


def tree_of(surfaces):
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputDataObject(surfaces)
    return tree


def lidar():
    return given(sensor(180, 4), HalfBeamwidth=0.02, LowerEnergyLimit=1e-8)  # a bird is faint


class ObjectClasses(InFolder):
    def check(self, surfaces, names, classes):
        """Tree and echo filter, with and without the tree, say the same; each echo has the class of its object."""
        tree = tree_of(surfaces)
        tree.Update()
        plain, treed = scan(surfaces, lidar()), scan(tree, lidar())
        for algorithm in (tree, plain, treed):
            algorithm.Update()
            for port in range(1 if algorithm is tree else 2):
                data = algorithm.GetOutputDataObject(port)
                self.assertEqual(field(data, "object_names"), names)
                self.assertEqual(field(data, "object_classes"), classes)
        return treed.GetOutput()

    def test_of_several_producers(self):
        """Each producer begins to count at 0, so objects get new numbers; a leaf may have several. Where no block says
        its own, the scene's are by object id."""
        hangar, cone, goose = thing("hangar", 0, ["hangar"]), thing("cone", 90), thing("goose", 180, ["bird"])
        leaf = thing("faces", 0, ["runway", "", "fence"], (2, 2, 2, 0, 0, 1))
        other = thing("more", 90, ["tree", "car"], (0, 0, 0, 1, 1, 1))
        unnamed = [thing("a", 0, None, [1] * 6), thing("b", 90, None, [0] * 6)]
        for part in unnamed:
            part.GetFieldData().RemoveArray("object_names")
        unnamed = group(*unnamed)
        add_field(unnamed, "object_classes", ["tower", "sign"])
        collect = vtk.vtkMultiBlockDataGroupFilter()  # it hands on the field data of its first input
        for part in (thing("faces", 0, ["runway", "apron", "fence"], (0, 0, 1, 1, 2, 2)), cone, goose):
            collect.AddInputData(part)
        collect.Update()
        for surfaces, expected in ((group(hangar, cone, goose), {"hangar": "hangar", "cone": "", "goose": "bird"}),
                                   (collect.GetOutput(), {"faces 0": "runway", "faces 1": "apron", "faces 2": "fence",
                                                          "cone": "", "goose": "bird"}),
                                   (leaf, {"faces 0": "runway", "faces 1": "", "faces 2": "fence"}),
                                   (unnamed, {"block 1": "tower", "block 0": "sign"}),
                                   (group(leaf, other), {"faces 0": "runway", "faces 1": "", "faces 2": "fence",
                                                         "more 0": "tree", "more 1": "car"})):
            self.check(surfaces, list(expected), list(expected.values()))

    def test_material_keeps_it(self):
        surfaces = group(thing("hangar", 0, ["hangar"]), thing("faces", 90, ["runway", "fence"], (0, 0, 0, 1, 1, 1)))
        paint = al.vtkAvianLidarMaterial()
        paint.SetInputData(surfaces)
        paint.SetMaterialToGlass()
        self.check(output(paint), ["hangar", "faces 0", "faces 1"], ["hangar", "runway", "fence"])
        paint.SetNameOfObject("pane")  # each block is one object: of one class, or of none that is known
        self.check(output(paint), ["pane", "pane"], ["hangar", ""])

    def test_a_new_class_is_seen(self):
        surfaces = group(thing("hangar", 0, ["hangar"]), thing("goose", 180, ["bird"]))
        tree = tree_of(surfaces)
        plain, treed = scan(surfaces, lidar()), scan(tree, lidar())
        for classes in (["hangar", "bird"], ["hangar", "aircraft"], ["hangar", "bird"]):
            add_field(surfaces.GetBlock(1), "object_classes", classes[1:])
            surfaces.Modified()
            for echo in (plain, treed):
                self.assertEqual(field(output(echo), "object_classes"), classes)
        self.assertEqual(tree.GetNumberOfBuilds(), 1)
        self.assertEqual(plain.GetNumberOfTracedRays(), 0)

    def test_labels_of_a_bird_over_an_airport(self):
        goose = bird(Species="Canada goose", Position=(0, 60, 2))
        surfaces = group(thing("hangar", 90, ["hangar"]), goose, thing("runway", 180, ["runway"]))
        echoes = self.check(surfaces, ["hangar", "Canada goose", "runway"], ["hangar", "bird", "runway"])
        self.assertEqual(set(array(echoes, "object_id")), {0, 1, 2})
        self.assertTrue(given(al.vtkAvianLidarKITTIWriter(), InputData=echoes, FileName="a.bin").Write())
        labels = np.fromfile("a.label", dtype="<u4")
        self.assertEqual((labels & 0xFFFF).tolist(), [{0: 50, 1: 99, 2: 40}[i] for i in array(echoes, "object_id")])
