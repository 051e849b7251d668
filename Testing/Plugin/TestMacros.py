# SPDX-License-Identifier: BSD-3-Clause
"""The macro that scans, the state and what else lies beside the plugin: the same echoes as from the pipeline built by
hand, shown as they should be, and a word where something does not fit.

With --documentation pictures of the birds and of the fog go to Documentation/images."""

import contextlib
import importlib.util
import io
import os
import shutil
import sys
import unittest

import numpy
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from plugin_testing import OUTPUT_DIR, PLUGIN, SCENE, SOURCE_DIR, airport, assert_same, fetch, load_plugin

FOLDER = os.path.dirname(PLUGIN)
MACRO = os.path.join(FOLDER, "Macros", "avian_lidar_airport_scan.py")
BIRDS = os.path.join(FOLDER, "Macros", "avian_lidar_birds_over_the_airport.py")
BEAM = os.path.join(FOLDER, "Macros", "avian_lidar_show_beam.py")
COVERAGE = os.path.join(FOLDER, "Macros", "avian_lidar_coverage.py")
TRACKED = os.path.join(FOLDER, "Macros", "avian_lidar_birds_tracked.py")
FOG = os.path.join(FOLDER, "Macros", "avian_lidar_ground_fog.py")
STATE = os.path.join(FOLDER, "States", "avian_lidar_airport.py")
LIMITS = (2e-6, 6.25e-5)


def load_macro(path=MACRO):
    spec = importlib.util.spec_from_file_location("macro", path)
    macro = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(macro)
    return macro


def run(path, **names):
    """What ParaView does with a macro or a state: runs the text, with `__file__`; returns what it prints and what it says
    in Output Messages."""
    printed, window, messages = io.StringIO(), vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(messages)
    try:
        with open(path, encoding="utf-8") as file, contextlib.redirect_stdout(printed):
            exec(compile(file.read(), path, "exec"), {"__name__": "__main__", "__file__": path, **names})
    finally:
        vtkOutputWindow.SetInstance(window)
    return printed.getvalue() + messages.GetOutput()


def shown(source, view, port=0):
    display = servermanager.GetRepresentation(source[port], view)
    return bool(display and display.Visibility)


