# SPDX-License-Identifier: BSD-3-Clause
"""Scans of any sensor that the point cloud reader reads, the beams found from their points, and poses.

A ring is a `laser_id` (the fields `ring` or `channel` of a file); where a file has none, a cluster of elevations or else a
band of them. A beam is a direction that answered, with its own azimuth and elevation. Between neighbours of a ring that
are several steps apart the sensor has fired, too, and nothing came back: these beams lie evenly between the two.
"""
import dataclasses
import json
import pathlib

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from avianlidar.vtkAvianLidar import vtkAvianLidarPointCloudReader

import running

ROOM = {"pandar64": "Pandar64", "pandar40p": "Pandar40P", "xt32": "PandarXT-32", "qt64": "PandarQT64"}
MESH = "room_mesh_4sensors.ply"
POSES = "transforms_to_pandar64.json"
BRIGHTNESS = ("intensity", "reflectivity", "signal", "return_energy")  # the first that a file has
NEVER = 3.0      # degrees from every azimuth that answered: there the sensor was not looking
CLUSTERED = 0.1  # height of a ring's elevations over the step between rings
PARALLEL = 256   # rings at most


@dataclasses.dataclass
class Scan:
    """One turn of a sensor. Arrays have a value for each beam, by ring and azimuth; without an answer the range is NaN."""
    sensor: str
    pose: np.ndarray          # 4 x 4, from the sensor's frame (its own place is 0) to that of the room
    azimuth: np.ndarray       # degrees from the y axis, clockwise, 0 to 360
    elevation: np.ndarray     # degrees
    ring: np.ndarray          # 0, 1, ... from the lowest
    range: np.ndarray         # m, of the farthest return
    intensity: np.ndarray     # of that return, on the sensor's own scale; 1 where a file has none

    @property
    def origin(self):
        return self.pose[:3, 3]

    @property
    def answered(self):
        return np.isfinite(self.range)

    def directions(self):
        """Unit vectors in the room's frame."""
        azimuth, elevation = np.radians(self.azimuth), np.radians(self.elevation)
        across = np.cos(elevation)
        own = np.column_stack([across * np.sin(azimuth), across * np.cos(azimuth), np.sin(elevation)])
        return own @ self.pose[:3, :3].T

    def points(self, nearest=0.0):
        """Places of the returns beyond a range, in the room's frame, and which beams they belong to."""
        beams = np.flatnonzero(self.range > nearest)
        return self.origin + self.range[beams, None] * self.directions()[beams], beams

    def rings(self):
        """First beam of each ring, and one past the last."""
        return np.searchsorted(self.ring, np.arange(self.ring[-1] + 2))

    def nearest_in_ring(self, ring, azimuths):
        """The beam of a ring that is nearest to each azimuth (degrees)."""
        start, end = self.rings()[ring:ring + 2]
        own = self.azimuth[start:end]
        middles = (own + np.roll(own, -1) + 360 * (np.arange(len(own)) == len(own) - 1)) / 2
        # What lies behind the middle of the last and the first belongs to the first; before it, to the last.
        place = np.searchsorted(middles, azimuths)
        place = np.where(azimuths < middles[-1] - 360, len(own) - 1, place)
        return start + place % len(own)


def _rings_of(elevation):
    """A number for each point: its cluster of elevations where these are narrow, else a band as high as beams are apart."""
    order = np.argsort(elevation)
    gaps = np.diff(elevation[order])
    for gap in np.geomspace(5.0, 0.02, 12):
        ring = np.cumsum(np.r_[0, gaps > gap])
        low, high = (np.flatnonzero(np.r_[True, gaps > gap]), np.flatnonzero(np.r_[gaps > gap, True]))
        height = elevation[order][high] - elevation[order][low]
        apart = np.diff(elevation[order][low])
        if 2 <= len(low) <= PARALLEL and np.median(height) < CLUSTERED * np.median(apart):
            break
    else:
        side = np.sqrt(360 * max(np.ptp(elevation), 1e-6) / len(elevation))
        ring = np.floor((elevation[order] - elevation[order][0]) / side).astype(int)
    result = np.empty(len(order), dtype=int)
    result[order] = ring
    return result


def _by_elevation(ring, elevation):
    """Rings numbered from the lowest."""
    names, number = np.unique(ring, return_inverse=True)
    middle = [np.median(elevation[number == i]) for i in range(len(names))]
    return np.argsort(np.argsort(middle, kind="stable"))[number]


