# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: a scan of a scene with a sensor, birds and weather, as a dialog has asked for them.

In ParaView the button opens the dialog; pressing Finish at once gives birds over the airport that comes with the plugin, in
clear air. It makes a scene (unless the airport is in the pipeline), a collision tree, the sensor, birds (Avian Lidar Tracks and their
group), an echo filter with ten scans to play, and in ground fog a medium. If something does not fit, nothing is made and the
reason is given in Output Messages. In a script: make(scene, sensor, species, number, weather, view).
"""

import importlib.util
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
AIRPORT, BIRDS, FOG = "avian_lidar_airport_scan", "avian_lidar_birds_over_the_airport", "avian_lidar_ground_fog"
REVOLUTIONS = 10
BIRD_COLOUR = (0.9, 0.1, 0.5)
RADIUS, HEIGHTS = 250.0, [4.0, 20.0]  # m
# Properties of the echo filter; a medium is in the scene.
WEATHER = {
    "clear": {"MeteorologicalVisibility": 23000.0},
    "haze": {"MeteorologicalVisibility": 5000.0},
    "fog": {"MeteorologicalVisibility": 500.0, "AirBackscatter": 1},
    "rain": {"MeteorologicalVisibility": 23000.0, "RainRate": 10.0},
    "ground fog": {"MeteorologicalVisibility": 23000.0},
}
SCATTERS = ("fog", "rain", "ground fog")


def say(text):
    """A word in Output Messages, which ParaView opens by itself."""
    vtkOutputWindow.GetInstance().DisplayErrorText(f"Avian lidar wizard: {text}.\n")


def neighbour(name):
    """Another macro of the plugin, beside this file or, if this is a copy elsewhere, beside the plugin."""
    folders = [os.path.dirname(os.path.abspath(__file__))] if "__file__" in globals() else []
    plugins = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager().GetLocalInformation()
    for i in range(plugins.GetNumberOfPlugins()):
        if plugins.GetPluginName(i) == PLUGIN and plugins.GetPluginLoaded(i):
            folders.append(os.path.join(os.path.dirname(os.path.abspath(plugins.GetPluginFileName(i))), "Macros"))
    for folder in folders:
        path = os.path.join(folder, name + ".py")
        if os.path.exists(path):
            spec = importlib.util.spec_from_file_location(name, path)
            macro = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(macro)
            return macro
    raise ValueError(f"there is no {name}.py in {' nor in '.join(folders) or 'any folder: load the plugin'}")


def check(sensor, weather):
    """Nothing is made before all fits."""
    if weather not in WEATHER:
        raise ValueError(f"the weather is {weather!r}, expected one of {', '.join(WEATHER)}")
    prototype = servermanager.ProxyManager().GetPrototypeProxy("sources", sensor)
    if prototype is None or prototype.GetVTKClassName() != "vtkAvianLidarBeamSource":
        raise ValueError(f"the sensor is {sensor!r}, expected a sensor's source as AvianLidarSearch905")
    if weather in SCATTERS and not prototype.GetProperty("ReceiverAperture").GetElement(0) > 0:
        raise ValueError(f"{weather} sends light back and needs a sensor with a Receiver Aperture, as Search 905; "
                         f"{prototype.GetXMLLabel()} has none")


def open_scene(airport, birds, scene):
    """The scene, its collision tree."""
    if scene is None:
        return birds.scene_and_tree(airport)
    surfaces = simple.OpenDataFile(scene)
    if surfaces is None:
        raise ValueError(f"ParaView does not read {scene}, expected a scene (.lidarscene.json) or surfaces")
    name = os.path.basename(scene).split(".")[0] or "Scene"
    simple.RenameSource(airport.free_name(name), surfaces)
    return surfaces, airport.tree_of(surfaces)


def name_of(sensor):
    """What the menu calls it."""
    prototype = servermanager.ProxyManager().GetPrototypeProxy("sources", sensor)
    hint = prototype.GetHints().FindNestedElementByName("AvianLidarMenu")
    return hint.GetAttribute("text") if hint else prototype.GetXMLLabel().replace("Avian Lidar ", "")


def build(airport, birds, view, scene, sensor, species, number, weather):
    """The pipeline, and what the view shows of it."""
    colour = airport.colouring().colour
    surfaces, tree = open_scene(airport, birds, scene)
    place = airport.lidar_place(tree) or airport.place_beside(tree)
    beams = getattr(simple, "".join(one for one in servermanager.ProxyManager().GetPrototypeProxy("sources", sensor).GetXMLLabel()
                                    if one.isalnum() or one == "_"))(
        registrationName=airport.free_name(name_of(sensor)), Position=place, NumberOfRevolutions=REVOLUTIONS)
    beams.UpdatePipelineInformation()
    solid, fog = tree, None
    if weather == "ground fog":
        macro = neighbour(FOG)
        simple.SetActiveSource(None)
        bottom = tree.GetDataInformation().GetBounds()[4]
        fog = simple.AvianLidarMedium(registrationName=airport.free_name("Ground fog"), Name="ground fog", Bottom=bottom,
                                      MeteorologicalVisibility=macro.VISIBILITY, Top=bottom + macro.TOP, Softness=macro.SOFTNESS)
        solid = simple.GroupDatasets(registrationName=airport.free_name("Scene in fog"), Input=[tree, fog])
    tracks, inputs = [], {}
    if number > 0:
        birds.BIRDS = {species.capitalize(): (BIRD_COLOUR, {"Pattern": "Crossings", "Species": species, "NumberOfBirds": number,
                                                           "Radius": RADIUS, "Heights": HEIGHTS})}
        tracks = birds.flights(airport, place, REVOLUTIONS / beams.RotationRate)
        for each in tracks if scene else ():
            each.Center = [*place[:2], place[2] - airport.HEIGHT]  # heights are above the lidar's foot
        inputs["Movers"] = simple.GroupDatasets(registrationName=airport.free_name("Birds"), Input=tracks)
    echoes = simple.AvianLidarEchoFilter(registrationName=airport.free_name("Scan"), Beams=beams, Surfaces=solid,
                                         NumberOfReflections=1, **inputs, **WEATHER[weather])
    animation = simple.GetAnimationScene()
    animation.UpdateAnimationUsingDataTimeSteps()
    animation.GoToFirst()
    echoes.UpdatePipeline(animation.TimeKeeper.Time)
    airport.hide_scans(view)
    airport.show(surfaces, tree, beams, echoes, view, colour)
    if number > 0:
        simple.Hide(inputs["Movers"], view)
        birds.show_birds(airport, tracks, echoes, view)
        x, y, z = place
        reach = (birds.WEST, birds.EAST, birds.SIDE) if scene is None else (RADIUS, RADIUS, RADIUS)
        about = (x - reach[0], x + reach[1], y - reach[2], y + reach[2], z - airport.HEIGHT, z + HEIGHTS[1])
        airport.frame(view, 0.0, about)
    if fog is not None:
        simple.Hide(solid, view)
        display = simple.Show(fog, view, "GeometryRepresentation")
        display.ColorArrayName = ["POINTS", ""]
        display.AmbientColor = display.DiffuseColor = macro.FOG_COLOUR
        display.Ambient, display.Diffuse, display.Opacity = 1.0, 0.0, macro.FOG_OPACITY
    simple.SetActiveSource(echoes)
    return beams, tracks, echoes


def make(scene=None, sensor="AvianLidarSearch905", species="herring gull", number=12, weather="clear", view=None):
    """A scan as asked for: returns (sensor, tracks, echo filter). After an error nothing is left of it."""
    airport, birds = neighbour(AIRPORT), neighbour(BIRDS)
    airport.CAMERA_ELEVATION = birds.CAMERA_ELEVATION
    airport.plugin_folder(on_server=True)
    check(sensor, weather)
    simple._DisableFirstRenderCameraReset()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    before = list(simple.GetSources().values())
    try:
        return build(airport, birds, view, scene, sensor, species, number, weather)
    except Exception:
        made = [source for source in simple.GetSources().values() if source not in before]
        for source in sorted(made, key=lambda one: -one.SMProxy.GetGlobalID()):  # consumers first
            simple.Delete(source)
        raise


def main():
    try:
        make(**globals().get("avian_lidar_answers", {}))
    except (ValueError, RuntimeError) as problem:
        say(problem)
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
