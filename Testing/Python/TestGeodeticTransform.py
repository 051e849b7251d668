# SPDX-License-Identifier: BSD-3-Clause
"""The geodetic transform against two outside programs (CartConvert of GeographicLib's tools, cct of PROJ), composites,
and bad input. Poles and the date line are tested in TestGeodeticFrame.cxx, properties and arrays of wrong values in
TestBadInput.py.

Tolerance against the programs: 10 nm in each coordinate, of which rounding takes 4 nm, digits of the programs 1 nm and
the methods themselves a few; 20 nm in UTM, where northings reach 1e7 m and the two series differ. Measured differences
are half of that.
"""
import math
import subprocess
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import VTK_DOUBLE
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkMultiBlockDataSet, vtkPolyData, vtkUnstructuredGrid

from avianlidar.vtkAvianLidar import vtkAvianLidarGeodeticTransform as Transform

import cloudtools
from cloudtools import points as coordinates
from echotools import Messages, array, given, group, output

NANO, NANO_UTM, EARTH = 10e-9, 20e-9, 6378137.0
ENU, GEODETIC, UTM, ECEF = Transform.FRAME_ENU, Transform.FRAME_GEODETIC, Transform.FRAME_UTM, Transform.FRAME_ECEF
# Latitude, longitude, height: the paper's airport, the southern hemisphere, both sides of the date line, both poles and
# next to them, the Gulf of Guinea, the zones' exceptions in Norway.
ORIGINS = [
    (31.1979, 121.3363, 3.0), (-33.9461, 151.1772, 6.0), (-16.5, 179.9999, 0.0), (-16.5, -179.9999, 0.0),
    (52.0, 180.0, 10.0), (90.0, 0.0, 0.0), (-90.0, 0.0, 2835.0), (89.9999, 45.0, 100.0), (0.0, 0.0, 0.0),
    (60.39, 5.32, 20.0), (78.22, 15.65, 5.0),
]
TO_RADIANS = "+proj=unitconvert +xy_in=deg +xy_out=rad"


def cloud(points, kind=vtkPolyData, origin=None):
    data = cloudtools.cloud(points, kind)
    if origin is not None:
        cloudtools.add_field(data, "geodetic_origin", origin)
    return data


def run(data, **properties):
    transform = given(Transform(), InputDataObject=data, **properties)
    messages = Messages(transform)
    return output(transform), messages


def program(arguments, rows):
    text = "\n".join(" ".join(repr(float(x)) for x in row) for row in rows) + "\n"
    printed = subprocess.run(arguments, input=text, capture_output=True, text=True, check=True).stdout
    return np.array([[float(x) for x in line.split()[:3]] for line in printed.splitlines()])


def cct(rows, *steps):
    words = [word for step in steps for word in ("+step " + step).split()]
    return program(["cct", "-d", "14", "+proj=pipeline", "+ellps=WGS84", *words], rows)


class OutsidePrograms(unittest.TestCase):
    def good(self, *arguments, **properties):
        data, messages = run(*arguments, **properties)
        self.assertEqual(messages.all(), [])
        return data

    def test_every_frame(self):
        points = np.random.default_rng(20240211).uniform(-1.0, 1.0, (40, 3)) * (4000.0, 4000.0, 300.0)
        points[0] = 0
        for origin in ORIGINS:
            with self.subTest(origin):
                data = self.good(cloud(points, origin=origin))
                np.testing.assert_array_equal(coordinates(data), points)
                ours = np.column_stack([array(data, name) for name in ("longitude", "latitude", "height")])
                theirs = program(["CartConvert", "-p", "9", "-r", "-l", *map(repr, origin)], points)
                turns = np.remainder(ours[:, 0] - theirs[:, 1] + 180.0, 360.0) - 180.0  # 360 degrees are none
                self.assertLess(abs(np.radians(turns) * EARTH * np.cos(np.radians(ours[:, 1]))).max(), NANO)
                self.assertLess(abs(np.radians(ours[:, 1] - theirs[:, 0])).max() * EARTH, NANO)
                self.assertLess(abs(ours[:, 2] - theirs[:, 2]).max(), NANO)
                ecef = self.good(cloud(points, origin=origin), TargetFrame=ECEF, MovePoints=True)
                self.assertLess(abs(coordinates(ecef) - cct(ours, TO_RADIANS, "+proj=cart")).max(), NANO)
                for frame, there in ((GEODETIC, cloud(ours, origin=origin)), (ECEF, ecef)):
                    back = self.good(there, SourceFrame=frame, TargetFrame=ENU, MovePoints=True)
                    self.assertLess(abs(coordinates(back) - points).max(), 2 * NANO)
                if abs(origin[0]) < 84.0:
                    utm = self.good(cloud(points, origin=origin), TargetFrame=UTM, MovePoints=True)
                    zone = int(utm.GetFieldData().GetArray("utm_zone").GetComponent(0, 0))
                    self.assertEqual(zone < 0, origin[0] < 0.0)
                    theirs = cct(ours, TO_RADIANS, f"+proj=utm +zone={abs(zone)}" + (" +south" if zone < 0 else ""))
                    self.assertLess(abs(coordinates(utm) - theirs).max(), NANO_UTM)
                    back = self.good(utm, SourceFrame=UTM, TargetFrame=ENU, MovePoints=True)
                    self.assertLess(abs(coordinates(back) - points).max(), 2 * NANO_UTM)


