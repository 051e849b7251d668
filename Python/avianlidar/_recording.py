# SPDX-License-Identifier: BSD-3-Clause
"""Recorded scans as one source: numbered files, bags of ROS, and folders of SemanticKITTI and nuScenes."""
import collections
import glob
import json
import pathlib
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
NANOSECONDS = 1e14  # times since 1970 above are in nanoseconds, also those that should be seconds
# Times of points in clouds of ROS: the field, the type of the driver's numbers, and their size in us.
_POINT_TIMES = (("t", "u", 1e-3), ("time", "f", 1e6), ("timestamp", "f", 1e6))


class _Scans(NamedTuple):
    """What a kind of recording knows before its scans are read."""
    times: np.ndarray  # s, rising
    origin: str  # where the times come from
    frame: str
    poses: list[np.ndarray] | None  # 3 x 4, of each scan
    clouds: Callable[[], Iterator[Cloud]]
    left_out: dict[str, int]  # number of scans by the reason
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
        self.times, self.times_from, self.frame, self.poses, self._clouds, self.left_out, self.files = scans
        for reason, count in self.left_out.items():
            warnings.warn(f"{source}: {count} {'scan is' if count == 1 else 'scans are'} left out: {reason}",
                          RuntimeWarning, stacklevel=callers_level())

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Cloud]:
        for time, cloud in zip(self.times.tolist(), self._clouds()):
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


def _of_files(files: list[pathlib.Path], rate: float | None) -> _Scans:
    suffixes = collections.Counter(file.suffix.lower() for file in files)
    if len(suffixes) > 1:
        raise ValueError(f"{files[0].parent}: has {', '.join(f'{count} {name}' for name, count in suffixes.items())}, "
                         "expected the files of one kind: a pattern such as scans/*.pcd chooses them")
    (suffix,) = suffixes
    if suffix in PACKETS and len(files) > 1:
        raise ValueError(f"{files[0]}: {len(files)} files of packets, expected one: each of its revolutions is a scan")
    frame, known = SENSOR if suffix in (".bin", *PACKETS) else OF_FILE, files if suffix in READERS else []
    if len(files) == 1 and suffix not in PACKETS:
        return _Scans(np.zeros(1), "one file", frame, None, lambda: iter([_cloud(files[0])]), {}, known)
    reader = _wrapped.vtkAvianLidarPointCloudReader()
    for file in files:
        reader.AddFileName(file_name(file))
    reader.SetScanRate(rate or 0.0)
    reader.UpdateInformation()
    found = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    if not found:
        update(reader)  # raises the error
    times = np.array(found)
    if suffix in PACKETS:
        return _Scans(times, "packets, s since the full hour", frame, None,
                      lambda: (_cloud(files[0], time=time) for time in times.tolist()), {}, known)
    names = [pathlib.Path(reader.GetScanFileName(k)) for k in range(len(times))]
    poses, home = None, files[0].parent.parent
    if suffix == ".bin" and (home / "poses.txt").exists():
        poses = [np.column_stack([pose[:, :3] @ TURNED.T, pose[:, 3]]) for pose in kitti_poses(home, calibrated=False)]
        if len(poses) != len(names):
            raise ValueError(f"{home / 'poses.txt'}: has {len(poses)} poses, expected one for each of "
                             f"{len(names)} scans")
    return _Scans(times, reader.GetScanTimes(), frame, poses, lambda: map(_cloud, names), {}, names if known else [])


