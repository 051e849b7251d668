# SPDX-License-Identifier: BSD-3-Clause
"""Points of real frames without birds that filters of one scan call birds.

    AVIANLIDAR_DATA_DIR=... Testing/Studies/run.py real --sets build/bench/sets

Frames are those of lidar_outdoor, lidar_ouster and lidar_vlp16_mrpt in AVIANLIDAR_DATA_DIR, of other lidars than
the one that the filters have learned. The filters learn all of hongqiao-train in fair weather, and take their threshold from Honolulu.
"""
import pathlib

import numpy as np

import avianlidar as al
import filters
import network
import tools
import trees
from running import study

FRAMES = ("lidar_outdoor/*.pcd", "lidar_ouster/*.pcd", "lidar_vlp16_mrpt/*.pcd")
STEP = 0.2  # deg, of the columns of the image of a real frame
FULL = 255.0  # intensity that is 1 in a sequence


def frame_of(file):
    """A real frame as a range image."""
    cloud = al.load_cloud(file)
    points = cloud.points
    some = np.linalg.norm(points, axis=1) > 0.1
    intensity = np.clip(np.array(cloud["intensity"], float) / FULL, 0.0, 1.0) if "intensity" in cloud else np.full(len(points), 0.1)
    # x forward and y left, as in a sequence.
    return filters.Frame(np.column_stack([points[:, 1], -points[:, 0], points[:, 2], intensity])[some], STEP)


@study(filters.SETS, data=sorted({str(pathlib.Path(pattern).parent) for pattern in FRAMES}))
def main(options):
    network.torch.set_num_threads(1)
    home, tuned = options.sets / filters.LEARNED, options.sets / filters.TUNED
    numbers = filters.sequences(home)
    forest = trees.learn([trees.training(home, number) for number in numbers], trees.KINDS[0], 0)
    net = network.learn([scan for number in numbers for scan in network.training(home, number)], network.KINDS[0], 0, network.SECONDS)
    score = {trees.KINDS[0]: lambda frame: forest.decision_function(filters.of_one_scan(frame)),
             network.KINDS[0]: lambda frame: network.scores_of_scan(net, network.KINDS[0], frame, ())}
    least = {}
    for kind, of in score.items():
        least[kind] = filters.tuned([(of(frame), filters.labels(tuned, number, name)) for number in filters.sequences(tuned)
                                     for name, frame, _ in filters.frames(tuned, number)])
    rows = []
    for file in sorted(file for pattern in FRAMES for file in options.data.glob(pattern)):
        frame = frame_of(file)
        counts = [int(np.count_nonzero(of(frame) >= least[kind])) for kind, of in score.items()]
        rows.append((f"{file.parent.name}/{file.stem}", f"{len(frame.range):,}", *(
            f"{count:,} ({100 * count / len(frame.range):.1f} %)" for count in counts)))
    tools.leave(options.out, "table", ("frame", "points", *score), rows)
