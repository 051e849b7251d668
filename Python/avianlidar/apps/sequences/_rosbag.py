# SPDX-License-Identifier: BSD-3-Clause
"""Writes a sequence as one file of ROS 2 messages (.mcap or .db3): clouds, the pose of the sensor, and boxes around
movers.

Sources: the MCAP specification (mcap.dev/spec), profile `ros2`; the SQLite schema of rosbag2 (Foxy), which all later
versions read."""
from __future__ import annotations

import contextlib
import math
import pathlib
import sqlite3
import struct
import zlib
from typing import Dict, Iterator, List, Sequence, Tuple

import numpy as np

from ..._bags import CHANNEL, CHUNK, CHUNKS, END, FOOTER, HEADER, MAGIC, MESSAGE, MESSAGES, SCHEMA, STATISTICS
from ..._disk import replacing
from ..._files import numbers_of, read_regular
from ..._recording import kitti_poses
from ..._ros import CLOUD, TRANSFORMS, packed, schema
from ..._version import __version__

_TF, _POINTS, _BOXES = 1, 2, 3  # numbers of the channels and of their schemas
_TOPICS = {_TF: ("/tf", TRANSFORMS), _POINTS: ("/points", CLOUD),
           _BOXES: ("/boxes", "visualization_msgs/MarkerArray")}
_CUBE, _ADD, _DELETE_ALL = 1, 0, 3  # type and actions of markers
_BIRD, _OTHER = (0.1, 0.7, 0.3, 0.5), (0.6, 0.3, 0.8, 0.5)  # red, green, blue, opacity of birds and of other movers
_POINT = np.dtype([*((name, "<f4") for name in ("x", "y", "z", "intensity")), ("label", "<u2"), ("instance", "<u2")])
_TIMED = np.dtype([*_POINT.descr, ("t", "<u4")])  # with ns since the start of the scan, as drivers write them
_DATATYPES = {"f4": 7, "u2": 4, "u4": 6}  # in PointField


def _message(key: int, *fields) -> bytes:
    """A message in a channel, little endian."""
    return packed(_TOPICS[key][1], *fields)


def _transform(time: int, pose: np.ndarray) -> bytes:
    """The transform from the sensor's frame to the map."""
    from scipy.spatial.transform import Rotation
    rotation = Rotation.from_matrix(pose[:, :3]).as_quat()
    turned = rotation * (-1 if rotation[3] < 0 else 1)
    return _message(_TF, [((divmod(time, 10**9), "map"), "lidar", (pose[:, 3], turned))])


def _cloud(time: int, points: np.ndarray) -> bytes:
    fields = [(name, offset, _DATATYPES[kind.str[1:]], 1) for name, (kind, offset, *_) in
              (points.dtype.fields or {}).items()]
    data, stamped = points.tobytes(), (divmod(time, 10**9), "lidar")
    return _message(_POINTS, stamped, 1, len(points), fields, False, points.dtype.itemsize, len(data), data, True)


def _marker(time: int, name: str, number: int, action: int, numbers: Sequence[float], words: str = "") -> Tuple:
    """A marker of a box, which is shown until the next scan removes all boxes.

    numbers  middle, size and heading, as in a line of boxes
    words    text of the marker
    """
    pose = numbers[:3], (0, 0, math.sin(numbers[6] / 2), math.cos(numbers[6] / 2))
    texture = ((0, 0), ""), "", b""
    return ((divmod(time, 10**9), "lidar"), name, number, _CUBE, action, pose, numbers[3:6],
            _BIRD if name == "bird" else _OTHER, (0, 0), False, (), (), "", texture, (), words, "", ("", b""), False)


def _boxes(time: int, file: pathlib.Path) -> bytes:
    """Messages that remove the boxes of the last scan and add one box for each line."""
    try:
        markers = [_marker(time, "", 0, _DELETE_ALL, (0,) * 7)]
        for line in read_regular(file).decode().splitlines():
            name, truncated, hidden, x, y, z, length, width, height, yaw, number, points = line.split()
            numbers = [float(value) for value in (x, y, z, length, width, height, yaw)]
            words = f"truncated {float(truncated):.2f}, hidden {float(hidden):.2f}, points {int(points)}"
            markers.append(_marker(time, name, int(number), _ADD, numbers, words))
        return _message(_BOXES, markers)
    except (ValueError, struct.error):  # also raised for text that is not UTF-8
        raise ValueError(f"{file}: expected lines of a class, 9 numbers, an id and a number of points") from None


