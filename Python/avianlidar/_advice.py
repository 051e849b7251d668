# SPDX-License-Identifier: BSD-3-Clause
"""The settings that a scene requires of a scan, as measured on the scene."""
import dataclasses
import io
import json
import os
import pathlib
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from ._numbers import figures
from ._properties import snake

# properties of vtkAvianLidarEchoFilter
SETTINGS = ("BeamSamples", "RaysPerBeam", "Sampling", "NumberOfReflections", "NumberOfConnections")
KINDS = ("energy", "range", "missed")  # kinds of errors
VERDICTS = ("not met", "undecided", "met")
NOT_MET, UNDECIDED, MET = range(3)
UNITS = {"seconds_per_beam": "s", "range_error": "m", "range_error_most": "m"}  # of columns; others have the unit "1"
MOST_ROWS = 12  # number of settings that a reader sees beside the scan's own
SUFFIXES = (".json", ".csv", ".png")


class Setting(NamedTuple):
    """Values of SETTINGS; choices are given by their numbers."""

    samples: int  # 0 cells, 1 rays
    rays: int
    sampling: int  # 0 Monte Carlo, 1 stratified
    reflections: int
    connections: int

    def words(self) -> str:
        paths = f"{self.reflections} reflections, {self.connections} connections" if self.reflections > 1 else "1 reflection"
        return f"{self.rays} {('Cells', 'Rays')[self.samples]}{'' if self.sampling else ', MonteCarlo'}, {paths}"

    def properties(self) -> dict[str, Any]:
        """The settings as keywords of `Scan.set`."""
        samples, sampling = ("Cells", "Rays")[self.samples], ("MonteCarlo", "Stratified")[self.sampling]
        values = (samples, self.rays, sampling, self.reflections, self.connections)
        return {"preset": "Custom", **dict(zip(map(snake, SETTINGS), values))}

    def as_commands(self) -> list[str]:
        """The settings as options of the command, in Python and for ParaView's panel."""
        values = self.properties().items()
        quoted = [(name, f'"{value}"' if isinstance(value, str) else value) for name, value in values]
        return ["Command: " + " ".join(f"--scan-set {name}={value}" for name, value in values),
                f"Python: scan.set({', '.join(f'{name}={value}' for name, value in quoted)})",
                "ParaView: " + ", ".join(f"{name.replace('_', ' ').title()} {value}" for name, value in values)]


