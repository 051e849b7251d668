# SPDX-License-Identifier: BSD-3-Clause
"""A sequence as one MCAP file of ROS 2 messages: clouds, and where the sensor stands.

Sources: the MCAP specification (mcap.dev/spec), profile `ros2`; OMG CDR, little endian; definitions of common_interfaces and geometry2.
"""
from __future__ import annotations

import pathlib
import struct
import zlib
from typing import Dict, Iterator, List, Tuple

import numpy as np

from .._disk import read_regular, replacing
from .._version import __version__

_MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _MESSAGES, _CHUNKS, _STATISTICS, _END = 1, 2, 3, 4, 5, 6, 7, 8, 11, 15
_LINE = "=" * 80
_TIME = f"{_LINE}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n{_LINE}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
_TF, _POINTS = 1, 2  # channels, and their schemas
_TOPICS = {
    _TF: ("/tf", "tf2_msgs/msg/TFMessage", f"""\
geometry_msgs/TransformStamped[] transforms
{_LINE}
MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
geometry_msgs/Transform transform
{_LINE}
MSG: geometry_msgs/Transform
geometry_msgs/Vector3 translation
geometry_msgs/Quaternion rotation
{_LINE}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
{_LINE}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
{_TIME}"""),
    _POINTS: ("/points", "sensor_msgs/msg/PointCloud2", f"""\
std_msgs/Header header
uint32 height
uint32 width
sensor_msgs/PointField[] fields
bool is_bigendian
uint32 point_step
uint32 row_step
uint8[] data
bool is_dense
{_LINE}
MSG: sensor_msgs/PointField
string name
uint32 offset
uint8 datatype
uint32 count
{_TIME}"""),
}
_FLOAT, _UINT = ("<f4", 7), ("<u2", 4)  # types, and what PointField calls them
_FIELDS = {"x": _FLOAT, "y": _FLOAT, "z": _FLOAT, "intensity": _FLOAT, "label": _UINT, "instance": _UINT}
_POINT = np.dtype([(name, kind) for name, (kind, _) in _FIELDS.items()])


