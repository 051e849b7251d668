# SPDX-License-Identifier: BSD-3-Clause
"""The first click of a user: a bare ParaView with the plugin, without a state, in which nothing has run Python before
the click.

Run by the system's Python: TestFirstClick.py paraview. Each test starts ParaView, which plays clicks by its own player
of events and saves the pipeline as a state. The player needs no Python."""

import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

from gui_testing import PLUGIN_DIR, SOURCE_DIR, play

SENSOR = os.path.join(SOURCE_DIR, "Filters", "Sensors", "VLP16.lidarsensor.json")
SCENE = os.path.join(SOURCE_DIR, "Examples", "airport", "scene", "hongqiao.lidarscene.json")
WINDOW = "pqClientMainWindow"
APPLY = "propertiesDock/propertiesPanel/Accept"
AIRPORT = {"Airport Hongqiao", "Collision tree", "Edges"}
BIRDS = {"Landmarks", "Birds", "Gulls", "Crows", "Starlings", "Echoes of gulls", "Echoes of crows", "Echoes of starlings"}
# Names in the pipeline after the first click on each macro.
MACROS = {"airport_scan": AIRPORT | {"Airport 16", "Landmarks", "Scan"},
          "birds_over_the_airport": AIRPORT | BIRDS | {"Search 905", "Scan with birds"},
          "birds_tracked": AIRPORT | BIRDS
          | {"Search 905", "Scan with birds", "Clutter filter", "Clutter", "What is left", "Tracker", "Tracks"},
          "coverage": AIRPORT | {"Search 905", "Coverage map", "Coverage at 30 m", "Probable", "Every other scan"},
          "ground_fog": AIRPORT | {"Search 905", "Ground fog", "Airport in fog", "Scan in fog", "Landmarks"}}
# Buttons of the toolbar, and those that need no selection.
SCANS = ("airport_scan", "birds_over_the_airport", "coverage")
ALWAYS = (*SCANS, "plot_waveform")
BUTTONS = (*SCANS, "energy_colours", "status_colours", "plot_waveform", "filter")
# What Output Messages say after the first click on a macro that needs a selection or a scan.
WORDS = {"show_beam": "select an echo first", "plot_waveform": "make a scan first"}


def click(widget, arguments=""):
    return ElementTree.Element("pqevent", object=f"{WINDOW}/{widget}", command="activate", arguments=arguments)


def macro(name):
    return click("menubar/menu_Macros", "avian_lidar_" + name)


def button(name):
    """The path of a button of the toolbar."""
    return f"AvianLidarToolbar/1QToolButton{BUTTONS.index(name)}"


def enabled(*names):
    """Checks that these buttons are enabled, and the others not."""
    return [ElementTree.Element("pqcheck", object=f"{WINDOW}/{button(name)}", property="enabled",
                                arguments=str(name in names or name in ALWAYS).lower()) for name in BUTTONS]


def names(state):
    """The names in the pipeline of a saved state."""
    (sources,) = (group for group in state.iter("ProxyCollection") if group.get("name") == "sources")
    return {source.get("name") for source in sources}


class FirstClick(unittest.TestCase):
    def test_macros(self):
        for name, expected in MACROS.items():
            with self.subTest(name):
                state, messages = play(PARAVIEW, [macro(name)])
                self.assertEqual((messages, names(state)), ([], expected))

    def test_buttons_in_turn(self):
        """Each button of the toolbar, whatever the click before has made. Buttons that do not fit the selection are
        disabled."""
        events = enabled()
        for name in (*SCANS, "airport_scan"):
            events.append(click(button(name)))
            events += enabled("energy_colours", "status_colours")
            events += [click(button("energy_colours")), click(button("status_colours"))]
        state, messages = play(PARAVIEW, events)
        self.assertEqual(messages, [])
        self.assertEqual({name for name in names(state) if name.startswith(tuple(AIRPORT))},
                         AIRPORT)

    def test_surfaces_are_not_selected(self):
        """With a sensor or echoes of a file selected, also before Apply, a click scans the airport."""
        with tempfile.TemporaryDirectory() as folder:
            echoes = os.path.join(folder, "echoes.vtp")
            subprocess.run([sys.executable, "-m", "avianlidar", "scan", SCENE, "--sensor-set", "azimuth_step=6", "-o",
                            echoes], check=True)
            for file in (SENSOR, echoes):
                state, messages = play(PARAVIEW, [click(button("airport_scan"))], [file])
                self.assertEqual(messages, [])
                self.assertLessEqual(MACROS["airport_scan"], names(state))

    def test_the_filter_of_a_sensor(self):
        """The button of the filter is enabled as soon as a sensor is applied, and asks for surfaces."""
        events = [*enabled(), click(APPLY), *enabled("filter"),
                  click(button("filter")), click("SelectInputDialog/buttonBox/1QPushButton1")]
        state, messages = play(PARAVIEW, events, [SENSOR])
        self.assertEqual((messages, names(state)), ([], {os.path.basename(SENSOR)}))

    def test_the_waveform_after_a_scan(self):
        state, messages = play(PARAVIEW, [click(button("airport_scan")), click(button("plot_waveform"))])
        self.assertEqual((messages, names(state)), ([], MACROS["airport_scan"] | {"Waveform"}))

    def test_the_macro_of_the_dialog(self):
        """As a script, with the values that Finish on the dialog's first page gives."""
        state, messages = play(PARAVIEW, [], [f"--script={PLUGIN_DIR}/Macros/avian_lidar_wizard.py"])
        self.assertEqual(messages, [])
        self.assertLessEqual(AIRPORT | {"Search 905", "Scan", "Herring gull", "Echoes of herring gull"}, names(state))

    def test_a_macro_without_a_selection(self):
        for name, words in WORDS.items():
            with self.subTest(name):
                (message,) = play(PARAVIEW, [macro(name)])[1]
                self.assertIn(words, message)
                self.assertNotIn("Traceback", message)


if __name__ == "__main__":
    PARAVIEW = sys.argv[1]
    unittest.main(argv=sys.argv[:1])
