# SPDX-License-Identifier: BSD-3-Clause
"""The plugin loads, and its proxies become functions."""

import os

from paraview import simple

simple.LoadPlugin(os.environ["AVIANLIDAR_PLUGIN"], remote=False, ns=globals())
assert "AvianLidarHSBColorMap" in globals()
