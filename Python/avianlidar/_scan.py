# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a scene and their echoes."""
import os
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from . import _display, _plot
from . import vtkAvianLidar as _wrapped
from ._advice import Advice
from ._advising import measure
from ._cloud import Cloud, add_array, array_names, as_numpy, point_array
from ._pipeline import Progress, callers_level, is_current, update
from ._properties import PropertyOwner, wraps
from ._scene import Scene, time_of
from ._sensor import Sensor
from ._sight import warnings_of
from ._waveforms import Waveforms


class SceneAndSensor(PropertyOwner):
    """Base of scans and coverages: a scene observed from a sensor."""

    algorithm: Any
    progress: Progress | None

    def __init__(self, algorithm, scene, sensor, progress: Progress | None, settings: dict[str, Any]):
        self.algorithm = algorithm
        self.set(**settings)
        self.progress = progress
        self.scene = scene
        self.sensor = sensor

    @property
    def scene(self) -> Scene:
        """The scene. May be set."""
        return self._scene

    @scene.setter
    def scene(self, scene) -> None:
        self._scene = scene if isinstance(scene, Scene) else Scene(scene, progress=self.progress)
        self.algorithm.SetSurfacesConnection(self._scene.tree.GetOutputPort())

    @property
    def sensor(self):
        """The sensor. May be set to a Sensor; to a preset's name or a sensor file, which are placed at the scene's
        lidar position; or to beams: vtkPolyData, a Cloud (`Sensor.beams`), or the output of a VTK algorithm."""
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
            raise TypeError("a sensor is a Sensor, a preset's name, a sensor file, or beams (vtkPolyData, Cloud, "
                            f"algorithm), not {type(sensor).__name__}")
        self._sensor = sensor

    def __reduce__(self):
        raise TypeError(f"a {type(self).__name__} cannot be copied: copy its scene and its sensor, and "
                        "make another object with properties()")

    def _refresh(self) -> None:
        self.scene.refresh()

    def is_current(self) -> bool:
        """Whether the results are up to date with all inputs and properties."""
        self._refresh()
        return is_current(self.algorithm)

    def update(self):
        """Runs everything that is not up to date. Errors are raised as `Error`. Warnings are Python warnings, also for
        a sensor that can see nothing. Ctrl-C stops the work."""
        if not self.is_current():
            update(self.algorithm, self.progress)
            for text in warnings_of(self):
                warnings.warn(text, RuntimeWarning, stacklevel=callers_level())
        return self

    @property
    def number_of_traced_rays(self) -> int:
        """Number of rays that the last execution traced; 0 if all hits were kept from before."""
        return int(self.algorithm.GetNumberOfTracedRays())


