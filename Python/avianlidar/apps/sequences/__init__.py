# SPDX-License-Identifier: BSD-3-Clause
"""Sequences of scans with labelled birds, tracks in them, and scores of trackers and networks."""
