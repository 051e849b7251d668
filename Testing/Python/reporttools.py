# SPDX-License-Identifier: BSD-3-Clause
"""Reports that are made in seconds."""
import contextlib
import unittest.mock

from avianlidar.apps import _report, reach


@contextlib.contextmanager
def quick():
    """Reports have one visibility, one rain and few ranges."""
    with unittest.mock.patch.multiple(_report, VISIBILITIES=(_report.ANSWERED,), RAINS=(0.0,)), unittest.mock.patch.object(reach, "RANGES", 12):
        yield
