# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over the airport, tracked from scan to scan, to play.

It makes the scans of the macro "birds over the airport", an Avian Lidar Clutter Filter that learns what stands still, and an
Avian Lidar Tracker of what is left. It goes through all scans once: clutter is grey, other echoes are white, confirmed tracks
have colours of their own, thin lines are the ways that the birds fly. Play goes from scan to scan; the first five scans are
learned, and nothing is tracked in them. If something does not fit, nothing is made and the reason is given in Output Messages.

In ParaView: it is in the menu Macros with the plugin. In a script: track(view).
"""

from avian_lidar_plugin import free_name, neighbour, run, show, start
from paraview import simple

BIRDS = "avian_lidar_birds_over_the_airport"
REVOLUTIONS = 20
CLUTTER_COLOUR, POINT_COLOUR = (0.55, 0.55, 0.6), (1.0, 1.0, 1.0)
CLUTTER_SIZE, POINT_SIZE, TRACK_WIDTH, TRAIL_WIDTH = 3, 6, 4, 1  # pixels


def track(view=None):
    """Scans the airport with birds and tracks them: returns (ways of the birds, echo filter, clutter filter, tracker)."""
    birds = neighbour(BIRDS, globals().get("__file__"))
    view = start(view)
    ways, beams, echoes, of_birds = birds.scan(view, REVOLUTIONS, TRAIL_WIDTH)
    clutter = simple.AvianLidarClutterFilter(registrationName=free_name("Clutter filter"), Input=echoes)
    tracker = simple.AvianLidarTracker(registrationName=free_name("Tracker"), Input=clutter)
    confirmed = simple.Threshold(registrationName=free_name("Tracks"), Input=tracker, Scalars=["CELLS", "confirmed"],
                                 ThresholdMethod="Above Upper Threshold", UpperThreshold=1)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    for time in beams.TimestepValues:  # both remember what came before
        scene.AnimationTime = time
        tracker.UpdatePipeline(time)
    for points in (echoes, *of_birds):
        simple.Hide(points, view)
    for title, value, colour, size in (("Clutter", 1, CLUTTER_COLOUR, CLUTTER_SIZE),
                                       ("What is left", 0, POINT_COLOUR, POINT_SIZE)):
        points = simple.Threshold(registrationName=free_name(title), Input=clutter, Scalars=["POINTS", "is_clutter"],
                                  LowerThreshold=value - 0.5, UpperThreshold=value + 0.5)
        show(points, view, colour, Representation="Points", PointSize=size)
    display = show(confirmed, view, Representation="Wireframe", LineWidth=TRACK_WIDTH)
    simple.ColorBy(display, ("CELLS", "track_id"))
    colours = simple.GetColorTransferFunction("track_id")
    colours.ApplyPreset("Rainbow Uniform", True)
    display.RescaleTransferFunctionToDataRange()
    simple.SetActiveSource(tracker)
    return ways, echoes, clutter, tracker


if __name__ in ("__main__", "__vtkconsole__"):
    run("birds tracked", track)
