# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: scans the selected surfaces with the lidar Airport 16 and shows the echoes, coloured by energy.

With nothing selected it opens the airport that comes with the plugin. What it makes are pipeline objects as from the
menus: a collision tree, a sensor, an echo filter. The sensor stands where the scene says (field data `lidar_position`),
else 3 m above the lowest point, in the middle of the southern side: drag it from there. If something does not fit,
nothing is made and the reason is printed.

In ParaView: the button is there with the plugin; select surfaces, or nothing, and click it. In a script:
scan(surfaces, view).
"""

import importlib.util
import itertools
import math
import os

from paraview import servermanager, simple

PLUGIN = "AvianLidarPlugin"
EXAMPLE = os.path.join("Scenes", "hongqiao.lidarscene.json")
COLOURS = "avian_lidar_energy_colours"
POSITION = "lidar_position"
# Metres above the lowest point where the scene does not say where the lidar stands.
HEIGHT = 3
ADVICE = "select surfaces, or nothing for the airport that comes with the plugin"
ECHO_SIZE, SENSOR_SIZE = 5, 12  # pixels
# Diffuse reflectances that are drawn black and white: concrete is then a middle grey, and echoes stand out.
GREY_RANGE = (-0.05, 0.6)
# One looks from the south and so many degrees above the horizon.
CAMERA_ELEVATION = 35
MARGIN = 1.1


def plugin_folder(on_server=False):
    """The folder of the loaded plugin; where a file is read by a remote server, as that server names it."""
    manager = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager()
    remote = on_server and servermanager.ActiveConnection.IsRemote()
    plugins = manager.GetLocalInformation()
    if remote:
        plugins = manager.GetRemoteInformation(servermanager.ActiveConnection.Session)
    for i in range(plugins.GetNumberOfPlugins()):
        if plugins.GetPluginName(i) == PLUGIN and plugins.GetPluginLoaded(i):
            file_name = plugins.GetPluginFileName(i)
            return os.path.dirname(file_name if remote else os.path.abspath(file_name))
    where = "on the server, too" if remote else "first"
    raise ValueError(f"load the plugin {where} (Tools > Manage Plugins)")


def colouring():
    """The macro that colours echoes: the neighbour of this file or, if this is a copy elsewhere, the plugin's."""
    folders = [os.path.join(plugin_folder(), "Macros")]
    if "__file__" in globals():
        folders.insert(0, os.path.dirname(os.path.abspath(__file__)))
    for folder in folders:
        path = os.path.join(folder, COLOURS + ".py")
        if os.path.exists(path):
            spec = importlib.util.spec_from_file_location(COLOURS, path)
            macro = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(macro)
            return macro
    raise ValueError(f"there is no {COLOURS}.py in {' nor in '.join(folders)}")


def free_name(name):
    """The name; with a number, if it is taken in the pipeline."""
    taken = {key[0] for key in simple.GetSources()}
    names = itertools.chain([name], (f"{name} {i}" for i in itertools.count(2)))
    return next(candidate for candidate in names if candidate not in taken)


def open_example():
    """The airport that comes with the plugin."""
    path = os.path.join(plugin_folder(on_server=True), EXAMPLE)
    return simple.AvianLidarSceneReader(registrationName=free_name("Airport Hongqiao"), FileName=path)


def tree_of(surfaces):
    """The surfaces with a collision tree."""
    if surfaces.SMProxy.GetXMLName() == "AvianLidarCollisionTree":
        return surfaces
    name = surfaces.SMProxy.GetXMLLabel()
    surfaces.UpdatePipeline()
    data = surfaces.GetDataInformation().DataInformation
    if not data.DataSetTypeIsA("vtkPolyData"):
        raise ValueError(f"{name} gives no surfaces: {ADVICE}")
    tree = simple.AvianLidarCollisionTree(registrationName=free_name("Collision tree"), Input=surfaces)
    tree.UpdatePipeline()
    if tree.GetDataInformation().GetNumberOfCells() == 0:
        simple.Delete(tree)
        raise ValueError(f"{name} gives no surfaces: {ADVICE}")
    return tree


def lidar_place(tree):
    """Where the sensor stands: as the scene says, else a place to start from."""
    position = tree.GetFieldDataInformation().GetArray(POSITION)
    if position is not None:
        return [position.GetRange(i)[0] for i in range(3)]
    west, east, south, _, bottom, _ = tree.GetDataInformation().GetBounds()
    print(f"Avian lidar airport scan: the surfaces have no {POSITION}: the sensor stands south of them; drag it from there.")
    return [(west + east) / 2, south, bottom + HEIGHT]


def show_grey(tree, view):
    """The surfaces in shades of grey: the lighter, the more they reflect."""
    display = simple.Show(tree, view, "GeometryRepresentation")
    display.Representation = "Surface"
    simple.ColorBy(display, ("CELLS", "kd"))
    grey = simple.GetColorTransferFunction("kd")
    grey.AutomaticRescaleRangeMode = "Never"
    grey.ApplyPreset("Grayscale", True)
    grey.RescaleTransferFunction(*GREY_RANGE)
    display.SetScalarBarVisibility(view, False)


def frame(view, *sources):
    """Looks at the sources from the south and above; without perspective, whose depth buffer cannot tell an apron from
    the grass 2 cm below it."""
    bounds = [source.GetDataInformation().GetBounds() for source in sources]
    low, high = ([choose(values) for values in zip(*(b[start::2] for b in bounds))]
                 for choose, start in ((min, 0), (max, 1)))
    centre = [(a + b) / 2 for a, b in zip(low, high)]
    width, depth, height = (b - a for a, b in zip(low, high))
    angle = math.radians(CAMERA_ELEVATION)
    far = 10 * max(width, depth, height)
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = centre
    view.CameraPosition = [centre[0], centre[1] - far * math.cos(angle), centre[2] + far * math.sin(angle)]
    view.CameraViewUp = [0, 0, 1]
    across, up = view.ViewSize
    visible = max(width * up / across, depth * math.sin(angle) + height * math.cos(angle))
    view.CameraParallelScale = MARGIN * visible / 2


def show(surfaces, tree, beams, echoes, view, colour):
    """Grey surfaces, the sensor as a large point, coloured echoes, all in sight."""
    simple.Hide(surfaces, view)
    show_grey(tree, view)
    display = simple.Show(beams, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = SENSOR_SIZE
    seen = echoes.GetDataInformation().GetNumberOfPoints() > 0
    if seen:
        colour(echoes, view)
    else:
        print(f"Avian lidar airport scan: no echo reaches the lower limit. Move the sensor, then click {COLOURS}.")
    display = simple.Show(echoes, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = ECHO_SIZE
    frame(view, beams, echoes if seen else tree)


def scan(surfaces=None, view=None):
    """Scans the surfaces, or the example: returns (collision tree, sensor, echo filter)."""
    plugin_folder(on_server=True)
    colour = colouring().colour
    # As in every script that ParaView writes: the camera stays where it is put.
    simple._DisableFirstRenderCameraReset()
    surfaces = surfaces or open_example()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    tree = tree_of(surfaces)
    beams = simple.AvianLidarAirport16(registrationName=free_name("Airport 16"), Position=lidar_place(tree))
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Echoes"), Beams=beams, Surfaces=tree)
    echoes.UpdatePipeline()
    show(surfaces, tree, beams, echoes, view, colour)
    simple.SetActiveSource(echoes)
    return tree, beams, echoes


def main():
    try:
        scan(simple.GetActiveSource())
    except ValueError as problem:
        print(f"Avian lidar airport scan: {problem}.")
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