@dataclasses.dataclass(frozen=True)
class Advice:
    """The measurements of a scene, and the advice.

    settings  properties of a Scan, for `scan.set(**advice.settings)`; None if no setting surely keeps the limits
    lines     sentences on what is advised and why; the last lines give the settings as options of the command, in
              Python and for ParaView's panel
    asked     largest allowed errors: `energy` (rms, relative), `range` (m, rms), `missed` (share)
    row       number of the advised row of the table, -1 if no row is advised
    table     columns with one value for each setting that was tried, the scan's own setting first: `beam_samples`
              (0 cells, 1 rays), `rays_per_beam`, ..., `seconds_per_beam` (s of one core), `energy_error`,
              `energy_error_most` (upper bound, 95 %), `range_error` (m), `missed_share`, `verdict` (0 limits exceeded,
              1 undecided, 2 limits kept)
    """

    settings: dict[str, Any] | None
    lines: tuple[str, ...]
    asked: dict[str, float]
    row: int
    table: dict[str, np.ndarray]

    def __str__(self) -> str:
        return "\n".join(self.lines)

    def words(self, row: int) -> str:
        """The setting in a row of the table, in words."""
        return self.setting(row).words()

    def setting(self, row: int) -> Setting:
        """The setting in a row of the table."""
        return Setting(*(int(self.table[snake(name)][row]) for name in SETTINGS))

    def save(self, file: str | os.PathLike) -> None:
        """Writes the advice: .json holds everything, .csv the table, .png a picture of errors (needs Matplotlib)."""
        from ._disk import write_whole
        from ._writers import as_csv
        target, content = pathlib.Path(file), io.BytesIO()
        check_suffix(target)
        if target.suffix.lower() == ".png":
            self.plot().figure.savefig(content, format="png", dpi=150)
        elif target.suffix.lower() == ".json":
            table = {key: [value if np.isfinite(value) else None for value in values.tolist()]
                     for key, values in self.table.items()}
            content.write((json.dumps({**dataclasses.asdict(self), "table": table}, indent=1) + "\n").encode())
        else:
            rows = ([f"{value:.9g}" for value in row] for row in zip(*self.table.values()))
            content.write(as_csv([list(self.table), *rows]))
        write_whole(target, content.getvalue())

    def plot(self, axes=None):
        """Draws the error of energy over time with Matplotlib, one point for each setting. A filled point keeps all
        limits. Returns the axes."""
        from matplotlib.figure import Figure
        axes = axes or Figure(figsize=(7, 4.5), layout="constrained").add_subplot()
        samples, reflections, verdicts = (self.table[key] for key in
                                          ("beam_samples", "number_of_reflections", "verdict"))
        times, errors = 1e6 * self.table["seconds_per_beam"], 100 * np.maximum(self.table["energy_error"], 1e-5)
        for kind, paths, marker, colour, name in (
                (0, 1, "s", "tab:orange", "Cells, 1 reflection"), (0, 3, "o", "tab:blue", "Cells, 3 reflections"),
                (1, 1, "v", "tab:olive", "Rays, 1 reflection"), (1, 3, "^", "tab:gray", "Rays, 3 reflections")):
            for met in (False, True):
                some = (samples == kind) & (reflections == paths) & ((verdicts == MET) == met)
                axes.scatter(times[some], errors[some], marker=marker, s=30, edgecolors=colour,
                             facecolors=colour if met else "none", label=name if met else None)
        axes.axhline(100 * self.asked["energy"], color="black", linewidth=0.8, linestyle=":")
        if self.row >= 0:
            axes.scatter(times[self.row], errors[self.row], s=160, facecolors="none", edgecolors="tab:red",
                         label="advised")
        axes.set(xscale="log", yscale="log", xlabel="time of a beam, one core (µs)", ylabel="error of energy (% rms)")
        axes.legend(fontsize="small")
        return axes


def check_suffix(file: pathlib.Path) -> None:
    if file.suffix.lower() not in SUFFIXES:
        kind = file.suffix or "a file without suffix"
        raise ValueError(f"{file}: advice is not written as {kind}, expected {', '.join(SUFFIXES)}")


def table_rows(advice: Advice) -> list[tuple[Any, ...]]:
    """Rows for a reader: the scan's own settings, then the fastest settings, with those that exceed limits last."""
    table = advice.table
    order = np.lexsort((table["seconds_per_beam"][1:], table["verdict"][1:] == NOT_MET)) + 1
    rows: list[tuple[Any, ...]] = [("setting", "us a beam", "energy, % (at most)", "range, m (at most)",
                                    "wrong echoes, % (at most)", "")]
    for row in (0, *order[:MOST_ROWS]):
        errors = [f"{figures(scale * table[name][row], 3)} ({figures(scale * table[name + '_most'][row], 3)})"
                  for name, scale in (("energy_error", 100), ("range_error", 1), ("missed_share", 100))]
        verdict = "advised" if row == advice.row else VERDICTS[table["verdict"][row]]
        name, time = ("" if row else "now: ") + advice.words(row), figures(1e6 * table['seconds_per_beam'][row], 3)
        rows.append((name, time, *errors, verdict))
    return rows


def to_act_on(fields: Mapping[str, Any]) -> Iterator[str]:
    """Sentences on limits of a scan that a user can remove, from the field data of the echoes."""
    farthest, gate = (float(fields.get(name, np.inf)) for name in ("perceivable_range", "range_gate"))
    if farthest < gate:
        yield (f"nothing beyond {farthest:.0f} m is perceived, although the range gate ends at {figures(gate)} m: "
               "more pulse energy, a lower energy limit or clearer air would let the sensor see farther")


def notes_of(fields: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Name and text of each note on what was modelled of a scan and what was left out, from the field data."""
    return [(name[5:].replace("_", " "), " ".join(text)) for name, text in fields.items() if name.startswith("note_")]
