# SPDX-License-Identifier: BSD-3-Clause
"""A scan simulated beam by beam, and compared with what the sensor saw."""
import dataclasses

import numpy as np
from scipy.stats import spearmanr
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkGenericCell, vtkStaticCellLocator

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter

import room_surface
import running

# What the data do not tell is assumed: a beam of 1.5 mrad half width, a pulse of 2 ns sampled at 1 ns, detection from
# 3 mJ of a pulse of 1 J on (a surface with kd = 0.3 that fills 1 % of the beam). No noise.
SENSOR = {"half_beamwidth": 1.5e-3, "beam_profile": 0, "pulse_energy": 1.0, "pulse_width": 2e-9, "frequency": 3.313e14,
          "sampling_interval": 1e-9, "range_gate": 60.0, "noise_photon_rate": 0.0, "lower_energy_limit": 3e-3,
          "upper_energy_limit": 1.0, "receiver_aperture": 0.0}
KD = 0.3


@dataclasses.dataclass
class Simulated:
    """What each beam gives; NaN or -1 where it has no echo."""
    range: np.ndarray
    energy: np.ndarray
    region: np.ndarray
    incidence: np.ndarray


def beams_of(scan, half_beamwidth, sensor=SENSOR):
    """The sensor's beams as a script makes them: a vertex with a direction for each, the sensor as field data."""
    beams = room_surface.cloud(np.tile(scan.origin, (len(scan.range), 1)), {"direction": scan.directions()})
    gate = max(sensor["range_gate"], 1.2 * np.nanmax(scan.range))
    for name, value in {**sensor, "range_gate": gate, "half_beamwidth": half_beamwidth}.items():
        array = vtkDoubleArray()
        array.SetName(name)
        array.InsertNextValue(value)
        beams.GetFieldData().AddArray(array)
    return beams


def echo_filter(scan, corners, region=None, kd=None, half_beamwidth=SENSOR["half_beamwidth"], rays=100, threads=0,
                sensor=SENSOR):
    """The scan's beams on the triangles, not yet updated: the last return, as a real one is the farther of two."""
    count, none = len(corners), np.zeros(len(corners))
    surface = room_surface.surface_data(corners, {
        "object_id": np.zeros(count, np.int32) if region is None else region.astype(np.int32),
        "material_id": np.full(count, 4, np.int32), "kd": np.full(count, KD) if kd is None else kd,
        "ks": none, "kp": none})
    lidar = vtkAvianLidarEchoFilter()
    lidar.SetInputData(0, beams_of(scan, half_beamwidth, sensor))
    lidar.SetSurfacesData(surface)
    lidar.SetRaysPerBeam(rays)
    lidar.SetNumberOfReflections(1)
    lidar.SetReturnModeToLast()
    lidar.SetNumberOfThreads(threads)
    return lidar


def simulate(scan, corners, **settings):
    """What each beam of the scan gives from the triangles; settings as of `echo_filter`."""
    lidar = echo_filter(scan, corners, **settings)
    running.update(lidar)
    points = lidar.GetOutput().GetPointData()
    beam = vtk_to_numpy(points.GetArray("beam_id"))

    def spread(name, nothing):
        values = np.full(len(scan.range), nothing)
        values[beam] = vtk_to_numpy(points.GetArray(name))
        return values

    return Simulated(spread("distance_m", np.nan), spread("return_energy", np.nan), spread("object_id", -1),
                     spread("incidence_angle", np.nan))


def spread_of(errors):
    """The distribution of range errors (m) as a dictionary."""
    if not len(errors):
        return dict.fromkeys(("median", "spread", "p05", "p95", "in2cm", "in5cm", "in10cm"), np.nan)
    middle = np.median(errors)
    low, high = np.percentile(errors, (5, 95))
    return {"median": middle, "spread": 1.4826 * np.median(abs(errors - middle)), "p05": low, "p95": high,
            **{f"in{100 * d:.0f}cm": np.mean(abs(errors) < d) for d in (0.02, 0.05, 0.1)}}


