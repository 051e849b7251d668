# SPDX-License-Identifier: BSD-3-Clause
"""Applications of scans and coverage, in packages by task. In the package `avianlidar`, only modules with public names
and the functions of the command's verbs import this subpackage."""

PACKAGES = "pages", "inputs", "places", "airport", "sequences", "view", "coverage"  # each imports only packages before it
