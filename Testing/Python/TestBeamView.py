# SPDX-License-Identifier: BSD-3-Clause
"""What a beam sees: closed forms, VTK's cell locator on the airport, movers, and what is refused."""
import math
import os
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkAppendPolyData

import avianlidar as al
import exampletools
from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarBeamView, vtkAvianLidarTracks
from echotools import Messages, array, scan

AIRPORT = os.path.join(exampletools.EXAMPLES, "airport", "scene", "hongqiao.lidarscene.json")
HALF = 5.6e-3  # rad
RAYS = 3000


def plate(x0, x1, distance, object_id, kd=0.5, z=40.0):
    """A plate across the direction north."""
    corners = [(x, distance, y) for x, y in ((x0, -z), (x1, -z), (x1, z), (x0, z))]
    data = al.mesh(corners, [(0, 1, 2), (0, 2, 3)])
    for name, value in (("kd", kd), ("ks", 0.0), ("kp", 1.0), ("object_id", object_id)):
        values = numpy_to_vtk(np.full(2, value, dtype=np.int32 if name == "object_id" else float), deep=True)
        values.SetName(name)
        data.GetCellData().AddArray(values)
    return data


def both(*plates):
    append = vtkAppendPolyData()
    for data in plates:
        append.AddInputData(data)
    append.Update()
    return append.GetOutput()


def north(**properties):
    """One beam, level to the north."""
    source = vtkAvianLidarBeamSource()
    source.SetNumberOfChannels(1)
    source.SetAzimuthRange(0, 1)
    source.SetAzimuthStep(1)
    for name, value in properties.items():
        getattr(source, "Set" + name)(value)
    return source


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
    return [{name: table.GetValueByName(i, name).ToString() if name in ("object", "material") else table.GetValueByName(i, name).ToDouble()
             for name in names} for i in range(table.GetNumberOfRows())]


def by_object(view, column):
    found = {}
    for row in rows(view):
        found[int(row["object_id"])] = found.get(int(row["object_id"]), 0.0) + row[column]
    return found


class ClosedForms(unittest.TestCase):
    def test_two_plates_halve_a_beam(self):
        for profile in (0, 1):
            view = look(north(BeamProfile=profile), both(plate(-40, 0, 100, 3, 0.6), plate(0, 40, 100, 4, 0.2)))
            for column, first in (("solid_angle_share", 0.5), ("energy_share", 0.75)):  # energy goes with the reflectance
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
        np.testing.assert_allclose(view.GetOutputDataObject(0).GetBounds(), (-radius, radius, 100, 100, -radius, radius), atol=2e-3 * radius)
        cone = view.GetOutputDataObject(1)
        self.assertEqual(cone.GetPoint(0), (0.0, 0.0, 0.0))
        self.assertAlmostEqual(cone.GetBounds()[3], 100.0, delta=0.01)
        echo = scan(wall, source, Noise=False)
        echo.Update()
        self.assertAlmostEqual(by_object(view, "energy_received")[3] / array(echo.GetOutput(), "return_energy")[0], 1.0, delta=1e-6)

    def test_slanted_plate(self):
        slanted = plate(-40, 40, 100, 3)
        for i in range(4):
            x, _, z = slanted.GetPoint(i)
            slanted.GetPoints().SetPoint(i, x, 100 + x, z)
        view = look(north(), slanted)
        np.testing.assert_allclose(vtk_to_numpy(view.GetOutputDataObject(0).GetCellData().GetArray("incidence_angle")), 45, atol=0.5)
        near, far = (100 / (math.cos(HALF) + s * math.sin(HALF)) for s in (1, -1))
        self.assertTrue(near < rows(view)[0]["nearest_m"] < 99.8 and 100.2 < rows(view)[0]["farthest_m"] < far)


class Airport(unittest.TestCase):
    def test_against_the_cell_locator(self):
        """The beams of mixed echoes: shares of the solid angle are those of rays that VTK follows."""
        scene = al.load_scene(AIRPORT)
        source = vtkAvianLidarBeamSource()
        source.SetPosition(0, 0, 3)
        seen = al.Scan(scene, al.Sensor("Airport16", position=(0, 0, 3)), noise=False)
        beams = np.array(seen["beam_id"])[np.argsort(seen["label_share"], kind="stable")]
        mesh = scene.tree.GetOutput()
        locator = vtkStaticCellLocator()
        locator.SetDataSet(mesh)
        locator.BuildLocator()
        objects = vtk_to_numpy(mesh.GetCellData().GetArray("object_id"))
        random = np.random.default_rng(1)
        found, view = 0, look(source, mesh)
        for beam in beams[:100]:
            view.SetBeamId(int(beam))
            view.Update()
            shares = by_object(view, "solid_angle_share")
            self.assertAlmostEqual(sum(shares.values()), 1.0, delta=1e-9)
            if found == 2 or len(shares) < 3:
                continue
            found += 1
            cone = view.GetOutputDataObject(1)
            ring = vtk_to_numpy(cone.GetPoints().GetData())[1:] - cone.GetPoint(0)
            axis = ring.mean(axis=0) / np.linalg.norm(ring.mean(axis=0))
            hits = rays_of(locator, np.array(cone.GetPoint(0)), axis, HALF, random, RAYS)
            for thing, share in shares.items():
                counted = np.count_nonzero(hits < 0) if thing == -1 else np.count_nonzero(objects[hits[hits >= 0]] == thing)
                error = 4 * math.sqrt(max(share * (1 - share), 1e-4) / RAYS) + 2e-3
                self.assertAlmostEqual(share, counted / RAYS, delta=error, msg=(beam, thing))
        self.assertEqual(found, 2)


def rays_of(locator, apex, axis, half, random, count):
    """The cells that rays, uniform in the solid angle of a cone, hit first; -1: none."""
    side = np.cross(axis, [0, 0, 1.0])
    side /= np.linalg.norm(side)
    up = np.cross(side, axis)
    cosine = 1 - random.random(count) * (1 - math.cos(half))
    turn = 2 * math.pi * random.random(count)
    sine = np.sqrt(1 - cosine**2)
    ways = cosine[:, None] * axis + sine[:, None] * (np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * up)
    found = np.full(count, -1)
    t, sub, cell, x, p = mutable(0.0), mutable(0), mutable(0), [0.0] * 3, [0.0] * 3
    for i, way in enumerate(ways):
        if locator.IntersectWithLine(apex, apex + 5000.0 * way, 0.0, t, x, p, sub, cell):
            found[i] = int(cell)
    return found


class Movers(unittest.TestCase):
    def test_a_bird_before_a_wall(self):
        tracks = vtkAvianLidarTracks()
        tracks.SetPatternToCircles()
        tracks.SetNumberOfBirds(40)
        tracks.SetCenter(0, 0, 0)
        tracks.SetRadius(60)
        tracks.SetHeights(3, 6)
        source = vtkAvianLidarBeamSource()
        source.SetPresetToSearch905()
        source.SetPosition(0, 0, 3)
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
            self.assertEqual([view.GetOutputDataObject(port).GetFieldData().GetArray("full_model").GetValue(0) for port in range(3)], [wanted] * 3)

    def test_a_beam_that_is_not_there(self):
        for beam in (1, -1):
            view = look(north(), plate(-40, 40, 100, 3))
            said = Messages(view)
            view.SetBeamId(beam)
            view.Update()
            self.assertIn(f"BeamId is {beam}, expected the beam_id of a beam of input port 0 (beams)", said.errors[0])
            self.assertEqual(view.GetOutputDataObject(2).GetNumberOfRows(), 0)


if __name__ == "__main__":
    unittest.main()