def _unanswered(azimuth, elevation, step):
    """Azimuths and elevations of the beams of a ring between those that answered, whose azimuths ascend."""
    gap = np.diff(azimuth, append=azimuth[0] + 360)
    count = np.maximum(np.round(gap / step).astype(int) - 1, 0)
    first = np.repeat(np.arange(len(gap)), count)
    part = (np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count) + 1) / (count[first] + 1)
    return ((azimuth[first] + part * gap[first]) % 360,
            elevation[first] + part * (np.roll(elevation, -1) - elevation)[first])


def beams_of(own, intensity, ring=None):
    """Azimuth, elevation, ring, range and intensity of the beams of points (m) in the sensor's frame."""
    distance = np.linalg.norm(own, axis=1)
    there = distance > 0
    own, distance, intensity = own[there], distance[there], intensity[there]
    azimuth = np.degrees(np.arctan2(own[:, 0], own[:, 1])) % 360
    elevation = np.degrees(np.arcsin(own[:, 2] / distance))
    ring = _by_elevation(_rings_of(elevation) if ring is None else ring[there], elevation)
    order = np.lexsort((azimuth, ring))
    ring, azimuth, elevation, distance, intensity = (v[order] for v in (ring, azimuth, elevation, distance, intensity))
    onward = np.where(np.diff(ring) == 0, np.diff(azimuth), 0.0)
    step = np.median(onward[onward > 1e-3]) if (onward > 1e-3).any() else 360.0
    # Returns of one beam: the farthest counts.
    beam = np.cumsum(np.r_[0, (np.diff(ring) != 0) | (np.diff(azimuth) > step / 2)])
    far = np.lexsort((distance, beam))[np.flatnonzero(np.diff(beam, append=beam[-1] + 1))]
    ring, azimuth, elevation, distance, intensity = (v[far] for v in (ring, azimuth, elevation, distance, intensity))
    looked = np.sort(azimuth)
    columns = [np.column_stack([azimuth, elevation, ring, distance, intensity])]
    for one in range(ring[-1] + 1):
        between, heights = _unanswered(azimuth[ring == one], elevation[ring == one], step)
        place = np.searchsorted(looked, between)
        off = np.minimum((looked[place % len(looked)] - between) % 360, (between - looked[place - 1]) % 360)
        between, heights = between[off < NEVER], heights[off < NEVER]
        nothing = np.full(len(between), np.nan)
        columns.append(np.column_stack([between, heights, np.full(len(between), one), nothing, nothing]))
    beams = np.concatenate(columns)
    azimuth, elevation, ring, distance, intensity = beams[np.lexsort((beams[:, 0], beams[:, 2]))].T
    return azimuth, elevation, ring.astype(int), distance, intensity


def read_scan(file, pose=None):
    """The scan of a file, and where the sensor stood: the pose leads from the file's coordinates to those of the room."""
    reader = vtkAvianLidarPointCloudReader()
    reader.SetFileName(str(file))
    running.update(reader)
    cloud = reader.GetOutput()
    if cloud.GetNumberOfPoints() < 3:
        raise SystemExit(f"{file}: {cloud.GetNumberOfPoints()} points; expected a scan")
    places, data = vtk_to_numpy(cloud.GetPoints().GetData()).astype(float), cloud.GetPointData()
    position = cloud.GetFieldData().GetArray("position")
    there = np.eye(4)
    there[:3, 3] = vtk_to_numpy(position).ravel() if position else 0.0
    bright = next((data.GetArray(name) for name in BRIGHTNESS if data.HasArray(name)), None)
    intensity = vtk_to_numpy(bright).astype(float) if bright else np.ones(len(places))
    ring = vtk_to_numpy(data.GetArray("laser_id")) if data.HasArray("laser_id") else None
    return Scan(pathlib.Path(file).stem, (np.eye(4) if pose is None else pose) @ there,
                *beams_of(places - there[:3, 3], intensity, ring))


def read_poses(file):
    """{scan: 4 x 4} of a JSON file {scan: {"T": rows}}."""
    try:
        found = {name: np.array(one["T"], dtype=float) for name, one in json.loads(pathlib.Path(file).read_text("utf-8")).items()}
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise SystemExit(f'{file}: {type(error).__name__}: {error}; expected {{"scan": {{"T": 4 rows of 4 numbers}}}}') from None
    for name, pose in found.items():
        if pose.shape != (4, 4):
            raise SystemExit(f"{file}: T of {name} has the shape {pose.shape}; expected 4 rows of 4 numbers")
    return found


def room_files(folder):
    """The scans of the room and their poses."""
    poses = read_poses(folder / POSES)
    return [folder / f"{name}.pcd" for name in ROOM], {name: poses[key] for name in ROOM
                                                       if (key := name.replace("pandar", "")) in poses}
