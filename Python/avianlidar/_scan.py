# SPDX-License-Identifier: BSD-3-Clause
"""Echoes of a scene."""
from __future__ import annotations

import os
import warnings
from typing import Any, Dict, Iterator, Optional

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from . import _display
from . import vtkAvianLidar as _wrapped
from ._advice import Advice
from ._advising import measure
from ._cloud import Cloud, add_array, array_names, as_numpy, point_array
from ._pipeline import Progress, callers_level, is_current, update
from ._plot import plot_map, plot_range_image
from ._properties import PropertyOwner, wraps
from ._scene import Scene, time_of
from ._sensor import Sensor
from ._sight import warnings_of


class SceneAndSensor(PropertyOwner):
    """What looks at a scene from a sensor."""

    algorithm: Any
    progress: Optional[Progress]

    def __init__(self, algorithm, scene, sensor, progress: Optional[Progress], settings: Dict[str, Any]):
        self.algorithm = algorithm
        self.set(**settings)
        self.progress = progress
        self.scene = scene
        self.sensor = sensor

    @property
    def scene(self) -> Scene:
        """The scene; another may be set."""
        return self._scene

    @scene.setter
    def scene(self, scene) -> None:
        self._scene = scene if isinstance(scene, Scene) else Scene(scene, progress=self.progress)
        self.algorithm.SetSurfacesConnection(self._scene.tree.GetOutputPort())

    @property
    def sensor(self):
        """The sensor; another may be set: a Sensor; a preset's name or a sensor file, which then stands where the scene
        puts the lidar; beams as vtkPolyData, as a Cloud (`Sensor.beams`), or the output of a VTK algorithm."""
        return self._sensor

    @sensor.setter
    def sensor(self, sensor) -> None:
        if sensor is None or isinstance(sensor, (str, os.PathLike)):
            sensor = Sensor("Airport16" if sensor is None else sensor, position=self.scene.lidar_position or (0, 0, 0))
        source = getattr(sensor, "algorithm", getattr(sensor, "data", sensor))
        if isinstance(source, vtkAlgorithm):
            self.algorithm.SetInputConnection(0, source.GetOutputPort())
        elif isinstance(source, vtkPolyData):
            self.algorithm.SetInputDataObject(0, source)
        else:
            raise TypeError("a sensor is a Sensor, a preset's name, a sensor file, or beams (vtkPolyData, Cloud, algorithm), not "
                            f"{type(sensor).__name__}")
        self._sensor = sensor

    def __reduce__(self):
        raise TypeError(f"a {type(self).__name__} is not copied: copy its scene and its sensor, and make another one with properties()")

    def _refresh(self) -> None:
        self.scene.refresh()

    def is_current(self) -> bool:
        """Whether it has run since anything was changed: what it gives then is there."""
        self._refresh()
        return is_current(self.algorithm)

    def update(self):
        """Run what is not up to date. Errors are `Error`, warnings are Python's, also of a sensor that can see nothing;
        Ctrl-C stops the work."""
        if not self.is_current():
            update(self.algorithm, self.progress)
            for text in warnings_of(self):
                warnings.warn(text, RuntimeWarning, stacklevel=callers_level())
        return self

    @property
    def number_of_traced_rays(self) -> int:
        """Rays that the last execution traced; 0 if it only lit what was known."""
        return int(self.algorithm.GetNumberOfTracedRays())


