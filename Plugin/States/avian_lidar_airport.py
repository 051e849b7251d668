# SPDX-License-Identifier: BSD-3-Clause
"""ParaView state: the airport Hongqiao, scanned by the lidar Airport 16, echoes coloured by energy.

In ParaView: File > Load State. From the command line: paraview --state avian_lidar_airport.py. It loads the plugin that
it lies beside, if ParaView has not, and finds its files from its own place. On a remote server the plugin must have been
loaded: else nothing is made, and the reason is printed.
"""

import importlib.util
import os

from paraview import simple

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDER = os.path.dirname(HERE)


def load_macro(name):
    path = os.path.join(FOLDER, "Macros", name + ".py")
    spec = importlib.util.spec_from_file_location(name, path)
    macro = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(macro)
    return macro


macro = load_macro("avian_lidar_airport_scan")
try:
    macro.plugin_folder()
except ValueError:
    simple.LoadPlugin(os.path.join(FOLDER, "AvianLidarPlugin.so"), remote=False, ns=vars(simple))
try:
    macro.scan()
except ValueError as problem:
    print(f"Avian lidar airport: {problem}.")
else:
    simple.Render()
