# SPDX-License-Identifier: BSD-3-Clause
"""Coverage: the places where a bird would be detected."""
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkDataSet, vtkImageData, vtkPolyData

from . import _display
from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud, add_array, field_values, point_array, rows_of, with_points
from ._pipeline import Progress
from ._properties import wraps
from ._scan import SceneAndSensor
from ._sensor import Sensor


def places_of(points, regions: Mapping[str, Any] | None = None) -> vtkPolyData:
    """Places of a coverage. @param points n x 3, m @param regions for each name the numbers of its points; points
    without a region belong to the region "elsewhere" """
    points = rows_of("places", points, (3,))
    data = with_points(points)
    if regions is not None:
        ids = np.full(len(points), len(regions), dtype=np.int32)
        for number, members in enumerate(map(np.asarray, regions.values())):
            ids[members if members.dtype == bool else members.astype(int)] = number
        add_array(data.GetPointData(), "region_id", ids)
        add_array(data.GetFieldData(), "region_names", [*regions, "elsewhere"])
    return data


@wraps(_wrapped.vtkAvianLidarCoverage)
class Coverage(SceneAndSensor):
    """Where a lidar would detect a bird, and why the bird is missed elsewhere. Every property of vtkAvianLidarCoverage
    is an attribute, in the unit of its description. Lines of sight are kept when bird, air or receiver change.

    >>> wall = Scene(([(-9, 50, -9), (9, 50, -9), (9, 50, 9), (-9, 50, 9)], [(0, 1, 2), (0, 2, 3)]), material="Wall")
    >>> cover = Coverage(wall, Sensor("Search905"), places=[(0, 200, 1), (100, 200, 1)], species="crow")
    >>> [cover.status_names[status] for status in cover["status"]]
    ['shadowed', 'seen']
    """

    def __init__(self, scene, sensor: Sensor | None = None, places=None, progress: Progress | None = None,
                 height_limits: Sequence[float] | None = None, **settings: Any):
        """Coverage, not yet computed.

        scene          a Scene, or any source of a Scene: a scene file, VTK data, (points, triangles)
        sensor         default: Airport16 at the scene's lidar position, else at the origin
        places         n x 3 coordinates (m), or a vtkDataSet; None: the points of an image given by `bounds` and
                       `spacing`
        progress       called with the completed share (0 to 1) and the name of the running class
        height_limits  limits of the table's height bands, m, ascending; default 0, 15, 30, 60, 150
        settings       any property by name, for example species="crow", visibility=10e3 (m), bounds, spacing
        """
        super().__init__(_wrapped.vtkAvianLidarCoverage(), scene, sensor, progress, settings)
        self.places = places
        if height_limits is not None:
            self.height_limits = list(height_limits)

    @property
    def height_limits(self) -> list[float]:
        """Limits of the table's height bands, m, ascending."""
        return [self.algorithm.GetHeightLimit(i) for i in range(self.algorithm.GetNumberOfHeightLimits())]

    @height_limits.setter
    def height_limits(self, limits: Sequence[float]) -> None:
        self.algorithm.RemoveAllHeightLimits()
        for limit in limits:
            self.algorithm.AddHeightLimit(limit)

    @property
    def places(self) -> vtkDataSet | None:
        """The places; None for an image. May be set."""
        return self._places

    @places.setter
    def places(self, places) -> None:
        self._places = places if places is None or isinstance(places, vtkDataSet) else places_of(places)
        self.algorithm.SetPlacesData(self._places)

    @property
    def data(self) -> vtkDataSet:
        """The image or the places, with the results."""
        return self.update().algorithm.GetOutputDataObject(0)

    def __getitem__(self, name: str) -> np.ndarray:
        """`detection_probability`, `track_probability`, `photoelectrons`, `beams_per_scan`, `minimum_effective_area`
        (m2) or `status`; the axes of an image are z, y, x. `pose_probabilities` has a further, last axis: the poses."""
        data = self.data
        values = point_array(data, name)
        rows = data.GetDimensions()[::-1] if isinstance(data, vtkImageData) else values.shape[:1]
        return values.reshape(rows + values.shape[1:])

    @property
    def status_names(self) -> list[str]:
        """The meanings of the numbers in `status`."""
        return field_values(self.data)["status_names"]

    @staticmethod
    def strike_height_density(heights) -> np.ndarray:
        """Density of bird strikes over height, 1/m, with which `strike_height_weights` weights the table.
        @param heights n heights, m above ground"""
        return np.array([_wrapped.vtkAvianLidarCoverage.StrikeHeightDensity(height)
                         for height in np.asarray(heights, dtype=float)])

    def __repr__(self) -> str:
        return _display.line(self, _display.coverage_rows)

    @property
    def table(self) -> list[dict[str, Any]]:
        """Rows of shares by region, species and height band (m), with standard errors; see vtkAvianLidarCoverage."""
        table = self.update().algorithm.GetOutputDataObject(1)
        columns = [table.GetColumn(i) for i in range(table.GetNumberOfColumns())]
        return [{column.GetName(): column.GetValue(i) for column in columns} for i in range(table.GetNumberOfRows())]

    @property
    def clutter_map(self) -> Cloud:
        """The range units with an echo of a surface, one point each (m), with `energy_received` (J) and
        `detection_probability`, the share of scans in which the echo is detected."""
        return Cloud(self.update().algorithm.GetOutputDataObject(2))

    @property
    def number_of_traced_places(self) -> int:
        """Number of lines of sight that the last execution traced; 0 if all were kept from before."""
        return int(self.algorithm.GetNumberOfTracedPlaces())
