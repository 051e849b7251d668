# SPDX-License-Identifier: BSD-3-Clause
"""The macros beside the plugin: the echoes of the pipeline built by hand, shown as they should be, and a word where
something does not fit, when nothing is made. The coverage's pictures are compared with baselines.

Run by pvpython: TestMacros.py [Macros] [MoreMacros]. With --documentation pictures go to Documentation/images. New
baselines: copy TestCoverageImage*.png from the folder for temporary files to Testing/Data/Baseline and look at them."""

import colorsys
import contextlib
import functools
import io
import os
import pathlib
import shutil
import struct
import sys
import tempfile
import unittest
import unittest.mock

import numpy
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from plugin_testing import (OUTPUT_DIR, PLUGIN, SOURCE_DIR, airport, assert_same, colour_of, compare, fetch, load_macro,
                            load_plugin)

FOLDER = os.path.dirname(PLUGIN)
AIRPORT, BIRDS, BEAM, COVERAGE, TRACKED, FOG, CLASSES, WAVEFORM = (
    os.path.join(FOLDER, "Macros", f"avian_lidar_{name}.py") for name in (
        "airport_scan", "birds_over_the_airport", "show_beam", "coverage", "birds_tracked", "ground_fog",
        "class_colours", "plot_waveform"))
LIMITS = (2e-6, 6.25e-5)


def said(work):
    """What a call prints, and says in Output Messages."""
    printed, window, messages = io.StringIO(), vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(messages)
    try:
        with contextlib.redirect_stdout(printed):
            work()
    finally:
        vtkOutputWindow.SetInstance(window)
    return printed.getvalue() + messages.GetOutput()


def run(path, active=None):
    """What ParaView does with a macro: runs the text, with `__file__`."""
    simple.SetActiveSource(active)
    code = compile(pathlib.Path(path).read_text("utf-8"), path, "exec")
    return said(lambda: exec(code, {"__name__": "__main__", "__file__": path}))


def shown(source, view, port=0):
    display = servermanager.GetRepresentation(source[port], view)
    return bool(display and display.Visibility)


def find(*names):
    return [simple.FindSource(name) for name in names]


def points_of(*names):
    return [source.GetDataInformation().GetNumberOfPoints() for source in find(*names)]


def document(name, view, size):
    if "--documentation" in sys.argv:
        simple.SaveScreenshot(os.path.join(SOURCE_DIR, "Documentation", "images", name), view, ImageResolution=size)


def palette():
    """Colours that ParaView keeps in the user's settings, which no macro changes."""
    return [*simple.GetSettingsProxy("ColorPalette").GetProperty("BackgroundColor")]


class Case(unittest.TestCase):
    def setUp(self):
        self.view = simple.CreateRenderView(ViewSize=[600, 400])
        simple.SetActiveSource(None)

    def tearDown(self):
        self.assertEqual(palette(), PALETTE)
        unittest.mock.patch.stopall()
        simple.ResetSession()
        load_plugin()

    def names(self):
        return sorted(name for name, _ in simple.GetSources())

    def check_shown(self, sources, expected):
        for source in sources:
            self.assertEqual(shown(source, self.view), expected, source)


