# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: where a lidar at the airport would detect a gull, and why not elsewhere.

It makes a sensor Search 905 where the scene says and an Avian Lidar Coverage around it, of a herring gull in clear air.
The view shows the airport under a surface within which a scan detects the bird at least every other time, and a slice
30 m above the ground with the probability. A second view beside it shows the same slice with the reasons: seen, too weak,
shadowed, in clutter, between beams, outside the band. Change Species, Meteorological Visibility or Reflectance of the coverage: no line
of sight is traced again. An airport that is in the pipeline is used, with its collision tree; what an earlier scan shows
is hidden. If something does not fit, nothing is made and the reason is given in Output Messages.

In ParaView: the button is there with the plugin; click it. In a script: cover(view).
"""

from avian_lidar_plugin import (
    airport_and_tree, colour_by, frame, free_name, hide_scans, lidar_place, neighbour, run, show, show_grey, show_sensor,
    start)
from paraview import simple

STATUS = "avian_lidar_status_colours"
SPECIES = "herring gull"
# Metres: the region to either side of the lidar and above the ground, the distances of its points, the slice.
REACH, CEILING = 900.0, 75.0
SPACING = [12.0, 12.0, 7.5]
HEIGHT = 30.0
LIMIT = 0.5  # probability on the surface
LEAST = 0.02  # what is less probable is not drawn, and the airport is seen below
PROBABILITY = "detection_probability"
SURFACE_COLOUR, SURFACE_OPACITY = (1.0, 0.85, 0.85), 0.4
FONT_SIZE = 17
# One looks east, where the terminal is, from so many degrees above the horizon, with so many metres west of the region in
# sight, for the legend.
CAMERA_ELEVATION = 40
EAST = 0.0
ROOM = 820.0
REASONS = "Reasons"  # the second view


def region(place):
    """About the lidar; the slice lies at a row of its points, which are not mixed then."""
    x, y = place[:2]
    return [x - REACH, x + REACH, y - REACH, y + REACH, 0.0, CEILING]


def second_view(view):
    """A view beside it, or the one where an earlier coverage has shown its reasons; and the pixels of each."""
    width, height = view.ViewSize
    other = simple.FindView(REASONS)
    if other is not None:
        return other, (min(width, other.ViewSize[0]), max(height, other.ViewSize[1]))
    layout = simple.GetLayout(view)
    other = simple.CreateView("RenderView")
    simple.RenameView(REASONS, other)
    if layout is None:
        other.ViewSize = view.ViewSize
        return other, (width, height)
    cell = layout.SplitViewHorizontal(view)
    simple.AssignViewToLayout(other, layout, cell)
    return other, (width // 2, height)


def show_legend(display, table, view, title, horizontal):
    """Below the map, in letters of one size."""
    bar = simple.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleFontSize = bar.LabelFontSize = FONT_SIZE
    if horizontal:
        bar.Orientation, bar.WindowLocation, bar.ScalarBarLength = "Horizontal", "Lower Center", 0.5
        bar.AutomaticLabelFormat = 0
        bar.LabelFormat = bar.RangeLabelFormat = "%.1f"
    else:
        bar.Orientation, bar.WindowLocation, bar.ScalarBarLength = "Vertical", "Lower Right Corner", 0.35
    display.SetScalarBarVisibility(view, True)


def show_probability(probable, surface, view):
    """The slice, and the surface, through which it is seen."""
    display = show(probable, view, Ambient=1.0, Diffuse=0.0)  # colours as in the legend
    table = colour_by(display, "POINTS", PROBABILITY, "Viridis (matplotlib)", (0.0, 1.0))
    title = f"probability of detection at {HEIGHT:g} m; surface: {LIMIT:g}"
    show_legend(display, table, view, title, horizontal=True)
    # Its upper side alone: one layer needs no order of drawing.
    show(surface, view, SURFACE_COLOUR, Opacity=SURFACE_OPACITY, BackfaceRepresentation="Cull Backface")


def show_reasons(status, level, view):
    """The slice by status, which words explain."""
    display = status.colour(level, view)
    display.Ambient, display.Diffuse = 1.0, 0.0  # colours as in the legend
    table = simple.GetColorTransferFunction(status.ARRAY, display, separate=True)
    show_legend(display, table, view, f"a bird at {HEIGHT:g} m", horizontal=False)


def cover(view=None):
    """The coverage of the airport: returns (sensor, coverage, slice, surface)."""
    status = neighbour(STATUS, globals().get("__file__"))
    view = start(view)
    scene, tree = airport_and_tree()
    place = lidar_place(tree)
    beams = simple.AvianLidarSearch905(registrationName=free_name("Search 905"), Position=place)
    simple.SetActiveSource(None)  # else it becomes the input Places
    coverage = simple.AvianLidarCoverage(registrationName=free_name("Coverage map"), Beams=beams, Surfaces=tree,
                                         Bounds=region(place), Spacing=SPACING, Species=SPECIES)
    coverage.UpdatePipeline()
    level = simple.Slice(registrationName=free_name(f"Coverage at {HEIGHT:g} m"), Input=coverage)
    level.SliceType.Origin = [*place[:2], HEIGHT]
    level.SliceType.Normal = [0.0, 0.0, 1.0]
    probable = simple.Threshold(registrationName=free_name("Probable"), Input=level, Scalars=["POINTS", PROBABILITY],
                                ThresholdMethod="Above Upper Threshold", UpperThreshold=LEAST)
    surface = simple.Contour(registrationName=free_name("Every other scan"), Input=coverage,
                             ContourBy=["POINTS", PROBABILITY], Isosurfaces=[LIMIT])
    other, pixels = second_view(view)
    for each in (view, other):
        hide_scans(each)
        simple.Hide(scene, each)
        show_grey(tree, each)
        show_sensor(beams, each)
    show_probability(probable, surface, view)
    show_reasons(status, level, other)
    west, *others = region(place)
    for each in (view, other):
        frame(each, EAST, CAMERA_ELEVATION, (west - ROOM, *others), pixels=pixels)
    simple.SetActiveView(view)
    simple.SetActiveSource(coverage)
    return beams, coverage, level, surface


if __name__ in ("__main__", "__vtkconsole__"):
    run("coverage", cover, render=simple.RenderAllViews)
