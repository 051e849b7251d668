# SPDX-License-Identifier: BSD-3-Clause
"""Waveforms of beams: the light that the receiver's digitiser samples."""
from __future__ import annotations

import pathlib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from ._cloud import Cloud, as_numpy
from ._disk import replacing
from ._writers import refuse, write, write_csv

WAVEFORMS = (".csv", ".vtp", ".las", ".png")  # suffixes of files
LINES: dict[str, tuple[str, dict[str, Any]]] = {
    "signal": ("mean signal", {"color": "C1"}), "sample": ("drawn sample", {"color": "C0", "ls": "", "marker": "."})}


class Waveform(Mapping):
    """One recorded stretch of a beam: arrays with a value for each sample, by name.

    `sample_time` (s), `distance_m` (m), `signal`, `background`, `sample`, `energy_received`, `threshold` (J)."""

    def __init__(self, owner: "Waveforms", number: int, begin: int, end: int):
        cells = owner.data.GetCellData()
        self._owner, self._place = owner, slice(begin, end)
        self.beam_id = int(cells.GetArray("beam_id").GetTuple1(number))
        self.timestamp = cells.GetArray("timestamp").GetTuple1(number)  # microseconds
        self.origin = cells.GetArray("origin").GetTuple3(number)  # m

    def __getitem__(self, name: str) -> np.ndarray:
        return self._owner[name][self._place]

    def __iter__(self) -> Iterator[str]:
        return iter(self._owner)

    def __len__(self) -> int:
        return len(self._owner)

    def __repr__(self) -> str:
        near, far = self["distance_m"][[0, -1]]
        return f"<Waveform of beam {self.beam_id}: {near:.2f} to {far:.2f} m, {len(self['signal'])} samples>"

    def crossings(self, level: float, array: str = "sample") -> np.ndarray:
        """Ranges (m) at which an array rises through a level (J), interpolated: the ranges of a receiver with a
        threshold, which a weak echo reaches later (range walk)."""
        values, ranges = self[array], self["distance_m"]
        at = np.flatnonzero((values[:-1] < level) & (values[1:] >= level))
        return ranges[at] + (level - values[at]) / (values[at + 1] - values[at]) * (ranges[at + 1] - ranges[at])

    def constant_fraction(self, level: float, fraction: float = 0.5, array: str = "sample") -> np.ndarray:
        """Ranges (m) at which each pulse above a level (J) reaches a fraction of its own peak. A pulse ends where it
        falls below the level. These ranges do not depend on the strength of the pulse."""
        values, ranges = self[array], self["distance_m"]
        above = np.concatenate([[False], values >= level, [False]])
        found = []
        for begin, end in zip(np.flatnonzero(~above[:-1] & above[1:]), np.flatnonzero(above[:-1] & ~above[1:])):
            peak = begin + int(np.argmax(values[begin:end]))
            wanted = fraction * values[peak]
            below = peak
            while below > 0 and values[below] >= wanted:
                below -= 1
            rise = values[below + 1] - values[below]
            part = (wanted - values[below]) / rise if rise > 0 else 0.0
            found.append(ranges[below] + part * (ranges[below + 1] - ranges[below]))
        return np.array(found)


