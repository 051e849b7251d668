# SPDX-License-Identifier: BSD-3-Clause
"""The macro that scans, the state and what else lies beside the plugin: the same echoes as from the pipeline built by
hand, shown as they should be, and a word where something does not fit."""

import contextlib
import importlib.util
import io
import os
import shutil
import unittest

from paraview import simple

from plugin_testing import OUTPUT_DIR, PLUGIN, SCENE, airport, assert_same, fetch, load_plugin

FOLDER = os.path.dirname(PLUGIN)
MACRO = os.path.join(FOLDER, "Macros", "avian_lidar_airport_scan.py")
STATE = os.path.join(FOLDER, "States", "avian_lidar_airport.py")
LIMITS = (2e-6, 6.25e-5)


def load_macro(path=MACRO):
    spec = importlib.util.spec_from_file_location("macro", path)
    macro = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(macro)
    return macro


def run(path, **names):
    """What ParaView does with a macro or a state: runs the text, with `__file__`; returns what it prints."""
    printed = io.StringIO()
    with open(path, encoding="utf-8") as file, contextlib.redirect_stdout(printed):
        exec(compile(file.read(), path, "exec"), {"__name__": "__main__", "__file__": path, **names})
    return printed.getvalue()


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
        """Colours mean energies; the echoes lie within the view and fill it."""
        echoes = simple.FindSource("Echoes")
        display = simple.GetDisplayProperties(echoes, view)
        self.assertEqual(list(display.ColorArrayName), ["POINTS", "energy"])
        self.assertEqual((display.Representation, display.Visibility), ("Points", 1))
        self.assertGreaterEqual(display.PointSize, 4)
        table = simple.GetColorTransferFunction("energy")
        self.assertEqual((table.RGBPoints[0], table.RGBPoints[-4]), LIMITS)
        bar = simple.GetScalarBar(table, view)
        self.assertEqual((bar.Title, bar.ComponentTitle, bar.Visibility), ("energy", "J", 1))
        tree = simple.GetDisplayProperties(simple.FindSource("Collision tree"), view)
        self.assertEqual((tree.Representation, tree.Visibility), ("Surface", 1))
        self.assertEqual(list(tree.ColorArrayName), ["CELLS", "kd"])
        simple.Render(view)
        camera = view.GetActiveCamera()
        matrix = camera.GetCompositeProjectionTransformMatrix(view.ViewSize[0] / view.ViewSize[1], -1, 1)
        points = [matrix.MultiplyPoint([*point, 1])[:2] for point in fetch(echoes)["points"]]
        self.assertLessEqual(max(abs(value) for point in points for value in point), 1)
        self.assertGreater(max(abs(value) for point in points for value in point), 0.7)

    def test_nothing_selected_opens_the_airport(self):
        self.assertEqual(run(MACRO), "")
        self.assertEqual(self.names(), ["Airport 16", "Airport Hongqiao", "Collision tree", "Echoes"])
        self.assertEqual(simple.GetActiveSource(), simple.FindSource("Echoes"))
        self.assertEqual(list(simple.FindSource("Airport 16").Position), [0, 0, 3])
        self.check_view(self.view)
        assert_same(fetch(simple.FindSource("Echoes")), self.expected())

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
        self.assertEqual(simple.FindSource("Echoes").Surfaces, tree)

    def test_a_second_scan_has_names_of_its_own(self):
        scene = simple.OpenDataFile(SCENE)
        for _ in range(2):
            simple.SetActiveSource(scene)
            run(MACRO)
        self.assertIn("Echoes 2", self.names())
        self.assertIn("Airport 16 2", self.names())

    def test_surfaces_without_a_place_for_the_lidar(self):
        box = simple.Box(XLength=200, YLength=100, ZLength=50, Center=[1000, 2000, 25])
        simple.SetActiveSource(box)
        printed = run(MACRO)
        self.assertIn("lidar_position", printed)
        self.assertEqual(list(simple.FindSource("Airport 16").Position), [1000, 1950, 3])

    def test_surfaces_without_echoes(self):
        simple.SetActiveSource(simple.Sphere())
        self.assertIn("no echo", run(MACRO))
        self.assertEqual(simple.FindSource("Echoes").GetDataInformation().GetNumberOfPoints(), 0)
        # The camera sees the sphere and the sensor, 3 m above its lowest point.
        self.assertLess(abs(self.view.CameraFocalPoint[2] - 1), 0.1)
        self.assertLess(self.view.CameraParallelScale, 5)

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
        assert_same(fetch(simple.FindSource("Echoes")), self.expected())


if __name__ == "__main__":
    load_plugin()
    unittest.main()
