# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: birds over the airport that comes with the plugin, scanned ten times by a lidar that turns, to play.

Gulls and crows cross the airport, a flock of starlings passes. Each is an Avian Lidar Tracks, whose movers, as one
group, are the third input of the echo filter; the lidar is a Search 905 where the scene says. Echoes are coloured by energy,
those of birds by kind, and large; lines are the ways that the birds fly. Play goes from scan to scan. An airport that is in
the pipeline is used, with its collision tree; what an earlier scan shows is hidden. If something does not fit, nothing is
made and the reason is given in Output Messages.

In ParaView: the button is there with the plugin; click it. In a script: scan(view).
"""

import importlib.util
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
AIRPORT = "avian_lidar_airport_scan"
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


def say(text):
    """A word in Output Messages, which ParaView opens by itself."""
    vtkOutputWindow.GetInstance().DisplayErrorText(f"Avian lidar birds over the airport: {text}.\n")


def macro_folders():
    """Where the other macros may be: beside this file or, if this is a copy elsewhere, beside the plugin."""
    folders = []
    if "__file__" in globals():
        folders.append(os.path.dirname(os.path.abspath(__file__)))
    plugins = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager().GetLocalInformation()
    for i in range(plugins.GetNumberOfPlugins()):
        if plugins.GetPluginName(i) == PLUGIN and plugins.GetPluginLoaded(i):
            folders.append(os.path.join(os.path.dirname(os.path.abspath(plugins.GetPluginFileName(i))), "Macros"))
    return folders


def airport_macro():
    """The macro that scans the airport."""
    for folder in macro_folders():
        path = os.path.join(folder, AIRPORT + ".py")
        if os.path.exists(path):
            spec = importlib.util.spec_from_file_location(AIRPORT, path)
            macro = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(macro)
            macro.CAMERA_ELEVATION = CAMERA_ELEVATION
            return macro
    raise ValueError(f"there is no {AIRPORT}.py in {' nor in '.join(macro_folders()) or 'any folder: load the plugin'}")


def of_kind(name):
    return [source for source in simple.GetSources().values() if source.SMProxy.GetXMLName() == name]


def scene_and_tree(airport):
    """The airport and its collision tree, those of the pipeline if they are there."""
    file_name = os.path.basename(airport.EXAMPLE)
    for tree in of_kind("AvianLidarCollisionTree"):
        scene = tree.Input
        if scene and scene.SMProxy.GetXMLName() == "AvianLidarSceneReader" and os.path.basename(scene.FileName) == file_name:
            tree.UpdatePipeline()
            return scene, tree
    known = (scene for scene in of_kind("AvianLidarSceneReader") if os.path.basename(scene.FileName) == file_name)
    scene = next(known, None) or airport.open_example()
    return scene, airport.tree_of(scene)


def flights(airport, position, seconds):
    """A source of tracks for each kind of birds."""
    found = []
    for number, (name, (_, properties)) in enumerate(BIRDS.items()):
        simple.SetActiveSource(None)  # else it becomes the input Lines
        tracks = simple.AvianLidarTracks(registrationName=airport.free_name(name), Center=[*position[:2], 0.0],
                                         TimeRange=[0.0, seconds], FirstObjectId=FIRST + IDS * number, **properties)
        tracks.UpdatePipeline()
        found.append(tracks)
    return found


def show_birds(airport, tracks, echoes, view):
    """Ways as thin lines, echoes of each kind as large points of the same colour; returns these echoes."""
    found = []
    for number, (source, (name, (colour, _))) in enumerate(zip(tracks, BIRDS.items())):
        simple.Hide(source, view)
        display = simple.Show(simple.OutputPort(source, 1), view, "GeometryRepresentation")
        display.ColorArrayName = ["POINTS", ""]
        display.AmbientColor = display.DiffuseColor = colour
        display.LineWidth = TRAIL_WIDTH
        display.Opacity = 0.6
        points = simple.Threshold(registrationName=airport.free_name(f"Echoes of {name.lower()}"), Input=echoes,
                                  Scalars=["POINTS", "object_id"], ThresholdMethod="Between",
                                  LowerThreshold=FIRST + IDS * number, UpperThreshold=FIRST + IDS * (number + 1) - 1)
        display = simple.Show(points, view, "UnstructuredGridRepresentation")
        display.Representation = "Points"
        display.ColorArrayName = ["POINTS", ""]
        display.AmbientColor = display.DiffuseColor = colour
        # Not as spheres: software rendering leaves out most of them. Squares lie over the point coloured by energy.
        display.PointSize = BIRD_SIZE
        found.append(points)
    return found


def show(airport, scene, tree, beams, echoes, view):
    """Grey surfaces, the sensor as a large point, echoes by energy."""
    simple.Hide(scene, view)
    airport.show_grey(tree, view)
    display = simple.Show(beams, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = airport.SENSOR_SIZE
    display.RenderPointsAsSpheres = 1
    airport.colouring().colour(echoes, view)
    display = simple.Show(echoes, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = CLUTTER_SIZE


def scan(view=None):
    """Scans the airport with birds: returns (tracks, sensor, echo filter, echoes of each kind of birds)."""
    airport = airport_macro()
    airport.plugin_folder(on_server=True)
    simple._DisableFirstRenderCameraReset()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    scene, tree = scene_and_tree(airport)
    position = airport.lidar_place(tree)
    beams = simple.AvianLidarSearch905(registrationName=airport.free_name("Search 905"), Position=position,
                                       NumberOfRevolutions=REVOLUTIONS)
    beams.UpdatePipelineInformation()
    tracks = flights(airport, position, REVOLUTIONS / beams.RotationRate)
    movers = simple.GroupDatasets(registrationName=airport.free_name("Birds"), Input=tracks)
    echoes = simple.AvianLidarEchoFilter(registrationName=airport.free_name("Scan with birds"), Beams=beams, Surfaces=tree,
                                         Movers=movers, AttenuationCoefficient=AIR, NumberOfReflections=1)
    animation = simple.GetAnimationScene()
    animation.UpdateAnimationUsingDataTimeSteps()
    animation.GoToFirst()
    echoes.UpdatePipeline(animation.TimeKeeper.Time)
    airport.hide_scans(view)
    show(airport, scene, tree, beams, echoes, view)
    simple.Hide(movers, view)
    birds = show_birds(airport, tracks, echoes, view)
    x, y = position[:2]
    airport.frame(view, 0.0, (x - WEST, x + EAST, y - SIDE, y + SIDE, 0.0, 20.0))
    simple.SetActiveSource(echoes)
    return tracks, beams, echoes, birds


def main():
    try:
        scan()
    except ValueError as problem:
        say(problem)
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
