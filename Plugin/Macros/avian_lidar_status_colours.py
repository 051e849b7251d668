# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours a beam report, range image or coverage by status, with words in the legend.

Beams are coloured by status: echo, no surface, below the lower limit, saturated, outside the gate. Places of a coverage
are coloured by other status values: seen, or the reason why a bird is missed. A range image needs a beam report as
Beams. A slice of a coverage is also possible. If the active output has no array `status` but another output of the
filter has, such as the Beam Report, the macro colours the other output. Without an array `status`, or without the
preset, the macro changes nothing and Output Messages gives the reason.

In ParaView: select the output, and click the button in the toolbar. In a script: colour(source, view).
"""

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import ENERGY_COLOURS, legend, neighbour, output_with, run

PRESET = "Avian lidar status"
COVERAGE_PRESET = "Avian lidar coverage status"
ARRAY = "status"
# Array that only a coverage has.
OF_COVERAGE = "track_probability"


def of_coverage(source):
    return source.GetPointDataInformation().GetArray(OF_COVERAGE) is not None


def colour(source, view=None):
    """Colours an output by status. @return the display of the output"""
    if source is None:
        raise ValueError("select the beam report first")
    source = output_with(source, ARRAY)
    places = of_coverage(source)
    preset = COVERAGE_PRESET if places else PRESET
    if not servermanager.vtkSMTransferFunctionPresets.GetInstance().HasPreset(preset):
        file = f"{preset.title().replace(' ', '')}.json"
        raise ValueError(f"there is no colour preset {preset}: load the plugin, or import {file}")
    images = neighbour(ENERGY_COLOURS, globals().get("__file__"))
    image = images.is_image(source)
    if image and not places:
        display, view = images.show_image(source, view)
    else:
        view = view or simple.GetActiveViewOrCreate("RenderView")
        display = simple.Show(source, view)
    if places and image and display.Representation == "Outline":
        display.SetRepresentationType("Slice")
    # Status values of places have other meanings than status values of beams, so places have a separate table of
    # colours.
    simple.ColorBy(display, ("POINTS", ARRAY), separate=places)
    table = simple.GetColorTransferFunction(ARRAY, display, separate=places)
    table.AutomaticRescaleRangeMode = "Never"
    table.ApplyPreset(preset, False)
    table.InterpretValuesAsCategories = 1
    legend(table, view, ARRAY)
    display.SetScalarBarVisibility(view, True)
    return display


if __name__ in ("__main__", "__vtkconsole__"):
    run("colours", colour, simple.GetActiveSource())
