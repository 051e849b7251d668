# SPDX-License-Identifier: BSD-3-Clause
"""Places on the ground: features of maps, runways and their regions, outlines, and places where a lidar may stand."""
