# SPDX-License-Identifier: BSD-3-Clause
"""Reports that are made in seconds."""
import base64
import contextlib
import pathlib
import unittest.mock

from avianlidar.apps import _pictures, _report, reach

PIXEL = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9Q"
                         "DwADhgGAWjR9awAAAABJRU5ErkJggg==")


@contextlib.contextmanager
def quick(pictures=False):
    """Reports have one visibility, one rain and few ranges, and a pixel for each picture unless `pictures` is set."""
    with contextlib.ExitStack() as changed:
        changed.enter_context(unittest.mock.patch.multiple(_report, VISIBILITIES=(_report.ANSWERED,), RAINS=(0.0,)))
        changed.enter_context(unittest.mock.patch.object(reach, "RANGES", 12))
        if not pictures:
            pixel = unittest.mock.patch.object(_pictures, "draw", lambda file, *_: pathlib.Path(file).write_bytes(PIXEL))
            changed.enter_context(pixel)
        yield
