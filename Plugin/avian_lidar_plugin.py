# SPDX-License-Identifier: BSD-3-Clause
"""Common functions of the macros. This module is in the plugin's library. `import avian_lidar_plugin` works wherever
the plugin is loaded, also in a copy of a macro, after `from paraview import servermanager`, which lets Python find
modules of plugins."""

import importlib.util
import itertools
import json
import math
import os

from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import vtkOutputWindow

PLUGIN = "AvianLidarPlugin"
EXAMPLE = os.path.join("Scenes", "hongqiao.lidarscene.json")
ENERGY_COLOURS, SPECIES_COLOURS = "avian_lidar_energy_colours", "avian_lidar_species_colours"
POSITION = "lidar_position"
BEAM = "beam_id"
TREE = "AvianLidarCollisionTree"
# Parts of a scan.
SENSORS = ("vtkAvianLidarBeamSource", "vtkAvianLidarSensorReader")  # classes of many sources
PARTS = (TREE, "AvianLidarMedium", "AvianLidarMediumInSurface", "AvianLidarTracks", "AvianLidarLandmarks")
ECHO_FILTER = "AvianLidarEchoFilter"
RESULTS = (ECHO_FILTER, "AvianLidarCoverage", "AvianLidarClutterFilter", "AvianLidarTracker")
# Filters that show a part of a result, and the filter that shows edges of surfaces.
SOME, EDGES = ("Threshold", "Cut", "Contour"), "FeatureEdges"
MOST_EDGED = 100_000  # triangles up to which edges take at most a second to find; at 750,000 they take minutes
SHARP = 30  # angle between faces from which on their edge is drawn, deg
RINGS_IN_VIEW = 6  # rings between the middle and the side of the view, at most
RANGES_AT = 60  # direction of the ranges of rings from the middle, clockwise from straight ahead, deg
AMBIENT = 0.35  # share of the light that has no direction
WHAT_TO_SELECT = "select surfaces, or nothing for the airport that comes with the plugin"
# Fonts with Chinese and Japanese letters, which ParaView's own font lacks.
FONTS = ("/usr/share/fonts/truetype/wqy/wqy-microhei.ttc", "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc")
# Views that macros put beside another view.
REASONS, SHARES, WAVEFORM = "Reasons", "Shares of the beam", "Waveform"
# Place of the lidar if the scene does not give a position: metres above the lowest point, share of the width or depth.
HEIGHT = 3
DISTANCE = 0.1
SENSOR_SIZE = 12  # size of the sensor's point, pixels
# Diffuse reflectances kd drawn as black and as white, for surfaces without classes.
GREY_RANGE = (-0.9, 0.6)
MARGIN = 1.15


def plugin_folder(on_server=False):
    """The folder of the loaded plugin. @param on_server the folder on the server, for files that a remote server
    reads"""
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


def neighbour(name, file=None):
    """Another macro as a module, from the folder of the macro `file`, else from the plugin's folder."""
    folders = [os.path.dirname(os.path.abspath(file))] if file else []
    folders.append(os.path.join(plugin_folder(), "Macros"))
    for folder in folders:
        path = os.path.join(folder, name + ".py")
        if os.path.exists(path):
            spec = importlib.util.spec_from_file_location(name, path)
            macro = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(macro)
            return macro
    raise ValueError(f"there is no {name}.py in {' nor in '.join(folders)}")


def data(name):
    """The content of a JSON file in the plugin's folder Data."""
    with open(os.path.join(plugin_folder(), "Data", name), encoding="utf-8") as file:
        return json.load(file)


def say(title, text, failed=True):
    """Shows a message in Output Messages. ParaView opens Output Messages after a failure."""
    window = vtkOutputWindow.GetInstance()
    display = window.DisplayErrorText if failed else window.DisplayWarningText
    display(f"Avian lidar {title}: {text}.\n")


def write(title, text):
    """Prints a message in the terminal, or in the Python shell."""
    print(f"Avian lidar {title}: {text}.")


