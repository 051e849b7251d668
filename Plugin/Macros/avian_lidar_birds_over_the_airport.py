# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over an airport, in ten scans of a rotating lidar to play.

The macro takes the selected surfaces or, with nothing selected, the airport that comes with the plugin. Gulls and crows
cross the airport, and a flock of starlings passes. Each species is a source Avian Lidar Tracks. A group of all movers
is the third input of the echo filter. The lidar is a Search 905 at the position that the scene gives, or else beside
the surfaces. Echoes of surfaces are coloured by energy. Lines show the paths of the birds. Paths and echoes of birds
have the colour of the species, with a legend. Play goes from scan to scan. If the surfaces have a collision tree, or if
a part or a result of a scan is selected, the macro uses the existing tree. The macro hides earlier scans. After an
error there are no new objects, and Output Messages gives the reason.

In ParaView: select surfaces, or nothing, and click the button in the toolbar. In a script: scan(view, surfaces).
"""

from paraview import simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    ENERGY_COLOURS, SPECIES_COLOURS, frame, free_name, ground_below, hide_scans, lidar_place, neighbour, run, say_place,
    show, show_landmarks, show_sensor, show_surfaces, start, surfaces_and_tree, update_first_step)

TITLE = "birds over the airport"
REVOLUTIONS = 10
AIR = 8.9e-5  # attenuation of haze, 1/m
# Object id of the first bird, and number of ids of a source of tracks.
FIRST, IDS = 10000, 1000
BIRDS = {
    "Gulls": {"Pattern": "Crossings", "Species": "herring gull", "NumberOfBirds": 12, "Radius": 250.0,
              "Heights": [4.0, 20.0]},
    "Crows": {"Pattern": "Crossings", "Species": "crow", "NumberOfBirds": 8, "Radius": 200.0, "Heights": [5.0, 15.0],
              "Seed": 2},
    "Starlings": {"Pattern": "Flock", "Species": "starling", "NumberOfBirds": 30, "Radius": 180.0,
                  "Heights": [8.0, 14.0], "Seed": 1},
}
BIRD_SIZE, CLUTTER_SIZE, TRAIL_WIDTH = 9, 4, 1.5  # sizes of points and width of lines, pixels
# Region of the view: metres west, east, and to either side of the lidar (the terminal is in the east). Elevation of the
# camera, deg.
WEST, EAST, SIDE = 260.0, 480.0, 330.0
CAMERA_ELEVATION = 40


def flights(kinds, centre, seconds):
    """A source of tracks for each kind of birds. @param centre of their region on the ground, m"""
    found = []
    for number, (name, properties) in enumerate(kinds.items()):
        simple.SetActiveSource(None)  # an active source would become the input Lines
        tracks = simple.AvianLidarTracks(registrationName=free_name(name), Center=centre,
                                         TimeRange=[0.0, seconds], FirstObjectId=FIRST + IDS * number, **properties)
        tracks.UpdatePipeline()
        found.append(tracks)
    return found


def show_birds(kinds, tracks, echoes, view, trail_width=TRAIL_WIDTH):
    """Shows paths as thin lines, and echoes of each kind as large points, in the colour of their species with a legend.
    @return these echoes"""
    species, found = neighbour(SPECIES_COLOURS, globals().get("__file__")), []
    for number, (source, (name, properties)) in enumerate(zip(tracks, kinds.items())):
        simple.Hide(source, view)
        points = simple.Threshold(registrationName=free_name(f"Echoes of {name.lower()}"), Input=echoes,
                                  Scalars=["POINTS", "object_id"], ThresholdMethod="Between",
                                  LowerThreshold=FIRST + IDS * number, UpperThreshold=FIRST + IDS * (number + 1) - 1)
        # Not spheres, because software rendering leaves out most spheres. Squares hide the points coloured by energy.
        show(points, view, species.colour_of(source), Representation="Points", PointSize=BIRD_SIZE)
        found.append(points)
    species.colour(tracks, view, LineWidth=trail_width, Opacity=0.6)
    return found


def scan(view=None, surfaces=None, revolutions=REVOLUTIONS, trail_width=TRAIL_WIDTH):
    """Scans the surfaces, or the airport, with birds. @return (tracks, sensor, echo filter, echoes of each kind)"""
    colour = neighbour(ENERGY_COLOURS, globals().get("__file__")).colour
    view = start(view)
    scene, tree = surfaces_and_tree(surfaces)
    position = lidar_place(tree)
    beams = simple.AvianLidarSearch905(registrationName=free_name("Search 905"), Position=position,
                                       NumberOfRevolutions=revolutions)
    beams.UpdatePipelineInformation()
    x, y, ground = *position[:2], ground_below(position, tree)
    tracks = flights(BIRDS, [x, y, ground], revolutions / beams.RotationRate)
    movers = simple.GroupDatasets(registrationName=free_name("Birds"), Input=tracks)
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan with birds"), Beams=beams, Surfaces=tree,
                                         Movers=movers, AttenuationCoefficient=AIR, NumberOfReflections=1)
    update_first_step(echoes)
    hide_scans(view)
    simple.Hide(scene, view)
    show_surfaces(tree, view)
    show_sensor(beams, view)
    colour(echoes, view)
    show(echoes, view, Representation="Points", PointSize=CLUTTER_SIZE)
    simple.Hide(movers, view)
    simple.GetDisplayProperties(echoes, view).SetScalarBarVisibility(view, False)  # one legend at a time
    birds = show_birds(BIRDS, tracks, echoes, view, trail_width)
    frame(view, 0.0, CAMERA_ELEVATION, (x - WEST, x + EAST, y - SIDE, y + SIDE, ground, ground + 20.0))
    show_landmarks(tree, beams, view)
    simple.SetActiveSource(echoes)
    say_place(TITLE, tree, beams)
    return tracks, beams, echoes, birds


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, scan, None, simple.GetActiveSource())
