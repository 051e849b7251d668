# SPDX-License-Identifier: BSD-3-Clause
"""The bird source: names and materials of its parts, where its wings and its bill point, species of one's own, errors
that name the property, and a lidar that sees it and says what it is. Shapes and areas are TestBird's (kernel)."""

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar
from avianlidar import Error, Scan, Sensor
from echotools import InFolder, bird

PARTS = ("Body", "LeftWing", "RightWing")
HEADER = "species,mass [kg],length [m],span [m],wing area [m2],passerine,airspeed [m/s]\n"


def points(surface, part):
    cells = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    of_part = vtk_to_numpy(surface.GetCellData().GetArray("part")) == PARTS.index(part)
    return vtk_to_numpy(surface.GetPoints().GetData())[np.unique(cells[of_part])]


class Bird(InFolder):
    def test_parts_have_names_and_materials(self):
        surface = bird(Reflectance=0.15, ObjectId=7)
        cells = {name: set(vtk_to_numpy(surface.GetCellData().GetArray(name)))
                 for name in ("kd", "ks", "kp", "object_id", "material_id", "part")}
        self.assertEqual(cells,
                         {"kd": {0.15}, "ks": {0}, "kp": {1}, "object_id": {7}, "material_id": {4}, "part": {0, 1, 2}})
        self.assertEqual(surface.GetFieldData().GetAbstractArray("object_names").GetValue(0), "herring gull")

    def test_flaps_glides_and_turns(self):
        right = points(bird(WingPhase=0.25), "RightWing")
        self.assertAlmostEqual(np.degrees(np.arctan2(np.ptp(right[:, 2]), np.ptp(right[:, 0]))), 35, delta=2)
        self.assertLess(points(bird(WingPhase=0.75), "RightWing")[:, 2].min(), -0.3)
        np.testing.assert_allclose(points(bird(Gliding=True, WingPhase=0.75), "LeftWing"),
                                   points(bird(Gliding=True), "LeftWing"))
        bill = points(bird(Position=(10, 20, 30)), "Body")[0]
        np.testing.assert_allclose(bill, (10, 20 + 0.325 * 0.6, 30), atol=0.02)
        np.testing.assert_allclose(points(bird(Heading=90.0), "Body")[0], (0.325 * 0.6, 0, 0), atol=0.02)
        # Banked to the right, the right wing is low.
        self.assertLess(points(bird(Bank=30.0), "RightWing")[:, 2].min(), -0.3)

    def test_species_of_ones_own(self):
        rows = HEADER + "swift,0.04,0.17,0.42,0.016,no,10\n"
        (self.folder / "own.csv").write_text(rows, "utf-8")
        body = points(bird(Species="swift", SpeciesFileName="own.csv"), "Body")
        self.assertAlmostEqual(np.ptp(body[:, 1]) / (0.65 * 0.17), 1, delta=0.1)
        self.assertGreater(bird(Species="crow", SpeciesFileName="own.csv").GetNumberOfCells(), 0)
        (self.folder / "own.csv").write_text(rows + "swift,heavy,0.17,0.42,0.016,no,10\n", "utf-8")
        with self.assertRaisesRegex(Error, r"own\.csv: line 3: mass is 'heavy'"):
            bird(Species="swift", SpeciesFileName="own.csv")

    def test_bad_values_name_the_property(self):
        for name, value in (("Species", "dodo"), ("SpeciesFileName", "/nowhere.csv"), ("WingPhase", float("nan")),
                            ("Heading", float("inf")), ("Bank", float("nan")), ("Position", (0.0, float("nan"), 0.0)),
                            ("Reflectance", 1.5), ("ObjectId", -2)):
            with self.subTest(name), self.assertRaisesRegex(Error, name + ".* is |cannot be read"):
                bird(**{name: value})

    def test_a_lidar_sees_it_and_says_what_it_is(self):
        scene = avianlidar.Scene(bird(Species="Canada goose", Position=(0, 300, 15), Heading=60.0, WingPhase=0.2))
        echoes = Scan(scene, Sensor("Search905"), noise=False).echoes
        self.assertGreater(len(echoes["distance_m"]), 0)
        np.testing.assert_allclose(echoes["distance_m"], np.hypot(300, 15), atol=1.0)
        self.assertEqual(set(echoes["object_id"]), {1})
        self.assertEqual(echoes.fields["object_names"][1], "Canada goose")
        # With the paper's receiver it is too faint.
        self.assertEqual(Scan(scene, Sensor("Airport16"), noise=False).echoes.number_of_points, 0)
