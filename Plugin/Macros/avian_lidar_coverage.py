# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: where a lidar at an airport would detect or miss a gull, and why.

The macro takes the selected surfaces or, with nothing selected, the airport that comes with the plugin. It makes a
sensor Search 905 at the position that the scene gives, or else beside the surfaces, and an Avian Lidar Coverage for a
herring gull in clear air around the sensor. The first view shows the airport, a surface within which a scan detects the
bird with a probability of at least 1/2, and a slice 30 m above the ground with the probability. The second view shows
the same slice with the status: seen, too weak, shadowed, in clutter, between beams, outside the band. A change of
Species, Meteorological Visibility or Reflectance of the coverage does not need new lines of sight. If the surfaces have
a collision tree, or if a part or a result of a scan is selected, the macro uses the existing tree. The macro hides
earlier scans. After an error there are no new objects, and Output Messages gives the reason.

In ParaView: select surfaces, or nothing, and click the button in the toolbar. In a script: cover(view, surfaces).
"""

import math

from paraview import simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    REASONS, colour_by, frame, free_name, ground_below, hide_scans, legend, lidar_place, neighbour, run, say_place,
    show, show_sensor, show_surfaces, start, surfaces_and_tree)

TITLE = "coverage"
STATUS = "avian_lidar_status_colours"
SPECIES = "herring gull"
# Extent of the region to either side of the lidar and above the ground, spacing of its points, height of the slice
# above the ground, m.
REACH, CEILING = 900.0, 75.0
SPACING = [12.0, 12.0, 7.5]
LEVEL = 30.0
STEP = 0.125  # of the region's bottom, m: heights of layers are then exact in binary, and the slice lies in a layer
LIMIT = 0.5  # probability on the surface
LEAST = 0.02  # least probability that is drawn; below, the view shows the airport
PROBABILITY = "detection_probability"
SURFACE_COLOUR, SURFACE_OPACITY = (1.0, 0.85, 0.85), 0.4
FONT_SIZE = 17
# Elevation of the camera, deg; its azimuth, rad, towards the terminal; width of a strip west of the region, for the
# legend, m.
CAMERA_ELEVATION = 40
EAST = 0.0
ROOM = 820.0


def region(place, ground):
    """Bounds of the region around the lidar, m. The slice lies at a layer of points, so status values are not
    interpolated. @param ground height of the ground, m"""
    x, y = place[:2]
    return [x - REACH, x + REACH, y - REACH, y + REACH, ground, ground + CEILING]


def second_view(view):
    """A view beside the given view, or the existing view of reasons, and the size of both views in pixels."""
    width, height = view.ViewSize
    other = simple.FindView(REASONS)
    if other not in (None, view):
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
    """Shows the legend, with letters of one size."""
    bar = legend(table, view, title)
    bar.TitleFontSize = bar.LabelFontSize = FONT_SIZE
    if horizontal:
        bar.Orientation, bar.WindowLocation, bar.ScalarBarLength = "Horizontal", "Lower Center", 0.5
        bar.LabelFormat = bar.RangeLabelFormat = "%.1f"
    else:
        bar.Orientation, bar.WindowLocation, bar.ScalarBarLength = "Vertical", "Lower Right Corner", 0.35
    display.SetScalarBarVisibility(view, True)


def show_probability(probable, surface, view):
    """Shows the slice by probability, and the translucent surface above it."""
    display = show(probable, view, Ambient=1.0, Diffuse=0.0)  # colours as in the legend
    table = colour_by(display, "POINTS", PROBABILITY, "Viridis (matplotlib)", (0.0, 1.0))
    title = f"probability of detection at {LEVEL:g} m; surface: {LIMIT:g}"
    show_legend(display, table, view, title, horizontal=True)
    # Only the upper side of the surface: a single translucent layer needs no order of drawing.
    show(surface, view, SURFACE_COLOUR, Opacity=SURFACE_OPACITY, BackfaceRepresentation="Cull Backface")


def show_reasons(status, level, view):
    """Shows the slice by status, with words in the legend."""
    display = status.colour(level, view)
    display.Ambient, display.Diffuse = 1.0, 0.0  # colours as in the legend
    table = simple.GetColorTransferFunction(status.ARRAY, display, separate=True)
    show_legend(display, table, view, f"a bird at {LEVEL:g} m", horizontal=False)


def cover(view=None, surfaces=None):
    """Makes the coverage of the surfaces, or of the airport. @return (sensor, coverage, slice, surface)"""
    status = neighbour(STATUS, globals().get("__file__"))
    view = start(view)
    scene, tree = surfaces_and_tree(surfaces)
    place = lidar_place(tree)
    ground = STEP * math.floor(ground_below(place, tree) / STEP)
    beams = simple.AvianLidarSearch905(registrationName=free_name("Search 905"), Position=place)
    simple.SetActiveSource(None)  # an active source would become the input Places
    coverage = simple.AvianLidarCoverage(registrationName=free_name("Coverage map"), Beams=beams, Surfaces=tree,
                                         Bounds=region(place, ground), Spacing=SPACING, Species=SPECIES)
    coverage.UpdatePipeline()
    level = simple.Slice(registrationName=free_name(f"Coverage at {LEVEL:g} m"), Input=coverage)
    level.SliceType.Origin = [*place[:2], ground + LEVEL]
    level.SliceType.Normal = [0.0, 0.0, 1.0]
    probable = simple.Threshold(registrationName=free_name("Probable"), Input=level, Scalars=["POINTS", PROBABILITY],
                                ThresholdMethod="Above Upper Threshold", UpperThreshold=LEAST)
    surface = simple.Contour(registrationName=free_name("Every other scan"), Input=coverage,
                             ContourBy=["POINTS", PROBABILITY], Isosurfaces=[LIMIT])
    other, pixels = second_view(view)
    hide_scans(view, other)
    for each in (view, other):
        simple.Hide(scene, each)
        show_surfaces(tree, each)
        show_sensor(beams, each)
    show_probability(probable, surface, view)
    show_reasons(status, level, other)
    west, *others = region(place, ground)
    for each in (view, other):
        frame(each, EAST, CAMERA_ELEVATION, (west - ROOM, *others), pixels=pixels)
    simple.SetActiveView(view)
    simple.SetActiveSource(coverage)
    say_place(TITLE, tree, beams)
    return beams, coverage, level, surface


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, cover, None, simple.GetActiveSource(), render=simple.RenderAllViews)
