# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours the active echoes or range image by energy as in the paper, blue at Qlow and red at Qhigh.

A range image gets its own view, in which cells without an echo are transparent. The range of the colours is the dynamic
range of the receiver, from the field data of the echoes. The range is fixed, so that a colour always means the same
energy. The scale is logarithmic if the upper limit is more than 100 times the lower limit, as for photon receivers.
With a linear scale, all echoes of birds would then be blue. If the active output has no energies but another output of
the filter has, the macro colours the other output. If limits in the field data, the array `energy` or the preset are
missing, the macro changes nothing and Output Messages gives the reason. ParaView's window runs the macro at the first
Apply of an echo filter or a range image.

In ParaView: select the echoes, and click the button in the toolbar. In a script: colour(source, view).
"""

import math

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import colour_by, data, legend, output_with, run

PRESET = "Avian lidar HSB"
ARRAY = "energy"
DECADES = 100.0  # ratio of the limits above which the scale is logarithmic
LIMITS = ("lower_energy_limit", "upper_energy_limit")
# Width of a drawn range image divided by its height. With equal scales, an image of 360 by 6 degrees would have 60.
ASPECT = 4
MARGIN = 1.35  # factor of the width, for numbers and legend


def energy_limits(source):
    """(Qlow, Qhigh) in joules from the field data of the output."""
    field_data = source.GetFieldDataInformation()
    limits = []
    for name in LIMITS:
        array = field_data.GetArray(name)
        if array is None:
            raise ValueError(f"the field data have no {name}: are these echoes of an avian lidar?")
        limits.append(array.GetRange(0)[0])
    return tuple(limits)


def decades(low, high):
    """The powers of ten between the limits. The legend's own labels on a logarithmic scale overlap."""
    return [10.0 ** power for power in range(math.ceil(math.log10(low)), math.floor(math.log10(high)) + 1)]


def steps(low, high):
    """The limits, and round numbers between them that keep their distance."""
    step = next(size * 10.0 ** power for power in range(-30, 9) for size in (1, 2, 5)
                if (high - low) / (size * 10.0 ** power) <= 5)
    inside = [step * number for number in range(math.ceil(low / step), math.floor(high / step) + 1)]
    return [low, *(one for one in inside if one - low > step / 3 and high - one > step / 3), high]


def unit_of(most):
    """The unit in which an energy (J) is at least 1, else the smallest, and the number of these units in a joule."""
    units = [*data("look.json")["units_of_energy"].items()]
    return next(((unit, scale) for unit, scale in units if most * scale >= 1), units[-1])


def is_image(source):
    return source.GetDataInformation().GetDataSetTypeAsString() == "vtkImageData"


def titles(source, columns, rows):
    """Titles of the axes: degrees, or counts if the angles are not equally spaced."""
    found = []
    for name, ends, degrees, counts in (("column_azimuths", columns, "azimuth (deg)", "column"),
                                        ("row_elevations", rows, "elevation (deg)", "row")):
        array = source.GetFieldDataInformation().GetArray(name)
        same = array and all(abs(a - b) < 1e-3 for a, b in zip(array.GetRange(0), ends))
        found.append(degrees if same else counts)
    return found


def new_view(active):
    """A view below the active view, with a place in the layout: ParaView's window shows only views with a place."""
    view = simple.CreateView("RenderView")
    layout = simple.GetLayout(active) if active else None
    simple.AssignViewToLayout(view, layout, layout.SplitViewVertical(active) if layout else 0)
    return view


def show_image(source, view=None):
    """Shows an image from above in its own view, or in the active view if that view shows the image. The axes are in
    degrees."""
    active = simple.GetActiveView()
    if view is None and active is not None and servermanager.GetRepresentation(source, active) is not None:
        view = active
    view = view or new_view(active)
    display = simple.Show(source, view)
    display.SetRepresentationType("Slice")
    west, east, down, up = source.GetDataInformation().GetBounds()[:4]
    if up > down:
        display.Scale = [1, (east - west) / (ASPECT * (up - down)), 1]
    grid = view.AxesGrid
    grid.Visibility = 1
    grid.XTitle, grid.YTitle = titles(source, (west, east), (down, up))
    grid.ZTitle = ""
    grid.DataScale = display.Scale
    view.InteractionMode = "2D"
    view.CameraParallelProjection = 1
    view.OrientationAxesVisibility = 0
    simple.ResetCamera(view)  # for the grid; in the window, the reset does not include the scale yet
    # Room for the legend below the image.
    width, middle = east - west, display.Scale[1] * (down + up) / 2 - 0.2 * (east - west) / ASPECT
    view.CameraFocalPoint = [(west + east) / 2, middle, 0]
    view.CameraPosition = [(west + east) / 2, middle, width]
    view.CameraViewUp = [0, 1, 0]
    view.CameraParallelScale = MARGIN * width * max(1.6 / ASPECT, view.ViewSize[1] / view.ViewSize[0]) / 2
    return display, view


def colour(source, view=None):
    """Colours an output by energy with the preset over the receiver's limits. @return (Qlow, Qhigh), J"""
    if source is None:
        raise ValueError("select the echoes first")
    source = output_with(source, ARRAY)
    low, high = energy_limits(source)
    if not servermanager.vtkSMTransferFunctionPresets.GetInstance().HasPreset(PRESET):
        raise ValueError(f"there is no colour preset {PRESET}: load the plugin, or import AvianLidarHSB.json")
    if is_image(source):
        display, view = show_image(source, view)
    else:
        view = view or simple.GetActiveViewOrCreate("RenderView")
        display = simple.Show(source, view)
    logarithmic = 0 < low * DECADES < high
    table = colour_by(display, "POINTS", ARRAY, PRESET, (low, high), logarithmic)
    simple.GetOpacityTransferFunction(ARRAY).RescaleTransferFunction(low, high)
    table.NanOpacity = 0  # cells without an echo
    unit, scale = unit_of(high)
    bar = legend(table, view, f"energy ({unit})")
    # Texts stand in for the legend's own numbers, which are in joules.
    bar.DrawTickLabels = bar.AddRangeLabels = 0
    bar.DrawAnnotations = 1
    table.AnnotationsInitialized = 1
    table.Annotations = [text for value in (decades(low, high) if logarithmic else steps(low, high))
                         for text in (repr(value), f"{value * scale:.3g}")]
    if is_image(source):
        bar.Orientation, bar.WindowLocation = "Horizontal", "Lower Center"
    display.SetScalarBarVisibility(view, True)
    return low, high


if __name__ in ("__main__", "__vtkconsole__"):
    run("colours", colour, simple.GetActiveSource())
