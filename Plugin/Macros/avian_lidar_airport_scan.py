# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: scans the selected surfaces with the lidar Airport 16 and shows the echoes, coloured by energy.

With nothing selected, the macro opens the airport that comes with the plugin. With a part or a result of a scan
selected, it scans the surfaces of that scan again. The macro makes a collision tree (unless the surfaces have one), a
sensor and an echo filter, as the menus do. The sensor stands at the position that the scene gives (field data
`lidar_position`). Without this position, the sensor stands south of the surfaces, at a distance of a tenth of their
width or depth. Its height is then 3 m above their lowest point, or half their height if they are lower than 6 m. The
macro hides earlier scans. After an error there are no new objects, and Output Messages gives the reason.

In ParaView: select surfaces, or nothing, and click the button in the toolbar. In a script: scan(surfaces, view).
"""

import math

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    ENERGY_COLOURS, frame, free_name, hide_scans, how_to_move, lidar_place, neighbour, run, say, say_place, show,
    show_landmarks, show_sensor, show_surfaces, start, surfaces_and_tree)

TITLE = "airport scan"
WIDE = 50e3  # m, extent from which on surfaces may be in millimetres
ECHO_SIZE = 5  # size of an echo's point, pixels
# Elevation of the camera, deg. From higher up, the rows of echoes on a wall hide each other. The view contains the
# echoes with at least the share STRONG of the largest energy, and looks at the echoes with at least the share
# STRONGEST.
CAMERA_ELEVATION = 20
STRONG, STRONGEST = 0.25, 0.9


def bounds_of_strong(echoes, share):
    """Bounds of the echoes with at least this share of the largest energy."""
    strongest = echoes.GetPointDataInformation().GetArray("energy").GetRange(0)[1]
    threshold = servermanager.filters.Threshold(
        Input=echoes, Scalars=["POINTS", "energy"], ThresholdMethod="Above Upper Threshold",
        UpperThreshold=share * strongest)
    threshold.UpdatePipeline()
    return threshold.GetDataInformation().GetBounds()


def centre_of(bounds):
    return [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]


def inside(point, bounds):
    return all(low < value < high for value, low, high in zip(point, bounds[::2], bounds[1::2]))


def look(view, beams, tree, echoes, seen, elevation):
    """Points the camera over the sensor at the strong echoes or, without echoes, from the south at the surfaces."""
    sensor = [value for value in beams.Position for _ in range(2)]
    if not seen:
        frame(view, math.pi / 2, elevation, sensor, tree.GetDataInformation().GetBounds())
        return
    strongest = centre_of(bounds_of_strong(echoes, STRONGEST))
    azimuth = math.atan2(strongest[1] - beams.Position[1], strongest[0] - beams.Position[0])
    frame(view, azimuth, elevation, sensor, bounds_of_strong(echoes, STRONG))


def show_scan(surfaces, tree, beams, echoes, view, colour, elevation=CAMERA_ELEVATION):
    """Shows the surfaces, the sensor as a large point, and coloured echoes."""
    simple.Hide(surfaces, view)
    show_surfaces(tree, view)
    # The ground cuts a square, but not a ball. ParaView does not draw a ball that is nearer than all other objects.
    show_sensor(beams, view, int(inside(beams.Position, tree.GetDataInformation().GetBounds())))
    seen = echoes.GetDataInformation().GetNumberOfPoints() > 0
    if seen:
        colour(echoes, view)
    show(echoes, view, Representation="Points", PointSize=ECHO_SIZE)
    look(view, beams, tree, echoes, seen, elevation)
    show_landmarks(tree, beams, view)


def scan(surfaces=None, view=None):
    """Scans the surfaces, or the airport. @return (collision tree, sensor, echo filter)"""
    colour = neighbour(ENERGY_COLOURS, globals().get("__file__")).colour
    view = start(view)
    surfaces, tree = surfaces_and_tree(surfaces)
    beams = simple.AvianLidarAirport16(registrationName=free_name("Airport 16", surfaces), Position=lidar_place(tree))
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan", surfaces), Beams=beams, Surfaces=tree)
    echoes.UpdatePipeline()
    hide_scans(view)
    show_scan(surfaces, tree, beams, echoes, view, colour)
    simple.SetActiveSource(echoes)
    if echoes.GetDataInformation().GetNumberOfPoints() == 0:
        bounds = surfaces.GetDataInformation().GetBounds()
        if max(bounds[1] - bounds[0], bounds[3] - bounds[2]) > WIDE:
            say(TITLE, f"no echoes: the surfaces are {bounds[1] - bounds[0]:g} m wide and {bounds[3] - bounds[2]:g} m "
                "deep. If the unit is the millimetre, apply Transform with the scale 0.001, select the result and "
                "click again")
        else:
            where = "({:g}, {:g}, {:g}) m".format(*beams.Position)
            say(TITLE, f"no echoes: the sensor at {where} sees nothing. To move the sensor, {how_to_move(beams)}. "
                "Then select the echoes and click Colour by Energy")
    else:
        say_place(TITLE, tree, beams)
    return tree, beams, echoes


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, scan, simple.GetActiveSource())
