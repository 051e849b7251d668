# SPDX-License-Identifier: BSD-3-Clause
"""Geodetic transform against two outside programs (CartConvert of GeographicLib's tools, cct of PROJ), round trips
through every pair of frames, composites, moving points, and every kind of bad input.

Tolerance against the programs: 10 nm in each coordinate. A coordinate of 6.4e6 m is rounded to 0.5 nm and goes through
some four operations on either side (4 nm); a longitude in degrees is rounded to 1.6 nm on the ground; the programs print
1 nm; the methods themselves err by a few nm. Measured differences are below 4 nm. In UTM, where northings reach 1e7 m
(rounded to 1 nm) and the two series differ, it is 20 nm, and measured differences are below 10 nm.
"""

import math
import subprocess
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_DOUBLE, vtkDoubleArray, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkImageData, vtkMultiBlockDataSet, vtkPolyData, vtkUnstructuredGrid)

from avianlidar.vtkAvianLidar import vtkAvianLidarGeodeticTransform as Transform

from echotools import Messages

NANO = 10e-9
NANO_UTM = 20e-9
EARTH = 6378137.0

# Latitude, longitude, height: the paper's airport, the southern hemisphere, both sides of the date line, both poles and
# next to them, the Gulf of Guinea, the zones' exceptions in Norway.
ORIGINS = [
    (31.1979, 121.3363, 3.0), (-33.9461, 151.1772, 6.0), (-16.5, 179.9999, 0.0), (-16.5, -179.9999, 0.0),
    (52.0, 180.0, 10.0), (90.0, 0.0, 0.0), (-90.0, 0.0, 2835.0), (89.9999, 45.0, 100.0), (0.0, 0.0, 0.0),
    (60.39, 5.32, 20.0), (78.22, 15.65, 5.0),
]


def local_points():
    generator = np.random.default_rng(20240211)
    points = generator.uniform(-1.0, 1.0, (40, 3)) * (4000.0, 4000.0, 300.0)
    return np.vstack([np.zeros(3), points])


def cloud(points, kind=vtkPolyData, origin=None):
    data = kind()
    holder = vtkPoints()
    holder.SetDataTypeToDouble()
    holder.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=1))
    data.SetPoints(holder)
    if origin is not None:
        add_origin(data, origin)
    return data


