# SPDX-License-Identifier: BSD-3-Clause
"""Polygons of every shape keep their area on every path to the collision tree: keyholes, outlines that touch
themselves, concave and degenerate polygons, in any plane. Expected areas: sums of the trapezoids of the rings from
which a polygon is made."""
import math
import pathlib
import time

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import scenetools as st
from avianlidar import vtkAvianLidar as al
from echotools import InFolder, Messages, output, painted

COUNT = 150
# with a window: 1088 m2
WALL = [(-20, 0), (20, 0), (20, 30), (-20, 30), (-20, 0), (-8, 5), (-8, 12), (8, 12), (8, 5), (-8, 5)]
PINCH = [(-20, 0), (20, 0), (20, 30), (0, 0), (-20, 30)]  # a corner on the first edge: 600 m2
BOW = [(0, 0), (4, 4), (4, 0), (0, 4)]  # crosses itself: two triangles of 4 m2


def shoelace(ring):
    x, y = np.transpose(ring)
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


def star(random, corners, centre, near, far, angle=0.0):
    """A ring around a centre that is seen from everywhere, with a corner of the greatest distance at an angle."""
    angles = angle + 2 * np.pi * (np.arange(corners) + np.r_[0, random.uniform(-0.4, 0.4, corners - 1)]) / corners
    radii = np.r_[far, random.uniform(near, far, corners - 1)]
    return centre + (radii * [np.cos(angles), np.sin(angles)]).T


def keyhole(random):
    """A ring with one to three holes, each reached by a bridge, and its area."""
    ring, area = [], 0.0
    holes = random.integers(1, 4)
    for k in range(holes):
        angle, step = 2 * np.pi * k / holes, 2 * np.pi / holes
        to = np.array([math.cos(angle), math.sin(angle)])
        hole = star(random, random.integers(3, 9), 5 * to, 0.3, 2, angle)
        ring += [12 * to, *np.vstack([hole, hole[:1]])[::-1], 12 * to]
        area -= shoelace(hole)
        number = 8 // holes + random.integers(1, 5)
        between = angle + step * (np.arange(1, number) + random.uniform(-0.3, 0.3, number - 1)) / number
        ring += list((random.uniform(9, 13, len(between)) * [np.cos(between), np.sin(between)]).T)
    outer = [p for i, p in enumerate(ring) if np.hypot(*p) > 8.5]
    return np.array(ring), area + shoelace(outer)


def pinched(random):
    """A convex ring with a notch whose tip lies on another edge or corner, and its area."""
    angles = np.sort(random.uniform(0, 2 * np.pi, random.integers(4, 12)))
    ring = np.array([8 * np.cos(angles), 5 * np.sin(angles)]).T
    k = random.integers(2, len(ring) - 1)
    tip = ring[0] + random.choice([0.0, 0.5, random.uniform()]) * (ring[1] - ring[0])
    return np.insert(ring, k + 1, tip, axis=0), shoelace(ring) - abs(shoelace([ring[k], tip, ring[k + 1]]))


def concave(random):
    ring = star(random, random.integers(4, 30), np.zeros(2), 1, 10)
    return ring, shoelace(ring)


def placed(random, ring, warp=0.0):
    """A ring in a plane of any direction, with points out of the plane by up to `warp`; equal points move together."""
    axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
    known, numbers = np.unique(ring, axis=0, return_inverse=True)
    offset = random.uniform(-warp, warp, len(known))[numbers.ravel()]
    return np.column_stack([ring, offset]) @ axes + random.uniform(-1000, 1000, 3)


def poly_data(rings, share=True, single=False):
    """Polygons as vtkPolyData, with an object id for each. @param share whether equal points have one id"""
    points = np.concatenate(rings)
    ids = np.arange(len(points))
    if share:
        points, ids = np.unique(points, axis=0, return_inverse=True)
    data, cells, places = vtk.vtkPolyData(), vtk.vtkCellArray(), vtk.vtkPoints()
    places.SetData(numpy_to_vtk(points.astype(np.float32 if single else float), deep=True))
    offsets = np.cumsum([0, *map(len, rings)])
    cells.SetData(*(vtk.util.numpy_support.numpy_to_vtkIdTypeArray(np.ascontiguousarray(numbers, dtype=np.int64),
                                                                   deep=True) for numbers in (offsets, ids.ravel())))
    data.SetPoints(places)
    data.SetPolys(cells)
    numbers = numpy_to_vtk(np.arange(len(rings), dtype=np.int32), deep=True)
    numbers.SetName("object_id")
    data.GetCellData().AddArray(numbers)
    return data


def tree_of(surfaces):
    tree = al.vtkAvianLidarCollisionTree()
    heard = Messages(tree)
    tree.SetInputDataObject(surfaces)
    return output(tree), [text for text in heard.all() if "cell arrays" not in text or "Also, " in text]


def areas_of(surfaces, count):
    """Area of the triangles of each polygon."""
    out, said = tree_of(surfaces)
    return np.bincount(st.cells(out, "object_id"), st.areas(st.corners(out)), minlength=count), said


