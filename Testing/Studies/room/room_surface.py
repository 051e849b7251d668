# SPDX-License-Identifier: BSD-3-Clause
"""A surface of the room from some of its scans.

triangulated(): neighbouring beams of one scan make triangles, so corners are what was measured, and holes stay holes.
distance_surface(): VTK's point-processing filters instead: normals from neighbouring points, a signed distance on a
grid, its zero surface. carved() takes away what another scan has seen through: what moved between the scans.
"""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersPoints import vtkExtractSurface, vtkPCANormalEstimation, vtkSignedDistance

import avianlidar as al
from avianlidar._cloud import vertices

STEEPEST = 80.0                               # degrees of incidence: what is met more obliquely is a gap, not a surface
THROUGH, BESIDE = 0.15, 0.5                   # m behind, degrees beside: what counts as seen through
BOUNDS = (-11.0, -9.0, -1.4), (11.0, 9.0, 3.4)  # of the grid of distance_surface(), m, in the frame of the Pandar64
STEP, REACH, NEIGHBOURS = 0.04, 2.5, 16       # m; how far a distance is known, in steps; points of a normal


def cloud(points, values=None):
    """Points as vtkPolyData with point arrays."""
    data = vertices(np.asarray(points, float))
    for name, array in (values or {}).items():
        column = numpy_to_vtk(np.ascontiguousarray(array), deep=True)
        column.SetName(name)
        data.GetPointData().AddArray(column)
    return data


def surface_data(corners, cells):
    """vtkPolyData of triangles (n x 3 x 3) with cell arrays."""
    data = al.mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    for name, values in cells.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetCellData().AddArray(array)
    return data


def triangles_of(surface):
    """Corner places (n x 3 x 3) of a vtkPolyData of triangles."""
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(surface.GetPoints().GetData()).astype(float)[corners]


def _scaled_normals(corners):
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def normals_of(corners):
    scaled = _scaled_normals(corners)
    return scaled / np.maximum(np.linalg.norm(scaled, axis=1), 1e-300)[:, None]


def cosines(corners, origin):
    """Of the incidence angles at which a triangle's centre is seen from a place."""
    to_eye = origin - corners.mean(axis=1)
    return abs((normals_of(corners) * to_eye).sum(axis=1)) / np.linalg.norm(to_eye, axis=1)


def triangulated(scan, used):
    """Corner places, and the brightness of each triangle: the mean intensity of its corners over the cosine of
    incidence. `used` says which beams may be corners."""
    faces, starts = [], scan.rings()
    for ring, (start, end) in enumerate(zip(starts[:-2], starts[1:-1])):
        here = np.arange(start, end)
        after = np.roll(here, -1)
        above = scan.nearest_in_ring(ring + 1, scan.azimuth[here])
        after_above = np.roll(above, -1)
        faces += [np.column_stack([here, after, above]), np.column_stack([after, after_above, above])]
    faces = np.concatenate(faces or [np.empty((0, 3), int)])
    faces = faces[used[faces].all(axis=1)]
    places = scan.origin + np.nan_to_num(scan.range)[:, None] * scan.directions()
    corners = places[faces]
    seen = cosines(corners, scan.origin)
    solid = (np.linalg.norm(_scaled_normals(corners), axis=1) > 0) & (seen > np.cos(np.radians(STEEPEST)))
    return corners[solid], scan.intensity[faces[solid]].mean(axis=1) / seen[solid]


def seen_through(corners, scan):
    """Which triangles a scan has looked through: its beam nearest to their centres went on behind them."""
    own = (corners.mean(axis=1) - scan.origin) @ scan.pose[:3, :3]
    distance = np.linalg.norm(own, axis=1)
    azimuth = np.degrees(np.arctan2(own[:, 0], own[:, 1])) % 360
    elevation = np.degrees(np.arcsin(own[:, 2] / distance))
    levels = np.array([np.median(scan.elevation[start:end]) for start, end in zip(scan.rings(), scan.rings()[1:])])
    nearest = np.searchsorted((levels[1:] + levels[:-1]) / 2, elevation)
    result = np.zeros(len(corners), dtype=bool)
    for ring in range(len(levels)):
        mine = nearest == ring
        beam = scan.nearest_in_ring(ring, azimuth[mine])
        behind = scan.range[beam] > distance[mine] + THROUGH  # False for NaN
        result[mine] = behind & (abs(scan.elevation[beam] - elevation[mine]) < BESIDE)
    return result