class Macros(Case):
    def setUp(self):
        """Fewer beams of the sensors that macros make."""
        super().setUp()
        for name, step in (("Airport16", 1.5), ("Search905", 0.75)):
            sensor = functools.partial(getattr(simple, "AvianLidar" + name), AzimuthStep=step)
            unittest.mock.patch.object(simple, "AvianLidar" + name, sensor).start()

    def check_view(self):
        """Colours mean energies; the sensor and the strong echoes lie within the view and fill it, and the strongest
        ones lie straight ahead of the sensor."""
        (echoes, tree), view = find("Scan", "Collision tree"), simple.GetActiveView()
        display = simple.GetDisplayProperties(echoes, view)
        self.assertEqual((list(display.ColorArrayName), display.Representation), (["POINTS", "energy"], "Points"))
        table = simple.GetColorTransferFunction("energy")
        self.assertEqual((table.RGBPoints[0], table.RGBPoints[-4]), LIMITS)
        bar = simple.GetScalarBar(table, view)
        self.assertEqual((bar.Title, bar.ComponentTitle, bar.Visibility), ("energy (\u00b5J)", "", 1))
        labels = dict(zip(map(float, table.Annotations[::2]), map(float, table.Annotations[1::2])))
        self.assertTrue(set(LIMITS) <= set(labels) and len(labels) > 3, labels)
        numpy.testing.assert_allclose([1e6 * energy for energy in labels], list(labels.values()), rtol=2e-3)
        surfaces = simple.GetDisplayProperties(tree, view)
        self.assertEqual(list(surfaces.ColorArrayName), ["CELLS", "object_id"])
        classes = simple.GetColorTransferFunction("object_id")
        runway = list(classes.Annotations[1::2]).index("runway")
        self.assertEqual([round(255 * value) for value in classes.IndexedColors[3 * runway:3 * runway + 3]], [58] * 3)
        self.assertTrue(shown(echoes, view) and shown(tree, view))
        simple.Render(view)
        matrix = view.GetActiveCamera().GetCompositeProjectionTransformMatrix(
            view.ViewSize[0] / view.ViewSize[1], -1, 1)
        found = fetch(echoes)
        energy, (x, y) = found["energy"], matrix.MultiplyPoint([*echoes.Beams.Position, 1])[:2]
        places = numpy.array([matrix.MultiplyPoint([*point, 1])[:2] for point in found["points"]])
        reach = numpy.abs([*places[energy >= 0.25 * energy.max()], (x, y)]).max()
        self.assertTrue(0.7 < reach <= 1, reach)
        ahead = places[numpy.argmax(energy)] - (x, y)
        self.assertTrue(abs(ahead[0]) < 0.1 and ahead[1] > 0, ahead)

    def test_airport(self):
        """With nothing selected. TestWindow.py loads the state, which runs this macro."""
        expected = fetch(airport(columns=240)[3])
        for source in [*simple.GetSources().values()]:
            simple.Delete(source)
        self.assertEqual(run(AIRPORT), "")
        self.assertEqual(self.names(), ["Airport 16", "Airport Hongqiao", "Collision tree", "Edges", "Landmarks",
                                        "Scan"])
        scan, beams = find("Scan", "Airport 16")
        self.assertEqual((simple.GetActiveSource(), list(beams.Position)), (scan, [0, 0, 3]))
        self.check_view()
        assert_same(fetch(scan), expected)

    def test_selected_surfaces(self):
        """Each scan has names of its own and hides the one before; what was shown otherwise stays. There is one tree of
        the wall, which the macro also finds from a result."""
        wall, own = simple.Box(registrationName="wall", XLength=90, Center=[0, 50, 0]), simple.Box()
        for source in (wall, own):
            simple.Show(source, self.view)
        for _ in range(2):
            run(AIRPORT, wall)
        for part in ("Airport 16", "Scan"):
            first, second = find(part, part + " of wall")
            self.assertEqual((shown(first, self.view), shown(second, self.view)), (False, True), part)
        self.assertTrue(shown(own, self.view) and not shown(wall, self.view))
        tree = find("Collision tree")[0]
        self.assertEqual((tree.Input, find("wall")), (wall, [wall]))
        for selected in (tree, find("Scan")[0], find("Airport 16")[0]):  # a sensor uses nothing: the newest tree
            run(AIRPORT, selected)
            self.assertEqual(simple.GetActiveSource().Surfaces, tree)
        self.assertEqual(sum("tree" in name for name in self.names()), 1)

    def test_own_airport(self):
        """Every macro takes the selected surfaces, at their height above the sea, and from then on a result of
        these."""
        wall = simple.Box(registrationName="wall", XLength=90, ZLength=20, Center=[0, 50, 110])
        other = simple.AvianLidarCollisionTree(registrationName="z", Input=simple.Box(registrationName="other"))
        for path in (FOG, BIRDS, COVERAGE):
            text = run(path, wall if path == FOG else simple.GetActiveSource())
            self.assertRegex(text, "the sensor stands beside the surfaces")
        (tree,), (fog, gulls, level) = find("Collision tree"), find("Ground fog", "Gulls", "Coverage at 30 m")
        self.assertEqual(tree.Input, wall)
        self.assertNotEqual(tree, other)
        run(AIRPORT, find("Search 905")[0])  # a sensor belongs to its scan
        self.assertEqual(simple.GetActiveSource().Surfaces, tree)
        for name in ("Scan with birds", "Coverage map"):
            self.assertEqual(find(name)[0].Surfaces, tree)
        self.assertEqual((fog.Bottom, gulls.Center[2], level.SliceType.Origin[2]), (100, 100, 130))

    def test_ground_below_a_mast(self):
        """Heights count from the surface straight below the lidar, not from the lowest point nor from the lidar."""
        low = simple.Box(XLength=90, YLength=90, ZLength=2, Center=[0, 0, -1])
        high = simple.Box(ZLength=4, Center=[20, 0, 3])
        tree = simple.AvianLidarCollisionTree(Input=simple.AppendGeometry(Input=[low, high]))
        tree.UpdatePipeline()
        ground = sys.modules["avian_lidar_plugin"].ground_below
        self.assertEqual([ground(place, tree) for place in ([5, 5, 10], [20, 0, 15], [20, 0, 4], [500, 0, 3])],
                         [0, 5, 1, -2])

    def test_a_map_of_reasons_goes_with_its_airport(self):
        """The map's second view is closed by the next scan, also if it is the active view."""
        layout = simple.CreateLayout("Airports")
        simple.AssignViewToLayout(self.view, layout)
        run(COVERAGE)
        simple.SetActiveView(simple.FindView("Reasons"))
        run(AIRPORT, simple.Box(XLength=90, Center=[0, 50, 0]))
        self.assertEqual((simple.GetRenderViews(), simple.GetActiveView()), ([self.view], self.view))
        self.assertEqual((simple.FindView("Reasons"), layout.GetViewLocation(self.view.SMProxy)), (None, 0))

    def test_place_beside_surfaces(self):
        for surfaces, place in ((simple.Box(XLength=200, YLength=100, ZLength=50, Center=[1000, 2000, 25]),
                                 [1000, 1930, 3]),
                                (simple.Plane(Origin=[0, 0, 7], Point1=[100, 0, 7], Point2=[0, 50, 7]), [50, -10, 10])):
            text = run(AIRPORT, surfaces)
            numpy.testing.assert_allclose(simple.GetActiveSource().Beams.Position, place, atol=0.01)
            self.assertRegex(text, "the sensor .*tick Show Point")

    def test_large_surfaces_have_no_edges(self):
        """Their edges would take minutes to find."""
        plugin = sys.modules["avian_lidar_plugin"]
        with unittest.mock.patch.object(plugin, "MOST_EDGED", 11):
            run(AIRPORT, simple.Box(XLength=90, Center=[0, 50, 0]))
        self.assertNotIn("Edges", self.names())
        run(AIRPORT, simple.Box(XLength=90, Center=[0, 50, 0]))
        self.assertIn("Edges", self.names())

    def test_surfaces_without_echoes(self):
        """The camera sees them and the sensor."""
        macro = load_macro(AIRPORT)
        macro.lidar_place = lambda tree: [0, -500, 400]
        self.assertIn("(0, -500, 400) m sees nothing", said(lambda: macro.scan(simple.Sphere(Radius=1), self.view)))
        self.assertEqual(points_of("Scan"), [0])
        self.assertLess(abs(self.view.CameraFocalPoint[0]), 1)
        self.assertTrue(100 < self.view.CameraParallelScale < 140)

    def test_nothing_is_made(self):
        for make in (simple.Wavelet, simple.Line):
            source = make()
            before = self.names()
            self.assertIn("gives no surfaces", run(AIRPORT, source))
            self.assertEqual(self.names(), before)
        simple.ResetSession()
        load_plugin()
        for path, name, act, words in ((AIRPORT, "PLUGIN", "scan", "load the plugin"),
                                       (AIRPORT, "ENERGY_COLOURS", "scan", "no_such.py"),
                                       (COVERAGE, "STATUS", "cover", "no_such.py")):
            macro = load_macro(path)
            place = sys.modules["avian_lidar_plugin"] if name == "PLUGIN" else macro  # what macros share
            with unittest.mock.patch.object(place, name, "no_such"), self.assertRaisesRegex(ValueError, words):
                getattr(macro, act)()
            self.assertEqual(self.names(), [])

    def test_a_copy_elsewhere_finds_its_neighbour_beside_the_plugin(self):
        with tempfile.TemporaryDirectory() as folder:
            run(shutil.copy(AIRPORT, folder), simple.Box(XLength=90, Center=[0, 50, 0]))
        self.assertEqual(list(simple.GetDisplayProperties(simple.GetActiveSource(), self.view).ColorArrayName),
                         ["POINTS", "energy"])

    def test_a_beam_that_is_not_there(self):
        """A new view goes again; one that is there stays."""
        run(AIRPORT, simple.Box(XLength=90, Center=[0, 50, 0]))
        macro, scan, before = load_macro(BEAM), simple.GetActiveSource(), self.names()
        with self.assertRaisesRegex(ValueError, "no beam 100000000"):
            macro.show_beam(scan, 10**8)
        self.assertEqual(self.names(), before)
        beam = macro.show_beam(scan, int(fetch(scan)["beam_id"][0]))
        with self.assertRaisesRegex(ValueError, "no beam 2000000000"):
            macro.show_beam(scan, 2 * 10**9)
        self.assertEqual((self.names(), int(beam.BeamId)), (sorted([*before, "Beam"]), 2 * 10**9))

    def test_birds(self):
        """Scans to play, in each of which birds of every kind are seen where they are drawn."""
        self.assertEqual(run(BIRDS), "")
        (echoes,), animation = find("Scan with birds"), simple.GetAnimationScene()
        self.assertEqual(simple.GetActiveSource(), echoes)
        self.assertEqual(list(animation.TimeKeeper.TimestepValues), [2.0 * k for k in range(10)])
        self.assertEqual((animation.PlayMode, animation.TimeKeeper.Time), ("Snap To TimeSteps", 0.0))
        seen, parts = [], [f"Echoes of {kind}" for kind in ("gulls", "crows", "starlings")]
        for k in range(2):
            simple.Render(self.view)
            kinds = fetch(echoes)["object_id"] // 1000
            seen.append(points_of(*parts))
            self.assertEqual(seen[k], [numpy.count_nonzero(kinds == 10 + place) for place in range(3)])
            self.assertGreater(min(seen[k]), 0)
            if not k:
                document("paraview-birds.png", self.view, [1200, 800])
                animation.GoToNext()
        self.assertNotEqual(*seen)
        self.check_shown(find(*parts, "Collision tree"), True)
        legend = simple.GetColorTransferFunction("species_id")
        self.assertEqual(list(legend.Annotations)[1::2], ["starling", "crow", "herring gull"])
        colours = dict(zip(legend.Annotations[1::2], numpy.reshape(legend.IndexedColors, (-1, 3)).tolist()))
        for tracks, echoes_of in zip(find("Gulls", "Crows", "Starlings"), find(*parts)):
            self.assertTrue(shown(tracks, self.view, 1) and not shown(tracks, self.view) and tracks.Lines is None)
            trails = simple.GetDisplayProperties(simple.OutputPort(tracks, 1), self.view)
            self.assertEqual(list(trails.ColorArrayName), ["CELLS", "species_id"])
            points = simple.GetDisplayProperties(echoes_of, self.view)
            self.assertEqual(list(points.AmbientColor), colours[tracks.Species[0]])
        bar = simple.GetScalarBar(legend, self.view)
        self.assertEqual((bar.Title, bar.Visibility), ("species", 1))
        # On the scale of a photon receiver, birds are not all blue.
        table = simple.GetColorTransferFunction("energy")
        self.assertEqual(table.UseLogScale, 1)
        simple.Render(self.view)
        found = fetch(echoes)
        energies = found["energy"][found["object_id"] >= 10000]
        hues = [colorsys.rgb_to_hsv(*colour_of(table.SMProxy.GetClientSideObject(), energy))[0] for energy in energies]
        self.assertLess(numpy.median(hues), 0.55)  # blue is 0.67

    def test_ground_fog(self):
        self.assertEqual(run(FOG), "")
        fog, scan = find("Ground fog", "Scan in fog")
        self.assertEqual(simple.GetActiveSource(), fog)
        self.check_shown((fog, scan), True)
        self.assertLess(simple.GetDisplayProperties(fog, self.view).Opacity, 0.6)
        counts = points_of("Scan in fog")
        for visibility in (2000.0, 50.0):
            fog.MeteorologicalVisibility = visibility
            scan.UpdatePipeline()
            counts += points_of("Scan in fog")
        self.assertTrue(counts[1] > counts[0] > counts[2], counts)

    def test_class_colours(self):
        """A sequence of two scans, whose times the reader gives."""
        folder = self.enterContext(tempfile.TemporaryDirectory())
        for name, kind, content in (("velodyne", "bin", struct.pack("<8f", *range(8))),
                                    ("labels", "label", struct.pack("<2I", 50, 99))):
            os.makedirs(os.path.join(folder, name))
            for k in range(2):
                pathlib.Path(folder, name, f"{k:06d}.{kind}").write_bytes(content[: len(content) // (2 - k)])
        times = pathlib.Path(folder, "times.txt")
        times.write_text("0\n0.5\n", "utf-8")
        reader = simple.OpenDataFile(str(times))
        self.assertEqual(list(reader.TimestepValues), [0, 0.5])
        simple.Show(reader, self.view)
        self.assertEqual(run(CLASSES, reader), "")
        self.assertEqual(list(simple.GetDisplayProperties(reader, self.view).ColorArrayName),
                         ["POINTS", "semantic_label"])
        table = simple.GetColorTransferFunction("semantic_label")
        bird = list(table.Annotations).index("bird") // 2
        colour = [round(255 * value) for value in table.IndexedColors[3 * bird : 3 * bird + 3]]
        self.assertEqual((table.Annotations[2 * bird], colour), ("99", [231, 41, 138]))

    def test_a_beam_in_the_air_of_its_scan(self):
        run(AIRPORT, simple.Box(XLength=90, Center=[0, 50, 0]))
        macro, scan = load_macro(BEAM), simple.GetActiveSource()
        beam_id, scan.Beams.ReceiverAperture = int(fetch(scan)["beam_id"][0]), 1e-3
        air = {"AttenuationCoefficient": 1e-4, "MeteorologicalVisibility": 5e3, "AirBackscatter": 1, "RainRate": 4.0}
        for name, value in air.items():
            setattr(scan, name, value)
        beam = macro.show_beam(scan, beam_id)
        self.assertEqual({name: getattr(beam, name) for name in air}, air)

    def test_the_waveform_of_the_selected_echo(self):
        """Without a selection, of the strongest echo. The chart follows the pulse."""
        self.assertIn("make a scan first", run(WAVEFORM))
        run(AIRPORT, simple.Box(XLength=90, Center=[0, 50, 0]))
        scan = simple.GetActiveSource()
        self.assertEqual(run(WAVEFORM, scan), "")
        chart, lines = simple.FindView("Waveform"), simple.FindSource("Waveform")
        display = servermanager.GetRepresentation(lines, chart)
        self.assertEqual((display.XArrayName, display.UseIndexForXAxis), ("distance_m", 0))
        self.assertEqual(list(display.SeriesVisibility), ["signal", "sample", "energy_received", "threshold"])
        before = fetch(lines)["signal"]
        scan.Beams.PulseWidth = 2.5e-9
        lines.UpdatePipeline()
        self.assertGreater(abs(fetch(lines)["signal"].max() / before.max() - 1.0), 1e-3)
        ids = fetch(scan)["beam_id"]
        other = int(ids[ids != lines.LowerThreshold][0])
        simple.QuerySelect(QueryString=f"beam_id == {other}", FieldType="POINT", Source=scan)
        self.assertEqual((run(WAVEFORM, scan), chart.ChartTitle), ("", f"Beam {other}"))
        self.assertEqual((lines.LowerThreshold, lines.UpperThreshold), (other, other))
        macro = load_macro(WAVEFORM)
        with self.assertRaisesRegex(ValueError, "has no waveform"):
            macro.plot_waveform(scan, 10**8)

    def test_names_in_chinese(self):
        folder = tempfile.mkdtemp(dir=OUTPUT_DIR)
        for file in pathlib.Path(SOURCE_DIR, "Examples", "airport", "scene").glob("hongqiao.*"):
            text = file.read_text("utf-8").replace("Terminal 2", "\u8679\u68652\u53f7\u822a\u7ad9\u697c")
            pathlib.Path(folder, file.name).write_text(text, "utf-8")
        run(AIRPORT, simple.OpenDataFile(os.path.join(folder, "hongqiao.lidarscene.json")))
        names = servermanager.GetRepresentation(simple.FindSource("Landmarks")[2], self.view)
        self.assertTrue(os.path.exists(names.PointLabelFontFile), names.PointLabelFontFile)  # fonts-wqy-microhei
        self.assertEqual(names.PointLabelFontFamily, "File")

    def test_the_state_of_a_recording(self):
        """`avianlidar track` writes it: in a session with the plugin alone, it shows the bird's track at the end."""
        import avianlidar
        from avianlidar.apps.sequences._recorded import RecordedTracks
        from TestRecordedTracks import RATE, SPEED, scan
        folder = pathlib.Path(tempfile.mkdtemp(dir=OUTPUT_DIR))
        for number in range(20):
            avianlidar.save(scan(number), folder / f"{number}.pcd")
        RecordedTracks(avianlidar.load_clouds(folder, rate=RATE), learning=8).write(folder / "out")
        run(str(folder / "out" / "play.py"))
        scans, tracks = find("Scans", "Tracks")
        self.assertEqual([*scans.TimestepValues], [number / RATE for number in range(20)])
        for time in scans.TimestepValues:
            tracks.UpdatePipeline(time)
        path = fetch(tracks)
        numpy.testing.assert_allclose(path["velocity"][-1][:2], SPEED, atol=1.0)
        self.assertTrue(all(shown(source, simple.GetActiveView()) for source in find("Clutter", "What is left")))


class MoreMacros(Case):
    """Takes minutes."""

    def check_first_view(self, macro, name):
        self.view.ViewSize = [900, 600]
        self.assertEqual(run(macro), "")
        simple.SaveScreenshot(os.path.join(OUTPUT_DIR, name), self.view, ImageResolution=[900, 600])
        compare(name)

    def test_first_view(self):
        """Edges, rings, names, beams, echoes, and a legend."""
        self.check_first_view(AIRPORT, "TestFirstView.png")

    def test_first_view_of_birds(self):
        self.check_first_view(BIRDS, "TestFirstView-birds.png")

    def test_coverage(self):
        """The probability on a slice under a surface, in the view; the reasons with words and colours, in the other."""
        size = [800, 350] if "--documentation" in sys.argv else [500, 400]
        self.view.ViewSize = [2 * size[0], size[1]]
        layout = simple.CreateLayout("Coverage")
        simple.AssignViewToLayout(self.view, layout)
        self.assertEqual(run(COVERAGE), "")
        coverage, level, surface, probable = find("Coverage map", "Coverage at 30 m", "Every other scan", "Probable")
        other = simple.FindView("Reasons")
        document("paraview-coverage.png", layout, [1600, 700])
        self.assertEqual((simple.GetActiveSource(), simple.GetActiveView(), coverage.Places),
                         (coverage, self.view, None))
        for view, name in ((self.view, "TestCoverageImage.png"), (other, "TestCoverageImage-reasons.png")):
            view.ViewSize, view.OrientationAxesVisibility = size, 0
            simple.SaveScreenshot(os.path.join(OUTPUT_DIR, name), view, ImageResolution=size)
            compare(name)
            self.assertTrue(shown(find("Collision tree")[0], view))
        self.assertEqual(list(simple.GetDisplayProperties(probable, self.view).ColorArrayName),
                         ["POINTS", "detection_probability"])
        table = simple.GetColorTransferFunction("detection_probability")
        self.assertEqual((table.RGBPoints[0], table.RGBPoints[-4]), (0, 1))
        self.check_shown((surface, probable), True)
        self.assertTrue(shown(level, other) and not shown(surface, other) and not shown(level, self.view))
        display = simple.GetDisplayProperties(level, other)
        self.assertEqual(list(display.ColorArrayName), ["POINTS", "status"])
        table = simple.GetColorTransferFunction("status", display, separate=True)
        names = servermanager.Fetch(level).GetFieldData().GetAbstractArray("status_names")
        names = [names.GetValue(i) for i in range(names.GetNumberOfValues())]
        self.assertEqual(list(table.Annotations), [text for i, name in enumerate(names) for text in (str(i), name)])
        self.assertEqual(len({tuple(table.IndexedColors[i : i + 3]) for i in range(0, 3 * len(names), 3)}), len(names))
        self.assertNotIn("seen", simple.GetColorTransferFunction("status").Annotations)  # those of beams
        # The slice lies at points of the image: no status is between two.
        data = servermanager.Fetch(coverage)
        nx, ny, nz = data.GetDimensions()
        status, probability = (vtk_to_numpy(data.GetPointData().GetArray(name))
                               for name in ("status", "detection_probability"))
        layer = status.reshape(nz, ny, nx)[round((30 - data.GetOrigin()[2]) / data.GetSpacing()[2])]
        found = vtk_to_numpy(servermanager.Fetch(level).GetPointData().GetArray("status"))
        numpy.testing.assert_array_equal(numpy.bincount(found, minlength=8), numpy.bincount(layer.ravel(), minlength=8))
        numpy.testing.assert_array_equal(status == 7, probability >= 0.1)
        # Another air: another map without a line of sight. Another place of the lidar has lines of its own.
        before = probability.mean()
        for change, traced in ((lambda: setattr(coverage, "MeteorologicalVisibility", 2000.0), 0),
                               (lambda: setattr(coverage.Beams, "Position", [20, 0, 3]), len(status))):
            change()
            now = vtk_to_numpy(servermanager.Fetch(coverage).GetPointData().GetArray("detection_probability")).mean()
            coverage.UpdatePipelineInformation()
            self.assertEqual(coverage.NumberOfTracedPlaces, traced)
            self.assertNotEqual(now, before)

    def test_birds_tracked(self):
        """Tracks after all scans, with clutter and what is left."""
        self.assertEqual(run(TRACKED), "")
        parts = ("Clutter", "What is left", "Tracks")
        (tracker, echoes), sources, scene = find("Tracker", "Scan with birds"), find(*parts), simple.GetAnimationScene()
        self.assertEqual(simple.GetActiveSource(), tracker)
        self.assertEqual(list(scene.TimeKeeper.TimestepValues), [2.0 * k for k in range(20)])
        confirmed = vtk_to_numpy(servermanager.Fetch(tracker).GetCellData().GetArray("confirmed"))
        self.assertGreater(numpy.count_nonzero(confirmed), 5)
        self.check_shown(sources, True)
        self.assertGreater(min(points_of(*parts)), 0)
        self.check_shown([echoes], False)
        simple.Render(self.view)
        # Back at the beginning all is forgotten, and the airport's scan hides the tracks.
        scene.AnimationTime = 0
        tracker.UpdatePipeline(0)
        self.assertEqual(servermanager.Fetch(tracker).GetNumberOfPoints(), 0)
        self.assertEqual([sum(points_of(*parts[:2]))], points_of("Scan with birds"))
        run(AIRPORT)
        self.check_shown(sources, False)


if __name__ == "__main__":
    load_plugin()
    PALETTE = palette()
    program = unittest.main(argv=[word for word in sys.argv if word != "--documentation"], exit=False)
    sys.stdout.flush()
    # pvpython 5.11 may crash when it ends after a macro and ResetSession().
    os._exit(not program.result.wasSuccessful())
