# SPDX-License-Identifier: BSD-3-Clause
"""Coverage by lidars: plans and maps, ranges of targets, sites, designs, and reports."""