def run(title, macro, *arguments, report=say, render=simple.Render):
    """Runs a macro as a click does: draws the views, or reports the problem."""
    try:
        macro(*arguments)
    except (ValueError, RuntimeError) as problem:
        report(title, problem)
    else:
        render()


def start(view=None):
    """The view to use. Raises an error if the plugin is not loaded."""
    plugin_folder(on_server=True)
    # As in scripts that ParaView writes: the first rendering does not move the camera.
    simple._DisableFirstRenderCameraReset()
    view = view or simple.GetActiveViewOrCreate("RenderView")
    if view in side_views():
        view = next((one for one in simple.GetRenderViews() if one not in side_views()), view)
        simple.SetActiveView(view)
    return view


def side_views():
    """The views that macros have put beside another view."""
    return [view for view in map(simple.FindView, (REASONS, SHARES, WAVEFORM)) if view is not None]


def close_view(view):
    """Closes a view. The view beside it gets its place."""
    layout = simple.GetLayout(view)
    if layout:
        cell = layout.GetViewLocation(view.SMProxy)
        layout.RemoveView(cell)
        layout.Collapse(cell)
    simple.Delete(view)


def name_of(source):
    """The name of a source in the pipeline."""
    return next((key[0] for key, known in simple.GetSources().items() if known == source), "surfaces")


def free_name(name, surfaces=None):
    """A free name in the pipeline: `name`, else `name` with the name of the surfaces, else also with a number."""
    taken = {key[0] for key in simple.GetSources()}
    long = f"{name} of {name_of(surfaces)}" if surfaces else name
    names = itertools.chain([name, long], (f"{long} {i}" for i in itertools.count(2)))
    return next(candidate for candidate in names if candidate not in taken)


def of_kind(name):
    return [source for source in simple.GetSources().values() if source.SMProxy.GetXMLName() == name]


def of_result(source):
    """Whether a source is a result, or a part of a result, such as echoes of birds or a slice of a coverage."""
    name = source.SMProxy.GetXMLName()
    return name in RESULTS or (name in SOME and source.Input is not None and of_result(source.Input))


def is_part(source):
    """Whether a source belongs to a scan."""
    return source.SMProxy.GetXMLName() in PARTS or source.SMProxy.GetVTKClassName() in SENSORS or of_result(source)


def hide_scans(*views):
    """Hides the parts and results of earlier scans in these views, and closes the views beside them."""
    for other in side_views():
        if other not in views:
            close_view(other)
    for source in filter(is_part, simple.GetSources().values()):
        for view in views:
            for port in range(source.SMProxy.GetNumberOfOutputPorts()):
                simple.Hide(source[port], view)


def upstream(source):
    """A source and all sources that it uses, the nearest first."""
    found = [source]
    for one in found:
        for name in one.ListProperties():
            inputs = one.GetProperty(name)
            if isinstance(inputs, servermanager.InputProperty):
                used = [getattr(port, "Proxy", port) for port in inputs]  # the source of a port
                found += [other for other in used if other is not None and other not in found]
    return found


def scan_of(source):
    """The echo filter that the source is or uses upstream, or None."""
    return next((one for one in upstream(source) if one.SMProxy.GetXMLName() == ECHO_FILTER), None) if source else None


def selected_beams():
    """(source, beam ids) of each selection of echoes, of a beam report or of waveforms; first of the active source."""
    active = simple.GetActiveSource()
    for source in sorted(simple.GetSources().values(), key=lambda one: one != active):
        for port in range(source.SMProxy.GetNumberOfOutputPorts()):
            selection = source.SMProxy.GetSelectionInput(port)
            if not selection or scan_of(source) is None:
                continue
            extract = servermanager.filters.ExtractSelection(
                Input=source[port], Selection=servermanager._getPyProxy(selection))
            extract.UpdatePipeline()
            data = servermanager.Fetch(extract)
            for arrays in (data.GetPointData(), data.GetCellData()):
                ids = arrays.GetArray("beam_id")
                if ids and ids.GetNumberOfTuples():
                    yield source, [int(ids.GetTuple1(i)) for i in range(ids.GetNumberOfTuples())]
                    break