class _Transforms:
    """Poses of frames, which messages of ROS give."""

    def __init__(self) -> None:
        self.parents: dict[str, str] = {}
        self.known: dict[str, dict[int, tuple[Any, Any]]] = collections.defaultdict(dict)  # by child and time, ns

    def add(self, data) -> None:
        (transforms,) = _ros.unpacked(_ros.TRANSFORMS, data)
        for ((seconds, nanoseconds), parent), child, transform in transforms:
            child = child.lstrip("/")
            self.parents[child] = parent.lstrip("/")
            self.known[child][10**9 * seconds + nanoseconds] = transform

    def _step(self, child: str, stamp: int) -> np.ndarray:
        """The matrix (4 x 4) from a frame to its parent: linear in place and spherical in rotation between times, and
        the nearest one before the first and after the last time."""
        from scipy.spatial.transform import Rotation, Slerp
        known = self.known[child]
        times = sorted(known)
        places = np.array([known[time][0] for time in times])
        turns = Rotation.from_quat([known[time][1] for time in times])
        seconds = 1e-9 * np.array([time - times[0] for time in times])
        at = float(np.clip(1e-9 * (stamp - times[0]), seconds[0], seconds[-1]))
        turn = Slerp(seconds, turns)(at) if len(times) > 1 else turns[0]
        matrix = np.eye(4)
        matrix[:3, :3] = turn.as_matrix()
        matrix[:3, 3] = [np.interp(at, seconds, places[:, axis]) for axis in range(3)]
        return matrix

    def pose(self, frame: str, stamp: int) -> np.ndarray | None:
        """The matrix (3 x 4) from a frame to the frame that has no parent; None for an unknown frame."""
        matrix, seen = np.eye(4), {frame}
        if frame not in self.parents:
            return None
        while frame in self.parents:
            matrix = self._step(frame, stamp) @ matrix
            frame = self.parents[frame]
            if frame in seen:
                raise ValueError(f"the frame {frame} is above itself in the messages of tf")
            seen.add(frame)
        return matrix[:3]


def _topic_of(source, counts: "collections.Counter[str]", topic: str | None) -> str:
    listed = ", ".join(f"{name} ({count})" for name, count in counts.items())
    if not counts:
        raise ValueError(f"{source}: has no message of {_ros.CLOUD}, expected recorded clouds; packets of a lidar must "
                         "be converted by its driver first")
    if topic is None and len(counts) > 1:
        raise ValueError(f"{source}: has clouds in {listed}, expected the choice of one topic")
    if topic is not None and topic not in counts:
        raise ValueError(f"{source}: has no clouds in {topic}, expected one of {listed}")
    return topic or next(iter(counts))


def _of_bag(source, files: list[pathlib.Path], topic: str | None) -> _Scans:
    counts: collections.Counter[str] = collections.Counter()
    stamps: dict[str, list[tuple[int, str]]] = collections.defaultdict(list)
    transforms, left_out = _Transforms(), {}
    try:
        for message in _bags.messages(files, (_ros.CLOUD, _ros.TRANSFORMS)):
            try:
                if message.kind == _ros.TRANSFORMS:
                    transforms.add(message.data)
                    continue
                (seconds, nanoseconds), frame = _ros.unpacked("std_msgs/Header", message.data)
            except ValueError as error:
                raise ValueError(f"{source}: a message of {message.topic} {error}") from None
            counts[message.topic] += 1
            stamps[message.topic].append((10**9 * seconds + nanoseconds or message.time, frame.lstrip("/")))
    except _bags.Torn as error:
        left_out[f"torn at the end ({error})"] = 1
    topic = _topic_of(source, counts, topic)
    kept, latest = [], -1
    for number, (stamp, _) in enumerate(stamps[topic]):
        if stamp > latest:
            kept.append(number)
            latest = stamp
    if len(kept) < counts[topic]:
        left_out["not later than the scan before"] = counts[topic] - len(kept)
    poses = [transforms.pose(stamps[topic][number][1], stamps[topic][number][0]) for number in kept]
    known = None
    if all(pose is not None for pose in poses):
        known = [np.column_stack([pose[:, :3] @ TURNED.T, pose[:, 3]]) for pose in poses if pose is not None]

    def clouds() -> Iterator[Cloud]:
        wanted, number = set(kept), -1
        with tempfile.TemporaryDirectory() as folder:
            try:
                for message in _bags.messages(files, (_ros.CLOUD,)):
                    number += message.topic == topic
                    if message.topic == topic and number in wanted:
                        try:
                            cloud = _ros.cloud_of(message.data)
                        except ValueError as error:
                            raise ValueError(f"{source}: scan {number} of {topic} {error}") from None
                        yield _from_rows(cloud, pathlib.Path(folder) / "scan.pcd")
            except _bags.Torn:  # counted above
                pass
    times = np.array([1e-9 * stamps[topic][number][0] for number in kept])
    return _Scans(times, f"messages of {topic}, s", SENSOR, known, clouds, left_out, [])


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
    for name, kind, size in _POINT_TIMES:
        if name in names and own.dtype[name].kind == kind and len(own) == found.number_of_points:
            times = own[name].astype(float)
            times *= 1e-3 if len(times) and times[0] > NANOSECONDS else size
            since = 1e-3 * cloud.stamp  # us
            times += since if len(times) and abs(times[0]) < 1e9 else 0.0  # else since 1970
            add_array(found.data.GetPointData(), "timestamp", times, "us")
            break
    return found


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
        rows = [row for row in table("sample_data")
                if "LIDAR_TOP" in row["filename"] and (root / row["filename"]).exists()]
        rows.sort(key=lambda row: row["timestamp"])
        there = list(dict.fromkeys(of_sample[row["sample_token"]] for row in rows))
        if scene is None and len(there) > 1 or scene is not None and scene not in there or not there:
            raise ValueError(f"{root}: has the scans of {', '.join(there) or 'no scene'}, expected the choice of one "
                             f"scene{'' if scene is None else f', got {scene}'}")
        rows = [row for row in rows if scene is None or of_sample[row["sample_token"]] == scene]
        egos, sensors = ({row["token"]: matrix(row) for row in table(name)}
                         for name in ("ego_pose", "calibrated_sensor"))
        poses = [(egos[row["ego_pose_token"]] @ sensors[row["calibrated_sensor_token"]])[:3] for row in rows]
    except KeyError as error:
        raise ValueError(f"{home}: its tables lack {error}") from None
    files = [root / row["filename"] for row in rows]
    return _Scans(1e-6 * np.array([row["timestamp"] for row in rows]), "tables of nuScenes, s since 1970", SENSOR, poses,
                  lambda: map(_cloud, files), {}, files)


