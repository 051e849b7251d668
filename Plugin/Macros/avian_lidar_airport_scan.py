# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: scans the selected surfaces with the lidar Airport 16 and shows the echoes, coloured by energy.

With nothing selected it opens the airport that comes with the plugin. What it makes are pipeline objects as from the
menus: a collision tree, a sensor, an echo filter. The sensor stands where the scene says (field data `lidar_position`),
else south of the surfaces, off by a tenth of their width or depth, 3 m above their lowest point or, if they are lower
than 6 m, at half their height: move it from there. What an earlier scan shows is hidden. If something does not fit,
nothing is made and the reason is given in Output Messages.

In ParaView: the button is there with the plugin; select surfaces, or nothing, and click it. In a script:
scan(surfaces, view).
"""

import importlib.util
import itertools
import math
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
EXAMPLE = os.path.join("Scenes", "hongqiao.lidarscene.json")
COLOURS = "avian_lidar_energy_colours"
WIDE = 50e3  # m: surfaces that extend farther may be in millimetres
POSITION = "lidar_position"
# Where the scene does not say where the lidar stands: metres above the lowest point; share of the width or depth.
HEIGHT = 3
DISTANCE = 0.1
# What a scan is made of.
SENSORS = ("vtkAvianLidarBeamSource", "vtkAvianLidarSensorReader")  # classes: there are many sources of them
PARTS = ("AvianLidarCollisionTree", "AvianLidarMedium", "AvianLidarMediumInSurface", "AvianLidarTracks")
RESULTS = ("AvianLidarEchoFilter", "AvianLidarCoverage", "AvianLidarClutterFilter", "AvianLidarTracker")
# What shows some of a result.
SOME = ("Threshold", "Cut", "Contour")
WHAT_TO_SELECT = "select surfaces, or nothing for the airport that comes with the plugin"
ECHO_SIZE, SENSOR_SIZE = 5, 12  # pixels
# Diffuse reflectances that are drawn black and white: concrete is then a middle grey, and echoes stand out.
GREY_RANGE = (-0.05, 0.6)
# One looks over the sensor to the strongest echoes, from so many degrees above the horizon: from higher up, the rows of
# echoes on a wall cover one another. In sight are the echoes of at least this share of the strongest one's energy.
CAMERA_ELEVATION = 20
STRONG, STRONGEST = 0.25, 0.9
MARGIN = 1.15


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


def say(text, failed=True):
    """A word in Output Messages, which ParaView opens by itself for a failure."""
    window = vtkOutputWindow.GetInstance()
    display = window.DisplayErrorText if failed else window.DisplayWarningText
    display(f"Avian lidar airport scan: {text}.\n")


def name_of(source):
    """Its name in the pipeline."""
    return next((key[0] for key, known in simple.GetSources().items() if known == source), "surfaces")


def free_name(name, surfaces=None):
    """The name; if it is taken in the pipeline, with that of the surfaces; if that is taken, with a number."""
    taken = {key[0] for key in simple.GetSources()}
    long = f"{name} of {name_of(surfaces)}" if surfaces else name
    names = itertools.chain([name, long], (f"{long} {i}" for i in itertools.count(2)))
    return next(candidate for candidate in names if candidate not in taken)


def apply(source):
    """Applies what has just been opened, before it has consumers: a script cannot press the button. ParaView's window,
    which keeps to itself what is not applied, is told anew of a source that has never been shown, and takes it as one
    that a script has made. Without this, Apply would later show the bare surfaces over the scan."""
    manager = servermanager.ProxyManager()
    name = manager.GetProxyName("sources", source)
    inputs = (display.SMProxy.GetProperty("Input") for display in simple.GetRepresentations().values())
    if name and not any(shown and shown.IsProxyAdded(source.SMProxy) for shown in inputs):
        manager.UnRegisterProxy("sources", name, source)
        manager.RegisterProxy("sources", name, source)


def of_result(source):
    """Whether it is a result, or some of one: echoes of birds, slices of a coverage."""
    name = source.SMProxy.GetXMLName()
    return name in RESULTS or (name in SOME and source.Input is not None and of_result(source.Input))


def is_part(source):
    """Whether it belongs to a scan."""
    return source.SMProxy.GetXMLName() in PARTS or source.SMProxy.GetVTKClassName() in SENSORS or of_result(source)


def hide_scans(view):
    """Hides what earlier scans show."""
    for source in simple.GetSources().values():
        if is_part(source):
            for port in range(source.SMProxy.GetNumberOfOutputPorts()):
                simple.Hide(source[port], view)


def open_example():
    """The airport that comes with the plugin."""
    path = os.path.join(plugin_folder(on_server=True), EXAMPLE)
    return simple.AvianLidarSceneReader(registrationName=free_name("Airport Hongqiao"), FileName=path)


def tree_of(surfaces):
    """The surfaces, applied, with a collision tree."""
    surfaces.UpdatePipeline()
    if surfaces.SMProxy.GetXMLName() == "AvianLidarCollisionTree":
        apply(surfaces)
        return surfaces
    name = surfaces.SMProxy.GetXMLLabel()
    data = surfaces.GetDataInformation().DataInformation
    if not data.DataSetTypeIsA("vtkPolyData"):
        raise ValueError(f"{name} gives no surfaces: {WHAT_TO_SELECT}")
    apply(surfaces)
    tree = simple.AvianLidarCollisionTree(registrationName=free_name("Collision tree", surfaces), Input=surfaces)
    tree.UpdatePipeline()
    if tree.GetDataInformation().GetNumberOfCells() == 0:
        simple.Delete(tree)
        raise ValueError(f"{name} gives no surfaces: {WHAT_TO_SELECT}")
    return tree


def lidar_place(tree):
    """Where the sensor stands, as the scene says, or None."""
    position = tree.GetFieldDataInformation().GetArray(POSITION)
    return position and [position.GetRange(i)[0] for i in range(3)]


def place_beside(tree):
    """A place to start from: beside the surfaces, neither in them nor above."""
    west, east, south, north, bottom, top = tree.GetDataInformation().GetBounds()
    height = min(HEIGHT, (top - bottom) / 2) or HEIGHT
    return [(west + east) / 2, south - DISTANCE * max(east - west, north - south), bottom + height]


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


def bounds_of_strong(echoes, share):
    """Bounds of the echoes of at least this share of the strongest one's energy."""
    strongest = echoes.GetPointDataInformation().GetArray("energy").GetRange(0)[1]
    threshold = servermanager.filters.Threshold(
        Input=echoes, Scalars=["POINTS", "energy"], ThresholdMethod="Above Upper Threshold", UpperThreshold=share * strongest
    )
    threshold.UpdatePipeline()
    return threshold.GetDataInformation().GetBounds()


