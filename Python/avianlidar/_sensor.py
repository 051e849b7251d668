# SPDX-License-Identifier: BSD-3-Clause
"""The lidar."""
from __future__ import annotations

import os
from typing import Any, Dict, Tuple, Union

from . import _display
from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud
from ._pipeline import file_name, update
from ._properties import PropertyOwner, choices, choose, wraps


@wraps(_wrapped.vtkAvianLidarBeamSource)
class Sensor(PropertyOwner):
    """A lidar: its scan pattern, beam, pulse and receiver. Every property of vtkAvianLidarBeamSource is an attribute, in
    the unit that its description says.

    >>> sensor = Sensor("Airport32", position=(0, 0, 3), orientation=(90, 0, 0))  # metres; degrees
    >>> sensor.pulse_energy = 2e-4  # joules
    >>> sensor.beams.number_of_points
    61440
    """

    algorithm: Any  # the vtkAvianLidarBeamSource

    def __init__(self, preset: Union[str, "os.PathLike[str]"] = "Airport16", **properties: Any):
        """`preset`: one of `Sensor.presets()`, or a file (`.lidarsensor.json`); any property by name changes it. The
        most used:

        position     metres east, north, up
        orientation  yaw (clockwise from north), pitch (nose up), roll (to the right) in degrees
        """
        self.algorithm = _wrapped.vtkAvianLidarBeamSource()
        if str(preset).endswith(".json"):
            update(self.algorithm, run=lambda: self.algorithm.LoadSensor(file_name(preset)))
        else:
            getattr(self.algorithm, "SetPresetTo" + choose(type(self.algorithm), "Preset", str(preset)))()
        self.set(**properties)

    @staticmethod
    def presets() -> Tuple[str, ...]:
        """Names of the sensors that are known.

        >>> Sensor.presets()
        ('Airport16', 'Airport32', 'Automotive16', 'CorridorC16', 'Search1550', 'Search905')
        """
        return tuple(choices(_wrapped.vtkAvianLidarBeamSource, "Preset"))

    def __getstate__(self) -> Dict[str, Any]:
        return self.properties()

    def __setstate__(self, properties: Dict[str, Any]) -> None:
        Sensor.__init__(self, **properties)

    def __repr__(self) -> str:
        return _display.line(self, _display.sensor_rows)

    def _repr_html_(self) -> str:
        return _display.page("Sensor", _display.sensor_rows(self), lambda axes: _display.draw_pattern(self, axes))

    @property
    def beams(self) -> Cloud:
        """The beams, one point each at the sensor (m): `direction` (unit vectors), `azimuth` (0.01 deg from north,
        clockwise), `vertical_angle` (deg), `timestamp` (us), `beam_id`, `laser_id`."""
        update(self.algorithm)
        return Cloud(self.algorithm.GetOutput())
