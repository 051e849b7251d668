# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours a beam report, or a range image of one, by what became of each beam, with words as legend; a
coverage, or a slice of one, by why a bird is seen there or not.

Echo, no surface, below the lower limit, saturated, outside the gate: each has one colour. If the active output has no
array `status` but the filter's Beam Report has, that is coloured. Places of a coverage have words and colours of their
own. Without an array `status`, or without the preset, nothing is changed and the reason is printed.

In ParaView: the button is there with the plugin; select the output and click it. In a script: colour(source, view).
"""

from avian_lidar_plugin import ENERGY_COLOURS, neighbour, run, write
from paraview import servermanager, simple

PRESET = "Avian lidar status"
COVERAGE_PRESET = "Avian lidar coverage status"
ARRAY = "status"
# An array that only places of a coverage have.
OF_COVERAGE = "track_probability"
FILES = {PRESET: "AvianLidarStatus.json", COVERAGE_PRESET: "AvianLidarCoverageStatus.json"}


def with_status(source):
    """The output with the array: the one given, else the second of its filter."""
    ports = [source]
    if source.SMProxy.GetNumberOfOutputPorts() > 1:
        proxy = source.SMProxy
        ports.append(servermanager.OutputPort(servermanager._getPyProxy(proxy), 1))
    for port in ports:
        if port.GetPointDataInformation().GetArray(ARRAY) is not None:
            return port
    raise ValueError(f"there is no point array {ARRAY}: select a beam report, or a range image whose beams are one")


def of_coverage(source):
    return source.GetPointDataInformation().GetArray(OF_COVERAGE) is not None


def colour(source, view=None):
    """Colours an output by status; returns its display."""
    if source is None:
        raise ValueError("select the beam report first")
    source = with_status(source)
    places = of_coverage(source)
    preset = COVERAGE_PRESET if places else PRESET
    if not servermanager.vtkSMTransferFunctionPresets.GetInstance().HasPreset(preset):
        raise ValueError(f"there is no colour preset {preset}: load the plugin, or import {FILES.get(preset, 'it')}")
    images = neighbour(ENERGY_COLOURS, globals().get("__file__"))
    image = images.is_image(source)
    if image and not places:
        display, view = images.show_image(source, view)
    else:
        view = view or simple.GetActiveViewOrCreate("RenderView")
        display = simple.Show(source, view)
    if places and image and display.Representation == "Outline":
        display.SetRepresentationType("Slice")
    # Numbers of places mean other words than those of beams: a table of colours of their own.
    simple.ColorBy(display, ("POINTS", ARRAY), separate=places)
    table = simple.GetColorTransferFunction(ARRAY, display, separate=places)
    table.AutomaticRescaleRangeMode = "Never"
    table.ApplyPreset(preset, False)
    table.InterpretValuesAsCategories = 1
    images.legend(table, view, ARRAY)
    display.SetScalarBarVisibility(view, True)
    return display


if __name__ in ("__main__", "__vtkconsole__"):
    run("colours", colour, simple.GetActiveSource(), report=write)