def centre_of(bounds):
    return [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]


def inside(point, bounds):
    return all(low < value < high for value, low, high in zip(point, bounds[::2], bounds[1::2]))


def axes_of_camera(azimuth):
    """Right, up and towards the eye, of one who looks along the azimuth (radians, from east to north)."""
    elevation = math.radians(CAMERA_ELEVATION)
    ahead = [math.cos(azimuth), math.sin(azimuth)]
    right = [ahead[1], -ahead[0], 0]
    up = [math.sin(elevation) * ahead[0], math.sin(elevation) * ahead[1], math.cos(elevation)]
    back = [-math.cos(elevation) * ahead[0], -math.cos(elevation) * ahead[1], math.sin(elevation)]
    return right, up, back


def frame(view, azimuth, *boxes, pixels=None):
    """Looks at the boxes from above, along the azimuth, in a view of so many pixels (default: as it is); without perspective, whose depth buffer cannot tell an apron from
    the grass 2 cm below it."""
    low, high = ([choose(values) for values in zip(*(b[start::2] for b in boxes))]
                 for choose, start in ((min, 0), (max, 1)))
    corners = [corner for box in boxes for corner in itertools.product(box[:2], box[2:4], box[4:])]
    right, up, back = axes_of_camera(azimuth)
    spans = []
    for axis in (right, up):
        along = [sum(a * b for a, b in zip(axis, corner)) for corner in corners]
        spans.append((min(along), max(along)))
    middle = [(low + high) / 2 for low, high in spans]
    # The point of the boxes' midst that the middle of the picture shows.
    centre = [(a + b) / 2 for a, b in zip(low, high)]
    for axis, value in zip((right, up), middle):
        shift = value - sum(a * b for a, b in zip(axis, centre))
        centre = [c + shift * a for c, a in zip(centre, axis)]
    far = 10 * max(b - a for a, b in zip(low, high))
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = centre
    view.CameraPosition = [c + far * b for c, b in zip(centre, back)]
    view.CameraViewUp = [0, 0, 1]
    pixels = pixels or view.ViewSize
    across, upright = (high - low for low, high in spans)
    view.CameraParallelScale = MARGIN * max(across * pixels[1] / pixels[0], upright) / 2


