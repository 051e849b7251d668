# SPDX-License-Identifier: BSD-3-Clause
"""Writes a sequence as one MCAP file of ROS 2 messages: clouds, the pose of the sensor, and boxes around movers.

Sources: the MCAP specification (mcap.dev/spec), profile `ros2`; OMG CDR, little endian; definitions in
common_interfaces and geometry2 (Humble and later)."""
from __future__ import annotations

import math
import pathlib
import re
import struct
import zlib
from typing import Iterator, List, Sequence, Tuple

import numpy as np

from ..._disk import replacing
from ..._files import numbers_of, read_regular
from ..._version import __version__

_MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _MESSAGES, _CHUNKS, _STATISTICS, _END = *range(1, 9), 11, 15
_TF, _POINTS, _BOXES = 1, 2, 3  # numbers of the channels and of their schemas
_TOPICS = {_TF: ("/tf", "tf2_msgs/TFMessage"), _POINTS: ("/points", "sensor_msgs/PointCloud2"),
           _BOXES: ("/boxes", "visualization_msgs/MarkerArray")}
_STAMPED = "std_msgs/Header header"
_XYZ = "float64 x, float64 y, float64 z"
_TYPES = {
    "builtin_interfaces/Duration": "int32 sec, uint32 nanosec",
    "builtin_interfaces/Time": "int32 sec, uint32 nanosec",
    "geometry_msgs/Point": _XYZ,
    "geometry_msgs/Pose": "geometry_msgs/Point position, geometry_msgs/Quaternion orientation",
    "geometry_msgs/Quaternion": f"{_XYZ}, float64 w",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation, geometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped": f"{_STAMPED}, string child_frame_id, geometry_msgs/Transform transform",
    "geometry_msgs/Vector3": _XYZ,
    "sensor_msgs/CompressedImage": f"{_STAMPED}, string format, uint8[] data",
    "sensor_msgs/PointCloud2": f"{_STAMPED}, uint32 height, uint32 width, sensor_msgs/PointField[] fields, "
                               "bool is_bigendian, uint32 point_step, uint32 row_step, uint8[] data, bool is_dense",
    "sensor_msgs/PointField": "string name, uint32 offset, uint8 datatype, uint32 count",
    "std_msgs/ColorRGBA": "float32 r, float32 g, float32 b, float32 a",
    "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "visualization_msgs/Marker":
        f"{_STAMPED}, string ns, int32 id, int32 type, int32 action, geometry_msgs/Pose pose, "
        "geometry_msgs/Vector3 scale, std_msgs/ColorRGBA color, builtin_interfaces/Duration lifetime, "
        "bool frame_locked, geometry_msgs/Point[] points, std_msgs/ColorRGBA[] colors, string texture_resource, "
        "sensor_msgs/CompressedImage texture, visualization_msgs/UVCoordinate[] uv_coordinates, string text, "
        "string mesh_resource, visualization_msgs/MeshFile mesh_file, bool mesh_use_embedded_materials",
    "visualization_msgs/MarkerArray": "visualization_msgs/Marker[] markers",
    "visualization_msgs/MeshFile": "string filename, uint8[] data",
    "visualization_msgs/UVCoordinate": "float32 u, float32 v"}
_CODES = {"bool": "?", "uint8": "B", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}  # in module struct
_CUBE, _ADD, _DELETE_ALL = 1, 0, 3  # type and actions of markers
_BIRD, _OTHER = (0.1, 0.7, 0.3, 0.5), (0.6, 0.3, 0.8, 0.5)  # red, green, blue, opacity of birds and of other movers
_POINT = np.dtype([*((name, "<f4") for name in ("x", "y", "z", "intensity")), ("label", "<u2"), ("instance", "<u2")])
_DATATYPES = {"f": 7, "u": 4}  # in PointField, by the kind of a field of _POINT


def _schema(name: str) -> str:
    """The definition of a message, followed by the definitions of the types inside."""
    names = [name]
    for one in names:
        names += [kind for kind in dict.fromkeys(re.findall(r"\w+/\w+", _TYPES[one])) if kind not in names]
    texts = [_TYPES[one].replace(", ", "\n") + "\n" for one in names]
    return f"{'=' * 80}\n".join([texts[0], *(f"MSG: {one}\n{text}" for one, text in zip(names[1:], texts[1:]))])


def _put(data: bytearray, kind: str, value) -> bytearray:
    """Appends a value of a type; a message is the tuple of its fields. Each number starts at a multiple of its size."""
    if kind.endswith("[]"):
        _put(data, "uint32", len(value))
        if kind == "uint8[]":
            data += value
        else:
            for one in value:
                _put(data, kind[:-2], one)
    elif kind == "string":
        _put(data, "uint8[]", value.encode() + b"\0")
    elif kind in _CODES:
        data += bytes(-len(data) % struct.calcsize(_CODES[kind])) + struct.pack("<" + _CODES[kind], value)
    else:
        for field, one in zip(_TYPES[kind].split(", "), value):
            _put(data, field.split()[0], one)
    return data


