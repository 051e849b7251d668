# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: scans the selected surfaces with the lidar Airport 16 and shows the echoes, coloured by energy.

With nothing selected it opens the airport that comes with the plugin. What it makes are pipeline objects as from the
menus: a collision tree, a sensor, an echo filter. The sensor stands where the scene says (field data `lidar_position`),
else south of the surfaces, off by a tenth of their width or depth, 3 m above their lowest point or, if they are lower
than 6 m, at half their height: move it from there. What an earlier scan shows is hidden. If something does not fit,
nothing is made and the reason is given in Output Messages.

In ParaView: the button is there with the plugin; select surfaces, or nothing, and click it. In a script:
scan(surfaces, view).
"""

import math

from avian_lidar_plugin import (
    ENERGY_COLOURS, POSITION, free_name, frame, hide_scans, lidar_place, name_of, neighbour, open_example, run, say, show,
    show_grey, show_sensor, start, tree_of)
from paraview import servermanager, simple

TITLE = "airport scan"
WIDE = 50e3  # m: surfaces that extend farther may be in millimetres
# Where the scene does not say where the lidar stands: metres above the lowest point; share of the width or depth.
HEIGHT = 3
DISTANCE = 0.1
ECHO_SIZE = 5  # pixels
# One looks over the sensor to the strongest echoes, from so many degrees above the horizon: from higher up, the rows of
# echoes on a wall cover one another. In sight are the echoes of at least this share of the strongest one's energy.
CAMERA_ELEVATION = 20
STRONG, STRONGEST = 0.25, 0.9


def place_beside(tree):
    """A place to start from: beside the surfaces, neither in them nor above."""
    west, east, south, north, bottom, top = tree.GetDataInformation().GetBounds()
    height = min(HEIGHT, (top - bottom) / 2) or HEIGHT
    return [(west + east) / 2, south - DISTANCE * max(east - west, north - south), bottom + height]


def bounds_of_strong(echoes, share):
    """Bounds of the echoes of at least this share of the strongest one's energy."""
    strongest = echoes.GetPointDataInformation().GetArray("energy").GetRange(0)[1]
    threshold = servermanager.filters.Threshold(
        Input=echoes, Scalars=["POINTS", "energy"], ThresholdMethod="Above Upper Threshold", UpperThreshold=share * strongest
    )
    threshold.UpdatePipeline()
    return threshold.GetDataInformation().GetBounds()


def centre_of(bounds):
    return [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]


def inside(point, bounds):
    return all(low < value < high for value, low, high in zip(point, bounds[::2], bounds[1::2]))


def look(view, beams, tree, echoes, seen, elevation):
    """The sensor with the strong echoes ahead; without echoes, with the surfaces, from the south."""
    sensor = [value for value in beams.Position for _ in range(2)]
    if not seen:
        frame(view, math.pi / 2, elevation, sensor, tree.GetDataInformation().GetBounds())
        return
    strongest = centre_of(bounds_of_strong(echoes, STRONGEST))
    azimuth = math.atan2(strongest[1] - beams.Position[1], strongest[0] - beams.Position[0])
    frame(view, azimuth, elevation, sensor, bounds_of_strong(echoes, STRONG))


def show_scan(surfaces, tree, beams, echoes, view, colour, elevation=CAMERA_ELEVATION):
    """Grey surfaces, the sensor as a large point, coloured echoes, all in sight."""
    simple.Hide(surfaces, view)
    show_grey(tree, view)
    # A ball on the ground is not cut by it as a square is; but the nearest ball of all vanishes from ParaView's picture.
    show_sensor(beams, view, int(inside(beams.Position, tree.GetDataInformation().GetBounds())))
    seen = echoes.GetDataInformation().GetNumberOfPoints() > 0
    if seen:
        colour(echoes, view)
    show(echoes, view, Representation="Points", PointSize=ECHO_SIZE)
    look(view, beams, tree, echoes, seen, elevation)


def scan(surfaces=None, view=None):
    """Scans the surfaces, or the example: returns (collision tree, sensor, echo filter)."""
    colour = neighbour(ENERGY_COLOURS, globals().get("__file__")).colour
    view = start(view)
    surfaces = surfaces or open_example()
    tree = tree_of(surfaces)
    known = lidar_place(tree)
    place = known or place_beside(tree)
    beams = simple.AvianLidarAirport16(registrationName=free_name("Airport 16", surfaces), Position=place)
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan", surfaces), Beams=beams, Surfaces=tree)
    echoes.UpdatePipeline()
    hide_scans(view)
    show_scan(surfaces, tree, beams, echoes, view, colour)
    simple.SetActiveSource(echoes)
    where = "({:g}, {:g}, {:g}) m".format(*place)
    move = f"select {name_of(beams)}, set Position or tick Show Point and drag the handle, Apply"
    if echoes.GetDataInformation().GetNumberOfPoints() == 0:
        bounds = surfaces.GetDataInformation().GetBounds()
        if max(bounds[1] - bounds[0], bounds[3] - bounds[2]) > WIDE:
            say(TITLE, f"no echoes: the surfaces are {bounds[1] - bounds[0]:g} m wide and {bounds[3] - bounds[2]:g} m deep. "
                "If they are in millimetres, apply Transform with the scale 0.001 to them, select it and click again")
        else:
            say(TITLE, f"no echoes: the sensor at {where} sees nothing. Move it: {move}; "
                "then select the echoes and click Colour by Energy")
    elif not known:
        say(TITLE, f"the surfaces have no {POSITION}: the sensor stands beside them, at {where}. To move it: {move}",
            failed=False)
    return tree, beams, echoes


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, scan, simple.GetActiveSource())
