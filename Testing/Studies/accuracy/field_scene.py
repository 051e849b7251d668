# SPDX-License-Identifier: BSD-3-Clause
"""A field of 900 thin and small objects around the lidar: poles, rails and boxes, 40 to 1,200 m away. Nothing fills a
beam, so that most echoes lie near the lower limit of the receiver: the hardest case for what is seen and what is not.
Metres; the lidar stands in the origin, 3 m above the ground, of which there is none."""
import numpy as np

import avianlidar as al
from running import BOX, BOX_SIDES

LIDAR = (0.0, 0.0, 3.0)


def build(number=900, seed=7):
    """A third of the objects each: upright poles 0.05 to 0.5 m thick and 4 to 30 m high, level rails as thin and 5 to 60 m
    long in any direction up to 20 m above the ground, boxes with sides of 0.2 to 3 m."""
    random = np.random.default_rng(seed)
    points = []
    for kind in np.arange(number) % 3:
        azimuth, turn = random.uniform(0, 2 * np.pi, 2)
        place = random.uniform(40, 1200) * np.array([np.sin(azimuth), np.cos(azimuth)])
        thin = 0.05 * 10 ** random.uniform(0, 1)
        size, height = {0: ((thin, thin, random.uniform(4, 30)), 0),
                        1: ((random.uniform(5, 60), thin, thin), random.uniform(0, 20)),
                        2: (random.uniform(0.2, 3, 3), random.uniform(0, 10))}[kind]
        corner = (BOX - (0.5, 0.5, 0.0)) * size
        x = corner[:, 0] * np.cos(turn) - corner[:, 1] * np.sin(turn)
        y = corner[:, 0] * np.sin(turn) + corner[:, 1] * np.cos(turn)
        points.append(np.column_stack([x + place[0], y + place[1], corner[:, 2] + height]))
    sides = (8 * np.arange(number)[:, None, None] + BOX_SIDES).reshape(-1, 3)
    return al.Scene(np.concatenate(points), sides, material="Wall").surfaces
