# SPDX-License-Identifier: BSD-3-Clause
"""Recorded scans as one source: numbered files, bags of ROS, and folders of SemanticKITTI and nuScenes."""
import collections
import glob
import json
import pathlib
import re
import tempfile
import warnings
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

from . import _bags, _ros
from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud, add_array
from ._files import file_name, load_cloud, numbers_of, read_regular
from ._pipeline import callers_level, update
from ._suffixes import PACKETS, READERS, TABLES

SUFFIXES = (*READERS, *TABLES, ".vtp")
# From x forward, y left, as KITTI and ROS have it, to x right, y forward, as clouds have it.
TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
SENSOR, OF_FILE = "of the sensor: right, forward and up", "of the files"
EXPECTED = ("numbered files, a folder or a pattern of them, a bag of ROS (.mcap, .db3, .bag, or its folder), a sequence of "
            "SemanticKITTI, or the folder of nuScenes")
BEYOND = 200_000_000  # ns: how far a pose serves before the first and after the last of its times without a warning
# Times of points in clouds of ROS, by the drivers of Ouster, Velodyne, Hesai and Livox, and Autoware.
_POINT_TIMES = ("t", "time", "timestamp", "time_stamp", "offset_time")
SINCE_1970 = 1e9  # larger times count from 1970
SHORTEST = 1e6  # ns: whole numbers that differ by less are us
LONGEST = 1e7  # us: times of points that differ by more are not times of one scan


class _Scans(NamedTuple):
    """What a kind of recording knows before its scans are read."""
    times: np.ndarray  # s, rising
    origin: str  # where the times come from
    frame: str
    poses: list[np.ndarray] | None  # 3 x 4, of each scan
    clouds: Callable[[], Iterator[Cloud]]
    left_out: dict[str, int]  # number of scans by the reason
    notes: list[str]  # sentences on what may be missing or is assumed
    files: list[pathlib.Path]  # that vtkAvianLidarPointCloudReader reads as the same scans


class Recording:
    """Recorded scans in the order of their times. A scan is read when it is needed: `for cloud in recording`.

    Each cloud has the field data `TimeValue` (s), so that the clutter filter and the tracker know its time.

    >>> recording = load_clouds("scans/*.pcd", rate=10)                                              # doctest: +SKIP
    >>> for cloud, time in zip(recording, recording.times):                                         # doctest: +SKIP
    ...     print(time, cloud.number_of_points)
    """

    def __init__(self, source, scans: _Scans, rate: float | None = None):
        self.source, self.rate = source, rate
        self.times, self.times_from, self.frame, self.poses, self._clouds, self.left_out, notes, self.files = scans
        if not len(self.times):
            reasons = [f"{count} {reason}" for reason, count in self.left_out.items()] + notes
            raise ValueError(f"{source}: has no scan{': ' + '; '.join(reasons) if reasons else ''}")
        for note in notes:
            warnings.warn(f"{source}: {note}", RuntimeWarning, stacklevel=callers_level())
        for reason, count in self.left_out.items():
            warnings.warn(f"{source}: {count} {'scan is' if count == 1 else 'scans are'} left out: {reason}",
                          RuntimeWarning, stacklevel=callers_level())

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Cloud]:
        """Each kind of warning about a scan is said once."""
        said: set[str] = set()
        clouds = self._clouds()
        for time in self.times.tolist():
            with warnings.catch_warnings(record=True) as heard:
                warnings.simplefilter("always")
                cloud = next(clouds)
            for text in (str(one.message) for one in heard):
                kind = re.sub(r"\S*/\S+|\d+", "", text)
                if kind not in said:
                    said.add(kind)
                    warnings.warn(text, RuntimeWarning, stacklevel=callers_level())
            add_array(cloud.data.GetFieldData(), "TimeValue", np.array([time]), "s")
            yield cloud

    def __repr__(self) -> str:
        return f"<Recording of {len(self)} scans in {self.times[-1] - self.times[0]:.6g} s: {self.source}>"

    def pose(self, number: int) -> np.ndarray:
        """The matrix (3 x 4) from the coordinates of a scan to the fixed frame of the recording; the identity if the
        recording has no poses."""
        return np.eye(3, 4) if self.poses is None else self.poses[number]

    @property
    def moves(self) -> bool:
        """Whether the sensor moves by more than 0.1 m or 0.01 rad."""
        if self.poses is None:
            return False
        change = np.abs(np.array(self.poses) - self.poses[0]).max(axis=0)
        return bool(change[:, 3].max() > 0.1 or change[:, :3].max() > 0.01)