def _scans(folder: pathlib.Path) -> Iterator[Tuple[str, int, np.ndarray, np.ndarray]]:
    """Name, time (ns), pose and points of each scan. A calibration turns camera poses into lidar poses."""
    if not (folder / "velodyne").is_dir():
        raise ValueError(f"{folder}: is not a folder of a sequence, "
                         "expected one with velodyne/, times.txt and poses.txt")
    files = sorted((folder / "velodyne").glob("*.bin"))
    times = numbers_of(folder / "times.txt", 1, least=0)[:, 0]
    poses = kitti_poses(folder)
    if not len(files) == len(times) == len(poses):
        raise ValueError(f"{folder}: has {len(files)} scans, {len(times)} times and {len(poses)} poses, "
                         "expected as many of each")
    for file, time, pose in zip(files, times, poses):
        content, label = read_regular(file), folder / "labels" / f"{file.stem}.label"
        given = read_regular(label) if label.parent.is_dir() else bytes(len(content) // 16 * 4)
        if len(content) != 4 * len(given) or len(content) % 16:
            raise ValueError(f"{file}: has {len(content)} bytes, and its labels have {len(given)}, "
                             "expected 16 and 4 for each point")
        labels = np.frombuffer(given, "<u4")
        x, y, z, light = np.frombuffer(content, "<f4").reshape(-1, 4).T
        if not ((light >= 0) & (light <= 1)).all():
            raise ValueError(f"{file}: the fourth numbers of its points are not all reflectances, "
                             "expected 0 to 1, as KITTI has them")
        parts, known = [x, y, z, 255 * light, labels & 0xffff, labels >> 16], folder / "offsets" / f"{file.stem}.offset"
        if known.exists():
            parts.append(np.rint(1e9 * np.frombuffer(read_regular(known), "<f4").astype(float)))
        if len(parts[-1]) != len(x):
            raise ValueError(f"{known}: has {len(parts[-1])} times, expected one for each of {len(x)} points")
        points = np.rec.fromarrays(parts, dtype=_TIMED if known.exists() else _POINT)
        yield file.stem, round(1e9 * time), pose, points


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def _bytes(*contents: bytes) -> bytes:
    """Contents, each after its length."""
    return b"".join(struct.pack("<I", len(content)) + content for content in contents)


def _messages(folder: pathlib.Path) -> Iterator[Tuple[int, Dict[int, bytes]]]:
    """Time (ns) and messages of each scan, by the channel."""
    boxes = (folder / "boxes").is_dir()
    for name, time, pose, points in _scans(folder):
        found = {_TF: _transform(time, pose), _POINTS: _cloud(time, points)}
        if boxes:
            found[_BOXES] = _boxes(time, folder / "boxes" / f"{name}.txt")
        yield time, found


def write(folder: pathlib.Path, out: pathlib.Path) -> int:
    """Writes a sequence and returns the number of scans. The suffix of `out` gives the format."""
    topics = {key: topic for key, topic in _TOPICS.items() if key != _BOXES or (folder / "boxes").is_dir()}
    with replacing(out) as name:
        return (_write_mcap if out.suffix.lower() == ".mcap" else _write_db3)(_messages(folder), topics, name)


def _write_db3(scans: Iterator[Tuple[int, Dict[int, bytes]]], topics: Dict[int, Tuple[str, str]], name: str) -> int:
    count = 0
    with contextlib.closing(sqlite3.connect(name)) as db, db:
        db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                   "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
        db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT "
                   "NULL, data BLOB NOT NULL)")
        db.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
        db.executemany("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')",
                       ((key, topic, kind.replace("/", "/msg/")) for key, (topic, kind) in topics.items()))
        for count, (time, messages) in enumerate(scans, 1):
            db.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                           ((key, time, message) for key, message in messages.items()))
    return count


def _write_mcap(scans: Iterator[Tuple[int, Dict[int, bytes]]], topics: Dict[int, Tuple[str, str]], name: str) -> int:
    """Each scan is a chunk with an index, not compressed."""
    known = b"".join(
        _record(SCHEMA, struct.pack("<H", key) + _bytes(
            kind.replace("/", "/msg/").encode(), b"ros2msg", schema(kind).encode()))
        + _record(CHANNEL, struct.pack("<HH", key, key) + _bytes(topic.encode(), b"cdr", b""))
        for key, (topic, kind) in topics.items())
    indices: List[bytes] = []
    times: List[int] = []
    with open(name, "wb") as file:
        file.write(MAGIC + _record(HEADER, _bytes(b"ros2", f"avian-lidar {__version__}".encode())) + known)
        for number, (time, messages) in enumerate(scans):
            times.append(time)
            records, offsets = b"", []
            for key, message in messages.items():
                offsets.append((key, len(records)))
                records += _record(MESSAGE, struct.pack("<HIQQ", key, number, time, time) + message)
            chunk = _record(CHUNK, struct.pack("<QQQI", time, time, len(records), zlib.crc32(records)) + _bytes(b"")
                            + struct.pack("<Q", len(records)) + records)
            begin, places = file.tell(), b""
            file.write(chunk)
            for key, offset in offsets:
                places += struct.pack("<HQ", key, file.tell())
                file.write(_record(MESSAGES, struct.pack("<HIQQ", key, 16, time, offset)))
            indices.append(_record(CHUNKS, struct.pack("<QQQQ", time, time, begin, len(chunk)) + _bytes(places)
                                   + struct.pack("<Q", file.tell() - begin - len(chunk)) + _bytes(b"")
                                   + struct.pack("<QQ", len(records), len(records))))
        file.write(_record(END, bytes(4)))
        summary, count = file.tell(), len(times)
        times = times or [0]
        numbers = count * len(topics), len(topics), len(topics), 0, 0, count, min(times), max(times)
        counts = _bytes(b"".join(struct.pack("<HQ", key, count) for key in topics))
        file.write(known + _record(STATISTICS, struct.pack("<QHIIIIQQ", *numbers) + counts) + b"".join(indices))
        file.write(_record(FOOTER, struct.pack("<QQI", summary, 0, 0)) + MAGIC)
    return count
