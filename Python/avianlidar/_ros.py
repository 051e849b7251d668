# SPDX-License-Identifier: BSD-3-Clause
"""Messages of ROS as bytes: clouds, transforms and boxes.

Sources: OMG CDR (XCDR1, of both byte orders); definitions in common_interfaces and geometry2 (Humble and later);
wiki.ros.org/msg for ROS 1, which has the same messages without gaps between numbers."""
import re
import struct
from typing import Any, NamedTuple

import numpy as np

CLOUD, TRANSFORMS = "sensor_msgs/PointCloud2", "tf2_msgs/TFMessage"
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
    CLOUD: f"{_STAMPED}, uint32 height, uint32 width, sensor_msgs/PointField[] fields, bool is_bigendian, "
           "uint32 point_step, uint32 row_step, uint8[] data, bool is_dense",
    "sensor_msgs/PointField": "string name, uint32 offset, uint8 datatype, uint32 count",
    "std_msgs/ColorRGBA": "float32 r, float32 g, float32 b, float32 a",
    "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
    TRANSFORMS: "geometry_msgs/TransformStamped[] transforms",
    "visualization_msgs/Marker":
        f"{_STAMPED}, string ns, int32 id, int32 type, int32 action, geometry_msgs/Pose pose, "
        "geometry_msgs/Vector3 scale, std_msgs/ColorRGBA color, builtin_interfaces/Duration lifetime, "
        "bool frame_locked, geometry_msgs/Point[] points, std_msgs/ColorRGBA[] colors, string texture_resource, "
        "sensor_msgs/CompressedImage texture, visualization_msgs/UVCoordinate[] uv_coordinates, string text, "
        "string mesh_resource, visualization_msgs/MeshFile mesh_file, bool mesh_use_embedded_materials",
    "visualization_msgs/MarkerArray": "visualization_msgs/Marker[] markers",
    "visualization_msgs/MeshFile": "string filename, uint8[] data",
    "visualization_msgs/UVCoordinate": "float32 u, float32 v"}
ROS1 = b"\x7f\1\0\0"  # stands before a message of ROS 1, where CDR has its header
_CODES = {"bool": "?", "uint8": "B", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}  # in module struct
_NUMBERS = ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")  # datatypes of PointField, from 1 on


def schema(name: str) -> str:
    """The definition of a message, followed by the definitions of the types inside."""
    names = [name]
    for one in names:
        names += [kind for kind in dict.fromkeys(re.findall(r"\w+/\w+", _TYPES[one])) if kind not in names]
    texts = [_TYPES[one].replace(", ", "\n") + "\n" for one in names]
    return f"{'=' * 80}\n".join([texts[0], *(f"MSG: {one}\n{text}" for one, text in zip(names[1:], texts[1:]))])


def _put(data: bytearray, kind: str, value: Any) -> bytearray:
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


def packed(kind: str, *fields: Any) -> bytes:
    """A message as bytes, little endian."""
    return b"\0\1\0\0" + _put(bytearray(), kind, fields)


class _Reading:
    """A position in the bytes of a message."""

    def __init__(self, data: memoryview):
        self.is_ros1 = bytes(data[:4]) == ROS1
        if len(data) < 4 or data[0] != 0 and not self.is_ros1 or data[1] > 1:
            raise ValueError("is not CDR as ROS 2 writes it")
        self.data, self.at, self.order = data[4:], 0, "<" if data[1] else ">"

    def take(self, kind: str) -> Any:
        if kind.endswith("[]"):
            count = self.take("uint32")
            if kind != "uint8[]":
                if count > len(self.data):
                    raise ValueError(f"says that it has {count} items of {kind[:-2]}")
                return [self.take(kind[:-2]) for _ in range(count)]
            if count > len(self.data) - self.at:
                raise ValueError(f"ends within {count} bytes")
            self.at += count
            return self.data[self.at - count:self.at]
        if kind == "string":
            return bytes(self.take("uint8[]")).rstrip(b"\0").decode("utf-8", "replace")
        if kind in _CODES:
            code = self.order + _CODES[kind]
            size = struct.calcsize(code)
            begin = self.at if self.is_ros1 else self.at + -self.at % size
            if begin + size > len(self.data):
                raise ValueError("ends too early")
            self.at = begin + size
            return struct.unpack_from(code, self.data, begin)[0]
        if self.is_ros1 and kind == "std_msgs/Header":
            self.take("uint32")  # number of the message
        return tuple(self.take(field.split()[0]) for field in _TYPES[kind].split(", "))


def unpacked(kind: str, data) -> Any:
    """The fields of a message. ValueError if the bytes are damaged. Bytes inside are memory of `data`."""
    return _Reading(memoryview(data)).take(kind)


class PointCloud(NamedTuple):
    """A cloud in a message."""
    stamp: int  # ns since 1970, or since another time that the driver chose
    frame: str  # name of the sensor's frame
    rows: np.ndarray  # a structured array with the fields of each point


def cloud_of(data) -> PointCloud:
    """The cloud in the bytes of a PointCloud2. ValueError if the message is damaged or has no x, y and z."""
    ((seconds, nanoseconds), frame), height, width, fields, big, step, row_step, content, _ = unpacked(CLOUD, data)
    known = {name: (f"{'>' if big else '<'}{_NUMBERS[kind - 1]}", offset, count) for name, offset, kind, count in fields
             if 1 <= kind <= len(_NUMBERS) and count}
    if not {"x", "y", "z"} <= known.keys():
        raise ValueError(f"has the fields {', '.join(known) or 'none'}, expected x, y and z among them")
    try:
        dtype = np.dtype({"names": [*known], "formats": [(code, (count,)) if count > 1 else code
                                                         for code, _, count in known.values()],
                          "offsets": [offset for _, offset, _ in known.values()], "itemsize": step})
        bytes_of_rows = np.frombuffer(content, np.uint8)[:height * row_step].reshape(height, row_step)
        rows = np.ascontiguousarray(bytes_of_rows[:, :width * step]).reshape(-1).view(dtype)
        if len(rows) != height * width:
            raise ValueError
    except ValueError:
        raise ValueError(f"says that it has {height} rows of {width} points in {step} bytes each, but holds "
                         f"{len(content)} bytes") from None
    return PointCloud(10**9 * seconds + nanoseconds, frame, rows)
