# SPDX-License-Identifier: BSD-3-Clause
"""The settings that are compared: families of settings that differ in one thing, over the number of rays. Beams are
refined near the limit in the family of that name and with the presets alone: elsewhere a number of rays means all beams."""
import dataclasses

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import trade_runs

RAYS = (8, 16, 32, 64, 100, 200, 400, 1000, 1500, 3000)
FEW_RAYS = (32, 100, 400)
TARGETS = (0.01, 0.02, 0.05, 0.1, 0.2)
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
            elif value if name == "RefineNearLimit" else value != default:
                said.append(WORDS[name](value))
        return ", ".join(said)


WORDS = {
    "Sampling": lambda v: "Monte Carlo sampling" if v == Filter.SAMPLING_MONTE_CARLO else "stratified sampling",
    "NumberOfReflections": lambda v: "1 reflection" if v == 1 else f"{v} reflections",
    "NumberOfConnections": lambda v: f"{v or 'no'} connections",
    "TargetRelativeError": lambda v: f"a target error of {100 * v:g} %",
    "PlaneIntegration": lambda v: "few triangles integrated" if v else "every beam sampled",
    "RefineNearLimit": lambda v: "refined near the limit",
    "SmallTargets": lambda v: f"rays for small targets {'on' if v else 'off'}",
    "FullModel": lambda v: f"the full model {'on' if v else 'off'}",
}


def off_default(name):
    """{property: the value that is not the default}, empty where the filter has no such switch."""
    return {name: not getattr(Filter(), "Get" + name)()} if trade_runs.usable({name: True}) else {}


def choices(quick=False):
    """All that is compared. Every family says what it is; all else is the filter's default."""
    rays = RAYS[::3] if quick else RAYS
    found = {}

    refine = trade_runs.usable({"RefineNearLimit": False})

    def add(family, numbers, **settings):
        for number in numbers:
            values = tuple({"RaysPerBeam": number, **refine, **settings}.items())
            found[values] = Choice(family, values)

    # As in the paper: every beam is sampled.
    plain = {"PlaneIntegration": False} if trade_runs.usable({"PlaneIntegration": False}) else {}
    add("Monte Carlo", rays, Sampling=Filter.SAMPLING_MONTE_CARLO, **plain)
    add("stratified", rays, **plain)
    add("integrated", rays)
    add("one reflection", rays, NumberOfReflections=1)
    for target in TARGETS[1::2] if quick else TARGETS:
        add(f"target {100 * target:g} %", (100,) if quick else (100, 400), TargetRelativeError=target)
    add("no connections", rays[::3] if quick else rays, NumberOfConnections=0)
    for target in () if quick else TARGETS:
        add(f"target {100 * target:g} %, one reflection", (400,), TargetRelativeError=target, NumberOfReflections=1)
        add(f"target {100 * target:g} %, no connections", (100, 400), TargetRelativeError=target, NumberOfConnections=0)
        if off_default("PlaneIntegration"):
            switch = off_default("PlaneIntegration")
            add(f"target {100 * target:g} %, {WORDS['PlaneIntegration'](switch['PlaneIntegration'])}", (100,),
                TargetRelativeError=target, **switch)
    for connections in () if quick else (8, 32):
        add(f"{connections} connections", FEW_RAYS, NumberOfConnections=connections)
    if refine:
        add("refined near the limit", rays, RefineNearLimit=True)
    for name in ("PlaneIntegration", "SmallTargets", "FullModel"):
        if off_default(name):
            add(WORDS[name](off_default(name)[name]), FEW_RAYS[1:2] if quick else FEW_RAYS, **off_default(name))
    for name, value in PRESETS.items():
        if hasattr(Filter, value):
            values = (("Preset", getattr(Filter, value)),)
            found[values] = Choice(name, values)
    return list(found.values())
