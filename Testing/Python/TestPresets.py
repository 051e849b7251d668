# SPDX-License-Identifier: BSD-3-Clause
"""Presets of the echo filter: they override at execution, write no property, and what was used can be run again."""

import re

from avianlidar import vtkAvianLidar as al
from echotools import RAYS, Messages, arrays, assert_same_bits, scan, town

OVERRIDDEN = ("RaysPerBeam", "Sampling", "NumberOfReflections", "NumberOfConnections")
EXPECTED = {"Draft": (25, 1, 2, 0), "Standard": (200, 1, 2, 2), "Reference": (3200, 1, 2, 8)}
# Values that no preset has, and one that no preset may touch.
# BeamSamples, which no preset has either, is Rays: presets differ in rays, and integrated beams have none.
OWN = {"RaysPerBeam": 11, "Sampling": 0, "NumberOfReflections": 1, "NumberOfConnections": 3, "Seed": 5,
       "AttenuationCoefficient": 1e-4, "ReturnMode": 1, "BeamSamples": RAYS}
FILTER = al.vtkAvianLidarEchoFilter


def field(echo, name):
    """As the field data of the echoes say, by the name of the property."""
    snake = re.sub("(?<!^)(?=[A-Z])", "_", name).lower()
    values = {echo.GetOutput(port).GetFieldData().GetArray(snake).GetValue(0) for port in (0, 1)}
    assert len(values) == 1, (name, values)
    return values.pop()


def values(echo):
    return {name: getattr(echo, "Get" + name)() for name in OWN}


surfaces = town()
assert FILTER().GetPreset() == FILTER.PRESET_CUSTOM == 0

used, traced = {}, {}
for preset in ("Draft", "Standard", "Reference"):
    echo = scan(surfaces, **OWN)
    getattr(echo, "SetPresetTo" + preset)()
    assert echo.GetPreset() == getattr(FILTER, "PRESET_" + preset.upper())
    echo.Update()
    assert values(echo) == OWN, values(echo)  # no member was written
    assert field(echo, "Preset") == echo.GetPreset()
    traced[preset] = echo.GetNumberOfTracedRays()
    used[preset] = {name: field(echo, name) for name in OWN}
    assert all(used[preset][name] == OWN[name] for name in OWN if name not in OVERRIDDEN), used[preset]
    assert tuple(used[preset][name] for name in OVERRIDDEN) == EXPECTED[preset], used[preset]
    assert echo.GetOutput().GetNumberOfPoints() > 20

    # What field data say makes the same file again: as a custom setting, and with the preset named.
    for name in (preset, "Custom"):
        again = scan(surfaces, **used[preset])
        getattr(again, "SetPresetTo" + name)()
        again.Update()
        assert_same_bits(echo.GetOutput(), again.GetOutput())
        for name in ("points", "status"):  # the rest of the report is costs
            one, other = (arrays(run.GetOutput(1))[name] for run in (echo, again))
            assert one.tobytes() == other.tobytes(), name

# Each traces more than the one before.
rays = [traced[preset] for preset in ("Draft", "Standard", "Reference")]
assert rays[1] > 5 * rays[0] and rays[2] > 10 * rays[1], rays

# From preset to preset and back: each is the fresh run of its kind, and custom is what the members say.
echo = scan(surfaces, **OWN)
for preset in ("Draft", "Custom", "Standard", "Draft"):
    getattr(echo, "SetPresetTo" + preset)()
    echo.Update()
    fresh = scan(surfaces, **(used[preset] if preset != "Custom" else OWN))
    fresh.Update()
    assert_same_bits(echo.GetOutput(), fresh.GetOutput())
assert field(echo, "RaysPerBeam") == used["Draft"]["RaysPerBeam"]

# A member that is bad on its own does no harm while a preset overrides it, and is named when none does.
echo = scan(surfaces, RaysPerBeam=0, Preset=FILTER.PRESET_DRAFT)
heard = Messages(echo)
echo.Update()
assert not heard.errors and echo.GetOutput().GetNumberOfPoints() > 20, heard.errors
echo.SetPresetToCustom()
echo.Update()
assert len(heard.errors) == 1 and "RaysPerBeam" in heard.errors[0], heard.errors

assert "Preset: 1" in str(scan(surfaces, Preset=FILTER.PRESET_DRAFT))
