# SPDX-License-Identifier: BSD-3-Clause
"""Reports that are made in seconds, for tests of all but their curves."""
import contextlib
import unittest.mock

from avianlidar.apps import _report, reach


@contextlib.contextmanager
def quick():
    """Reports have one visibility, one rain and few ranges."""
    with unittest.mock.patch.multiple(_report, VISIBILITIES=(_report.ANSWERED,), RAINS=(0.0,)), unittest.mock.patch.object(reach, "RANGES", 12):
        yield


@contextlib.contextmanager
def curves():
    """Reports have three visibilities and rains, and half of the ranges."""
    with unittest.mock.patch.multiple(_report, VISIBILITIES=(200.0, _report.ANSWERED, 20e3), RAINS=(0.0, 10.0, 50.0)), \
            unittest.mock.patch.object(reach, "RANGES", 24):
        yield
