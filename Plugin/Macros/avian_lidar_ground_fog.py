# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: the airport in ground fog, and what a lidar receives of it.

It makes a sensor Search 905 where the scene says, a medium (fog of 400 m visibility up to 5 m, fading above) and a scan of
both together, as Group Datasets gives them to an Avian Lidar Echo Filter. The fog is drawn translucent, the airport grey,
echoes by energy. Change Kind, Visibility or the shape of the medium, and Apply. An airport that is in the pipeline is used,
with its collision tree; what an earlier scan shows is hidden. If something does not fit, nothing is made and the reason is
given in Output Messages.

In ParaView: it is in the menu Macros with the plugin. In a script: cover(view).
"""

from avian_lidar_plugin import (
    ENERGY_COLOURS, airport_and_tree, free_name, hide_scans, lidar_place, neighbour, run, show, start)
from paraview import simple

AIRPORT = "avian_lidar_airport_scan"
# m: visibility, height of the dense part, and over which it fades above.
VISIBILITY, TOP, SOFTNESS = 400.0, 5.0, 3.0
FOG_COLOUR, FOG_OPACITY = (0.9, 0.95, 1.0), 0.45


def fog_above(bottom):
    return simple.AvianLidarMedium(registrationName=free_name("Ground fog"), Name="ground fog", Bottom=bottom,
                                   MeteorologicalVisibility=VISIBILITY, Top=bottom + TOP, Softness=SOFTNESS)


def show_fog(fog, view):
    show(fog, view, FOG_COLOUR, Ambient=1.0, Diffuse=0.0, Opacity=FOG_OPACITY)


def cover(view=None):
    """The airport in ground fog: returns (sensor, medium, group, scan)."""
    airport, colours = (neighbour(name, globals().get("__file__")) for name in (AIRPORT, ENERGY_COLOURS))
    view = start(view)
    scene, tree = airport_and_tree()
    beams = simple.AvianLidarSearch905(registrationName=free_name("Search 905"), Position=lidar_place(tree))
    simple.SetActiveSource(None)
    fog = fog_above(0.0)
    together = simple.GroupDatasets(registrationName=free_name("Airport in fog"), Input=[tree, fog])
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan in fog"), Beams=beams, Surfaces=together)
    echoes.UpdatePipeline()
    hide_scans(view)
    airport.show_scan(scene, tree, beams, echoes, view, colours.colour)
    show_fog(fog, view)
    simple.SetActiveSource(fog)
    return beams, fog, together, echoes


if __name__ in ("__main__", "__vtkconsole__"):
    run("ground fog", cover)
