# SPDX-License-Identifier: BSD-3-Clause
"""The four scans of the room: points, firing patterns found from them, and poses.

A scan is one turn with two returns per beam. Its points stand in the order of firing: blocks of one azimuth, in each
block one point per ring that answered, rings ascending. So a new block begins where the ring does not ascend, and
azimuth(point) = azimuth(block) + offset(ring), elevation(point) = elevation(ring), exactly: what the sensor has
fired is every ring at every block, also where nothing came back.
"""
import dataclasses
import json
import pathlib

import numpy as np

SENSORS = ("pandar64", "pandar40p", "xt32", "qt64")
NAMES = {"pandar64": "Pandar64", "pandar40p": "Pandar40P", "xt32": "PandarXT-32", "qt64": "PandarQT64"}
MESH = "room_mesh_4sensors.ply"
POSES = "transforms_to_pandar64.json"

_KINDS = {("F", 4): "<f4", ("F", 8): "<f8", ("U", 1): "u1", ("U", 2): "<u2", ("U", 4): "<u4", ("I", 4): "<i4"}


def read_pcd(file):
    """Fields of an uncompressed binary PCD file (version 0.7) as a structured array. Another kind is a ValueError."""
    data = pathlib.Path(file).read_bytes()
    header, rest = {}, 0
    while "DATA" not in header:
        end = data.find(b"\n", rest)
        if end < 0:
            raise ValueError(f"{file}: no line DATA, so this is no PCD file")
        words = data[rest:end].decode("ascii", "replace").split()
        rest = end + 1
        if words:
            header[words[0]] = words[1:]
    if header["DATA"] != ["binary"] or set(header.get("COUNT", ["1"])) != {"1"}:
        raise ValueError(f"{file}: DATA {' '.join(header['DATA'])}; expected binary fields of one value each")
    kinds = zip(header["TYPE"], map(int, header["SIZE"]))
    record = np.dtype([(name, _KINDS[kind]) for name, kind in zip(header["FIELDS"], kinds)])
    return np.frombuffer(data, record, int(header["POINTS"][0]), rest)


@dataclasses.dataclass
class Scan:
    """One sensor's turn. Arrays of beams are (blocks x rings) in one row; what did not answer has the range NaN."""
    sensor: str
    pose: np.ndarray          # 4 x 4, from the sensor's frame to that of the room
    azimuth: np.ndarray       # degrees from the sensor's y axis, clockwise
    elevation: np.ndarray     # degrees
    ring: np.ndarray
    column: np.ndarray
    range: np.ndarray         # m, of the farther of the two returns
    intensity: np.ndarray     # of that return, 0 to 255, the sensor's own scale
    two_returns: np.ndarray   # whether the two are more than 0.1 m apart

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

    def shape(self):
        return self.column.max() + 1, len(np.unique(self.ring))


def _wrapped(degrees):
    return (degrees + 180) % 360 - 180


def _pattern(azimuth, block, ring, rings):
    """Azimuth of each block and offset of each ring, degrees."""
    seen = np.full((block[-1] + 1, rings), np.nan)
    seen[block, ring] = azimuth
    most = np.bincount(ring).argmax()
    apart = _wrapped(seen - seen[:, [most]])
    offset = np.array([np.nanmedian(column) if np.isfinite(column).any() else np.nan for column in apart.T])
    by_ring = seen - offset
    first = by_ring[np.arange(len(seen)), np.isfinite(by_ring).argmax(axis=1)]
    return first % 360, offset


def read_scan(folder, sensor):
    """The scan of a sensor in the folder `lidar_room`."""
    data = read_pcd(pathlib.Path(folder) / f"{sensor}.pcd")
    places = np.column_stack([data[axis] for axis in "xyz"]).astype(float)
    ring, distance = data["ring"].astype(int), np.linalg.norm(places, axis=1)
    rings = ring.max() + 1
    azimuth = np.degrees(np.arctan2(places[:, 0], places[:, 1]))
    block = np.cumsum(np.r_[0, np.diff(ring) <= 0])
    of_block, offset = _pattern(azimuth, block, ring, rings)
    elevations = np.degrees(np.arcsin(places[:, 2] / distance))
    elevation = np.array([np.median(elevations[ring == r]) if (ring == r).any() else np.nan for r in range(rings)])
    # The two returns of a firing are two blocks of the same azimuth.
    order = np.argsort(of_block, kind="stable")
    column_of_sorted = np.cumsum(np.r_[0, np.diff(of_block[order]) > 0.05])
    column_of = np.empty(len(order), dtype=int)
    column_of[order] = column_of_sorted
    known = np.flatnonzero(np.isfinite(elevation))  # a ring that never answered has no known elevation
    columns, place = column_of_sorted[-1] + 1, np.full(rings, -1)
    place[known] = np.arange(len(known))
    slot = column_of[block] * len(known) + place[ring]
    near, far, bright = (np.full(columns * len(known), value) for value in (np.inf, np.nan, np.nan))
    np.minimum.at(near, slot, distance)
    rising = np.argsort(distance, kind="stable")  # the last to be written is the farthest
    far[slot[rising]], bright[slot[rising]] = distance[rising], data["intensity"][rising]
    start = of_block[order][np.searchsorted(column_of_sorted, np.arange(columns))]
    azimuths = _wrapped(np.repeat(start, len(known)) + np.tile(offset[known], columns))
    return Scan(sensor, read_pose(folder, sensor), azimuths,
                np.tile(elevation[known], columns), np.tile(known, columns), np.repeat(np.arange(columns), len(known)),
                far, bright, far - near > 0.1)


def read_pose(folder, sensor):
    """From the sensor's frame to that of the Pandar64."""
    if sensor == SENSORS[0]:
        return np.eye(4)
    transforms = json.loads((pathlib.Path(folder) / POSES).read_text(encoding="utf-8"))
    return np.array(transforms[sensor.replace("pandar", "")]["T"])
