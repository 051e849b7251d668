# SPDX-License-Identifier: BSD-3-Clause
"""Messages in bags of ROS: .mcap, .db3 and .bag files (the last by Debian's python3-rosbag), read from the beginning to
the end.

Sources: the MCAP specification (mcap.dev/spec); the SQLite schema of rosbag2."""
import contextlib
import pathlib
import re
import sqlite3
import struct
import urllib.parse
import zlib
from collections.abc import Collection, Iterator
from typing import Any, NamedTuple

from ._files import require_regular
from ._ros import ROS1

SUFFIXES = (".mcap", ".db3", ".bag")
MAGIC = b"\x89MCAP0\r\n"
MOST = 1 << 30  # bytes of a chunk or a message after decompression
(HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGES, CHUNKS), STATISTICS, END = range(1, 9), 11, 15  # records
_ZSTD = b"\x28\xb5\x2f\xfd"  # beginning of what zstd has compressed


class Message(NamedTuple):
    """A message of a bag."""
    topic: str
    kind: str  # as sensor_msgs/PointCloud2
    time: int  # of the recording computer, ns since 1970
    data: Any  # bytes


class Torn(ValueError):
    """The end of a file is missing."""


def _decompressed(kind: str, data: bytes, size: int) -> bytes:
    """Decompressed bytes. @param kind lz4, zstd or empty @param size number of bytes, as the file says"""
    if size > MOST:
        raise ValueError(f"a part has {size:,} bytes, expected at most {MOST:,}")
    if kind in ("", "none"):
        return data
    if kind == "lz4":
        import lz4.frame
        unpacked = lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    elif kind == "zstd":
        import zstandard
        try:
            unpacked = zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
        except zstandard.ZstdError as error:
            raise ValueError(f"its compression by zstd is damaged ({error})") from None
    else:
        raise ValueError(f"is compressed by {kind}, expected lz4, zstd or none")
    if len(unpacked) != size:
        raise ValueError(f"a part has {len(unpacked)} bytes after decompression, expected {size}")
    return unpacked


def _texts(data: memoryview, at: int, count: int) -> tuple[list[str], int]:
    """Texts, each after its length, and the offset behind."""
    found = []
    for _ in range(count):
        (length,) = struct.unpack_from("<I", data, at)
        found.append(bytes(data[at + 4:at + 4 + length]).decode("utf-8", "replace"))
        at += 4 + length
    return found, at


def _records(stream, size: int) -> Iterator[tuple[int, memoryview]]:
    """The records of a file: kind and content. Records without messages are not read."""
    while True:
        head = stream.read(9)
        if not head:
            raise Torn("ends without an end of the data")
        kind, length = struct.unpack("<BQ", head) if len(head) == 9 else (0, 0)
        if not kind or length > size - stream.tell():
            raise Torn("ends within a record")
        if kind in (SCHEMA, CHANNEL, MESSAGE, CHUNK):
            yield kind, memoryview(stream.read(length))
        elif kind in (END, FOOTER):
            return
        else:
            stream.seek(length, 1)


def _inside(records: memoryview) -> Iterator[tuple[int, memoryview]]:
    """The records of a chunk."""
    at = 0
    while at < len(records):
        kind, length = struct.unpack_from("<BQ", records, at)
        if length > len(records) - at - 9:
            raise ValueError("a record reaches beyond its chunk")
        yield kind, records[at + 9:at + 9 + length]
        at += 9 + length


