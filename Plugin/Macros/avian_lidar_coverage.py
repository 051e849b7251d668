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

import importlib.util
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
AIRPORT = "avian_lidar_airport_scan"
BIRDS = "avian_lidar_birds_over_the_airport"
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


def say(text):
    """A word in Output Messages, which ParaView opens by itself."""
    vtkOutputWindow.GetInstance().DisplayErrorText(f"Avian lidar coverage: {text}.\n")


def macro_folders():
    """Where the other macros may be: beside this file or, if this is a copy elsewhere, beside the plugin."""
    folders = []
    if "__file__" in globals():
        folders.append(os.path.dirname(os.path.abspath(__file__)))
    plugins = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager().GetLocalInformation()
    for i in range(plugins.GetNumberOfPlugins()):
        if plugins.GetPluginName(i) == PLUGIN and plugins.GetPluginLoaded(i):
            folders.append(os.path.join(os.path.dirname(os.path.abspath(plugins.GetPluginFileName(i))), "Macros"))
    return folders


def neighbour(name):
    """Another macro of the plugin."""
    for folder in macro_folders():
        path = os.path.join(folder, name + ".py")
        if os.path.exists(path):
            spec = importlib.util.spec_from_file_location(name, path)
            macro = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(macro)
            return macro
    raise ValueError(f"there is no {name}.py in {' nor in '.join(macro_folders()) or 'any folder: load the plugin'}")


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


def show_airport(airport, tree, beams, view):
    """Grey surfaces, the sensor as a large point."""
    airport.show_grey(tree, view)
    display = simple.Show(beams, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = airport.SENSOR_SIZE
    display.RenderPointsAsSpheres = 1


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
    display = simple.Show(probable, view, "UnstructuredGridRepresentation")
    display.Ambient, display.Diffuse = 1.0, 0.0  # colours as in the legend
    simple.ColorBy(display, ("POINTS", PROBABILITY))
    table = simple.GetColorTransferFunction(PROBABILITY)
    table.AutomaticRescaleRangeMode = "Never"
    table.ApplyPreset("Viridis (matplotlib)", True)
    table.RescaleTransferFunction(0.0, 1.0)
    title = f"probability of detection at {HEIGHT:g} m; surface: {LIMIT:g}"
    show_legend(display, table, view, title, horizontal=True)
    display = simple.Show(surface, view, "GeometryRepresentation")
    display.ColorArrayName = ["POINTS", ""]
    display.AmbientColor = display.DiffuseColor = SURFACE_COLOUR
    display.Opacity = SURFACE_OPACITY
    # Its upper side alone: one layer needs no order of drawing.
    display.BackfaceRepresentation = "Cull Backface"


def show_reasons(status, level, view):
    """The slice by status, which words explain."""
    display = status.colour(level, view)
    display.Ambient, display.Diffuse = 1.0, 0.0  # colours as in the legend
    table = simple.GetColorTransferFunction(status.ARRAY, display, separate=True)
    show_legend(display, table, view, f"a bird at {HEIGHT:g} m", horizontal=False)


def cover(view=None):
    """The coverage of the airport: returns (sensor, coverage, slice, surface)."""
    airport = neighbour(AIRPORT)
    birds, status = neighbour(BIRDS), neighbour(STATUS)
    airport.CAMERA_ELEVATION = CAMERA_ELEVATION
    airport.plugin_folder(on_server=True)
    simple._DisableFirstRenderCameraReset()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    scene, tree = birds.scene_and_tree(airport)
    place = airport.lidar_place(tree)
    beams = simple.AvianLidarSearch905(registrationName=airport.free_name("Search 905"), Position=place)
    simple.SetActiveSource(None)  # else it becomes the input Places
    coverage = simple.AvianLidarCoverage(registrationName=airport.free_name("Coverage map"), Beams=beams, Surfaces=tree,
                                         Bounds=region(place), Spacing=SPACING, Species=SPECIES)
    coverage.UpdatePipeline()
    level = simple.Slice(registrationName=airport.free_name(f"Coverage at {HEIGHT:g} m"), Input=coverage)
    level.SliceType.Origin = [*place[:2], HEIGHT]
    level.SliceType.Normal = [0.0, 0.0, 1.0]
    probable = simple.Threshold(registrationName=airport.free_name("Probable"), Input=level, Scalars=["POINTS", PROBABILITY],
                                ThresholdMethod="Above Upper Threshold", UpperThreshold=LEAST)
    surface = simple.Contour(registrationName=airport.free_name("Every other scan"), Input=coverage,
                             ContourBy=["POINTS", PROBABILITY], Isosurfaces=[LIMIT])
    other, pixels = second_view(view)
    for each in (view, other):
        airport.hide_scans(each)
        simple.Hide(scene, each)
        show_airport(airport, tree, beams, each)
    show_probability(probable, surface, view)
    show_reasons(status, level, other)
    west, *others = region(place)
    for each in (view, other):
        airport.frame(each, EAST, (west - ROOM, *others), pixels=pixels)
    simple.SetActiveView(view)
    simple.SetActiveSource(coverage)
    return beams, coverage, level, surface


def main():
    try:
        cover()
    except ValueError as problem:
        say(problem)
        return
    simple.RenderAllViews()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
