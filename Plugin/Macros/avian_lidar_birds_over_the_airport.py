# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over the airport that comes with the plugin, in ten scans of a rotating lidar to play.

Gulls and crows cross the airport, and a flock of starlings passes. Each kind is a source Avian Lidar Tracks. A group of
all movers is the third input of the echo filter. The lidar is a Search 905 at the position that the scene gives. Echoes
of surfaces are coloured by energy. Echoes of birds are large points, coloured by kind. Lines show the paths of the
birds. Play goes from scan to scan. If the pipeline contains the airport and its collision tree, the macro uses them.
The macro hides earlier scans. After an error there are no new objects, and Output Messages gives the reason.

In ParaView: click the button in the toolbar. In a script: scan(view).
"""

from paraview import simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    ENERGY_COLOURS, airport_and_tree, frame, free_name, hide_scans, lidar_place, neighbour, run, show, show_grey,
    show_sensor, start, update_first_step)

REVOLUTIONS = 10
AIR = 8.9e-5  # attenuation of haze, 1/m
# Object id of the first bird, and number of ids of a kind of birds.
FIRST, IDS = 10000, 1000
BIRDS = {
    "Gulls": ((0.9, 0.1, 0.5), {"Pattern": "Crossings", "Species": "herring gull", "NumberOfBirds": 12, "Radius": 250.0,
                                "Heights": [4.0, 20.0]}),
    "Crows": ((1.0, 0.6, 0.1), {"Pattern": "Crossings", "Species": "crow", "NumberOfBirds": 8, "Radius": 200.0,
                                "Heights": [5.0, 15.0], "Seed": 2}),
    "Starlings": ((0.2, 0.9, 0.4), {"Pattern": "Flock", "Species": "starling", "NumberOfBirds": 30, "Radius": 180.0,
                                    "Heights": [8.0, 14.0], "Seed": 1}),
}
BIRD_SIZE, CLUTTER_SIZE, TRAIL_WIDTH = 9, 4, 1.5  # sizes of points and width of lines, pixels
# Region of the view: metres west, east, and to either side of the lidar (the terminal is in the east). Elevation of the
# camera, deg.
WEST, EAST, SIDE = 260.0, 480.0, 330.0
CAMERA_ELEVATION = 40


def flights(kinds, position, seconds):
    """A source of tracks for each kind of birds."""
    found = []
    for number, (name, (_, properties)) in enumerate(kinds.items()):
        simple.SetActiveSource(None)  # an active source would become the input Lines
        tracks = simple.AvianLidarTracks(registrationName=free_name(name), Center=[*position[:2], 0.0],
                                         TimeRange=[0.0, seconds], FirstObjectId=FIRST + IDS * number, **properties)
        tracks.UpdatePipeline()
        found.append(tracks)
    return found


def show_birds(kinds, tracks, echoes, view, trail_width=TRAIL_WIDTH):
    """Shows paths as thin lines, and echoes of each kind as large points of the same colour. @return these echoes"""
    found = []
    for number, (source, (name, (colour, _))) in enumerate(zip(tracks, kinds.items())):
        simple.Hide(source, view)
        show(simple.OutputPort(source, 1), view, colour, LineWidth=trail_width, Opacity=0.6)
        points = simple.Threshold(registrationName=free_name(f"Echoes of {name.lower()}"), Input=echoes,
                                  Scalars=["POINTS", "object_id"], ThresholdMethod="Between",
                                  LowerThreshold=FIRST + IDS * number, UpperThreshold=FIRST + IDS * (number + 1) - 1)
        # Not spheres, because software rendering leaves out most spheres. Squares hide the points coloured by energy.
        show(points, view, colour, Representation="Points", PointSize=BIRD_SIZE)
        found.append(points)
    return found


def scan(view=None, revolutions=REVOLUTIONS, trail_width=TRAIL_WIDTH):
    """Scans the airport with birds. @return (tracks, sensor, echo filter, echoes of each kind of birds)"""
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
