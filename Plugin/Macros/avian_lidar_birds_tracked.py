# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over an airport, tracked from scan to scan, to play.

The macro makes the scans of the macro "birds over the airport", an Avian Lidar Clutter Filter that learns clutter, and
an Avian Lidar Tracker of the other echoes. Clutter is grey, and other echoes are black. Confirmed tracks are thick
black lines. Thin lines show the paths of the birds, in the colours of their species. The macro executes all scans once.
Play goes from scan to scan. In the first five scans the filter learns, and all points are clutter. After an error there
are no new objects, and Output Messages gives the reason.

In ParaView: select surfaces, or nothing, and choose the macro in the menu Macros. In a script: track(view, surfaces).
"""

from paraview import simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import free_name, neighbour, run, show, start

BIRDS = "avian_lidar_birds_over_the_airport"
REVOLUTIONS = 20
CLUTTER_COLOUR, POINT_COLOUR = (0.55, 0.55, 0.6), (0.0, 0.0, 0.0)  # tracks are black, too
CLUTTER_SIZE, POINT_SIZE, TRACK_WIDTH, TRAIL_WIDTH = 3, 6, 4, 1  # sizes of points and widths of lines, pixels


def track(view=None, surfaces=None):
    """Scans the surfaces, or the airport, with birds and tracks the birds. @return (paths of the birds, echo filter,
    clutter filter, tracker)"""
    birds = neighbour(BIRDS, globals().get("__file__"))
    view = start(view)
    ways, beams, echoes, of_birds = birds.scan(view, surfaces, REVOLUTIONS, TRAIL_WIDTH)
    clutter = simple.AvianLidarClutterFilter(registrationName=free_name("Clutter filter"), Input=echoes)
    tracker = simple.AvianLidarTracker(registrationName=free_name("Tracker"), Input=clutter)
    confirmed = simple.Threshold(registrationName=free_name("Tracks"), Input=tracker, Scalars=["CELLS", "confirmed"],
                                 ThresholdMethod="Above Upper Threshold", UpperThreshold=1)
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    for time in beams.TimestepValues:  # in order, because clutter filter and tracker keep earlier scans
        scene.AnimationTime = time
        tracker.UpdatePipeline(time)
    for points in (echoes, *of_birds):
        simple.Hide(points, view)
    for title, value, colour, size in (("Clutter", 1, CLUTTER_COLOUR, CLUTTER_SIZE),
                                       ("What is left", 0, POINT_COLOUR, POINT_SIZE)):
        points = simple.Threshold(registrationName=free_name(title), Input=clutter, Scalars=["POINTS", "is_clutter"],
                                  LowerThreshold=value - 0.5, UpperThreshold=value + 0.5)
        show(points, view, colour, Representation="Points", PointSize=size)
    show(confirmed, view, POINT_COLOUR, Representation="Wireframe", LineWidth=TRACK_WIDTH)
    simple.SetActiveSource(tracker)
    return ways, echoes, clutter, tracker


if __name__ in ("__main__", "__vtkconsole__"):
    run("birds tracked", track, None, simple.GetActiveSource())
