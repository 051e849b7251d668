# SPDX-License-Identifier: BSD-3-Clause
"""The public name of `apps.reach`."""
import sys

from .apps import reach
from .apps.reach import *  # noqa: F401,F403  for who reads types

sys.modules[__name__] = reach