class Behaviour(unittest.TestCase):
    def test_units_and_types(self):
        data, messages = run(cloud([[0.0, 0.0, 5.0]], vtkUnstructuredGrid), UseFieldDataOrigin=False, Origin=ORIGINS[0])
        self.assertEqual(messages.all(), [])
        self.assertIsInstance(data, vtkUnstructuredGrid)
        for name, unit, value in (("latitude", "deg", ORIGINS[0][0]), ("longitude", "deg", ORIGINS[0][1]),
                                  ("height", "m", ORIGINS[0][2] + 5.0)):
            a = data.GetPointData().GetArray(name)
            self.assertEqual((a.GetDataType(), a.GetInformation().Get(a.UNITS_LABEL())), (VTK_DOUBLE, unit))
            self.assertAlmostEqual(a.GetValue(0), value, places=8)
        self.assertEqual(data.GetFieldData().GetArray("geodetic_origin").GetTuple3(0), ORIGINS[0])

    def test_origin_is_needed_only_where_it_is_used(self):
        self.assertEqual(run(cloud([[EARTH, 0.0, 0.0]]), SourceFrame=ECEF)[1].all(), [])
        data, messages = run(cloud([[500e3, 1e6, 0.0]]), SourceFrame=UTM, UTMZone=-51)
        self.assertEqual(messages.all(), [])
        self.assertLess(array(data, "latitude")[0], -70.0)
        self.assertAlmostEqual(array(data, "longitude")[0], 123.0, places=12)

    def test_composite_takes_the_origin_of_the_whole(self):
        scene = group(cloud([[1.0, 2.0, 3.0]]), None, group(cloud([[1.0, 2.0, 3.0]], vtkUnstructuredGrid)))
        cloudtools.add_field(scene, "geodetic_origin", ORIGINS[1])
        data, messages = run(scene, TargetFrame=ECEF, MovePoints=True)
        self.assertEqual(messages.all(), [])
        first, second = data.GetBlock(0), data.GetBlock(2).GetBlock(0)
        np.testing.assert_array_equal(coordinates(first), coordinates(second))
        self.assertAlmostEqual(array(first, "longitude")[0], ORIGINS[1][1], places=3)
        self.assertEqual(scene.GetBlock(0).GetPoint(0), (1.0, 2.0, 3.0))

    def test_empty_input_is_silent(self):
        for empty in (vtkPolyData(), vtkMultiBlockDataSet()):
            self.assertEqual(run(empty)[1].all(), [])

    def test_bad_input(self):
        one, here = [[0.0, 0.0, 0.0]], dict(UseFieldDataOrigin=False)
        volume, block = group(vtkImageData()), group(cloud([[math.nan, 0.0, 0.0]]))
        for scene in (volume, block):
            scene.GetMetaData(0).Set(scene.NAME(), "volume")
        for text, data, properties in (
                ("latitude is 91", cloud(one), dict(Origin=(91.0, 0.0, 0.0), **here)),
                ("latitude is -90.5", cloud(one, origin=(-90.5, 0.0, 0.0)), {}),
                ("longitude is 361", cloud(one, origin=(0.0, 361.0, 0.0)), {}),
                ("longitude is nan", cloud(one, origin=(0.0, math.nan, 0.0)), {}),
                ("height is nan", cloud(one, origin=(0.0, 0.0, math.nan)), {}),
                ("finite", cloud([[0.0, math.nan, 0.0]]), here),
                ("northing", cloud([[5e5, 3e7, 0.0]]), dict(SourceFrame=UTM, UTMZone=31)),
                ("'geodetic_origin'", cloud(one), {}),
                ("latitude (y) is 91", cloud([[0.0, 91.0, 0.0]]), dict(SourceFrame=GEODETIC)),
                ("easting", cloud([[5e6, 0.0, 0.0]]), dict(SourceFrame=UTM, UTMZone=31)),
                ("'volume'", volume, here), ("block 'volume'", block, here)):
            with self.subTest(text):
                output, messages = run(data, **properties)
                self.assertTrue(any(text in said for said in messages.errors), messages.all())
                self.assertEqual(output.GetNumberOfPoints(), 0)