def look(view, beams, tree, echoes, seen):
    """The sensor with the strong echoes ahead; without echoes, with the surfaces, from the south."""
    sensor = [value for value in beams.Position for _ in range(2)]
    if not seen:
        frame(view, math.pi / 2, sensor, tree.GetDataInformation().GetBounds())
        return
    strongest = centre_of(bounds_of_strong(echoes, STRONGEST))
    azimuth = math.atan2(strongest[1] - beams.Position[1], strongest[0] - beams.Position[0])
    frame(view, azimuth, sensor, bounds_of_strong(echoes, STRONG))


def show(surfaces, tree, beams, echoes, view, colour):
    """Grey surfaces, the sensor as a large point, coloured echoes, all in sight."""
    simple.Hide(surfaces, view)
    show_grey(tree, view)
    display = simple.Show(beams, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = SENSOR_SIZE
    # A ball on the ground is not cut by it as a square is; but the nearest ball of all vanishes from ParaView's picture.
    display.RenderPointsAsSpheres = int(inside(beams.Position, tree.GetDataInformation().GetBounds()))
    seen = echoes.GetDataInformation().GetNumberOfPoints() > 0
    if seen:
        colour(echoes, view)
    display = simple.Show(echoes, view, "GeometryRepresentation")
    display.Representation = "Points"
    display.PointSize = ECHO_SIZE
    look(view, beams, tree, echoes, seen)


def scan(surfaces=None, view=None):
    """Scans the surfaces, or the example: returns (collision tree, sensor, echo filter)."""
    plugin_folder(on_server=True)
    colour = colouring().colour
    # As in every script that ParaView writes: the camera stays where it is put.
    simple._DisableFirstRenderCameraReset()
    surfaces = surfaces or open_example()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    tree = tree_of(surfaces)
    known = lidar_place(tree)
    place = known or place_beside(tree)
    beams = simple.AvianLidarAirport16(registrationName=free_name("Airport 16", surfaces), Position=place)
    echoes = simple.AvianLidarEchoFilter(registrationName=free_name("Scan", surfaces), Beams=beams, Surfaces=tree)
    echoes.UpdatePipeline()
    hide_scans(view)
    show(surfaces, tree, beams, echoes, view, colour)
    simple.SetActiveSource(echoes)
    where = "({:g}, {:g}, {:g}) m".format(*place)
    move = f"select {name_of(beams)}, set Position or tick Show Point and drag the handle, Apply"
    if echoes.GetDataInformation().GetNumberOfPoints() == 0:
        bounds = surfaces.GetDataInformation().GetBounds()
        if max(bounds[1] - bounds[0], bounds[3] - bounds[2]) > WIDE:
            say(f"no echoes: the surfaces are {bounds[1] - bounds[0]:g} m wide and {bounds[3] - bounds[2]:g} m deep. If they are in millimetres, "
                "apply Transform with the scale 0.001 to them, select it and click again")
        else:
            say(f"no echoes: the sensor at {where} sees nothing. Move it: {move}; then select the echoes and click Colour by Energy")
    elif not known:
        say(f"the surfaces have no {POSITION}: the sensor stands beside them, at {where}. To move it: {move}", failed=False)
    return tree, beams, echoes


def main():
    try:
        scan(simple.GetActiveSource())
    except ValueError as problem:
        say(problem)
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
