# SPDX-License-Identifier: BSD-3-Clause
"""Random surfaces: boxes, walls, soups, strips, concave polygons, small and degenerate ones, in any composition."""

import math

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

NAME = vtk.vtkCompositeDataSet.NAME()


def add_cells(data, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.GetCellData().AddArray(array)
    return array


def add_names(data, name, values):
    array = vtk.vtkStringArray()
    array.SetName(name)
    for value in values:
        array.InsertNextValue(value)
    data.GetFieldData().AddArray(array)


def polydata(points, cells, double=True):
    data = vtk.vtkPolyData()
    holder = vtk.vtkPoints()
    holder.SetDataType(vtk.VTK_DOUBLE if double else vtk.VTK_FLOAT)
    for point in points:
        holder.InsertNextPoint(*point)
    polygons = vtk.vtkCellArray()
    for cell in cells:
        polygons.InsertNextCell(len(cell), cell)
    data.SetPoints(holder)
    data.SetPolys(polygons)
    return data


def place(r):
    angle, distance = 2 * math.pi * r.random(), r.choice((8, 30, 60, 120)) * (0.5 + r.random())
    return np.array([distance * math.sin(angle), distance * math.cos(angle), r.uniform(-3, 12)])


def _box(r):
    c, h = place(r), np.array([r.uniform(0.3, 8) for _ in range(3)])
    corners = [c + h * np.array([x, y, z]) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return corners, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def _wall(r):
    c = place(r)
    along, up = np.array([r.gauss(0, 20), r.gauss(0, 20), r.gauss(0, 1)]), np.array([0, 0, r.uniform(5, 30)])
    return [c - along, c + along, c + along + up, c - along + up], [[0, 1, 2, 3]]


def _ground(r):
    n, size, z = r.randint(1, 4), r.choice((40.0, 300.0)), r.uniform(-5, -1)
    points = [(size * (2 * i / n - 1), size * (2 * j / n - 1), z) for j in range(n + 1) for i in range(n + 1)]
    return points, [[j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i]
                    for j in range(n) for i in range(n)]


def _soup(r):
    c, n = place(r), r.randint(1, 20)
    points = [c + np.array([r.gauss(0, 4) for _ in range(3)]) for _ in range(3 * n)]
    return points, [[3 * i, 3 * i + 1, 3 * i + 2] for i in range(n)]


def _concave(r):
    c, s = place(r), r.uniform(1, 8)
    away = np.array([-c[1], c[0], 0.0]) / max(1e-9, math.hypot(c[0], c[1]))
    flat = ((0, 0), (4, 0), (4, 4), (2, 1), (0, 4))
    return [c + s * (u * away + np.array([0, 0, v])) for u, v in flat], [[0, 1, 2, 3, 4]]


def _small(r):
    c, s = place(r), r.uniform(0.01, 0.3)
    return [c, c + (s, 0, 0), c + (0, s, 0), c + (0, 0, s)], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]


def _degenerate(r):
    points, cells = _soup(r)
    points[1] = points[0]
    return points, cells + [[0, 0, 0], [0, 1, 2]]


def leaf(r):
    """One object of any kind, with or without arrays, which may be strips."""
    shape = r.choice((_box, _box, _wall, _ground, _soup, _soup, _concave, _small, _degenerate))
    data = polydata(*shape(r), double=r.random() < 0.7)
    if r.random() < 0.5:
        data = triangulated(data)
    if r.random() < 0.15:
        data = stripped(data)
    if r.random() < 0.1:
        verts = vtk.vtkCellArray()
        verts.InsertNextCell(1, [0])
        data.SetVerts(verts)
    if r.random() < 0.75:
        paint(r, data)
    return data


def triangulated(data):
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(data)
    triangles.Update()
    return triangles.GetOutput()


def stripped(data):
    strips = vtk.vtkStripper()
    strips.SetInputData(data)
    strips.Update()
    copy = vtk.vtkPolyData()
    copy.CopyStructure(strips.GetOutput())
    return copy


def coefficients(r, count):
    kd = np.array([r.uniform(0, 0.5) for _ in range(count)])
    ks = np.array([r.choice((0.0, 0.05, 0.45)) for _ in range(count)])
    kp = np.array([r.choice((0.0, 1.0, 112.0, 8046.0)) for _ in range(count)])
    return kd, ks, kp


def paint(r, data):
    """Coefficients, and often ids and names."""
    count = data.GetNumberOfCells()
    kind = r.choice((np.float64, np.float64, np.float32))
    for name, values in zip(("kd", "ks", "kp"), coefficients(r, count)):
        add_cells(data, name, values.astype(kind))
    if r.random() < 0.6:
        add_cells(data, "material_id", np.array([r.randint(0, 3) for _ in range(count)], dtype=np.int32))
        add_names(data, "material_names", [f"m{i}" for i in range(4)])
    if r.random() < 0.5:
        objects = r.randint(1, 3)
        add_cells(data, "object_id", np.array([i % objects for i in range(count)], dtype=np.int32))
        if r.random() < 0.5:
            add_names(data, "object_names", [f"o{r.randint(0, 99)}" for _ in range(objects)])


def scene(r):
    """A vtkPolyData, or blocks of it, some nested, empty or missing."""
    if r.random() < 0.25:
        return leaf(r)
    blocks = vtk.vtkMultiBlockDataSet()
    for i in range(r.randint(1, 8)):
        kind = r.random()
        if kind < 0.06:
            blocks.SetBlock(i, None)
        elif kind < 0.12:
            blocks.SetBlock(i, vtk.vtkPolyData())
        elif kind < 0.2:
            nested = vtk.vtkMultiBlockDataSet()
            for j in range(r.randint(0, 3)):
                nested.SetBlock(j, leaf(r))
                nested.GetMetaData(j).Set(NAME, f"inner {j}")
            blocks.SetBlock(i, nested)
        else:
            blocks.SetBlock(i, leaf(r))
        if r.random() < 0.8:
            blocks.GetMetaData(i).Set(NAME, f"block {i}")
    return blocks
