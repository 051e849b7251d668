# SPDX-License-Identifier: BSD-3-Clause
"""Presets of the echo filter: they override at execution, write no property, and what was used can be run again."""

import re

from avianlidar import vtkAvianLidar as al
from echotools import Messages, arrays, assert_same_bits, scan, town

OVERRIDDEN = ("RaysPerBeam", "Sampling", "TargetRelativeError", "NumberOfReflections", "NumberOfConnections",
              "RefineNearLimit")
# Values that no preset has, and one that no preset may touch.
# PlaneIntegration, which no preset has either, is off: presets differ in rays, and integrated beams have none.
OWN = {"RaysPerBeam": 11, "Sampling": 0, "TargetRelativeError": 0.77, "NumberOfReflections": 1,
       "NumberOfConnections": 3, "RefineNearLimit": True, "Seed": 5, "AttenuationCoefficient": 1e-4, "ReturnMode": 1,
       "PlaneIntegration": False}
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
    assert used[preset] != OWN and echo.GetOutput().GetNumberOfPoints() > 20

    # What field data say makes the same file again: as a custom setting, and with the preset named.
    for name in (preset, "Custom"):
        again = scan(surfaces, **used[preset])
        getattr(again, "SetPresetTo" + name)()
        again.Update()
        assert_same_bits(echo.GetOutput(), again.GetOutput())
        for name in ("points", "status"):  # the rest of the report is costs
            one, other = (arrays(run.GetOutput(1))[name] for run in (echo, again))
            assert one.tobytes() == other.tobytes(), name

# The three are different, each finer than the one before.
assert used["Draft"]["RaysPerBeam"] <= used["Standard"]["RaysPerBeam"] < used["Reference"]["RaysPerBeam"]
assert used["Draft"]["NumberOfReflections"] <= used["Standard"]["NumberOfReflections"] == 2
assert used["Reference"]["TargetRelativeError"] == 0
rays = [traced[preset] for preset in ("Draft", "Standard", "Reference")]
assert rays == sorted(rays) and rays[2] > 20 * rays[1], rays

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