class _Cdr:
    """A message: each number at a multiple of its size."""

    def __init__(self) -> None:
        self.data = bytearray()

    def put(self, code: str, *values) -> None:
        for value in values:
            self.data += bytes(-len(self.data) % struct.calcsize(code)) + struct.pack("<" + code, value)

    def text(self, word: str) -> None:
        self.put("I", len(word) + 1)
        self.data += word.encode("ascii") + b"\0"

    def header(self, time: int, frame: str) -> None:
        self.put("i", time // 10**9)
        self.put("I", time % 10**9)
        self.text(frame)

    def message(self) -> bytes:
        return b"\0\1\0\0" + self.data  # little endian


def _transform(time: int, pose: np.ndarray) -> bytes:
    """TFMessage of one: from the sensor's frame to the map. The quaternion is the eigenvector of the largest eigenvalue (Bar-Itzhack 2000)."""
    (a, b, c), (d, e, f), (g, h, i) = pose[:, :3]
    rotation = np.linalg.eigh([[a - e - i, d + b, g + c, h - f], [d + b, e - a - i, h + f, c - g],
                               [g + c, h + f, i - a - e, d - b], [h - f, c - g, d - b, a + e + i]])[1][:, -1]
    cdr = _Cdr()
    cdr.put("I", 1)
    cdr.header(time, "map")
    cdr.text("lidar")
    cdr.put("d", *pose[:, 3], *(rotation * (-1 if rotation[3] < 0 else 1)))
    return cdr.message()


def _cloud(time: int, points: np.ndarray) -> bytes:
    """PointCloud2."""
    cdr = _Cdr()
    cdr.header(time, "lidar")
    cdr.put("I", 1, len(points), len(_FIELDS))
    offset = 0
    for name, (kind, number) in _FIELDS.items():
        cdr.text(name)
        cdr.put("I", offset)
        cdr.put("B", number)
        cdr.put("I", 1)
        offset += np.dtype(kind).itemsize
    cdr.put("B", 0)
    cdr.put("I", _POINT.itemsize, points.nbytes, points.nbytes)
    cdr.data += points.tobytes()
    cdr.put("B", 1)
    return cdr.message()


def _table(file: pathlib.Path, columns: int, least: float = -2e9, key: str = "") -> np.ndarray:
    """The numbers of each line that begins with the key."""
    try:
        lines = [line[len(key):].split() for line in read_regular(file).decode().splitlines() if line.startswith(key)]
        rows = np.array(lines, float).reshape(-1, columns)
        if not ((rows >= least) & (rows < 2e9)).all():
            raise ValueError
    except ValueError:
        raise ValueError(f"{file}: expected lines of {key or 'numbers'}, {columns} in each, from {least:g} to 2e9") from None
    return rows


def _scans(folder: pathlib.Path) -> Iterator[Tuple[int, np.ndarray, np.ndarray]]:
    """Time (ns), pose and points of each scan. A calibration turns poses of a camera to those of the lidar, as in SemanticKITTI."""
    if not (folder / "velodyne").is_dir():
        raise ValueError(f"{folder}: is no folder of a sequence, expected one with velodyne/, times.txt and poses.txt")
    files = sorted((folder / "velodyne").glob("*.bin"))
    times, poses = _table(folder / "times.txt", 1, least=0)[:, 0], _table(folder / "poses.txt", 12).reshape(-1, 3, 4)
    if not len(files) == len(times) == len(poses):
        raise ValueError(f"{folder}: has {len(files)} scans, {len(times)} times and {len(poses)} poses, expected as many of each")
    last = [0, 0, 0, 1]
    camera = np.vstack([*_table(folder / "calib.txt", 12, key="Tr:").reshape(-1, 4), last])
    if camera.shape != (4, 4) or abs(np.linalg.det(camera)) < 0.5:
        raise ValueError(f"{folder / 'calib.txt'}: expected one line Tr: with a rotation and a translation in 12 numbers")
    for file, time, pose in zip(files, times, poses):
        content, label = read_regular(file), folder / "labels" / f"{file.stem}.label"
        labels = np.frombuffer(read_regular(label), "<u4") if label.exists() else np.zeros(len(content) // 16, "<u4")
        if len(content) != 16 * len(labels):
            raise ValueError(f"{file}: has {len(content)} bytes, expected 16 for each of {len(labels)} labels")
        points, rows = np.empty(len(labels), _POINT), np.frombuffer(content, "<f4").reshape(-1, 4)
        points["x"], points["y"], points["z"], points["intensity"] = (rows * np.array([1, 1, 1, 255], "<f4")).T
        points["label"], points["instance"] = labels & 0xffff, labels >> 16
        yield round(1e9 * time), (np.linalg.inv(camera) @ np.vstack([pose, last]) @ camera)[:3], points


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def _bytes(content: bytes) -> bytes:
    return struct.pack("<I", len(content)) + content


def write(folder: pathlib.Path, out: pathlib.Path) -> int:
    """Write a sequence; returns the number of scans. Each scan is a chunk with an index, not compressed."""
    known = b"".join(_record(_SCHEMA, struct.pack("<H", key) + _bytes(schema.encode()) + _bytes(b"ros2msg") + _bytes(text.encode()))
                     + _record(_CHANNEL, struct.pack("<HH", key, key) + _bytes(topic.encode()) + _bytes(b"cdr") + _bytes(b""))
                     for key, (topic, schema, text) in _TOPICS.items())
    indices: List[bytes] = []
    times: List[int] = []
    with replacing(out) as name, open(name, "wb") as file:
        file.write(_MAGIC + _record(_HEADER, _bytes(b"ros2") + _bytes(f"avian-lidar {__version__}".encode())) + known)
        for number, (time, pose, points) in enumerate(_scans(folder)):
            times.append(time)
            records, offsets = b"", {}  # type: bytes, Dict[int, int]
            for key, message in ((_TF, _transform(time, pose)), (_POINTS, _cloud(time, points))):
                offsets[key] = len(records)
                records += _record(_MESSAGE, struct.pack("<HIQQ", key, number, time, time) + message)
            chunk = _record(_CHUNK, struct.pack("<QQQI", time, time, len(records), zlib.crc32(records)) + _bytes(b"")
                            + struct.pack("<Q", len(records)) + records)
            begin, places = file.tell(), b""
            file.write(chunk)
            for key, offset in offsets.items():
                places += struct.pack("<HQ", key, file.tell())
                file.write(_record(_MESSAGES, struct.pack("<HIQQ", key, 16, time, offset)))
            indices.append(_record(_CHUNKS, struct.pack("<QQQQ", time, time, begin, len(chunk)) + _bytes(places) + struct.pack(
                "<Q", file.tell() - begin - len(chunk)) + _bytes(b"") + struct.pack("<QQ", len(records), len(records))))
        file.write(_record(_END, bytes(4)))
        summary, count = file.tell(), len(times)
        file.write(known + _record(_STATISTICS, struct.pack(
            "<QHIIIIQQ", count * len(_TOPICS), len(_TOPICS), len(_TOPICS), 0, 0, count, min(times, default=0), max(times, default=0)) + _bytes(
                b"".join(struct.pack("<HQ", key, count) for key in _TOPICS))) + b"".join(indices))
        file.write(_record(_FOOTER, struct.pack("<QQI", summary, 0, 0)) + _MAGIC)
    return count
