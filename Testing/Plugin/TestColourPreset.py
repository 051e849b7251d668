# SPDX-License-Identifier: BSD-3-Clause
"""The colour preset is Eq. 13 over the receiver's limits, and the macro puts it on the echoes and leaves it there; what
became of each beam has colours and words of its own, on the beam report and on its map."""

import colorsys
import os

from paraview import servermanager, simple

from plugin_testing import SOURCE_DIR, airport, colour_of, load_macro, load_plugin

MACROS = os.path.join(SOURCE_DIR, "Plugin", "Macros")
PRESET = "Avian lidar HSB"
LIMITS = (2e-6, 6.25e-5)
STATUS = ("echo", "no surface", "below the lower limit", "saturated", "outside the gate")


def assert_eq_13(table):
    """Hue 240 degrees at Qlow to 0 degrees at Qhigh, saturation and brightness 1."""
    function = table.GetClientSideObject()
    low, high = LIMITS
    # Exact, and as a table of 256 colours of 8 bits.
    for discretize, tolerance in ((0, 1e-9), (1, 1)):
        table.Discretize = discretize
        table.UpdateVTKObjects()
        for i in range(5):
            energy = low + (high - low) * i / 4
            hue, saturation, brightness = colorsys.rgb_to_hsv(*colour_of(function, energy))
            assert abs(360 * hue - 240 * (high - energy) / (high - low)) <= tolerance, (energy, hue)
            assert abs(saturation - 1) < 1e-9 and abs(brightness - 1) < 1e-9
    # Below and above: the nearer end.
    assert colour_of(function, 0) == [0, 0, 1] and colour_of(function, 1) == [1, 0, 0]


def test_plugin_brings_the_presets():
    """Once, though it is loaded twice."""
    presets = servermanager.vtkSMTransferFunctionPresets.GetInstance()
    names = [presets.GetPresetName(i) for i in range(presets.GetNumberOfPresets())]
    assert all(names.count(preset) == 1
               for preset in (PRESET, "Avian lidar status", "Avian lidar coverage status")), names


def test_macro():
    macro = load_macro(os.path.join(MACROS, "avian_lidar_energy_colours.py"))
    _, _, beams, echoes = airport(60)
    view = simple.CreateRenderView()
    assert macro.colour(echoes, view) == LIMITS
    display = simple.GetDisplayProperties(echoes, view)
    assert (list(display.ColorArrayName), display.Representation) == (["POINTS", "energy"], "Points")
    table = simple.GetColorTransferFunction("energy")
    assert_eq_13(table)
    assert table.NanOpacity == 0, "what has no echo is not drawn"
    # New data, other energies: the range stays. Other limits of the receiver: the macro follows them.
    beams.PulseEnergy, echoes.ReturnMode = 1e-4, "Last"
    simple.Render(view)
    assert (table.RGBPoints[0], table.RGBPoints[-4]) == LIMITS
    beams.UpperEnergyLimit = 5e-5
    assert macro.colour(echoes, view) == (2e-6, 5e-5) == (table.RGBPoints[0], table.RGBPoints[-4])
    # A range image: in a view of its own, stretched; it is in sight, and below it as much again as half its height.
    image = simple.AvianLidarRangeImage(Echoes=echoes, Beams=beams)
    assert macro.colour(image) == (2e-6, 5e-5)
    own = simple.GetActiveView()
    assert own != view and own.InteractionMode == "2D"
    assert simple.GetLayout(own).GetViewLocation(own) >= 0  # else no window shows it
    display = simple.GetDisplayProperties(image, own)
    assert (list(display.ColorArrayName), display.Representation) == (["POINTS", "energy"], "Slice")
    assert abs(display.Scale[1] - 354 / (4 * 5.625)) < 1e-9
    height, middle = 354 / 4, display.Scale[1] * 5.625 / 2
    above, below = (sign * (own.CameraFocalPoint[1] - middle) + own.CameraParallelScale for sign in (1, -1))
    assert above > height / 2 and below > height, (above, below, height)


def test_data_without_colours():
    """Nothing is shown or coloured."""
    _, _, _, echoes = airport(24)
    sphere, view = simple.Sphere(), simple.CreateRenderView()
    for name, word in (("avian_lidar_energy_colours", "energy"), ("avian_lidar_status_colours", "status")):
        for source, preset, words in ((sphere, None, word), (echoes, "no such", "no colour preset no such")):
            macro = load_macro(os.path.join(MACROS, name + ".py"))
            macro.PRESET = preset or macro.PRESET
            try:
                macro.colour(source, view)
            except ValueError as problem:
                assert words in str(problem), problem
            else:
                raise AssertionError(words)
    assert len(view.Representations) == 0, view.Representations


def test_status_macro():
    """Five values, five words, five colours: of a filter that has a report, of the report, and on a map."""
    macro = load_macro(os.path.join(MACROS, "avian_lidar_status_colours.py"))
    _, _, _, echoes = airport(60)
    view, report = simple.CreateRenderView(), simple.OutputPort(echoes, 1)
    image = simple.AvianLidarRangeImage(Echoes=echoes, Beams=report)
    for source in (echoes, report, image):
        display = macro.colour(source, None if source is image else view)
        assert list(display.ColorArrayName) == ["POINTS", "status"]
        table = simple.GetColorTransferFunction("status")
        assert list(table.Annotations) == [text for i, name in enumerate(STATUS) for text in (str(i), name)]
        colours = {tuple(table.IndexedColors[i : i + 3]) for i in range(0, 15, 3)}
        assert table.InterpretValuesAsCategories and len(colours) == 5
        assert source is image or (display.Representation == "Points" and display.Input.Port == 1)
    own = simple.GetActiveView()
    assert display.Representation == "Slice" and own != view
    macro.colour(image)
    assert simple.GetActiveView() == own  # where it is shown already


if __name__ == "__main__":
    load_plugin()
    # A second time: the preset is there once.
    load_plugin()
    test_plugin_brings_the_presets()
    test_macro()
    test_data_without_colours()
    test_status_macro()
