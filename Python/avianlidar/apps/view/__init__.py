# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML with a scene in three dimensions."""
