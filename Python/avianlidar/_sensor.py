# SPDX-License-Identifier: BSD-3-Clause
"""Lidar sensors."""
import json
import os
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from . import _display
from . import vtkAvianLidar as _wrapped
from ._cloud import Cloud, add_array, lines_of, point_array, rows_of, with_points
from ._pipeline import file_name, is_current, update
from ._properties import DECISIVE, PATTERN, PropertyOwner, choices, choose, wraps


def trajectory(positions, times, orientations=None) -> vtkPolyData:
    """A trajectory of a moving platform for `Sensor(trajectory=...)`: a line with a pose at each point.

    positions     n rows of x, y, z in metres
    times         n ascending times in seconds, on the clock of the beams
    orientations  n unit quaternions w, x, y, z from the platform's frame (x right, y forward, z up) to the scene's
                  frame; None: no rotation

    >>> car = trajectory([(0, 0, 2), (40, 0, 2)], times=[0, 4])
    >>> Sensor(trajectory=car).beams.points[-1].round()
    array([20.,  0.,  2.])
    """
    places, at = rows_of("positions", positions, (3,)), rows_of("times", times, ())
    turns = None if orientations is None else rows_of("orientations", orientations, (4,))
    if {len(places), len(at), len(at if turns is None else turns)} != {len(places)}:
        raise ValueError(f"there are {len(places)} positions, {len(at)} times and {'no' if turns is None else len(turns)} "
                         "orientations, expected as many of each")
    line = lines_of([np.column_stack([places, at])])
    if turns is not None:
        add_array(line.GetPointData(), "pose_orientation", turns, "1")
    return line


def poses_of(line: vtkPolyData) -> tuple[np.ndarray, ...]:
    """Copies of positions (m), times (s) and, if there are any, orientations of a trajectory."""
    names = [name for name in ("time", "pose_orientation") if line.GetPointData().GetArray(name)]
    return tuple(np.array(part) for part in (Cloud(line).points, *(point_array(line, name) for name in names)))


