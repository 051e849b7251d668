# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: the airport in ground fog, and what a lidar receives of it.

It makes a sensor Search 905 where the scene says, a medium (fog of 400 m visibility up to 5 m, fading above) and a scan of
both together, as Group Datasets gives them to an Avian Lidar Echo Filter. The fog is drawn translucent, the airport grey,
echoes by energy. Change Kind, Visibility or the shape of the medium, and Apply. An airport that is in the pipeline is used,
with its collision tree; what an earlier scan shows is hidden. If something does not fit, nothing is made and the reason is
given in Output Messages.

In ParaView: it is in the menu Macros with the plugin. In a script: cover(view).
"""

import importlib.util
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
AIRPORT = "avian_lidar_airport_scan"
BIRDS = "avian_lidar_birds_over_the_airport"
# m: visibility, height of the dense part, and over which it fades above.
VISIBILITY, TOP, SOFTNESS = 400.0, 5.0, 3.0
FOG_COLOUR, FOG_OPACITY = (0.9, 0.95, 1.0), 0.45


def say(text):
    """A word in Output Messages, which ParaView opens by itself."""
    vtkOutputWindow.GetInstance().DisplayErrorText(f"Avian lidar ground fog: {text}.\n")


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


def cover(view=None):
    """The airport in ground fog: returns (sensor, medium, group, scan)."""
    airport, birds = neighbour(AIRPORT), neighbour(BIRDS)
    airport.plugin_folder(on_server=True)
    colour = airport.colouring().colour
    simple._DisableFirstRenderCameraReset()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    scene, tree = birds.scene_and_tree(airport)
    beams = simple.AvianLidarSearch905(registrationName=airport.free_name("Search 905"), Position=airport.lidar_place(tree))
    simple.SetActiveSource(None)
    fog = simple.AvianLidarMedium(registrationName=airport.free_name("Ground fog"), Name="ground fog",
                                  MeteorologicalVisibility=VISIBILITY, Bottom=0.0, Top=TOP, Softness=SOFTNESS)
    together = simple.GroupDatasets(registrationName=airport.free_name("Airport in fog"), Input=[tree, fog])
    echoes = simple.AvianLidarEchoFilter(registrationName=airport.free_name("Scan in fog"), Beams=beams, Surfaces=together)
    echoes.UpdatePipeline()
    airport.hide_scans(view)
    airport.show(scene, tree, beams, echoes, view, colour)
    display = simple.Show(fog, view, "GeometryRepresentation")
    display.ColorArrayName = ["POINTS", ""]
    display.AmbientColor = display.DiffuseColor = FOG_COLOUR
    display.Ambient, display.Diffuse = 1.0, 0.0
    display.Opacity = FOG_OPACITY
    simple.SetActiveSource(fog)
    return beams, fog, together, echoes


def main():
    try:
        cover()
    except ValueError as problem:
        say(problem)
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