@wraps(_wrapped.vtkAvianLidarEchoFilter)
class Scan(SceneAndSensor):
    """A scan of a scene by a sensor. Every property of vtkAvianLidarEchoFilter is an attribute, in the unit of its
    description.

    A scan runs when results are read, and repeats only the work that a change requires. Hits of rays are kept: after a
    change of attenuation, limits, materials or return modes, few rays are traced, mostly none.

    >>> scene = Scene(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Glass")
    >>> scan = Scan(scene, Sensor(azimuth_step=1), rays_per_beam=200)
    >>> haze = scan["energy"].mean()  # joules
    >>> scan.attenuation_coefficient = 8.8e-5  # 1/m
    >>> bool(scan["energy"].mean() < haze), scan.number_of_traced_rays
    (True, 0)
    """

    def __init__(self, scene, sensor=None, progress: Progress | None = None, movers=None, **settings: Any):
        """A scan, not yet run.

        scene     a Scene, or any source of a Scene: a mesh or scene file, VTK data, (points, triangles)
        sensor    a Sensor, a preset's name or any beams, see `sensor`; default: Airport16 at the scene's lidar
                  position, else at the origin
        progress  called with the completed share (0 to 1) and the name of the running class
        movers    moving surfaces: vtkPolyData of `mover`, a list or a composite of vtkPolyData, or a VTK algorithm such
                  as vtkAvianLidarTracks
        settings  any property by name, for example rays_per_beam, preset="Standard", attenuation_coefficient (1/m)
        """
        algorithm = _wrapped.vtkAvianLidarEchoFilter()
        algorithm.ReportMoversOff()  # until the mover report is read
        super().__init__(algorithm, scene, sensor, progress, settings)
        self.movers = movers

    @property
    def movers(self):
        """The movers, as they were given. May be set; None for no movers."""
        return self._movers

    @movers.setter
    def movers(self, movers) -> None:
        self._movers = movers
        self._blocks, self._seen = None, 0  # data, and VTK's time of their last known change
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
            modified = time_of(self._blocks)  # a composite does not include the times of its blocks
            if self._seen and modified > self._seen:
                self._blocks.Modified()
            self._seen = time_of(self._blocks)

    @property
    def echoes(self) -> Cloud:
        """The echoes, one point each (m): `energy` (J), `distance_m` (m), `intensity` (0 to 255), `object_id`, ..., as
        described in vtkAvianLidarEchoFilter. A returned Cloud does not change when the scan changes."""
        return Cloud(self.update().algorithm.GetOutput(0))

    @property
    def report(self) -> Cloud:
        """One point for every beam: `status` (0 echo, 1 no surface, 2 below the lower limit, 3 saturated, 4 outside
        the gate), costs, and `skipped_bound` (J)."""
        return Cloud(self.update().algorithm.GetOutput(1))

    @property
    def mover_report(self) -> Cloud:
        """One point for every mover that is present, at its place when a beam receives most energy from the mover:
        `object_id`, `effective_area` (m2), `energy_received` (J, without noise), `detection_probability`,
        `number_of_echoes`, ...

        The first reading of this report switches `report_movers` on."""
        self.algorithm.ReportMoversOn()
        return Cloud(self.update().algorithm.GetOutput(2))

    @property
    def waveforms(self) -> Waveforms:
        """The recorded light of beams before the receiver decides. The first reading switches `record_waveforms` on, after
        which the echoes have `echo_width`, `echo_rise_time` (s), `echo_amplitude` (W), `echo_integral` (J) and
        `echo_samples`. `waveform_floor` chooses the stretches; the sensor has `digitiser_rate` and
        `digitiser_bits`."""
        self.algorithm.RecordWaveformsOn()
        return Waveforms(self.update().algorithm.GetOutput(3))

    def __getitem__(self, name: str) -> np.ndarray:
        """An array of the echoes by name, in the unit of `echoes.units`."""
        return self.echoes[name]

    def __iter__(self) -> Iterator[str]:
        """Names of the arrays of the echoes."""
        return iter(self.echoes)

    def __contains__(self, name: object) -> bool:
        return name in self.echoes

    def range_image(self) -> dict[str, np.ndarray]:
        """The strongest echo of each beam as an image, elevation by azimuth.

        distance_m  m, NaN where there is no echo      column_azimuths  deg from north, clockwise
        energy      J, NaN where there is no echo      row_elevations   deg, upwards
        object_id   -1 where there is no echo          echo             number of the echo, -1 without an echo

        The arrays of the beam report are also included: `status`, `candidates`, `nodes_visited`, `rays_traced`,
        `skipped`, `skipped_bound` (J).

        For a tilted sensor and for a sensor with rotating prisms, columns are firings and rows are channels.
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
        shape = data.GetDimensions()[1::-1]  # rows, columns
        result = {name: point_array(data, name).reshape(shape) for name in array_names(data)}
        for name in ("column_azimuths", "row_elevations"):
            result[name] = as_numpy(data.GetFieldData().GetArray(name))
        result["echo"] = result["object_id"]
        objects = np.append(point_array(echoes, "object_id"), -1)  # the last element stands for beams without an echo
        result["object_id"] = objects[result["echo"]]
        return result

    def advise(self, energy: float = 0.02, range: float = 0.05, missed: float = 0.01, beams: int = 1000,
               progress: Progress | None = None) -> Advice:
        """The settings that this scan requires, measured on some of its beams: the fastest settings that surely keep
        the limits.

        energy    largest allowed error of the received energy, rms, relative
        range     largest allowed error of ranges, rms, m
        missed    largest allowed share of missed or invented echoes, relative to the true echoes
        beams     number of beams that are measured; more beams decide smaller errors and take longer
        progress  as in the constructor; default: the scan's own

        Sensor, scene, movers and air are those of the scan, which does not change. `scan.set(**advice.settings)`
        applies the settings. The measurement takes seconds; see Documentation/guide/accuracy.md.

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

    plot_map, plot_range_image = _plot.plot_map, _plot.plot_range_image

    def __repr__(self) -> str:
        return _display.line(self, _display.scan_rows)

    def _repr_html_(self) -> str:
        draw = (lambda axes: self.plot_range_image(axes=axes)) if self.is_current() else None
        return _display.page(self, _display.scan_rows, draw, (8.0, 2.5))

    def save(self, file, **properties) -> None:
        """Writes the echoes; see `save`."""
        self.echoes.save(file, **properties)