def _message(key: int, *fields) -> bytes:
    """A message in a channel, little endian."""
    return b"\0\1\0\0" + _put(bytearray(), _TOPICS[key][1], fields)


def _transform(time: int, pose: np.ndarray) -> bytes:
    """The transform from the sensor's frame to the map."""
    from scipy.spatial.transform import Rotation
    rotation = Rotation.from_matrix(pose[:, :3]).as_quat()
    turned = rotation * (-1 if rotation[3] < 0 else 1)
    return _message(_TF, [((divmod(time, 10**9), "map"), "lidar", (pose[:, 3], turned))])


def _cloud(time: int, points: np.ndarray) -> bytes:
    fields = [(name, offset, _DATATYPES[kind.kind], 1) for name, (kind, offset, *_) in (_POINT.fields or {}).items()]
    data, stamped = points.tobytes(), (divmod(time, 10**9), "lidar")
    return _message(_POINTS, stamped, 1, len(points), fields, False, _POINT.itemsize, len(data), data, True)


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
    poses = numbers_of(folder / "poses.txt", 12).reshape(-1, 3, 4)
    if not len(files) == len(times) == len(poses):
        raise ValueError(f"{folder}: has {len(files)} scans, {len(times)} times and {len(poses)} poses, "
                         "expected as many of each")
    last = [0, 0, 0, 1]
    camera = np.vstack([*numbers_of(folder / "calib.txt", 12, key="Tr:").reshape(-1, 4), last])
    if camera.shape != (4, 4) or abs(np.linalg.det(camera)) < 0.5:
        raise ValueError(f"{folder / 'calib.txt'}: "
                         "expected one line Tr: with a rotation and a translation in 12 numbers")
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
        points = np.rec.fromarrays([x, y, z, 255 * light, labels & 0xffff, labels >> 16], dtype=_POINT)
        yield file.stem, round(1e9 * time), (np.linalg.inv(camera) @ np.vstack([pose, last]) @ camera)[:3], points


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def _bytes(*contents: bytes) -> bytes:
    """Contents, each after its length."""
    return b"".join(struct.pack("<I", len(content)) + content for content in contents)


def write(folder: pathlib.Path, out: pathlib.Path) -> int:
    """Writes a sequence and returns the number of scans. Each scan is a chunk with an index, not compressed."""
    topics = {key: topic for key, topic in _TOPICS.items() if key != _BOXES or (folder / "boxes").is_dir()}
    known = b"".join(
        _record(_SCHEMA, struct.pack("<H", key) + _bytes(
            kind.replace("/", "/msg/").encode(), b"ros2msg", _schema(kind).encode()))
        + _record(_CHANNEL, struct.pack("<HH", key, key) + _bytes(topic.encode(), b"cdr", b""))
        for key, (topic, kind) in topics.items())
    indices: List[bytes] = []
    times: List[int] = []
    with replacing(out) as name, open(name, "wb") as file:
        file.write(_MAGIC + _record(_HEADER, _bytes(b"ros2", f"avian-lidar {__version__}".encode())) + known)
        for number, (name_of_scan, time, pose, points) in enumerate(_scans(folder)):
            times.append(time)
            messages = {_TF: _transform(time, pose), _POINTS: _cloud(time, points)}
            if _BOXES in topics:
                messages[_BOXES] = _boxes(time, folder / "boxes" / f"{name_of_scan}.txt")
            records, offsets = b"", []
            for key, message in messages.items():
                offsets.append((key, len(records)))
                records += _record(_MESSAGE, struct.pack("<HIQQ", key, number, time, time) + message)
            chunk = _record(_CHUNK, struct.pack("<QQQI", time, time, len(records), zlib.crc32(records)) + _bytes(b"")
                            + struct.pack("<Q", len(records)) + records)
            begin, places = file.tell(), b""
            file.write(chunk)
            for key, offset in offsets:
                places += struct.pack("<HQ", key, file.tell())
                file.write(_record(_MESSAGES, struct.pack("<HIQQ", key, 16, time, offset)))
            indices.append(_record(_CHUNKS, struct.pack("<QQQQ", time, time, begin, len(chunk)) + _bytes(places)
                                   + struct.pack("<Q", file.tell() - begin - len(chunk)) + _bytes(b"")
                                   + struct.pack("<QQ", len(records), len(records))))
        file.write(_record(_END, bytes(4)))
        summary, count = file.tell(), len(times)
        times = times or [0]
        numbers = count * len(topics), len(topics), len(topics), 0, 0, count, min(times), max(times)
        counts = _bytes(b"".join(struct.pack("<HQ", key, count) for key in topics))
        file.write(known + _record(_STATISTICS, struct.pack("<QHIIIIQQ", *numbers) + counts) + b"".join(indices))
        file.write(_record(_FOOTER, struct.pack("<QQI", summary, 0, 0)) + _MAGIC)
    return count
