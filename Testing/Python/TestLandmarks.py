# SPDX-License-Identifier: BSD-3-Clause
"""Names, rings, ranges and fan: closed forms, and what gets no name. Names of runway ends are TestSiting's."""
import math
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
from avianlidar._cloud import add_array, as_numpy
from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarLandmarks
from echotools import Messages, given

# Object: name, class, corners of its ground plan (m), height (m).
OBJECTS = [("Runway 09/27", "runway", ((-500, -20), (500, 20)), 0.0), ("Two runways", "runway", ((0, 0), (90, 90)), 0.0),
           ("Hangar 3", "hangar", ((100, 100), (140, 160)), 9.0), ("Terminal 2", "terminal", ((200, 0), (300, 40)), 25.0),
           ("Old tower", "tower", ((0, 200), (10, 210)), 40.0), ("Nature reserve", "vegetation", ((-500, -900), (400, 0)),
                                                                  5.0), ("Kerb", "structure", ((5, 5), (9, 9)), 0.2)]


def surfaces():
    """Two level rectangles of each object, below and above."""
    corners, cells, ids = [], [], []
    for number, (_, _, ((west, south), (east, north)), height) in enumerate(OBJECTS):
        for z in {0.0, height}:
            first = len(corners)
            corners += [(west, south, z), (east, south, z), (east, north, z), (west, north, z)]
            cells += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
            ids += 2 * [number]
    data = al.mesh(corners, cells)
    add_array(data.GetCellData(), "object_id", np.array(ids, dtype=np.int32))
    for name, texts in (("object_names", [one[0] for one in OBJECTS]), ("object_classes", [one[1] for one in OBJECTS])):
        add_array(data.GetFieldData(), name, texts)
    return data


def landmarks(beams=None, data=None, **properties):
    """The four outputs."""
    algorithm = given(vtkAvianLidarLandmarks(), **properties)
    if beams:
        algorithm.SetInputConnection(0, beams.GetOutputPort())
    if data:
        algorithm.SetInputDataObject(1, data)
    algorithm.Update()
    return [algorithm.GetOutput(port) for port in range(4)]


def texts(output):
    names = output.GetPointData().GetAbstractArray("name")
    return {names.GetValue(i): output.GetPoint(i) for i in range(output.GetNumberOfPoints())} if names else {}


class Landmarks(unittest.TestCase):
    def test_names(self):
        """No name for numbered things, low things, wide things, and several runways in one object."""
        *others, names, fan = landmarks(data=surfaces())
        found = texts(names)
        self.assertEqual(list(found), ["09", "27", "Terminal 2", "Old tower"])
        for name, place in zip(found, ((-500, 0, 0), (500, 0, 0), (250, 20, 25), (5, 205, 40))):
            # Names of buildings are at the middle of a triangle.
            np.testing.assert_allclose(found[name], place, atol=20 if name.startswith("T") else 2 if " " in name else 1e-9)
        self.assertEqual([one.GetNumberOfPoints() for one in (*others, fan)], [0, 0, 0])
        self.assertEqual(list(texts(landmarks(data=surfaces(), MaximumNumberOfBuildings=1)[2])),
                         ["09", "27", "Terminal 2"])
        bare = surfaces()
        bare.GetFieldData().Initialize()
        self.assertEqual(landmarks(data=bare)[2].GetNumberOfPoints(), 0)

    def test_rings_ranges_and_fan(self):
        beams = given(vtkAvianLidarBeamSource(), NumberOfChannels=3, MinimumElevation=-5, ElevationStep=5, AzimuthStep=7,
                      Position=(10, 20, 3))
        rings, ranges, names, fan = landmarks(beams, RingSpacing=50, NumberOfRings=4, RangeDirection=90)
        self.assertEqual(names.GetNumberOfPoints(), 0)
        off = as_numpy(rings.GetPoints().GetData()) - (10, 20, 3)
        np.testing.assert_allclose(np.linalg.norm(off.reshape(4, -1, 3), axis=2), 50.0 * np.arange(1, 5)[:, None]
                                   * np.ones(180), rtol=1e-12)
        self.assertEqual(vtk_to_numpy(rings.GetCellData().GetArray("distance_m")).tolist(), [50, 100, 150, 200])
        self.assertEqual({name: tuple(np.round(place, 9)) for name, place in texts(ranges).items()},
                         {**{f"{far} m": (10.0 + far, 20.0, 3.0) for far in (50, 100, 150, 200)}, "N": (10, 120, 3)})
        starts, ends = as_numpy(fan.GetPoints().GetData()).reshape(-1, 2, 3).swapaxes(0, 1)
        self.assertTrue((starts == (10, 20, 3)).all())
        way = (ends - starts) / 50.0
        elevations = np.degrees(np.arcsin(way[:, 2])).round(9)
        self.assertEqual(sorted(elevations), sorted(12 * [-5, 0, 5]))
        # Steps of 7 degrees: the beam nearest to each multiple of 30 is the multiple of 7 nearest to it.
        wanted = [7 * round(30 * k / 7) for k in range(12)]
        turned = np.degrees(np.arctan2(way[:, 0], way[:, 1])).round(6) % 360
        self.assertEqual(sorted(set(turned)), sorted(wanted))
        self.assertTrue(math.isclose(np.linalg.norm(way, axis=1).max(), 1.0))

    def test_bad_numbers(self):
        for name, value in (("RingSpacing", 0.0), ("RingSpacing", math.nan), ("NumberOfRings", -1),
                            ("RangeDirection", math.inf), ("MaximumNumberOfBuildings", -1)):
            algorithm = given(vtkAvianLidarLandmarks(), **{name: value})
            said = Messages(algorithm)
            algorithm.Update()
            self.assertIn(f"{name} is ", said.errors[0])

    def test_places_that_are_not_finite(self):
        broken = surfaces()
        broken.GetPoints().SetPoint(0, math.nan, 0, 0)  # of the runway
        self.assertEqual(list(texts(landmarks(data=broken)[2])), ["Terminal 2", "Old tower"])
        beams = al.Sensor("Airport16", azimuth_step=30).beams.data
        beams.GetPoints().SetPoint(0, math.nan, 0, 0)
        algorithm = vtkAvianLidarLandmarks()
        algorithm.SetInputDataObject(0, beams)
        said = Messages(algorithm)
        algorithm.Update()
        self.assertIn("Input port 0, first beam: position", said.errors[0])


if __name__ == "__main__":
    unittest.main()