class TestMacros(unittest.TestCase):
    def setUp(self):
        self.view = simple.CreateRenderView(ViewSize=[600, 400])
        simple.SetActiveSource(None)

    def tearDown(self):
        simple.ResetSession()
        load_plugin()

    def names(self):
        return sorted(name for name, _ in simple.GetSources())

    def expected(self):
        _, _, _, echoes = airport()
        return fetch(echoes)

    def check_view(self, view):
        """Colours mean energies; the sensor and the strong echoes lie within the view and fill it, and the strongest ones
        lie straight ahead of the sensor."""
        echoes = simple.FindSource("Scan")
        display = simple.GetDisplayProperties(echoes, view)
        self.assertEqual(list(display.ColorArrayName), ["POINTS", "energy"])
        self.assertEqual((display.Representation, display.Visibility), ("Points", 1))
        self.assertGreaterEqual(display.PointSize, 4)
        table = simple.GetColorTransferFunction("energy")
        self.assertEqual((table.RGBPoints[0], table.RGBPoints[-4]), LIMITS)
        bar = simple.GetScalarBar(table, view)
        self.assertEqual((bar.Title, bar.ComponentTitle, bar.Visibility), ("energy (J)", "", 1))
        tree = simple.GetDisplayProperties(simple.FindSource("Collision tree"), view)
        self.assertEqual((tree.Representation, tree.Visibility), ("Surface", 1))
        self.assertEqual(list(tree.ColorArrayName), ["CELLS", "kd"])
        simple.Render(view)
        camera = view.GetActiveCamera()
        matrix = camera.GetCompositeProjectionTransformMatrix(view.ViewSize[0] / view.ViewSize[1], -1, 1)
        found = fetch(echoes)
        energy = found["energy"]
        sensor = echoes.Beams.Position

        def place(point):
            return matrix.MultiplyPoint([*point, 1])[:2]

        strong = [place(point) for point in found["points"][energy >= 0.25 * energy.max()]]
        places = numpy.abs([*strong, place(sensor)])
        self.assertLessEqual(places.max(), 1)
        self.assertGreater(places.max(), 0.7)
        strongest = place(found["points"][numpy.argmax(energy)])
        self.assertLess(abs(strongest[0] - place(sensor)[0]), 0.1)
        self.assertGreater(strongest[1], place(sensor)[1])

    def test_nothing_selected_opens_the_airport(self):
        self.assertEqual(run(MACRO), "")
        self.assertEqual(self.names(), ["Airport 16", "Airport Hongqiao", "Collision tree", "Scan"])
        self.assertEqual(simple.GetActiveSource(), simple.FindSource("Scan"))
        self.assertEqual(list(simple.FindSource("Airport 16").Position), [0, 0, 3])
        self.check_view(self.view)
        assert_same(fetch(simple.FindSource("Scan")), self.expected())

    def test_the_selected_scene(self):
        scene = simple.OpenDataFile(SCENE)
        simple.SetActiveSource(scene)
        self.assertEqual(run(MACRO), "")
        self.assertEqual(simple.FindSource("Collision tree").Input, scene)
        self.check_view(self.view)

    def test_the_selected_tree_is_used(self):
        _, tree, _, _ = airport(240)
        simple.SetActiveSource(tree)
        self.assertEqual(run(MACRO), "")
        self.assertEqual(simple.FindSource("Scan").Surfaces, tree)

    def test_a_second_scan_has_names_of_its_own_and_hides_the_first(self):
        scene = simple.OpenDataFile(SCENE)
        simple.RenameSource("my scene", scene)
        own = simple.Show(simple.Box(), self.view)
        for _ in range(3):
            simple.SetActiveSource(scene)
            run(MACRO)
        for part in ("Collision tree", "Airport 16", "Scan"):
            first, *later = (simple.FindSource(part + end) for end in ("", " of my scene", " of my scene 2"))
            self.assertEqual([shown(source, self.view) for source in (first, *later)], [False, False, True], part)
        self.assertEqual(own.Visibility, 1)

    def test_a_source_that_was_shown_keeps_its_place(self):
        scene = simple.OpenDataFile(SCENE)
        simple.RenameSource("my scene", scene)
        simple.Show(scene, self.view)
        simple.SetActiveSource(scene)
        run(MACRO)
        self.assertFalse(shown(scene, self.view))
        self.assertEqual(simple.FindSource("my scene"), scene)

    def test_surfaces_without_a_place_for_the_lidar(self):
        box = simple.Box(XLength=200, YLength=100, ZLength=50, Center=[1000, 2000, 25])
        simple.SetActiveSource(box)
        said = run(MACRO)
        self.assertIn("no lidar_position: the sensor stands beside them, at (1000, 1930, 3) m", said)
        self.assertIn("tick Show Point", said)
        self.assertEqual(list(simple.FindSource("Airport 16").Position), [1000, 1930, 3])
        self.check_view(self.view)

    def test_a_small_thing_is_seen_from_beside(self):
        sphere = simple.Sphere(ThetaResolution=60, PhiResolution=60)
        simple.SetActiveSource(sphere)
        run(MACRO)
        x, y, z = simple.FindSource("Airport 16").Position
        self.assertLess(abs(y + 0.6), 0.01)
        self.assertLess(abs(z), 0.01)
        self.assertGreater(simple.FindSource("Scan").GetDataInformation().GetNumberOfPoints(), 1000)

    def test_flat_surfaces(self):
        simple.SetActiveSource(simple.Plane(Origin=[0, 0, 7], Point1=[100, 0, 7], Point2=[0, 50, 7]))
        run(MACRO)
        self.assertEqual(list(simple.FindSource("Airport 16").Position), [50, -10, 10])

    def test_surfaces_without_echoes(self):
        sphere = simple.Sphere(Radius=1)
        macro = load_macro()
        macro.place_beside = lambda tree: [0, -500, 400]
        messages = vtkStringOutputWindow()
        window = vtkOutputWindow.GetInstance()
        vtkOutputWindow.SetInstance(messages)
        self.addCleanup(vtkOutputWindow.SetInstance, window)
        macro.scan(sphere, self.view)
        self.assertIn("no echoes: the sensor at (0, -500, 400) m sees nothing. Move it", messages.GetOutput())
        self.assertEqual(simple.FindSource("Scan").GetDataInformation().GetNumberOfPoints(), 0)
        # The camera sees the sphere and the sensor.
        self.assertLess(abs(self.view.CameraFocalPoint[0]), 1)
        self.assertGreater(self.view.CameraParallelScale, 100)
        self.assertLess(self.view.CameraParallelScale, 140)

    def test_what_gives_no_surfaces(self):
        for make in (simple.Wavelet, simple.AvianLidarAirport32, simple.Line):
            source = make()
            simple.SetActiveSource(source)
            before = self.names()
            self.assertIn("gives no surfaces: select surfaces", run(MACRO))
            self.assertEqual(self.names(), before)

    def test_a_copy_elsewhere_finds_its_neighbour_beside_the_plugin(self):
        copy = os.path.join(OUTPUT_DIR, "TestMacros_copy", "avian_lidar_airport_scan.py")
        os.makedirs(os.path.dirname(copy), exist_ok=True)
        self.addCleanup(shutil.rmtree, os.path.dirname(copy))
        shutil.copy(MACRO, copy)
        self.assertEqual(run(copy), "")
        self.check_view(self.view)

    def test_birds(self):
        """Scans to play, in each of which birds of every kind are seen where they are drawn; a second time, too."""
        for number, end in enumerate(("", " 2")):
            self.assertEqual(run(BIRDS), "")
            echoes = simple.FindSource("Scan with birds" + end)
            self.assertEqual(simple.GetActiveSource(), echoes)
            animation = simple.GetAnimationScene()
            self.assertEqual(list(animation.TimeKeeper.TimestepValues), [2.0 * k for k in range(10)])
            self.assertEqual((animation.PlayMode, animation.TimeKeeper.Time), ("Snap To TimeSteps", 0.0))
            seen = []
            for k in range(3):
                simple.Render(self.view)
                self.assertEqual(animation.TimeKeeper.Time, 2.0 * k)
                of = fetch(echoes)["object_id"]
                counts = []
                for place, kind in enumerate(("gulls", "crows", "starlings")):
                    source = simple.FindSource(f"Echoes of {kind}{end}")
                    self.assertTrue(shown(source, self.view), kind)
                    counts.append(source.GetDataInformation().GetNumberOfPoints())
                    self.assertEqual(counts[-1], numpy.count_nonzero(of // 1000 == 10 + place), kind)
                    self.assertGreater(counts[-1], 0)
                seen.append(counts)
                if k < 2:
                    animation.GoToNext()
            self.assertNotEqual(seen[0], seen[1])
            for name in ("Gulls", "Crows", "Starlings"):
                tracks = simple.FindSource(name + end)
                self.assertTrue(shown(tracks, self.view, 1))
                self.assertFalse(shown(tracks, self.view, 0))
                self.assertIsNone(tracks.Lines)
            self.assertTrue(shown(simple.FindSource("Collision tree"), self.view))
            if "--documentation" in sys.argv and not number:
                file = os.path.join(SOURCE_DIR, "Documentation", "images", "paraview-birds.png")
                simple.SaveScreenshot(file, self.view, ImageResolution=[1200, 800])
            animation.GoToFirst()
        self.assertEqual(len([name for name in self.names() if name.startswith(("Airport", "Collision"))]), 2)
        for name in ("Scan with birds", "Echoes of gulls", "Search 905"):
            self.assertFalse(shown(simple.FindSource(name), self.view), name)
        self.assertFalse(shown(simple.FindSource("Gulls"), self.view, 1))
        # The airport's scan hides all of it.
        simple.SetActiveSource(None)
        run(MACRO)
        self.assertFalse(shown(simple.FindSource("Echoes of gulls 2"), self.view))
        self.assertFalse(shown(simple.FindSource("Gulls 2"), self.view, 1))

    def places(self, end=""):
        """The coverage's points: probability and status, and how many lines of sight were traced."""
        coverage = simple.FindSource("Coverage map" + end)
        data = servermanager.Fetch(coverage).GetPointData()
        coverage.UpdatePipelineInformation()
        arrays = [vtk_to_numpy(data.GetArray(name)).copy() for name in ("detection_probability", "status")]
        return (*arrays, coverage.NumberOfTracedPlaces)

    def check_coverage(self, end=""):
        """The probability on the slice under a surface, in the view; the reasons with words and colours, in the other."""
        other = simple.FindView("Reasons")
        level, surface = (simple.FindSource(name + end) for name in ("Coverage at 30 m", "Every other scan"))
        probable = simple.GetDisplayProperties(simple.FindSource("Probable" + end), self.view)
        self.assertEqual((list(probable.ColorArrayName), probable.Visibility), (["POINTS", "detection_probability"], 1))
        table = simple.GetColorTransferFunction("detection_probability")
        self.assertEqual((table.RGBPoints[0], table.RGBPoints[-4]), (0, 1))
        self.assertTrue(shown(surface, self.view))
        self.assertLess(simple.GetDisplayProperties(surface, self.view).Opacity, 0.6)
        self.assertFalse(shown(surface, other) or shown(level, self.view))
        self.assertTrue(shown(level, other))
        for view in (self.view, other):
            self.assertTrue(shown(simple.FindSource("Collision tree"), view))
        display = simple.GetDisplayProperties(level, other)
        self.assertEqual(list(display.ColorArrayName), ["POINTS", "status"])
        table = simple.GetColorTransferFunction("status", display, separate=True)
        names = servermanager.Fetch(level).GetFieldData().GetAbstractArray("status_names")
        names = [names.GetValue(i) for i in range(names.GetNumberOfValues())]
        self.assertEqual(len(names), 8)
        self.assertEqual(list(table.Annotations), [text for i, name in enumerate(names) for text in (str(i), name)])
        self.assertEqual(len({tuple(table.IndexedColors[i : i + 3]) for i in range(0, 24, 3)}), 8)
        # The slice lies at points of the image: no status is between two.
        on_slice = vtk_to_numpy(servermanager.Fetch(level).GetPointData().GetArray("status"))
        data = servermanager.Fetch(simple.FindSource("Coverage map" + end))
        nx, ny, nz = data.GetDimensions()
        layer = round((30 - data.GetOrigin()[2]) / data.GetSpacing()[2])
        image = vtk_to_numpy(data.GetPointData().GetArray("status")).reshape(nz, ny, nx)[layer]
        self.assertEqual(on_slice.dtype, numpy.uint8)
        numpy.testing.assert_array_equal(numpy.bincount(on_slice, minlength=8), numpy.bincount(image.ravel(), minlength=8))

    def test_coverage(self):
        self.assertEqual(run(COVERAGE), "")
        coverage = simple.FindSource("Coverage map")
        self.assertEqual(simple.GetActiveSource(), coverage)
        self.assertEqual(simple.GetActiveView(), self.view)
        self.assertIsNone(coverage.Places)
        self.check_coverage()
        probability, status, _ = self.places()
        numpy.testing.assert_array_equal(status == 7, probability >= 0.1)
        self.assertGreater(numpy.count_nonzero(status == 4), 1000)
        # Another bird and another air: other maps without a line of sight.
        means = [probability.mean()]
        for values in ({"Species": "starling"}, {"Species": "Canada goose"}, {"MeteorologicalVisibility": 2000.0}):
            for name, value in values.items():
                setattr(coverage, name, value)
            probability, status, traced = self.places()
            self.assertEqual(traced, 0)
            means.append(probability.mean())
        self.assertTrue(means[1] < means[0] < means[2] > means[3], means)
        # Another place of the lidar has lines of sight of its own.
        coverage.Beams.Position = [20, 0, 3]
        self.assertEqual(self.places()[2], len(status))
        views = len(simple.GetViews())
        # A second time, and after it the airport's scan.
        self.assertEqual(run(COVERAGE), "")
        self.check_coverage(" 2")
        self.assertEqual(len(simple.GetViews()), views)
        parts = ("Coverage at 30 m", "Probable", "Every other scan", "Search 905")
        for view in (self.view, simple.FindView("Reasons")):
            for name in parts:
                self.assertFalse(shown(simple.FindSource(name), view), name)
        self.assertEqual(len([name for name in self.names() if name.startswith(("Airport", "Collision"))]), 2)
        simple.SetActiveSource(None)
        run(MACRO)
        for name in parts:
            self.assertFalse(shown(simple.FindSource(name + " 2"), self.view), name)

    def test_birds_tracked(self):
        """Tracks after all scans, with clutter and what is left."""
        self.assertEqual(run(TRACKED), "")
        tracker, echoes = simple.FindSource("Tracker"), simple.FindSource("Scan with birds")
        self.assertEqual(simple.GetActiveSource(), tracker)
        scene = simple.GetAnimationScene()
        times = list(scene.TimeKeeper.TimestepValues)
        self.assertEqual(times, [2.0 * k for k in range(20)])
        confirmed = vtk_to_numpy(servermanager.Fetch(tracker).GetCellData().GetArray("confirmed"))
        self.assertGreater(numpy.count_nonzero(confirmed), 5)
        for name in ("Clutter", "What is left", "Tracks"):
            source = simple.FindSource(name)
            self.assertTrue(shown(source, self.view), name)
            self.assertGreater(source.GetDataInformation().GetNumberOfPoints(), 0, name)
        self.assertFalse(shown(echoes, self.view))
        simple.Render(self.view)
        if "--documentation" in sys.argv:
            file = os.path.join(SOURCE_DIR, "Documentation", "images", "paraview-tracked.png")
            simple.SaveScreenshot(file, self.view, ImageResolution=[1200, 800])
        # Back at the beginning all is forgotten, and the airport's scan hides the tracks.
        scene.AnimationTime = times[0]
        tracker.UpdatePipeline(times[0])
        self.assertEqual(servermanager.Fetch(tracker).GetNumberOfPoints(), 0)
        total = echoes.GetDataInformation().GetNumberOfPoints()
        self.assertEqual(sum(simple.FindSource(name).GetDataInformation().GetNumberOfPoints() for name in ("Clutter", "What is left")), total)
        simple.SetActiveSource(None)
        run(MACRO)
        for name in ("Clutter", "What is left", "Tracks"):
            self.assertFalse(shown(simple.FindSource(name), self.view), name)

    def test_ground_fog(self):
        self.assertEqual(run(FOG), "")
        fog, scan = simple.FindSource("Ground fog"), simple.FindSource("Scan in fog")
        self.assertEqual(simple.GetActiveSource(), fog)
        display = simple.GetDisplayProperties(fog, self.view)
        self.assertTrue(shown(fog, self.view) and shown(scan, self.view) and display.Opacity < 0.6)
        if "--documentation" in sys.argv:
            file = os.path.join(SOURCE_DIR, "Documentation", "images", "paraview-fog.png")
            simple.SaveScreenshot(file, self.view, ImageResolution=[1000, 600])
        counts = []
        for visibility in (400.0, 2000.0, 50.0):
            fog.MeteorologicalVisibility = visibility
            scan.UpdatePipeline()
            counts.append(scan.GetDataInformation().GetNumberOfPoints())
        self.assertTrue(counts[1] > counts[0] > counts[2], counts)
        # A second time, and after it the airport's scan.
        self.assertEqual(run(FOG), "")
        self.assertFalse(shown(fog, self.view) or shown(scan, self.view))
        self.assertEqual(len([name for name in self.names() if name.startswith(("Airport H", "Collision"))]), 2)
        simple.SetActiveSource(None)
        run(MACRO)
        self.assertFalse(shown(simple.FindSource("Ground fog 2"), self.view))

    def test_coverage_by_status(self):
        """The colours of status know the words of places, and leave those of beams as they are."""
        run(COVERAGE)
        macro = load_macro(os.path.join(FOLDER, "Macros", "avian_lidar_status_colours.py"))
        display = macro.colour(simple.FindSource("Coverage map"), self.view)
        self.assertEqual(display.Representation, "Slice")
        table = simple.GetColorTransferFunction("status", display, separate=True)
        self.assertEqual(list(table.Annotations)[-2:], ["7", "seen"])
        self.assertNotIn("seen", simple.GetColorTransferFunction("status").Annotations)

    def test_coverage_without_its_neighbours(self):
        macro = load_macro(COVERAGE)
        macro.BIRDS = "no_such_macro"
        with self.assertRaisesRegex(ValueError, "there is no no_such_macro.py in"):
            macro.cover()
        self.assertEqual(self.names(), [])

    def test_a_beam_that_is_not_there(self):
        """A new view goes again; one that is there stays."""
        run(MACRO)
        macro, scan, before = load_macro(BEAM), simple.FindSource("Scan"), self.names()
        with self.assertRaisesRegex(ValueError, "there is no beam 100000000 to show"):
            macro.show_beam(scan, 10**8)
        self.assertEqual(self.names(), before)
        beam = macro.show_beam(scan, 11408)
        with self.assertRaisesRegex(ValueError, "there is no beam 2000000000 to show"):
            macro.show_beam(scan, 2 * 10**9)
        self.assertEqual((self.names(), int(beam.BeamId)), (sorted([*before, "Beam"]), 2 * 10**9))

    def test_without_the_plugin(self):
        macro = load_macro()
        macro.PLUGIN = "NoSuchPlugin"
        with self.assertRaisesRegex(ValueError, "load the plugin first"):
            macro.scan()

    def test_without_its_neighbour_nothing_is_made(self):
        macro = load_macro()
        macro.COLOURS = "no_such_macro"
        with self.assertRaisesRegex(ValueError, "there is no no_such_macro.py in"):
            macro.scan()
        self.assertEqual(self.names(), [])

    def test_state(self):
        run(STATE)
        self.check_view(simple.GetActiveView())
        assert_same(fetch(simple.FindSource("Scan")), self.expected())


if __name__ == "__main__":
    load_plugin()
    unittest.main(argv=[word for word in sys.argv if word != "--documentation"])
