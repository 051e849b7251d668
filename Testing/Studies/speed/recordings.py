# SPDX-License-Identifier: BSD-3-Clause
"""How fast recordings are read, filtered and tracked, by one core, and a recording beside its simulation. Leaves two
tables and a picture.

    Testing/Studies/run.py recordings --data DATA     # default: AVIANLIDAR_DATA_DIR

Reading: files of one frame, beside Open3D (if it is installed) and NumPy's fromfile; the least of ten runs. Following:
40 scans made of one real frame each, with 2 cm of noise along the range; the median of the last 20 scans. The picture
is that of `avianlidar compare --align` for the PandarXT-32 in the room.
"""
import os
import pathlib
import shutil
import tempfile
import time

import numpy as np

import avianlidar as al
import tools
from avianlidar.apps.sequences import _rosbag
from avianlidar.apps.sequences._compared import Comparison
from avianlidar.apps.sequences._following import Beams, Chain, Scan
from avianlidar.apps.sequences._recorded import HALF_BEAMWIDTH, _steps
from running import argument, study

FRAMES = {"OS1-32": "lidar_ouster/os1_32", "OS0-32": "lidar_ouster/os0_32", "PandarXT-16": "lidar_outdoor/xt16",
          "Helios 16P": "lidar_outdoor/helios16p_frame0", "Pandar64": "lidar_room/pandar64",
          "PandarXT-32": "lidar_room/xt32", "VLP-16": "lidar_vlp16_mrpt/vlp16"}
RUNS, SCANS, LEARNING, NOISE = 10, 40, 20, 0.02


def least(work):
    """The least time of several runs, ms."""
    seconds = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - begin)
    return 1e3 * min(seconds)


def reading(cloud, folder):
    """Rows on files of a cloud with float32 coordinates and intensities."""
    points = cloud.points.astype(np.float32)
    rows = np.column_stack([points, np.full(len(points), 0.5, np.float32)])
    home = folder / "00"
    for name in ("velodyne", "labels"):
        (home / name).mkdir(parents=True)
    (home / "velodyne/000000.bin").write_bytes(rows.tobytes())
    np.zeros(len(rows), np.uint32).tofile(home / "labels/000000.label")
    (home / "times.txt").write_text("0\n")
    (home / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    (home / "calib.txt").write_text("Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n")
    (folder / "plain.pcd").write_bytes(
        f"VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {len(rows)}\nHEIGHT 1\n"
        f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(rows)}\nDATA binary\n".encode() + rows.tobytes())
    al.save(al.load_cloud(folder / "plain.pcd"), folder / "plain.ply")
    for suffix in (".mcap", ".db3"):
        _rosbag.write(home, folder / f"bag{suffix}")
    try:
        import open3d
        other = open3d.io.read_point_cloud
    except ImportError:
        other = None
    for file in ("plain.pcd", "plain.ply", "00/velodyne/000000.bin", "bag.mcap", "bag.db3"):
        path = str(folder / file)
        own = least(lambda: list(al.load_clouds(path)))
        theirs = None
        if file.endswith((".pcd", ".ply")) and other:
            theirs = "Open3D", least(lambda: other(path))
        elif file.endswith(".bin"):
            theirs = "fromfile", least(lambda: np.fromfile(path, np.float32))
        yield (pathlib.Path(file).suffix[1:], f"{own:.2f}",
               *((theirs[0], f"{theirs[1]:.2f}", f"{own / theirs[1]:.2f}") if theirs else ("", "", "")))


def following(name, cloud):
    """A row on the clutter filter and the tracker."""
    draw, base = np.random.default_rng(1), cloud.points - cloud.fields.get("position", np.zeros(3))
    ranges = np.maximum(np.linalg.norm(base, axis=1, keepdims=True), 1e-6)

    def scans():
        for number in range(SCANS):
            points = base * (1 + draw.normal(0, NOISE, ranges.shape) / ranges)
            yield Scan(number, 0.1 * number, points, points, None, np.zeros(len(points), np.uint32))
    chain, seconds = Chain(Beams(*_steps(cloud), HALF_BEAMWIDTH, np.zeros(3)), LEARNING, {}, {}), []
    made = list(scans())
    begin = time.perf_counter()
    for _ in chain.follow(made):
        now = time.perf_counter()
        seconds.append(now - begin)
        begin = now
    each = 1e3 * float(np.median(seconds[LEARNING:]))
    per = each * 1e5 / len(base)
    return name, len(base), f"{each:.1f}", f"{per:.1f}", f"{100.0 / per:.1f}"


@study(argument("--data", type=pathlib.Path, default=None, help="folder of real scans"))
def main(options):
    data = options.data or pathlib.Path(os.environ["AVIANLIDAR_DATA_DIR"])
    frames = {name: al.load_cloud(data / f"{file}.pcd") for name, file in FRAMES.items()}
    with tempfile.TemporaryDirectory() as folder:
        tools.leave(options.out, "recordings-reading", ("file", "ms", "other", "ms of the other", "ratio"),
                    list(reading(frames["Pandar64"], pathlib.Path(folder))))
    tools.leave(options.out, "recordings", ("frame", "points a scan", "ms a scan", "ms for 100,000 points",
                                            "times as fast as 10 Hz"),
                [following(name, cloud) for name, cloud in frames.items()])
    scene = al.Scene(data / "lidar_room" / "room_mesh_4sensors.ply", material="Wall")
    compared = Comparison(scene, al.load_clouds(data / f"{FRAMES['PandarXT-32']}.pcd"), al.Sensor("PandarXT32"), align=True)
    found = compared.write(options.out / "compared")
    shutil.copyfile(options.out / "compared" / "ranges.png", options.out / "ranges.png")
    print(compared.pose.words(), compared.change, found)
