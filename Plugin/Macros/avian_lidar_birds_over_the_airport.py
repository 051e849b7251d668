# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over the airport that comes with the plugin, scanned ten times by a lidar that turns, to play.

Gulls and crows cross the airport, a flock of starlings passes. Each is an Avian Lidar Tracks, whose movers, as one
group, are the third input of the echo filter; the lidar is a Search 905 where the scene says. Echoes are coloured by energy,
those of birds by kind, and large; lines are the ways that the birds fly. Play goes from scan to scan. An airport that is in
the pipeline is used, with its collision tree; what an earlier scan shows is hidden. If something does not fit, nothing is
made and the reason is given in Output Messages.

In ParaView: the button is there with the plugin; click it. In a script: scan(view).
"""

from avian_lidar_plugin import (
    ENERGY_COLOURS, airport_and_tree, frame, free_name, hide_scans, lidar_place, neighbour, run, show, show_grey,
    show_sensor, start, update_first_step)
from paraview import simple

REVOLUTIONS = 10
AIR = 8.9e-5  # 1/m, haze
# Object ids: of the first bird, and how many a kind of birds may have.
FIRST, IDS = 10000, 1000
BIRDS = {
    "Gulls": ((0.9, 0.1, 0.5), {"Pattern": "Crossings", "Species": "herring gull", "NumberOfBirds": 12, "Radius": 250.0,
                                "Heights": [4.0, 20.0]}),
    "Crows": ((1.0, 0.6, 0.1), {"Pattern": "Crossings", "Species": "crow", "NumberOfBirds": 8, "Radius": 200.0,
                                "Heights": [5.0, 15.0], "Seed": 2}),
    "Starlings": ((0.2, 0.9, 0.4), {"Pattern": "Flock", "Species": "starling", "NumberOfBirds": 30, "Radius": 180.0,
                                    "Heights": [8.0, 14.0], "Seed": 1}),
}
BIRD_SIZE, CLUTTER_SIZE, TRAIL_WIDTH = 9, 4, 1.5  # pixels
# What the view shows: metres west, east, and to either side of the lidar (the terminal is in the east), from so many degrees
# above the horizon.
WEST, EAST, SIDE = 260.0, 480.0, 330.0
CAMERA_ELEVATION = 40


def flights(kinds, position, seconds):
    """A source of tracks for each kind of birds."""
    found = []
    for number, (name, (_, properties)) in enumerate(kinds.items()):
        simple.SetActiveSource(None)  # else it becomes the input Lines
        tracks = simple.AvianLidarTracks(registrationName=free_name(name), Center=[*position[:2], 0.0],
                                         TimeRange=[0.0, seconds], FirstObjectId=FIRST + IDS * number, **properties)
        tracks.UpdatePipeline()
        found.append(tracks)
    return found


def show_birds(kinds, tracks, echoes, view, trail_width=TRAIL_WIDTH):
    """Ways as thin lines, echoes of each kind as large points of the same colour; returns these echoes."""
    found = []
    for number, (source, (name, (colour, _))) in enumerate(zip(tracks, kinds.items())):
        simple.Hide(source, view)
        show(simple.OutputPort(source, 1), view, colour, LineWidth=trail_width, Opacity=0.6)
        points = simple.Threshold(registrationName=free_name(f"Echoes of {name.lower()}"), Input=echoes,
                                  Scalars=["POINTS", "object_id"], ThresholdMethod="Between",
                                  LowerThreshold=FIRST + IDS * number, UpperThreshold=FIRST + IDS * (number + 1) - 1)
        # Not as spheres: software rendering leaves out most of them. Squares lie over the point coloured by energy.
        show(points, view, colour, Representation="Points", PointSize=BIRD_SIZE)
        found.append(points)
    return found


def scan(view=None, revolutions=REVOLUTIONS, trail_width=TRAIL_WIDTH):
    """Scans the airport with birds: returns (tracks, sensor, echo filter, echoes of each kind of birds)."""
    colour = neighbour(ENERGY_COLOURS, globals().get("__file__")).colour
    view = start(view)
    scene, tree = airport_and_tree()
    position = lidar_place(tree)
    beams = simple.AvianLidarSearch905(registrationName=free_name("Search 905"), Position=position,
                                       NumberOfRevolutions=revolutions)
    beams.UpdatePipelineInformation()
    tracks = flights(BIRDS, position, revolutions / beams.RotationRate)
    movers = simple.GroupDatasets(registrationName=free_name("Birds"), Input=tracks)
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan with birds"), Beams=beams, Surfaces=tree,
                                         Movers=movers, AttenuationCoefficient=AIR, NumberOfReflections=1)
    update_first_step(echoes)
    hide_scans(view)
    simple.Hide(scene, view)
    show_grey(tree, view)
    show_sensor(beams, view)
    colour(echoes, view)
    show(echoes, view, Representation="Points", PointSize=CLUTTER_SIZE)
    simple.Hide(movers, view)
    birds = show_birds(BIRDS, tracks, echoes, view, trail_width)
    x, y = position[:2]
    frame(view, 0.0, CAMERA_ELEVATION, (x - WEST, x + EAST, y - SIDE, y + SIDE, 0.0, 20.0))
    simple.SetActiveSource(echoes)
    return tracks, beams, echoes, birds


if __name__ in ("__main__", "__vtkconsole__"):
    run("birds over the airport", scan)
