# SPDX-License-Identifier: BSD-3-Clause
"""What a scan leaves out stays within the bounds that it states: the examples on rich sceneries and on the real room,
against the full model. They are not in the repository: without AVIANLIDAR_DATA_DIR skipped (77)."""
import os
import sys
import types
import unittest

from echotools import CELLS, RAYS
from needstools import airport_filters, corridor_filter, needed_and_full
import room
import room_compare

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
SCENES = os.environ.get("AVIANLIDAR_SCENES_DIR", "")


def scene(name):
    return "--scene", os.path.join(SCENES, name + ".lidarscene.json")


class ModelNeedsScenery(unittest.TestCase):
    def test_airports_street_and_town(self):
        for name in ("zsss_structures", "phnl", "ingolstadt", "neubrandenburg"):
            for _, lidar in airport_filters(name, "--preset", "Airport16", *scene(name)):
                for samples in (CELLS, RAYS):
                    with self.subTest(name, samples=samples):
                        lidar.SetBeamSamples(samples)
                        needed_and_full(self, name, lidar)

    def test_office(self):
        lidar = corridor_filter(*scene("avz_office"), "--position", "0", "-11", "1.3")
        needed_and_full(self, "avz_office", lidar)

    def test_room(self):
        # One reflection, no noise: nothing but silent beams is left out, and no echo differs at all.
        options = types.SimpleNamespace(data=DATA, scans=None, poses=None, desk=room.DESK, sensors=None)
        room.complete(options)
        scans = room.Room(options)
        for sensor in scans.scans:
            with self.subTest(sensor):
                lidar = room_compare.echo_filter(scans.scans[sensor], scans.without(sensor)[0])
                needed, full = needed_and_full(self, sensor, lidar)
                self.assertEqual(needed.units, full.units)


if __name__ == "__main__":
    if not DATA:
        print("AVIANLIDAR_DATA_DIR is not set: skipped")
        sys.exit(77)
    unittest.main()