def apply(source):
    """Applies a source that has just been opened and has no consumers, because a script cannot press the button Apply.
    If the source was never shown, the function registers the source again, like a source that a script has made.
    Otherwise, Apply would later show the bare surfaces over the scan."""
    manager = servermanager.ProxyManager()
    name = manager.GetProxyName("sources", source)
    inputs = (display.SMProxy.GetProperty("Input") for display in simple.GetRepresentations().values())
    if name and not any(shown and shown.IsProxyAdded(source.SMProxy) for shown in inputs):
        manager.UnRegisterProxy("sources", name, source)
        manager.RegisterProxy("sources", name, source)


def open_example():
    """The airport that comes with the plugin."""
    path = os.path.join(plugin_folder(on_server=True), EXAMPLE)
    return simple.AvianLidarSceneReader(registrationName=free_name("Airport Hongqiao"), FileName=path)


def tree_of(surfaces):
    """Applies the surfaces, and gives them a collision tree."""
    surfaces.UpdatePipeline()
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


def is_example(source):
    return (source is not None and source.SMProxy.GetXMLName() == "AvianLidarSceneReader" and
            os.path.basename(source.FileName) == os.path.basename(EXAMPLE))


def has_beams(source):
    """Whether the points of a source are echoes or beams, as in a file of echoes."""
    source.UpdatePipeline()
    return source.GetPointDataInformation().GetArray(BEAM) is not None


def surfaces_and_tree(selected):
    """The surfaces to scan and their collision tree, from the pipeline if possible. If a part or a result of a scan is
    selected, these are the surfaces of its scan or else of the newest scan. If nothing is selected, or there is no
    scan, they are the airport that comes with the plugin."""
    newest = sorted(simple.GetSources().values(), key=lambda one: -one.SMProxy.GetGlobalID())
    trees = [one for one in newest if one.SMProxy.GetXMLName() == TREE]
    part = selected is not None and (is_part(selected) or has_beams(selected))
    chains = []
    if selected is not None:
        chains.append(upstream(selected))
        if part:
            chains += [chain for chain in map(upstream, newest) if selected in chain] + [trees]
    tree = next((one for chain in chains for one in chain if one in trees), None)
    if tree is None:
        surfaces = selected
        if selected is None or part:
            surfaces = next(filter(is_example, of_kind("AvianLidarSceneReader")), None) or open_example()
        tree = next((one for one in trees if one.Input == surfaces), None) or tree_of(surfaces)
    tree.UpdatePipeline()
    if tree == selected:
        apply(tree)
    return tree.Input, tree


def place_beside(tree):
    """A place for the sensor beside the surfaces, neither inside nor above them."""
    west, east, south, north, bottom, top = tree.GetDataInformation().GetBounds()
    height = min(HEIGHT, (top - bottom) / 2) or HEIGHT
    return [(west + east) / 2, south - DISTANCE * max(east - west, north - south), bottom + height]


def lidar_place(tree):
    """The position of the sensor, m: from the scene or, without a position there, beside the surfaces."""
    position = tree.GetFieldDataInformation().GetArray(POSITION)
    return [position.GetRange(i)[0] for i in range(3)] if position else place_beside(tree)


def ground_below(place, tree):
    """Height of the surface straight below a place, m, or of the lowest point of the surfaces."""
    down = servermanager.sources.AvianLidarBeamSource(
        Position=place, ChannelElevations=[-90.0], AzimuthRange=[0.0, 1.0], AzimuthStep=1.0)
    seen = servermanager.filters.AvianLidarBeamView(Beams=down, Surfaces=tree, BeamId=0)
    seen.UpdatePipeline()
    below = seen.GetDataInformation()
    return below.GetBounds()[5] if below.GetNumberOfPoints() else tree.GetDataInformation().GetBounds()[4]


def how_to_move(beams):
    return f"select {name_of(beams)}, set Position (or tick Show Point and drag the handle), and click Apply"


def say_place(title, tree, beams):
    """Warns if the scene does not give the position of the sensor."""
    if not tree.GetFieldDataInformation().GetArray(POSITION):
        where = "({:g}, {:g}, {:g}) m".format(*beams.Position)
        say(title, f"the surfaces have no {POSITION}: the sensor stands beside the surfaces, at {where}. To move the "
            f"sensor, {how_to_move(beams)}", failed=False)


