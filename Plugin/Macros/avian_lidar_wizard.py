# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: a scan of a scene with a sensor, birds and weather, which the user chooses in a dialog.

In ParaView, Macros > Avian Lidar: Scan as You Choose... opens the dialog. The button Finish on the first page gives
birds over the airport that comes with the plugin, in clear air. The macro makes a scene (unless the pipeline contains
the airport), a collision tree, the sensor, birds (Avian Lidar Tracks in a group) and an echo filter with ten scans to
play. Ground fog also needs a medium. After an error there are no new objects, and Output Messages gives the reason. In
a script: make(scene, sensor, species, number, weather, view).
"""

import os

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    ENERGY_COLOURS, data, frame, free_name, ground_below, hide_scans, lidar_place, neighbour, plugin_folder, run, start,
    surfaces_and_tree, tree_of, update_first_step)

AIRPORT, BIRDS, FOG = "avian_lidar_airport_scan", "avian_lidar_birds_over_the_airport", "avian_lidar_ground_fog"
REVOLUTIONS = 10
RADIUS, HEIGHTS = 250.0, [4.0, 20.0]  # region of the birds, m


def check(sensor, weather):
    """Raises an error if sensor and weather do not fit, before any object is made. @return the echo filter's properties
    in this weather. For ground fog, the scene also has a medium."""
    weathers = {one["name"]: one for one in data("weathers.json")}
    if weather not in weathers:
        raise ValueError(f"the weather is {weather!r}, expected one of {', '.join(weathers)}")
    prototype = servermanager.ProxyManager().GetPrototypeProxy("sources", sensor)
    if prototype is None or prototype.GetVTKClassName() != "vtkAvianLidarBeamSource":
        raise ValueError(f"the sensor is {sensor!r}, expected the source of a sensor, such as AvianLidarSearch905")
    # Of a new proxy, because prototypes in ParaView's window have the values of the beam source.
    aperture = servermanager.ProxyManager().NewProxy("sources", sensor).GetProperty("ReceiverAperture").GetElement(0)
    if weathers[weather].get("sends_light_back") and not aperture > 0:
        raise ValueError(f"{weather} sends light back and needs a sensor with a Receiver Aperture, such as Search 905. "
                         f"{prototype.GetXMLLabel()} does not have a Receiver Aperture")
    return weathers[weather]["properties"]


def open_scene(scene):
    """The scene and its collision tree."""
    if scene is None:
        return surfaces_and_tree(None)
    surfaces = simple.OpenDataFile(scene)
    if surfaces is None:
        raise ValueError(f"ParaView does not read {scene}, expected a scene (.lidarscene.json) or surfaces")
    name = os.path.basename(scene).split(".")[0] or "Scene"
    simple.RenameSource(free_name(name), surfaces)
    return surfaces, tree_of(surfaces)


def name_of(sensor):
    """The name of a sensor in the menu."""
    prototype = servermanager.ProxyManager().GetPrototypeProxy("sources", sensor)
    hint = prototype.GetHints().FindNestedElementByName("AvianLidarMenu")
    return hint.GetAttribute("text") if hint else prototype.GetXMLLabel().replace("Avian Lidar ", "")


def build(macros, view, scene, sensor, species, number, weather, air):
    """Makes the pipeline, and shows it in the view."""
    airport, birds, fogs, colours = macros
    surfaces, tree = open_scene(scene)
    place = lidar_place(tree)
    beams = getattr(simple, sensor)(registrationName=free_name(name_of(sensor)), Position=place,
                                    NumberOfRevolutions=REVOLUTIONS)
    beams.UpdatePipelineInformation()
    x, y, ground = *place[:2], ground_below(place, tree)
    solid, fog = tree, None
    if weather == "ground fog":
        simple.SetActiveSource(None)
        fog = fogs.fog_above(ground)
        solid = simple.GroupDatasets(registrationName=free_name("Scene in fog"), Input=[tree, fog])
    tracks, inputs = [], {}
    if number > 0:
        flight = {"Pattern": "Crossings", "Species": species, "NumberOfBirds": number, "Radius": RADIUS,
                  "Heights": HEIGHTS}
        kinds = {species.capitalize(): flight}
        tracks = birds.flights(kinds, [x, y, ground], REVOLUTIONS / beams.RotationRate)
        inputs["Movers"] = simple.GroupDatasets(registrationName=free_name("Birds"), Input=tracks)
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan"), Beams=beams, Surfaces=solid,
                                         NumberOfReflections=1, **inputs, **air)
    update_first_step(echoes)
    hide_scans(view)
    airport.show_scan(surfaces, tree, beams, echoes, view, colours.colour, birds.CAMERA_ELEVATION)
    if number > 0:
        simple.Hide(inputs["Movers"], view)
        birds.show_birds(kinds, tracks, echoes, view)
        reach = (birds.WEST, birds.EAST, birds.SIDE) if scene is None else (RADIUS, RADIUS, RADIUS)
        about = (x - reach[0], x + reach[1], y - reach[2], y + reach[2], ground, ground + HEIGHTS[1])
        frame(view, 0.0, birds.CAMERA_ELEVATION, about)
    if fog is not None:
        simple.Hide(solid, view)
        fogs.show_fog(fog, view)
    simple.SetActiveSource(echoes)
    return beams, tracks, echoes


def make(scene=None, sensor="AvianLidarSearch905", species="herring gull", number=12, weather="clear", view=None):
    """Makes a scan. @return (sensor, tracks, echo filter). After an error there are no new objects."""
    macros = [neighbour(name, globals().get("__file__")) for name in (AIRPORT, BIRDS, FOG, ENERGY_COLOURS)]
    plugin_folder(on_server=True)
    air = check(sensor, weather)
    view = start(view)
    before = list(simple.GetSources().values())
    try:
        return build(macros, view, scene, sensor, species, number, weather, air)
    except Exception:
        made = [source for source in simple.GetSources().values() if source not in before]
        for source in sorted(made, key=lambda one: -one.SMProxy.GetGlobalID()):  # consumers first
            simple.Delete(source)
        raise


if __name__ in ("__main__", "__vtkconsole__"):
    run("wizard", lambda: make(**globals().get("avian_lidar_answers", {})))
