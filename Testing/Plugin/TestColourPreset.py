# SPDX-License-Identifier: BSD-3-Clause
"""The colour preset is Eq. 13 over the receiver's limits, and the macro puts it on the echoes and leaves it there."""

import colorsys
import importlib.util
import json
import os

from paraview import servermanager, simple

from plugin_testing import SOURCE_DIR, airport, load_plugin

PRESET = "Avian lidar HSB"
LIMITS = (2e-6, 6.25e-5)
FILE = os.path.join(SOURCE_DIR, "Plugin", "Presets", "AvianLidarHSB.json")


def load_macro():
    path = os.path.join(SOURCE_DIR, "Plugin", "Macros", "avian_lidar_energy_colours.py")
    spec = importlib.util.spec_from_file_location("macro", path)
    macro = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(macro)
    return macro


def colour_of(function, energy):
    rgb = [0, 0, 0]
    function.GetColor(energy, rgb)
    return rgb


def assert_eq_13(table):
    """Hue 240 degrees at Qlow to 0 degrees at Qhigh, saturation and brightness 1, at nine energies."""
    function = table.GetClientSideObject()
    low, high = LIMITS
    # Exact, and as a table of 256 colours of 8 bits.
    for discretize, tolerance in ((0, 1e-9), (1, 1)):
        table.Discretize = discretize
        table.UpdateVTKObjects()
        for i in range(9):
            energy = low + (high - low) * i / 8
            hue, saturation, brightness = colorsys.rgb_to_hsv(*colour_of(function, energy))
            assert abs(360 * hue - 240 * (high - energy) / (high - low)) <= tolerance, (energy, hue)
            assert abs(saturation - 1) < 1e-9 and abs(brightness - 1) < 1e-9
    # Below and above: the nearer end.
    assert colour_of(function, 0) == [0, 0, 1] and colour_of(function, 1) == [1, 0, 0]


def test_plugin_brings_the_preset():
    presets = servermanager.vtkSMTransferFunctionPresets.GetInstance()
    names = [presets.GetPresetName(i) for i in range(presets.GetNumberOfPresets())]
    assert names.count(PRESET) == 1
    with open(FILE, encoding="utf-8") as text:
        (shipped,) = json.load(text)
    assert shipped["Name"] == PRESET
    known = json.loads(presets.GetPresetAsString(names.index(PRESET)))
    assert known == shipped


def test_preset():
    table = simple.GetColorTransferFunction("anything")
    assert table.ApplyPreset(PRESET, True)
    table.RescaleTransferFunction(*LIMITS)
    assert_eq_13(table)


def test_macro():
    macro = load_macro()
    _, _, beams, echoes = airport(240)
    view = simple.CreateRenderView()
    assert macro.colour(echoes, view) == LIMITS
    display = simple.GetDisplayProperties(echoes, view)
    assert display.Representation == "Points"
    assert list(display.ColorArrayName) == ["POINTS", "energy"]
    table = simple.GetColorTransferFunction("energy")
    assert_eq_13(table)
    # New data, other energies: the range stays.
    beams.PulseEnergy = 1e-4
    echoes.ReturnMode = "Last"
    simple.Render(view)
    assert (table.RGBPoints[0], table.RGBPoints[-4]) == LIMITS
    # Other limits of the receiver: the macro follows them.
    beams.UpperEnergyLimit = 5e-5
    assert macro.colour(echoes, view) == (2e-6, 5e-5)
    assert (table.RGBPoints[0], table.RGBPoints[-4]) == (2e-6, 5e-5)


def test_macro_without_limits():
    macro = load_macro()
    try:
        macro.colour(simple.Sphere())
    except ValueError as problem:
        assert "energy" in str(problem)
    else:
        raise AssertionError("a sphere is no echo")


if __name__ == "__main__":
    load_plugin()
    # A second time: the preset is there once.
    load_plugin()
    test_plugin_brings_the_preset()
    test_preset()
    test_macro()
    test_macro_without_limits()
