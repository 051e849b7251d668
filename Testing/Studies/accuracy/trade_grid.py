# SPDX-License-Identifier: BSD-3-Clause
"""The settings that are compared: families of settings that differ in one thing, over the number of rays."""
import dataclasses

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

RAYS = (8, 16, 32, 64, 100, 200, 400, 1000, 1500, 3000)
FEW_RAYS = (32, 100, 400)
PRESETS = {"Draft": "PRESET_DRAFT", "Standard": "PRESET_STANDARD", "Reference": "PRESET_REFERENCE"}


@dataclasses.dataclass(frozen=True)
class Choice:
    """One setting of the filter; family and rays are its place in the plots."""

    family: str
    values: tuple  # of (property, value)

    @property
    def settings(self):
        return dict(self.values)

    @property
    def words(self):
        """As one would say it, without what is the filter's default."""
        if "Preset" in self.settings:
            return f"the preset {self.family}"
        said = []
        for name, value in self.values:
            default = getattr(Filter(), "Get" + name)()
            if name == "RaysPerBeam":
                said.insert(0, f"{value} rays per beam")
            elif value != default:
                said.append(WORDS[name](value))
        return ", ".join(said)


WORDS = {
    "Sampling": lambda v: "Monte Carlo sampling" if v == Filter.SAMPLING_MONTE_CARLO else "stratified sampling",
    "NumberOfReflections": lambda v: "1 reflection" if v == 1 else f"{v} reflections",
    "NumberOfConnections": lambda v: f"{v or 'no'} connections",
    "BeamSamples": lambda v: "without cells" if v == Filter.BEAM_SAMPLES_RAYS else "cells",
    "FullModel": lambda v: f"the full model {'on' if v else 'off'}",
}


def choices(quick=False):
    """All that is compared. Every family says what it is; all else is the filter's default."""
    rays, few = (RAYS[::3], FEW_RAYS[1:2]) if quick else (RAYS, FEW_RAYS)
    found = {}

    def add(family, numbers, **settings):
        for number in numbers:
            values = tuple({"RaysPerBeam": number, **settings}.items())
            found[values] = Choice(family, values)

    add("Monte Carlo", rays, BeamSamples=Filter.BEAM_SAMPLES_RAYS, Sampling=Filter.SAMPLING_MONTE_CARLO)  # as in the paper
    add("stratified", rays, BeamSamples=Filter.BEAM_SAMPLES_RAYS)
    add("cells", rays)
    add("one reflection", rays, NumberOfReflections=1)
    add("no connections", rays[::3] if quick else rays, NumberOfConnections=0)
    for connections in () if quick else (8, 32):
        add(f"{connections} connections", few, NumberOfConnections=connections)
    add("the full model", few, FullModel=True)
    for name, value in PRESETS.items():
        values = (("Preset", getattr(Filter, value)),)
        found[values] = Choice(name, values)
    return list(found.values())