@wraps(_wrapped.vtkAvianLidarEchoFilter)
class Scan(SceneAndSensor):
    """A scan of a scene by a sensor. Every property of vtkAvianLidarEchoFilter is an attribute, in the unit that its
    description says.

    Nothing runs before results are asked for, and only what changes ask for runs again: hits are kept, so that another
    attenuation, other limits, materials or return modes trace only what is not known yet, mostly nothing.

    >>> scene = Scene(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Glass")
    >>> scan = Scan(scene, Sensor(azimuth_step=1), rays_per_beam=200)
    >>> haze = scan["energy"].mean()  # joules
    >>> scan.attenuation_coefficient = 8.8e-5  # 1/m
    >>> bool(scan["energy"].mean() < haze), scan.number_of_traced_rays
    (True, 0)
    """

    def __init__(self, scene, sensor=None, progress: Optional[Progress] = None, movers=None,
                 **settings: Any):
        """A scan, not yet run.

        scene     a Scene, or what a Scene is made of: a mesh or scene file, VTK data, (points, triangles)
        sensor    a Sensor, a preset's name or any beams, see `sensor`; default: Airport16 where the scene puts the lidar,
                  else at the origin
        progress  called with the share done (0 to 1) and the name of the class at work
        movers    what moves: vtkPolyData of `mover`, a list or a composite of them, or a VTK algorithm such as
                  vtkAvianLidarTracks
        settings  any property by name, for example rays_per_beam, preset="Standard", attenuation_coefficient (1/m)
        """
        algorithm = _wrapped.vtkAvianLidarEchoFilter()
        algorithm.ReportMoversOff()  # until somebody asks
        super().__init__(algorithm, scene, sensor, progress, settings)
        self.movers = movers

    @property
    def movers(self):
        """What moves, as it was given; others may be set, None for nothing."""
        return self._movers

    @movers.setter
    def movers(self, movers) -> None:
        self._movers = movers
        self._blocks, self._seen = None, 0  # data, and VTK's time of the last look at them
        if isinstance(movers, vtkAlgorithm):
            self.algorithm.SetMoversConnection(movers.GetOutputPort())
            return
        self._blocks = movers
        if isinstance(movers, (list, tuple)):
            self._blocks = vtkMultiBlockDataSet()
            for number, block in enumerate(movers):
                self._blocks.SetBlock(number, block)
        self.algorithm.SetMoversData(self._blocks)

    def _refresh(self) -> None:
        super()._refresh()
        if self._blocks is not None:
            modified = time_of(self._blocks)  # a composite does not ask its blocks
            if self._seen and modified > self._seen:
                self._blocks.Modified()
            self._seen = time_of(self._blocks)

    @property
    def echoes(self) -> Cloud:
        """The echoes, one point each (m): `energy` (J), `distance_m` (m), `intensity` (0 to 255), `object_id`, ..., as
        the page of vtkAvianLidarEchoFilter says. What it gives stays as it is when the scan changes."""
        return Cloud(self.update().algorithm.GetOutput(0))

    @property
    def report(self) -> Cloud:
        """One point for every beam: `status` (0 echo, 1 no surface, 2 below the lower limit, 3 saturated, 4 outside
        the gate), costs, `skipped_bound` (J)."""
        return Cloud(self.update().algorithm.GetOutput(1))

    @property
    def mover_report(self) -> Cloud:
        """One point for every mover that is present, where it is when a beam sees most of it: `object_id`,
        `effective_area` (m2), `energy_received` (J, without noise), `detection_probability`, `number_of_echoes`, ...

        It is made from the first time on that it is read: `report_movers` is off until then."""
        self.algorithm.ReportMoversOn()
        return Cloud(self.update().algorithm.GetOutput(2))

    def __getitem__(self, name: str) -> np.ndarray:
        """An array of the echoes by name, in the unit of `echoes.units`."""
        return self.echoes[name]

    def __iter__(self) -> Iterator[str]:
        """Names of the arrays of the echoes."""
        return iter(self.echoes)

    def __contains__(self, name: object) -> bool:
        return name in self.echoes

    def range_image(self) -> Dict[str, np.ndarray]:
        """The strongest echo of each beam as an image, elevation by azimuth.

        distance_m  m, NaN where there is no echo      column_azimuths  deg from north, clockwise
        energy      J, NaN where there is no echo      row_elevations   deg, upwards
        object_id   -1 where there is no echo          echo             number of the echo, -1 where there is none

        And what the report says of each beam: `status`, `candidates`, `nodes_visited`, `rays_traced`, `skipped`,
        `skipped_bound` (J).

        For a tilted sensor, and one with rotating prisms, columns and rows are firings and channels.
        """
        self.update()
        numbered, echoes = vtkPolyData(), self.algorithm.GetOutput(0)
        numbered.ShallowCopy(echoes)
        add_array(numbered.GetPointData(), "object_id", np.arange(echoes.GetNumberOfPoints(), dtype=np.int32))
        image = _wrapped.vtkAvianLidarRangeImage()
        image.SetInputData(0, numbered)
        image.SetInputConnection(1, self.algorithm.GetOutputPort(1))
        report = self.report
        if "prism_wedge_angles" in report.fields:
            image.SetRows(int(report.fields["number_of_channels"]))
            image.SetColumns(report.number_of_points // image.GetRows())
        update(image)
        data = image.GetOutput()
        columns, rows, _ = data.GetDimensions()
        result = {name: point_array(data, name).reshape(rows, columns) for name in array_names(data)}
        for name in ("column_azimuths", "row_elevations"):
            result[name] = as_numpy(data.GetFieldData().GetArray(name))
        result["echo"] = result["object_id"]
        objects = np.append(point_array(echoes, "object_id"), -1)  # the last: no echo
        result["object_id"] = objects[result["echo"]]
        return result

    def advise(self, energy: float = 0.02, range: float = 0.05, missed: float = 0.01, beams: int = 1000,
               progress: Optional[Progress] = None) -> Advice:
        """Which settings this scan requires, measured on some of its beams: the fastest whose errors are surely below those asked.

        energy    error of the energy received that is allowed, rms, relative
        range     error of ranges that is allowed, rms, m
        missed    echoes that may be missed or invented, as a share of the true ones
        beams     beams to measure on; more of them tell smaller errors, and take longer
        progress  as of the scan, whose own it is by default

        Sensor, scene, movers and air are the scan's, and nothing of the scan changes: `scan.set(**advice.settings)` takes the
        settings over. It takes seconds. How it is measured: Documentation/guide/accuracy.md.

        >>> scene = Scene(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Glass")
        >>> Scan(scene, Sensor(azimuth_step=1)).advise(energy=0.05, missed=0.5).settings["number_of_reflections"]
        1
        """
        self._refresh()
        inputs, progress = [], progress or self.progress
        for port in (0, 1, 2):
            known = self.algorithm.GetNumberOfInputConnections(port)
            if known:
                update(self.algorithm.GetInputAlgorithm(port, 0), progress)
            inputs.append(self.algorithm.GetInputDataObject(port, 0) if known else None)
        return measure(self.algorithm, inputs, {"energy": energy, "range": range, "missed": missed}, beams, progress)

    def to_pandas(self):
        """The echoes as a pandas DataFrame; see `Cloud.to_pandas`."""
        return self.echoes.to_pandas()

    def plot_range_image(self, array: str = "distance_m", axes=None, **options):
        """Draw the range image with Matplotlib; see `plot_range_image`."""
        return plot_range_image(self, array, axes, **options)

    def plot_map(self, array: str = "energy", axes=None, **options):
        """Draw the echoes from above with Matplotlib; see `plot_map`."""
        return plot_map(self.echoes, array, axes, **options)

    def __repr__(self) -> str:
        return _display.line(self, _display.scan_rows)

    def _repr_html_(self) -> str:
        draw = (lambda axes: self.plot_range_image(axes=axes)) if self.is_current() else None
        return _display.page(self, _display.scan_rows, draw, (8.0, 2.5))

    def save(self, file, **properties) -> None:
        """Write the echoes; see `save`."""
        self.echoes.save(file, **properties)