def output_with(source, array):
    """The output that has an array at its points: the given output or, without the array, another one of the source."""
    proxy = servermanager._getPyProxy(source.SMProxy)
    others = (servermanager.OutputPort(proxy, port) for port in range(source.SMProxy.GetNumberOfOutputPorts()))
    for output in itertools.chain([source], others):
        if output.GetPointDataInformation().GetArray(array) is not None:
            return output
    raise ValueError(f"{name_of(source)} has no point array {array}")


def update_first_step(echoes):
    """Gives the animation the time steps of the data, and goes to the first step."""
    animation = simple.GetAnimationScene()
    animation.UpdateAnimationUsingDataTimeSteps()
    animation.GoToFirst()
    echoes.UpdatePipeline(animation.TimeKeeper.Time)


def show(source, view, colour=None, **properties):
    """Shows a source with these properties, and in one colour if `colour` is given. @return the display"""
    display = simple.Show(source, view)
    if colour:
        display.ColorArrayName = ["POINTS", ""]
        display.AmbientColor = display.DiffuseColor = colour
    for name, value in properties.items():
        setattr(display, name, value)
    return display


def colour_by(display, kind, array, preset, limits, logarithmic=False):
    """Colours a display by an array over a fixed range. @return the table of colours"""
    simple.ColorBy(display, (kind, array))
    table = simple.GetColorTransferFunction(array)
    # Before the range is set: otherwise the next update would undo the range.
    table.AutomaticRescaleRangeMode = "Never"
    table.UseLogScale = 0
    table.ApplyPreset(preset, True)
    table.RescaleTransferFunction(*limits)
    table.UseLogScale = int(logarithmic)
    return table


def legend(table, view, title):
    """The legend of a table of colours in letters that the background shows, with one format for all numbers."""
    bar = simple.GetScalarBar(table, view)
    is_light = not view.UseColorPaletteForBackground and sum(view.Background) > 1.5
    bar.TitleColor = bar.LabelColor = [0.1 if is_light else 1.0] * 3
    bar.Title, bar.ComponentTitle = title, ""
    bar.AutomaticLabelFormat = 0
    bar.LabelFormat = bar.RangeLabelFormat = "%.3g"
    return bar


def rgb(colour):
    """Red, green and blue (0 to 1) of a colour #rrggbb."""
    return [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]


def texts_of(source, name):
    """The texts of an array of the field data, which a server sends without cells and points."""
    empty = servermanager.filters.Threshold(Input=source, Scalars=["CELLS", "object_id"],
                                            ThresholdMethod="Above Upper Threshold", UpperThreshold=1e9)
    empty.UpdatePipeline()
    found = servermanager.Fetch(empty).GetFieldData().GetAbstractArray(name)
    return [found.GetValue(i) for i in range(found.GetNumberOfValues())] if found else []


def light(view):
    """Gives the view a light background: colours of the view alone, since a palette would stay in the user's settings.
    @return colours of the project (look.json)"""
    look = data("look.json")
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode, view.Background = "Single Color", rgb(look["sky"])
    view.OrientationAxesLabelColor = [0.0] * 3
    return look