def kitti_poses(folder: pathlib.Path, calibrated: bool = True) -> np.ndarray:
    """Poses of the lidar (n x 3 x 4) in poses.txt. A calibration turns poses of a camera into poses of the lidar.
    @param calibrated whether calib.txt must be there"""
    poses = numbers_of(folder / "poses.txt", 12).reshape(-1, 3, 4)
    last = [0, 0, 0, 1]
    if not calibrated and not (folder / "calib.txt").exists():
        return poses
    camera = np.vstack([*numbers_of(folder / "calib.txt", 12, key="Tr:").reshape(-1, 4), last])
    if camera.shape != (4, 4) or abs(np.linalg.det(camera)) < 0.5:
        raise ValueError(f"{folder / 'calib.txt'}: "
                         "expected one line Tr: with a rotation and a translation in 12 numbers")
    return np.array([(np.linalg.inv(camera) @ np.vstack([pose, last]) @ camera)[:3] for pose in poses])


def _cloud(file: pathlib.Path, **properties: Any) -> Cloud:
    """A cloud, in metres east, north and up of its own origin if there is one."""
    local = {"local_coordinates": True} if file.suffix.lower() in (".las", ".laz") else {}
    return load_cloud(file, **local, **properties)


def _of_files(files: list[pathlib.Path], rate: float | None, notes: list[str], address: dict[str, str]) -> _Scans:
    suffixes = collections.Counter(file.suffix.lower() for file in files)
    if len(suffixes) > 1:
        raise ValueError(f"{files[0].parent}: has {', '.join(f'{count} {name}' for name, count in suffixes.items())}, "
                         "expected the files of one kind: a pattern such as scans/*.pcd chooses them")
    (suffix,) = suffixes
    if suffix in PACKETS and len(files) > 1:
        raise ValueError(f"{files[0]}: {len(files)} files of packets, expected one: each of its revolutions is a scan")
    frame, known = SENSOR if suffix in (".bin", *PACKETS) else OF_FILE, files if suffix in READERS else []
    if len(files) == 1 and suffix not in PACKETS:
        return _Scans(np.zeros(1), "one file", frame, None, lambda: iter([_cloud(files[0])]), {}, notes, known)
    reader = _wrapped.vtkAvianLidarPointCloudReader()
    for file in files:
        reader.AddFileName(file_name(file))
    reader.SetScanRate(rate or 0.0)
    if address:
        reader.SetSensorAddress(address["sensor_address"])
    reader.UpdateInformation()
    found = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    if not found:
        update(reader)  # raises the error
    times = np.array(found)
    if suffix in PACKETS:
        return _Scans(times, "packets, s since the full hour", frame, None,
                      lambda: (_cloud(files[0], time=time, **address) for time in times.tolist()), {}, notes, known)
    names = [pathlib.Path(reader.GetScanFileName(k)) for k in range(len(times))]
    poses, home = None, files[0].parent.parent
    if suffix == ".bin" and (home / "poses.txt").exists():
        poses = [np.column_stack([pose[:, :3] @ TURNED.T, pose[:, 3]]) for pose in kitti_poses(home, calibrated=False)]
        if len(poses) != len(names):
            raise ValueError(f"{home / 'poses.txt'}: has {len(poses)} poses, expected one for each of "
                             f"{len(names)} scans")
    return _Scans(times, reader.GetScanTimes(), frame, poses, lambda: map(_cloud, names), {}, notes,
                  names if known else [])


