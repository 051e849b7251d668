# SPDX-License-Identifier: BSD-3-Clause
"""What stands on top of scans and coverage: sequences, plans and maps, sites, reports. Nothing of the package imports it but public
names and, within functions, the command's verbs."""