class PolygonFiles(InFolder):
    def test_areas_in_any_plane(self):
        for make in (keyhole, pinched, concave):
            for share, single, warp, tolerance in ((True, False, 0, 1e-7), (False, False, 0, 1e-7),
                                                   (True, False, 1e-3, 1e-3), (False, True, 0, 2e-3)):
                with self.subTest(make=make.__name__, share=share, single=single, warp=warp):
                    random = np.random.default_rng(5)
                    rings, expected = zip(*(make(random) for _ in range(COUNT)))
                    found, said = areas_of(poly_data([placed(random, ring, warp) for ring in rings], share, single),
                                           COUNT)
                    np.testing.assert_allclose(found, expected, rtol=tolerance)
                    self.assertEqual(said, [])

    def test_triangles_lie_inside(self):
        """Centres of triangles are inside by the parity of the edges beyond them, and the normal is that of the
        polygon."""
        random = np.random.default_rng(6)
        for ring, _ in (make(random) for make in (keyhole, pinched, concave) for _ in range(COUNT)):
            triangles = st.corners(tree_of(poly_data([np.column_stack([ring, 0 * ring])[:, :3]]))[0])
            self.assertTrue((st.normals(triangles)[:, 2] > -1e-12).all())
            centres = triangles[st.areas(triangles) > 1e-9].mean(axis=1)[:, None, :2]
            start, end = ring[None], np.roll(ring, -1, axis=0)[None]
            crosses = (start[..., 1] > centres[..., 1]) != (end[..., 1] > centres[..., 1])
            with np.errstate(divide="ignore", invalid="ignore"):
                x = start[..., 0] + (centres[..., 1] - start[..., 1]) / (end - start)[..., 1] * (end - start)[..., 0]
            self.assertTrue(((crosses & (centres[..., 0] < x)).sum(axis=1) % 2 == 1).all())

    def test_quadrilaterals_have_the_shorter_diagonal_inside(self):
        arrow = np.array([(0, 0, 0), (4, 1, 0), (1, 1, 0), (1, 4, 0)], dtype=float)
        flat = np.array([(0, 0, 0), (6, 1, 0), (10, 0, 0), (4, -1, 0)], dtype=float)
        for turn in range(4):
            found, said = areas_of(poly_data([np.roll(arrow, turn, axis=0), np.roll(flat, turn, axis=0) + [20, 0, 0]]),
                                   2)
            np.testing.assert_allclose(found, [3, 10], rtol=1e-12)
            triangles = st.corners(tree_of(poly_data([np.roll(flat, turn, axis=0)]))[0])
            self.assertEqual([len(np.unique(triangles[..., 0])), sum(4 in t[:, 0] and 6 in t[:, 0] for t in triangles),
                              said], [4, 2, []])

    def test_degenerate_polygons(self):
        """Repeated points change nothing; polygons without area give nothing; what crosses itself is named."""
        flat = [np.column_stack([ring, np.zeros(len(ring))]).astype(float)
                for ring in ([(0, 0)] * 6, [(0, 0), (1, 1), (2, 2), (3, 3), (1, 1)],
                             [(0, 0), (4, 0), (4, 0), (4, 3), (0, 3), (0, 0)], [(0, 0), (4, 0), (4, 3), (4, 3)],
                             [(0, 0), (4, 0), (9, 0), (4, 0), (4, 3), (0, 3)], BOW, [*PINCH[:4], (30, 10)])]
        found, said = areas_of(poly_data(flat), len(flat))
        np.testing.assert_allclose(found[:6], [0, 0, 12, 6, 12, 8], atol=1e-12)
        self.assertEqual(len(said), 1)
        self.assertIn("2 polygons (cells 5, 6) cross or overlap themselves: the areas of the outline and of the "
                      "triangles of the first polygon differ by 100 % of the larger area. What", said[0])
        broken = np.vstack([flat[2][:-1], [np.nan, 0, 0]])
        self.assertIn("has a coordinate that is not finite", tree_of(poly_data([broken]))[1][0])

    def test_cell_arrays_follow_lines_polygons_and_strips(self):
        data = poly_data([np.column_stack([WALL, np.zeros(10)]).astype(float)])
        data.GetCellData().Initialize()
        for name, number in (("SetVerts", 1), ("SetLines", 2), ("SetStrips", 5)):
            cells = vtk.vtkCellArray()
            cells.InsertNextCell(number, range(number))
            getattr(data, name)(cells)
        data.BuildCells()
        numbers = numpy_to_vtk(np.array([7, 8, 9, 10], dtype=np.int32), deep=True)
        numbers.SetName("material_id")
        data.GetCellData().AddArray(numbers)
        numbers = numpy_to_vtk(np.arange(4, dtype=np.int32), deep=True)
        numbers.SetName("object_id")
        data.GetCellData().AddArray(numbers)
        out, said = tree_of(data)
        self.assertEqual((np.bincount(st.cells(out, "object_id")).tolist(), said), ([0, 0, 8, 3], []))

    def test_files(self):
        """The same wall, outline and crossing polygon through each kind of file."""
        rings = [np.column_stack([[x for x, _ in ring], [50] * len(ring), [z for _, z in ring]]).astype(float)
                 + [100 * i, 0, 0] for i, ring in enumerate((WALL, PINCH, BOW))]
        data = poly_data(rings)
        grid = vtk.vtkUnstructuredGrid()
        grid.Allocate(4)
        grid.SetPoints(data.GetPoints())
        grid.InsertNextCell(vtk.VTK_VERTEX, 1, [0])
        for i in range(3):
            ids = vtk.vtkIdList()
            data.GetCellPoints(i, ids)
            grid.InsertNextCell(vtk.VTK_POLYGON, ids)
        for writer, name, given in (
                (vtk.vtkXMLPolyDataWriter(), "a.vtp", data), (vtk.vtkPolyDataWriter(), "a.vtk", data),
                (vtk.vtkXMLUnstructuredGridWriter(), "a.vtu", grid), (vtk.vtkPLYWriter(), "a.ply", data)):
            writer.SetFileName(name)
            writer.SetInputData(given)
            if name in ("a.vtp", "a.vtu"):
                writer.SetDataModeToBinary()
            writer.Write()
        text = "".join(f"v {x} {y} {z}\n" for ring in rings for x, y, z in ring)
        number = iter(range(1, 100))
        pathlib.Path("a.obj").write_text(
            text + "".join("f " + " ".join(str(next(number)) for _ in ring) + "\n" for ring in rings), "utf-8")
        for name, what in (("a.vtp", "cell 2"), ("a.vtk", "cell 2"), ("a.vtu", "cell 3"), ("a.ply", "face 2"),
                           ("a.obj", "face 2")):
            with self.subTest(file=name):
                scene = st.Read(st.write_scene(".", "scene",
                                               {"version": 1, "objects": [{"file": name, "material": "Wall"}]}))
                triangles = st.corners(scene.blocks[0])
                number = ((triangles[..., 0].mean(axis=1) + 50) // 100).astype(int)
                np.testing.assert_allclose(np.bincount(number, st.areas(triangles)), [1088, 600, 8], rtol=1e-6)
                self.assertEqual((len(scene.warnings), scene.errors), (1, []))
                self.assertIn(f"polygon ({what}) crosses or overlaps itself: the areas of the outline and of the "
                              "triangles of the first polygon differ by 100 % of the larger area. What",
                              scene.warnings[0])

    def test_movers_and_media(self):
        """A mover with a bow is named; a medium whose closed surface has keyholes is filled."""
        bow = painted(poly_data([np.column_stack([BOW, np.zeros(4)]).astype(float)]), "Wall")
        echoes = al.vtkAvianLidarEchoFilter()
        heard = Messages(echoes)
        beams = al.vtkAvianLidarBeamSource()
        echoes.SetInputConnection(0, beams.GetOutputPort())
        echoes.SetInputDataObject(1, vtk.vtkMultiBlockDataSet())
        pose = numpy_to_vtk(np.array([[0.0, 50, 0]]), deep=True)
        pose.SetName("pose_position")
        bow.GetFieldData().AddArray(pose)
        echoes.SetInputDataObject(2, bow)
        echoes.Update()
        self.assertIn("movers), surfaces: polygon (cell 0) crosses or overlaps itself", " ".join(heard.all()))

        outer, inner = [(0, 0), (6, 0), (6, 6), (0, 6)], [(2, 2), (2, 4), (4, 4), (4, 2)]
        frame = [*outer, outer[0], *inner, inner[0]]
        walls = [[(*a, 0), (*b, 0), (*b, 1), (*a, 1)] for ring in (outer, inner)
                 for a, b in zip(ring, ring[1:] + ring[:1])]
        rings = [np.array(ring, dtype=float)
                 for ring in ([(x, y, 1) for x, y in frame], [(x, y, 0) for x, y in frame[::-1]], *walls)]
        medium = al.vtkAvianLidarMedium()
        heard = Messages(medium)
        medium.SetInputDataObject(poly_data(rings))
        medium.SetShapeToSurface()
        out = output(medium)
        self.assertEqual(heard.all(), [])
        triangles = vtk_to_numpy(out.GetPoints().GetData())[vtk_to_numpy(
                                                                out.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
        self.assertAlmostEqual(st.volume(triangles.astype(float)), 32.0, places=9)

    def test_many_corners_take_seconds(self):
        """A ring of 1e5 corners around a hole of 1e5 corners."""
        angles = 2 * np.pi * np.arange(100000) / 100000
        circle = np.array([np.cos(angles), np.sin(angles)]).T
        ring = np.concatenate([10 * circle, [[10, 0]], [[4, 0]], 4 * circle[::-1]])
        start = time.process_time()
        found, said = areas_of(poly_data([np.column_stack([ring, 3 * ring[:, :1]])]), 1)
        self.assertLess(time.process_time() - start, 20)
        self.assertEqual(said, [])
        np.testing.assert_allclose(found, math.sqrt(10) * (shoelace(10 * circle) - shoelace(4 * circle)), rtol=1e-9)