def carved(corners, scans):
    """Which triangles none of the scans has looked through."""
    keep = np.ones(len(corners), dtype=bool)
    for scan in scans:
        keep &= ~seen_through(corners, scan)
    return keep


def distance_surface(scans, used):
    """Corner places of the zero surface of the signed distance to all points of the scans."""
    points, normals = [], []
    for scan, use in zip(scans, used):
        places = scan.origin + scan.range[use, None] * scan.directions()[use]
        estimate = vtkPCANormalEstimation()
        estimate.SetInputData(cloud(places))
        estimate.SetSampleSize(NEIGHBOURS)
        estimate.SetNormalOrientationToPoint()
        estimate.SetOrientationPoint(*scan.origin)
        estimate.Update()
        points.append(places)
        normals.append(vtk_to_numpy(estimate.GetOutput().GetPointData().GetNormals()))
    data = cloud(np.vstack(points), {"Normals": np.vstack(normals).astype(np.float32)})
    data.GetPointData().SetActiveNormals("Normals")
    low, high = np.array(BOUNDS)
    counts = np.ceil((high - low) / STEP).astype(int) + 1
    distance = vtkSignedDistance()
    distance.SetInputData(data)
    distance.SetDimensions(*map(int, counts))
    distance.SetBounds(*np.column_stack([low, low + STEP * (counts - 1)]).ravel())
    distance.SetRadius(REACH * STEP)
    surface = vtkExtractSurface()
    surface.SetInputConnection(distance.GetOutputPort())
    surface.SetRadius(REACH * STEP)
    surface.HoleFillingOff()
    surface.Update()
    return triangles_of(surface.GetOutput())


# ---- Regions: the large planes of the room.

PLANES, THICKNESS, ALIKE, SMALLEST = 8, 0.06, 0.95, 1.0  # at most so many; m; cosine; m2
OTHER = "everything else"


def find_planes(corners, eye, seed=1):
    """(name, unit normal towards the eye, offset) of the planes that hold most area; candidates are triangles chosen
    at random by their area."""
    normals, centres = normals_of(corners), corners.mean(axis=1)
    normals *= np.sign(((eye - centres) * normals).sum(axis=1))[:, None]
    areas = np.linalg.norm(_scaled_normals(corners), axis=1) / 2
    random, found = np.random.default_rng(seed), []
    left = np.ones(len(corners), dtype=bool)
    while len(found) < PLANES and left.any():
        chance = np.where(left, areas, 0)
        picks = random.choice(len(corners), 200, p=chance / chance.sum())
        best = max((left & _on(centres, normals, normals[i], normals[i] @ centres[i]) for i in picks),
                   key=lambda on: areas[on].sum())
        middle = np.average(centres[best], axis=0, weights=areas[best])
        spread = (centres[best] - middle) * np.sqrt(areas[best])[:, None]
        normal = np.linalg.eigh(spread.T @ spread)[1][:, 0]
        normal *= np.sign(normal @ normals[best].mean(axis=0))
        best = left & _on(centres, normals, normal, normal @ middle)
        if areas[best].sum() < SMALLEST:
            break
        found.append((normal, normal @ middle))
        left &= ~best
    return _named(found)


def _on(centres, normals, normal, offset):
    return (abs(centres @ normal - offset) < THICKNESS) & (normals @ normal > ALIKE)


def _named(planes):
    named, counts = [], {}
    for normal, offset in planes:
        kind = "floor" if normal[2] > 0.9 else "ceiling" if normal[2] < -0.9 else "wall"
        counts[kind] = counts.get(kind, 0) + 1
        named.append((f"{kind} {counts[kind]}", normal, offset))
    return named


def regions(corners, eye, planes):
    """The number of the plane on which each triangle lies; len(planes) where it lies on none."""
    normals, centres = normals_of(corners), corners.mean(axis=1)
    normals *= np.sign(((eye - centres) * normals).sum(axis=1))[:, None]
    result = np.full(len(corners), len(planes))
    for i in reversed(range(len(planes))):
        result[_on(centres, normals, *planes[i][1:])] = i
    return result
