# SPDX-License-Identifier: BSD-3-Clause
"""ParaView state: the airport Hongqiao, scanned by the lidar Airport 16, with echoes coloured by energy.

In ParaView: File > Load State. From the command line: paraview --state avian_lidar_airport.py. The state loads the
plugin from the folder above, unless ParaView has loaded the plugin. On a remote server the plugin must already be
loaded. Otherwise there are no new objects, and the state prints the reason.
"""

import os

from paraview import simple

FOLDER = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

try:
    import avian_lidar_plugin
except ImportError:
    simple.LoadPlugin(os.path.join(FOLDER, "AvianLidarPlugin.so"), remote=False, ns=vars(simple))
    import avian_lidar_plugin

scan = avian_lidar_plugin.neighbour("avian_lidar_airport_scan").scan
avian_lidar_plugin.run("airport", scan, report=avian_lidar_plugin.write)