class _Transforms:
    """Poses of frames, which messages of ROS give."""

    def __init__(self) -> None:
        self.parents: dict[str, str] = {}
        self.known: dict[str, dict[int, tuple[Any, Any]]] = collections.defaultdict(dict)  # by child and time, ns

    def add(self, data, static: bool) -> None:
        """@param static whether the transforms replace earlier ones"""
        (transforms,) = _ros.unpacked(_ros.TRANSFORMS, data)
        for ((seconds, nanoseconds), parent), child, transform in transforms:
            if not np.isfinite([*transform[0], *transform[1]]).all() or np.linalg.norm(transform[1]) < 0.5:
                raise ValueError(f"gives {child} the place {transform[0]} and the rotation {transform[1]}, expected "
                                 "finite numbers and a unit quaternion")
            child = child.lstrip("/")
            self.parents[child] = parent.lstrip("/")
            if static:
                self.known[child].clear()
            self.known[child][10**9 * seconds + nanoseconds] = transform

    def _step(self, child: str, stamp: Any) -> np.ndarray:
        """The matrix (4 x 4) from a frame to its parent, at a time or at each of several times: linear in place and
        spherical in rotation between times, and the nearest one before the first and after the last time."""
        from scipy.spatial.transform import Rotation, Slerp
        known = self.known[child]
        times = sorted(known)
        places = np.array([known[time][0] for time in times])
        turns = Rotation.from_quat([known[time][1] for time in times])
        seconds = 1e-9 * np.array([time - times[0] for time in times])
        at = np.clip(1e-9 * (np.asarray(stamp) - times[0]), seconds[0], seconds[-1])
        turn = Slerp(seconds, turns)(at) if len(times) > 1 else turns[0]
        matrix = np.zeros((*at.shape, 4, 4))
        matrix[..., :3, :3] = turn.as_matrix()
        matrix[..., :3, 3] = np.stack([np.interp(at, seconds, places[:, axis]) for axis in range(3)], -1)
        matrix[..., 3, 3] = 1.0
        return matrix

    def above(self, frame: str) -> list[str]:
        """The frame and all frames above it that have a parent, upwards."""
        found: list[str] = []
        while frame in self.parents:
            if frame in found:
                raise ValueError(f"the frame {frame} is above itself in the messages of tf")
            found.append(frame)
            frame = self.parents[frame]
        return found

    def covers(self, frame: str, stamp: int) -> bool:
        """Whether a time is not far outside the times of any moving frame above."""
        moving = [times for times in (self.known[one] for one in self.above(frame)) if len(times) > 1]
        return all(min(times) - BEYOND <= stamp <= max(times) + BEYOND for times in moving)

    def pose(self, frame: str, stamp: Any) -> np.ndarray | None:
        """The matrix (3 x 4) from a frame to the frame that has no parent; None for an unknown frame.
        @param stamp a time (ns), or an array of n times, which gives n x 3 x 4"""
        if frame not in self.parents:
            return None
        matrix = np.eye(4)
        for one in self.above(frame):
            matrix = self._step(one, stamp) @ matrix
        return matrix[..., :3, :]


