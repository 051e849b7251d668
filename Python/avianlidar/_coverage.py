# SPDX-License-Identifier: BSD-3-Clause
"""Where a bird would be seen."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Optional, Sequence

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkDataSet, vtkImageData, vtkPolyData

from . import _display
from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud, add_array, array_names, field_values, point_array, rows_of, with_points
from ._pipeline import Progress
from ._properties import wraps
from ._scan import SceneAndSensor
from ._sensor import Sensor


def places_of(points, regions: Optional[Mapping[str, Any]] = None) -> vtkPolyData:
    """Places to look at. @param points n x 3, m @param regions names, each with the numbers of its points; those that no
    region has are of the region "elsewhere" """
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
    """Where a lidar would detect a bird, where not, and why. Every property of vtkAvianLidarCoverage is an attribute, in
    the unit that its description says. Another bird, air or receiver traces no line of sight.

    >>> wall = Scene(([(-9, 50, -9), (9, 50, -9), (9, 50, 9), (-9, 50, 9)], [(0, 1, 2), (0, 2, 3)]), material="Wall")
    >>> cover = Coverage(wall, Sensor("Search905"), places=[(0, 200, 1), (100, 200, 1)], species="crow")
    >>> [cover.status_names[status] for status in cover["status"]]
    ['shadowed', 'seen']
    """

    def __init__(self, scene, sensor: Optional[Sensor] = None, places=None, progress: Optional[Progress] = None,
                 height_limits: Optional[Sequence[float]] = None, **settings: Any):
        """Coverage, not yet computed.

        scene          a Scene, or what a Scene is made of: a scene file, VTK data, (points, triangles)
        sensor         default: Airport16 where the scene puts the lidar, else at the origin
        places         n x 3 coordinates (m), or a vtkDataSet; None: the points of an image, see bounds and spacing
        progress       called with the share done (0 to 1) and the name of the class at work
        height_limits  of the table's bands, m, rising; default 0, 15, 30, 60, 150
        settings       any property by name, for example species="crow", visibility=10e3 (m), bounds, spacing
        """
        super().__init__(_wrapped.vtkAvianLidarCoverage(), scene, sensor, progress, settings)
        self.places = places
        if height_limits is not None:
            self.height_limits = list(height_limits)

    @property
    def height_limits(self) -> List[float]:
        """Limits of the table's height bands, m, rising."""
        return [self.algorithm.GetHeightLimit(i) for i in range(self.algorithm.GetNumberOfHeightLimits())]

    @height_limits.setter
    def height_limits(self, limits: Sequence[float]) -> None:
        self.algorithm.RemoveAllHeightLimits()
        for limit in limits:
            self.algorithm.AddHeightLimit(limit)

    @property
    def places(self) -> Optional[vtkDataSet]:
        """The places, None for an image; others may be set."""
        return self._places

    @places.setter
    def places(self, places) -> None:
        self._places = places if places is None or isinstance(places, vtkDataSet) else places_of(places)
        self.algorithm.SetPlacesData(self._places)

    @property
    def data(self) -> vtkDataSet:
        """The image, or the places, with what was found."""
        return self.update().algorithm.GetOutputDataObject(0)

    def __getitem__(self, name: str) -> np.ndarray:
        """`detection_probability`, `track_probability`, `photoelectrons`, `beams_per_scan`, `minimum_effective_area` (m2)
        or `status`: of an image by z, y, x. `pose_probabilities`, where they are asked for, have a last axis of poses."""
        data = self.data
        if name not in array_names(data):
            raise KeyError(f"there is no array {name!r}; known are {', '.join(array_names(data))}")
        values = point_array(data, name)
        return values.reshape(data.GetDimensions()[::-1] + values.shape[1:]) if isinstance(data, vtkImageData) else values

    @property
    def status_names(self) -> List[str]:
        """What the numbers of `status` mean."""
        return field_values(self.data)["status_names"]

    @staticmethod
    def strike_height_density(heights) -> np.ndarray:
        """Density of bird strikes over height, 1/m, by which `strike_height_weights` weights the table. @param heights n, m above
        ground"""
        return np.array([*map(_wrapped.vtkAvianLidarCoverage.StrikeHeightDensity, np.asarray(heights, dtype=float))])

    def __repr__(self) -> str:
        return _display.line(self, _display.coverage_rows)

    @property
    def table(self) -> List[Dict[str, Any]]:
        """Shares by region, species and height band (m), with standard errors: a row each, as vtkAvianLidarCoverage says."""
        table = self.update().algorithm.GetOutputDataObject(1)
        columns = [table.GetColumn(i) for i in range(table.GetNumberOfColumns())]
        return [{column.GetName(): column.GetValue(row) for column in columns} for row in range(table.GetNumberOfRows())]

    @property
    def clutter_map(self) -> Cloud:
        """The range units with an echo of a surface, a point each (m), with `energy_received` (J) and
        `detection_probability`: in which share of scans it is perceived."""
        return Cloud(self.update().algorithm.GetOutputDataObject(2))

    @property
    def number_of_traced_places(self) -> int:
        """Lines of sight that the last execution traced; 0 if all were known."""
        return int(self.algorithm.GetNumberOfTracedPlaces())
