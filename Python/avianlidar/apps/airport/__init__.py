# SPDX-License-Identifier: BSD-3-Clause
"""Scenes, plans and scenarios of airports, made from maps, rasters of heights and surveyed obstacles."""