def show_surfaces(tree, view):
    """Shows the surfaces on a light background, in the colours of their classes or, without classes, in shades of grey:
    lighter surfaces reflect more. Edges are drawn unless there are too many triangles."""
    look = light(view)
    display = show(tree, view, Representation="Surface")
    names = tree.GetFieldDataInformation().GetArray("object_classes")
    classes = texts_of(tree, "object_classes") if names else []
    if not any(classes):
        colour_by(display, "CELLS", "kd", "Grayscale", GREY_RANGE)
    else:
        colours = [look["land"] if word in look["ground"][:2] else
                   look["classes"].get(word, look["classes"]["building"] if word else look["unknown"])
                   for word in classes]
        simple.ColorBy(display, ("CELLS", "object_id"))
        table = simple.GetColorTransferFunction("object_id")
        table.InterpretValuesAsCategories = table.AnnotationsInitialized = 1
        table.Annotations = [text for number, word in enumerate(classes) for text in (str(number), word or "surface")]
        table.IndexedColors = [value for colour in colours for value in rgb(colour)]
        table.IndexedOpacities = [1.0] * len(colours)
    display.SetScalarBarVisibility(view, False)
    display.Ambient, display.Diffuse = AMBIENT, 1 - AMBIENT / 2  # the colours of the classes, with shades
    if tree.GetDataInformation().GetNumberOfCells() > MOST_EDGED:
        return
    edges = next((one for one in of_kind(EDGES) if one.Input == tree), None)
    if edges is None:
        edges = simple.FeatureEdges(registrationName=free_name("Edges", tree.Input), Input=tree, FeatureAngle=SHARP,
                                    NonManifoldEdges=0, Coloring=0)
    show(edges, view, rgb(look["edges"]))


def show_sensor(beams, view, as_ball=1):
    show(beams, view, rgb(data("look.json")["lidar"]), Representation="Points", PointSize=SENSOR_SIZE,
         RenderPointsAsSpheres=as_ball)


def show_landmarks(tree, beams, view):
    """Shows names of runway ends and buildings, rings of equal range, and a fan of beams to the first ring. Call it when
    the camera is in its place. Rings and fan move with the sensor."""
    look = data("look.json")
    least = view.CameraParallelScale * view.ViewSize[0] / view.ViewSize[1] / RINGS_IN_VIEW
    ahead = math.degrees(math.atan2(*(view.CameraFocalPoint[i] - view.CameraPosition[i] for i in (0, 1))))
    landmarks = simple.AvianLidarLandmarks(
        registrationName=free_name("Landmarks"), Beams=beams, Surfaces=tree, RangeDirection=(ahead + RANGES_AT) % 360,
        RingSpacing=next(size * 10.0 ** power for power in range(-3, 9) for size in (1, 2, 5)
                         if size * 10.0 ** power >= least))
    view.OrientationAxesVisibility = 0  # N tells directions, and names lie where the axes would be
    rings, ranges, names, fan = (simple.OutputPort(landmarks, port) for port in range(4))
    shown = [simple.Show(texts, view) for texts in (ranges, names)]
    font = next(filter(os.path.exists, FONTS), None)
    if font and any(letter > "\u02ff" for letter in "".join(texts_of(tree, "object_names"))):
        shown[1].PointLabelFontFamily, shown[1].PointLabelFontFile = "File", font
    show(rings, view, rgb(look["edges"]), Opacity=0.5)
    show(fan, view, rgb(look["lidar"]), Opacity=0.3)


def axes_of_camera(azimuth, elevation):
    """Unit vectors to the right, up and towards the eye. @param azimuth rad, from east to north @param elevation deg"""
    elevation = math.radians(elevation)
    ahead = [math.cos(azimuth), math.sin(azimuth)]
    right = [ahead[1], -ahead[0], 0]
    up = [math.sin(elevation) * ahead[0], math.sin(elevation) * ahead[1], math.cos(elevation)]
    back = [-math.cos(elevation) * ahead[0], -math.cos(elevation) * ahead[1], math.sin(elevation)]
    return right, up, back


def frame(view, azimuth, elevation, *boxes, pixels=None):
    """Points the camera at the boxes from above, along the azimuth. The camera has no perspective: with perspective,
    the depth buffer mixes an apron and the grass 2 cm below. @param pixels size of the view (default: the present
    size)"""
    low, high = ([choose(values) for values in zip(*(b[start::2] for b in boxes))]
                 for choose, start in ((min, 0), (max, 1)))
    corners = [corner for box in boxes for corner in itertools.product(box[:2], box[2:4], box[4:])]
    right, up, back = axes_of_camera(azimuth, elevation)
    spans = []
    for axis in (right, up):
        along = [sum(a * b for a, b in zip(axis, corner)) for corner in corners]
        spans.append((min(along), max(along)))
    middle = [(low + high) / 2 for low, high in spans]
    # Moves the centre of the boxes to the point in the middle of the picture.
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