def _in_mcap(path: pathlib.Path, kinds: Collection[str]) -> Iterator[Message]:
    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, str]] = {}

    def messages(kind: int, content: memoryview) -> Iterator[Message]:
        if kind == SCHEMA:
            (name,), _ = _texts(content, 2, 1)
            schemas[struct.unpack_from("<H", content)[0]] = name.replace("/msg/", "/")
        elif kind == CHANNEL:
            number, of = struct.unpack_from("<HH", content)
            (topic, encoding), _ = _texts(content, 4, 2)
            if schemas.get(of) in kinds and encoding != "cdr":
                raise ValueError(f"has {topic} in the encoding {encoding!r}, expected cdr, as ROS 2 writes it")
            channels[number] = topic, schemas.get(of, "")
        elif kind == MESSAGE:
            number, _, time, _ = struct.unpack_from("<HIQQ", content)
            topic, of = channels.get(number, ("", ""))
            if of in kinds:
                yield Message(topic, of, time, content[22:])
        elif kind == CHUNK:
            _, _, length, checksum = struct.unpack_from("<QQQI", content)
            (compression,), at = _texts(content, 28, 1)
            records = _decompressed(compression, content[at + 8:], length)
            if checksum and zlib.crc32(records) != checksum:
                raise ValueError("a chunk does not have its checksum")
            for part in _inside(memoryview(records)):
                yield from messages(*part)

    with open(path, "rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise ValueError("is not an MCAP file")
        for record in _records(stream, path.stat().st_size):
            yield from messages(*record)


def _in_db3(path: pathlib.Path, kinds: Collection[str]) -> Iterator[Message]:
    name = f"file:{urllib.parse.quote(str(path.resolve()))}?mode=ro"
    if not path.with_name(f"{path.name}-wal").exists():
        name += "&immutable=1"  # else SQLite writes files beside a bag in its mode WAL
    with contextlib.closing(sqlite3.connect(name, uri=True)) as db:
        topics = {number: (name, kind.replace("/msg/", "/"))
                  for number, name, kind, encoding in db.execute(
                      "SELECT id, name, type, serialization_format FROM topics") if encoding == "cdr"}
        wanted = [number for number, (_, kind) in topics.items() if kind in kinds]
        query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({','.join('?' * len(wanted))}) " \
                "ORDER BY timestamp"
        for number, time, data in db.execute(query, wanted):
            if data[:4] == _ZSTD:
                import zstandard
                size = zstandard.frame_content_size(data)
                data = _decompressed("zstd", data, size)
            yield Message(*topics[number], time, data)


def _in_bag(path: pathlib.Path, kinds: Collection[str]) -> Iterator[Message]:
    """The messages of a bag of ROS 1."""
    try:
        import rosbag
    except ImportError:
        raise ImportError(f"{path}: a bag of ROS 1 needs rosbag, which is not installed: install python3-rosbag"
                          ) from None
    try:
        with rosbag.Bag(str(path)) as bag:
            for topic, (kind, data, *_), time in bag.read_messages(raw=True):
                kind = "tf2_msgs/TFMessage" if kind == "tf/tfMessage" else kind  # the same message
                if kind in kinds:
                    yield Message(topic, kind, time.to_nsec(), ROS1 + data)
    except rosbag.ROSBagUnindexedException:
        raise ValueError("has no index, as after a recording that was killed: `rosbag reindex` makes it") from None
    except rosbag.ROSBagException as error:
        raise ValueError(f"is not a bag of ROS 1 ({error})") from None


def files_of(folder: pathlib.Path, notes: list[str]) -> list[pathlib.Path]:
    """The files of a bag in a folder, in the order of the numbers at the ends of their names. @param notes sentences on
    parts that are missing are added"""
    files = [file for file in sorted(folder.iterdir())
             if file.suffix.lower() in SUFFIXES and not file.name.startswith(".")]
    listed = folder / "metadata.yaml"
    if files and listed.is_file():
        parts = re.findall(r"^\s*-\s+[\"']?(\S+\.(?:mcap|db3))[\"']?\s*$", listed.read_text("utf-8", "replace"), re.M)
        missing = [part for part in parts if not (folder / part).exists()]
        notes += [f"{listed} names {missing[0]}, which is missing ({len(missing)} of {len(parts)} parts)"] if missing else []
    packed = [file.name for file in folder.glob("*.db3.zstd")]
    if not files and packed:
        raise ValueError(f"{folder}: {packed[0]} is compressed as a whole, expected .db3 or .mcap: decompress it "
                         "first, by zstd -d")
    return sorted(files, key=lambda file: (file.suffix, int((re.findall(r"\d+", file.stem) or ["0"])[-1])))


def messages(files: list[pathlib.Path], kinds: Collection[str], notes: list[str]) -> Iterator[Message]:
    """The messages of some kinds in the files of a bag. @param notes sentences on files whose end is missing are added"""
    for file in files:
        require_regular(file)
        read = {".mcap": _in_mcap, ".db3": _in_db3, ".bag": _in_bag}[file.suffix.lower()]
        began = False
        try:
            for message in read(file, kinds):
                began = True
                yield message
        except sqlite3.DatabaseError as error:
            if not began:
                raise ValueError(f"{file}: is not a bag of ROS 2, or is damaged ({error})") from None
            notes.append(f"{file}: {error}: the scans behind are missing")
        except Torn as error:
            notes.append(f"{file}: {error}: its last scans may be missing")
        except (ValueError, RuntimeError, struct.error) as error:  # RuntimeError of lz4
            raise ValueError(f"{file}: {error}") from None
