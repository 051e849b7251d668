# SPDX-License-Identifier: BSD-3-Clause
"""Boxes around movers, for networks that learn boxes."""
from __future__ import annotations

import math
from typing import Callable, Optional, Tuple

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkPolyData

from ..._cloud import Cloud, field_values, leaves_of, triangles_of

RAYS = 72  # least number of rays to a mover


def _rotation(times: np.ndarray, quaternions: np.ndarray, time: float) -> np.ndarray:
    """Rotation from a mover's frame to the scene's at a time, s. @param quaternions w, x, y, z"""
    from scipy.spatial.transform import Rotation, Slerp
    last = int(np.clip(np.searchsorted(times, time), 1, max(len(times) - 1, 1)))
    two = slice(last - 1, last + 1)  # the poses before and after
    turns = Rotation.from_quat(quaternions[two][:, [1, 2, 3, 0]])
    return (Slerp(times[two], turns)(np.clip(time, times[0], times[-1])) if len(times) > 1 else turns[0]).as_matrix()


def _parts(n: int) -> np.ndarray:
    """Centres of n*n equal parts of a triangle, in barycentric coordinates."""
    upright = [(i, j) for i in range(n) for j in range(n - i)]
    corners = [*((3 * i + 1, 3 * j + 1) for i, j in upright),
               *((3 * i + 2, 3 * j + 2) for i, j in upright if i + j < n - 1)]
    return np.array([(a, b, 3 * n - a - b) for a, b in corners]) / (3 * n)


class Boxes:
    """Boxes of the movers of scans. Surfaces of the scene hide movers. The field of view cuts movers: it contains the
    azimuths, elevations and ranges between the sensor's outermost beams."""

    def __init__(self, tree, sensor, pose: np.ndarray):
        """tree    vtkAvianLidarCollisionTree of the scene, updated
           sensor  a Sensor, at rest
           pose    3 x 4 matrix from the coordinates of points (x forward, y left, z up) to the scene's coordinates, or
                   to those of the platform on which the sensor stands"""
        self.tree, self.pose = tree, pose
        self.gate = float(sensor.minimum_range), float(sensor.range_gate)
        turned, up = self._angles(sensor.beams["direction"] @ pose[:, :3])
        turned, margin = np.sort(turned), float(sensor.half_beamwidth)
        self.low, self.high = up.min() - margin, up.max() + margin
        gaps = np.diff(np.append(turned, turned[0] + 2 * np.pi))
        widest = int(gaps.argmax())  # the field of view begins after the widest gap
        self.begin = turned[(widest + 1) % len(turned)] - margin
        self.width = 2 * np.pi if gaps[widest] < np.radians(10) else 2 * np.pi - gaps[widest] + 2 * margin

    @staticmethod
    def _angles(rows: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Angles to the left and upwards of each row, rad."""
        return np.arctan2(rows[:, 1], rows[:, 0]), np.arctan2(rows[:, 2], np.hypot(rows[:, 0], rows[:, 1]))

    def lines(self, report: Cloud, movers, poses: Optional[Callable[[int], np.ndarray]] = None,
              frame: Optional[np.ndarray] = None) -> str:
        """A line for each mover in the field of view.

        report  the mover report
        movers  of the scan
        poses   for a sensor that moves, its pose (as `pose`) by the id of the beam that meets the mover
        frame   matrix from the coordinates of the boxes to the scene's; default: the sensor's pose
        """
        blocks = {int(block.GetCellData().GetArray("object_id").GetTuple1(0)): block for block in leaves_of(movers)}
        if not report.number_of_points:
            return ""
        columns = [report[name].tolist() for name in ("object_id", "timestamp", "number_of_echoes")]
        found = []
        for row, (number, time, points, place) in enumerate(zip(*columns, report.points)):
            self.pose = poses(int(report["beam_id"][row])) if poses else self.pose
            found.append(self._line(blocks[number], number, 1e-6 * time, points, place,
                                    self.pose if frame is None else frame))
        return "".join(found)

    def _line(self, block: vtkPolyData, number: int, time: float, points: int, place: np.ndarray,
              frame: np.ndarray) -> str:
        fields = field_values(block)
        quaternions = np.reshape(fields.get("pose_orientation", [1.0, 0, 0, 0]), (-1, 4))
        rotation = _rotation(np.ravel(fields.get("pose_time", [0.0])), quaternions, time)
        corners, cells = triangles_of(block)
        truncated, hidden = self._shares((corners @ rotation.T + place)[cells])
        if truncated >= 1:
            return ""
        bounds = np.reshape(block.GetBounds(), (3, 2))
        width, length, height = bounds[:, 1] - bounds[:, 0]  # x is right, y is forward
        centre = (rotation @ bounds.mean(axis=1) + place - frame[:, 3]) @ frame[:, :3]
        ahead = rotation[:, 1] @ frame[:, :3]
        name = "_".join(str(fields["object_classes"][0]).split()) or "object"
        numbers = " ".join(f"{value:.4f}" for value in (*centre, length, width, height, np.arctan2(ahead[1], ahead[0])))
        return f"{name} {truncated:.2f} {hidden:.2f} {numbers} {number} {points}\n"

    def _shares(self, triangles: np.ndarray) -> Tuple[float, float]:
        """The share of the visible side that is outside the field of view, and the hidden share of the rest."""
        place, parts = self.pose[:, 3], _parts(math.ceil(math.sqrt(RAYS / len(triangles))))
        centres = np.einsum("pc,tcx->tpx", parts, triangles).reshape(-1, 3)
        views = centres - place
        ranges = np.linalg.norm(views, axis=1)
        first, second, third = triangles.transpose(1, 0, 2)  # corners
        across = np.repeat(np.cross(second - first, third - second), len(parts), axis=0)
        weights = np.abs(np.einsum("ij,ij->i", across, views)) / ranges**3  # solid angles
        turned, up = self._angles(views @ self.pose[:, :3])
        inside = (up >= self.low) & (up <= self.high) & ((turned - self.begin) % (2 * np.pi) <= self.width)
        inside &= (ranges >= self.gate[0]) & (ranges <= self.gate[1])
        if not weights[inside].sum() > 0:
            return 1.0, 0.0
        hidden = vtkUnsignedCharArray()
        self.tree.FindHiddenPoints(place, numpy_to_vtk(np.ascontiguousarray(centres[inside])), hidden)
        covered = vtk_to_numpy(hidden)
        return float(weights[~inside].sum() / weights.sum()), float(weights[inside] @ covered / weights[inside].sum())
