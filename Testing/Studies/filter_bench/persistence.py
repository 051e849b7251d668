# SPDX-License-Identifier: BSD-3-Clause
"""The clutter filter, which learns nothing but where echoes persist.

    Testing/Studies/run.py persistence --sets build/bench/sets

The score is 1 - `clutter_probability`. The sequences of a set are one stream, as of one lidar that goes on: the filter knows all scans before.
"""
from vtkmodules.util.numpy_support import vtk_to_numpy

import clutter
import filters


@filters.baseline()
def main(options):
    streams = {}

    def scores_of(home, number):
        stream = streams.setdefault(home, clutter.Stream({}))
        for name in filters.names(home, number):
            stream.moving(home / "sequences" / number / "velodyne" / f"{name}.bin")
            yield name, [1.0 - vtk_to_numpy(stream.filter.GetOutputDataObject(0).GetPointData().GetArray("clutter_probability"))]
    filters.predict(options.sets, options.out, ["persistence"], scores_of)