def clouds(simulated, real):
    """Hausdorff distance and RMSE (paper, Eq. 19, 20) both ways, m; density-aware Chamfer distance, 1."""
    comparison = running.apart(simulated, real)
    return {"hausdorff": comparison.GetHausdorffDistance(),
            "density_aware_chamfer": comparison.GetDensityAwareChamferDistance(),
            "rmse_rs": comparison.GetRMSEReferenceToSimulated(), "rmse_sr": comparison.GetRMSESimulatedToReference()}


class Nearest:
    """The nearest triangle of a surface."""

    def __init__(self, corners):
        self.locator = vtkStaticCellLocator()
        self.surface = room_surface.surface_data(corners, {})
        self.locator.SetDataSet(self.surface)
        self.locator.BuildLocator()

    def __call__(self, points, farthest):
        """(distance, triangle) of each point; (farthest, -1) where nothing is as near as that."""
        cell, place = vtkGenericCell(), [0.0, 0.0, 0.0]
        number, sub, square = reference(0), reference(0), reference(0.0)
        distance, triangle = np.full(len(points), farthest), np.full(len(points), -1)
        for i, point in enumerate(points):
            if self.locator.FindClosestPointWithinRadius(point, farthest, place, cell, number, sub, square):
                distance[i], triangle[i] = square.get() ** 0.5, number.get()
        return distance, triangle


def fitted_pose(scan, used, corners, within=0.1, rounds=3):
    """The scan in a pose fitted to the surface: the planes of the nearest triangles, none farther than `within`, each
    point weighing less the farther it is (Gauss-Newton on six small motions about the sensor)."""
    nearest, normals, inside = Nearest(corners), room_surface.normals_of(corners), corners.mean(axis=1)
    pose, chosen = scan.pose.copy(), np.flatnonzero(used)[::3]
    for _ in range(rounds):
        moved = dataclasses.replace(scan, pose=pose)
        places = moved.origin + scan.range[chosen, None] * moved.directions()[chosen]
        distance, triangle = nearest(places, within)
        near = triangle >= 0
        normal, arm = normals[triangle[near]], places[near] - moved.origin
        off = ((places[near] - inside[triangle[near]]) * normal).sum(axis=1)
        weight = (1 - (distance[near] / within) ** 2) ** 2
        columns = np.column_stack([np.cross(arm, normal), normal])
        motion = np.linalg.lstsq(columns * weight[:, None], -off * weight, rcond=None)[0]
        turn = np.array([[0, -motion[2], motion[1]], [motion[2], 0, -motion[0]], [-motion[1], motion[0], 0]])
        rotation, _, other = np.linalg.svd((np.eye(3) + turn) @ pose[:3, :3])
        pose[:3, :3] = rotation @ other
        pose[:3, 3] += motion[3:]
    return dataclasses.replace(scan, pose=pose)


def range_noise(scan, used):
    """The spread of a scan's own ranges about the line through both neighbours of the same ring, m: what the sensor
    itself scatters, with the room's roughness."""
    ranges = np.where(used, scan.range, np.nan)
    bend = ranges[:-2] - 2 * ranges[1:-1] + ranges[2:]
    bend = bend[np.isfinite(bend) & (scan.ring[2:] == scan.ring[:-2])]
    return 1.4826 * np.median(abs(bend - np.median(bend))) / np.sqrt(6)


def rank_correlation(one, other):
    """Spearman's; NaN for fewer than 20 pairs or where one does not vary."""
    if len(one) < 20 or np.ptp(one) == 0 or np.ptp(other) == 0:
        return np.nan
    return spearmanr(one, other)[0]


def factor(energy, intensity):
    """The spread of their ratio as a factor, of what has an intensity above 0; NaN for fewer than 20."""
    bright = intensity > 0
    if bright.sum() < 20:
        return np.nan
    ratio = np.log(energy[bright] / intensity[bright])
    return np.exp(1.4826 * np.median(abs(ratio - np.median(ratio))))
