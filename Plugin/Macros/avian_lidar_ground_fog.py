# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: an airport in ground fog, and the echoes of a lidar.

The macro takes the selected surfaces or, with nothing selected, the airport that comes with the plugin. It makes a
sensor Search 905 at the position that the scene gives, or else beside the surfaces, and a medium (fog of 400 m
visibility up to a height of 5 m, less dense above). Group Datasets combines airport and fog for an Avian Lidar Echo
Filter. The fog is translucent, and echoes are coloured by energy. You can then change Kind,
Meteorological Visibility or the shape of the medium. If the surfaces have a collision tree, or if a part or a result of
a scan is selected, the macro uses the existing tree. The macro hides earlier scans. After an error there are no new
objects, and Output Messages gives the reason.

In ParaView: choose the macro in the menu Macros. In a script: cover(view, surfaces).
"""

from paraview import simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    ENERGY_COLOURS, free_name, ground_below, hide_scans, lidar_place, neighbour, run, say_place, show, start,
    surfaces_and_tree)

TITLE = "ground fog"
AIRPORT = "avian_lidar_airport_scan"
# Visibility, height of the dense part, and height over which the density decreases to 1/e above, m.
VISIBILITY, TOP, SOFTNESS = 400.0, 5.0, 3.0
FOG_COLOUR, FOG_OPACITY = (0.9, 0.95, 1.0), 0.45


def fog_above(bottom):
    return simple.AvianLidarMedium(registrationName=free_name("Ground fog"), Name="ground fog", Bottom=bottom,
                                   MeteorologicalVisibility=VISIBILITY, Top=bottom + TOP, Softness=SOFTNESS)


def show_fog(fog, view):
    show(fog, view, FOG_COLOUR, Ambient=1.0, Diffuse=0.0, Opacity=FOG_OPACITY)


def cover(view=None, surfaces=None):
    """Scans the surfaces, or the airport, in ground fog. @return (sensor, medium, group, scan)"""
    airport, colours = (neighbour(name, globals().get("__file__")) for name in (AIRPORT, ENERGY_COLOURS))
    view = start(view)
    scene, tree = surfaces_and_tree(surfaces)
    place = lidar_place(tree)
    beams = simple.AvianLidarSearch905(registrationName=free_name("Search 905"), Position=place)
    simple.SetActiveSource(None)
    fog = fog_above(ground_below(place, tree))
    together = simple.GroupDatasets(registrationName=free_name("Airport in fog"), Input=[tree, fog])
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan in fog"), Beams=beams, Surfaces=together)
    echoes.UpdatePipeline()
    hide_scans(view)
    airport.show_scan(scene, tree, beams, echoes, view, colours.colour)
    show_fog(fog, view)
    simple.SetActiveSource(fog)
    say_place(TITLE, tree, beams)
    return beams, fog, together, echoes


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, cover, None, simple.GetActiveSource())
