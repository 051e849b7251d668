# SPDX-License-Identifier: BSD-3-Clause
"""Presets of the echo filter: they override at execution, write no property, and what was used can be run again."""

import math
import re

from avianlidar import vtkAvianLidar as al
from echotools import RAYS, Messages, assert_same_bits, given, output, scan, town

OVERRIDDEN = ("RaysPerBeam", "Sampling", "NumberOfReflections", "NumberOfConnections")
EXPECTED = {"Draft": (25, 1, 3, 0), "Standard": (200, 1, 3, 2), "Reference": (3200, 1, 3, 8), "Preview": (100, 1, 1, 0),
            "Paper": (100, 0, 2, 2)}
# The paper: N rays (Sec. 2.1), batch detection (Sec. 3.2), both constraints, light compared with Qlow (Sec. 3.4), its
# reflectance
# (Eq. 8), a point for each range unit (Eq. 12).
METHOD = {"BeamSamples": 1, "BatchCollisionDetection": 2, "BeamConstraint": 1, "LightEnergyConstraint": 1,
          "LightEnergyThreshold": 1, "ReflectanceModel": 0, "ReturnMode": 4}
OTHERWISE = {"BeamSamples": 0, "BatchCollisionDetection": 0, "BeamConstraint": 0, "LightEnergyConstraint": 0,
             "LightEnergyThreshold": 0, "ReflectanceModel": 1, "ReturnMode": 1}
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
    own, method = ({**OWN, **OTHERWISE}, METHOD) if preset == "Paper" else (OWN, {})
    echo = scan(surfaces, **own)
    getattr(echo, "SetPresetTo" + preset)()
    assert echo.GetPreset() == getattr(FILTER, "PRESET_" + preset.upper())
    echo.Update()
    assert {name: getattr(echo, "Get" + name)() for name in own} == own  # no member was written
    assert field(echo, "Preset") == echo.GetPreset()
    rays.append(echo.GetNumberOfTracedRays())
    used[preset] = {name: field(echo, name) for name in own}
    assert used[preset] == {**own, **dict(zip(OVERRIDDEN, expected)), **method}, used[preset]
    assert echo.GetOutput().GetNumberOfPoints() > 20
    # What field data say makes the same file again as a custom setting.
    assert_same_bits(echo.GetOutput(), output(scan(surfaces, **used[preset])))
assert rays[1] > 5 * rays[0], rays


# A member that is bad on its own does no harm while a preset overrides it, and is named when none does.
echo = scan(surfaces, RaysPerBeam=0, Preset=FILTER.PRESET_DRAFT)
heard = Messages(echo)
echo.Update()
assert not heard.errors and echo.GetOutput().GetNumberOfPoints() > 20, heard.errors
echo.SetPresetToCustom()
echo.Update()
assert len(heard.errors) == 1 and "RaysPerBeam" in heard.errors[0], heard.errors

# The tree of the paper: a binary tree of single triangles (Algorithm 1), whose median splits make it as flat as can be.
default, paper = (given(al.vtkAvianLidarCollisionTree(), Preset=preset) for preset in (0, 1))
for tree in (default, paper):
    tree.SetInputData(surfaces)
    tree.Update()
triangles = paper.GetOutput().GetNumberOfCells()
assert (paper.GetNumberOfLeaves(), paper.GetNumberOfNodes(), paper.GetDepth()) == (
    triangles, 2 * triangles - 1, math.ceil(math.log2(triangles)))
assert default.GetNumberOfLeaves() < triangles
assert_same_bits(*(output(scan(tree.GetOutput(), Preset=FILTER.PRESET_PAPER)) for tree in (default, paper)))
