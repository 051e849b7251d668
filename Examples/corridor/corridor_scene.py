# SPDX-License-Identifier: BSD-3-Clause
"""The small scene of paper, Sec. 5.2, built as geometry: a corridor with a wooden door with a window and a hydrant
cabinet of glass at its near end, a bulletin board of acrylic (which reflects like glass), and a stairwell with a metal
handrail. The paper gives no measures; these are ours. Metres; x runs along the corridor to the east, y across it to
the north, z up from the floor."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkTriangleFilter, vtkTubeFilter

from avianlidar.vtkAvianLidar import vtkAvianLidarMaterial

LIDAR = (0.0, 0.0, 1.3)  # 1.2 m from both walls
WEST, EAST, SIDE, CEILING = -3.5, 24.0, 1.2, 2.8
STAIRWELL = (-0.6, 2.0, -5.2, 4.5)  # from x, to x, to y, ceiling
INNER = (0.6, 0.8)  # x between the two flights
STEPS, DEPTH, RISE = 9, 0.28, 0.165

# Pattern of block names and material, the later ones win (paper, Table 1).
MATERIALS = (("*", "Wall"), ("Door*", "Wood"), ("Window*", "Glass"), ("Hydrant cabinet", "Glass"),
             ("Bulletin board", "Glass"), ("Handrail*", "Metal"))


def quads(corners):
    """Surfaces of n quadrangles from n x 4 x 3 coordinates; corners in one place are one point."""
    data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    places, number = np.unique(np.array(corners, dtype=float).reshape(-1, 3), axis=0, return_inverse=True)
    points.SetData(numpy_to_vtk(places, deep=True))
    for quad in number.reshape(-1, 4):
        cells.InsertNextCell(4, quad)
    data.SetPoints(points)
    data.SetPolys(cells)
    return data


def panel(place, size, openings=()):
    """An upright rectangle with rectangular openings. `place(u, z)` says where it stands, `size` is (u0, u1, z0, z1),
    like each opening. It is cut along all their sides, so that it and what fills an opening share whole edges."""
    boxes = [size, *openings]
    us = np.unique([u for box in boxes for u in box[:2]])
    zs = np.unique([z for box in boxes for z in box[2:]])
    cells = []
    for u0, u1 in zip(us[:-1], us[1:]):
        for z0, z1 in zip(zs[:-1], zs[1:]):
            if not any(a <= u0 and u1 <= b and c <= z0 and z1 <= d for a, b, c, d in openings):
                cells.append([place(u0, z0), place(u1, z0), place(u1, z1), place(u0, z1)])
    return quads(cells)


def box(x0, x1, y0, y1, z0, z1):
    corner = [[(x0, x1)[i & 1], (y0, y1)[i >> 1 & 1], (z0, z1)[i >> 2]] for i in range(8)]
    sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return [[corner[i] for i in side] for side in sides]


def level(x0, x1, y0, y1, z):
    return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]


def tube(*places, radius=0.025):
    """A round bar along a polyline."""
    line, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    for place in places:
        points.InsertNextPoint(*place)
    cells.InsertNextCell(len(places), range(len(places)))
    line.SetPoints(points)
    line.SetLines(cells)
    bar = vtkTubeFilter()
    bar.SetInputData(line)
    bar.SetRadius(radius)
    bar.SetNumberOfSides(12)
    bar.CappingOn()
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(bar.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def near_end():
    """The end wall west of the lidar, faced by it: door, window in the door, hydrant cabinet."""
    def place(y, z):
        return WEST, y, z

    door, window, cabinet = (-0.6, 0.6, 0, 2.1), (-0.15, 0.15, 1.6, 1.95), (0.7, 1.05, 0.7, 1.6)
    return {"Near end": panel(place, (-SIDE, SIDE, 0, CEILING), [door, cabinet]),
            "Door": panel(place, door, [window]), "Window of the door": panel(place, window),
            "Hydrant cabinet": panel(place, cabinet)}


def long_walls():
    """North wall with the bulletin board; south wall with the way to the stairs and two doors."""
    def north(x, z):
        return x, SIDE, z

    def south(x, z):
        return x, -SIDE, z

    board, stairs = (1.0, 3.2, 0.9, 1.9), (*STAIRWELL[:2], 0, 2.4)
    doors = [(6.0, 7.0, 0, 2.1), (12.0, 13.0, 0, 2.1)]
    return {"North wall": panel(north, (WEST, EAST, 0, CEILING), [board]), "Bulletin board": panel(north, board),
            "South wall": panel(south, (WEST, EAST, 0, CEILING), [stairs, *doors]),
            "Door at 6 m": panel(south, doors[0]), "Door at 12 m": panel(south, doors[1]),
            "Far end": panel(lambda y, z: (EAST, y, z), (-SIDE, SIDE, 0, CEILING)),
            "Floor": quads([level(WEST, EAST, -SIDE, SIDE, 0)]),
            "Ceiling": quads([level(WEST, EAST, -SIDE, SIDE, CEILING)])}


def stairs():
    """One flight up away from the corridor, a landing, one flight back up above it."""
    x0, x1, y1, top = STAIRWELL
    start, landing = -1.7, STEPS * RISE
    end = start - STEPS * DEPTH
    steps = []
    for i in range(STEPS):
        y = start - i * DEPTH
        steps += box(INNER[1], x1, y - DEPTH, y, 0, (i + 1) * RISE)
        y = end + i * DEPTH
        steps += box(x0, INNER[0], y, y + DEPTH, landing + i * RISE - 0.15, landing + (i + 1) * RISE)
    steps += box(x0, x1, y1, end, landing - 0.15, landing)
    walls = quads([[(x0, -SIDE, 0), (x0, y1, 0), (x0, y1, top), (x0, -SIDE, top)],
                   [(x1, -SIDE, 0), (x1, y1, 0), (x1, y1, top), (x1, -SIDE, top)],
                   [(x0, y1, 0), (x1, y1, 0), (x1, y1, top), (x0, y1, top)],
                   level(x0, x1, y1, -SIDE, 0), level(x0, x1, y1, -SIDE, top),
                   [(x0, -SIDE, CEILING), (x1, -SIDE, CEILING), (x1, -SIDE, top), (x0, -SIDE, top)]])
    return {"Steps": quads(steps), "Stairwell": walls, **handrail(start, end, landing)}


def handrail(start, end, landing, height=0.95):
    """Along the inner sides of both flights, with a post on every second step."""
    left, right = INNER
    parts = {"Handrail": tube((right, start, height + RISE), (right, end, landing + height),
                              (left, end, landing + height), (left, start, 2 * landing + height))}
    for i in range(0, STEPS, 2):
        y, step = start - (i + 0.5) * DEPTH, (i + 1) * RISE
        parts[f"Handrail post {i // 2 + 1}"] = tube((right, y, step), (right, y, step + height + 0.05), radius=0.015)
    return parts


def build():
    """The scene as one block per object, with names and materials."""
    scene = vtkMultiBlockDataSet()
    for i, (name, surfaces) in enumerate({**near_end(), **long_walls(), **stairs()}.items()):
        scene.SetBlock(i, surfaces)
        scene.GetMetaData(i).Set(scene.NAME(), name)
    return painted(scene, MATERIALS)


def painted(scene, materials):
    """Blocks with their materials. @param materials patterns of names, each with its material, the later ones win"""
    for pattern, material in materials:
        painter = vtkAvianLidarMaterial()
        painter.SetInputData(scene)
        painter.SetBlockNamePattern(pattern)
        getattr(painter, "SetMaterialTo" + material)()
        painter.Update()
        scene = painter.GetOutputDataObject(0)
    return scene


def names(scene):
    return [scene.GetMetaData(i).Get(scene.NAME()) for i in range(scene.GetNumberOfBlocks())]