class Waveforms(Cloud):
    """Waveforms of a scan: a Cloud of samples, in lines that are the recorded stretches of beams.

    >>> scene = Scene(([(-5, 50, -5), (5, 50, -5), (0, 50, 9)], [(0, 1, 2)]), material="Wall")
    >>> scan = Scan(scene, Sensor(azimuth_step=1, digitiser_rate=1e9), record_waveforms=True)
    >>> wave = scan.waveforms.strongest()
    >>> wave.crossings(wave["signal"].max() / 2, "signal").round(1)
    array([49.6])
    """

    def _bounds(self) -> np.ndarray:
        offsets = self.data.GetLines().GetOffsetsArray()
        return vtk_to_numpy(offsets) if offsets.GetNumberOfTuples() else np.zeros(1, int)

    @property
    def number_of_stretches(self) -> int:
        """Number of recorded stretches."""
        return len(self._bounds()) - 1

    @property
    def samples_of_unit(self) -> int:
        """Number of samples in a range unit."""
        return max(1, round(self.fields.get("digitiser_rate", 0.0) * self.fields["sampling_interval"]))

    @property
    def beam_ids(self) -> np.ndarray:
        """The beam of each stretch."""
        return as_numpy(self.data.GetCellData().GetArray("beam_id")) if self.number_of_stretches else np.zeros(0, int)

    def stretch(self, number: int) -> Waveform:
        """A stretch by its number, from 0."""
        bounds = self._bounds()
        if not 0 <= number < len(bounds) - 1:
            raise IndexError(f"there is no stretch {number}, expected 0 to {len(bounds) - 2}")
        return Waveform(self, number, int(bounds[number]), int(bounds[number + 1]))

    def of(self, beam_id: int) -> list[Waveform]:
        """The stretches of a beam, nearest first. Beams without light above the floor have none."""
        return [self.stretch(int(number)) for number in np.flatnonzero(self.beam_ids == beam_id)]

    def check(self, beam_id: int) -> None:
        """Raises ValueError for a beam of which nothing is recorded."""
        if beam_id not in self.beam_ids:
            raise ValueError(f"beam {beam_id} has no waveform above waveform_floor, expected a beam such as "
                             f"{self.strongest().beam_id}, the strongest")

    def strongest(self) -> Waveform:
        """The stretch with the largest mean signal."""
        if not self.number_of_stretches:
            raise ValueError("no waveform is recorded: no beam has light above waveform_floor, or record_waveforms is off")
        most = int(np.argmax(self["signal"]))
        return self.stretch(int(np.searchsorted(self._bounds(), most, side="right")) - 1)

    def plot(self, beam_id: int | None = None, axes=None):
        """Draws the stretches of a beam against range with Matplotlib, logarithmically: drawn samples, mean signal, the
        energy of range units, and the threshold of the receiver. Samples are scaled to the length of a range unit, so
        that one height means one power. Default: the beam with the strongest signal. Returns the axes."""
        import matplotlib.pyplot as plt
        beam_id = self.strongest().beam_id if beam_id is None else beam_id
        self.check(beam_id)
        stretches = self.of(beam_id)
        if axes is None:
            _, axes = plt.subplots(figsize=(9, 4), constrained_layout=True)
        for number, one in enumerate(stretches):
            ranges = one["distance_m"]
            half = 0.5 * (ranges[1] - ranges[0]) if len(ranges) > 1 else 0.05
            borders = np.append(ranges - half, ranges[-1] + half)
            known = {} if number == 0 else {"label": "_"}
            axes.stairs(one["energy_received"], borders, **{"color": "0.6", "label": "range unit", **known})
            for array, (words, style) in LINES.items():
                axes.plot(ranges, self.samples_of_unit * one[array], **{"label": words, **style, **known})
            axes.plot(borders[:-1], one["threshold"], **{"ls": "--", "color": "C3", "label": "threshold", **known})
        most = max(one["energy_received"].max() for one in stretches)
        least = min(one["threshold"].min() for one in stretches)
        axes.set(xlabel="range (m)", ylabel="energy in a range unit (J)", title=f"beam {beam_id}", yscale="log",
                 ylim=(0.1 * least, 3 * max(most, least)))
        axes.legend(loc="upper right")
        return axes

    def save(self, file, echoes=None, beam_id: int | None = None, **properties: Any) -> None:  # type: ignore[override]
        """Writes the waveforms to a file, by its suffix. @param echoes echoes of the scan, for .las @param beam_id the
        beam of a picture

        .csv  a row for each sample                  .las  the echoes, with waveform packets (LAS 1.4), and
        .vtp  the lines, for VTK and ParaView              properties of vtkAvianLidarLASWriter, such as external_waveforms
        .png  `plot`
        """
        path = pathlib.Path(file)
        suffix = path.suffix.lower()
        if suffix not in WAVEFORMS:
            raise refuse("write waveforms to", path, list(WAVEFORMS))
        if suffix == ".las":
            if echoes is None:
                raise TypeError("a .las file of waveforms needs echoes, the points that the waveforms belong to")
            write(echoes, path, waveforms=self.data, **properties)
            return
        if suffix == ".vtp":
            write(self, path)
            return
        with replacing(path) as name:
            if suffix == ".csv":
                cells, counts = self.data.GetCellData(), np.diff(self._bounds())
                write_csv(self, name, [(array, unit, np.repeat(vtk_to_numpy(cells.GetArray(array)), counts))
                                       for array, unit in (("beam_id", ""), ("timestamp", "us")) if len(counts)])
            else:
                import matplotlib.pyplot as plt
                figure = self.plot(beam_id).figure
                figure.savefig(name, format="png", dpi=150)
                plt.close(figure)