def moving_poses(path: pathlib.Path, frame: str, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Times (ns) and matrices (n x 3 x 4) from a frame's x right, y forward and z up to the fixed frame of a bag, at
    the times of all moving transforms above the frame.

    path   the bag or its folder
    frame  default: the frame of the clouds if they have one, else the only moving frame that has none below
    notes  sentences on parts that are missing are added
    """
    transforms, clouds = _Transforms(), set()
    for message in _bags.messages(_bags.files_of(path, notes) if path.is_dir() else [path],
                                  (_ros.TRANSFORMS, *([] if frame else [_ros.CLOUD])), notes):
        try:
            if message.kind == _ros.TRANSFORMS:
                transforms.add(message.data, message.topic.endswith("static"))
            else:
                clouds.add(_ros.unpacked(_ros.CLOUD, message.data)[0][1].lstrip("/"))
        except ValueError as error:
            raise ValueError(f"{path}: a message of {message.topic} {error}") from None
    known = {child: [*poses.values()] for child, poses in transforms.known.items()}
    moving = {child for child, poses in known.items() if any(pose != poses[0] for pose in poses)}
    frames = {frame.lstrip("/")} if frame else clouds if len(clouds) == 1 else moving - {
        transforms.parents[child] for child in moving}
    above = transforms.above(next(iter(frames), ""))
    stamps = [np.array(sorted(transforms.known[one]), np.int64) for one in above if one in moving]
    if len(frames) != 1 or not stamps:
        raise ValueError(f"{path}: {' and '.join(sorted(frames)) or 'no frame'} may be meant, expected the choice of "
                         f"one frame that moves: {', '.join(sorted(moving)) or 'the messages of /tf have none'}")
    times = np.unique(np.concatenate(stamps))
    times = times[(times >= max(one[0] for one in stamps)) & (times <= min(one[-1] for one in stamps))]
    if not len(times):
        raise ValueError(f"{path}: {', '.join(above)} have no time in common, expected transforms of one recording")
    poses = transforms.pose(above[0], times)
    assert poses is not None
    poses[..., :3] = poses[..., :3] @ TURNED.T
    return times, poses


def _topic_of(source, counts: "collections.Counter[str]", topic: str | None) -> str:
    listed = ", ".join(f"{name} ({count})" for name, count in counts.items())
    if not counts:
        raise ValueError(f"{source}: has no message of {_ros.CLOUD}, expected recorded clouds; packets of a lidar must "
                         "be converted by its driver first")
    if topic is None and len(counts) > 1:
        raise ValueError(f"{source}: has clouds in {listed}, expected the choice of one topic (--topic)")
    if topic is not None and topic not in counts:
        raise ValueError(f"{source}: has no clouds in {topic}, expected one of {listed}")
    return topic or next(iter(counts))


def _of_bag(source, files: list[pathlib.Path], topic: str | None, notes: list[str]) -> _Scans:
    counts: collections.Counter[str] = collections.Counter()
    found: dict[str, list[tuple[int, int, str, str]]] = collections.defaultdict(list)  # stamp, time, frame, fault
    transforms = _Transforms()
    for message in _bags.messages(files, (_ros.CLOUD, _ros.TRANSFORMS), notes):
        try:
            if message.kind == _ros.TRANSFORMS:
                transforms.add(message.data, message.topic.endswith("static"))
                continue
        except ValueError as error:
            raise ValueError(f"{source}: a message of {message.topic} {error}") from None
        counts[message.topic] += 1
        try:
            cloud = _ros.cloud_of(message.data)
            found[message.topic].append((cloud.stamp, message.time, cloud.frame.lstrip("/"), ""))
        except ValueError as error:
            found[message.topic].append((0, message.time, "", str(error)))
    if not counts and notes:
        raise ValueError(f"{source}: has no whole message of {_ros.CLOUD}: {notes[0]}")
    topic = _topic_of(source, counts, topic)
    rows = found[topic]
    left_out: collections.Counter[str] = collections.Counter()
    has_clock = any(stamp for stamp, _, _, fault in rows if not fault)
    kept: list[tuple[int, int]] = []  # stamps, and numbers of the messages
    for number, (stamp, time, _, fault) in enumerate(rows):
        if fault or has_clock and stamp <= 0 and stamp != time:
            left_out[f"damaged: {fault}" if fault else "without a time"] += 1
        else:
            kept.append((stamp if has_clock else time, number))
    kept.sort()
    twice = {number for (before, _), (stamp, number) in zip(kept, kept[1:]) if stamp == before}
    if twice:
        left_out["of the same time as the scan before"] += len(twice)
    kept = [one for one in kept if one[1] not in twice]
    if not kept and rows[0][3]:
        raise ValueError(f"{source}: a message of {topic} {rows[0][3]}")
    poses = [transforms.pose(rows[number][2], stamp) for stamp, number in kept]
    known = None
    if all(pose is not None for pose in poses):
        known = [np.column_stack([pose[:, :3] @ TURNED.T, pose[:, 3]]) for pose in poses if pose is not None]
        outside = sum(not transforms.covers(rows[number][2], stamp) for stamp, number in kept)
        if outside:
            notes.append(f"{outside} of {len(kept)} scans are before the first or after the last pose of /tf, and have "
                         "the nearest pose")

    def clouds() -> Iterator[Cloud]:
        """In the order of the times. Scans that come early in the bag wait."""
        turn = {number: order for order, (_, number) in enumerate(kept)}
        waiting: dict[int, Any] = {}
        number, following = -1, 0
        with tempfile.TemporaryDirectory() as folder:
            for message in _bags.messages(files, (_ros.CLOUD,), []):
                number += message.topic == topic
                if message.topic == topic and number in turn:
                    waiting[turn[number]] = message.data
                    while following in waiting:
                        yield _from_rows(_ros.cloud_of(waiting.pop(following)), pathlib.Path(folder) / "scan.pcd")
                        following += 1
    times = np.array([1e-9 * stamp for stamp, _ in kept])
    return _Scans(times, f"messages of {topic}, s", SENSOR, known, clouds, dict(left_out), notes, [])


def _from_rows(cloud: _ros.PointCloud, file: pathlib.Path) -> Cloud:
    """A cloud of a message. Its rows go through the reader of PCD files, whose binary layout is the same. Beams without
    an echo are at (0, 0, 0) or not finite, and are left out. @param file name of a file that may be overwritten"""
    rows = cloud.rows
    finite = np.isfinite(rows["x"]) & np.isfinite(rows["y"]) & np.isfinite(rows["z"])
    rows = rows[finite & ((rows["x"] != 0) | (rows["y"] != 0) | (rows["z"] != 0))]
    names = [name for name in rows.dtype.names if not set(name) & set(" \t\n")]
    renamed = {"label": "semantic_label", "instance": "instance_id"} if "instance" in names else {}  # of this project
    own = np.empty(len(rows), [(name, rows.dtype[name].newbyteorder("<")) for name in names])
    for name in names:
        own[name] = rows[name]
    own["x"], own["y"] = -rows["y"], rows["x"]
    parts = [(own.dtype[name].base, int(np.prod(own.dtype[name].shape, dtype=int))) for name in names]
    header: dict[str, list[Any]] = {"VERSION": ["0.7"], "FIELDS": [renamed.get(name, name) for name in names],
              "SIZE": [kind.itemsize for kind, _ in parts], "TYPE": [kind.kind.upper() for kind, _ in parts],
              "COUNT": [count for _, count in parts], "WIDTH": [len(own)], "HEIGHT": [1],
              "VIEWPOINT": [0, 0, 0, 1, 0, 0, 0], "POINTS": [len(own)], "DATA": ["binary"]}
    text = "".join(f"{key} {' '.join(map(str, values))}\n" for key, values in header.items())
    file.write_bytes(text.encode() + own.tobytes())
    found = load_cloud(file)
    if len(own) and len(own) == found.number_of_points:
        times = _times_of(own, cloud.stamp)
        if times is not None:
            add_array(found.data.GetPointData(), "timestamp", times, "us")
    return found


def _times_of(rows: np.ndarray, stamp: int) -> np.ndarray | None:
    """Times of points, us since 1970, of the fields that drivers write; None without a field whose times are sensible.
    @param stamp time of the scan, ns"""
    for name in _POINT_TIMES:
        if name not in (rows.dtype.names or ()) or rows.dtype[name].shape:
            continue
        values = rows[name].astype(float)
        first, span = abs(values[0]), np.ptp(values)
        if first > SINCE_1970:  # in s, ms, us or ns since 1970
            times = values * 10.0 ** (6 - 3 * round((np.log10(first) - 9.2) / 3.0))
        else:  # since the scan began, floats in s and integers in ns or us
            seconds = values * (1.0 if rows.dtype[name].kind == "f" else 1e-9 if span > SHORTEST else 1e-6)
            times = 1e6 * seconds + 1e-3 * stamp
        if np.isfinite(span) and np.ptp(times) < LONGEST:
            return times
    return None


def _of_nuscenes(root: pathlib.Path, scene: str | None) -> _Scans:
    """The scans of the lidar on top, in one scene of nuScenes. Source: the schema of nuScenes (nuscenes.org)."""
    from scipy.spatial.transform import Rotation
    (home, *_) = sorted(root.glob("v1.0-*"))

    def table(name: str) -> list[dict[str, Any]]:
        try:
            return json.loads(read_regular(home / f"{name}.json", 1 << 31))
        except ValueError as error:
            raise ValueError(f"{home / name}.json: {error}") from None

    def matrix(row: dict[str, Any]) -> np.ndarray:
        found = np.eye(4)
        found[:3, :3] = Rotation.from_quat([*row["rotation"][1:], row["rotation"][0]]).as_matrix()
        found[:3, 3] = row["translation"]
        return found
    try:
        scenes = {row["token"]: row["name"] for row in table("scene")}
        of_sample = {row["token"]: scenes[row["scene_token"]] for row in table("sample")}
        named = [row for row in table("sample_data") if "LIDAR_TOP" in row["filename"]]
        rows = [row for row in named if (root / row["filename"]).exists()]
        rows.sort(key=lambda row: row["timestamp"])
        there = list(dict.fromkeys(of_sample[row["sample_token"]] for row in rows))
        if scene is None and len(there) > 1 or scene is not None and scene not in there or not there:
            raise ValueError(f"{root}: has the scans of {', '.join(there) or 'no scene'}, expected the choice of one "
                             f"scene (--topic){'' if scene is None else f', got {scene}'}")
        rows = [row for row in rows if scene is None or of_sample[row["sample_token"]] == scene]
        egos, sensors = ({row["token"]: matrix(row) for row in table(name)}
                         for name in ("ego_pose", "calibrated_sensor"))
        poses = [(egos[row["ego_pose_token"]] @ sensors[row["calibrated_sensor_token"]])[:3] for row in rows]
    except KeyError as error:
        raise ValueError(f"{home}: its tables lack {error}") from None
    files = [root / row["filename"] for row in rows]
    absent = sum(of_sample[row["sample_token"]] in (scene, *there[:1]) for row in named) - len(rows)
    notes = [f"the files of {absent} scans in its tables are missing"] if absent else []
    return _Scans(1e-6 * np.array([row["timestamp"] for row in rows]), "tables of nuScenes, s since 1970", SENSOR, poses,
                  lambda: map(_cloud, files), {}, notes, files)


def _in_folder(folder: pathlib.Path, notes: list[str]) -> list[pathlib.Path]:
    """The files of scans in a folder, or in the folders in which KITTI has its scans. Hidden files are not scans. @param
    notes a sentence on what is left out is added"""
    for inner in ("velodyne", "velodyne_points/data"):
        if (folder / inner).is_dir():
            folder = folder / inner
            break
    found = [file for file in sorted(folder.iterdir())
             if file.suffix.lower() in SUFFIXES and not file.name.startswith(".")]
    files = [file for file in found if file.is_file()]
    if len(files) < len(found):
        notes.append(f"left out are {len(found) - len(files)} folders, pipes and broken links in {folder}")
    shapes = {re.sub(r"\d+", "#", file.stem): file.name for file in files}
    listed = any((place / name).exists() for place in (folder, folder.parent) for name in ("times.txt", "timestamps.txt"))
    if len(shapes) > 1 and len({file.suffix.lower() for file in files}) == 1 and not listed:
        raise ValueError(f"{folder}: has {' and '.join(list(shapes.values())[:2])}, expected names that differ by "
                         "numbers alone: a pattern chooses one recording")
    return files


def load_clouds(source, rate: float | None = None, topic: str | None = None, sensor_address: str | None = None
                ) -> Recording:
    """Opens recorded scans as one source, whose scans are read one after another.

    source  names of files, a pattern ("scans/*.pcd"), a folder of numbered files in any format of `load_cloud`, a file
            of packets, a bag of ROS (.mcap, .db3, .bag, or the folder of a bag), a sequence of SemanticKITTI, or the
            folder of nuScenes
    rate    scans a second, Hz, above 0 to 1e6, for numbered files; default: times in times.txt or timestamps.txt beside
            the files, or in the names of the files, else 10 (assumed, as `times_from` says)
    topic   the topic of clouds in a bag, or the scene of nuScenes; default: the only one
    sensor_address  address of the sensor in packets, as "192.168.1.201"; default: the only sensor

    Clouds of bags and of .bin files are in the frame of the sensor: metres right, forward and up. Other clouds are in
    the frame of their files. `poses` leads from there to the fixed frame, if the recording has poses.
    """
    if rate is not None and (not isinstance(rate, (int, float)) or not 0.0 < rate <= 1e6):
        raise ValueError(f"rate is {rate}, expected above 0 to 1e6 scans a second")
    notes: list[str] = []
    address = {} if sensor_address is None else {"sensor_address": sensor_address}
    if isinstance(source, (list, tuple)):
        files, path = [pathlib.Path(one) for one in source], None
    else:
        path = pathlib.Path(source)
        if not path.exists() and glob.has_magic(str(source)):
            files, path = [pathlib.Path(one) for one in sorted(glob.glob(str(source)))], None
    if path is not None:
        if not path.exists():
            raise FileNotFoundError(f"no such file or folder: {path}")
        if path.is_dir():
            bag = _bags.files_of(path, notes)
            if bag:
                return Recording(source, _of_bag(path, bag, topic, notes))
            if list(path.glob("v1.0-*")):
                return Recording(source, _of_nuscenes(path, topic))
            files = _in_folder(path, notes)
        else:
            files = [path]
    if files and all(file.suffix.lower() in _bags.SUFFIXES for file in files):
        if rate is not None:
            raise ValueError(f"rate is {rate}, expected none for {source}: a bag has times")
        return Recording(source, _of_bag(files[0], files, topic, notes))
    if not files or any(file.suffix.lower() not in SUFFIXES for file in files):
        wrong = next((f": {file}" for file in files if file.suffix.lower() not in SUFFIXES), "")
        raise ValueError(f"{source} is not a recording{wrong}: expected {EXPECTED}")
    if topic is not None:
        raise ValueError(f"topic is {topic!r}, expected none for {source}: only bags and nuScenes have topics")
    return Recording(source, _of_files(files, rate, notes, address), rate)
