# SPDX-License-Identifier: BSD-3-Clause
"""What a beam sees: closed forms, movers, and what is refused. Shares of many triangles are TestVisiblePolygons's
(kernel)."""
import math
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkAppendPolyData

import avianlidar as al
from avianlidar._cloud import add_array
from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarBeamView, vtkAvianLidarTracks
from echotools import Messages, array, given, output, scan

HALF = 5.6e-3  # rad


def plate(x0, x1, distance, object_id, kd=0.5, z=40.0):
    """A plate across the direction north."""
    corners = [(x, distance, y) for x, y in ((x0, -z), (x1, -z), (x1, z), (x0, z))]
    data = al.mesh(corners, [(0, 1, 2), (0, 2, 3)])
    for name, value in (("kd", kd), ("ks", 0.0), ("kp", 1.0), ("object_id", object_id)):
        add_array(data.GetCellData(), name, np.full(2, value, dtype=np.int32 if name == "object_id" else float))
    return data


def both(*plates):
    append = vtkAppendPolyData()
    for data in plates:
        append.AddInputData(data)
    return output(append)


def north(**properties):
    """One beam, level to the north."""
    return given(vtkAvianLidarBeamSource(), NumberOfChannels=1, AzimuthRange=(0, 1), AzimuthStep=1, **properties)


def look(source, surfaces, beam=0, movers=None):
    view = vtkAvianLidarBeamView()
    view.SetInputConnection(0, source.GetOutputPort())
    view.SetInputDataObject(1, surfaces)
    if movers:
        view.SetInputConnection(2, movers.GetOutputPort())
    view.SetBeamId(beam)
    view.Update()
    return view


def rows(view):
    """The table: {object_id: {column: value}}, summed shares by object."""
    table = view.GetOutputDataObject(2)
    names = [table.GetColumnName(i) for i in range(table.GetNumberOfColumns())]
    return [{name: table.GetValueByName(i, name).ToString() if name in ("object", "material")
             else table.GetValueByName(i, name).ToDouble() for name in names} for i in range(table.GetNumberOfRows())]


def by_object(view, column):
    found = {}
    for row in rows(view):
        found[int(row["object_id"])] = found.get(int(row["object_id"]), 0.0) + row[column]
    return found


class ClosedForms(unittest.TestCase):
    def test_two_plates_halve_a_beam(self):
        for profile in (0, 1):
            view = look(north(BeamProfile=profile), both(plate(-40, 0, 100, 3, 0.6), plate(0, 40, 100, 4, 0.2)))
            # energy goes with the reflectance
            for column, first in (("solid_angle_share", 0.5), ("energy_share", 0.75)):
                shares = by_object(view, column)
                self.assertAlmostEqual(shares[3], first, delta=1e-5)
                self.assertAlmostEqual(sum(shares.values()), 1.0, delta=1e-12)
            table = rows(view)
            self.assertEqual([row["object_id"] for row in table], [3, 4, -1])
            self.assertEqual(table[-1]["object"], "no surface")
            self.assertAlmostEqual(table[0]["distance_m"], 100.0, delta=0.01)

    def test_sky(self):
        view = look(north(), plate(-40, 0, 100, 3))
        self.assertAlmostEqual(by_object(view, "solid_angle_share")[-1], 0.5, delta=1e-6)
        self.assertEqual(by_object(view, "energy_share"), {3: 1.0, -1: 0.0})
        view = look(north(), plate(-40, 0, -100, 3))
        self.assertEqual([(row["object"], row["solid_angle_share"]) for row in rows(view)], [("no surface", 1.0)])
        self.assertEqual(view.GetOutputDataObject(0).GetNumberOfCells(), 0)
        self.assertAlmostEqual(view.GetOutputDataObject(1).GetBounds()[3], 1000.0, delta=0.1)

    def test_what_is_seen_lies_in_the_cone_and_has_the_energy_of_the_echo(self):
        source, wall, radius = north(), plate(-40, 40, 100, 3), 100 * math.tan(HALF)
        view = look(source, wall)
        np.testing.assert_allclose(view.GetOutputDataObject(0).GetBounds(),
                                   (-radius, radius, 100, 100, -radius, radius), atol=2e-3 * radius)
        cone = view.GetOutputDataObject(1)
        self.assertEqual(cone.GetPoint(0), (0.0, 0.0, 0.0))
        self.assertAlmostEqual(cone.GetBounds()[3], 100.0, delta=0.01)
        echo = scan(wall, source, Noise=False)
        echo.Update()
        self.assertAlmostEqual(by_object(view, "energy_received")[3] / array(echo.GetOutput(), "return_energy")[0], 1.0,
                               delta=1e-6)

    def test_slanted_plate(self):
        slanted = plate(-40, 40, 100, 3)
        for i in range(4):
            x, _, z = slanted.GetPoint(i)
            slanted.GetPoints().SetPoint(i, x, 100 + x, z)
        view = look(north(), slanted)
        np.testing.assert_allclose(vtk_to_numpy(view.GetOutputDataObject(0).GetCellData().GetArray("incidence_angle")),
                                   45, atol=0.5)
        near, far = (100 / (math.cos(HALF) + s * math.sin(HALF)) for s in (1, -1))
        self.assertTrue(near < rows(view)[0]["nearest_m"] < 99.8 and 100.2 < rows(view)[0]["farthest_m"] < far)


class Movers(unittest.TestCase):
    def test_a_bird_before_a_wall(self):
        tracks = given(vtkAvianLidarTracks(), NumberOfBirds=40, Center=(0, 0, 0), Radius=60, Heights=(3, 6))
        tracks.SetPatternToCircles()
        source = given(vtkAvianLidarBeamSource(), Position=(0, 0, 3))
        source.SetPresetToSearch905()
        wall = plate(-900, 900, 500, 3, z=200)
        echoes = scan(wall, source)
        echoes.SetInputConnection(2, tracks.GetOutputPort())
        echoes.Update()
        objects = array(echoes.GetOutput(), "object_id")
        birds = np.flatnonzero(objects > 3)
        self.assertGreater(len(birds), 3)
        for i in birds[:3]:
            view = look(source, wall, int(array(echoes.GetOutput(), "beam_id")[i]), tracks)
            self.assertGreater(by_object(view, "energy_received")[objects[i]], 0)
            self.assertAlmostEqual(sum(by_object(view, "solid_angle_share").values()), 1.0, delta=1e-9)


class Settings(unittest.TestCase):
    def test_full_model_is_what_was_set(self):
        view = look(north(), plate(-40, 40, 100, 3))
        for wanted in (False, True):
            view.SetFullModel(wanted)
            view.Update()
            self.assertEqual([view.GetOutputDataObject(port).GetFieldData().GetArray("full_model").GetValue(0)
                              for port in range(3)], [wanted] * 3)

    def test_a_beam_that_is_not_there(self):
        for beam in (1, -1):
            view = look(north(), plate(-40, 40, 100, 3))
            said = Messages(view)
            view.SetBeamId(beam)
            view.Update()
            self.assertIn(f"BeamId is {beam}, expected the beam_id of a beam of input port 0 (beams)", said.errors[0])
            self.assertEqual(view.GetOutputDataObject(2).GetNumberOfRows(), 0)