@wraps(_wrapped.vtkAvianLidarBeamSource)
class Sensor(PropertyOwner):
    """A lidar: its scan pattern, beam, pulse and receiver. Every property of vtkAvianLidarBeamSource is an attribute,
    in the unit of its description.

    >>> sensor = Sensor("Airport32", position=(0, 0, 3), orientation=(90, 0, 0))  # metres; degrees
    >>> sensor.pulse_energy = 2e-4  # joules
    >>> sensor.beams.number_of_points
    61440
    >>> Sensor(directions=[(0, 1, 0), (1, 1, 0)], times=[0, 1e-4], wavelength=1550).beams["azimuth"]  # of one's own
    array([   0., 4500.])
    """

    algorithm: Any  # the vtkAvianLidarBeamSource
    _beams: Any  # directions, times and positions of the user's beams, or None

    def __init__(self, preset: str | os.PathLike = "Airport16", *, directions=None, times=None, positions=None,
                 trajectory: vtkPolyData | None = None, **properties: Any):
        """`preset` is one of `Sensor.presets()`, or a file (`.lidarsensor.json`). Any property by name changes the
        preset. Frequent properties:

        position     metres east, north, up
        orientation  yaw (clockwise from north), pitch (nose up), roll (right side down) in degrees

        Beams may replace the pattern of the preset. They are in the frame of the sensor, which `orientation` turns and
        `position` moves. Beam shape, pulse and receiver are kept from the preset:

        directions   n rows of x, y, z, of any length above 0
        times        n seconds since the start of the scan, 0 or more; default: all 0. Without `rotation_rate`, a scan
                     that is too short for the times is extended to the last time
        positions    n rows of x, y, z in metres; default: all 0

        A sensor on a car or a drone has a `trajectory`, see there.
        """
        self.algorithm = _wrapped.vtkAvianLidarBeamSource()
        if str(preset).endswith(".json"):
            update(self.algorithm, run=lambda: self.algorithm.LoadSensor(file_name(preset)))
        else:
            getattr(self.algorithm, "SetPresetTo" + choose(type(self.algorithm), "Preset", str(preset)))()
        self._beams = None if directions is None else (directions, times, positions)
        if self._beams:
            latest = self._take_beams(*self._beams)
            if latest * self.algorithm.GetRotationRate() > 1:
                properties = {"rotation_rate": 1 / latest, **properties}
        elif times is not None or positions is not None:
            raise TypeError("Sensor: times and positions need directions, which are not given")
        self.set(**properties)
        self.trajectory = trajectory

    def _take_beams(self, directions, times, positions) -> float:
        """Sets the beams, and returns the time of the last beam, s."""
        count = len(directions) if np.ndim(directions) else 0
        found = []
        for name, values, shape in (("directions", directions, (count, 3)), ("times", times, (count,)),
                                    ("positions", positions, (count, 3))):
            found.append(np.zeros(shape) if values is None else np.asarray(values, dtype=float))
            if found[-1].shape != shape or not count:
                expected = "n rows of x, y, z" if name == "directions" else f"{shape}, as directions have {count} rows"
                raise ValueError(f"Sensor: {name} have the shape {found[-1].shape}, expected {expected}")
        beams = with_points(found[2])
        add_array(beams.GetPointData(), "direction", found[0])
        add_array(beams.GetPointData(), "timestamp", 1e6 * found[1])
        update(self.algorithm, run=lambda: self.algorithm.SetBeams(beams))
        return float(found[1].max())

    @property
    def trajectory(self) -> vtkPolyData | None:
        """The trajectory of the platform on which the sensor moves: vtkPolyData of `avianlidar.trajectory` or
        `read_trajectory`; None for a sensor that stands. May be set. `position` and `orientation` are then in the frame
        of the platform (x right, y forward, z up)."""
        return self.algorithm.GetInputDataObject(0, 0) if self.algorithm.GetNumberOfInputConnections(0) else None

    @trajectory.setter
    def trajectory(self, trajectory: vtkPolyData | None) -> None:
        if not (trajectory is None or isinstance(trajectory, vtkPolyData)):
            raise TypeError(f"a trajectory is vtkPolyData, as of read_trajectory, not {type(trajectory).__name__}")
        self.algorithm.SetInputDataObject(0, trajectory)

    @staticmethod
    def presets() -> tuple[str, ...]:
        """Names of the sensors that are known.

        >>> print(*Sensor.presets())  # doctest: +NORMALIZE_WHITESPACE
        Airport16 Airport32 Automotive16 Avia CorridorC16 HDL32E Helios16P Mid360 Mid40 OS0_128 OS1_64 OS2_128
        Pandar40P PandarXT32 Search1550 Search905 VLP16 VLP32C
        """
        return tuple(choices(_wrapped.vtkAvianLidarBeamSource, "Preset"))

    def __getstate__(self) -> dict[str, Any]:
        line = self.trajectory
        return {"text": self.algorithm.GetDescription(), "beams": self._beams, "properties": self.properties(),
                "trajectory": line and poses_of(line)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.algorithm = _wrapped.vtkAvianLidarBeamSource()
        update(self.algorithm, run=lambda: self.algorithm.LoadSensorText(state["text"]))
        self._beams = state["beams"]
        if self._beams:
            self._take_beams(*self._beams)
        self.set(**state["properties"])
        self.trajectory = state["trajectory"] and trajectory(*state["trajectory"])

    def __repr__(self) -> str:
        return _display.line(self, _display.sensor_rows)

    def _repr_html_(self) -> str:
        return _display.page(self, _display.sensor_rows, lambda axes: _display.draw_pattern(self, axes))

    def fit(self, points=None):
        """Fits the receiver to all points of the maker's data sheet: sets `receiver_aperture` and, if the points differ
        in light, `filter_bandwidth` of a photon receiver. Needs SciPy.

        points  mappings with `range` (m), `reflectance` (above 0, at most 1), `source` (a text), and optionally
                `probability` of detection (default 0.5, assumed), `light` on the board (klx, default 0) and `board`,
                the board's width (m; default: one fitted width for all points). Default: the points of the sensor's
                file (`sheet.points`)

        Returns a Fit with `numbers`, `board` (m) and, for each point, `predicted` (m), `residuals` and `left_out`: the
        relative errors of the range with the point in the fit and without the point. `bar` is the largest of these
        errors, the expected error of ranges by this receiver (nan: no point can be left out, so the error is unknown).
        A filter is at most 100 nm wide (assumed); `limit` is a sentence if the fit ends at this bound, else empty.
        ValueError: a point is invalid, or the sensor has no aperture.

        >>> round(Sensor("Search905").fit([{"range": 300, "reflectance": 0.1, "source": "mine"}]).predicted[0])
        300
        """
        from ._sheet import fit
        found = fit(self, points)
        self.set(receiver_model="Photons", **found.numbers)
        return found

    @property
    def description(self) -> dict[str, Any]:
        """The content of the preset's file: `name`, a description (`comment`), documents (`source`), and, if the file
        has them, the maker's numbers without a property (`data_sheet`) and with a property (`values`), each with
        `value`, `unit` and `source`. A `source` that begins with "assumed" means that the number was not measured.
        `sheet` has ranges of the data sheet. Later changes of properties do not appear.

        >>> Sensor("VLP-16").description["values"]["wavelength"]
        {'value': 903.0, 'unit': 'nm', 'source': 'user manual'}
        """
        return json.loads(self.algorithm.GetDescription())

    @property
    def not_given(self) -> tuple[str, ...]:
        """Decisive properties that the sensor's file does not give and that have their defaults.

        >>> Sensor("VLP16").not_given
        ()
        """
        given, default = self.description.get("values", {}), Sensor()
        own = set(PATTERN) | {"rotation_rate", "firing_interval"} if self._beams else set()
        return tuple(name for name, others in {**PATTERN, **DECISIVE}.items()
                     if name not in own and not given.keys() & {name, *others} and
                     getattr(self, name) == getattr(default, name))

    def set_limits_from_data_sheet(self, range: float, reflectance: float,
                                   attenuation: float | None = None) -> "Sensor":
        """Sets the limits of `EnergyLimits` so that a surface that fills the beam is detected up to `range` (m) at this
        reflectance. `attenuation` of the air (1/m); default: clear air.

        >>> Sensor("VLP16").set_limits_from_data_sheet(50, 0.1).lower_energy_limit > 0
        True
        """
        air = self.algorithm.GetClearAirAttenuation() if attenuation is None else attenuation
        update(self.algorithm, run=lambda: self.algorithm.SetLimitsFromDataSheet(range, reflectance, air))
        return self

    @property
    def on_sale(self) -> bool:
        """Whether somebody sells the lidar of the preset's file: the file names a maker other than "assumed".

        >>> Sensor("OS2_128").on_sale, Sensor("Search905").on_sale, Sensor("Airport16").on_sale
        (True, False, False)
        """
        return self.description.get("maker", "assumed") != "assumed"

    @property
    def beams(self) -> Cloud:
        """The beams, one point each at the sensor (m): `direction` (unit vectors), `azimuth` (0.01 deg from north,
        clockwise), `vertical_angle` (deg), `timestamp` (us), `beam_id`, `laser_id`."""
        if not is_current(self.algorithm):
            update(self.algorithm)
        return Cloud(self.algorithm.GetOutput())
