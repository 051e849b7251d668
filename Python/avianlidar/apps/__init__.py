# SPDX-License-Identifier: BSD-3-Clause
"""Applications of scans and coverage: sequences, plans and maps, sites, reports. In the package, only modules with
public names and the functions of the command's verbs import this subpackage."""