def _in_folder(folder: pathlib.Path) -> list[pathlib.Path]:
    """The files of scans in a folder, or in the folders in which KITTI has its scans."""
    for inner in ("velodyne", "velodyne_points/data"):
        if (folder / inner).is_dir():
            folder = folder / inner
            break
    return sorted(file for file in folder.iterdir() if file.suffix.lower() in SUFFIXES and file.is_file())


def load_clouds(source, rate: float | None = None, topic: str | None = None) -> Recording:
    """Opens recorded scans as one source, whose scans are read one after another.

    source  names of files, a pattern ("scans/*.pcd"), a folder of numbered files in any format of `load_cloud`, a file
            of packets, a bag of ROS (.mcap, .db3, .bag, or the folder of a bag), a sequence of SemanticKITTI, or the
            folder of nuScenes
    rate    scans a second, Hz, above 0 to 1e6, for numbered files; default: times in times.txt or timestamps.txt beside
            the files, or in the names of the files, else 10 (assumed, as `times_from` says)
    topic   the topic of clouds in a bag, or the scene of nuScenes; default: the only one

    Clouds of bags and of .bin files are in the frame of the sensor: metres right, forward and up. Other clouds are in
    the frame of their files. `poses` leads from there to the fixed frame, if the recording has poses.
    """
    if rate is not None and not 0.0 < rate <= 1e6:
        raise ValueError(f"rate is {rate}, expected above 0 to 1e6 scans a second")
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
            bag = _bags.files_of(path)
            if bag:
                return Recording(source, _of_bag(path, bag, topic))
            if list(path.glob("v1.0-*")):
                return Recording(source, _of_nuscenes(path, topic))
            files = _in_folder(path)
        else:
            files = [path]
    if files and all(file.suffix.lower() in _bags.SUFFIXES for file in files):
        return Recording(source, _of_bag(files[0], files, topic))
    if not files or any(file.suffix.lower() not in SUFFIXES for file in files):
        wrong = next((f": {file}" for file in files if file.suffix.lower() not in SUFFIXES), "")
        raise ValueError(f"{source} is not a recording{wrong}: expected {EXPECTED}")
    if topic is not None:
        raise ValueError(f"topic is {topic!r}, expected none for {source}: only bags and nuScenes have topics")
    return Recording(source, _of_files(files, rate), rate)
