# SPDX-License-Identifier: BSD-3-Clause
"""Presets of the echo filter: they override at execution, write no property, and what was used can be run again."""

import re

from avianlidar import vtkAvianLidar as al
from echotools import RAYS, Messages, assert_same_bits, scan, town

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


surfaces, used, rays = town(), {}, []
assert FILTER().GetPreset() == FILTER.PRESET_CUSTOM == 0
for preset, expected in EXPECTED.items():
    echo = scan(surfaces, **OWN)
    getattr(echo, "SetPresetTo" + preset)()
    assert echo.GetPreset() == getattr(FILTER, "PRESET_" + preset.upper())
    echo.Update()
    assert {name: getattr(echo, "Get" + name)() for name in OWN} == OWN  # no member was written
    assert field(echo, "Preset") == echo.GetPreset()
    rays.append(echo.GetNumberOfTracedRays())
    used[preset] = {name: field(echo, name) for name in OWN}
    assert used[preset] == {**OWN, **dict(zip(OVERRIDDEN, expected))}, used[preset]
    assert echo.GetOutput().GetNumberOfPoints() > 20
    # What field data say makes the same file again as a custom setting.
    again = scan(surfaces, **used[preset])
    again.Update()
    assert_same_bits(echo.GetOutput(), again.GetOutput())
assert rays[1] > 5 * rays[0], rays


# A member that is bad on its own does no harm while a preset overrides it, and is named when none does.
echo = scan(surfaces, RaysPerBeam=0, Preset=FILTER.PRESET_DRAFT)
heard = Messages(echo)
echo.Update()
assert not heard.errors and echo.GetOutput().GetNumberOfPoints() > 20, heard.errors
echo.SetPresetToCustom()
echo.Update()
assert len(heard.errors) == 1 and "RaysPerBeam" in heard.errors[0], heard.errors