def add_origin(data, origin):
    array = vtkDoubleArray()
    array.SetName("geodetic_origin")
    array.SetNumberOfComponents(3)
    array.InsertNextTuple3(*origin)
    data.GetFieldData().AddArray(array)


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def coordinates(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def run(data, **properties):
    transform = Transform()
    transform.SetInputDataObject(data)
    for name, value in properties.items():
        getattr(transform, "Set" + name)(value)
    messages = Messages(transform)
    transform.Update()
    return transform.GetOutputDataObject(0), messages


def program(arguments, rows):
    text = "\n".join(" ".join(repr(float(x)) for x in row) for row in rows) + "\n"
    printed = subprocess.run(arguments, input=text, capture_output=True, text=True, check=True).stdout
    return np.array([[float(x) for x in line.split()[:3]] for line in printed.splitlines()])


def cart_convert(rows, *options):
    return program(["CartConvert", "-p", "9", *options], rows)


def cct(rows, *steps):
    pipeline = ["+proj=pipeline", "+ellps=WGS84"]
    for step in steps:
        pipeline += ["+step"] + step.split()
    return program(["cct", "-d", "14", *pipeline], rows)


TO_RADIANS = "+proj=unitconvert +xy_in=deg +xy_out=rad"


def metres(longitude_difference, latitude_difference, latitude):
    """East and north parts of a difference of angles in degrees, in metres; 360 degrees are none."""
    turns = np.remainder(longitude_difference + 180.0, 360.0) - 180.0
    return np.radians(turns) * EARTH * np.cos(np.radians(latitude)), np.radians(latitude_difference) * EARTH


class OutsidePrograms(unittest.TestCase):
    def geodetic(self, origin, points):
        data, messages = run(cloud(points, origin=origin))
        self.assertEqual(messages.all(), [])
        np.testing.assert_array_equal(coordinates(data), points)
        return np.column_stack([array(data, name) for name in ("longitude", "latitude", "height")])

    def test_enu_to_geodetic_against_cart_convert(self):
        points = local_points()
        for origin in ORIGINS:
            ours = self.geodetic(origin, points)
            theirs = cart_convert(points, "-r", "-l", *(repr(x) for x in origin))
            east, north = metres(ours[:, 0] - theirs[:, 1], ours[:, 1] - theirs[:, 0], ours[:, 1])
            worst = max(abs(east).max(), abs(north).max(), abs(ours[:, 2] - theirs[:, 2]).max())
            self.assertLess(worst, NANO, origin)

    def test_geodetic_to_enu_against_cart_convert_and_cct(self):
        points = local_points()
        for origin in ORIGINS:
            geodetic = self.geodetic(origin, points)
            data, messages = run(
                cloud(geodetic, origin=origin), SourceFrame=Transform.FRAME_GEODETIC,
                TargetFrame=Transform.FRAME_ENU, MovePoints=True)
            self.assertEqual(messages.all(), [])
            ours = coordinates(data)
            theirs = cart_convert(geodetic[:, [1, 0, 2]], "-l", *(repr(x) for x in origin))
            self.assertLess(abs(ours - theirs).max(), NANO, origin)
            latitude, longitude, height = origin
            topocentric = f"+proj=topocentric +lat_0={latitude!r} +lon_0={longitude!r} +h_0={height!r}"
            theirs = cct(geodetic, TO_RADIANS, "+proj=cart", topocentric)
            self.assertLess(abs(ours - theirs).max(), NANO, origin)

    def test_ecef_against_cart_convert_and_cct(self):
        points = local_points()
        for origin in ORIGINS:
            geodetic = self.geodetic(origin, points)
            data, messages = run(
                cloud(points, origin=origin), TargetFrame=Transform.FRAME_ECEF, MovePoints=True)
            self.assertEqual(messages.all(), [])
            ours = coordinates(data)
            self.assertLess(abs(ours - cart_convert(geodetic[:, [1, 0, 2]])).max(), NANO, origin)
            self.assertLess(abs(ours - cct(geodetic, TO_RADIANS, "+proj=cart")).max(), NANO, origin)

    def test_utm_against_cct(self):
        points = local_points()
        for origin in ORIGINS:
            if abs(origin[0]) > 84.0:
                continue
            geodetic = self.geodetic(origin, points)
            data, messages = run(
                cloud(points, origin=origin), TargetFrame=Transform.FRAME_UTM, MovePoints=True)
            self.assertEqual(messages.all(), [])
            zone = int(data.GetFieldData().GetArray("utm_zone").GetComponent(0, 0))
            self.assertEqual(zone < 0, origin[0] < 0.0)
            utm = f"+proj=utm +zone={abs(zone)}" + (" +south" if zone < 0 else "")
            theirs = cct(geodetic, TO_RADIANS, utm)
            self.assertLess(abs(coordinates(data) - theirs).max(), NANO_UTM, origin)

    def test_utm_near_the_poles_against_cct(self):
        # Outside of UTM proper the projection still holds: compared with PROJ's transverse Mercator.
        geodetic = np.array([[45.0, 89.9999, 0.0], [-135.0, 89.5, 10.0], [9.0, 90.0, 0.0]])
        data, messages = run(
            cloud(geodetic), SourceFrame=Transform.FRAME_GEODETIC, TargetFrame=Transform.FRAME_UTM, MovePoints=True,
            UTMZone=32)
        self.assertEqual(messages.all(), [])
        mercator = "+proj=tmerc +lat_0=0 +lon_0=9 +k_0=0.9996 +x_0=500000"
        self.assertLess(abs(coordinates(data) - cct(geodetic, TO_RADIANS, mercator)).max(), NANO_UTM)


class RoundTrips(unittest.TestCase):
    def test_every_pair_of_frames(self):
        # There and back: two conversions, so twice the tolerance.
        points = local_points()
        for origin in ORIGINS:
            for through in range(4):
                for end in range(4):
                    first, _ = run(cloud(points, origin=origin), TargetFrame=through, MovePoints=True)
                    second, _ = run(first, SourceFrame=through, TargetFrame=end, MovePoints=True)
                    third, messages = run(second, SourceFrame=end, TargetFrame=0, MovePoints=True)
                    self.assertEqual(messages.all(), [])
                    self.assertLess(abs(coordinates(third) - points).max(), 2.0 * NANO, (origin, through, end))

    def test_arrays_do_not_depend_on_the_source_frame(self):
        points = local_points()
        origin = ORIGINS[0]
        expected, _ = run(cloud(points, origin=origin))
        for frame in range(4):
            moved, _ = run(cloud(points, origin=origin), TargetFrame=frame, MovePoints=True)
            again, _ = run(moved, SourceFrame=frame)
            for name, scale in (("longitude", 111e3), ("latitude", 111e3), ("height", 1.0)):
                self.assertLess(abs(array(again, name) - array(expected, name)).max() * scale, 2.0 * NANO)


class Behaviour(unittest.TestCase):
    def test_defaults(self):
        t = Transform()
        self.assertEqual((t.GetSourceFrame(), t.GetTargetFrame()), (Transform.FRAME_ENU, Transform.FRAME_GEODETIC))
        self.assertEqual((t.GetMovePoints(), t.GetUseFieldDataOrigin(), t.GetUTMZone()), (False, True, 0))
        self.assertEqual(t.GetOrigin(), (0.0, 0.0, 0.0))

    def test_arrays_have_units_and_are_double(self):
        data, _ = run(cloud([[0.0, 0.0, 0.0]], origin=ORIGINS[0]))
        for name, unit in (("longitude", "deg"), ("latitude", "deg"), ("height", "m")):
            a = data.GetPointData().GetArray(name)
            self.assertEqual(a.GetDataType(), VTK_DOUBLE)
            self.assertEqual(a.GetInformation().Get(a.UNITS_LABEL()), unit)

    def test_given_origin_and_other_types_of_points(self):
        data, messages = run(
            cloud([[0.0, 0.0, 5.0]], vtkUnstructuredGrid), UseFieldDataOrigin=False, Origin=ORIGINS[0])
        self.assertEqual(messages.all(), [])
        self.assertIsInstance(data, vtkUnstructuredGrid)
        self.assertAlmostEqual(array(data, "latitude")[0], ORIGINS[0][0], places=12)
        self.assertAlmostEqual(array(data, "height")[0], ORIGINS[0][2] + 5.0, places=8)
        self.assertEqual(data.GetFieldData().GetArray("geodetic_origin").GetTuple3(0), ORIGINS[0])

    def test_origin_is_needed_only_where_it_is_used(self):
        _, messages = run(cloud([[EARTH, 0.0, 0.0]]), SourceFrame=Transform.FRAME_ECEF)
        self.assertEqual(messages.all(), [])
        data, messages = run(
            cloud([[500e3, 1e6, 0.0]]), SourceFrame=Transform.FRAME_UTM, UTMZone=-51)
        self.assertEqual(messages.all(), [])
        self.assertLess(array(data, "latitude")[0], -70.0)
        self.assertAlmostEqual(array(data, "longitude")[0], 123.0, places=12)

    def test_composite_takes_the_origin_of_the_whole(self):
        inner = vtkMultiBlockDataSet()
        inner.SetBlock(0, cloud([[1.0, 2.0, 3.0]], vtkUnstructuredGrid))
        scene = vtkMultiBlockDataSet()
        scene.SetBlock(0, cloud([[1.0, 2.0, 3.0]]))
        scene.SetBlock(1, None)
        scene.SetBlock(2, inner)
        add_origin(scene, ORIGINS[1])
        data, messages = run(scene, TargetFrame=Transform.FRAME_ECEF, MovePoints=True)
        self.assertEqual(messages.all(), [])
        first, second = data.GetBlock(0), data.GetBlock(2).GetBlock(0)
        np.testing.assert_array_equal(coordinates(first), coordinates(second))
        self.assertAlmostEqual(array(first, "longitude")[0], ORIGINS[1][1], places=3)
        self.assertEqual(scene.GetBlock(0).GetPoint(0), (1.0, 2.0, 3.0))

    def test_empty_input_is_silent(self):
        for empty in (vtkPolyData(), vtkMultiBlockDataSet()):
            _, messages = run(empty)
            self.assertEqual(messages.all(), [])

    def test_abort_leaves_an_empty_output(self):
        transform = Transform()
        transform.SetInputDataObject(cloud(np.zeros((100000, 3)), origin=ORIGINS[0]))
        seen = []

        def stop(caller, event):
            seen.append(transform.GetProgress())
            if transform.GetProgress() > 0.3:
                transform.SetAbortExecute(1)
        transform.AddObserver("ProgressEvent", stop)
        transform.Update()
        self.assertEqual(transform.GetOutputDataObject(0).GetNumberOfPoints(), 0)
        self.assertTrue(0.0 < min(x for x in seen if x) < 0.3)


class BadInput(unittest.TestCase):
    def check(self, text, data, **properties):
        output, messages = run(data, **properties)
        self.assertTrue(any(text in said for said in messages.errors), (text, messages.all()))
        self.assertEqual(output.GetNumberOfPoints(), 0)

    def test_every_kind(self):
        one = [[0.0, 0.0, 0.0]]
        given = dict(UseFieldDataOrigin=False)
        self.check("latitude is 91", cloud(one), Origin=(91.0, 0.0, 0.0), **given)
        self.check("latitude is -90.5", cloud(one, origin=(-90.5, 0.0, 0.0)))
        self.check("latitude is nan", cloud(one), Origin=(math.nan, 0.0, 0.0), **given)
        self.check("longitude is 400", cloud(one), Origin=(0.0, 400.0, 0.0), **given)
        self.check("height is inf", cloud(one), Origin=(0.0, 0.0, math.inf), **given)
        self.check("'geodetic_origin'", cloud(one))
        self.check("latitude (y) is 91", cloud([[0.0, 91.0, 0.0]]), SourceFrame=Transform.FRAME_GEODETIC)
        self.check("point 1 ", cloud([[0.0, 0.0, 0.0], [math.nan, 0.0, 0.0]], origin=ORIGINS[0]))
        self.check("not finite", cloud([[0.0, math.inf, 0.0]]), SourceFrame=Transform.FRAME_ECEF)
        self.check("easting", cloud([[5e6, 0.0, 0.0]]), SourceFrame=Transform.FRAME_UTM, UTMZone=31)
        self.check("easting", cloud([[80.0, 0.0, 0.0]]), SourceFrame=Transform.FRAME_GEODETIC,
                   TargetFrame=Transform.FRAME_UTM, MovePoints=True, UTMZone=31)
        self.check("UTMZone is 61", cloud(one, origin=ORIGINS[0]), UTMZone=61)
        self.check("SourceFrame is 4", cloud(one, origin=ORIGINS[0]), SourceFrame=4)
        self.check("TargetFrame -1", cloud(one, origin=ORIGINS[0]), TargetFrame=-1)

    def test_bad_blocks(self):
        scene = vtkMultiBlockDataSet()
        scene.SetBlock(0, vtkImageData())
        scene.GetMetaData(0).Set(scene.NAME(), "volume")
        self.check("'volume'", scene, UseFieldDataOrigin=False)
        scene.SetBlock(0, cloud([[math.nan, 0.0, 0.0]]))
        self.check("block 'volume'", scene, UseFieldDataOrigin=False)


if __name__ == "__main__":
    unittest.main()
