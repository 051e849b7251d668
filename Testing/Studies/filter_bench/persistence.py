# SPDX-License-Identifier: BSD-3-Clause
"""The clutter filter, which learns nothing but where echoes persist.

    Testing/Studies/run.py persistence --sets build/bench/sets

The score is 1 - `clutter_probability`. The sequences of a set are one stream, as of one lidar that goes on: the filter knows all scans before.
"""
import pathlib

from vtkmodules.util.numpy_support import vtk_to_numpy

import filters
from avianlidar.vtkAvianLidar import vtkAvianLidarClutterFilter, vtkAvianLidarPointCloudReader


class Stream:
    """The filter on all scans of a set, sequence by sequence."""

    def __init__(self):
        self.home, self.reader, self.filter = pathlib.Path(), None, None

    def scores_of(self, home, number):
        if home != self.home:
            self.home, self.reader, self.filter = home, vtkAvianLidarPointCloudReader(), vtkAvianLidarClutterFilter()
            self.filter.SetInputConnection(self.reader.GetOutputPort())
        for name in filters.names(home, number):
            self.reader.SetFileName(str(home / "sequences" / number / "velodyne" / f"{name}.bin"))
            self.filter.Update()
            clutter = self.filter.GetOutputDataObject(0).GetPointData().GetArray("clutter_probability")
            yield name, [1.0 - vtk_to_numpy(clutter)]


@filters.baseline()
def main(options):
    filters.predict(options.sets, options.out, ["persistence"], Stream().scores_of)
