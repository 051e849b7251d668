# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over the airport, tracked from scan to scan, to play.

It makes the scans of the macro "birds over the airport", an Avian Lidar Clutter Filter that learns what stands still, and an
Avian Lidar Tracker of what is left. It goes through all scans once: clutter is grey, other echoes are white, confirmed tracks
have colours of their own, thin lines are the ways that the birds fly. Play goes from scan to scan; the first five scans are
learned, and nothing is tracked in them. If something does not fit, nothing is made and the reason is given in Output Messages.

In ParaView: it is in the menu Macros with the plugin. In a script: track(view).
"""

import importlib.util
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
BIRDS = "avian_lidar_birds_over_the_airport"
REVOLUTIONS = 20
CLUTTER_COLOUR, POINT_COLOUR = (0.55, 0.55, 0.6), (1.0, 1.0, 1.0)
CLUTTER_SIZE, POINT_SIZE, TRACK_WIDTH, TRAIL_WIDTH = 3, 6, 4, 1  # pixels


def say(text):
    """A word in Output Messages, which ParaView opens by itself."""
    vtkOutputWindow.GetInstance().DisplayErrorText(f"Avian lidar birds tracked: {text}.\n")


def neighbour(name):
    """Another macro of the plugin, beside this file or, if this is a copy elsewhere, beside the plugin."""
    folders = [os.path.dirname(os.path.abspath(__file__))] if "__file__" in globals() else []
    plugins = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager().GetLocalInformation()
    for i in range(plugins.GetNumberOfPlugins()):
        if plugins.GetPluginName(i) == PLUGIN and plugins.GetPluginLoaded(i):
            folders.append(os.path.join(os.path.dirname(os.path.abspath(plugins.GetPluginFileName(i))), "Macros"))
    for folder in folders:
        path = os.path.join(folder, name + ".py")
        if os.path.exists(path):
            spec = importlib.util.spec_from_file_location(name, path)
            macro = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(macro)
            return macro
    raise ValueError(f"there is no {name}.py in {' nor in '.join(folders) or 'any folder: load the plugin'}")


def show_points(points, view, colour, size):
    display = simple.Show(points, view)
    display.Representation = "Points"
    display.ColorArrayName = ["POINTS", ""]
    display.AmbientColor = display.DiffuseColor = colour
    display.PointSize = size


def track(view=None):
    """Scans the airport with birds and tracks them: returns (ways of the birds, echo filter, clutter filter, tracker)."""
    birds = neighbour(BIRDS)
    birds.REVOLUTIONS, birds.TRAIL_WIDTH = REVOLUTIONS, TRAIL_WIDTH
    view = view or simple.GetActiveViewOrCreate("RenderView")
    ways, beams, echoes, of_birds = birds.scan(view)
    name = birds.airport_macro().free_name
    clutter = simple.AvianLidarClutterFilter(registrationName=name("Clutter filter"), Input=echoes)
    tracker = simple.AvianLidarTracker(registrationName=name("Tracker"), Input=clutter)
    confirmed = simple.Threshold(registrationName=name("Tracks"), Input=tracker, Scalars=["CELLS", "confirmed"],
                                 ThresholdMethod="Above Upper Threshold", UpperThreshold=1)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    for time in beams.TimestepValues:  # both remember what came before
        scene.AnimationTime = time
        tracker.UpdatePipeline(time)
    for points in (echoes, *of_birds):
        simple.Hide(points, view)
    for title, value, colour, size in (("Clutter", 1, CLUTTER_COLOUR, CLUTTER_SIZE), ("What is left", 0, POINT_COLOUR, POINT_SIZE)):
        points = simple.Threshold(registrationName=name(title), Input=clutter, Scalars=["POINTS", "is_clutter"],
                                  LowerThreshold=value - 0.5, UpperThreshold=value + 0.5)
        show_points(points, view, colour, size)
    display = simple.Show(confirmed, view)
    display.Representation = "Wireframe"
    display.LineWidth = TRACK_WIDTH
    simple.ColorBy(display, ("CELLS", "track_id"))
    colours = simple.GetColorTransferFunction("track_id")
    colours.ApplyPreset("Rainbow Uniform", True)
    display.RescaleTransferFunctionToDataRange()
    simple.SetActiveSource(tracker)
    return ways, echoes, clutter, tracker


def main():
    try:
        track()
    except ValueError as problem:
        say(problem)
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
